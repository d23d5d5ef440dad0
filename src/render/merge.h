/* merge.h -- shares of a render added up. See merge.c. */
#ifndef RENDER_MERGE_H
#define RENDER_MERGE_H

#include "render/render.h"
#include "render/state.h"

/* Which numbers a part is made of: its seed and, of the shares with it, which one. */
typedef struct { char seed[24]; uint32_t shard, shards; } PartOf;      /* 0, 0: all of it */

typedef struct {
    Film     film;              /* owned: the sum, once there is a part */
    Identity text;              /* owned: of the first part */
    PartOf  *parts;             /* owned */
    size_t   n, cap;
    double   samples, squares;  /* of all parts; of estimated errors, times samples squared */
} Merge;

/* Adds what the file holds. {0} is a sum of nothing. False: reported. */
bool merge_add(Merge *m, const char *path, const ReadLimits *limits);
void merge_clear(Merge *m);
/* Shares that were asked for and have not come. */
uint32_t merge_missing(const Merge *m);
/* Estimated sigma/mu of the sum. */
double merge_error(const Merge *m);
/* The extra pictures that the parts have, layer by layer, into s, where none is wanted yet. False:
 * reported. */
bool merge_aovs(const Merge *m, RenderSettings *s);
/* Wants one of them, by "NAME=FILE", which is borrowed. False: reported. */
bool merge_want(const Merge *m, RenderSettings *s, const char *text);

#endif

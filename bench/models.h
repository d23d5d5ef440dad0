/* models.h -- the scenes of the tables: made by rule, or the user's own. */
#ifndef BENCH_MODELS_H
#define BENCH_MODELS_H

#include "bench/printed.h"
#include "render/cast.h"

typedef struct {
    const char *name;           /* borrowed */
    const PrintedScene *printed;/* what the document says of it; NULL: nothing */
    Scene *scene;               /* borrowed: one geometry, which holds no more than it needs */
    size_t bytes;               /* taken for that geometry, with normals and coordinates */
    uint64_t tris;
} Model;

/* Calls f for each scene in turn, which then is forgotten. With MODELS in the environment they are
 * the PLY and OBJ files of that folder, by name. Else they are as large as those of the document,
 * without those of more than `most` triangles; and the largest only with FULL. With MODEL only that
 * of them that it names. */
void models_each(uint64_t most, void (*f)(const Model *m));

/* A structure by its text, "lbvh:bits=8"; its strings go to the arena. A wrong text is our bug. */
CastConfig config_of(const char *text, Arena *arena);

/* ---- what the tables have in common ---- */

/* Columns: the structures that are printed, then more of ours. */
enum { COLUMNS = PRINTED + 4 };
const Structure *table_column(int i);

/* The heads of the columns, after another one. */
void table_head(const char *first);
/* Starts a line: what it is of, and what the line has. */
void line_head(const char *front, const char *what);
/* "28,055,742" */
const char *with_commas(char out[32], uint64_t n);
/* A cell of a table, or "-"; mark: behind it. */
void cell(double v, int digits, bool known, char mark);

#endif

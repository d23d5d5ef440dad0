/* casttable.h -- what `cast` prints. */
#ifndef CLI_CASTTABLE_H
#define CLI_CASTTABLE_H

#include "render/cast.h"

/* What was measured over one scene. All borrowed. */
typedef struct {
    const CastScene  *scene;
    const CastOrder  *order;
    const RaySet     *sets;
    int               nsets;
    const CastConfig *configs;
    const CastRow    *rows;     /* by configuration */
    int               nrows;
} CastTable;

void cast_table_print(const CastTable *t);      /* for people, at most 80 columns */
void cast_csv_head(void);
void cast_csv_print(const CastTable *t);        /* a line for each structure and ray set */

#endif

/* describe.h -- the tables of the program, as JSON: what a viewer may choose from. */
#ifndef VIEW_DESCRIBE_H
#define VIEW_DESCRIBE_H

#include "view/json.h"

/* An object of lists: integrators, accelerators, samplers, filters, tonemaps, meters, denoisers. */
void describe_tables(Json *j);

#endif

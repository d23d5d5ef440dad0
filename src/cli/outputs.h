/* outputs.h -- pictures of a render become files: the picture itself, and the extra ones. */
#ifndef CLI_OUTPUTS_H
#define CLI_OUTPUTS_H

#include "cli/denoising.h"
#include "render/render.h"

/* Files to write and how; borrowed. */
typedef struct {
    const char *pictures[OUTPUTS_MAX];
    int     n;
    Display display;
    Denoising denoising;        /* of the pictures, not of the extra ones */
} Outputs;

/* One more of at most OUTPUTS_MAX pictures to write; borrowed. False: usage error reported. */
bool output_add(const char **outputs, int *n, const char *value);
/* Adds the extra pictures, without files, that the filters are guided by. */
void outputs_prepare(const Outputs *o, RenderSettings *s);
/* Whether all could be written, asked before the hours of rendering. False: reported. */
bool outputs_possible(const Outputs *o, const RenderSettings *s);
/* Writes all, each of them even if others fail. What goes to one .exr file are its layers. False:
 * reported. */
bool outputs_write(const Outputs *o, const RenderSettings *s, const Film *f);

#endif

/* pictures.h -- layers of a film as files, for the commands that have films. */
#ifndef CLI_PICTURES_H
#define CLI_PICTURES_H

#include "render/render.h"

/* Writes a layer of the film by the extension of path. aov: what the layer is, NULL of layer 0.
 * False: reported. */
bool layer_write(const Film *f, int layer, const Aov *aov, const char *path,
                 const Display *display);

#endif

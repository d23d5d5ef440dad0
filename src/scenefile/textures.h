/* textures.h -- the makers of textures from the inside: what the classes share. */
#ifndef SCENEFILE_TEXTURES_H
#define SCENEFILE_TEXTURES_H

#include "scenefile/reader.h"

typedef struct {                /* of the texture being made */
    Reader *r;
    const Params *ps;
    bool     colour;
    uint32_t cost;
} Build;

/* In the scene's arena, with the mapping of (u, v); NULL: memory, reported. */
Texture *texture_new(Reader *r, TextureKind kind);
/* Reads the parameters of a mapping. False: reported. */
bool texture_mapping(Build *b, Texture *t);
/* For patterns in space: places are those of the current transform. */
void texture_space(Build *b, Texture *t);
bool texture_imagemap(Build *b, Place at, const Texture **t);

#endif

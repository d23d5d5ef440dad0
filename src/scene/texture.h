/* texture.h -- values that vary over surfaces and through space: a closed set, since every hit
 * evaluates some. */
#ifndef SCENE_TEXTURE_H
#define SCENE_TEXTURE_H

#include "base/transform.h"
#include "geometry/geometry.h"
#include "image/pyramid.h"

typedef enum {
    TEXTURE_CONSTANT,           /* value */
    TEXTURE_IMAGE,              /* a picture times value */
    TEXTURE_CHECKER,            /* a and b alternate in unit squares of (s, t) */
    TEXTURE_CHECKER3,           /* in unit cubes of space */
    TEXTURE_SCALE,              /* a times b */
    TEXTURE_MIX,                /* a (1 - c) + b c */
    TEXTURE_ROOT,               /* of a */
    TEXTURE_DIRECTION_MIX,      /* a where the normal runs along `axis`, b where across */
    TEXTURE_BILERP,             /* a, b, c, d at (0,0), (0,1), (1,0), (1,1) of (s, t) */
    TEXTURE_DOTS,               /* a inside, b outside of discs in about half of the unit squares */
    TEXTURE_UV,                 /* red and green are the fractions of s and t */
    TEXTURE_FBM,                /* from here on noise in space, times value */
    TEXTURE_WRINKLED,
    TEXTURE_WINDY,
    TEXTURE_MARBLE
} TextureKind;

/* Where (s, t) come from. In the order of the names in the scene language. */
typedef enum {
    TEXTURE_MAP_UV,                 /* (su u + du, sv v + dv) */
    TEXTURE_MAP_SPHERICAL,          /* about the texture space's origin: theta / pi, phi / 2 pi */
    TEXTURE_MAP_CYLINDRICAL,        /* about its z axis: (pi + phi) / 2 pi, z */
    TEXTURE_MAP_PLANAR              /* (vs . p + du, vt . p + dv) */
} TextureMapKind;

typedef struct {
    TextureMapKind kind;
    float su, sv, du, dv;
    V3 vs, vt;
    Affine to_texture;          /* from the world; also of the kinds that vary through space */
} TextureMap;

typedef enum { FILTER_BILINEAR, FILTER_POINT, FILTER_TRILINEAR } ImageFilter;

typedef struct Texture {
    TextureKind kind;
    Rgb value;
    const struct Texture *a, *b, *c, *d;        /* borrowed from the scene */
    TextureMap map;
    const Image *image;         /* borrowed from the scene, as is the pyramid */
    const Pyramid *pyramid;     /* of TRILINEAR, else NULL */
    Wrap wrap;
    ImageFilter filter;
    bool invert, grey;          /* 1 - colour, not below 0; the mean of the channels */
    V3 axis;                    /* unit, in the world */
    int octaves;
    float roughness, scale, variation;          /* scale and variation: of MARBLE */
} Texture;

enum { TEXTURE_OCTAVES_MAX = 32 };      /* a float has no digits for finer ones */

Rgb texture_eval(const Texture *t, const Surface *s);
/* As an opacity: alpha of pictures that have it, else the grey value. */
float texture_alpha(const Texture *t, const Surface *s);

/* texturemap.c: (s, t) of a point, and how far they change over the width of the beam there; the
 * same for space. A width of 0: not known, or a ray. */
V2 texture_map_st(const TextureMap *m, const Surface *s);
V2 texture_map_width(const TextureMap *m, const Surface *s);
V3 texture_map_space(const TextureMap *m, const Surface *s);
float texture_map_space_width(const TextureMap *m, const Surface *s);

#endif

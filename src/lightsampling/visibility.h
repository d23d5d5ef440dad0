/* visibility.h -- maps of what hides the light, on a sparse grid of pixels.
 *
 * Source      [Cline07 6.2, 6.3]; errata 6.3. A map covers the unit square: of the numbers that a
 *             product sampler warps (preimage space), or of directions (world space, where left and
 *             right edge are one). A texel is in one of three zones: occluded, visible, uncertain.
 * Texels      Two bits: it may be occluded, it may be visible. Maps agree where they have the same
 *             bits; all together they are the bits of any: one OR of whole words. No bits: nobody
 *             looked, as where the map's own pixel shows no surface; such a map has no say.
 * Grid        A map every `spacing` pixels of the whole picture, at its origin, so that a window
 *             has the maps of the whole. A pixel is in a cell of the grid; the maps of the cell's
 *             corners are its four nearest.
 * Learning    What a pixel finds is noted in the four maps, but for pixels of the same tile of the
 *             film only: a tile is one thread's at a time and its pixels have an order, so no
 *             picture depends on the threads. And for pixels of the other colour of a chessboard
 *             only: the map of a pixel then depends on none of its own samples, and no sampler, by
 *             spreading the samples of a pixel, can make an unbiased estimate biased. (A picture of
 *             one pixel learns nothing.) Since borders of tiles are barriers, the pixels of a
 *             window (--crop) are not quite those of the whole picture.
 * Memory      size^2 / 4 bytes a map: 64 by default, so a byte a pixel for maps made before, and
 *             8 bytes a pixel for what is learned (two colours, nine maps a tile of 16 x 16; pages
 *             that nothing is learned on are never touched). visibility_bytes has the sum. */
#ifndef LIGHTSAMPLING_VISIBILITY_H
#define LIGHTSAMPLING_VISIBILITY_H

#include "image/film.h"

typedef enum { ZONE_UNKNOWN, ZONE_OCCLUDED, ZONE_VISIBLE, ZONE_UNCERTAIN } Zone;

enum { VISIBILITY_MOST = 64, TEXELS_A_WORD = 16,        /* most texels across */
       VISIBILITY_WORDS = VISIBILITY_MOST * VISIBILITY_MOST / TEXELS_A_WORD };

typedef struct {
    int      size, words;       /* texels across; words of a map */
    bool     wraps;             /* left and right edge are one */
    uint32_t spacing;
    uint32_t full_w, full_h;    /* of the whole picture */
    uint32_t x0, y0, tiles_x;   /* the window's corner; its tiles */
    uint32_t gx, gy, gw, gh;    /* the grid's columns and rows that matter: first and how many */
    uint32_t across, down;      /* maps that the pixels of a tile may have */
    uint32_t *made;             /* owned: [map][words]; NULL: all are occluded at first */
    uint32_t *learned[2];       /* owned: by colour of the pixels that look: [tile][map][words] */
    size_t   nmade, nlearned;   /* words */
} Visibility;

/* The map of a pixel, and what its samples find. */
typedef struct {
    int  size;
    bool wraps;
    int  open;                  /* texels that are not occluded for certain */
    int  noted;                 /* findings */
    uint32_t zone[VISIBILITY_WORDS], found[VISIBILITY_WORDS];
} VisibilityMap;

/* For the window of f. lazy: no maps are made, all is occluded until found to be otherwise; else
 * nothing is known. False: reported, nothing held. */
bool visibility_init(Visibility *v, const Film *f, int size, uint32_t spacing, bool wraps,
                     bool lazy);
void visibility_clear(Visibility *v);
size_t visibility_bytes(const Visibility *v);

/* ---- making: maps may be made in any order, each once ---- */

INLINE uint32_t visibility_maps(const Visibility *v) { return v->made ? v->gw * v->gh : 0; }
/* The pixel that map k is looked at from. */
void visibility_place(const Visibility *v, uint32_t k, uint32_t *x, uint32_t *y);
/* A number of its own, the same in all windows of the picture. */
INLINE uint64_t visibility_number(const Visibility *v, uint32_t k)
{
    return ((uint64_t)(v->gy + k / v->gw) << 32) + v->gx + k % v->gw;
}
/* visible: size x size texels, row by row. Those of which one beside them, also across a corner, is
 * unlike become uncertain. */
void visibility_make(Visibility *v, uint32_t k, const bool *visible);

/* ---- of a pixel of the window ---- */

/* By agreement of the four nearest maps. Where none has a say: uncertain. */
void visibility_at(const Visibility *v, uint32_t x, uint32_t y, VisibilityMap *m);
/* One that knows nothing: all of it uncertain. */
INLINE void visibility_unknown(VisibilityMap *m)
{
    m->size = m->open = 1;
    m->wraps = false;
    m->noted = 0;
    m->zone[0] = m->found[0] = ZONE_UNCERTAIN;
}
/* Light was seen at p: that texel and those around it are uncertain. */
void visibility_note(VisibilityMap *m, V2 p);
/* Writes what was noted to the pixel's four maps. By the worker that has the pixel's tile. */
void visibility_learn(Visibility *v, uint32_t x, uint32_t y, const VisibilityMap *m);

/* What has been learned, into a file and back. */
void visibility_save(const Visibility *v, Saving *s);
bool visibility_load(Visibility *v, Loading *l);        /* false: too short; not reported */

INLINE int visibility_texel(int size, V2 p)
{
    int x = (int)(p.x * (float)size), y = (int)(p.y * (float)size);
    return (y < size ? y : size - 1) * size + (x < size ? x : size - 1);
}
INLINE Zone visibility_zone(const VisibilityMap *m, V2 p)
{
    int k = visibility_texel(m->size, p);
    return (Zone)(m->zone[k / TEXELS_A_WORD] >> 2 * (k % TEXELS_A_WORD) & 3);
}

/* ---- directions as points of a map in world space ---- */

/* Equal areas: azimuth in turns, and (1 - z) / 2. [0,1) and [0,1]. */
V2 visibility_of_direction(V3 w);
V3 visibility_direction(V2 p);

/* ---- how many points ---- */

typedef struct {
    int   points;               /* m, to divide by */
    float keep;                 /* p: of those in occluded texels */
} Thinning;

enum { THINNING_MOST = 64 };    /* m / n */

/* For n samples where a share v of the square is open, and in occluded texels a share a of the
 * density shall stay: m = n (v + (1 - v)(1 - a)) / v and p = n a / m [Cline07 6.3], errata 6.0; all
 * of the square alike if v is 0, and m bounded, errata 6.2. With a = 0 nothing stays, and m = n / v
 * is that of [Cline07 6.2.1]. */
Thinning thinning_of(int n, float v, float a);

/* Whether a point in this zone is used, by a canonical number of its own; then *weight is what it
 * counts in the sum. [Cline07 6.3], errata 6.1 */
INLINE bool thinning_keeps(const Thinning *t, Zone zone, float choice, float *weight)
{
    *weight = 1.0f / (float)t->points;
    if (zone != ZONE_OCCLUDED)
        return true;
    *weight /= t->keep;                 /* infinite only where the answer is no */
    return choice < t->keep;
}

#endif

/* pointlights.h -- all light as a set of point lights, each of which stands for a cell: of the
 * sphere of directions, of a lamp, or of a surface that reflects light on.
 *
 * Source      [Wang09 3.1, 4]: tens of thousands of points, each with a place, a normal and a small
 *             area, or with a direction and a small solid angle, and a radiance alike on all sides.
 * Beyond      Cells are squares of the octahedral map, which keeps areas: all have the same solid
 *             angle to the last bit, none is long and thin, and the cell of a direction is found
 *             at once. More even than points that were repelled from each other, and blue noise is
 *             not wanted of what is never seen as a pattern. L is the mean over the cell, so a sun
 *             smaller than that loses nothing; the point is where the cell's light has its middle.
 * Lamps       Cells are strata of the unit square that the light itself makes a place of.
 * Surfaces    surfacepoints.c.
 * Two uses    At its point, the light stands still: what is summed is the sum over the points, and
 *             that is the source's truth. Or anywhere in its cell (jitter): what is summed is the
 *             integral over all lights, without bias. Points on surfaces have no cells to choose
 *             from and stand still.
 * Delta       Point and distant lights are none of these; one asks them as they are. */
#ifndef LIGHTSAMPLING_POINTLIGHTS_H
#define LIGHTSAMPLING_POINTLIGHTS_H

#include "scene/scene.h"

typedef enum { POINT_BEYOND, POINT_ON_LAMP, POINT_ON_SURFACE } PointKind;

typedef struct {
    PointKind kind;
    bool  two_sided;            /* on a lamp that is */
    V3    p, err;               /* the place and its error; beyond: the unit direction towards it */
    V3    n;                    /* the side that shines; beyond: 0 */
    V2    uv;
    float size;                 /* area, or solid angle */
    float lum;                  /* luminance of L, above 0: what a choice goes by */
    Rgb   L;                    /* radiance, beyond and on surfaces */
    uint32_t light, cell;       /* lamp and its stratum; beyond: the cell of the sphere */
} PointLight;

typedef struct {
    const Scene *scene;         /* borrowed */
    PointLight *p;              /* owned */
    size_t n, cap;
    uint32_t side;              /* the sphere has side^2 cells; 0: no light from beyond */
    uint32_t *strata;           /* owned; by light of the scene: strata along a side; 0: none */
    bool jitter;
} PointLights;

typedef enum { INDIRECT_NO, INDIRECT_YES, INDIRECT_ONLY } Indirect;

/* About `wanted` points, shared among the kinds of light that there are. jitter: they will be used
 * anywhere in their cells, so even cells that seem black are kept, as a thousandth of the mean.
 * Points are the same whatever the seed of the picture. False: memory, reported. */
bool pointlights_init(PointLights *it, const Scene *s, size_t wanted, bool jitter, Indirect which);
void pointlights_clear(PointLights *it);

/* Number i as seen from a point: s->L is the irradiance on a surface that faces it, times what was
 * chosen of its cell by u, so that the sum over all i, of L f cos, is the light of all. Where the
 * point stands still it is taken to be no nearer than the radius of a disc of its size: A cos /
 * max(d^2, A / pi), so that no point brings more than a surface all round would. pdf_w is 1. False:
 * it does not shine here. */
bool pointlight_seen(const PointLights *it, size_t i, V3 from, V2 u, LightSample *s);

/* The cell of a direction: below side^2. */
uint32_t sphere_cell(uint32_t side, V3 d);
/* A direction in the cell, uniformly by u. */
V3 sphere_direction(uint32_t side, uint32_t cell, V2 u);

/* Appends points on surfaces that scatter light on, about `wanted`. False: memory. */
bool surface_points(PointLights *it, size_t wanted);

#endif

/* skymap.h -- the light from beyond the scene, or that of a lamp with a picture, as a grid of cells
 * whose sums over any rectangle are four look-ups away: what partitions are made of.
 *
 * Source      [Cline07 5.2.1]: a summed area table of luminance times the sine of the polar angle
 *             (which is the cosine of the source's angle of inclination), in doubles.
 * Cells       Columns are longitudes, rows are polar angles from z, as the latlong mapping of
 *             panorama.h has them, in the frame of the light. Where that is how the light's picture
 *             goes, a cell lies within one pixel, or is a whole number of columns and rows of them
 *             if the picture is very large. Small pictures and constants have cells enough for a
 *             surface's own factor to be followed; other mappings are looked up by direction, and
 *             so is light that no picture says exactly.
 * Lamps       Parallelograms, see light.h: cells are of the unit square of their places. What is
 *             said of directions of the world is said of points of the world then, and 1 is the
 *             jacobian: densities are per unit square.
 * Measure     Light counts by luminance, or by one of its channels, for methods that have a map for
 *             each.
 * Positive    A cell is above 0 wherever light comes from its directions: whatever is drawn in
 *             proportion to it misses none (errata 5.3).
 * Measures    Sums are shares of all light: the whole has 1. Places are of the unit square;
 *             d omega = 2 pi^2 sin(theta) d place (errata 5.1). */
#ifndef LIGHTSAMPLING_SKYMAP_H
#define LIGHTSAMPLING_SKYMAP_H

#include "scene/scene.h"

typedef enum { BY_LUMINANCE, BY_RED, BY_GREEN, BY_BLUE } SkyMeasure;

typedef struct {
    const Light *light;         /* borrowed */
    SkyMeasure measure;
    LightPicture picture;       /* of a light from beyond */
    bool  flat;                 /* of a lamp: */
    LightRectangle lamp;
    V3    back[2];              /* a point less the corner, times these, is its place */
    bool  exact;                /* one radiance in each cell: that of the picture's pixel there */
    uint32_t w, h;              /* cells; at most SKYMAP_WIDEST and half as much; of a lamp
                                 * SKYMAP_LAMP_WIDEST both */
    double *sum;                /* owned: h + 1 rows of w + 1, of all cells left of and above */
    V2     *column;             /* owned: cosine and sine of the longitudes of w + 1 edges */
    V2     *row;                /* owned: sine and cosine of the polar angles of h + 1 edges; of
                                 * lamps both are NULL */
    double light_in_all;        /* what is measured times solid angle of the whole, W/m^2; of a
                                 * lamp: times the unit square */
} SkyMap;

enum { SKYMAP_WIDEST = 4096, SKYMAP_NARROWEST = 128, SKYMAP_LAMP_WIDEST = 512 };

/* Of a light that has `picture`, prepared. False: memory, reported. */
bool skymap_init(SkyMap *m, const Light *l, SkyMeasure by);
/* Of one that is a rectangle. */
bool skymap_init_lamp(SkyMap *m, const Light *l, const LightRectangle *r, SkyMeasure by);
void skymap_clear(SkyMap *m);

/* The light beyond that is worth a map: of those that can say their picture the one of most power.
 * NULL: there is none. */
const Light *skymap_light(const Scene *s);

/* Share of all light in the columns x0 .. x1 - 1 of the rows y0 .. y1 - 1; never below 0, though
 * rounding would have it. */
INLINE double skymap_sum(const SkyMap *m, uint32_t x0, uint32_t y0, uint32_t x1, uint32_t y1)
{
    const double *top = m->sum + (size_t)y0 * (m->w + 1), *end = m->sum + (size_t)y1 * (m->w + 1);
    return d_max(0.0, (end[x1] - end[x0]) - (top[x1] - top[x0]));
}

/* The direction of the world to a corner of cells. */
INLINE V3 skymap_corner(const SkyMap *m, uint32_t x, uint32_t y)
{
    float s;

    if (m->flat)
        return v_mad(m->lamp.side[0], (float)x / (float)m->w,
                     v_mad(m->lamp.side[1], (float)y / (float)m->h, m->lamp.corner));
    s = m->row[y].x;
    return affine_vector(&m->picture.to_world,
                         v3(s * m->column[x].x, s * m->column[x].y, m->row[y].y));
}

/* Place to direction of the world, and d omega / d place. */
V3 skymap_direction(const SkyMap *m, V2 place, float *jacobian);
void skymap_directions(const SkyMap *m, const V2 *place, V3 *wi, float *jacobian, int n);
V2 skymap_place(const SkyMap *m, V3 wi, float *jacobian);
INLINE void skymap_cell(const SkyMap *m, V2 place, uint32_t *x, uint32_t *y)
{
    *x = (uint32_t)((double)place.x * m->w);            /* places are in [0,1) */
    *y = (uint32_t)((double)place.y * m->h);
}

/* What comes from there: of the cell that the place lies in, whatever rounding did to wi. Not of
 * lamps. */
Rgb skymap_radiance(const SkyMap *m, V2 place, V3 wi);

#endif

/* area.h -- what the files of the light `diffuse` share; the light is described in area.c. */
#ifndef SCENE_AREA_H
#define SCENE_AREA_H

#include "sampling/table.h"
#include "scene/scene.h"

typedef struct {
    Light base;
    Rgb   L;
    bool  two_sided;
    float exponent;
    Texture picture;            /* if base.textured */
    Rgb   mean;                 /* of picture and mask over the shape */
    const Texture *mask;        /* borrowed; opacity of the shape's material, or NULL */
    const Scene *scene;         /* borrowed */
    uint32_t geometry, shape;
    float area;
    Table triangles;            /* owned; if there are any: by area */
    V3   *normals;              /* owned; of each triangle, by the order of its corners */
    uint32_t solid;             /* triangles to sample by solid angle; 0: by area */
    float power_wanted;         /* by luminance; 0: L is as given */
    V3    centre, axis;         /* of a ball around it; its one normal if it is flat, else 0 */
    float radius, lum;          /* of the ball; mean luminance along the normal */
} Area;

INLINE const Geometry *geometry_of(const Area *l) { return &l->scene->geometries[l->geometry]; }
INLINE const Shape *shape_of(const Area *l) { return &geometry_of(l)->shapes[l->shape]; }

/* Triangle i of the lamp, whatever order an accelerator has put them into. */
INLINE uint32_t lamp_triangle(const Shape *s, size_t i)
{
    if (s->kind == SHAPE_TESSELLATION)
        return s->as.tessellation->first_face + (uint32_t)i;
    return s->first + (s->place ? s->place[i] : (uint32_t)i);
}

/* Its ball, its one normal, its luminance: after all else is prepared. */
void  area_prepare_estimate(Area *l);
float area_estimate(const Light *base, V3 p, V3 n);

/* ---- triangles by the solid angle that they fill, see area_solid.c ---- */

enum { SOLID_MOST = 16 };       /* triangles of a lamp; each is looked at for each sample */

/* Solid angles of those that show `from` their front (any side, if both shine) up to each one, in
 * running sums. 0: area is to be sampled from there. */
double area_solid_angles(const Area *l, V3 from, double sum[SOLID_MOST]);
/* Triangle and weights of its second and third corner. False: by rounding, none. */
bool   area_solid_sample(const Area *l, V3 from, V2 u, const double sum[SOLID_MOST],
                         uint32_t *triangle, float *b1, float *b2);

#endif

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
    bool  is_rectangle;         /* two triangles make one, with a picture: */
    LightRectangle rectangle;
    int   first[2];             /* of each: the corner that it does not share, */
    bool  turned;               /* and whether those of the second go the other way round */
} Area;

extern const LightKind light_diffuse;

INLINE const Geometry *geometry_of(const Area *l) { return &l->scene->geometries[l->geometry]; }
INLINE const Shape *shape_of(const Area *l) { return &geometry_of(l)->shapes[l->shape]; }

/* How many triangles a mesh or tessellation has. */
INLINE uint32_t lamp_triangles(const Shape *s)
{
    return s->kind == SHAPE_MESH ? s->count : tessellation_faces(s->as.tessellation);
}

/* Triangle i of the lamp, whatever order an accelerator has put them into. */
INLINE uint32_t lamp_triangle(const Shape *s, size_t i)
{
    if (s->kind == SHAPE_TESSELLATION)
        return s->as.tessellation->first_face + (uint32_t)i;
    return s->first + (s->place ? s->place[i] : (uint32_t)i);
}

/* A point with its error, the front's normal, and (u, v) if it matters. */
typedef struct { V3 p, err, n; V2 uv; } AreaPoint;
/* Uniform by area. False: there is none. */
bool  area_point(const Area *l, V2 u, AreaPoint *s);
/* Radiance at (u, v) in a direction whose cosine with the normal is c > 0. */
Rgb   area_emitted(const Area *l, V2 uv, float c);
/* The part of the shape that is there. */
Rgb   area_masked(const Area *l, const AreaPoint *s, Rgb L);

/* The point of its i-th triangle with weights b1 and b2 of the second and third corner. */
void  area_on_triangle(const Area *l, uint32_t i, float b1, float b2, AreaPoint *at);
/* As seen from a point, with the density of points drawn uniform by area. False: no light comes. */
bool  area_seen(const Area *l, const AreaPoint *at, V3 from, LightSample *s);

bool  area_emit(const Light *base, V2 u, V2 v, Emission *e);
void  area_emit_pdf(const Light *base, const Surface *hit, V3 d, float *pdf_a, float *pdf_w);
/* Its ball, its one normal, its luminance: after all else is prepared. */
void  area_prepare_estimate(Area *l);
float area_estimate(const Light *base, V3 p, V3 n);

/* ---- rectangles, see area_rectangle.c ---- */

void  area_prepare_rectangle(Area *l);          /* after all else is prepared */
extern const LightPlaces area_places;

/* ---- triangles by the solid angle that they fill, see area_solid.c ---- */

enum { SOLID_MOST = 16 };       /* triangles of a lamp; each is looked at for each sample */

/* Solid angles of those that show `from` their front (any side, if both shine) up to each one, in
 * running sums. 0: area is to be sampled from there. */
double area_solid_angles(const Area *l, V3 from, double sum[SOLID_MOST]);
/* Triangle and weights of its second and third corner. False: by rounding, none. */
bool   area_solid_sample(const Area *l, V3 from, V2 u, const double sum[SOLID_MOST],
                         uint32_t *triangle, float *b1, float *b2);

#endif

/* scene.h -- what is in the world: shapes in spaces, materials, textures, lights, media, a camera.
 * The scene owns all of it. Readers add things; scene_build makes the structures for rays. */
#ifndef SCENE_SCENE_H
#define SCENE_SCENE_H

#include "accel/accel.h"
#include "image/pyramid.h"
#include "scene/camera.h"
#include "scene/light.h"
#include "scene/material.h"
#include "scene/medium.h"

typedef struct {
    const char *path;           /* in the arena */
    Encoding encoding;
    Image    image;
    Pyramid  pyramid;           /* made when it is first wanted */
} SceneImage;

struct Scene {
    Arena arena;                        /* lights, cameras, textures, names */
    Geometry *geometries;               /* owned; [0] is the world, others are instanced */
    Accel   **accels;                   /* owned; by geometry, after scene_build */
    size_t    ngeometries, cap_geometries;
    Material *materials;                /* owned; [0] is a neutral grey */
    size_t    nmaterials, cap_materials;
    Light   **lights;                   /* owned array, lights in the arena */
    size_t    nlights, cap_lights;
    const Light **infinite;             /* owned array: those that rays meet beyond the scene */
    size_t    ninfinite;
    Medium   *media;                    /* owned */
    size_t    nmedia, cap_media;
    uint32_t  around;                   /* the medium that the camera is in, or NO_MEDIUM */
    bool      see_through;              /* rays pass some of the surfaces; set by scene_build */
    SceneImage **images;                /* owned: of textures and lights */
    size_t    nimages, cap_images;
    Camera   *camera;                   /* in the arena, or NULL */
    double    times[2];                 /* when motions begin and end: times 0 and 1 of rays */
    bool      moves;                    /* a shape or the camera does; set by scene_build */
    Accel    *accel;                    /* of the world; borrowed from accels */
    Box       bounds;                   /* of the world; set by scene_build */
    V3        centre;                   /* of the sphere around it */
    float     radius;
};

Scene *scene_new(void);                         /* NULL: reported */
void   scene_free(Scene *s);
/* Each gives an index in *index (NULL: not wanted). False: memory, reported. */
bool   scene_add_geometry(Scene *s, uint32_t *index);
bool   scene_add_material(Scene *s, const Material *m, uint32_t *index);
bool   scene_add_light(Scene *s, Light *l, uint32_t *index);
bool   scene_add_medium(Scene *s, const Medium *m, uint32_t *index);
/* Reads a picture for a texture or a light; the scene keeps it. One file is read once. */
const Image *scene_image(Scene *s, const Making *m, const char *name);
const Image *scene_image_as(Scene *s, const Making *m, const char *name, Encoding encoding);
const Pyramid *scene_pyramid(Scene *s, const Image *of);        /* of one of these; NULL: memory */
/* Finishes geometries, builds structures bottom up, prepares lights. */
bool   scene_build(Scene *s, const AccelKind *kind, const Opts *o, int threads);
/* The structures alone, in place of those that there were. */
bool   scene_build_accels(Scene *s, const AccelKind *kind, const Opts *o, int threads);
void   scene_drop_accels(Scene *s);

/* The time of a ray that is made at the part u of the interval in which the camera's shutter is
 * open: before motions begin things stand as at their start, after they end as at their end. */
float  scene_time(const Scene *s, float u);
/* Whether pictures depend on u. */
bool   scene_blurs(const Scene *s);

/* The light that shines from this surface, or NULL. */
static inline const Light *scene_light_of(const Scene *s, const Surface *hit)
{
    return hit->shape->light == NO_LIGHT ? NULL : s->lights[hit->shape->light];
}
/* ---- rays among surfaces that let some pass: passage.c ---- */

typedef enum { MET_NOTHING, MET_SURFACE, MET_BORDER } Met;
/* What stops the ray; with `borders`, also the first border of media that would let it pass. h->t
 * is along r; *at is the surface met. MET_NOTHING: *h = hit_none. */
Met  scene_meets(const Scene *s, const Ray *r, bool borders, Hit *h, Surface *at);
bool scene_nearest_past(const Scene *s, const Ray *r, Hit *h);
/* The part of the light that gets along the whole ray, whose start is in `medium`; media change at
 * their borders. Black where anything stops it. */
Rgb  scene_transmittance(const Scene *s, const Ray *r, uint32_t medium);
/* The medium around a place, by the nearest border of media in some direction. */
uint32_t scene_medium_at(const Scene *s, V3 p, float time);
/* The medium on the side of a surface that w points to; `medium` if it separates none. */
uint32_t medium_beyond(const Surface *at, V3 w, uint32_t medium);

INLINE bool scene_nearest(const Scene *s, const Ray *r, Hit *h)
{
    return LIKELY(!s->see_through) ? accel_nearest(s->accel, r, h) : scene_nearest_past(s, r, h);
}
INLINE bool scene_blocked(const Scene *s, const Ray *r)
{
    Hit h;
    return LIKELY(!s->see_through) ? accel_blocked(s->accel, r) : scene_nearest_past(s, r, &h);
}

/* Where the input brought none: a camera that frames the world; for bare meshes a sky as well. */
bool   scene_frame_camera(Scene *s);
bool   scene_frame(Scene *s);

#endif

/* scene.h -- what is in the world: shapes in spaces, materials, textures, lights, a camera. The
 * scene owns all of it. Readers add things; scene_build makes the structures for rays. */
#ifndef SCENE_SCENE_H
#define SCENE_SCENE_H

#include "accel/accel.h"
#include "bsdf/bsdf.h"
#include "geometry/geometry.h"
#include "image/image.h"
#include "scene/medium.h"

typedef struct Scene Scene;

/* ---- textures: a closed set, since every hit evaluates some ---- */

typedef enum {
    TEXTURE_CONSTANT,
    TEXTURE_IMAGE,              /* bilinear, repeated */
    TEXTURE_CHECKER,            /* a and b alternate in unit squares of (u, v) */
    TEXTURE_SCALE               /* a times b */
} TextureKind;

typedef struct Texture {
    TextureKind kind;
    Rgb value;                          /* CONSTANT */
    const struct Texture *a, *b;        /* borrowed from the scene */
    const Image *image;                 /* borrowed from the scene */
    float su, sv, du, dv;               /* (u, v) becomes (su u + du, sv v + dv) */
} Texture;

Rgb texture_eval(const Texture *t, const Surface *s);
Rgb texture_mean(const Texture *t);     /* over the unit square, for estimates of power */

/* ---- materials ---- */

typedef struct {
    const BsdfKind *kind;
    const char *name;                           /* borrowed from the scene's arena; "" if none */
    Rgb value[OPT_MAX];                         /* by option of the kind */
    const Texture *texture[OPT_MAX];            /* or NULL: the value */
    int  nvalues;
    bool textured;                              /* any texture that is not NULL */
    const Texture *opacity;                     /* NULL: 1; where it is 0, rays pass */
    void *data;                                 /* what the kind's load() made, or NULL */
    bool borrows;                               /* data is another material's; else it is owned */
} Material;

void material_init(Material *m, const BsdfKind *kind, const Opts *o);   /* constants from o */
/* The model at a point, in *room, which is returned. */
const Bsdf *material_bsdf(const Material *m, const Surface *s, BsdfRoom *room);
/* The local frame in which the model's directions are given. */
static inline Frame material_frame(const Material *m, const Surface *s)
{
    return m->kind->flags & BSDF_TANGENT ? frame_along(s->ns, s->dpdu) : frame_about(s->ns);
}

/* ---- making things out of options ---- */

typedef struct {
    Scene *scene;
    Transform to_world;         /* current transform */
    Place at;                   /* of the directive; at.file is what paths are relative to */
    uint64_t max_file, max_pixels;
    uint32_t geometry, shape;   /* area lights: the shape that shines */
} Making;

/* ---- lights: one file a kind; light.c has the list ---- */

typedef struct Light Light;

/* A direction towards a light, seen from a point. */
typedef struct {
    V3    wi;                   /* unit, towards the light */
    Rgb   L;                    /* radiance along -wi; for delta lights: irradiance on a facing
                                 * surface, so that L f cos is what is reflected */
    float pdf_w;                /* solid angle; 1 for delta lights */
    float dist;                 /* to the light's point; INFINITY for lights at infinity */
    V3    p, err, n;            /* the light's point, its error, its normal (0 for none) */
} LightSample;

typedef struct {
    KindInfo info;
    bool delta;                 /* a ray cannot hit it: point, spot, distant */
    bool infinite;              /* seen by rays that leave the scene */
    /* From options of the kind's table, in the scene's arena. NULL: reported. */
    Light *(*make)(const Making *m, const Opts *o);
    /* After the scene is complete: bounds known. False: reported. NULL: nothing to do. */
    bool (*prepare)(Light *l, const Scene *s);
    void (*clear)(Light *l);                            /* NULL: nothing owned */
    /* Samples a direction from the point `from` towards the light. False: no light from there. */
    bool (*sample)(const Light *l, V3 from, V2 u, LightSample *s);
    /* Density of `sample` at direction wi; hit: the light's surface met there (area lights). */
    float (*pdf_w)(const Light *l, V3 from, V3 wi, const Surface *hit);
    /* Radiance that the light sends along -wi; hit as above. 0 for delta lights. */
    Rgb (*radiance)(const Light *l, V3 wi, const Surface *hit);
    /* Total power, watts (an estimate for textured ones); for selection. */
    Rgb (*power)(const Light *l);
} LightKind;

struct Light {                  /* first member of every concrete light */
    const LightKind *kind;
    uint32_t index;             /* in the scene's lights */
    Place at;
};
extern const LightKind *const lights[];         /* ends with NULL */

/* pdf_w and radiance of lights that no ray can hit: 0. */
float delta_pdf_w(const Light *l, V3 from, V3 wi, const Surface *hit);
Rgb   delta_radiance(const Light *l, V3 wi, const Surface *hit);

/* The sky of a bare mesh: soft light from above, a broad key light on one side. NULL: reported. */
Light *light_studio(const Making *m);

/* ---- cameras: one file a kind; camera.c has the list ---- */

typedef struct Camera Camera;
typedef struct {
    KindInfo info;
    Camera *(*make)(const Making *m, const Opts *o);    /* to_world: camera to world */
    void (*film)(Camera *c, uint32_t w, uint32_t h);    /* the picture's size, before any ray */
    /* Whether `lens` matters: a pinhole needs no number drawn for it. */
    bool (*has_lens)(const Camera *c);
    /* The ray through (x, y) in pixels from the top left, lens position u in [0,1)^2. Unit d. */
    Ray (*ray)(const Camera *c, V2 pixel, V2 lens);
} CameraKind;

struct Camera { const CameraKind *kind; };
extern const CameraKind *const cameras[];       /* ends with NULL */

/* ---- the scene ---- */

typedef struct { const char *path; Image image; } SceneImage;   /* path in the arena */

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
/* Finishes geometries, builds structures bottom up, prepares lights. */
bool   scene_build(Scene *s, const AccelKind *kind, const Opts *o, int threads);
/* The structures alone, in place of those that there were. */
bool   scene_build_accels(Scene *s, const AccelKind *kind, const Opts *o, int threads);
void   scene_drop_accels(Scene *s);

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

/* scene.h -- what is in the world: shapes in spaces, materials, textures, lights, a camera. The
 * scene owns all of it. Readers add things; scene_build makes the structures for rays. */
#ifndef SCENE_SCENE_H
#define SCENE_SCENE_H

#include "accel/accel.h"
#include "bsdf/bsdf.h"
#include "geometry/geometry.h"
#include "image/image.h"
#include "scene/texture.h"
#include "scene/medium.h"

#include <string.h>

typedef struct Scene Scene;

/* ---- materials ---- */

typedef struct Material {
    const BsdfKind *kind;
    const char *name;                           /* borrowed from the scene's arena; "" if none */
    Rgb value[BSDF_OPTIONS];                    /* by option of the kind */
    const Texture *texture[BSDF_OPTIONS];       /* or NULL: the value */
    int  nvalues;
    bool textured;                              /* any texture that is not NULL */
    const Texture *opacity;                     /* NULL: 1; where it is 0, rays pass */
    const Texture *bump;                        /* NULL: none; height along the shading normal */
    const Texture *normals;                     /* NULL: none; a picture of them, material.c */
    float slope;                                /* factor of their tilt, */
    bool  mirrors;                              /* in a frame whose second tangent follows v */
    void *data;                                 /* what the kind's load() made, or NULL */
    bool borrows;                               /* data is another material's; else it is owned */
    /* Of a mix: materials added before this one. Where they let rays pass, its opacity is their
     * mean by `amount`, and of what it stops each has the part that it stopped. */
    uint32_t part[2];
    const struct Material *mixed[2];            /* the same, borrowed; set by scene_build */
    bool tangent;                               /* set by scene_build: the frame follows dpdu, */
    bool looks_at_uv;                           /* and uv and its derivatives matter */
} Material;

/* Constants from o, and what the model loads from files (NULL: no names of files are in o). False:
 * reported. Before scene_add_material has taken it over, its owner clears it. */
bool material_init(Material *m, const BsdfKind *kind, const Opts *o, const BsdfFiles *files);
void material_clear(Material *m);
/* How many models the material is made of at a point: at most BSDF_PARTS may be. */
int  material_size(const Material *all, uint32_t index);
/* Fills in what scene_build sets. Those before it have been settled. */
void material_settle(Material *all, uint32_t index);
/* Whether it may scatter light by delta events. After scene_build. */
bool material_glints(const Material *m);
/* The model at a point, in *room, which is returned. */
const Bsdf *material_bsdf(const Material *m, const Surface *s, BsdfRoom *room);
/* The local frame in which the model's directions are given: about the shading normal, which a bump
 * map or a normal map turns. */
Frame material_frame_bumped(const Material *m, const Surface *s);
static inline Frame material_frame(const Material *m, const Surface *s)
{
    if (UNLIKELY(m->bump || m->normals))
        return material_frame_bumped(m, s);
    return m->tangent ? frame_along(s->ns, s->dpdu) : frame_about(s->ns);
}

/* ---- making things out of options ---- */

typedef struct {
    Scene *scene;
    Transform to_world;         /* current transform, at time 0 */
    Transform to_world_end;     /* cameras: at time 1, if `moves` */
    bool moves;
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
    V3    p, err, n;            /* the light's point, its error, its front normal (0 for none) */
} LightSample;

/* A particle of light on its way: the first ray of a light path [Veach97 8.3.2]. Whatever the light
 * is, L cosine / (pdf_a pdf_w) is the power that the particle stands for, in watts, and its mean
 * over u and v is the light's power. What L and the densities are:
 *
 *                       L                        cosine    pdf_a            pdf_w
 *   shapes              radiance W/(m^2 sr)      n.d       of p, 1/m^2      of d, 1/sr
 *   at a point          intensity W/sr           1         1 (delta)        of d, 1/sr
 *   at infinity         radiance W/(m^2 sr)      1         1/(pi R^2)       of d, 1/sr
 *   parallel            irradiance W/m^2         1         1/(pi R^2)       1 (delta)
 *
 * Lights beyond the scene send their particles from a disc across d, as large as the scene's sphere
 * (radius R), that lies before it: so pdf_a is per area perpendicular to d, not of any surface. */
typedef struct {
    V3    p, err;               /* whence: a point of the light or of the disc, and its error */
    V3    n;                    /* the light's normal there, on the side of d; 0 for no surface */
    V3    d;                    /* unit, the way the light goes */
    Rgb   L;
    float cosine, pdf_a, pdf_w;
    V2    uv;                   /* of p, where the light is a shape */
} Emission;

/* The first ray, which does not meet the surface that it leaves. Lights stand still: any time. */
INLINE Ray emission_ray(const Emission *e, float time)
{
    return (Ray){ .o = ray_origin(e->p, e->err, e->n, e->d), .d = e->d, .tmax = INFINITY,
                  .time = time };
}

/* What a ray cannot find by chance: the light's place, or its direction. */
typedef enum { DELTA_NONE, DELTA_PLACE, DELTA_DIRECTION } Delta;

/* How a light beyond the scene shows a picture, for methods that go by its cells. */
typedef struct {
    const Image *image;         /* borrowed; NULL: constant */
    bool latlong;               /* the picture goes by longitude and latitude, see panorama.h */
    Rgb  L;                     /* factor of the picture */
    Affine to_light, to_world;  /* directions */
    /* NULL: the picture says all. Else it is but a guide, of about this radiance, */
    Rgb (*shows)(const Light *l, V3 wi);
    Light *remainder;           /* and of what it leaves out this is a light; NULL: there is none */
} LightPicture;

/* A parallelogram that shines by a picture: places are of the unit square, (x, y) is the point
 * corner + x side[0] + y side[1]. */
typedef struct {
    V3   corner, side[2];
    V3   n;                     /* unit; the front's */
    bool both;                  /* its back may shine too */
    float exponent;             /* its light goes by this power of the cosine */
    uint32_t pixels[2];         /* that the picture has along the sides, about */
} LightRectangle;

/* What such a light can be asked. `rectangle` gives false: it is none, ask no more. */
typedef struct {
    bool (*rectangle)(const Light *l, LightRectangle *r);
    Rgb  (*shows)(const Light *l, V2 place);    /* radiance along the normal */
    /* As a light's sample; pdf_w: of places drawn all alike. False: no light from there. */
    bool (*seen)(const Light *l, V2 place, V3 from, LightSample *s);
} LightPlaces;

/* Of `hit`, a point of the light, its functions look at p, ng (the front) and uv; lights without a
 * surface are given NULL. surface_at makes one of a LightSample or an Emission. */
typedef struct {
    KindInfo info;
    Delta delta;                /* not DELTA_NONE: no ray can hit it */
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
    /* The same two for samples that stand beside as many directions by the surface, each weighed by
     * the densities of both: they need not find what those find as well. See light_sample. NULL:
     * no different. */
    bool (*sample_beside)(const Light *l, V3 from, V2 u, LightSample *s);
    float (*pdf_beside)(const Light *l, V3 from, V3 wi, const Surface *hit);
    /* The numbers u by which sample, or sample_beside, gives a direction wi to light from beyond
     * the scene, but for rounding. False, and so for every direction: nobody knows; NULL: too.
     * u NULL: only whether anybody does. */
    bool (*numbers)(const Light *l, bool beside, V3 wi, V2 *u);
    /* Radiance that the light sends along -wi; hit as above. 0 for delta lights. */
    Rgb (*radiance)(const Light *l, V3 wi, const Surface *hit);
    /* Sends a particle: u decides about the place, v about the direction. False: none this time,
     * which counts as one of power 0. */
    bool (*emit)(const Light *l, V2 u, V2 v, Emission *e);
    /* The densities with which `emit` sends a particle from the point `hit` the way d: the same as
     * in Emission, so 1 for what is a delta. d is a way that the light shines. */
    void (*emit_pdf)(const Light *l, const Surface *hit, V3 d, float *pdf_a, float *pdf_w);
    /* Total power, watts (an estimate for textured ones); for selection. */
    Rgb (*power)(const Light *l);
    /* See light_estimate. NULL: a delta light, whose one sample says it all. */
    float (*estimate)(const Light *l, V3 p, V3 n);
    /* Lights beyond the scene. NULL: it is no picture, but what radiance() says. */
    LightPicture (*picture)(const Light *l);
    const LightPlaces *places;  /* NULL: none is a rectangle */
} LightKind;

struct Light {                  /* first member of every concrete light */
    const LightKind *kind;
    uint32_t index;             /* in the scene's lights */
    bool textured;              /* its radiance looks at uv of the surface */
    Place at;
};
extern const LightKind *const lights[];         /* ends with NULL */

INLINE Surface surface_at(V3 p, V3 err, V3 front, V2 uv)
{
    Surface s;
    memset(&s, 0, sizeof s);
    s.p = p;
    s.err = err;
    s.ng = s.ns = front;
    s.uv = uv;
    return s;
}

/* A direction towards the light, and the density of that; `beside`: as many directions go by the
 * surface, and whoever asks weighs both. */
INLINE bool light_sample(const Light *l, bool beside, V3 from, V2 u, LightSample *s)
{
    return beside && l->kind->sample_beside ? l->kind->sample_beside(l, from, u, s)
                                            : l->kind->sample(l, from, u, s);
}
INLINE float light_pdf_w(const Light *l, bool beside, V3 from, V3 wi, const Surface *hit)
{
    return beside && l->kind->pdf_beside ? l->kind->pdf_beside(l, from, wi, hit)
                                         : l->kind->pdf_w(l, from, wi, hit);
}

/* What the light would bring a matt surface at p that looks along n, with nothing in between: a
 * guess at the irradiance, by luminance; n 0: at the light from all round. For choosing among
 * lights, so it is above 0 wherever the light can bring anything at all from above the surface,
 * and finite. */
float light_estimate(const Light *l, V3 p, V3 n);

/* ---- what lights share ---- */

/* A guess at the mean of max(0, n.w) over the directions w to a ball of this radius in the
 * direction and distance of `to`; above 0 unless the ball is surely below the horizon. n 0: 1. */
float estimate_cosine(V3 n, V3 to, float radius);
/* The cosine c, of what may lie `play` of it higher or lower: c where all of that is above the
 * horizon, 0 where all is below, a parabola in between. */
INLINE float estimate_above(float c, float play)
{
    return c >= play ? c : c <= -play ? 0.0f : f_sqr(c + play) / (4.0f * play);
}

/* The frame of a light that has directions of its own, without its scale. False: the transform is
 * no rotation (or mirror image), reported. what: "an infinite light's". */
bool  frame_of_light(const Making *m, const char *what, Affine *to_world, Affine *to_light);
/* From `from` to a light at the point p: all of *s but L. Gives the squared distance; 0: none. */
float sample_at_point(V3 p, V3 from, LightSample *s);
/* To a light beyond the scene: all of *s but wi, pdf_w and L. */
INLINE void sample_beyond(LightSample *s)
{
    s->dist = INFINITY;
    s->p = s->err = s->n = v_all(0.0f);
}
/* A particle of intensity I from the point p. */
void  emit_from_point(V3 p, V3 d, Rgb I, float pdf_w, Emission *e);
/* The sphere that a light beyond the scene shines on. */
typedef struct { V3 centre; float radius; } Stage;
Stage stage_of(const Scene *s);
float stage_pdf_a(const Stage *s);              /* 1 / (pi R^2) */
/* First member of a light that shines from beyond the scene. Its particles go the ways that its
 * samples come from, over the whole stage: these are its emit and emit_pdf. */
typedef struct { Light base; Stage stage; } Beyond;
bool  beyond_emit(const Light *l, V2 u, V2 v, Emission *e);
void  beyond_emit_pdf(const Light *l, const Surface *hit, V3 d, float *pdf_a, float *pdf_w);

/* pdf_w and radiance of lights that no ray can hit: 0. */
float delta_pdf_w(const Light *l, V3 from, V3 wi, const Surface *hit);
Rgb   delta_radiance(const Light *l, V3 wi, const Surface *hit);

/* The factor that gives a light the power (by luminance) wanted; 1 if wanted or its own is 0. */
float power_factor(float wanted, Rgb own);

/* The options of lights at a point whose intensity is I. */
#define INTENSITY_OPTIONS(what)                                                                    \
    { .key = "I", .type = OPT_RGB, .num = 1, .help = what ", W/sr" },                              \
    { .key = "scale", .type = OPT_RGB, .num = 1, .help = "factor of I" },                          \
    { .key = "power", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 1e30,                            \
      .help = "W (by luminance); sets I if above 0" }

/* The sky of a bare mesh: soft light from above, a broad key light on one side. NULL: reported. */
Light *light_studio(const Making *m);

/* ---- cameras: one file a kind; camera.c has the list ----
 *
 * A camera is the sensor of a picture: rays run from its lens, or from its eye where that is a
 * point, to what it sees, and light comes back along them. Its importance We is defined by the
 * measurement that is the mean of all pixels [Veach97 8.3], [PBRT4 16.1], [Cline07 (7.2)]:
 *
 *     mean = integral of We L |cos| over places on the lens and directions,
 *
 * with the cosine at the lens (errata 7.2), so that We |cos| integrates to 1. Places on the picture
 * and on the lens are chosen uniformly and a pixel is the mean over its filter, so We |cos| is the
 * density pdf_a pdf_w of rays. A path that is traced from a light and reaches the lens adds, where
 * filters of a pixel hold its place, (pixels of the picture) times We ... / density to that pixel.
 *
 * Deltas. From a point (`point`) pdf_a is 1 and means a delta in place; where each place looks in
 * one direction only (`parallel`) pdf_w is 1 and means a delta in direction. */

typedef struct {
    float we;
    float pdf_a, pdf_w;         /* densities of the place on the lens, and of the direction at it */
    V2    pixel;                /* where on the picture, in pixels from the top left */
} CameraView;

/* The way from a point of the scene to the camera. */
typedef struct {
    V3    wi;                   /* unit, from the point towards the camera */
    float dist;
    V3    p;                    /* the place on the lens */
    float we;                   /* of the ray from there along -wi */
    float pdf_w;                /* of wi: f |cos| at the point times we / pdf_w is what a path adds.
                                 * 1 where there was no choice but to take it (`parallel`) */
    V2    pixel;
} CameraSample;

typedef struct Camera Camera;
typedef struct {
    KindInfo info;
    size_t bytes;               /* of one, which may be copied: it owns nothing */
    Camera *(*make)(const Making *m, const Opts *o);    /* to_world: camera to world */
    void (*film)(Camera *c, uint32_t w, uint32_t h);    /* the picture's size, before any ray */
    /* The ray through (x, y) in pixels from the top left, lens position u in [0,1)^2. Unit d. */
    Ray (*ray)(const Camera *c, V2 pixel, V2 lens, float time);
    /* What there is to say of a ray from a place on the lens, unit d; also of those that pass by
     * the edges of the picture, where filters reach. False: nothing, it looks elsewhere. */
    bool (*view)(const Camera *c, const Ray *r, CameraView *v);
    /* Chooses a place on the lens for light from a point. False: the camera cannot see it. */
    bool (*sample)(const Camera *c, V3 from, V2 lens, float time, CameraSample *s);
} CameraKind;

struct Camera {                 /* first member of every concrete camera */
    const CameraKind *kind;
    Affine  to_world, to_camera;        /* of one that moves: at time 0 */
    const Motion *motion;       /* in the scene's arena; NULL: it stands still */
    double  shutter[2];         /* opens and closes; in the units of the scene's `times` */
    bool    has_lens;           /* `lens` matters: a pinhole needs no number drawn for it */
    bool    point, parallel;    /* deltas, see above */
};
extern const CameraKind *const cameras[];       /* ends with NULL */

/* ---- the scene ---- */

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

/* light.h -- what sends light: one file a kind, of which light.c has the list. */
#ifndef SCENE_LIGHT_H
#define SCENE_LIGHT_H

#include "geometry/geometry.h"
#include "image/image.h"
#include "scene/making.h"

#include <string.h>

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

#endif

/* bsdf.h -- how a point of a surface scatters light. One file a model; bsdf.c has the list.
 *
 * Conventions, said once: directions wo (towards the viewer) and wi (towards the light) are unit,
 * point away from the surface, and are given in the local frame whose z axis is the shading normal.
 * f never contains the cosine. pdf_w is per solid angle of wi. A model scatters RADIANCE by eval
 * and sample: light comes from wi and leaves along wo; where transport is not symmetric (crossing
 * an interface) `importance` asks for the adjoint. */
#ifndef BSDF_BSDF_H
#define BSDF_BSDF_H

#include "base/kind.h"
#include "base/options.h"
#include "base/vec.h"

typedef struct Bsdf Bsdf;

enum {                          /* what a model can do; BsdfSample.flags has those of the event */
    BSDF_REFLECT  = 1,
    BSDF_TRANSMIT = 2,
    BSDF_SPECULAR = 4,          /* delta: eval and pdf are 0, only sample finds it */
    BSDF_SMOOTH   = 8,          /* not delta: eval and pdf are meaningful */
    BSDF_LOBES    = 16,         /* sample chooses between parts by `lobe` */
    BSDF_TANGENT  = 32,         /* differs along the two tangents: x is that along which u grows */
    BSDF_MATT     = 64          /* of smooth events: drawn from the part that has no lobe about a
                                 * reflection or refraction. Methods that follow no diffuse light
                                 * let such paths end; measured models do not say it */
};

typedef struct {
    V3    wi;
    Rgb   weight;               /* f |cos| / pdf_w; for delta events the limit of that */
    float pdf_w;                /* 0 for delta events */
    int   flags;
    float eta;                  /* index ratio crossed, transmitted over incident side; else 1 */
} BsdfSample;

enum { BSDF_OPTIONS = 16 };     /* most that a model may have */
enum { BSDF_DELTAS = 16 };      /* most that a model may have: two of each of its parts */

/* Where load() finds files: names are as seen from the file that names them. */
typedef struct { const char *beside; uint64_t max_file; } BsdfFiles;

typedef struct {
    KindInfo info;              /* options: the model's parameters, RGB and FLOAT take textures */
    int flags;                  /* union of what its instances can do */

    /* Reads what options that are no numbers name (files, lists) into *data, which belongs to the
     * material: once, when it is made. False: reported. NULL: there is nothing of the kind. */
    bool (*load)(const Opts *o, const BsdfFiles *files, void **data);
    void (*drop)(void *data);

    /* Makes the model at a point out of its parameters, value[k] for option k (numbers in .r), and
     * what load() made (else NULL), in *b, which has room for any. b->flags are those of the kind;
     * what this one cannot do is taken away. Called by bsdf_make. */
    void (*setup)(Bsdf *b, const Rgb *value, const void *data);

    /* f(wo, wi) without delta parts. */
    Rgb (*eval)(const Bsdf *b, V3 wo, V3 wi, bool importance);
    float (*pdf_w)(const Bsdf *b, V3 wo, V3 wi);
    /* lobe chooses between parts of the model, u the direction. False: absorbed. */
    bool (*sample)(const Bsdf *b, V3 wo, float lobe, V2 u, bool importance, BsdfSample *s);
    /* All delta events for wo, of radiance, and how many: for methods that follow each of them. The
     * weight is f |cos| in the limit, not over the chance with which `sample` takes the event, so
     * the means are the same. NULL: the model has none. */
    int (*deltas)(const Bsdf *b, V3 wo, BsdfSample s[BSDF_DELTAS]);
    /* Directional albedo for wo, or a close estimate of it: for roulette and AOVs, not exact. */
    Rgb (*albedo)(const Bsdf *b, V3 wo);
    /* Directions wi around which f is large (at most 16), and how many. [Cline07 5.2.2] */
    int (*peaks)(const Bsdf *b, V3 wo, V3 peak[16]);
} BsdfKind;

struct Bsdf {
    const BsdfKind *kind;
    int flags;                  /* what this one can do */
    union { float number[24]; const void *align; } as;  /* the model's own, see its file */
};

/* What a point's model is made in: itself first; a mixture finds its parts behind it. */
enum { BSDF_PARTS = 8 };
typedef struct { Bsdf b[BSDF_PARTS]; } BsdfRoom;

extern const BsdfKind *const bsdfs[];           /* ends with NULL */

INLINE void bsdf_make(Bsdf *b, const BsdfKind *kind, const Rgb *value, const void *data)
{
    b->kind = kind;
    b->flags = kind->flags;
    kind->setup(b, value, data);
}
INLINE int bsdf_deltas(const Bsdf *b, V3 wo, BsdfSample s[BSDF_DELTAS])
{
    return b->flags & BSDF_SPECULAR ? b->kind->deltas(b, wo, s) : 0;
}
/* Gives a mixture, made before, its two parts, which are borrowed. Without them it is black. */
void mix_parts(Bsdf *b, const Bsdf *first, const Bsdf *second);
extern const BsdfKind bsdf_mix;
/* For methods that know what matt surfaces do: f is constant on either side. */
extern const BsdfKind bsdf_diffuse;

INLINE bool same_side(V3 a, V3 b) { return a.z * b.z > 0.0f; }

/* ---- for the models ---- */

INLINE BsdfSample delta_event(V3 wi, Rgb weight, int side, float eta)
{
    return (BsdfSample){ wi, weight, 0.0f, side | BSDF_SPECULAR, eta };
}
/* Ends the sampling of s->wi, which is above, for a wo of either side, where f and pdf_w are. */
INLINE bool smooth_event(BsdfSample *s, V3 wo, Rgb f, float pdf_w, bool matt)
{
    if (!(pdf_w > 0.0f))
        return false;
    s->pdf_w = pdf_w;
    s->weight = rgb_scale(f, s->wi.z / pdf_w);
    s->flags = BSDF_REFLECT | BSDF_SMOOTH | (matt ? BSDF_MATT : 0);
    s->eta = 1.0f;
    if (wo.z < 0.0f)
        s->wi.z = -s->wi.z;
    return true;
}

/* Exponents of cosine lobes: the lobe is then as wide as 1e4 roundings of a direction. */
#define BSDF_SHARPEST 1e6f

/* 1 / |w| of a unit vector, whose length is off by roundings: to the second order in those. */
INLINE double unit_factor(V3 w)
{
    return 1.5 - 0.5 * ((double)w.x * w.x + (double)w.y * w.y + (double)w.z * w.z);
}

INLINE V3 mirror_z(V3 w) { return (V3){ -w.x, -w.y, w.z }; }
/* The normal on the side of w. */
INLINE V3 normal_z(V3 w) { return (V3){ 0.0f, 0.0f, w.z < 0.0f ? -1.0f : 1.0f }; }
INLINE V3 above(V3 w) { return (V3){ w.x, w.y, fabsf(w.z) }; }   /* reflective models: both sides */
INLINE Rgb reflectance_of(Rgb value)                /* a texture may leave [0,1] */
{
    return (Rgb){ clamp01(value.r), clamp01(value.g), clamp01(value.b) };
}
/* Those of two parts, taken down together where they would be more than 1. */
INLINE void reflectances_of(const Rgb value[2], Rgb *first, Rgb *second)
{
    Rgb a = reflectance_of(value[0]), b = reflectance_of(value[1]), sum = rgb_add(a, b);
    Rgb scale = { 1.0f / f_max(1.0f, sum.r), 1.0f / f_max(1.0f, sum.g), 1.0f / f_max(1.0f, sum.b) };

    *first = rgb_mul(a, scale);
    *second = rgb_mul(b, scale);
}
Rgb   bsdf_eval_none(const Bsdf *b, V3 wo, V3 wi, bool importance);      /* of delta models */
float bsdf_pdf_none(const Bsdf *b, V3 wo, V3 wi);
/* The normal and the mirror image of wo: of a matt part with a lobe. */
int   bsdf_matt_lobe_peaks(const Bsdf *b, V3 wo, V3 peak[16]);

#endif

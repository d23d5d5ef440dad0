/* mirror.c -- a perfect mirror, on both sides, with the same reflectance at every angle. */
#include "bsdf/bsdf.h"

typedef struct { Rgb reflectance; } Mirror;

static const Mirror *of(const Bsdf *b) { return (const Mirror *)(const void *)b->as.number; }

static void setup(Bsdf *b, const Rgb *value, const void *data)
{
    Mirror *m = (Mirror *)(void *)b->as.number;
    (void)data;
    m->reflectance = reflectance_of(value[0]);
}

static bool sample(const Bsdf *b, V3 wo, float lobe, V2 u, bool importance, BsdfSample *s)
{
    (void)lobe, (void)u, (void)importance;
    *s = delta_event(mirror_z(wo), of(b)->reflectance, BSDF_REFLECT, 1.0f);
    return wo.z != 0.0f;
}

static int deltas(const Bsdf *b, V3 wo, BsdfSample s[BSDF_DELTAS])
{
    return sample(b, wo, 0.0f, (V2){ 0, 0 }, false, s);
}

static Rgb albedo(const Bsdf *b, V3 wo)
{
    (void)wo;
    return of(b)->reflectance;
}

static int peaks(const Bsdf *b, V3 wo, V3 peak[16])
{
    (void)b;
    peak[0] = mirror_z(wo);
    return 1;
}

static const OptDef options[] = {
    { .key = "reflectance", .type = OPT_RGB, .num = 0.9, .lo = 0, .hi = 1, .also = "Kr",
      .help = "part of the light that is reflected" },
    { .key = NULL }
};

const BsdfKind bsdf_mirror = {
    .info = { "mirror", "Shirley91 5.3", "perfect mirror of one colour", options },
    .flags = BSDF_REFLECT | BSDF_SPECULAR,
    .setup = setup, .eval = bsdf_eval_none, .pdf_w = bsdf_pdf_none,
    .sample = sample, .deltas = deltas, .albedo = albedo, .peaks = peaks
};

/* diffuse.c -- a matt surface: the same radiance in every direction, on both sides.
 *
 * Source  [Lambert1760]: f = reflectance / pi. Sampled in proportion to the cosine, so that the
 *         weight of a sample is the reflectance itself. */
#include "bsdf/bsdf.h"
#include "sampling/warp.h"

typedef struct { Rgb reflectance; } Diffuse;

static const Diffuse *of(const Bsdf *b) { return (const Diffuse *)(const void *)b->as.number; }

static void setup(Bsdf *b, const Rgb *value, const void *data)
{
    Diffuse *d = (Diffuse *)(void *)b->as.number;
    (void)data;
    d->reflectance = reflectance_of(value[0]);
}

static Rgb eval(const Bsdf *b, V3 wo, V3 wi, bool importance)
{
    (void)importance;
    return same_side(wo, wi) ? rgb_scale(of(b)->reflectance, INV_PI) : rgb_all(0.0f);
}

static float pdf_w(const Bsdf *b, V3 wo, V3 wi)
{
    (void)b;
    return same_side(wo, wi) ? warp_cosine_pdf(fabsf(wi.z)) : 0.0f;
}

static bool sample(const Bsdf *b, V3 wo, float lobe, V2 u, bool importance, BsdfSample *s)
{
    (void)lobe, (void)importance;
    s->wi = warp_cosine(u);
    s->pdf_w = warp_cosine_pdf(s->wi.z);
    if (wo.z < 0.0f)
        s->wi.z = -s->wi.z;
    s->weight = of(b)->reflectance;
    s->flags = BSDF_REFLECT | BSDF_SMOOTH | BSDF_MATT;
    s->eta = 1.0f;
    return same_side(wo, s->wi);
}

static Rgb albedo(const Bsdf *b, V3 wo)
{
    (void)wo;
    return of(b)->reflectance;
}

static int peaks(const Bsdf *b, V3 wo, V3 peak[16])
{
    (void)b;
    peak[0] = normal_z(wo);
    return 1;
}

static const OptDef options[] = {
    { .key = "reflectance", .type = OPT_RGB, .num = 0.5, .lo = 0, .hi = 1, .also = "Kd",
      .help = "part of the light that is reflected" },
    { .key = NULL }
};

const BsdfKind bsdf_diffuse = {
    .info = { "diffuse", "Lambert1760; Cline07 5.2.2", "matt: the same in every direction",
              options },
    .flags = BSDF_REFLECT | BSDF_SMOOTH | BSDF_MATT,
    .setup = setup, .eval = eval, .pdf_w = pdf_w, .sample = sample, .albedo = albedo, .peaks = peaks
};

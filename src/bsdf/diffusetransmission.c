/* diffusetransmission.c -- a thin matt sheet: light is spread over both sides. Leaves, paper, lamp
 * shades.
 *
 * Source  [Lambert1760], on either side with a colour of its own: f = reflectance / pi on the side
 *         of the viewer, transmittance / pi on the other. Where they add up to more than 1, both
 *         are scaled down until they do not. */
#include "bsdf/bsdf.h"
#include "sampling/warp.h"

typedef struct {
    Rgb   reflectance, transmittance;
    float reflects;             /* probability of sampling the side of the viewer */
} Sheet;

static const Sheet *of(const Bsdf *b) { return (const Sheet *)(const void *)b->as.number; }

static void setup(Bsdf *b, const Rgb *value, const void *data)
{
    Sheet *s = (Sheet *)(void *)b->as.number;
    float lr, lt;

    (void)data;
    reflectances_of(value, &s->reflectance, &s->transmittance);
    lr = rgb_lum(s->reflectance);
    lt = rgb_lum(s->transmittance);
    s->reflects = lt > 0.0f ? lr / (lr + lt) : 1.0f;
}

static Rgb eval(const Bsdf *b, V3 wo, V3 wi, bool importance)
{
    (void)importance;
    if (wo.z * wi.z == 0.0f)
        return rgb_all(0.0f);
    return rgb_scale(same_side(wo, wi) ? of(b)->reflectance : of(b)->transmittance, INV_PI);
}

static float pdf_w(const Bsdf *b, V3 wo, V3 wi)
{
    float p = of(b)->reflects;
    if (wo.z * wi.z == 0.0f)
        return 0.0f;
    return warp_cosine_pdf(fabsf(wi.z)) * (same_side(wo, wi) ? p : 1.0f - p);
}

static bool sample(const Bsdf *b, V3 wo, float lobe, V2 u, bool importance, BsdfSample *s)
{
    const Sheet *sheet = of(b);
    bool reflects = lobe < sheet->reflects;
    float p = reflects ? sheet->reflects : 1.0f - sheet->reflects;

    (void)importance;
    s->wi = warp_cosine(u);
    s->pdf_w = warp_cosine_pdf(s->wi.z) * p;
    if ((wo.z < 0.0f) == reflects)
        s->wi.z = -s->wi.z;
    s->weight = rgb_scale(reflects ? sheet->reflectance : sheet->transmittance, 1.0f / p);
    s->flags = (reflects ? BSDF_REFLECT : BSDF_TRANSMIT) | BSDF_SMOOTH | BSDF_MATT;
    s->eta = 1.0f;
    return wo.z * s->wi.z != 0.0f;
}

static Rgb albedo(const Bsdf *b, V3 wo)
{
    (void)wo;
    return rgb_add(of(b)->reflectance, of(b)->transmittance);
}

static int peaks(const Bsdf *b, V3 wo, V3 peak[16])
{
    (void)b, (void)wo;
    peak[0] = v3(0.0f, 0.0f, 1.0f);
    peak[1] = v3(0.0f, 0.0f, -1.0f);
    return 2;
}

static const OptDef options[] = {
    { .key = "reflectance", .type = OPT_RGB, .num = 0.25, .lo = 0, .hi = 1, .also = "Kd",
      .help = "part of the light that is sent back" },
    { .key = "transmittance", .type = OPT_RGB, .num = 0.25, .lo = 0, .hi = 1,
      .help = "part of the light that passes" },
    { .key = NULL }
};

const BsdfKind bsdf_diffusetransmission = {
    .info = { "diffusetransmission", "Lambert1760; Cline07 5.2.2",
              "a thin matt sheet, lit from both sides: leaves, paper", options },
    .flags = BSDF_REFLECT | BSDF_TRANSMIT | BSDF_SMOOTH | BSDF_LOBES | BSDF_MATT,
    .setup = setup, .eval = eval, .pdf_w = pdf_w, .sample = sample, .albedo = albedo, .peaks = peaks
};

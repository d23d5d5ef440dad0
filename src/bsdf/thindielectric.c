/* thindielectric.c -- a pane of glass so thin that its two surfaces are one: reflects, and lets
 * light pass straight on.
 *
 * Source  [PBRT4 9.5.1]: with R of one surface, the light that runs to and fro inside adds up to
 *           R' = R + T^2 R / (1 - R^2) = 2 R / (1 + R),
 *         and 1 - R' passes. Both sides are in one medium: nothing scales, all is symmetric. */
#include "bsdf/bsdf.h"
#include "bsdf/fresnel.h"

typedef struct { Rgb reflectance, transmittance; float eta; } Pane;

static const Pane *of(const Bsdf *b) { return (const Pane *)(const void *)b->as.number; }

static void setup(Bsdf *b, const Rgb *value, const void *data)
{
    Pane *p = (Pane *)(void *)b->as.number;
    (void)data;
    p->eta = f_min(f_max(value[0].r, 1.0f), 10.0f);
    p->reflectance = reflectance_of(value[1]);
    p->transmittance = reflectance_of(value[2]);
}

static float reflected(const Pane *p, V3 wo)
{
    double R = fresnel_dielectric(f_min(fabsf(wo.z), 1.0f), p->eta);
    return (float)(2.0 * R / (1.0 + R));
}

static bool sample(const Bsdf *b, V3 wo, float lobe, V2 u, bool importance, BsdfSample *s)
{
    const Pane *p = of(b);
    float F = reflected(p, wo);
    float R = F * rgb_lum(p->reflectance), T = (1.0f - F) * rgb_lum(p->transmittance);

    (void)u, (void)importance;
    if (wo.z == 0.0f || !(R + T > 0.0f))
        return false;
    if (lobe * (R + T) < R)
        *s = delta_event(mirror_z(wo), rgb_scale(p->reflectance, F * ((R + T) / R)), BSDF_REFLECT,
                         1.0f);
    else
        *s = delta_event(v_neg(wo), rgb_scale(p->transmittance, (1.0f - F) * ((R + T) / T)),
                         BSDF_TRANSMIT, 1.0f);
    return true;
}

static int deltas(const Bsdf *b, V3 wo, BsdfSample s[BSDF_DELTAS])
{
    const Pane *p = of(b);
    float F = reflected(p, wo);

    if (wo.z == 0.0f)
        return 0;
    s[0] = delta_event(mirror_z(wo), rgb_scale(p->reflectance, F), BSDF_REFLECT, 1.0f);
    s[1] = delta_event(v_neg(wo), rgb_scale(p->transmittance, 1.0f - F), BSDF_TRANSMIT, 1.0f);
    return 2;
}

static Rgb albedo(const Bsdf *b, V3 wo)
{
    const Pane *p = of(b);
    float F = reflected(p, wo);
    return rgb_add(rgb_scale(p->reflectance, F), rgb_scale(p->transmittance, 1.0f - F));
}

static int peaks(const Bsdf *b, V3 wo, V3 peak[16])
{
    (void)b;
    peak[0] = mirror_z(wo);
    peak[1] = v_neg(wo);
    return 2;
}

static const OptDef options[] = {
    { .key = "eta", .type = OPT_FLOAT, .num = 1.5, .lo = 1, .hi = 10, .also = "index",
      .help = "index of refraction of the pane over that around it" },
    { .key = "reflectance", .type = OPT_RGB, .num = 1, .lo = 0, .hi = 1, .also = "Kr",
      .help = "tint of what is reflected" },
    { .key = "transmittance", .type = OPT_RGB, .num = 1, .lo = 0, .hi = 1, .also = "Kt",
      .help = "tint of what passes" },
    { .key = NULL }
};

const BsdfKind bsdf_thindielectric = {
    .info = { "thindielectric", "PBRT4 9.5.1; Born99 1.5.2",
              "a thin pane of glass: reflects and lets pass", options },
    .flags = BSDF_REFLECT | BSDF_TRANSMIT | BSDF_SPECULAR | BSDF_LOBES,
    .setup = setup, .eval = bsdf_eval_none, .pdf_w = bsdf_pdf_none,
    .sample = sample, .deltas = deltas, .albedo = albedo, .peaks = peaks
};

/* blinn.c -- a matt surface with a glossy lobe of facets whose normals follow a cosine power, both
 * sides: the microfacet model as it was first drawn.
 *
 * Source  [Blinn77], of Torrance and Sparrow: with h half-way between wo and wi,
 *           f = kd/pi + ks F(c) D(h) G / (4 zo zi),  c = h.wo,
 *           D = (n + 2) / (2 pi) hz^n,  G = min(1, 2 hz zo / c, 2 hz zi / c),
 *         the facets being the sides of long grooves. D is normalised so that the facets cover the
 *         surface once: the lobe then returns at most what it gets. F is 1, or Fresnel's for an
 *         index, see fresnel.h. h is sampled with density (n + 1) / (2 pi) hz^n.
 *
 * Roughness in the sense of [Cline07 5.4] is 1/n. Where kd + ks passes 1, both are scaled down
 * until it does not. */
#include "bsdf/bsdf.h"
#include "bsdf/fresnel.h"
#include "bsdf/half.h"

typedef struct {
    Rgb   diffuse, specular;
    float exponent, eta;        /* eta 0: F is 1 */
    float glossy;               /* probability of sampling the lobe */
} Blinn;

static const Blinn *of(const Bsdf *b) { return (const Blinn *)(const void *)b->as.number; }

static void setup(Bsdf *b, const Rgb *value, const void *data)
{
    Blinn *p = (Blinn *)(void *)b->as.number;
    float ld, ls;

    (void)data;
    reflectances_of(value, &p->diffuse, &p->specular);
    p->exponent = f_min(f_max(value[2].r, 0.0f), BSDF_SHARPEST);
    p->eta = value[3].r >= 1.0f ? f_min(value[3].r, 10.0f) : 0.0f;
    ld = rgb_lum(p->diffuse);
    ls = rgb_lum(p->specular) * (p->eta > 0.0f ? 0.2f : 1.0f);  /* F is small most of the way */
    p->glossy = ls > 0.0f ? ls / (ld + ls) : 0.0f;
}

/* hz^n / (2 pi), for directions above the surface. */
static double power_of(const Blinn *p, const Half *h)
{
    if (!(h->z > 0.0))
        return 0.0;
    return 0.5 / PI * md_pow(h->z * h->z / h->length2, 0.5 * p->exponent);
}

/* G / (zo zi) is the smallest of 1 / (zo zi), 2 hz / (c zi) and 2 hz / (c zo), so one of those two:
 * hz of the unit h is (zo + zi) / 2c. */
static Rgb f_of(const Blinn *p, V3 wo, V3 wi, const Half *h, double power)
{
    double F = p->eta > 0.0f ? fresnel_dielectric(d_min(h->cosine, 1.0), p->eta) : 1.0;
    double most = d_max(d_max(wo.z, wi.z), 1e-12), least = d_max(d_min(wo.z, wi.z), 1e-12);
    double shade = h->z / (h->cosine * h->cosine * most);       /* G / (zo zi), in shadow */

    shade = d_min(1.0 / (most * least), shade);
    return rgb_add(rgb_scale(p->diffuse, INV_PI),
                   rgb_scale(p->specular,
                             (float)d_min(0.25 * F * (p->exponent + 2.0) * power * shade, 1e30)));
}

static float pdf_of(const Blinn *p, V3 wi, const Half *h, double power)
{
    return (1.0f - p->glossy) * warp_cosine_pdf(wi.z) +
           p->glossy * (float)(0.25 * (p->exponent + 1.0) * power / h->cosine);
}

static Rgb eval(const Bsdf *b, V3 wo, V3 wi, bool importance)
{
    Half h;
    (void)importance;
    if (!same_side(wo, wi))
        return rgb_all(0.0f);
    wo = above(wo);
    wi = above(wi);
    h = half_of(wo, wi);
    return f_of(of(b), wo, wi, &h, power_of(of(b), &h));
}

static float pdf_w(const Bsdf *b, V3 wo, V3 wi)
{
    Half h;
    if (!same_side(wo, wi))
        return 0.0f;
    h = half_of(above(wo), above(wi));
    return pdf_of(of(b), above(wi), &h, power_of(of(b), &h));
}

static V3 reflected(const Blinn *p, V3 wo, V2 u)
{
    double rest, down, sine;
    V2 c = circle_and(u, &rest);
    down = 1.0 - md_pow(rest, 1.0 / (p->exponent + 1.0));
    sine = sqrt(down * (2.0 - down));
    return half_reflect(wo, sine * c.x, sine * c.y, 1.0 - down);
}

static bool sample(const Bsdf *b, V3 wo, float lobe, V2 u, bool importance, BsdfSample *s)
{
    const Blinn *p = of(b);
    V3 up = above(wo);
    Half h;
    double power;
    bool matt = !(lobe < p->glossy);

    (void)importance;
    s->wi = !matt ? reflected(p, up, u) : warp_cosine(u);
    if (!same_side(up, s->wi))
        return false;
    h = half_of(up, s->wi);
    power = power_of(p, &h);
    return smooth_event(s, wo, f_of(p, up, s->wi, &h, power), pdf_of(p, s->wi, &h, power), matt);
}

/* The lobe's without Fresnel is a fit; Fresnel's cosine is that of facets that turn to the eye. */
static Rgb albedo(const Bsdf *b, V3 wo)
{
    const Blinn *p = of(b);
    float z = f_min(fabsf(wo.z), 1.0f), wide = 1.0f / sqrtf(p->exponent + 1.0f);
    float keeps = 1.0f - 0.625f * m_pow(0.8f, p->exponent) * z;
    if (p->eta > 0.0f)
        keeps *= (float)fresnel_dielectric(z + (1.0f - z) * 0.5f * wide, p->eta);
    return rgb_add(p->diffuse, rgb_scale(p->specular, keeps));
}

static const OptDef options[] = {
    { .key = "reflectance", .type = OPT_RGB, .num = 0.5, .lo = 0, .hi = 1, .also = "Kd",
      .help = "part of the light that is reflected in every direction" },
    { .key = "specular", .type = OPT_RGB, .num = 0.25, .lo = 0, .hi = 1, .also = "Ks",
      .help = "part of the light that facets reflect, where Fresnel lets them" },
    { .key = "exponent", .type = OPT_FLOAT, .num = 50, .lo = 0, .hi = 1e6, .also = "Ns",
      .help = "of the facets' cosine: sharpness of the lobe" },
    { .key = "eta", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 10, .also = "index",
      .help = "index of refraction of the facets; below 1: they reflect alike at every angle" },
    { .key = NULL }
};

const BsdfKind bsdf_blinn = {
    .info = { "blinn", "Blinn77; Cline07 5.2.2", "matt with a glossy lobe of facets", options },
    .flags = BSDF_REFLECT | BSDF_SMOOTH | BSDF_LOBES | BSDF_MATT,
    .setup = setup, .eval = eval, .pdf_w = pdf_w, .sample = sample, .albedo = albedo,
    .peaks = bsdf_matt_lobe_peaks
};

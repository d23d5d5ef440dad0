/* ward.c -- a matt surface with a glossy lobe that may be stretched along a tangent, as on brushed
 * metal or varnished wood. Both sides.
 *
 * Source  [Ward92], in the form of [Geisler10], which is reciprocal and whose albedo is at most the
 *         part `specular` from every direction. With h = wo + wi, not made unit,
 *           f = kd/pi + ks / (pi ax ay) exp(-((hx/ax)^2 + (hy/ay)^2) / hz^2) h.h / hz^4.
 *         The slopes hx/hz, hy/hz of half vectors are sampled from the Gaussian [Ward92];
 *         density of wi: exp(...) / (4 pi ax ay h.wo hz^3) with h unit.
 *
 * Ward's own form divides by sqrt(zo zi) instead and loses light at grazing angles; that of Duer,
 * by zo zi, makes some. ax and ay are standard deviations of the slope times sqrt 2. Where kd + ks
 * passes 1, both are scaled down until it does not. */
#include "bsdf/bsdf.h"
#include "bsdf/ggx.h"
#include "bsdf/half.h"

typedef struct {
    Rgb   diffuse, specular;
    float ax, ay;
    float glossy;               /* probability of sampling the lobe */
} Ward;

static const Ward *of(const Bsdf *b) { return (const Ward *)(const void *)b->as.number; }

static void setup(Bsdf *b, const Rgb *value, const void *data)
{
    Ward *w = (Ward *)(void *)b->as.number;
    float u = value[3].r < 0.0f ? value[2].r : value[3].r;
    float v = value[4].r < 0.0f ? value[2].r : value[4].r, ld, ls;

    (void)data;
    reflectances_of(value, &w->diffuse, &w->specular);
    w->ax = f_min(f_max(u, GGX_SMOOTHEST), 1.0f);
    w->ay = f_min(f_max(v, GGX_SMOOTHEST), 1.0f);
    ld = rgb_lum(w->diffuse);
    ls = rgb_lum(w->specular);
    w->glossy = ls > 0.0f ? ls / (ld + ls) : 0.0f;
    if (w->ax == w->ay)
        b->flags &= ~BSDF_TANGENT;
}

/* The Gaussian over pi ax ay hz^4, for directions above the surface. */
static double lobe_of(const Ward *w, const Half *h)
{
    double x = h->x / w->ax, y = h->y / w->ay, z2 = h->z * h->z;
    if (!(h->z > 1e-15))                        /* hz^4 is a number yet */
        return 0.0;
    return md_exp(-(x * x + y * y) / z2) / (PI * w->ax * w->ay * z2 * z2);
}

static Rgb f_of(const Ward *w, const Half *h, double lobe)
{
    return rgb_add(rgb_scale(w->diffuse, INV_PI),
                   rgb_scale(w->specular, (float)d_min(lobe * h->length2, 1e30)));
}

/* exp / (4 pi ax ay (h.wo) hz^3) of the unit h is lobe hz |h|^2 / 2. */
static float pdf_of(const Ward *w, V3 wi, const Half *h, double lobe)
{
    return (1.0f - w->glossy) * warp_cosine_pdf(wi.z) +
           w->glossy * (float)d_min(0.5 * lobe * h->z * h->length2, 1e30);
}

static Rgb eval(const Bsdf *b, V3 wo, V3 wi, bool importance)
{
    Half h;
    (void)importance;
    if (!same_side(wo, wi))
        return rgb_all(0.0f);
    h = half_of(above(wo), above(wi));
    return f_of(of(b), &h, lobe_of(of(b), &h));
}

static float pdf_w(const Bsdf *b, V3 wo, V3 wi)
{
    Half h;
    if (!same_side(wo, wi))
        return 0.0f;
    h = half_of(above(wo), above(wi));
    return pdf_of(of(b), above(wi), &h, lobe_of(of(b), &h));
}

static V3 reflected(const Ward *w, V3 wo, V2 u)
{
    double rest, far;
    V2 c = circle_and(u, &rest);
    far = sqrt(-md_log(rest));
    return half_reflect(wo, w->ax * far * c.x, w->ay * far * c.y, 1.0);
}

static bool sample(const Bsdf *b, V3 wo, float lobe, V2 u, bool importance, BsdfSample *s)
{
    const Ward *w = of(b);
    V3 up = above(wo);
    Half h;
    double gloss;
    bool matt = !(lobe < w->glossy);

    (void)importance;
    s->wi = !matt ? reflected(w, up, u) : warp_cosine(u);
    if (!same_side(up, s->wi))
        return false;
    h = half_of(up, s->wi);
    gloss = lobe_of(w, &h);
    return smooth_event(s, wo, f_of(w, &h, gloss), pdf_of(w, s->wi, &h, gloss), matt);
}

/* The lobe's is a fit: a wide one sends light below the surface, but little from grazing eyes. */
static Rgb albedo(const Bsdf *b, V3 wo)
{
    const Ward *w = of(b);
    float a2 = w->ax * w->ax + w->ay * w->ay, z = f_min(fabsf(wo.z), 1.0f);
    float top = 1.0f / (1.0f + 0.6f * a2 + 0.12f * a2 * a2), grazing = f_sqr(f_sqr(1.0f - z));
    return rgb_add(w->diffuse, rgb_scale(w->specular, top + (0.9f - top) * grazing));
}

static int peaks(const Bsdf *b, V3 wo, V3 peak[16])
{
    Ggx g = { of(b)->ax, of(b)->ay };
    peak[0] = normal_z(wo);
    return 1 + ggx_peaks(g, wo, peak + 1);
}

static const OptDef options[] = {
    { .key = "reflectance", .type = OPT_RGB, .num = 0.5, .lo = 0, .hi = 1, .also = "Kd",
      .help = "part of the light that is reflected in every direction" },
    { .key = "specular", .type = OPT_RGB, .num = 0.25, .lo = 0, .hi = 1, .also = "Ks",
      .help = "part of the light that the lobe reflects, at most" },
    { .key = "roughness", .type = OPT_FLOAT, .num = 0.15, .lo = 0, .hi = 1, .also = "alpha",
      .help = "width of the lobe in the slope of facets" },
    { .key = "uroughness", .type = OPT_FLOAT, .num = -1, .lo = -1, .hi = 1, .also = "alphax",
      .help = "along the first tangent; below 0: as roughness" },
    { .key = "vroughness", .type = OPT_FLOAT, .num = -1, .lo = -1, .hi = 1, .also = "alphay",
      .help = "along the second tangent; below 0: as roughness" },
    { .key = NULL }
};

const BsdfKind bsdf_ward = {
    .info = { "ward", "Ward92; Geisler10; Cline07 5.2.2",
              "matt with a glossy lobe that may be stretched: brushed metal", options },
    .flags = BSDF_REFLECT | BSDF_SMOOTH | BSDF_LOBES | BSDF_TANGENT | BSDF_MATT,
    .setup = setup, .eval = eval, .pdf_w = pdf_w, .sample = sample, .albedo = albedo, .peaks = peaks
};

/* ashikhminshirley.c -- a matt surface under a glossy one, by Fresnel: the less the lobe reflects,
 * the more light reaches what is below. The lobe may be stretched along a tangent. Both sides.
 *
 * Source  [Ashikhmin00 (3), (4), (5)]: with h half-way between wo and wi, c = h.wo and hz = h.n,
 *           f_s = sqrt((nu + 1)(nv + 1)) / (8 pi) hz^e F(c) / (c max(zo, zi)),
 *           e = (nu hx^2 + nv hy^2) / (hx^2 + hy^2),  F(c) = Rs + (1 - Rs)(1 - c)^5,
 *           f_d = 28 Rd / (23 pi) (1 - Rs) B(zo) B(zi),  B(z) = 1 - (1 - z/2)^5.
 *         h is sampled with density sqrt((nu + 1)(nv + 1)) / (2 pi) hz^e [(6), (9), (10)].
 *
 * Departs The exponents may also be given as roughness: n = 2 / alpha^2 - 2 makes a lobe as wide
 *         as that of facets with this alpha. Energy is at most 1, as there (the tests look). */
#include "bsdf/bsdf.h"
#include "bsdf/ggx.h"
#include "bsdf/half.h"

typedef struct {
    Rgb   below, Rs;            /* 28 Rd (1 - Rs) / 23 pi */
    float nu, nv, norm;         /* norm: sqrt((nu + 1)(nv + 1)) / (8 pi) */
} Blend;

static const Blend *of(const Bsdf *b) { return (const Blend *)(const void *)b->as.number; }

/* The exponent, from roughness unless that is below 0. */
static float exponent_of(float n, float roughness, float both, bool remap)
{
    if (roughness >= 0.0f || both >= 0.0f)
        n = 2.0f / f_sqr(f_max(ggx_alpha(roughness, both, remap), GGX_SMOOTHEST)) - 2.0f;
    return f_min(f_max(n, 0.0f), BSDF_SHARPEST);
}

static void setup(Bsdf *b, const Rgb *value, const void *data)
{
    Blend *s = (Blend *)(void *)b->as.number;
    Rgb Rd = reflectance_of(value[0]);
    bool remap = value[7].r != 0.0f;

    (void)data;
    s->Rs = reflectance_of(value[1]);
    s->nu = exponent_of(value[2].r, value[5].r, value[4].r, remap);
    s->nv = exponent_of(value[3].r, value[6].r, value[4].r, remap);
    s->norm = sqrtf((s->nu + 1.0f) * (s->nv + 1.0f)) * (0.125f * INV_PI);
    s->below = rgb_scale(rgb_mul(Rd, rgb_sub(rgb_all(1.0f), s->Rs)), 28.0f / 23.0f * INV_PI);
    if (s->nu == s->nv)
        b->flags &= ~BSDF_TANGENT;
}

/* norm hz^e / c, for directions above the surface. */
static double lobe_of(const Blend *s, const Half *h)
{
    double r2 = h->x * h->x + h->y * h->y, e;
    if (!(h->z > 0.0))
        return 0.0;
    e = r2 > 0.0 ? (s->nu * h->x * h->x + s->nv * h->y * h->y) / r2 : 0.0;
    return s->norm * md_pow(h->z * h->z / h->length2, 0.5 * e) / h->cosine;
}

static float matt(float z) { return 1.0f - (float)schlick5(0.5 * z); }

static Rgb f_of(const Blend *s, V3 wo, V3 wi, const Half *h, double lobe)
{
    float F = (float)schlick5(h->cosine), gloss = (float)(lobe / f_max(f_max(wo.z, wi.z), 1e-12f));
    Rgb fresnel = rgb_add(s->Rs, rgb_scale(rgb_sub(rgb_all(1.0f), s->Rs), F));
    return rgb_add(rgb_scale(s->below, matt(wo.z) * matt(wi.z)), rgb_scale(fresnel, gloss));
}

/* Probability of sampling the lobe: its part of the albedo, roughly. */
static float glossy(const Blend *s, V3 wo)
{
    float F = (float)schlick5(wo.z), gloss = rgb_lum(s->Rs) * (1.0f - F) + F;
    float below = rgb_lum(s->below) * PI_F * matt(wo.z);
    return gloss > 0.0f ? gloss / (gloss + below) : below > 0.0f ? 0.0f : 0.5f;
}

static float pdf_of(const Blend *s, V3 wo, V3 wi, double lobe)
{
    float p = glossy(s, wo);
    return (1.0f - p) * warp_cosine_pdf(wi.z) + p * (float)lobe;
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
    return f_of(of(b), wo, wi, &h, lobe_of(of(b), &h));
}

static float pdf_w(const Bsdf *b, V3 wo, V3 wi)
{
    Half h;
    if (!same_side(wo, wi))
        return 0.0f;
    wo = above(wo);
    wi = above(wi);
    h = half_of(wo, wi);
    return pdf_of(of(b), wo, wi, lobe_of(of(b), &h));
}

/* Azimuth of h: tan phi = sqrt((nu + 1) / (nv + 1)) tan phi' with phi' uniform; then its cosine is
 * u^(1 / (e + 1)). */
static V3 reflected(const Blend *s, V3 wo, V2 u)
{
    double rest, x, y, e, down, sine;
    V2 c = circle_and(u, &rest);

    x = sqrt(s->nv + 1.0) * c.x;
    y = sqrt(s->nu + 1.0) * c.y;
    e = (s->nu * x * x + s->nv * y * y) / (x * x + y * y);
    down = 1.0 - md_pow(rest, 1.0 / (e + 1.0));
    sine = sqrt(down * (2.0 - down) / (x * x + y * y));
    return half_reflect(wo, x * sine, y * sine, 1.0 - down);
}

static bool sample(const Bsdf *b, V3 wo, float lobe, V2 u, bool importance, BsdfSample *s)
{
    const Blend *blend = of(b);
    V3 up = above(wo);
    Half h;
    double gloss;
    bool matt = !(lobe < glossy(blend, up));

    (void)importance;
    s->wi = !matt ? reflected(blend, up, u) : warp_cosine(u);
    if (!same_side(up, s->wi))
        return false;
    h = half_of(up, s->wi);
    gloss = lobe_of(blend, &h);
    return smooth_event(s, wo, f_of(blend, up, s->wi, &h, gloss),
                    pdf_of(blend, up, s->wi, gloss), matt);
}

/* Exact for what is below, whose integral of B(z) z / pi is 23/28. A lobe without Fresnel has half
 * at grazing, because of the larger of two cosines, and (n + 1)/(n + 6) from above; Fresnel's
 * cosine is that of facets tilted by about 1 / sqrt(n + 1). Fits, for the mean n of both. */
static Rgb albedo(const Bsdf *b, V3 wo)
{
    const Blend *s = of(b);
    float z = f_min(fabsf(wo.z), 1.0f), n, wide, keeps, F;
    Rgb gloss;

    n = 2.0f / (1.0f / (s->nu + 1.0f) + 1.0f / (s->nv + 1.0f)) - 1.0f;
    wide = 1.0f / sqrtf(n + 1.0f);
    keeps = 0.5f + ((n + 1.0f) / (n + 6.0f) - 0.5f) * z / (z + 2.0f * wide);
    F = (float)schlick5(z + (1.0f - z) * 0.6f * wide);
    gloss = rgb_add(s->Rs, rgb_scale(rgb_sub(rgb_all(1.0f), s->Rs), F));
    return rgb_add(rgb_scale(gloss, keeps), rgb_scale(s->below, 23.0f / 28.0f * PI_F * matt(z)));
}

/* An exponent goes as 1/alpha^2. */
static int peaks(const Bsdf *b, V3 wo, V3 peak[16])
{
    const Blend *s = of(b);
    Ggx g = { 1.0f / sqrtf(s->nu + 1.0f), 1.0f / sqrtf(s->nv + 1.0f) };
    peak[0] = normal_z(wo);
    return 1 + ggx_peaks(g, wo, peak + 1);
}

static const OptDef options[] = {
    { .key = "reflectance", .type = OPT_RGB, .num = 0.5, .lo = 0, .hi = 1, .also = "Kd",
      .help = "part of the light below the gloss that is reflected" },
    { .key = "specular", .type = OPT_RGB, .num = 0.05, .lo = 0, .hi = 1, .also = "Ks",
      .help = "part of the light that the lobe reflects, seen from above" },
    { .key = "nu", .type = OPT_FLOAT, .num = 100, .lo = 0, .hi = 1e6,
      .help = "exponent of the lobe along the first tangent" },
    { .key = "nv", .type = OPT_FLOAT, .num = 100, .lo = 0, .hi = 1e6,
      .help = "exponent of the lobe along the second tangent" },
    { .key = "roughness", .type = OPT_FLOAT, .num = -1, .lo = -1, .hi = 1,
      .help = "instead of exponents; below 0: not used" },
    { .key = "uroughness", .type = OPT_FLOAT, .num = -1, .lo = -1, .hi = 1,
      .help = "instead of nu; below 0: as roughness" },
    { .key = "vroughness", .type = OPT_FLOAT, .num = -1, .lo = -1, .hi = 1,
      .help = "instead of nv; below 0: as roughness" },
    { .key = "remaproughness", .type = OPT_BOOL, .num = 1,
      .help = "alpha of the lobe is sqrt(roughness), not roughness itself" },
    { .key = NULL }
};

const BsdfKind bsdf_ashikhminshirley = {
    .info = { "ashikhminshirley", "Ashikhmin00; Cline07 5.2.2",
              "matt under gloss that may be stretched: lacquer, brushed paint", options },
    .flags = BSDF_REFLECT | BSDF_SMOOTH | BSDF_LOBES | BSDF_TANGENT | BSDF_MATT,
    .setup = setup, .eval = eval, .pdf_w = pdf_w, .sample = sample, .albedo = albedo, .peaks = peaks
};

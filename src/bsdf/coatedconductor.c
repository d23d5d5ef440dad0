/* coatedconductor.c -- a metal under a clear coat, each smooth or rough, on both sides: lacquered
 * brass, car paint without its flakes, a wet coin.
 *
 * Source  the options and their defaults are those of [PBRT4], whose metal has its index in air:
 *         inside the coat it is that over the coat's. Light that enters the coat, is reflected by
 *         facets of the metal and leaves again, as [Weidlich07] has it, reciprocal and with the
 *         light that the coat throws back; primes mark directions inside, sin' = sin / eta:
 *           f = f_coat + f_base + f_kept,
 *           f_base = T(wo) T(wi) / eta^2  R(h') ggx(wo', wi') / (1 - min(E(wo), E(wi)) R(h')).
 *         T = 1 - E and E are those of coat.h. Two smooth layers are the whole series
 *         E + T^2 R / (1 - E R) of light to and fro, exactly; so are facets that become smooth.
 *         Since (1 - E(wi)) / (1 - min(..) R) is at most 1, f_base returns at most T(wo).
 * Kept    Facets of the metal turn light beyond the critical angle, where the coat reflects all of
 *         it. Of light along w that is at least the part l(w), as GGX slopes are distributed, a the
 *         smaller alpha: straight down a^2 / (a^2 + t^2), t = tan(critical / 2); else what two
 *         lines across the plane of incidence cut off, 1 - sum of t_k / sqrt(a^2 + t_k^2) / 2 with
 *         t_k = tan((critical -+ theta') / 2), made less by 1 - a / 3, as facets that face w are
 *         seen the most (and by up to 12 % if eta is below 1.35: the least factors that a search
 *         left). At each further bounce a part e gets out, a half or less:
 *           f_kept = T(wo) l(wo) T(wi) l(wi) e R^2 / (1 - R (1 - e)) / (pi M),
 *         R at 60 degrees, M the mean of T l as Tm in coat.h: it returns l of T(wo), never more.
 * Roughness of the coat blurs what is seen through it: facets of slope m turn light that enters by
 *         (1 - 1/eta) m, as half as much slope of the metal would, and again where it leaves. So
 *         the metal's alpha^2 grows by (1 - 1/eta)^2 / 2 times the coat's.
 *
 * What is approximate: E of a rough coat is a bound, and light that one facet of the metal throws
 * onto another is lost, both as elsewhere; light thrown back by the coat keeps to its lobe. The
 * tests make random walks through the same two layers, with what facets lose at each meeting lost
 * and given back. Between the two, what this model returns lies to 0.01 (alphas of 0.1 to 0.3), but
 * for coloured metals: 0.04 above under a smooth coat (alpha 0.1), and for a smooth one under a
 * coat of alpha 0.1 up to 0.09 above towards the horizon. Where both are smooth they are one. */
#include "bsdf/bsdf.h"
#include "bsdf/coat.h"
#include "bsdf/metal.h"

typedef struct {
    Coat  coat;
    Metal metal;                /* over the coat's index */
    Ggx   base;                 /* facets of the metal, blurred by the coat; ax = 0: smooth, and so
                                 * is the coat */
    Rgb   kept;                 /* f_kept / (T l T l) */
    float mean;                 /* M */
    float alpha, edge, sure;    /* a, t, factor of l */
} Coated;

enum { PARTS = 3 };             /* the coat, the metal, what was kept for a while */
typedef struct { float p[PARTS]; } Shares;

static const Coated *of(const Bsdf *b) { return (const Coated *)(const void *)b->as.number; }

static bool all_smooth(const Coated *c) { return c->base.ax == 0.0f; }

static float blurred(float alpha, float coat, float eta)
{
    return f_max(sqrtf(alpha * alpha + 0.5f * f_sqr((1.0f - 1.0f / eta) * coat)), GGX_SMOOTHEST);
}

static V3 inside(const Coated *c, V3 w)
{
    float x = w.x / c->coat.eta, y = w.y / c->coat.eta;
    return (V3){ x, y, sqrtf(1.0f - (x * x + y * y)) };
}

static float below(const Coated *c, float t) { return t / sqrtf(f_sqr(c->alpha) + t * t); }

/* l */
static float lost(const Coated *c, V3 w)
{
    V3 i = inside(c, w);
    float t = c->edge, a2 = f_sqr(c->alpha), half = sqrtf(i.x * i.x + i.y * i.y) / (1.0f + i.z);
    float cut = 0.5f * (below(c, (t - half) / (1.0f + t * half)) +
                        below(c, (t + half) / (1.0f - t * half)));

    if (all_smooth(c))
        return 0.0f;
    return c->sure * f_max(a2 / (a2 + t * t), (1.0f - cut) * (1.0f - c->alpha / 3.0f));
}

static float kept_of(float R, float e) { return e * R * R / (1.0f - R * (1.0f - e)); }

/* M by eight strips; 3 % more is on the safe side of their error. */
static void set_kept(Coated *c)
{
    Rgb R = metal_fresnel(&c->metal, 0.5f);
    float e;

    c->alpha = f_min(c->base.ax, c->base.ay);
    c->edge = 1.0f / (c->coat.eta + sqrtf(f_sqr(c->coat.eta) - 1.0f));
    c->sure = 1.0f - 0.12f * clamp01((1.35f - c->coat.eta) / 0.25f);
    e = f_min(0.5f, f_sqr(c->edge) / (f_sqr(c->alpha) + f_sqr(c->edge)));
    c->mean = 0.0f;
    for (int i = 0; i < 8; i++) {
        float z = ((float)i + 0.5f) / 8.0f;
        V3 w = { sqrtf(1.0f - z * z), 0.0f, z };
        c->mean += 1.03f * 2.0f * z * (1.0f - coat_albedo(&c->coat, w)) * lost(c, w) / 8.0f;
    }
    c->kept = all_smooth(c) ? rgb_all(0.0f)
                            : rgb_scale(rgb(kept_of(R.r, e), kept_of(R.g, e), kept_of(R.b, e)),
                                        INV_PI / c->mean);
}

static void setup(Bsdf *b, const Rgb *value, const void *data)
{
    Coated *c = (Coated *)(void *)b->as.number;
    bool remap = value[10].r != 0.0f, smooth;
    float eta = f_min(f_max(value[3].r, 1.1f), 3.0f);

    (void)data;
    c->coat.eta = eta;
    smooth = !ggx_init(&c->coat.facets, value[0].r, value[1].r, value[2].r, remap);
    c->metal = metal_of(value[7], value[8], value[9]);
    c->metal.eta = rgb_scale(c->metal.eta, 1.0f / eta);
    c->metal.k = rgb_scale(c->metal.k, 1.0f / eta);
    if (ggx_init(&c->base, value[4].r, value[5].r, value[6].r, remap) || !smooth) {
        c->base.ax = blurred(c->base.ax, c->coat.facets.ax, eta);
        c->base.ay = blurred(c->base.ay, c->coat.facets.ay, eta);
    }
    set_kept(c);
    if (!smooth)
        b->flags &= ~BSDF_SPECULAR;
    if (all_smooth(c))
        b->flags &= ~(BSDF_SMOOTH | BSDF_MATT | BSDF_LOBES);
    if (c->base.ax == c->base.ay && c->coat.facets.ax == c->coat.facets.ay)
        b->flags &= ~BSDF_TANGENT;
}

/* ---- directions above the surface; Eo, Ei are coat_albedo() of wo, wi ---- */

/* Along the mirrored direction all of the series but the coat's own part, of two smooth layers. */
static Rgb to_and_fro(const Coated *c, V3 wo, float E)
{
    Rgb R = metal_fresnel(&c->metal, inside(c, wo).z);
    float t2 = f_sqr(1.0f - E);

    return rgb(t2 * R.r / (1.0f - E * R.r), t2 * R.g / (1.0f - E * R.g),
               t2 * R.b / (1.0f - E * R.b));
}

static Rgb f_of(const Coated *c, V3 wo, V3 wi, float Eo)
{
    float Ei = coat_albedo(&c->coat, wi), E = f_min(Eo, Ei), pass = (1.0f - Eo) * (1.0f - Ei), g;
    V3 o = inside(c, wo), i = inside(c, wi);
    Rgb R = metal_fresnel(&c->metal, ggx_cos(o, i)), f;

    g = pass * ggx_f(c->base, o, i) / f_sqr(c->coat.eta);
    f = rgb(g * R.r / (1.0f - E * R.r), g * R.g / (1.0f - E * R.g), g * R.b / (1.0f - E * R.b));
    f = rgb_add(f, rgb_scale(c->kept, pass * (lost(c, wo) * lost(c, wi))));
    return coat_is_smooth(&c->coat) ? f : rgb_add(f, rgb_all(coat_f(&c->coat, wo, wi)));
}

/* What each part returns, roughly. That of the coat is never 0. */
static Rgb of_base(const Coated *c, V3 wo, float E)
{
    return rgb_scale(to_and_fro(c, wo, E),
                     (1.0f - lost(c, wo)) * ggx_albedo(c->base, inside(c, wo)));
}
static Rgb of_kept(const Coated *c, V3 wo, float E)
{
    return rgb_scale(c->kept, PI_F * c->mean * (1.0f - E) * lost(c, wo));
}

static Shares shares(const Coated *c, V3 wo, float E)
{
    float base = rgb_lum(of_base(c, wo, E)), kept = rgb_lum(of_kept(c, wo, E));
    float sum = E + base + kept;

    return (Shares){ { E / sum, base / sum, f_max(0.0f, 1.0f - E / sum - base / sum) } };
}

/* Inside, a solid angle of cos' is eta^2 / cos as large as outside. */
static float pdf_of(const Coated *c, V3 wo, V3 wi, const Shares *s)
{
    V3 o = inside(c, wo), i = inside(c, wi);
    float base = ggx_pdf(c->base, o, i) * wi.z / (f_sqr(c->coat.eta) * i.z);
    float coat = coat_is_smooth(&c->coat) ? 0.0f : ggx_pdf(c->coat.facets, wo, wi);

    return s->p[0] * coat + s->p[1] * base + s->p[2] * warp_cosine_pdf(wi.z);
}

/* From the metal to the outside. False: the coat keeps it. */
static bool sample_base(const Coated *c, V3 wo, V2 u, V3 *wi)
{
    V3 i = ggx_sample(c->base, inside(c, wo), u);
    float x = i.x * c->coat.eta, y = i.y * c->coat.eta, z2 = 1.0f - (x * x + y * y);

    if (!(i.z > 0.0f) || !(z2 > 0.0f))
        return false;
    *wi = v_unit((V3){ x, y, sqrtf(z2) });
    return true;
}

/* ---- the model ---- */

static Rgb eval(const Bsdf *b, V3 wo, V3 wi, bool importance)
{
    const Coated *c = of(b);

    (void)importance;
    if (all_smooth(c) || !same_side(wo, wi))
        return rgb_all(0.0f);
    wo = above(wo);
    return f_of(c, wo, above(wi), coat_albedo(&c->coat, wo));
}

static float pdf_w(const Bsdf *b, V3 wo, V3 wi)
{
    const Coated *c = of(b);
    Shares s;

    if (all_smooth(c) || !same_side(wo, wi))
        return 0.0f;
    wo = above(wo);
    s = shares(c, wo, coat_albedo(&c->coat, wo));
    return pdf_of(c, wo, above(wi), &s);
}

/* What goes to the mirrored direction as a delta. */
static Rgb mirrored(const Coated *c, V3 wo, float E)
{
    Rgb coat = rgb_all(E);
    return all_smooth(c) ? rgb_add(coat, to_and_fro(c, wo, E)) : coat;
}

static bool sample(const Bsdf *b, V3 wo, float lobe, V2 u, bool importance, BsdfSample *s)
{
    const Coated *c = of(b);
    V3 up = above(wo);
    float E = coat_albedo(&c->coat, up);
    Shares all = shares(c, up, E);
    int part = lobe < all.p[0] ? 0 : lobe < all.p[0] + all.p[1] ? 1 : 2;

    (void)importance;
    if (all_smooth(c) || (part == 0 && coat_is_smooth(&c->coat))) {
        float chance = all_smooth(c) ? 1.0f : all.p[0];
        Rgb weight = rgb_scale(mirrored(c, up, E), 1.0f / chance);
        *s = delta_event(mirror_z(wo), weight, BSDF_REFLECT, 1.0f);
        return wo.z != 0.0f;
    }
    if (part == 1 && !sample_base(c, up, u, &s->wi))
        return false;
    if (part != 1)
        s->wi = part == 0 ? ggx_sample(c->coat.facets, up, u) : warp_cosine(u);
    if (!same_side(up, s->wi))
        return false;
    return smooth_event(s, wo, f_of(c, up, s->wi, E), pdf_of(c, up, s->wi, &all), part == 2);
}

static int deltas(const Bsdf *b, V3 wo, BsdfSample s[BSDF_DELTAS])
{
    const Coated *c = of(b);

    if (!coat_is_smooth(&c->coat) || wo.z == 0.0f)
        return 0;
    s[0] = delta_event(mirror_z(wo), mirrored(c, above(wo), coat_albedo(&c->coat, above(wo))),
                       BSDF_REFLECT, 1.0f);
    return 1;
}

static Rgb albedo(const Bsdf *b, V3 wo)
{
    const Coated *c = of(b);
    V3 up = above(wo);
    float E = coat_albedo(&c->coat, up);

    if (all_smooth(c))
        return mirrored(c, up, E);
    return rgb_add(rgb_all(E), rgb_add(of_base(c, up, E), of_kept(c, up, E)));
}

/* The metal's lobe stands about the same direction as the coat's: of the two, that which makes the
 * more peaks. */
static int peaks(const Bsdf *b, V3 wo, V3 peak[16])
{
    V3 other[16];
    int n = ggx_peaks(of(b)->coat.facets, wo, peak), m = ggx_peaks(of(b)->base, wo, other);

    for (int i = n; i < m; i++)
        peak[i] = other[i];
    return m > n ? m : n;
}

#define ALONG(which, axis) which " along the " axis " tangent; below 0: alike along both"

static const OptDef options[] = {
    { .key = "interface.roughness", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 1,
      .help = "of the coat, 0: smooth" },
    { .key = "interface.uroughness", .type = OPT_FLOAT, .num = -1, .lo = -1, .hi = 1,
      .help = ALONG("of the coat", "first") },
    { .key = "interface.vroughness", .type = OPT_FLOAT, .num = -1, .lo = -1, .hi = 1,
      .help = ALONG("of the coat", "second") },
    { .key = "interface.eta", .type = OPT_FLOAT, .num = 1.5, .lo = 1.1, .hi = 3,
      .help = "index of refraction of the coat" },
    { .key = "conductor.roughness", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 1,
      .help = "of the metal, 0: polished" },
    { .key = "conductor.uroughness", .type = OPT_FLOAT, .num = -1, .lo = -1, .hi = 1,
      .help = ALONG("of the metal", "first") },
    { .key = "conductor.vroughness", .type = OPT_FLOAT, .num = -1, .lo = -1, .hi = 1,
      .help = ALONG("of the metal", "second") },
    { .key = "conductor.eta", .type = OPT_RGB, .num = -1, .lo = -1, .hi = 1000,
      .help = "index of the metal in air, real part; below 0: copper" },
    { .key = "conductor.k", .type = OPT_RGB, .num = -1, .lo = -1, .hi = 1000,
      .help = "index of the metal in air, imaginary part; below 0: copper" },
    { .key = "reflectance", .type = OPT_RGB, .num = -1, .lo = -1, .hi = 1,
      .help = "colour of the bare metal head on, instead of eta and k; below 0: not used" },
    { .key = "remaproughness", .type = OPT_BOOL, .num = 1,
      .help = "alpha of the facets is sqrt(roughness), not roughness itself" },
    { .key = NULL }
};

const BsdfKind bsdf_coatedconductor = {
    .info = { "coatedconductor", "Weidlich07; Walter07; Heitz18; PBRT4",
              "metal under a clear coat: lacquered brass, car paint", options },
    .flags = BSDF_REFLECT | BSDF_SPECULAR | BSDF_SMOOTH | BSDF_LOBES | BSDF_TANGENT | BSDF_MATT,
    .setup = setup, .eval = eval, .pdf_w = pdf_w, .sample = sample, .deltas = deltas,
    .albedo = albedo, .peaks = peaks
};

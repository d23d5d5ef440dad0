/* coateddiffuse.c -- a matt base under a clear coat, smooth or rough, on both sides: plastic,
 * glazed pottery, varnish.
 *
 * Source  the split into a coat and what passes it, in the reciprocal and energy-conserving form of
 *         [Ashikhmin00] and [Kelemen01], with the light that the coat throws back inside:
 *           f = f_coat + rho/pi T(wo) T(wi) / (eta^2 (1 - rho Fi)),  T = 1 - E,
 *           Fi = 1 - Tm / eta^2,  Tm = integral of T(w) cos / pi over the hemisphere.
 *         f_coat is that of GGX facets (ggx.h) with Fresnel's reflectance, or a delta. E(w) stands
 *         for the albedo of f_coat. Fi is the part of diffuse light from inside that the coat
 *         reflects: by reciprocity 1 - Fi = (1 - Fe) / eta^2, and Tm = 1 - Fe. A white base then
 *         has albedo E + T = 1 exactly: nothing is absorbed.
 *
 * `specular` takes away from f_coat, as absorption at its surface would. (Other renderers have such
 * factors.) The base does not get what it takes.
 *
 * What is approximate: the base sees diffuse light whatever the angles of refraction, and the coat
 * absorbs nothing. E of a rough coat is a bound, see coat.h. The price is light lost:
 * of a white surface with eta = 1.5, 1 % on average over the hemisphere for alpha = 0.1, 3 % for
 * 0.5, 6 % for 1, and up to 19 % near grazing (more, if the coat is strongly anisotropic). With a
 * smooth coat nothing is lost: then a random walk through the two layers (test/test_layers.c)
 * returns the same to 0.004. */
#include "bsdf/bsdf.h"
#include "bsdf/coat.h"

typedef struct {
    Rgb   base;                 /* rho / (pi (eta^2 (1 - rho) + rho Tm)) */
    Coat  coat;
    float mean;                 /* Tm */
    Rgb   specular;
} Coated;

static const Coated *of(const Bsdf *b) { return (const Coated *)(const void *)b->as.number; }

static bool is_smooth(const Coated *c) { return coat_is_smooth(&c->coat); }

static float base_of(const Coated *c, float rho)
{
    return rho * INV_PI / (c->coat.eta * c->coat.eta * (1.0f - rho) + rho * c->mean);
}

static void setup(Bsdf *b, const Rgb *value, const void *data)
{
    Coated *c = (Coated *)(void *)b->as.number;
    Rgb rho = reflectance_of(value[0]);

    (void)data;
    c->specular = reflectance_of(value[6]);
    c->coat.eta = f_min(f_max(value[1].r, 1.1f), 3.0f);
    ggx_init(&c->coat.facets, value[2].r, value[3].r, value[4].r, value[5].r != 0.0f);
    b->flags &= ~(is_smooth(c) ? BSDF_TANGENT : ggx_lacks(c->coat.facets));
    c->mean = coat_mean_passing(&c->coat);
    c->base = rgb(base_of(c, rho.r), base_of(c, rho.g), base_of(c, rho.b));
}

/* Albedo of the base through the coat, for light E of which the coat reflects. */
static Rgb base_albedo(const Coated *c, float E)
{
    return rgb_scale(c->base, PI_F * (1.0f - E) * c->mean);
}

/* Probability of sampling the coat: its part of the albedo, E of which is never 0. */
static float coat_share(const Coated *c, float E)
{
    float coat = E * f_max(rgb_lum(c->specular), 1e-3f);
    return coat / (coat + rgb_lum(base_albedo(c, E)));
}

/* For directions above the surface; E is coat_albedo(wo). */
static Rgb f_of(const Coated *c, V3 wo, V3 wi, float E)
{
    Rgb f = rgb_scale(c->base, (1.0f - E) * (1.0f - coat_albedo(&c->coat, wi)));
    if (is_smooth(c))
        return f;
    return rgb_add(f, rgb_scale(c->specular, coat_f(&c->coat, wo, wi)));
}

static float pdf_of(const Coated *c, V3 wo, V3 wi, float share)
{
    float coat = is_smooth(c) ? 0.0f : ggx_pdf(c->coat.facets, wo, wi);
    return share * coat + (1.0f - share) * warp_cosine_pdf(wi.z);
}

static Rgb eval(const Bsdf *b, V3 wo, V3 wi, bool importance)
{
    (void)importance;
    if (!same_side(wo, wi))
        return rgb_all(0.0f);
    wo = above(wo);
    return f_of(of(b), wo, above(wi), coat_albedo(&of(b)->coat, wo));
}

static float pdf_w(const Bsdf *b, V3 wo, V3 wi)
{
    if (!same_side(wo, wi))
        return 0.0f;
    wo = above(wo);
    return pdf_of(of(b), wo, above(wi), coat_share(of(b), coat_albedo(&of(b)->coat, wo)));
}

static bool sample(const Bsdf *b, V3 wo, float lobe, V2 u, bool importance, BsdfSample *s)
{
    const Coated *c = of(b);
    V3 up = above(wo);
    float E = coat_albedo(&c->coat, up), share = coat_share(c, E);

    (void)importance;
    if (lobe < share && is_smooth(c)) {
        *s = delta_event(mirror_z(wo), rgb_scale(c->specular, E / share), BSDF_REFLECT, 1.0f);
        return wo.z != 0.0f;
    }
    s->wi = lobe < share ? ggx_sample(c->coat.facets, up, u) : warp_cosine(u);
    if (!same_side(up, s->wi))
        return false;
    return smooth_event(s, wo, f_of(c, up, s->wi, E), pdf_of(c, up, s->wi, share), !(lobe < share));
}

static int deltas(const Bsdf *b, V3 wo, BsdfSample s[BSDF_DELTAS])
{
    if (!is_smooth(of(b)) || wo.z == 0.0f)
        return 0;
    s[0] = delta_event(mirror_z(wo),
                       rgb_scale(of(b)->specular, coat_albedo(&of(b)->coat, above(wo))),
                       BSDF_REFLECT, 1.0f);
    return 1;
}

static Rgb albedo(const Bsdf *b, V3 wo)
{
    float E = coat_albedo(&of(b)->coat, wo);
    return rgb_add(rgb_scale(of(b)->specular, E), base_albedo(of(b), E));
}

static int peaks(const Bsdf *b, V3 wo, V3 peak[16])
{
    peak[0] = normal_z(wo);
    return 1 + ggx_peaks(of(b)->coat.facets, wo, peak + 1);
}

static const OptDef options[] = {
    { .key = "reflectance", .type = OPT_RGB, .num = 0.5, .lo = 0, .hi = 1, .also = "Kd",
      .help = "part of the light inside that the base reflects" },
    { .key = "eta", .type = OPT_FLOAT, .num = 1.5, .lo = 1.1, .hi = 3, .also = "index",
      .help = "index of refraction of the coat" },
    { .key = "roughness", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 1,
      .help = "of the coat, 0: smooth" },
    GGX_OPTIONS_BESIDE_ROUGHNESS,
    { .key = "specular", .type = OPT_RGB, .num = 1, .lo = 0, .hi = 1, .also = "Ks",
      .help = "tint of what the coat reflects" },
    { .key = NULL }
};

const BsdfKind bsdf_coateddiffuse = {
    .info = { "coateddiffuse", "Ashikhmin00; Kelemen01; Walter07; Heitz18",
              "matt under a clear coat: plastic, pottery, varnish", options },
    .flags = BSDF_REFLECT | BSDF_SPECULAR | BSDF_SMOOTH | BSDF_LOBES | BSDF_TANGENT | BSDF_MATT,
    .setup = setup, .eval = eval, .pdf_w = pdf_w, .sample = sample, .deltas = deltas,
    .albedo = albedo, .peaks = peaks
};

/* orennayar.c -- a matt surface of rough facets, each of them Lambert's: clay, plaster, the moon.
 * It sends more light back to where it came from than Lambert's does, on both sides.
 *
 * Source  [OrenNayar94 (30)], the qualitative model: with a and b the larger and the smaller of
 *         the two angles to the normal and phi between the two directions seen from above,
 *           f = rho / pi (A + B max(0, cos phi) sin a tan b),
 *           A = 1 - 0.5 s^2 / (s^2 + 0.33), B = 0.45 s^2 / (s^2 + 0.09),
 *         s the standard deviation of the facets' slope angle. Light that goes from facet to facet
 *         is left out, as there. Sampled in proportion to the cosine.
 *
 * Albedo  has a closed form, rho (A + B g) with
 *           g(t) = 2/pi (sin t (t/2 - sin 2t / 4) + tan t (1 - sin^3 t) / 3),
 *         which grows from 0 to 1/2 at grazing angles. A + B/2 passes 1 for s below 30 degrees or
 *         so, by 1 % at most: there A and B are scaled down until it does not. */
#include "bsdf/bsdf.h"
#include "sampling/warp.h"

typedef struct { Rgb reflectance; float a, b; } OrenNayar;

static const OrenNayar *of(const Bsdf *b)
{
    return (const OrenNayar *)(const void *)b->as.number;
}

static void setup(Bsdf *b, const Rgb *value, const void *data)
{
    OrenNayar *o = (OrenNayar *)(void *)b->as.number;
    float s2 = f_sqr(f_min(f_max(value[1].r, 0.0f), 90.0f) * (PI_F / 180.0f)), most;

    (void)data;
    o->reflectance = reflectance_of(value[0]);
    o->a = 1.0f - 0.5f * s2 / (s2 + 0.33f);
    o->b = 0.45f * s2 / (s2 + 0.09f);
    most = f_max(1.0f, o->a + 0.5f * o->b);
    o->a /= most;
    o->b /= most;
}

/* cos phi sin a tan b is the product of the two directions in the plane over the larger cosine. */
static float shape(const OrenNayar *o, V3 wo, V3 wi)
{
    float along = wo.x * wi.x + wo.y * wi.y, c = f_max(fabsf(wo.z), fabsf(wi.z));
    return along > 0.0f && c > 0.0f ? o->a + o->b * along / c : o->a;
}

static Rgb eval(const Bsdf *b, V3 wo, V3 wi, bool importance)
{
    const OrenNayar *o = of(b);
    (void)importance;
    return same_side(wo, wi) ? rgb_scale(o->reflectance, INV_PI * shape(o, wo, wi)) : rgb_all(0.0f);
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
    s->weight = rgb_scale(of(b)->reflectance, shape(of(b), wo, s->wi));
    s->flags = BSDF_REFLECT | BSDF_SMOOTH | BSDF_MATT;
    s->eta = 1.0f;
    return same_side(wo, s->wi);
}

/* tan t (1 - sin^3 t) = sin t cos t (1 + sin t + sin^2 t) / (1 + sin t), as 1 - sin^2 = cos^2. */
static Rgb albedo(const Bsdf *b, V3 wo)
{
    const OrenNayar *o = of(b);
    float c = f_min(fabsf(wo.z), 1.0f), s = sqrtf(1.0f - c * c), t = m_acos(c);
    float g = s * (0.5f * t - 0.5f * s * c) + s * c * (1.0f + s + s * s) / (1.0f + s) / 3.0f;
    return rgb_scale(o->reflectance, f_min(o->a + o->b * 2.0f * INV_PI * g, 1.0f));
}

static int peaks(const Bsdf *b, V3 wo, V3 peak[16])
{
    (void)b;
    peak[0] = normal_z(wo);
    peak[1] = wo;
    return 2;
}

static const OptDef options[] = {
    { .key = "reflectance", .type = OPT_RGB, .num = 0.5, .lo = 0, .hi = 1, .also = "Kd",
      .help = "part of the light that each facet reflects" },
    { .key = "sigma", .type = OPT_FLOAT, .num = 20, .lo = 0, .hi = 90,
      .help = "standard deviation of the facets' angle, degrees; 0: as diffuse" },
    { .key = NULL }
};

const BsdfKind bsdf_orennayar = {
    .info = { "orennayar", "OrenNayar94; Cline07 5.2.2", "matt and rough: clay, plaster", options },
    .flags = BSDF_REFLECT | BSDF_SMOOTH | BSDF_MATT,
    .setup = setup, .eval = eval, .pdf_w = pdf_w, .sample = sample, .albedo = albedo, .peaks = peaks
};

/* conductor.c -- a metal, polished or rough, on both sides.
 *
 * Source  GGX facets with sampled visible normals, see ggx.h; Fresnel's formula for a complex
 *         index, one for each of red, green and blue, see metal.h. As in pbrt-v4, alpha is
 *         sqrt(roughness) unless `remaproughness` is false.
 *
 * Light is reflected by one facet only, so rough metal comes out too dark, never too bright. An
 * alpha below GGX_SMOOTHEST along both axes makes a perfect mirror, a delta. */
#include "bsdf/bsdf.h"
#include "bsdf/ggx.h"
#include "bsdf/metal.h"

typedef struct { Metal metal; Ggx facets; } Conductor;          /* facets.ax = 0: a mirror */

static const Conductor *of(const Bsdf *b)
{
    return (const Conductor *)(const void *)b->as.number;
}

static bool is_mirror(const Conductor *c) { return c->facets.ax == 0.0f; }

static void setup(Bsdf *b, const Rgb *value, const void *data)
{
    Conductor *c = (Conductor *)(void *)b->as.number;

    (void)data;
    ggx_init(&c->facets, value[0].r, value[1].r, value[2].r, value[3].r != 0.0f);
    b->flags &= ~ggx_lacks(c->facets);
    c->metal = metal_of(value[4], value[5], value[6]);
}

static Rgb fresnel(const Conductor *c, float cosine) { return metal_fresnel(&c->metal, cosine); }

static Rgb eval(const Bsdf *b, V3 wo, V3 wi, bool importance)
{
    const Conductor *c = of(b);
    (void)importance;
    if (is_mirror(c) || !same_side(wo, wi))
        return rgb_all(0.0f);
    wo = above(wo);
    wi = above(wi);
    return rgb_scale(fresnel(c, ggx_cos(wo, wi)), ggx_f(c->facets, wo, wi));
}

static float pdf_w(const Bsdf *b, V3 wo, V3 wi)
{
    const Conductor *c = of(b);
    if (is_mirror(c) || !same_side(wo, wi))
        return 0.0f;
    return ggx_pdf(c->facets, above(wo), above(wi));
}

static bool sample(const Bsdf *b, V3 wo, float lobe, V2 u, bool importance, BsdfSample *s)
{
    const Conductor *c = of(b);
    V3 up = above(wo);

    (void)lobe, (void)importance;
    s->eta = 1.0f;
    if (is_mirror(c)) {
        *s = delta_event(mirror_z(wo), fresnel(c, up.z), BSDF_REFLECT, 1.0f);
        return wo.z != 0.0f;
    }
    s->wi = ggx_sample(c->facets, up, u);
    if (!same_side(up, s->wi))
        return false;
    s->pdf_w = ggx_pdf(c->facets, up, s->wi);
    s->weight = rgb_scale(fresnel(c, ggx_cos(up, s->wi)), ggx_weight(c->facets, up, s->wi));
    s->flags = BSDF_REFLECT | BSDF_SMOOTH;
    if (wo.z < 0.0f)
        s->wi.z = -s->wi.z;
    return s->pdf_w > 0.0f;
}

static int deltas(const Bsdf *b, V3 wo, BsdfSample s[BSDF_DELTAS])
{
    return is_mirror(of(b)) && sample(b, wo, 0.0f, (V2){ 0, 0 }, false, s);
}

static Rgb albedo(const Bsdf *b, V3 wo)
{
    const Conductor *c = of(b);
    return rgb_scale(fresnel(c, ggx_bounding_cos(c->facets, wo)), ggx_albedo(c->facets, wo));
}

static int peaks(const Bsdf *b, V3 wo, V3 peak[16]) { return ggx_peaks(of(b)->facets, wo, peak); }

static const OptDef options[] = {
    { .key = "roughness", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 1,
      .help = "0: polished" },
    GGX_OPTIONS_BESIDE_ROUGHNESS,
    { .key = "eta", .type = OPT_RGB, .num = -1, .lo = -1, .hi = 1000,
      .help = "index of refraction, real part; below 0: copper" },
    { .key = "k", .type = OPT_RGB, .num = -1, .lo = -1, .hi = 1000,
      .help = "index of refraction, imaginary part; below 0: copper" },
    { .key = "reflectance", .type = OPT_RGB, .num = -1, .lo = -1, .hi = 1,
      .help = "colour seen head on, instead of eta and k; below 0: not used" },
    { .key = NULL }
};

const BsdfKind bsdf_conductor = {
    .info = { "conductor", "Walter07; Heitz14 5.3; Heitz18; Cline07 5.2.2",
              "metal, polished or rough", options },
    .flags = BSDF_REFLECT | BSDF_SPECULAR | BSDF_SMOOTH | BSDF_TANGENT,
    .setup = setup, .eval = eval, .pdf_w = pdf_w, .sample = sample, .deltas = deltas,
    .albedo = albedo, .peaks = peaks
};

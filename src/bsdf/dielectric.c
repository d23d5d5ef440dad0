/* dielectric.c -- the smooth surface of glass or water: reflects and refracts, seen from either
 * side. The outside is where z > 0; eta is the index of the inside over that of the outside.
 *
 * Source  Fresnel and Snell, see fresnel.h; [Veach97 5.2] and the corrected eq. 2.14 and 2.16 of
 *         [GIRT]: radiance that crosses from index n_b (where wi lies) to n_a (where wo lies) grows
 *         by (n_a / n_b)^2, because its solid angle shrinks; importance, that is particles of
 *         light, does not. So f(wi, wo) / n_o^2 = f(wo, wi) / n_i^2.
 *
 * The two events are chosen by the energy each carries, F reflectance and (1 - F) transmittance. */
#include "bsdf/bsdf.h"
#include "bsdf/fresnel.h"

typedef struct { Rgb reflectance, transmittance; float eta; } Dielectric;

static const Dielectric *of(const Bsdf *b)
{
    return (const Dielectric *)(const void *)b->as.number;
}

static void setup(Bsdf *b, const Rgb *value, const void *data)
{
    Dielectric *d = (Dielectric *)(void *)b->as.number;
    (void)data;
    d->eta = f_min(f_max(value[0].r, 0.1f), 10.0f);
    d->reflectance = reflectance_of(value[1]);
    d->transmittance = reflectance_of(value[2]);
}

/* Index of the side that wo is not on over that of its own. */
static double eta_across(const Dielectric *d, V3 wo)
{
    return wo.z > 0.0f ? (double)d->eta : 1.0 / (double)d->eta;
}

static V3 refracted(V3 wo, double eta, double t)
{
    return (V3){ (float)(-wo.x / eta), (float)(-wo.y / eta), (float)(wo.z > 0.0f ? -t : t) };
}

static bool sample(const Bsdf *b, V3 wo, float lobe, V2 u, bool importance, BsdfSample *s)
{
    const Dielectric *d = of(b);
    double eta = eta_across(d, wo), c = fabsf(wo.z), t = refract_cos(c, eta);
    double F = fresnel_with(c, t, eta);
    double R = F * rgb_lum(d->reflectance), T = (1.0 - F) * rgb_lum(d->transmittance);

    (void)u;
    if (wo.z == 0.0f || !(R + T > 0.0))
        return false;
    s->pdf_w = 0.0f;
    if (lobe * (R + T) < R) {
        s->wi = mirror_z(wo);
        s->weight = rgb_scale(d->reflectance, (float)(F * (R + T) / R));
        s->flags = BSDF_REFLECT | BSDF_SPECULAR;
        s->eta = 1.0f;
        return true;
    }
    s->wi = refracted(wo, eta, t);
    s->weight = rgb_scale(d->transmittance,
                          (float)((1.0 - F) * (R + T) / T / (importance ? 1.0 : eta * eta)));
    s->flags = BSDF_TRANSMIT | BSDF_SPECULAR;
    s->eta = (float)eta;
    return s->wi.z != 0.0f;
}

static Rgb albedo(const Bsdf *b, V3 wo)
{
    const Dielectric *d = of(b);
    float F = (float)fresnel_dielectric(fabsf(wo.z), eta_across(d, wo));
    return rgb_add(rgb_scale(d->reflectance, F), rgb_scale(d->transmittance, 1.0f - F));
}

static int peaks(const Bsdf *b, V3 wo, V3 peak[16])
{
    double eta = eta_across(of(b), wo), t = refract_cos(fabsf(wo.z), eta);
    peak[0] = mirror_z(wo);
    peak[1] = refracted(wo, eta, t);
    return t > 0.0 ? 2 : 1;
}

static const OptDef options[] = {
    { .key = "eta", .type = OPT_FLOAT, .num = 1.5, .lo = 0.1, .hi = 10, .also = "index",
      .help = "index of refraction inside over that outside" },
    { .key = "reflectance", .type = OPT_RGB, .num = 1, .lo = 0, .hi = 1, .also = "Kr",
      .help = "tint of what is reflected" },
    { .key = "transmittance", .type = OPT_RGB, .num = 1, .lo = 0, .hi = 1, .also = "Kt",
      .help = "tint of what passes" },
    { .key = NULL }
};

const BsdfKind bsdf_dielectric = {
    .info = { "dielectric", "Born99 1.5.2; Veach97 5.2; GIRT (2.14), (2.16)",
              "smooth glass or water: reflects and refracts", options },
    .flags = BSDF_REFLECT | BSDF_TRANSMIT | BSDF_SPECULAR | BSDF_LOBES,
    .setup = setup, .eval = bsdf_eval_none, .pdf_w = bsdf_pdf_none,
    .sample = sample, .albedo = albedo, .peaks = peaks
};

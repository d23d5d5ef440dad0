/* dielectric.c -- the surface of glass or water, polished or rough: reflects and refracts, seen
 * from either side. The outside is where z > 0; eta is the index of the inside over that of the
 * outside.
 *
 * Source  Fresnel and Snell, see fresnel.h; [Veach97 5.2] and the corrected eq. 2.14 and 2.16 of
 *         [GIRT]: radiance that crosses from index n_b (where wi lies) to n_a (where wo lies) grows
 *         by (n_a / n_b)^2, because its solid angle shrinks; importance, that is particles of
 *         light, does not. So f(wi, wo) / n_o^2 = f(wo, wi) / n_i^2.
 *         Rough: GGX facets with sampled visible normals, see ggx.h, each of which reflects and
 *         refracts [Walter07 (20), (21)]. In the notation of ggx.h, with m the facet's normal along
 *         wo + eta wi, o = wo.m > 0, i = -wi.m > 0 and e the ratio of indices across:
 *           f_t = (1-F) D 2 o i / ((zi so + zo si) (i - o/e)^2) / (1 for importance, e^2),
 *           pdf = (1-F) D 2 o i / ((zo + so) (i - o/e)^2).
 *
 * The two events are chosen by the energy each carries, F reflectance and (1 - F) transmittance.
 * Light that meets a second facet is lost: white rough glass is too dark, never too bright. */
#include "bsdf/bsdf.h"
#include "bsdf/fresnel.h"
#include "bsdf/ggx.h"

typedef struct {
    Rgb   reflectance, transmittance;
    float eta;
    Ggx   facets;               /* ax = 0: polished */
} Dielectric;

static const Dielectric *of(const Bsdf *b)
{
    return (const Dielectric *)(const void *)b->as.number;
}

static bool is_polished(const Dielectric *d) { return d->facets.ax == 0.0f; }

/* Facets turn refracted light by their tilt times |eta - 1|, roughly: where that is finer than the
 * rounding of half vectors resolves, the surface is polished, see GGX_SMOOTHEST. */
static void setup(Bsdf *b, const Rgb *value, const void *data)
{
    Dielectric *d = (Dielectric *)(void *)b->as.number;
    (void)data;
    d->eta = f_min(f_max(value[0].r, 0.1f), 10.0f);
    d->reflectance = reflectance_of(value[1]);
    d->transmittance = reflectance_of(value[2]);
    ggx_init(&d->facets, value[3].r, value[4].r, value[5].r, value[6].r != 0.0f);
    if (f_min(d->facets.ax, d->facets.ay) * fabsf(d->eta - 1.0f) < GGX_SMOOTHEST * f_min(d->eta, 1))
        d->facets = (Ggx){ 0.0f, 0.0f };
    b->flags &= ~ggx_lacks(d->facets);
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

static bool sample_polished(const Bsdf *b, V3 wo, float lobe, bool importance, BsdfSample *s)
{
    const Dielectric *d = of(b);
    double eta = eta_across(d, wo), c = fabsf(wo.z), t = refract_cos(c, eta);
    double F = fresnel_with(c, t, eta);
    double R = F * rgb_lum(d->reflectance), T = (1.0 - F) * rgb_lum(d->transmittance);

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

static int deltas(const Bsdf *b, V3 wo, BsdfSample s[BSDF_DELTAS])
{
    const Dielectric *d = of(b);
    double eta = eta_across(d, wo), c = fabsf(wo.z), t = refract_cos(c, eta);
    double F = fresnel_with(c, t, eta);

    if (wo.z == 0.0f || !is_polished(d))
        return 0;
    s[0] = delta_event(mirror_z(wo), rgb_scale(d->reflectance, (float)F), BSDF_REFLECT, 1.0f);
    s[1] = delta_event(refracted(wo, eta, t),
                       rgb_scale(d->transmittance, (float)((1.0 - F) / (eta * eta))),
                       BSDF_TRANSMIT, (float)eta);
    return s[1].wi.z != 0.0f ? 2 : 1;
}

/* ---- rough: wo is taken to lie above; what lies below has been mirrored ---- */

/* A pair of directions and the facet between them. */
typedef struct {
    bool   any;                 /* there is one that wo sees and that does anything */
    double o, i;                /* cosines of wo and wi to it, both positive */
    float  D;
    double F, R, T;             /* Fresnel's; luminance of what is reflected, refracted */
} Between;

/* t is the cosine of what is refracted; 0 where all is reflected. */
static void split(const Dielectric *d, double t, double eta, Between *f)
{
    f->F = fresnel_with(f->o, t, eta);
    f->R = f->F * rgb_lum(d->reflectance);
    f->T = (1.0 - f->F) * rgb_lum(d->transmittance);
    f->any = f->R + f->T > 0.0;
}

static Between between(const Dielectric *d, V3 wo, V3 wi, double eta)
{
    double a = unit_factor(wo), b = unit_factor(wi), e = wi.z > 0.0f ? b : b * eta, side, length;
    double x = a * wo.x + e * wi.x, y = a * wo.y + e * wi.y, z = a * wo.z + e * wi.z;
    Between f = { false, 0.0, 0.0, 0.0f, 0.0, 0.0, 0.0 };

    side = z < 0.0 ? -1.0 : 1.0;                /* below when light goes on to a larger index */
    length = side * sqrt(x * x + y * y + z * z);
    if (!(fabs(z) > 1e-30))
        return f;
    f.o = a * (wo.x * x + wo.y * y + wo.z * z) / length;
    f.i = (wi.z > 0.0f ? b : -b) * (wi.x * x + wi.y * y + wi.z * z) / length;
    if (!(f.o > 0.0) || !(f.i > 0.0))
        return f;
    f.D = ggx_d_along(d->facets, x, y, side * z);
    /* From i, where that is known: near total reflection the root for t would cancel. */
    split(d, wi.z > 0.0f ? refract_cos(d_min(f.o, 1.0), eta) : f.i, eta, &f);
    return f;
}

/* What f and pdf have in common: D times dm/dwi, up to 2 o / (zo + so) and the like. */
static double density(const Between *f, V3 wi, double eta)
{
    double snell = f->i - f->o / eta;           /* not 0, as eta is not 1 */
    return wi.z > 0.0f ? 0.5 * f->D : 2.0 * f->D * f->o * f->i / (snell * snell);
}

static Rgb f_of(const Dielectric *d, const Between *f, V3 wo, V3 wi, double eta, bool importance)
{
    double all = density(f, wi, eta) /
                 (fabsf(wi.z) * ggx_s(d->facets, wo) + wo.z * ggx_s(d->facets, wi));
    if (wi.z > 0.0f)
        return rgb_scale(d->reflectance, (float)(f->F * all));
    return rgb_scale(d->transmittance,
                     (float)((1.0 - f->F) * all / (importance ? 1.0 : eta * eta)));
}

static float pdf_of(const Dielectric *d, const Between *f, V3 wo, V3 wi, double eta)
{
    double p = (wi.z > 0.0f ? f->R : f->T) / (f->R + f->T);
    return (float)(p * density(f, wi, eta) / (wo.z + ggx_s(d->facets, wo)));
}

/* Both directions as seen from the side of wo. */
static V3 turned(V3 w, V3 wo) { return wo.z < 0.0f ? v3(w.x, w.y, -w.z) : w; }

static Rgb eval(const Bsdf *b, V3 wo, V3 wi, bool importance)
{
    const Dielectric *d = of(b);
    double eta = eta_across(d, wo);
    V3 up = above(wo), to = turned(wi, wo);
    Between f;

    if (is_polished(d) || wo.z * wi.z == 0.0f)
        return rgb_all(0.0f);
    f = between(d, up, to, eta);
    return f.any ? f_of(d, &f, up, to, eta, importance) : rgb_all(0.0f);
}

static float pdf_w(const Bsdf *b, V3 wo, V3 wi)
{
    const Dielectric *d = of(b);
    double eta = eta_across(d, wo);
    V3 up = above(wo), to = turned(wi, wo);
    Between f;

    if (is_polished(d) || wo.z * wi.z == 0.0f)
        return 0.0f;
    f = between(d, up, to, eta);
    return f.any ? pdf_of(d, &f, up, to, eta) : 0.0f;
}

/* Refracted by the facet of normal m: -wo/eta and as much of m as Snell's law asks for. */
static V3 refracted_by(V3 wo, V3 m, double o, double eta)
{
    return v_unit(v_mad(m, (float)(o / eta - refract_cos(o, eta)), v_scale(wo, (float)(-1 / eta))));
}

static bool sample(const Bsdf *b, V3 wo, float lobe, V2 u, bool importance, BsdfSample *s)
{
    const Dielectric *d = of(b);
    double eta = eta_across(d, wo);
    V3 up = above(wo), m;
    bool reflects;
    Between f;

    if (is_polished(d))
        return sample_polished(b, wo, lobe, importance, s);
    m = ggx_sample_normal(d->facets, up, u);
    f.o = d_min(v_dot(up, m), 1.0);
    if (!(f.o > 0.0) || wo.z == 0.0f)
        return false;
    split(d, refract_cos(f.o, eta), eta, &f);
    reflects = lobe * (f.R + f.T) < f.R;
    s->wi = reflects ? v_unit(v_mad(m, (float)(2.0 * f.o), v_neg(up)))
                     : refracted_by(up, m, f.o, eta);
    if (!f.any || (s->wi.z > 0.0f) != reflects || s->wi.z == 0.0f)
        return false;
    f = between(d, up, s->wi, eta);
    s->pdf_w = f.any ? pdf_of(d, &f, up, s->wi, eta) : 0.0f;
    if (!(s->pdf_w > 0.0f))
        return false;
    s->weight = rgb_scale(f_of(d, &f, up, s->wi, eta, importance), fabsf(s->wi.z) / s->pdf_w);
    s->flags = (reflects ? BSDF_REFLECT : BSDF_TRANSMIT) | BSDF_SMOOTH;
    s->eta = reflects ? 1.0f : (float)eta;
    s->wi = turned(s->wi, wo);
    return true;
}

/* G2 / G1, the part of the light that reaches wi from the facets that wo sees. */
static float passing(const Dielectric *d, V3 wo, V3 wi, bool above)
{
    float so = ggx_s(d->facets, wo), si = ggx_s(d->facets, wi), zi = fabsf(wi.z);
    return (wi.z > 0.0f) == above && zi > 0.0f ? zi * (wo.z + so) / (zi * so + wo.z * si) : 0.0f;
}

/* Of rough glass: the mean over twelve facets. */
static Rgb albedo(const Bsdf *b, V3 wo)
{
    const Dielectric *d = of(b);
    double eta = eta_across(d, wo);
    float F = (float)fresnel_dielectric(f_min(fabsf(wo.z), 1.0f), eta), R = F, T = 1.0f - F;
    V3 up = above(wo);

    if (!is_polished(d))
        R = T = 0.0f;
    for (int k = 0; k < 12 && !is_polished(d); k++) {
        V2 u = { ((float)(k % 4) + 0.5f) / 4.0f, ((float)(k / 4) + 0.5f) / 3.0f };
        V3 m = ggx_sample_normal(d->facets, up, u);
        double o = d_min(d_max(v_dot(up, m), 0.0), 1.0);
        F = (float)fresnel_dielectric(o, eta);
        R += F / 12.0f * passing(d, up, v_mad(m, (float)(2.0 * o), v_neg(up)), true);
        T += (1.0f - F) / 12.0f * passing(d, up, refracted_by(up, m, o, eta), false);
    }
    return rgb_add(rgb_scale(d->reflectance, R), rgb_scale(d->transmittance, T));
}

/* Rough glass also lets light pass almost straight, by facets that face wo. */
static int peaks(const Bsdf *b, V3 wo, V3 peak[16])
{
    const Dielectric *d = of(b);
    double eta = eta_across(d, wo), t = refract_cos(fabsf(wo.z), eta);
    int n = ggx_peaks(d->facets, wo, peak);
    if (t > 0.0)
        peak[n++] = refracted(wo, eta, t);
    if (!is_polished(d))
        peak[n++] = v_neg(wo);
    return n;
}

static const OptDef options[] = {
    { .key = "eta", .type = OPT_FLOAT, .num = 1.5, .lo = 0.1, .hi = 10, .also = "index",
      .help = "index of refraction inside over that outside" },
    { .key = "reflectance", .type = OPT_RGB, .num = 1, .lo = 0, .hi = 1, .also = "Kr",
      .help = "tint of what is reflected" },
    { .key = "transmittance", .type = OPT_RGB, .num = 1, .lo = 0, .hi = 1, .also = "Kt",
      .help = "tint of what passes" },
    { .key = "roughness", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 1,
      .help = "0: polished" },
    GGX_OPTIONS_BESIDE_ROUGHNESS,
    { .key = NULL }
};

const BsdfKind bsdf_dielectric = {
    .info = { "dielectric", "Born99 1.5.2; Veach97 5.2; GIRT (2.14), (2.16); Walter07; Heitz18",
              "glass or water, polished or rough: reflects and refracts", options },
    .flags = BSDF_REFLECT | BSDF_TRANSMIT | BSDF_SPECULAR | BSDF_SMOOTH | BSDF_LOBES |
             BSDF_TANGENT,
    .setup = setup, .eval = eval, .pdf_w = pdf_w, .sample = sample, .deltas = deltas,
    .albedo = albedo, .peaks = peaks
};

/* phong.c -- a matt surface with a glossy lobe about the mirrored direction, on both sides.
 *
 * Source  [Lafortune94], the modified Phong model that keeps energy and reciprocity:
 *           f = kd / pi + ks (n + 2) / (2 pi) cos^n alpha,
 *         alpha between wi and the mirrored wo, the lobe cut off at right angles to it. It is
 *         sampled by cos alpha = u^(1/(n+1)) [erratum 002.2], density (n + 1) / (2 pi) cos^n alpha;
 *         what comes out below the surface is lost.
 *
 * Where kd + ks passes 1, as in many MTL files, both are scaled down until it does not.
 * cos alpha of a narrow lobe is 1 - d^2/2 with d the distance of the two directions: a product of
 * unit vectors would lose the digits that the n-th power brings to light. */
#include "bsdf/bsdf.h"
#include "sampling/warp.h"

typedef struct {
    Rgb   diffuse, specular;
    float exponent;
    float glossy;               /* probability of sampling the lobe */
} Phong;

static const Phong *of(const Bsdf *b) { return (const Phong *)(const void *)b->as.number; }

static void setup(Bsdf *b, const Rgb *value, const void *data)
{
    Phong *p = (Phong *)(void *)b->as.number;
    float ld, ls;

    (void)data;
    reflectances_of(value, &p->diffuse, &p->specular);
    p->exponent = f_min(f_max(value[2].r, 0.0f), BSDF_SHARPEST);
    ld = rgb_lum(p->diffuse);
    ls = rgb_lum(p->specular);
    p->glossy = ls > 0.0f ? ls / (ld + ls) : 0.0f;
}

/* cos^n alpha, for directions on one side. */
static float lobe_of(const Phong *p, V3 wo, V3 wi)
{
    double x = (double)wi.x + wo.x, y = (double)wi.y + wo.y, z = (double)wi.z - wo.z;
    double c = 1.0 - 0.5 * (x * x + y * y + z * z);
    return c > 0.0 ? (float)md_pow(c, p->exponent) : 0.0f;
}

static Rgb f_of(const Phong *p, float lobe)
{
    return rgb_add(rgb_scale(p->diffuse, INV_PI),
                   rgb_scale(p->specular, 0.5f * INV_PI * (p->exponent + 2.0f) * lobe));
}

static float pdf_of(const Phong *p, V3 wi, float lobe)
{
    return (1.0f - p->glossy) * warp_cosine_pdf(fabsf(wi.z)) +
           p->glossy * 0.5f * INV_PI * (p->exponent + 1.0f) * lobe;
}

static Rgb eval(const Bsdf *b, V3 wo, V3 wi, bool importance)
{
    (void)importance;
    return same_side(wo, wi) ? f_of(of(b), lobe_of(of(b), wo, wi)) : rgb_all(0.0f);
}

static float pdf_w(const Bsdf *b, V3 wo, V3 wi)
{
    return same_side(wo, wi) ? pdf_of(of(b), wi, lobe_of(of(b), wo, wi)) : 0.0f;
}

/* A direction of density cos^n about the axis. The radius on the disc has r^2 uniform. */
static V3 about(V3 axis, double n, V2 u)
{
    Frame frame = frame_about(axis);
    float r, scale;
    double down;
    V2 d = warp_disk_radius(u, &r);

    down = 1.0 - md_pow((1.0 - (double)r) * (1.0 + (double)r), 1.0 / (n + 1.0));
    scale = (float)(sqrt(down * (2.0 - down)) / (double)r);
    return v_unit(frame_out(&frame, (V3){ d.x * scale, d.y * scale, (float)(1.0 - down) }));
}

static bool sample(const Bsdf *b, V3 wo, float lobe, V2 u, bool importance, BsdfSample *s)
{
    const Phong *p = of(b);
    float c;

    (void)importance;
    if (lobe < p->glossy)
        s->wi = about(mirror_z(wo), p->exponent, u);
    else {
        s->wi = warp_cosine(u);
        if (wo.z < 0.0f)
            s->wi.z = -s->wi.z;
    }
    if (!same_side(wo, s->wi))
        return false;
    c = lobe_of(p, wo, s->wi);
    s->pdf_w = pdf_of(p, s->wi, c);
    if (!(s->pdf_w > 0.0f))
        return false;
    s->weight = rgb_scale(f_of(p, c), fabsf(s->wi.z) / s->pdf_w);
    s->flags = BSDF_REFLECT | BSDF_SMOOTH | (lobe < p->glossy ? 0 : BSDF_MATT);
    s->eta = 1.0f;
    return true;
}

/* The lobe's albedo is 1 from above and, for large n, cos theta. At grazing, half of the lobe and a
 * sine are left, (n+2)/(4 sqrt pi) Gamma((n+1)/2) / Gamma(n/2+2), or about 1 / sqrt(4 + 2 pi n). */
static Rgb albedo(const Bsdf *b, V3 wo)
{
    const Phong *p = of(b);
    float grazing2 = 1.0f / (4.0f + 2.0f * PI_F * p->exponent), c2 = f_min(wo.z * wo.z, 1.0f);
    return rgb_add(p->diffuse, rgb_scale(p->specular, sqrtf(c2 + (1.0f - c2) * grazing2)));
}

static const OptDef options[] = {
    { .key = "reflectance", .type = OPT_RGB, .num = 0.5, .lo = 0, .hi = 1, .also = "Kd",
      .help = "part of the light that is reflected in every direction" },
    { .key = "specular", .type = OPT_RGB, .num = 0.25, .lo = 0, .hi = 1, .also = "Ks",
      .help = "part of the light that the lobe reflects, seen from above" },
    { .key = "exponent", .type = OPT_FLOAT, .num = 50, .lo = 0, .hi = 1e6, .also = "Ns",
      .help = "sharpness of the lobe" },
    { .key = NULL }
};

const BsdfKind bsdf_phong = {
    .info = { "phong", "Lafortune94; Cline07 5.2.2", "matt with a glossy lobe, normalised",
              options },
    .flags = BSDF_REFLECT | BSDF_SMOOTH | BSDF_LOBES | BSDF_MATT,
    .setup = setup, .eval = eval, .pdf_w = pdf_w, .sample = sample, .albedo = albedo,
    .peaks = bsdf_matt_lobe_peaks
};

/* ggx.h -- reflection by a rough interface: facets whose normals follow the GGX distribution, in
 * the local frame, for directions above the surface (z > 0). Fresnel's factor is the caller's.
 *
 * Source  [Walter07] the distribution; [Heitz14 (99), sec. 5.3] the anisotropic form and the
 *         height-correlated masking and shadowing; [Heitz18] sampling of the visible normals.
 *
 * Written with s(w) = sqrt(z^2 + (ax x)^2 + (ay y)^2), the length of a direction in the space
 * where the facets are a hemisphere. Smith's Lambda is (s/z - 1)/2, so that
 *   G1 = 2 z / (z + s),   G2 = 2 zo zi / (zi so + zo si),
 *   f  = D G2 / (4 zo zi) = D / (2 (zi so + zo si)),   pdf = D G1 / (4 zo) = D / (2 (zo + so)),
 * and nothing divides by a cosine: grazing directions need no special care. One bounce only: light
 * that a facet throws onto another is lost, so that energy is at most 1. */
#ifndef BSDF_GGX_H
#define BSDF_GGX_H

#include "base/maths.h"
#include "base/platform.h"
#include "base/vec.h"
#include "bsdf/bsdf.h"
#include "sampling/warp.h"

#include <stdbool.h>

/* Below this alpha a facet distribution is narrower than the rounding of a half vector resolves
 * (6e-8 / 1e-3 changes D by 1e-4 already): such a surface is a perfect mirror. */
#define GGX_SMOOTHEST 1e-3f

typedef struct { float ax, ay; } Ggx;

/* alpha from roughness; negative u or v: as `roughness`. remap: alpha = sqrt(roughness). */
INLINE float ggx_alpha(float roughness, float fallback, bool remap)
{
    float r = clamp01(roughness < 0.0f ? fallback : roughness);
    return remap ? sqrtf(r) : r;
}
/* The last three of what ggx_init takes, for a model that has one layer of facets. */
#define GGX_OPTIONS_BESIDE_ROUGHNESS                                                               \
    { .key = "uroughness", .type = OPT_FLOAT, .num = -1, .lo = -1, .hi = 1,                        \
      .help = "along the first tangent; below 0: as roughness" },                                  \
    { .key = "vroughness", .type = OPT_FLOAT, .num = -1, .lo = -1, .hi = 1,                        \
      .help = "along the second tangent; below 0: as roughness" },                                 \
    { .key = "remaproughness", .type = OPT_BOOL, .num = 1,                                         \
      .help = "alpha of the facets is sqrt(roughness), not roughness itself" }
/* False: a perfect mirror, and *g is zero. */
INLINE bool ggx_init(Ggx *g, float roughness, float u, float v, bool remap)
{
    *g = (Ggx){ ggx_alpha(u, roughness, remap), ggx_alpha(v, roughness, remap) };
    if (g->ax < GGX_SMOOTHEST && g->ay < GGX_SMOOTHEST) {
        *g = (Ggx){ 0.0f, 0.0f };
        return false;
    }
    *g = (Ggx){ f_max(g->ax, GGX_SMOOTHEST), f_max(g->ay, GGX_SMOOTHEST) };
    return true;
}

/* Which of the flags of bsdf.h do not hold for these facets. */
INLINE int ggx_lacks(Ggx g)
{
    return (g.ax == 0.0f ? BSDF_SMOOTH : BSDF_SPECULAR) | (g.ax == g.ay ? BSDF_TANGENT : 0);
}

INLINE float ggx_s(Ggx g, V3 w)
{
    return sqrtf(w.z * w.z + f_sqr(g.ax * w.x) + f_sqr(g.ay * w.y));
}

/* D of the direction of (x, y, z), z > 0. */
INLINE float ggx_d_along(Ggx g, double x, double y, double z)
{
    double p = x / g.ax, q = y / g.ay, r = (x * x + y * y + z * z) / (z * z + p * p + q * q);
    return z > 1e-30 ? (float)(r * r) * INV_PI / (g.ax * g.ay) : 0.0f;
}

/* D of the half vector h. Near the horizon the two directions all but cancel in h, and a rounding
 * of either's length would turn it: at 0.1 degrees and alpha 0.02 by enough to lose a thousandth
 * of D. So both are made unit again, in double. */
INLINE float ggx_d(Ggx g, V3 wo, V3 wi)
{
    double a = unit_factor(wo), b = unit_factor(wi);
    return ggx_d_along(g, a * wo.x + b * wi.x, a * wo.y + b * wi.y, a * wo.z + b * wi.z);
}

INLINE float ggx_f(Ggx g, V3 wo, V3 wi)
{
    return ggx_d(g, wo, wi) * 0.5f / (wi.z * ggx_s(g, wo) + wo.z * ggx_s(g, wi));
}
INLINE float ggx_pdf(Ggx g, V3 wo, V3 wi)
{
    return ggx_d(g, wo, wi) * 0.5f / (wo.z + ggx_s(g, wo));
}
/* f cos / pdf, at most 1. */
INLINE float ggx_weight(Ggx g, V3 wo, V3 wi)
{
    float so = ggx_s(g, wo), si = ggx_s(g, wi);
    return wi.z * (wo.z + so) / (wi.z * so + wo.z * si);
}
/* Cosine between either direction and the half vector: half the length of their sum. */
INLINE float ggx_cos(V3 wo, V3 wi) { return f_min(0.5f * v_len(v_add(wo, wi)), 1.0f); }

/* A facet normal as seen from wo: stretch wo to where the facets are a hemisphere, choose on the
 * disc that it shows (a half disc and a half ellipse), and stretch back. [Heitz18 listing 1] */
INLINE V3 ggx_sample_normal(Ggx g, V3 wo, V2 u)
{
    V3 v = v_unit((V3){ g.ax * wo.x, g.ay * wo.y, wo.z }), s, t, m;
    float l2 = v.x * v.x + v.y * v.y, l = sqrtf(l2), half = 0.5f * (1.0f + v.z);
    V2 p = warp_disk_concentric(u);

    /* Seen from straight above any direction will do; 1e-30 keeps the quotient accurate. */
    s = v3(1.0f, 0.0f, 0.0f);
    if (l2 > 1e-30f)
        s = v3(-v.y / l, v.x / l, 0.0f);
    t = v_cross(v, s);
    p.y = (1.0f - half) * sqrtf(f_max(0.0f, 1.0f - p.x * p.x)) + half * p.y;
    m = v_scale(v, sqrtf(f_max(0.0f, 1.0f - p.x * p.x - p.y * p.y)));
    m = v_mad(s, p.x, v_mad(t, p.y, m));
    return v_unit((V3){ g.ax * m.x, g.ay * m.y, f_max(0.0f, m.z) });
}

/* The reflected direction; it may lie below the surface. */
INLINE V3 ggx_sample(Ggx g, V3 wo, V2 u)
{
    V3 m = ggx_sample_normal(g, wo, u);
    return v_unit(v_mad(m, 2.0f * v_dot(wo, m), v_neg(wo)));
}

/* ---- albedos: estimates in closed form, as there is none of the integral ---- */

/* Albedo for light along w if facets reflected all, within 0.12 for equal alphas. (What is lost was
 * reflected downwards or met another facet.) */
INLINE float ggx_albedo(Ggx g, V3 w)
{
    float a2 = 0.5f * (g.ax * g.ax + g.ay * g.ay);
    return 1.0f - 1.75f * a2 / (1.0f + 1.5f * a2) * sqrtf(f_min(fabsf(w.z), 1.0f));
}

/* A cosine c' at which Fresnel's reflectance of a dielectric, of index in [1.1, 3], is at least the
 * albedo of these facets for light along w, up to 1e-4 (the tests check it):
 *   c'^2 = c^2 (1 - 0.45 alpha) + 1.25 a^2 / (1 + 12.4 a^2) max(0, 1 - c^2 / (3.74 a)),
 * alpha the larger of the two, a the blend of both by the squares of w's direction in the plane.
 * The first term makes up for the convexity of F, the second says that facets turn towards grazing
 * eyes. The coefficients are ours, the best of a search under that condition. */
INLINE float ggx_bounding_cos(Ggx g, V3 w)
{
    float x2 = w.x * w.x, y2 = w.y * w.y, c2 = w.z * w.z, alpha = f_max(g.ax, g.ay);
    float a = x2 + y2 > 0.0f ? (g.ax * x2 + g.ay * y2) / (x2 + y2) : alpha, lift = 0.0f;
    if (a > 0.0f)
        lift = 1.25f * a * a / (1.0f + 12.4f * a * a) * f_max(0.0f, 1.0f - c2 / (3.74f * a));
    return sqrtf(f_min(c2 * (1.0f - 0.45f * alpha) + lift, 1.0f));
}

/* Directions where reflection is strong: the mirrored one and, if the facets spread much further
 * along one axis (as exponents of a ratio above 3 do, and an exponent goes as 1/alpha^2), nine on
 * the cone they trace out about the other axis. [Cline07 5.2.2], corrected. How many: 1 or 10. */
INLINE int ggx_peaks(Ggx g, V3 wo, V3 *peak)
{
    V3 r = { -wo.x, -wo.y, wo.z };
    bool along_x = g.ax > g.ay;
    float wide = f_max(g.ax, g.ay), narrow = f_min(g.ax, g.ay), radius, s, c;

    peak[0] = r;
    if (wide * wide <= 3.0f * narrow * narrow)
        return 1;
    radius = sqrtf(f_sqr(along_x ? r.x : r.y) + r.z * r.z);
    for (int i = 0; i <= 8; i++) {
        m_sincos_turn((float)i / 16.0f, &s, &c);
        s *= wo.z < 0.0f ? -radius : radius;
        c *= radius;
        peak[1 + i] = v3(along_x ? c : r.x, along_x ? r.y : c, s);
    }
    return 10;
}

#endif

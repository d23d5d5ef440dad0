/* coat.h -- a clear coat, smooth or rough, over a base: what models share that have one. In the
 * local frame, for directions above the surface (z > 0).
 *
 * E(w) is what the coat reflects of light along w, T = 1 - E what passes. For a rough coat E has no
 * closed form; we take a bound of it, E = F(c') with c' from ggx.h, so that a surface whose base
 * gets no more than T never returns more light than it gets. */
#ifndef BSDF_COAT_H
#define BSDF_COAT_H

#include "bsdf/fresnel.h"
#include "bsdf/ggx.h"

typedef struct {
    float eta;                  /* index inside over that outside, 1.1 to 3 */
    Ggx   facets;               /* ax = 0: smooth */
} Coat;

INLINE bool coat_is_smooth(const Coat *c) { return c->facets.ax == 0.0f; }

INLINE float coat_albedo(const Coat *c, V3 w)                   /* E */
{
    return (float)fresnel_dielectric(ggx_bounding_cos(c->facets, w), c->eta);
}

/* What the facets of a rough coat reflect, as f. */
INLINE float coat_f(const Coat *c, V3 wo, V3 wi)
{
    return (float)fresnel_dielectric(ggx_cos(wo, wi), c->eta) * ggx_f(c->facets, wo, wi);
}

/* Tm = integral of T(w) cos / pi over the hemisphere = integral over c in [0,1] of 2 c T(c) by
 * Gauss's six points, which err by less than 6e-5 over all eta and alpha; 1e-4 more keeps us on the
 * safe side. So does the rougher of two alphas, with which T is larger. */
INLINE float coat_mean_passing(const Coat *c)
{
    static const float at[6] = { 0.0337652429f, 0.169395307f, 0.380690407f,
                                 0.619309593f, 0.830604693f, 0.966234757f };
    static const float share[3] = { 0.0856622462f, 0.180380787f, 0.233956967f };
    Coat even = *c;
    float sum = 0.0f;

    even.facets.ax = even.facets.ay = f_max(c->facets.ax, c->facets.ay);
    for (int i = 0; i < 6; i++) {
        V3 w = { sqrtf(1.0f - at[i] * at[i]), 0.0f, at[i] };
        sum += share[i < 3 ? i : 5 - i] * 2.0f * at[i] * (1.0f - coat_albedo(&even, w));
    }
    return f_min(1.0f, sum + 1e-4f);
}

#endif

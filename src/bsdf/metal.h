/* metal.h -- the complex index of a metal, for each of red, green and blue, and what it reflects.
 * Options and their defaults (copper) are those of [PBRT4], as is the index made from a colour:
 * eta = 1 and k so that the colour is what is reflected head on, in air. */
#ifndef BSDF_METAL_H
#define BSDF_METAL_H

#include "bsdf/fresnel.h"
#include "bsdf/bsdf.h"

#define METAL_HIGHEST 1000.0f   /* index */

typedef struct { Rgb eta, k; } Metal;

/* k for eta = 1 and this reflectance R at c = 1, where R = k^2 / (4 + k^2). */
INLINE float metal_k_of(float R)
{
    R = f_min(clamp01(R), 0.9999f);                             /* R = 1 has no finite k */
    return 2.0f * sqrtf(R / (1.0f - R));
}

/* An index as a texture may give it; below 0 the metal's. */
INLINE Rgb metal_index(Rgb value, Rgb metal)
{
    if (value.r < 0.0f)
        return metal;
    return rgb(f_min(value.r, METAL_HIGHEST), f_min(f_max(value.g, 0.0f), METAL_HIGHEST),
               f_min(f_max(value.b, 0.0f), METAL_HIGHEST));
}

/* From the three options; a reflectance of 0 or more goes before the index. */
INLINE Metal metal_of(Rgb eta, Rgb k, Rgb reflectance)
{
    Metal m = { metal_index(eta, rgb(0.2004f, 0.9240f, 1.1022f)),               /* copper */
                metal_index(k, rgb(3.9129f, 2.4528f, 2.1421f)) };
    if (reflectance.r >= 0.0f) {
        m.eta = rgb_all(1.0f);
        m.k = rgb(metal_k_of(reflectance.r), metal_k_of(reflectance.g), metal_k_of(reflectance.b));
    }
    return m;
}

INLINE Rgb metal_fresnel(const Metal *m, float cosine)
{
    return rgb(fresnel_conductor(cosine, m->eta.r, m->k.r),
               fresnel_conductor(cosine, m->eta.g, m->k.g),
               fresnel_conductor(cosine, m->eta.b, m->k.b));
}

#endif

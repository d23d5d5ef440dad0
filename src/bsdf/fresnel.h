/* fresnel.h -- what a smooth interface does with light: how much is reflected, and at what
 * angle the rest goes on.
 *
 * Source  Fresnel's formulas as in [Born99 1.5.2] and, for absorbing media, [Born99 14.2] solved
 *         for real numbers. In double, because c - eta t cancels where little is reflected.
 *
 * eta is always the index of the far side over that of the side the light is on. */
#ifndef BSDF_FRESNEL_H
#define BSDF_FRESNEL_H

#include "base/maths.h"
#include "base/platform.h"

/* Cosine of the refracted direction; 0 when all is reflected. */
INLINE double refract_cos(double c, double eta)
{
    double cos2 = 1.0 - (1.0 - c) * (1.0 + c) / (eta * eta);
    return cos2 > 0.0 ? sqrt(cos2) : 0.0;
}

/* Reflectance of unpolarised light between transparent media; c in [0,1] is the cosine on the
 * light's side, t = refract_cos(c, eta). Total reflection, t = 0, comes out as 1. */
INLINE double fresnel_with(double c, double t, double eta)
{
    double s = c - eta * t, s_sum = c + eta * t, p = eta * c - t, p_sum = eta * c + t;
    if (!(t > 0.0))
        return 1.0;
    s /= s_sum;
    p /= p_sum;
    return 0.5 * (s * s + p * p);
}
INLINE double fresnel_dielectric(double c, double eta)
{
    return fresnel_with(c, refract_cos(c, eta), eta);
}

/* From a transparent medium to one of complex index eta + i k, both relative to the first.
 * With a + i b = sqrt((eta + i k)^2 - sin^2), which is (far index times far cosine):
 *   R_s = |(c - a - i b) / (c + a + i b)|^2,
 *   R_p = R_s |(a + i b - s^2/c) / (a + i b + s^2/c)|^2 */
INLINE float fresnel_conductor(double c, double eta, double k)
{
    double c2 = c * c, s2 = (1.0 - c) * (1.0 + c);
    double re = eta * eta - k * k - s2, im = 2.0 * eta * k;
    double size = sqrt(re * re + im * im);                      /* a^2 + b^2 */
    /* a^2 = (size + re) / 2 cancels if re < 0; then b is the safe one, and a = im / 2b */
    double a = re >= 0.0 ? sqrt(0.5 * (size + re)) : 0.5 * im / sqrt(0.5 * (size - re));
    double sum = size + c2, cross = 2.0 * a * c, rs, p_sum, p_cross;

    if (!(sum + cross > 0.0))                                   /* c = 0 and no contrast */
        return 1.0f;
    rs = (sum - cross) / (sum + cross);
    rs = rs > 0.0 ? rs : 0.0;                                   /* it may round to below */
    p_sum = c2 * size + s2 * s2;
    p_cross = cross * s2;
    if (!(p_sum + p_cross > 0.0))                               /* s = 0: both alike */
        return (float)rs;
    return (float)(0.5 * rs * (1.0 + (p_sum - p_cross) / (p_sum + p_cross)));
}

#endif

/* spectrum.c -- from spectra to linear RGB with the primaries and the white of BT.709.
 *
 * Source      [Wyman13] "Simple Analytic Approximations to the CIE XYZ Color Matching Functions",
 *             section 2.2: sums of Gaussians whose two flanks differ in width. Their error is below
 *             that of the 1931 observer's data. Planck's law with c2 of the SI of 2019.
 * Light       XYZ = sum s(l) (x,y,z)bar(l) / sum ybar(l): flat light of 1 has Y = 1 and the hue of
 *             illuminant E. This is what version 3 of the language says.
 * Albedo      What a reflectance, or a refractive index, does to white: the RGB of the spectrum
 *             over the RGB of a flat one, channel by channel. A flat spectrum is grey.
 * Black body  "blackbody L" [T]: version 4 divides each emission spectrum by its luminance, so
 *             Y = 1. "blackbody L" [T scale]: version 3, the spectrum's peak (Wien) is `scale`.
 * Departs     Inline and .spd spectra of lights keep their magnitude, as in version 3; version 4
 *             makes their luminance 1. Named illuminants, which only version 4 has, have Y = 1. */
#include "scenefile/spectrum.h"

#include "base/maths.h"

#include <string.h>

#define NM(i) (360.0 + 5.0 * (i))

/* One lobe: height, centre, and the width of either flank as 1/sigma. */
typedef struct { double a, mu, left, right; } Lobe;
static const Lobe lobes[3][3] = {
    { { 0.362, 442.0, 0.0624, 0.0374 }, { 1.056, 599.8, 0.0264, 0.0323 },
      { -0.065, 501.1, 0.0490, 0.0382 } },
    { { 0.821, 568.8, 0.0213, 0.0247 }, { 0.286, 530.9, 0.0613, 0.0322 }, { 0, 0, 0, 0 } },
    { { 1.217, 437.0, 0.0845, 0.0278 }, { 0.681, 459.0, 0.0385, 0.0725 }, { 0, 0, 0, 0 } },
};

static double lobe(const Lobe *l, double nm)
{
    double t = (nm - l->mu) * (nm < l->mu ? l->left : l->right);
    return l->a * md_exp(-0.5 * t * t);
}

void spectrum_from_xyz(const double xyz[3], double rgb[3])
{
    /* IEC 61966-2-1 to the digits of the primaries and the white (0.3127, 0.3290). */
    static const double m[3][3] = { { 3.2404542, -1.5371385, -0.4985314 },
                                    { -0.9692660, 1.8760108, 0.0415560 },
                                    { 0.0556434, -0.2040259, 1.0572252 } };
    for (int i = 0; i < 3; i++)
        rgb[i] = m[i][0] * xyz[0] + m[i][1] * xyz[1] + m[i][2] * xyz[2];
}

/* The functions are divided by the sum of ybar, so that sums against them need no more care. */
void cie_init(Cie *c)
{
    double y = 0, xyz[3] = { 0, 0, 0 };

    for (int i = 0; i < CIE_SAMPLES; i++) {
        for (int k = 0; k < 3; k++)
            c->bar[i][k] = lobe(&lobes[k][0], NM(i)) + lobe(&lobes[k][1], NM(i)) +
                           lobe(&lobes[k][2], NM(i));
        y += c->bar[i][1];
    }
    for (int i = 0; i < CIE_SAMPLES; i++)
        for (int k = 0; k < 3; k++) {
            c->bar[i][k] /= y;
            xyz[k] += c->bar[i][k];
        }
    spectrum_from_xyz(xyz, c->flat);
}

static void not_negative(double rgb[3])
{
    for (int i = 0; i < 3; i++)
        if (!(rgb[i] > 0))
            rgb[i] = 0;
}

void spectrum_from_samples(const Cie *c, const double *pairs, size_t n, SpectrumUse use,
                           double rgb[3])
{
    double xyz[3] = { 0, 0, 0 };
    size_t j = 0;

    for (int i = 0; i < CIE_SAMPLES; i++) {
        double nm = NM(i), v;
        while (j + 1 < n && pairs[2 * j + 2] <= nm)
            j++;
        v = pairs[2 * j + 1];
        if (nm > pairs[2 * j] && j + 1 < n)
            v += (pairs[2 * j + 3] - v) * ((nm - pairs[2 * j]) / (pairs[2 * j + 2] - pairs[2 * j]));
        for (int k = 0; k < 3; k++)
            xyz[k] += v * c->bar[i][k];
    }
    spectrum_from_xyz(xyz, rgb);
    for (int k = 0; k < 3 && use == SPECTRUM_ALBEDO; k++)
        rgb[k] /= c->flat[k];
    not_negative(rgb);
}

/* Planck's law relative to its peak, where hc/(l k T) = 4.965114231744276 (Wien). */
static double planck(double nm, double kelvin)
{
    const double c2 = 1.438776877e7, wien = 4.965114231744276;          /* nm K */
    double x = c2 / (nm * kelvin), r = x / wien;
    return r * r * r * r * r * (md_exp(wien) - 1) / (md_exp(x) - 1);
}

void spectrum_from_kelvin(const Cie *c, double kelvin, const double *scale, double rgb[3])
{
    double xyz[3] = { 0, 0, 0 };

    for (int i = 0; i < CIE_SAMPLES; i++)
        for (int k = 0; k < 3; k++)
            xyz[k] += planck(NM(i), kelvin) * c->bar[i][k];
    for (int k = 0; k < 3; k++)
        rgb[k] = xyz[k] * (scale ? *scale : 1 / xyz[1]);
    memcpy(xyz, rgb, sizeof xyz);
    spectrum_from_xyz(xyz, rgb);
    not_negative(rgb);
}

/* ---- other primaries ---- */

const char *const spectrum_spaces[] = { "srgb", "rec2020", "dci-p3", "aces2065-1", NULL };

/* x, y of red, green, blue and white: IEC 61966-2-1, ITU-R BT.2020, SMPTE EG 432-1 (P3 with white
 * D65), SMPTE ST 2065-1. */
static const double chromaticities[][8] = {
    { 0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290 },
    { 0.708, 0.292, 0.170, 0.797, 0.131, 0.046, 0.3127, 0.3290 },
    { 0.680, 0.320, 0.265, 0.690, 0.150, 0.060, 0.3127, 0.3290 },
    { 0.7347, 0.2653, 0.0, 1.0, 0.0001, -0.077, 0.32168, 0.33767 },
};

static double det3(double m[3][3])
{
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

/* The columns of m become the XYZ of the primaries, scaled so that they add up to the white with
 * Y = 1 (Cramer's rule). */
static void primaries(const double xy[8], double m[3][3])
{
    double p[3][3], white[3], det;

    for (int k = 0; k < 4; k++) {
        double x = xy[2 * k], y = xy[2 * k + 1], xyz[3] = { x / y, 1, (1 - x - y) / y };
        for (int i = 0; i < 3; i++) {
            if (k < 3)
                p[i][k] = xyz[i] * y;                   /* any length will do: x, y, z itself */
            else
                white[i] = xyz[i];
        }
    }
    det = det3(p);
    for (int k = 0; k < 3; k++) {
        double q[3][3];
        memcpy(q, p, sizeof q);
        for (int i = 0; i < 3; i++)
            q[i][k] = white[i];
        for (int i = 0; i < 3; i++)
            m[i][k] = p[i][k] * (det3(q) / det);
    }
}

bool spectrum_space(const char *name, double m[3][3])
{
    double to_xyz[3][3];
    size_t s = 0;

    while (spectrum_spaces[s] && strcmp(spectrum_spaces[s], name))
        s++;
    if (!spectrum_spaces[s])
        return false;
    primaries(chromaticities[s], to_xyz);
    for (int k = 0; k < 3; k++) {
        double xyz[3] = { to_xyz[0][k], to_xyz[1][k], to_xyz[2][k] }, rgb[3];
        spectrum_from_xyz(xyz, rgb);
        for (int i = 0; i < 3; i++)
            m[i][k] = rgb[i];
    }
    for (int i = 0; i < 3; i++) {                       /* white to white: von Kries in RGB */
        double sum = m[i][0] + m[i][1] + m[i][2];
        for (int k = 0; k < 3; k++)
            m[i][k] /= sum;
    }
    return true;
}

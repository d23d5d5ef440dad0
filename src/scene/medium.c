/* medium.c -- the code of `medium.h`
 *
 * Scattering  Along a flight, channel c has extinction s_c and transmittance T_c = exp(-tau_c). A
 *             flight that follows c ends in dx with density s_c T_c dx. Drawn with chances q_c, the
 *             density of an end is sum q_c s_c T_c, and the probability of none sum q_c T_c; the
 *             weights are scattering * T, or T, over that. [PBRT4 14.2.2] has the same for spectra
 *             with a channel that is fixed for the path. A medium that only absorbs ends no flight:
 *             its transmittance is a weight, without noise. */
#include "scene/medium.h"

#include "base/maths.h"
#include "sampling/warp.h"

static Rgb extinction(const Medium *m) { return rgb_add(m->absorption, m->scattering); }

/* exp(-s x), 1 for s = 0 however far x is. */
static float fade(float s, float x) { return s > 0.0f ? m_exp(-s * x) : 1.0f; }

Rgb medium_transmittance(const Medium *m, float length)
{
    Rgb s = extinction(m);
    return (Rgb){ fade(s.r, length), fade(s.g, length), fade(s.b, length) };
}

/* [HenyeyGreenstein41]: (1 - g^2) / (4 pi (1 + g^2 - 2 g cos)^(3/2)). The bracket is
 * (1 - g)^2 + 2 g (1 - cos), and 1 - cos is half the squared distance of the directions: neither
 * loses digits where g and the cosine are near 1. Likewise for g below 0, with the sum. */
float phase_pdf_w(float g, V3 from, V3 to)
{
    double a = fabs((double)g);
    V3 d = g >= 0.0f ? v_sub(to, from) : v_add(to, from);
    double q = (1.0 - a) * (1.0 - a) + a * v_dot(d, d);
    return (float)(0.25 / PI * (1.0 - a * a) / (q * sqrt(q)));
}

/* The inverse of the cumulative density: with s = (1 - a^2) / (1 + a - 2 a v),
 *   cos = (1 + a^2 - s^2) / (2 a),    1 - cos = (s^2 - (1 - a)^2) / (2 a)
 *                                             = 2 v (1 - a)^2 (1 + a - a v) / (1 + a - 2 a v)^2,
 * where v in [0,1] is uniform and 0 straight on. */
V3 phase_sample(float g, V3 from, V2 u)
{
    Frame frame = frame_about(g >= 0.0f ? from : v_neg(from));
    double a = fabs((double)g), down, s;
    float r;
    V2 d = warp_disk_radius(u, &r);
    double v = (double)r * r, q = 1.0 + a - 2.0 * a * v;

    down = 2.0 * v * (1.0 - a) * (1.0 - a) * (1.0 + a - a * v) / (q * q);
    s = sqrt(down * (2.0 - down)) / r;
    return v_unit(frame_out(&frame, v3((float)(d.x * s), (float)(d.y * s), (float)(1.0 - down))));
}

/* ---- flights ---- */

void flight_start(Flight *f, Rgb throughput, float u)
{
    float sum = throughput.r + throughput.g + throughput.b, chance;

    f->left = f->chosen = rgb_all(1.0f);
    f->chance = sum > 0.0f && is_finite(sum) ? rgb_scale(throughput, 1.0f / sum)
                                             : rgb_all(1.0f / 3.0f);
    chance = f->chance.r;
    f->channel = 0;
    if (u >= chance) {                  /* what is left of u is uniform again */
        u -= chance;
        f->channel = u < f->chance.g ? 1 : 2;
        chance = f->channel == 1 ? f->chance.g : f->chance.b;
        if (f->channel == 2)
            u -= f->chance.g;
    }
    u = chance > 0.0f ? f_min(u / chance, ONE_MINUS_ULP) : 0.0f;
    f->depth = -m_log(1.0f - u);
}

static float dot(Rgb a, Rgb b) { return a.r * b.r + a.g * b.g + a.b * b.b; }

bool flight_scatters(Flight *f, const Medium *m, float length, float *at, Rgb *weight)
{
    Rgb s = extinction(m), faded;
    float own = f->channel == 0 ? s.r : f->channel == 1 ? s.g : s.b, pdf;
    bool ends, scatters = !rgb_black(m->scattering);

    *at = scatters && own > 0.0f ? f->depth / own : INFINITY;
    ends = *at < length;
    faded = medium_transmittance(m, ends ? *at : length);
    f->left = rgb_mul(f->left, faded);
    if (scatters)
        f->chosen = rgb_mul(f->chosen, faded);
    if (!ends) {
        if (scatters && own > 0.0f)
            f->depth -= own * length;
        return false;
    }
    pdf = dot(f->chance, rgb_mul(s, f->chosen));
    *weight = pdf > 0.0f ? rgb_scale(rgb_mul(m->scattering, f->left), 1.0f / pdf) : rgb_all(0.0f);
    return true;
}

Rgb flight_arrives(const Flight *f)
{
    float p = dot(f->chance, f->chosen);
    return p > 0.0f ? rgb_scale(f->left, 1.0f / p) : rgb_all(0.0f);
}

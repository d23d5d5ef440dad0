/* merl.c -- the code of merl.h. */
#include "bsdf/merl.h"

#include "base/bits.h"
#include "base/mem.h"
#include "bsdf/half.h"

static uint32_t u32_at(const unsigned char *b)
{
    return (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

/* A double by its bits; 0 where it is negative, not finite, or absurd. */
static double value_at(const unsigned char *b)
{
    double x = double_of((uint64_t)u32_at(b + 4) << 32 | u32_at(b));
    return x >= 0x1p-100 && x < 0x1p101 ? x : 0.0;
}

bool merl_read(Merl *m, const char *path, const unsigned char *bytes, size_t n)
{
    static const double scale[3] = { 1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0 };
    Place at = { path, 0, 0 };
    uint32_t count[3] = { 0, 0, 0 };
    size_t all;

    m->f = NULL;
    for (int i = 0; i < 3 && n >= 12; i++)
        count[i] = u32_at(bytes + 4 * i);
    for (int i = 0; i < 3; i++)
        if (count[i] < 2 || count[i] > MERL_MOST)
            return err_at(at, "no table of a measured BRDF, expected three counts from 2 to %d",
                          MERL_MOST);
    all = (size_t)count[0] * count[1];
    if ((n - 12) / 24 / all != count[2] || (n - 12) % (24 * all) != 0)
        return err_at(at, "the file has %lu bytes, expected three times %lu x %lu x %lu doubles",
                      (unsigned long)n, (unsigned long)count[0], (unsigned long)count[1],
                      (unsigned long)count[2]);
    all *= count[2];
    m->nh = count[0];
    m->nd = count[1];
    m->np = count[2];
    m->f = MEM_ARRAY(Rgb, all);
    for (size_t i = 0; m->f && i < all; i++) {
        m->f[i].r = (float)d_min(value_at(bytes + 12 + 8 * i) * scale[0], 1e6);
        m->f[i].g = (float)d_min(value_at(bytes + 12 + 8 * (all + i)) * scale[1], 1e6);
        m->f[i].b = (float)d_min(value_at(bytes + 12 + 8 * (2 * all + i)) * scale[2], 1e6);
    }
    return m->f != NULL;
}

void merl_clear(Merl *m)
{
    mem_free(m->f);
    m->f = NULL;
}

/* The two cells about x, in cells, whose middles are at halves; *t weighs the second. */
static void between(double x, uint32_t n, bool wraps, uint32_t *a, uint32_t *b, float *t)
{
    double below = floor(x - 0.5);
    int64_t i = (int64_t)below, last = (int64_t)n - 1;

    *t = (float)(x - 0.5 - below);
    *a = (uint32_t)(i < 0 ? (wraps ? last : 0) : i > last ? last : i);
    *b = (uint32_t)(i >= last ? (wraps ? 0 : last) : i + 1);
}

static Rgb along_phi(const Merl *m, uint32_t h, uint32_t d, uint32_t p, uint32_t q, float t)
{
    const Rgb *row = m->f + ((size_t)h * m->nd + d) * m->np;
    return rgb_add(rgb_scale(row[p], 1.0f - t), rgb_scale(row[q], t));
}

static Rgb at_angles(const Merl *m, double h, double d, double p)
{
    uint32_t h0, h1, d0, d1, p0, p1;
    float th, td, tp;
    Rgb a, b;

    between(h * m->nh, m->nh, false, &h0, &h1, &th);
    between(d * m->nd, m->nd, false, &d0, &d1, &td);
    between(p * m->np, m->np, true, &p0, &p1, &tp);
    a = rgb_add(rgb_scale(along_phi(m, h0, d0, p0, p1, tp), 1.0f - td),
                rgb_scale(along_phi(m, h0, d1, p0, p1, tp), td));
    b = rgb_add(rgb_scale(along_phi(m, h1, d0, p0, p1, tp), 1.0f - td),
                rgb_scale(along_phi(m, h1, d1, p0, p1, tp), td));
    return rgb_add(rgb_scale(a, 1.0f - th), rgb_scale(b, th));
}

/* The difference vector is wi turned so that h is the pole: its azimuth is measured from the plane
 * of h and the normal. With e = wi - wo, along which it points from h, the two coordinates are
 *   e . (h x n) x h and e . (h x n), both over the length of h x n. */
Rgb merl_f(const Merl *m, V3 wo, V3 wi)
{
    Half h = half_of(wo, wi);
    double x = (double)wi.x - wo.x, y = (double)wi.y - wo.y, z = (double)wi.z - wo.z;
    double r2 = h.x * h.x + h.y * h.y, across = x * h.y - y * h.x, turn;
    double down = (x * h.x + y * h.y) * h.z - z * r2, diff = sqrt(x * x + y * y + z * z);
    double theta_h = md_atan2(sqrt(r2), h.z), theta_d = md_atan2(diff, sqrt(h.length2));

    down /= d_max(sqrt(h.length2), 1e-12);
    turn = r2 > 1e-20 && diff > 1e-10 ? md_atan2(-across, down) : 0.0;
    turn /= PI;
    turn -= floor(turn);                        /* reciprocity: half a turn is none */
    return at_angles(m, sqrt(d_min(theta_h / (0.5 * PI), 1.0)), d_min(theta_d / (0.5 * PI), 1.0),
                     turn);
}

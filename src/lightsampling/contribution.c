/* contribution.c -- the light sampler `contribution`: a light in proportion to what it would bring
 * to the point if nothing stood in between.
 *
 * Source      [Shirley91 5.4.3]: one shadow ray for all lights, one canonical number that chooses
 *             the light and is used again for the point on it. The number left over is (u - a) / w
 *             for the chosen interval [a, a + w): errata 001.4.
 * Estimates   light_estimate(): of the irradiance, by the light's middle and size. It is above 0
 *             wherever the light can contribute, so nothing is lost, and where it is 0 no ray is.
 * Cost        One estimate a light for each choice and each probability: for tens of lights. */
#include "base/mem.h"
#include "lightsampling/lightsampler.h"

static LightSampler *open_contribution(const Scene *s, const Opts *o)
{
    LightSampler *ls = MEM_NEW(LightSampler);
    (void)o;
    if (ls)
        ls->scene = s;
    return ls;
}

static double share(const LightSampler *ls, V3 p, V3 n, size_t i)
{
    return light_estimate(ls->scene->lights[i], p, n);
}

/* Of all, by adding up in order: pick and pmf have the same bits. */
static double total(const LightSampler *ls, V3 p, V3 n)
{
    double sum = 0.0;

    for (size_t i = 0; i < ls->scene->nlights; i++)
        sum += share(ls, p, n, i);
    return sum;
}

enum { KEPT = 64 };             /* estimates that are remembered between the two walks */

static const Light *pick(const LightSampler *ls, V3 p, V3 n, float u, float *pmf, float *left)
{
    size_t count = ls->scene->nlights, last = count;
    double kept[KEPT], sum = 0.0, x, w = 0.0, a = 0.0;

    for (size_t i = 0; i < count; i++) {
        double e = share(ls, p, n, i);
        if (i < KEPT)
            kept[i] = e;
        if (e > 0.0)
            last = i;
        sum += e;
    }
    if (last == count)
        return NULL;
    x = u * sum;
    for (size_t i = 0; i <= last; i++, a += w) {
        w = i < KEPT ? kept[i] : share(ls, p, n, i);
        if (w > 0.0 && (x < a + w || i == last)) {      /* the last one: x was rounded up */
            *pmf = (float)(w / sum);
            *left = f_min(f_max((float)((x - a) / w), 0.0f), ONE_MINUS_ULP);
            return *pmf > 0.0f ? ls->scene->lights[i] : NULL;
        }
    }
    return NULL;
}

static float pmf_of(const LightSampler *ls, V3 p, V3 n, const Light *l)
{
    double sum = total(ls, p, n);
    return sum > 0.0 ? (float)(share(ls, p, n, l->index) / sum) : 0.0f;
}

static void close_contribution(LightSampler *ls) { mem_free(ls); }

const LightSamplerKind lightsampler_contribution = {
    .info = { "contribution", "Shirley91 5.4.3",
              "a light in proportion to what it would bring to the point unhindered", NULL },
    .open = open_contribution, .pick = pick, .pmf = pmf_of, .close = close_contribution
};

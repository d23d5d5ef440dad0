/* resample.c -- resampled importance sampling: many tentative samples without visibility, of which
 * few are kept and looked at.
 *
 * Source      [Cline07 4.4.4, (4.9), (4.10)] with errata 4.1: q_i is in proportion to f_i / p_i. Of
 *             M tentative samples N are kept, with replacement, and
 *                 estimate = (1/N) sum over the kept of V_k  times  (1/M) sum_j f_j / p_j.
 * Mixture     M_l samples by lights and M_s by scattering have the density p = (M_l p_l + M_s p_s)
 *             / M together, so f_j / (M p_j) is what lighting.h calls a candidate, weighed by the
 *             balance heuristic: the second factor is the sum of the candidates, and any other
 *             heuristic serves as well, since in expectation
 *                 sum_j q_j V_j (sum c) = sum_j c_j V_j
 *             is the sum of a plain estimate with M rays.
 * Colours     q goes by luminance; the kept one brings its colour over its luminance.
 * Kept        by N equal steps through the sum of luminances, the first by chance: each step falls
 *             on j with probability q_j, and no two differ more than they must.
 * Delta       Delta lights are among the candidates like all others, with weight 1. */
#include "integrators/lighting.h"

Resampling resampling_of(int tentative, int kept, float light_share)
{
    Resampling r;

    r.by_light = (int)((float)tentative * light_share + 0.5f);
    if (light_share > 0.0f && r.by_light == 0)
        r.by_light = 1;
    if (light_share < 1.0f && r.by_light == tentative && tentative > 1)
        r.by_light = tentative - 1;
    r.by_scattering = tentative - r.by_light;
    r.kept = kept;
    return r;
}

/* Those that could add anything; how many. */
static int tentative(const Lighting *it, const Resampling *r, const Turn *u, Tracer *t,
                     Candidate c[TENTATIVE_MOST])
{
    int n = 0;                  /* not next to a Draw: one compiler, tcc 0.9.27, stores 16 of its */
    float nl = (float)r->by_light, ns = (float)r->by_scattering;        /* 12 bytes */
    Draw draw, first = { 0, { 0, 0 } };

    if (r->by_light)
        first = draw_first(t, u, DECIDE_LIGHT, DECIDE_LIGHT_POINT);
    for (int i = 0; i < r->by_light; i++) {
        draw = draw_number(&first, (uint32_t)i);
        n += candidate_by_light(it, u, &draw, nl, ns, t, &c[n]);
    }
    if (r->by_scattering)
        first = draw_first(t, u, DECIDE_TRY_LOBE, DECIDE_TRY_DIRECTION);
    for (int i = 0; i < r->by_scattering; i++) {
        draw = draw_number(&first, (uint32_t)i);
        n += candidate_by_scattering(it, u, &draw, nl, ns, t, &c[n]);
    }
    return n;
}

static double sum_of(const Candidate *c, int n)
{
    double sum = 0.0;
    for (int i = 0; i < n; i++)
        sum += rgb_lum(c[i].c);
    return sum;
}

/* Goes on from *j, the sum of those before it being *before, to where x of the sum is. */
static void find(const Candidate *c, int n, double x, int *j, double *before)
{
    while (*j < n - 1 && *before + rgb_lum(c[*j].c) <= x)
        *before += rgb_lum(c[(*j)++].c);
}

Rgb resample(const Lighting *it, const Resampling *r, const Turn *u, Tracer *t)
{
    Candidate c[TENTATIVE_MOST];
    int n = tentative(it, r, u, t, c), j = 0, last = -1;
    double sum = sum_of(c, n), before = 0.0, step = sum / r->kept;
    Rgb light = rgb_all(0.0f), one = light;
    float first;

    if (!(sum > 0.0))
        return light;
    first = sample_1d(&t->sampler, DECISION(DECIDE_KEEP, u->at));
    for (int k = 0; k < r->kept; k++) {
        find(c, n, (k + (double)first) * step, &j, &before);
        if (j != last) {                /* the ray of one that is kept again is cast once */
            Candidate kept = c[j];
            float lum = rgb_lum(kept.c);
            kept.c = rgb_scale(kept.c, lum > 0.0f ? (float)(step / lum) : 0.0f);
            one = candidate_light(&kept, u, t);
            last = j;
        } else
            tracer_tally(t, u->at + 2, c[j].how, rgb_mul(u->to_eye, one));
        light = rgb_add(light, one);
    }
    return light;
}

bool resample_one(const Lighting *it, const Resampling *r, const Turn *u, Tracer *t,
                  Candidate *kept)
{
    Candidate c[TENTATIVE_MOST];
    int n = tentative(it, r, u, t, c), j = 0;
    double sum = sum_of(c, n), before = 0.0;
    float lum;

    if (!(sum > 0.0))
        return false;
    find(c, n, sum * (double)sample_1d(&t->sampler, DECISION(DECIDE_KEEP, u->at)), &j, &before);
    lum = rgb_lum(c[j].c);
    if (!(lum > 0.0f))
        return false;
    *kept = c[j];
    kept->c = rgb_scale(kept->c, (float)(sum / lum));
    return true;
}

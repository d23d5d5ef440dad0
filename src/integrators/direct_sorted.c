/* direct_sorted.c -- direct light from many lights: all are looked at without shadows, and rays are
 * spent on those that would bring the most.
 *
 * Source      [Ward91], as [Cline07 4.4.2] tells it, and the unbiased variant of [Shirley96].
 * Both        One sample of each light, sorted by luminance without shadows. Rays go to the first
 *             of them, until what is left is at most `tolerance` of the whole.
 * ward        The rest is added unseen, times the part of what was tested that got through. That
 *             is a guess: biased where the rest is shadowed more or less than the first are.
 *             Departs: the statistics are those of the point, not of each light over the picture
 *             so far, since a pixel must not depend on the order of work.
 * shirley     Of the rest, with contributions c_i that add up to R, one is tested, chosen with
 *             probability c_i / R: it adds V_i c_i / (c_i / R). Given the samples, the mean is sum
 *             V_i c_i, so nothing is lost, with one ray more. */
#include "integrators/direct.h"

#include "base/mem.h"

#include <stdlib.h>

/* Contributions of lights beyond so many are tested one by one as they come. */
enum { SORTED_MOST = 256 };

typedef struct { float lum; int index; } Rank;

static int by_size(const void *a, const void *b)
{
    const Rank *x = a, *y = b;
    if (x->lum != y->lum)
        return x->lum > y->lum ? -1 : 1;
    return x->index - y->index;
}

/* One of the rest, tested for all of them. */
static Rgb one_for_all(Candidate *c, const Rank *rank, int n, double rest, const Turn *u,
                       Tracer *t)
{
    double x = rest * (double)sample_1d(&t->sampler, DECISION(DECIDE_KEEP, u->at)), before = 0.0;
    int i = 0;

    while (i < n - 1 && before + rank[i].lum <= x)
        before += rank[i++].lum;
    if (!(rank[i].lum > 0.0f))
        return rgb_all(0.0f);
    c += rank[i].index;
    c->c = rgb_scale(c->c, (float)(rest / rank[i].lum));
    return candidate_light(c, u, t);
}

/* The part of an untested light that is thought to get through. */
static Rgb guessed(const Candidate *c, float part, const Turn *u, Tracer *t)
{
    Rgb guess = rgb_scale(c->c, part);

    tracer_tally(t, u->at + 2, c->how, rgb_mul(u->to_eye, guess));
    return guess;
}

static Rgb of_candidates(const Direct *it, Candidate *c, int n, const Turn *u, Tracer *t)
{
    double all = 0.0, rest, tested = 0.0, through = 0.0;
    Rgb sum = rgb_all(0.0f);
    Rank rank[SORTED_MOST];
    int i;

    for (i = 0; i < n; i++) {
        rank[i] = (Rank){ rgb_lum(c[i].c), i };
        all += rank[i].lum;
    }
    qsort(rank, (size_t)n, sizeof rank[0], by_size);
    rest = all;
    for (i = 0; i < n && rest > it->tolerance * all; i++) {
        Rgb one = candidate_light(&c[rank[i].index], u, t);
        tested += rank[i].lum;
        through += rgb_lum(one);
        sum = rgb_add(sum, one);
        rest -= rank[i].lum;
    }
    if (i == n)
        return sum;
    if (it->which == LIGHTS_SHIRLEY)
        return rgb_add(sum, one_for_all(c, rank + i, n - i, rest, u, t));
    for (; i < n; i++)
        sum = rgb_add(sum, guessed(&c[rank[i].index], (float)(through / tested), u, t));
    return sum;
}

static Rgb light(const Direct *it, const Turn *u, Tracer *t)
{
    Draw draw, first = draw_first(t, u, DECIDE_LIGHT, DECIDE_LIGHT_POINT);
    const Scene *s = it->base.scene;
    Candidate c[SORTED_MOST];
    uint32_t number = 0;
    Rgb sum = rgb_all(0.0f);

    for (int i = 0; i < it->lightsamples; i++) {
        int n = 0;
        for (size_t k = 0; k < s->nlights; k++) {
            draw = draw_number(&first, number++);
            if (candidate_of_light(&it->lighting, u, s->lights[k], 1.0f, draw.point,
                                   (float)it->lightsamples, 0.0f, t, &c[n]))
                n++;
            if (n == SORTED_MOST)
                sum = rgb_add(sum, candidate_light(&c[--n], u, t));
        }
        sum = rgb_add(sum, of_candidates(it, c, n, u, t));
    }
    return sum;
}

const DirectStrategy direct_sorted = {
    .name = "sorted", .finds_deltas = true, .light = light
};

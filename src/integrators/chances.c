/* chances.c -- the code of `chances.h`. */
#include "integrators/chances.h"

/* Of each delta event, and the rest, which is that of the smooth part. */
typedef struct {
    BsdfSample event[BSDF_DELTAS];
    uint32_t name[BSDF_DELTAS];
    float chance[BSDF_DELTAS], smooth;
    int   n;
} Choices;

enum { SMOOTH_LEAST = 16 };             /* the smooth part has at least this part of the chance */

/* By energy: the square of the index ratio is no part of that. */
static void choices(const Vertex *at, V3 from, Choices *c)
{
    const Bsdf *b = at->b;
    float sum = 0.0f, rest = 0.0f;

    c->n = b->flags & BSDF_SPECULAR ? path_deltas(at, from, c->event, c->name) : 0;
    for (int k = 0; k < c->n; k++) {
        c->chance[k] = rgb_lum(c->event[k].weight) * f_sqr(c->event[k].eta);
        sum += c->chance[k];
    }
    if (b->flags & BSDF_SMOOTH)
        rest = f_max(rgb_lum(b->kind->albedo(b, from)) - sum, sum / (SMOOTH_LEAST - 1));
    if (sum + rest > 0.0f)
        for (int k = 0; k < c->n; k++)
            c->chance[k] /= sum + rest;
    c->smooth = sum > 0.0f ? rest / (sum + rest) : b->flags & BSDF_SMOOTH ? 1.0f : 0.0f;
}

static bool only_smooth(const Vertex *at) { return !(at->b->flags & BSDF_SPECULAR); }

/* Of a smooth direction. 0: lost. */
static float draws_smooth(const Vertex *at, V3 from, bool particle, float lobe, int number,
                          Tracer *t, BsdfSample *s)
{
    V2 u = sample_2d(&t->sampler, DECISION(DECIDE_DIRECTION, number));

    return at->b->kind->sample(at->b, from, lobe, u, particle, s) ? f_max(s->pdf_w, 0.0f) : 0.0f;
}

/* What is left of the number that chose, chooses within the smooth part. */
float chance_draws(const Vertex *at, V3 from, bool particle, int number, Tracer *t, uint32_t *event,
                   BsdfSample *s)
{
    float u = at->b->flags & BSDF_LOBES ? sample_1d(&t->sampler, DECISION(DECIDE_LOBE, number)) : 0;
    Choices c;

    *event = EVENT_SMOOTH;
    if (only_smooth(at))
        return draws_smooth(at, from, particle, u, number, t, s);
    choices(at, from, &c);
    for (int k = 0; k < c.n; u -= c.chance[k++])
        if (u < c.chance[k]) {
            *s = c.event[k];
            *event = c.name[k];
            if (particle)
                s->weight = rgb_scale(s->weight, f_sqr(s->eta));
            return c.chance[k];
        }
    if (!(c.smooth > 0.0f))
        return 0.0f;
    return c.smooth * draws_smooth(at, from, particle, f_min(f_max(u, 0) / c.smooth,
                                                             ONE_MINUS_ULP), number, t, s);
}

float chance_of(const Vertex *at, V3 from, V3 to, uint32_t event)
{
    Choices c;

    if (event == EVENT_SMOOTH && only_smooth(at))
        return at->b->kind->pdf_w(at->b, from, to);
    choices(at, from, &c);
    if (event == EVENT_SMOOTH)
        return c.smooth * at->b->kind->pdf_w(at->b, from, to);
    for (int k = 0; k < c.n; k++)
        if (c.name[k] == event)
            return c.chance[k];
    return 0.0f;
}

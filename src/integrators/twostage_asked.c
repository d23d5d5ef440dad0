/* twostage_asked.c -- lights whose products with a turn are made one by one: lamps with pictures,
 * and the sky by colour. See twostage.h, product.h. */
#include "integrators/twostage.h"

#include "sampling/pattern.h"

/* ---- which ---- */

static float power_of(const Light *l) { return rgb_lum(l->kind->power(l)); }

/* The lamp of most power that is a rectangle with a picture and has no map yet; NULL: none. */
static const Light *next_lamp(const TwoStage *it, const Scene *s, LightRectangle *r)
{
    const Light *best = NULL;
    float most = 0.0f;

    for (size_t i = 0; i < s->nlights; i++) {
        const Light *l = s->lights[i];
        if (l->kind->places && power_of(l) > most && !twostage_asks(it, l) &&
            l->kind->places->rectangle(l, r)) {
            most = power_of(l);
            best = l;
        }
    }
    return best && best->kind->places->rectangle(best, r) ? best : NULL;
}

bool twostage_find_asked(TwoStage *it, const Scene *s)
{
    LightRectangle r;
    const Light *l;

    if (it->light && it->colour) {
        if (!lightmap_init(&it->asked[0], it->light, NULL, true))
            return false;
        it->nasked = 1;
    }
    for (int k = 0; k < TWOSTAGE_LAMPS && (l = next_lamp(it, s, &r)) != NULL; k++) {
        if (!lightmap_init(&it->asked[it->nasked], l, &r, it->colour))
            return false;
        it->nasked++;
    }
    return true;
}

bool twostage_asks(const TwoStage *it, const Light *l)
{
    bool any = l == it->light;

    for (int k = 0; k < it->nasked; k++)
        any |= l == it->asked[k].light;
    return any;
}

/* ---- points ---- */

/* For light number k: by the roots of x^3 = x + 1, so that several keep apart. [Roberts18] */
static V2 shift_of(V2 u, int k)
{
    for (; k > 0; k--)
        u = (V2){ moved_round(u.x, 0.7548777f), moved_round(u.y, 0.5698403f) };
    return u;
}

/* ---- their light ---- */

static bool product_of(const TwoStage *it, int k, const Turn *u, int samples, Tracer *t,
                       Product *p)
{
    V3 peak[TWOSTAGE_PEAKS_MOST];
    int n = twostage_peaks(it, u, samples, t, peak);

    return product_make(p, &it->asked[k], u, peak, n, it->sampled, twostage_splits(it, samples));
}

static Rgb light_of(const TwoStage *it, int k, const Turn *u, int samples, V2 by, Tracer *t)
{
    Rgb sum = rgb_all(0.0f);
    PartitionSample s;
    Candidate c;
    Product p;

    if (!product_of(it, k, u, samples, t, &p))
        return sum;
    for (int i = 0; i < samples; i++) {
        product_draw(&p, hammersley_moved((uint32_t)i, (uint32_t)samples, by), &s);
        if (product_candidate(&p, &s, u, (float)samples, &c))
            sum = rgb_add(sum, candidate_light(&c, u, t));
    }
    return sum;
}

Rgb twostage_asked_light(const TwoStage *it, const Turn *u, int samples, Tracer *t)
{
    Rgb sum = rgb_all(0.0f);
    V2 by = { 0, 0 };

    if (it->nasked)
        by = sample_2d(&t->sampler, DECISION(DECIDE_PICTURE, u->at));
    for (int k = 0; k < it->nasked; k++)
        sum = rgb_add(sum, light_of(it, k, u, samples, shift_of(by, k), t));
    return sum;
}

bool twostage_asked_candidate(const TwoStage *it, int k, const Turn *u, Tracer *t, Candidate *c)
{
    V2 by = sample_2d(&t->sampler, DECISION(DECIDE_PICTURE, u->at));
    PartitionSample s;
    Product p;

    if (!product_of(it, k, u, 1, t, &p))
        return false;
    product_draw(&p, shift_of(by, k), &s);
    return product_candidate(&p, &s, u, 1.0f, c);
}

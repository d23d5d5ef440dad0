/* direct_mis.c -- direct light by multiple importance sampling: some directions by the lights, some
 * by the surface, each weighed by the heuristic on what both would have done.
 *
 * Source: [Cline07 4.4.1 to 4.4.3], [Veach97 9.2]. The two ways by themselves are the cases in
 * which the other one has no samples: then all weights are 1. */
#include "integrators/direct.h"

/* n candidates of one kind, by numbers of these decisions. */
static Rgb drawn(const Direct *it, const Turn *u, CandidateBy *by, DecisionKind choice,
                 DecisionKind point, int n, float nl, float ns, Tracer *t)
{
    Draw draw, first = draw_first(t, u, choice, point);
    Rgb sum = rgb_all(0.0f);
    Candidate c;

    for (int i = 0; i < n; i++) {
        draw = draw_number(&first, (uint32_t)i);
        if (by(&it->lighting, u, &draw, nl, ns, t, &c))
            sum = rgb_add(sum, candidate_light(&c, u, t));
    }
    return sum;
}

/* Every light has its shadow rays, and numbers further on round the cube. */
static Rgb by_all_lights(const Direct *it, const Turn *u, float nl, float ns, Tracer *t)
{
    Draw draw, first = draw_first(t, u, DECIDE_LIGHT, DECIDE_LIGHT_POINT);
    uint32_t number = 0;
    Rgb sum = rgb_all(0.0f);
    Candidate c;

    for (size_t k = 0; k < it->base.scene->nlights; k++) {
        const Light *l = it->base.scene->lights[k];
        for (int i = 0; i < it->lightsamples; i++) {
            draw = draw_number(&first, number++);
            if (candidate_of_light(&it->lighting, u, l, 1.0f, draw.point, nl, ns, t, &c))
                sum = rgb_add(sum, candidate_light(&c, u, t));
            if (l->kind->delta)         /* which says the same again */
                break;
        }
    }
    return sum;
}

static Rgb light_by(const Direct *it, const Turn *u, float nl, float ns, Tracer *t)
{
    Rgb sum = rgb_all(0.0f);

    if (nl > 0.0f && it->which == LIGHTS_ALL)
        sum = by_all_lights(it, u, nl, ns, t);
    else if (nl > 0.0f)
        sum = drawn(it, u, candidate_by_light, DECIDE_LIGHT, DECIDE_LIGHT_POINT, it->lightsamples,
                    nl, ns, t);
    if (ns > 0.0f)
        sum = rgb_add(sum, drawn(it, u, candidate_by_scattering, DECIDE_LOBE, DECIDE_DIRECTION,
                                 it->bsdfsamples, nl, ns, t));
    return sum;
}

static Rgb mis(const Direct *it, const Turn *u, Tracer *t)
{
    return light_by(it, u, (float)it->lightsamples, (float)it->bsdfsamples, t);
}

static bool open_mis(Direct *it, const Opts *o)
{
    (void)o;
    lighting_shares(&it->lighting, it->lightsamples, it->bsdfsamples);
    return true;
}

static Rgb brdf(const Direct *it, const Turn *u, Tracer *t)
{
    return light_by(it, u, 0.0f, (float)it->bsdfsamples, t);
}

static Rgb by_lights(const Direct *it, const Turn *u, Tracer *t)
{
    return light_by(it, u, (float)it->lightsamples, 0.0f, t);
}

const DirectStrategy direct_brdf = {
    .name = "brdf", .light = brdf           /* [Cline07 4.4.1] */
};
const DirectStrategy direct_light = {
    .name = "light", .finds_deltas = true, .light = by_lights       /* [Cline07 4.4.2] */
};
const DirectStrategy direct_mis = {
    .name = "mis", .finds_deltas = true, .open = open_mis, .light = mis
};

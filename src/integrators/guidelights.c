/* guidelights.c -- a guide's choice of lights, and of points on them: see guide.h.
 *
 * Source      [Cline07 9.2]; errata 9.2, 9.4.
 * Lights      A share of the choices is made by the map, the others by the light sampler; the
 *             probability is that of both together.
 * Points      The map warps the numbers that choose a point. Where a light can tell the numbers
 *             that would have given a direction, the density is known of every direction. */
#include "integrators/guideinner.h"

/* The entry of a light: if there are more lights than entries, several have one. */
static int entry_of(const Guide *g, int map, const Light *l)
{
    uint64_t n = (uint64_t)g->plan->shape[map].w;
    return (int)(l->index * n / g->plan->scene->nlights);
}

/* The first light of an entry: entry_of() of it is `entry`, and of the one before it is not. */
static size_t first_of(const Guide *g, int map, int entry)
{
    uint64_t n = (uint64_t)g->plan->shape[map].w;
    return (size_t)(((uint64_t)entry * g->plan->scene->nlights + n - 1) / n);
}

static float pmf_by_map(const Guide *g, int map, const Light *l)
{
    int i = entry_of(g, map, l);
    return inverted_pmf(&g->table[map], i) /
           (float)(first_of(g, map, i + 1) - first_of(g, map, i));
}

static const Light *light_by_map(const Guide *g, int map, float u)
{
    const Scene *s = g->plan->scene;
    size_t first, n, k;
    float rest;
    int i = inverted_choose(&g->table[map], u, &rest);

    first = first_of(g, map, i);
    n = first_of(g, map, i + 1) - first;
    k = (size_t)(rest * (float)n);
    return s->lights[first + (k < n ? k : n - 1)];
}

float guide_light_pmf(const Guide *g, const LightSampler *ls, V3 p, V3 n, const Light *l)
{
    float own = ls->kind->pmf(ls, p, n, l);
    int map = guide_map_here(g, GUIDE_LIGHT);

    return map < 0 ? own : learned_both(g->share[map], pmf_by_map(g, map, l), own);
}

const Light *guide_light(Guide *g, const LightSampler *ls, V3 p, V3 n, float u, float *pmf)
{
    const Light *l;
    float left, share;
    int map = guide_map_here(g, GUIDE_LIGHT);

    if (map < 0)
        return ls->kind->pick(ls, p, n, u, pmf, &left);
    share = g->share[map];
    if (u < share)
        l = light_by_map(g, map, f_min(u / share, ONE_MINUS_ULP));
    else
        l = ls->kind->pick(ls, p, n, f_min((u - share) / (1.0f - share), ONE_MINUS_ULP), pmf,
                           &left);
    if (!l)
        return NULL;
    g->decided[map] = (Decided){ .used = true, .own = ls->kind->pmf(ls, p, n, l),
                                 .map = pmf_by_map(g, map, l) };
    g->decided[map].place.x = ((float)entry_of(g, map, l) + 0.5f) / (float)g->plan->shape[map].w;
    *pmf = learned_both(share, g->decided[map].map, g->decided[map].own);
    return l;
}

/* The number of a direction to a light, in the map of the vertex; the last answer is kept, as
 * weights and what is learned ask for the same. False: nobody knows, or there is no such map. */
static bool number_of(Guide *g, const Light *l, bool beside, V3 wi, int *map, V2 *u)
{
    bool asked = g->met == l && g->met_wi.x == wi.x && g->met_wi.y == wi.y &&
                 g->met_wi.z == wi.z;

    *map = guide_map_here(g, GUIDE_POINT);
    if (*map < 0 || !l->kind->numbers)
        return false;
    if (!asked && !l->kind->numbers(l, beside, wi, &g->met_number))
        return false;
    g->met = l;
    g->met_wi = wi;
    *u = g->met_number;
    return true;
}

float guide_point_pdf(Guide *g, const Light *l, bool beside, V3 wi)
{
    int map;
    V2 u;

    return number_of(g, l, beside, wi, &map, &u) ? inverted_density(&g->table[map], u) : 1.0f;
}

void guide_points(const Guide *g, const Light *l, bool beside, LightSample *s, float *pdf)
{
    if (g->point_density == 1.0f)
        return;
    if (l->kind->numbers && l->kind->numbers(l, beside, s->wi, NULL))
        *pdf *= g->point_density;
    else
        s->L = rgb_scale(s->L, 1.0f / g->point_density);
}

void guide_met(Guide *g, const Light *l, bool beside, V3 wi, float density, Rgb light)
{
    float value = rgb_lum(light);
    int map;
    V2 u;

    if (number_of(g, l, beside, wi, &map, &u))
        learned_add(g->worth + g->plan->at[map], g->plan->shape[map], u, value * value * density);
}

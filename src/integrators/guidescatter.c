/* guidescatter.c -- where a guide has light go on: the direction from a surface, or the way at one
 * that reflects and refracts: see guide.h.
 *
 * Source      [Cline07 9.2, (9.2)]; errata 9.2 to 9.4.
 * Directions  A share of them is drawn by a map over longitude and latitude, the others by the
 *             vertex; the density of either is that of both together.
 * Forks       Of two delta events one is chosen, by the map as far as it is trusted. */
#include "integrators/guideinner.h"

/* ---- directions ---- */

/* Longitude and latitude of the world, as places of a map. */
static V2 place_of(V3 w)
{
    float x = m_atan2(w.y, w.x) * (0.5f * INV_PI), y = m_acos(w.z) * INV_PI;
    return (V2){ f_min(x < 0.0f ? x + 1.0f : x, ONE_MINUS_ULP), f_min(y, ONE_MINUS_ULP) };
}

/* d omega = 2 pi^2 sin(theta) d place, errata 5.1. */
static float density_w(float density, float sine)
{
    return sine > 0.0f ? density / (2.0f * PI_F * PI_F * sine) : 0.0f;
}

static float map_pdf_w(const Guide *g, int map, V3 w, V2 place)
{
    float sine = sqrtf(w.x * w.x + w.y * w.y);
    return density_w(inverted_density(&g->table[map], place), sine);
}

static V3 direction_at(V2 place)
{
    float st, ct, sp, cp;

    m_sincos_turn(0.5f * place.y, &st, &ct);
    m_sincos_turn(place.x, &sp, &cp);
    return v3(st * cp, st * sp, ct);
}

/* The map by which a share of directions goes; -1: none does. */
static int map_in_use(const Guide *g)
{
    int map = guide_map_here(g, GUIDE_DIRECTION);
    return map >= 0 && g->share[map] > 0.0f ? map : -1;
}

float guide_pdf_w(const Guide *g, V3 wi, float own)
{
    int map = map_in_use(g);

    if (map < 0)
        return own;
    return learned_both(g->share[map], map_pdf_w(g, map, wi, place_of(wi)), own);
}

void guide_places(const Guide *g, int map, Decided *d)
{
    float sine = sqrtf(d->way.x * d->way.x + d->way.y * d->way.y);

    d->place = place_of(d->way);
    d->map = density_w(inverted_alone(&g->table[map], d->place), sine);
}

/* Density of a direction by the map, which is noted with its place: to look for both takes long. */
static float noted_pdf_w(Guide *g, int map, V3 wi)
{
    Decided *d = &g->decided[map];

    d->place = place_of(wi);
    d->map = map_pdf_w(g, map, wi, d->place);
    return d->map;
}

/* A direction by the map, as if the vertex had made it. */
static bool scatters_by_map(Guide *g, int map, const Vertex *v, V2 u, BsdfSample *s,
                            float *thinned)
{
    float density, own;
    V3 local;

    s->wi = direction_at(inverted_sample(&g->table[map], u, &density));
    if (!vertex_local(v, s->wi, &local))
        return false;
    own = vertex_pdf_w(v, local);
    s->pdf_w = learned_both(g->share[map], noted_pdf_w(g, map, s->wi), own);
    s->weight = rgb_scale(vertex_f_cos(v, local), 1.0f / s->pdf_w);
    s->flags = BSDF_SMOOTH | (same_side(local, v->wo) ? BSDF_REFLECT : BSDF_TRANSMIT);
    s->eta = 1.0f;
    *thinned = s->pdf_w / f_max(own, 1e-6f * s->pdf_w);
    return s->pdf_w > 0.0f && !rgb_black(s->weight);
}

/* The same by the vertex, where a share goes by the map. */
static bool scatters_beside_map(Guide *g, int map, const Vertex *v, Tracer *t, int at,
                                BsdfSample *s, float *thinned)
{
    float own;

    if (!vertex_sample(v, t, at, s))
        return false;
    own = s->pdf_w;
    if (own > 0.0f) {
        s->pdf_w = learned_both(g->share[map], noted_pdf_w(g, map, s->wi), own);
        *thinned = s->pdf_w / own;
    } else
        *thinned = 1.0f - g->share[map];
    s->weight = rgb_scale(s->weight, 1.0f / *thinned);
    return true;
}

/* The same where no share does, but the map shall learn. */
static bool scatters_unguided(Guide *g, int map, const Vertex *v, Tracer *t, int at, BsdfSample *s)
{
    if (!vertex_sample(v, t, at, s))
        return false;
    if (map >= 0)
        g->decided[map].way = s->wi;
    return true;
}

static bool scatters_smoothly(Guide *g, int map, const Vertex *v, Tracer *t, int at,
                              BsdfSample *s, float *thinned)
{
    if (map < 0 || g->share[map] == 0.0f)
        return scatters_unguided(g, map, v, t, at, s);
    if (sample_1d(&t->sampler, DECISION(DECIDE_GUIDE, at)) < g->share[map])
        return scatters_by_map(g, map, v, sample_2d(&t->sampler, DECISION(DECIDE_DIRECTION, at)),
                               s, thinned);
    return scatters_beside_map(g, map, v, t, at, s, thinned);
}

/* ---- bifurcations ---- */

static const float *fork_map(const Guide *g, int at)
{
    const GuidePlan *p = g->plan;
    if (at >= p->forks)
        return NULL;
    return g->maps + p->at[GUIDE_BIFURCATION] + FORK_FLOATS * at;
}

/* Probability of refraction, of two delta events, without a map: by the energy that each carries,
 * or even. */
static float own_refraction(const Guide *g, const BsdfSample e[2])
{
    float r = rgb_lum(e[0].weight), t = rgb_lum(e[1].weight) * e[1].eta * e[1].eta;
    if (!(r > 0.0f) || !(t > 0.0f))
        return t > 0.0f ? 1.0f : 0.0f;
    return g->plan->coin ? 0.5f : t / (r + t);
}

static bool scatters_by_fork(Guide *g, const Vertex *v, Tracer *t, int at,
                             const BsdfSample e[2], BsdfSample *s, float *thinned)
{
    const float *map = fork_map(g, at);
    float own = own_refraction(g, e), p = own, share;
    bool refracts;

    if (own > 0.0f && own < 1.0f) {
        share = g->plan->share * map[2];
        p = share * map[1] / (map[0] + map[1]) + (1.0f - share) * own;      /* [Cline07 (9.2)] */
    }
    refracts = sample_1d(&t->sampler, DECISION(DECIDE_LOBE, at)) < p;
    *s = e[refracts];
    s->weight = rgb_scale(s->weight, 1.0f / (refracts ? p : 1.0f - p));
    *thinned = refracts ? p / own : (1.0f - p) / (1.0f - own);
    g->fork[at] = (Fork){ true, refracts, 0.0f };
    g->forked = at;
    return vertex_turns(v, s) && !rgb_black(s->weight);
}

/* Whether the vertex reflects and refracts, and nothing else. */
static bool forks(const Guide *g, const Vertex *v, int at, BsdfSample e[BSDF_DELTAS])
{
    return fork_map(g, at) && v->b->flags & BSDF_SPECULAR && v->b->flags & BSDF_TRANSMIT &&
           !vertex_is_smooth(v) && bsdf_deltas(v->b, v->wo, e) == 2 &&
           e[0].flags & BSDF_REFLECT && e[1].flags & BSDF_TRANSMIT;
}

/* How the direction could have come about, where its place or way is noted. */
static void note_direction(Guide *g, int map, const BsdfSample *s)
{
    Decided *d = &g->decided[map];
    float share = g->share[map];

    d->used = true;
    d->own = s->pdf_w;
    if (share > 0.0f)
        d->own = f_max((s->pdf_w - share * d->map) / (1.0f - share), 0.0f);
    g->direction = map;
}

bool guide_scatters(Guide *g, const Vertex *v, Tracer *t, Beam *b, BsdfSample *s)
{
    BsdfSample e[BSDF_DELTAS];
    int map = guide_map_here(g, GUIDE_DIRECTION);
    float thinned = 1.0f;

    if (!(forks(g, v, b->depth, e) ? scatters_by_fork(g, v, t, b->depth, e, s, &thinned)
                                   : scatters_smoothly(g, map, v, t, b->depth, s, &thinned)))
        return false;
    b->eta2 *= thinned;
    if (map >= 0 && s->pdf_w > 0.0f)
        note_direction(g, map, s);
    return true;
}

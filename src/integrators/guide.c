/* guide.c -- the code of `guide.h` */
#include "integrators/guide.h"

#include "base/mem.h"

#include <string.h>

#define EVEN_WORLD 1e-6f                /* the constant of world maps, over their cells */
#define WORTHWHILE 0.8f                 /* second moment with a map over that without */
#define HARMLESS 1.0f                   /* the same, of preimage maps, whose cost is bounded */
#define MOMENT_MOST 1e6f                /* a density over another */
enum { FORKS_MOST = 64 };

const char *const guide_names[GUIDE_KINDS] = {
    "time", "lens", "bifurcation", "distance", "light", "point", "direction"
};

/* What a sample has decided, for each map: where, and how much light there was before. */
typedef struct {
    bool  used;
    V2    place;
    float own, map;             /* densities without the map, and by it alone */
    float before, gained;       /* light so far; of a connection */
} Decided;

typedef struct { bool used, refracts; float before; } Fork;

struct Guide {
    const GuidePlan *plan;      /* borrowed */
    Sampler inner;              /* the pixel's own */
    float  *maps, *worth;       /* owned: of the pixel; what its samples were worth */
    float  *room;               /* owned: of inverted tables */
    Inverted table[GUIDE_MAPS];
    float   share[GUIDE_MAPS];  /* of what is by the map, the remainder being as without */
    Decided decided[GUIDE_MAPS];                /* by the sample at hand */
    Fork    fork[FORKS_MOST];
    float   pending;            /* over the density of warped numbers, not yet in the throughput */
    float   point_density;
    int     order, here;        /* of vertices that are guided; here: -1, this one is not */
    int     depth;              /* of the vertex at hand */
    int     direction, forked;  /* decided at this event: a map's number, a fork's; -1: not */
};

/* ---- plans ---- */

static bool is_world(int map)
{
    int k = map < GUIDE_DISTANCE ? map
                                 : GUIDE_DISTANCE + (map - GUIDE_DISTANCE) % GUIDE_BOUNCE_MAPS;
    return k == GUIDE_LIGHT || k == GUIDE_DIRECTION;
}

static bool has_forks(const Scene *s)
{
    int both = BSDF_TRANSMIT | BSDF_REFLECT | BSDF_SPECULAR;

    for (size_t i = 0; i < s->nmaterials; i++)
        if ((s->materials[i].kind->flags & both) == both && s->materials[i].kind->deltas)
            return true;
    return false;
}

static bool has_extended_lights(const Scene *s)
{
    for (size_t i = 0; i < s->nlights; i++)
        if (!s->lights[i]->kind->delta)
            return true;
    return false;
}

static bool is_of_use(const Scene *s, GuideKind k)
{
    switch (k) {
    case GUIDE_TIME: return scene_blurs(s);
    case GUIDE_LENS: return s->camera->has_lens;
    case GUIDE_BIFURCATION: return has_forks(s);
    case GUIDE_DISTANCE: return s->nmedia > 0;
    case GUIDE_LIGHT: return s->nlights > 1;
    case GUIDE_POINT: return has_extended_lights(s);
    case GUIDE_DIRECTION:
    case GUIDE_KINDS: break;
    }
    return true;
}

static LearnedShape shape_of(const Scene *s, GuideKind k, int n)
{
    LearnedShape line = { n, 1, false, false };

    switch (k) {
    case GUIDE_BIFURCATION: return (LearnedShape){ FORK_FLOATS * n, 1, false, true };
    case GUIDE_LIGHT:
        return (LearnedShape){ s->nlights < (size_t)n ? (int)s->nlights : n, 1, false, true };
    case GUIDE_LENS:
    case GUIDE_POINT: return (LearnedShape){ n, n, false, false };
    case GUIDE_DIRECTION: return (LearnedShape){ n, n, true, false };
    case GUIDE_TIME:
    case GUIDE_DISTANCE:
    case GUIDE_KINDS: break;
    }
    return line;
}

void guide_plan(GuidePlan *p, const Scene *s, const int cells[GUIDE_KINDS], int bounces,
                float share, bool coin)
{
    memset(p, 0, sizeof *p);
    p->scene = s;
    p->bounces = bounces;
    p->share = share;
    p->coin = coin;
    for (int b = 0; b < bounces; b++)
        for (int k = b ? GUIDE_DISTANCE : 0; k < GUIDE_KINDS; k++) {
            int m = guide_map((GuideKind)k, b);
            if (!cells[k] || !is_of_use(s, (GuideKind)k))
                continue;
            p->shape[m] = shape_of(s, (GuideKind)k, cells[k]);
            p->at[m] = p->floats;
            p->floats += learned_cells(p->shape[m]) + GUIDE_LEVELS;
            p->room[m] = p->rooms;
            p->rooms += inverted_size(p->shape[m]);
        }
}

void guide_forget(const GuidePlan *p, float *maps)
{
    for (int m = 0; m < GUIDE_MAPS; m++) {
        float *mass = maps + p->at[m];
        int n = learned_cells(p->shape[m]);
        if (m == GUIDE_BIFURCATION)
            for (int i = 0; i < n; i++)
                mass[i] = i % FORK_FLOATS < 2 ? 0.5f : 0.0f;
        else if (n)
            learned_uniform(mass, n);
        for (int k = 0; n && k < GUIDE_LEVELS; k++)
            mass[n + k] = 0.0f;
    }
}

Guide *guide_new(const GuidePlan *p)
{
    Guide *g = MEM_NEW(Guide);

    if (!g)
        return NULL;
    g->plan = p;
    g->maps = MEM_ARRAY(float, p->floats);
    g->worth = MEM_ARRAY(float, p->floats);
    g->room = MEM_ARRAY(float, p->rooms);
    if (!g->maps || !g->worth || !g->room) {
        guide_free(g);
        return NULL;
    }
    return g;
}

void guide_free(Guide *g)
{
    if (!g)
        return;
    mem_free(g->maps);
    mem_free(g->worth);
    mem_free(g->room);
    mem_free(g);
}

/* ---- the sampler around the pixel's own ---- */

static bool has(const Guide *g, int map) { return g->plan->shape[map].w != 0; }

static V2 warped(Guide *g, int map, V2 u, float *density)
{
    const GuidePlan *p = g->plan;
    V2 place = inverted_sample(&g->table[map], u, density);

    g->decided[map] = (Decided){ .used = true, .place = place, .own = 1.0f };
    g->decided[map].map = learned_density(g->maps + p->at[map], p->shape[map], place);
    return place;
}

static float guided_one(Sampler *s, Decision d)
{
    Guide *g = s->state;
    int bounce = (int)(d / DECIDE_KINDS), map = -1;
    float u = sample_1d(&g->inner, d), density;

    if (d == DECISION(DECIDE_TIME, 0))
        map = GUIDE_TIME;
    else if (d % DECIDE_KINDS == DECIDE_DISTANCE && bounce < g->plan->bounces)
        map = guide_map(GUIDE_DISTANCE, bounce);
    if (map < 0 || !has(g, map))
        return u;
    u = warped(g, map, (V2){ u, 0.0f }, &density).x;
    g->pending *= density;
    return u;
}

static V2 guided_two(Sampler *s, Decision d)
{
    Guide *g = s->state;
    V2 u = sample_2d(&g->inner, d);
    float density;

    if (d == DECISION(DECIDE_LENS, 0) && has(g, GUIDE_LENS)) {
        u = warped(g, GUIDE_LENS, u, &density);
        g->pending *= density;
    }
    if (d == DECISION(DECIDE_LIGHT_POINT, g->depth) && g->here >= 0 &&
        has(g, guide_map(GUIDE_POINT, g->here)))
        u = warped(g, guide_map(GUIDE_POINT, g->here), u, &g->point_density);
    return u;
}

static void guided_start(Sampler *s)
{
    Guide *g = s->state;

    sampler_start(&g->inner, s->index);
    memset(g->decided, 0, sizeof g->decided);
    memset(g->fork, 0, sizeof g->fork);
    g->pending = g->point_density = 1.0f;
    g->order = g->here = g->direction = g->forked = -1;
    g->depth = 0;
}

static const SamplerKind guided = {
    .info = { "guided", "Cline07 9.2", "numbers warped by learned maps", NULL },
    .start = guided_start, .one = guided_one, .two = guided_two
};

/* ---- pixel by pixel ---- */

static float share_at(const GuidePlan *p, int map, int level)
{
    return (float)level / (GUIDE_LEVELS - 1) * (is_world(map) ? p->share : 1.0f);
}

/* The highest level whose second moment is well below that without the map. Where nothing is known,
 * preimage maps are even, and world maps had better not be asked. */
static int best_level(int map, const float *moment)
{
    int k = GUIDE_LEVELS - 1;

    if (!(moment[0] > 0.0f))
        return is_world(map) ? 0 : k;
    while (k > 0 && !(moment[k] < (is_world(map) ? WORTHWHILE : HARMLESS) * moment[0]))
        k--;
    return k;
}

float *guide_maps(Guide *g) { return g->maps; }

void guide_pixel(Guide *g, Tracer *t, uint32_t x, uint32_t y)
{
    const GuidePlan *p = g->plan;

    g->inner = t->sampler;
    t->sampler.kind = &guided;
    t->sampler.state = g;
    t->guide = g;
    sampler_pixel(&g->inner, x, y);
    memset(g->worth, 0, (size_t)p->floats * sizeof *g->worth);
    for (int m = 0; m < GUIDE_MAPS; m++) {
        const float *mass = g->maps + p->at[m];
        int n = learned_cells(p->shape[m]);
        if (!n || m == GUIDE_BIFURCATION)
            continue;
        g->share[m] = share_at(p, m, best_level(m, mass + n));
        inverted_make(&g->table[m], p->shape[m], mass, is_world(m) ? 1.0f : g->share[m],
                      g->room + p->room[m]);
    }
}

static void merge_forks(float *map, const float *worth, int n)
{
    for (int i = 0; i < n; i += FORK_FLOATS)
        if (learned_merge(map + i, worth + i, 2, EVEN_WORLD))
            map[i + 2] = 0.5f * (map[i + 2] + 1.0f);
}

void guide_learns(Guide *g, Tracer *t)
{
    const GuidePlan *p = g->plan;

    t->sampler = g->inner;
    t->guide = NULL;
    for (int m = 0; m < GUIDE_MAPS; m++) {
        float *mass = g->maps + p->at[m];
        const float *worth = g->worth + p->at[m];
        int n = learned_cells(p->shape[m]);
        float constant = is_world(m) ? EVEN_WORLD / (float)n : 1.0f / (float)n;
        if (m == GUIDE_BIFURCATION)
            merge_forks(mass, worth, n);
        else if (n && learned_merge(mass, worth, n, constant))
            for (int k = 0; k < GUIDE_LEVELS; k++)
                mass[n + k] = 0.5f * (mass[n + k] + worth[n + k]);
    }
}

/* ---- along a path ---- */

/* The throughput is over the densities of numbers that were warped since the last time. */
static void settle(Guide *g, Beam *b)
{
    b->throughput = rgb_scale(b->throughput, 1.0f / g->pending);
    b->eta2 *= g->pending;
    g->pending = 1.0f;
}

void guide_starts(Guide *g, Beam *b) { settle(g, b); }

void guide_flies(Guide *g, Beam *b, Rgb sum)
{
    if (b->depth >= g->plan->bounces)
        return;
    settle(g, b);
    g->decided[guide_map(GUIDE_DISTANCE, b->depth)].before = rgb_lum(sum);
}

void guide_turns(Guide *g, const Beam *b, bool smooth)
{
    g->depth = b->depth;
    if (smooth)
        g->order++;
    g->here = smooth && g->order < g->plan->bounces ? g->order : -1;
    g->direction = g->forked = -1;
    g->point_density = 1.0f;
}

void guide_connected(Guide *g, Rgb light)
{
    if (g->here < 0)
        return;
    g->decided[guide_map(GUIDE_LIGHT, g->here)].gained = rgb_lum(light);
    g->decided[guide_map(GUIDE_POINT, g->here)].gained = rgb_lum(light);
}

void guide_leaves(Guide *g, Rgb sum)
{
    if (g->direction >= 0)
        g->decided[g->direction].before = rgb_lum(sum);
    if (g->forked >= 0)
        g->fork[g->forked].before = rgb_lum(sum);
}

static bool learns_from_connection(int map)
{
    int k = map < GUIDE_DISTANCE ? map
                                 : GUIDE_DISTANCE + (map - GUIDE_DISTANCE) % GUIDE_BOUNCE_MAPS;
    return k == GUIDE_LIGHT || k == GUIDE_POINT;
}

/* What the sample was worth: to the map, and, squared, to the second moments at all levels: of
 * value v found at density p, level k would make v p / p_k of it, p / p_k times as seldom. */
static void learn(Guide *g, int m, const Decided *d, float value)
{
    const GuidePlan *p = g->plan;
    float *worth = g->worth + p->at[m], *moment = worth + learned_cells(p->shape[m]);
    float now = g->share[m] * d->map + (1.0f - g->share[m]) * d->own;

    if (!(value > 0.0f) || !(value < 1e15f))
        return;
    learned_add(worth, p->shape[m], d->place, value);
    for (int k = 0; k < GUIDE_LEVELS; k++) {
        float x = share_at(p, m, k), at = x * d->map + (1.0f - x) * d->own;
        moment[k] += value * value * f_min(now / f_max(at, 1e-30f), MOMENT_MOST);
    }
}

void guide_ends(Guide *g, Rgb sum)
{
    const GuidePlan *p = g->plan;
    int forks = learned_cells(p->shape[GUIDE_BIFURCATION]) / FORK_FLOATS;
    float *fork = g->worth + p->at[GUIDE_BIFURCATION], all = rgb_lum(sum);

    for (int m = 0; m < GUIDE_MAPS; m++) {
        const Decided *d = &g->decided[m];
        if (d->used)
            learn(g, m, d, learns_from_connection(m) ? d->gained : all - d->before);
    }
    for (int i = 0; i < forks; i++)
        if (g->fork[i].used && all > g->fork[i].before && is_finite(all))
            fork[FORK_FLOATS * i + g->fork[i].refracts] += all - g->fork[i].before;
}

/* ---- lights ---- */

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

static bool guides_lights(const Guide *g)
{
    return g->here >= 0 && has(g, guide_map(GUIDE_LIGHT, g->here));
}

float guide_light_pmf(const Guide *g, const LightSampler *ls, V3 p, V3 n, const Light *l)
{
    float own = ls->kind->pmf(ls, p, n, l), share;
    int map;

    if (!guides_lights(g))
        return own;
    map = guide_map(GUIDE_LIGHT, g->here);
    share = g->share[map];
    return share * pmf_by_map(g, map, l) + (1.0f - share) * own;
}

const Light *guide_light(Guide *g, const LightSampler *ls, V3 p, V3 n, float u, float *pmf)
{
    const Light *l;
    float left, share;
    int map;

    if (!guides_lights(g))
        return ls->kind->pick(ls, p, n, u, pmf, &left);
    map = guide_map(GUIDE_LIGHT, g->here);
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
    *pmf = share * g->decided[map].map + (1.0f - share) * g->decided[map].own;
    return l;
}

float guide_point_pdf(const Guide *g, const Light *l, bool beside, V3 wi)
{
    int map = g->here >= 0 ? guide_map(GUIDE_POINT, g->here) : -1;
    V2 u;

    if (map < 0 || !has(g, map) || !l->kind->numbers || !l->kind->numbers(l, beside, wi, &u))
        return 1.0f;
    return inverted_density(&g->table[map], u);
}

void guide_points(const Guide *g, const Light *l, bool beside, LightSample *s, float *pdf)
{
    V2 u;

    if (l->kind->numbers && l->kind->numbers(l, beside, s->wi, &u))
        *pdf *= g->point_density;
    else
        s->L = rgb_scale(s->L, 1.0f / g->point_density);
}

void guide_met(Guide *g, const Light *l, bool beside, V3 wi, Rgb light)
{
    int map = g->here >= 0 ? guide_map(GUIDE_POINT, g->here) : -1;
    V2 u;

    if (map >= 0 && has(g, map) && l->kind->numbers && l->kind->numbers(l, beside, wi, &u))
        learned_add(g->worth + g->plan->at[map], g->plan->shape[map], u, rgb_lum(light));
}

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

static float map_pdf_w(const Guide *g, int map, V3 w)
{
    float sine = sqrtf(w.x * w.x + w.y * w.y);
    return density_w(inverted_density(&g->table[map], place_of(w)), sine);
}

static V3 direction_at(V2 place)
{
    float st, ct, sp, cp;

    m_sincos_turn(0.5f * place.y, &st, &ct);
    m_sincos_turn(place.x, &sp, &cp);
    return v3(st * cp, st * sp, ct);
}

static bool guides_direction(const Guide *g)
{
    return g->here >= 0 && has(g, guide_map(GUIDE_DIRECTION, g->here)) &&
           g->share[guide_map(GUIDE_DIRECTION, g->here)] > 0.0f;
}

float guide_pdf_w(const Guide *g, V3 wi, float own)
{
    float share;
    int map;

    if (!guides_direction(g))
        return own;
    map = guide_map(GUIDE_DIRECTION, g->here);
    share = g->share[map];
    return share * map_pdf_w(g, map, wi) + (1.0f - share) * own;
}

/* A direction by the map, as if the vertex had made it. */
static bool scatters_by_map(Guide *g, const Vertex *v, V2 u, BsdfSample *s, float *thinned)
{
    int map = guide_map(GUIDE_DIRECTION, g->here);
    float density, own;
    V3 local;

    s->wi = direction_at(inverted_sample(&g->table[map], u, &density));
    if (!vertex_local(v, s->wi, &local))
        return false;
    own = vertex_pdf_w(v, local);
    s->pdf_w = guide_pdf_w(g, s->wi, own);
    s->weight = rgb_scale(vertex_f_cos(v, local), 1.0f / s->pdf_w);
    s->flags = BSDF_SMOOTH | (same_side(local, v->wo) ? BSDF_REFLECT : BSDF_TRANSMIT);
    s->eta = 1.0f;
    *thinned = s->pdf_w / f_max(own, 1e-6f * s->pdf_w);
    return s->pdf_w > 0.0f && !rgb_black(s->weight);
}

/* The same by the vertex, where a share goes by the map. */
static bool scatters_beside_map(Guide *g, const Vertex *v, Tracer *t, int at, BsdfSample *s,
                                float *thinned)
{
    float own;

    if (!vertex_sample(v, t, at, s))
        return false;
    own = s->pdf_w;
    if (own > 0.0f) {
        s->pdf_w = guide_pdf_w(g, s->wi, own);
        *thinned = s->pdf_w / own;
    } else
        *thinned = 1.0f - g->share[guide_map(GUIDE_DIRECTION, g->here)];
    s->weight = rgb_scale(s->weight, 1.0f / *thinned);
    return true;
}

static bool scatters_smoothly(Guide *g, const Vertex *v, Tracer *t, int at, BsdfSample *s,
                              float *thinned)
{
    int map = guide_map(GUIDE_DIRECTION, g->here);
    bool by_map = sample_1d(&t->sampler, DECISION(DECIDE_GUIDE, at)) < g->share[map];

    if (!by_map)
        return scatters_beside_map(g, v, t, at, s, thinned);
    return scatters_by_map(g, v, sample_2d(&t->sampler, DECISION(DECIDE_DIRECTION, at)), s,
                           thinned);
}

/* ---- bifurcations ---- */

static const float *fork_map(const Guide *g, int at)
{
    const GuidePlan *p = g->plan;
    if (FORK_FLOATS * at >= learned_cells(p->shape[GUIDE_BIFURCATION]))
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
        p = share * map[1] / (map[0] + map[1]) + (1.0f - share) * own;
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

/* How the direction could have come about. */
static void note_direction(Guide *g, const BsdfSample *s)
{
    int map = guide_map(GUIDE_DIRECTION, g->here);
    float share = g->share[map], by_map = map_pdf_w(g, map, s->wi);

    g->direction = map;
    g->decided[map] = (Decided){ .used = true, .place = place_of(s->wi), .map = by_map,
                                 .own = f_max((s->pdf_w - share * by_map) / (1.0f - share), 0.0f) };
}

bool guide_scatters(Guide *g, const Vertex *v, Tracer *t, Beam *b, BsdfSample *s)
{
    BsdfSample e[BSDF_DELTAS];
    float thinned = 1.0f;
    bool goes_on;

    if (forks(g, v, b->depth, e))
        goes_on = scatters_by_fork(g, v, t, b->depth, e, s, &thinned);
    else if (guides_direction(g))
        goes_on = scatters_smoothly(g, v, t, b->depth, s, &thinned);
    else
        goes_on = vertex_sample(v, t, b->depth, s);
    if (!goes_on)
        return false;
    b->eta2 *= thinned;
    if (g->here >= 0 && s->pdf_w > 0.0f && has(g, guide_map(GUIDE_DIRECTION, g->here)))
        note_direction(g, s);
    return true;
}

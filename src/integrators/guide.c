/* guide.c -- the code of `guide.h` */
#include "integrators/guideinner.h"

#include "base/mem.h"

#include <string.h>

#define EVEN_FORK 1e-6f                 /* that no way at a fork is forgotten */
#define WORTHWHILE 0.8f                 /* second moment with a map over that without */

const char *const guide_names[GUIDE_KINDS] = {
    "time", "lens", "bifurcation", "distance", "light", "point", "direction"
};

/* ---- plans ---- */

static GuideKind kind_of(int map)
{
    return (GuideKind)(map < GUIDE_DISTANCE
                           ? map : GUIDE_DISTANCE + (map - GUIDE_DISTANCE) % GUIDE_BOUNCE_MAPS);
}

/* Of those whose share of decisions goes by the map alone; others are mixed with what is even. */
static bool is_world(int map)
{
    return kind_of(map) == GUIDE_LIGHT || kind_of(map) == GUIDE_DIRECTION;
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

static LearnedShape shape_of(const GuidePlan *p, GuideKind k, int n)
{
    LearnedShape line = { n, 1, NULL, false };
    size_t most = p->scene->nlights;

    switch (k) {
    case GUIDE_BIFURCATION: return (LearnedShape){ FORK_FLOATS * n, 1, NULL, true };
    case GUIDE_LIGHT:
        return (LearnedShape){ most < (size_t)n ? (int)most : n, 1, NULL, true };
    case GUIDE_LENS:
    case GUIDE_POINT: return (LearnedShape){ n, n, NULL, false };
    case GUIDE_DIRECTION: return (LearnedShape){ n, n, p->rings, false };
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
    learned_rings(p->rings, cells[GUIDE_DIRECTION]);
    for (int k = 0; k < GUIDE_LEVELS; k++)
        p->level[k] = share * (float)k / (GUIDE_LEVELS - 1);
    for (int b = 0; b < bounces; b++)
        for (int k = b ? GUIDE_DISTANCE : 0; k < GUIDE_KINDS; k++) {
            int m = guide_map((GuideKind)k, b);
            if (!cells[k] || !is_of_use(s, (GuideKind)k))
                continue;
            p->shape[m] = shape_of(p, (GuideKind)k, cells[k]);
            p->at[m] = p->floats;
            p->floats += learned_cells(p->shape[m]) + GUIDE_LEVELS;
            p->room[m] = p->rooms;
            p->rooms += inverted_size(p->shape[m]);
            if (k == GUIDE_BIFURCATION)
                p->forks = cells[k];
            else
                p->map[p->nmaps++] = m;
        }
}

void guide_forget(const GuidePlan *p, float *maps)
{
    float *fork = maps + p->at[GUIDE_BIFURCATION];

    memset(maps, 0, (size_t)p->floats * sizeof *maps);
    for (int i = 0; i < p->forks; i++)
        fork[FORK_FLOATS * i] = fork[FORK_FLOATS * i + 1] = 0.5f;
}

Guide *guide_new(const GuidePlan *p)
{
    Guide *g = MEM_NEW(Guide);

    if (!g)
        return NULL;
    g->plan = p;
    g->worth = MEM_ARRAY(float, p->floats);
    g->room = MEM_ARRAY(float, p->rooms);
    if (!g->worth || !g->room) {
        guide_free(g);
        return NULL;
    }
    return g;
}

void guide_free(Guide *g)
{
    if (!g)
        return;
    mem_free(g->worth);
    mem_free(g->room);
    mem_free(g);
}

/* ---- the sampler around the pixel's own ---- */

static V2 warped(Guide *g, int map, V2 u, float *density)
{
    V2 place = inverted_sample(&g->table[map], u, density);

    g->decided[map] = (Decided){ .used = true, .place = place, .own = 1.0f };
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
    if (map < 0 || !guide_has(g, map))
        return u;
    u = warped(g, map, (V2){ u, 0.0f }, &density).x;
    g->pending *= density;
    return u;
}

static V2 guided_two(Sampler *s, Decision d)
{
    Guide *g = s->state;
    V2 u = sample_2d(&g->inner, d);
    int point = d == DECISION(DECIDE_LIGHT_POINT, g->depth) ? guide_map_here(g, GUIDE_POINT) : -1;
    float density;

    if (d == DECISION(DECIDE_LENS, 0) && guide_has(g, GUIDE_LENS)) {
        u = warped(g, GUIDE_LENS, u, &density);
        g->pending *= density;
    }
    if (point >= 0)
        u = warped(g, point, u, &g->point_density);
    return u;
}

static void guided_start(Sampler *s)
{
    Guide *g = s->state;

    sampler_start(&g->inner, s->index);
    for (int i = 0; i < g->plan->nmaps; i++)
        g->decided[g->plan->map[i]].used = false;
    for (int i = 0; i < g->plan->forks; i++)
        g->fork[i].used = false;
    g->pending = g->point_density = 1.0f;
    g->order = g->here = g->direction = g->forked = -1;
    g->met = NULL;
    g->depth = 0;
}

static const SamplerKind guided = {
    .info = { "guided", "Cline07 9.2", "numbers warped by learned maps", NULL },
    .start = guided_start, .one = guided_one, .two = guided_two
};

/* ---- pixel by pixel ---- */

/* The level of the least second moment, if that is well below what is without the map: a gain that
 * is small is one by chance, and what goes by the map has lost its strata. */
static int best_level(const float *moment)
{
    float least = WORTHWHILE * moment[0];
    int best = 0;

    for (int k = 1; k < GUIDE_LEVELS; k++)
        if (moment[k] < least) {
            least = moment[k];
            best = k;
        }
    return best;
}

/* The table of lights tells its map's density even where that is left alone. */
static float part_of_table(int map, float share)
{
    return kind_of(map) == GUIDE_LIGHT || (is_world(map) && share > 0.0f) ? 1.0f : share;
}

void guide_pixel(Guide *g, Tracer *t, float *maps, uint32_t x, uint32_t y)
{
    const GuidePlan *p = g->plan;

    g->maps = maps;
    g->inner = t->sampler;
    t->sampler.kind = &guided;
    t->sampler.state = g;
    t->guide = g;
    sampler_pixel(&g->inner, x, y);
    memset(g->worth, 0, (size_t)p->floats * sizeof *g->worth);
    for (int i = 0; i < p->nmaps; i++) {
        int m = p->map[i];
        const float *mass = g->maps + p->at[m];
        g->share[m] = p->level[best_level(mass + learned_cells(p->shape[m]))];
        inverted_make(&g->table[m], p->shape[m], mass, part_of_table(m, g->share[m]),
                      g->room + p->room[m]);
    }
}

/* Masses of the two ways are means of values, as [Cline07] has them, and sum to 1. */
static void merge_forks(float *map, const float *worth, int n)
{
    for (int i = 0; i < FORK_FLOATS * n; i += FORK_FLOATS) {
        float sum = worth[i] + worth[i + 1];
        if (!(sum > 0.0f) || !is_finite(sum))
            continue;
        for (int k = i; k < i + 2; k++)
            map[k] = 0.5f * (map[k] + (worth[k] / sum + 0.5f * EVEN_FORK) / (1.0f + EVEN_FORK));
        map[i + 2] = 0.5f * (map[i + 2] + 1.0f);
    }
}

void guide_learns(Guide *g, Tracer *t)
{
    const GuidePlan *p = g->plan;

    t->sampler = g->inner;
    t->guide = NULL;
    for (int i = 0; i < p->nmaps; i++) {
        int m = p->map[i], n = learned_cells(p->shape[m]);
        learned_merge(g->maps + p->at[m], g->worth + p->at[m], n, n + GUIDE_LEVELS);
    }
    merge_forks(g->maps + p->at[GUIDE_BIFURCATION], g->worth + p->at[GUIDE_BIFURCATION],
                p->forks);
}

/* ---- along a path ---- */

/* The throughput is over the densities of numbers that were warped since the last time. */
static void settle(Guide *g, Beam *b)
{
    b->throughput = rgb_scale(b->throughput, 1.0f / g->pending);        /* [Cline07 (9.3)] */
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
    return kind_of(map) == GUIDE_LIGHT || kind_of(map) == GUIDE_POINT;
}

/* What the sample was worth. */
static void learn(Guide *g, int m, Decided *d, float value)
{
    const GuidePlan *p = g->plan;
    float *worth = g->worth + p->at[m], square = value * value, now;

    if (!(value > 0.0f) || !(value < 1e15f))
        return;
    if (!is_world(m))
        d->map = inverted_alone(&g->table[m], d->place);
    else if (kind_of(m) == GUIDE_DIRECTION && g->share[m] == 0.0f)
        guide_places(g, m, d);
    now = learned_both(g->share[m], d->map, d->own);
    learned_add(worth, p->shape[m], d->place, square * now);
    learned_moments(worth + learned_cells(p->shape[m]), p->level, GUIDE_LEVELS, d->map, d->own,
                    now, square);
}

void guide_ends(Guide *g, Rgb sum)
{
    const GuidePlan *p = g->plan;
    float *fork = g->worth + p->at[GUIDE_BIFURCATION], all = rgb_lum(sum);

    for (int i = 0; i < p->nmaps; i++) {
        int m = p->map[i];
        Decided *d = &g->decided[m];
        if (d->used)
            learn(g, m, d, learns_from_connection(m) ? d->gained : all - d->before);
    }
    for (int i = 0; i < p->forks; i++)
        if (g->fork[i].used && all > g->fork[i].before && is_finite(all))
            fork[FORK_FLOATS * i + g->fork[i].refracts] += all - g->fork[i].before;
}

/* direct_triple.c -- direct light by triple product sampling: by light of the sky, the surface's
 * factor, and what is known of what lies between.
 *
 * Source      [Cline07 6] with errata 6.0 to 6.3.
 * Idea        Two stage importance sampling warps points of the unit square to directions. A map of
 *             that square (preimage), or of directions (world), says where nothing can be seen of
 *             the sky. Of the points in occluded texels few are kept, and as many more are made
 *             that the open ones get n of them after all.
 * Estimate    m points u_i are made, those of occluded texels kept with probability p:
 *                 (1/m) [ sum over open texels of c_i V_i + sum over occluded ones, kept, of
 *                         c_i V_i / p ]
 *             with c = f |cos| L / pdf (errata 6.1). In world space m = n and p = a: what culling
 *             saves there is rays, not directions.
 * Maps        Made beforehand, a map every `spacing` pixels: from the middle of its pixel one ray
 *             for each texel, through any place in it. Or lazily: all is occluded at first, and
 *             every sample that sees light says so. Either way a sample in an occluded texel that
 *             sees light corrects the four maps around [Cline07 6.3]; see visibility.h for whose
 *             samples may correct whose maps, so that all pictures are the same for any number of
 *             threads, and unbiased.
 * Where       The maps are of what the eye's rays see first. Behind mirrors, and in media, samples
 *             are those of two stage sampling.
 * Truth       Unbiased, but for two options. biased: texels that are occluded are black and those
 *             that are visible are lit, no ray is cast for them [Cline07 6.2]. dim: kept samples of
 *             occluded texels count as if all had been kept, which takes specks away, and their
 *             light [Cline07 6.4]. */
#include "integrators/direct_twostage.h"

#include "base/mem.h"
#include "integrators/event.h"
#include "lightsampling/visibility.h"
#include "sampling/pattern.h"

enum { GROUP = 32 };

typedef struct {
    SkyAndRest two;             /* owned */
    Visibility seen;            /* owned */
    bool  ready;                /* seen is there */
    bool  world, biased, lazy, dim;
    float a;
    int   size;
    uint32_t spacing;
    uint64_t seed;
} Triple;

/* ---- samples ---- */

/* Golden section of the circle, in 24 bits: any run of them is spread evenly over it. */
static float choice_of(uint32_t i, float by)
{
    return (float)(((uint32_t)(by * 0x1p24f) + 10368889u * i) & 0xffffffu) * 0x1p-24f;
}

/* Points that are looked at together. */
typedef struct {
    V2    point[GROUP];
    float choice[GROUP];        /* whether it is kept, if it is in an occluded texel */
    int   n;
} Group;

/* What stands between a kept sample and the light; what it finds is noted. */
static Rgb seen_light(const Triple *own, const Turn *u, Candidate *c, V2 at, Zone zone,
                      VisibilityMap *m, Tracer *t)
{
    Rgb L;

    c->known = own->biased && zone == ZONE_VISIBLE && !t->scene->nmedia;
    L = candidate_light(c, u, t);
    if ((own->lazy || zone == ZONE_OCCLUDED) && !rgb_black(L))
        visibility_note(m, at);
    return L;
}

static Rgb of_group(const Triple *own, const Turn *u, const Partition *p, const Thinning *thin,
                    const Group *g, VisibilityMap *m, Tracer *t)
{
    PartitionSample s[GROUP];
    Rgb sum = rgb_all(0.0f);
    Candidate c;
    float weight;

    partition_warp_many(p, g->point, s, g->n);
    for (int i = 0; i < g->n; i++) {
        V2 at = own->world ? visibility_of_direction(s[i].wi) : g->point[i];
        Zone zone = visibility_zone(m, at);
        if (!thinning_keeps(thin, zone, g->choice[i], &weight) ||
            !twostage_candidate(&own->two.two, &s[i], u, 1.0f, &c))
            continue;
        c.c = rgb_scale(c.c, own->dim ? 1.0f / (float)thin->points : weight);
        sum = rgb_add(sum, seen_light(own, u, &c, at, zone, m, t));
    }
    return sum;
}

/* The estimate. In preimage space points of occluded texels go before they are warped. */
static Rgb of_map(const Triple *own, const Turn *u, const Partition *p, const Thinning *thin,
                  VisibilityMap *m, Tracer *t)
{
    V2 by = sample_2d(&t->sampler, DECISION(DECIDE_SKY, u->at));
    float first = sample_1d(&t->sampler, DECISION(DECIDE_ROULETTE, u->at)), weight;
    Rgb sum = rgb_all(0.0f);
    Group g = { .n = 0 };

    for (uint32_t i = 0; i < (uint32_t)thin->points; i++) {
        g.point[g.n] = hammersley_moved(i, (uint32_t)thin->points, by);
        g.choice[g.n] = choice_of(i, first);
        if (!own->world && !thinning_keeps(thin, visibility_zone(m, g.point[g.n]), g.choice[g.n],
                                           &weight))
            continue;
        if (++g.n == GROUP) {
            sum = rgb_add(sum, of_group(own, u, p, thin, &g, m, t));
            g.n = 0;
        }
    }
    return rgb_add(sum, of_group(own, u, p, thin, &g, m, t));
}

static Rgb sky(Triple *own, const Turn *u, Tracer *t)
{
    float a = own->biased ? 0.0f : own->a;
    int n = own->two.samples;
    Thinning thin = { n, a };
    VisibilityMap m;
    Partition p;
    Rgb L;

    if (!own->two.two.light || !twostage_partition(&own->two.two, u, n, t, &p))
        return rgb_all(0.0f);
    if (!own->ready || u->at > 0 || !u->v) {
        visibility_unknown(&m);
        return of_map(own, u, &p, &thin, &m, t);
    }
    visibility_at(&own->seen, t->x, t->y, &m);
    if (own->world)
        thin.keep = m.open ? a : 1.0f;
    else
        thin = thinning_of(n, (float)m.open / (float)(m.size * m.size), a);
    L = of_map(own, u, &p, &thin, &m, t);
    if (t->kept && !own->biased)
        visibility_learn(&own->seen, t->x, t->y, &m);
    return L;
}

static Rgb light(const Direct *it, const Turn *u, Tracer *t)
{
    Triple *own = it->own;

    return rgb_add(sky(own, u, t), skyrest_others(&own->two, u, t));
}

/* ---- maps ---- */

/* The surface seen through the middle of a pixel, as a turn. False: there is none to light. */
static bool turn_at(const Triple *own, uint32_t k, Vertex *v, Turn *u, Tracer *t)
{
    const Camera *c = t->scene->camera;
    Rgb left = rgb_all(1.0f);
    uint32_t x, y, medium = t->scene->around;
    Ray r;
    V3 eye;

    visibility_place(&own->seen, k, &x, &y);
    r = c->kind->ray(c, (V2){ (float)x + 0.5f, (float)y + 0.5f }, (V2){ 0.5f, 0.5f },
                     scene_time(t->scene, 0.5f));
    eye = r.o;
    if (!ray_meets(t, &r, &medium, &left, &v->s))
        return false;
    v->s.width = v_len(v_sub(v->s.p, eye)) * t->spread;
    vertex_make(v, t->scene, r.d);
    if (!vertex_is_smooth(v))
        return false;
    *u = turn_on(v, r.d, medium, 0);
    return true;
}

/* Whether the sky would be seen through a place of the map, and light the surface. */
static bool sees(const Triple *own, const Turn *u, const Partition *p, V2 at, Tracer *t)
{
    Candidate c = { .c = { 1, 1, 1 } };
    PartitionSample s;

    if (own->world) {
        V3 wi = visibility_direction(at);
        c.ray = turn_ray(u, wi);
        c.medium = turn_medium(u, wi);
    } else {
        partition_warp(p, at, &s);
        if (!twostage_candidate(&own->two.two, &s, u, 1.0f, &c))
            return false;
    }
    return tracer_passes(t, &c.ray, c.medium, &c.c);
}

static void make_map(const Direct *it, uint64_t k, Tracer *t)
{
    Triple *own = it->own;
    uint64_t key = key_with(own->seed, visibility_number(&own->seen, (uint32_t)k)), n = 0;
    bool visible[VISIBILITY_MOST * VISIBILITY_MOST];
    Partition p;
    Vertex v;
    Turn u;

    if (!turn_at(own, (uint32_t)k, &v, &u, t) ||
        (!own->world && !twostage_partition(&own->two.two, &u, own->two.samples, t, &p)))
        return;
    for (int y = 0; y < own->size; y++)
        for (int x = 0; x < own->size; x++) {
            uint64_t bits = draw64(key, n++);
            V2 at = { ((float)x + unit_of((uint32_t)bits)) / (float)own->size,
                      ((float)y + unit_of((uint32_t)(bits >> 32))) / (float)own->size };
            at.x = f_min(at.x, ONE_MINUS_ULP);
            at.y = f_min(at.y, ONE_MINUS_ULP);
            visible[y * own->size + x] = sees(own, &u, &p, at, t);
        }
    visibility_make(&own->seen, (uint32_t)k, visible);
}

static bool prepare(Direct *it, const Film *f, uint64_t seed, uint64_t *units)
{
    Triple *own = it->own;

    if (!own->two.two.light)
        return true;
    own->seed = seed;
    own->ready = visibility_init(&own->seen, f, own->size, own->spacing, own->world, own->lazy);
    *units = visibility_maps(&own->seen);
    return own->ready;
}

/* ---- what lasts ---- */

static void save(const Direct *it, Saving *s)
{
    const Triple *own = it->own;

    if (own->ready)
        visibility_save(&own->seen, s);
}

static bool load(Direct *it, Loading *l)
{
    Triple *own = it->own;

    return !own->ready || visibility_load(&own->seen, l);
}

/* ---- opening ---- */

static void close_triple(Direct *it)
{
    Triple *own = it->own;

    if (!own)
        return;
    visibility_clear(&own->seen);
    skyrest_clear(&own->two);
    mem_free(own);
}

static bool say_what_is_biased(const Triple *own)
{
    if (own->biased && own->lazy)
        return err_usage("direct: biased and lazy exclude one another: lazy maps are all occluded "
                         "at first, and biased=true never looks there");
    if (own->biased)
        return warn_at((Place){ NULL, 0, 0 }, "strategy=triple is biased with biased=true: what "
                       "maps of visibility say is believed");
    return !own->dim || warn_at((Place){ NULL, 0, 0 }, "strategy=triple is biased with dim=true: "
                                "light that was not expected is dimmed");
}

static bool open_triple(Direct *it, const Opts *o)
{
    Triple *own = MEM_NEW(Triple);

    if (!own)
        return false;
    if (opt_is(o, "f", "colour")) {
        mem_free(own);
        return err_usage("direct: f=colour goes with strategy=twostage, not with triple");
    }
    own->world = opt_is(o, "space", "world");
    own->biased = opt_bool(o, "biased");
    own->lazy = opt_bool(o, "lazy");
    own->dim = opt_bool(o, "dim");
    own->a = opt_float(o, "a");
    own->size = (int)opt_int(o, "size");
    own->spacing = (uint32_t)opt_int(o, "spacing");
    if (!say_what_is_biased(own) || !skyrest_init(&own->two, it, o)) {
        mem_free(own);
        return false;
    }
    it->own = own;
    return true;
}

const DirectStrategy direct_triple = {
    .name = "triple", .finds_deltas = true, .open = open_triple, .close = close_triple,
    .prepare = prepare, .run = make_map, .light = light, .save = save, .load = load
};

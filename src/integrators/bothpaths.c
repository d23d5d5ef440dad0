/* bothpaths.c -- the code of `bothpaths.h`. */
#include "integrators/bothpaths.h"

#include "integrators/direct.h"
#include "integrators/particle.h"

/* ---- what they bring ---- */

static const double BRIGHTNESS_MOST = 1e30;     /* more is no number, or sums are none soon */

double bothpath_brightness(const BothPaths *it, const LightPath *p, double scale, Places where)
{
    double light = rgb_lum(p->colour) * scale * places_share(where);

    return (it->direct && path_is_direct(p)) || !(light <= BRIGHTNESS_MOST) ? 0.0 : light;
}

/* ---- densities ---- */

/* Of what the lamp sends. */
static double sent_density(const BothPaths *it, const PathEnd *e)
{
    const LightSampler *by = it->sending;
    float a = 0.0f, w = 0.0f;

    e->light->kind->emit_pdf(e->light, lamp_is_shape(e->light) ? &e->s : NULL, v_neg(e->to.wi),
                             &a, &w);
    return (double)by->kind->pmf(by, v_all(0.0f), v_all(0.0f), e->light) * a * w;
}

/* Of the ways in which a lamp begins; density[i] is the product of chances before vertex i-1. */
static void densities_of_lamp(const BothPaths *it, const LightPath *p, Places where,
                              double *density)
{
    double sent = sent_density(it, &p->end), change = path_ending(p);

    for (int i = p->edges - 1; i > 0; i--) {
        const PathVertex *v = &p->v[i];
        bool joins = path_vertex_is_smooth(v) && (i == 1 || path_vertex_is_smooth(v - 1));
        double to_eye;
        change *= path_turn(v);
        to_eye = i > 1 ? change / ((double)v->dist * v->dist)
                       : change * path_lens(p, it->eye.scene->camera) * where.pixels /
                             ((double)where.size.x * where.size.y);
        density[i] = joins && to_eye > 0.0 ? density[i] * sent / to_eye : 0.0;
        if (i > 1)
            sent *= chance_of(v->at, v->wi, v->wo, v->event);
    }
}

void bothpath_densities(const BothPaths *it, const LightPath *p, bool whole, Places where,
                        double *density)
{
    double before = 1.0;

    for (int j = 0; j + 1 < p->edges; j++) {
        const PathVertex *v = &p->v[j];
        density[j + 1] = before;
        if (j > 0)
            before *= chance_of(v->at, v->wo, v->wi, v->event);
    }
    density[BY_EYE] = whole ? eyepath_whole_density(&it->eye, p, before)
                            : eyepath_density(&it->eye, p, before);
    if (it->sending && p->edges > 1)
        densities_of_lamp(it, p, where, density);
}

/* ---- from the lamp ---- */

enum { BACK = LIGHTPATH_MOST };         /* decisions of the lamp's path have numbers from here on */

/* Whence light has come to its first surface: the lamp's point, where it is a shape, and the medium
 * in which it arrived. */
typedef struct { V3 from; uint32_t medium; } Whence;

/* A lamp becomes the end. False: no light this time. */
static bool leaves_lamp(const BothPaths *it, LightPath *p, Walk *w, Whence *by, Tracer *t)
{
    Particle first;
    Emission e;
    const Light *l = particle_leaves(&first, it->sending, p->time, t, &e);

    if (!l)
        return false;
    *w = (Walk){ first.ray, first.medium, { 1, 1, 1 }, -1.0f };
    by->from = e.p;
    p->end.light = l;
    p->end.d = v_neg(e.d);
    p->end.medium = first.medium;
    return true;
}

/* The lamp is what the vertex before it sees there: as a surface, where it has one. */
static bool finds_lamp(LightPath *p, const Whence *by, Tracer *t)
{
    const Vertex *at = p->v[p->edges - 1].at;
    V3 way = v_sub(by->from, at->s.p);
    Walk w;

    if (!lamp_is_shape(p->end.light))
        return true;
    w = (Walk){ vertex_ray(at, v_unit(way)), by->medium, { 1, 1, 1 }, -1.0f };
    return eyepath_meets_point(p, p->end.light, by->from, v_len(way), &w, t);
}

/* On to vertex i, with its model. */
static bool comes_back(LightPath *p, int i, Walk *w, Vertex *room, Whence *by, Tracer *t)
{
    if (!path_arrives_back(p, i, w, room, t))
        return false;
    vertex_make(room, t->scene, w->ray.d);
    if (i == p->edges - 1)
        by->medium = w->medium;
    return true;
}

/* Vertex i, which has been met, does something by chance. Gives what is left of the energy, over
 * the chance; 0: lost. */
static double turns_back(LightPath *p, int i, Walk *w, Tracer *t)
{
    PathVertex *v = &p->v[i];
    double passed = rgb_max(w->passes), left;
    BsdfSample s;
    float chance = chance_draws(v->at, v->at->wo, true, BACK + p->edges - i, t, &v->event, &s);

    if (!(chance > 0.0f) || !vertex_turns(v->at, &s))
        return 0.0;
    left = passed * rgb_max(s.weight) / chance;
    path_goes_back(p, i, s.wi, w);
    return s.pdf_w > 0.0f ? left * s.pdf_w : left;
}

/* ---- joining ---- */

/* Vertices j and j+1, which are known from their sides; light has come by *w. */
static bool joined(LightPath *p, int j, const Walk *w, Places where, const Whence *by, Tracer *t)
{
    PathVertex *v = &p->v[j + 1];
    CameraSample c;

    v->event = EVENT_SMOOTH;
    if (j == 0)
        return path_reaches_lens(p, where, w, &c, t) && (!by || finds_lamp(p, by, t)) &&
               path_turned_round(p, 1, p->edges - 1, &c) && path_colours(p);
    p->v[j].event = EVENT_SMOOTH;
    v->medium = w->medium;
    return (!by || finds_lamp(p, by, t)) && path_turned_round(p, j + 1, p->edges - 1, NULL) &&
           path_is_clear(p, j, t) && path_colours(p);
}

/* ---- a single path ---- */

bool bothpath_new(const BothPaths *it, LightPath *p, int way, Vertex *const *rooms, Places where,
                  Tracer *t)
{
    int j = way - 1;
    Whence by;
    Walk w, eye;

    if (way == BY_EYE)
        return eyepath_new(&it->eye, p, rooms, t);
    if (!leaves_lamp(it, p, &w, &by, t))
        return false;
    for (int i = p->edges - 1; i > j; i--)
        if (!comes_back(p, i, &w, rooms[i], &by, t) ||
            (i > j + 1 ? !(turns_back(p, i, &w, t) > 0.0) : !vertex_is_smooth(rooms[i])))
            return false;
    eye = path_leaves_eye(p, it->eye.scene);
    for (int i = 1; i <= j; i++)
        if (!path_arrives(p, i, &eye, rooms[i], t) ||
            (i < j ? !(eyepath_turns(p, i, &eye, t) > 0.0) : !vertex_is_smooth(rooms[i])))
            return false;
    return joined(p, j, &w, where, &by, t);
}

/* ---- all ways at once ---- */

typedef struct {
    const BothPaths *it;
    LightPath *p;               /* of the eye */
    LightPath q;                /* of the lamp: as if it were as long as can be */
    EyeTrace how;
    Vertex *spare;
    Places where;
    EyePathFound *found;
    void  *ctx;
} Both;

static double sum_of_densities(const Both *b, const LightPath *p, double *density)
{
    double sum = 0.0;

    bothpath_densities(b->it, p, true, b->where, density);
    for (int k = 0; k < bothpath_ways(b->it, p->edges); k++)
        sum += density[k];
    return sum;
}

/* What the eye found: scale is over its own density alone. */
static void weigh(void *ctx, const LightPath *p, int by, double scale, Tracer *t)
{
    const Both *b = ctx;
    double density[LIGHTPATH_MOST + 1], sum = sum_of_densities(b, p, density);

    if (sum > 0.0)
        b->found(b->ctx, p, by, scale * density[BY_EYE] / sum, t);
}

/* Vertex j of the eye's path and vertex i of the lamp's, to which roulette let light come with that
 * probability. */
static void join(const Both *b, int j, int i, const Walk *w, double let, Tracer *t)
{
    double density[LIGHTPATH_MOST + 1], sum;
    LightPath y;

    b->p->edges = j + 1;
    path_shares(&y, b->p);
    y.edges = j + 1 + b->q.edges - i;
    memcpy(&y.v[j + 1], &b->q.v[i], (size_t)(b->q.edges - i) * sizeof y.v[0]);
    y.end = b->q.end;
    if (j == 0) {
        b->spare->s = y.v[1].at->s;
        y.v[1].at = b->spare;
    }
    if (!joined(&y, j, w, b->where, NULL, t))
        return;
    sum = sum_of_densities(b, &y, density);
    if (density[j + 1] > 0.0)
        b->found(b->ctx, &y, j + 1, 1.0 / (sum * let * (j ? b->how.let[j] : 1.0)), t);
}

/* All paths that end with vertex i and what follows it. */
static void join_all(const Both *b, int i, const Walk *w, double let, Tracer *t)
{
    int after = b->q.edges - i, most = b->it->eye.maxdepth - after;
    int least = b->it->least - after - 1, last = most < b->how.met ? most : b->how.met;

    for (int j = least > 0 ? least : 0; j <= last; j++)
        if (j == 0 || vertex_is_smooth(b->p->v[j].at))
            join(b, j, i, w, let, t);
}

/* The probability of going on. 0: it ends. */
static double survives(const BothPaths *it, int events, double left, Tracer *t)
{
    if (events < it->eye.roulette || left >= 1.0)
        return 1.0;
    return sample_1d(&t->sampler, DECISION(DECIDE_ROULETTE, BACK + events)) < left ? left : 0.0;
}

static void follow_lamp(Both *b, Vertex *const *back, Tracer *t)
{
    const BothPaths *it = b->it;
    LightPath *q = &b->q;
    double let = 1.0, left = 1.0;
    Whence by;
    Walk w;

    q->edges = it->eye.maxdepth + 2;
    q->time = b->p->time;
    if (!leaves_lamp(it, q, &w, &by, t))
        return;
    for (int i = q->edges - 1; i > 1; i--) {
        double lets;
        if (!comes_back(q, i, &w, back[i], &by, t) ||
            (i == q->edges - 1 && !finds_lamp(q, &by, t)))
            return;
        if (vertex_is_smooth(back[i]))
            join_all(b, i, &w, let, t);
        left *= turns_back(q, i, &w, t);
        lets = left > 0.0 ? survives(it, q->edges - i, left, t) : 0.0;
        if (!(lets > 0.0))
            return;
        left /= lets;
        let *= lets;
    }
}

void bothpath_traced(const BothPaths *it, LightPath *p, Vertex *const *rooms, Vertex *const *back,
                     Places where, Tracer *t, EyePathFound *found, void *ctx)
{
    Both b;

    b.it = it;
    b.p = p;
    b.spare = back[0];
    b.where = where;
    b.found = found;
    b.ctx = ctx;
    if (!it->sending) {
        eyepath_traced(&it->eye, p, rooms, t, found, ctx, &b.how);
        return;
    }
    eyepath_traced(&it->eye, p, rooms, t, weigh, &b, &b.how);
    follow_lamp(&b, back, t);
}

/* ---- by chances of edges and ways ---- */

static int most_edges(const BothPaths *it) { return it->eye.maxdepth + 1; }

void byway_add(const BothPaths *it, ByWay *to, const ByWay *x)
{
    for (int n = it->least; n <= most_edges(it); n++)
        for (int w = 0; w < bothpath_ways(it, n); w++)
            to->of[n][w] += x->of[n][w];
}

enum { EVENLY = 2 };                   /* one part in so many is alike for all numbers of edges */

/* Half of that is BY_EYE's, which finds what nothing else does where glass covers everything. */
static double evenly(const BothPaths *it, int edges, int way)
{
    int ways = bothpath_ways(it, edges), lengths = most_edges(it) - it->least + 1;

    return (ways == 1 ? 1.0 : way == BY_EYE ? 0.5 : 0.5 / (ways - 1)) / lengths;
}

static void add_up(const BothPaths *it, ByWay *x)
{
    for (int n = it->least; n <= most_edges(it); n++) {
        x->all[n] = 0.0;
        for (int w = 0; w < bothpath_ways(it, n); w++)
            x->all[n] += x->of[n][w];
    }
}

void byway_becomes_chances(const BothPaths *it, ByWay *x)
{
    double sum = 0.0, even;

    for (int n = it->least; n <= most_edges(it); n++)
        for (int w = 0; w < bothpath_ways(it, n); w++)
            sum += x->of[n][w] = sqrt(x->of[n][w]);
    even = sum > 0.0 ? 1.0 / EVENLY : 1.0;
    for (int n = it->least; n <= most_edges(it); n++)
        for (int w = 0; w < bothpath_ways(it, n); w++)
            x->of[n][w] = even * evenly(it, n, w) +
                          (sum > 0.0 ? (1.0 - even) * x->of[n][w] / sum : 0.0);
    add_up(it, x);
}

void byway_save(const BothPaths *it, const ByWay *x, Saving *s)
{
    for (int n = it->least; n <= most_edges(it); n++)
        for (int w = 0; w < bothpath_ways(it, n); w++)
            save_double(s, x->of[n][w]);
}

void byway_load(const BothPaths *it, ByWay *x, Loading *l)
{
    for (int n = it->least; n <= most_edges(it); n++)
        for (int w = 0; w < bothpath_ways(it, n); w++)
            x->of[n][w] = load_double(l);
    add_up(it, x);
}

static int some_edges(const BothPaths *it, const ByWay *chance, double u, int *way)
{
    int n = most_edges(it);

    while (n > it->least && u >= chance->all[n])
        u -= chance->all[n--];
    for (*way = bothpath_ways(it, n) - 1; *way > BY_EYE && u >= chance->of[n][*way]; --*way)
        u -= chance->of[n][*way];
    return n;
}

bool bothpath_some(const BothPaths *it, const ByWay *chance, double u, LightPath *p,
                   Vertex *const *rooms, Places where, Tracer *t)
{
    int way;

    p->edges = some_edges(it, chance, u, &way);
    return bothpath_new(it, p, way, rooms, where, t);
}

double bothpath_density(const BothPaths *it, const ByWay *chance, const LightPath *p, Places where)
{
    double by[LIGHTPATH_MOST], density = 0.0;

    bothpath_densities(it, p, false, where, by);
    for (int w = 0; w < bothpath_ways(it, p->edges); w++)
        density += chance->of[p->edges][w] * by[w];
    return density;
}

/* ---- opening ---- */

bool bothpaths_open(BothPaths *it, const char *name, const Scene *s, const Opts *o,
                    bool from_lamps)
{
    bool direct = opt_bool(o, "direct");

    it->asked = lightsampler_open(opt_string(o, "lightsampler"), s);
    it->eye = (EyePaths){ s, it->asked, (int)opt_int(o, "maxdepth"),
                          (int)opt_int(o, "roulette") };
    it->least = direct ? 3 : 1;
    if (from_lamps)
        it->sending = lightsampler_open("power", s);
    if (direct)
        it->direct = integrator_open_sharing(&integrator_direct, s, o);
    return it->asked && (!from_lamps || it->sending) && (!direct || it->direct) &&
           warn_of_scattering(s, name);
}

void bothpaths_close(BothPaths *it)
{
    integrator_close(it->direct);
    lightsampler_close(it->sending);
    lightsampler_close(it->asked);
}

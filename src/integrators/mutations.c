/* mutations.c -- the code of `mutations.h`. */
#include "integrators/mutations.h"

/* ---- what a path is like ---- */

static bool is_smooth(const LightPath *p, int i)
{
    return i < p->edges && path_vertex_is_smooth(&p->v[i]);
}

/* The first smooth vertex from i on, or the number of edges: that is the light. */
static int first_smooth(const LightPath *p, int i)
{
    while (i < p->edges && !is_smooth(p, i))
        i++;
    return i;
}

/* The vertex that a mutation from the eye joins to what follows; the number of edges: it goes on to
 * the light. *chains: directions that it moves on the way. */
static int joined(const LightPath *p, int *chains)
{
    int i = first_smooth(p, 1);

    for (*chains = 0; i < p->edges; ++*chains) {
        if (i + 1 == p->edges || is_smooth(p, i + 1))
            return i;
        i = first_smooth(p, i + 1);
    }
    return i;
}

/* Light may come to vertex i by a moved way. */
static bool is_lit(const LightPath *p, int i)
{
    return is_smooth(p, i) && (i == 1 || is_smooth(p, i - 1));
}

/* How many such there are beyond the first; *at: number `which` of them. */
static int inner_ones(const LightPath *p, int which, int *at)
{
    int n = 0;

    for (int i = 2; i < p->edges; i++)
        if (is_lit(p, i) && n++ == which)
            *at = i;
    return n;
}

bool mutation_applies(Mutation m, const LightPath *p)
{
    int chains, at, last;

    if (m == MUTATE_CAUSTIC)
        return is_lit(p, 1);
    if (m == MUTATE_INNER)
        return inner_ones(p, 0, &at) > 0;
    last = joined(p, &chains);
    return (last < p->edges || !p->end.light->kind->delta) &&
           (chains > 0) == (m == MUTATE_MULTICHAIN);
}

Move mutation_move(Mutation m, const LightPath *p, float u)
{
    Move move = { m, m == MUTATE_CAUSTIC };

    if (m == MUTATE_INNER) {
        int n = inner_ones(p, 0, &move.at);
        inner_ones(p, (int)(u * (float)n), &move.at);
    }
    return move;
}

/* L ... S D E: the eye sees light that has come by delta events. */
static bool is_caustic(const LightPath *p)
{
    return is_smooth(p, 1) && 2 < p->edges && !is_smooth(p, 2);
}

Mutation mutation_chosen(const Mutator *it, const LightPath *p, float u)
{
    float share[MUTATIONS], sum = 0.0f;

    if (it->always_caustic && is_caustic(p) && mutation_applies(MUTATE_CAUSTIC, p))
        return MUTATE_CAUSTIC;
    for (int m = 0; m < MUTATIONS; m++) {
        share[m] = (m != MUTATE_CAUSTIC || !it->always_caustic) &&
                           mutation_applies((Mutation)m, p) ? it->share[m] : 0.0f;
        sum += share[m];
    }
    for (int m = 0; m < MUTATIONS; m++) {
        if (u * sum < share[m])
            return (Mutation)m;
        u -= share[m] / sum;
    }
    return MUTATIONS;
}

/* ---- small moves ---- */

/* Between least and most, uniform by its logarithm [Cline07 figs 7.25, 7.26]. */
static float by_logarithm(float least, float most, Rng *r)
{
    return most * m_exp(-m_log(most / least) * rng_unit(r));
}

static V2 place_near(const Mutator *it, V2 p, Rng *r)
{
    float s, c, far;

    if (it->square > 0.0f) {
        float x = rng_unit(r) - 0.5f, y = rng_unit(r) - 0.5f;
        return (V2){ p.x + x * it->square, p.y + y * it->square };
    }
    m_sincos_turn(rng_unit(r), &s, &c);
    far = by_logarithm(it->nearest, it->farthest, r);
    return (V2){ p.x + far * c, p.y + far * s };
}

static V3 direction_near(const Mutator *it, V3 d, Rng *r)
{
    Frame f = frame_about(d);
    float s, c, far;

    m_sincos_turn(rng_unit(r), &s, &c);
    far = by_logarithm(it->least, it->most, r);
    return v_unit(frame_out(&f, v3(far * c, far * s, 1.0f)));
}

/* ---- from the eye ---- */

/* The walk meets a light like that of x: on a surface, or the same one beyond the scene. */
static bool meets_like(const LightPath *x, LightPath *y, Walk *w, Tracer *t)
{
    bool beyond = x->end.light->kind->infinite;
    Surface s;

    if (ray_meets(t, &w->ray, &w->medium, &w->passes, &s))
        return !beyond && s.shape->light != NO_LIGHT &&
               path_ends(y, scene_light_of(t->scene, &s), &s, w);
    return beyond && path_ends(y, x->end.light, NULL, w);
}

static bool moved_from_eye(const Mutator *it, const LightPath *x, LightPath *y,
                           Vertex *const *rooms, Rng *r, Tracer *t)
{
    int chains, last = joined(x, &chains);
    Walk w;

    y->pixel = place_near(it, x->pixel, r);
    if (!places_hold(canvas_places(t->canvas), y->pixel))
        return false;
    w = path_leaves_eye(y, it->scene);
    for (int i = 1; i <= last && i < x->edges; i++) {
        const PathVertex *v = &x->v[i];
        if (!path_arrives(y, i, &w, rooms[i], t))
            return false;
        if (i == last)
            return path_joins(y, i) && path_is_clear(y, i, t);
        if (!(path_vertex_is_smooth(v)
                  ? path_turns_to(y, i, direction_near(it, v->way, r), &w)
                  : path_turns_by(y, i, v->event, &w)))
            return false;
    }
    return meets_like(x, y, &w, t);
}

/* ---- from the light ---- */

/* The same light from beyond the scene, along a line beside the old one. */
static Ray ray_beside(const Mutator *it, const LightPath *x, Rng *r)
{
    V3 d = v_neg(path_way(x, x->edges - 1)), from = x->v[x->edges - 1].at->s.p;
    float s, c, far, radius = it->scene->radius;
    Frame f = frame_about(d);

    m_sincos_turn(rng_unit(r), &s, &c);
    far = radius * by_logarithm(it->least, it->most, r);
    from = v_add(from, frame_out(&f, v3(far * c, far * s, 0.0f)));
    from = v_sub(from, v_scale(d, v_dot(v_sub(from, it->scene->centre), d) + 2.0f * radius));
    return (Ray){ .o = from, .d = d, .tmax = INFINITY, .time = x->time };
}

/* Leaves vertex `start`, or the end if that is the number of edges, in a moved direction. */
static Walk leaves_light(const Mutator *it, const LightPath *x, int start, Rng *r)
{
    const PathVertex *v = &x->v[start];
    const LightSample *to = &x->end.to;
    V3 d;

    if (start == x->edges && !is_finite(to->dist))
        return (Walk){ ray_beside(it, x, r), x->end.medium, { 1, 1, 1 }, -1.0f };
    d = direction_near(it, v_neg(path_way(x, start - 1)), r);
    if (start < x->edges)
        return (Walk){ vertex_ray(v->at, d), medium_beyond(&v->at->s, d, v->medium), { 1, 1, 1 },
                       -1.0f };
    return (Walk){ { .o = ray_origin(to->p, to->err, to->n, d), .d = d, .tmax = INFINITY,
                     .time = x->time }, x->end.medium, { 1, 1, 1 }, -1.0f };
}

/* On by the delta event of that name, towards the eye. */
static bool goes_back(LightPath *y, int i, Walk *w)
{
    BsdfSample s[BSDF_DELTAS];
    uint32_t name[BSDF_DELTAS];
    PathVertex *v = &y->v[i];
    int k = path_deltas(v->at, v->at->wo, s, name);

    while (k-- > 0 && name[k] != v->event)
        ;
    if (k < 0 || !vertex_turns(v->at, &s[k]))
        return false;
    path_goes_back(y, i, s[k].wi, w);
    return true;
}

static bool moved_from_light(const Mutator *it, int at, const LightPath *x, LightPath *y,
                             Vertex *const *rooms, Rng *r, Tracer *t)
{
    int start = first_smooth(x, at + 1);
    Walk w = leaves_light(it, x, start, r);
    CameraSample c;

    for (int i = start - 1; i > at; i--) {
        if (!path_arrives_back(y, i, &w, rooms[i], t))
            return false;
        vertex_make(rooms[i], it->scene, w.ray.d);
        if (!goes_back(y, i, &w))
            return false;
    }
    if (!path_arrives_back(y, at, &w, rooms[at], t))
        return false;
    if (at == 1)
        return path_reaches_lens(y, canvas_places(t->canvas), &w, &c, t) &&
               path_turned_round(y, 1, start - 1, &c);
    vertex_make(rooms[at], it->scene, w.ray.d);
    y->v[at].medium = w.medium;
    return path_turned_round(y, at, start - 1, NULL) && path_is_clear(y, at - 1, t);
}

/* ---- acceptance ---- */

/* From directions at that vertex, and places on the picture or directions at the one before, to
 * directions at the start. */
static double change_to_light(const LightPath *p, int at, const Camera *camera)
{
    int start = first_smooth(p, at + 1);
    double change = start < p->edges ? (double)p->v[start].cos_o : path_ending(p);

    for (int i = at; i < start; i++)
        change *= path_turn(&p->v[i]);
    return at > 1 ? change / f_sqr(p->v[at].dist) : change * path_lens(p, camera);
}

/* F over T, up to a factor that is the same for all paths that the move joins: see mutations.h. */
static double worth(Move m, const LightPath *p, const Camera *c)
{
    double light = rgb_lum(p->colour);
    int chains, last;

    if (m.at)
        return light * change_to_light(p, m.at, c);
    last = joined(p, &chains);
    return last < p->edges ? light * path_area(p, last) : light;
}

double mutated(const Mutator *it, Move m, const LightPath *x, LightPath *y,
               Vertex *const *rooms, Rng *r, Tracer *t)
{
    const Camera *c = it->scene->camera;
    double from;

    path_shares(y, x);
    if (!(m.at ? moved_from_light(it, m.at, x, y, rooms, r, t)
               : moved_from_eye(it, x, y, rooms, r, t)) ||
        !path_colours(y))
        return 0.0;
    from = worth(m, x, c);
    return from > 0.0 ? worth(m, y, c) / from : 0.0;            /* [Cline07 (7.14), (8.6)] */
}

double mutation_tried(const Mutator *it, const LightPath *x, LightPath *y, Vertex *const *rooms,
                      Rng *r, Tracer *t)
{
    Mutation m = mutation_chosen(it, x, rng_unit(r));

    if (m == MUTATIONS)
        return 0.0;
    return d_min(mutated(it, mutation_move(m, x, rng_unit(r)), x, y, rooms, r, t), 1.0);
}

/* ---- options ---- */

void mutator_init(Mutator *it, const Scene *s, const Opts *o)
{
    static const char *const name[MUTATIONS] = { "lens", "multichain", "caustic", "inner" };

    it->scene = s;
    for (int m = 0; m < MUTATIONS; m++)
        it->share[m] = opt_float(o, name[m]);
    it->nearest = opt_float(o, "nearest");
    it->farthest = opt_float(o, "farthest");
    it->square = opt_float(o, "square");
    it->least = opt_float(o, "least");
    it->most = f_max(opt_float(o, "most"), it->least);
}

void mutator_prepare(Mutator *it, const Film *f)
{
    if (!(it->farthest > 0.0f))
        it->farthest = 0.1f * (float)f->full_w;
    it->farthest = f_max(it->farthest, it->nearest);
}

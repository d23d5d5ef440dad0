/* test_bidirectional.c -- paths from both ends: weights against densities worked out one by one,
 * and pictures against path tracing.
 *
 * Weights     The recursion of odds.h tells of each way of making a path from the two ends alone.
 *             Here the same paths are traced again and written down whole, every technique's
 *             density is multiplied up vertex by vertex, in double, and the weight is what its own
 *             share of them is: so all weights of a path add up to 1 by construction.
 * Pictures    Means of tiles over 16 runs, see pictures.h. */
#include "geometry/generate.h"
#include "integrators/lightstore.h"
#include "test/lamp_help.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- a path, whole ---- */

enum { MOST = 8 };                              /* vertices of one side */

typedef struct {
    V3   p, ng;
    const Vertex *v;                            /* borrowed; NULL: the lamp or the lens */
    bool delta;
} Node;

/* x[0] on the lamp, x[edges] at the lens. */
typedef struct {
    const Bidirectional *b;
    const Light *lamp;
    Surface there;                              /* of the lamp; p if it has a place */
    V3   d;                                     /* the way it shines */
    double camera;                              /* density of the eye's first direction */
    Node x[2 * MOST];
    int  edges;
} Whole;

static bool beyond(const Light *l)
{
    return l->kind->infinite || l->kind->delta == DELTA_DIRECTION;
}

static V3 way(const Whole *w, int from, int to)
{
    V3 d = v_sub(w->x[to].p, w->x[from].p);
    if ((from == 0 || to == 0) && beyond(w->lamp))
        return from == 0 ? w->d : v_neg(w->d);
    return v_unit(d);
}

/* What makes a density per solid angle one per area of x[to]. */
static double to_area(const Whole *w, int from, int to)
{
    V3 d = v_sub(w->x[to].p, w->x[from].p);
    double cosine = to == 0 && (w->lamp->kind->delta || beyond(w->lamp)) ? 1
                    : v_absdot(w->x[to].ng, way(w, from, to));

    if ((from == 0 || to == 0) && beyond(w->lamp))
        return cosine;
    return cosine / (double)v_dot(d, d);
}

/* Density per solid angle of going on to x[to] from x[at], for what came from x[from]. */
static double scattered(const Whole *w, int from, int at, int to)
{
    const Vertex *v = w->x[at].v;

    if (w->x[at].delta)
        return 1;
    return (double)v->b->kind->pdf_w(v->b, frame_in(&v->frame, way(w, at, from)),
                                     frame_in(&v->frame, way(w, at, to)));
}

/* Density of the first n vertices, as the lamp's path. */
static double from_lamp(const Whole *w, int n)
{
    const Bidirectional *b = w->b;
    double p;
    float a, s;

    if (n == 0)
        return 1;
    if (n == 1) {
        const Vertex *v = w->x[1].v;
        if (w->x[1].delta)
            return 0;
        p = b->asked->kind->pmf(b->asked, v->s.p, vertex_up(v), w->lamp);
        if (!w->lamp->kind->delta)
            p *= light_pdf_w(w->lamp, b->beside, v->s.p, way(w, 1, 0), &w->there) *
                 to_area(w, 1, 0);
        return p;
    }
    w->lamp->kind->emit_pdf(w->lamp, &w->there, w->d, &a, &s);
    p = (double)b->sending->kind->pmf(b->sending, v_all(0), v_all(0), w->lamp) * a * s *
        to_area(w, 0, 1);
    for (int i = 2; i < n; i++)
        p *= scattered(w, i - 2, i - 1, i) * to_area(w, i - 1, i);
    return p;
}

/* Density of x[first] .. x[edges], as the eye's path, but for the place on the lens. */
static double from_eye(const Whole *w, int first)
{
    int k = w->edges;
    double p = 1;

    if (first < k)
        p = w->camera * to_area(w, k, k - 1);
    for (int i = k - 2; i >= first; i--)
        p *= scattered(w, i + 2, i + 1, i) * to_area(w, i + 1, i);
    return p;
}

/* Of technique s: so many vertices from the lamp. */
static double connected(const Whole *w, int s)
{
    int k = w->edges;

    if (s == k && k == 1)
        return 0;                               /* lamps in plain view are met */
    if (s == 0)
        return w->lamp->kind->delta ? 0 : from_eye(w, 0);
    if ((s > 1 && w->x[s - 1].delta) || (s < k && w->x[s].delta))
        return 0;
    return from_lamp(w, s) * from_eye(w, s) * (s == k ? (double)w->b->shown : 1);
}

static double merged(const Whole *w, int i)
{
    const Techniques *q = &w->b->techniques;

    if (w->x[i].delta || (i == w->edges - 1 && !q->first) || (i == 1 && !q->straight))
        return 0;
    return q->eta * from_lamp(w, i + 1) * from_eye(w, i);
}

static double power_of(const Techniques *q, double p)
{
    return q->heuristic == HEURISTIC_BALANCE ? p : q->heuristic == HEURISTIC_POWER ? p * p : p > 0;
}

static double weight_of(const Whole *w, int s)
{
    const Techniques *q = &w->b->techniques;
    double sum = 0;

    for (int i = 0; i <= w->edges; i++)
        sum += power_of(q, connected(w, i));
    for (int i = 1; i < w->edges; i++)
        sum += power_of(q, merged(w, i));
    return power_of(q, connected(w, s)) / sum;
}

/* ---- both paths again, by the same numbers ---- */

typedef struct {
    const Light *lamp;
    Emission e;
    int  n;
    Vertex v[MOST];
    bool delta[MOST];
} LampPath;

static void trace_lamp(const Bidirectional *b, LampPath *l, float time, Tracer *t)
{
    Particle p;

    l->n = 0;
    l->lamp = particle_leaves(&p, b->sending, time, t, &l->e);
    if (!l->lamp)
        return;
    while (p.depth < b->maxdepth && vertex_meet(&l->v[l->n], &p.ray, t)) {
        BsdfSample s;
        Vertex *v = &l->v[l->n];
        V3 local;
        l->n++;
        if (!particle_samples(&p, v, t, &s, &local))
            return;
        l->delta[l->n - 1] = s.pdf_w == 0.0f;
        if (!particle_turns(&p, v, &s, local))
            return;
    }
}

typedef struct {
    int  n;
    bool escapes;
    V3   d[MOST + 1];                           /* of the ray to each vertex, and of the last one */
    Vertex v[MOST];
    bool delta[MOST];
} EyePath;

static void trace_eye(const Bidirectional *b, EyePath *e, const Ray *r, Tracer *t)
{
    Beam beam = beam_from_eye(r, b->scene);

    e->n = 0;
    for (;;) {
        BsdfSample s;
        e->d[e->n] = beam.ray.d;
        e->escapes = !vertex_meet(&e->v[e->n], &beam.ray, t);
        if (e->escapes)
            return;
        e->n++;
        if (e->n > b->maxdepth || !vertex_sample(&e->v[e->n - 1], t, beam.depth, &s))
            return;
        e->delta[e->n - 1] = s.pdf_w == 0.0f;
        beam_turn(&beam, &e->v[e->n - 1], &s);
    }
}

/* ---- one sample's paths ---- */

typedef struct {
    Lab *l;
    Bidirectional b;
    LampPath lamp;
    EyePath eye;
    Ray  ray;
    Tally tally;
    Tracer t;
    long seen[MOST + 2][MOST + 3];              /* weights compared, by technique */
    long off, wrong;                            /* of those, by more than 0.1 %; 2 % */
    char worst[160];
} Pair;

static void node(Whole *w, int i, const Vertex *v, bool delta)
{
    w->x[i] = (Node){ v->s.p, v->s.ng, v, delta };
}

/* The eye's vertices behind the first s, of which the last is joined. */
static void add_eye(Whole *w, const Pair *q, int s, int t)
{
    const Camera *c = q->b.scene->camera;
    Ray r = q->ray;
    CameraView view;

    w->b = &q->b;
    w->edges = s + t - 1;
    for (int j = 0; j < t - 1; j++)             /* eye.v[j] is x[edges - 1 - j] */
        if (w->edges - 1 - j > 0 || s > 0)
            node(w, w->edges - 1 - j, &q->eye.v[j], j < t - 2 && q->eye.delta[j]);
    w->x[w->edges] = (Node){ q->ray.o, v_all(0), NULL, false };
    if (t == 1)
        r.d = v_unit(v_sub(w->x[w->edges - 1].p, r.o));
    w->camera = c->kind->view(c, &r, &view) ? view.pdf_w : 0;
}

/* The lamp's first, with what x[0] is. */
static void add_lamp(Whole *w, const Pair *q, int s)
{
    const Emission *e = &q->lamp.e;

    w->lamp = q->lamp.lamp;
    w->there = surface_at(e->p, e->err, e->n, e->uv);
    w->d = e->d;
    w->x[0] = (Node){ e->p, e->n, NULL, false };
    for (int i = 1; i < s; i++)
        node(w, i, &q->lamp.v[i - 1], i < s - 1 && q->lamp.delta[i - 1]);
}

/* The lamp that the eye's path meets in the end. False: none, or more than one could be meant. */
static bool add_met(Whole *w, const Pair *q, int t)
{
    const Scene *s = q->b.scene;
    int i = t - 2;

    if (i < q->eye.n) {
        w->lamp = scene_light_of(s, &q->eye.v[i].s);
        w->there = q->eye.v[i].s;
    } else {
        w->lamp = s->ninfinite == 1 ? s->infinite[0] : NULL;
        w->there = surface_at(v_all(0), v_all(0), v_all(0), (V2){ 0, 0 });
    }
    w->d = v_neg(q->eye.d[i]);
    w->x[0] = (Node){ w->there.p, w->there.ng, NULL, false };
    return w->lamp != NULL;
}

/* The lamp that the eye's vertex asks. */
static bool add_asked(Whole *w, Pair *q, int t)
{
    const Vertex *z = &q->eye.v[t - 2];
    const LightSampler *by = q->b.asked;
    LightSample ls;
    float pmf, left, u;

    u = q->b.scene->nlights > 1 ? sample_1d(&q->t.sampler, DECISION(DECIDE_LIGHT, t - 2)) : 0.0f;
    w->lamp = by->kind->pick(by, z->s.p, vertex_up(z), u, &pmf, &left);
    if (!w->lamp || !light_sample(w->lamp, q->b.beside, z->s.p,
                                  sample_2d(&q->t.sampler, DECISION(DECIDE_LIGHT_POINT, t - 2)),
                                  &ls))
        return false;
    w->there = surface_at(ls.p, ls.err, ls.n, (V2){ 0, 0 });
    w->d = v_neg(ls.wi);
    w->x[0] = (Node){ ls.p, ls.n, NULL, false };
    return true;
}

static void compare(Pair *q, int s, int t)
{
    double bare = (double)q->tally.technique[s][t].bare.g, got, want;
    Whole w;

    if (!(bare > 0) || s + t < 3)
        return;
    memset(&w, 0, sizeof w);
    if (s == 0 ? !add_met(&w, q, t) : s == 1 && !add_asked(&w, q, t))
        return;
    if (s > 1)
        add_lamp(&w, q, s);
    add_eye(&w, q, s, t);
    got = (double)q->tally.technique[s][t].weighed.g / bare;
    want = weight_of(&w, s);
    q->seen[s][t]++;
    q->off += fabs(got - want) > 1e-3 * want + 1e-7;
    if (fabs(got - want) > 0.02 * want + 1e-6 && !q->wrong++)
        snprintf(q->worst, sizeof q->worst, "%d vertices from the %s, %d from the eye: weight "
                 "%.9g, it is %.9g", s, w.lamp->kind->info.name, t, got, want);
}

static void one_pair(Pair *q, uint32_t index)
{
    const Camera *c = q->b.scene->camera;
    LightVertex path[DEPTH_MOST];
    int n;

    tally_clear(&q->tally);
    sampler_pixel(&q->t.sampler, index, 7);
    sampler_start(&q->t.sampler, 0);
    q->ray = c->kind->ray(c, (V2){ 32 * sample_1d(&q->t.sampler, DECISION(DECIDE_TIME, 0)),
                                   32 * sample_1d(&q->t.sampler, DECISION(DECIDE_TIME, 1)) },
                          sample_2d(&q->t.sampler, DECISION(DECIDE_LENS, 0)), 0.0f);
    sampler_other(&q->t.sampler, PATH_FROM_LAMP);
    n = bidirectional_light(&q->b, 0.0f, path, &q->t);
    trace_lamp(&q->b, &q->lamp, 0.0f, &q->t);
    sampler_pixel(&q->t.sampler, index, 7);
    sampler_start(&q->t.sampler, 0);
    bidirectional_look(&q->b, &q->ray, path, n, &q->t);
    trace_eye(&q->b, &q->eye, &q->ray, &q->t);
    for (int s = 0; s <= q->lamp.n + 1; s++)
        for (int t = 1; t <= q->eye.n + 2 && t + s < TALLY_LENGTHS; t++)
            compare(q, s, t);
}

static void add_surfaces(Lab *l)
{
    lamp_things(l);
    lab_sphere(l, v3(0, -1.6f, 0.5f), 0.5f, lab_material(l, "dielectric", ""), false);
    lab_sphere(l, v3(-2, 1.5f, 0.6f), 0.6f, lab_material(l, "mirror", "reflectance=0.9"), false);
    lab_quad(l, v3(3, -3, 0), v3(0, 6, 0), v3(0, 0, 3), lab_material(l, "coateddiffuse",
                                                                    "roughness=0.2"));
    lab_sphere(l, v3(2, -2, 0.5f), 0.5f, lab_material(l, "dielectric", "roughness=0.3"), false);
}

/* eta: the method is as if there were mergers, though none are done. */
static void weights_of(const char *lamp, const char *options, float eta, bool first, long pairs,
                       long seen[MOST][MOST])
{
    const SamplerKind *independent = kind_find(samplers, "random");
    uint32_t spp = 1;
    Sampler sampler;
    long all = 0;
    Pair q;
    Opts o, none;
    Lab l;

    memset(&q, 0, sizeof q);
    lab_init(&l);
    lamp_add(&l, lamp);
    lamp_add(&l, "quad");
    add_surfaces(&l);
    lab_camera(&l, v3(0.5f, -7, 3), v3(0, 0, 1), 45, "");
    lab_build(&l);
    l.scene->camera->kind->film(l.scene->camera, 32, 32);
    lab_method(&l, options, &o);
    opts_default(&none, independent->info.options);
    REQUIRE(bidirectional_open(&q.b, "test", l.scene, &o), "%s", options);
    q.b.techniques.eta = eta;
    q.b.techniques.first = first;
    q.b.techniques.straight = eta > 1.0f;
    q.l = &l;
    q.t.scene = l.scene;
    q.t.tally = &q.tally;
    q.tally.by_technique = true;
    REQUIRE(sampler_init(&sampler, independent, &none, 3, &spp), "sampler");
    q.t.sampler = sampler;
    for (long i = 0; i < pairs; i++)
        one_pair(&q, (uint32_t)i);
    for (int s = 0; s < MOST; s++)
        for (int t = 0; t < MOST; t++)
            all += q.seen[s][t], seen[s][t] += q.seen[s][t];
    /* directions are told from places here: where these are near, and lobes narrow, digits go */
    EXPECT(q.off * 1000 < all, "%ld of %ld weights differ by more than 0.1 %%", q.off, all);
    EXPECT(q.wrong * 50000 <= all, "%ld of %ld weights are wrong, as %s", q.wrong, all, q.worst);
    bidirectional_clear(&q.b);
    sampler_clear(&sampler);
    lab_clear(&l);
}

static void weights_many(long pairs)
{
    static const char *const lamps[] = { "ball", "point", "spot", "distant", "infinite",
                                         "picture" };
    static const char *const how[] = { "balance", "power", "uniform" };
    long seen[MOST][MOST];

    memset(seen, 0, sizeof seen);
    for (size_t i = 0; i < sizeof lamps / sizeof *lamps; i++)
        for (size_t k = 0; k < 3; k++) {
            char text[100];
            snprintf(text, sizeof text, "bdpt:maxdepth=6,roulette=100,split=1,weights=%s%s", how[k],
                     i % 2 ? ",lightsampler=power" : "");
            weights_of(lamps[i], text, i % 3 == 1 ? 0.05f : i % 3 == 2 ? 30.0f : 0.0f, k % 2, pairs,
                       seen);
        }
    for (int s = 0; s <= 4; s++)
        for (int t = s > 1 ? 1 : 3 - s; t <= 4; t++)
            EXPECT(seen[s][t] > 0, "no path of %d vertices from the lamp, %d from the eye", s, t);
}

static void weights(void) { weights_many(5000); }
static void weights_long(void) { weights_many(100000); }

/* ---- pictures ---- */

static void expect_path(Lab *l, const char *method, int depth, uint32_t spp, double delta,
                        const char *what)
{
    char text[2][120];
    Series path, both;

    snprintf(text[0], sizeof *text, "path:maxdepth=%d,roulette=2", depth);
    snprintf(text[1], sizeof *text, "%s,maxdepth=%d,roulette=2", method, depth);
    series_render(l, &path, text[0], 32, 2 * spp, 1);
    series_render(l, &both, text[1], 32, spp, 2);
    series_expect_same(&both, &path, delta, what);
    series_clear(&path);
    series_clear(&both);
}

static void lamps_by(const char *method, uint32_t spp, double delta)
{
    for (size_t i = 0; i < LAMPS; i++) {
        Lab l;
        lamp_scene(&l, lamp_names[i], "");
        expect_path(&l, method, 4, spp, delta, lamp_names[i]);
        lab_clear(&l);
    }
}

static void lamps_balance(void) { lamps_by("bdpt:weights=balance", 8, 0.06); }
static void lamps_power(void) { lamps_by("bdpt:weights=power", 8, 0.06); }
static void lamps_uniform(void) { lamps_by("bdpt:weights=uniform", 32, 0.1); }
static void lamps_vcm(void) { lamps_by("vcm:share=0.0003", 8, 0.06); }

static void lenses(void)
{
    static const char *const names[][2] = {
        { "perspective", "lensradius=0.3,focaldistance=6" }, { "orthographic", "" },
        { "spherical", "" }, { "environment", "" },
    };

    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        Lab l;
        lab_init(&l);
        lamp_add(&l, "quad");
        lamp_add(&l, "point");
        lamp_things(&l);
        lab_camera_of(&l, names[i][0], v3(0.2f, -2.5f, 1.5f), v3(0, 0, 1), 60, names[i][1]);
        lab_build(&l);
        expect_path(&l, "bdpt:weights=balance", 4, 6, 0.08, names[i][0]);
        lab_clear(&l);
    }
}

/* Radiance is larger within water by the square of the index, flux is not. */
static void tank_by(const char *method, uint32_t spp)
{
    for (int inside = 0; inside < 2; inside++) {
        Mesh water;
        Lab l;
        lab_init(&l);
        lab_quad(&l, v3(-3, -3, 0.05f), v3(6, 0, 0), v3(0, 6, 0), lab_material(&l, "diffuse", ""));
        REQUIRE(mesh_box(&water, v3(-4, -4, -1), v3(4, 4, 1)), "memory");
        lab_mesh(&l, &water, lab_material(&l, "dielectric", "eta=1.33,roughness=0.4"), false);
        lamp_add(&l, "infinite");
        lab_camera(&l, inside ? v3(0, -2, 0.6f) : v3(0, -3, 3.5f), v3(0, 0, 0), 50, "");
        lab_build(&l);
        expect_path(&l, method, 4, spp, 0.15, inside ? "within a tank" : "into a tank");
        lab_clear(&l);
    }
}

static void tank(void) { tank_by("bdpt:weights=balance", 16); }
static void tank_vcm(void) { tank_by("vcm:share=0.001", 16); }

/* A closed one, where most of the light has been scattered more than once. */
static void room(void)
{
    static const char *const methods[] = { "bdpt:weights=power", "vcm:share=0.002",
                                           "bpm:share=0.01" };

    for (size_t i = 0; i < 3; i++) {
        Mesh walls;
        Lab l;
        lab_init(&l);
        lamp_add(&l, "ball");
        lamp_add(&l, "point");
        lamp_things(&l);
        REQUIRE(mesh_box(&walls, v3(-4, -8, -0.1f), v3(4, 4, 5)), "memory");
        lab_mesh(&l, &walls, lab_material(&l, "diffuse", "reflectance=0.8"), false);
        lab_camera(&l, v3(0.5f, -7, 3), v3(0, 0, 1), 45, "");
        lab_build(&l);
        expect_path(&l, methods[i], 4, 8, i == 2 ? 0.08 : 0.05, methods[i]);
        lab_clear(&l);
    }
}

/* A floor seen in a mirror. folded: its lamp shines up, at a mirror above; else it hangs where that
 * would show it, as bright, and light has one edge less. Something black is where it was. */
static void add_periscope(Lab *l, bool folded)
{
    uint32_t mirror = lab_material(l, "mirror", "reflectance=1");
    uint32_t black = lab_material(l, "diffuse", "reflectance=0");
    uint32_t low = lab_quad(l, v3(-2.9f, -2, 2), v3(2.5f, 0, 0), v3(0, 4, 0), black);

    lab_quad(l, v3(-2, -2, 0), v3(4, 0, 0), v3(0, 4, 0), lab_material(l, "diffuse", ""));
    lab_quad(l, v3(3, -3, 0.1f), v3(0, 6, 0), v3(0, 0, 3), mirror);
    if (folded)
        lab_quad(l, v3(-5, -5, 4), v3(10, 0, 0), v3(0, 10, 0), mirror);
    lab_shine(l, folded ? low : lab_quad(l, v3(-2.9f, -2, 6), v3(0, 4, 0), v3(2.5f, 0, 0), black),
              "L=4/5/6");
    lab_camera(l, v3(1, 0, 3), v3(3, 0, 1.2f), 25, "");
    lab_build(l);
}

/* Light between mirrors on both sides is found by splitting, as bright as without mirrors; and no
 * part of a split path shows more than its part. */
static void split(void)
{
    static const char *const methods[] = { "bdpt:maxdepth=3", "vcm:mode=bdpt,maxdepth=3,split=3" };
    Series plain, found;
    Lab l;

    lab_init(&l);
    add_periscope(&l, false);
    series_render(&l, &plain, "path:maxdepth=2", 32, 32, 1);
    lab_clear(&l);
    lab_init(&l);
    add_periscope(&l, true);
    for (size_t i = 0; i < 2; i++) {
        series_render(&l, &found, methods[i], 32, i ? 48 : 12, 2);
        series_expect_same(&found, &plain, 0.04, methods[i]);
        series_clear(&found);
    }
    series_clear(&plain);
    lab_clear(&l);
    lab_init(&l);
    lamp_add(&l, "infinite");
    add_periscope(&l, true);
    expect_path(&l, "bdpt:little=0", 1, 8, 0.04, "the sky in a mirror");
    lab_clear(&l);
}

/* What lamps beyond glass do, and mirrors: all techniques have a part in it. */
static void add_glass_room(Lab *l)
{
    lamp_add(l, "ball");
    add_surfaces(l);
    lab_camera(l, v3(0.5f, -7, 3), v3(0, 0, 1), 45, "");
    lab_build(l);
}

static void glass(void)
{
    static const char *const methods[] = { "bdpt:weights=balance", "vcm:share=0.0005",
                                           "vcm:share=0.0005,first=false,paths=2",
                                           "vcm:mode=bdpt", "bpm:share=0.002" };

    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) {
        Lab l;
        lab_init(&l);
        add_glass_room(&l);
        expect_path(&l, methods[i], 6, i == 4 ? 128 : 32, 0.15, methods[i]);
        lab_clear(&l);
    }
}

/* What is kept of a light path is the path, whether or not its first vertex stands apart. */
static void expect_kept(const Bidirectional *b, LightStore *store, Tracer *t)
{
    LightVertex path[DEPTH_MOST], again[DEPTH_MOST];
    long seen = 0;

    for (uint64_t unit = 0; unit < lightstore_units(store, 0, true); unit++)
        lightstore_run(store, b, 5, 0, unit, t);
    for (uint32_t i = 0; i < 1500; i++) {
        int n, m;
        sampler_pixel(&t->sampler, i, 0);
        sampler_start(&t->sampler, 5);
        sampler_other(&t->sampler, PATH_FROM_LAMP);
        n = bidirectional_light(b, 0.0f, path, t);
        m = lightstore_path(store, i, again, t);
        EXPECT(n == m, "path %lu: %d vertices, %d were kept", (unsigned long)i, n, m);
        for (int k = 0; k < n && k < m; k++, seen++) {
            const LightVertex *x = &path[k], *y = &again[k];
            EXPECT(v_len(v_sub(x->v.s.p, y->v.s.p)) <= 1e-5f && v_len(v_sub(x->d, y->d)) <= 1e-6f &&
                   v_len(v_sub(x->v.wo, y->v.wo)) <= 1e-4f && x->edges == y->edges &&
                   x->flux.g == y->flux.g && x->odds.early == y->odds.early &&
                   x->medium == y->medium && x->v.s.shape == y->v.s.shape,
                   "path %lu: vertex %d is another", (unsigned long)i, k);
        }
    }
    EXPECT(seen > 300, "%ld vertices", seen);
}

static void kept(void)
{
    const SamplerKind *independent = kind_find(samplers, "random");
    Bidirectional b = { 0 };
    LightStore store;
    uint32_t spp = 1;
    Tracer t = { 0 };
    Opts o, none;
    Lab l;

    lab_init(&l);
    add_glass_room(&l);
    l.scene->camera->kind->film(l.scene->camera, 32, 32);
    lab_method(&l, "bdpt:maxdepth=6", &o);
    opts_default(&none, independent->info.options);
    t.scene = l.scene;
    REQUIRE(bidirectional_open(&b, "test", l.scene, &o) &&
            sampler_init(&t.sampler, independent, &none, 3, &spp), "memory");
    for (int straight = 0; straight < 2; straight++) {
        b.techniques.straight = straight;
        REQUIRE(lightstore_init(&store, l.scene, 1500, straight), "memory");
        expect_kept(&b, &store, &t);
        EXPECT((store.straight == NULL) == straight, "vertices that nobody uses have memory");
        lightstore_clear(&store);
    }
    bidirectional_clear(&b);
    sampler_clear(&t.sampler);
    EXPECT(sizeof(KeptVertex) == 64, "a vertex takes %lu bytes", (unsigned long)sizeof(KeptVertex));
    lab_clear(&l);
}

/* ---- extra pictures ---- */

enum { PICTURES = 8, EDGE = 24 };

/* The picture and those asked for, as "NAME=FILE", by the same paths. */
static void render_aovs(Lab *l, const char *method, const char *const *asked, int n,
                        Image im[PICTURES])
{
    RenderSettings s;
    RenderReport report;
    Film film;

    picture_settings(l, &s, method, EDGE, EDGE, 4);
    for (s.naovs = 0; s.naovs < n; s.naovs++)
        REQUIRE(aov_parse(&s.aovs[s.naovs], asked[s.naovs]), "%s", asked[s.naovs]);
    picture_render(l, &s, &film, &report);
    for (int k = 0; k <= n; k++) {
        REQUIRE(image_init(&im[k], EDGE, EDGE), "memory");
        film_picture(&film, k, &im[k]);
    }
    film_clear(&film);
}

static void expect_close(const Image *a, const Image *b, const char *what)
{
    for (size_t i = 0; i < (size_t)EDGE * EDGE; i++) {
        Rgb x = a->pixels[i], y = b->pixels[i];
        EXPECT(fabs((double)x.g - (double)y.g) <= 1e-4 * (double)y.g + 1e-6, "%s: pixel %lu is %g, "
               "expected %g", what, (unsigned long)i, x.g, y.g);
    }
}

/* All ways of making paths of three edges are what these bring, of a picture with mergers too. */
static void techniques_add_up(void)
{
    static const char *const asked[] = {
        "technique:0,4=a.pfm", "technique:1,3=a.pfm", "technique:2,2=a.pfm", "technique:3,1=a.pfm",
        "length:3=a.pfm"
    };
    Image im[PICTURES];
    Lab l;

    lab_init(&l);
    add_glass_room(&l);
    render_aovs(&l, "bdpt:maxdepth=4", asked, 5, im);
    for (size_t i = 0; i < (size_t)EDGE * EDGE; i++)
        for (int k = 2; k <= 4; k++)
            im[1].pixels[i] = rgb_add(im[1].pixels[i], im[k].pixels[i]);
    expect_close(&im[1], &im[5], "paths of three edges");
    for (int k = 0; k <= 5; k++)
        image_clear(&im[k]);
    lab_clear(&l);
}

/* Of several radii each makes the picture that it would alone: paths are the same. */
static void radii(void)
{
    static const char *const asked[] = { "radius:1=a.pfm", "radius:3=a.pfm" };
    static const char *const kinds[] = { "vcm", "bpm" };

    for (int k = 0; k < 2; k++) {
        Image im[PICTURES], alone[PICTURES];
        char text[100];
        Lab l;
        lab_init(&l);
        add_glass_room(&l);
        snprintf(text, sizeof text, "%s:maxdepth=4,little=0,radii=3,radius=0.4", kinds[k]);
        render_aovs(&l, text, asked, 2, im);
        snprintf(text, sizeof text, "%s:maxdepth=4,little=0,radius=0.1", kinds[k]);
        render_aovs(&l, text, NULL, 0, alone);
        expect_close(&im[1], &im[0], "the largest radius");
        expect_close(&im[2], &alone[0], "a quarter of it");
        for (int i = 0; i < 3; i++)
            image_clear(&im[i]);
        image_clear(&alone[0]);
        lab_clear(&l);
    }
}

/* Mergers blur, the less the smaller their radius. */
static double bias_of(Lab *l, const char *method, const Image *truth)
{
    Image im[PICTURES];
    double sum = 0;

    render_aovs(l, method, NULL, 0, im);
    for (size_t i = 0; i < (size_t)EDGE * EDGE; i++)
        sum += fabs((double)im[0].pixels[i].g - (double)truth->pixels[i].g);
    image_clear(&im[0]);
    return sum / (EDGE * EDGE);
}

static void radius_falls(void)
{
    Image truth[PICTURES];
    double large, small;
    Lab l;

    lab_init(&l);
    add_glass_room(&l);
    render_aovs(&l, "path:maxdepth=2@@box", NULL, 0, truth);
    large = bias_of(&l, "vcm:mode=ppm,maxdepth=2,radius=1.5,alpha=1,paths=16", &truth[0]);
    small = bias_of(&l, "vcm:mode=ppm,maxdepth=2,radius=0.2,alpha=1,paths=16", &truth[0]);
    EXPECT(small < 0.7 * large, "off by %g, with a wide radius by %g", small, large);
    image_clear(&truth[0]);
    lab_clear(&l);
}

const TestCase test_bidirectional[] = {
    { "kept", kept, false },
    { "techniques", techniques_add_up, false },
    { "radii", radii, false },
    { "radius_falls", radius_falls, false },
    { "weights", weights, false },
    { "weights_many", weights_long, true },
    { "room", room, false },
    { "split", split, false },
    { "lamps", lamps_balance, true },
    { "lamps_power", lamps_power, true },
    { "lamps_uniform", lamps_uniform, true },
    { "lamps_vcm", lamps_vcm, true },
    { "lenses", lenses, true },
    { "tank", tank, true },
    { "tank_vcm", tank_vcm, true },
    { "glass", glass, true },
    { NULL, NULL, false }
};

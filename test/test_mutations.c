/* test_mutations.c -- moved paths: acceptance by two routes, flows between states that balance, and
 * the density of new paths, from the eye and from both ends.
 *
 * Routes      The program has ratios of colours and of a few changes of measure. Here stands (7.14)
 *             as it is printed, with the corrections of the errata: F per area by fig. 7.20, and T
 *             as the product of T_pixel, T_specular and T_perturbAngle, from the vertices' places
 *             alone, in double; for mutations from the light with the particle's factors.
 * Balance     Samples of the path tracer, each moved once: what flows from A to B must flow back.
 *             There is no formula in that which could be wrong twice. */
#include "integrators/bothpaths.h"
#include "integrators/mutations.h"
#include "integrators/particle.h"
#include "test/chi2.h"
#include "test/lamp_help.h"

#include <stdio.h>
#include <string.h>

enum { SIDE = 16, EVENTS = 6 };         /* paths of up to 7 edges */

/* ---- a world in which every kind of path has its share ---- */

static uint32_t half_mirror(Lab *l, const char *mirrors, uint32_t other)
{
    uint32_t mirror = lab_material(l, "mirror", mirrors),
             mix = lab_material(l, "mix", "amount=0.5");

    l->scene->materials[mix].part[0] = other;
    l->scene->materials[mix].part[1] = mirror;
    return mix;
}

/* A room open to the sky on the eye's side, with water on its floor: what crosses a ball comes out
 * as it went in, and faults of refraction would cancel. Dim: walls reflect little. */
static void add_room(Lab *l, bool dim)
{
    const char *mirrors = dim ? "reflectance=0.4" : "reflectance=0.95";
    uint32_t black = lab_material(l, "diffuse", "reflectance=0"),
             glass = lab_material(l, "dielectric", "eta=1.5"),
             wall = half_mirror(l, mirrors, lab_material(l, "diffuse", dim ? "reflectance=0.3"
                                                         : "reflectance=0.7/0.8/0.6")),
             shiny = half_mirror(l, mirrors, lab_material(l, "phong", dim
                                 ? "reflectance=0.2,specular=0.2,exponent=10"
                                 : "reflectance=0.3,specular=0.5,exponent=10"));

    lab_quad(l, v3(-2, -2, -2), v3(4, 0, 0), v3(0, 4, 0), wall);
    lab_quad(l, v3(-2, -2, 2), v3(0, 4, 0), v3(4, 0, 0), wall);
    lab_quad(l, v3(-2, -2, -2), v3(0, 4, 0), v3(0, 0, 4), shiny);
    lab_quad(l, v3(2, -2, -2), v3(0, 0, 4), v3(0, 4, 0), wall);
    lab_quad(l, v3(-2, 2, -2), v3(0, 0, 4), v3(4, 0, 0), shiny);
    lab_quad(l, v3(-2, -2, -1.5f), v3(4, 0, 0), v3(0, 4, 0), glass);
    lab_sphere(l, v3(-0.7f, 0.5f, -0.6f), 0.7f, glass, false);
    lab_sphere(l, v3(0.9f, 0.2f, 0.3f), 0.5f, glass, false);
    lab_shine(l, lab_quad(l, v3(-1.8f, -1.8f, 1.9f), v3(0, 3.6f, 0), v3(3.6f, 0, 0), black),
              "L=2/2.5/3");
    lab_shine(l, lab_sphere(l, v3(1.3f, 1.2f, -1.4f), 0.5f, black, false), "L=3/2/1");
    lab_light(l, "point", "from=-1/-1/0.5,I=1", NULL);
    lab_light(l, "infinite", "L=0.5/0.7/1", NULL);
    lab_light(l, "distant", "from=0.3/-1/0.2,to=0/0/0,L=2", NULL);
}

/* What moves paths, and where they come from. */
typedef struct {
    Lab lab;
    Filter filter;
    Film film;
    Canvas canvas;
    Tracer t;
    BothPaths paths;
    Mutator mutator;
} World;

static void room_opens(World *w, const char *camera, bool dim)
{
    const uint32_t crop[4] = { 0, 0, SIDE, SIDE };
    uint32_t spp = 0;
    Opts none, mlt;

    memset(w, 0, sizeof *w);
    lab_init(&w->lab);
    add_room(&w->lab, dim);
    lab_camera(&w->lab, v3(0.3f, -5, 0.2f), v3(0, 0, 0), 40, camera);
    lab_build(&w->lab);
    w->lab.scene->camera->kind->film(w->lab.scene->camera, SIDE, SIDE);
    opts_default(&none, filters[0]->info.options);
    filter_init(&w->filter, kind_find(filters, "box"), &none);
    REQUIRE(film_init(&w->film, SIDE, SIDE, crop, 1), "film");
    w->canvas.filter = &w->filter;
    w->canvas.film = &w->film;
    w->t.scene = w->lab.scene;
    w->t.canvas = &w->canvas;
    opts_default(&none, NULL);
    REQUIRE(sampler_init(&w->t.sampler, kind_find(samplers, "random"), &none, 1, &spp), "sampler");
    lab_method(&w->lab, "mlt:direct=no,maxdepth=6,roulette=100,lightsampler=power", &mlt);
    REQUIRE(bothpaths_open(&w->paths, "mlt", w->lab.scene, &mlt, true), "paths");
    REQUIRE(w->paths.eye.maxdepth == EVENTS, "edges");
    w->mutator = (Mutator){ .scene = w->lab.scene, .share = { 1, 1, 1, 3 }, .nearest = 0.1f,
                            .farthest = 8, .least = 1e-3f, .most = 0.5f };
}

static void world_opens(World *w, const char *camera) { room_opens(w, camera, false); }

static void world_clears(World *w)
{
    bothpaths_close(&w->paths);
    film_clear(&w->film);
    sampler_clear(&w->t.sampler);
    lab_clear(&w->lab);
}

typedef struct { Vertex storage[LIGHTPATH_MOST], *at[LIGHTPATH_MOST]; } Rooms;

static void rooms_open(Rooms *r)
{
    for (int i = 0; i < LIGHTPATH_MOST; i++)
        r->at[i] = &r->storage[i];
}

static void trace(World *w, uint32_t number, EyePathFound *found, void *ctx)
{
    LightPath p;
    Rooms rooms, back;
    V2 u;

    rooms_open(&rooms);
    rooms_open(&back);
    sampler_pixel(&w->t.sampler, number, 0);
    sampler_start(&w->t.sampler, 0);
    u = sample_2d(&w->t.sampler, DECISION(DECIDE_PIXEL, 0));
    p.pixel = (V2){ u.x * SIDE, u.y * SIDE };
    eyepath_begins(w->lab.scene, &p, &w->t);
    bothpath_traced(&w->paths, &p, rooms.at, back.at, canvas_places(&w->canvas), &w->t, found, ctx);
}

/* ---- the other route: places in double ---- */

typedef struct { double x, y, z; } D3;

static D3 place(const LightPath *p, int i)
{
    V3 a = i == 0 ? p->eye : i < p->edges ? p->v[i].at->s.p
           : p->end.light->kind->delta ? p->end.to.p : p->end.s.p;
    return (D3){ a.x, a.y, a.z };
}

static bool is_away(const LightPath *p, int i)          /* beyond the scene */
{
    const LightKind *k = p->end.light->kind;
    return i == p->edges && (k->infinite || k->delta == DELTA_DIRECTION);
}

/* The unit vector from vertex i to vertex j, a neighbour. */
static D3 way(const LightPath *p, int i, int j, double *dist)
{
    D3 a = place(p, i), b, d;
    double l;

    if (is_away(p, j) || is_away(p, i)) {
        double s = is_away(p, j) ? 1 : -1;
        *dist = 1;
        return (D3){ s * p->end.d.x, s * p->end.d.y, s * p->end.d.z };
    }
    b = place(p, j);
    d = (D3){ b.x - a.x, b.y - a.y, b.z - a.z };
    l = sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
    *dist = l;
    return (D3){ d.x / l, d.y / l, d.z / l };
}

static double along(D3 a, V3 n) { return a.x * n.x + a.y * n.y + a.z * n.z; }

static bool is_shape(const LightPath *p)
{
    return !p->end.light->kind->infinite && !p->end.light->kind->delta;
}

/* cos / d^2 at vertex i for light from its neighbour j; 1 where there is no area. */
static double area_at(const LightPath *p, int i, int j)
{
    double dist;
    D3 d = way(p, i, j, &dist);

    if (i == p->edges && !is_shape(p))
        return 1;
    return fabs(along(d, i == p->edges ? p->end.s.ng : p->v[i].at->s.ng)) / (dist * dist);
}

static V3 local(const LightPath *p, int i, int j)
{
    double dist;
    D3 d = way(p, i, j, &dist);

    return frame_in(&p->v[i].at->frame, v3((float)d.x, (float)d.y, (float)d.z));
}

/* Of the event at vertex i, for wo: what it weighs as radiance. */
static BsdfSample delta_at(const LightPath *p, int i, V3 wo)
{
    BsdfSample s[BSDF_DELTAS], found = { .pdf_w = 0 };
    int n = bsdf_deltas(p->v[i].at->b, wo, s);

    for (int k = 0; k < n; k++)
        if ((s[k].flags & (BSDF_REFLECT | BSDF_TRANSMIT)) == (int)(p->v[i].event & 3))
            found = s[k];
    return found;
}

static Rgb light_at(const LightPath *p)
{
    double dist;
    D3 d = way(p, p->edges - 1, p->edges, &dist);
    V3 wi = v3((float)d.x, (float)d.y, (float)d.z), from = p->edges > 1 ? p->v[p->edges - 1].at->s.p
                                                                        : p->eye;
    LightSample s;

    if (!p->end.light->kind->delta)
        return p->end.light->kind->radiance(p->end.light, wi, &p->end.s);
    p->end.light->kind->sample(p->end.light, from, (V2){ 0, 0 }, &s);
    return s.L;
}

/* We |cos| at the lens. */
static double lens_at(const World *w, const LightPath *p)
{
    const Camera *c = w->lab.scene->camera;
    double dist;
    D3 d = way(p, 0, 1, &dist);
    Ray r = { .o = p->eye, .d = v3((float)d.x, (float)d.y, (float)d.z), .time = p->time };
    CameraView v;

    REQUIRE(c->kind->view(c, &r, &v), "the lens does not see its own path");
    return (double)v.pdf_a * v.pdf_w;
}

static bool is_delta(const LightPath *p, int i) { return p->v[i].event != EVENT_SMOOTH; }

/* F per area, fig. 7.20, as light goes to the eye: deltas are 1, and are of the light's side. */
static double contribution(const World *w, const LightPath *p)
{
    Rgb c = light_at(p);
    double geometry = lens_at(w, p);

    for (int i = 1; i <= p->edges; i++)
        geometry *= area_at(p, i, i - 1);
    for (int i = 1; i < p->edges; i++) {
        const Bsdf *b = p->v[i].at->b;
        V3 wo = local(p, i, i - 1), wi = local(p, i, i + 1);
        c = rgb_mul(c, is_delta(p, i) ? delta_at(p, i, wo).weight
                                      : rgb_scale(b->kind->eval(b, wo, wi, false), fabsf(wi.z)));
    }
    return rgb_lum(c) * geometry;
}

/* The same as particles go, to vertex `at`: deltas are of the eye's side. From vertex `start`, but
 * for factors that the move does not change. */
static double contribution_of_light(const World *w, const LightPath *p, int at, int start)
{
    const Camera *camera = w->lab.scene->camera;
    double geometry = 1, dist;
    Rgb c = rgb_all(1);
    CameraSample seen;

    if (start == p->edges) {
        D3 d = way(p, start, start - 1, &dist);
        c = light_at(p);
        geometry = is_shape(p) ? fabs(along(d, p->end.s.ng)) : dist * dist;
    }
    for (int i = start < p->edges ? start : start - 1; i >= at; i--) {
        Vertex v = *p->v[i].at;
        V3 wo = local(p, i, i + 1), wi = local(p, i, i - 1), to = frame_out(&v.frame, wi);
        v.wo = wo;
        if (is_delta(p, i)) {
            BsdfSample s = delta_at(p, i, wo);
            c = rgb_mul(c, rgb_scale(s.weight, f_sqr(s.eta) * vertex_skew(&v, to, wi)));
        } else {
            v.b = p->v[i].at->b;
            c = rgb_mul(c, vertex_f_cos_of_light(&v, to, wi));
        }
        if (i < start)
            geometry *= area_at(p, i, i + 1);
    }
    for (int i = 1; i < p->edges; i++)                  /* some for their colour alone */
        if (i > start || i < at)
            c = rgb_mul(c, p->v[i].scatters);
    if (start < p->edges)
        c = rgb_mul(c, light_at(p));
    if (at > 1)
        return rgb_lum(c) * geometry * area_at(p, at - 1, at) / fabsf(local(p, at - 1, at).z);
    REQUIRE(camera->kind->sample(camera, p->v[1].at->s.p, p->lens, p->time, &seen), "lens");
    return rgb_lum(c) * geometry * seen.we / seen.pdf_w;
}

/* ---- T ---- */

/* Of a move by a tangent or a distance r whose logarithm is even, per area. */
static double spread(double r, double least, double most)
{
    return 1 / (2 * PI * r * r * md_log(most / least));
}

static double pixel_pdf(const Mutator *m, const LightPath *x, const LightPath *y)
{
    double dx = (double)y->pixel.x - x->pixel.x, dy = (double)y->pixel.y - x->pixel.y;
    return spread(sqrt(dx * dx + dy * dy), m->nearest, m->farthest);
}

/* Per solid angle: the plane through the old direction's end is seen at 1 / cos^3. */
static double angle_pdf(const Mutator *m, D3 a, D3 b)
{
    double c = a.x * b.x + a.y * b.y + a.z * b.z;
    D3 x = { a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
    double s = sqrt(x.x * x.x + x.y * x.y + x.z * x.z);

    return spread(s / c, m->least, m->most) / (c * c * c);
}

/* From x to y, starting at the eye: T_pixel, then T_specular and T_perturbAngle in turn, until two
 * neighbours are smooth or there is the light. */
static double transition_from_eye(const World *w, const LightPath *x, const LightPath *y)
{
    double dist, t = pixel_pdf(&w->mutator, x, y) * lens_at(w, y) * area_at(y, 1, 0);

    for (int i = 1; i < y->edges; i++) {
        if (!is_delta(y, i)) {
            if (i + 1 == y->edges || !is_delta(y, i + 1))
                return t;
            t *= angle_pdf(&w->mutator, way(x, i, i + 1, &dist), way(y, i, i + 1, &dist));
        }
        t *= area_at(y, i + 1, i);
    }
    return t;
}

/* Between two parallel lines of light from beyond, in radii of the scene. */
static double line_pdf(const World *w, const LightPath *x, const LightPath *y)
{
    double dist, l;
    D3 a = place(x, x->edges - 1), b = place(y, y->edges - 1),
       d = way(x, x->edges, x->edges - 1, &dist);

    a = (D3){ a.x - b.x, a.y - b.y, a.z - b.z };
    l = a.x * d.x + a.y * d.y + a.z * d.z;
    dist = a.x * a.x + a.y * a.y + a.z * a.z - l * l;
    return spread(sqrt(d_max(dist, 0)) / w->lab.scene->radius, w->mutator.least, w->mutator.most);
}

static double transition_from_light(const World *w, const LightPath *x, const LightPath *y,
                                    int at, int start)
{
    double dist, t = is_away(x, start) ? line_pdf(w, x, y)
                                       : angle_pdf(&w->mutator, way(x, start, start - 1, &dist),
                                                   way(y, start, start - 1, &dist));

    for (int i = start - 1; i >= at; i--)
        t *= area_at(y, i, i + 1);
    return t;
}

/* (7.14), before 1 is the most. */
static double as_printed(const World *w, Move m, const LightPath *x, const LightPath *y)
{
    int start = m.at + 1;

    if (!m.at)
        return contribution(w, y) * transition_from_eye(w, y, x) /
               (contribution(w, x) * transition_from_eye(w, x, y));
    while (start < x->edges && is_delta(x, start))
        start++;
    return contribution_of_light(w, y, m.at, start) * transition_from_light(w, y, x, m.at, start) /
           (contribution_of_light(w, x, m.at, start) * transition_from_light(w, x, y, m.at, start));
}

/* ---- what a way of making a path brings ---- */

/* As a particle turns at vertex i. */
static Rgb turn_of_light(const LightPath *p, int i)
{
    Vertex v = *p->v[i].at;
    V3 wi = local(p, i, i - 1), to = frame_out(&v.frame, wi);
    BsdfSample s;

    v.b = p->v[i].at->b;
    v.wo = local(p, i, i + 1);
    if (!is_delta(p, i))
        return vertex_f_cos_of_light(&v, to, wi);
    s = delta_at(p, i, v.wo);
    return rgb_scale(s.weight, f_sqr(s.eta) * vertex_skew(&v, to, wi));
}

/* Particles as the lamp sends them, over their density. */
static Rgb flux_at(const World *w, const LightPath *p)
{
    const Light *l = p->end.light;
    double dist;
    D3 d = way(p, p->edges, p->edges - 1, &dist);
    float a, b, share = w->paths.sending->kind->pmf(w->paths.sending, v_all(0), v_all(0), l);

    l->kind->emit_pdf(l, is_shape(p) ? &p->end.s : NULL, v3((float)d.x, (float)d.y, (float)d.z),
                      &a, &b);
    dist = is_shape(p) ? fabs(along(d, p->end.s.ng)) : dist * dist;
    return rgb_scale(light_at(p), (float)(dist / ((double)share * a * b)));
}

/* Particles that come to vertex j+1, what vertex j makes of them, and how the eye came there, over
 * the chances of all: [Veach97 (10.5)]. */
static double brought(const World *w, const LightPath *p, int j)
{
    const Camera *camera = w->lab.scene->camera;
    Rgb c = flux_at(w, p);
    double geometry = 1, dist;
    CameraSample seen;

    for (int i = p->edges - 1; i > j; i--) {
        V3 from = local(p, i, i + 1), to = local(p, i, i - 1);
        c = rgb_mul(c, turn_of_light(p, i));
        if (i > j + 1)
            geometry /= chance_of(p->v[i].at, from, to, p->v[i].event);
    }
    for (int i = 1; i <= j; i++) {
        const Bsdf *b = p->v[i].at->b;
        V3 wo = local(p, i, i - 1), wi = local(p, i, i + 1);
        c = rgb_mul(c, is_delta(p, i) ? delta_at(p, i, wo).weight
                                      : rgb_scale(b->kind->eval(b, wo, wi, false), fabsf(wi.z)));
        if (i < j)
            geometry /= chance_of(p->v[i].at, wo, wi, p->v[i].event);
    }
    if (j > 0) {
        way(p, j, j + 1, &dist);
        return rgb_lum(c) * geometry / (dist * dist);
    }
    REQUIRE(camera->kind->sample(camera, p->v[1].at->s.p, p->lens, p->time, &seen), "lens");
    return rgb_lum(c) * geometry * seen.we / seen.pdf_w;
}

static double roughness(const LightPath *p);

typedef struct { World *w; uint64_t ways, far, only, by[EVENTS + 1]; double worst; } Brought;

/* By every way, whichever has found the path. only: no other way finds it. */
static void compare_ways(void *ctx, const LightPath *p, int by, double scale, Tracer *t)
{
    Brought *b = ctx;
    double density[LIGHTPATH_MOST], sum = 0;

    bothpath_densities(&b->w->paths, p, true, canvas_places(t->canvas), density);
    for (int k = 0; k < p->edges; k++) {
        double off;
        sum += density[k];
        if (k == 0 || !(density[k] > 0))
            continue;
        off = fabs(rgb_lum(p->colour) / density[k] / brought(b->w, p, k - 1) - 1);
        b->ways++;
        b->by[k - 1]++;
        b->far += off > 1e-4;
        b->worst = d_max(b->worst, off / roughness(p));
    }
    b->only += density[by] == sum;
    EXPECT(fabs(scale * sum - 1) < 1e-5, "weight by way %d is off: %g", by, scale * sum);
}

/* Colour over density, and the product along both subpaths. */
static void ways_of(const char *camera)
{
    static World w;
    Brought b = { .w = &w };
    uint64_t least = test_is_long() ? 1000000 : 100000;

    world_opens(&w, camera);
    for (uint32_t n = 0; b.ways < least; n++)
        trace(&w, n, compare_ways, &b);
    for (int k = 0; k < EVENTS; k++)
        EXPECT(b.by[k] > least / 200, "few are joined at vertex %d: %.0f", k, (double)b.by[k]);
    EXPECT(b.only > 100, "%.0f paths can be made in one way only", (double)b.only);
    EXPECT(b.far * 100 < b.ways, "%.0f of %.0f are off by more than 1e-4", (double)b.far,
           (double)b.ways);
    EXPECT(b.worst < 1e-4, "the worst is off by %g for each of its small numbers", b.worst);
    world_clears(&w);
}

static void ways(void)
{
    ways_of("");
    ways_of("lensradius=0.2,focaldistance=5");
}

/* Paths found in each way: as many as without roulette, where each stands for those it ended. */
typedef struct { World *w; double found[EVENTS + 1]; } Found;

static void count_ways(void *ctx, const LightPath *p, int by, double scale, Tracer *t)
{
    Found *f = ctx;
    double density[LIGHTPATH_MOST], sum = 0;

    bothpath_densities(&f->w->paths, p, true, canvas_places(t->canvas), density);
    for (int k = 0; k < p->edges; k++)
        sum += density[k];
    f->found[by] += scale * sum;
}

static void found_by_ways(World *w, int roulette, uint32_t seed, Stat by[EVENTS + 1])
{
    enum { N = 150000 };

    memset(by, 0, (EVENTS + 1) * sizeof *by);
    w->paths.eye.roulette = roulette;
    for (uint32_t n = 0; n < N; n++) {
        Found f = { .w = w };
        trace(w, seed + n, count_ways, &f);
        for (int k = 0; k <= EVENTS; k++)
            stat_add(&by[k], f.found[k]);
    }
}

static void roulette(void)
{
    static World w;
    Stat with[EVENTS + 1], without[EVENTS + 1];
    char what[40];

    room_opens(&w, "", true);
    found_by_ways(&w, 1, 0, with);
    found_by_ways(&w, 100, 1u << 20, without);
    for (int k = 0; k < 4; k++) {               /* others are few */
        snprintf(what, sizeof what, "paths by way %d", k);
        stat_expect_same(&with[k], &without[k], 0.25, what);
    }
    world_clears(&w);
}

/* ---- acceptance by both ---- */

enum { SIGNATURES = 1 << (EVENTS + 1) };

typedef struct {
    World *w;
    Rng   r;
    uint64_t moves[MUTATIONS], of[SIGNATURES], far, own;
    double worst;
} Routes;

/* Events as bits behind a first 1. */
static uint32_t signature(const LightPath *p)
{
    uint32_t bits = 1;

    for (int i = 1; i < p->edges; i++)
        bits = bits << 1 | is_delta(p, i);
    return bits;
}

/* What roundings of places and directions are divided by, in all. */
static double roughness(const LightPath *p)
{
    double sum = 1 / p->end.cosine;

    for (int i = 1; i < p->edges; i++) {
        const PathVertex *v = &p->v[i];
        sum += 1 / v->dist + 1 / fabs(v->wo.z) + 1 / fabs(v->wi.z) + 1 / v->cos_o + 1 / v->cos_i;
    }
    return sum;
}

static void compare_routes(void *ctx, const LightPath *p, int by, double scale, Tracer *t)
{
    Routes *c = ctx;
    LightPath x, y;
    Rooms rooms, spare;

    (void)by, (void)scale;
    rooms_open(&rooms);
    rooms_open(&spare);
    path_copies(&x, p, rooms.at, c->w->lab.scene);
    for (int i = 0; i < 4; i++) {
        Mutation m = mutation_chosen(&c->w->mutator, &x, rng_unit(&c->r));
        double q, expected, off;
        Move move;
        if (m == MUTATIONS)
            return;
        move = mutation_move(m, &x, rng_unit(&c->r));
        q = mutated(&c->w->mutator, move, &x, &y, spare.at, &c->r, t);
        if (!(q > 0))
            continue;
        EXPECT(!x.end.light->kind->delta == !y.end.light->kind->delta,
               "mutation %d goes to a light from which none comes back", (int)m);
        expected = as_printed(c->w, move, &x, &y);
        off = fabs(q / expected - 1);
        c->moves[m]++;
        c->own += p->end.light->kind->delta && is_delta(p, p->edges - 1);
        c->of[signature(p)]++;
        c->far += off > 1e-4;
        c->worst = d_max(c->worst, off / (roughness(&x) + roughness(&y)));
    }
}

/* All but a few agree to 1e-4: those in which roundings count most, with a bound that grows so. */
static void routes_of(const char *camera)
{
    World w;
    Routes c = { .w = &w, .r = rng_seed(5) };
    uint64_t moves = 0, least = test_is_long() ? 1000000 : 100000;
    int kinds = 0;

    world_opens(&w, camera);
    for (uint32_t n = 0; moves < least; n++) {
        trace(&w, n, compare_routes, &c);
        moves = c.moves[0] + c.moves[1] + c.moves[2];
    }
    for (int k = 0; k < SIGNATURES; k++)
        kinds += c.of[k] > 0;
    for (int m = 0; m < MUTATIONS; m++)
        EXPECT(c.moves[m] > least / 50, "few moves of kind %d: %.0f", m, (double)c.moves[m]);
    EXPECT(c.far * 200 < moves, "%.0f of %.0f moves are off by more than 1e-4", (double)c.far,
           (double)moves);
    EXPECT(c.worst < 1e-4, "the worst is off by %g for each of its small numbers", c.worst);
    EXPECT(c.own > least / 500, "few end at points by delta events: %.0f", (double)c.own);
    EXPECT(kinds >= 108, "%d kinds of paths of 127", kinds);
    world_clears(&w);
}

static void routes(void)
{
    routes_of("");
    routes_of("lensradius=0.2,focaldistance=5");
}

/* ---- balance ---- */

enum { STATES = 8, BALANCED = 3 };      /* BALANCED: most events */

typedef struct {
    World *w;
    Rng   r;
    Mutation only;
    double flow[STATES][STATES], squares[STATES][STATES];
} Flows;

/* Where the path is on the picture, and which way the light comes to the first surface; of what
 * moves further inside, ways alone. */
static int state_of(Mutation m, const LightPath *p)
{
    V3 d = p->edges > 1 ? p->v[1].way : p->way;
    if (m == MUTATE_INNER)
        return (p->v[2].way.x < 0) + 2 * (d.z < 0) + 4 * (d.x < 0);
    return (p->pixel.x < SIDE / 2) + 2 * (p->pixel.y < SIDE / 2) + 4 * (d.x < 0);
}

static void flow_once(void *ctx, const LightPath *x, int by, double scale, Tracer *t)
{
    Flows *f = ctx;
    double e = rgb_lum(x->colour) * scale;
    LightPath y;
    Rooms rooms;

    (void)by;
    if (!mutation_applies(f->only, x))
        return;
    rooms_open(&rooms);
    e *= d_min(mutated(&f->w->mutator, mutation_move(f->only, x, rng_unit(&f->r)), x, &y,
                       rooms.at, &f->r, t), 1);
    if (e > 0) {
        f->flow[state_of(f->only, x)][state_of(f->only, &y)] += e;
        f->squares[state_of(f->only, x)][state_of(f->only, &y)] += e * e;
    }
}

/* The sum of z^2 over pairs of states between which enough flows. */
static void balance_of(Mutation m, double square, float least, int least_pairs)
{
    static World w;
    Flows f = { .w = &w, .r = rng_seed(17), .only = m };
    double chi2 = 0;
    int pairs = 0;

    world_opens(&w, "lensradius=0.1,focaldistance=5");
    w.mutator.square = (float)square;
    w.mutator.nearest = 2;
    w.mutator.least = least;
    w.mutator.most = 1;
    w.paths.eye.maxdepth = BALANCED;
    for (uint32_t n = 0; n < (test_is_long() ? 4800000 : 200000); n++)
        trace(&w, n, flow_once, &f);
    for (int a = 0; a < STATES; a++)
        for (int b = 0; b < a; b++) {
            double d = f.flow[a][b] - f.flow[b][a], v = f.squares[a][b] + f.squares[b][a];
            double sum = f.flow[a][b] + f.flow[b][a];
            if (v > 0 && sum * sum > 30 * v) {          /* as if of 30 equal moves */
                chi2 += d * d / v;
                pairs++;
            }
        }
    EXPECT(pairs >= least_pairs, "kind %d: %d pairs of states", (int)m, pairs);
    EXPECT(chi2_tail(chi2, pairs) >= CHI2_P_MIN, "kind %d: chi^2 = %.1f of %d pairs", (int)m, chi2,
           pairs);
    world_clears(&w);
}

static void balance(void)
{
    balance_of(MUTATE_LENS, 0, 0.1f, 20);
    balance_of(MUTATE_LENS, 9, 0.1f, 20);
    balance_of(MUTATE_CAUSTIC, 0, 0.1f, 10);
    if (test_is_long()) {               /* fewer of them cross from state to state */
        balance_of(MUTATE_MULTICHAIN, 0, 0.001f, 8);
        balance_of(MUTATE_INNER, 0, 0.1f, 8);
    }
}

/* ---- new paths ---- */

/* Of a point or one direction, by delta events: the eye alone does not find such paths. */
static bool is_lamps_own(const LightPath *p)
{
    return p->end.light->kind->delta && p->edges > 1 && is_delta(p, p->edges - 1);
}

/* What paths of each number of edges bring: all, and without those that the eye cannot find. */
typedef struct { double all[EVENTS + 2], eye[EVENTS + 2]; } ByEdges;

static void add_to_edges(void *ctx, const LightPath *p, int by, double scale, Tracer *t)
{
    ByEdges *b = ctx;
    double light = rgb_lum(p->colour) * scale;

    (void)by, (void)t;
    b->all[p->edges] += light;
    b->eye[p->edges] += is_lamps_own(p) ? 0 : light;
}

/* A single path of so many edges, over its density; by: a way, or -1 for all with equal chances. */
static double single(World *w, uint32_t n, int edges, int by)
{
    Places where = canvas_places(&w->canvas);
    double density[LIGHTPATH_MOST], sum = 0;
    LightPath p;
    Rooms rooms;
    V2 u;

    rooms_open(&rooms);
    sampler_pixel(&w->t.sampler, n, (uint32_t)(edges + (by < 0 ? 100 : 0)));
    sampler_start(&w->t.sampler, 0);
    u = sample_2d(&w->t.sampler, DECISION(DECIDE_PIXEL, 0));
    p.pixel = (V2){ u.x * SIDE, u.y * SIDE };
    p.edges = edges;
    eyepath_begins(w->lab.scene, &p, &w->t);
    if (!bothpath_new(&w->paths, &p, by < 0 ? (int)(n % (uint32_t)edges) : by, rooms.at, where,
                      &w->t))
        return 0;
    bothpath_densities(&w->paths, &p, false, where, density);
    for (int k = 0; k < edges; k++)
        sum += by < 0 ? density[k] / edges : k == by ? density[k] : 0;
    return rgb_lum(p.colour) / sum;
}

/* Single paths over their density, by the eye and by all ways, and whole paths bring the same;
 * whole paths of the eye bring what they can. */
static void new_paths(void)
{
    static World w;
    Stat whole[EVENTS + 2], eye[EVENTS + 2], part[EVENTS + 2];
    uint32_t runs = test_is_long() ? 1600000 : 100000;

    memset(whole, 0, sizeof whole);
    memset(eye, 0, sizeof eye);
    memset(part, 0, sizeof part);
    world_opens(&w, "");
    for (uint32_t n = 0; n < 2 * runs; n++) {
        LightSampler *sending = w.paths.sending;
        ByEdges b = { { 0 }, { 0 } };
        w.paths.sending = n & 1 ? sending : NULL;
        trace(&w, n, add_to_edges, &b);
        w.paths.sending = sending;
        for (int k = 1; k < EVENTS + 2; k++) {
            stat_add(n & 1 ? &whole[k] : &eye[k], b.all[k]);
            if (n & 1)
                stat_add(&part[k], b.eye[k]);
        }
    }
    for (int k = 1; k <= (test_is_long() ? EVENTS : 4); k++) {
        Stat by_eye = { 0, 0, 0, 0, 0 }, by_all = { 0, 0, 0, 0, 0 };
        char what[40];
        for (uint32_t n = 0; n < runs; n++) {
            stat_add(&by_eye, single(&w, n, k, BY_EYE));
            stat_add(&by_all, single(&w, n, k, -1));
        }
        snprintf(what, sizeof what, "%d edges", k);
        stat_expect_same(&by_eye, &eye[k], 0.3, what);
        stat_expect_same(&part[k], &eye[k], 0.3, what);
        stat_expect_same(&by_all, &whole[k], 0.3, what);
    }
    world_clears(&w);
}

const TestCase test_mutations[] = {
    { "routes", routes, false },
    { "balance", balance, false },
    { "ways", ways, false },
    { "roulette", roulette, false },
    { "new_paths", new_paths, false },
    { NULL, NULL, false }
};

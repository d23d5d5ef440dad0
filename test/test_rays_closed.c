/* test_rays_closed.c -- no ray slips out of a closed body, wherever it is aimed: at every vertex,
 * at points of edges, from inside, at scales from 1e-6 to 1e6 and far from the origin. Random rays
 * would prove nothing: a triangle test that leaks at one in ten rays aimed at edges may not lose
 * one in a million random ones.
 *
 * That the ray is aimed only to the rounding of its direction is what makes it hard: it passes on
 * either side of the edge, or exactly through. That the origin is inside is certain: it lies in a
 * ball within the body, smaller by what the rounding of the vertices can move a face. A body stays
 * closed whatever its vertices are rounded to, since triangles share them. */
#include "test/ray_help.h"

#include <stdio.h>
#include <string.h>

/* A closed mesh and a ball in it. */
typedef struct {
    const char *name;
    void (*make)(Mesh *m);
    V3 centre;
    float radius;
    float clear;                /* convex bodies: least distance of a face's plane to the ball */
    bool ring;                  /* the centre may be turned about the z axis by any angle */
} Body;

/* ---- bodies ---- */

#define MAKE(name, call) \
    static void name(Mesh *m) { memset(m, 0, sizeof *m); REQUIRE(call, "memory"); }
MAKE(cube, mesh_cube(m))
MAKE(room, mesh_room(m))
MAKE(sphere, mesh_icosphere(m, 24))
MAKE(small_sphere, mesh_icosphere(m, 2))
MAKE(globe, mesh_uvsphere(m, 48, 24))
MAKE(bumpy, mesh_bumpy(m, 16, 7))
MAKE(blob, mesh_blob(m, 3))
MAKE(torus, mesh_torus(m, 48, 24, 1.0f, 0.5f))
/* Two cones of thin triangles, base to base: each 1 by 1.3e-3 (and 6e-5). */
MAKE(spindle, mesh_uvsphere(m, 5000, 2))
MAKE(fine_spindle, mesh_uvsphere(m, 100000, 2))

/* A tube of 2 n side triangles, 4 long and 6.3 / n wide, between two fans. */
static void tube(Mesh *m)
{
    enum { N = 3000 };
    mesh_of(m, 2 * N, 4 * N - 4);
    for (uint32_t i = 0, t = 0; i < N; i++) {
        uint32_t next = (i + 1) % N;
        float x, y;
        m_sincos_turn((float)((double)i / N), &y, &x);
        m->p[i] = v3(x, y, -2.0f);
        m->p[N + i] = v3(x, y, 2.0f);
        m->tri[t++] = (Tri){ { i, next, N + next } };
        m->tri[t++] = (Tri){ { i, N + next, N + i } };
        if (i > 0 && i < N - 1) {
            m->tri[t++] = (Tri){ { 0, next, i } };
            m->tri[t++] = (Tri){ { N, N + i, N + next } };
        }
        m->ntris = t;
    }
}

static void stretch(Mesh *m, V3 by)
{
    for (uint32_t i = 0; i < m->nverts; i++)
        m->p[i] = v_mul(m->p[i], by);
}
static void pencil(Mesh *m) { sphere(m); stretch(m, v3(1.0f, 1e-2f, 1e-2f)); }
static void pancake(Mesh *m) { globe(m); stretch(m, v3(1.0f, 1.0f, 1e-2f)); }

/* The balls: inscribed ones, a tenth smaller or more. Faces of the waved bodies are no nearer than
 * 0.7 times the cosine of half the angle that a facet fills. */
enum { WAVED = 4, THIN = 7, FINE = 11, BODIES = 12, SMALL = 3 };
static const Body bodies[BODIES] = {
    { "cube", cube, { 0, 0, 0 }, 0.45f, 0.05f, false },
    { "room", room, { 0.5f, 0.5f, 0.5f }, 0.45f, 0, false },
    { "sphere", sphere, { 0, 0, 0 }, 0.9f, 0.09f, false },
    { "globe", globe, { 0, 0, 0 }, 0.9f, 0.09f, false },
    { "bumpy", bumpy, { 0, 0, 0 }, 0.6f, 0, false },
    { "blob", blob, { 0, 0, 0 }, 0.5f, 0, false },
    { "torus", torus, { 1, 0, 0 }, 0.43f, 0, true },
    { "spindle", spindle, { 0, 0, 0 }, 0.6f, 0.1f, false },
    { "tube", tube, { 0, 0, 0 }, 0.9f, 0.09f, false },
    { "pencil", pencil, { 0, 0, 0 }, 0.009f, 0, false },
    { "pancake", pancake, { 0, 0, 0 }, 0.009f, 0, false },
    { "fine spindle", fine_spindle, { 0, 0, 0 }, 0.6f, 0.1f, false }
};

static const Body small[SMALL] = {
    { "cube", cube, { 0, 0, 0 }, 0.45f, 0.05f, false },
    { "small sphere", small_sphere, { 0, 0, 0 }, 0.8f, 0, false },
    { "blob", blob, { 0, 0, 0 }, 0.5f, 0, false }
};

/* ---- places ---- */

typedef struct { double scale; V3 offset; } Where;
static const Where places[] = {
    { 1, { 0, 0, 0 } },
    { 1e-6, { 0, 0, 0 } }, { 1e-3, { 0, 0, 0 } }, { 1e3, { 0, 0, 0 } }, { 1e6, { 0, 0, 0 } },
    { 1, { 100, -50, 25 } }, { 1, { 148376, 1234, -223423 } }, { 1, { 1e6f, 1e6f, 1e6f } },
    { 1, { -1e6f, 0, 1 } }, { 1, { 0, 65536, 0 } },
    { 1e-3, { 1, 2, -3 } }, { 1e3, { -1e6f, 1e6f, 1e6f } },
    { 0, { 0, 0, 0 } }
};

/* Rounding to float moves a vertex by up to half a step in each coordinate. */
static float moved_by_rounding(const Where *p)
{
    float far = v_max3(v_abs(p->offset));
    return 0.87f * (float_after(far) - far) + 3.0f * ROUNDINGS(1) * (float)p->scale;
}

static V3 origin_in(const Body *b, const Where *p, Rng *rng)
{
    V3 c = b->centre;
    float r = (float)p->scale * b->radius - 2.0f * moved_by_rounding(p);
    double s = p->scale;

    if (b->ring) {
        float x, y;
        m_sincos_turn(rng_unit(rng), &y, &x);
        c = v3(c.x * x, c.x * y, c.z);
    }
    c = v3((float)(s * c.x + p->offset.x), (float)(s * c.y + p->offset.y),
           (float)(s * c.z + p->offset.z));
    return v_mad(rng_direction(rng), r * rng_unit(rng), c);
}

/* ---- shooting ---- */

typedef struct { uint64_t rays, lost, unblocked, misplaced; } Tally;

/* The way to the hit. Aimed at a point of a convex surface, the ray must end there. The triangle
 * test and the rounding of the direction move the ray sideways by less than 16 roundings of the way
 * q, and so along itself by that over the cosine, which is at least clear / q. Zero `clear`: any
 * hit will do. */
static bool ends_there(const Ray *r, const Hit *h, float q, float clear)
{
    float way = h->t * v_len(r->d);
    return clear <= 0.0f || fabsf(way - q) <= ROUNDINGS(16) * q * (1.0f + q / clear);
}

static void shoot(const Accel *a, V3 o, V3 at, uint32_t how, float clear, Tally *t)
{
    Ray r = { o, { 0, 0, 0 }, INFINITY };
    float q;
    Hit h;

    r.d = v_sub(at, o);
    q = v_len(r.d);
    if (how % 2)
        r.d = v_unit(r.d);
    if (how % 8 == 2)
        r.d = v_scale(r.d, 0x1p-40f);
    t->rays++;
    t->unblocked += !accel_blocked(a, &r);
    if (!accel_nearest(a, &r, &h)) {
        if (!t->lost++)
            printf("lost %s\n", ray_text(&r));
    } else if (!ends_there(&r, &h, q, clear))
        if (!t->misplaced++)
            printf("t %a and not %a: %s\n", (double)h.t, (double)(q / v_len(r.d)), ray_text(&r));
}

static V3 on_some_edge(const Geometry *g, Rng *rng)
{
    float w = rng_unit(rng);
    V3 c[3];
    geometry_corners(g, rng_below(rng, (uint32_t)g->ntris), c);
    return blend(c[0], c[1], c[2], v3(w, 1.0f - w, 0.0f));
}

static void shoot_body(const Accel *a, const Body *b, const Where *p, uint32_t rays, Tally *t)
{
    const Geometry *g = a->geo;
    bool exact = p->offset.x == 0.0f && p->offset.y == 0.0f && p->offset.z == 0.0f;
    float clear = exact ? (float)p->scale * b->clear : 0.0f;
    Rng rng = rng_seed(17);

    for (uint32_t i = 0; i < rays; i++) {
        V3 o = origin_in(b, p, &rng);
        V3 at = i % 2 ? g->p[i / 2 % (uint32_t)g->nverts] : on_some_edge(g, &rng);
        shoot(a, o, at, rng_below(&rng, 64), clear, t);
    }
}

static void report(const Setting *s, const char *what, const Where *p, const Tally *t)
{
    printf("%s, %s, %g at (%g %g %g): %lu rays, %lu lost\n", s->name, what, p->scale,
           (double)p->offset.x, (double)p->offset.y, (double)p->offset.z, (unsigned long)t->rays,
           (unsigned long)t->lost);
    EXPECT(!t->lost && !t->unblocked && !t->misplaced,
           "%s, %s times %g at (%g %g %g): of %lu rays %lu lost, %lu unblocked, %lu misplaced",
           s->name, what, p->scale, (double)p->offset.x, (double)p->offset.y, (double)p->offset.z,
           (unsigned long)t->rays, (unsigned long)t->lost, (unsigned long)t->unblocked,
           (unsigned long)t->misplaced);
}

/* Only where the rounding of the vertices leaves the ball some size. */
static bool fits(const Body *b, const Where *p)
{
    return (float)p->scale * b->radius > 3.0f * moved_by_rounding(p);
}

static Accel *place(const Setting *s, void (*make)(Mesh *m), const Where *p, Geometry *g)
{
    Mesh m;
    make(&m);
    mesh_place(&m, p->scale, p->offset);
    geometry_of(g, &m);
    return setting_build(s, g);
}

static void shoot_bodies(const Setting *s, const Body *b, const Body *end, uint32_t rays)
{
    for (; b < end; b++)
        for (const Where *p = places; p->scale > 0; p++) {
            Tally t = { 0, 0, 0, 0 };
            Geometry g;
            Accel *a;
            if (!fits(b, p))
                continue;
            a = place(s, b->make, p, &g);
            shoot_body(a, b, p, rays * (test_is_long() ? 10 : 1), &t);
            report(s, b->name, p, &t);
            accel_free(a);
            geometry_clear(&g);
        }
}

static void fast(const Body *b, const Body *end, uint32_t rays)
{
    for (const Setting *s = settings_usual(); s[1].kind; s++)
        shoot_bodies(s, b, end, rays);
}

static void solid(void) { fast(bodies, bodies + WAVED, 14000); }
static void waved(void) { fast(bodies + WAVED, bodies + THIN, 14000); }
static void thin(void) { fast(bodies + THIN, bodies + FINE, 5000); }
static void fine(void) { fast(bodies + FINE, bodies + BODIES, 5000); }
static void brute_force(void) { shoot_bodies(setting_brute(), small, small + SMALL, 4000); }

/* The eye in the plane of a wall, or within a few steps of it: the L-shaped room's two inner walls
 * lie in x = 1 and y = 1, and are seen edge-on from everywhere in those planes. */
static void shoot_edge_on(const Setting *s, const Where *p, uint32_t rays, Tally *t)
{
    Geometry g;
    Accel *a = place(s, room, p, &g);
    Rng rng = rng_seed(18);

    for (uint32_t i = 0; i < rays; i++) {
        float near = (float)p->scale, side = rng_between(&rng, 0.1f, 0.9f) * near;
        int steps = (int)rng_below(&rng, 33) - 16;
        V3 o;
        for (; steps > 0; steps--)
            near = float_after(near);
        for (; steps < 0; steps++)
            near = float_before(near);
        o = v3(near, side, rng_between(&rng, 0.1f, 0.9f) * (float)p->scale);
        if (i % 4 < 2)
            o = v3(o.y, o.x, o.z);
        shoot(a, o, i % 2 ? g.p[rng_below(&rng, (uint32_t)g.nverts)] : on_some_edge(&g, &rng),
              rng_below(&rng, 64), 0.0f, t);
    }
    accel_free(a);
    geometry_clear(&g);
}

static void edge_on(void)
{
    for (const Setting *s = settings_usual(); s->kind; s++)
        for (const Where *p = places; p < places + 5; p++) {
            Tally t = { 0, 0, 0, 0 };
            shoot_edge_on(s, p, test_is_long() ? 400000 : 20000, &t);
            report(s, "edge-on", p, &t);
        }
}

const TestCase test_rays_closed[] = {
    { "solid", solid, false }, { "waved", waved, false }, { "thin", thin, false },
    { "brute", brute_force, false }, { "edge_on", edge_on, false }, { "fine", fine, true },
    { NULL, NULL, false }
};

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
static void rod(Mesh *m) { cube(m); stretch(m, v3(1e-3f, 1e-3f, 1.0f)); }
static void pencil(Mesh *m) { sphere(m); stretch(m, v3(1.0f, 1e-2f, 1e-2f)); }
static void pancake(Mesh *m) { globe(m); stretch(m, v3(1.0f, 1.0f, 1e-2f)); }

/* The balls: inscribed ones, a tenth smaller or more. Faces of the waved bodies are no nearer than
 * 0.7 times the cosine of half the angle that a facet fills. */
enum { WAVED = 5, THIN = 8, FINE = 12, BODIES = 13, SMALL = 3 };
static const Body bodies[BODIES] = {
    { "cube", cube, { 0, 0, 0 }, 0.45f, 0.05f, false },
    { "room", room, { 0.5f, 0.5f, 0.5f }, 0.45f, 0, false },
    { "rod", rod, { 0, 0, 0 }, 4.5e-4f, 0, false },
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
 * q, and so along itself by that over the least cosine. Cosine 0: any hit will do. */
static bool ends_there(const Ray *r, const Hit *h, float q, float cosine)
{
    float way = h->t * v_len(r->d);
    return cosine <= 0.0f || fabsf(way - q) <= ROUNDINGS(16) * q * (1.0f + 1.0f / cosine);
}

/* clear: least distance of a plane that the ray may meet; 0: unknown. */
static void shoot(const Accel *a, V3 o, V3 at, uint32_t how, float clear, Tally *t)
{
    Ray r = { .o = o, .d = { 0, 0, 0 }, .tmax = INFINITY };
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
    } else if (!ends_there(&r, &h, q, clear / q))
        if (!t->misplaced++)
            printf("t %a and not %a: %s\n", (double)h.t, (double)(q / v_len(r.d)), ray_text(&r));
}

static V3 on_edge_of(const Geometry *g, uint32_t prim, Rng *rng)
{
    float w = rng_unit(rng);
    uint32_t k = rng_below(rng, 3);
    V3 c[3];
    geometry_corners(g, prim, c);
    return blend(c[k], c[(k + 1) % 3], c[(k + 2) % 3], v3(w, 1.0f - w, 0.0f));
}

static V3 on_some_edge(const Geometry *g, Rng *rng)
{
    return on_edge_of(g, rng_below(rng, (uint32_t)g->ntris), rng);
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
    return setting_arrange(s, g);
}

/* In the short run a body stands in every second place only, in those between for the next setting
 * and for the next body: every setting meets every place, and every body both. */
static void shoot_bodies(const Setting *s, int turn, const Body *b, const Body *end, uint32_t rays)
{
    for (; b < end; b++, turn++)
        for (const Where *p = places; p->scale > 0; p++) {
            Tally t = { 0, 0, 0, 0 };
            Geometry g;
            Accel *a;
            if (!fits(b, p) || (!test_is_long() && (turn + (p - places)) % 2))
                continue;
            a = place(s, b->make, p, &g);
            /* Cells are slow where floats cannot tell them apart. */
            shoot_body(a, b, p, test_is_long() ? 10 * rays : a->refs ? rays / 5 : rays, &t);
            report(s, b->name, p, &t);
            accel_free(a);
            geometry_clear(&g);
        }
}

static void fast(const Body *b, const Body *end, uint32_t rays)
{
    int turn = 0;
    for (const Setting *s = settings_usual(); s[1].kind; s++)
        shoot_bodies(s, turn++, b, end, rays);
}

static void solid(void) { fast(bodies, bodies + WAVED, 14000); }
static void waved(void) { fast(bodies + WAVED, bodies + THIN, 14000); }
static void thin(void) { fast(bodies + THIN, bodies + FINE, 1200); }
static void fine(void) { fast(bodies + FINE, bodies + BODIES, 5000); }
static void brute_force(void) { shoot_bodies(setting_brute(), 0, small, small + SMALL, 4000); }

/* From outside, from as far as 1e5 radii: the ray must stop at the front of a ball that it is aimed
 * at. Boxes, small as they are, must let pass what a float direction can wander on the way. Where
 * the ball's radius makes a cosine of 0.3 with the ray, faces make one of 0.2 at least. */
static void shoot_ball(const Setting *s, const Where *p, uint32_t rays, Tally *t)
{
    Rng rng = rng_seed(19);
    Geometry g;
    Accel *a = place(s, sphere, p, &g);

    for (uint32_t i = 0; i < rays; i++) {
        float far = (float)(p->scale * md_pow(10, 0.3 + 4.7 * rng_unit(&rng)));
        V3 o = v_mad(rng_direction(&rng), far, p->offset), way, out;
        V3 at = i % 2 ? g.p[rng_below(&rng, (uint32_t)g.nverts)] : on_some_edge(&g, &rng);
        way = v_sub(o, at);
        out = v_sub(at, p->offset);
        if (v_dot(way, out) > 0.3f * v_len(way) * v_len(out))
            shoot(a, o, at, rng_below(&rng, 64), 0.2f * v_len(way), t);
    }
    accel_free(a);
    geometry_clear(&g);
}

static void outside(void)
{
    for (const Setting *s = settings_usual(); s[1].kind; s++)
        for (const Where *p = places; p < places + 5; p++) {
            Tally t = { 0, 0, 0, 0 };
            shoot_ball(s, p, test_is_long() ? 1000000 : 100000, &t);
            report(s, "from outside", p, &t);
        }
}

/* From 1e-1 to 1e-5 away from an edge, at another point of that edge, from 1 to 1e-4 farther on, or
 * beside it by a bit more than rounding: faces reach far behind the eye, and what they err by is
 * large against the way. */
static void shoot_close(const Setting *s, const Body *b, const Where *p, uint32_t rays, Tally *t)
{
    Rng rng = rng_seed(20);
    Geometry g;
    Accel *a = place(s, b->make, p, &g);

    for (uint32_t i = 0; i < rays; i++) {
        float in = (float)md_pow(10, -1 - 4 * rng_unit(&rng)), w = rng_unit(&rng), on;
        uint32_t k = rng_below(&rng, 3);
        V3 c[3], by, at, o, off;
        geometry_corners(&g, rng_below(&rng, (uint32_t)g.ntris), c);
        by = blend(c[k], c[(k + 1) % 3], c[0], v3(w, 1 - w, 0));
        on = (1 - w) * (float)md_pow(10, -4 * rng_unit(&rng));
        at = blend(c[k], c[(k + 1) % 3], c[0], v3(w + on, 1 - w - on, 0));
        o = v_lerp(by, origin_in(b, p, &rng), in);
        off = v_scale(rng_direction(&rng), v_len(v_sub(at, o)));
        off = v_scale(off, (float)md_pow(10, -3 - 5 * rng_unit(&rng)));
        shoot(a, o, i % 2 ? at : v_add(at, off), rng_below(&rng, 64), 0.0f, t);
    }
    accel_free(a);
    geometry_clear(&g);
}

static void close_by(void)
{
    for (const Setting *s = settings_usual(); s[1].kind; s++)
        for (const Body *b = bodies; b < bodies + WAVED; b++)
            for (const Where *p = places; p < places + 5; p++) {
                Tally t = { 0, 0, 0, 0 };
                shoot_close(s, b, p, test_is_long() ? 300000 : 30000, &t);
                report(s, b->name, p, &t);
            }
}

/* The eye in the plane of a wall, to rounding: the L room's two inner walls, y = 1 and x = 1,
 * are triangles 4 to 7 and seen edge-on from everywhere in those planes. In the room as it stands
 * the way from the eye to a wall is exact; turned, rounding makes of the wall what it likes. */
static void shoot_edge_on(const Setting *s, const Transform *turn, uint64_t seed, uint32_t rays,
                          Tally *t)
{
    Rng rng = rng_seed(seed);
    Geometry g;
    Accel *a;
    Mesh m;

    room(&m);
    for (uint32_t i = 0; i < m.nverts; i++)
        m.p[i] = xf_point(turn, m.p[i]);
    geometry_of(&g, &m);
    a = setting_build(s, &g);
    for (uint32_t i = 0; i < rays; i++) {
        float side = rng_between(&rng, 0.1f, 0.9f), up = rng_between(&rng, 0.1f, 0.9f), in = 1.0f;
        uint32_t wall = rng_below(&rng, 2), prim = 4 + 2 * wall + rng_below(&rng, 2);
        int steps = (int)rng_below(&rng, 33) - 16;
        V3 o;
        for (; steps > 0; steps--)
            in = float_after(in);
        for (; steps < 0; steps++)
            in = float_before(in);
        o = xf_point(turn, wall ? v3(in, side, up) : v3(side, in, up));
        shoot(a, o, i % 2 ? g.p[g.tri[prim].v[rng_below(&rng, 3)]] : on_edge_of(&g, prim, &rng),
              rng_below(&rng, 64), 0.0f, t);
    }
    accel_free(a);
    geometry_clear(&g);
}

static void edge_on(void)
{
    for (const Setting *s = settings_usual(); s->kind; s++)
        for (const Where *p = places; p < places + 5; p++) {
            Transform size = xf_scale(p->scale, p->scale, p->scale);
            uint32_t rays = test_is_long() ? 100000 : 2000;
            Tally t = { 0, 0, 0, 0 };
            Rng rng = rng_seed(18);
            shoot_edge_on(s, &size, 0, rays, &t);
            for (uint64_t turns = 1; turns < 20; turns++) {
                V3 axis = rng_direction(&rng);
                Transform turn = xf_rotate(360 * rng_unit(&rng), axis.x, axis.y, axis.z);
                turn = xf_then(&turn, &size);
                shoot_edge_on(s, &turn, turns, rays, &t);
            }
            report(s, "edge-on", p, &t);
        }
}

const TestCase test_rays_closed[] = {
    { "solid", solid, false }, { "waved", waved, false }, { "thin", thin, false },
    { "brute", brute_force, false }, { "outside", outside, false },
    { "close_by", close_by, false }, { "edge_on", edge_on, false }, { "fine", fine, true },
    { NULL, NULL, false }
};

/* test_rays_leave.c -- rays that leave a surface do not meet it again, and those that enter a
 * convex body meet its far side: rays spawned by ray_origin at points that other rays found, or
 * that lights would sample, on fifteen shapes at scales from 1e-4 to 1e8, at the origin and away
 * from it, in instances that are turned and stretched.
 *
 * What must happen is decided apart from the code under test, in double, from the numbers that
 * define the shape: a ray whose origin is not below the plane (or within the sphere) that it leaves
 * and whose direction leads away from it can meet no convex body behind that plane. In an instance
 * that is decided in its own space, after the exact map. Whether the origin got to the right side
 * at all is a thing of its own and counted as `sunk`. */
#include "test/ray_help.h"

#include "geometry/generate.h"
#include "geometry/triangle.h"
#include "integrators/integrator.h"

#include <stdio.h>
#include <string.h>

/* ---- shapes ---- */

typedef struct {
    const char *name;
    void (*make)(Scene *s, const Where *at);
    int  sides;                 /* from which rays may leave without meeting it; 0: both, and it
                                 * is a convex body, so that rays within meet its far side */
} Body;

static const ShapeTraits plain = { 0, NO_LIGHT, false };

static Transform transform_to(const Where *at)
{
    Transform s = xf_scale(at->scale, at->scale, at->scale);
    Transform t = xf_translate(at->offset.x, at->offset.y, at->offset.z);
    return xf_then(&t, &s);
}

static void add_mesh(Scene *s, size_t k, Mesh *m, const Where *at)
{
    mesh_place(m, at->scale, at->offset);
    REQUIRE(geometry_add_mesh(&s->geometries[k], m, plain, NULL), "memory");
}

/* In no special position: planes that lie along the axes are easier. */
static void tilt(Mesh *m)
{
    Transform t = xf_rotate(37, 3, 1, -2);
    for (uint32_t i = 0; i < m->nverts; i++)
        m->p[i] = xf_point(&t, m->p[i]);
}

/* No two facets of these lie in one plane, so that rounding does not bend them inwards. */
static void make_ball(Mesh *m) { REQUIRE(mesh_icosphere(m, 2), "memory"); }
static void make_lens(Mesh *m, float height)
{
    REQUIRE(mesh_uvsphere(m, 11, 2), "memory");
    for (uint32_t i = 0; i < m->nverts; i++)
        m->p[i].z *= height;
    tilt(m);
}

#define MESH(name, call) \
    static void name(Scene *s, const Where *at) \
    { \
        Mesh m; \
        memset(&m, 0, sizeof m); \
        call; \
        add_mesh(s, 0, &m, at); \
    }
MESH(cube, REQUIRE(mesh_cube(&m), "memory"))
MESH(ball, make_ball(&m))
MESH(spindle, make_lens(&m, 2.0f))
MESH(lens, make_lens(&m, 0.05f))
MESH(sheet, REQUIRE(mesh_grid(&m, 8, 8), "memory"))

static void make_triangle(Mesh *m, float width)
{
    mesh_of(m, 3, 1);
    m->p[1] = v3(1.0f, 0.3f, 0.2f);
    m->p[2] = v_mad(v3(-0.3f, 1.0f, 0.7f), width, v3(0.0f, 0.0f, 0.0f));
    m->tri[0] = (Tri){ { 0, 1, 2 } };
}
MESH(triangle, make_triangle(&m, 1.0f))
MESH(sliver, make_triangle(&m, 1e-3f))
MESH(needle, make_triangle(&m, 1e-5f))

static void sphere_of(Scene *s, size_t k, const Where *at, float zmin, float phimax)
{
    Transform t = transform_to(at);
    Sphere sp;
    REQUIRE(sphere_init(&sp, &t, 1.0f, zmin, 1.0f, phimax) &&
            geometry_add_sphere(&s->geometries[k], &sp, plain, NULL), "memory");
}
static void sphere(Scene *s, const Where *at) { sphere_of(s, 0, at, -1.0f, 360.0f); }
static void cap(Scene *s, const Where *at) { sphere_of(s, 0, at, 0.3f, 250.0f); }

static void disk_of(Scene *s, const Where *at, float inner, float phimax)
{
    Transform t = transform_to(at), turn = xf_rotate(50, 1, 2, 3);
    Disk d;
    t = xf_then(&t, &turn);
    REQUIRE(disk_init(&d, &t, 0.25f, 1.0f, inner, phimax) &&
            geometry_add_disk(&s->geometries[0], &d, plain, NULL), "memory");
}
static void disc(Scene *s, const Where *at) { disk_of(s, at, 0.0f, 360.0f); }
static void ring(Scene *s, const Where *at) { disk_of(s, at, 0.4f, 280.0f); }

/* An instance of geometry 1, turned, stretched by 1 : 3 `by`, turned again and put there. */
static void add_instance(Scene *s, const Where *at, double by)
{
    Transform t = transform_to(at), turn = xf_rotate(70, -1, 2, 1);
    Transform stretch = xf_scale(1, 3, 1 / by);
    t = xf_then(&t, &turn);
    t = xf_then(&t, &stretch);
    turn = xf_rotate(25, 1, 1, 5);
    t = xf_then(&t, &turn);
    REQUIRE(geometry_add_instance(&s->geometries[0], 1, &t, NULL), "memory");
}

static const Where here = { 1, { 0, 0, 0 } }, aside = { 1, { 10, -20, 30 } };

static void ball_instance(Scene *s, const Where *at)
{
    Mesh m;
    memset(&m, 0, sizeof m);
    make_ball(&m);
    add_mesh(s, 1, &m, &here);
    add_instance(s, at, 5);
}

static void sphere_instance(Scene *s, const Where *at)
{
    sphere_of(s, 1, &here, -1.0f, 360.0f);
    add_instance(s, at, 5);
}

/* The object is far from the origin of its own space, and becomes as flat as a coin. */
static void cube_instance(Scene *s, const Where *at)
{
    Mesh m;
    memset(&m, 0, sizeof m);
    REQUIRE(mesh_cube(&m), "memory");
    add_mesh(s, 1, &m, &aside);
    add_instance(s, at, 50);
}

enum { MESHES = 4, PIECES = 8, ROUND = 12, BODIES = 15 };
static const Body bodies[BODIES] = {
    { "cube", cube, 0 }, { "ball", ball, 0 }, { "spindle", spindle, 0 }, { "lens", lens, 0 },
    { "triangle", triangle, 2 }, { "sliver", sliver, 2 }, { "needle", needle, 2 },
    { "sheet", sheet, 2 }, { "sphere", sphere, 0 }, { "cap", cap, 1 }, { "disc", disc, 2 },
    { "ring", ring, 2 }, { "instance of a ball", ball_instance, 0 },
    { "instance of a sphere", sphere_instance, 0 }, { "instance of a cube", cube_instance, 0 }
};

/* ---- the truth, in double ---- */

static D3 mapped(const Affine *a, D3 p, double w)
{
    const float (*m)[4] = a->m;
    return (D3){ m[0][0] * p.x + m[0][1] * p.y + m[0][2] * p.z + w * m[0][3],
                 m[1][0] * p.x + m[1][1] * p.y + m[1][2] * p.z + w * m[1][3],
                 m[2][0] * p.x + m[2][1] * p.y + m[2][2] * p.z + w * m[2][3] };
}

/* What a primitive makes of a point and a direction: height over its front (negative: behind) and
 * the cosine to it, each times some positive number. */
typedef struct { double height, along; } Stand;

static Stand stand_on(const Geometry *g, uint32_t prim, D3 o, D3 w)
{
    const Shape *s = geometry_shape(g, prim);
    D3 q, n;

    if (geometry_is_tri(g, prim)) {
        V3 c[3];
        geometry_corners(g, prim, c);
        n = d3_cross(d3_sub(d3(c[1]), d3(c[0])), d3_sub(d3(c[2]), d3(c[0])));
        q = d3_sub(o, d3(c[0]));
    } else if (s->kind == SHAPE_DISK) {
        n = d3(s->as.disk.frame.n);
        q = d3_sub(o, d3(s->as.disk.centre));
    } else {
        double r = s->as.sphere.radius;
        q = d3_sub(o, d3(s->as.sphere.centre));
        return (Stand){ d3_dot(q, q) - r * r, d3_dot(q, w) };
    }
    return (Stand){ d3_dot(n, q), d3_dot(n, w) };
}

/* The space that a hit is in: its geometry, and o and w there. */
static const Geometry *space_of(const Scene *s, const Hit *h, D3 *o, D3 *w)
{
    const Geometry *g = &s->geometries[0];
    const Shape *top = geometry_shape(g, h->outer);
    if (top->kind != SHAPE_INSTANCE)
        return g;
    *o = mapped(&top->as.instance->to_object, *o, 1);
    *w = mapped(&top->as.instance->to_object, *w, 0);
    return &s->geometries[top->as.instance->child];
}

static Stand stand_at(const Scene *s, const Hit *h, V3 o, V3 w)
{
    D3 p = d3(o), d = d3(w);
    const Geometry *g = space_of(s, h, &p, &d);
    return stand_on(g, h->prim, p, d);
}

/* |a| e: what errors of the coordinates become. */
static D3 spread(const Affine *a, D3 e)
{
    const float (*m)[4] = a->m;
    return (D3){ fabs(m[0][0]) * e.x + fabs(m[0][1]) * e.y + fabs(m[0][2]) * e.z,
                 fabs(m[1][0]) * e.x + fabs(m[1][1]) * e.y + fabs(m[1][2]) * e.z,
                 fabs(m[2][0]) * e.x + fabs(m[2][1]) * e.y + fabs(m[2][2]) * e.z };
}

/* Whether o is behind every face of the body. A point that is nearer to another face than its error
 * might as well be on that; then nothing is promised of it. */
static bool inside(const Scene *s, const Hit *h, D3 o, V3 err)
{
    const Shape *top = geometry_shape(&s->geometries[0], h->outer);
    D3 e = d3(err), none = { 0, 0, 0 };
    const Geometry *g = space_of(s, h, &o, &none);

    if (top->kind == SHAPE_INSTANCE)
        e = spread(&top->as.instance->to_object, e);
    for (uint32_t i = 0; i < geometry_prims(g); i++) {
        double least = 0;
        if (i != h->prim) {                     /* along is linear in the direction */
            D3 x = { 1, 0, 0 }, y = { 0, 1, 0 }, z = { 0, 0, 1 };
            D3 n = { stand_on(g, i, o, x).along, stand_on(g, i, o, y).along,
                     stand_on(g, i, o, z).along };
            least = d3_reach(n, e);
        }
        if (!(stand_on(g, i, o, none).height < -least))
            return false;
    }
    return true;
}

/* Rounding of the vertices may have bent a body: then what was said above does not hold for it. */
static bool is_convex(const Geometry *g)
{
    D3 none = { 0, 0, 0 };
    for (uint32_t i = 0; i < g->ntris; i++)
        for (uint32_t k = 0; k < g->nverts; k++) {
            const uint32_t *v = g->tri[i].v;
            if (k != v[0] && k != v[1] && k != v[2] &&
                stand_on(g, i, d3(g->p[k]), none).height > 0)
                return false;
        }
    return true;
}

/* ---- spawning ---- */

typedef struct {
    uint64_t rays, self, sunk, outside, entered, leaks, far, doors, shadows, blocked;
} Count;

/* A point of the surface: met by some ray, or chosen by weights as a light does, corners and edges
 * among them. */
static bool find_point(const Scene *s, RayMaker *m, Hit *h, Surface *sf)
{
    static const RayClass how[6] = { RAY_RANDOM, RAY_TO_VERTEX, RAY_TO_EDGE, RAY_TO_CENTRE,
                                     RAY_INSIDE, RAY_AXIS };
    Ray r = ray_make(m, how[rng_below(&m->rng, 6)]);
    const Geometry *g = &s->geometries[0];

    if (g->ntris && rng_below(&m->rng, 3) == 0) {
        V3 b = rng_barycentric(&m->rng);
        h->outer = h->prim = rng_below(&m->rng, (uint32_t)g->ntris);
        h->t = 0.0f;
        h->u = rng_below(&m->rng, 4) ? b.y : (float)rng_below(&m->rng, 2) * 1e-8f;
        h->v = rng_below(&m->rng, 4) ? b.z : 1.0f - h->u;
        if (h->u + h->v > 1.0f)
            h->v = 1.0f - h->u;
    } else if (!accel_nearest(s->accel, &r, h))
        return false;
    accel_surface(s->accel, &r, h, sf);
    return true;
}

/* A direction above n, at any height down to 1e-9 of the horizon. */
static V3 leave_towards(RayMaker *m, V3 n)
{
    V3 w = rng_direction(&m->rng);
    if (rng_below(&m->rng, 2)) {
        float up = (float)md_pow(10.0, -9.0 * rng_unit(&m->rng));
        w = v_unit(v_mad(n, up - v_dot(w, n), w));
    }
    return v_dot(w, n) < 0.0f ? v_neg(w) : w;
}

static void print_spawn(const char *what, const Ray *r, const Hit *from, const Hit *to)
{
    printf("%s: %s from %lu.%lu to %lu.%lu at t %a\n", what, ray_text(r),
           (unsigned long)from->outer, (unsigned long)from->prim, (unsigned long)to->outer,
           (unsigned long)to->prim, (double)to->t);
}

/* The ray that leaves towards w, on the side where n is up. */
static void check_outward(const Scene *s, const Hit *h, const Surface *sf, V3 w, double side,
                          Count *t)
{
    Ray r = { .o = ray_origin(sf->p, sf->err, sf->ng, w), .d = w, .tmax = INFINITY };
    Stand st = stand_at(s, h, r.o, w);
    Hit again;

    if (!(side * st.along > 0))
        return;                                 /* it leads in, by the rounding of the normal */
    t->rays++;
    if (side * st.height < 0) {
        if (!t->sunk++)
            print_spawn("sunk", &r, h, h);
    } else if (accel_nearest(s->accel, &r, &again)) {
        if (!t->self++)
            print_spawn("met itself", &r, h, &again);
    } else if (accel_blocked(s->accel, &r))
        t->self++;
}

/* The ray that enters towards w must meet the far side, and from there go on to nothing. */
static void check_inward(const Scene *s, const Hit *h, const Surface *sf, V3 w, Count *t)
{
    Ray r = { .o = ray_origin(sf->p, sf->err, sf->ng, w), .d = w, .tmax = INFINITY };
    Surface far;
    Hit hit;

    if (!(stand_at(s, h, r.o, w).along < 0))
        return;
    if (!inside(s, h, d3(r.o), sf->err)) {
        t->outside++;
        return;
    }
    t->entered++;
    if (!accel_nearest(s->accel, &r, &hit)) {
        if (!t->leaks++)
            print_spawn("leaked", &r, h, h);
        return;
    }
    if (stand_at(s, &hit, r.o, w).along <= 0 && geometry_shape(s->accel->geo, hit.outer)->kind
        != SHAPE_SPHERE && !s->geometries[1].nodd)
        t->far++;                               /* a face that it leads away from */
    accel_surface(s->accel, &r, &hit, &far);
    if (v_dot(far.ng, w) > 0.0f)
        check_outward(s, &hit, &far, w, 1.0, t);
}

/* Two points of the surface see each other through the body, if both ends of the ray are in it. */
static void check_through(const Scene *s, const Hit *ha, const Surface *a, const Hit *hb,
                          const Surface *b, Count *t)
{
    LightSample to = { .p = b->p, .err = b->err, .n = b->ng };
    Tracer tracer = { .scene = s };
    V3 way = v_sub(b->p, a->p);
    D3 end;
    Ray r, shadow;

    to.dist = v_len(way);
    to.wi = v_unit(way);
    if (!(v_dot(to.wi, a->ng) < 0.0f && v_dot(to.wi, b->ng) > 0.0f))
        return;
    r = ray_between(a->p, a->err, a->ng, b->p, b->err, b->ng, to.wi);
    end = (D3){ (double)r.o.x + r.d.x, (double)r.o.y + r.d.y, (double)r.o.z + r.d.z };
    if (!inside(s, ha, d3(r.o), a->err) || !inside(s, hb, end, b->err))
        return;
    t->shadows++;
    shadow = shadow_ray(a, &to);
    if (tracer_blocked(&tracer, &shadow) && !t->blocked++)
        printf("blocked: %s, %lu to %lu\n", ray_text(&r), (unsigned long)ha->prim,
               (unsigned long)hb->prim);
}

static void spawn(const Scene *s, const Body *b, RayMaker *m, uint32_t points, Count *t)
{
    Surface sf, last = { .width = 0 };
    Hit h, last_h;
    bool have_last = false;

    while (points--) {
        double side = b->sides < 2 || rng_below(&m->rng, 2) ? 1.0 : -1.0;
        V3 w;
        if (!find_point(s, m, &h, &sf))
            continue;
        w = leave_towards(m, side > 0 ? sf.ng : v_neg(sf.ng));
        if (side * v_dot(w, sf.ng) > 0.0f)
            check_outward(s, &h, &sf, w, side, t);
        if (b->sides)
            continue;
        if (v_dot(w, sf.ng) > 0.0f)
            check_inward(s, &h, &sf, v_neg(w), t);
        if (have_last)
            check_through(s, &last_h, &last, &h, &sf, t);
        last = sf;
        last_h = h;
        have_last = true;
    }
}

static Scene *scene_of(const Body *b, const Where *at)
{
    const AccelKind *kind = kind_find(accels, ACCEL_DEFAULT);
    Scene *s = scene_new();
    Opts o;

    opts_default(&o, kind->info.options);
    REQUIRE(s && scene_add_geometry(s, NULL), "memory");
    b->make(s, at);
    REQUIRE(scene_build(s, kind, &o, 1), "memory");
    return s;
}

static void add_tally(Count *sum, const Count *t)
{
    uint64_t *a = (uint64_t *)sum;
    const uint64_t *b = (const uint64_t *)t;
    for (size_t i = 0; i < sizeof *t / sizeof *a; i++)
        a[i] += b[i];
}

static void leave(const Body *b, const Where *at, uint32_t points, Count *sum)
{
    Scene *s = scene_of(b, at);
    Count t;

    memset(&t, 0, sizeof t);
    if (b->sides || (is_convex(&s->geometries[0]) && is_convex(&s->geometries[1]))) {
        RayMaker m = ray_maker(&s->geometries[0], s->accel, 23);
        spawn(s, b, &m, points * (test_is_long() ? 10 : 1), &t);
        EXPECT(!t.self && !t.sunk && !t.leaks && !t.far && !t.blocked,
               "%s times %g at (%g %g %g): of %lu rays %lu met it again, %lu were sunk; of %lu "
               "inward ones %lu leaked and %lu met a near face; of %lu across %lu were blocked",
               b->name, at->scale, (double)at->offset.x, (double)at->offset.y,
               (double)at->offset.z, (unsigned long)t.rays, (unsigned long)t.self,
               (unsigned long)t.sunk, (unsigned long)t.entered, (unsigned long)t.leaks,
               (unsigned long)t.far, (unsigned long)t.shadows, (unsigned long)t.blocked);
    } else
        printf("%s times %g is not convex\n", b->name, at->scale);
    add_tally(sum, &t);
    scene_free(s);
}

static void leave_all(size_t first, size_t end)
{
    static const double scale[7] = { 1e-4, 1e-2, 1, 1e2, 1e4, 1e6, 1e8 };
    static const V3 away[3] = { { 0, 0, 0 }, { 1, -2, 3 }, { 300, -200, 100 } };
    static const Where embree = { 1, { 148376, 1234, -223423 } };

    for (const Body *b = bodies + first; b < bodies + end; b++) {
        Count sum;
        memset(&sum, 0, sizeof sum);
        for (int i = 0; i < 7; i++)
            for (int k = 0; k < 3; k++) {
                Where at = { scale[i], v_scale(away[k], (float)scale[i]) };
                leave(b, &at, 4000, &sum);
            }
        leave(b, &embree, 4000, &sum);
        printf("%s: out %lu, self %lu, sunk %lu; in %lu (%lu at edges), leaks %lu, near %lu; "
               "across %lu, blocked %lu\n", b->name, (unsigned long)sum.rays,
               (unsigned long)sum.self, (unsigned long)sum.sunk, (unsigned long)sum.entered,
               (unsigned long)sum.outside, (unsigned long)sum.leaks, (unsigned long)sum.far,
               (unsigned long)sum.shadows, (unsigned long)sum.blocked);
    }
}

static void meshes(void) { leave_all(0, MESHES); }
static void pieces(void) { leave_all(MESHES, PIECES); }
static void round_ones(void) { leave_all(PIECES, ROUND); }
static void instances(void) { leave_all(ROUND, BODIES); }

/* ---- triangles side by side ---- */

/* Eight triangles about the origin; the ray begins about a point of one, far off it or so near that
 * only roundings tell on which side. */
static Ray ray_about(const Geometry *g, float scale, Rng *rng)
{
    V3 c[3], at, d = v_unit(v3(rng_unit(rng) - 0.5f, rng_unit(rng) - 0.5f, rng_unit(rng) - 0.5f));
    float u = rng_unit(rng), v = (1 - u) * rng_unit(rng), off;

    geometry_corners(g, rng_below(rng, 8), c);
    at = v_add(v_scale(c[0], 1 - u - v), v_add(v_scale(c[1], u), v_scale(c[2], v)));
    off = (rng_unit(rng) - 0.5f) * scale * (float)ldexp(1, -(int)rng_below(rng, 30));
    if (rng_below(rng, 4) == 0)
        d.z = 0;
    return (Ray){ .o = v_mad(d, off, at), .d = d, .tmax = INFINITY };
}

/* What the test of lanes passes over, triangle_nearest does not meet. Returns how many of those
 * that the ray's line meets behind its origin the lanes pass over. */
static int check_lanes(const Geometry *g, const Ray *r, bool always)
{
    static const uint32_t prims[8] = { 0, 1, 2, 3, 4, 5, 6, 7 };
    const Ray back = { .o = r->o, .d = v_neg(r->d), .tmax = INFINITY };
    TriangleBlock block;
    BlockView view;
    Probe p, q;
    Hit four;
    int bits, behind = 0;

    probe_init(&p, r);
    probe_init(&q, &back);
    triangle_block_fetch(&block, g, prims, 8);
    bits = triangle_block_test(&block, 8, &p, always, &view);
    for (uint32_t k = 0; k < 8; k++) {
        const uint32_t alone[4] = { k, 7 - k, 7 - k, 7 - k };
        Hit one;
        hit_none(&one, r->tmax);
        hit_none(&four, r->tmax);
        triangle_nearest(g, k, &p, &one);
        triangle_four_nearest(g, alone, 1, &p, always, &four);
        EXPECT(one.outer == four.outer && one.t == four.t, "a lane of four finds t = %g, not %g",
               (double)four.t, (double)one.t);
        EXPECT(one.outer == NO_PRIM || bits >> k & 1, "t = %g is passed over", (double)one.t);
        hit_none(&one, r->tmax);
        behind += !(bits >> k & 1) && triangle_nearest(g, k, &q, &one);
    }
    return behind;
}

static void lanes(void)
{
    static const float SCALES[] = { 1, 1e-3f, 1e4f, 1e-12f, 1e12f, 1e-20f, 1e18f, 1e-37f, 1e37f };
    Rng rng = rng_seed(5);
    int behind[2] = { 0, 0 };

    for (int i = 0; i < 900; i++) {
        float scale = SCALES[i % 9];
        Geometry g;
        Mesh m;
        REQUIRE(mesh_soup(&m, 12, 1, (uint64_t)i), "memory");
        mesh_place(&m, scale, v3(0, 0, 0));
        geometry_of(&g, &m);
        for (int k = 0; k < 60; k++) {
            Ray r = ray_about(&g, scale, &rng);
            behind[k & 1] += check_lanes(&g, &r, k & 1);
        }
        geometry_clear(&g);
    }
    for (int k = 0; k < 2; k++)
        EXPECT(behind[k] > 5000, "only %d triangles behind the origin are passed over", behind[k]);
}

const TestCase test_rays_leave[] = {
    { "meshes", meshes, false }, { "pieces", pieces, false }, { "round", round_ones, false },
    { "instances", instances, false }, { "lanes", lanes, false },
    { NULL, NULL, false }
};

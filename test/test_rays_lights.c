/* test_rays_lights.c -- a point sampled on a light is seen from where it was sampled for, if there
 * is nothing else in the world: the light does not stand in its own light. From near and far, from
 * straight ahead and from the light's horizon, for lights at the origin (where their own points are
 * exact and the way to them is not) and far from it (the other way round). */
#include "test/ray_help.h"

#include "integrators/integrator.h"

#include <stdio.h>
#include <string.h>

typedef struct {
    const char *name;
    void (*add)(Geometry *g, double size, V3 centre, uint32_t *shape);
    bool two_sided;             /* not the closed ones: they would hide their own back */
} Shining;

static const ShapeTraits plain = { 0, NO_LIGHT, false };

static void add_mesh(Geometry *g, Mesh *m, double size, V3 centre, uint32_t *shape)
{
    mesh_place(m, size, centre);
    REQUIRE(geometry_add_mesh(g, m, plain, shape), "memory");
}

/* A square about the origin, facing +z, or turned. */
static void make_square(Mesh *m, double degrees)
{
    Transform t = xf_rotate(degrees, 3, 1, -2), move = xf_translate(-0.5, -0.5, 0);
    REQUIRE(mesh_grid(m, 1, 1), "memory");
    t = xf_then(&t, &move);
    for (uint32_t i = 0; i < m->nverts; i++)
        m->p[i] = xf_point(&t, m->p[i]);
}

static void square(Geometry *g, double size, V3 centre, uint32_t *shape)
{
    Mesh m = { 0 };
    make_square(&m, 0);
    add_mesh(g, &m, size, centre, shape);
}

static void turned_square(Geometry *g, double size, V3 centre, uint32_t *shape)
{
    Mesh m = { 0 };
    make_square(&m, 37);
    add_mesh(g, &m, size, centre, shape);
}

static void lamp(Geometry *g, double size, V3 centre, uint32_t *shape)
{
    Mesh m = { 0 };
    REQUIRE(mesh_icosphere(&m, 2), "memory");
    add_mesh(g, &m, size, centre, shape);
}

static Transform map_to(double size, V3 centre)
{
    Transform s = xf_scale(size, size, size), t = xf_translate(centre.x, centre.y, centre.z);
    return xf_then(&t, &s);
}

static void sphere(Geometry *g, double size, V3 centre, uint32_t *shape)
{
    Transform t = map_to(size, centre);
    Sphere s;
    REQUIRE(sphere_init(&s, &t, 1, -1, 1, 360) && geometry_add_sphere(g, &s, plain, shape),
            "memory");
}

static void disk_at(Geometry *g, double size, V3 centre, float inner, uint32_t *shape)
{
    Transform t = map_to(size, centre), turn = xf_rotate(61, 1, -2, 1);
    Disk d;
    t = xf_then(&t, &turn);
    REQUIRE(disk_init(&d, &t, 0, 1, inner, 360) && geometry_add_disk(g, &d, plain, shape),
            "memory");
}
static void disc(Geometry *g, double size, V3 centre, uint32_t *shape)
{
    disk_at(g, size, centre, 0, shape);
}
static void ring(Geometry *g, double size, V3 centre, uint32_t *shape)
{
    disk_at(g, size, centre, 0.5f, shape);
}

static const Shining shining[] = {
    { "square", square, true }, { "turned square", turned_square, true }, { "lamp", lamp, false },
    { "sphere", sphere, false }, { "disc", disc, true }, { "ring", ring, true },
    { NULL, NULL, false }
};

static Light *make_light(Scene *s, uint32_t shape, bool two_sided)
{
    const LightKind *kind = kind_find(lights, "diffuse");
    Making m;
    Light *l;
    Opts o;

    memset(&m, 0, sizeof m);
    m.scene = s;
    m.shape = shape;
    opts_default(&o, kind->info.options);
    opt_set_number(&o, "twosided", two_sided);
    l = kind->make(&m, &o);
    REQUIRE(l, "memory");
    l->kind = kind;
    REQUIRE(scene_add_light(s, l, &s->geometries[0].shapes[shape].light), "memory");
    return l;
}

/* A place `far` from the light's centre, often near the plane of one of its parts, with a surface
 * that the light is above. */
static Surface receiver(const Geometry *g, Rng *rng, V3 centre, float far)
{
    V3 way = rng_direction(rng);
    Surface s;

    memset(&s, 0, sizeof s);
    if (g->ntris && rng_below(rng, 2)) {        /* low over a facet */
        float up = (float)md_pow(10.0, -5.0 * rng_unit(rng));
        V3 c[3], n;
        geometry_corners(g, rng_below(rng, (uint32_t)g->ntris), c);
        n = v_unit(v_cross(v_sub(c[1], c[0]), v_sub(c[2], c[0])));
        way = v_unit(v_mad(n, up - v_dot(way, n), way));
    }
    s.p = v_mad(way, far, centre);
    s.err = v_scale(v_abs(s.p), ROUNDINGS(7));
    s.ng = rng_direction(rng);
    if (v_dot(s.ng, way) > 0.0f)
        s.ng = v_neg(s.ng);
    return s;
}

static double height(V3 o, const LightSample *to)
{
    return ((double)o.x - to->p.x) * to->n.x + ((double)o.y - to->p.y) * to->n.y +
           ((double)o.z - to->p.z) * to->n.z;
}

/* Whether the receiver is so near to the plane in which the sample lies that the roundings of the
 * way, 16 of each coordinate, or the move off its own surface could put it on the other side: then
 * there is no saying. */
static bool in_plane(const Surface *from, const LightSample *to)
{
    V3 o = ray_origin(from->p, from->err, from->ng, to->wi), way = v_sub(to->p, o);
    double least = ROUNDINGS(16) * v_dot(v_abs(way), v_abs(to->n)), h = height(from->p, to);
    return h > 0 ? height(o, to) < least : height(o, to) > -least;
}

typedef struct { uint64_t seen, unseen, unsure; } Count;

static void look(const Scene *s, const Light *l, V3 centre, float far, uint32_t n, Count *count)
{
    Tracer tracer = { .scene = s };
    Rng rng = rng_seed(31);
    LightSample ls;

    while (n--) {
        Surface from = receiver(&s->geometries[0], &rng, centre, far);
        Ray shadow;
        V2 u;
        u.x = rng_unit(&rng);
        u.y = rng_unit(&rng);
        if (!l->kind->sample(l, from.p, u, &ls) || !(v_dot(ls.wi, from.ng) > 0.0f))
            continue;
        shadow = shadow_ray(&from, &ls);
        if (!tracer_blocked(&tracer, &shadow))
            count->seen++;
        else if (in_plane(&from, &ls))
            count->unsure++;
        else if (!count->unseen++)
            printf("from (%a %a %a) to (%a %a %a), normal (%a %a %a)\n", (double)from.p.x,
                   (double)from.p.y, (double)from.p.z, (double)ls.p.x, (double)ls.p.y,
                   (double)ls.p.z, (double)ls.n.x, (double)ls.n.y, (double)ls.n.z);
    }
}

static void look_at(const Shining *what, double size, V3 centre, Count *sum)
{
    static const float far[6] = { 1.2f, 2.0f, 10.0f, 100.0f, 1e3f, 1e5f };
    const AccelKind *kind = kind_find(accels, ACCEL_DEFAULT);
    Scene *s = scene_new();
    uint32_t shape;
    Light *l;
    Opts o;

    opts_default(&o, kind->info.options);
    REQUIRE(s, "memory");
    what->add(&s->geometries[0], size, centre, &shape);
    l = make_light(s, shape, what->two_sided);
    REQUIRE(scene_build(s, kind, &o, 1), "memory");
    for (int i = 0; i < 6; i++) {
        Count c = { 0, 0, 0 };
        if (ROUNDINGS(100) * v_max3(v_abs(centre)) > 0.1 * size)
            continue;                           /* the receiver's error would reach the light */
        look(s, l, centre, far[i] * (float)size, test_is_long() ? 40000 : 4000, &c);
        EXPECT(!c.unseen, "%s of size %g at (%g %g %g), %g away: %lu of %lu samples unseen",
               what->name, size, (double)centre.x, (double)centre.y, (double)centre.z,
               (double)far[i] * size, (unsigned long)c.unseen,
               (unsigned long)(c.seen + c.unseen));
        sum->seen += c.seen;
        sum->unseen += c.unseen;
        sum->unsure += c.unsure;
    }
    scene_free(s);
}

static void lights_seen(void)
{
    static const V3 centre[3] = { { 0, 0, 0 }, { 10, -20, 30 }, { 1000, 3000, -2000 } };

    for (const Shining *what = shining; what->name; what++) {
        Count sum = { 0, 0, 0 };
        for (int i = 0; i < 3; i++)
            for (double size = 1e-2; size < 1e3; size *= 100)
                look_at(what, size, centre[i], &sum);
        printf("%s: %lu seen, %lu unseen, %lu in the plane\n", what->name, (unsigned long)sum.seen,
               (unsigned long)sum.unseen, (unsigned long)sum.unsure);
    }
}

const TestCase test_rays_lights[] = {
    { "seen", lights_seen, false },
    { NULL, NULL, false }
};

/* test_geometry_round.c -- spheres and discs, whole and cut: where rays cross them, the errors of
 * the points that shading gets, texture coordinates, normals, boxes. Against formulas in double. */
#include "test/ray_help.h"

#include <string.h>

/* As if it had been written with so many digits after the point, as scene files are. */
static Transform written(const Transform *t, double digits)
{
    Transform r;
    double m[4][4];

    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            m[i][j] = floor(t->m[i][j] * digits + 0.5) / digits;
    REQUIRE(xf_from(&r, m), "a matrix near a rotation has an inverse");
    return r;
}

static Transform place(Rng *rng, const Where *at, bool rough)
{
    V3 axis = rng_direction(rng);
    Transform r = xf_rotate(360.0 * rng_unit(rng), axis.x, axis.y, axis.z);
    Transform s = xf_scale(at->scale, at->scale, rng_below(rng, 2) ? at->scale : -at->scale);
    Transform t = xf_translate(at->offset.x, at->offset.y, at->offset.z);

    if (rough)
        r = written(&r, 1e6);
    s = xf_then(&r, &s);
    return xf_then(&t, &s);
}

/* From up to ten radii away, so that the ray's own error counts as well. */
static Ray towards(Rng *rng, V3 centre, float radius)
{
    V3 o = v_mad(rng_direction(rng), radius * rng_between(rng, 0.0f, 10.0f), centre);
    V3 at = v_mad(rng_direction(rng), radius * 0.9f * rng_unit(rng), centre);
    return (Ray){ .o = o, .d = v_unit(v_sub(at, o)), .tmax = INFINITY };
}

static bool surface_of(Geometry *g, const Ray *r, float t, Surface *s)
{
    Hit h = { t, 0, 0, 0, 0 };
    if (t > 0.0f)
        geometry_surface(g, r, &h, s);
    return t > 0.0f;
}

static void sphere_errors(void)
{
    Rng rng = rng_seed(53);
    uint64_t bad = 0, hits = 0;

    for (uint32_t i = 0; i < 100000; i++) {
        const Where *at = &places_sane[i % PLACES_SANE];
        Transform t = place(&rng, at, i % 3 == 0);
        uint32_t odd = 0;
        Shape shape = { .kind = SHAPE_SPHERE };
        Geometry g;
        Surface sf;
        Sphere *s = &shape.as.sphere;
        Ray r;
        D3 q;
        double d;

        if (!sphere_init(s, &t, 1, -0.7f, 1, i % 2 ? 360 : 300))
            continue;                           /* written too roughly */
        memset(&g, 0, sizeof g);
        g.shapes = &shape;
        g.odd = &odd;
        g.nodd = g.nshapes = 1;
        r = towards(&rng, s->centre, s->radius);
        if (!surface_of(&g, &r, sphere_cross(s, &r), &sf))
            continue;
        q = d3_sub(d3(sf.p), d3(s->centre));
        d = sqrt(d3_dot(q, q));
        q = (D3){ q.x / d, q.y / d, q.z / d };
        hits++;
        bad += !(fabs(d - s->radius) <= d3_reach(q, d3(sf.err)));
    }
    EXPECT(!bad && hits > 50000, "of %lu points %lu are farther from the sphere",
           (unsigned long)hits, (unsigned long)bad);
}

static void disk_errors(void)
{
    Rng rng = rng_seed(54);
    uint64_t bad = 0, hits = 0;

    for (uint32_t i = 0; i < 100000; i++) {
        const Where *at = &places_sane[i % PLACES_SANE];
        Transform t = place(&rng, at, i % 3 == 0);
        uint32_t odd = 0;
        Shape shape = { .kind = SHAPE_DISK };
        Geometry g;
        Surface sf;
        Disk *k = &shape.as.disk;
        Ray r;
        D3 n;

        if (!disk_init(k, &t, 0.3f, 1, 0, 360))
            continue;
        memset(&g, 0, sizeof g);
        g.shapes = &shape;
        g.odd = &odd;
        g.nodd = g.nshapes = 1;
        r = towards(&rng, k->centre, k->radius);
        if (!surface_of(&g, &r, disk_cross(k, &r), &sf))
            continue;
        n = d3(k->frame.n);
        hits++;
        bad += !(fabs(d3_dot(n, d3_sub(d3(sf.p), d3(k->centre)))) <= d3_reach(n, d3(sf.err)));
    }
    EXPECT(!bad && hits > 30000, "of %lu points %lu are farther from the disc",
           (unsigned long)hits, (unsigned long)bad);
}

/* ---- crossings, texture coordinates, boxes ---- */

/* A part of a sphere or disc in a frame of its own; phi and z of a point of it, in double. */
static void polar(const Frame *f, V3 centre, D3 p, double *phi, double *z)
{
    D3 q = d3_sub(p, d3(centre));
    double x = d3_dot(q, d3(f->s)), y = d3_dot(q, d3(f->t));
    *phi = md_atan2(y, x);
    *phi += *phi < 0 ? 2 * PI : 0;
    *z = d3_dot(q, d3(f->n));
}

static D3 along(const Ray *r, double t)
{
    return (D3){ r->o.x + t * r->d.x, r->o.y + t * r->d.y, r->o.z + t * r->d.z };
}

/* The first crossing by the textbook's quadratic, 0 if none. *sure: not so near to the rim, or to a
 * cut, that rounding decides: 1e-5 radii is far beyond what the float frame errs. */
static double first_crossing(const Sphere *s, const Ray *r, bool *sure)
{
    D3 q = d3_sub(d3(r->o), d3(s->centre)), d = d3(r->d);
    double rad = s->radius, a = d3_dot(d, d), b = d3_dot(q, d), c = d3_dot(q, q) - rad * rad;
    double disc = b * b - a * c, near = 1e-5 * rad;

    *sure = fabs(disc) > 1e-4 * rad * rad * a && fabs(c) > near * rad;
    if (disc < 0)
        return 0;
    for (int side = -1; side <= 1; side += 2) {
        double t = (-b + side * sqrt(disc)) / a, phi, z;
        polar(&s->frame, s->centre, along(r, t), &phi, &z);
        *sure = *sure && (s->whole || (fabs(z - s->zmin) > near && fabs(z - s->zmax) > near &&
                                       fabs(phi - s->phimax) > 1e-4 && phi > 1e-4 &&
                                       2 * PI - phi > 1e-4));
        if (t > 0 && (s->whole || (z >= s->zmin && z <= s->zmax && phi <= s->phimax)))
            return t;
    }
    return 0;
}

/* t is that of the formula to its one rounding and what double makes of a discriminant that is 1e-4
 * of its terms, at most; the box holds the point. */
static void sphere_crossings(void)
{
    Rng rng = rng_seed(55);
    uint64_t tried = 0, hits = 0;

    for (uint32_t i = 0; i < 100000; i++) {
        Where at = { 1, v_scale(rng_direction(&rng), 10.0f) };
        Transform t = place(&rng, &at, false);
        double truth, phi, z;
        bool sure;
        Sphere s;
        float got;
        Ray r;
        Box box;

        REQUIRE(sphere_init(&s, &t, 2, i % 2 ? -1.2f : -2, i % 3 ? 1.5f : 2, i % 5 ? 360 : 200),
                "a similarity");
        r = towards(&rng, s.centre, s.radius);
        r.d = v_scale(r.d, i % 4 ? 1.0f : 1e-3f);
        truth = first_crossing(&s, &r, &sure);
        if (!sure)
            continue;
        tried++;
        got = sphere_cross(&s, &r);
        EXPECT((truth > 0) == (got > 0.0f) && fabs(got - truth) <= ROUNDINGS(2) * truth,
               "t %.9g and not %.9g for %s", (double)got, truth, ray_text(&r));
        if (!(truth > 0))
            continue;
        hits++;
        box = sphere_box(&s);
        polar(&s.frame, s.centre, along(&r, truth), &phi, &z);
        truth = along(&r, truth).x;
        EXPECT(truth >= box.lo.x && truth <= box.hi.x, "the box does not hold the point");
    }
    EXPECT(tried > 80000 && hits > 40000, "%lu tried, %lu hit", (unsigned long)tried,
           (unsigned long)hits);
}

static void disk_crossings(void)
{
    Rng rng = rng_seed(56);
    uint64_t tried = 0, hits = 0;

    for (uint32_t i = 0; i < 100000; i++) {
        Where at = { 1, v_scale(rng_direction(&rng), 10.0f) };
        Transform t = place(&rng, &at, false);
        double truth, phi, z, rad;
        float got, inner = i % 2 ? 0.0f : 0.5f;
        bool inside, sure;
        Disk k;
        Box box;
        Ray r;
        D3 p, q;

        REQUIRE(disk_init(&k, &t, 0.5f, 2, inner, i % 3 ? 360 : 100), "a similarity");
        r = towards(&rng, k.centre, k.radius);
        q = d3_sub(d3(r.o), d3(k.centre));
        truth = -d3_dot(q, d3(k.frame.n)) / d3_dot(d3(r.d), d3(k.frame.n));
        p = along(&r, truth);
        polar(&k.frame, k.centre, p, &phi, &z);
        q = d3_sub(p, d3(k.centre));
        rad = sqrt(d3_dot(q, q));
        inside = rad <= 2 && rad >= k.inner && phi <= k.phimax;
        sure = fabs(rad - 2) > 1e-4 && fabs(rad - inner) > 1e-4 && fabs(phi - k.phimax) > 1e-4 &&
               phi > 1e-4 && 2 * PI - phi > 1e-4 && fabs(truth) > 1e-4 && fabs(truth) < 1e4;
        if (!sure)
            continue;
        tried++;
        got = disk_cross(&k, &r);
        EXPECT((inside && truth > 0) == (got > 0.0f), "hit or miss at radius %g, phi %g", rad, phi);
        if (got > 0.0f) {
            hits++;
            box = disk_box(&k);
            EXPECT(fabs(got - truth) <= ROUNDINGS(2) * truth, "t %.9g and not %.9g", (double)got,
                   truth);
            EXPECT(p.x >= box.lo.x && p.x <= box.hi.x && p.y >= box.lo.y && p.y <= box.hi.y &&
                   p.z >= box.lo.z && p.z <= box.hi.z, "the box does not hold the point");
        }
    }
    EXPECT(tried > 80000 && hits > 15000, "%lu tried, %lu hit", (unsigned long)tried,
           (unsigned long)hits);
}

static double latitude(double z) { return md_atan2(z, sqrt(1 - z * z)); }

/* u runs with phi, v of a sphere with theta from the lower end, v of a disc inwards from the rim:
 * [PBRT4 6.2.2, 6.4]. The float point is off by some 1e-6 radii, which near a pole or the centre
 * turns phi by as much over the distance: 1e-5 where that is above 0.2. */
static void texture(void)
{
    Rng rng = rng_seed(57);
    uint32_t odd[2] = { 0, 1 }, seen = 0;
    Shape both[2] = { { .kind = SHAPE_SPHERE }, { .kind = SHAPE_DISK } };
    Geometry g;

    memset(&g, 0, sizeof g);
    g.shapes = both;
    g.odd = odd;
    g.nodd = g.nshapes = 2;
    for (uint32_t i = 0; i < 40000; i++) {
        Where at = { 1, { 0, 0, 0 } };
        Transform t = place(&rng, &at, false);
        Sphere *s = &both[0].as.sphere;
        Disk *k = &both[1].as.disk;
        uint32_t prim = i % 2;
        Surface sf;
        double phi, z, v, rad;
        Hit h = { 0, 0, 0, prim, prim };
        Ray r;
        D3 q;

        both[0].flip = both[1].flip = i % 4 < 2;
        REQUIRE(sphere_init(s, &t, 1, -0.5f, 0.75f, 250) && disk_init(k, &t, 0, 1, 0.25f, 250),
                "a similarity");
        r = towards(&rng, v3(0, 0, 0), 1.0f);
        h.t = prim ? disk_cross(k, &r) : sphere_cross(s, &r);
        if (!(h.t > 0.0f))
            continue;
        geometry_surface(&g, &r, &h, &sf);
        q = d3(sf.p);
        polar(prim ? &k->frame : &s->frame, v3(0, 0, 0), q, &phi, &z);
        rad = sqrt(d3_dot(q, q));
        v = prim ? (1 - rad) / 0.75 : (latitude(z) - latitude(-0.5)) /
                                      (latitude(0.75) - latitude(-0.5));
        EXPECT(fabs(sf.uv.x - phi / (250 * PI / 180)) < 1e-5 && fabs(sf.uv.y - v) < 1e-5,
               "%s: uv %g %g and not %g %g", prim ? "disc" : "sphere", (double)sf.uv.x,
               (double)sf.uv.y, phi / (250 * PI / 180), v);
        EXPECT(v_dot(sf.ng, prim ? k->frame.n : sf.p) * (both[0].flip ? -1.0f : 1.0f) > 0.99f &&
               v_dot(sf.ng, sf.ns) > 0.99f, "%s: normal", prim ? "disc" : "sphere");
        seen++;
    }
    EXPECT(seen > 15000, "%lu seen", (unsigned long)seen);
}

const TestCase test_geometry_round[] = {
    { "sphere_errors", sphere_errors, false }, { "disk_errors", disk_errors, false },
    { "sphere_crossings", sphere_crossings, false }, { "disk_crossings", disk_crossings, false },
    { "texture", texture, false },
    { NULL, NULL, false }
};

/* test_generate.c -- generated meshes: closed, outward, of the volume that geometry says. */
#include "test/mesh_help.h"

#include "geometry/generate.h"

#include <string.h>

static void check(const char *name, bool ok, Mesh *m, uint32_t nverts, uint32_t ntris)
{
    REQUIRE(ok, "%s was refused", name);
    EXPECT(m->nverts == nverts && m->ntris == ntris, "%s: %lu vertices, %lu triangles", name,
           (unsigned long)m->nverts, (unsigned long)m->ntris);
    EXPECT(!mesh_fault(m), "%s: %s", name, mesh_fault(m));
    EXPECT(!mesh_drop_degenerate(m), "%s: triangles without area", name);
}

static void boxes(void)
{
    Mesh m;

    check("cube", mesh_cube(&m), &m, 8, 12);
    mesh_check_closed("cube", &m, 2);
    EXPECT(mesh_volume(&m) == 1.0 && mesh_area(&m) == 6.0, "cube: volume %g, area %g",
           mesh_volume(&m), mesh_area(&m));
    mesh_clear(&m);
    check("room", mesh_room(&m), &m, 12, 20);
    mesh_check_closed("room", &m, 2);
    EXPECT(mesh_volume(&m) == 3.0 && mesh_area(&m) == 14.0, "room: volume %g, area %g",
           mesh_volume(&m), mesh_area(&m));
    mesh_clear(&m);
    EXPECT(mem_blocks() == 0, "%ld blocks left", mem_blocks());
}

/* A convex body with all vertices on the unit sphere, whose faces have circles no larger than that
 * of the equilateral triangle of side `edge`, holds the ball of radius r, r^2 = 1 - edge^2 / 3, so
 * its volume lies between those of the two balls. */
static void check_ball(const char *name, const Mesh *m, double edge)
{
    double full = 4.0 / 3.0 * PI, r = sqrt(1.0 - edge * edge / 3.0), v = mesh_volume(m);

    for (uint32_t i = 0; i < m->nverts; i++)
        EXPECT(fabsf(v_len(m->p[i]) - 1.0f) < ROUNDINGS(8), "%s: vertex %lu off the sphere", name,
               (unsigned long)i);
    EXPECT(v < full && v > full * r * r * r, "%s: volume %g, between %g and %g expected", name, v,
           full * r * r * r, full);
}

static void spheres(void)
{
    static const uint32_t n[] = { 1, 2, 3, 4, 7, 16, 33 };
    Mesh m;

    for (size_t k = 0; k < sizeof n / sizeof *n; k++) {
        double edge = 0.0;
        check("icosphere", mesh_icosphere(&m, n[k]), &m, 10 * n[k] * n[k] + 2, 20 * n[k] * n[k]);
        mesh_check_closed("icosphere", &m, 2);
        for (uint32_t i = 0; i < m.ntris; i++)
            for (int e = 0; e < 3; e++) {
                double l = (double)v_len(v_sub(m.p[m.tri[i].v[e]], m.p[m.tri[i].v[(e + 1) % 3]]));
                edge = l > edge ? l : edge;
            }
        /* The edge of the icosahedron is 1.05147, and p / |p| stretches what is flat by at most one
         * over the inner radius, 1 / 0.79465. */
        EXPECT(edge < 1.05147 / 0.79465 / n[k], "icosphere: edge of %g", edge);
        check_ball("icosphere", &m, edge);
        mesh_clear(&m);
    }
    for (uint32_t nu = 3; nu < 9; nu++)
        for (uint32_t nv = 2; nv < 7; nv++) {
            check("uvsphere", mesh_uvsphere(&m, nu, nv), &m, nu * (nv - 1) + 2,
                  2 * nu * (nv - 1));
            mesh_check_closed("uvsphere", &m, 2);
            EXPECT(mesh_volume(&m) > 0.0 && mesh_volume(&m) < 4.0 / 3.0 * PI, "uvsphere: volume");
            mesh_clear(&m);
        }
    check("uvsphere", mesh_uvsphere(&m, 64, 32), &m, 64 * 31 + 2, 2 * 64 * 31);
    mesh_check_closed("uvsphere", &m, 2);
    check_ball("uvsphere", &m, 2.0 * PI / 64 * sqrt(2.0));     /* diagonal of the largest cell */
    mesh_clear(&m);
    EXPECT(mem_blocks() == 0, "%ld blocks left", mem_blocks());
}

/* Both circles of the torus become inscribed polygons: with x = 2 pi / n, each takes sin(x)/x of
 * the volume, and 1 - sin(x)/x < x^2 / 6. */
static void toruses(void)
{
    Mesh m;
    double v, full = 2.0 * PI * PI * 2.0 * 0.25;

    for (uint32_t nu = 3; nu < 7; nu++)
        for (uint32_t nv = 3; nv < 7; nv++) {
            check("torus", mesh_torus(&m, nu, nv, 2.0f, 0.5f), &m, nu * nv, 2 * nu * nv);
            mesh_check_closed("torus", &m, 0);
            EXPECT(mesh_volume(&m) > 0.0, "torus: volume");
            mesh_clear(&m);
        }
    check("torus", mesh_torus(&m, 200, 100, 2.0f, 0.5f), &m, 20000, 40000);
    mesh_check_closed("torus", &m, 0);
    v = mesh_volume(&m);
    EXPECT(v < full && v > full * (1.0 - 4.0 * PI * PI / 6.0 * (1.0 / (200 * 200) +
                                                               1.0 / (100 * 100))),
           "torus: volume %g", v);
    mesh_clear(&m);
}

static void random_bodies(void)
{
    Mesh m, again;
    float lo, hi;

    for (uint64_t seed = 0; seed < 20; seed++) {
        check("blob", mesh_blob(&m, seed), &m, 102, 200);
        mesh_check_closed("blob", &m, 2);
        /* A surface over the sphere keeps the orientation of each cone over a triangle. */
        EXPECT(mesh_volume(&m) > 0.0, "blob: volume %g", mesh_volume(&m));
        lo = 9.0f;
        hi = 0.0f;
        for (uint32_t i = 0; i < m.nverts; i++) {
            lo = f_min(lo, v_len(m.p[i]));
            hi = f_max(hi, v_len(m.p[i]));
        }
        EXPECT(lo > 0.69999f && hi < 1.30001f && hi - lo > 0.01f, "blob: radius %g to %g",
               (double)lo, (double)hi);
        REQUIRE(mesh_blob(&again, seed), "blob");
        EXPECT(!memcmp(m.p, again.p, m.nverts * sizeof *m.p), "blob: not the same twice");
        mesh_clear(&again);
        mesh_clear(&m);
    }
    check("bumpy", mesh_bumpy(&m, 20, 3), &m, 4002, 8000);
    mesh_check_closed("bumpy", &m, 2);
    EXPECT(mesh_volume(&m) > 4.0 / 3.0 * PI * 0.3, "bumpy: volume %g", mesh_volume(&m));
    REQUIRE(mesh_bumpy(&again, 20, 4), "bumpy");
    EXPECT(memcmp(m.p, again.p, m.nverts * sizeof *m.p), "bumpy: the seed has no effect");
    mesh_clear(&again);
    mesh_clear(&m);
    for (uint32_t n = 80; n < 700; n += 2) {
        check("bumpy of", mesh_bumpy_of(&m, n, n), &m, n / 2 + 2, n);
        mesh_check_closed("bumpy of", &m, 2);
        mesh_clear(&m);
    }
    REQUIRE(mesh_bumpy_of(&m, 1000, 1) && mesh_bumpy_of(&again, 999, 1), "bumpy of");
    EXPECT(again.ntris == 999 && again.nverts == m.nverts &&
           !memcmp(again.tri, m.tri, 999 * sizeof *m.tri), "bumpy of: an odd number");
    mesh_clear(&again);
    mesh_clear(&m);
    check("soup", mesh_soup(&m, 1000, 0.1f, 5), &m, 3000, 1000);
    for (uint32_t i = 0; i < m.nverts; i++)
        EXPECT(v_max3(v_abs(v_sub(m.p[i], v_all(0.5f)))) < 0.55001f, "soup: far out");
    mesh_clear(&m);
    check("soup", mesh_soup(&m, 0, 0.1f, 5), &m, 0, 0);
    mesh_clear(&m);
    EXPECT(mem_blocks() == 0, "%ld blocks left", mem_blocks());
}

static void grids(void)
{
    Mesh m;

    check("grid", mesh_grid(&m, 7, 3), &m, 32, 42);
    for (uint32_t i = 0; i < m.ntris; i++) {
        V3 a = m.p[m.tri[i].v[0]];
        V3 n = v_cross(v_sub(m.p[m.tri[i].v[1]], a), v_sub(m.p[m.tri[i].v[2]], a));
        EXPECT(n.z > 0.0f && n.x == 0.0f && n.y == 0.0f, "grid: triangle %lu faces down",
               (unsigned long)i);
    }
    /* Coordinates are rounded once, so differences of 1/7 and 1/3 are off by 7 and 3 roundings. */
    EXPECT(fabs(mesh_area(&m) - 1.0) < (double)ROUNDINGS(16), "grid: area %g", mesh_area(&m));
    EXPECT(m.uv && m.uv[31].x == 1.0f && m.uv[31].y == 1.0f && m.uv[0].x == 0.0f, "grid: uv");
    mesh_clear(&m);
}

/* Refused, with one message, and nothing kept. */
static void refusals(void)
{
    Mesh m;
    char line[200];

#define REFUSES(call, word) \
    EXPECT(!(call) && !m.p && !m.tri && !m.nverts && messages_take(line, sizeof line) == 1 && \
           strstr(line, word), "%s: '%s'", #call, line)
    messages_start();
    memset(&m, 0, sizeof m);
    REFUSES(mesh_icosphere(&m, 0), "1 to 10000");
    REFUSES(mesh_icosphere(&m, 10001), "1 to 10000");
    REFUSES(mesh_uvsphere(&m, 2, 5), "meridians");
    REFUSES(mesh_uvsphere(&m, 3, 1), "parallels");
    REFUSES(mesh_uvsphere(&m, 100000, 100000), "too many");
    REFUSES(mesh_torus(&m, 3, 2, 1.0f, 0.5f), "tube");
    REFUSES(mesh_torus(&m, 3, 3, 1.0f, 1.5f), "major > minor");
    REFUSES(mesh_torus(&m, 3, 3, NAN, 1.0f), "major > minor");
    REFUSES(mesh_bumpy_of(&m, 79, 1), "80 to");
    REFUSES(mesh_soup(&m, 0xFFFFFFFFu, 0.1f, 0), "too many");
    REFUSES(mesh_soup(&m, 1, 0.0f, 0), "above 0");
    REFUSES(mesh_grid(&m, 0, 1), "columns");
    REFUSES(mesh_grid(&m, 70000, 70000), "too many");
    mem_fail_at(1, true);
    err_reset();
    REFUSES(mesh_cube(&m), "memory");
    mem_fail_at(3, true);
    err_reset();
    REFUSES(mesh_grid(&m, 2, 2), "memory");
#undef REFUSES
    mem_fail_at(0, false);
    EXPECT(mem_blocks() == 0, "%ld blocks left", mem_blocks());
}

const TestCase test_generate[] = {
    { "boxes", boxes, false },
    { "spheres", spheres, false },
    { "toruses", toruses, false },
    { "random-bodies", random_bodies, false },
    { "grids", grids, false },
    { "refusals", refusals, false },
    { NULL, NULL, false }
};

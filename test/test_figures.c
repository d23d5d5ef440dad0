/* test_figures.c -- shapes for modelling: bodies made by rule, outlines turned, tubes and ribbons,
 * and what the scene language makes of them. */
#include "geometry/figures.h"
#include "geometry/generate.h"
#include "geometry/implicit.h"
#include "geometry/quadric_mesh.h"
#include "geometry/sweep.h"
#include "test/mesh_help.h"
#include "test/scene_help.h"

#include <stdio.h>
#include <string.h>

/* Unit normals on the side where triangles run counter-clockwise; `most`: of the corners, so many
 * in a thousand may disagree (where features are thinner than triangles). */
static void check_normals(const char *name, const Mesh *m, unsigned most)
{
    size_t wrong = 0;

    REQUIRE(m->n, "%s has no normals", name);
    for (uint32_t i = 0; i < m->nverts; i++)
        EXPECT(fabsf(v_len(m->n[i]) - 1) < 1e-5f, "%s: normal of length %g", name,
               (double)v_len(m->n[i]));
    for (size_t i = 0; i < 3 * (size_t)m->ntris; i++) {
        const uint32_t *v = m->tri[i / 3].v;
        V3 g = v_cross(v_sub(m->p[v[1]], m->p[v[0]]), v_sub(m->p[v[2]], m->p[v[0]]));
        wrong += !(v_dot(g, m->n[v[i % 3]]) > 0);
    }
    EXPECT(1000 * wrong <= (size_t)most * 3 * m->ntris, "%s: %lu of %lu normals point inwards",
           name, (unsigned long)wrong, 3 * (unsigned long)m->ntris);
}

/* ---- surfaces of functions ---- */

typedef struct { double big, small; } Ring;
static double ring_at(const void *ctx, const double p[3])
{
    const Ring *r = ctx;
    double x = sqrt(p[0] * p[0] + p[1] * p[1]) - r->big;
    return sqrt(x * x + p[2] * p[2]) - r->small;
}

/* Against what is known of a torus; and blocks are skipped without loss: with a slope so large that
 * none is, the same bytes come out. */
static void implicit(void)
{
    static const Ring ring = { 1, 0.4 };
    Implicit f = { ring_at, &ring, 1, { -1.5, -1.5, -0.5 }, { 1.5, 1.5, 0.5 } };
    double full = 2 * PI * PI * 1 * 0.16;
    Mesh m, all;

    for (uint32_t n = 2000; n < 40000; n = n * 3 + 1) {
        REQUIRE(implicit_mesh(&m, &f, n), "refused");
        EXPECT(m.ntris == n / 2 * 2 && m.nverts == m.ntris / 2, "%lu triangles", (unsigned long)n);
        mesh_check_closed("ring", &m, 0);
        check_normals("ring", &m, 2);
        EXPECT(mesh_volume(&m) < full && mesh_volume(&m) > full * (1 - 110.0 / n),
               "volume %g of %g", mesh_volume(&m), full);
        for (uint32_t i = 0; i < m.nverts; i++) {
            double p[3] = { m.p[i].x, m.p[i].y, m.p[i].z };
            EXPECT(fabs(ring_at(&ring, p)) < 2.0 / n, "%g off the surface", ring_at(&ring, p));
        }
        mesh_clear(&m);
    }
    REQUIRE(implicit_mesh(&m, &f, 9000), "refused");
    f.steepest = 1e9;
    REQUIRE(implicit_mesh(&all, &f, 9000), "refused");
    EXPECT(!memcmp(m.p, all.p, m.nverts * sizeof *m.p) &&
           !memcmp(m.tri, all.tri, m.ntris * sizeof *m.tri), "blocks with a surface were skipped");
    mesh_clear(&m);
    mesh_clear(&all);
    EXPECT(mem_blocks() == 0, "%ld blocks left", mem_blocks());
}

/* ---- figures ---- */

/* V - E + F of each. The skull has three handles: two between jaw and cheek bones, one among the
 * teeth, where gaps are as thin as the triangles. */
static const struct { const char *name; FigureKind kind; long euler; } figures[] = {
    { "rock", FIGURE_ROCK, 2 }, { "knot", FIGURE_KNOT, 0 }, { "skull", FIGURE_SKULL, -4 },
    { "statue", FIGURE_STATUE, 2 }, { "hare", FIGURE_HARE, 2 }, { "dragon", FIGURE_DRAGON, 2 },
};

static void bodies(void)
{
    Box b;
    Mesh m, again;

    for (size_t k = 0; k < sizeof figures / sizeof *figures; k++) {
        const char *name = figures[k].name;
        REQUIRE(figure_mesh(&m, figures[k].kind, 40001, 5), "%s", name);
        EXPECT(!mesh_fault(&m), "%s: %s", name, mesh_fault(&m));
        /* Cutting fills up to the number; the knot rounds down to whole rings. */
        EXPECT(m.ntris <= 40000 && m.ntris > 39900 && m.ntris % 2 == 0, "%s: %lu triangles", name,
               (unsigned long)m.ntris);
        mesh_check_closed(name, &m, figures[k].euler);
        check_normals(name, &m, figures[k].kind == FIGURE_SKULL ? 20 : 4);
        EXPECT(mesh_volume(&m) > 0.01 && mesh_volume(&m) < 1, "%s: volume %g", name,
               mesh_volume(&m));
        b = box_empty();
        for (uint32_t i = 0; i < m.nverts; i++)
            b = box_point(b, m.p[i]);
        if (figures[k].kind != FIGURE_KNOT)
            EXPECT(b.lo.z > -0.12f && b.lo.z < 0.02f && b.hi.z > 0.8f && b.hi.z < 1.1f,
                   "%s: z from %g to %g", name, (double)b.lo.z, (double)b.hi.z);
        EXPECT(mesh_drop_degenerate(&m) == 0, "%s: triangles without area", name);
        REQUIRE(figure_mesh(&again, figures[k].kind, 40001, 6), "%s", name);
        EXPECT((figures[k].kind == FIGURE_ROCK) ==
                   (m.nverts != again.nverts || memcmp(m.p, again.p, m.nverts * sizeof *m.p)),
               "%s: the seed", name);
        mesh_clear(&again);
        mesh_clear(&m);
    }
    for (uint32_t n = 1000; n < 1200; n += 37) {
        REQUIRE(figure_mesh(&m, FIGURE_ROCK, n, n), "rock");
        EXPECT(m.ntris == n / 2 * 2, "%lu triangles for %lu", (unsigned long)m.ntris,
               (unsigned long)n);
        mesh_check_closed("rock", &m, 2);
        mesh_clear(&m);
    }
    EXPECT(mem_blocks() == 0, "%ld blocks left", mem_blocks());
}

/* ---- boxes and outlines ---- */

static void boxes(void)
{
    Mesh m;

    REQUIRE(mesh_box(&m, v3(-1, 2, 3), v3(1, 5, 7)), "box");
    EXPECT(mesh_volume(&m) == 24 && mesh_area(&m) == 52, "volume %g, area %g", mesh_volume(&m),
           mesh_area(&m));
    for (uint32_t i = 0; i < m.ntris; i++) {    /* u and v run right-handed seen from outside */
        const uint32_t *v = m.tri[i].v;
        V2 a = m.uv[v[0]], b = m.uv[v[1]], c = m.uv[v[2]];
        EXPECT((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x) == 1, "uv of triangle %lu",
               (unsigned long)i);
    }
    mesh_weld(&m);
    EXPECT(m.nverts == 8, "%lu vertices", (unsigned long)m.nverts);
    mesh_check_closed("box", &m, 2);
    mesh_clear(&m);
}

/* A cone on a cylinder, straight; and a curve through points of a half circle is near the ball. */
static void outlines(void)
{
    static const V2 tower[] = { { 0, 0 }, { 1, 0 }, { 1, 2 }, { 0, 3 } };
    Outline o = { tower, 4, false, 360, 64 };
    V2 arc[18];
    double s = 64 / (2 * PI) * md_sin(2 * PI / 64), full;
    Mesh m;

    memset(&m, 0, sizeof m);
    REQUIRE(outline_mesh(&m, &o), "memory");
    EXPECT(m.ntris <= outline_triangles(&o), "more triangles than said");
    check_normals("tower", &m, 0);
    mesh_weld(&m);
    mesh_check_closed("tower", &m, 2);
    full = PI * (2 + 1.0 / 3) * s;              /* polygons of 64 corners for circles */
    EXPECT(fabs(mesh_volume(&m) - full) < 1e-5 * full, "volume %g of %g", mesh_volume(&m), full);
    mesh_clear(&m);

    arc[0] = (V2){ 0, -1 };                     /* a corner first: no effect at an end */
    for (int i = 0; i <= 16; i++)
        arc[i + 1] = (V2){ i % 16 ? (float)md_sin(PI * i / 16) : 0, (float)-md_cos(PI * i / 16) };
    o = (Outline){ arc, 18, true, 360, 128 };
    memset(&m, 0, sizeof m);
    REQUIRE(outline_mesh(&m, &o), "memory");
    for (uint32_t i = 0; i < m.nverts; i++) {
        EXPECT(fabsf(v_len(m.p[i]) - 1) < 0.01f, "radius %g", (double)v_len(m.p[i]));
        EXPECT(v_dot(m.n[i], m.p[i]) > 0.98f, "normal at height %g", (double)m.p[i].z);
    }
    mesh_weld(&m);
    mesh_check_closed("ball", &m, 2);
    full = 4.0 / 3 * PI;
    EXPECT(fabs(mesh_volume(&m) - full) < 0.01 * full, "volume %g of %g", mesh_volume(&m), full);
    mesh_clear(&m);
    EXPECT(mem_blocks() == 0, "%ld blocks left", mem_blocks());
}

static void tori(void)
{
    Quadric q;
    double full = 4 * PI * PI * 2 * 0.5;
    Mesh m;

    memset(&q, 0, sizeof q);
    memset(&m, 0, sizeof m);
    q.kind = QUADRIC_TORUS;
    q.radius = 2;
    q.inner = 0.5;
    q.phimax = 360;
    REQUIRE(quadric_mesh(&m, &q), "memory");
    check_normals("torus", &m, 0);
    for (uint32_t i = 0; i < m.nverts; i++) {
        V3 axis = v_scale(v_unit(v3(m.p[i].x, m.p[i].y, 0)), 2);
        V3 d = v_scale(v_sub(m.p[i], axis), 2);
        EXPECT(v_near(d, m.n[i], 2e-6f), "normal of vertex %lu", (unsigned long)i);
    }
    mesh_weld(&m);
    mesh_check_closed("torus", &m, 0);
    EXPECT(fabs(mesh_area(&m) - full) < 2e-3 * full, "area %g of %g", mesh_area(&m), full);
    mesh_clear(&m);
}

/* ---- curves ---- */

/* Points of a straight line evenly spread: the tube is a prism of 16 sides. */
static void straight_tubes(void)
{
    static const V3 p[] = { { 1, 2, 3 }, { 1, 2, 4 }, { 1, 2, 5 }, { 1, 2, 6 } };
    double prism = 8 * md_sin(PI / 8) * 0.25;   /* 16 triangles of r^2 sin(2 pi / 16) / 2 */
    Mesh m;

    for (uint32_t degree = 2; degree <= 3; degree++)
        for (int bspline = 0; bspline < 2; bspline++) {
            Sweep s = { p, degree + 1, degree, bspline, NULL, 1, 1 };
            double length = !bspline ? degree : 1;
            memset(&m, 0, sizeof m);
            REQUIRE(sweep_mesh(&m, &s), "memory");
            EXPECT(m.ntris == sweep_triangles(&s), "%lu triangles", (unsigned long)m.ntris);
            check_normals("tube", &m, 0);
            mesh_weld(&m);
            mesh_check_closed("tube", &m, 2);
            EXPECT(fabs(mesh_volume(&m) - prism * length) < 1e-5, "degree %lu, %d: volume %g of %g",
                   (unsigned long)degree, bspline, mesh_volume(&m), prism * length);
            mesh_clear(&m);
            s.width1 = 0;                       /* a third of it, and a tip */
            REQUIRE(sweep_mesh(&m, &s), "memory");
            check_normals("tip", &m, 0);
            mesh_weld(&m);
            mesh_check_closed("tip", &m, 2);
            EXPECT(fabs(mesh_volume(&m) - prism * length / 3) < 1e-5, "tip: volume %g",
                   mesh_volume(&m));
            mesh_clear(&m);
        }
    EXPECT(mem_blocks() == 0, "%ld blocks left", mem_blocks());
}

/* One polynomial written in both bases and both degrees is the same curve; its tube is closed, and
 * all of it is half a width away from it. */
static void bent_tubes(void)
{
    static const V3 bezier[] = { { 0, 0, 0 }, { 0, 0, 2 }, { 2, 1, 2 }, { 2, 1, 0 } };
    static const V3 square[] = { { 0, 0, 0 }, { 3, 0, 3 }, { 6, 3, 0 } };
    /* raised: b0, b0 + 2/3 (b1 - b0), b2 + 2/3 (b1 - b2), b2 */
    static const V3 raised[] = { { 0, 0, 0 }, { 2, 0, 2 }, { 4, 1, 2 }, { 6, 3, 0 } };
    /* knots evenly spread: b0 = (p0 + 4 p1 + p2) / 6 and so on, solved for p */
    static const V3 spline[] = { { 4, 2, -10 }, { -2, -1, 2 }, { 4, 2, 2 }, { -2, -1, -10 } };
    Sweep a = { bezier, 4, 3, false, NULL, 0.2f, 0.1f }, b = a;
    Mesh m, same;

    memset(&m, 0, sizeof m);
    memset(&same, 0, sizeof same);
    REQUIRE(sweep_mesh(&m, &a), "memory");
    b.p = spline;
    b.bspline = true;
    REQUIRE(sweep_mesh(&same, &b), "memory");
    EXPECT(m.nverts == same.nverts, "vertices");
    for (uint32_t i = 0; i < m.nverts && i < same.nverts; i++)
        EXPECT(v_near(m.p[i], same.p[i], 1e-5f), "vertex %lu of both bases", (unsigned long)i);
    mesh_clear(&same);
    check_normals("tube", &m, 0);
    mesh_weld(&m);
    mesh_check_closed("tube", &m, 2);
    mesh_clear(&m);

    a = (Sweep){ square, 3, 2, false, NULL, 0.2f, 0.2f };
    b = (Sweep){ raised, 4, 3, false, NULL, 0.2f, 0.2f };
    memset(&m, 0, sizeof m);
    REQUIRE(sweep_mesh(&m, &a) && sweep_mesh(&same, &b), "memory");
    for (uint32_t i = 0; i < m.nverts; i++) {
        /* Rings are in the plane across the curve: a x^2 .. is known at parameter u. */
        float u = m.uv[i].x;
        V3 c = v3(6 * u, 3 * u * u, 6 * u * (1 - u));
        EXPECT(fabsf(v_len(v_sub(m.p[i], c)) - 0.1f) < 1e-5f, "vertex %lu", (unsigned long)i);
    }
    for (uint32_t i = 0; i < same.nverts; i++) {
        float u = same.uv[i].x;
        V3 c = v3(6 * u, 3 * u * u, 6 * u * (1 - u));
        EXPECT(fabsf(v_len(v_sub(same.p[i], c)) - 0.1f) < 1e-5f, "raised: %lu", (unsigned long)i);
    }
    mesh_clear(&m);
    mesh_clear(&same);
    EXPECT(mem_blocks() == 0, "%ld blocks left", mem_blocks());
}

/* A straight ribbon that turns by a right angle: as wide all along, and its normals turn evenly. */
static void ribbons(void)
{
    static const V3 p[] = { { 0, 0, 0 }, { 1, 0, 0 }, { 2, 0, 0 }, { 3, 0, 0 } };
    static const V3 n[] = { { 0, 0, 2 }, { 0, 1, 0 } };
    Sweep s = { p, 4, 3, false, n, 0.5f, 0.5f };
    Mesh m;

    memset(&m, 0, sizeof m);
    REQUIRE(sweep_mesh(&m, &s), "memory");
    EXPECT(m.nverts >= 20, "%lu vertices for a turn", (unsigned long)m.nverts);
    check_normals("ribbon", &m, 0);
    for (uint32_t i = 0; i + 1 < m.nverts; i += 2) {
        float turn = m.uv[i].x * 0.25f, c, sn;
        m_sincos_turn(turn, &sn, &c);
        EXPECT(fabsf(v_len(v_sub(m.p[i], m.p[i + 1])) - 0.5f) < 1e-5f, "width at %lu",
               (unsigned long)i);
        EXPECT(v_near(m.n[i], v3(0, sn, c), 2e-3f), "normal at %lu", (unsigned long)i);
    }
    mesh_clear(&m);
}

/* Curves that stand still, go back, or have no length or width. */
static void odd_curves(void)
{
    static const V3 p[] = { { 1, 1, 1 }, { 1, 1, 1 }, { 1, 1, 1 }, { 1, 1, 1 }, { 2, 1, 1 },
                            { 1, 1, 1 }, { 1, 1, 1 }, { 0, 0, 0 }, { 0, 0, 0 }, { 0, 0, 0 } };
    Mesh m;

    for (uint32_t n = 4; n <= 10; n += 3)
        for (uint32_t first = 0; first + n <= 10; first++)
            for (int width = 0; width < 2; width++) {
                Sweep s = { p + first, n, 3, false, NULL, (float)width, (float)width };
                memset(&m, 0, sizeof m);
                REQUIRE(sweep_mesh(&m, &s), "memory");
                EXPECT(!mesh_fault(&m), "%s", mesh_fault(&m));
                if (n == 4 && (first == 0 || !width))
                    EXPECT(!m.ntris, "%lu triangles of nothing", (unsigned long)m.ntris);
                mesh_clear(&m);
            }
    EXPECT(mem_blocks() == 0, "%ld blocks left", mem_blocks());
}

/* ---- in the scene language ---- */

static void language(void)
{
    static const struct { const char *shape; unsigned warnings; } rows[] = {
        { "\"curve\" \"point3 P\" [0 0 0 0 0 1 1 0 1 1 0 0] \"float width\" 0.1", 0 },
        { "\"curve\" \"point P\" [0 0 0 0 0 1 1 0 1] \"integer degree\" 2 \"string type\" "
          "\"ribbon\" \"normal N\" [0 1 0 0 1 0] \"float width0\" 0.1 \"float width1\" 0.2", 0 },
        { "\"curve\" \"point3 P\" [0 0 0 0 0 1 1 0 1 1 0 0 2 0 0] \"string basis\" \"bspline\" "
          "\"string type\" \"cylinder\" \"integer splitdepth\" 4", 0 },
        { "\"torus\" \"float radius\" 2 \"float minorradius\" 0.5 \"float phimax\" 90", 0 },
        { "\"box\"", 0 }, { "\"box\" \"point3 from\" [0 0 0] \"point3 to\" [1 2 3]", 0 },
        { "\"lathe\" \"point2 P\" [0 0 1 0 1 1 0.5 2] \"bool smooth\" false", 0 },
        { "\"lathe\" \"point2 P\" [0 0 1 0 1 0 1 1 0.5 2] \"integer around\" 12", 0 },
        { "\"generated\" \"string kind\" \"hare\" \"integer triangles\" 2000", 0 },
        { "\"generated\" \"string kind\" \"knot\" \"integer triangles\" 2000", 0 },
    };
    char text[400];

    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        SceneFile f;
        snprintf(text, sizeof text, "WorldBegin Shape %s", rows[i].shape);
        f = scene_of(text, rows[i].warnings);
        EXPECT(scene_shape(&f, 0)->count >= 12, "%s: %lu triangles", rows[i].shape,
               (unsigned long)scene_shape(&f, 0)->count);
        scenefile_clear(&f);
    }
    EXPECT(mem_blocks() == 0, "%ld blocks left", mem_blocks());
}

/* Memory that runs out anywhere is told and given back. */
static void memory(void)
{
    static const V3 p[] = { { 0, 0, 0 }, { 0, 0, 1 }, { 1, 0, 1 } };
    static const V2 outline[] = { { 0, 0 }, { 1, 1 } };
    Sweep s = { p, 3, 2, false, NULL, 0.1f, 0.1f };
    Outline o = { outline, 2, true, 360, 12 };

    messages_nowhere();
    for (unsigned long k = 1; k < 12; k++) {
        Mesh m = { 0 };
        mem_fail_at(k, true);
        EXPECT(sweep_mesh(&m, &s) == (k > 5), "curve at %lu", k);
        mesh_clear(&m);
        mem_fail_at(k, true);
        EXPECT(outline_mesh(&m, &o) == (k > 4), "outline at %lu", k);
        mesh_clear(&m);
        mem_fail_at(k, true);
        EXPECT(!figure_mesh(&m, FIGURE_ROCK, 1000, 1), "rock at %lu", k);
        EXPECT(!m.p && !m.tri, "kept something");
        mem_fail_at(k, true);
        EXPECT(figure_mesh(&m, FIGURE_KNOT, 1000, 1) == (k > 3), "knot at %lu", k);
        mesh_clear(&m);
    }
    mem_fail_at(0, false);
    EXPECT(mem_blocks() == 0, "%ld blocks left", mem_blocks());
}

const TestCase test_figures[] = {
    { "implicit", implicit, false },
    { "bodies", bodies, false },
    { "boxes", boxes, false },
    { "outlines", outlines, false },
    { "tori", tori, false },
    { "straight-tubes", straight_tubes, false },
    { "bent-tubes", bent_tubes, false },
    { "ribbons", ribbons, false },
    { "odd-curves", odd_curves, false },
    { "language", language, false },
    { "memory", memory, false },
    { NULL, NULL, false }
};

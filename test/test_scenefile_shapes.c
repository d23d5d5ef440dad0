/* test_scenefile_shapes.c -- shapes of scene files: fronts and arrays of meshes, shapes of
 * revolution against their equations, Loop subdivision against what is invariant under it. */
#include "geometry/loop.h"
#include "geometry/quadric_mesh.h"
#include "test/mesh_help.h"
#include "test/scene_help.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- meshes ---- */

#define QUAD "\"point3 P\" [0 0 0 1 0 0 1 1 0 0 1 0] \"integer indices\" [0 1 2 0 2 3] "

/* Normals go by the inverse transpose and are turned round by ReverseOrientation; without normals
 * the front stays where it was when a transform mirrors. */
static void fronts(void)
{
    static const char tri[] = "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]";
    static const struct { const char *before; bool normals, flip; V3 n; } rows[] = {
        { "", false, false, { 0, 0, 0 } },
        { "ReverseOrientation", false, true, { 0, 0, 0 } },
        { "Scale -1 1 1", false, true, { 0, 0, 0 } },
        { "Scale -1 1 1 ReverseOrientation", false, false, { 0, 0, 0 } },
        { "Scale -1 -1 1", false, false, { 0, 0, 0 } },
        { "Scale 2 1 1", true, false, { 0.5f, 0, 1 } },
        { "Scale 2 1 1 ReverseOrientation", true, true, { -0.5f, 0, -1 } },
        { "Scale -1 1 1", true, true, { -1, 0, 1 } },
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char text[300];
        SceneFile f;
        const Shape *s;
        snprintf(text, sizeof text, "WorldBegin %s %s %s", rows[i].before, tri,
                 rows[i].normals ? "\"normal N\" [2 0 2 2 0 2 2 0 2]" : "");
        f = scene_of(text, 0);
        s = scene_shape(&f, 0);
        EXPECT(s->flip == rows[i].flip, "flip: %s", text);
        EXPECT((s->n != NULL) == rows[i].normals, "normals: %s", text);
        for (int k = 0; s->n && k < 3; k++)
            EXPECT(v_near(s->n[k], v_unit(rows[i].n), 1e-6f), "normal %g %g %g: %s", s->n[k].x,
                   s->n[k].y, s->n[k].z, text);
        scenefile_clear(&f);
    }
}

static void mesh_arrays(void)
{
    static const char *const names[] = { "point2 uv", "float uv", "float st", "point2 st" };
    for (size_t i = 0; i < 4; i++) {
        char text[300];
        SceneFile f;
        snprintf(text, sizeof text,
                 "WorldBegin Shape \"trianglemesh\" " QUAD "\"%s\" [0 0 2 0 2 3 0 3]", names[i]);
        f = scene_of(text, 0);
        EXPECT(scene_shape(&f, 0)->count == 2 && scene_shape(&f, 0)->uv &&
                   scene_shape(&f, 0)->uv[2].x == 2 && scene_shape(&f, 0)->uv[2].y == 3,
               "%s", names[i]);
        EXPECT(f.scene->geometries[0].tri[1].v[2] == 3, "indices");
        scenefile_clear(&f);
    }
}

/* ---- shapes of revolution ---- */

/* Value of the shape's equation at p (0 on the surface) and its gradient. */
static double equation(const Quadric *q, V3 p, V3 *g)
{
    double r2 = (double)p.x * p.x + (double)p.y * p.y, k;
    double dx = (double)q->p2.x - q->p1.x, dy = (double)q->p2.y - q->p1.y;
    double dz = (double)q->p2.z - q->p1.z, t, x, y;

    switch (q->kind) {
    case QUADRIC_SPHERE:
        *g = p;
        return r2 + (double)p.z * p.z - q->radius * q->radius;
    case QUADRIC_DISK:
        *g = v3(0, 0, 1);
        return p.z - q->height;
    case QUADRIC_TORUS:                             /* test_figures.c */
        break;
    case QUADRIC_CYLINDER:
        *g = v3(p.x, p.y, 0);
        return r2 - q->radius * q->radius;
    case QUADRIC_CONE:                              /* r = R (1 - z/h) */
        k = q->radius / q->height;
        *g = v3(p.x, p.y, (float)(k * k * (q->height - p.z)));
        return r2 - k * k * (q->height - p.z) * (q->height - p.z);
    case QUADRIC_PARABOLOID:                        /* r^2 = R^2 z / zmax, outside below */
        k = q->radius * q->radius / q->zmax;
        *g = v3(2 * p.x, 2 * p.y, (float)-k);
        return r2 - k * p.z;
    case QUADRIC_HYPERBOLOID:                       /* r^2 that of the line at this height */
        t = (p.z - q->p1.z) / dz;
        x = q->p1.x + t * dx;
        y = q->p1.y + t * dy;
        *g = v3(p.x, p.y, (float)(-(x * dx + y * dy) / dz));
        return r2 - x * x - y * y;
    }
    return 1;
}

/* Every vertex lies on the surface; its normal is the gradient; triangles face the same way; all
 * triangles are met: their area is that of the surface up to the chords. */
static void quadrics(void)
{
    static const struct { Quadric q; double area; } rows[] = {
        { { QUADRIC_SPHERE, 2, 0, -2, 2, 0, 360, { 0, 0, 0 }, { 0, 0, 0 } }, 50.265482 },
        { { QUADRIC_SPHERE, 2, 0, -1, 0.5, 0, 90, { 0, 0, 0 }, { 0, 0, 0 } }, 4.712389 },
        { { QUADRIC_DISK, 2, 1, 0, 0, 3, 360, { 0, 0, 0 }, { 0, 0, 0 } }, 9.424778 },
        { { QUADRIC_DISK, 2, 0, 0, 0, -1, 180, { 0, 0, 0 }, { 0, 0, 0 } }, 6.283185 },
        { { QUADRIC_CYLINDER, 0.5, 0, -1, 3, 0, 360, { 0, 0, 0 }, { 0, 0, 0 } }, 12.566371 },
        { { QUADRIC_CONE, 3, 0, 0, 0, 4, 360, { 0, 0, 0 }, { 0, 0, 0 } }, 47.123890 },
        { { QUADRIC_PARABOLOID, 1, 0, 0, 1, 0, 360, { 0, 0, 0 }, { 0, 0, 0 } }, 5.330414 },
        { { QUADRIC_PARABOLOID, 1, 0, 0.25, 1, 0, 360, { 0, 0, 0 }, { 0, 0, 0 } }, 4.372901 },
        { { QUADRIC_HYPERBOLOID, 1, 0, 0, 0, 0, 360, { 1, 0, -1 }, { 1, 0, 1 } }, 12.566371 },
        { { QUADRIC_HYPERBOLOID, 1, 0, 0, 0, 0, 270, { 1, 1, -1 }, { 1, -1, 1 } }, 0 },
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const Quadric *q = &rows[i].q;
        double area = 0, worst = 0, turn = 1, sign = 0;
        Mesh m;
        memset(&m, 0, sizeof m);
        REQUIRE(quadric_mesh(&m, q), "memory");
        EXPECT(!mesh_fault(&m) && m.ntris <= quadric_triangles(q), "mesh %lu", (unsigned long)i);
        for (uint32_t v = 0; v < m.nverts; v++) {
            V3 g = v_all(0.0f);
            double e = fabs(equation(q, m.p[v], &g)) / 10;
            worst = e > worst ? e : worst;
            if (v_len(g) > 1e-3f) {             /* a tip has no gradient */
                double c = v_dot(v_unit(g), m.n[v]);
                sign = sign ? sign : c;
                turn = c * sign < turn ? c * sign : turn;
            }
        }
        EXPECT(worst < 1e-6, "shape %lu: off by %g", (unsigned long)i, worst);
        EXPECT(turn > 1 - 1e-5, "shape %lu: normals differ from the gradient: %g", (unsigned long)i,
               turn);
        EXPECT(sign > 0 || q->kind == QUADRIC_HYPERBOLOID, "shape %lu: inside out",
               (unsigned long)i);
        turn = 1;
        for (uint32_t t = 0; t < m.ntris; t++) {
            const uint32_t *v = m.tri[t].v;
            V3 n = v_cross(v_sub(m.p[v[1]], m.p[v[0]]), v_sub(m.p[v[2]], m.p[v[0]]));
            double c = v_dot(v_unit(n), v_unit(v_add(m.n[v[0]], v_add(m.n[v[1]], m.n[v[2]]))));
            area += 0.5 * v_len(n);
            turn = c < turn ? c : turn;
        }
        EXPECT(turn > 0.9, "shape %lu: a triangle faces away: %g", (unsigned long)i, turn);
        EXPECT(!rows[i].area ||
                   (area > rows[i].area * (1 - 2e-3) && area < rows[i].area * (1 + 1e-6)),
               "shape %lu: area %.7g, not %.7g", (unsigned long)i, area, rows[i].area);
        mesh_clear(&m);
    }
}

/* The ellipsoid that a distorted sphere becomes: points and fronts. */
static void distorted(void)
{
    SceneFile f;
    const Geometry *g;
    double worst = 0;
    bool outward = true;

    messages_nowhere();
    f = scene_of("WorldBegin Translate 1 2 3 Scale 1 -2 3 Shape \"sphere\" "
                 "Shape \"disk\" \"float height\" .5", 2);
    g = &f.scene->geometries[0];
    REQUIRE(g->nshapes == 2 && g->shapes[0].kind == SHAPE_MESH, "shapes");
    for (uint32_t i = 0; i < g->shapes[0].count; i++)
        for (int k = 0; k < 3; k++) {
            uint32_t v = g->tri[i].v[k];
            V3 p = v_sub(g->p[v], v3(1, 2, 3));
            V3 q = v3(p.x, p.y / 2, p.z / 3);
            double e = fabs(v_len(q) - 1);
            worst = e > worst ? e : worst;
            outward = outward && v_dot(g->shapes[0].n[v], v3(q.x, q.y / 2, q.z / 3)) > 0;
        }
    EXPECT(worst < 1e-6 && outward, "off by %g", worst);
    EXPECT(g->p[g->shapes[1].first_vertex].z == 4.5f && g->shapes[1].n[0].z == 1, "the disc");
    scenefile_clear(&f);
}

static void other_shapes(void)
{
    SceneFile f = scene_of(
        "WorldBegin Shape \"heightfield\" \"integer nu\" 3 \"integer nv\" 2\n"
        "\"float Pz\" [0 1 2 3 4 5]\n"
        "Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0]\n"
        "Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 1 2 0 0 2 1 0]\n"
        "\"integer indices\" [0 1 2 3 1 4 3 5]\n"
        "Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0]\n"
        "\"normal N\" [0 0 -1 0 0 -1 0 0 -1 0 0 -1] \"point2 uv\" [0 0 2 0 0 2 2 2]\n",
        0);
    const Geometry *g = &f.scene->geometries[0];
    bool on = true;

    REQUIRE(g->nshapes == 4, "four shapes");
    REQUIRE(g->shapes[0].kind == SHAPE_TESSELLATION, "height field");
    EXPECT(tessellation_faces(g->shapes[0].as.tessellation) == 4 &&
           v_equal(tessellation_point(g->shapes[0].as.tessellation, 1, 1), v3(0.5f, 1, 4)),
           "point of a height field");
    EXPECT(g->shapes[1].count == 2, "a parallelogram is two triangles");
    EXPECT(g->shapes[2].count == 2 * 2 * 16 * 16, "two patches of 16 x 16");
    for (size_t v = g->shapes[2].first_vertex; v < g->shapes[2].first_vertex + 17u * 17; v++)
        on = on && fabsf(g->p[v].z - g->p[v].x * g->p[v].y) < 1e-6f;       /* z = x y */
    EXPECT(on, "points of a bilinear patch");
    EXPECT(g->shapes[3].n[3].z == -1 && g->shapes[3].uv[3].x == 2, "given normals and uv");
    scenefile_clear(&f);
}

/* ---- Loop subdivision ---- */

static Mesh make_mesh(const float *p, uint32_t np, const uint32_t *tri, uint32_t nt)
{
    Mesh m;
    memset(&m, 0, sizeof m);
    m.p = MEM_ARRAY(V3, np);
    m.tri = MEM_ARRAY(Tri, nt);
    REQUIRE(m.p && m.tri, "memory");
    m.nverts = np;
    m.ntris = nt;
    for (uint32_t i = 0; i < np; i++)
        m.p[i] = v3(p[3 * i], p[3 * i + 1], p[3 * i + 2]);
    for (uint32_t i = 0; i < 3 * nt; i++)
        m.tri[i / 3].v[i % 3] = tri[i];
    return m;
}

/* The limit surface does not depend on how often one subdivided on the way to it: points of the
 * first mesh's vertices, and of the first edges', come out the same, and normals of the inner ones.
 * A closed mesh and an open one, inner vertices of valence 3 and 6, boundary ones of 2 to 5. */
static void loop_limit(void)
{
    static const float p[2][30] = {
        { 1, 1, 1, -1, -1, 1, -1, 1, -1, 1, -1, -1 },
        { 0, 0, 0.3f, 1, 0, 0, 0.5f, 1, 0.2f, -0.5f, 1, 0, -1, 0, 0.5f, -0.5f, -1, 0, 0.5f, -1, 0,
          1.5f, 1, 0.4f, 2, 0, 0.1f, 2, -1, 0 }
    };
    static const uint32_t tri[2][27] = {
        { 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3 },
        { 0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 5, 0, 5, 6, 0, 6, 1, 1, 7, 2, 1, 8, 7, 8, 1, 9 }
    };
    static const uint32_t np[2] = { 4, 10 }, nt[2] = { 4, 9 };

    for (int k = 0; k < 2; k++) {
        Mesh coarse = make_mesh(p[k], np[k], tri[k], nt[k]);
        REQUIRE(loop_subdivide(&coarse, 1) == LOOP_DONE, "refused");
        for (int level = 0; level < 5; level++) {
            Mesh fine = make_mesh(p[k], np[k], tri[k], nt[k]);
            uint32_t common = level ? coarse.nverts : np[k];
            REQUIRE(loop_subdivide(&fine, level) == LOOP_DONE, "refused");
            EXPECT(fine.ntris == nt[k] << (2 * level), "mesh %d: %lu triangles", k,
                   (unsigned long)fine.ntris);
            EXPECT(!mesh_fault(&fine), "mesh %d", k);
            for (uint32_t v = 0; v < common; v++) {
                EXPECT(v_near(fine.p[v], coarse.p[v], 1e-6f),
                       "mesh %d, level %d: vertex %lu moves to %g %g %g from %g %g %g", k,
                       level, (unsigned long)v, fine.p[v].x, fine.p[v].y, fine.p[v].z,
                       coarse.p[v].x, coarse.p[v].y, coarse.p[v].z);
                EXPECT((k == 1 && v > 0) || v_near(fine.n[v], coarse.n[v], 1e-5f),
                       "mesh %d, level %d: normal %lu turns", k, level, (unsigned long)v);
            }
            mesh_clear(&fine);
        }
        mesh_clear(&coarse);
    }
}

/* Normals of the limit: those of a fine mesh's triangles tend to them; a plane's are exact. */
static void loop_normals(void)
{
    static const float p[] = { 1, 1, 1, -1, -1, 1, -1, 1, -1, 1, -1, -1 };
    static const uint32_t tri[] = { 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3 };
    static const float flat[] = { 0, 0, 0, 1, 0, 0, 0.5f, 1, 0, -0.5f, 1, 0, -1, 0, 0, -0.5f, -1, 0,
                                  0.7f, -1, 0 };
    static const uint32_t fan[] = { 0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 5, 0, 5, 6 };
    Mesh m = make_mesh(p, 4, tri, 4);
    float least = 1;

    REQUIRE(loop_subdivide(&m, 5) == LOOP_DONE, "refused");
    for (uint32_t t = 0; t < m.ntris; t++) {
        const uint32_t *v = m.tri[t].v;
        V3 n = v_unit(v_cross(v_sub(m.p[v[1]], m.p[v[0]]), v_sub(m.p[v[2]], m.p[v[0]])));
        for (int k = 0; k < 3; k++)
            least = f_min(least, v_dot(n, m.n[v[k]]));
    }
    /* A facet turns from its corners' normals by about half the angle that 1/32 of an edge spans:
     * an eighth of the sphere's 109 degrees over 32 steps, twice for the strong curvature. */
    EXPECT(least > 0.99f, "a facet and its corner's normal: cosine %g", least);
    EXPECT(v_near(m.p[0], v3(0.2f, 0.2f, 0.2f), 1e-6f), "limit of a vertex of valence 3");
    mesh_clear(&m);
    m = make_mesh(flat, 7, fan, 5);
    REQUIRE(loop_subdivide(&m, 2) == LOOP_DONE, "refused");
    for (uint32_t v = 0; v < m.nverts; v++)
        EXPECT(v_equal(m.n[v], v3(0, 0, 1)), "normal %lu of a flat fan is %g %g %g",
               (unsigned long)v, m.n[v].x, m.n[v].y, m.n[v].z);
    mesh_clear(&m);
}

/* Meshes without a front: an edge of three triangles, neighbours that disagree, a bow tie, a corner
 * used twice. They are refused and stay as they were. */
static void loop_manifold(void)
{
    static const float p[] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1 };
    static const uint32_t tri[4][9] = {
        { 0, 1, 2, 1, 0, 3, 0, 1, 4 }, { 0, 1, 2, 0, 1, 3, 2, 1, 4 }, { 0, 1, 2, 0, 3, 4, 1, 3, 2 },
        { 0, 1, 2, 1, 1, 3, 2, 1, 4 }
    };
    SceneFile f;

    for (int k = 0; k < 4; k++) {
        Mesh m = make_mesh(p, 5, tri[k], k == 2 ? 2 : 3);
        EXPECT(loop_subdivide(&m, 2) == LOOP_NOT_MANIFOLD, "mesh %d was taken", k);
        EXPECT(m.nverts == 5 && m.ntris == (k == 2 ? 2u : 3u) && !m.n, "mesh %d was changed", k);
        mesh_clear(&m);
    }
    messages_nowhere();
    f = scene_of("WorldBegin Shape \"loopsubdiv\" \"point3 P\" [0 0 0 1 0 0 0 1 0 0 0 1 1 1 1]"
                 "\"integer indices\" [0 1 2 0 3 4]", 1);
    EXPECT(scene_shape(&f, 0)->count == 2, "the control mesh is used");
    scenefile_clear(&f);
}

const TestCase test_scenefile_shapes[] = {
    { "fronts", fronts, false },
    { "mesh_arrays", mesh_arrays, false },
    { "quadrics", quadrics, false },
    { "distorted", distorted, false },
    { "other_shapes", other_shapes, false },
    { "loop_limit", loop_limit, false },
    { "loop_normals", loop_normals, false },
    { "loop_manifold", loop_manifold, false },
    { NULL, NULL, false }
};

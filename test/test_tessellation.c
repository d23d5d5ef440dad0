/* test_tessellation.c -- regular tessellations: where points and triangles are, that boxes over
 * them lose no hit of a plain loop, bit for bit, that closed ones are closed, how they are shaded,
 * and what they take of memory. test_rays.c has them among other things, in instances, under every
 * accelerator. */
#include "base/mem.h"
#include "geometry/image_shapes.h"
#include "test/cli_help.h"
#include "test/ray_help.h"

#include <stdio.h>
#include <string.h>

static const ShapeTraits plain = { 0, NO_LIGHT, false };

/* ---- making some ---- */

typedef enum { FLAT, WAVES, NOISE, SPIKES, STEPS, COLLAPSED, FIELDS } FieldKind;

static float height_of(FieldKind kind, uint32_t x, uint32_t y, Rng *rng)
{
    float noise = rng_unit(rng);

    switch (kind) {
    case FLAT:   return 0.25f;
    case WAVES:  return 0.2f * (float)md_sin(0.7 * x + 0.4 * y);
    case NOISE:  return noise;
    case SPIKES: return noise < 0.1f ? 1000.0f * noise : 0.0f;
    case STEPS:  return (float)(rng_below(rng, 3));
    default:     return 0.0f;
    }
}

/* A field of nu x nv points, turned and placed; COLLAPSED: the map leaves a line of it. */
static void field(Geometry *g, bool triangular, uint32_t nu, uint32_t nv, FieldKind kind, int bits,
                  const Where *where, Rng *rng)
{
    Transform s = xf_scale(where->scale, where->scale * (kind == COLLAPSED ? 0 : 1), where->scale);
    Transform turn = xf_rotate(kind == FLAT ? 90 * rng_below(rng, 4) : 360 * rng_unit(rng),
                               kind == FLAT, 0.3 * (kind != FLAT), 1 - 1.0 * (kind == FLAT));
    Transform move = xf_translate(where->offset.x, where->offset.y, where->offset.z), map;
    Tessellation t;
    size_t i = 0;

    map = xf_then(&turn, &s);
    map = xf_then(&move, &map);
    memset(g, 0, sizeof *g);
    REQUIRE(tessellation_init(&t, triangular, nu, nv, &map), "memory");
    for (uint32_t y = 0; y < nv; y++)
        for (uint32_t x = 0; x < (triangular ? y + 1 : nu); x++)
            t.values[i++] = height_of(kind, x, y, rng);
    REQUIRE(tessellation_finish(&t, bits) && geometry_add_tessellation(g, &t, plain, NULL) &&
            geometry_finish(g), "memory");
}

static const Tessellation *only(const Geometry *g) { return g->shapes[0].as.tessellation; }

static Accel *build(const Geometry *g, const char *options)
{
    static Arena arena;
    const AccelKind *kind = kind_find(accels, "lbvh");
    Accel *a;
    Opts o;

    opts_default(&o, kind->info.options);
    REQUIRE(opts_parse(&o, "lbvh", options, &arena), "%s", options);
    a = accel_build_as_is(kind, g, &o, 1);
    REQUIRE(a != NULL, "memory");
    return a;
}

/* ---- points and triangles ---- */

static void check_places(const Tessellation *t)
{
    uint32_t faces = tessellation_faces(t), n = 0;
    size_t points = 0;

    for (uint32_t y = 0; y < t->nv; y++)
        for (uint32_t x = 0; x < (t->triangular ? y + 1 : t->nu); x++)
            EXPECT(tessellation_index(t, x, y) == points++, "(%lu, %lu)", (unsigned long)x,
                   (unsigned long)y);
    EXPECT(points == tessellation_points(t), "%lu points", (unsigned long)points);
    for (uint32_t y = 0; y + 1 < t->nv; y++) {
        uint32_t row = t->triangular ? 2 * y + 1 : 2 * (t->nu - 1);
        for (uint32_t k = 0; k < row; k++, n++) {
            uint32_t face = tessellation_face(t, y, k);
            GridPoint at[3];
            double area;
            V3 c[3];
            EXPECT(face == (t->triangular ? n : n ^ 1), "face %lu", (unsigned long)face);
            tessellation_places(t, face, at);
            tessellation_corners(t, face, c);
            area = ((double)at[1].x - at[0].x) * ((double)at[2].y - at[0].y) -
                   ((double)at[1].y - at[0].y) * ((double)at[2].x - at[0].x);
            EXPECT(area == 1, "face %lu is not counter-clockwise", (unsigned long)face);
            for (uint32_t i = 0; i < 3; i++) {
                V3 p = tessellation_strip(t, y, k + i);
                int same = 0;
                for (int j = 0; j < 3; j++)
                    same += !memcmp(&p, &c[j], 3 * sizeof(float));
                EXPECT(same >= 1 && at[i].y >= y && at[i].y <= y + 1, "strip of row %lu",
                       (unsigned long)y);
            }
        }
    }
    EXPECT(n == faces, "%lu triangles, expected %lu", (unsigned long)n, (unsigned long)faces);
}

static void places(void)
{
    Rng rng = rng_seed(3);

    for (uint32_t n = 2; n <= 34; n++)
        for (int triangular = 0; triangular < 2; triangular++) {
            Geometry g;
            field(&g, triangular, triangular ? n : 1 + n / 2 + rng_below(&rng, 9), n, NOISE, 32,
                  places_sane, &rng);
            check_places(only(&g));
            geometry_clear(&g);
        }
}

/* ---- the hierarchy ---- */

/* Nodes of four siblings each and a root, by halving the regions upwards. */
static uint64_t nodes_expected(const Tessellation *t, uint32_t leaf)
{
    uint64_t w = t->nu - 1, h = t->nv - 1, groups = 0, side = 1;

    if (t->triangular) {                        /* a full tree over sides of 2^k leaves */
        while (side * leaf < w)
            side *= 2;
        return (4 * side * side - 1) / 3;
    }
    w = (w + leaf - 1) / leaf;
    h = (h + leaf - 1) / leaf;
    while (w > 1 || h > 1) {
        w = (w + 1) / 2;
        h = (h + 1) / 2;
        groups += w * h;
    }
    return 4 * groups + 1;
}

/* Nodes by the formula; 12 or 6 bytes for each but the root; and little else, beside what a
 * structure over nothing takes. */
static void check_tree(const Geometry *g, int bits, uint32_t leaf, uint32_t side)
{
    const Tessellation *t = only(g);
    char options[40], why[120] = "";
    Geometry empty;
    Accel *a, *none;
    uint64_t nodes = nodes_expected(t, side), rest;

    memset(&empty, 0, sizeof empty);
    REQUIRE(geometry_finish(&empty), "memory");
    snprintf(options, sizeof options, "bits=%d,leaf=%d", bits, (int)leaf);
    a = build(g, options);
    none = build(&empty, options);
    EXPECT(accel_validate(a, why, sizeof why), "%lu x %lu, %s: %s", (unsigned long)t->nu,
           (unsigned long)t->nv, options, why);
    EXPECT(a->nodes == nodes + 1, "%lu x %lu, %s: %lu nodes, expected %lu", (unsigned long)t->nu,
           (unsigned long)t->nv, options, (unsigned long)a->nodes - 1, (unsigned long)nodes);
    rest = a->bytes - none->bytes - (nodes - 1) * 6 * (uint64_t)bits / 8;
    EXPECT(rest < 600, "%lu bytes beside the nodes", (unsigned long)rest);
    accel_free(a);
    accel_free(none);
    geometry_clear(&empty);
}

/* Every side, those of 2^k among them, and long ones. */
static void trees(void)
{
    static const struct { uint32_t leaf, rectangular, triangular; } side[4] = {
        { 1, 1, 1 }, { 4, 1, 2 }, { 8, 2, 2 }, { 64, 4, 8 }
    };
    Rng rng = rng_seed(4);

    for (uint32_t n = 2; n <= 34; n++)
        for (int triangular = 0; triangular < 2; triangular++) {
            Geometry g;
            uint32_t nu = triangular ? n : n % 5 == 0 ? 2 + rng_below(&rng, 70) : n;
            field(&g, triangular, nu, n, NOISE, 32, places_sane, &rng);
            for (int k = 0; k < 4; k++)
                for (int bits = 8; bits <= 16; bits += 8)
                    check_tree(&g, bits, side[k].leaf,
                               triangular ? side[k].triangular : side[k].rectangular);
            geometry_clear(&g);
        }
}

/* A check that can fail: one point moved out of its boxes. */
static void noticed(void)
{
    Rng rng = rng_seed(5);
    Geometry g;
    char why[120] = "";
    Accel *a;

    field(&g, false, 9, 9, NOISE, 32, places_sane, &rng);
    a = build(&g, "");
    for (size_t i = 0; i < tessellation_points(only(&g)); i++) {
        float *v = &only(&g)->values[i], old = *v;
        *v = 1.5f;
        EXPECT(!accel_validate(a, why, sizeof why) && *why, "point %lu moved", (unsigned long)i);
        *v = old;
    }
    EXPECT(accel_validate(a, why, sizeof why), "all as it was: %s", why);
    accel_free(a);
    geometry_clear(&g);
}

/* ---- against a plain loop ---- */

enum { FORMS = 6 };
static const char *const forms[FORMS] = { "bits=16,leaf=1", "bits=8,leaf=1", "bits=16,leaf=4",
                                          "bits=8,leaf=8", "bits=16,leaf=64", "bits=8,leaf=32" };

static void compare(const Accel *brute, const Accel *a, const Ray *r, const char *what)
{
    Hit want, got;
    Steps steps = { 0, 0 };
    bool is;

    memset(&want, 0x5A, sizeof want);
    memset(&got, 0x5A, sizeof got);
    is = accel_nearest(brute, r, &want);
    EXPECT(a->kind->nearest(a, r, &got, &steps) == is && !memcmp(&want, &got, sizeof got),
           "%s: another hit for ray %s", what, ray_text(r));
    EXPECT(steps.nodes <= a->nodes && steps.prims <= prims_most(a), "%s: too many steps", what);
    EXPECT(accel_blocked(a, r) == is && accel_blocked(brute, r) == is, "%s: blocked differs for %s",
           what, ray_text(r));
    if (is)
        EXPECT(want.outer == 0 && want.prim >= 1 && want.prim < 1 + a->geo->nfaces, "%s: face %lu",
               what, (unsigned long)want.prim);
}

static void compare_all(const Geometry *g, uint32_t rays, uint64_t seed, const char *what)
{
    Accel *brute = setting_build(setting_brute(), g), *a[FORMS];
    RayMaker m = ray_maker(g, brute, seed);

    for (int k = 0; k < FORMS; k++)
        a[k] = build(g, forms[k]);
    for (uint32_t i = 0; i < rays * (test_is_long() ? 100 : 1); i++) {
        Ray r = ray_make(&m, (RayClass)(i % RAY_CLASSES));
        compare(brute, a[i / RAY_CLASSES % FORMS], &r, what);
    }
    for (int k = 0; k < FORMS; k++)
        accel_free(a[k]);
    accel_free(brute);
}

static void every_side(void)
{
    Rng rng = rng_seed(6);

    for (uint32_t n = 2; n <= 34; n++)
        for (int k = 0; k < 4; k++) {
            bool triangular = k & 1;
            FieldKind kind = (FieldKind)((n + 3 * (uint32_t)k) % FIELDS);
            char what[60];
            Geometry g;
            field(&g, triangular, triangular || n % 3 ? n : 36 - n, n, kind, k & 2 ? 16 : 32,
                  places_sane, &rng);
            snprintf(what, sizeof what, "side %d, kind %d.%d", (int)n - 1, k, (int)kind);
            compare_all(&g, 336, 10 * n + (uint32_t)k, what);
            geometry_clear(&g);
        }
}

static void every_place(void)
{
    Rng rng = rng_seed(7);

    for (uint64_t place = 0; place < PLACES_SANE; place++)
        for (int kind = 0; kind < FIELDS; kind++)
            for (int k = 0; k < 2; k++) {
                char what[60];
                Geometry g;
                field(&g, k, k ? 14 : 12, k ? 14 : 17, (FieldKind)kind, kind & 1 ? 16 : 32,
                      &places_sane[place], &rng);
                snprintf(what, sizeof what, "place %d, field %d.%d", (int)place, kind, k);
                compare_all(&g, 420, 100 * place + (uint64_t)(10 * kind + k), what);
                geometry_clear(&g);
            }
}

/* Boxes that overflow, or nearly: one leaf of all, or the last planes of floats. */
static void extreme(void)
{
    static const Where huge[4] = { { 1e38, { 0, 0, 0 } }, { 3e38, { 0, 0, 0 } },
                                   { 1e-40, { 0, 0, 0 } }, { 1e30, { 3e38f, 0, 0 } } };
    Rng rng = rng_seed(8);

    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 2; k++) {
            Geometry g;
            field(&g, k, 10, 10, WAVES, 32, &huge[i], &rng);
            compare_all(&g, 700, (uint64_t)(2 * i + k), "extreme");
            geometry_clear(&g);
        }
}

/* ---- closed ones ---- */

typedef struct { const char *name; bool torus; ImageForm form; } Closed;

static void make_closed(Geometry *g, const Closed *c, const Where *where, int bits)
{
    Transform s = xf_scale(where->scale, where->scale, where->scale);
    Transform turn = xf_rotate(37, 1, 2, 3);
    Transform place = xf_translate(where->offset.x, where->offset.y, where->offset.z);
    ImageForm f = c->form;
    Tessellation t;

    place = xf_then(&place, &turn);
    place = xf_then(&place, &s);
    f.bits = bits;
    f.place = &place;
    memset(g, 0, sizeof *g);
    REQUIRE((c->torus ? image_torus(&t, f, 1.0f, 0.5f) : image_sphere(&t, f, 1.0f)) &&
            geometry_add_tessellation(g, &t, plain, NULL) && geometry_finish(g), "memory");
}

/* Signed volume: positive if fronts are outside; and each edge is shared, if the sums of the
 * triangles' area vectors vanish. */
static void check_closed(const Geometry *g, const char *what)
{
    double volume = 0, size = 0;
    D3 sum = { 0, 0, 0 };
    V3 c0[3];

    tessellation_corners(only(g), 0, c0);
    for (uint32_t i = 0; i < tessellation_faces(only(g)); i++) {
        D3 n, at;
        V3 c[3];
        tessellation_corners(only(g), i, c);
        n = d3_cross(d3_sub(d3(c[1]), d3(c[0])), d3_sub(d3(c[2]), d3(c[0])));
        at = d3_sub(d3(c[0]), d3(c0[0]));
        volume += d3_dot(n, at);
        size += sqrt(d3_dot(n, n));
        sum = (D3){ sum.x + n.x, sum.y + n.y, sum.z + n.z };
    }
    EXPECT(volume > 0, "%s: inside out", what);
    EXPECT(fabs(sum.x) + fabs(sum.y) + fabs(sum.z) < 1e-12 * size, "%s: not closed", what);
}

/* From near a point well within, at points of the grid and of edges. */
static void shoot_out(const Geometry *g, const Accel *a, const Where *where, const Closed *c,
                      uint32_t rays, const char *what)
{
    const Tessellation *t = only(g);
    Transform turn = xf_rotate(37, 1, 2, 3);
    uint64_t lost = 0;
    Rng rng = rng_seed(9);

    for (uint32_t i = 0; i < rays; i++) {
        float x = 1, y = 0, w = i & 1 ? 0.0f : rng_unit(&rng);
        Ray r = { .o = { 0, 0, 0 }, .d = { 0, 0, 0 }, .tmax = INFINITY };
        uint32_t k = rng_below(&rng, 3);
        V3 corner[3];
        Hit h;
        m_sincos_turn(rng_unit(&rng), &y, &x);
        r.o = v_scale(rng_direction(&rng), 0.3f * rng_unit(&rng));
        if (c->torus)
            r.o = v_add(r.o, xf_vector(&turn, v3(x, y, 0)));
        r.o = v_mad(r.o, (float)where->scale, where->offset);
        tessellation_corners(t, rng_below(&rng, tessellation_faces(t)), corner);
        r.d = v_sub(blend(corner[k], corner[(k + 1) % 3], corner[0], v3(1.0f - w, w, 0.0f)), r.o);
        if (i & 2)
            r.d = v_unit(r.d);
        lost += !accel_nearest(a, &r, &h) || !accel_blocked(a, &r);
    }
    EXPECT(!lost, "%s, place %g at %g: %lu of %lu rays lost", what, where->scale,
           (double)where->offset.x, (unsigned long)lost, (unsigned long)rays);
}

static void closed(void)
{
    static const Closed bodies[5] = {
        { "sphere", false, { false, 32, 0, NULL } },
        { "odd sphere", false, { false, 21, 0, NULL } },
        { "triangular sphere", false, { true, 32, 0, NULL } },
        { "odd triangular sphere", false, { true, 27, 0, NULL } },
        { "torus", true, { false, 40, 0, NULL } }
    };
    uint32_t rays = test_is_long() ? 150000 : 3000;

    for (int b = 0; b < 5; b++)
        for (int place = 0; place < PLACES_SANE; place++)
            for (int bits = 16; bits <= 32; bits += 16) {
                const Where *where = &places_sane[place];
                Geometry g;
                make_closed(&g, &bodies[b], where, bits);
                check_closed(&g, bodies[b].name);
                for (int k = 2; k < 4; k++) {
                    Accel *a = build(&g, forms[k]);
                    shoot_out(&g, a, where, &bodies[b], rays, bodies[b].name);
                    accel_free(a);
                }
                geometry_clear(&g);
            }
}

/* ---- shading ---- */

/* Normals of a sphere lean off the radius by less than a cell; the point is on a triangle. */
static void shaded(void)
{
    Rng rng = rng_seed(10);

    for (int k = 0; k < 4; k++) {
        Closed c = { "sphere", false, { k & 1, 64, 0, NULL } };
        Geometry g;
        Accel *a;
        double worst = 0, mean = 0;
        make_closed(&g, &c, places_sane, 32);
        g.shapes[0].flip = k & 2;
        a = build(&g, "");
        for (int i = 0; i < 3000; i++) {
            Ray r = { .o = { 0, 0, 0 }, .d = { 0, 0, 0 }, .tmax = INFINITY };
            Surface s;
            double off;
            Hit h;
            r.d = rng_direction(&rng);
            REQUIRE(accel_nearest(a, &r, &h), "lost");
            accel_surface(a, &r, &h, &s);
            off = 1 - v_dot(s.ns, s.p) * (k & 2 ? -1 : 1);
            worst = off > worst ? off : worst;
            mean += off / 3000;
            EXPECT(v_dot(s.ns, s.ng) > 0 && s.shape == &g.shapes[0] && s.prim == h.prim &&
                   v_max3(s.err) < 1e-5f && v_len(v_sub(s.p, v_scale(r.d, h.t))) < 1e-6f,
                   "surface");
            EXPECT(s.uv.x >= 0 && s.uv.x <= 1 && s.uv.y >= 0 && s.uv.y <= 1, "uv");
        }
        EXPECT(mean < 2e-3 && worst < 0.01, "kind %d: normals off by %g, at worst %g", k, mean,
               worst);
        accel_free(a);
        geometry_clear(&g);
    }
}

/* A height field gives the picture of the same field as a mesh, byte for byte: as a thing with a
 * texture, turned round, mirrored, as an instance, and as a lamp. */
static const char STAGE[] =
    "LookAt 0.4 -5 2.2  0 0 0.6  0 0 1\nCamera \"perspective\" \"float fov\" 38\n"
    "Film \"rgb\" \"integer xresolution\" 24 \"integer yresolution\" 16\n"
    "Sampler \"zerotwo\" \"integer pixelsamples\" 4\nWorldBegin\n"
    "LightSource \"infinite\" \"rgb L\" [ 0.3 0.4 0.5 ]\n"
    "Texture \"squares\" \"spectrum\" \"checkerboard\" \"float uscale\" 5 \"float vscale\" 5\n"
    "Material \"diffuse\" \"texture reflectance\" \"squares\"\n"
    "AttributeBegin Translate -2 -2 -0.2 Scale 4 4 0.6 %s AttributeEnd\n"
    "AttributeBegin Translate 0 0 1 Rotate 50 1 1 0 Scale 1 -1 1 %s AttributeEnd\n"
    "ObjectBegin \"o\" Translate 0.5 0 0 %s ObjectEnd\n"
    "AttributeBegin Rotate 20 0 1 0 ObjectInstance \"o\" AttributeEnd\n"
    "AttributeBegin Translate -1 -1 1 ReverseOrientation\n"
    "AreaLightSource \"diffuse\" \"rgb L\" [ 4 3 2 ] %s AttributeEnd\n";

static void render(const char *shape, const char *file)
{
    static char text[6000];
    snprintf(text, sizeof text, STAGE, shape, shape, shape, shape);
    cli_write_text("s.pbrt", text);
    CLI_WORKS("%s --quiet -o %s", cli_path("s.pbrt"), cli_path(file));
}

static void as_mesh(void)
{
    static const char height[12][4] = { ".1", ".3", "0", ".2", ".5", ".4", ".2", ".7", ".3", "0",
                                        ".1", ".9" };
    char field[300] = "Shape \"heightfield\" \"integer nu\" 4 \"integer nv\" 3 \"float Pz\" [",
         mesh[1200] = "Shape \"trianglemesh\" \"integer indices\" [", one[100];

    for (int i = 0; i < 12; i++)
        strcat(strcat(field, " "), height[i]);
    for (int cell = 0; cell < 6; cell++) {
        int a = cell / 3 * 4 + cell % 3;
        snprintf(one, sizeof one, " %d %d %d %d %d %d", a, a + 1, a + 5, a, a + 5, a + 4);
        strcat(mesh, one);
    }
    strcat(mesh, " ] \"point3 P\" [");
    for (int i = 0; i < 12; i++) {
        snprintf(one, sizeof one, " %.9g %.9g %s", i % 4 / 3.0, i / 4 / 2.0, height[i]);
        strcat(mesh, one);
    }
    strcat(mesh, " ] \"point2 uv\" [");
    for (int i = 0; i < 12; i++) {
        snprintf(one, sizeof one, " %.9g %.9g", i % 4 / 3.0, i / 4 / 2.0);
        strcat(mesh, one);
    }
    render(strcat(field, " ]"), "field.pfm");
    render(strcat(mesh, " ]"), "mesh.pfm");
    EXPECT(cli_same_file("field.pfm", "mesh.pfm"), "a height field is not drawn as its mesh is");
}

/* ---- as lists ---- */

/* A mesh of one triangle a vertex pair, with normals, so that what is copied has a length. */
static void add_strip(Geometry *g, uint32_t n, float z)
{
    Mesh m;

    REQUIRE(mesh_grid(&m, n, 1), "memory");
    m.n = MEM_ARRAY(V3, m.nverts);
    REQUIRE(m.n, "memory");
    for (uint32_t i = 0; i < m.nverts; i++) {
        m.p[i].z = z;
        m.n[i] = v3((float)i, z, 1);
    }
    REQUIRE(geometry_add_mesh(g, &m, plain, NULL), "memory");
}

static void same_corners(const Geometry *g, uint32_t a, const Geometry *h, uint32_t b)
{
    V3 c[3], d[3];

    geometry_face(g, a, c);
    geometry_face(h, b, d);
    EXPECT(!memcmp(c, d, sizeof c), "triangle %lu is not %lu of the list", (unsigned long)a,
           (unsigned long)b);
}

/* Meshes, a disc and tessellations in turn: the copy shares nothing, and the list has the meshes'
 * triangles first, then those of the tessellations by their numbers; a copy of it is good, too. */
static void listed(void)
{
    Geometry g, copy, again;
    Tessellation t;
    Disk d;
    Transform map = xf_rotate(33, 1, 2, 3);

    memset(&g, 0, sizeof g);
    REQUIRE(disk_init(&d, &map, 0, 1, 0, 360), "a disc");
    REQUIRE(image_patch(&t, (ImageForm){ true, 5, 16, NULL }) &&
            geometry_add_tessellation(&g, &t, plain, NULL), "memory");
    add_strip(&g, 3, 0.25f);
    REQUIRE(geometry_add_disk(&g, &d, plain, NULL) &&
            image_torus(&t, (ImageForm){ false, 6, 32, NULL }, 2, 0.5f) &&
            geometry_add_tessellation(&g, &t, plain, NULL), "memory");
    add_strip(&g, 2, 0.5f);
    REQUIRE(geometry_finish(&g) && geometry_copy(&copy, &g) && geometry_copy(&again, &copy),
            "memory");
    geometry_clear(&copy);
    REQUIRE(geometry_list(&again) && geometry_copy(&copy, &again), "memory");
    geometry_clear(&again);
    EXPECT(copy.ntris == 10 + 25 + 72 && copy.nodd == 1 && !copy.nfaces && copy.nmeshes == 4 &&
           geometry_shape(&copy, 107)->kind == SHAPE_DISK, "%lu triangles",
           (unsigned long)copy.ntris);
    for (uint32_t i = 0; i < 10; i++)
        same_corners(&g, i, &copy, i);
    for (uint32_t i = 0; i < 25 + 72; i++)
        same_corners(&g, 10 + 3 + i, &copy, 10 + i);
    EXPECT(geometry_shape(&copy, 9)->n[5].x == 5, "normals of the second mesh");
    geometry_clear(&copy);
    geometry_clear(&g);
}

/* ---- memory ---- */

/* [Cline07 3.2.2]: a height field of floats takes just over 2 bytes a triangle, a geometry image
 * just over 6. Boxes: 4/3 nodes a leaf, of 12 or 6 bytes. (Table 3.1 has no tessellations.) */
static void memory(void)
{
    static const struct {
        bool heights, triangular;
        int bits;
        double geometry, shorts, bytes;
    } row[6] = {
        { true, false, 32, 2, 8, 4 }, { true, false, 16, 1, 8, 4 }, { false, false, 32, 6, 8, 4 },
        { false, false, 16, 3, 8, 4 }, { true, true, 32, 2, 4, 2 }, { false, true, 32, 6, 4, 2 }
    };
    enum { SIDE = 512 };

    for (int i = 0; i < 6; i++) {
        Transform map = xf_identity();
        Tessellation t;
        Geometry g;
        double faces, points;
        memset(&g, 0, sizeof g);
        REQUIRE(tessellation_init(&t, row[i].triangular, SIDE + 1, SIDE + 1,
                                  row[i].heights ? &map : NULL) &&
                tessellation_finish(&t, row[i].bits), "memory");
        faces = tessellation_faces(&t);
        points = (double)tessellation_bytes(&t) / faces;
        EXPECT(points > row[i].geometry && points < 1.006 * row[i].geometry,
               "row %d: %g bytes of points a triangle, expected %g", i, points, row[i].geometry);
        REQUIRE(geometry_add_tessellation(&g, &t, plain, NULL) && geometry_finish(&g), "memory");
        for (int bits = 8; bits <= 16; bits += 8) {
            Accel *a = build(&g, bits == 8 ? "bits=8" : "bits=16");
            double want = bits == 8 ? row[i].bytes : row[i].shorts;
            double have = (double)a->bytes / faces;
            printf("row %d, %d bits: %.3f bytes of points and %.3f of boxes a triangle\n", i, bits,
                   points, have);
            EXPECT(fabs(have - want) < 0.01 * want, "row %d: %g bytes of boxes, expected %g", i,
                   have, want);
            accel_free(a);
        }
        geometry_clear(&g);
    }
}

/* Wherever memory runs out, nothing is left behind. */
static void out_of_memory(void)
{
    const AccelKind *kind = kind_find(accels, "lbvh");
    Opts usual;

    opts_default(&usual, kind->info.options);
    for (int bits = 16; bits <= 32; bits += 16) {
        long before = mem_blocks();
        unsigned long k = 1;
        bool done = false;
        for (; !done; k++) {
            Accel *a = NULL;
            Tessellation t;
            Geometry g;
            memset(&g, 0, sizeof g);
            mem_fail_at(k, k % 2);
            if (image_sphere(&t, (ImageForm){ false, 8, bits, NULL }, 1.0f)) {
                if (geometry_add_tessellation(&g, &t, plain, NULL) && geometry_finish(&g))
                    a = accel_build_as_is(kind, &g, &usual, 1);
                tessellation_clear(&t);
            }
            mem_fail_at(0, false);
            done = a != NULL;
            accel_free(a);
            geometry_clear(&g);
            EXPECT(mem_blocks() == before, "blocks left after failure %lu", k);
            REQUIRE(k < 100, "never succeeds");
        }
        EXPECT(k > 8, "only %lu requests", k);
    }
}

const TestCase test_tessellation[] = {
    { "places", places, false }, { "trees", trees, false }, { "noticed", noticed, false },
    { "every_side", every_side, false }, { "every_place", every_place, false },
    { "extreme", extreme, false }, { "closed", closed, false }, { "shaded", shaded, false },
    { "as_mesh", as_mesh, false }, { "listed", listed, false }, { "memory", memory, false },
    { "out_of_memory", out_of_memory, false },
    { NULL, NULL, false }
};

/* test_rays.c -- every accelerator gives the answer of `brute`, bit for bit: the same hit or miss,
 * the same t, u, v and primitive (equal t go to the smaller number, so there is one right answer),
 * and `blocked` exactly where there is a hit. Each in every setting, singly, in batches and
 * counted, over a zoo of meshes and worlds. Also that no query does more steps than there are nodes
 * and primitives. */
#include "test/ray_help.h"

#include "base/file.h"
#include "geometry/image_shapes.h"
#include "geometry/meshfile.h"
#include "scene/scene.h"

#include <stdio.h>
#include <string.h>

enum { BATCH = 512, SHOT_MOST = 200 };

typedef struct {
    Ray  ray[BATCH];
    Hit  hit[BATCH];            /* of brute */
    bool is[BATCH];
    size_t n;
    RayClass class;
} Batch;

/* One thing to shoot at. */
typedef struct {
    const char *name;
    const Accel *brute;
    Accel *accel[SHOT_MOST];          /* owned, beside their settings */
    const Setting *setting;
    int turn;                   /* whose turn it is for the rarer questions */
    uint64_t rays, hits, wrong[RAY_CLASSES];
    bool flat;                  /* no instances: steps have a bound */
} Target;

static void mismatch(Target *t, int k, const Batch *b, size_t i, const char *what)
{
    t->wrong[b->class]++;
    test_fail(__FILE__, __LINE__, "%s, %s, %s: %s for ray %s", t->name, t->setting[k].name,
              ray_class_names[b->class], what, ray_text(&b->ray[i]));
}

/* What a miss leaves behind must be what was there before. */
static Hit untouched(void)
{
    Hit h;
    memset(&h, 0x5A, sizeof h);
    return h;
}

static void check_nearest(Target *t, int k, const Batch *b)
{
    static Hit many[BATCH];
    static bool is_many[BATCH];
    const Accel *a = t->accel[k];

    for (size_t i = 0; i < b->n; i++)
        many[i] = untouched();
    accel_nearest_many(a, b->ray, many, is_many, b->n);
    for (size_t i = 0; i < b->n; i++) {
        if (is_many[i] != b->is[i] || memcmp(&many[i], &b->hit[i], sizeof many[i]))
            mismatch(t, k, b, i, "another hit");
    }
}

/* The other two ways to ask: singly, and with counts of steps. */
static void check_counted(Target *t, int k, const Batch *b)
{
    const Accel *a = t->accel[k];

    for (size_t i = 0; i < b->n; i++) {
        Steps steps = { 0, 0 };
        Hit h = untouched(), single = untouched();
        if (a->kind->nearest(a, &b->ray[i], &h, &steps) != b->is[i] ||
            memcmp(&h, &b->hit[i], sizeof h))
            mismatch(t, k, b, i, "another hit when steps are counted");
        if (i % 4 == 0 && (accel_nearest(a, &b->ray[i], &single) != b->is[i] ||
                           memcmp(&single, &b->hit[i], sizeof single)))
            mismatch(t, k, b, i, "another hit for the single ray");
        if (t->flat && (steps.nodes > a->nodes || steps.prims > prims_most(a)))
            mismatch(t, k, b, i, "too many steps");
    }
}

static void check_blocked(Target *t, int k, const Batch *b)
{
    static bool many[BATCH];
    const Accel *a = t->accel[k];

    accel_blocked_many(a, b->ray, many, b->n);
    for (size_t i = 0; i < b->n; i++) {
        Steps steps = { 0, 0 };
        if (a->kind->blocked(a, &b->ray[i], &steps) != b->is[i])
            mismatch(t, k, b, i, "blocked differs");
        if (many[i] != b->is[i])
            mismatch(t, k, b, i, "blocked differs in a batch");
        if (t->flat && (steps.nodes > a->nodes || steps.prims > prims_most(a)))
            mismatch(t, k, b, i, "too many steps");
    }
}

static void check_batch(Target *t, RayMaker *m, Batch *b)
{
    for (size_t i = 0; i < b->n; i++) {
        b->ray[i] = ray_make(m, b->class);
        b->hit[i] = untouched();
        b->is[i] = accel_nearest(t->brute, &b->ray[i], &b->hit[i]);
        t->hits += b->is[i];
        if (i % 8 == 0 && accel_blocked(t->brute, &b->ray[i]) != b->is[i])
            test_fail(__FILE__, __LINE__, "%s: brute is blocked otherwise for ray %s", t->name,
                      ray_text(&b->ray[i]));
    }
    for (int k = 0; t->accel[k]; k++)
        check_nearest(t, k, b);
    for (int k = 0; k < 2; k++) {
        check_counted(t, t->turn, b);
        check_blocked(t, t->turn, b);
        t->turn = t->accel[t->turn + 1] ? t->turn + 1 : 0;
    }
    t->rays += b->n;
}

/* Shoots `rays` rays of every class in turn. */
static void shoot(Target *t, uint64_t rays, uint64_t seed)
{
    static Batch b;
    RayMaker m = ray_maker(t->brute->geo, t->brute, seed);
    uint64_t left = rays * (test_is_long() ? 5 : 1);

    for (int c = 0; left > 0; c = (c + 1) % RAY_CLASSES) {
        b.class = (RayClass)c;
        b.n = left < BATCH ? (size_t)left : BATCH;
        check_batch(t, &m, &b);
        left -= b.n;
    }
    printf("%s: %lu rays, %lu hits, wrong:", t->name, (unsigned long)t->rays,
           (unsigned long)t->hits);
    for (int c = 0; c < RAY_CLASSES; c++)
        printf(" %lu", (unsigned long)t->wrong[c]);
    printf("\n");
}

/* ---- meshes ---- */

/* All settings; in the short run of complete trees, which have most, every third, and of the others
 * one in so many; the next ones for the next mesh. */
static const Setting *settings_shot(uint64_t seed, uint64_t one_in)
{
    static Setting shot[SHOT_MOST];
    uint64_t turn = seed, other = seed;
    int n = 0;

    for (const Setting *s = settings_all(); s->kind; s++)
        if (test_is_long() || (setting_is_forest(s) ? turn++ % 3 : other++ % one_in) == 0) {
            REQUIRE(n + 1 < SHOT_MOST, "too many settings");
            shot[n++] = *s;
        }
    shot[n].kind = NULL;
    return shot;
}

static void shoot_mesh(const char *name, Mesh *mesh, uint64_t rays, uint64_t seed, uint64_t one_in)
{
    Target t;
    Geometry g;
    char why[120] = "";

    memset(&t, 0, sizeof t);
    geometry_of(&g, mesh);
    t.name = name;
    t.flat = true;
    t.setting = settings_shot(seed, one_in);
    t.brute = setting_build(setting_brute(), &g);
    for (int k = 0; t.setting[k].kind; k++) {
        t.accel[k] = setting_build(&t.setting[k], &g);
        EXPECT(accel_validate(t.accel[k], why, sizeof why), "%s, %s: %s", name,
               t.setting[k].name, why);
    }
    shoot(&t, rays, seed);
    for (int k = 0; t.accel[k]; k++)
        accel_free(t.accel[k]);
    accel_free((Accel *)t.brute);
    geometry_clear(&g);
}

static void shoot_zoo(const ZooMesh *z, uint64_t rays)
{
    for (uint64_t seed = 1; z->name; z++, seed++) {
        Mesh m;
        z->make(&m);
        shoot_mesh(z->name, &m, rays, seed, 1);
    }
}

static void tame(void) { shoot_zoo(zoo_tame, 24000); }
static void wild(void) { shoot_zoo(zoo_wild, 6000); }

/* Far from the origin coordinates are coarse and boxes matter; see RELIABILITY section 0.4 for the
 * second offset, where Embree loses rays. */
static void shoot_placed(int first, int end)
{
    static const Where place[6] = {
        { 1e-6, { 0, 0, 0 } }, { 1e6, { 0, 0, 0 } }, { 1, { 148376, 1234, -223423 } },
        { 1, { 1e6f, -1e6f, 1e6f } }, { 1e-6, { 1, -2, 3 } }, { 1e3, { -1e6f, 1e6f, 0 } }
    };
    static const char *const names[8] = { "icosphere", "torus", "bumpy", "soup", "slivers",
                                          "needles", "sheets", "bricks" };

    for (int i = first; i < end; i++) {
        const ZooMesh *z = i < 4 ? zoo_tame : zoo_wild;
        while (strcmp(z->name, names[i]))
            z++;
        for (uint64_t k = 0; k < 6; k++) {
            char name[60];
            Mesh m;
            snprintf(name, sizeof name, "%s, place %d", z->name, (int)k);
            z->make(&m);
            mesh_place(&m, place[k].scale, place[k].offset);
            shoot_mesh(name, &m, 6000, 100 * (uint64_t)i + k, 2);
        }
    }
}

static void placed_tame(void) { shoot_placed(0, 4); }
static void placed_wild(void) { shoot_placed(4, 8); }

static void shoot_file(const char *path, uint64_t rays, uint64_t one_in)
{
    FileBytes f;
    Mesh m;

    REQUIRE(file_read(test_data(path), FILE_LIMIT_DEFAULT, &f), "%s", path);
    REQUIRE(ply_read(&m, path, (const unsigned char *)f.bytes, f.size), "%s", path);
    file_clear(&f);
    shoot_mesh(path, &m, rays, 1, one_in);
}

static void small_bunny(void) { shoot_file("meshes/bun_zipper_res4.ply", 30000, 1); }
static void bunny(void) { shoot_file("meshes/bun_zipper.ply", 1000, 2); }

/* ---- worlds of everything ---- */

static const ShapeTraits plain = { 0, NO_LIGHT, false };

static Transform random_turn(Rng *rng)
{
    V3 axis = rng_direction(rng);
    return xf_rotate(360.0 * rng_unit(rng), axis.x, axis.y, axis.z);
}

/* Turned, stretched by up to 1 : `stretch`, turned again, mirrored now and then, moved. */
static Transform random_map(Rng *rng, double stretch, float reach)
{
    Transform turn = random_turn(rng), again = random_turn(rng), t;
    double s[3];

    for (int k = 0; k < 3; k++)
        s[k] = (rng_below(rng, 4) ? 0.3 : -0.3) * md_pow(stretch, rng_unit(rng));
    t = xf_scale(s[0], s[1], s[2]);
    t = xf_then(&t, &turn);
    t = xf_then(&again, &t);
    turn = xf_translate(rng_between(rng, -reach, reach), rng_between(rng, -reach, reach),
                        rng_between(rng, -reach, reach));
    return xf_then(&turn, &t);
}

static Transform random_similarity(Rng *rng, float reach)
{
    Transform turn = random_turn(rng), t = xf_translate(rng_between(rng, -reach, reach),
                                                        rng_between(rng, -reach, reach),
                                                        rng_between(rng, -reach, reach));
    return xf_then(&t, &turn);
}

/* Spheres and discs, whole, cut, and some twice in the same place. */
static void add_odd(Geometry *g, Rng *rng, float reach)
{
    for (int i = 0; i < 14; i++) {
        Transform t = random_similarity(rng, reach);
        float r = rng_between(rng, 0.05f, 0.6f), a = rng_between(rng, -r, r);
        Sphere s;
        Disk d;
        REQUIRE(sphere_init(&s, &t, r, i < 6 ? -r : a, r, i < 9 ? 360.0f : 200.0f) &&
                disk_init(&d, &t, 0.2f, r, i < 6 ? 0.0f : 0.5f * r, i < 9 ? 360.0f : 100.0f),
                "a turn and a shift keep a sphere");
        for (int twice = 0; twice < (i % 3 ? 1 : 2); twice++)
            REQUIRE(geometry_add_sphere(g, &s, plain, NULL) &&
                    geometry_add_disk(g, &d, plain, NULL), "memory");
    }
}

static void add_mesh(Geometry *g, const ZooMesh *z)
{
    Mesh m;
    z->make(&m);
    REQUIRE(geometry_add_mesh(g, &m, plain, NULL), "memory");
}

/* Height fields, and geometry images in the same place. */
static void add_tessellations(Geometry *g, Rng *rng, float reach)
{
    Transform place = random_map(rng, 1.0, reach), field = random_map(rng, 1.0, reach);
    Tessellation t;

    for (int twice = 0; twice < 2; twice++) {
        REQUIRE(image_sphere(&t, (ImageForm){ false, 5, 16, &place }, 0.8f) &&
                geometry_add_tessellation(g, &t, plain, NULL), "memory");
        REQUIRE(tessellation_init(&t, twice, 6, 6, &field), "memory");
        for (size_t i = 0; i < tessellation_points(&t); i++)
            t.values[i] = rng_unit(rng);
        REQUIRE(tessellation_finish(&t, 32) && geometry_add_tessellation(g, &t, plain, NULL),
                "memory");
    }
}

static void add_instances(Geometry *g, uint32_t child, int n, Rng *rng, double stretch, float reach)
{
    for (int i = 0; i < n; i++) {
        Transform t = random_map(rng, stretch, reach);
        for (int twice = 0; twice < (i % 3 ? 1 : 2); twice++)
            REQUIRE(geometry_add_instance(g, child, &t, NULL), "memory");
    }
}

/* The first slides, the others turn and change their size, too; two move alike. */
static void add_moving(Geometry *g, uint32_t child, int n, Rng *rng, double stretch, float reach)
{
    for (int i = 0; i < n; i++) {
        Transform start = random_map(rng, stretch, reach), end = random_map(rng, stretch, reach);
        Motion m;
        if (i == 0) {
            Transform move = xf_translate(rng_between(rng, -1, 1), rng_between(rng, -1, 1), 0.1);
            end = xf_then(&move, &start);
        }
        if (xf_swaps_hands(&start) != xf_swaps_hands(&end)) {
            Transform mirror = xf_scale(1, -1, 1);
            end = xf_then(&end, &mirror);
        }
        REQUIRE(motion_init(&m, &start, &end), "something is between");
        for (int twice = 0; twice < (i ? 1 : 2); twice++)
            REQUIRE(geometry_add_moving(g, child, &m, NULL), "memory");
    }
}

/* Bricks, and an instance of such bricks in the same place: ties that only rounding settles. */
static void add_twins(Scene *sc, uint32_t child, Rng *rng, double stretch, float reach)
{
    Transform t = xf_scale(0.3 * stretch, 0.1, 0.37), move;
    Mesh m;

    move = xf_translate(rng_between(rng, -reach, reach), rng_between(rng, -reach, reach), -reach);
    t = xf_then(&move, &t);
    zoo_wild[11].make(&m);
    for (uint32_t i = 0; i < m.nverts; i++)
        m.p[i] = xf_point(&t, m.p[i]);
    REQUIRE(geometry_add_mesh(&sc->geometries[0], &m, plain, NULL) &&
            geometry_add_instance(&sc->geometries[0], child, &t, NULL), "memory");
}

/* Geometry 1: a mesh, spheres, discs, tessellations. 2: a mesh. 3: bricks. 0, the world: all of it
 * and more, standing and moving. `order` may be a setting whose order of triangles brute is to
 * have, too. */
static Scene *world(const Setting *s, const Setting *order, double stretch, float reach)
{
    Scene *sc = scene_new();
    Rng rng = rng_seed(99);

    REQUIRE(sc && scene_add_geometry(sc, NULL) && scene_add_geometry(sc, NULL) &&
            scene_add_geometry(sc, NULL), "memory");
    add_mesh(&sc->geometries[1], &zoo_tame[7]);
    add_odd(&sc->geometries[1], &rng, 1.0f);
    add_tessellations(&sc->geometries[1], &rng, 1.0f);
    add_mesh(&sc->geometries[2], &zoo_tame[1]);
    add_mesh(&sc->geometries[3], &zoo_wild[11]);
    add_mesh(&sc->geometries[0], &zoo_tame[3]);
    add_mesh(&sc->geometries[0], &zoo_wild[4]);
    add_odd(&sc->geometries[0], &rng, 2.0f);
    add_tessellations(&sc->geometries[0], &rng, reach);
    add_instances(&sc->geometries[0], 1, 4, &rng, stretch, reach);
    add_instances(&sc->geometries[0], 2, 4, &rng, stretch, reach);
    add_twins(sc, 3, &rng, stretch, reach);
    add_moving(&sc->geometries[0], 1, 2, &rng, stretch, reach);
    add_moving(&sc->geometries[0], 2, 2, &rng, stretch, reach);
    for (size_t k = 0; order && k < sc->ngeometries; k++) {
        REQUIRE(geometry_finish(&sc->geometries[k]), "memory");
        accel_free(setting_arrange(order, &sc->geometries[k]));
    }
    REQUIRE(scene_build(sc, s->kind, &s->opts, 1), "%s", s->name);
    return sc;
}

/* All settings that leave triangles in their order. */
static void shoot_world(const char *name, double stretch, float reach, uint64_t rays)
{
    static Setting plain_ones[SHOT_MOST];
    Scene *truth = world(setting_brute(), NULL, stretch, reach), *other[SHOT_MOST];
    Target t;
    int n = 0;

    memset(&t, 0, sizeof t);
    t.name = name;
    t.brute = truth->accel;
    t.setting = plain_ones;
    for (const Setting *s = settings_all(); s->kind; s++) {
        if (s->kind->arrange)
            continue;
        REQUIRE(n + 1 < SHOT_MOST, "too many settings");
        plain_ones[n] = *s;
        other[n] = world(s, NULL, stretch, reach);
        t.accel[n] = other[n]->accel;
        n++;
    }
    shoot(&t, rays, 7);
    while (n)
        scene_free(other[--n]);
    scene_free(truth);
}

/* Of the others `wide` and every third, each against brute with triangles in its order. */
static void shoot_arranged(const char *name, double stretch, float reach, uint64_t rays)
{
    int n = 0;

    for (const Setting *s = settings_all(); s->kind; s++) {
        Scene *truth, *own;
        Target t;
        if (!s->kind->arrange || (n++ % 3 && strcmp(s->kind->info.name, ACCEL_DEFAULT)))
            continue;
        truth = world(setting_brute(), s, stretch, reach);
        own = world(s, NULL, stretch, reach);
        memset(&t, 0, sizeof t);
        t.name = name;
        t.brute = truth->accel;
        t.setting = s;
        t.accel[0] = own->accel;
        shoot(&t, rays, 7);
        scene_free(own);
        scene_free(truth);
    }
}

static void world_near(void) { shoot_world("world", 3.0, 3.0f, 30000); }
static void world_stretched(void) { shoot_world("stretched world", 1000.0, 3.0f, 30000); }
static void world_far(void) { shoot_world("far world", 3.0, 1e4f, 30000); }

static void world_arranged(void)
{
    shoot_arranged("world", 3.0, 3.0f, 3000);
    shoot_arranged("stretched world", 1000.0, 3.0f, 3000);
    shoot_arranged("far world", 3.0, 1e4f, 3000);
}

const TestCase test_rays[] = {
    { "tame", tame, false }, { "wild", wild, false }, { "placed_tame", placed_tame, false },
    { "placed_wild", placed_wild, false }, { "small_bunny", small_bunny, false },
    { "bunny", bunny, false }, { "world", world_near, false },
    { "world_stretched", world_stretched, false }, { "world_far", world_far, false },
    { "world_arranged", world_arranged, false },
    { NULL, NULL, false }
};

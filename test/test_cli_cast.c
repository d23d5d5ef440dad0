/* test_cli_cast.c -- the command `cast`: its tables and CSV, rays whose hits are known, files of
 * rays there and back, and files that are none. No figure of speed is judged. */
#include "base/random.h"
#include "geometry/generate.h"
#include "render/cast.h"
#include "test/cli_help.h"
#include "test/mesh_help.h"

#include <stdlib.h>
#include <string.h>

enum { HEAD = 56, RECORD = 32 };

static void write_mesh(const char *name, Mesh *m)
{
    REQUIRE(ply_write(m, cli_path(name)), "%s", name);
    mesh_clear(m);
}

static void write_bumpy(const char *name)
{
    Mesh m = { 0 };
    REQUIRE(mesh_bumpy(&m, 4, 3), "memory");
    write_mesh(name, &m);
}

static int structures(void)
{
    int n = 0;
    while (accels[n])
        n++;
    return n;
}

/* ---- CSV ---- */

/* The same rays have the same answers in every structure; rows come by structure, then by rays. */
static void expect_agreement(const Csv *c, int sets)
{
    for (int i = sets; i < c->n; i++) {
        EXPECT(!strcmp(csv_text(c, i, "rays"), csv_text(c, i % sets, "rays")), "row %d", i);
        EXPECT(!strcmp(csv_text(c, i, "hits"), csv_text(c, i % sets, "hits")) &&
               !strcmp(csv_text(c, i, "sum_t"), csv_text(c, i % sets, "sum_t")),
               "row %d: %s has hits and sum of its own", i, csv_text(c, i, "structure"));
    }
}

static void csv(void)
{
    const Csv *c;
    int n = structures();

    write_bumpy("m,\"1.ply");
    c = csv_of(CLI_WORKS("cast m,\"1.ply --quiet --csv --size 24x20 --runs 1 --threads 2").out);
    REQUIRE(c->n == n * RAYS_KINDS, "%d rows", c->n);
    expect_agreement(c, RAYS_KINDS);
    for (int i = 0; i < c->n; i++) {
        bool brute = !strcmp(csv_text(c, i, "structure"), "brute");
        EXPECT(!strcmp(csv_text(c, i, "mesh"), "m,\"1.ply"), "mesh: %s", csv_text(c, i, "mesh"));
        EXPECT(!strcmp(csv_text(c, i, "structure"), accels[i / RAYS_KINDS]->info.name) &&
               !strcmp(csv_text(c, i, "rays"), rays_names[i % RAYS_KINDS]), "row %d: %s %s", i,
               csv_text(c, i, "structure"), csv_text(c, i, "rays"));
        EXPECT(csv_num(c, i, "triangles") == 320 && csv_num(c, i, "vertices") == 162, "the mesh");
        EXPECT(brute || csv_num(c, i, "nodes") > 0, "no nodes");
        EXPECT(csv_num(c, i, "peak_bytes_per_triangle") >= csv_num(c, i, "bytes_per_triangle"),
               "peak %s", csv_text(c, i, "peak_bytes_per_triangle"));
        EXPECT(fabs(csv_num(c, i, "bytes_per_triangle_all") - csv_num(c, i, "bytes_per_triangle") -
                    (320 * sizeof(Tri) + 162 * sizeof(V3)) / 320.0) < 1e-9, "geometry");
        EXPECT(csv_num(c, i, "hits") <= csv_num(c, i, "count") && csv_num(c, i, "count") > 0 &&
               csv_num(c, i, "prims_per_ray") > 0 && !*csv_text(c, i, "file_hits"), "row %d", i);
    }
    EXPECT(csv_num(c, 0, "count") == 24 * 20 && csv_num(c, 0, "prims_per_ray") == 320, "brute");
    c = csv_of(CLI_WORKS("cast m,\"1.ply --quiet --csv --size 8x8 --runs 0 --accel wide "
                         "--accel lbvh:bits=8,leaf=2").out);
    EXPECT(c->n == 2 * RAYS_KINDS && !strcmp(csv_text(c, 0, "structure"), "wide") &&
           !strcmp(csv_text(c, RAYS_KINDS, "structure"), "lbvh:bits=8,leaf=2"), "chosen ones");
    EXPECT(!*csv_text(c, 0, "mrays_single") && !*csv_text(c, 0, "mrays_batch"), "speed of no run");
}

/* ---- tables ---- */

static int count_of(const char *text, const char *word)
{
    int n = 0;
    for (const char *p = text; (p = strstr(p, word)) != NULL; p++)
        n++;
    return n;
}

static void expect_narrow(const char *page)
{
    for (const char *p = page; *p; p += strcspn(p, "\n") + (p[strcspn(p, "\n")] != 0))
        EXPECT(strcspn(p, "\n") <= 80, "a line of %lu columns: %.100s",
               (unsigned long)strcspn(p, "\n"), p);
}

/* A row of each structure in each table: builds, single rays, batches, tests. */
static void tables(void)
{
    char line[200];
    Cli c;

    write_bumpy("m.ply");
    write_bumpy("n.ply");
    c = CLI_WORKS("cast m.ply --quiet --size 24x20 --runs 1");
    expect_narrow(c.out);
    EXPECT(!strncmp(c.out, "m.ply: 320 triangles, 162 vertices\n", 35), "it begins: %.50s", c.out);
    for (int i = 0; accels[i]; i++) {
        snprintf(line, sizeof line, "\n%s ", accels[i]->info.name);
        EXPECT(count_of(c.out, line) == 4, "%d rows of %s", count_of(c.out, line),
               accels[i]->info.name);
    }
    for (int k = 0; k < RAYS_KINDS; k++)
        EXPECT(count_of(c.out, rays_names[k]) >= 4, "%s", rays_names[k]);
    c = CLI_WORKS("cast m.ply n.ply --quiet --size 9x9 --runs 0 --accel bvh:split=gs,layout=skip "
                  "--accel lbvh:bits=16,arity=8,leaf=8");
    expect_narrow(c.out);
    EXPECT(count_of(c.out, "\nbvh:split=gs,layout=skip ") == 4 && strstr(c.out, "n.ply: 320") &&
           count_of(c.out, "\nlbvh:bits=16,arity=8,leaf=8\n") == 4, "two meshes: %s", c.out);
    EXPECT(!strstr(c.out, "million rays"), "speeds of no run");
}

/* The number of tests that brute would need decides. */
static void brute_left_out(void)
{
    Mesh m = { 0 };
    Cli c;

    REQUIRE(mesh_bumpy(&m, 40, 3), "memory");
    write_mesh("m.ply", &m);
    c = CLI_WORKS("cast m.ply --quiet --size 60x60 --runs 0");
    EXPECT(!strstr(c.out, "\nbrute  ") && count_of(c.out, "\nbrute is left out, it would take "
           "long: --accel brute asks for it\n") == 1, "3600 rays: %s", c.out);
    c = CLI_WORKS("cast m.ply --size 8x8 --runs 0");
    EXPECT(strstr(c.out, "\nbrute  ") && !strstr(c.out, "left out"), "64 rays: %s", c.out);
    EXPECT(cli_lines(c.err) == structures(), "a note each: %s", c.err);
}

/* ---- rays whose hits are known ---- */

/* Rays that leave a convex body meet nothing, with the light outside; of those within a closed room
 * each meets a wall. */
static void known_hits(void)
{
    const Csv *c;
    Mesh m = { 0 };

    REQUIRE(mesh_icosphere(&m, 6), "memory");
    write_mesh("ball.ply", &m);
    REQUIRE(mesh_room(&m), "memory");
    write_mesh("room.ply", &m);
    c = csv_of(CLI_WORKS("cast ball.ply --quiet --csv --size 64x64 --runs 0").out);
    expect_agreement(c, RAYS_KINDS);
    EXPECT(csv_num(c, RAYS_PRIMARY, "hits") > 0.6 * 64 * 64 &&
           csv_num(c, RAYS_PRIMARY, "hits") < 64 * 64, "the frame: %s",
           csv_text(c, RAYS_PRIMARY, "hits"));
    EXPECT(csv_num(c, RAYS_BOUNCE, "count") == csv_num(c, RAYS_PRIMARY, "hits") &&
           csv_num(c, RAYS_AO, "count") == csv_num(c, RAYS_PRIMARY, "hits"), "a ray a hit");
    EXPECT(csv_num(c, RAYS_SHADOW, "count") > 0.3 * csv_num(c, RAYS_PRIMARY, "hits") &&
           csv_num(c, RAYS_SHADOW, "count") < csv_num(c, RAYS_PRIMARY, "hits"), "facing the light");
    for (int k = RAYS_BOUNCE; k <= RAYS_AO; k++)
        EXPECT(csv_num(c, k, "hits") == 0, "%s: %s hits", rays_names[k], csv_text(c, k, "hits"));
    c = csv_of(CLI_WORKS("cast room.ply --quiet --csv --size 64x64 --runs 0 "
                         "--cam 0.5,0.4,0.5,1.9,0.6,0.4,60 --light 0.5,0.5,0.9 --ao 5").out);
    expect_agreement(c, RAYS_KINDS);
    EXPECT(csv_num(c, RAYS_PRIMARY, "hits") == 64 * 64, "primary: %s", csv_text(c, 0, "hits"));
    EXPECT(csv_num(c, RAYS_BOUNCE, "hits") == 64 * 64 && csv_num(c, RAYS_AO, "hits") == 64 * 64,
           "bounce: %s, ao: %s", csv_text(c, RAYS_BOUNCE, "hits"), csv_text(c, RAYS_AO, "hits"));
    EXPECT(csv_num(c, RAYS_SHADOW, "count") > 0 && csv_num(c, RAYS_SHADOW, "hits") <
           0.5 * csv_num(c, RAYS_SHADOW, "count"), "shadow: %s", csv_text(c, RAYS_SHADOW, "hits"));
}

/* Bounces go by the cosine: on a plane seen from above, its mean is 2/3; 4 standard errors. */
static void cosine(void)
{
    RaySet s;
    double sum = 0, n;
    Mesh m = { 0 };

    REQUIRE(mesh_grid(&m, 3, 3), "memory");
    write_mesh("floor.ply", &m);
    CLI_WORKS("cast floor.ply --quiet --size 100x100 --runs 0 --accel wide --rays-out r "
              "--cam 0.5,0.5,1,0.5,0.5,0,30");
    REQUIRE(rayset_read(&s, cli_path("r.bounce.rays"), 1 << 30) && s.n == 10000, "bounces");
    n = (double)s.n;
    for (size_t i = 0; i < s.n; i++) {
        EXPECT(s.rays[i].d.z > 0 && s.rays[i].o.z > 0, "ray %lu goes down", (unsigned long)i);
        sum += s.rays[i].d.z;
    }
    EXPECT(fabs(sum / n - 2.0 / 3) < 4 * sqrt(1 / 18.0 / n), "mean cosine %g", sum / n);
    rayset_clear(&s);
}

/* ---- files of rays, there and back ---- */

static uint32_t u32_at(const char *b, size_t at)
{
    uint32_t x;
    memcpy(&x, b + at, 4);
    return x;
}

static uint64_t u64_at(const char *b, size_t at)
{
    uint64_t x;
    memcpy(&x, b + at, 8);
    return x;
}

static void expect_head(const Csv *c, int k)
{
    static const char zeros[16];
    char name[40];
    size_t n, kind = strlen(rays_names[k]);
    double sum;
    char *b;

    snprintf(name, sizeof name, "r.%s.rays", rays_names[k]);
    b = cli_read(name, &n);
    REQUIRE(b && n >= HEAD, "%s", name);
    memcpy(&sum, b + 48, 8);
    EXPECT(!memcmp(b, "RAYS", 4) && u32_at(b, 4) == 1 && !memcmp(b + 8, rays_names[k], kind) &&
           !memcmp(b + 8 + kind, zeros, 16 - kind), "%s: magic, version, kind", name);
    EXPECT(u32_at(b, 24) == (k == RAYS_SHADOW || k == RAYS_AO) && u32_at(b, 28) == 0, "query");
    EXPECT(u64_at(b, 32) == (n - HEAD) / RECORD && (n - HEAD) % RECORD == 0 &&
           (double)u64_at(b, 32) == csv_num(c, k, "count"), "%s: count", name);
    EXPECT((double)u64_at(b, 40) == csv_num(c, k, "hits") && sum == csv_num(c, k, "sum_t"),
           "%s: hits or sum", name);
}

static void round_trip(void)
{
    const Csv *made, *read;

    write_bumpy("m.ply");
    made = csv_of(CLI_WORKS("cast m.ply --quiet --csv --size 40x30 --runs 0 --rays-out r").out);
    for (int k = 0; k < RAYS_KINDS; k++)
        expect_head(made, k);
    read = csv_of(CLI_WORKS("cast m.ply --quiet --csv --runs 0 --batch 7 --rays r.primary.rays "
                            "--rays r.bounce.rays --rays r.shadow.rays --rays r.ao.rays "
                            "--rays r.random.rays").out);
    REQUIRE(read->n == made->n, "%d rows", read->n);
    for (int i = 0; i < made->n; i++) {
        EXPECT(!strcmp(csv_text(read, i, "hits"), csv_text(made, i, "hits")) &&
               !strcmp(csv_text(read, i, "sum_t"), csv_text(made, i, "sum_t")) &&
               !strcmp(csv_text(read, i, "query"), csv_text(made, i, "query")) &&
               !strcmp(csv_text(read, i, "count"), csv_text(made, i, "count")), "row %d", i);
        EXPECT(!strcmp(csv_text(read, i, "hits"), csv_text(read, i, "file_hits")) &&
               !strcmp(csv_text(read, i, "sum_t"), csv_text(read, i, "file_sum_t")), "row %d", i);
    }
    EXPECT(!strcmp(cli_folder(), "m.ply r.ao.rays r.bounce.rays r.primary.rays r.random.rays "
                   "r.shadow.rays "), "the folder holds %s", cli_folder());
}

/* The same seed, the same files; another seed, another bounce, the same picture. */
static void seeds(void)
{
    write_bumpy("m.ply");
    CLI_WORKS("cast m.ply --quiet --size 16x16 --runs 0 --accel bvh --threads 1 --rays-out a");
    CLI_WORKS("cast m.ply --quiet --size 16x16 --runs 0 --accel lbvh --threads 2 --rays-out b");
    CLI_WORKS("cast m.ply --quiet --size 16x16 --runs 0 --accel bvh --seed 2 --rays-out c");
    for (int k = 0; k < RAYS_KINDS; k++) {
        char a[40], b[40], c[40];
        snprintf(a, sizeof a, "a.%s.rays", rays_names[k]);
        snprintf(b, sizeof b, "b.%s.rays", rays_names[k]);
        snprintf(c, sizeof c, "c.%s.rays", rays_names[k]);
        EXPECT(cli_same_file(a, b), "%s: the structure or the threads matter", rays_names[k]);
        EXPECT(cli_same_file(a, c) == (k == RAYS_PRIMARY || k == RAYS_SHADOW), "%s: the seed",
               rays_names[k]);
    }
}

/* ---- files written by hand ---- */

typedef struct { char bytes[HEAD + 8 * RECORD]; size_t n; } RayBytes;

static RayBytes ray_bytes(const float *v, uint64_t count, uint32_t any)
{
    const uint32_t version = 1;
    RayBytes f;

    memset(&f, 0, sizeof f);
    memcpy(f.bytes, "RAYS", 4);
    memcpy(f.bytes + 4, &version, 4);
    memcpy(f.bytes + 8, "by hand", 7);
    memcpy(f.bytes + 24, &any, 4);
    memcpy(f.bytes + 32, &count, 8);
    memcpy(f.bytes + HEAD, v, (size_t)count * RECORD);
    f.n = HEAD + (size_t)count * RECORD;
    return f;
}

/* The square z = 0 from above: seven rays, of which four hit at t = 1, 1, 2 and 1. */
static const float SEVEN[7][8] = {
    { 0.3f, 0.6f, 1, 0, 0, -1, 0, INFINITY },
    { 0.3f, 0.6f, 1, 0, 0, -1, 0.25f, 10 },
    { 0.3f, 0.6f, 1, 0, 0, -0.5f, 0.5f, 2 },
    { 0.3f, 0.6f, 1, 0, 0, -1, -3, 1 },
    { 0.3f, 0.6f, 1, 0, 0, -1, 1.5f, 10 },      /* begins behind it */
    { 0.3f, 0.6f, 1, 0, 0, -1, 0.25f, 0.5f },   /* ends before it */
    { 0.3f, 0.6f, 1, 0, 0, -1, 1, 1 },          /* begins on it: not after its beginning */
};

static void write_square(void)
{
    Mesh m = { 0 };
    REQUIRE(mesh_grid(&m, 2, 2), "memory");
    write_mesh("square.ply", &m);
}

static void tmin(void)
{
    const char *warning = "rushlight: r.rays: warning: 6 of 7 rays have a tmin other than 0: they "
                          "are cast from o + tmin d, and their t is counted from o\n";
    RayBytes f;

    write_square();
    for (uint32_t any = 0; any < 2; any++) {
        const Csv *t;
        Cli c;
        f = ray_bytes(SEVEN[0], 7, any);
        cli_write("r.rays", f.bytes, f.n);
        c = cli("cast square.ply --quiet --csv --runs 0 --rays r.rays");
        EXPECT_CLI(c, 0, warning);
        t = csv_of(c.out);
        REQUIRE(t->n == structures(), "%d rows", t->n);
        expect_agreement(t, 1);
        EXPECT(csv_num(t, 0, "hits") == 4 && csv_num(t, 0, "sum_t") == (any ? 0 : 5) &&
               csv_num(t, 0, "count") == 7, "%s hits, sum %s", csv_text(t, 0, "hits"),
               csv_text(t, 0, "sum_t"));
    }
}

static void swap(char *b, size_t n)
{
    for (size_t k = 0; k < n / 2; k++) {
        char x = b[k];
        b[k] = b[n - 1 - k];
        b[n - 1 - k] = x;
    }
}

static void other_byte_order(void)
{
    RayBytes f = ray_bytes(SEVEN[0], 1, 0), g;
    const Csv *c;

    write_square();
    g = f;
    swap(g.bytes + 4, 4);
    swap(g.bytes + 24, 4);
    for (size_t at = 32; at < HEAD; at += 8)
        swap(g.bytes + at, 8);
    for (size_t at = HEAD; at < g.n; at += 4)
        swap(g.bytes + at, 4);
    cli_write("f.rays", f.bytes, f.n);
    cli_write("g.rays", g.bytes, g.n);
    c = csv_of(CLI_WORKS("cast square.ply --quiet --csv --runs 0 --rays f.rays --rays g.rays "
                         "--accel wide").out);
    EXPECT(csv_num(c, 0, "hits") == 1 && csv_num(c, 1, "hits") == 1 &&
           csv_num(c, 0, "sum_t") == 1 &&
           csv_num(c, 1, "sum_t") == 1, "one of the orders");
}

static void expect_refused(const RayBytes *f, const char *why)
{
    char err[300];
    snprintf(err, sizeof err, "r.rays: %s", why);
    cli_write("r.rays", f->bytes, f->n);
    CLI_FAILS(STATUS_INPUT, err, "cast square.ply --quiet --rays r.rays");
}

static void hostile_heads(void)
{
    const RayBytes good = ray_bytes(SEVEN[0], 2, 0);
    RayBytes f = good;

    write_square();
    f.n = 0;
    expect_refused(&f, "not a file of rays, 'RAYS' was expected at its beginning");
    f.n = HEAD - 1;
    expect_refused(&f, "has 55 bytes, a head of 56 was expected");
    f = good;
    f.bytes[3] = 's';
    expect_refused(&f, "not a file of rays, 'RAYS' was expected at its beginning");
    f = ray_bytes(SEVEN[0], 2, 0);
    memcpy(f.bytes + 4, "\2\2\2\2", 4);
    expect_refused(&f, "byte 4: the version is 33686018, expected 1");
    f = ray_bytes(SEVEN[0], 2, 2);
    expect_refused(&f, "byte 24: the query is 2 and 0, expected 0 (nearest) or 1 (any), and 0");
    f = good;
    memset(f.bytes + 32, 0xFF, 8);
    expect_refused(&f, "byte 32: the count is 18446744073709551615, but 64 bytes follow the head, "
                   "expected 32 a ray");
    f = good;
    f.n -= 1;
    expect_refused(&f, "byte 32: the count is 2, but 63 bytes follow the head, expected 32 a ray");
    f = good;
    f.n += RECORD;
    expect_refused(&f, "byte 32: the count is 2, but 96 bytes follow the head, expected 32 a ray");
}

static void hostile_rays(void)
{
    const struct { int at; float v; const char *why; } CASES[] = {
        { 0, INFINITY, "a number is not finite (tmax may be infinite)" },
        { 6, -INFINITY, "a number is not finite (tmax may be infinite)" },
        { 7, -INFINITY, "a number is not finite (tmax may be infinite)" },
        { 5, 0, "the direction is 0" },
        { 6, 20, "tmin is above tmax, expected tmin <= tmax" },
        { 7, -1, "tmin is above tmax, expected tmin <= tmax" },
    };
    float v[2][8];
    char why[200];
    RayBytes f;

    write_square();
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        memcpy(v, SEVEN + 1, sizeof v);
        v[1][CASES[i].at] = CASES[i].v;
        f = ray_bytes(v[0], 2, 0);
        snprintf(why, sizeof why, "ray 1 at byte 88: %s", CASES[i].why);
        expect_refused(&f, why);
    }
    for (int k = 0; k < 8; k++) {
        memcpy(v, SEVEN + 1, sizeof v);
        v[0][k] = (float)sqrt(-1.0);
        f = ray_bytes(v[0], 2, 0);
        expect_refused(&f, "ray 0 at byte 56: a number is not finite (tmax may be infinite)");
    }
    memcpy(v, SEVEN + 1, sizeof v);
    v[0][5] = 1e38f;
    v[0][6] = 1e5f;
    v[0][7] = 1e6f;
    f = ray_bytes(v[0], 2, 0);
    expect_refused(&f, "ray 0 at byte 56: the point at tmin is beyond the range of floats");
}

/* Broken at random: refused, or rays that can be cast, in little memory. */
static void hostile_at_random(void)
{
    int rounds = test_is_long() ? 50000 : 5000, taken = 0;
    Rng rng = rng_seed(4);

    messages_nowhere();
    for (int i = 0; i < rounds; i++) {
        RayBytes f = ray_bytes(SEVEN[0], 7, i & 1);
        RaySet s;
        for (uint32_t k = rng_below(&rng, 4); k > 0; k--)
            f.bytes[rng_below(&rng, (uint32_t)f.n)] = (char)(rng_bits(&rng) >> 56);
        if (rng_below(&rng, 4) == 0)
            f.n = rng_below(&rng, (uint32_t)f.n + 1);
        cli_write("r.rays", f.bytes, f.n);
        mem_peak_restart();
        if (rayset_read(&s, cli_path("r.rays"), 1 << 20)) {
            for (size_t k = 0; k < s.n; k++)
                EXPECT(v_finite(s.rays[k].o) && v_finite(s.rays[k].d) && s.rays[k].tmax >= 0 &&
                       v_max3(v_abs(s.rays[k].d)) > 0, "round %d: ray %lu", i, (unsigned long)k);
            taken++;
        }
        EXPECT(mem_peak() < 4 * sizeof f.bytes + 400, "%lu bytes", (unsigned long)mem_peak());
        rayset_clear(&s);
    }
    EXPECT(taken > rounds / 10 && taken < rounds * 9 / 10, "%d of %d taken", taken, rounds);
    EXPECT(mem_blocks() == 0, "%ld blocks are left", mem_blocks());
}

/* ---- meshes out of the common run ---- */

#define PLY_HEAD(v, f) "ply\nformat ascii 1.0\nelement vertex " v "\nproperty float x\n" \
    "property float y\nproperty float z\nelement face " f "\n" \
    "property list uchar int vertex_indices\nend_header\n"

static void odd_meshes(void)
{
    static const struct { const char *text; double tris; } CASES[] = {
        { PLY_HEAD("0", "0"), 0 },
        { PLY_HEAD("3", "0") "0 0 0\n1 0 0\n0 1 0\n", 0 },
        { PLY_HEAD("3", "1") "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", 1 },
        { PLY_HEAD("3", "1") "0 -1 0\n0 1 0\n0 0 1\n3 0 1 2\n", 1 },
        { PLY_HEAD("3", "1") "-3e38 0 0\n3e38 0 0\n0 3e38 3e38\n3 0 1 2\n", 1 },
        { PLY_HEAD("3", "1") "1e-30 0 0\n3e-30 0 0\n0 2e-30 0\n3 0 1 2\n", 1 },
        { PLY_HEAD("3", "1") "1e9 1e9 1e9\n1000000064 1e9 1e9\n1e9 1000000064 1e9\n3 0 1 2\n", 1 },
    };
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        const Csv *c;
        cli_write_text("odd.ply", CASES[i].text);
        c = csv_of(CLI_WORKS("cast odd.ply --quiet --csv --size 16x16 --runs 1").out);
        REQUIRE(c->n == structures() * RAYS_KINDS, "%d rows", c->n);
        expect_agreement(c, RAYS_KINDS);
        EXPECT(csv_num(c, 0, "triangles") == CASES[i].tris, "mesh %lu", (unsigned long)i);
        EXPECT(!*csv_text(c, 0, "bytes_per_triangle") == !CASES[i].tris, "bytes of no triangle");
        EXPECT(!strstr(CLI_WORKS("cast odd.ply --quiet --size 16x16 --runs 1").out, "nan"), "nan");
    }
    cli_write_text("odd.ply", PLY_HEAD("3", "1") "nan 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    EXPECT(cli("cast odd.ply --quiet").status == STATUS_INPUT, "a point that is no point");
}

/* Shapes that are no triangles, and a lamp whose triangles are put into another order. */
static void scenes(void)
{
    const Csv *c;

    cli_scene();
    c = csv_of(CLI_WORKS("cast tiny.pbrt --quiet --csv --size 40x30 --runs 0").out);
    REQUIRE(c->n == structures() * RAYS_KINDS, "%d rows", c->n);
    expect_agreement(c, RAYS_KINDS);
    EXPECT(csv_num(c, 0, "hits") > 100 && csv_num(c, 0, "triangles") == 6, "hits: %s",
           csv_text(c, 0, "hits"));
    cli_write_text("two.pbrt", "WorldBegin\nObjectBegin \"a\"\nShape \"sphere\"\n"
                   "AreaLightSource \"diffuse\"\nShape \"plymesh\" \"string filename\" "
                   "\"roof.ply\"\nObjectEnd\nObjectInstance \"a\"\nTranslate 3 0 0\n"
                   "Scale 1 2 1\nObjectInstance \"a\"\n");
    c = csv_of(cli("cast two.pbrt --quiet --csv --size 40x30 --runs 0").out);
    REQUIRE(c->n == structures() * RAYS_KINDS, "%d rows", c->n);
    expect_agreement(c, RAYS_KINDS);
    EXPECT(csv_num(c, 0, "hits") > 100, "instances: %s hits", csv_text(c, 0, "hits"));
}

/* ---- words ---- */

static void wrong_words(void)
{
    static const struct { const char *line, *err; } CASES[] = {
        { "cast", "cast takes meshes (.ply, .obj), scenes, or "
          "shapes made by rule (geometryimage:side=512); see rushlight help cast" },
        { "cast m.ply --acel wide",
          "cast: unknown option '--acel', did you mean '--accel'?; see rushlight help cast" },
        { "cast m.ply --accel wide:bits=3", "wide has no option 'bits'" },
        { "cast a.ply b.ply --rays-out r", "--rays-out takes one mesh, got 'a.ply' and 'b.ply'" },
        { "cast a.ply --rays-out r --rays x.rays",
          "--rays-out writes rays that are made, --rays 'x.rays' has made ones" },
        { "cast m.ply --batch 0",
          "--batch '0' is not right, expected a whole number from 1 to 1048576" },
        { "cast m.ply --runs 101",
          "--runs '101' is not right, expected a whole number from 0 to 100" },
        { "cast m.ply --size 100000x100000",
          "--size '100000x100000' is not right, at most 268435456 pixels were expected" },
        { "cast m.ply --cam 1,2,3", "--cam '1,2,3' is not right, expected X,Y,Z,TX,TY,TZ,FOV" },
        { "cast m.ply --cam 1,2,3,4,5,6,7,", "--cam '1,2,3,4,5,6,7,' is not right, expected "
          "X,Y,Z,TX,TY,TZ,FOV" },
        { "cast m.ply --cam 1,2,3,1,2,3,40", "--cam '1,2,3,1,2,3,40' is not right, expected a "
          "target that is not the eye, and degrees between 0 and 180" },
        { "cast m.ply --light 1,2,inf", "--light '1,2,inf' is not right, expected X,Y,Z" },
        { "cast m.ply --ao 0", "--ao '0' is not right, expected a number from 1e-9 to 1000000000" },
    };
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        Cli c = CLI_FAILS(STATUS_USAGE, CASES[i].err, "%s", CASES[i].line);
        EXPECT(!c.out[0], "'%s' prints: %s", CASES[i].line, c.out);
    }
    write_bumpy("m.ply");
    CLI_FAILS(STATUS_OUTPUT, "nosuch/r.primary.rays: cannot be written: No such file or directory",
              "cast nosuch.ply --quiet --rays-out nosuch/r");
    CLI_FAILS(STATUS_INPUT, "nosuch.ply: cannot be opened: No such file or directory",
              "cast nosuch.ply --quiet");
    CLI_FAILS(STATUS_INPUT, "no.rays: cannot be opened: No such file or directory",
              "cast m.ply --quiet --rays no.rays");
    EXPECT(!strcmp(cli_folder(), "m.ply "), "the folder holds %s", cli_folder());
}

/* ---- tessellations ---- */

/* Rows of all structures over the list of triangles, then of lbvh over the grid of points: of as
 * many triangles, with the same hits, bytes of the geometry by 12 or fewer a point, four nodes for
 * each region that is divided, its root, and one above. */
static void expect_regular(const char *shape, double tris, double points, double point_bytes,
                           double nodes)
{
    const Csv *c = csv_of(CLI_WORKS("cast %s --quiet --csv --size 24x20 --runs 1 --batch 50",
                                    shape).out);
    int last = c->n - RAYS_KINDS;

    REQUIRE(c->n == (structures() + 1) * RAYS_KINDS, "%s: %d rows", shape, c->n);
    expect_agreement(c, RAYS_KINDS);
    for (int i = 0; i < c->n; i++) {
        double geometry = i < last ? tris * sizeof(Tri) + points * sizeof(V3)
                                   : points * point_bytes + sizeof(Shape);
        EXPECT(csv_num(c, i, "triangles") == tris && csv_num(c, i, "vertices") == points,
               "%s: %s triangles", shape, csv_text(c, i, "triangles"));
        EXPECT(fabs((csv_num(c, i, "bytes_per_triangle_all") - csv_num(c, i, "bytes_per_triangle"))
                    * tris - geometry) < 1e-6, "%s, row %d: geometry", shape, i);
    }
    EXPECT(csv_num(c, last, "nodes") == nodes, "%s: %s nodes", shape, csv_text(c, last, "nodes"));
    EXPECT(!strcmp(csv_text(c, last, "structure"), "lbvh regular") &&
           csv_num(c, 0, "hits") > 100 && csv_num(c, RAYS_BOUNCE, "hits") > 0, "%s: %s, %s hits",
           shape, csv_text(c, last, "structure"), csv_text(c, 0, "hits"));
}

/* By their names, and in a scene. */
static void tessellations(void)
{
    const Csv *c;

    expect_regular("geometryimage:surface=patch,side=12", 288, 169, 12, 202);
    expect_regular("geometryimage:surface=torus,side=14,bits=16", 392, 225, 6, 282);
    expect_regular("heightfield:nu=20,nv=15,rule=hills", 532, 300, 4, 398);
    expect_regular("heightfield:nu=18,nv=18,rule=hills,subdivision=triangular,bits=16", 289, 171,
                   2, 342);
    cli_write_text("s.pbrt", "WorldBegin Shape \"box\" ObjectBegin \"o\"\n"
                   "Shape \"geometryimage\" \"integer side\" 4 Shape \"torus\" ObjectEnd\n"
                   "AttributeBegin Translate 2 1 0 Shape \"heightfield\" \"string rule\" \"hills\""
                   " \"integer nu\" 5 \"integer nv\" 6 AttributeEnd\n"
                   "AttributeBegin Translate 3 0 0 ObjectInstance \"o\" AttributeEnd\n"
                   "Shape \"sphere\" AttributeBegin Translate 0 3 0 Shape \"box\" AttributeEnd\n");
    c = csv_of(CLI_WORKS("cast s.pbrt --quiet --csv --size 30x30 --runs 0 --accel wide "
                         "--accel lbvh:bits=8 --accel lbvh:leaf=1 --accel brute").out);
    REQUIRE(c->n == 6 * RAYS_KINDS, "%d rows", c->n);
    expect_agreement(c, RAYS_KINDS);
    EXPECT(!strcmp(csv_text(c, 4 * RAYS_KINDS, "structure"), "lbvh:bits=8 regular") &&
           !strcmp(csv_text(c, 5 * RAYS_KINDS, "structure"), "lbvh:leaf=1 regular"), "%s, %s",
           csv_text(c, 4 * RAYS_KINDS, "structure"), csv_text(c, 5 * RAYS_KINDS, "structure"));
}

/* Any shape that is made by rule; what is none. */
static void shapes(void)
{
    const Csv *c = csv_of(CLI_WORKS("cast generated:kind=rock,triangles=1000 sphere --quiet --csv "
                                    "--size 16x16 --runs 0 --accel wide").out);

    EXPECT(c->n == 2 * RAYS_KINDS && csv_num(c, 0, "triangles") == 1000 &&
           csv_num(c, RAYS_KINDS, "triangles") == 0, "%s triangles", csv_text(c, 0, "triangles"));
    CLI_FAILS(STATUS_USAGE, "geometryimage has no option 'sid', did you mean 'side'?",
              "cast geometryimage:sid=4 --quiet");
    CLI_FAILS(STATUS_INPUT, "nurbs: the shape is not supported", "cast nurbs --quiet");
    CLI_FAILS(STATUS_INPUT, "heightfield:rule=hills: a heightfield needs \"integer nu\" and "
              "\"integer nv\", at least 2 each", "cast heightfield:rule=hills --quiet");
    CLI_FAILS(STATUS_INPUT, "plymesh: the shape needs a \"string filename\"",
              "cast plymesh --quiet");
    CLI_FAILS(STATUS_INPUT, "heightfeld: a scene was expected: .pbrt, .obj or .ply",
              "cast heightfeld --quiet");
}

const TestCase test_cli_cast[] = {
    { "csv", csv, false },
    { "tables", tables, false },
    { "brute_left_out", brute_left_out, false },
    { "known_hits", known_hits, false },
    { "cosine", cosine, false },
    { "round_trip", round_trip, false },
    { "seeds", seeds, false },
    { "tmin", tmin, false },
    { "other_byte_order", other_byte_order, false },
    { "hostile_heads", hostile_heads, false },
    { "hostile_rays", hostile_rays, false },
    { "hostile_at_random", hostile_at_random, false },
    { "odd_meshes", odd_meshes, false },
    { "scenes", scenes, false },
    { "wrong_words", wrong_words, false },
    { "tessellations", tessellations, false },
    { "shapes", shapes, false },
    { NULL, NULL, false }
};

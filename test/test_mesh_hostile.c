/* test_mesh_hostile.c -- broken and hostile PLY, OBJ and MTL files: every change of one byte of a
 * small file of each form, files that want much memory or time for little text, every allocation
 * failing. Whatever comes, a reader either gives a mesh that keeps the promises of mesh.h or
 * refuses it with an input error and nothing kept; within 16 bytes a byte and 1 MiB. Run under
 * ASan and UBSan (make check V=asan) this also shows that nothing is read out of bounds: the bytes
 * stand in a block of exactly their size. */
#include "test/mesh_help.h"

#include "base/random.h"
#include "geometry/lookup.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SEED_MAX = 512 };

typedef struct { MeshFileKind kind; unsigned char bytes[SEED_MAX]; size_t n; } Seed;

/* ---- the seeds: small, with every feature of the readers ---- */

static const char obj_text[] =
    "# a\nmtllib a.mtl b\nv -1 0 .5\nv 1e0 0 0 1\nv 0 1 0\nv 2 2 0\nv 1 .2 0\nvt 0 1\nvt .5\n"
    "vn 0 0 1\nusemtl r\nf 1 2 3\ns 1\nf 1/1 2/2 4 \\\n3/1\nusemtl b c\nf 1//1 2/2/1 -2 4 -3/-1\n"
    "g x\nl 1 2\nf 1 2\n";

static const char mtl_text[] =
    "# a\nnewmtl r\nKd .1 .2 .3\nKs 1\nKe 0 0 1e1\nNs 10\nNi 1.5\nd .5\nTr .5\nTf 1 1 1\nillum 2\n"
    "map_Kd -s 1 2 -clamp on a b.png\nmap_d d.png\nnewmtl b c # d\nbump -bm .5 x.png\n"
    "Kd spectral f 1\nKd xyz 1 1 1\nPr 1 \\\n2\nd -halo .5\n"
    "newmtl p\nPm .5\nPc 1\naniso .1\nmap_Pr -bm 1 r.png\nnorm -bm 2 n.png\nmap_Ke e.png\n"
    "map_Ns s.png\nmap_Ks k.png\n";

static const char ply_text[] =
    "ply\nformat ascii 1.0\ncomment a\nelement face 2\nproperty uchar c\n"
    "property list uchar int vertex_indices\nelement vertex 5\nproperty list uchar int l\n"
    "property float x\nproperty float y\nproperty double z\nproperty float nx\nproperty float ny\n"
    "property float nz\nelement tristrips 1\nproperty list int int vertex_index\nend_header\n"
    "1 4 0 1 3 2\n2 5 0 1 4 3 2\n0 0 0 0 0 0 1\n1 7 1 0 0 0 0 2\n0 0 1 0 1 0 0\n"
    "2 8 9 1 1 0 0 0 0\n0 .5 .2 0 0 0 1\n7 0 1 2 -1 2 3 4\n";

static unsigned char *append(unsigned char *at, uint32_t v, int size, bool big)
{
    for (int k = 0; k < size; k++)
        *at++ = (unsigned char)(v >> 8 * (big ? size - 1 - k : k));
    return at;
}

/* Vertices with uv, read by a plan; faces of three to five corners; a strip; an unknown element. */
static size_t make_binary(unsigned char *bytes, bool big)
{
    static const float xy[5][2] = { { 0, 0 }, { 1, 0 }, { 0, 1 }, { 1, 1 }, { 0.5f, 0.25f } };
    static const unsigned char face[3][5] = { { 0, 1, 2 }, { 0, 1, 3, 2 }, { 0, 1, 4, 3, 2 } };
    unsigned char *at = bytes;

    at += sprintf((char *)at, "ply\nformat binary_%s_endian 1.0\nelement vertex 5\nproperty "
                  "float x\nproperty float y\nproperty short z\nproperty uchar u\nproperty uchar "
                  "v\nelement face 3\nproperty list uchar ushort vertex_indices\nproperty char c\n"
                  "element e 1\nproperty list ushort short a\nelement tristrips 1\n"
                  "property list uint char vertex_indices\nend_header\n", big ? "big" : "little");
    for (int i = 0; i < 5; i++) {
        for (int k = 0; k < 2; k++) {
            uint32_t bits;
            memcpy(&bits, &xy[i][k], 4);
            at = append(at, bits, 4, big);
        }
        at = append(at, (uint32_t)i, 2, big);
        *at++ = (unsigned char)i;
        *at++ = 1;
    }
    for (int i = 0; i < 3; i++) {
        *at++ = (unsigned char)(i + 3);
        for (int k = 0; k < i + 3; k++)
            at = append(at, face[i][k], 2, big);
        *at++ = 9;
    }
    at = append(at, 2, 2, big);
    at = append(at, 0x12345678, 4, big);
    at = append(at, 6, 4, big);
    for (int k = 0; k < 6; k++)
        *at++ = (unsigned char)(k == 3 ? 255 : k > 3 ? k - 3 : k);
    return (size_t)(at - bytes);
}

enum { SEEDS = 5 };

static Seed seed_of(int k)
{
    static const char *const texts[3] = { ply_text, obj_text, mtl_text };
    static const MeshFileKind kinds[3] = { FILE_PLY, FILE_OBJ, FILE_MTL };
    Seed s = { FILE_PLY, { 0 }, 0 };

    if (k < 3) {
        s.kind = kinds[k];
        s.n = strlen(texts[k]);
        REQUIRE(s.n <= SEED_MAX, "seed of %lu bytes", (unsigned long)s.n);
        memcpy(s.bytes, texts[k], s.n);
    } else
        s.n = make_binary(s.bytes, k == 4);
    REQUIRE(s.n <= SEED_MAX, "seed of %lu bytes", (unsigned long)s.n);
    return s;
}

/* ---- one input ---- */

/* Reads and checks everything that holds for any input; true if it was read. */
static bool try_bytes(MeshFileKind kind, const unsigned char *bytes, size_t n, const char *what)
{
    const char *fault;
    size_t peak;
    bool ok;
    MeshFile f;

    err_reset();
    mem_fail_at(0, false);
    f = mesh_file_read(kind, "h", bytes, n);
    ok = f.ok;
    peak = mem_peak();
    fault = mesh_file_fault(kind, &f);
    mesh_file_clear(kind, &f);
    if (!fault && mem_blocks())
        fault = "something is kept";
    if (!fault && peak > 16 * n + (1 << 20))
        fault = "too much memory";
    if (!fault && (ok ? err_status() != STATUS_OK || warnings_count() > 1
                      : err_status() != STATUS_INPUT || warnings_count() != 0))
        fault = "messages that do not fit";
    EXPECT(!fault, "%s of %lu bytes: %s", what, (unsigned long)n, fault);
    return ok;
}

/* The same with a copy in a block of its own. */
static bool try_copy(MeshFileKind kind, const unsigned char *bytes, size_t n, const char *what)
{
    unsigned char *block = malloc(n ? n : 1);
    bool ok;
    REQUIRE(block, "memory");
    memcpy(block, bytes, n);
    ok = try_bytes(kind, block, n, what);
    free(block);
    return ok;
}

/* Every byte with every other value, every beginning, every byte left out, and eight put in
 * before every byte. */
static void mutate(int which)
{
    static const unsigned char insert[] = { 0, '\n', ' ', '-', '0', '9', '\\', 255 };
    Seed s = seed_of(which);
    unsigned char *block = malloc(s.n), changed[SEED_MAX + 1];
    long read = 0, tried = 0;

    REQUIRE(block, "memory");
    messages_nowhere();
    EXPECT(try_copy(s.kind, s.bytes, s.n, "the seed"), "the seed was refused");
    memcpy(block, s.bytes, s.n);
    for (size_t i = 0; i < s.n; i++) {
        for (int v = 1; v < 256; v++, tried++) {
            block[i] = (unsigned char)(s.bytes[i] ^ v);
            read += try_bytes(s.kind, block, s.n, "one byte changed");
        }
        block[i] = s.bytes[i];
    }
    free(block);
    for (size_t i = 0; i < s.n; i++) {
        try_copy(s.kind, s.bytes, i, "a beginning");
        memcpy(changed, s.bytes, i);
        memcpy(changed + i, s.bytes + i + 1, s.n - i - 1);
        try_copy(s.kind, changed, s.n - 1, "one byte left out");
        memcpy(changed + i + 1, s.bytes + i, s.n - i);
        for (size_t k = 0; k < sizeof insert; k++) {
            changed[i] = insert[k];
            try_copy(s.kind, changed, s.n + 1, "one byte put in");
        }
    }
    /* Seeds must be neither so strict nor so loose that only one way out is tried. */
    EXPECT(read > tried / 100 && read < tried, "%ld of %ld were read", read, tried);
}

static void mutate_ply_ascii(void) { mutate(0); }
static void mutate_obj(void) { mutate(1); }
static void mutate_mtl(void) { mutate(2); }
static void mutate_ply_little(void) { mutate(3); }
static void mutate_ply_big(void) { mutate(4); }

/* ---- several changes at once ---- */

static size_t change(unsigned char *b, size_t n, size_t room, Rng *rng, const Seed *other)
{
    static const char *const words[] = { "0", "-1", "99999999999", "4294967295", "1e39", "nan",
                                         "\n", " ", "\\\n", "#", "f ", "v ", "1/1/1", "list", "-0",
                                         "usemtl ", "newmtl x\n", "255", "3 0 1 2\n", "\r" };
    size_t at = n ? rng_below(rng, (uint32_t)n) : 0, m, from;
    const char *w;

    switch (rng_below(rng, 6)) {
    case 0:                                              /* a byte */
        if (n)
            b[at] = (unsigned char)rng_bits(rng);
        return n;
    case 1:                                              /* a bit */
        if (n)
            b[at] ^= (unsigned char)(1u << rng_below(rng, 8));
        return n;
    case 2:                                              /* a piece left out */
        m = rng_below(rng, 20);
        m = m < n - at ? m : n - at;
        memmove(b + at, b + at + m, n - at - m);
        return n - m;
    case 3:                                              /* a word put in */
        w = words[rng_below(rng, sizeof words / sizeof *words)];
        m = strlen(w);
        if (n + m > room)
            return n;
        memmove(b + at + m, b + at, n - at);
        memcpy(b + at, w, m);
        return n + m;
    case 4:                                              /* a word put over */
        w = words[rng_below(rng, sizeof words / sizeof *words)];
        m = strlen(w) < n - at ? strlen(w) : n - at;
        memcpy(b + at, w, m);
        return n;
    default:                                             /* a piece of a seed put in */
        from = rng_below(rng, (uint32_t)other->n);
        m = 1 + rng_below(rng, 60);
        m = m < other->n - from ? m : other->n - from;
        if (n + m > room)
            return n;
        memmove(b + at + m, b + at, n - at);
        memcpy(b + at, other->bytes + from, m);
        return n + m;
    }
}

static void fuzz(uint64_t key, long runs)
{
    Rng rng = rng_seed(key);
    unsigned char b[2 * SEED_MAX];
    Seed seeds[SEEDS];

    messages_nowhere();
    for (int k = 0; k < SEEDS; k++)
        seeds[k] = seed_of(k);
    for (long r = 0; r < runs; r++) {
        const Seed *s = &seeds[rng_below(&rng, SEEDS)];
        size_t n = s->n;
        memcpy(b, s->bytes, n);
        for (uint32_t k = 1 + rng_below(&rng, 8); k; k--)
            n = change(b, n, sizeof b, &rng, &seeds[rng_below(&rng, SEEDS)]);
        try_copy(s->kind, b, n, "random changes");
    }
}

static void fuzz_short(void) { fuzz(1, 50000); }
static void fuzz_long(void) { fuzz(2, 10000000); }

/* ---- much for little ---- */

typedef struct { unsigned char *bytes; size_t n, room; } Big;

static void add(Big *b, const char *s)
{
    size_t m = strlen(s);
    if (b->n + m > b->room) {
        b->room = 2 * b->room + m + 1000;
        b->bytes = realloc(b->bytes, b->room);
        REQUIRE(b->bytes, "memory");
    }
    memcpy(b->bytes + b->n, s, m);
    b->n += m;
}

static void add_byte(Big *b, unsigned char c)
{
    add(b, "x");
    b->bytes[b->n - 1] = c;
}

enum { MUCH = 3000000 };                        /* bytes: 1 MiB is little against 16 times that */

static void add_until_much(Big *b, const char *s)
{
    while (b->n < MUCH)
        add(b, s);
}

static void greedy(Big *b, MeshFileKind kind, bool ok, const char *what)
{
    EXPECT(try_copy(kind, b->bytes, b->n, what) == ok, "%s: %s", what, ok ? "refused" : "read");
    free(b->bytes);
    *b = (Big){ NULL, 0, 0 };
}

static void greedy_obj(void)
{
    Big b = { NULL, 0, 0 };
    char line[100];

    messages_nowhere();
    add(&b, "v 0 0 0\nf");
    add_until_much(&b, " 1");
    greedy(&b, FILE_OBJ, true, "one face");
    add(&b, "v 0 0 0\nvt 0\nf");
    add_until_much(&b, " 1/1");
    greedy(&b, FILE_OBJ, true, "one face of vertices with uv");
    add(&b, "v 0 0 0\n");
    add_until_much(&b, "f 1 1 1\n");
    greedy(&b, FILE_OBJ, true, "triangles");
    add(&b, "v 0 0 0\n");
    add_until_much(&b, "f 1 1 1 1 1 1 1 1 1 1\n");
    greedy(&b, FILE_OBJ, true, "polygons");
    add_until_much(&b, "v 0 0 0\n");
    greedy(&b, FILE_OBJ, true, "vertices");
    add_until_much(&b, "vn 0 0 0\nvt 0\n");
    greedy(&b, FILE_OBJ, true, "normals");
    for (int k = 0; k < 1000; k++)
        add(&b, "v 0 0 0\nvt 0\nvn 0 0 0\n");
    add(&b, "f");
    for (int v = 1, t = 1; b.n < MUCH; v = v % 1000 + 1, t += v == 1) {
        snprintf(line, sizeof line, " %d/%d", v, t);
        add(&b, line);
    }
    greedy(&b, FILE_OBJ, true, "distinct corners");
    add(&b, "v 0 0 0\n");
    for (int k = 0; b.n < MUCH; k++) {
        snprintf(line, sizeof line, "usemtl %x\nf 1 1 1\n", k);
        add(&b, line);
    }
    greedy(&b, FILE_OBJ, true, "groups");
    add(&b, "mtllib");
    for (int k = 0; b.n < MUCH; k++) {
        snprintf(line, sizeof line, " %x", k);
        add(&b, line);
    }
    greedy(&b, FILE_OBJ, true, "libraries");
    add_until_much(&b, "usemtl a\nmtllib a\nx\n");
    greedy(&b, FILE_OBJ, true, "statements");
    add_until_much(&b, "\\\n");
    greedy(&b, FILE_OBJ, true, "continuations");
}

static void greedy_mtl(void)
{
    Big b = { NULL, 0, 0 };
    char line[40];

    messages_nowhere();
    add_until_much(&b, "newmtl a\n");
    greedy(&b, FILE_MTL, true, "materials");
    for (int k = 0; b.n < MUCH; k++) {
        snprintf(line, sizeof line, "newmtl %x\nbump b\n", k);
        add(&b, line);
    }
    greedy(&b, FILE_MTL, true, "materials with maps");
    add(&b, "newmtl a\n");
    add_until_much(&b, "bump b\n");
    greedy(&b, FILE_MTL, true, "maps");
    add_until_much(&b, "\\\n");
    greedy(&b, FILE_MTL, true, "continuations");
}

#define XYZ "property uchar x\nproperty uchar y\nproperty uchar z\n"

static void greedy_ply(void)
{
    Big b = { NULL, 0, 0 };
    char line[200];
    size_t at;

    messages_nowhere();
    add(&b, "ply\nformat ascii 1.0\nelement vertex 1\n" XYZ "element face 1\nproperty list uint "
            "int vertex_indices\nend_header\n0 0 0\n1499900");
    for (int k = 0; k < 1499900; k++)
        add(&b, " 0");
    greedy(&b, FILE_PLY, true, "one face of text");
    add(&b, "ply\nformat ascii 1.0\nelement vertex 1\n" XYZ "element face 300000\nproperty list "
            "uint int vertex_indices\nend_header\n0 0 0\n");
    for (int k = 0; k < 300000; k++)
        add(&b, "3 0 0 0\n");
    greedy(&b, FILE_PLY, true, "triangles of text");
    for (int strip = 0; strip < 2; strip++) {
        snprintf(line, sizeof line, "ply\nformat binary_big_endian 1.0\nelement vertex 1\n" XYZ
                 "element %s 1\nproperty list uint char vertex_indices\nend_header\n%c%c%c",
                 strip ? "tristrips" : "face", 1, 1, 1);
        add(&b, line);
        for (int k = 3; k >= 0; k--)
            add_byte(&b, (unsigned char)((uint32_t)MUCH >> 8 * k));
        for (int k = 0; k < MUCH; k++)
            add_byte(&b, 0);
        greedy(&b, FILE_PLY, true, strip ? "one strip of bytes" : "one face of bytes");
    }
    /* Many face elements: the room for triangles must not grow by halves. */
    add(&b, "ply\nformat binary_big_endian 1.0\nelement vertex 1\n" XYZ);
    for (int k = 0; k < 20; k++)
        add(&b, "element face 10000\nproperty list uchar uchar vertex_index\n");
    add(&b, "end_header\nxyz");
    for (int k = 0; k < 200000; k++) {
        add_byte(&b, 14);
        for (int c = 0; c < 14; c++)
            add_byte(&b, 0);
    }
    greedy(&b, FILE_PLY, true, "many face elements");
    add(&b, "ply\nformat binary_big_endian 1.0\nelement vertex 300000\n" XYZ "property char nx\n"
            "property char ny\nproperty char nz\nproperty char u\nproperty char v\nend_header\n");
    for (int k = 0; k < 8 * 300000; k++)
        add_byte(&b, 1);
    greedy(&b, FILE_PLY, true, "vertices of bytes");
    add(&b, "ply\nformat ascii 1.0\nelement vertex 0\n");
    add_until_much(&b, "element a 0\n");
    add(&b, "end_header\n");
    greedy(&b, FILE_PLY, true, "elements");
    add(&b, "ply\nformat ascii 1.0\nelement vertex 0\n");
    add_until_much(&b, "property int x\n");
    add(&b, "end_header\n");
    greedy(&b, FILE_PLY, true, "properties");
    add(&b, "ply\nformat binary_big_endian 1.0\nelement vertex 0\nelement none "
            "9000000000000000000\nelement face 0\nend_header\n");
    greedy(&b, FILE_PLY, true, "nine quintillion records of nothing");
    add(&b, "ply\nformat ascii 1.0\nelement none 9000000000000000000\nelement vertex 0\n"
            "end_header\n");
    greedy(&b, FILE_PLY, true, "the same in text");
    for (at = 0; at < 2; at++) {
        snprintf(line, sizeof line, "ply\nformat %s 1.0\nelement vertex 4294967295\n" XYZ
                 "end_header\n", at ? "ascii" : "binary_little_endian");
        add(&b, line);
        greedy(&b, FILE_PLY, false, "an absurd count");
        snprintf(line, sizeof line, "ply\nformat %s 1.0\nelement vertex 0\nelement face "
                 "9223372036854775807\nproperty list uchar int vertex_index\nend_header\n",
                 at ? "ascii" : "binary_little_endian");
        add(&b, line);
        greedy(&b, FILE_PLY, false, "an absurd count of faces");
    }
}

/* Ids whose hashes are all one: the search for one ends after LOOKUP_PROBES steps, some are not
 * entered, and those of other hashes are not in their way. */
static void colliding_hashes(void)
{
    enum { SAME = 100000, OTHERS = 1000 };
    const uint32_t hash = 0xFFFFFFF0u;                  /* its slots wrap about the end */
    Lookup l = { NULL, 0, 0 };
    uint32_t probe = 0, found = 0, id;

    for (uint32_t i = 0; i < OTHERS; i++)
        REQUIRE(lookup_add(&l, (uint32_t)mix64(i), i), "memory");
    for (uint32_t i = 0; i < SAME; i++)
        REQUIRE(lookup_add(&l, hash, OTHERS + i), "memory");
    while ((id = lookup_next(&l, hash, &probe)) != LOOKUP_NONE) {
        EXPECT(id >= OTHERS && id < OTHERS + SAME, "id %lu of another hash", (unsigned long)id);
        found++;
    }
    EXPECT(found > 0 && found <= LOOKUP_PROBES, "%lu found", (unsigned long)found);
    EXPECT(l.size <= 4 * (OTHERS + LOOKUP_PROBES), "%lu slots", (unsigned long)l.size);
    for (uint32_t i = 0; i < OTHERS; i++) {
        probe = 0;
        do
            id = lookup_next(&l, (uint32_t)mix64(i), &probe);
        while (id != i && id != LOOKUP_NONE);
        EXPECT(id == i, "id %lu lost", (unsigned long)i);
    }
    lookup_clear(&l);
    EXPECT(mem_blocks() == 0, "%ld blocks left", mem_blocks());
}

/* 90,000 distinct corners out of 300 positions stay distinct. */
static void many_corners(void)
{
    enum { SIDE = 300 };
    Big b = { NULL, 0, 0 };
    char line[100];
    MeshFile f;

    messages_nowhere();
    for (int k = 0; k < SIDE; k++)
        add(&b, "v 0 0 0\nvt 0 0\n");
    for (int v = 1; v <= SIDE; v++)
        for (int t = 1; t <= SIDE; t++) {
            snprintf(line, sizeof line, "f %d/%d %d/%d %d/%d\n", v, t, t, v, v, v);
            add(&b, line);
        }
    f = mesh_file_read(FILE_OBJ, "h", b.bytes, b.n);
    EXPECT(f.ok && f.mesh.nverts == SIDE * SIDE && f.mesh.ntris == SIDE * SIDE,
           "%lu vertices, %d expected", (unsigned long)f.mesh.nverts, SIDE * SIDE);
    mesh_file_clear(FILE_OBJ, &f);
    free(b.bytes);
}

/* ---- memory that fails ---- */

static void out_of_memory(void)
{
    messages_nowhere();
    for (int which = 0; which < SEEDS; which++)
        for (int on = 0; on < 2; on++) {
            Seed s = seed_of(which);
            unsigned long k, calls;
            bool ok = false;
            for (k = 1; !ok && k < 1000; k++) {
                MeshFile f;
                err_reset();
                mem_fail_at(k, on);
                f = mesh_file_read(s.kind, "h", s.bytes, s.n);
                calls = mem_calls();
                ok = f.ok;
                EXPECT(ok == (calls < k), "seed %d: allocation %lu failed and was ignored", which,
                       k);
                EXPECT(ok || err_status() == STATUS_OUTPUT, "seed %d: status", which);
                mem_fail_at(0, false);
                EXPECT(!mesh_file_fault(s.kind, &f), "seed %d: %s", which,
                       mesh_file_fault(s.kind, &f));
                mesh_file_clear(s.kind, &f);
                EXPECT(mem_blocks() == 0, "seed %d: %ld blocks left", which, mem_blocks());
            }
            EXPECT(ok && k > 3, "seed %d: %lu allocations", which, k);
        }
}

const TestCase test_mesh_hostile[] = {
    { "mutate-ply-ascii", mutate_ply_ascii, false },
    { "mutate-ply-little", mutate_ply_little, false },
    { "mutate-ply-big", mutate_ply_big, false },
    { "mutate-obj", mutate_obj, false },
    { "mutate-mtl", mutate_mtl, false },
    { "fuzz-short", fuzz_short, false },
    { "fuzz-long", fuzz_long, true },
    { "greedy-obj", greedy_obj, false },
    { "greedy-mtl", greedy_mtl, false },
    { "greedy-ply", greedy_ply, false },
    { "colliding-hashes", colliding_hashes, false },
    { "many-corners", many_corners, false },
    { "out-of-memory", out_of_memory, false },
    { NULL, NULL, false }
};

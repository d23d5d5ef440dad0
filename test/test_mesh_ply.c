/* test_mesh_ply.c -- PLY in every encoding and with every type, and PLY written and read again. */
#include "test/mesh_help.h"

#include "base/file.h"
#include "geometry/generate.h"

#include <stdio.h>
#include <string.h>

#define XYZ "property float x\nproperty float y\nproperty float z\n"
#define LIST "property list uchar int vertex_indices\n"

/* ---- every encoding and type ---- */

typedef enum { ASCII, LITTLE, BIG, ENCODINGS } Encoding;
typedef enum { I8, U8, I16, U16, I32, U32, F32, F64, TYPES } Type;

static const char *const type_names[2][TYPES] = {
    { "char", "uchar", "short", "ushort", "int", "uint", "float", "double" },
    { "int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64" }
};

typedef struct { unsigned char bytes[20000]; size_t n; Encoding e; } Bytes;

static void put_text(Bytes *b, const char *s)
{
    memcpy(b->bytes + b->n, s, strlen(s));
    b->n += strlen(s);
}

/* A whole number as a value of any type; in text followed by a blank. */
static void put(Bytes *b, Type t, int v)
{
    static const int sizes[] = { 1, 1, 2, 2, 4, 4, 4, 8 };
    uint64_t bits = (uint64_t)(int64_t)v;
    char text[20];
    float f = (float)v;
    double d = v;
    uint32_t half;

    if (b->e == ASCII) {
        snprintf(text, sizeof text, "%d ", v);
        put_text(b, text);
        return;
    }
    if (t == F32) {
        memcpy(&half, &f, 4);
        bits = half;
    } else if (t == F64)
        memcpy(&bits, &d, 8);
    for (int k = 0; k < sizes[t]; k++)
        b->bytes[b->n++] = (unsigned char)(bits >> 8 * (b->e == LITTLE ? k : sizes[t] - 1 - k));
}

static void end_record(Bytes *b)
{
    if (b->e == ASCII)
        put_text(b, "\n");
}

enum { VERTS_OUT = 40, FACES_OUT = 25 };

/* Writes a mesh of small whole numbers, with values of type tv, counts of tc and indices of ti;
 * `odd` puts lists and unknown values between them, and the faces first. */
static void put_vertices(Bytes *b, Type tv, bool odd)
{
    for (int i = 0; i < VERTS_OUT; i++) {
        if (odd) {
            put(b, U8, i % 3);
            for (int k = 0; k < i % 3; k++)
                put(b, I16, -k);
        }
        put(b, F64, 77);
        put(b, tv, i);
        put(b, tv, i * i % 50);
        put(b, I8, -1);
        put(b, tv, 100 - i);
        end_record(b);
    }
}

static void put_faces(Bytes *b, Type tc, Type ti, bool odd)
{
    for (int i = 0; i < FACES_OUT; i++) {
        int n = odd ? 3 + i % 4 : 3;
        put(b, U16, i);
        put(b, tc, n);
        for (int k = 0; k < n; k++)
            put(b, ti, (i + k * k) % VERTS_OUT);
        if (odd) {
            put(b, U32, 1);
            put(b, F32, 5);
        }
        end_record(b);
    }
}

static void put_ply(Bytes *b, Encoding e, Type tv, Type tc, Type ti, bool odd)
{
    static const char *const formats[] = { "ascii", "binary_little_endian", "binary_big_endian" };
    const char *const *names = type_names[odd];
    char vertices[400], faces[300];

    b->n = 0;
    b->e = e;
    put_text(b, "ply\nformat ");
    put_text(b, formats[e]);
    put_text(b, " 1.0\n");
    snprintf(vertices, sizeof vertices, "element vertex %d\n%sproperty double q\nproperty %s x\n"
             "property %s y\nproperty int8 w\nproperty %s z\n", VERTS_OUT,
             odd ? "property list uchar short l\n" : "", names[tv], names[tv], names[tv]);
    snprintf(faces, sizeof faces, "element face %d\nproperty uint16 id\nproperty list %s %s "
             "vertex_indices\n%s", FACES_OUT, names[tc], names[ti],
             odd ? "property list uint float f\n" : "");
    put_text(b, odd ? faces : vertices);
    put_text(b, odd ? vertices : faces);
    put_text(b, "end_header\n");
    if (odd)
        put_faces(b, tc, ti, odd);
    put_vertices(b, tv, odd);
    if (!odd)
        put_faces(b, tc, ti, odd);
}

static void check_encoding(const Bytes *b, const char *what, bool odd)
{
    Mesh m;
    uint32_t ntris = 0;

    REQUIRE(ply_read(&m, what, b->bytes, b->n), "%s: refused", what);
    EXPECT(m.nverts == VERTS_OUT && !mesh_fault(&m), "%s: vertices", what);
    for (int i = 0; i < VERTS_OUT; i++)
        EXPECT(v3_is(m.p[i], (float)i, (float)(i * i % 50), (float)(100 - i)), "%s: vertex %d",
               what, i);
    for (int i = 0; i < FACES_OUT; i++) {
        int n = odd ? 3 + i % 4 : 3;
        const uint32_t *v = m.tri[ntris].v;
        if (n == 3)
            EXPECT(v[0] == (uint32_t)i && v[1] == (uint32_t)(i + 1) % VERTS_OUT &&
                   v[2] == (uint32_t)(i + 4) % VERTS_OUT, "%s: face %d", what, i);
        ntris += (uint32_t)n - 2;
    }
    EXPECT(m.ntris == ntris, "%s: %lu triangles", what, (unsigned long)m.ntris);
    mesh_clear(&m);
}

static void ply_encodings(void)
{
    static Bytes b;
    char what[80];

    for (int e = 0; e < ENCODINGS; e++)
        for (int tv = 0; tv < TYPES; tv++)
            for (int tc = 0; tc < F32; tc++)
                for (int ti = 0; ti < F32; ti++)
                    for (int odd = 0; odd < 2; odd++) {
                        put_ply(&b, (Encoding)e, (Type)tv, (Type)tc, (Type)ti, odd);
                        snprintf(what, sizeof what, "encoding %d, types %s %s %s%s", e,
                                 type_names[0][tv], type_names[0][tc], type_names[0][ti],
                                 odd ? ", odd" : "");
                        check_encoding(&b, what, odd);
                    }
}

/* Values at the ends of their types, the same from both byte orders; and what no float holds. */
static void ply_extremes(void)
{
    static const char tail[] = "\nproperty float y\nproperty float z\nend_header\n";
    static const struct {
        const char *type;
        unsigned char big[8];
        size_t n;
        double v;
    } cases[] = {
        { "char", { 0x80 }, 1, -128 }, { "char", { 0x7F }, 1, 127 }, { "uchar", { 0xFF }, 1, 255 },
        { "short", { 0x80, 0 }, 2, -32768 }, { "short", { 0x7F, 0xFF }, 2, 32767 },
        { "ushort", { 0xFE, 0xFF }, 2, 65279 }, { "int", { 0x80, 0, 0, 0 }, 4, -2147483648.0 },
        { "int", { 0xFF, 0xFF, 0xFF, 0xFE }, 4, -2 },
        { "uint", { 0xFF, 0, 0, 0 }, 4, 4278190080.0 },
        { "float", { 0x3F, 0x80, 0, 1 }, 4, 1.00000011920928955 },
        { "float", { 0x7F, 0x7F, 0xFF, 0xFF }, 4, 0x1.fffffep127 },
        { "float", { 0x80, 0, 0, 1 }, 4, -0x1p-149 },
        { "double", { 0xC0, 9, 0x21, 0xFB, 0x40, 0, 0, 0 }, 8, -3.14159250259399414 },
        { "double", { 0x3F, 0xF0, 0, 0, 0x10, 0, 0, 0 }, 8, 1.0 },
        { "float", { 0x7F, 0x80, 0, 0 }, 4, INFINITY },
        { "float", { 0xFF, 0xC0, 0, 0 }, 4, INFINITY },
        { "double", { 0x7F, 0xF0, 0, 0, 0, 0, 0, 0 }, 8, INFINITY },
        { "double", { 0x47, 0xF0, 0, 0, 0, 0, 0, 0 }, 8, INFINITY },
        { "double", { 0xC7, 0xEF, 0xFF, 0xFF, 0xE0, 0, 0, 1 }, 8, INFINITY }
    };
    char line[300];

    messages_start();
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++)
        for (int big = 0; big < 2; big++) {
            unsigned char b[300];
            size_t n = (size_t)sprintf((char *)b, "ply\nformat binary_%s_endian 1.0\nelement "
                                       "vertex 1\nproperty %s x%s", big ? "big" : "little",
                                       cases[c].type, tail);
            Mesh m;
            bool ok;
            for (size_t k = 0; k < cases[c].n; k++)
                b[n + k] = cases[c].big[big ? k : cases[c].n - 1 - k];
            memset(b + n + cases[c].n, 0, 8);
            ok = ply_read(&m, "x.ply", b, n + cases[c].n + 8);
            messages_take(line, sizeof line);
            EXPECT(ok == (cases[c].v < INFINITY), "case %d", (int)c);
            EXPECT(!ok || (double)m.p[0].x == cases[c].v, "case %d: %.17g", (int)c,
                   ok ? (double)m.p[0].x : 0.0);
            EXPECT(ok || strstr(line, "byte "), "'%s'", line);
            mesh_clear(&m);
        }
}

/* A body that begins with the byte of a line end, after headers of each kind of line end. */
static void ply_line_ends(void)
{
    static const char *const ends[] = { "\n", "\r\n", "\r" };

    for (int k = 0; k < 3; k++) {
        unsigned char b[300];
        const char *e = ends[k];
        size_t n = (size_t)sprintf((char *)b, "ply%sformat binary_little_endian 1.0%selement "
                                   "vertex 1%sproperty uchar x%sproperty uchar y%sproperty uchar "
                                   "z%send_header%s\n\r\n", e, e, e, e, e, e, e);
        Mesh m;
        REQUIRE(ply_read(&m, "e.ply", b, n), "refused");
        EXPECT(v3_is(m.p[0], 10, 13, 10), "line end %d: %g %g %g", k, (double)m.p[0].x,
               (double)m.p[0].y, (double)m.p[0].z);
        mesh_clear(&m);
    }
}

static void ply_binary_faults(void)
{
    static const char head[] = "ply\nformat binary_big_endian 1.0\nelement vertex 3\n" XYZ
                               "element face 1\n" LIST "end_header\n";
    unsigned char b[400] = { 0 };
    size_t n = sizeof head - 1, body = n;
    char line[300], place[80];
    Mesh m;

    messages_start();
    memcpy(b, head, n);
    n += 36;
    b[n++] = 3;
    b[n + 3] = 0;
    b[n + 7] = 1;
    b[n + 11] = 3;                                       /* of 0, 1, 2 */
    n += 12;
    EXPECT(!ply_read(&m, "f.ply", b, n), "index 3 of 3");
    messages_take(line, sizeof line);
    snprintf(place, sizeof place, "f.ply: byte %d, record 1", (int)(body + 36 + 9));
    EXPECT(strstr(line, place) && strstr(line, "index 3, 3 vertices"), "'%s'", line);
    b[n - 1] = 2;
    EXPECT(!ply_read(&m, "f.ply", b, n - 1), "a byte is missing");
    messages_take(line, sizeof line);
    EXPECT(strstr(line, "a list of 3 values does not fit into the 11 bytes left"), "'%s'", line);
    b[body + 16] = 0x7F;
    b[body + 17] = 0xC0;
    EXPECT(!ply_read(&m, "f.ply", b, n), "NaN");
    messages_take(line, sizeof line);
    snprintf(place, sizeof place, "f.ply: byte %d, record 2 of element 'vertex'", (int)(body + 12));
    EXPECT(strstr(line, place), "'%s'", line);
    b[body + 16] = b[body + 17] = 0;
    EXPECT(ply_read(&m, "f.ply", b, n) && m.ntris == 1, "whole");
    EXPECT(messages_take(line, sizeof line) == 0, "'%s'", line);
    mesh_clear(&m);
    b[n] = 7;
    EXPECT(ply_read(&m, "f.ply", b, n + 1), "one byte more");
    EXPECT(messages_take(line, sizeof line) == 1 && strstr(line, "after the last"), "'%s'", line);
    mesh_clear(&m);
}

/* ---- writing ---- */

static bool same_mesh(const Mesh *a, const Mesh *b)
{
    return a->nverts == b->nverts && a->ntris == b->ntris && !a->n == !b->n && !a->uv == !b->uv &&
           !memcmp(a->p, b->p, a->nverts * sizeof *a->p) &&
           (!a->n || !memcmp(a->n, b->n, a->nverts * sizeof *a->n)) &&
           (!a->uv || !memcmp(a->uv, b->uv, a->nverts * sizeof *a->uv)) &&
           !memcmp(a->tri, b->tri, a->ntris * sizeof *a->tri);
}

static void check_written(Mesh *m, const char *path)
{
    Mesh back;
    REQUIRE(ply_write(m, path), "cannot write");
    back = mesh_of_ply(path);
    EXPECT(same_mesh(m, &back), "not what was written: %s%s", m->n ? "normals " : "",
           m->uv ? "uv" : "");
    mesh_clear(&back);
}

static void ply_writing(void)
{
    char path[300], line[300];
    Mesh m;

    snprintf(path, sizeof path, "%s/w.ply", test_folder());
    REQUIRE(mesh_bumpy(&m, 20, 1), "bumpy");
    check_written(&m, path);
    mesh_clear(&m);
    REQUIRE(mesh_grid(&m, 5, 6), "grid");
    check_written(&m, path);
    m.n = MEM_ARRAY(V3, m.nverts);
    REQUIRE(m.n, "memory");
    m.n[1] = v3(0.0f, 0.0f, -1.0f);                     /* exactly unit, so it stays */
    check_written(&m, path);
    messages_start();
    for (unsigned long k = 1; k < 6; k++) {              /* whatever fails, the old file stays */
        Mesh back;
        file_fail_at(k, true, 28);
        EXPECT(!ply_write(&m, path), "written although operation %lu failed", k);
        file_fail_at(0, false, 0);
        EXPECT(messages_take(line, sizeof line) == 1, "messages of failure %lu: '%s'", k, line);
        back = mesh_of_ply(path);
        EXPECT(same_mesh(&m, &back), "failure %lu hurt the old file", k);
        mesh_clear(&back);
        if (file_calls() < k)
            break;
    }
    mesh_clear(&m);
    EXPECT(mem_blocks() == 0, "%ld blocks left", mem_blocks());
}

const TestCase test_mesh_ply[] = {
    { "encodings", ply_encodings, false },
    { "extremes", ply_extremes, false },
    { "line-ends", ply_line_ends, false },
    { "binary-faults", ply_binary_faults, false },
    { "writing", ply_writing, false },
    { NULL, NULL, false }
};

/* test_scenefile_hostile.c -- broken and hostile scenes: every change of one byte of small scenes,
 * an OBJ with its MTL, every allocation and every file operation failing, and files that want much
 * memory or time for little text. Whatever comes, a scene is read, or refused with one line and
 * nothing kept, within 16 bytes a byte and 1 MiB. Under ASan and UBSan (make check V=asan) this
 * also shows that nothing is read out of bounds: the text stands in a block of exactly its size. */
#include "base/random.h"
#include "test/mesh_help.h"
#include "test/scene_help.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SEED_MAX = 512 };

/* Four seeds that together hold every directive but Include, and every form of value. */
static const char *const seeds[] = {
    "Option \"seed\" 1\nLookAt 0 -5 1 0 0 0 0 0 1\nRotate -5 0 0 1 # x\n"
    "Camera \"perspective\" \"float fov\"[40]\n"
    "Film \"rgb\" \"integer xresolution\" 9 \"string filename\" \"a\\\"b\"\n"
    "Sampler \"a\" PixelFilter \"box\" Accelerator \"b\"\n"
    "Integrator \"path\" \"integer maxdepth\" 5 \"bool c\" true\nColorSpace \"rec2020\"\n"
    "WorldBegin\n"
    "LightSource \"point\" \"blackbody I\" [3000 2] \"point3 from\" [1 2 3]\n"
    "LightSource \"infinite\" \"spectrum L\" [400 1 700 2]\n"
    "MakeNamedMedium \"m\" MediumInterface \"m\" \"\"",

    "WorldBegin\nAttributeBegin\nAreaLightSource \"diffuse\" \"rgb L\"[2 2 2]\n"
    "Material \"matte\" \"color Kd\" [0 0 0]\nTranslate 0 0 9\n"
    "Shape \"sphere\" \"float radius\" [.5]\nAttributeEnd\nTransformBegin Scale 1 2 1\n"
    "ConcatTransform [1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1] TransformEnd ReverseOrientation\n"
    "Shape \"trianglemesh\" \"point P\" [0 0 0 1 0 0 0 1 0 1 1 0] \"integer indices\" "
    "[0 1 2 2 1 3]\n\"float st\" [0 0 1 0 0 1 1 1] \"normal N\" [0 0 1 0 0 1 0 0 1 0 0 1]\n"
    "Attribute \"shape\" \"float radius\" 2 Shape \"disk\"",

    "WorldBegin Texture \"c\" \"spectrum\" \"checkerboard\" \"float uscale\" [2] \"rgb tex1\" "
    "[.1 .1 .1]\nTexture \"s\" \"color\" \"scale\" \"texture tex1\" \"c\" \"float tex2\" .5\n"
    "MakeNamedMaterial \"a\" \"string type\" [\"glass\"] \"float eta\" 1.5\n"
    "MakeNamedMaterial \"b\" \"string type\" \"matte\" \"texture Kd\" \"s\"\nNamedMaterial \"b\"\n"
    "ObjectBegin \"o\" Shape \"disk\" ObjectEnd\nCoordinateSystem \"w\" CoordSysTransform \"w\"\n"
    "ObjectInstance \"o\" Material \"mix\" \"string materials\" [\"a\" \"b\"]\n"
    "Material \"metal\" \"spectrum eta\" \"metal-Au-eta\"",

    "WorldBegin ActiveTransform EndTime Identity ActiveTransform All\n"
    "Transform [1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1] TransformTimes 0 1\n"
    "Shape \"loopsubdiv\" \"string scheme\" \"loop\" \"point P\" [1 0 0 0 1 0 0 0 1]\n"
    "Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0]\n"
    "Shape \"heightfield\" \"integer nu\" 2 \"integer nv\" 2 \"float Pz\" [0 0 0 1]\n"
    "Shape \"geometryimage\" \"integer side\" 9\n"
    "Shape \"cylinder\" \"float phimax\" 9 Shape \"nurbs\" \"xyz a\" [1 1 1]\n"
    "Material \"conductor\" \"bool remaproughness\" \"false\" Material \"\" WorldEnd",

    "WorldBegin MakeNamedMaterial \"d\" \"string type\" \"disney\" \"rgb color\" [.8 .2 0]\n"
    "\"float metallic\" .5 \"float spectrans\" .2 \"float anisotropic\" .1 \"float sheen\" 1\n"
    "MakeNamedMaterial \"u\" \"string type\" \"uber\" \"rgb opacity\" [0 1 .5]\n"
    "Material \"mix\" \"string materials\" [\"d\" \"u\"] \"rgb amount\" [1 0 .5]\n"
    "Material \"coatedconductor\" \"float interface.eta\" 1.3 \"float albedo\" 0\n"
    "\"string normalmap\" \"n.jpg\""
};
enum { SEEDS = sizeof seeds / sizeof *seeds };

/* ---- one input ---- */

/* Reads and checks what holds for any text; true if it was read. */
static bool try_text(const char *text, size_t n, const char *what)
{
    ReadLimits limits = READ_LIMITS_DEFAULT;
    const char *fault = NULL;
    SceneFile f;
    size_t peak;
    bool ok;

    err_reset();
    mem_fail_at(0, false);
    ok = scenefile_parse(&f, "h/test.pbrt", text, n, &limits);
    peak = mem_peak();
    if (ok)
        scenefile_clear(&f);
    if (mem_blocks())
        fault = "something is kept";
    else if (peak > 16 * n + (1 << 20))
        fault = "too much memory";
    else if (ok ? err_status() != STATUS_OK : err_status() != STATUS_INPUT)
        fault = "a status that does not fit";
    EXPECT(!fault, "%s of %lu bytes: %s: %.*s", what, (unsigned long)n, fault, (int)n, text);
    return ok;
}

/* The same with the text in a block of its own, and never more than one line of error. */
static bool try_copy(const char *text, size_t n, const char *what)
{
    char line[2000], *block = malloc(n ? n : 1);
    int lines;
    bool ok;

    REQUIRE(block, "memory");
    memcpy(block, text, n);
    ok = try_text(block, n, what);
    free(block);
    lines = messages_take(line, sizeof line);
    EXPECT(lines == (int)warnings_count() + !ok, "%s: %d lines, %u warnings: %.*s", what, lines,
           warnings_count(), (int)n, text);
    return ok;
}

/* Every byte with every other value. */
static void mutate(int which)
{
    size_t n = strlen(seeds[which]);
    char *block = malloc(n);
    long read = 0, tried = 0;

    REQUIRE(block && n <= SEED_MAX, "seed of %lu bytes", (unsigned long)n);
    messages_nowhere();
    memcpy(block, seeds[which], n);
    EXPECT(try_text(block, n, "the seed"), "the seed was refused");
    for (size_t i = 0; i < n; i++) {
        for (int v = 1; v < 256; v++, tried++) {
            block[i] = (char)((unsigned char)seeds[which][i] ^ v);
            read += try_text(block, n, "one byte changed");
        }
        block[i] = seeds[which][i];
    }
    free(block);
    /* Seeds must be neither so strict nor so loose that only one way out is tried. */
    EXPECT(read > tried / 100 && read < tried, "%ld of %ld were read", read, tried);
}

static void mutate_options(void) { mutate(0); }
static void mutate_attributes(void) { mutate(1); }
static void mutate_names(void) { mutate(2); }
static void mutate_shapes(void) { mutate(3); }
static void mutate_materials(void) { mutate(4); }

/* Every beginning, every byte left out or doubled, eight bytes put in before every byte; and, as a
 * sample of the changes above, one line of error each. */
static void cut(void)
{
    static const char insert[] = { 0, '\n', ' ', '-', '9', '"', '[', (char)255 };
    char changed[SEED_MAX + 1];

    messages_start();
    for (int k = 0; k < SEEDS; k++) {
        const char *s = seeds[k];
        size_t n = strlen(s);
        for (size_t i = 0; i < n; i++) {
            try_copy(s, i, "a beginning");
            memcpy(changed, s, i);
            memcpy(changed + i, s + i + 1, n - i - 1);
            try_copy(changed, n - 1, "one byte left out");
            memcpy(changed + i + 1, s + i, n - i);
            changed[i] = s[i];
            try_copy(changed, n + 1, "one byte doubled");
            for (size_t b = 0; b < sizeof insert; b++) {
                changed[i] = insert[b];
                try_copy(changed, n + 1, "one byte put in");
            }
            memcpy(changed, s, n);
            for (int bit = 0; bit < 8; bit++) {
                changed[i] = (char)((unsigned char)s[i] ^ 1u << bit);
                try_copy(changed, n, "one bit changed");
            }
        }
    }
}

/* ---- an OBJ file and its MTL file ---- */

static const char obj_text[] =
    "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 1\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\n"
    "usemtl a\nf 1 2 4\nusemtl b\nf -1 3 4\nusemtl c\nf 2 3 4\n";
static const char mtl_text[] =
    "newmtl a\nKd .1 .2 .3\nKs .9 1 .5\nNs 9\nmap_Kd x.tga\nbump n.ppm\nnewmtl b\nKe 1 2 3\n"
    "map_Ke n.ppm\nPr .5\nmap_Pm n.ppm\nnewmtl c\nillum 7\nNi 1.5\nTf 1 .5 1\nd .5\n";

/* Without the care of file_write, which waits for the disc. */
static void overwrite(const char *path, const char *bytes, size_t n)
{
    FILE *f = fopen(path, "wb");
    REQUIRE(f && fwrite(bytes, 1, n, f) == n && !fclose(f), "cannot write %s", path);
}

static bool try_pair(const char *path, const char *what)
{
    ReadLimits limits = READ_LIMITS_DEFAULT;
    SceneFile f;
    bool ok;

    err_reset();
    mem_fail_at(0, false);
    ok = scenefile_read(&f, path, &limits);
    EXPECT(mem_peak() < 1 << 20, "%s: %lu bytes of memory", what, (unsigned long)mem_peak());
    if (ok)
        scenefile_clear(&f);
    EXPECT(mem_blocks() == 0, "%s: %ld blocks are kept", what, mem_blocks());
    EXPECT(err_status() == (ok ? STATUS_OK : STATUS_INPUT), "%s: status %d", what,
           (int)err_status());
    return ok;
}

/* Changes of each byte of the one or the other: of two of its bits, or (long) every other value.
 * The readers of meshes have a suite of their own; this is about what is made of them. */
static void mutate_pair(bool every)
{
    static const char *const texts[2] = { obj_text, mtl_text };
    static const char *const names[2] = { "a.obj", "a.mtl" };
    char path[2][300], block[SEED_MAX];

    messages_nowhere();
    scene_write("n.ppm", "P3 1 1 255 128 128 255\n");
    for (int k = 0; k < 2; k++)
        snprintf(path[k], sizeof path[k], "%s", scene_write(names[k], texts[k]));
    EXPECT(try_pair(path[0], "the seed"), "the seed was refused");
    for (int k = 0; k < 2; k++) {
        size_t n = strlen(texts[k]);
        memcpy(block, texts[k], n);
        for (size_t i = 0; i < n; i++) {
            for (int v = 1; v < 256; v = every ? v + 1 : v << 4) {
                block[i] = (char)((unsigned char)texts[k][i] ^ v);
                overwrite(path[k], block, n);
                try_pair(path[0], names[k]);
            }
            block[i] = texts[k][i];
        }
        for (size_t i = 0; i < n; i++) {
            overwrite(path[k], texts[k], i);
            try_pair(path[0], "a beginning");
        }
        scene_write(names[k], texts[k]);
    }
}

static void mutate_obj_bits(void) { mutate_pair(false); }
static void mutate_obj_all(void) { mutate_pair(true); }

/* ---- memory and files that fail ---- */

/* A scene that touches every part of the reader, files included. */
static const char *write_everything(void)
{
    static const unsigned char tga[18 + 3] = {
        0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 24, 0x20, 1, 2, 3
    };
    char path[400];

    snprintf(path, sizeof path, "%.200s/x.tga", test_folder());
    REQUIRE(file_write(path, tga, sizeof tga), "cannot write");
    for (int k = 0; k < 3; k++) {
        char name[20];
        snprintf(name, sizeof name, "s%d.pbrt", k);
        scene_write(name, strstr(seeds[k + 1], "WorldBegin") + 10);
    }
    scene_write("a.obj", obj_text);
    scene_write("a.mtl", mtl_text);
    scene_write("a.spd", "400 1\n700 2\n");
    scene_write("a.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                "property float y\nproperty float z\nelement face 1\n"
                "property list uchar int vertex_indices\nend_header\n"
                "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    return scene_write("all.pbrt",
        "LookAt 0 -5 1 0 0 0 0 0 1 Camera \"perspective\"\n"
        "Film \"rgb\" \"string filename\" [\"a\" \"b\"]\nWorldBegin\n"
        "Texture \"i\" \"spectrum\" \"imagemap\" \"string filename\" \"x.tga\"\n"
        "Texture \"m\" \"spectrum\" \"mix\" \"texture tex1\" \"i\"\n"
        "Material \"matte\" \"texture Kd\" \"i\" Shape \"plymesh\" \"string filename\" \"a.ply\"\n"
        "Shape \"obj\" \"string filename\" \"a.obj\" Material \"metal\" \"spectrum k\" \"a.spd\"\n"
        "Shape \"loopsubdiv\" \"integer levels\" 2 \"point3 P\" [0 0 0 1 0 0 0 1 0]\n"
        "LightSource \"infinite\" \"string filename\" \"x.tga\"\n"
        "Include \"s0.pbrt\" Include \"s1.pbrt\" Import \"s2.pbrt\"\n");
}

/* Reads with one failing operation, or with all from that one on; true if none failed. */
static bool try_failing(const char *path, Status want, const char *what, unsigned long k)
{
    ReadLimits limits = READ_LIMITS_DEFAULT;
    SceneFile f;
    bool ok = scenefile_read(&f, path, &limits);

    mem_fail_at(0, false);
    file_fail_at(0, false, 0);
    if (ok)
        scenefile_clear(&f);
    EXPECT(mem_blocks() == 0, "%s %lu: %ld blocks are kept", what, k, mem_blocks());
    EXPECT(err_status() == (ok ? STATUS_OK : want), "%s %lu: status %d", what, k,
           (int)err_status());
    return ok;
}

static void memory_fails(void)
{
    const char *path = write_everything();
    unsigned long k = 1;
    char line[2000];
    bool done = false;

    messages_start();
    for (; !done; k++)
        for (int on = 0; on < 2 && !done; on++) {
            err_reset();
            mem_fail_at(k, on != 0);
            done = try_failing(path, STATUS_OUTPUT, "allocation", k);
            EXPECT(messages_take(line, sizeof line) == (int)warnings_count() + !done,
                   "allocation %lu: not one line", k);
        }
    EXPECT(k > 100, "only %lu allocations were made to fail", k);
}

static void files_fail(void)
{
    const char *path = write_everything();
    unsigned long k = 1;
    bool done = false;

    messages_nowhere();
    for (; !done; k++) {
        err_reset();
        file_fail_at(k, false, EIO);
        done = try_failing(path, STATUS_INPUT, "operation", k);
    }
    EXPECT(k > 20, "only %lu operations were made to fail", k);
}

/* ---- much for little ---- */

/* The costliest words that there are, a quarter of a megabyte of each. Scenes of spheres, lights
 * and materials hold structures that are larger than the words that ask for them: 24 bytes of scene
 * a byte of text are allowed there, and 16 for numbers. */
static void much(void)
{
    static const struct { const char *head, *word, *tail; size_t factor; } rows[] = {
        { "WorldBegin Shape\"trianglemesh\"\"point P\"[", "0 0 1 ", "]\"integer indices\"[0 1 2]",
          16 },
        { "WorldBegin Shape\"trianglemesh\"\"point P\"[0 0 0 1 0 0 0 1 0]\"integer indices\"[",
          "0 1 2 ", "]", 16 },
        { "Film\"a\"\"string b\"[", "\"\"", "]", 16 },
        { "Film\"a\"\"float b\"[", "1 ", "]", 16 },
        { "WorldBegin ", "Shape\"disk\"", "", 24 },
        { "WorldBegin ", "Shape\"sphere\"", "", 24 },
        { "WorldBegin ObjectBegin\"a\"Shape\"disk\"ObjectEnd ", "ObjectInstance\"a\"", "", 24 },
        { "WorldBegin ", "LightSource\"point\"", "", 24 },
        { "WorldBegin ", "Material\"mirror\"", "", 72 },
        { "WorldBegin ", "Texture\"a\"\"float\"\"constant\"", "", 24 },
        { "WorldBegin ", "AreaLightSource\"diffuse\"", "", 16 },
        { "", "CoordinateSystem\"a\"", "", 16 },
        { "", "Film\"a\"", "", 24 },
        { "", "Scale 1 1 1 ", "", 16 },
        { "", "# ", "", 16 },
        { "", "AttributeBegin AttributeEnd ", "", 16 },
    };
    enum { SIZE = 1 << 18 };
    ReadLimits limits = READ_LIMITS_DEFAULT;
    char *text = malloc(SIZE + 200);

    REQUIRE(text, "memory");
    messages_nowhere();
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        size_t n = (size_t)sprintf(text, "%s", rows[i].head), word = strlen(rows[i].word);
        SceneFile f;
        while (n + word <= SIZE) {
            memcpy(text + n, rows[i].word, word);
            n += word;
        }
        n += (size_t)sprintf(text + n, "%s", rows[i].tail);
        err_reset();
        mem_fail_at(0, false);
        EXPECT(scenefile_parse(&f, "test.pbrt", text, n, &limits), "refused: %s", rows[i].word);
        EXPECT(mem_peak() <= rows[i].factor * n + (1 << 20), "%s: %.1f bytes a byte", rows[i].word,
               ((double)mem_peak() - (1 << 20)) / (double)n);
        scenefile_clear(&f);
        EXPECT(mem_blocks() == 0, "%s: blocks are kept", rows[i].word);
    }
    free(text);
}

/* Shapes that become triangles are counted over the whole scene: 257 times 2^14 is too much. */
static void many_triangles(void)
{
    enum { N = 300 };
    char text[30 + 20 * N], line[2000];
    size_t n = (size_t)sprintf(text, "WorldBegin Scale 1 2 1 ");
    SceneFile f;

    for (int i = 0; i < N; i++)
        n += (size_t)sprintf(text + n, "\nShape \"sphere\"");
    messages_start();
    err_reset();
    EXPECT(!scene_parse(&f, text), "was read");
    messages_take(line, sizeof line);
    EXPECT(warnings_count() == 256 && mem_blocks() == 0, "%u spheres", warnings_count());
}

/* Time must not grow with the square of a text: 10^5 names, and 10^5 that are not known. */
static void many_names(void)
{
    enum { N = 30000 };
    char *text = malloc(200 * (size_t)N);
    size_t n;
    SceneFile f;

    REQUIRE(text, "memory");
    n = (size_t)sprintf(text, "WorldBegin ");
    for (int i = 0; i < N; i++)
        n += (size_t)sprintf(
            text + n, "Texture \"t%d\" \"float\" \"constant\" CoordinateSystem \"c%d\"\n", i, i);
    for (int i = 0; i < N; i++)
        n += (size_t)sprintf(text + n, "CoordSysTransform \"c%d\" NamedMaterial \"m%d\"\n", i, i);
    messages_nowhere();
    f = scene_of(text, N);
    scenefile_clear(&f);
    free(text);
}

const TestCase test_scenefile_hostile[] = {
    { "mutate_options", mutate_options, false },
    { "mutate_attributes", mutate_attributes, false },
    { "mutate_names", mutate_names, false },
    { "mutate_materials", mutate_materials, false },
    { "mutate_shapes", mutate_shapes, false },
    { "cut", cut, false },
    { "mutate_obj_bits", mutate_obj_bits, false },
    { "mutate_obj_all", mutate_obj_all, true },
    { "memory_fails", memory_fails, false },
    { "files_fail", files_fail, false },
    { "much", much, false },
    { "many_triangles", many_triangles, false },
    { "many_names", many_names, false },
    { NULL, NULL, false }
};

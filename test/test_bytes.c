/* test_bytes.c -- the same scene, seed and sample count give the same bytes: for any number of
 * threads, and on every compiler, flag set and machine that the suite is run on.
 *
 * The pictures walk the program's own lists, so that every integrator, structure, sampler, filter,
 * light, material, shape, camera, format and tone map has one; more cover what no list has. The
 * hashes of their files (FNV-1a of 64 bits) stand in bytes_hashes.h. After a change that is meant
 * to change pictures, and for a new member of a list,
 *
 *     RUSHLIGHT_HASHES=test/bytes_hashes.h make check T=bytes/pictures
 *
 * writes that file anew, and `make check-long T=builds` tells whether all builds agree with it. */
#include "cli/args.h"
#include "image/denoise.h"
#include "image/filter.h"
#include "image/tonemap.h"
#include "integrators/integrator.h"
#include "lightsampling/lightsampler.h"
#include "scenefile/shapes.h"
#include "test/cli_help.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const struct { const char *name; uint64_t hash; } hashes[] = {
#include "test/bytes_hashes.h"
    { NULL, 0 }
};

static uint64_t fnv1a(const char *bytes, size_t n)
{
    uint64_t h = 0xCBF29CE484222325u;
    for (size_t i = 0; i < n; i++)
        h = (h ^ (unsigned char)bytes[i]) * 0x100000001B3u;
    return h;
}

/* ---- the stage: a floor, something on it, lights ---- */

static const char HEAD[] =
    "LookAt 0.4 -5 2.2  0 0 0.6  0 0 1\nCamera \"perspective\" \"float fov\" 38\n"
    "Film \"rgb\" \"integer xresolution\" 20 \"integer yresolution\" 16\n"
    "Sampler \"zerotwo\" \"integer pixelsamples\" 4\nWorldBegin\n";
static const char SKY[] = "LightSource \"infinite\" \"string filename\" \"sky.pfm\"\n";
static const char LAMP[] =
    "AttributeBegin\nAreaLightSource \"diffuse\" \"rgb L\" [ 8 6 4 ]\nTranslate 1.2 -0.8 2.4\n"
    "Shape \"sphere\" \"float radius\" 0.4\nAttributeEnd\n";
static const char FLOOR[] =
    "Texture \"wood\" \"spectrum\" \"imagemap\" \"string filename\" \"wood.ppm\"\n"
    "  \"float uscale\" 2\n"
    "AttributeBegin\nMaterial \"diffuse\" \"texture reflectance\" \"wood\"\n"
    "Shape \"trianglemesh\" \"integer indices\" [ 0 1 2 0 2 3 ]\n"
    "  \"point3 P\" [ -2 -2 0  2 -2 0  2 2 0  -2 2 0 ] \"point2 uv\" [ 0 0 1 0 1 1 0 1 ]\n"
    "AttributeEnd\n";
static const char BLOB[] =
    "Shape \"loopsubdiv\" \"point3 P\" [ -1 -1 0  1 -1 0  0 1 0  0 0 1.6 ]\n"
    "  \"integer indices\" [ 0 2 1  0 1 3  1 2 3  2 0 3 ]\n";
static const char BALL[] = "Translate 0 0 0.7\nShape \"sphere\" \"float radius\" 0.7\n";

/* What kinds need besides their name. */
static const struct { const char *kind, *params; } NEEDS[] = {
    { "goniometric", "\"string filename\" \"sky.pfm\"" },
    { "projection", "\"string filename\" \"wood.ppm\"" },
    { "trianglemesh", "\"point3 P\" [ -1 0 0  1 0 0.2  0 0.3 1.3 ] \"integer indices\" [ 0 1 2 ]" },
    { "plymesh", "\"string filename\" \"roof.ply\"" },
    { "obj", "\"string filename\" \"room.obj\"" },
    { "loopsubdiv", "\"point3 P\" [ -1 -1 0  1 -1 0  0 1 0  0 0 1.6 ] \"integer levels\" 2 "
                    "\"integer indices\" [ 0 2 1  0 1 3  1 2 3  2 0 3 ]" },
    { "heightfield", "\"integer nu\" 3 \"integer nv\" 3 "
                     "\"float Pz\" [ 0 .3 .1 .7 .2 .5 0 .4 .9 ]" },
    { "geometryimage", "\"float radius\" 0.8 \"integer side\" 12" },
    { "bilinearmesh", "\"point3 P\" [ -1 -0.3 0  1 -0.3 0.3  -1 0.4 1.5  1 0.4 1.1 ]" },
    { "hyperboloid", "\"point3 p1\" [ 0.7 0 0 ] \"point3 p2\" [ 0 0.7 1.2 ]" },
    { "cone", "\"float radius\" 0.8" }, { "paraboloid", "\"float radius\" 0.9" },
    { "cylinder", "\"float radius\" 0.6 \"float phimax\" 270" },
    { "sphere", "\"float radius\" 0.8 \"float zmax\" 0.5 \"float phimax\" 300" },
    { "disk", "\"float height\" 0.4 \"float innerradius\" 0.2" },
    { "curve", "\"point3 P\" [ -1 0 0  -1 0 2  0 -1 0  1 0 1 ] "
               "\"float width0\" 0.5 \"float width1\" 0" },
    { "torus", "\"float radius\" 0.7 \"float minorradius\" 0.3" },
    { "box", "\"point3 from\" [ -0.6 -0.5 -0.4 ] \"point3 to\" [ 0.6 0.5 0.7 ]" },
    { "lathe", "\"point2 P\" [ 0 0  0.5 0  0.5 0  0.2 0.7  0.6 1.1 ]" },
    { "generated", "\"string kind\" \"hare\" \"integer triangles\" 2000" },
    { "mix", "\"string materials\" [\"p\" \"q\"]" },
    { "conductor", "\"float roughness\" 0.1" }, { "coateddiffuse", "\"float roughness\" 0.05" },
};

static const char *needs(const char *kind)
{
    for (size_t i = 0; i < sizeof NEEDS / sizeof *NEEDS; i++)
        if (!strcmp(NEEDS[i].kind, kind))
            return NEEDS[i].params;
    return "";
}

/* ---- rendering one and looking its hash up ---- */

static FILE *table;             /* being written anew, or NULL */

static void write_scene(const char *a, const char *b, const char *c, const char *d, const char *e)
{
    static char text[8000];
    snprintf(text, sizeof text, "%s%s%s%s%s", a, b, c, d, e);
    cli_write_text("s.pbrt", text);
}

static int run_line(const char *line)
{
    static char copy[1000];
    char *words[60] = { (char *)"rushlight" };
    int n = 1;
    snprintf(copy, sizeof copy, "%s", line);
    for (char *p = strtok(copy, " "); p && n < 59; p = strtok(NULL, " "))
        words[n++] = p;
    return cli_run(n, words);
}

static uint64_t hash_of(const char *file)
{
    size_t n;
    char *bytes = cli_read(file, &n);
    uint64_t h;
    REQUIRE(bytes, "no %s", file);
    h = fnv1a(bytes, n);
    remove(cli_path(file));
    return h;
}

static void check_hash(const char *set, const char *name, uint64_t h)
{
    char full[80];
    size_t i = 0;

    snprintf(full, sizeof full, "%s/%s", set, name);
    if (table) {
        fprintf(table, "    { \"%s\", 0x%08lX%08lX },\n", full, (unsigned long)(h >> 32),
                (unsigned long)(h & 0xFFFFFFFFu));
        return;
    }
    while (hashes[i].name && strcmp(hashes[i].name, full))
        i++;
    EXPECT(hashes[i].name, "%s has no hash: see the head of this file", full);
    EXPECT(!hashes[i].name || hashes[i].hash == h, "%s has other bytes (%08lX%08lX)", full,
           (unsigned long)(h >> 32), (unsigned long)(h & 0xFFFFFFFFu));
}

/* Renders s.pbrt with these options to a PFM file. */
static uint64_t picture(const char *set, const char *name, const char *options)
{
    char line[1000];
    uint64_t h;

    snprintf(line, sizeof line, "s.pbrt --quiet --threads 2 -o x.pfm %s", options);
    REQUIRE(run_line(line) == 0, "%s/%s: '%s' failed", set, name, line);
    h = hash_of("x.pfm");
    check_hash(set, name, h);
    return h;
}

/* ---- the lists ---- */

static void set_up(void)
{
    cli_scene();
    cli_write_text("room.obj", "mtllib room.mtl\nv -1 0 0\nv 1 0 0\nv 0.9 0.6 1\nv -1 0.6 1.2\n"
                   "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl red\nf 1/1 2/2 3/3 4/4\nusemtl lamp\n"
                   "v 0 -1 2\nv 0.5 -1 2\nv 0 -1.5 2.1\nf 5 6 7\n");
    cli_write_text("room.mtl", "newmtl red\nKd 0.8 0.7 0.6\nmap_Kd wood.ppm\nnewmtl lamp\n"
                   "Ke 5 5 9\n");
    REQUIRE(chdir(test_folder()) == 0, "chdir");
}

/* Each member by an option of the command line: "--sampler %s". */
static void each_option(const void *list, const char *set, const char *format)
{
    const KindInfo *info;
    write_scene(HEAD, SKY, LAMP, FLOOR, BALL);
    for (size_t k = 0; (info = kind_info(list, k)) != NULL; k++) {
        char options[100];
        snprintf(options, sizeof options, format, info->name);
        picture(set, info->name, options);
    }
}

/* A lamp of n strips, each above the last and none in its place in the list: what an accelerator
 * does to the order of triangles must not change which point of the lamp a number is for. */
static const char *mesh_lamp(void)
{
    enum { N = 40 };
    static char text[N * 160 + 200];
    size_t at = (size_t)snprintf(text, sizeof text, "AttributeBegin\n"
        "AreaLightSource \"diffuse\" \"rgb L\" [ 6 5 4 ]\n"
        "Shape \"trianglemesh\" \"integer indices\" [");

    for (int i = 0; i < N; i++) {
        int k = i * 17 % N;
        at += (size_t)snprintf(text + at, sizeof text - at, " %d %d %d", 3 * k, 3 * k + 1,
                               3 * k + 2);
    }
    at += (size_t)snprintf(text + at, sizeof text - at, " ]\n\"point3 P\" [");
    for (int i = 0; i < N; i++)
        at += (size_t)snprintf(text + at, sizeof text - at, " %g %g 3 %g %g 3 %g %g 3.1\n",
                               -1 + i * 0.05, 1.0, -0.97 + i * 0.05, 1.2, -1 + i * 0.05, 1.2);
    snprintf(text + at, sizeof text - at, " ]\nAttributeEnd\n");
    return text;
}

/* The structures must all find what the plain one finds, so their pictures are one picture. */
static void each_accelerator_of(const char *name, const char *lamp)
{
    uint64_t first = 0;
    write_scene(HEAD, SKY, lamp, FLOOR, BLOB);
    for (size_t k = 0; accels[k]; k++) {
        char options[100];
        uint64_t h;
        snprintf(options, sizeof options, "--accel %s", accels[k]->info.name);
        h = picture(name, accels[k]->info.name, options);
        first = k ? first : h;
        EXPECT(h == first, "%s gives another picture than %s", accels[k]->info.name,
               accels[0]->info.name);
    }
}

static void each_accelerator(void)
{
    each_accelerator_of("accelerator", LAMP);
    each_accelerator_of("mesh_lamp", mesh_lamp());
}

static void each_material(void)
{
    char text[500];
    for (size_t k = 0; bsdfs[k]; k++) {
        snprintf(text, sizeof text, "MakeNamedMaterial \"p\" \"string type\" \"mirror\"\n"
                 "MakeNamedMaterial \"q\" \"string type\" \"diffuse\"\n"
                 "Material \"%s\" %s\n", bsdfs[k]->info.name,
                 needs(bsdfs[k]->info.name));
        write_scene(HEAD, SKY, FLOOR, text, BALL);
        picture("material", bsdfs[k]->info.name, "--spp 8");
    }
}

static void each_light(void)
{
    char text[400];
    for (size_t k = 0; lights[k]; k++) {
        bool area = !lights[k]->delta && !lights[k]->infinite;
        snprintf(text, sizeof text, "AttributeBegin\nTranslate 0.5 -1.5 3\nRotate 170 1 0 0\n"
                 "%s \"%s\" \"rgb scale\" [ 9 8 7 ] %s\n%sAttributeEnd\n",
                 area ? "AreaLightSource" : "LightSource", lights[k]->info.name,
                 needs(lights[k]->info.name), area ? "Shape \"disk\" \"float radius\" 0.3\n" : "");
        write_scene(HEAD, text, FLOOR, BALL, "");
        picture("light", lights[k]->info.name, "");
    }
}

static void each_shape(void)
{
    char text[500];
    for (size_t k = 0; shape_readers[k]; k++) {
        const char *name = shape_readers[k]->info.name;
        if (!shape_readers[k]->read)
            continue;
        snprintf(text, sizeof text, "Rotate 20 0 0 1\nTranslate 0 0 0.5\nShape \"%s\" %s\n", name,
                 needs(name));
        write_scene(HEAD, SKY, LAMP, FLOOR, text);
        picture("shape", name, "");
    }
}

static void each_camera(void)
{
    char text[400];
    for (size_t k = 0; cameras[k]; k++) {
        const char *name = cameras[k]->info.name;
        snprintf(text, sizeof text, "LookAt 0.4 -5 2.2  0 0 0.6  0 0 1\nCamera \"%s\" %s\n"
                 "Film \"rgb\" \"integer xresolution\" 20 \"integer yresolution\" 16\nSampler "
                 "\"random\" \"integer pixelsamples\" 4\nWorldBegin\n", name, needs(name));
        write_scene(text, SKY, LAMP, FLOOR, BALL);
        picture("camera", name, "");
    }
}

static void each_format(void)
{
    write_scene(HEAD, SKY, LAMP, FLOOR, BALL);
    for (size_t k = 0; image_formats[k]; k++) {
        const char *name = image_formats[k]->info.name;
        char line[200], file[40];
        if (!image_formats[k]->write)
            continue;
        snprintf(file, sizeof file, "x.%s", name);
        snprintf(line, sizeof line, "s.pbrt --quiet --exposure 0.3 -o %s", file);
        REQUIRE(run_line(line) == 0, "'%s' failed", line);
        check_hash("format", name, hash_of(file));
    }
    for (size_t k = 0; tonemaps[k]; k++) {
        char line[200];
        snprintf(line, sizeof line, "s.pbrt --quiet --tonemap %s -o x.ppm", tonemaps[k]->info.name);
        REQUIRE(run_line(line) == 0, "'%s' failed", line);
        check_hash("tonemap", tonemaps[k]->info.name, hash_of("x.ppm"));
    }
    for (size_t k = 0; denoisers[k]; k++) {
        char line[200];
        snprintf(line, sizeof line, "s.pbrt --quiet --denoise %s --dither -o x.ppm",
                 denoisers[k]->info.name);
        REQUIRE(run_line(line) == 0, "'%s' failed", line);
        check_hash("denoise", denoisers[k]->info.name, hash_of("x.ppm"));
    }
}

/* ---- what is in no list ---- */

static void lens(void)
{
    write_scene("LookAt 0.4 -5 2.2  0 0 0.6  0 0 1\nCamera \"perspective\" \"float fov\" 38 "
                "\"float lensradius\" 0.2 \"float focaldistance\" 5\nFilm \"rgb\" \"integer "
                "xresolution\" 20 \"integer yresolution\" 16\nWorldBegin\n",
                SKY, LAMP, FLOOR, BALL);
    picture("more", "lens", "--spp 4");
}

static void instances(void)
{
    write_scene(HEAD, SKY, LAMP, FLOOR,
                "ObjectBegin \"roof\"\nShape \"plymesh\" \"string filename\" \"roof.ply\"\n"
                "Shape \"sphere\" \"float radius\" 0.3\nObjectEnd\n"
                "AttributeBegin\nScale 0.4 0.5 0.7\nTranslate 2 0 0\nRotate 25 0 0 1\n"
                "ObjectInstance \"roof\"\nAttributeEnd\nTranslate -0.8 0.3 0\nScale -0.5 0.5 0.5\n"
                "ObjectInstance \"roof\"\n");
    picture("more", "instances", "");
}

/* Lamps with a picture, focused ones, and skies of each mapping. */
static void pictured_lights(void)
{
    static const char *const mappings[] = { "octahedral", "angular", "mirrorball" };
    char sky[200], name[40];

    write_scene(HEAD, "AttributeBegin\nAreaLightSource \"diffuse\" \"float exponent\" 3.5 "
                "\"float power\" 60 \"string filename\" \"wood.ppm\" \"bool twosided\" true\n"
                "Translate 1.2 -0.8 2.4\nShape \"sphere\" \"float radius\" 0.4 \"float zmax\" 0.2\n"
                "Translate -2 0 0\nShape \"sphere\" \"float radius\" 0.3\nAttributeEnd\n",
                FLOOR, BALL, "");
    picture("more", "pictured_lamps", "");
    for (int k = 0; k < 3; k++) {
        snprintf(sky, sizeof sky, "LightSource \"infinite\" \"string filename\" \"sky.pfm\" "
                 "\"string mapping\" \"%s\"\n", mappings[k]);
        snprintf(name, sizeof name, "sky_%s", mappings[k]);
        write_scene(HEAD, sky, FLOOR, BALL, "");
        picture("more", name, "");
    }
}

static void textures_and_spectra(void)
{
    write_scene(HEAD, SKY, "LightSource \"point\" \"point3 from\" [ -1 -2 3 ] \"blackbody I\" 3000 "
                "\"float power\" 200\n", FLOOR,
                "Texture \"squares\" \"spectrum\" \"checkerboard\" \"float uscale\" 6 \"float "
                "vscale\" 4 \"texture tex1\" \"wood\" \"rgb tex2\" [ 0.1 0.3 0.8 ]\n"
                "Texture \"both\" \"spectrum\" \"scale\" \"texture tex\" \"squares\" \"float "
                "scale\" 0.9\nMaterial \"coateddiffuse\" \"texture reflectance\" \"both\"\n"
                "Translate -0.8 0 0.7\nShape \"sphere\" \"float radius\" 0.7\n"
                "Material \"conductor\" \"spectrum eta\" \"metal-Au-eta\" \"spectrum k\" "
                "\"metal-Au-k\" \"float roughness\" 0.2\nTranslate 1.5 0 0\n"
                "Shape \"sphere\" \"float radius\" 0.6\n");
    picture("more", "textures_and_spectra", "");
}

/* Light that has gone a long way: glass, a mirror, long paths, roulette. */
static void deep(void)
{
    write_scene(HEAD, SKY, LAMP, FLOOR,
                "Material \"dielectric\"\nTranslate -0.7 0 0.7\n"
                "Shape \"sphere\" \"float radius\" 0.7\nMaterial \"mirror\"\n"
                "Translate 1.5 0.3 0\nShape \"sphere\" \"float radius\" 0.7\n");
    picture("more", "deep", "--spp 8 --integrator path:maxdepth=40,roulette=2");
}

static void window(void)
{
    write_scene(HEAD, SKY, LAMP, FLOOR, BALL);
    picture("more", "window", "--size 65537x65539 --crop 30000,40000,30016,40012 --seed "
            "9223372036854775807 --filter triangle:xradius=100,yradius=60");
}

static void extras(void)
{
    static const char *const EXTRAS[] = {
        "normal", "depth", "albedo", "length:2", "length:3", "strategy:implicit",
        "strategy:explicit", "geometric", "position", "primitive", "material", "emission", "direct",
        "indirect", "edges", "variance", "variance:indirect", "samples"
    };
    char line[300];

    write_scene(HEAD, SKY, LAMP, FLOOR, BALL);
    for (size_t i = 0; i < sizeof EXTRAS / sizeof *EXTRAS; i++) {
        snprintf(line, sizeof line, "s.pbrt --quiet -o x.ppm --aov %s=y.pfm", EXTRAS[i]);
        REQUIRE(run_line(line) == 0, "'%s' failed", line);
        check_hash("aov", EXTRAS[i], hash_of("y.pfm"));
    }
}

static void bare_mesh(void)
{
    REQUIRE(run_line("roof.ply --quiet --size 20x20 --spp 2 -o x.pfm") == 0, "roof.ply failed");
    check_hash("more", "bare_mesh", hash_of("x.pfm"));
}

static void pictures(void)
{
    const char *file = getenv("RUSHLIGHT_HASHES");

    if (file) {
        table = fopen(file, "w");
        REQUIRE(table, "cannot write %s", file);
        fprintf(table, "/* bytes_hashes.h -- written by test_bytes.c, which says how. */\n");
    }
    set_up();
    each_option(integrators, "integrator", "--integrator %s");
    each_option(samplers, "sampler", "--sampler %s");
    each_option(filters, "filter", "--filter %s");
    each_option(lightsamplers, "lightsampler", "--integrator path:lightsampler=%s");
    each_accelerator();
    each_material();
    each_light();
    each_shape();
    each_camera();
    each_format();
    lens();
    pictured_lights();
    instances();
    textures_and_spectra();
    deep();
    window();
    extras();
    bare_mesh();
    if (table)
        fclose(table);
}

/* ---- threads ---- */

static void expect_same_for_threads(const char *options)
{
    static const int THREADS[] = { 1, 2, 3, 7, 16 };
    uint64_t first[2] = { 0, 0 };

    for (size_t i = 0; i < sizeof THREADS / sizeof *THREADS; i++) {
        char line[300];
        uint64_t h[2];
        snprintf(line, sizeof line, "s.pbrt --quiet --size 70x50 --threads %d -o x.pfm -o x.png %s",
                 THREADS[i], options);
        REQUIRE(run_line(line) == 0, "'%s' failed", line);
        h[0] = hash_of("x.pfm");
        h[1] = hash_of("x.png");
        if (!i)
            memcpy(first, h, sizeof h);
        EXPECT(h[0] == first[0] && h[1] == first[1], "'%s': other bytes than with 1 thread", line);
    }
}

static void threads(void)
{
    char options[100];

    set_up();
    write_scene(HEAD, SKY, LAMP, FLOOR, BLOB);
    for (size_t k = 0; integrators[k]; k++) {
        snprintf(options, sizeof options, "--spp 2 --integrator %s", integrators[k]->info.name);
        expect_same_for_threads(options);
    }
    for (size_t k = 0; accels[k]; k++) {
        snprintf(options, sizeof options, "--spp 1 --accel %s", accels[k]->info.name);
        expect_same_for_threads(options);
    }
    expect_same_for_threads("--spp 2 --aov length:2=y.pfm --filter triangle --sampler random");
    expect_same_for_threads("--spp 1000 --error 0.3");
}

const TestCase test_bytes[] = {
    { "pictures", pictures, false },
    { "threads", threads, false },
    { NULL, NULL, false }
};

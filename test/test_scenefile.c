/* test_scenefile.c -- what the words of the scene language come to: transforms, attributes, both
 * spellings of parameters, files that include files, objects, and real scenes. */
#include "test/mesh_help.h"
#include "test/scene_help.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#define TRI "Shape \"trianglemesh\" \"point3 P\" [1 0 0 0 1 0 0 0 1]\n"

/* ---- transforms: where the unit points go ---- */

static void expect_frame(const SceneFile *f, size_t first, V3 x, V3 y, V3 z, float tolerance,
                         const char *what)
{
    V3 want[3];
    want[0] = x;
    want[1] = y;
    want[2] = z;
    for (size_t k = 0; k < 3; k++) {
        V3 p = scene_corner(f, first + k);
        EXPECT(v_near(p, want[k], tolerance), "%s: point %lu is %g %g %g, not %g %g %g", what,
               (unsigned long)k, p.x, p.y, p.z, want[k].x, want[k].y, want[k].z);
    }
}

/* Worked out by hand: the last directive acts first, matrices stand column by column. */
static void transforms(void)
{
    static const struct { const char *text; V3 x, y, z; } rows[] = {
        { "", { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } },
        { "Translate 1 2 3", { 2, 2, 3 }, { 1, 3, 3 }, { 1, 2, 4 } },
        { "Translate 1 2 3 Scale 2 3 4 Rotate 90 0 0 1", { 1, 5, 3 }, { -1, 2, 3 }, { 1, 2, 7 } },
        { "Rotate 90 0 0 1 Scale 2 3 4 Translate 1 2 3",
          { -6, 4, 12 }, { -9, 2, 12 }, { -6, 2, 16 } },
        { "Rotate 90 1 0 0", { 1, 0, 0 }, { 0, 0, 1 }, { 0, -1, 0 } },
        { "Rotate -90 0 2 0", { 0, 0, 1 }, { 0, 1, 0 }, { -1, 0, 0 } },
        { "Scale 2 2 2 Identity", { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } },
        { "Scale 9 9 9 Transform [1 2 3 0  4 5 6 0  7 8 10 0  11 12 13 1]",
          { 12, 14, 16 }, { 15, 17, 19 }, { 18, 20, 23 } },
        { "Transform [2 0 0 0 0 2 0 0 0 0 2 0 4 6 8 2]", { 3, 3, 4 }, { 2, 4, 4 }, { 2, 3, 5 } },
        { "Scale 2 2 2 ConcatTransform [0 1 0 0 -1 0 0 0 0 0 1 0 1 1 1 1]",
          { 2, 4, 2 }, { 0, 2, 2 }, { 2, 2, 4 } },
        { "CoordinateSystem \"a\" Scale 5 5 5 CoordinateSystem \"b\" CoordSysTransform \"a\" "
          "Translate 1 0 0 CoordSysTransform \"b\"", { 5, 0, 0 }, { 0, 5, 0 }, { 0, 0, 5 } },
        { "Scale 2 2 2 TransformBegin Scale 3 3 3 TransformEnd",
          { 2, 0, 0 }, { 0, 2, 0 }, { 0, 0, 2 } },
        { "Scale 2 2 2 AttributeBegin Scale 3 3 3 AttributeEnd",
          { 2, 0, 0 }, { 0, 2, 0 }, { 0, 0, 2 } },
        { "Scale 2 2 2 CoordSysTransform \"world\"", { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } },
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char text[400];
        SceneFile f;
        snprintf(text, sizeof text, "WorldBegin %s " TRI, rows[i].text);
        f = scene_of(text, 0);
        expect_frame(&f, 0, rows[i].x, rows[i].y, rows[i].z, 0.0f, rows[i].text);
        scenefile_clear(&f);
    }
}

/* The eye at (1,2,3) looks along +x with z up: camera space is left-handed, x to the right, so
 * right is up x forward = z x x = y. */
static void camera(void)
{
    SceneFile f = scene_of("LookAt 1 2 3  4 2 3  0 0 1 Camera \"perspective\" \"float fov\" 90 "
                           "WorldBegin CoordSysTransform \"camera\" " TRI, 0);
    Camera *c = f.scene->camera;
    Ray r;

    expect_frame(&f, 0, v3(1, 3, 3), v3(1, 2, 4), v3(2, 2, 3), 1e-6f, "camera space");
    REQUIRE(c, "no camera");
    c->kind->film(c, 100, 100);
    r = c->kind->ray(c, (V2){ 50, 50 }, (V2){ 0.5f, 0.5f }, 0.0f);
    EXPECT(v_near(r.o, v3(1, 2, 3), 1e-6f) && v_near(r.d, v3(1, 0, 0), 1e-6f), "the middle ray");
    r = c->kind->ray(c, (V2){ 100, 0 }, (V2){ 0.5f, 0.5f }, 0.0f);  /* top right: 1 : 1 : 1 */
    EXPECT(v_near(r.d, v_scale(v3(1, 1, 1), 0.57735027f), 1e-6f), "the corner ray");
    scenefile_clear(&f);
    /* A mirror before LookAt, as old scenes have it, swaps left and right. */
    f = scene_of("Scale -1 1 1 LookAt 1 2 3 4 2 3 0 0 1 Camera \"perspective\" \"float fov\" 90 "
                 "WorldBegin CoordSysTransform \"camera\" " TRI, 0);
    expect_frame(&f, 0, v3(1, 1, 3), v3(1, 2, 4), v3(2, 2, 3), 1e-6f, "mirrored camera space");
    scenefile_clear(&f);
}

/* Where shape k of the world, an instance that moves, takes its object's point p. */
static void expect_mover(const SceneFile *f, size_t k, V3 p, V3 start, V3 end)
{
    const Geometry *world = &f->scene->geometries[0];
    const Instance *in = world->shapes[k].as.instance;
    Affine first, last, back;

    REQUIRE(k < world->nshapes && world->shapes[k].kind == SHAPE_INSTANCE, "no instance %d",
            (int)k);
    REQUIRE(in->motion != NULL, "instance %d stands still", (int)k);
    motion_at(in->motion, 0.0f, &first, &back);
    motion_at(in->motion, 1.0f, &last, &back);
    EXPECT(v_near(affine_point(&first, p), start, 1e-5f) &&
               v_near(affine_point(&last, p), end, 1e-5f),
           "instance %d moves otherwise", (int)k);
}

#define MOVING_END(text) "ActiveTransform EndTime " text " ActiveTransform All "

/* Shapes for which start and end differ move; those that move alike do so together. */
static void active_transform(void)
{
    SceneFile f = scene_of(
        "TransformTimes 2 4\n"
        "WorldBegin ActiveTransform EndTime Scale 9 9 9 ActiveTransform StartTime "
        "Translate 1 0 0 ActiveTransform All Scale 2 2 2 " TRI TRI
        "AttributeBegin Translate 1 1 1 " TRI "AttributeEnd Identity " TRI, 0);

    EXPECT(f.scene->ngeometries == 3, "%d geometries", (int)f.scene->ngeometries);
    EXPECT(f.scene->geometries[1].nshapes == 2 && f.scene->geometries[2].nshapes == 1,
           "shapes that move alike are apart");
    EXPECT(v_equal(f.scene->geometries[1].p[0], v3(1, 0, 0)), "not in its own space");
    EXPECT(f.scene->times[0] == 2 && f.scene->times[1] == 4, "times");
    expect_mover(&f, 1, v3(1, 2, 3), v3(3, 4, 6), v3(18, 36, 54));
    expect_mover(&f, 2, v3(0, 0, 0), v3(3, 2, 2), v3(18, 18, 18));
    scenefile_clear(&f);
}

/* What moves in an object goes where that is placed, which may move, too. Lights stand. */
static void movers(void)
{
    SceneFile f;

    messages_nowhere();
    f = scene_of(
        "WorldBegin ObjectBegin \"o\" " TRI "AttributeBegin " MOVING_END("Translate 0 0 5") TRI
        "AttributeEnd ObjectEnd Translate 1 0 0 ObjectInstance \"o\"\n"
        "AttributeBegin " MOVING_END("Translate 0 2 0") "ObjectInstance \"o\"\n"
        "LightSource \"point\" AreaLightSource \"diffuse\" Shape \"sphere\" AttributeEnd\n"
        "CoordinateSystem \"here\" " MOVING_END("Translate 0 0 3") " CoordinateSystem \"there\" "
        "CoordSysTransform \"here\" " TRI " CoordSysTransform \"there\" " TRI, 1);
    EXPECT(f.scene->geometries[0].nshapes == 7, "%d shapes", (int)f.scene->geometries[0].nshapes);
    EXPECT(!f.scene->geometries[0].shapes[0].as.instance->motion, "the first placing stands");
    expect_mover(&f, 1, v3(0, 0, 0), v3(1, 0, 0), v3(1, 0, 5));
    expect_mover(&f, 2, v3(0, 0, 0), v3(1, 0, 0), v3(1, 2, 0));
    expect_mover(&f, 3, v3(0, 0, 0), v3(1, 0, 0), v3(1, 2, 5));
    EXPECT(f.scene->geometries[0].shapes[4].kind == SHAPE_SPHERE, "the lamp");
    EXPECT(f.scene->geometries[0].shapes[5].kind == SHAPE_MESH, "what stands here");
    expect_mover(&f, 6, v3(0, 0, 0), v3(1, 0, 0), v3(1, 0, 3));
    scenefile_clear(&f);
    f = scene_of("WorldBegin " MOVING_END("Scale -1 1 1") TRI TRI, 1);
    EXPECT(f.scene->geometries[0].nshapes == 2 && f.scene->ngeometries == 1,
           "what would be turned inside out stands");
    scenefile_clear(&f);
    EXPECT(!scene_parse(&f, "TransformTimes 1 1"), "no time at all");
    EXPECT(!scene_parse(&f, "Camera \"perspective\" \"float shutteropen\" 1 "
                            "\"float shutterclose\" 0.5"), "closes before it opens");
}

/* A camera that moves; when its shutter is open. */
static void moving_camera(void)
{
    SceneFile f = scene_of("TransformTimes 1 3 " MOVING_END("Translate 0 0 -2")
                           "Camera \"orthographic\" \"float shutteropen\" 1.5 "
                           "\"float shutterclose\" 4 WorldBegin " TRI, 0);
    const AccelKind *kind = kind_find(accels, ACCEL_DEFAULT);
    const Camera *c = f.scene->camera;
    Opts o;
    Ray r;

    opts_default(&o, kind->info.options);
    REQUIRE(scene_build(f.scene, kind, &o, 1), "build");
    REQUIRE(c && c->kind == kind_find(cameras, "orthographic"), "the camera");
    EXPECT(f.scene->moves && scene_blurs(f.scene), "it moves");
    EXPECT(scene_time(f.scene, 0) == 0.25f && scene_time(f.scene, 0.2f) == 0.5f &&
               scene_time(f.scene, 1) == 1.0f, "times");
    c->kind->film(f.scene->camera, 10, 10);
    r = c->kind->ray(c, (V2){ 5, 5 }, (V2){ 0, 0 }, 0.5f);
    EXPECT(v_near(r.o, v3(0, 0, 1), 1e-6f) && v_near(r.d, v3(0, 0, 1), 1e-6f) && r.time == 0.5f,
           "the ray half way starts at %g %g %g", (double)r.o.x, (double)r.o.y, (double)r.o.z);
    scenefile_clear(&f);
}

/* ---- attributes ---- */

static void attributes(void)
{
    SceneFile f = scene_of(
        "WorldBegin MakeNamedMaterial \"a\" \"string type\" \"diffuse\"\n"
        "MakeNamedMaterial \"b\" \"string type\" \"mirror\"\n" TRI
        "NamedMaterial \"a\" AttributeBegin NamedMaterial \"b\" ReverseOrientation\n"
        "AreaLightSource \"diffuse\" \"rgb L\" [1 2 3] Translate 0 0 1\n" TRI
        "TransformBegin Translate 0 0 1 ReverseOrientation TransformEnd\n" TRI
        "AttributeEnd\n" TRI, 0);
    static const struct { uint32_t material; bool light, flip; float z; } want[] = {
        { 0, false, false, 0 }, { 2, true, true, 1 }, { 2, true, false, 1 }, { 1, false, false, 0 }
    };

    EXPECT(f.scene->nlights == 2, "%lu lights, not 2", (unsigned long)f.scene->nlights);
    for (size_t k = 0; k < 4; k++) {
        const Shape *s = scene_shape(&f, k);
        EXPECT(s->material == want[k].material, "material of shape %lu", (unsigned long)k);
        EXPECT((s->light != NO_LIGHT) == want[k].light, "light of shape %lu", (unsigned long)k);
        EXPECT(s->flip == want[k].flip, "flip of shape %lu", (unsigned long)k);
        EXPECT(scene_corner(&f, 3 * k).z == want[k].z, "height of shape %lu", (unsigned long)k);
    }
    scenefile_clear(&f);
}

/* Each light is that of its own shape: its power is pi L area. */
static void area_lights(void)
{
    const AccelKind *kind = kind_find(accels, "brute");
    Opts o;
    SceneFile f = scene_of(
        "WorldBegin Shape \"disk\" AreaLightSource \"diffuse\" \"rgb L\" [2 2 2] Scale 3 3 3\n"
        "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]\n"
        "AreaLightSource \"diffuse\" \"rgb L\" [1 1 1] \"float scale\" 4 Shape \"sphere\"", 0);
    static const double power[] = { 2 * 4.5 * PI, 4 * 36 * PI * PI };

    opts_default(&o, kind->info.options);
    REQUIRE(scene_build(f.scene, kind, &o, 1) && f.scene->nlights == 2, "two lights");
    for (size_t k = 0; k < 2; k++) {
        const Light *l = f.scene->lights[k];
        float w = l->kind->power(l).r;
        EXPECT(fabs(w / power[k] - 1) < 1e-5, "light %lu: %g W, not %g", (unsigned long)k, w,
               power[k]);
        EXPECT(scene_shape(&f, k + 1)->light == k, "light of shape %lu", (unsigned long)k + 1);
        EXPECT(l->at.line == 1 + 2 * (int)k && l->at.column == (k ? 1 : 25), "its place");
    }
    EXPECT(scene_shape(&f, 0)->light == NO_LIGHT, "the disc is dark");
    scenefile_clear(&f);
}

/* Defaults of version 4: the newest counts, the shape's own more than any, and they end. */
static void attribute_defaults(void)
{
    SceneFile f = scene_of(
        "WorldBegin Attribute \"shape\" \"float radius\" 2\n"
        "Attribute \"material\" \"rgb reflectance\" [.1 .2 .3] Shape \"sphere\"\n"
        "AttributeBegin Attribute \"shape\" \"float radius\" 3 Shape \"sphere\"\n"
        "Shape \"sphere\" \"float radius\" 4 Material \"diffuse\" Shape \"sphere\" AttributeEnd\n"
        "Shape \"sphere\" Shape \"disk\"\n", 0);
    static const float radius[] = { 2, 3, 4, 3, 2 };

    for (size_t k = 0; k < 5; k++)
        EXPECT(scene_shape(&f, k)->as.sphere.radius == radius[k], "radius of sphere %lu",
               (unsigned long)k);
    EXPECT(scene_shape(&f, 5)->as.disk.radius == 2, "radius of the disc");
    EXPECT(scene_shape(&f, 3)->material == 1 &&
           f.scene->materials[1].value[0].b == 0.3f, "default of the material");
    scenefile_clear(&f);
}

/* ---- parameters ---- */

static const Param *film_param(const SceneFile *f, const char *name)
{
    const Param *p = params_find(&f->film.params, name, NULL);
    REQUIRE(p, "no parameter %s", name);
    return p;
}

static void expect_numbers(const SceneFile *f, const char *name, ParamType kind, size_t n,
                           const double *v)
{
    const Param *p = film_param(f, name);
    EXPECT(p->kind == kind && p->n == n, "%s: kind %d, %lu values", name, (int)p->kind,
           (unsigned long)p->n);
    for (size_t i = 0; i < n && p->n == n; i++)
        EXPECT(p->numbers[i] == v[i], "%s: value %lu is %g, not %g", name, (unsigned long)i,
               p->numbers[i], v[i]);
}

static void parameters(void)
{
    SceneFile f = scene_of(
        "# a comment\nFilm \"x\" \"float a\" 1.5 \"float b\" [ 1 -2 3e1 ] # more\n"
        "\"integer c\" [7] \"bool d\" true \"bool e\" [\"false\" true] \"point3 g\" [1 2 3 4 5 6]"
        "\"point h\"[1 2 3]\"vector i\"[.5 +1 -.25]\"normal j\" [0 0 1] \"point2 k\" [1 2]\n"
        "\"rgb l\" [1 .5 .25] \"color m\" [1 2 3] \"string n\" \"a\\\"\\\\b\\t\" "
        "\"string o\" [\"p\" \"q\"]\n"
        "\"texture r\" \"s\" \"  float \t tt  \" 9 \"untyped\" [3 4] \"flag\" true \"word\" \"w\"",
        0);
    static const double a[] = { 1.5 }, b[] = { 1, -2, 30 }, c[] = { 7 }, yes[] = { 1 };
    static const double e[] = { 0, 1 }, g[] = { 1, 2, 3, 4, 5, 6 }, i[] = { 0.5, 1, -0.25 };
    static const double j[] = { 0, 0, 1 }, l[] = { 1, 0.5, 0.25 }, tt[] = { 9 }, un[] = { 3, 4 };

    expect_numbers(&f, "a", PARAM_FLOAT, 1, a);
    expect_numbers(&f, "b", PARAM_FLOAT, 3, b);
    expect_numbers(&f, "c", PARAM_INT, 1, c);
    expect_numbers(&f, "d", PARAM_BOOL, 1, yes);
    expect_numbers(&f, "e", PARAM_BOOL, 2, e);
    expect_numbers(&f, "g", PARAM_FLOAT, 6, g);
    expect_numbers(&f, "h", PARAM_FLOAT, 3, g);
    expect_numbers(&f, "i", PARAM_FLOAT, 3, i);
    expect_numbers(&f, "j", PARAM_FLOAT, 3, j);
    expect_numbers(&f, "k", PARAM_FLOAT, 2, g);
    expect_numbers(&f, "l", PARAM_FLOAT, 3, l);
    expect_numbers(&f, "m", PARAM_FLOAT, 3, g);
    expect_numbers(&f, "tt", PARAM_FLOAT, 1, tt);
    expect_numbers(&f, "untyped", PARAM_FLOAT, 2, un);
    expect_numbers(&f, "flag", PARAM_BOOL, 1, yes);
    EXPECT(!strcmp(film_param(&f, "n")->strings[0], "a\"\\b\t"), "escapes");
    EXPECT(!strcmp(film_param(&f, "o")->strings[1], "q"), "second string");
    EXPECT(film_param(&f, "r")->kind == PARAM_TEXTURE, "a texture");
    EXPECT(!strcmp(film_param(&f, "word")->strings[0], "w"), "a string without a type");
    EXPECT(!strcmp(film_param(&f, "h")->type, "point"), "the type as written");
    EXPECT(film_param(&f, "c")->at.line == 3 && film_param(&f, "c")->at.column == 1, "a place");
    EXPECT(film_param(&f, "a")->at.line == 2 && film_param(&f, "a")->at.column == 10, "a place");
    EXPECT(film_param(&f, "l")->at.line == 4 && film_param(&f, "l")->at.column == 1, "a place");
    scenefile_clear(&f);
}

/* What the render needs is kept as written, the last of each. */
static void settings(void)
{
    SceneFile f = scene_of("Integrator \"path\" Integrator \"bdpt\" \"integer maxdepth\" 5\n"
                           "Sampler \"halton\" PixelFilter \"box\" Accelerator \"lbvh\"\n"
                           "WorldBegin\n", 0);
    const Param *p = params_find(&f.integrator.params, "maxdepth", NULL);
    EXPECT(!strcmp(f.integrator.name, "bdpt") && p && p->numbers[0] == 5, "integrator");
    EXPECT(f.integrator.at.line == 1 && f.integrator.at.column == 19, "its place");
    EXPECT(!strcmp(f.sampler.name, "halton") && !strcmp(f.filter.name, "box") &&
           !strcmp(f.accelerator.name, "lbvh") && !f.film.name, "others");
    EXPECT(f.bare, "neither camera nor lights");
    scenefile_clear(&f);
}

/* ---- files ---- */

static void include(void)
{
    static const char sphere[] = "Shape \"sphere\"\n";
    ReadLimits limits = READ_LIMITS_DEFAULT;
    const char *path;
    SceneFile f;
    char folder[300];

    snprintf(folder, sizeof folder, "%.200s/sub", test_folder());
    REQUIRE(!mkdir(folder, 0777), "cannot make a folder");
    scene_write("one.pbrt", "Scale 2 2 2 Include \"two.pbrt\" Shape \"sphere\"");
    scene_write("two.pbrt", sphere);
    scene_write("sub/three.pbrt", "Include \"two.pbrt\" Include \"four.pbrt\"");
    scene_write("sub/four.pbrt", "Translate 1 0 0 Shape \"sphere\"");
    scene_write("five.pbrt", "Scale 3 3 3 Material \"mirror\" Shape \"sphere\" AttributeBegin");
    path = scene_write("main.pbrt", "WorldBegin Include \"one.pbrt\" Include \"sub/three.pbrt\"\n"
                       "Import \"five.pbrt\" Shape \"sphere\"");
    err_reset();
    messages_nowhere();
    REQUIRE(scenefile_read(&f, path, &limits), "refused");
    EXPECT(warnings_count() == 1, "the imported file leaves an attribute open");
    {
        static const struct { float radius, x; uint32_t material; } want[] = {
            { 2, 0, 0 }, { 2, 0, 0 },           /* two and one */
            { 2, 0, 0 }, { 2, 2, 0 },           /* beside the main file, beside its own */
            { 6, 2, 1 }, { 2, 2, 0 }            /* an import leaves nothing behind */
        };
        for (size_t k = 0; k < 6; k++) {
            const Shape *s = scene_shape(&f, k);
            EXPECT(s->as.sphere.radius == want[k].radius && s->as.sphere.centre.x == want[k].x &&
                   s->material == want[k].material, "sphere %lu", (unsigned long)k);
        }
    }
    scenefile_clear(&f);
}

/* ---- objects ---- */

static void objects(void)
{
    SceneFile f = scene_of(
        "WorldBegin Translate 0 0 5 ObjectBegin \"o\" Material \"mirror\" Translate 1 0 0\n" TRI
        "Shape \"sphere\" ObjectEnd ObjectBegin \"empty\" ObjectEnd\n"
        "Shape \"sphere\" AttributeBegin Scale 2 2 2 ObjectInstance \"o\"\n"
        "ObjectInstance \"empty\" AttributeEnd ObjectInstance \"o\"\n",
        0);
    const Geometry *world = &f.scene->geometries[0], *o = &f.scene->geometries[1];

    EXPECT(f.scene->ngeometries == 3 && world->nshapes == 3 && o->nshapes == 2, "counts");
    EXPECT(v_equal(o->p[0], v3(2, 0, 5)), "the object has the transform of where it began");
    EXPECT(o->shapes[0].material == 1 && world->shapes[0].material == 0, "materials");
    EXPECT(world->shapes[1].kind == SHAPE_INSTANCE && world->shapes[1].as.instance->child == 1,
           "an instance");
    EXPECT(v_equal(affine_point(&world->shapes[1].as.instance->to_world, o->p[0]), v3(4, 0, 15)),
           "the instance adds the transform of where it stands");
    EXPECT(v_equal(affine_point(&world->shapes[1].as.instance->to_object, v3(4, 0, 15)),
                   v3(2, 0, 5)), "and back");
    scenefile_clear(&f);
}

/* ---- real scenes ---- */

typedef struct { const char *path; size_t shapes, lights, images; unsigned warnings; } Real;

static void read_real(const Real *want)
{
    ReadLimits limits = READ_LIMITS_DEFAULT;
    const char *path = test_data(want->path);
    SceneFile f;

    err_reset();
    REQUIRE(scenefile_read(&f, path, &limits), "%s was refused", want->path);
    EXPECT(f.scene->geometries[0].nshapes == want->shapes, "%s: %lu shapes, not %lu", want->path,
           (unsigned long)f.scene->geometries[0].nshapes, (unsigned long)want->shapes);
    EXPECT(f.scene->nlights == want->lights, "%s: %lu lights, not %lu", want->path,
           (unsigned long)f.scene->nlights, (unsigned long)want->lights);
    EXPECT(f.scene->nimages == want->images, "%s: %lu images", want->path,
           (unsigned long)f.scene->nimages);
    EXPECT(warnings_count() == want->warnings, "%s: %u warnings, not %u", want->path,
           warnings_count(), want->warnings);
    EXPECT(f.scene->camera && f.film.name && !f.bare, "%s: camera and film", want->path);
    scenefile_clear(&f);
}

/* Counts from the table of the data's README. veach-ajar: the one warning is of triangles without
 * area in its files. */
static void bitterli(void)
{
    static const Real rows[] = {
        { "scenes/cornell-box/scene-v3.pbrt", 8, 1, 0, 0 },
        { "scenes/cornell-box/scene-v4.pbrt", 8, 1, 0, 0 },
        { "scenes/veach-mis/scene-v4.pbrt", 9, 3, 0, 0 },
        { "scenes/veach-bidir/scene-v4.pbrt", 14, 2, 0, 0 },
        { "scenes/veach-ajar/scene-v4.pbrt", 22, 1, 3, 1 },
        { "scenes/caustic-glass/caustic-glass-v4.pbrt", 2, 1, 0, 0 },
    };
    messages_nowhere();
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        read_real(&rows[i]);
}

static void all_scenes(void)
{
    static const char *const names[] = {
        "killeroos/killeroo-simple", "killeroos/killeroo-simple-v3", "killeroos/killeroo-gold",
        "killeroos/killeroo-moving", "killeroos/geometry/killeroo", "killeroos/geometry/killeroo3",
        "simple-room/room-path", "simple-room/room-mlt", "simple-room/room-sppm",
        "simple-room/geometry/room-teapot", "features-v3/cameras/depth-of-field",
        "features-v3/cameras/environment", "features-v3/cameras/orthographic",
        "features-v3/cameras/perspective", "features-v3/geometry/cube",
        "features-v3/lights/diffuse", "features-v3/lights/point", "features-v3/lights/spot",
        "features-v3/objects/instances", "features-v3/shapes/all-shapes",
        "features-v3/shapes/triangles-alpha-mask", "features-v3/test/example",
        "features-v3/textures/2d-checkerboard", "features-v3/textures/bilerp",
        "features-v3/textures/fbm"
    };
    ReadLimits limits = READ_LIMITS_DEFAULT;

    messages_nowhere();
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char name[100];
        SceneFile f;
        bool piece = strstr(names[i], "geometry") != NULL;
        snprintf(name, sizeof name, "scenes/%s.pbrt", names[i]);
        err_reset();
        REQUIRE(scenefile_read(&f, test_data(name), &limits), "%s was refused", name);
        EXPECT(piece == f.bare && piece == !f.scene->camera, "%s: bare", name);
        EXPECT(f.scene->geometries[0].nshapes > 0, "%s: shapes", name);
        scenefile_clear(&f);
    }
    EXPECT(mem_blocks() == 0, "%ld blocks are kept", mem_blocks());
}

const TestCase test_scenefile[] = {
    { "transforms", transforms, false },
    { "camera", camera, false },
    { "active_transform", active_transform, false },
    { "movers", movers, false },
    { "moving_camera", moving_camera, false },
    { "attributes", attributes, false },
    { "area_lights", area_lights, false },
    { "attribute_defaults", attribute_defaults, false },
    { "parameters", parameters, false },
    { "settings", settings, false },
    { "include", include, false },
    { "objects", objects, false },
    { "bitterli", bitterli, false },
    { "all_scenes", all_scenes, false },
    { NULL, NULL, false }
};

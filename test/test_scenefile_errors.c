/* test_scenefile_errors.c -- faults of scene files: each gives one line that names the very byte,
 * and nothing is kept. Names that are not known give a warning that says what is used, and reading
 * goes on. */
#include "test/mesh_help.h"
#include "test/scene_help.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A scene with one fault, where its message must point, and a part of what it must say. */
typedef struct { int line, column; const char *says, *text; } Fault;

static const Fault faults[] = {
    /* words */
    { 1, 1, "unknown directive 'WorldBegn', did you mean 'WorldBegin'?", "WorldBegn" },
    { 2, 3, "unknown directive 'Shpae', did you mean 'Shape'?", "WorldBegin\n  Shpae \"sphere\"" },
    { 1, 12, "expected a directive", "WorldBegin 7" },
    { 1, 33, "expected up to 15 times the numbers cx cy cz n r g b",
      "WorldBegin Material \"lafortune\" \"float lobes\" [1 2 3]" },
    { 1, 33, "expected exponents from 0 to 10000",
      "WorldBegin Material \"lafortune\" \"float lobes\" [1 1 1 -2 1 1 1]" },
    { 1, 27, "expected two strings",
      "WorldBegin Material \"mix\" \"string materials\" \"a\"" },
    { 1, 12, "unexpected byte 0x40", "WorldBegin @" },
    { 1, 16, "unexpected byte 0x21", "WorldBegin Shap!e" },
    { 1, 18, "the string has no end", "WorldBegin Shape \"sphere" },
    { 1, 18, "no end on its line", "WorldBegin Shape \"sphere\n\"" },
    { 1, 9, "unknown escape", "Film \"a \\q\"" },
    { 2, 11, "'1.5.2' is not a number", "#\nTranslate 1.5.2 0 0" },
    { 1, 7, "'1e39' is out of range", "Scale 1e39 1 1" },
    { 1, 7, "'-' is not a number", "Scale - 1 1" },
    /* numbers of directives */
    { 1, 15, "expected a number: Translate takes 3", "Translate 1 2 \"a\"" },
    { 1, 14, "expected a number: Rotate takes 4", "Rotate 1 2 3 WorldBegin" },
    { 1, 44, "expected ']'", "Transform [1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 2]" },
    { 1, 3, "without an inverse", "  Transform [1 0 0 0 0 1 0 0 0 0 0 0 0 0 0 1]" },
    { 1, 1, "a projection", "Transform [1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1]" },
    { 1, 1, "Scale by 0", "Scale 1 0 1" },
    { 1, 1, "an axis that is not 0 0 0", "Rotate 9 0 0 0" },
    { 1, 1, "LookAt needs an eye apart", "LookAt 1 1 1 1 1 1 0 0 1" },
    { 1, 1, "LookAt needs an eye apart", "LookAt 1 1 1 2 1 1 1 0 0" },
    { 2, 1, "becomes infinite or flat", "Scale 1e30 1e30 1e30\nScale 1e30 1 1" },
    { 1, 17, "expected StartTime", "ActiveTransform Never" },
    /* nesting */
    { 1, 1, "AttributeEnd without AttributeBegin", "AttributeEnd" },
    { 2, 2, "TransformEnd stands where AttributeEnd was expected, for the AttributeBegin in line 1",
      "AttributeBegin\n TransformEnd" },
    { 1, 43, "ObjectEnd stands where AttributeEnd",
      "WorldBegin ObjectBegin \"a\" AttributeBegin ObjectEnd" },
    { 1, 28, "ObjectBegin inside of an object", "WorldBegin ObjectBegin \"a\" ObjectBegin \"b\"" },
    { 1, 28, "an instance of itself", "WorldBegin ObjectBegin \"a\" ObjectInstance \"a\"" },
    { 1, 50, "called 'a' already", "WorldBegin ObjectBegin \"a\" ObjectEnd ObjectBegin \"a\"" },
    { 1, 1, "WorldEnd without WorldBegin", "WorldEnd" },
    { 1, 12, "Camera stands after WorldBegin", "WorldBegin Camera \"perspective\"" },
    { 2, 1, "Shape stands before WorldBegin", "Camera \"perspective\"\nShape \"sphere\"" },
    /* parameters */
    { 1, 26, "unknown parameter type 'flaot', did you mean 'float'?",
      "WorldBegin Shape \"disk\"  \"flaot radius\" 1" },
    { 1, 10, "declared by its type and its name", "Film \"x\" \"float a b\" 1" },
    { 1, 20, "a string stands where a number was expected", "Film \"x\" \"float a\" \"b\"" },
    { 1, 19, "the end of the file stands where", "Film \"x\" \"float a\"" },
    { 1, 26, "a number stands where a string", "Film \"x\" \"string a\" [\"b\" 2]" },
    { 1, 22, "the list is empty", "Film \"x\" \"integer a\" []" },
    { 1, 25, "the list that begins in line 1 has no end",
      "Film \"x\" \"float a\" [1 2 WorldBegin" },
    { 1, 22, "'1.5' is not right, expected a whole number", "Film \"x\" \"integer a\" 1.5" },
    { 1, 19, "expected", "Film \"x\" \"bool a\" 1" },
    { 1, 10, "4 numbers are given, expected groups of 3", "Film \"x\" \"point3 a\" [1 2 3 4]" },
    { 1, 10, "2 numbers are given, a colour has three", "Film \"x\" \"rgb a\" [1 2]" },
    { 1, 10, "pairs of wavelength", "Film \"x\" \"spectrum a\" [400 1 500]" },
    { 1, 10, "wavelengths of a spectrum must rise", "Film \"x\" \"spectrum a\" [500 1 400 1]" },
    { 1, 10, "from 100 to 10000000 kelvin", "Film \"x\" \"blackbody a\" 50" },
    { 1, 31, "the file", "WorldBegin Material \"diffuse\" \"spectrum reflectance\" \"none.spd\"" },
    { 1, 31, "2 spectra are given",
      "WorldBegin Material \"diffuse\" \"spectrum reflectance\" [\"a\" \"b\"]" },
    { 1, 10, "the spectrum is out of range", "Film \"x\" \"xyz a\" [3e38 0 0]" },
    /* values that a table refuses */
    { 1, 22, "a number from", "Camera \"perspective\" \"float fov\" 200" },
    { 1, 31, "one number or three",
      "WorldBegin Material \"diffuse\" \"string reflectance\" \"x\"" },
    { 1, 31, "is not right, expected",
      "WorldBegin Material \"diffuse\" \"rgb reflectance\" [1 2 3]" },
    { 1, 33, "a texture cannot give it",
      "WorldBegin Material \"conductor\" \"texture remaproughness\" \"x\"" },
    { 1, 27, "a number from", "WorldBegin Shape \"sphere\" \"float radius\" -1" },
    { 1, 12, "the sphere is empty", "WorldBegin Shape \"sphere\" \"float zmin\" 3" },
    { 1, 12, "the disc is empty", "WorldBegin Shape \"disk\" \"float innerradius\" 1" },
    { 1, 37, "not finite",
      "WorldBegin Translate 3e38 3e38 3e38 Shape \"trianglemesh\" \"point3 P\" "
      "[3e38 0 0 0 1 0 0 0 1]" },
    { 1, 40, "expected a number, a colour or a texture",
      "WorldBegin Texture \"a\" \"float\" \"scale\" \"string tex1\" \"x\"" },
    { 1, 40, "expected one number or three",
      "WorldBegin Texture \"a\" \"float\" \"scale\" \"float tex1\" [1 2]" },
    { 1, 40, "expected one texture",
      "WorldBegin Texture \"a\" \"float\" \"scale\" \"texture tex1\" [\"b\" \"c\"]" },
    { 1, 47, "\"uscale\" is not right, expected 1 number",
      "WorldBegin Texture \"a\" \"float\" \"checkerboard\" \"float uscale\" [1 2]" },
    { 1, 43, "\"filename\" is not right, expected one string",
      "WorldBegin Texture \"a\" \"float\" \"imagemap\" \"float filename\" 1" },
    { 1, 67, "\"wrap\" is not right, expected one string", "WorldBegin Texture \"a\" \"float\" "
      "\"imagemap\" \"string filename\" \"b\"   \"float wrap\" 1" },
    /* lights */
    { 1, 12, "the sun is not above the horizon",
      "WorldBegin LightSource \"sky\" \"vector3 sundirection\" [1 0 0]" },
    { 1, 32, "expected a number from 2 to 10",
      "WorldBegin LightSource \"sky\"   \"float turbidity\" 1" },
    { 1, 24, "a goniometric light's transform must be a rotation",
      "WorldBegin Scale 1 2 3 LightSource \"goniometric\"" },
    { 1, 35, "\"string mapping\" is not right",
      "WorldBegin LightSource \"infinite\" \"string mapping\" \"cube\"" },
    /* shapes */
    { 1, 33, "\"P\" is not right",
      "WorldBegin Shape \"trianglemesh\" \"integer P\" [1 2 3]" },
    { 1, 62, "\"N\" is not right, expected numbers",
      "WorldBegin Shape \"trianglemesh\" \"point P\" [0 0 0 1 0 0 0 1 0]\"string N\" \"a\"" },
    { 1, 36, "the sphere is not finite, or has no size",
      "WorldBegin Scale 1e-20 1e-20 1e-20 Shape \"sphere\" \"float radius\" 1e-30" },
    { 1, 36, "the disc is not finite",
      "WorldBegin Scale 1e20 1e20 1e20    Shape \"disk\" \"float radius\" 1e20" },
    { 1, 12, "needs its points", "WorldBegin Shape \"trianglemesh\"" },
    { 1, 12, "needs \"integer indices\"",
      "WorldBegin Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 1 1]" },
    { 2, 1, "index 2 of \"indices\" is 3, expected a whole number from 0 to 2",
      "WorldBegin Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]\n"
      "\"integer indices\" [0 1 3]" },
    { 2, 1, "index 0 of \"indices\" is -1",
      "WorldBegin Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]\n"
      "\"integer indices\" [-1 1 2]" },
    { 2, 1, "groups of 3",
      "WorldBegin Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]\n"
      "\"integer indices\" [0 1]" },
    { 1, 12, "needs a \"string filename\"", "WorldBegin Shape \"plymesh\"" },
    { 3, 2, "none.ply cannot be found",
      "WorldBegin\n\n Shape \"plymesh\" \"string filename\" \"none.ply\"" },
    { 1, 12, "expected 0 <= zmin < zmax", "WorldBegin Shape \"paraboloid\" \"float zmin\" -1" },
    { 1, 12, "\"integer nu\"", "WorldBegin Shape \"heightfield\"" },
    { 1, 68, "nu times nv",
      "WorldBegin Shape \"heightfield\" \"integer nu\" 2 \"integer nv\" 2       "
      "\"float Pz\" [1 2 3]" },
    { 1, 12, "\"integer nu\" and \"integer nv\" alike",
      "WorldBegin Shape \"heightfield\" \"string subdivision\" \"triangular\" \"integer nu\" 2 "
      "\"integer nv\" 3 \"float Pz\" [1 2 3]" },
    { 1, 96, "nu times nu + 1 by 2",
      "WorldBegin Shape \"heightfield\" \"string subdivision\" \"triangular\" \"integer nu\" 2 "
      "\"integer nv\" 2 \"float Pz\" [1 2 3 4]" },
    { 1, 12, "a torus has no such image",
      "WorldBegin Shape \"geometryimage\" \"string surface\" \"torus\" \"integer side\" 2" },
    { 1, 12, "the torus meets itself",
      "WorldBegin Shape \"geometryimage\" \"string surface\" \"torus\" \"float minorradius\" 1" },
    { 1, 12, "the curved shapes of the scene become more than",
      "WorldBegin Shape \"geometryimage\" \"integer side\" 99999" },
    { 1, 36, "the point 0 is not finite",
      "WorldBegin Scale 1e30 1e30 1e30    Shape \"geometryimage\" \"float radius\" 1e20" },
    { 1, 12, "a bezier curve of degree 3 cannot have 5 points, expected one more than a multiple",
      "WorldBegin Shape \"curve\" \"point3 P\" [1 2 3 1 2 3 1 2 3 1 2 3 1 2 3]" },
    { 1, 12, "a bspline curve of degree 2 cannot have 2 points, expected more than the degree",
      "WorldBegin Shape \"curve\" \"string basis\" \"bspline\" \"integer degree\" 2 "
      "\"point3 P\" [1 2 3 1 2 4]" },
    { 1, 12, "a ribbon needs its normals",
      "WorldBegin Shape \"curve\" \"string type\" \"ribbon\" \"integer degree\" 2 "
      "\"point3 P\" [1 2 3 1 2 4 1 2 5]" },
    { 1, 80, "expected 2 normals for a ribbon of 1 segments",
      "WorldBegin Shape \"curve\" \"string type\" \"ribbon\" \"point3 P\" [1 2 3 1 2 4 0 0 0] "
      "\"normal N\" [0 0 1] \"integer degree\" 2" },
    { 1, 12, "the torus meets itself", "WorldBegin Shape \"torus\" \"float minorradius\" 2" },
    { 1, 12, "the box is empty", "WorldBegin Shape \"box\" \"point3 to\" [1 -1 1]" },
    { 1, 12, "a lathe needs its outline", "WorldBegin Shape \"lathe\"" },
    { 1, 26, "point 1 of the outline is beyond the axis",
      "WorldBegin Shape \"lathe\" \"point2 P\" [0 0 -1 1]" },
    /* names and files */
    { 1, 9, "none.pbrt cannot be found", "Include \"none.pbrt\"" },
    { 1, 9, "the name of the file in quotes", "Include none" },
    { 1, 18, "the kind of shape in quotes", "WorldBegin Shape sphere" },
    { 1, 24, "of type \"float\" or \"spectrum\"",
      "WorldBegin Texture \"a\" \"colour\" \"constant\"" },
    { 1, 12, "an imagemap needs", "WorldBegin Texture \"a\" \"float\" \"imagemap\"" },
    { 1, 12, "needs a \"string type\"", "WorldBegin MakeNamedMaterial \"a\"" },
    { 1, 11, "expected \"shape\"", "Attribute \"shapes\" \"float radius\" 1" },
    { 1, 1, "Option takes a name", "Option 7" },
};

static const char *at_place(const Fault *f)
{
    static char place[60];
    snprintf(place, sizeof place, "test.pbrt:%d:%d: ", f->line, f->column);
    return place;
}

static void expect_fault(const Fault *f)
{
    char line[2000];
    const char *found;
    SceneFile s;
    int lines;

    err_reset();
    EXPECT(!scene_parse(&s, f->text), "was read: %s", f->text);
    lines = messages_take(line, sizeof line);
    EXPECT(err_status() == STATUS_INPUT && lines == 1, "%d lines: %s", lines, f->text);
    found = strstr(line, at_place(f));
    EXPECT(found, "%s\n  gives\n%s\n  not at %s", f->text, line, at_place(f));
    EXPECT(strstr(line, f->says), "%s\n  gives\n%s\n  not: %s", f->text, line, f->says);
    EXPECT(mem_blocks() == 0, "%ld blocks are kept: %s", mem_blocks(), f->text);
}

static void places(void)
{
    messages_start();
    for (size_t i = 0; i < sizeof faults / sizeof *faults; i++)
        expect_fault(&faults[i]);
}

/* ---- warnings ---- */

static const Fault warnings[] = {
    { 1, 8, "the camera 'pinhole' is not supported; perspective is used",
      "Camera \"pinhole\" \"float fov\" 50 \"float x\" 1 WorldBegin" },
    { 1, 22, "perspective has no parameter 'fow', did you mean 'fov'?; it is left out",
      "Camera \"perspective\" \"float fow\" 50 WorldBegin" },
    { 1, 18, "unknown shape 'shpere', did you mean 'sphere'?; it is left out",
      "WorldBegin Shape \"shpere\" \"float radius\" 1" },
    { 1, 12, "the shape 'nurbs' is not supported",
      "WorldBegin Shape \"nurbs\" \"point3 P\" [0 0 0]" },
    { 1, 12, "the curve has no length or no width; it is left out",
      "WorldBegin Shape \"curve\" \"point3 P\" [1 2 3 1 2 3 1 2 3 1 2 3]" },
    { 1, 27, "sphere has no parameter 'radios', did you mean 'radius'?",
      "WorldBegin Shape \"sphere\" \"float radios\" 1" },
    { 1, 12, "unknown material 'mate', did you mean 'matte'?; the neutral one is used",
      "WorldBegin Material \"mate\" \"rgb Kd\" [1 2 3]" },
    { 1, 12, "the material 'hair' is not supported; diffuse is used",
      "WorldBegin Material \"hair\" \"rgb color\" [.1 .1 .1]" },
    { 1, 12, "disney is a mixture of models that have no sheen, thin; left out",
      "WorldBegin Material \"disney\" \"float sheen\" 1 \"bool thin\" true" },
    { 1, 33, "disney has no parameter 'shen'",
      "WorldBegin Material \"disney\"    \"float shen\" 1" },
    { 1, 12, "the coat is left out", "WorldBegin Material \"disney\" \"float metallic\" .5 "
      "\"float spectrans\" .5 \"float clearcoat\" 1" },
    { 1, 37, "coats are clear", "WorldBegin Material \"coateddiffuse\" \"rgb albedo\" [0 0 .1]" },
    { 1, 56, "no material is called 'bb', did you mean 'b'?; the neutral one is used",
      "WorldBegin MakeNamedMaterial \"b\" \"string type\" \"matte\" "
      "Material \"mix\" \"string materials\" [\"b\" \"bb\"]" },
    { 1, 31, "pictures of the kind of 'a.jpg' cannot be read; the surface stays even",
      "WorldBegin Material \"diffuse\" \"string normalmap\" \"a.jpg\"" },
    { 2, 15, "no material is called 'bc', did you mean 'bcd'?; the neutral one is used",
      "WorldBegin MakeNamedMaterial \"bcd\" \"string type\" \"matte\"\nNamedMaterial \"bc\"" },
    { 1, 31, "unknown texture 'a'",
      "WorldBegin Material \"diffuse\" \"texture reflectance\" \"a\"" },
    { 1, 32, "unknown class of texture 'chess'", "WorldBegin Texture \"a\" \"float\" \"chess\"" },
    { 1, 43, "constant textures have no parameter 'valu'",
      "WorldBegin Texture \"a\" \"float\" \"constant\" \"float valu\" 1" },
    { 1, 24, "the light 'pont' is not known, did you mean 'point'?; it is left out",
      "WorldBegin LightSource \"pont\"" },
    { 1, 28, "the area light 'difuse' is not known, did you mean 'diffuse'?",
      "WorldBegin AreaLightSource \"difuse\"" },
    { 1, 24, "the light 'sun' is not known", "WorldBegin LightSource \"sun\" \"rgb L\" [1 1 1]" },
    { 1, 35, "a portal is left out: the light is the same",
      "WorldBegin LightSource \"infinite\" \"point3 portal\" [0 0 0 1 0 0 1 1 0 0 1 0]" },
    { 1, 28, "the area light 'point' is not known", "WorldBegin AreaLightSource \"point\"" },
    { 1, 30, "unknown coordinate system 'worl', did you mean 'world'?",
      "WorldBegin CoordSysTransform \"worl\"" },
    { 1, 27, "unknown object 'a'", "WorldBegin ObjectInstance \"a\"" },
    { 1, 12, "unknown colour space 'rec2021', did you mean 'rec2020'?", "ColorSpace \"rec2021\"" },
    { 1, 31, "unknown spectrum 'metal-Cu-et', did you mean 'metal-Cu-eta'?; the parameter is left",
      "WorldBegin Material \"diffuse\" \"spectrum reflectance\" \"metal-Cu-et\"" },
    { 1, 31, "unknown spectrum 'stdilum-F9', did you mean 'stdillum-F9'?",
      "WorldBegin Material \"diffuse\" \"spectrum reflectance\" \"stdilum-F9\"" },
    { 1, 1, "AttributeBegin has no AttributeEnd", "AttributeBegin" },
    { 1, 1, "AttributeBegin has no AttributeEnd", "AttributeBegin WorldBegin" },
    { 1, 1, "Shape stands before WorldBegin; this is read as a part",
      "Shape \"sphere\" Shape \"disk\"" },
    { 1, 42, "this one is used",
      "WorldBegin Shape \"disk\" \"float radius\" 1 \"float radius\" 2" },
    { 1, 12, "1 triangle is of zero area left out",
      "WorldBegin Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 1 1 2 2 2]" },
    { 2, 1, "\"N\" has 3 numbers, expected 9",
      "WorldBegin Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]\n\"normal N\" [0 0 1]" },
    { 1, 1, "media of type 'cloud' are not supported; it is left out",
      "MakeNamedMedium \"a\" \"string type\" \"cloud\"" },
    { 1, 8, "the option 'seed' is left out", "Option \"integer seed\" 7" },
    { 1, 8, "the option 'disablepixeljitter' is left out", "Option \"disablepixeljitter\" true" },
    { 1, 50, "unknown medium 'a'; nothing is there", "WorldBegin Shape \"sphere\"        "
      "MediumInterface \"a\"" },
    { 1, 1, "VolumeIntegrator is left out", "VolumeIntegrator \"a\" \"float b\" 1" },
    { 1, 51, "unknown mapping 'plana', did you mean 'planar'?; uv is used", "WorldBegin Texture "
      "\"a\" \"float\" \"checkerboard\"     \"string mapping\" \"plana\" \"vector v1\" [1 0 0]" },
    { 1, 47, "a checkerboard has 2 or 3 dimensions", "WorldBegin Texture \"a\" \"float\" "
      "\"checkerboard\" \"integer dimension\" 4" },
    { 1, 12, "cannot be read; grey 0.5 is used (another program can convert it to PNG)",
      "WorldBegin Texture \"a\" \"float\" \"imagemap\" \"string filename\" \"b.jpg\"" },
    { 1, 74, "is defined again", "WorldBegin MakeNamedMaterial \"a\" \"string type\" \"matte\" "
      "MakeNamedMaterial \"a\" \"string type\" \"mirror\"" },
    { 1, 43, "is defined again", "WorldBegin Texture \"a\" \"float\" \"constant\" "
      "Texture \"a\" \"float\" \"constant\"" },
    { 1, 55, "shapes of objects cannot be lights", "WorldBegin ObjectBegin \"a\" "
      "AreaLightSource \"diffuse\"  Shape \"disk\" Shape \"disk\" ObjectEnd" },
    { 1, 24, "triangles are used", "WorldBegin Scale 1 2 3 Shape \"sphere\"" },
};

static void warnings_say(void)
{
    messages_start();
    for (size_t i = 0; i < sizeof warnings / sizeof *warnings; i++) {
        const Fault *w = &warnings[i];
        char line[2000];
        SceneFile f;
        int lines;

        err_reset();
        EXPECT(scene_parse(&f, w->text), "was refused: %s", w->text);
        lines = messages_take(line, sizeof line);
        EXPECT(lines == 1 && warnings_count() == 1, "%d lines: %s", lines, w->text);
        EXPECT(strstr(line, at_place(w)), "%s\n  gives\n%s\n  not at %s", w->text, line,
               at_place(w));
        EXPECT(strstr(line, w->says), "%s\n  gives\n%s\n  not: %s", w->text, line, w->says);
        scenefile_clear(&f);
        err_reset();
        warnings_fatal(true);           /* --strict: the same line refuses */
        EXPECT(!scene_parse(&f, w->text) && err_status() == STATUS_INPUT, "strict: %s", w->text);
        messages_take(line, sizeof line);
        EXPECT(mem_blocks() == 0, "%ld blocks are kept: %s", mem_blocks(), w->text);
    }
}

/* ---- other files ---- */

static void spd_errors(void)
{
    static const struct { const char *text, *says; } rows[] = {
        { "400 1\n500 x\n", "a.spd:2:5: a spectrum file holds pairs" },
        { "400 1\n\n400 2\n", "a.spd:3:1: wavelengths must rise" },
        { "400 1\n500", "a.spd: a spectrum file holds pairs" },
        { "# none\n", "a.spd: a spectrum file holds pairs" },
    };
    char line[2000];
    SceneFile f;

    messages_start();
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        scene_write("a.spd", rows[i].text);
        err_reset();
        EXPECT(!scene_parse(&f, "WorldBegin Material \"metal\" \"spectrum k\" \"a.spd\""),
               "was read: %s", rows[i].text);
        EXPECT(messages_take(line, sizeof line) == 1 && strstr(line, rows[i].says), "%s", line);
        EXPECT(mem_blocks() == 0, "blocks are kept");
    }
}

static void many_parameters(void)
{
    char text[300 * 20], line[2000];
    size_t n = (size_t)sprintf(text, "Film \"x\"");
    SceneFile f;

    for (int i = 0; i < 257; i++)
        n += (size_t)sprintf(text + n, " \"float a%d\" 1", i);
    messages_start();
    EXPECT(!scene_parse(&f, text), "was read");
    messages_take(line, sizeof line);
    EXPECT(strstr(line, "more than 256 parameters"), "%s", line);
}

/* ---- files that include files ---- */

static void expect_error(const char *path, const char *says)
{
    ReadLimits limits = READ_LIMITS_DEFAULT;
    char line[2000];
    SceneFile f;

    err_reset();
    EXPECT(!scenefile_read(&f, path, &limits), "%s was read", path);
    messages_take(line, sizeof line);
    EXPECT(strstr(line, says), "%s\n  not: %s", line, says);
    EXPECT(mem_blocks() == 0, "%ld blocks are kept", mem_blocks());
}

static void include_errors(void)
{
    char text[100], name[20];

    messages_start();
    scene_write("self.pbrt", "Include \"self.pbrt\"");
    expect_error(scene_write("self.pbrt", "\n Include \"self.pbrt\""),
                 "self.pbrt:2:10: a file includes");
    scene_write("b.pbrt", "Include \"a.pbrt\"");
    expect_error(scene_write("a.pbrt", "Include \"b.pbrt\""), "a.pbrt includes ");
    scene_write("bad.pbrt", "\n\n Shpe");
    expect_error(scene_write("main.pbrt", "Include \"bad.pbrt\""),
                 "bad.pbrt:3:2: unknown directive");
    for (int i = 0; i < 70; i++) {              /* a chain of 70 is longer than the limit of 64 */
        snprintf(name, sizeof name, "c%d.pbrt", i);
        snprintf(text, sizeof text, "Include \"c%d.pbrt\"", i + 1);
        scene_write(name, text);
    }
    expect_error(scene_write("c.pbrt", "Include \"c0.pbrt\""), "more than 64 deep");
    scene_write("open.pbrt", "AttributeEnd");
    expect_error(scene_write("import.pbrt", "WorldBegin AttributeBegin Import \"open.pbrt\""),
                 "AttributeEnd stands where the end of the imported file was expected");
    expect_error("none.pbrt", "none.pbrt: cannot be opened");
    expect_error(scene_write("scene.txt", ""), "a scene was expected: .pbrt, .obj or .ply");
    expect_error(test_folder(), "a scene was expected");
}

/* Files that include each other twice would double at each level: 2^40 of them. */
static void include_bomb(void)
{
    char text[100], name[20];

    messages_start();
    for (int i = 0; i < 40; i++) {
        snprintf(name, sizeof name, "d%d.pbrt", i);
        snprintf(text, sizeof text, "Include \"d%d.pbrt\" Include \"d%d.pbrt\"", i + 1, i + 1);
        scene_write(name, text);
    }
    scene_write("d40.pbrt", "");
    expect_error(scene_write("d.pbrt", "Include \"d0.pbrt\""), "files are included");
}

/* ---- nesting ---- */

static void deep(void)
{
    enum { N = 100000 };
    static const struct { const char *word, *says; } rows[] = {
        { "AttributeBegin ", "nested more than 1024 deep" },
        { "TransformBegin ", "nested more than 1024 deep" },
        { "Attribute \"shape\" \"float radius\" 1 ", "more than 64 parameters" },
    };
    char line[2000], *text = malloc(40 * (size_t)N);
    SceneFile f;

    REQUIRE(text, "memory");
    messages_start();
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        size_t n = strlen(rows[k].word);
        for (size_t i = 0; i < N; i++)
            memcpy(text + i * n, rows[k].word, n);
        text[N * n] = 0;
        err_reset();
        EXPECT(!scene_parse(&f, text), "%s was read", rows[k].word);
        EXPECT(messages_take(line, sizeof line) == 1 && strstr(line, rows[k].says), "%s", line);
    }
    free(text);
}

/* A texture of textures of textures, twice each: 2^40 evaluations. */
static void texture_bomb(void)
{
    char text[8000], line[2000];
    int n = snprintf(text, sizeof text, "WorldBegin Texture \"t0\" \"float\" \"constant\"\n");
    SceneFile f;

    for (int i = 1; i < 40; i++)
        n += snprintf(text + n, sizeof text - (size_t)n,
                      "Texture \"t%d\" \"float\" \"scale\" \"texture tex1\" \"t%d\" "
                      "\"texture tex2\" \"t%d\"\n",
                      i, i - 1, i - 1);
    messages_start();
    EXPECT(!scene_parse(&f, text), "was read");
    messages_take(line, sizeof line);
    EXPECT(strstr(line, "made of more than 256 others"), "%s", line);
}

const TestCase test_scenefile_errors[] = {
    { "places", places, false },
    { "warnings", warnings_say, false },
    { "spd_errors", spd_errors, false },
    { "many_parameters", many_parameters, false },
    { "include_errors", include_errors, false },
    { "include_bomb", include_bomb, false },
    { "deep", deep, false },
    { "texture_bomb", texture_bomb, false },
    { NULL, NULL, false }
};

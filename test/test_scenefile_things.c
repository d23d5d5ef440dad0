/* test_scenefile_things.c -- what scene files are made of but shapes: spectra, materials, textures,
 * OBJ scenes. Expectations are published constants of metals and illuminants, and spellings of one
 * thing that must agree. */
#include "scenefile/spectrum.h"
#include "test/mesh_help.h"
#include "test/scene_help.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define QUAD "\"point3 P\" [0 0 0 1 0 0 1 1 0 0 1 0] \"integer indices\" [0 1 2 0 2 3] "

/* ---- spectra ---- */

static void chromaticity(const double rgb[3], double *x, double *y)
{
    /* Rec. 709 to XYZ, IEC 61966-2-1. */
    double X = 0.4124 * rgb[0] + 0.3576 * rgb[1] + 0.1805 * rgb[2];
    double Y = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
    double Z = 0.0193 * rgb[0] + 0.1192 * rgb[1] + 0.9505 * rgb[2];
    *x = X / (X + Y + Z);
    *y = Y / (X + Y + Z);
}

static void expect_rgb(const char *what, const double rgb[3], double r, double g, double b,
                       double tol)
{
    EXPECT(fabs(rgb[0] - r) <= tol && fabs(rgb[1] - g) <= tol && fabs(rgb[2] - b) <= tol,
           "%s: %g %g %g, not %g %g %g", what, rgb[0], rgb[1], rgb[2], r, g, b);
}

/* The 1931 observer (CIE 15, table T.4) every 20 nm from 400. */
static const double observer[16][3] = {
    { 0.01431, 0.000396, 0.06785 }, { 0.13438, 0.004, 0.6456 }, { 0.34828, 0.023, 1.74706 },
    { 0.2908, 0.06, 1.6692 }, { 0.09564, 0.13902, 0.81295 }, { 0.0049, 0.323, 0.272 },
    { 0.06327, 0.71, 0.07825 }, { 0.2904, 0.954, 0.0203 }, { 0.5945, 0.995, 0.0039 },
    { 0.9163, 0.87, 0.00165 }, { 1.0622, 0.631, 0.0008 }, { 0.85445, 0.381, 0.00019 },
    { 0.4479, 0.175, 0.00002 }, { 0.1649, 0.061, 0 }, { 0.04677, 0.017, 0 }, { 0.01136, 0.0041, 0 }
};

/* The sums again, with the observer's own data and Planck's law as it stands. */
static void naive_blackbody(double kelvin, double scale, double rgb[3])
{
    double top = 2.897771955e6 / kelvin, xyz[3] = { 0, 0, 0 }, y = 0;
    for (int i = 0; i < 16; i++) {
        double nm = 400 + 20 * i;
        double v = pow(top / nm, 5) * (exp(1.438776877e7 / (top * kelvin)) - 1) /
                   (exp(1.438776877e7 / (nm * kelvin)) - 1);
        for (int k = 0; k < 3; k++)
            xyz[k] += scale * v * observer[i][k];
        y += observer[i][1];
    }
    for (int k = 0; k < 3; k++)
        xyz[k] /= y;
    spectrum_from_xyz(xyz, rgb);
}

/* The fits err by a few hundredths of the peaks [Wyman13 table 1]: 4 % of the largest channel. */
static void blackbodies(void)
{
    static const struct { double kelvin, x, y; } rows[] = {         /* Planckian locus, CIE 15 */
        { 2855.5, 0.44758, 0.40745 }, { 4000, 0.38045, 0.37675 }, { 6500, 0.31352, 0.32363 },
        { 10000, 0.28063, 0.28833 }
    };
    static const double scale = 3, flat[] = { 400, 2, 800, 2 };
    double a[3], b[3], c[3], xyz[3], x, y;
    Cie cie;

    cie_init(&cie);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        spectrum_from_kelvin(&cie, rows[i].kelvin, NULL, a);
        chromaticity(a, &x, &y);
        EXPECT(fabs(x - rows[i].x) < 0.01 && fabs(y - rows[i].y) < 0.01, "%g K: %g %g",
               rows[i].kelvin, x, y);
        EXPECT(fabs(0.2126 * a[0] + 0.7152 * a[1] + 0.0722 * a[2] - 1) < 1e-3, "luminance 1");
        spectrum_from_kelvin(&cie, rows[i].kelvin, &scale, b);
        EXPECT(fabs(b[0] / b[2] / (a[0] / a[2]) - 1) < 1e-12, "the scale keeps the hue");
        naive_blackbody(rows[i].kelvin, scale, c);
        expect_rgb("black body", b, c[0], c[1], c[2], 0.04 * (c[0] > c[2] ? c[0] : c[2]));
    }
    xyz[0] = xyz[1] = xyz[2] = 2;               /* flat light is illuminant E */
    spectrum_from_xyz(xyz, c);
    spectrum_from_samples(&cie, flat, 2, SPECTRUM_LIGHT, b);
    expect_rgb("flat light of 2", b, c[0], c[1], c[2], 0.04 * c[0]);
    spectrum_from_samples(&cie, flat, 2, SPECTRUM_ALBEDO, b);
    expect_rgb("flat albedo of 2", b, 2, 2, 2, 1e-12);
}

/* One number: version 4, luminance 1. Two: version 3, with the scale of the peak. */
static void blackbody_parameters(void)
{
    static const double scale = 3;
    SceneFile f = scene_of("WorldBegin\n"
                           "LightSource \"point\" \"blackbody I\" 3000 \"float scale\" 2\n"
                           "LightSource \"point\" \"blackbody I\" [3000 3]", 0);
    double a[3], b[3], four_pi = 12.566370614;
    Rgb p = f.scene->lights[0]->kind->power(f.scene->lights[0]);
    Rgb q = f.scene->lights[1]->kind->power(f.scene->lights[1]);
    Cie cie;

    cie_init(&cie);
    spectrum_from_kelvin(&cie, 3000, NULL, a);
    spectrum_from_kelvin(&cie, 3000, &scale, b);
    EXPECT(fabs(p.r / (2 * four_pi * a[0]) - 1) < 1e-6 &&
               fabs(p.b / (2 * four_pi * a[2]) - 1) < 1e-6,
           "version 4: %g %g %g", p.r, p.g, p.b);
    EXPECT(fabs(q.r / (four_pi * b[0]) - 1) < 1e-6 && fabs(q.b / (four_pi * b[2]) - 1) < 1e-6,
           "version 3: %g %g %g", q.r, q.g, q.b);
    scenefile_clear(&f);
}

/* Of the metals: constants as they are in the scenes that Bitterli gave away, made of other
 * measurements and under illuminant E, whose white is divided out here (1.205, 0.948, 0.909). */
static void named_spectra(void)
{
    static const struct { const char *name; double r, g, b, tol; } rows[] = {
        { "metal-Cu-eta", 0.2004 / 1.205, 0.9240 / 0.948, 1.1022 / 0.909, 0.12 },
        { "metal-Cu-k", 3.9129 / 1.205, 2.4528 / 0.948, 2.1422 / 0.909, 0.2 },
        { "metal-Al-eta", 1.6575 / 1.205, 0.8804 / 0.948, 0.5212 / 0.909, 0.12 },
        { "metal-Al-k", 9.2239 / 1.205, 6.2695 / 0.948, 4.8370 / 0.909, 0.35 },
        { "metal-Au-eta", 0.1431 / 1.205, 0.3750 / 0.948, 1.4425 / 0.909, 0.2 },
        { "metal-Au-k", 3.9832 / 1.205, 2.3857 / 0.948, 1.6032 / 0.909, 0.25 },
        { "metal-MgO-eta", 1.735, 1.741, 1.752, 0.01 },
        { "metal-MgO-k", 0, 0, 0, 0 },
        { "glass-BK7", 1.5168, 1.5168, 1.5168, 1e-4 },
        { "glass-F11", 1.7847, 1.7847, 1.7847, 1e-4 },
        { "stdillum-D65", 1, 1, 1, 0.003 },
    };
    double rgb[3];
    Cie cie;

    cie_init(&cie);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        EXPECT(spectrum_named(&cie, rows[i].name, SPECTRUM_ALBEDO, rgb), "%s", rows[i].name);
        expect_rgb(rows[i].name, rgb, rows[i].r, rows[i].g, rows[i].b, rows[i].tol);
    }
    EXPECT(spectrum_named(&cie, "metal-CuZn-k", SPECTRUM_ALBEDO, rgb) && rgb[0] > rgb[2], "brass");
    EXPECT(!spectrum_named(&cie, "metal-Cu", SPECTRUM_ALBEDO, rgb) &&
           !spectrum_named(&cie, "metal-Cu-etas", SPECTRUM_ALBEDO, rgb) &&
           !spectrum_named(&cie, "", SPECTRUM_ALBEDO, rgb), "names that are none");
}

/* Spaces: white stays white, sRGB is ours, and the red of a wider space lies outside of ours. */
static void colour_spaces(void)
{
    double m[3][3];
    SceneFile f;

    for (size_t s = 0; spectrum_spaces[s]; s++) {
        EXPECT(spectrum_space(spectrum_spaces[s], m), "%s", spectrum_spaces[s]);
        for (int i = 0; i < 3; i++) {
            EXPECT(fabs(m[i][0] + m[i][1] + m[i][2] - 1) < 1e-12, "%s: white", spectrum_spaces[s]);
            for (int k = 0; k < 3 && s == 0; k++)
                EXPECT(fabs(m[i][k] - (i == k)) < 2e-4, "sRGB is not ours: %g", m[i][k]);
        }
        EXPECT(s == 0 || (m[0][0] > 1.2 && m[1][0] < 0), "%s: red", spectrum_spaces[s]);
    }
    f = scene_of(
        "ColorSpace \"rec2020\" WorldBegin Material \"diffuse\" \"rgb reflectance\" [1 0 0] "
        "Shape \"sphere\"",
        0);
    EXPECT(f.scene->materials[1].value[0].r == 1 && f.scene->materials[1].value[0].g == 0,
           "a reflectance stays one");
    scenefile_clear(&f);
}

static void spd_file(void)
{
    SceneFile f;
    Rgb v;

    scene_write("a.spd", "# nm value\n300 2\n\n  900 2 # flat\n");
    f = scene_of("WorldBegin Material \"conductor\" \"spectrum eta\" \"a.spd\" "
                 "\"spectrum k\" [300 3 900 3] Shape \"sphere\"", 0);
    v = f.scene->materials[1].value[4];
    EXPECT(fabsf(v.r - 2) < 1e-6f && fabsf(v.b - 2) < 1e-6f, "eta %g %g %g", v.r, v.g, v.b);
    EXPECT(fabsf(f.scene->materials[1].value[5].g - 3) < 1e-6f, "k");
    scenefile_clear(&f);
}

/* ---- materials ---- */

/* Two spellings of one thing give the same material. */
static void spellings(void)
{
    static const char *const pairs[][2] = {
        { "\"matte\" \"color Kd\" [.1 .2 .3]", "\"diffuse\" \"rgb reflectance\" [.1 .2 .3]" },
        { "\"matte\"", "\"diffuse\" \"float reflectance\" .5" },
        { "\"mirror\" \"rgb Kr\" [1 1 0]", "\"mirror\" \"rgb reflectance\" [1 1 0]" },
        { "\"glass\"", "\"dielectric\"" },
        { "\"glass\" \"float index\" 1.3 \"color Kt\" [1 0 0]",
          "\"dielectric\" \"rgb transmittance\" [1 0 0] \"float eta\" [1.3]" },
        { "\"dielectric\" \"spectrum eta\" \"glass-BK7\"", "\"dielectric\" \"float eta\" 1.5168" },
        /* The alphas are what version 3's formula gives, worked out by hand. */
        { "\"metal\" \"float roughness\" .2",
          "\"conductor\" \"float roughness\" 0.6838364 \"bool remaproughness\" false" },
        { "\"metal\"",
          "\"conductor\" \"float roughness\" 0.1389244 \"bool remaproughness\" false" },
        { "\"metal\" \"float roughness\" .2 \"bool remaproughness\" false",
          "\"conductor\" \"float roughness\" .2 \"bool remaproughness\" false" },
        { "\"matte\" \"float sigma\" 0", "\"diffuse\"" },
        { "\"matte\" \"float Kd\" .2 \"float sigma\" 25",
          "\"orennayar\" \"float reflectance\" .2 \"float sigma\" 25" },
        { "\"translucent\" \"rgb Kd\" [.8 .4 .2] \"float transmit\" .25",
          "\"diffusetransmission\" \"rgb reflectance\" [.4 .2 .1]"
          "\"rgb transmittance\" [.2 .1 .05]" },
        { "\"diffusetransmission\" \"float reflectance\" .5 \"float scale\" .5",
          "\"diffusetransmission\" \"float transmittance\" .125" },
        { "\"substrate\" \"bool remaproughness\" false",
          "\"ashikhminshirley\" \"float specular\" .5 \"float roughness\" .1 "
          "\"bool remaproughness\" false" },
        { "\"conductor\" \"bool remaproughness\" \"false\"",
          "\"conductor\" \"bool remaproughness\" false" },
        { "\"conductor\" \"rgb roughness\" [.1 .2 .6]", "\"conductor\" \"float roughness\" .3" },
        { "\"diffuse\" \"xyz reflectance\" [9 9 9]", "\"diffuse\" \"float reflectance\" 1" },
        { "\"conductor\" \"spectrum eta\" [300 2 800 2]", "\"conductor\" \"rgb eta\" [2 2 2]" },
    };
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        char text[400];
        const Material *a, *b;
        SceneFile f;
        snprintf(text, sizeof text,
                 "WorldBegin Material %s Shape \"sphere\" Material %s Shape \"sphere\"",
                 pairs[i][0], pairs[i][1]);
        f = scene_of(text, 0);
        REQUIRE(f.scene->nmaterials == 3, "%s", text);
        a = &f.scene->materials[1];
        b = &f.scene->materials[2];
        EXPECT(a->kind == b->kind, "%s", text);
        for (int k = 0; k < a->nvalues; k++)
            EXPECT(v_near(v3(a->value[k].r, a->value[k].g, a->value[k].b),
                          v3(b->value[k].r, b->value[k].g, b->value[k].b), 1e-6f), "%s: %s", text,
                   a->kind->info.options[k].key);
        scenefile_clear(&f);
    }
}

static void substitutes(void)
{
    static const struct { const char *type, *kind; } rows[] = {
        { "hair", "diffuse" },              { "kdsubsurface", "coateddiffuse" },
        { "measured", "diffuse" },          { "fourier", "diffuse" },
        { "subsurface", "coateddiffuse" },  { "nothing like it", "diffuse" },
    };
    messages_nowhere();
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const char *name;
        char text[200];
        SceneFile f;
        snprintf(text, sizeof text, "WorldBegin Material \"%s\" \"rgb x\" [1 1 1] \"float y\" 1 "
                 "Shape \"sphere\"", rows[i].type);
        f = scene_of(text, 1);
        name = f.scene->materials[scene_shape(&f, 0)->material].kind->info.name;
        EXPECT(!strcmp(name, rows[i].kind), "%s became %s", rows[i].type, name);
        scenefile_clear(&f);
    }
}

/* Borders of media are kept where they separate any, or shine; of a mixture the heavier part
 * counts. */
static void interfaces_and_mixtures(void)
{
    const Material *all;
    SceneFile f;

    messages_nowhere();
    f = scene_of("WorldBegin Material \"interface\" Shape \"sphere\" Shape \"trianglemesh\" " QUAD
                 "AreaLightSource \"diffuse\" Shape \"sphere\" Shape \"trianglemesh\" " QUAD, 0);
    EXPECT(f.scene->geometries[0].nshapes == 2 && f.scene->nlights == 2, "only lights are there");
    EXPECT(scene_shape(&f, 1)->material == 0, "they have a material");
    scenefile_clear(&f);
    f = scene_of("MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [1 2 3]\n"
                 "\"rgb sigma_s\" [0 0 0] \"float scale\" 2 MediumInterface \"\" \"m\"\n"
                 "Camera \"perspective\" WorldBegin MediumInterface \"m\" \"\"\n"
                 "Material \"interface\" Shape \"trianglemesh\" " QUAD, 0);
    EXPECT(f.scene->nmedia == 1 && f.scene->media[0].absorption.b == 6, "the medium");
    EXPECT(f.scene->around == 0, "the camera is in it");
    EXPECT(scene_shape(&f, 0)->separates && scene_shape(&f, 0)->inside == 0 &&
           scene_shape(&f, 0)->outside == NO_MEDIUM, "its border");
    EXPECT(f.scene->materials[scene_shape(&f, 0)->material].opacity, "which is not seen");
    scenefile_clear(&f);
    f = scene_of(
        "WorldBegin MakeNamedMaterial \"a\" \"string type\" \"mirror\"\n"
        "MakeNamedMaterial \"b\" \"string type\" \"matte\"\n"
        "MakeNamedMaterial \"c\" \"string type\" \"mix\" \"string materials\" [\"a\" \"b\"] "
        "\"float amount\" .7\n"
        "Material \"mix\" \"string namedmaterial1\" \"a\" \"string namedmaterial2\" \"b\"\n"
        "\"rgb amount\" [.7 .6 .5] Shape \"sphere\"\n"
        "Texture \"t\" \"float\" \"checkerboard\"\n"
        "Material \"mix\" \"string materials\" [\"c\" \"b\"] \"texture amount\" \"t\" "
        "Shape \"sphere\"",
        0);
    all = f.scene->materials;
    EXPECT(all[3].part[0] == 2 && all[3].part[1] == 1 && all[3].value[0].r == 0.7f,
           "version 4: the amount is of the second");
    EXPECT(scene_shape(&f, 0)->material == 4 && all[4].part[0] == 1 && all[4].part[1] == 2 &&
           all[4].value[0].b == 0.5f, "version 3: the amount is of the first");
    EXPECT(all[5].part[1] == 3 && all[5].texture[0] && material_size(all, 5) == 5, "nested");
    scenefile_clear(&f);
}

/* The parts of a mixture come out of the scene as f = a f_1 + (1 - a) f_2, nested too. */
static void mixtures_shine(void)
{
    const Surface s = { .ns = { 0, 0, 1 }, .ng = { 0, 0, 1 } };
    const V3 wo = { 0.6f, 0, 0.8f }, wi = { 0, 0.6f, 0.8f };
    SceneFile f = scene_of(
        "WorldBegin MakeNamedMaterial \"a\" \"string type\" \"diffuse\" \"float reflectance\" .8\n"
        "MakeNamedMaterial \"b\" \"string type\" \"diffuse\" \"float reflectance\" .2\n"
        "MakeNamedMaterial \"c\" \"string type\" \"mix\" \"string materials\" [\"a\" \"b\"] "
        "\"float amount\" .25\n"
        "Material \"mix\" \"string materials\" [\"c\" \"b\"] \"float amount\" .5 "
        "Shape \"sphere\"",
        0);
    const Material *m = &f.scene->materials[4];
    BsdfRoom room;
    const Bsdf *b;

    for (uint32_t k = 0; k < f.scene->nmaterials; k++)
        material_settle(f.scene->materials, k);
    b = material_bsdf(m, &s, &room);
    EXPECT(fabsf(b->kind->eval(b, wo, wi, false).g * PI_F - 0.425f) < 1e-6f, "f is %g",
           b->kind->eval(b, wo, wi, false).g * PI_F);
    EXPECT(b->flags == (BSDF_REFLECT | BSDF_SMOOTH | BSDF_LOBES | BSDF_MATT) && !m->tangent,
           "flags");
    scenefile_clear(&f);
}

/* A height that grows by 0.3 a unit of u and falls by 0.2 a unit of v tilts the normal against it,
 * on whichever side of the surface it stands and whichever way (u, v) turn; too steep a bump, or
 * one where (u, v) are not known, is none. */
static void bumps(void)
{
    static Rgb pixels[16 * 16];
    const Image im = { 16, 16, pixels, NULL };
    Texture t = { .kind = TEXTURE_IMAGE, .image = &im, .value = { 1, 1, 1 },
                  .map = { .su = 1, .sv = 1 } };
    Material m = { .bump = &t };

    for (int y = 0; y < 16; y++)                /* v runs upwards, rows downwards */
        for (int x = 0; x < 16; x++)
            pixels[16 * y + x] = rgb_all(0.3f * (float)x / 16 + 0.2f * (float)y / 16 + 1.0f);
    for (int k = 0; k < 8; k++) {
        float up = k & 1 ? -1.0f : 1.0f, su = k & 2 ? -2.0f : 2.0f, sv = k & 4 ? -0.5f : 0.5f;
        Surface s = { .uv = { 0.4f, 0.6f }, .ns = { 0, 0, up }, .ng = { 0, 0, up },
                      .dpdu = { su, 0, 0 }, .dpdv = { 0, sv, 0 } };
        V3 want = v_unit(v3(-0.3f / su, 0.2f / sv, up)), n = material_frame(&m, &s).n;
        EXPECT(v_len(v_sub(n, want)) < 2e-4f, "normal %d: %g %g %g, not %g %g %g", k, n.x, n.y, n.z,
               want.x, want.y, want.z);
        s.dpdu = s.dpdv = v_all(0);
        EXPECT(v_equal(material_frame(&m, &s).n, s.ns), "a bump without derivatives");
    }
}

/* ---- textures ---- */

static Rgb reflectance_at(const SceneFile *f, size_t material, float u, float v)
{
    const Material *m = &f->scene->materials[material];
    const Surface s = { .uv = { u, v } };
    return m->texture[0] ? texture_eval(m->texture[0], &s) : m->value[0];
}

static void textures(void)
{
    /* red green / blue white */
    static const unsigned char tga[18 + 12] = {
        0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 2, 0, 24, 0x20,
        0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255
    };
    char path[500];
    SceneFile f;
    Rgb c;

    snprintf(path, sizeof path, "%.200s/a.tga", test_folder());
    REQUIRE(file_write(path, tga, sizeof tga), "cannot write");
    f = scene_of(
        "WorldBegin Texture \"c\" \"spectrum\" \"checkerboard\" \"rgb tex1\" [.1 .2 .3]\n"
        "\"float uscale\" 2 \"float tex2\" .9\n"
        "Texture \"s\" \"color\" \"scale\" \"texture tex1\" \"c\" \"float tex2\" .5\n"
        "Texture \"s4\" \"spectrum\" \"scale\" \"texture tex\" \"c\" \"float scale\" .25\n"
        "Texture \"i\" \"spectrum\" \"imagemap\" \"string filename\" \"a.tga\" \"float scale\" .5\n"
        "Texture \"k\" \"spectrum\" \"constant\" \"rgb value\" [.5 .6 .7]\n"
        "Texture \"r\" \"float\" \"constant\" \"float value\" .3\n"
        "Material \"matte\" \"texture Kd\" \"c\" Material \"matte\" \"texture Kd\" \"s\"\n"
        "Material \"matte\" \"texture Kd\" \"s4\"\n"
        "Material \"diffuse\" \"texture reflectance\" \"i\"\n"
        "Material \"diffuse\" \"texture reflectance\" \"k\"\n"
        "Material \"conductor\" \"texture roughness\" \"r\"\n", 0);
    EXPECT(reflectance_at(&f, 1, 0.2f, 0.2f).g == 0.2f &&
               reflectance_at(&f, 1, 0.7f, 0.2f).g == 0.9f,
           "checkerboard");
    EXPECT(reflectance_at(&f, 2, 0.2f, 0.2f).g == 0.1f, "scale, version 3");
    EXPECT(reflectance_at(&f, 3, 0.2f, 0.2f).g == 0.05f, "scale, version 4");
    c = reflectance_at(&f, 4, 0.25f, 0.75f);
    EXPECT(c.r == 0.5f && c.g == 0 && c.b == 0, "top left of the picture is at v = 3/4: %g %g %g",
           c.r, c.g, c.b);
    EXPECT(reflectance_at(&f, 4, 0.25f, 0.25f).b == 0.5f, "bottom left");
    EXPECT(!f.scene->materials[5].textured && f.scene->materials[5].value[0].b == 0.7f, "constant");
    EXPECT(f.scene->materials[6].value[0].r == 0.3f, "a number from a texture");
    EXPECT(f.scene->nimages == 1, "one picture");
    scenefile_clear(&f);
}

/* ---- OBJ ---- */

static void obj_scene(void)
{
    ReadLimits limits = READ_LIMITS_DEFAULT;
    static const char *const kinds[] = { "diffuse", "diffuse", "phong", "mirror", "dielectric",
                                         "dielectric", "diffuse" };
    const char *path;
    SceneFile f;
    const Scene *s;

    scene_write("a.mtl", "newmtl a\nKd .1 .2 .3\nnewmtl b\nKd .6 .6 .6\nKs .6 .6 .6\nNs 20\n"
                "newmtl c\nKs .9 .8 .7\nillum 3\nnewmtl d\nNi 1.3\nd .5\nTf 1 .5 .25\n"
                "newmtl e\nillum 7\nKs .5 .5 .5\nnewmtl f\nKe 1 2 3\n");
    path = scene_write(
        "a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n"
                 "usemtl a\nf 1 2 4\nusemtl b\nf 1 3 4\nusemtl c\nf 2 3 4\nusemtl d\nf 3 2 1\n"
                 "usemtl e\nf 4 2 1\nusemtl f\nf 4 3 1\n");
    err_reset();
    REQUIRE(scenefile_read(&f, path, &limits), "refused");
    s = f.scene;
    REQUIRE(s->geometries[0].nshapes == 7, "%lu shapes", (unsigned long)s->geometries[0].nshapes);
    for (size_t k = 0; k < 7; k++)
        EXPECT(!strcmp(s->materials[scene_shape(&f, k)->material].kind->info.name, kinds[k]),
               "material of group %lu", (unsigned long)k);
    EXPECT(scene_shape(&f, 0)->material == 0 && s->materials[1].value[0].g == 0.2f, "Kd");
    EXPECT(fabsf(s->materials[2].value[0].r - 0.5f) < 1e-6f &&
           fabsf(s->materials[2].value[1].r - 0.5f) < 1e-6f && s->materials[2].value[2].r == 20,
           "Kd + Ks becomes 1");
    EXPECT(s->materials[3].value[0].g == 0.8f, "a mirror's colour");
    EXPECT(s->materials[4].value[0].r == 1.3f && s->materials[4].value[2].b == 0.25f, "glass");
    EXPECT(s->materials[5].value[0].r == 1.5f && s->materials[5].value[1].r == 0.5f, "more glass");
    EXPECT(s->nlights == 1 && scene_shape(&f, 6)->light == 0 && !f.bare && !s->camera, "the lamp");
    EXPECT(v_equal(s->geometries[0].p[s->geometries[0].tri[3].v[2]], v3(0, 0, 1)), "points");
    scenefile_clear(&f);
    /* As a shape: the scene's materials go before those of the file, its transform applies. */
    f = scene_of("WorldBegin MakeNamedMaterial \"c\" \"string type\" \"matte\"\nScale 2 2 2\n"
                 "NamedMaterial \"c\" Shape \"obj\" \"string filename\" \"a.obj\"", 0);
    EXPECT(scene_shape(&f, 3)->material == 1 && scene_shape(&f, 0)->material == 1, "overridden");
    EXPECT(f.scene->geometries[0].p[1].x == 2, "transformed");
    scenefile_clear(&f);
}

static void obj_faults(void)
{
    ReadLimits limits = READ_LIMITS_DEFAULT;
    SceneFile f;

    messages_nowhere();
    err_reset();
    REQUIRE(scenefile_read(&f, scene_write("b.obj", "mtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n"
                           "usemtl x\nf 1 2 3\n"), &limits), "refused");
    EXPECT(warnings_count() == 1 && f.bare && scene_shape(&f, 0)->material == 0, "no MTL file");
    scenefile_clear(&f);
    scene_write("c.mtl", "newmtl x\nKd .5 1 1\nmap_Kd .\\none.tga\nmap_bump b.png\n");
    err_reset();
    REQUIRE(scenefile_read(&f, scene_write("c.obj", "mtllib c.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n"
                           "usemtl x\nf 1 2 3\n"), &limits), "refused");
    EXPECT(warnings_count() == 2 && !f.scene->materials[1].textured, "no picture, no bumps");
    scenefile_clear(&f);
}

static void cornell_obj(void)
{
    ReadLimits limits = READ_LIMITS_DEFAULT;
    SceneFile f;

    messages_nowhere();
    REQUIRE(scenefile_read(&f, test_data("obj/CornellBox-Original.obj"), &limits), "refused");
    EXPECT(f.scene->geometries[0].nshapes == 8 && f.scene->geometries[0].ntris == 36 &&
           f.scene->nlights == 1 && f.scene->nmaterials == 9, "counts");
    scenefile_clear(&f);
    REQUIRE(scenefile_read(&f, test_data("meshes/bun_zipper_res4.ply"), &limits), "refused");
    EXPECT(f.bare && f.scene->geometries[0].ntris == 948, "a bare mesh");
    scenefile_clear(&f);
}

const TestCase test_scenefile_things[] = {
    { "blackbodies", blackbodies, false },
    { "blackbody_parameters", blackbody_parameters, false },
    { "named_spectra", named_spectra, false },
    { "colour_spaces", colour_spaces, false },
    { "spd_file", spd_file, false },
    { "spellings", spellings, false },
    { "substitutes", substitutes, false },
    { "interfaces_and_mixtures", interfaces_and_mixtures, false },
    { "mixtures_shine", mixtures_shine, false },
    { "bumps", bumps, false },
    { "textures", textures, false },
    { "obj_scene", obj_scene, false },
    { "obj_faults", obj_faults, false },
    { "cornell_obj", cornell_obj, false },
    { NULL, NULL, false }
};

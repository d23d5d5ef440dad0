/* test_mtl.c -- MTL files as exporters write them: every map is where it should be and multiplies
 * what it is a map of, numbers are read as stored and colours are not, pictures of normals are told
 * from heights. */
#include "image/image.h"
#include "test/mesh_help.h"
#include "test/scene_help.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* One triangle a material, (u, v) with v along -y, in the order of `names`. */
static SceneFile obj_of(const char *mtl, const char *const *names, unsigned warnings)
{
    ReadLimits limits = READ_LIMITS_DEFAULT;
    char obj[2000];
    size_t n = (size_t)sprintf(obj, "mtllib m.mtl\nv -2 -2 0\nv 2 -2 0\nv -2 2 0\nvt 0 1\nvt 1 1\n"
                                    "vt 0 0\n");
    SceneFile f;

    for (; *names; names++)
        n += (size_t)sprintf(obj + n, "usemtl %s\nf 1/1 2/2 3/3\n", *names);
    scene_write("m.mtl", mtl);
    err_reset();
    REQUIRE(scenefile_read(&f, scene_write("m.obj", obj), &limits), "refused");
    EXPECT(warnings_count() == warnings, "%u warnings", warnings_count());
    return f;
}

static const Material *material(const SceneFile *f, size_t k)
{
    return &f->scene->materials[scene_shape(f, k)->material];
}

/* What option `key` is at (u, v). */
static Rgb value(const Material *m, const char *key, float u, float v)
{
    Surface s = surface_at(v_all(0.0f), v_all(0.0f), v3(0, 0, 1), (V2){ u, v });
    const OptDef *d = m->kind->info.options;
    int k = 0;

    while (d[k].key && strcmp(d[k].key, key))
        k++;
    REQUIRE(d[k].key, "no option %s", key);
    return m->texture[k] ? texture_eval(m->texture[k], &s) : m->value[k];
}

static bool is(Rgb c, double r, double g, double b)
{
    return fabs(c.r - r) < 1e-4 * (1 + r) && fabs(c.g - g) < 1e-4 * (1 + g) &&
           fabs(c.b - b) < 1e-4 * (1 + b);
}

/* Two pixels side by side, 51 and 204 of 255: places 0.25 and 0.75 of u are their middles. */
static const char grey[] = "P3 2 1 255 51 51 51 204 204 204\n";
#define SRGB_51 0.0331048       /* ((0.2 + 0.055) / 1.055)^2.4 */
#define SRGB_204 0.6038273

static void maps(void)
{
    static const char *const names[] = { "shiny", "cut", "lamp", "lit", NULL };
    SceneFile f;

    scene_write("g.ppm", grey);
    f = obj_of("newmtl shiny\nKd .2 .2 .4\nKs .5 .4 .3\nNs 100\nillum 2\nmap_Kd g.ppm\n"
               "map_Ks g.ppm\nmap_Ns g.ppm\nnewmtl cut\nKd .5 .5 .5\nd .5\nmap_d g.ppm\n"
               "newmtl lamp\nKe 4 2 1\nmap_Ke g.ppm\nnewmtl lit\nmap_Ke g.ppm\n", names, 0);
    EXPECT(is(value(material(&f, 0), "reflectance", .25f, 0), .2 * SRGB_51, .2 * SRGB_51,
              .4 * SRGB_51), "map_Kd");
    EXPECT(is(value(material(&f, 0), "specular", .75f, 0), .5 * SRGB_204, .4 * SRGB_204,
              .3 * SRGB_204), "map_Ks");
    EXPECT(is(value(material(&f, 0), "exponent", .25f, 0), 20, 20, 20) &&
           is(value(material(&f, 0), "exponent", .75f, 0), 80, 80, 80), "map_Ns");
    {
        Surface s = surface_at(v_all(0.0f), v_all(0.0f), v3(0, 0, 1), (V2){ .25f, 0 });
        REQUIRE(material(&f, 1)->opacity, "no mask");
        EXPECT(fabsf(texture_alpha(material(&f, 1)->opacity, &s) - 0.1f) < 1e-6f, "map_d");
        REQUIRE(f.scene->nlights == 2, "%lu lamps", (unsigned long)f.scene->nlights);
        EXPECT(is(f.scene->lights[0]->kind->radiance(f.scene->lights[0], v3(0, 0, 1), &s),
                  4 * SRGB_51, 2 * SRGB_51, SRGB_51), "map_Ke");
        EXPECT(is(f.scene->lights[1]->kind->radiance(f.scene->lights[1], v3(0, 0, 1), &s),
                  SRGB_51, SRGB_51, SRGB_51), "map_Ke alone");
    }
    scenefile_clear(&f);
}

/* Pr and its kin; of glass, alpha is Pr^2. */
static void principled(void)
{
    static const char *const names[] = { "metal", "both", "glass", NULL };
    SceneFile f;
    const Material *m;

    scene_write("g.ppm", grey);
    f = obj_of("newmtl metal\nKd .9 .5 .1\nPm 1\nPr .5\nmap_Pr g.ppm\nnewmtl both\nKd .9 .5 .1\n"
               "map_Pm g.ppm\nPr .4\nNi 1.3\nnewmtl glass\nillum 7\nNi 1.5\nPr .6\n", names, 0);
    m = material(&f, 0);
    EXPECT(!strcmp(m->kind->info.name, "conductor") &&
           is(value(m, "reflectance", 0, 0), .9, .5, .1) &&
           is(value(m, "uroughness", .75f, 0), .16, .16, .16), "metal of alpha (.5 .8)^2: %g",
           (double)value(m, "uroughness", .75f, 0).r);
    m = material(&f, 1);
    EXPECT(m->kind == &bsdf_mix && is(value(m, "amount", .25f, 0), .2, .2, .2), "a map of metal");
    m = &f.scene->materials[m->part[1]];
    EXPECT(!strcmp(m->kind->info.name, "coateddiffuse") && is(value(m, "eta", 0, 0), 1.3, 1.3, 1.3)
           && is(value(m, "vroughness", 0, 0), .16, .16, .16), "and of what is none");
    m = material(&f, 2);
    EXPECT(fabs(sqrt((double)value(m, "roughness", 0, 0).r) - .36) < 1e-6, "rough glass");
    scenefile_clear(&f);
}

/* Normals by name and by what the picture shows. v and the second tangent run along -y. */
static void relief(void)
{
    static const char *const names[] = { "by_name", "by_look", "heights", "grey", NULL };
    float x = 2 * 150 / 255.0f - 1, y = 2 * 90 / 255.0f - 1, z = 2 * 248 / 255.0f - 1;
    SceneFile f;
    Surface s;
    V3 n, want = v_unit(v3(x, -y, z)), twice = v_unit(v3(2 * x, -2 * y, z));

    scene_write("n.ppm", "P3 1 1 255 150 90 248\n");
    scene_write("h.ppm", "P3 1 1 255 120 120 125\n");
    scene_write("w.ppm", "P3 1 1 255 202 202 202\n");           /* a unit vector, but grey */
    f = obj_of("newmtl by_name\nnorm n.ppm\nnewmtl by_look\nmap_Bump -bm 2 n.ppm\n"
               "newmtl heights\nmap_Bump -bm 2 h.ppm\nnewmtl grey\nbump w.ppm\n", names, 0);
    s = surface_at(v_all(0.0f), v_all(0.0f), v3(0, 0, 1), (V2){ 0, 0 });
    s.ns = s.ng;
    s.dpdu = v3(4, 0, 0);
    s.dpdv = v3(0, -4, 0);
    n = material_frame(material(&f, 0), &s).n;
    EXPECT(v_near(n, want, 1e-5f), "norm: %g %g %g", (double)n.x, (double)n.y, (double)n.z);
    n = material_frame(material(&f, 1), &s).n;
    EXPECT(v_near(n, twice, 1e-5f), "map_Bump: %g %g %g", (double)n.x, (double)n.y, (double)n.z);
    for (size_t k = 2; k < 4; k++)
        EXPECT(material(&f, k)->bump && !material(&f, k)->normals, "heights taken for normals");
    scenefile_clear(&f);
}

static void faults(void)
{
    static const char *const names[] = { "x", "y", NULL };
    SceneFile f;

    messages_nowhere();
    f = obj_of("newmtl x\nKs .5 .5 .5\nmap_Ks no.png\nmap_Ns no.png\nmap_Ke no.png\nnorm a.jpg\n"
               "newmtl y\nmap_Pr no.png\nmap_Pm no.jpg\nmap_d no.png\n", names, 7);
    EXPECT(f.scene->nlights == 0 && !material(&f, 0)->normals && !material(&f, 1)->opacity, "none");
    scenefile_clear(&f);
}

const TestCase test_mtl[] = {
    { "maps", maps, false },
    { "principled", principled, false },
    { "relief", relief, false },
    { "faults", faults, false },
    { NULL, NULL, false }
};

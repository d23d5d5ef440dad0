/* cmd_info.c -- the command `info`: what a scene, a mesh or an image holds. */
#include "base/number.h"
#include "base/text.h"
#include "cli/args.h"
#include "render/render.h"

#include <stdio.h>
#include <string.h>

static const ArgDef args[] = { { NULL, NULL, NULL } };
static int run(int argc, char **argv);

const Command command_info = {
    "info", "FILE", "what a scene (.pbrt, .obj, .ply) or an image holds", args, run
};

static bool set(void *ctx, int k, const char *value)
{
    (void)k;
    if (*(const char **)ctx)
        return err_usage("info takes one file");
    *(const char **)ctx = value;
    return true;
}

static void print_number(double v)
{
    char text[NUMBER_MAX];
    number_print_float(text, (float)v);
    printf(" %s", text);
}

static void print_box(Box b)
{
    printf("bounds        ");
    if (box_is_empty(b)) {
        printf(" none\n");
        return;
    }
    print_number(b.lo.x);
    print_number(b.lo.y);
    print_number(b.lo.z);
    printf("  to ");
    print_number(b.hi.x);
    print_number(b.hi.y);
    print_number(b.hi.z);
    printf("\n");
}

static int info_image(const char *path)
{
    Image im = { 0 };
    Rgb least = rgb_all(INFINITY), most = rgb_all(-INFINITY);
    double sum[3] = { 0, 0, 0 };
    unsigned long bad = 0;
    size_t n;

    if (!image_read(&im, path, IMAGE_PIXELS_DEFAULT))
        return failed_status();
    n = (size_t)im.w * im.h;
    for (size_t i = 0; i < n; i++) {
        Rgb c = im.pixels[i];
        if (!rgb_finite(c)) {
            bad++;
            continue;
        }
        least = rgb(f_min(least.r, c.r), f_min(least.g, c.g), f_min(least.b, c.b));
        most = rgb(f_max(most.r, c.r), f_max(most.g, c.g), f_max(most.b, c.b));
        sum[0] += c.r;
        sum[1] += c.g;
        sum[2] += c.b;
    }
    printf("image          %lux%lu\n", (unsigned long)im.w, (unsigned long)im.h);
    printf("mean          ");
    for (int k = 0; k < 3; k++)
        print_number(n > bad ? sum[k] / (double)(n - bad) : 0);
    if (n > bad) {
        printf("\nleast         ");
        print_number(least.r);
        print_number(least.g);
        print_number(least.b);
        printf("\nmost          ");
        print_number(most.r);
        print_number(most.g);
        print_number(most.b);
    }
    printf("\nnot finite     %lu pixels\n", bad);
    image_clear(&im);
    return STATUS_OK;
}

static void print_geometry(const Scene *s)
{
    enum { KINDS = SHAPE_INSTANCE + 1 };
    static const char *const names[KINDS] = { "meshes", "spheres", "disks", "tessellations",
                                              "instances" };
    unsigned long count[KINDS] = { 0 };

    for (size_t g = 0; g < s->ngeometries; g++) {
        const Geometry *geo = &s->geometries[g];
        size_t points = geo->nverts;
        for (size_t i = 0; i < geo->nshapes; i++)
            count[geo->shapes[i].kind]++;
        for (size_t i = 0; i < geo->ntessellated; i++)
            points += tessellation_points(geo->shapes[geo->tessellated[i]].as.tessellation);
        if (g == 0)
            printf("world          ");
        else
            printf("object %-7lu ", (unsigned long)g);
        printf("%lu triangles, %lu vertices\n", (unsigned long)(geo->ntris + geo->nfaces),
               (unsigned long)points);
    }
    printf("shapes        ");
    for (int k = 0; k < KINDS; k++)
        printf(" %lu %s%s", count[k], names[k], k + 1 < KINDS ? "," : "\n");
}

static void print_scene(const Scene *s)
{
    print_geometry(s);
    print_box(s->bounds);
    printf("materials      %lu:", (unsigned long)s->nmaterials);
    for (size_t i = 0; i < s->nmaterials && i < 40; i++)
        printf(" %s%s%s", s->materials[i].name, s->materials[i].name[0] ? "=" : "",
               s->materials[i].kind->info.name);
    printf("\nlights         %lu", (unsigned long)s->nlights);
    for (size_t i = 0; i < s->nlights && i < 20; i++) {
        printf("%s %s (", i ? "," : ":", s->lights[i]->kind->info.name);
        print_number(rgb_lum(s->lights[i]->kind->power(s->lights[i])));
        printf(" W )");
    }
    printf("\ncamera         %s\n", s->camera ? s->camera->kind->info.name : "none");
    printf("memory         %lu bytes, of which the structure for rays %lu (depth %d)\n",
           (unsigned long)mem_bytes(), (unsigned long)s->accel->bytes, s->accel->depth);
}

static int info_scene(const char *path)
{
    const AccelKind *kind = kind_find(accels, ACCEL_DEFAULT);
    ReadLimits limits = READ_LIMITS_DEFAULT;
    SceneFile f;
    Opts o;
    bool ok;

    if (!scenefile_read(&f, path, &limits))
        return failed_status();
    opts_default(&o, kind->info.options);
    ok = scene_build(f.scene, kind, &o, 1);
    if (ok)
        print_scene(f.scene);
    scenefile_clear(&f);
    return ok ? STATUS_OK : failed_status();
}

/* As scenefile_read picks its readers. */
static bool is_scene(const char *path)
{
    const char *ext = path_extension(path);
    Word w = { ext, strlen(ext) };
    return word_is_nocase(w, "pbrt") || word_is_nocase(w, "obj") || word_is_nocase(w, "ply");
}

static int run(int argc, char **argv)
{
    const char *path = NULL;

    if (!args_parse(&command_info, argc, argv, set, &path))
        return failed_status();
    if (!path) {
        err_usage("info takes a file");
        return STATUS_USAGE;
    }
    return is_scene(path) ? info_scene(path) : info_image(path);
}

/* cmd_info.c -- the command `info`: what a scene, a mesh or an image holds. */
#include "base/number.h"
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
        return err_usage("info takes one file, got '%s' and '%s'", *(const char **)ctx, value);
    *(const char **)ctx = value;
    return true;
}

static void print_number(double v)
{
    char text[NUMBER_MAX];
    number_print_float(text, (float)v);
    printf(" %s", text);
}

static void print_three(double a, double b, double c)
{
    print_number(a);
    print_number(b);
    print_number(c);
}

static void print_box(Box b)
{
    printf("bounds        ");
    if (box_is_empty(b)) {
        printf(" none\n");
        return;
    }
    print_three(b.lo.x, b.lo.y, b.lo.z);
    printf("  to ");
    print_three(b.hi.x, b.hi.y, b.hi.z);
    printf("\n");
}

typedef struct {
    Rgb    least, most;
    double mean[3];             /* of the finite ones */
    unsigned long bad;          /* pixels that are not */
} Extent;

static Extent extent_of(const Image *im)
{
    Extent e = { rgb_all(INFINITY), rgb_all(-INFINITY), { 0, 0, 0 }, 0 };
    size_t n = (size_t)im->w * im->h;

    for (size_t i = 0; i < n; i++) {
        Rgb c = im->pixels[i];
        if (!rgb_finite(c)) {
            e.bad++;
            continue;
        }
        e.least = rgb(f_min(e.least.r, c.r), f_min(e.least.g, c.g), f_min(e.least.b, c.b));
        e.most = rgb(f_max(e.most.r, c.r), f_max(e.most.g, c.g), f_max(e.most.b, c.b));
        e.mean[0] += c.r;
        e.mean[1] += c.g;
        e.mean[2] += c.b;
    }
    for (int k = 0; k < 3; k++)
        e.mean[k] = n > e.bad ? e.mean[k] / (double)(n - e.bad) : 0;
    return e;
}

static int info_image(const char *path)
{
    Image im = { 0 };
    Extent e;

    if (!image_read(&im, path, IMAGE_PIXELS_DEFAULT))
        return failed_status();
    e = extent_of(&im);
    printf("image          %lux%lu\n", (unsigned long)im.w, (unsigned long)im.h);
    printf("mean          ");
    print_three(e.mean[0], e.mean[1], e.mean[2]);
    if ((size_t)im.w * im.h > e.bad) {
        printf("\nleast         ");
        print_three(e.least.r, e.least.g, e.least.b);
        printf("\nmost          ");
        print_three(e.most.r, e.most.g, e.most.b);
    }
    printf("\nnot finite     %lu pixels\n", e.bad);
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

static int run(int argc, char **argv)
{
    const char *path = NULL;

    if (!args_parse(&command_info, argc, argv, set, &path))
        return failed_status();
    if (!path) {
        err_usage("info takes a file");
        return STATUS_USAGE;
    }
    return scenefile_is_scene(path) ? info_scene(path) : info_image(path);
}

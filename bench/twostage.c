/* twostage.c -- two stage importance sampling against its publication, [Cline07 5].
 *
 * 5.8        how sigma/mu falls with samples, on unshadowed spheres of three models, by two stages
 *            and by multiple importance sampling: slopes of lines through the logarithms. Each
 *            pixel has one eye ray, through its middle: only these samples make noise.
 * 5.1        a matt and a glossy floor, with shadows: sigma/mu, and at equal time.
 * cost       a partition and 32 points warped by it, against the 32 shadow rays that they serve, at
 *            what the eye sees of a scene of 120,000 triangles under a probe.
 * 5.9        with as many camera samples for all pixels, and where noise is; adaptive.c does it.
 * screen     what the document says of "large light sources" only: a floor under a lamp with a
 *            picture, and by colour.
 * Galileo's Tomb is not at hand: ours is scenes/probe.hdr. */
#include "base/file.h"
#include "bench/bench.h"
#include "image/compare.h"
#include "integrators/twostage.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* ---- what partitions cost ---- */

enum { COST_SIDE = 192, CHUNK = 64, POINTS = 32 };

typedef struct {
    Vertex v[CHUNK];
    V3     d[CHUNK];
    Ray    ray[CHUNK * POINTS];
    Partition part;
    int    n, rays;
    uint64_t hits, shadow, leaves, blocked;
    double make, warp, cast;
} Cost;

/* What the chunk's vertices take, in three rounds so that the clock is read seldom. */
static void chunk(Cost *c, const TwoStage *two, Tracer *t)
{
    double start = clock_cpu(), made;
    PartitionSample s[POINTS];
    V2 point[POINTS];

    c->rays = 0;
    for (int i = 0; i < c->n; i++) {
        Turn u = turn_on(&c->v[i], c->d[i], NO_MEDIUM, 0);
        c->leaves += twostage_partition(two, &u, POINTS, t, &c->part) ? (c->part.n + 1u) / 2 : 0;
    }
    made = clock_cpu();
    c->make += made - start;
    for (int i = 0; i < c->n; i++) {
        Turn u = turn_on(&c->v[i], c->d[i], NO_MEDIUM, 0);
        if (!twostage_partition(two, &u, POINTS, t, &c->part))
            continue;
        for (uint32_t k = 0; k < POINTS; k++)
            point[k] = (V2){ (float)k / POINTS, (float)(k * 5 % POINTS) / POINTS };
        partition_warp_many(&c->part, point, s, POINTS);
        for (uint32_t k = 0; k < POINTS; k++)
            c->ray[c->rays++] = turn_ray(&u, s[k].wi);
    }
    c->warp += clock_cpu() - made - (made - start);
    start = clock_cpu();
    for (int i = 0; i < c->rays; i++)
        c->blocked += scene_blocked(t->scene, &c->ray[i]);
    c->cast += clock_cpu() - start;
    c->hits += (uint64_t)c->n;
    c->shadow += (uint64_t)c->rays;
    c->n = 0;
}

static void cost_of(const char *name, Cost *c, SceneFile *f)
{
    const IntegratorKind *direct = kind_find(integrators, "direct");
    TwoStage two;
    Opts o;
    Tracer t;

    memset(&t, 0, sizeof t);
    t.scene = f->scene;
    opts_default(&o, direct->info.options);
    if (!twostage_init(&two, f->scene, &o, false))
        return;
    f->scene->camera->kind->film(f->scene->camera, COST_SIDE, COST_SIDE);
    for (int i = 0; i < COST_SIDE * COST_SIDE; i++) {
        V2 pixel = { (float)(i % COST_SIDE), (float)(i / COST_SIDE) }, lens = { 0.5f, 0.5f };
        Ray r = f->scene->camera->kind->ray(f->scene->camera, pixel, lens, 0);
        if (!vertex_meet(&c->v[c->n], &r, &t))
            continue;
        vertex_make(&c->v[c->n], f->scene, r.d);
        c->d[c->n++] = r.d;
        if (c->n == CHUNK)
            chunk(c, &two, &t);
    }
    printf("cost\t%s\thits %lu\tleaves %.1f\tmake us %.2f\twarp us %.2f\tshadow rays us %.2f\t"
           "blocked %.2f\tpartition and points over rays %.2f\n", name, (unsigned long)c->hits,
           (double)c->leaves / (double)c->hits, 1e6 * c->make / (double)c->hits,
           1e6 * c->warp / (double)c->hits, 1e6 * c->cast / (double)c->hits,
           (double)c->blocked / (double)c->shadow, (c->make + c->warp) / c->cast);
    twostage_clear(&two);
}

static void cost(const char *scene)
{
    ReadLimits limits = READ_LIMITS_DEFAULT;
    RenderSettings s;
    RenderRequest q;
    SceneFile f;
    Cost *c = MEM_NEW(Cost);

    memset(&q, 0, sizeof q);
    q.spp = 1;
    q.threads = 1;
    q.max_pixels = limits.max_pixels;
    if (c && scenefile_read(&f, scene, &limits)) {
        if (settings_resolve(&s, &q, &f) && scene_build(f.scene, s.accel, &s.accel_opts, 1))
            cost_of(scene, c, &f);
        scenefile_clear(&f);
    }
    mem_free(c);
}

/* ---- figure 5.8 ---- */

static const char ball[] =
    "LookAt 0 -4 2  0 0 0  0 0 1\nCamera \"perspective\" \"float fov\" 29\n"
    "PixelFilter \"box\" \"float xradius\" 0.0001 \"float yradius\" 0.0001\n"
    "WorldBegin\nLightSource \"infinite\" \"string filename\" \"%s/scenes/probe.hdr\"\n"
    "Material %s\nShape \"sphere\"\n";

static const struct { const char *name, *material, *printed; } figure_5_8[] = {
    { "blinn", "\"blinn\" \"rgb reflectance\" [ 0 0 0 ] \"rgb specular\" [ 1 1 1 ] "
      "\"float exponent\" 50", "two stage 1.17, MIS 0.64 (roughness 0.02)" },
    { "ashikhmin", "\"ashikhminshirley\" \"rgb reflectance\" [ 0 0 0 ] "
      "\"rgb specular\" [ 1 1 1 ] \"float nu\" 1000 \"float nv\" 1",
      "two stage 0.93, MIS 0.70" },
    { "lafortune", "\"lafortune\" \"rgb reflectance\" [ 0.31 0.18 0.12 ] \"float lobes\" "
      "[ -1.08 -1.08 0.72 14 .12 .12 .12  -0.6 -0.6 0.9 4 .1 .07 .05 ]",
      "two stage 0.98, MIS 0.77" },
};

static bool error_of(const char *scene, const char *integrator, uint32_t side, uint32_t spp,
                     uint64_t seed, const Image *ref, double *error, double *seconds)
{
    RenderReport report;
    ImageDifference d;
    Image im = { 0 };
    bool ok = bench_render(scene, integrator, NULL, side, spp, 1, seed, &im, &report) &&
              image_compare(&im, integrator, ref, scene, &d);

    *error = ok ? d.sigma_over_mu : 0;
    *seconds = report.cpu_seconds;
    image_clear(&im);
    return ok;
}

/* `way` wants the number of samples, or half of it, twice. */
static void slope_of(const char *scene, const char *name, const char *way, int ways,
                     const Image *ref, const char *printed)
{
    enum { FIRST = 3, STEPS = 6 };              /* 8 .. 256 samples */
    double x[STEPS], y[STEPS], sx = 0, sy = 0, sxx = 0, sxy = 0, seconds;
    char text[120];

    printf("fig5.8\t%s\t%-40s\t", name, way);
    for (int i = 0; i < STEPS; i++) {
        int n = 1 << (FIRST + i);
        snprintf(text, sizeof text, way, n / ways, n / ways);
        if (!error_of(scene, text, 64, 1, 5, ref, &y[i], &seconds))
            return;
        printf("%.4f ", y[i]);
        x[i] = log2((double)n);
        y[i] = log2(y[i]);
        sx += x[i] / STEPS;
        sy += y[i] / STEPS;
    }
    for (int i = 0; i < STEPS; i++) {
        sxx += (x[i] - sx) * (x[i] - sx);
        sxy += (x[i] - sx) * (y[i] - sy);
    }
    printf("\tslope %.2f\t%s\n", sxy / sxx, printed);
    fflush(stdout);
}

static void slopes(void)
{
    static const struct { const char *text; int ways; const char *note; } way[] = {
        { "direct:strategy=twostage,samples=%d,splits=%d", 1, "" },
        { "direct:strategy=twostage,samples=%d", 1, "splits by default: fewer from 32 samples on" },
        { "direct:strategy=twostage,peaks=sampled,samples=%d,splits=%d", 1,
          "printed: sampled peaks equal, better from more samples on, worse" },
        { "direct:lightsamples=%d,bsdfsamples=%d", 2, "" },
    };
    char scene[64], here[512], text[2048];

    snprintf(scene, sizeof scene, "/tmp/rushlight-bench-%ld.pbrt", (long)getpid());
    if (!getcwd(here, sizeof here))
        return;
    for (int k = 0; k < 3; k++) {
        RenderReport report;
        Image ref = { 0 };
        int n = snprintf(text, sizeof text, ball, here, figure_5_8[k].material);
        if (!file_write(scene, text, (size_t)n) ||
            !bench_render(scene, "direct:strategy=twostage,samples=4096,splits=480", NULL, 64, 4,
                          processors(), 99, &ref, &report))
            return;
        for (size_t i = 0; i < sizeof way / sizeof *way; i++)
            slope_of(scene, figure_5_8[k].name, way[i].text, way[i].ways, &ref,
                     i ? way[i].note : figure_5_8[k].printed);
        image_clear(&ref);
    }
    unlink(scene);
}

/* ---- table 5.1 ---- */

static void table_5_1(const char *scene, const char *printed)
{
    static const char *const m[] = {
        "direct:strategy=brdf,bsdfsamples=64", "direct:strategy=light,lightsamples=64",
        "direct:strategy=mis,lightsamples=32,bsdfsamples=32",
        "direct:strategy=ris,tentative=64,samples=32", "direct:strategy=twostage,samples=32",
        "direct:strategy=twostage,samples=32,peaks=sampled",
        "path:maxdepth=1", "path:strategy=twostage,maxdepth=1"
    };
    RenderReport report;
    Image ref = { 0 };

    if (!bench_render(scene, "direct:strategy=twostage,samples=64", NULL, 160, 64, processors(), 99,
                      &ref, &report))
        return;
    for (size_t i = 0; i < sizeof m / sizeof *m; i++) {
        double error = 0, least = 1e30, e = 0, seconds = 0;
        for (uint64_t k = 0; k < 3; k++) {
            if (!error_of(scene, m[i], 160, i < 6 ? 1 : 32, k + 1, &ref, &e, &seconds))
                return;
            error += e * e / 3;
            least = d_min(least, seconds);
        }
        printf("table5.1\t%s\t%-50s\tsigma/mu %.4f\tCPU s %.3f\tat one second %.4f\t%s\n", scene,
               m[i], sqrt(error), least, sqrt(error * least), i ? "" : printed);
        fflush(stdout);
    }
    image_clear(&ref);
}

/* ---- a lamp with a picture ---- */

static const char screen[] =
    "LookAt 0 -4 2  0 0.4 0.2  0 0 1\nCamera \"perspective\" \"float fov\" 40\n"
    "PixelFilter \"box\" \"float xradius\" 0.0001 \"float yradius\" 0.0001\n"
    "WorldBegin\nMaterial \"blinn\" \"rgb reflectance\" [ 0.3 0.06 0.03 ] "
    "\"rgb specular\" [ 0.5 0.5 0.5 ] \"float exponent\" 80\n"
    "Shape \"trianglemesh\" \"point3 P\" [ -4 -4 0 4 -4 0 4 4 0 -4 4 0 ] "
    "\"integer indices\" [ 0 1 2 0 2 3 ]\n"
    "AttributeBegin\nTranslate 0 0.5 0.5\nShape \"sphere\" \"float radius\" 0.5\n"
    "AttributeEnd\nAreaLightSource \"diffuse\" \"rgb L\" [ 4 4 4 ] "
    "\"string filename\" \"%s/scenes/slide.ppm\"\n"
    "Material \"diffuse\" \"rgb reflectance\" [ 0 0 0 ]\n"
    "Shape \"trianglemesh\" \"point3 P\" [ -1.5 2.5 1 1.5 2.5 1 1.5 2 3 -1.5 2 3 ] "
    "\"integer indices\" [ 0 1 2 0 2 3 ] \"point2 uv\" [ 0 0 1 0 1 1 0 1 ]\n";

static void of_screen(const char *scene)
{
    static const char *const m[] = {
        "direct:strategy=light,lightsamples=32",
        "direct:strategy=mis,lightsamples=16,bsdfsamples=16",
        "direct:strategy=ris,tentative=64,samples=32", "direct:strategy=twostage,samples=32",
        "direct:strategy=twostage,samples=32,f=colour"
    };
    RenderReport report;
    Image ref = { 0 };

    if (!bench_render(scene, "direct:strategy=twostage,samples=4096", NULL, 96, 1, processors(), 99,
                      &ref, &report))
        return;
    for (size_t i = 0; i < sizeof m / sizeof *m; i++) {
        double error, seconds;
        if (!error_of(scene, m[i], 96, 1, 5, &ref, &error, &seconds))
            return;
        printf("screen\t%-50s\tsigma/mu %.4f\tCPU s %.3f\tat one second %.4f\n", m[i], error,
               seconds, error * sqrt(seconds));
        fflush(stdout);
    }
    image_clear(&ref);
}

static void screens(void)
{
    char scene[64], here[512], text[2048];
    int n;

    snprintf(scene, sizeof scene, "/tmp/rushlight-screen-%ld.pbrt", (long)getpid());
    if (!getcwd(here, sizeof here))
        return;
    n = snprintf(text, sizeof text, screen, here);
    if (file_write(scene, text, (size_t)n))
        of_screen(scene);
    unlink(scene);
}

void bench_twostage(void)
{
    slopes();
    table_5_1("scenes/floor-diffuse.pbrt", "printed: BRDF 0.300, light 0.038, two stage 0.030");
    table_5_1("scenes/floor-glossy.pbrt", "printed: BRDF 0.243, light 0.206, two stage 0.041");
    bench_variable("scenes/swarm-probe.pbrt", "direct:strategy=twostage,samples=2");
    screens();
}

void bench_twostage_cost(void)
{
    cost("scenes/statue.pbrt");
    cost("scenes/hare.pbrt");
    cost("scenes/floor-glossy.pbrt");
}

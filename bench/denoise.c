/* denoise.c -- noise filters: how far pictures of 16 samples a pixel are from the truth before and
 * after, and how they look.
 *
 * The error is sigma/mu without the noise of the reference: of two independent ones r and q the
 * mean of (a - r)(a - q) has the expectation of (a - truth)^2. It holds the bias of the filter. */
#include "bench/bench.h"
#include "bench/report.h"

#include "cli/args.h"
#include "cli/denoising.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { SIDE = 128, SPP = 16, REFERENCE_SPP = 256, METHODS = 5 };

static const char *const scenes[] = { "s3", "colonnade", "bathroom", "living-room", "fruits",
                                      "nine-lights" };
static const char *const methods[METHODS] = { "nothing", "gaussian", "bilateral", "guided",
                                              "nlmeans" };
enum { SCENES = sizeof scenes / sizeof *scenes };
static const char file[] = "denoise.exr";

/* Renders into `file`, with all that filters want. */
static bool make(const char *scene, int spp, int seed)
{
    char path[100], size[40], n[20], s[20], layer[LAYERS][60];
    char *argv[20 + 2 * LAYERS] = { "rushlight", "render", path, "--quiet", "--size", size, "--spp",
                                    n, "--seed", s, "-o", (char *)file };
    int argc = 12;

    snprintf(path, sizeof path, "scenes/%s.pbrt", scene);
    snprintf(size, sizeof size, "%dx%d", SIDE, SIDE);
    snprintf(n, sizeof n, "%d", spp);
    snprintf(s, sizeof s, "%d", seed);
    for (int k = PART_EMISSION; k <= GUIDE_VARIANCE; k++) {
        snprintf(layer[k], sizeof layer[k], "%s=%s", denoising_layer(k), file);
        argv[argc++] = "--aov";
        argv[argc++] = layer[k];
    }
    return cli_run(argc, argv) == STATUS_OK;
}

static bool load(Image im[LAYERS])
{
    memset(im, 0, LAYERS * sizeof *im);
    for (int k = 0; k <= GUIDE_VARIANCE; k++)
        if (!image_read_layer(&im[k], file, IMAGE_PIXELS_DEFAULT, denoising_layer(k)))
            return false;
    return true;
}

static void unload(Image im[LAYERS])
{
    for (int k = 0; k < LAYERS; k++)
        image_clear(&im[k]);
}

/* The picture of 16 samples, filtered. */
static bool filtered(const char *method, Image *out, double *seconds)
{
    Denoising d = { .threads = 1 };
    Arena arena = { 0 };
    Image im[LAYERS];
    bool ok = load(im);

    if (ok && strcmp(method, "nothing"))
        ok = denoising_set(&d, method, &arena);
    *seconds = clock_cpu();
    ok = ok && denoising_run(&d, im);
    *seconds = clock_cpu() - *seconds;
    *out = im[0];
    im[0] = (Image){ 0 };
    unload(im);
    arena_clear(&arena);
    return ok;
}

static double paired_sigma(const Image *a, const Image *r, const Image *q)
{
    double sum = 0, mu = 0, n = (double)a->w * a->h;

    for (size_t i = 0; i < (size_t)n; i++) {
        Rgb d = rgb_sub(a->pixels[i], r->pixels[i]), e = rgb_sub(a->pixels[i], q->pixels[i]);
        sum += rgb_lum(rgb_mul(d, e));
        mu += 0.5 * (rgb_lum(r->pixels[i]) + rgb_lum(q->pixels[i]));
    }
    return sqrt(d_max(sum, 0) / n) / (mu / n);
}

static bool reference(const char *scene, int seed, Image *im)
{
    return make(scene, REFERENCE_SPP, seed) &&
           image_read_layer(im, file, IMAGE_PIXELS_DEFAULT, "");
}

/* One line of the table, one row of the sheet. */
static bool bench_scene(int row, Image *sheet)
{
    const char *scene = scenes[row];
    Image r = { 0 }, q = { 0 }, a;
    double before = 0, seconds, cpu = 0;
    bool ok = reference(scene, 1001, &r) && reference(scene, 1002, &q) && make(scene, SPP, 1);

    printf("%-12s", scene);
    for (int m = 0; ok && m < METHODS; m++) {
        double e;
        ok = filtered(methods[m], &a, &seconds);
        e = ok ? paired_sigma(&a, &r, &q) : 0;
        before = m ? before : e;
        cpu += seconds;
        printf(m ? "  %6.4f (%4.2f)" : "  %6.4f", e, before / e);
        if (ok)
            sheet_paste(sheet, &a, (uint32_t)m * SIDE, (uint32_t)row * SIDE, SIDE, SIDE);
        image_clear(&a);
    }
    printf("  %6.2f\n", cpu);
    if (ok)
        sheet_paste(sheet, &r, METHODS * SIDE, (uint32_t)row * SIDE, SIDE, SIDE);
    image_clear(&r);
    image_clear(&q);
    return ok;
}

void bench_denoise(void)
{
    static const Display display = { 0 };
    Image sheet;
    bool ok = image_init(&sheet, (METHODS + 1) * SIDE, SCENES * SIDE);

    printf("\n# noise filters: %d x %d, %d samples a pixel; sigma/mu, and how many times less;\n"
           "# all CPU s; denoise.png: the same in this order, and %d samples\n%-12s", SIDE, SIDE,
           SPP, REFERENCE_SPP, "scene");
    for (int m = 0; m < METHODS; m++)
        printf(m ? "  %-13s" : "  %6.6s", methods[m]);
    printf("   CPU s\n");
    for (int s = 0; ok && s < SCENES; s++)
        ok = bench_scene(s, &sheet);
    if (ok && image_write(&sheet, "denoise.png", &display))
        report_picture("denoise.png");
    image_clear(&sheet);
    unlink(file);
}

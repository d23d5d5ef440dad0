/* zoneplate.c -- what pixel filters make of sin(x^2 + y^2): figure 5.1 of [Shirley91].
 *
 * The origin is the middle of the left side. Rings around it are real; they get finer
 * to the right, and where the figure is finer than pixels can show, a good filter is grey. Rings in
 * the middle and on the right are aliases. Writes zoneplate.png, a panel for each filter, and
 * prints for each how much of the real rings is left and how much of the aliases. */
#include "bench/bench.h"
#include "bench/report.h"

#include <stdio.h>

/* The plate has x / pi periods a unit along x. At the right side, at UNITS, that is just above one
 * period a pixel, UNITS^2 / (pi SIDE), which points in the middles of pixels cannot tell from
 * none; half way it is half a period, which alternates from pixel to pixel. */
enum { SIDE = 200, SPP = 256, COLUMNS = 3, GAP = 4 };
#define UNITS 25.4

static double plate(double x, double y) { return 0.5 + 0.5 * md_sin(x * x + y * y); }

/* The pixel (px, py), sampled as the renderer does: strata in place, independent for each pixel. */
static double pixel(const Filter *f, Sampler *s, int px, int py)
{
    double scale = UNITS / SIDE, sum = 0;

    sampler_pixel(s, (uint32_t)px, (uint32_t)py);
    for (uint32_t i = 0; i < SPP; i++) {
        float weight;
        V2 off;
        sampler_start(s, i);
        off = filter_sample(f, sample_2d(s, DECISION(DECIDE_PIXEL, 0)), &weight);
        sum += (double)weight * plate((px + 0.5 + (double)off.x) * scale,
                              (py + 0.5 - SIDE / 2 + (double)off.y) * scale);
    }
    return sum / SPP;
}

/* Root mean square of the deviation from grey over columns x0 to x1, against that of the plate. */
static double contrast(const Image *im, uint32_t left, uint32_t top, int x0, int x1)
{
    double sum = 0;
    for (int y = 0; y < SIDE; y++)
        for (int x = x0; x < x1; x++) {
            double d = image_at(im, left + (uint32_t)x, top + (uint32_t)y)->r - 0.5;
            sum += d * d;
        }
    return sqrt(sum / ((x1 - x0) * SIDE) / 0.125);
}

static void panel(Image *im, int k, const char *name, const FilterKind *kind, double radius)
{
    uint32_t left = (uint32_t)(k % COLUMNS) * (SIDE + GAP);
    uint32_t top = (uint32_t)(k / COLUMNS) * (SIDE + GAP);
    uint32_t spp = SPP;
    Sampler s;
    Filter f;
    Opts o, none;

    opts_default(&o, kind->info.options);
    opt_set_number(&o, "xradius", radius);
    opt_set_number(&o, "yradius", radius);
    filter_init(&f, kind, &o);
    s.kind = kind_find(samplers, SAMPLER_DEFAULT);
    opts_default(&none, s.kind->info.options);
    if (!sampler_init(&s, s.kind, &none, 1, &spp))
        return;
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++)
            *image_at(im, left + (uint32_t)x, top + (uint32_t)y) =
                rgb_all((float)pixel(&f, &s, x, y));
    sampler_clear(&s);
    printf("  %-24s%10.3f%10.3f%10.3f\n", name, contrast(im, left, top, 5, 35),
           contrast(im, left, top, SIDE / 2 - 20, SIDE / 2 + 20),
           contrast(im, left, top, SIDE - 40, SIDE));
}

void bench_zoneplate(void)
{
    static const struct { const char *name, *kind; double radius; } boxes[] = {
        { "box, 1 pixel", "box", 0.5 }, { "box, 2 pixels", "box", 1 },
        { "box, 3 pixels", "box", 1.5 }
    };
    static const Display display = { 0 };
    int n = 0, panels = 2;
    Image im;

    while (filters[panels - 2])
        panels++;
    if (!image_init(&im, COLUMNS * (SIDE + GAP),
                    (uint32_t)((panels + COLUMNS - 1) / COLUMNS) * (SIDE + GAP)))
        return;
    printf("# zone plate: contrast left (true), in the middle and on the right (aliases)\n");
    for (size_t k = 0; k < sizeof boxes / sizeof *boxes; k++)
        panel(&im, n++, boxes[k].name, kind_find(filters, boxes[k].kind), boxes[k].radius);
    for (int k = 0; filters[k]; k++)
        if (filters[k] != kind_find(filters, "box"))
            panel(&im, n++, filters[k]->info.name, filters[k], 0);
    if (image_write(&im, "zoneplate.png", &display)) {
        printf("  the figure is zoneplate.png\n");
        report_picture("zoneplate.png");
    }
    image_clear(&im);
}

/* test_splats.c -- light that lands on any pixel: filters, borders, what is refused. */
#include "base/random.h"
#include "image/splats.h"
#include "test/test.h"

#include <math.h>

static Filter box_filter(void)
{
    const FilterKind *k = kind_find(filters, "box");
    Filter f;
    Opts o;

    opts_default(&o, k->info.options);
    filter_init(&f, k, &o);
    return f;
}

/* A splat gives each pixel what the filter around its centre has there; of places all over the
 * plane, as much as there is of light. */
static void filters_of_splats(void)
{
    static const uint32_t crop[4] = { 3, 2, 11, 12 };

    for (int k = 0; filters[k]; k++) {
        Rng rng = rng_seed(5);
        double sum = 0, n = 20000, area = 24.0 * 22.0;
        Image im;
        Film f;
        Filter filter;
        Opts o;
        opts_default(&o, filters[k]->info.options);
        filter_init(&filter, filters[k], &o);
        REQUIRE(film_init(&f, 16, 14, crop, 1) && film_accepts_splats(&f) && image_init(&im, 8, 10),
                "memory");
        film_splat(&f, &filter, (V2){ 6.75f, 7.125f }, 1, rgb(1, 2, 4));
        film_shots(&f, 1);
        film_picture(&f, 0, &im);
        for (uint32_t y = 2; y < 12; y++)
            for (uint32_t x = 3; x < 11; x++) {
                double want = filter_eval(&filter, 6.75 - (x + 0.5), 7.125 - (y + 0.5));
                Rgb got = *image_at(&im, x - 3, y - 2);
                EXPECT(fabs(got.r - want) <= 1e-6 && fabs(got.b - 4 * want) <= 4e-6,
                       "%s: pixel %lu,%lu has %g of %g", filters[k]->info.name, (unsigned long)x,
                       (unsigned long)y, got.r, want);
            }
        for (int i = 0; i < (int)n; i++) {
            V2 at = { rng_unit(&rng) * 24 - 4, rng_unit(&rng) * 22 - 4 };
            film_splat(&f, &filter, at, 1, rgb_all(1));
        }
        film_picture(&f, 0, &im);
        for (int i = 0; i < 80; i++)
            sum += im.pixels[i].g;
        /* 80 pixels of area 1 each; the filter's own spread is below that of a box of 3 pixels */
        EXPECT(fabs((sum - 2) / (80 * n / area) - 1) < 6 / sqrt(n * 40 / area),
               "%s: %g of %g", filters[k]->info.name, sum - 2, 80 * n / area);
        image_clear(&im);
        film_clear(&f);
    }
}

/* A box has one pixel for each place, on its very borders, too. */
static void box(void)
{
    static const uint32_t crop[4] = { 0, 0, 8, 8 };
    Filter filter = box_filter();
    Image im;
    Film f;

    REQUIRE(film_init(&f, 8, 8, crop, 2) && film_accepts_splats(&f) && image_init(&im, 8, 8),
            "memory");
    for (int y = 0; y <= 32; y++)
        for (int x = 0; x <= 32; x++)
            film_splat(&f, &filter, (V2){ (float)x / 4, (float)y / 4 }, 2, rgb_all(1));
    film_splat(&f, &filter, (V2){ NAN, 1 }, 1, rgb_all(1));
    film_splat(&f, &filter, (V2){ 2, INFINITY }, 1, rgb_all(1));
    film_splat(&f, &filter, (V2){ 3e38f, -3e38f }, 1, rgb_all(1));
    film_shots(&f, 1);
    film_picture(&f, 1, &im);
    for (int i = 0; i < 64; i++)
        EXPECT(im.pixels[i].r == 16, "pixel %d has %g of 16", i,
               im.pixels[i].r);
    film_picture(&f, 0, &im);
    for (int i = 0; i < 64; i++)
        EXPECT(im.pixels[i].r == 0, "a splat in a layer that was not asked for");
    image_clear(&im);
    film_clear(&f);
}

static void refused(void)
{
    static const uint32_t crop[4] = { 0, 0, 40, 40 };
    uint32_t x = 0, y = 0, index = 7;
    Filter filter = box_filter();
    Film f;

    REQUIRE(film_init(&f, 40, 40, crop, 1) && film_accepts_splats(&f), "memory");
    film_splat(&f, &filter, (V2){ 20.5f, 30.5f }, 1, rgb(1, INFINITY, 1));
    film_splat(&f, &filter, (V2){ 20.5f, 30.5f }, 1, rgb(1, 1, NAN));
    EXPECT(film_refused(&f, &x, &y, &index) == 2 && x == 20 && y == 30 && index == 0,
           "%lu,%lu", (unsigned long)x, (unsigned long)y);
    film_clear(&f);
}

const TestCase test_splats[] = {
    { "filters", filters_of_splats, false },
    { "box", box, false },
    { "refused", refused, false },
    { NULL, NULL, false }
};

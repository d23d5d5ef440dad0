/* pictures.h -- small renders through the driver, for the tests: a camera, settings that are valid
 * as they are, and the means of tiles over several seeds. */
#ifndef TEST_PICTURES_H
#define TEST_PICTURES_H

#include "render/render.h"
#include "test/physics.h"

void lab_camera(Lab *l, V3 eye, V3 at, float fov, const char *options);
void lab_camera_of(Lab *l, const char *kind, V3 eye, V3 at, float fov, const char *options);

/* One thread. method: as lab_method takes it; a sampler may follow, and a filter, as in
 * "direct:strategy=mis@halton" or "@random@gaussian", else they are the defaults. Text is kept by
 * l. */
void picture_settings(Lab *l, RenderSettings *s, const char *method, uint32_t w, uint32_t h,
                      uint32_t spp);
/* Renders or ends the case. The film is the caller's. */
void picture_render(Lab *l, const RenderSettings *s, Film *film, RenderReport *report);
/* Everything that a picture is made of: sums and counts. */
bool films_equal(const Film *a, const Film *b);

/* ---- pictures by two methods: the same but for noise? [RELIABILITY S14] ---- */

enum { RUNS = 16, TILE = 8 };

/* Luminance of tiles of 8 x 8 pixels in RUNS runs of different seeds. */
typedef struct {
    uint32_t tiles;
    double  *tile;              /* owned: [tile][run] */
    bool     tied;              /* a path may bring light to many tiles */
} Series;

void series_render(Lab *l, Series *s, const char *method, uint32_t side, uint32_t spp,
                   uint64_t seed);
void series_clear(Series *s);

/* Welch's test of each tile: the least p is not too small, their histogram is even, and the whole
 * pictures agree with power to find a relative difference of delta. */
void series_expect_same(const Series *a, const Series *b, double delta, const char *what);

#endif

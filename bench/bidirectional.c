/* bidirectional.c -- paths from both ends: error after equal time, on scenes that other programs
 * were measured on and on those of [GIRT 5]; what a pass of vcm consists of.
 *
 * Reference   two pictures by methods that miss nothing of the scene, see paired_relmse: where
 *             delta lamps are seen by way of glass that is vcm, of other seeds.
 * Time        Samples are as many as 20 CPU-seconds allow, by what a few of them take. */
#include "bench/bench.h"

#include <stdio.h>
#include <string.h>

typedef struct {
    const char *scene, *method, *reference;
    uint32_t side;              /* pixels; 0: as the scene has it */
    double seconds;
    const char *asked;
} Case;

#define BOTH "bdpt"
#define ALL "vcm"

static const Case cases[] = {
    { "scenes/s5.pbrt", "bdpt", BOTH, 0, 20, "asked 0.006, aim 0.004; SmallVCM 0.0082" },
    { "scenes/s5.pbrt", "vcm", BOTH, 0, 20, "asked 0.003, aim 0.002; SmallVCM 0.0041" },
    { "scenes/s5.pbrt", "path", BOTH, 0, 20, "Mitsuba 0.027" },
    { "scenes/s5.pbrt", "bpm", BOTH, 0, 20, "SmallVCM 0.0320" },
    { "scenes/s1.pbrt", "vcm", BOTH, 0, 20, "asked 0.0025, aim 0.0017; SmallVCM 0.0034" },
    { "scenes/s1.pbrt", "bdpt", BOTH, 0, 20, "SmallVCM 0.0171" },
    { "scenes/s0.pbrt", "vcm", ALL, 0, 20, "asked 0.012, aim 0.008; SmallVCM 0.0168" },
    { "scenes/s2.pbrt", "vcm", ALL, 0, 20, "asked 0.0035, aim 0.0023; SmallVCM 0.0046" },
    { "scenes/s2.pbrt", "bdpt", ALL, 0, 20, "asked 0.0035, aim 0.0023; SmallVCM 0.0049" },
};

/* [GIRT tables 5.6 to 5.8]: path best where it can find the light; bpm early, vcm in the end where
 * caustics are seen in mirrors. */
#define FOUR(name, seconds) \
    { "scenes/" name ".pbrt", "path", ALL, 128, seconds, "" },                 \
    { "scenes/" name ".pbrt", "bdpt", ALL, 128, seconds, "" },                 \
    { "scenes/" name ".pbrt", "bpm:share=0.01", ALL, 128, seconds, "" },       \
    { "scenes/" name ".pbrt", "vcm", ALL, 128, seconds, "" }
static const Case rooms[] = {
    FOUR("mirror-balls", 1), FOUR("mirror-balls", 8), FOUR("living-room", 1),
    FOUR("living-room", 8), FOUR("bathroom", 1), FOUR("bathroom", 8),
};

static void after(const Case *c, const Image ref[2])
{
    enum { FEW = 16 };
    RenderReport r;
    Image im = { 0 };
    uint32_t spp;

    if (!bench_render(c->scene, c->method, NULL, c->side, FEW, 1, 5, NULL, &r))
        return;
    spp = (uint32_t)d_max(1, FEW * c->seconds / r.cpu_seconds);
    if (bench_render(c->scene, c->method, NULL, c->side, spp, processors(), 1, &im, &r)) {
        double e = paired_relmse(&im, &ref[0], &ref[1]);
        printf("bidirectional\t%s\t%s\tspp %lu\tCPU-seconds %.1f\trelMSE %.5f\tscaled to %g s "
               "%.5f\t%s\n", c->scene, c->method, (unsigned long)spp, r.cpu_seconds, e,
               c->seconds, e * r.cpu_seconds / c->seconds, c->asked);
    }
    fflush(stdout);
    image_clear(&im);
}

static void table(const Case *row, size_t n)
{
    Image ref[2] = { { 0 }, { 0 } };
    RenderReport r;

    for (size_t i = 0; i < n; i++) {
        const Case *c = &row[i];
        bool same = i && !strcmp(c[-1].scene, c->scene);
        for (uint64_t k = 0; k < 2 && !same; k++) {
            image_clear(&ref[k]);
            if (!bench_render(c->scene, c->reference, NULL, c->side, 128, processors(), 77 + k,
                              &ref[k], &r))
                return;
        }
        after(c, ref);
    }
    image_clear(&ref[0]);
    image_clear(&ref[1]);
}

void bench_bidirectional(void)
{
    table(cases, sizeof cases / sizeof *cases);
}

void bench_bidirectional_rooms(void)
{
    table(rooms, sizeof rooms / sizeof *rooms);
}

/* ---- a pass ---- */

enum { PASSES = 8 };

static double cpu_of(const char *scene, const char *method, RenderReport *r)
{
    return bench_render(scene, method, NULL, 0, PASSES, 1, 3, NULL, r) ? r->cpu_seconds / PASSES
                                                                       : 0;
}

/* What a pass of one sample a pixel consists of [GIRT table 5.3]. What mergers and connections take
 * is told from runs without them. */
static void profile(const char *scene)
{
    RenderReport r, other;
    const PathWork *w = &r.work;
    double whole = cpu_of(scene, "vcm", &r);
    double connects = cpu_of(scene, "vcm:mode=bdpt", &other);
    double merges = cpu_of(scene, "vcm:mode=bpm", &other);

    if (!(whole > 0) || !w->from_eye || !w->from_lamps)
        return;
    printf("pass\t%s\tCPU-seconds %.3f, of light paths and their grid %.3f\twithout mergers %.3f, "
           "without connections %.3f\tedges from lamps %.2f, from the eye %.2f\t"
           "a pixel: connections %.1f, mergers %.1f, rays %.1f\tMrays/s %.2f\n",
           scene, whole, r.before / PASSES, connects, merges,
           (double)w->lamp_edges / (double)w->from_lamps,
           (double)w->eye_edges / (double)w->from_eye, (double)w->joins / (double)w->from_eye,
           (double)w->mergers / (double)w->from_eye, (double)r.rays / (double)w->from_eye,
           (double)r.rays * 1e-6 / r.seconds);
    fflush(stdout);
}

void bench_bidirectional_pass(void)
{
    profile("scenes/s5.pbrt");
    profile("scenes/mirror-balls.pbrt");
    profile("scenes/living-room.pbrt");
    profile("scenes/bathroom.pbrt");
}

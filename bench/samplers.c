/* samplers.c -- which sampler wins: relMSE times CPU-seconds of `path`, of scenes of scenes/ in
 * 96 x 96 pixels, against two references of many samples and other seeds. SAMPLERS and
 * SCENES="a b" choose others, SPP=n other than 64 samples. Runs alternate, so that whatever else
 * the machine does hits all of them. */
#include "bench/bench.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 96, ROUNDS = 6, MOST = 24, REFERENCE_SPP = 1024 };

typedef struct { char text[100]; double error, seconds; } Entry;

/* The words of text, or of the variable if it is set. */
static int words(const char *variable, const char *text, char (*out)[100])
{
    const char *set = getenv(variable), *at = set ? set : text;
    int n = 0;

    for (; n < MOST && *(at += strspn(at, " ")); n++) {
        size_t len = strcspn(at, " ");
        snprintf(out[n], sizeof out[n], "%.*s", len < 99 ? (int)len : 99, at);
        at += len;
    }
    return n;
}

static void measure(const char *scene, Entry *e, int n, uint32_t spp)
{
    Image ref[2] = { { 0 }, { 0 } };
    RenderReport r;
    bool ok = true;

    for (int k = 0; k < 2 && ok; k++)
        ok = bench_render(scene, NULL, "zerotwo", SIDE, REFERENCE_SPP, processors(),
                          1000 + (uint64_t)k, &ref[k], &r);
    for (int round = 0; round < ROUNDS && ok; round++)
        for (int i = 0; i < n && ok; i++) {
            Image im = { 0 };
            ok = bench_render(scene, NULL, e[i].text, SIDE, spp, 1, (uint64_t)round, &im, &r);
            if (ok) {               /* per planned sample: some round their number up */
                double share = (double)r.samples / ((double)SIDE * SIDE * spp);
                e[i].error += paired_relmse(&im, &ref[0], &ref[1]) * share / ROUNDS;
                e[i].seconds += r.cpu_seconds / share / ROUNDS;
            }
            image_clear(&im);
        }
    image_clear(&ref[0]);
    image_clear(&ref[1]);
}

void bench_samplers(void)
{
    static char names[MOST][100], scenes[MOST][100];
    uint32_t spp = getenv("SPP") ? (uint32_t)atoi(getenv("SPP")) : 64;
    int nscenes = words("SCENES", "s3 s4 s5 plates swarm-probe", scenes), n = 0;
    char all[1000] = "";

    for (int k = 0; samplers[k]; k++)
        strcat(strcat(all, samplers[k]->info.name), " ");
    n = words("SAMPLERS", all, names);
    printf("# 1 / (relMSE x CPU-seconds) beside that of the first; %lu samples a pixel\n",
           (unsigned long)spp);
    for (int s = 0; s < nscenes; s++) {
        Entry e[MOST];
        char path[200];
        memset(e, 0, sizeof e);
        snprintf(path, sizeof path, "scenes/%.99s.pbrt", scenes[s]);
        for (int i = 0; i < n; i++)
            memcpy(e[i].text, names[i], sizeof e[i].text);
        measure(path, e, n, spp);
        for (int i = 0; i < n; i++)
            printf("samplers\t%s\t%-28s relMSE %.6f\tof the first %.3f\tCPU-seconds %.3f\t"
                   "efficiency %.2f\n", scenes[s], e[i].text, e[i].error,
                   e[i].error / e[0].error, e[i].seconds,
                   e[0].error * e[0].seconds / (e[i].error * e[i].seconds));
        fflush(stdout);
    }
}

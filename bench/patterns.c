/* patterns.c -- [Cline07 4.5] measured: the point sets of figures 4.11 to 4.15 as patterns.svg, the
 * star discrepancy of each, how variance falls with N for the three kinds of integrand of
 * [Mitchell96], and what uncorrelated jittering [Shirley91 5.4.1] gains. */
#include "bench/bench.h"
#include "bench/report.h"

#include "render/plot.h"

#include <stdio.h>
#include <string.h>

enum { MOST = 4096 };
static const Decision place = DECISION(DECIDE_PIXEL, 0);

static bool open_sampler(Sampler *s, const char *text, uint32_t *spp)
{
    Arena arena = { 0 };
    Opts o;
    const SamplerKind *kind = kind_from_text(samplers, "sampler", text, &o, &arena);
    bool ok = kind && sampler_init(s, kind, &o, 1, spp);

    arena_clear(&arena);
    return ok;
}

static void take(Sampler *s, uint32_t pixel, uint32_t n, V2 *u)
{
    sampler_pixel(s, pixel, 0);
    for (uint32_t i = 0; i < n; i++) {
        sampler_start(s, i);
        u[i] = sample_2d(s, place);
    }
}

/* ---- figures ---- */

/* A panel: n points of a sampler on a grid of columns x rows. */
typedef struct { const char *title, *sampler; uint32_t n; int columns, rows; } Panel;

static const Panel panels[] = {
    { "4.11 random", "random", 64, 8, 8 },
    { "4.12 stratified", "stratified", 64, 8, 8 },
    { "4.13 Poisson disk, best candidate", "poisson:randomize=none", 64, 1, 1 },
    { "4.13 Poisson disk, dart throwing", "poisson:method=darts,randomize=none", 64, 1, 1 },
    { "4.13 the same, Lloyd 10 times", "poisson:method=darts,relax=10,randomize=none", 64, 1, 1 },
    { "4.14 Latin hypercube", "nrooks", 16, 16, 16 },
    { "4.14 multi-jittered", "multijittered", 16, 4, 4 },
    { "correlated multi-jittered", "cmj", 16, 4, 4 },
    { "uncorrelated jittering, restricted", "uncorrelated", 64, 8, 8 },
    { "4.15 (0,2)-sequence, 1 x 16", "zerotwo:randomize=none", 16, 1, 16 },
    { "4.15 2 x 8", "zerotwo:randomize=none", 16, 2, 8 },
    { "4.15 4 x 4", "zerotwo:randomize=none", 16, 4, 4 },
    { "4.15 8 x 2", "zerotwo:randomize=none", 16, 8, 2 },
    { "4.15 16 x 1", "zerotwo:randomize=none", 16, 16, 1 },
    { "(0,2)-sequence, scrambled", "zerotwo", 16, 4, 4 },
    { "4.15 Halton sequence", "halton:randomize=none", 64, 1, 1 },
    { "Halton sequence, scrambled", "halton", 64, 1, 1 },
    { "4.15 Hammersley points", "hammersley:randomize=none", 64, 1, 1 },
    { "Hammersley points, rotated", "hammersley", 64, 1, 1 },
    { "Sobol's, dimensions 0 and 1, scrambled", "sobol", 64, 8, 8 },
};
enum { PANELS = sizeof panels / sizeof panels[0], ACROSS = 5, POINTS = 64 };

static void figures(void)
{
    V2 u[POINTS];
    static float xy[PANELS][2 * POINTS];
    PlotPoints sets[PANELS];

    for (int k = 0; k < PANELS; k++) {
        const Panel *p = &panels[k];
        uint32_t spp = p->n;
        Sampler s;
        if (!open_sampler(&s, p->sampler, &spp))
            return;
        take(&s, 7, p->n, u);
        sampler_clear(&s);
        for (uint32_t i = 0; i < p->n; i++) {
            xy[k][2 * i] = u[i].x;
            xy[k][2 * i + 1] = u[i].y;
        }
        sets[k] = (PlotPoints){ p->title, xy[k], (int)p->n, p->columns, p->rows };
    }
    if (plot_write_points("patterns.svg", sets, PANELS, ACROSS)) {
        printf("# figures 4.11 to 4.15: patterns.svg\n");
        report_picture("patterns.svg");
    }
}

/* ---- star discrepancy ---- */

/* The largest | share of points in [0,x) x [0,y) - x y |, or with both closed: reached where x and
 * y are coordinates of points or 1. */
static double discrepancy(const V2 *u, int n)
{
    double worst = 0;

    for (int a = 0; a <= n; a++)
        for (int b = 0; b <= n; b++) {
            float x = a < n ? u[a].x : 1, y = b < n ? u[b].y : 1;
            int open = 0, closed = 0;
            for (int i = 0; i < n; i++) {
                open += u[i].x < x && u[i].y < y;
                closed += u[i].x <= x && u[i].y <= y;
            }
            worst = d_max(worst, (double)x * y - (double)open / n);
            worst = d_max(worst, (double)closed / n - (double)x * y);
        }
    return worst;
}

/* ---- Mitchell's three kinds ---- */

enum { KINDS = 3, CELLS = 2048 };
static const char *const kind_names[KINDS] = { "smooth", "edges", "complex" };

static double cell_value(uint32_t x, uint32_t y)
{
    return (double)(key_with(96, (uint64_t)y << 32 | x) >> 63);
}

/* A polynomial; a disc, with another value below a line; black and white cells without order. */
static void integrands(V2 u, double f[KINDS])
{
    double x = (double)u.x + 0x1p-25, y = (double)u.y + 0x1p-25, dx = x - 0.42, dy = y - 0.47;
    f[0] = x * y + x * x + 0.5 * y * y * y;
    f[1] = (dx * dx + dy * dy < 0.1 ? 1 : 0) + (y < 0.2 + 0.37 * x ? 0.7 : 0);
    f[2] = cell_value((uint32_t)(u.x * CELLS), (uint32_t)(u.y * CELLS));
}

static void integrals(double f[KINDS])
{
    f[0] = 0.25 + 1.0 / 3 + 0.125;
    f[1] = PI * 0.1 + 0.7 * (0.2 + 0.185);
    f[2] = 0;
    for (uint32_t y = 0; y < CELLS; y++)
        for (uint32_t x = 0; x < CELLS; x++)
            f[2] += cell_value(x, y) / ((double)CELLS * CELLS);
}

static void variances(const char *text, uint32_t n, const double truth[KINDS], double v[KINDS])
{
    uint32_t runs = 1 << 22 >> (n > 1024 ? 1 : 0), spp = n;
    Sampler s;

    runs = runs / n < 4000 ? runs / n : 4000;
    for (int k = 0; k < KINDS; k++)
        v[k] = 0;
    if (!open_sampler(&s, text, &spp))
        return;
    for (uint32_t run = 0; run < runs; run++) {
        double sum[KINDS] = { 0, 0, 0 }, f[KINDS];
        sampler_pixel(&s, run, 1);
        for (uint32_t i = 0; i < n; i++) {
            sampler_start(&s, i);
            integrands(sample_2d(&s, place), f);
            for (int k = 0; k < KINDS; k++)
                sum[k] += f[k];
        }
        for (int k = 0; k < KINDS; k++)
            v[k] += (sum[k] / n - truth[k]) * (sum[k] / n - truth[k]) / runs;
    }
    sampler_clear(&s);
}

/* Least squares of log variance against log N, N = 4, 16, ... 4096. */
static void slopes(const char *text, const double truth[KINDS], double slope[KINDS])
{
    enum { COUNTS = 6 };
    double v[COUNTS][KINDS];

    for (int c = 0; c < COUNTS; c++)
        variances(text, 4u << 2 * c, truth, v[c]);
    for (int k = 0; k < KINDS; k++) {
        double sum = 0;
        for (int c = 0; c < COUNTS; c++)
            sum += (c - 2.5) * (double)m_log2((float)(v[c][k] * 1e12));
        slope[k] = sum / 17.5 / 2;          /* sum of (c - 2.5)^2; two doublings a step */
    }
}

static void sets(void)
{
    static const struct { const char *sampler; double theory[KINDS]; } all[] = {
        { "random", { -1, -1, -1 } }, { "stratified", { -2, -1.5, -1 } },
        { "uncorrelated", { -2, -1.5, -1 } }, { "nrooks", { 0, 0, -1 } },
        { "multijittered", { 0, 0, -1 } }, { "cmj", { 0, 0, -1 } }, { "poisson", { 0, 0, -1 } },
        { "poisson:method=darts", { 0, 0, -1 } }, { "poisson:relax=10", { 0, 0, -1 } },
        { "zerotwo", { 0, 0, -1 } }, { "zerotwo:randomize=rotation", { 0, 0, -1 } },
        { "halton", { 0, 0, -1 } }, { "hammersley", { 0, 0, -1 } },
        { "hammersley:randomize=owen", { 0, 0, -1 } }, { "sobol", { 0, 0, -1 } },
    };
    static V2 u[MOST];
    double truth[KINDS], slope[KINDS];

    integrals(truth);
    printf("# star discrepancy of 16 and 64 points, mean of 20 sets; slope of variance against N, "
           "4 to 4096,\n# (theory: [Mitchell96], N^-2, N^-1.5 and N^-1)\n");
    for (size_t k = 0; k < sizeof all / sizeof all[0]; k++) {
        double d[2] = { 0, 0 };
        for (int size = 0; size < 2; size++)
            for (uint32_t pixel = 0; pixel < 20; pixel++) {
                uint32_t n = size ? 64 : 16, spp = n;
                Sampler s;
                if (!open_sampler(&s, all[k].sampler, &spp))
                    return;
                take(&s, pixel, n, u);
                d[size] += discrepancy(u, (int)n) / 20;
                sampler_clear(&s);
            }
        slopes(all[k].sampler, truth, slope);
        printf("patterns\t%-28s\tdiscrepancy %.3f %.3f", all[k].sampler, d[0], d[1]);
        for (int i = 0; i < KINDS; i++) {
            double theory = all[k].theory[i];
            bool wrong = theory != 0 && fabs(slope[i] - theory) > 0.1;
            printf("\t%s %.2f", kind_names[i], slope[i]);
            if (theory != 0)
                printf(" (theory %.1f)%s", theory, wrong ? " WRONG" : "");
        }
        printf("\n");
        fflush(stdout);
    }
}

/* ---- uncorrelated jittering ---- */

/* What a pixel sees through a lens: in focus a function of its place alone; a texture with a glow
 * from the lens, sums of the two; an edge out of focus, that both together decide. */
static double view(int kind, V2 p, V2 l)
{
    double x = p.x, y = p.y;
    return kind == 0 ? (x * x + x * y)
           : kind == 1 ? x * x + x * y + (double)l.x * l.y
           : x + 0.3 * y + 0.8 * l.x + 0.2 * l.y < 1.15 ? 1 : 0;
}

static void uncorrelated(void)
{
    static const char *const text[] = { "uncorrelated:match=independent",
                                        "uncorrelated:match=permuted", "uncorrelated" };
    enum { RUNS = 20000, REFERENCE = 4000000 };
    uint32_t counts[3] = { 4, 16, 64 }, spp = 1;
    double truth[3] = { 1.0 / 3 + 0.25, 1.0 / 3 + 0.5, 0 }, v[3][4];
    Sampler s;

    if (!open_sampler(&s, "sobol", &spp))
        return;
    sampler_pixel(&s, 0, 0);
    for (uint32_t i = 0; i < REFERENCE; i++) {
        V2 p;
        sampler_start(&s, i);
        p = sample_2d(&s, place);
        truth[2] += view(2, p, sample_2d(&s, DECISION(DECIDE_LENS, 0))) / REFERENCE;
    }
    sampler_clear(&s);
    printf("# variance of pixel and lens together, of that with independent samples: in focus, "
           "sum, edge out of focus\n");
    for (int c = 0; c < 3; c++)
        for (int t = -1; t < 3; t++) {
            spp = counts[c];
            if (!open_sampler(&s, t < 0 ? "random" : text[t], &spp))
                return;
            for (int k = 0; k < 3; k++)
                v[k][t + 1] = 0;
            for (uint32_t run = 0; run < RUNS; run++) {
                double sum[3] = { 0, 0, 0 };
                sampler_pixel(&s, run, 2);
                for (uint32_t i = 0; i < counts[c]; i++) {
                    V2 p, l;
                    sampler_start(&s, i);
                    p = sample_2d(&s, place);
                    l = sample_2d(&s, DECISION(DECIDE_LENS, 0));
                    for (int k = 0; k < 3; k++)
                        sum[k] += view(k, p, l) / counts[c];
                }
                for (int k = 0; k < 3; k++)
                    v[k][t + 1] += (sum[k] - truth[k]) * (sum[k] - truth[k]);
            }
            if (t >= 0)
                printf("patterns\t%3lu samples\t%-30s\t%.3f\t%.3f\t%.3f\n",
                       (unsigned long)counts[c], text[t], v[0][t + 1] / v[0][0],
                       v[1][t + 1] / v[1][0], v[2][t + 1] / v[2][0]);
            sampler_clear(&s);
        }
}

void bench_patterns(void)
{
    figures();
    sets();
    uncorrelated();
}

/* test_filters.c -- pixel filters: places and weights of samples against the filter, the conditions
 * of [Shirley91 5.1] against what each says of itself, and pictures against the convolution. */
#include "base/random.h"
#include "image/filter.h"
#include "test/chi2.h"
#include "test/pictures.h"

#include <stdio.h>
#include <string.h>

typedef struct { const char *kind, *options; } Case;

/* The usual ones, and others: narrow and wide, longer one way, with other numbers. */
static const Case cases[] = {
    { "box", "" }, { "box", "xradius=1.5,yradius=1" }, { "triangle", "" }, { "cubic", "" },
    { "cubic", "a=-16" }, { "cubic", "a=-3,xradius=2" }, { "blackmanharris", "" },
    { "gaussian", "" }, { "gaussian", "sigma=0.3,yradius=2" }, { "gaussian", "alpha=0.5" },
    { "mitchell", "" }, { "mitchell", "B=1,C=0" }, { "mitchell", "B=0,C=0.5,xradius=1.7" },
    { "gaussian", "sigma=0.05,xradius=100" }, { "sinc", "" },
    { "sinc", "tau=2,xradius=2,yradius=3" }, { "sinc", "tau=1,xradius=1.5,yradius=1" }
};
enum { CASES = sizeof cases / sizeof *cases };

static void filter_of(Filter *f, const Case *c)
{
    const FilterKind *k = kind_find(filters, c->kind);
    Arena words = { 0 };
    Opts o;

    REQUIRE(k, "%s", c->kind);
    opts_default(&o, k->info.options);
    REQUIRE(opts_parse(&o, c->kind, c->options, &words), "%s", c->options);
    filter_init(f, k, &o);
    arena_clear(&words);
}

/* ---- samples ---- */

static V2 place_of(const Filter *f, V3 w)
{
    return (V2){ (float)((2.0 * w.x - 1) * f->axis[0].radius),
                 (float)((2.0 * w.y - 1) * f->axis[1].radius) };
}

static bool draw(const void *of, Rng *rng, V3 *w)
{
    const Filter *f = of;
    V2 u, p;
    float weight;

    u.x = rng_unit(rng);
    u.y = rng_unit(rng);
    p = filter_sample(f, u, &weight);
    *w = v3((float)(0.5 + 0.5 * p.x / f->axis[0].radius),
            (float)(0.5 + 0.5 * p.y / f->axis[1].radius), 0);
    w->x = w->x < 1.0f ? w->x : ONE_MINUS_ULP;
    w->y = w->y < 1.0f ? w->y : ONE_MINUS_ULP;
    if ((double)weight * filter_eval(f, p.x, p.y) < -1e-6)
        test_fail(__FILE__, __LINE__, "the sign at %g %g is wrong", (double)p.x, (double)p.y);
    return fabsf(fabsf(weight) / f->weight - 1) < 1e-6f;
}

static double pdf(const void *of, V3 w)
{
    const Filter *f = of;
    V2 p = place_of(f, w);
    return fabs(filter_eval(f, p.x, p.y)) / f->weight * 4 * f->axis[0].radius * f->axis[1].radius;
}

/* Samples fall as |w| does, where w is negative with a negative weight, all of one size. */
static void density(void)
{
    for (int k = 0; k < CASES; k++) {
        Filter f;
        Chi2 test = { .draw = draw, .pdf = pdf, .of = &f, .square = true, .draws = 100000,
                      .seed = 4, .rows = 48, .cols = 48, .halvings = 1 };
        Chi2Result is;
        filter_of(&f, &cases[k]);
        is = chi2_run(&test);
        EXPECT(is.p_fine > CHI2_P_MIN && is.p_coarse > CHI2_P_MIN && !is.astray && !is.refused &&
                   fabs(is.integral - 1) < 1e-3,
               "%s %s: p %g and %g, %d astray, %d refused, integral %g", cases[k].kind,
               cases[k].options, is.p_fine, is.p_coarse, (int)is.astray, (int)is.refused,
               is.integral);
    }
}

/* Rising in each number, from end to end; and the number is where the integral of |w| gets to,
 * which is worked out here by the middle rule. */
static void inverse(void)
{
    enum { STEPS = 200, N = 20000 };

    for (int k = 0; k < CASES; k++) {
        double before = -INFINITY, mass = 0, most = 0, x = 0, r;
        Filter f;
        int next = 0;

        filter_of(&f, &cases[k]);
        r = f.axis[0].radius;
        for (int i = 0; i < STEPS; i++) {
            float weight, u = ((float)i + 0.5f) / STEPS;
            V2 p = filter_sample(&f, (V2){ u, 0.5f }, &weight);
            EXPECT((double)p.x >= before && fabs((double)p.x) <= r, "%s %s: at %g is %g after %g",
                   cases[k].kind, cases[k].options, (double)u, (double)p.x, before);
            before = p.x;
            for (; (x = -r + 2 * r * next / N) < p.x; next++)
                mass += fabs(f.kind->profile(&f, fabs(x + r / N), r)) * 2 * r / N;
            most = d_max(most, fabs(mass / (2 * f.axis[0].sum[f.axis[0].n]) - u));
        }
        EXPECT(most < 4.0 / N * r * f.kind->profile(&f, 0, r) / f.axis[0].sum[f.axis[0].n] + 1e-6,
               "%s %s: the integral is up to %g off", cases[k].kind, cases[k].options, most);
    }
}

/* ---- conditions ---- */

/* The largest change of the sum of weights on the grid of pixels, as the grid is moved; and the
 * least weight. */
static void measure(const Filter *f, double *change, double *least, double *volume)
{
    enum { PLACES = 32, MOST = 6 };
    double lo = INFINITY, hi = -INFINITY;

    *least = INFINITY;
    *volume = 0;
    for (int i = 0; i < PLACES * PLACES; i++) {
        double x = (i % PLACES + 0.5) / PLACES, y = (i / PLACES + 0.5) / PLACES, sum = 0;
        for (int p = -MOST; p <= MOST; p++)
            for (int q = -MOST; q <= MOST; q++) {
                double w = filter_eval(f, x - p, y - q);
                sum += w;
                *least = d_min(*least, w);
                EXPECT(fabs(w - filter_eval(f, p - x, y - q)) < 1e-12 &&
                           fabs(w - filter_eval(f, y - q, x - p)) < 1e-12,
                       "%s is not symmetric", f->kind->info.name);
            }
        *volume += sum / (PLACES * PLACES);
        lo = d_min(lo, sum);
        hi = d_max(hi, sum);
    }
    *change = hi - lo;
}

static void conditions(void)
{
    for (int k = 0; filters[k]; k++) {
        Case usual = { filters[k]->info.name, "" };
        const char *fails = filters[k]->fails;
        double change, least, volume;
        Filter f;

        filter_of(&f, &usual);
        measure(&f, &change, &least, &volume);
        printf("%s: sums differ by %g, least weight %g, volume %g, |w| %g\n", usual.kind, change,
               least, volume, (double)f.weight);
        EXPECT(fabs(volume - 1) < 5e-3, "%s: volume %g", usual.kind, volume);
        EXPECT((strchr(fails, '4') != NULL) == (least < -1e-9), "%s: least %g, fails '%s'",
               usual.kind, least, fails);
        EXPECT((strchr(fails, '5') != NULL) == (change > 1e-6), "%s: sums differ by %g, fails '%s'",
               usual.kind, change, fails);
    }
}

/* The whole of the family; beyond its ends something is negative. The cubic spline. */
static void family(void)
{
    static const char *const members[] = { "a=-16", "a=-5", "a=0", "a=1", "a=2" };
    Case spline = { "mitchell", "B=1,C=0" };
    double change, least, volume;
    Filter f, tent;

    for (int k = 0; k < 5; k++) {
        Case c = { "cubic", members[k] };
        filter_of(&f, &c);
        measure(&f, &change, &least, &volume);
        EXPECT(change < 1e-12 && least > -1e-12, "%s: %g %g", members[k], change, least);
        if (k == 2) {
            Case t = { "triangle", "" };
            filter_of(&tent, &t);
            for (int i = 0; i < 100; i++)
                EXPECT(fabs(filter_eval(&f, 0.01 * i, 0.3) - filter_eval(&tent, 0.01 * i, 0.3)) <
                           1e-12, "a=0 is the tent");
        }
    }
    f.a = -16.5;
    measure(&f, &change, &least, &volume);
    EXPECT(least < -1e-4, "beyond the end: %g", least);
    f.a = 2.2;
    measure(&f, &change, &least, &volume);
    EXPECT(least < -1e-4, "beyond the other: %g", least);
    filter_of(&f, &spline);
    measure(&f, &change, &least, &volume);
    EXPECT(change < 1e-12 && least > -1e-12 && f.weight == 1.0f, "the spline: %g %g", change,
           least);
}

/* ---- pictures ---- */

/* What is left of x of the filter, along x: by the middle rule. */
static double left_of(const Filter *f, double x)
{
    enum { N = 4000 };
    double r = f->axis[0].radius, sum = 0;
    for (int i = 0; i < N; i++) {
        double at = -r + 2 * r * (i + 0.5) / N;
        if (at < x)
            sum += f->kind->profile(f, fabs(at), r) * 2 * r / N;
    }
    return sum / f->axis[0].area;
}

/* A sky that is bright on one side of an edge between pixels and in them: what each pixel of a row
 * gets is the part of its filter on that side, within standard errors. */
static void edge(void)
{
    enum { W = 12, SPP = 6000 };
    static const char scene[] =
        "Film \"rgb\" \"integer xresolution\" 12 \"integer yresolution\" 1\n"
        "Camera \"orthographic\" \"float screenwindow\" [0 12 0 1]\nWorldBegin\n"
        "LightSource \"infinite\" \"rgb L\" [1 1 1]\n"
        "Material \"diffuse\" \"rgb reflectance\" [0 0 0]\n"
        "Shape \"trianglemesh\" \"point3 P\" [6.3 -90 1 90 -90 1 90 90 1 6.3 90 1] "
        "\"integer indices\" [0 1 2 0 2 3]";

    for (int k = 0; k < CASES; k++) {
        char filter[100];
        RenderRequest q = { .integrator = "path:maxdepth=1", .sampler = "random", .filter = filter,
                            .spp = SPP, .threads = 1, .max_pixels = 1 << 20 };
        double chi2 = 0, n = 0;
        ReadLimits limits = READ_LIMITS_DEFAULT;
        RenderSettings s;
        RenderReport report;
        SceneFile file;
        Film film;
        Filter f;

        filter_of(&f, &cases[k]);
        snprintf(filter, sizeof filter, "%s%s%s", cases[k].kind, cases[k].options[0] ? ":" : "",
                 cases[k].options);
        messages_quiet(true);
        REQUIRE(scenefile_parse(&file, "edge.pbrt", scene, sizeof scene - 1, &limits) &&
                    settings_resolve(&s, &q, &file) &&
                    scene_build(file.scene, s.accel, &s.accel_opts, 1) &&
                    render(file.scene, &s, &film, &report), "render");
        for (uint32_t x = 0; x < W; x++) {
            double want = left_of(&f, 6.3 - (x + 0.5)), z = f.weight, sigma;
            double is = exact_value(&film.sums[3 * film_pixel(&film, x, 0)]) / SPP;
            /* of values 0, Z and -Z with mean `want`: those that are not 0 are at most all */
            sigma = sqrt(d_max(0, z * d_max(fabs(want), d_min(1, fabs(want) + z - 1)) - want * want)
                         / SPP) + 1e-9;
            EXPECT(fabs(is - want) < 5 * sigma + 1e-3, "%s, pixel %d: %g, not %g (+- %g)", filter,
                   (int)x, is, want, sigma);
            if (want > 0.05 && want < 0.95 && z == 1) {
                chi2 += (is - want) * (is - want) / (sigma * sigma);
                n++;
            }
        }
        EXPECT(n == 0 || chi2_tail(chi2, n) > CHI2_P_MIN, "%s: chi2 %g of %g", filter, chi2, n);
        film_clear(&film);
        scenefile_clear(&file);
    }
}

/* Numbers at the ends of their ranges: samples stay within, sums stay finite. */
static void extremes(void)
{
    static const Case far[] = {
        { "sinc", "xradius=16,yradius=15.99,tau=1" }, { "sinc", "xradius=16,tau=1.01" },
        { "sinc", "xradius=0.01,yradius=16,tau=100" }, { "mitchell", "B=10,C=-10" },
        { "mitchell", "B=-10,C=10" }, { "mitchell", "B=10,C=10" }, { "mitchell", "B=-10,C=-10" },
        { "gaussian", "sigma=0.05,xradius=100" }, { "gaussian", "sigma=100" },
        { "gaussian", "alpha=200,xradius=100" }, { "cubic", "xradius=100,yradius=1e-6" },
        { "blackmanharris", "xradius=100,yradius=1e-30" }
    };
    Rng rng = rng_seed(9);

    for (size_t k = 0; k < sizeof far / sizeof *far; k++) {
        Filter f;
        filter_of(&f, &far[k]);
        EXPECT(f.weight >= 1 && is_finite(f.weight), "%s: weight %g", far[k].options,
               (double)f.weight);
        for (int i = 0; i < 2000; i++) {
            V2 u, p;
            float weight;
            u.x = i ? rng_unit(&rng) : 0.0f;
            u.y = i ? rng_unit(&rng) : ONE_MINUS_ULP;
            p = filter_sample(&f, u, &weight);
            EXPECT(fabs((double)p.x) <= f.axis[0].radius * (1 + 1e-6) &&
                       fabs((double)p.y) <= f.axis[1].radius * (1 + 1e-6) &&
                       fabsf(weight) == f.weight,
                   "%s: %g %g of weight %g", far[k].options, (double)p.x, (double)p.y,
                   (double)weight);
        }
    }
}

const TestCase test_filters[] = {
    { "density", density, false }, { "inverse", inverse, false },
    { "conditions", conditions, false }, { "family", family, false }, { "edge", edge, false },
    { "extremes", extremes, false }, { NULL, NULL, false }
};

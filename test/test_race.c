/* test_race.c -- races whose errors are known: the picture is a uniform number a sample, so that
 * sigma/mu of n of them is 1 / sqrt(3 n) whatever the reference, and the slope -1/2. */
#include "render/race.h"
#include "test/pictures.h"
#include "image/compare.h"

#include <stdio.h>
#include <string.h>

enum { SIDE = 72 };

static Integrator *open_even(const Scene *s, const Opts *o)
{
    Integrator *it = MEM_NEW(Integrator);
    (void)o;
    if (it)
        it->scene = s;
    return it;
}
static void close_even(Integrator *it) { mem_free(it); }

static Rgb even(const Integrator *it, const Ray *r, Tracer *t)
{
    (void)it;
    (void)r;
    return rgb_all(sample_1d(&t->sampler, DECISION(DECIDE_LIGHT, 0)));
}

/* The same with three times the spread and three times the samples' worth of error. */
static Rgb rough(const Integrator *it, const Ray *r, Tracer *t)
{
    Rgb c = even(it, r, t);
    return rgb_all(0.5f + 3.0f * (c.r - 0.5f));
}

static const IntegratorKind even_kind = {
    .info = { "even", "", "", NULL }, .truth = UNBIASED, .misses = "", .open = open_even,
    .close = close_even, .radiance = even
};
static const IntegratorKind rough_kind = {
    .info = { "rough", "", "", NULL }, .truth = UNBIASED, .misses = "", .open = open_even,
    .close = close_even, .radiance = rough
};

static void start(Lab *l, RenderSettings *s, RaceOrder *o)
{
    messages_quiet(true);
    lab_init(l);
    lab_quad(l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0), lab_material(l, "diffuse", ""));
    lab_light(l, "infinite", "", NULL);
    lab_camera(l, v3(0, -5, 2), v3(0, 0, 0.5f), 40, "");
    lab_build(l);
    picture_settings(l, s, "@random", SIDE, SIDE, 1);
    s->threads = 2;
    s->seed = 5;
    memset(o, 0, sizeof *o);
    o->request.max_pixels = IMAGE_PIXELS_DEFAULT;
    o->nmethods = 2;
    o->method[0].label = "even";
    o->method[0].integrator = &even_kind;
    o->method[1].label = "rough";
    o->method[1].integrator = &rough_kind;
    o->reference_method.integrator = &even_kind;
}

/* The error of P pixels has a relative deviation of about sqrt(kurtosis - 1) / (2 sqrt(P)): below
 * 0.007 here. What the noise of the reference adds to the deviation is below twice that again. */
static void expect_known(const Race *race, int points, double bound, const char *what)
{
    REQUIRE(race->n == 2, "%s: %d methods", what, race->n);
    for (int i = 0; i < 2; i++) {
        const RaceResult *r = &race->result[i];
        EXPECT(r->n == points, "%s: %d points", what, r->n);
        for (int k = 0; k < r->n; k++) {
            const RacePoint *p = &r->point[k];
            double is = (i ? 3 : 1) / sqrt(3 * p->spp);
            EXPECT(p->spp == 1 << k, "%s: %g samples", what, p->spp);
            EXPECT(p->doubtful || fabs(p->sigma_over_mu / is - 1) < bound,
                   "%s: method %d, %g samples: %g, it is %g", what, i, p->spp, p->sigma_over_mu,
                   is);
            EXPECT(fabs(p->mean - 0.5) < 6 * is / SIDE, "%s: mean %g", what, p->mean);
        }
        EXPECT(r->fit.lo < -0.5 && r->fit.hi > -0.5 && r->fit.error < 0.05, "%s: slope %g (%g, %g)",
               what, r->fit.slope, r->fit.lo, r->fit.hi);
    }
}

static void pairs(void)
{
    RenderSettings s;
    RaceOrder o;
    Race race;
    Lab l;
    const double most = 64;

    start(&l, &s, &o);
    REQUIRE(race_spp_set(&o, &most, 1) && race_run(&o, l.scene, &s, &race), "race");
    expect_known(&race, 7, 0.035, "pairs");
    EXPECT(race.result[0].point[3].relmse == INFINITY && !race.noise_known, "no reference");
    /* The rough one gets to what the even one has at 64 samples after 9 * 64: not in this race. */
    EXPECT(race.goal == race.result[0].point[6].sigma_over_mu && race.result[0].reach_is == 0 &&
           race.result[0].reach == race.result[0].point[6].cpu_seconds &&
           race.result[1].reach_is == 1, "goal");
    lab_clear(&l);
}

/* A reference of two halves of 16 samples: its own noise is that of 32 samples, more than that of a
 * method's 64. Without taking it off, the error at 16 samples would be sqrt(3/2) of what it is. */
static void noisy_reference(void)
{
    RenderSettings s;
    RaceOrder o;
    Race race;
    Lab l;
    const double most = 64;

    start(&l, &s, &o);
    o.reference = REFERENCE_AUTO;
    o.reference_spp = 16;
    REQUIRE(race_spp_set(&o, &most, 1) && race_run(&o, l.scene, &s, &race), "race");
    EXPECT(race.noise_known && fabs(race.noise_over_mu * sqrt(3 * 32.0) - 1) < 0.035, "noise %g",
           race.noise_over_mu);
    expect_known(&race, 7, 0.05, "auto");
    EXPECT(race.result[0].point[6].doubtful && !race.result[0].point[4].doubtful &&
           !race.result[1].point[6].doubtful, "what is doubtful");
    lab_clear(&l);
}

/* A picture of the truth, plus grey noise of deviation `spread` if any. */
static void write_reference(const char *path, double spread, uint64_t seed)
{
    Display plain = { 0 };
    Rng rng = rng_seed(seed);
    Image im;

    REQUIRE(image_init(&im, SIDE, SIDE), "memory");
    for (int i = 0; i < SIDE * SIDE; i++)
        im.pixels[i] = rgb_all((float)(0.5 + spread * sqrt(12.0) * ((double)rng_unit(&rng) - 0.5)));
    REQUIRE(image_write(&im, path, &plain), "%s", path);
    image_clear(&im);
}

static void files(void)
{
    static char one[300], two[300], small[300];
    RenderSettings s;
    RaceOrder o;
    Race race;
    Lab l;
    const double most = 64;

    start(&l, &s, &o);
    snprintf(one, sizeof one, "%s/one.pfm", test_folder());
    snprintf(two, sizeof two, "%s/two.pfm", test_folder());
    snprintf(small, sizeof small, "%s/small.pfm", test_folder());
    o.reference = REFERENCE_FILES;
    o.reference_file[0] = one;
    write_reference(one, 0, 1);
    REQUIRE(race_spp_set(&o, &most, 1) && race_run(&o, l.scene, &s, &race), "race");
    EXPECT(!race.noise_known && fabs(race.mean - 0.5) < 1e-6, "the truth has mean %g", race.mean);
    expect_known(&race, 7, 0.035, "one file");
    write_reference(one, 0.1, 1);
    write_reference(two, 0.1, 2);
    o.reference_file[1] = two;
    REQUIRE(race_run(&o, l.scene, &s, &race), "race");
    EXPECT(race.noise_known && fabs(race.noise_over_mu - 0.2 * sqrt(0.5)) < 0.005, "noise %g",
           race.noise_over_mu);
    expect_known(&race, 7, 0.06, "two files");
    s.crop[2] = SIDE / 2;
    EXPECT(!race_run(&o, l.scene, &s, &race) && err_status() == STATUS_INPUT && race.n == 0,
           "a reference of another size");
    lab_clear(&l);
}

/* ---- time ---- */

/* Nothing is said of how fast it is: checkpoints rise, and the last is no earlier than its time. */
static void by_time(void)
{
    RenderSettings s;
    RaceOrder o;
    Race race;
    Lab l;
    const double last = 0.064;

    start(&l, &s, &o);
    o.reference = REFERENCE_AUTO;
    o.reference_spp = 64;
    REQUIRE(race_seconds_set(&o, &last, 1) && o.nseconds == 8 && o.seconds[0] == 0.0005, "times");
    REQUIRE(race_run(&o, l.scene, &s, &race), "race");
    REQUIRE(race.n == 2, "%d methods", race.n);
    for (int i = 0; i < 2; i++) {
        const RaceResult *r = &race.result[i];
        EXPECT(r->n >= 1 && r->n <= 8 && r->point[r->n - 1].seconds >= last, "%d points", r->n);
        for (int k = 1; k < r->n; k++)
            EXPECT(r->point[k].spp > r->point[k - 1].spp &&
                   r->point[k].seconds > r->point[k - 1].seconds, "point %d", k);
    }
    lab_clear(&l);
}

/* ---- samplers that plan ---- */

static bool plan(Sampler *s, const Opts *o, uint32_t *spp)
{
    (void)s;
    (void)o;
    (void)spp;
    return true;
}

/* Numbers that depend on how many are planned; each sample of them is independent all the same. */
static float planned_one(Sampler *s, Decision d)
{
    return unit_of((uint32_t)(draw64(key_with(s->key, s->spp), d) >> 32));
}

static V2 planned_two(Sampler *s, Decision d)
{
    float x = planned_one(s, d + 1000);
    return (V2){ x, planned_one(s, d + 2000) };
}

static const SamplerKind planner = {
    .info = { "planner", "", "", NULL }, .init = plan, .one = planned_one, .two = planned_two
};

static void plans(void)
{
    RenderSettings s;
    RaceOrder o;
    RaceMethod m = { .integrator = &even_kind };
    Race race;
    Lab l;
    bool yes;
    const double most = 64;

    start(&l, &s, &o);
    for (int k = 0; samplers[k]; k++) {
        m.sampler = samplers[k];
        opts_default(&m.sampler_opts, samplers[k]->info.options);
        REQUIRE(race_sampler_plans(&m, 1, 64, &yes), "%s", samplers[k]->info.name);
        EXPECT(!yes || (strcmp(samplers[k]->info.name, "random") &&
                        strcmp(samplers[k]->info.name, "zerotwo")), "%s", samplers[k]->info.name);
    }
    s.sampler = &planner;
    REQUIRE(race_spp_set(&o, &most, 1) && race_run(&o, l.scene, &s, &race), "race");
    EXPECT(race.result[0].fresh && race.result[1].fresh, "it was not noticed");
    expect_known(&race, 7, 0.035, "fresh");
    lab_clear(&l);
}

/* Every sampler's points depend on the seed, but for those that are told to be fixed. */
static void seeds(void)
{
    static const char *const fixed[] = { "path@halton:randomize=none", "path@sobol:randomize=none",
                                         "path@zerotwo:randomize=none" };
    const uint32_t counts[] = { 1, 16, 0 };
    Arena arena = { 0 };
    RaceMethod m = { .integrator = &even_kind };
    bool yes;

    messages_quiet(true);
    for (int n = 0; n < 3; n++) {
        for (int k = 0; samplers[k]; k++) {
            m.sampler = samplers[k];
            opts_default(&m.sampler_opts, samplers[k]->info.options);
            REQUIRE(race_sampler_seeded(&m, counts[n], &yes), "%s", samplers[k]->info.name);
            EXPECT(yes, "%s, %d samples", samplers[k]->info.name, (int)counts[n]);
        }
        for (int k = 0; k < 3; k++) {
            RaceMethod f;
            REQUIRE(race_method_parse(&f, fixed[k], &arena) &&
                    race_sampler_seeded(&f, counts[n], &yes), "%s", fixed[k]);
            EXPECT(!yes, "%s, %d samples", fixed[k], (int)counts[n]);
        }
    }
    arena_clear(&arena);
}

/* ---- orders ---- */

static void methods(void)
{
    Arena arena = { 0 };
    RaceMethod m;

    REQUIRE(race_method_parse(&m, "path:strategy=implicit,maxdepth=3@random", &arena), "both");
    EXPECT(!strcmp(m.integrator->info.name, "path") && !strcmp(m.sampler->info.name, "random") &&
           opt_is(&m.integrator_opts, "strategy", "implicit") &&
           opt_int(&m.integrator_opts, "maxdepth") == 3 &&
           !strcmp(m.label, "path:strategy=implicit,maxdepth=3@random"), "both: %s", m.label);
    REQUIRE(race_method_parse(&m, "ao", &arena) && !m.sampler, "no sampler");
    EXPECT(!race_method_parse(&m, "ao@", &arena) && !race_method_parse(&m, "@random", &arena) &&
           !race_method_parse(&m, "", &arena) && !race_method_parse(&m, "path:x=1", &arena) &&
           !race_method_parse(&m, "path@random@random", &arena), "wrong ones");
    arena_clear(&arena);
}

static void lists(void)
{
    const double falls[] = { 1, 4, 4 }, broken[] = { 1, 2.5 }, good[] = { 1, 10, 100 };
    const double hundred = 100;
    double many[RACE_LOOKS + 1];
    static RaceOrder o;

    REQUIRE(race_spp_set(&o, &hundred, 1) && o.nspp == 8 && o.spp[6] == 64 && o.spp[7] == 100,
            "100");
    REQUIRE(race_spp_set(&o, good, 3) && o.nspp == 3 && o.spp[2] == 100, "a list");
    for (int i = 0; i <= RACE_LOOKS; i++)
        many[i] = i + 1;
    EXPECT(!race_spp_set(&o, falls, 3) && !race_spp_set(&o, broken, 2) &&
           !race_spp_set(&o, many, RACE_LOOKS + 1) && race_spp_set(&o, many, RACE_LOOKS) &&
           !race_seconds_set(&o, falls, 3) && race_seconds_set(&o, broken, 2) &&
           !race_autosave_set(&o, falls, 3) && !race_spp_set(&o, many, 0), "wrong lists");
}

static void picture_names(void)
{
    static const struct { const char *output, *label, *name; int method; double seconds; } c[] = {
        { "a/plates.pfm", "mis@halton", "a/plates-2-mis_halton.pfm", 1, -1 },
        { "plates.png", "path:k=1/2", "plates-1-path_k_1_2-20s.png", 0, 20 },
        { "p.x.hdr", "../\xC3\xA4", "p.x-16-_____-0.5s.hdr", 15, 0.5 },
        { "plain", "", "plain-1-", 0, -1 },
    };
    for (size_t i = 0; i < sizeof c / sizeof *c; i++) {
        char *name = race_picture_name(c[i].output, c[i].method, c[i].label, c[i].seconds);
        REQUIRE(name && !strcmp(name, c[i].name), "'%s', not '%s'", name, c[i].name);
        mem_free(name);
    }
}

const TestCase test_race[] = {
    { "pairs", pairs, false },
    { "noisy_reference", noisy_reference, false },
    { "files", files, false },
    { "by_time", by_time, false },
    { "plans", plans, false },
    { "seeds", seeds, false },
    { "methods", methods, false },
    { "lists", lists, false },
    { "picture_names", picture_names, false },
    { NULL, NULL, false }
};

/* test_lightsampling.c -- which light: what `pick` does is what `pmf` says, by going through u. */
#include "base/random.h"
#include "geometry/generate.h"
#include "lightsampling/lightsampler.h"
#include "test/chi2.h"
#include "test/physics.h"

static LightSampler *open_sampler(const Scene *s, const LightSamplerKind *k)
{
    LightSampler *ls;
    Opts none;
    opts_default(&none, k->info.options);
    ls = k->open(s, &none);
    REQUIRE(ls, "light sampler %s", k->info.name);
    ls->kind = k;
    return ls;
}

/* Every u of a fine grid: the share of each light is its pmf, and what is left of u is uniform. */
static void expect_choice(const Lab *l, const LightSamplerKind *k, V3 n, const double *share)
{
    enum { N = 1 << 18, LEFT = 64, MOST = 8 };
    LightSampler *ls = open_sampler(l->scene, k);
    double count[MOST] = { 0 }, expected[LEFT], sum = 0, p_left;
    uint64_t left_count[LEFT] = { 0 };
    size_t count_of = l->scene->nlights;

    for (uint32_t i = 0; i < N; i++) {
        float u = (float)i / N, pmf, left;
        const Light *light = k->pick(ls, v_all(0), n, u, &pmf, &left);
        REQUIRE(light, "%s: no light for u = %g", k->info.name, (double)u);
        EXPECT(pmf > 0 && pmf == k->pmf(ls, v_all(0), n, light),
               "%s: pick says %.9g, pmf another", k->info.name, (double)pmf);
        EXPECT(left >= 0 && left < 1, "%s: left %.9g", k->info.name, (double)left);
        count[light->index] += 1.0 / N;
        left_count[(int)(left * LEFT)]++;
    }
    for (size_t i = 0; i < count_of; i++) {
        double pmf = (double)k->pmf(ls, v_all(0), n, l->scene->lights[i]);
        sum += pmf;
        EXPECT(fabs(pmf - share[i]) <= 2e-6 && fabs(count[i] - pmf) <= 1.5 / N,
               "%s: light %d has pmf %.9g and count %.9g, expected %.9g", k->info.name, (int)i, pmf,
               count[i], share[i]);
    }
    EXPECT(fabs(sum - 1) < 1e-6, "%s: the pmf sums to %.9g", k->info.name, sum);
    for (int i = 0; i < LEFT; i++)
        expected[i] = (double)N / LEFT;
    p_left = chi2_counts(expected, left_count, LEFT);
    EXPECT(p_left >= CHI2_P_MIN, "%s: what is left of u is not uniform, p = %g", k->info.name,
           p_left);
    k->close(ls);
}

static void choice(void)
{
    static const double by_power[] = { 1 / 18.0, 0, 5 / 18.0, 8 / 18.0, 4 / 18.0 };
    static const double alike[] = { 0.2, 0.2, 0.2, 0.2, 0.2 };
    const LightSamplerKind *power = kind_find(lightsamplers, "power");
    const LightSamplerKind *uniform = kind_find(lightsamplers, "uniform");
    Lab l;

    lab_init(&l);
    lab_light(&l, "point", "I=1", NULL);
    lab_light(&l, "point", "I=0", NULL);
    lab_light(&l, "point", "I=5", NULL);
    lab_light(&l, "point", "I=8", NULL);
    lab_shine(&l, lab_quad(&l, v_all(0), v3(4, 0, 0), v3(0, 4, 0), 0), "L=1");  /* as I = 4 */
    lab_build(&l);
    expect_choice(&l, power, v3(0, 0, 1), by_power);
    expect_choice(&l, uniform, v3(0, 0, 1), alike);
    lab_clear(&l);
}

/* By what each brings to the origin: points by I cos / d^2, a small far ball by pi L (R / d)^2 cos,
 * a sky by pi L; and from all round, as in a medium, without cosines and by 4 pi L. */
static void contributions(void)
{
    const LightSamplerKind *k = kind_find(lightsamplers, "contribution");
    double E[2][6] = { { 1.0 / 4, 0, 8 * 0.6 / 25, 0, 3 * PI * 0.8e-4, 0.01 * PI },
                       { 1.0 / 4, 3, 8.0 / 25, 0, 3 * PI * 1e-4, 0.01 * 4 * PI } };
    Lab l;

    lab_init(&l);
    lab_light(&l, "point", "I=1,from=0/0/2", NULL);
    lab_light(&l, "point", "I=3,from=0/0/-1", NULL);            /* below the horizon */
    lab_light(&l, "point", "I=8,from=4/0/3", NULL);
    lab_light(&l, "spot", "I=8,from=0/0/3,to=0/3/3,coneangle=20", NULL);       /* looks past it */
    lab_shine(&l, lab_sphere(&l, v3(3, 0, 4), 0.05f, 0, false), "L=3");
    lab_light(&l, "infinite", "L=0.01", NULL);
    lab_build(&l);
    for (int j = 0; j < 2; j++) {
        double sum = 0;
        for (int i = 0; i < 6; i++)
            sum += E[j][i];
        for (int i = 0; i < 6; i++)
            E[j][i] /= sum;
        expect_choice(&l, k, j ? v_all(0) : v3(0, 0, 1), E[j]);
    }
    lab_clear(&l);
}

/* The default goes by the number of lights. */
static void by_number(void)
{
    Lab l;

    lab_init(&l);
    for (int i = 0; i < 65; i++) {
        const char *best = i == 1 ? "uniform" : "contribution";
        EXPECT(lightsampler_named("auto", l.scene) == kind_find(lightsamplers, best) &&
                   lightsampler_named("power", l.scene) == kind_find(lightsamplers, "power"),
               "with %d lights", i);
        lab_light(&l, "point", "I=1", NULL);
    }
    EXPECT(lightsampler_named("auto", l.scene) == kind_find(lightsamplers, "power"), "65 lights");
    lab_clear(&l);
}

/* ---- estimates ---- */

static uint32_t zoo(Lab *l)
{
    uint32_t i;
    Mesh m = { 0 };
    Rng rng = rng_seed(3);

    lab_init(l);
    lab_shine(l, lab_quad(l, v3(-1, -1, 0), v3(2, 0, 0), v3(0, 2, 0), 0), "L=1");
    lab_shine(l, lab_quad(l, v3(-1, -1, 0), v3(2, 0, 0), v3(0, 2, 0), 0), "L=1,twosided");
    lab_shine(l, lab_quad(l, v3(-1, 0, 0), v3(1, 0, 1), v3(0, 3, 0), 0), "L=1,exponent=40");
    lab_shine(l, lab_disk(l, v3(0, 0, 0.5f), v3(1, 2, 3), 1.2f, 0.4f, 0), "L=1");
    lab_shine(l, lab_sphere(l, v3(0.3f, 0, 0), 0.8f, 0, false), "L=1");
    lab_shine(l, lab_sphere(l, v3(0.3f, 0, 0), 0.8f, 0, true), "L=1");
    lab_shine(l, lab_zone(l, v3(0, 0, 0), 1, -0.2f, 0.7f, 0, false), "L=1,twosided");
    REQUIRE(mesh_cube(&m), "cube");
    lab_shine(l, lab_mesh(l, &m, 0, false), "L=1");
    REQUIRE(mesh_blob(&m, 2), "blob");
    for (i = 0; i < m.nverts; i++)              /* nearly flat, with folds */
        m.p[i].z *= 0.01f * rng_unit(&rng);
    lab_shine(l, lab_mesh(l, &m, 0, false), "L=1");
    lab_light(l, "point", "I=1", NULL);
    lab_light(l, "spot", "I=1,from=0/0/1,to=1/1/0", NULL);
    lab_light(l, "distant", "L=1", NULL);
    lab_light(l, "infinite", "L=1", NULL);
    lab_light(l, "sky", "", NULL);
    lab_build(l);
    return (uint32_t)l->scene->nlights;
}

/* Wherever a light sends anything to the front of a surface, its estimate is above 0. */
static void nothing_lost(void)
{
    enum { POINTS = 3000, DRAWS = 8 };
    static const float scale[] = { 0.3f, 1, 2, 30 };
    Rng rng = rng_seed(4);
    Lab l;
    uint32_t members = zoo(&l);

    for (int i = 0; i < POINTS; i++) {
        V3 a = v3(rng_unit(&rng), rng_unit(&rng), rng_unit(&rng)), p, n;
        a = v_sub(v_scale(a, 2), v_all(1));
        p = v_scale(a, scale[i % 4]);
        n = v_unit(v3(rng_unit(&rng) - 0.5f, rng_unit(&rng) - 0.5f, rng_unit(&rng) - 0.5f));
        for (uint32_t k = 0; k < members; k++) {
            const Light *light = l.scene->lights[k];
            float e = light_estimate(light, p, n), all = light_estimate(light, p, v_all(0));
            EXPECT(is_finite(e) && e >= 0 && is_finite(all), "light %lu: %g", (unsigned long)k,
                   (double)e);
            for (int j = 0; j < DRAWS; j++) {
                LightSample s;
                V2 u = { rng_unit(&rng), 0 };
                u.y = rng_unit(&rng);
                if (light->kind->sample(light, p, u, &s) && !rgb_black(s.L))
                    EXPECT(all > 0 && (e > 0 || v_dot(n, s.wi) <= 1e-6f),
                           "light %lu shines on point %d, estimates %g and %g", (unsigned long)k,
                           i, (double)e, (double)all);
            }
        }
    }
    lab_clear(&l);
}

/* No light, and lights that give nothing. */
static void no_light(void)
{
    for (int k = 0; k < 2; k++)
        for (int i = 0; lightsamplers[i]; i++) {
            LightSampler *ls;
            const Light *light;
            float pmf = 0, left;
            Lab l;
            lab_init(&l);
            if (k)
                lab_light(&l, "point", "I=0", NULL);
            lab_build(&l);
            ls = open_sampler(l.scene, lightsamplers[i]);
            light = ls->kind->pick(ls, v_all(0), v3(0, 0, 1), 0.5f, &pmf, &left);
            EXPECT(!light || (k && pmf == 1), "%s: a light was picked", ls->kind->info.name);
            ls->kind->close(ls);
            lab_clear(&l);
        }
}

const TestCase test_lightsampling[] = {
    { "choice", choice, false },
    { "contributions", contributions, false },
    { "by_number", by_number, false },
    { "nothing_lost", nothing_lost, false },
    { "no_light", no_light, false },
    { NULL, NULL, false }
};

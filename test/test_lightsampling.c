/* test_lightsampling.c -- which light: what `pick` does is what `pmf` says, by going through u. */
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
static void expect_choice(const Lab *l, const LightSamplerKind *k, const double *share)
{
    enum { N = 1 << 18, LEFT = 64, MOST = 8 };
    LightSampler *ls = open_sampler(l->scene, k);
    double count[MOST] = { 0 }, expected[LEFT], sum = 0, p_left;
    uint64_t left_count[LEFT] = { 0 };
    size_t n = l->scene->nlights;

    for (uint32_t i = 0; i < N; i++) {
        float u = (float)i / N, pmf, left;
        const Light *light = k->pick(ls, v_all(0), v3(0, 0, 1), u, &pmf, &left);
        REQUIRE(light, "%s: no light for u = %g", k->info.name, (double)u);
        EXPECT(pmf > 0 && pmf == k->pmf(ls, v_all(0), v3(0, 0, 1), light),
               "%s: pick says %.9g, pmf another", k->info.name, (double)pmf);
        EXPECT(left >= 0 && left < 1, "%s: left %.9g", k->info.name, (double)left);
        count[light->index] += 1.0 / N;
        left_count[(int)(left * LEFT)]++;
    }
    for (size_t i = 0; i < n; i++) {
        double pmf = (double)k->pmf(ls, v_all(0), v3(0, 0, 1), l->scene->lights[i]);
        sum += pmf;
        EXPECT(fabs(pmf - share[i]) <= 1e-6 && fabs(count[i] - pmf) <= 1.5 / N,
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
    expect_choice(&l, power, by_power);
    expect_choice(&l, uniform, alike);
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
    { "no_light", no_light, false },
    { NULL, NULL, false }
};

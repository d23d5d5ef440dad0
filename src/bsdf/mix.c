/* mix.c -- two models side by side on one surface: dust on glass, worn paint, anything faded into
 * anything by a texture.
 *
 * Idea    f = a f_1 + (1 - a) f_2 with the amount a, a colour: linear in both, so that it keeps
 *         energy, reciprocity and the adjoint wherever its parts do. Parts may be mixtures.
 *         A part is chosen with probability p = the luminance of a; what is left of the number
 *         that chose is passed on to it. The density of smooth events is the mixture of both; delta
 *         events keep their weight, times a / p. */
#include "bsdf/bsdf.h"

typedef struct {
    const Bsdf *part[2];        /* borrowed; NULL: black */
    Rgb   amount;               /* of the first */
    float p;
} Mix;

static const Mix *of(const Bsdf *b) { return (const Mix *)(const void *)b->as.number; }

static void setup(Bsdf *b, const Rgb *value, const void *data)
{
    Mix *m = (Mix *)(void *)b->as.number;
    (void)data;
    m->part[0] = m->part[1] = NULL;
    m->amount = reflectance_of(value[0]);
    m->p = f_min(rgb_lum(m->amount), 1.0f);
    if (!(rgb_max(rgb_sub(rgb_all(1.0f), m->amount)) > 0.0f))   /* the weights may add up to less */
        m->p = 1.0f;
}

void mix_parts(Bsdf *b, const Bsdf *first, const Bsdf *second)
{
    Mix *m = (Mix *)(void *)b->as.number;
    m->part[0] = first;
    m->part[1] = second;
    b->flags = BSDF_LOBES | (m->p > 0.0f ? first->flags : 0) | (m->p < 1.0f ? second->flags : 0);
}

static Rgb share(const Mix *m, int k)
{
    return k == 0 ? m->amount : rgb_sub(rgb_all(1.0f), m->amount);
}
static float chance(const Mix *m, int k) { return k == 0 ? m->p : 1.0f - m->p; }

static Rgb eval(const Bsdf *b, V3 wo, V3 wi, bool importance)
{
    const Mix *m = of(b);
    Rgb sum = rgb_all(0.0f);
    for (int k = 0; k < 2 && m->part[0]; k++)
        if (chance(m, k) > 0.0f) {
            const Bsdf *part = m->part[k];
            sum = rgb_add(sum, rgb_mul(share(m, k), part->kind->eval(part, wo, wi, importance)));
        }
    return sum;
}

static float pdf_w(const Bsdf *b, V3 wo, V3 wi)
{
    const Mix *m = of(b);
    float sum = 0.0f;
    for (int k = 0; k < 2 && m->part[0]; k++)
        if (chance(m, k) > 0.0f)
            sum += chance(m, k) * m->part[k]->kind->pdf_w(m->part[k], wo, wi);
    return sum;
}

static bool sample(const Bsdf *b, V3 wo, float lobe, V2 u, bool importance, BsdfSample *s)
{
    const Mix *m = of(b);
    int k = !(lobe < m->p);
    float p = chance(m, k), rest = (k == 0 ? lobe : lobe - m->p) / p;
    const Bsdf *part = m->part[k];

    if (!part || !(p > 0.0f) ||
        !part->kind->sample(part, wo, f_min(rest, ONE_MINUS_ULP), u, importance, s))
        return false;
    if (s->flags & BSDF_SPECULAR) {
        s->weight = rgb_mul(s->weight, rgb_scale(share(m, k), 1.0f / p));
        return true;
    }
    s->pdf_w = pdf_w(b, wo, s->wi);
    s->weight = rgb_scale(eval(b, wo, s->wi, importance), fabsf(s->wi.z) / s->pdf_w);
    return s->pdf_w > 0.0f;
}

static int deltas(const Bsdf *b, V3 wo, BsdfSample s[BSDF_DELTAS])
{
    const Mix *m = of(b);
    int n = 0;
    for (int k = 0; k < 2 && m->part[0]; k++)
        if (chance(m, k) > 0.0f)
            for (int end = n + bsdf_deltas(m->part[k], wo, s + n); n < end; n++)
                s[n].weight = rgb_mul(s[n].weight, share(m, k));
    return n;
}

static Rgb albedo(const Bsdf *b, V3 wo)
{
    const Mix *m = of(b);
    Rgb sum = rgb_all(0.0f);
    for (int k = 0; k < 2 && m->part[0]; k++)
        sum = rgb_add(sum, rgb_mul(share(m, k), m->part[k]->kind->albedo(m->part[k], wo)));
    return sum;
}

/* Those of both parts, as many as there is room for: half each, or more where one has fewer. */
static int peaks(const Bsdf *b, V3 wo, V3 peak[16])
{
    const Mix *m = of(b);
    V3 mine[2][16];
    int n[2] = { 0, 0 }, have = 0;

    for (int k = 0; k < 2 && m->part[0]; k++)
        n[k] = m->part[k]->kind->peaks(m->part[k], wo, mine[k]);
    for (int i = 0; i < 16; i++)
        for (int k = 0; k < 2; k++)
            if (i < n[k] && have < 16)
                peak[have++] = mine[k][i];
    return have;
}

static const OptDef options[] = {
    { .key = "amount", .type = OPT_RGB, .num = 0.5, .lo = 0, .hi = 1,
      .help = "how much of the first material there is; the rest is the second" },
    { .key = NULL }
};

const BsdfKind bsdf_mix = {
    .info = { "mix", "Cline07 5.2.2", "two materials by their names, side by side", options },
    .flags = BSDF_REFLECT | BSDF_TRANSMIT | BSDF_SPECULAR | BSDF_SMOOTH | BSDF_LOBES |
             BSDF_TANGENT | BSDF_MATT,
    .setup = setup, .eval = eval, .pdf_w = pdf_w, .sample = sample, .deltas = deltas,
    .albedo = albedo, .peaks = peaks
};

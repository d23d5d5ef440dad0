/* direct_cut.c -- direct light by point lights: bidirectional importance sampling from illumination
 * cuts, and what it is compared with.
 *
 * Source      [Wang09]; errata 002.1 to 002.5. All light is made into point lights once
 *             (lightsampling/pointlights.h), and one cut through their tree serves the picture
 *             (lighttree.h). For each turn the clusters of the cut get probabilities
 *             (lightcut.h), by `brdf`:
 *                 counts      rays by the BSDF counted in clusters, and a matt term: the source's
 *                 single      the BSDF at the middle of each cluster [Wang09 3.3]
 *                 none        light alone [Wang09 3.2]
 *                 all         no choice: all point lights are asked. The source's reference
 *             and `samples` lights are chosen, by equal steps through the pmf. With judged > 1, so
 *             many times as many are tried, judged without rays, and resampled, as sir does it.
 * Sir         [Wang09 5, fig. 8]: `tentative` lights by their light alone, judged without rays, of
 *             which `samples` are kept and looked at.
 * Truth       jitter=true: a light is chosen, then a place in its cell. The estimate is that of all
 *             light of lamps and sky, without bias: no cell has probability 0. jitter=false, as in
 *             the source: the sum over the points, without bias; what the points themselves are
 *             off by, bench/cuts.c measures. Indirect light has no cells: always the sum.
 * Departs     Counts are not all trusted (errata 002.1): 3 % of the energy of lobes counts as matt,
 *             and `safe` of all choices go by light alone. safe=0: neither. With prior=0 as well
 *             clusters that no ray found are lost, as in the source, if nothing is matt: a test
 *             has how much. The source as printed is safe=0,prior=0,extent=0,within=even,boxes=true
 *             (but for errata 002.2 to 002.4).
 * Delta       Point, spot and distant lights are asked one by one, each by a ray. */
#include "integrators/direct.h"

#include "base/mem.h"
#include "lightsampling/lightcut.h"

typedef enum { BRDF_COUNTS, BRDF_SINGLE, BRDF_NONE, BRDF_ALL } CutBrdf;         /* by choices */

typedef struct {
    PointLights lights;         /* owned, all of them */
    LightTree tree;
    LightCut cut;
    CutBrdf brdf;
    Indirect indirect;
    int rays, samples;
    int tentative;              /* tried: as many as samples, if none is judged beforehand */
    float safe, prior;
} Cut;

static const float SPREAD = 0.03f;       /* of lobes, as if they were matt; with safe=0: none */

/* ---- opening ---- */

static void close_cut(Direct *it)
{
    Cut *c = it->own;

    if (!c)
        return;
    lightcut_clear(&c->cut);
    lighttree_clear(&c->tree);
    pointlights_clear(&c->lights);
    mem_free(c);
    it->own = NULL;
}

/* False: warnings are fatal. */
static bool warn_of_points(bool jitter, Indirect indirect)
{
    static const Place nowhere = { NULL, 0, 0 };

    if (!jitter && !warn_at(nowhere, "jitter=false is biased: point lights stand for all light"))
        return false;
    return indirect == INDIRECT_NO ||
           warn_at(nowhere, "indirect light is biased: it comes from points, alike on all sides");
}

static bool open_points(Direct *it, const Opts *o, size_t most, WithinCluster within)
{
    CutRule rule = { most, opt_float(o, "sigma"), opt_float(o, "extent") };
    Cut *c = it->own = MEM_NEW(Cut);

    if (!c)
        return false;
    c->brdf = (CutBrdf)opt_choice(o, "brdf");
    c->indirect = (Indirect)opt_choice(o, "indirect");
    c->rays = (int)opt_int(o, "rays");
    c->samples = (int)opt_int(o, "samples");
    if (c->rays == 0)
        c->rays = c->samples > 32 ? 2 * c->samples : 64;
    c->safe = opt_float(o, "safe");
    c->prior = opt_float(o, "prior");
    return warn_of_points(opt_bool(o, "jitter"), c->indirect) &&
           pointlights_init(&c->lights, it->base.scene, (size_t)opt_int(o, "points"),
                            opt_bool(o, "jitter"), c->indirect) &&
           lighttree_init(&c->tree, &c->lights) &&
           lightcut_init(&c->cut, &c->tree, &rule, opt_bool(o, "boxes"), within);
}

static bool open_cut(Direct *it, const Opts *o)
{
    if (open_points(it, o, (size_t)opt_int(o, "clusters"),
                    (WithinCluster)opt_choice(o, "within"))) {
        Cut *c = it->own;
        int64_t tried = (int64_t)c->samples * opt_int(o, "judged");
        c->tentative = tried < SIR_MOST ? (int)tried : SIR_MOST;
        return true;
    }
    close_cut(it);
    return false;
}

/* Lights are drawn by their own values: any cut will do. */
static bool open_sir(Direct *it, const Opts *o)
{
    if (open_points(it, o, 1, WITHIN_BY_LIGHT)) {
        ((Cut *)it->own)->tentative = (int)opt_int(o, "tentative");
        return true;
    }
    close_cut(it);
    return false;
}

/* ---- probabilities ---- */

/* What rays by the scattering say: energies of lobes by cluster, and what is matt on both sides. */
typedef struct { float above, below, lobes; } Albedo;

static Albedo count_rays(const Cut *c, const Turn *u, Tracer *t, float *energy_of)
{
    Draw draw, first = draw_first(t, u, DECIDE_TRY_LOBE, DECIDE_TRY_DIRECTION);
    Albedo a = { 0, 0, 0 };
    BsdfSample bs;

    for (int i = 0; i < c->rays; i++) {
        float energy;
        draw = draw_number(&first, (uint32_t)i);
        if (!turn_sample(u, draw.choice, draw.point, &bs) || !(bs.pdf_w > 0.0f))
            continue;
        energy = rgb_lum(bs.weight) / (float)c->rays;
        if (!(bs.flags & BSDF_MATT)) {
            a.lobes += energy;
            lightcut_count(&c->cut, u->p, bs.wi, energy, energy_of);
        } else if (v_dot(bs.wi, u->v->frame.n) > 0.0f)
            a.above += energy;
        else
            a.below += energy;
    }
    return a;
}

static void by_counts(const Cut *c, const Turn *u, Tracer *t, float *weight)
{
    enum { KINDS = BSDF_MATT | BSDF_LOBES | BSDF_TRANSMIT };
    int flags = u->v ? u->v->b->flags : 0;
    Albedo a = { 0, 0, 1 };
    float part = 1.0f;

    if ((flags & KINDS) != BSDF_MATT) { /* else rays would say no more: matt, and above */
        a = count_rays(c, u, t, weight);
        lightcut_lobes(&c->cut, u->p, c->prior, a.lobes / (float)c->rays, weight);
        part = c->safe > 0.0f ? SPREAD : 0.0f;
    }
    if (!u->v)
        return;
    if (flags & BSDF_TRANSMIT || u->v->wo.z > 0.0f)
        a.above += part * a.lobes;
    if (flags & BSDF_TRANSMIT || u->v->wo.z < 0.0f)
        a.below += part * a.lobes;
    if (a.above > 0.0f || a.below > 0.0f)
        lightcut_matt(&c->cut, u->p, u->v->frame.n, a.above, a.below, weight);
}

static void by_middles(const Cut *c, const Turn *u, float *weight)
{
    for (size_t k = 0; k < c->cut.n; k++) {
        Rgb f_cos;
        V3 wi;
        float omega = lightcut_middle(&c->cut, k, u->p, &wi);
        if (turn_f_cos(u, wi, &f_cos, NULL))
            weight[k] = c->cut.lum[k] * omega * rgb_lum(f_cos);
    }
}

/* ---- light ---- */

static Rgb looked_at(const Cut *c, const Turn *u, size_t i, Candidate *seen, Tracer *t)
{
    if (UNLIKELY(t->tally != NULL) && c->lights.p[i].kind == POINT_ON_SURFACE) {
        Turn farther = *u;              /* one edge more */
        farther.at++;
        return candidate_light(seen, &farther, t);
    }
    return candidate_light(seen, u, t);
}

/* Point light i at a place of its own by `place`, taken own times. */
static Rgb one_light(const Cut *c, const Turn *u, size_t i, V2 place, float own, Tracer *t)
{
    LightSample ls;
    Candidate seen;

    if (!pointlight_seen(&c->lights, i, u->p, place, &ls) ||
        !candidate_seen(u, &ls, own, &seen))
        return rgb_all(0.0f);
    return looked_at(c, u, i, &seen, t);
}

static Rgb all_lights(const Cut *c, const Turn *u, Tracer *t)
{
    Draw first = draw_first(t, u, DECIDE_LIGHT, DECIDE_LIGHT_POINT);
    Rgb sum = rgb_all(0.0f);

    for (size_t i = 0; i < c->lights.n; i++)
        sum = rgb_add(sum, one_light(c, u, i, draw_number(&first, (uint32_t)i).point, 1.0f, t));
    return sum;
}

/* Delta lights: nothing is to be chosen of them. */
static Rgb deltas(const Direct *it, const Turn *u, Tracer *t)
{
    const Scene *s = it->base.scene;
    Rgb sum = rgb_all(0.0f);
    Candidate c;

    for (size_t i = 0; i < s->nlights; i++)
        if (s->lights[i]->kind->delta &&
            candidate_of_light(&it->lighting, u, s->lights[i], 1.0f, (V2){ 0.5f, 0.5f }, 1.0f,
                               0.0f, t, &c))
            sum = rgb_add(sum, candidate_light(&c, u, t));
    return sum;
}

/* ---- the choice ---- */

/* Lights by equal steps through a pmf. */
typedef struct {
    const Cut *c;
    const Turn *u;
    const float *pmf_of;        /* by cluster */
    LitPoint lit;               /* for whom */
    Draw first;
    int  n;                     /* steps */
    size_t k;                   /* where the last one ended, for lightcut_choose */
    double before;
} Choice;

static Choice choice_of(const Cut *c, const Turn *u, const float *pmf_of, int n, Tracer *t)
{
    Choice by = { .c = c, .u = u, .pmf_of = pmf_of, .lit = { u->p, u->up }, .n = n };

    by.first = draw_first(t, u, DECIDE_LIGHT, DECIDE_LIGHT_POINT);
    return by;
}

/* Step i: the light; its pmf times the steps. */
static size_t choose(Choice *by, int i, float *own)
{
    double x = (i + (double)by->first.choice) / by->n;
    float pmf;
    size_t at = lightcut_choose(&by->c->cut, &by->lit, by->pmf_of, x, &by->k, &by->before, &pmf);

    *own = pmf * (float)by->n;
    return at;
}

static V2 place_of(const Choice *by, int i) { return draw_number(&by->first, (uint32_t)i).point; }

static Rgb by_steps(Choice *by, Tracer *t)
{
    Rgb sum = rgb_all(0.0f);

    for (int i = 0; i < by->n; i++) {
        float own;
        size_t at = choose(by, i, &own);
        sum = rgb_add(sum, one_light(by->c, by->u, at, place_of(by, i), own, t));
    }
    return sum;
}

/* ---- sampling importance resampling ---- */

static bool judge(const Choice *by, size_t light, int i, float own, Candidate *seen)
{
    LightSample ls;
    return own > 0.0f && pointlight_seen(&by->c->lights, light, by->u->p, place_of(by, i), &ls) &&
           candidate_seen(by->u, &ls, own, seen);
}

/* The steps through the sum of what was tried, as in resample.c. The kept are made again. */
static Rgb keep_some(Choice *by, const float *tried, double sum, Tracer *t)
{
    const int kept = by->c->samples;
    double at = 0.0, step = sum / kept;
    float start = sample_1d(&t->sampler, DECISION(DECIDE_KEEP, by->u->at)), own;
    Rgb light = rgb_all(0.0f);
    Candidate seen;
    int next = 0;

    for (int i = 0; i < by->n && next < kept; i++) {
        size_t number = choose(by, i, &own);
        int times = 0;
        at += (double)tried[i];
        while (next < kept && ((next + (double)start) * step < at)) {
            next++;
            times++;
        }
        if (!times || !judge(by, number, i, own, &seen))
            continue;
        seen.c = rgb_scale(seen.c, (float)(times * step / (double)tried[i]));
        light = rgb_add(light, looked_at(by->c, by->u, number, &seen, t));
    }
    return light;
}

static Rgb by_resampling(Choice *by, Tracer *t)
{
    const Choice start = *by;
    float tried[SIR_MOST];        /* luminance */
    double all = 0.0;
    Candidate seen;

    for (int i = 0; i < by->n; i++) {
        float own;
        size_t number = choose(by, i, &own);
        tried[i] = judge(by, number, i, own, &seen) ? rgb_lum(seen.c) : 0.0f;
        all += (double)tried[i];
    }
    *by = start;
    return all > 0.0 ? keep_some(by, tried, all, t) : rgb_all(0.0f);
}

/* ---- the strategies ---- */

static Rgb chosen_lights(const Cut *c, const Turn *u, Tracer *t)
{
    float weight[CUT_MOST];
    Choice by;

    memset(weight, 0, c->cut.n * sizeof weight[0]);
    if (c->brdf == BRDF_COUNTS)
        by_counts(c, u, t, weight);
    else if (c->brdf == BRDF_SINGLE)
        by_middles(c, u, weight);
    lightcut_normalize(&c->cut, c->safe, weight);
    by = choice_of(c, u, weight, c->tentative, t);
    return c->tentative > c->samples ? by_resampling(&by, t) : by_steps(&by, t);
}

static Rgb light_by_cut(const Direct *it, const Turn *u, Tracer *t)
{
    const Cut *c = it->own;
    Rgb sum = c->indirect == INDIRECT_ONLY ? rgb_all(0.0f) : deltas(it, u, t);

    if (!c->cut.n)
        return sum;
    return rgb_add(sum, c->brdf == BRDF_ALL ? all_lights(c, u, t) : chosen_lights(c, u, t));
}

static Rgb light_by_sir(const Direct *it, const Turn *u, Tracer *t)
{
    const Cut *c = it->own;
    Rgb sum = c->indirect == INDIRECT_ONLY ? rgb_all(0.0f) : deltas(it, u, t);
    Choice by;

    if (!c->cut.n)
        return sum;
    by = choice_of(c, u, c->cut.share, c->tentative, t);
    return rgb_add(sum, by_resampling(&by, t));
}

const DirectStrategy direct_cut = {
    .name = "cut",
    .finds_deltas = true, .open = open_cut, .close = close_cut, .light = light_by_cut
};
const DirectStrategy direct_sir = {
    .name = "sir",
    .finds_deltas = true, .open = open_sir, .close = close_cut, .light = light_by_sir
};

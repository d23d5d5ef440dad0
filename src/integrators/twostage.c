/* twostage.c -- two stage importance sampling at a turn. See twostage.h. */
#include "integrators/twostage.h"

#include "base/mem.h"

/* ---- the other lights ---- */

/* Stands for lights with maps in the list of the others, so that they keep their numbers. */
static bool dark_sample(const Light *l, V3 from, V2 u, LightSample *s)
{
    (void)l;
    (void)from;
    (void)u;
    (void)s;
    return false;
}
static Rgb dark_power(const Light *l)
{
    (void)l;
    return rgb_all(0.0f);
}
static float dark_estimate(const Light *l, V3 p, V3 n)
{
    (void)l;
    (void)p;
    (void)n;
    return 0.0f;
}
static const LightKind dark_kind = {
    .info = { "dark", "", "no light", NULL }, .sample = dark_sample, .pdf_w = delta_pdf_w,
    .radiance = delta_radiance, .power = dark_power, .estimate = dark_estimate
};

static bool leave_out(TwoStage *it, const Scene *s)
{
    Light *remainder = it->light ? it->light->kind->picture(it->light).remainder : NULL;

    it->remainder = remainder;
    it->rest = *s;
    it->dark.kind = &dark_kind;
    it->rest.lights = MEM_ARRAY(Light *, s->nlights);
    it->rest.infinite = MEM_ARRAY(const Light *, s->ninfinite);
    if (!it->rest.lights || !it->rest.infinite)
        return false;
    for (size_t i = 0; i < s->nlights; i++) {
        Light *l = s->lights[i] == it->light && it->remainder ? remainder : s->lights[i];
        bool other = !twostage_asks(it, l);
        it->rest.lights[i] = other ? l : &it->dark;
        it->any |= other;
        it->lamps |= other && !l->kind->delta;
    }
    it->rest.ninfinite = 0;
    for (size_t i = 0; i < s->ninfinite; i++) {
        const Light *l = s->infinite[i] == it->light ? it->remainder : s->infinite[i];
        if (l)
            it->rest.infinite[it->rest.ninfinite++] = l;
    }
    return true;
}

bool twostage_init(TwoStage *it, const Scene *s, const Opts *o, bool directions)
{
    memset(it, 0, sizeof *it);
    it->splits = (int)opt_int(o, "splits");
    it->sampled = opt_is(o, "peaks", "sampled");
    it->colour = opt_is(o, "f", "colour");
    it->light = skymap_light(s);
    if (twostage_find_asked(it, s) && leave_out(it, s) &&
        (!it->light || it->colour || skymap_init(&it->map, it->light, BY_LUMINANCE)) &&
        lighting_init(&it->others, &it->rest, o, false, directions))
        return true;
    twostage_clear(it);
    return false;
}

void twostage_clear(TwoStage *it)
{
    lighting_clear(&it->others);
    skymap_clear(&it->map);
    for (int k = 0; k < it->nasked; k++)
        lightmap_clear(&it->asked[k]);
    it->nasked = 0;
    mem_free(it->rest.lights);
    mem_free(it->rest.infinite);
    it->rest.lights = NULL;
    it->rest.infinite = NULL;
}

/* ---- a turn ---- */

static float factor(const void *of, V3 wi)
{
    Rgb f_cos;
    return turn_f_cos(of, wi, &f_cos, NULL) ? rgb_lum(f_cos) : 0.0f;
}

static int known_peaks(const Turn *u, V3 *peak)
{
    int n;

    if (!u->v) {                /* of a phase function: on, or back */
        peak[0] = u->g < 0.0f ? v_neg(u->d) : u->d;
        return 1;
    }
    n = u->v->b->kind->peaks(u->v->b, u->v->wo, peak);
    for (int i = 0; i < n; i++)
        peak[i] = frame_out(&u->v->frame, peak[i]);
    return n;
}

/* [Cline07 5.2.2]: a quarter as many as there will be samples. They are drawn by numbers of their
 * own: what the partition is must not depend on the points that it will warp. */
static int sampled_peaks(const Turn *u, int samples, Tracer *t, V3 *peak)
{
    Draw draw, first = draw_first(t, u, DECIDE_TRY_LOBE, DECIDE_TRY_DIRECTION);
    int tries = (samples + 3) / 4, n = 0;
    BsdfSample s;

    for (int i = 0; i < tries && n < TWOSTAGE_PEAKS_MOST; i++) {
        draw = draw_number(&first, (uint32_t)i);
        if (turn_sample(u, draw.choice, draw.point, &s) && s.pdf_w > 0.0f)
            peak[n++] = s.wi;
    }
    return n;
}

/* The source splits as often as there are samples. Half as often costs what it saves where nothing
 * is in shadow, and less than that where shadows make most of the noise; see `make bench
 * T=twostage`. Few samples want all. */
int twostage_splits(const TwoStage *it, int samples)
{
    enum { ALL = 16 };

    if (it->splits)
        return it->splits;
    return samples <= ALL ? samples : samples / 2 > ALL ? samples / 2 : ALL;
}

int twostage_peaks(const TwoStage *it, const Turn *u, int samples, Tracer *t,
                   V3 peak[TWOSTAGE_PEAKS_MOST])
{
    return it->sampled ? sampled_peaks(u, samples, t, peak) : known_peaks(u, peak);
}

bool twostage_partition(const TwoStage *it, const Turn *u, int samples, Tracer *t, Partition *p)
{
    V3 peak[TWOSTAGE_PEAKS_MOST];
    PartitionOrder o = { factor, u, u->up, peak, 0, peak, 0, 0 };
    int n;

    if (!it->light || it->colour)
        return false;
    n = twostage_peaks(it, u, samples, t, peak);
    o.splits = twostage_splits(it, samples);
    o.peaks = it->sampled ? 0 : n;
    o.tries = it->sampled ? n : 0;
    return partition_make(p, &it->map, &o);
}

bool twostage_candidate(const TwoStage *it, const PartitionSample *s, const Turn *u, float n,
                        Candidate *c)
{
    return skymap_candidate(&it->map, s, u, n, c);
}

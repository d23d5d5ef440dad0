/* lighting.c -- candidates for direct light. See lighting.h. */
#include "integrators/lighting.h"

#include "base/mem.h"
#include "integrators/event.h"
#include "sampling/warp.h"

/* No shape shines: what comes along a direction is known but for what stands in the way. */
static bool only_beyond(const Scene *s)
{
    size_t others = s->nlights;

    for (size_t i = 0; i < s->nlights; i++)
        others -= s->lights[i]->kind->delta != DELTA_NONE;
    return others == s->ninfinite;
}

bool lighting_init(Lighting *it, const Scene *s, const Opts *o, bool tentative,
                   bool directions)
{
    return lighting_init_as(it, s, opt_string(o, "lightsampler"), opt_is(o, "heuristic", "power"),
                            opt_is(o, "sky", "bright"), tentative, directions);
}

bool lighting_init_as(Lighting *it, const Scene *s, const char *lightsampler, bool power,
                      bool bright, bool tentative, bool directions)
{
    memset(it, 0, sizeof *it);
    it->scene = s;
    it->power = power;
    it->bright = bright;
    it->lights = lightsampler_open(lightsampler, s);
    if (!it->lights)
        return false;
    it->tentative = tentative || only_beyond(s);
    it->directions = directions;
    it->shining.none = true;
    if ((tentative || directions) && !subset_init(&it->shining, s, shape_shines)) {
        lightsampler_close(it->lights);
        it->lights = NULL;
        return false;
    }
    return true;
}

void lighting_shares(Lighting *it, int by_light, int by_scattering)
{
    it->beside = it->bright && by_light > 0 && by_scattering >= by_light;
}

void lighting_clear(Lighting *it)
{
    if (!it->lights)
        return;
    it->lights->kind->close(it->lights);
    it->lights = NULL;
    subset_clear(&it->shining);
}

bool lighting_warn_of_deltas(const Scene *s, const char *strategy)
{
    for (size_t i = 0; i < s->nlights; i++)
        if (s->lights[i]->kind->delta)
            return warn_at(s->lights[i]->at, "strategy=%s cannot find %s lights", strategy,
                           s->lights[i]->kind->info.name);
    return true;
}

/* ---- turns ---- */

Turn turn_on(const Vertex *v, V3 d, uint32_t medium, int at)
{
    return (Turn){ v, v->s.p, vertex_up(v), d, 0.0f, v->s.time, medium, at, { 1, 1, 1 } };
}

Turn turn_within(const Scene *s, V3 p, V3 d, float time, uint32_t medium, int at)
{
    return (Turn){ NULL, p, v_all(0.0f), d, s->media[medium].g, time, medium, at, { 1, 1, 1 } };
}

bool turn_f_cos(const Turn *u, V3 wi, Rgb *f_cos, float *pdf_w)
{
    V3 local;

    if (!u->v) {                /* the phase function is both */
        float p = phase_pdf_w(u->g, u->d, wi);
        *f_cos = rgb_all(p);
        if (pdf_w)
            *pdf_w = p;
        return p > 0.0f;
    }
    if (!vertex_local(u->v, wi, &local))
        return false;
    *f_cos = vertex_f_cos(u->v, local);
    if (rgb_black(*f_cos))
        return false;
    if (pdf_w)
        *pdf_w = vertex_pdf_w(u->v, local);
    return true;
}

bool turn_sample(const Turn *u, float lobe, V2 point, BsdfSample *s)
{
    if (u->v)
        return vertex_sample_by(u->v, lobe, point, s);
    s->wi = phase_sample(u->g, u->d, point);
    s->pdf_w = phase_pdf_w(u->g, u->d, s->wi);
    s->weight = rgb_all(1.0f);
    s->flags = BSDF_SMOOTH;
    s->eta = 1.0f;
    return s->pdf_w > 0.0f;
}

Ray turn_ray(const Turn *u, V3 wi)
{
    if (u->v)
        return vertex_ray(u->v, wi);
    return (Ray){ .o = u->p, .d = wi, .tmax = INFINITY, .time = u->time };
}

uint32_t turn_medium(const Turn *u, V3 wi)
{
    return u->v ? medium_beyond(&u->v->s, wi, u->medium) : u->medium;
}

static Ray ray_to_light(const Turn *u, const LightSample *ls)
{
    Surface s = { .p = u->p, .time = u->time };
    return shadow_ray(u->v ? &u->v->s : &s, ls);
}

/* ---- numbers ---- */

Draw draw_first(Tracer *t, const Turn *u, DecisionKind choice, DecisionKind point)
{
    Draw d;
    d.choice = sample_1d(&t->sampler, DECISION(choice, u->at));
    d.point = sample_2d(&t->sampler, DECISION(point, u->at));
    return d;
}

/* In 24 bits, as canonical numbers are: exact. */
static float go_round(float u, uint32_t step, uint32_t i)
{
    return (float)(((uint32_t)(u * 0x1p24f) + step * i) & 0xffffffu) * 0x1p-24f;
}

Draw draw_number(const Draw *first, uint32_t i)
{
    /* 2^24 over 1.2207440846, its square and its cube, to odd numbers: none comes again soon */
    Draw d = { go_round(first->choice, 13743435u, i),
               { go_round(first->point.x, 11258243u, i), go_round(first->point.y, 9222443u, i) } };
    return d;
}

/* ---- weights ---- */

/* Density with which a sample by light takes the direction to this point of l. */
static float pdf_by_light(const Lighting *it, const Turn *u, const Light *l, V3 wi,
                          const Surface *hit)
{
    float pmf = it->all ? 1.0f : it->lights->kind->pmf(it->lights, u->p, u->up, l);
    return pmf > 0.0f ? pmf * light_pdf_w(l, it->beside, u->p, wi, hit) : 0.0f;
}

/* The same with all lights along the ray. [Cline07 (4.8)], errata 4.2: a closed light has a term
 * for each time that it is met. */
static float all_pdf_w(const Lighting *it, const Turn *u, V3 wi)
{
    Ray r = turn_ray(u, wi);
    float sum = 0.0f;
    Surface s;

    while (subset_next(&it->shining, &r, &s))
        sum += pdf_by_light(it, u, scene_light_of(it->scene, &s), wi, &s);
    for (size_t i = 0; i < it->scene->ninfinite; i++)
        sum += pdf_by_light(it, u, it->scene->infinite[i], wi, NULL);
    return sum;
}

/* ---- what comes along a direction ---- */

static Rgb weighed(const Lighting *it, const Turn *u, const Light *l, V3 wi, const Surface *hit,
                   float own, float n_light)
{
    Rgb L = l->kind->radiance(l, wi, hit);

    if (n_light == 0.0f || it->directions || rgb_black(L))
        return L;
    return rgb_scale(L, mis_weight(it->power, own, n_light * pdf_by_light(it, u, l, wi, hit)));
}

/* By the surface met, or by lights beyond the scene if there is none. */
static Rgb coming(const Lighting *it, const Turn *u, V3 wi, const Surface *hit, float own,
                  float n_light)
{
    Rgb sum = rgb_all(0.0f);

    if (hit) {
        const Light *l = scene_light_of(it->scene, hit);
        return l ? weighed(it, u, l, wi, hit, own, n_light) : sum;
    }
    for (size_t i = 0; i < it->scene->ninfinite; i++)
        sum = rgb_add(sum, weighed(it, u, it->scene->infinite[i], wi, NULL, own, n_light));
    return sum;
}

/* Where samples are directions, the weight is that of the direction, whatever it meets. */
static float direction_weight(const Lighting *it, const Turn *u, V3 wi, float own, float n_light)
{
    if (!it->directions || n_light == 0.0f)
        return 1.0f;
    return mis_weight(it->power, own, n_light * all_pdf_w(it, u, wi));
}

/* beyond: lights of shapes bring nothing. */
static bool cast_along(const Lighting *it, const Turn *u, V3 wi, Rgb f_cos, float own,
                       float n_light, bool beyond, Tracer *t, Candidate *c)
{
    Rgb left = rgb_all(1.0f), L;
    uint32_t medium = turn_medium(u, wi);
    Ray r;
    Surface s;
    bool met;

    c->ray = r = turn_ray(u, wi);
    met = ray_meets(t, &r, &medium, &left, &s);
    if (met && beyond)
        return false;
    L = coming(it, u, wi, met ? &s : NULL, own, n_light);
    if (rgb_black(L))
        return false;
    c->c = rgb_scale(rgb_mul(rgb_mul(f_cos, L), left),
                     direction_weight(it, u, wi, own, n_light) / own);
    c->known = true;
    c->how = STRATEGY_IMPLICIT;
    return true;
}

bool candidate_along(const Lighting *it, const Turn *u, V3 wi, Rgb f_cos, float own, float n_light,
                     Tracer *t, Candidate *c)
{
    return cast_along(it, u, wi, f_cos, own, n_light, false, t, c);
}

bool candidate_beyond(const Lighting *it, const Turn *u, V3 wi, Rgb f_cos, float own,
                      float n_light, Tracer *t, Candidate *c)
{
    return cast_along(it, u, wi, f_cos, own, n_light, true, t, c);
}

/* ---- tentatively ---- */

/* The first lamp in that direction, if there were nothing else. */
static bool first_lamp(const Lighting *it, const Turn *u, V3 wi, Rgb f_cos, float own,
                       float n_light, Candidate *c)
{
    Ray r = turn_ray(u, wi);
    LightSample ls;
    Surface s;
    bool met = subset_next(&it->shining, &r, &s);
    Rgb L = coming(it, u, wi, met ? &s : NULL, own, n_light);

    if (rgb_black(L))
        return false;
    memset(&ls, 0, sizeof ls);
    ls.wi = wi;
    ls.dist = INFINITY;
    if (met) {
        ls.p = s.p;
        ls.err = s.err;
        ls.n = s.ng;
        ls.dist = v_len(v_sub(s.p, u->p));
    }
    c->c = rgb_scale(rgb_mul(f_cos, L), direction_weight(it, u, wi, own, n_light) / own);
    c->ray = met ? ray_to_light(u, &ls) : turn_ray(u, wi);
    c->medium = turn_medium(u, wi);
    c->known = false;
    c->how = STRATEGY_IMPLICIT;
    return true;
}

/* A candidate along wi as the user of `it` wants it: cast, or tentative. Where surfaces let some of
 * the rays pass, only a cast ray can say what it meets. */
static bool along(const Lighting *it, const Turn *u, V3 wi, Rgb f_cos, float own, float n_light,
                  Tracer *t, Candidate *c)
{
    if (!it->tentative || it->scene->see_through || it->scene->nmedia ||
        (!it->shining.accel && !it->shining.none))
        return candidate_along(it, u, wi, f_cos, own, n_light, t, c);
    return first_lamp(it, u, wi, f_cos, own, n_light, c);
}

/* ---- by light ---- */

/* Where samples are directions: whatever shines there, by the densities of all lights there. */
static bool along_light(const Lighting *it, const Turn *u, V3 wi, float n_light, float n_scatter,
                        Tracer *t, Candidate *c)
{
    float own = n_light * all_pdf_w(it, u, wi), pdf_w = 0.0f;
    Rgb f_cos;

    if (!(own > 0.0f) || !turn_f_cos(u, wi, &f_cos, n_scatter > 0.0f ? &pdf_w : NULL) ||
        !along(it, u, wi, f_cos, own, 0.0f, t, c))
        return false;
    c->c = rgb_scale(c->c, mis_weight(it->power, own, n_scatter * pdf_w));
    c->how = STRATEGY_EXPLICIT;
    return true;
}

bool candidate_of_light(const Lighting *it, const Turn *u, const Light *l, float pmf, V2 point,
                        float n_light, float n_scatter, Tracer *t, Candidate *c)
{
    float own, pdf_w = 0.0f, weight = 1.0f;
    LightSample ls;
    Rgb f_cos;

    if (!light_sample(l, it->beside, u->p, point, &ls))
        return false;
    if (it->directions && !l->kind->delta)
        return along_light(it, u, ls.wi, n_light, n_scatter, t, c);
    if (rgb_black(ls.L) ||
        !turn_f_cos(u, ls.wi, &f_cos, n_scatter > 0.0f && !l->kind->delta ? &pdf_w : NULL))
        return false;
    own = n_light * pmf * ls.pdf_w;
    if (!(own > 0.0f))
        return false;
    if (n_scatter > 0.0f && !l->kind->delta)
        weight = mis_weight(it->power, own, n_scatter * pdf_w);
    c->c = rgb_scale(rgb_mul(f_cos, ls.L), weight / own);
    c->ray = ray_to_light(u, &ls);
    c->medium = turn_medium(u, ls.wi);
    c->known = false;
    c->how = STRATEGY_EXPLICIT;
    return true;
}

bool candidate_by_light(const Lighting *it, const Turn *u, const Draw *draw, float n_light,
                        float n_scatter, Tracer *t, Candidate *c)
{
    float pmf, left;
    const Light *l = it->lights->kind->pick(it->lights, u->p, u->up, draw->choice, &pmf, &left);

    return l && candidate_of_light(it, u, l, pmf, draw->point, n_light, n_scatter, t, c);
}

bool candidate_seen(const Turn *u, const LightSample *ls, float own, Candidate *c)
{
    Rgb f_cos;

    if (!(own > 0.0f) || rgb_black(ls->L) || !turn_f_cos(u, ls->wi, &f_cos, NULL))
        return false;
    c->c = rgb_scale(rgb_mul(f_cos, ls->L), 1.0f / own);
    c->ray = ray_to_light(u, ls);
    c->medium = turn_medium(u, ls->wi);
    c->known = false;
    c->how = STRATEGY_EXPLICIT;
    return true;
}

/* ---- by scattering ---- */

bool candidate_by_scattering(const Lighting *it, const Turn *u, const Draw *draw, float n_light,
                             float n_scatter, Tracer *t, Candidate *c)
{
    BsdfSample bs;
    float own;

    if (!turn_sample(u, draw->choice, draw->point, &bs) || !(bs.pdf_w > 0.0f))
        return false;
    own = n_scatter * bs.pdf_w;
    bs.weight = rgb_scale(bs.weight, bs.pdf_w);                 /* f |cos| */
    if (!(own > 0.0f) || rgb_black(bs.weight))
        return false;
    return along(it, u, bs.wi, bs.weight, own, n_light, t, c);
}

Rgb candidate_light(Candidate *c, const Turn *u, Tracer *t)
{
    if (!c->known && !tracer_passes(t, &c->ray, c->medium, &c->c))
        return rgb_all(0.0f);
    tracer_tally(t, u->at + 2, c->how, rgb_mul(u->to_eye, c->c));
    return c->c;
}

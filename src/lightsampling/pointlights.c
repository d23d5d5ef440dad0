/* pointlights.c -- point lights of what lies beyond the scene, and of lamps. See pointlights.h.
 *
 * Light of a cell of the sphere. Looked up at LOOKS^2 places of each cell, and at directions drawn
 * by the light itself, weighed by the balance heuristic [Veach97 9.2]: with n_c looks in the cell
 * and n draws over the sphere, each finds L / (n_c / omega + n p). A sky that is smooth is all
 * looks, a sun of one pixel among millions all draws, and nothing is lost. */
#include "lightsampling/pointlights.h"

#include "base/mem.h"
#include "scene/panorama.h"

enum { LOOKS = 3, DRAWS = 2 };  /* both squared, for each cell */

static const Mapping octahedral = { MAPPING_OCTAHEDRAL, 0.0f, 0.0f };

V3 sphere_direction(uint32_t side, uint32_t cell, V2 u)
{
    float x = (float)(cell % side) + u.x, y = (float)(cell / side) + u.y, jacobian;
    return v_unit(mapping_direction(&octahedral, (V2){ x / (float)side, y / (float)side },
                                    &jacobian));
}

static uint32_t below(float x, uint32_t n)
{
    return x >= (float)n ? n - 1 : (uint32_t)f_max(x, 0.0f);
}

uint32_t sphere_cell(uint32_t side, V3 d)
{
    float jacobian;
    V2 at = mapping_place(&octahedral, d, &jacobian);
    return below(at.x * (float)side, side) + side * below(at.y * (float)side, side);
}

/* ---- from beyond ---- */

typedef struct { double L[3], moment[3]; } CellSum;

static void cell_add(CellSum *c, Rgb L, V3 d, double weight)
{
    double lum = (double)rgb_lum(L) * weight;

    c->L[0] += (double)L.r * weight;
    c->L[1] += (double)L.g * weight;
    c->L[2] += (double)L.b * weight;
    c->moment[0] += (double)d.x * lum;
    c->moment[1] += (double)d.y * lum;
    c->moment[2] += (double)d.z * lum;
}

static void look_at(const Light *l, uint32_t side, CellSum *sum)
{
    uint32_t cells = side * side, nd = side * DRAWS;
    double omega = 4 * PI / cells, n_c = LOOKS * LOOKS / omega, n = (double)nd * nd;
    LightSample s;

    for (uint32_t c = 0; c < cells; c++)
        for (int k = 0; k < LOOKS * LOOKS; k++) {
            V2 u = { ((float)(k % LOOKS) + 0.5f) / LOOKS, ((float)(k / LOOKS) + 0.5f) / LOOKS };
            V3 d = sphere_direction(side, c, u);
            double p = (double)l->kind->pdf_w(l, v_all(0.0f), d, NULL);
            cell_add(&sum[c], l->kind->radiance(l, d, NULL), d, 1 / (n_c + n * p) / omega);
        }
    for (uint32_t k = 0; k < nd * nd; k++) {
        V2 u = { ((float)(k % nd) + 0.5f) / (float)nd, ((float)(k / nd) + 0.5f) / (float)nd };
        if (l->kind->sample(l, v_all(0.0f), u, &s) && s.pdf_w > 0.0f)
            cell_add(&sum[sphere_cell(side, s.wi)], s.L, s.wi,
                     1 / (n_c + n * (double)s.pdf_w) / omega);
    }
}

static V3 middle_of(const CellSum *c, uint32_t side, uint32_t cell)
{
    double m = c->moment[0] * c->moment[0] + c->moment[1] * c->moment[1] +
               c->moment[2] * c->moment[2];

    if (!(m > 0.0) || m - m != 0.0)
        return sphere_direction(side, cell, (V2){ 0.5f, 0.5f });
    m = 1 / sqrt(m);
    return v_unit(v3((float)(c->moment[0] * m), (float)(c->moment[1] * m),
                     (float)(c->moment[2] * m)));
}

static bool push(PointLights *it, const PointLight *p)
{
    return MEM_PUSH(it->p, it->n, it->cap, *p);
}

static bool points_beyond(PointLights *it, size_t wanted)
{
    uint32_t side = 1;
    CellSum *sum;
    bool ok = true;

    while ((size_t)(side + 1) * (side + 1) <= wanted)
        side++;
    it->side = side;
    sum = MEM_ARRAY(CellSum, (size_t)side * side);
    if (!sum)
        return false;
    for (size_t i = 0; i < it->scene->ninfinite; i++)
        look_at(it->scene->infinite[i], side, sum);
    for (uint32_t c = 0; ok && c < side * side; c++) {
        PointLight p = { .kind = POINT_BEYOND, .cell = c };
        p.L = rgb((float)sum[c].L[0], (float)sum[c].L[1], (float)sum[c].L[2]);
        p.lum = rgb_lum(p.L);
        p.size = (float)(4 * PI / ((double)side * side));
        p.p = middle_of(&sum[c], side, c);
        ok = (!it->jitter && !(p.lum > 0.0f)) || push(it, &p);
    }
    mem_free(sum);
    return ok;
}

/* ---- on lamps ---- */

/* A place of the lamp: from the front of one with two sides. */
static bool place_on(const Light *l, V2 u, Emission *e)
{
    return l->kind->emit(l, u, (V2){ 0.25f, 0.5f }, e) && e->pdf_a > 0.0f;
}

static bool shines_both_ways(const Light *l)
{
    Emission e, back;
    V2 u = { 0.5f, 0.5f };

    return place_on(l, u, &e) && l->kind->emit(l, u, (V2){ 0.75f, 0.5f }, &back) &&
           v_dot(e.n, back.n) < 0.0f;
}

static V2 in_stratum(uint32_t n, uint32_t cell, V2 u)
{
    return (V2){ f_min(((float)(cell % n) + u.x) / (float)n, ONE_MINUS_ULP),
                 f_min(((float)(cell / n) + u.y) / (float)n, ONE_MINUS_ULP) };
}

static bool points_on(PointLights *it, const Light *l, double wanted)
{
    uint32_t n = 1;
    bool two_sided = shines_both_ways(l);

    while ((double)(n + 1) * (n + 1) <= wanted)
        n++;
    it->strata[l->index] = n;
    for (uint32_t c = 0; c < n * n; c++) {
        PointLight p = { .kind = POINT_ON_LAMP, .light = l->index, .cell = c };
        Emission e;
        if (!place_on(l, in_stratum(n, c, (V2){ 0.5f, 0.5f }), &e))
            continue;
        p.p = e.p;
        p.err = e.err;
        p.n = e.n;
        p.uv = e.uv;
        p.two_sided = two_sided;
        p.L = e.L;
        p.lum = rgb_lum(e.L);
        p.size = 1.0f / (e.pdf_a * (float)n * (float)n);
        if ((it->jitter || p.lum > 0.0f) && is_finite(p.size) && !push(it, &p))
            return false;
    }
    return true;
}

static bool is_lamp(const Light *l) { return !l->kind->delta && !l->kind->infinite; }

static double power_of(const Light *l)
{
    double power = (double)rgb_lum(l->kind->power(l));
    return is_lamp(l) && power > 0.0 && power - power == 0.0 ? power : 0.0;
}

static bool points_on_lamps(PointLights *it, size_t wanted, double power)
{
    for (size_t i = 0; i < it->scene->nlights; i++) {
        const Light *l = it->scene->lights[i];
        double own = power_of(l);
        if (own > 0.0 && !points_on(it, l, (double)wanted * own / power))
            return false;
    }
    return true;
}

/* ---- the set ---- */

/* What seems black in a cell may not be: it keeps a thousandth of its kind's mean. */
static void floor_of(PointLights *it, PointKind kind)
{
    double sum = 0.0;
    size_t n = 0;
    float least;

    for (size_t i = 0; i < it->n; i++)
        if (it->p[i].kind == kind) {
            sum += (double)it->p[i].lum;
            n++;
        }
    least = n ? (float)(1e-3 * sum / (double)n) : 0.0f;
    for (size_t i = 0; i < it->n; i++)
        if (it->p[i].kind == kind)
            it->p[i].lum = f_max(it->p[i].lum, least);
}

/* Takes away what has no light at all, or cannot be counted. */
static void drop_black(PointLights *it)
{
    size_t n = 0;

    for (size_t i = 0; i < it->n; i++)
        if (it->p[i].lum > 0.0f && is_finite(it->p[i].lum) && it->p[i].size > 0.0f)
            it->p[n++] = it->p[i];
    it->n = n;
}

bool pointlights_init(PointLights *it, const Scene *s, size_t wanted, bool jitter, Indirect which)
{
    bool own = which != INDIRECT_ONLY, beyond = own && s->ninfinite, bounce;
    double power = 0.0;
    size_t share;
    bool ok;

    memset(it, 0, sizeof *it);
    it->scene = s;
    it->jitter = jitter;
    it->strata = MEM_ARRAY(uint32_t, s->nlights);
    if (!it->strata)
        return false;
    for (size_t i = 0; own && i < s->nlights; i++)
        power += power_of(s->lights[i]);
    bounce = which != INDIRECT_NO && s->nlights;
    share = (size_t)beyond + (power > 0.0) + bounce;
    share = share ? wanted / share : 0;
    ok = (!beyond || points_beyond(it, share)) &&
         (!(power > 0.0) || points_on_lamps(it, share, power)) &&
         (!bounce || surface_points(it, share ? share : 1));
    if (!ok) {
        pointlights_clear(it);
        return false;
    }
    if (jitter) {
        floor_of(it, POINT_BEYOND);
        floor_of(it, POINT_ON_LAMP);
    }
    drop_black(it);
    return true;
}

void pointlights_clear(PointLights *it)
{
    mem_free(it->p);
    mem_free(it->strata);
    memset(it, 0, sizeof *it);
}

/* ---- seen from a point ---- */

static bool beyond_seen(const PointLights *it, const PointLight *p, V2 u, LightSample *s)
{
    const Scene *scene = it->scene;

    sample_beyond(s);
    s->wi = p->p;
    s->L = p->L;
    if (it->jitter) {
        s->wi = sphere_direction(it->side, p->cell, u);
        s->L = rgb_all(0.0f);
        for (size_t i = 0; i < scene->ninfinite; i++)
            s->L = rgb_add(s->L, scene->infinite[i]->kind->radiance(scene->infinite[i], s->wi,
                                                                    NULL));
    }
    s->L = rgb_scale(s->L, p->size);
    return !rgb_black(s->L);
}

/* The way to s->p; the cosine there, and the squared distance. False: none, or behind it. */
static bool way_to(V3 from, bool two_sided, LightSample *s, float *cosine, float *d2)
{
    V3 to = v_sub(s->p, from);

    *d2 = v_len2(to);
    if (!(*d2 > 0.0f))
        return false;
    s->dist = sqrtf(*d2);
    s->wi = v_scale(to, 1.0f / s->dist);
    *cosine = -v_dot(s->wi, s->n);
    if (two_sided)
        *cosine = fabsf(*cosine);
    return *cosine > 0.0f && is_finite(s->dist);
}

static bool lamp_seen(const PointLights *it, const PointLight *p, V3 from, V2 u, LightSample *s)
{
    const Light *l = it->scene->lights[p->light];
    float cosine, d2, disc = p->size * INV_PI;
    V2 uv = p->uv;
    Surface at;

    if (it->jitter) {
        Emission e;
        if (!place_on(l, in_stratum(it->strata[p->light], p->cell, u), &e) || rgb_black(e.L))
            return false;
        s->p = e.p;
        s->err = e.err;
        s->n = e.n;
        uv = e.uv;
        disc = 0.0f;
    }
    if (!way_to(from, p->two_sided, s, &cosine, &d2))
        return false;
    at = surface_at(s->p, s->err, s->n, uv);
    s->L = rgb_scale(l->kind->radiance(l, s->wi, &at), p->size * cosine / f_max(d2, disc));
    return !rgb_black(s->L);
}

bool pointlight_seen(const PointLights *it, size_t i, V3 from, V2 u, LightSample *s)
{
    const PointLight *p = &it->p[i];
    float cosine, d2;

    s->pdf_w = 1.0f;
    if (p->kind == POINT_BEYOND)
        return beyond_seen(it, p, u, s);
    s->p = p->p;
    s->err = p->err;
    s->n = p->n;
    if (p->kind == POINT_ON_LAMP)
        return lamp_seen(it, p, from, u, s);
    if (!way_to(from, false, s, &cosine, &d2))
        return false;
    s->L = rgb_scale(p->L, p->size * cosine / f_max(d2, p->size * INV_PI));
    return true;
}

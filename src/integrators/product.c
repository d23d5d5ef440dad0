/* product.c -- products of a light's map and a turn's factor. See product.h. */
#include "integrators/product.h"

/* ---- maps ---- */

bool lightmap_init(LightMap *it, const Light *l, const LightRectangle *lamp, bool colour)
{
    memset(it, 0, sizeof *it);
    it->light = l;
    for (int k = 0; k < (colour ? 3 : 1); k++) {
        SkyMeasure by = colour ? (SkyMeasure)(BY_RED + k) : BY_LUMINANCE;
        if (lamp ? !skymap_init_lamp(&it->map[k], l, lamp, by) : !skymap_init(&it->map[k], l, by)) {
            lightmap_clear(it);
            return false;
        }
        it->channels++;
    }
    return true;
}

void lightmap_clear(LightMap *it)
{
    for (int k = 0; k < it->channels; k++)
        skymap_clear(&it->map[k]);
    it->channels = 0;
}

/* ---- factors ---- */

typedef struct { const Turn *u; const SkyMap *m; } Factor;

static float measured(const SkyMap *m, Rgb c)
{
    switch (m->measure) {
    case BY_RED:   return c.r;
    case BY_GREEN: return c.g;
    case BY_BLUE:  return c.b;
    case BY_LUMINANCE: break;
    }
    return rgb_lum(c);
}

static float towards_sky(const void *of, V3 wi)
{
    const Factor *f = of;
    Rgb f_cos;

    return turn_f_cos(f->u, wi, &f_cos, NULL) ? measured(f->m, f_cos) : 0.0f;
}

/* Of the distance, half the diagonal of a cell is the least that counts: a lamp that touches the
 * surface would have f infinite at a corner. */
static float towards_lamp(const void *of, V3 p)
{
    const Factor *f = of;
    const LightRectangle *r = &f->m->lamp;
    V3 d = v_sub(p, f->u->p);
    float d2 = v_len2(d), c, least;
    Rgb f_cos;

    if (!(d2 > 0.0f))
        return 0.0f;
    d = v_scale(d, 1.0f / sqrtf(d2));
    c = -v_dot(r->n, d);
    c = r->both ? fabsf(c) : c;
    if (!(c > 0.0f) || !turn_f_cos(f->u, d, &f_cos, NULL))
        return 0.0f;
    if (r->exponent > 0.0f)
        c *= m_pow(f_min(c, 1.0f), r->exponent);
    least = 0.25f * (v_len2(r->side[0]) / f_sqr((float)f->m->w) +
                     v_len2(r->side[1]) / f_sqr((float)f->m->h));
    return measured(f->m, f_cos) * c / f_max(d2, least);
}

/* ---- peaks on a lamp ---- */

enum { PEAKS_MOST = 192 };

static bool on_lamp(const SkyMap *m, V3 p)
{
    V3 d = v_sub(p, m->lamp.corner);
    float x = v_dot(d, m->back[0]), y = v_dot(d, m->back[1]);

    return x >= 0.0f && x < 1.0f && y >= 0.0f && y < 1.0f;
}

/* Where the direction meets the lamp. */
static bool meets_lamp(const SkyMap *m, V3 from, V3 d, V3 *p)
{
    float away = v_dot(m->lamp.n, v_sub(m->lamp.corner, from)), along = v_dot(m->lamp.n, d);

    if (!(away * along > 0.0f))
        return false;
    *p = v_mad(d, away / along, from);
    return on_lamp(m, *p);
}

/* The places that peaks show, and that beneath the turn, or above it: there the lamp's own cosine
 * over the squared distance is largest. */
static int peaks_on_lamp(const SkyMap *m, const Turn *u, const V3 *peak, int n, bool tried,
                         V3 point[PEAKS_MOST])
{
    float away = v_dot(m->lamp.n, v_sub(u->p, m->lamp.corner)), jacobian;
    int found = 0;

    for (int i = 0; i < n && found < PEAKS_MOST - 2; i++)
        found += meets_lamp(m, u->p, peak[i], &point[found]);
    if (tried)
        return found;
    if (v_len2(u->up) > 0.0f)
        found += meets_lamp(m, u->p, u->up, &point[found]);
    point[found] = v_mad(m->lamp.n, -away, u->p);
    point[found] = skymap_direction(m, skymap_place(m, point[found], &jacobian), &jacobian);
    return found + 1;
}

/* ---- products ---- */

static bool make_part(Product *p, int k, const Turn *u, const V3 *peak, int n, bool tried,
                      int splits)
{
    const SkyMap *m = &p->of->map[k];
    Factor factor = { u, m };
    PartitionOrder o = { m->flat ? towards_lamp : towards_sky, &factor, { 0, 0, 0 }, peak, n, peak,
                         n, splits };
    V3 point[PEAKS_MOST];

    if (m->flat) {
        n = peaks_on_lamp(m, u, peak, n, tried, point);
        o.peak = o.tried = point;
    } else
        o.up = u->up;
    o.peaks = tried ? 0 : n;
    o.tries = tried ? n : 0;
    return partition_make(&p->part[k], m, &o);
}

bool product_make(Product *p, const LightMap *of, const Turn *u, const V3 *peak, int n,
                  bool tried, int splits)
{
    static const Rgb one[3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
    double part[3] = { 0, 0, 0 }, sum = 0.0;

    p->of = of;
    for (int k = 0; k < of->channels; k++) {
        if (make_part(p, k, u, peak, n, tried, splits))
            part[k] = p->part[k].node[0].weight * of->map[k].light_in_all *
                      (double)rgb_lum(one[k]);
        sum += part[k];
    }
    for (int k = 0; k < 3; k++)
        p->share[k] = sum > 0.0 ? (float)(part[k] / sum) : 0.0f;
    return sum > 0.0;
}

float product_pdf(const Product *p, V2 place)
{
    float sum = 0.0f, jacobian;

    skymap_direction(&p->of->map[0], place, &jacobian);
    for (int k = 0; k < p->of->channels; k++)
        if (p->share[k] > 0.0f)
            sum += p->share[k] * partition_pdf_at(&p->part[k], place, jacobian);
    return sum;
}

void product_draw(const Product *p, V2 u, PartitionSample *s)
{
    int k = 0;

    if (p->of->channels == 1) {
        partition_warp(&p->part[0], u, s);
        return;
    }
    while (k < 2 && u.x >= p->share[k])
        u.x -= p->share[k++];
    while (!(p->share[k] > 0.0f))               /* by rounding: the last has none */
        k--;
    u.x = f_min(u.x / p->share[k], ONE_MINUS_ULP);
    partition_warp(&p->part[k], u, s);
    s->pdf_w = product_pdf(p, s->place);
}

bool skymap_candidate(const SkyMap *m, const PartitionSample *s, const Turn *u, float n,
                      Candidate *c)
{
    LightSample ls = { .wi = s->wi, .dist = INFINITY };

    if (!(s->pdf_w > 0.0f))
        return false;
    ls.L = skymap_radiance(m, s->place, s->wi);
    return candidate_seen(u, &ls, n * s->pdf_w, c);
}

bool product_candidate(const Product *p, const PartitionSample *s, const Turn *u, float n,
                       Candidate *c)
{
    const SkyMap *m = &p->of->map[0];
    const Light *l = p->of->light;
    LightSample ls;

    if (!m->flat)
        return skymap_candidate(m, s, u, n, c);
    return s->pdf_w > 0.0f && l->kind->places->seen(l, s->place, u->p, &ls) &&
           candidate_seen(u, &ls, n * s->pdf_w * ls.pdf_w, c);
}

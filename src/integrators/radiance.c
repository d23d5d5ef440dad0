/* radiance.c -- the code of `radiance.h` */
#include "integrators/radiance.h"

#include "base/mem.h"

/* ---- making a record ---- */

void dome_start(Dome *d, const Harmonics *basis, int rays)
{
    memset(d, 0, sizeof *d);
    d->basis = basis;
    hemisphere_cells(rays, &d->rings, &d->sectors);
}

/* Ring 0 is about the normal. */
static float height(const Dome *d, float j) { return f_max(0.0f, 1.0f - j / (float)d->rings); }

static V3 direction(float z, float turn)
{
    float s, c, sine = sqrtf(f_max(0.0f, (1.0f - z) * (1.0f + z)));

    m_sincos_turn(turn, &s, &c);
    return v3(sine * c, sine * s, z);
}

V3 dome_direction(const Dome *d, int j, int k, V2 u)
{
    return direction(height(d, (float)j + u.x), ((float)k + u.y) / (float)d->sectors);
}

/* The border between cells a and b, around w, moves by `factor` over the distance of the nearer
 * where one moves along (x, y). */
static void moves(Dome *d, const HemisphereCell *a, const HemisphereCell *b, float factor, V3 w,
                  float x, float y)
{
    float Y[HARMONICS_MOST];
    Rgb step = rgb_scale(rgb_sub(b->L, a->L), factor * f_max(a->inv_distance, b->inv_distance));

    if (rgb_black(step))
        return;
    harmonics_at(d->basis, w, Y);
    for (int i = 0; i < d->basis->n; i++) {
        d->of[i].along[0] = rgb_add(d->of[i].along[0], rgb_scale(step, x * Y[i]));
        d->of[i].along[1] = rgb_add(d->of[i].along[1], rgb_scale(step, y * Y[i]));
    }
}

/* The border between sector k - 1, whose cell is a, and k. */
static void moves_across(Dome *d, int j, int k, const HemisphereCell *a, const HemisphereCell *b)
{
    float low = height(d, (float)j + 1.0f), high = height(d, (float)j), s, c;
    float wide = m_acos(low) - m_acos(high);

    m_sincos_turn((float)k / (float)d->sectors, &s, &c);
    moves(d, a, b, wide, direction(0.5f * (low + high), (float)k / (float)d->sectors), -s, c);
}

static void moves_up(Dome *d, int j, int k, const HemisphereCell *a, const HemisphereCell *b)
{
    float turn = ((float)k + 0.5f) / (float)d->sectors, s, c;
    V3 w = direction(height(d, (float)j), turn);
    float sine = sqrtf(f_max(0.0f, (1.0f - w.z) * (1.0f + w.z)));

    m_sincos_turn(turn, &s, &c);
    moves(d, a, b, 2.0f * PI_F / (float)d->sectors * sine * w.z, w, c, s);
}

void dome_take(Dome *d, int j, int k, V3 w, Rgb L, float inv_distance)
{
    HemisphereCell now = { L, inv_distance };
    float Y[HARMONICS_MOST];

    harmonics_at(d->basis, w, Y);
    for (int i = 0; i < d->basis->n; i++)
        d->of[i].value = rgb_add(d->of[i].value, rgb_scale(L, Y[i]));
    d->inv += inv_distance;
    if (j > 0)                  /* last[j - 1] is of this sector */
        moves_up(d, j, k, &d->last[j - 1], &now);
    if (k > 0)
        moves_across(d, j, k, &d->last[j], &now);
    else
        d->first[j] = now;
    d->last[j] = now;
    if (k == d->sectors - 1)
        moves_across(d, j, 0, &now, &d->first[j]);
}

Reach dome_end(Dome *d, V3 p, V3 n, float least, float most, Radiance *of)
{
    int cells = d->rings * d->sectors;
    float value = 0.0f, slope = 0.0f, kept;
    Reach r = { p, n, most, least };

    for (int i = 0; i < d->basis->n; i++) {
        of[i] = d->of[i];
        of[i].value = rgb_scale(of[i].value, 2.0f * PI_F / (float)cells);
        value += f_sqr(rgb_lum(of[i].value));
        slope += f_sqr(rgb_lum(of[i].along[0])) + f_sqr(rgb_lum(of[i].along[1]));
    }
    kept = reach_limit(&r, (float)(d->inv / cells), sqrtf(value), sqrtf(slope), least, most);
    for (int i = 0; i < d->basis->n; i++)
        for (int k = 0; k < 2; k++)
            of[i].along[k] = rgb_scale(of[i].along[k], kept);
    return r;
}

/* ---- many ---- */

bool radiance_init(RadianceStore *s, Box around, float a, int bands)
{
    memset(s, 0, sizeof *s);
    harmonics_init(&s->basis, bands);
    return reaches_init(&s->reaches, around, a);
}

void radiance_clear(RadianceStore *s)
{
    reaches_clear(&s->reaches);
    mem_free(s->of);
    memset(s, 0, sizeof *s);
}

bool radiance_insert(RadianceStore *s, const Reach *r, const Radiance *of)
{
    size_t n = (size_t)s->basis.n, bytes = n * sizeof *of;

    if (!mem_grow(&s->of, &s->cap, s->reaches.n + 1, bytes))
        return false;
    memcpy(s->of + s->reaches.n * n, of, bytes);
    return reaches_insert(&s->reaches, r);
}

bool radiance_known(const RadianceStore *s, V3 p, V3 n, float a)
{
    BallWalk walk = balltree_ask(&s->reaches.tree, p);
    uint32_t id;

    while (balltree_next(&walk, &id))
        if (reach_error(&s->reaches.at[id], p, n) < a)
            return true;
    return false;
}

/* What one record says at p of the light along wi. */
static Rgb told(const RadianceStore *s, uint32_t id, V3 p, V3 wi, bool gradients)
{
    const Radiance *of = s->of + (size_t)id * (size_t)s->basis.n;
    const Reach *at = &s->reaches.at[id];
    Frame f = frame_about(at->n);
    V3 moved = frame_in(&f, v_sub(p, at->p));
    float Y[HARMONICS_MOST];
    Rgb L = rgb_all(0.0f);

    harmonics_at(&s->basis, frame_in(&f, wi), Y);
    for (int i = 0; i < s->basis.n; i++) {
        Rgb c = of[i].value;
        if (gradients)
            c = rgb_add(c, rgb_add(rgb_scale(of[i].along[0], moved.x),
                                   rgb_scale(of[i].along[1], moved.y)));
        L = rgb_add(L, rgb_scale(c, Y[i]));
    }
    return L;
}

bool radiance_at(const RadianceStore *s, V3 p, V3 n, V3 wi, float a, bool gradients, Rgb *L)
{
    BallWalk walk = balltree_ask(&s->reaches.tree, p);
    double weight = 0.0, sum[3] = { 0.0, 0.0, 0.0 };
    uint32_t id;

    while (balltree_next(&walk, &id)) {
        double w = reach_weight(&s->reaches.at[id], p, n, a);
        Rgb c;
        if (!(w > 0.0))
            continue;
        c = told(s, id, p, wi, gradients);
        weight += w;
        sum[0] += w * (double)c.r;
        sum[1] += w * (double)c.g;
        sum[2] += w * (double)c.b;
    }
    if (!(weight > 0.0))
        return false;
    *L = rgb((float)(d_max(sum[0], 0.0) / weight), (float)(d_max(sum[1], 0.0) / weight),
             (float)(d_max(sum[2], 0.0) / weight));
    return true;
}

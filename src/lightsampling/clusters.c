/* clusters.c -- see clusters.h. */
#include "lightsampling/clusters.h"

#include "base/random.h"
#include "lightsampling/halves.h"

/* What roundings may take from a bound: cosines are off by some 2^-22. */
#define SLACK 1e-5f

/* ---- building ---- */

typedef struct {
    Cluster *node;
    uint32_t *order;
    const OrientedLight *l;
    float across;
    uint64_t key;
    uint32_t nnodes;
} Builder;

/* Opposite normals count as `across`. */
static float key_of(const void *of, uint32_t light, int k)
{
    const Builder *b = (const Builder *)of;
    const OrientedLight *l = &b->l[light];
    return k < 3 ? v_axis(l->p, k) : 0.5f * b->across * v_axis(l->n, k - 3);
}

/* Box and cone over all lights of the run. Two sides are a cone of all directions. */
static void surround(const Builder *b, Cluster *c, uint32_t first, uint32_t end)
{
    V3 sum = v_all(0.0f);

    c->box = box_empty();
    c->cosine = 1.0f;
    for (uint32_t i = first; i < end; i++) {
        const OrientedLight *l = &b->l[b->order[i]];
        c->box = box_point(c->box, l->p);
        sum = v_add(sum, l->n);
        if (l->two_sided)
            c->cosine = -1.0f;
    }
    c->axis = v_len2(sum) > 0.0f ? v_unit(sum) : b->l[b->order[first]].n;
    for (uint32_t i = first; i < end; i++)
        c->cosine = f_min(c->cosine, v_dot(c->axis, b->l[b->order[i]].n));
    c->cosine = f_max(-1.0f, c->cosine - SLACK);
    c->sine = sqrtf(f_max(0.0f, 1.0f - c->cosine * c->cosine));
}

static void build(Builder *b, uint32_t first, uint32_t end)
{
    uint32_t at = b->nnodes++, middle;
    Cluster *c = &b->node[at], *other;

    surround(b, c, first, end);
    c->second = 0;
    c->light = b->order[first];
    c->power = b->l[c->light].power;
    if (end - first == 1)
        return;
    middle = halves_divide(b->order, first, end, key_of, b);
    build(b, first, middle);
    c->second = b->nnodes - at;
    build(b, middle, end);
    other = c + c->second;
    c->power = c[1].power + other->power;
    c->light = unit_of((uint32_t)(draw64(b->key, at) >> 32)) * c->power < c[1].power
                   ? c[1].light : other->light;
}

void clusters_build(Cluster *node, uint32_t *order, const OrientedLight *l, uint32_t n,
                    float across, uint64_t key)
{
    Builder b = { node, order, l, across, key, 0 };

    for (uint32_t i = 0; i < n; i++)
        order[i] = i;
    build(&b, 0, n);
}

/* ---- bounds ---- */

/* Most of the cosine at the lights. `to`: from the middle of the box to the point. */
static float cosine_at_lights(const Cluster *c, V3 to, float radius)
{
    float d = v_len(to), turn, wide, wide_sine, sine, cb;

    if (!(d > radius))
        return 1.0f;
    turn = v_dot(c->axis, to) / d;
    sine = radius / d;
    cb = sqrtf(f_max(0.0f, 1.0f - sine * sine));
    wide = c->cosine * cb - c->sine * sine;             /* of both angles together */
    wide_sine = c->sine * cb + c->cosine * sine;
    if (wide_sine <= 0.0f || turn >= wide)              /* half a turn or more; within the cone */
        return 1.0f;
    return f_max(0.0f, turn * wide + sqrtf(f_max(0.0f, 1.0f - turn * turn)) * wide_sine);
}

float cluster_bound(const Cluster *c, const LitMatt *at)
{
    V3 lo = v_sub(c->box.lo, at->p), hi = v_sub(c->box.hi, at->p);
    V3 half = v_scale(v_sub(hi, lo), 0.5f), middle = v_scale(v_add(hi, lo), 0.5f);
    V3 near = v_max(v_all(0.0f), v_max(lo, v_neg(hi)));
    float d2 = v_len2(near), high, low = v_dot(v_abs(at->n), half), cosine = 1.0f;

    high = v_dot(at->n, middle) + low + SLACK * (v_len(middle) + v_len(half));
    if (high <= 0.0f)
        return 0.0f;                                    /* all below the horizon */
    if (!(d2 > 0.0f))
        return at->most;
    if (high * high < d2)
        cosine = high / sqrtf(d2);
    cosine *= f_min(1.0f, cosine_at_lights(c, v_neg(middle), v_len(half)) + SLACK);
    return f_min(at->most, cosine * (1.0f + 4.0f * SLACK) / d2);
}

/* ---- cutting ---- */

/* A heap: none is above its parent. */
static void sink(CutCluster *h, size_t n, size_t i)
{
    CutCluster x = h[i];

    for (size_t k; (k = 2 * i + 1) < n; i = k) {
        if (k + 1 < n && h[k + 1].error > h[k].error)
            k++;
        if (h[k].error <= x.error)
            break;
        h[i] = h[k];
    }
    h[i] = x;
}

static void rise(CutCluster *h, size_t i)
{
    CutCluster x = h[i];

    for (; i && h[(i - 1) / 2].error < x.error; i = (i - 1) / 2)
        h[i] = h[(i - 1) / 2];
    h[i] = x;
}

static float light_of(const CutCluster *c) { return rgb_lum(c->unit) * c->node->power; }

/* unit: NULL if its light has to be asked. */
static CutCluster taken(const CutAsk *q, const Cluster *node, uint32_t root, const Rgb *unit)
{
    CutCluster c = { node, { 0, 0, 0 }, 0.0f, root };
    float bound = q->f * node->power * cluster_bound(node, &q->at);

    if (node->second)
        c.error = bound;
    if (!(bound > 0.0f))
        return c;
    if (unit)
        c.unit = *unit;
    else {
        const Cluster *leaf = node;     /* the light's power is that of its leaf */
        while (leaf->second)
            leaf += leaf[1].light == node->light ? 1 : leaf->second;
        c.unit = rgb_scale(q->ask(q->ctx, root, node->light), 1.0f / leaf->power);
    }
    return c;
}

size_t clusters_cut(const Cluster *const *root, size_t nroots, const CutAsk *q, CutCluster *cut)
{
    float sum = q->besides;
    size_t n = 0;

    for (size_t i = 0; i < nroots; i++) {
        cut[n] = taken(q, root[i], (uint32_t)i, NULL);
        sum += light_of(&cut[n]);
        rise(cut, n++);
    }
    while (n && n < q->most && cut[0].error > q->tolerance * sum) {
        CutCluster c = cut[0];
        const Cluster *first = c.node + 1, *second = c.node + c.node->second;
        bool is_first = first->light == c.node->light;
        CutCluster a = taken(q, first, c.root, is_first ? &c.unit : NULL);
        CutCluster b = taken(q, second, c.root, is_first ? NULL : &c.unit);
        sum += light_of(&a) + light_of(&b) - light_of(&c);
        cut[0] = a;
        sink(cut, n, 0);
        cut[n] = b;
        rise(cut, n++);
    }
    return n;
}

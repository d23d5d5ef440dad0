/* lighttree.c -- building the tree of point lights, and cutting it. See lighttree.h.
 *
 * Built from the top: lights are divided at the middle of their longest side, in the space of
 * places and normals, so a node's two halves are compact whatever the density. Sums of squares of
 * two nodes are joined as [Welford62] does, in double.
 *
 * Cut. [Wang09 3.2] divides the node of the largest squares |C| var. Under an even sky all squares
 * are 0, and the source would keep one node for all directions; and it cannot tell a lamp near a
 * wall from one far away. Therefore the next to be divided is that of the largest
 *     squares + extent * |C| <l>^2 * (diagonal)^2,
 * the diagonal in units of the sphere's radius (of directions: of 1): what light times a factor
 * that changes with place would deviate. It departs from the source for extent > 0 only. */
#include "lightsampling/lighttree.h"

#include "base/mem.h"
#include "lightsampling/halves.h"

#include <stdlib.h>

/* ---- one light ---- */

static double unit_of_kind(const PointLights *l, PointKind kind)
{
    double R = (double)l->scene->radius;
    return kind == POINT_BEYOND || !(R > 0.0) ? 1.0 : 1.0 / (4 * R * R);
}

/* The disc's extent along an axis is r sqrt(1 - n^2). */
static Box box_of(const PointLight *p)
{
    float r = sqrtf(p->size * INV_PI);
    V3 n = p->kind == POINT_BEYOND ? p->p : p->n, e;

    e.x = r * sqrtf(f_max(0.0f, 1.0f - n.x * n.x));
    e.y = r * sqrtf(f_max(0.0f, 1.0f - n.y * n.y));
    e.z = r * sqrtf(f_max(0.0f, 1.0f - n.z * n.z));
    return (Box){ v_sub(p->p, e), v_add(p->p, e) };
}

static LightNode node_of(const LightTree *t, uint32_t at)
{
    const PointLight *p = &t->lights->p[t->order[at]];
    LightNode node = { .box = box_of(p), .centre = p->p, .first = at, .count = 1 };

    if (!p->two_sided)
        node.normal = v_scale(p->n, p->size);
    node.size = (double)p->size;
    node.light = (double)p->lum * node.size;
    node.sum = t->running[at + 1] - t->running[at];
    node.beyond = p->kind == POINT_BEYOND;
    node.within = !node.beyond;
    return node;
}

static LightNode joined(const LightNode *a, const LightNode *b)
{
    LightNode n = *a;
    double ma = a->sum / a->count, mb = b->sum / b->count, all = (double)a->count + b->count;

    n.box = box_join(a->box, b->box);
    n.centre = v_lerp(a->centre, b->centre, (float)(b->sum / (a->sum + b->sum)));
    n.normal = v_add(a->normal, b->normal);
    n.sum = a->sum + b->sum;
    n.squares = a->squares + b->squares + (ma - mb) * (ma - mb) * a->count * (b->count / all);
    n.size = a->size + b->size;
    n.light = a->light + b->light;
    n.count = a->count + b->count;
    n.beyond = a->beyond || b->beyond;
    n.within = a->within || b->within;
    return n;
}

/* ---- building ---- */

/* Opposite normals count as a quarter of the scene's radius. */
static float key_of(const void *of, uint32_t light, int k)
{
    const PointLights *l = ((const LightTree *)of)->lights;
    const PointLight *p = &l->p[light];
    return k < 3 ? v_axis(p->p, k) : 0.125f * l->scene->radius * v_axis(p->n, k - 3);
}

/* Parts one kind from the other, once. */
static uint32_t divide_kinds(LightTree *t)
{
    uint32_t at = 0, n = (uint32_t)t->lights->n;

    for (uint32_t i = 0; i < n; i++)
        if (t->lights->p[t->order[i]].kind == POINT_BEYOND)
            order_swap(&t->order[i], &t->order[at++]);
    return at;
}

/* Nodes' runs, in preorder; what they hold comes after. */
static void build(LightTree *t, uint32_t first, uint32_t end, uint32_t middle)
{
    LightNode *n = &t->node[t->nnodes++];

    n->first = first;
    n->count = end - first;
    if (end - first < 2)
        return;
    if (middle == first || middle == end)
        middle = halves_divide(t->order, first, end, key_of, t);
    build(t, first, middle, first);
    n->second = (uint32_t)t->nnodes;
    build(t, middle, end, middle);
}

static void fill(LightTree *t)
{
    size_t n = t->lights->n;
    double all = 0.0, scale;

    for (size_t i = 0; i < n; i++) {
        const PointLight *p = &t->lights->p[i];
        all += (double)p->size * unit_of_kind(t->lights, p->kind);
    }
    scale = (double)n / all;
    for (size_t i = 0; i < n; i++) {
        const PointLight *p = &t->lights->p[t->order[i]];
        t->running[i + 1] = t->running[i] + (double)p->lum * (double)p->size *
                                                unit_of_kind(t->lights, p->kind) * scale;
    }
    for (size_t i = t->nnodes; i-- > 0;) {
        LightNode *node = &t->node[i];
        uint32_t second = node->second;
        *node = second ? joined(node + 1, &t->node[second]) : node_of(t, node->first);
        node->second = second;
    }
    for (size_t i = 0; i < t->nnodes; i++) {
        LightNode *node = &t->node[i];
        if (!node->within)
            node->centre = v_unit(node->centre);
        node->half = v_max(v_sub(node->box.hi, node->centre), v_sub(node->centre, node->box.lo));
        node->radius = v_len(node->half);
        node->lum = (float)(node->light / node->size);
        node->turned = v_len2(node->normal) > 0.0f ? v_len(node->normal) : -1.0f;
        if (node->turned > 0.0f)
            node->deep = v_dot(node->half, v_abs(node->normal)) / node->turned;
    }
}

bool lighttree_init(LightTree *t, const PointLights *points)
{
    size_t n = points->n;

    memset(t, 0, sizeof *t);
    t->lights = points;
    t->node = MEM_ARRAY(LightNode, 2 * n);
    t->order = MEM_ARRAY(uint32_t, n);
    t->running = MEM_ARRAY(double, n + 1);
    if (!t->node || !t->order || !t->running) {
        lighttree_clear(t);
        return false;
    }
    for (size_t i = 0; i < n; i++)
        t->order[i] = (uint32_t)i;
    if (n) {
        build(t, 0, (uint32_t)n, divide_kinds(t));
        fill(t);
    }
    return true;
}

void lighttree_clear(LightTree *t)
{
    mem_free(t->node);
    mem_free(t->order);
    mem_free(t->running);
    memset(t, 0, sizeof *t);
}

/* ---- cutting ---- */

typedef struct { double error; uint32_t node; } Rank;

/* Below 0: it is not to be divided. */
static double error_of(const LightTree *t, const CutRule *rule, uint32_t i)
{
    const LightNode *n = &t->node[i];
    double mean = n->sum / n->count, R = n->within ? (double)t->lights->scene->radius : 1.0;
    V3 d = v_sub(n->box.hi, n->box.lo);

    if (!n->second)
        return -1.0;
    if (n->beyond && n->within)         /* they are never one cluster */
        return 1e300;
    if (rule->sigma > 0.0f && n->squares <= (double)rule->sigma * (double)rule->sigma)
        return -1.0;
    return n->squares + (double)rule->extent * n->count * mean * mean * (double)v_len2(d) /
                            (R > 0.0 ? R * R : 1.0);
}

static bool before(Rank a, Rank b)
{
    return a.error > b.error || (a.error == b.error && a.node < b.node);
}

static void sift_up(Rank *heap, size_t i)
{
    while (i && before(heap[i], heap[(i - 1) / 2])) {
        Rank x = heap[i];
        heap[i] = heap[(i - 1) / 2];
        heap[i = (i - 1) / 2] = x;
    }
}

static void sift_down(Rank *heap, size_t n)
{
    for (size_t i = 0, k; (k = 2 * i + 1) < n; i = k) {
        Rank x = heap[i];
        if (k + 1 < n && before(heap[k + 1], heap[k]))
            k++;
        if (!before(heap[k], x))
            return;
        heap[i] = heap[k];
        heap[k] = x;
    }
}

static int by_node(const void *a, const void *b)
{
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return x < y ? -1 : x > y;
}

size_t lighttree_cut(const LightTree *t, const CutRule *rule, uint32_t *node)
{
    Rank heap[CUT_MOST];
    size_t n = 0, most = rule->most < CUT_MOST ? rule->most : CUT_MOST;

    if (!t->nnodes)
        return 0;
    heap[n++] = (Rank){ error_of(t, rule, 0), 0 };
    while (heap[0].error >= 0.0 && (n < most || heap[0].error == 1e300)) {
        uint32_t one = heap[0].node + 1, other = t->node[heap[0].node].second;
        heap[0] = (Rank){ error_of(t, rule, one), one };
        sift_down(heap, n);
        heap[n] = (Rank){ error_of(t, rule, other), other };
        sift_up(heap, n++);
    }
    for (size_t i = 0; i < n; i++)
        node[i] = heap[i].node;
    qsort(node, n, sizeof *node, by_node);
    return n;
}

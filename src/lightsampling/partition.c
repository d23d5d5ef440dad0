/* partition.c -- stage one: a partition of the sky map for a turn. See partition.h. */
#include "lightsampling/partition.h"

enum { KEY_LEAVES = 1023 };     /* PARTITION_NODES and more, all ones */
enum { STRIDE = 16 };           /* keys that are compared at once */

/* f and where it comes from, while the tree grows. */
typedef struct { Partition *p; const SkyMap *m; const PartitionOrder *o; } Growth;

static float f_towards(const PartitionOrder *o, V3 wi)
{
    float f = o->f(o->of, wi);
    return f > 0.0f && is_finite(f) ? f : 0.0f;
}

static float f_at(const Growth *g, uint32_t x, uint32_t y)
{
    return f_towards(g->o, skymap_corner(g->m, x, y));
}

/* Share in the standard deviation of f over the corners, times light and area. [Cline07 (5.3)] */
INLINE float potential_of(float f0, float f1, float f2, float f3, double sum, float cells)
{
    float mean = 0.25f * ((f0 + f1) + (f2 + f3));
    float s = (f_sqr(f0 - mean) + f_sqr(f1 - mean)) + (f_sqr(f2 - mean) + f_sqr(f3 - mean));

    return cells > 1.0f ? 0.5f * sqrtf(s) * (float)sum * cells : 0.0f;
}

/* As a whole number: floats that are not negative go by their bits. The last of them give way to
 * the leaf's number, so that the largest of all says whose it is: which of two within 1/8192 of
 * each other goes first does not matter. */
static uint32_t key_of(int i, float potential)
{
    uint32_t bits;
    memcpy(&bits, &potential, sizeof bits);
    return potential > 0.0f ? (bits & ~(uint32_t)KEY_LEAVES) | (uint32_t)i : 0;
}

/* All values are handed over, not read back from the node. */
INLINE void put_leaf(Partition *p, int i, uint32_t x0, uint32_t y0, uint32_t x1, uint32_t y1,
                     float f0, float f1, float f2, float f3, double sum)
{
    p->node[i] = (PartitionNode){ .x0 = (uint16_t)x0, .y0 = (uint16_t)y0, .x1 = (uint16_t)x1,
                                  .y1 = (uint16_t)y1, .f = { f0, f1, f2, f3 }, .sum = sum };
    p->key[i] = key_of(i, potential_of(f0, f1, f2, f3, sum, (float)((x1 - x0) * (y1 - y0))));
}

/* The leaf that holds a cell of the root. */
static int leaf_of(const Partition *p, uint32_t x, uint32_t y)
{
    int i = 0;

    while (p->node[i].child) {
        const PartitionNode *r = &p->node[i];
        i = r->child + ((r->by_x ? x : y) >= r->split);
    }
    return i;
}

/* Two more nodes, the children of leaf i. Keys come by the STRIDE, of which the last ones are 0. */
INLINE void put_fork(Partition *p, int i, bool by_x, uint32_t at)
{
    p->node[i].by_x = by_x;
    p->node[i].split = (uint16_t)at;
    p->node[i].child = (uint16_t)p->n;
    p->key[i] = 0;
    if ((p->n + 1) % STRIDE == 0)
        memset(&p->key[p->n + 1], 0, STRIDE * sizeof p->key[0]);
    p->n += 2;
}

/* Splits leaf i before column `at`, of which f at the upper and lower end is given. */
static void split_x(Growth *g, int i, uint32_t at, float upper, float lower)
{
    const PartitionNode *r = &g->p->node[i];
    uint32_t x0 = r->x0, x1 = r->x1, y0 = r->y0, y1 = r->y1;
    float f0 = r->f[0], f1 = r->f[1], f2 = r->f[2], f3 = r->f[3];
    double left = skymap_sum(g->m, x0, y0, at, y1), right = d_max(0.0, r->sum - left);
    int n = g->p->n;

    put_fork(g->p, i, true, at);
    put_leaf(g->p, n, x0, y0, at, y1, f0, upper, f2, lower, left);
    put_leaf(g->p, n + 1, at, y0, x1, y1, upper, f1, lower, f3, right);
}

static void split_y(Growth *g, int i, uint32_t at, float left, float right)
{
    const PartitionNode *r = &g->p->node[i];
    uint32_t x0 = r->x0, x1 = r->x1, y0 = r->y0, y1 = r->y1;
    float f0 = r->f[0], f1 = r->f[1], f2 = r->f[2], f3 = r->f[3];
    double upper = skymap_sum(g->m, x0, y0, x1, at), lower = d_max(0.0, r->sum - upper);
    int n = g->p->n;

    put_fork(g->p, i, false, at);
    put_leaf(g->p, n, x0, y0, x1, at, f0, f1, left, right, upper);
    put_leaf(g->p, n + 1, x0, at, x1, y1, left, right, f2, f3, lower);
}

static bool is_full(const Growth *g) { return g->p->n + 2 > PARTITION_NODES; }

/* The split of column x goes on across row y, up or down, as long as f where it arrives is above
 * that of the two corners beside it together. [Cline07 5.2.2, fig. 5.5] */
static void cascade_x(Growth *g, uint32_t x, uint32_t y, bool down, float f)
{
    while (!is_full(g) && (down ? y < g->p->node[0].y1 : y > g->p->node[0].y0)) {
        int i = leaf_of(g->p, x, down ? y : y - 1);
        const PartitionNode *r = &g->p->node[i];
        float far;
        if (x <= r->x0 || x >= r->x1 || !(f > (down ? r->f[0] + r->f[1] : r->f[2] + r->f[3])))
            return;
        y = down ? r->y1 : r->y0;
        far = f_at(g, x, y);
        split_x(g, i, x, down ? f : far, down ? far : f);
        f = far;
    }
}

/* The same of row y across column x, and on round the map, unless that is flat. */
static void cascade_y(Growth *g, uint32_t x, uint32_t y, bool right, float f)
{
    while (!is_full(g)) {
        uint32_t cell = right ? (x == g->m->w ? 0 : x) : (x == 0 ? g->m->w : x) - 1;
        int i = leaf_of(g->p, cell, y);
        const PartitionNode *r = &g->p->node[i];
        float far;
        if (g->m->flat && x == (right ? g->m->w : 0))
            return;
        if (y <= r->y0 || y >= r->y1 || !(f > (right ? r->f[0] + r->f[2] : r->f[1] + r->f[3])))
            return;
        x = right ? r->x1 : r->x0;
        far = f_at(g, x, y);
        split_y(g, i, y, right ? f : far, right ? far : f);
        f = far;
    }
}

static void divide_x(Growth *g, int i, uint32_t x)
{
    const PartitionNode *r = &g->p->node[i];
    uint32_t y0 = r->y0, y1 = r->y1;
    float upper, lower;

    if (is_full(g) || x <= r->x0 || x >= r->x1)
        return;
    upper = f_at(g, x, y0);
    lower = f_at(g, x, y1);
    split_x(g, i, x, upper, lower);
    cascade_x(g, x, y0, false, upper);
    cascade_x(g, x, y1, true, lower);
}

static void divide_y(Growth *g, int i, uint32_t y)
{
    const PartitionNode *r = &g->p->node[i];
    uint32_t x0 = r->x0, x1 = r->x1;
    float left, right;

    if (is_full(g) || y <= r->y0 || y >= r->y1)
        return;
    left = f_at(g, x0, y);
    right = f_at(g, x1, y);
    split_y(g, i, y, left, right);
    cascade_y(g, x0, y, false, left);
    cascade_y(g, x1, y, true, right);
}

/* Makes the corner (x, y) one of every leaf that touches it: by columns, then by rows. Errata 5.5:
 * a point may lie on an edge already. */
static void divide_at(Growth *g, uint32_t x, uint32_t y)
{
    const PartitionNode *root = &g->p->node[0];
    uint32_t w = g->m->w, left = x == 0 ? (g->m->flat ? 1 : w) : x;
    uint32_t side[2] = { x == w ? (g->m->flat ? w - 1 : 0) : x, left - 1 };
    uint32_t first = y > root->y0 ? y - 1 : y, last = y < root->y1 ? y : y - 1;

    if (y < root->y0 || y > root->y1)
        return;
    for (uint32_t row = first; row <= last; row++)
        if (x > 0 && x < w)
            divide_x(g, leaf_of(g->p, x, row), x);
    for (uint32_t row = first; row <= last; row++)
        for (int k = 0; k < 2; k++)
            divide_y(g, leaf_of(g->p, side[k], row), y);
}

static void nearest_corner(const SkyMap *m, V3 wi, uint32_t *x, uint32_t *y)
{
    float jacobian;
    V2 q = skymap_place(m, wi, &jacobian);

    *x = (uint32_t)((double)q.x * m->w + 0.5);
    if (!m->flat)
        *x %= m->w;
    *y = (uint32_t)((double)q.y * m->h + 0.5);
}

/* The rows that the hemisphere about `up` reaches, and the splits that show its cosine. */
static void plant(Growth *g, V3 up)
{
    const SkyMap *m = g->m;
    bool half = v_len2(up) > 0.0f;
    float jacobian, y = half ? skymap_place(m, up, &jacobian).y * (float)m->h : 0.0f;
    float reach = 0.5f * (float)m->h + 0.001f;          /* beyond what y is rounded by */
    uint32_t xn, yn, y0, y1;
    float upper, lower;

    y0 = half && y > reach ? (uint32_t)(y - reach) : 0;
    y1 = half && y + reach < (float)m->h ? (uint32_t)(y + reach + 1.0f) : m->h;
    upper = f_at(g, 0, y0);
    lower = f_at(g, 0, y1);
    memset(g->p->key, 0, STRIDE * sizeof g->p->key[0]);
    put_leaf(g->p, 0, 0, y0, m->w, y1, upper, upper, lower, lower,
             skymap_sum(m, 0, y0, m->w, y1));
    g->p->n = 1;
    if (half) {
        nearest_corner(m, up, &xn, &yn);
        divide_at(g, xn, yn);
        divide_at(g, (xn + m->w / 2) % m->w, yn);
    }
}

static void divide_at_peaks(Growth *g)
{
    const PartitionOrder *o = g->o;
    uint32_t x, y, cx, cy;
    float jacobian;

    for (int i = 0; i < o->peaks; i++) {
        nearest_corner(g->m, o->peak[i], &x, &y);
        divide_at(g, x, y);
    }
    for (int i = 0; i < o->tries; i++) {
        const PartitionNode *root = &g->p->node[0], *r;
        skymap_cell(g->m, skymap_place(g->m, o->tried[i], &jacobian), &cx, &cy);
        if (cy < root->y0 || cy >= root->y1)
            continue;
        r = &g->p->node[leaf_of(g->p, cx, cy)];
        if (!(f_towards(o, o->tried[i]) > 0.25f * ((r->f[0] + r->f[1]) + (r->f[2] + r->f[3]))))
            continue;
        nearest_corner(g->m, o->tried[i], &x, &y);
        divide_at(g, x, y);
    }
}

/* Along which axis f changes more. [Cline07 (5.4)], errata 5.8 */
static bool better_by_x(const PartitionNode *r)
{
    uint32_t w = r->x1 - r->x0, h = r->y1 - r->y0;
    float dx = f_sqr(r->f[1] - r->f[0]) + f_sqr(r->f[3] - r->f[2]);
    float dy = f_sqr(r->f[2] - r->f[0]) + f_sqr(r->f[3] - r->f[1]);

    return h == 1 || (w > 1 && dx * (float)w > dy * (float)h);
}

static void divide_by_potential(Growth *g)
{
    const Partition *p = g->p;

    for (int s = 0; s < g->o->splits && !is_full(g); s++) {
        uint32_t most = 0;
        int best;
        for (int i = 0; i < p->n; i += STRIDE)
            for (int k = i; k < i + STRIDE; k++)
                most = most > p->key[k] ? most : p->key[k];
        if (!most)
            return;
        best = (int)(most & KEY_LEAVES);
        if (better_by_x(&p->node[best]))
            divide_x(g, best, (p->node[best].x0 + p->node[best].x1) / 2u);
        else
            divide_y(g, best, (p->node[best].y0 + p->node[best].y1) / 2u);
    }
}

static double mean_f(const PartitionNode *r)
{
    return 0.25 * (((double)r->f[0] + r->f[1]) + ((double)r->f[2] + r->f[3]));
}

/* The unit square cut as the tree is, by weight [Cline07 fig. 5.13]: along x for columns, along y
 * for rows. Whoever has no weight has no part of it, to the last bit. errata 5.2 */
static void lay_out(Partition *p)
{
    p->part[0] = (PartitionPart){ { 0.0, 0.0 }, { 1.0, 1.0 } };
    for (int i = 0; i < p->n; i++) {                    /* parents stand before their children */
        const PartitionNode *r = &p->node[i], *a = &p->node[r->child];
        PartitionPart q = p->part[i];
        int k = !r->by_x;
        double share, cut;
        if (!r->child) {
            p->fork[i] = (PartitionFork){ 2.0, (uint16_t)i, 0 };
            continue;
        }
        share = r->weight > 0.0 ? a->weight / r->weight : 1.0;
        cut = share < 1.0 ? d_min(q.at[k] + (q.end[k] - q.at[k]) * share, q.end[k]) : q.end[k];
        p->fork[i] = (PartitionFork){ cut, r->child, (uint16_t)k };
        p->part[r->child] = p->part[r->child + 1] = q;
        p->part[r->child].end[k] = p->part[r->child + 1].at[k] = cut;
    }
}

/* Weights [Cline07 (5.5)] without the floor, then with it: f that gives its share to the map. */
static bool weigh(Partition *p)
{
    double light = 0.0, product = 0.0;

    for (int i = 0; i < p->n; i++)
        if (!p->node[i].child) {
            const PartitionNode *r = &p->node[i];
            light += r->sum;
            product += r->sum * mean_f(r);
        }
    if (!(light > 0.0))
        return false;
    p->floor = (float)(PARTITION_FLOOR * product / light);
    if (!(p->floor > 0.0f) || !is_finite(p->floor))
        p->floor = 1.0f;                /* f was 0 at all corners: the map says all there is */
    for (int i = p->n - 1; i >= 0; i--) {               /* children stand behind their parents */
        PartitionNode *r = &p->node[i];
        if (r->child) {
            r->weight = p->node[r->child].weight + p->node[r->child + 1].weight;
            continue;
        }
        for (int k = 0; k < 4; k++)
            r->f[k] = f_max(r->f[k], p->floor);
        r->weight = r->sum * mean_f(r);
    }
    lay_out(p);
    return p->node[0].weight > 0.0;
}

bool partition_make(Partition *p, const SkyMap *m, const PartitionOrder *o)
{
    Growth g = { p, m, o };

    p->map = m;
    plant(&g, o->up);
    divide_at_peaks(&g);
    divide_by_potential(&g);
    return weigh(p);
}

/* partition.c -- stage one: a partition of the sky map for a turn. See partition.h. */
#include "lightsampling/partition.h"

enum { KEY_LEAVES = 1023 };     /* PARTITION_NODES and more, all ones */

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
static float potential_of(const PartitionNode *r)
{
    float w = (float)(r->x1 - r->x0), h = (float)(r->y1 - r->y0);
    float mean = 0.25f * ((r->f[0] + r->f[1]) + (r->f[2] + r->f[3]));
    float s = (f_sqr(r->f[0] - mean) + f_sqr(r->f[1] - mean)) +
              (f_sqr(r->f[2] - mean) + f_sqr(r->f[3] - mean));

    if (w * h <= 1.0f)
        return 0.0f;
    return 0.5f * sqrtf(s) * (float)r->sum * (w * h);
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

static void finish_leaf(Growth *g, int i, double sum)
{
    PartitionNode *r = &g->p->node[i];

    r->child = 0;
    r->by_x = false;
    r->sum = sum;
    g->p->key[i] = key_of(i, potential_of(r));
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

/* Splits leaf i before column `at`, of which f at the upper and lower end is given. */
static void split_x(Growth *g, int i, uint32_t at, float upper, float lower)
{
    Partition *p = g->p;
    PartitionNode *r = &p->node[i], *a = &p->node[p->n], *b = a + 1;
    double left = skymap_sum(g->m, r->x0, r->y0, at, r->y1);

    *a = *b = *r;
    a->x1 = b->x0 = r->split = (uint16_t)at;
    a->f[1] = b->f[0] = upper;
    a->f[3] = b->f[2] = lower;
    r->by_x = true;
    r->child = (uint16_t)p->n;
    p->key[i] = 0;
    finish_leaf(g, p->n, left);
    finish_leaf(g, p->n + 1, d_max(0.0, r->sum - left));
    p->n += 2;
}

static void split_y(Growth *g, int i, uint32_t at, float left, float right)
{
    Partition *p = g->p;
    PartitionNode *r = &p->node[i], *a = &p->node[p->n], *b = a + 1;
    double upper = skymap_sum(g->m, r->x0, r->y0, r->x1, at);

    *a = *b = *r;
    a->y1 = b->y0 = r->split = (uint16_t)at;
    a->f[2] = b->f[0] = left;
    a->f[3] = b->f[1] = right;
    r->by_x = false;
    r->child = (uint16_t)p->n;
    p->key[i] = 0;
    finish_leaf(g, p->n, upper);
    finish_leaf(g, p->n + 1, d_max(0.0, r->sum - upper));
    p->n += 2;
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

/* The same of row y across column x, and on round the map. */
static void cascade_y(Growth *g, uint32_t x, uint32_t y, bool right, float f)
{
    while (!is_full(g)) {
        uint32_t cell = right ? (x == g->m->w ? 0 : x) : (x == 0 ? g->m->w : x) - 1;
        int i = leaf_of(g->p, cell, y);
        const PartitionNode *r = &g->p->node[i];
        float far;
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
    uint32_t w = g->m->w, side[2] = { x == w ? 0 : x, (x == 0 ? w : x) - 1 };
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

    *x = (uint32_t)((double)q.x * m->w + 0.5) % m->w;
    *y = (uint32_t)((double)q.y * m->h + 0.5);
}

/* The rows that the hemisphere about `up` reaches, and the splits that show its cosine. */
static void plant(Growth *g, V3 up)
{
    const SkyMap *m = g->m;
    PartitionNode *r = &g->p->node[0];
    bool half = v_len2(up) > 0.0f;
    float jacobian, y = half ? skymap_place(m, up, &jacobian).y * (float)m->h : 0.0f;
    float reach = 0.5f * (float)m->h + 0.001f;          /* beyond what y is rounded by */
    uint32_t xn, yn;

    g->p->n = 1;
    r->x0 = 0;
    r->x1 = (uint16_t)m->w;
    r->y0 = half && y > reach ? (uint16_t)(y - reach) : 0;
    r->y1 = half && y + reach < (float)m->h ? (uint16_t)(y + reach + 1.0f) : (uint16_t)m->h;
    r->f[0] = r->f[1] = f_at(g, 0, r->y0);
    r->f[2] = r->f[3] = f_at(g, 0, r->y1);
    finish_leaf(g, 0, skymap_sum(m, 0, r->y0, m->w, r->y1));
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

    for (int k = 0; k < g->o->splits && !is_full(g); k++) {
        uint32_t most = 0;
        int best;
        for (int i = 0; i < p->n; i++)
            most = most > p->key[i] ? most : p->key[i];
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

/* partition.c -- two stage importance sampling. See partition.h. */
#include "lightsampling/partition.h"

/* ---- stage one ---- */

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

static void finish_leaf(Growth *g, int i, double sum)
{
    PartitionNode *r = &g->p->node[i];

    r->child = 0;
    r->sum = sum;
    g->p->potential[i] = potential_of(r);
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
    p->potential[i] = -1.0f;
    finish_leaf(g, p->n, left);
    finish_leaf(g, p->n + 1, skymap_sum(g->m, at, r->y0, r->x1, r->y1));
    p->n += 2;
}

static void split_y(Growth *g, int i, uint32_t at, float left, float right)
{
    Partition *p = g->p;
    PartitionNode *r = &p->node[i], *a = &p->node[p->n], *b = a + 1;
    double top = skymap_sum(g->m, r->x0, r->y0, r->x1, at);

    *a = *b = *r;
    a->y1 = b->y0 = r->split = (uint16_t)at;
    a->f[2] = b->f[0] = left;
    a->f[3] = b->f[1] = right;
    r->by_x = false;
    r->child = (uint16_t)p->n;
    p->potential[i] = -1.0f;
    finish_leaf(g, p->n, top);
    finish_leaf(g, p->n + 1, skymap_sum(g->m, r->x0, at, r->x1, r->y1));
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
        int best = 0;
        for (int i = 1; i < p->n; i++)
            if (p->potential[i] > p->potential[best])
                best = i;
        if (!(p->potential[best] > 0.0f))
            return;
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

/* ---- stage two ---- */

/* A part of a leaf: cells, f at its corners, the table's entries there. Corners are numbered x +
 * 2 y, so that the next one along the axis x or y is 1 or 2 further on, whichever the axis is. */
typedef struct {
    uint32_t edge[2][2];        /* first column and row; those beyond the last */
    double f[4], s[4];
} Part;

static Part part_of(const SkyMap *m, const PartitionNode *r)
{
    const double *top = m->sum + (size_t)r->y0 * (m->w + 1);
    const double *end = m->sum + (size_t)r->y1 * (m->w + 1);

    return (Part){ { { r->x0, r->y0 }, { r->x1, r->y1 } },
                   { (double)r->f[0], (double)r->f[1], (double)r->f[2], (double)r->f[3] },
                   { top[r->x0], top[r->x1], end[r->x0], end[r->x1] } };
}

INLINE uint32_t side_of(const Part *p, int axis) { return p->edge[1][axis] - p->edge[0][axis]; }
INLINE bool is_cell(const Part *p) { return side_of(p, 0) * side_of(p, 1) == 1; }

/* Where a part is cut, before it is one of its halves. */
typedef struct {
    int    axis;
    uint32_t at;
    double f[2], s[2];          /* on the cut, at its two ends */
    double a, all;              /* weight of the first half, and of both */
} Halves;

/* [Cline07 fig. 5.14]. Both halves count their part of the light, of which the table's roundings
 * may leave none: then they go by area. */
INLINE Halves halve(const SkyMap *m, const Part *p)
{
    size_t pitch[2] = { 1, m->w + 1 };
    int axis = side_of(p, 0) <= side_of(p, 1);
    int other = 1 - axis, on = 1 + axis, across = 2 - axis;     /* to the next corner */
    uint32_t first = p->edge[0][axis], last = p->edge[1][axis], at = (first + last) / 2;
    double share = (double)(at - first) / (double)(last - first), b;
    const double *cut = m->sum + at * pitch[axis];
    Halves h = { axis, at, { p->f[0] + share * (p->f[on] - p->f[0]),
                             p->f[across] + share * (p->f[3] - p->f[across]) },
                 { cut[p->edge[0][other] * pitch[other]], cut[p->edge[1][other] * pitch[other]] }, 0, 0 };

    h.a = d_max(0.0, (h.s[1] - p->s[across]) - (h.s[0] - p->s[0])) *
          ((p->f[0] + p->f[across]) + (h.f[0] + h.f[1]));
    b = d_max(0.0, (p->s[3] - h.s[1]) - (p->s[on] - h.s[0])) *
        ((p->f[on] + p->f[3]) + (h.f[0] + h.f[1]));
    h.all = h.a + b;
    if (UNLIKELY(!(h.all > 0.0))) {
        h.a = share;
        h.all = 1.0;
    }
    return h;
}

/* Which half it is nobody can foretell: by numbers, without a branch. */
INLINE void take_half(Part *p, const Halves *h, int second)
{
    int on = 1 + h->axis, corner = on * (1 - second);

    p->f[corner] = h->f[0];
    p->s[corner] = h->s[0];
    p->f[corner + 3 - on] = h->f[1];
    p->s[corner + 3 - on] = h->s[1];
    p->edge[1 - second][h->axis] = h->at;
}

/* Density per solid angle of a cell that is drawn with this probability. */
static float cell_pdf_w(const SkyMap *m, double probability, float jacobian)
{
    return jacobian > 0.0f ? (float)(probability * ((double)m->w * m->h) / (double)jacobian) : 0.0f;
}

/* Which half a canonical number falls in; it becomes canonical again, within that: at most
 * 1 - 2^-50, of which no product with `all` rounds up to `all`. So a half of weight 0 is never the
 * one. errata 5.2 */
INLINE int falls_second(double *u, double a, double all)
{
    double x = *u * all;
    int second = x >= a;
    double weight = second ? all - a : a;

    *u = d_min((x - (second ? a : 0.0)) / weight, 1.0 - 0x1p-50);
    return second;
}

static float place_in(uint32_t cell, double rest, uint32_t n)
{
    float x = (float)((cell + rest) / n);
    uint32_t k = (uint32_t)((double)x * n);
    return x >= 1.0f || k > cell ? x - 0x1p-24f : k < cell ? x + 0x1p-24f : x;
}

/* A point on its way. */
typedef struct {
    double at[2], chosen, among;
    const PartitionNode *r;
    Part part;
} Fall;

/* Several at once, step by step: each step waits for the one before it, and the processor has the
 * others to go on with. */
enum { TOGETHER = 8 };

static void fall_to_leaves(const Partition *p, Fall *f, int n)
{
    int falling = n;

    for (int i = 0; i < n; i++)
        f[i].r = &p->node[0];
    while (falling) {                                   /* [Cline07 fig. 5.13] */
        falling = 0;
        for (int i = 0; i < n; i++) {
            const PartitionNode *r = f[i].r, *a = &p->node[r->child];
            if (!r->child)
                continue;
            f[i].r = a + falls_second(&f[i].at[!r->by_x], a->weight, r->weight);
            falling++;
        }
    }
    for (int i = 0; i < n; i++) {
        f[i].chosen = f[i].r->weight;
        f[i].among = p->node[0].weight;
        f[i].part = part_of(p->map, f[i].r);
    }
}

static void fall_to_cells(const SkyMap *m, Fall *f, int n)
{
    int falling = n;

    while (falling) {                                   /* [Cline07 fig. 5.14] */
        falling = 0;
        for (int i = 0; i < n; i++) {
            Halves h;
            int second;
            if (is_cell(&f[i].part))
                continue;
            h = halve(m, &f[i].part);
            second = falls_second(&f[i].at[h.axis], h.a, h.all);
            f[i].chosen *= second ? h.all - h.a : h.a;
            f[i].among *= h.all;
            take_half(&f[i].part, &h, second);
            falling++;
        }
    }
}

static void warp_some(const Partition *p, const V2 *u, PartitionSample *out, int n)
{
    const SkyMap *m = p->map;
    Fall f[TOGETHER];
    float jacobian;

    for (int i = 0; i < n; i++) {
        f[i].at[0] = (double)u[i].x;
        f[i].at[1] = (double)u[i].y;
    }
    fall_to_leaves(p, f, n);
    fall_to_cells(m, f, n);
    for (int i = 0; i < n; i++) {
        out[i].place = (V2){ place_in(f[i].part.edge[0][0], f[i].at[0], m->w),
                             place_in(f[i].part.edge[0][1], f[i].at[1], m->h) };
        out[i].wi = v_unit(skymap_direction(m, out[i].place, &jacobian));
        out[i].pdf_w = cell_pdf_w(m, f[i].chosen / f[i].among, jacobian);
    }
}

void partition_warp(const Partition *p, V2 u, PartitionSample *s) { warp_some(p, &u, s, 1); }

void partition_warp_many(const Partition *p, const V2 *u, PartitionSample *s, int n)
{
    for (int i = 0; i < n; i += TOGETHER)
        warp_some(p, u + i, s + i, n - i < TOGETHER ? n - i : TOGETHER);
}

/* ---- back ---- */

/* The cell's probability, and the rectangle of the unit square that is warped to it. */
static double find_cell(const Partition *p, uint32_t x, uint32_t y, double at[2], double side[2])
{
    const PartitionNode *r = &p->node[0];
    double probability;
    Part part;

    at[0] = at[1] = 0.0;
    side[0] = side[1] = 1.0;
    if (y < r->y0 || y >= r->y1)
        return 0.0;
    while (r->child) {
        const PartitionNode *a = &p->node[r->child];
        bool second = (r->by_x ? x : y) >= r->split;
        int k = r->by_x ? 0 : 1;
        at[k] += second ? side[k] * (a->weight / r->weight) : 0.0;
        side[k] *= (second ? r->weight - a->weight : a->weight) / r->weight;
        r = a + second;
        if (!(r->weight > 0.0))
            return 0.0;
    }
    probability = r->weight / p->node[0].weight;
    part = part_of(p->map, r);
    while (!is_cell(&part)) {
        Halves h = halve(p->map, &part);
        bool second = (h.axis ? y : x) >= h.at;
        double share = (second ? h.all - h.a : h.a) / h.all;
        at[h.axis] += second ? side[h.axis] * (h.a / h.all) : 0.0;
        side[h.axis] *= share;
        probability *= share;
        take_half(&part, &h, second);
    }
    return probability;
}

float partition_pdf_w(const Partition *p, V3 wi)
{
    V2 u;
    float pdf_w;
    return partition_unwarp(p, wi, &u, &pdf_w) ? pdf_w : 0.0f;
}

static float canonical(double x)
{
    return x < (double)ONE_MINUS_ULP ? (float)x : ONE_MINUS_ULP;
}

bool partition_unwarp(const Partition *p, V3 wi, V2 *u, float *pdf_w)
{
    const SkyMap *m = p->map;
    float jacobian;
    V2 place = skymap_place(m, wi, &jacobian);
    double at[2], side[2], probability;
    uint32_t x, y;

    skymap_cell(m, place, &x, &y);
    probability = find_cell(p, x, y, at, side);
    *pdf_w = cell_pdf_w(m, probability, jacobian);
    *u = (V2){ canonical(at[0] + side[0] * ((double)place.x * m->w - x)),
               canonical(at[1] + side[1] * ((double)place.y * m->h - y)) };
    return *pdf_w > 0.0f;
}

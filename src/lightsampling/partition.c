/* partition.c -- two stage importance sampling. See partition.h. */
#include "lightsampling/partition.h"

/* ---- stage one ---- */

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

/* ---- stage two ---- */

/* Points on their way, and the part of a leaf that each is in. Steps are the same for all, without
 * branches, so that a compiler can do several at once and the processor need not guess which half
 * it will be. */
enum { TOGETHER = 8 };

typedef struct {
    double u[2][TOGETHER];              /* the point, canonical within its part */
    double probability[TOGETHER];       /* of the part */
    int64_t x0[TOGETHER], x1[TOGETHER], y0[TOGETHER], y1[TOGETHER];
    double f00[TOGETHER], f10[TOGETHER], f01[TOGETHER], f11[TOGETHER];     /* f at its corners */
    double s00[TOGETHER], s10[TOGETHER], s01[TOGETHER], s11[TOGETHER];     /* and of the table */
    int64_t x[TOGETHER], y[TOGETHER];   /* where it is cut */
    double top[TOGETHER], end[TOGETHER], left[TOGETHER], right[TOGETHER];  /* of the table there */
    double middle[TOGETHER];
} Falls;

static void start_in(Falls *p, int i, const SkyMap *m, const PartitionNode *r, double probability)
{
    const double *top = m->sum + (size_t)r->y0 * (m->w + 1);
    const double *end = m->sum + (size_t)r->y1 * (m->w + 1);

    p->probability[i] = probability;
    p->x0[i] = r->x0;
    p->x1[i] = r->x1;
    p->y0[i] = r->y0;
    p->y1[i] = r->y1;
    p->f00[i] = (double)r->f[0];
    p->f10[i] = (double)r->f[1];
    p->f01[i] = (double)r->f[2];
    p->f11[i] = (double)r->f[3];
    p->s00[i] = top[r->x0];
    p->s10[i] = top[r->x1];
    p->s01[i] = end[r->x0];
    p->s11[i] = end[r->x1];
}

/* Middles, rounded up: of a single cell the cut is its far edge, and all of it in the first half.
 * False: all parts are cells. */
INLINE bool look_up(Falls *p, const SkyMap *m, int n)
{
    size_t pitch = m->w + 1;
    int64_t more = 0;

    for (int i = 0; i < n; i++) {
        const double *row;
        p->x[i] = (p->x0[i] + p->x1[i] + 1) / 2;
        p->y[i] = (p->y0[i] + p->y1[i] + 1) / 2;
        more |= (p->x1[i] - p->x[i]) | (p->y1[i] - p->y[i]);
        row = m->sum + (size_t)p->y[i] * pitch;
        p->top[i] = m->sum[(size_t)p->y0[i] * pitch + (size_t)p->x[i]];
        p->end[i] = m->sum[(size_t)p->y1[i] * pitch + (size_t)p->x[i]];
        p->left[i] = row[p->x0[i]];
        p->right[i] = row[p->x1[i]];
        p->middle[i] = row[p->x[i]];
    }
    return more != 0;
}

/* Which of two a canonical number falls on; it becomes canonical again, within that: at most
 * 1 - 2^-50, of which no product with `all` rounds up to `all`. So one of weight 0 never is the
 * one. errata 5.2 */
INLINE bool falls_second(double *u, double first, double all)
{
    double x = *u * all;
    bool second = x >= first;

    *u = d_min((x - (second ? first : 0.0)) / (second ? all - first : first), 1.0 - 0x1p-50);
    return second;
}

/* One step [Cline07 fig. 5.14], but by columns and rows at once: half as many, and how much is on
 * each side is known better. f on the cut is half of both ends, also where cells do not divide
 * evenly; if there is but one, the cut is its far edge. All quarters count their part of the light,
 * of which the table's roundings may leave none: then the first takes all. towards NULL: the way
 * goes by the point; else to that cell, and corner and side of the part's preimage are noted. */
typedef struct { int64_t x, y; double at[2], side[2]; } Aim;

INLINE void step(Falls *p, int i, Aim *towards)
{
    double f00 = p->f00[i], f10 = p->f10[i], f01 = p->f01[i], f11 = p->f11[i];
    double s00 = p->s00[i], s10 = p->s10[i], s01 = p->s01[i], s11 = p->s11[i];
    double top = p->top[i], end = p->end[i], left = p->left[i], right = p->right[i];
    double middle = p->middle[i];
    double by_x = p->x[i] == p->x1[i] ? 1.0 : 0.5, by_y = p->y[i] == p->y1[i] ? 1.0 : 0.5;
    double f_top = f00 + by_x * (f10 - f00), f_end = f01 + by_x * (f11 - f01);
    double f_left = f00 + by_y * (f01 - f00), f_right = f10 + by_y * (f11 - f10);
    double f = f_top + by_y * (f_end - f_top);
    double w00 = d_max(0.0, (middle - left) - (top - s00)) * ((f00 + f_top) + (f_left + f));
    double w10 = d_max(0.0, (right - middle) - (s10 - top)) * ((f10 + f_top) + (f_right + f));
    double w01 = d_max(0.0, (end - s01) - (middle - left)) * ((f01 + f_end) + (f_left + f));
    double w11 = d_max(0.0, (s11 - end) - (right - middle)) * ((f11 + f_end) + (f_right + f));
    double none = w00 + w01 + (w10 + w11) > 0.0 ? 0.0 : 1.0;
    double first = w00 + none + w01, all = first + (w10 + w11), upper, column;
    bool b, c;                          /* right, lower */

    b = towards ? towards->x >= p->x[i] : falls_second(&p->u[0][i], first, all);
    upper = b ? w10 : w00 + none;
    column = upper + (b ? w11 : w01);
    c = towards ? towards->y >= p->y[i] : falls_second(&p->u[1][i], upper, column);
    if (towards) {
        double of_row = column > 0.0 ? upper / column : 1.0;
        towards->at[0] += b ? towards->side[0] * (first / all) : 0.0;
        towards->at[1] += c ? towards->side[1] * of_row : 0.0;
        towards->side[0] *= (b ? all - first : first) / all;
        towards->side[1] *= c ? 1.0 - of_row : of_row;
    }
    p->probability[i] *= (c ? column - upper : upper) / all;
    p->f00[i] = c ? (b ? f : f_left) : b ? f_top : f00;
    p->f10[i] = c ? (b ? f_right : f) : b ? f10 : f_top;
    p->f01[i] = c ? (b ? f_end : f01) : b ? f : f_left;
    p->f11[i] = c ? (b ? f11 : f_end) : b ? f_right : f;
    p->s00[i] = c ? (b ? middle : left) : b ? top : s00;
    p->s10[i] = c ? (b ? right : middle) : b ? s10 : top;
    p->s01[i] = c ? (b ? end : s01) : b ? middle : left;
    p->s11[i] = c ? (b ? s11 : end) : b ? right : middle;
    p->x0[i] = b ? p->x[i] : p->x0[i];
    p->x1[i] = b ? p->x1[i] : p->x[i];
    p->y0[i] = c ? p->y[i] : p->y0[i];
    p->y1[i] = c ? p->y1[i] : p->y[i];
}

/* Density per solid angle of a cell that is drawn with this probability. */
static float cell_pdf_w(const SkyMap *m, double probability, float jacobian)
{
    return jacobian > 0.0f ? (float)(probability * ((double)m->w * m->h) / (double)jacobian) : 0.0f;
}

static float place_in(uint32_t cell, double rest, uint32_t n)
{
    float x = (float)((cell + rest) / n);
    uint32_t k = (uint32_t)((double)x * n);
    return x >= 1.0f || k > cell ? x - 0x1p-24f : k < cell ? x + 0x1p-24f : x;
}

/* To the leaves [Cline07 fig. 5.13]. Who is there waits for the others: all of it is in the first
 * of its children, itself. */
INLINE void fall_to_leaves(const Partition *p, Falls *f, int lanes)
{
    double first[TOGETHER], all[TOGETHER];
    int64_t node[TOGETHER] = { 0 }, child[TOGETHER], by_y[TOGETHER];

    for (;;) {
        int more = 0;
        for (int i = 0; i < lanes; i++) {
            const PartitionNode *r = &p->node[node[i]];
            more |= r->child;
            child[i] = r->child ? r->child : node[i];
            by_y[i] = !r->by_x;
            first[i] = p->node[child[i]].weight;
            all[i] = r->weight;
        }
        if (!more)
            break;
        for (int i = 0; i < lanes; i++) {
            double u = by_y[i] ? f->u[1][i] : f->u[0][i];
            node[i] = child[i] + falls_second(&u, first[i], all[i]);
            f->u[0][i] = by_y[i] ? f->u[0][i] : u;
            f->u[1][i] = by_y[i] ? u : f->u[1][i];
        }
    }
    for (int i = 0; i < lanes; i++)
        start_in(f, i, p->map, &p->node[node[i]], all[i] / p->node[0].weight);
}

INLINE void fall(const Partition *p, const V2 *u, PartitionSample *out, int n, int lanes)
{
    const SkyMap *m = p->map;
    float jacobian;
    Falls f;

    for (int i = 0; i < lanes; i++) {
        f.u[0][i] = (double)u[i < n ? i : 0].x;
        f.u[1][i] = (double)u[i < n ? i : 0].y;
    }
    fall_to_leaves(p, &f, lanes);
    while (look_up(&f, m, lanes))
        for (int i = 0; i < lanes; i++)
            step(&f, i, NULL);
    for (int i = 0; i < n; i++) {
        out[i].place = (V2){ place_in((uint32_t)f.x0[i], f.u[0][i], m->w),
                             place_in((uint32_t)f.y0[i], f.u[1][i], m->h) };
        out[i].wi = v_unit(skymap_direction(m, out[i].place, &jacobian));
        out[i].pdf_w = cell_pdf_w(m, f.probability[i], jacobian);
    }
}

void partition_warp(const Partition *p, V2 u, PartitionSample *s) { fall(p, &u, s, 1, 1); }

void partition_warp_many(const Partition *p, const V2 *u, PartitionSample *s, int n)
{
    for (int i = 0; i < n; i += TOGETHER)
        fall(p, u + i, s + i, n - i < TOGETHER ? n - i : TOGETHER, TOGETHER);
}

/* ---- back ---- */

/* The cell's probability, and the rectangle of the unit square that is warped to it. */
static double find_cell(const Partition *p, Aim *aim)
{
    const PartitionNode *r = &p->node[0];
    Falls f;

    aim->at[0] = aim->at[1] = 0.0;
    aim->side[0] = aim->side[1] = 1.0;
    if (aim->y < r->y0 || aim->y >= r->y1)
        return 0.0;
    while (r->child) {
        const PartitionNode *a = &p->node[r->child];
        bool second = (r->by_x ? aim->x : aim->y) >= r->split;
        int k = r->by_x ? 0 : 1;
        aim->at[k] += second ? aim->side[k] * (a->weight / r->weight) : 0.0;
        aim->side[k] *= (second ? r->weight - a->weight : a->weight) / r->weight;
        r = a + second;
        if (!(r->weight > 0.0))
            return 0.0;
    }
    start_in(&f, 0, p->map, r, r->weight / p->node[0].weight);
    while (f.probability[0] > 0.0 && look_up(&f, p->map, 1))
        step(&f, 0, aim);
    return f.probability[0];
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
    uint32_t x, y;
    Aim aim;

    skymap_cell(m, place, &x, &y);
    aim.x = x;
    aim.y = y;
    *pdf_w = cell_pdf_w(m, find_cell(p, &aim), jacobian);
    *u = (V2){ canonical(aim.at[0] + aim.side[0] * ((double)place.x * m->w - x)),
               canonical(aim.at[1] + aim.side[1] * ((double)place.y * m->h - y)) };
    return *pdf_w > 0.0f;
}

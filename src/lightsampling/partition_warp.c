/* partition_warp.c -- stage two: points of the unit square down a partition to directions, and
 * back. See partition.h.
 *
 * Departs     The source halves parts of a leaf along the longer side. Here they are cut along both
 *             at once, and several points go side by side. */
#include "lightsampling/partition.h"

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

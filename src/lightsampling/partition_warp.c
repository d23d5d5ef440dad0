/* partition_warp.c -- stage two: points of the unit square down a partition to directions, and
 * back. See partition.h.
 *
 * Departs     The source takes points down the tree by numbers made canonical again at each step;
 *             here the tree has cut the unit square beforehand. The source halves parts of a leaf
 *             along the longer side; here they are cut along both at once, and several points go
 *             side by side. */
#include "lightsampling/partition.h"

/* Points on their way. Steps are the same for all, without branches, so that a compiler can do
 * several at once and the processor need not guess which half it will be. */
enum { SIDE_BY_SIDE = 8, TOGETHER = 32 };

/* And the part of a leaf that each is in. */
typedef struct {
    double u[2][TOGETHER];              /* the point, canonical within its part */
    double probability[TOGETHER];       /* of the part */
    double f00[TOGETHER], f10[TOGETHER], f01[TOGETHER], f11[TOGETHER]; /* f at its corners */
    double s00[TOGETHER], s10[TOGETHER], s01[TOGETHER], s11[TOGETHER]; /* and of the table */
    int64_t x0[TOGETHER], x1[TOGETHER], y0[TOGETHER], y1[TOGETHER];
} Falls;

/* Where the parts are cut, and the table there. */
typedef struct {
    int64_t x[TOGETHER], y[TOGETHER];
    double top[TOGETHER], end[TOGETHER], left[TOGETHER], right[TOGETHER], middle[TOGETHER];
} Cuts;

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
INLINE bool look_up(const Falls *p, Cuts *c, const SkyMap *m, int n)
{
    int64_t top[TOGETHER], end[TOGETHER], left[TOGETHER], right[TOGETHER], middle[TOGETHER];
    int64_t pitch = (int64_t)m->w + 1, more = 0;

    for (int i = 0; i < n; i++) {
        int64_t x = (p->x0[i] + p->x1[i] + 1) / 2, y = (p->y0[i] + p->y1[i] + 1) / 2;
        c->x[i] = x;
        c->y[i] = y;
        top[i] = p->y0[i] * pitch + x;
        end[i] = p->y1[i] * pitch + x;
        middle[i] = y * pitch + x;
        left[i] = y * pitch + p->x0[i];
        right[i] = y * pitch + p->x1[i];
        more |= (p->x1[i] - x) | (p->y1[i] - y);
    }
    if (!more)
        return false;
    for (int i = 0; i < n; i++) {
        c->top[i] = m->sum[top[i]];
        c->end[i] = m->sum[end[i]];
        c->middle[i] = m->sum[middle[i]];
        c->left[i] = m->sum[left[i]];
        c->right[i] = m->sum[right[i]];
    }
    return true;
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

/* A cell, and the rectangle of the unit square that is warped to the part which holds it. */
typedef struct { int64_t x, y; double at[2], side[2]; } Aim;

/* One step [Cline07 fig. 5.14], but by columns and rows at once: half as many, and how much is on
 * each side is known better. f on the cut is half of both ends, also where cells do not divide
 * evenly; if there is but one, the cut is its far edge. All quarters count their part of the light,
 * of which the table's roundings may leave none: then the first takes all. towards NULL: the way
 * goes by the point; else to that cell, and corner and side of the part's preimage are noted. What
 * comes out is not written over what goes in, for the vectors' sake. */
INLINE void step(const Falls *p, const Cuts *cut, Falls *to, int i, Aim *towards)
{
    double f00 = p->f00[i], f10 = p->f10[i], f01 = p->f01[i], f11 = p->f11[i];
    double s00 = p->s00[i], s10 = p->s10[i], s01 = p->s01[i], s11 = p->s11[i];
    double top = cut->top[i], end = cut->end[i], left = cut->left[i], right = cut->right[i];
    double middle = cut->middle[i], u = p->u[0][i], v = p->u[1][i];
    int64_t x = cut->x[i], y = cut->y[i];
    double by_x = x == p->x1[i] ? 1.0 : 0.5, by_y = y == p->y1[i] ? 1.0 : 0.5;
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

    b = towards ? towards->x >= x : falls_second(&u, first, all);
    upper = b ? w10 : w00 + none;
    column = upper + (b ? w11 : w01);
    c = towards ? towards->y >= y : falls_second(&v, upper, column);
    if (towards) {
        double of_row = column > 0.0 ? upper / column : 1.0;
        towards->at[0] += b ? towards->side[0] * (first / all) : 0.0;
        towards->at[1] += c ? towards->side[1] * of_row : 0.0;
        towards->side[0] *= (b ? all - first : first) / all;
        towards->side[1] *= c ? 1.0 - of_row : of_row;
    }
    to->u[0][i] = u;
    to->u[1][i] = v;
    to->probability[i] = p->probability[i] * ((c ? column - upper : upper) / all);
    to->f00[i] = c ? (b ? f : f_left) : b ? f_top : f00;
    to->f10[i] = c ? (b ? f_right : f) : b ? f10 : f_top;
    to->f01[i] = c ? (b ? f_end : f01) : b ? f : f_left;
    to->f11[i] = c ? (b ? f11 : f_end) : b ? f_right : f;
    to->s00[i] = c ? (b ? middle : left) : b ? top : s00;
    to->s10[i] = c ? (b ? right : middle) : b ? s10 : top;
    to->s01[i] = c ? (b ? end : s01) : b ? middle : left;
    to->s11[i] = c ? (b ? s11 : end) : b ? right : middle;
    to->x0[i] = b ? x : p->x0[i];
    to->x1[i] = b ? p->x1[i] : x;
    to->y0[i] = c ? y : p->y0[i];
    to->y1[i] = c ? p->y1[i] : y;
}

/* Density per solid angle of a cell that is drawn with this probability. */
static float cell_pdf_w(const SkyMap *m, double probability, float jacobian)
{
    return jacobian > 0.0f ? (float)(probability * ((double)m->w * m->h) / (double)jacobian) : 0.0f;
}

/* To the next float up or down if rounding left the cell. */
INLINE float place_in(uint32_t cell, double rest, double n, double cells)
{
    float x = (float)((cell + rest) * n);
    uint32_t k = (uint32_t)((double)x * cells);
    return x >= 1.0f || k > cell ? x - 0x1p-24f : k < cell ? x + 0x1p-24f : x;
}

/* To the leaves [Cline07 fig. 5.13]. Who is there waits for the others. */
INLINE void fall_to_leaves(const Partition *p, const V2 *u, Falls *f, int from, int lanes)
{
    double at[2][SIDE_BY_SIDE];
    uint32_t node[SIDE_BY_SIDE] = { 0 };
    int more;

    for (int i = 0; i < lanes; i++) {
        at[0][i] = (double)u[i].x;
        at[1][i] = (double)u[i].y;
    }
    do {
        more = 0;
        for (int i = 0; i < lanes; i++) {
            const PartitionFork *r = &p->fork[node[i]];
            uint32_t next = r->first + (at[r->by_y][i] >= r->cut);
            more |= next ^ node[i];
            node[i] = next;
        }
    } while (more);
    for (int i = 0; i < lanes; i++) {
        const PartitionNode *r = &p->node[node[i]];
        const PartitionPart *q = &p->part[node[i]];
        for (int k = 0; k < 2; k++)
            f->u[k][from + i] = d_min((at[k][i] - q->at[k]) / (q->end[k] - q->at[k]),
                                      1.0 - 0x1p-50);
        start_in(f, from + i, p->map, r, r->weight / p->node[0].weight);
    }
}

/* From cells to directions. */
INLINE void land(const Partition *p, const Falls *f, PartitionSample *out, int n)
{
    const SkyMap *m = p->map;
    double across = 1.0 / m->w, down = 1.0 / m->h;
    float jacobian[TOGETHER];
    V2 place[TOGETHER];
    V3 wi[TOGETHER];

    for (int i = 0; i < n; i++) {
        place[i].x = place_in(f->x0[i], f->u[0][i], across, m->w);
        place[i].y = place_in(f->y0[i], f->u[1][i], down, m->h);
    }
    skymap_directions(m, place, wi, jacobian, n);
    for (int i = 0; i < n; i++) {
        out[i].place = place[i];
        out[i].wi = m->flat ? wi[i] : v_unit(wi[i]);
        out[i].pdf_w = cell_pdf_w(m, f->probability[i], jacobian[i]);
    }
}

void partition_warp(const Partition *p, V2 u, PartitionSample *s)
{
    Falls f[2];
    Cuts cut;
    int now = 0;

    fall_to_leaves(p, &u, &f[0], 0, 1);
    for (; look_up(&f[now], &cut, p->map, 1); now ^= 1)
        step(&f[now], &cut, &f[now ^ 1], 0, NULL);
    land(p, &f[now], s, 1);
}

/* To the cells, a step there and a step back: two names, so that a compiler sees that one is not
 * the other. */
static void fall_to_cells(Falls *f, const SkyMap *m, int lanes)
{
    Falls g;
    Cuts cut;

    while (look_up(f, &cut, m, lanes)) {
        for (int i = 0; i < lanes; i++)
            step(f, &cut, &g, i, NULL);
        if (!look_up(&g, &cut, m, lanes)) {
            *f = g;
            return;
        }
        for (int i = 0; i < lanes; i++)
            step(&g, &cut, f, i, NULL);
    }
}

void partition_warp_many(const Partition *p, const V2 *u, PartitionSample *s, int n)
{
    V2 point[TOGETHER];
    Falls f;

    for (int first = 0; first < n; first += TOGETHER) {
        int some = n - first < TOGETHER ? n - first : TOGETHER;
        int lanes = (some + SIDE_BY_SIDE - 1) / SIDE_BY_SIDE * SIDE_BY_SIDE;
        for (int i = 0; i < lanes; i++)
            point[i] = u[first + (i < some ? i : 0)];
        for (int i = 0; i < lanes; i += SIDE_BY_SIDE)
            fall_to_leaves(p, point + i, &f, i, SIDE_BY_SIDE);
        fall_to_cells(&f, p->map, lanes);
        land(p, &f, s + first, some);
    }
}

/* ---- back ---- */

/* The cell's probability, and the rectangle of the unit square that is warped to it. */
static double find_cell(const Partition *p, Aim *aim)
{
    const PartitionNode *r = &p->node[0];
    Falls f[2];
    Cuts cut;
    int now = 0;

    if (aim->y < r->y0 || aim->y >= r->y1)
        return 0.0;
    while (r->child)
        r = &p->node[r->child] + ((r->by_x ? aim->x : aim->y) >= r->split);
    if (!(r->weight > 0.0))
        return 0.0;
    for (int k = 0; k < 2; k++) {
        const PartitionPart *q = &p->part[r - p->node];
        aim->at[k] = q->at[k];
        aim->side[k] = q->end[k] - q->at[k];
    }
    f[0].u[0][0] = f[0].u[1][0] = 0.0;
    start_in(&f[0], 0, p->map, r, r->weight / p->node[0].weight);
    for (; f[now].probability[0] > 0.0 && look_up(&f[now], &cut, p->map, 1); now ^= 1)
        step(&f[now], &cut, &f[now ^ 1], 0, aim);
    return f[now].probability[0];
}

float partition_pdf_w(const Partition *p, V3 wi)
{
    V2 u;
    float pdf_w;
    return partition_unwarp(p, wi, &u, &pdf_w) ? pdf_w : 0.0f;
}

float partition_pdf_at(const Partition *p, V2 place, float jacobian)
{
    uint32_t x, y;
    Aim aim;

    skymap_cell(p->map, place, &x, &y);
    aim.x = x;
    aim.y = y;
    return cell_pdf_w(p->map, find_cell(p, &aim), jacobian);
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

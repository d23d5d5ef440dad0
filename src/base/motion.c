/* motion.c -- maps between two maps. See motion.h. */
#include "base/motion.h"

#include <string.h>

/* ---- three by three ---- */

static double determinant(const Linear *a)
{
    const double (*m)[3] = a->m;
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

static Linear inverse(const Linear *l)
{
    const double (*m)[3] = l->m;
    double scale = 1 / determinant(l);
    Linear out;

    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int a = (j + 1) % 3, b = (j + 2) % 3, c = (i + 1) % 3, d = (i + 2) % 3;
            out.m[i][j] = (m[a][c] * m[b][d] - m[a][d] * m[b][c]) * scale;
        }
    return out;
}

static Linear product(const Linear *l, const Linear *r)
{
    const double (*a)[3] = l->m, (*b)[3] = r->m;
    Linear out;

    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out.m[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
    return out;
}

/* a + t b */
static Linear sum(const Linear *a, const Linear *b, double t)
{
    Linear out;

    for (int k = 0; k < 9; k++)
        out.m[k / 3][k % 3] = a->m[k / 3][k % 3] + t * b->m[k / 3][k % 3];
    return out;
}

static Linear transposed(const Linear *a)
{
    Linear out;

    for (int k = 0; k < 9; k++)
        out.m[k % 3][k / 3] = a->m[k / 3][k % 3];
    return out;
}

static double largest(const Linear *a)
{
    double most = 0;

    for (int k = 0; k < 9; k++)
        most = d_max(most, fabs(a->m[k / 3][k % 3]));
    return most;
}

/* ---- taking maps apart ---- */

/* m = r s, r a rotation, s symmetric. r is the limit of averaging a matrix with the transpose of
 * its inverse, which leaves the rotation and takes each stretch x to (x + 1 / x) / 2; so from 1 to
 * 2^60, and after a scale to 1 at most, 70 steps are enough. [Higham86]. Where m mirrors, the
 * rotation of -m, since -1 is a mirror image in three dimensions and has no direction. */
static bool divide(const Linear *m, Linear *r, Linear *s)
{
    static const Linear none = { { { 0 } } };
    double most = largest(m), moved = 1;
    Linear back;

    if (!(most > 0))
        return false;
    *r = sum(&none, m, (determinant(m) < 0 ? -1 : 1) / most);
    for (int step = 0; step < 100 && moved > 1e-15; step++) {
        Linear mean;
        if (!(determinant(r) > 0))
            return false;
        back = inverse(r);
        back = transposed(&back);
        mean = sum(r, &back, 1);
        mean = sum(&none, &mean, 0.5);
        back = sum(&mean, r, -1);
        moved = largest(&back);
        *r = mean;
    }
    back = transposed(r);
    *s = product(&back, m);
    return moved < 1e-9;
}

/* Axis and angle of a rotation, by its quaternion, of which the part that is largest comes first so
 * that nothing small is divided by. [Shoemake92] */
static void axis_of(const Linear *turn, double axis[3], double *angle)
{
    const double (*r)[3] = turn->m;
    double trace = r[0][0] + r[1][1] + r[2][2], q[4], len;
    int k = 0;

    for (int i = 1; i < 3; i++)
        if (r[i][i] > r[k][k])
            k = i;
    if (trace > r[k][k]) {
        q[3] = 1 + trace;
        q[0] = r[2][1] - r[1][2];
        q[1] = r[0][2] - r[2][0];
        q[2] = r[1][0] - r[0][1];
    } else {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        q[k] = 1 + r[k][k] - r[i][i] - r[j][j];
        q[i] = r[i][k] + r[k][i];
        q[j] = r[j][k] + r[k][j];
        q[3] = r[j][i] - r[i][j];
    }
    len = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
    if (q[3] < 0)
        len = -len;                     /* the shorter way round */
    *angle = 2 * md_atan2(fabs(len), fabs(q[3]));
    for (int i = 0; i < 3; i++)
        axis[i] = len != 0 ? q[i] / len : i == 2;
}

static Linear linear_part(const Transform *t)
{
    Linear l;
    for (int i = 0; i < 3; i++)
        memcpy(l.m[i], t->m[i], sizeof l.m[i]);
    return l;
}

bool motion_init(Motion *m, const Transform *start, const Transform *end)
{
    Linear a = linear_part(start), b = linear_part(end), turned, stretched, back;

    memset(m, 0, sizeof *m);
    m->to_world = xf_affine(start);
    m->to_object = xf_affine_inverse(start);
    for (int i = 0; i < 3; i++) {
        m->from[i] = start->m[i][3];
        m->way[i] = end->m[i][3] - start->m[i][3];
        m->back_from[i] = start->inv[i][3];
        m->back_way[i] = end->inv[i][3] - start->inv[i][3];
    }
    back = sum(&b, &a, -1);
    m->slides = largest(&back) == 0;
    if (m->slides)
        return true;
    if (xf_swaps_hands(start) != xf_swaps_hands(end) || !divide(&a, &m->turned, &m->stretch) ||
        !divide(&b, &turned, &stretched))
        return false;
    m->growth = sum(&stretched, &m->stretch, -1);
    back = transposed(&m->turned);
    turned = product(&turned, &back);
    axis_of(&turned, m->axis, &m->angle);
    return true;
}

/* ---- at a time ---- */

/* The rotation about the axis by t times the angle: Rodrigues' formula. */
static Linear turn_at(const Motion *m, double t)
{
    double s = md_sin(t * m->angle), c = md_cos(t * m->angle);
    const double *a = m->axis;
    Linear out;

    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out.m[i][j] = a[i] * a[j] * (1 - c) + (i == j ? c : 0);
    for (int i = 0; i < 3; i++) {
        out.m[(i + 1) % 3][i] += s * a[(i + 2) % 3];
        out.m[i][(i + 1) % 3] -= s * a[(i + 2) % 3];
    }
    return out;
}

static void slide(const Motion *m, double t, Affine *to_world, Affine *to_object)
{
    *to_world = m->to_world;
    *to_object = m->to_object;
    for (int i = 0; i < 3; i++) {
        to_world->m[i][3] = (float)(m->from[i] + t * m->way[i]);
        to_object->m[i][3] = (float)(m->back_from[i] + t * m->back_way[i]);
    }
}

void motion_at(const Motion *m, float time, Affine *to_world, Affine *to_object)
{
    double t = time, at[3];
    Linear turn, stretch, there, back;

    if (m->slides) {
        slide(m, t, to_world, to_object);
        return;
    }
    turn = turn_at(m, t);
    turn = product(&turn, &m->turned);
    stretch = sum(&m->stretch, &m->growth, t);
    there = product(&turn, &stretch);
    back = inverse(&there);
    for (int i = 0; i < 3; i++)
        at[i] = m->from[i] + t * m->way[i];
    for (int i = 0; i < 3; i++) {
        const double *b = back.m[i];
        for (int j = 0; j < 3; j++) {
            to_world->m[i][j] = (float)there.m[i][j];
            to_object->m[i][j] = (float)b[j];
        }
        to_world->m[i][3] = (float)at[i];
        to_object->m[i][3] = (float)-(b[0] * at[0] + b[1] * at[1] + b[2] * at[2]);
    }
}

/* ---- bounds ---- */

/* Most of |x''| for the corners x of the box, see motion_box: a^2 |q| + 2 a |q'|, of which |q| has
 * its maximum at an end, being convex in t. */
static double bend_of(const Motion *m, Box b)
{
    double most = 0;

    for (int k = 0; k < 8; k++) {
        double p[3] = { k & 1 ? b.hi.x : b.lo.x, k & 2 ? b.hi.y : b.lo.y, k & 4 ? b.hi.z : b.lo.z };
        double q0 = 0, q1 = 0, way = 0;
        for (int i = 0; i < 3; i++) {
            const double *s = m->stretch.m[i], *g = m->growth.m[i];
            double q = s[0] * p[0] + s[1] * p[1] + s[2] * p[2];
            double d = g[0] * p[0] + g[1] * p[1] + g[2] * p[2];
            q0 += q * q;
            q1 += (q + d) * (q + d);
            way += d * d;
        }
        most = d_max(most, m->angle * m->angle * sqrt(d_max(q0, q1)) + 2 * m->angle * sqrt(way));
    }
    return most;
}

/* A point p of the box is at x(t) = R(t) q(t) + from + t way, where q(t) = S(t) p is linear in t
 * and R turns at the speed a = angle: |R'| = a, |R''| = a^2 as maps. So x'' = R'' q + 2 R' q', at
 * most a^2 |q| + 2 a |q'|, and between two times h apart x leaves the line between its two places
 * by at most h^2 / 8 of that, in each coordinate. At one time the map is affine, so what holds the
 * corners holds the box; and a box that holds both ends of lines holds the lines. Hence: the boxes
 * at times h apart, joined, and made larger by h^2 / 8 of the most. With a slide the lines are the
 * truth, and two times will do. */
Box motion_box(const Motion *m, Box b)
{
    int steps = m->slides ? 1 : 1 + (int)(m->angle * 16);
    double h = 1.0 / steps, bend = m->slides || box_is_empty(b) ? 0 : bend_of(m, b) * h * h / 8;
    float margin = (float)bend * (1.0f + ROUNDINGS(4));
    Box all = box_empty();

    for (int k = 0; k <= steps; k++) {
        Affine to_world, to_object;
        motion_at(m, (float)k / (float)steps, &to_world, &to_object);
        all = box_join(all, affine_box(&to_world, b));
    }
    return box_is_empty(all) ? all : (Box){ v_sub(all.lo, v_all(margin)),
                                            v_add(all.hi, v_all(margin)) };
}

/* transform.c -- 4x4 maps. See transform.h. */
#include "base/transform.h"

#include <string.h>

Transform xf_identity(void)
{
    Transform t;
    memset(&t, 0, sizeof t);
    for (int i = 0; i < 4; i++)
        t.m[i][i] = t.inv[i][i] = 1;
    return t;
}

Transform xf_translate(double x, double y, double z)
{
    Transform t = xf_identity();
    t.m[0][3] = x;
    t.m[1][3] = y;
    t.m[2][3] = z;
    t.inv[0][3] = -x;
    t.inv[1][3] = -y;
    t.inv[2][3] = -z;
    return t;
}

Transform xf_scale(double x, double y, double z)
{
    Transform t = xf_identity();
    t.m[0][0] = x;
    t.m[1][1] = y;
    t.m[2][2] = z;
    t.inv[0][0] = 1 / x;
    t.inv[1][1] = 1 / y;
    t.inv[2][2] = 1 / z;
    return t;
}

static void transpose(double to[4][4], double from[4][4])
{
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            to[i][j] = from[j][i];
}

/* Rodrigues' formula; the angle is reduced in degrees, so that 90 is exact. */
Transform xf_rotate(double degrees, double x, double y, double z)
{
    Transform t = xf_identity();
    double len = sqrt(x * x + y * y + z * z), s, c;
    double a = degrees - 360 * floor(degrees / 360);

    if (!(len > 0))
        return t;
    x /= len;
    y /= len;
    z /= len;
    s = a == 90 ? 1 : a == 180 ? 0 : a == 270 ? -1 : md_sin(a * (PI / 180));
    c = a == 90 || a == 270 ? 0 : a == 180 ? -1 : md_cos(a * (PI / 180));
    t.m[0][0] = x * x + (1 - x * x) * c;
    t.m[0][1] = x * y * (1 - c) - z * s;
    t.m[0][2] = x * z * (1 - c) + y * s;
    t.m[1][0] = x * y * (1 - c) + z * s;
    t.m[1][1] = y * y + (1 - y * y) * c;
    t.m[1][2] = y * z * (1 - c) - x * s;
    t.m[2][0] = x * z * (1 - c) - y * s;
    t.m[2][1] = y * z * (1 - c) + x * s;
    t.m[2][2] = z * z + (1 - z * z) * c;
    transpose(t.inv, t.m);
    return t;
}

/* Gauss-Jordan with full pivoting. */
static bool invert(double out[4][4], double in[4][4])
{
    double a[4][8];

    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) {
            if (in[i][j] - in[i][j] != 0)
                return false;
            a[i][j] = in[i][j];
            a[i][j + 4] = i == j;
        }
    for (int k = 0; k < 4; k++) {
        int best = k;
        double p;
        for (int i = k + 1; i < 4; i++)
            if (fabs(a[i][k]) > fabs(a[best][k]))
                best = i;
        p = a[best][k];
        if (p == 0)
            return false;
        for (int j = 0; j < 8; j++) {
            double swap = a[k][j];
            a[k][j] = a[best][j] / p;
            if (best != k)
                a[best][j] = swap;
        }
        for (int i = 0; i < 4; i++)
            if (i != k) {
                double f = a[i][k];
                for (int j = 0; j < 8; j++)
                    a[i][j] -= f * a[k][j];
            }
    }
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) {
            out[i][j] = a[i][j + 4];
            if (out[i][j] - out[i][j] != 0)
                return false;
        }
    return true;
}

bool xf_from(Transform *t, double m[4][4])
{
    memcpy(t->m, m, sizeof t->m);
    return invert(t->inv, t->m);
}

bool xf_look_at(Transform *t, V3 eye, V3 at, V3 up)
{
    double d[3] = { (double)at.x - eye.x, (double)at.y - eye.y, (double)at.z - eye.z };
    double u[3] = { up.x, up.y, up.z }, r[3], n[3], len = 0;
    double m[4][4] = { { 0 } };

    for (int i = 0; i < 3; i++)
        len += d[i] * d[i];
    len = sqrt(len);
    for (int i = 0; i < 3; i++)
        d[i] /= len;
    r[0] = u[1] * d[2] - u[2] * d[1];               /* right = up x forward: left-handed */
    r[1] = u[2] * d[0] - u[0] * d[2];
    r[2] = u[0] * d[1] - u[1] * d[0];
    len = sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
    for (int i = 0; i < 3; i++)
        r[i] /= len;
    n[0] = d[1] * r[2] - d[2] * r[1];
    n[1] = d[2] * r[0] - d[0] * r[2];
    n[2] = d[0] * r[1] - d[1] * r[0];
    for (int i = 0; i < 3; i++) {                   /* camera to world: columns are its axes */
        m[i][0] = r[i];
        m[i][1] = n[i];
        m[i][2] = d[i];
    }
    m[0][3] = eye.x;
    m[1][3] = eye.y;
    m[2][3] = eye.z;
    m[3][3] = 1;
    if (!xf_from(t, m))
        return false;
    *t = xf_inverse(t);
    return true;
}

static void multiply(double out[4][4], const double a[4][4], const double b[4][4])
{
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            out[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j] +
                        a[i][3] * b[3][j];
}

Transform xf_then(const Transform *a, const Transform *b)
{
    Transform t;
    multiply(t.m, a->m, b->m);
    multiply(t.inv, b->inv, a->inv);
    return t;
}

Transform xf_inverse(const Transform *t)
{
    Transform r;
    memcpy(r.m, t->inv, sizeof r.m);
    memcpy(r.inv, t->m, sizeof r.inv);
    return r;
}

V3 xf_point(const Transform *t, V3 p)
{
    const double (*m)[4] = t->m;
    double x = m[0][0] * p.x + m[0][1] * p.y + m[0][2] * p.z + m[0][3];
    double y = m[1][0] * p.x + m[1][1] * p.y + m[1][2] * p.z + m[1][3];
    double z = m[2][0] * p.x + m[2][1] * p.y + m[2][2] * p.z + m[2][3];
    double w = m[3][0] * p.x + m[3][1] * p.y + m[3][2] * p.z + m[3][3];
    return w == 1 ? v3((float)x, (float)y, (float)z)
                  : v3((float)(x / w), (float)(y / w), (float)(z / w));
}

V3 xf_vector(const Transform *t, V3 v)
{
    const double (*m)[4] = t->m;
    return v3((float)(m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z),
              (float)(m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z),
              (float)(m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z));
}

V3 xf_normal(const Transform *t, V3 n)
{
    const double (*m)[4] = t->inv;
    return v3((float)(m[0][0] * n.x + m[1][0] * n.y + m[2][0] * n.z),
              (float)(m[0][1] * n.x + m[1][1] * n.y + m[2][1] * n.z),
              (float)(m[0][2] * n.x + m[1][2] * n.y + m[2][2] * n.z));
}

static double determinant(const double m[4][4])
{
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

bool xf_swaps_hands(const Transform *t) { return determinant(t->m) < 0; }

bool xf_is_identity(const Transform *t)
{
    Transform i = xf_identity();
    for (int r = 0; r < 4; r++)
        for (int c = 0; c < 4; c++)
            if (t->m[r][c] != i.m[r][c])
                return false;
    return true;
}

/* The 3x3 part is s Q with Q orthogonal if its columns are orthogonal and of one length s; 1e-6
 * is the rounding of matrices that were written with seven digits. */
bool xf_is_similarity(const Transform *t, double *scale)
{
    const double (*m)[4] = t->m;
    double dot[3][3], s2;

    if (m[3][0] != 0 || m[3][1] != 0 || m[3][2] != 0 || m[3][3] != 1)
        return false;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            dot[i][j] = m[0][i] * m[0][j] + m[1][i] * m[1][j] + m[2][i] * m[2][j];
    s2 = dot[0][0];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            if (fabs(dot[i][j] - (i == j ? s2 : 0)) > 1e-6 * s2)
                return false;
    *scale = sqrt(s2);
    return s2 > 0;
}

static Affine affine_of(const double m[4][4])
{
    Affine a;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            a.m[i][j] = (float)m[i][j];
    return a;
}

Affine xf_affine(const Transform *t) { return affine_of(t->m); }
Affine xf_affine_inverse(const Transform *t) { return affine_of(t->inv); }

Box affine_box(const Affine *m, Box b)
{
    Box out = box_empty();
    V3 e;

    if (box_is_empty(b))
        return out;
    for (int i = 0; i < 8; i++)
        out = box_point(out, affine_point(m, v3(i & 1 ? b.hi.x : b.lo.x, i & 2 ? b.hi.y : b.lo.y,
                                                i & 4 ? b.hi.z : b.lo.z)));
    e = v_mad(v_max(v_abs(out.lo), v_abs(out.hi)), ROUNDINGS(8),
              v_all(ROUNDINGS(8) * v_max3(v_sub(out.hi, out.lo))));
    return (Box){ v_sub(out.lo, e), v_add(out.hi, e) };
}

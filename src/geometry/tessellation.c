/* tessellation.c -- points, triangles and normals of regular tessellations. See tessellation.h. */
#include "geometry/tessellation.h"

#include "base/error.h"
#include "base/mem.h"
#include "geometry/triangle.h"

#include <string.h>

/* Numbers are kept for each axis that `values` has. */
static int first_axis(const Tessellation *t) { return t->heights ? 2 : 0; }
static size_t width(const Tessellation *t) { return t->heights ? 1 : 3; }

size_t tessellation_points(const Tessellation *t)
{
    return t->triangular ? tessellation_index(t, 0, t->nv) : (size_t)t->nu * t->nv;
}

uint32_t tessellation_faces(const Tessellation *t)
{
    uint32_t rows = t->nv - 1;
    return t->triangular ? rows * rows : 2 * rows * (t->nu - 1);
}

size_t tessellation_bytes(const Tessellation *t)
{
    return tessellation_points(t) * width(t) * (t->values ? sizeof(float) : sizeof(uint16_t));
}

bool tessellation_init(Tessellation *t, bool triangular, uint32_t nu, uint32_t nv,
                       const Transform *map)
{
    double faces = triangular ? (nv - 1.0) * (nv - 1.0) : 2.0 * (nu - 1.0) * (nv - 1.0);

    ASSERT(nu >= 2 && nv >= 2 && (!triangular || nu == nv));
    memset(t, 0, sizeof *t);
    if (faces >= UINT32_MAX || nu > TESSELLATION_MOST || nv > TESSELLATION_MOST)
        return err_at((Place){ NULL, 0, 0 }, "a tessellation of %.0f triangles, expected at most "
                      "%lu", faces, (unsigned long)UINT32_MAX - 1);
    t->triangular = triangular;
    t->heights = map != NULL;
    t->nu = nu;
    t->nv = nv;
    if (map)
        memcpy(t->map, map->m, sizeof t->map);
    t->values = MEM_ARRAY(float, tessellation_points(t) * width(t));
    return t->values != NULL;
}

void tessellation_clear(Tessellation *t)
{
    mem_free(t->values);
    mem_free(t->fractions);
    memset(t, 0, sizeof *t);
}

/* The nearest fraction of the range of all; the range is halved first, since it may overflow. */
static bool make_fractions(Tessellation *t)
{
    size_t n = tessellation_points(t), w = width(t);
    uint16_t *q = MEM_ARRAY(uint16_t, n * w);

    if (!q)
        return false;
    for (size_t k = 0; k < w; k++) {
        int axis = first_axis(t) + (int)k;
        float lo = INFINITY, hi = -INFINITY;
        for (size_t i = k; i < n * w; i += w) {
            lo = f_min(lo, t->values[i]);
            hi = f_max(hi, t->values[i]);
        }
        t->lo[axis] = lo;
        t->step[axis] = 2.0f * ((0.5f * hi - 0.5f * lo) / 65535.0f);
        for (size_t i = k; i < n * w; i += w) {
            double x = ((double)t->values[i] - lo) / t->step[axis] + 0.5;
            q[i] = x > 0 ? x < 65535 ? (uint16_t)x : 65535 : 0;         /* 0 / 0: step is 0 */
        }
    }
    mem_free(t->values);
    t->values = NULL;
    t->fractions = q;
    return true;
}

bool tessellation_copy(Tessellation *to, const Tessellation *from)
{
    size_t n = tessellation_points(from) * width(from);
    bool ok;

    *to = *from;
    to->values = from->values ? MEM_ARRAY(float, n) : NULL;
    to->fractions = from->fractions ? MEM_ARRAY(uint16_t, n) : NULL;
    ok = to->values || to->fractions;
    if (to->values)
        memcpy(to->values, from->values, n * sizeof *to->values);
    if (to->fractions)
        memcpy(to->fractions, from->fractions, n * sizeof *to->fractions);
    if (!ok)
        memset(to, 0, sizeof *to);
    return ok;
}

static Box row_box(const Tessellation *t, uint32_t y)
{
    uint32_t end = t->triangular ? 2 * y + 3 : 2 * t->nu;
    V3 a = tessellation_strip(t, y, 0), b = tessellation_strip(t, y, 1);
    Box box = box_empty();

    for (uint32_t k = 2; k < end; k++) {
        V3 c = tessellation_strip(t, y, k);
        box = box_join(box, triangle_box(a, b, c));
        a = b;
        b = c;
    }
    return box;
}

bool tessellation_finish(Tessellation *t, int bits)
{
    if (bits == 16 && !make_fractions(t))
        return false;
    t->bounds = box_empty();
    for (uint32_t y = 0; y + 1 < t->nv; y++)
        t->bounds = box_join(t->bounds, row_box(t, y));
    return true;
}

void tessellation_places(const Tessellation *t, uint32_t face, GridPoint at[3])
{
    uint32_t across = 2 * (t->nu - 1);
    uint32_t y = t->triangular ? (uint32_t)sqrt((double)face) : face / across;
    uint32_t position = t->triangular ? face - y * y : face % across ^ 1, x = position / 2;

    at[0] = (GridPoint){ x, y };
    at[1] = position & 1 ? (GridPoint){ x + 1, y } : (GridPoint){ x + 1, y + 1 };
    at[2] = position & 1 ? (GridPoint){ x + 1, y + 1 } : (GridPoint){ x, y + 1 };
}

void tessellation_corners(const Tessellation *t, uint32_t face, V3 c[3])
{
    GridPoint at[3];

    tessellation_places(t, face, at);
    for (int k = 0; k < 3; k++)
        c[k] = tessellation_point(t, at[k].x, at[k].y);
}

/* ---- normals ---- */

static bool inside(const Tessellation *t, int64_t x, int64_t y)
{
    return 0 <= x && 0 <= y && y < (int64_t)t->nv && x <= (t->triangular ? y : (int64_t)t->nu - 1);
}

/* The grid continued beyond the sides that (x, y) lies beyond. A side that folds is turned by half
 * a turn about its middle. */
static void continue_grid(const Tessellation *t, int64_t *x, int64_t *y)
{
    int64_t mx = (int64_t)t->nu - 1, my = (int64_t)t->nv - 1;
    int64_t right = t->triangular ? *y : mx;            /* the last x of the row */

    if (t->border == BORDER_WRAPS) {
        *x = *x < 0 ? *x + mx : *x > mx ? *x - mx : *x;
        *y = *y < 0 ? *y + my : *y > my ? *y - my : *y;
        return;
    }
    if (*x < 0 || *x > right) {
        *x = *x < 0 ? -*x : t->triangular ? mx - *x : 2 * mx - *x;
        *y = my - *y;
    }
    if (*y < 0 || *y > my) {
        *x = mx - *x;
        *y = *y < 0 ? -*y : 2 * my - *y;
    }
}

/* The point dx, dy from `at`; where nothing is there, that point itself. */
static V3 beside(const Tessellation *t, GridPoint at, int dx, int dy)
{
    int64_t x = (int64_t)at.x + dx, y = (int64_t)at.y + dy;

    if (!inside(t, x, y) && t->border != BORDER_OPEN)
        continue_grid(t, &x, &y);
    return inside(t, x, y) ? tessellation_point(t, (uint32_t)x, (uint32_t)y)
                           : tessellation_point(t, at.x, at.y);
}

/* From the ways along rows and columns and, in a triangular grid, along the third side of its
 * triangles: at its border two of the three lead somewhere. */
V3 tessellation_normal(const Tessellation *t, GridPoint at)
{
    V3 u = v_sub(beside(t, at, 1, 0), beside(t, at, -1, 0));
    V3 v = v_sub(beside(t, at, 0, 1), beside(t, at, 0, -1));
    V3 w, n = v_cross(u, v);

    if (!t->triangular)
        return n;
    w = v_sub(beside(t, at, 1, 1), beside(t, at, -1, -1));
    return v_add(n, v_add(v_cross(u, w), v_cross(w, v)));
}

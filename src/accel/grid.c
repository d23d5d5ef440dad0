/* grid.c -- equal cells, each with a list of the primitives in it, and grids within dense cells.
 *
 * Source      [Cline07 2.2.1, 3.4.1] one cell a primitive; [Fujimoto86] the walk from cell to cell;
 *             [Klimaszewski97] grids within cells; mailboxes [Amanatides87].
 * Idea        A ray asks only the cells along it, in their order, and ends once a hit lies before
 *             the next ones.
 * Departs     The walk goes by slices along the axis on which the ray crosses most cells: of each
 *             slice it visits the rectangle of cells that the ray can be in, all in double. So it
 *             cannot stray, and visits a cell or two a slice more than stepping would.
 * No hit lost Every cell that a hit could be in is visited, see line.h. The cell of a coordinate
 *             never falls as the coordinate rises, for primitives and rays alike, so what is near a
 *             point of the ray is found whatever the rounding of that map.
 * Mailbox     A primitive in many cells is tested once, but for collisions in a table of 64. */
#include "accel/accel.h"
#include "accel/cells.h"
#include "accel/line.h"
#include "accel/prim.h"
#include "base/d3.h"
#include "base/mem.h"

#include <float.h>
#include <string.h>

/* NEST_LEAST: primitives of a cell that gets a grid; DEPTH_MOST: grids in grids; RES_MOST: cells
 * along an axis; MOST and MOST_NESTED: cells that a primitive takes on average, see add_grid. */
enum { NEST_LEAST = 24, DEPTH_MOST = 3, RES_MOST = 1 << 15, MOST = 16, MOST_NESTED = 4 };

/* Entries of cells: primitives, or a grid within the cell. */
#define NESTED ((uint32_t)1 << 31)

typedef struct {
    double lo[3], size[3], per[3];      /* of cells; per = 1 / size */
    int    res[3];
    uint32_t *start;                    /* owned; of each cell and one more, in `entry` */
    uint32_t *entry;                    /* owned */
} Cells;

typedef struct {
    Accel  base;
    Box    box;                         /* of everything */
    double slack;
    Cells *grid;                        /* owned; the first is the outermost */
    size_t ngrids, cap_grids;
} Grid;

static size_t cells_of(const Cells *c) { return (size_t)c->res[0] * c->res[1] * c->res[2]; }

/* The cell along an axis; what lies outside counts as in the outermost ones, and so does what is no
 * number. */
static int cell_at(const Cells *c, int axis, double x)
{
    double i = (x - c->lo[axis]) * c->per[axis];
    return i >= c->res[axis] ? c->res[axis] - 1 : i > 0 ? (int)i : 0;
}

static size_t cell_index(const Cells *c, int x, int y, int z)
{
    return ((size_t)z * c->res[1] + y) * c->res[0] + x;
}

/* ---- building ---- */

/* About `wanted` cells, as near to cubes as the box allows: their side is found by halving. It is
 * no less than `least`. */
static void choose_cells(Cells *c, const double lo[3], const double hi[3], double wanted,
                         double least)
{
    double extent[3], most = 0, small, large;

    for (int k = 0; k < 3; k++) {
        extent[k] = hi[k] - lo[k];
        most = d_max(most, extent[k]);
    }
    small = d_max(most / RES_MOST, least);
    large = d_max(most, small);
    for (int i = 0; i < 50; i++) {
        double side = 0.5 * (small + large), cells = 1;
        for (int k = 0; k < 3; k++)
            cells *= d_max(1, extent[k] / side);
        *(cells > wanted ? &small : &large) = side;
    }
    for (int k = 0; k < 3; k++) {
        double n = large > 0 ? extent[k] / large : 1;
        c->res[k] = n >= RES_MOST ? RES_MOST : n > 1 ? (int)n : 1;
        c->lo[k] = lo[k];
        c->size[k] = extent[k] / c->res[k];
        c->per[k] = c->size[k] > 0 ? 1 / c->size[k] : 0;
    }
}

/* The cells of a box, and the plane of a triangle, which passes by many of them. */
typedef struct {
    int    from[3], to[3];
    bool   flat;                        /* a triangle with a plane */
    double n[3], at, reach;             /* n . x = at; how far off it still counts */
} Cover;

static Cover cover_of(const Grid *g, const Cells *c, uint32_t prim)
{
    Box b = geometry_box(g->base.geo, prim);
    Cover v;
    V3 p[3];
    D3 n;

    for (int k = 0; k < 3; k++) {
        v.from[k] = cell_at(c, k, v_axis(b.lo, k));
        v.to[k] = cell_at(c, k, v_axis(b.hi, k));
    }
    v.flat = geometry_is_tri(g->base.geo, prim);
    if (!v.flat)
        return v;
    geometry_corners(g->base.geo, prim, p);
    n = d3_normal(p[0], p[1], p[2]);
    v.n[0] = n.x;
    v.n[1] = n.y;
    v.n[2] = n.z;
    v.at = d3_dot(n, d3_of(p[0]));
    v.reach = 0;
    for (int k = 0; k < 3; k++)
        v.reach += fabs(v.n[k]) * (0.5 * c->size[k] + 2 * g->slack);
    v.flat = v.reach > 0 && v.reach < DBL_MAX;
    return v;
}

/* Does the plane pass the cell? The middle of a cell is in reach of it then. Those at the border
 * have no end, so they are always passed. */
static bool covers(const Cells *c, const Cover *v, const int i[3])
{
    double off = -v->at;

    if (!v->flat)
        return true;
    for (int k = 0; k < 3; k++) {
        if (i[k] == 0 || i[k] == c->res[k] - 1)
            return true;
        off += v->n[k] * (c->lo[k] + (i[k] + 0.5) * c->size[k]);
    }
    return fabs(off) <= v->reach;
}

/* Counts the primitive in each of its cells, or, where `entry` is, puts it there. */
static void register_prim(const Grid *g, const Cells *c, uint32_t prim, uint32_t *start,
                          uint32_t *entry)
{
    Cover v = cover_of(g, c, prim);
    int i[3];

    for (i[2] = v.from[2]; i[2] <= v.to[2]; i[2]++)
        for (i[1] = v.from[1]; i[1] <= v.to[1]; i[1]++)
            for (i[0] = v.from[0]; i[0] <= v.to[0]; i[0]++)
                if (covers(c, &v, i)) {
                    size_t at = cell_index(c, i[0], i[1], i[2]);
                    if (entry)
                        entry[start[at]] = prim;
                    start[at]++;
                }
}

/* Cells that the boxes of the primitives take, at most. */
static double cells_taken(const Grid *g, const Cells *c, const uint32_t *prims, uint32_t n)
{
    double sum = 0;

    for (uint32_t k = 0; k < n; k++) {
        Box b = geometry_box(g->base.geo, prims ? prims[k] : k);
        double taken = 1;
        for (int a = 0; a < 3; a++)
            taken *= cell_at(c, a, v_axis(b.hi, a)) - cell_at(c, a, v_axis(b.lo, a)) + 1;
        sum += taken;
    }
    return sum;
}

/* Lists for the n primitives (NULL: the first n). False: out of memory. */
static bool fill_cells(const Grid *g, Cells *c, const uint32_t *prims, uint32_t n)
{
    size_t cells = cells_of(c);
    uint32_t sum = 0;

    c->start = MEM_ARRAY(uint32_t, cells + 1);
    if (!c->start)
        return false;
    for (uint32_t k = 0; k < n; k++)
        register_prim(g, c, prims ? prims[k] : k, c->start, NULL);
    for (size_t i = 0; i <= cells; i++) {
        uint32_t count = c->start[i];
        c->start[i] = sum;
        sum += count;
    }
    c->entry = MEM_ARRAY(uint32_t, sum);
    if (!c->entry)
        return false;
    for (uint32_t k = 0; k < n; k++)
        register_prim(g, c, prims ? prims[k] : k, c->start, c->entry);
    for (size_t i = cells; i > 0; i--)                  /* each stands at its end now */
        c->start[i] = c->start[i - 1];
    c->start[0] = 0;
    return true;
}

/* A grid over the box lo..hi with about density cells a primitive, fewer if primitives were so
 * large that each would take more than `most` of them. A cell is no smaller than what floats can
 * tell apart there: rays would visit its neighbours, too. */
static bool add_grid(Grid *g, const double lo[3], const double hi[3], const uint32_t *prims,
                     uint32_t n, double density, double most, size_t *index)
{
    Cells c;

    memset(&c, 0, sizeof c);
    for (double wanted = density * n;; wanted *= 0.25) {
        choose_cells(&c, lo, hi, wanted, 16 * g->slack);
        if (cells_of(&c) == 1 || cells_taken(g, &c, prims, n) <= most * n)
            break;
    }
    if (!mem_grow(&g->grid, &g->cap_grids, g->ngrids + 1, sizeof c))
        return false;
    *index = g->ngrids++;
    g->grid[*index] = c;                                /* drop() frees what it has */
    return fill_cells(g, &g->grid[*index], prims, n);
}

/* Replaces the list of cell i by a grid, if that divides it. The list keeps its place, of which
 * one entry is used; what leads from cell to cell is the starts. */
static bool nest_cell(Grid *g, size_t grid, const int i[3], uint32_t *ends, double density)
{
    const Cells *c = &g->grid[grid];
    size_t at = cell_index(c, i[0], i[1], i[2]), inner;
    uint32_t first = c->start[at], n = ends[at] - first;
    double lo[3], hi[3];

    for (int k = 0; k < 3; k++) {
        lo[k] = c->lo[k] + i[k] * c->size[k];
        hi[k] = lo[k] + c->size[k];
    }
    if (!add_grid(g, lo, hi, c->entry + first, n, density, MOST_NESTED, &inner))
        return false;
    c = &g->grid[grid];                                 /* the array may have moved */
    if (cells_of(&g->grid[inner]) == 1) {
        mem_free(g->grid[inner].start);
        mem_free(g->grid[inner].entry);
        g->ngrids--;
        return true;
    }
    c->entry[first] = NESTED | (uint32_t)inner;
    ends[at] = first + 1;
    return true;
}

/* Closes the gaps that nesting left: cell k keeps the entries from start[k] to ends[k]. */
static bool close_gaps(Cells *c, const uint32_t *ends)
{
    size_t cells = cells_of(c);
    uint32_t n = 0, to = 0, *entry;

    for (size_t k = 0; k < cells; k++)
        n += ends[k] - c->start[k];
    entry = MEM_ARRAY(uint32_t, n);
    if (!entry)
        return false;
    for (size_t k = 0; k < cells; k++) {
        uint32_t first = c->start[k];
        c->start[k] = to;
        while (first < ends[k])
            entry[to++] = c->entry[first++];
    }
    c->start[cells] = to;
    mem_free(c->entry);
    c->entry = entry;
    return true;
}

/* Grids for the dense cells of grid `index`, and for theirs. */
static bool nest(Grid *g, size_t index, double density, int depth)
{
    size_t cells = cells_of(&g->grid[index]), before = g->ngrids;
    uint32_t *ends = MEM_ARRAY(uint32_t, cells);
    bool ok = ends != NULL;
    int i[3], res[3];

    memcpy(res, g->grid[index].res, sizeof res);
    if (ok)
        memcpy(ends, g->grid[index].start + 1, cells * sizeof *ends);
    for (i[2] = 0; ok && i[2] < res[2]; i[2]++)
        for (i[1] = 0; ok && i[1] < res[1]; i[1]++)
            for (i[0] = 0; ok && i[0] < res[0]; i[0]++) {
                const Cells *c = &g->grid[index];
                size_t at = cell_index(c, i[0], i[1], i[2]);
                if (c->start[at + 1] - c->start[at] >= NEST_LEAST)
                    ok = nest_cell(g, index, i, ends, density);
            }
    ok = ok && close_gaps(&g->grid[index], ends);
    mem_free(ends);
    for (size_t k = before, after = g->ngrids; ok && depth + 1 < DEPTH_MOST && k < after; k++)
        ok = nest(g, k, density, depth + 1);
    return ok;
}

static void drop(Accel *a)
{
    Grid *g = (Grid *)a;

    for (size_t i = 0; i < g->ngrids; i++) {
        mem_free(g->grid[i].start);
        mem_free(g->grid[i].entry);
    }
    mem_free(g->grid);
    mem_free(g);
}

static void measure(Grid *g)
{
    g->base.bytes = sizeof *g + g->ngrids * sizeof *g->grid;
    for (size_t i = 0; i < g->ngrids; i++) {
        size_t cells = cells_of(&g->grid[i]);
        uint32_t entries = g->grid[i].start[cells];
        g->base.nodes += cells;
        g->base.refs += entries;
        g->base.bytes += (cells + 1 + entries) * sizeof(uint32_t);
    }
    g->base.leaves = g->base.nodes - (g->ngrids - 1);   /* the others have grids within */
}

static Accel *build(const Geometry *geo, const Opts *o, int threads)
{
    uint32_t n = geometry_prims(geo);
    double density = (double)opt_float(o, "density"), lo[3], hi[3];
    Grid *g = MEM_NEW(Grid);
    size_t first;

    (void)threads;
    if (!g)
        return NULL;
    g->base.geo = geo;
    if (n == 0)
        return &g->base;
    if (!accel_counts("grid", n, 27)) {
        drop(&g->base);
        return NULL;
    }
    g->box = box_empty();
    for (uint32_t i = 0; i < n; i++)
        g->box = box_join(g->box, geometry_box(geo, i));
    g->slack = line_slack(g->box);
    for (int k = 0; k < 3; k++) {
        lo[k] = v_axis(g->box.lo, k);
        hi[k] = v_axis(g->box.hi, k);
    }
    if (!add_grid(g, lo, hi, NULL, n, density, MOST, &first) ||
        (opt_bool(o, "nested") && !nest(g, first, density, 0))) {
        drop(&g->base);
        return NULL;
    }
    measure(g);
    return &g->base;
}

/* ---- queries ---- */

typedef struct {
    const Grid *grid;
    const Ray  *ray;
    Probe  probe;
    Line   line;
    Hit   *hit;
    bool   any;                         /* the first hit will do */
    Steps *steps;
    Mailbox tested;
} Walk;

/* The cells from..to along the axis that the ray is in between t0 and t1. */
static void cells_between(const Line *l, const Cells *c, int axis, double t0, double t1, int *from,
                          int *to)
{
    double a = l->o[axis] + t0 * l->d[axis], b = l->o[axis] + t1 * l->d[axis];
    double m = d_max(line_margin(l, axis, t0), line_margin(l, axis, t1));

    *from = cell_at(c, axis, d_min(a, b) - m);
    *to = cell_at(c, axis, d_max(a, b) + m);
}

/* True: the walk may end. */
static bool walk(Walk *w, const Cells *c, double t0, double t1);

static bool test_prim(Walk *w, uint32_t prim)
{
    if (!mailbox_takes(&w->tested, prim))
        return false;
    if (w->steps)
        w->steps->prims++;
    return prim_meets(&w->grid->base, prim, w->ray, &w->probe, w->hit, w->any, w->steps) &&
           w->any;
}

static bool visit(Walk *w, const Cells *c, size_t cell, double t0, double t1)
{
    if (w->steps)
        w->steps->nodes++;
    for (uint32_t k = c->start[cell]; k < c->start[cell + 1]; k++) {
        uint32_t e = c->entry[k];
        if (e & NESTED ? walk(w, &w->grid->grid[e & ~NESTED], t0, t1) : test_prim(w, e))
            return true;
    }
    return false;
}

/* The part of t0..t1 that the ray may be in the slice. Outermost slices have no end. */
static void slice_range(const Line *l, const Cells *c, int axis, int i, double *t0, double *t1)
{
    bool up = l->d[axis] > 0;
    int first = up ? i : i + 1, last = up ? i + 1 : i;  /* the planes that are met, by number */

    if (first > 0 && first < c->res[axis]) {
        double t = (c->lo[axis] + first * c->size[axis] - l->o[axis]) / l->d[axis];
        *t0 = d_max(*t0, t - line_doubt(l, axis, t));
    }
    if (last > 0 && last < c->res[axis]) {
        double t = (c->lo[axis] + last * c->size[axis] - l->o[axis]) / l->d[axis];
        *t1 = d_min(*t1, t + line_doubt(l, axis, t));
    }
}

/* The axis on which the ray crosses most cells. */
static int walk_axis(const Line *l, const Cells *c)
{
    double x = fabs(l->d[0]) * c->per[0], y = fabs(l->d[1]) * c->per[1];
    double z = fabs(l->d[2]) * c->per[2];
    int axis = x >= y && x >= z ? 0 : y >= z ? 1 : 2;

    return l->d[axis] != 0 ? axis : l->d[0] != 0 ? 0 : l->d[1] != 0 ? 1 : 2;
}

static bool walk(Walk *w, const Cells *c, double t0, double t1)
{
    const Line *l = &w->line;
    int a = walk_axis(l, c), b = (a + 1) % 3, e = (a + 2) % 3, i[3], from[3], to[3], n;

    cells_between(l, c, a, t0, t1, &from[a], &to[a]);
    n = to[a] - from[a] + 1;
    i[a] = l->d[a] > 0 ? from[a] : to[a];
    for (; n > 0; n--, i[a] += l->d[a] > 0 ? 1 : -1) {
        double near = t0, far = t1;
        slice_range(l, c, a, i[a], &near, &far);
        if (near > w->hit->t)
            return false;
        far = d_min(far, w->hit->t);
        if (!(near <= far))
            continue;
        cells_between(l, c, b, near, far, &from[b], &to[b]);
        cells_between(l, c, e, near, far, &from[e], &to[e]);
        for (i[e] = from[e]; i[e] <= to[e]; i[e]++)
            for (i[b] = from[b]; i[b] <= to[b]; i[b]++)
                if (visit(w, c, cell_index(c, i[0], i[1], i[2]), near, far))
                    return true;
    }
    return false;
}

static bool all_prims(Walk *w)
{
    for (uint32_t i = 0; i < geometry_prims(w->grid->base.geo); i++)
        if (test_prim(w, i))
            break;
    return w->hit->outer != NO_PRIM;
}

static bool query(const Grid *g, const Ray *r, Hit *h, bool any, Steps *steps)
{
    float near, far;
    Walk w;

    hit_none(h, r->tmax);
    if (g->ngrids == 0)
        return false;
    w.grid = g;
    w.ray = r;
    w.hit = h;
    w.any = any;
    w.steps = steps;
    mailbox_init(&w.tested);
    probe_init(&w.probe, r);
    if (!line_init(&w.line, r, g->slack))
        return all_prims(&w);
    if (!box_slabs(&w.probe, g->box, r->tmax, &near, &far))
        return false;
    walk(&w, &g->grid[0], near, d_min(d_min(far, r->tmax), FLT_MAX));
    return h->outer != NO_PRIM;
}

static bool nearest(const Accel *a, const Ray *r, Hit *h, Steps *steps)
{
    return query((const Grid *)a, r, h, false, steps);
}

static bool blocked(const Accel *a, const Ray *r, Steps *steps)
{
    Hit h;
    return query((const Grid *)a, r, &h, true, steps);
}

/* ---- checking ---- */

/* Is the primitive in the list of the cell that holds the point? */
static bool listed_in(const Grid *g, const Cells *c, uint32_t prim, const double p[3])
{
    size_t cell = cell_index(c, cell_at(c, 0, p[0]), cell_at(c, 1, p[1]), cell_at(c, 2, p[2]));
    const uint32_t *list = c->entry + c->start[cell];
    uint32_t n = c->start[cell + 1] - c->start[cell];

    if (n == 1 && *list & NESTED)
        return listed_in(g, &g->grid[*list & ~NESTED], prim, p);
    return list_holds(list, n, prim);
}

static bool listed(const Accel *a, uint32_t prim, const double p[3])
{
    const Grid *g = (const Grid *)a;
    return g->ngrids && listed_in(g, &g->grid[0], prim, p);
}

static bool check_lists(const Grid *g, const Cells *c, char *why, size_t room)
{
    size_t cells = cells_of(c);

    for (size_t i = 0; i < cells; i++) {
        if (c->start[i] > c->start[i + 1] ||
            !list_ascends(c->entry + c->start[i], c->start[i + 1] - c->start[i]))
            return accel_bad(why, room, "a list that does not ascend in cell", i);
        for (uint32_t k = c->start[i]; k < c->start[i + 1]; k++) {
            uint32_t e = c->entry[k];
            if (e & NESTED ? (e & ~NESTED) >= g->ngrids : e >= geometry_prims(g->base.geo))
                return accel_bad(why, room, "a primitive or grid that does not exist in cell", i);
        }
    }
    return true;
}

static bool validate(const Accel *a, char *why, size_t room)
{
    const Grid *g = (const Grid *)a;

    for (size_t i = 0; i < g->ngrids; i++)
        if (!check_lists(g, &g->grid[i], why, room))
            return false;
    return cells_validate(a, g->box, listed, why, room);
}

static const OptDef options[] = {
    { .key = "density", .type = OPT_FLOAT, .num = 1, .lo = 0.001, .hi = 64,
      .help = "cells a primitive" },
    { .key = "nested", .type = OPT_BOOL, .num = 1, .help = "grids within dense cells" },
    { .key = NULL }
};

const AccelKind accel_grid = {
    .info = { "grid", "Cline07 2.2.1, 3.4.1; Fujimoto86; Klimaszewski97",
              "equal cells with lists, and grids within dense ones", options },
    .build = build, .nearest = nearest, .blocked = blocked, .validate = validate, .free = drop
};

/* polygon.c -- cutting polygons into triangles. See polygon.h.
 *
 * An ear is a strictly convex corner whose triangle with its two neighbours holds no other corner.
 * Every simple polygon of four or more corners has two [Meisters75], and cutting one off leaves a
 * simple polygon of one corner less. Only corners that are not strictly convex can lie in the way:
 * where a chain that has entered an ear turns back, the angle inside the polygon is over half a
 * turn. For the same reason cutting an ear changes the state of no corner but its two neighbours.
 * So each corner is tested once, and two more for each ear, against the list of possible blockers.
 *
 * The plane: the Newell normal (the vector area, sum of p_i x p_i+1 over the sides) is right
 * for concave and slightly bent polygons. Dropping its largest axis keeps the coordinates exact,
 * and every test is then a sum of two products of differences of floats, in double.
 *
 * Polygons that touch themselves, such as those with holes joined to the rim by slits, have places
 * where no ear is free; least_harm() says how these go on and how those that cross themselves
 * end. */
#include "geometry/polygon.h"

#include "base/d3.h"

struct PolygonCorner {
    V3       p;
    uint32_t id;
    double   x, y;              /* in the plane, the polygon counter-clockwise */
    uint16_t prev, next;        /* ring of the corners that are left */
    uint16_t blocker;           /* next in the list of possible blockers, NONE ends it */
    bool     blocks;            /* not strictly convex, and not cut off */
    unsigned char tried;        /* times found to be no ear since a neighbour was cut off */
};

enum { NONE = 0xFFFF };

void polygon_init(Polygon *g, Mesh *m, Skipped *skipped, const char *file, size_t file_bytes)
{
    *g = (Polygon){ 0 };
    g->mesh = m;
    g->skipped = skipped;
    g->file = file;
    /* About a quarter of a second, and an eighth of a microsecond a byte. */
    g->tests = ((uint64_t)1 << 27) + 64 * (uint64_t)file_bytes;
}

void polygon_clear(Polygon *g)
{
    mem_free(g->c);
    g->c = NULL;
    g->cap_c = 0;
}

/* ---- triangles ---- */

bool polygon_room(Polygon *g, uint64_t n)
{
    Mesh *m = g->mesh;
    if (n > MESH_MAX - m->ntris)
        return err_at((Place){ g->file, 0, 0 }, "more than %lu triangles in one mesh",
                      (unsigned long)MESH_MAX);
    return mem_grow(&m->tri, &g->cap, (size_t)m->ntris + (size_t)n, sizeof *m->tri);
}

bool polygon_triangle(Polygon *g, uint32_t a, uint32_t b, uint32_t c)
{
    Mesh *m = g->mesh;
    if (UNLIKELY(m->ntris == g->cap) && !polygon_room(g, 1))
        return false;
    m->tri[m->ntris++] = (Tri){ { a, b, c } };
    return true;
}

static bool emit(Polygon *g, const PolygonCorner *a, const PolygonCorner *b,
                 const PolygonCorner *c)
{
    return polygon_triangle(g, a->id, b->id, c->id);
}

/* The first n corners as they came, as a fan about the first one. */
static bool plain_fan(Polygon *g, size_t n)
{
    for (size_t k = 2; k < n; k++)
        if (!emit(g, &g->c[0], &g->c[k - 1], &g->c[k]))
            return false;
    return true;
}

bool polygon_corner(Polygon *g, uint32_t id, V3 p)
{
    if (LIKELY(g->n < POLYGON_CARE)) {
        if (UNLIKELY(g->n == g->cap_c) && !mem_grow(&g->c, &g->cap_c, g->cap_c + 1, sizeof *g->c))
            return false;
        g->c[g->n].id = id;
        g->c[g->n++].p = p;
        return true;
    }
    if (g->n == POLYGON_CARE) {                 /* one too many */
        if (!plain_fan(g, POLYGON_CARE))
            return false;
        g->first = g->c[0].id;
        g->last = g->c[POLYGON_CARE - 1].id;
    }
    g->n++;
    if (!polygon_triangle(g, g->first, g->last, id))
        return false;
    g->last = id;
    return true;
}

/* ---- four corners ---- */

/* True if the diagonal from a to c cuts the quadrangle into two halves that face one way. */
static bool cuts_well(const PolygonCorner *a, const PolygonCorner *b, const PolygonCorner *c,
                      const PolygonCorner *d)
{
    return d3_dot(d3_normal(a->p, b->p, c->p), d3_normal(a->p, c->p, d->p)) > 0.0;
}

static bool cut_quad(Polygon *g)
{
    const PolygonCorner *c = g->c;
    if (!cuts_well(&c[0], &c[1], &c[2], &c[3]) && cuts_well(&c[1], &c[2], &c[3], &c[0]))
        return emit(g, &c[1], &c[2], &c[3]) && emit(g, &c[1], &c[3], &c[0]);
    return emit(g, &c[0], &c[1], &c[2]) && emit(g, &c[0], &c[2], &c[3]);
}

/* ---- ears ---- */

/* Fills x and y of the n corners. The Newell normal s is summed relative to the first corner, so
 * that nothing cancels far from the origin. False: no area as seen from anywhere. */
static bool project(PolygonCorner *c, unsigned n)
{
    D3 s = { 0.0, 0.0, 0.0 };
    double ax, ay, az;

    for (unsigned k = 1; k + 1 < n; k++)
        s = d3_mad(d3_normal(c[0].p, c[k].p, c[k + 1].p), 1.0, s);
    ax = fabs(s.x);
    ay = fabs(s.y);
    az = fabs(s.z);
    if (!(ax > 0.0 || ay > 0.0 || az > 0.0))
        return false;
    for (unsigned k = 0; k < n; k++) {
        V3 p = c[k].p;
        bool drop_x = ax >= ay && ax >= az, drop_y = !drop_x && ay >= az;
        double x = drop_x ? p.y : drop_y ? p.z : p.x;
        double y = drop_x ? p.z : drop_y ? p.x : p.y;
        bool turned = (drop_x ? s.x : drop_y ? s.y : s.z) < 0.0;
        c[k].x = turned ? y : x;
        c[k].y = turned ? x : y;
    }
    return true;
}

/* Twice the area of abc, positive if counter-clockwise. */
static double area2(const PolygonCorner *a, const PolygonCorner *b, const PolygonCorner *c)
{
    return (b->x - a->x) * (c->y - a->y) - (b->y - a->y) * (c->x - a->x);
}

static double area2_at(const PolygonCorner *c, unsigned v)
{
    return area2(&c[c[v].prev], &c[v], &c[c[v].next]);
}

/* Makes the ring and the list of blockers; returns the list's head. */
static uint16_t link_corners(PolygonCorner *c, unsigned n)
{
    uint16_t head = NONE;

    for (unsigned k = 0; k < n; k++) {
        c[k].prev = (uint16_t)(k ? k - 1 : n - 1);
        c[k].next = (uint16_t)(k + 1 < n ? k + 1 : 0);
        c[k].tried = 0;
    }
    for (unsigned k = n; k-- > 0;) {
        c[k].blocks = !(area2_at(c, k) > 0.0);
        if (c[k].blocks) {
            c[k].blocker = head;
            head = (uint16_t)k;
        }
    }
    return head;
}

/* Inside abc or on its rim, so that a new diagonal touches nothing. */
static bool in_the_way(const PolygonCorner *a, const PolygonCorner *b, const PolygonCorner *c,
                       const PolygonCorner *q)
{
    return area2(a, b, q) >= 0.0 && area2(b, c, q) >= 0.0 && area2(c, a, q) >= 0.0;
}

/* Is corner v an ear? Not tested if it was found to be none `times` times already. Unlinks entries
 * of the list that block no longer. */
static bool is_ear(Polygon *g, unsigned v, unsigned times, uint16_t *head)
{
    PolygonCorner *c = g->c, *b = &c[v], *a = &c[b->prev], *d = &c[b->next];
    uint16_t *link = head;

    if (b->tried >= times)
        return false;
    b->tried = (unsigned char)times;
    if (!(area2(a, b, d) > 0.0))
        return false;
    while (*link != NONE) {
        PolygonCorner *q = &c[*link];
        if (!q->blocks) {
            *link = q->blocker;
            continue;
        }
        g->tests -= g->tests > 0;
        if (q != a && q != b && q != d && in_the_way(a, b, d, q))
            return false;
        link = &q->blocker;
    }
    return true;
}

/* The corner to cut off where the ring has no ear: the polygon touches or crosses itself. One
 * without area does no harm and gets out of the way of others, so that these get a second chance;
 * else the one of least area. */
static unsigned least_harm(Polygon *g, unsigned v, unsigned left, uint16_t *blockers)
{
    unsigned best = v;

    g->tests -= g->tests < left ? g->tests : left;
    for (unsigned k = 0; k < left; k++, v = g->c[v].next)
        if (fabs(area2_at(g->c, v)) < fabs(area2_at(g->c, best)))
            best = v;
    if (area2_at(g->c, best) == 0.0)
        return best;
    for (unsigned k = 0; k < left; k++, v = g->c[v].next)
        if (is_ear(g, v, 2, blockers))
            return v;
    return best;
}

/* Cuts off corner v and returns the next. */
static unsigned cut_off(PolygonCorner *c, unsigned v)
{
    unsigned a = c[v].prev, b = c[v].next;

    c[a].next = (uint16_t)b;
    c[b].prev = (uint16_t)a;
    c[v].blocks = false;
    c[a].tried = c[b].tried = 0;
    /* A convex corner stays convex when a neighbouring ear goes: blocks never turns true again. */
    c[a].blocks = c[a].blocks && !(area2_at(c, a) > 0.0);
    c[b].blocks = c[b].blocks && !(area2_at(c, b) > 0.0);
    return b;
}

/* The fan about corner v of the `left` corners still in the ring. */
static bool ring_fan(Polygon *g, unsigned v, unsigned left)
{
    unsigned b = g->c[v].next;
    for (; left > 2; left--) {
        unsigned c = g->c[b].next;
        if (!emit(g, &g->c[v], &g->c[b], &g->c[c]))
            return false;
        b = c;
    }
    return true;
}

static bool clip_ears(Polygon *g, unsigned n, Place at)
{
    PolygonCorner *c = g->c;
    uint16_t blockers = link_corners(c, n);
    unsigned v = 1, left = n, missed = 0;       /* from 1: convex polygons give the fan about 0 */

    while (left > 3 && g->tests) {
        if (!is_ear(g, v, 1, &blockers)) {
            v = c[v].next;
            if (++missed < left)
                continue;
            v = least_harm(g, v, left, &blockers);
        }
        if (!emit(g, &c[c[v].prev], &c[v], &c[c[v].next]))
            return false;
        v = cut_off(c, v);
        left--;
        missed = 0;
    }
    if (left > 3)
        skipped_note(g->skipped, SKIPPED_CARE, at);
    return ring_fan(g, c[v].prev, left);
}

bool polygon_end(Polygon *g, Place at)
{
    uint64_t n = g->n;

    g->n = 0;
    if (LIKELY(n == 3))
        return emit(g, &g->c[0], &g->c[1], &g->c[2]);
    if (n == 4)
        return cut_quad(g);
    if (n < 3 || n > POLYGON_CARE) {
        skipped_note(g->skipped, n < 3 ? SKIPPED_FACE : SKIPPED_CARE, at);
        return true;
    }
    if (!project(g->c, (unsigned)n))
        return plain_fan(g, (size_t)n);
    return clip_ears(g, (unsigned)n, at);
}

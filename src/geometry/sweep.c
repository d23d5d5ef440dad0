/* sweep.c -- curves in space as triangles: tubes and ribbons.
 *
 * Source      Curves are those of [PBRT4 6.7]: Bezier or uniform B-spline of degree 2 or 3. Each
 *             polynomial is brought to Bezier form and evaluated by de Casteljau's steps.
 * Frames      The direction across is carried from point to point, each time freed of its part
 *             along the new tangent, so that tubes do not twist. Ribbons go across their normals,
 *             which are blended along the arc between those of the ends of the segment.
 * Error       A step turns by pi/24 at most, of what the control polygon turns; tubes have 16
 *             sides.
 * Departs     [PBRT4] has flat curves that turn to whoever looks; here they are tubes, which look
 *             as wide from every side. */
#include "geometry/sweep.h"

enum { SIDES = 16, MOST_STEPS = 64 };

typedef struct { V3 p, t, across; float radius, u; } Station;
typedef struct { Station *s; uint32_t n; } Stations;   /* s owned */

uint32_t sweep_segments(const Sweep *s)
{
    if (s->n < s->degree + 1)
        return 0;
    if (s->bspline)
        return s->n - s->degree;
    return (s->n - 1) % s->degree == 0 ? (s->n - 1) / s->degree : 0;
}

/* The Bezier points of a segment. */
static void segment_points(const Sweep *s, uint32_t i, V3 b[4])
{
    const V3 *p = s->p + (s->bspline ? i : i * (size_t)s->degree);

    for (uint32_t k = 0; k <= s->degree; k++)
        b[k] = p[k];
    if (!s->bspline)
        return;
    if (s->degree == 2) {
        b[0] = v_lerp(p[0], p[1], 0.5f);
        b[2] = v_lerp(p[1], p[2], 0.5f);
        return;
    }
    b[1] = v_lerp(p[1], p[2], 1.0f / 3.0f);
    b[2] = v_lerp(p[1], p[2], 2.0f / 3.0f);
    b[0] = v_lerp(v_lerp(p[0], p[1], 2.0f / 3.0f), b[1], 0.5f);
    b[3] = v_lerp(b[2], v_lerp(p[2], p[3], 1.0f / 3.0f), 0.5f);
}

/* Turning of the control polygon, by the sine of half the angle, which grows slower than the angle
 * by at most pi/2. */
static uint32_t segment_steps(const Sweep *s, uint32_t i)
{
    V3 b[4], last = { 0, 0, 0 };
    float turn = 0;

    segment_points(s, i, b);
    for (uint32_t k = 0; k < s->degree; k++) {
        V3 d = v_unit(v_sub(b[k + 1], b[k]));
        if (v_len2(d) == 0.0f)
            continue;
        if (v_len2(last) > 0.0f)
            turn += v_len(v_sub(d, last)) * 0.5f * PI_F;
        last = d;
    }
    turn = ceilf(turn * (24.0f / PI_F));
    if (s->normals)
        turn = f_max(turn, ceilf(12.0f * v_len(v_sub(s->normals[i + 1], s->normals[i]))));
    return turn < 1.0f ? 1 : turn > MOST_STEPS ? MOST_STEPS : (uint32_t)turn;
}

static uint64_t all_steps(const Sweep *s)
{
    uint64_t n = 0;
    for (uint32_t i = 0; i < sweep_segments(s); i++)
        n += segment_steps(s, i);
    return n;
}

uint64_t sweep_triangles(const Sweep *s)
{
    return s->normals ? 2 * all_steps(s) : 2 * SIDES * all_steps(s) + 2 * (SIDES - 2);
}

/* ---- stations along the curve ---- */

static void segment_at(const Sweep *s, const V3 b[4], float t, Station *out)
{
    V3 q[4] = { b[0], b[1], b[2], s->degree == 3 ? b[3] : b[2] }, d;

    for (uint32_t left = s->degree; left > 1; left--)
        for (uint32_t k = 0; k < left; k++)
            q[k] = v_lerp(q[k], q[k + 1], t);
    d = v_sub(q[1], q[0]);
    out->p = v_lerp(q[0], q[1], t);
    out->t = v_unit(d);
}

/* Blended along the arc: the unit vector that divides the angle, by halving; exact at the ends. */
static V3 blend(V3 a, V3 b, float t)
{
    float lo = 0, hi = 1;
    if (t <= 0.0f || t >= 1.0f)
        return v_unit(t <= 0.0f ? a : b);
    a = v_unit(a);
    b = v_unit(b);
    for (int k = 0; k < 12; k++) {
        V3 mid = v_unit(v_add(a, b));
        float half = 0.5f * (lo + hi);
        if (t < half) {
            b = mid;
            hi = half;
        } else {
            a = mid;
            lo = half;
        }
    }
    return a;
}

static V3 any_across(V3 t) { return frame_about(t).s; }

/* v without its part along t; what is left of it when v is along t is any direction. */
static V3 freed(V3 v, V3 t)
{
    V3 w = v_mad(t, -v_dot(v, t), v);
    return v_len2(w) > 1e-6f * v_len2(v) ? v_unit(w) : any_across(t);
}

/* Where the curve stands still (points that coincide) the way to the neighbours is the tangent. */
static bool fill_tangents(Stations *all)
{
    V3 last = { 0, 0, 0 };

    for (uint32_t i = 0; i < all->n; i++) {
        Station *s = &all->s[i];
        if (v_len2(s->t) == 0.0f)
            s->t = v_unit(v_sub(all->s[i + 1 < all->n ? i + 1 : i].p, all->s[i ? i - 1 : i].p));
        if (v_len2(s->t) == 0.0f)
            s->t = last;
        last = s->t;
    }
    for (uint32_t i = all->n; i-- > 0; ) {
        if (v_len2(all->s[i].t) == 0.0f)
            all->s[i].t = last;
        last = all->s[i].t;
    }
    return v_len2(last) > 0.0f;
}

/* False: out of memory, reported. n = 0: the curve has no length. */
static bool make_stations(const Sweep *s, Stations *all)
{
    uint32_t segments = sweep_segments(s);
    uint64_t n = all_steps(s) + 1;

    *all = (Stations){ MEM_ARRAY(Station, (size_t)n), 0 };
    if (!all->s)
        return false;
    for (uint32_t i = 0; i < segments; i++) {
        uint32_t steps = segment_steps(s, i);
        V3 b[4];
        segment_points(s, i, b);
        for (uint32_t k = i ? 1 : 0; k <= steps; k++) {
            Station *at = &all->s[all->n++];
            float t = (float)k / (float)steps;
            segment_at(s, b, t, at);
            at->u = ((float)i + t) / (float)segments;
            at->radius = 0.5f * (s->width0 + at->u * (s->width1 - s->width0));
            if (s->normals)
                at->across = blend(s->normals[i], s->normals[i + 1], t);
        }
    }
    if (!fill_tangents(all)) {
        all->n = 0;
        return true;
    }
    for (uint32_t i = 0; i < all->n; i++) {
        Station *at = &all->s[i];
        if (s->normals)
            at->across = v_unit(v_cross(freed(at->across, at->t), at->t));
        else
            at->across = i ? freed(all->s[i - 1].across, at->t) : any_across(at->t);
    }
    return true;
}

/* ---- triangles ---- */

static bool room(Mesh *m, uint64_t nverts, uint64_t ntris)
{
    if (nverts > MESH_MAX)
        return err_usage("a curve of %.0f points is too long", (double)nverts);
    return mesh_alloc(m, (size_t)nverts, (size_t)ntris, true, true);
}

static void add_vertex(Mesh *m, V3 p, V3 n, float u, float v)
{
    m->p[m->nverts] = p;
    m->n[m->nverts] = n;
    m->uv[m->nverts++] = (V2){ u, v };
}

static void ribbon(Mesh *m, const Stations *all)
{
    for (uint32_t i = 0; i < all->n; i++) {
        const Station *s = &all->s[i];
        V3 n = v_cross(s->t, s->across);
        uint32_t a = m->nverts;
        add_vertex(m, v_mad(s->across, -s->radius, s->p), n, s->u, 0);
        add_vertex(m, v_mad(s->across, s->radius, s->p), n, s->u, 1);
        if (i) {
            m->tri[m->ntris++] = (Tri){ { a - 2, a, a + 1 } };
            m->tri[m->ntris++] = (Tri){ { a - 2, a + 1, a - 1 } };
        }
    }
}

/* How much the radius grows on the way: normals lean back by it. */
static float slope(const Stations *all)
{
    float length = 0;
    for (uint32_t i = 1; i < all->n; i++)
        length += v_len(v_sub(all->s[i].p, all->s[i - 1].p));
    return (all->s[all->n - 1].radius - all->s[0].radius) / length;
}

static V3 around(const Station *s, uint32_t j, V3 *out)
{
    float x, y;
    m_sincos_turn((float)(j % SIDES) / SIDES, &y, &x);
    *out = v_add(v_scale(s->across, x), v_scale(v_cross(s->t, s->across), y));
    return v_mad(*out, s->radius, s->p);
}

static void cap(Mesh *m, const Station *s, bool last)
{
    uint32_t a = m->nverts;
    V3 out;

    for (uint32_t j = 0; j < SIDES; j++) {
        V3 p = around(s, j, &out);
        add_vertex(m, p, last ? s->t : v_neg(s->t), s->u, (float)j / SIDES);
    }
    for (uint32_t j = 1; j + 1 < SIDES; j++)
        m->tri[m->ntris++] = last ? (Tri){ { a, a + j, a + j + 1 } }
                                  : (Tri){ { a, a + j + 1, a + j } };
}

static void tube(Mesh *m, const Stations *all)
{
    float lean = slope(all);

    for (uint32_t i = 0; i < all->n; i++) {
        const Station *s = &all->s[i];
        for (uint32_t j = 0; j <= SIDES; j++) {
            uint32_t a = m->nverts, b = a - SIDES - 1;
            V3 out, p = around(s, j, &out);
            add_vertex(m, p, v_unit(v_mad(s->t, -lean, out)), s->u, (float)j / SIDES);
            if (!i || !j)
                continue;
            if (s[-1].radius > 0.0f)
                m->tri[m->ntris++] = (Tri){ { b - 1, b, a } };
            if (s->radius > 0.0f)
                m->tri[m->ntris++] = (Tri){ { b - 1, a, a - 1 } };
        }
    }
    if (all->s[0].radius > 0.0f)
        cap(m, &all->s[0], false);
    if (all->s[all->n - 1].radius > 0.0f)
        cap(m, &all->s[all->n - 1], true);
}

bool sweep_mesh(Mesh *m, const Sweep *s)
{
    Stations all;
    bool ok = make_stations(s, &all) &&
              room(m, s->normals ? 2 * (uint64_t)all.n : (all.n + (uint64_t)2) * (SIDES + 1),
                   sweep_triangles(s));

    if (ok && all.n) {
        if (s->normals)
            ribbon(m, &all);
        else
            tube(m, &all);
    }
    mem_free(all.s);
    return ok;
}

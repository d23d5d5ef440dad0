/* generate.c -- meshes made by rule. See generate.h. */
#include "geometry/generate.h"

#include "base/d3.h"
#include "base/random.h"

#include <string.h>

static bool in_range(const char *mesh, const char *what, uint32_t v, uint32_t lo, uint32_t hi)
{
    return (v >= lo && v <= hi) ||
           err_usage("%s with %lu %s, %lu to %lu were expected", mesh, (unsigned long)v, what,
                     (unsigned long)lo, (unsigned long)hi);
}

static bool begin(Mesh *m, uint64_t nverts, uint64_t ntris, bool uv)
{
    *m = (Mesh){ 0 };
    if (nverts > MESH_MAX || ntris > MESH_MAX)
        return err_usage("%.0f vertices and %.0f triangles are too many for one mesh",
                         (double)nverts, (double)ntris);
    if (!mesh_alloc(m, (size_t)nverts, (size_t)ntris, false, uv))
        return false;
    m->nverts = (uint32_t)nverts;
    return true;
}

static void add(Mesh *m, uint32_t a, uint32_t b, uint32_t c)
{
    m->tri[m->ntris++] = (Tri){ { a, b, c } };
}

/* The quadrangle a b c d, counter-clockwise. */
static void add_quad(Mesh *m, uint32_t a, uint32_t b, uint32_t c, uint32_t d)
{
    add(m, a, b, c);
    add(m, a, c, d);
}

/* ---- boxes ---- */

bool mesh_cube(Mesh *m)
{
    static const unsigned char side[6][4] = { { 0, 2, 3, 1 }, { 4, 5, 7, 6 }, { 0, 1, 5, 4 },
                                              { 2, 6, 7, 3 }, { 0, 4, 6, 2 }, { 1, 3, 7, 5 } };
    if (!begin(m, 8, 12, false))
        return false;
    for (unsigned k = 0; k < 8; k++)
        m->p[k] = v3(k & 1 ? 0.5f : -0.5f, k & 2 ? 0.5f : -0.5f, k & 4 ? 0.5f : -0.5f);
    for (int k = 0; k < 6; k++)
        add_quad(m, side[k][0], side[k][1], side[k][2], side[k][3]);
    return true;
}

/* u and v run along the side so that u x v points out. */
bool mesh_box(Mesh *m, V3 a, V3 b)
{
    static const unsigned char side[6][4] = { { 0, 2, 1, 3 }, { 4, 5, 6, 7 }, { 0, 1, 4, 5 },
                                              { 3, 2, 7, 6 }, { 2, 0, 6, 4 }, { 1, 3, 5, 7 } };
    if (!begin(m, 24, 12, true))
        return false;
    for (uint32_t k = 0; k < 24; k++) {
        unsigned c = side[k / 4][k % 4];
        m->p[k] = v3(c & 1 ? b.x : a.x, c & 2 ? b.y : a.y, c & 4 ? b.z : a.z);
        m->uv[k] = (V2){ (float)(k & 1), (float)(k >> 1 & 1) };
        if (k % 4 == 3)
            add_quad(m, k - 3, k - 2, k, k - 1);
    }
    return true;
}

bool mesh_room(Mesh *m)
{
    enum { N = 6, INNER = 3 };                  /* the corner that sees all others */
    static const V2 rim[N] = { { 0, 0 }, { 2, 0 }, { 2, 1 }, { 1, 1 }, { 1, 2 }, { 0, 2 } };

    if (!begin(m, 2 * N, 20, false))
        return false;
    for (uint32_t k = 0; k < N; k++) {
        m->p[k] = v3(rim[k].x, rim[k].y, 0.0f);
        m->p[N + k] = v3(rim[k].x, rim[k].y, 1.0f);
        add_quad(m, k, (k + 1) % N, N + (k + 1) % N, N + k);
    }
    for (uint32_t k = 1; k + 1 < N; k++) {
        uint32_t b = (INNER + k) % N, c = (INNER + k + 1) % N;
        add(m, INNER, c, b);
        add(m, N + INNER, N + b, N + c);
    }
    return true;
}

bool mesh_grid(Mesh *m, uint32_t nx, uint32_t ny)
{
    uint32_t row = nx + 1;

    if (!in_range("grid", "columns", nx, 1, MESH_MAX - 1) ||
        !in_range("grid", "rows", ny, 1, MESH_MAX - 1) ||
        !begin(m, (nx + (uint64_t)1) * (ny + (uint64_t)1), 2 * (uint64_t)nx * ny,
               true))
        return false;
    for (uint32_t j = 0, k = 0; j <= ny; j++)
        for (uint32_t i = 0; i <= nx; i++, k++) {
            m->uv[k] = (V2){ (float)((double)i / nx), (float)((double)j / ny) };
            m->p[k] = v3(m->uv[k].x, m->uv[k].y, 0.0f);
        }
    for (uint32_t j = 0; j < ny; j++)
        for (uint32_t i = 0; i < nx; i++)
            add_quad(m, j * row + i, j * row + i + 1, (j + 1) * row + i + 1, (j + 1) * row + i);
    return true;
}

/* ---- round bodies ---- */

bool mesh_uvsphere(Mesh *m, uint32_t nu, uint32_t nv)
{
    uint32_t south, north;

    if (!in_range("uvsphere", "meridians", nu, 3, MESH_MAX) ||
        !in_range("uvsphere", "parallels", nv, 2, MESH_MAX) ||
        !begin(m, (uint64_t)nu * (nv - 1) + 2, 2 * (uint64_t)nu * (nv - 1), false))
        return false;
    south = nu * (nv - 1);
    north = south + 1;
    for (uint32_t j = 1, k = 0; j < nv; j++) {          /* from the south pole up */
        float s, c, x, y;
        m_sincos_turn((float)(0.5 * j / nv), &s, &c);
        for (uint32_t i = 0; i < nu; i++) {
            m_sincos_turn((float)((double)i / nu), &y, &x);
            m->p[k++] = v3(s * x, s * y, -c);
        }
    }
    m->p[south] = v3(0.0f, 0.0f, -1.0f);
    m->p[north] = v3(0.0f, 0.0f, 1.0f);
    for (uint32_t i = 0; i < nu; i++) {
        uint32_t next = (i + 1) % nu, top = nu * (nv - 2);
        add(m, south, next, i);
        for (uint32_t j = 0; j + 2 < nv; j++)
            add_quad(m, j * nu + i, j * nu + next, (j + 1) * nu + next, (j + 1) * nu + i);
        add(m, north, top + i, top + next);
    }
    return true;
}

bool mesh_torus(Mesh *m, uint32_t nu, uint32_t nv, float major, float minor)
{
    if (!in_range("torus", "parts of the ring", nu, 3, MESH_MAX) ||
        !in_range("torus", "parts of the tube", nv, 3, MESH_MAX))
        return false;
    if (!(minor > 0.0f && minor < major && is_finite(major)))
        return err_usage("torus of radii %g and %g, major > minor > 0 was expected",
                         (double)major, (double)minor);
    if (!begin(m, (uint64_t)nu * nv, 2 * (uint64_t)nu * nv, false))
        return false;
    for (uint32_t i = 0, k = 0; i < nu; i++) {
        float x, y, s, c;
        m_sincos_turn((float)((double)i / nu), &y, &x);
        for (uint32_t j = 0; j < nv; j++) {
            m_sincos_turn((float)((double)j / nv), &s, &c);
            m->p[k++] = v3((major + minor * c) * x, (major + minor * c) * y, minor * s);
        }
    }
    for (uint32_t i = 0; i < nu; i++)
        for (uint32_t j = 0; j < nv; j++) {
            uint32_t here = i * nv, there = (i + 1) % nu * nv, next = (j + 1) % nv;
            add_quad(m, here + j, there + j, there + next, here + next);
        }
    return true;
}

/* ---- icosphere: the vertices of a cut face are numbered corners first, then the inner points of
 * the 30 edges, then those of the 20 faces, so that faces share what they have in common ---- */

typedef struct {
    uint32_t n;                 /* parts of an edge */
    D3  corner[12];             /* (0, +-1, +-g) and its cyclic turns, g the golden ratio */
    int edge[12][12];           /* number of the edge between two corners, or -1 */
    int face[20][3];            /* its corners, counter-clockwise from outside */
} Ico;

static void swap_int(int *a, int *b)
{
    int t = *a;
    *a = *b;
    *b = t;
}

static void ico_init(Ico *s, uint32_t n)
{
    double g = 0.5 + 0.5 * sqrt(5.0);
    int edges = 0, faces = 0;

    s->n = n;
    for (int k = 0; k < 4; k++) {
        double one = k & 1 ? 1.0 : -1.0, gold = k & 2 ? g : -g;
        s->corner[k] = (D3){ 0.0, one, gold };
        s->corner[4 + k] = (D3){ gold, 0.0, one };
        s->corner[8 + k] = (D3){ one, gold, 0.0 };
    }
    for (int a = 0; a < 12; a++)
        for (int b = 0; b <= a; b++) {
            D3 d = d3_mad(s->corner[b], -1.0, s->corner[a]);
            /* Edges are 2 long, the next distance is 2 g. */
            s->edge[a][b] = s->edge[b][a] = a != b && d3_dot(d, d) < 6.0 ? edges++ : -1;
        }
    for (int a = 0; a < 12; a++)
        for (int b = 0; b < a; b++)
            for (int c = 0; c < b; c++) {
                int *f = s->face[faces < 20 ? faces : 19];
                if (s->edge[a][b] < 0 || s->edge[b][c] < 0 || s->edge[c][a] < 0)
                    continue;
                faces++;
                f[0] = a;
                f[1] = b;
                f[2] = c;
                if (d3_dot(s->corner[a], d3_cross(s->corner[b], s->corner[c])) < 0.0)
                    swap_int(&f[1], &f[2]);
            }
    ASSERT(edges == 30 && faces == 20);
}

/* Number of the point `t` parts of an edge away from corner a towards b. */
static uint32_t ico_on_edge(const Ico *s, int a, int b, uint32_t t)
{
    uint32_t from_a = a < b ? t : s->n - t;
    return 12 + (uint32_t)s->edge[a][b] * (s->n - 1) + from_a - 1;
}

/* Number of the point of face f that lies i parts towards its second corner and j to its third. */
static uint32_t ico_vertex(const Ico *s, int f, uint32_t i, uint32_t j)
{
    const int *c = s->face[f];
    uint32_t n = s->n, k = n - i - j, inner;

    if (i == n || j == n || k == n)
        return (uint32_t)(i == n ? c[1] : j == n ? c[2] : c[0]);
    if (j == 0)
        return ico_on_edge(s, c[0], c[1], i);
    if (i == 0)
        return ico_on_edge(s, c[0], c[2], j);
    if (k == 0)
        return ico_on_edge(s, c[1], c[2], j);
    inner = (uint32_t)((uint64_t)(n - 1) * (n - 2) / 2);
    return 12 + 30 * (n - 1) + (uint32_t)f * inner +
           (uint32_t)((uint64_t)(i - 1) * (2 * n - 2 - i) / 2) + j - 1;
}

/* In double; a point of an edge comes out the same from both faces, as a + b = b + a. */
static V3 ico_point(const Ico *s, int f, uint32_t i, uint32_t j)
{
    D3 a = s->corner[s->face[f][0]], b = s->corner[s->face[f][1]], c = s->corner[s->face[f][2]];
    D3 p = d3_mad(c, j, d3_mad(b, i, d3_scale(a, (double)(s->n - i - j))));
    return d3_rounded(d3_unit(p));
}

bool mesh_icosphere(Mesh *m, uint32_t n)
{
    Ico s;

    if (!in_range("icosphere", "parts of an edge", n, 1, 10000) ||
        !begin(m, 10 * (uint64_t)n * n + 2, 20 * (uint64_t)n * n, false))
        return false;
    ico_init(&s, n);
    for (int f = 0; f < 20; f++)
        for (uint32_t i = 0; i <= n; i++)
            for (uint32_t j = 0; i + j <= n; j++) {
                uint32_t v = ico_vertex(&s, f, i, j);
                m->p[v] = ico_point(&s, f, i, j);
                if (i + j < n)
                    add(m, v, ico_vertex(&s, f, i + 1, j), ico_vertex(&s, f, i, j + 1));
                if (i + j + 1 < n)
                    add(m, ico_vertex(&s, f, i + 1, j), ico_vertex(&s, f, i + 1, j + 1),
                        ico_vertex(&s, f, i, j + 1));
            }
    return true;
}

/* ---- random shapes ---- */

static V3 random_point(Rng *rng)                /* in the unit cube */
{
    V3 p;
    p.x = rng_unit(rng);
    p.y = rng_unit(rng);
    p.z = rng_unit(rng);
    return p;
}

/* Moves the points of a unit sphere along their directions, by eight plane waves whose weights sum
 * to 0.3. A surface that is a function of direction stays closed and cannot fold over. */
static void make_waves(Mesh *m, float frequency, uint64_t seed)
{
    enum { WAVES = 8 };
    Rng rng = rng_seed(seed);
    V3 k[WAVES];
    float phase[WAVES];

    for (int w = 0; w < WAVES; w++) {
        k[w] = v_scale(v_sub(random_point(&rng), v_all(0.5f)), 2.0f * frequency);
        phase[w] = 2.0f * PI_F * rng_unit(&rng);
    }
    for (uint32_t i = 0; i < m->nverts; i++) {
        float sum = 0.0f;
        for (int w = 0; w < WAVES; w++)
            sum += m_sin(v_dot(k[w], m->p[i]) + phase[w]);
        m->p[i] = v_scale(m->p[i], 1.0f + 0.3f / WAVES * sum);
    }
}

bool mesh_bumpy(Mesh *m, uint32_t n, uint64_t seed)
{
    if (!mesh_icosphere(m, n))
        return false;
    make_waves(m, 12.0f, seed);
    return true;
}

/* Cuts `cuts` triangles of a unit sphere, evenly chosen, into three each about a new vertex, but
 * makes no more than ntris. */
static void cut_to(Mesh *m, uint32_t cuts, uint32_t ntris)
{
    uint32_t whole = m->ntris, first = m->nverts - cuts;

    for (uint32_t i = 0; i < cuts; i++) {
        uint32_t k = (uint32_t)((uint64_t)i * whole / cuts), v = first + i;
        Tri t = m->tri[k];
        V3 sum = v_add(v_add(m->p[t.v[0]], m->p[t.v[1]]), m->p[t.v[2]]);
        m->p[v] = v_unit(sum);
        m->tri[k].v[2] = v;
        add(m, t.v[1], t.v[2], v);
        if (m->ntris < ntris)
            add(m, t.v[2], t.v[0], v);
    }
}

bool mesh_bumpy_of(Mesh *m, uint32_t ntris, uint64_t seed)
{
    uint32_t n = 2, cuts;
    Mesh base;
    bool ok;

    if (!in_range("bumpy body", "triangles", ntris, 80, 2000000000))
        return false;
    while (n < 10000 && 20 * (n + 1) * (n + 1) <= ntris)
        n++;
    cuts = (ntris - 20 * n * n + 1) / 2;
    if (!mesh_icosphere(&base, n))
        return false;
    ok = begin(m, base.nverts + (uint64_t)cuts, ntris, false);
    if (ok) {
        memcpy(m->p, base.p, base.nverts * sizeof *m->p);
        memcpy(m->tri, base.tri, base.ntris * sizeof *m->tri);
        m->ntris = base.ntris;
        cut_to(m, cuts, ntris);
        make_waves(m, 12.0f, seed);
    }
    mesh_clear(&base);
    return ok;
}

bool mesh_blob(Mesh *m, uint64_t seed)
{
    if (!mesh_uvsphere(m, 10, 11))
        return false;
    make_waves(m, 4.0f, seed);
    return true;
}

bool mesh_soup(Mesh *m, uint32_t n, float side, uint64_t seed)
{
    Rng rng = rng_seed(seed);

    if (!(side > 0.0f && is_finite(side)))
        return err_usage("soup of triangles of side %g, a number above 0 was expected",
                         (double)side);
    if (!begin(m, 3 * (uint64_t)n, n, false))
        return false;
    for (uint32_t i = 0; i < n; i++) {
        V3 centre = random_point(&rng);
        for (uint32_t k = 0; k < 3; k++) {
            V3 d = v_sub(random_point(&rng), v_all(0.5f));
            m->p[3 * i + k] = v_mad(d, side, centre);
        }
        add(m, 3 * i, 3 * i + 1, 3 * i + 2);
    }
    return true;
}

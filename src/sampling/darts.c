/* darts.c -- Poisson-disk sets on the torus.
 *
 * Source      [Cline07 4.5.3]: dart throwing; [Mitchell91] best candidate; [Lloyd82] relaxation.
 * Thrown      A point is drawn at random and refused within a distance r of another. To have n of
 *             them, r begins near the most that n discs can have and shrinks a little after many
 *             misses in a row: all points then keep the last r.
 * Best        Of some candidates the one farthest from all points so far is kept.
 * Relaxation  Each point goes to the middle of the part of the torus that is nearest to it, found
 *             by asking a fine lattice of places. A few steps leave no two points near each other;
 *             many make a lattice of them, with all its artefacts. */
#include "sampling/darts.h"

#include "base/mem.h"

#include <string.h>

#define NOBODY UINT32_MAX
#define TORUS 4294967296.0

/* Points by cell of side x side, in lists. */
typedef struct {
    TorusPoint *p;              /* borrowed */
    uint32_t    n, side;
    uint32_t   *head, *next;    /* owned: first point of a cell, next in its cell; or NOBODY */
} Cells;

static uint32_t cell_of(const Cells *c, uint32_t x)
{
    return (uint32_t)((uint64_t)x * c->side >> 32);
}

static bool cells_init(Cells *c, TorusPoint *p, uint32_t most)
{
    c->p = p;
    c->n = 0;
    c->side = (uint32_t)sqrt((double)most);
    c->head = MEM_ARRAY(uint32_t, (size_t)c->side * c->side);
    c->next = MEM_ARRAY(uint32_t, most);
    if (c->head)
        memset(c->head, 0xFF, (size_t)c->side * c->side * sizeof *c->head);
    return c->head && c->next;
}

static void cells_clear(Cells *c)
{
    mem_free(c->head);
    mem_free(c->next);
}

static void cells_add(Cells *c, TorusPoint q)
{
    size_t cell = (size_t)cell_of(c, q.y) * c->side + cell_of(c, q.x);

    c->p[c->n] = q;
    c->next[c->n] = c->head[cell];
    c->head[cell] = c->n++;
}

/* Squared distance, in units of 2^-64. */
static uint64_t apart(TorusPoint a, TorusPoint b)
{
    uint32_t dx = a.x - b.x, dy = a.y - b.y;
    uint64_t x = dx >> 31 ? 0 - dx : dx, y = dy >> 31 ? 0 - dy : dy;
    return x * x + y * y;
}

static void ask_cell(const Cells *c, TorusPoint q, uint32_t x, uint32_t y, uint32_t *nearest,
                     uint64_t *d2)
{
    for (uint32_t i = c->head[(size_t)y * c->side + x]; i != NOBODY; i = c->next[i]) {
        uint64_t d = apart(q, c->p[i]);
        if (d < *d2) {
            *d2 = d;
            *nearest = i;
        }
    }
}

/* The point nearest to q, if any: ring by ring of cells, until what is beyond the last ring is
 * farther. A torus of few cells meets some of them twice, which does no harm. */
static uint32_t nearest_point(const Cells *c, TorusPoint q, uint64_t *d2)
{
    uint32_t x = cell_of(c, q.x), y = cell_of(c, q.y), n = c->side, nearest = NOBODY;
    double wide = TORUS / n;

    *d2 = UINT64_MAX;
    for (uint32_t r = 0; 2 * r <= n; r++) {
        double reach = r > 0 ? (r - 1) * wide : 0;
        if (nearest != NOBODY && r > 0 && reach * reach >= (double)*d2)
            break;
        for (uint32_t k = 0; k <= 2 * r; k++) {
            uint32_t across = (x + n * (1 + r) + k - r) % n, down = (y + n * (1 + r) + k - r) % n;
            uint32_t left = (x + n * (1 + r) - r) % n, right = (x + r) % n;
            ask_cell(c, q, across, (y + n * (1 + r) - r) % n, &nearest, d2);
            ask_cell(c, q, across, (y + r) % n, &nearest, d2);
            ask_cell(c, q, left, down, &nearest, d2);
            ask_cell(c, q, right, down, &nearest, d2);
        }
    }
    return nearest;
}

static TorusPoint random_point(Rng *rng)
{
    uint64_t bits = rng_bits(rng);
    return (TorusPoint){ (uint32_t)(bits >> 32), (uint32_t)bits };
}

static TorusPoint thrown(const Cells *c, double *r, Rng *rng)
{
    enum { MISSES = 200 };
    TorusPoint q;
    uint64_t d2;

    for (int misses = 0;; misses++) {
        q = random_point(rng);
        if (misses == MISSES) {
            *r *= 0.97;
            misses = 0;
        }
        if (nearest_point(c, q, &d2) == NOBODY || (double)d2 >= *r * *r)
            return q;
    }
}

static TorusPoint best_candidate(const Cells *c, Rng *rng)
{
    enum { FIRST = 8, MOST = 100 };
    uint32_t candidates = c->n + FIRST < MOST ? c->n + FIRST : MOST;
    TorusPoint best = random_point(rng);
    uint64_t farthest, d2;

    nearest_point(c, best, &farthest);
    for (uint32_t k = 1; k < candidates; k++) {
        TorusPoint q = random_point(rng);
        nearest_point(c, q, &d2);
        if (d2 > farthest) {
            farthest = d2;
            best = q;
        }
    }
    return best;
}

/* Differences from a point to the places nearest to it, summed, and how many there are. */
typedef struct { double x, y; uint32_t count; } Pull;

/* One step of Lloyd's. */
static void relax(TorusPoint *p, const Cells *c, Pull *pull)
{
    uint32_t side = 8 * (c->side + 1);
    uint64_t step = ((uint64_t)1 << 32) / side, d2;

    memset(pull, 0, c->n * sizeof *pull);
    for (uint32_t y = 0; y < side; y++)
        for (uint32_t x = 0; x < side; x++) {
            TorusPoint q = { (uint32_t)(x * step), (uint32_t)(y * step) };
            uint32_t i = nearest_point(c, q, &d2), dx = q.x - p[i].x, dy = q.y - p[i].y;
            pull[i].x += dx >> 31 ? -(double)(0 - dx) : (double)dx;
            pull[i].y += dy >> 31 ? -(double)(0 - dy) : (double)dy;
            pull[i].count++;
        }
    for (uint32_t i = 0; i < c->n; i++)
        if (pull[i].count) {
            p[i].x += (uint32_t)(int64_t)(pull[i].x / pull[i].count);
            p[i].y += (uint32_t)(int64_t)(pull[i].y / pull[i].count);
        }
}

static bool relax_all(TorusPoint *p, uint32_t n, int steps)
{
    Pull *pull = MEM_ARRAY(Pull, n);
    bool ok = pull != NULL;

    for (int k = 0; k < steps && ok; k++) {
        Cells c;
        ok = cells_init(&c, p, n);
        for (uint32_t i = 0; ok && i < n; i++)
            cells_add(&c, p[i]);
        if (ok)
            relax(p, &c, pull);
        cells_clear(&c);
    }
    mem_free(pull);
    return ok;
}

bool darts_make(TorusPoint *p, uint32_t n, DartMethod method, int steps, Rng *rng)
{
    double r = 0.85 * sqrt(2 / (sqrt(3.0) * n)) * TORUS;
    Cells c;
    bool ok = cells_init(&c, p, n);

    while (ok && c.n < n)
        cells_add(&c, method == DARTS_THROWN ? thrown(&c, &r, rng) : best_candidate(&c, rng));
    cells_clear(&c);
    return ok && relax_all(p, n, steps);
}

double darts_distance(const TorusPoint *p, uint32_t n)
{
    double least = TORUS * TORUS;

    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < i; j++)
            least = d_min(least, (double)apart(p[i], p[j]));
    return sqrt(least) / TORUS;
}

/* learned.c -- the code of `learned.h` */
#include "sampling/learned.h"

#include "base/maths.h"

#include <stdint.h>
#include <string.h>

/* What a pixel keeps of the maps that it has from its neighbours: so it goes by the last few. Where
 * these were far brighter it keeps less, or would go by them for as many pixels as that takes. */
#define KEEP 0.5f
#define MOST_BEFORE 10.0
#define LITTLE 1e-12                    /* of the whole: what is forgotten comes to no denormals */
#define MORE_MOST 1e6f                  /* a density over another */
#define WORTH_MOST 1e30f                /* of a pixel: then maps and their sums are finite */

/* Cell of n that holds x. */
static int cell_of(float x, int n)
{
    int k = (int)(x * (float)n);
    return k < 0 ? 0 : k < n ? k : n - 1;
}

void learned_rings(LearnedRing *r, int h)
{
    for (int y = 0; y < h; y++) {
        float sine, cosine;
        m_sincos_turn(0.5f * ((float)y + 0.5f) / (float)h, &sine, &cosine);
        r[y] = (LearnedRing){ (int)(1.0f / sine + 0.5f), sine };
    }
}

/* To so many columns on either side of x that the angle is that of one at the equator, round the
 * ring. Densities over places are those over directions, times the sine; here squared. */
static void add_to_ring(float *row, int w, LearnedRing ring, int x, float value)
{
    int n = 2 * ring.reach + 1, at = x - ring.reach;

    value = value * ring.sine * ring.sine;
    if (n >= w) {
        n = w;
        at = 0;
    } else if (at < 0)
        at += w;
    for (; n > 0; n--, at = at + 1 < w ? at + 1 : 0)
        row[at] += value;
}

static void add_to_row(float *row, int w, int x, float value)
{
    if (x > 0)
        row[x - 1] += value;
    row[x] += value;
    if (x + 1 < w)
        row[x + 1] += value;
}

void learned_add(float *worth, LearnedShape s, V2 place, float square)
{
    int x = cell_of(place.x, s.w), y = cell_of(place.y, s.h);

    if (!(square > 0.0f) || !is_finite(square))
        return;
    if (s.single) {
        worth[x] += square;
        return;
    }
    for (int k = y > 0 ? y - 1 : 0; k <= y + 1 && k < s.h; k++)
        if (s.rings)
            add_to_ring(worth + k * s.w, s.w, s.rings[k], x, square);
        else
            add_to_row(worth + k * s.w, s.w, x, square);
}

void learned_moments(float *restrict moment, const float *restrict share, int n, float by_map,
                     float own, float now, float square)
{
    for (int k = 0; k < n; k++) {
        float then = f_max(learned_both(share[k], by_map, own), 1e-30f);
        moment[k] += square * f_min(now / then, MORE_MOST);
    }
}

/* Sums are many side by side, so that compilers may keep them in lanes and none waits for the one
 * before: the same everywhere. */
enum { SUMS = 32 };
static void add_to_sums(float part[SUMS], const float *a, int n)
{
    int i = 0;

    for (; i + SUMS <= n; i += SUMS)
        for (int k = 0; k < SUMS; k++)
            part[k] += a[i + k];
    for (int k = 0; i + k < n; k++)
        part[k] += a[i + k];
}

static double total(const float part[SUMS])
{
    double sum = 0.0;

    for (int k = 0; k < SUMS; k++)
        sum += part[k];
    return sum;
}

static double sum_of(const float *a, int n)
{
    float part[SUMS] = { 0 };

    add_to_sums(part, a, n);
    return total(part);
}

void learned_merge(float *map, const float *worth, int cells, int n)
{
    double sum = sum_of(worth, cells), before = sum_of(map, cells);
    float keep = KEEP, little;

    if (!(sum > 0.0) || !(sum < (double)WORTH_MOST))
        return;
    if (before > MOST_BEFORE * sum)
        keep *= (float)(MOST_BEFORE * sum / before);
    little = (float)(LITTLE * sum / cells);
    for (int i = 0; i < cells; i++)
        map[i] = keep * map[i] + (worth[i] + little);
    for (int i = cells; i < n; i++)
        map[i] = keep * map[i] + f_min(worth[i], WORTH_MOST);
}

void learned_sum(float *sum, const float *a, int cells)
{
    for (int i = 0; i < cells; i++)
        sum[i] += a[i];
}

/* As many as a pixel mostly has. All at once: each float is looked at once. */
enum { SEVEN = 7 };
static void mean_of_seven(float *restrict mean, const float *const *of, int cells)
{
    const float *a = of[0], *b = of[1], *c = of[2], *d = of[3], *e = of[4], *f = of[5], *g = of[6];
    float share = 1.0f / SEVEN;

    for (int i = 0; i < cells; i++)
        mean[i] = (a[i] + b[i] + c[i] + d[i] + e[i] + f[i] + g[i]) * share;
}

/* Piece by piece, each of which stays in the fastest memory until it is done. */
static void mean_of_any(float *mean, const float *const *of, int n, int cells)
{
    enum { PIECE = 1024 };
    float share = 1.0f / (float)n;

    for (int at = 0; at < cells; at += PIECE) {
        int m = cells - at < PIECE ? cells - at : PIECE;
        memcpy(mean + at, of[0] + at, (size_t)m * sizeof *mean);
        for (int k = 1; k < n; k++)
            learned_sum(mean + at, of[k] + at, m);
        for (int i = at; i < at + m; i++)
            mean[i] *= share;
    }
}

void learned_mean(float *mean, const float *const *of, int n, int cells)
{
    if (n == SEVEN)
        mean_of_seven(mean, of, cells);
    else
        mean_of_any(mean, of, n, cells);
}

/* ---- inverted ---- */

static void take_roots(float *root, const float *mass, int n)
{
    for (int i = 0; i < n; i++)
        root[i] = sqrtf(mass[i]);
}

/* Each root where the running sum up to it will be. Their sum. */
static double place_roots(float *cell, LearnedShape s, const float *mass)
{
    float part[SUMS] = { 0 };

    for (int y = 0; y < s.h; y++) {
        float *row = cell + y * (s.w + 1) + 1;
        take_roots(row, mass + y * s.w, s.w);
        add_to_sums(part, row, s.w);
    }
    return total(part);
}

static void running_sums(float *sum, int n, float part, float even)
{
    float x = 0.0f;

    sum[0] = 0.0f;
    for (int i = 1; i <= n; i++)
        sum[i] = x += part * sum[i] + even;
}

/* The same of four rows that follow each other: each sum waits for the one before it, but not for
 * those of other rows. */
enum { ROWS = 4 };
static void running_sums_of_rows(float *sum, int n, float part, float even)
{
    float *a = sum, *b = a + n + 1, *c = b + n + 1, *d = c + n + 1;
    float x = 0.0f, y = 0.0f, z = 0.0f, w = 0.0f;

    a[0] = b[0] = c[0] = d[0] = 0.0f;
    for (int i = 1; i <= n; i++) {
        a[i] = x += part * a[i] + even;
        b[i] = y += part * b[i] + even;
        c[i] = z += part * c[i] + even;
        d[i] = w += part * d[i] + even;
    }
}

void inverted_make(Inverted *t, LearnedShape s, const float *mass, float part, float *room)
{
    double all;
    float even, scale;
    int y;

    t->shape = s;
    t->mass = mass;
    t->even = !(part > 0.0f);
    t->row = room;
    t->cell = room + s.h + 1;
    all = place_roots(t->cell, s, mass);
    t->alone = all > 0.0 ? (float)(learned_cells(s) / all) : 0.0f;
    if (t->even)
        return;
    even = (all > 0.0 ? 1.0f - part : 1.0f) / (float)learned_cells(s);
    scale = part * t->alone / (float)learned_cells(s);
    for (y = 0; y + ROWS <= s.h; y += ROWS)
        running_sums_of_rows(t->cell + y * (s.w + 1), s.w, scale, even);
    for (; y < s.h; y++)
        running_sums(t->cell + y * (s.w + 1), s.w, scale, even);
    t->row[0] = 0.0f;
    for (y = 0; y < s.h; y++)
        t->row[y + 1] = t->row[y] + t->cell[y * (s.w + 1) + s.w];
}

/* The last i with sum[i] <= x, for 0 <= x < sum[n]: its share is not empty. By halves as far as
 * counting is not faster: a count's steps do not wait for each other. */
enum { COUNTED = 64 };
static int find(const float *sum, int n, float x)
{
    int low = 0, i = 0;

    while (n > COUNTED) {
        int half = n / 2;
        low = sum[low + half] <= x ? low + half : low;
        n -= half;
    }
    for (int k = 1; k <= n; k++)
        i += sum[low + k] <= x;
    return low + i;
}

/* The part that u of the total lies in; *u moves to its place within that part, in [0,1]. Where
 * u times the total is rounded up to the total, it is the last part that is not empty. */
static int part_of(const float *sum, int n, float *u)
{
    float x = *u * sum[n];
    int i;

    if (x < sum[n])
        i = find(sum, n, x);
    else
        for (i = n - 1; i > 0 && sum[i] == sum[n]; i--)
            ;
    *u = (x - sum[i]) / (sum[i + 1] - sum[i]);
    return i;
}

static float share_of(const float *sum, int n, int i) { return (sum[i + 1] - sum[i]) / sum[n]; }

/* The place in cell i of n, in multiples of 2^-24. Rounding may cross into a neighbour: a step goes
 * back. */
static float place_in(int i, float rest, int n)
{
    float x = (float)(int32_t)(((float)i + rest) / (float)n * 0x1p24f) * 0x1p-24f;

    while (x >= 1.0f || cell_of(x, n) > i)
        x -= 0x1p-24f;
    while (cell_of(x, n) < i)
        x += 0x1p-24f;
    return x;
}

static float density_of(const Inverted *t, int x, int y)
{
    LearnedShape s = t->shape;
    const float *sum = t->cell + y * (s.w + 1);
    float row = s.h > 1 ? share_of(t->row, s.h, y) : 1.0f;
    return row > 0.0f ? row * share_of(sum, s.w, x) * (float)learned_cells(s) : 0.0f;
}

V2 inverted_sample(const Inverted *t, V2 u, float *density)
{
    LearnedShape s = t->shape;
    int x, y;

    if (t->even) {
        *density = 1.0f;
        return (V2){ u.x, s.h > 1 ? u.y : 0.0f };
    }
    y = s.h > 1 ? part_of(t->row, s.h, &u.y) : 0;
    x = part_of(t->cell + y * (s.w + 1), s.w, &u.x);
    *density = density_of(t, x, y);
    u.y = s.h > 1 ? place_in(y, u.y, s.h) : 0.0f;
    return (V2){ place_in(x, u.x, s.w), u.y };
}

float inverted_density(const Inverted *t, V2 place)
{
    return t->even ? 1.0f
                   : density_of(t, cell_of(place.x, t->shape.w), cell_of(place.y, t->shape.h));
}

float inverted_alone(const Inverted *t, V2 place)
{
    LearnedShape s = t->shape;
    float mass = t->mass[cell_of(place.y, s.h) * s.w + cell_of(place.x, s.w)];
    return t->alone > 0.0f ? sqrtf(mass) * t->alone : 1.0f;
}

int inverted_choose(const Inverted *t, float u, float *rest)
{
    int i = part_of(t->cell, t->shape.w, &u);

    *rest = u;
    return i;
}

float inverted_pmf(const Inverted *t, int entry)
{
    return share_of(t->cell, t->shape.w, entry);
}

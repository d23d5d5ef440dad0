/* learned.c -- the code of `learned.h` */
#include "sampling/learned.h"

#include <stdint.h>
#include <string.h>

/* Cell of n that holds x. */
static int cell_of(float x, int n)
{
    int k = (int)(x * (float)n);
    return k < 0 ? 0 : k < n ? k : n - 1;
}

static void add_to_row(float *row, LearnedShape s, int x, float value)
{
    int left = x - 1, right = x + 1;

    row[x] += value;
    if (s.single)
        return;
    if (s.around) {
        left = left < 0 ? s.w - 1 : left;
        right = right < s.w ? right : 0;
    }
    if (left >= 0)
        row[left] += value;
    if (right < s.w)
        row[right] += value;
}

void learned_add(float *worth, LearnedShape s, V2 place, float value)
{
    int x = cell_of(place.x, s.w), y = cell_of(place.y, s.h);

    if (!(value > 0.0f) || !is_finite(value))
        return;
    for (int k = y > 0 ? y - 1 : 0; k <= y + 1 && k < s.h; k++)
        add_to_row(worth + k * s.w, s, x, value);
}

float learned_density(const float *map, LearnedShape s, V2 place)
{
    return map[cell_of(place.y, s.h) * s.w + cell_of(place.x, s.w)] * (float)learned_cells(s);
}

/* In eight sums side by side, so that compilers may keep them in lanes: the same everywhere. */
static double sum_of(const float *a, int n)
{
    float part[8] = { 0, 0, 0, 0, 0, 0, 0, 0 };
    double sum = 0.0;
    int i = 0;

    for (; i + 8 <= n; i += 8)
        for (int k = 0; k < 8; k++)
            part[k] += a[i + k];
    for (; i < n; i++)
        sum += a[i];
    for (int k = 0; k < 8; k++)
        sum += part[k];
    return sum;
}

bool learned_merge(float *map, const float *worth, int cells, float constant)
{
    double sum = sum_of(worth, cells), all = 1.0 + (double)constant * cells;
    float scale, even;

    if (!(sum > 0.0) || !(sum < 1e38))
        return false;
    scale = (float)(0.5 / (sum * all));
    even = (float)(0.5 * constant / all);
    if (!is_finite(scale))
        return false;
    for (int i = 0; i < cells; i++)
        map[i] = 0.5f * map[i] + (scale * worth[i] + even);
    return true;
}

void learned_uniform(float *map, int cells)
{
    for (int i = 0; i < cells; i++)
        map[i] = 1.0f / (float)cells;
}

void learned_sum(float *sum, const float *a, int cells)
{
    for (int i = 0; i < cells; i++)
        sum[i] += a[i];
}

void learned_mean(float *mean, const float *const *of, int n, int cells)
{
    float share = 1.0f / (float)n;

    memcpy(mean, of[0], (size_t)cells * sizeof *mean);
    for (int k = 1; k < n; k++)
        learned_sum(mean, of[k], cells);
    for (int i = 0; i < cells; i++)
        mean[i] *= share;
}

/* ---- inverted ---- */

static void running_sums(float *sum, const float *mass, int n, float part, float even)
{
    float x = 0.0f;

    sum[0] = 0.0f;
    for (int i = 0; i < n; i++)
        sum[i + 1] = x += part * mass[i] + even;
}

void inverted_make(Inverted *t, LearnedShape s, const float *map, float part, float *room)
{
    float even = (1.0f - part) / (float)learned_cells(s);

    t->shape = s;
    t->row = room;
    t->cell = room + s.h + 1;
    t->row[0] = 0.0f;
    for (int y = 0; y < s.h; y++) {
        float *sum = t->cell + y * (s.w + 1);
        running_sums(sum, map + y * s.w, s.w, part, even);
        t->row[y + 1] = t->row[y] + sum[s.w];
    }
}

/* The last i with sum[i] <= x, for 0 <= x < sum[n]: its share is not empty. */
static int find(const float *sum, int n, float x)
{
    int low = 0;

    while (n > 1) {
        int half = n / 2;
        low = sum[low + half] <= x ? low + half : low;
        n -= half;
    }
    return low;
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
    int y = s.h > 1 ? part_of(t->row, s.h, &u.y) : 0;
    int x = part_of(t->cell + y * (s.w + 1), s.w, &u.x);

    *density = density_of(t, x, y);
    u.y = s.h > 1 ? place_in(y, u.y, s.h) : 0.0f;
    return (V2){ place_in(x, u.x, s.w), u.y };
}

float inverted_density(const Inverted *t, V2 place)
{
    return density_of(t, cell_of(place.x, t->shape.w), cell_of(place.y, t->shape.h));
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

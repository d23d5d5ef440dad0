/* table.c -- tables for sampling in proportion to weights. See table.h. */
#include "sampling/table.h"

#include "base/error.h"
#include "base/mem.h"

static double weight_of(float w) { return w > 0.0f && is_finite(w) ? w : 0.0; }

/* A leftover as float: rounding must not carry it to 1. */
static float canonical(double rest)
{
    float r = (float)rest;
    return r < ONE_MINUS_ULP ? (r > 0.0f ? r : 0.0f) : ONE_MINUS_ULP;
}

/* ---- running sums, shared by the 1-D and the 2-D table ---- */

/* sum[0..n] of n weights. */
static void sums_fill(double *sum, const float *weight, size_t n)
{
    sum[0] = 0.0;
    for (size_t i = 0; i < n; i++)
        sum[i + 1] = sum[i] + weight_of(weight[i]);
}

/* The first i with sum[i + 1] > x, for 0 <= x < sum[n]; then sum[i] <= x, so its share is not 0. */
static size_t sums_find(const double *sum, size_t n, double x)
{
    size_t lo = 0;
    while (n > 1) {
        size_t half = n / 2;
        lo = sum[lo + half] <= x ? lo + half : lo;
        n -= half;
    }
    return lo;
}

static double sums_share(const double *sum, size_t n, size_t i)
{
    return (sum[i + 1] - sum[i]) / sum[n];
}

/* As above for the part u of the total, with the leftover. The total is not 0. */
static size_t sums_sample(const double *sum, size_t n, double u, double *rest)
{
    double x = u * sum[n];
    size_t i;
    if (!(x < sum[n]))                  /* u so near 1 that the product rounds up: the last share */
        for (i = n - 1; sum[i] == sum[n]; i--)
            ;
    else
        i = sums_find(sum, n, x);
    *rest = (x - sum[i]) / (sum[i + 1] - sum[i]);
    return i;
}

/* ---- Table ---- */

bool table_init(Table *t, const float *weight, size_t n)
{
    *t = (Table){ 0, NULL };
    t->sum = MEM_ARRAY(double, n + 1);
    if (!t->sum)
        return false;
    t->n = n;
    sums_fill(t->sum, weight, n);
    return true;
}

void table_clear(Table *t)
{
    mem_free(t->sum);
    *t = (Table){ 0, NULL };
}

double table_total(const Table *t) { return t->n ? t->sum[t->n] : 0.0; }

bool table_sample(const Table *t, double u, size_t *index, float *pmf, float *rest)
{
    double left;
    if (!(table_total(t) > 0.0))
        return false;
    *index = sums_sample(t->sum, t->n, u, &left);
    if (pmf)
        *pmf = table_pmf(t, *index);
    if (rest)
        *rest = canonical(left);
    return true;
}

float table_pmf(const Table *t, size_t index)
{
    return table_total(t) > 0.0 ? (float)sums_share(t->sum, t->n, index) : 0.0f;
}

/* ---- AliasTable ---- */

/* Pairs bins below their 1/n share with bins above, each pair fixing one bin. `heap` has room for
 * n: those below grow from its front, those above from its back; keep[] has the shares times n.
 * What rounding leaves over gives its remainder to the heaviest bin, never to one of weight 0. */
static void alias_pair(AliasBin *bin, uint32_t n, uint32_t *heap, uint32_t heaviest)
{
    uint32_t below = 0, above = n;
    for (uint32_t i = 0; i < n; i++) {
        bin[i].other = heaviest;
        if (bin[i].keep < 1.0)
            heap[below++] = i;
        else
            heap[--above] = i;
    }
    while (below > 0 && above < n) {
        uint32_t poor = heap[--below], rich = heap[above];
        bin[poor].other = rich;
        bin[rich].keep = (bin[rich].keep + bin[poor].keep) - 1.0;
        if (bin[rich].keep < 1.0) {     /* both stacks shrank by one, so there is room */
            above++;
            heap[below++] = rich;
        }
    }
    while (above < n)
        bin[heap[above++]].keep = 1.0;
}

bool alias_init(AliasTable *t, const float *weight, uint32_t n)
{
    uint32_t *heap, heaviest = 0;

    *t = (AliasTable){ 0, 0.0, NULL };
    t->bin = MEM_ARRAY(AliasBin, n);
    heap = MEM_ARRAY(uint32_t, n);
    if (!t->bin || !heap) {
        mem_free(heap);
        alias_clear(t);
        return false;
    }
    t->n = n;
    for (uint32_t i = 0; i < n; i++) {
        t->total += weight_of(weight[i]);
        if (weight_of(weight[i]) > weight_of(weight[heaviest]))
            heaviest = i;
    }
    for (uint32_t i = 0; i < n && t->total > 0.0; i++) {
        double share = weight_of(weight[i]) / t->total;
        t->bin[i].pmf = (float)share;
        t->bin[i].keep = share * n;
    }
    alias_pair(t->bin, n, heap, heaviest);
    mem_free(heap);
    return true;
}

void alias_clear(AliasTable *t)
{
    mem_free(t->bin);
    *t = (AliasTable){ 0, 0.0, NULL };
}

bool alias_sample(const AliasTable *t, double u, uint32_t *index, float *pmf, float *rest)
{
    double x = u * t->n, keep;
    uint32_t i;
    if (!(t->total > 0.0))
        return false;
    i = x < t->n ? (uint32_t)x : t->n - 1;
    x -= i;
    keep = t->bin[i].keep;
    if (x < keep || keep == 1.0)
        x /= keep;
    else {
        x = (x - keep) / (1.0 - keep);
        i = t->bin[i].other;
    }
    *index = i;
    if (pmf)
        *pmf = t->bin[i].pmf;
    if (rest)
        *rest = canonical(x);
    return true;
}

float alias_pmf(const AliasTable *t, uint32_t index) { return t->bin[index].pmf; }

/* ---- Table2 ---- */

static const double *row_of(const Table2 *t, uint32_t y)
{
    return t->cell + (size_t)y * (t->w + 1);
}

bool table2_init(Table2 *t, const float *weight, uint32_t w, uint32_t h)
{
    *t = (Table2){ 0, 0, NULL, NULL };
    ASSERT(w <= TABLE2_MOST && h <= TABLE2_MOST);
    t->row = MEM_ARRAY(double, (size_t)h + 1);
    t->cell = mem_array(h, (w + 1) * sizeof *t->cell);       /* the product is checked */
    if (!t->row || !t->cell) {
        table2_clear(t);
        return false;
    }
    t->w = w;
    t->h = h;
    for (uint32_t y = 0; y < h; y++) {
        double *sum = t->cell + (size_t)y * (w + 1);
        sums_fill(sum, weight + (size_t)y * w, w);
        t->row[y + 1] = t->row[y] + sum[w];
    }
    return true;
}

void table2_clear(Table2 *t)
{
    mem_free(t->row);
    mem_free(t->cell);
    *t = (Table2){ 0, 0, NULL, NULL };
}

double table2_total(const Table2 *t) { return t->row ? t->row[t->h] : 0.0; }

/* Cell of n that the coordinate lies in; what is outside belongs to the nearest. */
static uint32_t cell_of(float x, uint32_t n)
{
    double k = (double)x * n;
    return k < 1.0 ? 0 : k < n ? (uint32_t)k : n - 1;
}

static float cell_pdf(const Table2 *t, uint32_t x, uint32_t y)
{
    const double *sum = row_of(t, y);
    double row = sums_share(t->row, t->h, y);
    return row > 0.0 ? (float)(row * t->h * sums_share(sum, t->w, x) * t->w) : 0.0f;
}

/* The place `rest` within cell i of n. Rounding to float may cross into a neighbour, as it does in
 * the listings of [Cline07 5.2]: then a step of 2^-24, less than a cell, leads back. */
static float place_in(uint32_t i, double rest, uint32_t n)
{
    float x = (float)((i + rest) / n);
    uint32_t k = cell_of(x, n);
    return x >= 1.0f || k > i ? x - 0x1p-24f : k < i ? x + 0x1p-24f : x;
}

bool table2_sample(const Table2 *t, V2 u, V2 *point, float *pdf)
{
    double rest_x, rest_y;
    uint32_t x, y;
    if (!(table2_total(t) > 0.0))
        return false;
    y = (uint32_t)sums_sample(t->row, t->h, u.y, &rest_y);
    x = (uint32_t)sums_sample(row_of(t, y), t->w, u.x, &rest_x);
    *point = (V2){ place_in(x, rest_x, t->w), place_in(y, rest_y, t->h) };
    *pdf = cell_pdf(t, x, y);
    return true;
}

static float number_of(const double *sum, uint32_t n, float x)
{
    uint32_t i = cell_of(x, n);
    double rest = d_min(d_max((double)x * n - i, 0.0), 1.0);
    return sum[n] > 0.0 ? canonical((sum[i] + rest * (sum[i + 1] - sum[i])) / sum[n]) : 0.0f;
}

V2 table2_numbers(const Table2 *t, V2 point)
{
    return (V2){ number_of(row_of(t, cell_of(point.y, t->h)), t->w, point.x),
                 number_of(t->row, t->h, point.y) };
}

float table2_pdf(const Table2 *t, V2 point)
{
    if (!(table2_total(t) > 0.0))
        return 0.0f;
    return cell_pdf(t, cell_of(point.x, t->w), cell_of(point.y, t->h));
}

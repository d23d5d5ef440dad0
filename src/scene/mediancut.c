/* mediancut.c -- regions of like light. See mediancut.h. */
#include "scene/mediancut.h"

#include "base/mem.h"

typedef struct { const float *weight; uint32_t w; } Cells;

static double row_light(const Cells *c, const Region *r, uint32_t y)
{
    double sum = 0.0;
    for (uint32_t x = r->x0; x < r->x1; x++)
        sum += c->weight[(size_t)y * c->w + x];
    return sum;
}

static double column_light(const Cells *c, const Region *r, uint32_t x)
{
    double sum = 0.0;
    for (uint32_t y = r->y0; y < r->y1; y++)
        sum += c->weight[(size_t)y * c->w + x];
    return sum;
}

static double light_of(const Cells *c, const Region *r)
{
    double sum = 0.0;
    for (uint32_t y = r->y0; y < r->y1; y++)
        sum += row_light(c, r, y);
    return sum;
}

/* Where the light of lines [lo, hi) is nearest to a half; at least one line on both sides. */
static uint32_t half_way(const Cells *c, const Region *r, bool rows, uint32_t lo, uint32_t hi)
{
    double all = light_of(c, r), sum = 0.0, one = 0.0;
    uint32_t k;

    for (k = lo; k < hi - 1; k++) {
        one = rows ? row_light(c, r, k) : column_light(c, r, k);
        if (sum + one >= 0.5 * all)
            break;
        sum += one;
    }
    if (k < hi - 1 && sum + one - 0.5 * all < 0.5 * all - sum)
        k++;                    /* this line rather belongs to the first half */
    return k > lo ? k : lo + 1;
}

static void cut(MedianCut *m, const Cells *c, uint32_t i)
{
    Region r = m->node[i], *a = &m->node[2 * i], *b = &m->node[2 * i + 1];
    uint32_t nx = r.x1 - r.x0, ny = r.y1 - r.y0;
    bool rows = (double)ny * m->w >= (double)nx * m->h;         /* by lengths in the picture */

    if (rows ? ny < 2 : nx < 2)
        rows = !rows;
    *a = *b = r;
    if (nx * ny < 2)
        b->x1 = b->x0;
    else if (rows)
        a->y1 = b->y0 = half_way(c, &r, true, r.y0, r.y1);
    else
        a->x1 = b->x0 = half_way(c, &r, false, r.x0, r.x1);
}

static void set_middle(const MedianCut *m, const Cells *c, Region *r, double light)
{
    double x = 0.0, y = 0.0;

    r->middle = (V2){ 0.5f * (float)(r->x0 + r->x1) / (float)m->w,
                      0.5f * (float)(r->y0 + r->y1) / (float)m->h };
    if (!(light > 0.0))
        return;
    for (uint32_t k = r->x0; k < r->x1; k++)
        x += column_light(c, r, k) * (k + 0.5);
    for (uint32_t k = r->y0; k < r->y1; k++)
        y += row_light(c, r, k) * (k + 0.5);
    r->middle = (V2){ (float)(x / light / m->w), (float)(y / light / m->h) };
}

bool mediancut_init(MedianCut *m, const float *weight, uint32_t w, uint32_t h, int cuts)
{
    uint32_t n = 1u << cuts;
    float *light = MEM_ARRAY(float, n);
    Cells c = { weight, w };
    bool ok;

    *m = (MedianCut){ w, h, cuts, NULL, { 0, NULL } };
    m->node = MEM_ARRAY(Region, 2 * n);
    ok = light && m->node;
    if (ok) {
        m->node[1] = (Region){ 0, 0, w, h, { 0, 0 } };
        for (uint32_t i = 1; i < n; i++)
            cut(m, &c, i);
        for (uint32_t i = 0; i < n; i++) {
            double sum = light_of(&c, &m->node[n + i]);
            light[i] = (float)sum;
            set_middle(m, &c, &m->node[n + i], sum);
        }
    }
    ok = ok && table_init(&m->table, light, n);
    mem_free(light);
    if (!ok)
        mediancut_clear(m);
    return ok;
}

void mediancut_clear(MedianCut *m)
{
    mem_free(m->node);
    table_clear(&m->table);
    m->node = NULL;
}

static uint32_t cell_of(float x, uint32_t n)
{
    float k = x * (float)n;
    return k < 1.0f ? 0 : k < (float)n ? (uint32_t)k : n - 1;
}

static bool holds(const Region *r, uint32_t x, uint32_t y)
{
    return x >= r->x0 && x < r->x1 && y >= r->y0 && y < r->y1;
}

uint32_t mediancut_find(const MedianCut *m, V2 place)
{
    uint32_t x = cell_of(place.x, m->w), y = cell_of(place.y, m->h), i = 1;

    for (int k = 0; k < m->cuts; k++)
        i = holds(&m->node[2 * i], x, y) ? 2 * i : 2 * i + 1;
    return i - (1u << m->cuts);
}

static float pdf_in(const MedianCut *m, uint32_t region)
{
    const Region *r = &m->node[(1u << m->cuts) + region];
    float area = (float)(r->x1 - r->x0) / (float)m->w * ((float)(r->y1 - r->y0) / (float)m->h);
    return area > 0.0f ? table_pmf(&m->table, region) / area : 0.0f;
}

float mediancut_pdf(const MedianCut *m, V2 place)
{
    return pdf_in(m, mediancut_find(m, place));
}

bool mediancut_sample(const MedianCut *m, V2 u, bool jitter, V2 *place, float *pdf)
{
    const Region *r;
    size_t i;

    if (!table_sample(&m->table, u.x, &i, NULL, &u.x))
        return false;
    r = &m->node[(1u << m->cuts) + i];
    *pdf = pdf_in(m, (uint32_t)i);
    *place = r->middle;
    if (jitter) {
        float x = ((float)r->x0 + u.x * (float)(r->x1 - r->x0)) / (float)m->w;
        float y = ((float)r->y0 + u.y * (float)(r->y1 - r->y0)) / (float)m->h;
        *place = (V2){ f_min(x, ONE_MINUS_ULP), f_min(y, ONE_MINUS_ULP) };
        *pdf = mediancut_pdf(m, *place);        /* rounding may lead into the next region */
    }
    return *pdf > 0.0f;
}

/* panorama.c -- pictures whose places are directions: their light, and samples of it. See
 * panorama.h; mapping.c has the mappings. */
#include "scene/panorama.h"

#include "base/mem.h"

#include <string.h>

static uint32_t width(const Panorama *p) { return p->image ? p->image->w : 1; }
static uint32_t height(const Panorama *p) { return p->image ? p->image->h : 1; }

static Rgb cell(const Panorama *p, uint32_t x, uint32_t y)
{
    return p->image ? *image_at(p->image, x, y) : rgb_all(1.0f);
}

/* Mean of the jacobian over a cell that the rim of a ball may cut. Of a cell of which a little is
 * within, and no point that is looked at, a little: its density must not be 0. */
static double ball_cell(const Panorama *p, uint32_t x, uint32_t y)
{
    enum { SIDE = 8 };
    float w = (float)width(p), h = (float)height(p), jacobian;
    float left = 2.0f * (float)x / w - 1.0f, top = 2.0f * (float)y / h - 1.0f;
    float nx = f_max(0.0f, f_max(left, -(left + 2.0f / w)));
    float ny = f_max(0.0f, f_max(top, -(top + 2.0f / h)));
    float fx = f_max(fabsf(left), fabsf(left + 2.0f / w));
    float fy = f_max(fabsf(top), fabsf(top + 2.0f / h));
    double sum = 0.0;

    if (nx * nx + ny * ny >= 1.0f)
        return 0.0;
    if (fx * fx + fy * fy <= 1.0f && width(p) >= 64 && height(p) >= 64) {
        V2 middle = { ((float)x + 0.5f) / w, ((float)y + 0.5f) / h };
        mapping_direction(&p->mapping, middle, &jacobian);
        return jacobian;
    }
    for (int i = 0; i < SIDE * SIDE; i++) {
        V2 q = { ((float)x + ((float)(i % SIDE) + 0.5f) / SIDE) / w,
                 ((float)y + ((float)(i / SIDE) + 0.5f) / SIDE) / h };
        mapping_direction(&p->mapping, q, &jacobian);
        sum += jacobian;
    }
    return d_max(sum, 0.01) / (SIDE * SIDE);
}

/* Solid angle of a cell, up to a factor that all have in common. */
static double cell_measure(const Panorama *p, uint32_t x, uint32_t y)
{
    const Mapping *m = &p->mapping;
    double w = width(p), h = height(p), l, r, t, b;

    switch (m->kind) {
    case MAPPING_LATLONG:    break;
    case MAPPING_OCTAHEDRAL: return 1.0;
    case MAPPING_ANGULAR:
    case MAPPING_MIRRORBALL: return ball_cell(p, x, y);
    case MAPPING_WINDOW:
        l = (2.0 * x / w - 1.0) * m->half_x;
        r = (2.0 * (x + 1.0) / w - 1.0) * m->half_x;
        t = (2.0 * y / h - 1.0) * m->half_y;
        b = (2.0 * (y + 1.0) / h - 1.0) * m->half_y;
        return d_max(0.0, mapping_corner(r, b) - mapping_corner(l, b) -
                          mapping_corner(r, t) + mapping_corner(l, t));
    }
    return md_sin(PI * (y + 0.5) / h);
}

/* Cells of a row go by runs, whose directions are that of their middle: at most 256 of them. */
static V3 moment_of_row(const Panorama *p, const float *weight, uint32_t y)
{
    uint32_t w = width(p), step = 1 + (w - 1) / 256;
    V3 sum = v_all(0.0f);
    float jacobian;

    for (uint32_t x = 0; x < w; x += step) {
        uint32_t end = x + step < w ? x + step : w;
        V2 q = { 0.5f * (float)(x + end) / (float)w, ((float)y + 0.5f) / (float)height(p) };
        V3 d = mapping_direction(&p->mapping, q, &jacobian);
        float run = 0.0f;
        for (uint32_t i = x; i < end; i++)
            run += weight[i];
        sum = v_mad(d, run, sum);
    }
    return sum;
}

/* Light of each cell: luminance times solid angle. */
static float *weights_of(Panorama *p)
{
    double sum[3] = { 0, 0, 0 }, moment[3] = { 0, 0, 0 }, all = 0;
    float *weight = MEM_ARRAY(float, (size_t)width(p) * height(p));
    V3 row_moment;

    for (uint32_t y = 0; weight && y < height(p); y++) {
        double row = cell_measure(p, 0, y);
        for (uint32_t x = 0; x < width(p); x++) {
            double measure = p->mapping.kind == MAPPING_LATLONG ? row : cell_measure(p, x, y);
            Rgb c = cell(p, x, y);
            weight[(size_t)y * width(p) + x] = (float)(rgb_lum(c) * measure);
            sum[0] += c.r * measure;
            sum[1] += c.g * measure;
            sum[2] += c.b * measure;
            all += measure;
        }
        row_moment = moment_of_row(p, weight + (size_t)y * width(p), y);
        moment[0] += row_moment.x;
        moment[1] += row_moment.y;
        moment[2] += row_moment.z;
    }
    p->moment = v3((float)(moment[0] / all), (float)(moment[1] / all), (float)(moment[2] / all));
    p->mean = rgb((float)(sum[0] / all), (float)(sum[1] / all), (float)(sum[2] / all));
    return weight;
}

bool panorama_init(Panorama *p, const Image *image, Mapping m)
{
    float *weight;
    bool ok;

    memset(p, 0, sizeof *p);
    p->image = image;
    p->mapping = m;
    weight = weights_of(p);
    ok = weight && table2_init(&p->table, weight, width(p), height(p));
    mem_free(weight);
    return ok;
}

/* Mean of radiance times jacobian over a region: its light over its area. */
static Rgb region_mean(const Panorama *p, const Region *r)
{
    float jacobian, area = (float)(r->x1 - r->x0) * (float)(r->y1 - r->y0);
    double sum[3] = { 0, 0, 0 };

    for (uint32_t y = r->y0; y < r->y1; y++)
        for (uint32_t x = r->x0; x < r->x1; x++) {
            V2 at = { ((float)x + 0.5f) / (float)width(p), ((float)y + 0.5f) / (float)height(p) };
            Rgb c = cell(p, x, y);
            mapping_direction(&p->mapping, at, &jacobian);
            sum[0] += (double)c.r * jacobian;
            sum[1] += (double)c.g * jacobian;
            sum[2] += (double)c.b * jacobian;
        }
    return area > 0.0f ? rgb((float)(sum[0] / area), (float)(sum[1] / area),
                             (float)(sum[2] / area)) : rgb_all(0.0f);
}

static bool set_regions(Panorama *p)
{
    uint32_t n = 1u << p->cut.cuts;

    p->region = MEM_ARRAY(Rgb, n);
    for (uint32_t i = 0; p->region && i < n; i++)
        p->region[i] = region_mean(p, &p->cut.node[n + i]);
    return p->region != NULL;
}

bool panorama_set_way(Panorama *p, PanoramaWay way, int cuts)
{
    float *weight = way == PANORAMA_CDF ? NULL : weights_of(p);
    bool ok = way == PANORAMA_CDF;

    p->way = way;
    if (weight && way == PANORAMA_ALIAS)
        ok = alias_init(&p->alias, weight, width(p) * height(p));
    else if (weight)
        ok = mediancut_init(&p->cut, weight, width(p), height(p), cuts) &&
             (way != PANORAMA_FIXED || set_regions(p));
    mem_free(weight);
    return ok;
}

/* Where samples of the surface are as many, they find directions of the hemisphere with a density
 * of 1/2 pi in the mean over all orientations of a surface. Those of the picture are to add what is
 * wanting: both together in proportion to the light L, up from a level l below which the surface
 * finds enough. A density of (L - l) / Z, where Z is the integral of max(0, L - l), plus 1/2 pi is
 * proportional to L if l = Z / 2 pi. In sums over the cells above the level, W of their light and M
 * of their solid angle, A of all: Z = W - l M and 2 pi = A / 2, so l = 2 W / (A + 2 M). From l = 0
 * this climbs to the solution, which is Newton's method: the fewer the cells above, the less it
 * moves. [Karlik19] subtracts the mean. */
static double even_level(const float *weight, const float *measure, size_t n, double all,
                         double lum, double angle)
{
    enum { STEPS_MOST = 32 };   /* of 4 to 8 on pictures of the sky; any level is unbiased */
    double level = 0.0, last = -1.0;

    for (int k = 0; k < STEPS_MOST && level > last; k++) {
        double above = lum > level ? angle : 0.0, light = lum * above;
        for (size_t i = 0; i < n; i++)
            if (weight[i] > level * measure[i]) {
                light += weight[i];
                above += measure[i];
            }
        last = level;
        level = all > 0.0 ? 2.0 * light / (all + 2.0 * above) : 0.0;
    }
    return last;
}

bool panorama_set_bright(Panorama *p, double lum, double angle, float *share)
{
    size_t n = (size_t)width(p) * height(p);
    float *weight = weights_of(p), *measure = MEM_ARRAY(float, n);
    bool ok = weight && measure;
    double all = 0.0, level, rest = 0.0, other;

    for (size_t i = 0; ok && i < n; i++) {
        measure[i] = (float)cell_measure(p, (uint32_t)(i % width(p)), (uint32_t)(i / width(p)));
        all += measure[i];
    }
    angle *= all / (4.0 * PI);                  /* in the unit of cells */
    level = ok ? even_level(weight, measure, n, all, lum, angle) : 0.0;
    for (size_t i = 0; ok && i < n; i++) {
        weight[i] = (float)d_max(0.0, weight[i] - level * measure[i]);
        rest += weight[i];
    }
    other = d_max(0.0, lum - level) * angle;
    if (share)
        *share = other > 0.0 ? (float)(other / (other + rest)) : 0.0f;
    ok = ok && table2_init(&p->bright, weight, width(p), height(p));
    mem_free(weight);
    mem_free(measure);
    return ok;
}

void panorama_clear(Panorama *p)
{
    table2_clear(&p->table);
    table2_clear(&p->bright);
    alias_clear(&p->alias);
    mediancut_clear(&p->cut);
    mem_free(p->region);
    p->region = NULL;
}

static Rgb lookup(const Panorama *p, V2 q)
{
    uint32_t x = (uint32_t)(q.x * (float)width(p)), y = (uint32_t)(q.y * (float)height(p));
    if (x >= width(p))
        x = width(p) - 1;
    if (y >= height(p))
        y = height(p) - 1;
    return cell(p, x, y);
}

Rgb panorama_at(const Panorama *p, V3 d)
{
    float jacobian;
    V2 q = mapping_place(&p->mapping, d, &jacobian);

    if (p->mapping.kind == MAPPING_WINDOW && !(jacobian > 0.0f))
        return rgb_all(0.0f);
    return lookup(p, q);
}

/* Density per unit square. */
static float place_pdf(const Panorama *p, V2 q)
{
    return p->way < PANORAMA_MEDIANCUT ? table2_pdf(&p->table, q) : mediancut_pdf(&p->cut, q);
}

float panorama_pdf_w(const Panorama *p, V3 d)
{
    float jacobian;
    V2 q = mapping_place(&p->mapping, d, &jacobian);
    return jacobian > 0.0f ? place_pdf(p, q) / jacobian : 0.0f;
}

float panorama_bright_pdf_w(const Panorama *p, V3 d)
{
    float jacobian;
    V2 q = mapping_place(&p->mapping, d, &jacobian);
    return jacobian > 0.0f ? table2_pdf(&p->bright, q) / jacobian : 0.0f;
}

V2 panorama_numbers(const Panorama *p, bool bright, V3 d)
{
    float jacobian;
    V2 q = mapping_place(&p->mapping, d, &jacobian);
    return table2_numbers(bright ? &p->bright : &p->table, q);
}

/* The cell takes both numbers, as one of 48 bits; what they still hold is cut in two for the place
 * in the cell, of 12 bits a side. Neighbours in u are none in the picture: strata are lost. */
static bool place_by_alias(const Panorama *p, V2 u, V2 *q, float *pdf)
{
    uint32_t i, w = width(p), h = height(p);
    float rest, high;

    if (!alias_sample(&p->alias, u.x + u.y * 0x1p-24, &i, NULL, &rest))
        return false;
    high = (float)(uint32_t)(rest * 0x1p12f);
    rest = rest * 0x1p12f - high;
    *q = (V2){ f_min(((float)(i % w) + (high + 0.5f) * 0x1p-12f) / (float)w, ONE_MINUS_ULP),
               f_min(((float)(i / w) + rest) / (float)h, ONE_MINUS_ULP) };
    *pdf = table2_pdf(&p->table, *q);
    return *pdf > 0.0f;
}

static bool place_sample(const Panorama *p, V2 u, V2 *q, float *pdf)
{
    switch (p->way) {
    case PANORAMA_CDF:       break;
    case PANORAMA_ALIAS:     return place_by_alias(p, u, q, pdf);
    case PANORAMA_MEDIANCUT: return mediancut_sample(&p->cut, u, true, q, pdf);
    case PANORAMA_FIXED:     return mediancut_sample(&p->cut, u, false, q, pdf);
    }
    return table2_sample(&p->table, u, q, pdf);
}

/* The direction of a place that was drawn with density pdf. */
static bool direction_of(const Panorama *p, V2 q, float pdf, V3 *d, float *pdf_w)
{
    float jacobian;

    *d = mapping_direction(&p->mapping, q, &jacobian);
    if (!(jacobian > 0.0f))
        return false;
    *pdf_w = pdf / jacobian;
    return *pdf_w > 0.0f;
}

/* Of PANORAMA_FIXED: the light of the region of a place, as radiance there. */
static Rgb region_light(const Panorama *p, V2 q)
{
    float jacobian;

    mapping_direction(&p->mapping, q, &jacobian);
    return rgb_scale(p->region[mediancut_find(&p->cut, q)], 1.0f / jacobian);
}

bool panorama_sample(const Panorama *p, V2 u, V3 *d, float *pdf_w, Rgb *value)
{
    float pdf;
    V2 q;

    if (!place_sample(p, u, &q, &pdf) || !direction_of(p, q, pdf, d, pdf_w))
        return false;
    *value = p->way == PANORAMA_FIXED ? region_light(p, q) : lookup(p, q);
    return true;
}

bool panorama_bright_sample(const Panorama *p, V2 u, V3 *d, float *pdf_w, Rgb *value)
{
    float pdf;
    V2 q;

    if (!table2_sample(&p->bright, u, &q, &pdf) || !direction_of(p, q, pdf, d, pdf_w))
        return false;
    *value = lookup(p, q);
    return true;
}

/* By points, at least 128 along each side: cells of small pictures hold several. */
double panorama_upward(const Panorama *p)
{
    uint32_t nx = 1 + 127 / width(p), ny = 1 + 127 / height(p);
    float w = (float)width(p) * (float)nx, h = (float)height(p) * (float)ny;
    double sum = 0.0;

    for (uint32_t y = 0; y < height(p) * ny; y++)
        for (uint32_t x = 0; x < width(p) * nx; x++) {
            V2 q = { ((float)x + 0.5f) / w, ((float)y + 0.5f) / h };
            float jacobian;
            V3 d = mapping_direction(&p->mapping, q, &jacobian);
            sum += (double)rgb_lum(cell(p, x / nx, y / ny)) * jacobian * d_max(0.0, d.z);
        }
    return sum / ((double)w * h);
}

float uniform_estimate(float lum, V3 n) { return (v_len2(n) > 0.0f ? PI_F : 4.0f * PI_F) * lum; }

float panorama_estimate(const Panorama *p, V3 n)
{
    float lum = rgb_lum(p->mean), flat = uniform_estimate(lum, n);
    return f_max(flat + 2.0f * PI_F * v_dot(p->moment, n), 0.05f * flat);
}

/* skymap.c -- a summed area table of the light from beyond the scene. See skymap.h. */
#include "lightsampling/skymap.h"

#include "base/mem.h"
#include "scene/panorama.h"

static const Mapping LATLONG = { MAPPING_LATLONG, 0, 0 };

/* ---- cells ---- */

/* Cells along a side of n pixels: as many, or a multiple, or by a divisor in whole pixels. */
static uint32_t cells_along(uint32_t n, uint32_t least, uint32_t most)
{
    if (n < least)
        return n * ((least + n - 1) / n);
    return n > most ? (n + (n - 1) / most) / (1 + (n - 1) / most) : n;
}

static float counted(const SkyMap *m, Rgb c)
{
    float x = m->measure == BY_LUMINANCE ? rgb_lum(c)
              : m->measure == BY_RED ? c.r : m->measure == BY_GREEN ? c.g : c.b;
    return x > 0.0f && is_finite(x) ? x : 0.0f;
}

/* Of all pixels that lie in the cell, if only in part: mean luminance. */
static float mean_of_pixels(const SkyMap *m, uint32_t x, uint32_t y)
{
    const Image *im = m->picture.image;
    uint64_t x0 = (uint64_t)x * im->w / m->w, y0 = (uint64_t)y * im->h / m->h;
    uint64_t x1 = ((uint64_t)(x + 1) * im->w + m->w - 1) / m->w;
    uint64_t y1 = ((uint64_t)(y + 1) * im->h + m->h - 1) / m->h;
    double sum = 0.0;

    for (uint64_t j = y0; j < y1; j++)
        for (uint64_t i = x0; i < x1; i++)
            sum += counted(m, rgb_mul(m->picture.L, *image_at(im, (uint32_t)i, (uint32_t)j)));
    return (float)(sum / (double)((x1 - x0) * (y1 - y0)));
}

static Rgb shown(const SkyMap *m, V3 wi)
{
    return m->picture.shows ? m->picture.shows(m->light, wi)
                            : m->light->kind->radiance(m->light, wi, NULL);
}

/* By points of the cell and its edges. What lies between them may be missed: see `spread`. Lamps
 * are looked up between their pixels: four of these across a cell do not escape. */
static float mean_of_points(const SkyMap *m, uint32_t x, uint32_t y)
{
    enum { SIDE = 3 };
    float jacobian, sum = 0.0f;

    for (int i = 0; i < SIDE * SIDE; i++) {
        V2 q = { ((float)x + (float)(i % SIDE) / (SIDE - 1)) / (float)m->w,
                 ((float)y + (float)(i / SIDE) / (SIDE - 1)) / (float)m->h };
        sum += counted(m, m->flat ? m->light->kind->places->shows(m->light, q)
                                  : shown(m, skymap_direction(m, q, &jacobian)));
    }
    return sum / (SIDE * SIDE);
}

/* Cells whose light is their pixels'. */
static bool by_pixels(const SkyMap *m)
{
    return !m->flat && m->picture.latlong && !m->picture.shows;
}

static float mean_of_cell(const SkyMap *m, uint32_t x, uint32_t y)
{
    if (!m->flat && !m->picture.image)
        return counted(m, m->picture.L);
    return by_pixels(m) ? mean_of_pixels(m, x, y) : mean_of_points(m, x, y);
}

/* Light times sine of each cell, added up from the top left; shares of the whole. */
static void fill(SkyMap *m)
{
    size_t n = (size_t)(m->h + 1) * (m->w + 1);
    double all;

    for (uint32_t y = 0; y < m->h; y++) {
        double sine = m->flat ? 1.0 : md_sin(PI * (y + 0.5) / m->h), in_row = 0.0;
        const double *above = m->sum + (size_t)y * (m->w + 1);
        double *row = m->sum + (size_t)(y + 1) * (m->w + 1);
        for (uint32_t x = 0; x < m->w; x++) {
            in_row += (double)mean_of_cell(m, x, y) * sine;
            row[x + 1] = above[x + 1] + in_row;
        }
    }
    all = m->sum[n - 1];
    m->light_in_all = all * (m->flat ? 1.0 : 2.0 * PI * PI) / ((double)m->w * m->h);
    for (size_t i = 0; all > 0.0 && i < n; i++)
        m->sum[i] /= all;
}

/* A hundredth of the samples goes to all directions, or places, alike, where cells were looked at
 * by points. */
static void spread(SkyMap *m)
{
    for (uint32_t y = 0; m->light_in_all > 0.0 && y <= m->h; y++)
        for (uint32_t x = 0; x <= m->w; x++) {
            double rows = m->flat ? (double)y / m->h : 0.5 * (1.0 - (double)m->row[y].y);
            double part = rows * x / m->w;
            double *sum = m->sum + (size_t)y * (m->w + 1) + x;
            *sum = 0.99 * *sum + 0.01 * part;
        }
}

static void fill_edges(SkyMap *m)
{
    float s, c;

    for (uint32_t x = 0; x <= m->w; x++) {              /* the last edge is the first, exactly */
        m_sincos_turn((float)(x % m->w) / (float)m->w, &s, &c);
        m->column[x] = (V2){ c, s };
    }
    for (uint32_t y = 0; y <= m->h; y++) {
        m_sincos_turn(0.5f * (float)y / (float)m->h, &s, &c);
        m->row[y] = (V2){ y == 0 || y == m->h ? 0.0f : s, c };
    }
}

/* The sums, of w x h cells. */
static bool take_sums(SkyMap *m)
{
    m->sum = mem_array((size_t)m->h + 1, ((size_t)m->w + 1) * sizeof *m->sum);
    return m->sum != NULL;
}

bool skymap_init(SkyMap *m, const Light *l, SkyMeasure by)
{
    const Image *im;

    memset(m, 0, sizeof *m);
    m->light = l;
    m->measure = by;
    m->picture = l->kind->picture(l);
    im = m->picture.image;
    m->w = cells_along(!im ? 1 : m->picture.latlong ? im->w : 2 * im->h, SKYMAP_NARROWEST,
                       SKYMAP_WIDEST);
    m->h = cells_along(im ? im->h : 1, SKYMAP_NARROWEST / 2, SKYMAP_WIDEST / 2);
    m->exact = !im || (by_pixels(m) && m->w % im->w == 0 && m->h % im->h == 0);
    m->column = MEM_ARRAY(V2, (size_t)m->w + 1);
    m->row = MEM_ARRAY(V2, (size_t)m->h + 1);
    if (!take_sums(m) || !m->column || !m->row) {
        skymap_clear(m);
        return false;
    }
    fill_edges(m);
    fill(m);
    if (im && !by_pixels(m))
        spread(m);
    return true;
}

/* Of a parallelogram: vectors whose products with a x + b y are x and y. */
static void dual_sides(const V3 side[2], V3 back[2])
{
    double aa = (double)v_len2(side[0]), bb = (double)v_len2(side[1]);
    double ab = (double)v_dot(side[0], side[1]), d = 1.0 / (aa * bb - ab * ab);

    back[0] = v_sub(v_scale(side[0], (float)(bb * d)), v_scale(side[1], (float)(ab * d)));
    back[1] = v_sub(v_scale(side[1], (float)(aa * d)), v_scale(side[0], (float)(ab * d)));
}

bool skymap_init_lamp(SkyMap *m, const Light *l, const LightRectangle *r, SkyMeasure by)
{
    memset(m, 0, sizeof *m);
    m->light = l;
    m->measure = by;
    m->flat = true;
    m->lamp = *r;
    dual_sides(r->side, m->back);
    m->w = cells_along(r->pixels[0], SKYMAP_NARROWEST / 2, SKYMAP_LAMP_WIDEST);
    m->h = cells_along(r->pixels[1], SKYMAP_NARROWEST / 2, SKYMAP_LAMP_WIDEST);
    if (!take_sums(m))
        return false;
    fill(m);
    spread(m);
    return true;
}

void skymap_clear(SkyMap *m)
{
    mem_free(m->sum);
    mem_free(m->column);
    mem_free(m->row);
    m->sum = NULL;
    m->column = m->row = NULL;
}

const Light *skymap_light(const Scene *s)
{
    const Light *best = NULL;
    float most = -1.0f;

    for (size_t i = 0; i < s->ninfinite; i++) {
        float power = rgb_lum(s->infinite[i]->kind->power(s->infinite[i]));
        if (s->infinite[i]->kind->picture && power > most) {
            most = power;
            best = s->infinite[i];
        }
    }
    return best;
}

/* ---- places and directions ---- */

V3 skymap_direction(const SkyMap *m, V2 place, float *jacobian)
{
    V3 d;

    if (m->flat) {
        *jacobian = 1.0f;
        return v_mad(m->lamp.side[0], place.x,
                     v_mad(m->lamp.side[1], place.y, m->lamp.corner));
    }
    d = mapping_direction(&LATLONG, place, jacobian);
    return affine_vector(&m->picture.to_world, d);
}

/* The same of n places, which go faster together. */
void skymap_directions(const SkyMap *m, const V2 *place, V3 *wi, float *jacobian, int n)
{
    enum { MOST = 16 };
    float turn[2 * MOST], s[2 * MOST], c[2 * MOST];

    for (int i = 0; m->flat && i < n; i++)
        wi[i] = skymap_direction(m, place[i], &jacobian[i]);
    if (m->flat)
        return;
    for (int first = 0, some; first < n; first += some) {
        some = n - first < MOST ? n - first : MOST;
        for (int i = 0; i < some; i++) {
            turn[i] = place[first + i].x;
            turn[some + i] = 0.5f * place[first + i].y;
        }
        m_sincos_turns(turn, s, c, 2 * some);
        for (int i = 0; i < some; i++) {
            float st = s[some + i];
            wi[first + i] = affine_vector(&m->picture.to_world,
                                          v3(st * c[i], st * s[i], c[some + i]));
            jacobian[first + i] = 2.0f * PI_F * PI_F * st;
        }
    }
}

V2 skymap_place(const SkyMap *m, V3 wi, float *jacobian)
{
    V3 d;

    if (m->flat) {
        d = v_sub(wi, m->lamp.corner);
        *jacobian = 1.0f;
        return (V2){ f_min(f_max(v_dot(d, m->back[0]), 0.0f), ONE_MINUS_ULP),
                     f_min(f_max(v_dot(d, m->back[1]), 0.0f), ONE_MINUS_ULP) };
    }
    return mapping_place(&LATLONG, affine_vector(&m->picture.to_light, wi), jacobian);
}

Rgb skymap_radiance(const SkyMap *m, V2 place, V3 wi)
{
    const Image *im = m->picture.image;

    if (!m->exact)
        return shown(m, wi);
    if (!im)
        return m->picture.L;
    return rgb_mul(m->picture.L, *image_at(im, (uint32_t)((double)place.x * im->w),
                                           (uint32_t)((double)place.y * im->h)));
}

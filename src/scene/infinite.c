/* infinite.c -- the light `infinite`: radiance from all directions, constant or by a picture in
 * latitude and longitude.
 *
 * Source      [Cline07 4.4.2, 5.2.1]; density: errata 5.1, d omega = 2 pi^2 sin(theta) du dv.
 * Mapping     z is up; u = phi / 2 pi runs with phi = atan2(y, x), v = theta / pi from the top row.
 * Sampling    Cells of the picture in proportion to luminance times sin(theta); constant skies
 *             uniformly over the sphere. The picture is looked up by cell, not between cells: so
 *             the density is above 0 wherever the radiance is, see errata 5.3. */
#include "sampling/table.h"
#include "sampling/warp.h"
#include "scene/scene.h"

#include <string.h>

typedef struct {
    Light  base;
    Rgb    L;                   /* factor of the picture, or the constant */
    const Image *image;         /* borrowed from the scene, or &own; NULL: constant */
    Image  own;                 /* owned */
    Table2 table;               /* owned */
    Affine to_light;            /* directions of the world in the light's frame */
    Affine to_world;
    float  radius;              /* of the scene */
    Rgb    mean;                /* radiance over the sphere */
} Infinite;

static Infinite *make_any(const Making *m, Rgb L)
{
    Infinite *l = arena_take(&m->scene->arena, 1, sizeof *l);
    double scale;

    if (!l)
        return NULL;
    l->L = l->mean = L;
    if (!xf_is_similarity(&m->to_world, &scale)) {
        err_at(m->at, "an infinite light's transform must be a rotation");
        return NULL;
    }
    l->to_world = xf_affine(&m->to_world);
    for (int i = 0; i < 3; i++)                         /* take the scale factor out */
        for (int j = 0; j < 3; j++) {
            l->to_world.m[i][j] = (float)(m->to_world.m[i][j] / scale);
            l->to_light.m[j][i] = l->to_world.m[i][j];
        }
    return l;
}

static Light *make(const Making *m, const Opts *o)
{
    const char *name = opt_string(o, "filename");
    Infinite *l = make_any(m, rgb_mul(opt_rgb(o, "L"), opt_rgb(o, "scale")));

    if (!l)
        return NULL;
    if (name[0]) {
        l->image = scene_image(m->scene, m, name);
        if (!l->image)
            return NULL;
    }
    return &l->base;
}

/* Weights of the table: luminance times the sine at the middle of the row, and the mean. */
static bool prepare_picture(Infinite *l)
{
    const Image *im = l->image;
    float *weight = MEM_ARRAY(float, (size_t)im->w * im->h);
    double sum[3] = { 0, 0, 0 }, all = 0;
    bool ok;

    if (!weight)
        return false;
    for (uint32_t y = 0; y < im->h; y++) {
        double sine = md_sin(PI * (y + 0.5) / im->h);
        for (uint32_t x = 0; x < im->w; x++) {
            Rgb c = *image_at(im, x, y);
            weight[(size_t)y * im->w + x] = (float)(rgb_lum(c) * sine);
            sum[0] += c.r * sine;
            sum[1] += c.g * sine;
            sum[2] += c.b * sine;
            all += sine;
        }
    }
    l->mean = rgb_mul(l->L, rgb((float)(sum[0] / all), (float)(sum[1] / all),
                                (float)(sum[2] / all)));
    ok = table2_init(&l->table, weight, im->w, im->h);
    mem_free(weight);
    return ok;
}

static bool prepare(Light *base, const Scene *s)
{
    Infinite *l = (Infinite *)base;
    l->radius = s->radius;
    return !l->image || prepare_picture(l);
}

static void clear(Light *base)
{
    Infinite *l = (Infinite *)base;
    table2_clear(&l->table);
    image_clear(&l->own);
}

static Rgb lookup(const Infinite *l, V2 p)
{
    uint32_t x = (uint32_t)(p.x * (float)l->image->w), y = (uint32_t)(p.y * (float)l->image->h);
    if (x >= l->image->w)
        x = l->image->w - 1;
    if (y >= l->image->h)
        y = l->image->h - 1;
    return rgb_mul(l->L, *image_at(l->image, x, y));
}

/* Place in the picture of a unit direction of the light's frame, and the sine of its angle to z. */
static V2 place_of(V3 w, float *sine)
{
    float phi = m_atan2(w.y, w.x);
    *sine = sqrtf(w.x * w.x + w.y * w.y);
    return (V2){ f_min((phi < 0.0f ? phi + 2.0f * PI_F : phi) * (0.5f * INV_PI), ONE_MINUS_ULP),
                 f_min(m_atan2(*sine, w.z) * INV_PI, ONE_MINUS_ULP) };
}

static bool sample(const Light *base, V3 from, V2 u, LightSample *s)
{
    const Infinite *l = (const Infinite *)base;
    float pdf, sn, cs, st, ct;
    V2 p;

    (void)from;
    s->dist = INFINITY;
    s->p = s->err = s->n = v_all(0.0f);
    if (!l->image) {
        s->wi = warp_sphere(u);
        s->pdf_w = warp_sphere_pdf();
        s->L = l->L;
        return true;
    }
    if (!table2_sample(&l->table, u, &p, &pdf))
        return false;
    m_sincos_turn(p.x, &sn, &cs);
    m_sincos_turn(0.5f * p.y, &st, &ct);
    if (!(st > 0.0f))
        return false;
    s->wi = v_unit(affine_vector(&l->to_world, v3(st * cs, st * sn, ct)));
    s->pdf_w = pdf / (2.0f * PI_F * PI_F * st);
    s->L = lookup(l, p);
    return s->pdf_w > 0.0f;
}

static float pdf_w(const Light *base, V3 from, V3 wi, const Surface *hit)
{
    const Infinite *l = (const Infinite *)base;
    float sine;
    V2 p;

    (void)from;
    (void)hit;
    if (!l->image)
        return warp_sphere_pdf();
    p = place_of(affine_vector(&l->to_light, wi), &sine);
    return sine > 0.0f ? table2_pdf(&l->table, p) / (2.0f * PI_F * PI_F * sine) : 0.0f;
}

static Rgb radiance(const Light *base, V3 wi, const Surface *hit)
{
    const Infinite *l = (const Infinite *)base;
    float sine;

    (void)hit;
    return l->image ? lookup(l, place_of(affine_vector(&l->to_light, wi), &sine)) : l->L;
}

/* What passes through the disc that the scene's sphere shows, from all directions. */
static Rgb power(const Light *base)
{
    const Infinite *l = (const Infinite *)base;
    return rgb_scale(l->mean, 4.0f * PI_F * PI_F * l->radius * l->radius);
}

/* ---- the sky of a bare mesh ---- */

enum { STUDIO_W = 512, STUDIO_H = 256 };        /* fine enough that no steps show */

/* A smooth background that brightens upwards, and a broad key light behind the eye to the left,
 * whose lobe is cos^24: about 20 degrees to half. The sum lights a facing white surface to about
 * 1, of which the key gives two thirds, so that shapes read. */
static Rgb studio_radiance(V3 w)
{
    V3 key = v_unit(v3(-0.7f, -0.6f, 0.6f));
    float c = f_max(0.0f, v_dot(w, key)), up = 0.5f + 0.5f * w.z;
    float lobe = f_sqr(f_sqr(f_sqr(c)));                /* c^8 */
    Rgb sky = rgb_add(rgb_scale(rgb(0.36f, 0.42f, 0.50f), up * up),
                      rgb_scale(rgb(0.10f, 0.10f, 0.10f), 1.0f - up));
    return rgb_add(sky, rgb_scale(rgb(1.0f, 0.94f, 0.84f), 8.0f * lobe * lobe * lobe));
}

Light *light_studio(const Making *m)
{
    Infinite *l = make_any(m, rgb_all(1.0f));

    if (!l || !image_init(&l->own, STUDIO_W, STUDIO_H))
        return NULL;
    for (uint32_t y = 0; y < STUDIO_H; y++)
        for (uint32_t x = 0; x < STUDIO_W; x++) {
            float sn, cs, st, ct;
            m_sincos_turn(((float)x + 0.5f) / STUDIO_W, &sn, &cs);
            m_sincos_turn(((float)y + 0.5f) / (2 * STUDIO_H), &st, &ct);
            *image_at(&l->own, x, y) = studio_radiance(v3(st * cs, st * sn, ct));
        }
    l->image = &l->own;
    return &l->base;
}

static const OptDef options[] = {
    { .key = "L", .type = OPT_RGB, .num = 1, .help = "radiance, or a factor of the picture" },
    { .key = "scale", .type = OPT_RGB, .num = 1, .help = "factor of L" },
    { .key = "filename", .type = OPT_STRING, .str = "", .also = "mapname",
      .help = "picture in latitude and longitude, z up (PFM, HDR, ...)" },
    { .key = "samples", .type = OPT_INT, .num = 1, .lo = 1, .hi = 1e9, .also = "nsamples",
      .help = "read for old scene files, without effect" },
    { .key = NULL }
};

const LightKind light_infinite = {
    .info = { "infinite", "Cline07 4.4.2", "the sky: constant, or a picture", options },
    .infinite = true, .make = make, .prepare = prepare, .clear = clear, .sample = sample,
    .pdf_w = pdf_w, .radiance = radiance, .power = power
};

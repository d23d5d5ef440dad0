/* infinite.c -- the light `infinite`: radiance from all directions, constant or by a picture of
 * them.
 *
 * Source      [Cline07 4.4.2, 5.2.1], [Karlik19]; mappings of pictures: panorama.h.
 * Sampling    Cells of the picture in proportion to luminance times solid angle, by inverting its
 *             sums or by the alias method [Cline07 4.4.2]; or regions of like light [Debevec05],
 *             and a place in each. Without jitter that place is the region's middle and stands for
 *             all of it: shadows have as many edges as there are regions, and the picture is
 *             biased. Constant skies uniformly over the sphere.
 * Beside      directions by the surface: cells by what rises above an even level, see panorama.h
 *             and [Karlik19]. Only where sums are inverted. */
#include "sampling/warp.h"
#include "scene/panorama.h"

typedef struct {
    Beyond beyond;
    Rgb    L;                   /* factor of the picture, or the constant */
    const Image *image;         /* borrowed from the scene, or &own; NULL: constant */
    Image  own;                 /* owned */
    Mapping mapping;
    Panorama picture;           /* owned */
    Affine to_light;            /* directions of the world in the light's frame */
    Affine to_world;
    PanoramaWay way;
    int    cuts;                /* of median cut: 2^cuts regions */
    float  illuminance;         /* wanted on a surface that faces z; 0: L is as given */
    Rgb    mean;                /* radiance over the sphere */
} Infinite;

static Infinite *make_any(const Making *m, Rgb L)
{
    Infinite *l = arena_take(&m->scene->arena, 1, sizeof *l);

    if (!l || !frame_of_light(m, "an infinite light's", &l->to_world, &l->to_light))
        return NULL;
    l->L = l->mean = L;
    return l;
}

static Light *make(const Making *m, const Opts *o)
{
    const char *name = opt_string(o, "filename");
    Infinite *l = make_any(m, rgb_mul(opt_rgb(o, "L"), opt_rgb(o, "scale")));

    if (!l)
        return NULL;
    if (opt_param(o, "portal") &&
        !warn_at(opt_param(o, "portal")->at, "a portal is left out: the light is the same, with "
                 "more noise"))
        return NULL;
    l->illuminance = opt_float(o, "illuminance");
    l->way = opt_is(o, "sampling", "cdf") ? PANORAMA_CDF
             : opt_is(o, "sampling", "alias") ? PANORAMA_ALIAS
             : opt_bool(o, "jitter") ? PANORAMA_MEDIANCUT : PANORAMA_FIXED;
    while (1 << l->cuts < opt_int(o, "lights"))
        l->cuts++;
    if (l->way == PANORAMA_FIXED && name[0] &&
        !warn_at(m->at, "%d fixed lights stand for the sky: the picture is biased", 1 << l->cuts))
        return NULL;
    if (name[0]) {
        l->image = scene_image(m->scene, m, name);
        if (!l->image)
            return NULL;
        l->mapping = mapping_option(o, l->image);
    }
    return &l->beyond.base;
}

static bool prepare(Light *base, const Scene *s)
{
    Infinite *l = (Infinite *)base;
    double up = PI;

    l->beyond.stage = stage_of(s);
    if (l->image && (!panorama_init(&l->picture, l->image, l->mapping) ||
                     !panorama_set_way(&l->picture, l->way, l->cuts) ||
                     (l->way == PANORAMA_CDF && !panorama_set_bright(&l->picture, 0.0, 0.0, NULL))))
        return false;
    if (l->image && l->illuminance > 0.0f)
        up = panorama_upward(&l->picture);
    l->L = rgb_scale(l->L, power_factor(l->illuminance, rgb_scale(l->L, (float)up)));
    l->mean = l->image ? rgb_mul(l->L, l->picture.mean) : l->L;
    return true;
}

static void clear(Light *base)
{
    Infinite *l = (Infinite *)base;
    panorama_clear(&l->picture);
    image_clear(&l->own);
}

/* A direction towards the light, its density and the radiance from there. */
static bool draw(const Infinite *l, bool bright, V2 u, V3 *wi, float *pdf, Rgb *L)
{
    Rgb value;
    V3 d;

    *L = l->L;
    if (!l->image) {
        *wi = warp_sphere(u);
        *pdf = warp_sphere_pdf();
        return true;
    }
    if (!(bright ? panorama_bright_sample(&l->picture, u, &d, pdf, &value)
                 : panorama_sample(&l->picture, u, &d, pdf, &value)))
        return false;
    *wi = v_unit(affine_vector(&l->to_world, d));
    *L = rgb_mul(l->L, value);
    return true;
}

static bool sample(const Light *base, V3 from, V2 u, LightSample *s)
{
    (void)from;
    sample_beyond(s);
    return draw((const Infinite *)base, false, u, &s->wi, &s->pdf_w, &s->L);
}

static float pdf_w(const Light *base, V3 from, V3 wi, const Surface *hit)
{
    const Infinite *l = (const Infinite *)base;

    (void)from;
    (void)hit;
    return l->image ? panorama_pdf_w(&l->picture, affine_vector(&l->to_light, wi))
                    : warp_sphere_pdf();
}

/* Pictures that are sampled by cells have a table of their bright parts. */
static bool has_bright(const Infinite *l) { return l->image && l->way == PANORAMA_CDF; }

static bool sample_beside(const Light *base, V3 from, V2 u, LightSample *s)
{
    const Infinite *l = (const Infinite *)base;

    (void)from;
    sample_beyond(s);
    return draw(l, has_bright(l), u, &s->wi, &s->pdf_w, &s->L);
}

static float pdf_beside(const Light *base, V3 from, V3 wi, const Surface *hit)
{
    const Infinite *l = (const Infinite *)base;

    return has_bright(l) ? panorama_bright_pdf_w(&l->picture, affine_vector(&l->to_light, wi))
                         : pdf_w(base, from, wi, hit);
}

static bool numbers(const Light *base, bool beside, V3 wi, V2 *u)
{
    const Infinite *l = (const Infinite *)base;

    if (!has_bright(l))
        return false;
    if (u)
        *u = panorama_numbers(&l->picture, beside, affine_vector(&l->to_light, wi));
    return true;
}

static Rgb radiance(const Light *base, V3 wi, const Surface *hit)
{
    const Infinite *l = (const Infinite *)base;

    (void)hit;
    if (!l->image)
        return l->L;
    return rgb_mul(l->L, panorama_at(&l->picture, affine_vector(&l->to_light, wi)));
}

/* What passes through the disc that the scene's sphere shows, from all directions. */
static Rgb power(const Light *base)
{
    const Infinite *l = (const Infinite *)base;
    float radius = l->beyond.stage.radius;
    return rgb_scale(l->mean, 4.0f * PI_F * PI_F * radius * radius);
}

static float estimate(const Light *base, V3 p, V3 n)
{
    const Infinite *l = (const Infinite *)base;

    (void)p;
    if (!l->image)
        return uniform_estimate(rgb_lum(l->L), n);
    return rgb_lum(l->L) * panorama_estimate(&l->picture, affine_vector(&l->to_light, n));
}

static LightPicture picture(const Light *base)
{
    const Infinite *l = (const Infinite *)base;
    return (LightPicture){ l->image, l->mapping.kind == MAPPING_LATLONG, l->L, l->to_light,
                           l->to_world, NULL, NULL };
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
    return &l->beyond.base;
}

static const OptDef options[] = {
    { .key = "L", .type = OPT_RGB, .num = 1, .help = "radiance, or a factor of the picture" },
    { .key = "scale", .type = OPT_RGB, .num = 1, .help = "factor of L" },
    { .key = "filename", .type = OPT_STRING, .str = "", .also = "mapname",
      .help = "picture of all directions (PFM, HDR, ...)" },
    MAPPING_OPTION("where directions are; auto: octahedral if square, but mapname is latlong"),
    { .key = "illuminance", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 1e30,
      .help = "luminance of the irradiance on a surface that faces z; sets L if above 0" },
    { .key = "sampling", .type = OPT_CHOICE, .str = "cdf", .choices = "cdf alias mediancut",
      .help = "of a picture: by inverting sums, by the alias method, by regions of like light" },
    { .key = "lights", .type = OPT_INT, .num = 64, .lo = 1, .hi = 1 << CUTS_MOST,
      .help = "mediancut: regions, rounded up to a power of two" },
    { .key = "jitter", .type = OPT_BOOL, .num = 1,
      .help = "mediancut: anywhere in a region; false: in its middle, fixed, without noise but "
              "biased: 64 lights by 1.5 % in the pixels of a floor, 16 by 5.5 %" },
    { .key = "portal", .type = OPT_NUMBERS, .help = "left out: the light is the same without it" },
    { .key = "samples", .type = OPT_INT, .num = 1, .lo = 1, .hi = 1e9, .also = "nsamples",
      .help = "read for old scene files, without effect" },
    { .key = NULL }
};

const LightKind light_infinite = {
    .info = { "infinite", "Cline07 4.4.2; Karlik19; Clarberg08; Debevec98",
              "all round: constant, or a picture", options },
    .infinite = true, .make = make, .prepare = prepare, .clear = clear, .sample = sample,
    .pdf_w = pdf_w, .sample_beside = sample_beside, .pdf_beside = pdf_beside,
    .numbers = numbers,
    .radiance = radiance, .emit = beyond_emit, .emit_pdf = beyond_emit_pdf,
    .power = power, .estimate = estimate, .picture = picture
};

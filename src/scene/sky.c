/* sky.c -- the light `sky`: a clear sky with its sun, and the ground below the horizon.
 *
 * Source      [Preetham99]: the sky's luminance and chromaticity are Perez' five numbers and the
 *             zenith's values, both polynomials in turbidity and the sun's angle (appendix A.2);
 *             the sun's light is what Rayleigh scattering, haze and ozone leave (appendix A.1),
 *             through an air mass by [Kasten66].
 * Units       kcd/m^2, and klx on surfaces. A white surface in full sun gets about 30.
 * Frame       z is up; below the horizon is a ground of the given albedo, lit by sky and sun.
 * Departs     The sun's three channels are each computed at one wavelength (620, 548 and 453 nm),
 *             from 128 klx of a black body of 5778 K outside the atmosphere: its luminance is
 *             within 2 % of the sum over the spectrum where the sun is 5 degrees high or more, red
 *             and green within 9 %. Water and mixed gases take nothing that is seen. The sun is a
 *             uniform disc without a corona of its own: the sky's model has that.
 * Sampling    The sun's cone, or a picture of sky and ground by luminance, as their light falls
 *             upon a sphere. The density is that of both together, wherever a direction comes
 *             from. Radiance is computed, not looked up: no cell shows. Beside directions by the
 *             surface, what rises above an even level counts, see panorama.h and [Karlik19].
 * In parts    Methods that go by a picture get that of sky and ground, and the sun as a light. */
#include "sampling/warp.h"
#include "scene/panorama.h"

enum { CELLS_X = 128, CELLS_Y = 64 };           /* rows end at the horizon */

/* Perez' distribution F = (1 + A e^(B / cos theta)) (1 + C e^(D gamma) + E cos^2 gamma), for the
 * luminance Y and the chromaticities x and y: its numbers are linear in turbidity. */
static const double PEREZ[3][5][2] = {
    { { 0.1787, -1.4630 }, { -0.3554, 0.4275 }, { -0.0227, 5.3251 }, { 0.1206, -2.5771 },
      { -0.0670, 0.3703 } },
    { { -0.0193, -0.2592 }, { -0.0665, 0.0008 }, { -0.0004, 0.2125 }, { -0.0641, -0.8989 },
      { -0.0033, 0.0452 } },
    { { -0.0167, -0.2608 }, { -0.0950, 0.0092 }, { -0.0079, 0.2102 }, { -0.0441, -1.6537 },
      { -0.0109, 0.0529 } }
};
/* Chromaticity of the zenith: rows by T^2, T, 1, columns by theta^3, theta^2, theta, 1. */
static const double ZENITH[2][3][4] = {
    { { 0.00166, -0.00375, 0.00209, 0 }, { -0.02903, 0.06377, -0.03202, 0.00394 },
      { 0.11693, -0.21196, 0.06052, 0.25886 } },
    { { 0.00275, -0.00610, 0.00317, 0 }, { -0.04214, 0.08970, -0.04153, 0.00516 },
      { 0.15346, -0.26756, 0.06670, 0.26688 } }
};

typedef struct Sun Sun;

typedef struct {
    Beyond beyond;
    Affine to_light, to_world;
    V3     sun;                 /* unit, in the light's frame */
    float  perez[3][5];         /* Y, x, y */
    float  zenith[3];           /* over F at the zenith; Y in kcd/m^2 */
    Rgb    sky_scale;
    Rgb    sun_L;               /* radiance of the disc */
    float  height;              /* 1 - cos of its half angle */
    Rgb    ground;              /* radiance from below */
    float  sun_share;           /* of the samples, */
    float  bright_share;        /* and of those of what rises above an even level */
    Sun   *alone;               /* in the arena; NULL: there is none */
    Image  own;                 /* owned: sky and ground by cell */
    Panorama cells;             /* owned */
} Sky;

struct Sun { Light base; const Sky *sky; };     /* without its sky */

/* ---- Preetham's sky ---- */

static float perez(const float a[5], float c, float gamma, float cos2)
{
    return (1.0f + a[0] * m_exp(a[1] / c)) * (1.0f + a[2] * m_exp(a[3] * gamma) + a[4] * cos2);
}

/* theta: of the sun, from the zenith. */
static void set_sky(Sky *l, double theta, double turbidity)
{
    double t = turbidity, chi = (4.0 / 9.0 - t / 120.0) * (PI - 2.0 * theta);
    double powers[4] = { theta * theta * theta, theta * theta, theta, 1.0 };
    double ts[3] = { t * t, t, 1.0 };

    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 5; i++)
            l->perez[k][i] = (float)(PEREZ[k][i][0] * t + PEREZ[k][i][1]);
    l->zenith[0] = (float)((4.0453 * t - 4.9710) * (md_sin(chi) / md_cos(chi)) - 0.2155 * t +
                           2.4192);
    for (int k = 0; k < 2; k++) {
        double sum = 0.0;
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 4; j++)
                sum += ts[i] * ZENITH[k][i][j] * powers[j];
        l->zenith[1 + k] = (float)sum;
    }
    for (int k = 0; k < 3; k++)
        l->zenith[k] /= perez(l->perez[k], 1.0f, (float)theta, f_sqr((float)md_cos(theta)));
}

/* IEC 61966-2-1: XYZ to linear RGB. What the primaries cannot show becomes 0. */
static Rgb rgb_of(float Y, float x, float y)
{
    float s = Y / f_max(y, 0.01f), X = x * s, Z = (1.0f - x - y) * s;
    return rgb(f_max(0.0f, 3.2406f * X - 1.5372f * Y - 0.4986f * Z),
               f_max(0.0f, -0.9689f * X + 1.8758f * Y + 0.0415f * Z),
               f_max(0.0f, 0.0557f * X - 0.2040f * Y + 1.0570f * Z));
}

/* Of sky and ground in direction d of the light's frame. */
static Rgb background(const Sky *l, V3 d)
{
    float c = v_dot(d, l->sun), gamma = m_acos(c), cos2 = c * c, v[3];

    if (d.z < 0.0f)
        return l->ground;
    for (int k = 0; k < 3; k++)
        v[k] = l->zenith[k] * perez(l->perez[k], d.z, gamma, cos2);
    return rgb_mul(l->sky_scale, rgb_of(f_max(0.0f, v[0]), v[1], v[2]));
}

/* ---- the sun ---- */

/* Illuminance on a surface that faces the sun, in klx. Wavelengths in micrometres; ozone: its
 * absorption there, per cm, in a layer of 0.35 cm. */
static Rgb sun_light(double theta, double turbidity)
{
    static const double outside[3] = { 1.1077, 0.9768, 0.9126 };        /* luminance 1 */
    static const double wave[3] = { 0.620, 0.548, 0.453 }, ozone[3] = { 0.105, 0.083, 0.0036 };
    double mass = 1.0 / (md_cos(theta) + 0.15 * md_pow(93.885 - theta * 180.0 / PI, -1.253));
    double haze = 0.04608 * turbidity - 0.04586, v[3];

    for (int k = 0; k < 3; k++)
        v[k] = 128.0 * outside[k] *
               md_exp(-mass * (0.008735 * md_pow(wave[k], -4.08) +
                               haze * md_pow(wave[k], -1.3) + 0.35 * ozone[k]));
    return rgb((float)v[0], (float)v[1], (float)v[2]);
}

/* Half the squared distance of unit vectors is 1 - cos, without the rounding of 1. */
static bool in_sun(const Sky *l, V3 d) { return 0.5f * v_len2(v_sub(d, l->sun)) <= l->height; }

static Rgb light_from(const Sky *l, V3 d)
{
    Rgb L = background(l, d);
    return in_sun(l, d) ? rgb_add(L, l->sun_L) : L;
}

/* ---- making it ---- */

static const Mapping latlong = { MAPPING_LATLONG, 0, 0 };

static V3 cell_direction(uint32_t x, uint32_t y)
{
    V2 p = { ((float)x + 0.5f) / CELLS_X, ((float)y + 0.5f) / CELLS_Y };
    float jacobian;
    return mapping_direction(&latlong, p, &jacobian);
}

/* The upper half of the picture, and what of it falls on the ground. */
static Rgb draw_sky(Sky *l)
{
    Rgb E = rgb_all(0.0f);

    for (uint32_t y = 0; y < CELLS_Y / 2; y++)
        for (uint32_t x = 0; x < CELLS_X; x++) {
            V3 d = cell_direction(x, y);
            float sine = sqrtf(f_max(0.0f, 1.0f - d.z * d.z));
            Rgb L = *image_at(&l->own, x, y) = background(l, d);
            E = rgb_add(E, rgb_scale(L, d.z * sine));
        }
    return rgb_scale(E, 2.0f * PI_F * PI_F / (CELLS_X * CELLS_Y));
}

static bool draw_cells(Sky *l, Rgb albedo)
{
    float turn = 2.0f * PI_F * l->height;       /* the sun's solid angle */
    float sun = rgb_lum(l->sun_L) * turn, rest;

    if (!image_init(&l->own, CELLS_X, CELLS_Y))
        return false;
    l->ground = rgb_add(draw_sky(l), rgb_scale(l->sun_L, turn * l->sun.z));
    l->ground = rgb_scale(rgb_mul(albedo, l->ground), INV_PI);
    for (uint32_t y = CELLS_Y / 2; y < CELLS_Y; y++)
        for (uint32_t x = 0; x < CELLS_X; x++)
            *image_at(&l->own, x, y) = l->ground;
    if (!panorama_init(&l->cells, &l->own, latlong) ||
        !panorama_set_bright(&l->cells, rgb_lum(l->sun_L), turn, &l->bright_share)) {
        panorama_clear(&l->cells);
        image_clear(&l->own);
        return false;
    }
    rest = rgb_lum(l->cells.mean) * 4.0f * PI_F;
    l->sun_share = sun > 0.0f ? sun / (sun + rest) : 0.0f;
    return true;
}

static bool make_alone(Sky *l, const Making *m);

static Light *make(const Making *m, const Opts *o)
{
    Sky *l = arena_take(&m->scene->arena, 1, sizeof *l);
    double theta, turbidity = opt_float(o, "turbidity"), sine;
    float half = opt_float(o, "sunsize") * (0.5f * PI_F / 180.0f);
    Rgb scale = opt_rgb(o, "scale");

    if (!l || !frame_of_light(m, "a sky's", &l->to_world, &l->to_light))
        return NULL;
    l->sun = v_unit(opt_point(o, "sundirection"));
    if (!(l->sun.z > 0.0f)) {
        err_at(m->at, "the sun is not above the horizon; expected a \"sundirection\" with z > 0");
        return NULL;
    }
    theta = md_atan2(sqrt((double)l->sun.x * l->sun.x + (double)l->sun.y * l->sun.y), l->sun.z);
    set_sky(l, theta, turbidity);
    sine = md_sin(0.5 * half);
    l->height = (float)(2.0 * sine * sine);
    l->sky_scale = rgb_scale(scale, opt_float(o, "skyscale"));
    l->sun_L = rgb_scale(rgb_mul(scale, sun_light(theta, turbidity)), opt_float(o, "sunscale"));
    /* the disc's irradiance is L pi sin^2: the same sun for every size */
    l->sun_L = rgb_scale(l->sun_L, 1.0f / (PI_F * l->height * (2.0f - l->height)));
    return make_alone(l, m) && draw_cells(l, opt_rgb(o, "albedo")) ? &l->beyond.base : NULL;
}

static bool prepare(Light *base, const Scene *s)
{
    Sky *l = (Sky *)base;

    l->beyond.stage = stage_of(s);
    if (l->alone)
        l->alone->base.index = base->index;
    return true;
}

static void clear(Light *base)
{
    Sky *l = (Sky *)base;
    panorama_clear(&l->cells);
    image_clear(&l->own);
}

/* ---- as a light ---- */

static float share_of_sun(const Sky *l, bool bright)
{
    return bright ? l->bright_share : l->sun_share;
}

/* Density of `draw` at direction d of the light's frame. */
static float density(const Sky *l, bool bright, V3 d)
{
    float share = share_of_sun(l, bright);
    float pdf = (1.0f - share) * (bright ? panorama_bright_pdf_w(&l->cells, d)
                                         : panorama_pdf_w(&l->cells, d));
    return in_sun(l, d) ? pdf + share * warp_cone_pdf(l->height) : pdf;
}

/* A direction of the world towards the light; bright: by what rises above an even level. */
static bool draw(const Sky *l, bool bright, V2 u, V3 *wi, float *pdf, Rgb *L)
{
    float share = share_of_sun(l, bright);
    Frame axis;
    Rgb value;
    V3 d;

    if (u.x < share) {
        u.x = f_min(u.x / share, ONE_MINUS_ULP);
        axis = frame_about(l->sun);
        d = v_unit(frame_out(&axis, warp_cone(u, l->height)));
    } else {
        u.x = f_min((u.x - share) / (1.0f - share), ONE_MINUS_ULP);
        if (!(bright ? panorama_bright_sample(&l->cells, u, &d, pdf, &value)
                     : panorama_sample(&l->cells, u, &d, pdf, &value)))
            return false;
    }
    *wi = v_unit(affine_vector(&l->to_world, d));
    *pdf = density(l, bright, d);
    *L = light_from(l, d);
    return *pdf > 0.0f && !rgb_black(*L);
}

static bool sample_by(const Light *base, bool bright, V2 u, LightSample *s)
{
    sample_beyond(s);
    return draw((const Sky *)base, bright, u, &s->wi, &s->pdf_w, &s->L);
}

static bool sample(const Light *base, V3 from, V2 u, LightSample *s)
{
    (void)from;
    return sample_by(base, false, u, s);
}

static bool sample_beside(const Light *base, V3 from, V2 u, LightSample *s)
{
    (void)from;
    return sample_by(base, true, u, s);
}

static float pdf_by(const Light *base, bool bright, V3 wi)
{
    const Sky *l = (const Sky *)base;
    return density(l, bright, v_unit(affine_vector(&l->to_light, wi)));
}

static float pdf_w(const Light *base, V3 from, V3 wi, const Surface *hit)
{
    (void)from;
    (void)hit;
    return pdf_by(base, false, wi);
}

static float pdf_beside(const Light *base, V3 from, V3 wi, const Surface *hit)
{
    (void)from;
    (void)hit;
    return pdf_by(base, true, wi);
}

static Rgb radiance(const Light *base, V3 wi, const Surface *hit)
{
    const Sky *l = (const Sky *)base;

    (void)hit;
    return light_from(l, v_unit(affine_vector(&l->to_light, wi)));
}

static Rgb power(const Light *base)
{
    const Sky *l = (const Sky *)base;
    Rgb all = rgb_add(rgb_scale(l->cells.mean, 4.0f * PI_F),
                      rgb_scale(l->sun_L, 2.0f * PI_F * l->height));
    return rgb_scale(all, 1.0f / stage_pdf_a(&l->beyond.stage));
}

/* up: in the light's frame. */
static float estimate_of_sun(const Sky *l, V3 up)
{
    float sine = sqrtf(l->height * (2.0f - l->height));
    return rgb_lum(l->sun_L) * 2.0f * PI_F * l->height * estimate_cosine(up, l->sun, sine);
}

static float estimate(const Light *base, V3 p, V3 n)
{
    const Sky *l = (const Sky *)base;
    V3 up = affine_vector(&l->to_light, n);

    (void)p;
    return panorama_estimate(&l->cells, up) + estimate_of_sun(l, up);
}

/* ---- in parts ---- */

static bool sun_sample(const Light *base, V3 from, V2 u, LightSample *s)
{
    const Sky *l = ((const Sun *)base)->sky;
    Frame axis = frame_about(l->sun);

    (void)from;
    sample_beyond(s);
    s->wi = v_unit(affine_vector(&l->to_world, frame_out(&axis, warp_cone(u, l->height))));
    s->pdf_w = warp_cone_pdf(l->height);
    s->L = l->sun_L;
    return true;
}

static Rgb sun_radiance(const Light *base, V3 wi, const Surface *hit)
{
    const Sky *l = ((const Sun *)base)->sky;

    (void)hit;
    return in_sun(l, v_unit(affine_vector(&l->to_light, wi))) ? l->sun_L : rgb_all(0.0f);
}

static float sun_pdf_w(const Light *base, V3 from, V3 wi, const Surface *hit)
{
    (void)from;
    return rgb_black(sun_radiance(base, wi, hit)) ? 0.0f
                                                  : warp_cone_pdf(((const Sun *)base)->sky->height);
}

static Rgb sun_power(const Light *base)
{
    const Sky *l = ((const Sun *)base)->sky;
    return rgb_scale(l->sun_L, 2.0f * PI_F * l->height / stage_pdf_a(&l->beyond.stage));
}

static float sun_estimate(const Light *base, V3 p, V3 n)
{
    const Sky *l = ((const Sun *)base)->sky;

    (void)p;
    return estimate_of_sun(l, affine_vector(&l->to_light, n));
}

/* In no list: direct light alone meets it, and asks it for no more. */
static const LightKind sun_kind = {
    .info = { "sun", "Preetham99", "the sun of a sky", NULL },
    .infinite = true, .sample = sun_sample, .pdf_w = sun_pdf_w, .radiance = sun_radiance,
    .power = sun_power, .estimate = sun_estimate
};

static bool make_alone(Sky *l, const Making *m)
{
    if (rgb_black(l->sun_L))
        return true;
    l->alone = arena_take(&m->scene->arena, 1, sizeof *l->alone);
    if (!l->alone)
        return false;
    l->alone->base.kind = &sun_kind;
    l->alone->sky = l;
    return true;
}

static Rgb without_sun(const Light *base, V3 wi)
{
    const Sky *l = (const Sky *)base;
    return background(l, v_unit(affine_vector(&l->to_light, wi)));
}

static LightPicture picture(const Light *base)
{
    const Sky *l = (const Sky *)base;
    return (LightPicture){ &l->own, true, { 1, 1, 1 }, l->to_light, l->to_world, without_sun,
                           l->alone ? &l->alone->base : NULL };
}

static const OptDef options[] = {
    { .key = "sundirection", .type = OPT_POINT, .str = "0 -1 1", .help = "to the sun; z is up" },
    { .key = "turbidity", .type = OPT_FLOAT, .num = 3, .lo = 2, .hi = 10,
      .help = "2: very clear, 3: clear, 6: warm and moist, 10: haze" },
    { .key = "albedo", .type = OPT_RGB, .num = 0.2, .lo = 0, .hi = 1,
      .help = "of the ground below the horizon" },
    { .key = "scale", .type = OPT_RGB, .num = 1,
      .help = "factor of all; 1 gives kcd/m^2, 0.03 makes white in full sun about 1" },
    { .key = "skyscale", .type = OPT_FLOAT, .num = 1, .lo = 0, .hi = 1e9,
      .help = "factor of the sky; 0 leaves the sun alone" },
    { .key = "sunscale", .type = OPT_FLOAT, .num = 1, .lo = 0, .hi = 1e9,
      .help = "factor of the sun; 0 takes it away" },
    { .key = "sunsize", .type = OPT_FLOAT, .num = 0.533, .lo = 0.01, .hi = 60,
      .help = "degrees across; its light stays the same" },
    { .key = NULL }
};

const LightKind light_sky = {
    .info = { "sky", "Preetham99; Kasten66", "a clear sky, its sun and the ground", options },
    .infinite = true, .make = make, .prepare = prepare, .clear = clear, .sample = sample,
    .pdf_w = pdf_w, .sample_beside = sample_beside, .pdf_beside = pdf_beside,
    .radiance = radiance, .emit = beyond_emit, .emit_pdf = beyond_emit_pdf,
    .power = power, .estimate = estimate, .picture = picture
};

/* texture.c -- what textures are worth at a point. See texture.h.
 *
 * Source      [PBRT4 10.3, 10.4, 10.5]: the textures of the scene language. Patterns are sampled
 *             at points; only pictures and noise look at the footprint.
 * Departs     The colours of marble and the places of dots are our own. */
#include "scene/texture.h"

#include "scene/noise.h"

static Rgb eval(const Texture *t, const Surface *s, bool alpha);

/* ---- pictures ---- */

/* Such that a pixel of the level is as wide as the beam, in the direction where it covers more. */
static float level_of(const Texture *t, const Surface *s)
{
    V2 w = texture_map_width(&t->map, s);
    float pixels = f_max(w.x * (float)t->image->w, w.y * (float)t->image->h);
    return pixels > 1.0f ? m_log2(pixels) : 0.0f;
}

static Rgb eval_image(const Texture *t, const Surface *s, bool alpha)
{
    V2 st = texture_map_st(&t->map, s);
    ImagePlace l = { st.x, st.y, t->wrap, alpha };
    Rgb c = t->filter == FILTER_POINT ? image_nearest(t->image, &l)
            : t->filter == FILTER_TRILINEAR && t->pyramid
              ? pyramid_trilinear(t->pyramid, &l, level_of(t, s)) : image_bilinear(t->image, &l);

    if (t->grey)
        c = rgb_all((c.r + c.g + c.b) / 3.0f);
    c = rgb_mul(c, t->value);
    return t->invert ? rgb(f_max(1.0f - c.r, 0.0f), f_max(1.0f - c.g, 0.0f),
                           f_max(1.0f - c.b, 0.0f)) : c;
}

/* ---- patterns ---- */

static bool odd(float s) { return s - 2.0f * floorf(0.5f * s) != 0.0f; }

static bool odd_square(V2 st) { return odd(floorf(st.x) + floorf(st.y)); }

static bool odd_cube(V3 p) { return odd(floorf(p.x) + floorf(p.y) + floorf(p.z)); }

static Rgb mix(Rgb a, Rgb b, Rgb part)
{
    return rgb_add(rgb_mul(a, rgb_sub(rgb_all(1.0f), part)), rgb_mul(b, part));
}

/* Discs of radius 0.35 somewhere in half of the squares about whole (s, t), not cut off. */
#define DOT_RADIUS 0.35f

static bool in_dot(V2 st)
{
    float x = floorf(st.x + 0.5f), y = floorf(st.y + 0.5f), dx, dy;
    const float shift = 1.0f - 2.0f * DOT_RADIUS;
    int64_t i, j;

    if (!(fabsf(x) < 0x1p30f) || !(fabsf(y) < 0x1p30f))
        return false;
    i = (int64_t)x;
    j = (int64_t)y;
    if (noise_cell(i, j, 0) < 0.5f)
        return false;
    dx = st.x - x - shift * (noise_cell(i, j, 1) - 0.5f);
    dy = st.y - y - shift * (noise_cell(i, j, 2) - 0.5f);
    return dx * dx + dy * dy < DOT_RADIUS * DOT_RADIUS;
}

static Rgb root(Rgb c)
{
    return rgb(sqrtf(f_max(c.r, 0.0f)), sqrtf(f_max(c.g, 0.0f)), sqrtf(f_max(c.b, 0.0f)));
}

static Rgb eval_bilerp(const Texture *t, const Surface *s, bool alpha)
{
    V2 st = texture_map_st(&t->map, s);
    Rgb left = mix(eval(t->a, s, alpha), eval(t->b, s, alpha), rgb_all(st.y));
    Rgb right = mix(eval(t->c, s, alpha), eval(t->d, s, alpha), rgb_all(st.y));
    return mix(left, right, rgb_all(st.x));
}

static float fraction(float x) { return x - floorf(x); }

static Rgb eval_uv(const Texture *t, const Surface *s)
{
    V2 st = texture_map_st(&t->map, s);
    return rgb(fraction(st.x), fraction(st.y), 0.0f);
}

/* ---- noise ---- */

static Octaves octaves_of(const Texture *t, const Surface *s, float scale)
{
    return (Octaves){ t->octaves, t->roughness, scale * texture_map_space_width(&t->map, s) };
}

/* Waves that a wind raises here and not there. */
static float windy(V3 p, float width)
{
    float wind = noise_sum(v_scale(p, 0.1f), (Octaves){ 3, 0.5f, 0.1f * width });
    return fabsf(wind) * noise_sum(p, (Octaves){ 6, 0.5f, width });
}

/* 1 at the middle, 0 from `half` on. */
static float bump(float x, float middle, float half)
{
    float d = (x - middle) / half;
    return fabsf(d) < 1.0f ? f_sqr(1.0f - d * d) : 0.0f;
}

/* Pale stone in layers along y, which noise folds: each has a soft grey band and a dark vein. */
static Rgb marble(const Texture *t, const Surface *s)
{
    V3 p = v_scale(texture_map_space(&t->map, s), t->scale);
    float fold = t->variation * noise_sum(p, octaves_of(t, s, fabsf(t->scale)));
    float x = 0.5f + 0.5f * m_sin(p.y + fold);
    Rgb c = mix(rgb(0.87f, 0.87f, 0.90f), rgb(0.74f, 0.74f, 0.75f),
                rgb_all(bump(x, 0.4f, 0.25f)));
    return mix(c, rgb(0.34f, 0.34f, 0.50f), rgb_all(bump(x, 0.9f, 0.2f)));
}

/* ---- all kinds ---- */

static Rgb eval_pattern(const Texture *t, const Surface *s)
{
    V3 p = texture_map_space(&t->map, s);

    switch (t->kind) {
    case TEXTURE_FBM:      return rgb_scale(t->value, noise_sum(p, octaves_of(t, s, 1.0f)));
    case TEXTURE_WRINKLED: return rgb_scale(t->value, noise_turbulence(p, octaves_of(t, s, 1.0f)));
    case TEXTURE_WINDY:
        return rgb_scale(t->value, windy(p, texture_map_space_width(&t->map, s)));
    case TEXTURE_MARBLE:   return rgb_mul(t->value, marble(t, s));
    default:               return t->value;
    }
}

/* Which of its operands a pattern shows. */
static const Texture *chosen(const Texture *t, const Surface *s)
{
    if (t->kind == TEXTURE_DOTS)
        return in_dot(texture_map_st(&t->map, s)) ? t->a : t->b;
    if (t->kind == TEXTURE_CHECKER)
        return odd_square(texture_map_st(&t->map, s)) ? t->b : t->a;
    return odd_cube(texture_map_space(&t->map, s)) ? t->b : t->a;
}

static Rgb eval(const Texture *t, const Surface *s, bool alpha)
{
    float along;

    switch (t->kind) {
    case TEXTURE_CONSTANT: return t->value;
    case TEXTURE_IMAGE:    return eval_image(t, s, alpha);
    case TEXTURE_CHECKER:
    case TEXTURE_CHECKER3:
    case TEXTURE_DOTS:     return eval(chosen(t, s), s, alpha);
    case TEXTURE_SCALE:    return rgb_mul(eval(t->a, s, alpha), eval(t->b, s, alpha));
    case TEXTURE_MIX:
        return mix(eval(t->a, s, alpha), eval(t->b, s, alpha), eval(t->c, s, false));
    case TEXTURE_ROOT:     return root(eval(t->a, s, alpha));
    case TEXTURE_DIRECTION_MIX:
        along = v_absdot(s->ng, t->axis);
        return mix(eval(t->b, s, alpha), eval(t->a, s, alpha), rgb_all(along));
    case TEXTURE_BILERP:   return eval_bilerp(t, s, alpha);
    case TEXTURE_UV:       return eval_uv(t, s);
    default:               return eval_pattern(t, s);
    }
}

Rgb texture_eval(const Texture *t, const Surface *s) { return eval(t, s, false); }

float texture_alpha(const Texture *t, const Surface *s)
{
    Rgb c = eval(t, s, true);
    return c.r == c.g && c.g == c.b ? c.r : rgb_lum(c);
}

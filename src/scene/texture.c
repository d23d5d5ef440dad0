/* texture.c -- values that vary over a surface. A closed set: a tag and a switch. See scene.h. */
#include "scene/scene.h"

/* Picks up pixel (x, y) of a picture that repeats. */
static Rgb pixel(const Image *im, int64_t x, int64_t y)
{
    int64_t w = im->w, h = im->h;
    x %= w;
    y %= h;
    return *image_at(im, (uint32_t)(x < 0 ? x + w : x), (uint32_t)(y < 0 ? y + h : y));
}

/* Bilinear between pixel centres; v runs upwards, rows run downwards. */
static Rgb image_lookup(const Image *im, float u, float v)
{
    float x = u * (float)im->w - 0.5f, y = (1.0f - v) * (float)im->h - 0.5f;
    float fx = floorf(x), fy = floorf(y), a = x - fx, b = y - fy;
    int64_t i, j;
    Rgb top, bottom;

    if (!(fabsf(fx) < 1e9f) || !(fabsf(fy) < 1e9f))     /* beyond the digits of a float */
        return *image_at(im, 0, 0);
    i = (int64_t)fx;
    j = (int64_t)fy;
    top = rgb_add(rgb_scale(pixel(im, i, j), 1.0f - a), rgb_scale(pixel(im, i + 1, j), a));
    bottom = rgb_add(rgb_scale(pixel(im, i, j + 1), 1.0f - a),
                     rgb_scale(pixel(im, i + 1, j + 1), a));
    return rgb_add(rgb_scale(top, 1.0f - b), rgb_scale(bottom, b));
}

static bool odd_square(float u, float v)
{
    float s = floorf(u) + floorf(v);
    return s - 2.0f * floorf(0.5f * s) != 0.0f;
}

Rgb texture_eval(const Texture *t, const Surface *s)
{
    float u = t->su * s->uv.x + t->du, v = t->sv * s->uv.y + t->dv;

    switch (t->kind) {
    case TEXTURE_CONSTANT: break;
    case TEXTURE_IMAGE:    return rgb_mul(image_lookup(t->image, u, v), t->value);
    case TEXTURE_CHECKER:  return texture_eval(odd_square(u, v) ? t->b : t->a, s);
    case TEXTURE_SCALE:    return rgb_mul(texture_eval(t->a, s), texture_eval(t->b, s));
    }
    return t->value;
}

Rgb texture_mean(const Texture *t)
{
    switch (t->kind) {
    case TEXTURE_CONSTANT: break;
    case TEXTURE_IMAGE: {
        double r = 0, g = 0, b = 0, n = (double)t->image->w * t->image->h;
        for (size_t i = 0; i < (size_t)t->image->w * t->image->h; i++) {
            r += t->image->pixels[i].r;
            g += t->image->pixels[i].g;
            b += t->image->pixels[i].b;
        }
        return rgb_mul(rgb((float)(r / n), (float)(g / n), (float)(b / n)), t->value);
    }
    case TEXTURE_CHECKER:
        return rgb_scale(rgb_add(texture_mean(t->a), texture_mean(t->b)), 0.5f);
    case TEXTURE_SCALE:
        return rgb_mul(texture_mean(t->a), texture_mean(t->b));
    }
    return t->value;
}

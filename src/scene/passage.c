/* passage.c -- rays past surfaces that let them pass: masks with holes, and the borders of media.
 * See scene.h.
 *
 * A surface of opacity a stops a part a of the rays that meet it. Which ones, a number decides that
 * is made of the ray's own bits and of what it met: so the same ray is stopped or not whoever asks,
 * and neither accelerator nor thread matters. A pattern behind such a surface is still sampled
 * right, since rays differ. Of several surfaces at one place, one is asked. */
#include "base/bits.h"
#include "base/random.h"
#include "scene/scene.h"

/* Surfaces that one ray may pass; the next one stops it. More leaves than a wood has. */
enum { PASSED_MOST = 65536 };

static uint64_t bits_of_both(float a, float b)
{
    return (uint64_t)bits_of_float(a) << 32 | bits_of_float(b);
}

/* n: surfaces passed before; a sphere is met twice. */
static float number_of(const Ray *r, const Hit *h, int n)
{
    uint64_t key = key_with(bits_of_both(r->o.x, r->o.y), bits_of_both(r->o.z, r->d.x));
    key = key_with(key_with(key, bits_of_both(r->d.y, r->d.z)), (uint64_t)n);
    return unit_of((uint32_t)(key_with(key, (uint64_t)h->outer << 32 | h->prim) >> 32));
}

static bool stops(const Scene *s, const Ray *r, const Hit *h, int n, const Surface *at)
{
    const Texture *opacity = s->materials[at->shape->material].opacity;
    float a;

    if (!opacity)
        return true;
    a = texture_alpha(opacity, at);
    return a >= 1.0f || (a > 0.0f && number_of(r, h, n) < a);
}

/* Sets the part of r that is left beyond the surface that it met at t. */
static void go_past(const Ray *r, const Surface *at, float t, Ray *part, float *passed)
{
    part->o = ray_origin(at->p, at->err, at->ng, r->d);
    *passed = f_max(*passed + t, v_dot(v_sub(part->o, r->o), r->d) / v_dot(r->d, r->d));
    part->tmax = r->tmax - *passed;
}

Met scene_meets(const Scene *s, const Ray *r, bool borders, Hit *h, Surface *at)
{
    Ray part = *r;
    float passed = 0.0f;

    for (int n = 0; part.tmax > 0.0f && accel_nearest(s->accel, &part, h); n++) {
        bool stopped;
        accel_surface(s->accel, &part, h, at);
        stopped = n == PASSED_MOST || stops(s, r, h, n, at);
        if (stopped || (borders && at->shape->separates)) {
            h->t += passed;
            return stopped ? MET_SURFACE : MET_BORDER;
        }
        go_past(r, at, h->t, &part, &passed);
    }
    hit_none(h, r->tmax);
    return MET_NOTHING;
}

bool scene_nearest_past(const Scene *s, const Ray *r, Hit *h)
{
    Surface at;
    return scene_meets(s, r, false, h, &at) == MET_SURFACE;
}

uint32_t medium_beyond(const Surface *at, V3 w, uint32_t medium)
{
    if (!at->shape->separates)
        return medium;
    return v_dot(at->ng, w) > 0.0f ? at->shape->outside : at->shape->inside;
}

uint32_t scene_medium_at(const Scene *s, V3 p, float time)
{
    Ray r = { .o = p, .d = { 0.36f, 0.48f, 0.8f }, .tmax = INFINITY, .time = time };

    for (int n = 0; n < PASSED_MOST; n++) {
        Surface at;
        Hit h;
        if (scene_meets(s, &r, true, &h, &at) == MET_NOTHING)
            break;
        if (at.shape->separates)
            return medium_beyond(&at, v_neg(r.d), s->around);
        r.o = ray_origin(at.p, at.err, at.ng, r.d);
    }
    return s->around;
}

Rgb scene_transmittance(const Scene *s, const Ray *r, uint32_t medium)
{
    Rgb left = rgb_all(1.0f);
    float unit = v_len(r->d), passed = 0.0f;
    Ray part = *r;

    for (int n = 0; n < PASSED_MOST && part.tmax > 0.0f; n++) {
        Surface at;
        Hit h;
        Met met = scene_meets(s, &part, true, &h, &at);
        if (met == MET_SURFACE)
            return rgb_all(0.0f);
        if (medium != NO_MEDIUM)
            left = rgb_mul(left, medium_transmittance(&s->media[medium], h.t * unit));
        if (met == MET_NOTHING || rgb_black(left))
            return left;
        medium = medium_beyond(&at, r->d, medium);
        go_past(r, &at, h.t, &part, &passed);
    }
    return left;
}

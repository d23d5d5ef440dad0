/* area_rectangle.c -- lamps that are rectangles (or other parallelograms) with a picture, of which
 * any place can be asked for: for methods that choose places by themselves.
 *
 * Two triangles P Q R and S R Q, the diagonal from Q to R theirs, with S = Q + R - P. Place (x, y)
 * is P + x (Q - P) + y (R - P), on the first where x + y <= 1, with weights 1 - x - y, x, y; else
 * on the second, with weights x + y - 1, 1 - x, 1 - y. So points lie on the surface that rays meet,
 * to the same error. */
#include "scene/area.h"

static const float OFF = 1e-5f;         /* of the diagonal: how far from S its place may be */
static const float THIN = 1e-3f;        /* least sine of the angle between sides */

static float size_of(V3 a) { return v_max3(v_abs(a)); }

/* The corner of triangle a that is none of b's, if the others are. */
static bool odd_corner(const V3 a[3], const V3 b[3], int *first)
{
    int shared = 0;

    for (int i = 0; i < 3; i++) {
        bool both = false;
        for (int k = 0; k < 3; k++)
            both |= size_of(v_sub(a[i], b[k])) == 0.0f;
        shared += both;
        if (!both)
            *first = i;
    }
    return shared == 2;
}

/* Weights of second and third corner of a triangle, from those of corners first, first + 1, ... */
static void set_weights(int first, const float w[3], float *b1, float *b2)
{
    float b[3];

    for (int k = 0; k < 3; k++)
        b[(first + k) % 3] = w[k];
    *b1 = f_max(b[1], 0.0f);
    *b2 = f_max(b[2], 0.0f);
}

static void at_place(const Area *l, V2 place, AreaPoint *at)
{
    float x = place.x, y = place.y, b1, b2;
    bool second = x + y > 1.0f;
    float near[3] = { 1.0f - x - y, x, y }, far[3] = { x + y - 1.0f, 1.0f - x, 1.0f - y };

    if (second && l->turned) {
        far[1] = 1.0f - y;
        far[2] = 1.0f - x;
    }
    set_weights(l->first[second], second ? far : near, &b1, &b2);
    area_on_triangle(l, second, b1, b2, at);
}

/* Pixels of the picture along the way from one corner to another. */
static uint32_t pixels_along(const Area *l, V2 to)
{
    enum { MOST = 1 << 20 };
    const Image *im = l->picture.image;
    AreaPoint a, b;
    float n;

    at_place(l, (V2){ 0, 0 }, &a);
    at_place(l, to, &b);
    n = f_max(fabsf(b.uv.x - a.uv.x) * (float)im->w, fabsf(b.uv.y - a.uv.y) * (float)im->h);
    return n >= 1.0f ? (uint32_t)f_min(n + 0.5f, MOST) : 1;
}

void area_prepare_rectangle(Area *l)
{
    LightRectangle *r = &l->rectangle;
    const Shape *s = shape_of(l);
    AreaPoint near, far;
    V3 a[3], b[3], q, t;

    if (!l->base.textured || s->kind != SHAPE_MESH || s->count != 2 || !(l->area > 0.0f))
        return;
    geometry_face(geometry_of(l), lamp_triangle(s, 0), a);
    geometry_face(geometry_of(l), lamp_triangle(s, 1), b);
    if (!odd_corner(a, b, &l->first[0]) || !odd_corner(b, a, &l->first[1]))
        return;
    r->corner = a[l->first[0]];
    q = a[(l->first[0] + 1) % 3];
    t = a[(l->first[0] + 2) % 3];
    l->turned = size_of(v_sub(b[(l->first[1] + 1) % 3], q)) == 0.0f;
    r->side[0] = v_sub(q, r->corner);
    r->side[1] = v_sub(t, r->corner);
    if (size_of(v_sub(v_add(r->side[0], r->side[1]), v_sub(b[l->first[1]], r->corner))) >
        OFF * v_len(v_sub(t, q)) ||
        !(v_len(v_cross(v_unit(r->side[0]), v_unit(r->side[1]))) > THIN))
        return;
    at_place(l, (V2){ 0.25f, 0.25f }, &near);
    at_place(l, (V2){ 0.75f, 0.75f }, &far);
    r->n = near.n;
    r->both = l->two_sided || v_dot(near.n, far.n) < 0.0f;
    r->exponent = l->exponent;
    r->pixels[0] = pixels_along(l, (V2){ 1, 0 });
    r->pixels[1] = pixels_along(l, (V2){ 0, 1 });
    l->is_rectangle = true;
}

/* ---- as others see it ---- */

static bool rectangle(const Light *base, LightRectangle *r)
{
    const Area *l = (const Area *)base;

    *r = l->rectangle;
    return l->is_rectangle;
}

static Rgb shows(const Light *base, V2 place)
{
    const Area *l = (const Area *)base;
    AreaPoint at;

    at_place(l, place, &at);
    return area_masked(l, &at, area_emitted(l, at.uv, 1.0f));
}

static bool seen(const Light *base, V2 place, V3 from, LightSample *s)
{
    const Area *l = (const Area *)base;
    AreaPoint at;

    at_place(l, place, &at);
    return area_seen(l, &at, from, s);
}

const LightPlaces area_places = { rectangle, shows, seen };

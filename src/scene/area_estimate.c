/* area_estimate.c -- what a shape that shines would bring to a point: for choosing among lights.
 * See light_estimate in light.h.
 *
 * The shape is taken for a ball around it, or, if it lies in a plane, for a disc. Nothing that it
 * can light is left out: each cosine is at least what some point of the ball gives. */
#include "scene/area.h"

static const float FLAT_COSINE = 0.9999f;       /* of two normals of a flat lamp, at least */

static Box box_of_lamp(const Area *l, const Shape *s, uint32_t n)
{
    Box b = box_empty();

    for (uint32_t i = 0; i < n; i++) {
        V3 c[3];
        geometry_face(geometry_of(l), lamp_triangle(s, i), c);
        for (int k = 0; k < 3; k++)
            b = box_point(b, c[k]);
    }
    return b;
}

/* All triangles in one plane and turned the same way? Not if the file's normals say which side
 * shines. */
static bool is_flat(const Area *l, const Shape *s, uint32_t n)
{
    if (!n || s->n || s->kind != SHAPE_MESH)
        return false;
    for (uint32_t i = 0; i < n; i++) {
        V3 c[3];
        geometry_face(geometry_of(l), lamp_triangle(s, i), c);
        if (!(v_dot(l->normals[i], l->normals[0]) >= FLAT_COSINE))
            return false;
        for (int k = 0; k < 3; k++)
            if (fabsf(v_dot(l->normals[0], v_sub(c[k], l->centre))) > 0.01f * l->radius)
                return false;
    }
    return true;
}

void area_prepare_estimate(Area *l)
{
    const Shape *s = shape_of(l);
    uint32_t n = 0;
    Box b = box_empty();

    l->axis = v_all(0.0f);
    if (s->kind == SHAPE_MESH || s->kind == SHAPE_TESSELLATION) {
        n = lamp_triangles(s);
        b = box_of_lamp(l, s, n);
    } else if (s->kind == SHAPE_SPHERE)
        b = sphere_box(&s->as.sphere);
    else if (s->kind == SHAPE_DISK)
        b = disk_box(&s->as.disk);
    if (box_is_empty(b))
        b.lo = b.hi = v_all(0.0f);
    l->centre = box_centre(b);
    l->radius = v_len(v_sub(b.hi, l->centre)) * (1.0f + ROUNDINGS(8));
    if (s->kind == SHAPE_SPHERE && s->as.sphere.whole)
        l->radius = s->as.sphere.radius * (1.0f + ROUNDINGS(8));
    if (s->kind == SHAPE_DISK)
        l->axis = s->flip ? v_neg(s->as.disk.frame.n) : s->as.disk.frame.n;
    else if (is_flat(l, s, n))
        l->axis = s->flip ? v_neg(l->normals[0]) : l->normals[0];
    l->lum = rgb_lum(rgb_mul(l->L, l->mean));
}

/* Area that a flat lamp shows the point, with its focus; a body shows a quarter of its surface, as
 * convex ones do. What is flat but for a hundredth may show a little where its plane does not: by
 * at most 0.01 radius / d + 0.0142 (1 + radius / d), the latter for FLAT_COSINE. */
static float shown_area(const Area *l, V3 to)
{
    float c, d = v_len(to);

    if (v_len2(l->axis) == 0.0f)
        return 0.25f * l->area;
    if (d <= l->radius)
        c = l->two_sided || v_dot(l->axis, to) < 0.05f * l->radius ? 1.0f : 0.0f;
    else {
        c = -v_dot(l->axis, to) / d;
        if (l->two_sided)
            c = fabsf(c);
        c = estimate_above(c, 0.03f * (1.0f + l->radius / d));
    }
    if (c > 0.0f && l->exponent > 0.0f)
        c = f_max(c * m_pow(f_min(c + l->radius / f_max(d, l->radius), 1.0f), l->exponent),
                  1e-12f);
    return l->area * c;
}

/* Of a disc that faces the point, exactly, from its axis: pi L R^2 / (d^2 + R^2). */
float area_estimate(const Light *base, V3 p, V3 n)
{
    const Area *l = (const Area *)base;
    V3 to = v_sub(l->centre, p);
    float a = shown_area(l, to), full = l->area * (v_len2(l->axis) == 0.0f ? 0.25f : 1.0f);

    if (!(a > 0.0f))
        return 0.0f;
    return l->lum * a * estimate_cosine(n, to, l->radius) / (v_len2(to) + INV_PI * full);
}

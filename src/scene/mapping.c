/* mapping.c -- places of a picture as directions: every mapping of panorama.h, there and back. */
#include "scene/panorama.h"

#include <string.h>

/* ---- latitude and longitude ---- */

static float latlong_jacobian(float sine) { return 2.0f * PI_F * PI_F * sine; }

static V3 latlong_direction(V2 p, float *jacobian)
{
    float sn, cs, st, ct;

    m_sincos_turn(p.x, &sn, &cs);
    m_sincos_turn(0.5f * p.y, &st, &ct);
    *jacobian = latlong_jacobian(st);
    return v3(st * cs, st * sn, ct);
}

static V2 latlong_place(V3 d, float *jacobian)
{
    float sine = sqrtf(d.x * d.x + d.y * d.y);

    *jacobian = latlong_jacobian(sine);
    return (V2){ m_azimuth(d.y, d.x) * (0.5f * INV_PI), m_atan2(sine, d.z) * INV_PI };
}

/* ---- the folded square ---- */

/* Within the diamond |x| + |y| = r is the ring 1 - z = r^2, whose area is that of the diamond's
 * rim; along it the azimuth is linear. The corners beyond are the lower half, folded outwards. */
static V3 octahedral_direction(V2 p, float *jacobian)
{
    float x = 2.0f * p.x - 1.0f, y = 2.0f * p.y - 1.0f, ax = fabsf(x), ay = fabsf(y);
    float inside = 1.0f - (ax + ay), r = 1.0f - fabsf(inside), sn, cs, sine;
    float turn = r > 0.0f ? 0.125f * ((ay - ax) / r + 1.0f) : 0.125f;   /* 0 to 1/4 */

    *jacobian = 4.0f * PI_F;
    m_sincos_turn(turn, &sn, &cs);
    sine = r * sqrtf(2.0f - r * r);
    return v3(copysignf(cs * sine, x), copysignf(sn * sine, y), copysignf(1.0f - r * r, inside));
}

static V2 octahedral_place(V3 d, float *jacobian)
{
    float x = fabsf(d.x), y = fabsf(d.y);
    float r = sqrtf((x * x + y * y) / (1.0f + fabsf(d.z)));     /* sqrt(1 - |z|), exactly */
    float v = r * (m_atan2(y, x) * (2.0f * INV_PI)), u = r - v;

    *jacobian = 4.0f * PI_F;
    if (d.z < 0.0f) {
        float fold = 1.0f - v;
        v = 1.0f - u;
        u = fold;
    }
    return (V2){ 0.5f * (copysignf(u, d.x) + 1.0f), 0.5f * (copysignf(v, d.y) + 1.0f) };
}

/* ---- balls ---- */

/* sin(pi r) / r. */
static float sine_over(float sine, float r) { return r > 0.0f ? sine / r : PI_F; }

static V3 ball_direction(MappingKind kind, V2 p, float *jacobian)
{
    float x = 2.0f * p.x - 1.0f, y = 1.0f - 2.0f * p.y, r2 = x * x + y * y, scale, c;

    if (!(r2 <= 1.0f)) {
        *jacobian = 0.0f;
        return v3(1, 0, 0);
    }
    if (kind == MAPPING_MIRRORBALL) {           /* sine and cosine of 2 asin(r), over r */
        scale = 2.0f * sqrtf(1.0f - r2);
        c = 1.0f - 2.0f * r2;
        *jacobian = 16.0f;
    } else {
        float r = sqrtf(r2), sine;
        m_sincos_turn(0.5f * r, &sine, &c);
        scale = sine_over(sine, r);
        *jacobian = 4.0f * PI_F * scale;
    }
    return v3(-c, scale * x, scale * y);
}

static V2 ball_place(MappingKind kind, V3 d, float *jacobian)
{
    float s2 = d.y * d.y + d.z * d.z, scale;

    if (kind == MAPPING_MIRRORBALL) {           /* r / sine = 1 / sqrt(2 (1 + cosine)) */
        float one = d.x > 0.0f ? s2 / (1.0f + d.x) : 1.0f - d.x;
        scale = one > 0.0f ? 1.0f / sqrtf(2.0f * one) : 0.0f;
        *jacobian = 16.0f;
    } else {
        float sine = sqrtf(s2), r = m_atan2(sine, -d.x) * INV_PI;
        scale = 1.0f / sine_over(sine, r);
        scale = is_finite(scale) ? scale : 0.0f;
        *jacobian = 4.0f * PI_F * sine_over(sine, r);
    }
    return (V2){ 0.5f * (1.0f + scale * d.y), 0.5f * (1.0f - scale * d.z) };
}

/* ---- a window ---- */

static V3 window_direction(const Mapping *m, V2 p, float *jacobian)
{
    V3 w = v3((2.0f * p.x - 1.0f) * m->half_x, (2.0f * p.y - 1.0f) * m->half_y, 1.0f);
    float c = 1.0f / v_len(w);

    *jacobian = 4.0f * m->half_x * m->half_y * c * c * c;
    return v_scale(w, c);
}

static V2 window_place(const Mapping *m, V3 d, float *jacobian)
{
    V2 p = { -1.0f, -1.0f };

    *jacobian = 0.0f;
    if (!(d.z > 0.0f))
        return p;
    p.x = 0.5f * (d.x / (d.z * m->half_x) + 1.0f);
    p.y = 0.5f * (d.y / (d.z * m->half_y) + 1.0f);
    if (p.x >= 0.0f && p.x <= 1.0f && p.y >= 0.0f && p.y <= 1.0f)
        *jacobian = 4.0f * m->half_x * m->half_y * d.z * d.z * d.z;
    return p;
}

/* ---- any ---- */

V3 mapping_direction(const Mapping *m, V2 place, float *jacobian)
{
    switch (m->kind) {
    case MAPPING_LATLONG:    break;
    case MAPPING_OCTAHEDRAL: return octahedral_direction(place, jacobian);
    case MAPPING_ANGULAR:
    case MAPPING_MIRRORBALL: return ball_direction(m->kind, place, jacobian);
    case MAPPING_WINDOW:     return window_direction(m, place, jacobian);
    }
    return latlong_direction(place, jacobian);
}

V2 mapping_place(const Mapping *m, V3 d, float *jacobian)
{
    V2 p = { 0, 0 };

    *jacobian = 0.0f;
    switch (m->kind) {
    case MAPPING_LATLONG:    p = latlong_place(d, jacobian); break;
    case MAPPING_OCTAHEDRAL: p = octahedral_place(d, jacobian); break;
    case MAPPING_ANGULAR:
    case MAPPING_MIRRORBALL: p = ball_place(m->kind, d, jacobian); break;
    case MAPPING_WINDOW:     p = window_place(m, d, jacobian); break;
    }
    return (V2){ f_min(f_max(p.x, 0.0f), ONE_MINUS_ULP), f_min(f_max(p.y, 0.0f), ONE_MINUS_ULP) };
}

double mapping_corner(double x, double y)
{
    return md_atan2(x * y, sqrt(1.0 + x * x + y * y));
}

double mapping_solid_angle(const Mapping *m)
{
    return m->kind == MAPPING_WINDOW ? 4.0 * mapping_corner(m->half_x, m->half_y) : 4.0 * PI;
}

bool mapping_is_v3(const Opts *o)
{
    const Param *file = opt_param(o, "filename");
    return file && !strcmp(file->name, "mapname");
}

Mapping mapping_option(const Opts *o, const Image *image)
{
    Mapping m = { MAPPING_LATLONG, 0, 0 };

    if (opt_is(o, "mapping", "octahedral") ||
        (opt_is(o, "mapping", "auto") && !mapping_is_v3(o) && image->w == image->h))
        m.kind = MAPPING_OCTAHEDRAL;
    else if (opt_is(o, "mapping", "angular"))
        m.kind = MAPPING_ANGULAR;
    else if (opt_is(o, "mapping", "mirrorball"))
        m.kind = MAPPING_MIRRORBALL;
    return m;
}

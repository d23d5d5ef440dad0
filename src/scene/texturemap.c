/* texturemap.c -- from points of surfaces to places in a texture. See texture.h.
 *
 * Source      [PBRT4 10.2]: the mappings of the scene language, by their formulas in version 4.
 * Footprints  A beam is `width` wide where it meets the surface, in units of the scene. It covers
 *             width / |dp/du| of u; of space as much as the map into the texture stretches it. */
#include "scene/texture.h"

V3 texture_map_space(const TextureMap *m, const Surface *s)
{
    return affine_point(&m->to_texture, s->p);
}

float texture_map_space_width(const TextureMap *m, const Surface *s)
{
    V3 along = v_len2(s->dpdu) > 0.0f ? v_unit(s->dpdu) : frame_about(s->ng).s;
    return s->width > 0.0f ? s->width * v_len(affine_vector(&m->to_texture, along)) : 0.0f;
}

static float from_axis(V3 p) { return sqrtf(p.x * p.x + p.y * p.y); }

V2 texture_map_st(const TextureMap *m, const Surface *s)
{
    V3 p;

    if (m->kind == TEXTURE_MAP_UV)
        return (V2){ m->su * s->uv.x + m->du, m->sv * s->uv.y + m->dv };
    p = texture_map_space(m, s);
    if (m->kind == TEXTURE_MAP_SPHERICAL)
        return (V2){ m_atan2(from_axis(p), p.z) * INV_PI, m_azimuth(p.y, p.x) * (0.5f * INV_PI) };
    if (m->kind == TEXTURE_MAP_CYLINDRICAL)
        return (V2){ (PI_F + m_atan2(p.y, p.x)) * (0.5f * INV_PI), p.z };
    return (V2){ v_dot(p, m->vs) + m->du, v_dot(p, m->vt) + m->dv };
}

static float ratio(float a, float b) { return b > 0.0f ? a / b : 0.0f; }

V2 texture_map_width(const TextureMap *m, const Surface *s)
{
    float w;
    V3 p;

    if (!(s->width > 0.0f))
        return (V2){ 0.0f, 0.0f };
    if (m->kind == TEXTURE_MAP_UV)
        return (V2){ fabsf(m->su) * ratio(s->width, v_len(s->dpdu)),
                     fabsf(m->sv) * ratio(s->width, v_len(s->dpdv)) };
    w = texture_map_space_width(m, s);
    p = texture_map_space(m, s);
    if (m->kind == TEXTURE_MAP_SPHERICAL)
        return (V2){ ratio(w, PI_F * v_len(p)), ratio(w, 2.0f * PI_F * from_axis(p)) };
    if (m->kind == TEXTURE_MAP_CYLINDRICAL)
        return (V2){ ratio(w, 2.0f * PI_F * from_axis(p)), w };
    return (V2){ w * v_len(m->vs), w * v_len(m->vt) };
}

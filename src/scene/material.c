/* material.c -- a BSDF model and where its parameters come from, bumps and pictures of normals
 * included. See material.h.
 *
 * Bumps   [Blinn78]: a surface p(u, v) displaced by d along its normal n has
 *           p'_u = p_u + d_u n, p'_v = p_v + d_v n (d n_u and d n_v are left out, as d is small),
 *         so that its normal lies along
 *           N' = |N| n + s (d_u (n x p_v) - d_v (n x p_u)),  N = p_u x p_v,
 *         where s = +-1 says on which side of n the vector N is. d_u and d_v are differences of
 *         the texture to both sides.
 *
 * Normals [PBRT4 10.5.3]: red, green and blue of a picture are (1 + x) / 2 and so on of a unit
 *         vector, in the frame of the shading normal (z), of x along p_u and y = z cross x. Tools
 *         that paint across seams where a picture is mirrored mean y to be on the side of p_v:
 *         `mirrors`. Bumps stand on top of them.
 *
 * Shading normals that geometry does not have are known to go wrong; what is done about it: the
 * normal stays on the side of the geometric one, or it is left as it was. It does not depend on
 * where the eye is, so that all ways of making a path agree on it. Where the eye sees a bump's back
 * side, light is taken from behind the surface, which is dark: such spots are left dark. */
#include "scene/material.h"

#include <string.h>

bool material_init(Material *m, const BsdfKind *kind, const Opts *o, const BsdfFiles *files)
{
    memset(m, 0, sizeof *m);
    m->kind = kind;
    m->name = "";
    for (int i = 0; kind->info.options && kind->info.options[i].key; i++) {
        const OptValue *v = &o->value[i];
        ASSERT(i < BSDF_OPTIONS);
        m->value[i] = kind->info.options[i].type == OPT_RGB ? v->rgb : rgb_all((float)v->num);
        m->nvalues = i + 1;
    }
    return !kind->load || kind->load(o, files, &m->data);
}

void material_clear(Material *m)
{
    if (m->kind->drop && m->data && !m->borrows)
        m->kind->drop(m->data);
    m->data = NULL;
}

/* ---- mixtures and frames ---- */

int material_size(const Material *all, uint32_t index)
{
    const Material *m = &all[index];
    if (m->kind != &bsdf_mix)
        return 1;
    return 1 + material_size(all, m->part[0]) + material_size(all, m->part[1]);
}

/* Whether the model may differ along the tangents. Textures that are not the same stand for numbers
 * that are not. */
static bool wants_tangent(const Material *m)
{
    Rgb value[BSDF_OPTIONS];
    Bsdf b;

    if (m->kind == &bsdf_mix)
        return m->mixed[0]->tangent || m->mixed[1]->tangent;
    for (int i = 0; i < m->nvalues; i++) {
        int same = 0;
        value[i] = m->value[i];
        while (m->texture[i] && m->texture[same] != m->texture[i])
            same++;
        if (m->texture[i])
            value[i] = rgb_all(0.3f + 0.02f * (float)same);
    }
    bsdf_make(&b, m->kind, value, m->data);
    return (b.flags & BSDF_TANGENT) != 0;
}

void material_settle(Material *all, uint32_t index)
{
    Material *m = &all[index];

    m->looks_at_uv = m->textured || m->opacity || m->bump || m->normals;
    for (int k = 0; k < 2 && m->kind == &bsdf_mix; k++) {
        ASSERT(m->part[k] < index);             /* settled before */
        m->mixed[k] = &all[m->part[k]];
        m->looks_at_uv = m->looks_at_uv || m->mixed[k]->looks_at_uv;
    }
    m->tangent = (m->kind->flags & BSDF_TANGENT) && wants_tangent(m);
    m->looks_at_uv = m->looks_at_uv || m->tangent;
}

bool material_glints(const Material *m)
{
    Bsdf b;

    if (m->mixed[0])
        return material_glints(m->mixed[0]) || material_glints(m->mixed[1]);
    if (m->textured || !(m->kind->flags & BSDF_SPECULAR))
        return (m->kind->flags & BSDF_SPECULAR) != 0;
    bsdf_make(&b, m->kind, m->value, m->data);
    return (b.flags & BSDF_SPECULAR) != 0;
}

/* ---- the model at a point ---- */

/* Of the rays that a mixture stopped, the share of its first part. */
static Rgb stopped_share(const Material *m, const Surface *s, Rgb amount)
{
    Rgb share[2];

    amount = reflectance_of(amount);
    for (int k = 0; k < 2; k++) {
        const Texture *o = m->mixed[k]->opacity;
        share[k] = rgb_scale(k ? rgb_sub(rgb_all(1.0f), amount) : amount,
                             o ? clamp01(texture_alpha(o, s)) : 1.0f);
    }
    share[1] = rgb_add(share[0], share[1]);
    return rgb(share[1].r > 0.0f ? share[0].r / share[1].r : 0.0f,
               share[1].g > 0.0f ? share[0].g / share[1].g : 0.0f,
               share[1].b > 0.0f ? share[0].b / share[1].b : 0.0f);
}

static bool parts_pass(const Material *m)
{
    return m->mixed[0] && (m->mixed[0]->opacity || m->mixed[1]->opacity);
}

/* Makes the model in *b; parts of mixtures take what follows *free. */
static void make(const Material *m, const Surface *s, Bsdf *b, Bsdf **free)
{
    Rgb value[BSDF_OPTIONS];

    if (LIKELY(!m->textured && !parts_pass(m)))
        bsdf_make(b, m->kind, m->value, m->data);
    else {
        for (int i = 0; i < m->nvalues; i++)
            value[i] = m->texture[i] ? texture_eval(m->texture[i], s) : m->value[i];
        if (parts_pass(m))
            value[0] = stopped_share(m, s, value[0]);
        bsdf_make(b, m->kind, value, m->data);
    }
    if (m->mixed[0]) {
        Bsdf *first = (*free)++, *second = (*free)++;
        make(m->mixed[0], s, first, free);
        make(m->mixed[1], s, second, free);
        mix_parts(b, first, second);
    }
}

const Bsdf *material_bsdf(const Material *m, const Surface *s, BsdfRoom *room)
{
    Bsdf *free = &room->b[1];
    make(m, s, &room->b[0], &free);
    return &room->b[0];
}

/* ---- bumps ---- */

/* The texture where (u, v) is off by so much, and p with it. */
static float displaced(const Texture *t, const Surface *s, float du, float dv)
{
    Surface there = *s;
    Rgb d;

    there.uv.x += du;
    there.uv.y += dv;
    there.p = v_mad(s->dpdu, du, v_mad(s->dpdv, dv, s->p));
    d = texture_eval(t, &there);
    return (d.r + d.g + d.b) / 3.0f;
}

/* How far to either side: half of what the beam covers, or less than half a pixel of a picture
 * of 1024 across, and never so little that (u, v) has not the digits. */
static float step_of(const Surface *s, V3 along, float at)
{
    float length = v_len(along), least = f_max(0.00025f, fabsf(at) * 0x1p-12f);
    return length > 0.0f ? f_max(least, 0.5f * s->width / length) : least;
}

/* The turned normal, if it stays on the side of both. */
static V3 if_above(V3 n, const Surface *s)
{
    return v_finite(n) && v_dot(n, s->ng) > 0.0f && v_dot(n, s->ns) > 0.0f ? n : s->ns;
}

static V3 bumped_normal(const Material *m, const Surface *s)
{
    float hu = step_of(s, s->dpdu, s->uv.x), hv = step_of(s, s->dpdv, s->uv.y), slope_u, slope_v;
    V3 N = v_cross(s->dpdu, s->dpdv), n;
    float size = v_len(N);

    slope_u = (displaced(m->bump, s, hu, 0.0f) - displaced(m->bump, s, -hu, 0.0f)) / (2.0f * hu);
    slope_v = (displaced(m->bump, s, 0.0f, hv) - displaced(m->bump, s, 0.0f, -hv)) / (2.0f * hv);
    if (v_dot(N, s->ns) < 0.0f)
        size = -size;                           /* s N' instead of N', which v_unit takes out */
    n = v_sub(v_scale(v_cross(s->ns, s->dpdv), slope_u),
              v_scale(v_cross(s->ns, s->dpdu), slope_v));
    n = v_unit(v_mad(s->ns, size, n));
    if (size < 0.0f)
        n = v_neg(n);
    return if_above(n, s);
}

static V3 painted_normal(const Material *m, const Surface *s)
{
    Frame f = frame_along(s->ns, s->dpdu);
    Rgb c = texture_eval(m->normals, s);
    V3 n = { (2.0f * c.r - 1.0f) * m->slope, (2.0f * c.g - 1.0f) * m->slope, 2.0f * c.b - 1.0f };

    if (m->mirrors && v_dot(f.t, s->dpdv) < 0.0f)
        n.y = -n.y;
    n = v_unit(frame_out(&f, n));
    return if_above(n, s);
}

Frame material_frame_bumped(const Material *m, const Surface *s)
{
    Surface there;
    V3 n;

    if (m->normals) {
        there = *s;
        there.ns = painted_normal(m, s);
        s = &there;
    }
    n = m->bump ? bumped_normal(m, s) : s->ns;
    return m->tangent ? frame_along(n, s->dpdu) : frame_about(n);
}

/* surfaces.c -- what a shape that is added gets besides its points: the material, with the shape's
 * own mask on it; the media that it separates; the light that shines from it. And the directives
 * that tell of media.
 *
 * A surface "interface" separates media and is not seen: a material of opacity 0. Where it
 * separates none, nothing is left of it. */
#include "scenefile/reader.h"

#include <string.h>

/* ---- masks ---- */

static bool masked(Reader *r, uint32_t of, const Texture *mask, uint32_t *index)
{
    Material m = r->scene->materials[of];
    Masked entry = { of, 0, mask };

    for (size_t i = r->nmasked; i-- > 0; )
        if (r->masked[i].of == of && r->masked[i].mask == mask) {
            *index = r->masked[i].material;
            return true;
        }
    m.borrows = true;
    m.opacity = m.opacity ? texture_product(r, m.opacity, mask) : mask;
    if (!m.opacity || !scene_add_material(r->scene, &m, &entry.material))
        return false;
    *index = entry.material;
    return MEM_PUSH(r->masked, r->nmasked, r->cap_masked, entry);
}

/* The mask of the shape to come; one number for all is a texture of its own, but 0. */
bool surface_mask(Reader *r, const Params *ps, bool *nowhere)
{
    const Param *p = params_find(ps, "alpha", "shadowalpha");

    r->mask = NULL;
    *nowhere = p && p->kind == PARAM_FLOAT && p->n == 1 && p->numbers[0] <= 0 && !r->state.area;
    if (!p || *nowhere)
        return true;
    if (p->kind == PARAM_TEXTURE && p->n == 1) {
        if (!texture_find(r, p->at, p->strings[0], false, &r->mask))
            return false;
        if (r->mask && r->mask->kind == TEXTURE_CONSTANT && r->mask->value.r >= 1)
            r->mask = NULL;
        return true;
    }
    if (p->kind != PARAM_FLOAT || p->n != 1)
        return err_at(p->at, "\"alpha\" is not right, expected a number or a texture");
    if (p->numbers[0] >= 1)
        return true;
    r->mask = texture_constant(r, rgb_all((float)p->numbers[0]));
    return r->mask != NULL;
}

/* ---- a shape's surface ---- */

static bool separates(const State *s) { return s->inside != s->outside; }

/* The material of a surface that is not seen. */
static bool unseen(Reader *r, uint32_t *index)
{
    const Texture *nothing;

    if (!r->unseen) {
        nothing = texture_constant(r, rgb_all(0.0f));
        if (!nothing || !masked(r, 0, nothing, &r->unseen))
            return false;
    }
    *index = r->unseen;
    return true;
}

bool surface_left_out(const Reader *r, uint32_t material)
{
    return material == MATERIAL_NONE && !r->state.area && !separates(&r->state);
}

/* A light may have the material that is left out: then it only shines. */
bool surface_material(Reader *r, uint32_t material, uint32_t *index)
{
    if (material == MATERIAL_NONE && !r->state.area)
        return unseen(r, index);
    *index = material == MATERIAL_NONE ? 0 : material;
    return !r->mask || masked(r, *index, r->mask, index);
}

bool surface_finish(Reader *r, const AreaLight *area, uint32_t shape, Place at)
{
    Shape *s = &r->scene->geometries[r->object].shapes[shape];

    s->separates = separates(&r->state);
    s->inside = r->state.inside;
    s->outside = r->state.outside;
    return lightsource_shine(r, area, shape, at);
}

/* ---- media ---- */

static const OptDef homogeneous[] = {
    { .key = "sigma_a", .type = OPT_RGB, .num = -1, .lo = -1, .hi = 1e30,
      .help = "absorption, per scene unit; if not given, that of the language" },
    { .key = "sigma_s", .type = OPT_RGB, .num = -1, .lo = -1, .hi = 1e30,
      .help = "scattering, per scene unit; if not given, that of the language" },
    { .key = "scale", .type = OPT_FLOAT, .num = 1, .lo = 0, .hi = 1e30, .help = "factor of both" },
    { .key = "g", .type = OPT_FLOAT, .num = 0, .lo = -0.999, .hi = 0.999,
      .help = "mean cosine of a scattering" },
    { .key = NULL }
};

static const KindInfo medium_homogeneous = {
    "homogeneous", "HenyeyGreenstein41; PBRT4 11.4", "absorbs and scatters alike everywhere",
    homogeneous
};
const KindInfo *const medium_kinds[] = { &medium_homogeneous, NULL };

/* What the language says where nothing is given: milk, roughly, in millimetres. [PBRT4 B.2.8] */
static bool medium_make(Reader *r, const char *name, Params *ps)
{
    double room[PARAMS_MAX + DEFAULTS_MAX][3];
    Medium m;
    Opts o;
    uint32_t index;
    float scale;

    params_fit(ps, homogeneous, room);
    opts_default(&o, homogeneous);
    if (!opts_params(&o, "medium", ps))
        return false;
    scale = opt_float(&o, "scale");
    m.absorption = opt_rgb(&o, "sigma_a");
    m.scattering = opt_rgb(&o, "sigma_s");
    if (m.absorption.r < 0)
        m.absorption = rgb(0.0011f, 0.0024f, 0.014f);
    if (m.scattering.r < 0)
        m.scattering = rgb(2.55f, 3.21f, 3.77f);
    m.absorption = rgb_scale(m.absorption, scale);
    m.scattering = rgb_scale(m.scattering, scale);
    m.g = opt_float(&o, "g");
    m.name = arena_string(&r->scene->arena, name, strlen(name));
    return m.name && scene_add_medium(r->scene, &m, &index) &&
           names_set(&r->media, &r->out->arena, m.name, index);
}

static const char *type_of(const Params *ps)
{
    const Param *p = params_find(ps, "type", NULL);
    return p && p->kind == PARAM_STRING && p->n == 1 ? p->strings[0] : "homogeneous";
}

/* MakeNamedMedium "name" "string type" "homogeneous" ... */
bool do_make_named_medium(Reader *r, Place at)
{
    Param list[PARAMS_MAX + DEFAULTS_MAX];
    Params ps, all;
    Token t;
    char *name;

    if (!reader_string(r, "the name of the medium", &t) ||
        !(name = reader_keep(&r->out->arena, &t)) || !params_read(r, SPECTRUM_ALBEDO, &ps))
        return false;
    params_with_defaults(r, TARGET_MEDIUM, &ps, list, &all);
    if (strcmp(type_of(&all), "homogeneous"))
        return warn_at(at, "media of type '%.60s' are not supported; it is left out",
                       type_of(&all)) &&
               names_set(&r->media, &r->out->arena, name, MEDIUM_LEFT_OUT);
    return medium_make(r, name, &all);
}

/* "" is nothing; so is one that could not be made. */
static bool find_medium(Reader *r, const Token *t, uint32_t *index)
{
    char *name = reader_text(r, t), hint[HINT_MAX];

    *index = NO_MEDIUM;
    if (!name)
        return false;
    if (!*name)
        return true;
    *index = names_find(&r->media, name);
    if (*index == NAME_NONE) {
        *index = NO_MEDIUM;
        return warn_at(t->at, "unknown medium '%.80s'%s; nothing is there", name,
                       names_hint(&r->media, name, hint));
    }
    if (*index == MEDIUM_LEFT_OUT)
        *index = NO_MEDIUM;
    return true;
}

/* MediumInterface "inside" "outside"; one name alone is both. */
bool do_medium_interface(Reader *r, Place at)
{
    Token t;

    (void)at;
    if (!reader_string(r, "the name of the inner medium", &t) ||
        !find_medium(r, &t, &r->state.inside) || !reader_peek(r, &t))
        return false;
    r->state.outside = r->state.inside;
    return t.kind != TOKEN_STRING ||
           (reader_next(r, &t) && find_medium(r, &t, &r->state.outside));
}

/* principled.c -- a material by what it looks like (metallic, rough, coated, clear), as many
 * programs describe one: a mixture of models that each keep energy and are reciprocal, and so does
 * the whole.
 *
 * Source  [Burley12] and what version 3 of the scene language makes of it ("disney"), with its
 *         names: alpha = roughness^2 / aspect and roughness^2 aspect, aspect = sqrt(1 - 0.9
 *         anisotropic); a part `metallic` is a conductor of that colour; of the rest a part
 *         `spectrans` is glass, tinted by the root of the colour since light passes twice, and what
 *         is left a matt surface under a coat. A part of clearcoat / 4 of metal and of matt surface
 *         has a coat of its own, of alpha 0.1 - 0.099 clearcoatgloss.
 *
 * Departs lobes are ours, not those of [Burley12], which are not all reciprocal and may return more
 *         than they get. There is no model of sheen, of flatness or of thin sheets, no tint of a
 *         coat, and nothing below the surface: one warning names what a scene asks for of these. */
#include "scenefile/textures.h"

#include <string.h>

/* ---- the parts ---- */

typedef struct { const Texture *au, *av, *gloss; } Alphas;

static bool constant(Reader *r, float x, const Texture **t)
{
    *t = texture_constant(r, rgb_all(x));
    return *t != NULL;
}

static bool scaled(Reader *r, const Texture *a, float x, const Texture **t)
{
    const Texture *k;
    return constant(r, x, &k) && (*t = texture_product(r, a, k)) != NULL;
}

static bool alphas_of(Reader *r, const Principled *p, Alphas *a)
{
    float aspect = sqrtf(1.0f - 0.9f * clamp01(p->anisotropic));
    const Texture *square = texture_product(r, p->roughness, p->roughness);

    return square && scaled(r, square, 1.0f / aspect, &a->au) &&
           scaled(r, square, aspect, &a->av) &&
           constant(r, 0.1f - 0.099f * clamp01(p->gloss), &a->gloss);
}

/* A material of that model, for the options to be put into. */
static bool part(Reader *r, Place at, const char *kind, uint32_t *index)
{
    Param unused;
    Params none = { &unused, 0 };
    const Texture *no;

    if (!constant(r, 0.0f, &no) || !material_make(r, at, kind, &none, "", index))
        return false;
    material_put(&r->scene->materials[*index], "remaproughness", no);
    return true;
}

static Material *made(Reader *r, uint32_t index) { return &r->scene->materials[index]; }

static bool metal(Reader *r, Place at, const Principled *p, const Alphas *a, bool coated,
                  uint32_t *index)
{
    if (!part(r, at, coated ? "coatedconductor" : "conductor", index))
        return false;
    material_put(made(r, *index), "reflectance", p->color);
    material_put(made(r, *index), coated ? "conductor.uroughness" : "uroughness", a->au);
    material_put(made(r, *index), coated ? "conductor.vroughness" : "vroughness", a->av);
    if (coated)
        material_put(made(r, *index), "interface.roughness", a->gloss);
    return true;
}

static bool matt(Reader *r, Place at, const Principled *p, const Alphas *a, bool coated,
                 uint32_t *index)
{
    const Texture *eta;

    if (!constant(r, p->eta, &eta) || !part(r, at, "coateddiffuse", index))
        return false;
    material_put(made(r, *index), "reflectance", p->color);
    material_put(made(r, *index), "eta", eta);
    material_put(made(r, *index), "uroughness", coated ? a->gloss : a->au);
    material_put(made(r, *index), "vroughness", coated ? a->gloss : a->av);
    return true;
}

static bool glass(Reader *r, Place at, const Principled *p, const Alphas *a, uint32_t *index)
{
    const Texture *eta;
    Texture *root = texture_new(r, TEXTURE_ROOT);

    if (!root || !constant(r, p->eta, &eta) || !part(r, at, "dielectric", index))
        return false;
    root->a = p->color;
    material_put(made(r, *index), "transmittance", root);
    material_put(made(r, *index), "eta", eta);
    material_put(made(r, *index), "uroughness", a->au);
    material_put(made(r, *index), "vroughness", a->av);
    return true;
}

/* ---- the whole ---- */

static bool is_all(const Texture *t, float value)
{
    return t->kind == TEXTURE_CONSTANT && rgb_min(t->value) == value && rgb_max(t->value) == value;
}

/* A surface, a part of which has a coat besides. */
typedef bool (*Maker)(Reader *r, Place at, const Principled *p, const Alphas *a, bool coated,
                      uint32_t *index);
static bool with_coat(Reader *r, Place at, Maker maker, const Principled *p, const Alphas *a,
                      uint32_t *index)
{
    const Texture *amount;
    uint32_t coated, bare;

    if (is_all(p->clearcoat, 0.0f))
        return maker(r, at, p, a, false, index);
    return scaled(r, p->clearcoat, 0.25f, &amount) && maker(r, at, p, a, true, &coated) &&
           maker(r, at, p, a, false, &bare) && material_mix(r, amount, coated, bare, index);
}

/* All of it would be nine models, which is more than a mixture may have. */
static bool coat_that_fits(Reader *r, Place at, Principled *p)
{
    bool all = !is_all(p->metallic, 0.0f) && !is_all(p->metallic, 1.0f) &&
               !is_all(p->spectrans, 0.0f) && !is_all(p->spectrans, 1.0f);

    if (!all || is_all(p->clearcoat, 0.0f))
        return true;
    return constant(r, 0.0f, &p->clearcoat) &&
           warn_at(at, "a material with metal, glass and clear coat at once: the coat is left out");
}

bool principled_make(Reader *r, Place at, const Principled *in, const char *name, uint32_t *index)
{
    Principled p = *in;
    uint32_t rest = 0, other;
    Alphas a;

    if (!coat_that_fits(r, at, &p) || !alphas_of(r, &p, &a))
        return false;
    if (!is_all(p.metallic, 1.0f)) {
        if (!is_all(p.spectrans, 1.0f) && !with_coat(r, at, matt, &p, &a, &rest))
            return false;
        if (!is_all(p.spectrans, 0.0f) &&
            (!glass(r, at, &p, &a, &other) || !material_mix(r, p.spectrans, other, rest, &rest)))
            return false;
    }
    if (!is_all(p.metallic, 0.0f) && (!with_coat(r, at, metal, &p, &a, &other) ||
                                      !material_mix(r, p.metallic, other, rest, &rest)))
        return false;
    *index = rest;
    made(r, rest)->name = arena_string(&r->scene->arena, name, strlen(name));
    return made(r, rest)->name != NULL;
}

/* ---- disney ---- */

/* In *t, or the number `otherwise` if it is not given. */
static bool value_or(Reader *r, const Params *ps, const char *name, float otherwise,
                     const Texture **t)
{
    return material_value(r, ps, name, t) && (*t || constant(r, otherwise, t));
}

static bool warn_of_missing(Place at, const Params *ps)
{
    static const char *const names[] = { "sheen", "flatness", "speculartint", "scatterdistance",
                                         "thin" };
    static const char *const known[] = { "sheentint", "difftrans", "remaproughness", "type" };
    char list[100] = "";
    size_t n = 0;

    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (params_given(ps, names[i])) {
            memcpy(list + n, n ? ", " : "  ", 2);
            n += 2;
            memcpy(list + n, names[i], strlen(names[i]) + 1);
            n += strlen(names[i]);
        }
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        params_find(ps, known[i], NULL);
    return !n || warn_at(at, "disney is a mixture of models that have no%s; left out", list + 1);
}

static bool warn_of_unknown(const Params *ps)
{
    for (size_t i = 0; i < ps->n; i++)
        if (!ps->p[i].used && !warn_at(ps->p[i].at, "disney has no parameter '%.60s'; it is left "
                                       "out", ps->p[i].name))
            return false;
    return true;
}

bool disney_make(Reader *r, Place at, const Params *ps, const char *name, uint32_t *index)
{
    Principled p;
    double eta = 1.5, anisotropic = 0, gloss = 1;
    const char *const type = "disney";

    material_extras_known(ps, type);
    if (!value_or(r, ps, "color", 0.5f, &p.color) ||
        !value_or(r, ps, "metallic", 0, &p.metallic) ||
        !value_or(r, ps, "roughness", 0.5f, &p.roughness) ||
        !value_or(r, ps, "spectrans", 0, &p.spectrans) ||
        !value_or(r, ps, "clearcoat", 0, &p.clearcoat) || !params_numbers(ps, "eta", 1, &eta) ||
        !params_numbers(ps, "anisotropic", 1, &anisotropic) ||
        !params_numbers(ps, "clearcoatgloss", 1, &gloss) || !warn_of_missing(at, ps) ||
        !warn_of_unknown(ps))
        return false;
    p.eta = (float)eta;
    p.anisotropic = (float)anisotropic;
    p.gloss = (float)gloss;
    return principled_make(r, at, &p, name, index) &&
           material_extras(r, type, ps, &r->scene->materials[*index]);
}

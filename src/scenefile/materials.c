/* materials.c -- Material, MakeNamedMaterial and NamedMaterial. A name that is a model of bsdf/ is
 * that model, with its own table of parameters; other names of the language stand in the table
 * below with the model that they mean, or with a warning the nearest one.
 *
 * What stands for what, where that is not plain: plastic and uber are a matt base under a coat, the
 * coat scaled by Ks, so that they keep energy; substrate is the Fresnel blend of Ashikhmin and
 * Shirley with exponents as wide as the roughness asks for; of translucent only the matt part is
 * there. Roughness of version 3 becomes the alpha of facets by its own formula, as long as no
 * texture gives it.
 *
 * disney is in principled.c.
 *
 * "", "none" and "interface" mark surfaces that only separate media, see surfaces.c. */
#include "scenefile/textures.h"

#include <string.h>

enum { MATERIAL_PARAMS = PARAMS_MAX + DEFAULTS_MAX + 8 };

typedef struct { const char *from, *to; } Rename;
typedef struct { const char *name; double value; } Preset;
typedef enum { STAND_IN, MEANT, MEANT_V3 } Match;      /* how well the model fits the name */

typedef struct {
    const char *name, *kind;
    Match  match;               /* STAND_IN: warned of; V3: roughness is that of version 3 */
    Rename renames[6];          /* where the model's table does not know the old names itself */
    Preset presets[3];          /* what the language says where a parameter is not given */
} Alias;

static const Alias aliases[] = {
    { "matte", "diffuse", MEANT, { { "Kd", "reflectance" } }, { { "reflectance", 0.5 } } },
    { "glass", "dielectric", MEANT_V3,
      { { "Kr", "reflectance" }, { "Kt", "transmittance" }, { "index", "eta" } },
      { { "eta", 1.5 } } },
    { "metal", "conductor", MEANT_V3, { { NULL, NULL } }, { { "roughness", 0.01 } } },
    { "plastic", "coateddiffuse", MEANT_V3, { { "Kd", "reflectance" }, { "Ks", "specular" } },
      { { "reflectance", 0.25 }, { "specular", 0.25 }, { "roughness", 0.1 } } },
    { "substrate", "ashikhminshirley", MEANT_V3,
      { { "Kd", "reflectance" }, { "Ks", "specular" } },
      { { "reflectance", 0.5 }, { "specular", 0.5 }, { "roughness", 0.1 } } },
    { "uber", "coateddiffuse", MEANT_V3,
      { { "Kd", "reflectance" }, { "Ks", "specular" }, { "index", "eta" } },
      { { "reflectance", 0.25 }, { "specular", 0.25 }, { "roughness", 0.1 } } },
    { "translucent", "diffusetransmission", MEANT, { { "Kd", "reflectance" } },
      { { "reflectance", 0.25 } } },
    { "kdsubsurface", "coateddiffuse", STAND_IN, { { "Kd", "reflectance" } },
      { { "reflectance", 0.5 } } },
    { "subsurface", "coateddiffuse", STAND_IN, { { NULL, NULL } }, { { "reflectance", 0.5 } } },
    { "hair", "diffuse", STAND_IN, { { "color", "reflectance" } }, { { "reflectance", 0.3 } } },
    { "measured", "diffuse", STAND_IN, { { NULL, NULL } }, { { "reflectance", 0.5 } } },
    { "fourier", "diffuse", STAND_IN, { { NULL, NULL } }, { { "reflectance", 0.5 } } },
};
enum { NALIASES = sizeof aliases / sizeof *aliases };

static const Alias *find_alias(const char *name)
{
    for (int i = 0; i < NALIASES; i++)
        if (!strcmp(aliases[i].name, name))
            return &aliases[i];
    return NULL;
}

/* ---- the parameters of another name ---- */

typedef struct {                /* a list of parameters that may grow */
    Param  p[MATERIAL_PARAMS];
    double number[MATERIAL_PARAMS][3];
    size_t n;
    Place  at;
} List;

static Param *find_param(List *l, const char *name)
{
    for (size_t i = 0; i < l->n; i++)
        if (!strcmp(l->p[i].name, name))
            return &l->p[i];
    return NULL;
}

static void add_number(List *l, const char *name, const double *v, size_t n)
{
    Param *p = &l->p[l->n];
    ASSERT(l->n < MATERIAL_PARAMS);
    memset(p, 0, sizeof *p);
    memcpy(l->number[l->n], v, n * sizeof *v);
    p->name = name;
    p->type = n == 3 ? "rgb" : "float";
    p->kind = PARAM_FLOAT;
    p->at = l->at;
    p->n = n;
    p->numbers = l->number[l->n++];
}

static void apply_alias(List *l, const Alias *a, const BsdfKind *kind)
{
    for (int i = 0; i < 6 && a->renames[i].from; i++) {
        Param *p = find_param(l, a->renames[i].from);
        if (p && !find_param(l, a->renames[i].to) &&
            material_option(kind, a->renames[i].to) >= 0)
            p->name = a->renames[i].to;
    }
    for (int i = 0; i < 3 && a->presets[i].name; i++)
        if (!find_param(l, a->presets[i].name) &&
            material_option(kind, a->presets[i].name) >= 0 &&
            (strcmp(a->presets[i].name, "roughness") || !find_param(l, "uroughness")))
            add_number(l, a->presets[i].name, &a->presets[i].value, 1);
}

/* ---- roughness of version 3 ---- */

/* alpha of a roughness: a fit that version 3 makes in the logarithm. */
static double alpha_of(double roughness)
{
    double x = md_log(roughness < 1e-3 ? 1e-3 : roughness);
    return 1.62142 + x * (0.819955 + x * (0.1734 + x * (0.0171201 + x * 0.000640711)));
}

/* Numbers become alphas, unless a texture gives one of them or the file says that they are. */
static void apply_remap(List *l, bool zero_is_smooth)
{
    static const char *const names[3] = { "roughness", "uroughness", "vroughness" };
    static const double no = 0;
    Param *remap = find_param(l, "remaproughness"), *p;

    if (remap && (remap->kind != PARAM_BOOL || remap->n != 1 || remap->numbers[0] == 0))
        return;
    for (int i = 0; i < 3; i++)
        if ((p = find_param(l, names[i])) &&
            ((p->kind != PARAM_FLOAT && p->kind != PARAM_INT) || p->n != 1))
            return;
    if (!find_param(l, names[0]) && !find_param(l, names[1]) && !find_param(l, names[2]))
        return;
    for (int i = 0; i < 3; i++)
        if ((p = find_param(l, names[i])) && !(zero_is_smooth && p->numbers[0] == 0) &&
            p->numbers[0] >= 0 && p->numbers[0] <= 1) {
            double *own = l->number[p - l->p];
            own[0] = d_min(alpha_of(p->numbers[0]), 1);
            p->numbers = own;
            p->kind = PARAM_FLOAT;
        }
    if (!remap) {
        add_number(l, "remaproughness", &no, 1);
        remap = &l->p[l->n - 1];
        remap->type = "bool";
        remap->kind = PARAM_BOOL;
    }
    remap->numbers = l->number[remap - l->p];
    l->number[remap - l->p][0] = 0;
}

/* ---- making one ---- */

/* The material without its place in the scene. The caller clears it, also after a failure. */
static bool fill(Reader *r, Place at, const BsdfKind *kind, const char *what, List *l, Material *m)
{
    double room[MATERIAL_PARAMS][3];
    Params ps = { l->p, l->n };
    const char *file;
    BsdfFiles files;
    Making making;
    Opts o;

    material_extras_known(&ps, what);
    params_fit(&ps, kind->info.options, room);
    opts_default(&o, kind->info.options);
    if (!opts_params(&o, what, &ps) || !params_string(&ps, "filename", NULL, &file) ||
        !reader_making(r, at, file, &making))
        return false;
    files.beside = making.at.file;
    files.max_file = making.max_file;
    return material_init(m, kind, &o, &files) && material_textures(r, m, &o) &&
           material_extras(r, what, &ps, m);
}

/* Of parts that let rays pass: those that a mixture stops are its mean, see material.h. */
static bool mixture_opacity(Reader *r, Material *m)
{
    const Texture *part[2];
    Texture *t;

    for (int k = 0; k < 2; k++)
        part[k] = r->scene->materials[m->part[k]].opacity;
    if (!part[0] && !part[1])
        return true;
    t = texture_new(r, TEXTURE_MIX);
    if (!t)
        return false;
    t->b = part[0] ? part[0] : texture_constant(r, rgb_all(1.0f));
    t->a = part[1] ? part[1] : texture_constant(r, rgb_all(1.0f));
    t->c = m->texture[0] ? m->texture[0] : texture_constant(r, m->value[0]);
    m->opacity = t;
    return t->a && t->b && t->c;
}

/* What a mixture has of its parts besides their models. */
static bool material_of_parts(Reader *r, Material *m, const uint32_t *part)
{
    for (int k = 0; k < 2; k++) {
        const Material *of = &r->scene->materials[part[k]];
        m->part[k] = part[k];
        if (!m->bump && !m->normals) {          /* one frame for both */
            m->bump = of->bump;
            m->normals = of->normals;
            m->slope = of->slope;
            m->mirrors = of->mirrors;
        }
    }
    return mixture_opacity(r, m);
}

/* part: the materials that are mixed, or NULL. */
static bool build(Reader *r, Place at, const BsdfKind *kind, const char *what, List *l,
                  const char *name, const uint32_t *part, uint32_t *index)
{
    Material m;

    memset(&m, 0, sizeof m);
    m.kind = kind;                              /* so that it can be cleared */
    if (fill(r, at, kind, what, l, &m) &&
        (m.name = arena_string(&r->scene->arena, name, strlen(name)))) {
        if ((!part || material_of_parts(r, &m, part)) &&
            scene_add_material(r->scene, &m, index))
            return true;
    }
    material_clear(&m);
    return false;
}

bool material_mix(Reader *r, const Texture *amount, uint32_t first, uint32_t second,
                  uint32_t *index)
{
    uint32_t part[2] = { first, second };
    Material m;
    Opts o;

    *index = second;
    if (amount->kind == TEXTURE_CONSTANT && rgb_max(amount->value) <= 0.0f)
        return true;
    *index = first;
    if (amount->kind == TEXTURE_CONSTANT && rgb_min(amount->value) >= 1.0f)
        return true;
    opts_default(&o, bsdf_mix.info.options);
    if (!material_init(&m, &bsdf_mix, &o, NULL))
        return false;
    material_put(&m, "amount", amount);
    return material_of_parts(r, &m, part) && scene_add_material(r->scene, &m, index);
}

static bool unknown_material(Place at, const char *type)
{
    enum { MOST = 64 };
    const char *names[MOST];
    char hint[HINT_MAX];
    size_t n = 0;
    for (; n < NALIASES; n++)
        names[n] = aliases[n].name;
    for (size_t i = 0; bsdfs[i] && n < MOST; i++)
        names[n++] = bsdfs[i]->info.name;
    return warn_at(at, "unknown material '%.60s'%s; the neutral one is used", type,
                   hint_nearest(hint, type, names, n));
}

/* A material to be mixed, by its name; the neutral one after a warning. */
static bool mixed(Reader *r, Place at, const char *name, uint32_t *index)
{
    uint32_t i = name ? names_find(&r->materials, name) : NAME_NONE;
    char hint[HINT_MAX];

    *index = i == NAME_NONE || i == MATERIAL_NONE ? 0 : i;
    if (i == MATERIAL_NONE)
        return warn_at(at, "'%.80s' is not seen, cannot be mixed; the neutral one is used", name);
    return i != NAME_NONE ||
           warn_at(at, "no material is called '%.80s'%s; the neutral one is used",
                   name ? name : "", name ? names_hint(&r->materials, name, hint) : "");
}

/* Version 3 names namedmaterial1 and 2 and weighs the first by `amount`, version 4 has a list and
 * weighs the second. */
static bool mixture(Reader *r, Place at, List *l, const char *name, uint32_t *index)
{
    Params ps = { l->p, l->n };
    const Param *list = params_find(&ps, "materials", NULL);
    const char *names[2] = { NULL, NULL };
    const Material *all;
    uint32_t part[2];

    if (list && list->kind == PARAM_STRING && list->n == 2) {
        names[0] = list->strings[1];
        names[1] = list->strings[0];
    } else if (list)
        return err_at(list->at, "\"materials\" is not right, expected two strings");
    else if (!params_string(&ps, "namedmaterial1", NULL, &names[0]) ||
             !params_string(&ps, "namedmaterial2", NULL, &names[1]))
        return false;
    if (!mixed(r, at, names[0], &part[0]) || !mixed(r, at, names[1], &part[1]))
        return false;
    all = r->scene->materials;
    *index = part[0];
    if (1 + material_size(all, part[0]) + material_size(all, part[1]) > BSDF_PARTS)
        return warn_at(at, "a mixture of more than %d models, mixtures counted; '%.80s' is used",
                       BSDF_PARTS, names[0] ? names[0] : "");
    return build(r, at, &bsdf_mix, "mix", l, name, part, index);
}

static bool is_interface(const char *type)
{
    return !*type || !strcmp(type, "none") || !strcmp(type, "interface");
}

/* measured of version 4 reads files of another format than that of our model. */
static bool is_merl(const Params *ps)
{
    const char *name;
    return params_given(ps, "filename") && params_string(ps, "filename", NULL, &name) &&
           strcmp(path_extension(name), "bsdf") != 0;
}

static const BsdfKind *find_model(const char *type, const Params *ps, const Alias **alias)
{
    const BsdfKind *kind = kind_find(bsdfs, type);

    *alias = !kind || (!strcmp(type, "measured") && !is_merl(ps)) ? find_alias(type) : NULL;
    if (!strcmp(type, "matte") && params_given(ps, "sigma"))
        return kind_find(bsdfs, "orennayar");
    return *alias ? kind_find(bsdfs, (*alias)->kind) : kind;
}

bool material_make(Reader *r, Place at, const char *type, const Params *ps, const char *name,
                   uint32_t *index)
{
    const Alias *alias;
    const BsdfKind *kind = find_model(type, ps, &alias);
    List l;

    *index = is_interface(type) ? MATERIAL_NONE : 0;
    if (is_interface(type))
        return true;
    if (!strcmp(type, "disney"))
        return disney_make(r, at, ps, name, index);
    if (!kind)
        return unknown_material(at, type);
    if (alias && alias->match == STAND_IN &&
        !warn_at(at, "the material '%s' is not supported; %s is used", type, alias->kind))
        return false;
    memcpy(l.p, ps->p, ps->n * sizeof *l.p);
    l.n = ps->n;
    l.at = at;
    if (kind == &bsdf_mix)
        return mixture(r, at, &l, name, index);
    if (alias)
        apply_alias(&l, alias, kind);
    if (alias && alias->match == MEANT_V3)
        apply_remap(&l, !strcmp(type, "glass"));
    if (alias && alias->match == STAND_IN)      /* what the model has not is told by the warning */
        for (size_t i = 0; i < l.n; i++)
            l.p[i].used = true;
    return build(r, at, kind, type, &l, name, NULL, index);
}

/* ---- directives ---- */

bool do_material(Reader *r, Place at)
{
    Token t;
    Param list[PARAMS_MAX + DEFAULTS_MAX];
    Params ps, all;
    char *type;

    if (!reader_string(r, "the kind of material", &t) ||
        !(type = reader_keep(&r->out->arena, &t)) || !params_read(r, SPECTRUM_ALBEDO, &ps))
        return false;
    params_with_defaults(r, TARGET_MATERIAL, &ps, list, &all);
    return material_make(r, at, type, &all, "", &r->state.material);
}

bool do_make_named_material(Reader *r, Place at)
{
    Token t;
    Param list[PARAMS_MAX + DEFAULTS_MAX];
    Params ps, all;
    const char *type;
    char *name;
    uint32_t index;

    if (!reader_string(r, "the name of the material", &t) ||
        !(name = reader_keep(&r->out->arena, &t)) || !params_read(r, SPECTRUM_ALBEDO, &ps))
        return false;
    params_with_defaults(r, TARGET_MATERIAL, &ps, list, &all);
    if (!params_string(&all, "type", NULL, &type))
        return false;
    if (!type)
        return err_at(at, "MakeNamedMaterial needs a \"string type\"");
    if (names_find(&r->materials, name) != NAME_NONE &&
        !warn_at(t.at, "the material '%.80s' is defined again; shapes to come use this one", name))
        return false;
    return material_make(r, at, type, &all, name, &index) &&
           names_set(&r->materials, &r->out->arena, name, index);
}

bool do_named_material(Reader *r, Place at)
{
    Token t;
    char *name, hint[HINT_MAX];
    uint32_t index;

    (void)at;
    if (!reader_string(r, "the name of the material", &t) || !(name = reader_text(r, &t)))
        return false;
    index = names_find(&r->materials, name);
    r->state.material = index == NAME_NONE ? 0 : index;
    if (index != NAME_NONE)
        return true;
    return warn_at(t.at, "no material is called '%.80s'%s; the neutral one is used", name,
                   names_hint(&r->materials, name, hint));
}

/* materials.c -- Material, MakeNamedMaterial and NamedMaterial. A name that is a model of bsdf/ is
 * that model, with its own table of parameters; other names of the language stand in the table
 * below with the nearest model.
 *
 * "", "none" and "interface" mark surfaces that only separate media, see surfaces.c. A mixture
 * is replaced by the part that weighs more. */
#include "scenefile/reader.h"

#include <string.h>

enum { MATERIAL_PARAMS = PARAMS_MAX + DEFAULTS_MAX + 8 };

typedef struct { const char *from, *to; } Rename;
typedef struct { const char *name; double value; } Preset;

typedef struct {
    const char *name, *kind;
    bool   exact;               /* the model is what the name means: nothing to warn of */
    Rename renames[6];          /* where the model's table does not know the old names itself */
    Preset presets[3];          /* what the language says where a parameter is not given */
} Alias;

static const Alias aliases[] = {
    { "matte", "diffuse", true, { { "Kd", "reflectance" } }, { { "reflectance", 0.5 } } },
    { "glass", "dielectric", true,
      { { "Kr", "reflectance" }, { "Kt", "transmittance" }, { "index", "eta" } },
      { { "eta", 1.5 } } },
    { "metal", "conductor", true, { { NULL, NULL } }, { { "roughness", 0.01 } } },
    { "thindielectric", "dielectric", false, { { "index", "eta" } }, { { "eta", 1.5 } } },
    { "plastic", "coateddiffuse", false, { { "Kd", "reflectance" } },
      { { "reflectance", 0.25 }, { "roughness", 0.1 } } },
    { "substrate", "coateddiffuse", false, { { "Kd", "reflectance" } },
      { { "reflectance", 0.5 }, { "roughness", 0.1 } } },
    { "uber", "coateddiffuse", false, { { "Kd", "reflectance" }, { "index", "eta" } },
      { { "reflectance", 0.25 }, { "roughness", 0.1 } } },
    { "disney", "coateddiffuse", false, { { "color", "reflectance" } },
      { { "reflectance", 0.5 }, { "roughness", 0.5 } } },
    { "kdsubsurface", "coateddiffuse", false, { { "Kd", "reflectance" } },
      { { "reflectance", 0.5 } } },
    { "subsurface", "coateddiffuse", false, { { NULL, NULL } }, { { "reflectance", 0.5 } } },
    { "translucent", "diffuse", false, { { "Kd", "reflectance" } }, { { "reflectance", 0.25 } } },
    { "diffusetransmission", "diffuse", false, { { NULL, NULL } }, { { "reflectance", 0.25 } } },
    { "hair", "diffuse", false, { { "color", "reflectance" } }, { { "reflectance", 0.3 } } },
    { "measured", "diffuse", false, { { NULL, NULL } }, { { "reflectance", 0.5 } } },
    { "fourier", "diffuse", false, { { NULL, NULL } }, { { "reflectance", 0.5 } } },
    { "coatedconductor", "conductor", false,
      { { "conductor.eta", "eta" }, { "conductor.k", "k" }, { "conductor.roughness", "roughness" },
        { "conductor.uroughness", "uroughness" }, { "conductor.vroughness", "vroughness" } },
      { { NULL, 0 } } },
};
enum { NALIASES = sizeof aliases / sizeof *aliases };

static const Alias *find_alias(const char *name)
{
    for (int i = 0; i < NALIASES; i++)
        if (!strcmp(aliases[i].name, name))
            return &aliases[i];
    return NULL;
}

static const OptDef *find_def(const OptDef *defs, const char *key)
{
    for (; defs && defs->key; defs++)
        if (!strcmp(defs->key, key))
            return defs;
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
        if (p && !find_param(l, a->renames[i].to) && find_def(kind->info.options, a->renames[i].to))
            p->name = a->renames[i].to;
    }
    for (int i = 0; i < 3 && a->presets[i].name; i++)
        if (!find_param(l, a->presets[i].name) &&
            find_def(kind->info.options, a->presets[i].name) &&
            (strcmp(a->presets[i].name, "roughness") || !find_param(l, "uroughness")))
            add_number(l, a->presets[i].name, &a->presets[i].value, 1);
}

/* ---- making one ---- */

/* Textures where the table wants numbers: options of colour and of number take them. */
static bool set_textures(Reader *r, Material *m, const Opts *o)
{
    for (int i = 0; i < m->nvalues; i++) {
        const Param *p = o->value[i].param;
        OptType type = o->defs[i].type;
        const Texture *t;
        if (!p || p->kind != PARAM_TEXTURE)
            continue;
        if ((type != OPT_RGB && type != OPT_FLOAT) || p->n != 1)
            return err_at(p->at, "\"%s\" is not right, a texture cannot give it", p->name);
        if (!texture_find(r, p->at, p->strings[0], type == OPT_RGB, &t))
            return false;
        if (t && t->kind == TEXTURE_CONSTANT)
            m->value[i] = t->value;
        else if (t) {
            m->texture[i] = t;
            m->textured = true;
        }
    }
    return true;
}

static bool build(Reader *r, const BsdfKind *kind, const char *what, List *l, const char *name,
                  uint32_t *index)
{
    double room[MATERIAL_PARAMS][3];
    Params ps = { l->p, l->n };
    Material m;
    Opts o;

    params_fit(&ps, kind->info.options, room);
    opts_default(&o, kind->info.options);
    if (!opts_params(&o, what, &ps))
        return false;
    memset(&m, 0, sizeof m);
    material_init(&m, kind, &o);
    m.name = arena_string(&r->scene->arena, name, strlen(name));
    return m.name && set_textures(r, &m, &o) && scene_add_material(r->scene, &m, index);
}

static bool unknown_material(Place at, const char *type)
{
    enum { MOST = 64 };
    const char *names[MOST], *near;
    size_t n = 0;
    for (; n < NALIASES; n++)
        names[n] = aliases[n].name;
    for (size_t i = 0; bsdfs[i] && n < MOST; i++)
        names[n++] = bsdfs[i]->info.name;
    near = nearest_name(type, names, n);
    return warn_at(at, "unknown material '%.60s'%s%s%s; the neutral one is used", type,
                   near ? ", did you mean '" : "", near ? near : "", near ? "'?" : "");
}

/* The named material of a mixture that weighs more, or the neutral one. */
static bool mixture(Reader *r, Place at, const Params *ps, uint32_t *index)
{
    const Param *list = params_find(ps, "materials", NULL);
    const Param *amount = params_find(ps, "amount", NULL);
    const char *name[2] = { NULL, NULL };
    bool v4 = list && list->kind == PARAM_STRING && list->n == 2, second;
    double k = 0.5;

    if (v4) {
        name[0] = list->strings[0];
        name[1] = list->strings[1];
    } else if (!params_string(ps, "namedmaterial1", NULL, &name[0]) ||
               !params_string(ps, "namedmaterial2", NULL, &name[1]))
        return false;
    if (amount && amount->kind == PARAM_FLOAT)
        k = amount->n == 3 ? (amount->numbers[0] + amount->numbers[1] + amount->numbers[2]) / 3
                           : amount->numbers[0];
    second = v4 ? k > 0.5 : k < 0.5;            /* version 3 weighs the first by `amount` */
    *index = name[second] ? names_find(&r->materials, name[second]) : NAME_NONE;
    if (*index == NAME_NONE) {
        *index = 0;
        return warn_at(at, "mixed materials are not supported; the neutral one is used");
    }
    return warn_at(at, "mixed materials are not supported; '%.80s' is used", name[second]);
}

static bool is_interface(const char *type)
{
    return !*type || !strcmp(type, "none") || !strcmp(type, "interface");
}

static const BsdfKind *find_model(const char *type, const Alias **alias)
{
    const BsdfKind *kind = kind_find(bsdfs, type);
    *alias = kind ? NULL : find_alias(type);
    return *alias ? kind_find(bsdfs, (*alias)->kind) : kind;
}

bool material_make(Reader *r, Place at, const char *type, const Params *ps, const char *name,
                   uint32_t *index)
{
    const Alias *alias;
    const BsdfKind *kind = find_model(type, &alias);
    List l;

    *index = is_interface(type) ? MATERIAL_NONE : 0;
    if (is_interface(type))
        return true;
    if (!strcmp(type, "mix"))
        return mixture(r, at, ps, index);
    if (!kind)
        return unknown_material(at, type);
    if (alias && !alias->exact &&
        !warn_at(at, "the material '%s' is not supported; %s is used", type, alias->kind))
        return false;
    memcpy(l.p, ps->p, ps->n * sizeof *l.p);
    l.n = ps->n;
    l.at = at;
    if (alias)
        apply_alias(&l, alias, kind);
    if (alias && !alias->exact)                 /* what the model has not is told by the warning */
        for (size_t i = 0; i < l.n; i++)
            l.p[i].used = true;
    return build(r, kind, type, &l, name, index);
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
    char *name;
    const char *near;
    uint32_t index;

    (void)at;
    if (!reader_string(r, "the name of the material", &t) || !(name = reader_text(r, &t)))
        return false;
    index = names_find(&r->materials, name);
    r->state.material = index == NAME_NONE ? 0 : index;
    if (index != NAME_NONE)
        return true;
    near = names_nearest(&r->materials, name);
    return warn_at(t.at, "no material is called '%.80s'%s%s%s; the neutral one is used", name,
                   near ? ", did you mean '" : "", near ? near : "", near ? "'?" : "");
}

/* materialuse.c -- what a material may have besides the numbers of its model: textures in their
 * place, bumps, opacity, and factors that no table has. See reader.h.
 *
 * A texture that is the same everywhere becomes a number. */
#include "scenefile/textures.h"

#include <string.h>

/* ---- textures ---- */

/* What option k is, as a texture, and back. NULL: out of memory. */
static const Texture *as_texture(Reader *r, const Material *m, int k)
{
    return m->texture[k] ? m->texture[k] : texture_constant(r, m->value[k]);
}
static void set_texture(Material *m, int k, const Texture *t)
{
    m->texture[k] = t->kind == TEXTURE_CONSTANT ? NULL : t;
    if (t->kind == TEXTURE_CONSTANT)
        m->value[k] = t->value;
    m->textured = m->textured || m->texture[k];
}

/* Textures where the table wants numbers: options of colour and of number take them. */
bool material_textures(Reader *r, Material *m, const Opts *o)
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
        if (t)
            set_texture(m, i, t);
    }
    return true;
}

int material_option(const BsdfKind *kind, const char *key)
{
    const OptDef *defs = kind->info.options;

    for (int k = 0; defs && defs[k].key; k++)
        if (!strcmp(defs[k].key, key))
            return k;
    return -1;
}

void material_put(Material *m, const char *key, const Texture *t)
{
    int k = material_option(m->kind, key);

    ASSERT(k >= 0);
    set_texture(m, k, t);
}

bool material_value(Reader *r, const Params *ps, const char *name, const Texture **t)
{
    const Param *p = params_find(ps, name, NULL);

    *t = NULL;
    if (!p)
        return true;
    if (p->kind == PARAM_TEXTURE && p->n == 1)
        return texture_find(r, p->at, p->strings[0], strcmp(p->type, "float") != 0, t);
    if (p->kind != PARAM_FLOAT || (p->n != 1 && p->n != 3))
        return err_at(p->at, "\"%s\" is not right, expected a number, a colour or a texture", name);
    *t = texture_constant(r, rgb((float)p->numbers[0], (float)p->numbers[p->n == 3 ? 1 : 0],
                                 (float)p->numbers[p->n == 3 ? 2 : 0]));
    return *t != NULL;
}

/* ---- what any material may have besides its model ---- */

static bool set_bump(Reader *r, const Params *ps, Material *m)
{
    const char *name = params_find(ps, "displacement", NULL) ? "displacement" : "bumpmap";
    const Texture *t;

    if (!material_value(r, ps, name, &t))
        return false;
    m->bump = t && t->kind != TEXTURE_CONSTANT ? t : NULL;
    return true;
}

static bool set_normals(Reader *r, const Params *ps, Material *m)
{
    const Param *p = params_find(ps, "normalmap", NULL);
    const char *name;

    if (!params_string(ps, "normalmap", NULL, &name))
        return false;
    if (!name || !*name)
        return true;
    if (!image_can_read(name))
        return warn_at(p->at, "pictures of the kind of '%.80s' cannot be read; the surface stays "
                       "even (another program can convert it to PNG)", name);
    m->slope = 1.0f;
    m->normals = texture_data(r, p->at, name);
    return m->normals != NULL;
}

/* uber of version 3 may let a part of the light pass. */
static bool set_opacity(Reader *r, const Params *ps, Material *m)
{
    const Texture *t;
    if (!material_value(r, ps, "opacity", &t))
        return false;
    if (t && (t->kind != TEXTURE_CONSTANT || rgb_lum(t->value) < 1.0f))
        m->opacity = t;
    return true;
}

/* translucent of version 3: Kd is shared out by `reflect` and `transmit`. */
static bool set_translucent(Reader *r, const Params *ps, Material *m)
{
    static const char *const names[2] = { "reflect", "transmit" };
    const Texture *kd = as_texture(r, m, 0), *part[2];

    for (int k = 0; k < 2; k++) {
        if (!kd || !material_value(r, ps, names[k], &part[k]))
            return false;
        if (!part[k] && !(part[k] = texture_constant(r, rgb_all(0.5f))))
            return false;
        if (!(part[k] = texture_product(r, kd, part[k])))
            return false;
        set_texture(m, k, part[k]);
    }
    return true;
}

/* diffusetransmission of version 4: both colours times `scale`. */
static bool set_scale(Reader *r, const Params *ps, Material *m)
{
    const Texture *scale, *t;

    if (!material_value(r, ps, "scale", &scale))
        return false;
    for (int k = 0; scale && k < 2; k++) {
        if (!(t = as_texture(r, m, k)) || !(t = texture_product(r, t, scale)))
            return false;
        set_texture(m, k, t);
    }
    return true;
}

/* The coats of version 4: thickness says nothing of a clear one, and the rest how to compute. */
static bool is_coated(const char *type)
{
    return !strcmp(type, "coateddiffuse") || !strcmp(type, "coatedconductor");
}

static bool set_coat(const Params *ps)
{
    const Param *p = params_find(ps, "albedo", NULL);
    bool clear = !p || (p->kind == PARAM_FLOAT && p->n > 0);

    for (size_t i = 0; p && clear && i < p->n; i++)
        clear = p->numbers[i] == 0;
    return clear || warn_at(p->at, "coats are clear; what is in this one (albedo) is left out");
}

bool material_extras(Reader *r, const char *type, const Params *ps, Material *m)
{
    return set_bump(r, ps, m) && set_normals(r, ps, m) && (!is_coated(type) || set_coat(ps)) &&
           (strcmp(type, "uber") || set_opacity(r, ps, m)) &&
           (strcmp(type, "translucent") || set_translucent(r, ps, m)) &&
           (strcmp(type, "diffusetransmission") || set_scale(r, ps, m));
}

/* The parameters that material_extras looks at are no faults of the table. */
void material_extras_known(const Params *ps, const char *type)
{
    static const char *const rows[][2] = {
        { "", "displacement" }, { "", "bumpmap" }, { "", "normalmap" }, { "uber", "opacity" },
        { "translucent", "reflect" }, { "translucent", "transmit" },
        { "diffusetransmission", "scale" }
    };
    static const char *const coat[] = { "albedo", "g", "thickness", "maxdepth", "nsamples" };

    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (!*rows[i][0] || !strcmp(rows[i][0], type))
            params_find(ps, rows[i][1], NULL);
    for (size_t i = 0; is_coated(type) && i < sizeof coat / sizeof *coat; i++)
        params_find(ps, coat[i], NULL);
}

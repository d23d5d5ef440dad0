/* textures.c -- textures and their names, and the Texture directive: its classes, of constants and
 * other textures. Pictures are in imagemaps.c. */
#include "scenefile/textures.h"

#include <string.h>

/* ---- made and found ---- */

Texture *texture_new(Reader *r, TextureKind kind)
{
    Texture *t = arena_take(&r->scene->arena, 1, sizeof *t);
    if (t) {
        t->kind = kind;
        t->value = rgb_all(1);
        t->map.su = t->map.sv = 1;
    }
    return t;
}

const Texture *texture_constant(Reader *r, Rgb value)
{
    Texture *t = texture_new(r, TEXTURE_CONSTANT);
    if (t)
        t->value = value;
    return t;
}

const Texture *texture_product(Reader *r, const Texture *a, const Texture *b)
{
    Texture *t;
    if (a->kind == TEXTURE_CONSTANT && b->kind == TEXTURE_CONSTANT)
        return texture_constant(r, rgb_mul(a->value, b->value));
    t = texture_new(r, TEXTURE_SCALE);
    if (t) {
        t->a = a;
        t->b = b;
    }
    return t;
}

static uint32_t find_index(const Reader *r, const char *name, bool colour)
{
    uint32_t i = names_find(colour ? &r->colour_textures : &r->float_textures, name);
    return i != NAME_NONE ? i : names_find(colour ? &r->float_textures : &r->colour_textures, name);
}

bool texture_find(Reader *r, Place at, const char *name, bool colour, const Texture **t)
{
    uint32_t i = find_index(r, name, colour);
    char hint[HINT_MAX];

    *t = NULL;
    if (i != NAME_NONE) {
        *t = r->textures[i].texture;
        return true;
    }
    names_hint(colour ? &r->colour_textures : &r->float_textures, name, hint);
    return warn_at(at, "unknown texture '%.80s'%s; the parameter is left out", name, hint);
}

/* ---- operands ---- */

/* A parameter that is a number, a colour or a texture. False: reported. */
static bool operand(Build *b, const char *name, float otherwise, const Texture **t)
{
    const Param *p = params_find(b->ps, name, NULL);
    Rgb value = rgb_all(otherwise);

    *t = NULL;
    if (p && p->kind == PARAM_TEXTURE) {
        uint32_t i = find_index(b->r, p->strings[0], b->colour);
        if (p->n != 1)
            return err_at(p->at, "expected one texture");
        if (!texture_find(b->r, p->at, p->strings[0], b->colour, t))
            return false;
        b->cost += i == NAME_NONE ? 0 : b->r->textures[i].cost;
        if (b->cost > TEXTURE_COST_MAX)
            return err_at(p->at, "the texture is made of more than %d others", TEXTURE_COST_MAX);
    } else if (p) {
        if (p->kind != PARAM_FLOAT && p->kind != PARAM_INT)
            return err_at(p->at, "expected a number, a colour or a texture");
        if (p->n != 1 && p->n != 3)
            return err_at(p->at, "expected one number or three");
        value.r = (float)p->numbers[0];
        value.g = (float)p->numbers[p->n == 3 ? 1 : 0];
        value.b = (float)p->numbers[p->n == 3 ? 2 : 0];
    }
    if (!*t)
        *t = texture_constant(b->r, value);
    return *t != NULL;
}

/* ---- one function for each class: *t NULL and true after a warning ---- */

static bool make_constant(Build *b, Place at, const Texture **t)
{
    (void)at;
    return operand(b, "value", 1, t);
}

static bool make_checkerboard(Build *b, Place at, const Texture **t)
{
    double dimension = 2;
    const Param *p = params_find(b->ps, "dimension", NULL);
    Texture *c = texture_new(b->r, TEXTURE_CHECKER);

    (void)at;
    params_find(b->ps, "aamode", NULL);
    if (!c || !operand(b, "tex1", 1, &c->a) || !operand(b, "tex2", 0, &c->b) ||
        !params_numbers(b->ps, "dimension", 1, &dimension) || !texture_mapping(b, c))
        return false;
    if (dimension == 3)
        c->kind = TEXTURE_CHECKER3;
    *t = c;
    return dimension == 2 || dimension == 3 ||
           warn_at(p->at, "a checkerboard has 2 or 3 dimensions; 2 is used");
}

/* Version 3 multiplies tex1 and tex2, version 4 tex and scale. */
static bool make_scale(Build *b, Place at, const Texture **t)
{
    bool v4 = params_find(b->ps, "tex", NULL) || params_find(b->ps, "scale", NULL);
    Texture *s = texture_new(b->r, TEXTURE_SCALE);

    (void)at;
    *t = s;
    return s && operand(b, v4 ? "tex" : "tex1", 1, &s->a) &&
           operand(b, v4 ? "scale" : "tex2", 1, &s->b);
}

static bool make_mix(Build *b, Place at, const Texture **t)
{
    Texture *m = texture_new(b->r, TEXTURE_MIX);

    (void)at;
    *t = m;
    return m && operand(b, "tex1", 0, &m->a) && operand(b, "tex2", 1, &m->b) &&
           operand(b, "amount", 0.5f, &m->c);
}

/* The direction is one of the current transform. */
static bool make_directionmix(Build *b, Place at, const Texture **t)
{
    double dir[3] = { 0, 1, 0 };
    Texture *m = texture_new(b->r, TEXTURE_DIRECTION_MIX);

    (void)at;
    if (!m || !operand(b, "tex1", 0, &m->a) || !operand(b, "tex2", 1, &m->b) ||
        !params_numbers(b->ps, "dir", 3, dir))
        return false;
    m->axis = v_unit(xf_vector(&b->r->state.ctm, v3((float)dir[0], (float)dir[1], (float)dir[2])));
    *t = m;
    return true;
}

static bool make_bilerp(Build *b, Place at, const Texture **t)
{
    Texture *m = texture_new(b->r, TEXTURE_BILERP);

    (void)at;
    *t = m;
    return m && operand(b, "v00", 0, &m->a) && operand(b, "v01", 1, &m->b) &&
           operand(b, "v10", 0, &m->c) && operand(b, "v11", 1, &m->d) && texture_mapping(b, m);
}

static bool make_dots(Build *b, Place at, const Texture **t)
{
    Texture *d = texture_new(b->r, TEXTURE_DOTS);

    (void)at;
    *t = d;
    return d && operand(b, "inside", 1, &d->a) && operand(b, "outside", 0, &d->b) &&
           texture_mapping(b, d);
}

static bool make_uv(Build *b, Place at, const Texture **t)
{
    Texture *u = texture_new(b->r, TEXTURE_UV);

    (void)at;
    *t = u;
    return u && texture_mapping(b, u);
}

/* Noise in the space of the current transform. */
static bool noise_of(Build *b, TextureKind kind, Texture **n)
{
    double octaves = 8, roughness = 0.5;

    *n = texture_new(b->r, kind);
    if (!*n || !params_numbers(b->ps, "octaves", 1, &octaves) ||
        !params_numbers(b->ps, "roughness", 1, &roughness))
        return false;
    (*n)->octaves = (int)d_min(d_max(octaves, 0), TEXTURE_OCTAVES_MAX);
    (*n)->roughness = (float)roughness;
    texture_space(b, *n);
    return true;
}

static bool make_fbm(Build *b, Place at, const Texture **t)
{
    Texture *n;
    bool ok = noise_of(b, TEXTURE_FBM, &n);
    (void)at;
    *t = n;
    return ok;
}

static bool make_wrinkled(Build *b, Place at, const Texture **t)
{
    Texture *n;
    bool ok = noise_of(b, TEXTURE_WRINKLED, &n);
    (void)at;
    *t = n;
    return ok;
}

static bool make_windy(Build *b, Place at, const Texture **t)
{
    Texture *n = texture_new(b->r, TEXTURE_WINDY);
    (void)at;
    *t = n;
    if (n)
        texture_space(b, n);
    return n != NULL;
}

static bool make_marble(Build *b, Place at, const Texture **t)
{
    double scale = 1, variation = 0.2;
    Texture *n;

    (void)at;
    if (!noise_of(b, TEXTURE_MARBLE, &n) || !params_numbers(b->ps, "scale", 1, &scale) ||
        !params_numbers(b->ps, "variation", 1, &variation))
        return false;
    n->scale = (float)scale;
    n->variation = (float)variation;
    *t = n;
    return true;
}

static bool make_nothing(Build *b, Place at, const Texture **t)
{
    (void)t;
    for (size_t i = 0; i < b->ps->n; i++)
        b->ps->p[i].used = true;
    return warn_at(at, "ptex textures are not supported; grey 0.5 is used");
}

static const struct {
    const char *name;
    bool (*make)(Build *b, Place at, const Texture **t);
} classes[] = {
    { "constant", make_constant }, { "imagemap", texture_imagemap },
    { "checkerboard", make_checkerboard }, { "scale", make_scale }, { "mix", make_mix },
    { "directionmix", make_directionmix }, { "bilerp", make_bilerp }, { "dots", make_dots },
    { "uv", make_uv }, { "fbm", make_fbm }, { "wrinkled", make_wrinkled },
    { "windy", make_windy }, { "marble", make_marble }, { "ptex", make_nothing }
};
enum { NCLASSES = sizeof classes / sizeof *classes };

static int find_class(const Token *t)
{
    for (int i = 0; i < NCLASSES; i++)
        if (token_is(t, classes[i].name))
            return i;
    return -1;
}

static bool unknown_class(Reader *r, const Token *t)
{
    const char *names[NCLASSES], *name = reader_text(r, t);
    char hint[HINT_MAX];
    if (!name)
        return false;
    for (int i = 0; i < NCLASSES; i++)
        names[i] = classes[i].name;
    return warn_at(t->at, "unknown class of texture '%.60s'%s; grey 0.5 is used", name,
                   hint_nearest(hint, name, names, NCLASSES));
}

/* Parameters that nothing asked for. */
static bool unused(const Params *ps, int class)
{
    for (size_t i = 0; i < ps->n; i++)
        if (!ps->p[i].used && class >= 0 &&
            !warn_at(ps->p[i].at, "%s textures have no parameter '%.60s'; it is left out",
                     classes[class].name, ps->p[i].name))
            return false;
    return true;
}

static bool enter(Reader *r, Place at, char *name, bool colour, const Texture *t,
                  uint32_t cost)
{
    Names *names = colour ? &r->colour_textures : &r->float_textures;
    NamedTexture entry = { t, cost, r->nstack ? r->stack[r->nstack - 1].block : 0 };
    uint32_t before = names_find(names, name);

    if (before != NAME_NONE && stack_holds(r, r->textures[before].block) &&
        !warn_at(at, "the texture '%.80s' is defined again; shapes to come use this one", name))
        return false;
    return names_set(names, &r->out->arena, name, (uint32_t)r->ntextures) &&
           MEM_PUSH(r->textures, r->ntextures, r->cap_textures, entry);
}

bool do_texture(Reader *r, Place at)
{
    Token type, class, name_token;
    Param list[PARAMS_MAX + DEFAULTS_MAX];
    Params ps, all;
    Build b = { r, &all, false, 1 };
    const Texture *t = NULL;
    char *name;
    int k;

    if (!reader_string(r, "the name of the texture", &name_token) ||
        !(name = reader_keep(&r->out->arena, &name_token)) ||
        !reader_string(r, "the type of the texture", &type) ||
        !reader_string(r, "the class of the texture", &class))
        return false;
    b.colour = token_is(&type, "spectrum") || token_is(&type, "color");
    if (!b.colour && !token_is(&type, "float"))
        return err_at(type.at, "a texture is of type \"float\" or \"spectrum\"");
    k = find_class(&class);
    if (k < 0 && !unknown_class(r, &class))
        return false;
    if (!params_read(r, SPECTRUM_ALBEDO, &ps))
        return false;
    params_with_defaults(r, TARGET_TEXTURE, &ps, list, &all);
    if (k >= 0 && !classes[k].make(&b, at, &t))
        return false;
    if (!t && !(t = texture_constant(r, rgb_all(0.5f))))
        return false;
    return unused(&all, k) && enter(r, at, name, b.colour, t, b.cost);
}

/* textures.c -- the Texture directive. Patterns that the scene cannot evaluate at each point are
 * replaced by a constant, the mean of what they vary between, and a warning says so. */
#include "scenefile/reader.h"

#include <string.h>

static Texture *new_texture(Reader *r, TextureKind kind)
{
    Texture *t = arena_take(&r->scene->arena, 1, sizeof *t);
    if (t) {
        t->kind = kind;
        t->su = t->sv = 1;
    }
    return t;
}

static Texture *constant(Reader *r, Rgb value)
{
    Texture *t = new_texture(r, TEXTURE_CONSTANT);
    if (t)
        t->value = value;
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
    const char *near;

    *t = NULL;
    if (i != NAME_NONE) {
        *t = r->textures[i].texture;
        return true;
    }
    near = names_nearest(colour ? &r->colour_textures : &r->float_textures, name);
    return warn_at(at, "unknown texture '%.80s'%s%s%s; the parameter is left out", name,
                   near ? ", did you mean '" : "", near ? near : "", near ? "'?" : "");
}

/* ---- operands ---- */

typedef struct {                /* of the texture being made */
    Reader *r;
    const Params *ps;
    bool     colour;
    uint32_t cost;
} Build;

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
        *t = constant(b->r, value);
    return *t != NULL;
}

/* Pixels that texture_mean looks at. A texture is a tree of at most TEXTURE_COST_MAX. */
static uint64_t pixels_of(const Texture *t)
{
    uint64_t n = t->kind == TEXTURE_IMAGE ? (uint64_t)t->image->w * t->image->h : 1;
    if (t->kind == TEXTURE_CHECKER || t->kind == TEXTURE_SCALE)
        n += pixels_of(t->a) + pixels_of(t->b);
    return n;
}

/* The mean of a texture, as long as the scene has not asked for too many. */
static bool mean_of(Build *b, Place at, const Texture *t, Rgb *mean)
{
    b->r->averaged += pixels_of(t);
    if (b->r->averaged > AVERAGED_MAX)
        return err_at(at, "means of textures are taken of more than %.0f pixels",
                      (double)AVERAGED_MAX);
    *mean = texture_mean(t);
    return true;
}

static bool operand_mean(Build *b, Place at, const char *name, float otherwise, Rgb *mean)
{
    const Texture *t;
    return operand(b, name, otherwise, &t) && mean_of(b, at, t, mean);
}

/* uscale, vscale, udelta, vdelta; other mappings than that of (u, v) are warned of. */
static bool mapping(Build *b, Texture *t)
{
    double su = 1, sv = 1, du = 0, dv = 0;
    const char *kind;
    const Param *p = params_find(b->ps, "mapping", NULL);

    if (!params_numbers(b->ps, "uscale", 1, &su) || !params_numbers(b->ps, "vscale", 1, &sv) ||
        !params_numbers(b->ps, "udelta", 1, &du) || !params_numbers(b->ps, "vdelta", 1, &dv) ||
        !params_string(b->ps, "mapping", "uv", &kind))
        return false;
    t->su = (float)su;
    t->sv = (float)sv;
    t->du = (float)du;
    t->dv = (float)dv;
    if (!strcmp(kind, "uv"))
        return true;
    params_find(b->ps, "v1", NULL);
    params_find(b->ps, "v2", NULL);
    return warn_at(p->at, "the mapping '%.40s' is not supported; uv is used", kind);
}

/* ---- one function for each class: *t NULL and true after a warning ---- */

static bool make_constant(Build *b, Place at, Texture **t)
{
    Rgb value;
    if (!operand_mean(b, at, "value", 1, &value))
        return false;
    *t = constant(b->r, value);
    return *t != NULL;
}

bool texture_readable(const char *name)
{
    const char *ext = path_extension(name);
    size_t n = strlen(ext);
    for (size_t i = 0; image_formats[i]; i++)
        for (const char *e = image_formats[i]->extensions; n && *e; e += strspn(e, " ")) {
            size_t k = strcspn(e, " ");
            if (k == n && word_is_nocase((Word){ e, k }, ext) && image_formats[i]->read)
                return true;
            e += k;
        }
    return false;
}

Texture *texture_image(Reader *r, Place at, const char *name)
{
    Making m;
    Texture *t;

    if (!texture_readable(name))
        return warn_at(at, "pictures of the kind of '%.80s' cannot be read; grey 0.5 is used", name)
                   ? constant(r, rgb_all(0.5f)) : NULL;
    t = new_texture(r, TEXTURE_IMAGE);
    if (!t || !reader_making(r, at, name, &m) || !(t->image = scene_image(r->scene, &m, name)))
        return NULL;
    t->value = rgb_all(1);
    return t;
}

static bool image_options(Build *b)
{
    static const char *const quality[] = { "filter", "maxanisotropy", "trilinear", "encoding",
                                           "gamma" };
    const char *wrap;
    const Param *p = params_find(b->ps, "wrap", NULL), *invert = params_find(b->ps, "invert", NULL);

    for (size_t i = 0; i < sizeof quality / sizeof *quality; i++)
        params_find(b->ps, quality[i], NULL);
    if (!params_string(b->ps, "wrap", "repeat", &wrap))
        return false;
    if (strcmp(wrap, "repeat") &&
        !warn_at(p->at, "the wrap mode '%.40s' is not supported; repeat is used", wrap))
        return false;
    if (!invert || (invert->kind == PARAM_BOOL && invert->numbers[0] == 0))
        return true;
    return warn_at(invert->at, "images cannot be inverted; 'invert' is left out");
}

static bool make_imagemap(Build *b, Place at, Texture **t)
{
    const char *name;
    Texture *image;
    double scale = 1;

    if (!params_string(b->ps, "filename", NULL, &name))
        return false;
    if (!name)
        return err_at(at, "an imagemap needs a \"string filename\"");
    if (!image_options(b) || !params_numbers(b->ps, "scale", 1, &scale))
        return false;
    image = texture_image(b->r, at, name);
    if (!image || !mapping(b, image))
        return false;
    image->value = rgb_scale(image->value, (float)scale);
    *t = image;
    return true;
}

static bool make_checkerboard(Build *b, Place at, Texture **t)
{
    double dimension = 2;
    Rgb mean;
    Texture *c = new_texture(b->r, TEXTURE_CHECKER);

    params_find(b->ps, "aamode", NULL);
    if (!c || !operand(b, "tex1", 1, &c->a) || !operand(b, "tex2", 0, &c->b) ||
        !params_numbers(b->ps, "dimension", 1, &dimension) || !mapping(b, c))
        return false;
    *t = c;
    if (dimension == 2)
        return true;
    if (!mean_of(b, at, c, &mean))
        return false;
    *t = constant(b->r, mean);
    return *t &&
           warn_at(at, "only two-dimensional checkerboards are supported; their mean is used");
}

/* Version 3 multiplies tex1 and tex2, version 4 tex and scale. */
static bool make_scale(Build *b, Place at, Texture **t)
{
    bool v4 = params_find(b->ps, "tex", NULL) || params_find(b->ps, "scale", NULL);
    Texture *s = new_texture(b->r, TEXTURE_SCALE);

    (void)at;
    if (!s || !operand(b, v4 ? "tex" : "tex1", 1, &s->a) ||
        !operand(b, v4 ? "scale" : "tex2", 1, &s->b))
        return false;
    *t = s;
    return true;
}

static bool make_mix(Build *b, Place at, Texture **t)
{
    Rgb one, two, k, all;

    params_find(b->ps, "dir", NULL);
    if (!operand_mean(b, at, "tex1", 0, &one) || !operand_mean(b, at, "tex2", 1, &two) ||
        !operand_mean(b, at, "amount", 0.5f, &k))
        return false;
    all = rgb_add(rgb_mul(one, rgb_sub(rgb_all(1), k)), rgb_mul(two, k));
    *t = constant(b->r, all);
    return *t && warn_at(at, "mixed textures are not supported; their mean is used");
}

static bool make_bilerp(Build *b, Place at, Texture **t)
{
    Rgb v[4];
    if (!operand_mean(b, at, "v00", 0, &v[0]) || !operand_mean(b, at, "v01", 1, &v[1]) ||
        !operand_mean(b, at, "v10", 0, &v[2]) || !operand_mean(b, at, "v11", 1, &v[3]))
        return false;
    *t = constant(b->r, rgb_scale(rgb_add(rgb_add(v[0], v[1]), rgb_add(v[2], v[3])), 0.25f));
    return *t && warn_at(at, "bilerp textures are not supported; their mean is used");
}

/* Half of the squares have a dot of radius 0.35, so dots cover pi 0.35^2 / 2 of the surface. */
static bool make_dots(Build *b, Place at, Texture **t)
{
    const float part = 0.19242255f;
    Rgb in, out;
    if (!operand_mean(b, at, "inside", 1, &in) || !operand_mean(b, at, "outside", 0, &out))
        return false;
    *t = constant(b->r, rgb_add(rgb_scale(in, part), rgb_scale(out, 1 - part)));
    return *t && warn_at(at, "dots are not supported; their mean is used");
}

static bool make_noise(Build *b, Place at, Texture **t)
{
    *t = constant(b->r, rgb_all(0.5f));
    return *t && warn_at(at, "procedural noise is not supported; grey 0.5 is used");
}

static const struct {
    const char *name;
    bool (*make)(Build *b, Place at, Texture **t);
    bool mapped;                /* takes the parameters of a mapping, though it needs none here */
} classes[] = {
    { "constant", make_constant, false }, { "imagemap", make_imagemap, false },
    { "checkerboard", make_checkerboard, false }, { "scale", make_scale, false },
    { "mix", make_mix, false }, { "directionmix", make_mix, false },
    { "bilerp", make_bilerp, true }, { "dots", make_dots, true }, { "uv", make_noise, true },
    { "fbm", make_noise, true }, { "wrinkled", make_noise, true }, { "windy", make_noise, true },
    { "marble", make_noise, true }, { "ptex", make_noise, true }
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
    const char *names[NCLASSES], *near, *name = reader_text(r, t);
    if (!name)
        return false;
    for (int i = 0; i < NCLASSES; i++)
        names[i] = classes[i].name;
    near = nearest_name(name, names, NCLASSES);
    return warn_at(t->at, "unknown class of texture '%.60s'%s%s%s; grey 0.5 is used", name,
                   near ? ", did you mean '" : "", near ? near : "", near ? "'?" : "");
}

/* Parameters that nothing asked for. */
static bool unused(const Params *ps, int class)
{
    for (size_t i = 0; i < ps->n; i++)
        if (!ps->p[i].used && class >= 0 && !classes[class].mapped &&
            !warn_at(ps->p[i].at, "%s textures have no parameter '%.60s'; it is left out",
                     classes[class].name, ps->p[i].name))
            return false;
    return true;
}

static bool enter(Reader *r, Place at, char *name, bool colour, Texture *t, uint32_t cost)
{
    Names *names = colour ? &r->colour_textures : &r->float_textures;
    NamedTexture entry = { t, cost };

    if (names_find(names, name) != NAME_NONE &&
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
    Texture *t = NULL;
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
    if (!t && !(t = constant(r, rgb_all(0.5f))))
        return false;
    return unused(&all, k) && enter(r, at, name, b.colour, t, b.cost);
}

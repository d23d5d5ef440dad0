/* imagemaps.c -- pictures as textures, and the mappings of textures onto surfaces. See
 * textures.h. */
#include "scenefile/textures.h"

#include "base/number.h"

#include <string.h>

/* ---- mappings ---- */

void texture_space(Build *b, Texture *t)
{
    t->map.to_texture = xf_affine_inverse(&b->r->state.ctm);
}

/* The place of `name` among names[0..n); the first one with a warning if it is unknown. */
static bool choose(const Param *p, const char *what, const char *name, const char *const *names,
                   int n, int *k)
{
    char hint[HINT_MAX];

    for (*k = 0; *k < n; (*k)++)
        if (word_is_nocase((Word){ name, strlen(name) }, names[*k]))
            return true;
    *k = 0;
    return warn_at(p->at, "unknown %s '%.40s'%s; %s is used", what, name,
                   hint_nearest(hint, name, names, (size_t)n), names[0]);
}

/* A string parameter that is one of names[0..n), as a number; 0 if it is not given. */
static bool choice(Build *b, const char *key, const char *what, const char *const *names, int n,
                   int *k)
{
    const char *name;

    *k = 0;
    return params_string(b->ps, key, names[0], &name) &&
           (name == names[0] ||
            choose(params_find(b->ps, key, NULL), what, name, names, n, k));
}

static V3 vector_of(const double *v) { return v3((float)v[0], (float)v[1], (float)v[2]); }

bool texture_mapping(Build *b, Texture *t)
{
    static const char *const names[] = { "uv", "spherical", "cylindrical", "planar" };
    double su = 1, sv = 1, du = 0, dv = 0, v1[3] = { 1, 0, 0 }, v2[3] = { 0, 1, 0 };
    int kind;

    if (!params_numbers(b->ps, "uscale", 1, &su) || !params_numbers(b->ps, "vscale", 1, &sv) ||
        !params_numbers(b->ps, "udelta", 1, &du) || !params_numbers(b->ps, "vdelta", 1, &dv) ||
        !params_numbers(b->ps, "v1", 3, v1) || !params_numbers(b->ps, "v2", 3, v2) ||
        !choice(b, "mapping", "mapping", names, 4, &kind))
        return false;
    t->map.kind = (TextureMapKind)kind;
    t->map.su = (float)su;
    t->map.sv = (float)sv;
    t->map.du = (float)du;
    t->map.dv = (float)dv;
    t->map.vs = vector_of(v1);
    t->map.vt = vector_of(v2);
    texture_space(b, t);
    return true;
}

/* ---- pictures ---- */

static Texture *picture(Reader *r, Place at, const char *name, Encoding encoding)
{
    Making m;
    Texture *t;

    if (!image_can_read(name)) {
        if (!warn_at(at, "pictures of the kind of '%.80s' cannot be read; grey 0.5 is used "
                     "(another program can convert it to PNG)", name))
            return NULL;
        t = texture_new(r, TEXTURE_CONSTANT);
        if (t)
            t->value = rgb_all(0.5f);
        return t;
    }
    t = texture_new(r, TEXTURE_IMAGE);
    if (!t || !reader_making(r, at, name, &m) ||
        !(t->image = scene_image_as(r->scene, &m, name, encoding)))
        return NULL;
    return t;
}

Texture *texture_image(Reader *r, Place at, const char *name)
{
    return picture(r, at, name, ENCODING_BY_FILE);
}

Texture *texture_data(Reader *r, Place at, const char *name)
{
    return picture(r, at, name, ENCODING_LINEAR);
}

/* Version 4: "encoding" is "sRGB", "linear" or "gamma X". Before: "bool gamma", whether it is sRGB,
 * and "float gamma", the exponent. */
static bool encoding_of(Build *b, Encoding *encoding)
{
    const Param *p = params_find(b->ps, "encoding", NULL), *g = params_find(b->ps, "gamma", NULL);
    const char *name;
    double gamma = 0;

    *encoding = ENCODING_BY_FILE;
    if (!params_string(b->ps, "encoding", NULL, &name))
        return false;
    if (!name && g && g->kind == PARAM_BOOL)
        *encoding = g->numbers[0] != 0 ? ENCODING_SRGB : ENCODING_LINEAR;
    else if (!name && g && !params_numbers(b->ps, "gamma", 1, &gamma))
        return false;
    else if (name && !strncmp(name, "gamma ", 6)) {
        const char *end = name + strlen(name);
        float x;
        gamma = number_float(name + 6, end, &x) == (size_t)(end - name) - 6 ? x : -1;
    } else if (name && word_is_nocase((Word){ name, strlen(name) }, "sRGB"))
        *encoding = ENCODING_SRGB;
    else if (name && !strcmp(name, "linear"))
        *encoding = ENCODING_LINEAR;
    else if (name)
        gamma = -1;
    if (gamma < 0 || gamma > 100)
        return warn_at(p ? p->at : g->at, "the encoding is none of \"sRGB\", \"linear\" and "
                       "\"gamma X\"; that of the file is used");
    if (gamma > 0)
        *encoding = (Encoding)gamma;
    return true;
}

/* How the picture is looked up. What asks for anisotropic filtering gets a pyramid. */
static bool image_options(Build *b, Texture *t)
{
    static const char *const wraps[] = { "repeat", "clamp", "black" };
    static const char *const filters[] = { "bilinear", "point", "trilinear", "ewa" };
    const Param *invert = params_find(b->ps, "invert", NULL);
    const Param *trilinear = params_find(b->ps, "trilinear", NULL);
    int wrap, filter;

    params_find(b->ps, "maxanisotropy", NULL);
    if (!choice(b, "wrap", "wrap mode", wraps, 3, &wrap) ||
        !choice(b, "filter", "filter", filters, 4, &filter))
        return false;
    t->wrap = (Wrap)wrap;
    t->filter = filter == 1 ? FILTER_POINT : filter > 1 ? FILTER_TRILINEAR : FILTER_BILINEAR;
    if (trilinear && trilinear->kind == PARAM_BOOL && trilinear->numbers[0] != 0)
        t->filter = FILTER_TRILINEAR;
    t->invert = invert && invert->kind == PARAM_BOOL && invert->numbers[0] != 0;
    t->grey = !b->colour;
    return texture_mapping(b, t);
}

bool texture_imagemap(Build *b, Place at, const Texture **t)
{
    const char *name;
    Texture *image, how;
    double scale = 1;
    Encoding encoding;

    memset(&how, 0, sizeof how);
    if (!params_string(b->ps, "filename", NULL, &name))
        return false;
    if (!name)
        return err_at(at, "an imagemap needs a \"string filename\"");
    if (!image_options(b, &how) || !encoding_of(b, &encoding) ||
        !params_numbers(b->ps, "scale", 1, &scale) ||
        !(image = picture(b->r, at, name, encoding)))
        return false;
    *t = image;
    how.kind = image->kind;
    how.image = image->image;
    how.value = rgb_scale(image->value, (float)scale);
    if (how.image && how.filter == FILTER_TRILINEAR &&
        !(how.pyramid = scene_pyramid(b->r->scene, how.image)))
        return false;
    *image = how;
    return true;
}

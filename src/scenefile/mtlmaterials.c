/* mtlmaterials.c -- the materials of MTL files as ours.
 *
 * Source      Wavefront Advanced Visualizer, MTL as its dialects have it; the words Pr, Pm, Pc, Pcr
 *             and aniso as exporters of programs write them whose materials are of that kind.
 * Models      in this order:
 *               illum 4, 6, 7, 9, or d < 1 and Ni but no illum: dielectric of index Ni (1.5 if
 *               that is 1), tinted by Tf, of alpha Pr^2;
 *               Pr, Pm or a map of one: see principled.c;
 *               illum 3, 5 with Ks: mirror of colour Ks;
 *               Ks without illum or with illum >= 2: phong of Kd, Ks, Ns;
 *               else: diffuse of Kd.
 *             Kd + Ks is scaled down to 1 where it is more. But for glass, d and map_d together are
 *             the opacity.
 * Maps        map_Kd, map_Ks, map_Ns, map_Pr, map_Pm and map_Ke multiply what they are maps of, if
 *             that is given and not 0. map_bump and bump are heights in the units of the scene,
 *             times -bm; but a picture of unit vectors is one of normals, as `norm` is: exporters
 *             write those as map_Bump. Maps of numbers are read as stored, those of colours not.
 * Light       Ke makes a group shine, to both sides: which side of a single face is meant, MTL
 *             does not say. The material stays as it is. */
#include "scenefile/reader.h"

#include <string.h>

/* ---- models ---- */

/* Parameters as a scene file would have them. */
typedef struct { Param p[4]; double v[4][3]; const char *s[4]; Params ps; } Made;

static Param *made_param(Made *m, Place at, const char *name, const char *type, ParamType kind)
{
    Param *p = &m->p[m->ps.n++];

    memset(p, 0, sizeof *p);
    p->name = name;
    p->type = type;
    p->kind = kind;
    p->at = at;
    p->n = 1;
    m->ps.p = m->p;
    return p;
}

static void made_number(Made *m, Place at, const char *name, double x)
{
    double *v = m->v[m->ps.n];

    v[0] = x;
    made_param(m, at, name, "float", PARAM_FLOAT)->numbers = v;
}

static void made_rgb(Made *m, Place at, const char *name, Rgb c)
{
    double *v = m->v[m->ps.n];
    Param *p = made_param(m, at, name, "rgb", PARAM_FLOAT);

    v[0] = c.r;
    v[1] = c.g;
    v[2] = c.b;
    p->n = 3;
    p->numbers = v;
}

static void made_true(Made *m, Place at, const char *name)
{
    double *v = m->v[m->ps.n];

    v[0] = 1;
    made_param(m, at, name, "bool", PARAM_BOOL)->numbers = v;
}

static void made_string(Made *m, Place at, const char *name, const char *value)
{
    const char **s = &m->s[m->ps.n];

    *s = value;
    made_param(m, at, name, "string", PARAM_STRING)->strings = s;
}

static Rgb not_negative(Rgb c)
{
    return rgb(f_max(0.0f, c.r), f_max(0.0f, c.g), f_max(0.0f, c.b));
}
static Rgb at_most_one(Rgb c) { return rgb(clamp01(c.r), clamp01(c.g), clamp01(c.b)); }

static bool is_glass(const MtlMaterial *m)
{
    return m->illum == 4 || m->illum == 6 || m->illum == 7 || m->illum == 9 ||
           (m->d < 1.0f && m->ni > 1.0001f && m->illum < 0);
}

static const char *glass(const MtlMaterial *m, Made *out)
{
    float eta = m->ni > 1.0001f ? f_min(m->ni, 10.0f) : 1.5f;
    if (m->has_ks && !rgb_black(m->ks))
        made_rgb(out, m->at, "reflectance", at_most_one(m->ks));
    if (!rgb_black(m->tf))
        made_rgb(out, m->at, "transmittance", at_most_one(m->tf));
    made_number(out, m->at, "eta", eta);
    if (m->roughness > 0.0f)                    /* of which the model takes the root */
        made_number(out, m->at, "roughness", f_sqr(f_sqr(f_min(m->roughness, 1.0f))));
    return "dielectric";
}

static const char *phong(const MtlMaterial *m, Rgb kd, Made *out)
{
    Rgb ks = not_negative(m->ks);
    float sum = rgb_max(rgb_add(kd, ks)), k = sum > 1.0f ? 1.0f / sum : 1.0f;
    made_rgb(out, m->at, "reflectance", at_most_one(rgb_scale(kd, k)));
    made_rgb(out, m->at, "specular", at_most_one(rgb_scale(ks, k)));
    made_number(out, m->at, "exponent", f_max(0.0f, f_min(m->ns, 1e6f)));
    return "phong";
}

/* Which model, with which parameters. */
static const char *model_of(const MtlMaterial *m, Rgb kd, Made *out)
{
    bool shiny = m->has_ks && rgb_max(m->ks) > 0.0f;

    memset(out, 0, sizeof *out);
    out->ps.p = out->p;
    if (is_glass(m))
        return glass(m, out);
    if (shiny && (m->illum == 3 || m->illum == 5)) {
        made_rgb(out, m->at, "reflectance", at_most_one(not_negative(m->ks)));
        return "mirror";
    }
    if (shiny && (m->illum < 0 || m->illum >= 2))
        return phong(m, kd, out);
    made_rgb(out, m->at, "reflectance", at_most_one(kd));
    return "diffuse";
}

char *mtl_slashed(Reader *r, const char *name)
{
    char *s = arena_string(&r->out->arena, name, strlen(name));
    for (char *p = s; p && *p; p++)
        if (*p == '\\')
            *p = '/';
    return s;
}

/* ---- maps ---- */

/* The picture as a texture; *t NULL if there is none, or after a warning that it cannot be had.
 * otherwise: what happens then. */
static bool find_map(Reader *r, const MtlMaterial *mtl, MtlMapKind kind, const char *otherwise,
                     Texture **t)
{
    const char *name = mtl_map(mtl, kind);
    bool colour = kind == MTL_KD || kind == MTL_KS;
    char *file, *path;
    bool there;

    *t = NULL;
    if (!*name)
        return true;
    file = mtl_slashed(r, name);
    path = file ? path_beside(mtl->at.file, file) : NULL;
    there = path && file_exists(path);
    mem_free(path);
    if (!path)
        return false;
    if (!there)
        return warn_at(mtl->at, "the picture %s cannot be found; %s", file, otherwise);
    if (!image_can_read(file))
        return warn_at(mtl->at, "pictures of the kind of %s cannot be read; %s", file, otherwise);
    *t = colour ? texture_image(r, mtl->at, file) : texture_data(r, mtl->at, file);
    if (*t)
        (*t)->grey = kind == MTL_NS || kind == MTL_ROUGHNESS || kind == MTL_METALLIC;
    return *t != NULL;
}

/* Multiplies an option of the model, if it has it, by the map. */
static bool multiply(Reader *r, const MtlMaterial *mtl, MtlMapKind kind, const char *key,
                     const char *otherwise, Material *m)
{
    int k = material_option(m->kind, key);
    Texture *t;

    if (!find_map(r, mtl, kind, otherwise, &t))
        return false;
    if (!t || k < 0)
        return true;
    t->value = rgb_mul(t->value, m->value[k]);
    m->texture[k] = t;
    m->textured = true;
    return true;
}

static bool add_maps(Reader *r, const MtlMaterial *mtl, Material *m)
{
    bool mirror = !strcmp(m->kind->info.name, "mirror");

    if (is_glass(mtl))
        return true;
    return multiply(r, mtl, MTL_KS, mirror ? "reflectance" : "specular", "Ks alone is used", m) &&
           multiply(r, mtl, MTL_NS, "exponent", "Ns alone is used", m) &&
           (mirror || multiply(r, mtl, MTL_KD, "reflectance", "Kd alone is used", m));
}

static bool add_opacity(Reader *r, const MtlMaterial *mtl, Material *m)
{
    Texture *t;

    if (!find_map(r, mtl, MTL_D, "d alone is used", &t))
        return false;
    if (is_glass(mtl) || (!t && !(mtl->d < 1.0f)))
        return true;
    if (t)
        t->value = rgb_scale(t->value, clamp01(mtl->d));
    m->opacity = t ? t : texture_constant(r, rgb_all(clamp01(mtl->d)));
    return m->opacity != NULL;
}

/* Nine of ten pixels, of a few thousand, are coloured and unit vectors that look up. */
static bool shows_normals(const Image *im)
{
    size_t n = (size_t)im->w * im->h, step = n / 4096 + 1, seen = 0, unit = 0;

    for (size_t i = 0; i < n; i += step, seen++) {
        Rgb c = im->pixels[i];
        V3 v = { 2.0f * c.r - 1.0f, 2.0f * c.g - 1.0f, 2.0f * c.b - 1.0f };
        bool grey = rgb_max(c) - rgb_min(c) < 0.05f;
        unit += !grey && v.z > 0.0f && fabsf(v_len(v) - 1.0f) < 0.1f;
    }
    return 10 * unit >= 9 * seen;
}

static bool add_relief(Reader *r, const MtlMaterial *mtl, Material *m)
{
    Texture *heights, *normals;

    if (!find_map(r, mtl, MTL_BUMP, "there are no bumps", &heights) ||
        !find_map(r, mtl, MTL_NORM, "the surface stays even", &normals))
        return false;
    m->slope = 1.0f;
    if (heights && shows_normals(heights->image)) {
        normals = normals ? normals : heights;
        m->slope = mtl->bump;
        heights = NULL;
    }
    if (heights)
        heights->value = rgb_scale(heights->value, mtl->bump);
    m->bump = heights;
    m->normals = normals;
    m->mirrors = true;
    return true;
}

/* ---- making one ---- */

/* A number times its map, in *t; what is not given is 1 with a map, else `otherwise`. */
static bool mapped(Reader *r, const MtlMaterial *mtl, MtlMapKind kind, float value,
                   float otherwise, const char *warning, const Texture **t)
{
    Texture *map;

    if (!find_map(r, mtl, kind, warning, &map))
        return false;
    if (map)
        map->value = rgb_all(value >= 0.0f ? value : 1.0f);
    *t = map ? map : texture_constant(r, rgb_all(value >= 0.0f ? clamp01(value) : otherwise));
    return *t != NULL;
}

static bool is_principled(const MtlMaterial *m)
{
    return m->roughness >= 0.0f || m->metallic >= 0.0f || *mtl_map(m, MTL_ROUGHNESS) ||
           *mtl_map(m, MTL_METALLIC);
}

static bool make_principled(Reader *r, const MtlMaterial *mtl, Rgb kd, uint32_t *index)
{
    Texture *map;
    Principled p;

    if (!find_map(r, mtl, MTL_KD, "Kd alone is used", &map) ||
        !mapped(r, mtl, MTL_ROUGHNESS, mtl->roughness, 0.5f, "Pr alone is used", &p.roughness) ||
        !mapped(r, mtl, MTL_METALLIC, mtl->metallic, 0, "Pm alone is used", &p.metallic))
        return false;
    if (map)
        map->value = kd;
    p.color = map ? map : texture_constant(r, at_most_one(kd));
    p.spectrans = texture_constant(r, rgb_all(0.0f));
    p.clearcoat = texture_constant(r, rgb_all(clamp01(mtl->coat)));
    p.eta = mtl->ni > 1.1f ? mtl->ni : 1.5f;
    p.anisotropic = mtl->aniso;
    p.gloss = 1.0f - mtl->coat_roughness;
    return p.color && p.spectrans && p.clearcoat &&
           principled_make(r, mtl->at, &p, mtl->name, index);
}

bool mtl_material(Reader *r, const MtlMaterial *mtl, uint32_t *index)
{
    Rgb kd = mtl->has_kd ? not_negative(mtl->kd) : rgb_all(mtl->has_ks ? 0.0f : 0.5f);
    const char *model;
    Material *m;
    Made made;

    if (*mtl_map(mtl, MTL_KD) && (rgb_black(kd) || !mtl->has_kd))
        kd = rgb_all(1.0f);
    if (is_principled(mtl) && !is_glass(mtl)) {
        if (!make_principled(r, mtl, kd, index))
            return false;
    } else {
        model = model_of(mtl, kd, &made);
        if (!material_make(r, mtl->at, model, &made.ps, mtl->name, index) ||
            !add_maps(r, mtl, &r->scene->materials[*index]))
            return false;
    }
    m = &r->scene->materials[*index];
    return add_opacity(r, mtl, m) && add_relief(r, mtl, m);
}

/* ---- light ---- */

/* The name of the map of light, if there is one that can be read; else "". */
static bool light_map(Reader *r, const MtlMaterial *m, const char **name)
{
    Texture *t;

    *name = "";
    if (!find_map(r, m, MTL_KE, "Ke alone is used", &t))
        return false;
    if (t)
        *name = mtl_slashed(r, mtl_map(m, MTL_KE));
    return *name != NULL;
}

bool mtl_light(Reader *r, const MtlMaterial *m, const AreaLight **area)
{
    AreaLight *a;
    const char *picture;
    Made made;
    bool shines = m->has_ke && rgb_max(m->ke) > 0.0f;

    *area = NULL;
    if (!light_map(r, m, &picture))
        return false;
    if (!shines && !*picture)
        return true;
    a = arena_take(&r->out->arena, 1, sizeof *a);
    if (!a)
        return false;
    memset(&made, 0, sizeof made);
    made_rgb(&made, m->at, "L", shines ? not_negative(m->ke) : rgb_all(1.0f));
    made_true(&made, m->at, "twosided");
    if (*picture)
        made_string(&made, m->at, "filename", picture);
    if (!params_keep(&r->out->arena, &made.ps, NULL, &a->params))
        return false;
    a->kind = kind_find(lights, "diffuse");
    a->at = m->at;
    *area = a;
    return true;
}

/* objfile.c -- OBJ files with their MTL files, as scenes or as shapes of one.
 *
 * Source      Wavefront Advanced Visualizer, appendix B; MTL as its dialects have it.
 * Materials   in this order, of a group of faces with one `usemtl`:
 *               a material of the scene file with that name;
 *               illum 4, 6, 7, 9, or d < 1 and Ni but no illum: dielectric of index Ni (1.5 if
 *               that is 1), tinted by Tf;
 *               illum 3, 5 with Ks: mirror of colour Ks;
 *               Ks without illum or with illum >= 2: phong of Kd, Ks, Ns;
 *               else: diffuse of Kd.
 *             Kd + Ks is scaled down to 1 where it is more. map_Kd multiplies Kd. But for glass, d
 *             and map_d together are the opacity. map_bump and bump are heights in the units of
 *             the scene, times -bm.
 * Light       Ke makes a group shine, to both sides: which side of a single face is meant, MTL
 *             does not say. The material stays as it is. */
#include "scenefile/reader.h"

#include <string.h>

/* ---- materials ---- */

typedef struct { Param p[4]; double v[4][3]; const char *s[4]; Params ps; } Made;

static void made_number(Made *m, Place at, const char *name, const char *type, double a, double b,
                        double c)
{
    Param *p = &m->p[m->ps.n];
    double *v = m->v[m->ps.n++];
    memset(p, 0, sizeof *p);
    v[0] = a;
    v[1] = b;
    v[2] = c;
    p->name = name;
    p->type = type;
    p->kind = PARAM_FLOAT;
    p->at = at;
    p->n = strcmp(type, "rgb") ? 1 : 3;
    p->numbers = v;
    m->ps.p = m->p;
}

static void made_rgb(Made *m, Place at, const char *name, Rgb c)
{
    made_number(m, at, name, "rgb", c.r, c.g, c.b);
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
    made_number(out, m->at, "eta", "float", eta, 0, 0);
    return "dielectric";
}

static const char *phong(const MtlMaterial *m, Rgb kd, Made *out)
{
    Rgb ks = not_negative(m->ks);
    float sum = rgb_max(rgb_add(kd, ks)), k = sum > 1.0f ? 1.0f / sum : 1.0f;
    made_rgb(out, m->at, "reflectance", at_most_one(rgb_scale(kd, k)));
    made_rgb(out, m->at, "specular", at_most_one(rgb_scale(ks, k)));
    made_number(out, m->at, "exponent", "float", f_max(0.0f, f_min(m->ns, 1e6f)), 0, 0);
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

/* Names of old files use backslashes. In the SceneFile's arena. */
static char *slashed(Reader *r, const char *name)
{
    char *s = arena_string(&r->out->arena, name, strlen(name));
    for (char *p = s; p && *p; p++)
        if (*p == '\\')
            *p = '/';
    return s;
}

/* The picture as a texture; *t NULL after a warning that it cannot be had. otherwise: what happens
 * then. */
static bool find_map(Reader *r, const MtlMaterial *mtl, const char *name, const char *otherwise,
                     Texture **t)
{
    char *slashed_name = slashed(r, name);
    char *path = slashed_name ? path_beside(mtl->at.file, slashed_name) : NULL;
    bool there = path && file_exists(path);

    *t = NULL;
    mem_free(path);
    if (!path)
        return false;
    if (!there)
        return warn_at(mtl->at, "the picture %s cannot be found; %s", slashed_name, otherwise);
    if (!texture_readable(slashed_name))
        return warn_at(mtl->at, "pictures of the kind of %s cannot be read; %s", slashed_name,
                       otherwise);
    *t = texture_image(r, mtl->at, slashed_name);
    return *t != NULL;
}

/* Multiplies the diffuse colour by the map. */
static bool add_map(Reader *r, const MtlMaterial *mtl, Material *m)
{
    const OptDef *d = m->kind->info.options;
    Texture *t;
    int k = 0;

    if (!find_map(r, mtl, mtl->map_kd, "Kd alone is used", &t))
        return false;
    while (d[k].key && strcmp(d[k].key, "reflectance"))
        k++;
    if (!t || !d[k].key || is_glass(mtl))
        return true;
    t->value = rgb_mul(t->value, m->value[k]);
    m->texture[k] = t;
    m->textured = true;
    return true;
}

static bool add_opacity(Reader *r, const MtlMaterial *mtl, Material *m)
{
    Texture *t = NULL;

    if (*mtl->map_d && !find_map(r, mtl, mtl->map_d, "d alone is used", &t))
        return false;
    if (is_glass(mtl) || (!t && !(mtl->d < 1.0f)))
        return true;
    if (t)
        t->value = rgb_scale(t->value, clamp01(mtl->d));
    m->opacity = t ? t : texture_constant(r, rgb_all(clamp01(mtl->d)));
    return m->opacity != NULL;
}

static bool add_bump(Reader *r, const MtlMaterial *mtl, Material *m)
{
    Texture *t;

    if (!find_map(r, mtl, mtl->map_bump, "there are no bumps", &t))
        return false;
    if (t)
        t->value = rgb_scale(t->value, mtl->bump);
    m->bump = t;
    return true;
}

static bool make_material(Reader *r, const MtlMaterial *mtl, uint32_t *index)
{
    Rgb kd = mtl->has_kd ? not_negative(mtl->kd) : rgb_all(mtl->has_ks ? 0.0f : 0.5f);
    bool mapped = *mtl->map_kd != 0;
    const char *model;
    Material *m;
    Made made;

    if (mapped && rgb_black(kd))
        kd = rgb_all(1.0f);
    model = model_of(mtl, kd, &made);
    if (!material_make(r, mtl->at, model, &made.ps, mtl->name, index))
        return false;
    m = &r->scene->materials[*index];
    return (!mapped || add_map(r, mtl, m)) && add_opacity(r, mtl, m) &&
           (!*mtl->map_bump || add_bump(r, mtl, m));
}

/* The light of a group, or NULL in *area. In the SceneFile's arena. */
static bool make_area(Reader *r, const MtlMaterial *m, const AreaLight **area)
{
    static const double yes = 1;
    const LightKind *kind = NULL;
    AreaLight *a;
    Param p[2];
    Made made;
    Params ps = { p, 2 };

    *area = NULL;
    if (!m->has_ke || !(rgb_max(m->ke) > 0.0f))
        return true;
    for (size_t i = 0; lights[i]; i++)
        if (!strcmp(lights[i]->info.name, "diffuse"))
            kind = lights[i];
    a = arena_take(&r->out->arena, 1, sizeof *a);
    if (!a || !kind)
        return a != NULL;
    memset(&made, 0, sizeof made);
    made_rgb(&made, m->at, "L", not_negative(m->ke));
    p[0] = p[1] = made.p[0];
    p[1].name = "twosided";
    p[1].type = "bool";
    p[1].kind = PARAM_BOOL;
    p[1].n = 1;
    p[1].numbers = &yes;
    if (!params_keep(&r->out->arena, &ps, NULL, &a->params))
        return false;
    a->kind = kind;
    a->at = m->at;
    *area = a;
    return true;
}

/* ---- groups ---- */

typedef struct { uint32_t material; const AreaLight *area; } Look;

typedef struct {                /* an OBJ file on its way into the scene */
    Reader  *r;
    Place    at;
    ObjFile  obj;
    MtlFile *mtl;               /* owned; one each of obj.mtllibs */
    const char **mtl_path;      /* owned; in the scene's arena */
    Names    by_name;           /* materials of all MTL files; the first of a name counts */
    const MtlMaterial **list;   /* owned; what by_name numbers */
    size_t   nlist, cap_list;
    Look    *look;              /* owned; by group */
} Job;

/* A library that is not there is warned of: many OBJ files name one that was never given away. */
static bool read_library(Job *j, size_t k)
{
    Reader *r = j->r;
    char *name = slashed(r, j->obj.mtllibs[k]), *path;
    FileBytes f;
    bool ok;

    if (!name)
        return false;
    path = path_beside(j->mtl_path[0], name);
    if (!path)
        return false;
    if (!file_exists(path)) {
        mem_free(path);
        return warn_at(j->at, "the material file %s cannot be found; neutral materials are used",
                       name);
    }
    j->mtl_path[k + 1] = arena_string(&r->scene->arena, path, strlen(path));
    ok = j->mtl_path[k + 1] && reader_file(r, j->at, path, &f);
    mem_free(path);
    if (!ok)
        return false;
    ok = mtl_read(&j->mtl[k], j->mtl_path[k + 1], (const unsigned char *)f.bytes, f.size);
    file_clear(&f);
    for (size_t i = 0; ok && i < j->mtl[k].n; i++) {
        const MtlMaterial *m = &j->mtl[k].m[i];
        if (names_find(&j->by_name, m->name) == NAME_NONE)
            ok = names_set(&j->by_name, &r->out->arena, m->name, (uint32_t)j->nlist) &&
                 MEM_PUSH(j->list, j->nlist, j->cap_list, m);
    }
    return ok;
}

/* What a group looks like; without a usemtl, the material of the moment. */
static bool look_of(Job *j, const char *name, Look *look)
{
    Reader *r = j->r;
    uint32_t own = names_find(&r->materials, name), m = names_find(&j->by_name, name);

    look->material = r->state.material;
    look->area = r->state.area;
    if (!*name)
        return true;
    if (own != NAME_NONE)
        look->material = own;
    else if (m == NAME_NONE && j->nlist)
        return warn_at(j->at, "no material is called '%.80s'; that of the scene file is used",
                       name);
    else if (m != NAME_NONE)
        return make_material(r, j->list[m], &look->material) &&
               (look->area || make_area(r, j->list[m], &look->area));
    return true;
}

/* ---- one mesh a group ---- */

/* Triangles first[k] .. first[k+1]-1 of `order` become those of group k. */
static void sort_by_group(const ObjFile *o, uint32_t *first, uint32_t *order)
{
    const Mesh *m = &o->mesh;
    for (uint32_t i = 0; i < m->ntris; i++)
        first[m->group[i] + 2]++;
    for (size_t k = 2; k < o->ngroups + 2; k++)
        first[k] += first[k - 1];
    for (uint32_t i = 0; i < m->ntris; i++)
        order[first[m->group[i] + 1]++] = i;
}

/* Numbers the vertices of n triangles in order of first use: seen[v] is 1 + the number of v. */
static uint32_t number_vertices(const Mesh *m, const uint32_t *order, uint32_t n, uint32_t *seen)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < n; i++)
        for (int c = 0; c < 3; c++)
            if (!seen[m->tri[order[i]].v[c]])
                seen[m->tri[order[i]].v[c]] = ++count;
    return count;
}

static bool part_init(Mesh *part, const Mesh *m, uint32_t nverts, uint32_t ntris)
{
    memset(part, 0, sizeof *part);
    part->nverts = nverts;
    part->ntris = ntris;
    part->tri = MEM_ARRAY(Tri, ntris);
    part->p = MEM_ARRAY(V3, nverts);
    if (m->n)
        part->n = MEM_ARRAY(V3, nverts);
    if (m->uv)
        part->uv = MEM_ARRAY(V2, nverts);
    return part->tri && part->p && (!m->n || part->n) && (!m->uv || part->uv);
}

/* Copies n triangles and the vertices that they use. seen is all 0 before and after. */
static bool part_of(const Mesh *m, const uint32_t *order, uint32_t n, uint32_t *seen, Mesh *part)
{
    if (!part_init(part, m, number_vertices(m, order, n, seen), n))
        return false;
    for (uint32_t i = 0; i < n; i++)
        for (int c = 0; c < 3; c++) {
            uint32_t v = m->tri[order[i]].v[c], k = seen[v] - 1;
            part->tri[i].v[c] = k;
            part->p[k] = m->p[v];
            if (m->n)
                part->n[k] = m->n[v];
            if (m->uv)
                part->uv[k] = m->uv[v];
        }
    for (uint32_t i = 0; i < n; i++)
        for (int c = 0; c < 3; c++)
            seen[m->tri[order[i]].v[c]] = 0;
    return true;
}

static bool add_groups(Job *j)
{
    const Mesh *m = &j->obj.mesh;
    size_t ngroups = j->obj.ngroups;
    uint32_t *first = MEM_ARRAY(uint32_t, ngroups + 2), *order = MEM_ARRAY(uint32_t, m->ntris);
    uint32_t *seen = MEM_ARRAY(uint32_t, m->nverts);
    bool ok = first && order && seen;

    if (ok)
        sort_by_group(&j->obj, first, order);
    for (size_t k = 0; ok && k < ngroups; k++) {
        Mesh part;
        uint32_t n = first[k + 1] - first[k];
        if (!part_of(m, order + first[k], n, seen, &part)) {
            mesh_clear(&part);
            ok = false;
        } else
            ok = shape_add_mesh(j->r, j->at, &part, j->look[k].material, j->look[k].area);
    }
    mem_free(first);
    mem_free(order);
    mem_free(seen);
    return ok;
}

static bool add_all(Job *j)
{
    Mesh *m = &j->obj.mesh;

    if (j->obj.ngroups > 1)
        return add_groups(j);
    mem_free(m->group);
    m->group = NULL;
    return m->ntris == 0 || shape_add_mesh(j->r, j->at, m, j->look[0].material, j->look[0].area);
}

/* ---- the file ---- */

static bool read_obj(Job *j, const char *path)
{
    FileBytes f;
    bool ok;

    if (!reader_file(j->r, j->at, path, &f))
        return false;
    ok = obj_read(&j->obj, path, (const unsigned char *)f.bytes, f.size);
    file_clear(&f);
    return ok;
}

static bool read_all(Job *j, const char *path)
{
    size_t nlibs, ngroups;

    if (!read_obj(j, path))
        return false;
    nlibs = j->obj.nmtllibs;
    ngroups = j->obj.ngroups;
    j->mtl = MEM_ARRAY(MtlFile, nlibs);
    j->mtl_path = MEM_ARRAY(const char *, nlibs + 1);
    j->look = MEM_ARRAY(Look, ngroups + 1);
    if (!j->mtl || !j->mtl_path || !j->look ||
        !(j->mtl_path[0] = arena_string(&j->r->scene->arena, path, strlen(path))))
        return false;
    if (!j->at.file)                            /* the OBJ file is the scene */
        j->at.file = j->mtl_path[0];
    for (size_t k = 0; k < nlibs; k++)
        if (!read_library(j, k))
            return false;
    for (size_t k = 0; k < ngroups; k++)
        if (!look_of(j, j->obj.group_names[k], &j->look[k]))
            return false;
    return add_all(j);
}

bool objfile_add(Reader *r, Place at, const char *path)
{
    Job j;
    bool ok;

    memset(&j, 0, sizeof j);
    j.r = r;
    j.at = at;
    ok = read_all(&j, path);
    for (size_t k = 0; j.mtl && k < j.obj.nmtllibs; k++)
        mtl_clear(&j.mtl[k]);
    mem_free(j.mtl);
    mem_free(j.mtl_path);
    mem_free(j.list);
    mem_free(j.look);
    names_clear(&j.by_name);
    obj_clear(&j.obj);
    return ok;
}

/* objfile.c -- OBJ files with their MTL files, as scenes or as shapes of one.
 *
 * Source      Wavefront Advanced Visualizer, appendix B; MTL as its dialects have it.
 * Materials   of a group of faces with one `usemtl`: the material of the scene file that has this
 *             name, which so goes before what the MTL file says; or that of the MTL file, see
 *             mtlmaterials.c. Without either, the material of the moment. */
#include "scenefile/reader.h"

#include <string.h>

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
    char *name = mtl_slashed(r, j->obj.mtllibs[k]), *path;
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
        return mtl_material(r, j->list[m], &look->material) &&
               (look->area || mtl_light(r, j->list[m], &look->area));
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

/* Copies n triangles and the vertices that they use. seen is all 0 before and after. */
static bool part_of(const Mesh *m, const uint32_t *order, uint32_t n, uint32_t *seen, Mesh *part)
{
    uint32_t nverts = number_vertices(m, order, n, seen);

    memset(part, 0, sizeof *part);
    if (!mesh_alloc(part, nverts, n, m->n != NULL, m->uv != NULL))
        return false;
    part->nverts = nverts;
    part->ntris = n;
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
        ok = part_of(m, order + first[k], n, seen, &part) &&
             shape_add_mesh(j->r, j->at, &part, j->look[k].material, j->look[k].area);
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

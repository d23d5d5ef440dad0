/* mesh_help.c -- see mesh_help.h. */
#include "test/mesh_help.h"

#include "base/file.h"

#include <stdio.h>
#include <string.h>

MeshFile mesh_file_read(MeshFileKind kind, const char *name, const unsigned char *bytes, size_t n)
{
    MeshFile f;

    memset(&f, 0xA5, sizeof f);                 /* a reader must not rely on what was there */
    if (kind == FILE_PLY)
        f.ok = ply_read(&f.mesh, name, bytes, n);
    else if (kind == FILE_MTL)
        f.ok = mtl_read(&f.mtl, name, bytes, n);
    else {
        f.ok = obj_read(&f.obj, name, bytes, n);
        f.mesh = f.obj.mesh;
    }
    return f;
}

void mesh_file_clear(MeshFileKind kind, MeshFile *f)
{
    if (kind == FILE_PLY)
        mesh_clear(&f->mesh);
    else if (kind == FILE_OBJ)
        obj_clear(&f->obj);
    else
        mtl_clear(&f->mtl);
}

const char *mesh_fault(const Mesh *m)
{
    for (uint32_t i = 0; i < m->ntris; i++)
        for (int k = 0; k < 3; k++)
            if (m->tri[i].v[k] >= m->nverts)
                return "an index beyond the vertices";
    for (uint32_t i = 0; i < m->nverts; i++) {
        if (!v_finite(m->p[i]))
            return "a position that is not finite";
        /* v_unit: one division, one product, a length of five roundings */
        if (m->n && v_len2(m->n[i]) != 0.0f && !(fabsf(v_len2(m->n[i]) - 1.0f) < ROUNDINGS(16)))
            return "a normal that is neither unit nor none";
        if (m->uv && !(is_finite(m->uv[i].x) && is_finite(m->uv[i].y)))
            return "a texture coordinate that is not finite";
    }
    return NULL;
}

static bool empty(const void *p, size_t n)
{
    const unsigned char *b = p;
    for (size_t i = 0; i < n; i++)
        if (b[i])
            return false;
    return true;
}

static const char *obj_fault(const ObjFile *f)
{
    const char *fault = mesh_fault(&f->mesh);

    if (fault)
        return fault;
    if ((f->mesh.group != NULL) != (f->ngroups > 1) || (f->ngroups > 0) != (f->mesh.ntris > 0))
        return "groups and triangles that do not fit";
    for (uint32_t i = 0; f->mesh.group && i < f->mesh.ntris; i++)
        if (f->mesh.group[i] >= f->ngroups)
            return "a group beyond the groups";
    for (size_t k = 0; k < f->ngroups; k++)
        if (!f->group_names[k])
            return "a group without a name";
    for (size_t k = 0; k < f->nmtllibs; k++)
        if (!f->mtllibs[k] || !f->mtllibs[k][0])
            return "a library without a name";
    return NULL;
}

static const char *mtl_fault(const MtlFile *f)
{
    for (size_t k = 0; k < f->n; k++) {
        const MtlMaterial *m = &f->m[k];
        if (!m->name || !m->map_kd || !m->map_d || !m->map_bump)
            return "a string that is NULL";
        if (!rgb_finite(m->kd) || !rgb_finite(m->ks) || !rgb_finite(m->ke) || !rgb_finite(m->tf) ||
            !is_finite(m->ns) || !is_finite(m->ni) || !is_finite(m->d))
            return "a value that is not finite";
        if (m->illum < -1 || m->illum > 10)
            return "an illumination model out of range";
    }
    return NULL;
}

const char *mesh_file_fault(MeshFileKind kind, const MeshFile *f)
{
    bool cleared = kind == FILE_PLY   ? empty(&f->mesh, sizeof f->mesh)
                   : kind == FILE_OBJ ? empty(&f->obj, sizeof f->obj)
                                      : empty(&f->mtl, sizeof f->mtl);
    if (!f->ok)
        return cleared ? NULL : "refused, but not empty";
    return kind == FILE_PLY ? mesh_fault(&f->mesh) : kind == FILE_OBJ ? obj_fault(&f->obj)
                                                                      : mtl_fault(&f->mtl);
}

Mesh mesh_of_ply(const char *path)
{
    FileBytes f;
    Mesh m;
    bool ok;
    REQUIRE(file_read(path, FILE_LIMIT_DEFAULT, &f), "cannot read %s", path);
    ok = ply_read(&m, path, (const unsigned char *)f.bytes, f.size);
    file_clear(&f);
    REQUIRE(ok, "%s was refused", path);
    return m;
}

bool v3_is(V3 v, float x, float y, float z) { return v.x == x && v.y == y && v.z == z; }

/* ---- messages ---- */

static FILE *told;

void messages_start(void)
{
    char path[300];

    snprintf(path, sizeof path, "%s/messages", test_folder());
    REQUIRE(freopen(path, "w", stderr), "cannot write %s", path);
    told = fopen(path, "r");
    REQUIRE(told, "cannot read %s", path);
}

void messages_nowhere(void) { REQUIRE(freopen("/dev/null", "w", stderr), "no /dev/null"); }

int messages_take(char *line, size_t room)
{
    int n = 0, c;
    size_t have = 0;

    fflush(stderr);
    clearerr(told);
    line[0] = 0;
    while ((c = getc(told)) != EOF) {
        if (!n && c != '\n' && have + 1 < room) {
            line[have++] = (char)c;
            line[have] = 0;
        }
        n += c == '\n';
    }
    return n;
}

/* mesh_help.c -- see mesh_help.h. */
#include "test/mesh_help.h"

#include "base/file.h"

#include <stdio.h>
#include <stdlib.h>
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
        for (const MtlMap *map = m->maps; map; map = map->next)
            if (!map->name || map->kind > MTL_METALLIC)
                return "a map that is none";
        if (!m->name)
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

/* ---- closed meshes ---- */

static int by_value(const void *a, const void *b)
{
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return x < y ? -1 : x > y;
}

static uint64_t directed(uint32_t a, uint32_t b) { return (uint64_t)a << 32 | b; }

/* Every edge in exactly two triangles, once each way; every vertex used; V - E + F as given. */
void mesh_check_closed(const char *name, const Mesh *m, long euler)
{
    size_t n = 3 * (size_t)m->ntris;
    uint64_t *edges = malloc(n * sizeof *edges), back;
    unsigned char *used = calloc(m->nverts, 1);
    long twice = 0, lonely = 0, unused = 0;

    REQUIRE(edges && used, "memory");
    for (size_t i = 0; i < n; i++) {
        const uint32_t *v = m->tri[i / 3].v;
        edges[i] = directed(v[i % 3], v[(i + 1) % 3]);
        used[v[i % 3]] = 1;
    }
    qsort(edges, n, sizeof *edges, by_value);
    for (size_t i = 0; i < n; i++) {
        back = edges[i] << 32 | edges[i] >> 32;
        twice += i && edges[i] == edges[i - 1];
        lonely += !bsearch(&back, edges, n, sizeof *edges, by_value);
    }
    for (uint32_t v = 0; v < m->nverts; v++)
        unused += !used[v];
    EXPECT(!twice && !lonely, "%s: %ld edges twice one way, %ld without partner", name, twice,
           lonely);
    EXPECT(!unused, "%s: %ld vertices unused", name, unused);
    EXPECT((long)m->nverts - (long)n / 2 + (long)m->ntris == euler, "%s: Euler characteristic %ld",
           name, (long)m->nverts - (long)n / 2 + (long)m->ntris);
    free(edges);
    free(used);
}

double mesh_volume(const Mesh *m)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < m->ntris; i++) {
        V3 a = m->p[m->tri[i].v[0]], b = m->p[m->tri[i].v[1]], c = m->p[m->tri[i].v[2]];
        sum += a.x * ((double)b.y * c.z - (double)b.z * c.y) +
               a.y * ((double)b.z * c.x - (double)b.x * c.z) +
               a.z * ((double)b.x * c.y - (double)b.y * c.x);
    }
    return sum / 6.0;
}

double mesh_area(const Mesh *m)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < m->ntris; i++) {
        V3 a = m->p[m->tri[i].v[0]];
        V3 n = v_cross(v_sub(m->p[m->tri[i].v[1]], a), v_sub(m->p[m->tri[i].v[2]], a));
        sum += 0.5 * (double)v_len(n);
    }
    return sum;
}

static int by_place(const void *a, const void *b) { return memcmp(a, b, 3 * sizeof(float)); }

/* Bit patterns are compared; adding 0 makes zeros alike. */
void mesh_weld(Mesh *m)
{
    typedef struct { float p[3]; uint32_t id; } Place3;
    Place3 *all = malloc((m->nverts + 1) * sizeof *all);
    uint32_t *now = malloc((m->nverts + 1) * sizeof *now), n = 0;

    REQUIRE(all && now, "memory");
    for (uint32_t i = 0; i < m->nverts; i++)
        all[i] = (Place3){ { m->p[i].x + 0.0f, m->p[i].y + 0.0f, m->p[i].z + 0.0f }, i };
    qsort(all, m->nverts, sizeof *all, by_place);
    for (uint32_t i = 0; i < m->nverts; i++) {
        if (i == 0 || by_place(&all[i], &all[i - 1]))
            n++;
        now[all[i].id] = n - 1;
    }
    for (uint32_t i = 0, k = 0; i < m->nverts; i++)
        if (i == 0 || by_place(&all[i], &all[i - 1]))
            m->p[k++] = v3(all[i].p[0], all[i].p[1], all[i].p[2]);
    for (size_t i = 0; i < 3 * (size_t)m->ntris; i++)
        m->tri[i / 3].v[i % 3] = now[m->tri[i / 3].v[i % 3]];
    m->nverts = n;
    free(all);
    free(now);
}

/* mesh.c -- what all meshes share: their memory, and dropping triangles without area. */
#include "geometry/mesh.h"

#include "base/d3.h"

bool mesh_alloc(Mesh *m, size_t nverts, size_t ntris, bool normals, bool uv)
{
    m->p = MEM_ARRAY(V3, nverts);
    m->n = normals ? MEM_ARRAY(V3, nverts) : NULL;
    m->uv = uv ? MEM_ARRAY(V2, nverts) : NULL;
    m->tri = MEM_ARRAY(Tri, ntris);
    if (m->p && (m->n || !normals) && (m->uv || !uv) && m->tri)
        return true;
    mesh_clear(m);
    return false;
}

void mesh_clear(Mesh *m)
{
    mem_free(m->p);
    mem_free(m->n);
    mem_free(m->uv);
    mem_free(m->tri);
    mem_free(m->group);
    *m = (Mesh){ 0 };
}

/* In double, where neither the product of two tiny edges underflows nor that of two huge ones
 * overflows, so that only triangles without area count as such. */
static bool has_area(V3 a, V3 b, V3 c)
{
    D3 n = d3_normal(a, b, c);
    return n.x != 0.0 || n.y != 0.0 || n.z != 0.0;
}

uint32_t mesh_drop_degenerate(Mesh *m)
{
    uint32_t kept = 0, dropped;

    for (uint32_t i = 0; i < m->ntris; i++) {
        Tri t = m->tri[i];
        if (!has_area(m->p[t.v[0]], m->p[t.v[1]], m->p[t.v[2]]))
            continue;
        if (m->group)
            m->group[kept] = m->group[i];
        m->tri[kept++] = t;
    }
    dropped = m->ntris - kept;
    m->ntris = kept;
    return dropped;
}

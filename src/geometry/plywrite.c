/* plywrite.c -- meshes as PLY files, binary little-endian. See meshfile.h. */
#include "geometry/meshfile.h"

#include "base/bits.h"
#include "base/file.h"

#include <stdio.h>

static unsigned char *put_u32(unsigned char *b, uint32_t v)
{
    for (int k = 0; k < 4; k++)
        *b++ = (unsigned char)(v >> 8 * k);
    return b;
}

static unsigned char *put_float(unsigned char *b, float v)
{
    return put_u32(b, bits_of_float(v));
}

static unsigned char *put_v3(unsigned char *b, V3 v)
{
    return put_float(put_float(put_float(b, v.x), v.y), v.z);
}

static void write_header(const Mesh *m, Out *o)
{
    char line[80];

    out_text(o, "ply\nformat binary_little_endian 1.0\ncomment rushlight\n");
    snprintf(line, sizeof line, "element vertex %lu\n", (unsigned long)m->nverts);
    out_text(o, line);
    out_text(o, "property float x\nproperty float y\nproperty float z\n");
    if (m->n)
        out_text(o, "property float nx\nproperty float ny\nproperty float nz\n");
    if (m->uv)
        out_text(o, "property float u\nproperty float v\n");
    snprintf(line, sizeof line, "element face %lu\n", (unsigned long)m->ntris);
    out_text(o, line);
    out_text(o, "property list uchar uint vertex_indices\nend_header\n");
}

bool ply_write(const Mesh *m, const char *path)
{
    unsigned char record[32], *b;
    Out *o = out_open(path);

    if (!o)
        return false;
    write_header(m, o);
    for (uint32_t i = 0; i < m->nverts; i++) {
        b = put_v3(record, m->p[i]);
        if (m->n)
            b = put_v3(b, m->n[i]);
        if (m->uv)
            b = put_float(put_float(b, m->uv[i].x), m->uv[i].y);
        out_write(o, record, (size_t)(b - record));
    }
    for (uint32_t i = 0; i < m->ntris; i++) {
        record[0] = 3;
        b = record + 1;
        for (int k = 0; k < 3; k++)
            b = put_u32(b, m->tri[i].v[k]);
        out_write(o, record, (size_t)(b - record));
    }
    return out_close(o);
}

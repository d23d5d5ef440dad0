/* memory.c -- table 3.1: what the structures take beside the geometry. */
#include "bench/bench.h"
#include "bench/models.h"

#include <stdio.h>
#include <string.h>

enum { CELLS = 1 + COLUMNS };           /* geometry, then the structures */
#define MIB 1048576.0

typedef struct { double printed[CELLS], formula[CELLS], held[CELLS]; } Cells;   /* MiB; 0: none */

/* ---- where cells come from ---- */

static void set_printed(Cells *c, const PrintedScene *s)
{
    c->printed[0] = s->geometry;
    memcpy(c->printed + 1, s->mib, sizeof s->mib);
}

static void set_formula(Cells *c, const Model *m)
{
    const Geometry *g = &m->scene->geometries[0];
    double *f = c->formula + 1;

    c->formula[0] = geometry_formula((double)m->tris) / MIB;
    f[PRINTED_BVH] = m->tris ? bvh_formula((double)m->tris) / MIB : 0;
    for (size_t i = 0; i < g->nmeshes; i++) {
        uint32_t n = g->shapes[g->mesh_shapes[i]].count;
        f[PRINTED_SHORT] += lbvh_formula(n, 16) / MIB;
        f[PRINTED_BYTE] += lbvh_formula(n, 8) / MIB;
    }
}

/* What the allocator has given and not got back: one structure at a time, each over the triangles
 * as the one before has left them, which is nothing to its size. */
static bool set_held(Cells *c, const Model *m)
{
    Arena arena = { NULL, 0, 0 };
    bool ok = true;

    c->held[0] = (double)m->bytes / MIB;
    for (int i = 0; ok && i < COLUMNS; i++) {
        CastConfig config = config_of(table_column(i)->ours, &arena);
        size_t before;
        scene_drop_accels(m->scene);
        before = mem_bytes();
        ok = scene_build_accels(m->scene, config.kind, &config.opts, processors());
        c->held[1 + i] = (double)(mem_bytes() - before) / MIB;
    }
    scene_drop_accels(m->scene);
    arena_clear(&arena);
    return ok;
}

/* ---- printing ---- */

/* Would it be printed otherwise than the document has it? */
static char mark(double v, double printed, int digits)
{
    char have[40], want[40];

    snprintf(have, sizeof have, "%.*f", digits, v);
    snprintf(want, sizeof want, "%.*f", digits, printed);
    return printed > 0 && strcmp(have, want) ? '*' : ' ';
}

static void print_row(const double *v, const double *printed, int digits)
{
    for (int i = 0; i < CELLS; i++)
        cell(v[i], digits, v[i] > 0, mark(v[i], printed[i], digits));
    printf("\n");
}

static void measure(const Model *m)
{
    int digits = m->printed ? m->printed->digits : m->tris < 1000000 ? 2 : 1;
    double each[CELLS], none[CELLS] = { 0 };
    char n[32];
    Cells c;

    memset(&c, 0, sizeof c);
    if (m->printed)
        set_printed(&c, m->printed);
    set_formula(&c, m);
    if (!m->tris || !set_held(&c, m))
        return;
    for (int i = 0; i < CELLS; i++)
        each[i] = c.held[i] * MIB / (double)m->tris;
    printf("\n%s, %s triangles\n", m->name, with_commas(n, m->tris));
    if (m->printed) {
        line_head("", "printed");
        print_row(c.printed, none, digits);
    }
    line_head("", "by formula");
    print_row(c.formula, c.printed, digits);
    line_head("", "measured");
    print_row(c.held, c.printed, digits);
    line_head("", "bytes each");
    print_row(each, none, 2);
    fflush(stdout);
}

static const char notes[] = "\n"
"Measured is what the allocator holds for a finished structure, with its headers; bytes each\n"
"is that for a triangle. Cells marked * are not what is printed:\n"
"  geometry  The formula is 28 bytes a triangle: three pointers, and half a vertex with\n"
"            normal and texture coordinates. Made meshes have these; files may have less, or\n"
"            more vertices. The Bunnies are 100.145 MiB, and above 100.15 with what 54 meshes\n"
"            have besides. The Angel's 28,055,742 triangles are 749.17 MiB: 749.1 where\n"
"            digits are cut off.\n"
"  grid      Depends on the scene, so there is no formula: one voxel a triangle, 4 bytes\n"
"            each, and 4 for each triangle that is in it. The document had scans in grids of\n"
"            their own, these are bumpy bodies in one. Its cells come to 9.4 to 25.6 bytes a\n"
"            triangle.\n"
"BVH is 32 bytes a node, 2 n - 1 nodes (ours over all meshes at once); short and byte are 12\n"
"and 6 bytes a node, 4 ceil((n - 1) / 3) + 1 nodes for each mesh. All have one triangle a\n"
"leaf. The Angel's BVH is not printed: it did not fit into the 2 GB of that machine. Right of\n"
"byte are more of ours: four triangles a leaf, as the document suggests in 3.4.3, with shorts\n"
"and with bytes of the parent's box; and kdtree and wide, the latter in its lean form.\n";

void bench_memory(void)
{
    printf("\nTable 3.1: memory of geometry and structures, MiB\n\n");
    table_head("geometry");
    models_each(UINT64_MAX, measure);
    fputs(notes, stdout);
}

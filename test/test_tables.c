/* test_tables.c -- the document's table of memory: its cells follow from formulas, and from the
 * structures as they are. */
#include "accel/accel.h"
#include "base/mem.h"
#include "bench/printed.h"
#include "geometry/generate.h"
#include "test/ray_help.h"

#include <stdio.h>
#include <string.h>

/* To the digits that are printed. instead: what a cell that differs comes to; NULL: none does. */
static void expect_cell(const PrintedScene *s, const char *what, double bytes, double printed,
                        const char *instead)
{
    char have[40], want[40];

    snprintf(have, sizeof have, "%.*f", s->digits, bytes / 1048576);
    snprintf(want, sizeof want, "%.*f", s->digits, printed);
    EXPECT(!strcmp(have, instead ? instead : want), "%s of %s: %s MiB, %s are printed", what,
           s->name, have, want);
}

/* 4 ceil((n - 1) / 3) + 1, which is what step 3 of fig. 3.1 comes to. */
static void nodes(void)
{
    Form f = { 4, 1, 0 };

    for (uint32_t n = 1; n < 3000; n++)
        EXPECT(forest_nodes(f, n) == 4 * ((n - 1 + 2) / 3) + 1, "%lu triangles: %lu nodes",
               (unsigned long)n, (unsigned long)forest_nodes(f, n));
    /* Pieces of 833, 833 and 834 triangles. */
    EXPECT(forest_nodes((Form){ 4, 1, 1000 }, 2500) ==
           2 * forest_nodes(f, 833) + forest_nodes(f, 834), "pieces: %lu nodes",
           (unsigned long)forest_nodes((Form){ 4, 1, 1000 }, 2500));
}

static void formulas(void)
{
    for (int i = 0; i < PRINTED_SCENES; i++) {
        const PrintedScene *s = &printed_scenes[i];
        double n = (double)s->meshes * s->triangles;
        expect_cell(s, "geometry", geometry_formula(n), s->geometry,
                    strcmp(s->name, "Angel") ? NULL : "749.2");
        if (s->mib[PRINTED_BVH] > 0)
            expect_cell(s, "BVH", bvh_formula(n), s->mib[PRINTED_BVH], NULL);
        expect_cell(s, "short", s->meshes * lbvh_formula(s->triangles, 16), s->mib[PRINTED_SHORT],
                    NULL);
        expect_cell(s, "byte", s->meshes * lbvh_formula(s->triangles, 8), s->mib[PRINTED_BYTE],
                    NULL);
    }
}

/* Bytes that building takes and keeps. */
static double built(const Geometry *g, const char *text)
{
    Arena arena = { NULL, 0, 0 };
    Opts o;
    const AccelKind *kind = kind_from_text(accels, "accelerator", text, &o, &arena);
    size_t before;
    Accel *a;
    double bytes;

    REQUIRE(kind, "%s", text);
    before = mem_bytes();
    a = accel_build_as_is(kind, g, &o, 1);
    REQUIRE(a, "%s", text);
    bytes = (double)(mem_bytes() - before);
    accel_free(a);
    arena_clear(&arena);
    return bytes;
}

/* The smaller scenes as they are in memory. */
static void structures(void)
{
    for (int i = 0; i < PRINTED_SCENES; i++) {
        const PrintedScene *s = &printed_scenes[i];
        Mesh m;
        Geometry g;
        if (s->meshes > 1 || s->triangles > 100000)
            continue;
        REQUIRE(mesh_bumpy_of(&m, s->triangles, 1), "memory");
        geometry_of(&g, &m);
        EXPECT(g.ntris == s->triangles, "%lu triangles", (unsigned long)g.ntris);
        for (int k = 0; k < PRINTED; k++)
            if (k != PRINTED_GRID)
                expect_cell(s, printed_structures[k].ours, built(&g, printed_structures[k].ours),
                            s->mib[k], NULL);
        geometry_clear(&g);
    }
}

const TestCase test_tables[] = {
    { "nodes", nodes, false },
    { "formulas", formulas, false },
    { "structures", structures, false },
    { NULL, NULL, false }
};

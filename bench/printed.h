/* printed.h -- what the document prints of the memory and the speed of its structures, and the
 * formulas behind the former.
 *
 * Source     [Cline07 3.2.3, 3.3, 3.4] tables 3.1 and 3.2.
 * Unit       "Megabytes" are 2^20 bytes: with 10^6 no number of triangles gives the cells of a
 *            column.
 * Triangles  The document tells their numbers in a picture only. But the cells of geometry, BVH and
 *            LBVH follow from formulas, which leaves few numbers for each scene: 22,856 to 22,937
 *            for the Skull, 69,387 to 69,468 for the Bunny, 1,087,079 to 1,087,897 for Buddha,
 *            3,749,479 to 3,750,531 for the Bunnies, 7,218,791 to 7,219,609 for the Dragon. The
 *            well-known scans of these names are among them, the Bunnies being 54. The Angel's,
 *            28,055,742, gives all cells but that of its geometry, which is 749.17. For the Skull,
 *            which is not known, we take a number. */
#ifndef BENCH_PRINTED_H
#define BENCH_PRINTED_H

#include "accel/forest.h"

enum { PRINTED_BVH, PRINTED_GRID, PRINTED_SHORT, PRINTED_BYTE, PRINTED };

/* The structures of both tables, and ours that are the same: one object a leaf, one voxel an
 * object. */
typedef struct { const char *name, *ours; } Structure;
static const Structure printed_structures[PRINTED] = {
    { "BVH", "bvh:split=median,leaf=1" }, { "grid", "grid:density=1,nested=0" },
    { "short", "lbvh:bits=16,leaf=1" }, { "byte", "lbvh:bits=8,leaf=1" },
};

typedef struct {
    const char *name;
    const char *files;          /* other names that files with this scene have */
    uint32_t meshes, triangles; /* triangles of each */
    int    digits;              /* of the cells of table 3.1, after the point */
    double geometry, mib[PRINTED], seconds[PRINTED];    /* 0: not printed */
} PrintedScene;

enum { PRINTED_SCENES = 6 };
static const PrintedScene printed_scenes[PRINTED_SCENES] = {
    { "Skull", "", 1, 22870, 2, 0.61, { 1.40, 0.56, 0.35, 0.17 }, { 18.5, 19.4, 20.3, 21.1 } },
    { "Bunny", "bun_zipper", 1, 69451, 2, 1.85,
      { 4.24, 0.94, 1.06, 0.53 }, { 6.6, 13.0, 7.8, 9.5 } },
    { "Buddha", "happy_vrip", 1, 1087716, 1, 29.0,
      { 66.4, 13.3, 16.6, 8.3 }, { 9.2, 62.7, 9.6, 16.9 } },
    { "Bunnies", "", 54, 69451, 1, 100.1,
      { 228.9, 44.4, 57.2, 28.6 }, { 15.3, 43.2, 18.7, 23.3 } },
    { "Dragon", "xyzrgb_dragon", 1, 7219045, 1, 192.8,
      { 440.6, 64.8, 110.2, 55.1 }, { 8.0, 45.3, 7.9, 37.7 } },
    { "Angel", "lucy", 1, 28055742, 1, 749.1,
      { 0, 252.2, 428.1, 214.0 }, { 0, 63.6, 9.5, 57.4 } },
};

/* ---- bytes ---- */

/* Three pointers of 4 bytes, and half a vertex with its normal and texture coordinates. */
static inline double geometry_formula(double triangles) { return 28 * triangles; }

/* Binary, one triangle a leaf, 32 bytes a node. */
static inline double bvh_formula(double triangles) { return 32 * (2 * triangles - 1); }

/* Of one mesh: four children a node, one triangle a leaf, six planes a node. */
static inline double lbvh_formula(uint32_t triangles, int bits)
{
    return 6.0 * bits / 8 * (double)forest_nodes((Form){ 4, 1, 0 }, triangles);
}

#endif

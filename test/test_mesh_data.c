/* test_mesh_data.c -- meshes that others wrote: those of the test data, whole and broken. */
#include "test/mesh_help.h"

#include "base/file.h"

#include <stdio.h>
#include <string.h>

/* Counts as the data's own README gives them; vertices of files with vt or vn are the distinct
 * corners, counted by sort -u. `says` as in TextCase. */
static const struct { const char *name; bool ok; unsigned nverts, ntris; const char *says; }
data_files[] = {
    { "meshes/bun_zipper.ply", true, 35947, 69451, "" },
    { "meshes/bun_zipper_be.ply", true, 35947, 69451, "" },
    { "meshes/bun_zipper_res4.ply", true, 453, 948, "" },
    { "meshes/dragon_vrip_res2.ply", true, 100250, 202520, "" },
    { "meshes/armadillo_100k.obj", true, 49990, 99976, "" },
    { "meshes/igea_tristrips.ply", true, 134345, 268686, "" },
    { "meshes/conference.ply", true, 194399, 331179, "" },
    { "meshes/teapot.obj", true, 3644, 6320, "" },
    { "meshes/suzanne.obj", true, 507, 968, "" },
    { "meshes/spot_triangulated.obj", true, 3225, 5856, "" },
    { "meshes/spot_quadrangulated.obj", true, 3225, 5856, "" },
    { "meshes/fandisk.obj", true, 6475, 12946, "" },
    { "obj/CornellBox-Original.obj", true, 72, 36, "" },
    { "obj/forms/box.obj", true, 8, 12, "" },
    { "obj/forms/box_longline.obj", true, 8, 944, "" },
    { "obj/forms/box_without_lineending.obj", true, 8, 12, "" },
    { "obj/forms/catmark_torus_creases0.obj", true, 128, 64, "8 (first 't'); normals or texture "
      "coordinates that are not in the file left out: 128" },
    { "obj/forms/concave_polygon.obj", true, 64, 64, "" },
    { "obj/forms/cornell_box.obj", true, 76, 36, "" },
    { "obj/forms/cube-vertexcol.obj", true, 8, 12, "" },
    { "obj/forms/cube.obj", true, 8, 12, "" },
    { "obj/forms/cube_usemtl.obj", true, 24, 12, "" },
    { "obj/forms/cube_with_materials.obj", true, 24, 12, "" },
    { "obj/forms/cubevt.obj", true, 24, 12, "not in the file left out: 36" },
    { "obj/forms/issue-138.obj", true, 24, 12, "" },
    { "obj/forms/leading-decimal-dot-issue-201.obj", true, 3, 1, "" },
    { "obj/forms/line-prim.obj", true, 8, 0, "no triangles" },
    { "obj/forms/multiple_spaces.obj", true, 3, 1, "" },
    { "obj/forms/negative_indices.obj", true, 24, 12, "" },
    { "obj/forms/number_formats.obj", false, 0, 0, ":11:14: coordinate of a vertex is '3.1+e2'" },
    { "obj/forms/points-prim.obj", true, 8, 0, "no triangles" },
    { "obj/forms/polygonfaces.obj", true, 5, 3, "" },
    { "obj/forms/single_triangle_negative_indices.obj", true, 3, 1, "" },
    { "obj/forms/singlevn.obj", true, 4, 2, "" },
    { "obj/forms/smoothing-group-two-squares.obj", true, 6, 3, "not in the file left out: 7" },
    { "obj/forms/spider.obj", true, 974, 1368, "" },
    { "obj/forms/usemtl-issue-104.obj", true, 12, 6, "" },
    { "ply-forms/cbox_smallbox.ply", true, 24, 12, "" },
    { "ply-forms/cube.ply", true, 8, 12, "" },
    { "ply-forms/cube_binary.ply", true, 8, 12, "" },
    { "ply-forms/cube_uv.ply", true, 24, 12, "" },
    { "ply-forms/float-color.ply", true, 3, 1, "" },
    { "ply-forms/platonic_shelf.ply", true, 50, 80, "" },
    { "ply-forms/platonic_shelf_ascii.ply", true, 50, 80, "" },
    { "ply-forms/platonic_shelf_big_endian.ply", true, 50, 80, "" },
    { "ply-forms/points.ply", true, 4, 0, "no triangles" },
    { "ply-forms/rectangle_normals.ply", true, 4, 2, "" },
    { "ply-forms/rectangle_normals_uv.ply", true, 4, 2, "" },
    { "ply-forms/rectangle_uv.ply", true, 4, 2, "" },
    { "ply-forms/triangle.ply", true, 3, 1, "" },
    { "ply-forms/triangle_face_colors.ply", true, 3, 1, "" },
};

static void data_counts(void)
{
    char line[1000];

    test_data("meshes");
    messages_start();
    for (size_t k = 0; k < sizeof data_files / sizeof *data_files; k++) {
        const char *name = data_files[k].name, *path = test_data(name);
        MeshFileKind kind = !strcmp(path_extension(name), "ply") ? FILE_PLY : FILE_OBJ;
        FileBytes bytes;
        MeshFile f;
        int told;
        REQUIRE(file_read(path, FILE_LIMIT_DEFAULT, &bytes), "cannot read %s", path);
        f = mesh_file_read(kind, name, (const unsigned char *)bytes.bytes, bytes.size);
        file_clear(&bytes);
        told = messages_take(line, sizeof line);
        EXPECT(f.ok == data_files[k].ok && f.mesh.nverts == data_files[k].nverts &&
               f.mesh.ntris == data_files[k].ntris, "%s: %lu vertices, %lu triangles", name,
               (unsigned long)f.mesh.nverts, (unsigned long)f.mesh.ntris);
        EXPECT(told == (data_files[k].says[0] != 0) && strstr(line, data_files[k].says),
               "%s: %d messages, '%s'", name, told, line);
        EXPECT(!mesh_file_fault(kind, &f), "%s: %s", name, mesh_file_fault(kind, &f));
        mesh_file_clear(kind, &f);
    }
    EXPECT(mem_blocks() == 0, "%ld blocks left", mem_blocks());
}

/* One mesh in two or three encodings. */
static void data_encodings(void)
{
    static const char *const same[][2] = {
        { "meshes/bun_zipper.ply", "meshes/bun_zipper_be.ply" },
        { "ply-forms/platonic_shelf.ply", "ply-forms/platonic_shelf_big_endian.ply" },
        { "ply-forms/platonic_shelf.ply", "ply-forms/platonic_shelf_ascii.ply" }
    };

    for (int k = 0; k < 3; k++) {
        Mesh a = mesh_of_ply(test_data(same[k][0])), b = mesh_of_ply(test_data(same[k][1]));
        float worst = 0.0f;
        EXPECT(a.ntris == b.ntris && !memcmp(a.tri, b.tri, a.ntris * sizeof *a.tri),
               "%s: triangles", same[k][0]);
        for (uint32_t i = 0; i < a.nverts; i++)
            worst = f_max(worst, v_max3(v_abs(v_sub(a.p[i], b.p[i]))));
        /* hapPLY prints six digits of coordinates below 10 */
        EXPECT(worst <= (k == 2 ? 0.5e-5f : 0.0f), "%s: %g apart", same[k][0], (double)worst);
        mesh_clear(&a);
        mesh_clear(&b);
    }
}

static const char *const malformed[] = {
    "obj/afl_000005.obj", "obj/afl_000011.obj", "obj/afl_000017.obj", "obj/afl_000023.obj",
    "obj/afl_000029.obj", "obj/afl_000035.obj", "obj/afl_000041.obj", "obj/afl_000047.obj",
    "obj/afl_000053.obj", "obj/afl_000059.obj", "obj/afl_000065.obj", "obj/afl_000071.obj",
    "obj/afl_000077.obj", "obj/empty.obj", "obj/invalid-face-definition.obj",
    "obj/invalid-relative-vertex-index.obj", "obj/malformed.obj", "obj/notenoughindices.obj",
    "obj/test-nan.obj", "ply/bun_zipper_be_cut.ply", "ply/crash-30d6d0f7.ply", "ply/empty.ply",
    "ply/ply_empty_ascii.ply", "ply/ply_empty_header.ply"
};

/* Exactly one message each, an error or a warning; in little memory. */
static void data_malformed(void)
{
    char line[1000], name[100];

    test_data("malformed");
    messages_start();
    for (size_t k = 0; k < sizeof malformed / sizeof *malformed; k++) {
        MeshFileKind kind = malformed[k][0] == 'p' ? FILE_PLY : FILE_OBJ;
        FileBytes bytes;
        MeshFile f;
        int told;
        snprintf(name, sizeof name, "malformed/%s", malformed[k]);
        REQUIRE(file_read(test_data(name), FILE_LIMIT_DEFAULT, &bytes), "cannot read %s", name);
        err_reset();
        mem_fail_at(0, false);
        f = mesh_file_read(kind, name, (const unsigned char *)bytes.bytes, bytes.size);
        EXPECT(mem_peak() <= 17 * bytes.size + (1 << 20), "%s: %lu bytes", name,
               (unsigned long)mem_peak());
        file_clear(&bytes);
        told = messages_take(line, sizeof line);
        EXPECT(told == 1 && strstr(line, malformed[k]), "%s: %d messages, '%s'", name, told, line);
        EXPECT((err_status() == STATUS_INPUT) == !f.ok, "%s: status", name);
        EXPECT(!mesh_file_fault(kind, &f), "%s: %s", name, mesh_file_fault(kind, &f));
        mesh_file_clear(kind, &f);
    }
    EXPECT(mem_blocks() == 0, "%ld blocks left", mem_blocks());
}

const TestCase test_mesh_data[] = {
    { "counts", data_counts, false },
    { "encodings", data_encodings, false },
    { "malformed", data_malformed, false },
    { NULL, NULL, false }
};

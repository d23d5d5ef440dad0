/* test_mesh.c -- reading OBJ, MTL and PLY of text: what the files say is what comes out, and what
 * is wrong with them is said once, at its place. */
#include "test/mesh_help.h"

#include "base/random.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- small texts ---- */

/* What must come of a text. Messages: none if `says` is "", else one that holds it. */
typedef struct {
    const char *name, *text;
    size_t size;                                /* 0: up to the final 0 */
    bool ok;
    unsigned nverts, ntris;                     /* for MTL: materials, 0 */
    const char *says;
} TextCase;

#define SIZED(s) s, sizeof s - 1

static void check_text(MeshFileKind kind, const char *file, const TextCase *c)
{
    size_t n = c->size ? c->size : strlen(c->text);
    unsigned char *block = malloc(n ? n : 1);
    char line[1000];
    MeshFile f;
    size_t nverts;
    int told;

    REQUIRE(block, "memory");
    memcpy(block, c->text, n);
    err_reset();
    f = mesh_file_read(kind, file, block, n);
    free(block);                                /* nothing may point into it */
    told = messages_take(line, sizeof line);
    EXPECT(f.ok == c->ok, "%s: %s: '%s'", c->name, f.ok ? "read" : "refused", line);
    EXPECT(told == (c->says[0] != 0) && strstr(line, c->says), "%s: %d messages, '%s'", c->name,
           told, line);
    EXPECT((err_status() == STATUS_INPUT) == !c->ok, "%s: status %d", c->name, (int)err_status());
    EXPECT(!mesh_file_fault(kind, &f), "%s: %s", c->name, mesh_file_fault(kind, &f));
    nverts = kind == FILE_MTL ? f.mtl.n : f.mesh.nverts;
    EXPECT(!f.ok || (nverts == c->nverts && (kind == FILE_MTL || f.mesh.ntris == c->ntris)),
           "%s: %lu vertices or materials, %lu triangles", c->name, (unsigned long)nverts,
           kind == FILE_MTL ? 0ul : (unsigned long)f.mesh.ntris);
    mesh_file_clear(kind, &f);
    EXPECT(mem_blocks() == 0, "%s: %ld blocks left", c->name, mem_blocks());
}

static void check_texts(MeshFileKind kind, const char *file, const TextCase *cases)
{
    messages_start();
    for (; cases->name; cases++)
        check_text(kind, file, cases);
}

#define V3_ "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
#define VT3 "vt 0 0\nvt 1 0\nvt 0 1\n"
#define VN1 "vn 0 0 2\n"

static const TextCase obj_cases[] = {
    { "v", V3_ "f 1 2 3\n", 0, true, 3, 1, "" },
    { "v/vt", V3_ VT3 "f 1/1 2/2 3/3\n", 0, true, 3, 1, "" },
    { "v//vn", V3_ VN1 "f 1//1 2//1 3//1\n", 0, true, 3, 1, "" },
    { "v/vt/vn", V3_ VT3 VN1 "f 1/1/1 2/2/1 3/3/1\n", 0, true, 3, 1, "" },
    { "empty attributes", V3_ "f 1// 2/ 3//\n", 0, true, 3, 1, "" },
    { "mixed forms share vertices", V3_ VT3 "f 1/1 2/2 3/3\nf 1/1 2/2 3\nf 3 2/2 1/1\n", 0, true,
      4, 3, "" },
    { "negative", V3_ VT3 VN1 "f -3/-3/-1 -2/-2/-1 -1/-1/-1\nv 1 1 1\nf -1//1 -2 -3\n", 0, true,
      6, 2, "" },
    { "negative counts what stands above", "v 0 0 0\nf -1 -1 -2\nv 1 0 0\n", 0, false, 0, 0,
      "t.obj:2:9: corner '-2'" },
    { "positive may point below", "f 1 2 3\n" V3_, 0, true, 3, 1, "" },
    { "unused vertices stay", V3_ "v 9 9 9\nf 1 2 3\n", 0, true, 4, 1, "" },
    { "unused corners go", V3_ "v 9 9 9\n" VT3 "f 1/1 2/2 3/3\n", 0, true, 3, 1, "" },
    { "quad and pentagon", V3_ "v 1 1 0\nv 2 2 0\nf 1 2 4 3\nf 1 2 5 4 3\n", 0, true, 5, 5, "" },
    { "old face word", V3_ "fo 1 2 3\n", 0, true, 3, 1, "" },
    { "continuation", "v 0 0 \\\n0\nv 1 0 0\nv 0 1 0\nf 1 \\\n 2\\\n\\\n3\\\n\n", 0, true, 3, 1,
      "" },
    { "continuation CRLF", "v 0 0 \\\r\n0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 \\\r\n 2 3\r\n", 0, true,
      3, 1, "" },
    { "continuation at the end", V3_ "f 1 2 3\\", 0, true, 3, 1, "" },
    { "continued unknown line", V3_ "curv 1 2 \\\n3 4\nf 1 2 3\n", 0, true, 3, 1,
      "t.obj:4:1: warning: statements that are not supported left out: 1 (first 'curv')" },
    { "comment is not continued", "# C:\\\n" V3_ "f 1 2 3\n", 0, true, 3, 1, "" },
    { "comments", "#\n" V3_ "f 1 2 3 # 9 9\n#f 9 9 9\n  # f 9 9 9", 0, true, 3, 1, "" },
    { "CRLF", "v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\r\n", 0, true, 3, 1, "" },
    { "CR", "v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r", 0, true, 3, 1, "" },
    { "CR, place", "v 0 0 0\r\rv 1 0 0\rv 0 1\r", 0, false, 0, 0, "t.obj:4:6: " },
    { "no final newline", V3_ "f 1 2 3", 0, true, 3, 1, "" },
    { "BOM", "\xEF\xBB\xBF" V3_ "f 1 2 3\n", 0, true, 3, 1, "" },
    { "tabs and blanks", "\tv\t0  0\t0 \n v 1 0 0\t\nv 0 1 0\n f  1\t2 \t3\t\n", 0, true, 3, 1,
      "" },
    { "NUL in a comment", SIZED("# \0\n" V3_ "f 1 2 3\n"), true, 3, 1, "" },
    { "NUL in a number", SIZED("v 0 0\0 0\n"), false, 0, 0, "t.obj:1:5: " },
    { "NUL in a keyword", SIZED(V3_ "f\0 1 2 3\n"), true, 3, 0, "no triangles" },
    { "NUL in a name", SIZED(V3_ "usemtl a\0b\nf 1 2 3\n"), false, 0, 0,
      "t.obj:4:8: a name with a byte 0" },
    { "NUL in a library", SIZED("mtllib a \0.mtl\n"), false, 0, 0, "t.obj:1:8: a name" },
    { "w and colours", "v 0 0 0 1\nv 1 0 0 0.5 0.5 0.5\nv 0 1 0\nf 1 2 3\n", 0, true, 3, 1, "" },
    { "vt of one and three", V3_ "vt 0.5\nvt 0 1 2\nf 1/1 2/2 3/1\n", 0, true, 3, 1, "" },
    { "groups", "o a\ng b c\ns off\ns 1\nmg 1\n" V3_ "g\nf 1 2 3\n", 0, true, 3, 1, "" },
    { "lines and points", V3_ "l 1 2\np 3\nf 1 2 3\n", 0, true, 3, 1, ": 2 (first 'l')" },
    { "many unknown words", V3_ "abc 1\nd\ne\nabc\nf 1 2 3\n", 0, true, 3, 1,
      "t.obj:4:1: warning: statements that are not supported left out: 4 (first 'abc')" },
    { "short faces", V3_ "f 1 2\nf\nf 1\nf 1 2 3\n", 0, true, 3, 1,
      "t.obj:4:1: warning: faces of fewer than 3 corners left out: 3" },
    { "vt and vn that are not there", V3_ VT3 "f 1/1/1 2/4 3/-4\n", 0, true, 3, 1,
      "t.obj:7:3: warning: normals or texture coordinates that are not in the file left out: 3" },
    { "empty", "", 0, true, 0, 0, "t.obj: warning: no triangles" },
    { "index 0", V3_ "f 1 0 2\n", 0, false, 0, 0, "t.obj:4:5: corner '0', but there are 3 vert" },
    { "index too large", V3_ "f 1 2 4\n", 0, false, 0, 0, "t.obj:4:7: corner '4'" },
    { "index too small", V3_ "f 1 2 -4\n", 0, false, 0, 0, "t.obj:4:7: corner '-4'" },
    { "index beyond 64 bits", V3_ "f 1 2 99999999999999999999999\n", 0, false, 0, 0, "t.obj:4:7" },
    { "index below 64 bits", V3_ "f 1 2 -99999999999999999999999\n", 0, false, 0, 0, "t.obj:4:7" },
    { "index 2^32 + 1", V3_ "f 1 2 4294967297\n", 0, false, 0, 0, "t.obj:4:7: corner" },
    { "index with a point", V3_ "f 1 2 3.0\n", 0, false, 0, 0, "integers was expected" },
    { "four parts", V3_ "f 1 2 3/1/1/1\n", 0, false, 0, 0, "t.obj:4:7: corner '3/1/1/1'" },
    { "rubbish corner", V3_ "f 1 2 x\n", 0, false, 0, 0, "t.obj:4:7: corner 'x'" },
    { "missing coordinate", "v 0 0\n", 0, false, 0, 0, "t.obj:1:6: coordinate of a vertex is mis" },
    { "rubbish coordinate", "\nv 0 1-2 0\n", 0, false, 0, 0, "t.obj:2:5: coordinate of a vertex" },
    { "NaN vertex", "v 0 0 0\n v 0 nan 0\n", 0, false, 0, 0, "t.obj:2:4: vertex that is infinite" },
    { "infinite vertex", "v 0 1e39 0\n", 0, false, 0, 0, "t.obj:1:3: vertex that is infinite" },
    { "decimal comma", "v 0,5 0 0\n", 0, false, 0, 0, "t.obj:1:3: " },
    { NULL, NULL, 0, false, 0, 0, NULL }
};

static void obj_texts(void) { check_texts(FILE_OBJ, "t.obj", obj_cases); }

#define HEAD "ply\nformat ascii 1.0\n"
#define XYZ "property float x\nproperty float y\nproperty float z\n"
#define LIST "property list uchar int vertex_indices\n"
#define VERTS HEAD "element vertex 3\n" XYZ
#define FACE VERTS "element face 1\n" LIST "end_header\n"
#define XYZ3 "0 0 0\n1 0 0\n0 1 0\n"

static const TextCase ply_cases[] = {
    { "triangle", FACE XYZ3 "3 0 1 2\n", 0, true, 3, 1, "" },
    { "no final newline", FACE XYZ3 "3 0 1 2", 0, true, 3, 1, "" },
    { "vertex_index, other type names",
      HEAD "element vertex 3\nproperty float64 x\nproperty int8 y\nproperty uint16 z\n"
      "element face 1\nproperty list uint32 int16 vertex_index\nend_header\n"
      XYZ3 "3 0 1 2\n", 0, true, 3, 1, "" },
    { "CRLF", "ply\r\nformat ascii 1.0\r\nelement vertex 3\r\nproperty float x\r\nproperty float "
      "y\r\nproperty float z\r\nelement face 1\r\nproperty list uchar int vertex_indices\r\n"
      "end_header\r\n0 0 0\r\n1 0 0\r\n0 1 0\r\n3 0 1 2\r\n", 0, true, 3, 1, "" },
    { "CR", "ply\rformat ascii 1.0\relement vertex 1\rproperty float x\rproperty float y\r"
      "property float z\rend_header\r0 0 0\r", 0, true, 1, 0, "no triangles" },
    { "BOM", "\xEF\xBB\xBF" FACE XYZ3 "3 0 1 2\n", 0, true, 3, 1, "" },
    { "comments and blank lines", "ply\ncomment a\nformat ascii 1.0\n\nobj_info b c\ncomment\n"
      "element vertex 1\n" XYZ "comment end_header\nend_header\n\n\n1 2 3\n\n", 0, true, 1, 0,
      "no triangles" },
    { "blanks at line ends", "ply \nformat ascii 1.0  \nelement vertex 1 \n" XYZ
      "end_header \n 1\t2 3 \n", 0, true, 1, 0, "no triangles" },
    { "faces before vertices", HEAD "element face 1\n" LIST "element vertex 3\n" XYZ
      "end_header\n3 0 1 2\n" XYZ3, 0, true, 3, 1, "" },
    { "faces on both sides", HEAD "element face 1\n" LIST "element vertex 3\n" XYZ
      "element face 2\n" LIST "end_header\n3 0 1 2\n" XYZ3 "3 0 1 2\n4 0 1 2 1\n", 0, true, 3, 4,
      "" },
    { "lists and unknown properties", HEAD "element vertex 3\nproperty list uchar float a\n"
      "property float x\nproperty uchar red\nproperty float y\nproperty list int int b\n"
      "property float z\nelement face 1\nproperty int id\n" LIST "property list uchar float "
      "texcoord\nend_header\n2 8 9 0 255 0 0 0\n0 1 255 0 1 7 0\n0 0 255 1 2 7 7 0\n"
      "77 3 0 1 2 6 0 0 1 0 0 1\n", 0, true, 3, 1, "" },
    { "unknown elements", HEAD "element camera 2\nproperty float a\nproperty list int int b\n"
      "element vertex 3\n" XYZ "element edge 1\nproperty int v1\nproperty int v2\n"
      "element face 1\n" LIST "element none 5\nend_header\n0.5 0\n0.5 2 1 2\n" XYZ3
      "0 1\n3 0 1 2\n", 0, true, 3, 1, "" },
    { "record over two lines", FACE "0 0\n0\n1 0 0\n0 1 0\n3\n0 1 2\n", 0, true, 3, 1, "" },
    { "no elements of zero count need properties", HEAD "element vertex 0\nelement face 0\n"
      "end_header\n", 0, true, 0, 0, "no triangles" },
    { "zero vertices, as exporters write them", HEAD "element vertex 0\n" XYZ
      "element face 0\n" LIST "end_header\n", 0, true, 0, 0, "t.ply: warning: no triangles" },
    { "polygons", HEAD "element vertex 5\n" XYZ "element face 3\n" LIST "end_header\n" XYZ3
      "1 1 0\n2 2 0\n5 0 1 4 3 2\n4 0 1 3 2\n3 0 1 2\n", 0, true, 5, 6, "" },
    { "short faces", VERTS "element face 4\n" LIST "end_header\n" XYZ3 "2 0 1\n0\n1 0\n3 0 1 2\n",
      0, true, 3, 1, "t.ply:13:2: warning: faces of fewer than 3 corners left out: 3" },
    { "strips", HEAD "element vertex 5\n" XYZ "element tristrips 1\nproperty list int int "
      "vertex_indices\nend_header\n" XYZ3 "1 1 0\n2 2 0\n10 0 1 2 3 4 -1 2 3 -1 0\n", 0, true, 5, 3,
      "" },
    { "more than declared", FACE XYZ3 "3 0 1 2\n3 0 1 2\n", 0, true, 3, 1,
      "t.ply:14:1: warning: bytes after the last element left out: 8" },
    { "empty file", "", 0, false, 0, 0, "t.ply:1:1: not a PLY file" },
    { "other magic", "plyx\n", 0, false, 0, 0, "t.ply:1:1: not a PLY file" },
    { "header only", HEAD "end_header\n", 0, false, 0, 0, "t.ply:3:1: header without an element" },
    { "header cut", HEAD "element vertex 3\n", 0, false, 0, 0, "end_header was expected" },
    { "no format", "ply\nelement vertex 0\nend_header\n", 0, false, 0, 0, "without a format" },
    { "format", "ply\nformat binary 1.0\n", 0, false, 0, 0, "t.ply:2:8: 'binary', ascii, bin" },
    { "version", "ply\nformat ascii 2.0\n", 0, false, 0, 0, "t.ply:2:14: '2.0', version 1.0" },
    { "header word", HEAD "elements vertex 3\n", 0, false, 0, 0, "t.ply:3:1: 'elements', one of" },
    { "more on a line", HEAD "element vertex 3 4\n", 0, false, 0, 0, "t.ply:3:18: '4', the end" },
    { "property first", HEAD "property int x\n", 0, false, 0, 0, "property before any element" },
    { "type", HEAD "element vertex 1\nproperty real x\n", 0, false, 0, 0, "t.ply:4:10: 'real'" },
    { "list of floats", VERTS "element face 1\nproperty list uchar float vertex_indices\n", 0,
      false, 0, 0, "t.ply:8:21: 'float', a list of an integer type" },
    { "count of floats", VERTS "element face 1\nproperty list float int vertex_indices\n", 0,
      false, 0, 0, "t.ply:8:15: 'float', an integer type" },
    { "indices no list", VERTS "element face 1\nproperty int vertex_indices\n", 0, false, 0, 0,
      "t.ply:8:10: 'int', a list" },
    { "faces without indices", VERTS "element face 1\nproperty int a\nend_header\n", 0, false, 0,
      0, "t.ply:7:1: no list 'vertex_indices'" },
    { "no z", HEAD "element vertex 3\nproperty float x\nproperty float y\nend_header\n", 0, false,
      0, 0, "t.ply:3:1: element 'vertex' without a property 'z'" },
    { "two vertex elements", VERTS "element vertex 1\n", 0, false, 0, 0, "t.ply:7:1: a second" },
    { "negative count", HEAD "element vertex -1\n", 0, false, 0, 0, "t.ply:3:16: '-1', the num" },
    { "absurd count", HEAD "element vertex 4000000000\n" XYZ "end_header\n0 0 0\n", 0, false, 0, 0,
      "t.ply:3:1: 4000000000 records of element 'vertex' do not fit into the 6 bytes left" },
    { "count beyond 64 bits", HEAD "element vertex 99999999999999999999\n" XYZ "end_header\n", 0,
      false, 0, 0, "t.ply:3:1: " },
    { "absurd count of an unknown element", HEAD "element vertex 0\nelement e 4000000000\nproperty "
      "int a\nend_header\n", 0, false, 0, 0, "t.ply:4:1: 4000000000 records of element 'e'" },
    { "absurd list", FACE XYZ3 "1000000 0 1 2\n", 0, false, 0, 0,
      "t.ply:13:1: record 1 of element 'face': a list of 1000000 values" },
    { "negative list", FACE XYZ3 "-3 0 1 2\n", 0, false, 0, 0, "a list of -3 values" },
    { "rubbish value", FACE "0 0 0\n1 x 0\n0 1 0\n3 0 1 2\n", 0, false, 0, 0,
      "t.ply:11:3: record 2 of element 'vertex': 'x', a number was expected" },
    { "NaN", FACE "0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n", 0, false, 0, 0, "t.ply:11:5: record 2" },
    { "infinite", FACE "0 0 0\n1 0 0\n0 1e40 0\n3 0 1 2\n", 0, false, 0, 0, "t.ply:12:3: record" },
    { "too many values", FACE "0 0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", 0, false, 0, 0,
      "t.ply:10:7: record 1 of element 'vertex': '0', the end of the line was expected" },
    { "index too large", FACE XYZ3 "3 0 1 3\n", 0, false, 0, 0,
      "t.ply:13:7: record 1 of element 'face': index 3, 3 vertices from 0" },
    { "index negative", FACE XYZ3 "3 0 -1 2\n", 0, false, 0, 0, "t.ply:13:5: record 1 of" },
    { "index rubbish", FACE XYZ3 "3 0 1 2.5\n", 0, false, 0, 0, "'2.5', an integer was expected" },
    { "NUL in a value", SIZED(FACE "0 0 \0" "0\n1 0 0\n0 1 0\n3 0 1 2\n"), false, 0, 0,
      "t.ply:10:5: " },
    { "cut", FACE XYZ3 "3 0", 0, false, 0, 0,
      "t.ply:13:1: record 1 of element 'face': a list of 3 values does not fit into the 2" },
    { "cut in a list", FACE XYZ3 "3 0 1", 0, false, 0, 0,
      "t.ply:13:6: record 1 of element 'face': the file ends here, 1 records were expected" },
    { NULL, NULL, 0, false, 0, 0, NULL }
};

static void ply_texts(void) { check_texts(FILE_PLY, "t.ply", ply_cases); }

static const TextCase mtl_cases[] = {
    { "one", "newmtl a\nKd 1 0.5 0\n", 0, true, 1, 0, "" },
    { "empty", "", 0, true, 0, 0, "" },
    { "CRLF, blanks, comments", "# c\r\n  newmtl a # b\r\n\tKd 1 1 1 # d\r\n\r\nnewmtl b", 0, true,
      2, 0, "" },
    { "before newmtl", "Kd 1 1 1\nd 1\nnewmtl a\n", 0, true, 1, 0,
      "t.mtl:1:1: warning: statements before the first newmtl left out: 2" },
    { "unknown", "newmtl a\nPs 0.5\nrefl a.png\nKa 1 1 1\n", 0, true, 1, 0,
      "t.mtl:2:1: warning: statements that are not supported left out: 2 (first 'Ps')" },
    { "spectral", "newmtl a\nKd spectral a.rfl 1\nKs xyz 1 1 1\n", 0, true, 1, 0,
      "t.mtl:2:4: warning: spectral or XYZ colours left out, RGB was expected: 2" },
    { "unknown option", "newmtl a\nmap_Kd -foo 1 a.png\n", 0, true, 1, 0,
      "t.mtl:2:8: warning: maps with an unknown option left out: 1" },
    { "NUL in a name", SIZED("newmtl a\0\n"), false, 0, 0, "t.mtl:1:8: a name with a byte 0" },
    { "NUL in a map", SIZED("newmtl a\nbump \0\n"), false, 0, 0, "t.mtl:2:6: a name with a b" },
    { "no name", "newmtl\n", 0, false, 0, 0, "t.mtl:1:1: newmtl without a name" },
    { "two numbers", "newmtl a\nKd 1 1\n", 0, false, 0, 0, "t.mtl:2:7: Kd is missing" },
    { "rubbish number", "newmtl a\nNs 1.0.0\n", 0, false, 0, 0, "t.mtl:2:4: Ns is '1.0.0'" },
    { "NaN", "newmtl a\nKe 0 nan 0\n", 0, false, 0, 0, "t.mtl:2:6: Ke is infinite or not" },
    { "illum", "newmtl a\nillum 11\n", 0, false, 0, 0, "t.mtl:2:7: illum is '11'" },
    { "illum missing", "newmtl a\nillum\n", 0, false, 0, 0, "t.mtl:2:6: illum is ''" },
    { "map without a file", "newmtl a\nmap_Kd -s 1 1\n", 0, true, 1, 0, "" },
    { "map without anything", "newmtl a\nmap_Kd\n", 0, false, 0, 0, "map_Kd without a file" },
    { "map with options only", "newmtl a\nbump -bm\n", 0, false, 0, 0, "bump without a file" },
    { NULL, NULL, 0, false, 0, 0, NULL }
};

static void mtl_texts(void) { check_texts(FILE_MTL, "t.mtl", mtl_cases); }

/* A line of a million characters is nothing special. */
static void long_lines(void)
{
    enum { CORNERS = 300000 };
    char *text = malloc(3 * CORNERS + 100), *at = text;
    MeshFile f;
    char line[300];

    REQUIRE(text, "memory");
    messages_start();
    at += sprintf(at, "#");
    memset(at, 'x', 1000000 % (2 * CORNERS));
    at += 1000000 % (2 * CORNERS);
    at += sprintf(at, "\n" V3_ "f 1 2 3\n");
    f = mesh_file_read(FILE_OBJ, "t.obj", (unsigned char *)text, (size_t)(at - text));
    EXPECT(f.ok && f.mesh.ntris == 1, "a long comment");
    mesh_file_clear(FILE_OBJ, &f);
    at = text + sprintf(text, V3_ "f");
    for (int k = 0; k < CORNERS; k++)
        at += sprintf(at, " %d", 1 + k % 3);
    f = mesh_file_read(FILE_OBJ, "t.obj", (unsigned char *)text, (size_t)(at - text));
    EXPECT(f.ok && f.mesh.ntris == CORNERS - 2, "a face of %d corners", CORNERS);
    EXPECT(messages_take(line, sizeof line) == 1 && strstr(line, "cut as fans"), "'%s'", line);
    mesh_file_clear(FILE_OBJ, &f);
    free(text);
}

/* ---- values ---- */

static ObjFile obj_of(const char *text)
{
    ObjFile f;
    REQUIRE(obj_read(&f, "v.obj", (const unsigned char *)text, strlen(text)), "refused");
    return f;
}

static void obj_values(void)
{
    ObjFile f = obj_of("v 1 2 3\nv -.5 2.e1 +1e-2\nv 0 0 1\nvn 0 0 -3\nvn 0 0 0\nvn nan 0 1\n"
                       "vt 0.25 0.75\nvt inf 0\nf 3/1/1 1/2/2 2//3\nf 2//3 3/1/1 1\n");
    const Mesh *m = &f.mesh;

    EXPECT(m->nverts == 4 && m->ntris == 2, "%lu vertices", (unsigned long)m->nverts);
    EXPECT(v3_is(m->p[0], 0, 0, 1) && v3_is(m->p[1], 1, 2, 3) &&
           v3_is(m->p[2], -0.5f, 20.0f, 0.01f) && v3_is(m->p[3], 1, 2, 3), "positions");
    EXPECT(v3_is(m->n[0], 0, 0, -1) && v3_is(m->n[1], 0, 0, 0) && v3_is(m->n[2], 0, 0, 0) &&
           v3_is(m->n[3], 0, 0, 0), "normals");
    EXPECT(m->uv[0].x == 0.25f && m->uv[0].y == 0.75f && m->uv[1].x == 0.0f && m->uv[3].x == 0.0f,
           "texture coordinates");
    EXPECT(m->tri[0].v[0] == 0 && m->tri[0].v[1] == 1 && m->tri[0].v[2] == 2 &&
           m->tri[1].v[0] == 2 && m->tri[1].v[1] == 0 && m->tri[1].v[2] == 3, "indices");
    obj_clear(&f);
    f = obj_of(V3_ "vt 0 0\nvn 0 0 1\nf 3 1 2\n");
    EXPECT(!f.mesh.uv && !f.mesh.n, "attributes that no corner has");
    EXPECT(f.mesh.nverts == 3 && v3_is(f.mesh.p[0], 0, 1, 0), "order of first use");
    obj_clear(&f);
}

static void obj_groups(void)
{
    static const uint32_t expected[] = { 0, 1, 1, 2, 0, 0, 3, 1 };
    ObjFile f = obj_of("mtllib a.mtl  b c.MTL d.mtl\nmtllib a.mtl e f\nmtllib\n" V3_
                       "v 1 1 0\nf 1 2 3\nusemtl red\nusemtl\tdark blue \nf 1 2 4 3\nusemtl\n"
                       "usemtl red # not blue\nf 1 2 3\nusemtl \nf 1 2 3\ng x\nf 1 2 3\n"
                       "usemtl red\nf 1 2\nusemtl green\nf 1 2 3\nusemtl dark blue\nf 1 2 3\n"
                       "usemtl never\n");
    static const char *const names[] = { "", "dark blue", "red", "green" };
    static const char *const libs[] = { "a.mtl", "b c.MTL", "d.mtl", "e", "f" };

    EXPECT(f.ngroups == 4 && f.nmtllibs == 5 && f.mesh.ntris == 8, "%lu groups, %lu libraries",
           (unsigned long)f.ngroups, (unsigned long)f.nmtllibs);
    for (size_t k = 0; k < f.ngroups; k++)
        EXPECT(!strcmp(f.group_names[k], names[k]), "group %lu '%s'", (unsigned long)k,
               f.group_names[k]);
    for (size_t k = 0; k < f.nmtllibs; k++)
        EXPECT(!strcmp(f.mtllibs[k], libs[k]), "library %lu '%s'", (unsigned long)k, f.mtllibs[k]);
    for (uint32_t i = 0; i < f.mesh.ntris; i++)
        EXPECT(f.mesh.group[i] == expected[i], "group of triangle %lu", (unsigned long)i);
    obj_clear(&f);
    f = obj_of("usemtl a\n" V3_ "f 1 2 3\nusemtl a\nf 1 2 3\n");
    EXPECT(f.ngroups == 1 && !f.mesh.group && !strcmp(f.group_names[0], "a"), "one group");
    obj_clear(&f);
}

/* Every triple once, numbered by first use: against a table of all triples. */
static void obj_sharing(void)
{
    enum { SIDE = 12, FACES = 4000 };
    static uint32_t number[SIDE + 1][SIDE + 1][SIDE + 1];
    Rng rng = rng_seed(11);
    char *text = malloc(FACES * 40 + 3 * SIDE * 40), *at = text;
    uint32_t want[FACES][3], count = 0;
    ObjFile f;

    REQUIRE(text, "memory");
    for (int k = 1; k <= SIDE; k++)
        at += sprintf(at, "v %d 0 0\nvt %d 0\nvn 0 0 %d\n", k, k, k);
    for (int i = 0; i < FACES; i++) {
        at += sprintf(at, "f");
        for (int c = 0; c < 3; c++) {
            uint32_t v = 1 + rng_below(&rng, SIDE), t = rng_below(&rng, SIDE + 1);
            uint32_t n = rng_below(&rng, SIDE + 1);
            if (!number[v][t][n])
                number[v][t][n] = ++count;
            want[i][c] = number[v][t][n] - 1;
            at += sprintf(at, " %u/", (unsigned)v);
            if (t)
                at += sprintf(at, "%u", (unsigned)t);
            if (n)
                at += sprintf(at, "/%u", (unsigned)n);
        }
        at += sprintf(at, "\n");
    }
    f = obj_of(text);
    EXPECT(f.mesh.nverts == count, "%lu vertices, %lu expected", (unsigned long)f.mesh.nverts,
           (unsigned long)count);
    EXPECT(f.mesh.ntris == FACES && !memcmp(f.mesh.tri, want, sizeof want), "indices");
    obj_clear(&f);
    free(text);
}

static void ply_values(void)
{
    static const char text[] =
        HEAD "element vertex 4\nproperty float texture_v\nproperty float nz\nproperty double x\n"
        "property float y\nproperty float z\nproperty float nx\nproperty float ny\n"
        "property float texture_u\nproperty float s\nelement tristrips 1\n"
        "property list int int vertex_index\nend_header\n"
        "0.5 2 1 2 3 0 0 0.25 9\n-1 nan -1 .5 0.1 0 1 2 9\n0 0 7 8 9 0 0 nan 9\n"
        "1 3e38 0 0 0 3e38 0 1 9\n9 0 1 2 3 -1 3 2 1 0\n";
    static const uint32_t strip[4][3] = { { 0, 1, 2 }, { 2, 1, 3 }, { 3, 2, 1 }, { 1, 2, 0 } };
    Mesh m;

    REQUIRE(ply_read(&m, "v.ply", (const unsigned char *)text, sizeof text - 1), "refused");
    EXPECT(v3_is(m.p[0], 1, 2, 3) && v3_is(m.p[1], -1, 0.5f, 0.1f) && v3_is(m.p[2], 7, 8, 9),
           "positions");
    EXPECT(v3_is(m.n[0], 0, 0, 1) && v3_is(m.n[1], 0, 0, 0) && v3_is(m.n[2], 0, 0, 0) &&
           fabsf(m.n[3].x - 0.70710678f) < 1e-6f && m.n[3].x == m.n[3].z, "normals");
    EXPECT(m.uv[0].x == 0.25f && m.uv[0].y == 0.5f && m.uv[1].x == 2.0f && m.uv[1].y == -1.0f &&
           m.uv[2].x == 0.0f && m.uv[2].y == 0.0f, "texture coordinates");
    EXPECT(m.ntris == 4 && !memcmp(m.tri, strip, sizeof strip), "strips");
    mesh_clear(&m);
}

static const MtlMaterial *material(const MtlFile *f, const char *name)
{
    for (size_t k = 0; k < f->n; k++)
        if (!strcmp(f->m[k].name, name))
            return &f->m[k];
    REQUIRE(false, "no material '%s'", name);
    return NULL;
}

static bool rgb_is(Rgb c, float r, float g, float b) { return c.r == r && c.g == g && c.b == b; }

static void mtl_values(void)
{
    static const char text[] =
        "newmtl all\n Kd .1 .2 .3\nKS 0.5\nKe 4 5 6\nTf 1 0 1\nNs 32\nNi 1.5\nd 0.25\nTr 0.5\n"
        "illum 7\nmap_Kd -clamp on -s 1 2 3 -o 0.5 -mm 0 1 some dir/a b.png # c\n"
        "map_d -imfchan l d.png\nbump -bm 0.5 b.png\n"
        "newmtl two words\nTr 0.75\nmap_Bump -t 1 2 -texres 512 -blendu off 7\n"
        "newmtl bare\nd -halo 0.5\n"
        "newmtl first\nillum 0\nnewmtl last\nillum 10\n";
    MtlFile f;
    const MtlMaterial *m;

    REQUIRE(mtl_read(&f, "v.mtl", (const unsigned char *)text, sizeof text - 1), "refused");
    EXPECT(f.n == 5, "%lu materials", (unsigned long)f.n);
    m = material(&f, "all");
    EXPECT(rgb_is(m->kd, 0.1f, 0.2f, 0.3f) && rgb_is(m->ks, 0.5f, 0.5f, 0.5f) &&
           rgb_is(m->ke, 4, 5, 6) && rgb_is(m->tf, 1, 0, 1) && m->has_kd && m->has_ks && m->has_ke,
           "colours");
    EXPECT(m->ns == 32.0f && m->ni == 1.5f && m->d == 0.25f && m->illum == 7, "numbers");
    EXPECT(!strcmp(mtl_map(m, MTL_KD), "some dir/a b.png") && !strcmp(mtl_map(m, MTL_D), "d.png") &&
           !strcmp(mtl_map(m, MTL_BUMP), "b.png"), "maps");
    EXPECT(m->at.line == 1 && m->at.column == 1 && !strcmp(m->at.file, "v.mtl"), "place");
    m = material(&f, "two words");
    EXPECT(m->d == 0.25f && !strcmp(mtl_map(m, MTL_BUMP), "7") && m->at.line == 14, "words");
    m = material(&f, "bare");
    EXPECT(m->d == 0.5f && rgb_is(m->tf, 1, 1, 1) && rgb_is(m->kd, 0, 0, 0) && !m->has_kd &&
           !m->has_ks && !m->has_ke && m->ni == 1.0f && m->ns == 0.0f && m->illum == -1 &&
           !mtl_map(m, MTL_KD)[0] && !mtl_map(m, MTL_D)[0] && !mtl_map(m, MTL_BUMP)[0], "defaults");
    EXPECT(material(&f, "first")->illum == 0 && material(&f, "last")->illum == 10, "illum");
    mtl_clear(&f);
}

static void degenerate(void)
{
    V3 p[] = { { 0, 0, 0 }, { 1, 1, 1 }, { 2, 2, 2 }, { 0, 1e-30f, 0 }, { 1e-30f, 0, 0 },
               { 1, 1, 1 }, { 3e38f, 0, 0 }, { 0, 3e38f, 0 } };
    Tri tri[] = { { { 0, 1, 2 } }, { { 0, 1, 4 } }, { { 1, 1, 2 } }, { { 1, 5, 4 } },
                  { { 0, 3, 4 } }, { { 2, 6, 7 } } };
    uint32_t group[] = { 0, 1, 2, 3, 4, 5 };
    Mesh m = { .nverts = 8, .ntris = 6, .p = p, .tri = tri, .group = group };

    EXPECT(mesh_drop_degenerate(&m) == 3 && m.ntris == 3, "%lu left", (unsigned long)m.ntris);
    EXPECT(tri[0].v[2] == 4 && tri[1].v[1] == 3 && tri[2].v[1] == 6, "which");
    EXPECT(group[0] == 1 && group[1] == 4 && group[2] == 5, "groups");
    EXPECT(mesh_drop_degenerate(&m) == 0, "again");
}

const TestCase test_mesh[] = {
    { "obj-texts", obj_texts, false },
    { "ply-texts", ply_texts, false },
    { "mtl-texts", mtl_texts, false },
    { "long-lines", long_lines, false },
    { "obj-values", obj_values, false },
    { "obj-groups", obj_groups, false },
    { "obj-sharing", obj_sharing, false },
    { "ply-values", ply_values, false },
    { "mtl-values", mtl_values, false },
    { "degenerate", degenerate, false },
    { NULL, NULL, false }
};

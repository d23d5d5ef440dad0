/* scene_help.c -- see scene_help.h. */
#include "test/scene_help.h"

#include <stdio.h>
#include <string.h>

const char *scene_write(const char *name, const char *text)
{
    static char path[4][500];
    static int turn;
    char *p = path[turn++ & 3];

    snprintf(p, sizeof path[0], "%.200s/%.200s", test_folder(), name);
    REQUIRE(file_write(p, text, strlen(text)), "cannot write %s", p);
    return p;
}

bool scene_parse(SceneFile *f, const char *text)
{
    static char path[500];
    ReadLimits limits = READ_LIMITS_DEFAULT;

    snprintf(path, sizeof path, "%.200s/test.pbrt", test_folder());
    return scenefile_parse(f, path, text, strlen(text), &limits);
}

SceneFile scene_of(const char *text, unsigned warnings)
{
    SceneFile f;
    err_reset();
    REQUIRE(scene_parse(&f, text), "refused: %.200s", text);
    EXPECT(warnings_count() == warnings, "%u warnings, not %u: %.200s", warnings_count(), warnings,
           text);
    return f;
}

const Shape *scene_shape(const SceneFile *f, size_t k)
{
    REQUIRE(k < f->scene->geometries[0].nshapes, "there is no shape %lu", (unsigned long)k);
    return &f->scene->geometries[0].shapes[k];
}

V3 scene_corner(const SceneFile *f, size_t vertex)
{
    REQUIRE(vertex < f->scene->geometries[0].nverts, "there is no point %lu",
            (unsigned long)vertex);
    return f->scene->geometries[0].p[vertex];
}

bool v_equal(V3 a, V3 b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

bool v_near(V3 a, V3 b, float tolerance) { return v_max3(v_abs(v_sub(a, b))) <= tolerance; }

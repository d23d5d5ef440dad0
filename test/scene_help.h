/* scene_help.h -- what the suites of scene files share. */
#ifndef TEST_SCENE_HELP_H
#define TEST_SCENE_HELP_H

#include "scenefile/scenefile.h"
#include "test/test.h"

/* Reads a text of the scene language called "test.pbrt" in the folder of the case. */
bool scene_parse(SceneFile *f, const char *text);
/* The same; ends the case if it is refused or gives other than `warnings` warnings. */
SceneFile scene_of(const char *text, unsigned warnings);
/* Writes a file into the folder of the case and gives its path (a static buffer for each). */
const char *scene_write(const char *name, const char *text);

/* The world's mesh number k, its points and triangles from 0. */
const Shape *scene_shape(const SceneFile *f, size_t k);
V3 scene_corner(const SceneFile *f, size_t vertex);
bool v_equal(V3 a, V3 b);
bool v_near(V3 a, V3 b, float tolerance);

#endif

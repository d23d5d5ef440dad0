/* scenefile.h -- reading a scene: the scene language (pbrt, versions 3 and 4), OBJ with MTL, and
 * bare PLY meshes. What is read goes into a Scene; what concerns the render (integrator, sampler,
 * film, ...) is kept as it was written, for the rooms above to resolve. */
#ifndef SCENEFILE_SCENEFILE_H
#define SCENEFILE_SCENEFILE_H

#include "base/file.h"
#include "scene/scene.h"

typedef struct {
    uint64_t max_file;          /* bytes of one file */
    uint64_t max_pixels;        /* of one image */
    int      max_include;       /* depth of Include and Import */
} ReadLimits;
#define READ_LIMITS_DEFAULT { FILE_LIMIT_DEFAULT, IMAGE_PIXELS_DEFAULT, 64 }

/* `Integrator "path" "integer maxdepth" [5]` as written. name NULL: the directive is absent. */
typedef struct { const char *name; Params params; Place at; } Setting;

typedef struct {
    Scene *scene;               /* owned until taken */
    Arena  arena;               /* owned; holds what the settings borrow */
    Setting integrator, sampler, filter, accelerator, film;
    bool   bare;                /* a mesh without camera or lights: wants scene_frame */
} SceneFile;

/* Reads by extension: .pbrt, .obj, .ply. False: reported, *f empty. A name that is not known gets
 * a warning with its place that says what is used instead. */
bool scenefile_read(SceneFile *f, const char *path, const ReadLimits *limits);
bool scenefile_is_scene(const char *path);      /* whether the extension is one of these */
/* The same from a text of the scene language; path is its name, for messages and for the files that
 * it names. */
bool scenefile_parse(SceneFile *f, const char *path, const char *text, size_t n,
                     const ReadLimits *limits);
/* A scene of one shape of the scene language, as a command line has it: "name:key=value,...". Only
 * those that are made by rule are of use. False: reported, as a usage error or as above. */
bool scenefile_shape(SceneFile *f, const char *text, const ReadLimits *limits);
/* Whether a text begins like one. */
bool scenefile_is_shape(const char *text);
void scenefile_clear(SceneFile *f);

/* The shapes of the scene language, for `list`: each begins with a KindInfo. Ends with NULL. */
typedef struct ShapeReader ShapeReader;
extern const ShapeReader *const shape_readers[];

/* The media of the scene language, likewise. */
extern const KindInfo *const medium_kinds[];

#endif

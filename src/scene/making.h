/* making.h -- what the maker of a light, camera or picture is told besides its options. */
#ifndef SCENE_MAKING_H
#define SCENE_MAKING_H

#include "base/kind.h"
#include "base/transform.h"

typedef struct Scene Scene;

typedef struct {
    Scene *scene;
    Transform to_world;         /* current transform, at time 0 */
    Transform to_world_end;     /* cameras: at time 1, if `moves` */
    bool moves;
    Place at;                   /* of the directive; at.file is what paths are relative to */
    uint64_t max_file, max_pixels;
    uint32_t geometry, shape;   /* area lights: the shape that shines */
} Making;

#endif

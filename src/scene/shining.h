/* shining.h -- the shapes that shine, by themselves: which lamp does a ray meet first, and which
 * ones after that, if there were nothing else in the world? [Cline07 4.4.2, 4.4.4] asks both. */
#ifndef SCENE_SHINING_H
#define SCENE_SHINING_H

#include "scene/scene.h"

typedef struct {
    const Scene *scene;         /* borrowed */
    Geometry geometry;          /* owned: copies of the shapes that shine */
    Accel *accel;               /* owned; NULL: that of the scene serves, whose other shapes are
                                 * passed by (where a tessellation shines) */
    bool   none;                /* no shape shines */
} Shining;

/* Of a scene that is built. False: reported; nothing is to be cleared then. */
bool shining_init(Shining *l, const Scene *s);
void shining_clear(Shining *l);

/* The first shape that shines along r; moves r on to start behind it. *s->shape is a copy, whose
 * light is the right one. False: none. */
bool shining_next(const Shining *l, Ray *r, Surface *s);

#endif

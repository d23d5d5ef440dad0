/* subset.h -- some of the shapes of a world, by themselves: which lamp does a ray meet first, and
 * which ones after that, if there were nothing else [Cline07 4.4.2, 4.4.4]? Is there any glass that
 * way? */
#ifndef SCENE_SUBSET_H
#define SCENE_SUBSET_H

#include "scene/scene.h"

/* Whether a shape of the world, or of what it instances, is one of them. */
typedef bool SubsetHas(const Scene *s, const Shape *shape);
SubsetHas shape_shines;
SubsetHas shape_glints;         /* its material may scatter light by delta events */

typedef struct {
    const Scene *scene;         /* borrowed */
    SubsetHas *has;
    Geometry geometry;          /* owned: copies of these shapes */
    Accel *accel;               /* owned; NULL: that of the scene serves, whose other shapes are
                                 * passed by (where one is an instance or a tessellation) */
    bool   none;                /* there are none of them */
} Subset;

/* Of a scene that is built. False: reported; nothing is to be cleared then. */
bool subset_init(Subset *l, const Scene *s, SubsetHas *has);
void subset_clear(Subset *l);

/* The first of them along r; moves r on to start behind it. *s->shape may be a copy, whose light
 * and material are right. False: none. */
bool subset_next(const Subset *l, Ray *r, Surface *s);
/* Whether r may meet one of them. */
bool subset_near(const Subset *l, const Ray *r);

#endif

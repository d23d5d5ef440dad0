/* camera.h -- what cameras share: their place, their shutter, and the screen of those that have a
 * flat one. */
#ifndef SCENE_CAMERA_H
#define SCENE_CAMERA_H

#include "scene/scene.h"

/* Sets place, motion and shutter of a camera. False: reported. */
bool camera_init(Camera *c, const Making *m, const Opts *o);

/* The maps of its space at a time. */
INLINE void camera_at(const Camera *c, float time, Affine *to_world, Affine *to_camera)
{
    if (UNLIKELY(c->motion != NULL))
        motion_at(c->motion, time, to_world, to_camera);
    else {
        *to_world = c->to_world;
        *to_camera = c->to_camera;
    }
}

/* A camera's space may be stretched. What densities per solid angle are multiplied by on the way
 * to the world, for the direction d that a unit one of the world becomes by to_camera: a linear map
 * C of determinant det takes solid angle about w to |det| / |C w|^3 times as much. */
double camera_solid(const Affine *to_camera, V3 d);

/* By how much an area of the plane z = 0 is larger in the world: by |det M| |M^-T z|, with M the
 * inverse of C. */
double camera_area(const Affine *to_camera);

/* The unit normal of that plane, on the side that is seen. */
V3 camera_normal(const Affine *to_camera);

/* ---- a flat screen, of which the shorter side spans [-1, 1] unless a window is given ---- */

typedef struct {
    float aspect;               /* 0: that of the film */
    bool  window_given;
    float window[4];            /* x0 x1 y0 y1 */
    float sx, ox, sy, oy;       /* pixels to screen */
    float area;                 /* of the whole picture on the screen */
} Screen;

bool screen_init(Screen *s, const Opts *o);                     /* false: reported */
/* scale: what 1 on the screen is to be in the camera's space. */
void screen_set(Screen *s, uint32_t w, uint32_t h, float scale);

INLINE V2 screen_at(const Screen *s, V2 pixel)
{
    return (V2){ pixel.x * s->sx + s->ox, pixel.y * s->sy + s->oy };
}
INLINE V2 screen_pixel(const Screen *s, float x, float y)
{
    return (V2){ (x - s->ox) / s->sx, (y - s->oy) / s->sy };
}

/* ---- options of all, and of those with a lens ---- */

#define CAMERA_OPTIONS \
    { .key = "frameaspectratio", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 1e6, \
      .help = "width to height; 0: that of the film" }, \
    { .key = "screenwindow", .type = OPT_NUMBERS, .help = "x0 x1 y0 y1 on the screen" }, \
    { .key = "shutteropen", .type = OPT_FLOAT, .num = 0, \
      .help = "when; TransformTimes says when motions begin and end, else 0 and 1" }, \
    { .key = "shutterclose", .type = OPT_FLOAT, .num = 1, .help = "when" }
#define LENS_OPTIONS \
    { .key = "lensradius", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 1e30, \
      .help = "of the aperture, scene units; 0: pinhole" }, \
    { .key = "focaldistance", .type = OPT_FLOAT, .num = 1e6, .lo = 1e-30, .hi = 1e30, \
      .help = "to the plane in focus, scene units" }

#endif

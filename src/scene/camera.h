/* camera.h -- the sensor of a picture: one file a kind, of which camera.c has the list.
 *
 * Rays run from its lens, or from its eye where that is a point, to what it sees, and light comes
 * back along them. Its importance We is defined by the measurement that is the mean of all pixels
 * [Veach97 8.3], [PBRT4 16.1], [Cline07 (7.2)]:
 *
 *     mean = integral of We L |cos| over places on the lens and directions,
 *
 * with the cosine at the lens (errata 7.2), so that We |cos| integrates to 1. Places on the picture
 * and on the lens are chosen uniformly and a pixel is the mean over its filter, so We |cos| is the
 * density pdf_a pdf_w of rays. A path that is traced from a light and reaches the lens adds, where
 * filters of a pixel hold its place, (pixels of the picture) times We ... / density to that pixel.
 *
 * Deltas. From a point (`point`) pdf_a is 1 and means a delta in place; where each place looks in
 * one direction only (`parallel`) pdf_w is 1 and means a delta in direction. */
#ifndef SCENE_CAMERA_H
#define SCENE_CAMERA_H

#include "geometry/geometry.h"
#include "scene/making.h"

typedef struct {
    float we;
    float pdf_a, pdf_w;         /* densities of the place on the lens, and of the direction at it */
    V2    pixel;                /* where on the picture, in pixels from the top left */
} CameraView;

/* The way from a point of the scene to the camera. */
typedef struct {
    V3    wi;                   /* unit, from the point towards the camera */
    float dist;
    V3    p;                    /* the place on the lens */
    float we;                   /* of the ray from there along -wi */
    float pdf_w;                /* of wi: f |cos| at the point times we / pdf_w is what a path adds.
                                 * 1 where there was no choice but to take it (`parallel`) */
    V2    pixel;
} CameraSample;

typedef struct Camera Camera;
typedef struct {
    KindInfo info;
    size_t bytes;               /* of one, which may be copied: it owns nothing */
    Camera *(*make)(const Making *m, const Opts *o);    /* to_world: camera to world */
    void (*film)(Camera *c, uint32_t w, uint32_t h);    /* the picture's size, before any ray */
    /* The ray through (x, y) in pixels from the top left, lens position u in [0,1)^2. Unit d. */
    Ray (*ray)(const Camera *c, V2 pixel, V2 lens, float time);
    /* What there is to say of a ray from a place on the lens, unit d; also of those that pass by
     * the edges of the picture, where filters reach. False: nothing, it looks elsewhere. */
    bool (*view)(const Camera *c, const Ray *r, CameraView *v);
    /* Chooses a place on the lens for light from a point. False: the camera cannot see it. */
    bool (*sample)(const Camera *c, V3 from, V2 lens, float time, CameraSample *s);
} CameraKind;

struct Camera {                 /* first member of every concrete camera */
    const CameraKind *kind;
    Affine  to_world, to_camera;        /* of one that moves: at time 0 */
    const Motion *motion;       /* in the scene's arena; NULL: it stands still */
    double  shutter[2];         /* opens and closes; in the units of the scene's `times` */
    bool    has_lens;           /* `lens` matters: a pinhole needs no number drawn for it */
    bool    point, parallel;    /* deltas, see above */
};
extern const CameraKind *const cameras[];       /* ends with NULL */

/* ---- what cameras share ---- */

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

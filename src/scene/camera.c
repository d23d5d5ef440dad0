/* camera.c -- the list of cameras, and what they share. */
#include "scene/camera.h"

#include "scene/scene.h"

#define CAMERAS(X)                                                             \
    X(perspective)              /* pinhole, thin lens */                       \
    X(orthographic)             /* the same from infinitely far */             \
    X(spherical)                /* all around, area onto area */               \
    X(environment)              /* all around, by latitude and longitude */
#define DECLARE(name) extern const CameraKind camera_##name;
#define ENTRY(name) &camera_##name,
CAMERAS(DECLARE)
const CameraKind *const cameras[] = { CAMERAS(ENTRY) NULL };

static bool set_motion(Camera *c, const Making *m)
{
    Motion *motion;

    if (!m->moves)
        return true;
    motion = arena_take(&m->scene->arena, 1, sizeof *motion);
    if (!motion)
        return false;
    if (motion_init(motion, &m->to_world, &m->to_world_end)) {
        c->motion = motion;
        return true;
    }
    return warn_at(m->at, "the camera is turned inside out as it moves; it stands as at its start");
}

bool camera_init(Camera *c, const Making *m, const Opts *o)
{
    c->to_world = xf_affine(&m->to_world);
    c->to_camera = xf_affine_inverse(&m->to_world);
    c->shutter[0] = opt_float(o, "shutteropen");
    c->shutter[1] = opt_float(o, "shutterclose");
    if (c->shutter[1] < c->shutter[0])
        return err_at(m->at, "the shutter closes before it opens");
    return set_motion(c, m);
}

/* ---- stretched spaces ---- */

static double determinant(const Affine *a)
{
    const float (*m)[4] = a->m;
    return m[0][0] * ((double)m[1][1] * m[2][2] - (double)m[1][2] * m[2][1]) -
           m[0][1] * ((double)m[1][0] * m[2][2] - (double)m[1][2] * m[2][0]) +
           m[0][2] * ((double)m[1][0] * m[2][1] - (double)m[1][1] * m[2][0]);
}

double camera_solid(const Affine *to_camera, V3 d)
{
    double l = sqrt((double)d.x * d.x + (double)d.y * d.y + (double)d.z * d.z);
    return fabs(determinant(to_camera)) / (l * l * l);
}

static V3 third_row(const Affine *a) { return v3(a->m[2][0], a->m[2][1], a->m[2][2]); }

double camera_area(const Affine *to_camera)
{
    return v_len(third_row(to_camera)) / fabs(determinant(to_camera));
}

V3 camera_normal(const Affine *to_camera) { return v_unit(third_row(to_camera)); }

/* ---- the screen ---- */

bool screen_init(Screen *s, const Opts *o)
{
    const Param *p = opt_param(o, "screenwindow");

    s->aspect = opt_float(o, "frameaspectratio");
    if (!p)
        return true;
    if (p->n != 4 || !(p->numbers[0] < p->numbers[1]) || !(p->numbers[2] < p->numbers[3]))
        return err_at(p->at, "\"screenwindow\" is not right, expected x0 < x1 and y0 < y1");
    for (int k = 0; k < 4; k++)
        s->window[k] = (float)p->numbers[k];
    s->window_given = true;
    return true;
}

void screen_set(Screen *s, uint32_t w, uint32_t h, float scale)
{
    float aspect = s->aspect > 0.0f ? s->aspect : (float)w / (float)h;
    float x0 = -1, x1 = 1, y0 = -1, y1 = 1;

    if (s->window_given) {
        x0 = s->window[0];
        x1 = s->window[1];
        y0 = s->window[2];
        y1 = s->window[3];
    } else if (aspect > 1.0f) {
        x1 = aspect;
        x0 = -x1;
    } else {
        y1 = 1.0f / aspect;
        y0 = -y1;
    }
    s->sx = (x1 - x0) * scale / (float)w;
    s->ox = x0 * scale;
    s->sy = (y0 - y1) * scale / (float)h;               /* rows run downwards */
    s->oy = y1 * scale;
    s->area = (x1 - x0) * scale * ((y1 - y0) * scale);
}

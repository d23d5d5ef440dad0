/* perspective.c -- the camera `perspective`: a pinhole or a thin lens.
 *
 * Source      [Cline07 7.3.3], [PBRT4 5.2]; the lens measure is r dr dtheta, errata 001.2.
 * Space       The camera looks along +z, x to the right, y up. The shorter side of the screen
 *             spans [-1, 1]; fov is the angle it fills. */
#include "sampling/warp.h"
#include "scene/scene.h"

typedef struct {
    Camera base;
    Affine to_world;
    V3     eye;
    float  tan_half;            /* of fov: screen units at distance 1 */
    float  lens, focus;         /* radius and distance, scene units; lens 0: pinhole */
    float  aspect;              /* 0: that of the film */
    bool   window_given;
    float  window[4];           /* x0 x1 y0 y1 on the screen */
    float  sx, ox, sy, oy;      /* pixels to screen */
} Perspective;

/* "float screenwindow" [x0 x1 y0 y1] */
static bool read_window(Perspective *c, const Opts *o)
{
    const Param *p = opt_param(o, "screenwindow");

    if (!p)
        return true;
    if (p->n != 4 || !(p->numbers[0] < p->numbers[1]) || !(p->numbers[2] < p->numbers[3]))
        return err_at(p->at, "\"screenwindow\" is not right, expected x0 < x1 and y0 < y1");
    for (int k = 0; k < 4; k++)
        c->window[k] = (float)p->numbers[k];
    c->window_given = true;
    return true;
}

static Camera *make(const Making *m, const Opts *o)
{
    Perspective *c = arena_take(&m->scene->arena, 1, sizeof *c);
    double half = opt_float(o, "fov") * (PI / 360);

    if (!c || !read_window(c, o))
        return NULL;
    c->to_world = xf_affine(&m->to_world);
    c->eye = xf_point(&m->to_world, v3(0, 0, 0));
    c->tan_half = (float)(md_sin(half) / md_cos(half));
    c->lens = opt_float(o, "lensradius");
    c->focus = opt_float(o, "focaldistance");
    c->aspect = opt_float(o, "frameaspectratio");
    return &c->base;
}

static void film(Camera *base, uint32_t w, uint32_t h)
{
    Perspective *c = (Perspective *)base;
    float aspect = c->aspect > 0.0f ? c->aspect : (float)w / (float)h;
    float x0 = -1, x1 = 1, y0 = -1, y1 = 1;

    if (c->window_given) {
        x0 = c->window[0];
        x1 = c->window[1];
        y0 = c->window[2];
        y1 = c->window[3];
    } else if (aspect > 1.0f) {
        x1 = aspect;
        x0 = -x1;
    } else {
        y1 = 1.0f / aspect;
        y0 = -y1;
    }
    c->sx = (x1 - x0) * c->tan_half / (float)w;
    c->ox = x0 * c->tan_half;
    c->sy = (y0 - y1) * c->tan_half / (float)h;         /* rows run downwards */
    c->oy = y1 * c->tan_half;
}

static bool has_lens(const Camera *c) { return ((const Perspective *)c)->lens > 0.0f; }

static Ray ray(const Camera *base, V2 pixel, V2 u)
{
    const Perspective *c = (const Perspective *)base;
    V3 d = v3(pixel.x * c->sx + c->ox, pixel.y * c->sy + c->oy, 1.0f);
    V3 o = c->eye;

    if (c->lens > 0.0f) {                               /* through the point in focus */
        V2 q = warp_disk_concentric(u);
        V3 on_lens = v3(q.x * c->lens, q.y * c->lens, 0.0f);
        d = v_sub(v_scale(d, c->focus), on_lens);
        o = affine_point(&c->to_world, on_lens);
    }
    return (Ray){ .o = o, .d = v_unit(affine_vector(&c->to_world, d)), .tmax = INFINITY };
}

static const OptDef options[] = {
    { .key = "fov", .type = OPT_FLOAT, .num = 90, .lo = 1e-4, .hi = 179.99,
      .help = "angle across the shorter side, degrees" },
    { .key = "lensradius", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 1e30,
      .help = "of the aperture, scene units; 0: pinhole" },
    { .key = "focaldistance", .type = OPT_FLOAT, .num = 1e6, .lo = 1e-30, .hi = 1e30,
      .help = "to the plane in focus, scene units" },
    { .key = "frameaspectratio", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 1e6,
      .help = "width to height; 0: that of the film" },
    { .key = "screenwindow", .type = OPT_NUMBERS, .help = "x0 x1 y0 y1 on the screen" },
    { .key = "shutteropen", .type = OPT_FLOAT, .num = 0, .help = "read, without effect" },
    { .key = "shutterclose", .type = OPT_FLOAT, .num = 1, .help = "read, without effect" },
    { .key = NULL }
};

const CameraKind camera_perspective = {
    .info = { "perspective", "Cline07 7.3.3", "pinhole or thin lens", options },
    .make = make, .film = film, .has_lens = has_lens, .ray = ray
};

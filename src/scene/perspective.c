/* perspective.c -- the camera `perspective`: a pinhole or a thin lens.
 *
 * Source      [Cline07 7.3.3, 7.6.2], [PBRT4 5.2, 16.1]; the lens measure is r dr dtheta, errata
 *             001.2, and We has the cosine at the lens besides, errata 7.2.
 * Space       The camera looks along +z, x to the right, y up. The shorter side of the screen
 *             spans [-1, 1]; fov is the angle it fills.
 * Densities   With A the area of the picture on the plane at distance 1 and l the place on the
 *             lens, the place shown there is l / focus + (d.x, d.y) / d.z: for any l a density of
 *             1 / A on that plane is 1 / (A cos^3) per solid angle, [Cline07 (7.3), (7.4)]. */
#include "sampling/warp.h"
#include "scene/scene.h"

typedef struct {
    Camera base;
    Screen screen;              /* at distance 1 */
    float  tan_half;            /* of fov: screen units at distance 1 */
    float  lens, focus;         /* radius and distance, scene units; lens 0: pinhole */
} Perspective;

static Camera *make(const Making *m, const Opts *o)
{
    Perspective *c = arena_take(&m->scene->arena, 1, sizeof *c);
    double half = opt_float(o, opt_given(o, "halffov") ? "halffov" : "fov") * (PI / 360);

    if (!c || !camera_init(&c->base, m, o) || !screen_init(&c->screen, o))
        return NULL;
    if (opt_given(o, "halffov"))
        half *= 2;
    c->tan_half = (float)(md_sin(half) / md_cos(half));
    c->lens = opt_float(o, "lensradius");
    c->focus = opt_float(o, "focaldistance");
    c->base.has_lens = c->lens > 0.0f;
    c->base.point = !c->base.has_lens;
    return &c->base;
}

static void film(Camera *base, uint32_t w, uint32_t h)
{
    Perspective *c = (Perspective *)base;
    screen_set(&c->screen, w, h, c->tan_half);
}

static V3 on_lens(const Perspective *c, V2 u)
{
    V2 q = { 0, 0 };
    if (c->lens > 0.0f)
        q = warp_disk_concentric(u);
    return v3(q.x * c->lens, q.y * c->lens, 0.0f);
}

static Ray ray(const Camera *base, V2 pixel, V2 u, float time)
{
    const Perspective *c = (const Perspective *)base;
    V2 at = screen_at(&c->screen, pixel);
    V3 d = v3(at.x, at.y, 1.0f), o = { 0, 0, 0 };
    Affine to_world, to_camera;

    camera_at(base, time, &to_world, &to_camera);
    if (c->lens > 0.0f) {                               /* through the point in focus */
        o = on_lens(c, u);
        d = v_sub(v_scale(d, c->focus), o);
    }
    return (Ray){ .o = affine_point(&to_world, o), .d = v_unit(affine_vector(&to_world, d)),
                  .tmax = INFINITY, .time = time };
}

/* What `view` gives, for the place l on the lens, in camera space, and the direction w. */
static bool look(const Perspective *c, const Affine *to_camera, V3 l, V3 w, CameraView *v)
{
    V3 d = affine_vector(to_camera, w);
    float cosine = v_dot(w, camera_normal(to_camera));
    double z;

    if (!(d.z > 0.0f) || !(cosine > 0.0f))
        return false;
    z = d.z / sqrt((double)d.x * d.x + (double)d.y * d.y + (double)d.z * d.z);
    v->pdf_w = (float)(camera_solid(to_camera, d) / (c->screen.area * (z * z * z)));
    v->pdf_a = c->lens > 0.0f ? (float)(1 / (PI * c->lens * c->lens * camera_area(to_camera))) : 1;
    v->we = v->pdf_a * v->pdf_w / cosine;
    v->pixel = screen_pixel(&c->screen, d.x / d.z + l.x / c->focus, d.y / d.z + l.y / c->focus);
    return true;
}

static bool view(const Camera *base, const Ray *r, CameraView *v)
{
    const Perspective *c = (const Perspective *)base;
    Affine to_world, to_camera;
    V3 l = { 0, 0, 0 };

    camera_at(base, r->time, &to_world, &to_camera);
    if (c->lens > 0.0f)
        l = affine_point(&to_camera, r->o);
    return look(c, &to_camera, l, r->d, v);
}

static bool sample(const Camera *base, V3 from, V2 u, float time, CameraSample *s)
{
    const Perspective *c = (const Perspective *)base;
    Affine to_world, to_camera;
    V3 l = on_lens(c, u), to;
    CameraView v;

    camera_at(base, time, &to_world, &to_camera);
    s->p = affine_point(&to_world, l);
    to = v_sub(s->p, from);
    s->dist = v_len(to);
    s->wi = v_unit(to);
    if (!look(c, &to_camera, l, v_neg(s->wi), &v))
        return false;
    s->we = v.we;
    s->pixel = v.pixel;
    s->pdf_w = v.pdf_a * s->dist * s->dist / -v_dot(s->wi, camera_normal(&to_camera));
    return true;
}

static const OptDef options[] = {
    { .key = "fov", .type = OPT_FLOAT, .num = 90, .lo = 1e-4, .hi = 179.99,
      .help = "angle across the shorter side, degrees" },
    { .key = "halffov", .type = OPT_FLOAT, .num = 45, .lo = 1e-4, .hi = 89.99,
      .help = "half of it, if given" },
    LENS_OPTIONS, CAMERA_OPTIONS,
    { .key = NULL }
};

const CameraKind camera_perspective = {
    .info = { "perspective", "Cline07 7.3.3", "pinhole or thin lens", options },
    .bytes = sizeof(Perspective),
    .make = make, .film = film, .ray = ray, .view = view, .sample = sample
};

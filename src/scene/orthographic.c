/* orthographic.c -- the camera `orthographic`: parallel rays, or with a lens, cones of one size.
 *
 * Source      [PBRT4 5.2.1, 5.2.3].
 * Space       The camera looks along +z from the plane z = 0, of which the shorter side of the
 *             picture spans [-1, 1] units. A lens moves with the pixel: a ray runs from s + l, with
 *             l on the disc of the lens, through (s, focus), for the place s of the pixel.
 * Densities   Without a lens: 1 / A for places, the direction is a delta. With one: s and l are
 *             uniform, and d.xy / d.z = -l / focus, so per solid angle the density of d is
 *             focus^2 / (cos^3 of the lens's area), and for any d that of the place 1 / A.
 * Departs     In pbrt rays of the lens start at l and not at s + l, a pinhole in effect. */
#include "sampling/warp.h"
#include "scene/scene.h"

typedef struct {
    Camera base;
    Screen screen;              /* at any distance */
    float  lens, focus;         /* radius and distance, scene units; lens 0: parallel */
} Orthographic;

static Camera *make(const Making *m, const Opts *o)
{
    Orthographic *c = arena_take(&m->scene->arena, 1, sizeof *c);

    if (!c || !camera_init(&c->base, m, o) || !screen_init(&c->screen, o))
        return NULL;
    c->lens = opt_float(o, "lensradius");
    c->focus = opt_float(o, "focaldistance");
    c->base.has_lens = c->lens > 0.0f;
    c->base.parallel = !c->base.has_lens;
    return &c->base;
}

static void film(Camera *base, uint32_t w, uint32_t h)
{
    Orthographic *c = (Orthographic *)base;
    screen_set(&c->screen, w, h, 1.0f);
}

/* (d.x, d.y) / d.z of the rays for this place on the lens. */
static V2 slope(const Orthographic *c, V2 u)
{
    V2 q = { 0, 0 };
    if (c->lens > 0.0f)
        q = warp_disk_concentric(u);
    return (V2){ -q.x * (c->lens / c->focus), -q.y * (c->lens / c->focus) };
}

static Ray ray(const Camera *base, V2 pixel, V2 u, float time)
{
    const Orthographic *c = (const Orthographic *)base;
    V2 at = screen_at(&c->screen, pixel), d = slope(c, u);
    V3 o = v3(at.x - d.x * c->focus, at.y - d.y * c->focus, 0.0f);
    Affine to_world, to_camera;

    camera_at(base, time, &to_world, &to_camera);
    return (Ray){ .o = affine_point(&to_world, o),
                  .d = v_unit(affine_vector(&to_world, v3(d.x, d.y, 1.0f))),
                  .tmax = INFINITY, .time = time };
}

/* What `view` gives, for the origin o, in camera space, and the direction w. */
static bool look(const Orthographic *c, const Affine *to_camera, V3 o, V3 w, CameraView *v)
{
    V3 d = affine_vector(to_camera, w);
    float cosine = v_dot(w, camera_normal(to_camera));

    if (!(d.z > 0.0f) || !(cosine > 0.0f))
        return false;
    v->pdf_a = (float)(1 / (c->screen.area * camera_area(to_camera)));
    v->pdf_w = 1.0f;
    if (c->lens > 0.0f) {
        double lens = c->lens / (double)c->focus;
        double across = (double)d.x * d.x + (double)d.y * d.y, z = d.z / sqrt(across + d.z * d.z);
        if (across > lens * lens * (1 + 1e-4) * d.z * d.z)
            return false;                       /* past the rim, by more than roundings */
        v->pdf_w = (float)(camera_solid(to_camera, d) / (PI * lens * lens * (z * z * z)));
        o = v3(o.x + d.x / d.z * c->focus, o.y + d.y / d.z * c->focus, 0.0f);
    }
    v->we = v->pdf_a * v->pdf_w / cosine;
    v->pixel = screen_pixel(&c->screen, o.x, o.y);
    return true;
}

static bool view(const Camera *base, const Ray *r, CameraView *v)
{
    const Orthographic *c = (const Orthographic *)base;
    Affine to_world, to_camera;

    camera_at(base, r->time, &to_world, &to_camera);
    return look(c, &to_camera, affine_point(&to_camera, r->o), r->d, v);
}

/* The place on the lens gives the direction; there is one place of the plane in it. Without a lens
 * the integral over that plane becomes one over the surface, cosines and all, and pdf_w is 1. */
static bool sample(const Camera *base, V3 from, V2 u, float time, CameraSample *s)
{
    const Orthographic *c = (const Orthographic *)base;
    V2 at = slope(c, u);
    V3 d = v3(at.x, at.y, 1.0f), p;
    Affine to_world, to_camera;
    CameraView v;

    camera_at(base, time, &to_world, &to_camera);
    p = affine_point(&to_camera, from);
    if (!(p.z > 0.0f))
        return false;
    p = v3(p.x - d.x * p.z, p.y - d.y * p.z, 0.0f);
    s->p = affine_point(&to_world, p);
    s->wi = v_unit(v_neg(affine_vector(&to_world, d)));
    s->dist = v_len(v_sub(s->p, from));
    if (!look(c, &to_camera, p, v_neg(s->wi), &v))
        return false;
    s->we = v.we;
    s->pixel = v.pixel;
    s->pdf_w = v.pdf_w;
    return true;
}

static const OptDef options[] = { LENS_OPTIONS, CAMERA_OPTIONS, { .key = NULL } };

const CameraKind camera_orthographic = {
    .info = { "orthographic", "PBRT4 5.2.1", "parallel rays; with a lens, cones of one size",
              options },
    .bytes = sizeof(Orthographic),
    .make = make, .film = film, .ray = ray, .view = view, .sample = sample
};

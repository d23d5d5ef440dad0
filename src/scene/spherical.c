/* spherical.c -- the cameras `spherical` and `environment`: all directions from one point, as
 * pictures that environment lights read: squares in which areas are solid angles, or latitude and
 * longitude.
 *
 * Source      [PBRT4 5.3], and version 3 for `environment`; [Clarberg08] for the squares.
 * Space       y is up. By latitude and longitude the top row looks up, the middle of a row along
 *             -x, and columns go from +x by +z and -x to -z.
 * Densities   pdf_w is 1 / (2 pi^2 sin theta), errata 5.1, or 1 / (4 pi). There is no lens and no
 *             cosine at it: We = pdf_w. */
#include "sampling/octahedral.h"
#include "scene/camera.h"

typedef struct {
    Camera base;
    bool   squares;
    float  w, h;                /* of the picture, pixels */
} Spherical;

static Camera *make(const Making *m, const Opts *o)
{
    Spherical *c = arena_take(&m->scene->arena, 1, sizeof *c);

    if (!c || !camera_init(&c->base, m, o))
        return NULL;
    c->squares = opt_is(o, "mapping", "equalarea");
    c->base.point = true;
    return &c->base;
}

static void film(Camera *base, uint32_t w, uint32_t h)
{
    Spherical *c = (Spherical *)base;
    c->w = (float)w;
    c->h = (float)h;
}

static Ray ray(const Camera *base, V2 pixel, V2 u, float time)
{
    const Spherical *c = (const Spherical *)base;
    V2 at = { pixel.x / c->w, pixel.y / c->h };
    Affine to_world, to_camera;
    V3 d;

    (void)u;
    if (c->squares)
        d = octahedral_sphere(octahedral_wrap(at));
    else {
        float sp, cp, st, ct;
        m_sincos(at.x * (2 * PI_F), &sp, &cp);
        m_sincos(at.y * PI_F, &st, &ct);
        d = v3(st * cp, st * sp, ct);
    }
    camera_at(base, time, &to_world, &to_camera);
    return (Ray){ .o = affine_point(&to_world, v3(0, 0, 0)),
                  .d = v_unit(affine_vector(&to_world, v3(d.x, d.z, d.y))),
                  .tmax = INFINITY, .time = time };
}

/* What `view` gives for the direction w. */
static bool look(const Spherical *c, const Affine *to_camera, V3 w, CameraView *v)
{
    V3 d = affine_vector(to_camera, w), unit = v_unit(d);
    V3 z_up = v3(unit.x, unit.z, unit.y);
    float sine = sqrtf(z_up.x * z_up.x + z_up.y * z_up.y);
    double solid = camera_solid(to_camera, d);
    V2 at;

    v->pdf_a = 1.0f;
    if (c->squares) {
        at = octahedral_square(z_up);
        v->pdf_w = (float)(solid / (4 * PI));
    } else {
        if (!(sine > 0.0f))
            return false;                       /* a pole: the whole of a row */
        at.x = m_atan2(z_up.y, z_up.x) * (0.5f * INV_PI);
        if (at.x < 0.0f)
            at.x += 1.0f;
        at.y = m_atan2(sine, z_up.z) * INV_PI;
        v->pdf_w = (float)(solid / (2 * PI * PI * sine));
    }
    v->we = v->pdf_w;
    v->pixel = (V2){ at.x * c->w, at.y * c->h };
    return true;
}

static bool view(const Camera *base, const Ray *r, CameraView *v)
{
    Affine to_world, to_camera;

    camera_at(base, r->time, &to_world, &to_camera);
    return look((const Spherical *)base, &to_camera, r->d, v);
}

static bool sample(const Camera *base, V3 from, V2 u, float time, CameraSample *s)
{
    Affine to_world, to_camera;
    CameraView v;
    V3 to;

    (void)u;
    camera_at(base, time, &to_world, &to_camera);
    s->p = affine_point(&to_world, v3(0, 0, 0));
    to = v_sub(s->p, from);
    s->dist = v_len(to);
    s->wi = v_unit(to);
    if (!(s->dist > 0.0f) || !look((const Spherical *)base, &to_camera, v_neg(s->wi), &v))
        return false;
    s->we = v.we;
    s->pixel = v.pixel;
    s->pdf_w = s->dist * s->dist;
    return true;
}

#define MAPPING(usual) \
    { .key = "mapping", .type = OPT_CHOICE, .str = usual, .choices = "equalarea equirectangular", \
      .help = "of the sphere to the picture" }

static const OptDef squares[] = { MAPPING("equalarea"), CAMERA_OPTIONS, { .key = NULL } };
static const OptDef rows[] = { MAPPING("equirectangular"), CAMERA_OPTIONS, { .key = NULL } };

const CameraKind camera_spherical = {
    .info = { "spherical", "PBRT4 5.3", "all around, area onto area", squares },
    .make = make, .film = film, .ray = ray, .view = view, .sample = sample
};
const CameraKind camera_environment = {
    .info = { "environment", "PBRT4 5.3", "all around, by latitude and longitude", rows },
    .make = make, .film = film, .ray = ray, .view = view, .sample = sample
};

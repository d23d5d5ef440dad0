/* spherical.c -- the cameras `spherical` and `environment`: all directions from one point, as
 * pictures that environment lights read: squares in which areas are solid angles, or latitude and
 * longitude.
 *
 * Source      [PBRT4 5.3], and version 3 for `environment`; [Clarberg08] for the squares.
 * Space       y is up. By latitude and longitude the top row looks up, the middle of a row along
 *             -x, and columns go from +x by +z and -x to -z.
 * Densities   pdf_w is 1 by the jacobian of the mapping, see panorama.h. There is no lens and no
 *             cosine at it: We = pdf_w. */
#include "scene/camera.h"
#include "scene/panorama.h"

typedef struct {
    Camera base;
    Mapping mapping;            /* latlong or octahedral, z up */
    float  w, h;                /* of the picture, pixels */
} Spherical;

static Camera *make(const Making *m, const Opts *o)
{
    Spherical *c = arena_take(&m->scene->arena, 1, sizeof *c);

    if (!c || !camera_init(&c->base, m, o))
        return NULL;
    c->mapping.kind = opt_is(o, "mapping", "equalarea") ? MAPPING_OCTAHEDRAL : MAPPING_LATLONG;
    c->base.point = true;
    return &c->base;
}

static void film(Camera *base, uint32_t w, uint32_t h)
{
    Spherical *c = (Spherical *)base;
    c->w = (float)w;
    c->h = (float)h;
}

/* The place in the picture of one a little beside it. Of squares, an edge is one with itself turned
 * round; rows go round, and beyond the poles is the other side. */
static V2 wrapped(const Spherical *c, V2 p)
{
    if (p.y < 0.0f || p.y > 1.0f) {
        p.y = p.y < 0.0f ? -p.y : 2.0f - p.y;
        p.x = c->mapping.kind == MAPPING_OCTAHEDRAL ? 1.0f - p.x : p.x + 0.5f;
    }
    if (p.x >= 0.0f && p.x <= 1.0f)
        return p;
    if (c->mapping.kind == MAPPING_OCTAHEDRAL)
        return (V2){ p.x < 0.0f ? -p.x : 2.0f - p.x, 1.0f - p.y };
    return (V2){ p.x - floorf(p.x), p.y };
}

static Ray ray(const Camera *base, V2 pixel, V2 u, float time)
{
    const Spherical *c = (const Spherical *)base;
    V2 at = { pixel.x / c->w, pixel.y / c->h };
    Affine to_world, to_camera;
    float jacobian;
    V3 d = mapping_direction(&c->mapping, wrapped(c, at), &jacobian);

    (void)u;
    camera_at(base, time, &to_world, &to_camera);
    return (Ray){ .o = affine_point(&to_world, v3(0, 0, 0)),
                  .d = v_unit(affine_vector(&to_world, v3(d.x, d.z, d.y))),
                  .tmax = INFINITY, .time = time };
}

/* What `view` gives for the direction w. */
static bool look(const Spherical *c, const Affine *to_camera, V3 w, CameraView *v)
{
    V3 d = affine_vector(to_camera, w), unit = v_unit(d);
    float jacobian;
    V2 at = mapping_place(&c->mapping, v3(unit.x, unit.z, unit.y), &jacobian);

    if (!(jacobian > 0.0f))
        return false;                           /* a pole: the whole of a row */
    v->pdf_a = 1.0f;
    v->pdf_w = (float)(camera_solid(to_camera, d) / jacobian);
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
    .bytes = sizeof(Spherical),
    .make = make, .film = film, .ray = ray, .view = view, .sample = sample
};
const CameraKind camera_environment = {
    .info = { "environment", "PBRT4 5.3", "all around, by latitude and longitude", rows },
    .bytes = sizeof(Spherical),
    .make = make, .film = film, .ray = ray, .view = view, .sample = sample
};

/* ambient.c -- the code of `ambient.h`
 *
 * Estimate    [Shirley91 5.2.1]: of the lights' power Phi a part R is reflected once, R^2 twice,
 *             and so on. In a closed room all of it arrives somewhere, so
 *               Phi_indirect = Phi R / (1 - R),   L_ambient = Phi_indirect / (pi A)
 *             with A the area of all surfaces and R their mean reflectance, weighted by area. In
 *             the open, light is lost, and the estimate is too bright.
 * Departs     By colour channel. Mirrors and clear glass hand light on: they are in neither A nor
 *             R. R is at most R_MOST: a room in which nothing is absorbed would be bright without
 *             bounds.
 * Sky         Environment lights are not in Phi: theirs is the light of a large sphere, most of
 *             which misses. Instead the eye looks round, before it more than beside it, at SEEN
 *             points; their mean irradiance by the sky over pi is S, and of the cosine-weighted
 *             directions there the part that is open is o. What is reflected meets a wall again
 *             but for that part:
 *               L_ambient = S                      for a method that does not ask these lights
 *                         + S q / (1 - q),  q = R (1 - o).
 *             Inside of a ball from which a cap is cut off that is the truth, as the form factors
 *             of all its points are the same. Without a camera, or with nothing in sight, S is the
 *             mean radiance and o is 1.
 * Measured    Of each shape whose material has textures at POINTS points, else at one; for each at
 *             four angles, at which the squared cosine is even. Parts of instances by the mean
 *             scale of their maps, as they stand at time 0. */
#include "integrators/ambient.h"

#include "base/maths.h"
#include "integrators/beam.h"
#include "sampling/warp.h"

#include <string.h>

#define R_MOST 0.98
enum { POINTS = 64, ANGLES = 4, SEEN = 512, ASKED = 16 };

/* Sums: area, and area times reflectance. */
static void add(Walls *w, const Walls *part, double scale)
{
    w->area += scale * part->area;
    for (int c = 0; c < 3; c++)
        w->reflectance[c] += scale * part->reflectance[c];
}

/* A piece of the surface, at the point. */
static void add_piece(Walls *w, const Scene *scene, const Surface *at, double area)
{
    const Material *m = &scene->materials[at->shape->material];
    Walls part = { 0.0, { 0.0, 0.0, 0.0 } };
    BsdfRoom room;
    const Bsdf *b = material_bsdf(m, at, &room);

    if (!(b->flags & BSDF_SMOOTH))
        return;
    part.area = area * (m->opacity ? clamp01(texture_alpha(m->opacity, at)) : 1.0f);
    for (int k = 0; k < ANGLES; k++) {
        float z = sqrtf(((float)k + 0.5f) / ANGLES);
        Rgb a = b->kind->albedo(b, v3(sqrtf(1.0f - z * z), 0.0f, z));
        part.reflectance[0] += part.area / ANGLES * clamp01(a.r);
        part.reflectance[1] += part.area / ANGLES * clamp01(a.g);
        part.reflectance[2] += part.area / ANGLES * clamp01(a.b);
    }
    add(w, &part, 1.0);
}

/* Points of a pattern without clusters: multiples of powers of the plastic number's inverse. */
static V2 place(int k)
{
    double x = 0.7548776662466927 * (k + 0.5), y = 0.5698402909980532 * (k + 0.5);
    return (V2){ (float)(x - (double)(int)x), (float)(y - (double)(int)y) };
}

static double face_area(const Geometry *g, uint32_t face)
{
    V3 c[3];
    geometry_face(g, face, c);
    return 0.5 * v_len(v_cross(v_sub(c[1], c[0]), v_sub(c[2], c[0])));
}

/* `faces` triangles, from `first`: the points stand in some of them, alike far apart. */
static void add_faces(Walls *w, const Scene *scene, const Geometry *g, uint32_t first,
                      uint32_t faces, int points)
{
    Walls some = { 0.0, { 0.0, 0.0, 0.0 } };
    double area = 0.0, weight = 0.0;

    for (uint32_t i = 0; i < faces; i++)
        area += face_area(g, first + i);
    for (int k = 0; k < points && faces; k++) {
        uint32_t face = first + (uint32_t)((uint64_t)faces * (uint64_t)k / (uint64_t)points);
        Ray none = { .d = { 0, 0, 1 } };
        double a = face_area(g, face);
        V2 u = place(k);
        Hit h = { 0, u.x, u.y, NO_PRIM, face };
        Surface at;
        if (u.x + u.y > 1.0f) {
            h.u = 1.0f - u.x;
            h.v = 1.0f - u.y;
        }
        geometry_surface(g, &none, &h, &at);
        add_piece(&some, scene, &at, a);
        weight += a;
    }
    if (weight > 0.0)
        add(w, &some, area / weight);
}

/* Points of a sphere or disc: on the surface, from which geometry finds the rest. */
static void add_round(Walls *w, const Scene *scene, const Geometry *g, const Shape *s, int points)
{
    const Sphere *sp = &s->as.sphere;
    const Disk *d = &s->as.disk;
    bool ball = s->kind == SHAPE_SPHERE;
    double area = ball ? (double)sp->phimax * sp->radius * (sp->zmax - sp->zmin)
                       : 0.5 * d->phimax * (f_sqr(d->radius) - f_sqr(d->inner));

    for (int k = 0; k < points; k++) {
        V2 u = place(k);
        Hit h = { 0, 0, 0, NO_PRIM, s->first };
        Ray at = { .d = { 0, 0, 1 } };
        Surface there;
        float r, z = 0.0f, sn, cs;
        const Frame *f = ball ? &sp->frame : &d->frame;
        m_sincos_turn(u.x * ((ball ? sp->phimax : d->phimax) / (2.0f * PI_F)), &sn, &cs);
        if (ball) {
            z = sp->zmin + u.y * (sp->zmax - sp->zmin);
            r = sqrtf(f_max(0.0f, (sp->radius - z) * (sp->radius + z)));
        } else
            r = sqrtf(f_sqr(d->inner) + u.y * (f_sqr(d->radius) - f_sqr(d->inner)));
        at.o = v_add(ball ? sp->centre : d->centre, frame_out(f, v3(r * cs, r * sn, z)));
        geometry_surface(g, &at, &h, &there);
        add_piece(w, scene, &there, area / points);
    }
}

static Walls walls_of(const Scene *scene, const Geometry *g);

/* The mean scale of areas is that of volumes to the power 2/3. */
static void add_instance(Walls *w, const Scene *scene, const Instance *in)
{
    const float (*m)[4] = in->to_world.m;
    Walls part = walls_of(scene, &scene->geometries[in->child]);
    double det = (double)m[0][0] * ((double)m[1][1] * m[2][2] - (double)m[1][2] * m[2][1]) -
                 (double)m[0][1] * ((double)m[1][0] * m[2][2] - (double)m[1][2] * m[2][0]) +
                 (double)m[0][2] * ((double)m[1][0] * m[2][1] - (double)m[1][1] * m[2][0]);

    add(w, &part, md_pow(fabs(det), 2.0 / 3.0));
}

static Walls walls_of(const Scene *scene, const Geometry *g)
{
    Walls w = { 0.0, { 0.0, 0.0, 0.0 } };

    for (size_t i = 0; i < g->nshapes; i++) {
        const Shape *s = &g->shapes[i];
        int points = s->kind != SHAPE_INSTANCE &&
                     (scene->materials[s->material].textured ||
                      scene->materials[s->material].opacity ||
                      scene->materials[s->material].kind == &bsdf_mix) ? POINTS : 1;
        switch (s->kind) {
        case SHAPE_MESH: add_faces(&w, scene, g, s->first, s->count, points); break;
        case SHAPE_TESSELLATION:
            add_faces(&w, scene, g, s->as.tessellation->first_face,
                      tessellation_faces(s->as.tessellation), points);
            break;
        case SHAPE_SPHERE:
        case SHAPE_DISK: add_round(&w, scene, g, s, points); break;
        case SHAPE_INSTANCE: add_instance(&w, scene, s->as.instance); break;
        }
    }
    return w;
}

Walls ambient_walls(const Scene *s)
{
    Walls w = s->ngeometries ? walls_of(s, &s->geometries[0]) : (Walls){ 0.0, { 0.0, 0.0, 0.0 } };
    for (int c = 0; c < 3; c++)
        w.reflectance[c] = w.area > 0.0 ? w.reflectance[c] / w.area : 0.0;
    return w;
}

/* ---- the sky ---- */

/* Of a sky of radiance L everywhere, the power is 4 pi L times the area of the sphere's disc. */
static Rgb mean_radiance(const Scene *s)
{
    Stage stage = stage_of(s);
    Rgb sum = rgb_all(0.0f);

    for (size_t i = 0; i < s->ninfinite; i++)
        sum = rgb_add(sum, s->infinite[i]->kind->power(s->infinite[i]));
    return rgb_scale(sum, 0.25f * INV_PI * stage_pdf_a(&stage));
}

/* Sums over points: irradiance by the sky over pi, and the open part of all directions. */
typedef struct { double sky[3], open; int n; } Outlook;

/* Number k of the points that are seen. */
static void look_up(Outlook *out, const Scene *s, const Vertex *v, uint32_t medium, int k,
                    Tracer *t)
{
    V3 up = v_dot(v->s.ng, frame_out(&v->frame, v->wo)) < 0.0f ? v_neg(v->s.ng) : v->s.ng;
    Frame f = frame_about(up);

    for (int j = 0; j < ASKED; j++) {
        V2 u = place(k * ASKED + j);
        Ray r = vertex_ray(v, frame_out(&f, warp_cosine(u)));
        out->open += tracer_blocked(t, &r) ? 0.0 : 1.0 / ASKED;
        for (size_t i = 0; i < s->ninfinite; i++) {
            LightSample ls;
            float cosine;
            Rgb c;
            if (!s->infinite[i]->kind->sample(s->infinite[i], v->s.p, u, &ls))
                continue;
            cosine = v_dot(up, ls.wi);
            r = shadow_ray(&v->s, &ls);
            c = rgb_scale(ls.L, cosine / (ls.pdf_w * PI_F * ASKED));
            if (cosine > 0.0f &&
                tracer_passes(t, &r, medium_beyond(&v->s, ls.wi, medium), &c)) {
                out->sky[0] += c.r;
                out->sky[1] += c.g;
                out->sky[2] += c.b;
            }
        }
    }
    out->n++;
}

/* From where the camera stands, at time 0. */
static Outlook look_round(const Scene *s)
{
    Outlook out = { { 0.0, 0.0, 0.0 }, 0.0, 0 };
    Frame f;
    Tracer t;

    memset(&t, 0, sizeof t);
    t.scene = s;
    f = frame_about(v_unit(affine_vector(&s->camera->to_world, v3(0, 0, 1))));
    for (int k = 0; k < SEEN; k++) {
        Ray r = { .o = affine_point(&s->camera->to_world, v_all(0.0f)), .tmax = INFINITY };
        Vertex v;
        Beam b;
        r.d = frame_out(&f, warp_cosine(place(k)));
        b = beam_from_eye(&r, s);
        if (!beam_meets(&b, &v.s, &t))
            continue;
        vertex_make(&v, s, b.ray.d);
        if (vertex_is_smooth(&v))
            look_up(&out, s, &v, b.medium, k, &t);
    }
    return out;
}

static float reflected(double R, double open)
{
    double q = d_min(R, R_MOST) * (1.0 - open);
    return (float)(q / (1.0 - q));
}

/* all: with what arrives straight from the sky. */
static Rgb from_sky(const Scene *s, const Walls *w, bool all)
{
    Outlook out = { { 0.0, 0.0, 0.0 }, 0.0, 0 };
    Rgb sky, more;
    float n;

    if (!s->ninfinite)
        return rgb_all(0.0f);
    if (s->camera)
        out = look_round(s);
    if (!out.n)
        return all ? mean_radiance(s) : rgb_all(0.0f);
    n = (float)out.n;
    sky = rgb((float)out.sky[0] / n, (float)out.sky[1] / n, (float)out.sky[2] / n);
    more = rgb_mul(sky, rgb(reflected(w->reflectance[0], out.open / out.n),
                            reflected(w->reflectance[1], out.open / out.n),
                            reflected(w->reflectance[2], out.open / out.n)));
    return all ? rgb_add(sky, more) : more;
}

/* L_ambient of the power phi. [Shirley91 5.2.1; errata 001.5] */
static float indirect(double phi, double R, double area)
{
    R = d_min(R, R_MOST);
    return area > 0.0 ? (float)(phi * R / (1.0 - R) / (PI * area)) : 0.0f;
}

Rgb ambient_light(const Scene *s, const Opts *o, bool sky)
{
    Rgb phi = rgb_all(0.0f), sum;
    Walls w;

    if (opt_is(o, "ambient", "none"))
        return phi;
    if (opt_is(o, "ambient", "constant"))
        return opt_rgb(o, "L0");
    for (size_t i = 0; i < s->nlights; i++)
        if (!s->lights[i]->kind->infinite)
            phi = rgb_add(phi, s->lights[i]->kind->power(s->lights[i]));
    w = ambient_walls(s);
    sum = rgb_add(from_sky(s, &w, sky), rgb(indirect(phi.r, w.reflectance[0], w.area),
                                            indirect(phi.g, w.reflectance[1], w.area),
                                            indirect(phi.b, w.reflectance[2], w.area)));
    return rgb_finite(sum) ? sum : rgb_all(0.0f);
}

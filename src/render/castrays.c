/* castrays.c -- rays made by rule, for measuring: the same five kinds, views and counts that are
 * customary where ray casters are compared, so that figures can be set against each other. */
#include "render/cast.h"

#include "base/random.h"
#include "sampling/warp.h"

#include <string.h>

#define FRAME_FOV  40.0f        /* degrees */
#define FRAME_AIR  1.02f        /* the camera stands so much farther off than all just fits */
#define OFF        1e-5         /* diagonals that secondary rays begin off the surface */
#define SHADOW_END 0.9999f      /* of the way to the light */

const char *const rays_names[RAYS_KINDS] = { "primary", "bounce", "shadow", "ao", "random" };

typedef struct {
    Box    box;
    V3     centre, eye, fwd, right, up, light;  /* fwd, right, up: unit */
    float  tan_x, tan_y;
    float  diagonal;
} View;

/* ---- the view ---- */

/* Corners of a triangle, or of the box of another primitive. */
static int points_of(const Geometry *g, uint32_t prim, V3 p[8])
{
    Box b;

    if (geometry_is_tri(g, prim)) {
        geometry_corners(g, prim, p);
        return 3;
    }
    b = geometry_box(g, prim);
    for (int k = 0; k < 8; k++)
        p[k] = v3(k & 1 ? b.hi.x : b.lo.x, k & 2 ? b.hi.y : b.lo.y, k & 4 ? b.hi.z : b.lo.z);
    return 8;
}

static void measure(View *v, const Geometry *g)
{
    double x, y, z;

    v->box = box_empty();
    for (uint32_t i = 0; i < geometry_prims(g); i++) {
        V3 p[8];
        for (int k = points_of(g, i, p); k-- > 0; )
            v->box = box_point(v->box, p[k]);
    }
    if (box_is_empty(v->box))
        v->box.lo = v->box.hi = v_all(0.0f);
    v->centre = box_centre(v->box);
    x = (double)v->box.hi.x - v->box.lo.x;
    y = (double)v->box.hi.y - v->box.lo.y;
    z = (double)v->box.hi.z - v->box.lo.z;
    v->diagonal = (float)sqrt(x * x + y * y + z * z);
}

static void aim(View *v, V3 dir)
{
    v->fwd = v_unit(dir);
    v->right = v_unit(v_cross(v->fwd, v3(0, 1, 0)));
    if (!(v_len2(v->right) > 0.0f))             /* straight up or down */
        v->right = v3(1, 0, 0);
    v->up = v_cross(v->right, v->fwd);
}

/* Moves the eye until all is seen: first across, so that what is seen is in the middle. */
static void frame(View *v, const Geometry *g)
{
    float x0 = INFINITY, x1 = -INFINITY, y0 = INFINITY, y1 = -INFINITY, back = 0.0f;
    V3 p[8], mid = v->centre;

    for (uint32_t i = 0; i < geometry_prims(g); i++)
        for (int k = points_of(g, i, p); k-- > 0; ) {
            V3 q = v_sub(p[k], v->centre);
            float x = v_dot(q, v->right), y = v_dot(q, v->up);
            x0 = f_min(x0, x);
            x1 = f_max(x1, x);
            y0 = f_min(y0, y);
            y1 = f_max(y1, y);
        }
    if (x0 <= x1)
        mid = v_mad(v->right, 0.5f * (x0 + x1), v_mad(v->up, 0.5f * (y0 + y1), mid));
    for (uint32_t i = 0; i < geometry_prims(g); i++)
        for (int k = points_of(g, i, p); k-- > 0; ) {
            V3 q = v_sub(p[k], mid);
            float x = v_absdot(q, v->right) / v->tan_x, y = v_absdot(q, v->up) / v->tan_y;
            back = f_max(back, f_max(x, y) - v_dot(q, v->fwd));
        }
    v->eye = v_mad(v->fwd, -FRAME_AIR * back, mid);
}

static void view_init(View *v, const Geometry *g, const RayRules *rules)
{
    V3 over = v3(0.5f, 0.8f, -0.8f);            /* right, up, forward */

    measure(v, g);
    v->tan_y = m_tan(0.5f * (rules->camera_given ? rules->fov : FRAME_FOV) * (PI_F / 180.0f));
    v->tan_x = v->tan_y * (float)rules->w / (float)rules->h;
    if (rules->camera_given) {
        v->eye = rules->eye;
        aim(v, v_sub(rules->target, rules->eye));
    } else {
        aim(v, v3(-0.45f, -0.3f, -1.0f));
        frame(v, g);
    }
    over = v_add(v_add(v_scale(v->right, over.x), v_scale(v->up, over.y)),
                 v_scale(v->fwd, over.z));
    v->light = rules->light_given ? rules->light : v_mad(over, v->diagonal, v->centre);
}

/* ---- rays ---- */

static bool set_init(RaySet *s, int kind, bool any, size_t room)
{
    memset(s, 0, sizeof *s);
    strcpy(s->kind, rays_names[kind]);
    s->any = any;
    s->rays = MEM_ARRAY(Ray, room);
    return s->rays != NULL;
}

static void push(RaySet *s, V3 o, V3 d, float tmax)
{
    if (v_finite(o) && v_finite(d) && v_max3(v_abs(d)) > 0.0f && tmax > 0.0f)
        s->rays[s->n++] = (Ray){ .o = o, .d = d, .tmax = tmax };
}

/* The k-th pair of numbers of ray i. */
static V2 pair(uint64_t seed, uint64_t i, uint64_t k)
{
    uint64_t bits = draw64(key_with(seed, i), k);
    return (V2){ unit_of((uint32_t)(bits >> 32)), unit_of((uint32_t)bits) };
}

static void make_primary(const View *v, const RayRules *rules, RaySet *s)
{
    for (uint32_t y = 0; y < rules->h; y++)
        for (uint32_t x = 0; x < rules->w; x++) {
            float sx = (2.0f * ((float)x + 0.5f) / (float)rules->w - 1.0f) * v->tan_x;
            float sy = (1.0f - 2.0f * ((float)y + 0.5f) / (float)rules->h) * v->tan_y;
            push(s, v->eye, v_unit(v_mad(v->right, sx, v_mad(v->up, sy, v->fwd))), INFINITY);
        }
}

static void make_secondary(const View *v, const RayRules *rules, const Accel *a, RaySet *set)
{
    const RaySet *from = &set[RAYS_PRIMARY];
    float off = (float)(OFF * v->diagonal);

    for (size_t i = 0; i < from->n; i++) {
        const Ray *r = &from->rays[i];
        Surface s;
        Frame f;
        V3 n, o, l;
        Hit h;

        if (!accel_nearest(a, r, &h))
            continue;
        accel_surface(a, r, &h, &s);
        n = v_dot(s.ng, r->d) > 0.0f ? v_neg(s.ng) : s.ng;
        o = ray_origin(s.p, v_mad(v_abs(n), off, s.err), n, n);
        f = frame_about(n);
        push(&set[RAYS_BOUNCE], o, frame_out(&f, warp_cosine(pair(rules->seed, i, 0))), INFINITY);
        push(&set[RAYS_AO], o, frame_out(&f, warp_cosine(pair(rules->seed, i, 1))),
             rules->ao * v->diagonal);
        l = v_sub(v->light, o);
        if (v_dot(l, n) > 0.0f)
            push(&set[RAYS_SHADOW], o, v_unit(l), SHADOW_END * v_len(l));
    }
}

static void make_random(const View *v, const RayRules *rules, RaySet *s)
{
    V3 extent = v_sub(v->box.hi, v->box.lo);
    size_t n = (size_t)rules->w * rules->h;

    for (size_t i = 0; i < n; i++) {
        V2 xy = pair(rules->seed, i, 3), z = pair(rules->seed, i, 4);
        V3 a = v_mad(warp_sphere(pair(rules->seed, i, 2)), 0.51f * v->diagonal, v->centre);
        V3 b = v_add(v->box.lo, v_mul(extent, v3(xy.x, xy.y, z.x)));
        push(s, a, v_unit(v_sub(b, a)), INFINITY);
    }
}

bool rays_make(const Scene *scene, const RayRules *rules, RaySet set[RAYS_KINDS])
{
    const Accel *a = scene->accel;
    size_t pixels = (size_t)rules->w * rules->h, hits = 0;
    View v;
    Hit h;
    bool ok;

    memset(set, 0, RAYS_KINDS * sizeof *set);
    view_init(&v, a->geo, rules);
    ok = set_init(&set[RAYS_PRIMARY], RAYS_PRIMARY, false, pixels);
    if (ok)
        make_primary(&v, rules, &set[RAYS_PRIMARY]);
    for (size_t i = 0; i < set[RAYS_PRIMARY].n; i++)
        hits += accel_nearest(a, &set[RAYS_PRIMARY].rays[i], &h);
    ok = ok && set_init(&set[RAYS_BOUNCE], RAYS_BOUNCE, false, hits) &&
         set_init(&set[RAYS_SHADOW], RAYS_SHADOW, true, hits) &&
         set_init(&set[RAYS_AO], RAYS_AO, true, hits) &&
         set_init(&set[RAYS_RANDOM], RAYS_RANDOM, false, pixels);
    if (ok) {
        make_secondary(&v, rules, a, set);
        make_random(&v, rules, &set[RAYS_RANDOM]);
    }
    for (int k = 0; !ok && k < RAYS_KINDS; k++)
        rayset_clear(&set[k]);
    return ok;
}

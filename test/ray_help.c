/* ray_help.c -- settings of accelerators and classes of rays. See ray_help.h. */
#include "test/ray_help.h"

#include "sampling/warp.h"

#include <stdio.h>
#include <string.h>

/* ---- accelerators ---- */

enum { SETTINGS_MAX = 400 };
static Setting all[SETTINGS_MAX], usual[40], brute[2];
static Arena words;

static void append(char *name, size_t room, const char *key, const char *value)
{
    size_t n = strlen(name);
    int more = snprintf(name + n, room - n, "%c%s=%s", strchr(name, ':') ? ',' : ':', key, value);
    REQUIRE(more > 0 && (size_t)more < room - n, "%s: no room for %s", name, key);
}

static void set(Setting *s, const char *key, const char *value)
{
    char text[100];
    snprintf(text, sizeof text, "%.40s=%.40s", key, value);
    REQUIRE(opts_parse(&s->opts, s->kind->info.name, text, &words), "%s", text);
    append(s->name, sizeof s->name, key, value);
}

/* The values worth trying of one option, as text, and how many. */
static int values_of(const OptDef *d, char value[16][24])
{
    int n = 0;
    const char *w = d->choices;

    if (d->type == OPT_BOOL) {
        strcpy(value[n++], "false");
        strcpy(value[n++], "true");
    } else if (d->type == OPT_CHOICE) {
        for (size_t k; *w; w += k, w += strspn(w, " ")) {
            k = strcspn(w, " ");
            snprintf(value[n++], 24, "%.*s", (int)k, w);
        }
    } else if (d->type == OPT_INT) {
        snprintf(value[n++], 24, "%.0f", d->lo);
        if (d->num != d->lo)
            snprintf(value[n++], 24, "%.0f", d->num);
        if (d->hi > d->num)
            snprintf(value[n++], 24, "%.0f", d->hi < 16 ? d->hi : 16);
    }
    return n;
}

/* Replaces setting s by one for each value of option k, and those by ones for the next option. */
static Setting *expand(Setting *out, Setting s, const OptDef *d)
{
    char value[16][24];
    int n;

    if (!d || !d->key) {
        REQUIRE(out < all + SETTINGS_MAX - 1, "too many settings of accelerators");
        *out = s;
        return out + 1;
    }
    n = values_of(d, value);
    for (int i = 0; i < n; i++) {
        Setting with = s;
        set(&with, d->key, value[i]);
        out = expand(out, with, d + 1);
    }
    return n ? out : expand(out, s, d + 1);
}

static Setting as_it_comes(const AccelKind *kind)
{
    Setting s;
    memset(&s, 0, sizeof s);
    s.kind = kind;
    opts_default(&s.opts, kind->info.options);
    snprintf(s.name, sizeof s.name, "%s", kind->info.name);
    return s;
}

const Setting *setting_brute(void)
{
    brute[0] = as_it_comes(kind_find(accels, "brute"));
    return brute;
}

const Setting *settings_all(void)
{
    Setting *out = all;
    for (int i = 0; accels[i]; i++)
        if (strcmp(accels[i]->info.name, "brute"))
            out = expand(out, as_it_comes(accels[i]), accels[i]->info.options);
    out->kind = NULL;
    return all;
}

const Setting *settings_usual(void)
{
    static const struct { const char *kind, *key, *value; } small[] = {
        { "lbvh", "bits", "8" }, { "wide", "form", "lean" }
    };
    size_t n = 0;
    for (int i = 0; accels[i]; i++)
        if (strcmp(accels[i]->info.name, "brute"))
            usual[n++] = as_it_comes(accels[i]);
    for (size_t i = 0; i < sizeof small / sizeof *small; i++) {
        usual[n] = as_it_comes(kind_find(accels, small[i].kind));
        set(&usual[n++], small[i].key, small[i].value);
    }
    usual[n++] = *setting_brute();
    usual[n].kind = NULL;
    return usual;
}

Accel *setting_build(const Setting *s, const Geometry *g)
{
    Accel *a = accel_build_as_is(s->kind, g, &s->opts, 1);
    REQUIRE(a != NULL, "%s cannot be built", s->name);
    return a;
}

Accel *setting_arrange(const Setting *s, Geometry *g)
{
    Accel *a = accel_build(s->kind, g, &s->opts, 1);
    REQUIRE(a != NULL, "%s cannot be built", s->name);
    return a;
}

bool setting_is_forest(const Setting *s)
{
    const OptDef *d = s->kind->info.options;
    while (d && d->key && strcmp(d->key, "pieces"))
        d++;
    return d && d->key;
}

uint64_t prims_most(const Accel *a)
{
    uint64_t n = geometry_prims(a->geo) + a->geo->nfaces;
    return a->refs > n ? a->refs : n;
}

/* ---- chance ---- */

float rng_between(Rng *r, float lo, float hi) { return lo + (hi - lo) * rng_unit(r); }

V3 rng_direction(Rng *r)
{
    V2 u;
    u.x = rng_unit(r);
    u.y = rng_unit(r);
    return v_unit(warp_sphere(u));
}

V3 rng_in_box(Rng *r, Box b)
{
    float x = rng_unit(r), y = rng_unit(r), z = rng_unit(r);
    V3 size = v_sub(b.hi, b.lo);
    return v3(b.lo.x + x * size.x, b.lo.y + y * size.y, b.lo.z + z * size.z);
}

V3 rng_barycentric(Rng *r)
{
    V2 u;
    u.x = rng_unit(r);
    u.y = rng_unit(r);
    return warp_triangle(u);
}

V3 blend(V3 a, V3 b, V3 c, V3 w)
{
    return v3((float)((double)w.x * a.x + (double)w.y * b.x + (double)w.z * c.x),
              (float)((double)w.x * a.y + (double)w.y * b.y + (double)w.z * c.y),
              (float)((double)w.x * a.z + (double)w.y * b.z + (double)w.z * c.z));
}

static float step(float x, bool up)
{
    uint32_t bits;
    if (x == 0.0f)
        return up ? 0x1p-149f : -0x1p-149f;
    memcpy(&bits, &x, 4);
    bits += (x > 0.0f) == up ? 1u : UINT32_MAX;
    memcpy(&x, &bits, 4);
    return x;
}
float float_after(float x) { return step(x, true); }
float float_before(float x) { return step(x, false); }

/* ---- rays ---- */

const char *const ray_class_names[RAY_CLASSES] = {
    "random", "inside", "axis", "plane", "tiny", "on vertex", "on face", "to vertex", "to edge",
    "to centre", "grazing", "short", "length", "extreme", "neighbour"
};

RayMaker ray_maker(const Geometry *g, const Accel *truth, uint64_t seed)
{
    RayMaker m = { .g = g, .truth = truth, .box = box_empty(), .rng = rng_seed(seed),
                   .times = rng_seed(~seed) };

    for (uint32_t i = 0; i < geometry_prims(g); i++)
        m.box = box_join(m.box, geometry_box(g, i));
    if (box_is_empty(m.box))
        m.box = (Box){ v_all(-1.0f), v_all(1.0f) };
    return m;
}

/* Three places on the surface of a sphere, or corners of the box of another primitive. */
static void odd_corners(RayMaker *m, const Shape *s, Box b, V3 c[3])
{
    for (int k = 0; k < 3; k++)
        if (s && s->kind == SHAPE_SPHERE)
            c[k] = v_mad(rng_direction(&m->rng), s->as.sphere.radius, s->as.sphere.centre);
        else {
            uint32_t bits = rng_below(&m->rng, 8);
            c[k] = v3(bits & 1 ? b.hi.x : b.lo.x, bits & 2 ? b.hi.y : b.lo.y,
                      bits & 4 ? b.hi.z : b.lo.z);
        }
}

/* Corners of a random triangle, within instances too; half of them of odd primitives, if any. */
static void corners_within(RayMaker *m, const Geometry *g, V3 c[3])
{
    uint32_t n = geometry_prims(g), odd = (uint32_t)g->nodd;
    uint32_t prim = odd && rng_below(&m->rng, 2) ? n - 1 - rng_below(&m->rng, odd)
                                                 : rng_below(&m->rng, n ? n : 1);
    const Shape *s = n ? geometry_shape(g, prim) : NULL;

    if (n && geometry_is_tri(g, prim))
        geometry_corners(g, prim, c);
    else if (s && s->kind == SHAPE_TESSELLATION) {
        const Tessellation *t = s->as.tessellation;
        tessellation_corners(t, rng_below(&m->rng, tessellation_faces(t)), c);
    } else if (s && s->kind == SHAPE_INSTANCE) {
        Affine to_world, to_object;
        corners_within(m, s->as.instance->accel->geo, c);
        instance_at(s->as.instance, m->time, &to_world, &to_object);
        for (int k = 0; k < 3; k++)
            c[k] = affine_point(&to_world, c[k]);
    } else
        odd_corners(m, s, n ? geometry_box(g, prim) : m->box, c);
}

static void any_corners(RayMaker *m, V3 c[3]) { corners_within(m, m->g, c); }

static V3 any_vertex(RayMaker *m)
{
    V3 c[3];
    any_corners(m, c);
    return c[rng_below(&m->rng, 3)];
}

static V3 on_edge(RayMaker *m)
{
    V3 c[3];
    float w = rng_unit(&m->rng);
    any_corners(m, c);
    return blend(c[0], c[1], c[2], v3(w, 1.0f - w, 0.0f));
}

static V3 on_face(RayMaker *m)
{
    V3 c[3];
    any_corners(m, c);
    return blend(c[0], c[1], c[2], rng_barycentric(&m->rng));
}

static V3 at_centre(RayMaker *m)
{
    V3 c[3];
    any_corners(m, c);
    return blend(c[0], c[1], c[2], v_all(1.0f / 3.0f));
}

/* In a box thrice as large about the same centre, so some origins lie within the mesh; one in eight
 * from far away. */
static V3 around(RayMaker *m)
{
    V3 half = v_sub(v_scale(m->box.hi, 0.5f), v_scale(m->box.lo, 0.5f)), c = box_centre(m->box);
    float far = rng_below(&m->rng, 8) ? 3.0f : 3000.0f;
    return rng_in_box(&m->rng, (Box){ v_mad(half, -far, c), v_mad(half, far, c) });
}

static float *axis_of(V3 *v, uint32_t k) { return k == 0 ? &v->x : k == 1 ? &v->y : &v->z; }

static float signed_zero(RayMaker *m) { return rng_below(&m->rng, 2) ? 0.0f : -0.0f; }

static Ray run_along(RayMaker *m, uint32_t zeros)
{
    Ray r = { .o = around(m), .d = { 0, 0, 0 }, .tmax = INFINITY };
    uint32_t axis = rng_below(&m->rng, 3);

    r.d = rng_direction(&m->rng);
    if (zeros == 2) {
        r.d = v3(signed_zero(m), signed_zero(m), signed_zero(m));
        *axis_of(&r.d, axis) = rng_below(&m->rng, 2) ? 1.0f : -1.0f;
    } else
        *axis_of(&r.d, axis) = signed_zero(m);
    for (uint32_t k = 0; k < 3; k++)                    /* on planes of vertices, and so of boxes */
        if (rng_below(&m->rng, 2)) {
            V3 v = any_vertex(m);
            *axis_of(&r.o, k) = *axis_of(&v, k);
        }
    return r;
}

static Ray tiny_components(RayMaker *m)
{
    static const float size[10] = { 0.0f, 0x1p-149f, 1e-42f, 0x1p-127f, 0x1p-126f, 1e-30f, 1e-10f,
                                    1e-3f, 0.5f, 1.0f };
    Ray r = { .o = around(m), .d = { 0, 0, 0 }, .tmax = INFINITY };

    for (uint32_t k = 0; k < 3; k++)
        *axis_of(&r.d, k) = size[rng_below(&m->rng, 10)] * (rng_below(&m->rng, 2) ? 1.0f : -1.0f);
    if (rng_below(&m->rng, 2))
        r.o = any_vertex(m);
    *axis_of(&r.d, rng_below(&m->rng, 3)) = 1.0f;
    return r;
}

static Ray within_plane(RayMaker *m)
{
    Ray r = { .o = { 0, 0, 0 }, .d = { 0, 0, 0 }, .tmax = INFINITY };
    V3 c[3], w = rng_barycentric(&m->rng);
    float a = rng_between(&m->rng, -3.0f, 3.0f), b = rng_between(&m->rng, -3.0f, 3.0f);

    any_corners(m, c);
    if (rng_below(&m->rng, 2)) {
        r.o = blend(c[0], c[1], c[2], v3(1.0f - a - b, a, b));
        r.d = v_sub(blend(c[0], c[1], c[2], w), r.o);
    } else {
        r.o = blend(c[0], c[1], c[2], v3(1.0f - a, a, 0.0f));
        r.d = v_sub(c[a < 0.5f], r.o);
    }
    return r;
}

static Ray aim(RayMaker *m, V3 at)
{
    Ray r = { .o = around(m), .d = { 0, 0, 0 }, .tmax = INFINITY };
    r.d = v_sub(at, r.o);
    if (rng_below(&m->rng, 2))
        r.d = v_unit(r.d);
    return r;
}

static Ray cut_short(RayMaker *m)
{
    Ray r = aim(m, on_face(m));
    Hit h;

    r.tmax = 1.0f;
    r.time = m->time;
    if (accel_nearest(m->truth, &r, &h))
        switch (rng_below(&m->rng, 4)) {
        case 0: r.tmax = float_before(h.t); break;
        case 1: r.tmax = h.t; break;
        case 2: r.tmax = float_after(h.t); break;
        case 3: r.tmax = h.t * rng_unit(&m->rng); break;
        }
    return r;
}

/* Of another class, and then 31 that differ from it by a little, in direction or in origin too, and
 * that end somewhere else. */
static Ray neighbour(RayMaker *m)
{
    Ray r = m->first;
    float apart = rng_below(&m->rng, 2) ? 0.02f : 1e-5f;

    if (m->neighbours-- == 0) {
        m->neighbours = 31;
        return m->first = ray_make(m, (RayClass)rng_below(&m->rng, RAY_NEIGHBOUR));
    }
    r.d = v_mul(r.d, v3(1.0f + apart * rng_unit(&m->rng), 1.0f + apart * rng_unit(&m->rng),
                        1.0f + apart * rng_unit(&m->rng)));
    if (rng_below(&m->rng, 4) == 0)
        r.o = v_mad(v_sub(any_vertex(m), r.o), apart, r.o);
    if (rng_below(&m->rng, 4) == 0)
        r.tmax = rng_below(&m->rng, 2) ? 1.0f : 3.0f * rng_unit(&m->rng);
    return r;
}

static float power_of_2(RayMaker *m, int lo, int hi)
{
    int e = lo + (int)rng_below(&m->rng, (uint32_t)(hi - lo + 1));
    float x = 1.0f;
    for (; e > 0; e--)
        x *= 2.0f;
    for (; e < 0; e++)
        x *= 0.5f;
    return x;
}

Ray ray_make(RayMaker *m, RayClass c)
{
    Ray r = { .o = { 0, 0, 0 }, .d = { 0, 0, 0 }, .tmax = INFINITY };
    uint32_t when = rng_below(&m->times, 8);
    V3 at;

    m->time = when == 0 ? 0.0f : when == 1 ? 1.0f : rng_unit(&m->times);
    switch (c) {
    case RAY_RANDOM:    r = aim(m, rng_in_box(&m->rng, m->box)); break;
    case RAY_INSIDE:    r.o = rng_in_box(&m->rng, m->box); r.d = rng_direction(&m->rng); break;
    case RAY_AXIS:      r = run_along(m, 2); break;
    case RAY_PLANE:     r = run_along(m, 1); break;
    case RAY_TINY:      r = tiny_components(m); break;
    case RAY_ON_VERTEX: r.o = any_vertex(m); at = any_vertex(m);
                        r.d = rng_below(&m->rng, 2) ? rng_direction(&m->rng) : v_sub(at, r.o);
                        break;
    case RAY_ON_FACE:   r.o = rng_below(&m->rng, 2) ? on_edge(m) : on_face(m);
                        r.d = rng_direction(&m->rng); break;
    case RAY_TO_VERTEX: r = aim(m, any_vertex(m)); break;
    case RAY_TO_EDGE:   r = aim(m, on_edge(m)); break;
    case RAY_TO_CENTRE: r = aim(m, at_centre(m)); break;
    case RAY_GRAZING:   r = within_plane(m); break;
    case RAY_SHORT:     r = cut_short(m); break;
    case RAY_LENGTH:    r = aim(m, on_face(m)); r.d = v_scale(r.d, power_of_2(m, -60, 60)); break;
    case RAY_EXTREME:   r = aim(m, on_face(m)); r.d = v_scale(r.d, power_of_2(m, -130, 126)); break;
    case RAY_NEIGHBOUR: r = neighbour(m); break;
    case RAY_CLASSES:   break;
    }
    if (r.d.x == 0.0f && r.d.y == 0.0f && r.d.z == 0.0f)        /* a ray has a direction */
        r.d.x = 1.0f;
    r.time = m->time;
    return r;
}

const char *ray_text(const Ray *r)
{
    static char text[4][240];
    static int turn;
    char *t = text[turn++ & 3];
    snprintf(t, sizeof text[0], "o (%a %a %a) d (%a %a %a) tmax %a time %a", (double)r->o.x,
             (double)r->o.y, (double)r->o.z, (double)r->d.x, (double)r->d.y, (double)r->d.z,
             (double)r->tmax, (double)r->time);
    return t;
}

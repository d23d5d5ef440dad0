/* physics.c -- means, scenes and measuring for the tests of light transport. See physics.h. */
#include "test/physics.h"

#include "base/random.h"
#include "sampling/warp.h"

#include <stdio.h>
#include <string.h>

#define Z_MOST 5.6
#define FIND 8.7                /* 5.6 to be seen, 3.1 more to be seen in 999 of 1000 seeds */
#define FLOATS ROUNDINGS(64)
#define TAIL 0.01
enum { BLOCK = 64 };             /* independent samples that make one value: less arithmetic */

/* ---- means ---- */

void stat_add_block(Stat *s, double mean, double n, double largest)
{
    double d = mean - s->mean;
    s->n += 1;
    s->mean += d / s->n;
    s->squares += d * (mean - s->mean);
    s->total += mean * n;
    s->largest = largest > s->largest ? largest : s->largest;
}

void stat_add(Stat *s, double x) { stat_add_block(s, x, 1, fabs(x)); }

double stat_error(const Stat *s)
{
    return s->n > 1 ? sqrt(s->squares / (s->n - 1) / s->n) : INFINITY;
}

double stat_power(const Stat *s) { return FIND * stat_error(s) / fabs(s->mean); }

static double declared(double delta) { return test_is_long() ? 0.25 * delta : delta; }

/* Power and tails. */
static bool is_sound(const Stat *s, double delta, const char *what)
{
    double power = stat_power(s);
    bool strong = power <= declared(delta), light = s->largest <= TAIL * fabs(s->total);

    EXPECT(strong, "%s: no power: a bias below %.3g %% may pass, %.3g %% was declared", what,
           100 * power, 100 * declared(delta));
    EXPECT(light, "%s: inconclusive: one contribution, %.3g, is %.2g %% of the sum", what,
           s->largest, 100 * s->largest / fabs(s->total));
    return strong && light;
}

void stat_expect(const Stat *s, double truth, double delta, const char *what)
{
    double off = s->mean - truth, se = stat_error(s);

    if (truth == 0) {
        EXPECT(s->n > 0 && s->largest == 0, "%s: %.9g, it is 0", what, s->mean);
        return;
    }
    EXPECT(fabs(off) <= Z_MOST * se + FLOATS * fabs(truth),
           "%s: %.9g, it is %.9g: off by %.3g %%, z = %.1f", what, s->mean, truth,
           100 * off / truth, off / se);
    is_sound(s, delta, what);
}

void stat_expect_same(const Stat *a, const Stat *b, double delta, const char *what)
{
    double off = a->mean - b->mean, ea = stat_error(a), eb = stat_error(b);
    double se = sqrt(ea * ea + eb * eb);

    EXPECT(fabs(off) <= Z_MOST * se + FLOATS * fabs(b->mean),
           "%s: %.9g against %.9g: off by %.3g %%, z = %.1f", what, a->mean, b->mean,
           100 * off / b->mean, off / se);
    is_sound(a, delta, what);
    is_sound(b, delta, what);
}

void stat_expect_rgb(const Stat s[3], const double truth[3], double delta, const char *what)
{
    static const char *const channel[3] = { "red", "green", "blue" };
    char name[200];

    for (int k = 0; k < 3; k++) {
        snprintf(name, sizeof name, "%s, %s", what, channel[k]);
        stat_expect(&s[k], truth[k], delta, name);
    }
}

/* With t = sqrt(dof) tan(theta) the density becomes cos^(dof - 1) theta: Simpson's rule on what is
 * beyond t, over the same from 0. */
static double cosine_power(double from, double power)
{
    enum { STEPS = 2000 };
    double h = (PI / 2 - from) / STEPS, sum = 0;

    for (int i = 0; i <= STEPS; i++) {
        double c = md_cos(from + i * h), f = c > 0 ? md_pow(c, power) : 0;
        sum += f * (i == 0 || i == STEPS ? 1 : i % 2 ? 4 : 2);
    }
    return sum * h / 3;
}

double student_tail(double t, double dof)
{
    return cosine_power(md_atan2(fabs(t), sqrt(dof)), dof - 1) / cosine_power(0, dof - 1);
}

/* ---- scenes ---- */

void lab_init(Lab *l)
{
    memset(l, 0, sizeof *l);
    l->scene = scene_new();
    REQUIRE(l->scene, "no scene");
}

void lab_clear(Lab *l)
{
    integrator_close(l->integrator);
    l->integrator = NULL;
    scene_free(l->scene);
    mem_free(l->opts);
    arena_clear(&l->arena);
    memset(l, 0, sizeof *l);
}

static const void *kind_with(Lab *l, const void *list, const char *name, const char *text, Opts *o)
{
    const KindInfo *info = kind_find(list, name);

    REQUIRE(info, "there is no %s", name);
    opts_default(o, info->options);
    REQUIRE(opts_parse(o, name, text, &l->arena), "options of %s: %s", name, text);
    return info;
}

uint32_t lab_material(Lab *l, const char *kind, const char *options)
{
    uint32_t index;
    Material m;
    Opts o;
    const BsdfKind *k = kind_with(l, bsdfs, kind, options, &o);

    REQUIRE(material_init(&m, k, &o, NULL), "material");
    REQUIRE(scene_add_material(l->scene, &m, &index), "memory");
    return index;
}

static Geometry *world(Lab *l) { return &l->scene->geometries[0]; }

static ShapeTraits traits_of(uint32_t material, bool flip)
{
    return (ShapeTraits){ material, NO_LIGHT, flip };
}

uint32_t lab_mesh(Lab *l, Mesh *m, uint32_t material, bool flip)
{
    uint32_t shape;
    REQUIRE(geometry_add_mesh(world(l), m, traits_of(material, flip), &shape), "memory");
    return shape;
}

static uint32_t quad(Lab *l, V3 corner, V3 a, V3 b, uint32_t material, bool uv)
{
    Mesh m = { 0 };

    m.p = MEM_ARRAY(V3, 4);
    m.tri = MEM_ARRAY(Tri, 2);
    m.uv = uv ? MEM_ARRAY(V2, 4) : NULL;
    REQUIRE(m.p && m.tri && (m.uv || !uv), "memory");
    m.nverts = 4;
    m.ntris = 2;
    m.p[0] = corner;
    m.p[1] = v_add(corner, a);
    m.p[2] = v_add(m.p[1], b);
    m.p[3] = v_add(corner, b);
    for (int i = 0; uv && i < 4; i++)
        m.uv[i] = (V2){ i == 1 || i == 2, i >= 2 };
    m.tri[0] = (Tri){ { 0, 1, 2 } };
    m.tri[1] = (Tri){ { 0, 2, 3 } };
    return lab_mesh(l, &m, material, false);
}

uint32_t lab_quad(Lab *l, V3 corner, V3 a, V3 b, uint32_t material)
{
    return quad(l, corner, a, b, material, false);
}

uint32_t lab_screen(Lab *l, V3 corner, V3 a, V3 b, uint32_t material)
{
    return quad(l, corner, a, b, material, true);
}

uint32_t lab_zone(Lab *l, V3 centre, float radius, float zmin, float zmax, uint32_t material,
                  bool flip)
{
    Transform t = xf_translate(centre.x, centre.y, centre.z);
    uint32_t shape;
    Sphere s;

    REQUIRE(sphere_init(&s, &t, radius, zmin, zmax, 360), "sphere");
    REQUIRE(geometry_add_sphere(world(l), &s, traits_of(material, flip), &shape), "memory");
    return shape;
}

uint32_t lab_sphere(Lab *l, V3 centre, float radius, uint32_t material, bool flip)
{
    return lab_zone(l, centre, radius, -radius, radius, material, flip);
}

uint32_t lab_disk(Lab *l, V3 centre, V3 normal, float radius, float inner, uint32_t material)
{
    uint32_t shape;
    Disk d;

    memset(&d, 0, sizeof d);
    d.centre = centre;
    d.frame = frame_about(v_unit(normal));
    d.radius = radius;
    d.inner = inner;
    d.phimax = 2.0f * PI_F;
    REQUIRE(geometry_add_disk(world(l), &d, traits_of(material, false), &shape), "memory");
    return shape;
}

static uint32_t add_light(Lab *l, const char *kind, const char *options, Making *m)
{
    const LightKind *k;
    uint32_t index;
    Light *light;
    Opts o;

    k = kind_with(l, lights, kind, options, &o);
    m->scene = l->scene;
    m->max_pixels = IMAGE_PIXELS_DEFAULT;
    light = k->make(m, &o);
    REQUIRE(light, "light %s", kind);
    light->kind = k;
    REQUIRE(scene_add_light(l->scene, light, &index), "memory");
    return index;
}

uint32_t lab_light(Lab *l, const char *kind, const char *options, const Transform *t)
{
    Making m;
    memset(&m, 0, sizeof m);
    m.to_world = t ? *t : xf_identity();
    return add_light(l, kind, options, &m);
}

uint32_t lab_shine(Lab *l, uint32_t shape, const char *options)
{
    Making m;
    uint32_t index;

    memset(&m, 0, sizeof m);
    m.to_world = xf_identity();
    m.shape = shape;
    index = add_light(l, "diffuse", options, &m);
    world(l)->shapes[shape].light = index;
    return index;
}

uint32_t lab_sky(Lab *l, uint32_t w, uint32_t h, Rgb (*f)(V3 w), const Transform *t)
{
    return lab_sky_as(l, w, h, f, t, "scale=1");
}

/* An empty picture, given to the scene under a name, as if it had been read from a file. */
static SceneImage *new_picture(Lab *l, uint32_t w, uint32_t h)
{
    Scene *s = l->scene;
    SceneImage *im = MEM_NEW(SceneImage);
    char name[40];

    snprintf(name, sizeof name, "picture %lu", (unsigned long)s->nimages);
    REQUIRE(im && image_init(&im->image, w, h), "memory");
    im->path = arena_string(&s->arena, name, strlen(name));
    REQUIRE(MEM_PUSH(s->images, s->nimages, s->cap_images, im), "memory");
    return im;
}

uint32_t lab_sky_as(Lab *l, uint32_t w, uint32_t h, Rgb (*f)(V3 w), const Transform *t,
                    const char *options)
{
    SceneImage *im = new_picture(l, w, h);
    char option[200];

    for (uint32_t y = 0; y < h; y++)
        for (uint32_t x = 0; x < w; x++) {
            double theta = PI * (y + 0.5) / h, phi = 2 * PI * (x + 0.5) / w, st = md_sin(theta);
            V3 d = v3((float)(st * md_cos(phi)), (float)(st * md_sin(phi)), (float)md_cos(theta));
            *image_at(&im->image, x, y) = f(d);
        }
    snprintf(option, sizeof option, "filename=%s,%s", im->path, options);
    return lab_light(l, "infinite", option, t);
}

const char *lab_picture(Lab *l, uint32_t w, uint32_t h, Rgb (*f)(float x, float y))
{
    SceneImage *im = new_picture(l, w, h);

    for (uint32_t y = 0; y < h; y++)
        for (uint32_t x = 0; x < w; x++)
            *image_at(&im->image, x, y) = f(((float)x + 0.5f) / (float)w,
                                            ((float)y + 0.5f) / (float)h);
    return im->path;
}

void lab_build(Lab *l)
{
    Opts o;
    const AccelKind *k = kind_with(l, accels, ACCEL_DEFAULT, "", &o);
    REQUIRE(scene_build(l->scene, k, &o, 1), "the scene was not built");
}

const IntegratorKind *lab_method(Lab *l, const char *text, Opts *o)
{
    const char *end = text + strcspn(text, ":");
    char name[40];

    snprintf(name, sizeof name, "%.*s", (int)(end - text), text);
    if (strchr(name, '=') || !*name)            /* options of `path` alone */
        return kind_with(l, integrators, "path", text, o);
    return kind_with(l, integrators, name, *end ? end + 1 : "", o);
}

void lab_open(Lab *l, const char *method)
{
    const IntegratorKind *k;

    integrator_close(l->integrator);
    mem_free(l->opts);
    l->opts = MEM_NEW(Opts);
    REQUIRE(l->opts, "memory");
    k = lab_method(l, method, l->opts);
    l->integrator = integrator_open(k, l->scene, l->opts);
    REQUIRE(l->integrator, "%s", method);
}

bool lab_opens(Lab *l, const char *method)
{
    Opts o;
    const IntegratorKind *k = lab_method(l, method, &o);
    Integrator *it = integrator_open(k, l->scene, &o);

    integrator_close(it);
    return it != NULL;
}

void mesh_move(Mesh *m, float scale, V3 by)
{
    for (uint32_t i = 0; i < m->nverts; i++)
        m->p[i] = v_mad(m->p[i], scale, by);
}

void mesh_part(Mesh *part, const Mesh *m, uint32_t first, uint32_t end)
{
    memset(part, 0, sizeof *part);
    part->nverts = m->nverts;
    part->ntris = end - first;
    part->p = MEM_ARRAY(V3, part->nverts);
    part->tri = MEM_ARRAY(Tri, part->ntris);
    REQUIRE(part->p && part->tri, "memory");
    memcpy(part->p, m->p, part->nverts * sizeof *m->p);
    memcpy(part->tri, m->tri + first, part->ntris * sizeof *m->tri);
}

/* ---- measuring ---- */

/* What is gathered of one run: sums, and the largest contributions. */
typedef struct { double sum[METER_VALUES][3], largest[METER_VALUES][3]; } Gathered;

static void gather_one(Gathered *g, int k, Rgb c)
{
    double v[3] = { c.r, c.g, c.b };
    for (int i = 0; i < 3; i++) {
        g->sum[k][i] += v[i];
        if (fabs(v[i]) > g->largest[k][i])
            g->largest[k][i] = fabs(v[i]);
    }
}

static void gather(Gathered *g, Rgb L, const Tally *t)
{
    gather_one(g, 0, L);
    for (int k = 0; k < TALLY_LENGTHS; k++)
        gather_one(g, 1 + k, t->length[k]);
    for (int k = 0; k < STRATEGIES; k++)
        gather_one(g, 1 + TALLY_LENGTHS + k, t->strategy[k]);
}

static void meter_add(Meter *m, const Gathered *g, double n)
{
    for (int k = 0; k < METER_VALUES; k++)
        for (int i = 0; i < 3; i++)
            stat_add_block(&m->value[k][i], g->sum[k][i] / n, n, g->largest[k][i]);
}

static void measure_run(Lab *l, const Gauge *g, Tracer *t, uint32_t n, Gathered *sum)
{
    for (uint32_t i = 0; i < n; i++) {
        Rgb L;
        Ray r;
        sampler_start(&t->sampler, i);
        r = g->ray(g->of, &t->sampler);
        memset(t->tally, 0, sizeof *t->tally);
        L = l->integrator->kind->radiance(l->integrator, &r, t);
        REQUIRE(rgb_finite(L), "radiance is not finite in sample %lu", (unsigned long)i);
        gather(sum, L, t->tally);
    }
}

/* The parts by length, and those by strategy, add up to the whole but for roundings of the sums. */
static void expect_parts(const Meter *m)
{
    for (int c = 0; c < 3; c++) {
        double whole = m->value[0][c].mean, lengths = 0, strategies = 0;
        for (int k = 0; k < TALLY_LENGTHS; k++)
            lengths += meter_length(m, k)[c].mean;
        for (int k = 0; k < STRATEGIES; k++)
            strategies += meter_strategy(m, (Strategy)k)[c].mean;
        EXPECT(fabs(lengths - whole) <= FLOATS * whole &&
                   fabs(strategies - whole) <= FLOATS * whole,
               "radiance %.9g, by lengths %.9g, by strategies %.9g", whole, lengths, strategies);
    }
}

void lab_measure(Lab *l, const Gauge *g, Meter *m)
{
    uint64_t n = test_is_long() ? 16 * g->n : g->n;
    uint32_t each = g->run ? g->run : BLOCK, spp = each;
    const SamplerKind *kind = kind_find(samplers, g->run ? SAMPLER_DEFAULT : "random");
    Tracer t;
    Tally tally;
    Opts none;

    memset(m, 0, sizeof *m);
    memset(&t, 0, sizeof t);
    t.scene = l->scene;
    t.tally = &tally;
    opts_default(&none, kind->info.options);
    REQUIRE(sampler_init(&t.sampler, kind, &none, g->seed, &spp), "sampler");
    for (uint64_t k = 0; k < n / each; k++) {
        Gathered sum;
        memset(&sum, 0, sizeof sum);
        sampler_pixel(&t.sampler, (uint32_t)k, (uint32_t)(k >> 32));
        measure_run(l, g, &t, each, &sum);
        meter_add(m, &sum, each);
    }
    expect_parts(m);
}

Ray ray_fixed(const void *of, Sampler *s)
{
    (void)s;
    return *(const Ray *)of;
}

Ray ray_anywhere(const void *of, Sampler *s)
{
    V3 d = warp_sphere(sample_2d(s, DECISION(DECIDE_PIXEL, 0)));
    return (Ray){ .o = *(const V3 *)of, .d = d, .tmax = INFINITY };
}

Ray ray_towards(V3 eye, V3 at)
{
    return (Ray){ .o = eye, .d = v_unit(v_sub(at, eye)), .tmax = INFINITY };
}

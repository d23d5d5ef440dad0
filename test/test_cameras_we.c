/* test_cameras_we.c -- what cameras say of their rays: importance, densities, places on the
 * picture. Of each kind, with and without a lens, also where its space is stretched or moves.
 *
 * Oracles: rays that the camera makes come back to their pixels; directions are drawn from the
 * density that is stated; importance integrates to 1; what light from a lamp adds to each pixel is
 * what the pixel's own rays see of the lamp; and the circle of confusion of a thin lens. */
#include "base/random.h"
#include "sampling/warp.h"
#include "test/chi2.h"
#include "test/pictures.h"

#include <stdio.h>
#include <string.h>

typedef struct {
    const char *kind, *options;
    int space;                  /* 0: as it is; 1: turned and moved; 2: of size 2 and mirrored; 3:
                                 * stretched; 4: moves */
    uint32_t w, h;
} Shot;

static const Shot shots[] = {
    { "perspective", "fov=70", 0, 8, 8 },
    { "perspective", "fov=50,lensradius=0.3,focaldistance=2.5", 1, 12, 6 },
    { "perspective", "halffov=35,lensradius=0.1,focaldistance=4", 2, 6, 12 },
    { "perspective", "fov=60,lensradius=0.2,focaldistance=3,frameaspectratio=1.4", 3, 8, 8 },
    { "perspective", "fov=80,lensradius=0.25,focaldistance=2", 4, 8, 8 },
    { "orthographic", "", 0, 8, 8 },
    { "orthographic", "lensradius=0.5,focaldistance=2.5", 1, 12, 6 },
    { "orthographic", "", 2, 6, 12 },
    { "orthographic", "", 3, 8, 8 },
    { "orthographic", "lensradius=0.8,focaldistance=2,frameaspectratio=0.8", 4, 8, 8 },
    { "spherical", "", 1, 12, 12 },
    { "spherical", "", 3, 12, 12 },
    { "environment", "", 0, 16, 8 },
    { "environment", "", 4, 16, 8 },
};
enum { SHOTS = sizeof shots / sizeof *shots };

static Transform then(Transform a, Transform b) { return xf_then(&a, &b); }

static Transform space_of(int space)
{
    Transform turned = then(xf_translate(1, -2, 0.5), xf_rotate(40, 1, -2, 0.5));

    switch (space) {
    case 1: return turned;
    case 2: return then(turned, xf_scale(2, -2, 2));
    case 3: return then(then(turned, xf_scale(1.5, 0.8, 1.2)), xf_rotate(30, 1, 1, 1));
    case 4: return then(turned, xf_translate(0, 0, -0.2));
    default: return xf_identity();
    }
}

static const Camera *camera_of(Lab *l, const Shot *s)
{
    const CameraKind *k = kind_find(cameras, s->kind);
    Camera *c;
    Making m;
    Opts o;

    memset(&m, 0, sizeof m);
    m.scene = l->scene;
    m.to_world = space_of(s->space);
    m.moves = s->space == 4;
    m.to_world_end = then(xf_rotate(70, 1, 0, 1), then(xf_translate(1, 1, 1), m.to_world));
    opts_default(&o, k->info.options);
    REQUIRE(opts_parse(&o, s->kind, s->options, &l->arena), "%s", s->options);
    c = k->make(&m, &o);
    REQUIRE(c, "camera");
    c->kind = k;
    k->film(c, s->w, s->h);
    return c;
}

static V2 two(Rng *rng)
{
    V2 u;
    u.x = rng_unit(rng);
    u.y = rng_unit(rng);
    return u;
}

static V2 pixel_of(const Shot *s, Rng *rng)
{
    V2 u = two(rng);
    return (V2){ u.x * (float)s->w, u.y * (float)s->h };
}

static bool within(const Shot *s, V2 p)
{
    return p.x >= 0 && p.y >= 0 && p.x < (float)s->w && p.y < (float)s->h;
}

/* In pixels; by latitude and longitude, of the size that they have at the equator. */
static double apart(const Shot *s, V2 a, V2 b)
{
    double x = fabs((double)a.x - b.x), y = fabs((double)a.y - b.y);
    if (!strcmp(s->kind, "environment"))
        x = d_min(x, s->w - x) * md_sin(PI * a.y / s->h);
    return d_max(x, y);
}

/* A ray comes back to its pixel; a point on it is seen in it, through the same place of the lens;
 * and both ways say the same of it. */
static void back(void)
{
    for (int k = 0; k < SHOTS; k++) {
        const Shot *s = &shots[k];
        Rng rng = rng_seed(70 + (uint64_t)k);
        const Camera *c;
        double most = 0, beside = 0;
        Lab l;

        lab_init(&l);
        c = camera_of(&l, s);
        for (int i = 0; i < 3000; i++) {
            V2 pixel = pixel_of(s, &rng), u = two(&rng);
            float time = rng_unit(&rng);
            Ray r = c->kind->ray(c, pixel, u, time);
            V3 at = v_mad(r.d, 0.5f + 9.0f * rng_unit(&rng), r.o);
            CameraView v;
            CameraSample way;
            REQUIRE(c->kind->view(c, &r, &v), "%d: its own ray is not seen", k);
            REQUIRE(c->kind->sample(c, at, u, time, &way), "%d: no way back", k);
            most = d_max(most, apart(s, v.pixel, pixel));
            beside = d_max(beside, apart(s, way.pixel, pixel));
            EXPECT(v_len(v_add(way.wi, r.d)) < 2e-5f && v_len(v_sub(way.p, r.o)) < 4e-5f,
                   "%d: another way back", k);
            EXPECT(fabsf(way.we / v.we - 1) < 2e-4f, "%d: importance %g and %g", k, (double)way.we,
                   (double)v.we);
            EXPECT(fabsf(way.dist - v_len(v_sub(way.p, at))) < 1e-5f * way.dist, "%d: dist", k);
        }
        printf("%s %s: %g and %g pixels off\n", s->kind, s->options, most, beside);
        EXPECT(most < 5e-5 && beside < 5e-5, "%d: %g and %g pixels off", k, most, beside);
        lab_clear(&l);
    }
}

/* ---- densities of directions ---- */

typedef struct { const Shot *shot; const Camera *camera; V2 lens, pixel; } Looking;

/* The place stays: that of the lens, or where all directions come from the lens, of the pixel. */
static Ray looking_ray(const Looking *k, Rng *rng)
{
    V2 u = rng ? two(rng) : (V2){ 0, 0 };
    V2 pixel = { u.x * (float)k->shot->w, u.y * (float)k->shot->h };
    bool by_lens = !strcmp(k->shot->kind, "orthographic");

    return k->camera->kind->ray(k->camera, by_lens ? k->pixel : pixel, by_lens ? u : k->lens, 0.3f);
}

static bool draw(const void *of, Rng *rng, V3 *w)
{
    *w = looking_ray(of, rng).d;
    return true;
}

static double pdf(const void *of, V3 w)
{
    const Looking *k = of;
    Ray r = { .o = { 0, 0, 0 }, .d = w, .tmax = INFINITY, .time = 0.3f };
    CameraView v;

    if (strcmp(k->shot->kind, "orthographic"))
        r.o = looking_ray(k, NULL).o;
    if (!k->camera->kind->view(k->camera, &r, &v))
        return 0;
    return within(k->shot, v.pixel) || !strcmp(k->shot->kind, "orthographic") ? v.pdf_w : 0;
}

/* The edge of what is seen cuts bins; what that costs the integral, `integral` makes good. */
static void directions(void)
{
    for (int k = 0; k < SHOTS; k++) {
        Looking at = { &shots[k], NULL, { 0.8f, 0.3f }, { 2.5f, 1.5f } };
        Chi2 test = { .draw = draw, .pdf = pdf, .of = &at, .draws = 60000, .seed = 3, .rows = 32,
                      .cols = 64, .halvings = 2 };
        Lab l;

        lab_init(&l);
        at.camera = camera_of(&l, at.shot);
        if (!at.camera->parallel) {
            Chi2Result is = chi2_run(&test);
            EXPECT(is.p_fine > CHI2_P_MIN && is.p_coarse > CHI2_P_MIN && !is.astray &&
                       fabs(is.integral - 1) < 2e-3,
                   "%d: p %g and %g, %d astray, integral %g", k, is.p_fine, is.p_coarse,
                   (int)is.astray, is.integral);
        }
        lab_clear(&l);
    }
}

/* ---- importance ---- */

/* The area in the world of a unit square of the plane z = 0 of the camera, at time 0.3. */
static double unit_area(const Camera *c, Affine *to_world)
{
    Affine back;
    V3 n;

    *to_world = c->to_world;
    if (c->motion)
        motion_at(c->motion, 0.3f, to_world, &back);
    n = v_cross(affine_vector(to_world, v3(1, 0, 0)), affine_vector(to_world, v3(0, 1, 0)));
    return v_len(n);
}

/* The integral of We |cos| over places and directions, by chance in both; the lens and the plane
 * are known here from their definitions. */
static void integral(void)
{
    enum { N = 400000 };
    static const double lens[SHOTS] = { 0, 0.3, 0.1, 0.2, 0.25 };

    for (int k = 0; k < SHOTS; k++) {
        const Shot *s = &shots[k];
        Rng rng = rng_seed(7);
        double sum = 0, sum2 = 0, mean, sigma, area;
        bool ortho = !strcmp(s->kind, "orthographic");
        const Camera *c;
        Affine to_world;
        V3 n;
        Lab l;

        lab_init(&l);
        c = camera_of(&l, s);
        area = unit_area(c, &to_world);
        n = v_unit(v_cross(affine_vector(&to_world, v3(1, 0, 0)),
                           affine_vector(&to_world, v3(0, 1, 0))));
        area *= ortho ? 36 : lens[k] > 0 ? PI * lens[k] * lens[k] : 1 / area;
        for (int i = 0; i < N; i++) {
            V2 q = two(&rng);
            Ray r = { .d = v_unit(warp_sphere(two(&rng))), .tmax = INFINITY, .time = 0.3f };
            double value = 4 * PI * area;
            CameraView v;
            if (ortho)
                q = (V2){ 6 * q.x - 3, 6 * q.y - 3 };
            else {
                q = warp_disk_concentric(q);
                q = (V2){ q.x * (float)lens[k], q.y * (float)lens[k] };
            }
            r.o = affine_point(&to_world, v3(q.x, q.y, 0));
            if (c->parallel) {
                r.d = v_unit(affine_vector(&to_world, v3(0, 0, 1)));
                value = area;
            }
            if (!c->kind->view(c, &r, &v) || !within(s, v.pixel))
                continue;
            if (!c->point || !strcmp(s->kind, "perspective"))
                value *= v_absdot(r.d, n);
            value *= v.we;
            sum += value;
            sum2 += value * value;
        }
        mean = sum / N;
        sigma = sqrt((sum2 / N - mean * mean) / N);
        printf("%s %s: %g +- %g\n", s->kind, s->options, mean, sigma);
        EXPECT(fabs(mean - 1) < 5 * sigma + 1e-4 && sigma < 0.05, "%d: importance integrates to %g",
               k, mean);
        lab_clear(&l);
    }
}

/* ---- light into pixels ---- */

/* A lamp: a disc before the camera, of radiance 1 on both sides. */
typedef struct { V3 centre, n; Frame frame; float radius; } Lamp;

static Lamp lamp_before(const Shot *s, const Camera *c)
{
    Ray r = c->kind->ray(c, (V2){ 0.6f * (float)s->w, 0.45f * (float)s->h }, (V2){ 0.5f, 0.5f },
                         0.3f);
    Lamp l;

    l.centre = v_mad(r.d, 2.2f, r.o);
    l.n = v_unit(v_add(r.d, v3(0.3f, 0.1f, -0.2f)));
    l.frame = frame_about(l.n);
    l.radius = 0.7f;
    return l;
}

static bool meets(const Lamp *l, const Ray *r)
{
    float t = v_dot(v_sub(l->centre, r->o), l->n) / v_dot(r->d, l->n);
    V3 at = v_sub(v_mad(r->d, t, r->o), l->centre);
    return t > 0 && v_dot(at, at) < l->radius * l->radius;
}

/* Each pixel by light that starts on the lamp, and by its own rays: the same, to their noise. */
static void expect_same_light(const Shot *s, const Camera *c, int number)
{
    enum { PIXELS = 144, PATHS = 300000, RAYS = 2000 };
    double sum[PIXELS] = { 0 }, sum2[PIXELS] = { 0 }, chi2 = 0, seen = 0, given = 0;
    uint32_t n = s->w * s->h, lit = 0;
    Lamp l = lamp_before(s, c);
    Rng rng = rng_seed(12);

    for (int i = 0; i < PATHS; i++) {
        V2 q = warp_disk_concentric(two(&rng));
        V3 at = v_mad(l.frame.s, q.x * l.radius, v_mad(l.frame.t, q.y * l.radius, l.centre));
        CameraSample way;
        if (c->kind->sample(c, at, two(&rng), 0.3f, &way) && within(s, way.pixel)) {
            uint32_t k = (uint32_t)way.pixel.y * s->w + (uint32_t)way.pixel.x;
            double v = PI * l.radius * l.radius * v_absdot(way.wi, l.n) * way.we / way.pdf_w * n;
            sum[k] += v;
            sum2[k] += v * v;
        }
    }
    for (uint32_t k = 0; k < n; k++) {
        double given_here = sum[k] / PATHS, hits = 0, p, var;
        for (int i = 0; i < RAYS; i++) {
            V2 u = two(&rng), pixel = { (float)(k % s->w) + u.x, (float)(k / s->w) + u.y };
            Ray r = c->kind->ray(c, pixel, two(&rng), 0.3f);
            hits += meets(&l, &r);
        }
        p = hits / RAYS;
        var = (p + 1.0 / RAYS) * (1 - p + 1.0 / RAYS) / RAYS +
              (sum2[k] / PATHS - given_here * given_here) / PATHS;
        seen += p / n;
        given += given_here / n;
        if (p > 0.02 && p < 0.999) {
            chi2 += (given_here - p) * (given_here - p) / var;
            lit++;
        }
        EXPECT(fabs(given_here - p) < 5 * sqrt(var) + 1e-4, "%d, pixel %d: %g given, %g seen",
               number, (int)k, given_here, p);
    }
    printf("%s %s: %g seen, %g given, chi2 %g of %d\n", s->kind, s->options, seen, given, chi2,
           (int)lit);
    EXPECT(lit >= 4 && chi2_tail(chi2, lit) > CHI2_P_MIN, "%d: chi2 %g of %d pixels", number, chi2,
           (int)lit);
}

static void light(void)
{
    for (int k = 0; k < SHOTS; k++) {
        Lab l;
        lab_init(&l);
        expect_same_light(&shots[k], camera_of(&l, &shots[k]), k);
        lab_clear(&l);
    }
}

/* ---- the circle of confusion ---- */

/* A point at distance z is seen on a disc about the place where a pinhole would see it, evenly, of
 * radius R |focus - z| / (focus z) on the plane at distance 1: by similar triangles, of the lens
 * seen from the point, cut by the plane in focus, and of that disc seen from the middle of the
 * lens. The rays of those pixels through those places of the lens meet the point. */
static void confusion(void)
{
    enum { N = 20000, BINS = 16 };
    static const float depth[] = { 1.0f, 2.0f, 2.5f, 4.0f, 40.0f };
    const Shot s = { "perspective", "fov=50,lensradius=0.3,focaldistance=2.5", 0, 200, 200 };
    const Shot small = { "perspective", "fov=50", 0, 200, 200 };
    const double scale = 100 * md_cos(25 * PI / 180) / md_sin(25 * PI / 180);   /* pixels of 1 */
    const Camera *c, *pinhole;
    Lab l;

    lab_init(&l);
    c = camera_of(&l, &s);
    pinhole = camera_of(&l, &small);
    for (size_t k = 0; k < sizeof depth / sizeof *depth; k++) {
        V3 p = v3(0.1f * depth[k], -0.2f * depth[k], depth[k]);
        double want = scale * 0.3 * fabs(2.5 - depth[k]) / (2.5 * depth[k]), most = 0, missed = 0;
        uint64_t count[BINS] = { 0 };
        double expected[BINS];
        Rng rng = rng_seed(20);
        CameraSample middle, way;
        REQUIRE(pinhole->kind->sample(pinhole, p, (V2){ 0, 0 }, 0, &middle), "middle");
        for (int i = 0; i < N; i++) {
            V2 u = two(&rng);
            double x, y, r2;
            Ray r;
            V3 to;
            REQUIRE(c->kind->sample(c, p, u, 0, &way), "a way");
            x = (double)way.pixel.x - middle.pixel.x;
            y = (double)way.pixel.y - middle.pixel.y;
            most = d_max(most, sqrt(x * x + y * y));
            r2 = want > 0 ? (x * x + y * y) / (want * want) : 0;
            count[r2 < 1 ? (int)(r2 * BINS) : BINS - 1]++;
            r = c->kind->ray(c, way.pixel, u, 0);
            to = v_sub(p, r.o);
            missed = d_max(missed, v_len(v_cross(to, r.d)));
        }
        for (int i = 0; i < BINS; i++)
            expected[i] = (double)N / BINS;
        EXPECT(most <= want + 1e-3 && most > 0.99 * want, "at %g: radius %g pixels, not %g",
               (double)depth[k], most, want);
        EXPECT(want == 0 || chi2_counts(expected, count, BINS) > CHI2_P_MIN, "at %g: not even",
               (double)depth[k]);
        EXPECT(missed < 2e-6 * (double)depth[k] + 2e-6, "at %g: rays miss by %g", (double)depth[k],
               missed);
    }
    lab_clear(&l);
}

/* ---- places known by heart ---- */

static void known(void)
{
    static const struct { const char *kind; float x, y; V3 d; } known[] = {
        { "environment", 0.0f, 0.5f, { 1, 0, 0 } },   { "environment", 0.25f, 0.5f, { 0, 0, 1 } },
        { "environment", 0.5f, 0.5f, { -1, 0, 0 } },  { "environment", 0.75f, 0.5f, { 0, 0, -1 } },
        { "environment", 0.3f, 0.0f, { 0, 1, 0 } },   { "environment", 0.3f, 1.0f, { 0, -1, 0 } },
        { "spherical", 0.5f, 0.5f, { 0, 1, 0 } },     { "spherical", 0.0f, 0.0f, { 0, -1, 0 } },
        { "spherical", 1.0f, 0.5f, { 1, 0, 0 } },     { "spherical", 0.5f, 1.0f, { 0, 0, 1 } },
        { "spherical", 0.0f, 0.5f, { -1, 0, 0 } },    { "spherical", 0.5f, 0.0f, { 0, 0, -1 } },
        { "orthographic", 0.3f, 0.8f, { 0, 0, 1 } },
    };

    for (size_t k = 0; k < sizeof known / sizeof *known; k++) {
        Shot s = { known[k].kind, "", 0, 10, 10 };
        const Camera *c;
        Lab l;
        Ray r;

        lab_init(&l);
        c = camera_of(&l, &s);
        r = c->kind->ray(c, (V2){ 10 * known[k].x, 10 * known[k].y }, (V2){ 0, 0 }, 0);
        EXPECT(v_len(v_sub(r.d, known[k].d)) < 1e-6f, "%s %g %g looks along %g %g %g",
               known[k].kind, (double)known[k].x, (double)known[k].y, (double)r.d.x,
               (double)r.d.y, (double)r.d.z);
        if (!strcmp(s.kind, "orthographic"))
            EXPECT(v_len(v_sub(r.o, v3(-0.4f, -0.6f, 0))) < 1e-6f, "starts at %g %g %g",
                   (double)r.o.x, (double)r.o.y, (double)r.o.z);
        lab_clear(&l);
    }
}

const TestCase test_cameras_we[] = {
    { "back", back, false },         { "directions", directions, false },
    { "integral", integral, false }, { "light", light, false },
    { "confusion", confusion, false }, { "known", known, false },
    { NULL, NULL, false }
};

/* test_swarm.c -- sample swarming: what a guide draws has the densities that it states; pictures
 * have the mean of those by path tracing, with every subset of maps; and do not depend on
 * threads. */
#include "base/mem.h"
#include "integrators/guide.h"
#include "test/chi2.h"
#include "test/pictures.h"
#include "test/scene_help.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- scenes ---- */

static Rgb cloudy(V3 w)
{
    float c = f_max(0, 0.58f * w.x - 0.58f * w.y + 0.58f * w.z), bright = f_sqr(f_sqr(c));
    return rgb_scale(rgb(0.5f, 0.7f, 1), w.z > 0 ? 0.5f + 3 * bright : 0.05f);
}

/* A lens, a sky with a picture, two lamps, a ball of glass, a glossy one. */
static void add_room(Lab *l)
{
    uint32_t black = lab_material(l, "diffuse", "reflectance=0");

    lab_quad(l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0),
             lab_material(l, "phong", "reflectance=0.4/0.3/0.2,specular=0.4,exponent=20"));
    lab_sphere(l, v3(0.8f, -0.4f, 0.61f), 0.6f, lab_material(l, "dielectric", ""), false);
    lab_sphere(l, v3(-0.7f, 0, 0.6f), 0.6f, lab_material(l, "conductor", "roughness=0.3"), false);
    lab_quad(l, v3(-1.2f, -1.6f, 0.1f), v3(0.8f, 0, 0), v3(0, 0.1f, 0.7f),
             lab_material(l, "coateddiffuse", "roughness=0"));
    lab_sky(l, 32, 16, cloudy, NULL);
    lab_shine(l, lab_quad(l, v3(-2, -1.5f, 2.2f), v3(0, 1, 0), v3(1, 0, 0.5f), black), "L=8/8/6");
    lab_shine(l, lab_sphere(l, v3(1.6f, 0.6f, 1.9f), 0.4f, black, false), "L=4/6/8");
    lab_camera(l, v3(0, -4, 2), v3(0, 0, 0.4f), 45, "lensradius=0.2,focaldistance=4");
}

/* Light beyond what the eye sees, spots and a lamp. */
static void add_fog(Lab *l)
{
    uint32_t black = lab_material(l, "diffuse", "reflectance=0"), fog;
    Medium air = { "air", { 0.05f, 0.1f, 0.1f }, { 0.16f, 0.16f, 0.12f }, 0.4f };

    REQUIRE(scene_add_medium(l->scene, &air, &fog), "memory");
    l->scene->around = fog;
    lab_quad(l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0), lab_material(l, "diffuse", ""));
    lab_sphere(l, v3(-0.4f, -0.5f, 0.5f), 0.5f, lab_material(l, "dielectric", "roughness=0.2"),
               false);
    for (int i = 0; i < 4; i++)
        lab_shine(l, lab_quad(l, v3((float)i - 2, 0.3f * (float)(i % 3) - 0.4f, 3.4f),
                              v3(0, 0.5f, 0), v3(0.5f, 0, 0), black), i ? "L=3/2/1" : "L=30/20/20");
    lab_light(l, "spot", "from=0/-1/7,to=0/0/0,coneangle=12,conedeltaangle=5,I=30", NULL);
    lab_camera(l, v3(0, -4, 2), v3(0, 0, 0.4f), 45, "");
}

/* Things in motion, one of which is bright; a pane that fades. */
static const char MOVING[] =
    "LookAt 0 -4 1.5  0 0 0.5  0 0 1\nCamera \"perspective\" \"float fov\" 45\nWorldBegin\n"
    "LightSource \"infinite\" \"rgb L\" [ 0.2 0.2 0.3 ]\n"
    "LightSource \"distant\" \"point3 from\" [ 1 -1 3 ] \"rgb L\" [ 0.5 0.4 0.3 ]\n"
    "Shape \"bilinearmesh\" \"point3 P\" [ -3 -3 0  3 -3 0  -3 3 0  3 3 0 ]\n"
    "AttributeBegin\nMaterial \"thindielectric\"\n"
    "Shape \"bilinearmesh\" \"point3 P\" [ -1 -1 0.1  1 -1 0.1  -1 -0.8 1  1 -0.8 1 ]\n"
    "AttributeEnd\n"
    "AttributeBegin\nTranslate -1.5 0 0.5\nActiveTransform EndTime\nTranslate 3 0 0.5\n"
    "ActiveTransform All\nMaterial \"diffuse\" \"rgb reflectance\" [ 0.9 0.5 0.2 ]\n"
    "Shape \"sphere\" \"float radius\" 0.3\nAttributeEnd\n"
    "AttributeBegin\nAreaLightSource \"diffuse\" \"rgb L\" [ 6 6 6 ]\nTranslate 1 1 1.4\n"
    "Shape \"sphere\" \"float radius\" 0.2\nAttributeEnd\n";

/* ---- a guide by itself ---- */

typedef struct {
    Lab     lab;
    GuidePlan plan;
    Guide  *guide;              /* owned */
    float  *maps;               /* owned */
    Tracer  tracer;
    Vertex  v;
    LightSampler *lights;
} Lesson;

static const int ALL[GUIDE_KINDS] = { 64, 32, 16, 64, 256, 32, 32 };

/* A guide whose maps have been made by rule, at the vertex that the ray meets. */
static void lesson_init(Lesson *n, void (*add)(Lab *l), V3 eye, V3 at)
{
    uint32_t spp = 0;
    Opts none;
    Ray r = ray_towards(eye, at);
    Beam b;
    Rng rng = rng_seed(1);

    memset(n, 0, sizeof *n);
    lab_init(&n->lab);
    add(&n->lab);
    lab_build(&n->lab);
    guide_plan(&n->plan, n->lab.scene, ALL, 1, 0.5f, false);
    n->guide = guide_new(&n->plan);
    n->maps = MEM_ARRAY(float, n->plan.floats);
    n->lights = lightsampler_open("power", n->lab.scene);
    opts_default(&none, kind_info(samplers, 0)->options);
    n->tracer.scene = n->lab.scene;
    REQUIRE(n->guide && n->maps && n->lights &&
            sampler_init(&n->tracer.sampler, kind_find(samplers, "random"), &none, 7, &spp),
            "open");
    guide_forget(&n->plan, n->maps);
    for (int m = 0; m < GUIDE_MAPS; m++) {
        int cells = learned_cells(n->plan.shape[m]);
        float *mass = n->maps + n->plan.at[m];
        for (int i = 0; i < cells && m != GUIDE_BIFURCATION; i++)
            mass[i] = rng_unit(&rng) < 0.2f ? 9 * rng_unit(&rng) : 0.01f;
        for (int k = 0; cells && k < GUIDE_LEVELS; k++)
            mass[cells + k] = 1.0f / (float)(1 + k);    /* the more of the map the better */
    }
    REQUIRE(vertex_meet(&n->v, &r, &n->tracer), "a vertex");
    guide_pixel(n->guide, &n->tracer, n->maps, 0, 0);
    sampler_start(&n->tracer.sampler, 0);
    b = beam_from_eye(&r, n->lab.scene);
    guide_starts(n->guide, &b);
    guide_turns(n->guide, &b, true);
}

static void lesson_clear(Lesson *n)
{
    guide_learns(n->guide, &n->tracer);
    guide_free(n->guide);
    mem_free(n->maps);
    lightsampler_close(n->lights);
    lab_clear(&n->lab);
}

static Lesson lesson;                   /* which draw() changes */
static uint32_t lesson_index;

/* Above the surface alone: what a map proposes below it is refused. */
static double density(const void *of, V3 w)
{
    V3 local;

    (void)of;
    if (!vertex_local(&lesson.v, w, &local) || local.z <= 0)
        return 0;
    return (double)guide_pdf_w(lesson.guide, w, vertex_pdf_w(&lesson.v, local));
}

static bool draw(const void *of, Rng *rng, V3 *w)
{
    Beam b = beam_from_eye(&(Ray){ .d = { 0, 0, -1 } }, lesson.lab.scene);
    BsdfSample s;

    (void)of, (void)rng;
    sampler_start(&lesson.tracer.sampler, ++lesson_index);
    guide_turns(lesson.guide, &b, true);
    if (!guide_scatters(lesson.guide, &lesson.v, &lesson.tracer, &b, &s))
        return false;
    *w = s.wi;
    EXPECT(fabsf(s.pdf_w - (float)density(NULL, s.wi)) <= 1e-4f * s.pdf_w,
           "a draw says %.9g, the density %.9g", (double)s.pdf_w, density(NULL, s.wi));
    return true;
}

/* A direction that the map and the surface can both give has the sum of their densities. */
static void directions(void)
{
    lesson_init(&lesson, add_room, v3(0.1f, -1.5f, 2), v3(0, -1.4f, 0));
    chi2_expect(&(Chi2){ draw, density, NULL, .draws = 200000, .halvings = 2, .rows = 32,
                         .cols = 64 }, "directions by a map");
    lesson_clear(&lesson);
}

/* What is reflected of a uniform sky, with a guide and without: a mirror's coat over matt paint, of
 * which the guide takes neither anything away nor too much. */
static void coat(void)
{
    Stat with = { 0, 0, 0, 0, 0 }, without = with;
    uint32_t n = test_is_long() ? 1600000 : 100000;

    lesson_init(&lesson, add_room, v3(-0.8f, -4, 0.4f), v3(-0.8f, -1.55f, 0.4f));
    REQUIRE(lesson.v.b->flags & BSDF_SPECULAR && vertex_is_smooth(&lesson.v), "coated");
    for (uint32_t i = 0; i < n; i++) {
        Beam b = beam_from_eye(&(Ray){ .d = { 0, 0, -1 } }, lesson.lab.scene);
        BsdfSample s;
        sampler_start(&lesson.tracer.sampler, i);
        guide_turns(lesson.guide, &b, true);
        stat_add(&with, guide_scatters(lesson.guide, &lesson.v, &lesson.tracer, &b, &s)
                            ? (double)rgb_lum(s.weight) : 0);
        sampler_start(&lesson.tracer.sampler, i + n);
        stat_add(&without, vertex_sample(&lesson.v, &lesson.tracer, 0, &s)
                               ? (double)rgb_lum(s.weight) : 0);
    }
    stat_expect_same(&with, &without, 0.05, "coated");
    lesson_clear(&lesson);
}

/* Scenes have maps of what there is to decide in them, and no others. */
static void plans(void)
{
    static const char *const light[][2] = { { "point", "I=1" }, { "distant", "L=1" },
                                            { "infinite", "L=1" } };

    for (int n = 1; n <= 4; n++) {      /* lights; and in the end glass */
        GuidePlan plan;
        Lab l;
        lab_init(&l);
        for (int i = 0; i < n && i < 3; i++)
            lab_light(&l, light[i][0], light[i][1], NULL);
        lab_sphere(&l, v_all(0), 1, lab_material(&l, n > 3 ? "dielectric" : "diffuse", ""), false);
        lab_camera(&l, v3(0, -4, 0), v_all(0), 45, "");
        lab_build(&l);
        guide_plan(&plan, l.scene, ALL, 1, 0.5f, false);
        for (int k = 0; k < GUIDE_KINDS; k++) {
            bool of_use = k == GUIDE_DIRECTION || (k == GUIDE_BIFURCATION && n > 3) ||
                          (k == GUIDE_LIGHT && n > 1) || (k == GUIDE_POINT && n > 2);
            EXPECT((plan.shape[guide_map((GuideKind)k, 0)].w > 0) == of_use,
                   "%d lights: a map of %s", n, guide_names[k]);
        }
        lab_clear(&l);
    }
}

/* What a direction has brought is learned where it went, also by a map that knows nothing yet and
 * is left alone. */
static void ways(void)
{
    int m = guide_map(GUIDE_DIRECTION, 0), tried = 0;
    double pi = acos(-1.0);

    lesson_init(&lesson, add_room, v3(0.1f, -1.5f, 2), v3(0, -1.4f, 0));
    for (uint32_t i = 0; i < 200; i++) {
        LearnedShape shape = lesson.plan.shape[m];
        float *mass = lesson.maps + lesson.plan.at[m];
        Beam b = beam_from_eye(&(Ray){ .d = { 0, 0, -1 } }, lesson.lab.scene);
        double all = 0, near = 0, most = 0;     /* of the map, three rows, a cell of its row */
        BsdfSample s;
        int x, y;

        guide_learns(lesson.guide, &lesson.tracer);
        guide_forget(&lesson.plan, lesson.maps);
        guide_pixel(lesson.guide, &lesson.tracer, lesson.maps, 0, 0);
        sampler_start(&lesson.tracer.sampler, i);
        guide_turns(lesson.guide, &b, true);
        if (!guide_scatters(lesson.guide, &lesson.v, &lesson.tracer, &b, &s))
            continue;
        guide_leaves(lesson.guide, rgb_all(0));
        guide_ends(lesson.guide, rgb_all(1));
        guide_learns(lesson.guide, &lesson.tracer);
        x = (int)((1 + atan2((double)s.wi.y, (double)s.wi.x) / (2 * pi)) * shape.w) % shape.w;
        y = (int)(acos((double)s.wi.z) / pi * shape.h);
        for (int k = 0; k < learned_cells(shape); k++) {
            all += (double)mass[k];
            near += abs(k / shape.w - y) <= 1 ? (double)mass[k] : 0;
            if (k / shape.w == y && (double)mass[k] > most)
                most = (double)mass[k];
        }
        EXPECT((double)mass[y * shape.w + x] > 0.99 * most && near > 0.99 * all,
               "%g %g %g: %g in its cell, %g in another, %g near, %g in all", (double)s.wi.x,
               (double)s.wi.y, (double)s.wi.z, (double)mass[y * shape.w + x], most, near, all);
        tried++;
    }
    EXPECT(tried > 100, "%d directions", tried);
    lesson_clear(&lesson);
}

static void choices(void)
{
    enum { DRAWS = 100000, MOST = 8 };
    Lesson n;
    V3 p, up;
    double expected[MOST], sum = 0, chance;
    uint64_t count[MOST] = { 0 };

    lesson_init(&n, add_fog, v3(0.1f, -1.5f, 2), v3(0.8f, -1.4f, 0));
    p = n.v.s.p;
    up = vertex_up(&n.v);
    for (int i = 0; i < DRAWS; i++) {
        float u = ((float)i + 0.5f) / DRAWS, pmf;
        const Light *l = guide_light(n.guide, n.lights, p, up, u, &pmf);
        REQUIRE(l, "a light");
        count[l->index]++;
        EXPECT(pmf == guide_light_pmf(n.guide, n.lights, p, up, l), "pmf %.9g", (double)pmf);
    }
    for (size_t i = 0; i < n.lab.scene->nlights; i++) {
        expected[i] = DRAWS * (double)guide_light_pmf(n.guide, n.lights, p, up,
                                                      n.lab.scene->lights[i]);
        sum += expected[i] / DRAWS;
        EXPECT(fabs(expected[i] - (double)count[i]) <= 3, "light %d: %g of %g", (int)i,
               (double)count[i], expected[i]);
    }
    chance = chi2_counts(expected, count, n.lab.scene->nlights);
    EXPECT(chance >= CHI2_P_MIN && fabs(sum - 1) < 1e-5, "p = %g, sum %g", chance, sum);
    lesson_clear(&n);
}

/* The numbers that a sky gives for a direction are those that gave it. */
static void sky_numbers(void)
{
    Lab l;
    const Light *sky;
    Rng r = rng_seed(4);

    lab_init(&l);
    add_room(&l);
    lab_build(&l);
    sky = l.scene->infinite[0];
    for (int i = 0; i < 20000; i++) {
        V2 u = { rng_unit(&r), rng_unit(&r) }, back;
        bool beside = i & 1;
        LightSample s;
        if (!light_sample(sky, beside, v_all(0), u, &s))
            continue;
        REQUIRE(sky->kind->numbers(sky, beside, s.wi, &back), "numbers");
        EXPECT(fabsf(u.x - back.x) < 2e-4f && fabsf(u.y - back.y) < 2e-4f,
               "%.9g %.9g gives %.9g %.9g", (double)u.x, (double)u.y, (double)back.x,
               (double)back.y);
    }
    lab_clear(&l);
}

/* ---- pictures ---- */

typedef struct { const char *method; double delta; } Way;

static void compare(Lab *l, const char *truth, uint32_t spp, const Way *ways, size_t n)
{
    Series path, swarm;

    series_render(l, &path, truth, 32, spp, 1);
    for (size_t i = 0; i < n; i++) {
        series_render(l, &swarm, ways[i].method, 32, 4, 2 + i);
        series_expect_same(&swarm, &path, ways[i].delta, ways[i].method);
        series_clear(&swarm);
    }
    series_clear(&path);
}

static void room(void)
{
    static const Way ways[] = {
        { "swarm:band=1,maxdepth=4", 0.1 },
        { "swarm:maxdepth=4,bounces=3,passes=2,band=1,share=0.8@random", 0.12 },
        { "swarm:maxdepth=4,strategy=explicit,coin=true,light=2,lightsampler=uniform", 0.2 },
        { "swarm:maxdepth=4,sky=all,roulette=1,heuristic=balance,point=7,lens=5,direction=9",
          0.08 },
    };
    Lab l;

    lab_init(&l);
    add_room(&l);
    lab_build(&l);
    compare(&l, "path:maxdepth=4", 16, ways, sizeof ways / sizeof *ways);
    lab_clear(&l);
}

static void fog(void)
{
    static const Way ways[] = {
        { "swarm:band=1,maxdepth=3,bounces=2", 0.15 },
        { "swarm:maxdepth=3,direction=0,light=3", 0.15 },
    };
    static const Way direct = { "swarm:over=direct,maxdepth=3,band=1", 0.15 };
    Lab l;

    lab_init(&l);
    add_fog(&l);
    lab_build(&l);
    compare(&l, "path:maxdepth=3", 16, ways, sizeof ways / sizeof *ways);
    compare(&l, "direct:maxdepth=3", 8, &direct, 1);
    lab_clear(&l);
}

static void motion(void)
{
    static const Way ways[] = {
        { "swarm:maxdepth=5,band=1", 0.06 },
        { "swarm:maxdepth=5,strategy=implicit,passes=3,lightsampler=power", 0.3 },
    };
    SceneFile f = scene_of(MOVING, 0);
    Lab l;

    memset(&l, 0, sizeof l);
    l.scene = f.scene;
    lab_build(&l);
    compare(&l, "path:maxdepth=5", 16, ways, 1);
    compare(&l, "path:maxdepth=5,strategy=implicit", 64, ways + 1, 1);
    l.scene = NULL;
    lab_clear(&l);
    scenefile_clear(&f);
}

/* A lamp far out of focus: of each pixel, a small part of the lens sees it. */
static void blurred(void)
{
    static const Way direct = { "swarm:over=direct,band=1", 0.2 };
    Lab l;

    lab_init(&l);
    lab_shine(&l, lab_quad(&l, v3(-0.3f, 0, -0.3f), v3(0.6f, 0, 0), v3(0, 0, 0.6f),
                           lab_material(&l, "diffuse", "reflectance=0")), "L=20/20/20");
    lab_camera(&l, v3(0, -4, 0), v3(0, 0, 0), 45, "lensradius=0.5,focaldistance=2");
    lab_build(&l);
    compare(&l, "direct", 16, &direct, 1);
    lab_clear(&l);
}

/* What a band or a pass begins with does not depend on who did what when. */
static void threads(void)
{
    static const char *const methods[] = { "swarm:band=1", "swarm:band=2,passes=3" };
    Lab l;

    lab_init(&l);
    add_room(&l);
    lab_build(&l);
    for (int k = 0; k < 2; k++) {
        RenderSettings s;
        RenderReport report;
        Film one, many;
        picture_settings(&l, &s, methods[k], 40, 72, 5);
        s.crop[0] = 3;
        s.crop[1] = 5;
        picture_render(&l, &s, &one, &report);
        s.threads = 5;
        picture_render(&l, &s, &many, &report);
        EXPECT(films_equal(&one, &many), "%s: threads matter", methods[k]);
        film_clear(&one);
        film_clear(&many);
    }
    lab_clear(&l);
}

const TestCase test_swarm[] = {
    { "directions", directions, false },
    { "coat", coat, false },
    { "plans", plans, false },
    { "ways", ways, false },
    { "choices", choices, false },
    { "sky_numbers", sky_numbers, false },
    { "room", room, false },
    { "fog", fog, false },
    { "motion", motion, false },
    { "blurred", blurred, false },
    { "threads", threads, false },
    { NULL, NULL, false }
};

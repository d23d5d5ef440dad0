/* test_progressive.c -- ppm and sppm: what their passes add up to, and how what is wrong falls.
 *
 * Radius      A flat mirror shows the floor a lamp of known place: the light within a disc about
 *             the foot of it is known, so is what each pass brings, by the radius that theory
 *             says it has (where photons are spread evenly R_n^2 = R_1^2 product (i - 1 + alpha)
 *             / i over i < n). Passes must bring that, and what is wrong must fall as
 *             n^(alpha - 1).
 * Furnace     In a sphere that shines alike everywhere every sum is known. A sphere's area within
 *             a distance R is pi R^2, so a large radius is wrong only where it turns so far that
 *             photons come from below the horizon of where they are gathered.
 * Truth       Small radii against `path`, in every light, through lenses, in motion, through glass;
 *             and against `light` where lamps have no size, which paths of the eye cannot find
 *             behind glass.
 * Input       Radii beyond the scene, no lamps, particles that nothing takes. */
#include "base/mem.h"
#include "test/lamp_help.h"

#include <stdio.h>
#include <string.h>

/* ---- theory ---- */

/* A spot looks up from height 1 at a mirror at height 2, and the floor sees it there, at 3. */
static const double HEIGHT = 3, RADIUS = 1.5;

static void add_virtual_lamp(Lab *l)
{
    lab_quad(l, v3(-8, -8, 0), v3(16, 0, 0), v3(0, 16, 0),
             lab_material(l, "diffuse", "reflectance=0.5"));
    lab_quad(l, v3(-8, -8, 2), v3(0, 16, 0), v3(16, 0, 0), lab_material(l, "mirror",
                                                                      "reflectance=1"));
    lab_light(l, "spot", "from=0/0/1,to=0/0/2,I=10,coneangle=50,conedeltaangle=1", NULL);
    lab_camera(l, v3(0.4f, 0, 1), v3(0, 0, 0), 0.01f, "");
    lab_build(l);
}

/* Mean over a disc of radius R of the irradiance by a lamp of 1 W/sr, over that in the middle. */
static double within_disc(double R2)
{
    double h2 = HEIGHT * HEIGHT;

    return 2 * h2 * (1 - 1 / sqrt(1 + R2 / h2)) / R2;
}

/* What the mean of n passes is, over the truth; with photons as they are expected, in units of
 * those that a disc of area 1 would get in the middle. */
static double after(int n, double alpha)
{
    double R2 = RADIUS * RADIUS, sum = 0, N = 0;

    for (int i = 1; i <= n; i++) {
        double M = R2 * within_disc(R2);
        sum += within_disc(R2);
        R2 *= (N + alpha * M) / (N + M);
        N += alpha * M;
    }
    return sum / n;
}

/* The mean luminance of the picture by so many passes. */
static Stat mean_of(Lab *l, const char *method, uint32_t passes, int runs)
{
    Stat st = { 0, 0, 0, 0, 0 };
    RenderReport report;
    RenderSettings s;
    Image im;

    REQUIRE(image_init(&im, 2, 2), "memory");
    picture_settings(l, &s, method, 2, 2, passes);
    for (int run = 0; run < runs; run++) {
        Film film;
        double sum = 0;
        s.seed = 77 + (uint64_t)run;
        picture_render(l, &s, &film, &report);
        film_picture(&film, 0, &im);
        for (int i = 0; i < 4; i++)
            sum += rgb_lum(im.pixels[i]) / 4;
        stat_add_block(&st, sum, 1, 0);
        film_clear(&film);
    }
    image_clear(&im);
    return st;
}

static void radius_of(const char *name, double alpha)
{
    static const uint32_t passes[] = { 1, 4, 16, 64 };
    double truth = 10 / (HEIGHT * HEIGHT) * 0.5 / PI, wrong[4], slope;
    char method[200];
    Lab l;

    lab_init(&l);
    add_virtual_lamp(&l);
    snprintf(method, sizeof method, "%s,radius=%g,alpha=%g,photons=4096,maxdepth=2", name, RADIUS,
             alpha);
    for (int k = 0; k < 4; k++) {
        Stat st = mean_of(&l, method, passes[k], k < 2 ? 16 : 8);
        stat_expect(&st, truth * after((int)passes[k], alpha), 0.05, method);
        wrong[k] = 1 - st.mean / truth;
    }
    /* -0.303 of -1/3 and -0.570 of -0.6 between 4 and 64 passes: not yet quite the asymptote */
    slope = md_log(wrong[3] / wrong[1]) / md_log(16);
    EXPECT(fabs(slope - (alpha - 1)) < 0.05, "%s: what is wrong falls by %.3f, not %.3f", method,
           slope, alpha - 1);
    lab_clear(&l);
}

static void radius(void)
{
    radius_of("sppm:k=2", 2.0 / 3);
    radius_of("sppm:k=2", 0.4);
    radius_of("ppm:samples=1", 2.0 / 3);
}

/* ---- sums ---- */

/* Light of 1 from a sphere that reflects half of it, four times: 1 + 1/2 + ... + 1/16. All passes
 * have one radius; then, by k, the first has its own for each pixel, and its bias would show. */
static void furnace(void)
{
    static const char *const ways[] = { "radius=0.2", "radius=0.3,glossy=follow,alpha=0.3",
                                        "k=30,share=1", "k=3,share=1" };
    char method[100];
    Lab l;

    lab_init(&l);
    lab_shine(&l, lab_sphere(&l, v3(0, 0, 0), 1, lab_material(&l, "diffuse", "reflectance=0.5"),
                             true), "L=1");
    lab_camera(&l, v3(0.2f, 0.1f, 0.3f), v3(1, 0, 0), 90, "");
    lab_build(&l);
    for (int i = 0; i < 8; i++) {
        Stat st;
        snprintf(method, sizeof method, "%s,maxdepth=4,%s", i < 4 ? "sppm:photons=3000" :
                 "ppm:samples=2,photons=2000", ways[i % 4]);
        if (i % 4 == 3)         /* one pass each: its radius is that of its own photons */
            snprintf(strchr(method, ':'), 90, ":maxdepth=4,photons=60,%s@random", ways[i % 4]);
        st = mean_of(&l, method, i % 4 == 3 ? 1 : 4, i % 4 == 3 ? 3000 : 32);
        stat_expect(&st, 1.9375, 0.05, method);
    }
    lab_clear(&l);
}

/* ---- against other methods ---- */

static void compare(Lab *l, const char *method, const char *truth, uint32_t passes, uint32_t spp,
                    double delta, const char *what)
{
    Series a, b;

    series_render(l, &a, method, 32, passes, 3);
    series_render(l, &b, truth, 32, spp, 4);
    series_expect_same(&a, &b, delta, what);
    series_clear(&a);
    series_clear(&b);
}

static const char SPPM[] = "sppm:radius=0.06,maxdepth=4,photons=2048";
static const char PATH[] = "path:maxdepth=4,roulette=2";

static void lamps(void)
{
    for (size_t i = 0; i < LAMPS; i++) {
        Lab l;
        lamp_scene(&l, lamp_names[i], i % 2 ? "" : "lensradius=0.1,focaldistance=6");
        compare(&l, i == 1 ? "ppm:radius=0.06,maxdepth=4,photons=2048,samples=2" : SPPM, PATH, 4, 8,
                0.08, lamp_names[i]);
        lab_clear(&l);
    }
}

/* Glossy surfaces, of which paths go on: what a rough metal and a coat show of each other. */
static void glossy(void)
{
    Lab l;

    lab_init(&l);
    lamp_add(&l, "quad");
    lamp_things(&l);
    lab_sphere(&l, v3(0, -1.5f, 0.5f), 0.5f, lab_material(&l, "conductor", "roughness=0.3"), false);
    lab_sphere(&l, v3(1, -2, 0.4f), 0.4f, lab_material(&l, "coateddiffuse", "roughness=0"), false);
    lab_camera(&l, v3(0.5f, -7, 3), v3(0, 0, 1), 45, "");
    lab_build(&l);
    compare(&l, SPPM, PATH, 6, 16, 0.06, "gathering");
    compare(&l, "sppm:radius=0.06,maxdepth=4,photons=2048,glossy=follow", PATH, 6, 16, 0.06,
            "following");
    lab_clear(&l);
}

/* A ball of glass: through it, and its caustic; by a disc and by a point, of which `path` finds no
 * caustic and `light` nothing in the glass, so only the floor is looked at. */
static void caustic(void)
{
    static const char *const truths[] = { "light:maxdepth=4,roulette=2", PATH };

    for (int large = 0; large < 2; large++) {
        Lab l;
        lab_init(&l);
        if (large) {
            lamp_glass(&l);
            lab_camera(&l, v3(2.2f, -4, 2), v3(0.6f, 0, 0.5f), 35, "");
        } else {
            lab_quad(&l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0), lab_material(&l, "diffuse", ""));
            lab_sphere(&l, v3(0, 0, 1.2f), 1, lab_material(&l, "dielectric", ""), false);
            lab_light(&l, "spot", "from=-3/0/4.5,to=0/0/1.2,I=30/20/10,coneangle=18", NULL);
            lab_camera(&l, v3(2.2f, -2.5f, 2), v3(1.6f, 0, 0), 24, "");
        }
        lab_build(&l);
        compare(&l, "sppm:radius=0.03,maxdepth=4,photons=8192", truths[large], large ? 6 : 4,
                large ? 128 : 32, 0.1, large ? "glass" : "a caustic of a point");
        lab_clear(&l);
    }
}

/* ---- the picture as a whole ---- */

static void any_scene(Lab *l)
{
    lab_init(l);
    lamp_add(l, "quad");
    lamp_add(l, "picture");
    lamp_things(l);
    lab_sphere(l, v3(0, -1.5f, 0.5f), 0.5f, lab_material(l, "dielectric", ""), false);
    lab_camera(l, v3(0.5f, -7, 3), v3(0, 0, 1), 45, "");
    lab_build(l);
}

/* Bytes do not depend on threads; parts by length and strategy add up to the picture. */
static void parts_of(Lab *l, const char *method)
{
    static const char *const names[] = { "strategy:implicit=a.pfm", "strategy:explicit=b.pfm",
                                        "strategy:merge=c.pfm", "length:1=d.pfm", "length:2=e.pfm",
                                        "length:3=f.pfm", "length:4=g.pfm", "length:5=h.pfm" };
    enum { AOVS = sizeof names / sizeof *names };
    Image part[1 + AOVS];
    RenderSettings s;
    RenderReport report;
    Film one, three;

    picture_settings(l, &s, method, 40, 24, 3);
    for (int k = 0; k < AOVS; k++)
        REQUIRE(aov_parse(&s.aovs[k], names[k]), "%s", names[k]);
    s.naovs = AOVS;
    picture_render(l, &s, &one, &report);
    s.threads = 3;
    picture_render(l, &s, &three, &report);
    EXPECT(films_equal(&one, &three), "%s: threads change the picture", method);
    for (int k = 0; k <= AOVS; k++) {
        REQUIRE(image_init(&part[k], 40, 24), "memory");
        film_picture(&one, k, &part[k]);
    }
    for (int i = 0; i < 40 * 24; i++) {
        float all = part[0].pixels[i].g, strategies = 0, lengths = 0;
        for (int k = 1; k <= AOVS; k++)
            *(k <= 3 ? &strategies : &lengths) += part[k].pixels[i].g;
        EXPECT(fabsf(all - strategies) <= 1e-5f * all && fabsf(all - lengths) <= 1e-5f * all,
               "pixel %d: %g, by strategy %g, by length %g", i, (double)all, (double)strategies,
               (double)lengths);
    }
    for (int k = 0; k <= AOVS; k++)
        image_clear(&part[k]);
    film_clear(&one);
    film_clear(&three);
}

static void parts(void)
{
    Lab l;

    any_scene(&l);
    parts_of(&l, "sppm:maxdepth=4,photons=3000");
    parts_of(&l, "sppm:maxdepth=4,radius=0.3,glossy=follow@random@gaussian");
    parts_of(&l, "ppm:maxdepth=4,samples=2");
    lab_clear(&l);
}

/* A window is that part of the whole picture, but for the order in which photons are added up. */
static void window(void)
{
    static const char *const methods[] = { "sppm:k=10", "ppm:samples=2,radius=0.4" };
    Lab l;

    any_scene(&l);
    for (int m = 0; m < 2; m++) {
        RenderSettings s;
        RenderReport report;
        Image all, part;
        Film film;
        picture_settings(&l, &s, methods[m], 40, 24, 4);
        picture_render(&l, &s, &film, &report);
        REQUIRE(image_init(&all, 40, 24) && image_init(&part, 9, 5), "memory");
        film_picture(&film, 0, &all);
        film_clear(&film);
        memcpy(s.crop, (uint32_t[4]){ 20, 11, 29, 16 }, sizeof s.crop);
        picture_render(&l, &s, &film, &report);
        film_picture(&film, 0, &part);
        film_clear(&film);
        for (uint32_t i = 0; i < 45; i++) {
            float a = image_at(&all, 20 + i % 9, 11 + i / 9)->g, b = part.pixels[i].g;
            EXPECT(fabsf(a - b) <= 1e-5f * a, "%s: pixel %u is %g, in the window %g", methods[m], i,
                   (double)a, (double)b);
        }
        image_clear(&all);
        image_clear(&part);
    }
    lab_clear(&l);
}

/* The estimate of noise: as far apart as two pictures are. */
static void error(void)
{
    RenderSettings s;
    RenderReport report;
    Image im[2];
    double squares = 0, mean = 0;
    Film film;
    Lab l;

    any_scene(&l);
    picture_settings(&l, &s, "sppm:photons=4096", 32, 32, 0);
    s.error = 0.1;
    for (int k = 0; k < 2; k++) {
        s.seed = (uint64_t)k;
        picture_render(&l, &s, &film, &report);
        EXPECT(film_error(&film) <= 0.1 && report.spp >= 4, "it ends at %g", film_error(&film));
        REQUIRE(image_init(&im[k], 32, 32), "memory");
        film_picture(&film, 0, &im[k]);
        film_clear(&film);
    }
    for (int i = 0; i < 32 * 32; i++) {
        double a = rgb_lum(im[0].pixels[i]), b = rgb_lum(im[1].pixels[i]);
        squares += (a - b) * (a - b) / 2;
        mean += (a + b) / 2;
    }
    squares = sqrt(squares * 32 * 32) / mean;
    EXPECT(squares < 0.14 && squares > 0.05, "asked for 0.1, got %g", squares);
    image_clear(&im[0]);
    image_clear(&im[1]);
    lab_clear(&l);
}

/* ---- input ---- */

static void refused(void)
{
    Medium fog = { "fog", { 0, 0, 0 }, { 1, 1, 1 }, 0 };
    unsigned before;
    Lab l;

    messages_quiet(true);
    any_scene(&l);
    EXPECT(!lab_opens(&l, "sppm:radius=100") && !lab_opens(&l, "ppm:radius=100"),
           "beyond the scene");
    EXPECT(lab_opens(&l, "sppm:radius=1"), "a radius of 1");
    before = warnings_count();
    REQUIRE(scene_add_medium(l.scene, &fog, NULL), "memory");
    EXPECT(lab_opens(&l, "sppm") && lab_opens(&l, "ppm") && warnings_count() == before + 2, "fog");
    lab_clear(&l);
}

/* Without lamps black; at maxdepth=0 the lamps alone; at 1, or where particles meet nothing again,
 * what lamps show and light at once. */
static void dark(void)
{
    for (int lamps = 0; lamps < 2; lamps++) {
        Stat st, truth;
        Lab l;
        lab_init(&l);
        if (lamps)
            lamp_add(&l, "quad");
        lab_quad(&l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0), lab_material(&l, "diffuse", ""));
        lab_camera(&l, v3(0, -7, 2), v3(0, 0, 2), 60, "");
        lab_build(&l);
        for (int depth = 0; depth < 4; depth++) {
            char method[80];
            snprintf(method, sizeof method, "sppm:photons=%d,maxdepth=%d", depth, depth);
            st = mean_of(&l, method, 64, 8);
            snprintf(method, sizeof method, "path:maxdepth=%d", depth);
            truth = mean_of(&l, method, 64, 8);
            if (lamps)
                stat_expect_same(&st, &truth, 0.6, "lamps alone");
            else
                stat_expect(&st, 0, 0.6, "no lamps");
        }
        lab_clear(&l);
    }
}

const TestCase test_progressive[] = {
    { "radius", radius, false },
    { "furnace", furnace, false },
    { "lamps", lamps, false },
    { "glossy", glossy, false },
    { "caustic", caustic, false },
    { "parts", parts, false },
    { "window", window, false },
    { "error", error, false },
    { "refused", refused, false },
    { "dark", dark, false },
    { NULL, NULL, false }
};

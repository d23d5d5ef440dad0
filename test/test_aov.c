/* test_aov.c -- the extra pictures: of scenes whose answers are known, against the picture itself,
 * and (variance) against how far renders of many seeds lie apart. */
#include "base/mem.h"
#include "base/statistics.h"
#include "image/exr.h"
#include "test/cli_help.h"
#include "test/pictures.h"

#include <math.h>
#include <string.h>

enum { SIDE = 24 };

static void ask(RenderSettings *s, const char *text)
{
    REQUIRE(aov_parse(&s->aovs[s->naovs], text), "%s", text);
    s->naovs++;
}

static Image picture_of(const RenderSettings *s, const Film *f, int k)
{
    Image im;

    REQUIRE(image_init(&im, f->w, f->h), "memory");
    if (k < 0)
        film_picture(f, 0, &im);
    else
        aov_picture(&s->aovs[k], f, k, &im);
    return im;
}

/* A floor of two triangles and a ball above it, seen from above. */
static void room(Lab *l)
{
    lab_init(l);
    lab_quad(l, v3(-9, -9, 0), v3(18, 0, 0), v3(0, 18, 0),
             lab_material(l, "diffuse", "reflectance=0.5/0.25/0.125"));
    lab_sphere(l, v3(0, 0, 1), 0.5f, lab_material(l, "diffuse", "reflectance=0.5"), false);
    lab_light(l, "infinite", "L=1", NULL);
    lab_light(l, "point", "I=20", NULL);
    lab_camera(l, v3(0, -3, 5), v3(0, 0, 0), 40, "");
    lab_build(l);
}

/* Pixels of a material: where they are, which way they face, of which primitive they are. Material
 * 1 is the lab's own. */
static void what_is_met(void)
{
    static const char *const names[] = { "position=a.pfm", "geometric=b.pfm", "primitive=c.pfm",
                                         "material=d.pfm", "depth=e.pfm" };
    enum { AOVS = sizeof names / sizeof *names };
    unsigned long balls = 0, seen[4] = { 0 };
    RenderSettings s;
    RenderReport report;
    Image im[AOVS];
    Film film;
    Lab l;

    room(&l);
    picture_settings(&l, &s, "ao@random", SIDE, SIDE, 5);
    for (int k = 0; k < AOVS; k++)
        ask(&s, names[k]);
    picture_render(&l, &s, &film, &report);
    for (int k = 0; k < AOVS; k++)
        im[k] = picture_of(&s, &film, k);
    for (size_t i = 0; i < SIDE * SIDE; i++) {
        Rgb p = im[0].pixels[i], n = im[1].pixels[i], id = im[2].pixels[i], m = im[3].pixels[i];
        bool floor = n.r == 0 && n.g == 0 && n.b == 1;
        balls += m.r == 3;
        EXPECT(m.r == 2 || m.r == 3, "material %g", (double)m.r);
        EXPECT(!floor || (m.r == 2 && fabsf(p.b) < 1e-5f), "a floor at z %g of material %g",
               (double)p.b, (double)m.r);
        EXPECT(id.r == id.g && id.r >= 1 && id.r <= 3 && id.b == 0, "primitive %g, %g",
               (double)id.r, (double)id.g);
        EXPECT((id.r == 3) == (m.r == 3), "primitive %g of material %g", (double)id.r, (double)m.r);
        if (floor)              /* the distance of the mean point is near the mean distance */
            EXPECT(fabs(sqrt((double)p.r * p.r + (p.g + 3.0) * (p.g + 3.0) + 25) -
                        im[4].pixels[i].r) < 0.01,
                   "depth %g", (double)im[4].pixels[i].r);
        seen[(int)id.r]++;
    }
    EXPECT(balls > 20 && seen[1] > 100 && seen[2] > 100, "%lu of the ball, %lu, %lu of the floor",
           balls, seen[1], seen[2]);
    for (int k = 0; k < AOVS; k++)
        image_clear(&im[k]);
    film_clear(&film);
    lab_clear(&l);
}

/* emission + direct + indirect is the picture, by every way to find light. */
static void light_by_length(void)
{
    static const char *const methods[] = { "path", "path:strategy=implicit", "light", "sppm" };

    for (int m = 0; m < 4; m++) {
        RenderSettings s;
        RenderReport report;
        Image all, part[3];
        double sums[3] = { 0, 0, 0 };
        Film film;
        Lab l;
        room(&l);
        picture_settings(&l, &s, methods[m], SIDE, SIDE, 4);
        ask(&s, "emission=a.pfm");
        ask(&s, "direct=b.pfm");
        ask(&s, "indirect=c.pfm");
        picture_render(&l, &s, &film, &report);
        all = picture_of(&s, &film, -1);
        for (int k = 0; k < 3; k++)
            part[k] = picture_of(&s, &film, k);
        for (size_t i = 0; i < SIDE * SIDE; i++) {
            float want = all.pixels[i].g, got = 0;
            for (int k = 0; k < 3; k++) {
                got += part[k].pixels[i].g;
                sums[k] += part[k].pixels[i].g;
            }
            EXPECT(fabsf(got - want) <= 1e-5f * want, "%s: the parts give %.9g, the picture %.9g",
                   methods[m], (double)got, (double)want);
        }
        EXPECT(sums[0] == 0 && sums[1] > 0 && (sums[2] > 0 || m == 3), "%s: %g %g %g", methods[m],
               sums[0], sums[1], sums[2]);
        for (int k = 0; k < 3; k++)
            image_clear(&part[k]);
        image_clear(&all);
        film_clear(&film);
        lab_clear(&l);
    }
}

/* A matt room with a pane and a ball of glass, a mirror, a lamp and a sky: whatever a method does,
 * its paths lead there through things that take some of the light. */
static void room_of_glass(Lab *l)
{
    uint32_t grey, glass;

    lab_init(l);
    grey = lab_material(l, "diffuse", "reflectance=0.6/0.5/0.4");
    glass = lab_material(l, "dielectric", "transmittance=0.8/0.9/1");
    lab_quad(l, v3(-3, -3, 0), v3(6, 0, 0), v3(0, 6, 0), grey);
    lab_quad(l, v3(-3, 3, 0), v3(6, 0, 0), v3(0, 0, 4),
             lab_material(l, "mirror", "reflectance=0.7/0.8/0.9"));
    lab_sphere(l, v3(0.6f, 0, 0.8f), 0.7f, glass, false);
    lab_sphere(l, v3(-1, 0.5f, 0.7f), 0.6f,
               lab_material(l, "phong", "reflectance=0.3,specular=0.4,exponent=12"), false);
    lab_shine(l, lab_quad(l, v3(-1, -1, 3), v3(0, 1, 0), v3(1, 0, 0), grey), "L=9/8/7");
    lab_light(l, "infinite", "L=0.3/0.4/0.5", NULL);
    lab_light(l, "point", "from=1/-2/3,I=4", NULL);
    lab_camera(l, v3(0.5f, -5, 2), v3(0, 0, 0.6f), 50, "");
    lab_build(l);
}

/* The sum of the pictures first .. first + n - 1, by all channels of all pixels. */
static double sum_of(const RenderSettings *s, const Film *f, int first, int n)
{
    double sum = 0;

    for (int k = first; k < first + n; k++) {
        Image im = picture_of(s, f, k);
        for (size_t i = 0; i < (size_t)im.w * im.h; i++)
            sum += (double)im.pixels[i].r + (double)im.pixels[i].g + (double)im.pixels[i].b;
        image_clear(&im);
    }
    return sum;
}

/* All light that a method finds is of some length and found by some strategy. */
static void expect_parts(const char *method)
{
    RenderSettings s;
    RenderReport report;
    double want, lengths, ways;
    Film film;
    Lab l;

    room_of_glass(&l);
    picture_settings(&l, &s, method, SIDE, SIDE, 2);
    ask(&s, "emission=a.pfm");
    ask(&s, "direct=b.pfm");
    ask(&s, "indirect=c.pfm");
    for (int k = 0; k < STRATEGIES; k++) {
        char text[40];
        sprintf(text, "strategy:%s=d.pfm", strategy_names[k]);
        ask(&s, text);
    }
    picture_render(&l, &s, &film, &report);
    want = sum_of(&s, &film, -1, 1);
    lengths = sum_of(&s, &film, 0, 3);
    ways = sum_of(&s, &film, 3, STRATEGIES);
    EXPECT(want > 0, "%s: it shows %g", method, want);
    EXPECT(fabs(lengths - want) <= 1e-4 * want, "%s: by length %.9g of %.9g", method, lengths,
           want);
    EXPECT(fabs(ways - want) <= 1e-4 * want, "%s: by strategy %.9g of %.9g", method, ways, want);
    film_clear(&film);
    lab_clear(&l);
}

static void parts_of_all_methods(void)
{
    static const char *const more[] = {
        "photonmap:view=direct", "photonmap:caustics=0", "pssmlt:over=path",
        "irradiancecache:photons=2000,caustics=2000", "instantradiosity:compensate=true,clamp=9",
        "direct:lights=ward,strategy=light,tolerance=0.7", "direct:strategy=ris",
        "direct:strategy=ris,tentative=4,samples=32", "direct:strategy=cut",
        "direct:strategy=twostage", "path:strategy=ris"
    };

    for (int i = 0; integrators[i]; i++) {
        const char *name = integrators[i]->info.name;
        expect_parts(strcmp(name, "photons") ? name : "photons:ball=2");
    }
    for (size_t k = 0; k < sizeof more / sizeof *more; k++)
        expect_parts(more[k]);
}

/* Of direct light two edges; of all light the mean over lengths, which length:N gives too. */
static void edges(void)
{
    RenderSettings s;
    RenderReport report;
    Image mean, length[4];
    Film film;
    Lab l;

    room(&l);
    picture_settings(&l, &s, "path:maxdepth=3", SIDE, SIDE, 4);
    ask(&s, "edges=e.pfm");
    for (int k = 1; k <= 4; k++) {
        char text[40];
        snprintf(text, sizeof text, "length:%d=a.pfm", k);
        ask(&s, text);
    }
    picture_render(&l, &s, &film, &report);
    mean = picture_of(&s, &film, 0);
    for (int k = 0; k < 4; k++)
        length[k] = picture_of(&s, &film, 1 + k);
    for (size_t i = 0; i < SIDE * SIDE; i++) {
        double sum = 0, light = 0;
        for (int k = 0; k < 4; k++) {
            sum += (k + 1) * (double)rgb_lum(length[k].pixels[i]);
            light += rgb_lum(length[k].pixels[i]);
        }
        EXPECT(fabs(mean.pixels[i].r - sum / light) < 1e-4, "%g, not %g", (double)mean.pixels[i].r,
               sum / light);
    }
    image_clear(&mean);
    for (int k = 0; k < 4; k++)
        image_clear(&length[k]);
    film_clear(&film);
    lab_clear(&l);
}

/* The variance that a render says of its pixels is, in the mean, that of renders of many seeds.
 * filter: its weights, below 0 too, belong to the samples. */
static void expect_variance(const char *method, const char *part, double *z)
{
    enum { SEEDS = 48, PIXELS = SIDE * SIDE };
    static double sum[PIXELS], squares[PIXELS], said[PIXELS];
    double mean = 0, spread = 0;
    Lab l;

    memset(sum, 0, sizeof sum);
    memset(squares, 0, sizeof squares);
    memset(said, 0, sizeof said);
    room(&l);
    for (int k = 0; k < SEEDS; k++) {
        RenderSettings s;
        RenderReport report;
        Film film;
        Image im, v;
        picture_settings(&l, &s, method, SIDE, SIDE, 6);
        s.seed = (uint64_t)k + 1;
        ask(&s, part ? "variance:direct=v.pfm" : "variance=v.pfm");
        if (part)
            ask(&s, part);
        REQUIRE(settings_aovs_fit(&s), "fit");
        picture_render(&l, &s, &film, &report);
        im = picture_of(&s, &film, part ? 1 : -1);
        v = picture_of(&s, &film, 0);
        for (size_t i = 0; i < PIXELS; i++) {
            double c = s.integrator->splats ? rgb_lum(im.pixels[i]) : im.pixels[i].g;
            sum[i] += c;
            squares[i] += c * c;
            said[i] += v.pixels[i].g;
        }
        image_clear(&im);
        image_clear(&v);
        film_clear(&film);
    }
    for (int i = 0; i < PIXELS; i++) {          /* both unbiased: the difference has the mean 0 */
        double d = said[i] / SEEDS - (squares[i] - sum[i] * sum[i] / SEEDS) / (SEEDS - 1);
        mean += d / PIXELS;
        spread += d * d / PIXELS;
    }
    *z = mean / sqrt((spread - mean * mean) / PIXELS);
    lab_clear(&l);
}

static void variance(void)
{
    static const struct { const char *method, *part; } runs[] = {
        { "path@random", NULL }, { "path@random@mitchell", NULL },
        { "path@random", "direct=d.pfm" }, { "light@random", NULL }
    };

    for (int k = 0; k < 4; k++) {
        double z;
        expect_variance(runs[k].method, runs[k].part, &z);
        EXPECT(fabs(z) < 4.5, "%s %s: z = %g", runs[k].method, runs[k].part ? runs[k].part : "", z);
    }
}

/* ---- files ---- */

/* Layers of one file are the pictures of single files. */
static void layers(void)
{
    static const char *const names[] = { "normal", "depth", "material", "length:2",
                                         "variance:direct", "samples" };
    static const char *const layer[] = { "normal", "depth", "material", "length.2",
                                         "variance.direct", "samples" };
    char line[1000] = "tiny.pbrt --quiet --spp 3 -o a.pfm -o a.exr -o b.exr --uncompressed";
    size_t n;
    char *bytes;

    cli_scene();
    for (int k = 0; k < 6; k++)
        sprintf(line + strlen(line), " --aov %s=a.exr --aov %s=%d.pfm", names[k], names[k], k);
    CLI_WORKS("%s", line);
    bytes = cli_read("a.exr", &n);
    REQUIRE(bytes, "a.exr");
    for (int k = -1; k < 6; k++) {
        char name[20] = "a.pfm";
        Image one, of_all;
        if (k >= 0)
            sprintf(name, "%d.pfm", k);
        REQUIRE(image_read(&one, cli_path(name), 1000), "%s", name);
        REQUIRE(exr_read(&of_all, "a.exr", (unsigned char *)bytes, n, 1000,
                         k < 0 ? "" : layer[k]), "layer");
        for (size_t i = 0; i < (size_t)one.w * one.h; i++)
            EXPECT(one.pixels[i].r == of_all.pixels[i].r && one.pixels[i].b == of_all.pixels[i].b,
                   "%s: pixel %lu", k < 0 ? "picture" : names[k], (unsigned long)i);
        image_clear(&one);
        image_clear(&of_all);
    }
    CLI_WORKS("convert b.exr c.pfm");
    EXPECT(cli_same_file("a.pfm", "c.pfm"), "-o b.exr");
    CLI_WORKS("convert --layer depth a.exr d.pfm");
    EXPECT(cli_same_file("1.pfm", "d.pfm"), "--layer");
    CLI_FAILS(STATUS_INPUT, "b.exr: it has no layer 'depth'; its channels: B G R",
              "convert --layer depth b.exr d.pfm");
    CLI_FAILS(STATUS_INPUT, "a.pfm: only EXR files have layers, --layer depth was asked for",
              "convert --layer depth a.pfm d.pfm");
}

const TestCase test_aov[] = {
    { "what_is_met", what_is_met, false },
    { "light_by_length", light_by_length, false },
    { "parts_of_all_methods", parts_of_all_methods, false },
    { "edges", edges, false },
    { "variance", variance, false },
    { "layers", layers, false },
    { NULL, NULL, false }
};

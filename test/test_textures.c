/* test_textures.c -- textures against their formulas written out, pyramids against averages of
 * boxes, seams, noise, and what the scene language makes of all that. */
#include "image/pyramid.h"
#include "scene/noise.h"
#include "test/image_help.h"
#include "test/png_help.h"
#include "test/scene_help.h"

/* ---- pictures between pixels ---- */

static Image noisy(uint32_t w, uint32_t h, bool alpha, uint64_t seed)
{
    Image im;
    Rng r = rng_seed(seed);

    REQUIRE((alpha ? image_init_alpha : image_init)(&im, w, h), "image");
    for (size_t i = 0; i < (size_t)w * h; i++) {
        im.pixels[i].r = rng_unit(&r);
        im.pixels[i].g = rng_unit(&r);
        im.pixels[i].b = rng_unit(&r);
        if (alpha)
            im.alpha[i] = rng_unit(&r);
    }
    return im;
}

static bool near(double a, double b, double tolerance) { return fabs(a - b) <= tolerance; }

static bool near_rgb(Rgb a, Rgb b, double tolerance)
{
    return near(a.r, b.r, tolerance) && near(a.g, b.g, tolerance) && near(a.b, b.b, tolerance);
}

static double mean_of(const Image *im, double *alpha)
{
    double sum = 0, n = (double)im->w * im->h;
    *alpha = 0;
    for (size_t i = 0; i < (size_t)im->w * im->h; i++) {
        sum += im->pixels[i].r + im->pixels[i].g + im->pixels[i].b;
        *alpha += im->alpha ? im->alpha[i] : 0;
    }
    *alpha /= n;
    return sum / n;
}

/* Naive: the mean over pixel (x, y) of an image of w x h laid over im, by its parts. */
static double box_mean(const Image *im, uint32_t w, uint32_t h, uint32_t x, uint32_t y)
{
    double sum = 0, area = 0;
    for (uint32_t j = 0; j < im->h; j++)
        for (uint32_t i = 0; i < im->w; i++) {
            double wide = d_min((x + 1.0) * im->w / w, i + 1.0) - d_max((double)x * im->w / w, i);
            double high = d_min((y + 1.0) * im->h / h, j + 1.0) - d_max((double)y * im->h / h, j);
            if (wide > 0 && high > 0) {
                sum += wide * high * image_at(im, i, j)->g;
                area += wide * high;
            }
        }
    return sum / area;
}

static void pyramid_levels(void)
{
    static const uint32_t sizes[][2] = { { 16, 16 }, { 1, 1 }, { 13, 1 }, { 7, 11 }, { 33, 20 } };

    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        Image im = noisy(sizes[k][0], sizes[k][1], k & 1, k);
        double alpha, mean = mean_of(&im, &alpha), a;
        const Image *before = &im;
        Pyramid p;
        REQUIRE(pyramid_init(&p, &im), "pyramid");
        for (int n = 0; n < p.n; n++) {
            const Image *l = &p.level[n];
            EXPECT(l->w == (before->w + 1) / 2 && l->h == (before->h + 1) / 2, "size");
            for (uint32_t y = 0; y < l->h; y++)
                for (uint32_t x = 0; x < l->w; x++)
                    EXPECT(near(image_at(l, x, y)->g, box_mean(before, l->w, l->h, x, y), 1e-6),
                           "level %d, %u, %u", n + 1, (unsigned)x, (unsigned)y);
            EXPECT(near(mean_of(l, &a), mean, 1e-6) && near(a, alpha, 1e-6), "mean");
            before = l;
        }
        EXPECT(before->w == 1 && before->h == 1, "the last level is a pixel");
        pyramid_clear(&p);
        image_clear(&im);
    }
    EXPECT(mem_blocks() == 0, "%ld blocks", mem_blocks());
}

/* Naive bilinear: a sum over all pixels, by the distance to their centres, of the picture and its
 * copies around it. */
static double naive_bilinear(const Image *im, double u, double v, Wrap wrap)
{
    double x = u * im->w - 0.5, y = (1 - v) * im->h - 0.5, sum = 0;
    for (int j = (int)floor(y); j <= (int)floor(y) + 1; j++)
        for (int i = (int)floor(x); i <= (int)floor(x) + 1; i++) {
            int w = (int)im->w, h = (int)im->h, a = i, b = j;
            if (wrap == WRAP_BLACK && (i < 0 || j < 0 || i >= w || j >= h))
                continue;
            a = wrap == WRAP_CLAMP ? (i < 0 ? 0 : i >= w ? w - 1 : i) : (i % w + w) % w;
            b = wrap == WRAP_CLAMP ? (j < 0 ? 0 : j >= h ? h - 1 : j) : (j % h + h) % h;
            sum += (1 - fabs(x - i)) * (1 - fabs(y - j)) *
                   image_at(im, (uint32_t)a, (uint32_t)b)->r;
        }
    return sum;
}

static void lookups(void)
{
    Image im = noisy(5, 4, true, 9);
    Rng r = rng_seed(41);

    for (int k = 0; k < 6000; k++) {
        ImagePlace at;
        at.u = 4.0f * rng_unit(&r) - 1.5f;
        at.v = 4.0f * rng_unit(&r) - 1.5f;
        at.wrap = (Wrap)(k % 3);
        at.alpha = false;
        EXPECT(near(image_bilinear(&im, &at).r, naive_bilinear(&im, at.u, at.v, at.wrap), 2e-6),
               "%g %g, wrap %d", (double)at.u, (double)at.v, at.wrap);
        at.alpha = true;
        EXPECT(image_bilinear(&im, &at).r == image_bilinear(&im, &at).b, "alpha is grey");
    }
    for (int k = 0; k < 20; k++) {              /* pixel centres, and both sides of the seams */
        ImagePlace c = { ((float)(k % 5) + 0.5f) / 5.0f, 1.0f - ((float)(k / 5) + 0.5f) / 4.0f,
                         WRAP_REPEAT, false }, left = c, right = c;
        Rgb p = *image_at(&im, (uint32_t)(k % 5), (uint32_t)(k / 5));
        EXPECT(near_rgb(image_bilinear(&im, &c), p, 1e-6), "centre of pixel %d", k);
        EXPECT(near_rgb(image_nearest(&im, &c), p, 0), "nearest, pixel %d", k);
        c.alpha = true;
        EXPECT(near(image_bilinear(&im, &c).g, im.alpha[k], 1e-6), "alpha of pixel %d", k);
        left.u = 1.0f - 1e-5f;
        right.u = 1.0f + 1e-5f;
        EXPECT(near_rgb(image_bilinear(&im, &left), image_bilinear(&im, &right), 4e-4), "seam");
    }
    image_clear(&im);
}

/* Numbers without a place, and such as are no numbers. */
static void far_places(void)
{
    const float wild[] = { 1e10f, -1e30f, INFINITY, -INFINITY, 3e9f };
    Image im = noisy(5, 4, false, 10);
    Pyramid p;
    float nan = INFINITY - INFINITY;

    REQUIRE(pyramid_init(&p, &im), "pyramid");
    for (int k = 0; k < 18; k++) {
        float x = k < 15 ? wild[k / 3] : nan;
        ImagePlace a = { x, 0.5f, (Wrap)(k % 3), false }, b = { 0.5f, x, (Wrap)(k % 3), false };
        EXPECT(rgb_finite(image_bilinear(&im, &a)) && rgb_finite(image_nearest(&im, &b)) &&
               rgb_finite(image_bilinear(&im, &b)) && rgb_finite(pyramid_trilinear(&p, &a, x)),
               "%d", k);
    }
    EXPECT(noise(v3(1e30f, 0, 0)) == 0 && noise(v3(0, nan, 0)) == 0 &&
           noise(v3(0, 0, -INFINITY)) == 0, "noise without a place");
    pyramid_clear(&p);
    image_clear(&im);
}

/* Whole levels are bilinear in them, the last one is the mean everywhere; between them, in line. */
static void trilinear(void)
{
    Image im = noisy(16, 8, false, 11);
    Pyramid p;
    Rng r = rng_seed(42);

    REQUIRE(pyramid_init(&p, &im), "pyramid");
    for (int k = 0; k < 500; k++) {
        ImagePlace at = { 0, 0, WRAP_REPEAT, false };
        at.u = rng_unit(&r);
        at.v = rng_unit(&r);
        EXPECT(near_rgb(pyramid_trilinear(&p, &at, -3), image_bilinear(&im, &at), 0), "below 0");
        for (int n = 0; n < p.n; n++) {
            const Image *fine = n ? &p.level[n - 1] : &im;
            Rgb a = image_bilinear(fine, &at), b = image_bilinear(&p.level[n], &at);
            EXPECT(near_rgb(pyramid_trilinear(&p, &at, (float)n), a, 1e-6), "level %d", n);
            EXPECT(near_rgb(pyramid_trilinear(&p, &at, (float)n + 0.25f),
                            rgb_add(rgb_scale(a, 0.75f), rgb_scale(b, 0.25f)), 1e-6), "between");
        }
        EXPECT(near_rgb(pyramid_trilinear(&p, &at, 99), p.level[p.n - 1].pixels[0], 1e-6), "last");
    }
    pyramid_clear(&p);
    image_clear(&im);
}

/* ---- noise ---- */

static V3 somewhere(Rng *r, float size)
{
    V3 p;
    p.x = size * (rng_unit(r) - 0.5f);
    p.y = size * (rng_unit(r) - 0.5f);
    p.z = size * (rng_unit(r) - 0.5f);
    return p;
}

/* The mean of n independent numbers of variance v errs by sqrt(v / n); values in one cube are not
 * independent, but cubes are. */
static void noise_figures(void)
{
    enum { N = 200000 };
    double sum = 0, squares = 0, most = 0, steepest = 0;
    Rng r = rng_seed(43);

    for (int k = 0; k < N; k++) {
        V3 p = somewhere(&r, 4000), q = p;
        double v = noise(p), step;
        sum += v;
        squares += v * v;
        most = d_max(most, fabs(v));
        q.x = floorf(q.x);
        q.y = floorf(q.y);
        q.z = floorf(q.z);
        EXPECT(noise(q) == 0, "0 at the corners");
        p = somewhere(&r, 8);
        q = p;
        q.x += 1e-3f;
        step = fabs(noise(q) - noise(p)) / 1e-3;
        steepest = d_max(steepest, step);
        q = v3(floorf(p.x) + 1, p.y, p.z);              /* both sides of the border of cubes */
        p.x = q.x - 1e-4f;
        q.x += 1e-4f;
        EXPECT(fabs(noise(p) - noise(q)) < 4 * 2e-4, "a step at a border");
    }
    EXPECT(most <= 1 && most > 0.7, "largest %g", most);
    EXPECT(fabs(sum / N) < 4 * sqrt(squares / N / N), "mean %g", sum / N);
    EXPECT(squares / N > 0.05 && squares / N < 0.1, "variance %g", squares / N);
    EXPECT(steepest < 4, "slope %g", steepest);
}

/* Sums by the sum, and with octaves left out where they are finer than the beam. */
static void noise_sums(void)
{
    Rng r = rng_seed(44);

    for (int k = 0; k < 2000; k++) {
        V3 p = somewhere(&r, 50), q = p;
        double sum = 0, creased = 0, height = 1;
        for (int n = 0; n < 5; n++) {
            sum += height * noise(q);
            creased += height * fabs(noise(q));
            height *= 0.6f;
            q = v_scale(q, 1.99f);
        }
        EXPECT(near(noise_sum(p, (Octaves){ 5, 0.6f, 0 }), sum, 1e-6), "sum");
        EXPECT(near(noise_turbulence(p, (Octaves){ 5, 0.6f, 0 }), creased, 1e-6), "turbulence");
        EXPECT(noise_sum(p, (Octaves){ 5, 0.6f, 0.25f }) == noise_sum(p, (Octaves){ 1, 0.6f, 0 }),
               "a beam of a quarter sees one octave");
        EXPECT(noise_sum(p, (Octaves){ 5, 0.6f, 1 }) == 0, "a beam of 1 sees none");
    }
}

/* ---- textures out of the scene language ---- */

/* The texture called "x" that the text makes, by the material that uses it. */
static const Texture *texture_of(SceneFile *f, const char *text)
{
    char all[3000];

    REQUIRE(snprintf(all, sizeof all, "WorldBegin %s Material \"diffuse\" \"texture reflectance\" "
                     "\"x\" Shape \"sphere\"", text) < (int)sizeof all, "room");
    *f = scene_of(all, 0);
    for (size_t i = 0; i < f->scene->nmaterials; i++)
        for (int k = 0; k < f->scene->materials[i].nvalues; k++)
            if (f->scene->materials[i].texture[k])
                return f->scene->materials[i].texture[k];
    REQUIRE(false, "no texture: %s", text);
    return NULL;
}

static Surface place_on(V3 p, float u, float v)
{
    Surface s;
    memset(&s, 0, sizeof s);
    s.p = p;
    s.uv = (V2){ u, v };
    s.ng = s.ns = v3(0, 0, 1);
    s.dpdu = v3(2, 0, 0);
    s.dpdv = v3(0, 4, 0);
    return s;
}

/* The value of "x" at a point. */
static Rgb value(const char *text, V3 p, float u, float v)
{
    SceneFile f;
    Surface s = place_on(p, u, v);
    Rgb c = texture_eval(texture_of(&f, text), &s);
    scenefile_clear(&f);
    return c;
}

#define UVC "Texture \"x\" \"spectrum\" \"uv\" "        /* shows (s, t) as they are */

static void mappings(void)
{
    const V3 p = { 3, 4, 5 }, o = { 0, 0, 0 };
    const double phi = md_atan2(4, 3) / (2 * PI), theta = md_atan2(5, 5) / PI;
    Rgb c;

    EXPECT(near_rgb(value(UVC, o, 0.25f, 0.75f), rgb(0.25f, 0.75f, 0), 1e-6), "uv");
    EXPECT(near_rgb(value(UVC "\"float uscale\" 3 \"float vscale\" 2 \"float udelta\" .5 "
                          "\"float vdelta\" -.25", o, 0.25f, 0.375f), rgb(0.25f, 0.5f, 0), 1e-6),
           "scale and delta");
    c = value(UVC "\"string mapping\" \"spherical\"", p, 0, 0);
    EXPECT(near_rgb(c, rgb((float)theta, (float)phi, 0), 1e-6), "spherical");
    c = value(UVC "\"string mapping\" \"spherical\"", v3(3, -4, 5), 0, 0);
    EXPECT(near_rgb(c, rgb((float)theta, (float)(1 - phi), 0), 1e-6), "the other half");
    c = value(UVC "\"string mapping\" \"cylindrical\"", v3(3, 4, 5.25f), 0, 0);
    EXPECT(near_rgb(c, rgb((float)(0.5 + phi), 0.25f, 0), 1e-6), "cylindrical");
    c = value(UVC "\"string mapping\" \"planar\" \"vector v1\" [.1 0 0] \"vector v2\" [0 .1 .1] "
              "\"float udelta\" .125 \"float vdelta\" -.25", p, 0, 0);
    EXPECT(near_rgb(c, rgb(0.425f, 0.65f, 0), 1e-6), "planar");
    c = value("Translate 1 2 3 Scale 10 10 10 " UVC "\"string mapping\" \"planar\"", p, 0, 0);
    EXPECT(near_rgb(c, rgb(0.2f, 0.2f, 0), 1e-6), "in the space of the transform");
}

static void patterns(void)
{
    static const char two[] = "Texture \"x\" \"spectrum\" \"checkerboard\" \"rgb tex1\" [1 .5 0] "
                              "\"rgb tex2\" [0 .25 1] \"float uscale\" 4 \"float vscale\" 4";
    static const char three[] = "Texture \"x\" \"spectrum\" \"checkerboard\" \"integer dimension\" "
                                "3 \"rgb tex1\" [1 .5 0] \"rgb tex2\" [0 .25 1]";
    static const char mixed[] = "Texture \"a\" \"float\" \"constant\" \"float value\" .25 "
                                "Texture \"x\" \"spectrum\" \"mix\" \"rgb tex1\" [1 .5 0] "
                                "\"rgb tex2\" [0 .5 1] \"texture amount\" \"a\"";
    static const char bilerp[] = "Texture \"x\" \"spectrum\" \"bilerp\" \"rgb v00\" [1 0 0] "
                                 "\"rgb v01\" [0 1 0] \"rgb v10\" [0 0 1] \"rgb v11\" [1 1 1]";
    static const char along[] = "Rotate 90 1 0 0 Texture \"x\" \"spectrum\" \"directionmix\" "
                                "\"rgb tex1\" [1 0 0] \"rgb tex2\" [0 1 0]";
    const Rgb a = { .r = 1, .g = 0.5f, .b = 0 }, b = { .r = 0, .g = 0.25f, .b = 1 };
    const V3 o = { 0, 0, 0 };
    Rng r = rng_seed(45);
    SceneFile f;
    const Texture *t2 = texture_of(&f, two), *t3;
    SceneFile g;

    t3 = texture_of(&g, three);
    for (int k = 0; k < 1000; k++) {
        V3 p = somewhere(&r, 20);
        Surface s = place_on(p, p.x, p.y);
        bool odd2 = ((int)floor(4 * p.x) + (int)floor(4 * p.y)) & 1;
        bool odd3 = ((int)floor(p.x) + (int)floor(p.y) + (int)floor(p.z)) & 1;
        EXPECT(near_rgb(texture_eval(t2, &s), odd2 ? b : a, 1e-6), "squares");
        EXPECT(near_rgb(texture_eval(t3, &s), odd3 ? b : a, 1e-6), "cubes");
    }
    scenefile_clear(&f);
    scenefile_clear(&g);
    EXPECT(near_rgb(value(mixed, o, 0, 0), rgb(0.75f, 0.5f, 0.25f), 1e-6), "mix");
    EXPECT(near_rgb(value(bilerp, o, 0.25f, 0.75f), rgb(0.375f, 0.75f, 0.25f), 1e-6) &&
           near_rgb(value(bilerp, o, 0, 1), rgb(0, 1, 0), 1e-6) &&
           near_rgb(value(bilerp, o, 1, 0), rgb(0, 0, 1), 1e-6) &&
           near_rgb(value(bilerp, o, 0.5f, 0.5f), rgb_all(0.5f), 1e-6), "bilerp");
    EXPECT(near_rgb(value(along, o, 0, 0), rgb(1, 0, 0), 1e-6), "y of the transform is z");
    EXPECT(near_rgb(value(along + 16, o, 0, 0), rgb(0, 1, 0), 1e-6), "across the normal");
}

/* About half of the squares have a dot, whole, of its radius: pi 0.35^2 / 2 of the surface. */
static void dots(void)
{
    enum { N = 40000 };
    SceneFile f;
    const Texture *t = texture_of(&f, "Texture \"x\" \"spectrum\" \"dots\"");
    double p = 0.5 * PI * 0.35 * 0.35, inside = 0;
    Rng r = rng_seed(46);

    for (int k = 0; k < N; k++) {
        Surface s;
        s = place_on(v_all(0), 900 * rng_unit(&r), 0);
        s.uv.y = 900 * rng_unit(&r);
        inside += texture_eval(t, &s).r;
        s.uv.x = floorf(s.uv.x) + 0.5f;                 /* borders between squares */
        EXPECT(texture_eval(t, &s).r == 0, "a dot is cut off");
    }
    EXPECT(fabs(inside / N - p) < 4 * sqrt(p * (1 - p) / N), "%g of %g", inside / N, p);
    scenefile_clear(&f);
}

static void noises(void)
{
    static const char scaled[] = "Scale 2 2 2 Texture \"x\" \"spectrum\" \"%s\"";
    Rng r = rng_seed(47);

    for (int kind = 0; kind < 4; kind++) {
        static const char *const names[] = { "fbm", "wrinkled", "windy", "marble" };
        char text[200];
        SceneFile f;
        const Texture *t;
        snprintf(text, sizeof text, scaled, names[kind]);
        t = texture_of(&f, text);
        for (int k = 0; k < 300; k++) {
            V3 p = somewhere(&r, 30), half = v_scale(p, 0.5f);
            Surface s = place_on(p, 0, 0);
            Octaves o = { 8, 0.5f, 0 };
            Rgb c = texture_eval(t, &s);
            if (kind == 0)
                EXPECT(near(c.r, noise_sum(half, o), 1e-6), "fbm");
            else if (kind == 1)
                EXPECT(near(c.r, noise_turbulence(half, o), 1e-6), "wrinkled");
            else if (kind == 2)
                EXPECT(near(c.r, fabs(noise_sum(v_scale(half, 0.1f), (Octaves){ 3, 0.5f, 0 })) *
                            noise_sum(half, (Octaves){ 6, 0.5f, 0 }), 1e-6), "windy");
            else
                EXPECT(c.r >= 0.34f && c.r <= 0.88f && c.b <= 0.91f && c.b >= c.r, "marble");
        }
        scenefile_clear(&f);
    }
}

/* A picture of 2 x 2 with alpha: top red and green, bottom blue and white, alpha 0 85 170 255. */
static void write_picture(void)
{
    static PngFile f;
    static const unsigned char raw[18] = { 0, 255, 0, 0, 0, 0, 255, 0, 85,
                                           0, 0, 0, 255, 170, 255, 255, 255, 255 };
    png_begin(&f, 2, 2, 8, 6, 0);
    png_data(&f, raw, sizeof raw, 1000);
    REQUIRE(file_write(in_folder("p.png"), f.bytes, f.n), "write");
}

#define IMG(type) "Texture \"x\" \"" type "\" \"imagemap\" \"string filename\" \"p.png\" "

static void imagemaps(void)
{
    const V3 o = { 0, 0, 0 };

    write_picture();
    EXPECT(near_rgb(value(IMG("spectrum"), o, 0.25f, 0.75f), rgb(1, 0, 0), 1e-6), "top left");
    EXPECT(near_rgb(value(IMG("spectrum"), o, 0.75f, 0.25f), rgb(1, 1, 1), 1e-6), "bottom right");
    EXPECT(near_rgb(value(IMG("spectrum"), o, 0.5f, 0.5f), rgb_all(0.5f), 1e-6), "middle");
    EXPECT(near_rgb(value(IMG("spectrum") "\"string filter\" \"point\"", o, 0.51f, 0.49f),
                    rgb(1, 1, 1), 0), "point");
    EXPECT(near_rgb(value(IMG("spectrum") "\"string wrap\" \"black\"", o, 1.3f, 0.3f),
                    rgb_all(0), 0), "black");
    EXPECT(near_rgb(value(IMG("spectrum") "\"string wrap\" \"clamp\"", o, 7, -3),
                    rgb(1, 1, 1), 1e-6), "clamp");
    EXPECT(near_rgb(value(IMG("spectrum") "\"string wrap\" \"repeat\"", o, 7.25f, -3.25f),
                    rgb(1, 0, 0), 1e-6), "repeat");
    EXPECT(near_rgb(value(IMG("spectrum") "\"float scale\" .25 \"bool invert\" true", o, 0.25f,
                          0.75f), rgb(0.75f, 1, 1), 1e-6), "scale, then invert");
    EXPECT(near_rgb(value(IMG("float"), o, 0.25f, 0.75f), rgb_all(1.0f / 3), 1e-6),
           "a float is the mean of the channels");
}

/* Greys of 100 with each encoding. */
static void encodings(void)
{
    static const struct { const char *text; float encoding; } how[] = {
        { "", ENCODING_SRGB }, { "\"string encoding\" \"linear\"", ENCODING_LINEAR },
        { "\"string encoding\" \"sRGB\"", ENCODING_SRGB }, { "\"bool gamma\" true", ENCODING_SRGB },
        { "\"bool gamma\" false", ENCODING_LINEAR }, { "\"float gamma\" 1", ENCODING_LINEAR },
        { "\"string encoding\" \"gamma 1.8\"", 1.8f }, { "\"float gamma\" 2.2", 2.2f }
    };
    static PngFile f;
    const float x = 100.0f / 255.0f;

    png_begin(&f, 1, 1, 8, 0, 0);
    png_data(&f, (const unsigned char *)"\0\144", 2, 1000);
    REQUIRE(file_write(in_folder("p.png"), f.bytes, f.n), "write");
    for (size_t k = 0; k < sizeof how / sizeof *how; k++) {
        char text[300];
        float e = how[k].encoding, want = e < 0 ? srgb_decode(x) : e == 1 ? x : m_pow(x, e);
        snprintf(text, sizeof text, IMG("spectrum") "%s", how[k].text);
        EXPECT(near(value(text, v_all(0), 0.5f, 0.5f).r, want, 1e-6), "%s", how[k].text);
    }
}

/* Alpha of the picture through what is made of it; the grey value where there is none. */
static void alphas(void)
{
    static const struct { const char *text; float u, v, want; } cases[] = {
        { IMG("float"), 0.25f, 0.75f, 0 }, { IMG("float"), 0.75f, 0.75f, 1.0f / 3 },
        { IMG("float"), 0.25f, 0.25f, 2.0f / 3 }, { IMG("spectrum"), 0.75f, 0.25f, 1 },
        { IMG("float") "\"bool invert\" true", 0.75f, 0.75f, 2.0f / 3 },
        { IMG("float") "\"float uscale\" 2 Texture \"y\" \"float\" \"scale\" \"texture tex\" \"x\" "
          "\"float scale\" .5 Texture \"x\" \"float\" \"mix\" \"texture tex1\" \"y\" "
          "\"float tex2\" 1", 0.375f, 0.75f, (1.0f / 6 + 1) / 2 },
        { "Texture \"x\" \"float\" \"constant\" \"float value\" .4", 0, 0, 0.4f }
    };

    write_picture();
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        SceneFile f;
        char text[1000];
        Surface s = place_on(v_all(0), cases[k].u, cases[k].v);
        const Texture *t = NULL;
        snprintf(text, sizeof text, "WorldBegin %s Shape \"sphere\" \"texture alpha\" \"x\"",
                 cases[k].text);
        f = scene_of(text, k == 5);                     /* one is defined twice */
        for (size_t i = 0; i < f.scene->nmaterials; i++)
            t = f.scene->materials[i].opacity ? f.scene->materials[i].opacity : t;
        REQUIRE(t, "no mask");
        EXPECT(near(texture_alpha(t, &s), cases[k].want, 1e-6), "case %d: %g", (int)k,
               (double)texture_alpha(t, &s));
        scenefile_clear(&f);
    }
}

/* A fine checkerboard of a picture: the level follows from the width of the beam and from how far
 * the surface goes for one u. Wide beams see the mean, whatever the mapping. */
static void footprints(void)
{
    static const char *const maps[] = { "uv", "spherical", "cylindrical", "planar" };
    Image im = new_image(64, 64);

    for (uint32_t y = 0; y < 64; y++)
        for (uint32_t x = 0; x < 64; x++)
            *image_at(&im, x, y) = rgb_all((float)((x + y) & 1));
    REQUIRE(image_write(&im, in_folder("c.pfm"), NULL), "write");
    for (int k = 0; k < 4; k++) {
        char text[300];
        SceneFile f;
        const Texture *t;
        Surface s = place_on(v3(0.3f, 0.7f, 0.1f), 0.1484375f, 0.3359375f);
        snprintf(text, sizeof text, "Texture \"x\" \"spectrum\" \"imagemap\" \"string filename\" "
                 "\"c.pfm\" \"string filter\" \"%s\" \"string mapping\" \"%s\"",
                 k & 1 ? "trilinear" : "EWA", maps[k]);
        t = texture_of(&f, text);
        REQUIRE(t->pyramid && t->pyramid->n == 6, "pyramid");
        if (k == 0) {
            Rgb c = texture_eval(t, &s);
            EXPECT(c.r == 0 || c.r == 1, "a ray: %g", (double)c.r);
            s.width = 2.0f / 64;                        /* a pixel: dp/du is 2 */
            EXPECT(near_rgb(texture_eval(t, &s), c, 1e-6), "a pixel");
            s.width = 2 * 2.0f / 64;
            EXPECT(near(texture_eval(t, &s).r, 0.5, 1e-6), "two pixels");
        }
        s.width = 100;
        EXPECT(near(texture_eval(t, &s).r, 0.5, 1e-6), "%s", maps[k]);
        s.dpdu = s.dpdv = v_all(0);                     /* not known */
        EXPECT(rgb_finite(texture_eval(t, &s)), "%s", maps[k]);
        scenefile_clear(&f);
    }
    image_clear(&im);
}

/* A texture may not touch more than so many others; octaves are bounded. */
static void bounded(void)
{
    char text[6000] = "WorldBegin Texture \"t0\" \"float\" \"fbm\" \"integer octaves\" 2000000000 ";
    SceneFile f;

    for (int k = 1; k < 12; k++)
        sprintf(text + strlen(text), "Texture \"t%d\" \"float\" \"mix\" \"texture tex1\" \"t%d\" "
                "\"texture tex2\" \"t%d\" ", k, k - 1, k - 1);
    err_reset();
    EXPECT(!scene_parse(&f, text), "4096 textures in one");
    f = scene_of("WorldBegin Texture \"x\" \"float\" \"fbm\" \"integer octaves\" 2000000000 "
                 "Shape \"sphere\" \"texture alpha\" \"x\"", 0);
    for (size_t i = 0; i < f.scene->nmaterials; i++)
        EXPECT(!f.scene->materials[i].opacity ||
               f.scene->materials[i].opacity->octaves == TEXTURE_OCTAVES_MAX, "octaves");
    scenefile_clear(&f);
}

/* A name is free again where the block ends in which it was defined. */
static void names_end(void)
{
    static const char define[] = "Texture \"t\" \"float\" \"constant\"\n";
    char text[600];
    SceneFile f;

    messages_quiet(true);
    snprintf(text, sizeof text, "WorldBegin AttributeBegin %s AttributeEnd AttributeBegin %s"
             "AttributeEnd %s", define, define, define);
    f = scene_of(text, 0);
    scenefile_clear(&f);
    snprintf(text, sizeof text, "WorldBegin %s AttributeBegin %s TransformBegin %s TransformEnd "
             "AttributeEnd", define, define, define);
    f = scene_of(text, 2);
    scenefile_clear(&f);
}

const TestCase test_textures[] = {
    { "names_end", names_end, false },
    { "pyramid_levels", pyramid_levels, false },
    { "lookups", lookups, false },
    { "far_places", far_places, false },
    { "trilinear", trilinear, false },
    { "noise_figures", noise_figures, false },
    { "noise_sums", noise_sums, false },
    { "mappings", mappings, false },
    { "patterns", patterns, false },
    { "dots", dots, false },
    { "noises", noises, false },
    { "imagemaps", imagemaps, false },
    { "encodings", encodings, false },
    { "alphas", alphas, false },
    { "footprints", footprints, false },
    { "bounded", bounded, false },
    { NULL, NULL, false }
};

/* test_denoise.c -- noise filters: what they must not touch, what they must take away, against
 * naive twins; parts and files by the program as a user runs it. */
#include "cli/denoising.h"
#include "image/denoise.h"
#include "test/cli_help.h"
#include "test/image_help.h"

#include <math.h>
#include <stdlib.h>

enum { W = 48, H = 37 };

static float normal(Rng *r)
{
    float u = rng_unit(r), v = rng_unit(r);
    return sqrtf(-2.0f * m_log(1.0f - u)) * m_cos(2.0f * PI_F * v);
}

/* Two halves of different albedo; light that falls off over both; noise of sigma 0.1 on it. */
typedef struct { Image truth, noisy, variance, albedo, normal, depth; } Sample;

static Sample sample_init(float sigma)
{
    Sample s = { new_image(W, H), new_image(W, H), new_image(W, H), new_image(W, H),
                 new_image(W, H), new_image(W, H) };
    Rng r = rng_seed(11);

    for (uint32_t y = 0; y < H; y++)
        for (uint32_t x = 0; x < W; x++) {
            size_t i = (size_t)y * W + x;
            Rgb a = x < W / 2 ? rgb(0.9f, 0.8f, 0.7f) : rgb(0.1f, 0.2f, 0.1f);
            s.albedo.pixels[i] = a;
            s.normal.pixels[i] = rgb(0, 0, 1);
            s.depth.pixels[i] = rgb_all(5);
            s.truth.pixels[i] = rgb_scale(a, 1.0f - 0.3f * (float)y / H);
            s.variance.pixels[i] = rgb_all(sigma * sigma);
            s.noisy.pixels[i].r = s.truth.pixels[i].r + sigma * normal(&r);
            s.noisy.pixels[i].g = s.truth.pixels[i].g + sigma * normal(&r);
            s.noisy.pixels[i].b = s.truth.pixels[i].b + sigma * normal(&r);
        }
    return s;
}

static void sample_clear(Sample *s)
{
    image_clear(&s->truth);
    image_clear(&s->noisy);
    image_clear(&s->variance);
    image_clear(&s->albedo);
    image_clear(&s->normal);
    image_clear(&s->depth);
}

static Noisy noisy_of(const Sample *s, bool guided, bool known)
{
    return (Noisy){ &s->noisy, known ? &s->variance : NULL, guided ? &s->albedo : NULL,
                    guided ? &s->normal : NULL, guided ? &s->depth : NULL, 2 };
}

static Image run(const char *text, const Noisy *in)
{
    static Arena arena;
    Opts o;
    const Denoiser *k = kind_from_text(denoisers, "noise filter", text, &o, &arena);
    Image out = new_image(in->colour->w, in->colour->h);

    REQUIRE(k && k->run(in, &o, &out), "%s", text);
    return out;
}

static double error_of(const Image *a, const Image *r)
{
    double sum = 0;

    for (size_t i = 0; i < (size_t)a->w * a->h; i++) {
        Rgb d = rgb_sub(a->pixels[i], r->pixels[i]);
        sum += d.r * d.r + d.g * d.g + d.b * d.b;
    }
    return sqrt(sum / (3.0 * a->w * a->h));
}

/* A picture of one colour comes out as it went in, whatever the filter. */
static void even_pictures(void)
{
    for (int k = 0; denoisers[k]; k++)
        for (int how = 0; how < 4; how++) {
            Sample s = sample_init(0);
            Noisy in = noisy_of(&s, how & 1, how & 2);
            Image out;
            for (size_t i = 0; i < W * H; i++)
                s.noisy.pixels[i] = rgb(0.3f, 7.0f, 1e-3f);
            out = run(denoisers[k]->info.name, &in);
            for (size_t i = 0; i < W * H; i++) {
                Rgb c = out.pixels[i];
                EXPECT(fabsf(c.r - 0.3f) < 1e-5f && fabsf(c.g - 7) < 1e-4f &&
                       fabsf(c.b - 1e-3f) < 1e-6f, "%s %d: %g %g %g", denoisers[k]->info.name, how,
                       (double)c.r, (double)c.g, (double)c.b);
            }
            image_clear(&out);
            sample_clear(&s);
        }
}

/* Noise goes, by half at least, and no edge with it if it is known of or well above the noise. The
 * Gaussian blurs the edge: that is what it is; it must beat the noise off the edge. */
static void noise_goes(void)
{
    static const char *const names[] = { "guided", "nlmeans", "bilateral:range=0.5" };
    Sample s = sample_init(0.05f);
    double before = error_of(&s.noisy, &s.truth);

    EXPECT(fabs(before - 0.05) < 0.05 / sqrt(2.0 * 3 * W * H) * 4, "the noise is %g", before);
    for (int k = 0; k < 3; k++)
        for (int how = 0; how < 4; how++) {
            Noisy in = noisy_of(&s, how & 1, how & 2);
            Image out = run(names[k], &in);
            double e = error_of(&out, &s.truth);
            EXPECT(e < before / 2, "%s, guides %d, variance %d: %g of %g is left", names[k],
                   how & 1, how >> 1, e, before);
            image_clear(&out);
        }
    sample_clear(&s);
}

/* An edge of light that no guide knows of, far above the noise, stays; and so does a spot. */
static void shadows_stay(void)
{
    static const char *const names[] = { "guided", "nlmeans" };
    Sample s = sample_init(0.02f);

    for (uint32_t i = 0; i < W * H; i++) {
        float shade = i / W < H / 2 ? 0.0f : 2.0f;
        s.truth.pixels[i] = rgb_add(s.truth.pixels[i], rgb_all(shade));
        s.noisy.pixels[i] = rgb_add(s.noisy.pixels[i], rgb_all(shade));
    }
    for (int k = 0; k < 2; k++) {
        Noisy in = noisy_of(&s, true, true);
        Image out = run(names[k], &in);
        double worst = 0;
        for (size_t i = 0; i < W * H; i++)
            worst = fmax(worst, fabs((double)out.pixels[i].g - s.truth.pixels[i].g));
        EXPECT(worst < 0.1, "%s: %g of an edge of 2 and noise of 0.02", names[k], worst);
        EXPECT(error_of(&out, &s.truth) < 0.02, "%s: more error than before: %g", names[k],
               error_of(&out, &s.truth));
        image_clear(&out);
    }
    sample_clear(&s);
}

/* ---- naive twins ---- */

static double weight_at(const Image *im, int x, int y, double *sum, double sigma)
{
    double total = 0;

    *sum = 0;
    for (int v = 0; v < H; v++)
        for (int u = 0; u < W; u++)
            if (abs(u - x) <= 6 && abs(v - y) <= 6) {
                double w = exp(-((u - x) * (u - x) + (v - y) * (v - y)) / (2 * sigma * sigma));
                *sum += w * im->pixels[v * W + u].r;
                total += w;
            }
    return total;
}

static void gaussian_twin(void)
{
    Sample s = sample_init(0.1f);
    Noisy in = noisy_of(&s, false, false);
    Image out = run("gaussian:sigma=2", &in);

    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++) {
            double sum, total = weight_at(&s.noisy, x, y, &sum, 2);
            EXPECT(fabs(out.pixels[y * W + x].r - sum / total) < 1e-5, "%d,%d", x, y);
        }
    image_clear(&out);
    sample_clear(&s);
}

/* [Rousselle12 (4)] pixel by pixel, patch by patch. */
static double patch_distance(const Sample *s, int x, int y, int dx, int dy, int patch, double k)
{
    double d2 = 0;

    for (int j = -patch; j <= patch; j++)
        for (int i = -patch; i <= patch; i++) {
            int u = x + i < 0 ? 0 : x + i >= W ? W - 1 : x + i;
            int v = y + j < 0 ? 0 : y + j >= H ? H - 1 : y + j;
            int p = u + dx < 0 ? 0 : u + dx >= W ? W - 1 : u + dx;
            int q = v + dy < 0 ? 0 : v + dy >= H ? H - 1 : v + dy;
            const float *a = &s->noisy.pixels[v * W + u].r, *b = &s->noisy.pixels[q * W + p].r;
            const float *va = &s->variance.pixels[v * W + u].r;
            const float *vb = &s->variance.pixels[q * W + p].r;
            for (int c = 0; c < 3; c++)
                d2 += ((a[c] - b[c]) * (a[c] - b[c]) - (va[c] + fmin(va[c], vb[c]))) /
                      (1e-10 + k * k * (va[c] + vb[c])) / 3;
        }
    return d2 / ((2 * patch + 1) * (2 * patch + 1));
}

static void nlmeans_twin(void)
{
    enum { R = 3 };
    Sample s = sample_init(0.1f);
    Noisy in = noisy_of(&s, false, true);
    Image out;

    for (uint32_t i = 0; i < W * H; i++)        /* another variance for each pixel */
        s.variance.pixels[i] = rgb_scale(s.variance.pixels[i], 0.5f + (float)(i % 7) / 7.0f);
    out = run("nlmeans:radius=3,patch=2,k=0.6", &in);
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++) {
            double sum = 0, total = 0;
            for (int dy = -R; dy <= R; dy++)
                for (int dx = -R; dx <= R; dx++) {
                    double d2, w;
                    if (x + dx < 0 || x + dx >= W || y + dy < 0 || y + dy >= H)
                        continue;
                    d2 = patch_distance(&s, x, y, dx, dy, 2, 0.6);
                    w = exp(-fmax(d2, 0)) * (1 - dx * dx / 16.0) * (1 - dy * dy / 16.0);
                    sum += w * s.noisy.pixels[(y + dy) * W + x + dx].g;
                    total += w;
                }
            EXPECT(fabs(out.pixels[y * W + x].g - sum / total) < 1e-4, "%d,%d: %g, not %g", x, y,
                   (double)out.pixels[y * W + x].g, sum / total);
        }
    image_clear(&out);
    sample_clear(&s);
}

/* What is linear in the guides, the guided filter gives back. */
static void guided_exact(void)
{
    Sample s = sample_init(0);
    Noisy in;
    Image out;
    Rng r = rng_seed(3);

    for (size_t i = 0; i < W * H; i++) {
        Rgb a = rgb(rng_unit(&r), rng_unit(&r), rng_unit(&r));
        s.albedo.pixels[i] = a;
        s.noisy.pixels[i] = rgb(2 * a.r + a.g + 0.5f, 3 - a.b, a.r + a.g + a.b);
    }
    in = noisy_of(&s, true, true);
    out = run("guided:eps=1e-6", &in);
    for (size_t i = 0; i < W * H; i++)
        EXPECT(fabsf(out.pixels[i].r - s.noisy.pixels[i].r) < 1e-3f &&
               fabsf(out.pixels[i].b - s.noisy.pixels[i].b) < 1e-3f, "pixel %lu: %g, not %g",
               (unsigned long)i, (double)out.pixels[i].r, (double)s.noisy.pixels[i].r);
    image_clear(&out);
    sample_clear(&s);
}

/* The number of threads does not matter. */
static void threads(void)
{
    Sample s = sample_init(0.1f);

    for (int k = 0; denoisers[k]; k++) {
        Noisy in = noisy_of(&s, true, true);
        Image one, five;
        in.threads = 1;
        one = run(denoisers[k]->info.name, &in);
        in.threads = 5;
        five = run(denoisers[k]->info.name, &in);
        EXPECT(same_pixels(one.pixels, five.pixels, W * H), "%s", denoisers[k]->info.name);
        image_clear(&one);
        image_clear(&five);
    }
    sample_clear(&s);
}

static void fireflies(void)
{
    Image im = new_image(5, 4), v = new_image(5, 4);

    for (int i = 0; i < 20; i++) {
        im.pixels[i] = rgb_all(1 + (float)i / 100);
        v.pixels[i] = rgb_all(4);
    }
    im.pixels[12] = rgb(30, 60, 0);
    im.pixels[0] = rgb_all(1.5f);
    REQUIRE(fireflies_clamp(&im, &v, 2), "clamp");
    EXPECT(fabsf(rgb_lum(im.pixels[12]) - 2 * 1.18f) < 1e-5f, "%g", (double)rgb_lum(im.pixels[12]));
    EXPECT(im.pixels[12].g == 2 * im.pixels[12].r && im.pixels[12].b == 0, "the hue");
    EXPECT(fabsf(v.pixels[12].r / 4 - f_sqr(im.pixels[12].r / 30)) < 1e-6f, "its variance");
    EXPECT(im.pixels[0].r == 1.5f && im.pixels[11].r == 1.11f && v.pixels[0].r == 4, "others");
    image_clear(&im);
    image_clear(&v);
}

/* ---- as a user runs it ---- */

#define RENDER "tiny.pbrt --quiet --spp 8 --size 40x30 "

/* render --denoise is convert --denoise of a file that has the layers; a part filtered by itself
 * leaves the others as they are. */
static void program(void)
{
    Image raw, direct, indirect, out;

    cli_scene();
    CLI_WORKS(RENDER "-o n.exr --aov albedo=n.exr --aov normal=n.exr --aov depth=n.exr "
              "--aov variance=n.exr --aov emission=n.exr --aov direct=n.exr --aov indirect=n.exr "
              "--aov variance:indirect=n.exr");
    for (int k = 0; denoisers[k]; k++) {
        CLI_WORKS(RENDER "-o a.pfm --denoise %s --threads 3", denoisers[k]->info.name);
        CLI_WORKS("convert n.exr b.pfm --denoise %s", denoisers[k]->info.name);
        CLI_WORKS("convert n.exr c.pfm");
        EXPECT(cli_same_file("a.pfm", "b.pfm"), "%s: two pictures", denoisers[k]->info.name);
        EXPECT(!cli_same_file("a.pfm", "c.pfm"), "%s does nothing", denoisers[k]->info.name);
    }
    CLI_WORKS(RENDER "-o a.pfm --denoise indirect=gaussian");
    CLI_WORKS("convert n.exr b.pfm --denoise indirect=gaussian");
    EXPECT(cli_same_file("a.pfm", "b.pfm"), "of a part: two pictures");
    CLI_WORKS("convert --layer indirect n.exr i.pfm");
    CLI_WORKS("convert i.pfm f.pfm --denoise gaussian");
    REQUIRE(image_read(&raw, cli_path("c.pfm"), 9999) &&
            image_read(&indirect, cli_path("i.pfm"), 9999) &&
            image_read(&direct, cli_path("f.pfm"), 9999) &&
            image_read(&out, cli_path("a.pfm"), 9999), "files");
    for (size_t i = 0; i < 1200; i++) {
        float want = raw.pixels[i].g - indirect.pixels[i].g + direct.pixels[i].g;
        EXPECT(fabsf(out.pixels[i].g - want) <= 1e-5f * fmaxf(1, want), "pixel %lu",
               (unsigned long)i);
    }
    image_clear(&raw);
    image_clear(&indirect);
    image_clear(&direct);
    image_clear(&out);
    CLI_WORKS("convert c.pfm d.pfm --denoise nlmeans --guide albedo=n.exr");
    CLI_WORKS(RENDER "-o a.pfm --fireflies 1");
    EXPECT(!cli_same_file("a.pfm", "c.pfm"), "--fireflies does nothing");
    CLI_WORKS(RENDER "-o a.pfm --integrator light --denoise direct=nlmeans --denoise "
              "indirect=guided --fireflies 3");
}

static void wrong_lines(void)
{
    cli_scene();
    CLI_FAILS(STATUS_INPUT, "sky.pfm: has no layer 'direct' to filter (--guide direct=FILE gives "
              "one)", "convert sky.pfm a.pfm --denoise direct=guided");
    CLI_FAILS(STATUS_INPUT, "wood.ppm: 'albedo' has 2x2 pixels, the picture has 8x4",
              "convert sky.pfm a.pfm --denoise guided --guide albedo=wood.ppm");
    CLI_FAILS(STATUS_USAGE, "--denoise filters the picture or parts of it, not both",
              "tiny.pbrt --denoise guided --denoise direct=guided");
    CLI_FAILS(STATUS_USAGE, "--denoise PART=NAME takes emission, direct or indirect",
              "tiny.pbrt --denoise picture=guided");
    CLI_FAILS(STATUS_USAGE, "--fireflies '0.5' is not right, expected a number from 1 to "
              "1000000000", "tiny.pbrt --fireflies 0.5");
}

const TestCase test_denoise[] = {
    { "even_pictures", even_pictures, false },
    { "noise_goes", noise_goes, false },
    { "shadows_stay", shadows_stay, false },
    { "gaussian_twin", gaussian_twin, false },
    { "nlmeans_twin", nlmeans_twin, false },
    { "guided_exact", guided_exact, false },
    { "threads", threads, false },
    { "fireflies", fireflies, false },
    { "program", program, false },
    { "wrong_lines", wrong_lines, false },
    { NULL, NULL, false }
};

/* test_twostage_sky.c -- two stage importance sampling of the sky by colour, and of the clear one.
 *
 * Colour      the light of other strategies; less noise where light and things have colours.
 * Maps        every strategy that samples products against path tracing, with things in between and
 *             without: one bright pixel, a black half, a constant, 1 x 1, 4096 x 2048.
 * Clear sky   its map leaves out the sun, which is asked as other lights are, and met by chance. */
#include "integrators/integrator.h"
#include "test/twostage_help.h"

enum { SIDE = 16 };

/* ---- by colour ---- */

/* Red light from the left, blue from the right, on red things: half of the samples by luminance go
 * where nothing comes back. */
static Rgb red_blue(V3 w) { return w.x < 0 ? rgb(1, 0, 0) : rgb(0, 0, 2.9f); }

static void colour_pays(void)
{
    double luminance, colour;
    Lab l;

    lab_init(&l);
    lab_quad(&l, v3(-4, -5, 0), v3(10, 0, 0), v3(0, 10, 0),
             lab_material(&l, "diffuse", "reflectance=0.8/0.02/0.01"));
    lab_sky(&l, 64, 32, red_blue, NULL);
    lab_build(&l);
    luminance = noise_of(&l, "direct:strategy=twostage,samples=3,f=luminance", 0);
    colour = noise_of(&l, "direct:strategy=twostage,samples=3,f=colour", 0);
    EXPECT(colour < 0.8 * luminance, "by colour: error %.8f, by luminance: %.8f", colour,
           luminance);
    messages_quiet(true);
    {
        Opts o;
        const IntegratorKind *k = lab_method(&l, "direct:strategy=triple,f=colour", &o);
        EXPECT(!k->open(l.scene, &o), "triple has no maps of colour");
    }
    lab_clear(&l);
}

static void by_colour(void)
{
    static const Way ways[] = {
        { "direct:strategy=twostage,f=colour,samples=4", 2, 0.16 },
        { "direct:strategy=twostage,f=colour,samples=5,peaks=sampled", 2, 0.16 },
        { "path:strategy=twostage,f=colour,maxdepth=1", 4, 0.16 },
        { NULL, 0, 0 }
    };

    for (int k = 0; k < 3; k++) {
        Lab l;
        lab_init(&l);
        add_things(&l, k == 1);
        lab_sky_as(&l, k == 2 ? 32 : 64, 32, k == 0 ? red_blue : sky_cloudy, NULL,
                   k == 2 ? "mapping=octahedral" : "");
        add_eye(&l);
        ways_agree(&l, SIDE, "path:maxdepth=1", 32, ways, k == 0 ? "red and blue" : "cloudy");
        lab_clear(&l);
    }
}

/* ---- a clear sky ---- */

static const Way under_sky[] = {
    { "direct:strategy=twostage,samples=4", 3, 0.17 },
    { "direct:strategy=triple,samples=4", 3, 0.17 },
    { "path:strategy=twostage,maxdepth=1", 8, 0.17 },
    { "path:strategy=twostage,maxdepth=1,f=colour,lightsampler=power", 8, 0.17 },
    { NULL, 0, 0 }
};

/* With its sun, alone, without, with a wide one; turned; the sun alone. */
static void clear_skies(void)
{
    static const char *const options[] = {
        "sundirection=0.5/-0.6/0.4,scale=0.03", "sunscale=0,scale=0.2",
        "sundirection=0.5/-0.6/0.4,scale=0.03,sunsize=20", "skyscale=0,scale=0.03,albedo=0"
    };
    Transform turn = xf_rotate(40, 1, 2, 0.5);

    for (int k = 0; k < (test_is_long() ? 4 : 2); k++) {
        Lab l;
        lab_init(&l);
        add_things(&l, k % 2 == 0);
        lab_light(&l, "sky", options[k], k == 2 ? &turn : NULL);
        if (k == 1)
            lab_shine(&l, lab_disk(&l, v3(0.9f, 0, 2.6f), v3(-0.3f, -0.2f, -1), 0.4f, 0,
                                   lab_material(&l, "diffuse", "reflectance=0")), "L=3/2/1");
        add_eye(&l);
        ways_agree(&l, SIDE, "path:maxdepth=1", 16, under_sky, options[k]);
        lab_clear(&l);
    }
}

/* ---- maps ---- */

static Rgb one_bright(V3 w)
{
    return rgb_all(v_dot(w, v_unit(v3(0.6f, -0.6f, 0.7f))) > 0.995f ? 100.0f : 0.1f);
}
static Rgb half_black(V3 w) { return rgb_all(w.x > 0.0f ? 1.0f + 0.5f * w.z : 0.0f); }
static Rgb even(V3 w) { (void)w; return rgb(0.5f, 0.6f, 0.8f); }

static const Way products[] = {
    { "direct:strategy=twostage,samples=4", 2, 0.25 },
    { "direct:strategy=twostage,samples=3,peaks=sampled,f=colour", 2, 0.25 },
    { "direct:strategy=triple,samples=4", 2, 0.25 },
    { "direct:strategy=triple,samples=4,lazy=true,space=world", 2, 0.25 },
    { "direct:strategy=cut,points=1024,clusters=60,samples=4", 3, 0.25 },
    { "direct:strategy=sir,points=1024,tentative=16,samples=4", 3, 0.25 },
    { "path:strategy=twostage,maxdepth=1", 6, 0.25 },
    { NULL, 0, 0 }
};

static void on_maps(int first, int end)
{
    static const struct { const char *name; uint32_t w, h; Rgb (*f)(V3 w); } map[] = {
        { "one bright", 48, 24, one_bright }, { "black half", 40, 20, half_black },
        { "constant", 64, 32, even }, { "1 x 1", 1, 1, even },
        { "large, bright", 4096, 2048, one_bright }, { "large", 4096, 2048, sky_cloudy }
    };

    for (int k = 2 * first; k < 2 * end; k++) {
        char what[60];
        Lab l;
        lab_init(&l);
        add_things(&l, k % 2);
        lab_sky_as(&l, map[k / 2].w, map[k / 2].h, map[k / 2].f, NULL, "mapping=latlong");
        add_eye(&l);
        snprintf(what, sizeof what, "%s%s", map[k / 2].name, k % 2 ? ", covered" : "");
        ways_agree(&l, SIDE, "path:maxdepth=1", 24, products, what);
        lab_clear(&l);
    }
}

static void maps(void) { on_maps(0, 4); }
static void large_maps(void) { on_maps(4, 6); }

const TestCase test_twostage_sky[] = {
    { "colour", by_colour, false }, { "colour_pays", colour_pays, false },
    { "maps", maps, false }, { "large_maps", large_maps, true },
    { "clear_skies", clear_skies, false }, { NULL, NULL, false }
};

/* test_scenes.c -- the scenes of scenes/: each is read without a word, and a small picture of it
 * holds light and nothing but finite numbers. */
#include "image/image.h"
#include "test/cli_help.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { MOST = 100, SIDE = 64 };

static int by_name(const void *a, const void *b) { return strcmp(a, b); }

/* The scenes number k, k + step, ...; returns how many there are. */
static int names(char name[MOST][100])
{
    DIR *d = opendir("scenes");
    struct dirent *e;
    int n = 0;

    if (!d)
        test_skip("the folder of scenes is not here");
    while ((e = readdir(d)) != NULL) {
        size_t len = strlen(e->d_name);
        if (len > 5 && len < 90 && !strcmp(e->d_name + len - 5, ".pbrt") && n < MOST)
            strcpy(name[n++], e->d_name);
    }
    closedir(d);
    qsort(name, (size_t)n, sizeof name[0], by_name);
    EXPECT(n >= 38 && n < MOST, "%d scenes", n);
    return n;
}

/* The first line of each says what it is for: a comment. */
static void look(const char *name)
{
    char path[600], folder[400], line[300];
    const char *out = cli_path("picture.pfm");
    double sum = 0;
    Image im;
    FILE *f;
    Cli c;

    REQUIRE(getcwd(folder, sizeof folder), "no folder");
    snprintf(path, sizeof path, "%s/scenes/%s", folder, name);
    f = fopen(path, "r");
    EXPECT(f && fgets(line, sizeof line, f) && line[0] == '#' && strlen(line) > 20,
           "%s does not say what it is for", path);
    if (f)
        fclose(f);
    c = cli("render %s --size %dx%d --spp 2 --quiet --threads 1 -o %s", path, SIDE, SIDE, out);
    EXPECT(c.status == 0 && !*c.err, "%s is not read without a word: %s", path, c.err);
    REQUIRE(image_read(&im, out, IMAGE_PIXELS_DEFAULT), "%s: no picture", path);
    EXPECT(im.w == SIDE && im.h == SIDE, "%s: %lu x %lu", path, (unsigned long)im.w,
           (unsigned long)im.h);
    for (size_t i = 0; i < (size_t)im.w * im.h; i++) {
        EXPECT(rgb_finite(im.pixels[i]), "%s: pixel %lu", path, (unsigned long)i);
        sum += (double)rgb_lum(im.pixels[i]);
    }
    /* A picture is exposed so that 1 is white; two samples of dim scenes miss most of the light. */
    EXPECT(sum / (SIDE * SIDE) > 0.005 && sum / (SIDE * SIDE) < 20, "%s: mean %g", path,
           sum / (SIDE * SIDE));
    image_clear(&im);
}

/* Two cases share the work of two processors. */
static void half(int first)
{
    static char name[MOST][100];
    int n = names(name);
    for (int i = first; i < n; i += 2)
        look(name[i]);
}
static void even(void) { half(0); }
static void odd(void) { half(1); }

const TestCase test_scenes[] = {
    { "even", even, false },
    { "odd", odd, false },
    { NULL, NULL, false }
};

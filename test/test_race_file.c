/* test_race_file.c -- files of races: what they mean, where they are wrong, and hostile ones. Under
 * ASan (make check V=asan) the last also show that nothing is read out of bounds: the text stands
 * in a block of exactly its size. */
#include "base/mem.h"
#include "base/random.h"
#include "render/race.h"
#include "test/mesh_help.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char whole[] =
    "# all there is\n"
    "Scene \"plates.pbrt\" Size 240 170 Crop 0 10 240 [\n";

static const char good[] =
    "# all there is\n"
    "Scene \"plates.pbrt\" Size 240 170\nCrop 0 10 240 100\n"
    "Spp 6 Time [ 1 2.5 ] Seed 7 Threads 2\n"
    "Sampler \"random\" Filter \"box\" Accelerator \"wide\"\n"
    "Reference \"auto\" \"integer spp\" 99 \"float seconds\" 1.5\n"
    "  Integrator \"ao\" Sampler \"random\"\n"
    "Method \"one\" Integrator \"path\" \"string strategy\" \"implicit\" \"integer maxdepth\" 3\n"
    "Method \"two, \\\"2\\\"\" Sampler \"zerotwo\" Integrator \"ao\"\n"
    "Output \"a.pfm\" \"b.png\" Autosave [1 5 20] Csv \"c.csv\" Plot \"d.svg\" Output \"e.hdr\"\n";

static const char files[] = "Reference \"r.pfm\" \"q.pfm\" Scene \"/s.ply\"";

static bool parse(RaceOrder *o, const char *text, size_t n)
{
    ReadLimits limits = READ_LIMITS_DEFAULT;
    memset(o, 0, sizeof *o);
    err_reset();
    return race_file_parse(o, "dir/x.race", text, n, &limits);
}

static void meaning(void)
{
    static RaceOrder o;

    REQUIRE(parse(&o, good, strlen(good)), "refused");
    EXPECT(!strcmp(o.scene, "dir/plates.pbrt") && o.request.w == 240 && o.request.h == 170 &&
           o.request.crop_given && o.request.crop[1] == 10 && o.request.crop[3] == 100, "picture");
    EXPECT(o.nspp == 4 && o.spp[2] == 4 && o.spp[3] == 6 && o.nseconds == 2 && o.seconds[1] == 2.5,
           "checkpoints");
    EXPECT(o.request.seed_given && o.request.seed == 7 && o.request.threads == 2, "seed, threads");
    EXPECT(!strcmp(o.sampler.name, "random") && !strcmp(o.filter.name, "box") &&
           !strcmp(o.accelerator.name, "wide"), "of all");
    EXPECT(o.reference == REFERENCE_AUTO && o.reference_spp == 99 && o.reference_seconds == 1.5 &&
           !strcmp(o.reference_method.integrator->info.name, "ao") &&
           !strcmp(o.reference_method.sampler->info.name, "random"), "reference");
    REQUIRE(o.nmethods == 2, "%d methods", o.nmethods);
    EXPECT(!strcmp(o.method[0].label, "one") && !o.method[0].sampler &&
           opt_is(&o.method[0].integrator_opts, "strategy", "implicit") &&
           opt_int(&o.method[0].integrator_opts, "maxdepth") == 3, "method 1");
    EXPECT(!strcmp(o.method[1].label, "two, \"2\"") &&
           !strcmp(o.method[1].sampler->info.name, "zerotwo") &&
           !strcmp(o.method[1].integrator->info.name, "ao"), "method 2: %s", o.method[1].label);
    EXPECT(o.noutputs == 3 && !strcmp(o.outputs[1], "b.png") && !strcmp(o.outputs[2], "e.hdr") &&
           o.nautosave == 3 && o.autosave[2] == 20 && !strcmp(o.csv, "c.csv") &&
           !strcmp(o.plot, "d.svg"), "outputs");
    EXPECT(warnings_count() == 0, "warnings");
    race_order_clear(&o);
    REQUIRE(parse(&o, files, strlen(files)), "files");
    EXPECT(!strcmp(o.reference_file[0], "dir/r.pfm") && !strcmp(o.reference_file[1], "dir/q.pfm") &&
           !strcmp(o.scene, "/s.ply") && o.reference == REFERENCE_FILES, "files");
    race_order_clear(&o);
}

/* The one that people copy from. */
static void example(void)
{
    ReadLimits limits = READ_LIMITS_DEFAULT;
    static RaceOrder o;

    REQUIRE(race_file_read(&o, "scenes/plates.race", &limits) && warnings_count() == 0, "refused");
    EXPECT(o.nmethods == 4 && !strcmp(o.scene, "scenes/plates.pbrt") && file_exists(o.scene) &&
           o.reference == REFERENCE_AUTO && o.csv && o.plot && o.noutputs == 1, "it says less");
    race_order_clear(&o);
}

/* The end may be left open: "...*", where sets that grow are told. */
static bool says(const char *line, const char *expected)
{
    size_t n = strlen(expected);
    bool open = n && expected[n - 1] == '*';

    if (strncmp(line, "rushlight: ", 11))
        return false;
    return open ? !strncmp(line + 11, expected, n - 1) : !strcmp(line + 11, expected);
}

static void wrong(void)
{
    static const struct { const char *text, *error; } c[] = {
        { "", "dir/x.race: the race has no Scene" },
        { "Scene \"a\"\nMethod \"m\"",
          "dir/x.race:2:1: the method \"m\" has no Integrator" },
        { "Methd \"m\"", "dir/x.race:1:1: unknown directive 'Methd', did you mean 'Method'?" },
        { "\n  \"path\"", "dir/x.race:2:3: expected a directive" },
        { "Scene 5", "dir/x.race:1:7: expected the name of the scene's file in quotes" },
        { "Scene \"\"", "dir/x.race:1:7: expected the name of the scene's file, the string is "
          "empty" },
        { "Scene \"a\" Scene \"b\"", "dir/x.race:1:11: Scene was given before" },
        { "Size 10", "dir/x.race:1:8: expected a whole number from 1 to 2147483647" },
        { "Size 10 1.5", "dir/x.race:1:9: expected a whole number from 1 to 2147483647" },
        { "Crop 5 0 5 9", "dir/x.race:1:1: Crop is not right, expected x0 y0 x1 y1 with x0 < x1 "
          "and y0 < y1" },
        { "Threads 0", "dir/x.race:1:9: expected a whole number from 1 to 256" },
        { "Seed -1", "dir/x.race:1:6: expected a whole number from 0 to 9007199254740992" },
        { "Spp [ 4 2 ]", "dir/x.race:1:5: Spp is not right, expected whole numbers from 1 on that "
          "rise" },
        { "Spp [ ]", "dir/x.race:1:7: expected a number or ']'" },
        { "Spp [ 4", "dir/x.race:1:8: expected a number or ']'" },
        { "Spp x", "dir/x.race:1:5: expected a number or a list of them" },
        { "Time 0", "dir/x.race:1:6: Time is not right, expected seconds from 0.001 to 1e9 that "
          "rise" },
        { "Autosave [1 1]", "dir/x.race:1:10: Autosave is not right, expected seconds from 0.001 "
          "to 1e9 that rise" },
        { "Integrator \"path\"", "dir/x.race:1:1: Integrator stands before any Method" },
        { "Method \"m\" Integrator \"pth\"",
          "dir/x.race:1:23: unknown integrator 'pth', did you mean 'path'? (have:*" },
        { "Method \"m\" Integrator \"path\" \"integer maxdeth\" 4",
          "dir/x.race:1:30: path has no parameter 'maxdeth', did you mean 'maxdepth'?" },
        { "Method \"m\" Integrator \"path\" \"float maxdepth\" 0.5",
          "dir/x.race:1:30: \"float maxdepth\" is not right, expected a whole number from 0 to "
          "100000" },
        { "Method \"m\" Integrator \"path\" \"texture maxdepth\" \"t\"",
          "dir/x.race:1:30: path takes no textures" },
        { "Method \"m\"\nMethod \"n\"", "dir/x.race:1:1: the method \"m\" has no Integrator" },
        { "Sampler \"randm\"",
          "dir/x.race:1:9: unknown sampler 'randm', did you mean 'random'? (have:*" },
        { "Output \"a.gif\"",
          "dir/x.race:1:8: 'a.gif' is of no format that can be written, one of these was "
          "expected: *" },
        { "Output", "dir/x.race:1:7: expected the name of a picture in quotes" },
        { "Reference \"a.pfm\" \"integer spp\" 4",
          "dir/x.race:1:1: only the reference \"auto\" has parameters" },
        { "Reference \"auto\" \"integer sp\" 4",
          "dir/x.race:1:18: Reference has no parameter 'sp', did you mean 'spp'?" },
        { "Scene \"a\" Reference \"pair\" Integrator \"path\"",
          "dir/x.race:1:11: only the reference \"auto\" has an Integrator" },
        { "Plot \"a", "dir/x.race:1:6: the string has no end, expected '\"'" },
    };
    static RaceOrder o;
    char line[2000];

    messages_start();
    for (size_t i = 0; i < sizeof c / sizeof *c; i++) {
        bool ok = parse(&o, c[i].text, strlen(c[i].text));
        int lines = messages_take(line, sizeof line);
        EXPECT(!ok && lines == 1 && err_status() == STATUS_INPUT, "%s: %d lines: %s", c[i].text,
               lines, line);
        EXPECT(says(line, c[i].error), "%s: %s", c[i].text, line);
        race_order_clear(&o);
    }
}

/* ---- hostile ones ---- */

static bool try_text(const char *text, size_t n, const char *what)
{
    static RaceOrder o;
    char *block = malloc(n ? n : 1);
    const char *fault = NULL;
    bool ok;

    REQUIRE(block, "memory");
    memcpy(block, text, n);
    mem_fail_at(0, false);
    ok = parse(&o, block, n);
    race_order_clear(&o);
    free(block);
    if (mem_blocks())
        fault = "something is kept";
    else if (mem_peak() > 16 * n + (1 << 20))
        fault = "too much memory";
    else if (ok ? err_status() != STATUS_OK : err_status() != STATUS_INPUT)
        fault = "a status that does not fit";
    EXPECT(!fault, "%s: %s: %.*s", what, fault, (int)n, text);
    return ok;
}

static void hostile(void)
{
    static const char insert[] = { 0, '\n', ' ', '-', '9', '"', '[', ']', (char)255 };
    size_t n = strlen(good);
    char changed[sizeof good + 1];
    long read = 0, tried = 0;
    Rng rng = rng_seed(1);

    messages_nowhere();
    EXPECT(try_text(good, n, "the seed") && !try_text(whole, strlen(whole), "half a list"), "seed");
    for (size_t i = 0; i < n; i++) {
        try_text(good, i, "a beginning");
        memcpy(changed, good, n);
        for (int k = 0; k < 24; k++, tried++) {
            changed[i] = (char)rng_below(&rng, 256);
            read += try_text(changed, n, "a byte changed");
        }
        memcpy(changed + i, good + i + 1, n - i - 1);
        try_text(changed, n - 1, "a byte left out");
        for (size_t k = 0; k < sizeof insert; k++) {
            changed[i] = insert[k];
            memcpy(changed + i + 1, good + i, n - i);
            try_text(changed, n + 1, "a byte put in");
        }
    }
    EXPECT(read > tried / 100 && read < tried, "%ld of %ld were read", read, tried);
}

/* Every allocation fails once: an error of memory, and nothing is kept. */
static void no_memory(void)
{
    static RaceOrder o;
    bool ok = false;

    messages_nowhere();
    for (unsigned long k = 1; !ok; k++) {
        REQUIRE(k < 1000, "it never ends");
        mem_fail_at(k, true);
        ok = parse(&o, good, strlen(good));
        race_order_clear(&o);
        mem_fail_at(0, false);
        EXPECT(mem_blocks() == 0 && err_status() == (ok ? STATUS_OK : STATUS_OUTPUT),
               "failure %lu: status %d, %ld blocks", k, (int)err_status(), mem_blocks());
    }
}

const TestCase test_race_file[] = {
    { "meaning", meaning, false },
    { "example", example, false },
    { "wrong", wrong, false },
    { "hostile", hostile, false },
    { "no_memory", no_memory, false },
    { NULL, NULL, false }
};

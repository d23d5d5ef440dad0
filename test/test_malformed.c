/* test_malformed.c -- broken files that other programs crashed on, and broken ones of known kinds,
 * through the whole program: named on the command line, and named by a scene. Each run ends with a
 * result, or with one line of error and status 3 and no output. Warnings may stand before. */
#include "base/file.h"
#include "cli/args.h"
#include "test/cli_help.h"

#include <dirent.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { FILES = 400 };

static char *files[FILES];
static int   nfiles;

static int by_name(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

/* The files of the folders of malformed/, by absolute name: runs are in a folder of their own. */
static void find_files(void)
{
    static char text[FILES][500];
    const char *data = test_data("malformed");
    char here[200], root[300];
    DIR *d = opendir(data);

    REQUIRE(d && getcwd(here, sizeof here), "no folder");
    snprintf(root, sizeof root, "%s%s%s", data[0] == '/' ? "" : here, data[0] == '/' ? "" : "/",
             data);
    for (struct dirent *e; (e = readdir(d)) != NULL; ) {
        char folder[400];
        DIR *sub;
        snprintf(folder, sizeof folder, "%s/%.90s", root, e->d_name);
        sub = e->d_name[0] == '.' ? NULL : opendir(folder);
        if (!sub)
            continue;
        for (struct dirent *f; nfiles < FILES && (f = readdir(sub)) != NULL; )
            if (f->d_name[0] != '.') {
                snprintf(text[nfiles], sizeof text[0], "%s/%.90s", folder, f->d_name);
                files[nfiles] = text[nfiles];
                nfiles++;
            }
        closedir(sub);
    }
    closedir(d);
    qsort(files, (size_t)nfiles, sizeof *files, by_name);
    REQUIRE(nfiles >= 30, "only %d files", nfiles);
}

/* Lines that are no warnings; -1 if one is not ours. */
static int error_lines(const char *err)
{
    const char *word;
    int n = 0;

    for (const char *p = err; *p; p = strchr(p, '\n') + 1) {
        if (strncmp(p, "rushlight: ", 11) || !strchr(p, '\n'))
            return -1;
        word = strstr(p, "warning: ");
        n += !word || word > strchr(p, '\n');
    }
    return n;
}

static bool is_there(const char *name)
{
    size_t n;
    return cli_read(name, &n) != NULL;
}

/* output: what it writes, or NULL. */
static void expect_end(const Cli *c, const char *what, const char *file, const char *output)
{
    EXPECT(c->status == STATUS_OK || c->status == STATUS_INPUT, "%s %s: status %d: %s", what, file,
           c->status, c->err);
    EXPECT(error_lines(c->err) == (c->status != 0), "%s %s: status %d, and it says: %s", what, file,
           c->status, c->err);
    if (output) {
        EXPECT(is_there(output) == (c->status == 0), "%s %s: status %d, output or not", what, file,
               c->status);
        remove(cli_path(output));
    }
}

static void named(void)
{
    int fine = 0;

    find_files();
    for (int i = 0; i < nfiles; i++) {
        Cli c = cli("info %s", files[i]);
        expect_end(&c, "info", files[i], NULL);
        fine += c.status == 0;
        c = cli("convert %s x.pfm", files[i]);
        expect_end(&c, "convert", files[i], "x.pfm");
        c = cli("render %s --quiet --size 8x8 --spp 1 -o x.pfm", files[i]);
        expect_end(&c, "render", files[i], "x.pfm");
        c = cli("compare %s %s --diff x.pfm", files[i], files[i]);
        expect_end(&c, "compare", files[i], "x.pfm");
    }
    EXPECT(fine < nfiles, "all of %d files are fine", nfiles);
    EXPECT(!cli_folder()[0], "left: %s", cli_folder());
}

/* A scene that names the file; what it says must tell the file or the place in the scene. */
static void by_scene(const char *file, const char *format)
{
    char text[1000];
    Cli c;

    strcpy(text, "Camera \"perspective\"\nWorldBegin\nLightSource \"distant\"\n");
    snprintf(text + strlen(text), sizeof text - strlen(text), format, file);
    cli_write_text("s.pbrt", text);
    c = cli("s.pbrt --quiet --size 8x8 --spp 1 -o x.pfm");
    expect_end(&c, "a scene with", file, "x.pfm");
    EXPECT(c.status == 0 || strstr(c.err, file) || strstr(c.err, "s.pbrt:"), "%s: it says: %s",
           file, c.err);
}

static void named_by_scenes(void)
{
    find_files();
    for (int i = 0; i < nfiles; i++) {
        const char *ext = path_extension(files[i]);
        if (!strcmp(ext, "ply"))
            by_scene(files[i], "Shape \"plymesh\" \"string filename\" \"%s\"\n");
        else if (!strcmp(ext, "obj"))
            by_scene(files[i], "Shape \"obj\" \"string filename\" \"%s\"\n");
        else {
            by_scene(files[i], "LightSource \"infinite\" \"string filename\" \"%s\"\n");
            by_scene(files[i], "Texture \"t\" \"spectrum\" \"imagemap\" "
                               "\"string filename\" \"%s\"\n"
                               "Material \"diffuse\" \"texture reflectance\" \"t\"\n"
                               "Shape \"sphere\"\n");
        }
    }
}

const TestCase test_malformed[] = {
    { "named", named, false },
    { "named_by_scenes", named_by_scenes, false },
    { NULL, NULL, false }
};

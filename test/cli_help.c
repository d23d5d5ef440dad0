/* cli_help.c -- see cli_help.h. */
#include "test/cli_help.h"

#include "base/mem.h"
#include "cli/args.h"
#include "image/image.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { WORDS = 64, LINE = 4000, SECONDS = 100 };

/* ---- the process ---- */

static int open_descriptors(void)
{
    int n = 0;
    for (int fd = 3; fd < 64; fd++)
        n += fcntl(fd, F_GETFD) >= 0;
    return n;
}

/* Standard error may be closed by `setup`; then a leak shows in the status. */
static void run_child(void (*setup)(void), char **words, int n, FILE *const stream[2])
{
    int status, before;
    long blocks = mem_blocks();

    alarm(SECONDS);
    if (chdir(test_folder()) || dup2(fileno(stream[0]), 1) < 0 || dup2(fileno(stream[1]), 2) < 0)
        _exit(99);
    if (setup)
        setup();
    before = open_descriptors();
    status = cli_run(n, words);
    if (mem_blocks() != blocks) {
        fprintf(stderr, "LEAK: %ld blocks\n", mem_blocks() - blocks);
        status = 98;
    }
    if (open_descriptors() != before) {
        fprintf(stderr, "LEAK: %d descriptors\n", open_descriptors() - before);
        status = 97;
    }
    fflush(stdout);
    _exit(status);
}

char *cli_text(const char *fmt, ...)
{
    static char line[LINE];
    va_list args;
    va_start(args, fmt);
    vsnprintf(line, sizeof line, fmt, args);
    va_end(args);
    return line;
}

Cli cli_start_line(void (*setup)(void), char *line)
{
    char *words[WORDS] = { (char *)"rushlight" }, *next;
    int n = 1;
    Cli c;

    for (char *p = line + strspn(line, " "); *p && n < WORDS - 1; p = next) {
        next = p + strcspn(p, " ");
        if (*next)
            *next++ = 0;
        next += strspn(next, " ");
        words[n++] = strcmp(p, "''") ? p : p + 2;
    }
    test_folder();                          /* made here, not by the child */
    c.status = -1;
    c.out = c.err = NULL;
    for (int k = 0; k < 2; k++) {
        c.stream[k] = tmpfile();
        REQUIRE(c.stream[k], "tmpfile: %s", strerror(errno));
    }
    fflush(NULL);
    c.pid = fork();
    REQUIRE(c.pid >= 0, "fork: %s", strerror(errno));
    if (c.pid == 0)
        run_child(setup, words, n, c.stream);
    return c;
}

static char *all_of(FILE *f, size_t *n)
{
    long size = (fseek(f, 0, SEEK_END), ftell(f));
    char *text = malloc((size_t)size + 1);
    REQUIRE(text && size >= 0, "no memory");
    rewind(f);
    *n = fread(text, 1, (size_t)size, f);
    text[*n] = 0;
    return text;
}

/* Reachable until the process ends, so that no leak checker minds. */
static char *keep(char *text)
{
    static char **kept;
    static size_t n, room;
    if (n == room) {
        room = 2 * room + 16;
        kept = realloc(kept, room * sizeof *kept);
        REQUIRE(kept, "no memory");
    }
    return kept[n++] = text;
}

void cli_wait(Cli *c)
{
    int status;
    size_t n;

    while (waitpid(c->pid, &status, 0) < 0)
        REQUIRE(errno == EINTR, "waitpid: %s", strerror(errno));
    c->status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    c->out = keep(all_of(c->stream[0], &n));
    c->err = keep(all_of(c->stream[1], &n));
    fclose(c->stream[0]);
    fclose(c->stream[1]);
}

/* The position of the stream is shared with the child, so this reads by pread. */
void cli_await(const Cli *c, const char *text)
{
    const struct timespec pause = { 0, 2000000 };
    char have[LINE];

    for (;;) {
        ssize_t n = pread(fileno(c->stream[1]), have, sizeof have - 1, 0);
        REQUIRE(n >= 0, "pread: %s", strerror(errno));
        have[n] = 0;
        if (strstr(have, text))
            return;
        REQUIRE(waitpid(c->pid, NULL, WNOHANG) == 0, "ended before '%s': %s", text, have);
        nanosleep(&pause, NULL);
    }
}

Cli cli_line(char *line)
{
    Cli c = cli_start_line(NULL, line);
    cli_wait(&c);
    return c;
}

/* ---- what came of it ---- */

int cli_lines(const char *text)
{
    int n = 0;
    for (; *text; text++)
        n += *text == '\n';
    return n;
}

void cli_expect(const char *file, int line, Cli c, int status, const char *err)
{
    if (c.status != status)
        test_fail(file, line, "exit status %d, not %d; it says: %s", c.status, status, c.err);
    else if (err && strcmp(c.err, err))
        test_fail(file, line, "it says: %snot: %s", c.err, err);
}

Cli cli_fails(const char *file, int line, int status, const char *err, Cli c)
{
    char want[LINE];
    if (err)
        snprintf(want, sizeof want, "rushlight: %s\n", err);
    cli_expect(file, line, c, status, err ? want : NULL);
    return c;
}

/* ---- files ---- */

const char *cli_path(const char *name)
{
    static char path[8][600];
    static int turn;
    char *p = path[turn++ & 7];
    snprintf(p, sizeof path[0], "%s/%s", test_folder(), name);
    return p;
}

void cli_write(const char *name, const void *bytes, size_t n)
{
    FILE *f = fopen(cli_path(name), "wb");
    REQUIRE(f && fwrite(bytes, 1, n, f) == n && !fclose(f), "cannot write %s", name);
}

void cli_write_text(const char *name, const char *text) { cli_write(name, text, strlen(text)); }

static char *bytes_of(const char *name, size_t *n)
{
    FILE *f = fopen(cli_path(name), "rb");
    char *bytes;

    *n = 0;
    if (!f)
        return NULL;
    bytes = all_of(f, n);
    fclose(f);
    return bytes;
}

char *cli_read(const char *name, size_t *n)
{
    char *bytes = bytes_of(name, n);
    return bytes ? keep(bytes) : NULL;
}

bool cli_same_file(const char *a, const char *b)
{
    size_t na, nb;
    char *x = bytes_of(a, &na), *y = bytes_of(b, &nb);
    bool same = x && y && na == nb && !memcmp(x, y, na);
    free(x);
    free(y);
    return same;
}

static int by_name(const void *a, const void *b)
{
    return strcmp((const char *)a, (const char *)b);
}

const char *cli_folder(void)
{
    static char all[2000];
    char names[24][80];
    int n = 0;
    DIR *d = opendir(test_folder());

    REQUIRE(d, "opendir: %s", strerror(errno));
    for (struct dirent *e; n < 24 && (e = readdir(d)) != NULL; )
        if (strcmp(e->d_name, ".") && strcmp(e->d_name, ".."))
            snprintf(names[n++], sizeof names[0], "%.79s", e->d_name);
    closedir(d);
    qsort(names, (size_t)n, sizeof names[0], by_name);
    all[0] = 0;
    for (int i = 0; i < n; i++) {
        strcat(all, names[i]);
        strcat(all, " ");
    }
    return all;
}

/* ---- the small scene ---- */

const char cli_scene_text[] =
    "LookAt 0 -5 2  0 0 0.5  0 0 1\n"
    "Camera \"perspective\" \"float fov\" [ 40 ]\n"
    "Film \"rgb\" \"integer xresolution\" [ 16 ] \"integer yresolution\" [ 12 ]\n"
    "Sampler \"zerotwo\" \"integer pixelsamples\" [ 2 ]\n"
    "Integrator \"path\" \"integer maxdepth\" [ 4 ]\n"
    "WorldBegin\n"
    "LightSource \"infinite\" \"string filename\" \"sky.pfm\"\n"
    "AttributeBegin\n"
    "  AreaLightSource \"diffuse\" \"rgb L\" [ 8 6 4 ]\n"
    "  Translate 1.5 -0.5 2.5\n"
    "  Shape \"sphere\" \"float radius\" [ 0.4 ]\n"
    "AttributeEnd\n"
    "Texture \"wood\" \"spectrum\" \"imagemap\" \"string filename\" \"wood.ppm\"\n"
    "Material \"diffuse\" \"texture reflectance\" \"wood\"\n"
    "Shape \"trianglemesh\" \"integer indices\" [ 0 1 2 0 2 3 ]\n"
    "  \"point3 P\" [ -2 -2 0  2 -2 0  2 2 0  -2 2 0 ] \"point2 uv\" [ 0 0  1 0  1 1  0 1 ]\n"
    "Material \"conductor\" \"float roughness\" [ 0.1 ]\n"
    "Shape \"plymesh\" \"string filename\" \"roof.ply\"\n";

static const char roof[] =
    "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n"
    "property float z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n"
    "-1 -1 0\n1 -1 0\n1 1 0\n-1 1 0\n0 0 1.5\n3 0 1 4\n3 1 2 4\n3 2 3 4\n3 3 0 4\n";

static const char wood[] = "P3\n2 2\n255\n200 120 60  90 60 30\n80 50 20  220 150 80\n";

void cli_scene(void)
{
    Image sky;

    REQUIRE(image_init(&sky, 8, 4), "image_init");
    for (uint32_t y = 0; y < 4; y++)
        for (uint32_t x = 0; x < 8; x++)
            *image_at(&sky, x, y) = rgb(0.25f * (float)(4 - y), 0.125f * (float)(x + 1), 0.5f);
    REQUIRE(image_write(&sky, cli_path("sky.pfm"), NULL), "sky.pfm");
    image_clear(&sky);
    cli_write_text("roof.ply", roof);
    cli_write_text("wood.ppm", wood);
    cli_write_text("tiny.pbrt", cli_scene_text);
}

/* ---- CSV ---- */

/* One line; returns what follows. */
static const char *csv_row(CsvRow *r, const char *p, int *fields)
{
    int k = 0, n = 0;
    bool quoted = false;

    memset(r, 0, sizeof *r);
    for (; *p && (quoted || *p != '\n'); p++) {
        if (*p == '"' && quoted && p[1] == '"')
            r->field[k][n++] = *p++;
        else if (*p == '"')
            quoted = !quoted;
        else if (*p == ',' && !quoted) {
            k++;
            n = 0;
        } else
            r->field[k][n++] = *p;
        REQUIRE(k < CSV_FIELDS && n < CSV_FIELD_ROOM - 1, "too many fields, or too long a one");
    }
    EXPECT(*p == '\n', "a line without end");
    *fields = k + 1;
    return p + (*p == '\n');
}

const Csv *csv_of(const char *text)
{
    static Csv turns[2];
    static int turn;
    Csv *c = &turns[turn++ & 1];
    int fields;

    c->n = 0;
    for (text = csv_row(&c->head, text, &c->fields); *text; c->n++) {
        REQUIRE(c->n < CSV_ROWS, "too many rows");
        text = csv_row(&c->row[c->n], text, &fields);
        EXPECT(fields == c->fields, "row %d: %d fields", c->n, fields);
    }
    return c;
}

const char *csv_text(const Csv *c, int row, const char *column)
{
    int k = 0;
    while (k < c->fields && strcmp(c->head.field[k], column))
        k++;
    REQUIRE(k < c->fields && row < c->n, "no column '%s', or no row %d", column, row);
    return c->row[row].field[k];
}

double csv_num(const Csv *c, int row, const char *column)
{
    const char *text = csv_text(c, row, column);
    char *end;
    double v = strtod(text, &end);
    EXPECT(end > text && !*end, "row %d: %s is '%s'", row, column, text);
    return v;
}

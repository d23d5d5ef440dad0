/* test_base.c -- the ground floor: memory and its fault counter, messages, files under every fault,
 * text, options, random numbers, vectors and frames. */
#include "base/error.h"
#include "base/file.h"
#include "base/mem.h"
#include "base/options.h"
#include "base/random.h"
#include "base/text.h"
#include "base/vec.h"
#include "test/test.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <float.h>
#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

/* Most standard errors that a sound generator may be off: 2e-8 a test, both sides. */
#define Z_MAX 5.6

static char *in_folder(char out[300], const char *name)
{
    snprintf(out, 300, "%.200s/%.90s", test_folder(), name);
    return out;
}

/* ---- what goes to standard error ---- */

typedef struct { int saved; char path[300]; } Capture;

static void capture_begin(Capture *c)
{
    int fd = open(in_folder(c->path, "stderr"), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    fflush(stderr);
    c->saved = dup(2);
    REQUIRE(fd >= 0 && c->saved >= 0 && dup2(fd, 2) == 2, "cannot catch standard error");
    close(fd);
}

static void capture_end(Capture *c, char *text, size_t room)
{
    FILE *f;
    size_t n;
    fflush(stderr);
    dup2(c->saved, 2);
    close(c->saved);
    f = fopen(c->path, "r");
    REQUIRE(f, "cannot read %s", c->path);
    n = fread(text, 1, room - 1, f);
    text[n] = 0;
    fclose(f);
    unlink(c->path);
}

static int lines_in(const char *s)
{
    int n = 0;
    for (; *s; s++)
        n += *s == '\n';
    return n;
}

/* ---- error.h ---- */

static void messages(void)
{
    const Place whole = { "a.ply", 0, 0 }, line = { "a.ply", 7, 0 }, column = { "a.ply", 7, 9 };
    const Place none = { NULL, 0, 0 };
    char text[2000];
    Capture c;

    capture_begin(&c);
    EXPECT(!err_at(whole, "is %s", "short") && !err_at(line, "x") && !err_at(column, "y %d", 3),
           "err_at gives true");
    EXPECT(!err_at(none, "no place") && !err_usage("u") && !err_output("o.png", "full"), "true");
    EXPECT(!err_memory(12) && !err_memory(13), "err_memory gives true");
    EXPECT(warn_at(line, "odd"), "a warning stops the caller");
    note("done");
    messages_quiet(true);
    note("not this");
    warn_at(whole, "still this");
    capture_end(&c, text, sizeof text);
    EXPECT(!strcmp(text, "rushlight: a.ply: is short\nrushlight: a.ply:7: x\n"
                         "rushlight: a.ply:7:9: y 3\nrushlight: no place\nrushlight: u\n"
                         "rushlight: o.png: full\n"
                         "rushlight: out of memory: 12 bytes were asked for\n"
                         "rushlight: a.ply:7: warning: odd\nrushlight: done\n"
                         "rushlight: a.ply: warning: still this\n"), "got:\n%s", text);
    EXPECT(warnings_count() == 2, "%u warnings", warnings_count());
}

/* One line of bounded length whatever stands in it. */
static void messages_hostile(void)
{
    char name[5000], text[6000];
    Capture c;

    memset(name, 'n', sizeof name);
    name[sizeof name - 1] = 0;
    capture_begin(&c);
    err_at((Place){ name, INT_MAX, INT_MAX }, "%s", name);
    capture_end(&c, text, sizeof text);
    EXPECT(lines_in(text) == 1 && strlen(text) < 1500, "%d lines, %d bytes", lines_in(text),
           (int)strlen(text));
    capture_begin(&c);
    err_at((Place){ "a\nb\x1b[2J", 1, 1 }, "%s", "c\r\nd\t\x7f\xc3\xa4");
    capture_end(&c, text, sizeof text);
    EXPECT(!strcmp(text, "rushlight: a?b?[2J:1:1: c??d??\xc3\xa4\n"), "got: %s", text);
}

static void statuses(void)
{
    const Place p = { "f", 1, 1 };

    EXPECT(err_status() == STATUS_OK, "status at the start");
    warn_at(p, "w");
    EXPECT(err_status() == STATUS_OK, "a warning is no error");
    err_usage("u");
    err_at(p, "x");
    EXPECT(err_status() == STATUS_USAGE, "the first class counts");
    err_reset();
    EXPECT(err_status() == STATUS_OK && warnings_count() == 0, "err_reset");
    err_memory(1);
    EXPECT(err_status() == STATUS_OUTPUT, "memory");
    err_reset();
    warnings_fatal(true);
    EXPECT(!warn_at(p, "w") && err_status() == STATUS_INPUT, "--strict");
    err_reset();
    EXPECT(warn_at(p, "w"), "err_reset forgets --strict");
}

static void asserts(void)
{
    int status = 0;
    pid_t pid;

    ASSERT(1 + 1 == 2);
    fflush(NULL);
    pid = fork();
    if (pid == 0) {
        ASSERT(1 + 1 == 3);
        _exit(0);
    }
    REQUIRE(pid > 0 && waitpid(pid, &status, 0) == pid, "cannot fork");
    EXPECT(WIFSIGNALED(status), "a false ASSERT lets the program go on");
}

static void nearest(void)
{
    static const char *const NAMES[] = { "path", "bdpt", "ppm", "sppm", "mlt", "photonmap" };
    static const struct { const char *word, *want; } CASES[] = {
        { "path", "path" }, { "pth", "path" }, { "ptah", "path" }, { "PATH", "path" },
        { "bdtp", "bdpt" }, { "sppn", "sppm" }, { "photomap", "photonmap" }, { "pssmlt", "mlt" },
        { "fotonmaps", "photonmap" }, { "zzzz", NULL }, { "", NULL }, { "q", NULL },
    };
    char giant[300];

    for (size_t k = 0; k < sizeof CASES / sizeof CASES[0]; k++) {
        const char *got = nearest_name(CASES[k].word, NAMES, 6), *want = CASES[k].want;
        EXPECT(got == want || (got && want && !strcmp(got, want)), "%s: %s", CASES[k].word,
               got ? got : "nothing");
    }
    memset(giant, 'p', sizeof giant);
    giant[sizeof giant - 1] = 0;
    nearest_name(giant, NAMES, 6);                      /* must not write past its rows */
    EXPECT(!nearest_name("path", NULL, 0), "the nearest of none");
}

/* The edit distance by its definition. */
static int distance(const char *a, const char *b)
{
    int best, d;
    if (!*a || !*b)
        return (int)(strlen(a) + strlen(b));
    best = distance(a + 1, b + 1) + (*a != *b);
    d = distance(a + 1, b) + 1;
    best = d < best ? d : best;
    d = distance(a, b + 1) + 1;
    best = d < best ? d : best;
    if (a[1] && b[1] && a[0] == b[1] && a[1] == b[0] && (d = distance(a + 2, b + 2) + 1) < best)
        best = d;
    return best;
}

static void nearest_twin(void)
{
    Rng r = rng_seed(21);

    for (int i = 0; i < 3000; i++) {
        char words[4][8] = { "" };
        const char *names[3] = { words[1], words[2], words[3] }, *want = NULL, *got;
        int least;
        for (int k = 0; k < 4; k++)
            for (int n = (int)rng_below(&r, 7), j = 0; j < n; j++)
                words[k][j] = (char)('a' + rng_below(&r, 3));
        least = (int)strlen(words[0]) / 2 + 1;
        for (int k = 0; k < 3; k++)
            if (distance(words[0], names[k]) < least) {
                least = distance(words[0], names[k]);
                want = names[k];
            }
        got = nearest_name(words[0], names, 3);
        EXPECT(got == want, "%s among %s %s %s: %s, expected %s", words[0], names[0], names[1],
               names[2], got ? got : "none", want ? want : "none");
    }
}

/* ---- mem.h ---- */

static void memory(void)
{
    unsigned char *p = mem_array(1000, 3);
    long blocks = mem_blocks();
    size_t bytes = mem_bytes();
    void *none, *none2;
    char *s;

    REQUIRE(p, "no memory");
    for (int i = 0; i < 3000; i++)
        EXPECT(!p[i], "byte %d is not zero", i);
    none = mem_array(0, 8);
    none2 = mem_array(8, 0);
    EXPECT(none && none2, "zero sizes");
    s = mem_string("abcdef", 3);
    EXPECT(s && !strcmp(s, "abc"), "mem_string");
    EXPECT(mem_blocks() == blocks + 3, "%ld blocks more", mem_blocks() - blocks);
    mem_free(none);
    mem_free(none2);
    mem_free(s);
    mem_free(NULL);
    EXPECT(mem_blocks() == blocks && mem_bytes() == bytes, "freed blocks still count");
    EXPECT(!mem_array(SIZE_MAX, 2) && !mem_array(2, SIZE_MAX) && !mem_array(SIZE_MAX / 2, 2) &&
           !mem_array(SIZE_MAX / 16 + 1, 16), "a size that overflows");
    EXPECT(mem_blocks() == blocks && err_status() == STATUS_OUTPUT, "after failures");
    mem_free(p);
    EXPECT(mem_blocks() == blocks - 1 && mem_bytes() < bytes, "the last one");
}

static void growth(void)
{
    int *a = NULL;
    size_t n = 0, cap = 0, before;
    unsigned long calls;

    mem_fail_at(0, false);
    for (int i = 0; i < 100000; i++)
        REQUIRE(MEM_PUSH(a, n, cap, i * 7), "no memory");
    calls = mem_calls();
    EXPECT(calls < 40, "%lu calls for 100000 elements", calls);
    for (int i = 0; i < 100000; i++)
        EXPECT(a[i] == i * 7, "element %d is %d", i, a[i]);
    before = cap;
    EXPECT(!mem_grow(&a, &cap, SIZE_MAX / 2, sizeof *a) && cap == before, "a size that overflows");
    mem_fail_at(1, true);
    EXPECT(!mem_grow(&a, &cap, cap + 1, sizeof *a) && cap == before, "failure changes the array");
    EXPECT(mem_grow(&a, &cap, cap, sizeof *a), "room that is there needs no call");
    mem_fail_at(0, false);
    EXPECT(a[99999] == 99999 * 7, "contents after failure");
    mem_free(a);
    EXPECT(mem_blocks() == 0 && mem_bytes() == 0, "%ld blocks left", mem_blocks());
}

static void memory_faults(void)
{
    void *p[6];

    for (int on = 0; on < 2; on++)
        for (unsigned long k = 1; k <= 6; k++) {
            mem_fail_at(k, on != 0);
            for (unsigned long i = 1; i <= 6; i++) {
                bool fails = on ? i >= k : i == k;
                p[i - 1] = mem_array(i, 8);
                EXPECT(!p[i - 1] == fails, "call %lu, fault at %lu, on %d", i, k, on);
            }
            EXPECT(mem_calls() == 6, "%lu calls", mem_calls());
            for (int i = 0; i < 6; i++)
                mem_free(p[i]);
        }
    mem_fail_at(0, false);
    mem_limit(mem_bytes() + 1000);
    p[0] = mem_array(1, 900);
    p[1] = mem_array(1, 900);
    EXPECT(p[0] && !p[1], "mem_limit");
    mem_free(p[0]);
    mem_limit(0);
    p[0] = mem_array(1, 5000);
    mem_free(p[0]);
    EXPECT(mem_peak() >= 5000 && mem_peak() < 6000, "peak %lu", (unsigned long)mem_peak());
    EXPECT(mem_blocks() == 0 && mem_bytes() == 0, "%ld blocks left", mem_blocks());
}

/* How the machine aligns what needs it most. */
struct Probe { char c; union { double d; void *p; int64_t i; long double l; } most; };

static void arenas(void)
{
    enum { N = 2000 };
    static unsigned char *piece[N];
    static size_t size[N];
    Arena a = { NULL, 0, 0 };
    Rng r = rng_seed(22);
    char *s;

    for (int i = 0; i < N; i++) {
        size[i] = rng_below(&r, i % 100 ? 200 : 60000);
        piece[i] = arena_take(&a, size[i], 1);
        REQUIRE(piece[i], "no memory");
        EXPECT((uintptr_t)piece[i] % offsetof(struct Probe, most) == 0, "piece %d: place", i);
        for (size_t k = 0; k < size[i]; k++)
            EXPECT(!piece[i][k], "piece %d is not zeroed", i);
        memset(piece[i], i & 255, size[i]);
    }
    for (int i = 0; i < N; i++)
        for (size_t k = 0; k < size[i]; k++)
            EXPECT(piece[i][k] == (i & 255), "piece %d was overwritten", i);
    s = arena_string(&a, "hello", 4);
    EXPECT(s && !strcmp(s, "hell"), "arena_string");
    EXPECT(!arena_take(&a, SIZE_MAX, 2) && !arena_take(&a, SIZE_MAX / 3, 1), "overflow");
    mem_fail_at(1, true);
    EXPECT(!arena_take(&a, 100000, 1), "a failing block");
    mem_fail_at(0, false);
    EXPECT(piece[N - 1][0] == ((N - 1) & 255) || !size[N - 1], "contents after failure");
    arena_clear(&a);
    arena_clear(&a);
    EXPECT(mem_blocks() == 0 && mem_bytes() == 0, "%ld blocks left", mem_blocks());
    EXPECT(arena_take(&a, 8, 1) != NULL, "use after arena_clear");
    arena_clear(&a);
}

/* ---- file.h ---- */

static int entries(const char *folder)
{
    DIR *d = opendir(folder);
    int n = 0;
    struct dirent *e;
    REQUIRE(d, "cannot list %s", folder);
    while ((e = readdir(d)) != NULL)
        n += e->d_name[0] != '.';
    closedir(d);
    return n;
}

static bool holds(const char *path, const char *bytes, size_t n)
{
    FileBytes f;
    bool equal = file_read(path, FILE_LIMIT_DEFAULT, &f) && f.size == n &&
                 !memcmp(f.bytes, bytes, n) && f.bytes[n] == 0;
    file_clear(&f);
    return equal;
}

enum { BIG = 300000 };
static char big[BIG];

static void fill_big(void)
{
    Rng r = rng_seed(23);
    for (int i = 0; i < BIG; i++)
        big[i] = (char)(unsigned char)(rng_bits(&r) & 127);
}

static void files(void)
{
    char path[300], other[300];
    static const char BYTES[] = { 0x12, 0x34, 0x56, 0x78, 0, 1, 2, 3 };
    Out *o;
    FileBytes f;

    fill_big();
    in_folder(path, "f");
    in_folder(other, "g");
    EXPECT(!file_exists(path), "a file before it is written");
    EXPECT(file_write(path, "", 0) && holds(path, "", 0), "an empty file");
    EXPECT(file_write(path, big, BIG) && holds(path, big, BIG), "300000 bytes");
    EXPECT(file_exists(path) && entries(test_folder()) == 1, "something lies beside the file");
    EXPECT(file_read(path, BIG, &f) && f.size == BIG, "a file as large as the limit");
    file_clear(&f);
    file_clear(&f);
    EXPECT(!file_read(path, BIG - 1, &f) && !f.bytes && !f.size, "a file above the limit");
    o = out_open(other);
    REQUIRE(o, "cannot write %s", other);
    out_u32be(o, 0x12345678u);
    out_text(o, "");
    out_write(o, BYTES + 4, 4);
    EXPECT(!file_exists(other), "the file appears before it is whole");
    EXPECT(out_close(o) && holds(other, BYTES, 8), "out_u32be and out_write");
    o = out_open(other);
    REQUIRE(o, "cannot write %s", other);
    out_write(o, big, BIG);
    out_abort(o);
    out_abort(NULL);
    EXPECT(holds(other, BYTES, 8) && entries(test_folder()) == 2, "out_abort leaves traces");
    EXPECT(mem_blocks() == 0, "%ld blocks left", mem_blocks());
}

static void files_wrong(void)
{
    char path[300];
    FileBytes f;

    EXPECT(!file_read(in_folder(path, "missing"), 100, &f) && !f.bytes, "a missing file");
    EXPECT(err_status() == STATUS_INPUT, "status of a missing file");
    EXPECT(!file_read(test_folder(), 100, &f) && !f.bytes, "a folder is read");
    EXPECT(!file_read("", 100, &f) && !f.bytes, "the empty name is read");
    REQUIRE(mkfifo(in_folder(path, "fifo"), 0600) == 0, "mkfifo");
    EXPECT(!file_read(path, 100, &f) && !f.bytes, "a pipe without a writer is read");
    unlink(path);
    err_reset();
    EXPECT(!file_write(test_folder(), "x", 1), "a folder is written");
    EXPECT(err_status() == STATUS_OUTPUT, "status of a failing output");
    EXPECT(!file_write(in_folder(path, "no/such/folder"), "x", 1), "a missing folder");
    EXPECT(!file_write("", "x", 1), "the empty name is written");
    if (file_exists("/dev/full")) {
        fill_big();
        EXPECT(!file_write("/dev/full", big, BIG) && !file_write("/dev/full", "x", 1), "/dev/full");
    }
    if (file_exists("/dev/null"))
        EXPECT(file_write("/dev/null", "x", 1), "/dev/null");
    EXPECT(entries(test_folder()) == 0 && mem_blocks() == 0, "something is left");
}

/* The system takes a part of what is written, then no more. */
static void write_partly(void)
{
    const struct rlimit most = { 100000, 100000 };
    char path[300];

    fill_big();
    REQUIRE(file_write(in_folder(path, "f"), "old", 3), "cannot write %s", path);
    REQUIRE(signal(SIGXFSZ, SIG_IGN) != SIG_ERR && !setrlimit(RLIMIT_FSIZE, &most), "setrlimit");
    EXPECT(!file_write(path, big, BIG) && err_status() == STATUS_OUTPUT, "not reported");
    EXPECT(!file_write(path, big, 100001), "the last byte is missing");
    EXPECT(holds(path, "old", 3) && entries(test_folder()) == 1, "the old file is broken");
    EXPECT(file_write(path, big, 100000) && holds(path, big, 100000), "what there is room for");
}

/* Each operation of a write fails in turn, once or for good: the failure is told, the old file
 * stands, nothing lies beside it. A write that is only interrupted succeeds. */
static void write_faults(void)
{
    static const int CODES[] = { EIO, ENOSPC, EINTR };
    char path[300];

    fill_big();
    in_folder(path, "f");
    for (int c = 0; c < 3; c++)
        for (int on = 0; on < (CODES[c] == EINTR ? 1 : 2); on++)
            for (unsigned long k = 1;; k++) {
                bool ok, reached;
                REQUIRE(file_write(path, "old", 3), "cannot write %s", path);
                err_reset();
                file_fail_at(k, on != 0, CODES[c]);
                ok = file_write(path, big, BIG);
                reached = file_calls() >= k;
                file_fail_at(0, false, 0);
                EXPECT(ok ? holds(path, big, BIG) : holds(path, "old", 3),
                       "%s at operation %lu: the file is broken", strerror(CODES[c]), k);
                EXPECT(entries(test_folder()) == 1, "operation %lu: something lies beside", k);
                EXPECT(ok == (err_status() == STATUS_OK), "operation %lu: not reported", k);
                EXPECT(ok == (!reached || CODES[c] == EINTR), "operation %lu: success is %d", k,
                       ok);
                EXPECT(mem_blocks() == 0, "operation %lu leaks", k);
                if (!reached) {
                    EXPECT(k > 8, "only %lu operations", k - 1);
                    break;
                }
            }
}

static void read_faults(void)
{
    char path[300];
    FileBytes f;

    fill_big();
    REQUIRE(file_write(in_folder(path, "f"), big, BIG), "cannot write %s", path);
    for (int code = 0; code < 2; code++)
        for (unsigned long k = 1;; k++) {
            bool ok, reached;
            err_reset();
            file_fail_at(k, false, code ? EINTR : EIO);
            ok = file_read(path, BIG, &f);
            reached = file_calls() >= k;
            file_fail_at(0, false, 0);
            EXPECT(ok ? f.size == BIG && !memcmp(f.bytes, big, BIG) : !f.bytes && !f.size,
                   "operation %lu: wrong contents", k);
            EXPECT(ok == (!reached || code), "operation %lu: success is %d", k, ok);
            EXPECT(ok == (err_status() == STATUS_OK), "operation %lu: not reported", k);
            file_clear(&f);
            EXPECT(mem_blocks() == 0, "operation %lu leaks", k);
            if (!reached)
                break;
        }
    for (unsigned long k = 1; k <= 5; k++) {
        bool ok;
        mem_fail_at(k, true);
        ok = file_read(path, BIG, &f) && file_write(path, "new", 3);
        mem_fail_at(0, false);
        file_clear(&f);
        EXPECT(ok == (k > 4), "memory fault %lu: success is %d", k, ok);
        EXPECT(mem_blocks() == 0 && entries(test_folder()) == 1, "memory fault %lu leaks", k);
    }
}

static void paths(void)
{
    static const struct { const char *from, *name, *want; } CASES[] = {
        { "a/b.pbrt", "c.ply", "a/c.ply" }, { "b.pbrt", "c.ply", "c.ply" },
        { "a/b", "/c", "/c" }, { NULL, "c", "c" }, { "/b", "c", "/c" }, { "a/", "c", "a/c" },
        { "a/b/c", "../d", "a/b/../d" }, { "a/b", "", "a/" },
    };
    static const struct { const char *path, *want; } EXTENSIONS[] = {
        { "a.ply", "ply" }, { "a.tar.gz", "gz" }, { "a", "" }, { "a.b/c", "" }, { "a.", "" },
        { "/x.y/z.png", "png" }, { "", "" }, { ".hidden", "hidden" },
    };
    for (size_t k = 0; k < sizeof CASES / sizeof CASES[0]; k++) {
        char *p = path_beside(CASES[k].from, CASES[k].name);
        REQUIRE(p, "no memory");
        EXPECT(!strcmp(p, CASES[k].want), "%s: %s", CASES[k].want, p);
        mem_free(p);
    }
    for (size_t k = 0; k < sizeof EXTENSIONS / sizeof EXTENSIONS[0]; k++)
        EXPECT(!strcmp(path_extension(EXTENSIONS[k].path), EXTENSIONS[k].want), "%s: %s",
               EXTENSIONS[k].path, path_extension(EXTENSIONS[k].path));
}

/* ---- text.h ---- */

/* Lines against a splitting by hand, of random mixtures of line ends. */
static void lines(void)
{
    Rng r = rng_seed(24);

    for (int i = 0; i < 20000; i++) {
        char bytes[12];
        size_t n = rng_below(&r, 13), at = 0, seen = 0;
        int count = 0;
        Text t, line;
        for (size_t k = 0; k < n; k++)
            bytes[k] = "a \r\n"[rng_below(&r, 4)];
        text_init(&t, "f", bytes, n);
        while (text_line(&t, &line)) {
            size_t end = at;
            while (end < n && bytes[end] != '\r' && bytes[end] != '\n')
                end++;
            count++;
            EXPECT(line.at == bytes + at && line.end == bytes + end && line.line == count,
                   "case %d line %d", i, count);
            EXPECT(text_place(&line).column == 1 && text_place(&line).line == count, "its place");
            if (end < n)
                end += bytes[end] == '\r' && end + 1 < n && bytes[end + 1] == '\n' ? 2 : 1;
            at = end;
        }
        EXPECT(at == n && text_done(&t) && text_peek(&t) == -1, "case %d: bytes are left", i);
        text_init(&t, "f", bytes, n);                   /* words see the same lines */
        for (text_space(&t); !text_done(&t); text_space(&t)) {
            Place p = text_place(&t);
            size_t start = (size_t)(t.at - bytes), back = start;
            int want = 1;
            while (back && bytes[back - 1] != '\r' && bytes[back - 1] != '\n')
                back--;
            for (size_t k = 0; k < start; k++)
                want += bytes[k] == '\n' || (bytes[k] == '\r' && bytes[k + 1] != '\n');
            EXPECT(p.line == want && p.column == (int)(start - back) + 1, "case %d: place %d:%d",
                   i, p.line, p.column);
            seen += text_word(&t).n;
        }
        for (size_t k = 0; k < n; k++)
            seen -= bytes[k] == 'a';
        EXPECT(!seen, "case %d: letters are lost", i);
    }
}

static void words(void)
{
    static const char BYTES[] = "\xEF\xBB\xBF v 1.5\t-2e3 x\0y 7 12z 3.5 9\r\n";
    Text t;
    Word w;
    float f = 7.0f;
    int64_t k = 7;
    char copy[4];

    text_init(&t, "f", BYTES, sizeof BYTES - 1);
    w = text_word(&t);
    EXPECT(w.n == 1 && word_is(w, "v") && !word_is(w, "vn") && !word_is(w, ""), "v");
    EXPECT(!word_is_nocase(w, "W") && word_is_nocase(w, "V"), "word_is_nocase");
    EXPECT(text_place(&t).column == 3, "the mark at the start counts as a column");
    EXPECT(text_float(&t, &f) && f == 1.5f && text_float(&t, &f) && f == -2000.0f, "numbers");
    EXPECT(!text_float(&t, &f) && f == -2000.0f && !text_int(&t, &k) && k == 7, "x is no number");
    w = text_word(&t);
    EXPECT(w.n == 3 && w.s[1] == 0, "a word with a zero byte");
    EXPECT(text_int(&t, &k) && k == 7, "7");
    EXPECT(!text_int(&t, &k) && !text_float(&t, &f), "12z is no number");
    w = text_word(&t);
    EXPECT(!strcmp(word_copy(copy, sizeof copy, w), "12z"), "word_copy");
    EXPECT(!text_int(&t, &k) && text_float(&t, &f) && f == 3.5f, "3.5 is no integer");
    EXPECT(text_int(&t, &k) && k == 9 && text_peek(&t) == '\r', "9");
    EXPECT(!text_word(&t).n && !text_int(&t, &k) && !text_float(&t, &f), "a line end is no word");
    text_space(&t);
    EXPECT(text_done(&t) && text_place(&t).line == 2, "the end");
    w.s = "abcdef";
    w.n = 6;
    EXPECT(!strcmp(word_copy(copy, sizeof copy, w), "abc"), "word_copy cuts");
    EXPECT(word_is_nocase(w, "ABCdef") && !word_is_nocase(w, "ABCdeg"), "word_is_nocase");
    text_init(&t, "f", "\xEF\xBB", 2);
    EXPECT(text_peek(&t) == 0xEF, "half a mark is no mark");
}

/* ---- options.h ---- */

/* A choice is known by its place in the table, also where one word begins like another. */
static void choices(void)
{
    static const OptDef defs[] = {
        { .key = "at", .type = OPT_INT },
        { .key = "kind", .type = OPT_CHOICE, .str = "light", .choices = "lights all light no" },
        { .key = NULL }
    };
    static const char *const words[] = { "lights", "all", "light", "no" };
    Arena arena = { 0 };
    char text[40];
    Opts o;

    opts_default(&o, defs);
    EXPECT(opt_choice(&o, "kind") == 2, "the default: %d", opt_choice(&o, "kind"));
    for (int k = 0; k < 4; k++) {
        snprintf(text, sizeof text, "kind=%s", words[k]);
        EXPECT(opts_parse(&o, "x", text, &arena) && opt_choice(&o, "kind") == k, "%s: %d", text,
               opt_choice(&o, "kind"));
    }
    arena_clear(&arena);
}

/* ---- random.h ---- */

/* Published outputs of SplitMix64 for the seed 1234567. */
static void splitmix(void)
{
    static const uint64_t WANT[] = { 6457827717110365317u, 3203168211198807973u,
                                     9817491932198370423u, 4593380528125082431u,
                                     16408922859458223821u };
    for (uint64_t k = 0; k < 5; k++)
        EXPECT(draw64(1234567, k + 1) == WANT[k], "draw %d", (int)k);
    EXPECT(mix64(0) == 0 && key_with(0, 0) != 0, "zeros");
    EXPECT(unit_of(0xFFFFFFFFu) == ONE_MINUS_ULP && unit_of(0) == 0.0f, "ends of unit_of");
    EXPECT(unit_of(255) == 0.0f && unit_of(256) == 0x1p-24f && unit_of(1u << 31) == 0.5f, "steps");
}

static uint64_t flip_mix(uint64_t x, uint64_t bit) { return mix64(x) ^ mix64(x ^ bit); }
static uint64_t flip_key(uint64_t x, uint64_t b) { return key_with(x, 9) ^ key_with(x ^ b, 9); }
static uint64_t flip_word(uint64_t x, uint64_t b) { return key_with(9, x) ^ key_with(9, x ^ b); }
static uint64_t flip_draw(uint64_t x, uint64_t b) { return draw64(x, 5) ^ draw64(x ^ b, 5); }
static uint64_t flip_count(uint64_t x, uint64_t b) { return draw64(9, x) ^ draw64(9, x ^ b); }

/* Each bit that goes in turns half of the bits that come out, of counting inputs. */
static void avalanche(void)
{
    static uint64_t (*const FLIPS[])(uint64_t, uint64_t) = { flip_mix, flip_key, flip_word,
                                                              flip_draw, flip_count };
    enum { N = 4096 };

    for (int f = 0; f < 5; f++)
        for (int in = 0; in < 64; in++) {
            int count[64] = { 0 };
            for (uint64_t x = 0; x < N; x++) {
                uint64_t d = FLIPS[f](x, (uint64_t)1 << in);
                for (int out = 0; out < 64; out++)
                    count[out] += d >> out & 1;
            }
            for (int out = 0; out < 64; out++) {
                double z = (count[out] - N / 2) / (0.5 * sqrt(N));
                EXPECT(fabs(z) < Z_MAX, "function %d: bit %d turns bit %d: z %.1f", f, in, out, z);
            }
        }
}

static double chi_squared_z(const int *count, int bins, double n)
{
    double sum = 0.0, each = n / bins;
    for (int k = 0; k < bins; k++)
        sum += (count[k] - each) * (count[k] - each) / each;
    return (sum - (bins - 1)) / sqrt(2.0 * (bins - 1));
}

/* Numbers are level within a stream, across streams at one counter, and in pairs. */
static void streams(void)
{
    enum { N = 1 << 20, SIDE = 1024 };
    static int along[256], across[256], pairs[4096];
    double lag = 0.0, beside = 0.0, se = sqrt(N) / 12.0;

    for (uint64_t s = 0; s < SIDE; s++) {
        uint64_t key = key_with(7, s), next = key_with(7, s + 1);
        for (uint64_t k = 0; k < SIDE; k++) {
            float u = unit_of((uint32_t)(draw64(key, k) >> 32));
            float v = unit_of((uint32_t)(draw64(key, k + 1) >> 32));
            float w = unit_of((uint32_t)(draw64(next, k) >> 32));
            along[(int)(u * 256.0f)]++;
            across[draw64(key, k) & 255]++;             /* the low bits too */
            pairs[(int)(u * 64.0f) * 64 + (int)(w * 64.0f)]++;
            lag += (u - 0.5) * (v - 0.5);
            beside += (u - 0.5) * (w - 0.5);
        }
    }
    EXPECT(fabs(chi_squared_z(along, 256, N)) < Z_MAX, "%f", chi_squared_z(along, 256, N));
    EXPECT(fabs(chi_squared_z(across, 256, N)) < Z_MAX, "%f", chi_squared_z(across, 256, N));
    EXPECT(fabs(chi_squared_z(pairs, 4096, N)) < Z_MAX, "%f", chi_squared_z(pairs, 4096, N));
    EXPECT(fabs(lag / se) < Z_MAX, "neighbours in a stream: z %.1f", lag / se);
    EXPECT(fabs(beside / se) < Z_MAX, "neighbouring streams: z %.1f", beside / se);
}

static int by_value(const void *a, const void *b)
{
    uint64_t x, y;
    memcpy(&x, a, sizeof x);
    memcpy(&y, b, sizeof y);
    return (x > y) - (x < y);
}

/* Streams do not overlap: of 2^18 draws of 2^9 streams, and of as many keys, no two are the same
 * (by chance once in 10^9 runs). */
static void distinct(void)
{
    enum { N = 1 << 18 };
    static uint64_t draws[N], keys[N];

    for (uint64_t i = 0; i < N; i++) {
        draws[i] = draw64(key_with(0, i >> 9), i & 511);
        keys[i] = key_with(key_with(3, i >> 9), i & 511);       /* (a, b) and (b, a) among them */
    }
    qsort(draws, N, sizeof draws[0], by_value);
    qsort(keys, N, sizeof keys[0], by_value);
    for (int i = 1; i < N; i++)
        EXPECT(draws[i] != draws[i - 1] && keys[i] != keys[i - 1], "two of %d are the same", N);
}

static void sequence(void)
{
    static const uint32_t SIDES[] = { 2, 7, 100, 1000 };
    Rng a = rng_seed(1), b = rng_seed(1), c = rng_seed(2);
    int same = 0;

    for (int i = 0; i < 1000; i++) {
        uint64_t x = rng_bits(&a);
        EXPECT(x == rng_bits(&b), "one seed, two sequences");
        same += x == rng_bits(&c);
        EXPECT(rng_unit(&a) < 1.0f && rng_below(&a, 1) == 0, "range");
        b = a;
    }
    EXPECT(!same, "two seeds, one sequence");
    for (int k = 0; k < 4; k++) {
        static int count[1000];
        double z;
        memset(count, 0, sizeof count);
        for (int i = 0; i < 200000; i++) {
            uint32_t x = rng_below(&a, SIDES[k]);
            REQUIRE(x < SIDES[k], "%u is not below %u", (unsigned)x, (unsigned)SIDES[k]);
            count[x]++;
        }
        z = chi_squared_z(count, (int)SIDES[k], 200000.0);
        EXPECT(z < Z_MAX, "below %u: z %.1f", (unsigned)SIDES[k], z);
    }
}

/* ---- vec.h ---- */

static double dot_d(V3 a, V3 b)
{
    return (double)a.x * b.x + (double)a.y * b.y + (double)a.z * b.z;
}

static V3 any_vector(Rng *r)
{
    float x = rng_unit(r) - 0.5f, y = rng_unit(r) - 0.5f, z = rng_unit(r) - 0.5f;
    return v3(x, y, z);
}

static bool same(V3 a, V3 b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

static void vectors(void)
{
    const V3 a = { 1.0f, -2.0f, 3.0f }, b = { 4.0f, 5.0f, -6.0f };

    EXPECT(same(v_add(a, b), v3(5, 3, -3)) && same(v_sub(a, b), v3(-3, -7, 9)), "sums");
    EXPECT(same(v_mul(a, b), v3(4, -10, -18)) && same(v_scale(a, 2), v3(2, -4, 6)), "products");
    EXPECT(same(v_neg(a), v3(-1, 2, -3)) && same(v_mad(a, 2, b), v3(6, 1, 0)), "v_mad");
    EXPECT(v_dot(a, b) == -24.0f && v_absdot(a, b) == 24.0f && v_len2(a) == 14.0f, "v_dot");
    EXPECT(same(v_cross(a, b), v3(-3, 18, 13)) && v_len(v3(2, 3, 6)) == 7.0f, "v_cross");
    EXPECT(same(v_abs(a), v3(1, 2, 3)) && v_max3(a) == 3.0f, "v_abs");
    EXPECT(same(v_all(2), v3(2, 2, 2)), "v_all");
    EXPECT(same(v_min(a, b), v3(1, -2, -6)) && same(v_max(a, b), v3(4, 5, 3)), "v_min");
    EXPECT(v_axis(a, 0) == 1.0f && v_axis(a, 1) == -2.0f && v_axis(a, 2) == 3.0f, "v_axis");
    EXPECT(v_finite(a) && !v_finite(v3(0, NAN, 0)) && !v_finite(v3(0, 0, -INFINITY)), "v_finite");
    EXPECT(same(v_lerp(a, b, 0.0f), a) && same(v_lerp(a, b, 0.5f), v3(2.5f, 1.5f, -1.5f)), "lerp");
    EXPECT(fabsf(rgb_lum(rgb_all(1.0f)) - 1.0f) <= ROUNDINGS(5), "weights of luminance");
    EXPECT(rgb_black(rgb(0, -0.0f, 0)) && !rgb_black(rgb(0, 0, 1)) && rgb_max(rgb(1, 3, 2)) == 3,
           "colours");
    EXPECT(rgb_finite(rgb(1, 2, 3)) && !rgb_finite(rgb(1, INFINITY, 3)), "rgb_finite");
}

/* The cross product of nearly parallel vectors: the products are exact in double, their difference
 * is rounded to double, then to float. */
static void cross(void)
{
    Rng r = rng_seed(25);
    for (int i = 0; i < 100000; i++) {
        V3 a = any_vector(&r), b = v_mad(any_vector(&r), i % 2 ? 1e-6f : 1.0f, a);
        V3 c = v_cross(a, b);
        double yz = (double)a.y * b.z, zy = (double)a.z * b.y, d = yz - zy;
        double bound = fabs(d) * 0x1.001p-24 + 0x1p-53 * (fabs(yz) + fabs(zy)) + 0x1p-150;
        long double exact = (long double)a.y * b.z - (long double)a.z * b.y;
        EXPECT(fabsl(c.x - exact) <= bound, "cross %a, exactly %La", (double)c.x, exact);
    }
}

/* v_unit: the square of the length errs by twice 4.5 roundings, and by one more in each component
 * where it scales. */
static void unit(void)
{
    static const float SIZES[] = { 1.0f, 1e-20f, 1e20f, 1e-38f, 1e-44f, 3e38f, 1e-15f, 1e15f };
    Rng r = rng_seed(26);

    for (int i = 0; i < 80000; i++) {
        V3 d = any_vector(&r), a = v_scale(d, SIZES[i % 8]), n = v_unit(a);
        if (a.x == 0.0f && a.y == 0.0f && a.z == 0.0f)
            continue;
        EXPECT(fabs(dot_d(n, n) - 1.0) <= ROUNDINGS(12), "size %g: length off by %g",
               (double)SIZES[i % 8], dot_d(n, n) - 1.0);
        EXPECT(n.x * d.x >= 0.0f && n.y * d.y >= 0.0f && n.z * d.z >= 0.0f, "direction");
    }
    EXPECT(same(v_unit(v3(0, 0, 0)), v3(0, 0, 0)), "of nothing");
    EXPECT(same(v_unit(v3(0, INFINITY, 0)), v3(0, 0, 0)), "of infinity");
    EXPECT(same(v_unit(v3(0, -0x1p-149f, 0)), v3(0, -1, 0)), "of the least denormal");
    EXPECT(same(v_unit(v3(0, 0, FLT_MAX)), v3(0, 0, 1)), "of the largest float");
}

/* In roundings: a = -1 / (sign + n.z) has 2; n.x n.x a has 4, its sum with 1 one more, and it is at
 * most 1; n.x n.y a has 4 and is at most 1/2. So a product of two axes errs by 2 (5 + 2) = 14, and
 * by the 9 or so that |n|^2 is off (see unit), once: 23. */
static void expect_frame(V3 n)
{
    Frame f = frame_about(n);
    const V3 axes[3] = { f.s, f.t, f.n };

    EXPECT(same(f.n, n), "the normal of the frame");
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            double d = dot_d(axes[i], axes[k]) - (i == k);
            EXPECT(fabs(d) <= ROUNDINGS(24), "axes %d and %d about (%a %a %a): off by %g", i, k,
                   (double)n.x, (double)n.y, (double)n.z, d);
        }
    EXPECT(dot_d(v_cross(f.s, f.t), f.n) > 0.99, "left-handed");
}

static void frames(void)
{
    Rng r = rng_seed(27);

    for (int k = 0; k < 3; k++)
        for (int sign = -1; sign <= 1; sign += 2) {
            float c[3] = { 0.0f, 0.0f, 0.0f };
            c[k] = (float)sign;
            expect_frame(v3(c[0], c[1], c[2]));
        }
    expect_frame(v3(0.0f, 1.0f, -0.0f));
    expect_frame(v3(1e-30f, 0.0f, -1.0f));
    for (int i = 0; i < 100000; i++) {
        V3 d = any_vector(&r), v = any_vector(&r), n, back;
        Frame f;
        if (i % 4 == 0)
            d = v3(d.x * 1e-4f, d.y * 1e-4f, d.z);      /* near both poles */
        n = v_unit(d);
        if (same(n, v3(0, 0, 0)))
            continue;
        expect_frame(n);
        f = frame_about(n);
        back = frame_in(&f, frame_out(&f, v));          /* 24 sqrt(3) + 2 * 3 sqrt(3) roundings */
        EXPECT(v_max3(v_abs(v_sub(back, v))) <= ROUNDINGS(56) * v_len(v), "there and back");
        EXPECT(same(frame_out(&f, v3(0, 0, 1)), n), "the local z axis");
    }
}

static void boxes(void)
{
    Box e = box_empty(), a = { { 0, 0, 0 }, { 1, 2, 3 } }, b = { { -1, 1, 1 }, { 0.5f, 1.5f, 9 } };
    Box far = { { -FLT_MAX, 0, 0 }, { -FLT_MAX / 2, FLT_MAX, 0 } }, j = box_join(a, b);
    Box p = box_point(e, v3(1, 2, 3));

    EXPECT(box_is_empty(e) && !box_is_empty(a) && !box_is_empty(p), "box_is_empty");
    EXPECT(box_is_empty(box_join(e, e)) && same(box_join(e, a).hi, a.hi), "joining nothing");
    EXPECT(same(p.lo, v3(1, 2, 3)) && same(p.hi, v3(1, 2, 3)), "box_point");
    EXPECT(same(j.lo, v3(-1, 0, 0)) && same(j.hi, v3(1, 2, 9)), "box_join");
    EXPECT(box_holds(j, a) && box_holds(j, b) && !box_holds(a, b) && box_holds(a, a), "box_holds");
    EXPECT(same(box_centre(a), v3(0.5f, 1, 1.5f)) && v_finite(box_centre(far)), "box_centre");
    EXPECT(box_area(a) == 22.0f && box_area(p) == 0.0f, "box_area");
}

const TestCase test_base[] = {
    { "messages", messages, false },
    { "messages_hostile", messages_hostile, false },
    { "statuses", statuses, false },
    { "asserts", asserts, false },
    { "nearest", nearest, false },
    { "nearest_twin", nearest_twin, false },
    { "memory", memory, false },
    { "growth", growth, false },
    { "memory_faults", memory_faults, false },
    { "arenas", arenas, false },
    { "files", files, false },
    { "files_wrong", files_wrong, false },
    { "write_partly", write_partly, false },
    { "write_faults", write_faults, false },
    { "read_faults", read_faults, false },
    { "paths", paths, false },
    { "lines", lines, false },
    { "words", words, false },
    { "choices", choices, false },
    { "splitmix", splitmix, false },
    { "avalanche", avalanche, false },
    { "streams", streams, false },
    { "distinct", distinct, false },
    { "sequence", sequence, false },
    { "vectors", vectors, false },
    { "cross", cross, false },
    { "unit", unit, false },
    { "frames", frames, false },
    { "boxes", boxes, false },
    { NULL, NULL, false }
};

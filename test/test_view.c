/* test_view.c -- a scene looked at: cameras moved by hand, who is let in, and whole sessions by
 * sockets, whose pictures are those of `render`. */
#include "base/clock.h"
#include "image/image.h"
#include "integrators/integrator.h"
#include "test/cli_help.h"
#include "test/pictures.h"
#include "test/view_help.h"
#include "view/pose.h"

#include <errno.h>
#include <math.h>
#include <netinet/in.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

/* ---- the camera ---- */

enum { W = 80, H = 60 };

typedef struct { Lab lab; Camera *camera; Pose pose; V3 pivot; } Studio;

static void studio_init(Studio *s, const char *kind, const char *options)
{
    lab_init(&s->lab);
    lab_camera_of(&s->lab, kind, v3(3, 2, -5), v3(0, 1, 0), 40, options);
    s->camera = s->lab.scene->camera;
    s->camera->kind->film(s->camera, W, H);
    s->pivot = v3(0, 1, 0);
    pose_init(&s->pose, s->camera, s->pivot);
}

/* Where a point is seen, in heights of the picture from its middle, x to the right and y up. */
static V2 seen(Studio *s, V3 p)
{
    CameraSample v;

    REQUIRE(pose_put(&s->pose, s->camera), "it cannot stand so");
    REQUIRE(s->camera->kind->sample(s->camera, p, (V2){ 0.5f, 0.5f }, 0, &v), "out of sight");
    return (V2){ (v.pixel.x - W / 2.0f) / H, (H / 2.0f - v.pixel.y) / H };
}

static void expect_seen(Studio *s, V3 p, double x, double y, const char *what)
{
    V2 at = seen(s, p);
    EXPECT(fabs(at.x - x) < 1e-4 && fabs(at.y - y) < 1e-4, "%s: at %.6f,%.6f, not %.6f,%.6f", what,
           at.x, at.y, x, y);
}

/* As it is put it is what it was; what orbits goes around the pivot, which stays in its place at
 * its distance; what is in front of the pivot goes where the hand goes. */
static void orbit(void)
{
    Studio s;
    double far;
    V2 before, after;
    V3 front = v3(0.6f, 1.2f, -1);              /* between the eye and the pivot */

    studio_init(&s, "perspective", "");
    expect_seen(&s, s.pivot, 0, 0, "at first");
    far = pose_distance(&s.pose);
    before = seen(&s, front);
    pose_orbit(&s.pose, 0.1, 0.05);
    after = seen(&s, front);
    EXPECT(after.x > before.x + 0.01f && after.y > before.y + 0.005f, "it goes elsewhere");
    for (int i = 0; i < 1000; i++)
        pose_orbit(&s.pose, 0.37, i % 3 ? 0.11 : -0.2);
    expect_seen(&s, s.pivot, 0, 0, "after many");
    EXPECT(fabs(pose_distance(&s.pose) - far) < 1e-9 * far, "nearer or farther");
    lab_clear(&s.lab);
}

/* Never upside down, however far it is dragged. */
static void upright(void)
{
    Studio s;
    double m[4][4];

    studio_init(&s, "perspective", "");
    for (int sign = -1; sign <= 1; sign += 2)
        for (int i = 0; i < 400; i++) {
            pose_orbit(&s.pose, 0, 0.02 * sign);
            pose_matrix(&s.pose, m);
            EXPECT(m[1][1] > 0, "its up points down");
        }
    lab_clear(&s.lab);
}

static void other_moves(void)
{
    Studio s;
    double m[4][4], far;
    V2 before, after;
    V3 behind = v3(-2, 0.5f, 4);

    studio_init(&s, "perspective", "");
    before = seen(&s, behind);
    pose_turn(&s.pose, -0.05, -0.03);           /* the picture goes the other way */
    after = seen(&s, behind);
    EXPECT(after.x > before.x + 0.01f && after.y > before.y + 0.01f, "turned elsewhere");
    EXPECT(s.pose.eye[0] == 3 && s.pose.eye[1] == 2 && s.pose.eye[2] == -5, "the eye has moved");
    s.pose.pitch = s.pose.yaw = 0;
    far = pose_distance(&s.pose);
    pose_zoom(&s.pose, 0.5);
    EXPECT(fabs(pose_distance(&s.pose) - far / 2) < 1e-9, "zoomed to another distance");
    expect_seen(&s, s.pivot, 0, 0, "zoomed");
    pose_matrix(&s.pose, m);
    pose_shift(&s.pose, 0.3, 0.2, 0.1, true);
    for (int i = 0; i < 3; i++)
        EXPECT(fabs(s.pose.eye[i] - (m[i][3] + 0.3 * m[i][0] + 0.2 * m[i][1] + 0.1 * m[i][2])) <
               1e-6, "component %d is shifted elsewhere", i);
    EXPECT(fabs(pose_distance(&s.pose) - far / 2) < 1e-6, "the pivot is left behind");
    lab_clear(&s.lab);
}

/* ---- a session by sockets ---- */

typedef struct { int status; char *head, *body; size_t n; } Reply;

/* All that comes till the other side closes. */
static Reply hear(int fd)
{
    static char *all;                           /* of the last reply */
    size_t n = 0, room = 1 << 16;
    Reply r = { 0, NULL, NULL, 0 };
    ssize_t more;

    free(all);
    all = malloc(room);
    while (all && (more = recv(fd, all + n, room - n - 1, 0)) > 0)
        if ((n += (size_t)more) + 1 == room)
            all = realloc(all, room *= 2);
    REQUIRE(all, "no memory");
    close(fd);
    all[n] = 0;
    r.head = all;
    r.body = strstr(all, "\r\n\r\n");
    if (n && r.body && sscanf(all, "HTTP/1.1 %d ", &r.status) == 1) {
        r.body += 4;
        r.n = n - (size_t)(r.body - all);
    }
    return r;
}

static Reply ask_text(const View *v, const char *text)
{
    int fd = dial(INADDR_LOOPBACK, v->port);

    REQUIRE(fd >= 0, "nobody is there: %s", strerror(errno));
    send(fd, text, strlen(text), MSG_NOSIGNAL);
    return hear(fd);
}

static Reply ask(const View *v, const char *method, const char *word)
{
    char text[1000];

    snprintf(text, sizeof text, "%s /%s/%s HTTP/1.1\r\nHost: 127.0.0.1:%d\r\n\r\n", method,
             v->token, word, v->port);
    return ask_text(v, text);
}

static Reply ask_well(const View *v, const char *method, const char *word)
{
    Reply r = ask(v, method, word);
    REQUIRE(r.status == 200, "%s: %d %s", word, r.status, r.body ? r.body : "nothing");
    return r;
}

/* The number behind the k-th "key": of a state. */
static double state_number(const Reply *r, const char *key, int k)
{
    char name[60];
    const char *at = r->body;

    snprintf(name, sizeof name, "\"%s\":", key);
    for (; k >= 0 && at; k--)
        at = (at = strstr(at, name)) ? at + strlen(name) : NULL;
    REQUIRE(at, "the state has no %s", key);
    return strtod(at, NULL);
}

/* Until the pane has had all its samples of what is wanted now. */
static void await_all(const View *v, int pane, double spp)
{
    double change = 0;

    for (;;) {
        char word[60];
        Reply r;
        snprintf(word, sizeof word, "state?since=%.0f", change);
        r = ask_well(v, "GET", word);
        change = state_number(&r, "change", 0);
        if (state_number(&r, "of", pane) == state_number(&r, "wanted", 0) &&
            state_number(&r, "scale", pane) == 1 && state_number(&r, "spp", 1 + pane) >= spp)
            return;
    }
}

/* The picture as the page gets it against a file that `render` wrote. */
static void expect_picture(const View *v, const char *query, const char *file)
{
    Reply r = ask_well(v, "GET", query);
    size_t size, w = 0, h = 0;
    const char *have = cli_read(file, &size), *at = strstr(r.head, "X-Picture: ");

    REQUIRE(at && sscanf(at, "X-Picture: %zu %zu 1 ", &w, &h) == 2 && r.n == 4 * w * h &&
            size > 3 * w * h, "%s: %s", query, r.head);
    have += size - 3 * w * h;                   /* behind the head of a .ppm */
    for (size_t i = 0; i < w * h; i++)
        if (memcmp(r.body + 4 * i, have + 3 * i, 3) || (unsigned char)r.body[4 * i + 3] != 255) {
            EXPECT(false, "%s: pixel %d is another", query, (int)i);
            return;
        }
}

/* What is seen is what `render` makes of the same: by two methods, on other structures, with tone
 * mapping and noise filter. */
static void pictures(void)
{
    View v;

    cli_scene();
    CLI_WORKS("tiny.pbrt --quiet --size 40x30 --spp 8 --exposure 1 --tonemap reinhard -o a.ppm");
    CLI_WORKS("tiny.pbrt --quiet --size 40x30 --spp 8 --integrator ao:samples=2 -o b.ppm");
    CLI_WORKS("tiny.pbrt --quiet --size 40x30 --spp 8 --integrator ao:samples=2 "
              "--denoise gaussian -o c.ppm");
    view_start(&v, "--size 40x30 --spp 8");
    await_all(&v, 0, 8);
    expect_picture(&v, "image?pane=0&exposure=1&tonemap=reinhard", "a.ppm");
    ask_well(&v, "POST", "set?what=integrator2&to=ao:samples%3D2");
    ask_well(&v, "POST", "set?what=split&to=on");
    await_all(&v, 0, 8);
    await_all(&v, 1, 8);
    expect_picture(&v, "image?pane=0&exposure=1&tonemap=reinhard", "a.ppm");
    expect_picture(&v, "image?pane=1", "b.ppm");
    expect_picture(&v, "image?pane=1&denoise=gaussian", "c.ppm");
    ask_well(&v, "POST", "set?what=accel&to=lbvh:bits%3D8");
    await_all(&v, 0, 8);
    expect_picture(&v, "image?pane=0&exposure=1&tonemap=reinhard", "a.ppm");
    view_end(&v);
}

/* A camera that has been moved shows something else, and the first view again what it was. */
static void moves(void)
{
    static const char *const HOWS[] = { "orbit", "turn", "pan", "zoom", "walk" };
    View v;
    Reply r;

    cli_scene();
    CLI_WORKS("tiny.pbrt --quiet --size 40x30 --spp 2 -o a.ppm");
    view_start(&v, "--size 40x30 --spp 2");
    await_all(&v, 0, 2);
    for (int k = 0; k < 5; k++) {
        char *before, word[60];
        size_t n;
        r = ask_well(&v, "GET", "image?pane=0");
        n = r.n;
        before = malloc(n);
        REQUIRE(before, "no memory");
        memcpy(before, r.body, n);
        snprintf(word, sizeof word, "move?how=%s&x=0.05&y=0.03&z=0.1", HOWS[k]);
        ask_well(&v, "POST", word);
        await_all(&v, 0, 2);
        r = ask_well(&v, "GET", "image?pane=0");
        EXPECT(r.n == n && memcmp(before, r.body, n), "%s changes nothing", HOWS[k]);
        free(before);
    }
    ask_well(&v, "POST", "view?what=save");
    ask_well(&v, "POST", "view?what=first");
    await_all(&v, 0, 2);
    expect_picture(&v, "image?pane=0", "a.ppm");
    ask_well(&v, "POST", "view?what=next");
    r = ask_well(&v, "GET", "state");
    EXPECT(state_number(&r, "views", 0) == 1 && strstr(r.body, "\"transform\":\"Transform ["),
           "views");
    view_end(&v);
}

/* ---- who is let in ---- */

static int status_of(const View *v, const char *method, const char *path, const char *fields)
{
    char text[3000];
    Reply r;

    snprintf(text, sizeof text, "%s %s HTTP/1.1\r\n%s\r\n", method, path, fields);
    r = ask_text(v, text);
    EXPECT(r.status != 200 || !strstr(r.body, "root:"), "a file has been read");
    return r.status;
}

static void doors(void)
{
    static const char *const PLACES[] = {
        "/%s/../../../../etc/passwd", "/%s//etc/passwd", "/%s/%%2e%%2e/etc/passwd", "/%s/page",
        "/%s/tiny.pbrt", "/%s/state/", "/%s/State",
    };
    char host[60], path[200], other[TOKEN_LENGTH + 1];
    View v;
    int fd;

    cli_scene();
    view_start(&v, "--size 8x8 --spp 1");
    snprintf(host, sizeof host, "Host: localhost:%d\r\n", v.port);
    snprintf(path, sizeof path, "/%s/state", v.token);
    EXPECT(status_of(&v, "GET", path, host) == 200, "it is not let in");
    EXPECT(status_of(&v, "POST", path, host) == 405, "a question as a change");
    EXPECT(status_of(&v, "GET", path, "Host: evil.example\r\n") == 403, "another host");
    EXPECT(status_of(&v, "GET", path, "Host: 127.0.0.1\r\n") == 403, "another port");
    snprintf(host, sizeof host, "Host: 127.0.0.1:%d\r\nOrigin: http://evil.example\r\n", v.port);
    EXPECT(status_of(&v, "GET", path, host) == 403, "another origin");
    snprintf(host, sizeof host, "Host: 127.0.0.1:%d\r\n", v.port);
    for (int k = 0; k < TOKEN_LENGTH; k++) {
        memcpy(other, v.token, sizeof other);
        other[k] = other[k] == '0' ? '1' : '0';
        snprintf(path, sizeof path, "/%s/state", other);
        EXPECT(status_of(&v, "GET", path, host) == 403, "a token wrong at %d", k);
    }
    EXPECT(status_of(&v, "GET", "/", host) == 403 && status_of(&v, "GET", "/state", host) == 403,
           "no token");
    for (size_t k = 0; k < sizeof PLACES / sizeof *PLACES; k++) {
        snprintf(path, sizeof path, PLACES[k], v.token);
        EXPECT(status_of(&v, "GET", path, host) == 404, "%s", path);
    }
    fd = dial(INADDR_LOOPBACK + 1, v.port);     /* 127.0.0.2 is this machine, too */
    EXPECT(fd < 0, "it listens elsewhere");
    view_end(&v);
}

/* Errors come as text, say what is wrong, and change nothing. */
static void errors(void)
{
    static const struct { const char *word, *text; } CASES[] = {
        { "set?what=integrator&to=nonsense", "unknown integrator 'nonsense'" },
        { "set?what=integrator&to=path:maxdepth%3Dx", "maxdepth" },
        { "set?what=accel&to=lbvh:bits%3D9", "bits" },
        { "set?what=filter&to=", "filter" },
        { "set?what=colour&to=red", "there is no 'colour'" },
        { "set?what=split&to=maybe", "not 'maybe'" },
        { "set?what=integrator", "to what?" },
        { "move?how=jump&x=1", "no such move" },
        { "move", "no such move" },
        { "view?what=last", "no such view" },
    };
    View v;
    Reply r;

    cli_scene();
    CLI_WORKS("tiny.pbrt --quiet --size 8x8 --spp 1 -o a.ppm");
    view_start(&v, "--size 8x8 --spp 1");
    for (size_t k = 0; k < sizeof CASES / sizeof *CASES; k++) {
        r = ask(&v, "POST", CASES[k].word);
        EXPECT(r.status == 400 && strstr(r.body, CASES[k].text), "%s: %d %s", CASES[k].word,
               r.status, r.body);
    }
    await_all(&v, 0, 1);
    r = ask(&v, "GET", "image?pane=0&tonemap=nonsense");
    EXPECT(r.status == 400 && strstr(r.body, "unknown tone mapper"), "%d %s", r.status, r.body);
    expect_picture(&v, "image?pane=0&exposure=nan", "a.ppm");
    ask_well(&v, "POST", "move?how=walk&x=1e30&y=-1e30");
    ask_well(&v, "POST", "view?what=first");
    await_all(&v, 0, 1);
    expect_picture(&v, "image?pane=0", "a.ppm");
    view_end(&v);
    EXPECT(!v.run.err[0], "standard error has: %s", v.run.err);
}

/* ---- many and odd visitors ---- */

static int come_silently(const View *v, int k)
{
    int fd = dial(INADDR_LOOPBACK, v->port);

    REQUIRE(fd >= 0, "visitor %d: %s", k, strerror(errno));
    send(fd, "GET /", (size_t)k % 6, MSG_NOSIGNAL);
    return fd;
}

#define PATIENCE 4.0                    /* seconds that the server surely waits for silent ones */

/* Silent ones, slow ones, ones that go away, much too much: others are served meanwhile. */
static void visitors(void)
{
    enum { FEW = 8, MANY = 32, TRIES = 1000 };
    static char flood[100000];
    int silent[MANY], tries = 0, busy;
    double start;
    View v;
    Reply r;

    cli_scene();
    view_start(&v, "--size 8x8 --spp 1");
    for (int k = 0; k < FEW; k++)
        silent[k] = come_silently(&v, k);
    for (int k = 0; k < 20; k++)
        close(dial(INADDR_LOOPBACK, v.port));
    memset(flood, 'a', sizeof flood - 1);
    EXPECT(ask_text(&v, flood).status == 431, "a flood");
    await_all(&v, 0, 1);
    r = ask_well(&v, "GET", "");
    EXPECT(strstr(r.head, "Content-Security-Policy: default-src 'none'") &&
           strstr(r.body, "<canvas") && !strstr(r.body, "http"), "the page");
    ask_well(&v, "GET", "script.js");
    ask_well(&v, "GET", "style.css");
    for (int k = 0; k < FEW; k++)
        close(silent[k]);
    start = clock_wall();
    for (int k = 0; k < MANY; k++)
        silent[k] = come_silently(&v, k);
    busy = ask(&v, "GET", "style.css").status;      /* 0: gone before it had asked */
    EXPECT(busy == 503 || !busy || clock_wall() - start > PATIENCE, "one too many: %d", busy);
    for (int k = 0; k < FEW; k++)
        close(silent[k]);
    while (ask(&v, "GET", "style.css").status != 200)
        REQUIRE(++tries < TRIES, "nobody is let in after some have gone");
    view_end(&v);
    for (int k = FEW; k < MANY; k++)
        close(silent[k]);
}

/* ---- no memory ---- */

static const char small_scene[] =
    "LookAt 0 0 -5  0 0 0  0 1 0  Camera \"perspective\"\n"
    "Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 12\n"
    "WorldBegin  LightSource \"infinite\"  Shape \"sphere\"\n";

static HttpStatus ask_here(const Door *door, bool post, const char *word, const char *query)
{
    HttpRequest r = { 0 };
    char path[80];
    HttpStatus status;
    Answer a;

    snprintf(path, sizeof path, "/%s/%s", door->token, word);
    r.post = post;
    r.path = (Word){ path, strlen(path) };
    r.query = (Word){ query, strlen(query) };
    r.host = (Word){ "127.0.0.1:7", 11 };
    answer(door, &r, &a);
    status = a.status;
    answer_clear(&a);
    return status;
}

/* Whichever request for memory fails, of a render or of an answer: the next ones are served, and
 * nothing is left behind. */
static void memory(void)
{
    ReadLimits limits = READ_LIMITS_DEFAULT;
    long blocks = mem_blocks();
    RenderRequest q = { 0 };
    Door door = { 0 };
    RenderSettings s;
    SceneFile f;
    Snapshot shot;

    q.threads = 1;
    q.spp = 2;
    q.max_pixels = limits.max_pixels;
    messages_quiet(true);
    REQUIRE(scenefile_parse(&f, "small", small_scene, sizeof small_scene - 1, &limits) &&
            settings_resolve(&s, &q, &f) && scene_build(f.scene, s.accel, &s.accel_opts, 1) &&
            (door.session = session_new(&f, &s)) != NULL, "no session");
    memset(door.token, 'a', TOKEN_LENGTH);
    door.port = 7;
    for (unsigned long k = 1; k < 90; k++) {
        mem_fail_at(k, false);
        ask_here(&door, true, "move", "how=orbit&x=0.01");
        ask_here(&door, false, "state", "");
        ask_here(&door, false, "tables", "");
        ask_here(&door, false, "image", "denoise=gaussian&tonemap=local");
        ask_here(&door, false, "pixel", "x=3&y=3");
        ask_here(&door, true, "set", k % 2 ? "what=integrator&to=ao:samples=2"
                                           : "what=accel&to=bvh");
        mem_fail_at(0, false);
    }
    EXPECT(ask_here(&door, true, "set", "what=integrator&to=path") == HTTP_OK, "no more methods");
    EXPECT(!session_has_quit(door.session), "it has given up");
    for (uint64_t at = 0; !session_snapshot(door.session, 0, &shot);)
        at = session_wait(door.session, at, 1);
    image_clear(&shot.image);
    session_free(door.session);
    scenefile_clear(&f);
    EXPECT(mem_blocks() == blocks, "%ld blocks are left", mem_blocks() - blocks);
}

/* Every member of every list that can be chosen stands in the tables, with its options. */
static void tables(void)
{
    View v;
    Reply r;

    cli_scene();
    view_start(&v, "--size 8x8 --spp 1");
    r = ask_well(&v, "GET", "tables");
    for (int k = 0; integrators[k]; k++) {
        const KindInfo *info = &integrators[k]->info;
        char name[80];
        snprintf(name, sizeof name, "{\"name\":\"%s\"", info->name);
        EXPECT(strstr(r.body, name), "no %s", name);
        for (int i = 0; info->options && info->options[i].key; i++) {
            snprintf(name, sizeof name, "\"key\":\"%s\"", info->options[i].key);
            EXPECT(strstr(r.body, name), "no %s", name);
        }
    }
    view_end(&v);
}

const TestCase test_view[] = {
    { "orbit", orbit, false },
    { "upright", upright, false },
    { "other_moves", other_moves, false },
    { "pictures", pictures, false },
    { "moves", moves, false },
    { "doors", doors, false },
    { "errors", errors, false },
    { "visitors", visitors, false },
    { "memory", memory, false },
    { "tables", tables, false },
    { NULL, NULL, false }
};

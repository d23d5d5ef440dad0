/* view.c -- the viewer: how long after the hand has moved the picture does.
 *
 * A session over 100 000 triangles is asked as a page asks it, but without sockets: a move of the
 * camera, the state until there is a picture of that or of a later one, and this picture's bytes.
 * Once with a rest between the moves, and once with a move sixty times a second, as a hand
 * drags. */
#include "bench/bench.h"

#include "view/answer.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { MOVES = 15, DRAG_MOVES = 180 };

static const char text[] =
    "LookAt 1.2 -2 1  0 0 0.5  0 0 1  Camera \"perspective\" \"float fov\" 40\n"
    "Film \"rgb\" \"integer xresolution\" 1280 \"integer yresolution\" 720\n"
    "WorldBegin\n"
    "LightSource \"infinite\" \"rgb L\" [0.5 0.6 0.8]\n"
    "LightSource \"distant\" \"rgb L\" [2 2 1.8] \"point3 from\" [2 -1 3]\n"
    "Material \"coateddiffuse\"\n"
    "Shape \"generated\" \"string kind\" \"statue\" \"integer triangles\" 100000\n"
    "Material \"diffuse\"\n"
    "Shape \"disk\" \"float radius\" 6\n";

static void request(Door *door, bool post, const char *word, Answer *a)
{
    char path[100], host[40];
    const char *query = strchr(word, '?');
    HttpRequest r;

    snprintf(path, sizeof path, "/%s/%.*s", door->token,
             (int)(query ? (size_t)(query - word) : strlen(word)), word);
    snprintf(host, sizeof host, "127.0.0.1:%d", door->port);
    memset(&r, 0, sizeof r);
    r.post = post;
    r.path = (Word){ path, strlen(path) };
    r.query = query ? (Word){ query + 1, strlen(query + 1) } : (Word){ "", 0 };
    r.host = (Word){ host, strlen(host) };
    answer(door, &r, a);
}

static double number_behind(const Answer *a, const char *key)
{
    const char *at = a->body ? strstr(a->body, key) : NULL;
    return at ? strtod(at + strlen(key), NULL) : 0;
}

/* What is wanted, which picture there is, and its scale; waits for a change after *change. */
static void look(Door *door, double *change, double *wanted, double *of, double *scale)
{
    char word[60];
    Answer a;

    snprintf(word, sizeof word, "state?since=%.0f", *change);
    request(door, false, word, &a);
    *change = number_behind(&a, "\"change\":");
    *wanted = number_behind(&a, "\"wanted\":");
    *of = number_behind(&a, "\"of\":");
    *scale = number_behind(&a, "\"scale\":");
    answer_clear(&a);
}

static void post_move(Door *door)
{
    Answer a;
    request(door, true, "move?how=orbit&x=0.01&y=0.001", &a);
    answer_clear(&a);
}

static void get_image(Door *door)
{
    Answer a;
    request(door, false, "image?pane=0&tonemap=reinhard&exposure=1", &a);
    answer_clear(&a);
}

static void sleep_for(double seconds)
{
    struct timespec t;
    t.tv_sec = (time_t)seconds;
    t.tv_nsec = (long)((seconds - (double)t.tv_sec) * 1e9);
    nanosleep(&t, NULL);
}

static void report(const char *what, double *ms, int n, double scale)
{
    double most = 0;

    for (int k = 0; k < n; k++)
        most = ms[k] > most ? ms[k] : most;
    printf("view\t100k triangles, 1280x720, %s\tpicture after: median %.0f ms, most %.0f ms\t"
           "of 1/%.0f the width\tasked for: 150 ms\n", what, median(ms, n), most, scale);
}

/* Each move after the picture of the last one has become whole. */
static void at_rest(Door *door)
{
    double ms[MOVES], change = 0, wanted, of, scale = 0, start, goal, first = 0;

    for (int k = 0; k < MOVES; k++) {
        do
            look(door, &change, &wanted, &of, &scale);
        while (of < wanted || scale > 1);
        start = clock_wall();
        post_move(door);
        goal = wanted + 1;
        do
            look(door, &change, &wanted, &of, &scale);
        while (of < goal);
        get_image(door);
        ms[k] = 1e3 * (clock_wall() - start);
        first = scale;
    }
    report("one move", ms, MOVES, first);
}

typedef struct { Door *door; double moved[DRAG_MOVES]; double first; } Hand;

static void *drag(void *arg)
{
    Hand *h = arg;

    for (int k = 0; k < DRAG_MOVES; k++) {
        h->moved[k] = clock_wall();
        post_move(h->door);
        sleep_for(1.0 / 60);
    }
    return NULL;
}

/* How old the latest move is that the picture shows, when it has come. */
static void while_dragged(Door *door)
{
    double ms[DRAG_MOVES], change = 0, wanted, of, scale = 0, last;
    pthread_t thread;
    Hand h;
    int n = 0;

    look(door, &change, &wanted, &of, &scale);
    h.door = door;
    h.first = last = wanted;
    if (!work_thread(&thread, drag, &h))
        return;
    while (last < h.first + DRAG_MOVES && n < DRAG_MOVES) {
        look(door, &change, &wanted, &of, &scale);
        if (of <= last)
            continue;
        get_image(door);
        last = of;
        ms[n++] = 1e3 * (clock_wall() - h.moved[(int)(of - h.first) - 1]);
    }
    pthread_join(thread, NULL);
    report("dragged, 60 moves a second", ms, n, scale);
    printf("view\t100k triangles, 1280x720, dragged\t%d pictures in 3 s\n", n);
}

void bench_view(void)
{
    ReadLimits limits = READ_LIMITS_DEFAULT;
    RenderRequest q;
    RenderSettings s;
    SceneFile f;
    Door door;

    memset(&q, 0, sizeof q);
    q.threads = processors();
    q.spp = 4096;
    q.max_pixels = limits.max_pixels;
    if (!scenefile_parse(&f, "view", text, sizeof text - 1, &limits))
        return;
    if (settings_resolve(&s, &q, &f) && scene_build(f.scene, s.accel, &s.accel_opts, s.threads)) {
        memset(&door, 0, sizeof door);
        memset(door.token, 'a', TOKEN_LENGTH);
        door.port = 1;
        door.session = session_new(&f, &s);
        if (door.session) {
            at_rest(&door);
            while_dragged(&door);
        }
        session_free(door.session);
    }
    scenefile_clear(&f);
}

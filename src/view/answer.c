/* answer.c -- the code of `answer.h`.
 *
 * Addresses   http://127.0.0.1:PORT/TOKEN/WORD, and what WORDs there are is the table `words`: no
 *             part of an address is ever taken for the name of a file. Whoever has no token learns
 *             nothing but that.
 * Host        must be this machine by its own name or number, so that no foreign name that has been
 *             made to point here opens the door; Origin, where a browser says one, likewise. */
#include "view/answer.h"

#include "base/number.h"
#include "image/denoise.h"
#include "image/format.h"
#include "view/describe.h"
#include "view/page.h"

#include <stdio.h>
#include <string.h>

#define WAIT_SECONDS 10.0

/* ---- answers ---- */

static void answer_bytes(Answer *a, const char *type, char *body, size_t n)
{
    if (!body) {
        answer_error(a, HTTP_FAILED, "out of memory");
        return;
    }
    *a = (Answer){ HTTP_OK, type, body, n, "" };
}

void answer_error(Answer *a, HttpStatus status, const char *text)
{
    size_t n = strlen(text);
    char *body = mem_array(n + 1, 1);

    if (body) {
        memcpy(body, text, n);
        body[n++] = '\n';
    }
    *a = (Answer){ status, "text/plain; charset=utf-8", body, body ? n : 0, "" };
}

void answer_clear(Answer *a) { mem_free(a->body); }

static void answer_lines(Answer *a, const char *type, const char *const *lines)
{
    size_t n = 0, at = 0;
    char *body;

    for (int k = 0; lines[k]; k++)
        n += strlen(lines[k]) + 1;
    body = mem_array(n, 1);
    for (int k = 0; body && lines[k]; k++) {
        size_t length = strlen(lines[k]);
        memcpy(body + at, lines[k], length);
        body[at + length] = '\n';
        at += length + 1;
    }
    answer_bytes(a, type, body, n);
}

static void answer_json(Answer *a, Json *j)
{
    if (j->failed) {
        json_clear(j);
        answer_error(a, HTTP_FAILED, "out of memory");
    } else
        answer_bytes(a, "application/json", j->text, j->n);
}

static void answer_done(Answer *a, bool ok, const char *error)
{
    Json j = { 0 };

    if (!ok) {
        answer_error(a, HTTP_BAD, error);
        return;
    }
    json_bool(&j, true);
    answer_json(a, &j);
}

/* ---- values of a query ---- */

static bool number_of(Word query, const char *key, double *v)
{
    char text[60];
    size_t n;

    if (!http_value(query, key, text, sizeof text))
        return false;
    n = strlen(text);
    return n && number_double(text, text + n, v) == n && *v - *v == 0;
}

static double number_or(Word query, const char *key, double other)
{
    double v;
    return number_of(query, key, &v) ? v : other;
}

static int pane_of(Word query) { return number_or(query, "pane", 0) == 1; }

/* ---- the page and what it knows ---- */

static void get_page(Session *s, Word query, Answer *a)
{
    (void)s;
    (void)query;
    answer_lines(a, "text/html; charset=utf-8", page_html);
}

static void get_style(Session *s, Word query, Answer *a)
{
    (void)s;
    (void)query;
    answer_lines(a, "text/css; charset=utf-8", page_style);
}

static void get_script(Session *s, Word query, Answer *a)
{
    (void)s;
    (void)query;
    answer_lines(a, "text/javascript; charset=utf-8", page_script);
}

static void get_tables(Session *s, Word query, Answer *a)
{
    Json j = { 0 };

    (void)s;
    (void)query;
    describe_tables(&j);
    answer_json(a, &j);
}

/* since=N: waits for a change after that one. */
static void get_state(Session *s, Word query, Answer *a)
{
    double since = number_or(query, "since", 0);
    Json j = { 0 };

    if (since >= 1 && since < 9e15)
        session_wait(s, (uint64_t)since, WAIT_SECONDS);
    session_describe(s, &j);
    answer_json(a, &j);
}

/* ---- pictures ---- */

/* How the picture is to be shown: tonemap=, meter=, denoise=NAME[:...], exposure=STOPS. */
typedef struct {
    Display display;
    const Denoiser *denoiser;
    Opts  denoiser_opts;
    int   threads;
    Arena arena;
} Look;

/* One of a list by key; none if the query says nothing. False: said. */
static bool look_kind(Word query, const char *key, const void *list, const char *what,
                      const void **kind, Opts *o, Arena *arena)
{
    char text[LINE_MOST];

    if (!http_value(query, key, text, sizeof text) || !text[0])
        return true;
    *kind = kind_from_text(list, what, text, o, arena);
    return *kind != NULL;
}

static bool look_parse(Look *l, Word query)
{
    const void *tone = NULL, *meter = NULL, *denoiser = NULL;
    bool ok;

    memset(l, 0, sizeof *l);
    l->display.exposure = (float)d_max(-100, d_min(100, number_or(query, "exposure", 0)));
    ok = look_kind(query, "tonemap", tonemaps, "tone mapper", &tone, &l->display.tonemap_opts,
                   &l->arena) &&
         look_kind(query, "meter", meters, "meter", &meter, &l->display.meter_opts, &l->arena) &&
         look_kind(query, "denoise", denoisers, "noise filter", &denoiser, &l->denoiser_opts,
                   &l->arena);
    l->display.tonemap = tone;
    l->display.meter = meter;
    l->denoiser = denoiser;
    return ok;
}

/* False: said. */
static bool denoise(const Look *l, Image *im)
{
    Noisy noisy = { im, NULL, NULL, NULL, NULL, l->threads };
    Image out;

    if (!l->denoiser)
        return true;
    if (!image_init(&out, im->w, im->h))
        return false;
    if (!l->denoiser->run(&noisy, &l->denoiser_opts, &out)) {
        image_clear(&out);
        return false;
    }
    image_clear(im);
    *im = out;
    return true;
}

/* Four bytes a pixel, red, green, blue and 255, as a canvas takes them. NULL: reported. */
static char *pixels_of(const Image *im, const Display *display)
{
    unsigned char *bytes = mem_array((size_t)im->w * im->h, 4), *row = mem_array(im->w, 3);
    Quantiser q;
    bool ok = bytes && row && quantiser_init(&q, display, im);

    for (uint32_t y = 0; ok && y < im->h; y++) {
        unsigned char *to = bytes + (size_t)y * im->w * 4;
        quantiser_row(&q, y, row);
        for (uint32_t x = 0; x < im->w; x++, to += 4) {
            memcpy(to, row + 3 * x, 3);
            to[3] = 255;
        }
    }
    if (ok)
        quantiser_clear(&q);
    mem_free(row);
    if (!ok)
        mem_free(bytes);
    return ok ? (char *)bytes : NULL;
}

/* What is asked for most: X-Picture has its width, height, scale and change. */
static void get_image(Session *s, Word query, Answer *a)
{
    Snapshot shot;
    Look l;
    bool ok = look_parse(&l, query);

    l.threads = session_threads(s);
    *a = (Answer){ HTTP_BAD, NULL, NULL, 0, "" };
    if (ok && !session_snapshot(s, pane_of(query), &shot))
        answer_error(a, HTTP_NOT_FOUND, "there is no picture yet");
    else if (ok) {
        if (denoise(&l, &shot.image)) {
            answer_bytes(a, "application/octet-stream", pixels_of(&shot.image, &l.display),
                         (size_t)shot.image.w * shot.image.h * 4);
            snprintf(a->field, sizeof a->field, "X-Picture: %lu %lu %lu %.0f",
                     (unsigned long)shot.image.w, (unsigned long)shot.image.h,
                     (unsigned long)shot.scale, (double)shot.shown);
        }
        image_clear(&shot.image);
    }
    arena_clear(&l.arena);
}

/* The light at x, y of each pane, as it is, without exposure and filter. */
static void get_pixel(Session *s, Word query, Answer *a)
{
    double x = number_or(query, "x", -1), y = number_or(query, "y", -1);
    Json j = { 0 };

    json_open(&j, '[');
    for (int k = 0; k < PANES; k++) {
        Rgb c;
        if (!session_pixel(s, k, x, y, &c)) {
            json_string(&j, NULL);
            continue;
        }
        json_open(&j, '[');
        json_number(&j, c.r);
        json_number(&j, c.g);
        json_number(&j, c.b);
        json_close(&j, ']');
    }
    json_close(&j, ']');
    answer_json(a, &j);
}

/* ---- changes ---- */

static void post_move(Session *s, Word query, Answer *a)
{
    char how[20];
    bool ok = http_value(query, "how", how, sizeof how);
    double v[3] = { number_or(query, "x", 0), number_or(query, "y", 0), number_or(query, "z", 0) };

    for (int k = 0; k < 3; k++)
        v[k] = d_max(-100, d_min(100, v[k]));
    answer_done(a, ok && session_move(s, how, v[0], v[1], v[2]), "there is no such move");
}

static void post_set(Session *s, Word query, Answer *a)
{
    char what[20], to[LINE_MOST];
    bool ok = http_value(query, "what", what, sizeof what) &&
              http_value(query, "to", to, sizeof to);

    if (!ok)
        answer_error(a, HTTP_BAD, "what is to be set, and to what?");
    else if (session_set(s, what, to))
        answer_done(a, true, NULL);
    else
        *a = (Answer){ HTTP_BAD, NULL, NULL, 0, "" };
}

static void post_view(Session *s, Word query, Answer *a)
{
    char what[20];
    bool ok = http_value(query, "what", what, sizeof what);

    answer_done(a, ok && session_view(s, what), "there is no such view, or no room for more");
}

/* ---- who may ask what ---- */

static const struct {
    const char *word;
    bool post;
    void (*run)(Session *s, Word query, Answer *a);
} words[] = {
    { "", false, get_page }, { "style.css", false, get_style }, { "script.js", false, get_script },
    { "tables", false, get_tables }, { "state", false, get_state }, { "image", false, get_image },
    { "pixel", false, get_pixel }, { "move", true, post_move }, { "set", true, post_set },
    { "view", true, post_view },
};

/* "127.0.0.1:PORT", "localhost:PORT", for an origin with "http://" before it. */
static bool is_here(Word w, const char *before, int port)
{
    static const char *const NAMES[] = { "127.0.0.1", "localhost" };
    char name[60];

    for (int k = 0; k < 2; k++) {
        snprintf(name, sizeof name, "%s%s:%d", before, NAMES[k], port);
        if (word_is_nocase(w, name))
            return true;
    }
    return false;
}

/* "/TOKEN/word": word. All of the token is compared, so that time tells nothing about it. */
static bool has_token(Word path, const char *token, Word *word)
{
    unsigned differ = 0;

    if (path.n < TOKEN_LENGTH + 2 || path.s[0] != '/' || path.s[TOKEN_LENGTH + 1] != '/')
        return false;
    for (int k = 0; k < TOKEN_LENGTH; k++)
        differ |= (unsigned char)(path.s[k + 1] ^ token[k]);
    *word = (Word){ path.s + TOKEN_LENGTH + 2, path.n - TOKEN_LENGTH - 2 };
    return !differ;
}

static void run_word(Session *s, int k, Word query, Answer *a)
{
    Asker asker;

    session_ask(s, &asker);
    words[k].run(s, query, a);
    session_asked(s, &asker);
    if (!a->body)
        answer_error(a, a->status == HTTP_OK ? HTTP_FAILED : a->status,
                     asker.said[0] ? asker.said : "it could not be done");
}

void answer(const Door *door, const HttpRequest *r, Answer *a)
{
    Word word;

    if (!is_here(r->host, "", door->port) ||
        (r->origin.s && !is_here(r->origin, "http://", door->port))) {
        answer_error(a, HTTP_FORBIDDEN, "this is for visitors of this machine alone");
        return;
    }
    if (!has_token(r->path, door->token, &word)) {
        answer_error(a, HTTP_FORBIDDEN, "the address has a secret part, which this one has not");
        return;
    }
    for (size_t k = 0; k < sizeof words / sizeof *words; k++)
        if (word_is(word, words[k].word)) {
            if (r->post == words[k].post)
                run_word(door->session, (int)k, r->query, a);
            else
                answer_error(a, HTTP_METHOD, "GET is for questions, POST for changes");
            return;
        }
    answer_error(a, HTTP_NOT_FOUND, "there is nothing here");
}

/* preview.c -- see preview.h.
 *
 * Terminal    It is asked for its other screen, without cursor and without a new line at the right
 *             edge, and given back the first one at the end, be it normal, by a signal or after an
 *             error. Its last line is left to the line of progress.
 * Size        It is asked for before each picture: so a new size is right with the next one.
 * Cost        Pictures are so far apart that a tenth of the time at most goes into them. */
#include "cli/preview.h"

#include "base/clock.h"
#include "base/progress.h"
#include "cli/interrupt.h"
#include "image/halfblocks.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define ENTER "\033[?1049h\033[?25l\033[?7l\033[2J"
#define LEAVE "\033[0m\033[?7h\033[?25h\033[?1049l"
#define LOOK_SECONDS 0.1
enum { COST = 9 };                      /* times what a picture took, nobody looks */

/* All of it, whatever signals come; a terminal that is gone is no error. */
static void send_text(const char *text, size_t n)
{
    while (n > 0) {
        ssize_t done = write(2, text, n);
        if (done < 0 && errno != EINTR)
            return;
        if (done > 0) {
            text += done;
            n -= (size_t)done;
        }
    }
}

/* ---- the terminal ---- */

/* Ctrl-Z: the shell gets its own screen. Called again, it goes on with an empty one, which the next
 * picture fills. */
static void on_suspend(int sig)
{
    int kept = errno;

    (void)sig;
    send_text(LEAVE, sizeof LEAVE - 1);
    kill(getpid(), SIGSTOP);
    send_text(ENTER, sizeof ENTER - 1);
    errno = kept;
}

static void catch_suspension(void (*handler)(int))
{
    struct sigaction a;

    memset(&a, 0, sizeof a);
    a.sa_handler = handler;
    a.sa_flags = SA_RESTART;
    sigaction(SIGTSTP, &a, NULL);
}

static bool says(const char *variable, const char *word)
{
    const char *value = getenv(variable);
    return value && strstr(value, word);
}

static bool has_true_colour(void)
{
    return says("COLORTERM", "truecolor") || says("COLORTERM", "24bit") || says("TERM", "-direct");
}

static bool can_show(void)
{
    const char *term = getenv("TERM");
    return isatty(2) == 1 && term && *term && strcmp(term, "dumb") != 0;
}

/* ---- pictures ---- */

/* False: out of memory, reported. */
static bool draw_small(const Preview *p, const Image *small, int columns, int rows)
{
    char *text = mem_array(HALFBLOCKS_ROOM(small->w, small->h), 1);

    if (!text)
        return false;
    send_text(text, halfblocks_text(small, columns, rows, p->true_colour, text));
    mem_free(text);
    return true;
}

static bool draw(const Preview *p, const Film *film)
{
    Image all, small;
    uint32_t w, h;
    int columns, rows;
    bool ok;

    terminal_size(&columns, &rows);
    halfblocks_fit(film->w, film->h, columns, rows > 1 ? rows - 1 : 1, &w, &h);
    if (!image_init(&all, film->w, film->h))
        return false;
    film_picture(film, 0, &all);
    ok = image_init(&small, w, h);
    if (ok) {
        ok = halfblocks_shrink(&all, p->display, &small) && draw_small(p, &small, columns, rows);
        image_clear(&small);
    }
    image_clear(&all);
    return ok;
}

/* Without memory for a picture the render ends: it will hardly have any itself. */
static bool look(void *ctx, const Film *film, const RenderReport *so_far)
{
    Preview *p = ctx;
    double start = clock_wall();
    bool ok;

    (void)so_far;
    if (start < p->draw_at)
        return true;
    ok = draw(p, film);
    p->draw_at = start + COST * (clock_wall() - start);
    return ok;
}

/* ---- what is said meanwhile ---- */

static void hold(void *ctx, const char *line)
{
    Preview *p = ctx;
    size_t n = strlen(line);

    if (n + 1 >= sizeof p->held - p->nheld) {
        p->lost++;
        return;
    }
    memcpy(p->held + p->nheld, line, n);
    p->nheld += n + 1;
    p->held[p->nheld - 1] = '\n';
}

bool preview_start(Preview *p, const Display *display, RenderSettings *s)
{
    memset(p, 0, sizeof *p);
    if (!can_show())
        return warn_at((Place){ NULL, 0, 0 }, "--preview wants a terminal on standard error: there "
                       "is no preview");
    p->display = display;
    p->true_colour = has_true_colour();
    p->watch = (RenderWatch){ p, look, NULL, NULL, 0, 0, LOOK_SECONDS };
    s->watch = &p->watch;
    p->on = true;
    messages_to(hold, p);
    interrupts_farewell(LEAVE);
    catch_suspension(on_suspend);
    send_text(ENTER, sizeof ENTER - 1);
    return true;
}

void preview_end(Preview *p)
{
    if (!p->on)
        return;
    send_text(LEAVE, sizeof LEAVE - 1);
    catch_suspension(SIG_DFL);
    interrupts_farewell(NULL);
    messages_to(NULL, NULL);
    send_text(p->held, p->nheld);
    if (p->lost)
        note("and %u more messages", p->lost);
    p->on = false;
}

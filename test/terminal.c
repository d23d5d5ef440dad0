/* terminal.c -- see terminal.h. */
#define _XOPEN_SOURCE 700               /* pseudo terminals */
#include "test/terminal.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

enum { MOST_MS = 60000 };

static char slave[100], colour_term[60], term[60];

void terminal_open(Terminal *t, int columns, int rows, const char *variables)
{
    memset(t, 0, sizeof *t);
    t->fd = posix_openpt(O_RDWR | O_NOCTTY);
    if (t->fd < 0 || grantpt(t->fd) || unlockpt(t->fd) || !ptsname(t->fd))
        test_skip("no pseudo terminal: %s", strerror(errno));
    fcntl(t->fd, F_SETFD, FD_CLOEXEC);
    snprintf(slave, sizeof slave, "%s", ptsname(t->fd));
    term[0] = colour_term[0] = 0;
    sscanf(variables, "TERM=%59s COLORTERM=%59s", term, colour_term);
    t->cursor = t->wraps = true;
    t->ink = t->ground = -1;
    terminal_resize(t, columns, rows);
}

/* The slave stays open under its own number: what it has sent would else be lost on some systems
 * before we have read it. */
void terminal_take(void)
{
    int fd;

    setsid();
    fd = open(slave, O_RDWR);
    if (fd < 0 || dup2(fd, 2) < 0)
        _exit(96);
    close(fd);
    setenv("TERM", term, 1);
    setenv("COLORTERM", colour_term, 1);
}

void terminal_resize(Terminal *t, int columns, int rows)
{
    struct winsize size = { 0 };

    size.ws_col = (unsigned short)columns;
    size.ws_row = (unsigned short)rows;
    REQUIRE(ioctl(t->fd, TIOCSWINSZ, &size) == 0, "TIOCSWINSZ: %s", strerror(errno));
    t->columns = columns;
    t->rows = rows;
}

void terminal_close(Terminal *t) { close(t->fd); }

/* ---- what comes ---- */

static void wipe(Terminal *t, int x0, int y0, int x1, int y1)
{
    for (int y = y0; y < y1; y++)
        for (int x = x0; x < x1; x++)
            t->page[t->other].cell[y][x] = (TermCell){ -1, -1, ' ', false };
}

static int32_t of_256(int n)
{
    int level[3];

    if (n >= 232)
        return 0x010101 * (8 + 10 * (n - 232));
    for (int k = 2; k >= 0; k--) {
        level[k] = k == 2 ? (n - 16) % 6 : k == 1 ? (n - 16) / 6 % 6 : (n - 16) / 36;
        level[k] = level[k] ? 55 + 40 * level[k] : 0;
    }
    return level[0] << 16 | level[1] << 8 | level[2];
}

static void set_colours(Terminal *t, const int *p, int n)
{
    if (n == 1 && p[0] == 0)
        t->ink = t->ground = -1;
    else if (n == 1 && p[0] == 49)
        t->ground = -1;
    else if ((n == 5 && p[1] == 2) || (n == 3 && p[1] == 5)) {
        int32_t c = n == 5 ? p[2] << 16 | p[3] << 8 | p[4] : of_256(p[2]);
        REQUIRE(p[0] == 38 || p[0] == 48, "colour %d", p[0]);
        *(p[0] == 38 ? &t->ink : &t->ground) = c;
    } else
        REQUIRE(false, "colours of %d numbers, %d first", n, p[0]);
}

static void change_page(Terminal *t, bool other)
{
    if (other && !t->other) {
        t->kept_x = t->x;
        t->kept_y = t->y;
    } else if (!other && t->other) {
        t->x = t->kept_x;
        t->y = t->kept_y;
    }
    t->other = other;
}

static void set_mode(Terminal *t, int mode, bool on)
{
    switch (mode) {
    case 7: t->wraps = on; break;
    case 25: t->cursor = on; break;
    case 1049: change_page(t, on); break;
    default: REQUIRE(false, "mode %d", mode);
    }
}

static void move_to(Terminal *t, int row, int column)
{
    t->y = row < 1 ? 0 : row > t->rows ? t->rows - 1 : row - 1;
    t->x = column < 1 ? 0 : column > t->columns ? t->columns - 1 : column - 1;
    if (!t->x && !t->y) {
        t->frames++;
        t->whole_x = t->most_x;
        t->whole_y = t->most_y;
        t->most_x = t->most_y = 0;
    }
}

/* The sequence pending[0..npending) that ends with `last`. */
static void obey(Terminal *t, char last)
{
    bool mode = t->pending[2] == '?';
    int p[8] = { 0 }, n = 0;
    char *at = t->pending + 2 + mode;

    for (; n < 8; n++) {
        p[n] = (int)strtol(at, &at, 10);
        if (*at != ';') {
            n++;
            break;
        }
        at++;
    }
    if (mode && (last == 'h' || last == 'l'))
        set_mode(t, p[0], last == 'h');
    else if (last == 'H')
        move_to(t, p[0], p[1]);
    else if (last == 'm')
        set_colours(t, p, n);
    else if (last == 'K')
        wipe(t, t->x, t->y, t->columns, t->y + 1);
    else if (last == 'J')
        wipe(t, 0, p[0] == 2 ? 0 : t->y, t->columns, t->rows);
    else
        REQUIRE(false, "the sequence %s is not known", t->pending + 1);
}

static void put(Terminal *t, char c, bool block)
{
    TermCell cell = { t->ink, t->ground, c, block };

    if (t->x >= t->columns) {
        t->x = t->wraps ? 0 : t->columns - 1;
        t->y += t->wraps && t->y < t->rows - 1;
    }
    t->page[t->other].cell[t->y][t->x++] = cell;
    if (block) {
        t->most_x = t->x > t->most_x ? t->x : t->most_x;
        t->most_y = t->y + 1 > t->most_y ? t->y + 1 : t->most_y;
    }
}

/* In a sequence, or in the three bytes of a half block: until it is whole, or another begins. */
static void take_pending(Terminal *t, char c)
{
    if (c == '\033')
        t->npending = 0;
    REQUIRE(t->npending + 1 < sizeof t->pending, "a sequence without an end");
    t->pending[t->npending++] = c;
    t->pending[t->npending] = 0;
    if (t->pending[0] == '\033' ? t->npending > 2 && ((c >= 'A' && c <= 'Z') ||
                                                      (c >= 'a' && c <= 'z'))
                                : t->npending == 3) {
        if (t->pending[0] == '\033')
            obey(t, c);
        else {
            EXPECT(!strcmp(t->pending, "\xe2\x96\x80"), "another character");
            put(t, '#', true);
        }
        t->npending = 0;
    }
}

static void take(Terminal *t, char c)
{
    if (t->npending || c == '\033' || c == '\xe2')
        take_pending(t, c);
    else if (c == '\r')
        t->x = 0;
    else if (c == '\n') {
        if (t->y < t->rows - 1)
            t->y++;
        else {
            memmove(t->page[t->other].cell[0], t->page[t->other].cell[1],
                    (size_t)(t->rows - 1) * sizeof t->page[0].cell[0]);
            wipe(t, 0, t->rows - 1, t->columns, t->rows);
        }
    } else
        put(t, c, false);
}

bool terminal_read(Terminal *t, unsigned frames)
{
    unsigned first = t->frames;
    struct pollfd p = { t->fd, POLLIN, 0 };
    char bytes[4096];

    while (!frames || t->frames < first + frames) {
        ssize_t n;
        REQUIRE(poll(&p, 1, MOST_MS) == 1, "nothing comes for a minute");
        n = read(t->fd, bytes, sizeof bytes);
        if (n <= 0)
            return true;                        /* nobody holds the other end any more */
        for (ssize_t i = 0; i < n; i++)
            take(t, bytes[i]);
    }
    return false;
}

bool terminal_is_restored(const Terminal *t)
{
    return !t->other && t->cursor && t->wraps && t->ink == -1 && t->ground == -1 && !t->npending;
}

const char *terminal_line(const Terminal *t, int row)
{
    static char line[TERMINAL_COLUMNS + 1];
    int n = 0;

    for (int x = 0; x < t->columns; x++) {
        line[x] = t->page[0].cell[row][x].c;
        if (line[x] && line[x] != ' ')
            n = x + 1;
        else
            line[x] = ' ';
    }
    line[n] = 0;
    return line;
}

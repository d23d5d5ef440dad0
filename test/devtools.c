/* devtools.c -- see devtools.h. */
#include "test/devtools.h"

#include "test/view_help.h"
#include "view/json.h"

#include <errno.h>
#include <netinet/in.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { TRIES = 600 };

/* ---- the process ---- */

static void run_browser(int said, int width, int height)
{
    static const char *const NAMES[] = { "chromium", "chromium-browser", "google-chrome" };
    char folder[300], size[60];

    snprintf(folder, sizeof folder, "--user-data-dir=%s/browser", test_folder());
    snprintf(size, sizeof size, "--window-size=%d,%d", width, height);
    dup2(said, 2);
    for (size_t k = 0; k < sizeof NAMES / sizeof *NAMES; k++)
        execlp(NAMES[k], NAMES[k], "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic",
               "--no-first-run", "--disable-background-networking", "--disable-component-update",
               "--disable-sync", "--remote-debugging-port=0", folder, size, "about:blank",
               (char *)NULL);
    _exit(127);
}

/* Also when the case ends early. */
static pid_t running;

static void end_browser(void)
{
    int status;

    if (!running)
        return;
    kill(running, SIGTERM);
    waitpid(running, &status, 0);
    running = 0;
}

/* The port that it says it listens at; 0: it has ended. */
static int port_said(int fd)
{
    static const char SAYS[] = "DevTools listening on ws://127.0.0.1:";
    char text[8000];
    size_t n = 0;
    ssize_t more;

    while (n < sizeof text - 1 && (more = read(fd, text + n, sizeof text - 1 - n)) > 0) {
        const char *at;
        n += (size_t)more;
        text[n] = 0;
        at = strstr(text, SAYS);
        if (at && strchr(at, '\n'))
            return atoi(at + sizeof SAYS - 1);
    }
    return 0;
}

/* ---- the socket ---- */

static void send_bytes(int fd, const char *bytes, size_t n)
{
    while (n > 0) {
        ssize_t done = send(fd, bytes, n, MSG_NOSIGNAL);
        REQUIRE(done > 0, "the browser is gone");
        bytes += done;
        n -= (size_t)done;
    }
}

static void read_bytes(int fd, void *to, size_t n)
{
    for (char *at = to; n > 0;) {
        ssize_t more = recv(fd, at, n, 0);
        REQUIRE(more > 0, "the browser is gone");
        at += more;
        n -= (size_t)more;
    }
}

/* Masked by zeros, which leaves it as it is. */
static void send_text(int fd, const char *text, size_t n)
{
    unsigned char head[14] = { 0x81 };
    size_t length = 2;

    if (n < 126)
        head[1] = (unsigned char)(0x80 | n);
    else {
        head[1] = 0x80 | 127;
        for (int k = 0; k < 8; k++)
            head[2 + k] = (unsigned char)((uint64_t)n >> (56 - 8 * k));
        length = 10;
    }
    send_bytes(fd, (const char *)head, length + 4);
    send_bytes(fd, text, n);
}

/* One message, of one or more frames, into b->answer. */
static void read_text(Browser *b)
{
    size_t n = 0;
    unsigned char head[2], more[8];

    do {
        uint64_t length;
        read_bytes(b->fd, head, 2);
        length = head[1];
        if (length >= 126) {
            int bytes = length == 126 ? 2 : 8;
            read_bytes(b->fd, more, (size_t)bytes);
            length = 0;
            for (int k = 0; k < bytes; k++)
                length = length << 8 | more[k];
        }
        if (n + length + 1 > b->room) {
            b->room = n + (size_t)length + 1;
            b->answer = realloc(b->answer, b->room);
            REQUIRE(b->answer, "no memory");
        }
        read_bytes(b->fd, b->answer + n, (size_t)length);
        n += (size_t)length;
        b->answer[n] = 0;
    } while (!(head[0] & 0x80));
}

/* The path of the first page's socket. */
static void find_page(int port, char path[200])
{
    char text[8000];
    const char *at;
    size_t n = 0;
    ssize_t more;
    int fd = dial(INADDR_LOOPBACK, port);

    REQUIRE(fd >= 0, "nobody listens at %d", port);
    n = (size_t)snprintf(text, sizeof text, "GET /json/list HTTP/1.1\r\nHost: 127.0.0.1:%d\r\n"
                         "Connection: close\r\n\r\n", port);
    send_bytes(fd, text, n);
    text[n = 0] = 0;
    while (!strstr(text, "\n} ]") && n < sizeof text - 1 &&
           (more = recv(fd, text + n, sizeof text - 1 - n, 0)) > 0) {
        n += (size_t)more;
        text[n] = 0;
    }
    close(fd);
    at = strstr(text, "/devtools/page/");
    REQUIRE(at, "no page: %s", text);
    snprintf(path, 200, "%.*s", (int)strcspn(at, "\"\r\n&"), at);
}

static void shake_hands(Browser *b, int port, const char *path)
{
    char text[1000];
    size_t n;

    b->fd = dial(INADDR_LOOPBACK, port);
    REQUIRE(b->fd >= 0, "nobody listens at %d", port);
    n = (size_t)snprintf(text, sizeof text,
                         "GET %s HTTP/1.1\r\nHost: 127.0.0.1:%d\r\nUpgrade: websocket\r\n"
                         "Connection: Upgrade\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n"
                         "Sec-WebSocket-Version: 13\r\n\r\n", path, port);
    send_bytes(b->fd, text, n);
    for (n = 0; n < 4 || memcmp(text + n - 4, "\r\n\r\n", 4); n++) {
        REQUIRE(n < sizeof text, "a long answer");
        read_bytes(b->fd, text + n, 1);
    }
}

/* ---- commands ---- */

static void note_complaint(Browser *b)
{
    if (!strstr(b->answer, "\"Runtime.exceptionThrown\"") &&
        !(strstr(b->answer, "\"Log.entryAdded\"") && strstr(b->answer, "\"level\":\"error\"")))
        return;
    if (strstr(b->answer, "/favicon.ico"))      /* browsers ask for one by themselves */
        return;
    if (!b->complaints++)
        snprintf(b->complaint, sizeof b->complaint, "%s", b->answer);
}

const char *browser_do(Browser *b, const char *method, const char *params)
{
    char mine[40], *text;
    size_t room = strlen(method) + strlen(params) + 100, n;

    text = malloc(room);
    REQUIRE(text, "no memory");
    n = (size_t)snprintf(text, room, "{\"id\":%u,\"method\":\"%s\",\"params\":{%s}}", ++b->id,
                         method, params);
    send_text(b->fd, text, n);
    free(text);
    snprintf(mine, sizeof mine, "{\"id\":%u,", b->id);
    for (;;) {
        read_text(b);
        if (!strncmp(b->answer, mine, strlen(mine)))
            return b->answer;
        note_complaint(b);
    }
}

void browser_open(Browser *b, int width, int height, bool dark)
{
    char path[200], text[300];
    int said[2], port;

    memset(b, 0, sizeof *b);
    test_folder();                      /* made here, not by the child */
    REQUIRE(pipe(said) == 0, "pipe: %s", strerror(errno));
    fflush(NULL);
    b->pid = fork();
    REQUIRE(b->pid >= 0, "fork: %s", strerror(errno));
    if (!b->pid)
        run_browser(said[1], width, height);
    running = b->pid;
    atexit(end_browser);
    close(said[1]);
    port = port_said(said[0]);
    if (!port)
        test_skip("no Chromium that can be run");
    find_page(port, path);
    shake_hands(b, port, path);
    browser_do(b, "Page.enable", "");
    browser_do(b, "Runtime.enable", "");
    browser_do(b, "Log.enable", "");
    snprintf(text, sizeof text, "\"features\":[{\"name\":\"prefers-color-scheme\","
             "\"value\":\"%s\"}]", dark ? "dark" : "light");
    browser_do(b, "Emulation.setEmulatedMedia", text);
}

void browser_close(Browser *b)
{
    close(b->fd);
    end_browser();
    free(b->answer);
}

void browser_visit(Browser *b, const char *address)
{
    char text[300];

    snprintf(text, sizeof text, "\"url\":\"%s\"", address);
    browser_do(b, "Page.navigate", text);
}

void browser_ask(Browser *b, const char *script, char *out, size_t room)
{
    static const char VALUE[] = "\"type\":\"string\",\"value\":\"";
    Json j = { 0 };
    const char *answer, *at;
    char *whole = malloc(strlen(script) + 20);

    REQUIRE(whole, "no memory");
    sprintf(whole, "String(%s)", script);
    json_open(&j, '{');
    json_key(&j, "expression");
    json_string(&j, whole);
    json_close(&j, '}');
    REQUIRE(!j.failed, "no memory");
    j.text[j.n - 1] = 0;
    answer = browser_do(b, "Runtime.evaluate", j.text + 1);
    json_clear(&j);
    free(whole);
    at = strstr(answer, VALUE);
    REQUIRE(at, "'%s' gives %.300s", script, answer);
    at += sizeof VALUE - 1;
    snprintf(out, room, "%.*s", (int)strcspn(at, "\""), at);
}

void browser_await(Browser *b, const char *script)
{
    const struct timespec pause = { 0, 100000000 };
    char out[20] = "";

    for (int k = 0; k < TRIES; k++) {
        browser_ask(b, script, out, sizeof out);
        if (!strcmp(out, "true"))
            return;
        nanosleep(&pause, NULL);
    }
    REQUIRE(false, "it does not come true: %s", script);
}

void browser_mouse(Browser *b, const char *what, int x, int y)
{
    char text[200];

    snprintf(text, sizeof text, "\"type\":\"%s\",\"x\":%d,\"y\":%d,\"button\":\"left\","
             "\"buttons\":1,\"clickCount\":1", what, x, y);
    browser_do(b, "Input.dispatchMouseEvent", text);
}

/* test_browser.c -- the viewer's page in a real browser: what it shows is what `render` makes, what
 * hands do arrives, and nothing is complained of. Skipped where there is no Chromium. */
#include "test/devtools.h"
#include "test/view_help.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define WHOLE(pane) \
    "typeof state === 'object' && state.panes[" pane "].of === state.wanted &&" \
    "state.panes[" pane "].fresh && state.panes[" pane "].spp >= 4 && !panes[" pane "].busy &&" \
    "panes[" pane "].have === state.panes[" pane "].shown"

enum { W = 40, H = 30 };

/* The bytes of a canvas against a .ppm file. */
static void expect_canvas(Browser *b, const char *canvas, const char *file)
{
    static char text[5 * 3 * W * H];
    char script[300], *at = text;
    size_t size, n = 3 * W * H;
    const char *have = cli_read(file, &size);

    REQUIRE(have && size > n, "no %s", file);
    snprintf(script, sizeof script, "Array.from(id('%s').getContext('2d').getImageData(0, 0, %d, "
             "%d).data).filter((v, k) => k %% 4 < 3).join(' ')", canvas, W, H);
    browser_ask(b, script, text, sizeof text);
    for (size_t k = 0; k < n; k++)
        if (strtol(at, &at, 10) != (unsigned char)have[size - n + k]) {
            EXPECT(false, "%s, %s: byte %d is another", canvas, file, (int)k);
            return;
        }
}

static void nap(void)
{
    const struct timespec t = { 0, 30000000 };
    nanosleep(&t, NULL);
}

/* The camera's words change by what is done. */
static void expect_moved(Browser *b, const char *what, char *before)
{
    char now[800];

    browser_await(b, WHOLE("0"));
    browser_ask(b, "state.transform", now, sizeof now);
    EXPECT(strcmp(now, before), "%s moves nothing", what);
    strcpy(before, now);
}

static void hands(Browser *b)
{
    char before[800], place[60];
    int x, y;

    browser_ask(b, "state.transform", before, sizeof before);
    browser_ask(b, "(r => Math.round(r.x + r.width / 2) + ' ' + Math.round(r.y + r.height / 2))"
                "(id('frame').getBoundingClientRect())", place, sizeof place);
    REQUIRE(sscanf(place, "%d %d", &x, &y) == 2, "a place: %s", place);
    browser_mouse(b, "mousePressed", x, y);
    for (int k = 0; k < 10; k++) {
        browser_mouse(b, "mouseMoved", x + 3 * k, y + k);
        nap();
    }
    browser_mouse(b, "mouseReleased", x + 27, y + 9);
    expect_moved(b, "a drag", before);
    browser_do(b, "Input.dispatchKeyEvent", "\"type\":\"keyDown\",\"key\":\"w\"");
    for (int k = 0; k < 5; k++)
        nap();
    browser_do(b, "Input.dispatchKeyEvent", "\"type\":\"keyUp\",\"key\":\"w\"");
    expect_moved(b, "the key W", before);
    browser_do(b, "Input.dispatchMouseEvent", "\"type\":\"mouseWheel\",\"x\":200,\"y\":200,"
               "\"deltaX\":0,\"deltaY\":120");
    expect_moved(b, "the wheel", before);
    browser_ask(b, "id('first').click()", place, sizeof place);
    expect_moved(b, "reset", before);
}

static void page(void)
{
    char address[200], out[60];
    Browser b;
    View v;

    cli_scene();
    CLI_WORKS("tiny.pbrt --quiet --size 40x30 --spp 4 -o a.ppm");
    CLI_WORKS("tiny.pbrt --quiet --size 40x30 --spp 4 --exposure 1 --tonemap reinhard -o b.ppm");
    CLI_WORKS("tiny.pbrt --quiet --size 40x30 --spp 4 --exposure 1 --tonemap reinhard "
              "--integrator ao:samples=2 -o c.ppm");
    browser_open(&b, 1000, 700, false);
    view_start(&v, "--size 40x30 --spp 4");
    snprintf(address, sizeof address, "http://127.0.0.1:%d/%s/", v.port, v.token);
    browser_visit(&b, address);
    browser_await(&b, WHOLE("0"));
    expect_canvas(&b, "a", "a.ppm");
    hands(&b);
    browser_await(&b, WHOLE("0"));
    expect_canvas(&b, "a", "a.ppm");

    browser_ask(&b, "(id('split').click(), choosers.integrator2.select.value = 'ao',"
                "choosers.integrator2.select.onchange())", out, sizeof out);
    browser_await(&b, "state.panes[1].integrator.name === 'ao'");
    browser_ask(&b, "(f => (f.input.value = 2, f.input.onchange()))"
                "(choosers.integrator2.fields[0])", out, sizeof out);
    browser_ask(&b, "(choosers.tonemap.select.value = 'reinhard',"
                "choosers.tonemap.select.onchange(), id('exposure').value = 1,"
                "id('exposure').oninput())", out, sizeof out);
    browser_await(&b, "state.panes[1].integrator.values.samples === '2'");
    browser_await(&b, WHOLE("0"));
    browser_await(&b, WHOLE("1"));
    expect_canvas(&b, "a", "b.ppm");
    expect_canvas(&b, "b", "c.ppm");
    browser_ask(&b, "id('error').textContent", out, sizeof out);
    EXPECT(!out[0], "the page says: %s", out);
    view_end(&v);
    browser_await(&b, "!id('lost').hidden");
    EXPECT(!b.complaints || strstr(b.complaint, "net::ERR_"), "%u complaints: %s", b.complaints,
           b.complaint);
    browser_close(&b);
}

const TestCase test_browser[] = {
    { "page", page, true },
    { NULL, NULL, false }
};

/* test_view_http.c -- requests as bytes: what is right, what is refused and how, pieces, mutations;
 * values of queries; texts in JSON. */
#include "base/random.h"
#include "test/test.h"
#include "view/http.h"
#include "view/json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define HOST "Host: 127.0.0.1:8080\r\n"

/* In a block of just that size, so that a look beyond it is seen. */
static HttpStatus parse(const char *bytes, size_t n, HttpRequest *r)
{
    char *copy = malloc(n + !n);
    HttpStatus status;

    REQUIRE(copy, "no memory");
    memcpy(copy, bytes, n);
    status = http_parse(copy, n, r);
    if (status == HTTP_OK) {                    /* all words lie in the bytes */
        Word w[3];              /* tcc 0.9.27 takes no structs by name as initializers here */
        w[0] = r->path;
        w[1] = r->query;
        w[2] = r->host;
        for (int k = 0; k < 3; k++)
            EXPECT(w[k].s >= copy && w[k].s + w[k].n <= copy + n, "word %d lies elsewhere", k);
    }
    free(copy);
    return status;
}

/* ---- what is right ---- */

static void right(void)
{
    static const char GOOD[] = "GET /ab/state?since=12&x=%41+b HTTP/1.1\r\n" HOST
                               "Origin: http://localhost:8080 \r\nContent-Length: 0\r\n"
                               "X-Odd:\r\nUser-Agent: Mozilla (\xc3\xa9)\t!\r\n\r\n";
    HttpRequest r;
    char out[20];

    REQUIRE(http_parse(GOOD, sizeof GOOD - 1, &r) == HTTP_OK, "refused");
    EXPECT(!r.post && word_is(r.path, "/ab/state") && word_is(r.query, "since=12&x=%41+b"),
           "words");
    EXPECT(word_is(r.host, "127.0.0.1:8080") && word_is(r.origin, "http://localhost:8080"), "who");
    EXPECT(http_value(r.query, "x", out, sizeof out) && !strcmp(out, "A b"), "a value");
    for (size_t n = 0; n < sizeof GOOD - 1; n++)
        EXPECT(parse(GOOD, n, &r) == HTTP_MORE, "%d bytes are enough", (int)n);
    REQUIRE(http_parse("POST / HTTP/1.0\r\n" HOST "\r\n", 41, &r) == HTTP_OK, "a post");
    EXPECT(r.post && word_is(r.path, "/") && !r.query.n && !r.origin.s, "a post");
}

/* ---- what is refused ---- */

static void refused(void)
{
    static const struct { const char *text; HttpStatus status; } BAD[] = {
        { "GET / HTTP/1.1\r\n\r\n", HTTP_BAD },                       /* no host */
        { "GET / HTTP/1.1\r\n" HOST HOST "\r\n", HTTP_BAD },          /* two */
        { "GET / HTTP/1.1\r\nHost:\r\n\r\n", HTTP_BAD },
        { "GET / HTTP/1.1\n" HOST "\r\n\r\n", HTTP_BAD },             /* ends of lines */
        { "GET / HTTP/1.1\r" HOST "\r\n\r\n", HTTP_BAD },
        { "GET / HTTP/1.1\r\n" HOST "A: b\nC: d\r\n\r\n", HTTP_BAD },
        { "GET / HTTP/1.1\r\n" HOST "A: b\r\n folded\r\n\r\n", HTTP_BAD },
        { "GET / HTTP/1.1\r\n" HOST "A : b\r\n\r\n", HTTP_BAD },      /* blank before the colon */
        { "GET / HTTP/1.1\r\n" HOST "A b\r\n\r\n", HTTP_BAD },
        { "GET / HTTP/1.1\r\n" HOST ": b\r\n\r\n", HTTP_BAD },
        { "GET / HTTP/1.1\r\n" HOST "A: \x01\r\n\r\n", HTTP_BAD },
        { " GET / HTTP/1.1\r\n" HOST "\r\n", HTTP_BAD },
        { "GET  / HTTP/1.1\r\n" HOST "\r\n", HTTP_BAD },
        { "GET / HTTP/1.1 \r\n" HOST "\r\n", HTTP_BAD },
        { "GET /\x7f HTTP/1.1\r\n" HOST "\r\n", HTTP_BAD },
        { "GET /\xc3\xa9 HTTP/1.1\r\n" HOST "\r\n", HTTP_BAD },
        { "GET http://127.0.0.1/ HTTP/1.1\r\n" HOST "\r\n", HTTP_BAD },
        { "GET ../etc HTTP/1.1\r\n" HOST "\r\n", HTTP_BAD },
        { "GET * HTTP/1.1\r\n" HOST "\r\n", HTTP_BAD },
        { "GET /\r\n" HOST "\r\n", HTTP_BAD },                        /* HTTP/0.9 */
        { "\r\n\r\n", HTTP_BAD },
        { "GET / HTTP/2.0\r\n" HOST "\r\n", HTTP_VERSION },
        { "GET / HTTP/1.10\r\n" HOST "\r\n", HTTP_VERSION },
        { "GET / FTP/1.1\r\n" HOST "\r\n", HTTP_BAD },
        { "HEAD / HTTP/1.1\r\n" HOST "\r\n", HTTP_METHOD },
        { "DELETE / HTTP/1.1\r\n" HOST "\r\n", HTTP_METHOD },
        { "get / HTTP/1.1\r\n" HOST "\r\n", HTTP_METHOD },
        { "POST / HTTP/1.1\r\n" HOST "Content-Length: 5\r\n\r\nhello", HTTP_BODY },
        { "POST / HTTP/1.1\r\n" HOST "Content-Length: -1\r\n\r\n", HTTP_BODY },
        { "POST / HTTP/1.1\r\n" HOST "Content-Length:\r\n\r\n", HTTP_BODY },
        { "POST / HTTP/1.1\r\n" HOST "Content-Length: 99999999999999999999\r\n\r\n", HTTP_BODY },
        { "POST / HTTP/1.1\r\n" HOST "Transfer-Encoding: chunked\r\n\r\n", HTTP_CODING },
        { "GET / HTTP/1.1\r\n" HOST "Origin: a\r\nOrigin: b\r\n\r\n", HTTP_BAD },
    };
    HttpRequest r;

    for (size_t i = 0; i < sizeof BAD / sizeof *BAD; i++) {
        HttpStatus status = parse(BAD[i].text, strlen(BAD[i].text), &r);
        EXPECT(status == BAD[i].status, "case %d: %d, not %d", (int)i, (int)status,
               (int)BAD[i].status);
    }
    EXPECT(parse("GET / HTTP/1.1\r\nHost: a\r\nA: \0\r\n\r\n", 33, &r) == HTTP_BAD, "a zero");
}

/* Long heads, targets and lists of fields: just within and just beyond. */
static void sizes(void)
{
    static char text[3 * HTTP_HEAD_MOST];
    HttpRequest r;
    size_t n;

    for (int more = 0; more < 2; more++) {
        n = (size_t)sprintf(text, "GET /");
        memset(text + n, 'a', HTTP_TARGET_MOST);
        n += (size_t)(HTTP_TARGET_MOST - 1 + more);
        n += (size_t)sprintf(text + n, " HTTP/1.1\r\n" HOST "\r\n");
        EXPECT(parse(text, n, &r) == (more ? HTTP_TARGET : HTTP_OK), "target, %d more", more);

        n = (size_t)sprintf(text, "GET / HTTP/1.1\r\n" HOST);
        for (int k = 1; k < HTTP_FIELDS_MOST + more; k++)
            n += (size_t)sprintf(text + n, "A: b\r\n");
        n += (size_t)sprintf(text + n, "\r\n");
        EXPECT(parse(text, n, &r) == (more ? HTTP_HEAD : HTTP_OK), "fields, %d more", more);

        n = (size_t)sprintf(text, "GET / HTTP/1.1\r\n" HOST "A: ");
        memset(text + n, 'a', HTTP_HEAD_MOST);
        n = (size_t)(HTTP_HEAD_MOST - 4 + more);
        n += (size_t)sprintf(text + n, "\r\n\r\n");
        EXPECT(parse(text, n, &r) == (more ? HTTP_HEAD : HTTP_OK), "head, %d more", more);
    }
    memset(text, 'a', sizeof text);
    EXPECT(parse(text, HTTP_HEAD_MOST - 1, &r) == HTTP_MORE, "too early");
    EXPECT(parse(text, HTTP_HEAD_MOST, &r) == HTTP_HEAD, "no end");
    EXPECT(parse(text, sizeof text, &r) == HTTP_HEAD, "no end at all");
}

/* ---- chance ---- */

static bool is_status(HttpStatus s)
{
    return s == HTTP_MORE || s == HTTP_OK || s == HTTP_BAD || s == HTTP_METHOD ||
           s == HTTP_BODY || s == HTTP_TARGET || s == HTTP_HEAD || s == HTTP_CODING ||
           s == HTTP_VERSION;
}

/* Whatever is changed, cut, doubled or thrown in: an answer of the list, and values that end. */
static void mutations(void)
{
    static const char *const SEEDS[] = {
        "GET /ab/image?pane=0&exposure=1.5&tonemap=reinhard%3Awhite%3D2 HTTP/1.1\r\n" HOST
        "Accept: */*\r\nOrigin: http://127.0.0.1:8080\r\n\r\n",
        "POST /ab/set?what=integrator&to=path:maxdepth%3d5,strategy=mis HTTP/1.1\r\n" HOST
        "Content-Length: 0\r\n\r\n",
    };
    static const char ODD[] = "\r\n :?&=%+/\0\t\x7f\xff" "0Aa";
    Rng rng = rng_seed(11);
    int good = 0, all = test_is_long() ? 3000000 : 60000;

    for (int i = 0; i < all; i++) {
        char text[400], value[30];
        size_t n = strlen(SEEDS[i % 2]);
        HttpRequest r;
        HttpStatus s;
        memcpy(text, SEEDS[i % 2], n);
        for (int k = 1 + (int)(rng_unit(&rng) * 3); k > 0; k--) {
            size_t at = (size_t)(rng_unit(&rng) * (float)n);
            char c = ODD[(size_t)(rng_unit(&rng) * (float)(sizeof ODD - 1))];
            if (rng_unit(&rng) < 0.5f)
                text[at] = c;
            else if (rng_unit(&rng) < 0.5f) {
                memmove(text + at, text + at + 1, n - at - 1);
                n--;
            } else {
                memmove(text + at + 1, text + at, n - at);
                text[at] = c;
                n++;
            }
        }
        s = parse(text, n, &r);
        EXPECT(is_status(s), "status %d", (int)s);
        if (http_parse(text, n, &r) != HTTP_OK)
            continue;
        good++;
        if (http_value(r.query, "to", value, sizeof value))
            EXPECT(strlen(value) < sizeof value && !strpbrk(value, "\r\n\t"), "a value: %s", value);
    }
    EXPECT(good > all / 50 && good < all, "%d of %d are right", good, all);
}

/* ---- queries ---- */

static void queries(void)
{
    static const struct { const char *query, *value; } CASES[] = {
        { "a=1", "1" }, { "b=2&a=1", "1" }, { "a=", "" }, { "a=1&a=2", "1" }, { "aa=3&a=1", "1" },
        { "a=%31%2b+", "1+ " }, { "a=x=y", "x=y" }, { "&&a=1", "1" }, { "a=%c3%A9", "\xc3\xa9" },
        { "", NULL }, { "a", NULL }, { "=1", NULL }, { "A=1", NULL }, { "a=%", NULL },
        { "a=%4", NULL }, { "a=%4g", NULL }, { "a=%00", NULL }, { "a=%0a", NULL },
        { "a=12345678", NULL }, { "a=%7f", NULL },
    };

    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        char out[8];
        Word q = { CASES[i].query, strlen(CASES[i].query) };
        bool ok = http_value(q, "a", out, sizeof out);
        EXPECT(ok == (CASES[i].value != NULL) && (!ok || !strcmp(out, CASES[i].value)),
               "'%s': %s", CASES[i].query, ok ? out : "nothing");
    }
}

/* ---- JSON ---- */

static void json(void)
{
    Json j = { 0 };

    json_open(&j, '{');
    json_key(&j, "a\"b");
    json_open(&j, '[');
    json_number(&j, 0.1);
    json_number(&j, INFINITY);
    json_number(&j, NAN);
    json_bool(&j, true);
    json_string(&j, NULL);
    json_close(&j, ']');
    json_key(&j, "c");
    json_string(&j, "</script>\n\\\x1f\xc3\xa9");
    json_key(&j, "d");
    json_open(&j, '{');
    json_close(&j, '}');
    json_close(&j, '}');
    EXPECT(!j.failed && !strcmp(j.text, "{\"a\\u0022b\":[0.1,null,null,true,null],\"c\":"
                                "\"\\u003c/script>\\u000a\\u005c\\u001f\xc3\xa9\",\"d\":{}}"),
           "%s", j.text);
    json_clear(&j);
}

const TestCase test_view_http[] = {
    { "right", right, false },
    { "refused", refused, false },
    { "sizes", sizes, false },
    { "mutations", mutations, false },
    { "queries", queries, false },
    { "json", json, false },
    { NULL, NULL, false }
};

/* http.c -- the code of `http.h`.
 *
 * Source      RFC 9112, of which this takes the strict side wherever there is one: lines end with
 *             CR LF, no field is folded or has a blank before its colon, Host stands there once.
 *             What is odd gets no second reading, since two programs might read it in two ways. */
#include "view/http.h"

#include "base/number.h"

#include <string.h>

/* The bytes up to CR LF; false: there is no whole line, or a CR or LF stands alone. */
static bool next_line(const char **at, const char *end, Word *line)
{
    const char *s = *at, *p = s;

    while (p < end && *p != '\r' && *p != '\n')
        p++;
    if (end - p < 2 || p[0] != '\r' || p[1] != '\n')
        return false;
    *line = (Word){ s, (size_t)(p - s) };
    *at = p + 2;
    return true;
}

static bool is_visible(char c) { return c > 32 && c < 127; }

static bool all_visible(Word w)
{
    for (size_t i = 0; i < w.n; i++)
        if (!is_visible(w.s[i]))
            return false;
    return true;
}

/* What stands before the byte, which is taken too. */
static bool split_at(Word *rest, char c, Word *first)
{
    const char *p = rest->n ? memchr(rest->s, c, rest->n) : NULL;

    if (!p)
        return false;
    *first = (Word){ rest->s, (size_t)(p - rest->s) };
    *rest = (Word){ p + 1, rest->n - first->n - 1 };
    return true;
}

static HttpStatus parse_target(Word target, HttpRequest *r)
{
    if (target.n > HTTP_TARGET_MOST)
        return HTTP_TARGET;
    if (!target.n || target.s[0] != '/' || !all_visible(target))
        return HTTP_BAD;
    r->query = target;
    if (!split_at(&r->query, '?', &r->path)) {
        r->path = target;
        r->query = (Word){ target.s, 0 };
    }
    return HTTP_OK;
}

/* "GET /path?query HTTP/1.1" */
static HttpStatus parse_first(Word line, HttpRequest *r)
{
    Word method, target;

    if (!split_at(&line, ' ', &method) || !split_at(&line, ' ', &target) || !all_visible(method) ||
        !all_visible(line))
        return HTTP_BAD;
    if (!word_is(line, "HTTP/1.1") && !word_is(line, "HTTP/1.0"))
        return line.n >= 5 && !memcmp(line.s, "HTTP/", 5) ? HTTP_VERSION : HTTP_BAD;
    r->post = word_is(method, "POST");
    if (!r->post && !word_is(method, "GET"))
        return method.n ? HTTP_METHOD : HTTP_BAD;
    return parse_target(target, r);
}

/* Without blanks at its ends; visible characters, blanks and bytes above 127 may stand in it. */
static bool trim_value(Word *w)
{
    while (w->n && (w->s[0] == ' ' || w->s[0] == '\t')) {
        w->s++;
        w->n--;
    }
    while (w->n && (w->s[w->n - 1] == ' ' || w->s[w->n - 1] == '\t'))
        w->n--;
    for (size_t i = 0; i < w->n; i++)
        if ((unsigned char)w->s[i] < 32 ? w->s[i] != '\t' : w->s[i] == 127)
            return false;
    return true;
}

static bool is_zero(Word w)
{
    for (size_t i = 0; i < w.n; i++)
        if (w.s[i] != '0')
            return false;
    return w.n > 0;
}

static HttpStatus parse_field(Word line, HttpRequest *r)
{
    Word name, value = line;

    if (!split_at(&value, ':', &name) || !name.n || !all_visible(name) || !trim_value(&value))
        return HTTP_BAD;
    if (word_is_nocase(name, "transfer-encoding"))
        return HTTP_CODING;
    if (word_is_nocase(name, "content-length") && !is_zero(value))
        return HTTP_BODY;
    if (word_is_nocase(name, "host")) {
        if (r->host.s || !value.n)
            return HTTP_BAD;
        r->host = value;
    } else if (word_is_nocase(name, "origin")) {
        if (r->origin.s)
            return HTTP_BAD;
        r->origin = value;
    }
    return HTTP_OK;
}

/* The bytes before and with the empty line; 0: it has not come yet. */
static size_t head_length(const char *bytes, size_t n)
{
    for (size_t i = 3; i < n; i++)
        if (bytes[i] == '\n' && bytes[i - 1] == '\r' && bytes[i - 2] == '\n' &&
            bytes[i - 3] == '\r')
            return i + 1;
    return 0;
}

HttpStatus http_parse(const char *bytes, size_t n, HttpRequest *r)
{
    size_t length = head_length(bytes, n < HTTP_HEAD_MOST ? n : HTTP_HEAD_MOST);
    const char *at = bytes, *end = bytes + length;
    HttpStatus status;
    Word line;

    *r = (HttpRequest){ 0 };
    if (!length)
        return n >= HTTP_HEAD_MOST ? HTTP_HEAD : HTTP_MORE;
    status = next_line(&at, end, &line) ? parse_first(line, r) : HTTP_BAD;
    for (int fields = 0; status == HTTP_OK; fields++) {
        if (!next_line(&at, end, &line))
            return HTTP_BAD;
        if (!line.n)
            return r->host.s && at == end ? HTTP_OK : HTTP_BAD;
        status = fields < HTTP_FIELDS_MOST ? parse_field(line, r) : HTTP_HEAD;
    }
    return status;
}

const char *http_reason(HttpStatus s)
{
    switch (s) {
    case HTTP_OK:        return "OK";
    case HTTP_BAD:       return "Bad Request";
    case HTTP_FORBIDDEN: return "Forbidden";
    case HTTP_NOT_FOUND: return "Not Found";
    case HTTP_METHOD:    return "Method Not Allowed";
    case HTTP_TIMEOUT:   return "Request Timeout";
    case HTTP_BODY:      return "Content Too Large";
    case HTTP_TARGET:    return "URI Too Long";
    case HTTP_HEAD:      return "Request Header Fields Too Large";
    case HTTP_CODING:    return "Not Implemented";
    case HTTP_BUSY:      return "Service Unavailable";
    case HTTP_VERSION:   return "HTTP Version Not Supported";
    default:             return "Internal Server Error";
    }
}

/* ---- queries ---- */

static int digit_of(char c)
{
    return c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10
         : c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

/* One character of the text; -1: it is none. */
static int decode(Word *w)
{
    int c = (unsigned char)*w->s, hi, lo;
    size_t taken = 1;

    if (c == '+')
        c = ' ';
    else if (c == '%') {
        hi = w->n > 2 ? digit_of(w->s[1]) : -1;
        lo = w->n > 2 ? digit_of(w->s[2]) : -1;
        c = hi < 0 || lo < 0 ? -1 : 16 * hi + lo;
        taken = 3;
    }
    w->s += taken;
    w->n -= taken <= w->n ? taken : w->n;
    return c < 32 || c == 127 ? -1 : c;
}

static bool decode_all(Word w, char *out, size_t room)
{
    size_t n = 0;

    while (w.n) {
        int c = decode(&w);
        if (c < 0 || n + 1 >= room)
            return false;
        out[n++] = (char)c;
    }
    out[n] = 0;
    return true;
}

bool http_value(Word query, const char *key, char *out, size_t room)
{
    Word pair, name;

    while (query.n) {
        if (!split_at(&query, '&', &pair)) {
            pair = query;
            query.n = 0;
        }
        if (split_at(&pair, '=', &name) && word_is(name, key))
            return decode_all(pair, out, room);
    }
    return false;
}

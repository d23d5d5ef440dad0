/* http.h -- requests of HTTP/1.1, read from bytes: a pure function, which takes no more of the
 * language than a browser needs to ask for a page and for what the page asks for. */
#ifndef VIEW_HTTP_H
#define VIEW_HTTP_H

#include "base/text.h"

enum { HTTP_HEAD_MOST = 8192, HTTP_TARGET_MOST = 2000, HTTP_FIELDS_MOST = 64 };

/* All borrowed from the bytes. */
typedef struct {
    bool post;                  /* else a GET */
    Word path, query;           /* before and after the first '?' */
    Word host, origin;          /* origin.s NULL: not said */
} HttpRequest;

typedef enum {
    HTTP_MORE = 0,              /* it is not whole yet */
    HTTP_OK = 200,
    HTTP_BAD = 400, HTTP_FORBIDDEN = 403, HTTP_NOT_FOUND = 404, HTTP_METHOD = 405,
    HTTP_TIMEOUT = 408, HTTP_BODY = 413, HTTP_TARGET = 414, HTTP_HEAD = 431, HTTP_FAILED = 500,
    HTTP_CODING = 501, HTTP_BUSY = 503, HTTP_VERSION = 505
} HttpStatus;

/* What the bytes of a request so far are: whole and right (HTTP_OK, *r is set), not whole, or what
 * to answer to them. Requests have no body: whoever says otherwise is refused. */
HttpStatus  http_parse(const char *bytes, size_t n, HttpRequest *r);
const char *http_reason(HttpStatus s);

/* The value of a key of a query, "key=value&key=value", with %41 for A and + for a blank. False: it
 * is not there, does not fit, or holds what is no text. */
bool http_value(Word query, const char *key, char *out, size_t room);

#endif

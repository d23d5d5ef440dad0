/* json.h -- texts in JSON, written from left to right. */
#ifndef VIEW_JSON_H
#define VIEW_JSON_H

#include "base/mem.h"

/* Owned. After memory has run out, reported, nothing more is written. */
typedef struct { char *text; size_t n, cap; bool failed, comma; } Json;

/* Brackets of an object or a list, "{", "}", "[" or "]". */
void json_open(Json *j, char bracket);
void json_close(Json *j, char bracket);
/* Before a value of an object. */
void json_key(Json *j, const char *key);
void json_string(Json *j, const char *s);       /* NULL: null */
void json_number(Json *j, double v);            /* null if it is not finite */
void json_bool(Json *j, bool v);
void json_clear(Json *j);

#endif

/* lexer.h -- the words of the scene language: quoted strings, numbers, names, brackets. Comments
 * run from # to the end of the line. Nothing is copied: tokens point into the text. */
#ifndef SCENEFILE_LEXER_H
#define SCENEFILE_LEXER_H

#include "base/text.h"

typedef enum {
    TOKEN_END, TOKEN_NAME, TOKEN_STRING, TOKEN_NUMBER, TOKEN_OPEN, TOKEN_CLOSE
} TokenKind;

typedef struct {
    TokenKind   kind;
    const char *s;              /* borrowed: NAME, NUMBER as written; STRING between its quotes */
    size_t      n;
    double      number;         /* NUMBER: finite, and as a float too */
    Place       at;             /* of the first byte, a quote included */
} Token;

typedef struct {
    Text  text;
    Token ahead;                /* a token that was looked at but not taken */
    bool  looked;
} Lexer;

void lexer_init(Lexer *l, const char *file, const char *bytes, size_t n);

/* Each false: no token here, reported with its place. At the end of the text: TOKEN_END. */
bool lexer_next(Lexer *l, Token *t);
bool lexer_peek(Lexer *l, Token *t);

/* What a string says, escapes resolved, with a final 0, in out[0 .. n]. Returns its length. */
size_t token_text(const Token *t, char *out);
bool   token_is(const Token *t, const char *s);         /* a STRING or NAME that says just this */

/* Reports a directive that is none of names[0..n). Returns false. */
bool   token_unknown(const Token *t, const char *const *names, size_t n);

#endif

/* answer.h -- what a viewer's request is answered. */
#ifndef VIEW_ANSWER_H
#define VIEW_ANSWER_H

#include "view/http.h"
#include "view/session.h"

enum { TOKEN_LENGTH = 32 };

/* Who may ask: those who know the token, and come by an address of this machine. */
typedef struct {
    Session *session;
    char     token[TOKEN_LENGTH + 1];
    int      port;
} Door;

typedef struct {
    HttpStatus  status;
    const char *type;           /* of the body */
    char       *body;           /* owned */
    size_t      n;
    char        field[100];     /* one more line of the head, without its end, or "" */
} Answer;

/* Always gives one. Errors come as text, in one line. */
void answer(const Door *door, const HttpRequest *r, Answer *a);
/* To a request that could not be read. */
void answer_error(Answer *a, HttpStatus status, const char *text);
void answer_clear(Answer *a);

#endif

/* view_help.h -- a viewer run as a user runs it, for the suites that visit it. */
#ifndef TEST_VIEW_HELP_H
#define TEST_VIEW_HELP_H

#include "test/cli_help.h"
#include "view/answer.h"

typedef struct { Cli run; int port; char token[TOKEN_LENGTH + 1]; } View;

/* Of tiny.pbrt in the folder of the case, with these options; reads the address that it prints. */
void view_start(View *v, const char *options);
/* By a signal, after which it must end soon, and well. */
void view_end(View *v);

/* A connection to an address of this machine, as a number; -1: nobody is there. */
int dial(unsigned long address, int port);

#endif

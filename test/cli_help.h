/* cli_help.h -- the whole program run as a user runs it: in a process of its own, in the folder of
 * the case, with what it prints caught. A run that leaves a block of memory or a descriptor behind
 * says so on its standard error, so that no case can pass with a leak. */
#ifndef TEST_CLI_HELP_H
#define TEST_CLI_HELP_H

#include "test/test.h"

#include <stdio.h>
#include <sys/types.h>

typedef struct {
    int   status;               /* exit status; 128 + n if signal n ended it */
    char *out, *err;            /* what it printed; they live as long as the case */
    pid_t pid;
    FILE *stream[2];
} Cli;

/* "render a.pbrt --spp 2", without "rushlight": words with blanks between, each of which may hold
 * the word '' for an empty one. */
#define cli(...) cli_line(cli_text(__VA_ARGS__))
/* The same; setup (or NULL) runs in the new process first: closes streams, sets limits. */
#define cli_start(setup, ...) cli_start_line(setup, cli_text(__VA_ARGS__))
/* In two steps: tcc loses the arguments of functions that take any number and return a struct. */
char *cli_text(const char *fmt, ...) PRINTF_LIKE(1, 2);         /* in one static buffer */
Cli  cli_line(char *line);
Cli  cli_start_line(void (*setup)(void), char *line);
void cli_wait(Cli *c);
/* Waits until the running program has printed `text` on standard error. */
void cli_await(const Cli *c, const char *text);

/* Exit status and standard error must be these; NULL: any. */
void cli_expect(const char *file, int line, Cli c, int status, const char *err);
#define EXPECT_CLI(c, status, err) cli_expect(__FILE__, __LINE__, c, status, err)
/* Runs the line: the exit status and the one line "rushlight: ERR" must come. Gives the run. */
#define CLI_FAILS(status, err, ...) cli_fails(__FILE__, __LINE__, status, err, cli(__VA_ARGS__))
Cli cli_fails(const char *file, int line, int status, const char *err, Cli c);
/* Runs the line, which must end well. */
#define CLI_WORKS(...) cli_fails(__FILE__, __LINE__, 0, NULL, cli(__VA_ARGS__))

int  cli_lines(const char *text);
/* Path of a file in the folder of the case. Static buffers, eight in turn. */
const char *cli_path(const char *name);
void cli_write(const char *name, const void *bytes, size_t n);
void cli_write_text(const char *name, const char *text);
/* A file's bytes, which live as long as the case; NULL: it is not there. */
char *cli_read(const char *name, size_t *n);
bool cli_same_file(const char *a, const char *b);
/* The names in the folder of the case, in order, with a blank after each. */
const char *cli_folder(void);

/* ---- CSV ---- */

enum { CSV_FIELDS = 32, CSV_FIELD_ROOM = 80, CSV_ROWS = 100 };
typedef struct { char field[CSV_FIELDS][CSV_FIELD_ROOM]; } CsvRow;
typedef struct { CsvRow head, row[CSV_ROWS]; int fields, n; } Csv;

/* A text with a head; quotes as RFC 4180 has them. All rows must have as many fields as the head.
 * Two static ones in turn. */
const Csv  *csv_of(const char *text);
const char *csv_text(const Csv *c, int row, const char *column);
double      csv_num(const Csv *c, int row, const char *column);     /* a number, or a failure */

/* Writes the files of a small scene into the folder: tiny.pbrt with a mesh in a file, a sphere, a
 * texture, a picture of the sky and an area light; 16 x 12 pixels, 2 samples. */
void cli_scene(void);
extern const char cli_scene_text[];

#endif

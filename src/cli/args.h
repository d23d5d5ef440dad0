/* args.h -- commands, and the options of each: a table, read in any order, `--name value` or
 * `--name=value`. cli.c has the list of commands. */
#ifndef CLI_ARGS_H
#define CLI_ARGS_H

#include "base/error.h"

#include <stdbool.h>
#include <stdint.h>

typedef struct {
    const char *name;           /* "--spp" or "-o" */
    const char *arg;            /* what stands for its value in help, or NULL: takes none */
    const char *help;
} ArgDef;

typedef struct {
    const char *name;           /* of the command */
    const char *usage;          /* "SCENE [-o FILE] ..." */
    const char *summary;
    const ArgDef *args;         /* ends at name == NULL */
    int (*run)(int argc, char **argv);          /* words after the command; gives the exit status */
} Command;
extern const Command *const commands[];         /* ends with NULL */

/* Walks the words: option k of the table goes to set(ctx, k, value), other words to
 * set(ctx, -1, word). "--" ends options. False: reported, or set returned false. */
bool args_parse(const Command *c, int argc, char **argv,
                bool (*set)(void *ctx, int k, const char *value), void *ctx);

/* Values. False: usage error reported that names the option and the range. */
bool arg_int(const char *name, const char *value, int64_t lo, int64_t hi, int64_t *v);
bool arg_number(const char *name, const char *value, double lo, double hi, double *v);
/* n of them with commas between; form: "X,Y,Z", for the message. */
bool arg_floats(const char *name, const char *value, const char *form, float *v, int n);
bool arg_size(const char *name, const char *value, uint32_t *w, uint32_t *h);           /* WxH */
bool arg_part(const char *name, const char *value, uint32_t *i, uint32_t *n);   /* I/N, I from 1 */
bool arg_window(const char *name, const char *value, uint32_t window[4]);       /* X0,Y0,X1,Y1 */

/* Exit status of a command that failed: the class of its first error. */
int  failed_status(void);
/* Sends off what was printed. False: it could not be written, reported. */
bool output_flush(void);

/* The whole program: argv[0] is its name. May be called again and again in one process. */
int  cli_run(int argc, char **argv);

#endif

/* options.h -- one table of options serves the command line (`name:key=value,key=value`), the
 * scene file (typed parameters), `list` and `help`, and the range checks. */
#ifndef BASE_OPTIONS_H
#define BASE_OPTIONS_H

#include "base/error.h"
#include "base/mem.h"
#include "base/vec.h"

#include <stdint.h>

typedef enum {
    OPT_BOOL, OPT_INT, OPT_FLOAT,
    OPT_RGB,                    /* three numbers, or one for grey */
    OPT_POINT,                  /* three numbers */
    OPT_NUMBERS,                /* any count, scene files only: read them from OptValue.param */
    OPT_STRING,
    OPT_CHOICE                  /* one of the words in `choices` */
} OptType;

extern const char *const opt_type_names[];      /* by type: "bool", "integer", ... */

typedef struct {
    const char *key;
    OptType     type;
    double      num;            /* default of BOOL, INT, FLOAT, grey RGB, POINT (all three) */
    double      lo, hi;         /* closed range of numbers; lo == hi: any */
    const char *str;            /* default of STRING and CHOICE; "x y z" of POINT (else num) */
    const char *choices;        /* CHOICE: "a b c" */
    const char *help;
    const char *also;           /* other spellings, "Kd color": those of older scene files */
} OptDef;

/* ---- typed parameters as a scene file gives them ---- */

typedef enum { PARAM_BOOL, PARAM_INT, PARAM_FLOAT, PARAM_STRING, PARAM_TEXTURE } ParamType;

typedef struct {
    const char *name, *type;    /* borrowed: type as written, "rgb", "point3", "spectrum" */
    ParamType   kind;           /* how the values are held */
    Place       at;
    size_t      n;
    const double *numbers;      /* BOOL (0, 1), INT, FLOAT; borrowed */
    const char *const *strings; /* STRING, TEXTURE; borrowed */
    bool        used;           /* someone asked for it */
} Param;

typedef struct { Param *p; size_t n; } Params;          /* borrowed from the scene file's arena */

/* By name, also by the other spellings of `also`; marks it used. NULL if not given. */
Param *params_find(const Params *ps, const char *name, const char *also);

/* ---- values of a table ---- */

typedef struct {
    double num;
    Rgb    rgb;                 /* RGB and POINT */
    const char *str;
    bool   given;               /* by the user, not the default */
    const Param *param;         /* the typed parameter it came from, or NULL */
} OptValue;

enum { OPT_MAX = 40 };          /* most options of one kind */
typedef struct { const OptDef *defs; OptValue value[OPT_MAX]; } Opts;

void opts_default(Opts *o, const OptDef *defs);

/* Sets from "key=value,key=value" (strings are copied to the arena). False: reported as a usage
 * error that names `what` and the nearest key. */
bool opts_parse(Opts *o, const char *what, const char *text, Arena *arena);

/* Sets from typed parameters. A parameter that the table has not is a warning with its place and
 * the nearest name; a value of the wrong type or out of range an error. */
bool opts_params(Opts *o, const char *what, const Params *ps);

/* By key; a key that is not in the table is our bug (ASSERT). */
bool        opt_bool(const Opts *o, const char *key);
int64_t     opt_int(const Opts *o, const char *key);
float       opt_float(const Opts *o, const char *key);
Rgb         opt_rgb(const Opts *o, const char *key);
V3          opt_point(const Opts *o, const char *key);
const char *opt_string(const Opts *o, const char *key);
bool        opt_is(const Opts *o, const char *key, const char *choice);
int         opt_choice(const Opts *o, const char *key); /* its place among the table's choices */
bool        opt_given(const Opts *o, const char *key);
void        opt_set_number(Opts *o, const char *key, double v);
const Param *opt_param(const Opts *o, const char *key);  /* NULL: not from a scene file */

#endif

/* race.h -- several methods on one scene, and how their error falls: with samples, with time.
 *
 * A race is an order (from the command line or a file), and results for each of its methods: the
 * error at some checkpoints of one render, and the slope of log error against log samples.
 *
 * Source  [Cline07] 4.6: error (4.13); without a reference, from two renders (4.14), (4.15).
 *         [GIRT] appendix C: what a file of measurements holds. */
#ifndef RENDER_RACE_H
#define RENDER_RACE_H

#include "base/statistics.h"
#include "render/render.h"

enum { RACE_METHODS = 16, RACE_LOOKS = 48 };
#define RACE_CONFIDENCE 0.95            /* of the interval of a slope */

/* ---- the order ---- */

typedef struct {
    const char *label;                  /* borrowed */
    const IntegratorKind *integrator;   Opts integrator_opts;
    const SamplerKind    *sampler;      Opts sampler_opts;      /* NULL: that of all */
} RaceMethod;

typedef enum {
    REFERENCE_PAIR,             /* none: each method is rendered twice */
    REFERENCE_FILES,            /* one picture, or two that are independent: their mean */
    REFERENCE_AUTO              /* rendered first, in two independent halves */
} RaceReference;

/* All text is borrowed, or stands in the arena. Zero or NULL: not said. */
typedef struct {
    Arena       arena;                  /* owned */
    const char *scene;
    RenderRequest request;              /* of all methods: size, seed, threads, sampler, ... */
    Setting     sampler, filter, accelerator;   /* likewise, if a file gave them */
    RaceMethod  method[RACE_METHODS];
    int         nmethods;
    uint32_t    spp[RACE_LOOKS];        /* checkpoints by samples, rising; */
    int         nspp;                   /* without any: */
    double      seconds[RACE_LOOKS];    /* checkpoints by time, rising; the last ends the render */
    int         nseconds;
    RaceReference reference;
    const char *reference_file[2];
    RaceMethod  reference_method;       /* AUTO; integrator NULL: "path" */
    uint32_t    reference_spp;          /* AUTO, of each half; 0: by the rule below */
    double      reference_seconds;      /* likewise */
    double      autosave[RACE_LOOKS];   /* rising: when pictures are written */
    int         nautosave;
    const char *outputs[OUTPUTS_MAX];   /* pictures: race_picture_name tells their names */
    int         noutputs;
    const char *csv, *plot;
} RaceOrder;

/* Each half of a reference has so many times the largest checkpoint. */
enum { REFERENCE_TIMES = 16, REFERENCE_TIMES_SECONDS = 4 };

void race_order_clear(RaceOrder *o);

/* A method from "INTEGRATOR[:key=value,...][@SAMPLER[:key=value,...]]", which is its label too.
 * False: usage error reported. */
bool race_method_parse(RaceMethod *m, const char *text, Arena *arena);
bool race_add_method(RaceOrder *o, const char *text);

/* One number n: 1, 2, 4, ... and n; else the list as it is. False: it does not rise or is too
 * long, or a number is not in range; nothing reported. */
bool race_spp_set(RaceOrder *o, const double *v, int n);
/* One number t: t / 128, t / 64, ... t. */
bool race_seconds_set(RaceOrder *o, const double *v, int n);
bool race_autosave_set(RaceOrder *o, const double *v, int n);

/* Reads a file of one race into *o, which is empty or holds defaults. The grammar is that of the
 * scene language, see racefile.c. False: reported with its place. */
bool race_file_read(RaceOrder *o, const char *path, const ReadLimits *limits);
/* The same from a text; path is its name, for messages and for the files that it names. */
bool race_file_parse(RaceOrder *o, const char *path, const char *text, size_t n,
                     const ReadLimits *limits);

/* ---- the results ---- */

typedef struct {
    double spp;                         /* mean samples a pixel */
    double seconds, cpu_seconds;        /* of rendering up to here */
    double sigma_over_mu;               /* the reference's own noise is taken off, if it is known */
    double relmse;                      /* likewise; infinite without a reference to divide by */
    double mean;                        /* of |c| over the picture */
    bool   doubtful;                    /* the error is below the noise of the reference */
    bool   known;                       /* this checkpoint was reached */
} RacePoint;

typedef struct {
    const char *label;                  /* borrowed */
    const char *sampler;                /* borrowed */
    RacePoint point[RACE_LOOKS + 1];    /* known ones first */
    int       n;
    bool      fresh;                    /* each checkpoint is a render of its own */
    LineFit   fit;                      /* log sigma/mu against log spp; doubtful points left out */
    double    reach;                    /* CPU seconds to the error of the goal; 0: not known */
    int       reach_is;                 /* 0: just so; -1: no more than that; 1: more than that */
} RaceResult;

typedef struct {
    RaceResult result[RACE_METHODS];
    int      n;                         /* methods that have a checkpoint */
    uint32_t w, h;                      /* of the window that is rendered */
    uint64_t seed;
    int      threads;
    RaceReference reference;
    bool     noise_known;               /* of the reference: */
    double   noise_over_mu;             /* sigma/mu */
    double   mean;                      /* of the reference, else of the first method's last */
    double   goal;                      /* the error that the first method ends with */
    bool     interrupted;
} Race;

/* Of a method whose checkpoints are set, wherever they stand in point[]: known ones first, the fit.
 * Of a race whose methods are finished: goal, mean, and who reaches the goal when. */
void race_finish(RaceResult *r);
void race_conclude(Race *race);

/* Runs what is ordered; base: what settings_resolve made of o->request for the scene, which must be
 * built. Pictures are written on the way. False: reported, and *race holds what was done before. */
bool race_run(const RaceOrder *o, const Scene *scene, const RenderSettings *base, Race *race);

/* Whether two counts of planned samples give different numbers, as patterns do that must know how
 * many points they have: then a part of a render is not a render of fewer samples. False if the
 * sampler cannot be made, which is reported. */
bool race_sampler_plans(const RaceMethod *m, uint32_t few, uint32_t many, bool *plans);

/* Whether other seeds give other points: not those of fixed patterns, of which at most the order
 * changes. Two renders then are not independent. spp 0: not known. */
bool race_sampler_seeded(const RaceMethod *m, uint32_t spp, bool *seeded);

/* "plates.pfm", method 2 called "mis@halton", 20 s: "plates-2-mis_halton-20s.pfm". seconds < 0: the
 * end, "plates-2-mis_halton.pfm". Owned by the caller; NULL: out of memory. */
char *race_picture_name(const char *output, int method, const char *label, double seconds);

#endif

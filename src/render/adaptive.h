/* adaptive.h -- how many samples each pixel gets. One file a policy; adaptive.c has the list.
 *
 * For integrators that give radiance along a camera ray. A pixel's samples are those of its own
 * sequence, 0, 1, 2 ...; a policy says between passes how many of them each pixel shall have, and
 * the driver takes them. What a pixel has does not depend on threads, for a policy looks at pixels
 * that are complete, in an order that is fixed.
 *
 * Truth       A mean of n samples is unbiased if n does not depend on them. Which pixels a count
 *             may look at, and when, is said in the file of each policy. The counts depend on the
 *             pixels around, so a window (--crop) is not quite that part of the whole picture. */
#ifndef RENDER_ADAPTIVE_H
#define RENDER_ADAPTIVE_H

#include "image/film.h"
#include "integrators/integrator.h"

typedef struct Adaptive Adaptive;

enum { SEEN_MARKS = 8 };
enum { PASS_MOST = 64 };                /* most samples a pixel in a pass, by a policy or not */

/* What has been seen of one pixel. */
typedef struct {
    double   sum, squares;      /* of the luminances of the samples taken */
    float    mark[SEEN_MARKS];  /* entry k % SEEN_MARKS: mean of the first 2^k, for the last k */
    uint32_t taken, want;       /* samples: done; to be done before the next plan */
    uint32_t dropped;           /* done before these and thrown away */
    uint32_t keep;              /* those from this one on are not part of the picture */
} Seen;

typedef struct {
    KindInfo info;
    Truth truth;
    /* Makes a->pilot or whatever else. False: reported. NULL: nothing to do. */
    bool (*start)(Adaptive *a);
    /* Between passes: sets Seen.want. False: the picture is done. NULL: the policy has no say about
     * single pixels; the whole picture stops. */
    bool (*plan)(Adaptive *a);
    /* Units of the pass at hand and running one of them. NULL: tiles. The units of two workers may
     * not share a tile of the film. */
    uint32_t (*units)(const Adaptive *a);
    void (*run)(Adaptive *a, uint32_t unit, Taker *t);
} AdaptiveKind;

extern const AdaptiveKind *const adaptives[];   /* ends with NULL */
extern const AdaptiveKind adaptive_none;
#define ADAPTIVE_DEFAULT "neighbours"

struct Adaptive {
    const AdaptiveKind *kind;
    Opts     opts;
    Film    *film;              /* borrowed */
    uint32_t n;                 /* pixels of the window */
    uint64_t seed;
    uint32_t least;             /* samples that every pixel gets, a power of two */
    uint32_t mean;              /* samples a pixel on average; 0: until error or time ends it */
    uint32_t most;              /* of any pixel */
    double   error;             /* sigma/mu wanted; 0: none */
    double   expected;          /* samples of the window in all, as far as one can tell; 0: not */
    Seen    *seen;              /* owned: of each pixel */
    float   *room;              /* owned: two a pixel, for plans */
    double  *way;               /* owned: one a row of tiles, for those who go along them */
    Seen    *pilot;             /* owned: samples that are no part of the picture, or NULL */
    uint32_t npilot;
    uint32_t slice;             /* most samples of a pixel in this pass */
    int      step;              /* the policy's own, as are the others: where it is */
    double   level, average;
    bool     done[2];
};

/* spp: with an error the most that a pixel gets, else the mean; 0: not said. False: reported. */
bool adaptive_init(Adaptive *a, const AdaptiveKind *kind, const Opts *o, Film *film, uint32_t spp,
                   double error, uint64_t seed);
void adaptive_clear(Adaptive *a);
/* Whether there is another pass, planning where the one before has ended a plan. */
bool adaptive_next(Adaptive *a);
uint32_t adaptive_units(const Adaptive *a);
void adaptive_run(Adaptive *a, uint32_t unit, Taker *t);
/* Samples taken so far, also those that are not in the picture. */
uint64_t adaptive_taken(const Adaptive *a);
double adaptive_coming(const Adaptive *a);      /* samples of the next pass, about */

/* ---- for the policies ---- */

/* The option that all have. */
#define ADAPTIVE_LEAST { .key = "min", .type = OPT_INT, .num = 16, .lo = 1, .hi = 65536,           \
                         .help = "samples that every pixel gets, rounded up to a power of two" }

/* Takes up to `most` of the samples that are wanted of a pixel. Those of a pilot are independent of
 * those of the picture, and no part of it. */
void adaptive_take(Seen *s, Taker *t, uint32_t x, uint32_t y, uint32_t most, bool pilot);
void seen_drop(Seen *s);        /* as if no sample had been taken */
void adaptive_tile(Adaptive *a, uint32_t tile, Taker *t);       /* a pass of a tile of pixels */
/* All that plans rest on, into a file and back. */
void adaptive_save(const Adaptive *a, Saving *s);
bool adaptive_load(Adaptive *a, Loading *l);    /* false: it does not fit, not reported */
/* Every pixel shall have n samples at least. */
void adaptive_want(Adaptive *a, uint32_t n);
double adaptive_mean(const Adaptive *a);        /* of all samples of the window */
double seen_variance(const Seen *s);            /* of a sample; two or more are taken */
/* Q of the first 2^k samples: see film.c. k >= 1; no more than 2^(k + 6) samples are taken. */
double seen_q(const Seen *s, int k);

#endif

/* sampler.h -- canonical numbers by named decision.
 *
 * A path builder never asks for "the next random number". It asks for a decision: what is being
 * decided, at which bounce. A sampler answers with a number that is a pure function of the seed,
 * the pixel, the sample's index and the decision, so that patterns can stratify each decision by
 * itself, a Markov chain can mutate it, a map can guide it, and a test can enumerate it, all with
 * the same path code; and so that nothing depends on the order in which work is done. */
#ifndef SAMPLING_SAMPLER_H
#define SAMPLING_SAMPLER_H

#include "base/kind.h"
#include "base/random.h"
#include "base/vec.h"

typedef enum {
    DECIDE_PIXEL,               /* 2-D: place on the pixel */
    DECIDE_LENS,                /* 2-D: place on the lens */
    DECIDE_TIME,                /* 1-D: moment of the shutter */
    DECIDE_LIGHT,               /* 1-D: which light */
    DECIDE_LIGHT_POINT,         /* 2-D: point on it, or direction to it */
    DECIDE_LOBE,                /* 1-D: which part of the BSDF; reflect or transmit */
    DECIDE_DIRECTION,           /* 2-D: scattered direction */
    DECIDE_DISTANCE,            /* 1-D: to the next scattering in a medium */
    DECIDE_ROULETTE,            /* 1-D: go on or end */
    DECIDE_TRY_LOBE,            /* 1-D, 2-D: lobe and direction of what is tried, */
    DECIDE_TRY_DIRECTION,       /* besides the direction that the path takes */
    DECIDE_KEEP,                /* 1-D: which of the tentative samples is kept */
    DECIDE_SKY,                 /* 2-D: directions to the light from beyond, by its map */
    DECIDE_BAND,                /* 1-D: the band of the spectrum of a photon */
    DECIDE_PICTURE,             /* 2-D: places on lamps with pictures, by their maps */
    DECIDE_TECHNIQUE,           /* 1-D: in which way a path is made; small steps leave it alone */
    /* 1-D: whether a learned map chooses the direction. Shared: no method has photons and maps. */
    DECIDE_GUIDE = DECIDE_BAND,
    DECIDE_KINDS = 16           /* a power of two: the last bits of a Decision */
} DecisionKind;

typedef uint32_t Decision;
#define DECISION(kind, bounce) ((Decision)(kind) + (Decision)(bounce) * DECIDE_KINDS)

typedef struct Sampler Sampler;

typedef struct {
    KindInfo info;
    /* From options. spp: samples a pixel that are planned, which the sampler may round up, saying
     * so by a note; 0: not known, as when a budget of time ends the render. A plan is no limit:
     * any index may be asked for. False: reported, with nothing left to clear. NULL: nothing to
     * do. */
    bool (*init)(Sampler *s, const Opts *o, uint32_t *spp);
    bool plans;                 /* numbers depend on how many samples are planned */
    void (*clear)(Sampler *s);  /* frees the state; NULL: it has none */
    /* After the index of a new sample is set. NULL: nothing to do. */
    void (*start)(Sampler *s);
    /* Numbers in [0, 1): multiples of 2^-24. */
    float (*one)(Sampler *s, Decision d);
    V2    (*two)(Sampler *s, Decision d);
} SamplerKind;

/* By value: a copy is an independent sampler of the same pattern. Copies share the state, which is
 * only read; it is cleared once, by whoever holds the first. */
struct Sampler {
    const SamplerKind *kind;
    uint64_t seed;
    uint64_t pixel;             /* key of the pixel and the seed */
    uint64_t key;               /* key of pixel and sample */
    uint32_t index;             /* of the sample in its pixel */
    uint32_t reversed;          /* the index with its bits in reverse, where the kind wants it */
    uint32_t spp;               /* planned samples a pixel; 0: not known */
    bool     fixed;             /* the same pattern in all pixels */
    int      way;               /* of randomizing, or another choice of the kind's own */
    int      dimensions;        /* of one sequence, where the kind has such */
    uint32_t block, most;       /* samples of a pattern; 0: not known, see pattern.h */
    uint32_t at, size;          /* the sample's place in its pattern; the pattern's samples */
    uint32_t nx, ny;            /* its strata in 2-D */
    uint32_t parts;             /* of strata, across, where the kind wants it */
    uint64_t pattern;           /* key of pixel and pattern */
    void    *state;             /* the kind's own, shared by copies; NULL: none */
};

bool sampler_init(Sampler *s, const SamplerKind *kind, const Opts *o, uint64_t seed, uint32_t *spp);
void sampler_clear(Sampler *s);                         /* of all copies */
void sampler_pixel(Sampler *s, uint32_t x, uint32_t y); /* before the first sample of a pixel */
void sampler_start(Sampler *s, uint32_t index);         /* before each sample of the pixel */

/* For a path of a sample beside the one from the eye: decisions of the same names are others. */
typedef enum { PATH_FROM_LAMP = 2, PATH_SPLIT } SamplerPath;
void sampler_other(Sampler *s, SamplerPath path);

INLINE float sample_1d(Sampler *s, Decision d) { return s->kind->one(s, d); }
INLINE V2    sample_2d(Sampler *s, Decision d) { return s->kind->two(s, d); }

/* For a sample that decides some things n times: a sampler for the k-th time. The n times of all
 * samples of a pixel are one pattern, n times as long, so they are spread as evenly over the pixel
 * as over each sample, and other decisions are matched with them as samples are among themselves:
 * [Shirley91 5.4.1] by permutation, not by multiplying. Decisions that it makes must not be made by
 * *s too. */
INLINE Sampler sampler_part(const Sampler *s, uint32_t n, uint32_t k)
{
    Sampler part = *s;
    if (n > 1)
        sampler_start(&part, s->index * n + k);
    return part;
}

extern const SamplerKind *const samplers[];     /* ends with NULL */
#define SAMPLER_DEFAULT "zerotwo"

#endif

/* chains.h -- what Metropolis methods share: many chains of states side by side, where they start,
 * and what their visits are worth.
 *
 * Source      [Cline07 7.11, 7.13; errata 7.4, 7.5, 7.13], [Veach97 11.3] for starts without bias,
 *             [Kelemen02] for weights and large steps.
 * Idea        A state x brings the picture the light f(x), of brightness I(x), its luminance summed
 *             over the picture. A chain that goes from x to a proposal y with the probability a =
 *             min(1, I(y) T(y>x) / (I(x) T(x>y))), (7.13), and stays else, comes to each x in
 *             proportion to I(x). So the mean of f(x) b / I(x) along it is the picture, b being the
 *             integral of I.
 * Starts      Of n samples, independent or spread evenly, b is the mean brightness, and each chain
 *             begins at one of them, drawn in proportion to its brightness. Then the expectation of
 *             (that b) / I(x) f(x) is the picture at every step, from the first on: none has to be
 *             thrown away.
 *             Starts are drawn at equal distances along the running sum of brightness, so they are
 *             spread as the samples are.
 * Visits      Both ends of a step count, the proposal a and the present state 1 - a: the mean
 *             over the decision, instead of the decision. chain_steps does this.
 * Large steps Proposals that are drawn as the first samples are, with no regard to the present
 *             state, in a share p of all steps, are also a plain estimate of the picture: the mean
 *             of f(y) / p over all steps. Two estimates of one thing, of densities I/b a step and
 *             p: by the balance heuristic f counts, with any constant c,
 *                 (b / c) / (I/c + p)   a visit,        1 / (I/c + p)   a large proposal,
 *             and the sum has the right expectation whatever c is, for it is in the weights alone;
 *             c = b makes them those of [Kelemen02]. Without large steps p = 0 and a visit counts
 *             b / I.
 * b           Large steps are samples like those: their brightness goes on to refine b from pass
 *             to pass; c stays. What a pass adds is worked out with the b that came before it. That
 *             is why methods of chains are consistent: b and the visits of later passes depend on
 *             each other a little.
 * Darkness    A chain without a start (nothing was found) tries large steps till it finds light.
 * Passes      Phase 0, in the first pass alone: the samples, a part of them a unit. Phase 1: a unit
 *             a chain; the chains' steps are together as many as the window has pixels. A shot is
 *             a step. */
#ifndef INTEGRATORS_CHAINS_H
#define INTEGRATORS_CHAINS_H

#include "integrators/integrator.h"

typedef struct Chains Chains;

/* One chain: first member of every concrete one. */
typedef struct {
    uint64_t key;               /* of its own random numbers, for its steps */
    uint64_t steps;             /* so far; before it starts, the sample that it starts with */
    float    brightness;        /* I of the present state; 0: it has none */
    double   weight;            /* of visits to the present state that are not on the film yet */
    double   found;             /* brightness of the large steps of this pass, summed, */
    uint64_t tries;             /* and how many there were */
} Chain;

typedef struct {
    size_t size;                /* of the concrete chain, bytes */
    float  large;               /* p: share of steps that are large; 0: there are none */
    /* False: reported. What it holds is freed by clear, called on each that init was called on. */
    bool (*init)(Chains *cs, Chain *c);
    void (*clear)(Chain *c);
    /* Makes sample `number` of `total` the state: a function of these and the seed alone. Returns
     * its brightness: finite, not negative, 0 of light that the film would refuse. */
    float (*start)(Chains *cs, Chain *c, uint64_t number, Tracer *t);
    /* One step: proposes a state, says by chain_steps what becomes of it. */
    void (*step)(Chains *cs, Chain *c, Tracer *t);
    /* Splats the light of the present state, times weight. */
    void (*show)(Chains *cs, Chain *c, float weight, Tracer *t);
    /* The present state, into a file and back. False: it does not fit. */
    void (*save)(const Chains *cs, const Chain *c, Saving *s);
    bool (*load)(const Chains *cs, Chain *c, Loading *l);
} ChainKind;

/* An integrator of chains: the first member of every concrete one. */
struct Chains {
    Integrator base;
    ChainKind kind;
    uint64_t seed;
    void    *chains;            /* owned: n concrete ones */
    size_t   n, inited;
    uint64_t asked;             /* for samples to start with; 0: as many as pixels */
    uint64_t total;             /* such samples */
    float   *brightness;        /* owned: of each of them, till chains have chosen; then NULL */
    double   found;             /* brightness of independent samples so far, and */
    uint64_t tries;             /* their number: b is the quotient */
    double   b, c;              /* of this pass; c > 0 */
    uint64_t pixels;            /* of the window: steps of a pass */
    uint32_t begun;             /* passes in which chains go on or have gone on */
};

/* Of a zeroed *cs, whose base.scene is set. */
void chains_open(Chains *cs, const ChainKind *kind, const Opts *o);
void chains_clear(Chains *cs);
/* As .prepare, .units and .run of an integrator. */
bool chains_prepare(Integrator *it, const Film *f, uint64_t seed);
enum { CHAINS_PHASES = 2 };
uint64_t chains_units(Integrator *it, const Film *f, uint32_t pass, int phase);
void chains_run(Integrator *it, Film *f, uint32_t pass, int phase, uint64_t unit, Tracer *t);

/* As .save and .load of an integrator that keeps all. */
void chains_save(const Integrator *it, Saving *s);
bool chains_load(Integrator *it, Loading *l);

INLINE Chain *chains_at(const Chains *cs, size_t k)
{
    return (Chain *)((char *)cs->chains + k * cs->kind.size);
}

INLINE size_t chains_index(const Chains *cs, const Chain *c)
{
    return (size_t)((const char *)c - (const char *)cs->chains) / cs->kind.size;
}

/* What a visit to a state counts, and a large proposal beside it. */
INLINE double chains_visit(const Chains *cs, float brightness)
{
    return cs->b / ((double)brightness + cs->kind.large * cs->c);
}
INLINE double chains_try(const Chains *cs, float brightness)
{
    return cs->c / ((double)brightness + cs->kind.large * cs->c);
}

/* What a step comes to. */
typedef struct {
    bool   moves;               /* the proposal becomes the present state */
    double left;                /* what the state that is not kept counts on the film: show it */
} Step;

/* A proposal of this brightness, to be accepted with the probability a; large: drawn as samples to
 * start with are; u, in [0,1), decides. Where the chain moves, the old state is shown with .left,
 * where it stays the proposal is; Chain.weight and .brightness are seen to. */
Step chain_steps(const Chains *cs, Chain *c, float brightness, float a, bool large, float u);

/* a of symmetric proposals, whose T are the same both ways. */
INLINE float chain_accepts(const Chain *c, float brightness)
{
    return brightness < c->brightness ? brightness / c->brightness : 1.0f;  /* [Cline07 (7.13)] */
}

#define CHAINS_OPTIONS                                                         \
    { .key = "chains", .type = OPT_INT, .num = 256, .lo = 1, .hi = 1e6,        \
      .help = "chains side by side, whatever the number of threads" },         \
    { .key = "bootstrap", .type = OPT_INT, .num = 0, .lo = 0, .hi = 4e9,       \
      .help = "samples among which chains begin, and that tell how bright the picture is; 0: as " \
              "many as it has pixels, at least 64 a chain" }

#endif

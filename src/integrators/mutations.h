/* mutations.h -- ways to move a path a little, and how likely a chain is to follow.
 *
 * Source      [Cline07 7.12.1, figs 7.25 to 7.28, 8.4.2, 8.4.3, appendix 8A; errata 7.3, 7.4, 7.10,
 *             8.3, 8.4], [Veach97 11.4].
 * Kinds       lens        the place on the picture moves; the path is followed again up to the
 *                         first smooth vertex, through delta events of the same names, and joined
 *                         to the next vertex, which is smooth or a light.
 *             multichain  the same where a delta event comes next: the direction moves as well, and
 *                         so on from smooth vertex to smooth vertex, till two follow each other.
 *             caustic     the direction moves that light takes from the second smooth vertex, or
 *                         from its lamp, by delta events to the first, which the lens then sees
 *                         elsewhere; light from beyond the scene moves to the side instead, by as
 *                         many radii of the scene, or its kind could not be moved at all;
 *             inner       the same further on: to a smooth vertex that follows another, to which
 *                         it is joined. None of the others moves what lies behind two neighbours
 *                         that are smooth, which chains keep till they find a new path. Not in
 *                         the sources, and off by default.
 * Signature   A moved path has the same number of edges and the same events: so the same kinds
 *             apply to it, and the choice among them has the same probabilities both ways.
 * Acceptance  a = min(1, F(y) T(y>x) / (F(x) T(x>y))), (7.14), with F and T per area, T being
 *             products of T_pixel = p_pixel We |cos| / d^2 (errata 7.3), and of T_specular and
 *             T_perturbAngle = |cos| / d^2. Each of these factors of T is also one of F, see
 *             lightpath.h, so what is left is worth(y) / worth(x) with
 *                 lens, multichain  colour times |cos| / d^2 of the edge that joins, if any: rules
 *                                   1, 2 and 3 of 8.4.2; an edge to a light has it too, rule 4;
 *                 caustic           colour times the change from directions at the first smooth
 *                                   vertex, and places on the picture, to directions at the second
 *                                   one or at the lamp: rule 5 with errata 8.3;
 *                 inner             the same with 1 / d^2 in place of what the lens has.
 *             From the light's side the weight of a vertex is |cos_o| / |cos_i| times that from the
 *             eye's, and for refraction eta^2 |wi.ns| / |wo.ns| times that: [Veach97 5.2, 5.3].
 * Deltas      Light of a point, or from one direction, that comes by delta events to its first
 *             smooth vertex has no density over directions there: what is said of such paths is
 *             per direction, or place, at the lamp, so nothing moves them that would have to meet
 *             it.
 * Symmetry    Offsets depend on the distance alone between old and new, on the plane of the picture
 *             or across the light, and by the angle between directions: so the chance is the same
 *             both ways. */
#ifndef INTEGRATORS_MUTATIONS_H
#define INTEGRATORS_MUTATIONS_H

#include "integrators/lightpath.h"

typedef enum { MUTATE_LENS, MUTATE_MULTICHAIN, MUTATE_CAUSTIC, MUTATE_INNER,
               MUTATIONS } Mutation;
/* at: the vertex to which light comes on its new way; 0 where the eye begins. */
typedef struct { Mutation by; int at; } Move;

typedef struct {
    const Scene *scene;         /* borrowed */
    float share[MUTATIONS];     /* how often each is chosen, relative to others that apply */
    bool  always_caustic;       /* where light comes by delta events: nothing but that, 8.4.3 */
    float nearest, farthest;    /* on the picture, pixels, fig. 7.25; */
    float square;               /* or uniform in a square of this side; 0: not */
    float least, most;          /* angles, radians, fig. 7.26; of what comes from beyond the scene
                                 * ways to the side, in radii of the scene */
} Mutator;

/* Whether the mutation applies to paths like that. */
bool mutation_applies(Mutation m, const LightPath *p);
/* How it is done: where there are several ways, by u. */
Move mutation_move(Mutation m, const LightPath *p, float u);
/* Which one is tried: by u. MUTATIONS: none applies. */
Mutation mutation_chosen(const Mutator *it, const LightPath *p, float u);

/* Moves x: to *y, whose new vertices are in rooms, others shared with x. Gives
 * F(y) T(y>x) / (F(x) T(x>y)); 0: there is no such path. */
double mutated(const Mutator *it, Move m, const LightPath *x, LightPath *y,
               Vertex *const *rooms, Rng *r, Tracer *t);

/* One move by some mutation: its probability to be accepted. */
double mutation_tried(const Mutator *it, const LightPath *x, LightPath *y, Vertex *const *rooms,
                      Rng *r, Tracer *t);

#define MUTATION_OPTIONS(near, far, side)                                      \
    { .key = "lens", .type = OPT_FLOAT, .num = 1, .lo = 0, .hi = 1e6,          \
      .help = "share of lens perturbations where several kinds apply" },       \
    { .key = "multichain", .type = OPT_FLOAT, .num = 1, .lo = 0, .hi = 1e6,    \
      .help = "share of multi-chain perturbations" },                          \
    { .key = "caustic", .type = OPT_FLOAT, .num = 1, .lo = 0, .hi = 1e6,       \
      .help = "share of caustic perturbations" },                              \
    { .key = "inner", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 1e6,         \
      .help = "share of those that move what lies behind the first two smooth vertices: fewer " \
              "spikes, but more noise in all" },                               \
    { .key = "nearest", .type = OPT_FLOAT, .num = near, .lo = 1e-6, .hi = 1e6, \
      .help = "least move on the picture, pixels" },                           \
    { .key = "farthest", .type = OPT_FLOAT, .num = far, .lo = 0, .hi = 1e6,    \
      .help = "greatest move on the picture, pixels; 0: a tenth of its width" }, \
    { .key = "square", .type = OPT_FLOAT, .num = side, .lo = 0, .hi = 1e6,     \
      .help = "moves are uniform in a square of this side, pixels; 0: not" },  \
    { .key = "least", .type = OPT_FLOAT, .num = 1e-4, .lo = 1e-9, .hi = 1,     \
      .help = "least angle by which a direction moves, radians" },             \
    { .key = "most", .type = OPT_FLOAT, .num = 0.1, .lo = 1e-9, .hi = 1,       \
      .help = "greatest angle by which a direction moves, radians" }

/* By these options, and for a film. */
void mutator_init(Mutator *it, const Scene *s, const Opts *o);
void mutator_prepare(Mutator *it, const Film *f);

#endif

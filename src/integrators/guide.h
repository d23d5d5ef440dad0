/* guide.h -- seven learned maps that guide the decisions of a path, and that learn from what its
 * paths bring.
 *
 * Source      [Cline07 9.2, table 9.1]; errata 9.1 to 9.4.
 * Preimage    time, lens, distance, point: a sampler around the pixel's own warps the numbers of
 *             these decisions by the map; what follows counts over the map's density (9.3).
 * World       bifurcation, light, direction: a share of the decisions goes by the map, the others
 *             as ever; the density is that of both together (9.2), also in the weights of paths
 *             that end by meeting a light as well as by asking for it.
 * Where       Time, lens: of the camera sample. Distance: of the first ray. Bifurcation: at each
 *             polished surface that reflects and refracts, by the number of scattering events
 *             before. Light, point, direction (of surfaces only): at the first vertex that is no
 *             delta as a whole. With more `bounces`, distance at so many rays and the last three
 *             at so many such vertices, each with maps of its own.
 * Worth       What a decision learns from is the light that was found because of it: a light and a
 *             point on it from their connection, a direction or a bifurcation from all that comes
 *             after, time and lens from the whole.
 * Truth       A map may change between pixels only: then all densities of a pixel's samples are
 *             fixed before the first is drawn, and each is unbiased. Preimage maps are above 0
 *             everywhere, as a part of their density is even. World maps may be 0 where they like,
 *             as the other share goes everywhere.
 * Levels      A map is used as far as it is of use: besides it, pixels learn the second moment that
 *             their samples would have had without the map and with more and more of it, up to its
 *             share. The least is taken, if it is well below the first; else the map is left alone:
 *             it would cost more in strata than it brings.
 *             A bifurcation is trusted the more, the more has been learned of it.
 * Weights     Points on lights: the heuristic wants the number that would have given a direction
 *             that the surface chose [errata 9.4]. Pictures of the sky know it. With other lights
 *             it looks at their own densities, without the map's, for both ways: any weights whose
 *             sum is 1 are right; these are a little less than the best.
 * Roulette    Of a path that a guide takes often, each goes with less light. It must not end for
 *             that: Beam.eta2 takes the guide's part out of its strength. */
#ifndef INTEGRATORS_GUIDE_H
#define INTEGRATORS_GUIDE_H

#include "integrators/beam.h"
#include "lightsampling/lightsampler.h"
#include "sampling/learned.h"

typedef enum {
    GUIDE_TIME, GUIDE_LENS, GUIDE_BIFURCATION,
    GUIDE_DISTANCE, GUIDE_LIGHT, GUIDE_POINT, GUIDE_DIRECTION,  /* these for each bounce */
    GUIDE_KINDS
} GuideKind;
extern const char *const guide_names[GUIDE_KINDS];

enum { GUIDE_BOUNCES = 4, GUIDE_BOUNCE_MAPS = GUIDE_KINDS - GUIDE_DISTANCE };
enum { GUIDE_MAPS = GUIDE_DISTANCE + GUIDE_BOUNCES * GUIDE_BOUNCE_MAPS };
enum { GUIDE_LEVELS = 8 };      /* how much of a map is used: from nothing to its share */
enum { GUIDE_ROWS = 128 };      /* most, of maps of two numbers */
enum { FORK_FLOATS = 3 };       /* of bifurcations: masses of reflecting and refracting, trust */

/* The number of a map in a pixel's. */
INLINE int guide_map(GuideKind k, int bounce)
{
    return k < GUIDE_DISTANCE ? (int)k : (int)k + bounce * GUIDE_BOUNCE_MAPS;
}

/* What all pixels of a picture have in common. It stays where it is: maps point into it. */
typedef struct {
    LearnedShape shape[GUIDE_MAPS];             /* w 0: there is no such map */
    int   at[GUIDE_MAPS];       /* of its masses in a pixel's floats, moments after them */
    int   room[GUIDE_MAPS];     /* of its inverted table in a guide's */
    int   floats, rooms;        /* of a pixel; of all tables */
    int   map[GUIDE_MAPS], nmaps;               /* the maps there are, but for bifurcations, */
    int   forks;                /* and entries of that */
    LearnedRing rings[GUIDE_ROWS];              /* of maps of directions */
    float level[GUIDE_LEVELS];  /* shares, from 0 to `share` */
    int   bounces;
    float share;                /* of maps that are trusted: alpha of (9.2) */
    bool  coin;                 /* reflecting and refracting are even without a map */
    const Scene *scene;         /* borrowed */
} GuidePlan;

/* cells[k]: entries of maps of kind k, along each side if they have two; 0: none. What the scene
 * has no use for is left out. */
void guide_plan(GuidePlan *p, const Scene *s, const int cells[GUIDE_KINDS], int bounces,
                float share, bool coin);
/* The floats of a pixel that knows nothing. */
void guide_forget(const GuidePlan *p, float *maps);

/* NULL: memory, reported. The guide borrows the plan. */
Guide *guide_new(const GuidePlan *p);
void   guide_free(Guide *g);

/* ---- pixel by pixel ---- */

/* From now on *t is guided, by the pixel's maps, until guide_learns, after its last sample: then
 * they have what others may go by. */
void guide_pixel(Guide *g, Tracer *t, float *maps, uint32_t x, uint32_t y);
void guide_learns(Guide *g, Tracer *t);

/* ---- for whoever builds paths ----
 *
 * starts, then for each event flies, turns (where it scatters), connected (for light found by a
 * connection there), leaves (all decisions there are made); ends. `sum` is the light so far. Where
 * only what comes before the first vertex is guided, to fly is enough. */

void guide_starts(Guide *g, Beam *b);
void guide_flies(Guide *g, Beam *b, Rgb sum);
void guide_turns(Guide *g, const Beam *b, bool smooth);
void guide_connected(Guide *g, Rgb light);
void guide_leaves(Guide *g, Rgb sum);
void guide_ends(Guide *g, Rgb sum);

/* As the functions of a LightSampler; also of the vertex before, up to the next guide_turns. */
const Light *guide_light(Guide *g, const LightSampler *ls, V3 p, V3 n, float u, float *pmf);
float guide_light_pmf(const Guide *g, const LightSampler *ls, V3 p, V3 n, const Light *l);
/* What the density of a direction to a light is multiplied by, because of its point's number, where
 * the light knows that of every direction; else 1. */
float guide_point_pdf(Guide *g, const Light *l, bool beside, V3 wi);
/* For the sample of a light that was asked for: into *pdf as well; else into what it brings. */
void  guide_points(const Guide *g, const Light *l, bool beside, LightSample *s, float *pdf);

/* Light l was met along wi, by a direction of the vertex, whose density is so many times the
 * light's own: its map of points would have wanted that too, where the light knows the number. */
void  guide_met(Guide *g, const Light *l, bool beside, V3 wi, float density, Rgb light);

/* As vertex_sample, for the beam's next event; tells b of its part in the density. */
bool guide_scatters(Guide *g, const Vertex *v, Tracer *t, Beam *b, BsdfSample *s);
/* Density of that where the vertex itself has the density `own`. */
float guide_pdf_w(const Guide *g, V3 wi, float own);

#endif

/* progressive.h -- what ppm and sppm share: eye paths to where photons are gathered, within a
 * radius that shrinks from pass to pass.
 *
 * Source      [GIRT 2.3.3, 2.3.4 (2.73) to (2.79); errata 3], [Hachisuka08], [Hachisuka09].
 * Estimate    With radius R, photons of flux F that came along w and paths of the eye with
 *             throughput T, a pass of n particles gives
 *                 T sum f(w) F / (pi R^2 n)                                        (2.79)
 *             and the mean of the passes is the picture. That is the sources' tau / (pi R^2 N): for
 *             tau' = (tau + tau_M) R'^2 / R^2, see (2.77), so that tau / R^2 is but a sum of
 *             tau_M / R^2 over passes, each with the radius that it had. No tau has to be kept, and
 *             the film adds up exactly.
 * Radius      Of M photons more, a share alpha is kept: N' = N + alpha M  (2.74) and
 *             R' = R sqrt((N + alpha M) / (N + M))  (2.75), so that both the radius falls to
 *             nothing and the count grows beyond bounds, with R^2 ~ n^(alpha-1) after n passes. For
 *             sppm these belong to a pixel, wherever its paths end ("shared statistics").
 * First       radius: given, or such that it holds k photons of the first pass; k-1 of these are
 *             nearer than it, and that is the right number for its area.
 * Corners     Photons count whatever the normal is where they are. In a corner those of the other
 *             wall stand in for what is missing of the disc, and do so well: to ask for like
 *             normals makes corners dark, and the error of 64 passes 1.2 to 1.7 times what it is.
 * Direct      light is found as `direct` does with strategy=mis: photons are those that have been
 *             scattered before.
 * Limits      For any number of passes the picture is blurred a little, by less with each. */
#ifndef INTEGRATORS_PROGRESSIVE_H
#define INTEGRATORS_PROGRESSIVE_H

#include "integrators/beam.h"
#include "integrators/lighting.h"
#include "integrators/photonpass.h"

typedef struct { float radius, photons; } Refined;      /* R, 0: not yet set; and N */

typedef struct {
    Integrator base;
    Lighting lighting;          /* owned */
    PhotonPass pass;            /* owned */
    int   maxdepth, roulette;
    bool  through;              /* paths of the eye go on from glossy surfaces */
    float alpha;
    float radius;               /* given; 0: by k */
    int   k;
    float most, least;          /* of the first radius by k */
    uint64_t particles;         /* of a pass; 0: as many as the picture has pixels */
    Refined *refined;           /* owned: [pixel][each] */
    size_t nrefined, each;
    uint32_t x0, y0, w;         /* window of the film */
    float    edge;              /* of the cells of pass number edge_of, from 1 on; 0: of none */
    uint32_t edge_of;
} Progressive;

/* Of a zeroed *it: all but what depends on the picture. False: reported, not cleared. */
bool progressive_open(Progressive *it, const char *name, const Scene *s, const Opts *o);
void progressive_clear(Progressive *it);
/* `each` statistics for each pixel of the window. False: reported. */
bool progressive_prepare(Progressive *it, const Film *f, size_t each);

/* The phases of an integrator, as .units and .run. */
enum { PROGRESSIVE_PHASES = PHOTONPASS_PHASES };
uint64_t progressive_units(Integrator *it, const Film *f, uint32_t pass, int phase);
void progressive_run(Integrator *it, Film *f, uint32_t pass, int phase, uint64_t unit, Tracer *t);

/* IntegratorKind.save and .load, or a part of them. Photons are summed in the order of their cells,
 * so a pass that goes on must have the cells that it began with. */
void progressive_save(const Integrator *it, Saving *s);
bool progressive_load(Integrator *it, Loading *l);

/* The statistics number `which` of the tracer's pixel. */
INLINE Refined *progressive_of(const Progressive *it, const Tracer *t, size_t which)
{
    return &it->refined[((size_t)(t->y - it->y0) * it->w + (t->x - it->x0)) * it->each + which];
}

/* The pass's estimate of the radiance along the ray, which refines *m. The tracer's sampler leads
 * the path, *light asks for direct light. */
Rgb progressive_look(const Progressive *it, const Ray *r, Refined *m, const Sampler *light,
                     Tracer *t);

#define PROGRESSIVE_OPTIONS                                                    \
    { .key = "radius", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 1e30,       \
      .help = "the first radius in which photons are gathered; 0: by k" },     \
    { .key = "k", .type = OPT_INT, .num = 32, .lo = 2, .hi = NEAREST_MOST,     \
      .help = "photons of the first pass that the first radius holds" },       \
    { .key = "share", .type = OPT_FLOAT, .num = 0.05, .lo = 1e-6, .hi = 1,     \
      .help = "most that the first radius by k may be, of the scene's" },      \
    { .key = "alpha", .type = OPT_FLOAT, .num = 2.0 / 3, .lo = 0.01, .hi = 1,  \
      .help = "share of new photons that count; the radius falls the faster the less, with 1 " \
              "not at all" },                                                  \
    { .key = "photons", .type = OPT_INT, .num = 0, .lo = 0, .hi = 4e9,         \
      .help = "particles of a pass; 0: as many as the picture has pixels" },   \
    MAXDEPTH_OPTION,                                                           \
    ROULETTE_OPTION(1),                                                        \
    { .key = "glossy", .type = OPT_CHOICE, .str = "gather", .choices = "gather follow", \
      .help = "glossy surfaces without a matt part: photons are gathered there, or the eye's " \
              "paths go on" },                                                 \
    LIGHTING_HEURISTIC,                                                        \
    LIGHTING_SKY,                                                              \
    LIGHTING_LIGHTSAMPLER

#endif

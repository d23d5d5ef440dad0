/* virtuallights.h -- the light of the scene as points that shine: virtual point lights, from the
 * places where particles leave lamps and from those where surfaces scatter them.
 *
 * Source      [Keller97], [Cline07 7.8, fig. 7.15; errata 7.7].
 * Emission    Of N paths, the place y that a particle leaves, chosen with the density p over all
 *             lamps, shines with the intensity L(y, w) |cos| / (N p): all directions, not only the
 *             one that the particle takes. (Fig. 7.15 with its caption: it is the BSDF at the
 *             virtual light that a lamp does not have.)
 * Surfaces    A vertex that is reached by the flux F shines with F f* |cos| / N, f* being the
 *             model there, matt or not; see particle.h for the adjoint and shading normals. Delta
 *             surfaces send the particle on and shine for nobody.
 * Not these   Lights beyond the scene and delta lights have no places of area: their particles
 *             leave light on surfaces, but they have to be asked for themselves.
 * Sets        n * n of them, each of N paths, each of them the light of all [Cline07 7.8.3].
 * Memory      Paths are made twice: first to count what they leave, then into their places. So an
 *             order of lights follows from the numbers of paths, whoever makes them.
 * Media       What they take is taken; what they scatter is left out.
 * Motion      Lights lie where things are in the middle of the shutter's time. */
#ifndef INTEGRATORS_VIRTUALLIGHTS_H
#define INTEGRATORS_VIRTUALLIGHTS_H

#include "integrators/particle.h"

typedef enum {
    VIRTUAL_MATT,               /* intensity power times the cosine to n */
    VIRTUAL_LAMP,               /* power times L |cos| */
    VIRTUAL_GLOSSY              /* power times f* |cos| */
} VirtualKind;

typedef struct {
    V3    p, err;
    V3    n;                    /* geometric; MATT: on the side that shines */
    V3    ns;                   /* MATT: above this too; of a lamp the same as n */
    Rgb   power;
    VirtualKind kind;
    bool  two_sided;            /* MATT: both sides of n shine */
    uint32_t depth;             /* scattering events on the way to the eye: 0 on a lamp */
    uint32_t number;            /* among all as they were made: breaks ties of depth */
    const Light *lamp;          /* LAMP */
    V2    uv;                   /* LAMP */
    uint32_t vertex;            /* GLOSSY */
} VirtualLight;

typedef struct { size_t first, n; } LightRun;

typedef struct {
    const Scene *scene;         /* borrowed */
    LightSampler *by;           /* owned: by power */
    uint32_t paths, sets;       /* paths of each set */
    int   maxdepth, roulette;
    uint32_t *count[2];         /* owned; by path: lights that it leaves, and vertices of these */
    VirtualLight *light;        /* owned: set after set, each by depth */
    Vertex *vertex;             /* owned: of those that are glossy */
    LightRun *set;              /* owned */
    size_t n, nvertices;
} VirtualLights;

enum { VIRTUAL_PATHS = 1000000 };       /* most of all sets */

/* False: reported. maxdepth, roulette: as for `path`. */
bool virtuallights_init(VirtualLights *v, const Scene *s, uint32_t paths, uint32_t sets,
                        int maxdepth, int roulette);
void virtuallights_clear(VirtualLights *v);

/* Phases of units: 0 counts, 1 makes room (one unit; false: memory, reported), 2 makes lights, 3
 * puts those of each set in order. */
enum { VIRTUAL_PHASES = 4 };
uint64_t virtuallights_units(const VirtualLights *v, int phase);
bool virtuallights_run(VirtualLights *v, int phase, uint64_t unit, Tracer *t);

/* Watts per steradian that it sends the way d, unit. */
Rgb virtuallight_intensity(const VirtualLights *v, const VirtualLight *l, V3 d);

/* What it brings the eye from the vertex unless it is hidden, and the ray that tells; its geometric
 * term |cos| |cos| / d^2 is at most `bound`, unless that is 0. False: nothing. */
bool virtuallight_reaches(const VirtualLights *v, const VirtualLight *l, const Vertex *at,
                          float bound, Rgb *c, Ray *r);

/* The part that a bound leaves of light between points of such normals. */
INLINE float bound_leaves(float bound, V3 nx, V3 ny, V3 wi, float d2)
{
    float g;

    if (!(bound > 0.0f))
        return 1.0f;
    g = v_absdot(nx, wi) * v_absdot(ny, wi) / d2;
    return g > bound ? bound / g : 1.0f;
}

#endif

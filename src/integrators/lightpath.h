/* lightpath.h -- a path from the lens to a light with all its vertices at hand, so that it can be
 * moved: for Metropolis methods and for energy redistribution.
 *
 * Source      [Cline07 7.10, (7.6) to (7.11), 8.4.1; errata 7.2, 7.3, 7.10, 7.11].
 * Path        x_0 on the lens, x_1 to x_{n-1} on surfaces, x_n on a light, of n edges. At each
 *             surface it is said what happens: scattering by the smooth part of the model, or
 *             which of its delta events; paths that differ in that are different paths. So the
 *             contribution is a product, of which the radiance of the picture is the sum.
 * Colour      F of (7.9), fig. 7.20, without what is geometry alone:
 *                 colour = L_e prod s_i,  s_i = f |wi.ns|, or the weight of the delta event,
 *             for light that goes to the eye (radiance, not particles), times what media leave.
 *             Integrated over places on the picture, places on the lens, and at each smooth vertex
 *             the directions wi, it is the picture. What else F has is the change to area,
 *                 |cos_o| / d^2 at the vertex where an edge of length d from the eye's side ends,
 *             and We |cos| / d^2 in place of the first. A mutation works in a measure of its own,
 *             and its acceptance is the ratio of colours times that of a few such factors: deltas
 *             and unchanged factors are never there, see mutations.h.
 * Refraction  As the eye sees it light changes by the square of the index ratio; the Jacobian of
 *             directions across the surface is eta^2 |wi.ns| / |wo.ns|, errata 7.10.
 * Ends        A point of a shape that shines, the place of a light that has one, or a direction.
 *             L is that of LightSample: for lights of delta the irradiance, so with 1 / d^2 in it.
 * Media       absorb on the way; light that they scatter is left out.
 * Storage     Surfaces and models stand apart, so that paths share what they have in common. */
#ifndef INTEGRATORS_LIGHTPATH_H
#define INTEGRATORS_LIGHTPATH_H

#include "integrators/event.h"
#include "integrators/vertex.h"

enum { LIGHTPATH_MOST = 32 };           /* edges */
enum { EVENT_SMOOTH = 0 };              /* others: side and number of a delta event */

typedef struct {
    Vertex  *at;                /* borrowed: surface and model; its own wo means nothing */
    V3    wo, wi;               /* local: towards the eye's side, and the light's */
    V3    way;                  /* wi in the world */
    float cos_o, cos_i;         /* of both to the geometric normal, positive */
    float dist;                 /* from the vertex before, or the place on the lens */
    uint32_t event;
    float eta;                  /* of the event: index on the light's side over that before */
    Rgb   scatters;             /* s */
    Rgb   passes;               /* what media leave on the edge from the eye's side */
    uint32_t medium;            /* in which that edge ends */
} PathVertex;

typedef struct {
    const Light *light;
    Surface s;                  /* of a shape that shines */
    V3    d;                    /* to a light beyond the scene */
    LightSample to;             /* as it is seen from the vertex before */
    float cosine;               /* at a shape; else 1 */
    Rgb   passes;
    uint32_t medium;
} PathEnd;

typedef struct {
    int   edges;
    V2    pixel, lens;          /* place on the picture, and numbers of that on the lens */
    V3    eye, way;             /* that place, and the way that it looks */
    float time;
    PathVertex v[LIGHTPATH_MOST];       /* 1 .. edges-1 */
    PathEnd end;
    Rgb   colour;
} LightPath;

/* ---- growing from the eye ---- */

/* What flies to the next vertex, on either side. */
typedef struct {
    Ray   ray;
    uint32_t medium;
    Rgb   passes;
    float way;                  /* from the eye by delta events only; below 0: there were others */
} Walk;

INLINE bool path_vertex_is_smooth(const PathVertex *v) { return v->event == EVENT_SMOOTH; }
/* Of vertex i, or of the end, by light's side. */
INLINE V3 path_way(const LightPath *p, int i) { return i ? p->v[i].way : p->way; }

/* Sets eye and way by pixel, lens and time, which are there, and leaves. */
Walk path_leaves_eye(LightPath *p, const Scene *s);

/* The walk's next surface becomes vertex i, in the room. False: there is none. */
bool path_arrives(LightPath *p, int i, Walk *w, Vertex *room, Tracer *t);

/* From vertex i by that delta event; or to the world's direction d, by the smooth part. Sets what
 * the vertex says of its light's side. False: there is no such event, or no light by it. */
bool path_turns_by(LightPath *p, int i, uint32_t event, Walk *w);
bool path_turns_to(LightPath *p, int i, V3 d, Walk *w);

/* All delta events of the vertex for wo, and the names by which they are known on either side. They
 * mean that a path keeps its name when it is moved, or looked at from its other end. */
int  path_deltas(const Vertex *at, V3 wo, BsdfSample s[BSDF_DELTAS], uint32_t name[BSDF_DELTAS]);

/* The walk from vertex edges-1, or from the lens, ends on l: at the surface that it has met, or (s
 * NULL) beyond the scene. False: no light comes from there. */
bool path_ends(LightPath *p, const Light *l, const Surface *s, const Walk *w);

/* ---- growing from the light ---- */

/* The walk from the light's side meets vertex i, in the room, whose model is not made yet; what
 * media left belongs to the edge before. False: it meets nothing. */
bool path_arrives_back(LightPath *p, int i, Walk *w, Vertex *room, Tracer *t);
/* On from vertex i, towards the eye, in the world's direction d. */
void path_goes_back(LightPath *p, int i, V3 d, Walk *w);
/* Vertex 1 is shown to the lens, at *c: a place that is among these. False: something stands in
 * between, or it is elsewhere. */
bool path_reaches_lens(LightPath *p, Places where, const Walk *w, CameraSample *c, Tracer *t);

/* ---- joining ---- */

/* Vertex i, of which the eye's side is known, scatters by its smooth part towards what follows:
 * vertex i+1, which does so too and whose light's side is known, or the end. False: nothing gets
 * through, even if nothing stands between, which is left to path_is_clear. */
bool path_joins(LightPath *p, int i);
/* Whether nothing stands between vertex i and what follows. Sets what media leave, which is the
 * last thing that the colour needs. */
bool path_is_clear(LightPath *p, int i, Tracer *t);

/* Vertices first .. last have been met from the light's side: of each `at`, event, medium and
 * passes are there. Vertex 1 is as the lens shows it at c, others are joined to the smooth one
 * before. Sets all else, also of what follows. False: no light comes this way. */
bool path_turned_round(LightPath *p, int first, int last, const CameraSample *c);

/* Sets the colour from all factors. False: it is black, or no number. */
bool path_colours(LightPath *p);

/* Splats its colour, of a luminance by which it adds so much to the mean of the picture. */
void path_shows(const LightPath *p, double luminance, Tracer *t);

/* Whether it is among those of the integrator `direct`: no event but the last is smooth. */
bool path_is_direct(const LightPath *p);

/* ---- copies ---- */

/* y is x, with the same vertices: what is moved is to be replaced. */
void path_shares(LightPath *y, const LightPath *x);
/* x becomes y, of which some vertices are in rooms and others those of x: rooms used are those of x
 * now, for which its own are free. Each `at` of x is a room, whether or not the path is so long. */
void path_moves(LightPath *x, const LightPath *y, Vertex **rooms);
/* *y = *x, with all vertices in rooms. */
void path_copies(LightPath *y, const LightPath *x, Vertex *const *rooms, const Scene *s);

/* ---- in files: pathstate.c ---- */

void path_save(const LightPath *p, const Scene *s, Saving *to);
/* Into the rooms that p has, for at most so many edges. False: it does not fit. */
bool path_load(LightPath *p, int most, const Scene *s, Loading *l);

/* ---- changes of measure ---- */

/* Of light that is followed from the lamp instead of from the eye, [Veach97 5.2, 5.3]: what a
 * vertex contributes, in the sense of errata 7.10; */
INLINE double path_turn(const PathVertex *v)
{
    double change = (double)v->cos_o / v->cos_i;
    return path_vertex_is_smooth(v) ? change
                                    : change * (double)f_sqr(v->eta) * fabsf(v->wi.z / v->wo.z);
}
/* and what the lamp does: its |cos|; where it has a place only, L is I / d^2; from beyond the scene
 * areas are across the light. */
INLINE double path_ending(const LightPath *p)
{
    const LightKind *k = p->end.light->kind;
    return k->delta == DELTA_PLACE ? (double)p->end.to.dist * p->end.to.dist
           : lamp_is_shape(p->end.light) ? (double)p->end.cosine : 1.0;
}
/* and the lens, for vertex 1: from directions there to places on a picture of area 1. */
INLINE double path_lens(const LightPath *p, const Camera *camera)
{
    CameraSample c;
    return camera->kind->sample(camera, p->v[1].at->s.p, p->lens, p->time, &c)
               ? (double)c.we / c.pdf_w : 0.0;
}

/* The change of solid angle, as seen from vertex i's eye side, to area at vertex i+1 or the end. */
INLINE float path_area(const LightPath *p, int i)
{
    if (i + 1 < p->edges)
        return p->v[i + 1].cos_o / f_sqr(p->v[i + 1].dist);
    return lamp_is_shape(p->end.light) ? p->end.cosine / f_sqr(p->end.to.dist) : 1.0f;
}

#endif

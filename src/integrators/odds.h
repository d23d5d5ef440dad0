/* odds.h -- how likely the other ways of making a path are, told from one end: what a subpath keeps
 * so that the weight of any way of completing it costs the same, however long the path.
 *
 * Source      [GIRT (2.65), (3.2), (3.6), (3.7); errata, "weight recursion"], [Veach97 9.2, 10.2],
 *             [Georgiev12].
 * Techniques  A path x_0 (on a lamp) .. x_k (at the lens) is made by technique s if x_0 .. x_{s-1}
 *             came from the lamp and the others from the eye: the two ends are connected; or s = 0,
 *             the eye's path meets the lamp. It is merged at x_i if the lamp's path ended near x_i,
 *             to which the eye's came: which is as likely as technique i is, times the density of
 *             x_i seen from the lamp and eta = pi r^2 (light paths), how many end so near.
 * Weight      w_i = q_i / sum q_j, with q = p^b: b = 1 is the balance heuristic, 2 the power
 *             heuristic; 0 counts the techniques that could have made the path and takes them all
 *             alike (errata 7.9: those that can, not those that did).
 * Recursion   Neighbours differ by what happens at one vertex: p_{i-1} / p_i is (density of x_{i-1}
 *             seen from x_i) / (that seen from x_{i-2}). So with all of a light path's vertices
 *             before y known, the sum of q_j / q_s over techniques j < s is linear in what the
 *             direction chosen at y next says; the eye's side is the same, mirrored. With p> the
 *             density per solid angle of the direction taken, p< that of going back:
 *
 *                 last    of having connected to y: what the next vertex' density is to be
 *                         multiplied by, to be taken away;
 *                 early   of all connections before that, and of meeting the lamp;
 *                 merged  of all mergers before the vertex before y, over eta^b: so one path
 *                         serves any radius;
 *                 latest  of that at the vertex before y, in the same way. It is apart because the
 *                         merger next to a lamp may be left out, see `straight`.
 *
 *             at a vertex:    early' = (cos> / p>)^b ((p<)^b early + last)
 *                             merged' = (cos> p< / p>)^b (merged + latest),  last' = (1 / p>)^b,
 *                             latest' = (cos> / p>)^b, or 0 where no merging is done
 *             after a delta:  early' = cos>^b early, merged' = cos>^b (merged + latest),
 *                             last' = latest' = 0
 *             along an edge:  last *= (d^2 / cos)^b,  early, merged, latest /= cos^b
 *
 *             Cosines are to geometric normals: they make areas of solid angles.
 * Roulette    is in no density here. Weights may be any that add up to 1 for each path (errata
 *             4.11), and these are the same whoever made it. So are choices among deltas, and the
 *             index ratios that refraction has: they count as alike both ways. */
#ifndef INTEGRATORS_ODDS_H
#define INTEGRATORS_ODDS_H

#include "base/vec.h"

typedef enum { HEURISTIC_UNIFORM, HEURISTIC_BALANCE, HEURISTIC_POWER } Heuristic;

typedef struct {
    Heuristic heuristic;
    float eta;                  /* pi r^2 (light paths of a pass); 0: nothing is merged */
    bool  connects;             /* subpaths are; else they meet lamps or are merged */
    bool  first;                /* merges where the eye's first ray ends, too, */
    bool  straight;             /* and what comes straight from lamps */
} Techniques;

typedef struct { float last, early, merged, latest; } Odds;

/* x^b. */
INLINE float raised(const Techniques *q, float x)
{
    return LIKELY(q->heuristic == HEURISTIC_BALANCE) ? x
           : q->heuristic == HEURISTIC_POWER ? x * x : (float)(x > 0.0f);
}

/* Along an edge, of length^2 d2, to a surface: 1 if the edge came from beyond the scene. */
INLINE void odds_arrive(Odds *o, const Techniques *q, float d2, float cosine)
{
    float inverse = cosine > 0.0f ? raised(q, 1.0f / cosine) : 0.0f;
    o->last *= raised(q, d2) * inverse;
    o->early *= inverse;
    o->merged *= inverse;
    o->latest *= inverse;
}

/* On from a vertex; there: how the density of going on, forth, is to that of going back. merges: at
 * this vertex. */
INLINE void odds_scatter(Odds *o, const Techniques *q, float cosine, float forth, float back,
                         bool merges)
{
    float chance = raised(q, 1.0f / forth), out = raised(q, cosine) * chance;
    float in = raised(q, back);
    o->early = out * (in * o->early + o->last);
    o->merged = out * in * (o->merged + o->latest);
    o->latest = merges ? out : 0.0f;
    o->last = q->connects ? chance : 0.0f;
}

/* The same by a delta event. */
INLINE void odds_turn(Odds *o, const Techniques *q, float cosine)
{
    float out = raised(q, cosine);
    o->early *= out;
    o->merged = out * (o->merged + o->latest);
    o->latest = 0.0f;
    o->last = 0.0f;
}

/* All other techniques of a path over the one at hand, q_j / q_s added up: those that connect, and
 * those that merge, which eta^b is still to be multiplied to. */
typedef struct { float connect, merge; } Rivals;

/* Those before the vertex; back: density of going there, from the side that joins it. */
INLINE Rivals rivals_before(const Odds *o, const Techniques *q, float back)
{
    float in = raised(q, back);
    return (Rivals){ o->last + in * o->early, in * (o->merged + o->latest) };
}

/* And at the vertex itself, by merging; all times the density per area of being found, `there`. */
INLINE Rivals rivals_at(const Odds *o, const Techniques *q, float back, bool merges, float there)
{
    Rivals r = rivals_before(o, q, back);
    float scale = raised(q, there);
    return (Rivals){ scale * r.connect, scale * (r.merge + (float)merges) };
}

INLINE Rivals rivals_add(Rivals a, Rivals b)
{
    return (Rivals){ a.connect + b.connect, a.merge + b.merge };
}

/* 1 / (1 + all others). Sums without a bound times 0 are no number: then 0. */
INLINE float odds_weight(float others)
{
    float w = 1.0f / (1.0f + others);
    return w > 0.0f ? w : 0.0f;
}

/* The weight of a connection, and that of a merger. */
INLINE float rivals_connected(Rivals r, const Techniques *q, float eta)
{
    return odds_weight(eta > 0.0f ? r.connect + raised(q, eta) * r.merge        /* [GIRT (3.7)] */
                                  : r.connect);                                 /* [GIRT (2.65)] */
}
INLINE float rivals_merged(Rivals r, const Techniques *q, float eta)
{
    return odds_weight(r.merge + r.connect / raised(q, eta));                   /* [GIRT (3.7)] */
}

#endif

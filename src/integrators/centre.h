/* centre.h -- every light as one point or one direction, for methods without chance.
 *
 * Source      [Shirley91 5.2, 5.3]: the lights of the first ray tracers are points.
 * Idea        A shape that shines becomes a point lamp at its centre, with the intensity that it
 *             has from afar, I(d) = integral over its surface of L cosine: a disc sends its light
 *             forwards, a sphere all round. Lights that are points or parallel stay what they are.
 *             Lights all round have no centre and are left out: theirs is the ambient light.
 * What is off Near a lamp its light is too strong in the middle; shadows have sharp edges. A lamp
 *             whose middle is hidden (a ring about a post) is dark. */
#ifndef INTEGRATORS_CENTRE_H
#define INTEGRATORS_CENTRE_H

#include "integrators/vertex.h"

/* A flat piece of a lamp's surface, moved to its centre. */
typedef struct { Surface at; float area; } Facet;

typedef struct {
    const Light *light;         /* borrowed */
    V3       p;                 /* the centre, if it has facets */
    size_t   first, n;          /* its facets; 0: a point or a direction by itself */
} Centre;

typedef struct {
    Centre *centre;             /* owned */
    size_t  n;
    Facet  *facet;              /* owned */
    size_t  nfacets, cap_facets;
} Centres;

/* False: memory, reported. */
bool centres_init(Centres *c, const Scene *s);
void centres_clear(Centres *c);

/* Light number i (of c->n) as it is seen from a point: as of a delta light, s->L is the irradiance
 * on a surface that faces it. False: it does not shine there. */
bool centre_shines(const Centres *c, size_t i, V3 from, LightSample *s);
/* Whether that light gets to the vertex, before which there is `medium` on the light's side; *left
 * loses what media take of it. */
bool centre_arrives(const Centres *c, size_t i, const Vertex *v, const LightSample *s,
                    uint32_t medium, Tracer *t, Rgb *left);

#endif

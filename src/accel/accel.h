/* accel.h -- rays against many primitives, fast. One file a structure; accel.c has the list.
 *
 * Promise: every structure gives the answer of `brute` for every ray, bit for bit: they all call
 * the same tests of primitives, never pass over a box that could hold a hit, and settle equal t by
 * the smaller primitive number. */
#ifndef ACCEL_ACCEL_H
#define ACCEL_ACCEL_H

#include "base/kind.h"
#include "geometry/geometry.h"

#include <stddef.h>

typedef struct Accel Accel;

/* What a query did, for statistics and for tests that no loop runs away. */
typedef struct { uint64_t nodes, prims; } Steps;

/* Boxes over a tessellation: bits of a plane, 16 or 8, and most triangles of a leaf. */
typedef struct { int bits; uint32_t leaf; } RegularForm;
typedef struct Regular Regular;

typedef struct {
    KindInfo info;
    bool plain;                 /* no structure over tessellations either: a loop */

    /* Over the primitives of g, which stays borrowed and must be finished. NULL: reported. */
    Accel *(*build)(const Geometry *g, const Opts *o, int threads);

    /* The same, but may first put the triangles of each mesh into another order, which spares it a
     * list of them: primitives get other numbers, and structures that were built over g before are
     * of no use then. NULL: build(). */
    Accel *(*arrange)(Geometry *g, const Opts *o, int threads);

    /* The nearest hit with 0 < t <= r->tmax; of equal t the smaller primitive. No hit: false, *h
     * = hit_none. steps may be NULL; else counts are added. */
    bool (*nearest)(const Accel *a, const Ray *r, Hit *h, Steps *steps);

    /* True if anything lies in 0 < t <= r->tmax. May stop at the first one found. */
    bool (*blocked)(const Accel *a, const Ray *r, Steps *steps);

    /* The same for n rays at once, which a structure may interleave; NULL: a loop (the twin). */
    void (*nearest_many)(const Accel *a, const Ray *r, Hit *h, bool *hit, size_t n);
    void (*blocked_many)(const Accel *a, const Ray *r, bool *blocked, size_t n);

    /* Checks every invariant of the structure: bounds hold what is below them, each primitive is
     * reached exactly once. False: *why says which failed. */
    bool (*validate)(const Accel *a, char *why, size_t room);

    /* How boxes over tessellations are to be (see regular.h); NULL: with 16 bits, leaf = 4. */
    RegularForm (*regular)(const Opts *o);

    void (*free)(Accel *a);
} AccelKind;

struct Accel {                  /* first member of every concrete structure */
    const AccelKind *kind;
    const Geometry  *geo;       /* borrowed: outlives the structure */
    Regular **regular;          /* owned; by tessellation of geo; NULL where the kind is plain */
    size_t   bytes;             /* of the structure alone, without the geometry */
    uint64_t nodes, leaves;
    uint64_t refs;              /* primitives in leaves, if one may stand in several; else 0. No
                                 * query tests more primitives than that (or than there are). */
    int      depth;
};

extern const AccelKind *const accels[];         /* ends with NULL */
#define ACCEL_DEFAULT "wide"

/* arrange() where there is one, else build(); and build(). With the structures over tessellations,
 * which are the same for all but `brute`. NULL: reported. */
Accel *accel_build(const AccelKind *kind, Geometry *g, const Opts *o, int threads);
Accel *accel_build_as_is(const AccelKind *kind, const Geometry *g, const Opts *o, int threads);

/* Safe to call with an empty geometry. */
static inline bool accel_nearest(const Accel *a, const Ray *r, Hit *h)
{
    return a->kind->nearest(a, r, h, NULL);
}
static inline bool accel_blocked(const Accel *a, const Ray *r)
{
    return a->kind->blocked(a, r, NULL);
}
void accel_nearest_many(const Accel *a, const Ray *r, Hit *h, bool *hit, size_t n);
void accel_blocked_many(const Accel *a, const Ray *r, bool *blocked, size_t n);
void accel_free(Accel *a);                      /* NULL is allowed */
bool accel_validate(const Accel *a, char *why, size_t room);    /* kind->validate, and these */

/* For validate(): *why becomes "what at where". Returns false. */
bool accel_bad(char *why, size_t room, const char *what, size_t where);

/* For build(): n primitives are below 2^bits. False: too many, reported. */
bool accel_counts(const char *name, size_t n, int bits);

/* The surface of a hit, in the space of a's geometry, also where the hit is in an instance. */
void accel_surface(const Accel *a, const Ray *r, const Hit *h, Surface *s);

#endif

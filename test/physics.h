/* physics.h -- truth tests of light transport: small scenes made through the scene's own interface,
 * an integrator asked for radiance along given rays, and means judged by their standard error.
 *
 * The rule for every mean, with a truth from theory or a second mean to compare with:
 *   |mean - truth| <= 5.6 standard errors  (p = 2e-8: 5000 such tests fail once in 10^4 families),
 *                     and 64 roundings of a float, which a path's products may add up to;
 *   power: a relative bias of `delta` must be found surely, that is in 999 of 1000 seeds:
 *                     8.7 cv / sqrt(N) <= delta, or the test fails whatever its mean;
 *   tails: no contribution may be above 1 % of the sum, or the error is not to be trusted: failed.
 * Under --long there are 16 times the samples, and delta is a quarter of what a test declares. */
#ifndef TEST_PHYSICS_H
#define TEST_PHYSICS_H

#include "integrators/integrator.h"
#include "test/test.h"

/* ---- means ---- */

typedef struct {
    double n, mean, squares;    /* Welford: squares is the sum of squared deviations */
    double total, largest;      /* of the contributions, which may be more than n */
} Stat;

void   stat_add(Stat *s, double x);
/* A value that is itself the mean of n contributions, the largest of which is given. */
void   stat_add_block(Stat *s, double mean, double n, double largest);
double stat_error(const Stat *s);       /* standard error of the mean */
double stat_power(const Stat *s);       /* relative bias that is surely found */

/* Each records a failure of the running case, called `what`, if the rule above is broken. A truth
 * of 0 asks that every contribution was 0. */
void stat_expect(const Stat *s, double truth, double delta, const char *what);
void stat_expect_same(const Stat *a, const Stat *b, double delta, const char *what);
void stat_expect_rgb(const Stat s[3], const double truth[3], double delta, const char *what);

/* Two-sided tail of Student's distribution. */
double student_tail(double t, double dof);

/* ---- scenes ---- */

typedef struct {
    Scene *scene;               /* owned */
    Integrator *integrator;     /* owned; the one opened last */
    Opts *opts;                 /* owned: of the integrator */
    Arena arena;                /* owned: text of options */
} Lab;

/* None of these returns a failure: they end the case. */
void     lab_init(Lab *l);
void     lab_clear(Lab *l);
uint32_t lab_material(Lab *l, const char *kind, const char *options);   /* "a=1,b=1/0.5/0" */
uint32_t lab_mesh(Lab *l, Mesh *m, uint32_t material, bool flip);       /* its shape; takes m */
uint32_t lab_quad(Lab *l, V3 corner, V3 a, V3 b, uint32_t material);    /* front along a x b */
/* The same with u along a, v along b. */
uint32_t lab_screen(Lab *l, V3 corner, V3 a, V3 b, uint32_t material);
/* Zones of a sphere lie between zmin and zmax from the centre; the whole one has radius 1 times. */
uint32_t lab_sphere(Lab *l, V3 centre, float radius, uint32_t material, bool flip);
uint32_t lab_zone(Lab *l, V3 centre, float radius, float zmin, float zmax, uint32_t material,
                  bool flip);
uint32_t lab_disk(Lab *l, V3 centre, V3 normal, float radius, float inner, uint32_t material);
/* Its index among the scene's lights. t NULL: identity. */
uint32_t lab_light(Lab *l, const char *kind, const char *options, const Transform *t);
uint32_t lab_shine(Lab *l, uint32_t shape, const char *options);        /* the shape is a light */
/* A picture of the sky: f by direction, z up, at the middle of each of w x h cells. */
uint32_t lab_sky(Lab *l, uint32_t w, uint32_t h, Rgb (*f)(V3 w), const Transform *t);
uint32_t lab_sky_as(Lab *l, uint32_t w, uint32_t h, Rgb (*f)(V3 w), const Transform *t,
                    const char *options);
/* A picture of w x h pixels for lights to name: f at their middles, x to the right, y down from the
 * top, each in [0, 1]. The text is kept by l. */
const char *lab_picture(Lab *l, uint32_t w, uint32_t h, Rgb (*f)(float x, float y));
void     lab_build(Lab *l);
/* "name:key=value,..." of an integrator, or options of `path` alone. */
const IntegratorKind *lab_method(Lab *l, const char *text, Opts *o);
/* Opens the integrator of that text, closing the one before. */
void     lab_open(Lab *l, const char *method);
bool     lab_opens(Lab *l, const char *method);         /* whether it can be opened */

/* Moves and scales the points of a mesh. */
void mesh_move(Mesh *m, float scale, V3 by);
/* Parts of a closed mesh as shapes of their own: triangles [first, end). The mesh stays. */
void mesh_part(Mesh *part, const Mesh *m, uint32_t first, uint32_t end);

/* ---- measuring ---- */

/* Radiance, then its parts by length, then by strategy; red, green and blue of each. */
enum { METER_VALUES = 1 + TALLY_LENGTHS + STRATEGIES };
typedef struct { Stat value[METER_VALUES][3]; } Meter;
INLINE const Stat *meter_radiance(const Meter *m) { return m->value[0]; }
INLINE const Stat *meter_length(const Meter *m, int edges) { return m->value[1 + edges]; }
INLINE const Stat *meter_strategy(const Meter *m, Strategy s)
{
    return m->value[1 + TALLY_LENGTHS + (int)s];
}

typedef struct {
    Ray (*ray)(const void *of, Sampler *s);     /* the ray of each sample */
    const void *of;
    uint64_t n;                 /* samples; 16 times as many under --long */
    uint64_t seed;
    uint32_t run;               /* 0: independent samples; else patterns of so many by the default
                                 * sampler, each of which is one value to the Stats */
} Gauge;

void lab_measure(Lab *l, const Gauge *g, Meter *m);

/* A fixed ray, of = Ray; and rays in all directions from a point, of = V3. */
Ray ray_fixed(const void *of, Sampler *s);
Ray ray_anywhere(const void *of, Sampler *s);
/* The ray that looks at `at` from `eye`. */
Ray ray_towards(V3 eye, V3 at);

#endif

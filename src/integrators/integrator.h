/* integrator.h -- how light travels. One file a method; integrator.c has the list.
 *
 * The driver (render/) owns threads, budgets and film; an integrator offers work in up to three
 * shapes:
 *
 *   radiance   an estimate of the radiance along the ray of a camera sample: `path`;
 *   splats     light that the same call, or a unit of a phase, finds for any pixel: `light`;
 *   phases     work that comes before the camera samples, of units that may run in any order; once
 *              (visibility maps, photon maps) or anew for each pass of one sample a pixel; or that
 *              is all there is to a pass (chains).
 *
 * A pass of a method that merges light paths with eye paths, for example, has the phases 0: trace
 * light paths, and splat what they bring to the lens, 1: sort their vertices into a grid, and then
 * the camera samples, which look into the grid. A pass of chains has one phase, a unit for each
 * chain, that splats; the first pass has another before, where chains begin. Progressive photon
 * maps have the phases 0: eye paths of each tile, 1: grid of where they end, 2: photons, 3: the
 * tiles' statistics, and add to the film in the last.
 *
 * Everything random comes from the Tracer's sampler, by (seed, pixel or unit, index, decision),
 * never from the thread. */
#ifndef INTEGRATORS_INTEGRATOR_H
#define INTEGRATORS_INTEGRATOR_H

#include "image/splats.h"
#include "sampling/sampler.h"
#include "scene/scene.h"

#include <stddef.h>
#include <string.h>

typedef struct Integrator Integrator;

/* What one camera sample found, apart by path length and by strategy: for tests, and for pictures
 * of each (--aov length:3=FILE, --aov strategy:explicit=FILE). */
typedef enum {
    STRATEGY_IMPLICIT, STRATEGY_EXPLICIT, STRATEGY_LENS,
    STRATEGY_MERGE,                     /* a path of light ends near one of the eye */
    STRATEGY_CONNECT,                   /* one is joined to the other by an edge */
    STRATEGIES
} Strategy;
extern const char *const strategy_names[STRATEGIES];
enum { TALLY_LENGTHS = 17 };            /* edges 0 .. 15; the last entry holds all longer ones */
enum { TALLY_RADII = 8 };
typedef struct {
    bool by_technique;          /* is wanted, too */
    Rgb length[TALLY_LENGTHS];
    Rgb strategy[STRATEGIES];
    Rgb radius[TALLY_RADII];            /* of methods that merge by several radii at once */
    /* of methods that join two paths, by the number of vertices that came from the lamp and from
     * the eye: as it counts, and without its weight */
    struct { Rgb weighed, bare; } technique[TALLY_LENGTHS][TALLY_LENGTHS];
} Tally;

/* Before a sample. Techniques are many: they are left as they are where nobody asks for them. */
INLINE void tally_clear(Tally *t)
{
    bool wanted = t->by_technique;
    memset(t, 0, wanted ? sizeof *t : offsetof(Tally, technique));
    t->by_technique = wanted;
}

/* Where splats go. */
typedef struct {
    Film *film;
    const Filter *filter;
    uint32_t layers[TALLY_LENGTHS][STRATEGIES]; /* of the film, a bit each, for such paths */
    uint32_t bare[TALLY_LENGTHS];       /* for what is shown to the lens, without its weight */
    uint32_t radius[TALLY_RADII];       /* for the same as it counts with that radius */
} Canvas;

INLINE float canvas_pixels(const Canvas *k)             /* of the whole picture */
{
    return (float)k->film->full_w * (float)k->film->full_h;
}

/* Where places on the picture may be: all that the filters of the window's pixels look at. */
typedef struct {
    V2    lo, size;
    float pixels;               /* of the whole picture */
} Places;

INLINE Places canvas_places(const Canvas *k)
{
    float x = (float)k->filter->axis[0].radius - 0.5f, y = (float)k->filter->axis[1].radius - 0.5f;

    return (Places){ { (float)k->film->x0 - x, (float)k->film->y0 - y },
                     { (float)k->film->w + 2.0f * x, (float)k->film->h + 2.0f * y },
                     canvas_pixels(k) };
}

INLINE bool places_hold(Places w, V2 p)
{
    return p.x >= w.lo.x && p.x < w.lo.x + w.size.x && p.y >= w.lo.y && p.y < w.lo.y + w.size.y;
}

/* By numbers from 0 to 1 across. */
INLINE V2 places_at(Places w, V2 u)
{
    return (V2){ w.lo.x + u.x * w.size.x, w.lo.y + u.y * w.size.y };
}

/* Of the whole picture. */
INLINE float places_share(Places w) { return w.size.x * w.size.y / w.pixels; }

/* Splats that are kept back, till somebody knows what they count; and so is what is tallied. */
typedef struct {
    V2  place;
    Rgb c;                      /* as of tracer_splat */
    uint32_t layers;
} Splat;
typedef struct {
    Splat *splats;              /* owned */
    size_t n, cap;
    int   least;                /* paths of fewer edges are left out */
    V2    place;                /* of what is tallied, */
    float area;                 /* which counts so much there */
} SplatList;

/* A way of making paths: so many edges from the eye, so many from a lamp; between the two another,
 * unless it is the eye's path that meets the lamp. */
typedef struct { int eye, light; bool met; } Technique;
typedef struct Guide Guide;

/* What paths from both ends consist of [GIRT table 5.3]; of the others only the rays are told. */
typedef struct {
    uint64_t from_lamps, from_eye;      /* paths */
    uint64_t lamp_edges, eye_edges;     /* of theirs that ended on a surface */
    uint64_t joins, mergers;            /* rays between the two, or to the lens; pairs merged */
} PathWork;

/* One worker's tools. */
typedef struct Tracer {
    const Scene *scene;         /* borrowed */
    Sampler  sampler;
    uint64_t rays;              /* cast so far, for progress */
    PathWork work;              /* so far */
    uint64_t shots;             /* so far, whose splats' mean is the picture */
    const Canvas *canvas;       /* borrowed; NULL: there is none */
    SplatList *held;            /* borrowed; not NULL: splats go there instead */
    float    spread;            /* angle between the rays of neighbouring pixels, radians */
    Tally   *tally;             /* borrowed, or NULL: nobody wants it */
    const Technique *only;      /* borrowed; not NULL: all other paths are left out */
    uint32_t x, y;              /* the pixel of the camera sample */
    bool     kept;              /* which the film takes: then no other worker is in its tile */
    float    moment;            /* time of all rays of the pass, if these have a `moment` */
    bool     failed;            /* a unit ran out of memory, reported: the render ends */
    Guide   *guide;             /* borrowed: has learned what paths had better do, see guide.h;
                                 * NULL: nobody has */
} Tracer;

/* Takes sample `index` of pixel (x, y), adds it to the film if it shall be kept, and returns its
 * luminance, 0 for one that the film refuses. */
typedef float (*TakeSample)(void *ctx, Tracer *t, uint32_t x, uint32_t y, uint32_t index,
                            bool keep);
/* Whether whoever takes samples had better stop after this pixel: the render ends, or pauses. */
typedef bool (*IsLate)(void *ctx);

#define UNIT_DONE UINT32_MAX

/* Who takes the samples: the driver, for one worker. */
typedef struct {
    TakeSample take;
    IsLate  late;
    void   *ctx;
    Tracer *tracer;
    uint32_t *done;             /* pixels of the unit that are behind, UNIT_DONE when all are */
} Taker;

INLINE bool tracer_nearest(Tracer *t, const Ray *r, Hit *h)
{
    t->rays++;
    return scene_nearest(t->scene, r, h);
}
INLINE bool tracer_blocked(Tracer *t, const Ray *r)
{
    t->rays++;
    return scene_blocked(t->scene, r);
}
INLINE void tracer_blocked_many(Tracer *t, const Ray *r, bool *blocked, size_t n)
{
    t->rays += n;
    if (LIKELY(!t->scene->see_through))
        accel_blocked_many(t->scene->accel, r, blocked, n);
    else
        for (size_t i = 0; i < n; i++)
            blocked[i] = scene_blocked(t->scene, &r[i]);
}
/* Whether light gets along the ray, whose start is in `medium`; *c loses what media take of it. */
INLINE bool tracer_passes(Tracer *t, const Ray *r, uint32_t medium, Rgb *c)
{
    if (LIKELY(!t->scene->nmedia))
        return !tracer_blocked(t, r);
    t->rays++;
    *c = rgb_mul(*c, scene_transmittance(t->scene, r, medium));
    return !rgb_black(*c);
}
/* Lamps that shine from beyond the scene, and those that are shapes in it: others are points. */
INLINE bool lamp_is_beyond(const Light *l)
{
    return l->kind->infinite || l->kind->delta == DELTA_DIRECTION;
}
INLINE bool lamp_is_shape(const Light *l) { return !l->kind->infinite && !l->kind->delta; }

/* The ray that tells whether anything stands between the surface point and the light's. */
INLINE Ray shadow_ray(const Surface *from, const LightSample *to)
{
    Ray r;

    if (is_finite(to->dist))
        r = ray_between(from->p, from->err, from->ng, to->p, to->err, to->n, to->wi);
    else
        r = (Ray){ .o = ray_origin(from->p, from->err, from->ng, to->wi), .d = to->wi,
                   .tmax = INFINITY };
    r.time = from->time;
    return r;
}

INLINE bool tracer_makes(const Tracer *t, int eye, int light, bool met)
{
    const Technique *q = t->only;
    return LIKELY(!q) || (q->eye == eye && q->light == light && q->met == met);
}

/* Keeps back what a path of `edges` edges, found by `how`, brings to the place; where memory runs
 * out, the tracer has failed. */
void tracer_holds(Tracer *t, V2 place, int edges, Strategy how, Rgb c);
/* Puts all of a list on the canvas, times weight. */
void tracer_splat_list(Tracer *t, const SplatList *l, float weight);

INLINE uint32_t canvas_layers(const Canvas *k, int edges, Strategy how)
{
    return k->layers[edges < TALLY_LENGTHS ? edges : TALLY_LENGTHS - 1][how];
}

/* Adds a path of `edges` edges, found by `how`, to the tally. */
INLINE void tracer_tally(Tracer *t, int edges, Strategy how, Rgb c)
{
    Rgb *sum;
    if (LIKELY(!t->tally))
        return;
    sum = &t->tally->length[edges < TALLY_LENGTHS ? edges : TALLY_LENGTHS - 1];
    *sum = rgb_add(*sum, c);
    t->tally->strategy[how] = rgb_add(t->tally->strategy[how], c);
    if (t->held)
        tracer_holds(t, t->held->place, edges, how, rgb_scale(c, t->held->area));
}

/* A path of so many vertices from the lamp and from the eye brings c, times the weight. */
INLINE void tracer_technique(Tracer *t, int lamp, int eye, float weight, Rgb c)
{
    if (LIKELY(!t->tally) || !t->tally->by_technique || lamp >= TALLY_LENGTHS ||
        eye >= TALLY_LENGTHS)
        return;
    t->tally->technique[lamp][eye].weighed = rgb_add(t->tally->technique[lamp][eye].weighed,
                                                     rgb_scale(c, weight));
    t->tally->technique[lamp][eye].bare = rgb_add(t->tally->technique[lamp][eye].bare, c);
}

/* A path of `edges` edges, found by `how`, brings c to the place, in pixels: the measurement that
 * makes the mean of all pixels, divided by the path's density. */
INLINE void tracer_splat(Tracer *t, V2 place, int edges, Strategy how, Rgb c)
{
    const Canvas *k = t->canvas;

    if (!k || rgb_black(c))
        return;
    if (UNLIKELY(t->held != NULL))
        tracer_holds(t, place, edges, how, c);
    else
        film_splat(k->film, k->filter, place, canvas_layers(k, edges, how),
                   rgb_scale(c, canvas_pixels(k)));
}
/* The same into layers of the film alone that are no part of the picture. */
INLINE void tracer_splat_beside(Tracer *t, V2 place, uint32_t layers, Rgb c)
{
    const Canvas *k = t->canvas;

    if (layers && !t->held)
        film_splat(k->film, k->filter, place, layers, rgb_scale(c, canvas_pixels(k)));
}

/* What the mean of a method's pictures is, as samples and as passes go to infinity. */
typedef enum {
    UNBIASED,                   /* right at any number of samples */
    CONSISTENT,                 /* right in the limit */
    BIASED                      /* leaves something out or smooths; `misses` says what */
} Truth;
extern const char *const truth_names[3];

typedef struct {
    KindInfo info;
    Truth truth;
    const char *misses;         /* light it cannot find, or "": which scenes tests exempt */

    /* Prepares for rendering. NULL: reported. */
    Integrator *(*open)(const Scene *s, const Opts *o);
    void (*close)(Integrator *it);

    /* Whether it shows light where the scene's lights give none. NULL: no. */
    bool (*glows)(const Integrator *it);

    /* What it needs to know of the picture, whose film is there, before anything else. NULL:
     * nothing. False: reported. */
    bool (*prepare)(Integrator *it, const Film *f, uint64_t seed);

    /* Radiance arriving along the ray, one estimate. What tiles learn while samples are taken may
     * be kept: a tile of the film is one worker's at a time, and its samples have an order. NULL:
     * phases are all there is. */
    Rgb (*radiance)(const Integrator *it, const Ray *r, Tracer *t);

    /* For methods that learn from pixel to pixel: they choose the order of a pass's samples. `walk`
     * takes numbers first .. first + n - 1 of all pixels of a unit, or, if the taker is late before
     * the last, of some, and is called again for the others; no two units share a tile of the
     * film. `batch` is n of a pass, spp being what is planned in all, 0 if that is not known.
     * NULL: the driver goes from tile to tile. */
    uint32_t (*walks)(const Integrator *it, const Film *f);
    void (*walk)(Integrator *it, const Film *f, uint32_t unit, uint32_t first, uint32_t n,
                 const Taker *taker);
    uint32_t (*batch)(const Integrator *it, uint32_t first, uint32_t spp);

    /* Tracers have a canvas. Whoever splats counts shots, too. */
    bool splats;
    bool singles;               /* it can make paths by one technique alone, Tracer.only */

    /* Phases 0 .. phases-1 of units(...) units each; all units of a phase end before the next
     * begins. What a unit adds to the film must not depend on the order. They are run once, pass
     * being 0, before all camera samples; or, with `anew` or without `radiance`, in every pass. */
    int  phases;
    bool anew;                  /* a pass is one sample a pixel then */
    /* The number of the moment of which all rays of the pass are, as light from the lamps and rays
     * from the eye must be that meet on what moves. NULL: each camera sample has its own. */
    uint32_t (*moment)(const Integrator *it, uint32_t pass);
    uint64_t (*units)(Integrator *it, const Film *f, uint32_t pass, int phase);
    void (*run)(Integrator *it, Film *f, uint32_t pass, int phase, uint64_t unit, Tracer *t);
    /* After the last pass. NULL: nothing. False: reported. */
    bool (*finish)(Integrator *it, Film *f);

    /* What lasts from pass to pass beside the film, into a file and back, so that a render can go
     * on another day. NULL: nothing does. It is asked for when no unit runs, between passes or amid
     * one.
     * Usually what phases make for the camera samples of their pass is not kept: they are run again
     * after `load`, for the same pass, and what they splat then goes nowhere; so only the samples
     * may change what lasts. If `keeps_all` phases are not run again, and may; for the phase that
     * was left `units` is asked again. Without `radiance` the same holds for the last phase, the
     * only one that then splats and changes what lasts. `load` false: it does not fit; nobody has
     * reported it. */
    void (*save)(const Integrator *it, Saving *s);
    bool (*load)(Integrator *it, Loading *l);
    bool keeps_all;
    bool unkept;                /* something lasts, but cannot be kept: such a render cannot go on
                                 * another day, nor be shared */
} IntegratorKind;

/* Whether pixels may have different counts of samples, and whether these say how noisy the picture
 * is: not where a pass is one thing, or light or knowledge comes from elsewhere. */
INLINE bool integrator_adapts(const IntegratorKind *k)
{
    return k->radiance && !k->splats && !k->anew && !k->walk;
}

struct Integrator {             /* first member of every concrete one */
    const IntegratorKind *kind;
    const Scene *scene;         /* borrowed */
    bool failed;                /* set by units(), or by the only unit of a phase, that could
                                 * not be done, and reported it: the render fails */
};

/* Options that most methods have; `first`: scattering event. */
#define MAXDEPTH_OPTION                                                        \
    { .key = "maxdepth", .type = OPT_INT, .num = 9, .lo = 0, .hi = 100000,     \
      .help = "most scattering events of a path; 0 shows lights only" }
#define ROULETTE_OPTION(first)                                                 \
    { .key = "roulette", .type = OPT_INT, .num = first, .lo = 1, .hi = 100000, .also = "rrdepth", \
      .help = "first scattering event after which a path may end by chance" }

extern const IntegratorKind *const integrators[];       /* ends with NULL */
#define INTEGRATOR_DEFAULT "path"

/* By options of its own table. NULL: reported. */
Integrator *integrator_open(const IntegratorKind *k, const Scene *s, const Opts *o);
/* For methods made of others: with what both tables have, by name. NULL: reported. */
Integrator *integrator_open_sharing(const IntegratorKind *k, const Scene *s, const Opts *of);
/* Of a part that a method may lack, NULL: then nothing, and black. */
void integrator_close(Integrator *it);
INLINE Rgb integrator_radiance(const Integrator *it, const Ray *r, Tracer *t)
{
    return it ? it->kind->radiance(it, r, t) : rgb_all(0.0f);
}

/* For methods that leave out the light that media scatter: says so if there is such a medium.
 * False: warnings are fatal. */
bool warn_of_scattering(const Scene *s, const char *method);

#endif

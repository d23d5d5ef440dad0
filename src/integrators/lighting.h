/* lighting.h -- the light that a point scatters towards the viewer, having come straight from a
 * light: what the strategies of `direct`, and `path` with strategy=ris, are made of.
 *
 * Source      [Cline07 4.1 to 4.4]. A Turn is where light scatters, on a surface or in a medium. A
 *             Candidate is a direction in which light may come, with all that it would add but
 *             for what stands in between. It is found by asking a light, or by the turn's own
 *             scattering; each carries its weight against the other way.
 * Measures    Densities are per solid angle, and times the number of samples drawn by them: n p in
 *             [Veach97 9.2]. So candidates are simply added up.
 * Delta       Scattering without extent (mirrors) is nobody's business here: the caller follows it.
 *             Delta lights can only be asked, with weight 1. */
#ifndef INTEGRATORS_LIGHTING_H
#define INTEGRATORS_LIGHTING_H

#include "integrators/vertex.h"
#include "lightsampling/lightsampler.h"
#include "scene/subset.h"

typedef struct {
    const Scene  *scene;        /* borrowed */
    LightSampler *lights;       /* owned */
    Subset        shining;      /* owned: the shapes that do */
    bool power;                 /* power heuristic; else balance */
    bool bright;                /* lights may be asked for what rises above their even light */
    bool beside;                /* and are, as the surface's samples find the rest */
    bool all;                   /* every light is asked: none is chosen */
    bool directions;            /* samples are directions, not points of lights */
    bool tentative;             /* rays are cast later: directions are judged by the first lamp
                                 * there, as if there were nothing else */
} Lighting;

/* By the options `lightsampler`, `heuristic` and `sky`. False: reported. */
bool lighting_init(Lighting *it, const Scene *s, const Opts *o, bool tentative, bool directions);
/* By names, not by options. */
bool lighting_init_as(Lighting *it, const Scene *s, const char *lightsampler, bool power,
                      bool bright, bool tentative, bool directions);
/* How many samples a turn has, before the first: see light_sample. */
void lighting_shares(Lighting *it, int by_light, int by_scattering);
void lighting_clear(Lighting *it);
/* Warns that the strategy cannot find delta lights, if there are any. False: warnings are fatal. */
bool lighting_warn_of_deltas(const Scene *s, const char *strategy);

#define LIGHTING_HEURISTIC                                                     \
    { .key = "heuristic", .type = OPT_CHOICE, .str = "power", .choices = "power balance", \
      .help = "weights of paths that both ways can make" }
#define LIGHTING_SKY                                                           \
    { .key = "sky", .type = OPT_CHOICE, .str = "bright", .choices = "bright all", \
      .help = "skies, asked beside as many directions by the surface: for what rises above the " \
              "even light that those find, or for all" }
#define LIGHTING_LIGHTSAMPLER                                                  \
    { .key = "lightsampler", .type = OPT_CHOICE, .str = LIGHTSAMPLER_DEFAULT,  \
      .choices = "auto power uniform contribution", .also = "lightsamplestrategy",  \
      .help = "how a light is chosen; auto: by contribution if there are 2 to 64, else by power" }

/* Weight of a sample with density n p = own > 0 against other ways with n p = other, which may be
 * infinite: the weight is 0 then. */
INLINE float mis_weight(bool power, float own, float other)
{
    float r = other / own;
    return 1.0f / (1.0f + (power ? r * r : r));                 /* [Veach97 9.2.2, 9.2.4] */
}

/* ---- where light scatters ---- */

typedef struct {
    const Vertex *v;            /* borrowed; NULL: in a medium */
    V3    p, up;                /* the place; as light samplers want it */
    V3    d;                    /* of the ray that came here */
    float g;                    /* of the medium's phase function */
    float time;
    uint32_t medium;            /* that the ray came through */
    int   at;                   /* number of its decisions */
    Rgb   to_eye;               /* what of its light gets there: tallies take that of candidates */
} Turn;

/* All of it gets to the eye, unless the caller says otherwise. */
Turn turn_on(const Vertex *v, V3 d, uint32_t medium, int at);
Turn turn_within(const Scene *s, V3 p, V3 d, float time, uint32_t medium, int at);

/* f |cos|, and the density with which turn_sample takes wi (NULL: not wanted). False: nothing. */
bool turn_f_cos(const Turn *u, V3 wi, Rgb *f_cos, float *pdf_w);
/* False: absorbed. s->pdf_w is 0 for delta events. */
bool turn_sample(const Turn *u, float lobe, V2 point, BsdfSample *s);
Ray  turn_ray(const Turn *u, V3 wi);
uint32_t turn_medium(const Turn *u, V3 wi);             /* that the ray starts in */

/* ---- numbers for several samples of one turn ----
 *
 * One decision of the sampler is asked for each turn; sample i takes its numbers a step further
 * round, by the powers of the root of x^4 = x + 1: any run of them is spread evenly over the cube
 * [Roberts18]. Each by itself is as the sampler made it, so uniform. */

typedef struct { float choice; V2 point; } Draw;
Draw draw_first(Tracer *t, const Turn *u, DecisionKind choice, DecisionKind point);
Draw draw_number(const Draw *first, uint32_t i);

/* ---- candidates ---- */

typedef struct {
    Rgb  c;                     /* weight f |cos| L / (n p) */
    Ray  ray;                   /* which nothing may stop */
    uint32_t medium;            /* that it starts in */
    bool known;                 /* the ray has been cast: c is what it adds */
    Strategy how;
} Candidate;

/* n_light, n_scatter: samples that are drawn either way. False: it adds nothing. */
typedef bool CandidateBy(const Lighting *it, const Turn *u, const Draw *draw, float n_light,
                         float n_scatter, Tracer *t, Candidate *c);
CandidateBy candidate_by_light, candidate_by_scattering;
/* The same of a light that was chosen with probability pmf. */
bool candidate_of_light(const Lighting *it, const Turn *u, const Light *l, float pmf, V2 point,
                        float n_light, float n_scatter, Tracer *t, Candidate *c);
/* What comes along wi, a direction of density n p = own, by a cast ray; alone, or weighed against
 * n_light samples of lights. */
bool candidate_along(const Lighting *it, const Turn *u, V3 wi, Rgb f_cos, float own, float n_light,
                     Tracer *t, Candidate *c);

/* The same of lights beyond the scene alone. */
bool candidate_beyond(const Lighting *it, const Turn *u, V3 wi, Rgb f_cos, float own,
                      float n_light, Tracer *t, Candidate *c);

/* The light of a sample, whose L is over its density already, taken own times. */
bool candidate_seen(const Turn *u, const LightSample *ls, float own, Candidate *c);

/* What it adds: casts the ray, unless that is done. Tallies so much of it as gets to the eye. */
Rgb candidate_light(Candidate *c, const Turn *u, Tracer *t);

/* ---- resampling [Cline07 4.4.4], errata 4.1 ---- */

enum { TENTATIVE_MOST = 256 };
typedef struct {
    int by_light, by_scattering;        /* tentative samples: M in all, at most TENTATIVE_MOST */
    int kept;                           /* N */
} Resampling;
/* Shares M tentative samples out: at least one by scattering, and one by light, unless the share
 * of lights is 1 or 0. */
Resampling resampling_of(int tentative, int kept, float light_share);

/* The estimate from N of M candidates. */
Rgb resample(const Lighting *it, const Resampling *r, const Turn *u, Tracer *t);
/* One of the M, and in it the whole estimate, for a caller that casts rays later. */
bool resample_one(const Lighting *it, const Resampling *r, const Turn *u, Tracer *t, Candidate *c);

#endif

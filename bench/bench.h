/* bench.h -- what the benchmarks share. */
#ifndef BENCH_BENCH_H
#define BENCH_BENCH_H

#include "base/clock.h"
#include "base/statistics.h"
#include "base/work.h"
#include "render/cast.h"
#include "render/render.h"

void bench_load(void);          /* reading and building a million triangles */
void bench_rays(void);          /* every accelerator over one mesh, by kind of ray */
void bench_paths(void);         /* paths a CPU-second on the Cornell boxes */
void bench_error(void);         /* error after 20 CPU-seconds, where a reference is at hand */
void bench_memory(void);        /* table 3.1 of the document */
void bench_speed(void);         /* table 3.2 */
void bench_arity(void);         /* sections 3.3.1 and 3.4.3 */
void bench_adaptive(void);      /* figure 5.9 of [Cline07]: samples alike and where wanted */
/* The same figure for one integrator: all pixels alike, variable, and biased re-rendering. */
void bench_variable(const char *scene, const char *integrator);
void bench_direct(void);        /* figure 4.10 of the document, many lights, equal time */
void bench_cuts(void);          /* figures 4, 5, 7 and 8 of [Wang09] */
void bench_lamps(void);         /* fixed lights for a sky; lamps by area or solid angle */
void bench_bias(void);          /* what says that it is biased: by how much */
void bench_bidirectional(void); /* paths from both ends, after equal time */
void bench_bidirectional_rooms(void);   /* tables 5.6 to 5.8 of [GIRT] */
void bench_bidirectional_pass(void);    /* table 5.3: what a pass takes */
void bench_photons(void);       /* a million photons; neighbours; passes of sppm */
void bench_indirect(void);      /* caches and photons against paths, after equal time */
void bench_methods(void);       /* the three spheres by every method, on one sheet */
void bench_twostage(void);      /* chapter 5: figure 5.8, table 5.1 */
void bench_twostage_cost(void); /* what partitions cost beside the rays that they serve */
void bench_triple(void);        /* figures 6.7 and 6.8 of the document */
void bench_zoneplate(void);     /* figure 5.1 of [Shirley91], for every filter */
void bench_copyimage(void);     /* figures 7.22 and 7.23: a picture copied by Metropolis sampling */
void bench_pssmlt(void);        /* chains of samples against samples alone */
void bench_denoise(void);       /* noise filters: error at 16 samples, pictures side by side */
void bench_jitter(void);        /* section 5.4.1 of [Shirley91]: uncorrelated jittering */
void bench_patterns(void);      /* section 4.5: point sets, discrepancy, Mitchell's slopes */
void bench_moves_speed(void);   /* mutations a CPU-second */
void bench_moves_error(void);   /* chains of paths against the peers */
void bench_moves_narrow(void);  /* against path, where light comes by narrow ways */
void bench_moves_figures(void); /* figures 7.29, 8.10, 8.11, 8.13 to 8.15 of the document */
void bench_moves_strata(void);  /* figure 8.12: how even few samples are */
void bench_moves_curves(void);  /* figure 8.15: error over time, as text and SVG */
void bench_swarm_table(void);   /* table 9.2 of [Cline07]: what learned maps gain */
void bench_swarm_lens(void);    /* how many samples the lens map stands for */
void bench_swarm_large(void);   /* figures 9.11 to 9.14 */
void bench_swarm_cost(void);    /* what maps cost a pixel */
void bench_view(void);          /* how soon the viewer answers to a hand */
void bench_samplers(void);      /* which sampler wins, scene by scene */

/* Renders a scene file as the request says, its seed too: the picture, or the first extra picture
 * that is asked for. im may be NULL. False: it said why. */
bool bench_picture(const char *scene, const RenderRequest *asked, Image *im, RenderReport *report);
/* The same of a text of the scene language, whose name is for messages and for the files that it
 * names; NULL: of the file of that name. */
bool bench_text_picture(const char *name, const char *text, const RenderRequest *asked, Image *im,
                        RenderReport *report);

/* The same for a scene of scenes/ with spp samples, side x side pixels or, if that is 0, as many as
 * it says; integrator and sampler NULL: those that it names. */
bool bench_render(const char *scene, const char *integrator, const char *sampler, uint32_t side,
                  uint32_t spp, int threads, uint64_t seed, Image *im, RenderReport *report);

/* relMSE without the noise of the references: for two independent ones r and q, the mean of
 * (a - r)(a - q) / (r^2 + 0.01) has the expectation that (a - truth)^2 would give. */
double paired_relmse(const Image *a, const Image *r, const Image *q);

/* Pictures in cells of w by h, as a file. False: reported. */
bool sheet_of(const Image *im, uint32_t n, uint32_t columns, uint32_t w, uint32_t h,
              const char *file);
/* Puts a picture, made smaller, into the middle of a place of w x h pixels of another. */
void sheet_paste(Image *all, const Image *im, uint32_t left, uint32_t top, uint32_t w, uint32_t h);
/* COLUMNS WIDTH HEIGHT OUT IN...: a contact sheet. The exit status. */
int sheet(int argc, char **argv);

/* The rays of table 3.2 for a scene, with the answers of the default structure. False: reported. */
bool primary_rays(CastScene *c, RaySet *primary);

/* What a structure costs to cast them. */
typedef struct {
    double seconds, boxes, tests;       /* of all; of nodes and of triangles, a ray */
    uint64_t nodes;
    size_t bytes;
} PrimaryCost;
bool cast_primary(CastScene *c, const char *config, const RaySet *primary, PrimaryCost *cost);

#endif

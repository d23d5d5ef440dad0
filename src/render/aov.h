/* aov.h -- extra pictures of one render: what the eye ray meets first, the light apart by path
 * length and by strategy, and how sure it is. See aov.c. */
#ifndef RENDER_AOV_H
#define RENDER_AOV_H

#include "integrators/integrator.h"

typedef enum {
    AOV_NORMAL, AOV_GEOMETRIC, AOV_DEPTH, AOV_POSITION, AOV_ALBEDO, AOV_PRIMITIVE, AOV_MATERIAL,
    AOV_EMISSION, AOV_DIRECT, AOV_INDIRECT, AOV_LENGTH, AOV_STRATEGY, AOV_TECHNIQUE,
    AOV_UNWEIGHTED, AOV_RADIUS, AOV_EDGES, AOV_VARIANCE, AOV_SAMPLES,
    AOV_PICTURE = -1                    /* none of them: the picture itself */
} AovKind;
typedef struct {
    AovKind kind;
    int     which;              /* LENGTH: edges; STRATEGY, RADIUS: which; VARIANCE: of which
                                 * AovKind; TECHNIQUE, UNWEIGHTED: S TALLY_LENGTHS + T */
    int     of;                 /* VARIANCE: of which layer of the film */
    const char *file;           /* borrowed; NULL: nobody wants it for itself */
} Aov;
typedef struct {
    KindInfo info;
    AovKind  kind;
    const char *channels;       /* letters, of a layer of a file */
} AovInfo;
extern const AovInfo *const aovs[];                     /* ends with NULL */

/* From "NAME=FILE", as "depth=FILE", "length:N=FILE". `text` is borrowed for the file's name.
 * False: usage error reported. */
bool aov_parse(Aov *a, const char *text);
enum { AOV_NAME = 64 };
/* What it is called as a layer of a file ("length.2"), in name, and what its channels are there. */
const char *aov_layer(const Aov *a, char *name, size_t room);
const char *aov_channels(const Aov *a);

/* A camera sample as they see it. */
typedef struct {
    Ray   ray, middle;          /* middle: through that of pixel and lens */
    float weight;               /* of the pixel filter */
    bool  first;                /* of the pixel, on the film */
} AovSample;
bool aov_needs_tally(const Aov *a, int n);
bool aov_needs_techniques(const Aov *a, int n);
/* Which layers of the film, 1 + k for aov k, take splats of which paths; layer 0 takes all. */
void aov_layers(const Aov *a, int n, Canvas *c);
/* Values of the picture, values[0], which is given, and n more, times the sample's weight. */
void aov_values(const Aov *a, int n, const AovSample *s, Tracer *t, Rgb *values);
/* Picture k of a film: what its layer 1 + k stands for. */
void aov_picture(const Aov *a, const Film *f, int k, Image *im);
/* Turns a picture into what a display format can show (normals to colours, depths to greys). */
void aov_display(const Aov *a, Image *im);

#endif

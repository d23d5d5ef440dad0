/* panorama.h -- pictures whose places are directions: maps of the sky, light probes, the beam of a
 * lamp or of a projector.
 *
 * Each mapping is a bijection of the unit square (or of a disc in it) and directions, in the frame
 * of the light, with z up. x of a place runs to the right, y down from the top row.
 *
 *   latlong     x = phi / 2 pi, phi = atan2(dy, dx); y = theta / pi from z     [Cline07 5.2.1]
 *   octahedral  the square folded to a sphere, areas kept: the upper half within the diamond of
 *               its edges' middles, z in the middle                            [Clarberg08]
 *   mirrorball  the photograph of a small mirror ball by a far camera: the angle between a
 *               direction and the way to the camera is 2 asin(r)               [Debevec98]
 *   angular     as mirrorball, but the angle is pi r                           [Debevec98]
 *   window      a plane before the light: dx / dz from -half_x to half_x, dy / dz from -half_y to
 *               half_y; here z is the middle, not up                           [PBRT4 12.2.2]
 *
 * r is the distance from the middle, 1 at the edges of the square. The camera of both balls stands
 * at -x, looks along +x, and its upright is z: so right in the picture is +y. Hence both middles
 * are where latlong has its own; seen from the ball, left and right change sides. That is what a
 * photograph of a ball shows (test/test_probes.c takes one and lights by it), and what [Debevec98]
 * says, who stands with his camera in the middle of his probes: right-handed, the camera at +z,
 * (u, v) = r (x, y) and pi r = acos z; the world of the scene language is left-handed. Some tools
 * write angular maps of the world as it is seen from the middle, not mirrored: `Scale 1 -1 1`
 * before the light turns those over.
 *
 * jacobian = d omega / d place: latlong 2 pi^2 sin(theta) [errata 5.1]; octahedral 4 pi;
 * mirrorball 16; angular 4 pi sin(pi r) / r; window 4 half_x half_y cos^3(angle to z). It is 0
 * where the picture shows nothing: beyond the disc, beside the window. */
#ifndef SCENE_PANORAMA_H
#define SCENE_PANORAMA_H

#include "sampling/table.h"
#include "scene/mediancut.h"
#include "scene/scene.h"

typedef enum {
    MAPPING_LATLONG, MAPPING_OCTAHEDRAL, MAPPING_ANGULAR, MAPPING_MIRRORBALL, MAPPING_WINDOW
} MappingKind;
typedef struct { MappingKind kind; float half_x, half_y; } Mapping;

V3 mapping_direction(const Mapping *m, V2 place, float *jacobian);
/* For directions that the picture does not show: some place, and jacobian 0. */
V2 mapping_place(const Mapping *m, V3 d, float *jacobian);
double mapping_solid_angle(const Mapping *m);           /* of all that the picture shows */
/* Of the rectangle between z and (x, y, 1): a corner of the window's plane. */
double mapping_corner(double x, double y);

/* Whether a light is written as version 3 of the scene language has it: its file is a `mapname`. */
bool mapping_is_v3(const Opts *o);
/* By the options `mapping` and `filename` of a light. auto: what the file calls mapname is latlong,
 * as version 3 of the scene language has it, and so is what is not square; a square is octahedral,
 * as version 4 has it. */
Mapping mapping_option(const Opts *o, const Image *image);
#define MAPPING_OPTION(what)                                                   \
    { .key = "mapping", .type = OPT_CHOICE, .str = "auto",                     \
      .choices = "auto latlong octahedral angular mirrorball", .help = what }

/* A picture, looked up by cell (not between cells: so its density is above 0 wherever it is, see
 * errata 5.3), and sampled by luminance times solid angle. */
typedef enum { PANORAMA_CDF, PANORAMA_ALIAS, PANORAMA_MEDIANCUT, PANORAMA_FIXED } PanoramaWay;

typedef struct {
    Mapping mapping;
    PanoramaWay way;            /* of sampling: by table; by alias, or by regions, if there are */
    AliasTable alias;           /* owned */
    MedianCut  cut;             /* owned */
    Rgb       *region;          /* owned; of PANORAMA_FIXED: light of each over its area */
    const Image *image;         /* borrowed; NULL: white, and the picture is one cell */
    Table2 table;               /* owned */
    Table2 bright;              /* owned; empty, or the same of what is above an even level */
    Rgb    mean;                /* over the solid angle */
    V3     moment;              /* mean of luminance times direction */
} Panorama;

bool  panorama_init(Panorama *p, const Image *image, Mapping m);        /* false: memory */
/* Makes what another way of sampling than by the running sums of `table` wants. The alias method
 * has the same density; that of regions is even within each; and PANORAMA_FIXED gives only their
 * middles, with the light of the whole region: biased. False: memory. */
bool  panorama_set_way(Panorama *p, PanoramaWay way, int cuts);
/* Makes the second table, for samples that stand beside as many directions by the surface: the even
 * light of the picture is found by those, so these are better spent on what rises above it
 * [Karlik19]. panorama.c has the level. Something else may shine before the picture, as the sun
 * does, of this luminance from this solid angle: *share is its part of what rises (NULL: there is
 * none). False: memory. */
bool  panorama_set_bright(Panorama *p, double lum, double angle, float *share);
void  panorama_clear(Panorama *p);
Rgb   panorama_at(const Panorama *p, V3 d);
float panorama_pdf_w(const Panorama *p, V3 d);
bool  panorama_sample(const Panorama *p, V2 u, V3 *d, float *pdf_w, Rgb *value);
/* The same by the second table, if it was made: directions of little light have density 0. */
float panorama_bright_pdf_w(const Panorama *p, V3 d);
bool  panorama_bright_sample(const Panorama *p, V2 u, V3 *d, float *pdf_w, Rgb *value);
/* The numbers by which either gives the direction, but for rounding, where running sums are
 * inverted. */
V2    panorama_numbers(const Panorama *p, bool bright, V3 d);
/* A guess at the irradiance on a surface that looks along n, by luminance; n 0: from all round. The
 * first two bands of spherical harmonics: pi mean + 2 pi moment.n [Ramamoorthi01], but at least a
 * twentieth of what a uniform picture gave. */
float panorama_estimate(const Panorama *p, V3 n);
float uniform_estimate(float lum, V3 n);
/* Integral of luminance times max(0, z): what falls on a surface that faces z. */
double panorama_upward(const Panorama *p);

#endif

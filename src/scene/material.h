/* material.h -- a BSDF model, and where its parameters come from: constants, textures, bumps. */
#ifndef SCENE_MATERIAL_H
#define SCENE_MATERIAL_H

#include "bsdf/bsdf.h"
#include "scene/texture.h"

typedef struct Material {
    const BsdfKind *kind;
    const char *name;                           /* borrowed from the scene's arena; "" if none */
    Rgb value[BSDF_OPTIONS];                    /* by option of the kind */
    const Texture *texture[BSDF_OPTIONS];       /* or NULL: the value */
    int  nvalues;
    bool textured;                              /* any texture that is not NULL */
    const Texture *opacity;                     /* NULL: 1; where it is 0, rays pass */
    const Texture *bump;                        /* NULL: none; height along the shading normal */
    const Texture *normals;                     /* NULL: none; a picture of them, material.c */
    float slope;                                /* factor of their tilt, */
    bool  mirrors;                              /* in a frame whose second tangent follows v */
    void *data;                                 /* what the kind's load() made, or NULL */
    bool borrows;                               /* data is another material's; else it is owned */
    /* Of a mix: materials added before this one. Where they let rays pass, its opacity is their
     * mean by `amount`, and of what it stops each has the part that it stopped. */
    uint32_t part[2];
    const struct Material *mixed[2];            /* the same, borrowed; set by scene_build */
    bool tangent;                               /* set by scene_build: the frame follows dpdu, */
    bool looks_at_uv;                           /* and uv and its derivatives matter */
} Material;

/* Constants from o, and what the model loads from files (NULL: no names of files are in o). False:
 * reported. Before scene_add_material has taken it over, its owner clears it. */
bool material_init(Material *m, const BsdfKind *kind, const Opts *o, const BsdfFiles *files);
void material_clear(Material *m);
/* How many models the material is made of at a point: at most BSDF_PARTS may be. */
int  material_size(const Material *all, uint32_t index);
/* Fills in what scene_build sets. Those before it have been settled. */
void material_settle(Material *all, uint32_t index);
/* Whether it may scatter light by delta events. After scene_build. */
bool material_glints(const Material *m);
/* The model at a point, in *room, which is returned. */
const Bsdf *material_bsdf(const Material *m, const Surface *s, BsdfRoom *room);
/* The local frame in which the model's directions are given: about the shading normal, which a bump
 * map or a normal map turns. */
Frame material_frame_bumped(const Material *m, const Surface *s);
static inline Frame material_frame(const Material *m, const Surface *s)
{
    if (UNLIKELY(m->bump || m->normals))
        return material_frame_bumped(m, s);
    return m->tangent ? frame_along(s->ns, s->dpdu) : frame_about(s->ns);
}

#endif

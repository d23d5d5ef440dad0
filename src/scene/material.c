/* material.c -- a BSDF model and where its parameters come from. See scene.h. */
#include "scene/scene.h"

#include <string.h>

void material_init(Material *m, const BsdfKind *kind, const Opts *o)
{
    memset(m, 0, sizeof *m);
    m->kind = kind;
    m->name = "";
    for (int i = 0; kind->info.options && kind->info.options[i].key; i++) {
        const OptValue *v = &o->value[i];
        m->value[i] = kind->info.options[i].type == OPT_RGB ? v->rgb : rgb_all((float)v->num);
        m->nvalues = i + 1;
    }
}

const Bsdf *material_bsdf(const Material *m, const Surface *s, BsdfRoom *room)
{
    Rgb value[OPT_MAX];
    Bsdf *b = &room->b[0];

    b->kind = m->kind;
    if (LIKELY(!m->textured)) {
        m->kind->setup(b, m->value, m->data);
        return b;
    }
    for (int i = 0; i < m->nvalues; i++)
        value[i] = m->texture[i] ? texture_eval(m->texture[i], s) : m->value[i];
    m->kind->setup(b, value, m->data);
    return b;
}

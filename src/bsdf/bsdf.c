/* bsdf.c -- the list of models. See bsdf.h. */
#include "bsdf/bsdf.h"

#define BSDFS(X)                                                               \
    X(diffuse) X(orennayar)             /* matt */                             \
    X(diffusetransmission)              /* and light through it */             \
    X(phong)                            /* matt, with a lobe */                \
    X(mirror) X(dielectric) X(thindielectric) X(conductor)                     \
    X(coateddiffuse) X(coatedconductor) /* a dielectric over another */        \
    X(ashikhminshirley) X(ward) X(blinn) X(lafortune)   /* lobes */            \
    X(measured)                                                                \
    X(mix)                              /* of two others */
#define DECLARE(name) extern const BsdfKind bsdf_##name;
#define ENTRY(name) &bsdf_##name,
BSDFS(DECLARE)
const BsdfKind *const bsdfs[] = { BSDFS(ENTRY) NULL };

Rgb bsdf_eval_none(const Bsdf *b, V3 wo, V3 wi, bool importance)
{
    (void)b, (void)wo, (void)wi, (void)importance;
    return rgb_all(0.0f);
}

float bsdf_pdf_none(const Bsdf *b, V3 wo, V3 wi)
{
    (void)b, (void)wo, (void)wi;
    return 0.0f;
}

int bsdf_matt_lobe_peaks(const Bsdf *b, V3 wo, V3 peak[16])
{
    (void)b;
    peak[0] = normal_z(wo);
    peak[1] = mirror_z(wo);
    return 2;
}

/* bsdf.c -- the list of models. See bsdf.h. */
#include "bsdf/bsdf.h"

extern const BsdfKind bsdf_orennayar, bsdf_diffusetransmission, bsdf_phong,
                      bsdf_mirror, bsdf_dielectric, bsdf_thindielectric, bsdf_conductor,
                      bsdf_coateddiffuse, bsdf_coatedconductor, bsdf_ashikhminshirley, bsdf_ward,
                      bsdf_blinn, bsdf_lafortune, bsdf_measured;

const BsdfKind *const bsdfs[] = {
    &bsdf_diffuse, &bsdf_orennayar, &bsdf_diffusetransmission, &bsdf_phong, &bsdf_mirror,
    &bsdf_dielectric, &bsdf_thindielectric, &bsdf_conductor, &bsdf_coateddiffuse,
    &bsdf_coatedconductor, &bsdf_ashikhminshirley, &bsdf_ward, &bsdf_blinn, &bsdf_lafortune,
    &bsdf_measured, &bsdf_mix, NULL
};

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

/* kindsets.c -- the code of `kindsets.h`. */
#include "cli/kindsets.h"

#include "image/denoise.h"
#include "lightsampling/lightsampler.h"
#include "render/render.h"
#include "scenefile/scenefile.h"

#include <string.h>

const KindSet kind_sets[KIND_SETS] = {
    { "integrators", "--integrator --with --reference-with", integrators },
    { "accelerators", "--accel", accels },
    { "samplers", "--sampler", samplers },
    { "materials", "", bsdfs },
    { "lights", "", lights },
    { "lightsamplers", "", lightsamplers },
    { "media", "", medium_kinds },
    { "shapes", "", shape_readers },
    { "cameras", "", cameras },
    { "filters", "--filter", filters },
    { "adaptives", "--adaptive", adaptives },
    { "aovs", "", aovs },
    { "formats", "", image_formats },
    { "tonemaps", "--tonemap", tonemaps },
    { "meters", "--auto-exposure", meters },
    { "denoisers", "--denoise", denoisers },
};

const KindSet *kind_set_of(const char *option)
{
    size_t n = strlen(option);

    for (int s = 0; s < KIND_SETS; s++)
        for (const char *p = kind_sets[s].options; (p = strstr(p, option)) != NULL; p += n)
            if ((p == kind_sets[s].options || p[-1] == ' ') && (p[n] == ' ' || !p[n]))
                return &kind_sets[s];
    return NULL;
}

/* direct_uniform.c -- direct light by directions all alike: over the hemisphere that the viewer
 * sees, or the sphere where light may come from both sides.
 *
 * Source: [Cline07 4.3, (4.5), fig. 4.4]. The yardstick that all importance sampling is to beat. */
#include "integrators/direct.h"
#include "sampling/warp.h"

static Rgb light(const Direct *it, const Turn *u, Tracer *t)
{
    bool sphere = v_len2(u->up) == 0.0f;
    float own = (float)it->bsdfsamples * (sphere ? warp_sphere_pdf() : warp_hemisphere_pdf());
    Draw draw, first = draw_first(t, u, DECIDE_LOBE, DECIDE_DIRECTION);
    Frame up = frame_about(sphere ? v3(0, 0, 1) : u->up);
    Rgb sum = rgb_all(0.0f), f_cos;
    Candidate c;

    for (int i = 0; i < it->bsdfsamples; i++) {
        V3 wi;
        draw = draw_number(&first, (uint32_t)i);
        wi = v_unit(frame_out(&up, sphere ? warp_sphere(draw.point) : warp_hemisphere(draw.point)));
        if (turn_f_cos(u, wi, &f_cos, NULL) &&
            candidate_along(&it->lighting, u, wi, f_cos, own, 0.0f, t, &c))
            sum = rgb_add(sum, candidate_light(&c, u, t));
    }
    return sum;
}

const DirectStrategy direct_uniform = {
    .name = "uniform", .light = light
};

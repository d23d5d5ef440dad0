/* own.c -- the policy `own`: a pixel stops when its own samples say that its error is low enough.
 *
 * Source      The usual rule of renderers; [Kirk91] tells what is wrong with it.
 * Rule        After min, 2 min, 4 min ... samples: on with those whose standard error, from the
 *             spread of their samples, is above X times the mean of the picture.
 * Truth       Biased: a pixel that has not met its rare bright samples yet sees no spread, stops,
 *             and stays too dark; one that has met them goes on. With 2 % of the samples 50, the
 *             others 0.5, and X = 0.5, the mean comes out 48 % low. The less X, the less. */
#include "render/adaptive.h"

static bool start(Adaptive *a)
{
    return a->error > 0 ||
           err_usage("--adaptive own stops pixels at an error; expected --error X");
}

static bool plan(Adaptive *a)
{
    double mean, limit;
    bool more = false;

    if (!a->step++) {
        adaptive_want(a, a->least > 2 ? a->least : 2);
        return true;
    }
    mean = adaptive_mean(a);
    limit = a->error * mean * (a->error * mean);
    for (uint32_t i = 0; i < a->n; i++) {
        Seen *s = &a->seen[i];
        if (s->taken >= a->most || s->taken < s->want || seen_variance(s) / s->taken <= limit)
            continue;
        s->want = s->taken < a->most / 2 ? s->taken * 2 : a->most;
        more = true;
    }
    return more;
}

static const OptDef options[] = { ADAPTIVE_LEAST, { .key = NULL } };

const AdaptiveKind adaptive_own = {
    .info = { "own", "Kirk91", "a pixel stops by its own samples; needs --error; "
              "1 to 2 % dark under a probe, by half where light is rare bright samples", options },
    .truth = BIASED, .start = start, .plan = plan
};

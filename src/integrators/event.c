/* event.c -- rays through media. See event.h. */
#include "integrators/event.h"

enum { BORDERS_MOST = 65536 };          /* of media, between two events; a path beyond is lost */

Event ray_flies_through_media(Tracer *t, Ray *r, uint32_t *medium, float u, Rgb *throughput,
                              Surface *s, V3 *p)
{
    const Scene *scene = t->scene;
    Flight f;

    flight_start(&f, *throughput, u);
    for (int n = 0; n < BORDERS_MOST; n++) {
        float at;
        Hit h;
        Rgb weight;
        Met met = scene_meets(scene, r, true, &h, s);
        t->rays++;
        if (*medium != NO_MEDIUM &&
            flight_scatters(&f, &scene->media[*medium], h.t, &at, &weight)) {
            *p = v_mad(r->d, at, r->o);
            *throughput = rgb_mul(*throughput, weight);
            return SCATTERS;
        }
        if (met != MET_BORDER) {
            *throughput = rgb_mul(*throughput, flight_arrives(&f));
            return met == MET_SURFACE ? ARRIVES : ESCAPES;
        }
        *medium = medium_beyond(s, r->d, *medium);
        r->o = ray_origin(s->p, s->err, s->ng, r->d);
    }
    *throughput = rgb_all(0.0f);
    return ESCAPES;
}

bool ray_hits(Tracer *t, Ray *r, uint32_t *medium, Rgb *left, Hit *h, Surface *s)
{
    const Scene *scene = t->scene;

    if (LIKELY(!scene->nmedia)) {
        if (!tracer_nearest(t, r, h))
            return false;
        accel_surface(scene->accel, r, h, s);
        return true;
    }
    for (int n = 0; n < BORDERS_MOST; n++) {
        Met met = scene_meets(scene, r, true, h, s);
        t->rays++;
        if (*medium != NO_MEDIUM)
            *left = rgb_mul(*left, medium_transmittance(&scene->media[*medium], h->t));
        if (rgb_black(*left))
            return false;
        if (met != MET_BORDER)
            return met == MET_SURFACE;
        *medium = medium_beyond(s, r->d, *medium);
        r->o = ray_origin(s->p, s->err, s->ng, r->d);
    }
    *left = rgb_all(0.0f);
    return false;
}

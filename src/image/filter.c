/* filter.c -- the pixel filters. See filter.h. None is negative, so all samples weigh alike. */
#include "image/filter.h"

#include "sampling/warp.h"

static const OptDef radii[] = {
    { .key = "xradius", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 100, .also = "xwidth",
      .help = "half width in pixels; 0: the usual one" },
    { .key = "yradius", .type = OPT_FLOAT, .num = 0, .lo = 0, .hi = 100, .also = "ywidth",
      .help = "half height in pixels; 0: the usual one" },
    { .key = NULL }
};

static V2 box(V2 u, V2 r) { return (V2){ (2.0f * u.x - 1.0f) * r.x, (2.0f * u.y - 1.0f) * r.y }; }

static const FilterKind filter_box = {
    .info = { "box", "Shirley91 5.1", "all of the pixel alike", radii },
    .sample = box, .radius = { 0.5f, 0.5f }
};

static V2 triangle(V2 u, V2 r) { return (V2){ warp_tent(u.x) * r.x, warp_tent(u.y) * r.y }; }

static const FilterKind filter_triangle = {
    .info = { "triangle", "Shirley91 5.1, (5.9)", "a tent over two pixels: smoother edges", radii },
    .sample = triangle, .radius = { 1.0f, 1.0f }
};

const FilterKind *const filters[] = { &filter_box, &filter_triangle, NULL };

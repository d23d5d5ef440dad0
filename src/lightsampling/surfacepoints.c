/* surfacepoints.c -- point lights on the surfaces that reflect light on: one bounce.
 *
 * Source      [Wang09 4]: points spread evenly over the scene, each lit by the lamps.
 * Where       Straight lines at random through the scene's sphere meet every piece of surface in
 *             proportion to its area, whatever its shape and orientation, instanced or not; all of
 *             them are followed to their end. Of N lines, dA / (4 pi R^2) N meet one side of dA. So
 *             surfaces need not be listed, and no area be known: it comes out. Lines go by a
 *             sequence of low discrepancy in four dimensions [Roberts18].
 * Spread      Four times as many candidates as points. A candidate that has light becomes a point
 *             if there is none within a distance, facing alike: so all keep it. Every candidate
 *             then gives its area and its light to the nearest: what points stand for adds up to
 *             the whole, and their light is a mean over their cells. Surfaces without light get
 *             none: all points go where the light is.
 * Light       Each candidate asks lights, by sample and shadow ray, and is asked in turn by one
 *             sample of its own scattering for how much of it goes on. That is spread alike over
 *             all directions: the points are matt whatever the surface is, as in the source. */
#include "base/mem.h"
#include "base/random.h"
#include "lightsampling/lightsampler.h"
#include "lightsampling/pointlights.h"
#include "sampling/warp.h"

enum { CANDIDATES = 4 };        /* for each point */
enum { LINES_MOST = 64 };       /* the same; where so little is lit, there are fewer points */
enum { CROSSINGS_MOST = 64 };   /* of one line */
enum { ASKED = 4 };             /* lights, where there are more */

#define NOBODY UINT32_MAX

/* A candidate that has light. next: in its bucket, of those that are kept. */
typedef struct { V3 p, err, n; Rgb L; uint32_t next; } Lit;

typedef struct {
    const Scene *scene;
    LightSampler *lights;
    Lit *place;
    size_t n, cap;
    uint64_t draws;             /* of the sequences */
} Surfaces;

/* Coordinate k of point i of the sequence: powers of the root of x^5 = x + 1. */
static float line_number(uint64_t i, int k)
{
    static const uint32_t step[4] = { 3679390609u, 3152041523u, 2700274805u, 2313257605u };
    return unit_of((uint32_t)(i * step[k]) + 0x80000000u);
}

static float number(Surfaces *it) { return unit_of((uint32_t)(draw64(0x5ca77e2, ++it->draws))); }

/* ---- light ---- */

typedef struct { const Bsdf *b; Frame frame; const Surface *s; V3 n; } Spot;

/* How much of light from wi goes on towards the side of n: by one sample. */
static Rgb goes_on(Surfaces *it, const Spot *spot, V3 wi)
{
    V3 wo = frame_in(&spot->frame, wi), out;
    float lobe = number(it);
    V2 u;
    BsdfSample bs;

    u.x = number(it);
    u.y = number(it);
    if (wo.z == 0.0f || v_dot(wi, spot->s->ng) * wo.z <= 0.0f ||
        !spot->b->kind->sample(spot->b, wo, lobe, u, true, &bs) || !(bs.pdf_w > 0.0f))
        return rgb_all(0.0f);
    out = frame_out(&spot->frame, bs.wi);
    return v_dot(out, spot->n) > 0.0f && v_dot(out, spot->s->ng) * bs.wi.z > 0.0f
               ? bs.weight : rgb_all(0.0f);
}

static Rgb passes(const Surfaces *it, const Surface *s, const LightSample *ls)
{
    const Scene *scene = it->scene;
    Ray r = { .o = ray_origin(s->p, s->err, s->ng, ls->wi), .d = ls->wi, .tmax = INFINITY };

    if (is_finite(ls->dist))
        r = ray_between(s->p, s->err, s->ng, ls->p, ls->err, ls->n, ls->wi);
    if (scene->nmedia)
        return scene_transmittance(scene, &r, medium_beyond(s, ls->wi, scene->around));
    return rgb_all(scene_blocked(scene, &r) ? 0.0f : 1.0f);
}

static Rgb from_light(Surfaces *it, const Spot *spot, const Light *l, float pmf)
{
    V2 u;
    LightSample ls;
    Rgb c;

    u.x = number(it);
    u.y = number(it);
    if (!l->kind->sample(l, spot->s->p, u, &ls) || !(ls.pdf_w > 0.0f) || rgb_black(ls.L))
        return rgb_all(0.0f);
    c = rgb_mul(goes_on(it, spot, ls.wi), ls.L);
    if (rgb_black(c))
        return c;
    c = rgb_mul(c, passes(it, spot->s, &ls));
    return rgb_scale(c, v_absdot(ls.wi, spot->frame.n) / (PI_F * ls.pdf_w * pmf));
}

/* Radiance that leaves the spot's side of n, alike in all directions. */
static Rgb sent_on(Surfaces *it, const Spot *spot)
{
    const Scene *scene = it->scene;
    V3 up = spot->b->flags & BSDF_TRANSMIT ? v_all(0.0f) : spot->n;
    Rgb sum = rgb_all(0.0f);

    if (scene->nlights <= ASKED) {
        for (size_t i = 0; i < scene->nlights; i++)
            sum = rgb_add(sum, from_light(it, spot, scene->lights[i], 1.0f));
        return sum;
    }
    for (int k = 0; k < ASKED; k++) {
        float pmf, left;
        const Light *l = it->lights->kind->pick(it->lights, spot->s->p, up,
                                                ((float)k + number(it)) / ASKED, &pmf, &left);
        if (l)
            sum = rgb_add(sum, from_light(it, spot, l, pmf * ASKED));
    }
    return sum;
}

/* ---- candidates ---- */

static bool candidate(Surfaces *it, const Surface *s, V3 d)
{
    const Material *m = &it->scene->materials[s->shape->material];
    BsdfRoom room;
    Lit place;
    Spot spot;

    spot.b = material_bsdf(m, s, &room);
    spot.frame = material_frame(m, s);
    spot.s = s;
    spot.n = v_dot(d, s->ng) < 0.0f ? s->ng : v_neg(s->ng);
    if (!(spot.b->flags & BSDF_SMOOTH))
        return true;
    place = (Lit){ s->p, s->err, spot.n, sent_on(it, &spot), NOBODY };
    if (rgb_black(place.L) || !rgb_finite(place.L))
        return true;
    return MEM_PUSH(it->place, it->n, it->cap, place);
}

static bool follow_line(Surfaces *it, uint64_t i)
{
    const Scene *scene = it->scene;
    V3 d = warp_sphere((V2){ line_number(i, 0), line_number(i, 1) });
    V2 q = warp_disk_concentric((V2){ line_number(i, 2), line_number(i, 3) });
    float R = scene->radius;
    Frame f = frame_about(d);
    Ray r = { .d = d, .tmax = INFINITY };
    Hit h;

    r.o = v_add(scene->centre, frame_out(&f, v3(q.x * R, q.y * R, -2.0f * R)));
    for (int k = 0; k < CROSSINGS_MOST && scene_nearest(scene, &r, &h); k++) {
        Surface s;
        accel_surface(scene->accel, &r, &h, &s);
        if (!candidate(it, &s, d))
            return false;
        r.o = ray_origin(s.p, s.err, s.ng, d);
    }
    return true;
}

/* How many lines were followed. 0: memory. */
static uint64_t follow_lines(Surfaces *it, size_t wanted)
{
    uint64_t i = 0, most = (uint64_t)wanted * LINES_MOST;

    while (i < most && it->n < wanted * CANDIDATES)
        if (!follow_line(it, i++))
            return 0;
    return i;
}

/* ---- which of them are kept ---- */

typedef struct { uint32_t *bucket; uint32_t mask; float r; V3 lo; const Surfaces *of; } Near;

static uint32_t bucket_at(const Near *near, int64_t x, int64_t y, int64_t z)
{
    uint64_t key = mix64((uint64_t)x * 73856093u ^ (uint64_t)y * 19349663u << 20 ^
                         (uint64_t)z * 83492791u << 40);
    return (uint32_t)key & near->mask;
}

static int64_t slab(float x, float lo, float r)
{
    return (int64_t)floor((double)(x - lo) / (double)r);
}

/* The nearest of those kept, if there is one within r that faces alike; else NOBODY. */
static uint32_t nearest(const Near *near, const Lit *p)
{
    const Lit *all = near->of->place;
    int64_t x = slab(p->p.x, near->lo.x, near->r), y = slab(p->p.y, near->lo.y, near->r);
    int64_t z = slab(p->p.z, near->lo.z, near->r);
    float best = near->r * near->r;
    uint32_t found = NOBODY;

    for (int k = 0; k < 27; k++) {
        uint32_t i = near->bucket[bucket_at(near, x + k % 3 - 1, y + k / 3 % 3 - 1, z + k / 9 - 1)];
        for (; i != NOBODY; i = all[i].next) {
            float d2 = v_len2(v_sub(all[i].p, p->p));
            if (v_dot(all[i].n, p->n) > 0.5f && (d2 < best || (d2 == best && i < found))) {
                best = d2;
                found = i;
            }
        }
    }
    return found;
}

static void keep(Near *near, Lit *all, uint32_t i)
{
    const V3 p = all[i].p;
    uint32_t b = bucket_at(near, slab(p.x, near->lo.x, near->r), slab(p.y, near->lo.y, near->r),
                           slab(p.z, near->lo.z, near->r));
    all[i].next = near->bucket[b];
    near->bucket[b] = i;
}

/* Makes points of those kept, and gives each candidate's area and light to the nearest of them.
 * number_of: room for the place of each one among the points. */
static bool share_out(PointLights *to, const Surfaces *it, const Near *near, uint32_t *number_of,
                      const uint32_t *kept, size_t nkept, float area)
{
    size_t first = to->n;

    for (size_t k = 0; k < nkept; k++) {
        const Lit *q = &it->place[kept[k]];
        PointLight p = { .kind = POINT_ON_SURFACE, .p = q->p, .err = q->err, .n = q->n };
        if (!MEM_PUSH(to->p, to->n, to->cap, p))
            return false;
        number_of[kept[k]] = (uint32_t)k;
    }
    for (size_t i = 0; i < it->n; i++) {
        uint32_t k = nearest(near, &it->place[i]);
        PointLight *p = &to->p[first + number_of[k == NOBODY ? i : k]];
        p->size += area;
        p->L = rgb_add(p->L, it->place[i].L);
    }
    for (size_t k = first; k < to->n; k++) {
        to->p[k].L = rgb_scale(to->p[k].L, area / to->p[k].size);
        to->p[k].lum = rgb_lum(to->p[k].L);
    }
    return true;
}

/* Darts in the candidates' order, at the distance that leaves about `wanted`: a set that no dart
 * fits into any more has about 0.7 points in a square of that distance. */
static bool spread(PointLights *to, Surfaces *it, size_t wanted, float area)
{
    Near near = { NULL, 1023, 0, { 0, 0, 0 }, it };
    uint32_t *kept = MEM_ARRAY(uint32_t, it->n), *number_of = MEM_ARRAY(uint32_t, it->n);
    size_t nkept = 0;
    bool ok;

    while (near.mask < 2 * it->n && near.mask < UINT32_MAX / 2)
        near.mask = 2 * near.mask + 1;
    near.bucket = MEM_ARRAY(uint32_t, (size_t)near.mask + 1);
    near.lo = v_sub(it->scene->centre, v_all(it->scene->radius));
    near.r = f_max(sqrtf(0.6f * area * (float)it->n / (float)wanted), it->scene->radius * 1e-6f);
    ok = kept && number_of && near.bucket;
    if (ok) {
        memset(near.bucket, 0xff, ((size_t)near.mask + 1) * sizeof *near.bucket);
        for (uint32_t i = 0; i < it->n; i++)
            if (nearest(&near, &it->place[i]) == NOBODY) {
                kept[nkept++] = i;
                keep(&near, it->place, i);
            }
        ok = share_out(to, it, &near, number_of, kept, nkept, area);
    }
    mem_free(kept);
    mem_free(number_of);
    mem_free(near.bucket);
    return ok;
}

bool surface_points(PointLights *to, size_t wanted)
{
    const Scene *s = to->scene;
    Surfaces it = { s, NULL, NULL, 0, 0, 0 };
    uint64_t lines = 0;

    if (!s->accel || !(s->radius > 0.0f))
        return true;
    it.lights = lightsampler_open(LIGHTSAMPLER_DEFAULT, s);
    if (it.lights) {
        lines = follow_lines(&it, wanted);
        if (lines && it.n)
            lines = spread(to, &it, wanted,
                           (float)(4 * PI * (double)s->radius * (double)s->radius /
                                   (double)lines)) ? lines : 0;
        lightsampler_close(it.lights);
    }
    mem_free(it.place);
    return lines > 0;
}

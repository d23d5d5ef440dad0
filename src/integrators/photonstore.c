/* photonstore.c -- see photonstore.h. */
#include "integrators/photonstore.h"

#include "base/bits.h"
#include "base/mem.h"
#include "base/random.h"
#include "sampling/warp.h"

enum { UNIT = 4096,             /* paths */
       TRIED = 4,               /* units that are tried */
       PATHS_MOST = 32,         /* for each photon that is wanted, where few are ever kept; */
       UNLIKELY_MOST = 64,     /* units, where none was kept of those that were tried */
       WI_BITS = 10, NORMAL_BITS = 6 };

/* ---- directions: cells of a square, see octahedron_fold ---- */

static uint32_t fold_out(V3 d, int bits)
{
    float cells = (float)(1u << bits), sum = fabsf(d.x) + fabsf(d.y) + fabsf(d.z);
    float x = d.x / sum, y = d.y / sum;
    int i, j, last = (1 << bits) - 1;

    if (d.z < 0.0f)
        octahedron_fold(&x, &y);
    i = (int)((x * 0.5f + 0.5f) * cells);
    j = (int)((y * 0.5f + 0.5f) * cells);
    return (uint32_t)(i < last ? i : last) << bits | (uint32_t)(j < last ? j : last);
}

/* The middle of the cell. */
static V3 folded_in(uint32_t cell, int bits)
{
    float cells = (float)(1u << bits);
    float x = (2.0f * (float)(cell >> bits & ((1u << bits) - 1)) + 1.0f) / cells - 1.0f;
    float y = (2.0f * (float)(cell & ((1u << bits) - 1)) + 1.0f) / cells - 1.0f;
    float z = 1.0f - fabsf(x) - fabsf(y), l;

    if (z < 0.0f)
        octahedron_fold(&x, &y);
    l = 1.0f / sqrtf(x * x + y * y + z * z);
    return v3(x * l, y * l, z * l);
}

V3 photon_wi(const Photon *p) { return folded_in(p->ways >> 2 * NORMAL_BITS, WI_BITS); }
V3 photon_normal(const Photon *p) { return folded_in(p->ways, NORMAL_BITS); }

/* ---- flux: three mantissas of 8 bits and an exponent ---- */

/* 2^k, for normal numbers. */
static float two_to(int k) { return float_of((uint32_t)(k + 127) << 23); }

static uint32_t flux_packed(Rgb c, float u)
{
    float most = rgb_max(c), steps;
    int e;

    if (!(most >= 0x1p-110f))
        return 0;
    e = (int)(bits_of_float(most) >> 23) - 126;         /* 2^(e-1) <= most < 2^e */
    if (most * two_to(8 - e) > 255.0f)
        e++;
    if (e > 120)
        return 0;               /* no number that means anything */
    steps = two_to(8 - e);
    return (uint32_t)(f_max(c.r, 0.0f) * steps + u) << 24 |
           (uint32_t)(f_max(c.g, 0.0f) * steps + u) << 16 |
           (uint32_t)(f_max(c.b, 0.0f) * steps + u) << 8 | (uint32_t)(e + 128);
}

Rgb photon_flux(const Photon *p)
{
    float step;

    if (!p->flux)
        return rgb_all(0.0f);
    step = two_to((int)(p->flux & 255u) - 128 - 8);
    return rgb((float)(p->flux >> 24) * step, (float)(p->flux >> 16 & 255u) * step,
               (float)(p->flux >> 8 & 255u) * step);
}

/* The chance is made of the photon itself. */
Photon photon_of(V3 p, Rgb flux, V3 wi, V3 n)
{
    Photon made = { { p.x, p.y, p.z }, 0, 0 };
    uint64_t key = key_with((uint64_t)bits_of_float(p.x) << 32 | bits_of_float(p.y),
                            (uint64_t)bits_of_float(p.z) << 32 | bits_of_float(flux.g));

    made.flux = flux_packed(flux, unit_of((uint32_t)(key >> 32)));
    made.ways = fold_out(wi, WI_BITS) << 2 * NORMAL_BITS | fold_out(n, NORMAL_BITS);
    return made;
}

/* ---- paths ---- */

static bool is_of(PhotonLight light, const Particle *p)
{
    switch (light) {
    case PHOTONS_ALL:      return true;
    case PHOTONS_INDIRECT: return p->depth > 0;
    case PHOTONS_ROUGH:    return !p->deltas;
    case PHOTONS_CAUSTIC:  return p->depth > 0 && p->deltas;
    }
    return false;
}

/* Counts a photon, and keeps it unless the batch is one that is tried. */
static void keep(PhotonBatch *batch, bool tried, const Particle *p, const Vertex *v, Tracer *t)
{
    float across = v_absdot(p->ray.d, v->s.ng);
    Photon photon;

    if (!(across > 0.0f))
        return;
    photon = photon_of(v->s.p, rgb_scale(p->flux, fabsf(v->wo.z) / across), v_neg(p->ray.d),
                       v_dot(p->ray.d, v->s.ng) < 0.0f ? v->s.ng : v_neg(v->s.ng));
    if (!photon.flux || !v_finite(v->s.p))
        return;
    if (tried)
        batch->n++;
    else if (!MEM_PUSH(batch->photons, batch->n, batch->room, photon))
        t->failed = true;
}

static void shoot(const PhotonStore *s, PhotonBatch *batch, bool tried, Tracer *t)
{
    float u = scene_blurs(t->scene) ? sample_1d(&t->sampler, DECISION(DECIDE_TIME, 0)) : 0.0f;
    bool caustic = s->light == PHOTONS_CAUSTIC;
    Particle p;
    Emission e;

    if (!particle_leaves(&p, s->lights, scene_time(t->scene, u), t, &e))
        return;
    for (;;) {
        Vertex v;
        if (!ray_meets(t, &p.ray, &p.medium, &p.flux, &v.s))
            return;
        vertex_make(&v, t->scene, p.ray.d);
        if (vertex_is_smooth(&v) && is_of(s->light, &p))
            keep(batch, tried, &p, &v, t);
        if (p.depth >= s->maxdepth || (caustic && !(v.b->flags & BSDF_SPECULAR)) ||
            !particle_scatters(&p, &v, t) || (caustic && !p.deltas) ||
            !particle_survives(&p, s->roulette, t))
            return;
    }
}

/* Paths are one sequence, so that lamps are covered as evenly as the sampler can; those that are
 * tried are another, and so are those of each kind of store. */
static void shoot_unit(const PhotonStore *s, PhotonBatch *batch, bool tried, uint64_t first,
                       uint64_t n, Tracer *t)
{
    uint32_t sequence = UINT32_MAX - 1 - 2 * (s->light == PHOTONS_CAUSTIC) - tried;

    sampler_pixel(&t->sampler, sequence, (uint32_t)(first >> 32));
    for (uint64_t i = 0; i < n; i++) {
        sampler_start(&t->sampler, (uint32_t)(first + i));
        shoot(s, batch, tried, t);
    }
}

/* ---- stages: try, shoot, copy, and the tree's two ---- */

enum { TRY, SHOOT, COPY, START, FINISH };

void photonstore_init(PhotonStore *s, const LightSampler *by, PhotonLight light,
                      uint32_t wanted, int maxdepth, int roulette)
{
    memset(s, 0, sizeof *s);
    s->lights = by;
    s->light = light;
    s->wanted = maxdepth < 0 ? 0 : wanted;
    s->maxdepth = maxdepth;
    s->roulette = roulette;
}

static void drop_batches(PhotonStore *s)
{
    for (uint64_t i = 0; i < s->nbatches; i++)
        mem_free(s->batches[i].photons);
    mem_free(s->batches);
    mem_free(s->before);
    s->batches = NULL;
    s->before = NULL;
    s->nbatches = 0;
}

void photonstore_clear(PhotonStore *s)
{
    drop_batches(s);
    pointtree_clear(&s->tree);
    mem_free(s->photons);
    s->photons = NULL;
    s->n = 0;
}

static void make_batches(PhotonStore *s, uint64_t n)
{
    s->batches = MEM_ARRAY(PhotonBatch, n);
    s->nbatches = s->batches ? n : 0;
    s->failed = s->failed || !s->batches;
}

/* As many as bring what is wanted, by what those that were tried have brought. */
static void plan(PhotonStore *s)
{
    uint64_t kept = 0, most = (uint64_t)s->wanted * PATHS_MOST;
    double paths;

    for (uint64_t i = 0; i < s->nbatches; i++)
        kept += s->batches[i].n;
    drop_batches(s);
    paths = kept ? (double)s->wanted * TRIED * UNIT / (double)kept : (double)UNLIKELY_MOST * UNIT;
    s->paths = paths < (double)most ? (uint64_t)paths + 1 : most;
    make_batches(s, (s->paths + UNIT - 1) / UNIT);
}

/* Room for all photons, and the tree's. */
static void arrange(PhotonStore *s)
{
    uint64_t sum = 0;

    s->before = MEM_ARRAY(uint64_t, s->nbatches);
    for (uint64_t i = 0; s->before && i < s->nbatches; i++) {
        s->before[i] = sum;
        sum += s->batches[i].n;
    }
    if (s->before && sum < UINT32_MAX)
        s->photons = MEM_ARRAY(Photon, sum);
    if (s->photons && pointtree_init(&s->tree, s->photons, (uint32_t)sum, sizeof(Photon)))
        s->n = (uint32_t)sum;
    else {
        photonstore_clear(s);
        s->failed = true;
    }
}

uint64_t photonstore_units(PhotonStore *s, int stage)
{
    if (!s->wanted)
        return 0;
    switch (stage) {
    case TRY:
        make_batches(s, TRIED);
        return s->nbatches;
    case SHOOT:
        if (s->nbatches)
            plan(s);
        return s->nbatches;
    case COPY:
        if (s->nbatches)
            arrange(s);
        return s->nbatches;
    case START:
        drop_batches(s);
        return s->n > 0;
    default:
        return s->n ? pointtree_units(&s->tree) : 0;
    }
}

static void copy(PhotonStore *s, uint64_t unit)
{
    PhotonBatch *b = &s->batches[unit];

    if (b->n)
        memcpy(s->photons + s->before[unit], b->photons, b->n * sizeof *b->photons);
    mem_free(b->photons);
    b->photons = NULL;
}

void photonstore_run(PhotonStore *s, int stage, uint64_t unit, Tracer *t)
{
    uint64_t first = unit * UNIT, end = stage == TRY ? first + UNIT : s->paths;
    PhotonBatch batch;

    switch (stage) {
    case TRY: case SHOOT:
        batch = s->batches[unit];       /* neighbours in memory are other threads' */
        shoot_unit(s, &batch, stage == TRY, first, end - first < UNIT ? end - first : UNIT, t);
        s->batches[unit] = batch;
        break;
    case COPY: copy(s, unit); break;
    case START: pointtree_start(&s->tree); break;
    default: pointtree_finish(&s->tree, (uint32_t)unit); break;
    }
}

size_t photonstore_bytes(const PhotonStore *s)
{
    return s->n * sizeof *s->photons + pointtree_bytes(&s->tree);
}

/* ---- estimates ---- */

/* At d^2 / r^2 = q; over a disc, the mean is 1. */
INLINE float kernel_at(Kernel k, float q)
{
    switch (k) {
    case KERNEL_CONSTANT:     return 1.0f;
    case KERNEL_CONE:         return 3.0f * (1.0f - sqrtf(q));
    case KERNEL_EPANECHNIKOV: return 2.0f * (1.0f - q);
    }
    return 0.0f;
}

/* Whether the photon is where a record is, and not one by which records are estimated. */
static bool has_record(const Photon *p)
{
    uint64_t place = (uint64_t)bits_of_float(p->p[0]) << 32 | bits_of_float(p->p[1]);
    return key_with(place, (uint64_t)p->ways << 32 | bits_of_float(p->p[2])) % RECORD_STEP == 0;
}

static bool has_none(const void *ctx, uint32_t i)
{
    return !has_record(&((const PhotonStore *)ctx)->photons[i]);
}

/* The photons that count, in *found, and how many they are; *r2: of the disc. */
static uint32_t photons_near(const PhotonStore *s, const PhotonLook *look, V3 p, bool all,
                             Near *found, const Near **first, float *r2)
{
    uint32_t n = all ? pointtree_nearest(&s->tree, p, look->radius2, look->k, found)
                     : pointtree_nearest_of_some(&s->tree, p, look->radius2, look->k, found,
                                                 has_none, s);

    *first = found;
    *r2 = look->radius2;
    if (n < look->k)
        return n;
    *r2 = found[0].d2;
    *first = found + 1;         /* [errata 7.8] */
    return *r2 > 0.0f ? n - 1 : 0;
}

/* Of the disc, and of the number of paths. [Cline07 fig. 7.13; errata 7.7] */
static float scale_of(const PhotonStore *s, float r2)
{
    return 1.0f / (PI_F * r2 * (float)s->paths);
}

Rgb photonstore_radiance(const PhotonStore *s, const PhotonLook *look, const Vertex *v, float *disc)
{
    Near found[PHOTONS_NEAREST_MOST];
    Rgb sum = rgb_all(0.0f);
    const Near *a;
    float r2;
    uint32_t n = photons_near(s, look, v->s.p, true, found, &a, &r2);

    if (disc)
        *disc = r2;
    for (uint32_t i = 0; i < n; i++) {
        const Photon *p = &s->photons[a[i].i];
        V3 local;
        if (vertex_local(v, photon_wi(p), &local)) {
            Rgb f = v->b->kind->eval(v->b, v->wo, local, false);
            sum = rgb_add(sum, rgb_scale(rgb_mul(f, photon_flux(p)),
                                         kernel_at(look->kernel, a[i].d2 / r2)));
        }
    }
    return n ? rgb_scale(sum, scale_of(s, r2)) : sum;
}

/* ---- records ---- */

enum { RECORDS = 512 };         /* of a unit */

/* The radius keeps 12 bits of its mantissa but one: rounded down by less than 1 / 2048. */
#define RADIUS_BITS 0xfffff000u

void photonrecords_clear(PhotonRecords *r)
{
    pointtree_clear(&r->tree);
    mem_free(r->records);
    r->records = NULL;
    r->n = 0;
}

/* Records as the photons that are there: their places and normals stay. */
static bool place_records(PhotonRecords *r, const PhotonStore *s)
{
    uint32_t n = 0;

    for (uint32_t i = 0; i < s->n; i++)
        n += has_record(&s->photons[i]);
    r->records = MEM_ARRAY(Photon, n);
    if (!r->records)
        return false;
    for (uint32_t i = 0; i < s->n; i++)
        if (has_record(&s->photons[i]))
            r->records[r->n++] = s->photons[i];
    return pointtree_init(&r->tree, r->records, n, sizeof *r->records);
}

uint64_t photonrecords_units(PhotonRecords *r, const PhotonStore *s, int stage)
{
    if (stage == 0 && !place_records(r, s)) {
        photonrecords_clear(r);
        r->failed = true;
    }
    return stage == 0 ? (r->n + RECORDS - 1) / RECORDS : r->n > 0;
}

/* Irradiance on the side of n, where a record is; *r2: squared radius of the disc. */
static Rgb irradiance(const PhotonStore *s, const PhotonLook *look, V3 p, V3 n, float *r2)
{
    Near found[PHOTONS_NEAREST_MOST];
    Rgb sum = rgb_all(0.0f);
    const Near *a;
    uint32_t count = photons_near(s, look, p, false, found, &a, r2);

    for (uint32_t i = 0; i < count; i++) {
        const Photon *at = &s->photons[a[i].i];
        if (v_dot(photon_wi(at), n) > 0.0f)
            sum = rgb_add(sum, rgb_scale(photon_flux(at),
                                         kernel_at(look->kernel, a[i].d2 / *r2)));
    }
    return count ? rgb_scale(sum, scale_of(s, *r2) * RECORD_STEP / (RECORD_STEP - 1)) : sum;
}

void photonrecords_run(PhotonRecords *r, const PhotonStore *s, const PhotonLook *look, int stage,
                       uint64_t unit)
{
    uint32_t end = (uint32_t)unit * RECORDS + RECORDS;

    if (stage == 1) {
        pointtree_build(&r->tree);
        return;
    }
    for (uint32_t i = (uint32_t)unit * RECORDS; i < end && i < r->n; i++) {
        Photon *p = &r->records[i];
        V3 at = photon_place(p), n = photon_normal(p);
        uint32_t normal = p->ways & ((1u << 2 * NORMAL_BITS) - 1);
        float r2;
        Rgb E = irradiance(s, look, at, n, &r2);
        *p = photon_of(at, E, n, n);
        p->ways = (bits_of_float(sqrtf(r2)) & RADIUS_BITS) | normal;
    }
}

typedef struct { const Photon *records, *best; V3 n; } Wanted;

static float judge(void *ctx, uint32_t i, float d2, float r2)
{
    Wanted *w = ctx;

    if (v_dot(photon_normal(&w->records[i]), w->n) < 0.8f)
        return r2;
    w->best = &w->records[i];
    return d2;
}

bool photonrecords_irradiance(const PhotonRecords *r, const PhotonLook *look, V3 p, V3 n, Rgb *E,
                              float *r2)
{
    Wanted w = { r->records, NULL, n };

    pointtree_within(&r->tree, p, look->radius2, judge, &w);
    if (!w.best)
        return false;
    *E = photon_flux(w.best);
    *r2 = f_sqr(float_of(w.best->ways & RADIUS_BITS));
    return true;
}

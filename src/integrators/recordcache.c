/* recordcache.c -- the code of `recordcache.h` */
#include "integrators/recordcache.h"

#include "base/mem.h"
#include "scene/camera.h"

enum { COARSEST = 64, SETS = RECORDCACHE_SETS };
enum { RECORDS_OF = 1 << 30 };  /* added to a pixel's x: the numbers of its records */

/* ---- light along a path ---- */

/* By one direction towards a lamp and one by the surface. */
static Rgb direct(const RecordCache *it, const Turn *u, Tracer *t)
{
    Draw light = draw_first(t, u, DECIDE_LIGHT, DECIDE_LIGHT_POINT);
    Draw scattering = draw_first(t, u, DECIDE_LOBE, DECIDE_DIRECTION);
    Rgb sum = rgb_all(0.0f);
    Candidate c;

    if (candidate_by_light(&it->lighting, u, &light, 1.0f, 1.0f, t, &c))
        sum = candidate_light(&c, u, t);
    if (candidate_by_scattering(&it->lighting, u, &scattering, 1.0f, 1.0f, t, &c))
        sum = rgb_add(sum, candidate_light(&c, u, t));
    return sum;
}

static Spot spot_of(const RecordCache *it, const Vertex *v, const BsdfSample *s)
{
    float side = v_dot(s->wi, v->frame.n);
    return (Spot){ v->s.p, side < 0.0f ? v_neg(v->frame.n) : v->frame.n,
                    v->s.width > 0.0f ? v->s.width : it->pixel };
}

static Asks asked_by(const RecordCache *it, const BsdfSample *s)
{
    if (!(s->flags & BSDF_SMOOTH))
        return ASKS_NOTHING;
    if (s->flags & BSDF_MATT)
        return ASKS_MATT;
    return it->bands > 0 && s->pdf_w <= it->sharpest ? ASKS_GLOSSY : ASKS_NOTHING;
}

/* Whether an event at the beam's end may use light that was scattered before. */
static bool may_ask(const RecordCache *it, const Beam *b)
{
    return b->depth + 2 <= it->maxdepth;
}

/* The light that the event brings by records, along its direction. False: none knows. */
static bool ask(const RecordCache *it, const Beam *b, const Vertex *v, const BsdfSample *s,
                Tracer *t, Rgb *L)
{
    Asks what = may_ask(it, b) ? asked_by(it, s) : ASKS_NOTHING;
    Spot at = spot_of(it, v, s);

    if (what == ASKS_NOTHING)
        return false;
    if (what == ASKS_GLOSSY)
        return radiance_at(&it->glossy, at.p, at.n, s->wi, it->a * it->overlap, it->gradients, L);
    if (!it->ask(it, b, v, &at, t, L))
        return false;
    *L = rgb_scale(*L, INV_PI);
    return true;
}

/* What photons say of all light that leaves the vertex but by deltas. After an event that was none,
 * *L stays as it is where blur would come from as far as the beam itself: false. */
static bool by_photons(const RecordCache *it, const Beam *b, const Vertex *v, bool delta, Rgb *L)
{
    float r2 = 0.0f;
    Rgb all;

    if (!it->maps.photons.wanted || b->way >= 0.0f)
        return false;
    all = photonmaps_gathered(&it->maps, v, &r2);
    if (!delta && v_len2(v_sub(v->s.p, b->ray.o)) < r2)
        return false;
    *L = all;
    return true;
}

/* What has come straight from lamps, or by deltas alone if photons tell of that. */
static Rgb lit(const RecordCache *it, const Beam *b, const Vertex *v, Tracer *t)
{
    Turn u = turn_on(v, b->ray.d, b->medium, b->depth);
    Rgb caustics = photonmaps_caustics(&it->maps, v);

    u.to_eye = b->throughput;
    tracer_tally(t, b->depth + 3, STRATEGY_MERGE, rgb_mul(b->throughput, caustics));
    return rgb_add(direct(it, &u, t), caustics);
}

/* What leaves the vertex along the beam, but for its own light. Lamps that deltas lead to are
 * shown, unless they are caustics of which photons tell. forks: of the eye's paths, which use
 * records; else NULL. */
static Rgb leaves(const RecordCache *it, Beam *b, Vertex *v, Forks *forks, Tracer *t)
{
    const Scene *scene = it->base.scene;
    Rgb sum = rgb_all(0.0f), L;
    bool delta = false;

    while (b->depth < it->maxdepth) {
        bool told = false, shown;
        BsdfSample s;
        vertex_make(v, scene, b->ray.d);
        if (vertex_is_smooth(v)) {
            told = by_photons(it, b, v, delta, &L);
            L = rgb_mul(b->throughput, told ? L : lit(it, b, v, t));
            if (told)
                tracer_tally(t, b->depth + 2, STRATEGY_MERGE, L);
            sum = rgb_add(sum, L);
        } else if (forks && beam_forks(forks, b, v, t))
            break;
        if (!vertex_sample(v, t, b->depth, &s) || (told && s.pdf_w > 0.0f))
            break;
        if (forks && ask(it, b, v, &s, t, &L)) {
            L = rgb_mul(rgb_mul(b->throughput, s.weight), L);
            tracer_tally(t, b->depth + 3, STRATEGY_EXPLICIT, L);
            return rgb_add(sum, L);
        }
        delta = s.pdf_w == 0.0f;
        beam_turn(b, v, &s);
        if (!beam_lasts(b, it->roulette, t))
            break;
        shown = delta && !(b->way < 0.0f && it->maps.caustics.wanted);
        if (!beam_meets(b, &v->s, t))
            return shown ? rgb_add(sum, beam_shows_beyond(b, t)) : sum;
        if (shown && v->s.shape->light != NO_LIGHT)
            sum = rgb_add(sum, beam_shows(b, scene_light_of(scene, &v->s), &v->s, t));
    }
    return sum;
}

static Rgb found(const RecordCache *it, Beam *b, Forks *forks, Tracer *t)
{
    Rgb sum = rgb_all(0.0f);
    Vertex v;

    if (!beam_meets(b, &v.s, t))
        return beam_shows_beyond(b, t);
    if (v.s.shape->light != NO_LIGHT)
        sum = beam_shows(b, scene_light_of(it->base.scene, &v.s), &v.s, t);
    return rgb_add(sum, leaves(it, b, &v, forks, t));
}

Rgb recordcache_radiance(const Integrator *base, const Ray *r, Tracer *t)
{
    Beam b = beam_from_eye(r, base->scene);
    Forks forks = { .n = 0 };
    Rgb sum = rgb_all(0.0f);

    do
        sum = rgb_add(sum, found((const RecordCache *)base, &b, &forks, t));
    while (forks_next(&forks, &b));
    return sum;
}

/* ---- making a record ---- */

/* What comes along a ray of the record's, which has been scattered once already. */
static Rgb arrives(const RecordCache *it, const Vertex *from, uint32_t medium, V3 wi, Tracer *t,
                   float *inv_distance)
{
    Beam b = { .throughput = { 1, 1, 1 }, .eta2 = 1.0f, .way = -1.0f, .depth = 1 };
    Vertex v;

    *inv_distance = 0.0f;
    if (v_dot(wi, from->s.ng) * v_dot(wi, from->frame.n) <= 0.0f)
        return rgb_all(0.0f);   /* the surface is in the way */
    b.ray = vertex_ray(from, wi);
    b.medium = medium_beyond(&from->s, wi, medium);
    if (!beam_meets(&b, &v.s, t))
        return rgb_all(0.0f);
    *inv_distance = 1.0f / f_max(v_len(v_sub(v.s.p, from->s.p)), 1e-30f);
    return leaves(it, &b, &v, NULL, t);
}

/* The tracer's numbers while a record is made. */
typedef struct { Sampler sampler; Tally *tally; } Before;

static Before step_aside(Tracer *t)
{
    Before before = { t->sampler, t->tally };

    t->tally = NULL;
    sampler_pixel(&t->sampler, t->x + RECORDS_OF, t->y);
    return before;
}

static void step_back(Tracer *t, const Before *before)
{
    t->sampler = before->sampler;
    t->tally = before->tally;
}

static V2 numbers_of_ray(Tracer *t, uint32_t ray)
{
    sampler_start(&t->sampler, ray);
    return sample_2d(&t->sampler, DECISION(DECIDE_DIRECTION, 0));
}

IrradianceRecord recordcache_make(const RecordCache *it, const Vertex *v, const Spot *at,
                                  uint32_t medium, uint32_t number, Tracer *t)
{
    Frame f = frame_about(at->n);
    Before before = step_aside(t);
    Irradiance of;
    Hemisphere h;

    hemisphere_start(&h, it->rays);
    number *= (uint32_t)h.rings * (uint32_t)h.sectors;
    for (int k = 0; k < h.sectors; k++)
        for (int j = 0; j < h.rings; j++) {
            V3 d = hemisphere_direction(&h, j, k, numbers_of_ray(t, number++));
            float inv;
            Rgb L = arrives(it, v, medium, frame_out(&f, d), t, &inv);
            hemisphere_take(&h, j, k, L, inv);
        }
    hemisphere_end(&h, &f, &of);
    step_back(t, &before);
    return irradiance_record(at->p, at->n, &of, it->least * at->width / it->a,
                             it->most * at->width / it->a);
}

static Reach make_glossy(const RecordCache *it, const Vertex *v, const Spot *at, uint32_t medium,
                         Tracer *t, Radiance *of)
{
    Frame f = frame_about(at->n);
    Before before = step_aside(t);
    uint32_t ray = 0;
    Dome d;

    dome_start(&d, &it->glossy.basis, it->rays);
    for (int k = 0; k < d.sectors; k++)
        for (int j = 0; j < d.rings; j++) {
            V3 w = dome_direction(&d, j, k, numbers_of_ray(t, ray++));
            float inv;
            Rgb L = arrives(it, v, medium, frame_out(&f, w), t, &inv);
            dome_take(&d, j, k, w, L, inv);
        }
    step_back(t, &before);
    return dome_end(&d, at->p, at->n, it->least * at->width / it->a,
                    it->most * at->width / it->a, of);
}

/* ---- asking ---- */

static bool ask_store(const RecordCache *it, const Beam *b, const Vertex *v, const Spot *at,
                      Tracer *t, Rgb *E)
{
    (void)b, (void)v, (void)t;
    return irradiance_at(&it->matt, at->p, at->n, it->a * it->overlap, it->gradients, E);
}

/* ---- overture ----
 *
 * The sets: pixels of a grid, then the middles of its cells, then the next grid, half as wide. Each
 * has two phases, of which the first says where records lack and the second makes them; they are
 * taken in before the next one begins. */

/* What a sample of the pixel would ask, and where. */
static Asks seek(const RecordCache *it, uint32_t x, uint32_t y, Tracer *t, Beam *b, Vertex *v,
                 Spot *at)
{
    const Scene *scene = it->base.scene;
    V2 lens = { 0.5f, 0.5f }, middle = { (float)x + 0.5f, (float)y + 0.5f };
    float u = 0.0f;
    BsdfSample s;
    Ray r;

    t->x = x;
    t->y = y;
    sampler_pixel(&t->sampler, x, y);
    sampler_start(&t->sampler, 0);
    if (scene->camera->has_lens)
        lens = sample_2d(&t->sampler, DECISION(DECIDE_LENS, 0));
    if (scene_blurs(scene))
        u = sample_1d(&t->sampler, DECISION(DECIDE_TIME, 0));
    r = scene->camera->kind->ray(scene->camera, middle, lens, scene_time(scene, u));
    for (*b = beam_from_eye(&r, scene); may_ask(it, b); beam_turn(b, v, &s)) {
        if (!beam_meets(b, &v->s, t))
            return ASKS_NOTHING;
        vertex_make(v, scene, b->ray.d);
        if (!vertex_sample(v, t, b->depth, &s))
            return ASKS_NOTHING;
        *at = spot_of(it, v, &s);
        if (s.flags & BSDF_SMOOTH)
            return asked_by(it, &s);
    }
    return ASKS_NOTHING;
}

/* Set 0, 2, ...: the grids; 1, 3, ...: middles of cells. Pixels of earlier sets are left out. */
static bool is_of_set(uint32_t x, uint32_t y, int set)
{
    uint32_t s = (uint32_t)COARSEST >> (set / 2), inside = s - 1, wide = 2 * s - 1;

    if (set % 2)
        return (x & inside) == s / 2 && (y & inside) == s / 2;
    if ((x & inside) || (y & inside))
        return false;
    return set == 0 || ((x & wide) == s) != ((y & wide) == s);
}

/* What of records lacks at the pixel. */
static Asks lacks(const RecordCache *it, uint32_t x, uint32_t y, Tracer *t)
{
    Spot at;
    Vertex v;
    Beam b;
    Rgb E;
    Asks what = seek(it, x, y, t, &b, &v, &at);

    if (what == ASKS_MATT && irradiance_at(&it->matt, at.p, at.n, it->a, it->gradients, &E))
        return ASKS_NOTHING;
    if (what == ASKS_GLOSSY && radiance_known(&it->glossy, at.p, at.n, it->a))
        return ASKS_NOTHING;
    return what;
}

static void look(RecordCache *it, int set, uint32_t row, Tracer *t)
{
    for (uint32_t x = 0; x < it->w; x++)
        it->wanted[(size_t)row * it->w + x] =
            is_of_set(x, row, set) ? (uint8_t)lacks(it, it->x0 + x, it->y0 + row, t) : ASKS_NOTHING;
}

static void make(RecordCache *it, uint64_t unit, Tracer *t)
{
    uint64_t pixel = it->places[unit];
    size_t other = (size_t)unit - it->nmatt;
    Spot at;
    Vertex v;
    Beam b;
    Asks what = seek(it, it->x0 + (uint32_t)(pixel % it->w), it->y0 + (uint32_t)(pixel / it->w), t,
                     &b, &v, &at);

    if (what == ASKS_MATT)
        it->made[unit] = recordcache_make(it, &v, &at, b.medium, 0, t);
    if (what == ASKS_GLOSSY)
        it->reaches[other] = make_glossy(it, &v, &at, b.medium, t,
                                         it->shine + other * (size_t)it->glossy.basis.n);
}

/* Between phases, when no other thread works. False: memory, reported. */
static bool list_places(RecordCache *it)
{
    it->n = 0;
    for (uint8_t what = ASKS_MATT; what <= ASKS_GLOSSY; what++) {
        for (uint64_t i = 0; i < (uint64_t)it->w * it->h; i++)
            if (it->wanted[i] == what && !MEM_PUSH(it->places, it->n, it->cap_places, i))
                return false;
        if (what == ASKS_MATT)
            it->nmatt = it->n;
    }
    return mem_grow(&it->made, &it->cap_made, it->nmatt, sizeof *it->made) &&
           mem_grow(&it->reaches, &it->cap_reaches, it->n - it->nmatt, sizeof *it->reaches) &&
           mem_grow(&it->shine, &it->cap_shine,
                    (it->n - it->nmatt) * (size_t)it->glossy.basis.n, sizeof *it->shine);
}

static bool take_in(RecordCache *it)
{
    for (size_t i = 0; i < it->nmatt; i++)
        if (!irradiance_insert(&it->matt, &it->made[i]))
            return false;
    for (size_t i = 0; i < it->n - it->nmatt; i++)
        if (!radiance_insert(&it->glossy, &it->reaches[i],
                             it->shine + i * (size_t)it->glossy.basis.n))
            return false;
    it->n = it->nmatt = 0;
    return true;
}

uint64_t recordcache_units(Integrator *base, const Film *f, uint32_t pass, int phase)
{
    RecordCache *it = (RecordCache *)base;

    (void)f, (void)pass;
    if (phase < PHOTONMAPS_STAGES)
        return photonmaps_units(&it->maps, phase, &base->failed);
    phase -= PHOTONMAPS_STAGES;
    if (!it->overture || base->failed)
        return 0;
    base->failed = !(phase % 2 ? list_places(it) : take_in(it));
    if (base->failed || phase == 2 * SETS)
        return 0;
    return phase % 2 ? it->n : it->h;
}

void recordcache_run(Integrator *base, Film *f, uint32_t pass, int phase, uint64_t unit, Tracer *t)
{
    RecordCache *it = (RecordCache *)base;

    (void)f, (void)pass;
    phase -= PHOTONMAPS_STAGES;
    if (phase < 0)
        photonmaps_run(&it->maps, phase + PHOTONMAPS_STAGES, unit, t);
    else if (phase % 2)
        make(it, unit, t);
    else
        look(it, phase / 2, (uint32_t)unit, t);
}

/* ---- opening ---- */

bool recordcache_prepare(Integrator *base, const Film *f, uint64_t seed)
{
    RecordCache *it = (RecordCache *)base;
    Box around = base->scene->bounds;

    (void)seed;
    it->x0 = f->x0;
    it->y0 = f->y0;
    it->w = f->w;
    it->h = f->h;
    it->pixel = 2.0f * base->scene->radius / (float)f->full_w;
    if (!it->overture)
        return true;
    it->wanted = MEM_ARRAY(uint8_t, (size_t)f->w * f->h);
    return it->wanted && irradiance_init(&it->matt, around, it->a * it->overlap) &&
           (!it->bands || radiance_init(&it->glossy, around, it->a * it->overlap, it->bands));
}

void recordcache_clear(RecordCache *it)
{
    irradiance_clear(&it->matt);
    radiance_clear(&it->glossy);
    photonmaps_clear(&it->maps);
    lighting_clear(&it->lighting);
    mem_free(it->wanted);
    mem_free(it->places);
    mem_free(it->made);
    mem_free(it->reaches);
    mem_free(it->shine);
}

bool recordcache_open(RecordCache *it, const char *name, const Scene *s, const Opts *o)
{
    it->base.scene = s;
    it->ask = ask_store;
    it->overture = true;
    it->maxdepth = (int)opt_int(o, "maxdepth");
    it->roulette = (int)opt_int(o, "roulette");
    it->rays = (int)opt_int(o, "rays");
    it->a = opt_float(o, "accuracy");
    it->overlap = opt_float(o, "overlap");
    it->least = opt_float(o, "minspacing");
    it->most = f_max(it->least, opt_float(o, "maxspacing"));
    it->gradients = opt_bool(o, "gradients");
    if (!warn_of_scattering(s, name) || !lighting_init(&it->lighting, s, o, true, false) ||
        !photonmaps_open(&it->maps, s, o, it->maxdepth, 1, true))
        return false;
    lighting_shares(&it->lighting, 1, 1);
    return true;
}

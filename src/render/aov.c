/* aov.c -- extra pictures: what the eye ray meets first, the light apart by path length and by
 * strategy, and how sure it is. See aov.h.
 *
 * How         Each is a layer of the film, a sum over the samples of a pixel; most are its mean. Of
 *             some the ratio of two sums is what is wanted: the third component is the divisor
 *             then. Ids are such: they are taken once a pixel, from the ray through its middle,
 *             with 1 for a divisor, so that films which are added up still say the same.
 * Variance    Of the mean c of n independent samples: (E[c^2] - E[c]^2) / (n - 1) [Welford62]. Of
 *             stratified ones that is too much. Where light comes in splats it is the square of how
 *             far two halves of the passes lie apart, of luminance: true in the mean, and noisy. */
#include "render/aov.h"

#include "base/number.h"
#include "base/text.h"

#include <stdio.h>
#include <string.h>

#define AOVS(X) \
    X(NORMAL, "normal", "XYZ", "shading normal of what is met first, bumps included") \
    X(GEOMETRIC, "geometric", "XYZ", "normal of the geometry, of what is met first") \
    X(DEPTH, "depth", "Z", "distance to it along the ray; 0: nothing is met") \
    X(POSITION, "position", "XYZ", "where it is in the world") \
    X(ALBEDO, "albedo", "RGB", "share of light that it reflects, by colour") \
    X(PRIMITIVE, "primitive", "RGB", "from 1: number in its object; number of that in the world") \
    X(MATERIAL, "material", "Y", "from 1: number of its material; 0: nothing is met") \
    X(EMISSION, "emission", "RGB", "light that is seen straight away: paths of one edge") \
    X(DIRECT, "direct", "RGB", "light that was scattered once: paths of two edges") \
    X(INDIRECT, "indirect", "RGB", "light that was scattered more often: longer paths") \
    X(LENGTH, "length", "RGB", ":N; light by paths of N edges") \
    X(STRATEGY, "strategy", "RGB", ":NAME; by implicit, explicit, lens, merge or connect") \
    X(TECHNIQUE, "technique", "RGB", ":S,T; by paths of S vertices from a lamp, T from the eye") \
    X(UNWEIGHTED, "unweighted", "RGB", ":S,T; the same as if no other technique could make them") \
    X(RADIUS, "radius", "RGB", ":K; by the K-th of vcm's or bpm's radii") \
    X(EDGES, "edges", "Y", "mean edges of paths, each counted by its light") \
    X(VARIANCE, "variance", "RGB", "of a pixel's mean; :NAME of its emission, direct or indirect") \
    X(SAMPLES, "samples", "Y", "samples of each pixel")

#define DEFINE(id, name, channels, what) \
    static const AovInfo aov_##id = { { name, "", what, NULL }, AOV_##id, channels };
#define ENTRY(id, name, channels, what) &aov_##id,
AOVS(DEFINE)
const AovInfo *const aovs[] = { AOVS(ENTRY) NULL };

static const AovInfo *info_of(AovKind kind)
{
    int k = 0;
    while (aovs[k]->kind != kind)
        k++;
    return aovs[k];
}

/* ---- asking for them ---- */

static bool parse_length(Aov *a, const char *arg, size_t n)
{
    int64_t v;

    if (!n || number_int(arg, arg + n, &v, NULL) != n || v < 1 || v >= TALLY_LENGTHS)
        return err_usage("--aov length:N takes N from 1 to %d edges", TALLY_LENGTHS - 1);
    a->which = (int)v;
    return true;
}

static bool parse_strategy(Aov *a, const char *arg, size_t n)
{
    for (int k = 0; k < STRATEGIES; k++)
        if (strlen(strategy_names[k]) == n && !memcmp(strategy_names[k], arg, n)) {
            a->which = k;
            return true;
        }
    return err_usage("--aov strategy:NAME takes implicit, explicit, lens, merge or connect");
}

static bool parse_radius(Aov *a, const char *arg, size_t n)
{
    int64_t v;

    if (!n || number_int(arg, arg + n, &v, NULL) != n || v < 1 || v > TALLY_RADII)
        return err_usage("--aov radius:K takes K from 1 to %d", TALLY_RADII);
    a->which = (int)v - 1;
    return true;
}

/* At least one vertex is the eye's own, and lamps in plain view are met: so S + T > 1, T > 0, and
 * 1,1 is none. */
static bool parse_technique(Aov *a, const char *arg, size_t n)
{
    const char *comma = memchr(arg, ',', n), *end = arg + n;
    int64_t s = 0, t = 0;
    bool ok = comma && number_int(arg, comma, &s, NULL) == (size_t)(comma - arg) &&
              comma + 1 < end && number_int(comma + 1, end, &t, NULL) == (size_t)(end - comma - 1);

    if (!ok || s < 0 || t < 1 || s >= TALLY_LENGTHS || t >= TALLY_LENGTHS || s + t < 2 ||
        (s == 1 && t == 1))
        return err_usage("--aov %s:S,T takes vertices from the lamp, 0 to %d, and from the eye, 1 "
                         "to %d; 0,1 and 1,1 are no paths", info_of(a->kind)->info.name,
                         TALLY_LENGTHS - 1, TALLY_LENGTHS - 1);
    a->which = (int)(s * TALLY_LENGTHS + t);
    return true;
}

static bool parse_part(Aov *a, const char *arg, size_t n)
{
    static const AovKind parts[] = { AOV_EMISSION, AOV_DIRECT, AOV_INDIRECT };

    a->which = AOV_PICTURE;
    for (int k = 0; k < 3 && n; k++) {
        const char *name = info_of(parts[k])->info.name;
        if (strlen(name) == n && !memcmp(name, arg, n))
            a->which = (int)parts[k];
    }
    return !n || a->which != AOV_PICTURE ||
           err_usage("--aov variance:NAME takes emission, direct or indirect");
}

static bool parse_which(Aov *a, const char *arg, size_t n, bool colon)
{
    a->which = 0;
    switch (a->kind) {
    case AOV_LENGTH:   return parse_length(a, arg, n);
    case AOV_STRATEGY: return parse_strategy(a, arg, n);
    case AOV_VARIANCE: return parse_part(a, arg, n);
    case AOV_RADIUS:   return parse_radius(a, arg, n);
    case AOV_TECHNIQUE: case AOV_UNWEIGHTED: return parse_technique(a, arg, n);
    default:
        return !colon || err_usage("--aov %s takes nothing after ':'", info_of(a->kind)->info.name);
    }
}

bool aov_parse(Aov *a, const char *text)
{
    size_t name = strcspn(text, ":="), all = strcspn(text, "=");
    char word[40];
    const AovInfo *info;

    if (!text[all] || !text[all + 1])
        return err_usage("--aov takes NAME=FILE; see list aovs");
    a->file = text + all + 1;
    if (!image_format_for_writing(a->file))
        return false;
    word_copy(word, sizeof word, (Word){ text, name });
    info = kind_find_at((Place){ NULL, 0, 0 }, aovs, "--aov", word);
    if (!info)
        return false;
    a->kind = info->kind;
    a->of = 0;
    return parse_which(a, text + name + (name < all), all - name - (name < all), name < all);
}

const char *aov_layer(const Aov *a, char *name, size_t room)
{
    const char *sub = a->kind == AOV_STRATEGY ? strategy_names[a->which]
                    : a->kind == AOV_VARIANCE && a->which != AOV_PICTURE
                          ? info_of((AovKind)a->which)->info.name : "";
    char number[2 * NUMBER_MAX];

    if (a->kind == AOV_LENGTH || a->kind == AOV_RADIUS) {
        number_print_double(number, a->which + (a->kind == AOV_RADIUS));
        sub = number;
    } else if (a->kind == AOV_TECHNIQUE || a->kind == AOV_UNWEIGHTED) {
        snprintf(number, sizeof number, "%d-%d", a->which / TALLY_LENGTHS,
                 a->which % TALLY_LENGTHS);
        sub = number;
    }
    ASSERT(strlen(info_of(a->kind)->info.name) + strlen(sub) + 2 <= room);
    strcpy(name, info_of(a->kind)->info.name);
    return sub[0] ? strcat(strcat(name, "."), sub) : name;
}

const char *aov_channels(const Aov *a) { return info_of(a->kind)->channels; }

/* ---- what they need ---- */

static bool of_light(AovKind k)
{
    return k == AOV_LENGTH || k == AOV_STRATEGY || k == AOV_EMISSION || k == AOV_DIRECT ||
           k == AOV_INDIRECT || k == AOV_EDGES || k == AOV_TECHNIQUE || k == AOV_UNWEIGHTED ||
           k == AOV_RADIUS;
}

static bool of_hit(AovKind k)
{
    return k == AOV_NORMAL || k == AOV_GEOMETRIC || k == AOV_DEPTH || k == AOV_POSITION ||
           k == AOV_ALBEDO;
}

static bool is_id(AovKind k) { return k == AOV_PRIMITIVE || k == AOV_MATERIAL; }
static bool is_ratio(AovKind k) { return is_id(k) || k == AOV_EDGES; }

static bool any(const Aov *a, int n, bool (*is)(AovKind))
{
    for (int i = 0; i < n; i++)
        if (is(a[i].kind))
            return true;
    return false;
}

static bool of_technique(AovKind k) { return k == AOV_TECHNIQUE || k == AOV_UNWEIGHTED; }

bool aov_needs_tally(const Aov *a, int n) { return any(a, n, of_light); }
bool aov_needs_techniques(const Aov *a, int n) { return any(a, n, of_technique); }

/* Whether light by a path of so many edges, found so, belongs to it. */
static bool takes_path(const Aov *a, int edges, int how)
{
    switch (a->kind) {
    case AOV_LENGTH:   return a->which == edges;
    case AOV_STRATEGY: return a->which == how;
    case AOV_EMISSION: return edges <= 1;
    case AOV_DIRECT:   return edges == 2;
    case AOV_INDIRECT: return edges > 2;
    case AOV_TECHNIQUE:                 /* only those that are shown to the lens come by splats */
        return how == STRATEGY_LENS && a->which == edges * TALLY_LENGTHS + 1;
    default:           return false;
    }
}

void aov_layers(const Aov *a, int n, Canvas *c)
{
    for (int edges = 0; edges < TALLY_LENGTHS; edges++)
        for (int how = 0; how < STRATEGIES; how++) {
            c->layers[edges][how] = 1;
            for (int k = 0; k < n; k++)
                if (takes_path(&a[k], edges, how))
                    c->layers[edges][how] |= (uint32_t)2 << k;
        }
    for (int k = 0; k < n; k++) {
        if (a[k].kind == AOV_UNWEIGHTED && a[k].which % TALLY_LENGTHS == 1)
            c->bare[a[k].which / TALLY_LENGTHS] |= (uint32_t)2 << k;
        else if (a[k].kind == AOV_RADIUS)
            c->radius[a[k].which] |= (uint32_t)2 << k;
    }
}

/* ---- values of a sample ---- */

static Rgb of_vector(V3 v) { return rgb(v.x, v.y, v.z); }

static Rgb albedo_at(const Tracer *t, const Ray *r, const Surface *s)
{
    const Material *m = &t->scene->materials[s->shape->material];
    Frame f = material_frame(m, s);
    BsdfRoom room;
    const Bsdf *b = material_bsdf(m, s, &room);
    return b->kind->albedo(b, frame_in(&f, v_neg(r->d)));
}

/* Light apart by edges, as the tally has it. */
static Rgb light_value(const Aov *a, const Tally *t)
{
    Rgb sum = rgb_all(0.0f);
    int s = a->which / TALLY_LENGTHS, e = a->which % TALLY_LENGTHS;

    switch (a->kind) {
    case AOV_STRATEGY: return t->strategy[a->which];
    case AOV_RADIUS:   return t->radius[a->which];
    /* what is shown to the lens comes by splats */
    case AOV_TECHNIQUE:  return e > 1 ? t->technique[s][e].weighed : sum;
    case AOV_UNWEIGHTED: return e > 1 ? t->technique[s][e].bare : sum;
    default: break;
    }
    for (int edges = 0; edges < TALLY_LENGTHS; edges++)
        if (takes_path(a, edges, -1))
            sum = rgb_add(sum, t->length[edges]);
    return sum;
}

/* Mean edges: sum of edges times light, nothing, light. */
static Rgb edges_value(const Tally *t)
{
    float sum = 0.0f, light = 0.0f;

    for (int edges = 0; edges < TALLY_LENGTHS; edges++) {
        float lum = rgb_lum(t->length[edges]);
        sum += (float)edges * lum;
        light += lum;
    }
    return rgb(sum, 0.0f, light);
}

static Rgb id_value(AovKind kind, const Tracer *t, const Hit *h, const Ray *r)
{
    Surface s;

    if (kind == AOV_PRIMITIVE)
        return rgb((float)h->prim + 1.0f, (float)h->outer + 1.0f, 1.0f);
    accel_surface(t->scene->accel, r, h, &s);
    return rgb((float)s.shape->material + 1.0f, 0.0f, 1.0f);
}

static void id_values(const Aov *a, int n, const Ray *r, Tracer *t, Rgb *values)
{
    Hit h;
    bool hit = tracer_nearest(t, r, &h);

    for (int i = 0; i < n; i++)
        if (is_id(a[i].kind))
            values[i] = hit ? id_value(a[i].kind, t, &h, r) : rgb(0.0f, 0.0f, 1.0f);
}

static void hit_values(const Aov *a, int n, const Ray *r, Tracer *t, Rgb *values)
{
    Surface s;
    Hit h;

    if (!tracer_nearest(t, r, &h))
        return;
    accel_surface(t->scene->accel, r, &h, &s);
    for (int i = 0; i < n; i++)
        switch (a[i].kind) {
        case AOV_NORMAL:
            values[i] = of_vector(material_frame(&t->scene->materials[s.shape->material], &s).n);
            break;
        case AOV_GEOMETRIC: values[i] = of_vector(s.ng); break;
        case AOV_DEPTH:     values[i] = rgb_all(h.t); break;
        case AOV_POSITION:  values[i] = of_vector(s.p); break;
        case AOV_ALBEDO:    values[i] = albedo_at(t, r, &s); break;
        default: break;
        }
}

/* What a film still takes. */
static float squared(float x) { return f_min(x * x, 0x1p59f); }

void aov_values(const Aov *a, int n, const AovSample *s, Tracer *t, Rgb *values)
{
    for (int i = 0; i < n; i++) {
        values[1 + i] = rgb_all(0.0f);
        if (a[i].kind == AOV_EDGES)
            values[1 + i] = edges_value(t->tally);
        else if (of_light(a[i].kind))
            values[1 + i] = light_value(&a[i], t->tally);
    }
    if (any(a, n, of_hit))
        hit_values(a, n, &s->ray, t, values + 1);
    for (int i = 0; s->weight != 1.0f && i <= n; i++)
        values[i] = rgb_scale(values[i], s->weight);
    for (int i = 0; i < n; i++)
        if (a[i].kind == AOV_VARIANCE) {
            Rgb c = values[a[i].of];
            values[1 + i] = rgb(squared(c.r), squared(c.g), squared(c.b));
        }
    if (s->first && any(a, n, is_id))
        id_values(a, n, &s->middle, t, values + 1);
}

/* ---- pictures of them ---- */

static void divide(Image *im, AovKind kind)
{
    for (size_t i = 0; i < (size_t)im->w * im->h; i++) {
        Rgb *p = &im->pixels[i];
        float k = p->b != 0.0f ? 1.0f / p->b : 0.0f;
        *p = kind == AOV_PRIMITIVE ? rgb(p->r * k, p->g * k, 0.0f) : rgb_all(p->r * k);
    }
}

void aov_picture(const Aov *a, const Film *f, int k, Image *im)
{
    if (a->kind == AOV_SAMPLES)
        film_counts(f, im);
    else if (a->kind == AOV_VARIANCE)
        film_variance(f, a->of, 1 + k, im);
    else
        film_picture(f, 1 + k, im);
    if (is_ratio(a->kind))
        divide(im, a->kind);
}

/* Colours that tell numbers apart; 0 is black. */
static Rgb colour_of_id(Rgb id)
{
    Rng r = rng_seed((uint64_t)id.r + ((uint64_t)id.g << 32));
    float a = rng_unit(&r), b = rng_unit(&r), c = rng_unit(&r);
    return id.r > 0.0f ? rgb(0.1f + 0.9f * a, 0.1f + 0.9f * b, 0.1f + 0.9f * c) : rgb_all(0.0f);
}

/* Into the unit cube, all sides by the same factor. */
static void fit_positions(Image *im)
{
    Box box = box_empty();
    float most;

    for (size_t i = 0; i < (size_t)im->w * im->h; i++)
        if (!rgb_black(im->pixels[i]))
            box = box_point(box, v3(im->pixels[i].r, im->pixels[i].g, im->pixels[i].b));
    most = v_max3(v_sub(box.hi, box.lo));
    for (size_t i = 0; most > 0.0f && i < (size_t)im->w * im->h; i++) {
        Rgb *p = &im->pixels[i];
        if (!rgb_black(*p))
            *p = rgb((p->r - box.lo.x) / most, (p->g - box.lo.y) / most, (p->b - box.lo.z) / most);
    }
}

static void fit_numbers(Image *im)
{
    float most = 0.0f;

    for (size_t i = 0; i < (size_t)im->w * im->h; i++)
        most = f_max(most, im->pixels[i].r);
    for (size_t i = 0; most > 0.0f && i < (size_t)im->w * im->h; i++)
        im->pixels[i] = rgb_scale(im->pixels[i], 1.0f / most);
}

void aov_display(const Aov *a, Image *im)
{
    if (a->kind == AOV_POSITION)
        fit_positions(im);
    else if (a->kind == AOV_DEPTH || a->kind == AOV_SAMPLES || a->kind == AOV_EDGES)
        fit_numbers(im);
    for (size_t i = 0; i < (size_t)im->w * im->h; i++) {
        Rgb *p = &im->pixels[i];
        if (is_id(a->kind))
            *p = colour_of_id(*p);
        else if ((a->kind == AOV_NORMAL || a->kind == AOV_GEOMETRIC) && !rgb_black(*p))
            *p = rgb(0.5f + 0.5f * p->r, 0.5f + 0.5f * p->g, 0.5f + 0.5f * p->b);
    }
}

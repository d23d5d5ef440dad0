/* test_visibility.c -- maps of what hides the light, against a twin that keeps a byte a texel.
 *
 * Zones       a texel is uncertain exactly where one beside it is unlike; edges wrap or do not.
 * Agreement   the map of a pixel is that of its four nearest where these agree, for windows, sizes
 *             and spacings of all kinds; findings reach the pixels that they should, and no others.
 * Points      m, p: [Cline07 6.3], errata 6.0 to 6.3. */
#include "lightsampling/visibility.h"

#include "base/mem.h"
#include "base/random.h"
#include "test/test.h"

#include <stdlib.h>
#include <string.h>

enum { GRID_MOST = 40 };                /* maps in a row of the twin */

/* The slow way: a map is a byte a texel, found by its column and row in the whole picture's grid.
 * Findings are kept by tile and colour. */
typedef struct {
    Film film;
    int  size;
    uint32_t spacing;
    bool wraps, lazy;
    unsigned char *made;                /* [row][column][texel] */
    unsigned char *found;               /* [tile][colour][row][column][texel] */
} Twin;

static unsigned char *twin_made(const Twin *t, uint32_t column, uint32_t row)
{
    return t->made + ((size_t)row * GRID_MOST + column) * (size_t)(t->size * t->size);
}

static unsigned char *twin_found(const Twin *t, uint32_t x, uint32_t y, int colour,
                                 uint32_t column, uint32_t row)
{
    uint32_t tile = (y - t->film.y0) / FILM_TILE * t->film.tiles_x + (x - t->film.x0) / FILM_TILE;
    size_t map = (((size_t)tile * 2 + (size_t)colour) * GRID_MOST + row) * GRID_MOST + column;
    return t->found + map * (size_t)(t->size * t->size);
}

static bool neighbours(const Twin *t, int a, int b)
{
    int dx = abs(a % t->size - b % t->size), dy = abs(a / t->size - b / t->size);
    return (dx <= 1 || (t->wraps && dx == t->size - 1)) && dy <= 1;
}

static void twin_make(Twin *t, uint32_t column, uint32_t row, const bool *visible)
{
    int n = t->size * t->size;

    for (int a = 0; a < n; a++) {
        Zone z = visible[a] ? ZONE_VISIBLE : ZONE_OCCLUDED;
        for (int b = 0; b < n; b++)
            if (neighbours(t, a, b) && visible[a] != visible[b])
                z = ZONE_UNCERTAIN;
        twin_made(t, column, row)[a] = (unsigned char)z;
    }
}

static Zone twin_zone(const Twin *t, uint32_t x, uint32_t y, int texel)
{
    bool all = true, occluded = t->lazy, visible = false;

    for (uint32_t k = 0; k < 4; k++) {
        uint32_t column = x / t->spacing + k % 2, row = y / t->spacing + k / 2;
        Zone z = (Zone)twin_made(t, column, row)[texel];
        if (twin_found(t, x, y, (x + y) % 2, column, row)[texel])
            z = ZONE_UNCERTAIN;
        all = all && z != ZONE_UNCERTAIN;
        occluded |= z == ZONE_OCCLUDED;
        visible |= z == ZONE_VISIBLE;
    }
    if (!all || occluded == visible)    /* they disagree, or nobody knows */
        return ZONE_UNCERTAIN;
    return occluded ? ZONE_OCCLUDED : ZONE_VISIBLE;
}

static void twin_find(Twin *t, uint32_t x, uint32_t y, int texel)
{
    for (uint32_t k = 0; k < 4; k++)
        for (int b = 0; b < t->size * t->size; b++)
            if (neighbours(t, texel, b))
                twin_found(t, x, y, (x + y + 1) % 2, x / t->spacing + k % 2,
                           y / t->spacing + k / 2)[b] = 1;
}

static void begin(Twin *t, Visibility *v, Rng *r)
{
    uint32_t w = 1 + rng_below(r, 60), h = 1 + rng_below(r, 60), crop[4];
    static const int sizes[] = { 1, 2, 3, 4, 5, 8, 16 };
    size_t texels;

    memset(t, 0, sizeof *t);
    crop[0] = rng_below(r, w);
    crop[1] = rng_below(r, h);
    crop[2] = crop[0] + 1 + rng_below(r, w - crop[0]);
    crop[3] = crop[1] + 1 + rng_below(r, h - crop[1]);
    REQUIRE(film_init(&t->film, w, h, crop, 1), "memory");
    t->size = sizes[rng_below(r, 7)];
    t->spacing = 2 + rng_below(r, 20);
    t->wraps = rng_below(r, 2);
    t->lazy = rng_below(r, 2);
    texels = (size_t)(t->size * t->size);
    t->made = MEM_ARRAY(unsigned char, GRID_MOST * GRID_MOST * texels);
    t->found = MEM_ARRAY(unsigned char, 2 * GRID_MOST * GRID_MOST * texels *
                                            film_ntiles(&t->film));
    REQUIRE(t->made && t->found &&
            visibility_init(v, &t->film, t->size, t->spacing, t->wraps, t->lazy), "memory");
}

static void end(Twin *t, Visibility *v)
{
    film_clear(&t->film);
    mem_free(t->made);
    mem_free(t->found);
    visibility_clear(v);
}

/* Blots, all of one kind, or chance; some maps are never made. */
static void make_all(Twin *t, Visibility *v, Rng *r)
{
    bool visible[16 * 16];

    for (uint32_t k = 0; k < visibility_maps(v); k++) {
        uint32_t way = rng_below(r, 5), x, y, column = v->gx + k % v->gw, row = v->gy + k / v->gw;
        for (int i = 0; i < t->size * t->size; i++)
            visible[i] = way < 2 ? way == 1 : way == 2 ? rng_below(r, 2)
                       : i % t->size > t->size / 3;
        visibility_place(v, k, &x, &y);
        EXPECT(x == (column * t->spacing < t->film.full_w ? column * t->spacing
                                                          : t->film.full_w - 1) &&
               y == (row * t->spacing < t->film.full_h ? row * t->spacing : t->film.full_h - 1),
               "map %u stands at %u, %u", k, x, y);
        if (way == 4)
            continue;
        visibility_make(v, k, visible);
        twin_make(t, column, row, visible);
    }
}

static void expect_alike(const Twin *t, const Visibility *v, uint32_t x, uint32_t y)
{
    int open = 0, unlike = 0;
    VisibilityMap m;

    visibility_at(v, x, y, &m);
    for (int i = 0; i < t->size * t->size; i++) {
        V2 p = { ((float)(i % t->size) + 0.5f) / (float)t->size,
                 ((float)(i / t->size) + 0.5f) / (float)t->size };
        Zone z = twin_zone(t, x, y, i);
        unlike += visibility_zone(&m, p) != z;
        open += z != ZONE_OCCLUDED;
    }
    EXPECT(!unlike && m.open == open, "%u, %u: %d texels unlike, %d open and not %d", x, y, unlike,
           m.open, open);
}

static void find_some(Twin *t, Visibility *v, Rng *r)
{
    uint32_t x = t->film.x0 + rng_below(r, t->film.w), y = t->film.y0 + rng_below(r, t->film.h);
    VisibilityMap m;

    visibility_at(v, x, y, &m);
    for (uint32_t n = rng_below(r, 3); n > 0; n--) {
        V2 p = { rng_unit(r), rng_unit(r) };
        visibility_note(&m, p);
        twin_find(t, x, y, visibility_texel(t->size, p));
    }
    visibility_learn(v, x, y, &m);
}

static void twin(void)
{
    Rng r = rng_seed(7);

    for (int scene = 0; scene < 60; scene++) {
        Visibility v;
        Twin t;
        begin(&t, &v, &r);
        make_all(&t, &v, &r);
        for (int round = 0; round < 4; round++) {
            for (int k = 0; k < 40; k++)
                expect_alike(&t, &v, t.film.x0 + rng_below(&r, t.film.w),
                             t.film.y0 + rng_below(&r, t.film.h));
            for (int k = 0; k < 6; k++)
                find_some(&t, &v, &r);
        }
        expect_alike(&t, &v, t.film.x1 - 1, t.film.y1 - 1);
        end(&t, &v);
    }
}

/* A map by hand: one bright texel, in the middle and at an edge that wraps. */
static void borders(void)
{
    static const uint32_t crop[4] = { 0, 0, 1, 1 };
    bool visible[8 * 8] = { false };
    VisibilityMap m;
    Visibility v;
    Film f;

    REQUIRE(film_init(&f, 1, 1, crop, 1), "memory");
    for (int wraps = 0; wraps < 2; wraps++) {
        memset(visible, 0, sizeof visible);
        visible[3 * 8 + 7] = true;
        REQUIRE(visibility_init(&v, &f, 8, 8, wraps, false), "memory");
        for (uint32_t k = 0; k < visibility_maps(&v); k++)
            visibility_make(&v, k, visible);
        visibility_at(&v, 0, 0, &m);
        EXPECT(m.open == (wraps ? 9 : 6), "one texel at the edge opens %d", m.open);
        EXPECT(visibility_zone(&m, (V2){ 0.99f, 0.4f }) == ZONE_UNCERTAIN &&
               visibility_zone(&m, (V2){ 0.8f, 0.3f }) == ZONE_UNCERTAIN &&
               visibility_zone(&m, (V2){ 0.7f, 0.4f }) == ZONE_OCCLUDED &&
               visibility_zone(&m, (V2){ 0, 0.4f }) == (wraps ? ZONE_UNCERTAIN : ZONE_OCCLUDED),
               "zones about the texel");
        visibility_clear(&v);
    }
    for (int i = 0; i < 64; i++)
        visible[i] = true;
    REQUIRE(visibility_init(&v, &f, 8, 8, true, false), "memory");
    visibility_at(&v, 0, 0, &m);
    EXPECT(m.open == 64 && visibility_zone(&m, (V2){ 0.5f, 0.5f }) == ZONE_UNCERTAIN,
           "nobody looked: %d", m.open);
    visibility_make(&v, 0, visible);
    visibility_at(&v, 0, 0, &m);
    EXPECT(visibility_zone(&m, (V2){ 0.5f, 0.5f }) == ZONE_VISIBLE, "one looked");
    visibility_clear(&v);
    film_clear(&f);
}

/* What it takes, as the head of the file says. */
static void memory(void)
{
    static const uint32_t crop[4] = { 0, 0, 640, 480 };
    Visibility v;
    Film f;

    REQUIRE(film_init(&f, 640, 480, crop, 1), "memory");
    REQUIRE(visibility_init(&v, &f, 16, 8, false, false), "memory");
    EXPECT(visibility_bytes(&v) == 64 * (81 * 61 + 2 * 9 * 40 * 30), "%lu bytes",
           (unsigned long)visibility_bytes(&v));
    visibility_clear(&v);
    REQUIRE(visibility_init(&v, &f, 16, 8, false, true), "memory");
    EXPECT(visibility_maps(&v) == 0 && visibility_bytes(&v) == 64 * 2 * 9 * 40 * 30, "lazy");
    visibility_clear(&v);
    for (unsigned long k = 1; k <= 3; k++) {
        mem_fail_at(k, false);
        messages_quiet(true);
        EXPECT(!visibility_init(&v, &f, 16, 8, false, false), "allocation %lu failed", k);
        mem_fail_at(0, false);
    }
    film_clear(&f);
}

/* Every direction has its place and back; equal areas, so all z are alike. */
static void directions(void)
{
    Rng r = rng_seed(9);

    for (int i = 0; i < 20000; i++) {
        V2 p = { rng_unit(&r), rng_unit(&r) }, q;
        V3 w = visibility_direction(p);
        q = visibility_of_direction(w);
        EXPECT(fabsf(v_len(w) - 1) < 1e-5f, "length %g", (double)v_len(w));
        EXPECT(fabsf(q.y - p.y) < 1e-6f && fabsf(q.x - p.x) < 1e-3f, "%g %g became %g %g",
               (double)p.x, (double)p.y, (double)q.x, (double)q.y);
        EXPECT(q.x >= 0 && q.x < 1 && q.y >= 0 && q.y <= 1, "outside");
    }
    EXPECT(visibility_of_direction(v3(-1, -0.0f, 0)).x < 1, "the seam");
    EXPECT(visibility_of_direction(v3(0, 0, 1)).y == 0 &&
           visibility_of_direction(v3(0, 0, -1)).y == 1, "the poles");
}

/* The figures of errata 6.0 and 6.2. */
static void points(void)
{
    static const struct { float v, a; int m; float p; } said[] = {
        { 0.25f, 0.5f, 40, 0.2f }, { 0.5f, 0.5f, 24, 1 / 3.0f }, { 1, 0.5f, 16, 1 },
        { 1 / 64.0f, 0.5f, 520, 16 / 1040.0f }, { 0.25f, 1, 16, 1 }, { 0.5f, 0, 32, 0 },
        { 0, 0.5f, 16, 1 }, { 0, 0, 16, 1 }, { 1 / 256.0f, 0.5f, 1024, 8 / 1024.0f }
    };
    for (size_t i = 0; i < sizeof said / sizeof said[0]; i++) {
        Thinning t = thinning_of(16, said[i].v, said[i].a);
        EXPECT(t.points == said[i].m && fabsf(t.keep - said[i].p) < 1e-6f,
               "v %g, a %g: %d points, %g kept", (double)said[i].v, (double)said[i].a, t.points,
               (double)t.keep);
    }
    for (int n = 1; n < 40; n++)
        for (int k = 0; k <= 256; k++)
            for (float a = 0; a <= 1; a += 0.25f) {
                Thinning t = thinning_of(n, (float)k / 256, a);
                EXPECT(t.points >= n && t.points <= THINNING_MOST * n && t.keep >= 0 &&
                       t.keep <= 1 && (a == 0 || t.keep > 0), "n %d, k %d, a %g", n, k, (double)a);
                if (k > 0 && k < 256)       /* density of what stays, relative to n */
                    EXPECT(fabsf((float)t.points * t.keep - a * (float)n) < 1e-3f, "n a = m p");
            }
}

const TestCase test_visibility[] = {
    { "twin", twin, false }, { "borders", borders, false }, { "memory", memory, false },
    { "directions", directions, false }, { "points", points, false }, { NULL, NULL, false }
};

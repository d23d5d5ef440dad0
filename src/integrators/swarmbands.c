/* swarmbands.c -- the code of `swarmbands.h` */
#include "integrators/swarmbands.h"

#include "base/mem.h"

#include <string.h>

enum { NEIGHBOURS = 7, BEFORE = 1 };    /* BEFORE: the tile, as the last pass left it */
enum { NEAR = 2 };                      /* columns to either side that are neighbours */

struct Band {
    Bands  *all;                /* borrowed */
    Guide  *guide;              /* owned */
    float  *row[2];             /* owned: maps of pixels, by the last bit of y */
    float  *none;               /* owned: of one that knows nothing */
    float  *sums;               /* owned: of each tile in the row at hand, sums of its pixels' maps;
                                 * NULL: nobody asks */
    uint32_t y0, y1, first;     /* rows; the first one, of practice, is not the band's */
    uint32_t at;                /* pixels that are behind */
};

static size_t floats_of(const Band *b) { return (size_t)b->all->plan.floats; }
static uint32_t pixels_of(const Band *b) { return (b->y1 - b->first) * b->all->film->w; }

static float *maps_at(const Band *b, uint32_t y, int64_t x)
{
    return b->row[y & 1] + (size_t)x * floats_of(b);
}

static float *tile_at(const Band *b, float *row_of_tiles, uint32_t x)
{
    return row_of_tiles + (size_t)((x - b->all->film->x0) / FILM_TILE) * floats_of(b);
}

/* The row of tiles that holds y; those above the band, which another one changes, are as its
 * first. */
static uint32_t tile_row(const Band *b, uint32_t y)
{
    return ((y < b->y0 ? b->y0 : y) - b->all->film->y0) / FILM_TILE;
}

static float *tiles_of_row(const Band *b, uint32_t row)
{
    return b->all->tiles + (size_t)row * b->all->film->tiles_x * floats_of(b);
}

/* ---- pixel by pixel ---- */

/* Columns of a row in their order: rows run back and forth. */
static uint32_t column(const Band *b, uint32_t y, uint32_t k)
{
    return y & 1 ? b->all->film->w - 1 - k : k;
}

/* The pixels that are done of those seven: how many. */
static int neighbours(const Band *b, uint32_t x, uint32_t y, const float **of)
{
    int64_t w = b->all->film->w, at = x, step = y & 1 ? -1 : 1;
    int n = 0;

    for (int k = 1; k <= NEAR; k++)
        if (at - k * step >= 0 && at - k * step < w)
            of[n++] = maps_at(b, y, at - k * step);
    for (int64_t k = at - NEAR; k <= at + NEAR && y > b->first; k++)
        if (k >= 0 && k < w)
            of[n++] = maps_at(b, y - 1, k);
    return n;
}

/* Samples of a pass: their numbers, and whether they are for the picture. */
typedef struct { uint32_t first, n; bool keep; } Batch;

static void take_pixel(const Band *b, uint32_t column, uint32_t y, const Batch *s,
                       const Taker *taker)
{
    const float *of[NEIGHBOURS + BEFORE];
    float *maps = maps_at(b, y, column);
    uint32_t x = b->all->film->x0 + column;
    int count = neighbours(b, column, y, of);

    if (b->all->tiles && b->all->known[tile_row(b, y)])
        of[count++] = tile_at(b, tiles_of_row(b, tile_row(b, y)), x);
    if (!count)
        of[count++] = b->none;
    learned_mean(maps, of, count, b->all->plan.floats);
    guide_pixel(b->guide, taker->tracer, maps, x, y);
    for (uint32_t i = 0; i < s->n; i++)
        taker->take(taker->ctx, taker->tracer, x, y, s->first + i, s->keep);
    guide_learns(b->guide, taker->tracer);
    if (b->sums && s->keep)
        learned_sum(tile_at(b, b->sums, x), maps, b->all->plan.floats);
}

/* The row of tiles is done: what the next pass begins with. */
static void keep_tiles(const Band *b, uint32_t y)
{
    const Film *f = b->all->film;
    uint32_t row = tile_row(b, y), first = f->y0 + row * FILM_TILE;
    size_t floats = floats_of(b), n = f->tiles_x * floats;
    float *tiles = tiles_of_row(b, row);

    for (uint32_t k = 0; k < f->tiles_x; k++) {
        uint32_t across = f->w - k * FILM_TILE < FILM_TILE ? f->w - k * FILM_TILE : FILM_TILE;
        float share = 1.0f / (float)(across * (y + 1 - first));
        for (size_t i = k * floats; i < (k + 1) * floats; i++)
            tiles[i] = share * b->sums[i];
    }
    memset(b->sums, 0, n * sizeof *b->sums);
    b->all->known[row] = true;
}

/* The next pixel of the band. */
static void advance(Band *b, uint32_t first, uint32_t n, const Taker *taker)
{
    const Film *f = b->all->film;
    uint32_t y = b->first + b->at / f->w, k = b->at % f->w;
    Batch s = { first, n, y >= b->y0 };

    take_pixel(b, column(b, y, k), y, &s, taker);
    if (b->sums && s.keep && k + 1 == f->w && ((y + 1 - f->y0) % FILM_TILE == 0 || y + 1 == f->y1))
        keep_tiles(b, y);
    b->at++;
}

/* ---- bands ---- */

static void band_free(Band *b)
{
    if (!b)
        return;
    guide_free(b->guide);
    mem_free(b->row[0]);
    mem_free(b->row[1]);
    mem_free(b->none);
    mem_free(b->sums);
    mem_free(b);
}

/* NULL: memory, reported. */
static Band *band_new(Bands *all, uint32_t unit)
{
    const Film *f = all->film;
    size_t floats = (size_t)all->plan.floats;
    uint32_t rows = all->rows * FILM_TILE;
    Band *b = MEM_NEW(Band);

    if (!b)
        return NULL;
    b->all = all;
    b->y0 = f->y0 + unit * rows;
    b->y1 = f->y1 - b->y0 > rows ? b->y0 + rows : f->y1;
    b->first = unit ? b->y0 - 1 : b->y0;
    b->guide = guide_new(&all->plan);
    b->none = MEM_ARRAY(float, floats);
    for (int k = 0; k < 2; k++)
        b->row[k] = mem_array(f->w, floats * sizeof *b->row[k]);
    if (all->tiles)
        b->sums = mem_array(f->tiles_x, floats * sizeof *b->sums);
    if (!b->guide || !b->none || !b->row[0] || !b->row[1] || (all->tiles && !b->sums)) {
        band_free(b);
        return NULL;
    }
    guide_forget(&all->plan, b->none);
    return b;
}

bool bands_prepare(Bands *all, const Film *f, bool across)
{
    all->film = f;
    all->n = (f->tiles_y + all->rows - 1) / all->rows;
    all->ntiles_y = f->tiles_y;
    all->open = MEM_ARRAY(Band *, all->n);
    all->known = MEM_ARRAY(bool, f->tiles_y);
    if (across)
        all->tiles = mem_array(film_ntiles(f), (size_t)all->plan.floats * sizeof *all->tiles);
    return all->open && all->known && (all->tiles || !across);
}

void bands_clear(Bands *all)
{
    for (uint32_t i = 0; all->open && i < all->n; i++)
        band_free(all->open[i]);
    mem_free(all->open);
    mem_free(all->tiles);
    mem_free(all->known);
}

void bands_walk(Bands *all, uint32_t unit, uint32_t first, uint32_t n, const Taker *taker)
{
    Band *b = all->open[unit];

    if (!b)
        all->open[unit] = b = band_new(all, unit);
    if (!b) {
        taker->tracer->failed = true;
        return;
    }
    while (b->at < pixels_of(b)) {
        advance(b, first, n, taker);
        *taker->done = b->at;
        if (taker->late(taker->ctx))
            return;
    }
    all->open[unit] = NULL;
    band_free(b);
    *taker->done = UNIT_DONE;
}

/* ---- in files ---- */

static void save_floats(const float *v, size_t n, Saving *s)
{
    for (size_t i = 0; i < n; i++)
        save_float(s, v[i]);
}

/* False: one is nothing that a map could have learned. */
static bool load_floats(float *v, size_t n, Loading *l)
{
    bool sound = true;

    for (size_t i = 0; i < n; i++) {
        v[i] = load_float(l);
        sound = sound && v[i] >= 0.0f && v[i] <= LEARNED_MOST;
    }
    return sound;
}

/* Whether pixels to come may look at the maps at the column: of the row at hand, those done; of the
 * one above, what is not yet out of reach. */
static bool is_wanted(const Band *b, bool above, uint32_t at_column)
{
    uint32_t w = b->all->film->w, y = b->first + b->at / w, done = b->at % w;
    uint32_t k = column(b, y, at_column);       /* its own inverse */

    return above ? y > b->first && k + NEAR >= done : k < done;
}

/* How the maps that are wanted get into a file, or back; false: no further. */
typedef bool (*MoveMaps)(float *maps, size_t n, void *file);

static bool to_file(float *maps, size_t n, void *file)
{
    save_floats(maps, n, file);
    return true;
}

static bool from_file(float *maps, size_t n, void *file) { return load_floats(maps, n, file); }

static bool move_maps(const Band *b, MoveMaps move, void *file)
{
    uint32_t w = b->all->film->w, y = b->first + b->at / w;
    size_t n = floats_of(b);

    for (uint32_t x = 0; x < w; x++)            /* y + 1 is y - 1 by its last bit */
        if ((is_wanted(b, false, x) && !move(maps_at(b, y, x), n, file)) ||
            (is_wanted(b, true, x) && !move(maps_at(b, y + 1, x), n, file)))
            return false;
    return !b->sums || move(b->sums, b->all->film->tiles_x * n, file);
}

void bands_save(const Bands *all, Saving *s)
{
    size_t of_row = all->film->tiles_x * (size_t)all->plan.floats;

    for (uint32_t row = 0; all->tiles && row < all->ntiles_y; row++) {
        save_u32(s, all->known[row]);
        if (all->known[row])
            save_floats(all->tiles + row * of_row, of_row, s);
    }
    for (uint32_t i = 0; i < all->n; i++) {
        const Band *b = all->open[i];
        save_u32(s, b ? b->at : 0);
        if (b)
            move_maps(b, to_file, s);
    }
}

static bool load_band(Bands *all, uint32_t unit, Loading *l)
{
    uint32_t at = load_u32(l);
    Band *b;

    if (!at)
        return true;
    all->open[unit] = b = band_new(all, unit);
    if (!b || at >= pixels_of(b))
        return false;
    b->at = at;
    return move_maps(b, from_file, l) && !l->beyond;
}

bool bands_load(Bands *all, Loading *l)
{
    size_t of_row = all->film->tiles_x * (size_t)all->plan.floats;

    for (uint32_t row = 0; all->tiles && row < all->ntiles_y; row++) {
        all->known[row] = load_u32(l) != 0;
        if (all->known[row] && !load_floats(all->tiles + row * of_row, of_row, l))
            return false;
    }
    for (uint32_t i = 0; i < all->n; i++)
        if (!load_band(all, i, l))
            return false;
    return !l->beyond;
}

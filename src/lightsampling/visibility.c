/* visibility.c -- maps of what hides the light. See visibility.h. */
#include "lightsampling/visibility.h"

#include "base/mem.h"

enum { MAYBE_OCCLUDED = 0x55555555 };      /* of each texel of a word */

/* ---- the grid ---- */

/* Most maps in a row that the pixels of a tile have. The tiles go from `first` to `end`. */
static uint32_t most_in_tile(uint32_t first, uint32_t end, uint32_t spacing)
{
    uint32_t most = 0;

    for (uint32_t x = first; x < end; x += FILM_TILE) {
        uint32_t last = end - x > FILM_TILE ? x + FILM_TILE - 1 : end - 1;
        uint32_t n = last / spacing - x / spacing + 2;
        most = n > most ? n : most;
    }
    return most;
}

static void lay_grid(Visibility *v, const Film *f)
{
    uint32_t s = v->spacing;

    v->full_w = f->full_w;
    v->full_h = f->full_h;
    v->x0 = f->x0;
    v->y0 = f->y0;
    v->tiles_x = f->tiles_x;
    v->gx = f->x0 / s;
    v->gy = f->y0 / s;
    v->gw = (f->x1 - 1) / s - v->gx + 2;
    v->gh = (f->y1 - 1) / s - v->gy + 2;
    v->across = most_in_tile(f->x0, f->x1, s);
    v->down = most_in_tile(f->y0, f->y1, s);
}

bool visibility_init(Visibility *v, const Film *f, int size, uint32_t spacing, bool wraps,
                     bool lazy)
{
    memset(v, 0, sizeof *v);
    v->size = size;
    v->words = (size * size + TEXELS_A_WORD - 1) / TEXELS_A_WORD;
    v->wraps = wraps;
    v->spacing = spacing;
    lay_grid(v, f);
    v->nlearned = (size_t)film_ntiles(f) * v->across * v->down * (size_t)v->words;
    v->learned[0] = MEM_ARRAY(uint32_t, v->nlearned);
    v->learned[1] = v->learned[0] ? MEM_ARRAY(uint32_t, v->nlearned) : NULL;
    if (!lazy && v->learned[1]) {
        v->nmade = (size_t)v->gw * v->gh * (size_t)v->words;
        v->made = MEM_ARRAY(uint32_t, v->nmade);
    }
    if (v->learned[1] && (lazy || v->made))
        return true;
    visibility_clear(v);
    return false;
}

void visibility_clear(Visibility *v)
{
    mem_free(v->made);
    mem_free(v->learned[0]);
    mem_free(v->learned[1]);
    memset(v, 0, sizeof *v);
}

size_t visibility_bytes(const Visibility *v)
{
    return (v->nmade + 2 * v->nlearned) * sizeof *v->made;
}

void visibility_place(const Visibility *v, uint32_t k, uint32_t *x, uint32_t *y)
{
    *x = (v->gx + k % v->gw) * v->spacing;
    *y = (v->gy + k / v->gw) * v->spacing;
    *x = *x < v->full_w ? *x : v->full_w - 1;
    *y = *y < v->full_h ? *y : v->full_h - 1;
}

/* ---- texels ---- */

static void set_zone(uint32_t *map, int texel, Zone z)
{
    map[texel / TEXELS_A_WORD] |= (uint32_t)z << 2 * (texel % TEXELS_A_WORD);
}

/* The texels at (x, y) and around it, nine at most; returns how many. */
static int around(int size, bool wraps, int x, int y, int texel[9])
{
    int n = 0;

    for (int j = y - 1; j <= y + 1; j++)
        for (int i = x - 1; i <= x + 1; i++) {
            int at = wraps ? (i + size) % size : i;
            if (j >= 0 && j < size && at >= 0 && at < size)
                texel[n++] = j * size + at;
        }
    return n;
}

void visibility_make(Visibility *v, uint32_t k, const bool *visible)
{
    uint32_t *map = v->made + (size_t)k * (size_t)v->words;
    int texel[9];

    for (int y = 0; y < v->size; y++)
        for (int x = 0; x < v->size; x++) {
            bool own = visible[y * v->size + x], border = false;
            int n = around(v->size, v->wraps, x, y, texel);
            for (int i = 0; i < n; i++)
                border |= visible[texel[i]] != own;
            set_zone(map, y * v->size + x,
                     border ? ZONE_UNCERTAIN : own ? ZONE_VISIBLE : ZONE_OCCLUDED);
        }
}

/* ---- of a pixel ---- */

/* What the tile of pixel (x, y) has learned for its colour: the map at the upper left corner of the
 * pixel's cell. */
static size_t learned_at(const Visibility *v, uint32_t x, uint32_t y)
{
    uint32_t tx = (x - v->x0) / FILM_TILE, ty = (y - v->y0) / FILM_TILE;
    uint32_t column = x / v->spacing - (v->x0 + tx * FILM_TILE) / v->spacing;
    uint32_t row = y / v->spacing - (v->y0 + ty * FILM_TILE) / v->spacing;
    size_t tile = (size_t)ty * v->tiles_x + tx;

    return ((tile * v->down + row) * v->across + column) * (size_t)v->words;
}

static int colour_of(uint32_t x, uint32_t y) { return (int)((x ^ y) & 1); }

/* Adds the bits of four maps: at map, beside it, and a row of `across` maps further on. */
static void join_four(uint32_t *to, const uint32_t *map, uint32_t across, int words)
{
    const uint32_t *below = map + (size_t)across * (size_t)words;

    for (int i = 0; i < words; i++)
        to[i] |= map[i] | map[i + words] | below[i] | below[i + words];
}

/* Nobody knows: uncertain. What is left is counted. */
static void settle(const Visibility *v, VisibilityMap *m)
{
    int texels = v->size * v->size, occluded = 0;

    for (int i = 0; i < v->words; i++) {
        uint32_t z = m->zone[i], none = ~(z | z >> 1) & MAYBE_OCCLUDED;
        z |= 3 * none;
        if ((i + 1) * TEXELS_A_WORD > texels)           /* beyond the last texel */
            z &= ((uint32_t)1 << 2 * (texels % TEXELS_A_WORD)) - 1;
        m->zone[i] = z;
        occluded += COUNT_BITS(z & ~(z >> 1) & MAYBE_OCCLUDED);
    }
    m->open = texels - occluded;
}

void visibility_at(const Visibility *v, uint32_t x, uint32_t y, VisibilityMap *m)
{
    uint32_t k = (y / v->spacing - v->gy) * v->gw + x / v->spacing - v->gx;

    m->size = v->size;
    m->wraps = v->wraps;
    m->noted = 0;
    memset(m->found, 0, (size_t)v->words * sizeof m->found[0]);
    for (int i = 0; i < v->words; i++)
        m->zone[i] = v->made ? 0 : MAYBE_OCCLUDED;
    if (v->made)
        join_four(m->zone, v->made + (size_t)k * (size_t)v->words, v->gw, v->words);
    join_four(m->zone, v->learned[colour_of(x, y)] + learned_at(v, x, y), v->across, v->words);
    settle(v, m);
}

void visibility_note(VisibilityMap *m, V2 p)
{
    int k = visibility_texel(m->size, p), texel[9];
    int n = around(m->size, m->wraps, k % m->size, k / m->size, texel);

    for (int i = 0; i < n; i++)
        set_zone(m->found, texel[i], ZONE_UNCERTAIN);
    m->noted++;
}

void visibility_learn(Visibility *v, uint32_t x, uint32_t y, const VisibilityMap *m)
{
    uint32_t *map = v->learned[!colour_of(x, y)] + learned_at(v, x, y);
    uint32_t *below = map + (size_t)v->across * (size_t)v->words;

    for (int i = 0; m->noted && i < v->words; i++) {
        map[i] |= m->found[i];
        map[i + v->words] |= m->found[i];
        below[i] |= m->found[i];
        below[i + v->words] |= m->found[i];
    }
}

/* ---- directions ---- */

V2 visibility_of_direction(V3 w)
{
    float turn = m_atan2(w.y, w.x) * (0.5f / PI_F);

    turn = turn < 0.0f ? turn + 1.0f : turn;
    return (V2){ turn < 1.0f ? turn : 0.0f, clamp01(0.5f - 0.5f * w.z) };
}

V3 visibility_direction(V2 p)
{
    float z = 1.0f - 2.0f * p.y, r = sqrtf(f_max(0.0f, 1.0f - z * z)), sn, cs;

    m_sincos_turn(p.x, &sn, &cs);
    return v3(r * cs, r * sn, z);
}

/* ---- how many points ---- */

Thinning thinning_of(int n, float v, float a)
{
    double m;
    Thinning t = { n, 1.0f };

    if (!(v > 0.0f))
        return t;
    m = n * ((double)v + (1.0 - (double)v) * (1.0 - (double)a)) / (double)v;
    m = m < (double)THINNING_MOST * n ? m : (double)THINNING_MOST * n;
    t.points = (int)(m + 0.5);
    t.keep = v < 1.0f ? (float)n * a / (float)t.points : 1.0f;
    return t;
}

/* ---- in files ---- */

void visibility_save(const Visibility *v, Saving *s)
{
    for (int k = 0; k < 2; k++)
        for (size_t i = 0; i < v->nlearned; i++)
            save_u32(s, v->learned[k][i]);
}

bool visibility_load(Visibility *v, Loading *l)
{
    for (int k = 0; k < 2; k++)
        for (size_t i = 0; i < v->nlearned; i++)
            v->learned[k][i] = load_u32(l);
    return !l->beyond;
}

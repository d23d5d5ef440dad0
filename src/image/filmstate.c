/* filmstate.c -- films in files, bit by bit, and the sum of two films. See film.h.
 *
 * Sums        are exact, so a film that is added up of parts is that of all their samples, whatever
 *             the order.
 * Noise       is another matter: the marks and the passes of film.c are of one sequence of samples.
 *             Of a sum of films nobody knows them, and film_error means nothing; whoever adds films
 *             up may ask each of them before. */
#include "base/archive.h"
#include "image/splats.h"

static size_t pixels_of(const Film *f) { return (size_t)f->w * f->h; }

/* ---- what films are of ---- */

void film_save_shape(const Film *f, Saving *s)
{
    const uint32_t shape[] = { f->full_w, f->full_h, f->x0, f->y0, f->x1, f->y1,
                               (uint32_t)f->layers, f->splats != NULL };

    for (size_t k = 0; k < sizeof shape / sizeof *shape; k++)
        save_u32(s, shape[k]);
}

bool film_load_shape(FilmShape *p, Loading *l)
{
    p->w = load_u32(l);
    p->h = load_u32(l);
    for (int k = 0; k < 4; k++)
        p->crop[k] = load_u32(l);
    p->layers = load_u32(l);
    p->splats = load_u32(l) != 0;
    return !l->beyond && p->crop[0] < p->crop[2] && p->crop[1] < p->crop[3] &&
           p->crop[2] <= p->w && p->crop[3] <= p->h && p->layers >= 1 &&
           p->layers <= FILM_LAYERS_MOST;
}

double film_bytes_saved(const FilmShape *p)
{
    double pixels = (double)(p->crop[2] - p->crop[0]) * (p->crop[3] - p->crop[1]);
    return pixels * (48.0 * p->layers * (p->splats ? 2 : 1) + 4 + 4 * FILM_MARKS);
}

bool film_has_shape(const Film *f, const FilmShape *p)
{
    return f->full_w == p->w && f->full_h == p->h && f->x0 == p->crop[0] && f->y0 == p->crop[1] &&
           f->x1 == p->crop[2] && f->y1 == p->crop[3] && (uint32_t)f->layers == p->layers &&
           (f->splats != NULL) == p->splats;
}

/* ---- what they hold ---- */

void exact_save(const Exact *e, size_t n, Saving *s)
{
    for (size_t i = 0; i < n; i++) {
        save_u64(s, e[i].lo);
        save_u64(s, e[i].hi);
    }
}

void exact_load(Exact *e, size_t n, Loading *l)
{
    for (size_t i = 0; i < n; i++) {
        e[i].lo = load_u64(l);
        e[i].hi = load_u64(l);
    }
}

void film_save(const Film *f, Saving *s)
{
    size_t n = pixels_of(f);

    exact_save(f->sums, n * 3 * (size_t)f->layers, s);
    for (size_t i = 0; i < n; i++)
        save_u32(s, f->counts[i]);
    for (size_t i = 0; i < n * FILM_MARKS; i++)
        save_float(s, f->marks[i]);
    for (uint32_t k = 0; k < film_ntiles(f); k++) {
        const TileStats *t = &f->tiles[k];
        save_double(s, t->sum);
        save_double(s, t->squares);
        save_u64(s, t->samples);
        save_u64(s, t->refused);
        save_u32(s, t->bad_x);
        save_u32(s, t->bad_y);
        save_u32(s, t->bad_index);
    }
    save_u32(s, f->passes);
    if (f->splats)
        splats_save(f->splats, n * 3 * (size_t)f->layers, s);
}

bool film_load(Film *f, Loading *l)
{
    size_t n = pixels_of(f);

    exact_load(f->sums, n * 3 * (size_t)f->layers, l);
    for (size_t i = 0; i < n; i++)
        f->counts[i] = load_u32(l);
    for (size_t i = 0; i < n * FILM_MARKS; i++)
        f->marks[i] = load_float(l);
    for (uint32_t k = 0; k < film_ntiles(f); k++) {
        TileStats *t = &f->tiles[k];
        t->sum = load_double(l);
        t->squares = load_double(l);
        t->samples = load_u64(l);
        t->refused = load_u64(l);
        t->bad_x = load_u32(l);
        t->bad_y = load_u32(l);
        t->bad_index = load_u32(l);
    }
    f->passes = load_u32(l);
    if (f->splats)
        splats_load(f->splats, n * 3 * (size_t)f->layers, l);
    return !l->beyond;
}

/* ---- sums of films ---- */

static void join_tiles(TileStats *to, const TileStats *from)
{
    if (!to->refused && from->refused) {
        to->bad_x = from->bad_x;
        to->bad_y = from->bad_y;
        to->bad_index = from->bad_index;
    }
    to->refused += from->refused;
    to->samples += from->samples;
    to->sum += from->sum;
    to->squares += from->squares;
}

void film_join(Film *f, const Film *other)
{
    size_t n = pixels_of(f);

    for (size_t i = 0; i < n * 3 * (size_t)f->layers; i++)
        exact_join(&f->sums[i], &other->sums[i]);
    for (size_t i = 0; i < n; i++)
        f->counts[i] += other->counts[i];
    for (uint32_t k = 0; k < film_ntiles(f); k++)
        join_tiles(&f->tiles[k], &other->tiles[k]);
    if (f->splats)
        splats_join(f->splats, other->splats, n * 3 * (size_t)f->layers);
}

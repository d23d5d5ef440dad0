/* rayfile.c -- files of rays. The format is in cast.h; numbers are read as bytes, so that either
 * byte order will do and no alignment is asked for. */
#include "render/cast.h"

#include "base/bits.h"
#include "base/file.h"

#include <string.h>

enum { KIND_AT = 8, QUERY_AT = 24, ZERO_AT = 28, COUNT_AT = 32, HITS_AT = 40, SUM_AT = 48,
       HEAD = 56, RECORD = 32, NUMBERS = 8 };

void rayset_clear(RaySet *s)
{
    mem_free(s->rays);
    mem_free(s->tmin);
    mem_free(s->t);
    memset(s, 0, sizeof *s);
}

/* ---- reading ---- */

typedef struct {
    Place at;
    const unsigned char *bytes;
    size_t size;
    bool   big;                 /* the most significant byte stands first */
} RayFile;

static uint32_t word32(const RayFile *f, size_t at)
{
    const unsigned char *b = f->bytes + at;
    uint32_t x = 0;
    for (int k = 0; k < 4; k++)
        x |= (uint32_t)b[k] << 8 * (f->big ? 3 - k : k);
    return x;
}

static uint64_t word64(const RayFile *f, size_t at)
{
    uint64_t first = word32(f, at), second = word32(f, at + 4);
    return f->big ? first << 32 | second : second << 32 | first;
}

/* The name goes to a terminal. */
static void read_kind(const RayFile *f, RaySet *s)
{
    for (int k = 0; k < 16 && f->bytes[KIND_AT + k]; k++) {
        unsigned char c = f->bytes[KIND_AT + k];
        s->kind[k] = c > ' ' && c < 127 ? (char)c : '?';
    }
    if (!s->kind[0])
        strcpy(s->kind, "rays");
}

/* The whole head, and the size of the file, before any memory is taken by its count. */
static bool read_head(RayFile *f, RaySet *s)
{
    uint64_t count;

    if (f->size < 4 || memcmp(f->bytes, "RAYS", 4))
        return err_at(f->at, "not a file of rays, 'RAYS' was expected at its beginning");
    if (f->size < HEAD)
        return err_at(f->at, "has %lu bytes, a head of %d was expected", (unsigned long)f->size,
                      HEAD);
    f->big = f->bytes[4] == 0;
    if (word32(f, 4) != 1)
        return err_at(f->at, "byte 4: the version is %lu, expected 1",
                      (unsigned long)word32(f, 4));
    if (word32(f, QUERY_AT) > 1 || word32(f, ZERO_AT))
        return err_at(f->at, "byte %d: the query is %lu and %lu, expected 0 (nearest) or 1 (any), "
                      "and 0", QUERY_AT, (unsigned long)word32(f, QUERY_AT),
                      (unsigned long)word32(f, ZERO_AT));
    count = word64(f, COUNT_AT);
    if (count != (f->size - HEAD) / RECORD || (f->size - HEAD) % RECORD)
        return err_at(f->at, "byte %d: the count is %llu, but %lu bytes follow the head, expected "
                      "%d a ray", COUNT_AT, (unsigned long long)count,
                      (unsigned long)(f->size - HEAD), RECORD);
    read_kind(f, s);
    s->any = word32(f, QUERY_AT) == 1;
    s->n = (size_t)count;
    s->file_hits = word64(f, HITS_AT);
    s->file_sum_t = double_of(word64(f, SUM_AT));
    return true;
}

/* What is wrong with a ray; NULL: nothing. */
static const char *read_ray(const RayFile *f, size_t at, Ray *r, float *tmin)
{
    float v[NUMBERS];

    for (int k = 0; k < NUMBERS; k++) {
        v[k] = float_of(word32(f, at + 4 * (size_t)k));
        if (!is_finite(v[k]) && (k < NUMBERS - 1 || !(v[k] > 0)))
            return "a number is not finite (tmax may be infinite)";
    }
    *r = (Ray){ .o = v3(v[0], v[1], v[2]), .d = v3(v[3], v[4], v[5]), .tmax = v[7] };
    *tmin = v[6];
    if (!(v_max3(v_abs(r->d)) > 0.0f))
        return "the direction is 0";
    if (v[6] > v[7])
        return "tmin is above tmax, expected tmin <= tmax";
    if (v[6] != 0.0f) {
        r->o = v_mad(r->d, v[6], r->o);
        r->tmax = v[7] - v[6];
    }
    return v_finite(r->o) ? NULL : "the point at tmin is beyond the range of floats";
}

static bool read_rays(const RayFile *f, RaySet *s)
{
    size_t moved = 0;

    s->rays = MEM_ARRAY(Ray, s->n);
    s->tmin = MEM_ARRAY(float, s->n);
    if (!s->rays || !s->tmin)
        return false;
    for (size_t i = 0; i < s->n; i++) {
        size_t at = HEAD + RECORD * i;
        const char *wrong = read_ray(f, at, &s->rays[i], &s->tmin[i]);
        if (wrong)
            return err_at(f->at, "ray %lu at byte %lu: %s", (unsigned long)i, (unsigned long)at,
                          wrong);
        moved += s->tmin[i] != 0.0f;
    }
    if (!moved) {
        mem_free(s->tmin);
        s->tmin = NULL;
        return true;
    }
    return warn_at(f->at, "%lu of %lu rays have a tmin other than 0: they are cast from o + tmin "
                   "d, and their t is counted from o", (unsigned long)moved, (unsigned long)s->n);
}

bool rayset_read(RaySet *s, const char *path, uint64_t limit)
{
    RayFile f = { { path, 0, 0 }, NULL, 0, false };
    FileBytes file;
    bool ok;

    memset(s, 0, sizeof *s);
    if (!file_read(path, limit, &file))
        return false;
    f.bytes = (const unsigned char *)file.bytes;
    f.size = file.size;
    ok = read_head(&f, s) && read_rays(&f, s);
    file_clear(&file);
    if (!ok)
        rayset_clear(s);
    s->file = path;
    return ok;
}

/* ---- writing ---- */

bool rayset_write(const RaySet *s, const char *path)
{
    unsigned char head[HEAD] = "RAYS";
    uint32_t version = 1, query = s->any;
    uint64_t count = s->n;
    Out *o = out_open(path);

    if (!o)
        return false;
    memcpy(head + 4, &version, 4);
    memcpy(head + KIND_AT, s->kind, 16);
    memcpy(head + QUERY_AT, &query, 4);
    memcpy(head + COUNT_AT, &count, 8);
    memcpy(head + HITS_AT, &s->hits, 8);
    memcpy(head + SUM_AT, &s->sum_t, 8);
    out_write(o, head, HEAD);
    for (size_t i = 0; i < s->n; i++) {
        const Ray *r = &s->rays[i];
        float v[NUMBERS] = { r->o.x, r->o.y, r->o.z, r->d.x, r->d.y, r->d.z, 0, r->tmax };
        out_write(o, v, sizeof v);
    }
    return out_close(o);
}

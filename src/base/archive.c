/* archive.c -- the code of `archive.h`. */
#include "base/archive.h"

#include "base/error.h"

enum { SUM_BYTES = 8 };

bool save_begin(Saving *s, const char *path)
{
    s->sum = DIGEST_NOTHING;
    s->out = out_open(path);
    return s->out != NULL;
}

void save_bytes(Saving *s, const void *bytes, size_t n)
{
    s->sum = digest(s->sum, bytes, n);
    out_write(s->out, bytes, n);
}

void save_u32(Saving *s, uint32_t v)
{
    unsigned char b[4];
    for (int k = 0; k < 4; k++)
        b[k] = (unsigned char)(v >> 8 * k);
    save_bytes(s, b, sizeof b);
}

void save_u64(Saving *s, uint64_t v)
{
    unsigned char b[8];
    for (int k = 0; k < 8; k++)
        b[k] = (unsigned char)(v >> 8 * k);
    save_bytes(s, b, sizeof b);
}

bool save_end(Saving *s)
{
    save_u64(s, s->sum);
    return out_close(s->out);
}

/* ---- reading ---- */

bool load_begin(Loading *l, const char *path, uint64_t limit)
{
    if (!file_read(path, limit, &l->file))
        return false;
    l->at = (const unsigned char *)l->file.bytes;
    l->end = l->at + (l->file.size < SUM_BYTES ? 0 : l->file.size - SUM_BYTES);
    l->beyond = false;
    return true;
}

bool load_whole(const Loading *l, const char *path)
{
    const char *bytes = l->file.bytes, *end = (const char *)l->end;
    Loading sum = { .at = l->end, .end = (const unsigned char *)bytes + l->file.size };

    if (load_u64(&sum) == digest(DIGEST_NOTHING, bytes, (size_t)(end - bytes)) && !sum.beyond)
        return true;
    return err_at((Place){ path, 0, 0 }, "is damaged or not whole");
}

void load_clear(Loading *l)
{
    file_clear(&l->file);
    l->at = l->end = NULL;
}

const char *load_bytes(Loading *l, size_t n)
{
    const unsigned char *p = l->at;

    if (n > load_left(l)) {
        l->beyond = true;
        l->at = l->end;
        return NULL;
    }
    l->at += n;
    return (const char *)p;
}

/* n bytes, the least first. */
static uint64_t load_number(Loading *l, size_t n)
{
    const unsigned char *p = (const unsigned char *)load_bytes(l, n);
    uint64_t v = 0;

    for (size_t k = 0; p && k < n; k++)
        v |= (uint64_t)p[k] << 8 * k;
    return v;
}

uint32_t load_u32(Loading *l) { return (uint32_t)load_number(l, 4); }
uint64_t load_u64(Loading *l) { return load_number(l, 8); }

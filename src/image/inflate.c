/* inflate.c -- unpacks zlib streams. See inflate.h.
 *
 * Source      [RFC1950] the zlib frame, [RFC1951] deflate.
 * How         A small machine: it is at the head of a block, among stored bytes or among codes, or
 *             at the sum that ends the stream, and can stop after any byte. A code of up to
 *             INFLATE_FAST bits is one look into a table; a longer one is found by its length:
 *             canonical codes of one length are consecutive numbers.
 * Invariant   Every stream is answered in bounded time: a step takes at least one bit of input or
 *             makes a byte. What zlib refuses is refused: codes that more symbols share than fit,
 *             codes with gaps (but for a single one of one bit), blocks without an end, distances
 *             before the first byte. */
#include "image/inflate.h"

#include "image/deflate.h"

#include <string.h>

enum { HEAD, STORED, CODES, SUM, DONE };
enum { LITERALS = 286, DISTANCES = 30, LENGTHS = 19, END = 256, LONGEST = 15 };

/* Of no meaning where the value is not used any more. */
static unsigned fail(Inflate *f, const char *what)
{
    if (!f->fault)
        f->fault = what;
    return 0;
}

/* ---- bits ---- */

static void fill(Inflate *f)
{
    while (f->nbits <= 56) {
        if (f->at == f->end && !f->more(f->ctx, &f->at, &f->end))
            return;
        if (f->at == f->end)
            continue;
        f->bits |= (uint64_t)*f->at++ << f->nbits;
        f->nbits += 8;
    }
}

/* The next n <= 16 bits; zeros stand behind the end of the input. */
static unsigned peek(Inflate *f, unsigned n)
{
    if (f->nbits < n)
        fill(f);
    return (unsigned)f->bits & ((1u << n) - 1);
}

static void drop(Inflate *f, unsigned n)
{
    if (f->nbits < n) {
        fail(f, "ends early");
        return;
    }
    f->bits >>= n;
    f->nbits -= n;
}

static unsigned take(Inflate *f, unsigned n)
{
    unsigned v = peek(f, n);
    drop(f, n);
    return v;
}

/* ---- codes ---- */

static void make_fast(InflateCode *c, const uint8_t *length, int n)
{
    unsigned next[LONGEST + 1] = { 0 };

    for (int k = 1; k < LONGEST; k++)
        next[k + 1] = (next[k] + c->count[k]) << 1;
    memset(c->fast, 0, sizeof c->fast);
    for (int s = 0; s < n; s++) {
        unsigned k = length[s], code, reversed = 0;
        if (k == 0 || k > INFLATE_FAST)
            continue;
        code = next[k]++;
        for (unsigned i = 0; i < k; i++)                /* codes are sent from their first bit on */
            reversed |= (code >> i & 1) << (k - 1 - i);
        for (unsigned i = reversed; i < 1u << INFLATE_FAST; i += 1u << k)
            c->fast[i] = (uint16_t)((unsigned)s << 4 | k);
    }
}

/* Canonical codes of given lengths [RFC1951 3.2.2]. False: no prefix code has them. */
static bool make_code(InflateCode *c, const uint8_t *length, int n, bool may_have_gaps)
{
    uint16_t first[LONGEST + 2] = { 0 };
    int left = 1, longest = 0;

    memset(c->count, 0, sizeof c->count);
    for (int s = 0; s < n; s++)
        c->count[length[s]]++;
    c->count[0] = 0;
    for (int k = 1; k <= LONGEST; k++) {
        left = 2 * left - c->count[k];
        if (left < 0)
            return false;
        if (c->count[k])
            longest = k;
        first[k + 1] = (uint16_t)(first[k] + c->count[k]);
    }
    if (left > 0 && (longest > 1 || !may_have_gaps))
        return false;
    for (int s = 0; s < n; s++)
        if (length[s])
            c->symbol[first[length[s]]++] = (uint16_t)s;
    make_fast(c, length, n);
    return true;
}

static unsigned next_symbol(Inflate *f, const InflateCode *c)
{
    unsigned next = peek(f, LONGEST), entry = c->fast[next & ((1u << INFLATE_FAST) - 1)];
    unsigned code = 0, first = 0, index = 0;

    if (entry) {
        drop(f, entry & 15);
        return entry >> 4;
    }
    for (unsigned k = 1; k <= LONGEST; k++, next >>= 1) {
        code |= next & 1;
        if (code - first < c->count[k]) {
            drop(f, k);
            return c->symbol[index + (code - first)];
        }
        index += c->count[k];
        first = (first + c->count[k]) << 1;
        code <<= 1;
    }
    return fail(f, f->nbits < LONGEST ? "ends early" : "has a code of no meaning");
}

static bool fixed_codes(Inflate *f)                     /* [RFC1951 3.2.6] */
{
    uint8_t length[288];

    for (int s = 0; s < 288; s++)
        length[s] = s < 144 ? 8 : s < 256 ? 9 : s < 280 ? 7 : 8;
    make_code(&f->literals, length, 288, false);
    memset(length, 5, 32);
    return make_code(&f->distances, length, 32, false);
}

/* Lengths of codes, which are packed themselves [RFC1951 3.2.7]. */
static bool read_lengths(Inflate *f, uint8_t *length, unsigned n)
{
    unsigned i = 0;

    while (i < n) {
        unsigned s = next_symbol(f, &f->distances), run = 1;
        uint8_t value = (uint8_t)s;
        if (s >= 16) {
            run = s == 16 ? 3 + take(f, 2) : s == 17 ? 3 + take(f, 3) : 11 + take(f, 7);
            value = s == 16 && i ? length[i - 1] : 0;
        }
        if (f->fault)
            return false;
        if (run > n - i || (s == 16 && i == 0)) {
            fail(f, "has a repetition of code lengths out of place");
            return false;
        }
        memset(length + i, value, run);
        i += run;
    }
    return true;
}

static bool own_codes(Inflate *f)
{
    static const uint8_t order[LENGTHS] = {
        16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15
    };
    uint8_t length[LITERALS + DISTANCES], head[LENGTHS] = { 0 };
    unsigned literals = 257 + take(f, 5), distances = 1 + take(f, 5), n = 4 + take(f, 4);

    for (unsigned i = 0; i < n; i++)
        head[order[i]] = (uint8_t)take(f, 3);
    if (f->fault || literals > LITERALS || distances > DISTANCES)
        return fail(f, "has a block of more codes than there are");
    if (!make_code(&f->distances, head, LENGTHS, false))
        return fail(f, "has code lengths that make no code");
    if (!read_lengths(f, length, literals + distances))
        return false;
    if (!length[END] || !make_code(&f->literals, length, (int)literals, true) ||
        !make_code(&f->distances, length + literals, (int)distances, true))
        return fail(f, "has code lengths that make no code");
    return true;
}

/* ---- blocks ---- */

static void begin(Inflate *f)                           /* [RFC1950 2.2] */
{
    unsigned method = take(f, 8), flags = take(f, 8);

    if (f->fault || (method & 15) != 8 || method >> 4 > 7 || (method << 8 | flags) % 31 ||
        flags & 32)
        fail(f, "does not begin as one");
}

static void begin_block(Inflate *f)
{
    unsigned type, n;

    f->last = take(f, 1) != 0;
    type = take(f, 2);
    if (f->fault)
        return;
    f->state = type ? CODES : STORED;
    f->left = 0;
    if (type == 1)
        fixed_codes(f);
    else if (type == 2)
        own_codes(f);
    else if (type == 3)
        fail(f, "has a block of unknown type");
    else {
        drop(f, f->nbits & 7);
        n = take(f, 16);
        if (take(f, 16) != (n ^ 0xFFFF))
            fail(f, "has a stored block of uncertain length");
        f->left = n;
    }
}

static void end_block(Inflate *f) { f->state = f->last ? SUM : HEAD; }

static void put(Inflate *f, unsigned char *out, unsigned char byte)
{
    *out = byte;
    f->window[f->made++ % INFLATE_WINDOW] = byte;
}

static size_t take_stored(Inflate *f, unsigned char *out, size_t n)
{
    size_t k = 0;

    for (; k < n && f->left; k++, f->left--) {
        unsigned char byte = (unsigned char)take(f, 8);
        if (f->fault)
            return k;
        put(f, out + k, byte);
    }
    if (!f->left)
        end_block(f);
    return k;
}

/* Code c of lengths or distances stands for base + extra bits: the code is the exponent and the
 * first bits of a small float. */
static uint32_t value_of(Inflate *f, unsigned c, unsigned mantissa)
{
    unsigned most = 1u << mantissa, extra = c < 2 * most ? 0 : (c >> mantissa) - 1;
    return c < 2 * most ? c : ((most + (c & (most - 1))) << extra) + take(f, extra);
}

static void begin_match(Inflate *f, unsigned symbol)
{
    unsigned c;

    f->left = symbol == 285 ? 258 : 3 + value_of(f, symbol - END - 1, 2);
    c = next_symbol(f, &f->distances);
    f->distance = 1 + value_of(f, c < DISTANCES ? c : 0, 1);
    if (symbol > 285 || c >= DISTANCES)
        fail(f, "has a code of no meaning");
    else if (f->distance > f->made)
        fail(f, "refers to bytes before its first one");
}

static size_t take_codes(Inflate *f, unsigned char *out, size_t n)
{
    size_t k = 0;

    while (k < n && !f->fault) {
        unsigned symbol;
        for (; f->left && k < n; f->left--, k++)
            put(f, out + k, f->window[(f->made - f->distance) % INFLATE_WINDOW]);
        if (k == n)
            break;
        symbol = next_symbol(f, &f->literals);
        if (f->fault)
            break;
        if (symbol < END)
            put(f, out + k++, (unsigned char)symbol);
        else if (symbol > END)
            begin_match(f, symbol);
        else {
            end_block(f);
            break;
        }
    }
    return k;
}

static void check_sum(Inflate *f)
{
    uint32_t sum = 0;

    drop(f, f->nbits & 7);
    for (int i = 0; i < 4; i++)
        sum = sum << 8 | take(f, 8);
    if (!f->fault && sum != f->adler)
        fail(f, "has a wrong checksum");
    f->state = DONE;
}

/* ---- the interface ---- */

void inflate_init(Inflate *f, bool (*more)(void *, const unsigned char **, const unsigned char **),
                  void *ctx)
{
    memset(f, 0, sizeof *f);
    f->more = more;
    f->ctx = ctx;
    f->adler = 1;
    f->state = HEAD;
    begin(f);
}

size_t inflate_take(Inflate *f, unsigned char *out, size_t n)
{
    size_t k = 0;

    while (k < n && !f->fault && f->state < SUM) {
        if (f->state == HEAD)
            begin_block(f);
        else if (f->state == STORED)
            k += take_stored(f, out + k, n - k);
        else
            k += take_codes(f, out + k, n - k);
    }
    f->adler = checksum_adler32(f->adler, out, k);
    if (!f->fault && f->state == SUM)
        check_sum(f);
    return k;
}

bool inflate_finish(Inflate *f)
{
    unsigned char dropped[512];

    while (!f->fault && f->state != DONE)
        inflate_take(f, dropped, sizeof dropped);
    return !f->fault;
}

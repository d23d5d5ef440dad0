/* deflate.c -- compression to the deflate format.
 *
 * Source      [RFC1950] the zlib frame, [RFC1951] deflate.
 *             [Larmore90] Larmore, Hirschberg, "A fast algorithm for optimal length-limited Huffman
 *             codes", JACM 37(3): package-merge.
 * How         The bytes become tokens: a literal, or a copy of 3 to 258 bytes from up to 32768
 *             bytes back. Earlier places with the same three bytes are found along chains of one
 *             hash table. A match waits for one byte, in case the next place has a longer one.
 *             Every BLOCK tokens are written in the shortest of the three ways the format has: as
 *             they are, in the fixed code, or in a code made for this block.
 * Invariant   The size of a block is known before it is written, so memory is asked for once a
 *             block, and writing bits cannot fail. Same bytes in, same bytes out. */
#include "image/deflate.h"

#include "base/mem.h"

#include <string.h>

enum {
    WINDOW = 1 << 15, HASHES = 1 << 15,
    MATCH_MIN = 3, MATCH_MAX = 258,
    CHAIN = 64,                 /* places looked at: 256 save 2 to 4 % and take twice the time */
    GOOD = 64,                  /* a match this long is taken without looking for a better one */
    FAR = 4096,                 /* three bytes from farther back take more bits than literals */
    BLOCK = 1 << 14,            /* tokens that share one code */
    STORED_MAX = 65535,         /* bytes of one stored block */
    LITERALS = 286, DISTANCES = 30, LENGTHS = 19, END = 256
};

/* A literal (distance 0) or a match. */
typedef struct { uint16_t value, distance; } Token;

/* A prefix code: bits[s] is already reversed, since codes are sent from their first bit on. */
typedef struct { uint8_t length[288]; uint16_t bits[288]; } Code;

typedef struct {
    const unsigned char *in;    /* borrowed */
    size_t n, block_start;      /* in[block_start..] is what the tokens stand for */
    size_t head[HASHES];        /* latest place of a hash, plus 1; 0: none */
    size_t before[WINDOW];      /* the one before place p at p mod WINDOW, likewise */
    Token  token[BLOCK];
    size_t tokens, extra;       /* extra: bits of lengths and distances beyond their codes */
    uint32_t literals[LITERALS], distances[DISTANCES];      /* how often each is used */
    unsigned char *out;         /* owned until returned */
    size_t out_n, out_cap;
    uint64_t pending;           /* bits not yet in out, the first one lowest */
    unsigned pending_n;
} Deflate;

/* ---- checksums ---- */

uint32_t checksum_crc32(uint32_t crc, const unsigned char *bytes, size_t n)
{
    /* The remainders of four bits by the reflected polynomial EDB88320. */
    static const uint32_t step[16] = {
        0x00000000, 0x1DB71064, 0x3B6E20C8, 0x26D930AC, 0x76DC4190, 0x6B6B51F4, 0x4DB26158,
        0x5005713C, 0xEDB88320, 0xF00F9344, 0xD6D6A3E8, 0xCB61B38C, 0x9B64C2B0, 0x86D3D2D4,
        0xA00AE278, 0xBDBDF21C
    };
    crc = ~crc;
    for (size_t i = 0; i < n; i++) {
        crc ^= bytes[i];
        crc = crc >> 4 ^ step[crc & 15];
        crc = crc >> 4 ^ step[crc & 15];
    }
    return ~crc;
}

uint32_t checksum_adler32(uint32_t adler, const unsigned char *bytes, size_t n)
{
    uint32_t a = adler & 0xFFFF, b = adler >> 16;
    while (n) {                 /* 5552 bytes of 255 are the most that do not overflow b */
        size_t k = n < 5552 ? n : 5552;
        n -= k;
        for (; k; k--) {
            a += *bytes++;
            b += a;
        }
        a %= 65521;
        b %= 65521;
    }
    return b << 16 | a;
}

/* ---- bits ---- */

static void put_bits(Deflate *d, uint32_t bits, unsigned count)
{
    d->pending |= (uint64_t)bits << d->pending_n;
    d->pending_n += count;
    while (d->pending_n >= 8) {
        d->out[d->out_n++] = (unsigned char)d->pending;
        d->pending >>= 8;
        d->pending_n -= 8;
    }
}

static void put_align(Deflate *d) { put_bits(d, 0, (8 - d->pending_n) & 7); }

/* Lengths and distances are coded like floats: a code for the exponent and the first `mantissa`
 * bits, then the others as they are. [RFC1951 3.2.5] */
typedef struct { unsigned code, extra, extra_n; } Split;

static Split split(unsigned v, unsigned mantissa)
{
    unsigned top = 0, shift;

    while (v >> (top + 1))
        top++;
    if (top <= mantissa)
        return (Split){ v, 0, 0 };
    shift = top - mantissa;
    return (Split){ (shift << mantissa) + (v >> shift), v & ((1u << shift) - 1), shift };
}

static Split split_length(unsigned length)
{
    Split s = length == MATCH_MAX ? (Split){ 28, 0, 0 } : split(length - MATCH_MIN, 2);
    s.code += END + 1;
    return s;
}

static Split split_distance(unsigned distance) { return split(distance - 1, 1); }

/* ---- codes ---- */

/* The used symbols, those of least weight first; equal weights by symbol. Returns their number. */
static int sort_symbols(const uint32_t *freq, int n, uint16_t *symbol)
{
    int used = 0;

    for (int s = 0; s < n; s++) {
        int i = used;
        if (!freq[s])
            continue;
        for (; i > 0 && freq[symbol[i - 1]] > freq[s]; i--)
            symbol[i] = symbol[i - 1];
        symbol[i] = (uint16_t)s;
        used++;
    }
    return used;
}

/* Code lengths of at most `limit` bits with the least sum of freq * length [Larmore90]. A symbol
 * with length k buys one coin of each of the values 1/2 .. 1/2^k; the cheapest coins worth
 * (used - 1) in all are bought. From the smallest value up, coins are packed in pairs and merged by
 * weight with the symbols' coins of the next value. At least two symbols must be used. */
static void limited_lengths(const uint32_t *freq, int n, int limit, uint8_t *length)
{
    uint16_t symbol[LITERALS];
    bool is_symbol[15][2 * LITERALS];
    uint64_t weight[2 * LITERALS], pair[LITERALS];
    int used = sort_symbols(freq, n, symbol), pairs = 0, take = 2 * used - 2;

    for (int level = 0; level < limit; level++) {
        int s = 0, p = 0;
        while (s < used || p < pairs) {
            bool own = p == pairs || (s < used && freq[symbol[s]] <= pair[p]);
            is_symbol[level][s + p] = own;
            weight[s + p] = own ? freq[symbol[s]] : pair[p];
            if (own)
                s++;
            else
                p++;
        }
        pairs = (s + p) / 2;
        for (int i = 0; i < pairs; i++)
            pair[i] = weight[2 * i] + weight[2 * i + 1];
    }
    memset(length, 0, (size_t)n);
    for (int level = limit - 1; level >= 0; level--) {  /* unpack what was bought */
        int own = 0;
        for (int i = 0; i < take; i++)
            own += is_symbol[level][i];
        for (int i = 0; i < own; i++)
            length[symbol[i]]++;
        take = 2 * (take - own);
    }
}

/* Canonical codes of given lengths: shorter first, then by symbol. [RFC1951 3.2.2] */
static void code_of_lengths(Code *c, int n)
{
    unsigned next = 0;

    for (unsigned length = 1; length <= 15; length++, next <<= 1)
        for (int s = 0; s < n; s++)
            if (c->length[s] == length) {
                unsigned reversed = 0;
                for (unsigned k = 0; k < length; k++)
                    reversed |= (next >> k & 1) << (length - 1 - k);
                c->bits[s] = (uint16_t)reversed;
                next++;
            }
}

/* The best code for these frequencies. One symbol alone would make a code that is not complete,
 * which some readers refuse, so two are always used. */
static void best_code(Code *c, uint32_t *freq, int n, int limit)
{
    int used = 0;

    for (int s = 0; s < n; s++)
        used += freq[s] != 0;
    for (int s = 0; used < 2; s++)
        if (!freq[s]) {
            freq[s] = 1;
            used++;
        }
    limited_lengths(freq, n, limit, c->length);
    code_of_lengths(c, n);
}

static void fixed_codes(Code *literals, Code *distances)        /* [RFC1951 3.2.6] */
{
    for (int s = 0; s < 288; s++)
        literals->length[s] = s < 144 ? 8 : s < 256 ? 9 : s < 280 ? 7 : 8;
    code_of_lengths(literals, 288);
    for (int s = 0; s < 32; s++)
        distances->length[s] = 5;
    code_of_lengths(distances, 32);
}

static size_t bits_of(const uint32_t *freq, const Code *c, int n)
{
    size_t bits = 0;
    for (int s = 0; s < n; s++)
        bits += (size_t)freq[s] * c->length[s];
    return bits;
}

/* ---- the code lengths at the head of a block with codes of its own ---- */

typedef struct {
    int      literals, distances, order;        /* how many of each are sent */
    int      n;
    uint8_t  symbol[LITERALS + DISTANCES], extra[LITERALS + DISTANCES];
    Code     code;
    size_t   bits;
} CodeHeader;

static const uint8_t length_order[LENGTHS] = {
    16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15
};

static unsigned header_extra_bits(int symbol)
{
    return symbol < 16 ? 0 : symbol == 16 ? 2 : symbol == 17 ? 3 : 7;
}

/* Shortens runs: 16 repeats the length before 3 to 6 times, 17 and 18 are 3 to 10 and 11 to 138
 * zeros. [RFC1951 3.2.7] */
static void pack_lengths(CodeHeader *h, const uint8_t *all, int n)
{
    for (int i = 0; i < n; ) {
        int run = 1, most = all[i] ? 7 : 138;
        while (i + run < n && run < most && all[i + run] == all[i])
            run++;
        if (all[i] && run >= 4) {
            h->symbol[h->n] = all[i];
            h->extra[h->n++] = 0;
            h->symbol[h->n] = 16;
            h->extra[h->n++] = (uint8_t)(run - 4);
        } else if (!all[i] && run >= 3) {
            h->symbol[h->n] = run < 11 ? 17 : 18;
            h->extra[h->n++] = (uint8_t)(run < 11 ? run - 3 : run - 11);
        } else {
            run = 1;
            h->symbol[h->n] = all[i];
            h->extra[h->n++] = 0;
        }
        i += run;
    }
}

static void make_header(CodeHeader *h, const Code *literals, const Code *distances)
{
    uint8_t all[LITERALS + DISTANCES];
    uint32_t freq[LENGTHS] = { 0 };

    memset(h, 0, sizeof *h);
    for (h->literals = LITERALS; !literals->length[h->literals - 1]; h->literals--)
        ;
    for (h->distances = DISTANCES; !distances->length[h->distances - 1]; h->distances--)
        ;
    memcpy(all, literals->length, (size_t)h->literals);
    memcpy(all + h->literals, distances->length, (size_t)h->distances);
    pack_lengths(h, all, h->literals + h->distances);
    for (int i = 0; i < h->n; i++) {
        freq[h->symbol[i]]++;
        h->bits += header_extra_bits(h->symbol[i]);
    }
    best_code(&h->code, freq, LENGTHS, 7);
    for (h->order = LENGTHS; !h->code.length[length_order[h->order - 1]]; h->order--)
        ;
    h->bits += 14 + 3 * (size_t)h->order + bits_of(freq, &h->code, LENGTHS);
}

static void put_header(Deflate *d, const CodeHeader *h)
{
    put_bits(d, (uint32_t)h->literals - 257, 5);
    put_bits(d, (uint32_t)h->distances - 1, 5);
    put_bits(d, (uint32_t)h->order - 4, 4);
    for (int i = 0; i < h->order; i++)
        put_bits(d, h->code.length[length_order[i]], 3);
    for (int i = 0; i < h->n; i++) {
        put_bits(d, h->code.bits[h->symbol[i]], h->code.length[h->symbol[i]]);
        put_bits(d, h->extra[i], header_extra_bits(h->symbol[i]));
    }
}

/* ---- blocks ---- */

static void put_tokens(Deflate *d, const Code *literals, const Code *distances)
{
    for (size_t i = 0; i < d->tokens; i++) {
        Token t = d->token[i];
        if (t.distance) {
            Split l = split_length(t.value), r = split_distance(t.distance);
            put_bits(d, literals->bits[l.code], literals->length[l.code]);
            put_bits(d, l.extra, l.extra_n);
            put_bits(d, distances->bits[r.code], distances->length[r.code]);
            put_bits(d, r.extra, r.extra_n);
        } else
            put_bits(d, literals->bits[t.value], literals->length[t.value]);
    }
    put_bits(d, literals->bits[END], literals->length[END]);
}

static void put_stored(Deflate *d, size_t end, bool last)
{
    do {
        size_t left = end - d->block_start, k = left < STORED_MAX ? left : STORED_MAX;
        put_bits(d, last && k == left, 3);
        put_align(d);
        put_bits(d, (uint32_t)k, 16);
        put_bits(d, (uint32_t)(~k & 0xFFFF), 16);
        memcpy(d->out + d->out_n, d->in + d->block_start, k);
        d->out_n += k;
        d->block_start += k;
    } while (d->block_start < end);
}

/* Writes the tokens so far, which stand for in[block_start .. end). */
static bool put_block(Deflate *d, size_t end, bool last)
{
    Code fixed[2], own[2];
    CodeHeader header;
    size_t bytes = end - d->block_start, stored, in_fixed, in_own, least;

    d->literals[END] = 1;
    fixed_codes(&fixed[0], &fixed[1]);
    in_fixed = 3 + d->extra + bits_of(d->literals, &fixed[0], LITERALS) +
               bits_of(d->distances, &fixed[1], DISTANCES);
    best_code(&own[0], d->literals, LITERALS, 15);
    best_code(&own[1], d->distances, DISTANCES, 15);
    make_header(&header, &own[0], &own[1]);
    in_own = 3 + header.bits + d->extra + bits_of(d->literals, &own[0], LITERALS) +
             bits_of(d->distances, &own[1], DISTANCES);
    stored = 8 * bytes + (bytes / STORED_MAX + 1) * 42;         /* 3 + at most 7 + 32 bits each */
    least = stored < in_fixed ? stored : in_fixed < in_own ? in_fixed : in_own;

    /* The pending bits, and the four bytes of the checksum that follows the last block. */
    if (!mem_grow(&d->out, &d->out_cap, d->out_n + least / 8 + 8, 1))
        return false;
    if (least == stored)
        put_stored(d, end, last);
    else {
        const Code *code = least == in_fixed ? fixed : own;
        put_bits(d, (code == fixed ? 2u : 4u) + last, 3);
        if (code == own)
            put_header(d, &header);
        put_tokens(d, &code[0], &code[1]);
    }
    memset(d->literals, 0, sizeof d->literals);
    memset(d->distances, 0, sizeof d->distances);
    d->tokens = d->extra = 0;
    d->block_start = end;
    return true;
}

/* ---- matches ---- */

static unsigned hash_at(const Deflate *d, size_t at)
{
    const unsigned char *p = d->in + at;
    uint32_t three = p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16;
    return three * 2654435761u >> 17;                   /* [Knuth3 6.4] the golden ratio */
}

static void remember(Deflate *d, size_t at)
{
    if (d->n - at >= MATCH_MIN) {
        size_t *head = &d->head[hash_at(d, at)];
        d->before[at % WINDOW] = *head;
        *head = at + 1;
    }
}

typedef struct { unsigned length, distance; } Match;

/* The longest earlier copy of what stands at `at`, the nearest of equals; length 0: none. Places
 * stand in chains from late to early, so the first one out of the window ends the search. */
static Match find_match(const Deflate *d, size_t at)
{
    Match best = { MATCH_MIN - 1, 0 };
    unsigned most = d->n - at < MATCH_MAX ? (unsigned)(d->n - at) : MATCH_MAX;
    const unsigned char *here = d->in + at;
    size_t place = most >= MATCH_MIN ? d->head[hash_at(d, at)] : 0;

    for (int k = 0; k < CHAIN && place && at - (place - 1) <= WINDOW && best.length < most; k++) {
        const unsigned char *there = d->in + place - 1;
        unsigned length = 0;
        if (there[best.length] == here[best.length])
            while (length < most && there[length] == here[length])
                length++;
        if (length > best.length)
            best = (Match){ length, (unsigned)(here - there) };
        place = d->before[(place - 1) % WINDOW];
    }
    if (best.length < MATCH_MIN || (best.length == MATCH_MIN && best.distance > FAR))
        return (Match){ 0, 0 };
    return best;
}

static bool put_token(Deflate *d, Token t, size_t end)
{
    if (t.distance) {
        Split l = split_length(t.value), r = split_distance(t.distance);
        d->literals[l.code]++;
        d->distances[r.code]++;
        d->extra += l.extra_n + r.extra_n;
    } else
        d->literals[t.value]++;
    d->token[d->tokens++] = t;
    return d->tokens < BLOCK || put_block(d, end, false);
}

static bool deflate(Deflate *d)
{
    Match m = { 0, 0 };

    for (size_t at = 0; at < d->n; ) {
        Match next = { 0, 0 };
        remember(d, at);
        if (m.length < GOOD && at + 1 < d->n)
            next = find_match(d, at + 1);
        if (m.length && next.length <= m.length) {
            Token t = { (uint16_t)m.length, (uint16_t)m.distance };
            for (unsigned k = 1; k < m.length; k++)
                remember(d, at + k);
            at += m.length;
            if (!put_token(d, t, at))
                return false;
            m = at < d->n ? find_match(d, at) : (Match){ 0, 0 };
        } else {
            Token t = { d->in[at], 0 };
            at++;
            if (!put_token(d, t, at))
                return false;
            m = next;
        }
    }
    return put_block(d, d->n, true);
}

bool zlib_compress(const unsigned char *bytes, size_t n, unsigned char **out, size_t *out_n)
{
    Deflate *d = MEM_NEW(Deflate);
    uint32_t sum = checksum_adler32(1, bytes, n);
    bool ok = d && mem_grow(&d->out, &d->out_cap, 2, 1);

    *out = NULL;
    *out_n = 0;
    if (ok) {
        d->in = bytes;
        d->n = n;
        put_bits(d, 0x9C78, 16);        /* deflate, a window of 32 KiB, the usual effort */
        ok = deflate(d);
    }
    if (ok) {
        put_align(d);
        for (int shift = 24; shift >= 0; shift -= 8)
            put_bits(d, sum >> shift & 0xFF, 8);
        *out = d->out;
        *out_n = d->out_n;
    } else if (d)
        mem_free(d->out);
    mem_free(d);
    return ok;
}

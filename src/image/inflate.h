/* inflate.h -- unpacks zlib streams, as many bytes at a time as are wanted, from input that may
 * come in pieces. Nothing is allocated. */
#ifndef IMAGE_INFLATE_H
#define IMAGE_INFLATE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { INFLATE_WINDOW = 1 << 15, INFLATE_FAST = 9, INFLATE_RATIO = 1032 };

/* A prefix code as a canonical one is decoded: how many codes there are of each length, and their
 * symbols in the order of the codes. fast: symbol * 16 + length by the next bits, 0 if longer. */
typedef struct { uint16_t count[16], symbol[288], fast[1 << INFLATE_FAST]; } InflateCode;

typedef struct {
    const unsigned char *at, *end;      /* borrowed: packed bytes that were not yet taken */
    /* Gives the next piece of the packed bytes, which may be empty. False: there is no more. */
    bool (*more)(void *ctx, const unsigned char **at, const unsigned char **end);
    void *ctx;
    const char *fault;                  /* what is wrong with the stream, or NULL */
    uint64_t bits;                      /* taken, but not used: the first one lowest */
    unsigned nbits;
    int      state;
    bool     last;                      /* the present block is the last one */
    uint32_t left, distance;            /* bytes still to copy, and from how far back */
    uint32_t adler;
    uint64_t made;                      /* bytes unpacked so far */
    InflateCode literals, distances;
    unsigned char window[INFLATE_WINDOW];       /* byte k of all is at k mod INFLATE_WINDOW */
} Inflate;

void inflate_init(Inflate *f, bool (*more)(void *, const unsigned char **, const unsigned char **),
                  void *ctx);
/* Unpacks n bytes. Fewer: the stream ended, or f->fault says why. n packed bytes never give more
 * than INFLATE_RATIO * n. */
size_t inflate_take(Inflate *f, unsigned char *out, size_t n);
/* Reads on to the end, dropping what is there. True if the stream is whole and its sum right. */
bool inflate_finish(Inflate *f);

#endif

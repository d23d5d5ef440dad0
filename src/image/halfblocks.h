/* halfblocks.h -- a picture as text for a terminal: each cell is a half block, whose ink is the
 * upper and whose ground the lower one of two square pixels. */
#ifndef IMAGE_HALFBLOCKS_H
#define IMAGE_HALFBLOCKS_H

#include "image/image.h"

/* The largest picture of the same shape that so many cells have room for, in pixels, of which a
 * cell holds one across and two down. At least 1 x 1. */
void halfblocks_fit(uint32_t w, uint32_t h, int columns, int rows, uint32_t *across,
                    uint32_t *down);

/* Fills `small`, whose size is the caller's: each of its pixels is the mean, by area, of what it
 * covers of the picture as `display` shows it, still linear. False: out of memory, reported. */
bool halfblocks_shrink(const Image *im, const Display *display, Image *small);

/* What a terminal of so many columns is sent to show it from its top left corner on, the rest of
 * its lines being blank, in `text`, which has room for HALFBLOCKS_ROOM bytes. Returns how many. The
 * cursor is left at the start of the last of `rows`. */
#define HALFBLOCKS_ROOM(across, down) \
    ((size_t)(across) * ((down) / 2 + 1) * 48 + (size_t)((down) / 2 + 1) * 24 + 64)
size_t halfblocks_text(const Image *small, int columns, int rows, bool true_colour, char *text);

/* Of the 256 colours of terminals the one nearest to a colour: 16 .. 231 are a cube of 6 levels a
 * component, 232 .. 255 greys. */
int colour_of_256(const unsigned char rgb[3]);

#endif

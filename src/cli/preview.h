/* preview.h -- the picture in the terminal while it is rendered: --preview. */
#ifndef CLI_PREVIEW_H
#define CLI_PREVIEW_H

#include "render/render.h"

typedef struct {
    const Display *display;     /* borrowed */
    bool   true_colour, on;     /* on: the terminal is ours */
    double draw_at;             /* clock: not before */
    RenderWatch watch;
    char   held[4096];          /* messages, each line with its end, till they can be read */
    size_t nheld;
    unsigned lost;              /* those that found no room */
} Preview;

/* Takes the terminal of standard error and looks at the render from now on. Where there is none,
 * or one that cannot show pictures, it warns and does nothing. False: warnings are fatal. */
bool preview_start(Preview *p, const Display *display, RenderSettings *s);
/* Leaves the terminal as it was, then says what has been said meanwhile. */
void preview_end(Preview *p);

#endif

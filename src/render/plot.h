/* plot.h -- curves on logarithmic axes, as an SVG picture: error against samples, against time. */
#ifndef RENDER_PLOT_H
#define RENDER_PLOT_H

#include <stdbool.h>

/* Points with a coordinate that is not positive and finite are left out. Labels may be any text.
 * All is borrowed. */
typedef struct {
    const char   *label, *note;         /* note: after the label in the legend; NULL: nothing */
    const double *x, *y;
    int           n;
} PlotCurve;

typedef struct {
    const char      *x_label, *y_label;
    const PlotCurve *curves;            /* curve k has the same colour and mark in all panels */
    int              ncurves;
    double           guide;             /* slope of a dashed line beside the curves; 0: none */
    const char      *guide_label;
} PlotPanel;

/* One file with the panels side by side, the legend of the first below them. False: reported,
 * nothing is written. */
bool plot_write(const char *path, const char *title, const PlotPanel *panels, int npanels);

#endif

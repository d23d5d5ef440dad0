/* plot.h -- SVG pictures: curves on logarithmic axes (error against samples, against time), and
 * sets of points in the unit square. */
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

/* Points of [0,1)^2, y upwards, over a grid of columns x rows lines. All is borrowed. */
typedef struct {
    const char  *title;
    const float *xy;                    /* x and y in turn */
    int          n, columns, rows;
} PlotPoints;

/* One file with the squares in rows of `across`. False: reported, nothing is written. */
bool plot_write_points(const char *path, const PlotPoints *sets, int nsets, int across);

#endif

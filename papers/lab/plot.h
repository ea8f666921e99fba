/* Plots as SVG or PNG files: axes with ticks, curves with marks or groups of bars, and a legend to the right. */
#ifndef PAPERS_LAB_PLOT_H
#define PAPERS_LAB_PLOT_H

#include <stdbool.h>

#include <pellicle/base.h>

typedef struct lab_curve {
    const char *name; /* in the legend; empty, of a single curve: no legend */
    const double *x, *y;
    int count;
    bool marks; /* a dot at each point */
} lab_curve;

enum { LAB_CURVES = 8 };

typedef struct lab_plot {
    const char *title, *x_name, *y_name;
    bool log_x, log_y; /* all values of that axis are above 0 */
    bool bars;         /* groups of bars instead of curves, all with the same x */
    lab_curve curves[LAB_CURVES];
    int curve_count;
} lab_plot;

/* As SVG. Errors: PEL_BAD_FILE, PEL_OUT_OF_MEMORY. */
pel_status lab_write_plot(const char *path, const lab_plot *plot, pel_error *error);

/* As PNG. Errors: PEL_BAD_FILE (also: no font), PEL_OUT_OF_MEMORY, PEL_BAD_ARGUMENT (no pictures in this program). */
pel_status lab_draw_plot(const char *path, const lab_plot *plot, pel_error *error);

#endif

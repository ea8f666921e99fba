/* Plots as SVG files: axes with ticks, curves with marks or groups of bars, and a legend to the right. */
#ifndef PELLICLE_CLI_PLOT_H
#define PELLICLE_CLI_PLOT_H

#include <stdbool.h>

#include <pellicle/base.h>

typedef struct cli_curve {
    const char *name; /* in the legend */
    const double *x, *y;
    int count;
    bool marks; /* a dot at each point */
} cli_curve;

enum { CLI_CURVES = 8 };

typedef struct cli_plot {
    const char *title, *x_name, *y_name;
    bool log_x, log_y; /* all values of that axis are above 0 */
    bool bars;         /* groups of bars instead of curves, all with the same x */
    cli_curve curves[CLI_CURVES];
    int curve_count;
} cli_plot;

/* Errors: PEL_BAD_FILE. */
pel_status cli_plot_write(const char *path, const cli_plot *plot, pel_error *error);

#endif

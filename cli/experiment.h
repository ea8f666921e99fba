/* Experiments of `pellicle reproduce`: each runs scenes, compares numbers with known ones, and leaves a folder. */
#ifndef PELLICLE_CLI_EXPERIMENT_H
#define PELLICLE_CLI_EXPERIMENT_H

#include "diagnostics.h"
#include "plot.h"

#include <pellicle/frames.h>
#include <pellicle/run.h>

enum { CLI_EXPERIMENT_NUMBERS = 256, CLI_EXPERIMENT_PATH = PEL_RUN_PATH_SIZE };

/* A number that came out, beside the one it should be. */
typedef struct cli_finding {
    char name[64];
    double value, expected;
    double tolerance;   /* largest difference that counts as equal; infinite = told, not judged */
    const char *source; /* of the expected number; a literal */
} cli_finding;

/* An experiment at work. */
typedef struct cli_experiment {
    const char *folder; /* of this experiment, exists */
    pel_error *error;
    cli_finding findings[CLI_EXPERIMENT_NUMBERS];
    int finding_count;
    bool quiet;
} cli_experiment;

typedef struct cli_experiment_case {
    const char *name;
    const char *doc; /* one line */
    pel_status (*run)(cli_experiment *experiment);
} cli_experiment_case;

/* folder/name in path (CLI_EXPERIMENT_PATH bytes); returns path */
const char *cli_experiment_path(const cli_experiment *experiment, const char *name, char *path);

/* A number that has to be `expected` up to the tolerance. */
void cli_experiment_check(cli_experiment *experiment, const char *name, double value, double expected, double tolerance,
                          const char *source);
/* A number that has to be at most `limit`. */
void cli_experiment_limit(cli_experiment *experiment, const char *name, double value, double limit, const char *source);
/* A number beside one that depends on the machine, or on what the paper does not say. */
void cli_experiment_tell(cli_experiment *experiment, const char *name, double value, double expected,
                         const char *source);
bool cli_finding_holds(const cli_finding *finding);

/* Runs a scene, given as text with overrides (null-terminated list), into folder/name. */
pel_status cli_experiment_run(cli_experiment *experiment, const char *name, const char *scene,
                              const char *const *overrides, pel_run_summary *summary);

/* Two columns of the series of a run. */
typedef struct cli_series {
    const double *x, *y; /* (count) */
    int count;
    pel_series *read; /* holds both */
} cli_series;

pel_status cli_series_read(const cli_experiment *experiment, const char *run, const char *x_name, const char *y_name,
                           cli_series *series);
void cli_series_free(cli_series *series);

/* Writes folder/plot.svg. */
pel_status cli_experiment_plot(const cli_experiment *experiment, const cli_plot *plot);

/* Draws folder/picture.png of runs side by side, with frames as rows; does nothing in a program without pictures. */
typedef struct cli_picture {
    const char *runs[4], *labels[4];
    int run_count;
    int frames[4];
    int frame_count;
    double azimuth, elevation;
    bool edges;
} cli_picture;

pel_status cli_experiment_draw(const cli_experiment *experiment, const cli_picture *picture);

/* the cases of the other files */
extern const cli_experiment_case cli_figure_6_7, cli_figure_8, cli_figure_9, cli_table_1, cli_accuracy,
    cli_figure_11_13, cli_figure_14, cli_figure_15, cli_figure_16_18, cli_figure_19_20, cli_shell_checks, cli_table_2,
    cli_shell_refinement, cli_validation;

#endif

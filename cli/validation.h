/* Shared by the files of the experiment `validation`. */
#ifndef PELLICLE_CLI_VALIDATION_H
#define PELLICLE_CLI_VALIDATION_H

#include "experiment.h"

enum { CLI_SCENE_SIZE = CLI_EXPERIMENT_PATH + 4000 };

/* A scene at work, without a folder. */
typedef struct cli_trial {
    pel_scene *scene;
    pel_model *model;
    pel_sim *sim;
} cli_trial;

/* Closing a trial that failed to open is fine. */
pel_status cli_trial_open(const cli_experiment *experiment, const char *text, cli_trial *trial);
void cli_trial_close(cli_trial *trial);
/* the frequencies or factors of an analysis; values (count) */
pel_status cli_trial_modes(const cli_experiment *experiment, const char *text, int count, double *values);

/* experiment_modes.c: frequencies, buckling, energy of a vibration */
pel_status cli_validate_modes(cli_experiment *experiment);
/* experiment_paths.c: limit points by arc length */
pel_status cli_validate_paths(cli_experiment *experiment);

#endif

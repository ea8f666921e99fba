/* Shared by the files of the experiment `validation`. */
#ifndef PAPERS_OWN_VALIDATION_H
#define PAPERS_OWN_VALIDATION_H

#include "papers/lab/experiment.h"
#include "papers/lab/trial.h"

enum { OWN_SCENE_SIZE = LAB_PATH_SIZE + 4000 };

/* the frequencies or factors of an analysis; values (count) */
pel_status own_modes(const lab_experiment *experiment, const char *text, int count, double *values);

/* modes.c: frequencies, buckling, energy of a vibration */
pel_status own_validate_modes(lab_experiment *experiment);
/* paths.c: limit points by arc length */
pel_status own_validate_paths(lab_experiment *experiment);

#endif

/* Shared by the files of the experiment `validation`. */
#ifndef PAPERS_OWN_VALIDATION_H
#define PAPERS_OWN_VALIDATION_H

#include "papers/lab/experiment.h"
#include "papers/lab/trial.h"

enum { OWN_SCENE_SIZE = LAB_PATH_SIZE + 4000, OWN_SIZES = 3 };

/* the frequencies or factors of an analysis; values (count) */
pel_status own_modes(const lab_experiment *experiment, const char *text, int count, double *values);

/* The scene of one mesh: cells n, kind and model of bending; the answer is a component of the displacement at a place.
 */
typedef struct own_study {
    const char *name, *title;
    pel_status (*write)(const lab_experiment *experiment, int n, const char *mesh, const char *model, char *text);
    int models, sizes[OWN_SIZES];
    double probe[3], direction[3];
    double expected;
    double tolerance; /* relative, at the finest mesh of midedge */
    const char *source;
} own_study;

/* All meshes and models, with a plot; hinges are reported, not judged. */
pel_status own_run_study(lab_experiment *experiment, const own_study *which);
/* A grid of cells_u x n cells laid over a surface, u and v from 0 to 1, and the scene of it under `static`; rest: the
   membrane, mass and supports of the body, and the loads. */
pel_status own_write_shell(const lab_experiment *experiment, const char *name, int cells_u, int n, const char *mesh,
                           const char *model, void (*place)(double u, double v, double x[3]), const char *rest,
                           char *text);

/* modes.c: frequencies, buckling, energy of a vibration */
pel_status own_validate_modes(lab_experiment *experiment);
/* paths.c: limit points by arc length */
pel_status own_validate_paths(lab_experiment *experiment);
/* classics.c: Cook's membrane, a pinched semi-cylinder, tubes, a drum, a ring, the largest pressure of a balloon */
pel_status own_validate_classics(lab_experiment *experiment);

#endif

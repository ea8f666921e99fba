/* Shared by the experiments of paper B: a closed shell that shrinks under an outside pressure, with self-contact. */
#ifndef PELLICLE_CLI_EXPERIMENT_SHRINK_H
#define PELLICLE_CLI_EXPERIMENT_SHRINK_H

#include "experiment.h"

#include <pellicle/error.h>
#include <pellicle/mesh.h>

#define CLI_SHRINK_PAPER "paper B"

/* Runs the scene of the file for a body into "BODY-WHAT"; settings is a null-terminated list of overrides, nullable. */
pel_status cli_shrink(cli_experiment *experiment, int body, const char *what, const char *const *settings,
                      pel_run_summary *summary);
/* "BODY-WHAT"; returns name (64 bytes) */
const char *cli_shrink_name(const cli_experiment *experiment, int body, const char *what, char *name);

/* "BODY: TEXT" in name (96 bytes); returns it */
const char *cli_shrink_label(const cli_experiment *experiment, int body, const char *text, char *name);

/* volume over that at rest in a frame of a run, or its last one; rises of it up to there */
pel_status cli_shrink_volume(const cli_experiment *experiment, const char *run, int frame, double *ratio, int *rises);
/* volume of a run over that of another one in a frame, or in the last one that both have */
pel_status cli_shrink_ratio(const cli_experiment *experiment, const char *run, const char *other, int frame,
                            double *ratio);
/* number in the last row of a column */
pel_status cli_shrink_last(const cli_experiment *experiment, const char *run, const char *column, double *number);

/* Writes a plot of the volumes of runs (count) with these labels. */
pel_status cli_shrink_plot(cli_experiment *experiment, const char *title, const char *const *runs,
                           const char *const *labels, int count);

/* A setting for fibres (E_A), before that of their region (cap of a body); returns text (64 bytes). */
const char *cli_shrink_fibres(const char *energy, char *text);

/* a frame of a run, or its last one */
pel_status cli_shrink_read(const cli_experiment *experiment, const char *run, int frame, pel_mesh **mesh);

/* The surface of a frame relative to frame 0. */
typedef struct cli_shrunk {
    double cap_way, body_way; /* root mean square of the displacement of the vertices of the cap, and of all [m] */
    double cap_depth;         /* mean way inward, along the normals at rest, of the cap [m] */
    double roughness;         /* of the mean curvature: its difference from the mean of the neighbours, over itself */
    double cap_curvature;     /* mean of the mean curvature in the cap [1/m] */
    double energy;            /* mean membrane energy per area at rest over mu */
    double energy_spread;     /* standard deviation over mean of the membrane energy per area, by area */
    double most_stretch;      /* longest edge over its length at rest */
} cli_shrunk;

pel_status cli_shrink_measure(const cli_experiment *experiment, int body, const char *run, int frame,
                              cli_shrunk *shape);
/* membrane energy per area at rest over mu at the vertices (vertex_count): St. Venant and Kirchhoff, nu = 0.3 */
void cli_shrink_energy(const pel_mesh *rest, const pel_mesh *mesh, double *density);
/* the same of two meshes with equal triangles */
pel_status cli_shrink_compare(const cli_body *body, const pel_mesh *rest, const pel_mesh *mesh, cli_shrunk *shape,
                              pel_error *error);

#endif

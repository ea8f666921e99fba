/* Shared by the experiments of paper B: a closed shell that shrinks under an outside pressure, with self-contact. */
#ifndef PAPERS_B_SHRINK_H
#define PAPERS_B_SHRINK_H

#include "papers/b/cases.h"
#include "papers/lab/body.h"

#define B_PAPER "paper B"

/* Runs the scene of the file for a body into "BODY-WHAT"; settings is a null-terminated list of overrides, nullable. */
pel_status b_shrink(lab_experiment *experiment, int body, const char *what, const char *const *settings,
                    pel_run_summary *summary);
/* "BODY-WHAT"; returns name (64 bytes) */
const char *b_run_name(const lab_experiment *experiment, int body, const char *what, char *name);

/* Numbers of a body: lab_expect, lab_at_most, lab_at_least and lab_tell with the name "BODY: TEXT". */
void b_expect(lab_experiment *experiment, int body, const char *text, double value, double expected, double tolerance,
              const char *source);
void b_at_most(lab_experiment *experiment, int body, const char *text, double value, double limit, const char *source);
void b_at_least(lab_experiment *experiment, int body, const char *text, double value, double limit, const char *source);
void b_tell(lab_experiment *experiment, int body, const char *text, double value, double expected, const char *source);

/* What contact did in runs of a body. */
typedef struct b_contacts {
    double intersections; /* pairs of triangles, at the ends of the runs */
    double guarded;       /* vertices that the guard stepped back: 0 = step 4 did without it */
    double pairs;         /* contacts, summed over frames: 0 = nothing touched */
} b_contacts;

/* Adds those of the run "BODY-WHAT". */
pel_status b_add_contacts(const lab_experiment *experiment, int body, const char *what, const pel_run_summary *summary,
                          b_contacts *sum);
/* Begins the claim that step 4 leaves no self-intersection (reason: why not, nullable); judges it for a body. runs:
   which they are */
void b_begin_contact_claim(lab_experiment *experiment, const char *reason);
void b_judge_contacts(lab_experiment *experiment, int body, const char *runs, const b_contacts *sum);

/* bodies of a picture with a row for each: the first ones */
enum { B_SHOWN = 3 };
int b_shown(const lab_experiment *experiment);

/* volume over that at rest in a frame of a run, or its last one; rises of it up to there */
pel_status b_volume(const lab_experiment *experiment, const char *run, int frame, double *ratio, int *rises);
/* turns of the volume from falling to rising, or back, until a frame of a run */
pel_status b_turns(const lab_experiment *experiment, const char *run, int frame, int *turns);
/* volume of a run over that of another one in a frame, or in the last one that both have */
pel_status b_volume_ratio(const lab_experiment *experiment, const char *run, const char *other, int frame,
                          double *ratio);
/* number in the last row of a column */
pel_status b_last(const lab_experiment *experiment, const char *run, const char *column, double *number);

/* mean of a column over the frames after the first one */
pel_status b_mean(const lab_experiment *experiment, const char *run, const char *column, double *mean);

/* Begins the claim that the bound of a correction does not decide how far E_A caves in; judges it for "BODY-WHAT". */
void b_begin_bound_claim(lab_experiment *experiment);
pel_status b_judge_bound(lab_experiment *experiment, int body, const char *what);

/* Writes a plot of the volumes of runs (count) with these labels. */
pel_status b_plot_volumes(lab_experiment *experiment, const char *title, const char *const *runs,
                          const char *const *labels, int count);

/* The next picture: a row for each body shown, the frames (frame_count) of its run "BODY-WHAT". */
pel_status b_draw_bodies(lab_experiment *experiment, const char *caption, const char *what, const int *frames,
                         int frame_count);
/* A picture of pairs in a frame, for lab_add_picture: one for each of the bodies, added one by one. names: of the runs
   or files, which outlive it */
lab_picture b_begin_pairs(const char *caption, int frame, int bodies);
void b_add_pair(lab_picture *picture, const char *const labels[2], char names[2][64]);

/* A setting for fibres (E_A) of a body, before that of their region (its cap); returns text (B_FIBRES_SIZE bytes). */
enum { B_FIBRES_SIZE = 96 };
double b_fibre_gradient(const lab_body *body); /* k_A [N] */
/* stvk has four times the energy of a small strain, and four times k_A here: small strains push as far with all */
const char *b_fibres(const lab_experiment *experiment, int body, const char *energy, char *text);

/* a frame of a run, or its last one */
pel_status b_read_frame(const lab_experiment *experiment, const char *run, int frame, pel_mesh **mesh);

/* The surface of a frame relative to frame 0. */
typedef struct b_shrunk {
    double cap_way, body_way; /* root mean square of the displacement of the vertices of the cap, and of all [m] */
    double cap_depth;         /* mean way inward, along the normals at rest, of the cap [m] */
    double roughness;         /* of the mean curvature: its difference from the mean of the neighbours, over itself */
    double cap_curvature;     /* mean of the mean curvature in the cap [1/m] */
    double energy;            /* mean membrane energy per area at rest over mu */
    double energy_spread;     /* standard deviation over mean of the membrane energy per area, by area */
    double most_stretch;      /* longest edge over its length at rest */
} b_shrunk;

pel_status b_measure(const lab_experiment *experiment, int body, const char *run, int frame, b_shrunk *shape);
/* How much the cap has changed its shape, by the displacements of its vertices less their mean, over the mean of that
   of parts of its size all over the body. */
pel_status b_cap_change(const lab_experiment *experiment, int body, const char *run, int frame, double *over_others);
/* membrane energy per area at rest over mu at the vertices (vertex_count): St. Venant and Kirchhoff, nu = 0.3 */
void b_energy_density(const pel_mesh *rest, const pel_mesh *mesh, double *density);
/* the same of two meshes with equal triangles */
pel_status b_compare(const lab_body *body, const pel_mesh *rest, const pel_mesh *mesh, b_shrunk *shape,
                     pel_error *error);

#endif

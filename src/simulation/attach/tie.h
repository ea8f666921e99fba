/* Ties between vertices and points: threads that act when they are longer than their length. */
#ifndef PEL_ATTACH_TIE_H
#define PEL_ATTACH_TIE_H

#include "linear/matrix.h"
#include "pellicle/tie.h"
#include "stage/stage.h"
#include "stage/transfer.h"

typedef enum pel_tie_phase { PEL_TIE_WAITING, PEL_TIE_HOLDING, PEL_TIE_OPEN } pel_tie_phase;

/* one vertex and its point: d = sum weights x - place */
typedef struct pel_tie {
    int32_t group, count; /* of its vertices: 1, 2 or 4 */
    int32_t vertices[4];  /* in model order; the unused ones repeat the first */
    double weights[4];
    int32_t row;      /* in a sequence */
    double stiffness; /* N/m; infinite = rigid */
    /* what changes while it runs; the rest of this struct goes through snapshots */
    double place[3];              /* m, in the frame of the tool, or in space */
    double start;                 /* m, distance at the begin */
    double force[3];              /* N, on the vertex, mean of the step or at its end */
    double before[3];             /* N, at the end of the step before */
    double multiplier[3], sum[3]; /* of a substep, and their sum in the step [N] */
    int32_t phase, unused;
} pel_tie;

typedef struct pel_tie_group {
    char name[PEL_NAME_SIZE];
    pel_tie_def def; /* its arrays are not kept */
    double gap;      /* m, that contact keeps between both bodies */
    int32_t lost_count, first, count;
    double lost_time, lost_force; /* s, N: of the first one */
} pel_tie_group;

struct pel_ties {
    pel_tie_group *groups; /* (group_count) */
    int32_t group_count;
    pel_tie *items; /* (count) group by group */
    int32_t count;
    bool change;             /* one begins or ends with the present part */
    int32_t (*couplings)[4]; /* (count) scratch: vertices of those that hold and have more than one */
};

/* Checks the ties of the def and finds their points; sim->ties stays null without any. After tools and contact.
   PEL_BAD_ARGUMENT, PEL_OUT_OF_MEMORY. */
pel_status pel_ties_create(pel_sim *sim, const pel_sim_def *def, pel_error *error);
void pel_ties_destroy(pel_sim *sim);

/* Before a part of a step: those that begin or end by the middle of it, or of its first substep. */
void pel_ties_begin(pel_sim *sim);
/* After a part that is accepted, with the new positions: forces, work, and what was too much. */
void pel_ties_end(pel_sim *sim, double next);

/* Energy [J] at unknowns (3 vertex_count) and a time; adds the gradient, or blocks to the matrix. */
double pel_ties_evaluate(pel_sim *sim, double time, const double *unknowns, double *gradient);
void pel_ties_add_matrix(pel_sim *sim, double time, const double *unknowns, pel_matrix *matrix);
/* Vertices of those that need blocks of the matrix beside the diagonal: (returned count). */
int32_t pel_ties_list_couplings(const pel_sim *sim, const int32_t (**vertices)[4]);
/* Explicit: adds the forces at the start of the step to the new velocities, and `ratio` [s] of the change to the
   positions. */
void pel_ties_apply(pel_sim *sim, double ratio);

/* Substeps of projection: those that begin or end by its middle [s], multipliers from 0; a sweep, at a time and with
   the length [s] of a substep; the forces, those on vertices that do not move also into reaction (vertex_count; null =
   none). */
void pel_ties_begin_substep(pel_sim *sim, double middle, const pel_record *start);
void pel_ties_project(pel_sim *sim, double time, double tau, pel_record *positions);
void pel_ties_tally(pel_sim *sim, double tau, pel_record *reaction);

/* a tie holds the body now */
bool pel_ties_hold(const pel_sim *sim, int32_t body);

/* a pel_transfer_part */
void pel_ties_transfer(pel_cursor *at, const pel_sim *sim, int32_t unused);

/* PEL_BAD_ARGUMENT: `what` does not support ties. */
pel_status pel_ties_refuse(const char *what, pel_error *error);

#endif

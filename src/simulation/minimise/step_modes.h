/* Analyses of the method `static`: frequencies and buckling. Step n shows the n-th mode. */
#ifndef PEL_MINIMISE_STEP_MODES_H
#define PEL_MINIMISE_STEP_MODES_H

#include "newton/modes.h"
#include "stage/stage.h"
#include "stage/transfer.h"

struct pel_sim_modes {
    pel_modes *modes;
    pel_record *base;    /* (vertex_count) the state that modes are about */
    pel_record *present; /* (vertex_count) of the step, while modes are computed */
    bool is_solved;      /* modes are there; not so at first after a snapshot was loaded */
    double *values;      /* (mode_count) in snapshots, and */
    int32_t count;       /* of them, 0 before the first step */
};

/* After pel_sim_newton_create. PEL_BAD_ARGUMENT beside tools or contact; PEL_OUT_OF_MEMORY. */
pel_status pel_sim_modes_create(pel_sim *sim, pel_error *error);
pel_status pel_sim_modes_check(const pel_sim *sim, pel_error *error);
void pel_sim_modes_destroy(pel_sim *sim);
/* The step: all modes when it is the first one. Errors of pel_modes_solve and of the state of rest. */
pel_status pel_sim_modes_step(pel_sim *sim, pel_step_result *result, pel_error *error);

/* Share of a vibration's stiffness that damping of the material meets, with the retardations of the bodies [s]: 1 s
   where all strain has it, less where tension or supports hold the vibration. After the first step of a modal analysis;
   -1 if out of memory. */
double pel_sim_mode_retardation(pel_sim *sim, int32_t mode);

/* a pel_transfer_part */
void pel_sim_modes_transfer(pel_cursor *at, const pel_sim *sim, int32_t unused);

#endif

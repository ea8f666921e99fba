/* The path of balances of a static simulation whose loads, gravity and given pressure grow in proportion: a step goes a
   length along it, through limit points (newton/newton.h). */
#ifndef PEL_MINIMISE_STEP_PATH_H
#define PEL_MINIMISE_STEP_PATH_H

#include "newton/newton.h"
#include "pellicle/sim_reading.h"
#include "stage/stage.h"
#include "stage/transfer.h"

struct pel_sim_path {
    pel_newton_path path; /* in snapshots but for its direction, which follows from the last two states */
    int32_t ended;        /* pel_path_end; in snapshots */
    double slope;         /* of the factor over the length behind the last state, and */
    bool is_unstable;     /* before the first limit point: so is the last state; in snapshots, and */
    int32_t limit_count;  /* of the points found so far, and */
    pel_limit_point limits[PEL_LIMIT_POINTS];
};

/* After pel_sim_newton_create. PEL_OUT_OF_MEMORY. */
pel_status pel_sim_path_create(pel_sim *sim, pel_error *error);
void pel_sim_path_destroy(pel_sim *sim);
/* Refuses tools, contact, keys, and bodies that no load acts on or nothing holds against them: PEL_BAD_ARGUMENT. */
pel_status pel_sim_path_check(pel_sim *sim, pel_error *error);
pel_status pel_sim_path_step(pel_sim *sim, pel_step_result *result, pel_error *error);

/* a pel_transfer_part */
void pel_sim_path_transfer(pel_cursor *at, const pel_sim *sim, int32_t unused);

#endif

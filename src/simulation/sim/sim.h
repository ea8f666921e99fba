/* The whole simulation: its rooms, creation and the step. */
#ifndef PEL_SIM_SIM_H
#define PEL_SIM_SIM_H

#include "boundary/loads.h"
#include "def/copy.h"
#include "method/softness.h"
#include "observe/ledger.h"
#include "sim/parts.h"
#include "tool/tool.h"
#include "touch/contact.h"

/* A simulation with the structs of its rooms, in one block. */
typedef struct pel_house {
    pel_sim sim; /* first: both have one address */
    pel_loads loads;
    pel_tools tools;
    pel_ledger ledger;
    pel_touch touch;
    pel_substeps substeps;
    pel_parts parts;
    pel_model *own_model;        /* the given one, where a change has made it; else null */
    pel_copies copies;           /* the arrays of the def */
    pel_fingerprint fingerprint; /* of the model and the def, in snapshots */
} pel_house;

static inline pel_house *pel_house_of(const pel_sim *sim)
{
    return (pel_house *)(uintptr_t)sim;
}

/* Points a simulation to its rooms. */
void pel_house_link(pel_house *house);

/* Sets up a simulation by its def, in a sim that is empty except goes_on; release it also on failure. */
pel_status pel_sim_build(pel_house *house, const pel_sim_def *def, pel_error *error);
/* Recomputes all constants of a simulation at its start after numbers of the solver in sim->def have changed and, with
   the model, after pel_model_refill. The result has the same bits as that of pel_sim_create. False if it must be
   created anew: another method than explicit and quasi-static, shells, refinement, tools, supports or contact, or the
   numbers are refused. It must be destroyed then. */
bool pel_sim_refill(pel_sim *sim, bool with_model);
/* Frees all that is in it. */
void pel_sim_release(pel_house *house);

#endif

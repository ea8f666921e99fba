/* A change of the defs of a running simulation: the defs are changed, the simulation is created from them again, and
   the state is transferred. So everything derived from the defs is right, and errors of creation are reported here. */
#ifndef PEL_SIM_CHANGE_H
#define PEL_SIM_CHANGE_H

#include "def/copy.h"
#include "sim/topology.h"
#include "stage/stage.h"

typedef struct pel_change {
    pel_model_def model; /* copies of the present defs, to be changed; pointers in them may be written to */
    pel_sim_def sim;
    pel_copies copies;
    bool changes_model;
    bool is_release;              /* vertices leave their volumetric springs: their energy is lost */
    const pel_surfaces *surfaces; /* of bodies whose triangles change; null = they stay */
    const void *state;            /* a snapshot of the changed simulation to load; null = keep the present state */
    size_t state_size;
} pel_change;

/* Begins with the present defs. PEL_OUT_OF_MEMORY; to be ended also then. */
pel_status pel_change_begin(const pel_sim *sim, pel_change *change, pel_error *error);
/* Puts the surfaces into a change, with all that lives by vertex; they live longer than it. PEL_OUT_OF_MEMORY. */
pel_status pel_change_surfaces(pel_change *change, const pel_surfaces *surfaces, pel_error *error);
/* Recreates the simulation. Errors of pel_model_create and pel_sim_create leave it unchanged. */
pel_status pel_change_apply(pel_sim *sim, const pel_change *change, pel_error *error);
void pel_change_end(pel_change *change);

static inline pel_body_def *pel_change_body(pel_change *change, int32_t body)
{
    return (pel_body_def *)(uintptr_t)change->model.bodies + body;
}
static inline pel_load_def *pel_change_load(pel_change *change, int32_t load)
{
    return (pel_load_def *)(uintptr_t)change->sim.loads + load;
}
static inline pel_tool_def *pel_change_tool(pel_change *change, int32_t tool)
{
    return (pel_tool_def *)(uintptr_t)change->sim.tools + tool;
}

#endif

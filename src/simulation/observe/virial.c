/* The share of each vertex in the virial of springs and shell.

   A spring of length l under the tension f adds f l to the derivative of the elastic energy by the logarithm of the
   size, dE / d ln s, when the whole net is stretched uniformly; half of that goes to each of its ends. A plane membrane
   under the tension tau in all directions has dE / d ln s = 2 tau A: so the mean tension at a vertex is its share over
   twice its area (the virial stress of particle mechanics, in the plane). On a regular net of triangles of springs k
   that is stretched by eps this is sqrt(3) k eps, the tension of the membrane that the net represents. A triangle of a
   shell gives a third of the derivative of its energy to each corner. */
#include "pellicle/sim_forces.h"
#include "stage/stage.h"
#include "stage/surface_view.h"

static pel_wide slice_virial(const pel_sim *sim, const pel_body_force *body, int32_t slice)
{
    const pel_model *model = sim->model;
    pel_slice own = pel_slice_load(sim->state->position, slice);
    pel_wide sum = pel_wide_splat(0);
    for (int32_t slot = model->slot_begin[slice]; slot < model->slot_end[slice]; slot++) {
        pel_wide3 d = pel_slot_offset(model, sim->state->position, slot, &own.position);
        pel_wide length = pel_spring_length(d), stiffness = pel_wide_splat(body->stiffness);
        if (!body->uniform)
            stiffness *= model->stiffnesses[slot];
        sum += stiffness * (length - pel_slot_rest(model, slot, length)) * length;
    }
    return pel_wide_splat((pel_real)0.5) * sum;
}

void pel_sim_get_spring_virials(const pel_sim *sim, int32_t body, double *virials)
{
    if (!pel_sim_has_body(sim, body) || virials == NULL)
        return;
    const pel_body *b = &sim->model->bodies[body];
    pel_body_force force = pel_body_force_of(sim->model, sim->state, body);
    for (int32_t slice = b->slice_begin; slice < b->slice_end; slice++) {
        pel_wide virial = slice_virial(sim, &force, slice);
        for (int32_t lane = 0; lane < PEL_WIDTH; lane++) {
            int32_t v = sim->model->mesh_vertex[slice * PEL_WIDTH + lane];
            if (v >= 0)
                virials[pel_output_vertex(sim, body, v)] = (double)virial[lane];
        }
    }
    pel_shell_forces_follow(sim->shells, sim->state->position);
    pel_shell_add_virials(sim->shells, body, pel_output_numbers(sim, body), sim->state->position, pel_sim_time(sim),
                          virials);
}

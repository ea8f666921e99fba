#include "stage/viscous.h"

#include "base/memory.h"
#include "base/status.h"
#include "force/tangent.h"
#include "stage/accessors.h"

struct pel_viscous {
    pel_tangent *tangent;
    double *unknowns; /* (unknown_count) */
    double *numbers;  /* (stress_count x PEL_VISCOUS_NUMBERS) */
};

pel_status pel_viscous_create(pel_sim *sim, pel_error *error)
{
    pel_tangent *tangent = NULL;
    bool any = false;
    for (int32_t b = 0; b < sim->model->body_count; b++)
        any |= pel_body_is_viscous(&sim->model->bodies[b]);
    if (!any)
        return PEL_OK;
    pel_viscous *viscous = sim->viscous = pel_allocate(1, sizeof *viscous);
    if (viscous == NULL)
        return pel_fail_memory(error);
    pel_status status = pel_tangent_create(sim->model, &tangent, error);
    viscous->tangent = tangent;
    if (status != PEL_OK)
        return status;
    const pel_tangent_pattern *pattern = pel_tangent_pattern_of(tangent);
    viscous->unknowns = pel_allocate((size_t)pattern->unknown_limit, sizeof *viscous->unknowns);
    viscous->numbers = pel_allocate((size_t)pattern->stress_limit * PEL_VISCOUS_NUMBERS, sizeof *viscous->numbers);
    return viscous->unknowns != NULL && viscous->numbers != NULL ? PEL_OK : pel_fail_memory(error);
}

void pel_viscous_destroy(pel_sim *sim)
{
    if (sim->viscous == NULL)
        return;
    pel_tangent_destroy(sim->viscous->tangent);
    pel_free(sim->viscous->unknowns);
    pel_free(sim->viscous->numbers);
    pel_free(sim->viscous);
}

void pel_viscous_follow_surface(pel_sim *sim)
{
    if (sim->viscous != NULL)
        pel_tangent_rebuild(sim->viscous->tangent);
}

static void take(const pel_sim *sim, const pel_record *position)
{
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        pel_vertex_position(position, v, sim->viscous->unknowns + 3 * (size_t)v);
}

double pel_viscous_find_loss(pel_sim *sim)
{
    const pel_viscous *viscous = sim->viscous;
    if (viscous == NULL)
        return 0;
    pel_tangent_input input = {
        .unknowns = viscous->unknowns, .span = pel_instant(pel_sim_time(sim)), .state = sim->state};
    take(sim, sim->state->position);
    pel_tangent_refer_rates(viscous->tangent, &input, 1, false, sim->pool, viscous->numbers);
    input.viscous = viscous->numbers;
    input.rate = 1 / sim->step.dt;
    take(sim, sim->state->position_next);
    return pel_tangent_viscous_loss(viscous->tangent, &input, sim->pool);
}

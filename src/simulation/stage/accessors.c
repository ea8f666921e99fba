/* Accessors of a simulation; they compute no forces. */
#include "stage/accessors.h"

#include "math/extremes.h"
#include "math/vec3.h"

#include <string.h>

/* s, over dt: times that differ by less are equal */
#define TIME_ROUNDING 1e-6

double pel_sim_time(const pel_sim *sim)
{
    if (sim == NULL)
        return 0;
    return ((double)sim->state->step + (double)sim->part.at / PEL_PART_LIMIT) * sim->solver.dt;
}

double pel_sim_next_time(const pel_sim *sim)
{
    return ((double)sim->state->step + (double)(sim->part.at + sim->part.step_size) / PEL_PART_LIMIT) * sim->solver.dt;
}

double pel_sim_part_time(const pel_sim *sim, double share)
{
    double at = (sim->part.at + share * sim->part.step_size) / PEL_PART_LIMIT;
    return ((double)sim->state->step + at) * sim->solver.dt;
}

bool pel_sim_has_come(const pel_sim *sim, double time)
{
    return time <= pel_sim_time(sim) + TIME_ROUNDING * sim->solver.dt;
}

int64_t pel_sim_step_count(const pel_sim *sim)
{
    if (sim == NULL)
        return 0;
    return sim->state->step;
}

size_t pel_sim_step_bytes(const pel_sim *sim)
{
    if (sim == NULL)
        return 0;
    const pel_model *model = sim->model;
    size_t slots = 0, slices = 0, with_stiffness = 0;
    for (int32_t b = 0; b < model->body_count; b++) {
        const pel_body *body = &model->bodies[b];
        slices += (size_t)(body->slice_end - body->slice_begin);
        for (int32_t s = body->slice_begin; s < body->slice_end; s++) {
            size_t own = (size_t)(model->slot_end[s] - model->slot_begin[s]);
            slots += own;
            with_stiffness += body->uniform_spring < 0 ? own : 0;
        }
    }
    /* position, rest and new position; with velocities the older or both velocity records, and the damping numbers */
    size_t records = 3, numbers = 0;
    if (pel_sim_has_velocity(sim) || sim->solver.keep_velocity) {
        records += pel_sim_has_velocity(sim) ? 2 : 1;
        numbers = 2;
    } else if (sim->solver.momentum > 0)
        records++;
    return slots * (sizeof *model->neighbours + (model->rest_lengths != NULL ? sizeof *model->rest_lengths : 0)) +
           with_stiffness * sizeof *model->stiffnesses +
           slices * PEL_WIDTH * (records * sizeof(pel_record) + numbers * sizeof(pel_real)) +
           slices * sizeof *model->slot_begin;
}

const pel_model *pel_sim_model(const pel_sim *sim)
{
    if (sim == NULL)
        return NULL;
    return sim->given;
}

double pel_sim_alpha(const pel_sim *sim)
{
    if (sim == NULL)
        return 0;
    return pel_sim_has_velocity(sim) ? 0 : sim->step.alpha;
}

double pel_sim_alpha_limit(const pel_sim *sim)
{
    if (sim == NULL)
        return 0;
    return sim->alpha_limit;
}

void pel_sim_update_factors(pel_sim *sim, double time)
{
    for (int32_t b = 0; b < sim->model->body_count; b++)
        for (int p = 0; p < PEL_PARAMETER_COUNT; p++) {
            const pel_curve *curve = &sim->model->bodies[b].curves[p];
            if (curve->key_count > 0)
                sim->state->factors[b][p] = pel_curve_value(curve->keys, curve->key_count, time);
        }
}

/* ---- the new positions ---- */

/* the first vertex of the new positions that is out of the bound, or -1 */
int32_t pel_sim_first_outside(const pel_sim *sim)
{
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        if (!pel_sim_is_inside(sim, v))
            return v;
    return -1;
}

bool pel_sim_all_inside(const pel_sim *sim)
{
    return pel_sim_first_outside(sim) < 0;
}

double pel_sim_longest_edge(const pel_sim *sim)
{
    return pel_longest_spring(sim->model, sim->state->position_next, sim->pool, sim->chunk_longest);
}

double pel_sim_fastest_way(const pel_sim *sim)
{
    double square = 0;
    for (int32_t v = 0; v < sim->model->vertex_count; v++) {
        double velocity[3];
        pel_vertex_position(sim->state->velocity, v, velocity);
        square = pel_max(square, pel_vec3_squared_length(velocity));
    }
    return sim->step.dt * sqrt(square);
}

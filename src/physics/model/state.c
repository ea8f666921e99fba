#include "model/state.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "math/vec3.h"
#include "model/shell.h"

#include <string.h>

/* states at rest */
static bool make_rigids(const pel_model *model, pel_state *state)
{
    static const double still[3] = {0};
    size_t count = (size_t)model->body_count;
    bool any = false;
    for (int32_t b = 0; b < model->body_count; b++)
        any |= model->bodies[b].rigid != NULL;
    if (!any)
        return true;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(state->rigids, count), PEL_ROOM(state->rigids_before, count),
                          PEL_ROOM(state->rigids_next, count)))
        return false;
    for (int32_t b = 0; b < model->body_count; b++) {
        if (model->bodies[b].rigid != NULL)
            pel_rigid_state_start(model->bodies[b].rigid, still, still, &state->rigids[b]);
        state->rigids_before[b] = state->rigids_next[b] = state->rigids[b];
    }
    return true;
}

/* shapes without stress are those at rest, or what has grown until the start */
static void start_flows(const pel_model *model, pel_state *state)
{
    for (int32_t b = 0; state->plastic.flows != NULL && b < model->body_count; b++) {
        const pel_shell *shell = model->bodies[b].shell;
        if (shell == NULL || !pel_shell_flows(shell))
            continue;
        pel_flow *flows = state->plastic.flows + shell->first_flow;
        for (int32_t t = 0; t < shell->triangle_count; t++) {
            memcpy(flows[t].inverse, pel_shell_rest(shell, t).inverse, sizeof flows[t].inverse);
            flows[t].growth = 1;
        }
        pel_shell_grow(shell, pel_shell_growth(shell, 0), state->plastic.flows);
        memcpy(state->plastic_next.flows + shell->first_flow, flows, (size_t)shell->triangle_count * sizeof *flows);
    }
}

pel_status pel_state_create(const pel_model *model, bool with_velocity, pel_state **state, pel_error *error)
{
    *state = NULL;
    size_t count = (size_t)model->vertex_count, folds = (size_t)pel_model_fold_count(model),
           flows = (size_t)pel_model_flow_count(model);
    pel_state *made = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    if (!PEL_ALLOCATE_ALL(
            PEL_ROOM_ALIGNED(made->position, count), PEL_ROOM_ALIGNED(made->position_before, count),
            PEL_ROOM_ALIGNED(made->position_next, count), PEL_ROOM(made->contact, count),
            PEL_ROOM(made->factors, model->body_count), PEL_ROOM(made->bending, model->body_count),
            PEL_ROOM_IF(folds > 0, made->plastic.folds, folds), PEL_ROOM_IF(folds > 0, made->plastic_next.folds, folds),
            PEL_ROOM_IF(flows > 0, made->plastic.flows, flows), PEL_ROOM_IF(flows > 0, made->plastic_next.flows, flows),
            PEL_ROOM_ALIGNED_IF(with_velocity, made->velocity, count),
            PEL_ROOM_ALIGNED_IF(with_velocity, made->velocity_next, count))) {
        pel_state_destroy(made);
        return pel_fail_memory(error);
    }
    if (!make_rigids(model, made)) {
        pel_state_destroy(made);
        return pel_fail_memory(error);
    }
    start_flows(model, made);
    made->load_factor = made->load_factor_before = 1;
    for (size_t i = 0; i < count; i++) {
        made->position[i] = model->rest[i];
        made->position[i][3] = model->inverse_mass[i];
    }
    for (int32_t b = 0; b < model->body_count; b++)
        for (int32_t v = 0; model->bodies[b].start != NULL && v < model->bodies[b].mesh->vertex_count; v++)
            for (int k = 0; k < 3; k++)
                made->position[model->bodies[b].model_index[v]][k] = (pel_real)model->bodies[b].start[v][k];
    for (size_t i = 0; i < count; i++)
        made->position_before[i] = made->position_next[i] = made->position[i];
    for (int32_t b = 0; b < model->body_count; b++)
        for (int p = 0; p < PEL_PARAMETER_COUNT; p++) {
            const pel_curve *curve = &model->bodies[b].curves[p];
            made->factors[b][p] = pel_curve_value(curve->keys, curve->key_count, 0);
        }
    *state = made;
    return PEL_OK;
}

/* of pins and momenta that these leave */
static void start_rigid(const pel_model *model, int32_t b, pel_state *state)
{
    const pel_body *body = &model->bodies[b];
    double center[3], velocity[3], spin[3];
    pel_rigid_state_start(body->rigid, body->velocity, body->angular_velocity, &state->rigids[b]);
    pel_rigid_center(body->rigid, &state->rigids[b], center, velocity, spin, NULL);
    for (int32_t v = body->slice_begin * PEL_WIDTH; v < body->slice_end * PEL_WIDTH; v++) {
        double arm[3], turning[3];
        if (!(model->inverse_mass[v] > 0))
            continue;
        pel_vertex_position(state->position, v, arm);
        pel_vec3_subtract(arm, center, arm);
        pel_vec3_cross(spin, arm, turning);
        for (int k = 0; k < 3; k++)
            state->velocity[v][k] = (pel_real)(velocity[k] + turning[k]);
    }
}

static void start_body(const pel_model *model, const pel_body *body, pel_state *state)
{
    int32_t begin = body->slice_begin * PEL_WIDTH, end = body->slice_end * PEL_WIDTH;
    double mass = 0, center[3] = {0};
    for (int32_t v = begin; v < end; v++) {
        double position[3], m = (double)model->mass[v];
        pel_vertex_position(state->position, v, position);
        pel_vec3_along(center, m, position, center);
        mass += m;
    }
    pel_vec3_scale(center, 1 / mass, center);
    for (int32_t v = begin; v < end; v++) {
        double arm[3], turning[3];
        if (!(model->inverse_mass[v] > 0))
            continue;
        pel_vertex_position(state->position, v, arm);
        pel_vec3_subtract(arm, center, arm);
        pel_vec3_cross(body->angular_velocity, arm, turning);
        for (int k = 0; k < 3; k++)
            state->velocity[v][k] = (pel_real)(body->velocity[k] + turning[k]);
    }
}

void pel_state_start(const pel_model *model, pel_state *state)
{
    for (int32_t b = 0; b < model->body_count; b++)
        if (pel_body_moves(&model->bodies[b]) && model->bodies[b].rigid != NULL)
            start_rigid(model, b, state);
        else if (pel_body_moves(&model->bodies[b]))
            start_body(model, &model->bodies[b], state);
}

void pel_state_refill(const pel_model *model, bool with_velocity, pel_state *state)
{
    for (int32_t i = 0; i < model->vertex_count; i++)
        state->position[i][3] = state->position_before[i][3] = state->position_next[i][3] = model->inverse_mass[i];
    if (with_velocity)
        pel_state_start(model, state);
}

pel_status pel_state_add_history(const pel_model *model, pel_state *state, pel_error *error)
{
    size_t count = (size_t)model->vertex_count;
    return PEL_ALLOCATE_ALL(PEL_ROOM_ALIGNED(state->older_position, count),
                            PEL_ROOM_ALIGNED(state->older_velocity, count), PEL_ROOM(state->touched, model->body_count))
               ? PEL_OK
               : pel_fail_memory(error);
}

void pel_state_move_history(const pel_model *model, pel_state *state, double before, double step)
{
    if (state->older_position == NULL || !state->older_is_known || step == before)
        return;
    pel_real by_velocity = (pel_real)step, by_change = (pel_real)(0.5 * step * step / before);
    pel_real share = (pel_real)(step / before);
    for (int32_t v = 0; v < model->vertex_count; v++) {
        pel_record change = state->velocity[v] - state->older_velocity[v];
        state->older_position[v] = state->position[v] - by_velocity * state->velocity[v] + by_change * change;
        state->older_velocity[v] = state->velocity[v] - share * change;
    }
}

void pel_state_destroy(pel_state *state)
{
    if (state == NULL)
        return;
    PEL_FREE_ALL(state->position, state->position_before, state->position_next, state->velocity, state->velocity_next,
                 state->older_position, state->older_velocity, state->touched, state->contact, state->factors,
                 state->bending, state->rigids, state->rigids_before, state->rigids_next, state->plastic.folds,
                 state->plastic.flows, state->plastic_next.folds, state->plastic_next.flows, state);
}

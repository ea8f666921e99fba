#include "refined/event_energy.h"

#include "base/assert.h"
#include "math/vec3.h"

#include <math.h>

/* one spring of a place: its energy, and its force on the place */
static double spring_of(const pel_model *model, const pel_state *state, int32_t place, int32_t slot, double factor,
                        double force[3])
{
    PEL_ASSERT_INDEX(slot, model->slot_begin[model->slice_count]);
    int32_t lane = place % PEL_WIDTH, other = model->neighbours[slot][lane];
    double x[3], y[3], rest = (double)model->rest_lengths[slot][lane];
    double k = factor * (double)model->stiffnesses[slot][lane];
    pel_vertex_position(state->position, place, x);
    pel_vertex_position(state->position, other, y);
    pel_vec3_subtract(y, x, force);
    double length = pel_vec3_length(force), stretch = length - rest;
    pel_vec3_scale(force, length > 0 ? k * stretch / length : 0, force);
    return 0.5 * k * stretch * stretch;
}

/* of all springs of a marked place, those between marked ones by half */
static double energy_of_place(const pel_refined_model *active, double factor, const pel_state *state, int32_t place,
                              pel_record *force)
{
    PEL_ASSERT_INDEX(place, active->model.vertex_count);
    const pel_model *model = &active->model;
    int32_t slice = place / PEL_WIDTH, lane = place % PEL_WIDTH;
    double sum = 0, total[3] = {0, 0, 0}, each[3];
    for (int32_t slot = model->slot_begin[slice]; slot < model->slot_end[slice]; slot++) {
        int32_t other = model->neighbours[slot][lane];
        if (other == place)
            continue;
        double energy = spring_of(model, state, place, slot, factor, each);
        sum += active->is_dirty[other] ? 0.5 * energy : energy;
        pel_vec3_add(total, each, total);
    }
    for (int i = 0; force != NULL && i < 3; i++)
        force[place][i] += (pel_real)total[i];
    return sum;
}

double pel_event_energy(pel_refined_model *active, int32_t body, const pel_state *state, const int32_t *places,
                        int32_t count, pel_record *force)
{
    PEL_ASSERT_INDEX(body, active->model.body_count);
    double sum = 0;
    for (int32_t i = 0; i < count; i++)
        active->is_dirty[places[i]] = 1;
    for (int32_t i = 0; i < count; i++)
        sum += energy_of_place(active, state->factors[body][PEL_SPRING_STIFFNESS], state, places[i], force);
    for (int32_t i = 0; i < count; i++)
        active->is_dirty[places[i]] = 0;
    return sum;
}

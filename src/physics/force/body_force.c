#include "force/body_force.h"
#include "base/assert.h"
#include "math/extremes.h"

#include <math.h>

typedef struct force_loop {
    const pel_model *model;
    const pel_state *state;
    const pel_record *velocity;
    pel_record *force;
} force_loop;

static void force_slice(const force_loop *loop, int32_t slice)
{
    pel_body_force body = pel_slice_force_of(loop->model, loop->state, slice);
    pel_slice own = pel_slice_load(loop->state->position, slice);
    pel_wide longest = pel_wide_splat(0);
    pel_wide3 sum = pel_elastic_force(loop->model, loop->state->position, slice, &own.position, &body, &longest);
    if (loop->velocity != NULL) {
        pel_slice v = pel_slice_load(loop->velocity, slice);
        pel_add_damping(loop->model, slice, &own.position, &v.position, &body, &sum);
    }
    pel_slice_store(loop->force, slice, sum, pel_wide_splat(0));
}

static void force_chunk(void *context, int32_t chunk)
{
    const force_loop *loop = context;
    int32_t first = chunk * PEL_SLICE_CHUNK, end = loop->model->slice_count;
    for (int32_t slice = first; slice < end && slice < first + PEL_SLICE_CHUNK; slice++)
        force_slice(loop, slice);
}

void pel_body_forces(const pel_model *model, const pel_state *state, const pel_record *velocity, pel_pool *pool,
                     pel_record *force)
{
    force_loop loop = {model, state, velocity, force};
    pel_pool_run(pool, pel_slice_chunk_count(0, model->slice_count), force_chunk, &loop);
}

typedef struct length_loop {
    const pel_model *model;
    const pel_record *position;
    int32_t slice_begin, slice_end;
    double *longest;
} length_loop;

static void length_chunk(void *context, int32_t chunk)
{
    const length_loop *loop = context;
    const pel_model *model = loop->model;
    int32_t first = loop->slice_begin + chunk * PEL_SLICE_CHUNK;
    pel_wide longest = pel_wide_splat(0);
    for (int32_t slice = first; slice < loop->slice_end && slice < first + PEL_SLICE_CHUNK; slice++) {
        pel_slice own = pel_slice_load(loop->position, slice);
        longest = pel_wide_max(pel_slice_longest(model, loop->position, slice, &own.position), longest);
    }
    loop->longest[chunk] = (double)pel_wide_largest(longest);
}

double pel_longest_spring(const pel_model *model, const pel_record *position, pel_pool *pool, double *longest)
{
    double most = 0;
    for (int32_t b = 0; b < model->body_count; b++) {
        const pel_body *body = &model->bodies[b];
        length_loop loop = {model, position, body->slice_begin, body->slice_end, longest};
        int32_t chunk_count = pel_slice_chunk_count(body->slice_begin, body->slice_end);
        pel_pool_run(pool, chunk_count, length_chunk, &loop);
        for (int32_t chunk = 0; chunk < chunk_count; chunk++)
            most = pel_max(most, longest[chunk]);
    }
    return most;
}

pel_record pel_elastic_force_at(const pel_model *model, const pel_state *state, const pel_record *position,
                                int32_t vertex)
{
    int32_t slice = vertex / PEL_WIDTH, lane = vertex % PEL_WIDTH;
    pel_body_force body = pel_slice_force_of(model, state, slice);
    pel_slice own = pel_slice_load(position, slice);
    pel_wide longest = pel_wide_splat(0);
    pel_wide3 sum = pel_elastic_force(model, position, slice, &own.position, &body, &longest);
    return (pel_record){sum.x[lane], sum.y[lane], sum.z[lane], 0};
}

void pel_slice_energy(const pel_model *model, const pel_state *state, int32_t slice, pel_wide *spring,
                      pel_wide *volumetric)
{
    PEL_ASSERT_INDEX(slice, model->slice_count);
    pel_body_force body = pel_slice_force_of(model, state, slice);
    pel_slice own = pel_slice_load(state->position, slice);
    pel_wide half = pel_wide_splat((pel_real)0.5), sum = pel_wide_splat(0);
    for (int32_t slot = model->slot_begin[slice]; slot < model->slot_end[slice]; slot++) {
        pel_wide3 d = pel_slot_offset(model, state->position, slot, &own.position);
        pel_wide length = pel_spring_length(d), stiffness = pel_wide_splat(body.stiffness);
        if (!body.uniform)
            stiffness *= model->stiffnesses[slot];
        sum += half * pel_spring_energy(length, pel_slot_rest(model, slot, length), stiffness);
    }
    pel_slice rest = pel_slice_load(model->rest, slice);
    pel_wide3 e = {own.position.x - rest.position.x, own.position.y - rest.position.y,
                   own.position.z - rest.position.z};
    *spring = sum;
    *volumetric = half * pel_wide_splat(body.volumetric_stiffness) * rest.inverse_mass * pel_wide3_dot(e, e);
}

double pel_slice_energy_add(const pel_model *model, const pel_state *state, int32_t slice, bool is_volumetric,
                            double sum)
{
    pel_wide spring, volumetric;
    pel_slice_energy(model, state, slice, &spring, &volumetric);
    for (int lane = 0; lane < PEL_WIDTH; lane++)
        if (model->mesh_vertex[slice * PEL_WIDTH + lane] >= 0)
            sum += (double)spring[lane] + (is_volumetric ? (double)volumetric[lane] : 0);
    return sum;
}

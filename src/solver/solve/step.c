/* Both methods are one sweep over the slices that reads every record once: bytes per vertex and step are the records
   (x, rest, new x and, explicit, v) plus 4 + 8 (4 + 4 in float) per spring end. See docs/performance.md for what that
   costs. */
#include "solve/step.h"

#include "force/body_force.h"
#include "math/extremes.h"

#include <math.h>

/* what a chunk adds to the result */
typedef struct tally {
    pel_wide longest, square; /* the latter of displacements */
    pel_wide_mask inside;
} tally;

typedef struct sweep {
    const pel_model *model;
    pel_state *state;
    const pel_step *step;
    pel_body_force body;
    int32_t slice_begin, slice_end;
} sweep;

#define STEP_INLINE static inline __attribute__((always_inline))

STEP_INLINE void note_position(tally *sum, const pel_wide3 *position, pel_wide3 way, const pel_step *step)
{
    pel_real bound = (pel_real)step->bound;
    sum->inside &= pel_wide3_dot(*position, *position) < pel_wide_splat(bound * bound);
    if (step->ways != NULL)
        sum->square = pel_wide_max(sum->square, pel_wide3_dot(way, way));
}

/* moves the vertices of a slice by the elastic force on them */
STEP_INLINE void quasi_static_slice(const sweep *run, int32_t slice, const pel_slice *own, pel_wide3 force,
                                    bool keep_velocity, tally *sum)
{
    const pel_step *step = run->step;
    pel_state *state = run->state;
    if (keep_velocity) {
        pel_slice before = pel_slice_load(state->position_before, slice);
        pel_wide rate = pel_wide_splat((pel_real)(1 / step->dt));
        pel_wide3 velocity = {rate * (own->position.x - before.position.x),
                              rate * (own->position.y - before.position.y),
                              rate * (own->position.z - before.position.z)};
        pel_add_damping(run->model, slice, &own->position, &velocity, &run->body, &force);
    }
    pel_wide factor = pel_wide_splat((pel_real)(step->alpha * step->dt * step->dt)) * own->inverse_mass;
    pel_wide3 way = {factor * force.x, factor * force.y, factor * force.z};
    if (step->momentum > 0) {
        pel_slice before = pel_slice_load(state->position_before, slice);
        pel_wide share = pel_wide_splat((pel_real)step->momentum);
        way.x += share * (own->position.x - before.position.x);
        way.y += share * (own->position.y - before.position.y);
        way.z += share * (own->position.z - before.position.z);
    }
    pel_wide3 next = {own->position.x + way.x, own->position.y + way.y, own->position.z + way.z};
    note_position(sum, &next, way, step);
    pel_slice_store(state->position_next, slice, next, own->inverse_mass);
}

STEP_INLINE void explicit_slice(const sweep *run, int32_t slice, const pel_slice *own, pel_wide3 force, bool symplectic,
                                tally *sum)
{
    const pel_step *step = run->step;
    pel_state *state = run->state;
    pel_slice speed = pel_slice_load(state->velocity, slice);
    pel_add_damping(run->model, slice, &own->position, &speed.position, &run->body, &force);
    pel_wide dt = pel_wide_splat((pel_real)step->dt), factor = dt * own->inverse_mass;
    pel_wide3 v = speed.position;
    pel_wide3 faster = {v.x + factor * force.x, v.y + factor * force.y, v.z + factor * force.z};
    pel_wide3 used = symplectic ? faster : v;
    pel_wide3 way = {dt * used.x, dt * used.y, dt * used.z};
    pel_wide3 next = {own->position.x + way.x, own->position.y + way.y, own->position.z + way.z};
    note_position(sum, &next, way, step);
    pel_slice_store(state->position_next, slice, next, own->inverse_mass);
    pel_slice_store(state->velocity_next, slice, faster, pel_wide_splat(0));
}

/* the slices first .. last - 1; the flags are constants at each call, so that the branches vanish */
STEP_INLINE void run_slices(const sweep *run, int32_t first, int32_t last, bool explicit_method, bool flag,
                            bool uniform, tally *sum)
{
    const pel_model *model = run->model;
    const pel_record *position = run->state->position;
    pel_slice own = pel_slice_load(position, first);
    pel_slot_flight flight = pel_slot_begin(model, position, model->slot_begin[first], &own.position);
    for (int32_t slice = first; slice < last; slice++) {
        int32_t next = slice + 1 < last ? slice + 1 : slice;
        pel_slice next_own = pel_slice_load(position, next);
        pel_wide3 force = pel_spring_force(model, position, slice, &own.position, next, &next_own.position, uniform,
                                           &flight, &sum->longest);
        pel_add_volumetric(model, slice, &own.position, &run->body, &force);
        if (explicit_method)
            explicit_slice(run, slice, &own, force, flag, sum);
        else
            quasi_static_slice(run, slice, &own, force, flag, sum);
        own = next_own;
    }
}

/* behind the slices from `slice` on that are plain as it is, or not */
static int32_t run_end(const pel_model *model, int32_t slice, int32_t last)
{
    int32_t end = slice + 1;
    if (model->plain_slices == NULL)
        return last;
    while (end < last && model->plain_slices[end] == model->plain_slices[slice])
        end++;
    return end;
}

STEP_INLINE void run_chunk(const sweep *whole, int32_t chunk, bool explicit_method, bool flag)
{
    int32_t first = whole->slice_begin + chunk * PEL_SLICE_CHUNK;
    int32_t last = whole->slice_end - first < PEL_SLICE_CHUNK ? whole->slice_end : first + PEL_SLICE_CHUNK;
    tally sum = {pel_wide_splat(0), pel_wide_splat(0), pel_wide_splat(0) == pel_wide_splat(0)};
    sweep run = *whole;
    for (int32_t begin = first, end; begin < last; begin = end) {
        end = run_end(run.model, begin, last);
        run.body = pel_slice_force_of(run.model, run.state, begin);
        if (run.body.uniform)
            run_slices(&run, begin, end, explicit_method, flag, true, &sum);
        else
            run_slices(&run, begin, end, explicit_method, flag, false, &sum);
    }
    /* an infinite length says that a position left the bound */
    run.step->longest[chunk] = pel_wide_all(sum.inside) ? (double)pel_wide_largest(sum.longest) : HUGE_VAL;
    /* the new position is rounded, which at most doubles a displacement */
    if (run.step->ways != NULL)
        run.step->ways[chunk] = 2 * sqrt((double)pel_wide_largest(sum.square));
}

static void quasi_static_chunk(void *context, int32_t chunk)
{
    run_chunk(context, chunk, false, false);
}

static void kept_velocity_chunk(void *context, int32_t chunk)
{
    run_chunk(context, chunk, false, true);
}

static void forward_chunk(void *context, int32_t chunk)
{
    run_chunk(context, chunk, true, false);
}

static void symplectic_chunk(void *context, int32_t chunk)
{
    run_chunk(context, chunk, true, true);
}

static void sweep_all(const pel_model *model, pel_state *state, const pel_step *step, pel_chunk_function *function,
                      pel_step_result *result)
{
    *result = (pel_step_result){.way_is_known = step->ways != NULL};
    for (int32_t b = 0; b < model->body_count; b++) {
        const pel_body *body = &model->bodies[b];
        sweep run = {.model = model,
                     .state = state,
                     .step = step,
                     .slice_begin = body->slice_begin,
                     .slice_end = body->slice_end};
        int32_t chunk_count = pel_slice_chunk_count(body->slice_begin, body->slice_end);
        pel_pool_run(step->pool, chunk_count, function, &run);
        for (int32_t chunk = 0; chunk < chunk_count; chunk++) {
            result->longest = pel_max(result->longest, step->longest[chunk]);
            result->way = pel_max(result->way, step->ways != NULL ? step->ways[chunk] : 0);
        }
    }
    result->diverged = isinf(result->longest);
}

void pel_step_quasi_static(const pel_model *model, pel_state *state, const pel_step *step, pel_step_result *result)
{
    sweep_all(model, state, step, step->keep_velocity ? kept_velocity_chunk : quasi_static_chunk, result);
}

void pel_step_explicit(const pel_model *model, pel_state *state, const pel_step *step, pel_step_result *result)
{
    sweep_all(model, state, step, step->symplectic ? symplectic_chunk : forward_chunk, result);
}

/* The numbers of batches that change with time and state. */
#include "base/assert.h"
#include "solve/project.h"
#include "solve/softness.h"

static void begin_region(pel_batch *batch, const pel_shell *shell, const pel_solver_def *solver, const pel_state *state,
                         double time)
{
    const pel_shell_region *region = &shell->regions[batch->region];
    const pel_anisotropy_def *def = &region->def;
    if (def->mode == PEL_FIBRE_ACTIVE || def->mode == PEL_FIBRE_MUSCLE)
        batch->law.rest_length =
            (pel_real)(region->amount * pel_curve_value(region->course.keys, region->course.key_count, time));
    if (batch->kind == PEL_CONSTRAINT_CAVE)
        pel_project_cave_begin(batch, shell, state, solver);
    for (int32_t i = 0; batch->is_projected && pel_batch_is_push(batch) && i < batch->block_count * PEL_BLOCK; i++)
        *pel_batch_number(batch, i, PEL_NORMAL_LIMITED) = 0;
}

/* springs without stiffness and the paper's bending without weight do nothing */
static bool has_effect(const pel_batch *batch, const double *factors, double weight)
{
    bool paper = batch->kind == PEL_CONSTRAINT_ISOMETRIC || batch->kind == PEL_CONSTRAINT_ANGLE;
    return !(batch->arity == 2 && !(factors[PEL_SPRING_STIFFNESS] > 0)) && !(paper && weight == 0);
}

void pel_project_body_begin(pel_batches *batches, int32_t body, const pel_solver_def *solver, const pel_state *state,
                            double time)
{
    const pel_body_batches *own = &batches->bodies[body];
    double weight = state->bending[body].weight;
    pel_batches_follow(batches, body, state->position);
    for (int32_t i = 0; i < own->batch_count; i++) {
        pel_batch *batch = &own->batches[i];
        batch->law.weight = (pel_real)weight;
        batch->is_on = batch->is_projected && has_effect(batch, state->factors[body], weight);
        if (batch->region >= 0)
            begin_region(batch, batches->model->bodies[body].shell, solver, state, time);
    }
}

/* A push is no energy that sweeps bring down: each of them adds to it. Five sweeps of one substep push as in paper B;
   other sweeps, substeps and parts of a step give the same acceleration. */
enum { PAPER_SWEEPS = 5 };

static double share_of(const pel_batch *batch, const pel_project_time *time)
{
    return pel_batch_is_push(batch) ? PAPER_SWEEPS / (double)time->iterations * time->ratio * time->ratio : time->share;
}

/* s: viscous over elastic stress at a rate of strain of 1/s */
static double retardation_of(const pel_body *body, const pel_batch *batch)
{
    if (batch->kind == PEL_CONSTRAINT_SPRING)
        return body->spring_retardation;
    if (batch->kind == PEL_CONSTRAINT_ANGLE_COMPLIANT || batch->kind == PEL_CONSTRAINT_FOLD)
        return body->shell->bending_retardation;
    bool is_strain = batch->kind >= PEL_CONSTRAINT_STRAIN && batch->kind < PEL_CONSTRAINT_ISOMETRIC;
    return is_strain ? body->shell->membrane_retardation : 0;
}

void pel_project_body_set_time(const pel_body *body, pel_body_batches *own, const double *factors,
                               const pel_project_time *time)
{
    double tau = time->tau;
    for (int32_t i = 0; i < own->batch_count; i++) {
        pel_batch_law *law = &own->batches[i].law;
        double factor = own->batches[i].arity == 2 ? factors[PEL_SPRING_STIFFNESS] : 1;
        law->square_time = (pel_real)(tau * tau * factor);
        law->inverse_square = (pel_real)(1 / (tau * tau * factor));
        law->force_rate = (pel_real)(1 / (tau * tau));
        law->correction = (pel_real)(time->iterations == 1 ? PEL_MOST_CORRECTION : 0);
        law->viscosity = (pel_real)(retardation_of(body, &own->batches[i]) / time->substep);
        own->batches[i].before = time->before;
        law->share = (pel_real)share_of(&own->batches[i], time);
    }
}

static bool has_fixed(const pel_batch *batch, int32_t block, const uint8_t *is_fixed)
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    const int32_t *steps = batch->steps + (size_t)block * (size_t)batch->arity * PEL_BLOCK;
    for (int32_t i = 0; i < batch->arity * PEL_BLOCK; i++)
        if (is_fixed[steps[i] / PEL_STEP])
            return true;
    return false;
}

void pel_project_body_mark_fixed(pel_body_batches *own, const uint8_t *is_fixed)
{
    for (int32_t i = 0; i < own->batch_count; i++) {
        const pel_batch *batch = &own->batches[i];
        if (!batch->is_projected)
            continue;
        /* caving in has no reaction */
        bool reacts = batch->kind != PEL_CONSTRAINT_CAVE && !pel_batch_is_push(batch);
        for (int32_t block = 0; block < batch->block_count; block++)
            batch->has_fixed[block] = reacts && has_fixed(batch, block, is_fixed);
    }
}

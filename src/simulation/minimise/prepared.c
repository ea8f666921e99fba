#include "minimise/prepared.h"

#include "base/hash.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "stage/plastic.h"

#include <string.h>

pel_status pel_sim_prepared_create(pel_sim *sim, pel_error *error)
{
    pel_newton_base *base = sim->minimise->newton->base = pel_allocate(1, sizeof *base);
    if (base == NULL)
        return pel_fail_memory(error);
    base->is_due = true;
    bool room = PEL_ALLOCATE_ALL(PEL_ROOM(base->unknowns, (size_t)pel_newton_pattern(sim->newton)->unknown_limit),
                                 PEL_ROOM(base->factors, (size_t)sim->model->body_count),
                                 PEL_ROOM(base->point_stiffness, (size_t)sim->model->vertex_count));
    return room ? PEL_OK : pel_fail_memory(error);
}

void pel_sim_prepared_destroy(pel_sim *sim)
{
    pel_newton_base *base = sim->minimise->newton->base;
    if (base == NULL)
        return;
    PEL_FREE_ALL(base->unknowns, base->factors, base->radial, base->point_stiffness);
    pel_free(base);
}

/* inertia and drag, as at the base */
static void set_point_stiffness(const pel_sim *sim, double *stiffness)
{
    const pel_newton_base *base = sim->minimise->newton->base;
    for (int32_t v = 0; v < sim->model->vertex_count; v++) {
        const double *factors = base->factors[sim->model->body_of_slice[v / PEL_WIDTH]];
        double mass = (double)sim->model->mass[v], damping = (double)sim->model->damping[v];
        double drag = factors[PEL_SPRING_DAMPING] * damping + sim->solver.drag * mass;
        stiffness[v] = sim->model->inverse_mass[v] > 0 ? (mass * base->rate + drag) * base->rate : 0;
    }
}

/* the factor at the base */
static pel_status make(pel_sim *sim, const pel_newton_problem *now, pel_error *error)
{
    pel_sim_newton *newton = sim->minimise->newton;
    pel_newton_base *base = newton->base;
    pel_state state = *sim->state;
    state.factors = base->factors;
    pel_tangent_follow(pel_newton_tangent(sim->newton), base->unknowns);
    set_point_stiffness(sim, base->point_stiffness);
    pel_newton_problem problem = *now;
    problem.span = base->span;
    problem.state = &state;
    problem.point_stiffness = base->point_stiffness;
    double(*radial)[4] = newton->radial, *unknowns = newton->unknowns;
    newton->radial = base->radial;
    newton->unknowns = base->unknowns;
    pel_status status = pel_newton_prepare(sim->newton, &problem, base->unknowns, error);
    newton->radial = radial;
    newton->unknowns = unknowns;
    pel_tangent_follow(pel_newton_tangent(sim->newton), unknowns);
    base->is_made = true;
    return status;
}

/* what the matrix depends on, beside positions and fixed unknowns; nothing was spent on steps with its factor yet */
static void take_numbers(pel_sim *sim, const pel_newton_problem *problem)
{
    const pel_sim_newton *newton = sim->minimise->newton;
    pel_newton_base *base = newton->base;
    if (base->radial != NULL)
        memcpy(base->radial, newton->radial, (size_t)sim->model->vertex_count * sizeof *base->radial);
    base->span = problem->span;
    base->wear = (pel_newton_wear){0};
    memcpy(base->factors, sim->state->factors, (size_t)sim->model->body_count * sizeof *base->factors);
}

/* whether the matrix depends on the start of the step: fibres that follow it */
static bool depends_on_start(const pel_sim *sim)
{
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_shell *shell = sim->model->bodies[b].shell;
        for (int32_t r = 0; shell != NULL && r < shell->region_count; r++)
            if (shell->regions[r].def.direction == PEL_FIBRE_PRINCIPAL)
                return true;
    }
    return false;
}

void pel_sim_prepared_take(pel_sim *sim, const pel_newton_problem *problem)
{
    pel_newton_base *base = sim->minimise->newton->base;
    if (!pel_newton_take_prepared(sim->newton, base->unknowns)) {
        base->is_due |= pel_newton_wears(&base->wear, pel_newton_work(sim->newton) - base->begin);
        return;
    }
    take_numbers(sim, problem);
    base->is_due = depends_on_start(sim);
}

pel_status pel_sim_prepared_begin(pel_sim *sim, const pel_newton_problem *problem, pel_error *error)
{
    pel_sim_newton *newton = sim->minimise->newton;
    pel_newton_base *base = newton->base;
    size_t unknowns = (size_t)pel_newton_pattern(sim->newton)->unknown_count;
    uint64_t fixed = pel_plastic_hash(sim, pel_hash_block(PEL_HASH_START, newton->fixed, unknowns));
    if (base->is_due || base->rate != newton->rate || base->fixed != fixed) {
        base->is_due = base->is_made = false;
        base->rate = newton->rate;
        base->fixed = fixed;
        take_numbers(sim, problem);
        memcpy(base->unknowns, newton->unknowns, unknowns * sizeof *base->unknowns);
    }
    const bool is_there = base->is_made && pel_newton_is_prepared(sim->newton);
    const pel_status status = is_there ? PEL_OK : make(sim, problem, error);
    base->begin = pel_newton_work(sim->newton);
    return status;
}

void pel_sim_prepared_transfer(pel_cursor *at, const pel_sim *sim)
{
    pel_newton_base *base = sim->minimise->newton->base;
    size_t unknowns = (size_t)pel_newton_pattern(sim->newton)->unknown_limit;
    pel_transfer(at, &base->is_due, sizeof base->is_due);
    pel_transfer(at, &base->rate, sizeof base->rate);
    pel_transfer(at, &base->span, sizeof base->span);
    pel_transfer(at, &base->fixed, sizeof base->fixed);
    pel_transfer(at, &base->wear, sizeof base->wear);
    pel_transfer(at, base->factors, (size_t)sim->model->body_count * sizeof *base->factors);
    pel_transfer(at, base->unknowns, unknowns * sizeof *base->unknowns);
    if (base->radial != NULL)
        pel_transfer(at, base->radial, (size_t)sim->model->vertex_count * sizeof *base->radial);
}

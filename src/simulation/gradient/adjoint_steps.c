/* Derivatives of a function of a path of steps of the method implicit by adjoint solutions from its last step to its
   first (discrete adjoint: Hairer, Lubich, Wanner, Geometric Numerical Integration, section VI.4.2; here of the schemes
   of step_implicit.c).

   A step seeks y with g(y) + m (rate / dt) (u - carried) + c u = 0, u = rate / dt (y - anchor), and ends at
   x_1 = e y + (1 - e) x, v_1 = e u + (1 - e) v. With a = df/dx_1 and b = df/dv_1 the multipliers are K m' = e a +
   e rate / dt b, K the tangent with inertia and drag on its diagonal; then

     df/dp = m' dF/dp,   df/danchor = s m' - e rate / dt b,   df/dcarried = m rate / dt m',

   with s the stiffness of the springs that represent inertia and drag. Anchor and carried depend on the state at the
   start of the step, under BDF2 on the previous one as well, in the second of two stages on the end of the first one.
   States are kept at every n-th of n^2 steps, those in
   between are recomputed n at a time (Griewank 1992): three steps and one linear system a step, and 2 n states. The
   steps are solved to rounding, so that derivatives are those of their solution. */
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "boundary/loads.h"
#include "constraint/frame.h"
#include "gradient/adjoint.h"
#include "minimise/step_newton.h"
#include "sim/sim.h"

#include <string.h>

typedef struct path {
    pel_sim *sim;
    const pel_adjoint_steps *def;
    pel_adjoint_work work;
    size_t size;      /* of a state */
    int64_t interval; /* steps between states that are kept */
    unsigned char *kept, *between, *end;
    size_t row_count;                        /* vertices of all meshes */
    double *positions, *velocities;          /* (row_count x 3) */
    double *by_positions, *by_velocities;    /* (row_count x 3) */
    double *position, *velocity;             /* (3 vertex_count) derivatives by the state after a step */
    double *older_position, *older_velocity; /* (3 vertex_count) and for the state before it, if known */
} path;

static bool follows_principal(const pel_sim *sim)
{
    bool any = false;
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_shell *shell = sim->model->bodies[b].shell;
        for (int32_t r = 0; shell != NULL && r < shell->region_count; r++)
            any |= shell->regions[r].def.direction == PEL_FIBRE_PRINCIPAL;
    }
    return any;
}

static bool has_moments(const pel_sim *sim)
{
    bool any = false;
    for (int32_t l = 0; l < sim->loads->count; l++)
        any |= sim->def.loads[l].kind == PEL_LOAD_MOMENT;
    return any;
}

static pel_status check(const pel_sim *sim, const pel_adjoint_steps *def, pel_error *error)
{
    if (sim->solver.method != PEL_METHOD_IMPLICIT)
        return pel_refuse(error, PEL_BAD_ARGUMENT,
                          "use it, or pel_sim_adjoint after an equilibrium of the method static",
                          "derivatives of several steps exist only for the method implicit");
    pel_status status = pel_adjoint_check(sim, &def->results, error);
    if (status != PEL_OK)
        return status;
    if (def->step_count < 1 || def->gradient == NULL)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give step_count of at least 1, and gradient",
                          "derivatives of steps need the number of steps and the gradient of the function");
    if (sim->active != NULL)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "leave refine out",
                          "steps of a body that refines have no derivatives");
    if (sim->cuts_done < sim->def.cut_count || sim->tear != NULL)
        return pel_refuse(error, PEL_BAD_ARGUMENT,
                          "leave the toughness, the seams and the cuts out, or take derivatives after the last one",
                          "steps that cut a surface have no derivatives");
    if (sim->minimise->newton->radial != NULL)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "set volumetric.damping to 0, or damp with springs.damping",
                          "damping of volumetric springs has no derivatives along a path");
    if (follows_principal(sim))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give the fibres a direction",
                          "fibres along principal directions have no derivatives along a path");
    if (has_moments(sim))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "use forces", "moments on edges have no derivatives along a path");
    if (sim->solver.budget > 0)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "leave budget out",
                          "steps that end by a budget of time have no derivatives");
    if (pel_house_of(sim)->parts.now.size != PEL_PART_LIMIT)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "make dt smaller", "the last step was divided into parts");
    return PEL_OK;
}

/* ---- room ---- */

static int64_t kept_count(const path *p)
{
    return (p->def->step_count + p->interval - 1) / p->interval;
}

static bool make_room(path *p)
{
    const pel_model *model = p->sim->model;
    size_t unknowns = 3 * (size_t)model->vertex_count;
    for (int32_t b = 0; b < model->body_count; b++)
        p->row_count += (size_t)model->bodies[b].mesh->vertex_count;
    p->size = pel_sim_save_size(p->sim);
    p->interval = (int64_t)ceil(sqrt((double)p->def->step_count));
    p->kept = pel_allocate((size_t)kept_count(p), p->size);
    p->between = pel_allocate((size_t)p->interval, p->size);
    p->end = pel_allocate(1, p->size);
    bool room = p->kept != NULL && p->between != NULL && p->end != NULL;
    double **rows[] = {&p->positions, &p->velocities, &p->by_positions, &p->by_velocities};
    double **vectors[] = {&p->position, &p->velocity, &p->older_position, &p->older_velocity};
    for (int i = 0; i < 4; i++) {
        *rows[i] = pel_allocate(3 * p->row_count, sizeof(double));
        *vectors[i] = pel_allocate(unknowns, sizeof(double));
        room &= *rows[i] != NULL && *vectors[i] != NULL;
    }
    return room;
}

static void release(path *p)
{
    PEL_FREE_ALL(p->kept, p->between, p->end, p->positions, p->velocities, p->by_positions, p->by_velocities,
                 p->position, p->velocity, p->older_position, p->older_velocity);
}

/* ---- forth ---- */

static pel_status step(const path *p, pel_error *error)
{
    pel_sim *sim = p->sim;
    pel_status status = pel_sim_step(sim, error);
    return status == PEL_OK ? pel_adjoint_check_step(sim, error) : status;
}

static pel_status go_forth(const path *p, pel_error *error)
{
    pel_status status = PEL_OK;
    for (int64_t k = 0; status == PEL_OK && k < p->def->step_count; k++) {
        if (k % p->interval == 0)
            pel_sim_save(p->sim, p->kept + (size_t)(k / p->interval) * p->size);
        status = step(p, error);
    }
    pel_sim_save(p->sim, p->end);
    return status;
}

/* ---- back ---- */

/* adds the derivatives of the function by the present state, after a step from 1 */
static pel_status ask(path *p, int64_t number, pel_error *error)
{
    const pel_model *model = p->sim->model;
    size_t first = 0;
    for (int32_t b = 0; b < model->body_count; b++) {
        pel_sim_get_positions(p->sim, b, p->positions + 3 * first);
        pel_sim_get_velocities(p->sim, b, p->velocities + 3 * first);
        first += (size_t)model->bodies[b].mesh->vertex_count;
    }
    memset(p->by_positions, 0, 3 * p->row_count * sizeof(double));
    memset(p->by_velocities, 0, 3 * p->row_count * sizeof(double));
    const pel_adjoint_point point = {number, p->positions, p->velocities, p->by_positions, p->by_velocities};
    if (!p->def->gradient(p->def->user, &point))
        return pel_fail(error, PEL_STOPPED, "stopped at step %lld on the way back", (long long)number);
    size_t row = 0;
    for (int32_t b = 0; b < model->body_count; b++)
        for (int32_t r = 0; r < model->bodies[b].mesh->vertex_count; r++, row++)
            for (size_t k = 0; k < 3; k++) {
                size_t u = 3 * (size_t)model->bodies[b].model_index[r] + k;
                p->position[u] += p->by_positions[3 * row + k];
                p->velocity[u] += p->by_velocities[3 * row + k];
            }
    return PEL_OK;
}

/* with respect to the unknowns of the step; held vertices have no velocity */
static void take_gradient(const path *p, const pel_implicit_scheme *s)
{
    const pel_model *model = p->sim->model;
    double rate = s->rate / p->sim->step.dt;
    memset(p->work.gradient, 0, (size_t)pel_newton_pattern(p->sim->newton)->unknown_count * sizeof(double));
    for (int32_t v = 0; v < model->vertex_count; v++)
        for (int32_t u = 3 * v; u < 3 * v + 3; u++)
            p->work.gradient[u] =
                model->inverse_mass[v] > 0 ? s->end * (p->position[u] + rate * p->velocity[u]) : p->position[u];
}

/* from the state after the step to those before it */
static void carry_back(path *p, const pel_implicit_scheme *s)
{
    const pel_model *model = p->sim->model;
    const double *stiffness = p->sim->minimise->newton->point_stiffness;
    double rate = s->rate / p->sim->step.dt;
    for (int32_t v = 0; v < model->vertex_count; v++) {
        bool moves = model->inverse_mass[v] > 0;
        for (int32_t u = 3 * v; u < 3 * v + 3; u++) {
            double x = p->position[u], w = p->velocity[u], multiplier = p->work.multipliers[u];
            double anchor = moves ? stiffness[v] * multiplier - s->end * rate * w : 0;
            double carried = moves ? (double)model->mass[v] * rate * multiplier : 0;
            double stays = moves ? 1 - s->end : 0;
            p->position[u] = p->older_position[u] + stays * x + s->position[0] * anchor;
            p->velocity[u] = p->older_velocity[u] + stays * w + s->velocity[0] * carried;
            p->older_position[u] = s->position[1] * anchor;
            p->older_velocity[u] = s->velocity[1] * carried;
        }
    }
}

static void swap(double **a, double **b)
{
    double *other = *a;
    *a = *b;
    *b = other;
}

/* The other state of the second stage is the end of the first one, not the step before. */
static pel_status go_back_a_stage(path *p, const pel_implicit_scheme *first, pel_error *error)
{
    swap(&p->position, &p->older_position);
    swap(&p->velocity, &p->older_velocity);
    take_gradient(p, first);
    pel_status status = pel_adjoint_solve_first(&p->work, first, error);
    if (status == PEL_OK)
        carry_back(p, first);
    return status;
}

static pel_status go_back_a_step(path *p, int64_t k, const unsigned char *state, pel_error *error)
{
    pel_status status = pel_sim_load(p->sim, state, p->size, error);
    if (status == PEL_OK)
        status = step(p, error);
    if (status == PEL_OK && (p->def->is_running || k == p->def->step_count - 1))
        status = ask(p, k + 1, error);
    if (status != PEL_OK)
        return status;
    const pel_implicit_scheme *s = p->sim->minimise->newton->scheme;
    take_gradient(p, s);
    status = pel_adjoint_solve(&p->work, s->end, error);
    if (status == PEL_OK)
        carry_back(p, s);
    return status == PEL_OK && s->first != NULL ? go_back_a_stage(p, s->first, error) : status;
}

/* the steps from a state that was kept to the next one */
static pel_status go_back_an_interval(path *p, int64_t number, pel_error *error)
{
    int64_t first = number * p->interval, count = p->def->step_count - first;
    count = count < p->interval ? count : p->interval;
    pel_status status = pel_sim_load(p->sim, p->kept + (size_t)number * p->size, p->size, error);
    for (int64_t k = 0; status == PEL_OK && k < count; k++) {
        pel_sim_save(p->sim, p->between + (size_t)k * p->size);
        if (k + 1 < count)
            status = step(p, error);
    }
    for (int64_t k = count - 1; status == PEL_OK && k >= 0; k--)
        status = go_back_a_step(p, first + k, p->between + (size_t)k * p->size, error);
    return status;
}

static void give_start(const path *p, const double *from, double *rows)
{
    const pel_model *model = p->sim->model;
    for (int32_t b = 0; rows != NULL && b < model->body_count; b++)
        for (int32_t r = 0; r < model->bodies[b].mesh->vertex_count; r++, rows += 3)
            memcpy(rows, from + 3 * (size_t)model->bodies[b].model_index[r], 3 * sizeof *rows);
}

static pel_status go(path *p, pel_error *error)
{
    pel_sim *sim = p->sim;
    bool could_halve = sim->part.can_halve;
    sim->part.can_halve = false;
    sim->minimise->newton->is_exact = true;
    pel_status status = go_forth(p, error);
    for (int64_t i = kept_count(p) - 1; status == PEL_OK && i >= 0; i--)
        status = go_back_an_interval(p, i, error);
    pel_sim_load(sim, status == PEL_OK ? p->end : p->kept, p->size, NULL);
    sim->minimise->newton->is_exact = false;
    sim->part.can_halve = could_halve;
    if (status != PEL_OK)
        return status;
    give_start(p, p->position, p->def->start_positions);
    give_start(p, p->velocity, p->def->start_velocities);
    return PEL_OK;
}

pel_status pel_sim_adjoint_steps(pel_sim *sim, const pel_adjoint_steps *def, pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    PEL_REFUSE_NULL(def, error);
    pel_status status = check(sim, def, error);
    if (status != PEL_OK)
        return status;
    path p = {.sim = sim, .def = def};
    bool room = make_room(&p);
    status = pel_adjoint_begin(&p.work, sim, &def->results, error);
    if (status == PEL_OK)
        status = room ? go(&p, error) : pel_fail_memory(error);
    pel_adjoint_end(&p.work);
    release(&p);
    return status;
}

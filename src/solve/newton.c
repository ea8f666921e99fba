#include "solve/newton_run.h"

#include "base/memory.h"
#include "base/status.h"

#include <math.h>
#include <string.h>

/* full steps of mixed integration points without a new least residual, after which steps of least energy follow; such
   steps in a part of the loads */
enum { PATIENCE = 12, PART_ITERATIONS = 30 };
/* multiples of the masses: the first one, of the stiffness over mass; by how much they shrink and grow */
#define FIRST_SHIFT 1e-2
#define LEAST_SHIFT 1e-12
#define MOST_SHIFT 1e3
#define SHRINK 0.2
#define GROW 4.0
/* of the decrease that a step promises; changes below this share of the energy's parts may be rounding */
#define DECREASE 1e-3
#define ROUNDING 1e-13
/* of the size, by which a balance that is no minimum is left */
#define NUDGE 1e-7
/* parts of the loads, where all at once lead nowhere: the first one, the least; by how much they grow and shrink */
#define FIRST_PART 0.25
#define LEAST_PART (1.0 / 1024)
#define PART_GROWTH 1.5
/* of the forces at the start, that a part but the last may leave */
#define PART_TOLERANCE 1e-4
#define PART_SHRINK 0.5

/* ---- creation ---- */

pel_status pel_newton_create_matrix(const pel_newton *newton, pel_matrix **matrix, pel_error *error)
{
    const pel_tangent_pattern *pattern = newton->pattern;
    int32_t node_count = pattern->vertex_count + pattern->edge_count;
    uint8_t *sizes = pel_allocate((size_t)node_count, 1);
    if (sizes == NULL)
        return pel_fail_memory(error);
    for (int32_t n = 0; n < node_count; n++)
        sizes[n] = n < pattern->vertex_count ? 3 : 1;
    const pel_matrix_def def = {
        .node_count = node_count,
        .node_size = sizes,
        .element_count = pattern->element_count,
        .element_start = pattern->node_begin,
        .element_node = pattern->nodes,
        .element_kind = pattern->element_kind,
    };
    pel_status status = pel_matrix_create(&def, matrix, error);
    pel_free(sizes);
    return status;
}

static void edge_midpoint(const pel_newton *newton, int32_t e, double middle[3])
{
    const int32_t *ends = pel_tangent_edges_of(newton->tangent)[e].vertices;
    for (int k = 0; k < 3; k++)
        middle[k] = 0.5 * ((double)newton->model->rest[ends[0]][k] + (double)newton->model->rest[ends[1]][k]);
}

static pel_status create_plan(pel_newton *newton, pel_error *error)
{
    const pel_tangent_pattern *pattern = newton->pattern;
    double(*places)[3] = pel_allocate((size_t)pattern->vertex_count + (size_t)pattern->edge_count, sizeof *places);
    if (places == NULL)
        return pel_fail_memory(error);
    for (int32_t v = 0; v < pattern->vertex_count; v++)
        pel_vertex_position(newton->model->rest, v, places[v]);
    for (int32_t e = 0; e < pattern->edge_count; e++)
        edge_midpoint(newton, e, places[pattern->vertex_count + e]);
    pel_status status = pel_factor_plan_create(newton->matrix, (const double(*)[3])places, &newton->plan, error);
    pel_free(places);
    return status;
}

/* masses, and lengths to compare with */
static void measure(pel_newton *newton)
{
    const pel_model *model = newton->model;
    const pel_tangent_pattern *pattern = newton->pattern;
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, sum = 0;
    for (int32_t v = 0; v < model->vertex_count; v++)
        for (int k = 0; k < 3; k++) {
            newton->masses[3 * v + k] = (double)model->mass[v];
            low[k] = fmin(low[k], (double)model->rest[v][k]);
            high[k] = fmax(high[k], (double)model->rest[v][k]);
        }
    newton->size = pel_vec3_distance(low, high);
    for (int32_t e = 0; e < pattern->edge_count; e++) {
        const int32_t *ends = pel_tangent_edges_of(newton->tangent)[e].vertices;
        double a[3], b[3];
        pel_vertex_position(model->rest, ends[0], a);
        pel_vertex_position(model->rest, ends[1], b);
        sum += pel_vec3_distance(a, b);
    }
    newton->edge = pattern->edge_count > 0 ? sum / pattern->edge_count : 1;
}

static bool make_room(pel_newton *newton)
{
    const pel_tangent_pattern *pattern = newton->pattern;
    size_t count = (size_t)pattern->unknown_count;
    newton->stresses = pel_allocate((size_t)pattern->stress_count + 1, sizeof *newton->stresses);
    newton->fixed = pel_allocate(count, 1);
    newton->frame = pel_allocate((size_t)pattern->vertex_count + (size_t)pattern->edge_count, sizeof *newton->frame);
    double **vectors[] = {&newton->gradient,   &newton->right,   &newton->step, &newton->start, &newton->start_gradient,
                          &newton->masses,     &newton->walked,  &newton->move, &newton->path,  &newton->load,
                          &newton->answer,     &newton->balance, &newton->way,  &newton->begin, &newton->part_start,
                          &newton->part_walked};
    bool room = newton->stresses != NULL && newton->fixed != NULL && newton->frame != NULL;
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++)
        room &= (*vectors[i] = pel_allocate(count, sizeof **vectors[i])) != NULL;
    return room;
}

pel_status pel_newton_create(const pel_model *model, pel_pool *pool, pel_newton **newton, pel_error *error)
{
    *newton = NULL;
    pel_newton *made = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    made->model = model;
    made->pool = pool;
    made->precision = PEL_FACTOR_FLOAT;
    pel_status status = pel_tangent_create(model, &made->tangent, error);
    if (status == PEL_OK) {
        made->pattern = pel_tangent_pattern_of(made->tangent);
        status = make_room(made) ? pel_newton_create_matrix(made, &made->matrix, error) : pel_fail_memory(error);
    }
    if (status == PEL_OK)
        status = create_plan(made, error);
    if (status == PEL_OK)
        status = pel_factor_create(made->plan, PEL_FACTOR_FLOAT, &made->factors[PEL_FACTOR_FLOAT], error);
    if (status == PEL_OK)
        status = pel_pcg_create(made->pattern->unknown_count, &made->pcg, error);
    if (status != PEL_OK) {
        pel_newton_destroy(made);
        return status;
    }
    measure(made);
    *newton = made;
    return PEL_OK;
}

void pel_newton_destroy(pel_newton *newton)
{
    if (newton == NULL)
        return;
    pel_pcg_destroy(newton->pcg);
    pel_minres_destroy(newton->minres);
    for (int p = 0; p < 2; p++)
        pel_factor_destroy(newton->factors[p]);
    pel_factor_plan_destroy(newton->plan);
    pel_matrix_destroy(newton->matrix);
    pel_tangent_destroy(newton->tangent);
    void *arrays[] = {newton->gradient, newton->right,          newton->step,       newton->start,
                      newton->masses,   newton->start_gradient, newton->stresses,   newton->fixed,
                      newton->walked,   newton->move,           newton->frame,      newton->path,
                      newton->load,     newton->answer,         newton->balance,    newton->way,
                      newton->begin,    newton->part_start,     newton->part_walked};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        pel_free(arrays[i]);
    pel_free(newton);
}

const pel_tangent_pattern *pel_newton_pattern(const pel_newton *newton)
{
    return newton->pattern;
}

pel_tangent *pel_newton_tangent(const pel_newton *newton)
{
    return newton->tangent;
}

const double *pel_newton_gradient(const pel_newton *newton)
{
    return newton->gradient;
}

const double *pel_newton_turns(const pel_newton *newton)
{
    return newton->walked + 3 * (size_t)newton->pattern->vertex_count;
}

double pel_newton_moment_force(const pel_newton *newton, const double *loads)
{
    double square = 0;
    for (int32_t u = 3 * newton->pattern->vertex_count; u < newton->pattern->unknown_count; u++)
        square += loads[u] * loads[u];
    return sqrt(square) / newton->edge;
}

pel_newton_system pel_newton_system_of(const pel_newton *newton)
{
    return (pel_newton_system){newton->model, newton->tangent, newton->matrix,
                               newton->plan,  newton->pool,    newton->masses};
}

/* Full steps of mixed integration points. False where they lead nowhere. */
static bool go_full_steps(newton_run *run)
{
    pel_newton_result *result = run->result;
    double best = HUGE_VAL;
    int since = 0;
    for (;;) {
        run->kind = PEL_TANGENT_EXACT;
        pel_newton_evaluate(run);
        if (!pel_newton_is_finite(run))
            return false;
        if (result->iterations == 0)
            result->first_residual = result->residual;
        if (pel_newton_has_converged(run) || result->iterations >= run->limit)
            return true;
        since = result->residual < best ? 0 : since + 1;
        best = fmin(best, result->residual);
        if (since > PATIENCE)
            return false;
        if (!pel_newton_find_step(run)) {
            run->kind = PEL_TANGENT_POSITIVE;
            run->has_stresses = false;
            pel_newton_evaluate(run);
            if (run->status != PEL_OK || !pel_newton_find_step(run))
                return false;
        }
        double share = pel_newton_find_share(run->newton);
        pel_newton_extrapolate(run, share);
        pel_newton_go(run, share);
        if (share == 1 && pel_newton_longest_move(run->newton) <= run->problem->short_move) {
            pel_newton_evaluate(run);
            result->converged = result->is_near = pel_newton_is_finite(run);
            return result->converged;
        }
    }
}

/* ---- steps of least energy ---- */

static double slope_of(const pel_newton *newton)
{
    double slope = 0;
    for (int32_t u = 0; u < newton->pattern->unknown_count; u++)
        slope += newton->fixed[u] ? 0 : newton->start_gradient[u] * newton->step[u];
    return slope;
}

/* The least shift, from the present one, under which the matrix is positive; false beyond the largest. */
static bool find_shifted_step(newton_run *run, double most)
{
    while (run->shift <= most) {
        if (pel_newton_find_step(run))
            return true;
        if (run->status != PEL_OK)
            return false;
        run->shift = fmax(GROW * run->shift, LEAST_SHIFT * most);
    }
    return false;
}

/* One step downhill from the last evaluation; false where there is none. */
static bool go_downhill(newton_run *run, double most)
{
    pel_newton *newton = run->newton;
    size_t bytes = (size_t)newton->pattern->unknown_count * sizeof(double);
    double energy = run->result->energy, residual = run->result->residual, parts = run->parts;
    memcpy(newton->start, run->unknowns, bytes);
    memcpy(newton->start_gradient, newton->gradient, bytes);
    while (find_shifted_step(run, most)) {
        double slope = slope_of(newton);
        pel_newton_go(run, pel_newton_find_share(newton));
        pel_newton_evaluate(run);
        double fall = energy - run->result->energy;
        if (pel_newton_is_finite(run) && (fall >= -DECREASE * slope - ROUNDING * parts ||
                                          (fall >= -ROUNDING * parts && run->result->residual < residual))) {
            run->shift = run->shift > LEAST_SHIFT * most ? SHRINK * run->shift : 0;
            return true;
        }
        memcpy(run->unknowns, newton->start, bytes);
        pel_newton_evaluate(run);
        run->shift = fmax(GROW * run->shift, LEAST_SHIFT * most);
        if (run->result->iterations >= run->limit)
            return false;
    }
    return false;
}

/* fixed unknowns are at their targets from here on */
static void go_to_targets(newton_run *run)
{
    pel_newton *newton = run->newton;
    for (int32_t u = 0; u < newton->pattern->unknown_count; u++) {
        newton->step[u] = newton->fixed[u] ? pel_newton_way_to_target(run, u) : 0;
        newton->walked[u] += newton->step[u];
    }
    pel_tangent_advance(newton->tangent, run->unknowns, pel_newton_find_move(run, 1), 1, newton->pool);
}

static void go_down(newton_run *run)
{
    pel_newton *newton = run->newton;
    run->kind = PEL_TANGENT_EXACT;
    run->has_stresses = false;
    go_to_targets(run);
    pel_newton_evaluate(run);
    pel_newton_assemble(run);
    double most = MOST_SHIFT * pel_newton_stiffness_scale(newton);
    run->shift = FIRST_SHIFT / MOST_SHIFT * most;
    while (run->status == PEL_OK && !pel_newton_has_converged(run) && run->result->iterations < run->limit)
        if (!go_downhill(run, most)) {
            run->result->stuck = run->status == PEL_OK;
            break;
        }
    run->shift = 0;
}

/* ---- loads in parts ---- */

/* forces that hold the start, and the ways of what is moved */
static void balance_start(newton_run *run)
{
    pel_newton *newton = run->newton;
    run->kind = PEL_TANGENT_EXACT;
    run->has_stresses = false;
    run->share = 0;
    pel_newton_evaluate(run);
    memcpy(newton->balance, newton->gradient, (size_t)newton->pattern->unknown_count * sizeof(double));
    pel_newton_frames_turn_back(&run->problem->frames, newton->balance);
    for (int32_t u = 0; u < newton->pattern->unknown_count; u++)
        newton->way[u] = pel_newton_way_to_target(run, u);
}

/* Forces that balance the start fade out part by part, each a run of full steps that begins where the last one ended;
   false where even the least part finds no balance. For what has no energy to go down (moments on edges), or too long a
   way. */
static bool go_in_parts(newton_run *run)
{
    pel_newton *newton = run->newton;
    size_t bytes = (size_t)newton->pattern->unknown_count * sizeof(double);
    double left = 1, part = FIRST_PART;
    balance_start(run);
    double forces = run->result->residual;
    while (left > 0 && part >= LEAST_PART) {
        memcpy(newton->part_start, run->unknowns, bytes);
        memcpy(newton->part_walked, newton->walked, bytes);
        run->share = left - part > LEAST_PART ? left - part : 0;
        run->loose = run->share > 0 ? PART_TOLERANCE * forces : 0;
        run->limit = run->result->iterations + (run->share > 0 ? PART_ITERATIONS : run->problem->iterations);
        run->has_stresses = false;
        if (go_full_steps(run) && run->result->converged) {
            left = run->share;
            part *= PART_GROWTH;
            continue;
        }
        if (run->status != PEL_OK)
            break;
        memcpy(run->unknowns, newton->part_start, bytes);
        memcpy(newton->walked, newton->part_walked, bytes);
        part *= PART_SHRINK;
    }
    run->share = run->loose = 0;
    return left == 0;
}

/* ---- stability ---- */

/* the exact tangent at the end has a factor */
static bool is_stable(newton_run *run)
{
    run->kind = PEL_TANGENT_EXACT;
    run->has_stresses = false;
    run->shift = 0;
    pel_newton_evaluate(run);
    pel_newton_assemble(run);
    return pel_newton_make_factor(run);
}

/* A small move of all free vertices, always the same; the steps downhill find where it grows. */
static void nudge(newton_run *run)
{
    pel_newton *newton = run->newton;
    uint32_t random = 1;
    for (int32_t u = 0; u < 3 * newton->pattern->vertex_count; u++) {
        random = random * 1664525u + 1013904223u;
        if (!newton->fixed[u] && newton->frame[u / 3] < 0)
            run->unknowns[u] += NUDGE * newton->size * ((double)(random >> 8) / (1 << 23) - 1);
    }
}

/* From a balance that is no minimum downhill to one that is; where there is none within reach, back to the balance. */
static void leave_balance(newton_run *run)
{
    pel_newton *newton = run->newton;
    size_t bytes = (size_t)newton->pattern->unknown_count * sizeof(double);
    memcpy(newton->part_start, run->unknowns, bytes);
    memcpy(newton->part_walked, newton->walked, bytes);
    run->limit = run->result->iterations + run->problem->iterations;
    nudge(run);
    go_down(run);
    if (run->status != PEL_OK || (run->result->converged && is_stable(run)))
        return;
    memcpy(run->unknowns, newton->part_start, bytes);
    memcpy(newton->walked, newton->part_walked, bytes);
    run->kind = PEL_TANGENT_EXACT;
    run->has_stresses = false;
    pel_newton_evaluate(run);
    run->result->converged = run->status == PEL_OK;
    run->result->stuck = false;
    run->result->unstable = true;
}

/* ---- a run ---- */

static void return_to_begin(newton_run *run)
{
    size_t bytes = (size_t)run->newton->pattern->unknown_count * sizeof(double);
    memcpy(run->unknowns, run->newton->begin, bytes);
    memset(run->newton->walked, 0, bytes);
    run->has_stresses = false;
    run->limit += run->problem->iterations;
}

pel_status pel_newton_run(pel_newton *newton, const pel_newton_problem *problem, double *unknowns,
                          pel_newton_result *result, pel_error *error)
{
    newton_run run = pel_newton_run_of(newton, problem, unknowns, result, error);
    size_t bytes = (size_t)newton->pattern->unknown_count * sizeof(double);
    *result = (pel_newton_result){0};
    pel_newton_fix_unknowns(&run);
    memcpy(newton->start, unknowns, bytes);
    memcpy(newton->begin, unknowns, bytes);
    run.limit = problem->iterations;
    if (!go_full_steps(&run) && run.status == PEL_OK) {
        return_to_begin(&run);
        go_down(&run);
    }
    if (run.status == PEL_OK && !result->converged && !problem->is_dynamic) {
        return_to_begin(&run);
        go_in_parts(&run);
    }
    if (run.status == PEL_OK && result->converged && !problem->is_dynamic && !is_stable(&run) && run.status == PEL_OK)
        leave_balance(&run);
    pel_newton_frames_turn_back(&problem->frames, newton->gradient);
    return run.status;
}

void pel_newton_forget(pel_newton *newton)
{
    newton->has_factor = false;
    newton->precision = PEL_FACTOR_FLOAT;
}

/* ---- a preconditioner ---- */

bool pel_newton_approximate(pel_newton *newton, const pel_newton_problem *problem, const double *unknowns, double shift)
{
    pel_newton_result result = {0};
    memcpy(newton->start, unknowns, (size_t)newton->pattern->unknown_count * sizeof *unknowns);
    newton_run run = pel_newton_run_of(newton, problem, newton->start, &result, NULL);
    run.kind = PEL_TANGENT_POSITIVE;
    double pivot;
    pel_newton_fix_unknowns(&run);
    pel_newton_evaluate(&run);
    pel_newton_assemble(&run);
    return pel_newton_compute_factor(&run, shift, &pivot);
}

void pel_newton_precondition(pel_newton *newton, double *vector)
{
    size_t vertices = 3 * (size_t)newton->pattern->vertex_count;
    memcpy(newton->right, vector, vertices * sizeof *vector);
    memset(newton->right + vertices, 0, (size_t)newton->pattern->edge_count * sizeof *vector);
    pel_factor_solve(newton->factors[newton->precision], newton->pool, newton->right, newton->step);
    memcpy(vector, newton->step, vertices * sizeof *vector);
}

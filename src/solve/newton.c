#include "solve/newton.h"

#include "base/hash.h"
#include "base/memory.h"
#include "base/status.h"
#include "linear/pcg.h"

#include <math.h>
#include <string.h>

/* full steps of mixed integration points without a new least residual, after which steps of least energy follow */
enum { PATIENCE = 12, DYNAMIC_PATIENCE = 6 };
/* such steps after which all that follow go only to where constraints take their slope away; evaluations of that */
enum { STALLED = 1, SEARCHES = 12 };
/* a slope of so much of that at the begin counts as zero; one steeper than FLAT of it pays to go on, up to MOST_SHARE
   times the step */
#define STEEP 0.2
#define FLAT 0.5
#define MOST_SHARE 16
/* no vertex goes farther than this share of the model's size in one step */
#define LONGEST_SHARE 0.5
/* fixed unknowns this near to their targets, of the size, are there: rounding */
#define SHORT_SHARE 1e-12
/* of conjugate gradients, relative */
#define SOLVE_TOLERANCE 1e-8
/* products with a new factor at most; with a kept one, more of them ask for a new one */
enum { MOST_PRODUCTS = 200, KEPT_PRODUCTS = 8 };
/* on the diagonal of a float factor near its limit of condition */
#define FLOAT_SHIFT 1e-7
/* a pivot in float, over its diagonal, that is below minus this is none of rounding */
#define ROUGH_PIVOT 1e-3
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

struct pel_newton {
    const pel_model *model;
    pel_pool *pool;
    pel_tangent *tangent;
    const pel_tangent_pattern *pattern;
    pel_matrix *matrix;
    pel_factor_plan *plan;
    pel_factor *factors[2]; /* by precision; that in double is made when one in float does not carry */
    pel_factor_precision precision;
    bool has_factor;
    uint64_t couplings; /* hash of those in the pattern */
    bool is_outdated;   /* the pattern is that of an older surface, or there was no memory for one */
    bool is_stale;      /* the pattern may have other couplings than the present run */
    pel_pcg *pcg;
    double *gradient, *right, *step, *start, *start_gradient; /* (unknown_count) */
    double *walked;                                           /* (unknown_count) sum of the steps of a run */
    double *best, *best_walked;                               /* (unknown_count) with the least residual of a run */
    double *move;                                             /* (unknown_count) the step along x, y, z */
    int32_t *frame;                                           /* (node_count) number of its axes, or -1 */
    double *stresses;                                         /* (stress_count) */
    double *masses;                                           /* (unknown_count) kg, 0 on edges */
    uint8_t *fixed;                                           /* (unknown_count) */
    double size;                                              /* m, of the model */
    double edge;                                              /* m, mean length of edges with an unknown */
};

/* one run */
typedef struct newton_run {
    pel_newton *newton;
    const pel_newton_problem *problem;
    double *unknowns;
    pel_newton_result *result;
    pel_error *error;
    pel_status status;
    pel_tangent_kind kind;
    bool has_stresses;
    double shift; /* 1/s2, of the masses */
    double parts; /* J, sum of the sizes of the energy's parts */
    bool has_best;
} newton_run;

/* ---- creation ---- */

static pel_status create_matrix(const pel_newton *newton, int32_t coupling_count, const int32_t (*couplings)[4],
                                pel_matrix **matrix, pel_error *error)
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
        .coupling_count = coupling_count,
        .couplings = couplings,
    };
    pel_status status = pel_matrix_create(&def, matrix, error);
    pel_free(sizes);
    return status;
}

pel_status pel_newton_create_matrix(const pel_newton *newton, pel_matrix **matrix, pel_error *error)
{
    return create_matrix(newton, 0, NULL, matrix, error);
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

static void destroy_system(pel_newton *newton)
{
    for (int p = 0; p < 2; p++) {
        pel_factor_destroy(newton->factors[p]);
        newton->factors[p] = NULL;
    }
    pel_factor_plan_destroy(newton->plan);
    pel_matrix_destroy(newton->matrix);
    pel_pcg_destroy(newton->pcg);
    newton->pcg = NULL;
    newton->plan = NULL;
    newton->matrix = NULL;
    newton->has_factor = false;
    newton->precision = PEL_FACTOR_FLOAT;
}

static uint64_t hash_couplings(int32_t count, const int32_t (*couplings)[4])
{
    return count > 0 ? pel_hash_bytes(PEL_HASH_START, couplings, (size_t)count * sizeof *couplings) : 0;
}

/* matrix, plan, factor and room to solve, with blocks for some couplings */
static pel_status create_system(pel_newton *newton, int32_t count, const int32_t (*couplings)[4], pel_error *error)
{
    destroy_system(newton);
    pel_status status = create_matrix(newton, count, couplings, &newton->matrix, error);
    if (status == PEL_OK)
        status = create_plan(newton, error);
    if (status == PEL_OK)
        status = pel_factor_create(newton->plan, PEL_FACTOR_FLOAT, &newton->factors[PEL_FACTOR_FLOAT], error);
    if (status == PEL_OK)
        status = pel_pcg_create(newton->pattern->unknown_count, &newton->pcg, error);
    newton->is_outdated = status != PEL_OK;
    newton->couplings = hash_couplings(count, couplings);
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
    size_t count = (size_t)pattern->unknown_limit, nodes = (size_t)pattern->vertex_count + (size_t)pattern->edge_limit;
    newton->stresses = pel_allocate((size_t)pattern->stress_limit + 1, sizeof *newton->stresses);
    newton->fixed = pel_allocate(count, 1);
    newton->frame = pel_allocate(nodes, sizeof *newton->frame);
    double **vectors[] = {&newton->gradient, &newton->right,  &newton->step, &newton->start, &newton->start_gradient,
                          &newton->masses,   &newton->walked, &newton->move, &newton->best,  &newton->best_walked};
    bool room = newton->stresses != NULL && newton->fixed != NULL && newton->frame != NULL;
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++)
        room &= (*vectors[i] = pel_allocate(count, sizeof **vectors[i])) != NULL;
    return room;
}

void pel_newton_follow(pel_newton *newton)
{
    pel_tangent_rebuild(newton->tangent);
    measure(newton);
    newton->is_outdated = true;
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
        status = make_room(made) ? create_system(made, 0, NULL, error) : pel_fail_memory(error);
    }
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
    destroy_system(newton);
    pel_tangent_destroy(newton->tangent);
    void *arrays[] = {newton->gradient,       newton->right,    newton->step,       newton->start,  newton->masses,
                      newton->start_gradient, newton->stresses, newton->fixed,      newton->walked, newton->move,
                      newton->frame,          newton->best,     newton->best_walked};
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

pel_newton_system pel_newton_system_of(const pel_newton *newton)
{
    return (pel_newton_system){newton->model, newton->tangent, newton->matrix,
                               newton->plan,  newton->pool,    newton->masses};
}

/* ---- energy, forces, matrix ---- */

/* loads are constant forces on positions and moments on edges; a moment has no part in the energy */
static double add_loads(const newton_run *run)
{
    const pel_newton *newton = run->newton;
    const double *force = run->problem->force;
    double sum = 0;
    for (int32_t u = 0; force != NULL && u < newton->pattern->unknown_count; u++) {
        newton->gradient[u] -= force[u];
        if (u < 3 * newton->pattern->vertex_count)
            sum -= force[u] * (run->unknowns[u] - (double)newton->model->rest[u / 3][u % 3]);
    }
    return sum;
}

/* vectors of unknowns: from x, y, z to the axes of the vertices that have some, and back */
static void turn(const newton_run *run, double *vector)
{
    const pel_newton_frames *frames = &run->problem->frames;
    for (int32_t f = 0; f < frames->count; f++) {
        double *x = vector + 3 * (size_t)frames->vertices[f], turned[3];
        for (int k = 0; k < 3; k++)
            turned[k] = pel_vec3_dot(frames->axes[f][k], x);
        pel_vec3_copy(turned, x);
    }
}

static void turn_back(const newton_run *run, double *vector)
{
    const pel_newton_frames *frames = &run->problem->frames;
    for (int32_t f = 0; f < frames->count; f++) {
        double *x = vector + 3 * (size_t)frames->vertices[f], turned[3] = {0};
        for (int k = 0; k < 3; k++)
            pel_vec3_along(turned, x[k], frames->axes[f][k], turned);
        pel_vec3_copy(turned, x);
    }
}

/* gradients of volumes lie as those of pel_tangent_evaluate */
static void turn_rank_ones(const newton_run *run)
{
    const pel_newton_frames *frames = &run->problem->frames;
    const pel_tangent_pattern *pattern = run->newton->pattern;
    for (int32_t r = 0; r < pattern->rank_one_count; r++)
        for (int32_t f = 0; f < frames->count; f++) {
            const pel_rank_one *one = &pattern->rank_ones[r];
            int32_t v = frames->vertices[f] - one->first_vertex;
            if (v < 0 || v >= one->vertex_count)
                continue;
            double *x = one->gradient + 3 * (size_t)v, turned[3];
            for (int k = 0; k < 3; k++)
                turned[k] = pel_vec3_dot(frames->axes[f][k], x);
            pel_vec3_copy(turned, x);
        }
}

/* a moment as the force that it is at the end of an edge */
static double force_of(const pel_newton *newton, int32_t u)
{
    return u < 3 * newton->pattern->vertex_count ? newton->gradient[u] : newton->gradient[u] / newton->edge;
}

static void measure_forces(const newton_run *run)
{
    const pel_newton *newton = run->newton;
    double free = 0, held = 0;
    for (int32_t u = 0; u < newton->pattern->unknown_count; u++) {
        double force = force_of(newton, u);
        *(newton->fixed[u] ? &held : &free) += force * force;
    }
    run->result->residual = sqrt(free);
    run->result->held_force = sqrt(held);
}

/* energy at the unknowns, and gradient along the axes of the vertices */
static void evaluate(newton_run *run)
{
    pel_newton *newton = run->newton;
    const pel_newton_problem *problem = run->problem;
    const pel_tangent_input input = {
        .unknowns = run->unknowns,
        .time = problem->time,
        .state = problem->state,
        .kind = run->kind,
        .stresses = run->has_stresses ? newton->stresses : NULL,
        .point_stiffness = problem->point_stiffness,
        .points = problem->points,
    };
    pel_tangent_energy energy = pel_tangent_evaluate(newton->tangent, &input, newton->pool, newton->gradient);
    double loads = add_loads(run), terms = 0;
    if (problem->terms != NULL)
        terms = problem->terms->evaluate(problem->terms->context, run->unknowns, newton->gradient);
    run->parts = fabs(energy.membrane) + fabs(energy.fibres) + fabs(energy.bending) + fabs(energy.edges) +
                 fabs(energy.springs) + fabs(energy.points) + fabs(energy.pressure) + fabs(loads) + fabs(terms);
    run->result->energy = pel_tangent_energy_sum(&energy) + loads + terms;
    turn(run, newton->gradient);
    turn_rank_ones(run);
    measure_forces(run);
}

static bool is_finite(const newton_run *run)
{
    return isfinite(run->result->energy) && isfinite(run->result->residual) && isfinite(run->result->held_force);
}

/* of a position, along the axes of its vertex */
static double coordinate(const newton_run *run, int32_t u)
{
    int32_t frame = run->newton->frame[u / 3];
    if (frame < 0)
        return run->unknowns[u];
    return pel_vec3_dot(run->problem->frames.axes[frame][u % 3], run->unknowns + 3 * (size_t)(u / 3));
}

/* what fixed unknowns have before them */
static double way_to_target(const newton_run *run, int32_t u)
{
    const pel_newton *newton = run->newton;
    bool is_position = u < 3 * newton->pattern->vertex_count;
    if (run->problem->fixed == NULL || !run->problem->fixed[u])
        return 0;
    return run->problem->target[u] - (is_position ? coordinate(run, u) : newton->walked[u]);
}

/* ---- linear systems ---- */

/* y += sum of coefficient g (g . x) over bodies with a gas or a kept volume, on unknowns that move */
static void add_rank_ones(void *context, pel_pool *pool, const double *x, double *y)
{
    const pel_newton *newton = context;
    (void)pool;
    for (int32_t r = 0; r < newton->pattern->rank_one_count; r++) {
        const pel_rank_one *one = &newton->pattern->rank_ones[r];
        const int32_t begin = 3 * one->first_vertex, count = 3 * one->vertex_count;
        double product = 0;
        for (int32_t i = 0; one->coefficient > 0 && i < count; i++)
            product += newton->fixed[begin + i] ? 0 : one->gradient[i] * x[begin + i];
        for (int32_t i = 0; one->coefficient > 0 && i < count; i++)
            y[begin + i] += newton->fixed[begin + i] ? 0 : one->coefficient * product * one->gradient[i];
    }
}

/* what the ways of fixed unknowns do through these */
static void shift_rank_ones(const newton_run *run)
{
    pel_newton *newton = run->newton;
    for (int32_t r = 0; r < newton->pattern->rank_one_count; r++) {
        const pel_rank_one *one = &newton->pattern->rank_ones[r];
        const int32_t begin = 3 * one->first_vertex, count = 3 * one->vertex_count;
        double product = 0;
        for (int32_t i = 0; i < count; i++)
            product += newton->fixed[begin + i] ? one->gradient[i] * newton->step[begin + i] : 0;
        for (int32_t i = 0; i < count; i++)
            newton->right[begin + i] -= newton->fixed[begin + i] ? 0 : one->coefficient * product * one->gradient[i];
    }
}

static bool has_volume_terms(const pel_newton *newton)
{
    for (int32_t r = 0; r < newton->pattern->rank_one_count; r++)
        if (newton->pattern->rank_ones[r].coefficient > 0)
            return true;
    return false;
}

static bool has_blocks(const pel_newton *newton, int32_t count, const int32_t (*couplings)[4])
{
    for (int32_t c = 0; c < count; c++)
        for (int i = 1; i < 4; i++)
            for (int j = 0; j < i; j++)
                if (pel_matrix_block(newton->matrix, couplings[c][i], couplings[c][j]) < 0)
                    return false;
    return true;
}

/* Blocks for what the terms couple. Where a run begins the pattern is that of its own couplings alone: so its bits do
   not depend on the runs before. */
static pel_status couple(newton_run *run)
{
    pel_newton *newton = run->newton;
    const pel_newton_terms *terms = run->problem->terms;
    const int32_t(*couplings)[4] = NULL;
    int32_t acting = 0, count = 0;
    if (terms != NULL && terms->list_couplings != NULL)
        count = terms->list_couplings(terms->context, &couplings, &acting);
    bool is_right = !newton->is_outdated;
    if (is_right)
        is_right = newton->is_stale ? newton->couplings == hash_couplings(count, couplings)
                                    : has_blocks(newton, acting, couplings);
    newton->is_stale = false;
    return is_right ? PEL_OK : create_system(newton, count, couplings, run->error);
}

/* The matrix of the last evaluation, with fixed unknowns taken out, and the right side. */
static void assemble(newton_run *run)
{
    pel_newton *newton = run->newton;
    run->status = couple(run);
    if (run->status != PEL_OK)
        return;
    pel_matrix_assemble(newton->matrix, newton->pool, pel_tangent_matrices, newton->tangent);
    if (run->problem->terms != NULL)
        run->problem->terms->add_matrix(run->problem->terms->context, newton->matrix);
    if (run->shift > 0)
        pel_matrix_add_diagonal(newton->matrix, run->shift, newton->masses);
    if (run->problem->frames.count > 0)
        pel_matrix_turn(newton->matrix, newton->pool, newton->frame, run->problem->frames.axes);
    for (int32_t u = 0; u < newton->pattern->unknown_count; u++) {
        newton->step[u] = newton->fixed[u] ? way_to_target(run, u) : 0;
        newton->right[u] = newton->fixed[u] ? 0 : -newton->gradient[u];
    }
    shift_rank_ones(run);
    pel_matrix_fix(newton->matrix, newton->pool, newton->fixed, newton->step, newton->right);
}

static bool compute_factor(newton_run *run, double shift, double *pivot)
{
    pel_newton *newton = run->newton;
    pel_factor_result made =
        pel_factor_compute(newton->factors[newton->precision], newton->matrix, shift, newton->pool);
    newton->has_factor = made.positive_definite;
    *pivot = made.pivot;
    return made.positive_definite;
}

/* in float, with a little on the diagonal, then in double from now on; false where the matrix is not positive */
static bool make_factor(newton_run *run)
{
    pel_newton *newton = run->newton;
    double pivot;
    if (compute_factor(run, 0, &pivot))
        return true;
    if (newton->precision == PEL_FACTOR_DOUBLE || pivot < -ROUGH_PIVOT)
        return false;
    if (compute_factor(run, FLOAT_SHIFT, &pivot))
        return true;
    if (pivot < -ROUGH_PIVOT)
        return false;
    pel_factor **factor = &newton->factors[PEL_FACTOR_DOUBLE];
    if (*factor == NULL)
        run->status = pel_factor_create(newton->plan, PEL_FACTOR_DOUBLE, factor, run->error);
    if (run->status != PEL_OK)
        return false;
    newton->precision = PEL_FACTOR_DOUBLE;
    return compute_factor(run, 0, &pivot);
}

static pel_pcg_end solve(newton_run *run, int32_t products)
{
    pel_newton *newton = run->newton;
    const pel_pcg_def def = {
        .matrix = newton->matrix,
        .add_product = has_volume_terms(newton) ? add_rank_ones : NULL,
        .added = newton,
        .precondition = pel_factor_solve,
        .preconditioner = newton->factors[newton->precision],
        .tolerance = SOLVE_TOLERANCE,
        .iterations = products,
    };
    return pel_pcg_solve(newton->pcg, &def, newton->pool, newton->right, newton->step).end;
}

/* The step of the matrix; false where that is not positive definite. */
static bool find_step(newton_run *run)
{
    assemble(run);
    if (run->status != PEL_OK)
        return false;
    if (run->problem->keeps_factor && run->newton->has_factor && solve(run, KEPT_PRODUCTS) == PEL_PCG_CONVERGED)
        return true;
    if (!make_factor(run))
        return false;
    pel_pcg_end end = solve(run, MOST_PRODUCTS);
    return end == PEL_PCG_CONVERGED || end == PEL_PCG_LIMIT;
}

/* ---- steps ---- */

static double longest_move(const pel_newton *newton)
{
    double longest = 0;
    for (int32_t v = 0; v < newton->pattern->vertex_count; v++)
        longest = fmax(longest, pel_vec3_length(newton->step + 3 * (size_t)v));
    return longest;
}

/* the step along x, y, z, times a scale */
static const double *find_move(const newton_run *run, double scale)
{
    pel_newton *newton = run->newton;
    for (int32_t u = 0; u < newton->pattern->unknown_count; u++)
        newton->move[u] = scale * newton->step[u];
    turn_back(run, newton->move);
    return newton->move;
}

/* of the step, as far as it is good for */
static double find_share(const pel_newton *newton)
{
    double longest = longest_move(newton), limit = LONGEST_SHARE * newton->size;
    return longest > limit ? limit / longest : 1;
}

/* goes a share of the step */
static void go(newton_run *run, double scale)
{
    pel_newton *newton = run->newton;
    pel_tangent_advance(newton->tangent, run->unknowns, find_move(run, 1), scale, newton->pool);
    for (int32_t u = 0; u < newton->pattern->unknown_count; u++)
        newton->walked[u] += scale * newton->step[u];
    run->result->iterations++;
}

static bool has_converged(newton_run *run)
{
    const pel_newton_problem *problem = run->problem;
    pel_newton_result *result = run->result;
    for (int32_t u = 0; u < run->newton->pattern->unknown_count; u++)
        if (run->newton->fixed[u] && fabs(way_to_target(run, u)) > SHORT_SHARE * run->newton->size)
            return false;
    double held = problem->held_share * result->held_force;
    bool reduced = result->residual <= problem->reduction * result->first_residual;
    result->converged = result->residual <= sqrt(problem->tolerance * problem->tolerance + held * held) ||
                        (reduced && result->residual <= problem->enough);
    return result->converged;
}

static void extrapolate(newton_run *run, double scale)
{
    pel_newton *newton = run->newton;
    const pel_tangent_input input = {
        .unknowns = run->unknowns,
        .time = run->problem->time,
        .state = run->problem->state,
    };
    pel_tangent_extrapolate(newton->tangent, &input, find_move(run, scale), newton->pool, newton->stresses);
    run->has_stresses = true;
}

/* of the energy along the step, by a gradient */
static double slope_of(const pel_newton *newton, const double *gradient)
{
    double slope = 0;
    for (int32_t u = 0; u < newton->pattern->unknown_count; u++)
        slope += newton->fixed[u] ? 0 : gradient[u] * newton->step[u];
    return slope;
}

/* the slope of an energy along the step, at a share of it */
typedef double slope_at(void *context, double share);

typedef struct slope_point {
    double share, slope;
} slope_point;

/* Between a point where an energy falls and one where it rises: where its slope is nearly zero, by the Illinois variant
   of regula falsi (Dowell, Jarratt 1971). The energy itself is of no use there: its changes are those of rounding. */
static double find_zero_slope(slope_point low, slope_point high, double flat, slope_at *slope_of_share, void *context)
{
    double at = high.share, slope = high.slope;
    for (int n = 0; n < SEARCHES && fabs(slope) > flat; n++) {
        at = low.share + (high.share - low.share) * low.slope / (low.slope - high.slope);
        slope = slope_of_share(context, at);
        slope_point *moved = slope > 0 ? &high : &low, *kept = slope > 0 ? &low : &high;
        *moved = (slope_point){at, slope};
        kept->slope *= 0.5;
    }
    return at;
}

/* constraints as they are along the step, the rest as the matrix has it */
typedef struct kinked_slope {
    const pel_newton_terms *terms;
    const double *unknowns, *move;
    double smooth, curvature; /* J, of the rest at the begin */
} kinked_slope;

static double kinked_slope_at(void *context, double share)
{
    const kinked_slope *s = context;
    return s->smooth + s->curvature * share +
           s->terms->find_slope(s->terms->context, s->unknowns, s->move, share, NULL);
}

static bool has_kinks(const newton_run *run)
{
    return run->problem->terms != NULL && run->problem->terms->find_slope != NULL;
}

/* Constraints begin and cease to act along a step, and full steps may go to and fro between them for ever: the share of
   the step at which the slope is zero. The bodies count as linear, since full steps are good for them. */
static double find_kink(const newton_run *run, double share)
{
    pel_newton *newton = run->newton;
    double curvature, before = slope_of(newton, newton->gradient);
    kinked_slope s = {.terms = run->problem->terms, .unknowns = run->unknowns, .move = find_move(run, 1)};
    double kinked = s.terms->find_slope(s.terms->context, s.unknowns, s.move, 0, &curvature);
    s.smooth = before - kinked;
    s.curvature = fmax(0, -before - curvature);
    const slope_point low = {0, before}, high = {share, kinked_slope_at(&s, share)};
    return before < 0 && high.slope > 0 ? find_zero_slope(low, high, -STEEP * before, kinked_slope_at, &s) : share;
}

/* a run along its step */
typedef struct step_walk {
    newton_run *run;
    double share; /* of the step, where it is */
} step_walk;

static double walk_to(void *context, double share)
{
    step_walk *walk = context;
    pel_newton *newton = walk->run->newton;
    double way = share - walk->share;
    pel_tangent_advance(newton->tangent, walk->run->unknowns, find_move(walk->run, 1), way, newton->pool);
    for (int32_t u = 0; u < newton->pattern->unknown_count; u++)
        newton->walked[u] += way * newton->step[u];
    walk->share = share;
    evaluate(walk->run);
    return slope_of(newton, newton->gradient);
}

/* A step of a tangent that was made positive, which is stiffer than the body: to where the slope is zero, beyond the
   step while that pays. */
static void go_to_slope(newton_run *run, double share)
{
    step_walk walk = {.run = run};
    double before = slope_of(run->newton, run->newton->gradient), most = MOST_SHARE * share;
    slope_point low = {0, before}, high = {share, 0};
    run->result->iterations++;
    run->has_stresses = false;
    high.slope = walk_to(&walk, share);
    while (high.slope < FLAT * before && high.share < most && is_finite(run)) {
        low = high;
        high.share *= 2;
        high.slope = walk_to(&walk, high.share);
    }
    if (before < 0 && high.slope > 0)
        find_zero_slope(low, high, -STEEP * before, walk_to, &walk);
}

/* ---- time ---- */

static bool is_late(newton_run *run)
{
    const pel_newton_problem *problem = run->problem;
    run->result->is_late =
        problem->clock != NULL && run->result->iterations > 0 && problem->clock() >= problem->deadline;
    return run->result->is_late;
}

/* Where the residual is less than in any step before. Where a run begins fixed unknowns are not at their targets. */
static void keep_best(newton_run *run, double before)
{
    pel_newton *newton = run->newton;
    size_t bytes = (size_t)newton->pattern->unknown_count * sizeof(double);
    if (run->problem->clock == NULL || !(run->result->residual < before) || run->result->iterations == 0)
        return;
    memcpy(newton->best, run->unknowns, bytes);
    memcpy(newton->best_walked, newton->walked, bytes);
    run->has_best = true;
}

/* back to the best state, unless the present one is better */
static void take_best(newton_run *run, double best)
{
    pel_newton *newton = run->newton;
    size_t bytes = (size_t)newton->pattern->unknown_count * sizeof(double);
    if (!run->has_best || run->result->residual < best)
        return;
    memcpy(run->unknowns, newton->best, bytes);
    memcpy(newton->walked, newton->best_walked, bytes);
    evaluate(run);
}

/* ---- full steps ---- */

/* Full steps of mixed integration points. False where they lead nowhere. */
static bool go_full_steps(newton_run *run)
{
    pel_newton_result *result = run->result;
    double best = HUGE_VAL;
    int since = 0;
    bool searches = false;
    for (;;) {
        run->kind = PEL_TANGENT_EXACT;
        evaluate(run);
        if (!is_finite(run))
            return false;
        if (result->iterations == 0)
            result->first_residual = result->residual;
        if (has_converged(run) || result->iterations >= run->problem->iterations)
            return true;
        if (is_late(run)) {
            take_best(run, best);
            return true;
        }
        since = result->residual < best ? 0 : since + 1;
        keep_best(run, best);
        best = fmin(best, result->residual);
        if (since > (run->problem->is_dynamic ? DYNAMIC_PATIENCE : PATIENCE))
            return false;
        if (!find_step(run)) {
            run->kind = PEL_TANGENT_POSITIVE;
            run->has_stresses = false;
            evaluate(run);
            if (run->status != PEL_OK || !find_step(run))
                return false;
        }
        double share = find_share(run->newton);
        if (run->kind == PEL_TANGENT_POSITIVE) {
            go_to_slope(run, share);
            continue;
        }
        searches |= since >= STALLED && has_kinks(run);
        if (searches)
            share = find_kink(run, share);
        extrapolate(run, share);
        go(run, share);
        if (share == 1 && longest_move(run->newton) <= run->problem->short_move) {
            evaluate(run);
            result->converged = result->is_near = is_finite(run);
            return result->converged;
        }
    }
}

/* ---- steps of least energy ---- */

/* stiffness over mass, a bound of what the shift has to do with */
static double stiffness_scale(const pel_newton *newton)
{
    double stiffness = 0, mass = 0;
    for (int32_t v = 0; v < newton->pattern->vertex_count; v++) {
        int32_t block = pel_matrix_block(newton->matrix, v, v);
        const double *diagonal = newton->matrix->values + newton->matrix->block_start[block];
        if (newton->fixed[3 * v])
            continue;
        stiffness += diagonal[0] + diagonal[4] + diagonal[8];
        mass += 3 * newton->masses[3 * v];
    }
    return stiffness / mass;
}

/* The least shift, from the present one, under which the matrix is positive; false beyond the largest. */
static bool find_shifted_step(newton_run *run, double most)
{
    while (run->shift <= most) {
        if (find_step(run))
            return true;
        if (run->status != PEL_OK)
            return false;
        run->shift = fmax(GROW * run->shift, LEAST_SHIFT * most);
    }
    return false;
}

/* One step downhill from the last evaluation; false where there is none. */
static bool go_downhill(newton_run *run, double most, int32_t last)
{
    pel_newton *newton = run->newton;
    size_t bytes = (size_t)newton->pattern->unknown_count * sizeof(double);
    double energy = run->result->energy, residual = run->result->residual, parts = run->parts;
    memcpy(newton->start, run->unknowns, bytes);
    memcpy(newton->start_gradient, newton->gradient, bytes);
    while (find_shifted_step(run, most)) {
        double slope = slope_of(newton, newton->start_gradient);
        go(run, find_share(newton));
        evaluate(run);
        double fall = energy - run->result->energy;
        if (is_finite(run) && (fall >= -DECREASE * slope - ROUNDING * parts ||
                               (fall >= -ROUNDING * parts && run->result->residual < residual))) {
            run->shift = run->shift > LEAST_SHIFT * most ? SHRINK * run->shift : 0;
            return true;
        }
        memcpy(run->unknowns, newton->start, bytes);
        evaluate(run);
        run->shift = fmax(GROW * run->shift, LEAST_SHIFT * most);
        if (run->result->iterations >= last)
            return false;
    }
    return false;
}

/* fixed unknowns are at their targets from here on */
static void go_to_targets(newton_run *run)
{
    pel_newton *newton = run->newton;
    for (int32_t u = 0; u < newton->pattern->unknown_count; u++) {
        newton->step[u] = newton->fixed[u] ? way_to_target(run, u) : 0;
        newton->walked[u] += newton->step[u];
    }
    pel_tangent_advance(newton->tangent, run->unknowns, find_move(run, 1), 1, newton->pool);
}

static void go_down(newton_run *run)
{
    pel_newton *newton = run->newton;
    run->kind = PEL_TANGENT_EXACT;
    run->has_stresses = false;
    go_to_targets(run);
    evaluate(run);
    assemble(run);
    if (run->status != PEL_OK)
        return;
    int32_t last = run->result->iterations + run->problem->iterations;
    double most = MOST_SHIFT * stiffness_scale(newton);
    run->shift = FIRST_SHIFT / MOST_SHIFT * most;
    while (run->status == PEL_OK && !has_converged(run) && run->result->iterations < last && !is_late(run))
        if (!go_downhill(run, most, last)) {
            run->result->stuck = run->status == PEL_OK;
            break;
        }
    run->shift = 0;
}

/* ---- stability ---- */

/* the exact tangent at the end has a factor */
static bool is_stable(newton_run *run)
{
    run->kind = PEL_TANGENT_EXACT;
    run->has_stresses = false;
    run->shift = 0;
    evaluate(run);
    assemble(run);
    return run->status == PEL_OK && make_factor(run);
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

/* ---- a run ---- */

static void fix_unknowns(newton_run *run)
{
    pel_newton *newton = run->newton;
    bool changed = false;
    for (int32_t u = 0; u < newton->pattern->unknown_count; u++) {
        bool is_vertex = u < 3 * newton->pattern->vertex_count;
        bool rests = is_vertex && !(newton->model->inverse_mass[u / 3] > 0);
        uint8_t fixed = rests || (run->problem->fixed != NULL && run->problem->fixed[u]);
        changed |= fixed != newton->fixed[u];
        newton->fixed[u] = fixed;
        newton->walked[u] = 0;
    }
    if (changed)
        newton->has_factor = false;
    for (int32_t n = 0; n < newton->pattern->vertex_count + newton->pattern->edge_count; n++)
        newton->frame[n] = -1;
    for (int32_t f = 0; f < run->problem->frames.count; f++)
        newton->frame[run->problem->frames.vertices[f]] = f;
}

pel_status pel_newton_run(pel_newton *newton, const pel_newton_problem *problem, double *unknowns,
                          pel_newton_result *result, pel_error *error)
{
    newton_run run = {.newton = newton, .problem = problem, .unknowns = unknowns, .result = result, .error = error};
    size_t bytes = (size_t)newton->pattern->unknown_count * sizeof(double);
    *result = (pel_newton_result){0};
    fix_unknowns(&run);
    memcpy(newton->start, unknowns, bytes);
    if (!go_full_steps(&run) && run.status == PEL_OK) {
        memcpy(unknowns, newton->start, bytes);
        memset(newton->walked, 0, bytes);
        go_down(&run);
    }
    if (run.status == PEL_OK && result->converged && !problem->is_dynamic && !is_stable(&run) && run.status == PEL_OK) {
        nudge(&run);
        go_down(&run);
    }
    turn_back(&run, newton->gradient);
    return run.status;
}

void pel_newton_forget(pel_newton *newton)
{
    newton->has_factor = false;
    newton->is_stale = true;
    newton->precision = PEL_FACTOR_FLOAT;
}

/* ---- a preconditioner ---- */

bool pel_newton_approximate(pel_newton *newton, const pel_newton_problem *problem, const double *unknowns, double shift)
{
    pel_newton_result result = {0};
    memcpy(newton->start, unknowns, (size_t)newton->pattern->unknown_count * sizeof *unknowns);
    newton_run run = {.newton = newton, .problem = problem, .unknowns = newton->start, .result = &result};
    run.kind = PEL_TANGENT_POSITIVE;
    double pivot;
    fix_unknowns(&run);
    evaluate(&run);
    assemble(&run);
    return run.status == PEL_OK && compute_factor(&run, shift, &pivot);
}

void pel_newton_precondition(pel_newton *newton, double *vector)
{
    size_t vertices = 3 * (size_t)newton->pattern->vertex_count;
    memcpy(newton->right, vector, vertices * sizeof *vector);
    memset(newton->right + vertices, 0, (size_t)newton->pattern->edge_count * sizeof *vector);
    pel_factor_solve(newton->factors[newton->precision], newton->pool, newton->right, newton->step);
    memcpy(vector, newton->step, vertices * sizeof *vector);
}

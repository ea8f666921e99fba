#include "newton/modes.h"

#include "base/lane.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "linear/eigen.h"
#include "linear/pcg.h"
#include "math/extremes.h"
#include "math/vec3.h"

#include <math.h>
#include <string.h>

/* of conjugate gradients and eigenvectors, relative */
#define SOLVE_TOLERANCE 1e-13
#define MODE_TOLERANCE 1e-6
#define BUCKLING_TOLERANCE 1e-4
enum { MOST_PRODUCTS = 30, MOST_ITERATIONS = 200 };
/* of stiffness times place, in forces at rest */
#define PI 3.14159265358979323846
#define ROUNDING (16 * (double)PEL_REAL_EPSILON)
/* of the first look for the lowest factor, above which no shift can be */
#define ROUGH_TOLERANCE 1e-2
enum { ROUGH_ITERATIONS = 8 };
/* shifts by the masses, of the mean stiffness over mass: the first one, and the largest */
#define SHIFT_SHARE 1e-8
#define MOST_SHIFT_SHARE 1e-3
#define SHIFT_GROWTH 100
/* of a force squared: a smaller part along rigid motions is an error of their modes, which are exact to 1e-4 */
#define RIGID_FORCE_SHARE 1e-6
/* squared frequencies below this share of the shift are those of rigid motions */
#define RIGID_SHARE 1e-5

struct pel_modes {
    pel_analysis analysis;
    int32_t count;
    pel_newton_system system;
    pel_matrix *geometric; /* of buckling, else null */
    pel_factor *factor;
    pel_pcg *pcg;
    pel_eigen *eigen;
    double *masses;           /* (unknown_count) kg, 0 where fixed and on edges */
    double *right, *stresses; /* (unknown_count), (stress_count + 1) */
    double *values, *vectors; /* (count), (count x unknown_count) */
    const pel_tangent_pattern *pattern;
    double largest_factor;             /* of loads: beyond, the linear step is longer than the model */
    uint8_t *fixed;                    /* (unknown_count) of the solve */
    int32_t *frame;                    /* (node_count) number of the axes of a vertex, or -1 */
    const pel_newton_problem *problem; /* of the solve */
    double shift;                      /* 1/s2 by the masses, or a factor of the loads */
};

pel_status pel_modes_create(pel_newton *newton, pel_analysis analysis, int32_t count, pel_modes **modes,
                            pel_error *error)
{
    *modes = NULL;
    pel_modes *made = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    made->analysis = analysis;
    made->count = count;
    made->system = pel_newton_system_of(newton);
    made->pattern = pel_newton_pattern(newton);
    size_t unknowns = (size_t)made->pattern->unknown_count;
    bool room = PEL_ALLOCATE_ALL(
        PEL_ROOM(made->masses, unknowns), PEL_ROOM(made->right, unknowns),
        PEL_ROOM(made->stresses, (size_t)made->pattern->stress_count + 1), PEL_ROOM(made->values, count),
        PEL_ROOM(made->vectors, (size_t)count * unknowns), PEL_ROOM(made->fixed, unknowns),
        PEL_ROOM(made->frame, (size_t)made->pattern->vertex_count + (size_t)made->pattern->edge_count));
    pel_status status = room ? PEL_OK : pel_fail_memory(error);
    if (status == PEL_OK && analysis == PEL_ANALYSIS_BUCKLING)
        status = pel_newton_create_matrix(newton, &made->geometric, error);
    if (status == PEL_OK)
        status = pel_factor_create(made->system.plan, PEL_FACTOR_DOUBLE, &made->factor, error);
    if (status == PEL_OK)
        status = pel_pcg_create((int32_t)unknowns, &made->pcg, error);
    if (status == PEL_OK)
        status = pel_eigen_create((int32_t)unknowns, count, &made->eigen, error);
    if (status != PEL_OK)
        pel_modes_destroy(made);
    else
        *modes = made;
    return status;
}

void pel_modes_destroy(pel_modes *modes)
{
    if (modes == NULL)
        return;
    pel_eigen_destroy(modes->eigen);
    pel_pcg_destroy(modes->pcg);
    pel_factor_destroy(modes->factor);
    pel_matrix_destroy(modes->geometric);
    pel_free(modes->fixed);
    pel_free(modes->frame);
    double *arrays[] = {modes->masses, modes->right, modes->stresses, modes->values, modes->vectors};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        pel_free(arrays[i]);
    pel_free(modes);
}

double pel_modes_value(const pel_modes *modes, int32_t number)
{
    return modes->values[number];
}

const double *pel_modes_vector(const pel_modes *modes, int32_t number)
{
    return modes->vectors + (size_t)number * (size_t)modes->pattern->unknown_count;
}

/* ---- products ---- */

/* what enclosed gases and kept volumes add */
static void add_rank_ones(void *context, pel_pool *pool, const double *x, double *y)
{
    const pel_modes *modes = context;
    (void)pool;
    pel_tangent_add_rank_ones(modes->pattern, modes->fixed, x, y);
}

static void multiply_stiffness(void *context, const double *x, double *y)
{
    pel_modes *modes = context;
    pel_matrix_multiply(modes->system.matrix, modes->system.pool, x, y);
    add_rank_ones(modes, modes->system.pool, x, y);
}

static void multiply_masses(void *context, const double *x, double *y)
{
    const pel_modes *modes = context;
    for (int32_t u = 0; u < modes->pattern->unknown_count; u++)
        y[u] = modes->masses[u] * x[u];
}

/* y = K^-1 right */
static void solve(pel_modes *modes, double *y)
{
    const pel_pcg_def def = {
        .matrix = modes->system.matrix,
        .add_product = add_rank_ones,
        .added = modes,
        .precondition = pel_factor_solve,
        .preconditioner = modes->factor,
        .tolerance = SOLVE_TOLERANCE,
        .iterations = MOST_PRODUCTS,
    };
    pel_pcg_solve(modes->pcg, &def, modes->system.pool, modes->right, y);
}

static void apply_masses(void *context, const double *x, double *y)
{
    pel_modes *modes = context;
    multiply_masses(modes, x, modes->right);
    solve(modes, y);
}

static void apply_geometric(void *context, const double *x, double *y)
{
    pel_modes *modes = context;
    pel_matrix_multiply(modes->geometric, modes->system.pool, x, modes->right);
    for (int32_t u = 0; u < modes->pattern->unknown_count; u++)
        modes->right[u] = modes->fixed[u] ? 0 : -modes->right[u];
    solve(modes, y);
}

/* ---- matrices ---- */

static void take_masses(pel_modes *modes, const uint8_t *fixed)
{
    const pel_newton_frames *frames = &modes->problem->frames;
    for (int32_t n = 0; n < modes->pattern->vertex_count + modes->pattern->edge_count; n++)
        modes->frame[n] = -1;
    for (int32_t f = 0; f < frames->count; f++)
        modes->frame[frames->vertices[f]] = f;
    for (int32_t u = 0; u < modes->pattern->unknown_count; u++) {
        bool rests = u < 3 * modes->pattern->vertex_count && !(modes->system.model->inverse_mass[u / 3] > 0);
        modes->fixed[u] = rests || fixed[u];
        modes->masses[u] = modes->fixed[u] ? 0 : modes->system.masses[u];
    }
}

/* 1/s2, mean stiffness of the vertices over mass */
static double stiffness_over_mass(const pel_modes *modes)
{
    const pel_matrix *matrix = modes->system.matrix;
    double stiffness = 0, mass = 0;
    for (int32_t v = 0; v < modes->pattern->vertex_count; v++) {
        const double *diagonal = matrix->values + matrix->block_start[pel_matrix_block(matrix, v, v)];
        for (int k = 0; k < 3; k++) {
            stiffness += modes->masses[3 * v + k] > 0 ? diagonal[4 * k] : 0;
            mass += modes->masses[3 * v + k];
        }
    }
    return stiffness / mass;
}

static void evaluate(pel_modes *modes, const pel_tangent_input *input, pel_matrix *matrix, double *gradient)
{
    const pel_newton_problem *problem = modes->problem;
    pel_tangent_evaluate(modes->system.tangent, input, modes->system.pool, gradient);
    pel_matrix_assemble(matrix, modes->system.pool, pel_tangent_matrices, modes->system.tangent);
    pel_newton_add_terms(problem->terms, true, matrix);
    pel_matrix_turn(matrix, modes->system.pool, modes->frame, problem->frames.axes);
    if (gradient == NULL)
        return;
    pel_newton_frames_turn(&problem->frames, gradient);
    pel_newton_frames_turn_rank_ones(&problem->frames, modes->pattern);
}

static bool compute_factor(pel_modes *modes)
{
    return pel_factor_compute(modes->factor, modes->system.matrix, 0, modes->system.pool).positive_definite;
}

static pel_status fail_unstable(const pel_modes *modes, pel_error *error)
{
    if (pel_pool_is_stopped(modes->system.pool))
        return pel_pool_check(modes->system.pool, error);
    return pel_refuse(error, PEL_BAD_ARGUMENT,
                      "make the loads smaller, or find the buckling load with analysis: buckling",
                      "the state under the loads is not stable: it has no frequencies");
}

/* ---- frequencies ---- */

static pel_status prepare_modal(pel_modes *modes, const pel_tangent_input *input, pel_error *error)
{
    pel_matrix *matrix = modes->system.matrix;
    evaluate(modes, input, matrix, modes->right);
    double scale = stiffness_over_mass(modes), added = 0;
    pel_matrix_fix(matrix, modes->system.pool, modes->fixed, NULL, NULL);
    for (modes->shift = SHIFT_SHARE * scale; modes->shift < MOST_SHIFT_SHARE * scale; modes->shift *= SHIFT_GROWTH) {
        pel_matrix_add_diagonal(matrix, modes->shift - added, modes->masses);
        added = modes->shift;
        if (compute_factor(modes))
            return PEL_OK;
    }
    return fail_unstable(modes, error);
}

/* ---- buckling ---- */

pel_status pel_modes_fail_unloaded(pel_error *error)
{
    return pel_refuse(error, PEL_BAD_ARGUMENT,
                      "add the loads or the pressure under which the body is to buckle; displacements of supports "
                      "do not count",
                      "no load acts, so there is no load factor");
}

/* N, what rounding of positions leaves of the forces at rest */
static double rounding_force(const pel_modes *modes)
{
    const pel_matrix *matrix = modes->system.matrix;
    double stiffness = 0, far = 0;
    for (int32_t v = 0; v < modes->pattern->vertex_count; v++) {
        const double *diagonal = matrix->values + matrix->block_start[pel_matrix_block(matrix, v, v)];
        for (int k = 0; k < 3; k++) {
            stiffness = pel_max(stiffness, diagonal[4 * k]);
            far = pel_max(far, fabs((double)modes->system.model->rest[v][k]));
        }
    }
    return ROUNDING * stiffness * far;
}

/* that takes a vertex as far as the model reaches */
static double longest_factor(const pel_modes *modes, const double *step)
{
    double longest = 0, far = 0;
    for (int32_t u = 0; u < 3 * modes->pattern->vertex_count; u++) {
        longest = pel_max(longest, fabs(step[u]));
        far = pel_max(
            far, fabs((double)modes->system.model->rest[u / 3][u % 3] - (double)modes->system.model->rest[0][u % 3]));
    }
    return far / longest;
}

/* Stresses of the linear step under the loads; then their contribution and that of the pressure to the tangent. */
static pel_status prepare_buckling(pel_modes *modes, const pel_newton_problem *problem, const pel_tangent_input *input,
                                   pel_error *error)
{
    pel_matrix *matrix = modes->system.matrix;
    pel_tangent_input own = *input;
    double most = 0;
    modes->shift = 0;
    own.kind = PEL_TANGENT_POSITIVE;
    evaluate(modes, &own, matrix, modes->right);
    if (problem->force != NULL)
        memcpy(modes->vectors, problem->force, (size_t)modes->pattern->unknown_count * sizeof *modes->vectors);
    else
        memset(modes->vectors, 0, (size_t)modes->pattern->unknown_count * sizeof *modes->vectors);
    pel_newton_frames_turn(&problem->frames, modes->vectors);
    for (int32_t u = 0; u < modes->pattern->unknown_count; u++) {
        modes->right[u] = modes->fixed[u] ? 0 : modes->vectors[u] - modes->right[u];
        most = u < 3 * modes->pattern->vertex_count ? pel_max(most, fabs(modes->right[u])) : most;
    }
    if (!(most > rounding_force(modes)))
        return pel_modes_fail_unloaded(error);
    pel_matrix_fix(matrix, modes->system.pool, modes->fixed, NULL, NULL);
    if (!compute_factor(modes))
        return fail_unstable(modes, error);
    solve(modes, modes->vectors);
    pel_newton_frames_turn_back(&problem->frames, modes->vectors);
    modes->largest_factor = longest_factor(modes, modes->vectors);
    pel_tangent_extrapolate(modes->system.tangent, input, modes->vectors, modes->system.pool, modes->stresses);
    own.kind = PEL_TANGENT_EXACT;
    own.stresses = modes->stresses;
    evaluate(modes, &own, modes->geometric, NULL);
    pel_matrix_fix(modes->geometric, modes->system.pool, modes->fixed, NULL, NULL);
    for (int32_t i = 0; i < matrix->block_start[matrix->block_count]; i++)
        modes->geometric->values[i] -= matrix->values[i];
    return PEL_OK;
}

/* matrix += (factor - shift) G */
static void shift_to(pel_modes *modes, double factor)
{
    pel_matrix *matrix = modes->system.matrix;
    for (int32_t i = 0; i < matrix->block_start[matrix->block_count]; i++)
        matrix->values[i] += (factor - modes->shift) * modes->geometric->values[i];
    modes->shift = factor;
}

/* Factors lie close together where shells buckle in short waves. From just below the first one they are far apart: K +
   shift G takes the place of K. It has a factor exactly while the shift is below the lowest. False where no factor
   above 0 shows. */
static bool find_shift(pel_modes *modes, const pel_eigen_def *def)
{
    static const double shares[] = {0.99, 0.95, 0.8, 0.5, 0};
    pel_eigen_def rough = *def;
    rough.tolerance = ROUGH_TOLERANCE;
    rough.iterations = ROUGH_ITERATIONS;
    pel_eigen_solve(modes->eigen, &rough);
    bool found = pel_eigen_value(modes->eigen, 0) * modes->largest_factor > 1;
    double estimate = found ? 1 / pel_eigen_value(modes->eigen, 0) : 0;
    for (size_t i = 0; found && i < sizeof shares / sizeof *shares; i++) {
        shift_to(modes, shares[i] * estimate);
        if (compute_factor(modes))
            break;
    }
    return found;
}

/* ---- modes ---- */

static double value_of(const pel_modes *modes, double inverse)
{
    if (modes->analysis == PEL_ANALYSIS_BUCKLING)
        return modes->shift + 1 / inverse;
    double square = 1 / inverse - modes->shift;
    return fabs(square) <= RIGID_SHARE * modes->shift ? 0 : copysign(sqrt(fabs(square)), square) / (2 * PI);
}

static void take_vector(pel_modes *modes, int32_t number)
{
    double *to = modes->vectors + (size_t)number * (size_t)modes->pattern->unknown_count, *from = modes->right;
    memcpy(from, pel_eigen_vector(modes->eigen, number), (size_t)modes->pattern->unknown_count * sizeof *from);
    pel_newton_frames_turn_back(&modes->problem->frames, from);
    double most = 0, component = 0;
    for (int32_t v = 0; v < modes->pattern->vertex_count; v++) {
        const double *x = from + 3 * (size_t)v;
        most = pel_max(most, sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]));
        /* the first of several that rounding makes larger or smaller */
        for (int k = 0; k < 3; k++)
            component = fabs(x[k]) > 1.001 * fabs(component) ? x[k] : component;
    }
    for (int32_t u = 0; u < modes->pattern->unknown_count; u++)
        to[u] = copysign(1 / most, component) * from[u];
}

static pel_status take_modes(pel_modes *modes, int32_t found, pel_error *error)
{
    bool buckles = modes->analysis == PEL_ANALYSIS_BUCKLING;
    for (int32_t m = 0; m < found; m++) {
        double inverse = pel_eigen_value(modes->eigen, m);
        if (buckles && !(inverse > 0 && value_of(modes, inverse) < modes->largest_factor)) {
            found = m;
            break;
        }
        modes->values[m] = value_of(modes, inverse);
        take_vector(modes, m);
        if (modes->values[m] < 0)
            return fail_unstable(modes, error);
    }
    if (found == modes->count)
        return PEL_OK;
    pel_fail(error, PEL_BAD_ARGUMENT, "found %d of %d modes", (int)found, (int)modes->count);
    pel_fail_remedy(error, buckles && found == 0 ? "the loads do not buckle the body: reverse them"
                                                 : "ask for fewer modes, or use a finer mesh");
    return PEL_BAD_ARGUMENT;
}

pel_status pel_modes_solve(pel_modes *modes, const pel_newton_problem *problem, const double *unknowns,
                           pel_error *error)
{
    const pel_tangent_input input = {.unknowns = unknowns, .span = problem->span, .state = problem->state};
    bool buckles = modes->analysis == PEL_ANALYSIS_BUCKLING;
    modes->problem = problem;
    take_masses(modes, problem->fixed);
    pel_status status = buckles ? prepare_buckling(modes, problem, &input, error) : prepare_modal(modes, &input, error);
    if (status != PEL_OK)
        return status;
    pel_eigen_def def = {
        .apply = buckles ? apply_geometric : apply_masses,
        .metric = buckles ? multiply_stiffness : multiply_masses,
        .context = modes,
        .tolerance = MODE_TOLERANCE,
        .iterations = MOST_ITERATIONS,
        .pool = modes->system.pool,
    };
    if (buckles) {
        bool found = find_shift(modes, &def);
        status = pel_pool_check(modes->system.pool, error);
        if (status != PEL_OK)
            return status;
        if (!found)
            return take_modes(modes, 0, error);
        def.tolerance = BUCKLING_TOLERANCE;
    }
    int32_t found = pel_eigen_solve(modes->eigen, &def).count;
    status = pel_pool_check(modes->system.pool, error);
    return status == PEL_OK ? take_modes(modes, found, error) : status;
}

/* ---- response ---- */

/* N2/kg */
static double square_of(const pel_modes *modes, const double *force)
{
    double sum = 0;
    for (int32_t u = 0; u < modes->pattern->unknown_count; u++)
        sum += modes->masses[u] > 0 ? force[u] * force[u] / modes->masses[u] : 0;
    return sum;
}

/* Takes the rigid motions out of a displacement, or what moves the body so out of a force, if it has such a part. */
static void leave_rigid_part(const pel_modes *modes, bool is_force, double whole, double *vector)
{
    for (int32_t m = 0; m < modes->count && modes->values[m] == 0; m++) {
        const double *mode = pel_modes_vector(modes, m);
        double along = 0, mass = 0;
        for (int32_t u = 0; u < modes->pattern->unknown_count; u++) {
            along += (is_force ? 1 : modes->masses[u]) * mode[u] * vector[u];
            mass += modes->masses[u] * mode[u] * mode[u];
        }
        const double share = !is_force || along * along > RIGID_FORCE_SHARE * whole * mass ? along / mass : 0;
        for (int32_t u = 0; u < modes->pattern->unknown_count; u++)
            vector[u] -= share * (is_force ? modes->masses[u] : 1) * mode[u];
    }
}

pel_modes_response pel_modes_respond(pel_modes *modes, const pel_newton_frames *frames, double *force)
{
    const int32_t count = modes->pattern->unknown_count;
    pel_modes_response response = {0};
    double kinetic = 0;
    const double whole = square_of(modes, force);
    leave_rigid_part(modes, true, whole, force);
    pel_newton_frames_turn(frames, force);
    for (int32_t u = 0; u < count; u++)
        modes->right[u] = modes->fixed[u] ? 0 : force[u];
    const double left = square_of(modes, modes->right);
    solve(modes, force);
    pel_newton_frames_turn_back(frames, force);
    leave_rigid_part(modes, false, 0, force);
    for (int32_t v = 0; v < modes->pattern->vertex_count; v++) {
        const double *move = force + 3 * (size_t)v;
        response.reach = pel_max(response.reach, pel_vec3_length(move));
        kinetic += modes->system.masses[3 * v] * pel_vec3_dot(move, move);
    }
    pel_newton_frames_turn(frames, force);
    for (int32_t u = 0; u < count; u++)
        response.energy += modes->right[u] * force[u];
    double square = kinetic > 0 ? response.energy / kinetic - modes->shift : 0;
    if (left > RIGID_FORCE_SHARE * whole && square > RIGID_SHARE * modes->shift)
        response.frequency = sqrt(square) / (2 * PI);
    return response;
}

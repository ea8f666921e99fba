#include "newton/run.h"

#include "base/hash.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "force/pressure.h"
#include "math/bounds.h"
#include "math/extremes.h"

#include <math.h>
#include <string.h>

/* full steps of mixed integration points without a new least residual, after which steps of least energy follow; such
   steps in a part of the loads */
enum { PATIENCE = 12, DYNAMIC_PATIENCE = 6, PART_ITERATIONS = 30 };
/* consecutive short steps that end a run under constraints with any residual: sticking contacts may slip in the next */
enum { SHORT_STEPS = 4 };
/* evaluations along a step: for its slope to be zero, for its energy to fall */
enum { SEARCHES = 12, CUTS = 12 };
/* systems of the positive tangent after an exact one without a factor, before the exact one is asked again */
enum { POSITIVE_SYSTEMS = 2 };
/* of steps, that L-BFGS goes by */
enum { PAIRS = 6 };
/* Line search: a slope below STEEP of the initial one counts as zero; a slope steeper than FLAT of it extends the step,
   up to MOST_SHARE times. A step that is too long is reduced to between LEAST_CUT and MOST_CUT of it. */
#define STEEP 0.2
#define LEAST_CUT 0.1
#define MOST_CUT 0.5
#define FLAT 0.5
#define MOST_SHARE 16
/* multiples of the masses: the first one, of the stiffness over mass; by how much they shrink and grow */
#define FIRST_SHIFT 1e-2
#define LEAST_SHIFT 1e-12
#define MOST_SHIFT 1e3
#define SHRINK 0.2
#define GROW 4.0
/* of the residual, that a short step leaves where it is the last one */
#define SHORT_REDUCTION 0.1
/* of the decrease that a step promises; changes below this share of the energy's parts may be rounding */
#define DECREASE 1e-3
#define ROUNDING 1e-13
/* of the size, ways by which a balance that is no minimum is left along its lowest mode */
#define FIRST_NUDGE 1e-4
#define LAST_NUDGE 2e-2
#define NUDGE_GROWTH 10.0
/* of the size, that each step downhill from there moves a vertex by: not beyond the minimum beside it */
#define LEAVING_SHARE 0.02
/* inverse iterations for that mode */
enum { MODE_ROUNDS = 20, LEAVING_ROUNDS = 3 };
/* parts of the loads, where all at once lead nowhere: the first one, the least; by how much they grow and shrink */
#define FIRST_PART 0.25
#define LEAST_PART (1.0 / 1024)
#define PART_GROWTH 1.5
/* of the forces at the start, that a part but the last may leave */
#define PART_TOLERANCE 1e-4
#define PART_SHRINK 0.5

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
    pel_minres_destroy(newton->minres);
    pel_newton_skew_destroy(newton->skew);
    newton->skew = NULL;
    newton->minres = NULL;
    newton->pcg = NULL;
    newton->plan = NULL;
    newton->matrix = NULL;
    newton->has_factor = newton->is_prepared = false;
    newton->has_plain = false;
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
    newton->coupled_count = count;
    return status;
}

static bool has_potential(const pel_model *model)
{
    for (int32_t b = 0; b < model->body_count; b++)
        if (!pel_shell_has_potential(&model->bodies[b]))
            return false;
    return true;
}

/* masses, and lengths to compare with */
static void measure(pel_newton *newton)
{
    const pel_model *model = newton->model;
    const pel_tangent_pattern *pattern = newton->pattern;
    double low[3], high[3], x[3], sum = 0;
    pel_bounds_clear(low, high);
    for (int32_t v = 0; v < model->vertex_count; v++) {
        for (int k = 0; k < 3; k++)
            newton->masses[3 * v + k] = (double)model->mass[v];
        pel_vertex_position(model->rest, v, x);
        pel_bounds_add(low, high, x);
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
    newton->has_potential = has_potential(model);
}

static bool make_room(pel_newton *newton)
{
    const pel_tangent_pattern *pattern = newton->pattern;
    size_t count = (size_t)pattern->unknown_limit, nodes = (size_t)pattern->vertex_count + (size_t)pattern->edge_limit;
    newton->stresses = pel_allocate((size_t)pattern->stress_limit + 1, sizeof *newton->stresses);
    newton->fixed = pel_allocate(count, 1);
    newton->frame = pel_allocate(nodes, sizeof *newton->frame);
    double **vectors[] = {&newton->gradient,     &newton->right,          &newton->step,
                          &newton->start,        &newton->start_gradient, &newton->masses,
                          &newton->walked,       &newton->move,           &newton->path,
                          &newton->load,         &newton->answer,         &newton->balance,
                          &newton->way,          &newton->begin,          &newton->part_start,
                          &newton->part_walked,  &newton->best,           &newton->best_walked,
                          &newton->first,        &newton->left,           &newton->product,
                          &newton->sum,          &newton->before_walked,  &newton->before_gradient,
                          &newton->before_terms, &newton->prepared_at};
    newton->rotations = pel_allocate((size_t)pattern->vertex_count, sizeof *newton->rotations);
    bool room = newton->rotations != NULL && newton->stresses != NULL && newton->fixed != NULL && newton->frame != NULL;
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++)
        room &= (*vectors[i] = pel_allocate(count, sizeof **vectors[i])) != NULL;
    return room && pel_pairs_create(&newton->pairs, PAIRS, count, NULL) == PEL_OK;
}

void pel_newton_rebuild(pel_newton *newton)
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
    pel_newton_space_destroy(newton->space);
    pel_tangent_destroy(newton->tangent);
    PEL_FREE_ALL(newton->gradient, newton->right, newton->step, newton->start, newton->masses, newton->start_gradient,
                 newton->stresses, newton->fixed, newton->walked, newton->move, newton->frame, newton->path,
                 newton->load, newton->answer, newton->balance, newton->way, newton->begin, newton->part_start,
                 newton->part_walked, newton->best, newton->best_walked, newton->first, newton->left, newton->product,
                 newton->sum, newton->plain, newton->coupled, newton->before_walked, newton->before_gradient,
                 newton->before_terms, newton->volumes, newton->prepared_at, newton->rotations, newton->owned,
                 newton->blocks);
    pel_pairs_release(&newton->pairs);
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

static bool has_blocks(const pel_newton *newton, int32_t count, const int32_t (*couplings)[4])
{
    for (int32_t c = 0; c < count; c++)
        for (int i = 1; i < 4; i++)
            for (int j = 0; j < i; j++)
                if (pel_matrix_block(newton->matrix, couplings[c][i], couplings[c][j]) < 0)
                    return false;
    return true;
}

/* those of the run so far and new ones: what lets go for a while comes back */
static bool keep_couplings(pel_newton *newton, bool is_first, int32_t count, const int32_t (*couplings)[4])
{
    newton->coupled_count = is_first ? 0 : newton->coupled_count;
    if (!pel_reserve((void **)&newton->coupled, &newton->coupled_capacity, (size_t)(newton->coupled_count + count),
                     sizeof *newton->coupled))
        return false;
    for (int32_t c = 0; c < count; c++)
        if (is_first || !has_blocks(newton, 1, couplings + c))
            memcpy(newton->coupled[newton->coupled_count++], couplings[c], sizeof *couplings);
    return true;
}

/* the pattern of the model alone, which the factor has that many runs share */
static pel_status uncouple(newton_run *run)
{
    pel_newton *newton = run->newton;
    bool is_plain = !newton->is_outdated && newton->couplings == 0;
    return is_plain ? PEL_OK : create_system(newton, 0, NULL, run->error);
}

/* Blocks for what the terms couple. Where a run begins the pattern is that of its own couplings alone: so its bits do
   not depend on the runs before. */
pel_status pel_newton_couple(newton_run *run)
{
    pel_newton *newton = run->newton;
    const pel_newton_terms *terms = run->problem->terms;
    const int32_t(*couplings)[4] = NULL;
    int32_t acting = 0, count = 0;
    if (run->is_prepared)
        return uncouple(run);
    if (terms != NULL && terms->list_couplings != NULL)
        count = terms->list_couplings(terms->context, &couplings, &acting);
    if (run->problem->frames.rigids != NULL) {
        int32_t own = pel_newton_rigids_couple(run, 0, acting, couplings);
        count = own < 0 ? own : pel_newton_rigids_couple(run, own, count - acting, couplings + acting);
        acting = own;
        couplings = (const int32_t(*)[4])newton->owned;
    }
    if (count < 0)
        return pel_fail_memory(run->error);
    bool is_right = !newton->is_outdated;
    if (is_right)
        is_right = newton->is_stale ? newton->couplings == hash_couplings(count, couplings)
                                    : has_blocks(newton, acting, couplings);
    bool is_first = newton->is_stale || newton->is_outdated;
    newton->is_stale = false;
    if (is_right)
        return PEL_OK;
    if (!keep_couplings(newton, is_first, count, couplings))
        return pel_fail_memory(run->error);
    return create_system(newton, newton->coupled_count, (const int32_t(*)[4])newton->coupled, run->error);
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
   of regula falsi (Dowell, Jarratt 1971) with cuts that are not too small: membranes are walls. Where it finds none,
   the last point at which the energy falls. */
static double find_zero_slope(slope_point low, slope_point high, double flat, slope_at *slope_of_share, void *context)
{
    double at = high.share, slope = high.slope;
    for (int n = 0; n < SEARCHES && fabs(slope) > flat; n++) {
        double width = high.share - low.share, cut = low.slope / (low.slope - high.slope);
        at = low.share + width * pel_min(pel_max(cut, LEAST_CUT), 1 - LEAST_CUT);
        slope = slope_of_share(context, at);
        slope_point *moved = slope > 0 ? &high : &low, *kept = slope > 0 ? &low : &high;
        *moved = (slope_point){at, slope};
        kept->slope *= 0.5;
    }
    return fabs(slope) <= flat || !(low.share > 0) ? at : low.share;
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
    pel_tangent_advance(newton->tangent, walk->run->unknowns, pel_newton_find_move(walk->run, 1), way, newton->pool);
    for (int32_t u = 0; u < newton->pattern->unknown_count; u++)
        newton->walked[u] += way * newton->step[u];
    walk->share = share;
    pel_newton_evaluate(walk->run);
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
    while (high.slope < FLAT * before && high.share < most && pel_newton_is_finite(run)) {
        low = high;
        high.share *= 2;
        high.slope = walk_to(&walk, high.share);
    }
    if (before < 0 && high.slope > 0)
        walk_to(&walk, find_zero_slope(low, high, -STEEP * before, walk_to, &walk));
}

/* the energy with the work of moments on edges, which this run's turns of edges have */
static double merit_of(const newton_run *run)
{
    const pel_newton *newton = run->newton;
    double work = 0;
    for (int32_t u = 3 * newton->pattern->vertex_count; u < newton->pattern->unknown_count; u++)
        work += run->problem->force != NULL ? run->factor * run->problem->force[u] * newton->walked[u] : 0;
    return run->result->energy - work;
}

/* where a point of an energy along a step stands */
typedef struct energy_point {
    double share, energy, slope;
} energy_point;

/* least value between two points of the cubic with their energies and slopes (Nocedal, Wright 2006, eq. 3.59), within
   the shares of the second that are tried next */
static double find_least(energy_point a, energy_point b)
{
    double way = b.share - a.share, d = a.slope + b.slope - 3 * (b.energy - a.energy) / way;
    double root = sqrt(d * d - a.slope * b.slope), cut = (b.slope + root - d) / (b.slope - a.slope + 2 * root);
    double least = isfinite(cut) ? b.share - cut * way : 0;
    return pel_min(pel_max(least, LEAST_CUT * b.share), MOST_CUT * b.share);
}

/* all forces have a potential */
static bool has_energy(const newton_run *run)
{
    const pel_newton_terms *terms = run->problem->terms;
    return run->newton->has_potential && (terms == NULL || terms->add_skew == NULL);
}

/* where a run stands along its step; forces without a potential have the work of the mean of both ends */
static energy_point find_point(step_walk *walk, double share, const energy_point *begin)
{
    energy_point point = {.share = share, .slope = walk_to(walk, share)};
    point.energy =
        has_energy(walk->run) ? merit_of(walk->run) : begin->energy + 0.5 * share * (begin->slope + point.slope);
    return point;
}

/* Makes a step of a tangent that was made positive, which is stiffer than the body, longer: while the energy falls. */
static void lengthen(step_walk *walk, const energy_point *begin, energy_point end)
{
    double most = MOST_SHARE * end.share;
    while (end.slope < FLAT * begin->slope && end.share < most) {
        const energy_point next = find_point(walk, 2 * end.share, begin);
        if (!pel_newton_is_finite(walk->run) || !(next.energy < end.energy)) {
            walk_to(walk, end.share);
            return;
        }
        end = next;
    }
}

/* A step as far as the energy falls enough (Armijo 1966; Nocedal, Wright 2006, section 3.1): constraints become
   active and inactive along it. False, at the start, if no share of it lowers the energy. */
static bool go_by_energy(newton_run *run, double share)
{
    step_walk walk = {.run = run};
    const energy_point begin = {0, merit_of(run), slope_of(run->newton, run->newton->gradient)};
    double noise = ROUNDING * run->parts;
    run->slope = begin.slope;
    bool is_stiff = run->kind == PEL_TANGENT_POSITIVE;
    run->result->iterations++;
    run->kind = PEL_TANGENT_EXACT;
    run->has_stresses = false;
    for (int n = 0; n < CUTS; n++) {
        const energy_point end = find_point(&walk, share, &begin);
        bool is_finite = pel_newton_is_finite(run);
        if (is_finite && end.energy <= begin.energy + DECREASE * share * begin.slope + noise) {
            if (is_stiff && n == 0)
                lengthen(&walk, &begin, end);
            return true;
        }
        share = is_finite ? find_least(begin, end) : LEAST_CUT * share;
        run->newton->is_smooth = false;
    }
    walk_to(&walk, 0);
    return false;
}

/* ---- time ---- */

bool pel_newton_is_late(newton_run *run)
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
    pel_newton_evaluate(run);
}

/* ---- full steps ---- */

static bool has_kinks(const newton_run *run)
{
    return run->problem->terms != NULL && run->problem->terms->has_kinks;
}

/* The step of the matrix; of a positive one where the exact one is not, and in motion under constraints for some
   systems after it; false where that has no factor either. */
static bool find_full_step(newton_run *run)
{
    bool asks = run->positive_left == 0, goes_on = run->problem->is_in_motion && has_kinks(run);
    if (asks && pel_newton_find_step(run))
        return true;
    run->positive_left = !asks ? run->positive_left - 1 : goes_on ? POSITIVE_SYSTEMS : 0;
    run->kind = PEL_TANGENT_POSITIVE;
    run->has_stresses = false;
    pel_newton_evaluate(run);
    return run->status == PEL_OK && pel_newton_find_step(run);
}

/* Goes along the step. Ways to targets raise the energy: under constraints as well the first step is a full one.
   Returns whether the run is evaluated at its end. */
static bool take_step(newton_run *run)
{
    double share = pel_newton_find_share(run->newton);
    bool is_down = has_kinks(run) && pel_newton_is_at_targets(run);
    if (is_down && go_by_energy(run, share))
        return true;
    if (is_down || run->kind == PEL_TANGENT_POSITIVE) {
        go_to_slope(run, share);
        return false;
    }
    pel_newton_extrapolate(run, share);
    pel_newton_go(run, share);
    return false;
}

/* Goes along a step of L-BFGS as far as the energy falls. False where the next one needs another factor. */
bool pel_newton_go_down_quasi_step(newton_run *run)
{
    int32_t systems = run->result->iterations;
    bool falls = slope_of(run->newton, run->newton->gradient) < 0;
    bool goes = falls && go_by_energy(run, pel_newton_find_share(run->newton));
    run->result->iterations = systems;
    run->quasi_steps = goes ? run->quasi_steps : INT32_MAX;
    return goes;
}

/* A step with the factor that there is. False where the next one needs another factor: constraints that begin and cease
   to act make steps of L-BFGS short. */
static bool go_quasi_step(newton_run *run)
{
    bool is_smooth = run->newton->is_smooth || !pel_newton_has_kinks(run);
    if (!run->problem->is_quasi || !is_smooth || !pel_newton_is_at_targets(run) || !pel_newton_quasi_pays(run))
        return false;
    pel_newton_find_quasi_step(run);
    return pel_newton_go_down_quasi_step(run);
}

/* fixed unknowns are at their targets from here on */
void pel_newton_go_to_targets(newton_run *run)
{
    pel_newton *newton = run->newton;
    for (int32_t u = 0; u < newton->pattern->unknown_count; u++) {
        newton->step[u] = newton->fixed[u] ? pel_newton_way_to_target(run, u) : 0;
        newton->walked[u] += newton->step[u];
    }
    pel_tangent_advance(newton->tangent, run->unknowns, pel_newton_find_move(run, 1), 1, newton->pool);
}

/* after a step as far as the energy falls */
static bool ends_settled(newton_run *run, double press)
{
    if (!pel_newton_has_settled(run, run->slope, press))
        return false;
    run->result->converged = run->result->is_near = true;
    return true;
}

static void renew_terms(newton_run *run)
{
    const pel_newton_terms *terms = run->problem->terms;
    bool renews = terms != NULL && terms->renew != NULL && pel_newton_is_at_targets(run);
    if (renews && terms->renew(terms->context, run->unknowns))
        pel_newton_evaluate(run);
}

/* Full steps of mixed integration points, or as far as the energy falls under constraints. False where they lead
   nowhere. */
static bool go_full_steps(newton_run *run)
{
    pel_newton_result *result = run->result;
    double best = HUGE_VAL;
    int since = 0, short_steps = 0;
    bool is_evaluated = false, is_first = true;
    for (;;) {
        run->kind = PEL_TANGENT_EXACT;
        if (!is_evaluated)
            pel_newton_evaluate(run);
        if (!pel_newton_is_finite(run))
            return false;
        if (is_first)
            result->first_residual = result->residual;
        is_first = false;
        bool is_spent = result->iterations > 0 && pel_newton_is_spent(run);
        if (pel_newton_has_converged(run) || result->iterations >= run->limit || is_spent)
            return true;
        if (pel_newton_is_late(run)) {
            take_best(run, best);
            return true;
        }
        since = result->residual < best ? 0 : since + 1;
        keep_best(run, best);
        best = pel_min(best, result->residual);
        if (!has_kinks(run) && since > (run->problem->is_dynamic ? DYNAMIC_PATIENCE : PATIENCE))
            return false;
        double press = run->press;
        bool goes_quasi = go_quasi_step(run);
        if (goes_quasi && ends_settled(run, press))
            return true;
        if (goes_quasi) {
            is_evaluated = true;
            since = 0;
            continue;
        }
        renew_terms(run);
        if (!find_full_step(run))
            return false;
        bool is_short =
            run->kind == PEL_TANGENT_EXACT && pel_newton_longest_move(run->newton) <= run->problem->short_move;
        double before = result->residual;
        is_evaluated = take_step(run);
        if (is_evaluated)
            renew_terms(run);
        if (is_evaluated && ends_settled(run, press))
            return true;
        short_steps = is_short ? short_steps + 1 : 0;
        if (!is_short)
            continue;
        if (!is_evaluated)
            pel_newton_evaluate(run);
        is_evaluated = true;
        if (!has_kinks(run) || short_steps == SHORT_STEPS || result->residual <= SHORT_REDUCTION * before) {
            result->converged = result->is_near = pel_newton_is_finite(run);
            return result->converged;
        }
    }
}

/* ---- steps of least energy ---- */

/* The least shift, from the present one, under which the matrix is positive; false beyond the largest. */
static bool find_shifted_step(newton_run *run, double most)
{
    while (run->shift <= most) {
        if (pel_newton_find_step(run))
            return true;
        if (run->status != PEL_OK || pel_newton_is_spent(run))
            return false;
        run->shift = pel_max(GROW * run->shift, LEAST_SHIFT * most);
    }
    return false;
}

/* J, that the energy fell by in the step that was gone from newton->start; without a potential (pressure on an open
   surface) the work of the mean force */
static double fall_of(const newton_run *run, double energy, double share)
{
    const pel_newton *newton = run->newton;
    if (newton->has_potential)
        return energy - run->result->energy;
    return -0.5 * share * (slope_of(newton, newton->start_gradient) + slope_of(newton, newton->gradient));
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
        double slope = slope_of(newton, newton->start_gradient);
        double share = pel_newton_find_share(newton), longest = share * pel_newton_longest_move(newton);
        share *= run->longest > 0 && longest > run->longest ? run->longest / longest : 1;
        pel_newton_go(run, share);
        pel_newton_evaluate(run);
        double fall = fall_of(run, energy, share);
        if (pel_newton_is_finite(run) && (fall >= -DECREASE * slope - ROUNDING * parts ||
                                          (fall >= -ROUNDING * parts && run->result->residual < residual))) {
            run->shift = run->shift > LEAST_SHIFT * most ? SHRINK * run->shift : 0;
            return true;
        }
        memcpy(run->unknowns, newton->start, bytes);
        pel_newton_evaluate(run);
        run->shift = pel_max(GROW * run->shift, LEAST_SHIFT * most);
        if (run->result->iterations >= run->limit || pel_newton_is_spent(run))
            return false;
    }
    return false;
}

static void go_down(newton_run *run)
{
    pel_newton *newton = run->newton;
    run->kind = PEL_TANGENT_EXACT;
    run->has_stresses = false;
    pel_newton_go_to_targets(run);
    pel_newton_evaluate(run);
    pel_newton_assemble(run);
    if (run->status != PEL_OK)
        return;
    double most = MOST_SHIFT * pel_max(pel_newton_stiffness_scale(newton), pel_newton_rigids_scale(run));
    run->shift = FIRST_SHIFT / MOST_SHIFT * most;
    while (run->status == PEL_OK && !pel_newton_has_converged(run) && run->result->iterations < run->limit &&
           !pel_newton_is_late(run) && !pel_newton_is_spent(run))
        if (!go_downhill(run, most)) {
            run->result->stuck = run->status == PEL_OK;
            break;
        }
    run->shift = 0;
}

/* ---- loads in parts ---- */

/* forces that hold the start, and displacements of moved vertices */
static void balance_start(newton_run *run)
{
    pel_newton *newton = run->newton;
    run->kind = PEL_TANGENT_EXACT;
    run->has_stresses = false;
    run->share = 0;
    pel_newton_evaluate(run);
    memcpy(newton->balance, newton->gradient, (size_t)newton->pattern->unknown_count * sizeof(double));
    pel_newton_frames_turn_forces_back(&run->problem->frames, newton->balance);
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

/* whether the matrix is positive in double, where it is in float: the lowest curvature of slender bodies is below the
   rounding of float. The factor in float stays. Forces without a potential have no curvature that could tell more. */
static bool is_positive_in_double(newton_run *run)
{
    pel_newton *newton = run->newton;
    double pivot;
    if (newton->precision == PEL_FACTOR_DOUBLE || !has_energy(run))
        return true;
    pel_factor **factor = &newton->factors[PEL_FACTOR_DOUBLE];
    if (*factor == NULL)
        run->status = pel_factor_create(newton->plan, PEL_FACTOR_DOUBLE, factor, run->error);
    if (run->status != PEL_OK)
        return false;
    newton->precision = PEL_FACTOR_DOUBLE;
    if (!pel_newton_compute_factor(run, 0, &pivot))
        return false;
    newton->precision = PEL_FACTOR_FLOAT;
    return true;
}

/* The exact tangent at the end has a factor. A balance that stays as it was has the tangent of the last factor, bit for
   bit, which serves again. */
static bool is_stable(newton_run *run)
{
    pel_newton *newton = run->newton;
    run->kind = PEL_TANGENT_EXACT;
    run->has_stresses = false;
    run->shift = 0;
    pel_newton_evaluate(run);
    pel_newton_assemble(run);
    if (run->status != PEL_OK)
        return false;
    const pel_matrix *matrix = newton->matrix;
    const size_t size = (size_t)matrix->block_start[matrix->block_count] * sizeof *matrix->values;
    const uint64_t tangent = pel_hash_block(newton->couplings, matrix->values, size);
    if (newton->is_proven && newton->proven == tangent) {
        pel_newton_take_factor(run, newton->proven_precision);
        return true;
    }
    newton->is_proven = pel_newton_make_factor(run) && is_positive_in_double(run);
    newton->proven = tangent;
    newton->proven_precision = newton->precision;
    return newton->is_proven;
}

/* newton->step = the lowest mode of the exact tangent, its largest component 1: inverse iterations with the factor of
   the tangent plus the least multiple of the masses that makes it positive, from a vector that is always the same.
   Where modes lie close together, a mixture of them. False without a factor. */
static bool find_lowest_mode(newton_run *run)
{
    pel_newton *newton = run->newton;
    int32_t count = newton->pattern->unknown_count;
    uint32_t random = 1;
    for (int32_t u = 0; u < count; u++) {
        random = random * 1664525u + 1013904223u;
        newton->step[u] = newton->fixed[u] ? 0 : (double)(random >> 8) / (1 << 23) - 1;
    }
    if (run->status != PEL_OK || !pel_newton_make_preconditioner(run))
        return false;
    for (int i = 0; i < MODE_ROUNDS; i++) {
        double largest = 0;
        for (int32_t u = 0; u < count; u++)
            newton->right[u] = newton->fixed[u] ? 0 : newton->masses[u] * newton->step[u];
        pel_factor_solve(newton->factors[newton->precision], newton->pool, newton->right, newton->step);
        for (int32_t u = 0; u < 3 * newton->pattern->vertex_count; u++)
            largest = fabs(newton->step[u]) > fabs(largest) ? newton->step[u] : largest;
        if (!(fabs(largest) > 0) || !isfinite(largest))
            return false;
        for (int32_t u = 0; u < count; u++)
            newton->step[u] /= largest;
    }
    return true;
}

/* From a balance that is no minimum along its lowest mode, farther and farther, and downhill to one that is; where
   there is none within reach, back to the balance. */
static void leave_balance(newton_run *run)
{
    pel_newton *newton = run->newton;
    size_t bytes = (size_t)newton->pattern->unknown_count * sizeof(double);
    memcpy(newton->part_start, run->unknowns, bytes);
    memcpy(newton->part_walked, newton->walked, bytes);
    for (double nudge = FIRST_NUDGE; nudge <= LAST_NUDGE; nudge *= NUDGE_GROWTH) {
        run->limit = run->result->iterations + LEAVING_ROUNDS * run->problem->iterations;
        if (!find_lowest_mode(run))
            break;
        run->longest = LEAVING_SHARE * newton->size;
        pel_newton_go(run, nudge * newton->size);
        go_down(run);
        run->longest = 0;
        if (run->status != PEL_OK || (run->result->converged && is_stable(run)))
            return;
        memcpy(run->unknowns, newton->part_start, bytes);
        memcpy(newton->walked, newton->part_walked, bytes);
        run->kind = PEL_TANGENT_EXACT;
        run->has_stresses = false;
        pel_newton_evaluate(run);
        pel_newton_assemble(run);
    }
    run->result->converged = run->status == PEL_OK;
    run->result->stuck = false;
    run->result->unstable = true;
}

/* ---- a run ---- */

void pel_newton_return_to_begin(newton_run *run)
{
    size_t bytes = (size_t)run->newton->pattern->unknown_count * sizeof(double);
    memcpy(run->unknowns, run->newton->begin, bytes);
    memset(run->newton->walked, 0, bytes);
    run->has_stresses = false;
    run->limit += run->problem->iterations;
}

void pel_newton_run_systems(newton_run *run)
{
    const pel_newton_problem *problem = run->problem;
    pel_newton_result *result = run->result;
    run->limit = problem->iterations;
    if (!go_full_steps(run) && run->status == PEL_OK) {
        pel_newton_return_to_begin(run);
        go_down(run);
    }
    if (run->status == PEL_OK && !result->converged && !problem->is_dynamic) {
        pel_newton_return_to_begin(run);
        /* the residual of a part is not that of all loads */
        if (!go_in_parts(run) && run->status == PEL_OK) {
            run->kind = PEL_TANGENT_EXACT;
            run->has_stresses = false;
            pel_newton_evaluate(run);
        }
    }
    bool is_balance = run->status == PEL_OK && result->converged && !problem->is_dynamic;
    if (is_balance && !is_stable(run) && run->status == PEL_OK)
        leave_balance(run);
}

int64_t pel_newton_work(const pel_newton *newton)
{
    return newton->work;
}

void pel_newton_forget(pel_newton *newton)
{
    newton->has_factor = newton->is_smooth = false;
    newton->is_stale = true;
    newton->precision = PEL_FACTOR_FLOAT;
}

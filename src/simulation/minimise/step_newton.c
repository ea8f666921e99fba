#include "minimise/step_newton.h"
#include "attach/joint.h"
#include "attach/tie.h"
#include "base/assert.h"
#include "minimise/rounds.h"
#include "minimise/step_turn.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "boundary/edge_load.h"
#include "boundary/fluid.h"
#include "boundary/follower.h"
#include "boundary/hold.h"
#include "boundary/loads.h"
#include "constraint/constraint.h"
#include "math/extremes.h"
#include "math/functions.h"
#include "minimise/prepared.h"
#include "pellicle/sim.h"
#include "tear/loose.h"

#include <string.h>

/* steps that derivatives are taken of end at this share of the forces that they start with */
#define EXACT_REDUCTION 1e-10
/* share of the diagonal of a preconditioner that rounding in float may remove */
#define HELD_SHIFT 1e-7
/* constraints nearer than this many of their tolerances get blocks in the matrix before they act */
#define NEAR_TOLERANCES 200
/* of the forces on a body that may be left where it stays as it is: a tenth of the tolerance */
#define REST_SHARE 1e-4
/* steps between tries of a way that costs as much, by the square of the ratio more where it costs more; the first try;
   evaluations or unknowns, below which steps are quick, and systems end nearer to the solution than one old factor */
enum { TRY_STEPS = 24, FIRST_TRY = 4, FIRST_PREPARED_TRY = 12, LEAST_COST = 30, LEAST_UNKNOWNS = 2000 };
/* of the cost of a step in its mean */
#define MEAN_SHARE 0.5
/* of a run of a step in time without constraints */
enum { DYNAMIC_ITERATIONS = 20 };

/* systems of the first round that are not ended where little energy is left: smooth motion needs no more, and converges
   fast */
enum { FIRST_SYSTEMS = 3 };

/* bodies that press against each other; sums are kept with the first of them */
typedef struct newton_group {
    int32_t leader;   /* a body of the same group with a lower number, or itself */
    bool is_held;     /* not free to move as a whole */
    double left[3];   /* N, sum of the forces that a run left */
    double stiffness; /* N/m, of the springs that inertia is */
} newton_group;

pel_status pel_sim_newton_create(pel_sim *sim, bool is_dynamic, pel_error *error)
{
    pel_sim_newton *newton = sim->minimise->newton = pel_allocate(1, sizeof *newton);
    if (newton == NULL)
        return pel_fail_memory(error);
    pel_status status = pel_newton_create(sim->model, sim->pool, &sim->newton, error);
    if (status != PEL_OK)
        return status;
    size_t vertices = (size_t)sim->model->vertex_count;
    size_t count = (size_t)pel_newton_pattern(sim->newton)->unknown_limit;
    bool room = PEL_ALLOCATE_ALL(PEL_ROOM(newton->unknowns, count), PEL_ROOM(newton->target, count),
                                 PEL_ROOM(newton->loads, count), PEL_ROOM(newton->fixed, count),
                                 PEL_ROOM_ALIGNED(newton->force, vertices));
    if (!is_dynamic)
        room &= PEL_ALLOCATE_ALL(PEL_ROOM(newton->anchor_stiffness, vertices), PEL_ROOM(newton->anchors, vertices));
    if (is_dynamic) {
        newton->point_stiffness = pel_allocate(vertices, sizeof *newton->point_stiffness);
        newton->points = pel_allocate(vertices, sizeof *newton->points);
        sim->minimise->inertia = newton->point_stiffness;
        newton->groups = pel_allocate((size_t)sim->model->body_count, sizeof *newton->groups);
        newton->collided = pel_allocate((size_t)sim->model->body_count, sizeof *newton->collided);
        newton->turns = pel_allocate((size_t)sim->model->body_count, sizeof *newton->turns);
        for (int i = 0; i < 2; i++)
            newton->stage[i] = pel_allocate_aligned(vertices, sizeof *newton->stage[i]);
        room &= newton->stage[0] != NULL && newton->stage[1] != NULL && newton->point_stiffness != NULL &&
                newton->points != NULL && newton->groups != NULL && newton->collided != NULL && newton->turns != NULL;
    }
    if (is_dynamic && pel_tangent_is_viscous(pel_newton_tangent(sim->newton))) {
        size_t numbers = (size_t)pel_newton_pattern(sim->newton)->stress_limit * PEL_VISCOUS_NUMBERS;
        newton->viscous = pel_allocate(numbers, sizeof *newton->viscous);
        room &= newton->viscous != NULL;
    }
    if (!room)
        return pel_fail_memory(error);
    status = pel_rigid_parts_create(sim, newton->unknowns, is_dynamic, &newton->rigid, error);
    return status == PEL_OK && is_dynamic ? pel_sim_prepared_create(sim, error) : status;
}

void pel_sim_newton_destroy(pel_sim *sim)
{
    pel_sim_newton *newton = sim->minimise->newton;
    if (newton == NULL)
        return;
    pel_sim_prepared_destroy(sim);
    pel_rigid_parts_destroy(&newton->rigid);
    pel_newton_destroy(sim->newton);
    PEL_FREE_ALL(newton->unknowns, newton->target, newton->loads, newton->fixed, newton->force, newton->points,
                 newton->couplings, newton->radial, newton->point_stiffness, newton->groups, newton->collided,
                 newton->kinks, newton->turns, newton->viscous, newton->stage[0], newton->stage[1],
                 newton->anchor_stiffness, newton->anchors);
    pel_free(newton);
}

/* ---- input ---- */

void pel_sim_newton_begin(pel_sim *sim)
{
    sim->minimise->newton->goes_on = false;
    sim->minimise->newton->way = sim->rigids != NULL ? PEL_SYSTEMS : sim->minimise->newton->choice.way;
    pel_newton_forget(sim->newton);
    if (sim->solver.budget > 0)
        sim->deadline = sim->clock() + sim->solver.budget;
    sim->loads->edge_load_work = 0;
}

/* whether a contact presses, or is about to */
static bool touches(const pel_sim *sim)
{
    const pel_minimise *minimise = sim->minimise;
    for (int32_t c = 0; c < minimise->count; c++) {
        pel_gap_sample sample;
        if (minimise->constraints[c].load > 0)
            return true;
        pel_minimise_contact_meet(sim, &minimise->constraints[c], minimise->newton->unknowns, &sample);
        if (!(sample.gap > 0))
            return true;
    }
    return false;
}

/* Contacts change the matrix too much for one factor, damping of the material refers to another state. */
static bool may_prepare(const pel_sim *sim)
{
    const pel_sim_newton *newton = sim->minimise->newton;
    return !touches(sim) && newton->point_stiffness != NULL && !newton->is_exact && newton->lead == NULL &&
           newton->viscous == NULL && sim->ties == NULL;
}

void pel_sim_newton_choose(pel_sim *sim)
{
    pel_sim_newton *newton = sim->minimise->newton;
    if (newton == NULL || newton->point_stiffness == NULL || sim->rigids != NULL)
        return;
    pel_newton_choice *choice = &newton->choice;
    double *cost = choice->cost, work = (double)(pel_newton_work(sim->newton) - newton->work);
    newton->work += (int64_t)work;
    if (touches(sim))
        return;
    cost[newton->way] += (cost[newton->way] > 0 ? MEAN_SHARE : 1) * (work - cost[newton->way]);
    bool is_worth = newton->way == PEL_PREPARED || cost[newton->way] > LEAST_COST ||
                    pel_newton_pattern(sim->newton)->unknown_count >= LEAST_UNKNOWNS;
    int32_t first = is_worth && may_prepare(sim) ? PEL_PREPARED : PEL_QUASI, cheapest = newton->way, next = -1;
    for (int32_t way = first; way < PEL_WAY_COUNT; way++)
        cheapest = cost[way] > 0 && cost[way] < cost[cheapest] ? way : cheapest;
    /* in turn, first the ways that have not been gone */
    for (int32_t i = 1; i <= PEL_WAY_COUNT; i++) {
        int32_t way = (choice->tried + i) % PEL_WAY_COUNT;
        bool is_other = way != cheapest && way >= first;
        next = is_other && (next < 0 || (!(cost[way] > 0) && cost[next] > 0)) ? way : next;
    }
    int32_t first_try = newton->way == PEL_PREPARED ? FIRST_PREPARED_TRY : FIRST_TRY;
    double ratio = cost[next] / cost[cheapest];
    double wait = cost[next] > 0 ? TRY_STEPS * pel_max(1, ratio * ratio) : first_try;
    bool tries = ++choice->age >= wait;
    choice->way = tries ? next : cheapest;
    choice->tried = tries ? next : choice->tried;
    choice->age = tries ? 0 : choice->age;
}

void pel_sim_newton_follow_surface(pel_sim *sim)
{
    pel_minimise_follow_surface(sim);
    sim->minimise->newton->goes_on = false;
    if (sim->minimise->newton->base != NULL)
        sim->minimise->newton->base->is_due = true;
    pel_newton_rebuild(sim->newton);
}

/* edges at least bending energy, except clamps; from zero: the same bits for any history */
static void settle_edges(const pel_sim *sim)
{
    pel_sim_newton *newton = sim->minimise->newton;
    pel_tangent *tangent = pel_newton_tangent(sim->newton);
    const pel_tangent_pattern *pattern = pel_newton_pattern(sim->newton);
    memset(newton->unknowns + 3 * (size_t)pattern->vertex_count, 0, (size_t)pattern->edge_count * sizeof(double));
    const uint8_t *is_fixed = sim->holds != NULL ? sim->holds->edge_fixed : NULL;
    if (is_fixed != NULL)
        pel_tangent_clamp_edges(tangent, newton->unknowns, is_fixed);
    pel_tangent_settle_edges(tangent, newton->unknowns, is_fixed);
}

/* Vertices that stand elsewhere than where the last run left them. */
static void take_positions(pel_sim *sim)
{
    pel_sim_newton *newton = sim->minimise->newton;
    const pel_record *from = newton->goes_on ? sim->state->position_next : sim->state->position;
    for (int32_t v = 0; v < sim->model->vertex_count; v++) {
        bool is_held = sim->held != NULL && sim->held[v];
        for (int k = 0; k < 3; k++) {
            double *x = &newton->unknowns[3 * v + k];
            newton->target[3 * v + k] = (double)sim->state->position_next[v][k];
            newton->fixed[3 * v + k] = is_held;
            if (!newton->goes_on || (!is_held && (pel_real)*x != from[v][k]))
                *x = (double)from[v][k];
        }
    }
    if (!newton->goes_on) {
        pel_tangent_follow(pel_newton_tangent(sim->newton), newton->unknowns);
        settle_edges(sim);
    }
    newton->goes_on = true;
}

static void find_loads(pel_sim *sim, pel_span span)
{
    pel_sim_newton *newton = sim->minimise->newton;
    memset(newton->force, 0, (size_t)sim->model->vertex_count * sizeof *newton->force);
    pel_loads_add(sim, span, NULL, newton->force);
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        for (int k = 0; k < 3; k++)
            newton->loads[3 * v + k] = (double)newton->force[v][k];
    double *moments = newton->loads + 3 * (size_t)sim->model->vertex_count;
    memset(moments, 0, (size_t)pel_newton_pattern(sim->newton)->edge_count * sizeof *moments);
    pel_edge_loads_add(sim, span, moments);
}

/* ---- free bodies ---- */

static bool is_held(const pel_sim *sim, int32_t v)
{
    PEL_ASSERT_INDEX(v, sim->model->vertex_count);
    return !(sim->model->inverse_mass[v] > 0) || (sim->held != NULL && sim->held[v]);
}

bool pel_sim_newton_is_free(const pel_sim *sim, int32_t body)
{
    PEL_ASSERT_INDEX(body, sim->model->body_count);
    const pel_body *own = &sim->model->bodies[body];
    for (int32_t v = own->slice_begin * PEL_WIDTH; v < pel_body_place_end(sim->model, body); v++)
        if (sim->model->mesh_vertex[v] >= 0 && is_held(sim, v))
            return false;
    bool is_tied = (pel_ties_hold(sim, body) || pel_joints_hold(sim, body)) &&
                   (sim->minimise == NULL || sim->minimise->newton->groups == NULL);
    return !own->has_volumetric && !pel_holds_has_body(sim, body) && !is_tied;
}

static int largest_component(const double x[3])
{
    int largest = 0;
    for (int k = 1; k < 3; k++)
        largest = fabs(x[k]) > fabs(x[largest]) ? k : largest;
    return largest;
}

static void way_between(const pel_sim_newton *newton, int32_t from, int32_t to, double way[3])
{
    pel_vec3_subtract(newton->unknowns + 3 * (size_t)to, newton->unknowns + 3 * (size_t)from, way);
}

/* the vertex farthest from one, or from the line along `axis` through it */
static int32_t find_farthest(const pel_sim *sim, int32_t body, int32_t from, const double *axis)
{
    const pel_body *own = &sim->model->bodies[body];
    double most = -1;
    int32_t farthest = from;
    for (int32_t v = own->slice_begin * PEL_WIDTH; v < pel_body_place_end(sim->model, body); v++) {
        double way[3], across[3];
        if (sim->model->mesh_vertex[v] < 0)
            continue;
        way_between(sim->minimise->newton, from, v, way);
        if (axis != NULL)
            pel_vec3_cross(axis, way, across);
        double square = pel_vec3_squared_length(axis != NULL ? across : way);
        if (square > most) {
            most = square;
            farthest = v;
        }
    }
    return farthest;
}

/* The distance of a vertex from the nearest load on a part of the body, at its first vertex; infinite without any. */
static double distance_from_loads(const pel_sim *sim, int32_t body, int32_t v)
{
    double least = (double)HUGE_VAL, way[3];
    for (int32_t l = 0; l < sim->loads->count; l++) {
        const pel_load *load = &sim->loads->items[l];
        if (load->body != body || load->vertex_count == 0 || load->vertex_count >= pel_sim_vertex_count(sim, body))
            continue;
        way_between(sim->minimise->newton, load->vertices[0], v, way);
        least = pel_min(least, pel_vec3_length(way));
    }
    return least;
}

/* The vertex farthest from all such loads: the displacement of the others is that from where it is. */
static int32_t find_calm(const pel_sim *sim, int32_t body)
{
    double most = -1;
    int32_t calm = -1;
    for (int32_t v = sim->model->bodies[body].slice_begin * PEL_WIDTH; v < pel_body_place_end(sim->model, body); v++) {
        double distance = sim->model->mesh_vertex[v] >= 0 ? distance_from_loads(sim, body, v) : -1;
        if (distance > most) {
            most = distance;
            calm = v;
        }
    }
    return calm;
}

static void fix(pel_sim_newton *newton, int32_t v, int k)
{
    newton->fixed[3 * v + k] = 1;
    newton->target[3 * v + k] = newton->unknowns[3 * v + k];
}

/* An unsupported body under balanced loads: six components of three vertices remove its rigid motions and carry no
   force: all of one vertex; for a second one those across the line to it; for a third one the component across their
   plane. */
static void support_free_body(pel_sim *sim, int32_t body)
{
    pel_sim_newton *newton = sim->minimise->newton;
    int32_t first = find_calm(sim, body);
    int32_t second = find_farthest(sim, body, first, NULL);
    double axis[3], way[3], normal[3];
    way_between(newton, first, second, axis);
    int32_t third = find_farthest(sim, body, first, axis);
    way_between(newton, first, third, way);
    pel_vec3_cross(axis, way, normal);
    for (int k = 0; k < 3; k++) {
        fix(newton, first, k);
        if (k != largest_component(axis))
            fix(newton, second, k);
    }
    fix(newton, third, largest_component(normal));
}

/* beside another simulation: the components that it has supported, if any */
static void support_as_lead(const pel_sim *sim, int32_t body)
{
    pel_sim_newton *newton = sim->minimise->newton;
    const pel_body *own = &sim->model->bodies[body];
    for (int32_t u = 3 * own->slice_begin * PEL_WIDTH; u < 3 * pel_body_place_end(sim->model, body); u++)
        if (newton->lead->problem->fixed[u]) {
            newton->fixed[u] = 1;
            newton->target[u] = newton->lead->unknowns[u];
        }
}

pel_newton_frames pel_sim_newton_gather(pel_sim *sim, pel_span span, bool supports_free)
{
    take_positions(sim);
    return pel_sim_newton_gather_at(sim, span, supports_free);
}

pel_newton_frames pel_sim_newton_gather_at(pel_sim *sim, pel_span span, bool supports_free)
{
    pel_sim_newton *newton = sim->minimise->newton;
    newton->frames = pel_holds_fix(sim, span.time, newton->fixed, newton->target);
    pel_loose_fix(sim, newton->unknowns, newton->fixed, newton->target);
    find_loads(sim, span);
    for (int32_t b = 0; b < sim->model->body_count && supports_free; b++) {
        if (sim->model->bodies[b].rigid != NULL || !pel_sim_newton_is_free(sim, b))
            continue;
        if (newton->lead != NULL)
            support_as_lead(sim, b);
        else
            support_free_body(sim, b);
    }
    newton->frames.rigids =
        pel_rigid_parts_gather(sim, &newton->rigid, supports_free ? pel_sim_newton_is_free : NULL, newton->fixed);
    return newton->frames;
}

/* ---- constraints ---- */

/* Damping along volumetric springs: the component of a vertex's velocity along its displacement from rest at the start
   of the step. */
static double evaluate_radial(const pel_sim_newton *newton, int32_t count, const double *unknowns, double *gradient)
{
    double energy = 0;
    for (int32_t v = 0; newton->radial != NULL && v < count; v++) {
        const double *along = newton->radial[v];
        double way = pel_vec3_dot(along, unknowns + 3 * (size_t)v) - along[3];
        energy += 0.5 * way * way;
        pel_vec3_along(gradient + 3 * (size_t)v, way, along, gradient + 3 * (size_t)v);
    }
    return energy;
}

static double evaluate_constraints(void *context, const double *unknowns, double *gradient)
{
    const pel_minimise_context *at = context;
    pel_sim *sim = at->sim;
    double springs = pel_holds_evaluate(sim, at->span.time, unknowns, gradient);
    pel_followers_evaluate(sim, at->span, unknowns, gradient);
    springs += pel_ties_evaluate(sim, at->span.time, unknowns, gradient);
    springs += pel_fluids_evaluate(sim, unknowns, gradient);
    springs += evaluate_radial(sim->minimise->newton, sim->model->vertex_count, unknowns, gradient);
    if (!at->is_constrained)
        return springs;
    double *force = sim->minimise->force;
    int32_t count = 3 * sim->model->vertex_count;
    memset(force, 0, (size_t)count * sizeof *force);
    double energy = pel_minimise_contacts_evaluate(sim, unknowns, force);
    for (int32_t u = 0; u < count; u++)
        gradient[u] -= force[u];
    return energy + springs;
}

static bool renew_constraints(void *context, const double *unknowns)
{
    const pel_minimise_context *at = context;
    return pel_minimise_contacts_grip(at->sim, unknowns);
}

static void add_block(pel_matrix *matrix, int32_t i, int32_t j, double weight, const double stiffness[3][3])
{
    int32_t block = pel_matrix_block(matrix, i, j);
    double *values = matrix->values + matrix->block_start[block];
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            values[a + 3 * b] += weight * stiffness[a][b];
}

static void add_constraint(pel_matrix *matrix, const int32_t vertices[4], const double weights[4],
                           const double stiffness[3][3])
{
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) {
            double weight = weights[i] * weights[j];
            if (weight != 0)
                add_block(matrix, vertices[i], vertices[j], weight, stiffness);
        }
}

static void add_row(pel_matrix *matrix, const int32_t vertices[4], double row[4][3])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            double product[3][3];
            for (int a = 0; a < 3; a++)
                for (int b = 0; b < 3; b++)
                    product[a][b] = row[i][a] * row[j][b];
            add_block(matrix, vertices[i], vertices[j], 1, (const double(*)[3])product);
        }
}

static void add_constraints(void *context, pel_matrix *matrix)
{
    const pel_minimise_context *at = context;
    const pel_sim *sim = at->sim;
    const pel_minimise *minimise = sim->minimise;
    pel_holds_add_matrix(sim, matrix);
    pel_followers_add_matrix(sim, matrix);
    pel_ties_add_matrix(at->sim, at->span.time, minimise->newton->unknowns, matrix);
    pel_fluids_add_matrix(sim, minimise->newton->unknowns, matrix);
    for (int32_t v = 0; minimise->newton->radial != NULL && v < sim->model->vertex_count; v++) {
        double square[3][3];
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++)
                square[a][b] = minimise->newton->radial[v][a] * minimise->newton->radial[v][b];
        add_block(matrix, v, v, 1, (const double(*)[3])square);
    }
}

static void add_contacts(void *context, pel_matrix *matrix)
{
    const pel_minimise_context *at = context;
    const pel_sim *sim = at->sim;
    const pel_minimise *minimise = sim->minimise;
    for (int32_t c = 0; c < minimise->count; c++) {
        const pel_minimise_contact *constraint = &minimise->constraints[c];
        pel_contact_stiffness stiffness;
        if (!pel_minimise_contact_stiffness(sim, constraint, minimise->newton->unknowns, &stiffness))
            continue;
        add_constraint(matrix, constraint->vertices, stiffness.weights, (const double(*)[3])stiffness.along);
        add_constraint(matrix, constraint->vertices, constraint->weights, (const double(*)[3])stiffness.across);
        for (int r = 0; r < stiffness.row_count; r++)
            add_row(matrix, constraint->vertices, stiffness.rows[r]);
    }
}

static pel_newton_kink *list_kinks(void *context, int32_t *count)
{
    const pel_minimise_context *at = context;
    pel_sim_newton *newton = at->sim->minimise->newton;
    *count = at->sim->minimise->count;
    pel_minimise_contacts_list_kinks(at->sim, newton->unknowns, newton->kinks);
    return newton->kinks;
}

static void add_skew(void *context, const double *x, double *y)
{
    const pel_minimise_context *at = context;
    pel_followers_add_skew(at->sim, x, y);
}

/* the elements of the model have blocks for the corners of a triangle */
static bool has_tied_corners(const pel_sim *sim, int32_t v)
{
    PEL_ASSERT_INDEX(v, sim->model->vertex_count);
    const pel_body *body = &sim->model->bodies[sim->model->body_of_slice[v / PEL_WIDTH]];
    return body->shell != NULL || body->plain_spring != 0;
}

/* the moving vertices; the first of these for the others */
static void copy_vertices(const pel_minimise_contact *constraint, int32_t vertices[4])
{
    int first = 0;
    while (first < 3 && constraint->weights[first] == 0)
        first++;
    for (int i = 0; i < 4; i++)
        vertices[i] = constraint->vertices[constraint->weights[i] != 0 || i < constraint->points ? i : first];
}

/* Lists the constraints that act, or (acts = false) those that do not but are near. */
static int32_t list_constraints(pel_sim *sim, bool acts, int32_t count)
{
    const pel_minimise *minimise = sim->minimise;
    pel_sim_newton *newton = minimise->newton;
    for (int32_t c = 0; c < minimise->count; c++) {
        const pel_minimise_contact *constraint = &minimise->constraints[c];
        pel_contact_stiffness stiffness;
        pel_gap_sample sample;
        if (constraint->tool >= 0 && has_tied_corners(sim, constraint->vertices[0]))
            continue;
        if (pel_minimise_contact_stiffness(sim, constraint, newton->unknowns, &stiffness) != acts)
            continue;
        if (!acts) {
            pel_minimise_contact_meet(sim, constraint, newton->unknowns, &sample);
            if (sample.gap > NEAR_TOLERANCES * constraint->tolerance)
                continue;
        }
        copy_vertices(constraint, newton->couplings[count++]);
    }
    return count;
}

static int32_t list_couplings(void *context, const int32_t (**vertices)[4], int32_t *acting)
{
    const pel_minimise_context *at = context;
    pel_sim *sim = at->sim;
    int32_t count = pel_ties_list_couplings(sim, vertices);
    *acting = count;
    if (!at->is_constrained)
        return count;
    int32_t(*couplings)[4] = sim->minimise->newton->couplings;
    for (int32_t i = 0; i < count; i++)
        memcpy(couplings[i], (*vertices)[i], sizeof *couplings);
    *acting = list_constraints(sim, true, count);
    *vertices = (const int32_t(*)[4])couplings;
    return list_constraints(sim, false, *acting);
}

/* ---- momentum ---- */

static int32_t leader_of(const newton_group *groups, int32_t body)
{
    while (groups[body].leader != body)
        body = groups[body].leader;
    return body;
}

static int32_t body_of(const pel_sim *sim, int32_t v)
{
    PEL_ASSERT_INDEX(v, sim->model->vertex_count);
    return sim->model->body_of_slice[v / PEL_WIDTH];
}

int32_t pel_sim_newton_group(const pel_sim *sim, int32_t body)
{
    PEL_ASSERT_INDEX(body, sim->model->body_count);
    return leader_of(sim->minimise->newton->groups, body);
}

bool pel_sim_newton_group_is_held(const pel_sim *sim, int32_t group)
{
    return sim->minimise->newton->groups[group].is_held;
}

/* bodies that a constraint presses together, or holds to a tool */
static void join(const pel_sim *sim, const pel_minimise_contact *constraint)
{
    const pel_sim_newton *newton = sim->minimise->newton;
    pel_gap_sample sample;
    pel_minimise_contact_meet(sim, constraint, newton->unknowns, &sample);
    if (!(constraint->load > 0) && !(constraint->load - constraint->stiffness * sample.gap > 0))
        return;
    int32_t first = -1;
    for (int i = 0; i < 4; i++) {
        if (sample.weights[i] == 0)
            continue;
        int32_t other = leader_of(newton->groups, body_of(sim, constraint->vertices[i]));
        int32_t low = first >= 0 && first < other ? first : other, high = first > other ? first : other;
        newton->groups[high].leader = low;
        newton->groups[low].is_held |= newton->groups[high].is_held || constraint->tool >= 0;
        first = low;
    }
}

static void join_bodies(newton_group *groups, int32_t first, int32_t second, bool is_held)
{
    int32_t a = leader_of(groups, first), b = leader_of(groups, second);
    groups[a].is_held |= groups[b].is_held || is_held;
    groups[b].is_held = groups[a].is_held;
    groups[a > b ? a : b].leader = a < b ? a : b;
}

static void join_tie(const pel_sim *sim, const pel_tie *tie)
{
    newton_group *groups = sim->minimise->newton->groups;
    if (tie->phase != PEL_TIE_HOLDING)
        return;
    int32_t first = body_of(sim, tie->vertices[0]);
    join_bodies(groups, first, tie->count > 1 ? body_of(sim, tie->vertices[1]) : first, tie->count == 1);
}

static void find_groups(const pel_sim *sim, bool is_constrained)
{
    const pel_minimise *minimise = sim->minimise;
    for (int32_t b = 0; b < sim->model->body_count; b++)
        minimise->newton->groups[b] =
            (newton_group){.leader = b, .is_held = !pel_sim_newton_is_free(sim, b) || minimise->newton->radial != NULL};
    for (int32_t c = 0; is_constrained && c < minimise->count; c++)
        join(sim, &minimise->constraints[c]);
    for (int32_t i = 0; sim->ties != NULL && i < sim->ties->count; i++)
        join_tie(sim, &sim->ties->items[i]);
    for (int32_t i = 0; sim->joints != NULL && i < sim->joints->count; i++) {
        const pel_joint_def *def = &sim->joints->items[i].def;
        join_bodies(minimise->newton->groups, def->body, def->to_body >= 0 ? def->to_body : def->body,
                    def->to_body < 0);
    }
}

/* Systems are solved approximately, which may leave a net force on a body: a translation of everything that moves
   together balances it, against inertia and drag only. So momentum follows the loads. */
static void balance_groups(const pel_sim *sim, bool is_constrained)
{
    pel_sim_newton *newton = sim->minimise->newton;
    const double *gradient = pel_newton_gradient(sim->newton);
    find_groups(sim, is_constrained);
    for (int32_t v = 0; v < sim->model->vertex_count; v++) {
        newton_group *group = &newton->groups[leader_of(newton->groups, body_of(sim, v))];
        pel_vec3_add(group->left, gradient + 3 * (size_t)v, group->left);
        group->stiffness += newton->point_stiffness[v];
    }
    for (int32_t v = 0; v < sim->model->vertex_count; v++) {
        const newton_group *group = &newton->groups[leader_of(newton->groups, body_of(sim, v))];
        double *x = newton->unknowns + 3 * (size_t)v;
        if (!group->is_held && group->stiffness > 0)
            pel_vec3_along(x, -1 / group->stiffness, group->left, x);
    }
}

pel_newton_terms pel_sim_newton_terms(pel_minimise_context *context)
{
    return (pel_newton_terms){
        .context = context,
        .evaluate = evaluate_constraints,
        .renew = context->is_constrained ? renew_constraints : NULL,
        .add_matrix = add_constraints,
        .add_kinks = context->is_constrained ? add_contacts : NULL,
        .list_couplings = list_couplings,
        .add_skew = context->sim->loads->follower_count > 0 ? add_skew : NULL,
        .list_kinks = context->is_constrained && context->sim->minimise->count > 0 ? list_kinks : NULL,
        .has_kinks = context->is_constrained,
    };
}

bool pel_sim_newton_has_terms(const pel_sim *sim)
{
    return (sim->holds != NULL && sim->holds->spring_count > 0) || sim->minimise->newton->radial != NULL ||
           sim->loads->follower_count > 0 || sim->loads->fluid_count > 0 || sim->ties != NULL;
}

/* ---- a run ---- */

/* what Newton's method is asked for, from what the frame asks for; steps that are exact end at rounding */
static pel_newton_problem problem_of(const pel_minimise_context *context, const pel_descent_problem *problem,
                                     const pel_newton_terms *terms)
{
    const pel_sim *sim = context->sim;
    const pel_sim_newton *newton = sim->minimise->newton;
    bool is_dynamic = pel_minimise_is_in_motion(sim), is_exact = newton->is_exact, settles = newton->settling.rate > 0;
    double moments = pel_newton_moment_force(sim->newton, newton->loads);
    double tolerance = pel_hypot(problem->tolerance, problem->held_share * moments);
    int32_t constrained = pel_minimise_systems_left(sim);
    int32_t automatic = !is_dynamic               ? PEL_STATIC_ITERATIONS
                        : context->is_constrained ? constrained
                                                  : DYNAMIC_ITERATIONS;
    bool is_bounded = is_dynamic && context->is_constrained && sim->part.can_halve;
    return (pel_newton_problem){
        .span = context->span,
        .state = sim->state,
        .force = newton->loads,
        .point_stiffness = settles ? newton->anchor_stiffness : newton->point_stiffness,
        .points = (const double(*)[3])(settles ? newton->anchors : newton->points),
        .viscous = newton->viscous,
        .rate = newton->rate,
        .fixed = newton->fixed,
        .target = newton->target,
        .frames = newton->frames,
        .terms = context->is_constrained || pel_sim_newton_has_terms(sim) ? terms : NULL,
        .tolerance = is_exact ? EXACT_REDUCTION * tolerance : tolerance,
        .held_share = is_exact ? 0 : problem->held_share,
        .inertia_share = is_exact ? 0 : problem->inertia_share,
        .reduction = is_exact ? EXACT_REDUCTION : problem->reduction,
        .enough = is_dynamic ? HUGE_VAL : problem->enough,
        .short_move = is_exact ? EXACT_REDUCTION * problem->short_move : problem->short_move,
        .iterations = sim->solver.iterations > 0 ? sim->solver.iterations : automatic,
        .work = is_bounded ? (int64_t)PEL_SYSTEM_WORK * constrained : 0,
        .clock = sim->solver.budget > 0 ? sim->clock : NULL,
        .deadline = sim->deadline,
        .keeps_factor = is_dynamic,
        .is_quasi = is_dynamic && !is_exact && newton->lead == NULL && newton->way != PEL_SYSTEMS,
        .is_in_motion = is_dynamic && !is_exact,
        .rest_share = is_dynamic && !problem->goes_on ? (is_exact ? EXACT_REDUCTION : REST_SHARE) : 0,
        .rounding = is_exact ? 0 : problem->rounding,
        .settles = !is_dynamic || is_exact || settles ? 0
                   : problem->goes_on                 ? 1
                                                      : FIRST_SYSTEMS,
        .is_dynamic = is_dynamic,
    };
}

static pel_descent_result result_of(const pel_newton_result *run)
{
    return (pel_descent_result){
        .iterations = run->iterations,
        .evaluations = run->iterations + 1,
        .energy = run->energy,
        .residual = run->residual,
        .first_residual = run->first_residual,
        .held_force = run->held_force,
        .inertia_force = run->inertia_force,
        .converged = run->converged,
        .is_near = run->is_near,
        .stuck = run->stuck,
        .unstable = run->unstable,
    };
}

/* of a run; under contacts steps of L-BFGS go as long as none of them begins or ceases to act */
static void choose_way(const pel_sim *sim)
{
    pel_sim_newton *newton = sim->minimise->newton;
    if (sim->rigids == NULL && (touches(sim) || (newton->way == PEL_PREPARED && !may_prepare(sim))))
        newton->way = PEL_QUASI;
}

/* with other loads of joints; what is small already is nothing to rest at */
static pel_status run_again(pel_sim *sim, pel_newton_problem *problem, pel_newton_result *result, pel_error *error)
{
    int32_t iterations = result->iterations;
    double first_residual = result->first_residual;
    problem->rest_share = 0;
    pel_status status = pel_newton_run(sim->newton, problem, sim->minimise->newton->unknowns, result, error);
    result->iterations += iterations;
    result->first_residual = first_residual;
    return status;
}

pel_status pel_sim_newton_minimise(pel_minimise_context *context, const pel_descent_problem *problem,
                                   pel_descent_result *result, pel_error *error)
{
    pel_sim *sim = context->sim;
    pel_sim_newton *newton = sim->minimise->newton;
    bool is_dynamic = newton->point_stiffness != NULL;
    size_t count = (size_t)sim->minimise->count + (size_t)(sim->ties != NULL ? sim->ties->count : 0);
    const pel_newton_terms terms = pel_sim_newton_terms(context);
    if (!pel_reserve((void **)&newton->couplings, &newton->coupling_capacity, count, sizeof *newton->couplings) ||
        !pel_reserve((void **)&newton->kinks, &newton->kink_capacity, count, sizeof *newton->kinks))
        return pel_fail_memory(error);
    bool is_first = !newton->goes_on;
    int64_t work = pel_newton_work(sim->newton);
    pel_sim_newton_gather(sim, context->span, !is_dynamic && !context->is_constrained);
    if (is_first)
        pel_rigid_parts_join(sim, newton->loads, &newton->rigid);
    choose_way(sim);
    pel_newton_problem own = problem_of(context, problem, &terms);
    pel_newton_result run;
    pel_status status = PEL_OK;
    if (is_first && newton->way == PEL_PREPARED) {
        status = pel_sim_prepared_begin(sim, &own, error);
        if (status != PEL_OK)
            return status;
        own.is_prepared = true;
    }
    status = newton->lead != NULL
                 ? pel_newton_run_beside(sim->newton, &own, newton->lead, newton->unknowns, NULL, &run, error)
                 : pel_newton_run(sim->newton, &own, newton->unknowns, &run, error);
    if (own.is_prepared)
        pel_sim_prepared_take(sim, &own);
    for (int runs = 1; status == PEL_OK && sim->joints != NULL && pel_rigid_parts_are_apart(sim, runs); runs++)
        status = run_again(sim, &own, &run, error);
    if (status == PEL_OK && is_dynamic && newton->lead == NULL)
        balance_groups(sim, context->is_constrained);
    pel_rigid_parts_take(sim, &newton->rigid);
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        for (int k = 0; k < 3 && sim->model->mesh_vertex[v] >= 0; k++)
            sim->minimise->position[3 * v + k] = newton->unknowns[3 * v + k];
    *result = result_of(&run);
    result->work = pel_newton_work(sim->newton) - work;
    result->moment_force = pel_newton_moment_force(sim->newton, newton->loads);
    pel_edge_loads_add_work(sim, context->span, pel_newton_turns(sim->newton));
    return status;
}

/* ---- the preconditioner of descent ---- */

bool pel_sim_newton_approximate(pel_minimise_context *context)
{
    pel_sim *sim = context->sim;
    pel_sim_newton *newton = sim->minimise->newton;
    for (int32_t b = 0; b < sim->model->body_count; b++)
        if (pel_sim_newton_is_free(sim, b))
            return false;
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        for (int k = 0; k < 3; k++) {
            newton->unknowns[3 * v + k] = newton->target[3 * v + k] = (double)sim->state->position_next[v][k];
            newton->fixed[3 * v + k] = sim->held != NULL && sim->held[v];
        }
    const pel_newton_problem problem = {
        .span = context->span,
        .state = sim->state,
        .fixed = newton->fixed,
        .target = newton->target,
    };
    return pel_newton_approximate(sim->newton, &problem, newton->unknowns, HELD_SHIFT);
}

void pel_sim_newton_precondition(void *context, double *vector)
{
    const pel_minimise_context *at = context;
    pel_newton_precondition(at->sim->newton, vector);
}

/* ---- readings ---- */

void pel_sim_newton_settle_at(const pel_sim *sim)
{
    if (pel_newton_pattern(sim->newton)->edge_count > 0)
        settle_edges(sim);
    sim->minimise->newton->goes_on = false;
}

pel_tangent *pel_sim_newton_settle_edges(const pel_sim *sim, const double **unknowns)
{
    pel_sim_newton *newton = sim->minimise->newton;
    pel_tangent *tangent = pel_newton_tangent(sim->newton);
    if (pel_newton_pattern(sim->newton)->edge_count == 0)
        return NULL;
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        pel_vertex_position(sim->state->position, v, newton->unknowns + 3 * (size_t)v);
    settle_edges(sim);
    newton->goes_on = false;
    *unknowns = newton->unknowns;
    return tangent;
}

void pel_sim_newton_held_force(const pel_sim *sim, int32_t v, double force[3])
{
    PEL_ASSERT_INDEX(v, sim->model->vertex_count);
    const double *gradient = pel_newton_gradient(sim->newton);
    pel_vec3_scale(gradient + 3 * (size_t)v, -1, force);
}

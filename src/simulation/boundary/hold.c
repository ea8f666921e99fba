#include "boundary/hold.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "math/extremes.h"
#include "model/quantity.h"
#include "newton/run.h"

#include <stdio.h>
#include <string.h>

/* directions nearer to those that are held already are theirs */
#define DEPENDENT 1e-6
/* of the body's size: two supports that want places of one vertex this far apart contradict each other */
#define CONTRADICTION 1e-9

pel_support_def pel_support_def_default(void)
{
    return (pel_support_def){.fix = {true, true, true}, .axes = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
}

static bool are_orthonormal(const double axes[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j <= i; j++)
            if (!(fabs(pel_vec3_dot(axes[i], axes[j]) - (i == j)) < 1e-9))
                return false;
    return true;
}

/* the body resists bending, but its edges have no rotations that could be fixed */
static bool folds_at_clamps(const pel_body *body)
{
    return body->shell != NULL && body->shell->bending->has_hinges;
}

static pel_status check_def(const pel_sim *sim, const pel_support_def *def, int32_t support, pel_error *error)
{
    if (def->body < 0 || def->body >= sim->model->body_count)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "support", support, "give the number of a body",
                                  "support names a body that does not exist");
    const pel_body *body = &sim->model->bodies[def->body];
    if (body->detail != NULL)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "support", support,
                                  "remove `refine`, or use pinned vertices", "support of a body that refines");
    if (def->vertices == NULL || def->vertex_count < 1)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "support", support,
                                  "choose a region with at least one vertex",
                                  "support holds no vertex: vertices is null or empty");
    for (int32_t i = 0; i < def->vertex_count; i++)
        if (def->vertices[i] < 0 || def->vertices[i] >= body->mesh->vertex_count)
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "support", support, "give vertices of the mesh",
                                      "support names a vertex that does not exist");
    if (def->key_count < 0 || (def->key_count > 0 && def->keys == NULL))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "support", support, "give the keys with their count",
                                  "keys of the support is null, or key_count below 0");
    if (!are_orthonormal(def->axes))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "support", support, "give three unit vectors, orthogonal",
                                  "axes of the support are not orthonormal");
    for (int k = 0; k < 3; k++)
        if (!isfinite(def->displacement[k]))
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "support", support, "give three finite numbers",
                                      "displacement of the support is not finite");
    if (!(def->stiffness >= 0 && isfinite(def->stiffness)))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "support", support,
                                  "give a positive stiffness in N/m, or 0 for a rigid support",
                                  "stiffness of the support is below 0 or not finite");
    if (!(def->foundation >= 0 && isfinite(def->foundation)) || (def->stiffness > 0 && def->foundation > 0))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "support", support,
                                  "give a positive stiffness in N/m3 and leave out that of vertices, or 0 for none",
                                  "foundation of the support is below 0, not finite, or beside a stiffness");
    if (!def->fix[0] && !def->fix[1] && !def->fix[2] && !def->fix_rotation)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "support", support, "fix a component, or the rotation",
                                  "support fixes nothing");
    if (def->fix_rotation && folds_at_clamps(body))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "support", support,
                                  "give the body bending of model midedge, or fix displacements only",
                                  "support clamps edges, which only bending of model midedge has rotations for");
    if (!pel_keys_are_ordered(def->keys, def->key_count))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "support", support, "give keys with increasing times",
                                  "keys are not finite or not in order");
    return PEL_OK;
}

static pel_status copy_def(pel_hold *hold, const pel_support_def *def, pel_error *error)
{
    snprintf(hold->name, sizeof hold->name, "%s", def->name != NULL ? def->name : "");
    hold->body = def->body;
    hold->fixes_rotation = def->fix_rotation;
    memcpy(hold->axes, def->axes, sizeof hold->axes);
    memcpy(hold->value, def->displacement, sizeof hold->value);
    hold->keys = pel_allocate((size_t)def->key_count, sizeof *hold->keys);
    if (hold->keys == NULL)
        return pel_fail_memory(error);
    if (def->key_count > 0)
        memcpy(hold->keys, def->keys, (size_t)def->key_count * sizeof *hold->keys);
    hold->key_count = def->key_count;
    return PEL_OK;
}

/* ---- held components ---- */

/* m, along an axis of a support, from the place at rest */
static double displacement(const pel_hold *hold, int component, double time)
{
    return hold->value[component] == 0 ? 0
                                       : hold->value[component] * pel_curve_value(hold->keys, hold->key_count, time);
}

/* displacements of a held vertex along its own axes */
static void held_displacements(const pel_holds *holds, const pel_held_vertex *held, double time, double along[3])
{
    for (int i = 0; i < held->count; i++) {
        along[i] = displacement(&holds->holds[held->owner[i]], held->component[i], time);
        for (int j = 0; j < i; j++)
            along[i] -= held->factor[i][j] * along[j];
        along[i] /= held->factor[i][i];
    }
}

/* any two more axes */
static void complete(double axes[3][3], int count)
{
    for (int k = 0; count < 3 && k < 3; k++) {
        double unit[3] = {k == 0, k == 1, k == 2};
        for (int round = 0; round < 2; round++)
            for (int j = 0; j < count; j++)
                pel_vec3_along(unit, -pel_vec3_dot(unit, axes[j]), axes[j], unit);
        if (pel_vec3_length(unit) < 0.5)
            continue;
        pel_vec3_normalize(unit);
        pel_vec3_copy(unit, axes[count++]);
    }
}

/* a direction that depends on those that are held: both supports have to want the same, whenever a key says so */
static pel_status check_same(const pel_sim *sim, const pel_held_vertex *held, int32_t owner, int component,
                             const double factor[3], pel_error *error)
{
    const pel_holds *holds = sim->holds;
    const pel_hold *hold = &holds->holds[owner];
    for (int32_t h = 0; h < holds->hold_count; h++)
        for (int32_t k = -1; k < holds->holds[h].key_count; k++) {
            double time = k < 0 ? 0 : holds->holds[h].keys[k].time, along[3];
            double wanted = displacement(hold, component, time);
            held_displacements(holds, held, time, along);
            for (int j = 0; j < held->count; j++)
                wanted -= factor[j] * along[j];
            if (fabs(wanted) <= CONTRADICTION * sim->model->bodies[hold->body].diameter)
                continue;
            return pel_refuse_element(
                error, PEL_BAD_ARGUMENT, "support", owner,
                "let their regions share no vertex, or give both the same displacement",
                "supports '%s' and '%s' contradict each other at vertex %d: they are %.3g m apart at time %.4g s",
                holds->holds[held->owner[0]].name, hold->name, (int)sim->model->mesh_vertex[held->vertex], fabs(wanted),
                time);
        }
    return PEL_OK;
}

static pel_status hold_component(const pel_sim *sim, pel_held_vertex *held, double axes[3][3], int32_t owner,
                                 int component, pel_error *error)
{
    double rest[3], factor[3] = {0};
    pel_vec3_copy(sim->holds->holds[owner].axes[component], rest);
    for (int round = 0; round < 2; round++)
        for (int j = 0; j < held->count; j++) {
            double part = pel_vec3_dot(rest, axes[j]);
            factor[j] += part;
            pel_vec3_along(rest, -part, axes[j], rest);
        }
    double length = pel_vec3_length(rest);
    if (length < DEPENDENT)
        return check_same(sim, held, owner, component, factor, error);
    factor[held->count] = length;
    pel_vec3_scale(rest, 1 / length, axes[held->count]);
    memcpy(held->factor[held->count], factor, sizeof factor);
    held->owner[held->count] = owner;
    held->component[held->count++] = component;
    return PEL_OK;
}

static void add_springs(pel_holds *holds, const pel_support_def *def, int32_t owner, int32_t v, double stiffness)
{
    for (int k = 0; stiffness > 0 && k < 3; k++)
        if (def->fix[k])
            holds->springs[holds->spring_count++] = (pel_hold_spring){v, owner, k, stiffness};
}

static pel_status hold_vertex(pel_sim *sim, const pel_support_def *def, int32_t owner, int32_t v, int32_t *place,
                              pel_error *error)
{
    PEL_ASSERT_INDEX(v, sim->model->vertex_count);
    pel_holds *holds = sim->holds;
    if (!(def->fix[0] || def->fix[1] || def->fix[2]))
        return PEL_OK;
    if (place[v] == 0) {
        holds->held[holds->held_count].vertex = holds->vertices[holds->held_count] = v;
        place[v] = ++holds->held_count;
    }
    pel_held_vertex *held = &holds->held[place[v] - 1];
    pel_status status = PEL_OK;
    for (int k = 0; status == PEL_OK && k < 3; k++)
        if (def->fix[k])
            status = hold_component(sim, held, holds->axes[place[v] - 1], owner, k, error);
    return status;
}

/* m2 at rest, of the mesh's vertices: thirds of the triangles with all corners in the region */
static pel_status find_areas(const pel_sim *sim, const pel_support_def *def, int32_t support, double *areas,
                             pel_error *error)
{
    const pel_mesh *mesh = sim->model->bodies[def->body].mesh;
    double sum = 0;
    /* -1 = not in the region */
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        areas[v] = -1;
    for (int32_t i = 0; i < def->vertex_count; i++)
        areas[def->vertices[i]] = 0;
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        const int32_t *v = mesh->triangles[t];
        if (areas[v[0]] < 0 || areas[v[1]] < 0 || areas[v[2]] < 0)
            continue;
        double area = pel_vec3_triangle_area(mesh->positions[v[0]], mesh->positions[v[1]], mesh->positions[v[2]]);
        for (int k = 0; k < 3; k++)
            areas[v[k]] += area / 3;
        sum += area;
    }
    if (sum > 0)
        return PEL_OK;
    return pel_refuse_element(error, PEL_BAD_ARGUMENT, "support", support,
                              "choose a region with all three corners of triangles, or give the stiffness of vertices",
                              "foundation of the support is under no triangle");
}

/* edges with both ends in the region */
static void fix_edges(pel_sim *sim, const pel_support_def *def, int32_t support, int32_t *marks)
{
    pel_newton *newton = sim->newton;
    const pel_tangent_edge *edges = pel_tangent_edges_of(pel_newton_tangent(newton));
    const int32_t *index = sim->model->bodies[def->body].model_index;
    memset(marks, 0, (size_t)sim->model->vertex_count * sizeof *marks);
    for (int32_t i = 0; i < def->vertex_count; i++)
        marks[index[def->vertices[i]]] = 1;
    for (int32_t e = 0; e < pel_newton_pattern(newton)->edge_count; e++)
        if (edges[e].body == def->body && marks[edges[e].vertices[0]] != 0 && marks[edges[e].vertices[1]] != 0 &&
            !sim->holds->edge_fixed[e]) {
            sim->holds->edge_fixed[e] = 1;
            sim->holds->edge_owner[e] = support;
        }
}

static pel_status make_room(pel_holds *holds, const pel_sim *sim, const pel_sim_def *def, pel_error *error)
{
    size_t most = 0;
    for (int32_t s = 0; s < def->support_count; s++)
        most += (size_t)def->supports[s].vertex_count;
    holds->held = pel_allocate(most, sizeof *holds->held);
    holds->vertices = pel_allocate(most, sizeof *holds->vertices);
    holds->axes = pel_allocate(most, sizeof *holds->axes);
    holds->springs = pel_allocate(3 * most, sizeof *holds->springs);
    size_t edges = (size_t)pel_newton_pattern(sim->newton)->edge_count + 1;
    holds->edge_fixed = pel_allocate(edges, 1);
    holds->edge_owner = pel_allocate(edges, sizeof *holds->edge_owner);
    bool room = holds->held != NULL && holds->vertices != NULL && holds->axes != NULL && holds->springs != NULL &&
                holds->edge_fixed != NULL && holds->edge_owner != NULL;
    return room ? PEL_OK : pel_fail_memory(error);
}

/* a pin holds before a support, which may not want it elsewhere */
static pel_status check_pin(const pel_sim *sim, const pel_support_def *def, int32_t support, int32_t vertex,
                            pel_error *error)
{
    if (pel_vec3_squared_length(def->displacement) == 0)
        return PEL_OK;
    return pel_refuse_element(
        error, PEL_BAD_ARGUMENT, "support", support, "let the region of the support and `pinned` share no vertex",
        "support '%s' displaces vertex %d, which is pinned", sim->holds->holds[support].name, (int)vertex);
}

static pel_status hold_all(pel_sim *sim, const pel_sim_def *def, pel_error *error)
{
    int32_t *place = pel_allocate((size_t)sim->model->vertex_count, sizeof *place);
    double *areas = pel_allocate((size_t)sim->model->vertex_count, sizeof *areas);
    pel_status status = place != NULL && areas != NULL ? PEL_OK : pel_fail_memory(error);
    for (int32_t s = 0; status == PEL_OK && s < def->support_count; s++) {
        const pel_support_def *support = &def->supports[s];
        const int32_t *index = sim->model->bodies[support->body].model_index;
        if (support->foundation > 0)
            status = find_areas(sim, support, s, areas, error);
        for (int32_t i = 0; status == PEL_OK && i < support->vertex_count; i++) {
            int32_t v = index[support->vertices[i]];
            if (!(sim->model->inverse_mass[v] > 0)) {
                status = check_pin(sim, support, s, support->vertices[i], error);
                continue;
            }
            if (support->foundation > 0)
                add_springs(sim->holds, support, s, v, support->foundation * areas[support->vertices[i]]);
            else if (support->stiffness > 0)
                add_springs(sim->holds, support, s, v,
                            support->stiffness *
                                pel_vertex_share(&sim->model->bodies[support->body], support->vertices[i]));
            else
                status = hold_vertex(sim, support, s, v, place, error);
        }
    }
    for (int32_t s = 0; status == PEL_OK && s < def->support_count; s++)
        if (def->supports[s].fix_rotation)
            fix_edges(sim, &def->supports[s], s, place);
    pel_free(place);
    pel_free(areas);
    for (int32_t h = 0; h < sim->holds->held_count; h++)
        complete(sim->holds->axes[h], sim->holds->held[h].count);
    return status;
}

pel_status pel_holds_create(pel_sim *sim, const pel_sim_def *def, pel_error *error)
{
    if (def->support_count == 0)
        return PEL_OK;
    if (!sim->stepper->turns_edges)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "support", 0,
                                  "use the method static or implicit, or pin the vertices",
                                  "this method has no supports of single components");
    for (int32_t s = 0; s < def->support_count; s++) {
        pel_status status = check_def(sim, &def->supports[s], s, error);
        if (status != PEL_OK)
            return status;
        if (sim->model->bodies[def->supports[s].body].detail != NULL)
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "support", s,
                                      "leave out refine of the body, or pin the vertices",
                                      "a support holds vertices of a body that refines");
    }
    pel_holds *holds = sim->holds = pel_allocate(1, sizeof *holds);
    if (holds == NULL)
        return pel_fail_memory(error);
    holds->holds = pel_allocate((size_t)def->support_count, sizeof *holds->holds);
    if (holds->holds == NULL)
        return pel_fail_memory(error);
    holds->hold_count = def->support_count;
    pel_status status = make_room(holds, sim, def, error);
    for (int32_t s = 0; status == PEL_OK && s < def->support_count; s++)
        status = copy_def(&holds->holds[s], &def->supports[s], error);
    return status == PEL_OK ? hold_all(sim, def, error) : status;
}

void pel_holds_destroy(pel_sim *sim)
{
    pel_holds *holds = sim->holds;
    if (holds == NULL)
        return;
    for (int32_t h = 0; h < holds->hold_count; h++)
        pel_free(holds->holds[h].keys);
    PEL_FREE_ALL(holds->holds, holds->held, holds->vertices, holds->axes, holds->springs, holds->edge_fixed,
                 holds->edge_owner);
    pel_free(holds);
}

bool pel_holds_has_body(const pel_sim *sim, int32_t body)
{
    PEL_ASSERT_INDEX(body, sim->model->body_count);
    for (int32_t h = 0; sim->holds != NULL && h < sim->holds->hold_count; h++)
        if (sim->holds->holds[h].body == body)
            return true;
    return false;
}

bool pel_holds_move(const pel_sim *sim)
{
    for (int32_t h = 0; sim->holds != NULL && h < sim->holds->hold_count; h++)
        for (int k = 0; k < 3; k++)
            if (sim->holds->holds[h].value[k] != 0)
                return true;
    return false;
}

/* ---- mechanisms ---- */

/* The rigid motions of a body that its supports leave: v + w x (x - center) as (v, size w); Gauss elimination of the
   sum of the squares of all directions that are held. */
typedef struct motion {
    double center[3], size, squares[6][6];
} motion;

static void add_direction(motion *m, const double point[3], const double direction[3], bool is_turn)
{
    double row[6] = {0}, arm[3], moment[3];
    pel_vec3_subtract(point, m->center, arm);
    pel_vec3_cross(arm, direction, moment);
    for (int k = 0; k < 3; k++) {
        row[k] = is_turn ? 0 : direction[k];
        row[3 + k] = is_turn ? direction[k] : moment[k] / m->size;
    }
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 6; j++)
            m->squares[i][j] += row[i] * row[j];
}

static void add_held(const pel_sim *sim, int32_t body, motion *m)
{
    static const double unit[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const pel_holds *holds = sim->holds;
    const pel_body *own = &sim->model->bodies[body];
    double at[3];
    for (int32_t v = own->slice_begin * PEL_WIDTH; v < pel_body_place_end(sim->model, body); v++) {
        pel_vertex_position(sim->model->rest, v, at);
        for (int k = 0; sim->model->mesh_vertex[v] >= 0 && !(sim->model->inverse_mass[v] > 0) && k < 3; k++)
            add_direction(m, at, unit[k], false);
    }
    for (int32_t h = 0; h < holds->held_count; h++) {
        pel_vertex_position(sim->model->rest, holds->held[h].vertex, at);
        for (int k = 0; holds->holds[holds->held[h].owner[0]].body == body && k < holds->held[h].count; k++)
            add_direction(m, at, holds->axes[h][k], false);
    }
    for (int32_t i = 0; i < holds->spring_count; i++) {
        const pel_hold *hold = &holds->holds[holds->springs[i].owner];
        pel_vertex_position(sim->model->rest, holds->springs[i].vertex, at);
        if (hold->body == body)
            add_direction(m, at, hold->axes[holds->springs[i].component], false);
    }
    pel_newton *newton = sim->newton;
    const pel_tangent_edge *edges = pel_tangent_edges_of(pel_newton_tangent(newton));
    for (int32_t e = 0; e < pel_newton_pattern(newton)->edge_count; e++) {
        double end[3], along[3];
        if (!holds->edge_fixed[e] || edges[e].body != body)
            continue;
        pel_vertex_position(sim->model->rest, edges[e].vertices[0], at);
        pel_vertex_position(sim->model->rest, edges[e].vertices[1], end);
        pel_vec3_subtract(end, at, along);
        pel_vec3_normalize(along);
        add_direction(m, at, along, true);
    }
}

/* Gauss and Jordan with pivots from the diagonal; false and a motion that stays free where there is one */
static bool find_free_motion(motion *m, double free[6])
{
    bool done[6] = {false};
    double largest = 0;
    for (int i = 0; i < 6; i++)
        largest = pel_max(largest, m->squares[i][i]);
    for (int round = 0; round < 6; round++) {
        int pivot = -1;
        for (int i = 0; i < 6; i++)
            if (!done[i] && (pivot < 0 || m->squares[i][i] > m->squares[pivot][pivot]))
                pivot = i;
        if (!(m->squares[pivot][pivot] > 1e-10 * largest)) {
            for (int i = 0; i < 6; i++)
                free[i] = done[i] ? 0 - m->squares[i][pivot] : i == pivot;
            return true;
        }
        done[pivot] = true;
        double scale = 1 / m->squares[pivot][pivot];
        for (int j = 0; j < 6; j++)
            m->squares[pivot][j] *= scale;
        for (int i = 0; i < 6; i++) {
            double share = m->squares[i][pivot];
            for (int j = 0; i != pivot && j < 6; j++)
                m->squares[i][j] -= share * m->squares[pivot][j];
        }
    }
    return false;
}

/* a support of the body fixes rotations, but there is no edge that has one */
static bool has_idle_clamp(const pel_sim *sim, int32_t body)
{
    bool fixes = false;
    for (int32_t h = 0; h < sim->holds->hold_count; h++)
        fixes |= sim->holds->holds[h].body == body && sim->holds->holds[h].fixes_rotation;
    const pel_shell *shell = sim->model->bodies[body].shell;
    return fixes && (shell == NULL || !shell->bending->turns_edges);
}

static pel_status refuse_mechanism(const pel_sim *sim, int32_t body, const motion *m, const double free[6],
                                   pel_error *error)
{
    const char *name = sim->model->bodies[body].name;
    double turn[3], way[3], foot[3];
    for (int k = 0; k < 3; k++)
        turn[k] = free[3 + k] / m->size;
    pel_vec3_copy(free, way);
    for (int k = 0; k < 3; k++) {
        way[k] = fabs(way[k]) < 1e-6 ? 0 : way[k];
        turn[k] = fabs(turn[k]) * m->size < 1e-6 ? 0 : turn[k];
    }
    double square = pel_vec3_squared_length(turn), length = sqrt(square);
    if (length * m->size > 1e-6) {
        pel_vec3_cross(turn, way, foot);
        pel_vec3_along(m->center, 1 / square, foot, foot);
        for (int k = 0; k < 3; k++)
            foot[k] = fabs(foot[k]) < 1e-6 * m->size ? 0 : foot[k];
        pel_fail(error, PEL_BAD_ARGUMENT,
                 "supports leave body '%s' free to turn about the axis (%.3g, %.3g, %.3g) through (%.3g, %.3g, %.3g): "
                 "it has no equilibrium",
                 name, turn[0] / length, turn[1] / length, turn[2] / length, foot[0], foot[1], foot[2]);
    } else {
        pel_vec3_normalize(way);
        pel_fail(error, PEL_BAD_ARGUMENT,
                 "supports leave body '%s' free to move along (%.3g, %.3g, %.3g): it has no equilibrium", name, way[0],
                 way[1], way[2]);
    }
    pel_fail_element(error, "body", body);
    if (has_idle_clamp(sim, body))
        pel_fail_remedy(error,
                        "give the body bending of model midedge, whose edges `rotation: fixed` and `symmetry` clamp, "
                        "hold that motion at one vertex, or use the method implicit");
    else
        pel_fail_remedy(error, "hold that motion at one vertex, or use the method implicit");
    return PEL_BAD_ARGUMENT;
}

pel_status pel_holds_check_mechanism(const pel_sim *sim, int32_t body, pel_error *error)
{
    PEL_ASSERT_INDEX(body, sim->model->body_count);
    const pel_body *own = &sim->model->bodies[body];
    motion m = {.size = own->diameter};
    double free[6];
    if (!pel_holds_has_body(sim, body) || own->has_volumetric)
        return PEL_OK;
    pel_vertex_position(sim->model->rest, own->slice_begin * PEL_WIDTH, m.center);
    add_held(sim, body, &m);
    return find_free_motion(&m, free) ? refuse_mechanism(sim, body, &m, free, error) : PEL_OK;
}

/* ---- in a step ---- */

pel_newton_frames pel_holds_fix(const pel_sim *sim, double time, uint8_t *fixed, double *target)
{
    const pel_holds *holds = sim->holds;
    if (holds == NULL)
        return (pel_newton_frames){0};
    for (int32_t h = 0; h < holds->held_count; h++) {
        const pel_held_vertex *held = &holds->held[h];
        double rest[3], along[3], place[3];
        uint8_t *at = fixed + 3 * (size_t)held->vertex;
        bool is_grasped = at[0];
        pel_vertex_position(sim->model->rest, held->vertex, rest);
        pel_vec3_copy(target + 3 * (size_t)held->vertex, place);
        held_displacements(holds, held, time, along);
        for (int k = 0; k < 3; k++) {
            bool is_held = !is_grasped && k < held->count;
            at[k] = is_grasped || is_held;
            target[3 * (size_t)held->vertex + (size_t)k] =
                is_held ? pel_vec3_dot(holds->axes[h][k], rest) + along[k] : pel_vec3_dot(holds->axes[h][k], place);
        }
    }
    int32_t edges = pel_newton_pattern(sim->newton)->edge_count;
    memcpy(fixed + 3 * (size_t)sim->model->vertex_count, holds->edge_fixed, (size_t)edges);
    return (pel_newton_frames){holds->held_count, holds->vertices, (const double(*)[3][3])holds->axes, NULL};
}

/* m, how far a spring is stretched at a position */
static double stretch(const pel_sim *sim, const pel_hold_spring *spring, double time, const double x[3])
{
    const pel_hold *hold = &sim->holds->holds[spring->owner];
    double rest[3], way[3];
    pel_vertex_position(sim->model->rest, spring->vertex, rest);
    pel_vec3_subtract(x, rest, way);
    return pel_vec3_dot(way, hold->axes[spring->component]) - displacement(hold, spring->component, time);
}

double pel_holds_evaluate(const pel_sim *sim, double time, const double *unknowns, double *gradient)
{
    double energy = 0;
    for (int32_t i = 0; sim->holds != NULL && i < sim->holds->spring_count; i++) {
        const pel_hold_spring *spring = &sim->holds->springs[i];
        const double *axis = sim->holds->holds[spring->owner].axes[spring->component];
        double long_by = stretch(sim, spring, time, unknowns + 3 * (size_t)spring->vertex);
        double *at = gradient + 3 * (size_t)spring->vertex;
        pel_vec3_along(at, spring->stiffness * long_by, axis, at);
        energy += 0.5 * spring->stiffness * long_by * long_by;
    }
    return energy;
}

void pel_holds_add_matrix(const pel_sim *sim, pel_matrix *matrix)
{
    for (int32_t i = 0; sim->holds != NULL && i < sim->holds->spring_count; i++) {
        const pel_hold_spring *spring = &sim->holds->springs[i];
        const double *axis = sim->holds->holds[spring->owner].axes[spring->component];
        double *values = matrix->values + matrix->block_start[pel_matrix_block(matrix, spring->vertex, spring->vertex)];
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++)
                values[a + 3 * b] += spring->stiffness * axis[a] * axis[b];
    }
}

/* ---- readings ---- */

/* N, of a vertex on a support along a direction */
static void add_reading(pel_sim *sim, pel_hold *hold, int32_t v, double size, const double direction[3])
{
    PEL_ASSERT_INDEX(v, sim->model->vertex_count);
    double point[3], force[3], torque[3];
    pel_vertex_position(sim->state->position_next, v, point);
    pel_vec3_scale(direction, size, force);
    pel_vec3_along(sim->reactions[v], -pel_part_share(sim), force, sim->reactions[v]);
    pel_vec3_cross(point, force, torque);
    pel_vec3_add(hold->part.force, force, hold->part.force);
    pel_vec3_add(hold->part.torque, torque, hold->part.torque);
    hold->part.vertex_count++;
}

/* the force of a vertex on its supports, distributed over their directions */
static void read_held(pel_sim *sim, int32_t h)
{
    pel_holds *holds = sim->holds;
    const pel_held_vertex *held = &holds->held[h];
    double force[3], share[3];
    if (sim->held != NULL && sim->held[held->vertex])
        return;
    sim->stepper->get_held_force(sim, held->vertex, force);
    for (int i = held->count - 1; i >= 0; i--) {
        share[i] = pel_vec3_dot(force, holds->axes[h][i]);
        for (int j = i + 1; j < held->count; j++)
            share[i] -= held->factor[j][i] * share[j];
        share[i] /= held->factor[i][i];
        pel_hold *owner = &holds->holds[held->owner[i]];
        add_reading(sim, owner, held->vertex, share[i], owner->axes[held->component[i]]);
    }
}

/* the moments of clamped edges, about these edges */
static void read_clamps(const pel_sim *sim)
{
    const pel_holds *holds = sim->holds;
    pel_newton *newton = sim->newton;
    const pel_tangent_edge *edges = pel_tangent_edges_of(pel_newton_tangent(newton));
    const double *moments = pel_newton_gradient(newton) + 3 * (size_t)sim->model->vertex_count;
    for (int32_t e = 0; e < pel_newton_pattern(newton)->edge_count; e++) {
        double from[3], to[3], along[3], *torque = holds->holds[holds->edge_owner[e]].part.torque;
        if (!holds->edge_fixed[e])
            continue;
        pel_vertex_position(sim->state->position_next, edges[e].vertices[0], from);
        pel_vertex_position(sim->state->position_next, edges[e].vertices[1], to);
        pel_vec3_subtract(to, from, along);
        pel_vec3_normalize(along);
        pel_vec3_along(torque, -moments[e], along, torque);
    }
}

/* readings of a step in parts are means */
static void add_part(const pel_sim *sim, pel_hold *hold)
{
    double share = pel_part_share(sim);
    if (sim->part.at == 0)
        hold->reading = (pel_support_reading){0};
    pel_vec3_along(hold->reading.force, share, hold->part.force, hold->reading.force);
    pel_vec3_along(hold->reading.torque, share, hold->part.torque, hold->reading.torque);
    hold->reading.vertex_count = hold->part.vertex_count;
}

void pel_holds_read(pel_sim *sim, double time)
{
    pel_holds *holds = sim->holds;
    if (holds == NULL)
        return;
    for (int32_t h = 0; h < holds->hold_count; h++)
        holds->holds[h].part = (pel_support_reading){0};
    for (int32_t h = 0; h < holds->held_count; h++)
        read_held(sim, h);
    read_clamps(sim);
    for (int32_t i = 0; i < holds->spring_count; i++) {
        const pel_hold_spring *spring = &holds->springs[i];
        pel_hold *hold = &holds->holds[spring->owner];
        double point[3];
        pel_vertex_position(sim->state->position_next, spring->vertex, point);
        add_reading(sim, hold, spring->vertex, spring->stiffness * stretch(sim, spring, time, point),
                    hold->axes[spring->component]);
    }
    for (int32_t h = 0; h < holds->hold_count; h++)
        add_part(sim, &holds->holds[h]);
}

double pel_holds_work(pel_sim *sim, double time)
{
    pel_holds *holds = sim->holds;
    double work = 0, energy = 0;
    if (holds == NULL)
        return 0;
    /* readings of methods with velocities are means of the step, the others forces at its end */
    double share = pel_sim_has_velocity(sim) ? 1 : 0.5;
    for (int32_t h = 0; h < holds->hold_count; h++) {
        pel_hold *hold = &holds->holds[h];
        for (int c = 0; c < 3; c++) {
            double way = displacement(hold, c, time);
            work -= (way - hold->booked_way[c]) * (share * pel_vec3_dot(hold->part.force, hold->axes[c]) +
                                                   (1 - share) * pel_vec3_dot(hold->booked_force, hold->axes[c]));
            hold->booked_way[c] = way;
        }
        pel_vec3_copy(hold->part.force, hold->booked_force);
    }
    for (int32_t i = 0; i < holds->spring_count; i++) {
        double point[3];
        pel_vertex_position(sim->state->position_next, holds->springs[i].vertex, point);
        double long_by = stretch(sim, &holds->springs[i], time, point);
        energy += 0.5 * holds->springs[i].stiffness * long_by * long_by;
    }
    work += holds->booked_energy - energy;
    holds->booked_energy = energy;
    return work;
}

void pel_holds_add_readings(const pel_sim *sim, int32_t body, pel_support_reading *sum)
{
    PEL_ASSERT_INDEX(body, sim->model->body_count);
    for (int32_t h = 0; sim->holds != NULL && h < sim->holds->hold_count; h++) {
        const pel_hold *hold = &sim->holds->holds[h];
        if (hold->body != body)
            continue;
        pel_vec3_add(sum->force, hold->reading.force, sum->force);
        pel_vec3_add(sum->torque, hold->reading.torque, sum->torque);
        sum->vertex_count += hold->reading.vertex_count;
    }
}

int32_t pel_sim_support_count(const pel_sim *sim)
{
    if (sim == NULL)
        return 0;
    return sim->holds != NULL ? sim->holds->hold_count : 0;
}

const char *pel_sim_support_name(const pel_sim *sim, int32_t support)
{
    if (support < 0 || support >= pel_sim_support_count(sim))
        return "";
    return sim->holds->holds[support].name;
}

void pel_sim_get_support_part(const pel_sim *sim, int32_t support, pel_support_reading *reading)
{
    if (reading == NULL || support < 0 || support >= pel_sim_support_count(sim))
        return;
    *reading = sim->holds->holds[support].reading;
}

/* ---- snapshots ---- */

void pel_holds_transfer(pel_cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    pel_holds *holds = sim->holds;
    if (holds == NULL)
        return;
    for (int32_t h = 0; h < holds->hold_count; h++) {
        pel_transfer(at, &holds->holds[h].reading, sizeof holds->holds[h].reading);
        pel_transfer(at, holds->holds[h].booked_force, sizeof holds->holds[h].booked_force);
        pel_transfer(at, holds->holds[h].booked_way, sizeof holds->holds[h].booked_way);
    }
    pel_transfer(at, &holds->booked_energy, sizeof holds->booked_energy);
}

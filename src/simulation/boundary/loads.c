#include "boundary/loads.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "boundary/fluid.h"
#include "boundary/follower.h"
#include "boundary/share.h"
#include "boundary/wind.h"
#include "force/pressure.h"
#include "force/shell_force.h"
#include "math/extremes.h"
#include "math/vec3.h"
#include "model/quantity.h"
#include "pellicle/topology.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

pel_load_def pel_load_def_default(void)
{
    pel_load_def def = {0};
    pel_def_reset(PEL_DEF_LOAD, &def);
    return def;
}

static bool is_finite3(const double a[3])
{
    return isfinite(a[0]) && isfinite(a[1]) && isfinite(a[2]);
}

/* of its largest value: a larger change of a mean load from one step to the next is a jump */
#define JUMP_SHARE 0.25

static pel_status check_load(const pel_sim *sim, const pel_load_def *def, int32_t load, pel_error *error)
{
    PEL_ASSERT_INDEX(load, sim->loads->count);
    if (def->body < 0 || def->body >= sim->model->body_count)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "load", load, "give the number of a body of the model",
                                  "load names a body that does not exist");
    if (PEL_IS_NO_CHOICE(def->kind, PEL_LOAD_MOMENT + 1))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "load", load, "give one of pel_load_kind",
                                  "kind of the load is unknown");
    if (def->vertex_count < 0 || def->key_count < 0 || (def->key_count > 0 && def->keys == NULL))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "load", load, "give counts of the arrays",
                                  "keys is null, or vertex_count or key_count is below 0");
    if (!is_finite3(def->force))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "load", load, "give three finite numbers",
                                  "force is not finite");
    if (!(def->until > def->from))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "load", load, "give `from` less than `until`",
                                  "load ends before it begins: from is not less than until");
    const pel_body *body = &sim->model->bodies[def->body];
    if (def->vertices != NULL && def->vertex_count < 1)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "load", load,
                                  "choose a region that holds at least one vertex", "load acts on no vertex");
    for (int32_t i = 0; def->vertices != NULL && i < def->vertex_count; i++) {
        if (def->vertices[i] < 0 || def->vertices[i] >= body->mesh->vertex_count)
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "load", load, "give vertex numbers of the mesh",
                                      "load names a vertex that does not exist");
        if (def->weights != NULL && !isfinite(def->weights[i]))
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "load", load, "give finite weights",
                                      "weight is not finite");
    }
    if (def->kind >= PEL_LOAD_PER_LENGTH && body->detail != NULL)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "load", load, "give the load per vertex or in total",
                                  "load on edges of a body that refines");
    if (!pel_keys_are_ordered(def->keys, def->key_count))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "load", load, "give keys with increasing times",
                                  "keys are not finite or not in order");
    return PEL_OK;
}

/* ---- loads on boundary edges ---- */

/* m, half the length at rest of the boundary edges at each vertex of the mesh whose ends the load both has; lips of
   cuts are none */
static pel_status find_lengths(const pel_body *body, const pel_load_def *def, double *lengths, pel_error *error)
{
    const pel_mesh *mesh = body->mesh;
    uint8_t *marks = pel_allocate((size_t)mesh->vertex_count, sizeof *marks);
    pel_topology *topology = NULL;
    pel_status status = marks != NULL ? pel_topology_create(mesh, &topology, error) : pel_fail_memory(error);
    if (status != PEL_OK) {
        pel_free(marks);
        return status;
    }
    memset(marks, def->vertices == NULL, (size_t)mesh->vertex_count);
    for (int32_t i = 0; def->vertices != NULL && i < def->vertex_count; i++)
        marks[def->vertices[i]] = 1;
    for (int32_t h = 0; h < 3 * topology->triangle_count; h++) {
        int32_t a = pel_half_edge_origin(topology, h), b = pel_half_edge_target(topology, h);
        if (topology->twin[h] >= 0 || !marks[a] || !marks[b] || pel_is_lip(body, h))
            continue;
        double half = 0.5 * pel_vec3_distance(mesh->positions[a], mesh->positions[b]);
        lengths[a] += half;
        lengths[b] += half;
    }
    pel_topology_destroy(topology);
    pel_free(marks);
    return PEL_OK;
}

/* weights of vertices become weights of edges */
static pel_status weigh_by_length(const pel_body *body, const pel_load_def *def, int32_t index, pel_load *load,
                                  pel_error *error)
{
    double *lengths = pel_allocate((size_t)body->mesh->vertex_count, sizeof *lengths), sum = 0;
    pel_status status = lengths != NULL ? find_lengths(body, def, lengths, error) : pel_fail_memory(error);
    for (int32_t i = 0; status == PEL_OK && i < load->vertex_count; i++) {
        load->weights[i] *= lengths[def->vertices != NULL ? def->vertices[i] : i];
        sum += fabs(load->weights[i]);
    }
    pel_free(lengths);
    if (status == PEL_OK && !(sum > 0))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "load", index,
                                  "choose a region with both ends of boundary edges, or give the load per vertex",
                                  "load per length acts on no boundary edge");
    return status;
}

/* ---- loads on a body that refines ---- */

static size_t place_count(const pel_sim *sim, int32_t body)
{
    return (size_t)(sim->active->bodies[body].fine_limit - sim->model->bodies[body].slice_begin * PEL_WIDTH);
}

/* sets the weight of a place, 0 = none; true if it has changed */
static bool set_weight(pel_load *load, int32_t at, double weight)
{
    bool differs = load->weight_of_place[at] != weight;
    load->weight_of_place[at] = weight;
    return differs;
}

static bool set_vertex(const pel_sim *sim, pel_load *load, int32_t v)
{
    const pel_refined_model *active = sim->active;
    int32_t first = sim->model->bodies[load->body].slice_begin * PEL_WIDTH;
    int32_t place = active->bodies[load->body].model_index[v];
    double weight = active->is_base[place] ? load->base_weights[v] : load->densities[v] * active->areas[place];
    return set_weight(load, place - first, weight);
}

/* by rising places: sums over the list do not depend on how the surface came about */
static void list_places(const pel_sim *sim, pel_load *load)
{
    int32_t first = sim->model->bodies[load->body].slice_begin * PEL_WIDTH;
    load->vertex_count = 0;
    for (size_t i = 0; i < place_count(sim, load->body); i++)
        if (load->weight_of_place[i] != 0) {
            load->vertices[load->vertex_count] = first + (int32_t)i;
            load->weights[load->vertex_count++] = load->weight_of_place[i];
        }
}

void pel_loads_update(pel_sim *sim, int32_t body)
{
    PEL_ASSERT_INDEX(body, sim->model->body_count);
    const pel_refined_model *active = sim->active;
    int32_t first = sim->model->bodies[body].slice_begin * PEL_WIDTH;
    for (int32_t l = 0; l < sim->loads->count; l++) {
        pel_load *load = &sim->loads->items[l];
        bool differs = false;
        if (load->body != body || load->densities == NULL)
            continue;
        for (int32_t i = 0; i < active->released_count; i++)
            differs |= set_weight(load, active->released[i] - first, 0);
        for (int32_t d = 0; d < active->dirty_count; d++)
            differs |= set_vertex(sim, load, active->dirty[d]);
        if (differs)
            list_places(sim, load);
    }
}

void pel_loads_rebuild(pel_sim *sim, int32_t body)
{
    PEL_ASSERT_INDEX(body, sim->model->body_count);
    const pel_front *front = sim->model->bodies[body].front;
    for (int32_t l = 0; l < sim->loads->count; l++) {
        pel_load *load = &sim->loads->items[l];
        if (load->body != body || load->densities == NULL)
            continue;
        memset(load->weight_of_place, 0, place_count(sim, body) * sizeof *load->weight_of_place);
        for (int32_t i = 0; i < front->vertex_count; i++)
            set_vertex(sim, load, front->vertices[i]);
        list_places(sim, load);
    }
}

static pel_status spread_load(pel_sim *sim, pel_load *load, const pel_load_def *def, pel_error *error)
{
    const pel_body_levels *detail = sim->model->bodies[def->body].detail;
    int32_t mesh_count = sim->model->bodies[def->body].mesh->vertex_count;
    int32_t count = def->vertices != NULL ? def->vertex_count : mesh_count;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(load->base_weights, mesh_count),
                          PEL_ROOM(load->densities, detail->forest->levels[detail->forest->depth]->vertex_count),
                          PEL_ROOM(load->weight_of_place, place_count(sim, def->body))))
        return pel_fail_memory(error);
    for (int32_t i = 0; i < count; i++)
        load->base_weights[def->vertices != NULL ? def->vertices[i] : i] += load->weights[i];
    memcpy(load->densities, load->base_weights, (size_t)mesh_count * sizeof *load->densities);
    pel_levels_spread(detail, 1, load->densities);
    pel_loads_rebuild(sim, def->body);
    return PEL_OK;
}

static pel_status create_load(pel_sim *sim, const pel_load_def *def, int32_t index, pel_error *error)
{
    pel_status status = check_load(sim, def, index, error);
    if (status != PEL_OK)
        return status;
    pel_load *load = &sim->loads->items[index];
    const pel_body *body = &sim->model->bodies[def->body];
    int32_t count = def->vertices != NULL ? def->vertex_count : body->mesh->vertex_count;
    snprintf(load->name, sizeof load->name, "%s", def->name != NULL ? def->name : "");
    memcpy(load->force, def->force, sizeof load->force);
    load->body = def->body;
    load->kind = def->kind;
    load->from = def->from;
    load->until = def->until;
    size_t room = (size_t)count + (body->detail != NULL ? place_count(sim, def->body) : 0);
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(load->vertices, room), PEL_ROOM(load->weights, room),
                          PEL_ROOM(load->keys, def->key_count)))
        return pel_fail_memory(error);
    if (def->key_count > 0)
        memcpy(load->keys, def->keys, (size_t)def->key_count * sizeof *load->keys);
    load->key_count = def->key_count;
    load->vertex_count = count;
    for (int32_t i = 0; i < count; i++) {
        load->vertices[i] = body->model_index[def->vertices != NULL ? def->vertices[i] : i];
        load->weights[i] = def->weights != NULL ? def->weights[i] : 1;
    }
    if (def->kind <= PEL_LOAD_PER_VERTEX)
        status = pel_load_share(sim->given, def, load->weights, error);
    if (status != PEL_OK)
        return status;
    if (body->detail != NULL)
        return spread_load(sim, load, def, error);
    return def->kind == PEL_LOAD_PER_LENGTH ? weigh_by_length(body, def, index, load, error) : PEL_OK;
}

/* room for pressures whose work is that of substeps */
static bool make_pressed(pel_sim *sim)
{
    bool any = false;
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_shell *shell = sim->model->bodies[b].shell;
        any |= shell != NULL && (shell->outside.key_count > 1 || shell->target.key_count > 1 ||
                                 !pel_shell_has_potential(&sim->model->bodies[b]));
    }
    if (!any || !pel_sim_projects_elements(sim))
        return true;
    sim->loads->pressed = pel_allocate_aligned((size_t)sim->model->vertex_count, sizeof *sim->loads->pressed);
    return sim->loads->pressed != NULL;
}

pel_status pel_loads_create(pel_sim *sim, const pel_load_def *defs, int32_t count, pel_error *error)
{
    sim->loads->items = pel_allocate((size_t)count, sizeof *sim->loads->items);
    if (sim->loads->items == NULL || !make_pressed(sim))
        return pel_fail_memory(error);
    sim->loads->count = count;
    pel_status status = PEL_OK;
    for (int32_t i = 0; status == PEL_OK && i < count; i++)
        status = create_load(sim, &defs[i], i, error);
    return status;
}

pel_status pel_load_retime(pel_sim *sim, int32_t index, const pel_load_def *def, pel_error *error)
{
    pel_load_def *own = (pel_load_def *)(uintptr_t)sim->def.loads + index;
    pel_load *load = &sim->loads->items[index];
    pel_status status = check_load(sim, def, index, error);
    if (status != PEL_OK)
        return status;
    *own = *def;
    memcpy(load->force, def->force, sizeof load->force);
    load->from = def->from;
    load->until = def->until;
    sim->present.has_force = false;
    return PEL_OK;
}

void pel_loads_destroy(pel_sim *sim)
{
    for (int32_t i = 0; i < sim->loads->count; i++) {
        PEL_FREE_ALL(sim->loads->items[i].vertices, sim->loads->items[i].weights, sim->loads->items[i].keys,
                     sim->loads->items[i].base_weights, sim->loads->items[i].densities,
                     sim->loads->items[i].weight_of_place);
    }
    PEL_FREE_ALL(sim->loads->items, sim->loads->pressed);
    pel_wind_destroy(sim);
}

double pel_load_factor(const pel_sim *sim, const pel_load *load, pel_span span)
{
    span.extrapolates &= sim->loads->is_plain == NULL || !sim->loads->is_plain[load->body];
    return sim->state->load_factor * pel_curve_mean(load->keys, load->key_count, span, load->from, load->until);
}

/* force of a load on a vertex of weight 1 over a span; false when it does not act */
static bool load_force(const pel_sim *sim, const pel_load *load, pel_span span, double force[3])
{
    double factor = pel_load_factor(sim, load, span);
    pel_vec3_scale(load->force, factor, force);
    return factor != 0;
}

static bool has_gravity(const pel_model *model)
{
    return model->gravity[0] != 0 || model->gravity[1] != 0 || model->gravity[2] != 0;
}

static pel_record record_of(const double a[3])
{
    return (pel_record){(pel_real)a[0], (pel_real)a[1], (pel_real)a[2], 0};
}

/* adds force / mass, times the gains, to the new position and velocity of a vertex */
typedef struct real_gains {
    pel_real position, velocity;
} real_gains;

static bool push(pel_sim *sim, int32_t v, real_gains gain, pel_record acceleration)
{
    PEL_ASSERT_INDEX(v, sim->model->vertex_count);
    sim->state->position_next[v] += gain.position * acceleration;
    if (sim->state->velocity_next != NULL)
        sim->state->velocity_next[v] += gain.velocity * acceleration;
    return pel_sim_is_inside(sim, v);
}

static bool apply_gravity(pel_sim *sim, const pel_body *body, real_gains gain)
{
    const pel_model *model = sim->model;
    pel_record gravity = record_of(model->gravity);
    bool inside = true;
    for (int32_t v = body->slice_begin * PEL_WIDTH; v < body->slice_end * PEL_WIDTH; v++) {
        if (model->inverse_mass[v] > 0)
            inside &= push(sim, v, gain, gravity);
    }
    return inside;
}

bool pel_loads_exist(const pel_sim *sim)
{
    return sim->loads->count > 0 || sim->loads->follower_count > 0 || sim->loads->fluid_count > 0 ||
           sim->loads->wind != NULL || sim->loads->external != NULL || sim->loads->dragged != NULL ||
           has_gravity(sim->model);
}

bool pel_loads_act(const pel_sim *sim)
{
    bool any = pel_loads_exist(sim);
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_shell *shell = sim->model->bodies[b].shell;
        any |= shell != NULL && (shell->pressure.outside.value != 0 || shell->pressure_weights != NULL);
    }
    return any;
}

bool pel_loads_apply(pel_sim *sim, pel_span span, pel_gains gains)
{
    const real_gains gain = {(pel_real)gains.position, (pel_real)gains.velocity};
    double force[3];
    bool inside = true;
    for (int32_t l = 0; l < sim->loads->count; l++) {
        const pel_load *load = &sim->loads->items[l];
        if (!load_force(sim, load, span, force))
            continue;
        pel_record full = record_of(force);
        for (int32_t i = 0; i < load->vertex_count; i++) {
            int32_t v = load->vertices[i];
            pel_real scale = (pel_real)load->weights[i] * sim->model->inverse_mass[v];
            inside &= push(sim, v, gain, scale * full);
        }
    }
    for (int32_t i = 0; i < sim->loads->follower_count; i++) {
        pel_follower_force(sim, i, span, sim->state->position, force);
        for (int k = 0; k < 2; k++) {
            int32_t v = sim->loads->followers[i].vertices[k];
            inside &= push(sim, v, gain, (pel_real)0.5 * sim->model->inverse_mass[v] * record_of(force));
        }
    }
    if (sim->loads->fluid_count > 0) {
        memset(sim->force, 0, (size_t)sim->model->vertex_count * sizeof *sim->force);
        pel_fluids_add(sim, sim->state->position, sim->force);
    }
    for (int32_t v = 0; sim->loads->fluid_count > 0 && v < sim->model->vertex_count; v++)
        inside &= push(sim, v, gain, sim->model->inverse_mass[v] * sim->force[v]);
    for (int32_t v = 0; sim->loads->external != NULL && v < sim->model->vertex_count; v++)
        inside &= push(sim, v, gain, sim->model->inverse_mass[v] * sim->loads->external[v]);
    for (int32_t v = 0; sim->loads->dragged != NULL && v < sim->model->vertex_count; v++)
        inside &= push(sim, v, gain, sim->model->inverse_mass[v] * sim->loads->dragged[v]);
    for (int32_t b = 0; has_gravity(sim->model) && b < sim->model->body_count; b++)
        inside &= apply_gravity(sim, &sim->model->bodies[b], gain);
    return inside;
}

double pel_load_product(const pel_sim *sim, int32_t load, pel_span span, const double *vectors)
{
    PEL_ASSERT_INDEX(load, sim->loads->count);
    const pel_load *at = &sim->loads->items[load];
    double force[3], sum = 0;
    if (!load_force(sim, at, span, force))
        return 0;
    for (int32_t i = 0; i < at->vertex_count; i++)
        sum += at->weights[i] * pel_vec3_dot(force, vectors + 3 * (size_t)at->vertices[i]);
    return sum;
}

void pel_loads_add(const pel_sim *sim, pel_span span, const pel_record *positions, pel_record *force)
{
    double each[3];
    for (int32_t l = 0; l < sim->loads->count; l++) {
        const pel_load *load = &sim->loads->items[l];
        if (!load_force(sim, load, span, each))
            continue;
        pel_record full = record_of(each);
        for (int32_t i = 0; i < load->vertex_count; i++)
            force[load->vertices[i]] += (pel_real)load->weights[i] * full;
    }
    for (int32_t i = 0; positions != NULL && i < sim->loads->follower_count; i++) {
        pel_follower_force(sim, i, span, positions, each);
        pel_vec3_copy(each, sim->loads->followers[i].pushed);
        for (int k = 0; k < 2; k++)
            force[sim->loads->followers[i].vertices[k]] += (pel_real)0.5 * record_of(each);
    }
    if (positions != NULL)
        pel_fluids_add(sim, positions, force);
    for (int32_t v = 0; sim->loads->external != NULL && v < sim->model->vertex_count; v++)
        force[v] += sim->loads->external[v];
    for (int32_t v = 0; sim->loads->dragged != NULL && v < sim->model->vertex_count; v++)
        force[v] += sim->loads->dragged[v];
    if (has_gravity(sim->model)) {
        pel_record gravity = (pel_real)sim->state->load_factor * record_of(sim->model->gravity);
        for (int32_t v = 0; v < sim->model->vertex_count; v++)
            force[v] += sim->model->mass[v] * gravity;
    }
}

/* ---- keyed loads in a step ---- */

static bool is_leapfrog(const pel_sim *sim)
{
    return pel_sim_is_explicit(sim) && sim->shells != NULL && sim->solver.symplectic;
}

pel_span pel_loads_kick_span(const pel_sim *sim, double time)
{
    double dt = sim->step.dt;
    if (is_leapfrog(sim))
        return (pel_span){.time = time, .back = time > 0 ? 0.5 * dt : 0, .ahead = 0.5 * dt};
    return (pel_span){.time = time, .ahead = dt};
}

/* change of a keyed factor from the time before a span to it, over its largest value */
static double change_of(const pel_key *keys, int32_t key_count, pel_span span, double from, double until)
{
    const pel_span before = {.time = span.time - span.back, .back = span.back};
    double largest = key_count > 0 ? 0 : 1;
    for (int32_t k = 0; k < key_count; k++)
        largest = pel_max(largest, fabs(keys[k].value));
    double change =
        pel_curve_mean(keys, key_count, span, from, until) - pel_curve_mean(keys, key_count, before, from, until);
    return largest > 0 ? fabs(change) / largest : 0;
}

bool pel_loads_jump(const pel_sim *sim, pel_span span)
{
    double most = 0;
    for (int32_t l = 0; l < sim->loads->count; l++) {
        const pel_load *load = &sim->loads->items[l];
        most = pel_max(most, change_of(load->keys, load->key_count, span, load->from, load->until));
    }
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_shell *shell = sim->model->bodies[b].shell;
        if (shell != NULL && shell->outside.key_count > 0)
            most = pel_max(most, change_of(shell->outside.keys, shell->outside.key_count, span, -HUGE_VAL, HUGE_VAL));
    }
    return most > JUMP_SHARE;
}

/* the sum of a load's weights times displacements from some positions to the new ones */
static void weigh_way(const pel_sim *sim, const pel_load *load, const pel_record *start, double way[3])
{
    pel_vec3_set(way, 0, 0, 0);
    for (int32_t i = 0; i < load->vertex_count; i++) {
        int32_t v = load->vertices[i];
        for (int c = 0; c < 3; c++)
            way[c] += load->weights[i] * ((double)sim->state->position_next[v][c] - (double)start[v][c]);
    }
}

/* the same of velocities */
static void weigh_velocity(const pel_load *load, const pel_record *velocity, double sum[3])
{
    pel_vec3_set(sum, 0, 0, 0);
    for (int32_t i = 0; i < load->vertex_count; i++)
        for (int c = 0; c < 3; c++)
            sum[c] += load->weights[i] * (double)velocity[load->vertices[i]][c];
}

/* J: work of the forces of the caller from some positions to others, null = all zero */
static double external_work(const pel_sim *sim, const pel_record *from, const pel_record *to)
{
    double work = 0;
    for (int32_t v = 0; sim->loads->external != NULL && v < sim->model->vertex_count; v++)
        for (int c = 0; c < 3; c++)
            work += (double)sim->loads->external[v][c] * ((double)to[v][c] - (from != NULL ? (double)from[v][c] : 0));
    return work;
}

/* whether a load changes between two times */
static bool changes(const pel_load *load, double from, double to)
{
    const pel_key *keys = load->keys;
    bool is_keyed = load->key_count > 1 && to > keys[0].time && from < keys[load->key_count - 1].time;
    return is_keyed || (load->from > from && load->from < to) || (load->until > from && load->until < to);
}

void pel_loads_begin_tally(pel_sim *sim, double h)
{
    double from = pel_sim_time(sim), to = from + sim->step.dt;
    sim->loads->tallied_work = sim->loads->pressure_work = 0;
    sim->loads->external_work = h * external_work(sim, NULL, sim->state->velocity);
    for (int32_t l = 0; l < sim->loads->count; l++) {
        pel_load *load = &sim->loads->items[l];
        load->is_tallied = sim->solver.second_order || changes(load, from, to);
        if (!load->is_tallied)
            continue;
        weigh_velocity(load, sim->state->velocity, load->way);
        pel_vec3_scale(load->way, h, load->way);
    }
}

/* N m, of the pressures of the substep on ways: from some positions to others, or of velocities over a time */
static double work_on(const pel_sim *sim, const pel_record *from, const pel_record *to, const pel_record *velocity,
                      double h)
{
    double work = 0;
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        for (int c = 0; c < 3; c++)
            work += (double)sim->loads->pressed[v][c] *
                    (from != NULL ? (double)to[v][c] - (double)from[v][c] : h * (double)velocity[v][c]);
    return work;
}

/* N m, the same of follower loads, whose forces the substep has kept */
static double followers_work_on(const pel_sim *sim, const pel_record *from, const pel_record *to,
                                const pel_record *velocity, double h)
{
    double work = 0;
    for (int32_t i = 0; i < sim->loads->follower_count; i++)
        for (int k = 0; k < 2; k++) {
            const pel_follower *at = &sim->loads->followers[i];
            const int32_t v = at->vertices[k];
            for (int c = 0; c < 3; c++)
                work += 0.5 * at->pushed[c] *
                        (from != NULL ? (double)to[v][c] - (double)from[v][c] : h * (double)velocity[v][c]);
        }
    return work;
}

void pel_loads_press(pel_sim *sim, const pel_record *positions, const pel_record *before, const pel_record *velocity,
                     pel_span span)
{
    pel_record *pressed = sim->loads->pressed;
    const size_t count = (size_t)sim->model->vertex_count;
    sim->loads->tallied_work += 0.5 * followers_work_on(sim, before, positions, velocity, span.ahead);
    if (pressed != NULL)
        memcpy(pressed, sim->force, count * sizeof *pressed);
    pel_shell_forces_press(sim->shells, positions, span, sim->pool, sim->force);
    if (pressed == NULL)
        return;
    for (size_t v = 0; v < count; v++)
        pressed[v] = sim->force[v] - pressed[v];
    sim->loads->pressure_work += 0.5 * work_on(sim, before, positions, velocity, span.ahead);
}

/* The mean of the velocities at both ends moves a load; in first order each of them is that of the way before it. */
void pel_loads_tally(pel_sim *sim, pel_span span, const pel_record *start)
{
    bool second_order = sim->solver.second_order;
    const pel_state *state = sim->state;
    double h = span.back, external = second_order ? h * external_work(sim, NULL, state->velocity_next)
                                                  : external_work(sim, start, state->position_next);
    sim->loads->tallied_work += 0.5 * (external + sim->loads->external_work);
    sim->loads->external_work = external;
    sim->loads->tallied_work +=
        0.5 * followers_work_on(sim, second_order ? NULL : start, state->position_next, state->velocity_next, h);
    if (sim->loads->pressed != NULL)
        sim->loads->pressure_work +=
            0.5 * work_on(sim, second_order ? NULL : start, state->position_next, state->velocity_next, h);
    span.extrapolates = false;
    for (int32_t l = 0; l < sim->loads->count; l++) {
        pel_load *load = &sim->loads->items[l];
        double way[3], mean[3];
        if (!load->is_tallied)
            continue;
        if (second_order) {
            weigh_velocity(load, state->velocity_next, way);
            pel_vec3_scale(way, h, way);
        } else {
            weigh_way(sim, load, start, way);
        }
        for (int c = 0; c < 3; c++)
            mean[c] = 0.5 * (way[c] + load->way[c]);
        pel_vec3_copy(way, load->way);
        sim->loads->tallied_work += pel_load_factor(sim, load, span) * pel_vec3_dot(load->force, mean);
    }
}

/* Statics pass through the loads in between; kicks of velocities in the middle of steps do half of their work before
   and half after them. */
void pel_loads_find_spans(const pel_sim *sim, double from, double to, pel_span spans[2])
{
    const double times[2] = {from, to};
    for (int i = 0; i < 2; i++) {
        spans[i] = (pel_span){.time = times[i], .back = times[i] - from, .ahead = to - times[i]};
        if (!pel_sim_has_velocity(sim))
            spans[i] = pel_instant(times[i]);
        else if (pel_sim_is_explicit(sim))
            spans[i] = pel_loads_kick_span(sim, times[i]);
    }
}

bool pel_loads_begin_at_once(const pel_sim *sim)
{
    return sim->state->step == 0 && !pel_sim_has_velocity(sim) && !sim->stepper->relaxes;
}

/* mean of the forces at both ends of the step times the displacement of the edges */
static double followers_work(const pel_sim *sim, const pel_span spans[2])
{
    const bool begins = pel_loads_begin_at_once(sim);
    double work = 0;
    for (int32_t i = 0; i < sim->loads->follower_count; i++) {
        double before[3], after[3], a[3], b[3];
        pel_follower_force(sim, i, spans[0], sim->state->position, before);
        if (begins && pel_vec3_length(before) > 0)
            pel_follower_force(sim, i, spans[1], sim->state->position, before);
        pel_follower_force(sim, i, spans[1], sim->state->position_next, after);
        pel_vec3_add(before, after, before);
        for (int k = 0; k < 2; k++) {
            int32_t v = sim->loads->followers[i].vertices[k];
            pel_vertex_position(sim->state->position, v, a);
            pel_vertex_position(sim->state->position_next, v, b);
            pel_vec3_subtract(b, a, a);
            work += 0.25 * pel_vec3_dot(before, a);
        }
    }
    return work;
}

/* mean factor of a load in a step; statics follow the factor of the path */
static double mean_factor(const pel_sim *sim, const pel_load *load, const pel_span spans[2])
{
    double factors[2] = {sim->state->load_factor_before, sim->state->load_factor};
    for (int i = 0; i < 2; i++)
        factors[i] *= pel_curve_mean(load->keys, load->key_count, spans[i], load->from, load->until);
    if (factors[0] != 0 && pel_loads_begin_at_once(sim))
        factors[0] = factors[1];
    return 0.5 * factors[0] + 0.5 * factors[1];
}

double pel_loads_work(const pel_sim *sim, double from, double to, double h)
{
    const pel_state *state = sim->state;
    pel_span spans[2];
    pel_loads_find_spans(sim, from, to, spans);
    double work = pel_fluids_work(sim) + pel_wind_work(sim, h) + sim->loads->tallied_work;
    work += pel_sim_projects_elements(sim) ? 0 : followers_work(sim, spans);
    for (int32_t l = 0; l < sim->loads->count; l++) {
        const pel_load *load = &sim->loads->items[l];
        double factor = load->is_tallied ? 0 : mean_factor(sim, load, spans), way[3], before[3], after[3];
        if (factor == 0)
            continue;
        weigh_way(sim, load, state->position, way);
        if (h > 0) {
            weigh_velocity(load, state->velocity, before);
            weigh_velocity(load, state->velocity_next, after);
            for (int c = 0; c < 3; c++)
                way[c] -= 0.5 * h * (after[c] - before[c]);
        }
        work += factor * pel_vec3_dot(load->force, way);
    }
    /* substeps have summed it */
    return pel_sim_projects_elements(sim) ? work : work + external_work(sim, state->position, state->position_next);
}

/* ---- snapshots ---- */

void pel_load_transfer(pel_cursor *at, const pel_sim *sim, int32_t load)
{
    PEL_ASSERT_INDEX(load, sim->loads->count);
    pel_transfer(at, sim->loads->items[load].force, sizeof sim->loads->items[load].force);
}

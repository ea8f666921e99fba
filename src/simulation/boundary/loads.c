#include "boundary/loads.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "boundary/follower.h"
#include "math/vec3.h"
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
    for (int32_t k = 0; k < def->key_count; k++)
        if (!isfinite(def->keys[k].time) || !isfinite(def->keys[k].value) ||
            (k > 0 && !(def->keys[k].time > def->keys[k - 1].time)))
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "load", load, "give keys with increasing times",
                                      "keys are not finite or not in order");
    return PEL_OK;
}

/* ---- loads on boundary edges ---- */

/* m, half the length at rest of the boundary edges at each vertex of the mesh whose ends the load both has */
static pel_status find_lengths(const pel_mesh *mesh, const pel_load_def *def, double *lengths, pel_error *error)
{
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
        if (topology->twin[h] >= 0 || !marks[a] || !marks[b])
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
static pel_status weigh_by_length(const pel_mesh *mesh, const pel_load_def *def, int32_t index, pel_load *load,
                                  pel_error *error)
{
    double *lengths = pel_allocate((size_t)mesh->vertex_count, sizeof *lengths), sum = 0;
    pel_status status = lengths != NULL ? find_lengths(mesh, def, lengths, error) : pel_fail_memory(error);
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

static pel_status spread_load(pel_sim *sim, pel_load *load, const pel_load_def *def, double share, pel_error *error)
{
    const pel_body_levels *detail = sim->model->bodies[def->body].detail;
    int32_t mesh_count = sim->model->bodies[def->body].mesh->vertex_count;
    int32_t count = def->vertices != NULL ? def->vertex_count : mesh_count;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(load->base_weights, mesh_count),
                          PEL_ROOM(load->densities, detail->forest->levels[detail->forest->depth]->vertex_count),
                          PEL_ROOM(load->weight_of_place, place_count(sim, def->body))))
        return pel_fail_memory(error);
    for (int32_t i = 0; i < count; i++)
        load->base_weights[def->vertices != NULL ? def->vertices[i] : i] +=
            share * (def->weights != NULL ? def->weights[i] : 1);
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
    size_t room = body->detail != NULL ? place_count(sim, def->body) : (size_t)count;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(load->vertices, room), PEL_ROOM(load->weights, room),
                          PEL_ROOM(load->keys, def->key_count)))
        return pel_fail_memory(error);
    double share = def->kind == PEL_LOAD_TOTAL ? 1.0 / count : 1.0;
    if (def->key_count > 0)
        memcpy(load->keys, def->keys, (size_t)def->key_count * sizeof *load->keys);
    load->key_count = def->key_count;
    if (body->detail != NULL)
        return spread_load(sim, load, def, share, error);
    load->vertex_count = count;
    for (int32_t i = 0; i < count; i++) {
        load->vertices[i] = body->model_index[def->vertices != NULL ? def->vertices[i] : i];
        load->weights[i] = share * (def->weights != NULL ? def->weights[i] : 1);
    }
    return def->kind == PEL_LOAD_PER_LENGTH ? weigh_by_length(body->mesh, def, index, load, error) : PEL_OK;
}

pel_status pel_loads_create(pel_sim *sim, const pel_load_def *defs, int32_t count, pel_error *error)
{
    sim->loads->items = pel_allocate((size_t)count, sizeof *sim->loads->items);
    if (sim->loads->items == NULL)
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
    pel_free(sim->loads->items);
}

/* force of a load on a vertex of weight 1 at a time; false when it does not act */
static bool load_force(const pel_sim *sim, const pel_load *load, double time, double force[3])
{
    if (!(time >= load->from && time < load->until))
        return false;
    double factor = sim->state->load_factor * pel_curve_value(load->keys, load->key_count, time);
    for (int i = 0; i < 3; i++)
        force[i] = factor * load->force[i];
    return true;
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
    return sim->loads->count > 0 || sim->loads->follower_count > 0 || sim->loads->external != NULL ||
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

bool pel_loads_apply(pel_sim *sim, pel_gains gains)
{
    const real_gains gain = {(pel_real)gains.position, (pel_real)gains.velocity};
    double time = pel_sim_time(sim), force[3];
    bool inside = true;
    for (int32_t l = 0; l < sim->loads->count; l++) {
        const pel_load *load = &sim->loads->items[l];
        if (!load_force(sim, load, time, force))
            continue;
        pel_record full = record_of(force);
        for (int32_t i = 0; i < load->vertex_count; i++) {
            int32_t v = load->vertices[i];
            pel_real scale = (pel_real)load->weights[i] * sim->model->inverse_mass[v];
            inside &= push(sim, v, gain, scale * full);
        }
    }
    for (int32_t i = 0; i < sim->loads->follower_count; i++) {
        pel_follower_force(sim, i, time, sim->state->position, force);
        for (int k = 0; k < 2; k++) {
            int32_t v = sim->loads->followers[i].vertices[k];
            inside &= push(sim, v, gain, (pel_real)0.5 * sim->model->inverse_mass[v] * record_of(force));
        }
    }
    for (int32_t v = 0; sim->loads->external != NULL && v < sim->model->vertex_count; v++)
        inside &= push(sim, v, gain, sim->model->inverse_mass[v] * sim->loads->external[v]);
    for (int32_t b = 0; has_gravity(sim->model) && b < sim->model->body_count; b++)
        inside &= apply_gravity(sim, &sim->model->bodies[b], gain);
    return inside;
}

double pel_load_product(const pel_sim *sim, int32_t load, double time, const double *vectors)
{
    PEL_ASSERT_INDEX(load, sim->loads->count);
    const pel_load *at = &sim->loads->items[load];
    double force[3], sum = 0;
    if (!load_force(sim, at, time, force))
        return 0;
    for (int32_t i = 0; i < at->vertex_count; i++)
        sum += at->weights[i] * pel_vec3_dot(force, vectors + 3 * (size_t)at->vertices[i]);
    return sum;
}

void pel_loads_add(const pel_sim *sim, double time, const pel_record *positions, pel_record *force)
{
    double each[3];
    for (int32_t l = 0; l < sim->loads->count; l++) {
        const pel_load *load = &sim->loads->items[l];
        if (!load_force(sim, load, time, each))
            continue;
        pel_record full = record_of(each);
        for (int32_t i = 0; i < load->vertex_count; i++)
            force[load->vertices[i]] += (pel_real)load->weights[i] * full;
    }
    for (int32_t i = 0; positions != NULL && i < sim->loads->follower_count; i++) {
        pel_follower_force(sim, i, time, positions, each);
        for (int k = 0; k < 2; k++)
            force[sim->loads->followers[i].vertices[k]] += (pel_real)0.5 * record_of(each);
    }
    for (int32_t v = 0; sim->loads->external != NULL && v < sim->model->vertex_count; v++)
        force[v] += sim->loads->external[v];
    if (has_gravity(sim->model)) {
        pel_record gravity = (pel_real)sim->state->load_factor * record_of(sim->model->gravity);
        for (int32_t v = 0; v < sim->model->vertex_count; v++)
            force[v] += sim->model->mass[v] * gravity;
    }
}

/* Mean factor of a load over a step. The leapfrog kicks at both ends; the other methods look at one instant whether the
   load acts at all. */
static double mean_factor(const pel_sim *sim, const pel_load *load, double from, double to)
{
    bool at_from = from >= load->from && from < load->until, at_to = to >= load->from && to < load->until;
    if (!pel_sim_is_explicit(sim))
        at_from = at_to = sim->stepper->is_at_end ? at_to : at_from;
    double before = sim->state->load_factor_before, now = sim->state->load_factor;
    return 0.5 * ((at_from ? before * pel_curve_value(load->keys, load->key_count, from) : 0) +
                  (at_to ? now * pel_curve_value(load->keys, load->key_count, to) : 0));
}

/* mean of the forces at both ends of the step times the displacement of the edges */
static double followers_work(const pel_sim *sim, double from, double to)
{
    double work = 0;
    for (int32_t i = 0; i < sim->loads->follower_count; i++) {
        double before[3], after[3], a[3], b[3];
        pel_follower_force(sim, i, from, sim->state->position, before);
        pel_follower_force(sim, i, to, sim->state->position_next, after);
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

double pel_loads_work(const pel_sim *sim, double from, double to)
{
    const pel_state *state = sim->state;
    double work = followers_work(sim, from, to);
    for (int32_t l = 0; l < sim->loads->count; l++) {
        const pel_load *load = &sim->loads->items[l];
        double factor = mean_factor(sim, load, from, to), shift[3] = {0};
        for (int32_t i = 0; factor != 0 && i < load->vertex_count; i++) {
            int32_t v = load->vertices[i];
            for (int c = 0; c < 3; c++)
                shift[c] += load->weights[i] * ((double)state->position_next[v][c] - (double)state->position[v][c]);
        }
        work += factor * pel_vec3_dot(load->force, shift);
    }
    for (int32_t v = 0; sim->loads->external != NULL && v < sim->model->vertex_count; v++)
        for (int c = 0; c < 3; c++)
            work += (double)sim->loads->external[v][c] *
                    ((double)state->position_next[v][c] - (double)state->position[v][c]);
    return work;
}

/* ---- snapshots ---- */

void pel_load_transfer(pel_cursor *at, const pel_sim *sim, int32_t load)
{
    PEL_ASSERT_INDEX(load, sim->loads->count);
    pel_transfer(at, sim->loads->items[load].force, sizeof sim->loads->items[load].force);
}

/* Rigid tools: they move on their keys, hold what they grasped, and push the surface out of the way.

   The force on the tool is what the surface does to it. Quasi-static method: the force F_i of eq. A-2
   on each touched vertex, as far as it presses against the tool (held vertices: all of it); at rest this balances the
   push exactly, and friction carries what is across it, as far as it can. Explicit method: the momentum taken from the
   vertices over dt. Minimisation: the sum of the loads of its contacts (descent.h), and all of F_i where it holds. */
#include "base/memory.h"
#include "base/status.h"
#include "bvh/mesh_query.h"
#include "sim/contact.h"
#include "sim/descent.h"
#include "sim/tool.h"

#include <stdio.h>
#include <string.h>

/* rounds over the tools at most */
enum { ROUND_LIMIT = 4 };
/* turns of a key at most: angles of more lose their digits */
enum { MOST_TURNS = 1000000 };
/* of a tool's size */
#define CAUGHT_UP 1e-6
static const double FULL_TURN = 6.283185307179586476925;

pel_tool_def pel_tool_def_default(void)
{
    return (pel_tool_def){
        .shape = PEL_TOOL_SPHERE, .body = -1, .press = true, .friction = -1, .grasp_until = (double)INFINITY};
}

/* ---- creation ---- */

static pel_status refuse(pel_error *error, int32_t tool, const char *what, const char *remedy)
{
    pel_fail(error, PEL_BAD_ARGUMENT, "%s", what);
    pel_fail_element(error, "tool", tool);
    pel_fail_remedy(error, "%s", remedy);
    return PEL_BAD_ARGUMENT;
}

static bool is_positive(double value)
{
    return value > 0 && isfinite(value);
}

static bool is_key(const pel_pose_key *key)
{
    const double *position = key->position, *q = key->rotation;
    double square = pel_vec3_dot(q, q) + q[3] * q[3];
    return isfinite(key->time) && isfinite(position[0]) && isfinite(position[1]) && isfinite(position[2]) &&
           fabs(square - 1) < 1e-6 && pel_vec3_length(key->rotation_vector) <= MOST_TURNS * FULL_TURN;
}

static pel_status check_shape(const pel_tool_def *def, int32_t tool, pel_error *error)
{
    const double *half = def->half_extents;
    if (def->shape == PEL_TOOL_MESH) {
        if (def->mesh == NULL)
            return refuse(error, tool, "tool of shape mesh has no mesh", "give a mesh");
    } else if (def->shape == PEL_TOOL_BOX) {
        if (!is_positive(half[0]) || !is_positive(half[1]) || !is_positive(half[2]))
            return refuse(error, tool, "box has no size", "give three half extents above 0");
    } else if (!is_positive(def->radius)) {
        return refuse(error, tool, "radius is not above 0", "give a radius above 0");
    }
    if (def->shape == PEL_TOOL_CAPSULE && !(def->half_length >= 0 && isfinite(def->half_length)))
        return refuse(error, tool, "capsule length is below 0", "give a half length of at least 0");
    return PEL_OK;
}

static pel_status check_support(const pel_sim *sim, const pel_tool_def *def, int32_t tool, pel_error *error)
{
    if (def->body < 0 || def->vertices == NULL || def->vertex_count < 1)
        return refuse(error, tool, "support has no body or no vertices", "give a body and vertices of its mesh");
    if (sim->given->bodies[def->body].detail != NULL)
        return refuse(error, tool, "keyed support of a body that refines",
                      "switch refine off for this body, or hold it by a tool with grasp");
    if (!isfinite(def->center[0]) || !isfinite(def->center[1]) || !isfinite(def->center[2]))
        return refuse(error, tool, "center of the support is not finite", "give a point in metres");
    for (int32_t i = 0; i < def->vertex_count; i++) {
        int32_t v = def->vertices[i];
        if (v < 0 || v >= sim->given->bodies[def->body].mesh->vertex_count)
            return refuse(error, tool, "support names a vertex that does not exist", "give vertices of the mesh");
        if (!(sim->model->inverse_mass[sim->model->bodies[def->body].slot_of_vertex[v]] > 0))
            return refuse(error, tool, "support holds a vertex that is pinned", "pin it or let the support hold it");
    }
    return PEL_OK;
}

static pel_status check_tool(const pel_sim *sim, const pel_tool_def *defs, int32_t tool, pel_error *error)
{
    const pel_tool_def *def = &defs[tool];
    if (def->name == NULL || def->name[0] == '\0' || strlen(def->name) >= PEL_NAME_SIZE)
        return refuse(error, tool, "tool has no name or a very long one", "give a short name");
    for (int32_t other = 0; other < tool; other++)
        if (strcmp(defs[other].name, def->name) == 0)
            return refuse(error, tool, "two tools have the same name", "give each tool a name of its own");
    if (def->body < -1 || def->body >= sim->model->body_count)
        return refuse(error, tool, "tool names a body that does not exist", "give a body of the model, or -1 for all");
    if (def->key_count < 1 || def->keys == NULL)
        return refuse(error, tool, "tool has no pose", "give at least one key");
    for (int32_t k = 0; k < def->key_count; k++) {
        const pel_pose_key *key = &def->keys[k];
        if (!is_key(key))
            return refuse(error, tool, "a key is not finite, turns too often, or its rotation is no unit quaternion",
                          "give finite positions, unit quaternions x, y, z, w and at most 1e6 turns");
        if (k > 0 && !(key->time > key[-1].time))
            return refuse(error, tool, "keys are not in order", "give keys with increasing times");
    }
    if (!isfinite(def->friction))
        return refuse(error, tool, "the friction of a tool is not finite", "give a coefficient of at least 0");
    if (def->grasp && (!(def->grasp_until > def->grasp_from) || !(def->reach >= 0 && isfinite(def->reach))))
        return refuse(error, tool, "grasp ends before it begins, or its reach is below 0",
                      "give grasp_from < grasp_until and a reach of at least 0");
    if (def->grasp && !(def->grasp_max_force >= 0))
        return refuse(error, tool, "the largest force of a grasp is below 0 or not a number",
                      "give grasp_max_force > 0 in newtons, or 0 for no limit");
    return def->shape == PEL_TOOL_SUPPORT ? check_support(sim, def, tool, error) : check_shape(def, tool, error);
}

/* copies the mesh; the solid becomes the sphere about it */
static pel_status create_mesh(pel_tool *tool, const pel_mesh *mesh, pel_error *error)
{
    double radius = 0;
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        radius = fmax(radius, pel_vec3_length(mesh->positions[v]));
    tool->solid = (pel_solid){.kind = PEL_SOLID_SPHERE, .radius = radius};
    return pel_mesh_create((const double *)mesh->positions, mesh->vertex_count, (const int32_t *)mesh->triangles,
                           mesh->triangle_count, &tool->mesh, error);
}

static void sum_spins(pel_tool *tool);

/* A keyed support grasps its vertices for ever. It starts at rest; where its first key is elsewhere it goes there in
   the first step. Its size, for rotations, is that of the body. */
static pel_status create_support(const pel_sim *sim, const pel_tool_def *def, pel_tool *tool, pel_error *error)
{
    const pel_body *body = &sim->model->bodies[def->body];
    tool->support = pel_allocate((size_t)def->vertex_count, sizeof *tool->support);
    if (tool->support == NULL)
        return pel_fail_memory(error);
    for (int32_t i = 0; i < def->vertex_count; i++)
        tool->support[i] = body->slot_of_vertex[def->vertices[i]];
    tool->support_count = def->vertex_count;
    tool->grasp = true;
    tool->grasp_from = 0;
    tool->grasp_until = (double)INFINITY;
    tool->press = false;
    tool->solid.radius = tool->press_solid.radius = body->diameter;
    pel_vec3_copy(def->center, tool->center);
    return PEL_OK;
}

static pel_status create_tool(pel_sim *sim, const pel_tool_def *def, pel_tool *tool, pel_error *error)
{
    size_t vertex_count = (size_t)sim->model->vertex_count;
    snprintf(tool->name, sizeof tool->name, "%s", def->name);
    static const pel_solid_kind kinds[] = {[PEL_TOOL_SPHERE] = PEL_SOLID_SPHERE,
                                           [PEL_TOOL_CAPSULE] = PEL_SOLID_CAPSULE,
                                           [PEL_TOOL_BOX] = PEL_SOLID_BOX,
                                           [PEL_TOOL_MESH] = PEL_SOLID_SPHERE,
                                           [PEL_TOOL_SUPPORT] = PEL_SOLID_SPHERE};
    tool->solid = (pel_solid){.kind = kinds[def->shape], .radius = def->radius, .half_length = def->half_length};
    memcpy(tool->solid.half_extents, def->half_extents, sizeof tool->solid.half_extents);
    tool->press_solid = tool->solid;
    if (def->shape == PEL_TOOL_MESH) {
        pel_status status = create_mesh(tool, def->mesh, error);
        if (status == PEL_OK && def->grasp)
            status = pel_mesh_query_create(def->mesh, &tool->query, error);
        if (status != PEL_OK)
            return status;
    }
    tool->body = def->body;
    tool->press = def->press;
    tool->grasp = def->grasp;
    tool->grasp_from = def->grasp_from;
    tool->grasp_until = def->grasp_until;
    tool->reach = def->reach;
    tool->friction = def->friction;
    tool->grasp_max_force = isfinite(def->grasp_max_force) ? def->grasp_max_force : 0;
    tool->keys = pel_allocate((size_t)def->key_count, sizeof *tool->keys);
    tool->key_spins = pel_allocate((size_t)def->key_count, sizeof *tool->key_spins);
    tool->planes = pel_allocate(PEL_PLANE_LIMIT, sizeof *tool->planes);
    tool->planes_before = pel_allocate(PEL_PLANE_LIMIT, sizeof *tool->planes_before);
    tool->touches = pel_allocate(vertex_count, sizeof *tool->touches);
    tool->touch_of_vertex = pel_allocate(vertex_count, sizeof *tool->touch_of_vertex);
    if (def->shape == PEL_TOOL_SUPPORT) {
        pel_status status = create_support(sim, def, tool, error);
        if (status != PEL_OK)
            return status;
    }
    if (tool->grasp) {
        tool->held = pel_allocate(vertex_count, sizeof *tool->held);
        tool->anchors = pel_allocate(vertex_count, sizeof *tool->anchors);
    }
    if (tool->keys == NULL || tool->key_spins == NULL || tool->planes == NULL || tool->planes_before == NULL ||
        tool->touches == NULL || tool->touch_of_vertex == NULL ||
        (tool->grasp && (tool->held == NULL || tool->anchors == NULL)))
        return pel_fail_memory(error);
    memcpy(tool->keys, def->keys, (size_t)def->key_count * sizeof *tool->keys);
    tool->key_count = def->key_count;
    sum_spins(tool);
    tool->pose = pel_tool_pose_at(tool, 0);
    if (tool->support != NULL) {
        tool->pose = (pel_pose){.rotation = {0, 0, 0, 1}};
        pel_vec3_copy(tool->center, tool->pose.position);
    }
    tool->pose_before = tool->pose;
    return PEL_OK;
}

static pel_status check_outside(const pel_sim *sim, int32_t tool, pel_error *error);

/* room for what tools hold */
static pel_status create_grips(pel_sim *sim, pel_error *error)
{
    size_t count = (size_t)sim->model->vertex_count;
    sim->held_vertices = pel_allocate(count, sizeof *sim->held_vertices);
    sim->held_targets = pel_allocate(count, sizeof *sim->held_targets);
    sim->grip_forces = pel_allocate(count, sizeof *sim->grip_forces);
    if (sim->held_vertices == NULL || sim->held_targets == NULL || sim->grip_forces == NULL)
        return pel_fail_memory(error);
    return sim->projector != NULL ? pel_projector_record_reactions(sim->projector, error) : PEL_OK;
}

pel_status pel_tools_create(pel_sim *sim, const pel_tool_def *defs, int32_t count, pel_error *error)
{
    sim->tools = pel_allocate((size_t)count, sizeof *sim->tools);
    if (sim->tools == NULL)
        return pel_fail_memory(error);
    sim->tool_count = count;
    if (count == 0)
        return PEL_OK;
    sim->near_triangles = pel_allocate((size_t)sim->model->triangle_count, sizeof *sim->near_triangles);
    sim->plane_of_triangle = pel_allocate((size_t)sim->model->triangle_count, sizeof *sim->plane_of_triangle);
    sim->held = pel_allocate((size_t)sim->model->vertex_count, sizeof *sim->held);
    sim->looked_at = pel_allocate((size_t)sim->model->triangle_count, sizeof *sim->looked_at);
    sim->moved_at = pel_allocate((size_t)sim->model->vertex_count, sizeof *sim->moved_at);
    sim->cornered_at = pel_allocate((size_t)sim->model->vertex_count, sizeof *sim->cornered_at);
    if (sim->near_triangles == NULL || sim->plane_of_triangle == NULL || sim->held == NULL || sim->looked_at == NULL ||
        sim->moved_at == NULL || sim->cornered_at == NULL)
        return pel_fail_memory(error);
    pel_status status = pel_tool_search_create(sim->model, &sim->tool_search, error);
    bool grasps = false;
    for (int32_t i = 0; i < count; i++)
        grasps |= defs[i].grasp || defs[i].shape == PEL_TOOL_SUPPORT;
    if (status == PEL_OK && grasps)
        status = create_grips(sim, error);
    for (int32_t i = 0; status == PEL_OK && i < count; i++) {
        status = check_tool(sim, defs, i, error);
        if (status == PEL_OK)
            status = create_tool(sim, &defs[i], &sim->tools[i], error);
        if (status == PEL_OK && sim->tools[i].press && defs[i].shape != PEL_TOOL_MESH)
            status = check_outside(sim, i, error);
    }
    return status;
}

void pel_tools_destroy(pel_sim *sim)
{
    for (int32_t i = 0; i < sim->tool_count; i++) {
        pel_tool *tool = &sim->tools[i];
        void *arrays[] = {tool->keys,          tool->key_spins, tool->planes,
                          tool->planes_before, tool->touches,   tool->touch_of_vertex,
                          tool->held,          tool->anchors,   tool->support};
        for (size_t a = 0; a < sizeof arrays / sizeof *arrays; a++)
            pel_free(arrays[a]);
        pel_mesh_destroy(tool->mesh);
        pel_mesh_query_destroy(tool->query);
    }
    pel_free(sim->tools);
    pel_tool_search_destroy(sim->tool_search);
    pel_free(sim->near_triangles);
    pel_free(sim->plane_of_triangle);
    pel_free(sim->held);
    pel_free(sim->looked_at);
    pel_free(sim->moved_at);
    pel_free(sim->cornered_at);
    pel_free(sim->held_vertices);
    pel_free(sim->held_targets);
    pel_free(sim->grip_forces);
}

/* ---- frames ---- */

/* whole turns of a key, and the quaternion of all that is left of it */
static void split_turns(const pel_pose_key *key, double whole[3], double left[3], double rotation[4])
{
    double turns = trunc(pel_vec3_length(key->rotation_vector) / FULL_TURN);
    pel_vec3_set(whole, 0, 0, 0);
    pel_vec3_copy(key->rotation_vector, left);
    if (turns > 0) {
        pel_vec3_scale(left, turns * FULL_TURN / pel_vec3_length(left), whole);
        pel_vec3_subtract(left, whole, left);
    }
    pel_rotation_turn(key->rotation, left, 1, rotation);
}

/* The pose between two keys at s in 0 .. 1, with the rotation from the first key as its spin. With the whole turns A, B
   of the keys and the quaternions a, b of all else it is exp(s B) exp((1 - s) A) exp(s d) a, where d leads from a to b:
   of all such d the one nearest to the difference of the rotation vectors and the shorter arc of the quaternions. */
static pel_pose pose_between_keys(const pel_pose_key *a, const pel_pose_key *b, double s)
{
    static const double none[3] = {0};
    double whole[2][3], left[2][3], rotation[2][4], remains[3], expected[3];
    split_turns(a, whole[0], left[0], rotation[0]);
    split_turns(b, whole[1], left[1], rotation[1]);
    pel_rotation_between(a->rotation, b->rotation, none, expected);
    for (int i = 0; i < 3; i++)
        expected[i] += left[1][i] - left[0][i];
    pel_rotation_between(rotation[0], rotation[1], expected, remains);
    pel_pose pose;
    for (int i = 0; i < 3; i++) {
        pose.position[i] = a->position[i] + s * (b->position[i] - a->position[i]);
        pose.spin[i] = s * (whole[1][i] - whole[0][i] + remains[i]);
    }
    pel_rotation_turn(rotation[0], remains, s, pose.rotation);
    pel_rotation_turn(pose.rotation, whole[0], 1 - s, pose.rotation);
    pel_rotation_turn(pose.rotation, whole[1], s, pose.rotation);
    return pose;
}

/* the number of the key at or before a time, the first before all */
static int32_t find_key(const pel_pose_key *keys, int32_t count, double time)
{
    int32_t k = 0;
    while (k + 1 < count && keys[k + 1].time <= time)
        k++;
    return k;
}

static pel_pose pose_of_keys(const pel_pose_key *keys, int32_t count, double time)
{
    int32_t k = find_key(keys, count, time);
    const pel_pose_key *a = &keys[k], *b = k + 1 < count ? a + 1 : a;
    return pose_between_keys(a, b, time > a->time && b > a ? (time - a->time) / (b->time - a->time) : 0);
}

static void sum_spins(pel_tool *tool)
{
    pel_vec3_set(tool->key_spins[0], 0, 0, 0);
    for (int32_t k = 1; k < tool->key_count; k++) {
        pel_pose pose = pose_between_keys(&tool->keys[k - 1], &tool->keys[k], 1);
        pel_vec3_add(tool->key_spins[k - 1], pose.spin, tool->key_spins[k]);
    }
}

void pel_tool_def_pose(const pel_tool_def *def, double time, double position[3], double rotation[4])
{
    pel_pose pose = pose_of_keys(def->keys, def->key_count, time);
    memcpy(position, pose.position, sizeof pose.position);
    memcpy(rotation, pose.rotation, sizeof pose.rotation);
}

pel_pose pel_tool_pose_at(const pel_tool *tool, double time)
{
    if (tool->driven)
        return tool->driven_pose;
    pel_pose pose = pose_of_keys(tool->keys, tool->key_count, time);
    pel_vec3_add(pose.spin, tool->key_spins[find_key(tool->keys, tool->key_count, time)], pose.spin);
    return pose;
}

void pel_tool_turn(const pel_pose *a, const pel_pose *b, double turn[3])
{
    double spin[3];
    pel_vec3_subtract(b->spin, a->spin, spin);
    pel_rotation_between(a->rotation, b->rotation, spin, turn);
}

void pel_tool_pose_between(const pel_pose *a, const pel_pose *b, double share, pel_pose *pose)
{
    if (share >= 1 || share <= 0) {
        *pose = share >= 1 ? *b : *a;
        return;
    }
    double turn[3];
    pel_tool_turn(a, b, turn);
    pel_rotation_turn(a->rotation, turn, share, pose->rotation);
    for (int i = 0; i < 3; i++) {
        pose->spin[i] = a->spin[i] + share * turn[i];
        pose->position[i] = a->position[i] + share * (b->position[i] - a->position[i]);
    }
}

/* ---- grasping ---- */

/* inside the tool, or within its reach */
static bool reaches(const pel_tool *tool, const double local[3])
{
    double normal[3];
    return tool->query != NULL ? pel_mesh_query_reaches(tool->query, local, tool->reach)
                               : pel_solid_distance(&tool->solid, local, normal) <= tool->reach;
}

static void grasp_body(pel_sim *sim, pel_tool *tool, int32_t body)
{
    const pel_body *b = &sim->model->bodies[body];
    for (int32_t v = b->slice_begin * PEL_WIDTH; v < b->slice_end * PEL_WIDTH; v++) {
        double x[3], local[3];
        if (pel_tool_mobility(sim, v) <= 0)
            continue;
        pel_vertex_position(sim->state->position, v, x);
        pel_pose_to_local(&tool->pose_before, x, local);
        if (!reaches(tool, local))
            continue;
        sim->held[v] = 1;
        sim->state->position[v][3] = 0;
        pel_vec3_copy(local, tool->anchors[tool->held_count]);
        tool->held[tool->held_count++] = v;
    }
}

/* anchors of a support are places at rest */
static void hold_support(pel_sim *sim, pel_tool *tool)
{
    for (int32_t i = 0; i < tool->support_count; i++) {
        int32_t v = tool->support[i];
        double rest[3];
        if (sim->held[v])
            continue;
        sim->held[v] = 1;
        sim->state->position[v][3] = 0;
        pel_vertex_position(sim->model->rest, v, rest);
        pel_vec3_subtract(rest, tool->center, tool->anchors[tool->held_count]);
        tool->held[tool->held_count++] = v;
    }
}

static void release(pel_sim *sim, pel_tool *tool)
{
    for (int32_t i = 0; i < tool->held_count; i++) {
        int32_t v = tool->held[i];
        sim->held[v] = 0;
        sim->state->position[v][3] = sim->model->inverse_mass[v];
    }
    tool->held_count = 0;
}

/* true when other vertices are held than before */
static bool update_grasp(pel_sim *sim, pel_tool *tool, double time)
{
    bool changed = false;
    if (!tool->grasp)
        return false;
    if (tool->phase == PEL_GRASP_WAITING && time >= tool->grasp_from) {
        tool->phase = PEL_GRASP_HOLDING;
        for (int32_t b = 0; tool->support == NULL && b < sim->model->body_count; b++)
            if (pel_tool_acts_on(tool, b))
                grasp_body(sim, tool, b);
        if (tool->support != NULL)
            hold_support(sim, tool);
        changed = true;
    }
    if (tool->phase == PEL_GRASP_HOLDING && time >= tool->grasp_until) {
        tool->phase = PEL_GRASP_DONE;
        release(sim, tool);
        changed = true;
    }
    return changed;
}

/* who holds what, for the methods that ask in every substep */
static void list_held(pel_sim *sim)
{
    int32_t count = 0;
    for (int32_t i = 0; i < sim->tool_count; i++)
        for (int32_t k = 0; k < sim->tools[i].held_count; k++)
            sim->held_vertices[count++] = sim->tools[i].held[k];
    sim->boundary =
        (pel_boundary){count > 0 ? sim->held : NULL, sim->held_vertices, (const double(*)[3])sim->held_targets, count};
    if (sim->projector != NULL)
        pel_projector_hold(sim->projector, sim->boundary.is_held);
}

/* force of a held vertex at a point on its tool */
static void add_grip(pel_sim *sim, pel_tool *tool, int32_t v, const double point[3], const double force[3])
{
    pel_vec3_add(sim->grip_forces[v], force, sim->grip_forces[v]);
    pel_tool_add_reaction(tool, point, force);
}

/* held vertices go where the tool takes them */
static void carry(pel_sim *sim, pel_tool *tool)
{
    pel_state *state = sim->state;
    for (int32_t i = 0; i < tool->held_count; i++) {
        int32_t v = tool->held[i];
        double target[3], velocity[3], change[3];
        pel_pose_to_world(&tool->pose, tool->anchors[i], target);
        for (int c = 0; c < 3; c++)
            state->position_next[v][c] = (pel_real)target[c];
        pel_tool_touch(tool, v);
        if (state->velocity_next == NULL)
            continue;
        pel_tool_velocity(tool, target, sim->step.dt, velocity);
        for (int c = 0; c < 3; c++) {
            change[c] = velocity[c] - (double)state->velocity_next[v][c];
            state->velocity_next[v][c] = (pel_real)velocity[c];
        }
        pel_vec3_scale(change, -(double)sim->model->mass[v] / sim->step.dt, change);
        add_grip(sim, tool, v, target, change);
    }
}

/* ---- forces of the methods without velocities ---- */

/* forces of loads and shells at the new positions on the touched vertices, into sim->force */
static void find_load_and_shell_forces(pel_sim *sim, double time)
{
    for (int32_t i = 0; i < sim->tool_count; i++)
        for (int32_t k = 0; k < sim->tools[i].touch_count; k++)
            sim->force[sim->tools[i].touches[k].vertex] = (pel_record){0};
    pel_loads_add(sim, time, sim->force);
    pel_shell_forces_add(sim->shells, sim->state->position_next, time, PEL_SHELL_ALL, sim->pool, sim->force);
}

/* force on a touched vertex at the new positions */
static void static_force(const pel_sim *sim, int32_t v, double force[3])
{
    const pel_state *state = sim->state;
    pel_record elastic = pel_elastic_force_at(sim->model, state, state->position_next, v);
    for (int i = 0; i < 3; i++)
        force[i] = (double)(elastic[i] + sim->force[v][i]);
}

/* what of a force presses against the tool, which cannot pull, and what of the rest friction holds */
static void hold_against(const pel_sim *sim, const pel_tool *tool, int32_t v, const double push[3], double force[3])
{
    double square = pel_vec3_squared_length(push), pressing[3], across[3];
    double along = square > 0 ? fmin(pel_vec3_dot(force, push) / square, 0) : 0;
    double friction = pel_sim_friction(sim, tool, v);
    pel_vec3_scale(push, along, pressing);
    pel_vec3_subtract(force, pressing, across);
    double limit = friction * pel_vec3_length(pressing), length = pel_vec3_length(across);
    pel_vec3_along(pressing, length > limit ? limit / length : 1, across, force);
}

static void read_forces(pel_sim *sim, pel_tool *tool)
{
    for (int32_t i = 0; i < tool->touch_count; i++) {
        const pel_touch *touch = &tool->touches[i];
        double force[3], x[3];
        /* of the rest the minimisation knows the loads, but of meshes that only a correction after it keeps out */
        if (sim->descent != NULL && !sim->held[touch->vertex] && (tool->mesh == NULL || pel_descent_sees_contacts(sim)))
            continue;
        static_force(sim, touch->vertex, force);
        pel_vertex_position(sim->state->position_next, touch->vertex, x);
        if (sim->held[touch->vertex]) {
            add_grip(sim, tool, touch->vertex, x, force);
        } else {
            hold_against(sim, tool, touch->vertex, touch->push, force);
            pel_tool_add_reaction(tool, x, force);
        }
    }
}

/* adds drag and damping of a held vertex, by its mean velocity in the step */
static void add_damping(const pel_sim *sim, int32_t v, const double *factors, double force[3])
{
    const pel_model *model = sim->model;
    const pel_record next = sim->state->position_next[v], before = sim->state->position[v];
    double drag = factors[PEL_SPRING_DAMPING] * (double)model->damping[v] + sim->solver.drag * (double)model->mass[v];
    double radial = factors[PEL_VOLUMETRIC_DAMPING] * (double)model->volumetric_damping[v], velocity[3], offset[3];
    for (int k = 0; k < 3; k++) {
        velocity[k] = (double)(next[k] - before[k]) / sim->step.dt;
        offset[k] = (double)(next[k] - model->rest[v][k]);
    }
    double square = pel_vec3_squared_length(offset);
    double along = square > 0 ? radial * pel_vec3_dot(velocity, offset) / square : 0;
    pel_vec3_along(force, -drag, velocity, force);
    pel_vec3_along(force, -along, offset, force);
}

/* what the substeps recorded on held vertices, what draws them to their rest places, damping and inertia */
static void read_grip(pel_sim *sim, pel_tool *tool)
{
    const pel_model *model = sim->model;
    const pel_state *state = sim->state;
    for (int32_t i = 0; i < tool->held_count; i++) {
        int32_t v = tool->held[i];
        const double *factors = state->factors[model->body_of_slice[v / PEL_WIDTH]];
        double spring = factors[PEL_VOLUMETRIC_STIFFNESS] * (double)model->rest[v][3], force[3], x[3];
        for (int k = 0; k < 3; k++) {
            x[k] = (double)state->position_next[v][k];
            force[k] =
                (double)sim->projector->reaction[v][k] / sim->solver.substeps -
                spring * (x[k] - (double)model->rest[v][k]) -
                (double)model->mass[v] * (double)(state->velocity_next[v][k] - state->velocity[v][k]) / sim->step.dt;
        }
        add_damping(sim, v, factors, force);
        add_grip(sim, tool, v, x, force);
        pel_tool_touch(tool, v);
    }
}

void pel_tool_take(pel_sim *sim, pel_tool *tool, const pel_contact *contact, const double change[3], double rate)
{
    const pel_record *positions = sim->state->position_next;
    double free = 0, point[3] = {0, 0, 0}, sum = 0, side = 0, force[3], x[3];
    for (int i = 0; i < 4; i++) {
        double weight = (double)contact->weights[i];
        if (weight == 0)
            continue;
        free += (double)positions[contact->vertices[i]][3] * weight * weight;
        pel_vertex_position(positions, contact->vertices[i], x);
        pel_vec3_along(point, fabs(weight), x, point);
        sum += fabs(weight);
        side += weight;
    }
    if (!(free > 0))
        return;
    for (int i = 0; i < 4; i++) {
        int32_t v = contact->vertices[i];
        double share = (double)(contact->weights[i] * contact->push * positions[v][3]) / free;
        if (share == 0)
            continue;
        pel_touch *touch = pel_tool_touch(tool, v);
        for (int k = 0; k < 3; k++)
            touch->push[k] += share * (double)contact->normal[k];
    }
    pel_vec3_scale(point, 1 / sum, point);
    /* of surfaces the tool may be the first or the second one */
    pel_vec3_scale(change, -copysign(rate / free, side), force);
    pel_tool_add_reaction(tool, point, force);
}

void pel_tool_take_push(pel_sim *sim, pel_tool *tool, const pel_contact *contact, double rate)
{
    double change[3];
    for (int k = 0; k < 3; k++)
        change[k] = (double)(contact->push * contact->normal[k] + contact->tangential[k]);
    pel_tool_take(sim, tool, contact, change, rate);
}

/* ---- one step ---- */

double pel_tool_way(const pel_tool *tool, const pel_pose *a, const pel_pose *b)
{
    double turn[3];
    pel_tool_turn(a, b, turn);
    return pel_vec3_distance(a->position, b->position) + pel_vec3_length(turn) * pel_tool_size(tool);
}

/* a tool that was held back catches up at twice its keyed speed, or by an eighth of the lag per step if that is more;
   a lag below CAUGHT_UP of its size is closed at once */
static pel_pose catch_up(const pel_tool *tool, double time, double dt)
{
    pel_pose wanted = pel_tool_pose_at(tool, time), last = pel_tool_pose_at(tool, time - dt), pose;
    double behind = pel_tool_way(tool, &tool->pose, &wanted), stride = 2 * pel_tool_way(tool, &last, &wanted);
    double share = behind > CAUGHT_UP * pel_tool_size(tool) ? fmax(stride / behind, 0.125) : 1;
    pel_tool_pose_between(&tool->pose, &wanted, fmin(share, 1), &pose);
    return pose;
}

pel_pose pel_tool_next_pose(const pel_tool *tool, double time, double dt)
{
    return tool->blocked ? catch_up(tool, time, dt) : pel_tool_pose_at(tool, time);
}

static void forget_touches(pel_tool *tool)
{
    for (int32_t i = 0; i < tool->touch_count; i++)
        tool->touch_of_vertex[tool->touches[i].vertex] = 0;
    tool->touch_count = 0;
    pel_vec3_set(tool->force, 0, 0, 0);
    pel_vec3_set(tool->torque, 0, 0, 0);
}

void pel_tools_forget_step(pel_sim *sim)
{
    for (int32_t i = 0; i < sim->tool_count; i++) {
        forget_touches(&sim->tools[i]);
        sim->tools[i].pose = sim->tools[i].pose_before;
    }
}

static void begin_tool(pel_sim *sim, pel_tool *tool, double time)
{
    tool->is_on_its_way = true;
    tool->blocked_before = tool->blocked;
    pel_vec3_copy(tool->force, tool->force_before);
    pel_vec3_copy(tool->torque, tool->torque_before);
    forget_touches(tool);
    pel_plane *oldest = tool->planes_before;
    tool->planes_before = tool->planes;
    tool->plane_before_count = tool->plane_count;
    tool->planes = oldest;
    tool->plane_count = 0;
    tool->pose_before = tool->pose_substep = tool->pose;
    tool->pose = tool->pose_wanted = pel_tool_next_pose(tool, time, sim->step.dt);
}

void pel_tools_begin(pel_sim *sim, double time)
{
    bool changed = false;
    for (int32_t i = 0; i < sim->tool_count; i++) {
        begin_tool(sim, &sim->tools[i], time);
        changed |= update_grasp(sim, &sim->tools[i], time);
        for (int32_t k = 0; k < sim->tools[i].held_count; k++)
            pel_vec3_set(sim->grip_forces[sim->tools[i].held[k]], 0, 0, 0);
    }
    if (sim->held_vertices != NULL && (changed || !sim->held_is_listed))
        list_held(sim);
    sim->held_is_listed = true;
}

void pel_tools_place(pel_sim *sim, double share)
{
    int32_t count = 0;
    for (int32_t i = 0; i < sim->tool_count; i++) {
        pel_tool *tool = &sim->tools[i];
        tool->pose_substep = tool->pose;
        pel_tool_pose_between(&tool->pose_before, &tool->pose_wanted, share, &tool->pose);
        for (int32_t k = 0; k < tool->held_count; k++)
            pel_pose_to_world(&tool->pose, tool->anchors[k], sim->held_targets[count++]);
    }
}

void pel_tools_move(pel_sim *sim, double time)
{
    pel_tools_begin(sim, time);
    pel_tools_carry(sim);
}

void pel_tools_carry(pel_sim *sim)
{
    for (int32_t i = 0; i < sim->tool_count; i++)
        carry(sim, &sim->tools[i]);
}

void pel_tools_return(pel_sim *sim)
{
    for (int32_t i = 0; i < sim->tool_count; i++) {
        pel_tool *tool = &sim->tools[i];
        if (!tool->is_on_its_way)
            continue;
        tool->is_on_its_way = false;
        tool->pose = tool->pose_before;
        tool->blocked = tool->blocked_before;
        pel_vec3_copy(tool->force_before, tool->force);
        pel_vec3_copy(tool->torque_before, tool->torque);
        pel_plane *newest = tool->planes;
        tool->planes = tool->planes_before;
        tool->plane_count = tool->plane_before_count;
        tool->planes_before = newest;
    }
}

static bool presses(const pel_tool *tool, bool only_round)
{
    return tool->press && tool->mesh == NULL && !(only_round && tool->solid.kind == PEL_SOLID_BOX);
}

void pel_tools_press(pel_sim *sim, double longest, bool only_round)
{
    /* the substeps have kept solids out (tool_solid.h), and no guard looks at them */
    bool moved = !pel_sim_is_projected(sim) || sim->contacts != NULL;
    for (int round = 0; moved && round < (sim->tool_count > 1 ? ROUND_LIMIT : 1); round++) {
        moved = false;
        for (int32_t i = 0; i < sim->tool_count; i++)
            if (presses(&sim->tools[i], only_round))
                moved |= pel_tool_press(sim, &sim->tools[i], longest);
    }
}

void pel_tools_read(pel_sim *sim, double time)
{
    int32_t touch_count = 0;
    if (sim->descent != NULL)
        pel_descent_contacts_read(sim);
    for (int32_t i = 0; i < sim->tool_count && sim->projector != NULL; i++)
        read_grip(sim, &sim->tools[i]);
    for (int32_t i = 0; i < sim->tool_count; i++)
        touch_count += sim->tools[i].touch_count;
    if (sim->state->velocity_next == NULL && touch_count > 0) {
        find_load_and_shell_forces(sim, time);
        for (int32_t i = 0; i < sim->tool_count; i++)
            read_forces(sim, &sim->tools[i]);
    }
    for (int32_t i = 0; i < sim->tool_count; i++) {
        sim->tools[i].contact_count = sim->tools[i].touch_count;
        sim->tools[i].is_on_its_way = false;
    }
}

/* ---- refinement ---- */

/* a plane stays with its triangle where that is still as it was; where it was refined, with the child at the point */
static bool follow_plane(const pel_sim *sim, int32_t body, pel_plane *plane)
{
    const pel_front *front = sim->model->bodies[body].front;
    int32_t begin = sim->model->triangle_begin[body], number = (int32_t)plane->triangle - begin, node = number / 2;
    if (front->old_shapes[node] == front->shapes[node])
        return true;
    if (front->old_shapes[node] != PEL_FRONT_WHOLE)
        return false;
    double *w = plane->weights;
    int32_t level = pel_front_level(front, node);
    while (front->shapes[node] == PEL_FRONT_RED) {
        int32_t i = w[0] >= 0.5 ? 0 : w[1] >= 0.5 ? 1 : w[2] >= 0.5 ? 2 : 3;
        node = front->node_begin[level + 1] + pel_lod_child(node - front->node_begin[level], i);
        double a = w[0], b = w[1], c = w[2];
        /* corner child (v_i m_i m_(i-1)), middle child (m_0 m_1 m_2) */
        if (i == 3)
            pel_vec3_set(w, 1 - 2 * c, 1 - 2 * a, 1 - 2 * b);
        else if (i == 0)
            pel_vec3_set(w, 2 * a - 1, 2 * b, 2 * c);
        else if (i == 1)
            pel_vec3_set(w, 2 * b - 1, 2 * c, 2 * a);
        else
            pel_vec3_set(w, 2 * c - 1, 2 * a, 2 * b);
        level++;
    }
    plane->triangle = begin + 2 * node;
    return front->shapes[node] == PEL_FRONT_WHOLE;
}

static void follow_planes(const pel_sim *sim, int32_t body, pel_tool *tool)
{
    int32_t kept = 0, begin = sim->model->triangle_begin[body], end = sim->model->triangle_begin[body + 1];
    for (int32_t p = 0; p < tool->plane_count; p++) {
        pel_plane plane = tool->planes[p];
        bool own = plane.triangle >= begin && plane.triangle < end;
        if (!own || follow_plane(sim, body, &plane))
            tool->planes[kept++] = plane;
    }
    tool->plane_count = kept;
}

static void release_places(pel_sim *sim, pel_tool *tool)
{
    const pel_active *active = sim->active;
    for (int32_t r = 0; r < active->released_count; r++) {
        if (!sim->held[active->released[r]])
            continue;
        for (int32_t i = 0; i < tool->held_count; i++)
            if (tool->held[i] == active->released[r]) {
                pel_tool_let_go(sim, tool, i);
                break;
            }
    }
}

void pel_tools_update(pel_sim *sim, int32_t body)
{
    for (int32_t i = 0; i < sim->tool_count; i++) {
        follow_planes(sim, body, &sim->tools[i]);
        release_places(sim, &sim->tools[i]);
    }
}

/* ---- start ---- */

/* solid angle of a triangle seen from the origin over 4 pi */
static double winding(const double a[3], const double b[3], const double c[3])
{
    double la = pel_vec3_length(a), lb = pel_vec3_length(b), lc = pel_vec3_length(c), n[3];
    pel_vec3_cross(b, c, n);
    double divisor = la * lb * lc + pel_vec3_dot(a, b) * lc + pel_vec3_dot(b, c) * la + pel_vec3_dot(c, a) * lb;
    return atan2(pel_vec3_dot(a, n), divisor) / 6.283185307179586;
}

bool pel_tool_is_enclosed(const pel_sim *sim, const double point[3], int32_t body)
{
    double sum = 0;
    for (int32_t i = 0; i < pel_surface_count(sim->model, body); i++) {
        int32_t t = pel_surface_triangle(sim->model, body, i);
        double corner[3][3];
        for (int c = 0; c < 3; c++) {
            pel_vertex_position(sim->state->position, sim->model->triangles[t][c], corner[c]);
            pel_vec3_subtract(corner[c], point, corner[c]);
        }
        sum += winding(corner[0], corner[1], corner[2]);
    }
    return fabs(sum) > 0.5;
}

static pel_status refuse_inside(const pel_tool *tool, int32_t index, const char *body, double depth, pel_error *error)
{
    pel_fail(error, PEL_BAD_ARGUMENT, "tool '%s' starts inside body '%s' (by %.3g m)", tool->name, body, depth);
    pel_fail_element(error, "tool", index);
    pel_fail_remedy(error, "move its first key away from the body by at least that much");
    return PEL_BAD_ARGUMENT;
}

/* how far the solid extends from its centre along a unit vector of its frame */
static double extent_along(const pel_solid *solid, const double along[3])
{
    const double *half = solid->half_extents;
    if (solid->kind == PEL_SOLID_BOX)
        return half[0] * fabs(along[0]) + half[1] * fabs(along[1]) + half[2] * fabs(along[2]);
    return solid->radius + (solid->kind == PEL_SOLID_CAPSULE ? solid->half_length * fabs(along[2]) : 0);
}

/* the way out of a body for a tool whose centre is inside: through the nearest point of the surface, by all of the tool
 */
static double depth_inside(const pel_sim *sim, const pel_tool *tool, int32_t body)
{
    double least = HUGE_VAL, corner[3][3], nearest[3] = {0, 0, 0}, weights[3];
    for (int32_t i = 0; i < pel_surface_count(sim->model, body); i++) {
        const int32_t *v = sim->model->triangles[pel_surface_triangle(sim->model, body, i)];
        for (int c = 0; c < 3; c++)
            pel_vertex_position(sim->state->position, v[c], corner[c]);
        double square = pel_closest_point_triangle(tool->pose.position, corner[0], corner[1], corner[2], weights);
        if (!(square < least))
            continue;
        least = square;
        for (int c = 0; c < 3; c++)
            nearest[c] = weights[0] * corner[0][c] + weights[1] * corner[1][c] + weights[2] * corner[2][c];
    }
    double distance = sqrt(least), along[3] = {0, 0, 1};
    pel_pose_to_local(&tool->pose, nearest, nearest);
    if (distance > 0)
        pel_vec3_scale(nearest, 1 / distance, along);
    return distance + extent_along(&tool->solid, along);
}

static pel_status check_outside(const pel_sim *sim, int32_t index, pel_error *error)
{
    const pel_tool *tool = &sim->tools[index];
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_body *body = &sim->model->bodies[b];
        if (tool->body >= 0 && tool->body != b)
            continue;
        double deepest = 0, weights[3], normal[3];
        for (int32_t i = 0; i < pel_surface_count(sim->model, b); i++) {
            int32_t t = pel_surface_triangle(sim->model, b, i);
            deepest = fmax(deepest,
                           pel_tool_triangle_depth(sim, tool, &tool->solid, sim->state->position, t, weights, normal));
        }
        if (body->closed && pel_tool_is_enclosed(sim, tool->pose.position, b))
            return refuse_inside(tool, index, body->name, depth_inside(sim, tool, b), error);
        if (deepest > 1e-3 * pel_tool_size(tool))
            return refuse_inside(tool, index, body->name, deepest, error);
    }
    return PEL_OK;
}

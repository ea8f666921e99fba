/* Rigid tools: they move on their keys, hold what they grasped, and push the surface out of the way.

   Pressing keeps whole triangles out of the tool, not only vertices: each triangle near the tool is pushed out at its
   deepest point p = sum b_i x_i by x_i += w_i b_i / (sum w b^2) depth n, triangle after triangle until none is deeper
   than the tolerance. Vertices come first, which settles most of it.

   The force on the tool is what the surface does to it without friction. Quasi-static method: the force F_i of eq. A-2
   on each touched vertex, as far as it presses against the tool (held vertices: all of it); at rest this balances the
   push exactly. Explicit method: the momentum taken from the vertices over dt. */
#include "base/memory.h"
#include "base/status.h"
#include "math/pose.h"
#include "sim/sim.h"

#include <stdio.h>
#include <string.h>

/* sweeps over the near triangles at most, rounds over the tools at most */
enum { SWEEP_LIMIT = 40, ROUND_LIMIT = 4 };
/* depth that counts as touching, relative to the tool's size */
#define DEPTH_TOLERANCE 1e-6

pel_tool_def pel_tool_def_default(void)
{
    return (pel_tool_def){.shape = PEL_TOOL_SPHERE, .body = -1, .press = true, .grasp_until = (double)INFINITY};
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

static bool is_pose(const double position[3], const double rotation[4])
{
    double square = 0;
    for (int i = 0; i < 4; i++)
        square += rotation[i] * rotation[i];
    return isfinite(position[0]) && isfinite(position[1]) && isfinite(position[2]) && fabs(square - 1) < 1e-6;
}

static pel_status check_shape(const pel_tool_def *def, int32_t tool, pel_error *error)
{
    const double *half = def->half_extents;
    if (def->shape == PEL_TOOL_BOX) {
        if (!is_positive(half[0]) || !is_positive(half[1]) || !is_positive(half[2]))
            return refuse(error, tool, "box has no size", "give three half extents above 0");
    } else if (!is_positive(def->radius)) {
        return refuse(error, tool, "radius is not above 0", "give a radius above 0");
    }
    if (def->shape == PEL_TOOL_CAPSULE && !(def->half_length >= 0 && isfinite(def->half_length)))
        return refuse(error, tool, "capsule length is below 0", "give a half length of at least 0");
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
        if (!isfinite(key->time) || !is_pose(key->position, key->rotation))
            return refuse(error, tool, "a key is not finite or its rotation is no unit quaternion",
                          "give finite positions and unit quaternions x, y, z, w");
        if (k > 0 && !(key->time > key[-1].time))
            return refuse(error, tool, "keys are not in order", "give keys with increasing times");
    }
    if (def->grasp && (!(def->grasp_until > def->grasp_from) || !(def->reach >= 0 && isfinite(def->reach))))
        return refuse(error, tool, "grasp ends before it begins, or its reach is below 0",
                      "give grasp_from < grasp_until and a reach of at least 0");
    return check_shape(def, tool, error);
}

static pel_status create_tool(pel_sim *sim, const pel_tool_def *def, pel_tool *tool, pel_error *error)
{
    size_t vertex_count = (size_t)sim->model->vertex_count;
    snprintf(tool->name, sizeof tool->name, "%s", def->name);
    static const pel_solid_kind kinds[] = {
        [PEL_TOOL_SPHERE] = PEL_SOLID_SPHERE, [PEL_TOOL_CAPSULE] = PEL_SOLID_CAPSULE, [PEL_TOOL_BOX] = PEL_SOLID_BOX};
    tool->solid = (pel_solid){.kind = kinds[def->shape], .radius = def->radius, .half_length = def->half_length};
    memcpy(tool->solid.half_extents, def->half_extents, sizeof tool->solid.half_extents);
    tool->body = def->body;
    tool->press = def->press;
    tool->grasp = def->grasp;
    tool->grasp_from = def->grasp_from;
    tool->grasp_until = def->grasp_until;
    tool->reach = def->reach;
    tool->keys = pel_allocate((size_t)def->key_count, sizeof *tool->keys);
    tool->touches = pel_allocate(vertex_count, sizeof *tool->touches);
    tool->touch_of_vertex = pel_allocate(vertex_count, sizeof *tool->touch_of_vertex);
    if (def->grasp) {
        tool->held = pel_allocate(vertex_count, sizeof *tool->held);
        tool->anchors = pel_allocate(vertex_count, sizeof *tool->anchors);
    }
    if (tool->keys == NULL || tool->touches == NULL || tool->touch_of_vertex == NULL ||
        (def->grasp && (tool->held == NULL || tool->anchors == NULL)))
        return pel_fail_memory(error);
    memcpy(tool->keys, def->keys, (size_t)def->key_count * sizeof *tool->keys);
    tool->key_count = def->key_count;
    tool->pose = tool->pose_before = pel_tool_pose_at(tool, 0);
    return PEL_OK;
}

static pel_status check_outside(const pel_sim *sim, int32_t tool, pel_error *error);

pel_status pel_tools_create(pel_sim *sim, const pel_tool_def *defs, int32_t count, pel_error *error)
{
    sim->tools = pel_allocate((size_t)count, sizeof *sim->tools);
    if (sim->tools == NULL)
        return pel_fail_memory(error);
    sim->tool_count = count;
    if (count == 0)
        return PEL_OK;
    sim->near_triangles = pel_allocate((size_t)sim->model->triangle_count, sizeof *sim->near_triangles);
    sim->triangle_marks = pel_allocate((size_t)sim->model->triangle_count, sizeof *sim->triangle_marks);
    sim->held = pel_allocate((size_t)sim->model->vertex_count, sizeof *sim->held);
    if (sim->near_triangles == NULL || sim->triangle_marks == NULL || sim->held == NULL)
        return pel_fail_memory(error);
    pel_status status = PEL_OK;
    for (int32_t i = 0; status == PEL_OK && i < count; i++) {
        status = check_tool(sim, defs, i, error);
        if (status == PEL_OK)
            status = create_tool(sim, &defs[i], &sim->tools[i], error);
        if (status == PEL_OK && defs[i].press)
            status = check_outside(sim, i, error);
    }
    return status;
}

void pel_tools_destroy(pel_sim *sim)
{
    for (int32_t i = 0; i < sim->tool_count; i++) {
        pel_tool *tool = &sim->tools[i];
        void *arrays[] = {tool->keys, tool->touches, tool->touch_of_vertex, tool->held, tool->anchors};
        for (size_t a = 0; a < sizeof arrays / sizeof *arrays; a++)
            pel_free(arrays[a]);
    }
    pel_free(sim->tools);
    pel_free(sim->near_triangles);
    pel_free(sim->triangle_marks);
    pel_free(sim->held);
}

/* ---- frames ---- */

pel_pose pel_tool_pose_at(const pel_tool *tool, double time)
{
    if (tool->driven)
        return tool->driven_pose;
    const pel_pose_key *key = tool->keys;
    int32_t k = 0;
    while (k < tool->key_count && key[k].time <= time)
        k++;
    pel_pose pose;
    const pel_pose_key *a = &key[k > 0 ? k - 1 : 0], *b = &key[k < tool->key_count ? k : tool->key_count - 1];
    double s = b->time > a->time ? (time - a->time) / (b->time - a->time) : 0;
    for (int i = 0; i < 3; i++)
        pose.position[i] = a->position[i] + s * (b->position[i] - a->position[i]);
    pel_slerp(a->rotation, b->rotation, s, pose.rotation);
    return pose;
}

static void to_local(const pel_pose *pose, const double world[3], double local[3])
{
    pel_vec3_subtract(world, pose->position, local);
    pel_rotate_back(pose->rotation, local, local);
}

static void to_world(const pel_pose *pose, const double local[3], double world[3])
{
    pel_rotate(pose->rotation, local, world);
    pel_vec3_add(world, pose->position, world);
}

static void vertex_position(const pel_record *positions, int32_t v, double x[3])
{
    pel_vec3_set(x, (double)positions[v][0], (double)positions[v][1], (double)positions[v][2]);
}

/* velocity of the point of the tool that is now at `point`, over the last step */
static void tool_velocity(const pel_tool *tool, const double point[3], double dt, double velocity[3])
{
    double local[3], before[3];
    to_local(&tool->pose, point, local);
    to_world(&tool->pose_before, local, before);
    for (int i = 0; i < 3; i++)
        velocity[i] = (point[i] - before[i]) / dt;
}

static double tool_size(const pel_tool *tool)
{
    double half[3];
    pel_solid_half_box(&tool->solid, half);
    return half[0] + half[1] + half[2];
}

static int32_t first_vertex(const pel_sim *sim, int32_t body)
{
    return body < 0 ? 0 : sim->model->bodies[body].slice_begin * PEL_WIDTH;
}

static int32_t end_vertex(const pel_sim *sim, int32_t body)
{
    return body < 0 ? sim->model->vertex_count : sim->model->bodies[body].slice_end * PEL_WIDTH;
}

/* ---- pressing ---- */

/* half sizes of the world-aligned box about the tool */
static void world_half_box(const pel_tool *tool, double half[3])
{
    double local[3], axis[3];
    pel_solid_half_box(&tool->solid, local);
    pel_vec3_set(half, 0, 0, 0);
    for (int i = 0; i < 3; i++) {
        pel_vec3_set(axis, i == 0 ? local[0] : 0, i == 1 ? local[1] : 0, i == 2 ? local[2] : 0);
        pel_rotate(tool->pose.rotation, axis, axis);
        for (int j = 0; j < 3; j++)
            half[j] += fabs(axis[j]);
    }
}

/* lists the triangles with a vertex within `reach` of the tool's box; a triangle that overlaps the tool has all its
   vertices within its longest edge of it */
static int32_t find_near_triangles(pel_sim *sim, const pel_tool *tool, const pel_record *positions, double reach)
{
    const pel_model *model = sim->model;
    double half[3];
    world_half_box(tool, half);
    pel_record low, high;
    for (int i = 0; i < 3; i++) {
        low[i] = (pel_real)(tool->pose.position[i] - half[i] - reach);
        high[i] = (pel_real)(tool->pose.position[i] + half[i] + reach);
    }
    int32_t count = 0, end = end_vertex(sim, tool->body);
    for (int32_t v = first_vertex(sim, tool->body); v < end; v++) {
        const pel_record x = positions[v];
        if (x[0] < low[0] || x[0] > high[0] || x[1] < low[1] || x[1] > high[1] || x[2] < low[2] || x[2] > high[2])
            continue;
        for (int32_t f = model->fan_begin[v]; f < model->fan_begin[v + 1]; f++) {
            int32_t t = model->fans[f];
            if (!sim->triangle_marks[t]) {
                sim->triangle_marks[t] = 1;
                sim->near_triangles[count++] = t;
            }
        }
    }
    for (int32_t i = 0; i < count; i++)
        sim->triangle_marks[sim->near_triangles[i]] = 0;
    return count;
}

static double mobility(const pel_sim *sim, int32_t v)
{
    return sim->held[v] ? 0 : (double)sim->model->inverse_mass[v];
}

static pel_touch *touch_of(pel_tool *tool, int32_t v)
{
    if (tool->touch_of_vertex[v] == 0) {
        tool->touches[tool->touch_count] = (pel_touch){.vertex = v};
        tool->touch_of_vertex[v] = ++tool->touch_count;
    }
    return &tool->touches[tool->touch_of_vertex[v] - 1];
}

static void add_reaction(pel_tool *tool, const double point[3], const double force[3])
{
    double arm[3], torque[3];
    pel_vec3_subtract(point, tool->pose.position, arm);
    pel_vec3_cross(arm, force, torque);
    pel_vec3_add(tool->force, force, tool->force);
    pel_vec3_add(tool->torque, torque, tool->torque);
}

static void record_add(pel_record *record, double scale, const double a[3])
{
    for (int i = 0; i < 3; i++)
        (*record)[i] += (pel_real)(scale * a[i]);
}

/* a point of the surface: up to three vertices with weights */
typedef struct surface_point {
    const int32_t *vertices;
    const double *weights;
    int count;
} surface_point;

/* explicit method: takes away the velocity with which the point runs into the tool, and counts the impulse */
static void stop_point(pel_sim *sim, pel_tool *tool, const surface_point *at, const double normal[3], double inertia)
{
    double point[3] = {0, 0, 0}, relative[3] = {0, 0, 0}, moving[3], x[3];
    for (int c = 0; c < at->count; c++) {
        vertex_position(sim->state->position_next, at->vertices[c], x);
        pel_vec3_along(point, at->weights[c], x, point);
        vertex_position(sim->state->velocity_next, at->vertices[c], x);
        pel_vec3_along(relative, at->weights[c], x, relative);
    }
    tool_velocity(tool, point, sim->step.dt, moving);
    pel_vec3_subtract(relative, moving, relative);
    double approach = -pel_vec3_dot(relative, normal);
    if (approach <= 0)
        return;
    double impulse = approach / inertia, force[3];
    for (int c = 0; c < at->count; c++) {
        int32_t v = at->vertices[c];
        record_add(&sim->state->velocity_next[v], impulse * at->weights[c] * mobility(sim, v), normal);
    }
    pel_vec3_scale(normal, -impulse / sim->step.dt, force);
    add_reaction(tool, point, force);
}

/* moves the vertices so that the point goes `depth` along the normal; false when none of them can move */
static bool push_point(pel_sim *sim, pel_tool *tool, const surface_point *at, double depth, const double normal[3])
{
    double inertia = 0;
    for (int c = 0; c < at->count; c++)
        inertia += mobility(sim, at->vertices[c]) * at->weights[c] * at->weights[c];
    if (inertia <= 0)
        return false;
    for (int c = 0; c < at->count; c++) {
        int32_t v = at->vertices[c];
        double share = mobility(sim, v) * at->weights[c] / inertia * depth;
        if (share <= 0)
            continue;
        record_add(&sim->state->position_next[v], share, normal);
        pel_touch *touch = touch_of(tool, v);
        pel_vec3_along(touch->push, share, normal, touch->push);
    }
    if (sim->state->velocity_next != NULL)
        stop_point(sim, tool, at, normal, inertia);
    return true;
}

static bool press_vertex(pel_sim *sim, pel_tool *tool, int32_t v, double tolerance)
{
    double x[3], local[3], normal[3];
    vertex_position(sim->state->position_next, v, x);
    to_local(&tool->pose, x, local);
    double depth = -pel_solid_distance(&tool->solid, local, normal);
    if (depth <= tolerance)
        return false;
    pel_rotate(tool->pose.rotation, normal, normal);
    const double whole = 1;
    return push_point(sim, tool, &(surface_point){&v, &whole, 1}, depth, normal);
}

/* depth of one triangle in the tool, with the deepest point and the way out in the tool's frame */
static double triangle_depth(const pel_sim *sim, const pel_tool *tool, const pel_record *positions, int32_t t,
                             double weights[3], double normal[3])
{
    double world[3], corner[3][3];
    for (int c = 0; c < 3; c++) {
        vertex_position(positions, sim->model->triangles[t][c], world);
        to_local(&tool->pose, world, corner[c]);
    }
    return pel_solid_depth(&tool->solid, corner[0], corner[1], corner[2], weights, normal);
}

static bool press_triangle(pel_sim *sim, pel_tool *tool, int32_t t, double tolerance)
{
    double weights[3], normal[3];
    double depth = triangle_depth(sim, tool, sim->state->position_next, t, weights, normal);
    if (depth <= tolerance)
        return false;
    pel_rotate(tool->pose.rotation, normal, normal);
    return push_point(sim, tool, &(surface_point){sim->model->triangles[t], weights, 3}, depth, normal);
}

/* pushes the surface out of one tool; true when anything moved */
static bool press(pel_sim *sim, pel_tool *tool, double longest)
{
    int32_t near_count = find_near_triangles(sim, tool, sim->state->position_next, 1.25 * longest);
    double tolerance = DEPTH_TOLERANCE * tool_size(tool);
    bool moved = false;
    for (int32_t i = 0; i < near_count; i++)
        for (int c = 0; c < 3; c++)
            moved |= press_vertex(sim, tool, sim->model->triangles[sim->near_triangles[i]][c], tolerance);
    bool again = true;
    for (int sweep = 0; again && sweep < SWEEP_LIMIT; sweep++) {
        again = false;
        for (int32_t i = 0; i < near_count; i++)
            again |= press_triangle(sim, tool, sim->near_triangles[i], tolerance);
        moved |= again;
    }
    return moved;
}

/* ---- grasping ---- */

static void grasp(pel_sim *sim, pel_tool *tool)
{
    int32_t end = end_vertex(sim, tool->body);
    for (int32_t v = first_vertex(sim, tool->body); v < end; v++) {
        double x[3], local[3], normal[3];
        if (mobility(sim, v) <= 0)
            continue;
        vertex_position(sim->state->position, v, x);
        to_local(&tool->pose_before, x, local);
        if (pel_solid_distance(&tool->solid, local, normal) > tool->reach)
            continue;
        sim->held[v] = 1;
        pel_vec3_copy(local, tool->anchors[tool->held_count]);
        tool->held[tool->held_count++] = v;
    }
}

static void release(pel_sim *sim, pel_tool *tool)
{
    for (int32_t i = 0; i < tool->held_count; i++)
        sim->held[tool->held[i]] = 0;
    tool->held_count = 0;
}

static void update_grasp(pel_sim *sim, pel_tool *tool, double time)
{
    if (!tool->grasp)
        return;
    if (tool->phase == PEL_GRASP_WAITING && time >= tool->grasp_from) {
        tool->phase = PEL_GRASP_HOLDING;
        grasp(sim, tool);
    }
    if (tool->phase == PEL_GRASP_HOLDING && time >= tool->grasp_until) {
        tool->phase = PEL_GRASP_DONE;
        release(sim, tool);
    }
}

/* held vertices go where the tool takes them */
static void carry(pel_sim *sim, pel_tool *tool)
{
    pel_state *state = sim->state;
    for (int32_t i = 0; i < tool->held_count; i++) {
        int32_t v = tool->held[i];
        double target[3], velocity[3], change[3];
        to_world(&tool->pose, tool->anchors[i], target);
        for (int c = 0; c < 3; c++)
            state->position_next[v][c] = (pel_real)target[c];
        touch_of(tool, v);
        if (state->velocity_next == NULL)
            continue;
        tool_velocity(tool, target, sim->step.dt, velocity);
        for (int c = 0; c < 3; c++) {
            change[c] = velocity[c] - (double)state->velocity_next[v][c];
            state->velocity_next[v][c] = (pel_real)velocity[c];
        }
        pel_vec3_scale(change, -(double)sim->model->mass[v] / sim->step.dt, change);
        add_reaction(tool, target, change);
    }
}

/* ---- forces of the quasi-static method ---- */

/* force on a touched vertex at the new positions, loads included */
static void quasi_static_force(const pel_sim *sim, int32_t v, double force[3])
{
    const pel_state *state = sim->state;
    pel_record elastic = pel_elastic_force_at(sim->model, state, state->position_next, v);
    for (int i = 0; i < 3; i++)
        force[i] = (double)(elastic[i] + sim->force[v][i]);
}

static void read_forces(pel_sim *sim, pel_tool *tool)
{
    for (int32_t i = 0; i < tool->touch_count; i++) {
        const pel_touch *touch = &tool->touches[i];
        double force[3], x[3];
        quasi_static_force(sim, touch->vertex, force);
        if (!sim->held[touch->vertex]) {
            /* only what presses against the tool: it cannot pull and has no friction */
            double push = pel_vec3_squared_length(touch->push);
            double along = push > 0 ? fmin(pel_vec3_dot(force, touch->push) / push, 0) : 0;
            pel_vec3_scale(touch->push, along, force);
        }
        vertex_position(sim->state->position_next, touch->vertex, x);
        add_reaction(tool, x, force);
    }
}

/* ---- one step ---- */

static void begin_tool(pel_sim *sim, pel_tool *tool, double time)
{
    for (int32_t i = 0; i < tool->touch_count; i++)
        tool->touch_of_vertex[tool->touches[i].vertex] = 0;
    tool->touch_count = 0;
    pel_vec3_set(tool->force, 0, 0, 0);
    pel_vec3_set(tool->torque, 0, 0, 0);
    tool->pose_before = tool->pose;
    tool->pose = pel_tool_pose_at(tool, time);
    update_grasp(sim, tool, time);
}

void pel_tools_apply(pel_sim *sim, double time, double longest)
{
    for (int32_t i = 0; i < sim->tool_count; i++)
        begin_tool(sim, &sim->tools[i], time);
    for (int32_t i = 0; i < sim->tool_count; i++)
        carry(sim, &sim->tools[i]);
    bool moved = true;
    for (int round = 0; moved && round < (sim->tool_count > 1 ? ROUND_LIMIT : 1); round++) {
        moved = false;
        for (int32_t i = 0; i < sim->tool_count; i++)
            if (sim->tools[i].press)
                moved |= press(sim, &sim->tools[i], longest);
    }
    if (sim->state->velocity_next == NULL) {
        for (int32_t i = 0; i < sim->tool_count; i++)
            for (int32_t k = 0; k < sim->tools[i].touch_count; k++)
                sim->force[sim->tools[i].touches[k].vertex] = pel_wide_splat(0);
        pel_loads_add(sim, time, sim->force);
        for (int32_t i = 0; i < sim->tool_count; i++)
            read_forces(sim, &sim->tools[i]);
    }
    for (int32_t i = 0; i < sim->tool_count; i++)
        sim->tools[i].contact_count = sim->tools[i].touch_count;
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

/* true when the tool's middle lies inside a closed body */
static bool is_enclosed(const pel_sim *sim, const pel_tool *tool, int32_t body)
{
    double sum = 0;
    for (int32_t t = sim->model->triangle_begin[body]; t < sim->model->triangle_begin[body + 1]; t++) {
        double corner[3][3];
        for (int c = 0; c < 3; c++) {
            vertex_position(sim->state->position, sim->model->triangles[t][c], corner[c]);
            pel_vec3_subtract(corner[c], tool->pose.position, corner[c]);
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

static pel_status check_outside(const pel_sim *sim, int32_t index, pel_error *error)
{
    const pel_tool *tool = &sim->tools[index];
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_body *body = &sim->model->bodies[b];
        if (tool->body >= 0 && tool->body != b)
            continue;
        double deepest = 0, weights[3], normal[3];
        for (int32_t t = sim->model->triangle_begin[b]; t < sim->model->triangle_begin[b + 1]; t++)
            deepest = fmax(deepest, triangle_depth(sim, tool, sim->state->position, t, weights, normal));
        if (deepest > 1e-3 * tool_size(tool))
            return refuse_inside(tool, index, body->name, deepest, error);
        if (body->closed && is_enclosed(sim, tool, b))
            return refuse_inside(tool, index, body->name, body->diameter, error);
    }
    return PEL_OK;
}

/* Grasps: vertices that tools hold and carry; a grasp that exceeds its force loses vertices.

   The grip force of a tool is the sum of the magnitudes of the forces on its held vertices, like the load that a clamp
   carries by friction: it bounds the net force, and a twist whose net force is zero counts as well. Where it exceeds
   the limit, the vertices with the largest forces are lost first, until the forces of the rest are within the limit.
   The rest takes over their load in the next steps, so a grasp tears out step by step.

   Without a limit of the user the material has one: GRIP_STRENGTH times the force that doubles the length of the
   sheet at the held vertices. Where the guard holds a grasp for some steps, however little it moves, no force is known
   and none would do: it lets go of all. */
#include "tool/grip.h"
#include "math/extremes.h"

#include "base/assert.h"
#include "bvh/mesh_query.h"
#include "stage/stepper.h"
#include "tool/follow.h"
#include "tool/pose.h"

/* of the strength of the held vertices: rubber bears 2 at five times its length, laws that stiffen bear more */
#define GRIP_STRENGTH 10.0

/* ---- holding ---- */

/* inside the tool, or within its reach */
static bool reaches(const pel_tool *tool, const double local[3])
{
    double normal[3];
    return tool->query != NULL ? pel_mesh_query_reaches(tool->query, local, tool->reach)
                               : pel_solid_distance(&tool->solid, local, normal) <= tool->reach;
}

static void hold(pel_sim *sim, pel_tool *tool, int32_t v, const double anchor[3])
{
    sim->held[v] = 1;
    sim->state->position[v][3] = 0;
    pel_vec3_copy(anchor, tool->anchors[tool->held_count]);
    tool->held[tool->held_count++] = v;
}

/* what holds a vertex of a rigid body holds all of it */
static void hold_rigid_body(pel_sim *sim, pel_tool *tool, pel_rigid *rigid, const pel_record *positions)
{
    const pel_tool_path path =
        pel_tool_path_at(tool, positions == sim->state->position ? &tool->pose_before : &tool->pose);
    for (int32_t v = rigid->begin; v < rigid->end; v++) {
        double x[3], anchor[3];
        if (sim->held[v] || !(sim->model->inverse_mass[v] > 0))
            continue;
        pel_vertex_position(positions, v, x);
        pel_tool_path_anchor(&path, v, x, anchor);
        hold(sim, tool, v, anchor);
    }
}

static void hold_rigid_bodies(pel_sim *sim, pel_tool *tool, const pel_record *positions)
{
    for (int32_t i = 0, count = tool->held_count; sim->rigids != NULL && i < count; i++) {
        pel_rigid *rigid = pel_rigid_of(sim->rigids, tool->held[i]);
        if (rigid != NULL)
            hold_rigid_body(sim, tool, rigid, positions);
    }
}

static void grasp_body(pel_sim *sim, pel_tool *tool, int32_t body, const pel_record *positions)
{
    const pel_body *b = &sim->model->bodies[body];
    /* both of the start of the step, or of the substep that begins */
    const pel_pose *pose = positions == sim->state->position ? &tool->pose_before : &tool->pose;
    for (int32_t v = b->slice_begin * PEL_WIDTH; v < b->slice_end * PEL_WIDTH; v++) {
        double x[3], local[3];
        if (pel_tool_mobility(sim, v) <= 0)
            continue;
        pel_vertex_position(positions, v, x);
        pel_pose_to_local(pose, x, local);
        if (reaches(tool, local))
            hold(sim, tool, v, local);
    }
}

void pel_tool_let_go(pel_sim *sim, pel_tool *tool, int32_t i)
{
    sim->held[tool->held[i]] = 0;
    tool->held[i] = tool->held[--tool->held_count];
    pel_vec3_copy(tool->anchors[tool->held_count], tool->anchors[i]);
    sim->tools->held_is_listed = false;
}

static void release_one(pel_sim *sim, pel_tool *tool, int32_t i)
{
    int32_t v = tool->held[i];
    pel_tool_let_go(sim, tool, i);
    sim->state->position[v][3] = sim->model->inverse_mass[v];
}

/* held ones beside `IN_PATCH` ones in the triangles of the body become such too, until none is left */
enum { HELD = 1, IN_PATCH = 2 };

static void spread_patch(const pel_sim *sim, int32_t body)
{
    bool any = true;
    while (any) {
        any = false;
        for (int32_t i = 0; i < pel_surface_count(sim->model, body); i++) {
            const int32_t *v = sim->model->triangles[pel_surface_triangle(sim->model, body, i)];
            bool has_patch = sim->held[v[0]] == IN_PATCH || sim->held[v[1]] == IN_PATCH || sim->held[v[2]] == IN_PATCH;
            for (int c = 0; has_patch && c < 3; c++)
                if (sim->held[v[c]] == HELD) {
                    sim->held[v[c]] = IN_PATCH;
                    any = true;
                }
        }
    }
}

/* keeps those of the held vertices that edges join to one of them */
static void keep_patch(pel_sim *sim, pel_tool *tool, int32_t seed)
{
    int32_t kept = 0;
    sim->held[seed] = IN_PATCH;
    spread_patch(sim, sim->model->body_of_slice[seed / PEL_WIDTH]);
    while (kept < tool->held_count)
        if (sim->held[tool->held[kept]] == IN_PATCH)
            kept++;
        else
            release_one(sim, tool, kept);
    /* of other tools too, through which the patch has spread */
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        if (sim->held[v] == IN_PATCH)
            sim->held[v] = HELD;
}

static void keep_nearest_patch(pel_sim *sim, pel_tool *tool)
{
    int32_t nearest = 0;
    for (int32_t i = 1; i < tool->held_count; i++)
        if (pel_vec3_length(tool->anchors[i]) < pel_vec3_length(tool->anchors[nearest]))
            nearest = i;
    if (tool->held_count > 0)
        keep_patch(sim, tool, tool->held[nearest]);
}

static void grasp_bodies(pel_sim *sim, pel_tool *tool, const pel_record *positions)
{
    for (int32_t b = 0; b < sim->model->body_count; b++)
        if (pel_tool_acts_on(tool, b))
            grasp_body(sim, tool, b, positions);
    if (tool->one_patch)
        keep_nearest_patch(sim, tool);
    hold_rigid_bodies(sim, tool, positions);
}

void pel_tool_hold_at_rest(pel_sim *sim, pel_tool *tool, int32_t v)
{
    PEL_ASSERT_INDEX(v, sim->model->vertex_count);
    double rest[3];
    if (sim->held[v])
        return;
    sim->held[v] = 1;
    sim->tools->held_is_listed = false;
    sim->state->position[v][3] = 0;
    pel_vertex_position(sim->model->rest, v, rest);
    pel_vec3_subtract(rest, tool->center, tool->anchors[tool->held_count]);
    if (tool->sequence != NULL)
        pel_vec3_set(tool->anchors[tool->held_count], 0, 0, 0);
    tool->held[tool->held_count++] = v;
}

/* A support that begins later holds its vertices where they are by then. */
static void hold_in_place(pel_sim *sim, pel_tool *tool, int32_t v, const pel_record *positions)
{
    const pel_tool_path path =
        pel_tool_path_at(tool, positions == sim->state->position ? &tool->pose_before : &tool->pose);
    double x[3];
    if (sim->held[v])
        return;
    pel_tool_hold_at_rest(sim, tool, v);
    pel_vertex_position(positions, v, x);
    pel_tool_path_anchor(&path, v, x, tool->anchors[tool->held_count - 1]);
}

/* the vertices that were given, and those between them where the body is refined already */
static void hold_support(pel_sim *sim, pel_tool *tool, const pel_record *positions)
{
    for (int32_t i = 0; i < tool->support_count; i++)
        if (tool->grasp_from > 0)
            hold_in_place(sim, tool, tool->support[i], positions);
        else
            pel_tool_hold_at_rest(sim, tool, tool->support[i]);
    hold_rigid_bodies(sim, tool, positions);
    if (tool->support_marks == NULL)
        return;
    const pel_refined_body *own = &sim->active->bodies[tool->body];
    for (int32_t v = own->fine_begin; v < own->fine_end; v++)
        if (sim->model->mesh_vertex[v] >= 0 && tool->support_marks[sim->model->mesh_vertex[v]])
            pel_tool_hold_at_rest(sim, tool, v);
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

/* true if the held vertices change */
bool pel_tool_update_grasp(pel_sim *sim, pel_tool *tool, double time, const pel_record *positions)
{
    bool changed = false;
    if (!tool->grasp)
        return false;
    if (tool->phase == PEL_GRASP_WAITING && time >= tool->grasp_from) {
        tool->phase = PEL_GRASP_HOLDING;
        if (tool->support == NULL)
            grasp_bodies(sim, tool, positions);
        else
            hold_support(sim, tool, positions);
        changed = true;
    }
    if (tool->phase == PEL_GRASP_HOLDING && time >= tool->grasp_until) {
        tool->phase = PEL_GRASP_DONE;
        release(sim, tool);
        changed = true;
    }
    return changed;
}

void pel_tool_take_patch(pel_sim *sim, pel_tool *tool, int32_t v)
{
    release(sim, tool);
    pel_vertex_position(sim->state->position, v, tool->pose.position);
    tool->pose_before = tool->driven_pose = tool->pose;
    grasp_body(sim, tool, sim->model->body_of_slice[v / PEL_WIDTH], sim->state->position);
    if (sim->held[v])
        keep_patch(sim, tool, v);
    hold_rigid_bodies(sim, tool, sim->state->position);
    sim->tools->held_is_listed = false;
    sim->state->older_is_known = false;
}

/* lists holders and held vertices, for methods that need them in every substep */
void pel_tools_list_held(pel_sim *sim)
{
    int32_t count = 0;
    for (int32_t i = 0; i < sim->tools->count; i++)
        for (int32_t k = 0; k < sim->tools->items[i].held_count; k++)
            sim->tools->held_vertices[count++] = sim->tools->items[i].held[k];
    sim->tools->boundary = (pel_boundary){count > 0 ? sim->held : NULL, sim->tools->held_vertices,
                                          (const double(*)[3])sim->tools->held_targets, count};
    if (sim->stepper->follow_held != NULL)
        sim->stepper->follow_held(sim);
}

/* ---- carrying ---- */

/* m/s, the mean of the step */
static void carried_velocity(const pel_sim *sim, const pel_tool_path *before, int32_t i, const double target[3],
                             double velocity[3])
{
    if (before->tool->sequence == NULL && before->tool->blade == NULL) {
        pel_tool_velocity(before->tool, target, sim->step.dt, velocity);
        return;
    }
    double start[3];
    pel_tool_path_target(before, i, start);
    pel_vec3_subtract(target, start, velocity);
    pel_vec3_scale(velocity, 1 / sim->step.dt, velocity);
}

/* held vertices go where the tool takes them */
static void carry(pel_sim *sim, pel_tool *tool)
{
    pel_state *state = sim->state;
    const pel_tool_path before = pel_tool_path_at(tool, &tool->pose_before), path = pel_tool_path_at(tool, &tool->pose);
    for (int32_t i = 0; i < tool->held_count; i++) {
        int32_t v = tool->held[i];
        double target[3], velocity[3], change[3];
        pel_tool_path_target(&path, i, target);
        for (int c = 0; c < 3; c++)
            state->position_next[v][c] = (pel_real)target[c];
        pel_tool_touch(tool, v);
        if (state->velocity_next == NULL)
            continue;
        carried_velocity(sim, &before, i, target, velocity);
        for (int c = 0; c < 3; c++) {
            change[c] = velocity[c] - (double)state->velocity_next[v][c];
            state->velocity_next[v][c] = (pel_real)velocity[c];
        }
        pel_vec3_scale(change, -(double)sim->model->mass[v] / sim->step.dt, change);
        /* minimisations and projections have no new velocities yet, and read the grip where they end */
        if (!sim->stepper->moves_tools || sim->stepper->is_explicit)
            pel_tool_add_grip(sim, tool, v, target, change);
        /* contacts on it push against the tool (reading.c) */
        state->position_next[v][3] = 0;
    }
}

void pel_tools_carry(pel_sim *sim)
{
    for (int32_t i = 0; i < sim->tools->count; i++)
        carry(sim, &sim->tools->items[i]);
}

/* ---- the end of a step ---- */

static double grip_force(const pel_sim *sim, const pel_tool *tool, int32_t i)
{
    return pel_vec3_length(sim->tools->grip_forces[tool->held[i]]);
}

/* of equal forces the first in the list */
static int32_t find_largest(const pel_sim *sim, const pel_tool *tool)
{
    int32_t largest = 0;
    for (int32_t i = 1; i < tool->held_count; i++)
        if (grip_force(sim, tool, i) > grip_force(sim, tool, largest))
            largest = i;
    return largest;
}

static bool has_own_limit(const pel_sim *sim, const pel_tool *tool)
{
    return tool->support == NULL && !(tool->grasp_max_force > 0) && pel_stepper_knows_material(sim->stepper);
}

/* N, of a held vertex in the step that was accepted: it follows the tool, whose velocity may jump */
static double inertia(const pel_sim *sim, int32_t v)
{
    const pel_state *state = sim->state;
    double now[3], before[3];
    if (state->velocity == NULL)
        return 0;
    pel_vertex_position(state->velocity, v, now);
    pel_vertex_position(state->velocity_next, v, before);
    return (double)sim->model->mass[v] * pel_vec3_distance(now, before) / sim->step.dt;
}

/* N, the largest sum of forces on held vertices */
static double grip_limit(const pel_sim *sim, const pel_tool *tool)
{
    double sum = 0, load = 0;
    for (int32_t i = 0; has_own_limit(sim, tool) && i < tool->held_count; i++) {
        sum += sim->tools->strengths[sim->model->body_of_slice[tool->held[i] / PEL_WIDTH]];
        load += inertia(sim, tool->held[i]);
    }
    if (sum > 0)
        return GRIP_STRENGTH * sum + load;
    return tool->grasp_max_force > 0 ? tool->grasp_max_force : (double)HUGE_VAL;
}

/* lost vertices move freely from the next step on */
static int32_t lose_vertices(pel_sim *sim, pel_tool *tool, double limit)
{
    int32_t lost_count = 0;
    double sum = 0;
    for (int32_t i = 0; i < tool->held_count; i++)
        sum += grip_force(sim, tool, i);
    while (sum > limit && tool->held_count > 0) {
        int32_t i = find_largest(sim, tool);
        sum -= grip_force(sim, tool, i);
        release_one(sim, tool, i);
        lost_count++;
    }
    return lost_count;
}

/* each vertex by itself */
static int32_t lose_weak(pel_sim *sim, pel_tool *tool)
{
    int32_t kept = 0, lost_count = 0;
    while (kept < tool->held_count)
        if (grip_force(sim, tool, kept) > tool->strength) {
            release_one(sim, tool, kept);
            lost_count++;
        } else {
            kept++;
        }
    return lost_count;
}

static bool is_partly_held(const pel_sim *sim, const pel_rigid *rigid)
{
    bool is_held = false, is_loose = false;
    for (int32_t v = rigid->begin; v < rigid->end; v++) {
        is_held |= sim->held[v];
        is_loose |= !sim->held[v] && sim->model->inverse_mass[v] > 0;
    }
    return is_held && is_loose;
}

/* what loses a vertex of a rigid body loses all of it */
static void lose_rigid_bodies(pel_sim *sim, pel_tool *tool)
{
    for (int32_t i = 0; sim->rigids != NULL && i < sim->rigids->count; i++) {
        const pel_rigid *rigid = &sim->rigids->items[i];
        if (!is_partly_held(sim, rigid))
            continue;
        for (int32_t k = tool->held_count - 1; k >= 0; k--)
            if (tool->held[k] >= rigid->begin && tool->held[k] < rigid->end)
                release_one(sim, tool, k);
    }
}

static void count_loss(pel_tool_tally *tally, int32_t count, double time, double limit)
{
    if (tally->lost_count == 0) {
        tally->lost_time = time;
        tally->lost_limit = limit;
    }
    tally->lost_count += count;
}

static void lose_above_limit(pel_sim *sim, pel_tool *tool, double time)
{
    bool is_stuck = tool->stride < PEL_STUCK_STRIDE && has_own_limit(sim, tool);
    double limit = is_stuck ? 0 : grip_limit(sim, tool);
    if (is_stuck)
        tool->stride = 1;
    int32_t count = isfinite(limit) && !is_stuck ? lose_vertices(sim, tool, limit) : 0;
    for (; is_stuck && tool->held_count > 0; count++)
        release_one(sim, tool, 0);
    if (isfinite(tool->strength)) {
        limit = tool->strength;
        count = lose_weak(sim, tool);
    }
    if (count > 0) {
        lose_rigid_bodies(sim, tool);
        count_loss(&tool->tally, count, time, limit);
    }
}

static void count_hold(pel_tool_tally *tally, double time)
{
    if (tally->held_back_count == 0)
        tally->held_back_time = time;
    tally->held_back_count++;
}

/* count a shortened stride as held back, and double it if the guard did not act; halve that of a grasp that is stuck */
static void follow_stride(pel_tool *tool)
{
    tool->is_stopped = tool->is_held_back || tool->is_doubtful;
    if (!(tool->stride < 1))
        return;
    bool is_slow = tool->stride <= PEL_LEAST_STRIDE && tool->stride >= PEL_STUCK_STRIDE;
    if (tool->is_held_back && is_slow && tool->support == NULL && tool->held_count > 0)
        tool->stride /= 2;
    if (!tool->is_held_back)
        tool->stride = pel_min(2 * tool->stride, 1);
    tool->is_held_back = tool->blocked = true;
}

void pel_tools_end_step(pel_sim *sim, double time)
{
    for (int32_t t = 0; t < sim->tools->count; t++) {
        pel_tool *tool = &sim->tools->items[t];
        follow_stride(tool);
        if (tool->held_count > 0)
            lose_above_limit(sim, tool, time);
        if (tool->is_held_back && !tool->hold_is_counted)
            count_hold(&tool->tally, time);
        tool->hold_is_counted |= tool->is_held_back;
        if (tool->blocked && !tool->is_held_back) {
            pel_pose wanted = pel_tool_pose_at(tool, time);
            tool->blocked = pel_tool_way(tool, &tool->pose, &wanted) > 0;
        }
    }
}

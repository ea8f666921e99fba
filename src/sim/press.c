/* Pressing keeps whole triangles out of a tool, not only vertices: each triangle near the tool is pushed out at its
   deepest point p = sum b_i x_i by x_i += w_i b_i / (sum w b^2) depth n, triangle after triangle until none is deeper
   than the tolerance. Vertices come first, which settles most of it.

   A quasi-static step may spring back farther than a small tool is thick, and the triangle would come out on the other
   side. So the half space of each contact is kept for one step: what has gone deep behind it is brought back. */
#include "base/sort.h"
#include "sim/tool.h"

/* sweeps over the near triangles at most */
enum { SWEEP_LIMIT = 100 };
/* depth that counts as touching, relative to the tool's size */
#define DEPTH_TOLERANCE 1e-5

/* half sizes of the world-aligned box about the tool */
static void world_half_box(const pel_tool *tool, double half[3])
{
    double local[3], axis[3];
    pel_solid_half_box(&tool->press_solid, local);
    pel_vec3_set(half, 0, 0, 0);
    for (int i = 0; i < 3; i++) {
        pel_vec3_set(axis, i == 0 ? local[0] : 0, i == 1 ? local[1] : 0, i == 2 ? local[2] : 0);
        pel_rotate(tool->pose.rotation, axis, axis);
        for (int j = 0; j < 3; j++)
            half[j] += fabs(axis[j]);
    }
}

static int32_t add_near_triangle(pel_sim *sim, int32_t t, int32_t count)
{
    if (sim->triangle_marks[t])
        return count;
    sim->triangle_marks[t] = 1;
    sim->near_triangles[count] = t;
    return count + 1;
}

/* the triangles at a vertex of a body that refines; none where the place is not in use */
static int32_t add_front_fan(pel_sim *sim, int32_t place, int32_t count)
{
    pel_active *active = sim->active;
    int32_t body = sim->model->body_of_slice[place / PEL_WIDTH], v = sim->model->mesh_vertex[place];
    if (v < 0)
        return count;
    int32_t corner_count = pel_front_fan(active->bodies[body].front, v, active->fan);
    for (int32_t i = 0; i < corner_count; i++)
        count = add_near_triangle(sim, sim->model->triangle_begin[body] + 2 * active->fan[i].node + active->fan[i].half,
                                  count);
    return count;
}

/* lists the triangles with a vertex within `reach` of the tool's box; a triangle that overlaps the tool has all its
   vertices within its longest edge of it. In rising order: the sweeps depend on the order, which must not change when a
   triangle that does not touch comes near or goes */
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
    int32_t count = 0, end = pel_tool_end_vertex(sim, tool->body);
    for (int32_t v = pel_tool_first_vertex(sim, tool->body); v < end; v++) {
        const pel_record x = positions[v];
        if (x[0] < low[0] || x[0] > high[0] || x[1] < low[1] || x[1] > high[1] || x[2] < low[2] || x[2] > high[2])
            continue;
        if (sim->active != NULL && model->bodies[model->body_of_slice[v / PEL_WIDTH]].front != NULL) {
            count = add_front_fan(sim, v, count);
            continue;
        }
        for (int32_t f = model->fan_begin[v]; f < model->fan_begin[v + 1]; f++)
            count = add_near_triangle(sim, model->fans[f], count);
    }
    for (int32_t i = 0; i < count; i++)
        sim->triangle_marks[sim->near_triangles[i]] = 0;
    pel_sort_int32(sim->near_triangles, count);
    return count;
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
        pel_vertex_position(sim->state->position_next, at->vertices[c], x);
        pel_vec3_along(point, at->weights[c], x, point);
        pel_vertex_position(sim->state->velocity_next, at->vertices[c], x);
        pel_vec3_along(relative, at->weights[c], x, relative);
    }
    pel_tool_velocity(tool, point, sim->step.dt, moving);
    pel_vec3_subtract(relative, moving, relative);
    double approach = -pel_vec3_dot(relative, normal);
    if (approach <= 0)
        return;
    double impulse = approach / inertia, force[3];
    for (int c = 0; c < at->count; c++) {
        int32_t v = at->vertices[c];
        record_add(&sim->state->velocity_next[v], impulse * at->weights[c] * pel_tool_mobility(sim, v), normal);
    }
    pel_vec3_scale(normal, -impulse / sim->step.dt, force);
    pel_tool_add_reaction(tool, point, force);
}

/* moves the vertices so that the point goes `depth` along the normal; false when none of them can move */
static bool push_point(pel_sim *sim, pel_tool *tool, const surface_point *at, double depth, const double normal[3])
{
    double inertia = 0;
    for (int c = 0; c < at->count; c++)
        inertia += pel_tool_mobility(sim, at->vertices[c]) * at->weights[c] * at->weights[c];
    if (inertia <= 0)
        return false;
    for (int c = 0; c < at->count; c++) {
        int32_t v = at->vertices[c];
        double share = pel_tool_mobility(sim, v) * at->weights[c] / inertia * depth;
        if (share <= 0)
            continue;
        record_add(&sim->state->position_next[v], share, normal);
        pel_touch *touch = pel_tool_touch(tool, v);
        pel_vec3_along(touch->push, share, normal, touch->push);
    }
    if (sim->state->velocity_next != NULL)
        stop_point(sim, tool, at, normal, inertia);
    return true;
}

/* point of a triangle in the tool's frame */
static void local_point(const pel_sim *sim, const pel_tool *tool, int32_t t, const double weights[3], double point[3])
{
    double x[3];
    pel_vec3_set(point, 0, 0, 0);
    for (int c = 0; c < 3; c++) {
        pel_vertex_position(sim->state->position_next, sim->model->triangles[t][c], x);
        pel_vec3_along(point, weights[c], x, point);
    }
    pel_pose_to_local(&tool->pose, point, point);
}

double pel_tool_triangle_depth(const pel_sim *sim, const pel_tool *tool, const pel_solid *solid,
                               const pel_record *positions, int32_t t, double weights[3], double normal[3])
{
    double world[3], corner[3][3];
    for (int c = 0; c < 3; c++) {
        pel_vertex_position(positions, sim->model->triangles[t][c], world);
        pel_pose_to_local(&tool->pose, world, corner[c]);
    }
    return pel_solid_depth(solid, corner[0], corner[1], corner[2], weights, normal);
}

/* keeps the half space in which a triangle has to stay; the latest one of a triangle counts */
static void remember_plane(const pel_sim *sim, pel_tool *tool, const pel_plane *plane)
{
    int32_t place = sim->plane_of_triangle[plane->triangle] - 1;
    if (place < 0) {
        if (tool->plane_count == PEL_PLANE_LIMIT)
            return;
        place = tool->plane_count++;
        sim->plane_of_triangle[plane->triangle] = place + 1;
    }
    tool->planes[place] = *plane;
}

/* pushes a point of a triangle that is `depth` in the tool out along the normal, given in the tool's frame */
static bool push_triangle(pel_sim *sim, pel_tool *tool, int32_t t, const double weights[3], double depth,
                          const double normal[3])
{
    double point[3], way[3];
    local_point(sim, tool, t, weights, point);
    pel_plane plane = {.triangle = t, .offset = pel_vec3_dot(normal, point) + depth};
    pel_vec3_copy(weights, plane.weights);
    pel_vec3_copy(normal, plane.normal);
    remember_plane(sim, tool, &plane);
    pel_rotate(tool->pose.rotation, normal, way);
    return push_point(sim, tool, &(surface_point){sim->model->triangles[t], weights, 3}, depth, way);
}

static bool press_corner(pel_sim *sim, pel_tool *tool, int32_t t, int corner, double tolerance)
{
    double x[3], local[3], normal[3];
    pel_vertex_position(sim->state->position_next, sim->model->triangles[t][corner], x);
    pel_pose_to_local(&tool->pose, x, local);
    double depth = -pel_solid_distance(&tool->press_solid, local, normal);
    if (depth <= tolerance)
        return false;
    const double weights[3] = {corner == 0, corner == 1, corner == 2};
    return push_triangle(sim, tool, t, weights, depth, normal);
}

static bool press_triangle(pel_sim *sim, pel_tool *tool, int32_t t, double tolerance)
{
    double weights[3], normal[3];
    double depth =
        pel_tool_triangle_depth(sim, tool, &tool->press_solid, sim->state->position_next, t, weights, normal);
    return depth > tolerance && push_triangle(sim, tool, t, weights, depth, normal);
}

/* with contact the solid is grown by the thickness, most of which is to be kept */
static double press_tolerance(const pel_sim *sim, const pel_tool *tool)
{
    double tolerance = DEPTH_TOLERANCE * pel_tool_size(tool), thickness = pel_sim_contact_thickness(sim);
    return thickness > 0 ? fmin(tolerance, 0.1 * thickness) : tolerance;
}

/* corners first, then whole triangles until none is deep */
static bool press_out(pel_sim *sim, pel_tool *tool, int32_t near_count)
{
    double tolerance = press_tolerance(sim, tool);
    bool moved = false, again = true;
    for (int32_t i = 0; i < near_count; i++)
        for (int c = 0; c < 3; c++)
            moved |= press_corner(sim, tool, sim->near_triangles[i], c, tolerance);
    for (int sweep = 0; again && sweep < SWEEP_LIMIT; sweep++) {
        again = false;
        for (int32_t i = 0; i < near_count; i++)
            again |= press_triangle(sim, tool, sim->near_triangles[i], tolerance);
        moved |= again;
    }
    return moved;
}

/* brings back what has gone through the tool since the last step: a point that lies behind its plane by more than half
   the thickness of the tool was pushed out on the wrong side */
static bool bring_back(pel_sim *sim, pel_tool *tool)
{
    double half[3];
    pel_solid_half_box(&tool->solid, half);
    double limit = 0.5 * fmin(half[0], fmin(half[1], half[2]));
    bool moved = false;
    for (int32_t p = 0; p < tool->plane_before_count; p++) {
        const pel_plane *plane = &tool->planes_before[p];
        double point[3], way[3];
        local_point(sim, tool, (int32_t)plane->triangle, plane->weights, point);
        double depth = plane->offset - pel_vec3_dot(plane->normal, point);
        if (depth <= limit)
            continue;
        pel_rotate(tool->pose.rotation, plane->normal, way);
        remember_plane(sim, tool, plane);
        moved |= push_point(sim, tool, &(surface_point){sim->model->triangles[plane->triangle], plane->weights, 3},
                            depth, way);
    }
    return moved;
}

bool pel_tool_press(pel_sim *sim, pel_tool *tool, double longest)
{
    int32_t near_count = find_near_triangles(sim, tool, sim->state->position_next, 1.25 * longest);
    for (int32_t p = 0; p < tool->plane_count; p++)
        sim->plane_of_triangle[tool->planes[p].triangle] = p + 1;
    bool moved = press_out(sim, tool, near_count);
    if (bring_back(sim, tool))
        moved |= press_out(sim, tool, near_count);
    for (int32_t p = 0; p < tool->plane_count; p++)
        sim->plane_of_triangle[tool->planes[p].triangle] = 0;
    return moved;
}

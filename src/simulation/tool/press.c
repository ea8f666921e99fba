/* Pressing keeps whole triangles out of a tool (on filled tissue, out of a smaller one: sagitta.c), not only
   vertices: each triangle near the tool is pushed out at its deepest point p = sum b_i x_i by
   x_i += w_i b_i / (sum w b^2) depth n, triangle after triangle until none is deeper than the tolerance. Vertices come
   first, which settles most of it.

   A quasi-static step may spring back farther than a small tool is thick, and the triangle would come out on the other
   side. So the half space of each contact is kept for one step: triangles deep behind it are brought back.

   Friction, with contact: each push by a distance d reverts up to friction times d of the point's tangential
   displacement since the start of the step, relative to the tool; velocities likewise, by the impulse. The sums obey
   Coulomb's law because each push does.

   Under the explicit method impulses stop what moves into the tool first (stop.c); what is left here is depth. */
#include "tool/press.h"

#include "base/assert.h"
#include "base/lane.h"
#include "contact/set.h"
#include "math/extremes.h"
#include "rigid/sum.h"
#include "tool/contact_force.h"
#include "tool/near.h"
#include "tool/sagitta.h"
#include "tool/stop.h"

#include <string.h>

/* sweeps over the near triangles at most */
enum { SWEEP_LIMIT = 100 };
/* depth that counts as touching, relative to the tool's size */
#define DEPTH_TOLERANCE 1e-5
/* triangles this near to the tool's box, relative to the longest edge, may be pushed into it during a step */
#define NEAR_MARGIN 0.25
/* share of a point that vertices which can move have at least, where these carry it */
#define LEAST_FREE 0.1

static void record_add(pel_record *record, double scale, const double a[3])
{
    for (int i = 0; i < 3; i++)
        (*record)[i] += (pel_real)(scale * a[i]);
}

/* a point of the surface: three vertices with weights */
typedef struct surface_point {
    const int32_t *vertices;
    const double *weights;
} surface_point;

void pel_tool_point(const pel_record *values, const int32_t vertices[3], const double weights[3], double point[3])
{
    double x[3];
    pel_vec3_set(point, 0, 0, 0);
    for (int c = 0; c < 3; c++) {
        pel_vertex_position(values, vertices[c], x);
        pel_vec3_along(point, weights[c], x, point);
    }
}

pel_solid pel_tool_press_solid(const pel_sim *sim, const pel_tool *tool, int32_t v)
{
    PEL_ASSERT_INDEX(v, sim->model->vertex_count);
    if (sim->contacts == NULL)
        return tool->solid;
    int32_t group = sim->model->body_count + (int32_t)(tool - sim->tools->items);
    return pel_solid_grown(&tool->solid,
                           pel_contact_thickness(sim->contacts, sim->model->body_of_slice[v / PEL_WIDTH], group));
}

double pel_sim_friction(const pel_sim *sim, const pel_tool *tool, int32_t v)
{
    PEL_ASSERT_INDEX(v, sim->model->vertex_count);
    if (sim->contacts == NULL)
        return 0;
    return pel_contact_friction(sim->contacts, sim->model->body_of_slice[v / PEL_WIDTH],
                                sim->model->body_count + (int32_t)(tool - sim->tools->items));
}

/* the component of a vector across the unit normal, reversed and at most `limit` long; false if it is zero */
static bool oppose_across(const double vector[3], const double normal[3], double limit, double back[3])
{
    pel_vec3_along(vector, -pel_vec3_dot(vector, normal), normal, back);
    double length = pel_vec3_length(back);
    if (!(length > 0) || !(limit > 0))
        return false;
    pel_vec3_scale(back, -pel_min(1, limit / length), back);
    return true;
}

static void change_velocity(pel_sim *sim, const surface_point *at, double impulse, const double direction[3])
{
    for (int c = 0; c < 3; c++) {
        int32_t v = at->vertices[c];
        record_add(&sim->state->velocity_next[v], impulse * at->weights[c] * pel_tool_mobility(sim, v), direction);
    }
}

/* projection and implicit steps: removes the velocity of the point into the tool, and records the impulse */
static void stop_point(pel_sim *sim, pel_tool *tool, const surface_point *at, const double normal[3], double inertia)
{
    double point[3], relative[3], moving[3];
    pel_tool_point(sim->state->position_next, at->vertices, at->weights, point);
    pel_tool_point(sim->state->velocity_next, at->vertices, at->weights, relative);
    pel_tool_velocity(tool, point, sim->step.dt, moving);
    pel_vec3_subtract(relative, moving, relative);
    double approach = -pel_vec3_dot(relative, normal);
    if (approach <= 0)
        return;
    double impulse = approach / inertia, back[3], force[3];
    const int32_t vertices[4] = {at->vertices[0], at->vertices[1], at->vertices[2], at->vertices[0]};
    pel_contact_action action = {.vertices = vertices, .obstacle = (int32_t)(tool - sim->tools->items)};
    memcpy(action.weights, at->weights, 3 * sizeof *action.weights);
    change_velocity(sim, at, impulse, normal);
    pel_vec3_scale(normal, impulse / sim->step.dt, action.load);
    pel_vec3_copy(action.load, action.force);
    if (oppose_across(relative, normal, pel_sim_friction(sim, tool, at->vertices[0]) * approach, back)) {
        change_velocity(sim, at, 1 / inertia, back);
        pel_vec3_along(action.force, 1 / (inertia * sim->step.dt), back, action.force);
    }
    pel_contact_act(sim, &action);
    pel_vec3_scale(action.force, -1, force);
    pel_tool_add_reaction(tool, point, force);
}

/* reverts the point's displacement along the tool in this step, as far as friction of a push by `depth` allows */
static void rub_point(pel_sim *sim, const pel_tool *tool, const surface_point *at, double depth, const double normal[3],
                      double inertia)
{
    double now[3], start[3], local[3], slip[3], back[3];
    pel_tool_point(sim->state->position_next, at->vertices, at->weights, now);
    pel_tool_point(sim->state->position, at->vertices, at->weights, start);
    /* where the tool's point that is now there was when the step began */
    pel_pose_to_local(&tool->pose, now, local);
    pel_pose_to_world(&tool->pose_before, local, slip);
    pel_vec3_subtract(slip, start, slip);
    if (!oppose_across(slip, normal, pel_sim_friction(sim, tool, at->vertices[0]) * depth, back))
        return;
    for (int c = 0; c < 3; c++) {
        int32_t v = at->vertices[c];
        record_add(&sim->state->position_next[v], pel_tool_mobility(sim, v) * at->weights[c] / inertia, back);
    }
}

/* the same of a rigid body in motion, which goes as a whole; its velocity loses the approach */
static bool push_rigid(pel_sim *sim, pel_tool *tool, const surface_point *at, double depth, const double normal[3])
{
    pel_rigid *rigid = pel_rigid_of(sim->rigids, at->vertices[0]);
    pel_rigid_sum sum;
    double push[3], point[3], speed[3], tool_speed[3];
    pel_rigid_sum_set(&sum, sim->rigids, at->vertices, at->weights, 3, sim->state->position_next);
    double free = pel_rigid_sum_mobility(&sum, normal);
    if (free <= 0)
        return false;
    sim->rigids->rate = 0;
    pel_vec3_scale(normal, depth / free, push);
    pel_rigid_sum_push(&sum, sim->rigids, sim->state->position_next, push);
    pel_vec3_along(sum.value, depth, normal, point);
    pel_tool_velocity(tool, point, sim->step.dt, tool_speed);
    pel_rigid_sum_velocity(&sum, sim->rigids, sim->state->velocity_next, speed);
    pel_vec3_subtract(speed, tool_speed, speed);
    double approach = -pel_vec3_dot(speed, normal);
    pel_vec3_scale(normal, approach > 0 ? approach / free : 0, push);
    pel_rigid_sum_hit(&sum, sim->rigids, sim->state->position_next, sim->state->velocity_next, push);
    pel_rigids_place(sim->rigids, sim->state->position_next);
    pel_rigid_place_velocities(rigid, sim->rigids, sim->state->position_next, sim->state->velocity_next);
    sim->tools->push_count++;
    for (int32_t v = rigid->begin; v < rigid->end; v++)
        sim->tools->moved_at[v] = sim->tools->push_count;
    pel_vec3_scale(push, -1 / sim->step.dt, push);
    pel_tool_add_reaction(tool, point, push);
    for (int c = 0; c < 3; c++)
        pel_tool_touch(tool, at->vertices[c]);
    return true;
}

double pel_tool_inertia(const pel_sim *sim, const int32_t vertices[3], const double weights[3])
{
    double inertia = 0, carried = 0;
    for (int c = 0; c < 3; c++) {
        const double mobility = pel_tool_mobility(sim, vertices[c]);
        inertia += mobility * weights[c] * weights[c];
        carried += mobility > 0 ? weights[c] : 0;
    }
    return carried < LEAST_FREE ? 0 : inertia;
}

/* moves the vertices so that the point goes `depth` along the normal; false when none of them can move */
static bool push_point(pel_sim *sim, pel_tool *tool, const surface_point *at, double depth, const double normal[3])
{
    if (pel_rigid_of(sim->rigids, at->vertices[0]) != NULL)
        return pel_sim_has_velocity(sim) && push_rigid(sim, tool, at, depth, normal);
    const double inertia = pel_tool_inertia(sim, at->vertices, at->weights);
    if (inertia <= 0)
        return false;
    for (int c = 0; c < 3; c++) {
        int32_t v = at->vertices[c];
        double share = pel_tool_mobility(sim, v) * at->weights[c] / inertia * depth;
        if (share <= 0)
            continue;
        record_add(&sim->state->position_next[v], share, normal);
        sim->tools->moved_at[v] = ++sim->tools->push_count;
        pel_contact_vertex *touch = pel_tool_touch(tool, v);
        pel_vec3_along(touch->push, share, normal, touch->push);
    }
    if (pel_sim_friction(sim, tool, at->vertices[0]) > 0)
        rub_point(sim, tool, at, depth, normal, inertia);
    if (sim->state->velocity_next != NULL && !sim->stepper->is_explicit)
        stop_point(sim, tool, at, normal, inertia);
    return true;
}

/* point of a triangle in the tool's frame */
static void local_point(const pel_sim *sim, const pel_tool *tool, int32_t t, const double weights[3], double point[3])
{
    pel_tool_point(sim->state->position_next, sim->model->triangles[t], weights, point);
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

void pel_tool_remember(const pel_sim *sim, pel_tool *tool, const pel_contact_plane *plane)
{
    int32_t place = sim->tools->plane_of_triangle[plane->triangle] - 1;
    if (place < 0) {
        if (tool->plane_count == PEL_PLANE_LIMIT)
            return;
        place = tool->plane_count++;
        sim->tools->plane_of_triangle[plane->triangle] = place + 1;
    }
    tool->planes[place] = *plane;
}

/* pushes a point of a triangle that is `depth` in the tool out along the normal, given in the tool's frame */
static bool push_triangle(pel_sim *sim, pel_tool *tool, int32_t t, const double weights[3], double depth,
                          const double normal[3])
{
    double point[3], way[3];
    local_point(sim, tool, t, weights, point);
    pel_contact_plane plane = {.triangle = t, .offset = pel_vec3_dot(normal, point) + depth};
    pel_vec3_copy(weights, plane.weights);
    pel_vec3_copy(normal, plane.normal);
    pel_tool_remember(sim, tool, &plane);
    pel_rotate(tool->pose.rotation, normal, way);
    return push_point(sim, tool, &(surface_point){sim->model->triangles[t], weights}, depth, way);
}

static bool press_corner(pel_sim *sim, pel_tool *tool, int32_t t, int corner, double tolerance)
{
    double x[3], local[3], normal[3];
    pel_vertex_position(sim->state->position_next, sim->model->triangles[t][corner], x);
    pel_pose_to_local(&tool->pose, x, local);
    const pel_solid solid = pel_tool_press_solid(sim, tool, sim->model->triangles[t][corner]);
    double depth = -pel_solid_distance(&solid, local, normal);
    if (depth <= tolerance)
        return false;
    const double weights[3] = {corner == 0, corner == 1, corner == 2};
    return push_triangle(sim, tool, t, weights, depth, normal);
}

/* Without friction a corner that was looked at is out, and stays there while corners are pushed: once is enough. */
static bool is_done(pel_sim *sim, const pel_tool *tool, int32_t v)
{
    PEL_ASSERT_INDEX(v, sim->model->vertex_count);
    bool done = sim->tools->cornered_at[v] == sim->tools->press_count && !(pel_sim_friction(sim, tool, v) > 0);
    sim->tools->cornered_at[v] = sim->tools->press_count;
    return done;
}

/* What a triangle that touches a tool reaches into, surely so: the box, and the sphere where the tool is one. */
typedef struct press_bounds {
    pel_search_box box;
    pel_record center;
    pel_real square; /* of the radius */
    bool is_sphere;
} press_bounds;

static press_bounds bounds_of(const pel_tool *tool, double longest)
{
    const double *x = tool->pose.position;
    double radius = 1.000001 * (tool->solid.radius + tool->press_margin);
    radius += 16 * (double)PEL_REAL_EPSILON * (fabs(x[0]) + fabs(x[1]) + fabs(x[2]) + radius + longest);
    press_bounds bounds = {.center = {(pel_real)x[0], (pel_real)x[1], (pel_real)x[2], 0},
                           .square = (pel_real)(radius * radius),
                           .is_sphere = pel_solid_is_ball(&tool->solid)};
    const pel_real half = (pel_real)radius;
    if (bounds.is_sphere)
        bounds.box = (pel_search_box){bounds.center - half, bounds.center + half};
    else
        bounds.box = pel_tool_box(tool, tool->press_margin, 0);
    return bounds;
}

/* of the three components of the vectors */
static inline pel_real dot(pel_record a, pel_record b)
{
    pel_record product = a * b;
    return product[0] + product[1] + product[2];
}

/* Whether a triangle, or a vertex three times, stays out of the bounds: of a sphere by its box, or by a plane across
   the direction of the middle of the triangle. */
static inline bool is_clear(const press_bounds *bounds, const pel_record *positions, const int32_t corners[3])
{
    const pel_search_box around = pel_search_triangle(positions, corners);
    if (pel_search_apart(&around, &bounds->box))
        return true;
    if (!bounds->is_sphere)
        return false;
    const pel_record a = positions[corners[0]] - bounds->center, b = positions[corners[1]] - bounds->center,
                     c = positions[corners[2]] - bounds->center, way = a + b + c;
    pel_real least = dot(way, a), second = dot(way, b), third = dot(way, c);
    pel_real square = least + second + third;
    least = second < least ? second : least;
    least = third < least ? third : least;
    return least > 0 && least * least > bounds->square * square;
}

static void press_corners(pel_sim *sim, pel_tool *tool, const press_bounds *bounds, int32_t t, double tolerance,
                          bool *moved)
{
    const int32_t *corners = sim->model->triangles[t];
    for (int c = 0; c < 3; c++) {
        const int32_t vertex[3] = {corners[c], corners[c], corners[c]};
        if (!is_done(sim, tool, corners[c]) && !is_clear(bounds, sim->state->position_next, vertex))
            *moved |= press_corner(sim, tool, t, c, tolerance);
    }
}

static bool press_triangle(pel_sim *sim, pel_tool *tool, int32_t t, double tolerance)
{
    double weights[3], normal[3];
    const pel_solid solid = pel_tool_triangle_solid(sim, tool, t);
    double depth = pel_tool_triangle_depth(sim, tool, &solid, sim->state->position_next, t, weights, normal);
    return depth > tolerance && push_triangle(sim, tool, t, weights, depth, normal);
}

/* with contact the solid is grown by the thickness, most of which must be kept */
double pel_tool_press_tolerance(const pel_sim *sim, const pel_tool *tool)
{
    double tolerance = DEPTH_TOLERANCE * pel_tool_size(tool);
    return sim->contacts != NULL ? pel_min(tolerance, 0.1 * sim->contacts->least) : tolerance;
}

/* One sweep over the near triangles. A triangle that was looked at since its corners moved last is as it was: moved_at
   (by vertex) and looked_at (by place in the list) count the pushes of this step. */
static bool sweep(pel_sim *sim, pel_tool *tool, const press_bounds *bounds, int32_t near_count, double tolerance)
{
    bool moved = false;
    for (int32_t i = 0; i < near_count; i++) {
        int32_t t = sim->tools->near_triangles[i];
        int64_t last = sim->tools->looked_at[i];
        if (last == sim->tools->push_count)
            continue;
        const int32_t *v = sim->model->triangles[t];
        if (sim->tools->moved_at[v[0]] <= last && sim->tools->moved_at[v[1]] <= last &&
            sim->tools->moved_at[v[2]] <= last)
            continue;
        sim->tools->looked_at[i] = sim->tools->push_count;
        moved |= !is_clear(bounds, sim->state->position_next, v) && press_triangle(sim, tool, t, tolerance);
    }
    return moved;
}

/* corners first, then whole triangles until none is deep */
static bool press_out(pel_sim *sim, pel_tool *tool, int32_t near_count, double longest)
{
    double tolerance = pel_tool_press_tolerance(sim, tool);
    const press_bounds bounds = bounds_of(tool, longest);
    bool moved = false, again = true;
    sim->tools->press_count++;
    for (int32_t i = 0; i < near_count; i++) {
        int32_t t = sim->tools->near_triangles[i];
        const int32_t *v = sim->model->triangles[t];
        sim->tools->looked_at[i] = sim->tools->push_count;
        if (is_clear(&bounds, sim->state->position_next, v))
            continue;
        /* resting points have to be pushed in every step, or they would creep against friction */
        double corner_tolerance = pel_sim_friction(sim, tool, v[0]) > 0 ? 0 : tolerance;
        press_corners(sim, tool, &bounds, t, corner_tolerance, &moved);
        sim->tools->looked_at[i] = -1;
    }
    for (int round = 0; again && round < SWEEP_LIMIT; round++) {
        again = sweep(sim, tool, &bounds, near_count, tolerance);
        moved |= again;
    }
    return moved;
}

/* brings back points that passed through the tool since the last step: a point that lies behind its plane by more than
   half the thickness of the tool was pushed out on the wrong side */
static bool bring_back(pel_sim *sim, pel_tool *tool)
{
    double half[3];
    pel_solid_half_box(&tool->solid, half);
    double limit = 0.5 * pel_min(half[0], pel_min(half[1], half[2]));
    bool moved = false;
    for (int32_t p = 0; p < tool->plane_before_count; p++) {
        const pel_contact_plane *plane = &tool->planes_before[p];
        double point[3], way[3];
        local_point(sim, tool, (int32_t)plane->triangle, plane->weights, point);
        double depth = plane->offset - pel_vec3_dot(plane->normal, point);
        if (depth <= limit)
            continue;
        pel_rotate(tool->pose.rotation, plane->normal, way);
        pel_tool_remember(sim, tool, plane);
        moved |=
            push_point(sim, tool, &(surface_point){sim->model->triangles[plane->triangle], plane->weights}, depth, way);
    }
    return moved;
}

bool pel_tool_press(pel_sim *sim, pel_tool *tool, double longest)
{
    int32_t near_count =
        pel_tool_near_triangles(sim, tool, &tool->near, sim->state->position_next, NEAR_MARGIN * longest);
    for (int32_t p = 0; p < tool->plane_count; p++)
        sim->tools->plane_of_triangle[tool->planes[p].triangle] = p + 1;
    bool moved = sim->stepper->is_explicit && pel_tool_stop(sim, tool, near_count);
    moved |= press_out(sim, tool, near_count, longest);
    if (bring_back(sim, tool))
        moved |= press_out(sim, tool, near_count, longest);
    for (int32_t p = 0; p < tool->plane_count; p++)
        sim->tools->plane_of_triangle[tool->planes[p].triangle] = 0;
    return moved;
}

/* The response of the explicit method to a tool: impulses that keep points of triangles out of it,

       x_i += w_i b_i d n / sum w b^2,    v_i += the same / dt,    d >= 0,    d (n . p - offset) = 0

   for the deepest point p = sum b_i x_i of each triangle and for its corners. Position and velocity change together, as
   the step x + dt v wants it, and the impulse d / (dt sum w b^2) over dt is the force: nothing is pushed that does not
   gain the velocity of it, so the mass of the pushed vertices is not felt.

   All points are solved together, in sweeps that may take back what an earlier one pushed: pushes that only add up lift
   neighbours off the tool, which fall back in the next step and make the force chatter. Friction opposes the slip along
   the tool since the start of the step, at most the coefficient times d.

   A point that was in the tool by a depth when the step began has to get no deeper, so that no depth becomes a
   velocity; pressing (press.c) moves it out. */
#include "tool/stop.h"

#include "base/assert.h"
#include "base/memory.h"
#include "math/extremes.h"
#include "tool/contact_force.h"
#include "tool/press.h"
#include "tool/sagitta.h"

#include <string.h>

/* looks for new points, and sweeps over them after each */
enum { LOOK_LIMIT = 8, SWEEP_LIMIT = 200 };
/* change of a push at which sweeps end, relative to the largest push of the tool: a tenth of a percent of the force */
#define SWEEP_TOLERANCE 1e-3
/* difference of weights from which two points of a triangle are two */
#define SAME_POINT 0.1

/* the plane that the point may not cross, from its depth at the end of the step and the way out in the tool's frame */
static void place(const pel_sim *sim, const pel_tool *tool, const pel_solid *solid, double depth, const double local[3],
                  pel_stop *stop)
{
    double point[3], before[3], at[3], away[3];
    pel_tool_point(sim->state->position_next, stop->vertices, stop->weights, point);
    pel_tool_point(sim->state->position, stop->vertices, stop->weights, before);
    pel_rotate(tool->pose.rotation, local, stop->normal);
    pel_pose_to_local(&tool->pose_before, before, at);
    double start = pel_max(0, -pel_solid_distance(solid, at, away));
    stop->offset = pel_vec3_dot(stop->normal, point) + pel_max(0, depth - start);
    /* the way of the tool's point that is now there, from where the surface was */
    pel_pose_to_local(&tool->pose, point, at);
    pel_pose_to_world(&tool->pose_before, at, at);
    pel_vec3_subtract(point, at, stop->stuck);
    pel_vec3_add(before, stop->stuck, stop->stuck);
}

static bool is_same(const pel_stop *stop, const int32_t vertices[3], const double weights[3])
{
    for (int c = 0; c < 3; c++)
        if (stop->vertices[c] != vertices[c] || fabs(stop->weights[c] - weights[c]) > SAME_POINT)
            return false;
    return true;
}

/* a point that is `depth` in the tool; one that is known keeps its push */
static void note(pel_sim *sim, const pel_tool *tool, int32_t t, const double weights[3], const pel_solid *solid,
                 double depth, const double normal[3])
{
    pel_stops *stops = &sim->tools->stops;
    const int32_t *vertices = sim->model->triangles[t];
    const double inertia = pel_tool_inertia(sim, vertices, weights);
    if (inertia <= 0)
        return;
    int32_t known = stops->is_new ? stops->count : 0;
    while (known < stops->count && !is_same(&stops->items[known], vertices, weights))
        known++;
    if (known == stops->count) {
        if (!pel_reserve((void **)&stops->items, &stops->capacity, (size_t)known + 1, sizeof *stops->items)) {
            sim->contact_forces.is_short = true; /* fails the step */
            return;
        }
        stops->items[known] = (pel_stop){.triangle = t};
        memcpy(stops->items[known].vertices, vertices, sizeof stops->items[known].vertices);
    }
    pel_stop *stop = &stops->items[known];
    pel_vec3_copy(weights, stop->weights);
    stop->inertia = inertia;
    stops->count += known == stops->count;
    place(sim, tool, solid, depth, normal, stop);
}

/* points deeper than the tolerance, corners first; returns whether there are any */
static bool look(pel_sim *sim, const pel_tool *tool, int32_t near_count, double tolerance)
{
    bool any = false;
    sim->tools->press_count++;
    for (int32_t i = 0; i < near_count; i++) {
        int32_t t = sim->tools->near_triangles[i];
        for (int c = 0; c < 4; c++) {
            double weights[3] = {c == 0, c == 1, c == 2}, normal[3], point[3], depth;
            pel_solid solid;
            if (c < 3) {
                int32_t v = sim->model->triangles[t][c];
                if (sim->tools->cornered_at[v] == sim->tools->press_count)
                    continue;
                sim->tools->cornered_at[v] = sim->tools->press_count;
                solid = pel_tool_press_solid(sim, tool, v);
                pel_vertex_position(sim->state->position_next, v, point);
                pel_pose_to_local(&tool->pose, point, point);
                depth = -pel_solid_distance(&solid, point, normal);
            } else {
                solid = pel_tool_triangle_solid(sim, tool, t);
                depth = pel_tool_triangle_depth(sim, tool, &solid, sim->state->position_next, t, weights, normal);
            }
            if (depth <= tolerance)
                continue;
            any = true;
            note(sim, tool, t, weights, &solid, depth, normal);
        }
    }
    return any;
}

/* moves the point, by the vertices that can move */
static void move(pel_sim *sim, const pel_stop *stop, const double way[3])
{
    for (int c = 0; c < 3; c++) {
        double share = pel_tool_mobility(sim, stop->vertices[c]) * stop->weights[c] / stop->inertia;
        for (int k = 0; k < 3; k++)
            sim->state->position_next[stop->vertices[c]][k] += (pel_real)(share * way[k]);
    }
}

/* one point: the push d, at least 0 in sum, and the friction across it; returns the change of the push */
static double relax(pel_sim *sim, const pel_tool *tool, pel_stop *stop)
{
    double point[3], way[3], slip[3], friction = pel_sim_friction(sim, tool, stop->vertices[0]);
    pel_tool_point(sim->state->position_next, stop->vertices, stop->weights, point);
    double change = pel_max(stop->offset - pel_vec3_dot(stop->normal, point), -stop->push);
    stop->push += change;
    pel_vec3_scale(stop->normal, change, way);
    if (friction > 0) {
        pel_vec3_subtract(stop->stuck, point, slip);
        pel_vec3_along(slip, -pel_vec3_dot(slip, stop->normal), stop->normal, slip);
        pel_vec3_add(slip, stop->rub, slip);
        double length = pel_vec3_length(slip), most = friction * stop->push;
        if (length > most)
            pel_vec3_scale(slip, most / length, slip);
        pel_vec3_add(way, slip, way);
        pel_vec3_subtract(way, stop->rub, way);
        pel_vec3_copy(slip, stop->rub);
    }
    move(sim, stop, way);
    return fabs(change);
}

static void solve(pel_sim *sim, const pel_tool *tool)
{
    const pel_stops *stops = &sim->tools->stops;
    for (int n = 0; n < SWEEP_LIMIT; n++) {
        double change = 0, most = 0;
        for (int32_t i = 0; i < stops->count; i++) {
            change = pel_max(change, relax(sim, tool, &stops->items[i]));
            most = pel_max(most, stops->items[i].push);
        }
        if (change <= SWEEP_TOLERANCE * most)
            return;
    }
}

/* a point that a later step finds far behind it has passed through the tool */
static void remember(const pel_sim *sim, pel_tool *tool, const pel_stop *stop, const double point[3])
{
    pel_contact_plane plane = {.triangle = stop->triangle};
    double local[3], tip[3];
    pel_vec3_add(point, stop->normal, tip);
    pel_pose_to_local(&tool->pose, point, local);
    pel_pose_to_local(&tool->pose, tip, tip);
    pel_vec3_subtract(tip, local, plane.normal);
    pel_vec3_copy(stop->weights, plane.weights);
    plane.offset = pel_vec3_dot(plane.normal, local);
    pel_tool_remember(sim, tool, &plane);
}

/* velocity and force of a push */
static void act(pel_sim *sim, pel_tool *tool, const pel_stop *stop)
{
    const double dt = sim->step.dt, rate = 1 / (stop->inertia * dt * dt);
    const int32_t vertices[4] = {stop->vertices[0], stop->vertices[1], stop->vertices[2], stop->vertices[0]};
    pel_contact_action action = {.vertices = vertices, .obstacle = (int32_t)(tool - sim->tools->items)};
    double point[3], force[3];
    memcpy(action.weights, stop->weights, sizeof stop->weights);
    pel_vec3_scale(stop->normal, rate * stop->push, action.load);
    pel_vec3_along(action.load, rate, stop->rub, action.force);
    for (int c = 0; c < 3; c++) {
        int32_t v = stop->vertices[c];
        double share = pel_tool_mobility(sim, v) * stop->weights[c];
        if (!(share > 0))
            continue;
        for (int k = 0; k < 3; k++)
            sim->state->velocity_next[v][k] += (pel_real)(share * dt * action.force[k]);
        pel_contact_vertex *touch = pel_tool_touch(tool, v);
        pel_vec3_along(touch->push, share / stop->inertia * stop->push, stop->normal, touch->push);
    }
    pel_contact_act(sim, &action);
    pel_tool_point(sim->state->position_next, stop->vertices, stop->weights, point);
    remember(sim, tool, stop, point);
    pel_vec3_scale(action.force, -1, force);
    pel_tool_add_reaction(tool, point, force);
}

bool pel_tool_stop(pel_sim *sim, pel_tool *tool, int32_t near_count)
{
    pel_stops *stops = &sim->tools->stops;
    stops->count = 0;
    stops->is_new = true;
    for (int n = 0; n < LOOK_LIMIT && look(sim, tool, near_count, n > 0 ? pel_tool_press_tolerance(sim, tool) : 0);
         n++) {
        solve(sim, tool);
        stops->is_new = false;
    }
    for (int32_t i = 0; i < stops->count; i++)
        if (stops->items[i].push > 0)
            act(sim, tool, &stops->items[i]);
    return stops->count > 0;
}

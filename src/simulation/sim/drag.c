/* Dragging a piece of surface by a spring.

   The piece is held by a grasp, which every method treats as a boundary, and the grasp moves to the balance of spring
   and surface: k (target - p) + F(p) = 0 with the force F of the surface on the hand. Between two steps F is known at p
   only. K is the measured stiffness of the surface: a secant of F.

   Methods without velocities: a secant step, p' = p + (k (target - p) + F) / (k + K).

   Methods with velocities: F holds the inertia of the piece, -m (p_n - 2 p_(n-1) + p_(n-2)) / dt^2, and a hand without
   mass would answer one step late: with a = c m / (dt^2 (k + K)) its steps obey l^2 + a l - a = 0, unstable from a =
   1/2 on, and slow below. So the hand has a mass M, a multiple of m and at least 2 K dt^2, and critical damping for k
   and M; then a = c m / M, where c, 1 to 4, depends on the integrator. The spring is evaluated at the end of the step,
   so any stiffness is stable. */
#include "base/memory.h"
#include "base/status.h"
#include "math/extremes.h"
#include "pellicle/live.h"
#include "stage/surface_view.h"
#include "tool/reading.h"

#include <stdio.h>
#include <string.h>

/* share of a new, smaller secant in the stiffness; with velocities a larger one is adopted immediately */
#define SECANT_SHARE 0.3
#define SLOW_SHARE 0.02
/* mass of the hand relative to the held mass, and its stiffness times dt^2 relative to the surface */
#define MASS_RATIO 8
#define STIFF_RATIO 2
/* mass factor of the nearest vertex that certainly holds it */
#define REACH_MARGIN 1.001

/* radius of the patch of surface that a hand holds, relative to the longest side of the body */
#define PATCH_SHARE 0.1

struct pel_drag {
    pel_sim *sim;
    char name[PEL_NAME_SIZE];
    double stiffness, target[3];
    double surface;                /* N/m, K */
    double held_mass, velocity[3]; /* kg, m/s; of methods with velocities */
    double point_before[3], force_before[3];
    bool has_moved;
};

static pel_status fail_drag(const pel_drag *drag, pel_error *error)
{
    return pel_fail(error, PEL_BAD_ARGUMENT, "the tool '%s' of the drag was removed", drag->name);
}

/* "drag", or the first of "drag-2", "drag-3", ... that is free */
static void choose_name(const pel_sim *sim, char name[PEL_NAME_SIZE])
{
    snprintf(name, PEL_NAME_SIZE, "drag");
    for (int i = 2; pel_sim_find_tool(sim, name) >= 0; i++)
        snprintf(name, PEL_NAME_SIZE, "drag-%d", i);
}

/* m, to the nearest corner of the triangle that was hit */
static double nearest_corner(const pel_sim *sim, const pel_pick_hit *hit)
{
    double least = HUGE_VAL, x[3];
    for (int c = 0; c < 3; c++) {
        pel_vertex_position(sim->state->position, pel_output_model_index(sim, hit->body, hit->vertices[c]), x);
        least = pel_min(least, pel_vec3_distance(x, hit->point));
    }
    return least;
}

/* kg, of the vertices within a radius */
static double mass_near(const pel_sim *sim, const pel_pick_hit *hit, double radius)
{
    double sum = 0, x[3];
    for (int32_t r = 0; r < pel_output_count(sim, hit->body); r++) {
        int32_t v = pel_output_model_index(sim, hit->body, r);
        pel_vertex_position(sim->state->position, v, x);
        if (pel_vec3_distance(x, hit->point) <= radius)
            sum += (double)sim->model->mass[v];
    }
    return sum;
}

static pel_status check(const pel_sim *sim, const pel_pick_hit *hit, double stiffness, double reach, pel_error *error)
{
    if (!hit->is_hit || hit->body < 0 || hit->body >= sim->model->body_count)
        return pel_fail(error, PEL_BAD_ARGUMENT, "there is nothing to drag: the ray met no body");
    for (int c = 0; c < 3; c++)
        if (hit->vertices[c] < 0 || hit->vertices[c] >= pel_output_count(sim, hit->body) || !isfinite(hit->point[c]))
            return pel_refuse(error, PEL_BAD_ARGUMENT, "pick again after a step that refined the body",
                              "the hit belongs to an earlier surface of the body");
    if (!(stiffness > 0 && isfinite(stiffness)) || !(reach >= 0 && isfinite(reach)))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give a stiffness above 0 N/m and a reach of at least 0 m",
                          "a drag has the stiffness %g and the reach %g", stiffness, reach);
    return PEL_OK;
}

pel_status pel_drag_begin(pel_sim *sim, const pel_pick_hit *hit, double stiffness, double reach, pel_drag **drag,
                          pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    PEL_REFUSE_NULL(hit, error);
    PEL_REFUSE_NULL(drag, error);
    *drag = NULL;
    pel_status status = check(sim, hit, stiffness, reach, error);
    if (status != PEL_OK)
        return status;
    pel_drag *made = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    choose_name(sim, made->name);
    pel_pose_key key = {.rotation = {0, 0, 0, 1}};
    pel_vec3_copy(hit->point, key.position);
    pel_tool_def def = pel_tool_def_default();
    def.name = made->name;
    def.radius = pel_max(reach, REACH_MARGIN * nearest_corner(sim, hit));
    def.radius = pel_max(def.radius, 1e-9 * sim->model->bodies[hit->body].diameter);
    def.body = hit->body;
    def.press = false;
    def.grasp = true;
    def.keys = &key;
    def.key_count = 1;
    status = pel_sim_add_tool(sim, &def, error);
    if (status == PEL_OK)
        status = pel_sim_set_tool_pose(sim, pel_sim_find_tool(sim, made->name), key.position, key.rotation, error);
    if (status != PEL_OK) {
        pel_free(made);
        return status;
    }
    made->sim = sim;
    made->stiffness = made->surface = stiffness;
    made->held_mass = mass_near(sim, hit, def.radius);
    pel_vec3_copy(hit->point, made->target);
    *drag = made;
    return PEL_OK;
}

/* update the stiffness of the surface from the last move */
static void learn(pel_drag *drag, const pel_tool_reading *now)
{
    double way[3], change[3];
    pel_vec3_subtract(now->position, drag->point_before, way);
    pel_vec3_subtract(now->force, drag->force_before, change);
    double square = pel_vec3_squared_length(way);
    if (drag->has_moved && square > 0) {
        double secant = pel_max(-pel_vec3_dot(change, way) / square, 0);
        bool rises_at_once = pel_sim_has_velocity(drag->sim) && secant > drag->surface;
        double share = rises_at_once ? 1 : pel_sim_has_velocity(drag->sim) ? SLOW_SHARE : SECANT_SHARE;
        if (isfinite(secant))
            drag->surface += share * (secant - drag->surface);
    }
    pel_vec3_copy(now->position, drag->point_before);
    pel_vec3_copy(now->force, drag->force_before);
    drag->has_moved = true;
}

/* m, way of the hand in a step along an axis, with the force on it at its start */
static double swing(pel_drag *drag, int axis, double force)
{
    double dt = drag->sim->solver.dt, k = drag->stiffness;
    double mass = pel_max(MASS_RATIO * drag->held_mass, STIFF_RATIO * drag->surface * dt * dt);
    double damping = 2 * sqrt(k * mass);
    drag->velocity[axis] = (mass * drag->velocity[axis] + dt * force) / (mass + dt * damping + dt * dt * k);
    return dt * drag->velocity[axis];
}

pel_status pel_drag_move(pel_drag *drag, const double target[3], pel_error *error)
{
    PEL_REFUSE_NULL(drag, error);
    PEL_REFUSE_NULL(target, error);
    pel_tool_reading now;
    double next[3];
    int32_t tool = pel_sim_find_tool(drag->sim, drag->name);
    if (tool < 0)
        return fail_drag(drag, error);
    if (!isfinite(target[0]) || !isfinite(target[1]) || !isfinite(target[2]))
        return pel_fail(error, PEL_BAD_ARGUMENT, "the target of a drag is not finite");
    pel_vec3_copy(target, drag->target);
    pel_sim_get_tool(drag->sim, tool, &now);
    learn(drag, &now);
    for (int i = 0; i < 3; i++) {
        double force = drag->stiffness * (target[i] - now.position[i]) + now.force[i];
        next[i] = now.position[i] +
                  (pel_sim_has_velocity(drag->sim) ? swing(drag, i, force) : force / (drag->stiffness + drag->surface));
    }
    return pel_sim_set_tool_pose(drag->sim, tool, next, now.rotation, error);
}

void pel_drag_get(const pel_drag *drag, pel_drag_reading *reading)
{
    if (drag == NULL || reading == NULL)
        return;
    pel_tool_reading now = {0};
    int32_t tool = pel_sim_find_tool(drag->sim, drag->name);
    *reading = (pel_drag_reading){0};
    if (tool < 0)
        return;
    pel_sim_get_tool(drag->sim, tool, &now);
    pel_vec3_copy(now.position, reading->point);
    pel_vec3_copy(drag->target, reading->target);
    pel_vec3_copy(now.force, reading->reaction);
    for (int i = 0; i < 3; i++)
        reading->force[i] = drag->stiffness * (drag->target[i] - now.position[i]);
    reading->held_count = now.held_count;
}

pel_status pel_drag_end(pel_drag *drag, pel_error *error)
{
    if (drag == NULL)
        return PEL_OK;
    int32_t tool = pel_sim_find_tool(drag->sim, drag->name);
    pel_status status = tool >= 0 ? pel_sim_remove_tool(drag->sim, tool, error) : PEL_OK;
    /* a tool that stays for want of memory lets go in the next step */
    if (status != PEL_OK)
        drag->sim->tools->items[tool].grasp_until = pel_sim_time(drag->sim);
    pel_free(drag);
    return status;
}

/* ---- a spring that suits ---- */

static bool read_number(const pel_sim *sim, const char *body, const char *key, double *value)
{
    char path[PEL_PARAMETER_PATH_SIZE];
    pel_parameter_info info;
    snprintf(path, sizeof path, "bodies.%s.%s", body, key);
    if (pel_parameter_find(sim, path, &info, NULL) != PEL_OK || !isfinite(info.value[0]))
        return false;
    *value = info.value[0];
    return true;
}

/* N/m of a sheet by its modulus and thickness; 0 without */
static double sheet_stiffness(const pel_sim *sim, const char *body, const char *young, const char *thickness)
{
    double modulus = 0, height = 0;
    bool is_known = read_number(sim, body, young, &modulus) && read_number(sim, body, thickness, &height);
    return is_known ? 0.3 * modulus * height : 0;
}

/* N/m of the filling under a patch of the surface, given by its modulus; 0 without */
static double filling_stiffness(const pel_sim *sim, const char *body, double radius)
{
    double modulus = 0, depth = 0;
    bool is_known = read_number(sim, body, "volumetric.young", &modulus) &&
                    read_number(sim, body, "volumetric.depth", &depth) && depth > 0;
    return is_known ? 3.14 * radius * radius * modulus / depth : 0;
}

double pel_drag_suit_stiffness(const pel_sim *sim)
{
    double most = 0;
    if (sim == NULL)
        return 0;
    const pel_body_def *bodies = sim->given->def.bodies;
    for (int32_t b = 0; b < sim->given->body_count; b++) {
        const char *name = bodies[b].name;
        double springs = 0, home = 0, low[3], high[3];
        pel_mesh_box(bodies[b].mesh, low, high);
        double size = pel_max(high[0] - low[0], pel_max(high[1] - low[1], high[2] - low[2]));
        double by_young = sheet_stiffness(sim, name, "membrane.young", "membrane.thickness") +
                          sheet_stiffness(sim, name, "springs.young", "springs.thickness") +
                          filling_stiffness(sim, name, PATCH_SHARE * size);
        read_number(sim, name, "volumetric.stiffness", &home);
        read_number(sim, name, "springs.stiffness", &springs);
        most = pel_max(most, pel_max(by_young, 4 * (springs + home)));
    }
    return most > 0 ? most : 1;
}

/* Bodies that have no place of least energy: a net force on a body that nothing holds moves it for ever. Pins,
   volumetric springs and tools hold a body; contact between bodies does when one of them is held. A body may turn under
   loads, which bounds their energy: torques need nothing to hold them. A pressure on all of a closed body has no net
   force; the vertex-normal form has a small one, which is not counted. */
#include "minimise/free_body.h"

#include "attach/joint.h"
#include "attach/tie.h"
#include "base/status.h"
#include "boundary/hold.h"
#include "boundary/loads.h"
#include "force/pressure.h"
#include "math/vec3.h"
#include "tool/tool.h"
#include "touch/contact.h"

#include <math.h>

/* net force over the sum of the forces' magnitudes: rounding of records, and the error of the vertex-normal form */
#define LOAD_RATIO 1e-4
#define FOLLOWER_RATIO 0.05
/* relative to its size: a body that moves this much farther than the tools has escaped */
#define STRAY_SHARE 0.5

/* by pins, volumetric springs or supports */
static bool is_fastened(const pel_sim *sim, int32_t body)
{
    const pel_body *own = &sim->model->bodies[body];
    for (int32_t v = own->slice_begin * PEL_WIDTH; v < own->slice_end * PEL_WIDTH; v++)
        if (sim->model->mesh_vertex[v] >= 0 && !(sim->model->inverse_mass[v] > 0))
            return true;
    return own->has_volumetric || pel_holds_has_body(sim, body) || pel_ties_hold(sim, body) ||
           pel_joints_hold(sim, body);
}

static bool holds_itself(const pel_sim *sim, int32_t body)
{
    for (int32_t i = 0; i < sim->tools->count; i++)
        if ((sim->tools->items[i].press || sim->tools->items[i].grasp) && pel_tool_acts_on(&sim->tools->items[i], body))
            return true;
    return is_fastened(sim, body);
}

static bool is_held(const pel_sim *sim, int32_t body)
{
    bool held = holds_itself(sim, body);
    bool meets = sim->contacts != NULL && sim->touch->def.between;
    for (int32_t b = 0; !held && meets && b < sim->model->body_count; b++)
        held = holds_itself(sim, b);
    return held;
}

/* the only joint of a body that nothing else holds, if it is a slider to the world without motor; null = others */
static const pel_joint *find_slider(const pel_sim *sim, int32_t body)
{
    const pel_joint *slider = NULL;
    int32_t count = 0;
    for (int32_t i = 0; sim->joints != NULL && i < sim->joints->count; i++) {
        const pel_joint *joint = &sim->joints->items[i];
        if (joint->def.body != body && joint->def.to_body != body)
            continue;
        count++;
        if (joint->def.kind == PEL_JOINT_SLIDER && joint->def.to_body < 0 && !(joint->def.strength > 0))
            slider = joint;
    }
    bool touches = sim->tools->count > 0 || (sim->contacts != NULL && sim->model->body_count > 1);
    return count > 1 || touches || pel_holds_has_body(sim, body) || pel_ties_hold(sim, body) ? NULL : slider;
}

/* a net force along a slider, up to no limit */
static pel_status check_slider(const pel_sim *sim, int32_t body, const double net[3], double time, pel_error *error)
{
    const pel_joint *slider = find_slider(sim, body);
    if (slider == NULL)
        return PEL_OK;
    const double *axis = slider->axes[0], along = pel_vec3_dot(net, axis);
    if (!(fabs(along) > LOAD_RATIO * pel_vec3_length(net)) || !isinf(along > 0 ? slider->def.most : slider->def.least))
        return PEL_OK;
    return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", body,
                              "give the joint `least` and `most` or a motor, hold the body by an attachment with a "
                              "`stiffness`, or use the method implicit",
                              "joint '%s' leaves body '%s' free to slide along (%.3g, %.3g, %.3g), where %.3g N act at "
                              "time %.4g s: it has no equilibrium",
                              slider->name, sim->model->bodies[body].name, axis[0], axis[1], axis[2], fabs(along),
                              time);
}

static pel_status refuse_free(const pel_sim *sim, int32_t body, const double net[3], double time, pel_error *error)
{
    return pel_refuse_element(
        error, PEL_BAD_ARGUMENT, "body", body,
        "pin vertices, add volumetric springs or a tool that it rests on, balance the loads, or use "
        "the method implicit, xpbd or explicit",
        "nothing holds body '%s' against the net force (%.3g, %.3g, %.3g) N at time %.4g s: it has no equilibrium",
        sim->model->bodies[body].name, net[0], net[1], net[2], time);
}

/* a push has no reaction: not even its net force of 0 at rest is one that a free body can bear */
static pel_status check_pushed(const pel_sim *sim, pel_error *error)
{
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_body *body = &sim->model->bodies[b];
        if (body->shell != NULL && pel_shell_has_mode(body->shell, PEL_FIBRE_NORMAL) && !is_held(sim, b))
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", b,
                                      "pin vertices, add volumetric springs, or use the method implicit, xpbd or pbd",
                                      "nothing holds body '%s' against its fibres of the mode normal, whose push has "
                                      "no reaction: it has no equilibrium",
                                      body->name);
    }
    return PEL_OK;
}

pel_status pel_minimise_check_held(const pel_sim *sim, const pel_record *force, double time, pel_error *error)
{
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_body *body = &sim->model->bodies[b];
        double net[3] = {0, 0, 0}, sum = 0, x[3];
        for (int32_t v = body->slice_begin * PEL_WIDTH; v < pel_body_place_end(sim->model, b); v++) {
            pel_vertex_position(force, v, x);
            pel_vec3_add(net, x, net);
            sum += pel_vec3_length(x);
        }
        bool follows = !pel_shell_has_potential(body);
        if (pel_vec3_length(net) > (follows ? FOLLOWER_RATIO : LOAD_RATIO) * sum && !is_held(sim, b))
            return refuse_free(sim, b, net, time, error);
        pel_status status = check_slider(sim, b, net, time, error);
        if (status != PEL_OK)
            return status;
    }
    return PEL_OK;
}

/* the forces of all loads and pressures that have no potential, on the rest shape */
static pel_status check_at(pel_sim *sim, double time, pel_error *error)
{
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        sim->force[v] = (pel_record){0};
    pel_loads_add(sim, pel_instant(time), sim->state->position, sim->force);
    pel_shell_forces_add(sim->shells, sim->state->position, pel_instant(time), PEL_SHELL_FOLLOWER, sim->pool,
                         sim->force);
    return pel_minimise_check_held(sim, sim->force, time, error);
}

pel_status pel_minimise_check_start(pel_sim *sim, pel_error *error)
{
    double dt = sim->step.dt;
    pel_status status = check_pushed(sim, error);
    if (status == PEL_OK)
        status = check_at(sim, dt, error);
    /* loads that begin later, and their keys */
    for (int32_t l = 0; status == PEL_OK && l < sim->loads->count; l++) {
        const pel_load *load = &sim->loads->items[l];
        if (load->from > dt)
            status = check_at(sim, load->from, error);
        for (int32_t k = 0; status == PEL_OK && k < load->key_count; k++)
            if (load->keys[k].time > dt)
                status = check_at(sim, load->keys[k].time, error);
    }
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        sim->force[v] = (pel_record){0};
    return status;
}

/* ---- bodies that get away ---- */

/* m, of the mean of a body's vertices from its place at rest, across the forces that stay; 0 where a grasp holds it */
static double way_across(const pel_sim *sim, int32_t body)
{
    const pel_state *state = sim->state;
    double way[3] = {0, 0, 0}, net[3] = {0, 0, 0}, x[3];
    int32_t count = 0;
    for (int32_t v = sim->model->bodies[body].slice_begin * PEL_WIDTH; v < pel_body_place_end(sim->model, body); v++) {
        if (sim->model->mesh_vertex[v] < 0)
            continue;
        if (sim->held != NULL && sim->held[v])
            return 0;
        pel_vertex_position(sim->minimise->external, v, x);
        pel_vec3_add(net, x, net);
        pel_vertex_position(state->position_next, v, x);
        pel_vec3_add(way, x, way);
        pel_vertex_position(sim->model->rest, v, x);
        pel_vec3_subtract(way, x, way);
        count++;
    }
    pel_vec3_scale(way, count > 0 ? 1.0 / count : 0, way);
    if (pel_vec3_normalize(net) > 0)
        pel_vec3_along(way, -pel_vec3_dot(way, net), net, way);
    return pel_vec3_length(way);
}

void pel_minimise_find_stray(pel_sim *sim)
{
    pel_minimise *minimise = sim->minimise;
    minimise->stray_body = -1;
    minimise->stray_way = 0;
    /* moving supports carry bodies that lie on them */
    for (int32_t b = 0; b < sim->model->body_count && !pel_holds_move(sim); b++) {
        const pel_body *body = &sim->model->bodies[b];
        double way = !is_fastened(sim, b) ? way_across(sim, b) : 0;
        if (way - minimise->tool_way - minimise->step_way < STRAY_SHARE * body->diameter || way <= minimise->stray_way)
            continue;
        minimise->stray_body = b;
        minimise->stray_way = way;
    }
}

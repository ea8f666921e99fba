/* Helpers shared by the files of the tools: frames, and the list of touched vertices. */
#ifndef PEL_SIM_TOOL_H
#define PEL_SIM_TOOL_H

#include "contact/contact.h"
#include "math/pose.h"
#include "sim/sim.h"

/* ---- tool_pose.c ---- */
/* finite, with a unit quaternion and not too many turns */
bool pel_tool_is_key(const pel_pose_key *key);
/* after the keys are there */
void pel_tool_sum_spins(pel_tool *tool);
/* a keyed pose at a time */
pel_pose pel_tool_pose_at(const pel_tool *tool, double time);
/* the pose that a tool moves to in the step to `time` */
pel_pose pel_tool_next_pose(const pel_sim *sim, const pel_tool *tool, double time);

/* velocity of the point of the tool that is now at `point`: v + w x r with the mean v and w of the last step */
static inline void pel_tool_velocity(const pel_tool *tool, const double point[3], double dt, double velocity[3])
{
    double turn[3], arm[3], before[3];
    pel_pose_turn(&tool->pose_before, &tool->pose, turn);
    pel_vec3_subtract(point, tool->pose.position, arm);
    pel_vec3_cross(turn, arm, velocity);
    pel_vec3_add(arm, tool->pose_before.position, before);
    for (int i = 0; i < 3; i++)
        velocity[i] = (velocity[i] + (point[i] - before[i])) / dt;
}

static inline double pel_tool_size(const pel_tool *tool)
{
    return pel_solid_size(&tool->solid);
}

/* displacement between two poses: of the position, and of the tool's rim by the rotation */
static inline double pel_tool_way(const pel_tool *tool, const pel_pose *a, const pel_pose *b)
{
    return pel_pose_way(a, b, pel_tool_size(tool));
}

/* grown by a distance about it */
static inline pel_solid pel_solid_grown(const pel_solid *solid, double margin)
{
    pel_solid grown = *solid;
    grown.radius += margin;
    for (int k = 0; k < 3; k++)
        grown.half_extents[k] += margin;
    return grown;
}

/* the solid that the body of a vertex is kept out of */
pel_solid pel_tool_press_solid(const pel_sim *sim, const pel_tool *tool, int32_t v);

static inline bool pel_tool_is_round(const pel_tool *tool)
{
    return tool->mesh == NULL && pel_solid_is_round(&tool->solid);
}

static inline bool pel_tool_acts_on(const pel_tool *tool, int32_t body)
{
    return tool->body < 0 || tool->body == body;
}

/* inverse mass, 0 if a tool holds the vertex */
static inline double pel_tool_mobility(const pel_sim *sim, int32_t v)
{
    return sim->held[v] ? 0 : (double)sim->model->inverse_mass[v];
}

/* the touch of a vertex in this step, new if need be */
static inline pel_contact_vertex *pel_tool_touch(pel_tool *tool, int32_t v)
{
    if (tool->touch_of_vertex[v] == 0) {
        tool->touches[tool->touch_count] = (pel_contact_vertex){.vertex = v};
        tool->touch_of_vertex[v] = ++tool->touch_count;
    }
    return &tool->touches[tool->touch_of_vertex[v] - 1];
}

static inline void pel_tool_add_reaction(pel_tool *tool, const double point[3], const double force[3])
{
    double arm[3], torque[3];
    pel_vec3_subtract(point, tool->pose.position, arm);
    pel_vec3_cross(arm, force, torque);
    pel_vec3_add(tool->force, force, tool->force);
    pel_vec3_add(tool->torque, torque, tool->torque);
}

/* ---- contact_force.c ---- */
/* Adds it to the forces of the step. */
void pel_contact_act(pel_sim *sim, const pel_contact_action *action);
/* Adds the force that changed the sum of a contact by `change`: `change` times rate over its mobility; with
   displacements in m the rate is in 1/s2, with velocities in 1/s. tool: its other side, which receives the reaction and
   the touch; -1 = none. */
void pel_contact_take(pel_sim *sim, int32_t tool, const pel_contact *contact, const double change[3], double rate);
/* the same for the push and friction of a substep */
void pel_contact_take_push(pel_sim *sim, int32_t tool, const pel_contact *contact, double rate);

/* force of a held vertex at a point on its tool */
static inline void pel_tool_add_grip(pel_sim *sim, pel_tool *tool, int32_t v, const double point[3],
                                     const double force[3])
{
    double back[3];
    pel_vec3_add(sim->grip_forces[v], force, sim->grip_forces[v]);
    pel_tool_add_reaction(tool, point, force);
    pel_vec3_scale(force, -1, back);
    pel_contact_forces_add_at(&sim->contact_forces, v, (int32_t)(tool - sim->tools), back);
}

/* ---- tool_grip.c ---- */
/* Holds a vertex where it is at rest in the frame of a support. */
void pel_tool_hold_at_rest(pel_sim *sim, pel_tool *tool, int32_t v);
/* Begins or ends the grasp; true if the held vertices change. */
bool pel_tool_update_grasp(pel_sim *sim, pel_tool *tool, double time);
/* lists holders and held vertices, for methods that need them in every substep */
void pel_tools_list_held(pel_sim *sim);
/* Takes the i-th held vertex from the list of a tool; the place stays without mobility. */
void pel_tool_let_go(pel_sim *sim, pel_tool *tool, int32_t i);

/* ---- tool_reading.c ---- */
/* Point of action of the mean force of a step on a held vertex: the mean of its arms at both ends of the step. With the
   last arm alone, an inward pull on a turning rim would drive the rotation. */
void pel_tool_mean_point(const pel_sim *sim, const pel_tool *tool, int32_t v, double point[3]);

/* ---- tool_sagitta.c ---- */
/* Whether triangles at a vertex may cut into a tool: a sphere or capsule on a body with a filling by Young's modulus,
   without contact between surfaces. */
bool pel_tool_cuts(const pel_sim *sim, const pel_tool *tool, int32_t v);
/* the solid that keeps whole triangles out: pel_tool_press_solid less the sagitta where they may cut in */
pel_solid pel_tool_triangle_solid(const pel_sim *sim, const pel_tool *tool, int32_t t);

/* ---- tool_start.c ---- */
/* PEL_BAD_ARGUMENT with that way */
pel_status pel_tool_refuse_inside(const pel_sim *sim, int32_t index, int32_t body, pel_error *error);
/* the same where a solid starts inside a body */
pel_status pel_tool_check_outside(const pel_sim *sim, int32_t index, pel_error *error);

/* ---- tool_near.c ---- */
/* Box about the tool grown by a width on all sides of its own frame, and a margin, along the axes of the world. */
pel_search_box pel_tool_box(const pel_tool *tool, double width, double margin);
/* Lists the triangles that reach within a margin of the tool's box in sim->near_triangles, in rising order; returns how
   many. The sweeps depend on this order, which must not change when a triangle without contact enters or leaves.
   list: kept for this tool and kind of margin alone; it makes no difference to the result. */
int32_t pel_tool_near_triangles(pel_sim *sim, const pel_tool *tool, pel_near_list *list, const pel_record *positions,
                                double margin);

/* ---- tool_press.c ---- */
/* Depth of one triangle in the tool, with the deepest point and the way out in the tool's frame (see pel_solid_depth).
 */
double pel_tool_triangle_depth(const pel_sim *sim, const pel_tool *tool, const pel_solid *solid,
                               const pel_record *positions, int32_t t, double weights[3], double normal[3]);
/* the depth that pressing leaves [m] */
double pel_tool_press_tolerance(const pel_sim *sim, const pel_tool *tool);
/* Coulomb's coefficient between a tool and the body of a vertex, 0 without contact */
double pel_sim_friction(const pel_sim *sim, const pel_tool *tool, int32_t v);
/* Pushes the new positions out of one tool; true when anything moved. longest: bound of the length of an edge. */
bool pel_tool_press(pel_sim *sim, pel_tool *tool, double longest);

#endif

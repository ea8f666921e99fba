/* Rigid tools in a step: they follow their keys, hold grasped vertices, and push the surface out. */
#include "tool/tools.h"

#include "base/assert.h"
#include "tool/follow.h"
#include "tool/grip.h"
#include "tool/pose.h"
#include "tool/press.h"
#include "tool/solid.h"

#include <string.h>

/* rounds over the tools at most */
enum { ROUND_LIMIT = 4 };

static void forget_touches(pel_tool *tool)
{
    PEL_ASSERT(tool->touch_count >= 0);
    for (int32_t i = 0; i < tool->touch_count; i++)
        tool->touch_of_vertex[tool->touches[i].vertex] = 0;
    tool->touch_count = 0;
    pel_vec3_set(tool->force, 0, 0, 0);
    pel_vec3_set(tool->torque, 0, 0, 0);
}

static void begin_tool(pel_sim *sim, pel_tool *tool, double time)
{
    tool->is_on_its_way = true;
    tool->blocked_before = tool->blocked;
    pel_vec3_copy(tool->force, tool->force_before);
    pel_vec3_copy(tool->torque, tool->torque_before);
    forget_touches(tool);
    pel_contact_plane *oldest = tool->planes_before;
    tool->planes_before = tool->planes;
    tool->plane_before_count = tool->plane_count;
    tool->planes = oldest;
    tool->plane_count = 0;
    if (sim->part.at == 0)
        tool->pose_start = tool->pose;
    tool->pose_before = tool->pose_substep = tool->pose;
    tool->pose = pel_tool_next_pose(sim, tool, time);
    if (tool->stride < 1)
        pel_pose_between(&tool->pose_before, &tool->pose, tool->stride, &tool->pose);
    tool->pose_wanted = tool->pose;
}

/* A grasp that holds or has opened in the middle of the coming part, or of its first substep, does so in all of it: it
   is late or early by half of that at most. */
static double grasp_time(const pel_sim *sim)
{
    int32_t count = pel_sim_is_projected(sim) ? sim->solver.substeps : 1;
    return pel_sim_time(sim) + 0.5 * sim->step.dt / count;
}

bool pel_tools_grasps_change(const pel_sim *sim)
{
    double at = grasp_time(sim);
    bool any = false;
    for (int32_t i = 0; i < sim->tools->count; i++) {
        const pel_tool *tool = &sim->tools->items[i];
        bool is_waiting = tool->phase == PEL_GRASP_WAITING, is_holding = tool->phase == PEL_GRASP_HOLDING;
        any |= tool->grasp && ((is_waiting && at >= tool->grasp_from) || (is_holding && at >= tool->grasp_until));
    }
    return any;
}

void pel_tools_begin(pel_sim *sim, double time)
{
    bool changed = false;
    double at = grasp_time(sim);
    for (int32_t i = 0; i < sim->tools->count; i++) {
        begin_tool(sim, &sim->tools->items[i], time);
        changed |= pel_tool_update_grasp(sim, &sim->tools->items[i], at, sim->state->position);
        for (int32_t k = 0; k < sim->tools->items[i].held_count; k++)
            pel_vec3_set(sim->tools->grip_forces[sim->tools->items[i].held[k]], 0, 0, 0);
    }
    if (sim->tools->held_vertices != NULL && (changed || !sim->tools->held_is_listed))
        pel_tools_list_held(sim);
    sim->tools->held_is_listed = true;
}

void pel_tools_follow_grasps(pel_sim *sim, double time)
{
    bool changed = false;
    for (int32_t i = 0; i < sim->tools->count; i++)
        changed |= pel_tool_update_grasp(sim, &sim->tools->items[i], time, sim->state->position_next);
    if (changed)
        pel_tools_list_held(sim);
}

void pel_tools_place(pel_sim *sim, double share)
{
    int32_t count = 0;
    for (int32_t i = 0; i < sim->tools->count; i++) {
        pel_tool *tool = &sim->tools->items[i];
        tool->pose_substep = tool->pose;
        pel_pose_between(&tool->pose_before, &tool->pose_wanted, share, &tool->pose);
        const pel_tool_path path = pel_tool_path_at(tool, &tool->pose);
        for (int32_t k = 0; k < tool->held_count; k++)
            pel_tool_path_target(&path, k, sim->tools->held_targets[count++]);
    }
}

void pel_tools_move(pel_sim *sim, double time)
{
    pel_tools_begin(sim, time);
    pel_tools_carry(sim);
}

void pel_tools_return(pel_sim *sim)
{
    for (int32_t i = 0; i < sim->tools->count; i++) {
        pel_tool *tool = &sim->tools->items[i];
        if (!tool->is_on_its_way)
            continue;
        tool->is_on_its_way = false;
        tool->pose = tool->pose_before;
        tool->blocked = tool->blocked_before;
        pel_vec3_copy(tool->force_before, tool->force);
        pel_vec3_copy(tool->torque_before, tool->torque);
        pel_contact_plane *newest = tool->planes;
        tool->planes = tool->planes_before;
        tool->plane_count = tool->plane_before_count;
        tool->planes_before = newest;
    }
}

static bool presses(const pel_tool *tool, bool only_round)
{
    return tool->press && tool->mesh == NULL && (!only_round || pel_solid_is_round(&tool->solid));
}

void pel_tools_press(pel_sim *sim, double longest, bool only_round)
{
    /* the substeps have kept solids out (solid.h) */
    bool moved = !pel_sim_is_projected(sim);
    for (int round = 0; moved && round < (sim->tools->count > 1 ? ROUND_LIMIT : 1); round++) {
        moved = false;
        for (int32_t i = 0; i < sim->tools->count; i++)
            if (presses(&sim->tools->items[i], only_round))
                moved |= pel_tool_press(sim, &sim->tools->items[i], longest);
    }
}

/* ---- snapshots ---- */

void pel_tool_transfer(pel_cursor *at, const pel_sim *sim, int32_t index)
{
    pel_tool *tool = &sim->tools->items[index];
    size_t vertex_count = (size_t)sim->model->vertex_count;
    pel_transfer(at, &tool->pose, sizeof tool->pose);
    pel_transfer(at, &tool->driven_pose, sizeof tool->driven_pose);
    pel_transfer(at, &tool->driven, sizeof tool->driven);
    pel_transfer(at, &tool->is_leading, sizeof tool->is_leading);
    pel_transfer(at, &tool->blocked, sizeof tool->blocked);
    pel_transfer(at, &tool->is_held_back, sizeof tool->is_held_back);
    pel_transfer(at, &tool->is_stopped, sizeof tool->is_stopped);
    pel_transfer(at, &tool->stride, sizeof tool->stride);
    pel_transfer(at, &tool->tally, sizeof tool->tally);
    pel_transfer(at, &tool->phase, sizeof tool->phase);
    pel_transfer(at, &tool->held_count, sizeof tool->held_count);
    pel_transfer(at, &tool->contact_count, sizeof tool->contact_count);
    pel_transfer(at, &tool->plane_count, sizeof tool->plane_count);
    pel_transfer(at, tool->planes, PEL_PLANE_LIMIT * sizeof *tool->planes);
    pel_transfer(at, tool->force, sizeof tool->force);
    pel_transfer(at, tool->torque, sizeof tool->torque);
    if (tool->booked_forces != NULL)
        pel_transfer(at, tool->booked_forces, vertex_count * sizeof *tool->booked_forces);
    if (tool->blade != NULL) {
        pel_transfer(at, &tool->blade->tip_count, sizeof tool->blade->tip_count);
        pel_transfer(at, tool->blade->tips, sizeof tool->blade->tips);
        pel_transfer(at, &tool->blade->closed, sizeof tool->blade->closed);
    }
    if (tool->grasp) {
        pel_transfer_list(at, tool->held, vertex_count, sizeof *tool->held);
        pel_transfer_list(at, tool->anchors, vertex_count, sizeof *tool->anchors);
    }
}

static bool is_flag(const bool *flag)
{
    unsigned char byte;
    memcpy(&byte, flag, sizeof byte);
    return byte <= 1;
}

static bool has_whole_tips(const pel_sim *sim, const pel_tool *tool)
{
    int32_t count = tool->blade != NULL ? tool->blade->tip_count : 0;
    if (count < 0 || count > PEL_BLADE_TIPS)
        return false;
    if (tool->blade != NULL && !(tool->blade->closed >= 0 && tool->blade->closed <= 1))
        return false;
    for (int32_t i = 0; i < count; i++) {
        const pel_blade_tip *tip = &tool->blade->tips[i];
        if (tip->body < 0 || tip->body >= sim->model->body_count || tip->vertex < 0 ||
            tip->vertex >= sim->model->bodies[tip->body].mesh->vertex_count)
            return false;
    }
    return true;
}

/* checks the ranges of the numbers of pel_tool_transfer */
static bool is_whole_tool(const pel_sim *sim, const pel_tool *tool)
{
    const pel_model *model = sim->model;
    if (!is_flag(&tool->driven) || !is_flag(&tool->is_leading) || !is_flag(&tool->blocked) ||
        !is_flag(&tool->is_held_back) || !is_flag(&tool->is_stopped) || !(tool->stride > 0 && tool->stride <= 1) ||
        (unsigned)tool->phase > PEL_GRASP_DONE || tool->plane_count < 0 || tool->plane_count > PEL_PLANE_LIMIT)
        return false;
    if (!has_whole_tips(sim, tool))
        return false;
    for (int32_t p = 0; p < tool->plane_count; p++)
        if (tool->planes[p].triangle < 0 || tool->planes[p].triangle >= model->triangle_begin[model->body_count])
            return false;
    return tool->grasp ? pel_is_list(tool->held, tool->held_count, (size_t)model->vertex_count) : tool->held_count == 0;
}

bool pel_tools_restore(pel_sim *sim)
{
    bool whole = pel_solids_restore(sim);
    for (int32_t t = 0; t < sim->tools->count; t++)
        whole = whole && is_whole_tool(sim, &sim->tools->items[t]);
    for (int32_t t = 0; !whole && t < sim->tools->count; t++) {
        pel_tool *tool = &sim->tools->items[t];
        tool->held_count = tool->plane_count = 0;
        if (tool->blade != NULL) {
            tool->blade->tip_count = 0;
            tool->blade->closed = 1;
        }
        tool->stride = 1;
        tool->driven = tool->is_leading = tool->blocked = tool->is_held_back = tool->is_stopped = false;
        tool->phase = PEL_GRASP_DONE;
    }
    return whole;
}

/* Rigid tools in a step: they follow their keys, hold grasped vertices, and push the surface out. */
#include "sim/contact.h"
#include "sim/tool.h"

/* rounds over the tools at most */
enum { ROUND_LIMIT = 4 };

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
    pel_contact_plane *oldest = tool->planes_before;
    tool->planes_before = tool->planes;
    tool->plane_before_count = tool->plane_count;
    tool->planes = oldest;
    tool->plane_count = 0;
    if (sim->parts.at == 0)
        tool->pose_start = tool->pose;
    tool->pose_before = tool->pose_substep = tool->pose;
    tool->pose = tool->pose_wanted = pel_tool_next_pose(sim, tool, time);
}

void pel_tools_begin(pel_sim *sim, double time)
{
    bool changed = false;
    for (int32_t i = 0; i < sim->tool_count; i++) {
        begin_tool(sim, &sim->tools[i], time);
        changed |= pel_tool_update_grasp(sim, &sim->tools[i], time);
        for (int32_t k = 0; k < sim->tools[i].held_count; k++)
            pel_vec3_set(sim->grip_forces[sim->tools[i].held[k]], 0, 0, 0);
    }
    if (sim->held_vertices != NULL && (changed || !sim->held_is_listed))
        pel_tools_list_held(sim);
    sim->held_is_listed = true;
}

void pel_tools_place(pel_sim *sim, double share)
{
    int32_t count = 0;
    for (int32_t i = 0; i < sim->tool_count; i++) {
        pel_tool *tool = &sim->tools[i];
        tool->pose_substep = tool->pose;
        pel_pose_between(&tool->pose_before, &tool->pose_wanted, share, &tool->pose);
        for (int32_t k = 0; k < tool->held_count; k++)
            pel_pose_to_world(&tool->pose, tool->anchors[k], sim->held_targets[count++]);
    }
}

void pel_tools_move(pel_sim *sim, double time)
{
    pel_tools_begin(sim, time);
    pel_tools_carry(sim);
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
    /* the substeps have kept solids out (tool_solid.h), and no guard looks at them */
    bool moved = !pel_sim_is_projected(sim) || sim->contacts != NULL;
    for (int round = 0; moved && round < (sim->tool_count > 1 ? ROUND_LIMIT : 1); round++) {
        moved = false;
        for (int32_t i = 0; i < sim->tool_count; i++)
            if (presses(&sim->tools[i], only_round))
                moved |= pel_tool_press(sim, &sim->tools[i], longest);
    }
}

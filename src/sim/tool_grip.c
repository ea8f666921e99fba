/* What happens to tools in a step: grasps that exceed their force lose vertices, and tools are held back.

   The grip force of a tool is the sum of the magnitudes of the forces on its held vertices, like the load that a clamp
   carries by friction: it bounds the net force, and a twist whose net force is zero counts as well. Where it exceeds
   the limit, the vertices with the largest forces are lost first, until the forces of the rest are within the limit.
   The rest takes over their load in the next steps, so a grasp tears out step by step. */
#include "sim/tool.h"

void pel_tool_let_go(pel_sim *sim, pel_tool *tool, int32_t i)
{
    sim->held[tool->held[i]] = 0;
    tool->held[i] = tool->held[--tool->held_count];
    pel_vec3_copy(tool->anchors[tool->held_count], tool->anchors[i]);
    sim->held_is_listed = false;
}

static double grip_force(const pel_sim *sim, const pel_tool *tool, int32_t i)
{
    return pel_vec3_length(sim->grip_forces[tool->held[i]]);
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

/* lost vertices move freely from the next step on */
static int32_t lose_vertices(pel_sim *sim, pel_tool *tool)
{
    int32_t lost_count = 0;
    double sum = 0;
    for (int32_t i = 0; i < tool->held_count; i++)
        sum += grip_force(sim, tool, i);
    while (sum > tool->grasp_max_force && tool->held_count > 0) {
        int32_t i = find_largest(sim, tool), v = tool->held[i];
        sum -= grip_force(sim, tool, i);
        pel_tool_let_go(sim, tool, i);
        sim->state->position[v][3] = sim->model->inverse_mass[v];
        lost_count++;
    }
    return lost_count;
}

static void count_loss(pel_tool_tally *tally, int32_t count, double time)
{
    if (tally->lost_count == 0)
        tally->lost_time = time;
    tally->lost_count += count;
}

static void count_hold(pel_tool_tally *tally, double time)
{
    if (tally->held_back_count == 0)
        tally->held_back_time = time;
    tally->held_back_count++;
}

void pel_tools_end_step(pel_sim *sim, double time)
{
    for (int32_t t = 0; t < sim->tool_count; t++) {
        pel_tool *tool = &sim->tools[t];
        int32_t lost = tool->grasp_max_force > 0 ? lose_vertices(sim, tool) : 0;
        if (lost > 0)
            count_loss(&tool->tally, lost, time);
        if (tool->is_held_back && !tool->hold_is_counted)
            count_hold(&tool->tally, time);
        tool->hold_is_counted |= tool->is_held_back;
        if (tool->blocked && !tool->is_held_back) {
            pel_pose wanted = pel_tool_pose_at(tool, time);
            tool->blocked = pel_tool_way(tool, &tool->pose, &wanted) > 0;
        }
    }
}

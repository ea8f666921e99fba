/* Tools on a refining surface: update their triangles and held vertices after an event. */
#include "tool/refine.h"

#include "base/assert.h"
#include "tool/grip.h"
#include "tool/solid.h"

/* a plane stays with its triangle where that is still as it was; where it was refined, with the child at the point */
static bool follow_plane(const pel_sim *sim, int32_t body, pel_contact_plane *plane)
{
    const pel_front *front = sim->model->bodies[body].front;
    int32_t begin = sim->model->triangle_begin[body], number = (int32_t)plane->triangle - begin, node = number / 2;
    if (front->old_shapes[node] == front->shapes[node])
        return true;
    if (front->old_shapes[node] != PEL_FRONT_WHOLE)
        return false;
    double *w = plane->weights;
    int32_t level = pel_front_level(front, node);
    while (front->shapes[node] == PEL_FRONT_RED) {
        int32_t i = w[0] >= 0.5 ? 0 : w[1] >= 0.5 ? 1 : w[2] >= 0.5 ? 2 : 3;
        node = front->node_begin[level + 1] + pel_lod_child(node - front->node_begin[level], i);
        double a = w[0], b = w[1], c = w[2];
        /* corner child (v_i m_i m_(i-1)), middle child (m_0 m_1 m_2) */
        if (i == 3)
            pel_vec3_set(w, 1 - 2 * c, 1 - 2 * a, 1 - 2 * b);
        else if (i == 0)
            pel_vec3_set(w, 2 * a - 1, 2 * b, 2 * c);
        else if (i == 1)
            pel_vec3_set(w, 2 * b - 1, 2 * c, 2 * a);
        else
            pel_vec3_set(w, 2 * c - 1, 2 * a, 2 * b);
        level++;
    }
    plane->triangle = begin + 2 * node;
    return front->shapes[node] == PEL_FRONT_WHOLE;
}

static void follow_planes(const pel_sim *sim, int32_t body, pel_tool *tool)
{
    int32_t kept = 0, begin = sim->model->triangle_begin[body], end = sim->model->triangle_begin[body + 1];
    for (int32_t p = 0; p < tool->plane_count; p++) {
        pel_contact_plane plane = tool->planes[p];
        bool own = plane.triangle >= begin && plane.triangle < end;
        if (!own || follow_plane(sim, body, &plane))
            tool->planes[kept++] = plane;
    }
    tool->plane_count = kept;
}

static void release_places(pel_sim *sim, pel_tool *tool)
{
    const pel_refined_model *active = sim->active;
    for (int32_t r = 0; r < active->released_count; r++) {
        if (!sim->held[active->released[r]])
            continue;
        for (int32_t i = 0; i < tool->held_count; i++)
            if (tool->held[i] == active->released[r]) {
                pel_tool_let_go(sim, tool, i);
                break;
            }
    }
}

/* new vertices between those of a support belong to it */
static void extend_support(pel_sim *sim, int32_t body, pel_tool *tool)
{
    const pel_refined_body *own = &sim->active->bodies[body];
    for (int32_t i = 0; i < own->front->added_count; i++) {
        int32_t v = own->front->added_vertices[i];
        if (tool->support_marks[v])
            pel_tool_hold_at_rest(sim, tool, own->model_index[v]);
    }
}

void pel_tools_update(pel_sim *sim, int32_t body)
{
    PEL_ASSERT_INDEX(body, sim->model->body_count);
    pel_solids_release(sim);
    for (int32_t i = 0; i < sim->tools->count; i++) {
        pel_tool *tool = &sim->tools->items[i];
        follow_planes(sim, body, tool);
        release_places(sim, tool);
        if (tool->support_marks != NULL && tool->body == body && tool->phase == PEL_GRASP_HOLDING)
            extend_support(sim, body, tool);
    }
}

/* Triangles near a tool. They are found as those of a list that is kept over many steps: of the triangles that reached
   into a larger box when the search was fitted to the positions last. While the present box, grown by the displacements
   since then, lies in that larger one, a triangle that is not listed cannot reach into it, and only listed ones are
   tested. The result is that of a test of all triangles, so it does not depend on how old the list is. */
#include "tool/near.h"

#include "base/lane.h"

#include <string.h>

/* growth of the box of a list, relative to the margin (half and twice as much: a step of a sphere is 0.5 % slower) */
#define GROWTH 1.0
/* displacement since the fit, relative to that growth, beyond which a new list needs a new fit */
#define DRIFT_SHARE 0.5

pel_search_box pel_tool_box(const pel_tool *tool, double width, double margin)
{
    double local[3], axis[3], half[3] = {0, 0, 0};
    pel_solid_half_box(&tool->solid, local);
    for (int i = 0; i < 3; i++) {
        double extent = local[i] + width;
        pel_vec3_set(axis, i == 0 ? extent : 0, i == 1 ? extent : 0, i == 2 ? extent : 0);
        pel_rotate(tool->pose.rotation, axis, axis);
        for (int j = 0; j < 3; j++)
            half[j] += fabs(axis[j]);
    }
    pel_search_box box = {{0}, {0}};
    for (int i = 0; i < 3; i++) {
        box.low[i] = (pel_real)(tool->pose.position[i] - half[i] - margin);
        box.high[i] = (pel_real)(tool->pose.position[i] + half[i] + margin);
    }
    return box;
}

/* by a width along each axis, and by the rounding of displacements */
static pel_search_box grown(const pel_search_box *box, pel_record width)
{
    const pel_real rounding = 8 * (pel_real)PEL_REAL_EPSILON;
    const pel_record size = pel_record_max(pel_record_max(box->high, -box->low), pel_record_max(box->low, -box->high));
    const pel_record growth = width + rounding * (size + width);
    return (pel_search_box){box->low - growth, box->high + growth};
}

static bool serves(const pel_near_list *list, const pel_tool_search *search, const pel_search_box *needed)
{
    pel_search_box own;
    memcpy(&own, list->box, sizeof own);
    return search->is_fitted && list->fit == search->fit_count && !pel_record_exceeds(own.low, needed->low) &&
           !pel_record_exceeds(needed->high, own.high);
}

static int32_t find(pel_sim *sim, const pel_tool *tool, const pel_search_box *box, int32_t *triangles)
{
    int32_t count = 0;
    for (int32_t b = 0; b < sim->model->body_count; b++)
        if (pel_tool_acts_on(tool, b))
            count = pel_tool_search_find(sim->tools->search, b, box, triangles, count);
    pel_tool_search_sort(sim->tools->search, triangles, count);
    return count;
}

/* lists what may come near the box while surface and tool move a little */
static void renew(pel_sim *sim, const pel_tool *tool, const pel_record *positions, const pel_search_box *box,
                  double margin, pel_record drift, pel_near_list *list)
{
    const pel_real growth = (pel_real)(GROWTH * margin), limit = (pel_real)DRIFT_SHARE * growth;
    const pel_record limits = {limit, limit, limit, limit}, none = {0};
    if (!sim->tools->search->is_fitted || pel_record_exceeds(drift, limits)) {
        pel_tool_search_fit(sim->tools->search, positions, true);
        drift = none;
    }
    const pel_search_box larger = grown(box, drift + growth);
    memcpy(list->box, &larger, sizeof larger);
    list->fit = sim->tools->search->fit_count;
    list->count = find(sim, tool, &larger, list->triangles);
}

/* Surfaces that refine change in many steps, and lists would not serve. At the start of a step the boxes serve all
   tools. */
static void fit_changing(pel_sim *sim, const pel_record *positions)
{
    pel_tool_search *search = sim->tools->search;
    bool at_start = positions == sim->state->position;
    const pel_search_state state = {at_start ? positions : NULL, sim->state_number, sim->part.at};
    bool is_known = search->is_fitted && at_start && state.positions == search->state.positions &&
                    state.number == search->state.number && state.part == search->state.part;
    if (!is_known)
        pel_tool_search_fit(search, positions, false);
    search->state = state;
}

int32_t pel_tool_near_triangles(pel_sim *sim, const pel_tool *tool, pel_near_list *list, const pel_record *positions,
                                double margin)
{
    pel_tool_search *search = sim->tools->search;
    const pel_search_box box = pel_tool_box(tool, tool->press_margin, margin);
    if (sim->active != NULL) {
        fit_changing(sim, positions);
        return find(sim, tool, &box, sim->tools->near_triangles);
    }
    const pel_record drift = pel_tool_search_drift(search, positions);
    const pel_search_box needed = grown(&box, drift);
    if (!serves(list, search, &needed))
        renew(sim, tool, positions, &box, margin, drift, list);
    int32_t count = 0;
    for (int32_t i = 0; i < list->count; i++) {
        const pel_search_box around = pel_search_triangle(positions, sim->model->triangles[list->triangles[i]]);
        sim->tools->near_triangles[count] = list->triangles[i];
        count += !pel_search_apart(&around, &box);
    }
    return count;
}

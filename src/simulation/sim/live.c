/* Loads, tools, pins and forces that are added, removed or moved while a simulation runs. */
#include "pellicle/live.h"
#include "base/memory.h"
#include "base/status.h"
#include "boundary/forces.h"
#include "boundary/loads.h"
#include "sim/change.h"
#include "tool/tool.h"

#include <string.h>

/* ---- lists of a change ---- */

/* a list with one more element at its end, or one less; null when out of memory */
static void *resize_list(pel_change *change, const void *list, int32_t count, size_t size, const void *added,
                         int32_t removed)
{
    size_t kept = (size_t)count * size;
    char *made = pel_copies_room(&change->copies, kept + size);
    if (made == NULL)
        return NULL;
    if (kept > 0)
        memcpy(made, list, kept);
    if (added != NULL)
        memcpy(made + kept, added, size);
    else
        memmove(made + (size_t)removed * size, made + ((size_t)removed + 1) * size,
                (size_t)(count - removed - 1) * size);
    return made;
}

static pel_status resize_loads(pel_change *change, const pel_load_def *added, int32_t removed, pel_error *error)
{
    pel_sim_def *sim = &change->sim;
    sim->loads = resize_list(change, sim->loads, sim->load_count, sizeof *sim->loads, added, removed);
    sim->load_count += added != NULL ? 1 : -1;
    return sim->loads != NULL ? PEL_OK : pel_fail_memory(error);
}

static pel_status resize_tools(pel_change *change, const pel_tool_def *added, int32_t removed, pel_error *error)
{
    pel_sim_def *sim = &change->sim;
    sim->tools = resize_list(change, sim->tools, sim->tool_count, sizeof *sim->tools, added, removed);
    sim->tool_count += added != NULL ? 1 : -1;
    return sim->tools != NULL ? PEL_OK : pel_fail_memory(error);
}

/* ---- loads ---- */

int32_t pel_sim_load_count(const pel_sim *sim)
{
    if (sim == NULL)
        return 0;
    return sim->loads->count;
}

const char *pel_sim_load_name(const pel_sim *sim, int32_t load)
{
    if (load < 0 || load >= pel_sim_load_count(sim))
        return "";
    return sim->loads->items[load].name;
}

pel_status pel_sim_add_load(pel_sim *sim, const pel_load_def *def, pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    PEL_REFUSE_NULL(def, error);
    pel_change change;
    for (int32_t l = 0; def->name != NULL && def->name[0] != '\0' && l < sim->loads->count; l++)
        if (strcmp(sim->loads->items[l].name, def->name) == 0)
            return pel_fail(error, PEL_BAD_ARGUMENT, "there is a load '%s' already", def->name);
    pel_status status = pel_change_begin(sim, &change, error);
    if (status == PEL_OK)
        status = resize_loads(&change, def, -1, error);
    if (status == PEL_OK)
        status = pel_change_apply(sim, &change, error);
    pel_change_end(&change);
    return status;
}

pel_status pel_sim_remove_load(pel_sim *sim, int32_t load, pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    pel_change change;
    if (load < 0 || load >= sim->loads->count)
        return pel_fail(error, PEL_BAD_ARGUMENT, "load %d does not exist", (int)load);
    pel_status status = pel_change_begin(sim, &change, error);
    if (status == PEL_OK)
        status = resize_loads(&change, NULL, load, error);
    if (status == PEL_OK)
        status = pel_change_apply(sim, &change, error);
    pel_change_end(&change);
    return status;
}

/* ---- tools ---- */

pel_status pel_sim_add_tool(pel_sim *sim, const pel_tool_def *def, pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    PEL_REFUSE_NULL(def, error);
    pel_change change;
    if (def->shape == PEL_TOOL_SUPPORT)
        return pel_refuse(error, PEL_BAD_ARGUMENT,
                          "add a tool that grasps, or pin vertices where they are (pel_sim_set_pins)",
                          "a support that moves on keys starts at rest");
    pel_status status = pel_change_begin(sim, &change, error);
    if (status == PEL_OK)
        status = resize_tools(&change, def, -1, error);
    if (status == PEL_OK)
        status = pel_change_apply(sim, &change, error);
    pel_change_end(&change);
    return status;
}

static pel_status refuse_tool(int32_t tool, pel_error *error)
{
    return pel_fail(error, PEL_BAD_ARGUMENT, "tool %d does not exist", (int)tool);
}

pel_status pel_sim_remove_tool(pel_sim *sim, int32_t tool, pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    pel_change change;
    if (tool < 0 || tool >= sim->tools->count)
        return refuse_tool(tool, error);
    pel_status status = pel_change_begin(sim, &change, error);
    if (status == PEL_OK)
        status = resize_tools(&change, NULL, tool, error);
    if (status == PEL_OK)
        status = pel_change_apply(sim, &change, error);
    pel_change_end(&change);
    return status;
}

pel_status pel_sim_set_tool_keys(pel_sim *sim, int32_t tool, const pel_pose_key *keys, int32_t key_count,
                                 pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    PEL_REFUSE_NULL(keys, error);
    pel_change change;
    if (tool < 0 || tool >= sim->tools->count)
        return refuse_tool(tool, error);
    pel_status status = pel_change_begin(sim, &change, error);
    if (status == PEL_OK) {
        pel_tool_def *def = pel_change_tool(&change, tool);
        def->keys = keys;
        def->key_count = key_count;
        status = pel_change_apply(sim, &change, error);
    }
    pel_change_end(&change);
    if (status != PEL_OK)
        return status;
    /* from where it is it catches up with its keys */
    sim->tools->items[tool].driven = sim->tools->items[tool].is_leading = false;
    sim->tools->items[tool].blocked = pel_sim_step_count(sim) > 0;
    return PEL_OK;
}

/* ---- pins ---- */

pel_status pel_sim_set_pins(pel_sim *sim, int32_t body, const int32_t *vertices, int32_t vertex_count, pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    pel_change change;
    if (body < 0 || body >= sim->model->body_count || vertex_count < 0 || (vertices == NULL && vertex_count > 0))
        return pel_fail(error, PEL_BAD_ARGUMENT, "body %d does not exist, or its pins are not given", (int)body);
    pel_status status = pel_change_begin(sim, &change, error);
    if (status == PEL_OK) {
        pel_change_body(&change, body)->pinned = vertices;
        pel_change_body(&change, body)->pinned_count = vertex_count;
        change.changes_model = true;
        status = pel_change_apply(sim, &change, error);
    }
    pel_change_end(&change);
    return status;
}

/* ---- forces ---- */

pel_status pel_sim_set_forces(pel_sim *sim, int32_t body, const double *forces, pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    if (body < 0 || body >= sim->model->body_count)
        return pel_fail(error, PEL_BAD_ARGUMENT, "body %d does not exist", (int)body);
    const pel_body *own = &sim->model->bodies[body];
    size_t count = 3 * (size_t)own->mesh->vertex_count;
    for (size_t i = 0; forces != NULL && i < count; i++)
        if (!isfinite(forces[i])) {
            pel_fail(error, PEL_BAD_ARGUMENT, "force is not finite");
            pel_fail_element(error, "vertex", (int64_t)(i / 3));
            return PEL_BAD_ARGUMENT;
        }
    if (forces == NULL && sim->loads->external == NULL)
        return PEL_OK;
    pel_status status = pel_sim_make_forces(sim, true, error);
    for (size_t i = 0; status == PEL_OK && i < count; i++)
        sim->loads->external[own->model_index[i / 3]][i % 3] = forces != NULL ? (pel_real)forces[i] : 0;
    sim->present.has_force = false;
    return status;
}

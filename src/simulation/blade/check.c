#include "blade/check.h"

#include "base/memory.h"
#include "base/status.h"
#include "blade/hold.h"
#include "boundary/loads.h"
#include "geom/sweep.h"

#include <math.h>

static bool is_number(double value)
{
    return value >= 0 && isfinite(value);
}

static pel_status check_body(const pel_sim *sim, const pel_tool_def *def, int32_t body, int32_t tool, pel_error *error)
{
    const pel_body_def *own = &sim->given->def.bodies[body];
    const char *name = sim->given->bodies[body].name;
    pel_pressure_kind kind = own->shell.pressure.kind;
    if (def->shape == PEL_TOOL_HOOK)
        return PEL_OK;
    if (sim->given->bodies[body].detail != NULL)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool,
                                  "leave out `refine` and subdivide the mesh before (`pellicle subdivide`), or give "
                                  "the blade another `body`",
                                  "blade '%s' acts on body '%s', which refines", def->name, name);
    if (kind == PEL_PRESSURE_GAS || kind == PEL_PRESSURE_VOLUME)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool,
                                  "give its pressure as a number or keys, or give the blade another `body`",
                                  "blade '%s' would open body '%s', which encloses a gas or has a target volume",
                                  def->name, name);
    if (def->sharpness > 0 && !own->shell.membrane.on && !(own->spring_thickness > 0))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool,
                                  "give the body a membrane or `springs: { young, thickness }`, or leave out sharpness",
                                  "blade '%s' has a sharpness, but the thickness of body '%s' is not known", def->name,
                                  name);
    return PEL_OK;
}

static pel_status check_def(const pel_sim *sim, const pel_tool_def *def, int32_t tool, pel_error *error)
{
    double length = pel_vec3_distance(def->edge[0], def->edge[1]);
    if (!(length > 0) || !isfinite(length))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool,
                                  "give two points of the tool's frame that are apart, such as edge: [[0, 0, -0.01], "
                                  "[0, 0, 0.01]]",
                                  "the edge of '%s' has no length", def->name);
    if (def->shape == PEL_TOOL_SCISSORS && (def->sharpness != 0 || def->kerf != 0))
        return pel_refuse_element(
            error, PEL_BAD_ARGUMENT, "tool", tool, "leave out sharpness and kerf, or use shape: blade",
            "scissors '%s' have a sharpness or a kerf: their blades exert no force on the surface", def->name);
    if (!is_number(def->sharpness) || !is_number(def->kerf))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool,
                                  "give a sharpness in J/m2 and a kerf in m of at least 0",
                                  "blade '%s' has a sharpness or a kerf out of range", def->name);
    if (def->grasp || def->leads)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool, "use a second tool to grasp",
                                  "'%s' has an edge and a grasp", def->name);
    if (sim->def.tie_count > 0 && def->shape != PEL_TOOL_HOOK)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool, "leave attachments and stitches out",
                                  "blade '%s' beside attachments or stitches", def->name);
    if (def->sharpness > 0 && def->shape == PEL_TOOL_BLADE && !pel_stepper_knows_material(sim->stepper))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool, "use method: implicit, or leave out sharpness",
                                  "blade '%s' has a sharpness under a method that does not balance its force",
                                  def->name);
    if (sim->def.solver.path != PEL_PATH_TIME || sim->def.solver.analysis != PEL_ANALYSIS_NONE)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool, "use steps over time",
                                  "'%s' along a path of balances or in an analysis", def->name);
    pel_status status = PEL_OK;
    for (int32_t b = 0; status == PEL_OK && b < sim->given->body_count; b++)
        if (def->body < 0 || def->body == b)
            status = check_body(sim, def, b, tool, error);
    return status;
}

pel_status pel_blade_check_start(const pel_sim *sim, int32_t index, pel_error *error)
{
    pel_tool *tool = &sim->tools->items[index];
    pel_blade_close(sim, tool);
    tool->blade->closed_before = tool->blade->closed;
    /* open scissors reach around a surface, from a place on it too */
    if (tool->solid.shape == PEL_TOOL_SCISSORS && !(tool->blade->closed > 0))
        return PEL_OK;
    double edge[2][3], corners[3][3], weights[3];
    pel_blade_edge_at(tool, &tool->pose, 1, edge);
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_body *body = &sim->model->bodies[b];
        for (int32_t t = 0; pel_tool_acts_on(tool, b) && t < body->mesh->triangle_count; t++) {
            for (int c = 0; c < 3; c++)
                pel_vertex_position(sim->state->position, body->model_index[body->mesh->triangles[t][c]], corners[c]);
            if (!pel_segment_passes((const double(*)[3])edge, (const double(*)[3])corners, weights))
                continue;
            double x[3] = {0};
            for (int c = 0; c < 3; c++)
                pel_vec3_along(x, weights[c], corners[c], x);
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", index,
                                      "start it beside the surface, or beyond its border, and lead it in by `motion`",
                                      "'%s' starts in the surface of body '%s', at (%.4g, %.4g, %.4g)", tool->name,
                                      body->name, x[0], x[1], x[2]);
        }
    }
    return PEL_OK;
}

pel_status pel_blades_create(pel_sim *sim, pel_error *error)
{
    pel_status status = PEL_OK;
    bool drags = false;
    for (int32_t t = 0; status == PEL_OK && t < sim->tools->count; t++) {
        if (sim->tools->items[t].blade == NULL)
            continue;
        status = check_def(sim, &sim->def.tools[t], t, error);
        if (status == PEL_OK && !sim->goes_on)
            status = pel_blade_check_start(sim, t, error);
        drags |= sim->def.tools[t].sharpness > 0 && !sim->stepper->is_static;
    }
    if (status != PEL_OK || !drags)
        return status;
    sim->loads->dragged = pel_allocate((size_t)sim->model->vertex_count, sizeof *sim->loads->dragged);
    return sim->loads->dragged != NULL ? PEL_OK : pel_fail_memory(error);
}

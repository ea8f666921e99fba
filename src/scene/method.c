#include "scene/method.h"

#include "model/model.h"
#include "model/shell.h"
#include "scene/build.h"

static bool is_pinned(const pel_model *model, int32_t body)
{
    for (int32_t v = model->bodies[body].slice_begin * PEL_WIDTH; v < model->bodies[body].slice_end * PEL_WIDTH; v++)
        if (model->mass[v] > 0 && !(model->inverse_mass[v] > 0))
            return true;
    return false;
}

/* held by a support that moves */
static bool is_supported(const pel_scene *scene, int32_t body)
{
    for (int32_t t = 0; t < scene->sim.tool_count; t++)
        if (scene->sim.tools[t].shape == PEL_TOOL_SUPPORT && scene->sim.tools[t].body == body)
            return true;
    return false;
}

/* a force that a free body cannot balance: gravity, a load, a pressure on an open surface or on a part of it */
static bool is_driven(const pel_scene *scene, const pel_model *model, int32_t b)
{
    const double *gravity = model->gravity;
    const pel_shell *shell = model->bodies[b].shell;
    bool driven = gravity[0] != 0 || gravity[1] != 0 || gravity[2] != 0;
    for (int32_t l = 0; l < scene->sim.load_count; l++)
        driven |= scene->sim.loads[l].body == b;
    if (shell != NULL && shell->pressure.kind != PEL_PRESSURE_NONE)
        driven |= !model->bodies[b].closed || shell->pressure_weights != NULL ||
                  shell->pressure.form != PEL_PRESSURE_CONSISTENT;
    return driven;
}

/* what only position-based methods know: strain limits, regions that cave in */
static bool needs_projection(const pel_shell *shell)
{
    if (shell != NULL && shell->strain_limit > 0)
        return true;
    for (int32_t r = 0; shell != NULL && r < shell->region_count; r++)
        if (shell->regions[r].def.mode == PEL_FIBRE_CAVE)
            return true;
    return false;
}

/* every body is held, or free of net forces, and minimisation knows its energy */
static bool has_rest(const pel_scene *scene, const pel_model *model)
{
    for (int32_t b = 0; b < model->body_count; b++) {
        bool held = is_pinned(model, b) || is_supported(scene, b) || model->bodies[b].has_volumetric;
        if ((!held && is_driven(scene, model, b)) || needs_projection(model->bodies[b].shell))
            return false;
    }
    return true;
}

static pel_status take_descent(pel_scene_reader *reader, const pel_scene_value *root, pel_scene *scene, int32_t needed)
{
    pel_solver_def *solver = &scene->sim.solver;
    pel_scene_value *method = pel_scene_value_at(root, "solver.method");
    pel_log_line(reader->log,
                 "method descent: xpbd would need %d substeps in a step of %g s, more than max_substeps %d. The run "
                 "finds states of rest; for motion write `method: xpbd` and `max_substeps: %d`, or a smaller dt",
                 (int)needed, solver->dt, (int)solver->max_substeps, (int)needed);
    solver->method = PEL_METHOD_DESCENT;
    method->text = pel_scene_method_name(PEL_METHOD_DESCENT);
    return PEL_OK;
}

pel_status pel_scene_choose_method(pel_scene_reader *reader, const pel_scene_value *root, pel_scene *scene)
{
    const pel_solver_def *solver = &scene->sim.solver;
    const pel_scene_value *method = pel_scene_value_at(root, "solver.method");
    pel_model *model;
    int32_t needed = 0;
    if (!method->is_implied || solver->method != PEL_METHOD_XPBD || solver->substeps > 0 || solver->iterations > 0)
        return PEL_OK;
    pel_status status = pel_model_create(&scene->model, &model, NULL);
    if (status != PEL_OK)
        return status == PEL_OUT_OF_MEMORY ? pel_fail_memory(reader->error) : PEL_OK;
    pel_sim_def def = scene->sim;
    def.model = model;
    status = pel_sim_needed_substeps(&def, &needed, NULL);
    bool takes = status == PEL_OK && needed > solver->max_substeps && has_rest(scene, model);
    pel_model_destroy(model);
    if (status == PEL_OUT_OF_MEMORY)
        return pel_fail_memory(reader->error);
    return takes ? take_descent(reader, root, scene, needed) : PEL_OK;
}

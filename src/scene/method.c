#include "scene/method.h"

#include "model/model.h"
#include "model/shell.h"
#include "scene/build.h"

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

/* forces alone move every body, on a surface that stays */
static bool is_solvable(const pel_model *model)
{
    for (int32_t b = 0; b < model->body_count; b++)
        if (needs_projection(model->bodies[b].shell) || model->bodies[b].detail != NULL)
            return false;
    return true;
}

static void take_implicit(pel_scene_reader *reader, const pel_scene_value *root, pel_scene *scene, int32_t needed)
{
    pel_solver_def *solver = &scene->sim.solver;
    pel_scene_value *method = pel_scene_value_at(root, "solver.method");
    pel_log_line(reader->log,
                 "method implicit: xpbd would need %d substeps in a step of %g s, more than max_substeps %d",
                 (int)needed, solver->dt, (int)solver->max_substeps);
    solver->method = PEL_METHOD_IMPLICIT;
    method->text = pel_scene_method_name(PEL_METHOD_IMPLICIT);
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
    bool takes = status == PEL_OK && needed > solver->max_substeps && is_solvable(model);
    pel_model_destroy(model);
    if (status == PEL_OUT_OF_MEMORY)
        return pel_fail_memory(reader->error);
    if (takes)
        take_implicit(reader, root, scene, needed);
    return PEL_OK;
}

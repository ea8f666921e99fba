/* Rest shapes that a buckling mode changes: the modes of the scene's own loads and supports, without tools and contact.
 */
#include "scene/build.h"

#include "base/memory.h"
#include "base/status.h"
#include "math/extremes.h"
#include "math/vec3.h"
#include "pellicle/sim.h"
#include "stage/stepper.h"

/* that which has analyses */
static pel_method static_method(void)
{
    int m = 0;
    while (!pel_stepper_of((pel_method)m)->is_static)
        m++;
    return (pel_method)m;
}

/* the analysis after as many steps as the number of the mode, which it shows then */
static pel_status find_mode(const pel_scene *scene, pel_model **model, pel_sim **sim, pel_error *error)
{
    pel_sim_def def = scene->sim;
    def.tool_count = 0;
    def.contact.enabled = false;
    def.solver.method = static_method();
    def.solver.path = PEL_PATH_TIME;
    def.solver.analysis = PEL_ANALYSIS_BUCKLING;
    def.solver.mode_count = scene->imperfection_mode;
    pel_status status = pel_model_create(&scene->model, model, error);
    def.model = *model;
    if (status == PEL_OK)
        status = pel_sim_create(&def, sim, error);
    for (int32_t m = 0; status == PEL_OK && m < scene->imperfection_mode; m++)
        status = pel_sim_step(*sim, error);
    return status;
}

/* adds the mode, with its largest displacement as given, to meshes that belong to the scene */
static pel_status add_mode(const pel_scene *scene, const pel_sim *sim, pel_mesh *const *meshes, int32_t mesh_count,
                           pel_error *error)
{
    double largest = 0;
    double(*modes[2])[3] = {NULL, NULL};
    pel_status status = PEL_OK;
    for (int round = 0; round < 2; round++)
        for (int32_t b = 0; status == PEL_OK && b < scene->model.body_count; b++) {
            const pel_mesh *mesh = scene->model.bodies[b].mesh;
            for (int i = 0; i < 2; i++)
                modes[i] = pel_allocate((size_t)mesh->vertex_count, sizeof *modes[i]);
            status = modes[0] != NULL && modes[1] != NULL ? PEL_OK : pel_fail_memory(error);
            if (status == PEL_OK) {
                pel_sim_get_positions(sim, b, &modes[0][0][0]);
                pel_sim_get_rest_positions(sim, b, &modes[1][0][0]);
            }
            int32_t own = 0;
            while (own < mesh_count && meshes[own] != mesh)
                own++;
            for (int32_t v = 0; status == PEL_OK && v < mesh->vertex_count; v++) {
                double move[3];
                pel_vec3_subtract(modes[0][v], modes[1][v], move);
                if (round == 0)
                    largest = pel_max(largest, pel_vec3_length(move));
                else if (own < mesh_count)
                    pel_vec3_along(meshes[own]->positions[v], scene->imperfection_amplitude / largest, move,
                                   meshes[own]->positions[v]);
            }
            pel_free(modes[0]);
            pel_free(modes[1]);
        }
    return status;
}

pel_status pel_scene_make_imperfect(pel_scene_reader *reader, pel_scene_value *root, pel_scene *scene,
                                    pel_mesh *const *meshes, int32_t mesh_count)
{
    const pel_scene_value *value = pel_scene_value_entry(root, "imperfection");
    pel_model *model = NULL;
    pel_sim *sim = NULL;
    if (value == NULL || !(scene->imperfection_amplitude > 0))
        return PEL_OK;
    pel_error cause = {0};
    pel_status status = find_mode(scene, &model, &sim, &cause);
    if (status == PEL_OK)
        status = add_mode(scene, sim, meshes, mesh_count, &cause);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    if (status == PEL_OK || status == PEL_OUT_OF_MEMORY) {
        *reader->error = status == PEL_OK ? *reader->error : cause;
        return status;
    }
    pel_scene_fail(reader, &value->place, "no buckling mode %d for the imperfection: %s", (int)scene->imperfection_mode,
                   cause.what);
    pel_fail_remedy(reader->error, "%s", cause.remedy);
    return PEL_BAD_SCENE;
}

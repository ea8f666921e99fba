#include "scene/patch.h"

#include "choice/time_step.h"
#include "scene/build.h"
#include "stage/stepper.h"

#include <string.h>

/* numbers of loads and tools take no part in the choice of a method */
static bool is_chosen_by(pel_def_kind kind)
{
    return kind != PEL_DEF_LOAD && kind != PEL_DEF_TOOL;
}

/* meshes that became finer follow from nearly all numbers of bodies, loads and tools */
static bool has_fine_mesh(const pel_scene *scene)
{
    bool has = false;
    for (int32_t b = 0; b < scene->model.body_count; b++)
        has |= pel_scene_is_fine(scene, b);
    return has;
}

/* and so may the step: explicit's is what is stable, implicit's what resolves vibrations and loads */
static bool leaves_dt(const pel_scene *scene)
{
    const pel_stepper *stepper = pel_stepper_of(scene->sim.solver.method);
    return (stepper->is_explicit || (stepper->minimises && stepper->has_velocity)) &&
           pel_scene_value_at(pel_scene_root(scene), "solver.dt")->is_implied;
}

bool pel_scene_patch_find(const pel_scene *scene, const char *path, pel_parameter_place *place)
{
    if (pel_parameter_find_place(&scene->model, &scene->sim, path, place, NULL) != PEL_OK)
        return false;
    const pel_def_row *row = pel_def_row_at(place->row);
    bool leaves_method = pel_scene_value_at(pel_scene_root(scene), "solver.method")->is_implied;
    /* supports and fibres are checked by the scene */
    bool is_checked = row->def == PEL_DEF_SUPPORT || row->def == PEL_DEF_FIBRES;
    return row->refusal == NULL && !row->is_implying && !is_checked && !has_fine_mesh(scene) && !leaves_dt(scene) &&
           !(leaves_method && is_chosen_by(row->def));
}

bool pel_scene_patch(pel_scene *scene, pel_parameter_place place, const char *text)
{
    return pel_parameter_write(&scene->model, &scene->sim, place, text);
}

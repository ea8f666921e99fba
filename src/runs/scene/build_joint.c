/* Joints of rigid bodies of a scene. */
#include "base/memory.h"
#include "keys/table.h"
#include "keys/validate.h"
#include "scene/build.h"

#include <math.h>

/* rad */
#define DEGREE 0.017453292519943295

static pel_status read_joint(pel_scene_reader *reader, pel_scene_value *value, const pel_scene *scene,
                             pel_joint_def *joint)
{
    *joint = pel_joint_def_default();
    const pel_scene_value *to = pel_scene_value_entry(value, "to");
    pel_status status = pel_scene_fill_body(reader, value, &scene->model, "joint");
    const pel_scene_part part = {reader, value, NULL};
    if (status == PEL_OK)
        status = pel_scene_read_members(&part, PEL_DEF_JOINT, joint);
    if (status == PEL_OK)
        status = pel_scene_find_body(reader, pel_scene_value_entry(value, "body"), &scene->model, &joint->body);
    joint->to_body = -1;
    if (status == PEL_OK && to != NULL)
        status = pel_scene_find_body(reader, to, &scene->model, &joint->to_body);
    double unit = joint->kind == PEL_JOINT_HINGE ? DEGREE : 1;
    joint->least *= unit;
    joint->most *= unit;
    joint->speed *= unit;
    return status;
}

pel_status pel_scene_build_joints(pel_scene_reader *reader, const pel_scene_value *root, pel_scene *scene)
{
    const pel_scene_value *list = pel_scene_value_entry(root, "joints");
    pel_joint_def *joints = pel_arena_take(reader->arena, (size_t)pel_scene_value_count(list), sizeof *joints);
    if (joints == NULL && pel_scene_value_count(list) > 0)
        return pel_fail_memory(reader->error);
    int32_t count = 0;
    pel_status status = pel_scene_check_names(reader, list);
    for (pel_scene_value *value = list->first; status == PEL_OK && value != NULL; value = value->next)
        status = read_joint(reader, value, scene, &joints[count++]);
    scene->sim.joints = joints;
    scene->sim.joint_count = count;
    return status;
}

/* Rigid bodies on joints. Include after rigid_scene.h. */
#ifndef JOINT_SCENE_H
#define JOINT_SCENE_H

#include "../rigid/rigid_scene.h"

#define GRAVITY 9.81

static inline pel_joint_def joint_of(const char *name, pel_joint_kind kind, double x, double y, double z)
{
    pel_joint_def def = pel_joint_def_default();
    def.name = name;
    def.kind = kind;
    pel_vec3_set(def.point, x, y, z);
    pel_vec3_set(def.axis, 0, 1, 0);
    return def;
}

/* without contact and weight */
static inline void begin_joints(rigid_scene *scene, pel_method method, pel_joint_def *joints, int32_t count)
{
    rigid_scene_begin(scene);
    scene->def.solver.method = method;
    scene->def.contact.enabled = false;
    scene->def.joints = joints;
    scene->def.joint_count = count;
}

/* a box of 1 kg under its weight on a slider that leads down by an angle, to a limit at 0.6 m */
static inline void begin_slider(rigid_scene *scene, pel_method method, pel_joint_def *joint, double angle)
{
    static const double center[3] = {0.3, 0, 0};
    *joint = joint_of("rail", PEL_JOINT_SLIDER, 0, 0, 0);
    pel_vec3_set(joint->axis, -2 * cos(angle), 0, -2 * sin(angle));
    joint->most = 0.6;
    begin_joints(scene, method, joint, 1);
    scene->gravity = -GRAVITY;
    rigid_scene_add(scene, make_box(0.1, 0.1, 0.1, center), 1000);
    rigid_scene_make(scene);
}

static inline pel_joint_reading read_joint(const rigid_scene *scene, int32_t joint)
{
    pel_joint_reading reading;
    assert_true(pel_sim_get_joint(scene->sim, joint, &reading));
    return reading;
}

#endif

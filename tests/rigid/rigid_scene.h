/* Simulations of rigid bodies for tests. */
#ifndef PEL_TESTS_RIGID_SCENE_H
#define PEL_TESTS_RIGID_SCENE_H

#include "check.h"
#include "math/vec3.h"
#include "pellicle/shape.h"
#include "pellicle/sim.h"

enum { RIGID_BODIES = 32, RIGID_TOOLS = 4 };

typedef struct rigid_scene {
    pel_body_def bodies[RIGID_BODIES];
    pel_mesh *meshes[RIGID_BODIES];
    char names[RIGID_BODIES][8];
    pel_tool_def tools[RIGID_TOOLS];
    pel_pose_key keys[RIGID_TOOLS];
    int32_t body_count, tool_count;
    pel_model *model;
    pel_sim_def def;
    pel_sim *sim;
    double gravity;
} rigid_scene;

static inline void rigid_scene_begin(rigid_scene *scene)
{
    memset(scene, 0, sizeof *scene);
    scene->def = pel_sim_def_default();
    scene->def.solver.method = PEL_METHOD_XPBD;
    scene->def.solver.dt = 0.01;
    scene->def.contact.enabled = true;
    scene->def.contact.friction = 0;
}

/* the mesh belongs to the scene */
static inline pel_body_def *rigid_scene_add(rigid_scene *scene, pel_mesh *mesh, double density)
{
    int32_t i = scene->body_count++;
    snprintf(scene->names[i], sizeof scene->names[i], "b%d", (int)i);
    scene->meshes[i] = mesh;
    scene->bodies[i] = pel_body_def_default();
    scene->bodies[i].name = scene->names[i];
    scene->bodies[i].mesh = mesh;
    scene->bodies[i].rigid.on = true;
    scene->bodies[i].rigid.density = density;
    return &scene->bodies[i];
}

/* a box of a tool whose upper face has this normal, in the plane x-z, and goes through the origin */
static inline void rigid_scene_floor(rigid_scene *scene, double angle)
{
    pel_tool_def *tool = &scene->tools[scene->tool_count];
    pel_pose_key *key = &scene->keys[scene->tool_count];
    const double half = 0.05;
    *tool = pel_tool_def_default();
    tool->name = "floor";
    tool->shape = PEL_TOOL_BOX;
    pel_vec3_set(tool->half_extents, 3, 3, half);
    *key = (pel_pose_key){.position = {-half * sin(angle), 0, -half * cos(angle)}, .rotation_vector = {0, angle, 0}};
    key->rotation[3] = 1;
    tool->keys = key;
    tool->key_count = 1;
    scene->tool_count++;
}

static inline pel_status rigid_scene_try(rigid_scene *scene, pel_error *error)
{
    pel_model_def model = pel_model_def_default();
    model.bodies = scene->bodies;
    model.body_count = scene->body_count;
    model.gravity[2] = scene->gravity;
    pel_status status = pel_model_create(&model, &scene->model, error);
    scene->def.model = scene->model;
    scene->def.tools = scene->tools;
    scene->def.tool_count = scene->tool_count;
    return status == PEL_OK ? pel_sim_create(&scene->def, &scene->sim, error) : status;
}

static inline void rigid_scene_make(rigid_scene *scene)
{
    pel_error error = {0};
    if (rigid_scene_try(scene, &error) != PEL_OK)
        fail_msg("%s (%s)", error.what, error.remedy);
}

static inline void rigid_scene_end(rigid_scene *scene)
{
    pel_sim_destroy(scene->sim);
    pel_model_destroy(scene->model);
    for (int32_t i = 0; i < scene->body_count; i++)
        pel_mesh_destroy(scene->meshes[i]);
}

static inline void rigid_scene_run(rigid_scene *scene, double time)
{
    pel_error error = {0};
    while (pel_sim_time(scene->sim) < time - 1e-9)
        if (pel_sim_step(scene->sim, &error) != PEL_OK)
            fail_msg("%s (%s)", error.what, error.remedy);
}

static inline pel_rigid_reading rigid_scene_read(const rigid_scene *scene, int32_t body)
{
    pel_rigid_reading reading;
    assert_true(pel_sim_get_rigid(scene->sim, body, &reading));
    return reading;
}

/* of all bodies, about the origin */
static inline void rigid_scene_momenta(const rigid_scene *scene, double momentum[3], double angular[3])
{
    pel_vec3_set(momentum, 0, 0, 0);
    pel_vec3_set(angular, 0, 0, 0);
    for (int32_t b = 0; b < scene->body_count; b++) {
        pel_rigid_reading reading = rigid_scene_read(scene, b);
        double turn[3];
        pel_vec3_cross(reading.center, reading.momentum, turn);
        pel_vec3_add(momentum, reading.momentum, momentum);
        pel_vec3_add(angular, reading.angular_momentum, angular);
        pel_vec3_add(angular, turn, angular);
    }
}

/* ---- meshes ---- */

static inline pel_mesh *make_box(double x, double y, double z, const double center[3])
{
    static const int32_t triangles[12][3] = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4},
                                             {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
    double positions[8][3];
    for (int i = 0; i < 8; i++) {
        const double sx = i % 4 == 1 || i % 4 == 2 ? 0.5 : -0.5, sy = i % 4 >= 2 ? 0.5 : -0.5, sz = i >= 4 ? 0.5 : -0.5;
        pel_vec3_set(positions[i], center[0] + sx * x, center[1] + sy * y, center[2] + sz * z);
    }
    pel_mesh *mesh;
    assert_int_equal(pel_mesh_create(positions[0], 8, triangles[0], 12, &mesh, NULL), PEL_OK);
    return mesh;
}

static inline pel_mesh *make_ball(double radius, int frequency, double x, double y, double z)
{
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    def.frequency = frequency;
    def.radius = radius;
    pel_mesh *mesh;
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    pel_transform transform = pel_transform_default();
    pel_vec3_set(transform.translation, x, y, z);
    assert_int_equal(pel_mesh_transform(mesh, &transform, NULL), PEL_OK);
    return mesh;
}

static inline void turn_mesh(pel_mesh *mesh, const double axis[3], double degrees)
{
    pel_transform transform = pel_transform_default();
    double half = degrees * 3.14159265358979323846 / 360;
    pel_vec3_scale(axis, sin(half) / pel_vec3_length(axis), transform.rotation);
    transform.rotation[3] = cos(half);
    assert_int_equal(pel_mesh_transform(mesh, &transform, NULL), PEL_OK);
}

/* a rigid body of a mesh, alone, as a case of for_allocation_failures (tests/failing_malloc.h); it takes a step if
 * asked */
typedef struct rigid_case {
    const pel_mesh *mesh;
    pel_method method;
    bool steps;
} rigid_case;

static inline pel_status rigid_scene_lone(const void *data, pel_error *error)
{
    const rigid_case *made = data;
    pel_body_def body = pel_body_def_default();
    body.name = "b";
    body.mesh = made->mesh;
    body.rigid.on = true;
    pel_model_def model_def = pel_model_def_default();
    model_def.bodies = &body;
    model_def.body_count = 1;
    pel_model *model;
    pel_sim *sim = NULL;
    pel_status status = pel_model_create(&model_def, &model, error);
    if (status == PEL_OK) {
        pel_sim_def def = pel_sim_def_default();
        def.solver.method = made->method;
        def.model = model;
        status = pel_sim_create(&def, &sim, error);
    }
    assert_true((sim != NULL) == (status == PEL_OK));
    if (status == PEL_OK && made->steps)
        status = pel_sim_step(sim, error);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    return status;
}

#endif

/* A ball on pins that is pressed from above, under the method descent, and conditions at rest. */
#ifndef PEL_TESTS_SIM_DESCENT_FIXTURE_H
#define PEL_TESTS_SIM_DESCENT_FIXTURE_H

#include "math/vec3.h"
#include "pellicle/sim_contact.h"
#include "pellicle/sim_forces.h"
#include "pellicle/sim_surface.h"
#include "sim/fixture.h"
#include "stage/stage.h"

/* share of the force on the tool that may remain on vertices without contact; positions in float have 24 bits */
#define LEFT_SHARE (sizeof(pel_real) == 4 ? 2e-2 : 1e-5)

enum { PRESS_KEYS = 3 };

typedef struct press_scene {
    pel_mesh *mesh;
    pel_model *model;
    pel_body_def body;
    pel_tool_def tool;
    pel_pose_key keys[PRESS_KEYS];
    int32_t pinned[400];
    pel_sim_def def;
} press_scene;

/* a shell of StVK and hinges, thick enough not to buckle, or (young 0) a ball of springs */
static inline void press_begin(press_scene *scene, int32_t frequency, double young)
{
    memset(scene, 0, sizeof *scene);
    scene->mesh = make_sphere(frequency);
    pel_body_def *body = &scene->body;
    *body = pel_body_def_default();
    body->name = "ball";
    body->mesh = scene->mesh;
    if (young > 0) {
        *body = pel_body_def_sheet("ball", scene->mesh, young, 0.1, 1000);
        body->shell.membrane.kind = PEL_MEMBRANE_STVK;
        body->shell.bending.model = PEL_BENDING_HINGE;
    }
    for (int32_t v = 0; v < scene->mesh->vertex_count; v++)
        if (scene->mesh->positions[v][2] < -0.7)
            scene->pinned[body->pinned_count++] = v;
    assert_true(body->pinned_count < 400);
    body->pinned = scene->pinned;
    scene->tool = pel_tool_def_default();
    scene->tool.name = "probe";
    scene->tool.radius = 0.5;
    scene->tool.keys = scene->keys;
    scene->def = pel_sim_def_default();
    scene->def.solver.method = PEL_METHOD_DESCENT;
    scene->def.solver.dt = 0.1;
    scene->def.solver.iterations = 400;
    scene->def.tools = &scene->tool;
    scene->def.tool_count = 1;
    scene->def.thread_count = 1;
}

/* the tool goes down by `depth` below where it touches (at `top`) until t = 1, and up again until t = 2 */
static inline void press_move(press_scene *scene, double top, double depth)
{
    for (int k = 0; k < PRESS_KEYS; k++)
        scene->keys[k] = (pel_pose_key){k, {0, 0, k == 1 ? top - depth : top + 1e-4}, {0, 0, 0, 1}, {0}};
    scene->tool.key_count = PRESS_KEYS;
}

static inline pel_sim *press_create(press_scene *scene)
{
    scene->model = make_model(&scene->body);
    scene->def.model = scene->model;
    return make_sim(&scene->def);
}

static inline void press_end(press_scene *scene, pel_sim *sim)
{
    pel_sim_destroy(sim);
    pel_model_destroy(scene->model);
    pel_mesh_destroy(scene->mesh);
}

static inline pel_tool_reading reading_of(const pel_sim *sim, int32_t tool)
{
    pel_tool_reading reading;
    pel_sim_get_tool(sim, tool, &reading);
    return reading;
}

static inline pel_solver_reading solver_of(const pel_sim *sim)
{
    pel_solver_reading reading;
    pel_sim_get_solver(sim, &reading);
    return reading;
}

static inline bool is_pinned(const press_scene *scene, int32_t v)
{
    return scene->mesh->positions[v][2] < -0.7;
}

/* positions, and forces of the body on its vertices, contact excluded; free with free_rest */
typedef struct rest_state {
    double (*x)[3], (*force)[3], *contact;
} rest_state;

static inline rest_state find_rest(pel_sim *sim)
{
    size_t count = (size_t)pel_sim_vertex_count(sim, 0);
    rest_state rest = {malloc(count * sizeof *rest.x), malloc(count * sizeof *rest.force),
                       malloc(count * sizeof *rest.contact)};
    pel_sim_get_positions(sim, 0, (double *)rest.x);
    pel_sim_get_forces(sim, 0, (double *)rest.force);
    pel_sim_get_contacts(sim, 0, rest.contact);
    return rest;
}

static inline void free_rest(rest_state *rest)
{
    free(rest->x);
    free(rest->force);
    free(rest->contact);
}

/* Forces vanish on vertices without contact; the forces on the others act on the tool and on the pins. Returns the
   force on the tool along z [N]. */
static inline double assert_balanced(const press_scene *scene, pel_sim *sim)
{
    rest_state rest = find_rest(sim);
    pel_tool_reading reading = reading_of(sim, 0);
    double sum[3] = {0, 0, 0}, torque[3] = {0, 0, 0}, pins[3] = {0, 0, 0}, scale = pel_vec3_length(reading.force);
    int touched = 0;
    for (int32_t v = 0; v < scene->mesh->vertex_count; v++) {
        const double *f = rest.force[v];
        double arm[3], turn[3];
        if (is_pinned(scene, v)) {
            pel_vec3_add(pins, f, pins);
            continue;
        }
        touched += rest.contact[v] > 0;
        if (rest.contact[v] == 0) {
            assert_near(pel_vec3_length(f), 0, LEFT_SHARE * scale);
            continue;
        }
        pel_vec3_subtract(rest.x[v], reading.position, arm);
        pel_vec3_cross(arm, f, turn);
        pel_vec3_add(torque, turn, torque);
        pel_vec3_add(sum, f, sum);
    }
    assert_int_equal(touched, reading.contact_count);
    for (int k = 0; k < 3; k++) {
        assert_near(reading.force[k], sum[k], LEFT_SHARE * scale);
        /* volumetric springs stand on the ground too */
        if (scene->body.shell.membrane.on)
            assert_near(reading.force[k], -pins[k], 10 * LEFT_SHARE * scale);
        assert_near(reading.torque[k], torque[k], LEFT_SHARE * scale);
    }
    free_rest(&rest);
    return reading.force[2];
}

#endif

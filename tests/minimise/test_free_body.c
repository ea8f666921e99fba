/* Bodies without a place of least energy are refused under the method descent; those that something holds are not. */
#include "sim/fixture.h"
#include "stage/stage.h"

#include <stdlib.h>

/* balls side by side, without springs to rest, and the forces on them */
typedef struct free_scene {
    pel_mesh *meshes[2];
    pel_body_def bodies[2];
    pel_model_def model;
    pel_sim_def def;
    pel_load_def loads[2];
    pel_tool_def tool;
    pel_pose_key key;
    int32_t pin, pole[2];
} free_scene;

static void begin(free_scene *scene, int32_t body_count)
{
    memset(scene, 0, sizeof *scene);
    for (int32_t b = 0; b < body_count; b++) {
        pel_body_def *body = &scene->bodies[b];
        scene->meshes[b] = make_sphere(3);
        for (int32_t v = 0; v < scene->meshes[b]->vertex_count; v++)
            scene->meshes[b]->positions[v][0] += 3 * b;
        *body = pel_body_def_default();
        body->name = b == 0 ? "left" : "right";
        body->mesh = scene->meshes[b];
        body->volumetric_stiffness.value = body->volumetric_damping.value = 0;
    }
    scene->model = pel_model_def_default();
    scene->model.bodies = scene->bodies;
    scene->model.body_count = body_count;
    scene->def = pel_sim_def_default();
    scene->def.solver.method = PEL_METHOD_DESCENT;
    scene->def.solver.dt = 0.1;
    scene->def.solver.iterations = 20;
    scene->def.loads = scene->loads;
    for (int l = 0; l < 2; l++) {
        scene->pole[l] = nearest_vertex(scene->meshes[0], 0, 0, l == 0 ? 1 : -1);
        scene->loads[l] = pel_load_def_default();
        scene->loads[l].name = l == 0 ? "up" : "down";
        scene->loads[l].vertices = &scene->pole[l];
        scene->loads[l].vertex_count = 1;
        scene->loads[l].force[2] = l == 0 ? 0.1 : -0.1;
    }
    scene->key = (pel_pose_key){0, {0, 0, -5}, {0, 0, 0, 1}, {0}};
    scene->tool = pel_tool_def_default();
    scene->tool.name = "floor";
    scene->tool.radius = 3.9;
    scene->tool.keys = &scene->key;
    scene->tool.key_count = 1;
    scene->def.tools = &scene->tool;
}

/* creates it and takes a step; returns the message if one of the two is refused, else "" */
static const char *outcome(free_scene *scene, int32_t refused_body)
{
    static pel_error error;
    pel_model *model;
    pel_sim *sim;
    error.what[0] = '\0';
    assert_int_equal(pel_model_create(&scene->model, &model, NULL), PEL_OK);
    scene->def.model = model;
    pel_status status = pel_sim_create(&scene->def, &sim, &error);
    if (status == PEL_OK)
        assert_int_equal(pel_sim_step(sim, &error), PEL_OK);
    if (refused_body >= 0) {
        assert_int_equal(status, PEL_BAD_ARGUMENT);
        assert_string_equal(error.element_kind, "body");
        assert_int_equal(error.element, refused_body);
        assert_non_null(strstr(error.remedy, "pin vertices"));
    } else if (status != PEL_OK) {
        print_error("%s\n", error.what);
    }
    assert_true((status == PEL_OK) == (refused_body < 0));
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    return error.what;
}

static void end(free_scene *scene)
{
    for (int b = 0; b < 2; b++)
        pel_mesh_destroy(scene->meshes[b]);
}

static void test_gravity(void **unused)
{
    (void)unused;
    free_scene scene;
    begin(&scene, 1);
    scene.model.gravity[2] = -1e-3;
    assert_non_null(strstr(outcome(&scene, 0), "nothing holds body 'left'"));
    scene.def.solver.method = PEL_METHOD_QUASI_STATIC;
    outcome(&scene, -1);
    scene.def.solver.method = PEL_METHOD_DESCENT;
    /* pins, springs to rest, a tool */
    scene.bodies[0].pinned = &scene.pin;
    scene.bodies[0].pinned_count = 1;
    outcome(&scene, -1);
    scene.bodies[0].pinned_count = 0;
    scene.bodies[0].volumetric_stiffness.value = 1;
    outcome(&scene, -1);
    scene.bodies[0].volumetric_stiffness.value = 0;
    scene.def.tool_count = 1;
    outcome(&scene, -1);
    scene.tool.press = false;
    outcome(&scene, 0);
    scene.tool.grasp = true;
    scene.tool.reach = 0.3;
    outcome(&scene, -1);
    end(&scene);
}

static void test_loads(void **unused)
{
    (void)unused;
    free_scene scene;
    begin(&scene, 1);
    scene.def.load_count = 1;
    assert_non_null(strstr(outcome(&scene, 0), "(0, 0, 0.1) N"));
    /* loads in balance hold each other */
    scene.def.load_count = 2;
    outcome(&scene, -1);
    scene.loads[1].until = 5;
    outcome(&scene, -1);
    /* not before the other begins */
    scene.loads[1].from = 4;
    outcome(&scene, 0);
    scene.loads[0].from = 7;
    assert_non_null(strstr(outcome(&scene, 0), "at time 7"));
    end(&scene);
}

/* a load that is set between steps */
static void test_later_force(void **unused)
{
    (void)unused;
    free_scene scene;
    begin(&scene, 1);
    scene.def.load_count = 2;
    pel_model *model;
    pel_error error;
    assert_int_equal(pel_model_create(&scene.model, &model, NULL), PEL_OK);
    scene.def.model = model;
    pel_sim *sim = make_sim(&scene.def);
    run_steps(sim, 1);
    assert_int_equal(pel_sim_set_load_force(sim, 0, (double[3]){0, 0, 0.2}, NULL), PEL_OK);
    uint64_t hash = pel_sim_hash(sim);
    assert_int_equal(pel_sim_step(sim, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, "nothing holds body 'left'"));
    assert_true(pel_sim_hash(sim) == hash);
    assert_int_equal(pel_sim_set_load_force(sim, 0, (double[3]){0, 0, 0.1}, NULL), PEL_OK);
    run_steps(sim, 1);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    end(&scene);
}

static void test_pressures(void **unused)
{
    (void)unused;
    free_scene scene;
    begin(&scene, 1);
    pel_shell_def *shell = &scene.bodies[0].shell;
    shell->membrane.on = true;
    shell->membrane.young.value = 1e4;
    shell->membrane.thickness.value = 0.01;
    shell->pressure.kind = PEL_PRESSURE_GIVEN;
    shell->pressure.outside.value = 5;
    outcome(&scene, -1);
    shell->pressure.form = PEL_PRESSURE_VERTEX_NORMAL;
    outcome(&scene, -1);
    /* a part of the surface alone drives it away */
    shell->pressure.form = PEL_PRESSURE_CONSISTENT;
    double *weights = calloc((size_t)scene.meshes[0]->vertex_count, sizeof *weights);
    assert_non_null(weights);
    weights[scene.pole[0]] = 1;
    shell->pressure.weights = weights;
    outcome(&scene, 0);
    free(weights);
    end(&scene);
}

/* contact with a body that is held holds the other */
static void test_contact(void **unused)
{
    (void)unused;
    free_scene scene;
    begin(&scene, 2);
    scene.model.gravity[2] = -1e-3;
    scene.bodies[0].pinned = &scene.pin;
    scene.bodies[0].pinned_count = 1;
    outcome(&scene, 1);
    scene.def.contact.enabled = true;
    outcome(&scene, -1);
    scene.bodies[0].pinned_count = 0;
    outcome(&scene, 0);
    end(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_gravity),   cmocka_unit_test(test_loads),   cmocka_unit_test(test_later_force),
        cmocka_unit_test(test_pressures), cmocka_unit_test(test_contact),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

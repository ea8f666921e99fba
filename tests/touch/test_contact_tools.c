/* Contact with tools: plates that press a body flat and are stopped by it, mesh tools, round tools that move fast. */
#include "pellicle/shape.h"
#include "sim/contact_scene.h"
#include "tool/pose.h"

static void press_flat(pel_method method)
{
    contact_scene scene;
    pel_sim *sim = pressed_flat(&scene, method, 5, 0.02, 300);
    assert_true(run_free(sim, 300) > 100);
    pel_sim_measures measures;
    pel_sim_measure(sim, &measures);
    assert_true(measures.volume_ratio < 0.05);
    for (int i = 0; i < 2; i++) {
        pel_tool_reading reading;
        pel_sim_get_tool(sim, i, &reading);
        assert_near(fabs(reading.position[2]), 0.11, 1e-12);
        assert_true(reading.contact_count > 10);
    }
    scene_end(&scene, sim);
}

static void test_pressed_flat(void **unused)
{
    (void)unused;
    press_flat(PEL_METHOD_QUASI_STATIC);
    press_flat(PEL_METHOD_EXPLICIT);
}

/* plates that would leave less room than the layers need are held back, and say so */
static void test_held_tools(void **unused)
{
    (void)unused;
    contact_scene scene;
    pel_sim *sim = pressed_flat(&scene, PEL_METHOD_QUASI_STATIC, 4, 0, 300);
    run_free(sim, 300);
    pel_tool_reading upper, lower;
    pel_sim_get_tool(sim, 0, &upper);
    pel_sim_get_tool(sim, 1, &lower);
    assert_true(upper.position[2] - lower.position[2] > 0.2 + pel_sim_contact_thickness(sim));
    assert_true(statistics_of(sim).tools_held > 0);
    /* the force is that of a way that the guard took back */
    int unknown = 0;
    for (int n = 0; n < 20; n++) {
        run_free(sim, 1);
        pel_sim_get_tool(sim, 0, &upper);
        assert_true(upper.is_held_back || upper.force_known);
        unknown += !upper.force_known;
    }
    assert_true(unknown > 0);
    scene_end(&scene, sim);
}

/* Plates that the guard holds back catch up by an eighth of their lag per step, or at twice their speed; others follow
   their keys. */
static void test_held_tools_catch_up(void **unused)
{
    (void)unused;
    contact_scene scene;
    pel_sim *sim = pressed_flat(&scene, PEL_METHOD_QUASI_STATIC, 2, -0.1, 20);
    pel_sim_destroy(sim);
    for (int i = 0; i < 2; i++) {
        scene.keys[i][2] = scene.keys[i][0];
        scene.keys[i][2].time = 3 * scene.keys[i][1].time;
        scene.tools[i].key_count = 3;
    }
    sim = make_sim(&scene.def);
    double dt = scene.def.solver.dt;
    int blocked = 0, freed = 0;
    for (int n = 0; n < 60; n++) {
        pel_pose before[2], keyed[2];
        bool was_blocked[2];
        for (int i = 0; i < 2; i++) {
            before[i] = sim->tools->items[i].pose;
            keyed[i] = pel_tool_pose_at(&sim->tools->items[i], n * dt);
            was_blocked[i] = sim->tools->items[i].blocked;
        }
        run_steps(sim, 1);
        for (int i = 0; i < 2; i++) {
            const pel_tool *tool = &sim->tools->items[i];
            pel_pose wanted = pel_tool_pose_at(tool, (n + 1) * dt);
            double way = pel_tool_way(tool, &before[i], &tool->pose), lag = pel_tool_way(tool, &before[i], &wanted);
            assert_true(way <= fmax(2 * pel_tool_way(tool, &keyed[i], &wanted), lag / 8) + 1e-12);
            assert_true(tool->blocked || pel_tool_way(tool, &tool->pose, &wanted) <= 1e-12);
            blocked += tool->blocked;
            freed += was_blocked[i] && !tool->blocked;
        }
    }
    assert_true(blocked > 20 && freed >= (sizeof(pel_real) == sizeof(float) ? 1 : 2));
    scene_end(&scene, sim);
}

/* a plate that stands still lags behind nothing: of two that squash a shell only the one that moves is held back */
static void test_still_tool_is_not_held(void **unused)
{
    (void)unused;
    skip_if_long();
    contact_scene scene;
    pel_sim *sim = pressed_flat(&scene, PEL_METHOD_QUASI_STATIC, 4, 0, 300);
    pel_sim_destroy(sim);
    scene_move(&scene, 0, 0, 0, 1.15, -1, 2.4);
    scene_move(&scene, 1, 0, 0, -1.15, -1.15, 1);
    scene.def.tools = scene.tools;
    assert_int_equal(pel_sim_create(&scene.def, &sim, NULL), PEL_OK);
    int64_t steps = 0, before = 0;
    for (int n = 0; n < 300; n++) {
        run_free(sim, 1);
        int64_t held = statistics_of(sim).tools_held;
        assert_true(held - before <= 1);
        steps += held > before;
        before = held;
    }
    assert_true(steps > 0);
    scene_end(&scene, sim);
}

/* a ring is pushed through a ball, which is held by nothing but its own inertia and another tool */
static void test_mesh_tool(void **unused)
{
    (void)unused;
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_QUASI_STATIC);
    scene_body(&scene, make_sphere(5));
    scene.def.contact.friction = 0.4;
    scene.tool_mesh = make_shape(PEL_SHAPE_TORUS);
    scene_tool(&scene, PEL_TOOL_MESH)->mesh = scene.tool_mesh;
    scene_tool(&scene, PEL_TOOL_MESH)->mesh = scene.tool_mesh;
    scene_move(&scene, 0, 0.1, 0, 1.3, 0.3, 1.5);
    scene_move(&scene, 1, 0, 0.1, -1.3, -0.3, 1.5);
    pel_sim *sim = scene_create(&scene);
    assert_true(run_free(sim, ROUNDS(200, 130)) > 50);
    pel_tool_reading reading;
    pel_sim_get_tool(sim, 0, &reading);
    assert_true(reading.force[2] > 0);
    scene_end(&scene, sim);
}

/* distance of the surface from the axis of a sphere or capsule along z */
static double axis_distance(const pel_sim *sim, const pel_mesh *mesh, double half_length)
{
    pel_tool_reading reading;
    double *x = malloc(3 * (size_t)mesh->vertex_count * sizeof *x), least = HUGE_VAL;
    pel_sim_get_tool(sim, 0, &reading);
    pel_sim_get_positions(sim, 0, x);
    double ends[2][3];
    for (int i = 0; i < 2; i++) {
        memcpy(ends[i], reading.position, sizeof ends[i]);
        ends[i][2] += i == 0 ? -half_length : half_length;
    }
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        const int32_t *v = mesh->triangles[t];
        double weights[5];
        least = fmin(least,
                     pel_closest_segment_triangle(ends[0], ends[1], x + 3 * v[0], x + 3 * v[1], x + 3 * v[2], weights));
    }
    free(x);
    return sqrt(least);
}

/* faster than its own size in a step, through a ball that is hit from above: nothing gets into the tool, and the tool
   does not get into the ball */
static void test_fast_round_tools(void **unused)
{
    (void)unused;
    for (int shape = 0; shape < 2; shape++) {
        contact_scene scene;
        scene_begin(&scene, PEL_METHOD_QUASI_STATIC);
        scene_body(&scene, make_sphere(4));
        pel_tool_def *tool = scene_tool(&scene, shape == 0 ? PEL_TOOL_SPHERE : PEL_TOOL_CAPSULE);
        tool->radius = 0.1;
        tool->half_length = shape == 0 ? 0 : 0.1;
        scene_move(&scene, 0, 0.05, 0.02, 1.6, -3, 0.04);
        pel_sim *sim = scene_create(&scene);
        for (int n = 0; n < 60; n++) {
            assert_int_equal(run_free(sim, 1) >= 0, 1);
            assert_true(axis_distance(sim, scene.meshes[0], tool->half_length) > tool->radius);
        }
        assert_true(statistics_of(sim).tools_held > 0);
        scene_end(&scene, sim);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pressed_flat),        cmocka_unit_test(test_held_tools),
        cmocka_unit_test(test_held_tools_catch_up), cmocka_unit_test(test_still_tool_is_not_held),
        cmocka_unit_test(test_mesh_tool),           cmocka_unit_test(test_fast_round_tools),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

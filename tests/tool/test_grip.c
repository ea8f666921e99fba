/* Grasps with a largest force: vertices tear out, and are told; tools that were held back catch up. */
#include "math/vec3.h"
#include "sim/fixture.h"
#include "tool/grip.h"

#define FROM 0.05

typedef struct pull_scene {
    pel_mesh *mesh;
    pel_model *model;
    pel_tool_def tool;
    pel_pose_key keys[3];
    int32_t pinned[400];
    pel_sim_def def;
} pull_scene;

/* a ball of springs that stands on pins, and a grip at its top that pulls it up by 0.3 within a second and stops */
static pel_sim *create(pull_scene *scene, pel_method method, double max_force)
{
    memset(scene, 0, sizeof *scene);
    scene->mesh = make_sphere(method == PEL_METHOD_IMPLICIT ? LONG(6, 4) : 6);
    pel_body_def body = ball_body(scene->mesh);
    body.pinned = scene->pinned;
    for (int32_t v = 0; v < scene->mesh->vertex_count; v++)
        if (scene->mesh->positions[v][2] < -0.7)
            scene->pinned[body.pinned_count++] = v;
    scene->model = make_model(&body);
    const double heights[3] = {1, 1.3, 1.3};
    for (int k = 0; k < 3; k++)
        scene->keys[k] = (pel_pose_key){k, {0, 0, heights[k]}, {0, 0, 0, 1}, {0}};
    scene->tool = pel_tool_def_default();
    scene->tool.name = "grip";
    scene->tool.radius = 0.4;
    scene->tool.press = false;
    scene->tool.grasp = true;
    scene->tool.grasp_from = FROM;
    scene->tool.reach = 0.05;
    scene->tool.grasp_max_force = max_force;
    scene->tool.keys = scene->keys;
    scene->tool.key_count = 3;
    scene->def = pel_sim_def_default();
    scene->def.model = scene->model;
    scene->def.solver.method = method;
    scene->def.solver.dt = 0.01;
    scene->def.tools = &scene->tool;
    scene->def.tool_count = 1;
    scene->def.thread_count = 1;
    return make_sim(&scene->def);
}

static void end(pull_scene *scene, pel_sim *sim)
{
    pel_sim_destroy(sim);
    pel_model_destroy(scene->model);
    pel_mesh_destroy(scene->mesh);
}

/* sum of the magnitudes of the forces on what is still held */
static double grip_force(const pel_sim *sim)
{
    double sum = 0;
    for (int32_t i = 0; i < sim->tools->items[0].held_count; i++)
        sum += pel_vec3_length(sim->tools->grip_forces[sim->tools->items[0].held[i]]);
    return sum;
}

/* the largest force over two seconds, and that the forces of the held vertices are all of the reading */
static double largest_force(pel_sim *sim)
{
    double largest = 0;
    for (int n = 0; n < 200; n++) {
        pel_tool_reading reading;
        double sum[3] = {0};
        run_steps(sim, 1);
        pel_sim_get_tool(sim, 0, &reading);
        for (int32_t i = 0; i < reading.held_count; i++)
            pel_vec3_add(sum, sim->tools->grip_forces[sim->tools->items[0].held[i]], sum);
        assert_near(pel_vec3_distance(sum, reading.force), 0, 1e-5);
        largest = fmax(largest, grip_force(sim));
    }
    return largest;
}

static const pel_method methods[] = {PEL_METHOD_EXPLICIT, PEL_METHOD_QUASI_STATIC, PEL_METHOD_XPBD,
                                     PEL_METHOD_PBD,      PEL_METHOD_DESCENT,      PEL_METHOD_IMPLICIT};

/* after every step the forces of what is held are within the limit; who is lost is free and counted from the first time
 * on */
static void check_limit(pel_method method)
{
    pull_scene scene;
    pel_sim *sim = create(&scene, method, 0);
    pel_tool_reading reading;
    double largest = largest_force(sim), limit = 0.5 * largest, first = 0;
    pel_sim_get_tool(sim, 0, &reading);
    int32_t held_count = reading.held_count;
    assert_true(held_count > 5 && reading.lost_count == 0);
    end(&scene, sim);
    sim = create(&scene, method, limit);
    for (int n = 1; n <= 200; n++) {
        int64_t lost_before = sim->tools->items[0].tally.lost_count;
        run_steps(sim, 1);
        pel_sim_get_tool(sim, 0, &reading);
        assert_true(grip_force(sim) <= limit * (1 + 1e-12));
        if (pel_sim_time(sim) > FROM + 0.011)
            assert_int_equal(reading.held_count + reading.lost_count, held_count);
        if (reading.lost_count > lost_before && lost_before == 0)
            first = pel_sim_time(sim);
    }
    assert_true(reading.lost_count > 0 && first > FROM - 1e-9);
    assert_near(reading.lost_time, first, 1e-12);
    int32_t marked_count = 0;
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        marked_count += sim->held[v];
    assert_int_equal(marked_count, reading.held_count);
    end(&scene, sim);
    /* as much as it takes: nothing tears */
    sim = create(&scene, method, 1.001 * largest);
    largest_force(sim);
    pel_sim_get_tool(sim, 0, &reading);
    assert_int_equal(reading.lost_count, 0);
    end(&scene, sim);
}

static void test_limit(void **unused)
{
    (void)unused;
    for (size_t m = 0; m < sizeof methods / sizeof *methods; m++)
        check_limit(methods[m]);
}

/* vertices that were lost move like all others: springs draw them back from the tool */
static void test_lost_are_free(void **unused)
{
    (void)unused;
    skip_if_slow();
    for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
        pull_scene scene;
        pel_sim *sim = create(&scene, methods[m], 1e-3);
        pel_tool_reading reading;
        int32_t top = nearest_vertex(scene.mesh, 0, 0, 1);
        run_steps(sim, methods[m] == PEL_METHOD_IMPLICIT ? LONG(1500, 150) : 1500);
        pel_sim_get_tool(sim, 0, &reading);
        assert_int_equal(reading.held_count, 0);
        /* the tool stays at 1.3; a ball of springs may keep a bulge */
        assert_true(height_of(sim, top) < 1.2);
        end(&scene, sim);
    }
}

/* Without a given limit the material has one, far above what it bears when it is stretched by its length; more makes
   the grasp lose vertices; pbd, whose forces are not the material's, has no limit. */
static void test_material_limit(void **unused)
{
    (void)unused;
    const pel_method tried[] = {PEL_METHOD_EXPLICIT, PEL_METHOD_XPBD, PEL_METHOD_PBD};
    for (size_t m = 0; m < 3; m++) {
        pull_scene scene;
        pel_tool_reading reading;
        pel_sim *sim = create(&scene, tried[m], 0);
        pel_sim_destroy(sim);
        scene.keys[1].position[2] = 2;
        scene.keys[2].position[2] = 100;
        sim = make_sim(&scene.def);
        run_steps(sim, 100);
        pel_sim_get_tool(sim, 0, &reading);
        int32_t held_count = reading.held_count;
        assert_true(held_count > 5 && reading.lost_count == 0);
        run_steps(sim, 100);
        pel_sim_get_tool(sim, 0, &reading);
        double each = sim->tools->strengths[0];
        assert_int_equal(reading.held_count + reading.lost_count, held_count);
        assert_true((reading.lost_count > 0) == (tried[m] != PEL_METHOD_PBD));
        /* k times the width of a vertex is the least of its parts */
        assert_true(each > 3 * sqrt(4 * 3.14 / scene.mesh->vertex_count) && each < 10);
        if (reading.lost_count > 0) {
            assert_true(reading.lost_limit >= 10 * each * held_count * (1 - 1e-12));
        }
        end(&scene, sim);
    }
}

/* A grasp that is drawn through the pinned side of its own shell is stopped by contact. It lets go of all, as it is
   stuck or as the material yields, and moves on, but not if the scene gives it a limit. */
static void test_stuck(void **unused)
{
    (void)unused;
    for (int is_given = 0; is_given < 2; is_given++) {
        pull_scene scene;
        pel_tool_reading reading;
        pel_sim *sim = create(&scene, PEL_METHOD_XPBD, is_given ? 1e9 : 0);
        end(&scene, sim);
        scene.mesh = make_sphere(8);
        pel_body_def body = ball_body(scene.mesh);
        body.volumetric_stiffness.value = 0;
        body.spring_stiffness.value = 300;
        body.mass = 0.05;
        body.pinned = scene.pinned;
        body.pinned_count = 0;
        for (int32_t v = 0; v < scene.mesh->vertex_count; v++)
            if (scene.mesh->positions[v][2] < -0.5)
                scene.pinned[body.pinned_count++] = v;
        scene.model = make_model(&body);
        scene.def.model = scene.model;
        scene.def.contact.enabled = true;
        scene.keys[1].position[2] = scene.keys[2].position[2] = -2;
        sim = make_sim(&scene.def);
        run_steps(sim, is_given ? 85 : 130);
        pel_sim_get_tool(sim, 0, &reading);
        assert_true(reading.held_back_count > 5);
        assert_true((reading.lost_count > 0) == !is_given && (reading.held_count == 0) == !is_given);
        assert_true((reading.position[2] < -1.9) == !is_given);
        end(&scene, sim);
    }
}

/* of two forces above the limit only the larger goes, and only as many as it takes */
static void test_largest_first(void **unused)
{
    (void)unused;
    pull_scene scene;
    pel_sim *sim = create(&scene, PEL_METHOD_XPBD, 0);
    run_steps(sim, 40);
    pel_tool *tool = &sim->tools->items[0];
    int32_t largest = tool->held[0], count = tool->held_count;
    double sum = 0;
    for (int32_t i = 0; i < count; i++) {
        double size = pel_vec3_length(sim->tools->grip_forces[tool->held[i]]);
        sum += size;
        if (size > pel_vec3_length(sim->tools->grip_forces[largest]))
            largest = tool->held[i];
    }
    tool->grasp_max_force = sum - 0.5 * pel_vec3_length(sim->tools->grip_forces[largest]);
    pel_tools_end_step(sim, 7);
    assert_int_equal(tool->held_count, count - 1);
    assert_true(!sim->held[largest] && sim->state->position[largest][3] == sim->model->inverse_mass[largest]);
    assert_true(tool->tally.lost_count == 1 && tool->tally.lost_time == 7);
    end(&scene, sim);
}

/* the state with its losses goes through snapshots */
static void test_resumes(void **unused)
{
    (void)unused;
    pull_scene scene;
    pel_sim *sim = create(&scene, PEL_METHOD_XPBD, 0.5);
    run_steps(sim, 60);
    pel_tool_reading before, after;
    pel_sim_get_tool(sim, 0, &before);
    assert_true(before.lost_count > 0);
    sim = resume_sim(sim, &scene.def);
    pel_sim_get_tool(sim, 0, &after);
    assert_true(after.lost_count == before.lost_count && after.lost_time == before.lost_time &&
                after.held_count == before.held_count);
    run_steps(sim, 60);
    uint64_t resumed = pel_sim_hash(sim);
    end(&scene, sim);
    sim = create(&scene, PEL_METHOD_XPBD, 0.5);
    run_steps(sim, 120);
    assert_true(pel_sim_hash(sim) == resumed);
    end(&scene, sim);
}

/* forces are those of the present step, whatever is left in the buffers of earlier ones */
static void test_readings_resume(void **unused)
{
    (void)unused;
    for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
        pull_scene scene;
        pel_tool_reading readings[2];
        for (int i = 0; i < 2; i++) {
            pel_sim *sim = create(&scene, methods[m], 0);
            run_steps(sim, 6);
            if (i == 1)
                sim = resume_sim(sim, &scene.def);
            run_steps(sim, 1);
            pel_sim_get_tool(sim, 0, &readings[i]);
            end(&scene, sim);
        }
        assert_true(readings[0].held_count > 5);
        assert_memory_equal(readings[0].force, readings[1].force, sizeof readings[0].force);
        assert_memory_equal(readings[0].torque, readings[1].torque, sizeof readings[0].torque);
    }
}

static void test_refusals(void **unused)
{
    (void)unused;
    pull_scene scene;
    pel_sim *sim = create(&scene, PEL_METHOD_XPBD, 0), *refused;
    const double bad[] = {-1, (double)NAN};
    for (size_t i = 0; i < 2; i++) {
        pel_error error;
        scene.tool.grasp_max_force = bad[i];
        assert_int_equal(pel_sim_create(&scene.def, &refused, &error), PEL_BAD_ARGUMENT);
        assert_non_null(strstr(error.what, "largest force of a grasp"));
    }
    end(&scene, sim);
}

/* a tool that lags catches up over many steps, never by more than an eighth of the lag where its keys stand still, and
   is exactly there in the end */
static void test_catches_up(void **unused)
{
    (void)unused;
    pull_scene scene;
    pel_sim *sim = create(&scene, PEL_METHOD_XPBD, 0);
    pel_tool *tool = &sim->tools->items[0];
    run_steps(sim, 120);
    pel_pose wanted = tool->pose;
    tool->pose.position[2] -= 0.1;
    tool->blocked = true;
    double lag = 0.1;
    int steps = 0;
    while (tool->blocked && steps++ < 200) {
        run_steps(sim, 1);
        double now = pel_tool_way(tool, &tool->pose, &wanted);
        assert_true(now == 0 || now > 0.874 * lag);
        lag = now;
    }
    assert_true(lag == 0 && steps > 50 && steps < 120);
    end(&scene, sim);
}

/* what is let go at the end of a grasp is as free as before, and comes back */
static void test_released_are_free(void **unused)
{
    (void)unused;
    for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
        pull_scene scene;
        pel_tool_reading reading;
        pel_sim *sim = create(&scene, methods[m], 0);
        pel_sim_destroy(sim);
        scene.tool.grasp_until = 1;
        sim = make_sim(&scene.def);
        int32_t top = nearest_vertex(scene.mesh, 0, 0, 1);
        run_steps(sim, 90);
        pel_sim_get_tool(sim, 0, &reading);
        assert_true(reading.held_count > 3 && height_of(sim, top) > 1.2);
        run_steps(sim, 15);
        pel_sim_get_tool(sim, 0, &reading);
        assert_int_equal(reading.held_count, 0);
        for (int32_t v = 0; v < scene.model->vertex_count; v++) {
            assert_int_equal(sim->held[v], 0);
            assert_true(sim->state->position[v][3] == scene.model->inverse_mass[v]);
        }
        run_steps(sim, ROUNDS(300, 30));
        assert_true(is_slow() || height_of(sim, top) < 1.2);
        end(&scene, sim);
    }
}

/* a snapshot has the readings of its step */
static void test_readings_return(void **unused)
{
    (void)unused;
    pull_scene scene;
    pel_sim *sim = create(&scene, PEL_METHOD_EXPLICIT, 0);
    pel_sim_destroy(sim);
    scene.keys[1].rotation_vector[2] = 2;
    sim = make_sim(&scene.def);
    run_steps(sim, 60);
    pel_tool_reading saved, later, loaded;
    size_t size = pel_sim_save_size(sim);
    void *snapshot = malloc(size);
    pel_sim_save(sim, snapshot);
    pel_sim_get_tool(sim, 0, &saved);
    run_steps(sim, 30);
    pel_sim_get_tool(sim, 0, &later);
    assert_int_equal(pel_sim_load(sim, snapshot, size, NULL), PEL_OK);
    pel_sim_get_tool(sim, 0, &loaded);
    assert_true(saved.torque[2] != later.torque[2] && saved.force[2] != later.force[2]);
    assert_memory_equal(loaded.force, saved.force, sizeof saved.force);
    assert_memory_equal(loaded.torque, saved.torque, sizeof saved.torque);
    assert_int_equal(loaded.held_count, saved.held_count);
    assert_int_equal(loaded.lost_count, saved.lost_count);
    free(snapshot);
    end(&scene, sim);
}

/* A body that is held as a whole falls freely from the time at which the grasp opens, which is within a step or not. */
static void test_opening(void **unused)
{
    (void)unused;
    static const struct {
        pel_method method;
        double dt;
        int count;
    } cases[] = {{PEL_METHOD_XPBD, 0.05, 16}, {PEL_METHOD_XPBD, 0.08, 10}, {PEL_METHOD_IMPLICIT, 0.05, 16}};
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        pull_scene scene;
        end(&scene, create(&scene, cases[c].method, 0));
        scene.mesh = make_sphere(3);
        pel_body_def body = ball_body(scene.mesh);
        body.spring_damping.value = body.volumetric_stiffness.value = body.volumetric_damping.value = 0;
        pel_model_def model = pel_model_def_default();
        model.bodies = &body;
        model.body_count = 1;
        model.gravity[2] = -9.81;
        assert_int_equal(pel_model_create(&model, &scene.model, NULL), PEL_OK);
        scene.def.model = scene.model;
        scene.def.solver.dt = cases[c].dt;
        scene.tool.radius = 2;
        scene.tool.grasp_from = 0;
        scene.tool.grasp_until = 0.3;
        scene.keys[0].position[2] = scene.keys[1].position[2] = scene.keys[2].position[2] = 1;
        pel_sim *sim = make_sim(&scene.def);
        run_steps(sim, cases[c].count);
        double *x = malloc(3 * sizeof *x * (size_t)scene.mesh->vertex_count);
        pel_sim_get_positions(sim, 0, x);
        double way = scene.mesh->positions[0][2] - x[2], truth = 0.5 * 9.81 * 0.5 * 0.5;
        assert_near(way, truth, 0.02 * truth);
        free(x);
        end(&scene, sim);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_opening),           cmocka_unit_test(test_readings_return),
        cmocka_unit_test(test_released_are_free), cmocka_unit_test(test_limit),
        cmocka_unit_test(test_material_limit),    cmocka_unit_test(test_stuck),
        cmocka_unit_test(test_lost_are_free),     cmocka_unit_test(test_largest_first),
        cmocka_unit_test(test_resumes),           cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_catches_up),        cmocka_unit_test(test_readings_resume),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

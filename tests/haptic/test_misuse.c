#include "haptic/idle_device.h"
#include "misuse.h"
#include "pellicle/haptic.h"
#include "sim/fixture.h"
#include "stage/stage.h"

static pel_status start(pel_haptic *haptic, bool reads, bool writes, pel_error *error)
{
    const pel_haptic_device device = {.read = reads ? read_nothing : NULL, .write = writes ? write_nothing : NULL};
    return pel_haptic_start(haptic, &device, error);
}

static void refuse_numbers(const pel_haptic_def *def)
{
    pel_haptic *haptic;
    pel_haptic_def wrong = *def;
    const double bad[] = {-1, (double)NAN, (double)INFINITY};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        wrong = *def, wrong.rate = bad[i];
        REFUSED("rate", pel_haptic_create(&wrong, &haptic, &error));
        wrong = *def, wrong.reach = bad[i];
        REFUSED("reach", pel_haptic_create(&wrong, &haptic, &error));
        wrong = *def, wrong.device_damping = bad[i];
        REFUSED("device_damping", pel_haptic_create(&wrong, &haptic, &error));
        wrong = *def, wrong.coupling_stiffness = bad[i];
        REFUSED("coupling_stiffness", pel_haptic_create(&wrong, &haptic, &error));
        wrong = *def, wrong.coupling_damping = bad[i];
        REFUSED("coupling_damping", pel_haptic_create(&wrong, &haptic, &error));
        wrong = *def, wrong.surface_stiffness = bad[i];
        REFUSED("surface_stiffness", pel_haptic_create(&wrong, &haptic, &error));
        wrong = *def, wrong.energy_budget = bad[i];
        REFUSED("energy_budget", pel_haptic_create(&wrong, &haptic, &error));
        wrong = *def, wrong.max_force = bad[i];
        REFUSED("max_force", pel_haptic_create(&wrong, &haptic, &error));
        wrong = *def, wrong.max_force_rate = bad[i];
        REFUSED("max_force_rate", pel_haptic_create(&wrong, &haptic, &error));
    }
    wrong = *def, wrong.rate = 99;
    REFUSED("rate", pel_haptic_create(&wrong, &haptic, &error));
    wrong = *def, wrong.device_damping = 0;
    REFUSED("device_damping", pel_haptic_create(&wrong, &haptic, &error));
    wrong = *def, wrong.coupling_damping = 0.5;
    REFUSED("coupling_damping", pel_haptic_create(&wrong, &haptic, &error));
    wrong = *def, wrong.max_force = 0;
    REFUSED("max_force", pel_haptic_create(&wrong, &haptic, &error));
    wrong = *def, wrong.coupling_stiffness = 1001;
    FAILS(pel_haptic_create(&wrong, &haptic, &error));
}

static void refuse_calls(pel_haptic *haptic)
{
    const double position[3] = {0, 0, 2}, endless[3] = {0, 0, (double)INFINITY}, crooked[4] = {1, 1, 0, 0};
    double force[3];
    REFUSED("haptic", pel_haptic_sync(NULL, &error));
    REFUSED("haptic", pel_haptic_update(NULL, position, NULL, force, &error));
    REFUSED("position", pel_haptic_update(haptic, NULL, NULL, force, &error));
    REFUSED("force", pel_haptic_update(haptic, position, NULL, NULL, &error));
    REFUSED("finite", pel_haptic_update(haptic, endless, NULL, force, &error));
    REFUSED("quaternion", pel_haptic_update(haptic, position, crooked, force, &error));
    REFUSED("device", pel_haptic_start(haptic, NULL, &error));
    REFUSED("haptic", start(NULL, true, true, &error));
    REFUSED("read", start(haptic, false, true, &error));
    REFUSED("write", start(haptic, true, false, &error));
    SURVIVES(pel_haptic_stop(NULL));
    SURVIVES(pel_haptic_stop(haptic));
    SURVIVES(pel_haptic_destroy(NULL));
    SURVIVES(pel_haptic_get(haptic, NULL));
    pel_haptic_reading reading;
    SURVIVES(pel_haptic_get(NULL, &reading));
    GIVES(pel_haptic_latency_quantile(NULL, 0.5) == 0);
    GIVES(pel_haptic_latency_quantile(&(pel_haptic_latency){.count = 0}, 0.5) == 0);
    GIVES(pel_haptic_passive_stiffness(0.5, 1, 1000) == 0);
}

static void test_haptic(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(2);
    pel_body_def body = ball_body(mesh);
    pel_model *model = make_model(&body);
    const pel_pose_key key = {.position = {0, 0, 2}, .rotation = {0, 0, 0, 1}};
    pel_tool_def tool = pel_tool_def_default();
    tool.name = "tip";
    tool.radius = 0.2;
    tool.keys = &key;
    tool.key_count = 1;
    tool.press = true;
    pel_sim_def sim_def = lone_sim(model, PEL_METHOD_QUASI_STATIC, 0.01);
    sim_def.tools = &tool;
    sim_def.tool_count = 1;
    pel_sim *sim = make_sim(&sim_def);
    pel_haptic_def def = pel_haptic_def_default(), wrong;
    /* energy that a delay would make is taken unless somebody declines that */
    assert_true(def.passivity_control);
    def.sim = sim;
    pel_haptic *haptic;
    REFUSED("haptic", pel_haptic_create(&def, NULL, &error));
    REFUSED("def", pel_haptic_create(NULL, &haptic, &error));
    wrong = def, wrong.cookie = 0;
    REFUSED("default", pel_haptic_create(&wrong, &haptic, &error));
    wrong = def, wrong.sim = NULL;
    REFUSED("sim", pel_haptic_create(&wrong, &haptic, &error));
    wrong = def, wrong.tool = 1;
    REFUSED("tool 1", pel_haptic_create(&wrong, &haptic, &error));
    wrong = def, wrong.tool = -1;
    REFUSED("tool -1", pel_haptic_create(&wrong, &haptic, &error));
    refuse_numbers(&def);
    assert_int_equal(pel_haptic_create(&def, &haptic, NULL), PEL_OK);
    refuse_calls(haptic);
    pel_haptic_destroy(haptic);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
    assert_int_equal(misuse_failures, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_haptic)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

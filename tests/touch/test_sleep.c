/* Bodies that rest in contact sleep: their step changes nothing and forces stay; what changes for them wakes them; what
   only moves slowly does not sleep. */
#include "contact/set.h"
#include "sim/contact_scene.h"
#include "touch/contact.h"

#define THICKNESS 2e-3

/* two sheets over each other on a box, the mean normal of which gravity leans against by `slope` */
static void resting(contact_scene *scene, bool sleeps, double friction, double slope)
{
    pel_transform transform = pel_transform_default();
    scene_begin(scene, PEL_METHOD_XPBD);
    transform.translation[2] = 1.05 * THICKNESS;
    for (int b = 0; b < 2; b++) {
        scene_body(scene, make_sheet(3, 0));
        scene->bodies[b].spring_damping.value = scene->bodies[b].volumetric_damping.value = 0;
        assert_int_equal(pel_mesh_transform(scene->meshes[b], &transform, NULL), PEL_OK);
        transform.translation[2] += 1.05 * THICKNESS;
    }
    scene->gravity = -8;
    scene->gravity_along = 8 * slope;
    scene->def.contact.thickness = THICKNESS;
    scene->def.contact.friction = friction;
    scene->def.contact.sleep = sleeps;
    pel_vec3_set(scene_tool(scene, PEL_TOOL_BOX)->half_extents, 5, 5, 0.5);
    scene_move(scene, 0, 0.5, 0.5, -0.5, -0.5, 1);
}

static double place_of(const pel_sim *sim, int axis)
{
    return (double)sim->state->position[0][axis];
}

static void test_sleeps(void **unused)
{
    (void)unused;
    contact_scene scene;
    resting(&scene, true, 0.3, 0);
    pel_sim *sim = scene_create(&scene);
    const double weight = 8 * 0.01 * 2 * scene.meshes[0]->vertex_count;
    run_free(sim, 250);
    assert_int_equal(sim->contacts->asleep_count, 2);
    /* what moves next is searched for */
    assert_false(sim->contacts->has_home);
    assert_true(statistics_of(sim).sleeping > 10);
    double before = place_of(sim, 2), forces[3 * 16];
    for (int n = 0; n < 20; n++) {
        pel_tool_reading reading;
        pel_sim_ledger ledger;
        pel_sim_measures measures;
        double sum = 0;
        run_free(sim, 1);
        pel_sim_get_tool(sim, 0, &reading);
        assert_near(reading.force[2], -weight, 0.01 * weight);
        pel_sim_get_contact_forces(sim, 1, forces);
        for (int v = 0; v < scene.meshes[1]->vertex_count; v++)
            sum += forces[3 * v + 2];
        assert_near(sum, 0.5 * weight, 0.01 * weight);
        pel_sim_get_ledger(sim, &ledger);
        assert_true(ledger.kinetic == 0 && ledger.energy_error <= 0.01 * ledger.supplied);
        pel_sim_measure(sim, &measures);
        assert_true(measures.contact_count > 0);
    }
    assert_true(place_of(sim, 2) == before);
    scene_end(&scene, sim);
}

/* pins carry on, and what refines sleeps between its events */
static void test_pinned_and_refined(void **unused)
{
    (void)unused;
    static const int32_t pinned[] = {0, 1, 2, 3};
    const double weight = 8 * 0.01 * 2 * 16;
    for (int refines = 0; refines < 2; refines++) {
        contact_scene scene;
        resting(&scene, true, 0.3, 0);
        scene.bodies[1].pinned = pinned;
        scene.bodies[1].pinned_count = 4;
        scene.bodies[0].refine.levels = refines;
        pel_sim *sim = scene_create(&scene);
        if (refines)
            assert_int_equal(pel_sim_refine(sim, 0, 5, 1, NULL), PEL_OK);
        run_free(sim, 300);
        assert_int_equal(sim->contacts->asleep_count, 2);
        pel_support_reading pins, later;
        pel_tool_reading table;
        pel_sim_get_support(sim, 1, &pins);
        pel_sim_get_tool(sim, 0, &table);
        assert_true(fabs(pins.force[2]) > 0.02 * weight);
        assert_near(pins.force[2] + table.force[2], -weight, 0.01 * weight);
        run_free(sim, 20);
        assert_int_equal(sim->contacts->asleep_count, 2);
        pel_sim_get_support(sim, 1, &later);
        assert_true(memcmp(pins.force, later.force, sizeof pins.force) == 0);
        double forces[3 * 16] = {0};
        forces[3 * 15 + 2] = 0.2;
        assert_int_equal(pel_sim_set_forces(sim, 1, forces, NULL), PEL_OK);
        run_free(sim, 1);
        assert_int_equal(sim->contacts->asleep_count, 0);
        scene_end(&scene, sim);
    }
}

/* a body whose vertices are all pinned carries its own weight too while everything else sleeps */
static void test_fixed_body(void **unused)
{
    (void)unused;
    int32_t pinned[16];
    contact_scene scene;
    resting(&scene, true, 0.3, 0);
    for (int32_t v = 0; v < 16; v++)
        pinned[v] = v;
    scene.bodies[0].pinned = pinned;
    scene.bodies[0].pinned_count = 16;
    pel_sim *sim = scene_create(&scene);
    run_free(sim, 250);
    assert_int_equal(sim->contacts->asleep_count, 1);
    pel_support_reading pins;
    pel_sim_get_support(sim, 0, &pins);
    assert_near(pins.force[2], -8 * 0.01 * 2 * 16, 0.01 * 8 * 0.01 * 2 * 16);
    scene_end(&scene, sim);
}

/* ---- what wakes ---- */

static pel_sim *asleep(contact_scene *scene)
{
    resting(scene, true, 0.3, 0);
    pel_tool_def *finger = scene_tool(scene, PEL_TOOL_SPHERE);
    finger->radius = 0.1;
    scene_move(scene, 1, 0.5, 0.5, 0.5, 0.5, 3.2);
    scene->keys[1][2] = (pel_pose_key){3.4, {0.5, 0.5, 0.08}, {0, 0, 0, 1}, {0}};
    scene->tools[1].key_count = 3;
    pel_sim *sim = scene_create(scene);
    run_free(sim, 300);
    assert_int_equal(sim->contacts->asleep_count, 2);
    return sim;
}

static void test_setters_wake(void **unused)
{
    (void)unused;
    contact_scene scene;
    double velocities[3 * 16] = {0};
    pel_sim *sim = asleep(&scene);
    double start = place_of(sim, 2);
    for (int v = 0; v < 16; v++)
        velocities[3 * v + 2] = 0.2;
    assert_int_equal(pel_sim_set_velocities(sim, 1, velocities, NULL), PEL_OK);
    run_free(sim, 2);
    /* one island: both are awake, and the lower one does not jump */
    assert_int_equal(sim->contacts->asleep_count, 0);
    assert_near(place_of(sim, 2), start, 0.02 * THICKNESS);
    assert_true((double)sim->state->velocity[sim->model->bodies[1].slice_begin * PEL_WIDTH][2] > 0);
    scene_end(&scene, sim);
}

static void test_forces_wake(void **unused)
{
    (void)unused;
    contact_scene scene;
    double forces[3 * 16] = {0};
    pel_sim *sim = asleep(&scene);
    forces[2] = 1;
    assert_int_equal(pel_sim_set_forces(sim, 1, forces, NULL), PEL_OK);
    run_free(sim, 1);
    assert_int_equal(sim->contacts->asleep_count, 0);
    scene_end(&scene, sim);
}

static void test_tools_wake(void **unused)
{
    (void)unused;
    contact_scene scene;
    pel_sim *sim = asleep(&scene);
    pel_tool_reading reading;
    /* far away it moves without waking anything */
    run_free(sim, 22);
    assert_int_equal(sim->contacts->asleep_count, 2);
    run_free(sim, 19);
    assert_int_equal(sim->contacts->asleep_count, 0);
    pel_sim_get_tool(sim, 1, &reading);
    assert_true(reading.force[2] > 0);
    scene_end(&scene, sim);
}

/* ---- what moves ---- */

/* growth that begins while a body sleeps */
static void test_growth_wakes(void **unused)
{
    (void)unused;
    static const pel_key keys[] = {{3.2, 0}, {4, 1}};
    contact_scene scene;
    resting(&scene, true, 0.3, 0);
    pel_membrane_def *membrane = &scene.bodies[0].shell.membrane;
    *membrane = pel_body_def_sheet("sheet", scene.meshes[0], 1e5, 1e-3, 1000).shell.membrane;
    membrane->rest_scale.value = 0.8;
    membrane->rest_keys = keys;
    membrane->rest_key_count = 2;
    pel_sim *sim = scene_create(&scene);
    while (pel_sim_time(sim) < 3.1)
        run_free(sim, 1);
    assert_int_equal(sim->contacts->asleep_count, 2);
    while (pel_sim_time(sim) < 3.4)
        run_free(sim, 1);
    assert_int_equal(sim->contacts->asleep_count, 0);
    scene_end(&scene, sim);
}

/* a slope just above the angle of friction: the sheets slide as if nothing could sleep; just below it they sleep */
static void test_slope(void **unused)
{
    (void)unused;
    for (int steep = 0; steep < 2; steep++) {
        double ends[2];
        for (int sleeps = 0; sleeps < 2; sleeps++) {
            contact_scene scene;
            resting(&scene, sleeps, 0.5, steep ? 0.51 : 0.49);
            pel_sim *sim = scene_create(&scene);
            run_free(sim, 200);
            assert_int_equal(sim->contacts->asleep_count, sleeps && !steep ? 2 : 0);
            ends[sleeps] = place_of(sim, 0);
            scene_end(&scene, sim);
        }
        assert_near(ends[1], ends[0], steep ? 0 : 0.02 * THICKNESS);
    }
}

/* what no force stops goes on, also by no more than a hundredth of the thickness per second */
static void test_slow_motion(void **unused)
{
    (void)unused;
    contact_scene scene;
    double velocities[3 * 16] = {0}, speed = 0.01 * THICKNESS;
    resting(&scene, true, 0, 0);
    scene.gravity = 0;
    pel_sim *sim = scene_create(&scene);
    for (int v = 0; v < 16; v++)
        velocities[3 * v] = speed;
    double start = place_of(sim, 0);
    assert_int_equal(pel_sim_set_velocities(sim, 0, velocities, NULL), PEL_OK);
    run_free(sim, 300);
    assert_near(place_of(sim, 0) - start, 3 * speed, sizeof(pel_real) == 8 ? 1e-3 * speed : 0.2 * speed);
    scene_end(&scene, sim);
}

/* ---- the same bits ---- */

static uint64_t hash_after(int threads, int saved_at)
{
    contact_scene scene;
    resting(&scene, true, 0.3, 0);
    scene.def.thread_count = threads;
    scene_tool(&scene, PEL_TOOL_SPHERE)->radius = 0.1;
    scene_move(&scene, 1, 0.5, 0.5, 0.5, 0.08, 3.2);
    pel_sim *sim = scene_create(&scene);
    run_steps(sim, saved_at);
    size_t size = pel_sim_save_size(sim);
    void *bytes = malloc(size);
    pel_sim_save(sim, bytes);
    pel_sim *other = make_sim(&scene.def);
    assert_int_equal(pel_sim_load(other, bytes, size, NULL), PEL_OK);
    assert_int_equal(other->contacts->asleep_count, sim->contacts->asleep_count);
    run_steps(other, 310 - saved_at);
    uint64_t hash = pel_sim_hash(other);
    pel_sim_destroy(other);
    free(bytes);
    scene_end(&scene, sim);
    return hash;
}

static void test_bits(void **unused)
{
    (void)unused;
    uint64_t hash = hash_after(1, 0);
    assert_true(hash_after(4, 0) == hash);
    /* awake, asleep, awake again */
    assert_true(hash_after(1, 60) == hash);
    assert_true(hash_after(1, 200) == hash);
    assert_true(hash_after(1, 300) == hash);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sleeps),      cmocka_unit_test(test_setters_wake),
        cmocka_unit_test(test_forces_wake), cmocka_unit_test(test_tools_wake),
        cmocka_unit_test(test_slope),       cmocka_unit_test(test_slow_motion),
        cmocka_unit_test(test_bits),        cmocka_unit_test(test_pinned_and_refined),
        cmocka_unit_test(test_fixed_body),  cmocka_unit_test(test_growth_wakes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

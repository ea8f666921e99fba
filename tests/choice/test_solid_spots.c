/* `refine: auto` of filled bodies: the force of a sphere that is pressed into a block. */
#include "failing_malloc.h"
#include "pellicle/sim_reading.h"
#include "scene/scene_run.h"

/* radius 20 mm, pressed 2 mm into a block of 120 x 120 x 60 mm that stands on a table */
#define BLOCK(more)                                                                                                    \
    "version: 1\nbodies:\n  - name: block\n    mesh: { shape: box, size_x: 0.12, size_y: 0.12, size_z: 0.06 }\n"       \
    "    volume: { young: 5000, edge: 0.02" more " }\n"                                                                \
    "    pinned: { box: { min: [-1, -1, -1], max: [1, 1, -0.029999] } }\n"
#define AUTO "    refine: auto\n"
#define FINGER(z)                                                                                                      \
    "solver: { method: static, dt: 1 }\nduration: 1\ntools:\n"                                                         \
    "  - { name: finger, shape: sphere, radius: 0.02, friction: 0,\n"                                                  \
    "      motion: [ { position: [0, 0, 0.05] }, { time: 1, position: [0, 0, " #z "] } ] }\n"
/* a small contact that goes far */
#define SLIDING                                                                                                        \
    "solver: { method: static, dt: 1 }\nduration: 1\ntools:\n"                                                         \
    "  - { name: finger, shape: sphere, radius: 0.02, motion: [ { position: [-0.05, 0, 0.0499] },\n"                   \
    "      { time: 1, position: [0.05, 0, 0.0499] }, { time: 2, position: [0, 0.05, 0.0499] } ] }\n"

/* over that of Hertz */
static double force_of(const char *text)
{
    run r;
    pel_error error = {0};
    pel_tool_reading reading;
    check_begin(&r, text);
    assert_int_equal(pel_sim_step(r.sim, &error), PEL_OK);
    pel_sim_get_tool(r.sim, 0, &reading);
    end(&r);
    return reading.force[2] / (4.0 / 3 * 5000 / 0.91 * sqrt(0.02) * pow(0.002, 1.5));
}

/* 1.10 of Hertz's force on a block that is so thin (Dimitriadis 2002) */
static void test_force(void **unused)
{
    (void)unused;
    skip_if_long();
    assert_true(force_of(BLOCK(", element: smooth") FINGER(0.048)) > 1.3);
    assert_near(force_of(BLOCK(", element: smooth") AUTO FINGER(0.048)), 1.10, 0.03 * 1.10);
}

static int32_t count_of(const char *text, const char *told)
{
    heard all = {""};
    const pel_log log = {.write = hear, .user = &all};
    pel_scene *scene;
    assert_int_equal(pel_scene_parse("a.yaml", text, strlen(text), NULL, 0, &log, &scene, NULL), PEL_OK);
    const int32_t count = scene->model.bodies[0].mesh->tetrahedron_count;
    if (strstr(all.text, told) == NULL)
        fail_msg("no '%s' in: %s", told, all.text);
    pel_scene_destroy(scene);
    return count;
}

static void test_places(void **unused)
{
    (void)unused;
    const int32_t base = count_of(BLOCK("") FINGER(0.048), "filled with");
    const int32_t fine = count_of(BLOCK("") AUTO FINGER(0.048), "'block' is refined where tools press it");
    assert_true(fine > 4 * base);
    /* smooth elements need fewer */
    assert_true(count_of(BLOCK(", element: smooth") AUTO FINGER(0.048), "is refined") < fine);
    /* a tool that stays away, and one that needs nothing */
    assert_int_equal(count_of(BLOCK("") AUTO FINGER(0.0501), "'block' is not refined"), base);
    assert_int_equal(count_of(BLOCK("") AUTO "duration: 1\n", "'block' is not refined"), base);
    /* too many tetrahedra: fewer, and told */
    const int32_t most = count_of(BLOCK("") AUTO SLIDING, "with longer edges than their forces need");
    assert_in_range(most, 50000, 160000);
}

/* vertices of the table stay pinned, all that there are now */
static void test_pins(void **unused)
{
    (void)unused;
    run r;
    check_begin(&r, BLOCK("") AUTO FINGER(0.048));
    const pel_body_def *body = &r.scene->model.bodies[0];
    int32_t low = 0;
    for (int32_t v = 0; v < body->mesh->vertex_count; v++)
        low += body->mesh->positions[v][2] < -0.029999;
    assert_int_equal(body->pinned_count, low);
    end(&r);
}

static pel_status parse_case(const void *unused, pel_error *error)
{
    (void)unused;
    const char *text = BLOCK("") AUTO FINGER(0.03);
    pel_scene *scene;
    pel_status status = pel_scene_parse("a.yaml", text, strlen(text), NULL, 0, NULL, &scene, error);
    pel_scene_destroy(scene);
    return status;
}

static void test_out_of_memory(void **unused)
{
    (void)unused;
    for_allocation_failures(parse_case, NULL, 29);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_force),
        cmocka_unit_test(test_places),
        cmocka_unit_test(test_pins),
        cmocka_unit_test(test_out_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

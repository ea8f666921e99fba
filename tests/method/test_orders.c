/* Substeps of xpbd: what touches goes by first order, with what pairs or ties connect to it, and nothing else does. */
#include "contact/set.h"
#include "method/meet.h"
#include "sim/contact_scene.h"
#include "solve/project.h"

enum { STEPS = 60 };

/* A ball that swings far above, and with it one that falls on a floor, tied to the first or not; the number of steps in
   which the second one touches. (vertex_count x 3) positions of the first one at the end. */
static int swing(bool has_other, bool is_tied, double *positions, bool *is_plain)
{
    contact_scene scene;
    int32_t ends[2] = {0, 0};
    pel_tie_def tie = pel_tie_def_default();
    scene_begin(&scene, PEL_METHOD_XPBD);
    scene.def.solver.substeps = 8;
    scene.gravity = -10;
    scene_body(&scene, make_moved_sphere(3, 0, 0, 30));
    scene.bodies[0].spring_damping.value = scene.bodies[0].volumetric_damping.value = 0;
    if (has_other)
        scene_body(&scene, make_moved_sphere(3, 5, 0, 1.02));
    pel_tool_def *floor = scene_tool(&scene, PEL_TOOL_BOX);
    for (int k = 0; k < 3; k++)
        floor->half_extents[k] = k < 2 ? 20 : 0.5;
    scene_move(&scene, 0, 0, 0, -0.5, -0.5, 1);
    tie.name = "thread";
    tie.target = PEL_TIE_VERTICES;
    tie.vertices = &ends[0];
    tie.to_vertices = &ends[1];
    tie.vertex_count = tie.to_body = 1;
    tie.stiffness = 1e-6;
    scene.def.ties = &tie;
    scene.def.tie_count = is_tied;
    pel_sim *sim = scene_create(&scene);
    const int32_t count = pel_sim_vertex_count(sim, 0);
    pel_sim_get_positions(sim, 0, positions);
    for (int32_t v = 0; v < count; v++)
        positions[3 * v] *= 1.1;
    assert_int_equal(pel_sim_set_positions(sim, 0, positions, NULL), PEL_OK);
    int touches = 0;
    *is_plain = false;
    for (int n = 0; n < STEPS; n++) {
        pel_sim_measures measures;
        run_steps(sim, 1);
        pel_sim_measure(sim, &measures);
        touches += measures.contact_count > 0;
        *is_plain |= n > 0 && sim->projector->orders[0] == PEL_ORDER_PLAIN;
        assert_true(!has_other || measures.contact_count == 0 || sim->projector->orders[1] == PEL_ORDER_PLAIN);
    }
    pel_sim_get_positions(sim, 0, positions);
    scene_end(&scene, sim);
    return touches;
}

static void test_beside(void **unused)
{
    (void)unused;
    double alone[3000], beside[3000];
    bool is_plain;
    memset(alone, 0, sizeof alone);
    memset(beside, 0, sizeof beside);
    assert_int_equal(swing(false, false, alone, &is_plain), 0);
    assert_false(is_plain);
    assert_true(swing(true, false, beside, &is_plain) > STEPS / 2);
    assert_false(is_plain);
    assert_memory_equal(alone, beside, sizeof alone);
    assert_true(swing(true, true, beside, &is_plain) > STEPS / 2);
    assert_true(is_plain);
}

/* whether a pair of the list has vertices of both bodies */
static bool are_near(const pel_sim *sim)
{
    const pel_contact_list *list = &sim->contacts->list;
    bool any = false;
    for (int32_t c = 0; c < list->count; c++) {
        int bodies = 0;
        for (int i = 0; i < 4; i++)
            if (list->contacts[c].weights[i] != 0)
                bodies |= 1 << sim->model->body_of_slice[list->contacts[c].vertices[i] / PEL_WIDTH];
        any |= bodies == 3;
    }
    return any;
}

/* a ball falls on one that lies on a floor: before they touch, pairs make both of first order */
static void test_approach(void **unused)
{
    (void)unused;
    contact_scene scene;
    int apart = 0, near = 0;
    scene_begin(&scene, PEL_METHOD_XPBD);
    scene.def.solver.substeps = 8;
    scene.gravity = -10;
    scene_body(&scene, make_moved_sphere(3, 0, 0, 3.3));
    scene_body(&scene, make_moved_sphere(3, 0, 0, 1.001));
    scene.bodies[0].spring_damping.value = scene.bodies[0].volumetric_damping.value = 0;
    scene.bodies[1].volumetric_stiffness.value = 1;
    pel_tool_def *floor = scene_tool(&scene, PEL_TOOL_BOX);
    for (int k = 0; k < 3; k++)
        floor->half_extents[k] = k < 2 ? 20 : 0.5;
    scene_move(&scene, 0, 0, 0, -0.5, -0.5, 1);
    pel_sim *sim = scene_create(&scene);
    for (int n = 0; n < STEPS; n++) {
        run_steps(sim, 1);
        uint8_t marks[2] = {0, 1};
        apart += sim->projector->orders[0] != sim->projector->orders[1];
        near += are_near(sim);
        pel_meet_spread(sim, marks);
        assert_int_equal(marks[0], are_near(sim));
        assert_int_equal(marks[1], 1);
    }
    print_message("%d steps apart, %d near\n", apart, near);
    assert_true(apart > 5 && near > 5);
    scene_end(&scene, sim);
}

/* a gas makes its own body of first order, unless the scene asks for second */
static void test_gas(void **unused)
{
    (void)unused;
    static const pel_choice choices[] = {PEL_AUTO, PEL_YES, PEL_NO};
    static const pel_substep_order orders[][2] = {
        {PEL_ORDER_PAST, PEL_ORDER_PLAIN}, {PEL_ORDER_PAST, PEL_ORDER_PAST}, {PEL_ORDER_PLAIN, PEL_ORDER_PLAIN}};
    for (int i = 0; i < 3; i++) {
        contact_scene scene;
        scene_begin(&scene, PEL_METHOD_XPBD);
        scene.def.contact.enabled = false;
        scene.def.solver.second_order = choices[i];
        scene_body(&scene, make_moved_sphere(3, 0, 0, 4));
        scene_body(&scene, make_moved_sphere(3, 5, 0, 4));
        scene.bodies[1].shell.pressure.kind = PEL_PRESSURE_GAS;
        scene.bodies[1].shell.pressure.value = 100;
        pel_sim *sim = scene_create(&scene);
        run_steps(sim, 3);
        for (int b = 0; b < 2; b++)
            assert_int_equal(sim->projector->orders[b], orders[i][b]);
        scene_end(&scene, sim);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_beside), cmocka_unit_test(test_approach),
                                       cmocka_unit_test(test_gas)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

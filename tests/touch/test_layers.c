/* Layers in whole simulations: what rests keeps its load, tools that are held back press with the force of their
   material, and pairs are found where surfaces stray from the way that was expected. */
#include "contact/set.h"
#include "math/extremes.h"
#include "sim/contact_scene.h"
#include "tool/solid.h"
#include "tool/tools.h"
#include "touch/contact.h"

/* A sheet that rests on a box: its layers carry the weight from step to step, and nothing moves. */
static void test_rests_on_solid(void **unused)
{
    (void)unused;
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_XPBD);
    scene_body(&scene, make_sheet(4, 0));
    scene.gravity = -8;
    pel_vec3_set(scene_tool(&scene, PEL_TOOL_BOX)->half_extents, 5, 5, 0.5);
    scene_move(&scene, 0, 0.5, 0.5, -0.501, -0.501, 1);
    pel_sim *sim = scene_create(&scene);
    const double weight = 8 * 0.01 * scene.meshes[0]->vertex_count;
    run_free(sim, 40);
    for (int n = 0; n < 10; n++) {
        pel_tool_reading reading;
        double carried = 0;
        run_steps(sim, 1);
        pel_sim_get_tool(sim, 0, &reading);
        assert_near(reading.force[2], -weight, (sizeof(pel_real) == 8 ? 1e-6 : 1e-3) * weight);
        for (int32_t c = 0; c < sim->tools->solids->list.count; c++)
            carried += sim->tools->solids->pairs[c].load;
        assert_near(carried, weight, (sizeof(pel_real) == 8 ? 1e-6 : 1e-3) * weight);
    }
    scene_end(&scene, sim);
}

/* mean force of a plate that goes 1 cm too far into a sheet on a table; smaller ones make it buckle */
static double pressed_by(double dt, bool *is_held_back)
{
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_XPBD);
    scene_body(&scene, make_sheet(6, 0));
    scene.def.solver.dt = dt;
    scene.def.contact.thickness = 2e-3;
    pel_vec3_set(scene_tool(&scene, PEL_TOOL_BOX)->half_extents, 1, 1, 0.1);
    pel_vec3_set(scene_tool(&scene, PEL_TOOL_BOX)->half_extents, 2, 2, 0.1);
    scene_move(&scene, 0, 0.5, 0.5, 0.11, 0.09, 0.2);
    scene_move(&scene, 1, 0.5, 0.5, -0.102, -0.102, 1);
    pel_sim *sim = scene_create(&scene);
    int count = (int)(0.1 / dt + 0.5);
    double force = 0;
    run_free(sim, 3 * count);
    for (int n = 0; n < count; n++) {
        pel_tool_reading reading;
        run_steps(sim, 1);
        pel_sim_get_tool(sim, 0, &reading);
        force += reading.force[2] / count;
        *is_held_back = reading.is_held_back;
    }
    scene_end(&scene, sim);
    return force;
}

static void test_held_back(void **unused)
{
    (void)unused;
    bool is_held_back[2];
    double coarse = pressed_by(0.01, &is_held_back[0]), fine = pressed_by(0.005, &is_held_back[1]);
    print_message("force %g N in steps of 10 ms, %g N in steps of 5 ms\n", coarse, fine);
    assert_true(is_held_back[0] && is_held_back[1]);
    assert_true(coarse > 0);
    assert_near(fine, coarse, 0.1 * coarse);
}

/* A ball is held too deep in a cloth on a table: what bulges around it moves by hundredths of an edge, round corners.
   Such steps are not divided; they were by the dozen. */
static void test_held_is_whole(void **unused)
{
    (void)unused;
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_XPBD);
    scene_body(&scene, make_sheet(12, 0));
    pel_body_def *cloth = &scene.bodies[0];
    cloth->spring_stiffness.value = cloth->spring_damping.value = cloth->volumetric_damping.value = 0;
    cloth->shell.membrane.on = true;
    cloth->shell.membrane.young.value = 1e6;
    cloth->shell.membrane.poisson = 0.3;
    cloth->shell.membrane.thickness.value = 2.5e-3;
    cloth->mass = 5e-3;
    scene.gravity = -10;
    scene.def.contact.friction = 0.3;
    scene_tool(&scene, PEL_TOOL_SPHERE)->radius = 0.08;
    pel_vec3_set(scene_tool(&scene, PEL_TOOL_BOX)->half_extents, 2, 2, 0.5);
    scene_move(&scene, 0, 0.5, 0.5, 0.2, 0.045, 0.3);
    scene_move(&scene, 1, 0.5, 0.5, -0.503, -0.503, 1);
    pel_sim *sim = scene_create(&scene);
    run_free(sim, 35);
    int64_t before = statistics_of(sim).steps_divided;
    run_free(sim, 15);
    pel_tool_reading reading;
    pel_sim_get_tool(sim, 0, &reading);
    int64_t divided = statistics_of(sim).steps_divided - before;
    print_message("%d of 15 steps divided, %g N\n", (int)divided, reading.force[2]);
    assert_true(reading.is_held_back || !reading.force_known);
    assert_true(divided <= 2);
    scene_end(&scene, sim);
}

/* A sheet falls on another one that is fixed: it does not go on as expected, the margin grows while it stops, and no
   pair is missed. */
static void test_strays(void **unused)
{
    (void)unused;
    contact_scene scene;
    int widened = 0;
    scene_begin(&scene, PEL_METHOD_XPBD);
    for (int b = 0; b < 2; b++) {
        scene_body(&scene, make_sheet(5, 0));
        scene.bodies[b].spring_damping.value = scene.bodies[b].volumetric_damping.value = 0;
    }
    pel_transform transform = pel_transform_default();
    pel_vec3_set(transform.translation, 0.03, 0.05, 0.1);
    assert_int_equal(pel_mesh_transform(scene.meshes[1], &transform, NULL), PEL_OK);
    scene.pinned = malloc((size_t)scene.meshes[0]->vertex_count * sizeof *scene.pinned);
    for (int32_t v = 0; v < scene.meshes[0]->vertex_count; v++)
        scene.pinned[scene.bodies[0].pinned_count++] = v;
    scene.bodies[0].pinned = scene.pinned;
    scene.gravity = -10;
    pel_sim *sim = scene_create(&scene);
    for (int n = 0; n < 25; n++) {
        run_free(sim, 1);
        /* it fell for .14 s */
        widened += n > 13 && sim->contacts->was_widened;
    }
    assert_true(widened > 0);
    scene_end(&scene, sim);
}

/* sheets of n x n cells over each other, as one mesh */
static pel_mesh *make_stack(int32_t count, int n, double size, double gap)
{
    pel_mesh *sheet = make_sheet(n, 0), *stack;
    int32_t vertices = sheet->vertex_count, triangles = sheet->triangle_count;
    double(*x)[3] = malloc((size_t)(count * vertices) * sizeof *x);
    int32_t(*corners)[3] = malloc((size_t)(count * triangles) * sizeof *corners);
    for (int32_t i = 0; i < count; i++) {
        for (int32_t v = 0; v < vertices; v++)
            pel_vec3_set(x[i * vertices + v], size * sheet->positions[v][0], size * sheet->positions[v][1],
                         (i + 1) * gap);
        for (int32_t t = 0; t < triangles; t++)
            for (int c = 0; c < 3; c++)
                corners[i * triangles + t][c] = i * vertices + sheet->triangles[t][c];
    }
    assert_int_equal(
        pel_mesh_create((const double *)x, count * vertices, (const int32_t *)corners, count * triangles, &stack, NULL),
        PEL_OK);
    pel_mesh_destroy(sheet);
    free(x);
    free(corners);
    return stack;
}

/* Sheets that fall together and are stopped one after the other, from below: none of them flies up, since no pair gets
   deep before it is looked at. */
static void test_stack_lands(void **unused)
{
    (void)unused;
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_XPBD);
    scene_body(&scene, make_stack(12, 3, 0.1, 6e-4));
    pel_body_def *body = &scene.bodies[0];
    body->mass = 0.006 / 16;
    body->spring_damping.value = body->volumetric_damping.value = 0;
    body->spring_stiffness.value = 200;
    scene.gravity = -9.81;
    scene.def.contact.thickness = 5e-4;
    scene.def.solver.substeps = 48;
    pel_vec3_set(scene_tool(&scene, PEL_TOOL_BOX)->half_extents, 5, 5, 0.5);
    scene_move(&scene, 0, 0.05, 0.05, -0.5, -0.5, 1);
    pel_sim *sim = scene_create(&scene);
    for (int n = 0; n < 12; n++) {
        pel_sim_ledger ledger;
        pel_sim_measures measures;
        run_free(sim, 1);
        pel_sim_get_ledger(sim, &ledger);
        pel_sim_measure(sim, &measures);
        assert_true(ledger.energy_error <= 0.01 * ledger.supplied);
        assert_true(measures.max_displacement < 12 * 1.05e-4);
    }
    scene_end(&scene, sim);
}

/* scales and moves a mesh */
static pel_mesh *placed(pel_mesh *mesh, double scale, double z)
{
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        for (int k = 0; k < 3; k++)
            mesh->positions[v][k] = scale * mesh->positions[v][k] + (k == 2 ? z : 0);
    return mesh;
}

static void make_sheet_of(pel_body_def *body, double young, double thickness, double mass)
{
    body->mass = mass / body->mesh->vertex_count;
    body->spring_stiffness.value = body->spring_damping.value = body->volumetric_damping.value = 0;
    body->shell.membrane.on = true;
    body->shell.membrane.kind = PEL_MEMBRANE_NEO_HOOKEAN;
    body->shell.membrane.young.value = young;
    body->shell.membrane.poisson = 0.3;
    body->shell.membrane.thickness.value = thickness;
}

/* A ball of half a kilogram that bounces on a cloth of 6 g on a table, solid or of triangles: no energy appears. */
static void test_heavy_on_light(void **unused)
{
    (void)unused;
    for (int kind = 0; kind < 2; kind++) {
        contact_scene scene;
        pel_mesh *table = placed(make_sheet(4, 0), 2, 0);
        scene_begin(&scene, PEL_METHOD_XPBD);
        scene_body(&scene, placed(make_sheet(12, 0), 0.2, 5e-4));
        scene_body(&scene, placed(make_moved_sphere(3, 2, 2, 0), 0.05, 0.052));
        make_sheet_of(&scene.bodies[0], 1e6, 5e-4, 0.006);
        make_sheet_of(&scene.bodies[1], 1e7, 3e-3, 0.5);
        scene.gravity = -9.81;
        scene.def.solver.substeps = 176;
        pel_tool_def *tool = scene_tool(&scene, kind == 0 ? PEL_TOOL_BOX : PEL_TOOL_MESH);
        pel_vec3_set(tool->half_extents, 2, 2, 0.5);
        tool->mesh = kind == 0 ? NULL : table;
        scene_move(&scene, 0, kind == 0 ? 0 : -1, kind == 0 ? 0 : -1, kind == 0 ? -0.5 : 0, kind == 0 ? -0.5 : 0, 1);
        pel_sim *sim = scene_create(&scene);
        double most = 0;
        for (int n = 0; n < 60; n++) {
            pel_sim_ledger ledger;
            run_free(sim, 1);
            pel_sim_get_ledger(sim, &ledger);
            most = pel_max(most, ledger.energy_error / ledger.supplied);
        }
        print_message("%s: %.3g of the work appeared\n", kind == 0 ? "solid" : "triangles", most);
        assert_true(most < 0.01);
        scene_end(&scene, sim);
        pel_mesh_destroy(table);
    }
}

/* The same ball on three such cloths: it lands, no energy appears, and before that the table carries their weight. */
static void test_heavy_on_stack(void **unused)
{
    (void)unused;
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_XPBD);
    scene_body(&scene, make_stack(3, 8, 0.2, 5e-4));
    scene_body(&scene, placed(make_moved_sphere(2, 2, 2, 0), 0.05, 0.056));
    make_sheet_of(&scene.bodies[0], 1e6, 5e-4, 0.018);
    make_sheet_of(&scene.bodies[1], 1e7, 3e-3, 0.5);
    scene.gravity = -9.81;
    scene.def.contact.thickness = 4e-4;
    scene.def.contact.friction = 0.3;
    scene.def.solver.substeps = 96;
    pel_vec3_set(scene_tool(&scene, PEL_TOOL_BOX)->half_extents, 2, 2, 0.5);
    scene_move(&scene, 0, 0, 0, -0.5, -0.5, 1);
    pel_sim *sim = scene_create(&scene);
    double most = 0, largest = 0;
    for (int n = 0; n < 30; n++) {
        pel_sim_ledger ledger;
        pel_tool_reading reading;
        run_free(sim, 1);
        pel_sim_get_ledger(sim, &ledger);
        pel_sim_get_tool(sim, 0, &reading);
        most = pel_max(most, ledger.energy_error / ledger.supplied);
        largest = pel_max(largest, -reading.force[2]);
    }
    print_message("%.3g of the work appeared, the largest force is %.3g N\n", most, largest);
    assert_true(most < 0.01);
    assert_true(largest > 2 * 0.5 * 9.81);
    scene_end(&scene, sim);
}

static pel_sim *make_resting(contact_scene *scene)
{
    scene_begin(scene, PEL_METHOD_XPBD);
    scene_body(scene, make_stack(4, 4, 0.1, 6e-4));
    scene->bodies[0].mass = 0.006 / 25;
    scene->bodies[0].spring_stiffness.value = 200;
    scene->gravity = -9.81;
    scene->def.contact.thickness = 5e-4;
    scene->def.contact.friction = 0.3;
    scene->def.contact.sleep = false;
    scene->def.solver.substeps = 48;
    pel_vec3_set(scene_tool(scene, PEL_TOOL_BOX)->half_extents, 5, 5, 0.5);
    scene_move(scene, 0, 0.05, 0.05, -0.5, -0.5, 1);
    return scene_create(scene);
}

/* In a stack that rests awake the pairs of one search serve for all steps, and no step looks for conflicts; a snapshot
   of it goes on in the same way. */
static void test_stack_rests(void **unused)
{
    (void)unused;
    contact_scene scene;
    pel_sim *sim = make_resting(&scene);
    run_free(sim, 30);
    const pel_contact_statistics before = sim->contacts->statistics;
    size_t size = pel_sim_save_size(sim);
    unsigned char *bytes = malloc(size);
    pel_sim_save(sim, bytes);
    pel_sim *other = make_sim(&scene.def);
    assert_int_equal(pel_sim_load(other, bytes, size, NULL), PEL_OK);
    for (int n = 0; n < 20; n++) {
        run_free(sim, 1);
        run_steps(other, 1);
        assert_true(sim->touch->is_same && other->touch->is_same);
        assert_true(pel_sim_hash(other) == pel_sim_hash(sim));
    }
    assert_true(sim->contacts->statistics.candidates == before.candidates);
    assert_true(other->contacts->statistics.candidates == before.candidates);
    /* vertices over vertices are one pair, not one from either side */
    assert_int_equal(sim->contacts->list.count, 3 * 25);
    free(bytes);
    pel_sim_destroy(other);
    scene_end(&scene, sim);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rests_on_solid), cmocka_unit_test(test_held_back),
        cmocka_unit_test(test_held_is_whole),  cmocka_unit_test(test_strays),
        cmocka_unit_test(test_stack_lands),    cmocka_unit_test(test_heavy_on_stack),
        cmocka_unit_test(test_heavy_on_light), cmocka_unit_test(test_stack_rests),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

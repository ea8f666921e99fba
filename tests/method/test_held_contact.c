/* What pins carry: contacts on pinned vertices too. */
#include "sim/contact_scene.h"

/* a ball lies on a sheet whose vertices are all pinned: the pins carry both */
static void test_load(void **unused)
{
    (void)unused;
    static const pel_method methods[] = {PEL_METHOD_XPBD, PEL_METHOD_PBD};
    for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
        contact_scene scene;
        scene_begin(&scene, methods[m]);
        scene_body(&scene, make_sheet(6, 0));
        scene_body(&scene, make_moved_sphere(2, 0.5, 0.5, 1.01));
        const int32_t count = scene.meshes[0]->vertex_count;
        scene.pinned = malloc((size_t)count * sizeof *scene.pinned);
        for (int32_t v = 0; v < count; v++)
            scene.pinned[v] = v;
        scene.bodies[0].pinned = scene.pinned;
        scene.bodies[0].pinned_count = count;
        scene.gravity = -10;
        scene.def.solver.drag = 5;
        pel_sim *sim = scene_create(&scene);
        run_steps(sim, 200);
        double mean = 0;
        for (int i = 0; i < 100; i++) {
            pel_support_reading reading;
            run_steps(sim, 1);
            pel_sim_get_support(sim, 0, &reading);
            mean += reading.force[2] / 100;
        }
        double weight = 0.1 * (count + scene.meshes[1]->vertex_count);
        assert_near(mean, -weight, 0.03 * weight);
        scene_end(&scene, sim);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_load)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

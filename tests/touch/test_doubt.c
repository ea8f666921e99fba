/* Forces of tools are not known where the guard has stepped back what they press. */
#include "base/memory.h"
#include "pellicle/sim_reading.h"
#include "sim/contact_scene.h"
#include "tool/grip.h"
#include "tool/tools.h"
#include "touch/contact.h"
#include "touch/doubt.h"

/* Two sheets: a tool presses the first, which presses the second or not. */
static void test_doubts(void **unused)
{
    (void)unused;
    contact_scene scene;
    scene_begin(&scene, PEL_METHOD_XPBD);
    for (int b = 0; b < 2; b++) {
        scene_body(&scene, make_sheet(3, 0));
        pel_transform transform = pel_transform_default();
        transform.translation[2] = 0.5 * b;
        assert_int_equal(pel_mesh_transform(scene.meshes[b], &transform, NULL), PEL_OK);
    }
    pel_vec3_set(scene_tool(&scene, PEL_TOOL_BOX)->half_extents, 5, 5, 0.5);
    scene_move(&scene, 0, 0.5, 0.5, -0.9, -0.9, 1);
    pel_sim *sim = scene_create(&scene);
    run_steps(sim, 1);
    pel_contact_set *contacts = sim->contacts;
    pel_contact_forces *forces = &sim->contact_forces;
    if (contacts->solved == NULL)
        contacts->solved = pel_allocate((size_t)contacts->vertex_count, sizeof *contacts->solved);
    memcpy(contacts->solved, contacts->end, (size_t)contacts->vertex_count * sizeof *contacts->solved);
    forces->pair_next[2].load_size = 1;
    for (int n = 0; n < 8; n++) {
        bool steps_back = n & 1, presses = n & 2;
        int32_t body = n / 4;
        double *moved = contacts->solved[sim->model->bodies[body].slice_begin * PEL_WIDTH + 1], kept = moved[1];
        forces->pair_next[1].load_size = presses ? 1 : 0;
        moved[1] += 0.1;
        sim->tools->items[0].is_doubtful = false;
        pel_contacts_doubt_forces(sim, steps_back);
        assert_true(sim->tools->items[0].is_doubtful == (steps_back && (body == 0 || presses)));
        moved[1] = kept;
    }
    sim->tools->items[0].is_doubtful = true;
    pel_tools_end_step(sim, 0);
    pel_tool_reading reading;
    pel_sim_get_tool(sim, 0, &reading);
    assert_false(reading.force_known);
    scene_end(&scene, sim);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_doubts)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* Grasps and attachments that let go between steps: what falls from there, falls as long as it should. */
#define _XOPEN_SOURCE 700 /* nftw */
#include "run/warned.h"

#define CLOTH                                                                                                          \
    "version: 1\nbodies:\n  - name: cloth\n    mesh: { shape: grid, nx: 4, ny: 4, size_x: 0.3, size_y: 0.3 }\n"        \
    "    membrane: { preset: silicone }\ngravity: [0, 0, -9.81]\nduration: 0.8\n"

/* g (t - 0.3)^2 / 2 */
static void test_fall(const char *scene)
{
    static const char *const methods[] = {"solver.method=implicit", "solver.method=xpbd"};
    static const char *const steps[] = {"solver.dt=0.05", "solver.dt=0.035", "solver.dt=0.0175", "solver.dt=0.013"};
    for (size_t m = 0; m < 2; m++)
        for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
            const char *own[] = {methods[m], steps[i]};
            pel_run_summary summary;
            run_scene(scene, own, 2, NULL, 0, &summary);
            const double fall = summary.time_simulated - 0.3, way = 0.5 * 9.81 * fall * fall;
            print_message("%s, %s: %.4f of the way\n", methods[m], steps[i], summary.max_displacement / way);
            assert_near(summary.max_displacement / way, 1, 0.006);
        }
}

static void test_grasp(void **unused)
{
    (void)unused;
    test_fall(CLOTH "tools:\n  - { name: hand, shape: box, size: [0.4, 0.4, 0.1], press: false, "
                    "grasp: { reach: 0.05, until: 0.3 }, motion: [ { position: [0, 0, 0] } ] }\n");
}

static void test_attachment(void **unused)
{
    (void)unused;
    test_fall(CLOTH "attachments:\n  - { body: cloth, at: all, until: 0.3 }\n");
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_grasp), cmocka_unit_test(test_attachment)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* xpbd with far too few substeps for its material. */
#include "pellicle/sim_ledger.h"
#include "scene_run.h"

#include <math.h>

#define SLACK(mesh, material)                                                                                          \
    "version: 1\ngravity: [0, 0, -9.81]\nbodies:\n  - name: slack\n    mesh: { shape: " mesh " }\n    " material       \
    "\n    mass: { density: 1000 }\n    pinned: { box: { min: [-1, -1, -1], max: [-0.049, 1, 1] } "                    \
    "}\nsolver: { method: xpbd, dt: 0.005, substeps: 2 }\nduration: 0.3\n"

/* A single sweep takes back no more than half of the compliance of a block, and stays stable: the energy is at most
   1.9 J. Without this bound it is 2e6 J (first sheet) and 4e8 J (beam, which diverges). */
static void test_bound_of_blocks(void **unused)
{
    (void)unused;
    static const char *const scenes[] = {
        SLACK("grid, nx: 12, ny: 6, size_x: 0.1, size_y: 0.05",
              "membrane: { material: stvk, young: 1e8, thickness: 0.001 }"),
        SLACK("grid, nx: 12, ny: 6, size_x: 0.1, size_y: 0.05", "membrane: { young: 1e8, thickness: 0.001 }"),
        SLACK("box, size_x: 0.1, size_y: 0.02, size_z: 0.02, nx: 10, ny: 2, nz: 2",
              "volume: { young: 1e6, poisson: 0.45, element: linear }"),
    };
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        run r;
        pel_sim_ledger ledger;
        double most = 0;
        check_begin(&r, scenes[i]);
        for (int s = 0; s < 60; s++) {
            assert_int_equal(pel_sim_step(r.sim, NULL), PEL_OK);
            pel_sim_get_ledger(r.sim, &ledger);
            most = fmax(most, ledger.elastic + ledger.kinetic);
        }
        assert_true(most < 10);
        end(&r);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_bound_of_blocks)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

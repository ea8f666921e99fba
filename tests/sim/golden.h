/* One hash of the whole state for each method, alone (test_golden.c), and with contact and refinement
   (test_golden_contact.c): the same bits for GCC and Clang, debug and release, with and without AVX2, and any number of
   threads. A change of the arithmetic on purpose changes the constants; say so in its commit. Only sqrt and the four
   operations are on the way (no sin, no exp), so the C library does not matter; hinges under Newton's method take
   angles from that of Debian 12. */
#ifndef PEL_TESTS_SIM_GOLDEN_H
#define PEL_TESTS_SIM_GOLDEN_H

#include "sim/fixture.h"
#include "stage/stage.h"

typedef struct golden_case {
    pel_solver_def solver;
    uint64_t early, hash; /* after a fifth of the time, and at the end */
    bool contact, shell, refines;
    pel_membrane_kind law; /* of the shell; stvk unless given */
} golden_case;

static inline void run_case(const golden_case *given, int thread_count, bool is_whole, uint64_t hashes[2])
{
    const pel_solver_def *solver = &given->solver;
    bool is_newton = solver->method == PEL_METHOD_STATIC || solver->method == PEL_METHOD_IMPLICIT;
    bool is_small = solver->method == PEL_METHOD_DESCENT || given->refines;
    pel_mesh *mesh = make_sphere(is_newton ? 5 : is_small ? 8 : 18);
    pel_body_def body = ball_body(mesh);
    body.volumetric_by_area = true;
    if (given->shell) {
        body.shell.membrane.on = true;
        body.shell.membrane.kind = given->law;
        body.shell.membrane.young.value = 500;
        body.shell.membrane.poisson = 0.3;
        body.shell.membrane.thickness.value = 0.01;
        body.shell.bending.model = PEL_BENDING_HINGE;
    }
    if (given->refines) {
        body.refine.levels = 1;
        body.refine.near_tools = 0.2;
    }
    pel_model *model = make_model(&body);
    const int32_t pulled[3] = {7, 100, is_newton ? 201 : is_small ? 501 : 911};
    pel_load_def load = pel_load_def_default();
    load.force[0] = 0.5;
    load.force[1] = -0.25;
    load.vertices = pulled;
    load.vertex_count = 3;
    load.until = 1;
    const pel_pose_key keys[3] = {
        {0, {0, 0, 1.5}, {0, 0, 0, 1}, {0}}, {1, {0, 0, 1.0}, {0, 0, 0, 1}, {0}}, {2, {0, 0, 1.5}, {0, 0, 0, 1}, {0}}};
    pel_tool_def tool = pel_tool_def_default();
    tool.name = "probe";
    tool.radius = 0.4;
    tool.keys = keys;
    tool.key_count = 3;
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    def.solver = *solver;
    def.loads = &load;
    def.load_count = 1;
    def.tools = &tool;
    def.tool_count = 1;
    def.thread_count = thread_count;
    def.contact.enabled = given->contact;
    def.contact.friction = 0.3;
    pel_sim *sim = make_sim(&def);
    int steps = (int)(1.5 / solver->dt + 0.5), early = (steps + 4) / 5;
    run_steps(sim, early);
    hashes[0] = pel_sim_hash(sim);
    if (is_whole)
        run_steps(sim, steps - early);
    hashes[1] = pel_sim_hash(sim);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* Whole runs with 4 threads, and what 1 thread does at first; the plain copy of the core, which has the same sources,
   with one number of threads. A sanitizer's steps take so long that it sees the early ones alone. */
static inline void check_cases(const golden_case *cases, size_t case_count)
{
    if (sizeof(pel_real) != 8)
        skip(); /* the constants are those of double */
    const char *kernels = getenv("PELLICLE_KERNELS");
    bool is_once = kernels != NULL || is_slow();
    int wrong = 0;
    for (size_t c = 0; c < case_count; c++)
        for (int threads = is_once ? 2 : 1; threads <= (is_once ? 2 : 4); threads *= 4) {
            uint64_t hashes[2];
            bool is_whole = !is_slow() && threads > 1;
            run_case(&cases[c], threads, is_whole, hashes);
            bool is_right = hashes[0] == cases[c].early && (!is_whole || hashes[1] == cases[c].hash);
            if (!is_right)
                print_error("case %d, %d threads: 0x%016llx, 0x%016llx\n", (int)c, threads,
                            (unsigned long long)hashes[0], (unsigned long long)hashes[1]);
            wrong += !is_right;
        }
    assert_int_equal(wrong, 0);
}

#endif

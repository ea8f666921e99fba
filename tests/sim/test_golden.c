/* One hash of the whole state for each method: the same bits for GCC and Clang, debug and release, with and without
   AVX2, and any number of threads. A change of the arithmetic on purpose changes the constants below; say so in its
   commit. Only sqrt and the four operations are on the way (no sin, no exp), so the C library does not matter; hinges
   under Newton's method take angles from that of Debian 12. */
#include "sim/fixture.h"
#include "stage/stage.h"

typedef struct golden_case {
    pel_solver_def solver;
    uint64_t early, hash; /* after a fifth of the time, and at the end */
    bool contact, shell, refines;
} golden_case;

static void run_case(const golden_case *given, int thread_count, bool is_whole, uint64_t hashes[2])
{
    const pel_solver_def *solver = &given->solver;
    bool is_newton = solver->method == PEL_METHOD_STATIC || solver->method == PEL_METHOD_IMPLICIT;
    bool is_small = solver->method == PEL_METHOD_DESCENT || given->refines;
    pel_mesh *mesh = make_sphere(is_newton ? 5 : is_small ? 8 : 18);
    pel_body_def body = ball_body(mesh);
    body.volumetric_by_area = true;
    if (given->shell) {
        body.shell.membrane.on = true;
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

static const golden_case cases[] = {
    {.solver = {.method = PEL_METHOD_QUASI_STATIC, .dt = 0.01, .alpha = 50},
     .early = UINT64_C(0x3f432437b66082f8),
     .hash = UINT64_C(0x584d1616326a71eb)},
    {.solver = {.method = PEL_METHOD_QUASI_STATIC, .dt = 0.01, .alpha = 15, .keep_velocity = true},
     .early = UINT64_C(0x81b231283e874d9d),
     .hash = UINT64_C(0xff8feeb56245ef52)},
    {.solver = {.method = PEL_METHOD_EXPLICIT, .dt = 0.001},
     .early = UINT64_C(0x190ca489498db81c),
     .hash = UINT64_C(0x44fceb1b1c78e541)},
    {.solver = {.method = PEL_METHOD_EXPLICIT, .dt = 0.01, .symplectic = true},
     .early = UINT64_C(0xe2bd982afd66159b),
     .hash = UINT64_C(0xe556640eb37ed050)},
    {.solver = {.method = PEL_METHOD_PBD, .dt = 0.01},
     .early = UINT64_C(0xc5131512376206fd),
     .hash = UINT64_C(0x506e90fd4c4f0255),
     .shell = true},
    {.solver = {.method = PEL_METHOD_XPBD, .dt = 0.01, .substeps = 8},
     .early = UINT64_C(0xd580eec367a0af17),
     .hash = UINT64_C(0x4b82045cec65d24c),
     .shell = true},
    {.solver = {.method = PEL_METHOD_XPBD, .dt = 0.01, .substeps = 4, .second_order = PEL_YES},
     .early = UINT64_C(0xe64b6ec88cf862c4),
     .hash = UINT64_C(0x86d0a10fe2400bd2),
     .shell = true},
    {.solver = {.method = PEL_METHOD_XPBD, .dt = 0.01, .substeps = 8},
     .early = UINT64_C(0x4b6f9e2b0dc78609),
     .hash = UINT64_C(0xb751bebffb486b76),
     .shell = true,
     .contact = true},
    {.solver = {.method = PEL_METHOD_XPBD, .dt = 0.01, .substeps = 8},
     .early = UINT64_C(0x11d0f14cc3761a0d),
     .hash = UINT64_C(0xc913b9cf6562c874),
     .refines = true},
    {.solver = {.method = PEL_METHOD_QUASI_STATIC, .dt = 0.01},
     .early = UINT64_C(0x9f132979f234245a),
     .hash = UINT64_C(0x9d21f4f31ef335ef),
     .refines = true},
    {.solver = {.method = PEL_METHOD_DESCENT, .dt = 0.05, .iterations = 20},
     .early = UINT64_C(0x816f991a5aa036c1),
     .hash = UINT64_C(0x31fd436b8c8d8b03),
     .shell = true},
    {.solver = {.method = PEL_METHOD_DESCENT, .dt = 0.05, .iterations = 20},
     .early = UINT64_C(0xcb5ef94cd8fe834a),
     .hash = UINT64_C(0xce63430d2c27c374),
     .shell = true,
     .contact = true},
    {.solver = {.method = PEL_METHOD_IMPLICIT, .dt = 0.1},
     .early = UINT64_C(0x7dc58d183bc4fe65),
     .hash = UINT64_C(0x2f6e75a0b92a51a4),
     .shell = true},
    {.solver = {.method = PEL_METHOD_IMPLICIT, .dt = 0.1},
     .early = UINT64_C(0x22da1a245d22616c),
     .hash = UINT64_C(0x029ce1df468c35a5),
     .shell = true,
     .contact = true},
    {.solver = {.method = PEL_METHOD_IMPLICIT, .dt = 0.1},
     .early = UINT64_C(0x1632036b9143909b),
     .hash = UINT64_C(0x2fd2e218eb260f13),
     .refines = true},
    {.solver = {.method = PEL_METHOD_STATIC, .dt = 0.25},
     .early = UINT64_C(0xb057deb6e7deeeec),
     .hash = UINT64_C(0x8e49b6623c45d7f2),
     .shell = true},
    {.solver = {.method = PEL_METHOD_XPBD, .dt = 0.01, .substeps = 8},
     .early = UINT64_C(0x2d2bc7db668b94b0),
     .hash = UINT64_C(0x38be4154b7dd3d58),
     .refines = true,
     .shell = true,
     .contact = true},
};

/* Whole runs with 4 threads, and what 1 thread does at first; the plain copy of the core, which has the same sources,
   with one number of threads. A sanitizer's steps take so long that it sees the early ones alone. */
static void test_hashes(void **unused)
{
    (void)unused;
    if (sizeof(pel_real) != 8)
        skip(); /* the constants are those of double */
    const char *kernels = getenv("PELLICLE_KERNELS");
    bool is_once = kernels != NULL || is_slow();
    int wrong = 0;
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++)
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

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_hashes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

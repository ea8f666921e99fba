/* Real surfaces under a ball: it is pressed in, its force rises, it is withdrawn, its force falls to zero, and the
   surface recovers. Scales from edges of 0.3 mm to busts of 0.5 m in millimetres. Runs where the shared meshes are; a
   sphere of uneven triangles stands in elsewhere. */
#include "pellicle/mesh_io.h"
#include "pellicle/sim_ledger.h"
#include "sim/fixture.h"
#include "source_dir.h"
#include "stage/stage.h"

#include <unistd.h>

typedef struct organ {
    const char *file;
    double radius, depth;
} organ;

/* the highest vertex */
static int32_t top_of(const pel_mesh *mesh)
{
    int32_t top = 0;
    for (int32_t v = 1; v < mesh->vertex_count; v++)
        if (mesh->positions[v][2] > mesh->positions[top][2])
            top = v;
    return top;
}

enum { PUSH = 300, HOLD = 100, PULL = 300, FREE = 400 };

static void press(pel_mesh *mesh, double radius, double depth)
{
    int32_t top = top_of(mesh);
    const double *p = mesh->positions[top];
    double clear = p[2] + 1.05 * radius, deep = p[2] + radius - depth, dt = 0.01;
    const pel_pose_key keys[4] = {{0, {p[0], p[1], clear}, {0, 0, 0, 1}, {0}},
                                  {PUSH * dt, {p[0], p[1], deep}, {0, 0, 0, 1}, {0}},
                                  {(PUSH + HOLD) * dt, {p[0], p[1], deep}, {0, 0, 0, 1}, {0}},
                                  {(PUSH + HOLD + PULL) * dt, {p[0], p[1], clear}, {0, 0, 0, 1}, {0}}};
    pel_tool_def tool = pel_tool_def_default();
    tool.name = "ball";
    tool.radius = radius;
    tool.keys = keys;
    tool.key_count = 4;
    pel_body_def body = pel_body_def_default();
    body.name = "organ";
    body.mesh = mesh;
    /* paper A's 252 home springs shared out over the vertices that there are, edge springs in proportion: every mesh
       recovers in the same number of steps (with springs by area, small triangles recover more slowly) */
    body.volumetric_stiffness.value = 1.5 * 252 / mesh->vertex_count;
    body.spring_stiffness.value = 4 * body.volumetric_stiffness.value;
    pel_model *model = make_model(&body);
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    def.tools = &tool;
    def.tool_count = 1;
    pel_sim *sim = make_sim(&def);
    pel_sim_measures measures;
    pel_tool_reading reading;
    double force[3];
    const int stops[3] = {PUSH / 2, PUSH / 2 + HOLD / 2, HOLD / 2 + PULL};
    for (int n = 0; n < 3; n++) {
        run_steps(sim, stops[n]);
        pel_sim_get_tool(sim, 0, &reading);
        force[n] = reading.force[2];
        if (n == 1) {
            pel_sim_measure(sim, &measures);
            assert_near(measures.max_displacement, depth, 0.25 * depth);
        }
    }
    assert_true(force[0] > 0 && force[1] > force[0] && force[2] == 0);
    run_steps(sim, FREE);
    pel_sim_measure(sim, &measures);
    if (!(measures.max_displacement < 0.02 * depth))
        print_error("%g of %g is left\n", measures.max_displacement, depth);
    assert_true(measures.max_displacement < 0.02 * depth);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
}

static void test_real_meshes(void **unused)
{
    (void)unused;
    const organ organs[] = {{"tests/data/bean", 0.01, 0.01},      {"tests/data/sac", 0.004, 0.002},
                            {"../shared/data/liver", 0.01, 0.01}, {"../shared/data/gallbladder", 0.004, 0.002},
                            {"../shared/data/spot", 0.15, 0.1},   {"../shared/data/nefertiti-head", 40, 20}};
    int found = 0;
    for (size_t i = 0; i < sizeof organs / sizeof *organs; i++) {
        char path[600];
        snprintf(path, sizeof path, PEL_SOURCE_DIR "/%s.obj", organs[i].file);
        if (access(path, R_OK) != 0)
            continue;
        pel_mesh *mesh;
        assert_int_equal(pel_mesh_read(path, PEL_FORMAT_AUTO, NULL, &mesh, NULL), PEL_OK);
        press(mesh, organs[i].radius, organs[i].depth);
        pel_mesh_destroy(mesh);
        found++;
    }
    assert_true(found >= 2);
}

static void test_uneven_sphere(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(16);
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        /* triangles five times smaller on one side */
        double *p = mesh->positions[v], squeeze = 0.6 + 0.4 * p[0];
        p[1] *= squeeze;
        p[2] *= squeeze;
    }
    press(mesh, 0.2, 0.15);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_real_meshes),
        cmocka_unit_test(test_uneven_sphere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

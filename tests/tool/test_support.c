/* Supports: forces on pinned vertices, and supports that move on keys. */
#include "pellicle/shape.h"
#include "pellicle/sim_ledger.h"
#include "shell_fixture.h"
#include "stage/stage.h"

static const double young = 1e5, thickness = 1e-3, width = 0.1, length = 0.4;

typedef struct strip {
    pel_mesh *mesh;
    pel_body_def body;
    pel_model *model;
    int32_t left[50], right[50], left_count, right_count;
    pel_pose_key keys[2];
    pel_tool_def tool;
    pel_sim_def def;
} strip;

/* a strip along x of a membrane without lateral contraction, pinned at its left end */
static void begin(strip *s, pel_method method, double dt)
{
    memset(s, 0, sizeof *s);
    s->mesh = make_grid(8, 2, length, width, PEL_GRID_UNION_JACK);
    for (int32_t v = 0; v < s->mesh->vertex_count; v++) {
        double x = s->mesh->positions[v][0];
        if (x < -0.499 * length)
            s->left[s->left_count++] = v;
        else if (x > 0.499 * length)
            s->right[s->right_count++] = v;
    }
    pel_body_def *body = &s->body;
    *body = shell_body(s->mesh, PEL_MEMBRANE_STVK);
    body->name = "strip";
    body->thickness.value = body->shell.membrane.thickness.value = thickness;
    body->shell.membrane.young.value = young;
    body->shell.membrane.poisson = 0;
    body->pinned = s->left;
    body->pinned_count = s->left_count;
    s->def = lone_sim(NULL, method, dt);
    s->tool = pel_tool_def_default();
    s->tool.name = "strip_support";
    s->tool.body = 0;
    s->tool.press = false;
    s->tool.keys = s->keys;
    s->tool.key_count = 2;
}

static pel_sim *create(strip *s, double gravity)
{
    pel_model_def def = pel_model_def_default();
    def.bodies = &s->body;
    def.body_count = 1;
    def.gravity[0] = gravity;
    assert_int_equal(pel_model_create(&def, &s->model, NULL), PEL_OK);
    s->def.model = s->model;
    return make_sim(&s->def);
}

static void end(strip *s, pel_sim *sim)
{
    pel_sim_destroy(sim);
    pel_model_destroy(s->model);
    pel_mesh_destroy(s->mesh);
}

/* pulls the right end by `stretch` within half a second, by a support or by a box that grasps */
static void pull(strip *s, bool by_support, double stretch)
{
    const double end_at[3] = {length / 2, 0, 0};
    for (int k = 0; k < 2; k++) {
        s->keys[k] = (pel_pose_key){0.5 * k, {0}, {0, 0, 0, 1}, {0}};
        s->keys[k].position[0] = end_at[0] + k * stretch;
    }
    s->tool.shape = by_support ? PEL_TOOL_SUPPORT : PEL_TOOL_BOX;
    s->tool.vertices = s->right;
    s->tool.vertex_count = s->right_count;
    pel_vec3_copy(end_at, s->tool.center);
    s->tool.grasp = !by_support;
    pel_vec3_set(s->tool.half_extents, 0.01, 0.2, 0.01);
    s->def.tools = &s->tool;
    s->def.tool_count = 1;
}

typedef struct method_case {
    pel_method method;
    double dt, drag;
    int steps, iterations;
} method_case;

static const method_case cases[] = {
    {PEL_METHOD_EXPLICIT, 5e-4, 10, 4000, 0}, {PEL_METHOD_QUASI_STATIC, 0.01, 0, 6000, 0},
    {PEL_METHOD_XPBD, 0.01, 10, 300, 0},      {PEL_METHOD_PBD, 0.01, 10, 300, 20},
    {PEL_METHOD_DESCENT, 0.1, 0, 10, 3000},   {PEL_METHOD_IMPLICIT, 0.05, 10, 100, 0},
    {PEL_METHOD_STATIC, 0.1, 0, 10, 0},
};
enum { CASE_COUNT = sizeof cases / sizeof cases[0] };

/* the pins of a hanging strip carry its weight, their own included, and its moment about the origin */
static void test_weight(void **unused)
{
    (void)unused;
    for (int c = 0; c < CASE_COUNT; c++) {
        strip s;
        begin(&s, cases[c].method, cases[c].dt);
        s.def.solver.drag = cases[c].drag;
        s.def.solver.iterations = cases[c].iterations;
        pel_sim *sim = create(&s, 9.81);
        run_steps(sim, cases[c].steps);
        pel_support_reading reading;
        pel_sim_get_support(sim, 0, &reading);
        double weight = 1000 * thickness * width * length * 9.81;
        check_reactions(sim);
        assert_int_equal(reading.vertex_count, s.left_count);
        assert_near(reading.force[0], weight, 2e-3 * weight);
        assert_near(reading.force[1], 0, 2e-3 * weight);
        assert_near(reading.force[2], 0, 2e-3 * weight);
        /* sweeps of pbd share a load unevenly */
        double uneven = cases[c].method == PEL_METHOD_PBD ? 2e-2 : 2e-3;
        assert_near(pel_vec3_length(reading.torque), 0, uneven * weight * width);
        end(&s, sim);
    }
}

/* a support pulls as a grasp does, with E h w times the strain, and the pins hold against it; the work of both goes
   into the strip */
static void test_pull(void **unused)
{
    (void)unused;
    for (int c = 0; c < CASE_COUNT; c++) {
        if (cases[c].method == PEL_METHOD_PBD)
            continue;
        double force[2], stretch = 0.02, lambda = 1 + stretch;
        double expected = young * thickness * width * lambda * 0.5 * (lambda * lambda - 1);
        for (int by_support = 0; by_support < 2; by_support++) {
            strip s;
            begin(&s, cases[c].method, cases[c].dt);
            s.def.solver.drag = cases[c].drag;
            s.def.solver.iterations = cases[c].iterations;
            s.def.solver.substeps = cases[c].method == PEL_METHOD_XPBD ? 60 : 0;
            pull(&s, by_support == 1, stretch * length);
            pel_sim *sim = create(&s, 0);
            run_steps(sim, cases[c].steps);
            pel_tool_reading reading;
            pel_support_reading support;
            pel_sim_ledger ledger;
            pel_sim_get_tool(sim, 0, &reading);
            pel_sim_get_support(sim, 0, &support);
            force[by_support] = reading.force[0];
            check_reactions(sim);
            assert_int_equal(reading.held_count, s.right_count);
            assert_near(reading.force[0], -expected, 0.01 * expected);
            double pins = by_support == 1 ? support.force[0] - reading.force[0] : support.force[0];
            assert_near(pins, expected, 0.01 * expected);
            pel_sim_get_ledger(sim, &ledger);
            if (cases[c].method == PEL_METHOD_DESCENT)
                assert_near(ledger.work_tools, ledger.elastic, 0.02 * ledger.elastic);
            end(&s, sim);
        }
        assert_near(force[0], force[1], 2e-3 * expected);
    }
}

/* vertices go exactly where the keys take their places at rest, about the center, and turn as written */
static void test_path(void **unused)
{
    (void)unused;
    const double pi = 3.14159265358979323846;
    for (int c = 0; c < CASE_COUNT; c++) {
        strip s;
        begin(&s, cases[c].method, cases[c].dt);
        pull(&s, true, 0.01);
        s.keys[1].rotation_vector[0] = pi / 2;
        s.keys[1].time = 20 * cases[c].dt;
        s.def.solver.iterations = cases[c].iterations;
        pel_sim *sim = create(&s, 0);
        double x[300];
        const double shares[] = {0.5, 1, 1};
        for (int part = 0; part < 3; part++) {
            run_steps(sim, 10);
            pel_sim_get_positions(sim, 0, x);
            double angle = shares[part] * pi / 2;
            for (int32_t i = 0; i < s.right_count; i++) {
                const double *rest = s.mesh->positions[s.right[i]], *now = x + 3 * s.right[i];
                double expected[3] = {rest[0] + 0.01 * shares[part], cos(angle) * rest[1], sin(angle) * rest[1]};
                assert_near(pel_vec3_distance(now, expected), 0, sizeof(pel_real) == 4 ? 1e-7 : 1e-14);
            }
        }
        end(&s, sim);
    }
}

/* readings and reactions go through snapshots */
static void test_resumes(void **unused)
{
    (void)unused;
    strip s;
    begin(&s, PEL_METHOD_XPBD, 0.01);
    pull(&s, true, 0.01);
    pel_sim *sim = create(&s, 9.81);
    run_steps(sim, 20);
    pel_support_reading before, after;
    pel_sim_get_support(sim, 0, &before);
    assert_true(fabs(before.force[0]) > 0.01);
    sim = resume_sim(sim, &s.def);
    pel_sim_get_support(sim, 0, &after);
    assert_memory_equal(&before, &after, sizeof before);
    check_reactions(sim);
    end(&s, sim);
}

/* a support of a strip that is fine everywhere, or where it is stretched, holds what lies between its vertices; it
   pulls with the closed form, and a run that resumes has the same bits */
static void test_refined(void **unused)
{
    (void)unused;
    const double stretch = 0.02, lambda = 1.05;
    double expected = young * thickness * width * lambda * 0.5 * (lambda * lambda - 1);
    for (int c = 0; c < CASE_COUNT; c++)
        for (int everywhere = 0; everywhere < 2; everywhere++) {
            strip s;
            if (cases[c].method == PEL_METHOD_PBD)
                continue;
            begin(&s, cases[c].method, cases[c].method == PEL_METHOD_EXPLICIT ? 2e-4 : cases[c].dt);
            s.def.solver.drag = cases[c].drag;
            s.def.solver.iterations = cases[c].iterations;
            s.body.refine.levels = everywhere ? 1 : 2;
            s.body.refine.everywhere = everywhere;
            s.body.refine.above = everywhere ? 0 : 0.02;
            s.body.refine.interval = 5;
            s.body.refine.rings = 2;
            pull(&s, true, stretch);
            pel_sim *sim = create(&s, 0);
            run_steps(sim, cases[c].steps / 2);
            sim = resume_sim(sim, &s.def);
            run_steps(sim, cases[c].steps / 2);
            pel_tool_reading tool;
            pel_support_reading reading;
            pel_sim_get_tool(sim, 0, &tool);
            pel_sim_get_support(sim, 0, &reading);
            check_reactions(sim);
            /* three vertices, and those between them; where the boundary is cut anew its corners are rounder */
            assert_true(pel_sim_vertex_count(sim, 0) > s.mesh->vertex_count);
            assert_int_equal(tool.held_count, everywhere ? 5 : 9);
            assert_near(tool.force[0], -expected, 2e-2 * expected);
            assert_near(reading.force[0], 0, 1e-2 * expected);
            int32_t count = pel_sim_vertex_count(sim, 0), on_path = 0;
            double *x = malloc(3 * (size_t)count * sizeof *x), *rest = malloc(3 * (size_t)count * sizeof *rest);
            pel_sim_get_positions(sim, 0, x);
            pel_sim_get_rest_positions(sim, 0, rest);
            for (size_t v = 0; v < 3 * (size_t)count; v += 3)
                on_path += fabs(x[v] - rest[v] - stretch) < 1e-6 && fabs(x[v + 1] - rest[v + 1]) < 1e-6;
            assert_int_equal(on_path, tool.held_count);
            free(x);
            free(rest);
            end(&s, sim);
        }
}

static void expect_refused(strip *s, const char *words)
{
    pel_sim *sim;
    pel_error error;
    assert_int_equal(pel_sim_create(&s->def, &sim, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, words));
}

static void test_refusals(void **unused)
{
    (void)unused;
    strip s;
    begin(&s, PEL_METHOD_XPBD, 0.01);
    pull(&s, true, 0.01);
    pel_sim *sim = create(&s, 0);
    s.tool.body = -1;
    expect_refused(&s, "no body");
    s.tool.body = 0;
    s.tool.vertex_count = 0;
    expect_refused(&s, "no vertices");
    s.tool.vertices = s.left;
    s.tool.vertex_count = s.left_count;
    expect_refused(&s, "pinned");
    const int32_t outside = s.mesh->vertex_count;
    s.tool.vertices = &outside;
    s.tool.vertex_count = 1;
    expect_refused(&s, "does not exist");
    s.tool.vertices = s.right;
    s.tool.center[1] = (double)NAN;
    expect_refused(&s, "not finite");
    end(&s, sim);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_weight),  cmocka_unit_test(test_pull),    cmocka_unit_test(test_path),
        cmocka_unit_test(test_resumes), cmocka_unit_test(test_refined), cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

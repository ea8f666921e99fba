/* Supports that follow a sequence: the path of their vertices, a moving frame, work, strength, times, snapshots. */
#include "failing_malloc.h"
#include "pellicle/sim_ledger.h"
#include "shell_fixture.h"
#include "stage/stage.h"

static const double thickness = 1e-3, width = 0.1, length = 0.4, zero[3];

enum { FRAMES = 9, MOST_VERTICES = 64 };

typedef struct strip {
    pel_mesh *mesh;
    pel_body_def body;
    pel_model *model;
    int32_t ends[MOST_VERTICES], end_count;
    double times[FRAMES], frames[FRAMES][MOST_VERTICES][3];
    pel_sequence *sequence;
    pel_pose_key key;
    pel_tool_def tool;
    pel_sim_def def;
} strip;

/* a strip along x whose left end follows */
static void begin(strip *s, pel_method method, double dt, int32_t nx)
{
    memset(s, 0, sizeof *s);
    s->mesh = make_grid(nx, 2, length, width, PEL_GRID_UNION_JACK);
    assert_true(s->mesh->vertex_count <= MOST_VERTICES);
    for (int32_t v = 0; v < s->mesh->vertex_count; v++)
        if (s->mesh->positions[v][0] < -0.499 * length)
            s->ends[s->end_count++] = v;
    s->body = shell_body(s->mesh, PEL_MEMBRANE_STVK);
    s->body.name = "strip";
    s->body.thickness.value = s->body.shell.membrane.thickness.value = thickness;
    s->def = lone_sim(NULL, method, dt);
    s->key = (pel_pose_key){.rotation = {0, 0, 0, 1}};
    s->tool = pel_tool_def_default();
    s->tool.name = "strip_follow";
    s->tool.shape = PEL_TOOL_SUPPORT;
    s->tool.body = 0;
    s->tool.press = false;
    s->tool.keys = &s->key;
    s->tool.key_count = 1;
    s->tool.vertices = s->ends;
    s->tool.vertex_count = s->end_count;
    s->def.tools = &s->tool;
    s->def.tool_count = 1;
}

typedef void motion(double time, const double rest[3], double x[3]);

static void follow(strip *s, double spacing, motion *move)
{
    static double flat[FRAMES * MOST_VERTICES][3];
    for (int f = 0; f < FRAMES; f++) {
        s->times[f] = spacing * f;
        for (int32_t v = 0; v < s->mesh->vertex_count; v++) {
            move(s->times[f], s->mesh->positions[v], s->frames[f][v]);
            pel_vec3_copy(s->frames[f][v], flat[f * s->mesh->vertex_count + v]);
        }
    }
    assert_int_equal(pel_sequence_create(flat[0], s->times, FRAMES, s->mesh->vertex_count, &s->sequence, NULL), PEL_OK);
    s->tool.sequence = s->sequence;
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
    pel_sequence_destroy(s->sequence);
    pel_mesh_destroy(s->mesh);
}

static const struct {
    pel_method method;
    double dt, drag;
    int iterations;
} cases[] = {
    {PEL_METHOD_EXPLICIT, 5e-4, 10, 0}, {PEL_METHOD_QUASI_STATIC, 0.01, 0, 0}, {PEL_METHOD_XPBD, 0.01, 10, 0},
    {PEL_METHOD_PBD, 0.01, 10, 20},     {PEL_METHOD_DESCENT, 0.1, 0, 3000},    {PEL_METHOD_IMPLICIT, 0.05, 10, 0},
    {PEL_METHOD_STATIC, 0.1, 0, 0},
};
enum { CASE_COUNT = sizeof cases / sizeof cases[0] };

static void begin_case(strip *s, int c)
{
    begin(s, cases[c].method, cases[c].dt, 8);
    s->def.solver.drag = cases[c].drag;
    s->def.solver.iterations = cases[c].iterations;
}

/* bends and stretches the end: no rigid motion */
static void wave(double time, const double rest[3], double x[3])
{
    pel_vec3_set(x, rest[0] + 0.02 * sin(9 * time), rest[1] * (1 + 0.5 * time), 0.3 * rest[1] * time + 0.01 * time);
}

static void expect_on_path(const strip *s, pel_sim *sim, double time)
{
    double x[MOST_VERTICES][3], wanted[MOST_VERTICES][3];
    pel_sequence_at(s->sequence, time, wanted[0]);
    pel_sim_get_positions(sim, 0, x[0]);
    for (int32_t i = 0; i < s->end_count; i++)
        assert_near(pel_vec3_distance(x[s->ends[i]], wanted[s->ends[i]]), 0, sizeof(pel_real) == 4 ? 1e-7 : 1e-14);
}

/* vertices are where the sequence has them at the end of each step, between its frames too, and stay at its end */
static void test_path(void **unused)
{
    (void)unused;
    for (int c = 0; c < CASE_COUNT; c++) {
        strip s;
        begin_case(&s, c);
        follow(&s, 2.3 * cases[c].dt, wave);
        pel_sim *sim = create(&s, 0);
        for (int step = 1; step <= 22; step++) {
            run_steps(sim, 1);
            expect_on_path(&s, sim, step * cases[c].dt);
        }
        pel_tool_reading reading;
        pel_sim_get_tool(sim, 0, &reading);
        assert_int_equal(reading.held_count, s.end_count);
        end(&s, sim);
    }
}

static void slide(double time, const double rest[3], double x[3])
{
    pel_vec3_set(x, rest[0] + 0.3 * time, rest[1] - 0.7 * time, rest[2]);
}

/* at a constant velocity the strip does what it does at rest, in the frame of the sequence: positions, force, and the
   energy that the sequence supplies */
static void test_moving_frame(void **unused)
{
    (void)unused;
    const int method[] = {0, 2, 5};
    /* implicit: its energy check sees another kinetic energy, and takes other schemes */
    const double places[] = {1e-12, 1e-12, 1e-5}, forces[] = {1e-9, 1e-9, 1e-3};
    for (int m = 0; m < 3; m++) {
        double x[2][MOST_VERTICES][3], force[2][3];
        for (int moves = 0; moves < 2; moves++) {
            strip s;
            begin_case(&s, method[m]);
            s.def.solver.drag = 0;
            follow(&s, 0.11, slide);
            if (moves == 0)
                s.tool.sequence = NULL;
            else
                slide(1, zero, s.body.velocity);
            pel_sim *sim = create(&s, 3);
            int steps = (int)(0.5 / cases[method[m]].dt + 0.5);
            run_steps(sim, steps);
            pel_sim_get_positions(sim, 0, x[moves][0]);
            pel_tool_reading reading;
            pel_sim_get_tool(sim, 0, &reading);
            pel_vec3_copy(reading.force, force[moves]);
            pel_sim_ledger ledger;
            pel_sim_get_ledger(sim, &ledger);
            double supplied = ledger.kinetic - ledger.kinetic_start + ledger.elastic - ledger.elastic_start;
            double largest = fabs(ledger.work_tools) + fabs(ledger.work_gravity);
            if (method[m] == 0)
                assert_near(ledger.work_tools + ledger.work_gravity, supplied, 0.01 * largest);
            end(&s, sim);
        }
        double way[3];
        slide(0.5, zero, way);
        strip s;
        begin_case(&s, method[m]);
        for (int32_t v = 0; v < s.mesh->vertex_count; v++)
            for (int k = 0; k < 3; k++)
                assert_near(x[1][v][k] - way[k], x[0][v][k], sizeof(pel_real) == 4 ? 1e-4 : places[m]);
        for (int k = 0; k < 3; k++)
            assert_near(force[1][k], force[0][k],
                        (sizeof(pel_real) == 4 ? 1e-2 : forces[m]) * pel_vec3_length(force[0]));
        pel_mesh_destroy(s.mesh);
    }
}

static void pull(double time, const double rest[3], double x[3])
{
    pel_vec3_set(x, rest[0] - 0.04 * time, rest[1], rest[2]);
}

/* the work is that of a support whose keys make the same motion */
static void test_work(void **unused)
{
    (void)unused;
    for (int c = 0; c < CASE_COUNT; c++) {
        double work[2], force[2];
        for (int by_keys = 0; by_keys < 2; by_keys++) {
            strip s;
            int32_t pins[MOST_VERTICES], pin_count = 0;
            begin_case(&s, c);
            for (int32_t v = 0; v < s.mesh->vertex_count; v++)
                if (s.mesh->positions[v][0] > 0.499 * length)
                    pins[pin_count++] = v;
            s.body.pinned = pins;
            s.body.pinned_count = pin_count;
            double spacing = 2.5 * cases[c].dt;
            follow(&s, spacing, pull);
            const pel_pose_key keys[2] = {
                s.key, {(FRAMES - 1) * spacing, {-0.04 * (FRAMES - 1) * spacing}, {0, 0, 0, 1}, {0}}};
            if (by_keys) {
                s.tool.sequence = NULL;
                s.tool.keys = keys;
                s.tool.key_count = 2;
            }
            pel_sim *sim = create(&s, 0);
            run_steps(sim, 20);
            pel_sim_ledger ledger;
            pel_tool_reading reading;
            pel_sim_get_ledger(sim, &ledger);
            pel_sim_get_tool(sim, 0, &reading);
            work[by_keys] = ledger.work_tools;
            force[by_keys] = reading.force[0];
            end(&s, sim);
        }
        assert_true(work[1] > 0);
        assert_near(work[0], work[1], (sizeof(pel_real) == 4 ? 1e-2 : 1e-6) * work[1]);
        assert_near(force[0], force[1], (sizeof(pel_real) == 4 ? 1e-2 : 1e-6) * fabs(force[1]));
    }
}

/* three vertices carry a weight of which no single one may carry half */
static void test_strength(void **unused)
{
    (void)unused;
    const double weight = 1000 * thickness * width * length * 9.81;
    for (int is_weak = 0; is_weak < 2; is_weak++) {
        strip s;
        begin(&s, PEL_METHOD_IMPLICIT, 0.01, 8);
        s.def.solver.drag = 10;
        s.tool.strength = (is_weak ? 0.2 : 2) * weight;
        pel_sim *sim = create(&s, 9.81);
        run_steps(sim, 100);
        pel_tool_reading reading;
        pel_sim_get_tool(sim, 0, &reading);
        assert_int_equal(reading.lost_count, is_weak ? s.end_count : 0);
        assert_int_equal(reading.held_count, is_weak ? 0 : s.end_count);
        if (is_weak)
            assert_near(reading.lost_limit, s.tool.strength, 1e-12 * weight);
        end(&s, sim);
    }
}

/* from a time on they follow with the distance that they had then, until they are released */
static void test_times(void **unused)
{
    (void)unused;
    strip s;
    begin(&s, PEL_METHOD_XPBD, 0.01, 8);
    follow(&s, 0.1, slide);
    s.tool.grasp_from = 0.2;
    s.tool.grasp_until = 0.4;
    pel_sim *sim = create(&s, 0);
    double x[MOST_VERTICES][3], v[MOST_VERTICES][3];
    const double *rest = s.mesh->positions[s.ends[0]];
    run_steps(sim, 20);
    pel_sim_get_positions(sim, 0, x[0]);
    assert_near(pel_vec3_distance(x[s.ends[0]], rest), 0, 1e-12);
    run_steps(sim, 10);
    pel_sim_get_positions(sim, 0, x[0]);
    assert_near(x[s.ends[0]][0] - rest[0], 0.03, 1e-3);
    assert_near(x[s.ends[0]][1] - rest[1], -0.07, 1e-3);
    run_steps(sim, 20);
    pel_tool_reading reading;
    pel_sim_get_tool(sim, 0, &reading);
    assert_int_equal(reading.held_count, 0);
    pel_sim_get_velocities(sim, 0, v[0]);
    double momentum = 0;
    for (int32_t i = 0; i < s.mesh->vertex_count; i++)
        momentum += v[i][1];
    assert_true(momentum < -0.1);
    end(&s, sim);
}

/* the same bits after a snapshot, in the middle between two frames */
static void test_resumes(void **unused)
{
    (void)unused;
    for (int c = 0; c < CASE_COUNT; c++) {
        double x[2][MOST_VERTICES][3], work[2];
        for (int resumes = 0; resumes < 2; resumes++) {
            strip s;
            begin_case(&s, c);
            follow(&s, 3.3 * cases[c].dt, wave);
            pel_sim *sim = create(&s, 1);
            run_steps(sim, 11);
            if (resumes)
                sim = resume_sim(sim, &s.def);
            run_steps(sim, 9);
            pel_sim_ledger ledger;
            pel_sim_get_positions(sim, 0, x[resumes][0]);
            pel_sim_get_ledger(sim, &ledger);
            work[resumes] = ledger.work_tools;
            end(&s, sim);
        }
        assert_memory_equal(x[0], x[1], 27 * sizeof x[0][0]);
        assert_true(work[0] == work[1]);
    }
}

static void expect_refused(strip *s, const char *words)
{
    pel_sim *sim;
    pel_error error;
    assert_int_equal(pel_sim_create(&s->def, &sim, &error), PEL_BAD_ARGUMENT);
    if (strstr(error.what, words) == NULL)
        fail_msg("expected '%s', got '%s'", words, error.what);
}

static void far_away(double time, const double rest[3], double x[3])
{
    pel_vec3_set(x, rest[0] + time, rest[1] + 1, rest[2]);
}

static void test_refusals(void **unused)
{
    (void)unused;
    strip s;
    begin(&s, PEL_METHOD_XPBD, 0.01, 8);
    follow(&s, 0.1, wave);
    pel_sim *sim = create(&s, 0);
    pel_sequence *own = s.sequence, *other;
    const int32_t rows[3] = {0, 1, 2};
    assert_int_equal(pel_sequence_map(own, rows, 3, NULL, 0, &other, NULL), PEL_OK);
    s.tool.sequence = other;
    expect_refused(&s, "3 vertices, the mesh of body 'strip' has 27");
    pel_sequence_destroy(other);
    s.tool.sequence = own;
    s.tool.strength = -1;
    expect_refused(&s, "strength");
    s.tool.strength = 0;
    s.tool.grasp_from = s.tool.grasp_until = 1;
    expect_refused(&s, "ends before it begins");
    end(&s, sim);
    begin(&s, PEL_METHOD_XPBD, 0.01, 8);
    follow(&s, 0.1, far_away);
    pel_model_def def = pel_model_def_default();
    def.bodies = &s.body;
    def.body_count = 1;
    assert_int_equal(pel_model_create(&def, &s.model, NULL), PEL_OK);
    s.def.model = s.model;
    expect_refused(&s, "1 m away from vertex");
    s.body.refine.levels = 1;
    s.body.refine.everywhere = true;
    pel_model_destroy(s.model);
    assert_int_equal(pel_model_create(&def, &s.model, NULL), PEL_OK);
    s.def.model = s.model;
    expect_refused(&s, "refines");
    end(&s, NULL);
}

/* the sequence may go before the simulation does */
static void test_owners(void **unused)
{
    (void)unused;
    strip s;
    begin(&s, PEL_METHOD_STATIC, 0.1, 8);
    follow(&s, 0.1, wave);
    pel_sim *sim = create(&s, 0);
    double wanted[MOST_VERTICES][3], x[MOST_VERTICES][3];
    pel_sequence_at(s.sequence, 0.3, wanted[0]);
    pel_sequence_destroy(s.sequence);
    s.sequence = NULL;
    run_steps(sim, 3);
    pel_sim_get_positions(sim, 0, x[0]);
    assert_near(pel_vec3_distance(x[s.ends[1]], wanted[s.ends[1]]), 0, 1e-7);
    end(&s, sim);
}

static void test_memory(void **unused)
{
    (void)unused;
    strip s;
    begin(&s, PEL_METHOD_STATIC, 0.1, 2);
    follow(&s, 0.1, wave);
    pel_sim *sim = create(&s, 0);
    for_every_allocation_failure(create_sim, &s.def);
    end(&s, sim);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_path),     cmocka_unit_test(test_moving_frame), cmocka_unit_test(test_work),
        cmocka_unit_test(test_strength), cmocka_unit_test(test_times),        cmocka_unit_test(test_resumes),
        cmocka_unit_test(test_refusals), cmocka_unit_test(test_owners),       cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* Runs beside a run: rows at its frames, ends, refusals. */
#include "check.h"

#include "failing_malloc.h"
#include "pellicle/run.h"
#include "pellicle/sim_surface.h"

static const char scene_text[] =
    "version: 1\n"
    "bodies: [{name: body, mesh: {shape: grid, nx: 3, ny: 2, size_x: 0.3, size_y: 0.2}, mass: {per_vertex: 0.002},\n"
    "  membrane: {young: 1.0e+4, thickness: 0.01}, pinned: {box: {min: [-1, -1, -1], max: [-0.149, 1, 1]}}}]\n"
    "loads: [{name: pull, force: [0.1, 0, 0], at: {nearest: [0.15, 0, 0]}}]\n"
    "gravity: [0, 0, 0]\nsolver: {method: static, dt: 0.1}\nduration: 0.2\noutput: {every: 0.1}\n";

enum { COUNT = 2, ROWS = 3, ROW_SIZE = 2000 };

typedef struct notes {
    pel_scene *scenes[COUNT + 1];
    char rows[COUNT + 1][ROWS + 1][ROW_SIZE];
    int row_count[COUNT + 1], ended[COUNT + 1];
    double x[COUNT + 1]; /* of the last vertex at the end */
} notes;

static void take_row(void *user, int32_t scene, const char *line)
{
    notes *n = user;
    assert_true(n->row_count[scene + 1] <= ROWS);
    snprintf(n->rows[scene + 1][n->row_count[scene + 1]++], ROW_SIZE, "%s", line);
}

static void take_line(void *user, const char *line)
{
    take_row(user, -1, line);
}

static void take_end(void *user, int32_t scene, pel_sim *sim)
{
    notes *n = user;
    double x[12][3];
    assert_int_equal(pel_sim_vertex_count(sim, 0), 12);
    pel_sim_get_positions(sim, 0, x[0]);
    n->x[scene + 1] = x[11][0];
    n->ended[scene + 1]++;
}

static void parse(notes *n)
{
    static const char *const overrides[] = {NULL, "bodies.body.membrane.young=9990",
                                            "bodies.body.membrane.young=10010"};
    pel_error error;
    *n = (notes){.row_count = {0}};
    for (int i = 0; i <= COUNT; i++)
        assert_int_equal(pel_scene_parse("test.yaml", scene_text, strlen(scene_text), &overrides[i], i > 0, NULL,
                                         &n->scenes[i], &error),
                         PEL_OK);
}

static void destroy(notes *n)
{
    for (int i = 0; i <= COUNT; i++)
        pel_scene_destroy(n->scenes[i]);
}

static pel_status run(notes *n, pel_run_def def, pel_error *error)
{
    const pel_run_beside beside = {
        .scenes = (const pel_scene *const *)&n->scenes[1], .count = COUNT, .row = take_row, .user = n};
    pel_run_summary summary;
    def.thread_count = 1;
    def.row = take_line;
    def.ended = take_end;
    def.user = n;
    def.beside = &beside;
    return pel_run(n->scenes[0], &def, &summary, error);
}

static void test_rows_and_ends(void **unused)
{
    (void)unused;
    static notes n;
    pel_error error;
    parse(&n);
    assert_int_equal(run(&n, pel_run_def_default(), &error), PEL_OK);
    /* the header is that of the run */
    assert_int_equal(n.row_count[0], ROWS + 1);
    for (int i = 0; i <= COUNT; i++) {
        assert_int_equal(n.ended[i], 1);
        for (int r = 0; r < ROWS; r++)
            assert_int_equal(atoi(n.rows[i][r + (i == 0)]), r);
    }
    for (int i = 1; i <= COUNT; i++)
        assert_int_equal(n.row_count[i], ROWS);
    /* the softer one goes farther, the other less far by nearly as much */
    double softer = n.x[1] - n.x[0], stiffer = n.x[2] - n.x[0];
    assert_true(softer > 1e-8);
    assert_near(softer + stiffer, 0, 0.01 * softer);
    assert_string_not_equal(n.rows[1][ROWS - 1], n.rows[2][ROWS - 1]);
    destroy(&n);
}

static void test_refused(void **unused)
{
    (void)unused;
    static notes n;
    pel_error error;
    parse(&n);
    pel_run_def def = pel_run_def_default();
    def.folder = "never-made";
    assert_int_equal(run(&n, def, &error), PEL_BAD_ARGUMENT);
    assert_int_equal(n.row_count[0] + n.ended[0], 0);
    destroy(&n);
}

static pel_status run_case(const void *data, pel_error *error)
{
    static notes n;
    memcpy(n.scenes, data, sizeof n.scenes);
    memset(n.row_count, 0, sizeof n.row_count);
    return run(&n, pel_run_def_default(), error);
}

static void test_memory(void **unused)
{
    (void)unused;
    static notes n;
    parse(&n);
    assert_true(for_every_allocation_failure(run_case, n.scenes) > 100);
    destroy(&n);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rows_and_ends),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

#include "check.h"
#include "failing_malloc.h"

#include "view/frame_selection.h"

enum { FRAMES = 11 };

typedef struct fixture {
    pel_frames frames[2];
    view_run runs[2];
    pel_render_def def;
    int32_t field_count;
} fixture;

static fixture make_fixture(const char *output, int32_t input_count)
{
    static double times[FRAMES];
    fixture f = {.frames = {{.frame_count = FRAMES, .times = times}, {.frame_count = 3, .times = times}}};
    f.field_count = 1;
    f.def = pel_render_def_default();
    f.def.output = output;
    f.def.input_count = input_count;
    return f;
}

static pel_status create(view_frame_selection *shots, fixture *f, pel_error *error)
{
    for (int r = 0; r < 2; ++r)
        f->runs[r] =
            (view_run){.path = r == 0 ? "soft" : "stiff", .has_times = true, .frames = &f->frames[r], .peak = 2 - r};
    return view_frame_selection_create(shots, &f->def, f->field_count, f->runs, error);
}

static void check_shots(fixture f, int32_t pages, int32_t columns, int32_t rows, const int32_t (*expected)[2])
{
    view_frame_selection shots;
    assert_int_equal(create(&shots, &f, NULL), PEL_OK);
    assert_int_equal(shots.page_count, pages);
    assert_int_equal(shots.columns, columns);
    assert_int_equal(shots.rows, rows);
    for (int i = 0; i < pages * columns * rows; ++i) {
        assert_int_equal(shots.shots[i].run, expected[i][0]);
        if (expected[i][0] >= 0)
            assert_int_equal(shots.shots[i].frame, expected[i][1]);
    }
    view_frame_selection_destroy(&shots);
}

/* a camera that turns shows a single frame from 72 sides; a film of several keeps its length */
static void test_turn(void **unused)
{
    (void)unused;
    const pel_frame_range last = {-1, -1, 1};
    fixture f = make_fixture("a.mp4", 1);
    view_frame_selection shots;
    f.def.turn = 360;
    assert_int_equal(create(&shots, &f, NULL), PEL_OK);
    assert_int_equal(shots.page_count, FRAMES);
    view_frame_selection_destroy(&shots);
    f.def.frames = &last;
    f.def.frame_range_count = 1;
    assert_int_equal(create(&shots, &f, NULL), PEL_OK);
    assert_int_equal(shots.page_count, 72);
    for (int32_t p = 0; p < shots.page_count; p++)
        assert_int_equal(shots.shots[p].frame, FRAMES - 1);
    view_frame_selection_destroy(&shots);
}

/* every run and field has a row of its own; with one frame of each all stand in one row */
static void test_fields(void **unused)
{
    (void)unused;
    const pel_frame_range early = {0, 1, 1};
    const view_shot rows[] = {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 1, 1}, {1, 0, 0}, {1, 1, 0}, {1, 0, 1}, {1, 1, 1}};
    fixture f = make_fixture("a.png", 2);
    view_frame_selection shots;
    f.field_count = 2;
    for (int several = 0; several < 2; several++) {
        f.def.frames = several ? &early : NULL;
        f.def.frame_range_count = several;
        assert_int_equal(create(&shots, &f, NULL), PEL_OK);
        assert_int_equal(shots.columns, several ? 2 : 4);
        assert_int_equal(shots.rows, several ? 4 : 1);
        for (int i = 0; i < shots.cell_count; i++) {
            const view_shot one = {i / 2, i / 2 == 0 ? 2 : 1, i % 2}, expected = several ? rows[i] : one;
            assert_memory_equal(&shots.shots[i], &expected, sizeof expected);
        }
        view_frame_selection_destroy(&shots);
    }
    f = make_fixture("a.gif", 1);
    f.field_count = 3;
    assert_int_equal(create(&shots, &f, NULL), PEL_OK);
    assert_int_equal(shots.page_count, FRAMES);
    assert_int_equal(shots.cell_count, 3);
    for (int i = 0; i < 3; i++)
        assert_int_equal(shots.shots[3 * 7 + i].field, i);
    view_frame_selection_destroy(&shots);
}

static void test_layouts(void **unused)
{
    (void)unused;
    const pel_frame_range steps[] = {{0, -1, 4}, {-2, -2, 1}}, early[] = {{0, 2, 2}};
    fixture f = make_fixture("a.png", 1);
    check_shots(f, 1, 1, 1, (const int32_t[][2]){{0, 2}});
    f = make_fixture("a.png", 2);
    check_shots(f, 1, 2, 1, (const int32_t[][2]){{0, 2}, {1, 1}});
    f.def.frames = early;
    f.def.frame_range_count = 1;
    check_shots(f, 1, 2, 2, (const int32_t[][2]){{0, 0}, {0, 2}, {1, 0}, {1, 2}});
    f.def.columns = 3;
    f.def.rows = 2;
    check_shots(f, 1, 3, 2, (const int32_t[][2]){{0, 0}, {0, 2}, {1, 0}, {1, 2}, {-1, 0}, {-1, 0}});
    /* a sheet without frames: as many of each run as fit */
    f = make_fixture("a.png", 2);
    f.def.columns = 3;
    f.def.rows = 2;
    check_shots(f, 1, 3, 2, (const int32_t[][2]){{0, 0}, {0, 5}, {0, 10}, {1, 0}, {1, 1}, {1, 2}});
    f.def.columns = 8;
    f.def.rows = 1;
    check_shots(f, 1, 8, 1, (const int32_t[][2]){{0, 0}, {0, 3}, {0, 7}, {0, 10}, {1, 0}, {1, 1}, {1, 2}, {-1, 0}});
    f.def.columns = f.def.rows = 1;
    f.def.input_count = 1;
    check_shots(f, 1, 1, 1, (const int32_t[][2]){{0, 2}});
    f = make_fixture("a.png", 1);
    f.def.frames = steps;
    f.def.frame_range_count = 2;
    check_shots(f, 1, 4, 1, (const int32_t[][2]){{0, 0}, {0, 4}, {0, 8}, {0, 9}});
    f = make_fixture("pictures", 1);
    f.def.frames = steps;
    f.def.frame_range_count = 1;
    check_shots(f, 3, 1, 1, (const int32_t[][2]){{0, 0}, {0, 4}, {0, 8}});
    /* the shorter run waits at its end */
    f = make_fixture("a.mp4", 2);
    view_frame_selection shots;
    assert_int_equal(create(&shots, &f, NULL), PEL_OK);
    assert_int_equal(shots.page_count, FRAMES);
    assert_int_equal(shots.shots[2 * 7 + 1].run, 1);
    assert_int_equal(shots.shots[2 * 7 + 1].frame, 2);
    view_frame_selection_destroy(&shots);
}

static void check_refused(pel_frame_range range, int32_t columns, const char *what)
{
    fixture f = make_fixture("a.png", 1);
    view_frame_selection shots;
    pel_error error;
    f.def.frames = &range;
    f.def.frame_range_count = 1;
    f.def.columns = f.def.rows = columns;
    assert_int_equal(create(&shots, &f, &error), PEL_BAD_ARGUMENT);
    assert_string_equal(error.what, what);
    assert_null(shots.shots);
}

static void test_refuses(void **unused)
{
    (void)unused;
    check_refused((pel_frame_range){11, 11, 1}, 0, "there is no frame 11");
    check_refused((pel_frame_range){0, 100, 1}, 0, "there is no frame 100");
    check_refused((pel_frame_range){-12, -1, 1}, 0, "there is no frame -12");
    check_refused((pel_frame_range){5, 4, 1}, 0, "there is no frame from 5 to 4 with steps of 1");
    check_refused((pel_frame_range){0, -1, 1}, 2, "11 pictures do not fit on the sheet");
}

static pel_status shots_case(const void *data, pel_error *error)
{
    fixture f = make_fixture(data, 2);
    view_frame_selection shots;
    pel_status status = create(&shots, &f, error);
    assert_true(status == PEL_OK || shots.shots == NULL);
    view_frame_selection_destroy(&shots);
    return status;
}

static void test_out_of_memory(void **unused)
{
    (void)unused;
    assert_int_equal(for_every_allocation_failure(shots_case, "a.png"), 4);
    assert_int_equal(for_every_allocation_failure(shots_case, "a.mp4"), 4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_layouts), cmocka_unit_test(test_turn),
                                       cmocka_unit_test(test_fields), cmocka_unit_test(test_refuses),
                                       cmocka_unit_test(test_out_of_memory)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

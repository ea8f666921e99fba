#include "check.h"

#include "base/memory.h"
#include "base/status.h"
#include "failing_malloc.h"

#include <math.h>

static const char *text_of(const pel_error *error)
{
    static char text[800];
    return pel_error_text(error, text, sizeof text);
}

static void test_every_status_has_a_text(void **unused)
{
    (void)unused;
    for (int status = 0; status < PEL_STATUS_COUNT; status++) {
        assert_string_not_equal(pel_status_text((pel_status)status), "unknown status");
        for (int other = 0; other < status; other++)
            assert_string_not_equal(pel_status_text((pel_status)status), pel_status_text((pel_status)other));
    }
    assert_string_equal(pel_status_text(PEL_STATUS_COUNT), "unknown status");
}

static void test_text_of_each_place(void **unused)
{
    (void)unused;
    pel_error error;
    assert_int_equal(pel_fail(&error, PEL_BAD_MESH, "%d is odd", 3), PEL_BAD_MESH);
    assert_string_equal(text_of(&error), "error: 3 is odd");
    pel_fail_remedy(&error, "use %d", 4);
    assert_string_equal(text_of(&error), "error: 3 is odd. use 4");
    pel_fail_element(&error, "vertex", 7);
    strcpy(error.element_name, "left");
    assert_string_equal(text_of(&error), "error: vertex 'left': 3 is odd. use 4");
    /* an element that the text begins with is not told twice */
    strcpy(error.what, "vertex 'left' is odd");
    assert_string_equal(text_of(&error), "error: vertex 'left' is odd. use 4");
    strcpy(error.what, "vertex 'lefty' is odd");
    assert_string_equal(text_of(&error), "error: vertex 'left': vertex 'lefty' is odd. use 4");
    strcpy(error.what, "3 is odd");
    error.element_name[0] = '\0';
    assert_string_equal(text_of(&error), "error: vertex 7: 3 is odd. use 4");
    pel_fail_place(&error, "a.obj", 12, 5);
    assert_string_equal(text_of(&error), "a.obj:12:5: error: vertex 7: 3 is odd. use 4");
    pel_fail_place(&error, "a.obj", 12, 0);
    assert_string_equal(text_of(&error), "a.obj:12: error: vertex 7: 3 is odd. use 4");
    pel_fail_offset(&error, "b.stl", 84);
    assert_string_equal(text_of(&error), "b.stl:byte 84: error: vertex 7: 3 is odd. use 4");
    /* the first of each */
    pel_fail_offset(&error, "b.stl", 0);
    pel_fail_element(&error, "vertex", 0);
    assert_string_equal(text_of(&error), "b.stl:byte 0: error: vertex 0: 3 is odd. use 4");
    pel_fail(&error, PEL_BAD_MESH, "%d is odd", 3);
    pel_fail_place(&error, "a.obj", 1, 1);
    assert_string_equal(text_of(&error), "a.obj:1:1: error: 3 is odd");
    /* without an error or a text there is nothing to say */
    assert_string_equal(text_of(NULL), "");
    assert_string_equal(pel_error_text(&error, NULL, 10), "");
    assert_string_equal(pel_error_text(NULL, NULL, 0), "");
}

/* The remedy is text: a % in it stands for itself. */
static void test_refuse(void **unused)
{
    (void)unused;
    pel_error error;
    pel_fail(&error, PEL_BAD_FILE, "first");
    pel_fail_place(&error, "a.obj", 1, 2);
    assert_int_equal(pel_refuse(&error, PEL_BAD_MESH, "give 5 %d at most", "%d is odd", 3), PEL_BAD_MESH);
    assert_int_equal(error.status, PEL_BAD_MESH);
    assert_string_equal(text_of(&error), "error: 3 is odd. give 5 %d at most");
    assert_int_equal(pel_refuse_element(&error, PEL_BAD_ARGUMENT, "load", 2, "give %s", "%s is odd", "it"),
                     PEL_BAD_ARGUMENT);
    assert_string_equal(text_of(&error), "error: load 2: it is odd. give %s");
}

static void test_new_failure_forgets_the_old(void **unused)
{
    (void)unused;
    pel_error error;
    pel_fail(&error, PEL_BAD_FILE, "first");
    pel_fail_place(&error, "a.obj", 1, 2);
    pel_fail_element(&error, "vertex", 0);
    assert_int_equal(pel_fail_memory(&error), PEL_OUT_OF_MEMORY);
    assert_int_equal(error.status, PEL_OUT_OF_MEMORY);
    assert_int_equal(error.element, -1);
    assert_int_equal(error.byte_offset, -1);
    assert_true(error.file[0] == '\0' && error.line == 0 && error.column == 0);
}

/* text is cut, never written past its end, and always terminated */
static void test_text_is_cut(void **unused)
{
    (void)unused;
    pel_error error;
    char whole[200], text[200];
    pel_fail(&error, PEL_BAD_FILE, "no such file");
    pel_fail_place(&error, "folder/a.obj", 3, 4);
    pel_fail_remedy(&error, "check the path");
    pel_error_text(&error, whole, sizeof whole);
    for (size_t size = 1; size <= strlen(whole) + 1; size++) {
        memset(text, '#', sizeof text);
        assert_ptr_equal(pel_error_text(&error, text, size), text);
        assert_int_equal(strlen(text), size - 1);
        assert_memory_equal(text, whole, size - 1);
        assert_int_equal(text[size], '#');
    }
    text[0] = '#';
    pel_error_text(&error, text, 0);
    assert_int_equal(text[0], '#');
}

static void test_long_values_are_cut(void **unused)
{
    (void)unused;
    char file[2000];
    memset(file, 'x', sizeof file - 1);
    file[sizeof file - 1] = '\0';
    pel_error error;
    pel_fail(&error, PEL_BAD_FILE, "%s", file);
    pel_fail_place(&error, file, 1, 1);
    pel_fail_remedy(&error, "%s", file);
    pel_fail_element(&error, file, 1);
    assert_int_equal(strlen(error.file), sizeof error.file - 1);
    assert_int_equal(strlen(error.what), sizeof error.what - 1);
    assert_int_equal(strlen(error.remedy), sizeof error.remedy - 1);
    assert_int_equal(strlen(error.element_kind), sizeof error.element_kind - 1);
}

static void test_null_error(void **unused)
{
    (void)unused;
    assert_int_equal(pel_fail(NULL, PEL_BAD_SCENE, "nobody reads this"), PEL_BAD_SCENE);
    assert_int_equal(pel_fail_memory(NULL), PEL_OUT_OF_MEMORY);
    assert_int_equal(pel_refuse(NULL, PEL_BAD_SCENE, "none", "nobody reads this"), PEL_BAD_SCENE);
    assert_int_equal(pel_refuse_element(NULL, PEL_BAD_FILE, "load", 1, "none", "nobody"), PEL_BAD_FILE);
    pel_fail_remedy(NULL, "none");
    pel_fail_element(NULL, "vertex", 1);
    pel_fail_place(NULL, "a.obj", 1, 1);
    pel_fail_offset(NULL, "a.obj", 1);
}

static void keep_line(void *user, const char *text)
{
    snprintf(user, 100, "%s", text);
}

static void test_log_line(void **unused)
{
    (void)unused;
    char kept[100] = "";
    const pel_log log = {keep_line, kept}, silent = {NULL, NULL};
    pel_log_line(&log, "welded %d vertices", 3);
    assert_string_equal(kept, "welded 3 vertices");
    pel_log_line(&silent, "lost");
    pel_log_line(NULL, "lost");
    assert_string_equal(kept, "welded 3 vertices");
}

/* a block that was refused is named where it is large, and its size says something */
static void test_memory_names_the_block(void **unused)
{
    (void)unused;
    static const struct {
        size_t bytes;
        const char *said;
    } cases[] = {{2500000, "out of memory: 0.0025 GB more were needed at once, of "},
                 {999999, "out of memory: "},
                 {SIZE_MAX, NULL}};
    pel_error error;
    char enough[100], all[64];
    snprintf(all, sizeof all, "%.3g GB", 1e-9 * pel_memory_limit());
    snprintf(enough, sizeof enough, "out of memory: %s are not enough", all);
    assert_true(pel_memory_limit() < (double)HUGE_VAL);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        failing_malloc_begin(1);
        assert_null(pel_allocate(1, cases[i].bytes));
        failing_malloc_end();
        assert_int_equal(pel_fail_memory(&error), PEL_OUT_OF_MEMORY);
        if (cases[i].said == NULL) {
            assert_string_equal(error.what, "out of memory");
            continue;
        }
        assert_memory_equal(error.what, cases[i].said, strlen(cases[i].said));
        assert_non_null(strstr(error.what, all));
        assert_int_equal(strcmp(error.what, enough) == 0, i == 1);
        /* told once */
        pel_fail_memory(&error);
        assert_string_equal(error.what, enough);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_status_has_a_text),
        cmocka_unit_test(test_text_of_each_place),
        cmocka_unit_test(test_refuse),
        cmocka_unit_test(test_new_failure_forgets_the_old),
        cmocka_unit_test(test_text_is_cut),
        cmocka_unit_test(test_long_values_are_cut),
        cmocka_unit_test(test_null_error),
        cmocka_unit_test(test_log_line),
        cmocka_unit_test(test_memory_names_the_block),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

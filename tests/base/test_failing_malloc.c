/* The allocation harness itself, on known numbers. */
#include "check.h"
#include "failing_malloc.h"

#include "base/memory.h"

static void test_harness_counts(void **unused)
{
    (void)unused;
    void *before = pel_allocate(3, 8);
    failing_malloc_begin(3);
    void *first = pel_allocate(3, 8), *second = pel_allocate_aligned(3, 8), *third = pel_allocate(3, 8);
    before = pel_reallocate(before, 4000, 8);
    first = pel_reallocate(first, 4000, 8);
    assert_non_null(second);
    assert_null(third);
    pel_free(second);
    allocation_count count = failing_malloc_end();
    assert_int_equal(count.calls, 5);
    assert_int_equal(count.failed, 1);
    assert_int_equal(count.live, 1);
    pel_free(before);
    pel_free(first);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_harness_counts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

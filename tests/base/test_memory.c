#include "check.h"
#include "failing_malloc.h"

#include "base/memory.h"
#include "base/patience.h"

static void test_blocks_are_zeroed(void **unused)
{
    (void)unused;
    for (size_t count = 0; count < 200; count += 7) {
        unsigned char *plain = pel_allocate(count, 3), *aligned = pel_allocate_aligned(count, 3);
        assert_non_null(plain);
        assert_non_null(aligned);
        assert_int_equal((uintptr_t)aligned % 64, 0);
        for (size_t i = 0; i < 3 * count; i++)
            assert_true(plain[i] == 0 && aligned[i] == 0);
        pel_free(plain);
        pel_free(aligned);
    }
    pel_free(NULL);
}

/* products and roundings that do not fit in size_t are refused before anything is asked of the heap */
static void test_overflow(void **unused)
{
    (void)unused;
    const size_t half = SIZE_MAX / 2 + 1;
    assert_null(pel_allocate(half, 2));
    assert_null(pel_allocate_aligned(half, 2));
    assert_null(pel_allocate_aligned(SIZE_MAX - 8, 1));
    assert_null(pel_reallocate(NULL, half, 2));
    void *array = NULL;
    size_t capacity = 0;
    assert_false(pel_reserve(&array, &capacity, SIZE_MAX, 1));
    assert_false(pel_reserve(&array, &capacity, half, 4));
    assert_null(array);
    assert_int_equal(capacity, 0);
}

/* what a thread did not get is told once, in bytes: messages of memory that is out name it */
static void test_refused(void **unused)
{
    (void)unused;
    pel_memory_refused();
    failing_malloc_begin(1);
    void *block = pel_allocate(3, 1000);
    failing_malloc_end();
    assert_null(block);
    assert_int_equal(pel_memory_refused(), 3000);
    assert_int_equal(pel_memory_refused(), 0);
    failing_malloc_begin(1);
    block = pel_allocate_aligned(100, 64);
    failing_malloc_end();
    assert_null(block);
    assert_int_equal(pel_memory_refused(), 6400);
    failing_malloc_begin(1);
    block = pel_reallocate(NULL, 7, 10);
    failing_malloc_end();
    assert_null(block);
    assert_int_equal(pel_memory_refused(), 70);
    block = pel_reallocate(NULL, 7, 10);
    assert_non_null(block);
    assert_int_equal(pel_memory_refused(), 0);
    pel_free(block);
}

/* what does not fit in size_t is told as all that there is, not as the block that was refused before */
static void test_overflow_is_refused(void **unused)
{
    (void)unused;
    const size_t half = SIZE_MAX / 2 + 1;
    void *array = NULL;
    size_t capacity = 0;
    pel_memory_refused();
    assert_null(pel_allocate(half, 2));
    assert_true(pel_memory_refused() == SIZE_MAX);
    assert_null(pel_allocate_aligned(half, 2));
    assert_true(pel_memory_refused() == SIZE_MAX);
    /* fits, but not its rounding to pages */
    assert_null(pel_allocate_aligned(SIZE_MAX - 8, 1));
    assert_true(pel_memory_refused() == SIZE_MAX - 8);
    assert_null(pel_reallocate(NULL, half, 2));
    assert_true(pel_memory_refused() == SIZE_MAX);
    assert_false(pel_reserve(&array, &capacity, SIZE_MAX, 1));
    assert_true(pel_memory_refused() == SIZE_MAX);
}

static bool is_over(void *unused)
{
    (void)unused;
    return false;
}

/* a thread that is to stop gets no block; that is no lack of memory */
static void test_impatience_is_not_refused(void **unused)
{
    (void)unused;
    pel_memory_refused();
    pel_patience_begin(is_over, NULL);
    assert_null(pel_allocate(3, 1000));
    assert_null(pel_allocate_aligned(3, 1000));
    assert_null(pel_reallocate(NULL, 3, 1000));
    assert_true(pel_patience_end());
    assert_int_equal(pel_memory_refused(), 0);
}

static void test_copy_string(void **unused)
{
    (void)unused;
    char *copy = pel_copy_string("liver"), *empty = pel_copy_string("");
    assert_string_equal(copy, "liver");
    assert_string_equal(empty, "");
    pel_free(copy);
    pel_free(empty);
    failing_malloc_begin(1);
    copy = pel_copy_string("liver");
    failing_malloc_end();
    assert_null(copy);
}

/* contents survive growth, the number of growths is logarithmic, a failure changes nothing */
static void test_reserve(void **unused)
{
    (void)unused;
    int *array = NULL;
    size_t capacity = 0;
    failing_malloc_begin(0);
    for (size_t i = 0; i < 100000; i++) {
        assert_true(pel_reserve((void **)&array, &capacity, i + 1, sizeof *array));
        array[i] = (int)i;
    }
    assert_true(failing_malloc_end().calls < 20);
    for (size_t i = 0; i < 100000; i++)
        assert_int_equal(array[i], i);
    const int *kept = array;
    const size_t kept_capacity = capacity;
    failing_malloc_begin(1);
    int grown = pel_reserve((void **)&array, &capacity, capacity + 1, sizeof *array);
    failing_malloc_end();
    assert_false(grown);
    assert_ptr_equal(array, kept);
    assert_int_equal(capacity, kept_capacity);
    pel_free(array);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_blocks_are_zeroed),
        cmocka_unit_test(test_overflow),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_overflow_is_refused),
        cmocka_unit_test(test_impatience_is_not_refused),
        cmocka_unit_test(test_copy_string),
        cmocka_unit_test(test_reserve),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

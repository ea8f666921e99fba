/* Arrays that are all there or none. */
#include "check.h"
#include "failing_malloc.h"

#include "base/room.h"

#include <stdint.h>

typedef struct thing {
    int32_t *numbers;
    double (*points)[3];
    void *bytes;
    char *extra;
    const float *more;
} thing;

static bool make(thing *own, size_t count, bool with_extra)
{
    return PEL_ALLOCATE_ALL(PEL_ROOM(own->numbers, count), PEL_ROOM_ALIGNED(own->points, 2 * count),
                            PEL_ROOM_OF(own->bytes, count, 7), PEL_ROOM_IF(with_extra, own->extra, count),
                            PEL_ROOM_ALIGNED_IF(with_extra, own->more, count));
}

static bool is_zero(const void *array, size_t bytes)
{
    for (size_t i = 0; i < bytes; i++)
        if (((const char *)array)[i] != 0)
            return false;
    return true;
}

static void test_all(void **unused)
{
    (void)unused;
    for (int with_extra = 0; with_extra < 2; with_extra++) {
        thing own;
        failing_malloc_begin(0);
        assert_true(make(&own, 5, with_extra != 0));
        assert_true(is_zero(own.numbers, 5 * sizeof *own.numbers) && is_zero(own.points, 10 * sizeof *own.points) &&
                    is_zero(own.bytes, 35));
        assert_int_equal((uintptr_t)own.points % 64, 0);
        assert_true((own.extra != NULL) == (with_extra != 0) && (own.more != NULL) == (with_extra != 0));
        PEL_FREE_ALL(own.numbers, own.points, own.bytes, own.extra, (void *)(uintptr_t)own.more);
        allocation_count count = failing_malloc_end();
        assert_int_equal(count.calls, 3 + 2 * with_extra);
        assert_int_equal(count.live, 0);
    }
}

/* whichever fails, nothing is left */
static void test_none(void **unused)
{
    (void)unused;
    for (long n = 1; n <= 5; n++) {
        thing own;
        failing_malloc_begin(n);
        assert_false(make(&own, 5, true));
        allocation_count count = failing_malloc_end();
        assert_int_equal(count.calls, n);
        assert_int_equal(count.live, 0);
        assert_true(own.numbers == NULL && own.points == NULL && own.bytes == NULL && own.extra == NULL &&
                    own.more == NULL);
    }
    /* more than any memory holds */
    thing own;
    assert_false(make(&own, SIZE_MAX / 4, false));
    assert_null(own.numbers);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_all), cmocka_unit_test(test_none)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* Sorting in place against qsort, of numbers and of records with their own order. */
#include "check.h"

#include "base/sort.h"

#include <stdbool.h>
#include <stdlib.h>

enum { LIMIT = 300 };

typedef struct record {
    int32_t key, number;
} record;

/* falling keys, equal ones by rising numbers */
static bool is_before(const record *a, const record *b)
{
    return a->key != b->key ? a->key > b->key : a->number < b->number;
}

PEL_DEFINE_SORT(sort_records, record, is_before)

static int compare_numbers(const void *a, const void *b)
{
    int32_t p = *(const int32_t *)a, q = *(const int32_t *)b;
    return (p > q) - (p < q);
}

static void test_numbers(void **unused)
{
    (void)unused;
    uint32_t random = 7;
    for (int32_t count = 0; count < LIMIT; count++) {
        int32_t values[LIMIT], expected[LIMIT];
        for (int32_t i = 0; i < count; i++) {
            random = 1664525u * random + 1013904223u;
            expected[i] = values[i] = (int32_t)(random >> 8) % (count % 2 ? 20 : 100000) - 10;
        }
        qsort(expected, (size_t)count, sizeof *expected, compare_numbers);
        pel_sort_int32(values, count);
        assert_memory_equal(values, expected, (size_t)count * sizeof *values);
    }
}

static void test_records(void **unused)
{
    (void)unused;
    record records[LIMIT];
    for (int32_t i = 0; i < LIMIT; i++)
        records[i] = (record){i * 37 % 11, (LIMIT - i) * 7};
    sort_records(records, LIMIT);
    for (int32_t i = 1; i < LIMIT; i++)
        assert_true(is_before(&records[i - 1], &records[i]));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_numbers),
        cmocka_unit_test(test_records),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

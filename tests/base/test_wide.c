/* Wide scalars and records against the same by lanes and components. */
#include "check.h"
#include "random.h"

#include "base/wide.h"

enum { ROUNDS_OF_LANES = 200 };

static void random_wide(random_state *random, pel_wide *a)
{
    for (int i = 0; i < PEL_WIDTH; i++)
        (*a)[i] = (pel_real)random_normal(random);
}

static void random_records(random_state *random, pel_record *records, int count)
{
    for (int v = 0; v < count; v++)
        for (int i = 0; i < 4; i++)
            records[v][i] = (pel_real)random_normal(random);
}

static bool is_same(pel_real a, pel_real b)
{
    return memcmp(&a, &b, sizeof a) == 0;
}

static void test_lanes(void **unused)
{
    (void)unused;
    random_state random = {1};
    for (int round = 0; round < ROUNDS_OF_LANES; round++) {
        pel_wide a, b, larger, root;
        random_wide(&random, &a);
        random_wide(&random, &b);
        int nan_lane = (int)random_integer(&random, 0, 2 * PEL_WIDTH);
        if (nan_lane < PEL_WIDTH)
            a[nan_lane] = (pel_real)NAN;
        larger = pel_wide_max(a, b);
        root = pel_wide_sqrt(b * b);
        pel_wide all = pel_wide_splat(b[0]);
        double sum = 0;
        for (int i = 0; i < PEL_WIDTH; i++) {
            assert_true(is_same(larger[i], a[i] > b[i] ? a[i] : b[i]));
            assert_true(is_same(root[i], b[i] < 0 ? -b[i] : b[i]));
            assert_true(is_same(all[i], b[0]));
            sum += (double)b[i];
        }
        assert_near(pel_wide_sum(b), sum, 0);
    }
}

/* also where all numbers are far below 0 */
static void test_largest(void **unused)
{
    (void)unused;
    const pel_real low = (pel_real)-1e30;
    for (int i = 0; i < PEL_WIDTH; i++) {
        pel_wide a = pel_wide_splat(2 * low);
        a[i] = low;
        assert_true(is_same(pel_wide_largest(a), low));
    }
}

static void test_masks(void **unused)
{
    (void)unused;
    pel_wide zero = pel_wide_splat(0);
    for (unsigned set = 0; set < 1u << PEL_WIDTH; set++) {
        pel_wide a;
        for (int i = 0; i < PEL_WIDTH; i++)
            a[i] = set >> i & 1 ? 1 : -1;
        assert_int_equal(pel_wide_all((pel_wide_mask)(a > zero)), set + 1 == 1u << PEL_WIDTH);
    }
}

static void test_records(void **unused)
{
    (void)unused;
    random_state random = {2};
    pel_record records[5];
    random_records(&random, records, 5);
    for (int v = 0; v < 5; v++) {
        pel_record taken = pel_record_get(records, v * PEL_STEP);
        assert_memory_equal(&taken, &records[v], sizeof taken);
        pel_record_set(records, v * PEL_STEP, -taken);
        for (int i = 0; i < 4; i++)
            assert_true(is_same(records[v][i], -taken[i]));
    }
    for (int round = 0; round < ROUNDS_OF_LANES; round++) {
        pel_record a, b;
        random_records(&random, &a, 1);
        random_records(&random, &b, 1);
        int nan_place = (int)random_integer(&random, 0, 7);
        if (nan_place < 4)
            a[nan_place] = (pel_real)NAN;
        pel_record larger = pel_record_max(a, b), smaller = pel_record_min(a, b);
        for (int i = 0; i < 4; i++) {
            assert_true(is_same(larger[i], a[i] > b[i] ? a[i] : b[i]));
            assert_true(is_same(smaller[i], a[i] < b[i] ? a[i] : b[i]));
        }
        assert_int_equal(pel_record_exceeds(a, b), a[0] > b[0] || a[1] > b[1] || a[2] > b[2]);
        /* the fourth number does not count, and equal ones are not above */
        pel_record fourth = b;
        fourth[3] += 1;
        assert_false(pel_record_exceeds(fourth, b));
        for (int i = 0; i < 3; i++) {
            pel_record above = b;
            above[i] += 1;
            assert_true(pel_record_exceeds(above, b));
        }
    }
}

static void check_columns(const pel_record *records, const int32_t *at, const pel_wide columns[4])
{
    for (int lane = 0; lane < PEL_WIDTH; lane++)
        for (int i = 0; i < 4; i++)
            assert_true(is_same(columns[i][lane], records[at[lane]][i]));
}

static void test_rows_and_columns(void **unused)
{
    (void)unused;
    enum { COUNT = 2 * PEL_WIDTH };
    random_state random = {3};
    pel_record records[COUNT], stored[COUNT];
    random_records(&random, records, COUNT);
    int32_t at[COUNT];
    pel_wide c[4];
    for (int32_t i = 0; i < COUNT; i++)
        at[i] = i;
    for (int begin = 0; begin < COUNT; begin += PEL_WIDTH) {
        pel_wide_load(records + begin, &c[0], &c[1], &c[2], &c[3]);
        check_columns(records, at + begin, c);
        pel_wide_store(stored + begin, c[0], c[1], c[2], c[3]);
    }
    assert_memory_equal(stored, records, sizeof records);
    for (int round = 0; round < ROUNDS_OF_LANES; round++) {
        for (int lane = 0; lane < PEL_WIDTH; lane++)
            at[lane] = (int32_t)random_integer(&random, 0, COUNT - 1);
        pel_wide_gather(records, at, &c[0], &c[1], &c[2], &c[3]);
        check_columns(records, at, c);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lanes),   cmocka_unit_test(test_largest),          cmocka_unit_test(test_masks),
        cmocka_unit_test(test_records), cmocka_unit_test(test_rows_and_columns),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

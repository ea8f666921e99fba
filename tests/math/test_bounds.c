#include "check.h"

#include "math/bounds.h"

static void test_points(void **unused)
{
    (void)unused;
    static const double points[3][3] = {{1, -2, 3}, {-4, 5, 3}, {0, 0, 0}};
    double low[3], high[3];
    pel_bounds_clear(low, high);
    assert_true(low[0] > high[0] && low[1] > high[1] && low[2] > high[2]);
    for (int i = 0; i < 3; i++)
        pel_bounds_add(low, high, points[i]);
    assert_true(low[0] == -4 && low[1] == -2 && low[2] == 0);
    assert_true(high[0] == 1 && high[1] == 5 && high[2] == 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_points),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

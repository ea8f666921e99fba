/* Numbers over a body and over time. */
#include "check.h"

#include "base/memory.h"
#include "model/quantity.h"

#include <math.h>

static const pel_key keys[3] = {{0, 1}, {1, 3}, {3, -1}};
static const double field[3] = {1, 2, -3};

static void test_values(void **unused)
{
    (void)unused;
    const pel_quantity number = {.value = 4}, keyed = {.value = 4, .keys = keys, .key_count = 3},
                       varied = {.value = 4, .field = field};
    assert_true(pel_quantity_at(&number, 2) == 4);
    assert_true(pel_quantity_at(&keyed, 2) == 1);
    assert_true(pel_quantity_at(&varied, 2) == -3);
}

static void test_curve(void **unused)
{
    (void)unused;
    static const double expected[][2] = {{-1, 1}, {0, 1}, {0.5, 2}, {1, 3}, {2, 1}, {3, -1}, {9, -1}};
    for (size_t i = 0; i < sizeof expected / sizeof expected[0]; i++)
        assert_near(pel_curve_value(keys, 3, expected[i][0]), expected[i][1], 1e-15);
    assert_true(pel_curve_value(NULL, 0, 5) == 1);
    const pel_quantity keyed = {.keys = keys, .key_count = 3}, number = {.value = 2};
    pel_curve curve = {0}, constant = {0};
    assert_int_equal(pel_curve_copy(&keyed, &curve, NULL), PEL_OK);
    assert_true(curve.keys != keys && memcmp(curve.keys, keys, sizeof keys) == 0 && curve.key_count == 3);
    assert_true(pel_curve_largest(&curve) == 3);
    assert_int_equal(pel_curve_copy(&number, &constant, NULL), PEL_OK);
    assert_true(constant.keys == NULL && pel_curve_largest(&constant) == 1);
    pel_free(curve.keys);
}

static void check(const pel_quantity *quantity, bool keys_allowed, bool is_signed, const char *what)
{
    pel_error error = {0};
    pel_status status = is_signed ? pel_quantity_check_signed(quantity, 3, 7, "pressure", keys_allowed, &error)
                                  : pel_quantity_check(quantity, 3, 7, "pressure", keys_allowed, &error);
    assert_int_equal(status, what == NULL ? PEL_OK : PEL_BAD_ARGUMENT);
    if (what == NULL)
        return;
    assert_string_equal(error.what, what);
    assert_string_equal(error.element_kind, "body");
    assert_int_equal(error.element, 7);
    assert_true(error.remedy[0] != '\0');
}

static void test_checks(void **unused)
{
    (void)unused;
    static const pel_key unordered[2] = {{1, 1}, {1, 2}}, infinite[1] = {{0, HUGE_VAL}};
    const pel_quantity keyed = {.keys = keys, .key_count = 3}, varied = {.field = field},
                       both = {.field = field, .keys = keys, .key_count = 3}, below = {.value = -2},
                       nan = {.value = (double)NAN}, mixed = {.keys = unordered, .key_count = 2},
                       far = {.keys = infinite, .key_count = 1};
    check(&keyed, true, true, NULL);
    check(&varied, false, true, NULL);
    check(&below, false, true, NULL);
    check(&keyed, false, true, "pressure is 0");
    check(&keyed, true, false, "pressure is -1");
    check(&varied, true, false, "pressure is -3");
    check(&both, true, true, "pressure is 0");
    check(&below, true, false, "pressure is -2");
    check(&nan, true, true, "pressure is nan");
    check(&mixed, true, true, "pressure is 1");
    check(&far, true, true, "pressure is inf");
}

/* keys with a fault at any place of a list of any length */
static void test_order(void **unused)
{
    (void)unused;
    enum { MOST = 5 };
    const double odd[] = {(double)NAN, HUGE_VAL, -HUGE_VAL};
    for (int32_t count = 0; count <= MOST; count++) {
        pel_key good[MOST];
        for (int32_t k = 0; k < MOST; k++)
            good[k] = (pel_key){k - 2.5, k % 3 - 1};
        assert_true(pel_keys_are_ordered(good, count));
        for (int32_t k = 0; k < MOST; k++) {
            for (size_t i = 0; i < sizeof odd / sizeof *odd; i++) {
                pel_key bad[MOST];
                memcpy(bad, good, sizeof bad);
                bad[k].value = odd[i];
                assert_true(pel_keys_are_ordered(bad, count) == (k >= count));
                bad[k] = (pel_key){odd[i], 0};
                assert_true(pel_keys_are_ordered(bad, count) == (k >= count));
            }
            pel_key bad[MOST];
            memcpy(bad, good, sizeof bad);
            bad[k].time = good[k > 0 ? k - 1 : 0].time;
            assert_true(pel_keys_are_ordered(bad, count) == (k == 0 || k >= count));
            bad[k].time = nextafter(bad[k].time, HUGE_VAL);
            assert_true(pel_keys_are_ordered(bad, count));
        }
    }
}

/* means over spans against sums over many instants */
static void test_means(void **unused)
{
    (void)unused;
    static const pel_key curve[4] = {{0.1, 1}, {0.3, -2}, {0.35, 4}, {0.9, 0.5}};
    enum { INSTANTS = 200000 };
    const double acts[3][2] = {{-HUGE_VAL, HUGE_VAL}, {0.15, 0.6}, {0.3, 0.32}};
    for (int c = 0; c < 3; c++)
        for (int s = 0; s < 4; s++) {
            const pel_span span = {.time = 0.05 + 0.3 * s, .back = 0.05 * s, .ahead = 0.1 + 0.2 * (s % 2)};
            double from = span.time - span.back, length = span.back + span.ahead, sum = 0;
            for (int i = 0; i < INSTANTS; i++) {
                double time = from + (i + 0.5) * length / INSTANTS;
                sum += time >= acts[c][0] && time < acts[c][1] ? pel_curve_value(curve, 4, time) : 0;
            }
            assert_near(pel_curve_mean(curve, 4, span, acts[c][0], acts[c][1]), sum / INSTANTS, 1e-4);
        }
    /* at an instant; without keys; ends that differ by rounding; what a linear curve leads to */
    assert_near(pel_curve_mean(curve, 4, pel_instant(0.2), 0, 1), -0.5, 1e-15);
    assert_near(pel_curve_mean(curve, 4, pel_instant(0.2), 0.25, 1), 0, 0);
    const pel_span step = {.time = 0.3, .back = 0.1};
    assert_near(pel_curve_mean(NULL, 0, step, -HUGE_VAL, HUGE_VAL), 1, 0);
    assert_near(pel_curve_mean(NULL, 0, step, -HUGE_VAL, 0.25), 0.5, 1e-12);
    assert_near(pel_curve_mean(NULL, 0, step, -HUGE_VAL, 0.2 + 1e-16), 0, 0);
    const pel_span end = {.time = 0.3, .back = 0.1, .extrapolates = true};
    assert_near(pel_curve_mean(curve, 2, end, -HUGE_VAL, HUGE_VAL), -2, 1e-12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_values), cmocka_unit_test(test_curve), cmocka_unit_test(test_order),
        cmocka_unit_test(test_checks), cmocka_unit_test(test_means),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* The pressure of each kind is the negative slope of its potential, which is zero at the rest volume. */
#include "check.h"

#include "force/pressure.h"
#include "shell_fixture.h"

static const double rest_volume = 2.5;

static void check(const pel_shell *shell, double time, double low, double high)
{
    assert_near(pel_pressure_potential(shell, pel_instant(time), 1, rest_volume, rest_volume), 0, 1e-12);
    for (double ratio = low; ratio < high; ratio *= 1.3) {
        double volume = ratio * rest_volume, h = 1e-5 * volume, potentials[2];
        for (int side = 0; side < 2; side++)
            potentials[side] =
                pel_pressure_potential(shell, pel_instant(time), 1, volume + (side ? h : -h), rest_volume);
        double difference = pel_pressure_difference(shell, pel_instant(time), 1, volume, rest_volume);
        double slope = (potentials[1] - potentials[0]) / (2 * h), scale = fabs(potentials[0]) / volume;
        assert_near(-slope, difference, 1e-7 * (fabs(difference) + scale) + 1e-9);
    }
}

static void test_potentials(void **unused)
{
    (void)unused;
    pel_key keys[2] = {{0, 1}, {1, 3}};
    pel_shell given = {.pressure = {.kind = PEL_PRESSURE_GIVEN, .outside = {.value = 7}},
                       .outside = {.keys = keys, .key_count = 2}};
    check(&given, 0.5, 0.1, 3);
    assert_near(pel_pressure_difference(&given, pel_instant(0.5), 1, 1, rest_volume), -14, 1e-12);
    pel_shell target = {.pressure = {.kind = PEL_PRESSURE_VOLUME, .bulk = 40, .target = {.value = 0.6}}};
    check(&target, 0, 0.1, 3);
    assert_near(pel_pressure_difference(&target, pel_instant(0), 1, 0.6 * rest_volume, rest_volume), 0, 1e-12);
    assert_true(pel_pressure_difference(&target, pel_instant(0), 1, 0.5 * rest_volume, rest_volume) > 0);
    /* a target that grows: 1.2 of the volume at rest by then */
    pel_shell keyed = {.pressure = target.pressure, .target = {.keys = keys, .key_count = 2}};
    check(&keyed, 0.5, 0.1, 3);
    assert_near(pel_pressure_difference(&keyed, pel_instant(0.5), 1, 1.2 * rest_volume, rest_volume), 0, 1e-12);
    assert_near(pel_pressure_difference(&keyed, pel_instant(0.5), 1, rest_volume, rest_volume), 40 * 0.2, 1e-12);
    /* isothermal, and down to where a gas is not squeezed any more */
    const double gammas[3] = {1, 1.4, 2};
    for (int i = 0; i < 3; i++) {
        pel_shell gas = {.pressure = {.kind = PEL_PRESSURE_GAS, .value = 3, .gamma = gammas[i]}};
        check(&gas, 0, 1e-2, 4);
        check(&gas, 0, 1.1e-3, 1e-2);
        check(&gas, 0, 1e-5, 0.9e-3);
        assert_near(pel_pressure_difference(&gas, pel_instant(0), 1, -rest_volume, rest_volume),
                    pel_pressure_difference(&gas, pel_instant(0), 1, 1e-3 * rest_volume, rest_volume), 0);
    }
    /* an outside pressure adds to any inside pressure */
    for (int i = 0; i < 2; i++) {
        pel_shell alone = {.pressure = {.kind = i == 0 ? PEL_PRESSURE_GAS : PEL_PRESSURE_VOLUME,
                                        .value = 3,
                                        .gamma = 1.4,
                                        .bulk = 40,
                                        .target = {.value = 0.9}}},
                  both = alone;
        both.pressure.outside.value = 5;
        both.outside = (pel_curve){keys, 2};
        assert_near(pel_pressure_difference(&both, pel_instant(0.5), 0.1, 1.7, rest_volume),
                    pel_pressure_difference(&alone, pel_instant(0.5), 0.1, 1.7, rest_volume) - 0.1 * 10, 1e-12);
        check(&both, 0.5, 0.1, 3);
    }
    pel_shell none = {.pressure = {.kind = PEL_PRESSURE_NONE}};
    check(&none, 0, 0.5, 2);
}

static void test_conservative(void **unused)
{
    (void)unused;
    double weight = 1;
    pel_shell shell = {.pressure = {.kind = PEL_PRESSURE_GIVEN, .form = PEL_PRESSURE_CONSISTENT}};
    pel_body body = {.closed = true, .shell = &shell};
    assert_true(pel_pressure_is_conservative(&body));
    body.closed = false;
    assert_false(pel_pressure_is_conservative(&body));
    body.closed = true;
    shell.pressure_weights = &weight;
    assert_false(pel_pressure_is_conservative(&body));
    shell.pressure_weights = NULL;
    shell.pressure.form = PEL_PRESSURE_VERTEX_NORMAL;
    assert_false(pel_pressure_is_conservative(&body));
    shell.pressure.kind = PEL_PRESSURE_NONE;
    assert_true(pel_pressure_is_conservative(&body));
}

/* ---- the largest pressure ---- */

static double pressure_of(pel_membrane_kind kind, double thickness, bool is_open, bool is_peak, double *ratio)
{
    pel_mesh *mesh = is_open ? make_grid(2, 2, 1, 1, PEL_GRID_ONE_DIAGONAL) : make_sphere(6);
    pel_body_def body = shell_body(mesh, kind);
    body.shell.membrane.young.value = 3e5;
    body.shell.membrane.poisson = kind == PEL_MEMBRANE_STVK ? 0.3 : 0.5;
    body.shell.membrane.thickness.value = thickness;
    body.shell.membrane.mooney_ratio = 0.1;
    pel_model *model = make_model(&body);
    double largest = (is_peak ? pel_pressure_peak : pel_pressure_largest)(model, 0, ratio);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
    return largest;
}

static double largest_of(pel_membrane_kind kind, double thickness, bool is_open, double *ratio)
{
    return pressure_of(kind, thickness, is_open, false, ratio);
}

static void test_largest(void **unused)
{
    (void)unused;
    double ratio;
    /* p = 2 mu h / R (1 / l - 1 / l^7): the largest at l = 7^(1/6); a polyhedron has more area for its volume */
    double stretch = pow(7, 1.0 / 6), exact = 2e5 * 0.01 * (1 / stretch - pow(stretch, -7));
    double found = largest_of(PEL_MEMBRANE_NEO_HOOKEAN, 0.01, false, &ratio);
    assert_near(found / exact, 1, 0.02);
    assert_near(ratio, sqrt(7), 1e-5);
    assert_near(largest_of(PEL_MEMBRANE_NEO_HOOKEAN, 0.02, false, &ratio), 2 * found, 1e-12 * found);
    /* these rise without end, and an open surface holds no pressure */
    assert_true(largest_of(PEL_MEMBRANE_STVK, 0.01, false, &ratio) == HUGE_VAL);
    assert_true(largest_of(PEL_MEMBRANE_GENT, 0.01, false, &ratio) == HUGE_VAL ||
                largest_of(PEL_MEMBRANE_GENT, 0.01, false, &ratio) > found);
    assert_true(largest_of(PEL_MEMBRANE_NEO_HOOKEAN, 0.01, true, &ratio) == HUGE_VAL);
    const pel_key keys[3] = {{0, 0}, {1, 3}, {2, 1}};
    const pel_shell keyed = {.pressure = {.kind = PEL_PRESSURE_GIVEN, .outside = {.value = -7}},
                             .outside = {.keys = (pel_key *)keys, .key_count = 3}};
    const pel_shell pressed = {.pressure = {.kind = PEL_PRESSURE_GIVEN, .outside = {.value = 7}}};
    assert_true(pel_pressure_given(&keyed) == 21 && pel_pressure_given(&pressed) == 0);
}

/* of rubber with two terms the pressure has a maximum, falls, and rises without end */
static void test_peak(void **unused)
{
    (void)unused;
    double ratio, best = 0, at = 1;
    assert_true(largest_of(PEL_MEMBRANE_MOONEY_RIVLIN, 0.01, false, &ratio) == HUGE_VAL);
    for (double l = 1; l < 2; l += 1e-5) {
        double pressure = 4 * 0.01 * (1 / l - pow(l, -7)) * (0.5e5 / 1.1) * (1 + 0.1 * l * l);
        at = pressure > best ? l : at;
        best = pressure > best ? pressure : best;
    }
    double peak = pressure_of(PEL_MEMBRANE_MOONEY_RIVLIN, 0.01, false, true, &ratio);
    assert_near(peak / best, 1, 0.02);
    assert_near(ratio, at * at * at, 1e-3);
    /* the largest of all is the first where it falls for ever, and none where it never falls */
    double same = pressure_of(PEL_MEMBRANE_NEO_HOOKEAN, 0.01, false, true, &ratio);
    assert_true(same == largest_of(PEL_MEMBRANE_NEO_HOOKEAN, 0.01, false, &ratio));
    assert_true(pressure_of(PEL_MEMBRANE_STVK, 0.01, false, true, &ratio) == HUGE_VAL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_potentials),
        cmocka_unit_test(test_conservative),
        cmocka_unit_test(test_largest),
        cmocka_unit_test(test_peak),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* The functions of the lanes against the C library. */
#include "check.h"
#include "random.h"

#include "base/lane.h"

enum { SAMPLES = 20000 };

/* largest error of a function of two numbers over the lanes, relative to 1 */
typedef pel_lane lane_function(pel_lane a, pel_lane b);

static double error_of(lane_function *function, double (*exact)(double, double), const double *a, const double *b)
{
    pel_lane x = pel_lane_splat(0), y = pel_lane_splat(0);
    for (int i = 0; i < PEL_BLOCK; i++) {
        x[i] = (pel_real)a[i];
        y[i] = (pel_real)b[i];
    }
    pel_lane result = function(x, y);
    double worst = 0;
    for (int i = 0; i < PEL_BLOCK; i++) {
        double expected = exact((double)x[i], (double)y[i]);
        worst = fmax(worst, fabs((double)result[i] - expected) / fmax(1e-30, fabs(expected)));
    }
    return worst;
}

static void test_atan2(void **unused)
{
    (void)unused;
    random_state random = {1};
    double worst = 0, a[PEL_BLOCK], b[PEL_BLOCK];
    for (int n = 0; n < SAMPLES; n++) {
        for (int i = 0; i < PEL_BLOCK; i++) {
            double scale = pow(10, random_between(&random, -8, 8));
            a[i] = scale * random_normal(&random);
            b[i] = scale * random_normal(&random) * pow(10, random_between(&random, -3, 3));
        }
        worst = fmax(worst, error_of(pel_lane_atan2, atan2, a, b));
    }
    assert_true(worst < 4 * (double)PEL_REAL_EPSILON);
    const double half_turn = 3.141592653589793238;
    const double special[6][3] = {{0, 1, 0}, {0, -1, half_turn},         {1, 0, half_turn / 2}, {-1, 0, -half_turn / 2},
                                  {0, 0, 0}, {-1, -1, -0.75 * half_turn}};
    for (int i = 0; i < 6; i++) {
        pel_lane angle =
            pel_lane_atan2(pel_lane_splat((pel_real)special[i][0]), pel_lane_splat((pel_real)special[i][1]));
        assert_near((double)angle[0], special[i][2], 1e-6);
    }
}

static pel_lane log1p_of_first(pel_lane a, pel_lane b)
{
    (void)b;
    return pel_lane_log1p(a);
}

static double exact_log1p(double a, double b)
{
    (void)b;
    return log1p(a);
}

static void test_log1p(void **unused)
{
    (void)unused;
    random_state random = {2};
    double worst = 0, a[PEL_BLOCK], b[PEL_BLOCK] = {0};
    for (int n = 0; n < SAMPLES; n++) {
        for (int i = 0; i < PEL_BLOCK; i++) {
            double size = pow(10, random_between(&random, -12, 6));
            a[i] = n % 2 == 0 ? size : -size / (1 + size);
        }
        worst = fmax(worst, error_of(log1p_of_first, exact_log1p, a, b));
    }
    /* 1 + x is rounded where x is not small: relative to the result that counts most just outside of [-0.29, 0.41] */
    assert_true(worst < 8 * (double)PEL_REAL_EPSILON);
}

static pel_lane expm1_of_first(pel_lane a, pel_lane b)
{
    (void)b;
    return pel_lane_expm1(a);
}

static double exact_expm1(double a, double b)
{
    (void)b;
    return expm1(a);
}

static void test_expm1(void **unused)
{
    (void)unused;
    random_state random = {3};
    double worst = 0, a[PEL_BLOCK], b[PEL_BLOCK] = {0};
    for (int n = 0; n < SAMPLES; n++) {
        for (int i = 0; i < PEL_BLOCK; i++)
            a[i] = n % 2 == 0 ? random_between(&random, -80, 80)
                              : pow(10, random_between(&random, -12, 1)) * (i % 2 ? 1 : -1);
        worst = fmax(worst, error_of(expm1_of_first, exact_expm1, a, b));
    }
    assert_true(worst < 4 * (double)PEL_REAL_EPSILON);
}

/* the angle of a fold that is flat to rounding: small values keep all their digits, and none of their powers is
   denormal */
static void test_small_angles(void **unused)
{
    (void)unused;
    for (double size = 1; size > (sizeof(pel_real) == 8 ? 1e-300 : 1e-37); size *= 0.7) {
        pel_lane angle = pel_lane_atan2(pel_lane_splat((pel_real)size), pel_lane_splat(1));
        double expected = atan2((double)(pel_real)size, 1);
        assert_near((double)angle[0] / expected, 1, 4 * (double)PEL_REAL_EPSILON);
    }
}

static void test_particles_round_trip(void **unused)
{
    (void)unused;
    pel_record records[2 * PEL_BLOCK];
    int32_t places[PEL_BLOCK], steps[PEL_BLOCK];
    for (int i = 0; i < 2 * PEL_BLOCK; i++)
        records[i] =
            (pel_record){(pel_real)(4 * i), (pel_real)(4 * i + 1), (pel_real)(4 * i + 2), (pel_real)(4 * i + 3)};
    for (int i = 0; i < PEL_BLOCK; i++)
        steps[i] = PEL_STEP * (places[i] = (5 * i + 3) % (2 * PEL_BLOCK));
    pel_particle p = pel_particle_load(records, steps, 0);
    for (int i = 0; i < PEL_BLOCK; i++) {
        assert_near((double)p.at.x[i], 4 * places[i], 0);
        assert_near((double)p.at.y[i], 4 * places[i] + 1, 0);
        assert_near((double)p.at.z[i], 4 * places[i] + 2, 0);
        assert_near((double)p.fourth[i], 4 * places[i] + 3, 0);
    }
    const pel_lane3 way = {pel_lane_splat((pel_real)0.5), pel_lane_splat(0), pel_lane_splat(-1)};
    places[1] = places[0]; /* repeated as in a block that is not full: it moves once */
    steps[1] = steps[0];
    p = pel_particle_load(records, steps, 0);
    for (int turn = 1; turn <= 2; turn++) {
        pel_particle_move(records, steps, 0, turn == 1 ? &p : NULL, way);
        for (int i = 0; i < PEL_BLOCK; i++)
            for (int c = 0; c < 4; c++)
                assert_near((double)records[places[i]][c],
                            4 * places[i] + c +
                                turn * (c == 0   ? 0.5
                                        : c == 2 ? -1
                                                 : 0),
                            0);
    }
}

/* three components of each lane as records side by side */
static void test_store(void **unused)
{
    (void)unused;
    pel_record records[PEL_BLOCK + 1];
    pel_lane3 a = {pel_lane_splat(0), pel_lane_splat(0), pel_lane_splat(0)};
    for (int i = 0; i < PEL_BLOCK; i++) {
        a.x[i] = (pel_real)(3 * i);
        a.y[i] = (pel_real)(3 * i + 1);
        a.z[i] = (pel_real)(3 * i + 2);
    }
    records[PEL_BLOCK] = (pel_record){7, 7, 7, 7};
    pel_lane3_store(records, a);
    for (int i = 0; i < PEL_BLOCK; i++)
        for (int c = 0; c < 4; c++)
            assert_near((double)records[i][c], c < 3 ? 3 * i + c : 0, 0);
    assert_near((double)records[PEL_BLOCK][0], 7, 0);
}

static void test_quotient(void **unused)
{
    (void)unused;
    static const double cases[4][3] = {{3, 2, 1.5}, {3, 0, 0}, {0, 0, 0}, {3, -2, 0}};
    for (int i = 0; i < 4; i++) {
        pel_lane quotient =
            pel_lane_quotient(pel_lane_splat((pel_real)cases[i][0]), pel_lane_splat((pel_real)cases[i][1]));
        assert_near((double)quotient[PEL_BLOCK - 1], cases[i][2], 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_atan2),
        cmocka_unit_test(test_log1p),
        cmocka_unit_test(test_expm1),
        cmocka_unit_test(test_small_angles),
        cmocka_unit_test(test_particles_round_trip),
        cmocka_unit_test(test_store),
        cmocka_unit_test(test_quotient),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

#include "check.h"
#include "collide/ends.h"
#include "math/vec3.h"
#include "random.h"

enum { POINTS = 60, PAIRS = 257 };

/* m, the most that points of both edges come nearer to each other */
static double approach_of(double (*start)[3], double (*end)[3], const int32_t v[4])
{
    double most = 0;
    for (int i = 0; i < 2; i++)
        for (int j = 2; j < 4; j++) {
            double apart[3];
            for (int k = 0; k < 3; k++)
                apart[k] = (end[v[i]][k] - start[v[i]][k]) - (end[v[j]][k] - start[v[j]][k]);
            most = fmax(most, pel_vec3_length(apart));
        }
    return most;
}

/* whether the ends keep two edges apart, from the angle and the shares of the lines where they are nearest */
static bool is_kept(double (*x)[3], const int32_t v[4], double room)
{
    double u[3], w[3], way[3], cross[3];
    pel_vec3_subtract(x[v[1]], x[v[0]], u);
    pel_vec3_subtract(x[v[3]], x[v[2]], w);
    pel_vec3_subtract(x[v[2]], x[v[0]], way);
    pel_vec3_cross(u, w, cross);
    double sine = pel_vec3_length(cross), size = pel_vec3_length(u) * pel_vec3_length(w), a[3], b[3];
    if (sine < 0.01 * size)
        return true;
    pel_vec3_cross(way, w, a);
    pel_vec3_cross(way, u, b);
    double s = pel_vec3_dot(a, cross) / (sine * sine), t = pel_vec3_dot(b, cross) / (sine * sine);
    bool is_inside = s > 1e-3 && s < 1 - 1e-3 && t > 1e-3 && t < 1 - 1e-3;
    return !is_inside && fabs(pel_vec3_dot(way, cross)) >= room * sine;
}

/* Random edges of a few lengths, some parallel, some of which slide: against one pair at a time, by its definition. */
static void test_against_single(void **unused)
{
    (void)unused;
    random_state random = {7};
    int32_t kept = 0, left = 0, slid = 0;
    for (int round = 0; round < 40; round++) {
        static double start[POINTS + 1][3], end[POINTS + 1][3], rooms[PAIRS];
        static int32_t points[PAIRS][4], numbers[PAIRS];
        const double slide = 0.3;
        for (int p = 0; p < POINTS; p++)
            for (int k = 0; k < 3; k++) {
                start[p][k] = random_between(&random, -1, 1) * (k == 2 ? 0.1 : 1);
                end[p][k] = start[p][k] + random_between(&random, -0.12, 0.12);
            }
        for (int i = 0; i < PAIRS; i++) {
            for (int k = 0; k < 4; k++)
                points[i][k] = 4 * (int32_t)random_between(&random, 0, POINTS / 4 - 0.01) + k;
            rooms[i] = random_between(&random, 0, 0.15);
        }
        for (int k = 0; k < 3; k++)
            start[3][k] = start[2][k] + start[1][k] - start[0][k];
        for (int i = 0; i < 4; i++)
            points[5][i] = i;
        const int32_t count = round % 2 == 0 ? PAIRS : round;
        const pel_edge_pairs pairs = {.start = (const double(*)[3])start,
                                      .end = (const double(*)[3])end,
                                      .points = (const int32_t(*)[4])points,
                                      .rooms = rooms,
                                      .count = count,
                                      .slide = slide};
        int32_t found = pel_edges_to_measure(&pairs, numbers), at = 0;
        for (int32_t i = 0; i < count; i++) {
            bool slides = !(approach_of(start, end, points[i]) < slide);
            bool is_left = slides || !is_kept(start, points[i], rooms[i]);
            assert_true(is_left == (at < found && numbers[at] == i));
            at += is_left;
            left += is_left;
            kept += !is_left;
            slid += slides;
        }
        assert_int_equal(at, found);
    }
    assert_true(kept > 1000 && left > 1000 && slid > 100);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_against_single)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

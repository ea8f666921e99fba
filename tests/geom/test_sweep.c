/* A moving segment through a moving triangle against samples in time: at any time it is in the triangle if and only if
   the time is between the two events of a pair. */
#include "check.h"

#include "geom/sweep.h"
#include "math/vec3.h"
#include "random.h"

enum { SAMPLES = 64 };

static void random_point(random_state *random, double size, double x[3])
{
    for (int k = 0; k < 3; k++)
        x[k] = random_between(random, -size, size);
}

static pel_sweep random_sweep(random_state *random)
{
    pel_sweep s = {0};
    for (int time = 0; time < 2; time++) {
        for (int end = 0; end < 2; end++)
            random_point(random, 2, s.segment[time][end]);
        for (int c = 0; c < 3; c++)
            random_point(random, 1, s.corners[time][c]);
    }
    for (int edge = 0; edge < 3; edge++)
        s.turned[edge] = random_between(random, 0, 1) < 0.5;
    return s;
}

static void at_time(const pel_sweep *s, double t, double segment[2][3], double corners[3][3])
{
    for (int k = 0; k < 3; k++) {
        for (int end = 0; end < 2; end++)
            segment[end][k] = (1 - t) * s->segment[0][end][k] + t * s->segment[1][end][k];
        for (int c = 0; c < 3; c++)
            corners[c][k] = (1 - t) * s->corners[0][c][k] + t * s->corners[1][c][k];
    }
}

static bool is_inside(const pel_sweep_event *events, int count, double t)
{
    for (int i = 0; i + 1 < count; i += 2)
        if (t > events[i].time && t < events[i + 1].time)
            return true;
    return false;
}

/* the point of an event lies on the segment at its time */
static void check_event(const pel_sweep *s, const pel_sweep_event *event)
{
    double segment[2][3], corners[3][3], x[3] = {0}, sum = 0, along[3], arm[3], off[3];
    at_time(s, event->time, segment, corners);
    for (int c = 0; c < 3; c++) {
        assert_true(event->weights[c] >= 0 && event->weights[c] <= 1);
        pel_vec3_along(x, event->weights[c], corners[c], x);
        sum += event->weights[c];
    }
    assert_near(sum, 1, 1e-12);
    pel_vec3_subtract(segment[1], segment[0], along);
    pel_vec3_subtract(x, segment[0], arm);
    pel_vec3_cross(along, arm, off);
    assert_near(pel_vec3_length(off) / pel_vec3_squared_length(along), 0, 1e-6);
    if (event->kind == PEL_SWEEP_EDGE)
        assert_near(event->weights[(event->edge + 2) % 3], 0, 0);
}

static void samples_agree(void **state)
{
    (void)state;
    random_state random = {7};
    int passages = 0, twice = 0;
    for (int round = 0; round < LONG(100000, 6000); round++) {
        const pel_sweep s = random_sweep(&random);
        pel_sweep_event events[PEL_SWEEP_EVENTS];
        int count = pel_sweep_find(&s, events);
        assert_int_equal(count % 2, 0);
        passages += count > 0;
        twice += count > 2;
        for (int i = 0; i < count; i++) {
            assert_true(i == 0 || events[i].time >= events[i - 1].time);
            check_event(&s, &events[i]);
        }
        for (int i = 0; i < SAMPLES; i++) {
            double t = (i + 0.5) / SAMPLES, segment[2][3], corners[3][3], weights[3];
            at_time(&s, t, segment, corners);
            bool is_in = pel_segment_passes((const double(*)[3])segment, (const double(*)[3])corners, weights);
            assert_int_equal(is_in, is_inside(events, count, t));
        }
    }
    assert_true(passages > 1000 && twice > 50);
}

/* both triangles beside an edge name the same time and place on it, bit for bit */
static void neighbours_agree(void **state)
{
    (void)state;
    random_state random = {11};
    int crossings = 0;
    for (int round = 0; round < 4000; round++) {
        pel_sweep one = random_sweep(&random), other = one;
        pel_sweep_event a[PEL_SWEEP_EVENTS], b[PEL_SWEEP_EVENTS];
        for (int time = 0; time < 2; time++) {
            /* its edge 1 is edge 0 of the first one, seen from the other side */
            memcpy(other.corners[time][1], one.corners[time][1], sizeof one.corners[time][1]);
            memcpy(other.corners[time][2], one.corners[time][0], sizeof one.corners[time][0]);
            random_point(&random, 1, other.corners[time][0]);
        }
        other.turned[1] = !one.turned[0];
        int a_count = pel_sweep_find(&one, a), b_count = pel_sweep_find(&other, b);
        for (int i = 0; i < a_count; i++)
            for (int k = 0; k < b_count && a[i].kind == PEL_SWEEP_EDGE && a[i].edge == 0; k++)
                if (b[k].kind == PEL_SWEEP_EDGE && b[k].edge == 1 && fabs(a[i].time - b[k].time) < 1e-9) {
                    assert_true(a[i].time == b[k].time && a[i].weights[0] == b[k].weights[2]);
                    crossings++;
                }
    }
    assert_true(crossings > 200);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(samples_agree), cmocka_unit_test(neighbours_agree)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

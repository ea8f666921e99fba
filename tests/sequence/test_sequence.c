/* Positions over time: between frames, outside them, copies, shares and bad input. */
#include "check.h"
#include "failing_malloc.h"
#include "math/vec3.h"
#include "random.h"
#include "sequence/sequence.h"

enum { FRAMES = 7, VERTICES = 5 };

typedef struct sample {
    double times[FRAMES], positions[FRAMES][VERTICES][3];
} sample;

static void fill(sample *s)
{
    random_state random = {7};
    for (int f = 0; f < FRAMES; f++) {
        s->times[f] = (f > 0 ? s->times[f - 1] : -0.3) + random_between(&random, 0.05, 0.4);
        for (int v = 0; v < VERTICES; v++)
            for (int k = 0; k < 3; k++)
                s->positions[f][v][k] = random_between(&random, -1, 1);
    }
}

static pel_sequence *make(const sample *s)
{
    pel_sequence *sequence;
    assert_int_equal(pel_sequence_create(s->positions[0][0], s->times, FRAMES, VERTICES, &sequence, NULL), PEL_OK);
    return sequence;
}

/* by looking at every pair of frames */
static double slow(const sample *s, double time, int v, int k)
{
    for (int f = 0; f + 1 < FRAMES; f++)
        if (time >= s->times[f] && time < s->times[f + 1]) {
            double share = (time - s->times[f]) / (s->times[f + 1] - s->times[f]);
            return s->positions[f][v][k] + share * (s->positions[f + 1][v][k] - s->positions[f][v][k]);
        }
    return s->positions[time < s->times[0] ? 0 : FRAMES - 1][v][k];
}

static void test_between(void **unused)
{
    (void)unused;
    sample s;
    fill(&s);
    pel_sequence *sequence = make(&s);
    double x[VERTICES][3];
    for (double time = s.times[0] - 0.1; time < s.times[FRAMES - 1] + 0.1; time += 0.003) {
        pel_sequence_at(sequence, time, x[0]);
        for (int v = 0; v < VERTICES; v++)
            for (int k = 0; k < 3; k++)
                assert_near(x[v][k], slow(&s, time, v, k), 1e-15);
    }
    for (int f = 0; f < FRAMES; f++) {
        pel_sequence_at(sequence, s.times[f], x[0]);
        assert_memory_equal(x, s.positions[f], sizeof x);
        assert_true(pel_sequence_time(sequence, f) == s.times[f]);
    }
    pel_sequence_destroy(sequence);
}

/* the largest speed between two frames bounds that of every vertex at any time, and one vertex has it */
static void test_speed(void **unused)
{
    (void)unused;
    sample s;
    fill(&s);
    pel_sequence *sequence = make(&s);
    double fastest = 0;
    for (int f = 0; f + 1 < FRAMES; f++)
        for (int v = 0; v < VERTICES; v++) {
            double speed = pel_vec3_distance(s.positions[f][v], s.positions[f + 1][v]) / (s.times[f + 1] - s.times[f]);
            fastest = speed > fastest ? speed : fastest;
        }
    assert_near(sequence->speed, fastest, 1e-14 * fastest);
    pel_sequence_destroy(sequence);
}

static void test_map(void **unused)
{
    (void)unused;
    sample s;
    fill(&s);
    pel_sequence *sequence = make(&s), *mapped;
    const int32_t rows[3] = {4, 0, 4};
    pel_transform transform = pel_transform_default();
    pel_vec3_set(transform.scale, 2, -1, 3);
    pel_vec3_set(transform.translation, 1, 2, 3);
    assert_int_equal(pel_sequence_map(sequence, rows, 3, &transform, 0.5, &mapped, NULL), PEL_OK);
    assert_int_equal(pel_sequence_vertex_count(mapped), 3);
    assert_int_equal(pel_sequence_frame_count(mapped), FRAMES);
    double x[VERTICES][3], y[3][3];
    pel_sequence_at(sequence, 0.2, x[0]);
    pel_sequence_at(mapped, 0.7, y[0]);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            assert_near(y[i][k], transform.scale[k] * x[rows[i]][k] + transform.translation[k], 1e-14);
    assert_true(mapped->fingerprint != sequence->fingerprint);
    pel_sequence_destroy(mapped);
    const int32_t outside[1] = {VERTICES};
    pel_error error;
    assert_int_equal(pel_sequence_map(sequence, outside, 1, NULL, 0, &mapped, &error), PEL_BAD_ARGUMENT);
    assert_null(mapped);
    assert_non_null(strstr(error.what, "vertex 5"));
    transform.scale[0] = 0;
    assert_int_equal(pel_sequence_map(sequence, rows, 3, &transform, 0, &mapped, &error), PEL_BAD_ARGUMENT);
    pel_sequence_destroy(sequence);
}

/* each owner destroys it once; the numbers stay until the last one has */
static void test_share(void **unused)
{
    (void)unused;
    sample s;
    fill(&s);
    failing_malloc_begin(0);
    pel_sequence *sequence = make(&s);
    const pel_sequence *shared = pel_sequence_share(sequence);
    assert_ptr_equal(shared, sequence);
    pel_sequence_destroy(sequence);
    double x[VERTICES][3];
    pel_sequence_at(shared, s.times[3], x[0]);
    assert_memory_equal(x, s.positions[3], sizeof x);
    pel_sequence_destroy((pel_sequence *)(uintptr_t)shared);
    assert_int_equal(failing_malloc_end().live, 0);
}

static void refuse(const sample *s, int32_t frames, int32_t vertices, const char *words)
{
    pel_sequence *sequence = (pel_sequence *)(uintptr_t)1;
    pel_error error;
    assert_int_equal(pel_sequence_create(s->positions[0][0], s->times, frames, vertices, &sequence, &error),
                     PEL_BAD_ARGUMENT);
    assert_null(sequence);
    assert_non_null(strstr(error.what, words));
    assert_true(error.remedy[0] != '\0');
}

static void test_refusals(void **unused)
{
    (void)unused;
    sample s;
    fill(&s);
    refuse(&s, 0, VERTICES, "0 frames");
    refuse(&s, FRAMES, 0, "0 vertices");
    sample bad = s;
    bad.times[3] = bad.times[2];
    refuse(&bad, FRAMES, VERTICES, "not after");
    bad = s;
    bad.times[0] = (double)NAN;
    refuse(&bad, FRAMES, VERTICES, "time of a frame");
    bad = s;
    bad.positions[6][4][2] = (double)INFINITY;
    refuse(&bad, FRAMES, VERTICES, "vertex 4");
}

static pel_status create_and_map(const void *data, pel_error *error)
{
    const sample *s = data;
    const int32_t rows[2] = {0, 3};
    pel_sequence *sequence, *mapped = NULL;
    pel_status status = pel_sequence_create(s->positions[0][0], s->times, FRAMES, VERTICES, &sequence, error);
    assert_true((status == PEL_OK) == (sequence != NULL));
    if (status == PEL_OK)
        status = pel_sequence_map(sequence, rows, 2, NULL, 0, &mapped, error);
    assert_true((status == PEL_OK) == (mapped != NULL));
    pel_sequence_destroy(sequence);
    pel_sequence_destroy(mapped);
    return status;
}

static void test_memory(void **unused)
{
    (void)unused;
    sample s;
    fill(&s);
    assert_true(for_every_allocation_failure(create_and_map, &s) >= 6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_between), cmocka_unit_test(test_speed),    cmocka_unit_test(test_map),
        cmocka_unit_test(test_share),   cmocka_unit_test(test_refusals), cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

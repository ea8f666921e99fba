/* Bounds of ways and approaches, against those of all points and pairs of points. */
#include "check.h"
#include "failing_malloc.h"

#include "base/memory.h"
#include "collide/travel.h"
#include "math/vec3.h"

enum { BODIES = 3, SLICES = 40, COUNT = SLICES * PEL_WIDTH, STEPS = 6 };

static double uniform(double low, double high)
{
    return low + (high - low) * rand() / RAND_MAX;
}

typedef struct cloud {
    int32_t body_of_slice[SLICES];
    pel_real mass[COUNT];
    pel_record *first, *now; /* (COUNT) */
    pel_travel_def def;
} cloud;

/* three bodies, each with padding that never moves */
static void make_cloud(cloud *c)
{
    c->first = pel_allocate_aligned(COUNT, sizeof *c->first);
    c->now = pel_allocate_aligned(COUNT, sizeof *c->now);
    for (int32_t v = 0; v < COUNT; v++) {
        c->body_of_slice[v / PEL_WIDTH] = v * BODIES / COUNT;
        c->mass[v] = v % PEL_WIDTH == 3 ? 0 : 1;
        for (int k = 0; k < 4; k++)
            c->first[v][k] = c->now[v][k] = (pel_real)uniform(-1, 1);
    }
    c->def = (pel_travel_def){COUNT, BODIES, c->body_of_slice, c->mass};
}

/* all points go by `common` [m], those of each body by up to `own` more */
static void move(cloud *c, double common, double own)
{
    for (int32_t v = 0; v < COUNT; v++)
        for (int k = 0; k < 3 && c->mass[v] > 0; k++)
            c->now[v][k] += (pel_real)(common + own * (1 + c->body_of_slice[v / PEL_WIDTH]) * uniform(-1, 1));
}

static void way_of(const cloud *c, int32_t v, double way[3])
{
    for (int k = 0; k < 3; k++)
        way[k] = (double)(c->now[v][k] - c->first[v][k]);
}

/* of the sum of the boxes' diagonals, by which bounds exceed what they bound at most: STEPS boxes of random ways */
#define LOOSE 12.0

static void check_bounds(const cloud *c, const pel_travel *travel)
{
    double ways[BODIES] = {0}, approach = 0;
    for (int32_t v = 0; v < COUNT; v++) {
        double way[3], other[3];
        int32_t body = c->body_of_slice[v / PEL_WIDTH];
        way_of(c, v, way);
        if (!(c->mass[v] > 0))
            continue;
        ways[body] = fmax(ways[body], pel_vec3_length(way));
        for (int32_t u = 0; u < v; u++) {
            way_of(c, u, other);
            if (c->mass[u] > 0)
                approach = fmax(approach, pel_vec3_distance(way, other));
        }
    }
    const double rounding = sizeof(pel_real) == 4 ? 1e-5 : 1e-12;
    for (int b = 0; b < BODIES; b++)
        assert_true(travel->way[b] >= ways[b] - rounding && travel->way[b] < LOOSE * ways[b] + rounding);
    assert_true(travel->approach >= approach - rounding && travel->approach < LOOSE * approach + rounding);
}

static void test_bounds(void **unused)
{
    (void)unused;
    srand(5);
    cloud c;
    pel_travel travel;
    make_cloud(&c);
    assert_int_equal(pel_travel_create(&c.def, &travel, NULL), PEL_OK);
    pel_travel_restart(&travel);
    pel_travel_follow(&travel, c.now, -1, NULL);
    assert_near(travel.approach + travel.way[0], 0, 0);
    for (int n = 0; n < STEPS; n++) {
        move(&c, 0.1, 0.01);
        pel_travel_follow(&travel, c.now, -1, NULL);
        check_bounds(&c, &travel);
    }
    pel_travel_destroy(&travel);
    pel_free(c.first);
    pel_free(c.now);
}

/* what falls as a whole comes no nearer to itself, but to what stays beside it */
static void test_common(void **unused)
{
    (void)unused;
    cloud c;
    pel_travel travel;
    make_cloud(&c);
    assert_int_equal(pel_travel_create(&c.def, &travel, NULL), PEL_OK);
    for (int is_beside = 0; is_beside < 2; is_beside++) {
        pel_travel_restart(&travel);
        pel_travel_follow(&travel, c.now, is_beside ? 0 : -1, NULL);
        move(&c, 1, 0);
        pel_travel_follow(&travel, c.now, is_beside ? 0 : -1, NULL);
        assert_near(travel.approach, is_beside ? sqrt(3) : 0, 1e-6);
        assert_near(travel.way[2], sqrt(3), 1e-6);
    }
    pel_travel_follow(&travel, c.now, 0.5, NULL);
    assert_near(travel.approach, sqrt(3) + 0.5, 1e-6);
    assert_near(travel.way[1], sqrt(3) + 0.5, 1e-6);
    pel_travel_destroy(&travel);
    pel_free(c.first);
    pel_free(c.now);
}

static pel_status try_create(const void *data, pel_error *error)
{
    pel_travel travel;
    pel_status status = pel_travel_create(data, &travel, error);
    pel_travel_destroy(&travel);
    return status;
}

static void test_memory(void **unused)
{
    (void)unused;
    cloud c;
    make_cloud(&c);
    for_every_allocation_failure(try_create, &c.def);
    pel_free(c.first);
    pel_free(c.now);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bounds),
        cmocka_unit_test(test_common),
        cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

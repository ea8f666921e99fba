/* Sums of vertices of rigid bodies and loose ones: values, mobility and momenta against what they do. */
#include "pair_fixture.h"
#include "random.h"

/* a body and loose vertices, or within one body: the value, and the way by a small push */
static void test_mobility(void **state)
{
    (void)state;
    static const int32_t cases[3][4] = {{1, 16, 17, 18}, {1, 2, 16, 17}, {9, 10, 11, 20}};
    static const double weights[4] = {1, -0.2, -0.3, -0.5};
    for (int c = 0; c < 3; c++) {
        pair p;
        pel_rigid_sum sum;
        double before[3], after[3], direction[3] = {0.36, 0.48, 0.8}, push[3];
        make_pair(&p);
        assert_true(pel_rigid_sum_is_asked(&p.rigids, cases[c], weights, 4));
        pel_rigid_sum_set(&sum, &p.rigids, cases[c], weights, 4, p.places);
        value_of(&p, cases[c], weights, before);
        for (int k = 0; k < 3; k++)
            assert_near(sum.value[k], before[k], sizeof(pel_real) == sizeof(double) ? 1e-14 : 1e-6);
        double mobility = pel_rigid_sum_mobility(&sum, direction), d = 1e-6 / mobility;
        pel_vec3_scale(direction, d, push);
        pel_rigid_sum_push(&sum, &p.rigids, p.places, push);
        pel_rigids_place(&p.rigids, p.places);
        value_of(&p, cases[c], weights, after);
        pel_vec3_subtract(after, before, after);
        assert_near(pel_vec3_dot(after, direction) / (mobility * d), 1,
                    sizeof(pel_real) == sizeof(double) ? 1e-4 : 0.5);
        end_pair(&p);
    }
    static const int32_t loose[4] = {16, 17, 18, 1};
    static const double unused[4] = {1, -0.5, -0.5, 0};
    pair p;
    make_pair(&p);
    assert_false(pel_rigid_sum_is_asked(&p.rigids, loose, unused, 4));
    assert_false(pel_rigid_sum_is_asked(NULL, loose, unused, 4));
    end_pair(&p);
}

/* Two free bodies over a substep: however they push each other, momentum and angular momentum stay, for pushes at
   places that have moved since its start. */
static void test_momenta(void **state)
{
    (void)state;
    static const int32_t vertices[4] = {6, 8, 9, 10};
    static const double weights[4] = {1, -0.2, -0.5, -0.3};
    random_state random = {7};
    for (int trial = 0; trial < 50; trial++) {
        pair p;
        double before[2][3], after[2][3], push[3];
        make_pair(&p);
        drift_pair(&p, before);
        for (int i = 0; i < 3; i++) {
            pel_rigid_sum sum;
            for (int k = 0; k < 3; k++)
                push[k] = random_between(&random, -5e-4, 5e-4);
            pel_rigid_sum_set(&sum, &p.rigids, vertices, weights, 4, p.places);
            pel_rigid_sum_push(&sum, &p.rigids, p.places, push);
        }
        find_momenta(&p, after);
        for (int i = 0; i < 2; i++)
            for (int k = 0; k < 3; k++)
                assert_near(after[i][k], before[i][k], 1e-13);
        end_pair(&p);
    }
}

/* impulses change velocities alone */
/* Two free bodies feel a push in the middle between their points; a free one that is pushed off a body that something
   carries, at its own point. */
static void test_arms(void **state)
{
    (void)state;
    static const int32_t vertices[4] = {6, 8, 9, 10};
    static const double weights[4] = {1, -0.2, -0.5, -0.3};
    for (int carried = -1; carried < 2; carried++) {
        pair p;
        pel_rigid_sum sum;
        double momentum[2][3], arm[3], own[3], far[3] = {0};
        make_pair(&p);
        drift_pair(&p, momentum);
        if (carried >= 0)
            p.items[carried].is_fixed = true;
        p.items[0].is_moved = p.items[1].is_moved = true;
        pel_rigids_place(&p.rigids, p.places);
        pel_vertex_position(p.places, 6, own);
        for (int i = 1; i < 4; i++) {
            pel_vertex_position(p.places, vertices[i], arm);
            pel_vec3_along(far, -weights[i], arm, far);
        }
        /* arms as they are now, at the pivots of the start */
        pel_vec3_subtract(own, p.items[0].state.pivot, own);
        pel_vec3_subtract(far, p.items[1].state.pivot, far);
        pel_vec3_add(far, p.items[1].started.pivot, far);
        pel_vec3_subtract(far, p.items[0].started.pivot, far);
        pel_rigid_sum_set(&sum, &p.rigids, vertices, weights, 4, p.places);
        for (int k = 0; k < 3; k++)
            assert_near(sum.grips[0].arm[k], carried >= 0 ? own[k] : 0.5 * (own[k] + far[k]),
                        sizeof(pel_real) == sizeof(double) ? 1e-12 : 1e-6);
        end_pair(&p);
    }
}

static void test_hit(void **state)
{
    (void)state;
    static const int32_t vertices[4] = {1, 16, 17, 18};
    static const double weights[4] = {1, -0.2, -0.3, -0.5}, impulse[3] = {0.1, 0.2, -0.3};
    pel_record velocities[SIZE] = {{0}};
    pair p;
    pel_rigid_sum sum;
    double before[3], after[3], length = pel_vec3_length(impulse), direction[3];
    make_pair(&p);
    pel_rigid_state start = p.items[0].state;
    pel_rigid_sum_set(&sum, &p.rigids, vertices, weights, 4, p.places);
    pel_rigid_sum_velocity(&sum, &p.rigids, velocities, before);
    pel_rigid_sum_hit(&sum, &p.rigids, p.places, velocities, impulse);
    pel_rigid_sum_velocity(&sum, &p.rigids, velocities, after);
    pel_vec3_subtract(after, before, after);
    pel_vec3_scale(impulse, 1 / length, direction);
    assert_near(pel_vec3_dot(after, direction), length * pel_rigid_sum_mobility(&sum, direction), 1e-6);
    assert_memory_equal(p.items[0].state.pivot, start.pivot, sizeof start.pivot);
    assert_near((double)velocities[16][0], -0.2 * 0.1, 1e-7);
    end_pair(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_mobility),
        cmocka_unit_test(test_momenta),
        cmocka_unit_test(test_arms),
        cmocka_unit_test(test_hit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

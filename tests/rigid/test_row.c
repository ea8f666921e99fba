/* Rows of sums of rigid bodies against the sums: places, mobility and momenta, however often and wherever they are
   pushed. */
#include "pair_fixture.h"
#include "random.h"

#include "base/memory.h"
#include "rigid/row.h"

enum { ROWS = 4, PUSHES = 40 };

/* a vertex of one box before a triangle of the other, edges, and what does not move on one side */
static const int32_t vertices[ROWS][4] = {{6, 8, 9, 10}, {1, 3, 12, 15}, {9, 10, 4, 7}, {2, 0, 0, 0}};
static const double weights[ROWS][4] = {{1, -0.2, -0.5, -0.3}, {0.4, 0.6, -0.7, -0.3}, {1, 0, -1, 0}, {1, 0, 0, 0}};

static void make_rows(pair *p, pel_rigid_row rows[ROWS])
{
    for (int r = 0; r < ROWS; r++) {
        pel_rigid_sum sum;
        pel_rigid_sum_set(&sum, &p->rigids, vertices[r], weights[r], 4, p->places);
        assert_true(pel_rigid_row_set(&rows[r], &p->rigids, &sum, p->places));
    }
}

static void draw_push(random_state *random, double size, double push[3])
{
    for (int k = 0; k < 3; k++)
        push[k] = random_between(random, -size, size);
}

/* Small pushes on all rows in turns move every row, and all vertices, as if each had been found anew. */
static void test_places(void **state)
{
    (void)state;
    random_state random = {3};
    pair p;
    pel_rigid_row rows[ROWS];
    double place[3], value[3], push[3], follows[3];
    make_pair(&p);
    make_rows(&p, rows);
    for (int i = 0; i < PUSHES; i++) {
        draw_push(&random, 1e-5, push);
        pel_rigid_row_place(&rows[i % ROWS], follows);
        pel_rigid_row_follow(&rows[i % ROWS], push, follows);
        pel_rigid_row_push(&rows[i % ROWS], push, p.rigids.rate);
        pel_rigid_row_place(&rows[i % ROWS], place);
        /* between two free bodies pushes act in the middle between their points, which here are far from each
           other; the tensor of a box turns with it */
        for (int k = 0; k < 3 && i % ROWS == 3; k++)
            assert_near(follows[k], place[k], 1e-8);
        /* what asks for the state between finds all of it */
        if (i % 5 == 4) {
            pel_rigid_settle(&p.items[i % 2]);
            assert_false(p.items[i % 2].is_owed);
        }
    }
    pel_rigids_place(&p.rigids, p.places);
    double moved = 0;
    for (int r = 0; r < ROWS; r++) {
        pel_rigid_row_place(&rows[r], place);
        value_of(&p, vertices[r], weights[r], value);
        moved = fmax(moved, pel_vec3_distance(place, rows[r].start));
        for (int k = 0; k < 3; k++)
            assert_near(place[k], value[k], sizeof(pel_real) == sizeof(double) ? 1e-7 : 1e-6);
    }
    assert_true(moved > 2e-5);
    /* a row that is set after bodies have moved */
    make_rows(&p, rows);
    for (int r = 0; r < ROWS; r++) {
        pel_rigid_row_place(&rows[r], place);
        value_of(&p, vertices[r], weights[r], value);
        for (int k = 0; k < 3; k++)
            assert_near(place[k], value[k], sizeof(pel_real) == sizeof(double) ? 1e-14 : 1e-6);
    }
    end_pair(&p);
}

/* pushes that turn bodies by a right angle and more: rows that are found anew where they no longer hold stay near the
 * sums */
static void test_far_turns(void **state)
{
    (void)state;
    random_state random = {11};
    pair p;
    pel_rigid_row rows[ROWS];
    double push[3], place[3], value[3], turned = 0;
    int anew = 0;
    make_pair(&p);
    make_rows(&p, rows);
    draw_push(&random, 2e-3, push);
    for (int i = 0; i < 3000 && turned < 2; i++) {
        double before[4], after[4];
        pel_rigid_settle(&p.items[0]);
        memcpy(before, p.items[0].state.rotation, sizeof before);
        pel_rigid_row_push(&rows[0], push, p.rigids.rate);
        pel_rigids_place(&p.rigids, p.places);
        memcpy(after, p.items[0].state.rotation, sizeof after);
        double cosine = 0;
        for (int k = 0; k < 4; k++)
            cosine += before[k] * after[k];
        turned += 2 * acos(fmin(fabs(cosine), 1));
        if (!pel_rigid_row_is_of(&rows[0], vertices[0], weights[0], weights[0])) {
            make_rows(&p, rows);
            anew++;
        }
        pel_rigid_row_place(&rows[0], place);
        value_of(&p, vertices[0], weights[0], value);
        for (int k = 0; k < 3; k++)
            assert_near(place[k], value[k], 0.02);
    }
    assert_true(turned > 2 && anew > 5);
    end_pair(&p);
}

/* mobility is that of the sum, along every direction */
static void test_mobility(void **state)
{
    (void)state;
    random_state random = {5};
    pair p;
    pel_rigid_row rows[ROWS];
    double direction[3];
    make_pair(&p);
    make_rows(&p, rows);
    for (int r = 0; r < ROWS; r++)
        for (int i = 0; i < 20; i++) {
            pel_rigid_sum sum;
            draw_push(&random, 1, direction);
            pel_vec3_normalize(direction);
            pel_rigid_sum_set(&sum, &p.rigids, vertices[r], weights[r], 4, p.places);
            double expected = pel_rigid_sum_mobility(&sum, direction);
            assert_near(pel_rigid_row_mobility(&rows[r], direction) / expected, 1, 1e-12);
        }
    end_pair(&p);
}

/* momentum and angular momentum stay, and the momenta of each body are those by pushes on the sums */
static void test_momenta(void **state)
{
    (void)state;
    random_state random = {7};
    for (int trial = 0; trial < 50; trial++) {
        pair p, q;
        pel_rigid_row rows[ROWS];
        pel_rigid_sum sum;
        double before[2][3], after[2][3], push[3];
        make_pair(&p);
        make_pair(&q);
        drift_pair(&p, before);
        drift_pair(&q, before);
        make_rows(&p, rows);
        pel_rigid_sum_set(&sum, &q.rigids, vertices[0], weights[0], 4, q.places);
        for (int i = 0; i < 6; i++) {
            draw_push(&random, 5e-4, push);
            pel_rigid_row_push(&rows[i % 2], push, p.rigids.rate);
        }
        pel_rigids_place(&p.rigids, p.places);
        find_momenta(&p, after);
        for (int i = 0; i < 2; i++)
            for (int k = 0; k < 3; k++)
                assert_near(after[i][k], before[i][k], 1e-13);
        for (int b = 0; b < 2; b++)
            p.items[b].state = p.items[b].started;
        pel_rigid_row_push(&rows[0], push, p.rigids.rate);
        pel_rigids_place(&p.rigids, p.places);
        pel_rigid_sum_push(&sum, &q.rigids, q.places, push);
        for (int b = 0; b < 2; b++)
            for (int k = 0; k < 3; k++) {
                assert_near(p.items[b].state.momentum[k], q.items[b].state.momentum[k], 1e-13);
                assert_near(p.items[b].state.angular_momentum[k], q.items[b].state.angular_momentum[k], 1e-13);
            }
        end_pair(&p);
        end_pair(&q);
    }
}

/* what is loose has no row; what is held is a row that does not move; other weights are another row */
static void test_kinds(void **state)
{
    (void)state;
    static const int32_t mixed[4] = {6, 16, 17, 18};
    pair p;
    pel_rigid_sum sum;
    pel_rigid_row row;
    double place[3], push[3] = {1e-3, 0, 0}, other[4] = {1, -0.2, -0.4, -0.4};
    make_pair(&p);
    pel_rigid_sum_set(&sum, &p.rigids, mixed, weights[0], 4, p.places);
    assert_false(pel_rigid_row_set(&row, &p.rigids, &sum, p.places));
    p.items[0].is_fixed = p.items[1].is_fixed = true;
    pel_rigid_sum_set(&sum, &p.rigids, vertices[0], weights[0], 4, p.places);
    assert_true(pel_rigid_row_set(&row, &p.rigids, &sum, p.places));
    pel_rigid_row_push(&row, push, p.rigids.rate);
    pel_rigid_row_place(&row, place);
    for (int k = 0; k < 3; k++)
        assert_true(place[k] == sum.value[k]);
    assert_true(pel_rigid_row_mobility(&row, push) == 0);
    assert_true(pel_rigid_row_is_of(&row, vertices[0], weights[0], weights[0]));
    assert_false(pel_rigid_row_is_of(&row, vertices[0], other, weights[0]));
    assert_false(pel_rigid_row_is_of(&row, mixed, weights[0], weights[0]));
    end_pair(&p);
}

/* rows begin anew, in the same room */
static void test_rows(void **state)
{
    (void)state;
    pel_rigids rigids = {0};
    int32_t round = rigids.row_round;
    for (int i = 0; i < 100; i++) {
        assert_non_null(pel_rigid_rows_add(&rigids));
        assert_int_equal(rigids.row_count, i + 1);
    }
    pel_rigid_rows_begin(&rigids);
    assert_int_equal(rigids.row_count, 0);
    assert_true(rigids.row_round != round);
    rigids.row_round = INT32_MAX;
    pel_rigid_rows_begin(&rigids);
    assert_true(rigids.row_round > 0);
    pel_free(rigids.rows);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_places),  cmocka_unit_test(test_mobility),
                                       cmocka_unit_test(test_momenta), cmocka_unit_test(test_kinds),
                                       cmocka_unit_test(test_rows),    cmocka_unit_test(test_far_turns)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

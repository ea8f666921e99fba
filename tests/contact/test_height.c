/* Heights of triangles that are pressed flat: against a measurement of all triangles, at each step of a way. */
#include "set_fixture.h"

#include "math/vec3.h"

#include <float.h>

/* of height.c: least height and that below which a triangle is watched, of the height at rest */
#define LEAST 0.05
#define WATCHED 0.2
/* positions have 24 bits or more */
#define TOLERANCE (sizeof(pel_real) == 4 ? 1e-5 : 1e-12)

/* twice the area over the longest edge */
static double height_of(const int32_t *v, const pel_record *positions)
{
    double x[3][3], a[3], b[3], normal[3], longest = 0;
    for (int i = 0; i < 3; i++)
        pel_vertex_position(positions, v[i], x[i]);
    for (int i = 0; i < 3; i++)
        longest = fmax(longest, pel_vec3_distance(x[i], x[(i + 1) % 3]));
    pel_vec3_subtract(x[1], x[0], a);
    pel_vec3_subtract(x[2], x[0], b);
    pel_vec3_cross(a, b, normal);
    return longest > 0 ? pel_vec3_length(normal) / longest : 0;
}

/* the list has every flat triangle once, and its least height */
static int32_t check_list(const pel_contact_set *set, const pel_record *rest, const pel_record *position)
{
    const pel_contact_heights *heights = &set->heights;
    int32_t next = 0;
    for (int32_t t = 0; t < set->triangle_count; t++) {
        if (set->triangles[t][0] >= set->vertex_count)
            continue; /* of the obstacle */
        double height = height_of(set->triangles[t], position), at_rest = height_of(set->triangles[t], rest);
        bool listed = next < heights->list.count && heights->triangles[next] == t;
        if (fabs(height - WATCHED * at_rest) > TOLERANCE)
            assert_int_equal(listed, height < WATCHED * at_rest);
        if (listed)
            assert_near((double)heights->list.contacts[next++].separation, LEAST * at_rest, TOLERANCE);
    }
    assert_int_equal(next, heights->list.count);
    return next;
}

/* A contact takes its vertex from the longest edge: the weighted sum of its corners is the height along the normal, and
   the normal is across the edge. */
static void check_contacts(const pel_contact_set *set, const pel_record *position)
{
    for (int32_t c = 0; c < set->heights.list.count; c++) {
        const pel_contact *contact = &set->heights.list.contacts[c];
        const int32_t *v = contact->vertices, *corners = set->triangles[set->heights.triangles[c]];
        double x[3][3], sum[3] = {0, 0, 0}, normal[3], edge[3], total = 0;
        for (int i = 0; i < 3; i++) {
            assert_true(v[i] == corners[0] || v[i] == corners[1] || v[i] == corners[2]);
            pel_vertex_position(position, v[i], x[i]);
            pel_vec3_along(sum, (double)contact->weights[i], x[i], sum);
            total += (double)contact->weights[i];
            normal[i] = (double)contact->normal[i];
        }
        assert_true(v[0] != v[1] && v[0] != v[2] && v[1] != v[2] && contact->weights[3] == 0);
        assert_near((double)contact->weights[0], 1, 0);
        assert_near(total, 0, TOLERANCE);
        pel_vec3_subtract(x[2], x[1], edge);
        assert_true(pel_vec3_length(edge) >= pel_vec3_distance(x[0], x[1]));
        assert_true(pel_vec3_length(edge) >= pel_vec3_distance(x[0], x[2]));
        double height = height_of(corners, position);
        if (height < 1e3 * TOLERANCE)
            continue; /* its direction is rounding */
        assert_near(pel_vec3_length(normal), 1, TOLERANCE);
        assert_near(pel_vec3_dot(normal, edge), 0, 1e3 * TOLERANCE);
        for (int k = 0; k < 3; k++)
            assert_near(sum[k], height * normal[k], TOLERANCE);
    }
}

/* a sheet of several chunks is pressed together along a direction in its plane and spread again, by small steps and
   jumps, with one thread and with two */
static void test_pressed_sheet(void **unused)
{
    (void)unused;
    static arrays a;
    random_state random = {3};
    int32_t most = 0, skipped = 0, again = 0;
    const pel_obstacle box = {.solid = {.shape = PEL_TOOL_BOX, .half_extents = {0.1, 0.1, 0.1}},
                              .presses = true,
                              .body = -1,
                              .before = pose_at(0, 0, 2),
                              .pose = pose_at(0, 0, 2)};
    a = (arrays){0};
    add_sheet(&a, 16, 0, 0.01, &random);
    add_obstacle(&a, &box, 0);
    assert_true(a.triangle_count > PEL_HEIGHT_CHUNK);
    for (int32_t v = 0; v < a.vertex_count; v++)
        a.rest[v][0] += (pel_real)0.5;
    pel_contact_set *set = create(&a);
    pel_pool *pool;
    assert_int_equal(pel_pool_create(2, &pool, NULL), PEL_OK);
    for (int n = 0; n <= 400; n++) {
        set->def.pool = n % 3 > 0 ? pool : NULL;
        double angle = 0.3, along = n <= 200 ? 1 - 0.00495 * n : 0.01 + 0.00495 * (n - 200);
        if (n % 50 == 49)
            along *= 0.5;
        for (int32_t v = 0; v < a.vertex_count; v++) {
            const double x = (double)a.rest[v][0], y = (double)a.rest[v][1];
            double u = along * (cos(angle) * x + sin(angle) * y), w = cos(angle) * y - sin(angle) * x;
            a.next[v][0] = (pel_real)(cos(angle) * u - sin(angle) * w + random_between(&random, -1e-5, 1e-5));
            a.next[v][1] = (pel_real)(sin(angle) * u + cos(angle) * w);
        }
        const double slack = set->heights.slack;
        assert_int_equal(pel_contact_heights_find(set, a.next, NULL), PEL_OK);
        skipped += slack > 0 && set->heights.slack == slack;
        pel_contact_heights_refresh(set, a.next);
        int32_t count = check_list(set, a.rest, a.next);
        check_contacts(set, a.next);
        most = count > most ? count : most;
        again += n > 250 && count == 0;
    }
    /* much of the sheet was flat, and steps far from it measured nothing */
    assert_true(most > a.triangle_count / 3 && skipped > 20 && again > 20);
    pel_contact_set_destroy(set);
    pel_pool_destroy(pool);
}

/* after a measurement any vertex may flatten a triangle alone, along any axis */
static void test_single_vertices(void **unused)
{
    (void)unused;
    static arrays a;
    random_state random = {9};
    a = (arrays){0};
    add_sheet(&a, 4, 0, 0, &random);
    for (int axis = 0; axis < 3; axis++) {
        /* the plane of the sheet has the axis as its first one */
        for (int32_t v = 0; v < 16; v++) {
            const double x = (v % 4) / 3.0, y = (v / 4) / 3.0;
            for (int k = 0; k < 3; k++)
                a.rest[v][k] = (pel_real)(k == axis ? x : k == (axis + 1) % 3 ? y : 0);
        }
        memcpy(a.next, a.rest, sizeof a.next);
        pel_contact_set *set = create(&a);
        for (int32_t v = 0; v < 16; v++) {
            assert_int_equal(pel_contact_heights_find(set, a.rest, NULL), PEL_OK);
            assert_true(set->heights.slack > 0 && set->heights.list.count == 0);
            /* nearly onto its neighbour in the row */
            const pel_real beside = a.rest[v % 4 < 3 ? v + 1 : v - 1][axis];
            a.next[v][axis] += (pel_real)0.95 * (beside - a.next[v][axis]);
            assert_int_equal(pel_contact_heights_find(set, a.next, NULL), PEL_OK);
            assert_true(check_list(set, a.rest, a.next) > 0);
            a.next[v][axis] = a.rest[v][axis];
        }
        /* another surface is measured anew */
        assert_int_equal(pel_contact_heights_find(set, a.rest, NULL), PEL_OK);
        assert_true(set->heights.slack > 0);
        pel_contact_heights_set_surface(set);
        assert_true(set->heights.slack == 0);
        pel_contact_set_destroy(set);
    }
}

/* a triangle that has become a point is flat, and has no direction */
static void test_point(void **unused)
{
    (void)unused;
    static arrays a;
    random_state random = {5};
    a = (arrays){0};
    add_sheet(&a, 2, 0, 0, &random);
    pel_contact_set *set = create(&a);
    for (int32_t v = 0; v < 4; v++)
        a.next[v] = a.rest[0];
    assert_int_equal(pel_contact_heights_find(set, a.next, NULL), PEL_OK);
    pel_contact_heights_refresh(set, a.next);
    assert_int_equal(set->heights.list.count, 2);
    for (int32_t c = 0; c < 2; c++)
        for (int k = 0; k < 3; k++) {
            assert_true(set->heights.list.contacts[c].normal[k] == 0);
            assert_true(isfinite((double)set->heights.list.contacts[c].weights[k]));
        }
    /* a point is near no bound: the next step measures again */
    assert_true(set->heights.slack == 0);
    assert_int_equal(pel_contact_heights_find(set, a.rest, NULL), PEL_OK);
    assert_int_equal(set->heights.list.count, 0);
    pel_contact_set_destroy(set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_pressed_sheet), cmocka_unit_test(test_single_vertices),
                                       cmocka_unit_test(test_point)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

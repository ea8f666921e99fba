/* Forces of contacts over arrays: what an action does to vertices, pairs of groups and records, in closed form. */
#include "check.h"
#include "contact/force.h"
#include "failing_malloc.h"
#include "math/vec3.h"

enum { VERTICES = 2 * PEL_WIDTH };

/* two bodies of a slice each, and an obstacle */
typedef struct fixture {
    pel_contact_forces forces;
    pel_record position[VERTICES], next[VERTICES];
    pel_pose before, pose;
} fixture;

static const int32_t body_of_slice[2] = {0, 1};

static void begin(fixture *f)
{
    pel_error error;
    memset(f, 0, sizeof *f);
    assert_int_equal(pel_contact_forces_create(VERTICES, 2, 1, body_of_slice, &f->forces, &error), PEL_OK);
    assert_int_equal(pel_contact_records_create(&f->forces, &error), PEL_OK);
    for (int32_t v = 0; v < VERTICES; v++) {
        f->position[v] = (pel_record){(pel_real)(v % PEL_WIDTH), (pel_real)(v % 2), v < PEL_WIDTH ? 1 : 0, 0};
        f->next[v] = f->position[v];
        f->next[v][2] -= v < PEL_WIDTH ? (pel_real)0.25 : 0;
    }
    f->before = f->pose = (pel_pose){.rotation = {0, 0, 0, 1}};
    f->pose.position[2] = 0.125;
}

/* a vertex of body 0 on the triangle of body 1 below it */
static pel_contact_action act(int32_t vertices[4], double size)
{
    for (int i = 0; i < 4; i++)
        vertices[i] = i == 0 ? 0 : PEL_WIDTH + i - 1;
    return (pel_contact_action){.vertices = vertices,
                                .weights = {1, -0.5, -0.25, -0.25},
                                .force = {0.5 * size, 0, size},
                                .load = {0, 0, size},
                                .obstacle = -1};
}

static void test_between_bodies(void **unused)
{
    (void)unused;
    fixture f;
    int32_t vertices[4];
    begin(&f);
    const pel_contact_way way = {f.position, f.next, NULL, NULL};
    const pel_contact_action action = act(vertices, 8);
    pel_contact_forces_begin(&f.forces);
    pel_contact_forces_add(&f.forces, &way, &action);
    pel_contact_forces_accept(&f.forces, 1, true);
    double sum[3] = {0, 0, 0}, x[3];
    for (int32_t v = 0; v < VERTICES; v++) {
        pel_vertex_position(f.forces.vertex, v, x);
        pel_vec3_add(sum, x, sum);
    }
    for (int k = 0; k < 3; k++)
        assert_near(sum[k], 0, 0);
    assert_near((double)f.forces.vertex[0][2], 8, 0);
    assert_near((double)f.forces.vertex[PEL_WIDTH][0], -2, 0);
    assert_near((double)f.forces.vertex[PEL_WIDTH + 2][2], -2, 0);
    /* body 0 has the row, with the force on it */
    const pel_pair_force *pair = &f.forces.pair[0 * f.forces.group_count + 1];
    assert_near(pair->force[0], 4, 0);
    assert_near(pair->load[2], 8, 0);
    assert_near(pair->load_size, 8, 0);
    /* it came nearer by a quarter */
    assert_near(pair->approach, 8 * 0.25, 1e-12);
    /* the mean of all points, by the sizes of their weights: heights 0.75 and 0 */
    assert_near(pair->point[2], 8 * 0.375, 1e-12);
    pel_contact_forces_destroy(&f.forces);
}

static void test_obstacle(void **unused)
{
    (void)unused;
    fixture f;
    begin(&f);
    const pel_contact_way way = {f.position, f.next, &f.before, &f.pose};
    const int32_t vertices[4] = {PEL_WIDTH, 0, 0, 0};
    const pel_contact_action action = {
        .vertices = vertices, .weights = {1, 0, 0, 0}, .force = {0, 1, 3}, .load = {0, 0, 3}, .obstacle = 0};
    const double grip[3] = {1, 0, 0};
    pel_contact_forces_begin(&f.forces);
    pel_contact_forces_add(&f.forces, &way, &action);
    pel_contact_forces_add_at(&f.forces, PEL_WIDTH + 1, 0, grip);
    pel_contact_forces_accept(&f.forces, 1, true);
    const pel_pair_force *pair = &f.forces.pair[1 * f.forces.group_count + 2];
    const double expected[3] = {1, 1, 3};
    for (int k = 0; k < 3; k++)
        assert_near(pair->force[k], expected[k], 0);
    assert_near(pair->load_size, 3, 0);
    /* the vertex stayed, the obstacle came by an eighth */
    assert_near(pair->approach, 3 * 0.125, 1e-12);
    assert_near((double)f.forces.vertex[PEL_WIDTH + 1][0], 1, 0);
    assert_int_equal(f.forces.records->last.count, 2);
    pel_contact_forces_destroy(&f.forces);
}

/* parts of a step: means, by their shares; a step that follows forgets them */
static void test_parts(void **unused)
{
    (void)unused;
    fixture f;
    int32_t vertices[4];
    begin(&f);
    const pel_contact_way way = {f.position, f.next, NULL, NULL};
    const double shares[] = {0.25, 0.75}, sizes[] = {4, 8};
    for (int round = 0; round < 2; round++) {
        for (int part = 0; part < 2; part++) {
            const pel_contact_action action = act(vertices, sizes[part]);
            pel_contact_forces_begin(&f.forces);
            pel_contact_forces_add(&f.forces, &way, &action);
            pel_contact_forces_accept(&f.forces, shares[part], part == 0);
        }
        assert_near((double)f.forces.vertex[0][2], 7, 0);
        assert_near(f.forces.pair[1].load_size, 7, 0);
        assert_int_equal(f.forces.records->last.count, 1);
        assert_near(f.forces.records->last.entries[0].load[2], 7, 0);
    }
    pel_contact_forces_begin(&f.forces);
    pel_contact_forces_accept(&f.forces, 1, true);
    assert_near((double)f.forces.vertex[0][2], 0, 0);
    assert_int_equal(f.forces.records->last.count, 0);
    pel_contact_forces_destroy(&f.forces);
}

static pel_status create_case(const void *unused, pel_error *error)
{
    (void)unused;
    pel_contact_forces forces;
    pel_status status = pel_contact_forces_create(VERTICES, 2, 1, body_of_slice, &forces, error);
    if (status == PEL_OK)
        status = pel_contact_records_create(&forces, error);
    pel_contact_forces_destroy(&forces);
    return status;
}

static void test_allocations(void **unused)
{
    (void)unused;
    assert_int_equal(for_every_allocation_failure(create_case, NULL), 7);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_between_bodies),
        cmocka_unit_test(test_obstacle),
        cmocka_unit_test(test_parts),
        cmocka_unit_test(test_allocations),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

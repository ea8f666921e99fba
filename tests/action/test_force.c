/* Forces of contacts over arrays: the effect of an action on vertices, pairs of groups and records, in closed form. */
#include "action/force.h"
#include "check.h"
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

static double force_on(const fixture *f, int32_t v, int axis)
{
    double force[3];
    pel_contact_force_at(&f->forces.vertex, v, force);
    return force[axis];
}

/* no force if none was added, or none are kept, on any axis */
static void test_untouched(void **unused)
{
    (void)unused;
    fixture f;
    begin(&f);
    for (int axis = 0; axis < 3; axis++)
        for (int32_t v = 0; v < VERTICES; v++)
            assert_near(force_on(&f, v, axis), 0, 0);
    const pel_force_pages none = {0};
    double force[3] = {1, 1, 1};
    pel_contact_force_at(&none, 1, force);
    assert_true(force[0] == 0 && force[1] == 0 && force[2] == 0);
    pel_contact_forces_destroy(&f.forces);
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
        pel_contact_force_at(&f.forces.vertex, v, x);
        pel_vec3_add(sum, x, sum);
    }
    for (int k = 0; k < 3; k++)
        assert_near(sum[k], 0, 0);
    assert_near(force_on(&f, 0, 2), 8, 0);
    assert_near(force_on(&f, PEL_WIDTH, 0), -2, 0);
    assert_near(force_on(&f, PEL_WIDTH + 2, 2), -2, 0);
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
    assert_near(force_on(&f, PEL_WIDTH + 1, 0), 1, 0);
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
        assert_near(force_on(&f, 0, 2), 7, 0);
        assert_near(f.forces.pair[1].load_size, 7, 0);
        assert_int_equal(f.forces.records->last.count, 1);
        assert_near(f.forces.records->last.entries[0].load[2], 7, 0);
    }
    pel_contact_forces_begin(&f.forces);
    pel_contact_forces_accept(&f.forces, 1, true);
    assert_near(force_on(&f, 0, 2), 0, 0);
    assert_int_equal(f.forces.records->last.count, 0);
    pel_contact_forces_destroy(&f.forces);
}

static size_t page_total(const pel_force_pages *pages, int32_t count)
{
    size_t sum = 0;
    for (int32_t p = 0; p < count; p++)
        sum += pages->pages[p] != NULL;
    return sum;
}

/* pages exist for forces only; forces written from outside are read back, and zeros take no page */
static void test_pages(void **unused)
{
    (void)unused;
    enum { PAGES = 5, COUNT = PAGES * PEL_FORCE_PAGE - PEL_WIDTH, LAST = PEL_FORCE_PAGE - PEL_WIDTH };
    static const int32_t one_body[COUNT / PEL_WIDTH];
    const double force[3] = {1, -2, 4};
    pel_record page[PEL_FORCE_PAGE];
    double x[3];
    pel_contact_forces f;
    assert_int_equal(pel_contact_forces_create(COUNT, 1, 0, one_body, &f, NULL), PEL_OK);
    pel_contact_forces_begin(&f);
    pel_contact_force_add(&f, &f.vertex_next, 3 * PEL_FORCE_PAGE + 1, force);
    pel_contact_force_add(&f, &f.vertex_next, 3 * PEL_FORCE_PAGE + 1, force);
    pel_contact_forces_accept(&f, 1, true);
    assert_int_equal(page_total(&f.vertex, PAGES) + page_total(&f.vertex_next, PAGES), 1);
    pel_contact_force_at(&f.vertex, 3 * PEL_FORCE_PAGE + 1, x);
    assert_true(x[0] == 2 && x[1] == -4 && x[2] == 8);
    pel_contact_force_at(&f.vertex, 3 * PEL_FORCE_PAGE, x);
    assert_true(x[0] == 0 && x[1] == 0 && x[2] == 0);
    /* to the last page, which is shorter, and back to zeros */
    pel_contact_forces_read(&f, 3 * PEL_FORCE_PAGE, LAST, page);
    pel_contact_forces_write(&f, 4 * PEL_FORCE_PAGE, LAST, page);
    pel_contact_force_at(&f.vertex, 4 * PEL_FORCE_PAGE + 1, x);
    assert_true(x[0] == 2 && x[1] == -4 && x[2] == 8);
    pel_contact_forces_read(&f, 0, PEL_FORCE_PAGE, page);
    pel_contact_forces_write(&f, PEL_FORCE_PAGE, PEL_FORCE_PAGE, page);
    pel_contact_forces_write(&f, 3 * PEL_FORCE_PAGE, PEL_FORCE_PAGE, page);
    assert_int_equal(page_total(&f.vertex, PAGES), 2);
    pel_contact_force_at(&f.vertex, 3 * PEL_FORCE_PAGE + 1, x);
    assert_true(x[0] == 0 && x[1] == 0 && x[2] == 0);
    pel_contact_forces_destroy(&f);
}

/* a force for which there is no memory is told; obstacles have theirs from the start */
static void test_short(void **unused)
{
    (void)unused;
    const double force[3] = {1, 0, 0};
    for (int32_t obstacles = 0; obstacles < 2; obstacles++) {
        pel_contact_forces f;
        assert_int_equal(pel_contact_forces_create(VERTICES, 2, obstacles, body_of_slice, &f, NULL), PEL_OK);
        pel_contact_forces_begin(&f);
        failing_malloc_begin(1);
        pel_contact_force_add(&f, &f.vertex_next, 0, force);
        assert_int_equal(failing_malloc_end().calls, obstacles == 0);
        assert_int_equal(f.is_short, obstacles == 0);
        pel_contact_forces_destroy(&f);
    }
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
    assert_int_equal(for_every_allocation_failure(create_case, NULL), 9);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_untouched),   cmocka_unit_test(test_between_bodies), cmocka_unit_test(test_obstacle),
        cmocka_unit_test(test_parts),       cmocka_unit_test(test_pages),          cmocka_unit_test(test_short),
        cmocka_unit_test(test_allocations),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* What a search finds, beside a look at every triangle. */
#include "failing_malloc.h"
#include "random.h"
#include "sim/refine_fixture.h"
#include "stage/stage.h"
#include "tool/search.h"

typedef struct scene {
    bench made;
    pel_tool_search *search;
    random_state random;
} scene;

static scene make_scene(int32_t levels)
{
    pel_mesh *mesh = make_sphere(8);
    pel_body_def body = ball(mesh, levels);
    pel_sim_def def = pel_sim_def_default();
    scene s = {.made = begin(mesh, &body, &def), .random = {13}};
    assert_int_equal(pel_tool_search_create(s.made.sim->model, &s.search, NULL), PEL_OK);
    return s;
}

static void free_scene(scene *s)
{
    pel_tool_search_destroy(s->search);
    end(&s->made);
}

static bool reaches(const pel_model *model, const pel_record *x, int32_t t, const pel_search_box *box)
{
    for (int i = 0; i < 3; i++) {
        int below = 0, above = 0;
        for (int c = 0; c < 3; c++) {
            below += x[model->triangles[t][c]][i] < box->low[i];
            above += x[model->triangles[t][c]][i] > box->high[i];
        }
        if (below == 3 || above == 3)
            return false;
    }
    return true;
}

/* boxes of all sizes at random places; returns how many triangles were found in all */
static int64_t compare(scene *s, const pel_record *x)
{
    const pel_model *model = s->made.sim->model;
    int32_t *found = malloc((size_t)model->triangle_begin[1] * sizeof *found);
    uint8_t *expected = calloc((size_t)model->triangle_begin[1], 1);
    int64_t total = 0;
    pel_tool_search_fit(s->search, x, random_integer(&s->random, 0, 1) == 0);
    for (int round = 0; round < 30; round++) {
        pel_search_box box = {{0}, {0}};
        double size = pow(10, random_between(&s->random, -3, 0.3));
        for (int i = 0; i < 3; i++) {
            double middle = random_between(&s->random, -1, 1);
            box.low[i] = (pel_real)(middle - size * random_between(&s->random, 0, 1));
            box.high[i] = (pel_real)(middle + size * random_between(&s->random, 0, 1));
        }
        int32_t count = pel_tool_search_find(s->search, 0, &box, found, 0), expected_count = 0;
        pel_tool_search_sort(s->search, found, count);
        for (int32_t i = 0; i < pel_surface_count(model, 0); i++) {
            int32_t t = pel_surface_triangle(model, 0, i);
            expected[t] = reaches(model, x, t, &box);
            expected_count += expected[t];
        }
        assert_int_equal(count, expected_count);
        for (int32_t i = 0; i < count; i++) {
            assert_true(expected[found[i]]);
            assert_true(i == 0 || found[i] > found[i - 1]);
        }
        total += count;
    }
    free(found);
    free(expected);
    return total;
}

/* moves all vertices about, some of them far, so that triangles are long */
static void move(scene *s)
{
    pel_state *state = s->made.sim->state;
    for (int32_t v = 0; v < s->made.sim->model->vertex_count; v++)
        for (int c = 0; c < 3; c++) {
            double far = random_between(&s->random, 0, 1) < 0.02 ? 1 : 0.1;
            state->position[v][c] += (pel_real)(far * random_between(&s->random, -1, 1));
        }
}

static void test_plain(void **unused)
{
    (void)unused;
    scene s = make_scene(0);
    assert_true(compare(&s, s.made.sim->state->position) > 100);
    move(&s);
    assert_true(compare(&s, s.made.sim->state->position) > 100);
    free_scene(&s);
}

/* through events of refinement, with vertices that come, go and come in other places */
static void test_events(void **unused)
{
    (void)unused;
    scene s = make_scene(3);
    pel_front *front = s.made.sim->active->bodies[0].front;
    int32_t vertex_count = s.made.mesh->vertex_count;
    int64_t total = 0;
    for (int round = 0; round < ROUNDS(60, 15); round++) {
        for (int n = 0; n < 4; n++)
            pel_front_mark_vertex(front, (int32_t)random_integer(&s.random, 0, vertex_count - 1),
                                  (int32_t)random_integer(&s.random, 1, 3), random_integer(&s.random, 0, 2) > 0);
        pel_front_close(front);
        pel_refined_commit(s.made.sim->active, 0, s.made.sim->state);
        pel_tool_search_update(s.search, 0);
        if (round % 10 == 0)
            move(&s);
        total += compare(&s, s.made.sim->state->position);
    }
    assert_true(total > 10000 && front->red_count > 0);
    pel_tool_search_rebuild(s.search, 0);
    compare(&s, s.made.sim->state->position);
    free_scene(&s);
}

/* lists of a good part of all triangles are sorted as a set, other long ones by digits, short ones by comparisons */
static void test_sort(void **unused)
{
    (void)unused;
    scene s = make_scene(3);
    int32_t limit = s.made.sim->model->triangle_begin[1], numbers[3000];
    for (int32_t count = 0; count <= 3000; count = 3 * count + 1) {
        int64_t sum = 0;
        /* none twice */
        if (count > limit)
            break;
        for (int32_t i = 0, t = 0; i < count; t++)
            if (random_integer(&s.random, 1, limit - t) <= count - i)
                sum += numbers[i++] = t;
        for (int32_t i = count - 1; i > 0; i--) {
            int32_t other = (int32_t)random_integer(&s.random, 0, i), t = numbers[i];
            numbers[i] = numbers[other];
            numbers[other] = t;
        }
        pel_tool_search_sort(s.search, numbers, count);
        for (int32_t i = 0; i < count; i++) {
            assert_true(i == 0 || numbers[i] >= numbers[i - 1]);
            sum -= numbers[i];
        }
        assert_int_equal(sum, 0);
    }
    free_scene(&s);
}

static pel_status create_search(const void *model, pel_error *error)
{
    pel_tool_search *search;
    pel_status status = pel_tool_search_create(model, &search, error);
    assert_true((search == NULL) == (status != PEL_OK));
    pel_tool_search_destroy(search);
    return status;
}

static void test_allocations(void **unused)
{
    (void)unused;
    scene s = make_scene(1);
    assert_true(for_every_allocation_failure(create_search, s.made.sim->model) > 8);
    /* bodies without tools have no search */
    pel_tool_search_update(NULL, 0);
    pel_tool_search_rebuild(NULL, 0);
    free_scene(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_plain),
        cmocka_unit_test(test_events),
        cmocka_unit_test(test_sort),
        cmocka_unit_test(test_allocations),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

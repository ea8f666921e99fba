/* Records of contacts against a list that is searched from its start. */
#include "action/force.h"
#include "check.h"
#include "failing_malloc.h"
#include "random.h"

enum { KEYS = 3000, ACTIONS = 3000 };

typedef struct plain_list {
    pel_contact_entry entries[KEYS];
    size_t count;
} plain_list;

static pel_contact_entry *find_plain(plain_list *list, const int32_t vertices[4], int32_t obstacle)
{
    for (size_t i = 0; i < list->count; i++)
        if (memcmp(list->entries[i].vertices, vertices, sizeof list->entries[i].vertices) == 0 &&
            list->entries[i].obstacle == obstacle)
            return &list->entries[i];
    assert_true(list->count < KEYS);
    pel_contact_entry *fresh = &list->entries[list->count++];
    *fresh = (pel_contact_entry){.obstacle = obstacle};
    memcpy(fresh->vertices, vertices, sizeof fresh->vertices);
    return fresh;
}

/* the same action on the plain list; an obstacle's forces are those on the body */
static void add_plain(plain_list *list, const pel_contact_action *action, double share)
{
    double size = sqrt(action->force[0] * action->force[0] + action->force[1] * action->force[1] +
                       action->force[2] * action->force[2]);
    double side = action->weights[0] + action->weights[1] + action->weights[2] + action->weights[3];
    double sign = action->obstacle >= 0 && side < 0 ? -1 : 1;
    int32_t vertices[4];
    for (int i = 0; i < 4; i++)
        vertices[i] = action->weights[i] != 0 ? action->vertices[i] : -1;
    if (size == 0)
        return;
    pel_contact_entry *entry = find_plain(list, vertices, action->obstacle);
    entry->size += share * size;
    for (int i = 0; i < 4; i++)
        entry->weights[i] += share * sign * size * action->weights[i];
    for (int k = 0; k < 3; k++) {
        entry->force[k] += share * sign * action->force[k];
        entry->load[k] += share * sign * action->load[k];
    }
}

static void check_equal(const pel_contact_table *table, const plain_list *list)
{
    assert_false(table->is_short);
    assert_int_equal(table->count, list->count);
    for (size_t i = 0; i < list->count; i++) {
        const pel_contact_entry *a = &table->entries[i], *b = &list->entries[i];
        assert_memory_equal(a->vertices, b->vertices, sizeof a->vertices);
        assert_int_equal(a->obstacle, b->obstacle);
        assert_near(a->size, b->size, 1e-12 * b->size);
        for (int k = 0; k < 4; k++)
            assert_near(a->weights[k], b->weights[k], 1e-12 * b->size);
        for (int k = 0; k < 3; k++) {
            assert_near(a->force[k], b->force[k], 1e-12 * b->size);
            assert_near(a->load[k], b->load[k], 1e-12 * b->size);
        }
    }
}

/* a pair of features of few vertices, so that it comes again; now and then without force */
static pel_contact_action random_action(random_state *random, int32_t vertices[4])
{
    static const double weights[][4] = {{1, -0.5, -0.25, -0.25}, {1, -0.5, -0.5, 0}, {-1, 0, 0, 0}, {0.5, 0.5, 0, 0}};
    pel_contact_action action = {.vertices = vertices, .obstacle = (int32_t)random_integer(random, -1, 1)};
    for (int i = 0; i < 4; i++)
        vertices[i] = (int32_t)random_integer(random, 0, 3) + 4 * i;
    memcpy(action.weights, weights[random_integer(random, 0, 3)], sizeof action.weights);
    double size = random_integer(random, 0, 9) > 0;
    for (int k = 0; k < 3; k++) {
        action.force[k] = size * random_between(random, -1, 1);
        action.load[k] = 0.5 * action.force[k];
    }
    return action;
}

static void test_against_list(void **unused)
{
    (void)unused;
    static plain_list last, next;
    static pel_contact_action actions[ACTIONS];
    static int32_t vertices[ACTIONS][4];
    random_state random = {11};
    pel_contact_forces forces = {0};
    failing_malloc_begin(0);
    assert_int_equal(pel_contact_records_create(&forces, NULL), PEL_OK);
    /* steps of two parts; the second one is smaller, so that a table is cleared that was larger */
    for (int step = 0; step < 2; step++) {
        last.count = 0;
        for (int part = 0; part < 2; part++) {
            const double share = part == 0 ? 0.25 : 0.75;
            int count = step == 0 ? ACTIONS : 40;
            next.count = 0;
            pel_contact_records_begin(&forces);
            for (int i = 0; i < count; i++) {
                actions[i] = random_action(&random, vertices[i]);
                add_plain(&next, &actions[i], 1);
                pel_contact_records_add(&forces, &actions[i]);
            }
            check_equal(&forces.records->next, &next);
            assert_true(step > 0 || next.count > 500);
            for (size_t i = 0; i < next.count; i++) {
                const pel_contact_entry *from = &next.entries[i];
                pel_contact_entry *to = find_plain(&last, from->vertices, from->obstacle);
                to->size += share * from->size;
                for (int k = 0; k < 4; k++)
                    to->weights[k] += share * from->weights[k];
                for (int k = 0; k < 3; k++) {
                    to->force[k] += share * from->force[k];
                    to->load[k] += share * from->load[k];
                }
            }
            pel_contact_records_accept(&forces, share, part == 0);
            check_equal(&forces.records->last, &last);
        }
    }
    pel_contact_records_forget(&forces);
    assert_int_equal(forces.records->last.count, 0);
    assert_true(forces.records->next.count > 0);
    pel_contact_records_destroy(&forces);
    assert_int_equal(failing_malloc_end().live, 0);
}

/* without memory a record is missing, which is told until the next step; those that are there stay right */
static void test_short(void **unused)
{
    (void)unused;
    for (int call = 1; call <= 2; call++) {
        pel_contact_forces forces = {0};
        const int32_t vertices[4] = {0, 1, 2, 3};
        const pel_contact_action action = {
            .vertices = vertices, .weights = {1, -1, 0, 0}, .force = {0, 0, 2}, .obstacle = -1};
        assert_int_equal(pel_contact_records_create(&forces, NULL), PEL_OK);
        pel_contact_records_begin(&forces);
        failing_malloc_begin(call);
        pel_contact_records_add(&forces, &action);
        failing_malloc_end();
        assert_true(forces.records->next.is_short && forces.records->next.count == 0);
        pel_contact_records_accept(&forces, 1, true);
        assert_true(forces.records->last.is_short && forces.records->last.count == 0);
        pel_contact_records_begin(&forces);
        assert_false(forces.records->next.is_short);
        pel_contact_records_add(&forces, &action);
        pel_contact_records_accept(&forces, 1, true);
        assert_true(!forces.records->last.is_short && forces.records->last.count == 1);
        assert_near(forces.records->last.entries[0].force[2], 2, 0);
        pel_contact_records_destroy(&forces);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_against_list), cmocka_unit_test(test_short)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

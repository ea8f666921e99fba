/* Sound sets of contacts pass; a set with one number changed does not. */
#include "set_fixture.h"

static void refuse(const pel_contact_set *set)
{
    assert_false(pel_contact_set_is_valid(set));
}

static void damage_keys(pel_contact_set *set, int32_t c)
{
    pel_contact_key *key = &set->keys[c], kept = *key;
    for (int i = 0; i < 4; i++) {
        key->points[i] = -1;
        refuse(set);
        key->points[i] = set->point_count;
        refuse(set);
        *key = kept;
    }
    key->obstacle = set->def.obstacle_count;
    refuse(set);
    key->obstacle = -2;
    refuse(set);
    *key = kept;
}

static void damage_contact(pel_contact_set *set, int32_t c)
{
    pel_contact *contact = &set->list.contacts[c], kept = *contact;
    for (int i = 0; i < 4; i++) {
        contact->vertices[i] = set->vertex_count;
        refuse(set);
        contact->vertices[i] = -1;
        refuse(set);
        *contact = kept;
        if (set->keys[c].obstacle < 0 || set->keys[c].points[i] >= set->vertex_count) {
            contact->weights[i] += (pel_real)0.1;
            refuse(set);
        }
        *contact = kept;
    }
    for (int k = 0; k < 3; k++)
        contact->normal[k] *= 2;
    refuse(set);
    *contact = kept;
    contact->friction = -1;
    refuse(set);
    *contact = kept;
}

static void test_damage(void **unused)
{
    (void)unused;
    static arrays a;
    make_sheets(&a, 3, 7, 6, 0.025, 0.01);
    const pel_obstacle box = {.solid = {.shape = PEL_TOOL_BOX, .half_extents = {0.2, 0.2, 0.01}},
                              .presses = true,
                              .body = -1,
                              .before = pose_at(0.5, 0.5, 0.06),
                              .pose = pose_at(0.5, 0.5, 0.06)};
    add_obstacle(&a, &box, 0.2);
    pel_contact_set *set = create(&a);
    assert_true(pel_contact_set_is_valid(set));
    assert_int_equal(pel_contact_set_find(set, 0, 0.01, NULL), PEL_OK);
    assert_true(pel_contact_set_is_valid(set));
    int32_t count = set->list.count, with_obstacle = 0;
    assert_true(count > 20);
    for (int32_t c = 0; c < count; c++) {
        with_obstacle += set->keys[c].obstacle >= 0;
        damage_keys(set, c);
        damage_contact(set, c);
    }
    assert_true(with_obstacle > 0 && with_obstacle < count);
    /* out of order, and twice */
    pel_contact_key first = set->keys[0];
    set->keys[0] = set->keys[1];
    refuse(set);
    set->keys[1] = first;
    refuse(set);
    set->keys[1] = set->keys[0];
    set->keys[0] = first;
    assert_true(pel_contact_set_is_valid(set));
    set->list.count = set->def.limit + 1;
    refuse(set);
    set->list.count = -1;
    refuse(set);
    set->list.count = count;
    set->group_of_point[0] = set->def.body_count;
    refuse(set);
    set->group_of_point[0] = 0;
    set->groups[1].thickness = 0;
    refuse(set);
    set->groups[1].thickness = THICKNESS;
    assert_true(pel_contact_set_is_valid(set));
    pel_contact_set_destroy(set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_damage)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

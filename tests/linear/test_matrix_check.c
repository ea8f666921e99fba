/* Sound patterns pass; a pattern with any one number changed does not. */
#include "system.h"

static void damage(const pel_matrix *m, int32_t *numbers, int32_t count)
{
    for (int32_t i = 0; i < count; i++) {
        int32_t kept = numbers[i];
        const int32_t others[4] = {kept + 1, kept - 1, INT32_MAX, -2};
        for (int k = 0; k < 4; k++) {
            numbers[i] = others[k];
            assert_false(pel_matrix_is_valid(m));
        }
        numbers[i] = kept;
    }
    assert_true(pel_matrix_is_valid(m));
}

static void test_damage(void **unused)
{
    (void)unused;
    random_state random = {4};
    test_system s = test_random_system(30, 60, &random);
    pel_matrix *m = test_matrix(&s, 0, NULL);
    assert_true(pel_matrix_is_valid(m));
    damage(m, m->first_unknown, m->node_count + 1);
    damage(m, m->row_start, m->node_count + 1);
    damage(m, m->column, m->block_count);
    damage(m, m->block_start, m->block_count + 1);
    damage(m, m->element_start, m->element_count + 1);
    damage(m, m->node_start, m->element_count + 1);
    damage(m, m->element_place, m->element_start[m->element_count]);
    damage(m, m->ordered, m->element_count);
    /* within a color the bounds of pieces may lie elsewhere */
    damage(m, m->color_start, 1);
    damage(m, &m->color_start[m->color_count], 1);
    damage(m, m->piece_start, 1);
    damage(m, &m->piece_start[m->piece_count], 1);
    damage(m, m->group_start, 1);
    damage(m, &m->group_start[m->group_count], 1);
    pel_matrix_destroy(m);
    test_system_release(&s);
}

/* two elements of one node cannot run at once: pieces of one color would share it */
static void test_colors(void **unused)
{
    (void)unused;
    random_state random = {5};
    enum { COUNT = 200 };
    test_system s = test_system_make(COUNT + 1, COUNT, 3, &random);
    for (int32_t e = 0; e < COUNT; e++)
        test_add_element(&s, (int32_t[]){0, e + 1}, 2, 0);
    test_fill_blocks(&s, &random);
    pel_matrix *m = test_matrix(&s, 0, NULL);
    assert_true(pel_matrix_is_valid(m) && m->color_count > 1);
    int32_t kept = m->color_count;
    m->color_count = 1;
    m->color_start[1] = m->piece_count;
    assert_false(pel_matrix_is_valid(m));
    m->color_count = kept;
    pel_matrix_destroy(m);
    test_system_release(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_damage), cmocka_unit_test(test_colors)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

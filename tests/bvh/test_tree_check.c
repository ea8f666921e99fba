/* Sound trees pass; a tree with any one number changed does not. */
#include "sample.h"

static void damage_words(const pel_tree *tree, int32_t *numbers, int32_t count)
{
    for (int32_t i = 0; i < count; i++) {
        int32_t kept = numbers[i];
        const int32_t others[4] = {kept + 1, kept - 1, INT32_MAX, -2};
        for (int k = 0; k < 4; k++) {
            numbers[i] = others[k];
            assert_false(pel_tree_is_valid(tree));
        }
        numbers[i] = kept;
    }
    assert_true(pel_tree_is_valid(tree));
}

static void test_structure(void **unused)
{
    (void)unused;
    surface s = make_soup(37, 0.3, 5);
    pel_tree *tree;
    assert_int_equal(pel_tree_create((const double(*)[3])s.start, s.vertex_count, (const int32_t(*)[3])s.triangles,
                                     s.triangle_count, PEL_TREE_FEATURES, &tree, NULL),
                     PEL_OK);
    assert_true(pel_tree_is_valid(tree));
    damage_words(tree, tree->leaves[0], PEL_LANES * tree->leaf_count);
    damage_words(tree, tree->next_in_edge, 3 * tree->triangle_count);
    damage_words(tree, &tree->leaf_count, 1);
    damage_words(tree, &tree->node_count, 1);
    for (int32_t t = 0; t < tree->triangle_count; t++)
        for (int bit = 0; bit < 6; bit++) {
            tree->features[t] = (uint8_t)(tree->features[t] ^ 1 << bit);
            assert_false(pel_tree_is_valid(tree));
            tree->features[t] = (uint8_t)(tree->features[t] ^ 1 << bit);
        }
    assert_true(pel_tree_is_valid(tree));
    pel_tree_destroy(tree);
    free_surface(&s);
}

/* each side of each box is that of something below it: moved inward, the node no longer contains it */
static void test_boxes(void **unused)
{
    (void)unused;
    surface s = make_soup(100, 0.3, 6);
    pel_tree *tree;
    pel_box *boxes = calloc((size_t)s.vertex_count, sizeof *boxes);
    for (int32_t v = 0; v < s.vertex_count; v++)
        for (int k = 0; k < 3; k++)
            boxes[v].low[k] = boxes[v].high[k] = (float)s.start[v][k];
    assert_int_equal(pel_tree_create((const double(*)[3])s.start, s.vertex_count, (const int32_t(*)[3])s.triangles,
                                     s.triangle_count, PEL_TREE_TRIANGLES, &tree, NULL),
                     PEL_OK);
    pel_tree_refit(tree, boxes, NULL);
    assert_true(pel_tree_is_valid(tree));
    for (int32_t n = 0; n < tree->node_count; n++)
        for (int k = 0; k < 3; k++) {
            pel_box kept = tree->nodes[n];
            tree->nodes[n].low[k] += 1e-3f;
            assert_false(pel_tree_is_valid(tree));
            tree->nodes[n] = kept;
            tree->nodes[n].high[k] -= 1e-3f;
            assert_false(pel_tree_is_valid(tree));
            tree->nodes[n] = kept;
        }
    assert_true(pel_tree_is_valid(tree));
    pel_tree_destroy(tree);
    free(boxes);
    free_surface(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_structure), cmocka_unit_test(test_boxes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

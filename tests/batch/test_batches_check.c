/* Sound layouts pass; a layout with any one number changed does not. */
#include "shell_fixture.h"

#include "batch/batches.h"

static pel_body_def body_of(const pel_mesh *mesh)
{
    pel_body_def body = shell_body(mesh, PEL_MEMBRANE_STVK);
    body.shell.bending.model = PEL_BENDING_HINGE;
    return body;
}

static void damage(const pel_batches *batches, int32_t *numbers, int32_t count, const int32_t changes[3])
{
    for (int32_t i = 0; i < count; i++) {
        int32_t kept = numbers[i];
        for (int k = 0; k < 3; k++) {
            numbers[i] = kept + changes[k];
            assert_false(pel_batches_is_valid(batches));
        }
        numbers[i] = kept;
    }
    assert_true(pel_batches_is_valid(batches));
}

static void damage_bytes(const pel_batches *batches, uint8_t *numbers, int32_t count, uint8_t other)
{
    for (int32_t i = 0; i < count; i++) {
        uint8_t kept = numbers[i];
        numbers[i] = other;
        assert_false(pel_batches_is_valid(batches));
        numbers[i] = kept;
    }
}

/* out of the body, between two places, and before the first */
static const int32_t steps_away[3] = {1 << 20, 1, -(1 << 20)};
static const int32_t starts_away[3] = {1, -1, 1 << 20};

static void test_damage(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(11);
    pel_body_def body = body_of(mesh);
    pel_model *model = make_model(&body);
    pel_batches *batches;
    assert_int_equal(pel_batches_create(model, PEL_METHOD_PBD, &batches, NULL), PEL_OK);
    assert_true(pel_batches_is_valid(batches));
    pel_body_batches *own = &batches->bodies[0];
    int32_t bundles = pel_bundle_count(&own->pieces);
    assert_int_equal(bundles, 4);
    for (int32_t b = 0; b < own->batch_count; b++) {
        pel_batch *batch = &own->batches[b];
        damage(batches, batch->steps, 100, steps_away);
        damage(batches, batch->bundle_begin, 1, starts_away);
        damage(batches, &batch->bundle_begin[bundles], 1, starts_away);
        damage(batches, &batch->block_count, 1, starts_away);
        damage_bytes(batches, batch->lane_counts, batch->block_count, 0);
        damage_bytes(batches, batch->lane_counts, batch->block_count, PEL_BLOCK + 1);
        damage_bytes(batches, batch->followers, batch->block_count, PEL_BATCH_GROUP);
    }
    damage(batches, batches->phase_begin, 1, starts_away);
    damage(batches, &batches->phase_begin[PEL_PHASE_COUNT], 1, starts_away);
    damage(batches, own->pieces.piece_of_place, 20, (int32_t[3]){-1 - INT16_MAX, INT16_MAX, 1 << 20});
    for (int32_t n = 0; n < batches->phase_begin[PEL_PHASE_COUNT]; n++) {
        batches->bundles[n].number += 4;
        assert_false(pel_batches_is_valid(batches));
        batches->bundles[n].number -= 4;
        batches->bundles[n].body = 1;
        assert_false(pel_batches_is_valid(batches));
        batches->bundles[n].body = 0;
    }
    /* a seam beside the pieces that it joins */
    batches->phase_begin[1]++;
    assert_false(pel_batches_is_valid(batches));
    batches->phase_begin[1]--;
    /* a vertex of a block comes again in the same group */
    pel_batch *batch = &own->batches[0];
    int32_t kept = batch->steps[0];
    batch->steps[0] = batch->steps[PEL_BLOCK + 1];
    assert_false(pel_batches_is_valid(batches));
    batch->steps[0] = kept;
    assert_true(pel_batches_is_valid(batches));
    pel_batches_destroy(batches);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_damage)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

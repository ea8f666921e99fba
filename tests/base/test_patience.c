/* Allocations of a thread without patience fail, and say that they were stopped; those of others do not. */
#include "check.h"

#include "base/memory.h"
#include "base/patience.h"
#include "base/pool.h"
#include "base/status.h"

#include <pthread.h>

static int asked, last;

static bool is_wanted(void *user)
{
    return user == &asked && asked++ < last;
}

static void *allocate_elsewhere(void *unused)
{
    (void)unused;
    void *block = pel_allocate(1, 8);
    pel_free(block);
    return block != NULL ? &asked : NULL;
}

static void test_allocations(void **unused)
{
    (void)unused;
    pel_error error;
    void *whole = NULL, *kept = pel_allocate(4, 1);
    pthread_t thread;
    asked = 0;
    last = 2;
    pel_patience_begin(is_wanted, &asked);
    for (int i = 0; i < last; i++) {
        void *block = pel_allocate(1, 8);
        assert_non_null(block);
        pel_free(block);
    }
    assert_null(pel_allocate(1, 8));
    assert_null(pel_allocate_aligned(1, 8));
    assert_null(pel_reallocate(kept, 8, 1));
    /* a no sticks, and is asked for once */
    assert_int_equal(asked, 3);
    assert_int_equal(pel_fail_memory(&error), PEL_STOPPED);
    assert_true(pel_pool_is_stopped(NULL));
    assert_int_equal(pthread_create(&thread, NULL, allocate_elsewhere, NULL), 0);
    assert_int_equal(pthread_join(thread, &whole), 0);
    assert_non_null(whole);
    assert_true(pel_patience_end());
    assert_false(pel_patience_end());
    assert_int_equal(pel_fail_memory(&error), PEL_OUT_OF_MEMORY);
    assert_false(pel_pool_is_stopped(NULL));
    pel_free(kept);
    kept = pel_allocate(1, 1);
    assert_non_null(kept);
    pel_free(kept);
}

static void count_chunk(void *context, int32_t chunk)
{
    ((int *)context)[chunk]++;
}

/* a pool is stopped in the thread that runs it; its loop is whole */
static void test_pool(void **unused)
{
    (void)unused;
    for (int threads = 1; threads <= 2; threads++) {
        int done[8] = {0};
        pel_pool *pool = NULL;
        assert_int_equal(pel_pool_create(threads, &pool, NULL), PEL_OK);
        asked = last = 0;
        pel_patience_begin(is_wanted, &asked);
        pel_pool_run(pool, 8, count_chunk, done);
        assert_true(pel_pool_is_stopped(pool) || threads == 2);
        assert_true(pel_patience_end() || threads == 2);
        for (int i = 0; i < 8; i++)
            assert_int_equal(done[i], 1);
        pel_pool_watch(pool, NULL, NULL);
        assert_false(pel_pool_is_stopped(pool));
        pel_pool_destroy(pool);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_allocations), cmocka_unit_test(test_pool)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

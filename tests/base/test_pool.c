/* Every chunk runs exactly once, for any number of threads and any interval between loops. */
#include "check.h"
#include "failing_malloc.h"

#include "base/pool.h"
#include "pellicle/parallel.h"

#include <pthread.h>
#include <stdatomic.h>
#include <time.h>

enum { CHUNK_LIMIT = 300 };

typedef struct counted {
    int runs[CHUNK_LIMIT];
    int base;
} counted;

static void count_chunk(void *context, int32_t chunk)
{
    counted *c = context;
    c->runs[chunk] += 1 + c->base;
}

static void check_loops(pel_pool *pool, int loop_count)
{
    counted c;
    for (int loop = 0; loop < loop_count; loop++) {
        int32_t chunk_count = loop % CHUNK_LIMIT;
        memset(&c, 0, sizeof c);
        c.base = loop;
        pel_pool_run(pool, chunk_count, count_chunk, &c);
        for (int32_t chunk = 0; chunk < CHUNK_LIMIT; chunk++)
            assert_int_equal(c.runs[chunk], chunk < chunk_count ? 1 + loop : 0);
    }
}

static void test_each_chunk_once(void **unused)
{
    (void)unused;
    check_loops(NULL, 20);
    for (int threads = 1; threads <= 8; threads *= 2) {
        pel_pool *pool;
        assert_int_equal(pel_pool_create(threads, &pool, NULL), PEL_OK);
        check_loops(pool, 3000);
        pel_pool_destroy(pool);
    }
}

typedef struct meeting {
    atomic_int arrived;
    int wanted;
    bool missed;
} meeting;

/* each chunk waits for all others */
static void meet(void *context, int32_t chunk)
{
    meeting *m = context;
    (void)chunk;
    atomic_fetch_add(&m->arrived, 1);
    for (int i = 0; i < 60000 && atomic_load(&m->arrived) < m->wanted; i++)
        nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
    if (atomic_load(&m->arrived) < m->wanted)
        m->missed = true;
}

/* as many chunks as threads run at once, from two on */
static void test_at_once(void **unused)
{
    (void)unused;
    for (int threads = 2; threads <= 5; threads++) {
        pel_pool *pool;
        assert_int_equal(pel_pool_create(threads, &pool, NULL), PEL_OK);
        for (int wanted = 2; wanted <= threads; wanted++) {
            meeting m = {.wanted = wanted};
            pel_pool_run(pool, wanted, meet, &m);
            assert_int_equal(atomic_load(&m.arrived), wanted);
            assert_false(m.missed);
        }
        pel_pool_destroy(pool);
    }
}

/* helpers that went to sleep between loops wake again */
static void test_after_sleep(void **unused)
{
    (void)unused;
    pel_pool *pool;
    assert_int_equal(pel_pool_create(3, &pool, NULL), PEL_OK);
    for (int n = 0; n < 20; n++) {
        nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
        check_loops(pool, 5);
    }
    pel_pool_destroy(pool);
}

/* s of processor time of all threads */
static double used(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* threads that wait for work for long use no processor */
static void test_idle(void **unused)
{
    (void)unused;
    pel_pool *pool;
    assert_int_equal(pel_pool_create(4, &pool, NULL), PEL_OK);
    check_loops(pool, 3);
    nanosleep(&(struct timespec){.tv_nsec = 50000000}, NULL);
    double before = used();
    nanosleep(&(struct timespec){.tv_nsec = 200000000}, NULL);
    assert_true(used() - before < 0.02);
    pel_pool_destroy(pool);
}

static pel_status create_pool(const void *data, pel_error *error)
{
    (void)data;
    pel_pool *pool;
    pel_status status = pel_pool_create(1, &pool, error);
    assert_true((pool == NULL) == (status != PEL_OK));
    pel_pool_destroy(pool);
    return status;
}

static void test_allocation_failure(void **unused)
{
    (void)unused;
    assert_int_equal(for_every_allocation_failure(create_pool, NULL), 1);
    assert_true(pel_thread_limit() >= 1);
}

static bool is_wanted(void *user)
{
    int *left = user;
    return (*left)-- > 0;
}

static void count_one(void *context, int32_t chunk)
{
    (void)chunk;
    atomic_fetch_add((atomic_int *)context, 1);
}

/* the calling thread asks until the answer is no; all chunks run all the same */
static void test_stop(void **unused)
{
    (void)unused;
    for (int threads = 1; threads <= 3; threads++) {
        pel_pool *pool;
        atomic_int count = 0;
        int left = 5;
        pel_error error;
        assert_int_equal(pel_pool_create(threads, &pool, NULL), PEL_OK);
        pel_pool_watch(pool, is_wanted, &left);
        for (int i = 0; i < 100; i++) {
            assert_int_equal(pel_pool_is_stopped(pool), left < 0);
            assert_int_equal(pel_pool_check(pool, &error), left < 0 ? PEL_STOPPED : PEL_OK);
            pel_pool_run(pool, 1, count_one, &count);
        }
        pel_pool_run(pool, 1000, count_one, &count);
        assert_int_equal(left, -1);
        assert_int_equal(count, 1100);
        assert_true(pel_pool_is_stopped(pool));
        pel_pool_watch(pool, NULL, NULL);
        assert_false(pel_pool_is_stopped(pool));
        pel_pool_destroy(pool);
    }
    pel_pool_watch(NULL, is_wanted, NULL);
    assert_false(pel_pool_is_stopped(NULL));
}

typedef struct long_chunk {
    pel_pool *pool;
    pthread_t caller;
    atomic_int looks, heard; /* by the calling thread */
} long_chunk;

/* a chunk that looks until it hears the answer, or a thousand times */
static void look(void *context, int32_t chunk)
{
    (void)chunk;
    long_chunk *c = context;
    bool is_caller = pthread_equal(pthread_self(), c->caller);
    for (int i = 0; i < 1000 && !pel_pool_is_stopped_now(c->pool); i++)
        if (is_caller)
            atomic_fetch_add(&c->looks, 1);
    if (is_caller)
        atomic_fetch_add(&c->heard, pel_pool_is_stopped(c->pool));
}

/* long chunks are stopped on their way: the calling thread asks within them, and no other one does */
static void test_stop_within(void **unused)
{
    (void)unused;
    for (int threads = 1; threads <= 3; threads++) {
        long_chunk c = {.caller = pthread_self()};
        int left = 5;
        assert_int_equal(pel_pool_create(threads, &c.pool, NULL), PEL_OK);
        pel_pool_watch(c.pool, is_wanted, &left);
        pel_pool_run(c.pool, 1, look, &c);
        assert_int_equal(c.looks, 5);
        assert_int_equal(c.heard, 1);
        assert_int_equal(left, -1);
        pel_pool_destroy(c.pool);
    }
    assert_false(pel_pool_is_stopped_now(NULL));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_each_chunk_once),    cmocka_unit_test(test_at_once), cmocka_unit_test(test_idle),
        cmocka_unit_test(test_after_sleep),        cmocka_unit_test(test_stop),    cmocka_unit_test(test_stop_within),
        cmocka_unit_test(test_allocation_failure),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

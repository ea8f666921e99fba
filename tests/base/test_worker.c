/* Jobs are done once each, in order, and a slot is not reused while its job runs. */
#include "check.h"
#include "failing_malloc.h"

#include "base/worker.h"

#include <time.h>

enum { SLOTS_MAX = 4, JOBS = 2000 };

typedef struct journal {
    int slots[SLOTS_MAX]; /* the job of each slot */
    int done[JOBS];       /* in the order they were done */
    int count;
    bool slow;
} journal;

static void note(void *context, int32_t slot)
{
    journal *l = context;
    if (l->slow)
        nanosleep(&(struct timespec){.tv_nsec = 200000}, NULL);
    l->done[l->count++] = l->slots[slot];
}

static void give_jobs(pel_worker *worker, journal *l, int first, int count)
{
    for (int job = first; job < first + count; job++) {
        int32_t slot = pel_worker_claim(worker);
        l->slots[slot] = job;
        pel_worker_give(worker);
    }
}

static void check_order(const journal *l, int count)
{
    assert_int_equal(l->count, count);
    for (int job = 0; job < count; job++)
        assert_int_equal(l->done[job], job);
}

static void test_order(void **unused)
{
    (void)unused;
    for (int32_t slots = 1; slots <= SLOTS_MAX; slots++)
        for (int slow = 0; slow < 2; slow++) {
            journal l = {.slow = slow};
            int jobs = slow ? 30 : JOBS / 2;
            pel_worker *worker;
            assert_int_equal(pel_worker_create(slots, note, &l, &worker, NULL), PEL_OK);
            give_jobs(worker, &l, 0, jobs);
            pel_worker_wait(worker);
            check_order(&l, jobs);
            /* the rest is done before the worker goes */
            give_jobs(worker, &l, jobs, jobs);
            pel_worker_destroy(worker);
            check_order(&l, 2 * jobs);
        }
}

static void test_idle(void **unused)
{
    (void)unused;
    journal l = {0};
    pel_worker *worker;
    assert_int_equal(pel_worker_create(2, note, &l, &worker, NULL), PEL_OK);
    pel_worker_wait(worker);
    assert_int_equal(pel_worker_claim(worker), 0);
    assert_int_equal(pel_worker_claim(worker), 0);
    pel_worker_destroy(worker);
    assert_int_equal(l.count, 0);
    pel_worker_destroy(NULL);
}

static pel_status create_and_destroy(const void *unused, pel_error *error)
{
    (void)unused;
    journal l = {0};
    pel_worker *worker;
    pel_status status = pel_worker_create(2, note, &l, &worker, error);
    pel_worker_destroy(worker);
    return status;
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    assert_true(for_every_allocation_failure(create_and_destroy, NULL) > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_order),
        cmocka_unit_test(test_idle),
        cmocka_unit_test(test_allocation_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

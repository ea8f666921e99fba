#include "failing_malloc.h"

#include "base/assert.h"
#include "check.h"

#include <malloc.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *block, size_t size);
void *__real_aligned_alloc(size_t alignment, size_t size);
void __real_free(void *block);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *block, size_t size);
void *__wrap_aligned_alloc(size_t alignment, size_t size);
void __wrap_free(void *block);

/* live blocks are kept by address: blocks of a shared library that we free must not count */
enum { LIVE_LIMIT = 1 << 16 };
static atomic_flag busy = ATOMIC_FLAG_INIT;
static atomic_bool counting;
static long fail_at;
static size_t fatal_size;
static allocation_count count;
static uintptr_t live[LIVE_LIMIT];

static void lock(void)
{
    while (atomic_flag_test_and_set(&busy)) {
    }
}

static void unlock(void)
{
    atomic_flag_clear(&busy);
}

/* true when the allocation being asked for has to fail */
static bool must_fail(size_t number, size_t size)
{
    if (fatal_size > 0 && size > 0 && number >= (fatal_size + size - 1) / size)
        raise(SIGALRM);
    if (!atomic_load(&counting) || pel_check_is_running())
        return false;
    lock();
    bool fails = ++count.calls == fail_at;
    count.failed += fails;
    unlock();
    return fails;
}

static void *remember(void *block)
{
    if (block == NULL || !atomic_load(&counting) || pel_check_is_running())
        return block;
    lock();
    if (count.live == LIVE_LIMIT)
        abort();
    live[count.live++] = (uintptr_t)block;
    unlock();
    return block;
}

/* replaces an address by another, or drops it when that is 0; addresses made before counting are not known */
static void move(uintptr_t from, uintptr_t to)
{
    if (!atomic_load(&counting))
        return;
    lock();
    long i = count.live;
    while (i > 0 && live[i - 1] != from)
        i--;
    if (i > 0)
        live[i - 1] = to != 0 ? to : live[--count.live];
    unlock();
}

void *__wrap_malloc(size_t size)
{
    return must_fail(1, size) ? NULL : remember(__real_malloc(size));
}

void *__wrap_calloc(size_t number, size_t size)
{
    return must_fail(number, size) ? NULL : remember(__real_calloc(number, size));
}

void *__wrap_aligned_alloc(size_t alignment, size_t size)
{
    return must_fail(1, size) ? NULL : remember(__real_aligned_alloc(alignment, size));
}

void *__wrap_realloc(void *block, size_t size)
{
    if (must_fail(1, size)) {
        count.failed_shrink = block != NULL && size <= malloc_usable_size(block);
        return NULL;
    }
    uintptr_t old = (uintptr_t)block;
    void *moved = __real_realloc(block, size);
    if (old == 0)
        return remember(moved);
    if (moved != NULL)
        move(old, (uintptr_t)moved);
    return moved;
}

void __wrap_free(void *block)
{
    if (block != NULL)
        move((uintptr_t)block, 0);
    __real_free(block);
}

void failing_malloc_begin(long n)
{
    fail_at = n;
    count = (allocation_count){0};
    atomic_store(&counting, true);
}

allocation_count failing_malloc_end(void)
{
    atomic_store(&counting, false);
    return count;
}

void failing_malloc_ends_at(size_t size)
{
    fatal_size = size;
}

long for_every_allocation_failure(allocation_case *run, const void *data)
{
    return for_allocation_failures(run, data, 1);
}

long for_allocation_failures(allocation_case *run, const void *data, long step)
{
    for (long n = 1;; n += step) {
        pel_error error = {.status = PEL_OK};
        failing_malloc_begin(n);
        pel_status status = run(data, &error);
        allocation_count counted = failing_malloc_end();
        if (counted.live != 0)
            print_error("%ld blocks leaked when allocation %ld failed\n", counted.live, n);
        assert_int_equal(counted.live, 0);
        if (counted.failed == 0) {
            assert_int_equal(status, PEL_OK);
            return counted.calls;
        }
        /* a failed realloc keeps the old block, and code that only shrinks it continues */
        if (counted.failed_shrink && status == PEL_OK)
            continue;
        if (status != PEL_OUT_OF_MEMORY)
            print_error("allocation %ld failed and the status was '%s'\n", n, pel_status_text(status));
        assert_int_equal(status, PEL_OUT_OF_MEMORY);
        assert_int_equal(error.status, PEL_OUT_OF_MEMORY);
        assert_true(error.what[0] != '\0' && error.remedy[0] != '\0');
    }
}

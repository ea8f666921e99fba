/* One atomic word distributes the work: the number of the loop in its upper half, the next chunk in its lower half. A
   thread takes a chunk by raising the lower half with compare-and-swap, which fails if the loop has changed meanwhile;
   so it runs the loop that it read. A new loop is closed (no chunks) until it is described, and a thread reads the
   number of chunks before the rest: if it sees chunks of the new loop, it sees its function too. */
#include "base/pool.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/patience.h"
#include "base/status.h"
#include "pellicle/parallel.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <unistd.h>

/* looks for work before a helper sleeps; some 20 microseconds */
enum { SPIN_LIMIT = 2000 };

struct pel_pool {
    _Atomic uint64_t ticket; /* loop << 32 | next chunk */
    _Atomic(pel_chunk_function *) function;
    _Atomic(void *) context;
    _Atomic int32_t chunk_count, done_count;
    _Atomic int sleeping_count;
    _Atomic bool stop;
    _Atomic bool is_stopped;    /* `wanted` has said no */
    bool (*wanted)(void *user); /* null = nobody is asked */
    void *user;
    pthread_t asker; /* the thread that runs loops */
    pthread_mutex_t mutex;
    pthread_cond_t wake;
    int helper_count;
    pthread_t helpers[];
};

static inline void pause_briefly(void)
{
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#endif
}

static bool has_work(pel_pool *pool)
{
    return (int64_t)(atomic_load(&pool->ticket) & UINT32_MAX) < atomic_load(&pool->chunk_count);
}

/* takes and runs one chunk; false if none is left */
static bool run_chunk(pel_pool *pool)
{
    uint64_t ticket = atomic_load(&pool->ticket);
    for (;;) {
        int32_t chunk = (int32_t)(ticket & UINT32_MAX);
        if (chunk >= atomic_load(&pool->chunk_count))
            return false;
        pel_chunk_function *function = atomic_load(&pool->function);
        void *context = atomic_load(&pool->context);
        if (atomic_compare_exchange_weak(&pool->ticket, &ticket, ticket + 1)) {
            function(context, chunk);
            atomic_fetch_add(&pool->done_count, 1);
            return true;
        }
    }
}

static void sleep_until_work(pel_pool *pool)
{
    pthread_mutex_lock(&pool->mutex);
    atomic_fetch_add(&pool->sleeping_count, 1);
    while (!has_work(pool) && !atomic_load(&pool->stop))
        pthread_cond_wait(&pool->wake, &pool->mutex);
    atomic_fetch_sub(&pool->sleeping_count, 1);
    pthread_mutex_unlock(&pool->mutex);
}

static void *help(void *argument)
{
    pel_pool *pool = argument;
    while (!atomic_load(&pool->stop)) {
        int spins = 0;
        while (!run_chunk(pool) && spins < SPIN_LIMIT && !atomic_load(&pool->stop)) {
            pause_briefly();
            spins++;
        }
        if (spins == SPIN_LIMIT)
            sleep_until_work(pool);
    }
    return NULL;
}

static void wake_helpers(pel_pool *pool)
{
    pthread_mutex_lock(&pool->mutex);
    pthread_cond_broadcast(&pool->wake);
    pthread_mutex_unlock(&pool->mutex);
}

pel_status pel_pool_create(int thread_count, pel_pool **pool, pel_error *error)
{
    *pool = NULL;
    int helper_count = thread_count > 1 ? thread_count - 1 : 0;
    pel_pool *made = pel_allocate(1, sizeof *made + (size_t)helper_count * sizeof *made->helpers);
    if (made == NULL)
        return pel_fail_memory(error);
    made->asker = pthread_self();
    pthread_mutex_init(&made->mutex, NULL);
    pthread_cond_init(&made->wake, NULL);
    for (int i = 0; i < helper_count; i++) {
        if (pthread_create(&made->helpers[i], NULL, help, made) != 0) {
            pel_pool_destroy(made);
            return pel_refuse(error, PEL_OUT_OF_MEMORY, "ask for fewer threads", "cannot start %d threads",
                              thread_count);
        }
        made->helper_count++;
    }
    *pool = made;
    return PEL_OK;
}

void pel_pool_destroy(pel_pool *pool)
{
    if (pool == NULL)
        return;
    atomic_store(&pool->stop, true);
    wake_helpers(pool);
    for (int i = 0; i < pool->helper_count; i++)
        pthread_join(pool->helpers[i], NULL);
    pthread_mutex_destroy(&pool->mutex);
    pthread_cond_destroy(&pool->wake);
    pel_free(pool);
}

/* describes the new loop while no chunk can be taken, then opens it */
static void open_loop(pel_pool *pool, int32_t chunk_count, pel_chunk_function *function, void *context)
{
    uint64_t loop = (atomic_load(&pool->ticket) >> 32) + 1;
    atomic_store(&pool->chunk_count, 0);
    atomic_store(&pool->ticket, loop << 32);
    atomic_store(&pool->function, function);
    atomic_store(&pool->context, context);
    atomic_store(&pool->done_count, 0);
    atomic_store(&pool->chunk_count, chunk_count);
    if (atomic_load(&pool->sleeping_count) > 0)
        wake_helpers(pool);
}

void pel_pool_watch(pel_pool *pool, bool (*wanted)(void *user), void *user)
{
    if (pool == NULL)
        return;
    pool->wanted = wanted;
    pool->user = user;
    pool->asker = pthread_self();
    atomic_store(&pool->is_stopped, false);
}

static void ask(pel_pool *pool)
{
    if (pool == NULL || atomic_load(&pool->is_stopped))
        return;
    if ((pool->wanted != NULL && !pool->wanted(pool->user)) || pel_patience_is_lost())
        atomic_store(&pool->is_stopped, true);
}

bool pel_pool_is_stopped(const pel_pool *pool)
{
    return pool != NULL ? atomic_load(&pool->is_stopped) : pel_patience_is_lost();
}

bool pel_pool_is_stopped_now(pel_pool *pool)
{
    if (pool != NULL && pthread_equal(pthread_self(), pool->asker))
        ask(pool);
    return pel_pool_is_stopped(pool);
}

pel_status pel_pool_check(const pel_pool *pool, pel_error *error)
{
    return pel_pool_is_stopped(pool) ? pel_fail(error, PEL_STOPPED, "stopped on request") : PEL_OK;
}

void pel_pool_run(pel_pool *pool, int32_t chunk_count, pel_chunk_function *function, void *context)
{
    PEL_ASSERT(chunk_count >= 0 && function != NULL);
    if (pool == NULL || pool->helper_count == 0 || chunk_count <= 1) {
        for (int32_t chunk = 0; chunk < chunk_count; chunk++) {
            function(context, chunk);
            ask(pool);
        }
        return;
    }
    open_loop(pool, chunk_count, function, context);
    while (run_chunk(pool))
        ask(pool);
    /* chunks that helpers have begun are short, or look whether they are stopped: wait for those only */
    for (int spins = 0; atomic_load(&pool->done_count) < chunk_count; spins++) {
        if (spins < SPIN_LIMIT)
            pause_briefly();
        else {
            ask(pool);
            sched_yield();
        }
    }
}

int pel_thread_limit(void)
{
    long count = sysconf(_SC_NPROCESSORS_ONLN);
    return count > 0 ? (int)count : 1;
}

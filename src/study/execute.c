/* All runs of a chunk on the threads of this machine. */
#include "base/memory.h"
#include "base/pool.h"
#include "pellicle/parallel.h"
#include "study/study.h"

#include <stdatomic.h>
#include <time.h>

enum { STUDY_COOKIE = 0x53747564 };

pel_study_def pel_study_def_default(void)
{
    return (pel_study_def){.chunk = 1, .chunk_count = 1, .cookie = STUDY_COOKIE};
}

/* what the threads share */
typedef struct execution {
    const pel_study *study;
    const pel_study_def *def;
    pel_study_store *store;
    int64_t *runs; /* (run_count) that are needed */
    int64_t run_count;
    double start;
    _Atomic(int64_t) done, failed;
    _Atomic(bool) stopped;
    atomic_flag telling; /* one thread at a time tells the progress, or the error */
    pel_status status;   /* the first failure */
    pel_error error;
} execution;

static double clock_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static bool goes_on(void *user)
{
    execution *e = user;
    if (!atomic_load(&e->stopped) && e->def->wanted != NULL && !e->def->wanted(e->def->user))
        atomic_store(&e->stopped, true);
    return !atomic_load(&e->stopped);
}

/* a thread that finds another one telling goes on without */
static void tell(execution *e)
{
    if (e->def->progress == NULL || atomic_flag_test_and_set(&e->telling))
        return;
    int64_t done = atomic_load(&e->done);
    double left = (double)(e->run_count - done), seconds = clock_now() - e->start;
    const pel_study_progress progress = {.done = done,
                                         .total = e->run_count,
                                         .failed = atomic_load(&e->failed),
                                         .remaining = done > 0 ? left * seconds / (double)done : -1};
    e->def->progress(e->def->user, &progress);
    atomic_flag_clear(&e->telling);
}

static void keep_error(execution *e, pel_status status, const pel_error *error)
{
    while (atomic_flag_test_and_set(&e->telling))
        ;
    if (e->status == PEL_OK) {
        e->status = status;
        e->error = *error;
    }
    atomic_flag_clear(&e->telling);
    atomic_store(&e->stopped, true);
}

static void do_run(void *context, int32_t chunk)
{
    execution *e = context;
    pel_error error = {0};
    if (!goes_on(e))
        return;
    char *row = pel_allocate(pel_study_row_size(e->study), 1);
    pel_status status = row != NULL ? pel_study_run(e->study, e->runs[chunk], e->def->folder, goes_on, e, row, &error)
                                    : pel_fail_memory(&error);
    if (status == PEL_OK)
        status = pel_study_store_add(e->store, row, &error);
    if (status == PEL_OK) {
        atomic_fetch_add(&e->failed, pel_study_row_is_done(row) ? 0 : 1);
        atomic_fetch_add(&e->done, 1);
        tell(e);
    } else if (status != PEL_STOPPED) {
        keep_error(e, status, &error);
    }
    pel_free(row);
}

static pel_status find_runs(execution *e, pel_study_summary *summary, pel_error *error)
{
    int64_t count = pel_study_run_count(e->study);
    e->runs = pel_allocate((size_t)count, sizeof *e->runs);
    if (e->runs == NULL)
        return pel_fail_memory(error);
    int64_t of_chunk = 0;
    for (int64_t run = 0; run < count; run++) {
        of_chunk += run % e->def->chunk_count == e->def->chunk - 1;
        if (pel_study_store_needs(e->store, run))
            e->runs[e->run_count++] = run;
    }
    summary->runs = count;
    summary->present = of_chunk - e->run_count;
    return PEL_OK;
}

static pel_status do_runs(execution *e, pel_error *error)
{
    pel_pool *pool = NULL;
    int32_t threads = e->def->thread_count > 0 ? e->def->thread_count : (int32_t)pel_thread_limit();
    if (threads > e->run_count)
        threads = (int32_t)e->run_count;
    pel_status status = pel_pool_create(threads, &pool, error);
    if (status != PEL_OK)
        return status;
    tell(e);
    pel_pool_run(pool, (int32_t)e->run_count, do_run, e);
    pel_pool_destroy(pool);
    if (e->status != PEL_OK && error != NULL)
        *error = e->error;
    return e->status;
}

static pel_status execute(execution *e, pel_study_summary *summary, pel_error *error)
{
    pel_status status = find_runs(e, summary, error);
    if (status == PEL_OK)
        status = do_runs(e, error);
    summary->done = atomic_load(&e->done);
    pel_status later =
        pel_study_store_collect(e->store, &summary->missing, &summary->failed, status == PEL_OK ? error : NULL);
    if (status != PEL_OK || later != PEL_OK)
        return status != PEL_OK ? status : later;
    if (summary->done < e->run_count)
        return pel_fail(error, PEL_STOPPED, "stopped with %lld of %lld runs done",
                        (long long)(summary->present + summary->done), (long long)(summary->present + e->run_count));
    return PEL_OK;
}

pel_status pel_study_execute(const pel_study *study, const pel_study_def *def, pel_study_summary *summary,
                             pel_error *error)
{
    PEL_REFUSE_NULL(study, error);
    PEL_REFUSE_NULL(def, error);
    pel_study_summary own;
    if (def->cookie != STUDY_COOKIE)
        return pel_fail(error, PEL_BAD_ARGUMENT, "study def was not made by pel_study_def_default()");
    if (def->thread_count < 0 || def->thread_count > PEL_THREADS_MOST)
        return pel_fail(error, PEL_BAD_ARGUMENT, "thread_count must be within 0 .. %d", (int)PEL_THREADS_MOST);
    PEL_REFUSE_NULL(def->folder, error);
    if (summary == NULL)
        summary = &own;
    *summary = (pel_study_summary){0};
    execution e = {.study = study, .def = def, .start = clock_now(), .telling = ATOMIC_FLAG_INIT};
    pel_status status = pel_study_store_open(study, def->folder, def->chunk, def->chunk_count, &e.store, error);
    if (status == PEL_OK)
        status = execute(&e, summary, error);
    pel_free(e.runs);
    pel_study_store_close(e.store);
    return status;
}

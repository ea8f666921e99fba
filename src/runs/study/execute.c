/* All runs of a chunk in processes of this machine. This process gives out runs and keeps rows; each worker (worker.h)
   does one run at a time. A run whose worker is lost is done once more, in case the loss had to do with the machine;
   then its row says how the process ended. */
#define _DEFAULT_SOURCE
#include "base/memory.h"
#include "base/pool.h"
#include "base/room.h"
#include "math/extremes.h"
#include "pellicle/parallel.h"
#include "study/worker.h"

#include <math.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>

enum { STUDY_COOKIE = 0x53747564 };

/* ms between looks for Ctrl-C and for runs that take too long */
enum { LOOK_MILLISECONDS = 50 };

/* ns that rows may gather before a look where all workers have further runs in their queues: each look costs about as
   much as ten steps of a small body */
enum { GATHER_NANOSECONDS = 2000000 };

/* s of work that a worker has in its queue, beside the run that it does: more than a round trip takes, less than
   anybody would wait for at the end */
#define QUEUE_SECONDS 0.02

/* workers that a run may lose */
enum { MOST_TRIES = 2 };

pel_study_def pel_study_def_default(void)
{
    return (pel_study_def){.chunk = 1, .chunk_count = 1, .cookie = STUDY_COOKIE};
}

typedef struct execution {
    const pel_study *study;
    const pel_study_def *def;
    pel_study_store *store;
    int64_t *runs; /* (run_count) that are needed */
    int64_t run_count;
    int64_t given;             /* of these */
    pel_study_worker *workers; /* (worker_count) */
    struct pollfd *channels;   /* (worker_count) */
    int32_t worker_count;
    char *row; /* of a run that was lost */
    double start;
    int64_t done, failed;
    bool stopped;
} execution;

static bool goes_on(execution *e)
{
    if (!e->stopped && e->def->wanted != NULL && !e->def->wanted(e->def->user))
        e->stopped = true;
    return !e->stopped;
}

static void tell(const execution *e)
{
    if (e->def->progress == NULL)
        return;
    double left = (double)(e->run_count - e->done), seconds = pel_seconds() - e->start;
    const pel_study_progress progress = {.done = e->done,
                                         .total = e->run_count,
                                         .failed = e->failed,
                                         .remaining = e->done > 0 ? left * seconds / (double)e->done : -1};
    e->def->progress(e->def->user, &progress);
}

/* ---- rows ---- */

static pel_status keep_row(execution *e, const char *row, pel_error *error)
{
    pel_status status = pel_study_store_gather(e->store, row, error);
    /* progress tells of rows that are written */
    if (status == PEL_OK && e->def->progress != NULL)
        status = pel_study_store_flush(e->store, error);
    if (status != PEL_OK)
        return status;
    e->failed += pel_study_row_is_done(row) ? 0 : 1;
    e->done++;
    tell(e);
    return PEL_OK;
}

static pel_status keep_lost(execution *e, int64_t run, const char *word, const char *what, const char *remedy,
                            pel_error *error)
{
    pel_status status = pel_study_lost_run(e->study, run, word, what, remedy, e->row, error);
    status = status == PEL_OK ? keep_row(e, e->row, error) : status;
    return status == PEL_OK ? pel_study_store_flush(e->store, error) : status;
}

/* the rows that have come back whole, with one write where nobody asks for progress */
static pel_status keep_rows(execution *e, pel_study_worker *worker, pel_error *error)
{
    const char *row;
    pel_status status = PEL_OK;
    while (status == PEL_OK && goes_on(e) && (row = pel_study_worker_row(worker)) != NULL) {
        status = row[0] != '\0' ? keep_row(e, row, error)
                                : keep_lost(e, worker->queue[0], "failed", "out of memory",
                                            "use a coarser mesh, or do fewer runs at a time", error);
        if (status == PEL_OK)
            pel_study_worker_answered(worker, pel_seconds());
    }
    return status == PEL_OK ? pel_study_store_flush(e->store, error) : status;
}

/* ---- workers ---- */

static int32_t queue_length(const pel_study_worker *worker)
{
    if (!(worker->seconds >= 0))
        return 1;
    double count = 1 + floor(QUEUE_SECONDS / pel_max(worker->seconds, 1e-6));
    return count < PEL_STUDY_QUEUE ? (int32_t)count : PEL_STUDY_QUEUE;
}

/* a worker that ends while it is given a run is found by the next look */
static void fill_queue(execution *e, pel_study_worker *worker)
{
    int64_t left = e->run_count - e->given;
    int32_t room = queue_length(worker) - worker->queued, count = room < left ? room : (int32_t)left;
    if (worker->process == 0 || count <= 0)
        return;
    pel_study_worker_give(worker, e->runs + e->given, count, pel_seconds());
    e->given += count;
}

static pel_status start_worker(execution *e, pel_study_worker *worker, pel_error *error)
{
    pel_status status = pel_study_worker_start(worker, e->study, e->def->folder, e->store, error);
    if (status != PEL_OK)
        return status;
    /* what the one before has not done */
    int64_t runs[PEL_STUDY_QUEUE];
    int32_t count = worker->queued;
    memcpy(runs, worker->queue, (size_t)count * sizeof *runs);
    worker->queued = 0;
    if (count > 0)
        pel_study_worker_give(worker, runs, count, pel_seconds());
    fill_queue(e, worker);
    return PEL_OK;
}

/* the first run of the queue has a row now that its worker did not write */
static void drop_first(pel_study_worker *worker)
{
    worker->queued--;
    worker->tries = 0;
    memmove(worker->queue, worker->queue + 1, (size_t)worker->queued * sizeof *worker->queue);
}

static void describe_end(int result, char *text, size_t size)
{
    if (WIFSIGNALED(result))
        snprintf(text, size, "the process of this run was ended twice, the last time by signal %d (%s)",
                 WTERMSIG(result), strsignal(WTERMSIG(result)));
    else
        snprintf(text, size, "the process of this run ended twice, the last time with exit status %d",
                 WEXITSTATUS(result));
}

/* after the process has ended by itself */
static pel_status replace_worker(execution *e, pel_study_worker *worker, pel_error *error)
{
    char text[200];
    int result = pel_study_worker_end(worker);
    pel_status status = PEL_OK;
    if (worker->queued > 0 && ++worker->tries >= MOST_TRIES) {
        describe_end(result, text, sizeof text);
        status = keep_lost(e, worker->queue[0], "crashed", text,
                           "do this run alone to see why; signal 9 may be a lack of memory", error);
        drop_first(worker);
    }
    return status == PEL_OK ? start_worker(e, worker, error) : status;
}

static pel_status stop_late_run(execution *e, pel_study_worker *worker, pel_error *error)
{
    char text[100];
    pel_study_worker_end(worker);
    snprintf(text, sizeof text, "the run took more than %g s", e->def->run_seconds);
    pel_status status = keep_lost(e, worker->queue[0], "timeout", text, "allow more time, or make it cheaper", error);
    drop_first(worker);
    return status == PEL_OK ? start_worker(e, worker, error) : status;
}

static pel_status look_at(execution *e, pel_study_worker *worker, bool is_readable, pel_error *error)
{
    double limit = e->def->run_seconds;
    bool has_ended = is_readable ? !pel_study_worker_read(worker) : pel_study_worker_has_ended(worker);
    pel_status status = keep_rows(e, worker, error);
    if (status != PEL_OK || e->stopped)
        return status;
    if (has_ended)
        return replace_worker(e, worker, error);
    if (limit > 0 && worker->queued > 0 && pel_seconds() - worker->since > limit)
        return stop_late_run(e, worker, error);
    fill_queue(e, worker);
    return PEL_OK;
}

/* whether every worker that has runs left has some more behind the one that it does */
static bool are_busy(const execution *e)
{
    for (int32_t w = 0; w < e->worker_count; w++)
        if (e->workers[w].queued < PEL_STUDY_QUEUE / 2)
            return false;
    return true;
}

static pel_status look_at_all(execution *e, pel_error *error)
{
    if (are_busy(e))
        nanosleep(&(struct timespec){.tv_nsec = GATHER_NANOSECONDS}, NULL);
    for (int32_t w = 0; w < e->worker_count; w++)
        e->channels[w] = (struct pollfd){.fd = e->workers[w].queued > 0 ? e->workers[w].channel : -1, .events = POLLIN};
    int ready = poll(e->channels, (nfds_t)e->worker_count, LOOK_MILLISECONDS);
    pel_status status = PEL_OK;
    for (int32_t w = 0; w < e->worker_count && status == PEL_OK && goes_on(e); w++)
        if (e->workers[w].queued > 0)
            status = look_at(e, &e->workers[w], ready > 0 && e->channels[w].revents != 0, error);
    return status;
}

static pel_status do_runs(execution *e, pel_error *error)
{
    pel_status status = PEL_OK;
    tell(e);
    for (int32_t w = 0; w < e->worker_count && status == PEL_OK && goes_on(e); w++)
        status = start_worker(e, &e->workers[w], error);
    while (status == PEL_OK && e->done < e->run_count && goes_on(e))
        status = look_at_all(e, error);
    for (int32_t w = 0; w < e->worker_count; w++)
        pel_study_worker_end(&e->workers[w]);
    return status;
}

/* ---- all of it ---- */

static pel_status find_runs(execution *e, pel_study_summary *summary, pel_error *error)
{
    int64_t count = pel_study_run_count(e->study);
    e->runs = pel_allocate((size_t)count, sizeof *e->runs);
    if (e->runs == NULL)
        return pel_fail_memory(error);
    int64_t of_chunk = 0;
    for (int64_t run = 0; run < count; run++) {
        of_chunk += run % e->def->chunk_count == e->def->chunk - 1;
        if (pel_study_store_needs(e->store, run) || (e->def->retry && pel_study_store_failed(e->store, run)))
            e->runs[e->run_count++] = run;
    }
    summary->runs = count;
    summary->present = of_chunk - e->run_count;
    return PEL_OK;
}

static pel_status allocate_workers(execution *e, pel_error *error)
{
    int32_t wanted = e->def->thread_count > 0 ? e->def->thread_count : (int32_t)pel_thread_limit();
    int32_t count = wanted < e->run_count ? wanted : (int32_t)e->run_count;
    /* each answer is shorter than a row and its newline */
    size_t size = 2 * (pel_study_row_size(e->study) + 1);
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(e->row, pel_study_row_size(e->study)), PEL_ROOM(e->workers, count),
                          PEL_ROOM(e->channels, count)))
        return pel_fail_memory(error);
    for (; e->worker_count < count; e->worker_count++) {
        pel_study_worker *worker = &e->workers[e->worker_count];
        worker->size = size;
        worker->text = pel_allocate(size, 1);
        if (worker->text == NULL)
            return pel_fail_memory(error);
    }
    return PEL_OK;
}

static pel_status execute(execution *e, pel_study_summary *summary, pel_error *error)
{
    pel_status status = find_runs(e, summary, error);
    if (status == PEL_OK)
        status = allocate_workers(e, error);
    if (status == PEL_OK)
        status = do_runs(e, error);
    summary->done = e->done;
    pel_status later =
        pel_study_store_collect(e->store, &summary->missing, &summary->failed, status == PEL_OK ? error : NULL);
    snprintf(summary->zeros, sizeof summary->zeros, "%s", pel_study_store_zeros(e->store));
    snprintf(summary->warnings, sizeof summary->warnings, "%s", pel_study_store_warnings(e->store));
    if (status != PEL_OK || later != PEL_OK)
        return status != PEL_OK ? status : later;
    if (summary->done < e->run_count)
        return pel_fail(error, PEL_STOPPED, "stopped with %lld of %lld runs done",
                        (long long)(summary->present + summary->done), (long long)(summary->present + e->run_count));
    return PEL_OK;
}

static void release(execution *e)
{
    for (int32_t w = 0; w < e->worker_count; w++)
        pel_free(e->workers[w].text);
    PEL_FREE_ALL(e->workers, e->channels, e->row, e->runs);
    pel_study_store_close(e->store);
}

static pel_status check_def(const pel_study_def *def, pel_error *error)
{
    if (def->cookie != STUDY_COOKIE)
        return pel_fail(error, PEL_BAD_ARGUMENT, "study def was not made by pel_study_def_default()");
    if (def->thread_count < 0 || def->thread_count > PEL_THREADS_MOST)
        return pel_fail(error, PEL_BAD_ARGUMENT, "thread_count must be within 0 .. %d", (int)PEL_THREADS_MOST);
    if (!(def->run_seconds >= 0 && isfinite(def->run_seconds)))
        return pel_fail(error, PEL_BAD_ARGUMENT, "run_seconds must be a number of seconds, 0 for no limit");
    PEL_REFUSE_NULL(def->folder, error);
    return PEL_OK;
}

pel_status pel_study_execute(const pel_study *study, const pel_study_def *def, pel_study_summary *summary,
                             pel_error *error)
{
    pel_study_summary own;
    PEL_REFUSE_NULL(study, error);
    PEL_REFUSE_NULL(def, error);
    pel_status status = check_def(def, error);
    if (status != PEL_OK)
        return status;
    if (summary == NULL)
        summary = &own;
    *summary = (pel_study_summary){0};
    execution e = {.study = study, .def = def, .start = pel_seconds()};
    status = pel_study_store_open(study, def->folder, def->chunk, def->chunk_count, &e.store, error);
    if (status == PEL_OK)
        status = execute(&e, summary, error);
    release(&e);
    return status;
}

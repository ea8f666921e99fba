#include "base/worker.h"

#include "base/memory.h"
#include "base/status.h"

#include <pthread.h>

struct pel_worker {
    pel_worker_function *function;
    void *context;
    int32_t slot_count;
    pthread_mutex_t mutex;
    pthread_cond_t given, done;
    int64_t given_count, done_count; /* jobs given */
    bool stop;
    pthread_t thread;
};

static void *work(void *argument)
{
    pel_worker *worker = argument;
    pthread_mutex_lock(&worker->mutex);
    for (;;) {
        while (worker->done_count == worker->given_count && !worker->stop)
            pthread_cond_wait(&worker->given, &worker->mutex);
        if (worker->done_count == worker->given_count)
            break;
        int32_t slot = (int32_t)(worker->done_count % worker->slot_count);
        pthread_mutex_unlock(&worker->mutex);
        worker->function(worker->context, slot);
        pthread_mutex_lock(&worker->mutex);
        worker->done_count++;
        pthread_cond_signal(&worker->done);
    }
    pthread_mutex_unlock(&worker->mutex);
    return NULL;
}

static void free_worker(pel_worker *worker)
{
    pthread_cond_destroy(&worker->done);
    pthread_cond_destroy(&worker->given);
    pthread_mutex_destroy(&worker->mutex);
    pel_free(worker);
}

pel_status pel_worker_create(int32_t slot_count, pel_worker_function *function, void *context, pel_worker **worker,
                             pel_error *error)
{
    *worker = NULL;
    pel_worker *made = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    made->function = function;
    made->context = context;
    made->slot_count = slot_count;
    pthread_mutex_init(&made->mutex, NULL);
    pthread_cond_init(&made->given, NULL);
    pthread_cond_init(&made->done, NULL);
    if (pthread_create(&made->thread, NULL, work, made) != 0) {
        free_worker(made);
        return pel_refuse(error, PEL_OUT_OF_MEMORY, "ask for one thread", "cannot start a thread");
    }
    *worker = made;
    return PEL_OK;
}

void pel_worker_destroy(pel_worker *worker)
{
    if (worker == NULL)
        return;
    pthread_mutex_lock(&worker->mutex);
    worker->stop = true;
    pthread_cond_signal(&worker->given);
    pthread_mutex_unlock(&worker->mutex);
    pthread_join(worker->thread, NULL);
    free_worker(worker);
}

/* returns when at most `count` jobs are under way */
static void wait_for(pel_worker *worker, int32_t count)
{
    pthread_mutex_lock(&worker->mutex);
    while (worker->given_count - worker->done_count > count)
        pthread_cond_wait(&worker->done, &worker->mutex);
    pthread_mutex_unlock(&worker->mutex);
}

int32_t pel_worker_claim(pel_worker *worker)
{
    wait_for(worker, worker->slot_count - 1);
    /* only the caller's thread gives jobs */
    return (int32_t)(worker->given_count % worker->slot_count);
}

void pel_worker_give(pel_worker *worker)
{
    pthread_mutex_lock(&worker->mutex);
    worker->given_count++;
    pthread_cond_signal(&worker->given);
    pthread_mutex_unlock(&worker->mutex);
}

void pel_worker_wait(pel_worker *worker)
{
    wait_for(worker, 0);
}

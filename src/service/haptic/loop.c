#include "haptic/loop.h"

#include "base/memory.h"
#include "base/status.h"
#include "math/extremes.h"

#include <math.h>
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <time.h>

/* ns, width of a bin of the histogram, and of a second */
enum { BIN = 10000, SECOND = 1000000000 };

struct pel_loop {
    int64_t period; /* ns */
    pel_loop_function *function;
    void *context;
    pel_haptic_latency latency;
    atomic_bool stop;
    pthread_t thread;
};

static int64_t clock_now(void)
{
    return (int64_t)(SECOND * pel_seconds());
}

static void sleep_until(int64_t time)
{
    const struct timespec until = {.tv_sec = (time_t)(time / SECOND), .tv_nsec = (long)(time % SECOND)};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, NULL) != 0)
        continue;
}

/* above all threads of the usual kind; refused without the right to it, which costs jitter only */
static bool ask_for_priority(void)
{
    const struct sched_param priority = {.sched_priority = sched_get_priority_min(SCHED_FIFO)};
    return pthread_setschedparam(pthread_self(), SCHED_FIFO, &priority) == 0;
}

void pel_loop_book(pel_haptic_latency *latency, int64_t late)
{
    int64_t bin = late / BIN;
    latency->bins[bin < PEL_HAPTIC_LATENCY_BINS ? bin : PEL_HAPTIC_LATENCY_BINS - 1]++;
    latency->count++;
    latency->most = pel_max(latency->most, (double)late / SECOND);
}

static void *run(void *argument)
{
    pel_loop *loop = argument;
    pel_haptic_latency *latency = &loop->latency;
    latency->is_real_time = ask_for_priority();
    int64_t due = clock_now() + loop->period;
    while (!atomic_load_explicit(&loop->stop, memory_order_acquire)) {
        sleep_until(due);
        int64_t begin = clock_now();
        pel_loop_book(latency, begin - due);
        loop->function(loop->context, latency);
        int64_t end = clock_now(), missed = (end - due) / loop->period;
        latency->most_update = pel_max(latency->most_update, (double)(end - begin) / SECOND);
        /* skip missed updates, so that the loop does not rush to catch up */
        latency->missed_count += missed;
        due += (missed + 1) * loop->period;
    }
    return NULL;
}

pel_status pel_loop_create(double rate, pel_loop_function *function, void *context, pel_loop **loop, pel_error *error)
{
    *loop = NULL;
    pel_loop *made = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    made->period = (int64_t)(SECOND / rate);
    made->function = function;
    made->context = context;
    atomic_init(&made->stop, false);
    if (pthread_create(&made->thread, NULL, run, made) != 0) {
        pel_free(made);
        return pel_refuse(error, PEL_OUT_OF_MEMORY, "call pel_haptic_update at the rate of the loop instead",
                          "cannot start a thread");
    }
    *loop = made;
    return PEL_OK;
}

void pel_loop_destroy(pel_loop *loop)
{
    if (loop == NULL)
        return;
    atomic_store_explicit(&loop->stop, true, memory_order_release);
    pthread_join(loop->thread, NULL);
    pel_free(loop);
}

double pel_haptic_latency_quantile(const pel_haptic_latency *latency, double share)
{
    if (latency == NULL || latency->count <= 0)
        return 0;
    double wanted = share * (double)latency->count, sum = 0;
    for (int i = 0; i + 1 < PEL_HAPTIC_LATENCY_BINS; i++) {
        sum += (double)latency->bins[i];
        if (sum >= wanted && sum > 0)
            return pel_min((double)(i + 1) * BIN / SECOND, latency->most);
    }
    return latency->most;
}

#define _DEFAULT_SOURCE /* MSG_NOSIGNAL, SOCK_CLOEXEC */
#include "study/worker.h"

#include "base/memory.h"
#include "study/kept.h"

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

/* ---- in the process ---- */

static bool send_all(int channel, const char *text, size_t length)
{
    while (length > 0) {
        ssize_t sent = send(channel, text, length, MSG_NOSIGNAL);
        if (sent < 0 && errno == EINTR)
            continue;
        if (sent < 0)
            return false;
        text += sent;
        length -= (size_t)sent;
    }
    return true;
}

/* A run that is out of memory gives an empty row: the parent, which has some, writes it. */
static bool do_run(const pel_study *study, pel_study_kept *kept, int64_t run, const char *folder, int channel)
{
    char *row = pel_allocate(pel_study_row_size(study) + 1, 1);
    if (row == NULL)
        return send_all(channel, "\n", 1);
    /* a run with a folder writes its own scene into it */
    pel_status status = study->keep ? pel_study_run(study, run, folder, NULL, NULL, row, NULL)
                                    : pel_study_run_kept(study, kept, run, row, NULL);
    if (status != PEL_OK)
        row[0] = '\0';
    size_t length = strlen(row);
    row[length++] = '\n';
    bool sent = send_all(channel, row, length);
    pel_free(row);
    return sent;
}

/* numbers of runs that have arrived */
typedef struct inbox {
    union {
        int64_t runs[PEL_STUDY_QUEUE];
        char bytes[PEL_STUDY_QUEUE * sizeof(int64_t)];
    } content;
    size_t length, taken; /* bytes */
} inbox;

/* The next run, waiting for it; false when the parent has closed the channel. Many arrive at once: receiving each by
   itself takes a hundredth of a short run. */
static bool take_run(inbox *in, int channel, int64_t *run)
{
    if (in->taken == in->length)
        in->taken = in->length = 0;
    while (in->length < in->taken + sizeof *run) {
        ssize_t got = recv(channel, in->content.bytes + in->length, sizeof in->content.bytes - in->length, 0);
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            return false;
        in->length += (size_t)got;
    }
    *run = in->content.runs[in->taken / sizeof *run];
    in->taken += sizeof *run;
    return true;
}

static _Noreturn void work(const pel_study *study, const char *folder, int channel, pid_t parent)
{
    int64_t run;
    inbox in = {.length = 0};
    pel_study_kept kept = {0};
    /* Ctrl-C reaches all processes of a terminal: what follows is the parent's decision, with which this one ends */
    signal(SIGINT, SIG_IGN);
    signal(SIGTERM, SIG_DFL);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    /* it may have ended before */
    if (getppid() != parent)
        _exit(0);
    while (take_run(&in, channel, &run) && do_run(study, &kept, run, folder, channel))
        ;
    _exit(0);
}

/* ---- in the parent ---- */

static pel_status fail_start(int number, pel_error *error)
{
    return pel_refuse(error, PEL_OUT_OF_MEMORY, "execute fewer runs at a time (--jobs); the same command continues",
                      "cannot start a process: %s", strerror(number));
}

pel_status pel_study_worker_start(pel_study_worker *worker, const pel_study *study, const char *folder,
                                  pel_study_store *store, pel_error *error)
{
    int ends[2];
    pid_t parent = getpid();
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
        return fail_start(errno, error);
    pid_t process = fork();
    if (process == 0) {
        close(ends[0]);
        /* its lock would outlive the parent */
        pel_study_store_close(store);
        work(study, folder, ends[1], parent);
    }
    int number = errno;
    close(ends[1]);
    if (process < 0) {
        close(ends[0]);
        return fail_start(number, error);
    }
    worker->process = process;
    worker->channel = ends[0];
    worker->length = 0;
    worker->seconds = -1;
    return PEL_OK;
}

bool pel_study_worker_give(pel_study_worker *worker, const int64_t *runs, int32_t count, double now)
{
    if (worker->queued == 0)
        worker->since = now;
    memcpy(worker->queue + worker->queued, runs, (size_t)count * sizeof *runs);
    worker->queued += count;
    return send_all(worker->channel, (const char *)runs, (size_t)count * sizeof *runs);
}

bool pel_study_worker_read(pel_study_worker *worker)
{
    ssize_t got = recv(worker->channel, worker->text + worker->length, worker->size - worker->length, MSG_DONTWAIT);
    if (got < 0)
        return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR;
    worker->length += (size_t)got;
    return got > 0;
}

char *pel_study_worker_row(pel_study_worker *worker)
{
    char *end = worker->queued > 0 ? memchr(worker->text, '\n', worker->length) : NULL;
    if (end == NULL)
        return NULL;
    *end = '\0';
    return worker->text;
}

void pel_study_worker_answered(pel_study_worker *worker, double now)
{
    size_t used = strlen(worker->text) + 1;
    worker->length -= used;
    memmove(worker->text, worker->text + used, worker->length);
    worker->queued--;
    memmove(worker->queue, worker->queue + 1, (size_t)worker->queued * sizeof *worker->queue);
    worker->seconds = now - worker->since;
    worker->since = now;
    worker->tries = 0;
}

bool pel_study_worker_has_ended(const pel_study_worker *worker)
{
    siginfo_t information = {0};
    return waitid(P_PID, (id_t)worker->process, &information, WEXITED | WNOHANG | WNOWAIT) != 0 ||
           information.si_pid != 0;
}

int pel_study_worker_end(pel_study_worker *worker)
{
    int result = 0;
    if (worker->process == 0)
        return 0;
    kill(worker->process, SIGKILL);
    while (waitpid(worker->process, &result, 0) < 0 && errno == EINTR)
        ;
    worker->process = 0;
    close(worker->channel);
    return result;
}

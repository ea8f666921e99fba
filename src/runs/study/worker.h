/* A separate process for runs, so that a run that crashes or is killed affects nothing else. */
#ifndef PEL_STUDY_WORKER_H
#define PEL_STUDY_WORKER_H

#include "study/study.h"

#include <sys/types.h>

/* runs that are given to a worker at once, at most: short runs do not wait for the next number */
enum { PEL_STUDY_QUEUE = 64 };

typedef struct pel_study_worker {
    pid_t process;                  /* 0 = there is none */
    int channel;                    /* numbers of runs go out, rows come back, each with a newline */
    int64_t queue[PEL_STUDY_QUEUE]; /* (queued) given and not answered; the first one is being done */
    int32_t queued;
    int32_t tries;  /* of the first one, by workers that were lost */
    double since;   /* s, when the first one was begun */
    double seconds; /* that the last run took; -1 = none yet */
    char *text;     /* (size) what came back of rows that are not whole, length bytes */
    size_t size, length;
} pel_study_worker;

/* Starts the process. folder as for pel_study_run; the store is closed in the process, which writes no rows itself.
   text and size are the caller's. PEL_OUT_OF_MEMORY when there can be no process. */
pel_status pel_study_worker_start(pel_study_worker *worker, const pel_study *study, const char *folder,
                                  pel_study_store *store, pel_error *error);
/* Gives it runs, for which the queue has room; false when the process has ended. */
bool pel_study_worker_give(pel_study_worker *worker, const int64_t *runs, int32_t count, double now);
/* Reads what has come back; false when the process has ended. */
bool pel_study_worker_read(pel_study_worker *worker);
/* The next whole row, without its newline, which the worker's text holds until the next call; "" = the run was out of
   memory; null = none. It answers the first run of the queue, which it leaves there. */
char *pel_study_worker_row(pel_study_worker *worker);
/* Takes the first run off the queue, and its row off the text. */
void pel_study_worker_answered(pel_study_worker *worker, double now);
/* Whether the process has ended; it is still there to be told of by pel_study_worker_end. */
bool pel_study_worker_has_ended(const pel_study_worker *worker);
/* Kills the process if it has not ended. The queue stays. Returns its end as waitpid gives it; 0 = there was none. */
int pel_study_worker_end(pel_study_worker *worker);

#endif

/* Calls of public functions with invalid arguments, each in a separate process: a crash or an endless call is a failure
   with the name of the function, not the end of the test. Every public function has such a call; the test house/misuse
   checks that. */
#ifndef PEL_TESTS_MISUSE_H
#define PEL_TESTS_MISUSE_H

#include "check.h"

#include <pellicle/error.h>

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

enum { MISUSE_SECONDS = 60, MISUSE_FINE = 0, MISUSE_WRONG = 1 };

static int misuse_cases, misuse_failures;

/* in the child true; in the parent false, after the child has ended */
static inline bool misuse_begin(const char *call)
{
    misuse_cases++;
    fflush(NULL);
    pid_t child = fork();
    if (child == 0) {
        alarm(MISUSE_SECONDS);
        /* cmocka would go on in the child otherwise */
        const int signals[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
        for (size_t i = 0; i < sizeof signals / sizeof *signals; i++)
            signal(signals[i], SIG_DFL);
        return true;
    }
    int result = 0;
    if (child < 0 || waitpid(child, &result, 0) != child)
        fail_msg("no process for %s", call);
    if (WIFEXITED(result) && WEXITSTATUS(result) == MISUSE_FINE)
        return false;
    misuse_failures++;
    if (WIFSIGNALED(result))
        print_error("%s: %s\n", call, WTERMSIG(result) == SIGALRM ? "does not end" : "crashes");
    else
        print_error("%s: not refused as it should be (see above)\n", call);
    return false;
}

/* ends the child: the status must be that of a bad argument, with a word of the message */
static inline void misuse_end(pel_status status, const pel_error *error, const char *word)
{
    bool fine = status == PEL_BAD_ARGUMENT && strstr(error->what, word) != NULL;
    if (!fine)
        fprintf(stderr, "status '%s', message '%s', expected '%s'\n", pel_status_text(status), error->what, word);
    _exit(fine ? MISUSE_FINE : MISUSE_WRONG);
}

/* refused with a message that holds the word; the call's last argument is &error */
#define REFUSED(word, call)                                                                                            \
    do {                                                                                                               \
        pel_error error = {.status = PEL_OK};                                                                          \
        if (misuse_begin(#call))                                                                                       \
            misuse_end(call, &error, word);                                                                            \
    } while (0)

/* refused, with any status and message */
#define FAILS(call)                                                                                                    \
    do {                                                                                                               \
        pel_error error = {.status = PEL_OK};                                                                          \
        if (misuse_begin(#call))                                                                                       \
            _exit((call) != PEL_OK && error.what[0] != '\0' ? MISUSE_FINE : MISUSE_WRONG);                             \
    } while (0)

/* ends, without a crash */
#define SURVIVES(call)                                                                                                 \
    do {                                                                                                               \
        if (misuse_begin(#call)) {                                                                                     \
            call;                                                                                                      \
            _exit(MISUSE_FINE);                                                                                        \
        }                                                                                                              \
    } while (0)

/* a condition on the result */
#define GIVES(condition)                                                                                               \
    do {                                                                                                               \
        if (misuse_begin(#condition))                                                                                  \
            _exit((condition) ? MISUSE_FINE : MISUSE_WRONG);                                                           \
    } while (0)

#endif

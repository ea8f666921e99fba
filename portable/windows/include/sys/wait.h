/* Windows: there are no children by fork to wait for. */
#ifndef PEL_PORTABLE_WINDOWS_WAIT_H
#define PEL_PORTABLE_WINDOWS_WAIT_H
typedef struct siginfo_t {
    int si_pid;
} siginfo_t;
typedef int id_t;
#define P_PID 1
#define WNOHANG 1
#define WEXITED 4
#define WNOWAIT 16
#define WIFEXITED(status) 1
#define WEXITSTATUS(status) (status)
#define WIFSIGNALED(status) 0
#define WTERMSIG(status) 0
#define waitpid(process, status, options) ((void)(process), *(status) = 0, pel_windows_unsupported())
#define waitid(kind, process, information, options) ((void)(process), (void)(information), pel_windows_unsupported())
#endif

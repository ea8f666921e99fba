#ifndef PEL_MACOS_SYS_WAIT_H
#define PEL_MACOS_SYS_WAIT_H
#include <signal.h>
#define WNOHANG 1
#define WUNTRACED 2
#define WTERMSIG(status) ((status)&0177)
#define WIFEXITED(status) (WTERMSIG(status) == 0)
#define WEXITSTATUS(status) (((status) >> 8) & 0xff)
#define WIFSIGNALED(status) (WTERMSIG(status) != 0177 && WTERMSIG(status) != 0)
typedef enum { P_ALL, P_PID, P_PGID } idtype_t;
#define WEXITED 4
#define WNOWAIT 0x20
pid_t wait(int *status);
pid_t waitpid(pid_t process, int *status, int options);
int waitid(idtype_t kind, id_t id, siginfo_t *information, int options);
#endif

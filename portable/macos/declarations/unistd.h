#ifndef PEL_MACOS_UNISTD_H
#define PEL_MACOS_UNISTD_H
#include <sys/types.h>
#define F_OK 0
#define X_OK 1
#define W_OK 2
#define R_OK 4
#define STDIN_FILENO 0
#define STDOUT_FILENO 1
#define STDERR_FILENO 2
#define _SC_CLK_TCK 3
#define _SC_OPEN_MAX 5
#define _SC_PAGESIZE 29
#define _SC_NPROCESSORS_CONF 57
#define _SC_NPROCESSORS_ONLN 58
#define _SC_PHYS_PAGES 200
#ifndef SEEK_SET
#define SEEK_SET 0
#define SEEK_CUR 1
#define SEEK_END 2
#endif
ssize_t read(int descriptor, void *block, size_t size);
ssize_t write(int descriptor, const void *block, size_t size);
ssize_t pread(int descriptor, void *block, size_t size, off_t offset);
ssize_t pwrite(int descriptor, const void *block, size_t size, off_t offset);
ssize_t readlink(const char *path, char *text, size_t size);
off_t lseek(int descriptor, off_t offset, int from);
int close(int descriptor);
int dup(int descriptor);
int dup2(int descriptor, int other);
int pipe(int ends[2]);
int fsync(int descriptor);
void sync(void);
int ftruncate(int descriptor, off_t size);
int truncate(const char *path, off_t size);
int access(const char *path, int mode);
int chdir(const char *path);
int rmdir(const char *path);
int link(const char *from, const char *to);
int linkat(int from_folder, const char *from, int to_folder, const char *to, int flags);
int symlink(const char *target, const char *path);
int unlink(const char *path);
int unlinkat(int folder, const char *path, int flags);
int isatty(int descriptor);
int gethostname(char *name, size_t size);
char *getcwd(char *path, size_t size);
pid_t fork(void);
pid_t getpid(void);
pid_t getppid(void);
pid_t getpgrp(void);
pid_t tcgetpgrp(int descriptor);
pid_t setsid(void);
uid_t getuid(void);
uid_t geteuid(void);
gid_t getgid(void);
int execl(const char *path, const char *word, ...);
int execlp(const char *name, const char *word, ...);
int execv(const char *path, char *const words[]);
int execvp(const char *name, char *const words[]);
void _exit(int status) __attribute__((noreturn));
unsigned alarm(unsigned seconds);
unsigned sleep(unsigned seconds);
int usleep(useconds_t time);
long sysconf(int name);
#endif

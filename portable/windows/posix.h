/* Windows by MinGW-w64: what POSIX has and it lacks. The compiler includes this file before each source
   (cmake/flags.cmake), and finds the headers that are missing in include/. What Windows cannot do (processes by fork,
   limits of resources) fails with ENOSYS, and the caller says so. Paths have slashes; a path is absolute as well if it
   begins with a drive, such as C:/. */
#ifndef PEL_PORTABLE_WINDOWS_POSIX_H
#define PEL_PORTABLE_WINDOWS_POSIX_H

#include <direct.h>
#include <fcntl.h>
#include <io.h>
#include <limits.h>
#include <process.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* files are opened without translation of line ends, and not for children */
#define O_CLOEXEC (_O_NOINHERIT | _O_BINARY)
#define O_NONBLOCK 0
#define O_NOCTTY 0
#define O_NOFOLLOW 0
#define O_DIRECTORY 0
#define O_TMPFILE 0
#define AT_FDCWD (-100)
#define AT_SYMLINK_FOLLOW 0
#define S_ISSOCK(mode) 0
#define S_ISLNK(mode) 0
#ifndef NAME_MAX
#define NAME_MAX 255
#endif
#define LOCK_SH 1
#define LOCK_EX 2
#define LOCK_NB 4
#define LOCK_UN 8
#define _SC_PAGESIZE 1
#define _SC_PHYS_PAGES 2
#define _SC_NPROCESSORS_ONLN 3
#define SIGHUP 1
#define SIGKILL 9
#define SIGXFSZ 25
#define SA_RESETHAND 0x80000000u

struct sigaction {
    void (*sa_handler)(int);
    unsigned sa_flags;
    int sa_mask;
};

/* blocks with any alignment; pel_free takes them all (src/ground/base/memory.c) */
void *pel_windows_calloc(size_t count, size_t size);
void *pel_windows_realloc(void *block, size_t size);
void *pel_windows_aligned_alloc(size_t alignment, size_t size);
void pel_windows_free(void *block);

int pel_windows_mkdir(const char *path, int mode);
int pel_windows_rename(const char *from, const char *to);
int pel_windows_unlink(const char *pattern, const char *name);
char *pel_windows_realpath(const char *path, char *resolved);
int pel_windows_flock(int descriptor, int operation);
long pel_windows_sysconf(int name);
ssize_t pel_windows_getline(char **line, size_t *size, FILE *file);
int pel_windows_sigaction(int number, const struct sigaction *action, struct sigaction *old);
/* the path of this program as /proc/self/exe */
ssize_t pel_windows_readlink(const char *path, char *text, size_t size);
int pel_windows_unsupported(void);

/* the C library of Windows has a function of this name, and so have sources of ours */
#define tell pel_own_tell

#define mkdir(path, mode) pel_windows_mkdir(path, mode)
#define rename pel_windows_rename
#define realpath pel_windows_realpath
#define flock pel_windows_flock
#define sysconf pel_windows_sysconf
#define sigaction(number, action, old) pel_windows_sigaction(number, action, old)
#define lstat stat
#define fchmod(descriptor, mode) ((void)(descriptor), (void)(mode), 0)
#define fsync _commit
#define getline pel_windows_getline
/* of whole volumes only administrators may */
#define sync() ((void)0)
#define posix_fallocate(descriptor, offset, size) _chsize_s(descriptor, (offset) + (size))
#define mkdtemp(path) ((void)(path), (char *)NULL)
/* a stream of opendir knows its folder */
#define dirfd(stream) ((stream)->dd_name)
#define unlinkat(folder, name, flags) pel_windows_unlink(folder, name)
#define linkat(from, source, to, name, flags) ((void)(source), (void)(name), pel_windows_unsupported())
#define symlink(target, path) ((void)(target), (void)(path), pel_windows_unsupported())
#define readlink(path, text, size) pel_windows_readlink(path, text, size)
#define fork() pel_windows_unsupported()
#define setsid() ((void)0)
#define dprintf(descriptor, ...) ((void)(descriptor), (void)snprintf(NULL, 0, __VA_ARGS__), pel_windows_unsupported())
#ifndef getppid
#define getppid pel_windows_unsupported
#endif
#define kill(process, number) ((void)(process), pel_windows_unsupported())
#define strsignal(number) ((void)(number), "a signal")
#define gethostname(name, size) snprintf(name, size, "%s", "this machine")

#endif

/* What POSIX and Linux have and macOS lacks. The headers in include/ come before the system's and name these functions
   in place of the missing ones; no other source has to know. tools/macos compiles all sources against declarations/,
   which lists what the manual pages of macOS 11 offer. */
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <mach-o/dyld.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>
#undef pthread_cond_timedwait
#undef readlink
#undef realpath
#undef send
#undef socketpair

/* time until the end, by CLOCK_MONOTONIC; false when it is past */
static int time_left(const struct timespec *end, struct timespec *left)
{
    const long second = 1000000000;
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    left->tv_sec = end->tv_sec - now.tv_sec;
    left->tv_nsec = end->tv_nsec - now.tv_nsec;
    if (left->tv_nsec < 0) {
        left->tv_sec--;
        left->tv_nsec += second;
    }
    return left->tv_sec >= 0 && (left->tv_sec > 0 || left->tv_nsec > 0);
}

int pel_macos_sleep_until(const struct timespec *end)
{
    struct timespec left;
    if (!time_left(end, &left))
        return 0;
    return nanosleep(&left, NULL) == 0 ? 0 : errno;
}

int pel_macos_timedwait(pthread_cond_t *condition, pthread_mutex_t *mutex, const struct timespec *end)
{
    struct timespec left;
    if (!time_left(end, &left))
        return ETIMEDOUT;
    return pthread_cond_timedwait_relative_np(condition, mutex, &left);
}

int pel_macos_fallocate(int descriptor, off_t size)
{
    fstore_t store = {.fst_flags = F_ALLOCATEALL, .fst_posmode = F_PEOFPOSMODE, .fst_length = size};
    if (fcntl(descriptor, F_PREALLOCATE, &store) == -1 || ftruncate(descriptor, size) != 0)
        return errno;
    return 0;
}

/* not for children */
static int keep_from_children(int ends[2])
{
    for (int i = 0; i < 2; i++)
        if (fcntl(ends[i], F_SETFD, FD_CLOEXEC) == -1) {
            int number = errno;
            close(ends[0]);
            close(ends[1]);
            errno = number;
            return -1;
        }
    return 0;
}

int pel_macos_pipe(int ends[2])
{
    return pipe(ends) == 0 ? keep_from_children(ends) : -1;
}

int pel_macos_socketpair(int family, int kind, int protocol, int ends[2])
{
    if (socketpair(family, kind & ~SOCK_CLOEXEC, protocol, ends) != 0)
        return -1;
    return (kind & SOCK_CLOEXEC) != 0 ? keep_from_children(ends) : 0;
}

/* writing to a closed socket gives EPIPE and no signal */
ssize_t pel_macos_send(int socket, const void *block, size_t size, int flags)
{
    const int on = 1;
    setsockopt(socket, SOL_SOCKET, SO_NOSIGPIPE, &on, sizeof on);
    return send(socket, block, size, flags);
}

/* the path of the program for /proc/self/exe; NULL if it is longer than PATH_MAX */
static const char *path_of(const char *path, char program[PATH_MAX])
{
    uint32_t size = PATH_MAX;
    if (strcmp(path, "/proc/self/exe") != 0)
        return path;
    return _NSGetExecutablePath(program, &size) == 0 ? program : NULL;
}

char *pel_macos_realpath(const char *path, char *resolved)
{
    char program[PATH_MAX];
    path = path_of(path, program);
    if (path == NULL)
        errno = ENAMETOOLONG;
    return path != NULL ? realpath(path, resolved) : NULL;
}

ssize_t pel_macos_readlink(const char *path, char *text, size_t size)
{
    char program[PATH_MAX];
    if (strcmp(path, "/proc/self/exe") != 0)
        return readlink(path, text, size);
    if (pel_macos_realpath(path, program) == NULL)
        return -1;
    size_t length = strlen(program);
    memcpy(text, program, length < size ? length : size);
    return (ssize_t)(length < size ? length : size);
}

void pel_macos_closefrom(int first)
{
    for (int descriptor = first; descriptor < (int)sysconf(_SC_OPEN_MAX); descriptor++)
        close(descriptor);
}

/* Windows: the channels of a study never exist. */
#ifndef PEL_PORTABLE_WINDOWS_POLL_H
#define PEL_PORTABLE_WINDOWS_POLL_H
struct pollfd {
    int fd;
    short events, revents;
};
typedef unsigned long nfds_t;
#define POLLIN 1
#define poll(channels, count, milliseconds) ((void)(channels), (void)(count), pel_windows_unsupported())
#endif

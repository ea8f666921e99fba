/* Windows: waits for sockets. */
#ifndef PEL_PORTABLE_WINDOWS_POLL_H
#define PEL_PORTABLE_WINDOWS_POLL_H
struct pollfd {
    int fd;
    short events, revents;
};
typedef unsigned long nfds_t;
#define POLLERR 0x1
#define POLLHUP 0x2
#define POLLOUT 0x10
#define POLLIN 0x300
int pel_windows_poll(struct pollfd *sockets, nfds_t count, int milliseconds);
#define poll(sockets, count, milliseconds) pel_windows_poll(sockets, count, milliseconds)
#endif

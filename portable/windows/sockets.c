/* Windows: the functions of include/sys/socket.h, arpa/inet.h, poll.h and sys/random.h. A socket is a descriptor beyond
   those of files: SOCKETS + its handle, which Windows keeps small. */
#include "posix.h"

#include <errno.h>
#include <string.h>
#undef gethostname
#undef rename
#undef sigaction
#undef tell
#include <winsock2.h>
#include <ws2tcpip.h>
/* after windows.h, which winsock2.h includes */
#include <ntsecapi.h>

enum { SOCKETS = 1 << 24, MOST_POLLED = 1024 };

/* the layout of include/poll.h */
struct pel_pollfd {
    int fd;
    short events, revents;
};

int pel_windows_socket(int domain, int type, int protocol);
int pel_windows_bind(int socket, const void *address, int size);
int pel_windows_listen(int socket, int backlog);
int pel_windows_accept(int socket);
int pel_windows_setsockopt(int socket, int level, int name, const void *value, int size);
int pel_windows_getsockname(int socket, void *address, int *size);
ssize_t pel_windows_send(int socket, const void *bytes, size_t size);
ssize_t pel_windows_recv(int socket, void *bytes, size_t size);
int pel_windows_unblock(int socket);
int pel_windows_close(int descriptor);
int pel_windows_pipe(int ends[2]);
int pel_windows_inet_pton(const char *text, void *address);
const char *pel_windows_inet_ntop(const void *address, char *text, size_t size);
int pel_windows_poll(struct pel_pollfd *sockets, unsigned long count, int milliseconds);
int pel_windows_getentropy(void *bytes, size_t size);

static SOCKET handle_of(int descriptor)
{
    return descriptor >= SOCKETS ? (SOCKET)(descriptor - SOCKETS) : INVALID_SOCKET;
}

/* the result of a call, with errno as POSIX has it */
static int ended(int result)
{
    if (result >= 0)
        return result;
    const int error = WSAGetLastError();
    errno = error == WSAEWOULDBLOCK                        ? EWOULDBLOCK
            : error == WSAEINTR                            ? EINTR
            : error == WSAEMFILE                           ? EMFILE
            : error == WSAEACCES || error == WSAEADDRINUSE ? EADDRINUSE
                                                           : EIO;
    return -1;
}

static int descriptor_of(SOCKET made)
{
    if (made == INVALID_SOCKET)
        return ended(-1);
    if (made < (SOCKET)(INT_MAX - SOCKETS))
        return SOCKETS + (int)made;
    closesocket(made);
    errno = EMFILE;
    return -1;
}

int pel_windows_socket(int domain, int type, int protocol)
{
    WSADATA data;
    /* Windows counts these calls, and ends all at the end of the program */
    return WSAStartup(MAKEWORD(2, 2), &data) == 0 ? descriptor_of(socket(domain, type, protocol))
                                                  : pel_windows_unsupported();
}

int pel_windows_bind(int descriptor, const void *address, int size)
{
    return ended(bind(handle_of(descriptor), address, size));
}

int pel_windows_listen(int descriptor, int backlog)
{
    return ended(listen(handle_of(descriptor), backlog));
}

int pel_windows_accept(int descriptor)
{
    return descriptor_of(accept(handle_of(descriptor), NULL, NULL));
}

int pel_windows_setsockopt(int descriptor, int level, int name, const void *value, int size)
{
    return ended(setsockopt(handle_of(descriptor), level, name, value, size));
}

int pel_windows_getsockname(int descriptor, void *address, int *size)
{
    return ended(getsockname(handle_of(descriptor), address, size));
}

ssize_t pel_windows_send(int descriptor, const void *bytes, size_t size)
{
    return ended(send(handle_of(descriptor), bytes, size < INT_MAX ? (int)size : INT_MAX, 0));
}

ssize_t pel_windows_recv(int descriptor, void *bytes, size_t size)
{
    return ended(recv(handle_of(descriptor), bytes, size < INT_MAX ? (int)size : INT_MAX, 0));
}

int pel_windows_unblock(int descriptor)
{
    u_long on = 1;
    return ended(ioctlsocket(handle_of(descriptor), (long)FIONBIO, &on));
}

int pel_windows_close(int descriptor)
{
    return descriptor >= SOCKETS ? ended(closesocket(handle_of(descriptor))) : _close(descriptor);
}

int pel_windows_pipe(int ends[2])
{
    struct sockaddr_in at = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    int size = sizeof at, listener = pel_windows_socket(AF_INET, SOCK_STREAM, 0);
    ends[0] = ends[1] = -1;
    if (listener < 0)
        return -1;
    if (pel_windows_bind(listener, &at, size) == 0 && pel_windows_listen(listener, 1) == 0 &&
        pel_windows_getsockname(listener, &at, &size) == 0)
        ends[1] = pel_windows_socket(AF_INET, SOCK_STREAM, 0);
    if (ends[1] >= 0 && ended(connect(handle_of(ends[1]), (struct sockaddr *)&at, size)) == 0)
        ends[0] = pel_windows_accept(listener);
    pel_windows_close(listener);
    if (ends[0] >= 0)
        return 0;
    if (ends[1] >= 0)
        pel_windows_close(ends[1]);
    ends[1] = -1;
    return -1;
}

int pel_windows_inet_pton(const char *text, void *address)
{
    return inet_pton(AF_INET, text, address);
}

const char *pel_windows_inet_ntop(const void *address, char *text, size_t size)
{
    return inet_ntop(AF_INET, address, text, size);
}

int pel_windows_poll(struct pel_pollfd *sockets, unsigned long count, int milliseconds)
{
    WSAPOLLFD polled[MOST_POLLED];
    if (count > MOST_POLLED) {
        errno = EINVAL;
        return -1;
    }
    for (unsigned long i = 0; i < count; i++)
        polled[i] = (WSAPOLLFD){.fd = handle_of(sockets[i].fd), .events = sockets[i].events};
    int result = ended(WSAPoll(polled, count, milliseconds));
    for (unsigned long i = 0; i < count; i++)
        sockets[i].revents = result > 0 ? polled[i].revents : 0;
    return result;
}

int pel_windows_getentropy(void *bytes, size_t size)
{
    return RtlGenRandom(bytes, (ULONG)size) ? 0 : -1;
}

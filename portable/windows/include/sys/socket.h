/* Windows: sockets of TCP, by functions of sockets.c. Studies need socketpair and fork, which there are not. */
#ifndef PEL_PORTABLE_WINDOWS_SOCKET_H
#define PEL_PORTABLE_WINDOWS_SOCKET_H
#include <stdint.h>
#define AF_UNIX 1
#define AF_INET 2
#define SOCK_STREAM 1
#define SOCK_CLOEXEC 0
#define SOL_SOCKET 0xffff
/* elsewhere it lets a port be used again at once, which Windows always does; here it keeps others away from the port */
#define SO_REUSEADDR (~4)
#define SOMAXCONN 0x7fffffff
/* sockets that fcntl was called for never wait */
#define MSG_NOSIGNAL 0
#define MSG_DONTWAIT 0
#define F_SETFD 2
#define F_SETFL 4
#define FD_CLOEXEC 1
#define INET_ADDRSTRLEN 16

typedef int socklen_t;
struct in_addr {
    uint32_t s_addr;
};
struct sockaddr {
    uint16_t sa_family;
    char sa_data[14];
};
struct sockaddr_in {
    int16_t sin_family;
    uint16_t sin_port;
    struct in_addr sin_addr;
    char sin_zero[8];
};

int pel_windows_socket(int domain, int type, int protocol);
int pel_windows_bind(int socket, const void *address, socklen_t size);
int pel_windows_listen(int socket, int backlog);
int pel_windows_accept(int socket);
int pel_windows_setsockopt(int socket, int level, int name, const void *value, socklen_t size);
int pel_windows_getsockname(int socket, void *address, socklen_t *size);
ssize_t pel_windows_send(int socket, const void *bytes, size_t size);
ssize_t pel_windows_recv(int socket, void *bytes, size_t size);
int pel_windows_unblock(int socket);
int pel_windows_close(int descriptor);
/* two ends of a channel that can be polled, as sockets are */
int pel_windows_pipe(int ends[2]);

#define socket pel_windows_socket
#define bind(socket, address, size) pel_windows_bind(socket, address, size)
#define listen(socket, backlog) pel_windows_listen(socket, backlog)
#define accept(socket, address, size) pel_windows_accept(socket)
#define setsockopt pel_windows_setsockopt
#define getsockname pel_windows_getsockname
#define send(socket, bytes, size, flags) pel_windows_send(socket, bytes, size)
#define recv(socket, bytes, size, flags) pel_windows_recv(socket, bytes, size)
#define read(socket, bytes, size) pel_windows_recv(socket, bytes, size)
#define write(socket, bytes, size) pel_windows_send(socket, bytes, size)
#define fcntl(socket, command, flags) pel_windows_unblock(socket)
#define close(descriptor) pel_windows_close(descriptor)
#define pipe(ends) pel_windows_pipe(ends)
#define socketpair(domain, type, protocol, ends) ((void)(ends), (ends)[0] = (ends)[1] = -1, pel_windows_unsupported())
#endif

#ifndef PEL_MACOS_SYS_SOCKET_H
#define PEL_MACOS_SYS_SOCKET_H
#include <sys/types.h>
#define AF_UNIX 1
#define AF_INET 2
#define AF_INET6 30
#define SOCK_STREAM 1
#define SOCK_DGRAM 2
#define SOL_SOCKET 0xffff
#define SO_REUSEADDR 0x0004
#define SO_KEEPALIVE 0x0008
#define SO_SNDBUF 0x1001
#define SO_RCVBUF 0x1002
#define SO_ERROR 0x1007
#define SO_NOSIGPIPE 0x1022
#define SOMAXCONN 128
#define MSG_PEEK 0x2
#define MSG_DONTWAIT 0x80
#define SHUT_RD 0
#define SHUT_WR 1
#define SHUT_RDWR 2
typedef uint8_t sa_family_t;
typedef uint32_t socklen_t;
struct sockaddr {
    uint8_t sa_len;
    sa_family_t sa_family;
    char sa_data[14];
};
int socket(int family, int kind, int protocol);
int socketpair(int family, int kind, int protocol, int ends[2]);
int bind(int socket, const struct sockaddr *address, socklen_t size);
int listen(int socket, int waiting);
int accept(int socket, struct sockaddr *address, socklen_t *size);
int connect(int socket, const struct sockaddr *address, socklen_t size);
int shutdown(int socket, int how);
int getsockname(int socket, struct sockaddr *address, socklen_t *size);
int getpeername(int socket, struct sockaddr *address, socklen_t *size);
int getsockopt(int socket, int level, int name, void *value, socklen_t *size);
int setsockopt(int socket, int level, int name, const void *value, socklen_t size);
ssize_t send(int socket, const void *block, size_t size, int flags);
ssize_t recv(int socket, void *block, size_t size, int flags);
#endif

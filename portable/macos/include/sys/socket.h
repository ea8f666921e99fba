#include_next <sys/socket.h>
#ifndef PEL_PORTABLE_MACOS_SYS_SOCKET_H
#define PEL_PORTABLE_MACOS_SYS_SOCKET_H
/* a flag of kinds of sockets that macOS leaves free */
#define SOCK_CLOEXEC 0x40000000
int pel_macos_socketpair(int family, int kind, int protocol, int ends[2]);
#define socketpair pel_macos_socketpair

/* no signal from closed sockets is an option of the socket here */
#undef MSG_NOSIGNAL
#define MSG_NOSIGNAL 0
ssize_t pel_macos_send(int socket, const void *block, size_t size, int flags);
#define send pel_macos_send
#endif

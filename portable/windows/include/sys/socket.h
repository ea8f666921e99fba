/* Windows: the channels between a study and its workers, which need fork. */
#ifndef PEL_PORTABLE_WINDOWS_SOCKET_H
#define PEL_PORTABLE_WINDOWS_SOCKET_H
#define AF_UNIX 1
#define SOCK_STREAM 1
#define SOCK_CLOEXEC 0
#define MSG_NOSIGNAL 0
#define MSG_DONTWAIT 0
#define socketpair(domain, type, protocol, ends) ((void)(ends), (ends)[0] = (ends)[1] = -1, pel_windows_unsupported())
#define send(channel, bytes, size, flags) ((void)(channel), (void)(bytes), (void)(size), pel_windows_unsupported())
#define recv(channel, bytes, size, flags) ((void)(channel), (void)(bytes), (void)(size), pel_windows_unsupported())
#endif

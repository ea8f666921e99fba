/* Windows: addresses of the Internet, by functions of sockets.c. */
#ifndef PEL_PORTABLE_WINDOWS_INET_H
#define PEL_PORTABLE_WINDOWS_INET_H
#include <sys/socket.h>
int pel_windows_inet_pton(const char *text, void *address);
const char *pel_windows_inet_ntop(const void *address, char *text, size_t size);
#define inet_pton(family, text, address) pel_windows_inet_pton(text, address)
#define inet_ntop(family, address, text, size) pel_windows_inet_ntop(address, text, size)
#define htons(number) __builtin_bswap16(number)
#define ntohs(number) __builtin_bswap16(number)
#endif

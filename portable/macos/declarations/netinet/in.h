#ifndef PEL_MACOS_NETINET_IN_H
#define PEL_MACOS_NETINET_IN_H
#include <sys/socket.h>
#define IPPROTO_TCP 6
#define INET_ADDRSTRLEN 16
#define INADDR_ANY ((in_addr_t)0)
#define INADDR_LOOPBACK ((in_addr_t)0x7f000001)
typedef uint16_t in_port_t;
typedef uint32_t in_addr_t;
struct in_addr {
    in_addr_t s_addr;
};
struct sockaddr_in {
    uint8_t sin_len;
    sa_family_t sin_family;
    in_port_t sin_port;
    struct in_addr sin_addr;
    char sin_zero[8];
};
#endif

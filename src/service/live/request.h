/* The head of an HTTP request (RFC 9112), as far as the server needs it: GET, a few headers, a token. */
#ifndef PEL_LIVE_REQUEST_H
#define PEL_LIVE_REQUEST_H

#include <stdbool.h>
#include <stddef.h>

enum { PEL_HEAD_LIMIT = 16384, PEL_TOKEN_SIZE = 64, PEL_HOST_SIZE = 300 };

typedef enum pel_request_end {
    PEL_REQUEST_WHOLE,
    PEL_REQUEST_PART, /* more bytes are needed */
    PEL_REQUEST_BAD,  /* not HTTP, a zero byte, two hosts, or a value that is too long */
} pel_request_end;

typedef struct pel_request {
    bool is_get;
    char path[PEL_TOKEN_SIZE];  /* up to the query; cut */
    bool has_query_token;       /* then `token` is that of the address, otherwise that of the cookie, "" = none */
    char token[PEL_TOKEN_SIZE]; /* "" where it is too long */
    char host[PEL_HOST_SIZE];   /* "" = none */
    char origin[PEL_HOST_SIZE]; /* "" = none */
    bool upgrades;              /* to a WebSocket of version 13 */
    char key[PEL_TOKEN_SIZE];   /* Sec-WebSocket-Key */
    bool has_protocol;          /* the page asks for the protocol "pellicle" */
    size_t size;                /* bytes of the head */
} pel_request;

/* cookie: the name of the cookie with the token. A head above PEL_HEAD_LIMIT bytes is PEL_REQUEST_BAD. */
pel_request_end pel_request_parse(const char *bytes, size_t size, const char *cookie, pel_request *request);

#endif

/* WebSocket frames (RFC 6455) on the side of a server: texts come in, in any pieces; other kinds and frames without a
   mask end the channel. */
#ifndef PEL_LIVE_CHANNEL_H
#define PEL_LIVE_CHANNEL_H

#include "live/digest.h"

#include <stdbool.h>
#include <stdint.h>

enum {
    PEL_CHANNEL_HEAD = 14,   /* bytes of the longest head that comes */
    PEL_CHANNEL_OUT = 10,    /* and of one that goes out */
    PEL_CONTROL_LIMIT = 125, /* payload of a ping */
};

typedef enum pel_frame_kind {
    PEL_FRAME_MORE = 0,
    PEL_FRAME_TEXT = 1,
    PEL_FRAME_BINARY = 2,
    PEL_FRAME_CLOSE = 8,
    PEL_FRAME_PING = 9,
    PEL_FRAME_PONG = 10
} pel_frame_kind;

/* a side that receives */
typedef struct pel_channel {
    unsigned char head[PEL_CHANNEL_HEAD];
    size_t head_size; /* bytes of it that are here */
    bool in_payload;
    uint64_t left, done; /* bytes of the payload */
    char *text;          /* (room) the message so far, zero-terminated */
    size_t length, room;
    bool in_message; /* its last frame has not come */
    unsigned char control[PEL_CONTROL_LIMIT];
    size_t control_size;
} pel_channel;

typedef enum pel_channel_event {
    PEL_CHANNEL_NOTHING, /* all bytes are taken */
    PEL_CHANNEL_MESSAGE, /* `text` is whole: read it before the next call */
    PEL_CHANNEL_PINGED,  /* answer by `control` */
    PEL_CHANNEL_CLOSED,  /* the other side ends the channel */
    PEL_CHANNEL_REFUSED, /* a frame that is not allowed, or a message above PEL_MESSAGE_LIMIT */
} pel_channel_event;

/* Takes bytes, *used of them, up to the next event. */
pel_channel_event pel_channel_take(pel_channel *channel, const unsigned char *bytes, size_t size, size_t *used);
void pel_channel_free(pel_channel *channel);

/* The head of a frame of `size` bytes, written so that it ends at `end`; returns its first byte. */
unsigned char *pel_channel_head(unsigned char *end, pel_frame_kind kind, size_t size);
/* The answer to a key. */
void pel_channel_accept(const char *key, char accept[PEL_DIGEST_TEXT]);

#endif

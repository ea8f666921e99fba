#include "live/channel.h"

#include "base/memory.h"
#include "live/mailbox.h"

#include <stdio.h>
#include <string.h>

enum { FINAL = 0x80, RESERVED = 0x70, KIND = 0x0f, MASKED = 0x80, LENGTH = 0x7f, LONG_LENGTH = 127, MASK_SIZE = 4 };

static bool is_control(const pel_channel *channel)
{
    return (channel->head[0] & KIND) >= PEL_FRAME_CLOSE;
}

/* bytes of the head, as far as its beginning tells */
static size_t head_needed(const pel_channel *channel)
{
    if (channel->head_size < 2)
        return 2;
    int length = channel->head[1] & LENGTH;
    return 2 + (length == LONG_LENGTH ? 8u : length == LONG_LENGTH - 1 ? 2u : 0u) + MASK_SIZE;
}

/* checks that need only the first two bytes */
static bool may_begin(const pel_channel *channel)
{
    int kind = channel->head[0] & KIND;
    if ((channel->head[1] & MASKED) == 0 || (channel->head[0] & RESERVED) != 0)
        return false;
    if (is_control(channel))
        return kind <= PEL_FRAME_PONG && (channel->head[0] & FINAL) != 0 &&
               (channel->head[1] & LENGTH) <= PEL_CONTROL_LIMIT;
    return kind == (channel->in_message ? PEL_FRAME_MORE : PEL_FRAME_TEXT);
}

/* makes room for the payload of a whole head */
static bool begin_payload(pel_channel *channel)
{
    void *text = channel->text;
    uint64_t size = channel->head[1] & LENGTH;
    if (size >= LONG_LENGTH - 1) {
        size_t end = channel->head_size - MASK_SIZE;
        size = 0;
        for (size_t i = 2; i < end; i++)
            size = size << 8 | channel->head[i];
    }
    channel->in_payload = true;
    channel->left = size;
    channel->done = 0;
    channel->control_size = 0;
    if (is_control(channel))
        return true;
    channel->in_message = true;
    if (size > PEL_MESSAGE_LIMIT || channel->length + size > PEL_MESSAGE_LIMIT ||
        !pel_reserve(&text, &channel->room, channel->length + (size_t)size + 1, 1))
        return false;
    channel->text = text;
    return true;
}

/* a piece of the payload without its mask; false where a text has a zero byte */
static bool take_payload(pel_channel *channel, const unsigned char *bytes, size_t size)
{
    const unsigned char *mask = channel->head + channel->head_size - MASK_SIZE;
    unsigned char *to = channel->control + channel->control_size;
    if (is_control(channel)) {
        channel->control_size += size;
    } else {
        to = (unsigned char *)channel->text + channel->length;
        channel->length += size;
        channel->text[channel->length] = '\0';
    }
    for (size_t i = 0; i < size; i++)
        to[i] = bytes[i] ^ mask[(channel->done + i) % MASK_SIZE];
    channel->done += size;
    channel->left -= size;
    return is_control(channel) || memchr(to, '\0', size) == NULL;
}

static pel_channel_event end_frame(pel_channel *channel)
{
    int kind = channel->head[0] & KIND;
    bool is_final = (channel->head[0] & FINAL) != 0;
    channel->in_payload = false;
    channel->head_size = 0;
    if (kind == PEL_FRAME_CLOSE)
        return PEL_CHANNEL_CLOSED;
    if (kind == PEL_FRAME_PING)
        return PEL_CHANNEL_PINGED;
    if (kind == PEL_FRAME_PONG || !is_final)
        return PEL_CHANNEL_NOTHING;
    channel->text[channel->length] = '\0';
    channel->length = 0;
    channel->in_message = false;
    return PEL_CHANNEL_MESSAGE;
}

pel_channel_event pel_channel_take(pel_channel *channel, const unsigned char *bytes, size_t size, size_t *used)
{
    pel_channel_event event = PEL_CHANNEL_NOTHING;
    *used = 0;
    while (event == PEL_CHANNEL_NOTHING && (*used < size || (channel->in_payload && channel->left == 0))) {
        if (!channel->in_payload) {
            channel->head[channel->head_size++] = bytes[(*used)++];
            if (channel->head_size == 2 && !may_begin(channel))
                return PEL_CHANNEL_REFUSED;
            if (channel->head_size == head_needed(channel) && !begin_payload(channel))
                return PEL_CHANNEL_REFUSED;
            continue;
        }
        size_t piece = channel->left < size - *used ? (size_t)channel->left : size - *used;
        if (piece > 0 && !take_payload(channel, bytes + *used, piece))
            return PEL_CHANNEL_REFUSED;
        *used += piece;
        if (channel->left == 0)
            event = end_frame(channel);
    }
    return event;
}

void pel_channel_free(pel_channel *channel)
{
    pel_free(channel->text);
    *channel = (pel_channel){0};
}

unsigned char *pel_channel_head(unsigned char *end, pel_frame_kind kind, size_t size)
{
    size_t length = size < LONG_LENGTH - 1 ? 2 : size <= 0xffff ? 4 : PEL_CHANNEL_OUT;
    unsigned char *head = end - length;
    head[0] = (unsigned char)(FINAL | (int)kind);
    head[1] = (unsigned char)(length == 2 ? size : length == 4 ? LONG_LENGTH - 1 : LONG_LENGTH);
    for (size_t i = 2; i < length; i++)
        head[i] = (unsigned char)((uint64_t)size >> (8 * (length - 1 - i)));
    return head;
}

void pel_channel_accept(const char *key, char accept[PEL_DIGEST_TEXT])
{
    char text[200];
    unsigned char digest[PEL_SHA1_SIZE];
    int length = snprintf(text, sizeof text, "%.100s258EAFA5-E914-47DA-95CA-C5AB0DC85B11", key);
    pel_sha1(text, (size_t)length, digest);
    pel_digest_text(digest, sizeof digest, accept);
}

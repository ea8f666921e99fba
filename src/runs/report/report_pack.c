#include "report/report_pack.h"

#include "base/memory.h"
#include "io/zlib_memory.h"

#include <string.h>

/* level 1 packs differences of neighbouring frames within 4 % of level 6 in half of the time */
enum { LEVEL = 1, LEAST_ROOM = 1 << 16 };

pel_status pel_report_pack_open(pel_report_pack *pack, size_t limit, pel_error *error)
{
    *pack = (pel_report_pack){.limit = limit};
    z_stream *stream = pel_allocate(1, sizeof *stream);
    if (stream == NULL)
        return pel_fail_memory(error);
    stream->zalloc = pel_zlib_allocate;
    stream->zfree = pel_zlib_release;
    if (deflateInit(stream, LEVEL) != Z_OK) {
        pel_free(stream);
        return pel_fail_memory(error);
    }
    pack->stream = stream;
    return PEL_OK;
}

/* packs the pending input of the stream */
static pel_status pump(pel_report_pack *pack, int flush, pel_error *error)
{
    z_stream *stream = pack->stream;
    do {
        if (!pel_reserve(&pack->bytes, &pack->capacity, pack->size + LEAST_ROOM, 1))
            return pel_fail_memory(error);
        size_t room = pack->capacity - pack->size;
        stream->next_out = (Bytef *)pack->bytes + pack->size;
        stream->avail_out = room < UINT32_MAX ? (uInt)room : UINT32_MAX;
        uInt before = stream->avail_out;
        deflate(stream, flush);
        pack->size += before - stream->avail_out;
        pack->full = pack->full || pack->size > pack->limit;
    } while (stream->avail_out == 0 && !pack->full);
    return PEL_OK;
}

pel_status pel_report_pack_add(pel_report_pack *pack, const void *bytes, size_t size, pel_error *error)
{
    const size_t largest = (size_t)1 << 30;
    const Bytef *at = bytes;
    pel_status status = PEL_OK;
    while (status == PEL_OK && size > 0 && !pack->full) {
        z_stream *stream = pack->stream;
        size_t piece = size < largest ? size : largest;
        stream->next_in = (Bytef *)(uintptr_t)at;
        stream->avail_in = (uInt)piece;
        status = pump(pack, Z_NO_FLUSH, error);
        at += piece;
        size -= piece;
    }
    return status;
}

static void close_stream(pel_report_pack *pack)
{
    if (pack->stream == NULL)
        return;
    deflateEnd(pack->stream);
    pel_free(pack->stream);
    pack->stream = NULL;
}

pel_status pel_report_pack_close(pel_report_pack *pack, pel_error *error)
{
    pel_status status = pump(pack, Z_FINISH, error);
    close_stream(pack);
    return status;
}

void pel_report_pack_free(pel_report_pack *pack)
{
    close_stream(pack);
    pel_free(pack->bytes);
    *pack = (pel_report_pack){0};
}

/* four letters for up to three bytes */
static void encode_three(const unsigned char *bytes, size_t count, char letters[4])
{
    static const char alphabet[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    unsigned a = bytes[0], b = count > 1 ? bytes[1] : 0, c = count > 2 ? bytes[2] : 0;
    letters[0] = alphabet[a >> 2];
    letters[1] = alphabet[(a & 3) << 4 | b >> 4];
    letters[2] = count > 1 ? alphabet[(b & 15) << 2 | c >> 6] : '=';
    letters[3] = count > 2 ? alphabet[c & 63] : '=';
}

void pel_report_pack_write_base64(const pel_report_pack *pack, pel_file_writer *writer)
{
    char letters[4096];
    size_t used = 0;
    for (size_t at = 0; at < pack->size; at += 3) {
        size_t left = pack->size - at;
        encode_three((const unsigned char *)pack->bytes + at, left < 3 ? left : 3, letters + used);
        used += 4;
        if (used == sizeof letters || left <= 3) {
            pel_file_writer_write(writer, letters, used);
            used = 0;
        }
    }
}

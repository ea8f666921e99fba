#include "io/vtk_blocks.h"

#include "base/memory.h"
#include "io/zlib_memory.h"

#include <string.h>

/* bytes of a whole block; and the level: 6 packs a frame a tenth better but takes 20 times as long on triangles, and
   Huffman codes alone or run lengths are not faster than level 1 */
enum { BLOCK_SIZE = 1 << 16, LEVEL = 1, HEAD_WORDS = PEL_VTK_BLOCKS_WORDS };

static size_t count_blocks(size_t size)
{
    return size / BLOCK_SIZE + (size % BLOCK_SIZE != 0);
}

static void store_word(unsigned char *bytes, uint64_t value)
{
    memcpy(bytes, &value, sizeof value);
}

uint64_t pel_vtk_blocks_word(const unsigned char *bytes, size_t word_size)
{
    uint64_t value = 0;
    uint32_t half = 0;
    if (word_size == sizeof value) {
        memcpy(&value, bytes, sizeof value);
        return value;
    }
    memcpy(&half, bytes, sizeof half);
    return half;
}

size_t pel_vtk_blocks_bound(size_t size)
{
    size_t count = count_blocks(size);
    return (HEAD_WORDS + count) * sizeof(uint64_t) + count * compressBound(BLOCK_SIZE);
}

pel_status pel_vtk_blocks_pack(const void *bytes, size_t size, unsigned char *packed, size_t *packed_size,
                               pel_error *error)
{
    size_t count = count_blocks(size);
    unsigned char *out = packed + (HEAD_WORDS + count) * sizeof(uint64_t);
    z_stream stream = {.zalloc = pel_zlib_allocate, .zfree = pel_zlib_release};
    if (deflateInit(&stream, LEVEL) != Z_OK)
        return pel_fail_memory(error);
    store_word(packed, count);
    store_word(packed + 8, BLOCK_SIZE);
    store_word(packed + 16, size % BLOCK_SIZE);
    for (size_t i = 0; i < count; i++) {
        size_t start = i * BLOCK_SIZE, length = size - start < BLOCK_SIZE ? size - start : BLOCK_SIZE;
        uLong room = compressBound(BLOCK_SIZE);
        deflateReset(&stream);
        stream.next_in = (Bytef *)(uintptr_t)((const unsigned char *)bytes + start);
        stream.avail_in = (uInt)length;
        stream.next_out = out;
        stream.avail_out = (uInt)room;
        /* cannot fail: the size is zlib's own bound */
        deflate(&stream, Z_FINISH);
        out += stream.total_out;
        store_word(packed + (HEAD_WORDS + i) * sizeof(uint64_t), stream.total_out);
    }
    deflateEnd(&stream);
    *packed_size = (size_t)(out - packed);
    return PEL_OK;
}

size_t pel_vtk_blocks_check(const unsigned char *packed, size_t available, size_t word_size, size_t size)
{
    /* deflate cannot shrink further than this */
    const size_t best_ratio = 1032;
    if (available / word_size < HEAD_WORDS)
        return 0;
    uint64_t count = pel_vtk_blocks_word(packed, word_size);
    uint64_t whole = pel_vtk_blocks_word(packed + word_size, word_size);
    uint64_t last = pel_vtk_blocks_word(packed + 2 * word_size, word_size);
    if (count > available / word_size - HEAD_WORDS || (count == 0) != (size == 0))
        return 0;
    size_t used = (size_t)(HEAD_WORDS + count) * word_size;
    if (count == 0)
        return used;
    uint64_t whole_count = last != 0 ? count - 1 : count;
    if (whole == 0 || last > whole || whole_count > size / whole || whole_count * whole + last != size ||
        size / best_ratio > available || whole > UINT32_MAX)
        return 0;
    for (uint64_t i = 0; i < count; i++) {
        uint64_t length = pel_vtk_blocks_word(packed + (HEAD_WORDS + (size_t)i) * word_size, word_size);
        if (length > available - used || length > UINT32_MAX)
            return 0;
        used += (size_t)length;
    }
    return used;
}

pel_status pel_vtk_blocks_unpack(const unsigned char *packed, size_t word_size, void *bytes, size_t size,
                                 pel_error *error)
{
    size_t count = (size_t)pel_vtk_blocks_word(packed, word_size);
    size_t whole = (size_t)pel_vtk_blocks_word(packed + word_size, word_size);
    const unsigned char *in = packed + (HEAD_WORDS + count) * word_size;
    z_stream stream = {.zalloc = pel_zlib_allocate, .zfree = pel_zlib_release};
    if (inflateInit(&stream) != Z_OK)
        return pel_fail_memory(error);
    int result = Z_STREAM_END;
    for (size_t i = 0; i < count && result == Z_STREAM_END; i++) {
        size_t start = i * whole, length = size - start < whole ? size - start : whole;
        inflateReset(&stream);
        stream.next_in = (Bytef *)(uintptr_t)in;
        stream.avail_in = (uInt)pel_vtk_blocks_word(packed + (HEAD_WORDS + i) * word_size, word_size);
        stream.next_out = (unsigned char *)bytes + start;
        stream.avail_out = (uInt)length;
        in += stream.avail_in;
        result = inflate(&stream, Z_FINISH);
        if (result == Z_STREAM_END && stream.avail_out != 0)
            result = Z_DATA_ERROR;
    }
    inflateEnd(&stream);
    if (result == Z_MEM_ERROR)
        return pel_fail_memory(error);
    if (result != Z_STREAM_END)
        return pel_fail(error, PEL_BAD_FORMAT, "packed data is damaged");
    return PEL_OK;
}

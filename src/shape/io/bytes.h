/* Integers and floats of either byte order in memory, on machines of either order. */
#ifndef PEL_IO_BYTES_H
#define PEL_IO_BYTES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* value, with its bytes reversed if their order differs from this machine's */
static inline uint64_t pel_vertex_order_bytes(uint64_t value, size_t size, bool big_endian)
{
    const bool same = big_endian == (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__);
    return same ? value : __builtin_bswap64(value) >> (64 - 8 * size);
}

/* `size` (1, 2, 4 or 8) bytes as an unsigned integer */
static inline uint64_t pel_load_bytes(const char *bytes, size_t size, bool big_endian)
{
    uint64_t value;
    uint32_t value_4;
    uint16_t value_2;
    switch (size) {
    case 1:
        return (unsigned char)*bytes;
    case 2:
        memcpy(&value_2, bytes, sizeof value_2);
        return pel_vertex_order_bytes(value_2, size, big_endian);
    case 4:
        memcpy(&value_4, bytes, sizeof value_4);
        return pel_vertex_order_bytes(value_4, size, big_endian);
    default:
        memcpy(&value, bytes, sizeof value);
        return pel_vertex_order_bytes(value, size, big_endian);
    }
}

/* turns `size` bytes around */
static inline void pel_swap_bytes(unsigned char *bytes, size_t size)
{
    for (size_t i = 0; i < size / 2; i++) {
        unsigned char first = bytes[i];
        bytes[i] = bytes[size - 1 - i];
        bytes[size - 1 - i] = first;
    }
}

static inline void pel_store_bytes(char *bytes, size_t size, bool big_endian, uint64_t value)
{
    for (size_t i = 0; i < size; i++)
        bytes[i] = (char)(unsigned char)(value >> (8 * (big_endian ? size - 1 - i : i)));
}

static inline double pel_load_float(const char *bytes, bool big_endian)
{
    uint32_t bits = (uint32_t)pel_load_bytes(bytes, 4, big_endian);
    float value;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

static inline double pel_load_double(const char *bytes, bool big_endian)
{
    uint64_t bits = pel_load_bytes(bytes, 8, big_endian);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static inline void pel_store_float(char *bytes, bool big_endian, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    pel_store_bytes(bytes, 4, big_endian, bits);
}

static inline void pel_store_double(char *bytes, bool big_endian, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    pel_store_bytes(bytes, 8, big_endian, bits);
}

#endif

/* Integers and floats of either byte order in memory, whatever the order of this machine. */
#ifndef PEL_IO_BYTES_H
#define PEL_IO_BYTES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* `size` (1, 2, 4 or 8) bytes as an unsigned integer */
static inline uint64_t pel_load_bytes(const char *bytes, size_t size, bool big_endian)
{
    uint64_t value = 0;
    for (size_t i = 0; i < size; i++)
        value |= (uint64_t)(unsigned char)bytes[i] << (8 * (big_endian ? size - 1 - i : i));
    return value;
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

/* 64-bit FNV-1a hash (Fowler, Noll, Vo), over 64-bit words or bytes. */
#ifndef PEL_BASE_HASH_H
#define PEL_BASE_HASH_H

#include <stddef.h>
#include <stdint.h>

#define PEL_HASH_START UINT64_C(14695981039346656037)

static inline uint64_t pel_hash_word(uint64_t hash, uint64_t word)
{
    return (hash ^ word) * UINT64_C(1099511628211);
}

static inline uint64_t pel_hash_bytes(uint64_t hash, const void *bytes, size_t size)
{
    for (size_t i = 0; i < size; i++)
        hash = pel_hash_word(hash, ((const unsigned char *)bytes)[i]);
    return hash;
}

#endif

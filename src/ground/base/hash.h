/* 64-bit FNV-1a hash (Fowler, Noll, Vo), over 64-bit words or bytes. */
#ifndef PEL_BASE_HASH_H
#define PEL_BASE_HASH_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

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

static inline uint64_t pel_hash_mix(uint64_t hash, uint64_t word)
{
    hash = (hash ^ word) * UINT64_C(0x9e3779b97f4a7c15);
    return hash ^ hash >> 32;
}

/* Another hash of bytes, some ten times as fast, of four sums that run side by side. Unlike in the ones above no change
   of high bits, such as of signs, is taken back by a second one. */
static inline uint64_t pel_hash_block(uint64_t hash, const void *bytes, size_t size)
{
    uint64_t sums[4] = {hash, hash + 1, hash + 2, hash + 3};
    const unsigned char *at = bytes;
    for (size_t i = 0; 8 * i < size; i++) {
        uint64_t word = 0;
        if (size - 8 * i >= sizeof word)
            memcpy(&word, at + 8 * i, sizeof word);
        else
            memcpy(&word, at + 8 * i, size - 8 * i);
        sums[i % 4] = pel_hash_mix(sums[i % 4], word);
    }
    hash = pel_hash_mix(hash, size);
    for (int i = 0; i < 4; i++)
        hash = pel_hash_mix(hash, sums[i]);
    return hash;
}

#endif

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

/* Another hash of bytes, some ten times as fast, of four sums that run side by side. Unlike in the ones above no change
   of high bits, such as of signs, is taken back by a second one. */
static inline uint64_t pel_hash_block(uint64_t hash, const void *bytes, size_t size)
{
    uint64_t sums[4] = {hash, hash + 1, hash + 2, hash + 3}, word;
    const unsigned char *at = bytes;
    size_t count = (size + 7) / 8;
    for (size_t i = 0; i < count; i++) {
        size_t left = size - 8 * i;
        word = 0;
        if (left >= 8)
            memcpy(&word, at + 8 * i, 8);
        else
            memcpy(&word, at + 8 * i, left);
        uint64_t sum = pel_hash_word(sums[i % 4], word);
        sums[i % 4] = sum ^ sum >> 32;
    }
    for (int i = 1; i < 4; i++) {
        sums[0] = pel_hash_word(sums[0], sums[i]);
        sums[0] ^= sums[0] >> 32;
    }
    return pel_hash_word(sums[0], size);
}

#endif

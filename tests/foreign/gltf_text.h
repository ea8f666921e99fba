/* The text of a .gltf file whose numbers are inside it. */
#ifndef PEL_TESTS_FOREIGN_GLTF_TEXT_H
#define PEL_TESTS_FOREIGN_GLTF_TEXT_H

#include "io/bytes.h"

#include <stdio.h>

typedef struct gltf_text {
    size_t size; /* bytes of the one buffer */
    char bytes[2400];
    char text[80000];
} gltf_text;

static inline void gltf_base64(const char *bytes, size_t size, char *text)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < size; i += 3) {
        uint32_t group = 0;
        for (size_t k = 0; k < 3; k++)
            group = group << 8 | (i + k < size ? (unsigned char)bytes[i + k] : 0u);
        for (size_t k = 0; k < 4; k++)
            *text++ = i + k > size ? '=' : digits[group >> (18 - 6 * k) & 63];
    }
    *text = '\0';
}

/* `middle`, which begins with the bracket of the file, and the buffer; lives as long as the file */
static inline const char *gltf_text_end(gltf_text *file, const char *middle)
{
    char numbers[3300];
    gltf_base64(file->bytes, file->size, numbers);
    snprintf(file->text, sizeof file->text,
             "%s,\"buffers\":[{\"byteLength\":%zu,\"uri\":\"data:application/octet-stream;base64,%s\"}]}", middle,
             file->size, numbers);
    return file->text;
}

#endif

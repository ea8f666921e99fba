/* Base64 (RFC 4648, section 4). */
#ifndef PEL_IO_BASE64_H
#define PEL_IO_BASE64_H

#include <stddef.h>

/* Decodes text at..end into at most `limit` bytes and returns how many; stops at the first character outside the
   alphabet. White space is skipped, and padding ends a group only: pieces that were encoded one by one may follow each
   other, as in files of VTK. */
size_t pel_base64_decode(const char *at, const char *end, unsigned char *bytes, size_t limit);

#endif

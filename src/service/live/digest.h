/* SHA-1 and SHA-256 (FIPS 180-4): the key of a WebSocket, and the hashes of a page's scripts. Not for secrets. */
#ifndef PEL_LIVE_DIGEST_H
#define PEL_LIVE_DIGEST_H

#include <stddef.h>

enum { PEL_SHA1_SIZE = 20, PEL_SHA256_SIZE = 32, PEL_DIGEST_TEXT = 45 };

void pel_sha1(const void *bytes, size_t size, unsigned char digest[PEL_SHA1_SIZE]);
void pel_sha256(const void *bytes, size_t size, unsigned char digest[PEL_SHA256_SIZE]);
/* base64 of size <= PEL_SHA256_SIZE bytes */
void pel_digest_text(const unsigned char *digest, size_t size, char text[PEL_DIGEST_TEXT]);

#endif

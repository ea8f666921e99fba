/* The zlib block format of VTK's appended data (vtkZLibDataCompressor): a head of words
       block count, bytes of a whole block, bytes of the last block when it is shorter (else 0), packed bytes of each
   block followed by the packed blocks. Words have the byte order of this machine and 8 (or, when reading, 4) bytes. */
#ifndef PEL_IO_VTK_BLOCKS_H
#define PEL_IO_VTK_BLOCKS_H

#include "base/status.h"

/* words before the packed sizes */
enum { PEL_VTK_BLOCKS_WORDS = 3 };

/* the most bytes that packing `size` bytes can give */
size_t pel_vtk_blocks_bound(size_t size);

/* Packs size bytes into packed (pel_vtk_blocks_bound(size) bytes), on an 8-byte boundary or not. Errors:
 * PEL_OUT_OF_MEMORY.
 */
pel_status pel_vtk_blocks_pack(const void *bytes, size_t size, unsigned char *packed, size_t *packed_size,
                               pel_error *error);

/* Bytes that the blocks at the beginning of packed (available bytes) take up, head included, when they claim to hold
   exactly `size` bytes and could; 0 when not. Looks at the head only. */
size_t pel_vtk_blocks_check(const unsigned char *packed, size_t available, size_t word_size, size_t size);

/* Unpacks blocks that passed pel_vtk_blocks_check into bytes (size). Errors: PEL_OUT_OF_MEMORY, PEL_BAD_FORMAT. */
pel_status pel_vtk_blocks_unpack(const unsigned char *packed, size_t word_size, void *bytes, size_t size,
                                 pel_error *error);

/* an unsigned word of 4 or 8 bytes */
uint64_t pel_vtk_blocks_word(const unsigned char *bytes, size_t word_size);

#endif

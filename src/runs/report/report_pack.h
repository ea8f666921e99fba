/* Bytes packed by zlib into memory, up to a limit, and written as base64. */
#ifndef PEL_REPORT_REPORT_PACK_H
#define PEL_REPORT_REPORT_PACK_H

#include "io/file.h"

typedef struct pel_report_pack {
    void *stream; /* z_stream, null when closed */
    void *bytes;
    size_t size, capacity;
    size_t limit;
    bool full; /* the limit was passed: further data are dropped */
} pel_report_pack;

pel_status pel_report_pack_open(pel_report_pack *pack, size_t limit, pel_error *error);
pel_status pel_report_pack_add(pel_report_pack *pack, const void *bytes, size_t size, pel_error *error);
/* ends the packed bytes; they stay until free */
pel_status pel_report_pack_close(pel_report_pack *pack, pel_error *error);
/* frees everything; fine on a zeroed pack */
void pel_report_pack_free(pel_report_pack *pack);

void pel_report_pack_write_base64(const pel_report_pack *pack, pel_file_writer *writer);

#endif

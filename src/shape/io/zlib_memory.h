/* Memory of zlib's streams: all allocations use base/memory.h. */
#ifndef PEL_IO_ZLIB_MEMORY_H
#define PEL_IO_ZLIB_MEMORY_H

#include "base/memory.h"

#include <zlib.h>

static inline void *pel_zlib_allocate(void *unused, unsigned count, unsigned size)
{
    (void)unused;
    return pel_allocate(count, size);
}

static inline void pel_zlib_release(void *unused, void *block)
{
    (void)unused;
    pel_free(block);
}

#endif

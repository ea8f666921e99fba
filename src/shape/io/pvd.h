/* Collections of .vtp files with several parts at a time, which ParaView shows as blocks. */
#ifndef PEL_IO_PVD_H
#define PEL_IO_PVD_H

#include "pellicle/results.h"

typedef struct pel_pvd_entry {
    const char *file; /* relative to the .pvd */
    const char *name; /* nullable: no name */
    double time;      /* s */
    int32_t part;
} pel_pvd_entry;

/* Errors: PEL_BAD_FILE, PEL_OUT_OF_MEMORY. */
pel_status pel_pvd_write_entries(const char *path, const pel_pvd_entry *entries, size_t count, pel_error *error);

#endif

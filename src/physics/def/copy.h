/* Deep copies of defs, by the table of members: the defs of a model and a simulation, for callers that change a
   part and create them again. */
#ifndef PEL_DEF_COPY_H
#define PEL_DEF_COPY_H

#include "def/row.h"

/* owns the arrays of copied defs */
typedef struct pel_copies {
    struct pel_copy_block *first;
} pel_copies;

/* Zeroed memory that lives as long as the copies; null if out of memory. */
void *pel_copies_room(pel_copies *copies, size_t size);
/* A copy of some bytes that lives as long as the copies; null when out of memory. */
void *pel_copies_take(pel_copies *copies, const void *bytes, size_t size);
void pel_copies_free(pel_copies *copies);

/* Replaces pointers of a def that was copied as a struct by pointers to copies, except meshes. PEL_OUT_OF_MEMORY: the
   def is unusable then. */
pel_status pel_def_copy(pel_copies *copies, pel_def_kind kind, void *def, pel_error *error);

#endif

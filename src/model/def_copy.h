/* Deep copies of defs, by the tables of their members: what a model and a simulation were made from, for those who
   change a part of it and make them anew. */
#ifndef PEL_MODEL_DEF_COPY_H
#define PEL_MODEL_DEF_COPY_H

#include "model/fingerprint.h"

/* owns what copied defs point to */
typedef struct pel_copies {
    struct pel_copy_block *first;
} pel_copies;

/* Room for so many bytes, zero, that lives as long as the copies; null when out of memory. */
void *pel_copies_room(pel_copies *copies, size_t size);
/* A copy of some bytes that lives as long as the copies; null when out of memory. */
void *pel_copies_take(pel_copies *copies, const void *bytes, size_t size);
void pel_copies_free(pel_copies *copies);

/* Makes pointers of a def that was copied as a struct point to copies of their own, but for meshes. PEL_OUT_OF_MEMORY:
   the def is of no use then. */
pel_status pel_def_copy(pel_copies *copies, const pel_member *members, void *def, pel_error *error);

#endif

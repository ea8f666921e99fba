/* Joining vertices at exactly equal positions while they are added, in the order of their first appearance. */
#ifndef PEL_IO_WELD_H
#define PEL_IO_WELD_H

#include "io/builder.h"

/* open-addressing hash table of the vertices of a builder; zero is a valid empty table */
typedef struct pel_weld {
    int32_t *slots;    /* vertex + 1, 0 = empty */
    size_t slot_count; /* a power of two, or 0 */
} pel_weld;

/* The index of the vertex of the builder at this position (-0 equals 0), added when there is none yet. False when out
   of memory. All vertices of the builder must come this way. */
bool pel_weld_vertex(pel_weld *weld, pel_builder *builder, const double position[3], int32_t *vertex);
void pel_weld_free(pel_weld *weld);

#endif

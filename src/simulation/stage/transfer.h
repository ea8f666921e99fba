/* Saving and loading: each room passes what it keeps to one cursor. The same function counts, saves and loads, so that
   these cannot differ. */
#ifndef PEL_STAGE_TRANSFER_H
#define PEL_STAGE_TRANSFER_H

#include "stage/stage.h"

/* copies bytes in one direction or the other, or only counts them; a sim that is const is written to while it loads */
struct pel_cursor {
    unsigned char *bytes; /* null = count */
    size_t at;
    bool load;
    size_t size;   /* of all bytes, to load */
    bool is_short; /* more was to be loaded than there is: it stays as it was */
    bool is_full;  /* there was no memory for what was to be loaded */
    /* to load arrays by vertex that were saved with other places, of which there are no more now */
    const int32_t
        *places;        /* (vertices of the model) the place of each one in the saved arrays, -1 = none; null = same */
    size_t place_count; /* of the saved arrays */
};

void pel_transfer(pel_cursor *at, void *data, size_t size);
/* An array with one element for each vertex of the model. */
void pel_transfer_vertices(pel_cursor *at, void *data, size_t count, size_t size);
/* A list with room for all vertices of the model: it may be longer now. */
void pel_transfer_list(pel_cursor *at, void *data, size_t count, size_t size);
/* The number of entries of a list that is as long as the present state needs, of at least so many bytes each. When it
   loads: 0 if there cannot be so many. */
void pel_transfer_count(pel_cursor *at, int64_t *count, size_t least);

/* Passes one part of the state, of a body, load or tool where it is of one. Parts may be carried over one by one. */
typedef void pel_transfer_part(pel_cursor *at, const pel_sim *sim, int32_t index);

/* positions and velocities; the step before, where it is kept; marks of contact; keyed numbers; the bending weight of a
   body; held vertices; what yields (plastic.c) */
pel_transfer_part pel_transfer_motion, pel_transfer_history, pel_transfer_marks, pel_transfer_factors,
    pel_transfer_bending, pel_transfer_held, pel_transfer_plastic;

/* whether loaded numbers are all at least 0 and below `limit`, and there are no more of them */
bool pel_is_list(const int32_t *list, int32_t count, size_t limit);

#endif

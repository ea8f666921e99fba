/* Steps in parts. */
#ifndef PEL_SIM_PARTS_H
#define PEL_SIM_PARTS_H

#include "stage/stage.h"
#include "stage/transfer.h"

/* successful parts of one size before the next is twice as long; doubled after a failure */
enum { PEL_LEAST_PATIENCE = 4, PEL_MOST_PATIENCE = 256 };

/* in snapshots */
typedef struct pel_parts_now {
    int32_t size;     /* of the next part */
    int32_t calm;     /* parts of this size that went well */
    int32_t patience; /* number required before the next part is longer */
} pel_parts_now;

typedef struct pel_parts {
    pel_parts_now now;
    bool divides; /* method and contacts allow steps in parts; then their sizes are in snapshots */
    bool is_kept; /* `before` is the state before the present step: it may be stopped on its way */
    void *before; /* (before_size) snapshot before a step in parts or a long one; null until there is one */
    size_t before_size, before_room;
    double began,
        seconds; /* s by the clock: when the step began, and of the one before; only where it may be stopped */
} pel_parts;

/* After contacts and restitution, before anything asks for the size of a snapshot. */
void pel_parts_create(pel_sim *sim);
void pel_parts_destroy(pel_sim *sim);
/* At the start of a step: chooses substeps and the size of the first part. PEL_OUT_OF_MEMORY. */
pel_status pel_parts_begin(pel_sim *sim, pel_error *error);
/* At the start of a step: if the caller may stop it midway, keeps the state to return to. */
pel_status pel_parts_keep(pel_sim *sim, pel_error *error);
/* PEL_OUT_OF_MEMORY. */
pel_status pel_parts_halve(pel_sim *sim, pel_error *error);
/* After a part: the next one begins. */
void pel_parts_accept(pel_sim *sim);
/* After the last part, or the first failure, which takes the state back to the start of the step. */
void pel_parts_end(pel_sim *sim, pel_status status);

/* a pel_transfer_part */
void pel_parts_transfer(pel_cursor *at, const pel_sim *sim, int32_t unused);
/* After it was loaded; false when the numbers are out of range. */
bool pel_parts_restore(pel_sim *sim);

#endif

/* Explicit steps of bodies that stiffen: parts as short as the present stretch needs. */
#ifndef PEL_METHOD_STIFFENING_H
#define PEL_METHOD_STIFFENING_H

#include "stage/stage.h"
#include "stage/transfer.h"

/* In snapshots. Stretches are logarithms of the largest ratio of an edge to its length at rest, or of its inverse. */
struct pel_stiffening {
    double safe;    /* largest stretch at which whole steps are known to be stable */
    double stretch; /* at the last look */
    double limit;   /* s, the largest stable dt there */
    double rest;    /* s, that limit at rest; 0 = not known */
    double slope;   /* how fast the logarithm of that limit falls with the stretch */
    double seen;    /* at the last measurement, ahead of it */
    int64_t next;   /* the step of the next one where nothing is near, after so many */
    int32_t interval;
    int32_t age;     /* parts since the last look, up to some */
    int32_t size;    /* of the next part */
    int32_t is_near; /* 1 = whole steps may soon be too long */
};

/* For shells under symplectic Euler whose dt is stable at rest. PEL_OUT_OF_MEMORY. */
pel_status pel_stiffening_create(pel_sim *sim, pel_error *error);
void pel_stiffening_destroy(pel_sim *sim);

/* At the start of a step or part: the largest size of the next part; PEL_PART_LIMIT where nothing stiffens.
   PEL_DIVERGED where that is less than a part can be. */
pel_status pel_stiffening_find(pel_sim *sim, int32_t *size, pel_error *error);

/* After the surface has changed: nothing is known but that at rest the step is stable. */
void pel_stiffening_forget(pel_sim *sim);

/* a pel_transfer_part */
void pel_stiffening_transfer(pel_cursor *at, const pel_sim *sim, int32_t unused);
/* After it was loaded; false when the numbers are out of range. */
bool pel_stiffening_restore(pel_sim *sim);

#endif

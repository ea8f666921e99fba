/* Storage of the elements of a model: springs, triangles, hinges and fibres of each body, once, with their numbers at
   rest. Projection sweeps over them, forces add to the vertices from them.

   The elements of a body form bundles that share no vertex: pieces of the surface, then the seams between neighbouring
   pieces, even and odd ones, then the few that touch other pairs of pieces. Bundles of a phase may run concurrently;
   the order within a bundle is fixed, so sums have the same bits for any number of threads. */
#ifndef PEL_BATCH_BATCHES_H
#define PEL_BATCH_BATCHES_H

#include "batch/layout.h"
#include "model/shell.h"
#include "pellicle/solver.h"

typedef struct pel_body_batches {
    pel_pieces pieces;
    int32_t batch_count; /* in the order of a sweep */
    pel_batch *batches;
    double *areas;              /* (places of the body) m2 at rest, of the triangles around; null unless it caves in */
    pel_build_scratch *scratch; /* kept when the body refines, else null */
} pel_body_batches;

typedef struct pel_bundle {
    int32_t body, number;
} pel_bundle;

enum { PEL_PHASE_COUNT = 4 };

typedef struct pel_batches {
    const pel_model *model;
    pel_method method;
    bool is_projected;                        /* by the method */
    pel_body_batches *bodies;                 /* (model body_count) */
    pel_bundle *bundles;                      /* by phase */
    int32_t phase_begin[PEL_PHASE_COUNT + 1]; /* in bundles */
} pel_batches;

/* Lays out the elements of a method. Methods that project skip elements that they cannot move; only they have springs
   here. PEL_OUT_OF_MEMORY. */
pel_status pel_batches_create(const pel_model *model, pel_method method, pel_batches **batches, pel_error *error);
void pel_batches_destroy(pel_batches *batches);

/* After the surface of a body that refines has changed: lays out its elements again, without allocation. */
void pel_batches_rebuild(pel_batches *batches, int32_t body);

/* Turns the fibres of a body that follow the largest stretch (PEL_FIBRE_PRINCIPAL) to its direction at these
   positions. */
void pel_batches_follow(pel_batches *batches, int32_t body, const pel_record *positions);

/* Whether its numbers follow what yields or grows in a state. The shell may be null. */
bool pel_batch_is_plastic(const pel_batch *batch, const pel_shell *shell);
/* Sets what a state changes of a block that yields or grows: rest and yield angles of hinges, shapes and slip of
 * triangles. */
void pel_batch_slip(const pel_batches *batches, int32_t body, const pel_batch *batch, int32_t block,
                    const pel_plastic *plastic);

/* Whether places, lanes and bundles are within their arrays, blocks that are computed together share no vertex, and
   neither do bundles of a phase. */
bool pel_batches_is_valid(const pel_batches *batches);

/* true for a batch whose energy has a region's fibres */
static inline bool pel_batch_is_fibre(const pel_batch *batch)
{
    return batch->kind >= PEL_CONSTRAINT_FIBRE && batch->kind <= PEL_CONSTRAINT_MUSCLE;
}

#endif

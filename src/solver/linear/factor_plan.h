/* The symbolic half of a factor: fronts, where everything lies, and what runs at once.

   A front holds some pivots (unknowns of consecutive nodes of the elimination order) and a border (those of later nodes
   that they touch). Its panel, kept as the factor, has a column for each pivot; rows are the pivots, padded to a
   multiple of PEL_FRONT_PAD, then the border, padded too. Its update matrix (border x border) is added to the front of
   its parent. */
#ifndef PEL_LINEAR_FACTOR_PLAN_H
#define PEL_LINEAR_FACTOR_PLAN_H

#include "linear/factor.h"

/* rows are padded to whole cache lines of floats */
enum { PEL_FRONT_PAD = 16 };

typedef struct pel_front {
    int32_t first_node, last_node;      /* pivots: positions in the order, the last one excluded */
    int32_t first_pivot, pivot_count;   /* unknowns in the order of elimination */
    int32_t border_start, border_count; /* unknowns of the border, in border_unknown and in the vectors of a solve */
    int32_t parent;                     /* -1 at a root */
    int32_t first_child, next_sibling;  /* fronts, ascending; -1 at the end */
    int32_t run_start, run_count;       /* runs of the border in the front of the parent */
    int32_t stride;                     /* rows of the panel, padding included */
    int64_t panel;                      /* its first number in the entries */
    int64_t update;                     /* its first number in the work space */
} pel_front;

/* consecutive unknowns of a border that are consecutive rows in the front of the parent */
typedef struct pel_front_run {
    int32_t from, to, count;
} pel_front_run;

/* Fronts that one thread eliminates one after the other: a subtree in postorder. */
typedef struct pel_front_task {
    int32_t first_front, last_front; /* the last one excluded */
    int32_t scratch;                 /* its first number in the scratch of solves */
} pel_front_task;

struct pel_factor_plan {
    int32_t node_count, unknown_count, block_count;
    int32_t front_count, task_count, upper_count, run_count, border_count;
    pel_front *fronts;       /* in postorder */
    pel_front_task *tasks;   /* (task_count) the largest first */
    int32_t *upper;          /* (upper_count) fronts above all tasks, in postorder */
    pel_front_run *runs;     /* (run_count) */
    int32_t *border_unknown; /* (border_count) in the order of elimination */
    int32_t *order;          /* (node_count) nodes in the order of elimination */
    int32_t *pivot_start;    /* (node_count + 1) first pivot of each position in the order */
    int32_t *front_unknown;  /* (unknown_count) unknown of the matrix, in the order of elimination */
    int32_t *block_row;      /* (block_count) row of a block of the matrix in the front of its row's node; -1: above */
    int64_t entry_count, work_count;
    int32_t scratch_count, upper_scratch; /* of solves; where that of the upper fronts begins */
    pel_factor_cost cost;
};

static inline int32_t pel_front_pad(int32_t count)
{
    return (count + PEL_FRONT_PAD - 1) / PEL_FRONT_PAD * PEL_FRONT_PAD;
}

/* distance of the columns of an update matrix */
static inline int32_t pel_front_update_stride(const pel_front *front)
{
    return pel_front_pad(front->border_count);
}

#endif

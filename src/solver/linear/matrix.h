/* Block sparse symmetric matrices over nodes of 1 to 6 unknowns: vertices of 3, edges of 1, rigid bodies of 6.

   The pattern comes from lists of the nodes of each element and is built once. Elements are cut into pieces that lie
   together, and pieces colored so that those of one color share no node: the pieces of a color are summed in parallel,
   colors one after the other, and so the sums have the same bits for any number of threads. (Coloring elements one by
   one was tried: ten times slower, because each color then runs through the whole matrix.) Both triangles are stored:
   a product is one pass over rows. */
#ifndef PEL_LINEAR_MATRIX_H
#define PEL_LINEAR_MATRIX_H

#include "base/pool.h"

enum {
    PEL_NODE_SIZE_LIMIT = 6,     /* unknowns of one node */
    PEL_ELEMENT_SIZE_LIMIT = 36, /* unknowns of one element */
    PEL_MATRIX_GROUP = 8         /* most elements in one call of a pel_matrix_function */
};

/* Blocks are column-major: unknown a of the row's node and b of the column's node at
   values[block_start[block] + a + size * b], with size the unknowns of the row's node. */
typedef struct pel_matrix {
    int32_t node_count, unknown_count, block_count;
    int32_t *first_unknown; /* (node_count + 1) first unknown of each node */
    int32_t *row_start;     /* (node_count + 1) first block of each row of blocks */
    int32_t *column;        /* (block_count) node of each block, ascending in a row; the diagonal is always there */
    int32_t *block_start;   /* (block_count + 1) */
    double *values;         /* (block_start[block_count], then four zeros) */

    int32_t element_count, group_count, piece_count, color_count;
    int32_t *element_start; /* (element_count + 1) places of each element */
    int32_t *element_place; /* n^2 for an element of n nodes, row-major: block_start of the pair's block */
    int32_t *element_node;  /* (sum of n) nodes of the elements */
    int32_t *node_start;    /* (element_count + 1) in element_node */
    int32_t *ordered;       /* (element_count) elements in the order of their sums */
    int32_t *group_start;   /* (group_count + 1) in ordered: groups of one kind and size */
    int32_t *piece_start;   /* (piece_count + 1) in group_start */
    int32_t *color_start;   /* (color_count + 1) in piece_start: what may run at once */
} pel_matrix;

typedef struct pel_matrix_def {
    int32_t node_count;
    const uint8_t *node_size; /* (node_count) unknowns of each node, 1 to PEL_NODE_SIZE_LIMIT; null = 3 each */
    int32_t element_count;
    const int32_t *element_start; /* (element_count + 1) in element_node, from 0 */
    const int32_t *element_node;  /* nodes of each element; one that comes twice is summed twice */
    const uint8_t *element_kind;  /* (element_count) a group has elements of one kind only; null = all alike */
    int32_t coupling_count;
    const int32_t (*couplings)[4]; /* (coupling_count) nodes that get blocks with each other; the caller fills them
                                      after pel_matrix_assemble. null = none */
} pel_matrix_def;

/* Builds the pattern; the values are zero. The arrays of the def are not kept. PEL_BAD_ARGUMENT for a node out of
   range, a size out of range, an element too large, or more values than an int32_t counts (names node or element). */
pel_status pel_matrix_create(const pel_matrix_def *def, pel_matrix **matrix, pel_error *error);
void pel_matrix_destroy(pel_matrix *matrix);

/* Writes the dense symmetric matrices of `count` elements (1 to PEL_MATRIX_GROUP) of one kind and size d to blocks
   (count x d x d), unknowns in the order of the element's nodes. Called from several threads at once. */
typedef void pel_matrix_function(void *context, const int32_t *elements, int32_t count, double *blocks);

/* values = sum of all elements. Allocates nothing. */
void pel_matrix_assemble(pel_matrix *matrix, pel_pool *pool, pel_matrix_function *function, void *context);

/* Adds factor * diagonal (unknown_count; null = 1 each) to the diagonal: masses over dt^2, shifts. */
void pel_matrix_add_diagonal(pel_matrix *matrix, double factor, const double *diagonal);

/* Fixes unknowns: zeroes row and column of each unknown with fixed[u] != 0 but for its diagonal entry, which stays
   (1 where it is not positive). value and right may be null together: else value (unknown_count) holds the solution
   of fixed unknowns, and right (unknown_count) is changed so that the solution of the others is that of the whole
   system. Keeps symmetry and pattern. */
void pel_matrix_fix(pel_matrix *matrix, pel_pool *pool, const uint8_t *fixed, const double *value, double *right);

/* Turns unknowns of nodes of three: those of node n are then along the rows of axes[frame[n]]; frame[n] < 0: they stay.
   frame (node_count), axes orthonormal. */
void pel_matrix_turn(pel_matrix *matrix, pel_pool *pool, const int32_t *frame, const double (*axes)[3][3]);

/* y = A x, both (unknown_count) and different; the same bits for any number of threads */
void pel_matrix_multiply(const pel_matrix *matrix, pel_pool *pool, const double *x, double *y);

/* Whether the pattern is whole: blocks ascend in each row, have their diagonal and their mirror image; elements find
   the blocks of their nodes, each is summed once, and pieces of one color share no node. */
bool pel_matrix_is_valid(const pel_matrix *matrix);

/* The block of a pair of nodes, or -1 when the pattern has none. */
int32_t pel_matrix_block(const pel_matrix *matrix, int32_t row, int32_t column);

#endif

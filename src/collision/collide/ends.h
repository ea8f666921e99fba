/* Pairs of edges that their ends keep apart: where surfaces lie on each other most edges that are near each other are
   of this kind, so they are told four at a time. */
#ifndef PEL_COLLIDE_ENDS_H
#define PEL_COLLIDE_ENDS_H

#include <stdint.h>

/* from start to end, both (points x 3) m */
typedef struct pel_edge_pairs {
    const double (*start)[3], (*end)[3];
    const int32_t (*points)[4]; /* (count) the ends of both edges */
    const double *rooms;        /* (count) m, lines with this much room keep their edges apart, once vertices do */
    int32_t count;
    double slide; /* m: what moves less against each other hardly slides */
} pel_edge_pairs;

/* Writes the numbers of the pairs that their ends do not keep apart, and returns how many: of two edges that hardly
   slide, whose closest points at the start lie at an end of one, and whose lines, which cross where the edges slide
   over each other, leave room; or which are parallel. */
int32_t pel_edges_to_measure(const pel_edge_pairs *pairs, int32_t *numbers);

#endif

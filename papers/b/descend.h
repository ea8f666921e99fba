/* Minimisation by gradient descent, with which paper B compares its projection (figure 15): a shell that moves as in
   the paper, but whose elastic energy E_S falls along its gradient. */
#ifndef PAPERS_B_DESCEND_H
#define PAPERS_B_DESCEND_H

#include <pellicle/mesh.h>

typedef struct b_descent {
    double young, poisson, density, thickness; /* of the shell: St. Venant and Kirchhoff */
    double pressure, dt;                       /* outside; a frame */
    int frames;
    const double *energies; /* (frames + 1) a frame ends at this energy [J], or after `most` iterations */
    int most;
} b_descent;

/* positions (vertex_count x 3): those of the last frame. iterations: of all frames. Errors: PEL_OUT_OF_MEMORY, and
   those of pel_topology_create. */
pel_status b_descend(const pel_mesh *rest, const b_descent *def, double (*positions)[3], int *iterations,
                     pel_error *error);

#endif

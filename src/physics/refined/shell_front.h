/* The shell of a body in an active model, with the places of that model. If the body refines, its triangles and hinges
   follow the present surface; otherwise everything but the places is that of the given shell.

   Rest data of finer triangles come from the subdivided rest surface, the material, fibres and pressure from the base
   triangle that they are a part of, so that an event changes the rest surface only by the subdivision. Hinges stand on
   all edges between two triangles of the surface, bisected ones included. Unrefined parts are copied from the base:
   without refinement the shell is that of the plain model, bit by bit. An event rebuilds all of it, without
   allocation. */
#ifndef PEL_REFINED_SHELL_FRONT_H
#define PEL_REFINED_SHELL_FRONT_H

#include "model/shell.h"

typedef struct pel_shell_front {
    pel_shell shell; /* curves belong to the given one */
    const pel_shell *given;
    bool refines;                /* else all below is null */
    int32_t (*corners)[3];       /* (triangle_limit) */
    int32_t **fibre_of_triangle; /* (region_count x given triangles) -1 = none */
    int32_t *hinge_of_half_edge; /* (3 x given triangles) -1 = none */
    pel_front_triangle *surface; /* (triangle_limit) scratch */
    int32_t *base_of_triangle;   /* (triangle_limit) */
    uint8_t *is_base;            /* (triangle_limit) 1 = a whole triangle of the base */
    int32_t *begin;              /* (places + 2) half-edges by the lower of their places */
    int32_t *half_edges;         /* (3 x triangle_limit) */
    int32_t first_place, place_count;
} pel_shell_front;

/* For a body of an active model whose model_index and front are set. corners: its triangles in that model, if it does
   not refine. place_limit: past its last possible place. triangle_limit: of any surface. Errors: PEL_OUT_OF_MEMORY. */
pel_status pel_shell_front_create(const pel_body *given, const pel_body *body, const int32_t (*corners)[3],
                                  int32_t place_limit, int32_t triangle_limit, pel_shell_front **made,
                                  pel_error *error);
void pel_shell_front_destroy(pel_shell_front *own);

/* After the front of a body that refines has changed. */
void pel_shell_front_update(pel_shell_front *own, const pel_front *front, const int32_t *model_index);

/* Volume that the present surface encloses at rest. */
double pel_shell_front_rest_volume(const pel_shell_front *own, const pel_front *front);

#endif

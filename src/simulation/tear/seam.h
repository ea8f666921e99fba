/* Seams: edges of a body that open at a time, or where the force across them is too large. */
#ifndef PEL_TEAR_SEAM_H
#define PEL_TEAR_SEAM_H

#include "tear/survey.h"

/* an edge that is closed at present */
typedef struct pel_seam_edge {
    int32_t edge, seam; /* of the topology; of the def */
} pel_seam_edge;

/* The seams of a body, for the present triangles: a step in which nothing opens allocates nothing. What is open is in
   the triangles alone, so snapshots hold nothing of seams. */
typedef struct pel_seams {
    int32_t body;
    pel_survey survey; /* of the body */
    int32_t edge_count;
    pel_seam_edge *edges; /* (edge_count) */
    uint8_t *marks;       /* (edges of the topology) those that open now */
    int32_t *mark_counts; /* (vertices) marked edges at each one */
} pel_seams;

bool pel_body_has_seam(const pel_sim *sim, int32_t body);
/* PEL_BAD_ARGUMENT with the seam: edges that do not exist or that cannot open; PEL_OUT_OF_MEMORY. pel_seams_end also
   then. */
pel_status pel_seams_begin(pel_seams *seams, pel_sim *sim, int32_t body, pel_error *error);
void pel_seams_end(pel_seams *seams);
/* N/m, of tension and shear across an edge in the present state (pel_shell_forces_follow has been called for it). */
double pel_seams_load(const pel_seams *seams, int32_t edge);
/* Marks the edges that open in the present state; returns their number. */
int32_t pel_seams_look(pel_seams *seams);

/* A vertex whose edges have opened, and what the triangles around it pull it with at this moment. */
typedef struct pel_seam_end {
    int32_t body, vertex, parent; /* the vertex of which it is a copy, itself if it is none */
    double gradient[3];           /* N, of the energy of its triangles, less the mean over all copies of its parent */
} pel_seam_end;
typedef struct pel_seam_ends {
    pel_seam_end *list; /* (count) */
    size_t count, room;
} pel_seam_ends;

/* Adds those of a body that has just opened; its vertices from `first` on are copies of parents. PEL_OUT_OF_MEMORY. */
pel_status pel_seam_ends_add(pel_seam_ends *ends, pel_seams *seams, int32_t first, const int32_t *parents,
                             pel_error *error);
/* J, that they have released on the way to where they are now (seam.c). */
double pel_seam_ends_work(const pel_seam_ends *ends, const pel_sim *sim);

#endif

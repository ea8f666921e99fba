/* Follower loads: forces per length on boundary edges that turn with the frame of the edge and its triangle. They have
   no potential. */
#ifndef PEL_BOUNDARY_FOLLOWER_H
#define PEL_BOUNDARY_FOLLOWER_H

#include "linear/matrix.h"
#include "stage/stage.h"

/* After the loads, taking over those that follow. PEL_BAD_ARGUMENT, PEL_OUT_OF_MEMORY. */
pel_status pel_followers_create(pel_sim *sim, const pel_sim_def *def, pel_error *error);
void pel_followers_destroy(pel_sim *sim);

/* N, of the i-th follower load over a span, on both ends of its edge together. */
void pel_follower_force(const pel_sim *sim, int32_t i, pel_span span, const pel_record *positions, double force[3]);
/* Subtracts the forces at unknowns from the gradient, and keeps their slopes for the matrix. */
void pel_followers_evaluate(const pel_sim *sim, pel_span span, const double *unknowns, double *gradient);
/* Adds the symmetric part of the slopes of the last evaluation. */
void pel_followers_add_matrix(const pel_sim *sim, pel_matrix *matrix);
/* y += the rest of them times x, both as the gradient. */
void pel_followers_add_skew(const pel_sim *sim, const double *x, double *y);
/* Slopes of the gradient of the i-th follower load in the last evaluation: one for both ends of its edge, by the
   positions of ends and tip. */
void pel_follower_slopes(const pel_sim *sim, int32_t i, double slopes[3][3][3]);

/* PEL_BAD_ARGUMENT if there are any: `what` does not support them. */
pel_status pel_followers_refuse(const pel_sim *sim, const char *what, pel_error *error);

#endif

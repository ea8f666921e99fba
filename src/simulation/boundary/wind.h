/* Air around all bodies: drag and lift on their triangles. */
#ifndef PEL_BOUNDARY_WIND_H
#define PEL_BOUNDARY_WIND_H

#include "stage/stage.h"

typedef struct pel_wind pel_wind;

/* PEL_BAD_ARGUMENT for numbers out of range and for methods without velocities; makes nothing without air. */
pel_status pel_wind_create(pel_sim *sim, const pel_wind_def *def, pel_error *error);
void pel_wind_destroy(pel_sim *sim);

/* Before a step, or a part of one: the forces F at its start and their slopes d. Within the step the air has the force
   F - d (v - v0) on a vertex of the velocity v, v0 at its start. */
void pel_wind_begin(pel_sim *sim);
/* F + d v0 [N] of the vertices and d [N s/m] as the fourth number (vertex_count), of the last pel_wind_begin; null = no
   air. */
const pel_record *pel_wind_forces(const pel_sim *sim);

/* Adds F + d v0 to force (vertex_count). */
void pel_wind_add(const pel_sim *sim, pel_record *force);
/* Adds the forces at some velocities and at the present positions to force (vertex_count). */
void pel_wind_add_present(const pel_sim *sim, pel_record *force);
/* Explicit: changes the change of the velocities in a step of length dt [s], and the new positions by `ratio` [s] of
   that. */
void pel_wind_apply(pel_sim *sim, double ratio);
/* Sums the work of a substep of length h [s] from some positions to position_next. */
void pel_wind_tally(pel_sim *sim, const pel_record *start, double h);
/* J, of the step: the sum of its substeps, or by its mean velocities. `h` [s] is the length of substeps whose new
   velocities move the positions, else 0. */
double pel_wind_work(const pel_sim *sim, double h);

/* PEL_BAD_ARGUMENT if there is air: `what` does not support it. */
pel_status pel_wind_refuse(const pel_sim *sim, const char *what, pel_error *error);

#endif

/* Liquid in bodies: its weight and the pressure that it makes. */
#ifndef PEL_BOUNDARY_FLUID_H
#define PEL_BOUNDARY_FLUID_H

#include "linear/matrix.h"
#include "stage/stage.h"

/* Counts the bodies that hold a liquid. PEL_BAD_ARGUMENT for a method that minimises by gradients or has no loads. */
pel_status pel_fluids_create(pel_sim *sim, pel_error *error);

/* N: adds the forces of all liquids at some positions. */
void pel_fluids_add(const pel_sim *sim, const pel_record *positions, pel_record *force);
/* J, of whole bodies that are filled: subtracts the forces at unknowns from the gradient. */
double pel_fluids_evaluate(const pel_sim *sim, const double *unknowns, double *gradient);
/* Adds the symmetric part of the slopes there, but for those of volume and centre of a filling. */
void pel_fluids_add_matrix(const pel_sim *sim, const double *unknowns, pel_matrix *matrix);
/* J: mean of the forces at both ends of the step times the displacement. */
double pel_fluids_work(const pel_sim *sim);

/* PEL_BAD_ARGUMENT if there are any: `what` does not support them. */
pel_status pel_fluids_refuse(const pel_sim *sim, const char *what, pel_error *error);

#endif

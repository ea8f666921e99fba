/* Cuts: the surface opens between two steps. */
#ifndef PEL_SIM_CUT_H
#define PEL_SIM_CUT_H

#include "stage/stage.h"

/* Checks the cuts and seams of a def: PEL_BAD_ARGUMENT with the cut or the seam. */
pel_status pel_cuts_check(const pel_sim *sim, const pel_sim_def *def, pel_error *error);
/* What a cut needs of the simulation, and of its path. */
pel_status pel_cut_check_sim(const pel_sim *sim, pel_error *error);
pel_status pel_cut_check_path(const pel_sim *sim, int32_t body, const int32_t *vertices, int32_t vertex_count,
                              pel_error *error);
/* Makes those whose time has come; errors of pel_cut, with the number of the cut. */
pel_status pel_cuts_make(pel_sim *sim, pel_error *error);
/* Opens the edges of seams whose time has come or that carry more than their strength, and lists their ends; free
   ends->list. PEL_OUT_OF_MEMORY. */
struct pel_seam_ends;
pel_status pel_seams_open(pel_sim *sim, struct pel_seam_ends *ends, pel_error *error);
/* Takes the volumetric springs from vertices that they pull harder than the adhesion. PEL_OUT_OF_MEMORY. */
pel_status pel_adhesions_release(pel_sim *sim, bool *has_released, pel_error *error);
/* Opens one edge at each tip that releases as much energy as the material takes. PEL_OUT_OF_MEMORY. */
pel_status pel_tears_grow(pel_sim *sim, bool *has_grown, pel_error *error);
/* After a step: opens what blades have gone through, and lets them slide. PEL_OUT_OF_MEMORY; PEL_BAD_ARGUMENT as
   pel_cut and pel_incision_find. */
pel_status pel_blades_cut(pel_sim *sim, bool *has_cut, pel_error *error);

#endif

/* What a body takes before it tears: toughness and strength, and the lengths that follow from both. */
#ifndef PEL_TEAR_MATERIAL_H
#define PEL_TEAR_MATERIAL_H

#include "stage/stage.h"

/* whether tips of a body grow, whether notches count as tips, and whether tears start by strength */
bool pel_body_can_tear(const pel_sim *sim, int32_t body);
bool pel_tear_may_start(const pel_sim *sim, int32_t body);
bool pel_body_has_strength(const pel_sim *sim, int32_t body);
/* m, of the sheet at a vertex, and N, the energy that a tear takes per length there; NaN where it is not known */
double pel_tear_thickness(const pel_sim *sim, int32_t body, int32_t vertex);
double pel_tear_resistance(const pel_sim *sim, int32_t body, int32_t vertex);
/* N/m, young x thickness at a vertex; NaN where it is not known */
double pel_tear_stiffness(const pel_sim *sim, int32_t body, int32_t vertex);
/* Pa, true stress at which a tear starts at a vertex of a body with a strength */
double pel_tear_strength(const pel_sim *sim, int32_t body, int32_t vertex);
/* m, L = young x toughness / (pi strength^2) at a vertex: half the length of the crack in a sheet under this stress
   that is about to grow (Griffith 1921) */
double pel_tear_length(const pel_sim *sim, int32_t body, int32_t vertex);
/* Area of a present triangle over that at rest -> present thickness over that at rest. */
double pel_tear_thinning(const pel_sim *sim, int32_t body, double area_ratio);

#endif

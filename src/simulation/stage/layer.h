/* The layers that bodies keep before other bodies and tools. */
#ifndef PEL_STAGE_LAYER_H
#define PEL_STAGE_LAYER_H

#include "stage/stage.h"

/* of the diagonal of all bodies: thickness of layers of which no sheet is known */
#define PEL_LAYER_RELATIVE 1e-4

/* Layers of the bodies by their materials; without contact, of a share of their sheets, or where
   none is known of their diameter. PEL_OUT_OF_MEMORY. */
pel_status pel_layers_create(pel_sim *sim, pel_error *error);
/* One of them takes the thickness that contact has [m]. */
void pel_layer_set_thickness(pel_sim *sim, int32_t body, double thickness);

/* N, of the share of a vertex in a body: Young's modulus x thickness x width of its sheet, and Young's modulus x area
   of its filling: the order of the force that doubles its length. 0 = unknown. */
double pel_body_strength(const pel_sim *sim, int32_t body);

#endif

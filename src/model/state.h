/* The state: what changes while simulating. Plain arrays in the model's vertex order. */
#ifndef PEL_MODEL_STATE_H
#define PEL_MODEL_STATE_H

#include "model/model.h"

struct pel_state {
    int64_t step;
    pel_record *position;      /* (vertex_count) position and inverse mass; swapped with position_other by each step */
    pel_record *position_other; /* (vertex_count) positions of the step before */
    pel_record *velocity;       /* (vertex_count) explicit methods only, else null */
    pel_record *velocity_other;
    uint8_t *contact;           /* (vertex_count) 1 = a tool touches or holds it */
    double (*factors)[PEL_PARAMETER_COUNT]; /* (body_count) present factor of each keyed parameter */
};

pel_status pel_state_create(const pel_model *model, bool with_velocity, pel_state **state, pel_error *error);
void pel_state_destroy(pel_state *state);

#endif

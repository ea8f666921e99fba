/* The state of a simulation: plain arrays in the model's vertex order. */
#ifndef PEL_MODEL_STATE_H
#define PEL_MODEL_STATE_H

#include "math/record.h"
#include "measure/plastic.h"
#include "model/model.h"

/* State of the automatic bending weight of a body (method/bending_weight.c). */
typedef struct pel_bending_control {
    double weight;       /* k_B at present; of bodies with a given weight that one */
    double volume_ratio; /* one step ago */
    double change;       /* of it in the last step that changed it */
} pel_bending_control;

struct pel_state {
    int64_t step;
    /* (vertex_count) position and inverse mass: now, one step ago, and scratch of the step in progress; they change
       places when a step is accepted */
    pel_record *position, *position_before, *position_next;
    pel_record *velocity, *velocity_next;        /* (vertex_count) explicit and position-based methods, else null */
    pel_record *older_position, *older_velocity; /* (vertex_count) one substep ago; second order methods, else null */
    bool older_is_known;                         /* false after the start, setters and events of refinement */
    int32_t unresolved; /* implicit: steps left until the best scheme is tried again, see step_implicit.c; 0 = none */
    int32_t collision;  /* implicit: steps for which a touch is remembered; 0 = none, or it is past */
    uint8_t *touched;   /* (body_count) xpbd: something touched the body in the last step; null without a history */
    uint8_t *contact;   /* (vertex_count) 1 = a tool touches or holds it */
    double (*factors)[PEL_PARAMETER_COUNT]; /* (body_count) present factor of each keyed parameter */
    pel_bending_control *bending;           /* (body_count) */
    /* (body_count) of rigid bodies: now, one step ago, and at the end of the step in progress; null = there are none */
    pel_rigid_state *rigids, *rigids_before, *rigids_next;
    pel_plastic plastic, plastic_next;      /* now, and in the step in progress */
    double load_factor, load_factor_before; /* of loads, gravity and given pressure: now and one step ago; 1 but along a
                                               path (PEL_PATH_ARC_LENGTH) */
};

pel_status pel_state_create(const pel_model *model, bool with_velocity, pel_state **state, pel_error *error);
/* gives the vertices that may move the velocities with which their bodies start; the state has velocities */
void pel_state_start(const pel_model *model, pel_state *state);
/* After pel_model_refill, at the start of a simulation: masses, and velocities where `with_velocity`. */
void pel_state_refill(const pel_model *model, bool with_velocity, pel_state *state);
/* allocates the history of second order methods, empty */
pel_status pel_state_add_history(const pel_model *model, pel_state *state, pel_error *error);
/* converts the history of a step of length `before` to a step of length `step`: x(t - h) and v(t - h) of the motion
   with the mean acceleration of that step */
void pel_state_move_history(const pel_model *model, pel_state *state, double before, double step);
void pel_state_destroy(pel_state *state);

#endif

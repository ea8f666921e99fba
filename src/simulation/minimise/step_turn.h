/* Rotations of free bodies under the schemes of step_implicit.c.

   A rotation by the angle a per step loses about a^4 / 2 of its energy in each step of BDF2 and a^2 under Euler's rule.
   So the error of the scheme on a rigid motion is subtracted (a deferred correction): each free body has a reference
   motion p(t) through its positions at the start of the step, that of a rigid body without torque with the body's
   angular momentum and inertia. With the weights a of the scheme

     anchor  += p_1 - a_0 p_0 - a_1 p_-1 - p'_1 / rate,   carried += p'_1 - a_0 p'_0 - a_1 p'_-1 - p''_1 / rate

   A rigid body that spins or tumbles is exact; in general the scheme keeps its order. */
#ifndef PEL_MINIMISE_STEP_TURN_H
#define PEL_MINIMISE_STEP_TURN_H

#include "minimise/step_newton.h"

/* the reference motion of a body in a step: at the other state of the scheme, at the start and at the unknown one */
typedef struct pel_sim_turn {
    bool turns;
    double center[3];      /* of mass, at the start */
    double rotation[3][4]; /* from the start */
    double spin[3][3];     /* rad/s */
    double change[3];      /* rad/s2, of the last */
} pel_sim_turn;

/* The reference motions of a step or stage; bodies that something holds have none, nor has the midpoint rule. */
void pel_sim_turns_set(const pel_sim *sim, const pel_implicit_scheme *s);
/* What a scheme takes the unknown position and velocity of a vertex from. */
void pel_sim_turn_refer(const pel_sim *sim, const pel_implicit_scheme *s, int32_t v, double anchor[3],
                        double carried[3]);

#endif

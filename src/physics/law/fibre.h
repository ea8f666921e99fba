/* Laws of fibres (Kim, De Goes, Iben 2019): psi = k/2 g^2 of I5 = |F a|^2, with the strain g = sqrt I5 - rest length,
   or I5 - 1 of PEL_FIBRE_STVK. In units of the stiffness k. */
#ifndef PEL_LAW_FIBRE_H
#define PEL_LAW_FIBRE_H

#include "base/lane.h"

typedef struct pel_fibre_response {
    pel_lane strain; /* g */
    pel_lane slope;  /* dg = slope (F a) . d(F a); 0 where a fibre was crushed to length 0 */
} pel_fibre_response;

PEL_INLINE pel_fibre_response pel_law_fibre(pel_lane square, pel_lane rest_length, bool squared)
{
    if (squared)
        return (pel_fibre_response){square - pel_lane_splat(1), pel_lane_splat(2)};
    pel_lane length = pel_lane_sqrt(square);
    return (pel_fibre_response){length - rest_length, pel_lane_quotient(pel_lane_splat(1), length)};
}

PEL_INLINE pel_lane pel_law_fibre_energy(pel_fibre_response r)
{
    return PEL_CONSTANT(0.5) * r.strain * r.strain;
}

/* A muscle of activation and tension 1: force over stretch, and its integral from the shortest length with a force. */
typedef struct pel_muscle_response {
    pel_lane force, energy;
    pel_lane slope; /* of the force */
} pel_muscle_response;

PEL_INLINE pel_muscle_response pel_law_muscle(pel_lane length, pel_lane optimum, pel_lane width)
{
    const pel_lane one = pel_lane_splat(1);
    const pel_lane at = pel_lane_max(pel_lane_min((length - optimum) / width, one), -one), square = at * at;
    return (pel_muscle_response){
        one - square,
        width * (at - square * at * PEL_CONSTANT(0.33333333333333333) + PEL_CONSTANT(0.66666666666666667)),
        pel_lane_where(pel_lane_above(one, square), PEL_CONSTANT(-2.0) * at / width),
    };
}

/* The energy of a fibre that is shorter than at rest, else 0: paper B's E_A as PEL_FIBRE_NORMAL takes it. */
PEL_INLINE pel_lane pel_law_fibre_shortening(pel_fibre_response r)
{
    return pel_lane_where(pel_lane_above(pel_lane_splat(0), r.strain), pel_law_fibre_energy(r));
}

#endif

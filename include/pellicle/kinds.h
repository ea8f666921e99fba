/* Pellicle: kinds of laws, pressure and collision detection, which defs and functions share. material.h has the
   equations of the laws. */
#ifndef PELLICLE_KINDS_H
#define PELLICLE_KINDS_H

#include "base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The laws: enumerator, name of the functions in src/physics/law, name in scene files. To add a law, add its file in
   src/physics/law and a row here. */
#define PEL_MEMBRANE_LAWS(ROW)                                                                                         \
    ROW(STVK, stvk, "stvk")                                                                                            \
    ROW(COROTATED, corotated, "corotated")                                                                             \
    ROW(LINEAR, linear, "linear")                                                                                      \
    ROW(MOONEY_RIVLIN, mooney_rivlin, "mooney-rivlin")                                                                 \
    ROW(NEO_HOOKEAN, neo_hookean, "neo-hookean")                                                                       \
    ROW(GENT, gent, "gent")                                                                                            \
    ROW(FUNG, fung, "fung")                                                                                            \
    ROW(ORTHOTROPIC, orthotropic, "orthotropic")                                                                       \
    ROW(TENSION_FIELD, tension_field, "tension-field")                                                                 \
    ROW(WEAVE, weave, "weave")                                                                                         \
    ROW(ELASTOPLASTIC, elastoplastic, "elastoplastic")

typedef enum pel_membrane_kind { /* PEL_MEMBRANE_STVK and so on */
#define PEL_MEMBRANE_ENUMERATOR(KIND, law, name) PEL_MEMBRANE_##KIND,
                                 PEL_MEMBRANE_LAWS(PEL_MEMBRANE_ENUMERATOR)
#undef PEL_MEMBRANE_ENUMERATOR
} pel_membrane_kind;

#define PEL_MEMBRANE_ONE(KIND, law, name) +1
enum { PEL_MEMBRANE_COUNT = 0 PEL_MEMBRANE_LAWS(PEL_MEMBRANE_ONE) }; /* number of laws */
#undef PEL_MEMBRANE_ONE

enum { PEL_WEAVE_POINTS = 6 }; /* most points of a curve of PEL_MEMBRANE_WEAVE */

/* Energies of fibres (Kim, De Goes, Iben 2019) with I5 = |F a|^2, stiffness k [N/m]. On a membrane arap and sqrt are
   the same function, because the sign of I4 is always 1. Their stiffness at rest is k, 4 k and k. */
typedef enum pel_fibre_kind {
    PEL_FIBRE_ARAP, /* k/2 (sqrt I5 - sign I4)^2 */
    PEL_FIBRE_STVK, /* k/2 (I5 - 1)^2 */
    PEL_FIBRE_SQRT  /* k/2 (sqrt I5 - 1)^2 */
} pel_fibre_kind;

/* Force of an outside pressure P on a surface (measure.h). */
typedef enum pel_pressure_form {
    PEL_PRESSURE_CONSISTENT,   /* f = -P times a third of each triangle's area along its own normal: minus P times the
                                  gradient of the volume; no net force and torque on a closed surface */
    PEL_PRESSURE_VERTEX_NORMAL /* as written in paper B: f = -P times a third of the areas, along the unit normal of the
                                  vertex (weighted by area, so both forms have the same direction); larger at sharp
                                  vertices, and with a net force on irregular surfaces */
} pel_pressure_form;

/* Detection of contacts between moving vertices, edges and triangles (geometry.h). */
typedef enum pel_ccd_method {
    PEL_CCD_CONSERVATIVE, /* filter, separating axes, conservative time of impact */
    PEL_CCD_BRIDSON       /* filter, then pel_ccd_bridson */
} pel_ccd_method;

#ifdef __cplusplus
}
#endif
#endif

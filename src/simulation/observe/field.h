/* The fields that every simulation has, by number: in the order of the table (field.c). */
#ifndef PEL_OBSERVE_FIELD_H
#define PEL_OBSERVE_FIELD_H

#include "pellicle/observe.h"

/* in the order of the table */
typedef enum pel_field_kind {
    PEL_FIELD_DISPLACEMENT,
    PEL_FIELD_VELOCITY,
    PEL_FIELD_FORCE,
    PEL_FIELD_ENERGY,
    PEL_FIELD_SPRING_ENERGY,
    PEL_FIELD_VOLUMETRIC_ENERGY,
    PEL_FIELD_MEMBRANE_ENERGY,
    PEL_FIELD_BENDING_ENERGY,
    PEL_FIELD_FIBRE_ENERGY,
    PEL_FIELD_PRESSURE,
    PEL_FIELD_CONTACT,
    PEL_FIELD_CONTACT_FORCE,
    PEL_FIELD_REACTION,
    PEL_FIELD_LEVEL,
    /* those from here on are measured on the surface (pellicle/measure.h) */
    PEL_FIELD_AREA,
    PEL_FIELD_NORMAL,
    PEL_FIELD_MEAN_CURVATURE,
    PEL_FIELD_GAUSSIAN_CURVATURE,
    /* up to here */
    PEL_FIELD_STRESS,
    /* those from here on are also written on triangles (field_mechanics.h) */
    PEL_FIELD_STRAIN,
    PEL_FIELD_PIOLA_STRESS,
    PEL_FIELD_CAUCHY_STRESS,
    PEL_FIELD_MEMBRANE_FORCE,
    PEL_FIELD_BENDING_MOMENT,
    PEL_FIELD_PRINCIPAL_STRAIN,
    PEL_FIELD_PRINCIPAL_STRESS,
    PEL_FIELD_PRINCIPAL_DIRECTION,
    PEL_FIELD_VON_MISES_TOP,
    PEL_FIELD_VON_MISES_BOTTOM,
    PEL_FIELD_MEMBRANE_DENSITY,
    PEL_FIELD_BENDING_DENSITY,
    PEL_FIELD_FIBRE_DENSITY,
    PEL_FIELD_COUNT
} pel_field_kind;

/* whether it is also on triangles (field_mechanics.h) */
static inline bool pel_field_is_mechanics(int32_t field)
{
    return field >= PEL_FIELD_STRAIN && field < PEL_FIELD_COUNT;
}

/* whether it is measured on the surface (pellicle/measure.h) */
static inline bool pel_field_is_measure(int32_t field)
{
    return field >= PEL_FIELD_AREA && field < PEL_FIELD_STRESS;
}

#endif

/* The vertex fields that every run can write, beside those of its meshes. One table: the checker of scenes, the frames
   and the reference page read it. */
#ifndef PEL_RESULTS_FIELDS_H
#define PEL_RESULTS_FIELDS_H

#include "pellicle/base.h"

/* in the order of the table */
typedef enum pel_run_field {
    PEL_RUN_DISPLACEMENT,
    PEL_RUN_VELOCITY,
    PEL_RUN_FORCE,
    PEL_RUN_ENERGY,
    PEL_RUN_SPRING_ENERGY,
    PEL_RUN_VOLUMETRIC_ENERGY,
    PEL_RUN_MEMBRANE_ENERGY,
    PEL_RUN_BENDING_ENERGY,
    PEL_RUN_FIBRE_ENERGY,
    PEL_RUN_PRESSURE,
    PEL_RUN_CONTACT,
    PEL_RUN_CONTACT_FORCE,
    /* those from here on are measured on the surface (pellicle/measure.h) */
    PEL_RUN_AREA,
    PEL_RUN_NORMAL,
    PEL_RUN_MEAN_CURVATURE,
    PEL_RUN_GAUSSIAN_CURVATURE,
    /* up to here */
    PEL_RUN_STRESS,
    /* those from here on are also written on triangles (results/mechanics.h) */
    PEL_RUN_STRAIN,
    PEL_RUN_PIOLA_STRESS,
    PEL_RUN_CAUCHY_STRESS,
    PEL_RUN_MEMBRANE_FORCE,
    PEL_RUN_BENDING_MOMENT,
    PEL_RUN_PRINCIPAL_STRAIN,
    PEL_RUN_PRINCIPAL_STRESS,
    PEL_RUN_PRINCIPAL_DIRECTION,
    PEL_RUN_VON_MISES_TOP,
    PEL_RUN_VON_MISES_BOTTOM,
    PEL_RUN_MEMBRANE_DENSITY,
    PEL_RUN_BENDING_DENSITY,
    PEL_RUN_FIBRE_DENSITY,
    PEL_RUN_FIELD_COUNT
} pel_run_field;

typedef struct pel_run_field_info {
    const char *name;
    int32_t component_count;
    const char *unit; /* "" = none */
    const char *doc;  /* one sentence without full stop */
} pel_run_field_info;

/* (PEL_RUN_FIELD_COUNT) by pel_run_field */
extern const pel_run_field_info pel_run_fields[PEL_RUN_FIELD_COUNT];

/* the index of the field of that name, PEL_RUN_FIELD_COUNT when there is none */
int pel_run_field_find(const char *name);

#endif

/* Pellicle: what makes a body a thin shell: membrane, bending, fibres and pressure (paper B). Plain numbers that a
   pel_body_def carries; arrays are read during pel_model_create only. */
#ifndef PELLICLE_SHELL_H
#define PELLICLE_SHELL_H

#include "bending.h"
#include "material.h"
#include "measure.h"

#ifdef __cplusplus
extern "C" {
#endif

/* One point of a piecewise linear curve over time. Before the first and after the last key the end values hold. */
typedef struct pel_key {
    double time; /* s */
    double value;
} pel_key;

/* A material number that may vary over the body or over time (not both). */
typedef struct pel_quantity {
    double value;        /* used when field and keys are null */
    const double *field; /* (vertex_count) value on each vertex; a spring takes the mean of its ends, a triangle that of
                            its corners; nullable */
    const pel_key *keys; /* (key_count) value over time; nullable */
    int32_t key_count;
} pel_quantity;

/* Constant-strain triangles of one of the materials (paper B, equations 1 and 2). */
typedef struct pel_membrane_def {
    bool on; /* false: no membrane */
    pel_membrane_kind kind;
    pel_quantity young; /* Pa, > 0; no keys */
    double poisson;
    pel_quantity thickness; /* m, > 0; no keys */
    double mooney_ratio;    /* 0.2 by default */
    double extension_limit; /* gent; 50 by default */
    double stiffening;      /* fung; 10 by default */
    double strain_limit; /* pbd, xpbd: principal stretches stay within 1 - strain_limit .. 1 + strain_limit, 0 <= it <
                            1; 0 = no limit (Provot 1995). Other methods refuse it */
} pel_membrane_def;

typedef enum pel_bending_model {
    PEL_BENDING_OFF,
    PEL_BENDING_ISOMETRIC,      /* paper B, equation 3, literal: pulls a curved rest shape flat */
    PEL_BENDING_ISOMETRIC_REST, /* the same energy less that of the rest shape */
    PEL_BENDING_HINGE,          /* dihedral angle against its angle at rest */
    PEL_BENDING_MIDEDGE         /* shape operator with a rotation of each edge: a plate's on every mesh */
} pel_bending_model;

typedef struct pel_bending_def {
    pel_bending_model model;
    double weight;          /* pbd: factor on the correction of the positions, the paper's k_B, 0 to 1; negative: chosen
                               so that the volume falls without jitter */
    pel_quantity stiffness; /* N m: D of a plate, for the solvers that feel it; value negative: from young, poisson and
                               thickness of the membrane; no keys */
} pel_bending_def;

/* What a region of fibres does. */
typedef enum pel_fibre_mode {
    PEL_FIBRE_CAVE,   /* paper B: where fibres are shorter than at rest, triangles go inward along their normal */
    PEL_FIBRE_STRAIN, /* the energy as it is: resists stretch along the fibres */
    PEL_FIBRE_ACTIVE, /* fibres that want to have `rest_length` times their length at rest: a muscle */
    PEL_FIBRE_CURL    /* the rest angles of hinges within are multiplied by `curvature`: below 0 it wants to cave in */
} pel_fibre_mode;

typedef enum pel_fibre_direction {
    PEL_FIBRE_TO_CENTER, /* towards the centre of the region */
    PEL_FIBRE_ALONG,     /* along `axis`, projected into each rest triangle */
    PEL_FIBRE_PRINCIPAL  /* where the triangle is stretched most, as it is at the start of each step */
} pel_fibre_direction;

/* Local anisotropy (paper B, section 3). */
typedef struct pel_anisotropy_def {
    pel_fibre_mode mode;
    pel_fibre_kind kind;
    double stiffness; /* N/m, > 0, of the fibres; not read by PEL_FIBRE_CURL */
    double strength;  /* cave: length [m] that a triangle goes inward in a step where its fibre is shorter than at rest
                         by  5 % (in proportion to the square, so to the energy), limited to max_step; > 0 */
    double max_step;  /* cave: share of its edge that a triangle may go inward in a step, whatever the sweeps and
                         substeps; 0.05 by default */
    pel_quantity rest_length; /* active: factor on the length at rest, 0 to 1 and beyond; may be keyed */
    double curvature;         /* curl: factor on rest angles; -1 turns them round */
    pel_fibre_direction direction;
    double axis[3];
    double center[3];      /* for PEL_FIBRE_TO_CENTER, at rest [m] */
    const double *weights; /* (vertex_count) 0 to 1: the region and its falloff; null = the whole body */
} pel_anisotropy_def;

typedef enum pel_pressure_kind {
    PEL_PRESSURE_NONE,
    PEL_PRESSURE_GIVEN, /* `outside` alone, which may be keyed in time or a field */
    PEL_PRESSURE_GAS,   /* a gas within: p V^gamma stays; `value` is its pressure at rest, against the same outside */
    PEL_PRESSURE_VOLUME /* drives the volume to `target` times that at rest */
} pel_pressure_kind;

typedef struct pel_pressure_def {
    pel_pressure_kind kind;
    pel_pressure_form form;
    pel_quantity outside;  /* Pa: pushes inward when positive, inflates when negative; adds to a gas or a target volume,
                              beside which it has no field */
    double value;          /* Pa, of the gas at rest */
    double gamma;          /* of the gas; 1 = isothermal; 1.4 by default */
    pel_quantity target;   /* of PEL_PRESSURE_VOLUME: volume over that at rest; may be keyed */
    double bulk;           /* Pa: pressure per relative difference of volume, of PEL_PRESSURE_VOLUME */
    const double *weights; /* (vertex_count) 0 to 1: region; null = the whole body */
} pel_pressure_def;

/* All of a shell. The default has nothing switched on. */
typedef struct pel_shell_def {
    pel_membrane_def membrane;
    pel_bending_def bending;
    const pel_anisotropy_def *anisotropies; /* (anisotropy_count) */
    int32_t anisotropy_count;
    pel_pressure_def pressure;
} pel_shell_def;

PEL_API pel_shell_def pel_shell_def_default(void);
PEL_API pel_anisotropy_def pel_anisotropy_def_default(void);

#ifdef __cplusplus
}
#endif
#endif

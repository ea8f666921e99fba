/* Pellicle: defs of a thin shell: membrane, bending, fibres and pressure (paper B), as members of a pel_body_def.
   Arrays are read only during pel_model_create. */
#ifndef PELLICLE_SHELL_H
#define PELLICLE_SHELL_H

#include "kinds.h"
#include "quantity.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Constant-strain triangles of one of the materials (paper B, equations 1 and 2). */
typedef struct pel_membrane_def {
    bool on; /* false: no membrane */
    pel_membrane_kind kind;
    pel_quantity young; /* Pa, > 0; no keys */
    double poisson;
    pel_quantity thickness; /* m, > 0; no keys */
    double mooney_ratio;    /* default: 0.2 */
    double extension_limit; /* gent; default: 50 */
    double stiffening;      /* fung; default: 10 */
    double weft;            /* Pa, orthotropic: Young's modulus across the warp; 0 (default) = young */
    double shear;           /* Pa, orthotropic: shear modulus; 0 (default) = young / (2 (1 + poisson)); weave: > 0 */
    double warp_curve[PEL_WEAVE_POINTS][2]; /* weave: points (strain, stress [Pa]), as of pel_membrane_material */
    double weft_curve[PEL_WEAVE_POINTS][2];
    double yield;             /* Pa, elastoplastic: yield stress > 0 */
    double hardening;         /* Pa, elastoplastic: growth of the yield stress over plastic strain, >= 0; default: 0 */
    double direction[3];      /* orthotropic: the warp, projected into each rest triangle; default: x */
    const double *coordinate; /* (vertex_count) the warp runs along its gradient in each rest triangle, in place of
                                 `direction`; null = not given */
    double strain_limit;      /* 0 to less than 1; pbd, xpbd: principal stretches differ from 1 by at most this (Provot
                                 1995); 0 = no limit. Other methods refuse it */
    double retardation; /* s, >= 0: viscous stress over the stiffness times the rate of strain (Kelvin, Voigt); implicit
                           and xpbd, other methods in time refuse it */
    pel_quantity toughness; /* J/m2, energy per area of a tear, which is its length times the thickness: cuts grow where
                               they release more (pellicle/tear.h); 0 (default) = they do not; no keys */
    pel_quantity strength;  /* Pa, true stress at which a tear starts (pel_tear_def): the mean of the largest principal
                               stress over a disc of 1.32 young toughness / (pi strength^2) around a vertex; 0 (default)
                               = at no stress; needs a toughness; no keys */
    pel_quantity rest_scale;  /* > 0: lengths of the shape without stress over those of the mesh, a body that grows or
                                 shrinks; its mass, thickness and moduli stay; 0 (default) = 1; no keys, but: */
    const pel_key *rest_keys; /* (rest_key_count) over time the share r of it, from 0, the shape of the mesh, to 1: the
                                 scale is 1 + r (rest_scale - 1); none = 1 */
    int32_t rest_key_count;
} pel_membrane_def;

typedef enum pel_bending_model {
    PEL_BENDING_NONE,
    PEL_BENDING_ISOMETRIC,      /* paper B, equation 3, literally: flattens a curved rest shape */
    PEL_BENDING_ISOMETRIC_REST, /* the same energy minus that of the rest shape */
    PEL_BENDING_HINGE,          /* change of the dihedral angle */
    PEL_BENDING_MIDEDGE         /* shape operator with a rotation of each edge: a plate on every mesh */
} pel_bending_model;

enum { PEL_BENDING_COUNT = PEL_BENDING_MIDEDGE + 1 }; /* number of models */

typedef struct pel_bending_def {
    pel_bending_model model;
    double weight; /* pbd: factor on the correction of the positions, the paper's k_B, 0 to 1; negative: automatic,
                      so that the volume falls without jitter */
    pel_quantity stiffness; /* N m: flexural rigidity D, for all methods except pbd; negative: from young, poisson and
                               thickness of the membrane; no keys */
    double weft; /* N m: flexural rigidity about the warp, so of the weft, where `stiffness` is that of the warp; the
                    axes are the membrane's. Negative (default): that of an orthotropic membrane whose `stiffness` is
                    automatic, else equal to `stiffness` */
    double retardation; /* s, >= 0: of angles, as that of membranes; models hinge and midedge */
    double yield;       /* 1/m, >= 0: change of curvature from rest beyond which the sheet folds for good (plastically),
                           under its yield moment, stiffness times yield; 0 (default) = never. Model hinge */
    double hardening;   /* >= 0: growth of the yield moment over stiffness times plastic curvature (isotropic); default:
                           0.05 */
} pel_bending_def;

/* Effect of a region of fibres. */
typedef enum pel_fibre_mode {
    PEL_FIBRE_CAVE,   /* triangles with fibres shorter than at rest move inward, by a bounded way in each step */
    PEL_FIBRE_STRAIN, /* elastic fibres: resist stretch */
    PEL_FIBRE_ACTIVE, /* fibres with the rest length `rest_length` times their length: a muscle */
    PEL_FIBRE_CURL,   /* multiplies the rest angles of hinges in the region by `curvature`: negative values cave in */
    PEL_FIBRE_NORMAL, /* paper B's energy E_A of the fibres with the gradient `gradient` along the normal */
    PEL_FIBRE_MUSCLE  /* fibres that pull with activation times `tension` times a force-length curve (Hill 1938; the
                         parabola of Woittiez and others 1984): at the stretch s per width at rest
                         activation tension (1 - ((s - optimum) / width)^2), nothing where that is below 0 */
} pel_fibre_mode;

typedef enum pel_fibre_direction {
    PEL_FIBRE_TO_CENTER, /* towards the centre of the region */
    PEL_FIBRE_ALONG,     /* along `axis`, projected into each rest triangle */
    PEL_FIBRE_PRINCIPAL  /* direction of the largest stretch at the start of each step */
} pel_fibre_direction;

/* Local anisotropy (paper B, section 3). */
typedef struct pel_anisotropy_def {
    pel_fibre_mode mode;
    pel_fibre_kind kind;
    double stiffness; /* N/m, > 0, of the fibres; not read by PEL_FIBRE_CURL and PEL_FIBRE_MUSCLE */
    double strength;  /* cave: inward motion [m] of a triangle per step at a fibre strain of -5 %, proportional to the
                         square of the strain (to the energy), limited by max_step; > 0 */
    double max_step;  /* as a share of the edge. cave: maximum inward motion per step, for any sweeps and substeps.
                         normal, pbd: maximum motion by one correction. Default: 0.05 */
    double gradient;  /* normal: k_A [N], > 0: a triangle with the energy E_A moves its corners by E_A / (3 k_A) */
    pel_quantity rest_length; /* active: factor on the rest length, 0 to 1 or more; may be keyed */
    double tension;           /* muscle: N/m, > 0: largest stress of the muscle times its thickness */
    pel_quantity activation;  /* muscle: 0 to 1; may be keyed, or vary over the body */
    double optimum;           /* muscle: stretch at which it is strongest, > 0; default: 1 */
    double width;             /* muscle: distance from it at which it has no force, > 0; default: 0.5 */
    double curvature;         /* curl: factor on rest angles; -1 inverts them */
    pel_fibre_direction direction;
    double axis[3];
    double center[3];      /* for PEL_FIBRE_TO_CENTER, at rest [m] */
    const double *weights; /* (vertex_count) 0 to 1: the region and its falloff; null = the whole body */
} pel_anisotropy_def;

typedef enum pel_pressure_kind {
    PEL_PRESSURE_NONE,
    PEL_PRESSURE_GIVEN, /* only `outside`, which may be keyed in time or a field */
    PEL_PRESSURE_GAS, /* an enclosed gas with constant p V^gamma; `value` is its pressure at rest, equal to that outside
                       */
    PEL_PRESSURE_VOLUME /* prescribes the volume as `target` times that at rest */
} pel_pressure_kind;

typedef struct pel_pressure_def {
    pel_pressure_kind kind;
    pel_pressure_form form;
    pel_quantity outside;  /* Pa: positive pushes inward, negative inflates. Acts in addition to a gas or a target
                              volume; it may not be a field then */
    double value;          /* Pa, of the gas at rest */
    double gamma;          /* of the gas; 1 = isothermal; default: 1.4 */
    pel_quantity target;   /* of PEL_PRESSURE_VOLUME: volume relative to rest; may be keyed */
    double bulk;           /* Pa, of PEL_PRESSURE_VOLUME: pressure per relative difference from the target volume */
    const double *weights; /* (vertex_count) 0 to 1: region; null = the whole body */
} pel_pressure_def;

/* A shell. The default has no parts. */
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

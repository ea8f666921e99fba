/* A membrane material as a law and its numbers. Each law has its own file (law/NAME.h), which defines

       pel_law_NAME          energy, stress and tangent of a strain, in units of the shear modulus (law/strain.h)
       pel_law_NAME_of       shear modulus and numbers of a material
       pel_law_NAME_refuse   names a number of the material that is out of the law's range
       pel_law_NAME_traits   properties for the generic code, and the numbers of a material that it reads

   and has a row in PEL_MEMBRANE_LAWS (pellicle/kinds.h), from which the build makes law/files.h. No other code
   depends on a law. */
#ifndef PEL_LAW_MEMBRANE_H
#define PEL_LAW_MEMBRANE_H

#include "pellicle/material.h"

enum { PEL_LAW_NUMBERS = 25 };

typedef struct pel_membrane_law {
    pel_membrane_kind kind;
    double modulus; /* shear modulus times thickness [N/m]: unit of energy, stress and tangent */
    double poisson; /* Poisson's ratio at small strain */
    double numbers[PEL_LAW_NUMBERS];
} pel_membrane_law;

typedef enum pel_law_trait {
    PEL_LAW_OF_STRAIN = 0,        /* any function of the strain: P = F t */
    PEL_LAW_BY_AREA = 1,          /* a function of tr C and J: P = 2 psi_t F + psi_J dJ/dF, finite at J = 0 */
    PEL_LAW_ALIGNED = 2,          /* of the strain of the triangle factor instead of the Green strain */
    PEL_LAW_CONSTANT_TANGENT = 4, /* D is the plane-stress tangent at any strain, so it has a compliance */
    PEL_LAW_COMPLIANT = 128,      /* D has an inverse in closed form (pel_compliance) at any strain */
    PEL_LAW_ORIENTED = 256,       /* the first two numbers are an axis in the rest frame, of each triangle its own */
    PEL_LAW_YIELDS = 2048,        /* the first number is the plastic slip, of each triangle its own; reads yield and
                                     hardening */
    /* numbers of a material that some laws read; all read young and thickness */
    PEL_LAW_READS_POISSON = 8,
    PEL_LAW_READS_MOONEY_RATIO = 16,
    PEL_LAW_READS_EXTENSION_LIMIT = 32,
    PEL_LAW_READS_STIFFENING = 64,
    PEL_LAW_READS_WEFT = 512,
    PEL_LAW_READS_SHEAR = 1024,
} pel_law_trait;

/* a number that some laws read: its key in scenes, and its place in pel_membrane_material */
typedef struct pel_material_number {
    const char *name;
    int trait;
    size_t offset;
} pel_material_number;

/* a number out of range; member is null if there is none */
typedef struct pel_law_refusal {
    const char *member, *range;
    double value;
} pel_law_refusal;

pel_membrane_law pel_membrane_law_of(const pel_membrane_material *material);

/* pel_law_trait of a kind, combined */
int pel_membrane_law_traits(pel_membrane_kind kind);

/* elements have a compliance: a law with a constant tangent 1 / (area young thickness), a compliant one
   1 / (area modulus) */
static inline bool pel_law_has_compliance(int traits)
{
    return (traits & (PEL_LAW_CONSTANT_TANGENT | PEL_LAW_COMPLIANT)) != 0;
}

enum { PEL_LAW_AXIS = 2 };
static inline bool pel_law_is_oriented(int traits)
{
    return (traits & PEL_LAW_ORIENTED) != 0;
}
static inline bool pel_law_yields(int traits)
{
    return (traits & PEL_LAW_YIELDS) != 0;
}
/* the first numbers, of which each triangle has its own */
static inline int pel_law_own_numbers(int traits)
{
    return pel_law_is_oriented(traits) ? PEL_LAW_AXIS : pel_law_yields(traits) ? 1 : 0;
}

/* words of scenes, by kind; null after the last */
extern const char *const pel_membrane_words[];

/* null after the last */
const pel_material_number *pel_material_number_at(int32_t index);

#endif

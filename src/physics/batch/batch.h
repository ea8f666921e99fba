/* Elements of one kind in blocks of PEL_BLOCK that share no vertex, so that all lanes of a block are computed together:
   projection moves its points, forces add to them. A block's vertices and numbers are stored together, lane by lane;
   the unused lanes of a last block repeat a used one, which is harmless because all lanes are loaded before any is
   stored. Blocks are ordered by bundle (batches.h) and within a bundle by colour. */
#ifndef PEL_BATCH_BATCH_H
#define PEL_BATCH_BATCH_H

#include "base/assert.h"
#include "base/wide.h"
#include "law/membrane.h"
#include "law/solid.h"

/* Compute the displacements of up to 4 blocks of one colour before applying any. A processor looks only some hundred
   operations beyond a pending division: this gives it the next blocks to work on (8 and 16: no better). */
enum { PEL_BATCH_GROUP = 4 };

/* Kinds of batches, with their numbers per element. A softness is 1 / stiffness; for a membrane 1 / (area young
   thickness), and for laws without a constant tangent 1 / (area shear modulus). "Compliant" kinds serve xpbd and
   forces; the kinds of pbd, whose constraints are the energies, have the same numbers and some that only pbd reads. */
typedef enum pel_constraint {
    PEL_CONSTRAINT_DISTANCE, /* rest length */
    PEL_CONSTRAINT_SPRING,   /* rest length, softness */
    PEL_CONSTRAINT_MEMBRANE, /* inverse of the rest matrix (3), softness, of oriented laws the axis (2), of ones that
                                yield the slip; one kind for each material from here on */
    PEL_CONSTRAINT_STRAIN = PEL_CONSTRAINT_MEMBRANE + PEL_MEMBRANE_COUNT,  /* the same */
    PEL_CONSTRAINT_ISOMETRIC = PEL_CONSTRAINT_STRAIN + PEL_MEMBRANE_COUNT, /* weights of x1, x2, x3, softness, and
                                 |K x|^2 of the rest shape, 0 for the literal form */
    PEL_CONSTRAINT_ISOMETRIC_COMPLIANT,                                    /* the same */
    PEL_CONSTRAINT_ANGLE,           /* cosine and sine of the rest angle, softness */
    PEL_CONSTRAINT_ANGLE_COMPLIANT, /* the same */
    PEL_CONSTRAINT_FOLD,            /* the same of a rest angle that follows, and the yield angle */
    PEL_CONSTRAINT_FIBRE,           /* image weights of x0 - x2 and x1 - x2, softness, weight of the region */
    PEL_CONSTRAINT_FIBRE_SQUARE,    /* the same, energy in the square of the length */
    PEL_CONSTRAINT_FIBRE_COMPLIANT, /* without the weight */
    PEL_CONSTRAINT_FIBRE_SQUARE_COMPLIANT,
    PEL_CONSTRAINT_MUSCLE,        /* the same, with the softness of the tension */
    PEL_CONSTRAINT_CAVE,          /* image weights, then as in pel_cave_number */
    PEL_CONSTRAINT_NORMAL,        /* image weights, then as in pel_normal_number */
    PEL_CONSTRAINT_NORMAL_SQUARE, /* the same, energy in the square of the length */
    PEL_CONSTRAINT_LIMIT,         /* inverse of the rest matrix (3): principal stretches between two limits */
    PEL_CONSTRAINT_PRESSURE,      /* weight, or none where all are 1; a force, never projected */
    PEL_CONSTRAINT_SOLID, /* gradients of the first three corners (9), softness: 1 / (young volume); one kind for each
                             law */
    PEL_CONSTRAINT_LAST = PEL_CONSTRAINT_SOLID + PEL_VOLUME_COUNT - 1,
    PEL_CONSTRAINT_COUNT
} pel_constraint;

enum {
    PEL_TRIANGLE_NUMBERS = 4, /* and those that each triangle has of its law: pel_triangle_numbers */
    PEL_ISOMETRIC_NUMBERS = 5,
    PEL_ANGLE_NUMBERS = 3,
    PEL_FOLD_NUMBERS = 4,
    PEL_FIBRE_NUMBERS = 3,
    PEL_FIBRE_WEIGHTED_NUMBERS = 4,
    PEL_SOLID_NUMBERS = 10
};

/* numbers of a triangle of a law with these traits */
static inline int pel_triangle_numbers(int traits)
{
    return PEL_TRIANGLE_NUMBERS + pel_law_own_numbers(traits);
}

/* numbers of a triangle that caves in */
typedef enum pel_cave_number {
    PEL_CAVE_WEIGHT = 2, /* of the region */
    PEL_CAVE_SHARE,      /* three: of each corner, of the area around it */
    PEL_CAVE_WAY = 6,    /* three: m, of each corner inward in a projection of this step */
    PEL_CAVE_NUMBERS = 9
} pel_cave_number;

/* numbers of a triangle with the energy E_A, whose gradient is along its normal */
typedef enum pel_normal_number {
    PEL_NORMAL_PUSH = 2, /* m: E_A over k_A at a strain of the fibre whose square is 2 */
    PEL_NORMAL_MOST,     /* m: bound on the way of a corner in a correction of pbd */
    PEL_NORMAL_LIMITED,  /* corrections of this step that the bound cut */
    PEL_NORMAL_NUMBERS
} pel_normal_number;

/* numbers that all elements of a batch share */
typedef struct pel_batch_law {
    pel_real numbers[PEL_LAW_NUMBERS]; /* membrane: constants of its law */
    pel_solid_law solid;               /* tetrahedra */
    double modulus;                    /* membrane: shear modulus of the law over young */
    pel_real poisson;                  /* membrane: Poisson's ratio at small strain */
    pel_real weight;                   /* bending of pbd: k_B */
    pel_real fold_share;               /* folds: of the stiffness, beyond the yield angle */
    pel_real share;          /* pbd: share of a correction that is applied, below 1 if a step has several substeps */
    pel_real least_strain;   /* limit: Green strain of the least principal stretch */
    pel_real most_strain;    /* limit: of the largest one */
    pel_real rest_length;    /* fibres: factor on the length at rest, now; muscles: their activation */
    pel_real optimum, width; /* muscles: of their force-length curve */
    pel_real square_time;    /* s2, of the substep, times the factor of a keyed stiffness */
    pel_real inverse_square; /* its inverse */
    pel_real correction;     /* of compliant kinds: what a single sweep takes off the softness at most, as a share */
    pel_real viscosity;      /* of compliant kinds: retardation over the length of a substep; 0 = elastic */
    pel_real force_rate;     /* 1/s2: from displacements times masses to forces */
} pel_batch_law;

typedef struct pel_batch {
    pel_constraint kind;
    pel_batch_law law;
    int arity, number_count, multiplier_count;
    int32_t region;        /* of the shell whose fibres these are, else -1 */
    bool is_projected;     /* the method sweeps over it; else it is there for forces and energies */
    bool is_on;            /* it is, and has an effect at present */
    int32_t capacity;      /* blocks */
    int32_t block_count;   /* in use */
    bool is_shared;        /* everything but the numbers belongs to another batch */
    int32_t *bundle_begin; /* (bundle_count + 1) first block of each bundle */
    int32_t *steps;        /* (capacity x arity x PEL_BLOCK) places in the model's order times PEL_STEP */
    pel_real *numbers;     /* (capacity x number_count x PEL_BLOCK) */
    int32_t *sources;      /* (capacity x PEL_BLOCK) the element in a lane, numbered as it was given; null when its
                              numbers never change */
    uint8_t *lane_counts;  /* (capacity) lanes used */
    uint8_t *followers;    /* (capacity) blocks after this one that are computed with it; all of one colour */
    /* of projection */
    const pel_record *before; /* (model vertex_count) positions at the start of the substep, of viscous ones */
    pel_real *multipliers;    /* (capacity x multiplier_count x PEL_BLOCK) of xpbd with iterations; else null */
    uint8_t *has_fixed;   /* (capacity) 1 = a vertex of the block is pinned or held; null = reactions not recorded */
    pel_record *reaction; /* (model vertex_count) forces on the holders of vertices; null likewise */
} pel_batch;

static inline bool pel_batch_is_solid(const pel_batch *batch)
{
    return batch->kind >= PEL_CONSTRAINT_SOLID && batch->kind <= PEL_CONSTRAINT_LAST;
}

static inline bool pel_batch_is_membrane(const pel_batch *batch)
{
    return batch->kind >= PEL_CONSTRAINT_MEMBRANE && batch->kind < PEL_CONSTRAINT_ISOMETRIC;
}

/* energies of fibres whose gradient is along the normal */
static inline bool pel_batch_is_push(const pel_batch *batch)
{
    return batch->kind == PEL_CONSTRAINT_NORMAL || batch->kind == PEL_CONSTRAINT_NORMAL_SQUARE;
}

static inline pel_real *pel_batch_number(const pel_batch *batch, int32_t i, int j)
{
    PEL_ASSERT_INDEX(i, batch->block_count * PEL_BLOCK);
    PEL_ASSERT_INDEX(j, batch->number_count);
    size_t block = (size_t)i / PEL_BLOCK, lane = (size_t)i % PEL_BLOCK;
    return &batch->numbers[(block * (size_t)batch->number_count + (size_t)j) * PEL_BLOCK + lane];
}

#endif

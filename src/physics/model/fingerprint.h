/* Fingerprint of all input that determines the result of a simulation: hashes of the members of the defs of a model and
   a sim, part by part, so that a snapshot made with other input is refused with the name of the part that differs.
   Names, numbers of threads and memory limits are excluded. */
#ifndef PEL_MODEL_FINGERPRINT_H
#define PEL_MODEL_FINGERPRINT_H

#include "pellicle/sim.h"

/* names of the parts for users */
#define PEL_PARTS(ROW)                                                                                                 \
    ROW(MESH, "mesh")                                                                                                  \
    ROW(MASS, "mass")                                                                                                  \
    ROW(PINS, "pinned vertices")                                                                                       \
    ROW(START, "velocity at the start")                                                                                \
    ROW(GRAVITY, "gravity")                                                                                            \
    ROW(SPRINGS, "springs")                                                                                            \
    ROW(VOLUMETRIC, "volumetric springs")                                                                              \
    ROW(SURFACE, "contact of a body")                                                                                  \
    ROW(REFINEMENT, "refinement")                                                                                      \
    ROW(MEMBRANE, "membrane")                                                                                          \
    ROW(BENDING, "bending")                                                                                            \
    ROW(ANISOTROPY, "anisotropy")                                                                                      \
    ROW(PRESSURE, "pressure")                                                                                          \
    ROW(LOADS, "loads")                                                                                                \
    ROW(SUPPORTS, "supports")                                                                                          \
    ROW(TOOLS, "tools")                                                                                                \
    ROW(CONTACT, "contact")                                                                                            \
    ROW(SOLVER, "solver")

typedef enum pel_part {
#define PEL_PART_ENUMERATOR(PART, name) PEL_PART_##PART,
    PEL_PARTS(PEL_PART_ENUMERATOR)
#undef PEL_PART_ENUMERATOR
        PEL_PART_COUNT,
    PEL_PART_SAME /* part of the def that contains the member */
} pel_part;

typedef struct pel_fingerprint {
    uint64_t parts[PEL_PART_COUNT];
} pel_fingerprint;

typedef enum pel_member_form {
    PEL_MEMBER_END,   /* of a table */
    PEL_MEMBER_PLAIN, /* `size` bytes without padding */
    PEL_MEMBER_DEF,   /* a nested def, with its own table */
    PEL_MEMBER_LIST,  /* nullable pointer to `count` elements of `size` bytes, plain or defs */
    PEL_MEMBER_FIELD, /* nullable pointer to a double for each vertex of the body's mesh */
    PEL_MEMBER_MESH,  /* nullable pointer to a mesh: positions and triangles */
    PEL_MEMBER_TEXT,  /* nullable name; decides nothing */
    PEL_MEMBER_OTHER  /* decides nothing, or is the count of a list */
} pel_member_form;

/* A member of a def. */
typedef struct pel_member {
    pel_part part;
    pel_member_form form;
    size_t offset, size;
    const struct pel_member *members; /* of defs, up to PEL_MEMBER_END */
    size_t count_offset;              /* of lists: int32_t */
} pel_member;

/* of a pel_model_def, its bodies, and a pel_sim_def */
extern const pel_member pel_model_members[], pel_body_members[], pel_sim_members[];

/* Adds the members of a valid def of such a table. */
void pel_fingerprint_add(pel_fingerprint *fingerprint, const pel_member *members, const void *def);
/* Of a pel_model_def whose meshes are those of before: the same as a new fingerprint. */
void pel_fingerprint_renew(pel_fingerprint *fingerprint, const void *def);
void pel_fingerprint_add_bytes(pel_fingerprint *fingerprint, pel_part part, const void *bytes, size_t size);

/* The names of the parts that differ, "gravity, tools"; empty when none does. Returns text. */
const char *pel_fingerprint_compare(const pel_fingerprint *a, const pel_fingerprint *b, char *text, size_t size);

#endif

/* Fingerprint of all input that determines the result of a simulation: hashes of the members of the defs of a model and
   a sim, part by part, so that a snapshot made with other input is refused with the name of the part that differs.
   Names, numbers of threads and memory limits are excluded. */
#ifndef PEL_DEF_FINGERPRINT_H
#define PEL_DEF_FINGERPRINT_H

#include "def/row.h"

typedef struct pel_fingerprint {
    uint64_t parts[PEL_PART_COUNT];
} pel_fingerprint;

/* Adds the members of a valid def of a model or a simulation. */
void pel_fingerprint_add(pel_fingerprint *fingerprint, pel_def_kind kind, const void *def);
/* Of a pel_model_def whose meshes are those of before: the same as a new fingerprint. */
void pel_fingerprint_renew(pel_fingerprint *fingerprint, const void *def);
void pel_fingerprint_add_bytes(pel_fingerprint *fingerprint, pel_part part, const void *bytes, size_t size);

/* The names of the parts that differ, "gravity, tools"; empty when none does. Returns text. */
const char *pel_fingerprint_compare(const pel_fingerprint *a, const pel_fingerprint *b, char *text, size_t size);

#endif

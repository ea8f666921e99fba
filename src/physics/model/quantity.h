/* Numbers that may vary over a body or over time. */
#ifndef PEL_MODEL_QUANTITY_H
#define PEL_MODEL_QUANTITY_H

#include "model/model.h"

/* Whether times and values are finite, and times increase. */
bool pel_keys_are_ordered(const pel_key *keys, int32_t count);
/* PEL_BAD_ARGUMENT with body, name, value and remedy. */
pel_status pel_body_refuse(pel_error *error, int32_t body, const char *name, double value, const char *remedy);

/* Refuses (PEL_BAD_ARGUMENT with body, name and value) values that are not finite or below 0, a field together with
   keys, and keys that are not allowed or whose times do not increase. */
pel_status pel_quantity_check(const pel_quantity *quantity, int32_t vertex_count, int32_t body, const char *name,
                              bool keys_allowed, pel_error *error);
/* the same for numbers that may be below 0 */
pel_status pel_quantity_check_signed(const pel_quantity *quantity, int32_t vertex_count, int32_t body, const char *name,
                                     bool keys_allowed, pel_error *error);

/* The toughness of a body: 0 everywhere = it does not tear. */
/* and the strength, which needs a toughness: 0 everywhere = tears start at no stress */
pel_status pel_strength_check(const pel_quantity *strength, const pel_quantity *toughness, const pel_body_def *def,
                              int32_t body, pel_error *error);
pel_status pel_toughness_check(const pel_quantity *toughness, const pel_body_def *def, int32_t body, pel_error *error);

/* Its value on a vertex; 1 when it is keyed. */
double pel_quantity_at(const pel_quantity *quantity, int32_t v);
/* Its mean over the vertices of a mesh. */
double pel_quantity_mean(const pel_quantity *quantity, int32_t vertex_count);

/* Keeps the keys of a quantity, if any; freed by pel_free(curve->keys). */
pel_status pel_curve_copy(const pel_quantity *quantity, pel_curve *curve, pel_error *error);

#endif

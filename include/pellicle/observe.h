/* Pellicle: fields of a simulation by name, such as displacement, force, stress and curvature. One table defines them
   for scene output, frames, reports and viewers.

       int32_t field = pel_field_find("von_mises_top");
       double *values = malloc(...);    (pel_sim_vertex_count x components)
       pel_observe(sim, field, body, values, &error);

   Call these functions between steps, from the thread that steps the simulation. */
#ifndef PELLICLE_OBSERVE_H
#define PELLICLE_OBSERVE_H

#include "sim_step.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum pel_field_place {
    PEL_FIELD_ON_VERTICES,
    PEL_FIELD_ON_BOTH /* on triangles, and on vertices as the mean of the adjacent triangles, weighted by area */
} pel_field_place;

typedef struct pel_field_info {
    const char *name;
    int32_t component_count; /* 1; 2 = principal values; 3 = vector; 6 = tensor xx, yy, zz, xy, yz, xz */
    const char *unit;        /* "" = none */
    pel_field_place place;
    const char *doc; /* one sentence without full stop */
} pel_field_info;

/* The table of fields, by number. */
PEL_API int32_t pel_field_count(void);
PEL_API const pel_field_info *pel_field_at(int32_t field);
/* The number of a field by name; -1 if there is none. */
PEL_API int32_t pel_field_find(const char *name);

/* Values of a field on the vertices of a body (pel_sim_vertex_count x component_count), rows as those of
   pel_sim_get_positions. Intermediate results that several fields need are computed once per state. PEL_BAD_ARGUMENT
   for a field or body that does not exist, PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_observe(pel_sim *sim, int32_t field, int32_t body, double *values, pel_error *error);
/* The same on triangles (pel_sim_triangle_count x component_count), in the order of pel_sim_get_triangles;
   PEL_BAD_ARGUMENT for a field that exists only on vertices. */
PEL_API pel_status pel_observe_triangles(pel_sim *sim, int32_t field, int32_t body, double *values, pel_error *error);

#ifdef __cplusplus
}
#endif
#endif

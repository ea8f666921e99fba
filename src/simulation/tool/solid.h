/* Spheres, capsules and boxes in the substeps of position-based methods: one contact for each vertex near a tool and
   one for each triangle near it, whose weights, normal and gap follow the present positions in every sweep. Near
   features are found once a step. */
#ifndef PEL_TOOL_SOLID_H
#define PEL_TOOL_SOLID_H

#include "contact/contact.h"
#include "geom/solid.h"
#include "stage/stage.h"

typedef struct pel_solid_pair {
    int32_t tool;
    int32_t triangle; /* -1 = the vertex */
    int32_t vertex;
    pel_solid solid; /* that the triangle is kept out of */
} pel_solid_pair;

struct pel_sim_solids {
    pel_contact_list list;
    pel_solid_pair *pairs; /* (list.count) */
    size_t capacity, pair_capacity;
    int32_t *mark_of_vertex; /* (vertex_count) scratch: tool that listed it last, plus 1 */
};

/* Null solids when no solid presses or the method has no substeps. PEL_OUT_OF_MEMORY. */
pel_status pel_solids_create(pel_sim *sim, pel_error *error);
void pel_solids_destroy(pel_sim *sim);
/* At the start of a step, tools at their wanted poses: lists features that they may touch in it. PEL_OUT_OF_MEMORY. */
pel_status pel_solids_find(pel_sim *sim, pel_error *error);
/* Contacts at position_next and the present poses; impulses of the substep are kept. start (vertex_count): positions at
   the start of the substep. */
void pel_solids_refresh(pel_sim *sim, const pel_record *start);

/* After the sweeps of a substep: its impulses act on the tools. rate: see pel_contact_take. */
void pel_solids_tally(pel_sim *sim, double rate);

#endif

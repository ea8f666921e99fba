/* Spheres, capsules and boxes in the substeps of position-based methods: one contact for each vertex near a tool and
   one for each triangle near it, whose weights, normal and gap follow the present positions in every sweep. Near
   features are found once a step. The contacts are layers, as those between surfaces are (sweep/sweep.c). */
#ifndef PEL_TOOL_SOLID_H
#define PEL_TOOL_SOLID_H

#include "collide/travel.h"
#include "geom/solid.h"
#include "stage/transfer.h"
#include "sweep/patch.h"

typedef struct pel_solid_pair {
    int32_t tool;
    int32_t triangle; /* -1 = the vertex */
    int32_t vertex;
    pel_solid solid;                /* that the triangle is kept out of */
    bool is_known;                  /* its slack is */
    bool is_near;                   /* it may touch in this substep */
    double slack;                   /* m, by which it may be in the tool: it was so at the start */
    double approach;                /* m/s, with which it came, that the layer stops */
    double load, earlier, drag[3];  /* N, along the normal and across it; warm start of the next substep */
    double mean_load, mean_drag[3]; /* N, over the substeps of this step */
    double owed, owed_drag[3];      /* N, parts of them that are no forces of the step yet */
} pel_solid_pair;

/* pairs of one body with a tool that stand together */
typedef struct pel_solid_run {
    int32_t body, end; /* up to this pair */
    double calm;       /* m, the least of its `calm`: until then none need be looked at, */
    bool acts;         /* and whether one is active */
} pel_solid_run;

struct pel_sim_solids {
    pel_contact_list list; /* its `active` is: */
    int32_t *active;       /* (list.active_count) */
    pel_solid_pair *pairs; /* (list.count) */
    double *calm;          /* (list.count) m, way of its body up to which a pair need not be looked at */
    pel_solid_run *runs;   /* (run_count) of all pairs, in their order */
    int32_t run_count;
    pel_contact_patches patches;
    size_t capacity, pair_capacity, calm_capacity, active_capacity, run_capacity;
    pel_travel travel; /* in this step, of vertices and tools */
    bool is_moved;     /* a tool has moved in this substep, or in the one before: */
    bool moves;
    bool has_slack;       /* a pair may have */
    pel_solid_pair *kept; /* (kept_count) those of the last step that carried a load or had slack */
    int32_t kept_count;
    size_t kept_capacity;
    int32_t *pair_of_vertex, *pair_of_triangle; /* (vertex_count, triangle_count) scratch: the pair that has it */
};

/* Null solids when no solid presses or the method has no substeps. PEL_OUT_OF_MEMORY. */
pel_status pel_solids_create(pel_sim *sim, pel_error *error);
void pel_solids_destroy(pel_sim *sim);
/* At the start of a step, tools at their wanted poses: lists features that they may touch in it; those of the last step
   keep their loads. PEL_OUT_OF_MEMORY. */
pel_status pel_solids_find(pel_sim *sim, pel_error *error);
/* Marks bodies (body_count) of contacts that carry a load from the substep before, or from any of this step. */
void pel_solids_mark_carried(const pel_sim *sim, uint8_t *bodies);
/* contacts of a body with a tool carry nothing any more */
void pel_solids_forget_loads(pel_sim *sim, int32_t body, int32_t tool);
/* Before the first substep of a step, its length [s]: kept loads in the multipliers. */
void pel_solids_recall_loads(pel_sim *sim, double substep);
/* At the start of a substep of this length [s]: less slack. */
void pel_solids_begin_substep(pel_sim *sim, double substep);
/* Contacts at position_next and the present poses, and which of them are active, where anything has moved enough;
   multipliers are kept. start (vertex_count): positions at the start of the substep. is_first: in this substep, nothing
   has acted yet; otherwise loaded contacts stay unchanged. */
void pel_solids_refresh(pel_sim *sim, const pel_record *start, bool is_first);
/* m, the least thickness of the layers before tools */
double pel_solids_thickness(const pel_sim *sim);

/* After the sweeps of a substep: its loads act on the tools, as soon as contacts change or loads are kept. rate: see
   pel_contact_take. */
void pel_solids_tally(pel_sim *sim, double rate);
/* After the last substep: the loads of the multipliers are kept. */
void pel_solids_keep_loads(pel_sim *sim);

/* The bodies (body_count) that fell asleep: their pairs keep the mean loads of the step. */
void pel_solids_keep_means(const pel_sim *sim, const uint8_t *fell_asleep);
/* After the substeps: kept loads on what is asleep act on the tools in this step. */
void pel_solids_tally_asleep(pel_sim *sim);

/* After an event of refinement: pairs of vertices whose places were given up are forgotten. */
void pel_solids_release(pel_sim *sim);
/* Pairs that carry a load: as many as there are at present. */
pel_transfer_part pel_solids_transfer;
/* After it was loaded: false, and no pairs, when one is of something that does not exist. */
bool pel_solids_restore(pel_sim *sim);
/* Takes over the pairs of another simulation of the same surfaces, by the names of tools. PEL_OUT_OF_MEMORY. */
pel_status pel_solids_take_over(pel_sim *sim, const pel_sim *from, pel_error *error);

#endif

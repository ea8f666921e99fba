/* Loads of all kinds, and their sums. */
#ifndef PEL_BOUNDARY_LOADS_H
#define PEL_BOUNDARY_LOADS_H

#include "stage/stage.h"
#include "stage/transfer.h"

typedef struct pel_load {
    char name[PEL_NAME_SIZE];
    double force[3];   /* N, on a vertex of weight 1 */
    int32_t *vertices; /* (vertex_count) in model order */
    double *weights;   /* (vertex_count) */
    int32_t vertex_count;
    /* on a body that refines: a load is proportional to area, like mass (levels.h) */
    double *base_weights;    /* (mesh vertices) */
    double *densities;       /* (vertices of the finest level) */
    double *weight_of_place; /* (places of the body) 0 = none */
    double from, until;
    pel_key *keys;
    int32_t key_count;
    int32_t body;
    pel_load_kind kind;
} pel_load;

/* a moment on one boundary edge (edge_load.c) */
typedef struct pel_edge_load {
    int32_t load, edge;
    double along[3]; /* m, the edge at rest */
} pel_edge_load;

/* a follower load on one boundary edge (follower.c) */
typedef struct pel_follower {
    int32_t load, vertices[3]; /* ends of the edge with its triangle to the left, tip */
    double rest[3][3];         /* its frame at rest */
    double length;             /* m at rest, times the weight of the load */
    /* of the last evaluation: N; turn of the frame by displacements of the vertices */
    double force[3], turns[3][3][3];
} pel_follower;

struct pel_loads {
    pel_load *items; /* (count) */
    int32_t count;
    pel_record *external;      /* (vertex_count) N, forces of the caller; null = none yet */
    pel_edge_load *edge_loads; /* (edge_load_count) null = none */
    int32_t edge_load_count;
    double edge_load_work;   /* J, in the step */
    pel_follower *followers; /* (follower_count) null = none */
    int32_t follower_count;
};

pel_status pel_loads_create(pel_sim *sim, const pel_load_def *defs, int32_t count, pel_error *error);
void pel_loads_destroy(pel_sim *sim);
/* Moves the new positions and velocities by the loads at the present time. False when a vertex leaves the bound. */
bool pel_loads_apply(pel_sim *sim, pel_gains gains);
/* there is one, gravity included */
bool pel_loads_exist(const pel_sim *sim);
/* the same, or a pressure from outside or inside */
bool pel_loads_act(const pel_sim *sim);
/* N m: the product of a load at a time with vectors on vertices (3 vertex_count) */
double pel_load_product(const pel_sim *sim, int32_t load, double time, const double *vectors);
/* Adds the loads at a time, gravity included, to force (vertex_count); follower loads at some positions, null = without
   these. */
void pel_loads_add(const pel_sim *sim, double time, const pel_record *positions, pel_record *force);

/* Work of the loads [J] over a step to position_next, from one time to another: mean force times displacement. */
double pel_loads_work(const pel_sim *sim, double from, double to);

/* Brings the loads on a body after the last event. */
void pel_loads_update(pel_sim *sim, int32_t body);
/* The same for all places, after a snapshot was loaded. */
void pel_loads_rebuild(pel_sim *sim, int32_t body);

/* Takes force and times of a def that differs in no other member, if they are right. PEL_BAD_ARGUMENT. */
pel_status pel_load_retime(pel_sim *sim, int32_t load, const pel_load_def *def, pel_error *error);

/* a pel_transfer_part: the force of a load */
void pel_load_transfer(pel_cursor *at, const pel_sim *sim, int32_t load);

#endif

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
    double way[3];   /* m, weighed: velocity at the end of the last substep times its length */
    bool is_tallied; /* its work is summed over substeps */
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
    double pushed[3]; /* N, in the present substep */
} pel_follower;

struct pel_loads {
    pel_load *items; /* (count) */
    int32_t count;
    pel_record *external;      /* (vertex_count) N, forces of the caller; null = none yet */
    pel_record *dragged;       /* (vertex_count) N, forces of blades at their limits (blade/hold.h); null = no blade */
    pel_edge_load *edge_loads; /* (edge_load_count) null = none */
    int32_t edge_load_count;
    double edge_load_work; /* J, in the step */
    double tallied_work;   /* J, in the substeps of the step, of loads that are tallied and of forces of the caller */
    double external_work;  /* J, of the latter with the velocities at the end of the last substep times its length */
    pel_record *pressed; /* (vertex_count) N, pressures of a substep; null = their work is a difference of potentials */
    double pressure_work;    /* J, of these in the substeps of the step */
    const uint8_t *is_plain; /* (body_count) set by the method: bodies whose loads never extrapolate; null = none */
    pel_follower *followers; /* (follower_count) null = none */
    int32_t follower_count;
    int32_t fluid_count;   /* bodies that hold a liquid (fluid.c) */
    struct pel_wind *wind; /* (wind.c) null = no air */
};

pel_status pel_loads_create(pel_sim *sim, const pel_load_def *defs, int32_t count, pel_error *error);
void pel_loads_destroy(pel_sim *sim);
/* Moves the new positions and velocities by the loads over a span. False when a vertex leaves the bound. */
bool pel_loads_apply(pel_sim *sim, pel_span span, pel_gains gains);
/* there is one, gravity included */
bool pel_loads_exist(const pel_sim *sim);
/* the same, or a pressure from outside or inside */
bool pel_loads_act(const pel_sim *sim);
/* N m: the product of a load over a span with vectors on vertices (3 vertex_count) */
double pel_load_product(const pel_sim *sim, int32_t load, pel_span span, const double *vectors);
/* mean factor of a load over a span, with that of the path */
double pel_load_factor(const pel_sim *sim, const pel_load *load, pel_span span);
/* The span of loads that kick the velocities at a time: the step that begins there, or the time around it where
   velocities belong to the middle of a step. */
pel_span pel_loads_kick_span(const pel_sim *sim, double time);
/* It is the first step of a method that finds states of rest. What acts at its start has no balance yet: the body falls
   from there under the loads at the end of the step, whose work is theirs all the way. A load that begins at 0 passes
   through the loads in between. */
bool pel_loads_begin_at_once(const pel_sim *sim);
/* The spans of the two loads whose mean does the work of a step from one time to another. */
void pel_loads_find_spans(const pel_sim *sim, double from, double to, pel_span spans[2]);
/* The mean of a load or pressure over a span is far from that over the same time before it. */
bool pel_loads_jump(const pel_sim *sim, pel_span span);

/* Adds the loads over a span, gravity included, to force (vertex_count); follower loads at some positions, null =
   without these. */
void pel_loads_add(const pel_sim *sim, pel_span span, const pel_record *positions, pel_record *force);

/* Before the substeps of a step, of length h [s]; and after one over a span, with positions at its start: the work of
   loads that change in the step, and of all in second order. */
void pel_loads_begin_tally(pel_sim *sim, double h);
void pel_loads_tally(pel_sim *sim, pel_span span, const pel_record *start);
/* Adds the pressures at the start of a substep, at positions that have come from those `before` or, where that is null,
   move with velocities; the tally has their work where it is no difference of potentials: they change in time, or
   follow a surface. */
void pel_loads_press(pel_sim *sim, const pel_record *positions, const pel_record *before, const pel_record *velocity,
                     pel_span span);

/* Work of the loads [J] over a step to position_next, from one time to another: mean force times displacement. `h` [s]
   is the length of substeps whose new velocities move the positions, else 0. */
double pel_loads_work(const pel_sim *sim, double from, double to, double h);

/* Brings the loads on a body after the last event. */
void pel_loads_update(pel_sim *sim, int32_t body);
/* The same for all places, after a snapshot was loaded. */
void pel_loads_rebuild(pel_sim *sim, int32_t body);

/* Takes force and times of a def that differs in no other member, if they are right. PEL_BAD_ARGUMENT. */
pel_status pel_load_retime(pel_sim *sim, int32_t load, const pel_load_def *def, pel_error *error);

/* a pel_transfer_part: the force of a load */
void pel_load_transfer(pel_cursor *at, const pel_sim *sim, int32_t load);

#endif

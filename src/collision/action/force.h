/* Forces of contacts in a step: on vertices, between groups, and of each contact. */
#ifndef PEL_ACTION_FORCE_H
#define PEL_ACTION_FORCE_H

#include "math/pose.h"
#include "math/record.h"
#include "math/vec3.h"
#include "pellicle/base.h"

/* What acts at a point of surfaces, a weighted sum of vertices. */
typedef struct pel_contact_action {
    const int32_t *vertices; /* (4) */
    double weights[4];       /* 0 where unused */
    double force[3];         /* N, on the sum: each vertex has it times its weight */
    double load[3];          /* N, the part of it along the normal */
    int32_t obstacle;        /* that it comes from; -1 = of surfaces of bodies */
} pel_contact_action;

/* What a body or obstacle did to a body in a step. Sums over contacts; those with a load are weighted by it. */
typedef struct pel_pair_force {
    double force[3];  /* N */
    double load[3];   /* N, the part along the normals of contacts */
    double point[3];  /* N m, sum of load times place */
    double approach;  /* N m, sum of load times way along the normal from the start of the step to the contact */
    double load_size; /* N, sum of the sizes of loads */
} pel_pair_force;

/* What acts between two features in a step (record.c). */
typedef struct pel_contact_entry {
    int32_t vertices[4]; /* places in the model's order; -1 = unused */
    int32_t obstacle;
    double weights[4]; /* times size, summed */
    double size;       /* N, sum of the sizes of forces */
    double force[3], load[3];
} pel_contact_entry;

typedef struct pel_contact_table {
    pel_contact_entry *entries; /* (count) */
    size_t count, capacity;
    int32_t *slots; /* (slot_count) 1 + number of an entry, 0 = free */
    size_t slot_count;
    bool is_short; /* there was no memory for an entry */
} pel_contact_table;

/* of the last step, and of the present one */
typedef struct pel_contact_records {
    pel_contact_table last, next;
} pel_contact_records;

/* vertices of a page of forces: whole slices */
enum { PEL_FORCE_PAGE = 32 };

/* Forces by vertex, in pages that are there where one has acted: most vertices never touch anything. With obstacles all
   are there from the start: they press anywhere, in steps that allocate nothing. */
typedef struct pel_force_pages {
    pel_record **pages;  /* (pages) null = zeros */
    uint8_t *is_touched; /* (pages) 0 = all of its forces are zero */
} pel_force_pages;

/* Forces of contacts and obstacles in a step, means where it has substeps. */
typedef struct pel_contact_forces {
    bool is_kept;                                  /* false = nothing is */
    int32_t vertex_count, body_count, group_count; /* groups are bodies, then obstacles */
    const int32_t *body_of_slice;                  /* (vertex_count / PEL_WIDTH), the caller's */
    pel_force_pages vertex, vertex_next;           /* N, in the last step and in the present one */
    bool is_short;                    /* there was no memory for a page: a force is missing; the caller resets it */
    pel_pair_force *pair, *pair_next; /* (body_count x group_count) on the body of the row; of two bodies the lower
                                         one has the row */
    pel_contact_records *records;     /* null = they are not kept */
} pel_contact_forces;

/* The motion in which an action is: positions at the start and the end of the step, and poses of its obstacle. */
typedef struct pel_contact_way {
    const pel_record *position, *next; /* (vertices) */
    const pel_pose *before, *pose;     /* null without an obstacle */
} pel_contact_way;

/* ---- force.c ---- */
/* body_of_slice has to live on. PEL_OUT_OF_MEMORY; free with pel_contact_forces_destroy, also what failed. */
pel_status pel_contact_forces_create(int32_t vertex_count, int32_t body_count, int32_t obstacle_count,
                                     const int32_t *body_of_slice, pel_contact_forces *forces, pel_error *error);
void pel_contact_forces_destroy(pel_contact_forces *forces);
/* Those below do nothing where no forces are kept, but for pel_contact_forces_add and _add_at, which need them. */
/* Before a step or a part of it, or before its substeps are done anew. */
void pel_contact_forces_begin(pel_contact_forces *forces);
/* The forces of the step become the present ones; those of a part, which is a share of the step, are added to the mean:
   the first one forgets the step before. */
void pel_contact_forces_accept(pel_contact_forces *forces, double share, bool is_first);
/* The force on a vertex; zero where none are kept. */
static inline void pel_contact_force_at(const pel_force_pages *forces, int32_t v, double force[3])
{
    const pel_record *page = forces->pages != NULL ? forces->pages[v / PEL_FORCE_PAGE] : NULL;
    if (page != NULL)
        pel_vertex_position(page, v % PEL_FORCE_PAGE, force);
    else
        pel_vec3_set(force, 0, 0, 0);
}
/* Adds to the force on a vertex. */
void pel_contact_force_add(pel_contact_forces *forces, pel_force_pages *to, int32_t v, const double force[3]);
/* The forces of the last step as they are stored elsewhere: begin .. begin + count of the vertices, of one page. */
void pel_contact_forces_read(const pel_contact_forces *forces, int32_t begin, int32_t count, pel_record *page);
void pel_contact_forces_write(pel_contact_forces *forces, int32_t begin, int32_t count, const pel_record *page);
/* Adds an action to the forces of the step. */
void pel_contact_forces_add(pel_contact_forces *forces, const pel_contact_way *given, const pel_contact_action *action);
/* The force of an obstacle on one vertex, without a load. */
void pel_contact_forces_add_at(pel_contact_forces *forces, int32_t v, int32_t obstacle, const double force[3]);

/* ---- record.c ---- */
/* PEL_OUT_OF_MEMORY. */
pel_status pel_contact_records_create(pel_contact_forces *forces, pel_error *error);
void pel_contact_records_destroy(pel_contact_forces *forces);
/* These do nothing where no records are kept. */
void pel_contact_records_begin(pel_contact_forces *forces);
void pel_contact_records_add(pel_contact_forces *forces, const pel_contact_action *action);
void pel_contact_records_accept(pel_contact_forces *forces, double share, bool is_first);
void pel_contact_records_forget(pel_contact_forces *forces);

#endif

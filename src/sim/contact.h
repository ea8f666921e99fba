/* Inside of contact: all surfaces of a simulation as one, the records of contacts, and the guard of a step's end.

   The points of that surface are the places of the model's vertices, then the vertices of the tools that are boxes or
   meshes. Spheres and capsules are points and segments with a radius and stand apart (contact_round.c).

   A step from the positions x0 (free of intersections) to x1 goes so:
     find     pairs that come within the thickness on the way from x0 to x1 become contacts (contact.c)
     correct  sweeps of Gauss-Seidel over them move x1, tools press, until no pair is too near, or some rounds are over
     guard    what is too near still is stepped back until the whole way from x0 to x1 is free (contact_guard.c) */
#ifndef PEL_SIM_CONTACT_H
#define PEL_SIM_CONTACT_H

#include "collide/collider.h"
#include "model/contact.h"
#include "sim/sim.h"

/* in mean edges: what goes farther in a step is not corrected after the solver, but stopped */
#define PEL_CONTACT_FAR 2.0

/* which pair a contact is of, in the order of the list; the tool that it is with, -1 = none */
typedef struct pel_contact_key {
    bool edge_edge;
    int32_t first, second;
    int32_t tool;
    bool is_impact; /* its place is that of a conflict in this step, which says more than where the step began */
    int32_t points[4];
    double place[4]; /* weights where it was found */
    /* in substeps and minimisations (contact_refresh.c) */
    bool is_off;          /* does not act at present */
    bool has_side;        /* the normal tells the side on which the pair touches */
    bool has_pushed;      /* in any substep of this step */
    double depth;         /* m, how much nearer than the thickness the pair was at the start of the step */
    double gap;           /* m, between the features, when it was looked at last */
    double load, drag[3]; /* N, of the method descent: along the normal and across it */
} pel_contact_key;

/* What comes too near on the way of a step. */
typedef struct pel_conflict {
    int32_t places[4]; /* in the model's order, -1 = none */
    int32_t tool;      /* -1 = none */
    double time;       /* of impact, as part of the way */
} pel_conflict;

/* where a pair that was found is a conflict */
typedef struct pel_timed_hit {
    pel_ccd_hit hit; /* time of impact above 1 = it is none */
    bool is_solved;  /* by a cubic */
} pel_timed_hit;

/* What moves together in the guard: a vertex or tool at first. Numbers of a zone stand at its root, but for those of a
   node. */
typedef struct pel_zone {
    int32_t parent;     /* of a forest; itself = root */
    bool is_joined;     /* more than one */
    bool is_held;       /* has met a tool, or has what cannot move: no common motion */
    double mass;        /* kg */
    double momentum[3]; /* kg m: sum of mass times way */
    /* of a node */
    int32_t leader;  /* the tool that holds it, or itself: whose share counts */
    bool is_stopped; /* it stays */
    double share;    /* of its way against that of the zone */
    double impact;   /* earliest in this round, 1 = none */
} pel_zone;

/* tools as a part of the surface */
typedef struct pel_contact_tool {
    int32_t point_begin, point_end; /* none for spheres and capsules */
    const double (*local)[3];       /* (points) in the tool's frame */
    double corners[8][3];           /* of a box */
} pel_contact_tool;

/* Pairs of triangles that intersect from the start on and are left alone (contact_tangle.c). */
typedef struct pel_tangles {
    bool is_known; /* false = to be found anew, before the next step */
    int64_t count;
    pel_pair *pairs; /* (count) triangles of the surface */
    size_t capacity;
    uint64_t *keys; /* (9 count) sorted: pairs of their corners */
    size_t key_capacity;
} pel_tangles;

/* triangles that may collapse in this step (contact_height.c) */
typedef struct pel_contact_heights {
    pel_contact_list list;
    int32_t *triangles; /* (list.count) of the surface */
    size_t capacity, triangle_capacity;
} pel_contact_heights;

struct pel_sim_contacts {
    pel_contact_def def;
    double thickness;           /* m, of bodies and tools that have none of their own */
    double least, largest;      /* m, of all of them */
    double *thickness_of_group; /* (bodies, then tools) */
    double guarded;             /* m, distance that the guard keeps */
    double mean_edge;           /* m, of the bodies at rest */
    double near;                /* m, what starts within it needs no time of impact (pel_ccd_batch) */

    /* the surface */
    pel_collider *collider;
    bool is_loaded; /* the collider's memory and revisions are of a snapshot, its surface is not yet */
    int32_t place_count, point_count, triangle_count;
    int32_t (*triangles)[3]; /* (triangle_count) those of tools first */
    int32_t triangle_limit;
    int32_t *group_of_point; /* (point_count) its body, or body_count and its tool */
    uint8_t *may_meet;
    double *friction_of_group;                     /* (bodies, then tools) */
    int64_t *revisions;                            /* (body_count) of the surface in the collider */
    pel_contact_tool *tools;                       /* (tool_count) */
    double (*start)[3], (*end)[3];                 /* (point_count) */
    double (*substep_start)[3], (*substep_end)[3]; /* (points of tools) */
    uint32_t substep;                              /* number of the substep, of all steps */
    bool way_is_searched;                          /* `on_way` and the conflicts are those of the present start and end:
                                                      every writer of these but pel_contact_points clears it */
    pel_collision_result on_way;                   /* the collider's */
    bool minds_sides;                              /* impacts whose normal leans over a triangle are left to that */

    /* contacts, sorted by their keys; the second ones are scratch of merging */
    pel_contact_list list;
    pel_contact_key *keys, *other_keys;
    pel_contact *other_contacts;
    size_t capacity, other_capacity, key_capacity, other_key_capacity;
    int32_t limit;
    pel_contact_heights heights;

    double solved_energy; /* J, of the new positions and velocities before anything was corrected */

    /* the guard */
    pel_conflict *conflicts; /* of the last look */
    size_t conflict_count, conflict_capacity;
    pel_timed_hit *impacts; /* (collisions of the last look) */
    size_t impact_capacity;
    double (*solved)[3];                /* (place_count) end positions before anything was stepped back */
    pel_zone *zones;                    /* (place_count + tool_count) */
    int32_t *rings;                     /* (same) scratch */
    double *body_shares, *body_impacts; /* (body_count) of the way of all of a body */
    pel_pose *wanted;                   /* (tool_count) poses before they were held back */
    void *before_event;                 /* (event_size) snapshot, of models that refine; else null */
    size_t event_size;
    pel_tangles tangles;
    pel_contact_statistics statistics;
};

/* ---- contact.c ---- */
/* Null contacts when they are not enabled. Errors as for pel_sim_create. */
pel_status pel_contacts_create(pel_sim *sim, const pel_contact_def *def, pel_error *error);
void pel_contacts_destroy(pel_sim *sim);
/* Before the solver of a method with contacts in its loop: what may touch in this step; what is as near as `least` [m]
   in any case, but for tools. */
pel_status pel_contacts_find(pel_sim *sim, double least, pel_error *error);
/* While a minimisation goes on: adds what comes too near on the way to the new positions, and finds the conflicts. */
pel_status pel_contacts_find_on_way(pel_sim *sim, pel_error *error);
/* Before the substeps of a step are done anew: the pairs stay, nothing of what they did. */
void pel_contacts_forget_step(pel_sim *sim);
/* After the solver: tools, contacts and guard bring position_next, velocity_next and the tools to the end of the
   step. longest: spring length bound. On failure the state and the poses of the tools are those before the step. */
pel_status pel_contacts_apply(pel_sim *sim, double time, double longest, pel_error *error);
/* Sets the contact flag of the vertices that were pushed. */
void pel_contacts_mark(const pel_sim *sim);
/* Before the step: brings the surface after refinement, and what is known of tangled pairs after a snapshot. */
pel_status pel_contacts_begin_step(pel_sim *sim, pel_error *error);

/* ---- contact_refresh.c ---- */
/* At the start of a substep, after pel_tools_place. */
void pel_contacts_place_tools(pel_sim *sim);
/* Contacts at position_next and the present poses; impulses of the substep are kept. start (vertex_count): positions at
   the start of the substep. reach: pairs that were farther apart than this at the last refresh, or off, stay as they
   were [m]; HUGE_VAL = all are looked at. */
void pel_contacts_refresh(pel_sim *sim, const pel_record *start, double reach);
/* For methods that keep the place of each pair during a step: off are those whose normal leans over a triangle at its
   start. */
void pel_contacts_look_at_start(pel_sim *sim);
/* After the sweeps of a substep: its impulses are forces of the step. rate: see pel_contact_take. */
void pel_contacts_tally(pel_sim *sim, double rate);

/* ---- contact_height.c ---- */
/* At the start of a step: triangles that are nearly collapsed. PEL_OUT_OF_MEMORY. */
pel_status pel_contact_heights_find(pel_sim *sim, pel_error *error);
/* contacts at position_next */
void pel_contact_heights_refresh(pel_sim *sim);

/* ---- contact_surface.c ---- */
pel_status pel_contact_surface_create(pel_sim *sim, pel_error *error);
bool pel_contact_surface_is_present(const pel_sim *sim);
/* after refinement */
pel_status pel_contact_surface_update(pel_sim *sim, pel_error *error);
/* start from the present positions and poses before the step, end from the next positions and present poses; if they
   differ from those of the last search it no longer holds */
void pel_contact_points(pel_sim *sim);
/* start alone, from the present positions and poses */
void pel_contact_present_points(pel_sim *sim);
/* the points of one tool at a pose, into points (point_count) */
void pel_contact_tool_points(const pel_contact_tool *tool, const pel_pose *pose, double (*points)[3]);
/* the tool of a point, -1 = a vertex of a body */
int32_t pel_contact_tool_of(const pel_sim *sim, int32_t point);
/* the triangles at the present positions, as a mesh that nothing is to be freed of */
pel_mesh pel_contact_mesh(const pel_sim *sim);

/* Adds what a search went through to the statistics. */
void pel_contact_count_search(pel_sim_contacts *contacts, const pel_collision_result *found);
/* Coulomb's coefficient between two groups: bodies, then tools */
double pel_contact_friction(const pel_sim_contacts *contacts, int32_t a, int32_t b);

/* m, distance that two groups keep: half the thickness of either */
double pel_contact_thickness(const pel_sim_contacts *contacts, int32_t a, int32_t b);

/* ---- contact_round.c ---- */
/* Adds a conflict for each triangle that comes too near to a sphere or capsule between start and end. */
pel_status pel_contact_round_conflicts(pel_sim *sim, pel_error *error);

/* ---- contact_guard.c ---- */
/* of the two parts of a pair at `start` */
double pel_contact_start_distance(const pel_sim_contacts *contacts, const pel_collision *hit);
/* Fills `conflicts` from what the collider found between start and end, and from the round tools. */
pel_status pel_contact_find_conflicts(pel_sim *sim, const pel_collision_result *found, pel_error *error);
pel_status pel_contact_add_conflict(pel_sim_contacts *contacts, const pel_conflict *conflict, pel_error *error);
/* The same with a search of its own, by the conservative test, for what comes nearer than the guarded distance. */
pel_status pel_contact_look(pel_sim *sim, pel_error *error);
/* Steps back until the way from start to end is free; position_next, velocity_next and the tools follow. */
pel_status pel_contact_guard(pel_sim *sim, pel_error *error);

/* ---- contact_tangle.c ---- */
/* Finds what intersects at `start`. */
pel_status pel_tangles_find(pel_sim *sim, pel_error *error);
/* true when the points are of a pair that is left alone: vertex and triangle, or two edges */
bool pel_tangles_have(const pel_sim_contacts *contacts, const pel_collision *collision);
pel_status pel_tangles_refuse(const pel_sim *sim, pel_error *error);

#endif

/* Pellicle: readings of contact. */
#ifndef PELLICLE_SIM_CONTACT_H
#define PELLICLE_SIM_CONTACT_H

#include "sim_step.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Forces of contacts on each vertex (vertex_count x 3) [N], of other bodies, of the body itself and of tools, grasps
   included; a mean over the last step for methods with velocities, else at its end. The forces of a body on itself sum
   to zero, the forces of a tool on all bodies to minus the force on it, also at pinned vertices. Zeros without contact
   and tools. */
PEL_API void pel_sim_get_contact_forces(const pel_sim *sim, int32_t body, double *forces);
/* Sum of the forces of other bodies on a body in the last step [N], tools excluded. */
PEL_API void pel_sim_get_body_contact(const pel_sim *sim, int32_t body, double force[3]);

/* One contact of the last step, between two features of surfaces or a feature and a tool. A feature is a vertex or a
   point of an edge or triangle, given by its corners and their weights.

   The force on corner i is weights[i] times the force; over all records of a body these sum to
   pel_sim_get_contact_forces, over those of a tool to minus the force on it (pel_tool_reading). Forces are means over
   the step as there, and weights are means over its substeps: on a vertex the sums differ if contacts slide during the
   step. */
typedef struct pel_contact_record {
    int32_t bodies[2];   /* of the first and the second side; second side -1 = the tool */
    int32_t tool;        /* -1 = both sides belong to bodies */
    int32_t vertices[4]; /* rows of the body's arrays; -1 = unused */
    double weights[4]; /* above 0 on the first side, where they sum to 1, below 0 on the second, where they sum to -1 */
    double point[3];   /* m, of the first side, at present */
    double normal[3];  /* unit, from the second side to the first; for held vertices, out of the tool */
    double force[3];   /* N, on the first side */
    double gap;        /* m, between both sides along the normal, at present; below 0 = inside of the tool */
} pel_contact_record;

/* Number of contacts with a force in the last step, in the order in which they first acted. Zero without
   record_contacts, before the first step and after loading a snapshot. Excludes impulses of restitution between whole
   bodies. */
PEL_API int64_t pel_sim_contact_record_count(const pel_sim *sim);
/* Reads the contacts (pel_sim_contact_record_count). Gaps to mesh tools test all of their triangles. PEL_OUT_OF_MEMORY
   if memory for a record was missing in the last step. */
PEL_API pel_status pel_sim_get_contact_records(const pel_sim *sim, pel_contact_record *records, pel_error *error);

/* 1 if a tool touches or holds the vertex or it is in contact with a surface, else 0 (vertex_count). */
PEL_API void pel_sim_get_contacts(const pel_sim *sim, int32_t body, double *contact);

/* Statistics of contact, summed over all steps since the start. All zero without contact. */
typedef struct pel_contact_statistics {
    int64_t candidates;                                /* pairs with overlapping boxes, of all searches */
    int64_t passed_filter;                             /* not excluded by the non-penetration filter */
    int64_t passed_hull;                               /* nor by separating axes */
    int64_t cubics;                                    /* solved for a time of impact */
    int64_t contacts;                                  /* records of contacts, all steps */
    int64_t dropped;                                   /* contacts beyond the limit */
    int64_t rounds;                                    /* of search and correction */
    int64_t fall_backs;                                /* vertices stepped back, all steps */
    double stepped_back;                               /* sum over the steps of the vertices stepped back, of a step in
                                                          parts the mean of its parts: at most all vertices in each */
    int64_t tools_held;                                /* tools stopped, all steps */
    int64_t steps_divided;                             /* steps that were done in parts */
    double sleeping;                                   /* sum over the steps of the share of vertices that slept */
    int64_t tangled;                                   /* pairs of triangles that intersect at present */
    double find_seconds, solve_seconds, guard_seconds; /* searching, correcting, guarding the end of the step */
} pel_contact_statistics;
PEL_API void pel_sim_get_contact_statistics(const pel_sim *sim, pel_contact_statistics *statistics);

/* m, default thickness of bodies and tools; 0 without contact */
PEL_API double pel_sim_contact_thickness(const pel_sim *sim);

/* The contact thickness of a body [m]: its own, that of its membrane (pel_contact_def) or the above; 0
   without contact, or without such a body. */
PEL_API double pel_sim_body_contact_thickness(const pel_sim *sim, int32_t body);

/* Number of intersecting pairs of triangles of the present surfaces and tools, by the exact test
   (pel_mesh_self_intersections); excludes spheres and capsules. PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_sim_intersections(pel_sim *sim, int64_t *count, pel_error *error);

#ifdef __cplusplus
}
#endif
#endif

/* The closed surfaces that the experiments of paper B shrink. */
#ifndef PAPERS_B_BODY_H
#define PAPERS_B_BODY_H

#include <pellicle/run.h>
#include <pellicle/topology.h>

enum { B_BODIES = 8, B_SOURCE_SIZE = PEL_RUN_PATH_SIZE };

typedef struct b_body {
    char name[40];
    char mesh[B_SOURCE_SIZE + 160];   /* the setting of bodies.0.mesh: about 2 m long, z up */
    double pressure;                  /* outside, in proportion to the length of the edges [Pa] */
    char *cap;                        /* the setting of the region of fibres: the part of the surface about its roundest
                                         vertex */
    double cap_center[3], cap_radius; /* that vertex, and the ball that the part lies in */
} b_body;

/* The mesh file that is given, whose axis `up` ('x', 'y' or 'z') points up; the scans in the folder that is given; or
   blends: bodies (B_BODIES). */
pel_status b_find_bodies(const char *mesh, char up, const char *data, b_body *bodies, int *count, pel_error *error);
/* Frees what b_find_bodies left in bodies (B_BODIES), also when it failed; zeroed ones are fine. */
void b_free_bodies(b_body *bodies);

/* Marks the cap of a body at rest: vertices that edges within the ball connect with the vertex nearest to its centre.
   marked: (vertex_count). */
pel_status b_mark_cap(const b_body *body, const pel_topology *topology, const double (*rest)[3], bool *marked,
                      pel_error *error);

#endif

/* The closed surfaces that the experiments deform: organs, heads and animals. */
#ifndef PAPERS_LAB_BODY_H
#define PAPERS_LAB_BODY_H

#include <pellicle/run.h>
#include <pellicle/topology.h>

enum { LAB_BODIES = 8, LAB_SOURCE_SIZE = PEL_RUN_PATH_SIZE };

typedef struct lab_body {
    char name[40];
    char mesh[LAB_SOURCE_SIZE + 160]; /* the setting of bodies.0.mesh: about 2 m long, z up */
    double pressure;                  /* outside, in proportion to the length of the edges [Pa] */
    char *cap;                        /* the setting of the region of fibres: the part of the surface about its roundest
                                         vertex */
    double cap_center[3], cap_radius; /* that vertex, and the ball that the part lies in */
    double cap_normal[3];             /* outward unit normal there */
} lab_body;

/* The mesh file that is given, whose axis `up` ('x', 'y' or 'z') points up; the scans in the folder that is given; or
   blends, written into a folder that exists: bodies (LAB_BODIES). */
pel_status lab_find_bodies(const char *folder, const char *mesh, char up, const char *data, lab_body *bodies,
                           int *count, pel_error *error);
/* Frees what lab_find_bodies left in bodies (LAB_BODIES), also when it failed; zeroed ones are fine. */
void lab_free_bodies(lab_body *bodies);

/* Marks the cap of a body at rest: vertices that edges within the ball connect with the vertex nearest to its centre.
   marked: (vertex_count). */
pel_status lab_mark_cap(const lab_body *body, const pel_topology *topology, const double (*rest)[3], bool *marked,
                        pel_error *error);

#endif

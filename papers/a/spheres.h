/* Table 1 of paper A: 500 steps of the sphere on its base mesh, refined everywhere and refined locally. The four
   alternate every few steps, processor time is counted, and each turn is compared with that of the base just before,
   so that other load on the machine affects both equally. All repeats compute the same: their median counts. */
#ifndef PAPERS_A_SPHERES_H
#define PAPERS_A_SPHERES_H

#include <pellicle/base.h>

enum { A_BASE, A_LOCAL, A_DYNAMIC, A_EVERYWHERE, A_SPHERES };

/* most runs of one a_spheres */
enum { A_REPEATS = 1000 };

/* of 500 steps in the paper (Pentium 4, 2006) */
extern const double a_paper_seconds[A_SPHERES];

typedef struct a_spheres a_spheres;

typedef struct a_times {
    int32_t triangles[A_SPHERES];
    double seconds[A_SPHERES], over_base[A_SPHERES]; /* of 500 steps */
    double refine, coarsen;                          /* s, an event of the local sphere and back */
} a_times;

/* a_spheres_destroy also frees what a failed creation left */
pel_status a_spheres_create(a_spheres **spheres, pel_error *error);
void a_spheres_destroy(a_spheres *spheres);

/* back to where a run starts; not timed */
pel_status a_spheres_rewind(a_spheres *spheres, pel_error *error);
/* 500 steps of each */
pel_status a_spheres_run(a_spheres *spheres, pel_error *error);
/* of all runs so far */
pel_status a_spheres_measure(a_spheres *spheres, a_times *times, pel_error *error);

#endif

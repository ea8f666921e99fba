/* Pellicle: contact of surfaces. */
#ifndef PELLICLE_CONTACT_H
#define PELLICLE_CONTACT_H

#include "kinds.h"

#ifdef __cplusplus
extern "C" {
#endif

/* When contacts are solved. */
typedef enum pel_contact_response {
    PEL_CONTACT_IN_LOOP, /* in every sweep of pbd and xpbd, in the minimisation of descent, and after the step until all
                            distances hold */
    PEL_CONTACT_AFTER    /* paper B: one correction after the step */
} pel_contact_response;

/* Contact of surfaces (paper B, section 4). If enabled, a step that starts without intersecting triangles (within a
   body, of two bodies, or of a body and a tool) ends without: the guard steps remaining violations back along their
   displacement, in the worst case to the start of the step. A tool stops while a body is trapped, and catches up
   afterwards. */
typedef struct pel_contact_def {
    bool enabled;
    bool self;                 /* contact within a body */
    bool between;              /* contact between bodies */
    double thickness;          /* m, default of bodies and tools; a pair keeps half of each thickness as distance;
                                  0 = shell_thickness, else relative_thickness */
    bool shell_thickness;      /* a body has the mean thickness of its membrane, without one an open surface that of its
                                  mass; others and tools have relative_thickness */
    double relative_thickness; /* times the diagonal of all bodies, at most half the shortest edge; 0 = 1e-4, but
                                  open surfaces have the limited thickness of their membrane (docs/collision.md) */
    double friction; /* Coulomb's coefficient, default of bodies and tools; a pair has the geometric mean of both (the
                        mixing rule of Box2D: a frictionless partner makes the pair frictionless) */
    double restitution; /* 0 .. 1, default of bodies and tools; a pair has the larger one. The rigid motions of a pair
                           separate with this share of their normal approach velocity if that is at least 2 g dt; an
                           impulse adds no more energy than the run has dissipated. Below 0 (default): vertices stop at
                           each other, and elasticity decides the rebound. Methods with velocities only */
    pel_ccd_method method; /* detection of contacts; the guard at the end of a step is always conservative */
    pel_contact_response response;
    bool sleep;         /* bodies that rest in contact are left out of steps until something changes (pbd, xpbd) */
    bool allow_tangled; /* accept a start with intersections: ignore these pairs until they separate */
    int32_t sweeps; /* maximum number of sweeps over the contacts after a step, six times as many with rigid bodies; 0 =
                       10 */
    int32_t limit;  /* maximum number of contacts; 0 = 64 per vertex. The guard handles the excess */
    int64_t memory_limit; /* bytes for the candidate pairs of a step; 0 = the larger of 1 GiB and 4 KiB per triangle. A
                             step that needs more fails with PEL_BAD_ARGUMENT; use a shorter step */
} pel_contact_def;

#ifdef __cplusplus
}
#endif
#endif

/* Pellicle: sums over all bodies of a simulation, and its energy balance. */
#ifndef PELLICLE_SIM_LEDGER_H
#define PELLICLE_SIM_LEDGER_H

#include "sim_step.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Sums over all bodies; the first columns of series.csv. */
typedef struct pel_sim_measures {
    double volume;             /* m3, enclosed by closed bodies */
    double volume_ratio;       /* the same relative to rest; NaN if each body is open, or flat at rest */
    double least_volume_ratio; /* smallest volume ratio of a body; at most 0 if it is inside out; NaN as above */
    double area_ratio;         /* area relative to rest */
    double kinetic_energy;     /* J, at the time of the positions (velocities of leapfrog are half a step earlier) */
    double elastic_energy;     /* J, the sum of the five below, and that of tetrahedra */
    double spring_energy;      /* J */
    double volumetric_energy;  /* J */
    double membrane_energy, bending_energy, fibre_energy; /* J, of shells */
    double max_displacement;                              /* m, from the rest position */
    double max_force;                                     /* N, largest vertex force as in pel_sim_get_forces */
    double unbalanced_force; /* N, sum of the magnitudes of these forces on free vertices: neither pinned, held nor
                                touched */
    int64_t vertex_count, triangle_count, contact_count;
} pel_sim_measures;
PEL_API void pel_sim_measure(pel_sim *sim, pel_sim_measures *measures);
/* Only volume_ratio, without the cost of forces; NaN if no body has a volume. */
PEL_API double pel_sim_volume_ratio(const pel_sim *sim);

/* Energy balance since the start, in J: supplied, stored and dissipated energy, and the remainder.

     energy_error - dissipated_solver = change + dissipated_drag + ... + dissipated_plastic - work
     change = elastic + kinetic - elastic_start - kinetic_start
     work = work_tools + work_loads + ... + work_setters

   A negative remainder is dissipation by friction, contact, and the numerical damping of implicit, quasi-static and
   position-based methods. A positive one is energy that appeared: the step is too long, the method does not follow the
   material, or contact and tools add energy. docs/results.md has the rule of each work. */
typedef struct pel_sim_ledger {
    double work_tools;     /* by tools, grasps and supports on bodies: from their readings and motions */
    double work_estimated; /* of work_tools: the sum of the sizes of what closed the balance of steps in which the force
                              of a tool was not known. Energy that contact makes there is part of it */
    double work_loads;     /* mean force times displacement */
    double work_pressure;  /* of prescribed pressure, enclosed gas or target volume */
    double work_gravity;
    double work_material; /* of time-dependent parameters: keyed stiffness of springs, active fibres */
    double work_setters; /* change of energy by pel_sim_set_positions and pel_sim_set_velocities after the first step */
    double elastic, kinetic;             /* at present; kinetic is 0 for methods without velocities */
    double elastic_start, kinetic_start; /* before the first step */
    double dissipated_drag;              /* by drag of the solver and damping of vertices */
    double dissipated_fracture; /* taken by tears: toughness x thickness x length; by seams: half their force times
                                   their opening; released by cuts: the bending across them */
    double dissipated_remesh;   /* of tears: the bending across them, and what vertices that move over the surface lose;
                                   under `static` also what refinement changes; below 0 if they gain */
    double dissipated_plastic;  /* by folds that yield: their moments times plastic angles */
    double dissipated_solver;   /* magnitude of a negative remainder */
    double energy_error;        /* a positive remainder */
    double supplied;            /* largest sum, over the steps, of the start energies and the magnitudes of all works */
    double tolerance;           /* raise an alarm if energy_error exceeds it: 5 % of supplied, plus rounding */
} pel_sim_ledger;
/* Works are summed in each step; the energies are evaluated here. */
PEL_API void pel_sim_get_ledger(pel_sim *sim, pel_sim_ledger *ledger);

#ifdef __cplusplus
}
#endif
#endif

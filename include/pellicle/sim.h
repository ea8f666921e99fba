/* Pellicle: the simulation. One pel_sim steps one state of one model under loads and tools.

       pel_sim_def def = pel_sim_def_default();
       def.model = model;
       pel_sim_create(&def, &sim, &error);
       while (pel_sim_time(sim) < 5.0)
           if (pel_sim_step(sim, &error) != PEL_OK) ...

   One thread at a time may use a pel_sim (inside a step, it uses threads of its own); different sims are independent.
   Vertex numbers and arrays are in the order of the body's mesh. A refined body has more vertices than its mesh: the
   rows of arrays are first the vertices of the mesh, then the active vertices of finer levels, coarser levels first.

   This header includes the headers of all topics, and those of the functions on meshes that go with them. */
#ifndef PELLICLE_SIM_H
#define PELLICLE_SIM_H

#include "bending.h"
#include "contact.h" /* contact of surfaces */
#include "geometry.h"
#include "load.h" /* forces on vertices */
#include "material.h"
#include "measure.h"
#include "model.h"       /* bodies */
#include "sim_adjoint.h" /* derivatives with respect to parameters */
#include "sim_contact.h" /* readings of contact */
#include "sim_forces.h"  /* forces, energies and stresses on vertices and triangles */
#include "sim_ledger.h"  /* sums over all bodies, energy balance */
#include "sim_reading.h" /* readings of tools, supports, the solver, modes and paths */
#include "sim_rigid.h"   /* place and motion of rigid bodies */
#include "sim_step.h"    /* pel_sim_def, creation, steps, state, setters, snapshots */
#include "sim_surface.h" /* the present surface, refinement */
#include "solver.h"      /* the method */
#include "support.h"     /* supports of vertices and edges */
#include "tear.h"        /* cuts */
#include "tool.h"        /* rigid instruments */
#include "wind.h"        /* air */

#endif

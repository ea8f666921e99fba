/* Contact in a simulation: the link between its state, tools and steppers and the set of contacts (contact/set.h). */
#ifndef PEL_SIM_CONTACT_H
#define PEL_SIM_CONTACT_H

#include "contact/set.h"
#include "sim/sim.h"

/* ---- contact.c ---- */
/* Null contacts when they are not enabled. Errors as for pel_sim_create. */
pel_status pel_contacts_create(pel_sim *sim, const pel_contact_def *def, pel_error *error);
void pel_contacts_destroy(pel_sim *sim);
/* Points at both ends of the step: present and next positions, poses before the step and present ones. */
void pel_contacts_place(pel_sim *sim);
/* Points at the start alone: present positions and poses. */
void pel_contacts_place_start(pel_sim *sim);
/* After refinement or a snapshot: the set takes the present surface, with the points at the start. */
pel_status pel_contacts_update_surface(pel_sim *sim, pel_error *error);
/* Before the solver of a method with contacts in its loop: finds pairs that may touch in this step, and all pairs
   nearer than `least` [m], except with tools. */
pel_status pel_contacts_find(pel_sim *sim, double least, pel_error *error);
/* During a minimisation: adds pairs too close on the way to the new positions, and finds the conflicts. */
pel_status pel_contacts_find_on_way(pel_sim *sim, pel_error *error);
/* At the start of a substep, after pel_tools_place. */
void pel_contacts_begin_substep(pel_sim *sim);
/* After the sweeps of a substep: its impulses are forces of the step. rate: see pel_contact_take. */
void pel_contacts_tally(pel_sim *sim, double rate);
/* After the solver: tools, contacts and guard bring position_next, velocity_next and the tools to the end of the
   step. On failure the state and the poses of the tools are those before the step. */
pel_status pel_contacts_apply(pel_sim *sim, double time, const pel_step_result *result, pel_error *error);
/* Before the step: updates the surface after refinement, and the tangled pairs after a snapshot. */
pel_status pel_contacts_begin_step(pel_sim *sim, pel_error *error);

/* ---- contact_tangle.c ---- */
/* Refuses intersections found at the start, and tools inside of bodies. PEL_BAD_ARGUMENT. */
pel_status pel_contacts_refuse_tangles(const pel_sim *sim, pel_error *error);

#endif

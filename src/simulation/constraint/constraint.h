/* Constraints of a minimisation: energy, forces, stiffness and multipliers; both fields are (3 vertex_count). */
#ifndef PEL_CONSTRAINT_CONSTRAINT_H
#define PEL_CONSTRAINT_CONSTRAINT_H

#include "constraint/frame.h"

/* the weighted sum of its points: their position, or against a surface the vector between both sides */
void pel_minimise_contact_point(const pel_minimise_contact *constraint, const double *position, double point[3]);
void pel_minimise_contact_meet(const pel_sim *sim, const pel_minimise_contact *constraint, const double *position,
                               pel_gap_sample *meeting);
/* Where surfaces press from all sides, some gaps do not close under any load: under constraints this stiff, relative to
   the bound of bodies and inertia, the layers of pairs give way by their loads, and gaps have more tolerance. */
#define PEL_JAM_PENALTY 6
/* One more constraint; false when nothing at it can move. PEL_OUT_OF_MEMORY. */
pel_status pel_minimise_contact_add(pel_sim *sim, const pel_minimise_contact *constraint, pel_error *error);
/* After loads have changed: the tangents of the layers under them. */
void pel_minimise_contacts_press(pel_sim *sim);
/* Whether a layer gives way by more than the tolerance of its gap. */
bool pel_minimise_contacts_jam(const pel_sim *sim);
/* Adds energy [J] and forces at positions. */
double pel_minimise_contacts_evaluate(pel_sim *sim, const double *position, double *force);
/* Second derivatives of a constraint's part. False where it does not act. */
bool pel_minimise_contact_stiffness(const pel_sim *sim, const pel_minimise_contact *constraint, const double *position,
                                    pel_contact_stiffness *stiffness);
/* Constraints as kinks (count) at positions; until pel_minimise_contacts_evaluate stiffnesses are of those that act. */
void pel_minimise_contacts_list_kinks(pel_sim *sim, const double *position, pel_newton_kink *kinks);
/* Friction is limited by the loads at positions from here on; false where none has changed. */
bool pel_minimise_contacts_grip(pel_sim *sim, const double *position);
/* Loads and drags after a minimisation. */
pel_contact_change pel_minimise_contacts_update(pel_sim *sim);
/* Loads that best balance `force`, the forces of the bodies at the end of the step, which is overwritten. stiffness
   (vertex_count): N/m of the springs of inertia, whose forces are in `force`; null = none. */
void pel_minimise_contacts_estimate(pel_sim *sim, double *force, double reach, const double *stiffness);
/* Keeps loads and drags for the next step, which begins with those of the same pairs. */
void pel_minimise_contacts_keep(pel_sim *sim);
void pel_minimise_contacts_take_kept(pel_sim *sim);
/* N, sums of the loads that were kept for the present constraints, and of their own */
double pel_minimise_contacts_sum_kept(const pel_sim *sim);
double pel_minimise_contacts_sum(const pel_sim *sim);
/* N, root of the sum of squares of the constraint forces on vertices */
double pel_minimise_contacts_force(const pel_sim *sim);
/* m, how near pairs of surfaces are constraints before anything moves. */
double pel_minimise_contacts_near(const pel_sim *sim);
/* Constraints of surfaces from the list of contacts, one where pairs are between the same
   points, after those of tools, with the loads stored by their keys. */
pel_status pel_minimise_contacts_add_surfaces(pel_sim *sim, pel_error *error);
/* Share of the forces of surfaces that has turned since the step found where they touch. */
double pel_minimise_contacts_turned(const pel_sim *sim);
/* Writes these loads into the keys. */
void pel_minimise_contacts_keep_loads(pel_sim *sim);
/* Marks tools whose forces in this part are not known: those whose layers, where they give way, have loads of other
   depths, or are loaded at once; with `all` whoever touches or holds something. */
void pel_minimise_contacts_doubt(pel_sim *sim, bool all);
/* Flags of the vertices of surfaces that press against each other. */
void pel_minimise_contacts_mark(const pel_sim *sim);

#endif

/* Forces and energies of the shells of a model: membrane, bending, fibres, pressure (paper B as energies).

   The blocks of batches add to the forces of their corners, in the order of bundles, which is the same for any number
   of threads, and so are the bits. Nothing is allocated. Loops over blocks (shell_lanes.c) have the precision of the
   state; values at vertices are computed element by element in double. The force of each part is the negative gradient
   of its energy, but for pressure in the vertex-normal form or on a part of the surface, and for PEL_FIBRE_NORMAL,
   whose follower force is a pressure of stiffness / k_A times E_A per area at rest. PEL_FIBRE_CAVE is a rule of
   position-based dynamics, not an energy: it gives no force. */
#ifndef PEL_FORCE_SHELL_FORCE_H
#define PEL_FORCE_SHELL_FORCE_H

#include "base/pool.h"
#include "batch/batches.h"

typedef enum pel_shell_part {
    PEL_SHELL_MEMBRANE = 1,
    PEL_SHELL_BENDING = 2,
    PEL_SHELL_FIBRES = 4,
    PEL_SHELL_CONSERVATIVE = 8, /* pressure on bodies where it has a potential */
    PEL_SHELL_VOLUME = 32,      /* tetrahedra */
    PEL_SHELL_FOLLOWER = 16,    /* pressure on the others, and that of PEL_FIBRE_NORMAL */
    PEL_SHELL_PRESSURE = PEL_SHELL_CONSERVATIVE | PEL_SHELL_FOLLOWER,
    PEL_SHELL_ELASTIC = PEL_SHELL_MEMBRANE | PEL_SHELL_BENDING | PEL_SHELL_FIBRES | PEL_SHELL_VOLUME,
    PEL_SHELL_ALL = PEL_SHELL_ELASTIC | PEL_SHELL_PRESSURE
} pel_shell_part;

/* Sums over all bodies [J]. */
typedef struct pel_shell_energy {
    double membrane, bending, fibres, volume;
    double pressure; /* potential of the conservative parts */
} pel_shell_energy;

/* Laws and scratch for all bodies of a model that are shells; one thread at a time uses it. */
typedef struct pel_shell_forces pel_shell_forces;

/* *forces stays null when the model has no shell. The batches, of any method, outlive it. Refuses (PEL_BAD_ARGUMENT)
   bending without a stiffness. */
pel_status pel_shell_forces_create(pel_batches *batches, pel_shell_forces **forces, pel_error *error);
void pel_shell_forces_destroy(pel_shell_forces *forces);

/* Sets directions that follow the state (PEL_FIBRE_PRINCIPAL) from these positions: once for each state. */
void pel_shell_forces_follow(pel_shell_forces *forces, const pel_record *position);

/* The factor of given pressure from now on; 1 at first. forces may be null. */
void pel_shell_forces_set_load_factor(pel_shell_forces *forces, double factor);

/* Takes what yields from a state, whose arrays outlive `forces` (which may be null). Again after each change of them.
 */
void pel_shell_forces_set_plastic(pel_shell_forces *forces, const pel_plastic *plastic);
/* Lets hinges beyond their yield angle and triangles beyond their yield stress slip: changes `plastic` (that given
   last), rest angles and shapes without stress, and returns the work that they dissipate [J]. */
double pel_shell_forces_slip(pel_shell_forces *forces, const pel_record *position, const pel_plastic *plastic);

/* Adds the forces of some parts (a sum of pel_shell_part) at a time to force (model vertex_count), which may be null;
   returns the energies of these parts. */
pel_shell_energy pel_shell_forces_add(pel_shell_forces *forces, const pel_record *position, pel_span span, int parts,
                                      pel_pool *pool, pel_record *force);

/* Adds the forces of all pressures, those of PEL_FIBRE_NORMAL included, at a time to force (model vertex_count). */
void pel_shell_forces_press(pel_shell_forces *forces, const pel_record *position, pel_span span, pel_pool *pool,
                            pel_record *force);

/* Lists the elements at each vertex of a body, for the function below. PEL_OUT_OF_MEMORY. */
pel_status pel_shell_forces_list(pel_shell_forces *forces, int32_t body, pel_error *error);

/* After the surface of a body that refines has changed: rebuilds that list, without allocation. */
void pel_shell_forces_rebuild(pel_shell_forces *forces, int32_t body);

/* Force of membrane, bending and fibres on one vertex of a body with lists, from the elements at it alone. */
void pel_shell_elastic_force_at(const pel_shell_forces *forces, int32_t body, const pel_record *position, double time,
                                int32_t place, double force[3]);

/* Energies on the vertices of one body by row: a third of each triangle, a quarter of each hinge there. Rows are the
   vertices of the mesh, or given by output_vertex for vertices of the forest. The arrays (vertex_count) are
   overwritten, with zeros for a body that is no shell. */
void pel_shell_vertex_energies(const pel_shell_forces *forces, int32_t body, int32_t vertex_count,
                               const int32_t *output_vertex, const pel_record *position, double time, double *membrane,
                               double *bending, double *fibres);

/* Adds the energy of each tetrahedron, or of each element of smooth ones, to the rows of its vertices in equal shares;
   rows are those of pel_shell_vertex_energies. */
void pel_shell_add_tetra_energies(const pel_shell_forces *forces, int32_t body, const int32_t *output_vertex,
                                  const pel_record *position, double *energies);

/* Adds to each mesh vertex of a body a third of the virial of membrane and fibres of each triangle there: the
   derivative of their energy by the logarithm of the size, twice tension times area. */
void pel_shell_add_virials(const pel_shell_forces *forces, int32_t body, const int32_t *output_vertex,
                           const pel_record *position, double time, double *virials);

/* D of a hinge as the factor of its energy element: D for hinges, D / 3 for the isometric model */
double pel_shell_hinge_factor(const pel_shell *shell, const pel_shell_hinge *hinge);

/* Upper bound of the largest eigenvalue of K / m at rest [1/s2], by rows of norms of the elements. */
double pel_shell_stiffness_bound(const pel_shell_forces *forces);

#endif

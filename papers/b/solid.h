/* Position-based simulation of continuous materials (Bender, Koschier, Charrier, Weber 2014), which paper B compares
   itself with: a solid of tetrahedra whose energies (St. Venant and Kirchhoff) are the constraints. */
#ifndef PAPERS_B_SOLID_H
#define PAPERS_B_SOLID_H

#include <pellicle/mesh.h>

/* A solid that fills a closed surface. */
typedef struct b_solid b_solid;

/* Fills the surface, scaled by `scale`, with the cells of a lattice, each cut into six tetrahedra; the surface is
   carried along by the cells. density in kg/m3. Errors: PEL_OUT_OF_MEMORY. Free with b_solid_destroy. */
pel_status b_solid_create(const pel_mesh *surface, double scale, int cells, double density, b_solid **solid,
                          pel_error *error);
void b_solid_destroy(b_solid *solid);

/* One frame of 1/60 s under an outside pressure: symplectic Euler, then five sweeps over the tetrahedra. */
void b_solid_step(b_solid *solid, double pressure);

/* volume of the surface over that at rest */
double b_solid_volume_ratio(const b_solid *solid);
/* positions of the surface (vertex_count x 3), in its own scale */
void b_solid_surface(const b_solid *solid, double (*positions)[3]);
double b_solid_volume(const b_solid *solid); /* at rest [m3] */

#endif

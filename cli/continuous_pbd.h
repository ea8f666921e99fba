/* Position-based simulation of continuous materials (Bender, Koschier, Charrier, Weber 2014), which paper B compares
   itself with: a solid of tetrahedra whose energies (St. Venant and Kirchhoff) are the constraints. */
#ifndef PELLICLE_CLI_CONTINUOUS_PBD_H
#define PELLICLE_CLI_CONTINUOUS_PBD_H

#include <pellicle/mesh.h>

/* A solid that fills a closed surface. */
typedef struct cli_solid cli_solid;

/* Fills the surface, scaled by `scale`, with the cells of a lattice, each cut into six tetrahedra; the surface is
   carried along by the cells. density in kg/m3. Errors: PEL_OUT_OF_MEMORY. Free with cli_solid_destroy. */
pel_status cli_solid_create(const pel_mesh *surface, double scale, int cells, double density, cli_solid **solid,
                            pel_error *error);
void cli_solid_destroy(cli_solid *solid);

/* One frame of 1/60 s under an outside pressure: symplectic Euler, then five sweeps over the tetrahedra. */
void cli_solid_step(cli_solid *solid, double pressure);

/* volume of the surface over that at rest */
double cli_solid_volume_ratio(const cli_solid *solid);
/* positions of the surface (vertex_count x 3), in its own scale */
void cli_solid_surface(const cli_solid *solid, double (*positions)[3]);
double cli_solid_volume(const cli_solid *solid); /* at rest [m3] */

#endif

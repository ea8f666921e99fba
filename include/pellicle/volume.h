/* Pellicle: tetrahedra that fill a closed surface, the elements of a body with `volume`. */
#ifndef PELLICLE_VOLUME_H
#define PELLICLE_VOLUME_H

#include "mesh.h"
#include "quantity.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Fills a closed surface with tetrahedra by isosurface stuffing (Labelle and Shewchuk, "Isosurface stuffing: fast
   tetrahedral meshes with good dihedral angles", 2007): a body-centred cubic lattice in which the edges along the axes
   are about `edge` [m] long (0: the mean edge of the surface) and divide the box of the surface evenly, cut at the
   surface. All dihedral angles are between 10 and 165 degrees on a cubic lattice. The new surface has vertices of its
   own, all of them on the given one; a box along the axes is kept exactly, other sharp edges are bevelled by up to one
   `edge`. Surfaces that pass through each other are filled where they wind once or more. Fields are not carried over.
   Errors: PEL_BAD_MESH for an open surface (with the triangle at the opening), for parts thinner than the lattice (with
   the triangle and its place); PEL_BAD_ARGUMENT for an edge that is negative, not finite, or asks for more than
   12 million tetrahedra; PEL_OUT_OF_MEMORY. On failure *filled is null. Free with pel_mesh_destroy. */
PEL_API pel_status pel_mesh_fill(const pel_mesh *surface, double edge, pel_mesh **filled, pel_error *error);

/* Copies points (point_count x 3) and tetrahedra (4 x tetrahedron_count) into a filled mesh; points that no tetrahedron
   has are left out, those of the surface come first. Errors: PEL_BAD_MESH with the tetrahedron that has no volume, is
   turned inside out or shares a face with two others, or with a place where the surface is no manifold;
   PEL_BAD_ARGUMENT for numbers that are not finite, vertices out of range, and counts below 1; PEL_OUT_OF_MEMORY. On
   failure *mesh is null. Free with pel_mesh_destroy. */
PEL_API pel_status pel_mesh_create_filled(const double *points, int32_t point_count, const int32_t *tetrahedra,
                                          int32_t tetrahedron_count, pel_mesh **mesh, pel_error *error);

/* Reads a file with tetrahedra, by its extension: .msh (Gmsh 2 and 4.1, text or binary), .vtk (legacy VTK, unstructured
   grid, text), .vtu (VTK XML, any encoding), .node and .ele (TetGen: either name, both files are read). Of tetrahedra
   with ten nodes the corners are used. If all tetrahedra are turned inside out, as some programs list their corners,
   all are turned around. Triangles, lines, groups and data are skipped. log (nullable) receives notes. Errors:
   PEL_BAD_FILE (missing, unreadable), PEL_BAD_FORMAT with the line or byte, and the tetrahedron, for numbers of nodes
   that do not exist, tetrahedra without volume or turned inside out among others, cells of other shapes, and what
   pel_mesh_create_filled refuses; PEL_OUT_OF_MEMORY. Memory use is bounded by a small multiple of the file's size. On
   failure *mesh is null. Free with pel_mesh_destroy. */
PEL_API pel_status pel_mesh_read_filled(const char *path, const pel_log *log, pel_mesh **mesh, pel_error *error);
/* The same of .msh, .vtk or .vtu from memory; `name` is the file's name, for its extension and in messages. */
PEL_API pel_status pel_mesh_parse_filled(const char *name, const void *bytes, size_t size, const pel_log *log,
                                         pel_mesh **mesh, pel_error *error);
/* Whether the extension is that of a file which pel_mesh_read_filled reads. */
PEL_API bool pel_mesh_is_filled_file(const char *path);

/* The laws of filled bodies: enumerator, name in scene files. With the Lame constants mu = E / (2 (1 + nu)) and
   lambda = E nu / ((1 + nu) (1 - 2 nu)), F the deformation gradient, J = det F, I = |F|^2, II = (I^2 - |F^T F|^2) / 2,
   E = (F^T F - 1) / 2, and R the rotation nearest to F, the energies per volume at rest are

       stvk           lambda/2 (tr E)^2 + mu |E|^2
       corotated      mu |F - R|^2 + lambda/2 (J - 1)^2          ("fixed"; Stomakhin et al. 2012)
       neo-hookean    mu/2 (I - 3) - mu (J - 1) + (lambda + mu)/2 (J - 1)^2    (Macklin and Mueller 2021)
       mooney-rivlin  c1 (I - 3) + c2 (II - 3) - (2 c1 + 4 c2) (J - 1) + (lambda + 2 c1)/2 (J - 1)^2, 2 (c1 + c2) = mu

   All are those of linear elasticity at small strain, and finite for a tetrahedron turned inside out. */
#define PEL_VOLUME_LAWS(ROW)                                                                                           \
    ROW(STVK, stvk, "stvk")                                                                                            \
    ROW(COROTATED, corotated, "corotated")                                                                             \
    ROW(MOONEY_RIVLIN, mooney_rivlin, "mooney-rivlin")                                                                 \
    ROW(NEO_HOOKEAN, neo_hookean, "neo-hookean")

typedef enum pel_volume_kind { /* PEL_VOLUME_STVK and so on */
#define PEL_VOLUME_ENUMERATOR(KIND, name, word) PEL_VOLUME_##KIND,
                               PEL_VOLUME_LAWS(PEL_VOLUME_ENUMERATOR)
#undef PEL_VOLUME_ENUMERATOR
} pel_volume_kind;

#define PEL_VOLUME_ONE(KIND, name, word) +1
enum { PEL_VOLUME_COUNT = 0 PEL_VOLUME_LAWS(PEL_VOLUME_ONE) }; /* number of laws */
#undef PEL_VOLUME_ONE

/* How the strain of a filled body is found. */
typedef enum pel_volume_element {
    PEL_VOLUME_LINEAR, /* in each tetrahedron: every method. Too stiff in bending, and above a Poisson's ratio of 0.45
                        */
    PEL_VOLUME_SMOOTH  /* as means over the tetrahedra at each edge: methods implicit, static, explicit and descent */
} pel_volume_element;

enum { PEL_VOLUME_ELEMENT_COUNT = PEL_VOLUME_SMOOTH + 1 };

/* A body whose mesh is filled with tetrahedra of a material. */
typedef struct pel_volume_def {
    bool on; /* default: false, tetrahedra of the mesh are not used */
    pel_volume_kind kind;
    pel_quantity young;         /* Pa, of a tetrahedron the mean of its corners; > 0; no keys */
    double poisson;             /* 0 to less than 0.5; default: 0.3 */
    double mooney_ratio;        /* mooney-rivlin: c2 over c1; default: 0.2 */
    pel_volume_element element; /* default: PEL_VOLUME_LINEAR */
} pel_volume_def;

/* Energy per volume [J/m3] of a law at the deformation gradient F (3 x 3 by rows), and its derivative by F, the first
   Piola-Kirchhoff stress [Pa] (nullable). Errors: PEL_BAD_ARGUMENT for numbers out of range or not finite. */
PEL_API pel_status pel_volume_density(pel_volume_kind kind, double young, double poisson, double mooney_ratio,
                                      const double deformation_gradient[9], double *density, double first_piola[9],
                                      pel_error *error);

/* Volume of a tetrahedron [m3], positive as in pel_mesh. */
PEL_API double pel_tetrahedron_volume(const double x[4][3]);

#ifdef __cplusplus
}
#endif
#endif

/* Pellicle: generated triangle meshes. Every shape is an oriented manifold; closed shapes face outward.

       pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
       def.frequency = 10;
       pel_shape_create(&def, &mesh, &error);

   or by name, as the program and the scene reader do:

       pel_shape_def def;
       pel_shape_def_of_name("torus", &def, &error);
       pel_shape_set(&def, "minor_radius", "0.2", &error); */
#ifndef PELLICLE_SHAPE_H
#define PELLICLE_SHAPE_H

#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum pel_shape_kind {
    PEL_SHAPE_GEODESIC_SPHERE, /* each edge of an icosahedron divided into `frequency` parts (class I), projected onto
                                  the sphere: 10 frequency^2 + 2 vertices, 20 frequency^2 triangles; the middle of an
                                  edge of the icosahedron is on the z axis. Frequency 5 gives 252 vertices and 500
                                  triangles, the sphere of paper A */
    PEL_SHAPE_UV_SPHERE,       /* meridians and parallels about the z axis: slices (rings - 1) + 2 vertices; vertex 0 is
                                  (0, 0, radius), the last one the other pole */
    PEL_SHAPE_GRID,            /* rectangle in the plane z = 0 about the origin, normal +z; rows of constant y, lowest
                                  first */
    PEL_SHAPE_CYLINDER,        /* about the z axis, from -height/2 to height/2; `capped` closes it with flat discs */
    PEL_SHAPE_TORUS,           /* about the z axis: slices x rings vertices */
    PEL_SHAPE_CAPSULE,         /* cylinder of length `height` about the z axis with a half sphere on each end */
    PEL_SHAPE_LENS_CAPSULE,    /* capsule of the human eye lens (Burd et al. 2002, outlines of three ages), metres, axis
                                  z, front (anterior) +z, vertex 0 = anterior pole; field "thickness" [m] */
    PEL_SHAPE_DISK,  /* in the plane z = 0 about the origin, normal +z: `rings` rings about vertex 0, the k-th of 6 k
                        vertices: 3 rings (rings + 1) + 1 vertices, 6 rings^2 triangles of about the same size */
    PEL_SHAPE_BLEND, /* a body that resembles a scanned one, smoothly joined from rounded parts: closed, genus 0, edges
                        of about the same length, bounding box centred at the origin, z up, front towards -y */
    PEL_SHAPE_BOX,   /* about the origin, nx x ny x nz cells: 2 (nx ny + ny nz + nz nx) + 2 vertices, vertex 0 is the
                        corner of the lowest coordinates; diagonals alternate */
    PEL_SHAPE_COUNT
} pel_shape_kind;

/* Bodies of PEL_SHAPE_BLEND. */
typedef enum pel_blend_body {
    PEL_BLEND_HEAD,   /* of a horned animal */
    PEL_BLEND_ANIMAL, /* on four legs */
    PEL_BLEND_LIVER   /* two lobes, concave below */
} pel_blend_body;

/* Triangulation of the cells of a grid. */
typedef enum pel_grid_diagonals {
    PEL_GRID_ONE_DIAGONAL, /* all diagonals in the same direction: (nx + 1) (ny + 1) vertices, 2 nx ny triangles */
    PEL_GRID_UNION_JACK,   /* diagonals alternate along x and y: vertices with 4 and 8 triangles; same counts */
    PEL_GRID_EQUILATERAL   /* every other row is shifted by half a cell. If size_y / ny = sqrt(3)/2 size_x / nx, the
                              triangles are equilateral (except half triangles at two sides). Odd rows have one vertex
                              more */
} pel_grid_diagonals;

/* A shape and its parameters. Each kind reads only its own parameters (pel_shape_info_of has their names, ranges and
   defaults). Lengths are in metres. */
typedef struct pel_shape_def {
    pel_shape_kind kind;
    int32_t frequency; /* geodesic-sphere: parts of each edge of the icosahedron */
    int32_t slices;    /* parts around the z axis */
    int32_t rings;     /* uv-sphere: parts from pole to pole; torus: around the tube; capsule: per half sphere;
                          disk: rings around the middle */
    int32_t segments;  /* cylinder, capsule: parts along the straight side */
    int32_t nx, ny;    /* grid, box: cells */
    int32_t nz;        /* box: cells */
    int32_t age;       /* lens-capsule: 11, 29 or 45 years */
    pel_grid_diagonals diagonals; /* grid */
    bool capped;                  /* cylinder */
    pel_blend_body body;          /* blend */
    double size;                  /* blend: longest side of the bounding box */
    double edge;                  /* blend: approximate length of the edges, 0.0005 to 0.03 times size (liver: 0.06) */
    double radius;
    double height;       /* cylinder; capsule: of the straight side, may be 0 */
    double size_x;       /* grid, box */
    double size_y;       /* grid, box */
    double size_z;       /* box */
    double major_radius; /* torus: axis to middle of tube */
    double minor_radius; /* torus: of the tube, less than major_radius */
    uint32_t cookie;     /* set by pel_shape_def_default */
} pel_shape_def;

typedef enum pel_shape_value {
    PEL_SHAPE_NUMBER,
    PEL_SHAPE_INTEGER,
    PEL_SHAPE_BOOLEAN,
    PEL_SHAPE_CHOICE
} pel_shape_value;

/* One parameter of a shape. */
typedef struct pel_shape_parameter {
    const char *name;           /* key in a scene and after --set, such as "minor_radius" */
    const char *doc;            /* one sentence without a full stop */
    const char *unit;           /* "m", "years" or "" */
    pel_shape_value type;       /* NUMBER is a double, INTEGER an int32_t, BOOLEAN a bool, CHOICE an enum */
    size_t offset;              /* of the member in pel_shape_def */
    double minimum, maximum;    /* both allowed, unless exclusive_minimum; of a CHOICE the first and last index */
    bool exclusive_minimum;     /* true: greater than minimum */
    double default_value;       /* of a CHOICE its index, of a BOOLEAN 0 or 1 */
    const char *const *choices; /* names of a CHOICE in order (maximum + 1 of them), null otherwise */
} pel_shape_parameter;

/* One shape with its parameters. All its data live forever. */
typedef struct pel_shape_info {
    pel_shape_kind kind;
    const char *name;                      /* "geodesic-sphere", ... */
    const char *doc;                       /* one sentence without a full stop */
    const pel_shape_parameter *parameters; /* (parameter_count) */
    int32_t parameter_count;
} pel_shape_info;

/* Null for a kind that does not exist. */
PEL_API const pel_shape_info *pel_shape_info_of(pel_shape_kind kind);

/* The defaults of this kind. */
PEL_API pel_shape_def pel_shape_def_default(pel_shape_kind kind);

/* The same by name. PEL_BAD_ARGUMENT for an unknown name, with the most similar one; *def is then a geodesic sphere. */
PEL_API pel_status pel_shape_def_of_name(const char *name, pel_shape_def *def, pel_error *error);

/* Sets one parameter of def->kind. The text is a number, "true" or "false", or the name of a choice.
   PEL_BAD_ARGUMENT, with def unchanged: unknown key (the remedy has the most similar one), not a number, out of range.
 */
PEL_API pel_status pel_shape_set(pel_shape_def *def, const char *key, const char *text, pel_error *error);
/* The same for a number (0 or 1 for a BOOLEAN, the index of a CHOICE). */
PEL_API pel_status pel_shape_set_number(pel_shape_def *def, const char *key, double value, pel_error *error);
/* Writes the value of `parameter` in def as a text for pel_shape_set, with the fewest digits that give the same number;
   32 bytes are enough. Returns text. */
PEL_API const char *pel_shape_get(const pel_shape_def *def, const pel_shape_parameter *parameter, char *text,
                                  size_t size);

/* Creates the mesh. PEL_BAD_ARGUMENT: a def without cookie, a parameter out of range, or more than 2^31 / 3 triangles.
   The same def gives the same bits. On failure *mesh is null. Free with pel_mesh_destroy. */
PEL_API pel_status pel_shape_create(const pel_shape_def *def, pel_mesh **mesh, pel_error *error);

#ifdef __cplusplus
}
#endif
#endif

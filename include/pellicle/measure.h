/* Pellicle: measures of a triangle surface: areas, normals, curvatures, volume and pressure.

   Pure functions over the caller's arrays: no state, no allocation, any thread; the same input gives the same bits.
   Positions (vertex_count x 3) are metres in one flat array, so that one topology serves every frame of a run.
   Triangles are counter-clockwise seen from outside: normals point outward and a sphere of radius r has the mean
   curvature +1/r.

   Triangles without area (PEL_FLAT_TRIANGLE of mesh_check.h): their area, if any, is shared equally by the corners;
   they add nothing to normals and mean curvature; their angles still sum to pi (coincident corners count as the limit
   of an isosceles or equilateral triangle), so that the total curvature stays right. No result is NaN for finite
   positions of ordinary size. Vertices in no triangle get zeros. */
#ifndef PELLICLE_MEASURE_H
#define PELLICLE_MEASURE_H

#include "topology.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- one vertex ---- */

/* Measures of the surface at a vertex, from the triangles around it. Source, unless stated otherwise: Meyer, Desbrun,
   Schroeder, Barr 2003, "Discrete differential-geometry operators for triangulated 2-manifolds". */
typedef struct pel_vertex_measure {
    double area;           /* m2, mixed area: Voronoi parts of triangles that are not obtuse, else a half or a quarter;
                              the sum over the vertices is the area of the surface */
    double normal[3];      /* unit, triangles weighted by their angle here (Thuermer, Wuethrich 1998); zero when none */
    double area_vector[3]; /* m2, a third of the triangles' areas along their normals: the gradient of the volume of a
                              closed surface, and along the area-weighted normal */
    double mean_curvature_normal[3]; /* 1/m, twice the mean curvature along the normal: the cotangent Laplacian, which
                                        is the gradient of the surface's area over `area`; zero on the boundary */
    double mean_curvature;     /* 1/m, half its length, positive where it points along the normal; zero on the boundary,
                                  where the sum over half a neighbourhood is no curvature */
    double angle_defect;       /* 2 pi minus the angles here; on the boundary pi minus the angles (its turning) */
    double gaussian_curvature; /* 1/m2, angle_defect over area, on the boundary too */
    bool boundary;             /* on the boundary, or in no triangle */
} pel_vertex_measure;

/* Measures vertex v (0 .. vertex_count - 1) in time proportional to its triangles. */
PEL_API void pel_vertex_measure_fill(const pel_topology *topology, const double *positions, int32_t v,
                                     pel_vertex_measure *measure);

/* ---- all vertices; pass null for measures that are not wanted ---- */

typedef enum pel_normal_weight {
    PEL_NORMAL_ANGLE, /* by the angle at the vertex: does not depend on how the surface is cut into triangles */
    PEL_NORMAL_AREA   /* by area: the direction of the volume's gradient */
} pel_normal_weight;

/* Mixed areas (vertex_count) [m2]. */
PEL_API void pel_surface_vertex_areas(const pel_topology *topology, const double *positions, double *areas);

/* Unit normals (vertex_count x 3); zero where the triangles' normals cancel out. */
PEL_API void pel_surface_normals(const pel_topology *topology, const double *positions, pel_normal_weight weight,
                                 double *normals);

/* Mean curvature (vertex_count) [1/m] and its normal vector (vertex_count x 3) [1/m]; either may be null. */
PEL_API void pel_surface_mean_curvature(const pel_topology *topology, const double *positions, double *curvature,
                                        double *normals);

/* Gaussian curvature (vertex_count) [1/m2] and angle defects (vertex_count); either may be null. Returns the sum of the
   defects, the total curvature: 2 pi times the Euler number (vertices in no triangle not counted), by Gauss-Bonnet. */
PEL_API double pel_surface_gaussian_curvature(const pel_topology *topology, const double *positions, double *curvature,
                                              double *defects);

/* Summary of curvature. Least, mean and greatest are over the vertices that are not on the boundary (all zero if there
   are none); means are weighted by area. */
typedef struct pel_curvature_summary {
    int32_t inner_vertex_count;
    double area;                    /* m2, of the whole surface */
    double mean_curvature_integral; /* m, mean curvature times area: 4 pi r on a sphere */
    double mean_curvature_min, mean_curvature_mean, mean_curvature_max; /* 1/m */
    double total_curvature; /* sum of all angle defects, including the boundary */
    double gaussian_curvature_min, gaussian_curvature_mean, gaussian_curvature_max; /* 1/m2 */
} pel_curvature_summary;

PEL_API void pel_surface_curvature_summary(const pel_topology *topology, const double *positions,
                                           pel_curvature_summary *summary);

/* ---- area and volume, for triangles (triangle_count x 3) of any kind ---- */

/* m2 */
PEL_API double pel_surface_area(const double *positions, const int32_t *triangles, int32_t triangle_count);

/* Signed volume [m3] between the triangles and a point, positive where they face away from it. On a closed surface the
   point does not matter but for rounding; null takes the first corner of the first triangle, so that a body far from
   the world's origin loses no digits. Bodies far from each other are better measured one by one. */
PEL_API double pel_surface_volume(const double *positions, const int32_t *triangles, int32_t triangle_count,
                                  const double origin[3]);

/* The same, with its gradient on the vertices (vertex_count x 3) [m2] for a point that stays where it is; null takes
   the same point as above. On a closed surface the gradient is pel_vertex_measure's area_vector. */
PEL_API double pel_surface_volume_gradient(const double *positions, int32_t vertex_count, const int32_t *triangles,
                                           int32_t triangle_count, const double origin[3], double *gradient);

/* ---- pressure (paper B, figure 2) ---- */

typedef enum pel_pressure_form {
    PEL_PRESSURE_CONSISTENT, /* f = -P times a third of the areas along their own normals: minus P times the gradient of
                                the volume; no net force and torque on a closed surface */
    PEL_PRESSURE_VERTEX_NORMAL /* paper B as written: f = -P times a third of the areas, along the vertex's unit normal
                                  (weighted by area, so that both forms have one direction); larger at sharp vertices,
                                  and with a net force on irregular surfaces */
} pel_pressure_form;

/* The force of an outside pressure P [Pa] (positive presses inward) on each vertex: forces (vertex_count x 3) [N],
   magnitudes (vertex_count) [N], and the cosine (vertex_count) of the angle between the force and +y, which is the
   colour in paper B's figure 2, 0 where there is no force. Each of the three may be null. */
PEL_API void pel_surface_pressure(const pel_topology *topology, const double *positions, double outside_pressure,
                                  pel_pressure_form form, double *forces, double *magnitudes,
                                  double *direction_cosines);

#ifdef __cplusplus
}
#endif
#endif

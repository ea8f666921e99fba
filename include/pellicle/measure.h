/* Pellicle: measures of a triangle surface: areas, normals, curvatures, volume and pressure.

   Pure functions over the caller's arrays: no state, no allocation, any thread; the same input gives the same bits.
   Positions (vertex_count x 3) are metres in one flat array, so that one topology serves every frame of a run.
   Triangles are counter-clockwise seen from outside: normals point outward and a sphere of radius r has the mean
   curvature +1/r.

   Triangles without area (PEL_FLAT_TRIANGLE of mesh_check.h): their area, if any, is shared equally by the corners.
   They contribute nothing to normals and mean curvature. Their angles still sum to pi (coincident corners count as the
   limit of an isosceles or equilateral triangle), so the total curvature stays correct. If positions are finite and far
   from the limits of double, no result is NaN. Vertices in no triangle get zeros. */
#ifndef PELLICLE_MEASURE_H
#define PELLICLE_MEASURE_H

#include "kinds.h"
#include "topology.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- one vertex ---- */

/* Measures of the surface at a vertex, from the triangles around it. Source, unless stated otherwise: Meyer, Desbrun,
   Schroeder, Barr 2003, "Discrete differential-geometry operators for triangulated 2-manifolds". */
typedef struct pel_vertex_measure {
    double area;           /* m2, mixed area: the Voronoi part of a triangle that is not obtuse, otherwise a half or a
                              quarter of the triangle; the sum over the vertices is the area of the surface */
    double normal[3];      /* unit, triangles weighted by their angle at the vertex (Thuermer, Wuethrich 1998); zero if
                              there is none */
    double area_vector[3]; /* m2, sum of a third of each triangle's area along its normal: the gradient of the volume of
                              a closed surface, parallel to the area-weighted normal */
    double mean_curvature_normal[3]; /* 1/m, twice the mean curvature along the normal: the cotangent Laplacian, that
                                        is the gradient of the surface's area divided by `area`; zero on the boundary */
    double mean_curvature;     /* 1/m, half its length, positive if it points along the normal; zero on the boundary,
                                  where a sum over half a neighbourhood is not a curvature */
    double angle_defect;       /* rad: 2 pi minus the sum of the angles at the vertex; on the boundary pi minus the sum
                                  (turning angle of the boundary) */
    double gaussian_curvature; /* 1/m2, angle_defect / area, also on the boundary */
    bool boundary;             /* on the boundary, or in no triangle */
} pel_vertex_measure;

/* Measures vertex v (0 .. vertex_count - 1). The time is proportional to the number of its triangles. */
PEL_API void pel_vertex_measure_fill(const pel_topology *topology, const double *positions, int32_t v,
                                     pel_vertex_measure *measure);

/* ---- all vertices; pass null for measures that you do not need ---- */

typedef enum pel_normal_weight {
    PEL_NORMAL_ANGLE, /* by the angle at the vertex: independent of the triangulation of the surface */
    PEL_NORMAL_AREA   /* by area: parallel to the gradient of the volume */
} pel_normal_weight;

/* Mixed areas (vertex_count) [m2]. */
PEL_API void pel_surface_vertex_areas(const pel_topology *topology, const double *positions, double *areas);

/* Unit normals (vertex_count x 3); zero where the triangles' normals cancel out. */
PEL_API void pel_surface_normals(const pel_topology *topology, const double *positions, pel_normal_weight weight,
                                 double *normals);

/* Mean curvature (vertex_count) [1/m] and its normal vector (vertex_count x 3) [1/m]; either may be null. */
PEL_API void pel_surface_mean_curvature(const pel_topology *topology, const double *positions, double *curvature,
                                        double *normals);

/* Gaussian curvature (vertex_count) [1/m2] and angle defects (vertex_count) [rad]; either may be null. Returns the
   total curvature, the sum of the defects: 2 pi times the Euler characteristic (without vertices in no triangle) by
   Gauss-Bonnet. */
PEL_API double pel_surface_gaussian_curvature(const pel_topology *topology, const double *positions, double *curvature,
                                              double *defects);

/* Summary of curvature. Minimum, mean and maximum are over the vertices that are not on the boundary (all zero if there
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

/* Area of the triangles [m2]. */
PEL_API double pel_surface_area(const double *positions, const int32_t *triangles, int32_t triangle_count);

/* Signed volume [m3] between the triangles and the point `origin`, positive for triangles that face away from it. On a
   closed surface the point affects only rounding. Null uses the first corner of the first triangle, so a body far from
   (0, 0, 0) loses no digits. Measure bodies that are far from each other one by one. */
PEL_API double pel_surface_volume(const double *positions, const int32_t *triangles, int32_t triangle_count,
                                  const double origin[3]);

/* The same, with the gradient on the vertices (vertex_count x 3) [m2] for a fixed point; null uses the same point as
   above. On a closed surface the gradient is the area_vector of pel_vertex_measure. */
PEL_API double pel_surface_volume_gradient(const double *positions, int32_t vertex_count, const int32_t *triangles,
                                           int32_t triangle_count, const double origin[3], double *gradient);

/* ---- pressure (paper B, figure 2) ---- */

/* The force of an outside pressure P [Pa] (positive: inward) on each vertex: forces (vertex_count x 3) [N], magnitudes
   (vertex_count) [N], and the cosine (vertex_count) of the angle between the force and +y, the colour in figure 2 of
   paper B; 0 if there is no force. Each of the three may be null. */
PEL_API void pel_surface_pressure(const pel_topology *topology, const double *positions, double outside_pressure,
                                  pel_pressure_form form, double *forces, double *magnitudes,
                                  double *direction_cosines);

#ifdef __cplusplus
}
#endif
#endif

/* Areas, normals and curvatures around vertices. */
#include "base/assert.h"
#include "field/corner.h"
#include "math/extremes.h"
#include "pellicle/measure.h"

/* What the angles at a vertex lack to those of a plane: 2 pi, or pi on the boundary. Pi is taken to twice the digits,
   or else a sum over 100,000 vertices would be off by their number times 2.4e-16. */
static double angle_defect(const pel_topology *topology, int32_t v, double angles)
{
    PEL_ASSERT_INDEX(v, topology->vertex_count);
    const double pi = 3.14159265358979323846, pi_rest = 1.2246467991473532e-16;
    if (topology->corner_of_vertex[v] < 0)
        return 0;
    double half_turns = pel_vertex_is_boundary(topology, v) ? 1 : 2;
    return half_turns * pi - angles + half_turns * pi_rest;
}

void pel_vertex_measure_fill(const pel_topology *topology, const double *positions, int32_t v,
                             pel_vertex_measure *measure)
{
    if (topology == NULL || positions == NULL || measure == NULL || v < 0 || v >= topology->vertex_count)
        return;
    *measure = (pel_vertex_measure){.boundary = pel_vertex_is_boundary(topology, v)};
    double *gradient = measure->mean_curvature_normal, angles = 0;
    for (int32_t h = pel_corner_first(topology, v); h >= 0; h = pel_corner_next(topology, v, h)) {
        pel_corner corner = pel_corner_load(topology, positions, h);
        double angle = pel_corner_angle(&corner);
        angles += angle;
        measure->area += pel_corner_mixed_area(&corner);
        pel_corner_add_area_gradient(&corner, gradient);
        pel_corner_add_angle_normal(&corner, angle, measure->normal);
        pel_vec3_along(measure->area_vector, 1.0 / 6, corner.normal, measure->area_vector);
    }
    pel_vec3_normalize(measure->normal);
    measure->angle_defect = angle_defect(topology, v, angles);
    measure->gaussian_curvature = measure->area > 0 ? measure->angle_defect / measure->area : 0;
    pel_vec3_scale(gradient, measure->area > 0 && !measure->boundary ? 1 / measure->area : 0, gradient);
    double half_length = pel_vec3_length(gradient) / 2;
    measure->mean_curvature = pel_vec3_dot(gradient, measure->normal) < 0 ? -half_length : half_length;
}

void pel_surface_vertex_areas(const pel_topology *topology, const double *positions, double *areas)
{
    if (topology == NULL || positions == NULL || areas == NULL)
        return;
    for (int32_t v = 0; v < topology->vertex_count; v++) {
        areas[v] = 0;
        for (int32_t h = pel_corner_first(topology, v); h >= 0; h = pel_corner_next(topology, v, h)) {
            pel_corner corner = pel_corner_load(topology, positions, h);
            areas[v] += pel_corner_mixed_area(&corner);
        }
    }
}

void pel_surface_normals(const pel_topology *topology, const double *positions, pel_normal_weight weight,
                         double *normals)
{
    if (topology == NULL || positions == NULL || normals == NULL)
        return;
    pel_vertex_measure measure;
    for (int32_t v = 0; v < topology->vertex_count; v++) {
        double *normal = weight == PEL_NORMAL_AREA ? measure.area_vector : measure.normal;
        pel_vertex_measure_fill(topology, positions, v, &measure);
        pel_vec3_normalize(normal);
        pel_vec3_copy(normal, normals + 3 * (size_t)v);
    }
}

void pel_surface_mean_curvature(const pel_topology *topology, const double *positions, double *curvature,
                                double *normals)
{
    if (topology == NULL || positions == NULL)
        return;
    pel_vertex_measure measure;
    for (int32_t v = 0; v < topology->vertex_count; v++) {
        pel_vertex_measure_fill(topology, positions, v, &measure);
        if (curvature != NULL)
            curvature[v] = measure.mean_curvature;
        if (normals != NULL)
            pel_vec3_copy(measure.mean_curvature_normal, normals + 3 * (size_t)v);
    }
}

double pel_surface_gaussian_curvature(const pel_topology *topology, const double *positions, double *curvature,
                                      double *defects)
{
    if (topology == NULL || positions == NULL)
        return 0;
    double total = 0;
    pel_vertex_measure measure;
    for (int32_t v = 0; v < topology->vertex_count; v++) {
        pel_vertex_measure_fill(topology, positions, v, &measure);
        total += measure.angle_defect;
        if (curvature != NULL)
            curvature[v] = measure.gaussian_curvature;
        if (defects != NULL)
            defects[v] = measure.angle_defect;
    }
    return total;
}

/* takes one more inner vertex into least, greatest and the integral of a quantity */
static void include_value(double value, double area, bool first, double *least, double *integral, double *greatest)
{
    *least = first ? value : pel_min(*least, value);
    *greatest = first ? value : pel_max(*greatest, value);
    *integral += area * value;
}

void pel_surface_curvature_summary(const pel_topology *topology, const double *positions,
                                   pel_curvature_summary *summary)
{
    if (topology == NULL || positions == NULL || summary == NULL)
        return;
    double inner_area = 0, gaussian_integral = 0;
    pel_vertex_measure measure;
    *summary = (pel_curvature_summary){0};
    for (int32_t v = 0; v < topology->vertex_count; v++) {
        pel_vertex_measure_fill(topology, positions, v, &measure);
        summary->area += measure.area;
        summary->total_curvature += measure.angle_defect;
        if (measure.boundary)
            continue;
        bool first = summary->inner_vertex_count++ == 0;
        inner_area += measure.area;
        include_value(measure.mean_curvature, measure.area, first, &summary->mean_curvature_min,
                      &summary->mean_curvature_integral, &summary->mean_curvature_max);
        include_value(measure.gaussian_curvature, measure.area, first, &summary->gaussian_curvature_min,
                      &gaussian_integral, &summary->gaussian_curvature_max);
    }
    if (inner_area > 0) {
        summary->mean_curvature_mean = summary->mean_curvature_integral / inner_area;
        summary->gaussian_curvature_mean = gaussian_integral / inner_area;
    }
}

/* a third of the triangles' areas around a vertex, and the same along their normals */
static double third_area(const pel_topology *topology, const double *positions, int32_t v, double area_vector[3])
{
    PEL_ASSERT_INDEX(v, topology->vertex_count);
    double area = 0;
    pel_vec3_set(area_vector, 0, 0, 0);
    for (int32_t h = pel_corner_first(topology, v); h >= 0; h = pel_corner_next(topology, v, h)) {
        pel_corner corner = pel_corner_load(topology, positions, h);
        area += corner.twice_area / 6;
        pel_vec3_along(area_vector, 1.0 / 6, corner.normal, area_vector);
    }
    return area;
}

void pel_surface_pressure(const pel_topology *topology, const double *positions, double outside_pressure,
                          pel_pressure_form form, double *forces, double *magnitudes, double *direction_cosines)
{
    if (topology == NULL || positions == NULL)
        return;
    for (int32_t v = 0; v < topology->vertex_count; v++) {
        double force[3], area = third_area(topology, positions, v, force);
        if (form == PEL_PRESSURE_VERTEX_NORMAL) {
            pel_vec3_normalize(force);
            pel_vec3_scale(force, area, force);
        }
        pel_vec3_scale(force, -outside_pressure, force);
        double magnitude = pel_vec3_length(force);
        if (forces != NULL)
            pel_vec3_copy(force, forces + 3 * (size_t)v);
        if (magnitudes != NULL)
            magnitudes[v] = magnitude;
        if (direction_cosines != NULL)
            direction_cosines[v] = magnitude > 0 ? force[1] / magnitude : 0;
    }
}

/* Surfaces whose curvature is known in every point, and how far a mesh's measures are from it. */
#ifndef PEL_TESTS_CLOSED_FORM_H
#define PEL_TESTS_CLOSED_FORM_H

#include "check.h"
#include "random.h"

#include "pellicle/measure.h"
#include "pellicle/shape.h"

#include <stdlib.h>

static const double pi = 3.14159265358979323846;

/* sizes of the torus and half axes of the ellipsoid */
static const double torus_major = 1, torus_minor = 0.4, half_axes[3] = {1, 0.8, 1.3};

typedef struct curved_mesh {
    pel_mesh *mesh;
    pel_topology *topology;
    const double *positions;
} curved_mesh;

static inline curved_mesh finish_mesh(pel_mesh *mesh)
{
    curved_mesh curved = {mesh, NULL, mesh->positions[0]};
    assert_int_equal(pel_topology_create(mesh, &curved.topology, NULL), PEL_OK);
    return curved;
}

static inline curved_mesh make_shape(const pel_shape_def *def)
{
    pel_mesh *mesh;
    assert_int_equal(pel_shape_create(def, &mesh, NULL), PEL_OK);
    return finish_mesh(mesh);
}

static inline void destroy_mesh(curved_mesh *curved)
{
    pel_topology_destroy(curved->topology);
    pel_mesh_destroy(curved->mesh);
}

static inline curved_mesh make_sphere(int32_t frequency, double radius)
{
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    def.frequency = frequency;
    def.radius = radius;
    return make_shape(&def);
}

static inline curved_mesh make_ellipsoid(int32_t frequency)
{
    curved_mesh curved = make_sphere(frequency, 1);
    for (int32_t v = 0; v < curved.mesh->vertex_count; v++)
        for (int c = 0; c < 3; c++)
            curved.mesh->positions[v][c] *= half_axes[c];
    return curved;
}

static inline curved_mesh make_torus(int32_t rings)
{
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_TORUS);
    def.major_radius = torus_major;
    def.minor_radius = torus_minor;
    def.rings = rings;
    def.slices = 2 * rings;
    return make_shape(&def);
}

/* an ellipsoid with random vertices: vertices of the sphere are moved by up to a part of an edge */
static inline curved_mesh make_irregular(int32_t frequency)
{
    random_state random = {5};
    curved_mesh curved = make_sphere(frequency, 1);
    for (int32_t v = 0; v < curved.mesh->vertex_count; v++) {
        double *x = curved.mesh->positions[v], square = 0;
        for (int c = 0; c < 3; c++) {
            x[c] += random_between(&random, -0.25, 0.25) * 1.1 / frequency;
            square += x[c] * x[c];
        }
        for (int c = 0; c < 3; c++)
            x[c] *= half_axes[c] / sqrt(square);
    }
    return curved;
}

typedef struct curvature {
    double mean, gaussian;
} curvature;

typedef curvature closed_form(const double x[3]);

static inline curvature sphere_curvature(const double x[3])
{
    double radius = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
    return (curvature){1 / radius, 1 / (radius * radius)};
}

static inline curvature torus_curvature(const double x[3])
{
    /* distance from the axis is R + r cos(theta) */
    double distance = sqrt(x[0] * x[0] + x[1] * x[1]), cosine = (distance - torus_major) / torus_minor;
    return (curvature){(torus_major + 2 * torus_minor * cosine) / (2 * torus_minor * distance),
                       cosine / (torus_minor * distance)};
}

static inline curvature ellipsoid_curvature(const double x[3])
{
    double product = 1, squares = 0, axes = 0, s = 0;
    for (int c = 0; c < 3; c++) {
        double axis = half_axes[c] * half_axes[c];
        product *= axis;
        axes += axis;
        squares += x[c] * x[c];
        s += x[c] * x[c] / (axis * axis);
    }
    return (curvature){fabs(squares - axes) / (2 * product * s * sqrt(s)), 1 / (product * s * s)};
}

/* errors over all vertices: largest, and root of the mean square weighted by area */
typedef struct curvature_error {
    double mean_largest, mean_square, gaussian_largest, gaussian_square;
} curvature_error;

static inline curvature_error curvature_error_of(const curved_mesh *curved, closed_form *exact)
{
    curvature_error error = {0};
    double area = 0;
    for (int32_t v = 0; v < curved->mesh->vertex_count; v++) {
        pel_vertex_measure measure;
        pel_vertex_measure_fill(curved->topology, curved->positions, v, &measure);
        curvature expected = exact(curved->mesh->positions[v]);
        double mean = fabs(measure.mean_curvature - expected.mean);
        double gaussian = fabs(measure.gaussian_curvature - expected.gaussian);
        area += measure.area;
        error.mean_largest = fmax(error.mean_largest, mean);
        error.gaussian_largest = fmax(error.gaussian_largest, gaussian);
        error.mean_square += measure.area * mean * mean;
        error.gaussian_square += measure.area * gaussian * gaussian;
    }
    error.mean_square = sqrt(error.mean_square / area);
    error.gaussian_square = sqrt(error.gaussian_square / area);
    return error;
}

#endif

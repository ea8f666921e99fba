/* Linear tetrahedra bend too stiffly: with edges e, a plate or beam of thickness t by a factor of about 1 + 1.1 (e /
   t)^2 (measured on bars of 4, 2, 1 and 0.4 edges: 1.065, 1.29, 2.1 and 8.5). They lock where the material is nearly
   incompressible: a beam of 4 cells is 5 % too stiff at a Poisson's ratio of 0.3, 7 % at 0.45 and 9 % at 0.49
   (docs/volumes.md). */
#include "run/warnings_volume.h"

#include "linear/eigen.h"
#include "math/extremes.h"
#include "math/vec3.h"
#include "pellicle/volume.h"
#include "run/state.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define BENDING_ERROR 1.1
/* share of the stiffness that is told; length over thickness from which a body bends */
#define MOST_ERROR 0.1
#define SLENDER 3
#define LOCKING_POISSON 0.45
/* edges in a thickness at which the error is 7 % */
#define GOOD_COUNT 4
/* twice volume over area is the thickness of a curved sheet; where it is more than this share of the thickness of the
   box with the same inertia, the body is a bar or a plate of that thickness */
#define SHEET_SHARE 0.33

typedef struct volume_shape {
    double edge;              /* m, mean of the longest edge of each tetrahedron */
    double thickness, length; /* m */
} volume_shape;

/* adds the moments of second order of a tetrahedron about the origin */
static void add_moments(const double x[4][3], double volume, double moments[9])
{
    double sum[3] = {0};
    for (int k = 0; k < 4; k++)
        pel_vec3_add(sum, x[k], sum);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            double products = sum[i] * sum[j];
            for (int k = 0; k < 4; k++)
                products += x[k][i] * x[k][j];
            moments[3 * i + j] += volume * products / 20;
        }
}

static double longest_edge(const double x[4][3])
{
    double longest = 0;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < i; j++)
            longest = pel_max(longest, pel_vec3_distance(x[i], x[j]));
    return longest;
}

static double area_of(const pel_mesh *mesh)
{
    double sum = 0, normal[3];
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        const int32_t *v = mesh->triangles[t];
        pel_vec3_triangle_normal(mesh->positions[v[0]], mesh->positions[v[1]], mesh->positions[v[2]], normal);
        sum += 0.5 * pel_vec3_length(normal);
    }
    return sum;
}

/* about the first vertex, so that a place far from the origin costs no digits */
static volume_shape measure_shape(const pel_mesh *mesh)
{
    double total = 0, center[3] = {0}, moments[9] = {0}, values[3], vectors[9], edges = 0;
    for (int32_t t = 0; t < mesh->tetrahedron_count; t++) {
        double x[4][3];
        for (int k = 0; k < 4; k++)
            pel_vec3_subtract(mesh->positions[mesh->tetrahedra[t][k]], mesh->positions[0], x[k]);
        double volume = pel_tetrahedron_volume((const double(*)[3])x);
        total += volume;
        edges += longest_edge((const double(*)[3])x);
        for (int k = 0; k < 4; k++)
            for (int i = 0; i < 3; i++)
                center[i] += 0.25 * volume * x[k][i];
        add_moments((const double(*)[3])x, volume, moments);
    }
    for (int i = 0; i < 9; i++)
        moments[i] = moments[i] / total - center[i / 3] / total * center[i % 3] / total;
    pel_eigen_dense(3, moments, values, vectors);
    /* of a box with this inertia */
    volume_shape shape = {edges / mesh->tetrahedron_count, sqrt(12 * pel_max(values[2], 0)), sqrt(12 * values[0])};
    double sheet = 2 * total / area_of(mesh);
    if (sheet < SHEET_SHARE * shape.thickness)
        shape.thickness = sheet;
    return shape;
}

/* of the stiffness in bending; 0 of bodies that are not slender */
static double error_of(const volume_shape *shape)
{
    double share = shape->edge / shape->thickness;
    return shape->length > SLENDER * shape->thickness ? BENDING_ERROR * share * share : 0;
}

void pel_warnings_check_volume(pel_run_state *run, int32_t b)
{
    const pel_body_def *body = &run->scene->model.bodies[b];
    if (!body->volume.on || body->volume.element == PEL_VOLUME_SMOOTH)
        return;
    const volume_shape shape = measure_shape(body->mesh);
    double error = error_of(&shape);
    if (error > MOST_ERROR || body->volume.poisson > LOCKING_POISSON)
        pel_warn_body(run, PEL_WARN_COARSE_VOLUME, b, error, 0);
}

void pel_tell_coarse_volume(const pel_warning_text *at)
{
    const pel_body_def *body = &at->run->scene->model.bodies[at->run->flagged[PEL_WARN_COARSE_VOLUME].body];
    const volume_shape shape = measure_shape(body->mesh);
    double error = error_of(&shape);
    if (error > MOST_ERROR)
        snprintf(
            at->text, at->size,
            "body '%s' is about %.2g m thick, and the edges of its tetrahedra are %.2g m long: it bends about %.2g "
            "times too stiffly. use volume: { element: smooth } or { edge: %.2g }, or for a thin sheet a surface with "
            "a membrane of that thickness",
            body->name, shape.thickness, shape.edge, 1 + error, shape.thickness / GOOD_COUNT);
    else
        snprintf(
            at->text, at->size,
            "Poisson's ratio of body '%s' is %.4g: linear tetrahedra lock above %g, and bend and shear too stiffly. "
            "use volume: { element: smooth }, or a smaller ratio",
            body->name, body->volume.poisson, LOCKING_POISSON);
}

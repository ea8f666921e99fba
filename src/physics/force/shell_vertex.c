/* Energies and virials of a shell at the vertices, for measures and for the criterion of refinement. */
#include "base/assert.h"
#include "force/shell_body.h"
#include "math/vec3.h"
#include "model/shell.h"

#include <string.h>

/* the row of a place: its number in the mesh or forest, mapped by output_vertex if given */
typedef struct row_map {
    const int32_t *mesh_vertex, *output_vertex;
} row_map;

static void share(double energy, const int32_t *vertices, int count, const row_map *rows, double *values)
{
    for (int i = 0; i < count; i++) {
        int32_t v = rows->mesh_vertex[vertices[i]];
        values[rows->output_vertex != NULL ? rows->output_vertex[v] : v] += energy / count;
    }
}

/* minus the virial of forces with the given gradients */
static double virial_of(const double x[3][3], const double gradient[3][3])
{
    double side[3], sum = 0;
    for (int i = 1; i < 3; i++) {
        pel_vec3_subtract(x[i], x[0], side);
        sum += pel_vec3_dot(gradient[i], side);
    }
    return sum;
}

/* energies or virials of a triangle or its fibres, distributed to the rows of its corners */
typedef struct corner_sums {
    const pel_shell_forces *forces;
    const pel_shell_body *own;
    const pel_record *position;
    double time;
    bool virial;
    row_map map;
} corner_sums;

static void add_membrane(const corner_sums *sums, double *values)
{
    const pel_shell *shell = sums->own->shell;
    double x[3][3], gradient[3][3];
    for (int32_t t = 0; shell->has_membrane && t < shell->triangle_count; t++) {
        const int32_t *vertices = shell->corners[t];
        pel_load_points(sums->position, vertices, 3, x);
        double energy = pel_shell_membrane_energy(sums->forces, sums->own, t, (const double(*)[3])x,
                                                  sums->virial ? gradient : NULL);
        share(sums->virial ? virial_of((const double(*)[3])x, (const double(*)[3])gradient) : energy, vertices, 3,
              &sums->map, values);
    }
}

static void add_fibres(const corner_sums *sums, double *values)
{
    const pel_shell *shell = sums->own->shell;
    double x[3][3], gradient[3][3];
    for (int32_t r = 0; r < shell->region_count; r++)
        for (int32_t i = 0; i < pel_shell_fibre_count(&shell->regions[r]); i++) {
            const int32_t *vertices = shell->corners[pel_shell_fibre_triangle(&shell->regions[r], i)];
            pel_load_points(sums->position, vertices, 3, x);
            double energy = pel_shell_fibre_energy(shell, &shell->regions[r], i, sums->time, (const double(*)[3])x,
                                                   sums->virial ? gradient : NULL);
            share(sums->virial ? virial_of((const double(*)[3])x, (const double(*)[3])gradient) : energy, vertices, 3,
                  &sums->map, values);
        }
}

void pel_shell_add_virials(const pel_shell_forces *forces, int32_t body, const int32_t *output_vertex,
                           const pel_record *position, double time, double *virials)
{
    const pel_shell_body *own = pel_shell_body_of(forces, body);
    if (own == NULL)
        return;
    const corner_sums sums = {forces, own, position, time, true, {forces->model->mesh_vertex, output_vertex}};
    add_membrane(&sums, virials);
    add_fibres(&sums, virials);
}

void pel_shell_vertex_energies(const pel_shell_forces *forces, int32_t body, int32_t vertex_count,
                               const int32_t *output_vertex, const pel_record *position, double time, double *membrane,
                               double *bending, double *fibres)
{
    const pel_shell_body *own = pel_shell_body_of(forces, body);
    double *lists[3] = {membrane, bending, fibres};
    for (int i = 0; i < 3; i++)
        memset(lists[i], 0, (size_t)vertex_count * sizeof **lists);
    if (own == NULL)
        return;
    const pel_shell *shell = own->shell;
    const corner_sums sums = {forces, own, position, time, false, {forces->model->mesh_vertex, output_vertex}};
    add_membrane(&sums, membrane);
    add_fibres(&sums, fibres);
    for (int32_t i = 0; i < pel_shell_elastic_hinges(shell); i++) {
        const pel_shell_hinge hinge = pel_shell_hinge_now(forces, shell, i);
        double x[4][3];
        pel_load_points(position, hinge.vertices, 4, x);
        double energy = pel_shell_hinge_factor(shell, &hinge) *
                        pel_shell_hinge_energy(shell, forces->model->rest, &hinge, (const double(*)[3])x, NULL);
        share(energy, hinge.vertices, 4, &sums.map, bending);
    }
}

void pel_shell_add_tetra_energies(const pel_shell_forces *forces, int32_t body, const int32_t *output_vertex,
                                  const pel_record *position, double *energies)
{
    const pel_shell_body *own = pel_shell_body_of(forces, body);
    if (own == NULL)
        return;
    const row_map rows = {forces->model->mesh_vertex, output_vertex};
    const pel_stars *stars = own->shell->stars;
    for (int32_t e = 0; stars != NULL && e < stars->count; e++) {
        const int32_t *nodes = stars->nodes + stars->begin[e], count = stars->begin[e + 1] - stars->begin[e];
        const pel_tangent_sum none = {0};
        double x[3 * PEL_STAR_NODES];
        for (int32_t k = 0; k < count; k++)
            pel_vertex_position(position, nodes[k], x + 3 * k);
        share(pel_star_tangent(stars, e, &own->shell->solid, x, PEL_TANGENT_EXACT, &none), nodes, count, &rows,
              energies);
    }
    for (int32_t t = 0; stars == NULL && t < own->shell->tetrahedron_count; t++) {
        const int32_t *vertices = own->shell->tetrahedra[t];
        pel_rest_tetra rest;
        double x[4][3], f[9];
        const double scale = pel_filled_rest(own->shell, forces->model->rest, t, &rest);
        pel_load_points(position, vertices, 4, x);
        pel_tetra_deformation(&rest, (const double(*)[3])x, f);
        share(scale * pel_solid_density(&own->shell->solid, f, NULL), vertices, 4, &rows, energies);
    }
}

/* ---- one vertex ---- */

static int corner_at(const int32_t *vertices, int32_t place)
{
    int corner = 0;
    while (vertices[corner] != place)
        corner++;
    return corner;
}

static void subtract_hinge(const pel_shell_forces *forces, const pel_shell *shell, int32_t i,
                           const pel_record *position, int32_t place, double force[3])
{
    PEL_ASSERT_INDEX(i, shell->hinge_count);
    const pel_shell_hinge hinge = pel_shell_hinge_now(forces, shell, i);
    double x[4][3], gradient[4][3];
    pel_load_points(position, hinge.vertices, 4, x);
    pel_shell_hinge_energy(shell, forces->model->rest, &hinge, (const double(*)[3])x, gradient);
    pel_vec3_along(force, -pel_shell_hinge_factor(shell, &hinge), gradient[corner_at(hinge.vertices, place)], force);
}

static void subtract_triangle(const pel_shell_forces *forces, const pel_shell_body *own, int32_t t,
                              const pel_record *position, double time, int32_t place, double force[3])
{
    const pel_shell *shell = own->shell;
    double x[3][3], gradient[3][3];
    int corner = corner_at(shell->corners[t], place);
    pel_load_points(position, shell->corners[t], 3, x);
    if (shell->has_membrane) {
        pel_shell_membrane_energy(forces, own, t, (const double(*)[3])x, gradient);
        pel_vec3_subtract(force, gradient[corner], force);
    }
    for (int32_t r = 0; r < shell->region_count; r++) {
        int32_t fibre = pel_shell_find_fibre(&shell->regions[r], t);
        if (fibre < 0)
            continue;
        pel_shell_fibre_energy(shell, &shell->regions[r], fibre, time, (const double(*)[3])x, gradient);
        pel_vec3_subtract(force, gradient[corner], force);
    }
}

void pel_shell_elastic_force_at(const pel_shell_forces *forces, int32_t body, const pel_record *position, double time,
                                int32_t place, double force[3])
{
    const pel_shell_body *own = pel_shell_body_of(forces, body);
    pel_vec3_set(force, 0, 0, 0);
    if (own == NULL)
        return;
    int32_t v = place - own->first_place, triangle_count = own->shell->triangle_count;
    for (int32_t i = own->element_begin[v]; i < own->element_begin[v + 1]; i++) {
        int32_t element = own->elements[i];
        if (element < triangle_count)
            subtract_triangle(forces, own, element, position, time, place, force);
        else if (element - triangle_count < pel_shell_elastic_hinges(own->shell))
            subtract_hinge(forces, own->shell, element - triangle_count, position, place, force);
    }
}

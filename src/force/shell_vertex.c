/* What the shell of a body does at its vertices, for measures and for the criterion of refinement. */
#include "force/shell_body.h"
#include "math/vec3.h"

#include <string.h>

/* the row of a place: its number in the mesh or forest, or what output_vertex says of that */
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

void pel_shell_add_virials(const pel_shell_forces *forces, int32_t body, const int32_t *output_vertex,
                           const pel_record *position, double time, double *virials)
{
    const pel_shell_body *own = pel_shell_body_of(forces, body);
    const row_map map = {forces != NULL ? forces->model->mesh_vertex : NULL, output_vertex};
    for (int32_t t = 0; own != NULL && t < own->shell->triangle_count; t++) {
        const int32_t *vertices = own->shell->triangles[t].vertices;
        double x[3][3], rows[3][3] = {{0}}, side[3], sum = 0;
        pel_load_points(position, vertices, 3, x);
        pel_shell_membrane_energy(own, t, (const double(*)[3])x, rows);
        pel_shell_fibre_energies(own, t, time, (const double(*)[3])x, rows);
        for (int i = 1; i < 3; i++) {
            pel_vec3_subtract(x[i], x[0], side);
            sum -= pel_vec3_dot(rows[i], side);
        }
        share(sum, vertices, 3, &map, virials);
    }
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
    const row_map rows = {forces->model->mesh_vertex, output_vertex};
    double x[4][3];
    for (int32_t t = 0; t < shell->triangle_count; t++) {
        const pel_shell_triangle *triangle = &shell->triangles[t];
        pel_load_points(position, triangle->vertices, 3, x);
        share(pel_shell_membrane_energy(own, t, (const double(*)[3])x, NULL), triangle->vertices, 3, &rows, membrane);
        share(pel_shell_fibre_energies(own, t, time, (const double(*)[3])x, NULL), triangle->vertices, 3, &rows,
              fibres);
    }
    for (int32_t i = 0; i < shell->hinge_count; i++) {
        const pel_shell_hinge *hinge = &shell->hinges[i];
        pel_load_points(position, hinge->vertices, 4, x);
        double energy =
            pel_shell_hinge_factor(shell, hinge) * pel_shell_hinge_energy(shell, hinge, (const double(*)[3])x, NULL);
        share(energy, hinge->vertices, 4, &rows, bending);
    }
}

/* ---- one vertex ---- */

/* elastic force of one element on one of its corners */
static void element_force(const pel_shell_body *own, const pel_record *position, double time, int32_t row,
                          double force[3])
{
    const pel_shell *shell = own->shell;
    double x[4][3], rows[4][3] = {{0}};
    if ((size_t)row >= own->first_hinge_row) {
        row -= (int32_t)own->first_hinge_row;
        const pel_shell_hinge *hinge = &shell->hinges[own->hinge_at[pel_lane_of(row, 4)]];
        pel_load_points(position, hinge->vertices, 4, x);
        pel_shell_hinge_energy(shell, hinge, (const double(*)[3])x, rows);
        pel_vec3_scale(rows[pel_corner_of(row, 4)], -pel_shell_hinge_factor(shell, hinge), force);
        return;
    }
    int32_t t = own->triangle_at[pel_lane_of(row, 3)];
    pel_load_points(position, shell->triangles[t].vertices, 3, x);
    pel_shell_membrane_energy(own, t, (const double(*)[3])x, rows);
    pel_shell_fibre_energies(own, t, time, (const double(*)[3])x, rows);
    pel_vec3_copy(rows[pel_corner_of(row, 3)], force);
}

void pel_shell_elastic_force_at(const pel_shell_forces *forces, int32_t body, const pel_record *position, double time,
                                int32_t place, double force[3])
{
    const pel_shell_body *own = pel_shell_body_of(forces, body);
    pel_vec3_set(force, 0, 0, 0);
    if (own == NULL)
        return;
    int32_t v = place - own->first_place;
    for (int32_t i = own->gather_begin[v]; i < own->gather_begin[v + 1]; i++) {
        double part[3];
        element_force(own, position, time, own->gather[i], part);
        pel_vec3_add(force, part, force);
    }
}

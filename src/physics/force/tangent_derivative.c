/* Derivatives of m . g, the product of a vector m of unknowns with the gradient g of the last evaluation, by the
   numbers of the elements, for an adjoint solution m. Factors of stiffness are exact, as the gradient is linear in
   them. Poisson's ratio and rest positions enter few numbers of each element: differences of fourth order of that
   element's own product, with a relative error of some 1e-11. */
#include "base/assert.h"
#include "force/shell_body.h"
#include "force/tangent_body.h"
#include "math/vec3.h"

#include <math.h>
#include <string.h>

/* of the length of an edge, and of 1 */
#define STEP 1e-3

typedef struct triangle_numbers {
    pel_rest_triangle rest;
    pel_membrane_law law;
    double stiffness; /* of bending */
    pel_plate plate;
} triangle_numbers;

/* the triangle at hand */
typedef struct triangle {
    const pel_tangent *tangent;
    const pel_tangent_shell *own;
    int32_t t;
    double x[9], m[PEL_TANGENT_UNKNOWNS], alpha[3], sign[3];
    int32_t edges[3];
} triangle;

static double product(const double *a, const double *b, int count)
{
    double sum = 0;
    for (int i = 0; i < count; i++)
        sum += a[i] * b[i];
    return sum;
}

static void load_triangle(const pel_tangent *tangent, const pel_tangent_shell *own, int32_t t, const double *m,
                          triangle *at)
{
    PEL_ASSERT_INDEX(t, own->shell->triangle_count);
    size_t positions = 3 * (size_t)tangent->pattern.vertex_count;
    const double *xi = tangent->input.unknowns + positions;
    *at = (triangle){.tangent = tangent, .own = own, .t = t};
    pel_tangent_points(tangent->input.unknowns, own->shell->corners[t], 3, at->x);
    pel_tangent_points(m, own->shell->corners[t], 3, at->m);
    for (int k = 0; own->midedges != NULL && k < 3; k++) {
        int32_t e = at->edges[k] = pel_tangent_edge_of(own->edges[t][k], &at->sign[k]);
        at->alpha[k] = tangent->half_angles[e] + at->sign[k] * xi[e];
        at->m[9 + k] = m[positions + (size_t)e];
    }
}

static triangle_numbers numbers_of(const triangle *at)
{
    const pel_shell *shell = at->own->shell;
    return (triangle_numbers){.rest = at->own->rests[at->t],
                              .law = pel_shell_law(shell, at->t),
                              .stiffness = at->own->midedges != NULL ? shell->parts[at->t].stiffness : 0,
                              .plate = pel_shell_plate(shell, at->t)};
}

static double membrane_product(const triangle *at, const triangle_numbers *numbers)
{
    double gradient[9] = {0};
    const pel_tangent_request request = {.kind = PEL_TANGENT_EXACT};
    const pel_tangent_sum sum = {.gradient = gradient};
    if (!at->own->shell->has_membrane)
        return 0;
    pel_membrane_tangent(&numbers->rest, &numbers->law, at->x, &request, &sum);
    return product(at->m, gradient, 9);
}

static double bending_product(const triangle *at, const triangle_numbers *numbers, const double alpha[3])
{
    double gradient[PEL_TANGENT_UNKNOWNS] = {0};
    const pel_tangent_request request = {.kind = PEL_TANGENT_EXACT};
    const pel_tangent_sum sum = {.gradient = gradient};
    if (at->own->midedges == NULL)
        return 0;
    const pel_midedge element = pel_midedge_setup(&numbers->rest, numbers->stiffness, &numbers->plate);
    pel_midedge_tangent(&element, alpha, at->sign, at->x, &request, &sum);
    return product(at->m, gradient, PEL_TANGENT_UNKNOWNS);
}

static double pressure_product(const triangle *at)
{
    double gradient[9] = {0},
           weight = at->own->shell->pressure_weights != NULL ? at->own->shell->pressure_weights[at->t] : 1;
    const pel_tangent_request request = {.kind = PEL_TANGENT_EXACT};
    const pel_tangent_sum sum = {.gradient = gradient};
    pel_pressure_tangent(weight * at->own->pressure, at->x, &request, &sum);
    return product(at->m, gradient, 9);
}

/* f'(0) from f at -2 h, -h, h, 2 h */
static double slope_of(const double f[4], double h)
{
    return (8 * (f[2] - f[1]) - (f[3] - f[0])) / (12 * h);
}

static const double places[4] = {-2, -1, 1, 2};

/* ---- Poisson's ratio ---- */

/* The numbers of a material in place of those of a triangle. The stiffness of an isotropic plate keeps its value: its
   derivative is known. */
static void move_poisson(const pel_shell *shell, const pel_membrane_material *material, triangle_numbers *numbers)
{
    const pel_plate kept = numbers->plate;
    const pel_membrane_law before = numbers->law;
    const bool is_oriented = pel_law_is_oriented(pel_membrane_law_traits(before.kind));
    numbers->law = pel_membrane_law_of(material);
    if (is_oriented && shell->bends_as_membrane) {
        const double along = pel_membrane_law_along(&shell->law) * before.modulus / shell->law.modulus;
        numbers->plate = pel_shell_plate_of(&numbers->law);
        numbers->stiffness *= pel_membrane_law_along(&numbers->law) / along;
    } else {
        const double now = shell->law.poisson;
        const double poisson = shell->has_membrane ? numbers->law.poisson : material->poisson;
        const double root = sqrt(kept.across);
        numbers->plate.coupling = poisson * root;
        numbers->plate.twist = kept.twist * (1 - poisson) / (1 - now);
    }
    for (int i = 0; i < PEL_LAW_AXIS; i++)
        numbers->plate.axis[i] = kept.axis[i];
    for (int i = 0; is_oriented && i < PEL_LAW_AXIS; i++)
        numbers->law.numbers[i] = before.numbers[i];
}

static double poisson_slope(const triangle *at, const triangle_numbers *numbers)
{
    const pel_shell *shell = at->own->shell;
    pel_shell_sheet sheet = pel_shell_sheet_of(shell, at->t);
    double f[4];
    for (int i = 0; i < 4; i++) {
        pel_membrane_material material = shell->material;
        triangle_numbers moved = *numbers;
        material.poisson += places[i] * STEP;
        material.young = sheet.young;
        material.thickness = sheet.thickness;
        move_poisson(shell, &material, &moved);
        f[i] = membrane_product(at, &moved) + bending_product(at, &moved, at->alpha);
    }
    return slope_of(f, STEP);
}

/* ---- rest positions ---- */

/* the warp of a triangle with its corners at x */
static void move_axis(const triangle *at, const double x[3][3], triangle_numbers *numbers)
{
    const pel_shell *shell = at->own->shell;
    double along[3];
    if (shell->axes == NULL)
        return;
    pel_shell_warp(shell, at->t, x, along);
    pel_rest_triangle_direction(x, along, numbers->plate.axis);
    for (int i = 0; i < PEL_LAW_AXIS && pel_law_is_oriented(pel_membrane_law_traits(shell->law.kind)); i++)
        numbers->law.numbers[i] = numbers->plate.axis[i];
}

static void rest_slopes(const triangle *at, const triangle_numbers *numbers, double *rest)
{
    const int32_t *v = at->own->shell->corners[at->t];
    double corners[3][3];
    for (int k = 0; k < 3; k++)
        pel_vertex_position(at->tangent->model->rest, v[k], corners[k]);
    double h = STEP * pel_vec3_distance(corners[0], corners[1]);
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < 3; c++) {
            double f[4], kept = corners[k][c];
            for (int i = 0; i < 4; i++) {
                triangle_numbers moved = *numbers;
                corners[k][c] = kept + places[i] * h;
                pel_rest_triangle_setup((const double(*)[3])corners, &moved.rest);
                move_axis(at, (const double(*)[3])corners, &moved);
                f[i] = membrane_product(at, &moved) + bending_product(at, &moved, at->alpha);
            }
            corners[k][c] = kept;
            rest[3 * (size_t)v[k] + (size_t)c] += slope_of(f, h);
        }
}

/* effect of rest angles, through alpha = (theta - theta_rest) / 2 +- xi; the product is linear in alpha */
static void add_angle_slopes(const triangle *at, const triangle_numbers *numbers, double *by_angle)
{
    double now = bending_product(at, numbers, at->alpha);
    for (int k = 0; at->own->midedges != NULL && k < 3; k++) {
        double alpha[3];
        memcpy(alpha, at->alpha, sizeof alpha);
        alpha[k] += 1;
        by_angle[at->edges[k]] -= 0.5 * (bending_product(at, numbers, alpha) - now);
    }
}

/* of the angle between two triangles at rest; curls multiply it */
static void angle_slopes(const pel_tangent *tangent, const pel_tangent_shell *own, const pel_tangent_edge *edge,
                         double by_angle, double *rest)
{
    double x[4][3];
    const pel_shell_part_bending *parts = own->shell->parts;
    double curl = 0.5 * (parts[edge->triangles[0]].curl + parts[edge->triangles[1]].curl);
    for (int k = 0; k < 4; k++)
        pel_vertex_position(tangent->model->rest, edge->vertices[k], x[k]);
    double h = STEP * pel_vec3_distance(x[0], x[1]);
    for (int k = 0; k < 4; k++)
        for (int c = 0; c < 3; c++) {
            double f[4], kept = x[k][c];
            for (int i = 0; i < 4; i++) {
                pel_hinge stencil;
                x[k][c] = kept + places[i] * h;
                pel_hinge_setup((const double(*)[3])x, &stencil);
                f[i] = stencil.rest_angle;
            }
            x[k][c] = kept;
            rest[3 * (size_t)edge->vertices[k] + (size_t)c] += by_angle * curl * slope_of(f, h);
        }
}

/* m . g of all hinges of a body; none with mid-edge bending */
static double hinges_product(const pel_tangent *tangent, const pel_tangent_shell *own, const double *m)
{
    const pel_shell *shell = own->shell;
    double sum = 0;
    for (int32_t i = 0; own->midedges == NULL && i < shell->hinge_count; i++) {
        const pel_shell_hinge hinge = pel_shell_hinge_of(shell, i);
        double x[12], gradient[4][3], moved[12];
        pel_tangent_points(tangent->input.unknowns, hinge.vertices, 4, x);
        pel_tangent_points(m, hinge.vertices, 4, moved);
        pel_shell_hinge_energy(shell, tangent->model->rest, &hinge, (const double(*)[3])x, gradient);
        sum += pel_shell_hinge_factor(shell, &hinge) * product(moved, &gradient[0][0], 12);
    }
    return sum;
}

/* m . g of all tetrahedra of a body */
static double tetrahedra_product(const pel_tangent *tangent, const pel_tangent_shell *own, const double *m)
{
    const pel_shell *shell = own->shell;
    const pel_stars *stars = shell->stars;
    const int32_t count = stars != NULL ? stars->count : shell->tetrahedron_count;
    double sum = 0, x[3 * PEL_STAR_NODES], moved[3 * PEL_STAR_NODES];
    for (int32_t e = 0; e < count; e++) {
        const int32_t *nodes = stars != NULL ? stars->nodes + stars->begin[e] : shell->tetrahedra[e];
        const int nodes_here = stars != NULL ? stars->begin[e + 1] - stars->begin[e] : 4;
        double gradient[3 * PEL_STAR_NODES] = {0};
        const pel_tangent_sum adds = {.gradient = gradient};
        pel_tangent_points(tangent->input.unknowns, nodes, nodes_here, x);
        pel_tangent_points(m, nodes, nodes_here, moved);
        if (stars != NULL)
            pel_star_tangent(stars, e, &shell->solid, x, PEL_TANGENT_EXACT, &adds);
        else
            pel_tetra_tangent(&own->tetras[e], &shell->solid, own->tetra_scales[e], x, PEL_TANGENT_EXACT, &adds);
        sum += product(moved, gradient, 3 * nodes_here);
    }
    return sum;
}

/* ---- all elements ---- */

void pel_tangent_derivatives(const pel_tangent *tangent, const double *m, pel_tangent_derivative *bodies, double *rest)
{
    double *by_angle = tangent->settle[0];
    memset(by_angle, 0, (size_t)tangent->pattern.edge_count * sizeof *by_angle);
    for (int32_t s = 0; s < tangent->shell_count; s++) {
        const pel_tangent_shell *own = &tangent->shells[s];
        pel_tangent_derivative *sum = &bodies[own->body];
        sum->bending += hinges_product(tangent, own, m);
        sum->volume += tetrahedra_product(tangent, own, m);
        for (int32_t t = 0; t < own->shell->triangle_count; t++) {
            triangle at;
            load_triangle(tangent, own, t, m, &at);
            const triangle_numbers numbers = numbers_of(&at);
            sum->membrane += membrane_product(&at, &numbers);
            sum->bending += bending_product(&at, &numbers, at.alpha);
            sum->poisson += poisson_slope(&at, &numbers);
            if (own->pressure != 0)
                sum->pressure += pressure_product(&at);
            if (rest == NULL)
                continue;
            rest_slopes(&at, &numbers, rest);
            add_angle_slopes(&at, &numbers, by_angle);
        }
    }
    for (int32_t e = 0; rest != NULL && e < tangent->pattern.edge_count; e++) {
        const pel_tangent_edge *edge = &tangent->edges[e];
        const pel_tangent_shell *own = tangent->shells;
        while (own->body != edge->body)
            own++;
        if (edge->triangles[1] >= 0)
            angle_slopes(tangent, own, edge, by_angle[e], rest);
    }
}

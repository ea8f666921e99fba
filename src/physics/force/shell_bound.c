/* Upper bound of the stiffness of shells over the mass, for the limits of explicit methods. */
#include "force/shell_body.h"
#include "math/extremes.h"
#include "math/functions.h"
#include "math/vec3.h"
#include "measure/element.h"
#include "model/shell.h"

#include <math.h>
#include <string.h>

/* adds to each vertex of an element the norms of its row of blocks, which are at most stiffness |g_a| |g_b| */
static void add_norms(double stiffness, const int32_t *vertices, int count, const double *norms, int32_t first,
                      double *sums)
{
    double total = 0;
    for (int i = 0; i < count; i++)
        total += norms[i];
    for (int i = 0; i < count; i++)
        sums[vertices[i] - first] += stiffness * norms[i] * total;
}

/* |d F / d x_a| of a rest triangle */
static void strain_norms(const pel_rest_triangle *rest, double norms[3])
{
    const double *i = rest->inverse;
    norms[0] = pel_hypot(i[0], i[1]);
    norms[1] = fabs(i[2]);
    norms[2] = pel_hypot(i[0], i[1] + i[2]);
}

static void add_hinge_norms(const pel_shell *shell, const pel_record *rest, const pel_shell_hinge *hinge, int32_t first,
                            double *sums)
{
    double norms[4], gradient[4][3], x[4][3], factor = pel_shell_hinge_factor(shell, hinge);
    if (shell->bending->is_angle) {
        pel_load_points(rest, hinge->vertices, 4, x);
        pel_dihedral_angle((const double(*)[3])x, gradient);
        for (int a = 0; a < 4; a++)
            norms[a] = pel_vec3_length(gradient[a]);
        factor *= pel_shell_angle(shell, rest, hinge).factor;
    } else {
        const pel_bending_isometric stencil = pel_shell_isometric(rest, hinge);
        for (int a = 0; a < 4; a++)
            norms[a] = fabs(stencil.weight[a]);
        factor *= stencil.factor;
    }
    add_norms(factor, hinge->vertices, 4, norms, first, sums);
}

/* largest size of a curve's values */
static double curve_size(const pel_curve *curve)
{
    double size = curve->key_count > 0 ? 0 : 1;
    for (int32_t k = 0; k < curve->key_count; k++)
        size = pel_max(size, fabs(curve->keys[k].value));
    return size;
}

/* the largest size that the pressure difference takes near rest [Pa] */
static double pressure_size(const pel_shell *shell)
{
    const pel_pressure_def *def = &shell->pressure;
    double given = def->kind != PEL_PRESSURE_NONE ? fabs(def->outside.value) * curve_size(&shell->outside) : 0;
    if (def->kind != PEL_PRESSURE_VOLUME)
        return given;
    return given + def->bulk * pel_max(1, fabs(def->target.value) * curve_size(&shell->target) - 1);
}

static void add_pressure_norms(const pel_shell_body *own, int32_t t, const double x[3][3], double *sums)
{
    const pel_shell *shell = own->shell;
    double size = pressure_size(shell) * (shell->pressure_weights != NULL ? fabs(shell->pressure_weights[t]) : 1);
    double edges = pel_vec3_distance(x[0], x[1]) + pel_vec3_distance(x[1], x[2]) + pel_vec3_distance(x[2], x[0]);
    for (int i = 0; i < 3; i++)
        sums[shell->corners[t][i] - own->first_place] += size * edges / 6;
}

/* contribution of a pressure that changes with the volume: the eigenvalue c sum |g|^2 / m of c g g^T / m, with its
   slope c and the gradient g of the volume. sums is scratch */
static double volume_bound(const pel_model *model, const pel_shell_body *own, double *sums)
{
    const pel_shell *shell = own->shell;
    const pel_pressure_def *def = &shell->pressure;
    double slope = def->kind == PEL_PRESSURE_GAS      ? def->gamma * def->value
                   : def->kind == PEL_PRESSURE_VOLUME ? def->bulk
                                                      : 0;
    if (slope == 0)
        return 0;
    memset(sums, 0, (size_t)own->place_count * sizeof *sums);
    for (int32_t t = 0; t < shell->triangle_count; t++) {
        double weight = shell->pressure_weights != NULL ? fabs(shell->pressure_weights[t]) : 1;
        double area = pel_shell_rest(shell, t).area;
        for (int i = 0; i < 3; i++)
            sums[shell->corners[t][i] - own->first_place] += weight * area / 3;
    }
    double sum = 0;
    for (int32_t v = 0; v < own->place_count; v++)
        sum += sums[v] * sums[v] * (double)model->inverse_mass[own->first_place + v];
    return slope / model->bodies[own->body].rest_volume * sum;
}

static void add_triangle(const pel_shell_body *own, int32_t t, double stiffness, double *sums)
{
    const pel_rest_triangle rest = pel_shell_rest(own->shell, t);
    double norms[3];
    strain_norms(&rest, norms);
    add_norms(rest.area * stiffness, own->shell->corners[t], 3, norms, own->first_place, sums);
}

static void add_tetra(const pel_model *model, const pel_shell_body *own, int32_t t, double unit, double *sums)
{
    pel_rest_tetra rest;
    double norms[4];
    const double scale = pel_filled_rest(own->shell, model->rest, t, &rest);
    for (int k = 0; k < 4; k++)
        norms[k] = pel_vec3_length(rest.gradients[k]);
    add_norms(scale * unit, own->shell->tetrahedra[t], 4, norms, own->first_place, sums);
}

/* largest stiffness of materials, fibres, bending and pressure at rest [N/m] */
static double body_bound(const pel_model *model, const pel_shell_body *own, double *sums)
{
    const pel_shell *shell = own->shell;
    double bound = 0, volume = volume_bound(model, own, sums), x[3][3];
    const double unit = pel_membrane_law_stiffness(&shell->law);
    memset(sums, 0, (size_t)own->place_count * sizeof *sums);
    for (int32_t t = 0; t < shell->triangle_count; t++) {
        pel_shell_sheet sheet = pel_shell_sheet_of(shell, t);
        pel_load_points(model->rest, shell->corners[t], 3, x);
        if (shell->has_membrane)
            add_triangle(own, t, unit * sheet.young * sheet.thickness, sums);
        add_pressure_norms(own, t, (const double(*)[3])x, sums);
    }
    for (int32_t r = 0; r < shell->region_count; r++) {
        const pel_shell_region *region = &shell->regions[r];
        double stiffness = region->def.stiffness * pel_fibre_law_stiffness(region->def.kind);
        for (int32_t i = 0; i < pel_shell_fibre_count(region); i++)
            add_triangle(own, pel_shell_fibre_triangle(region, i), stiffness * pel_shell_fibre_weight(region, i), sums);
    }
    for (int32_t i = 0; i < shell->hinge_count; i++) {
        const pel_shell_hinge hinge = pel_shell_hinge_of(shell, i);
        add_hinge_norms(shell, model->rest, &hinge, own->first_place, sums);
    }
    for (int32_t t = 0; t < shell->tetrahedron_count; t++)
        add_tetra(model, own, t, pel_solid_law_stiffness(&shell->solid), sums);
    for (int32_t v = 0; v < own->place_count; v++)
        bound = pel_max(bound, sums[v] * (double)model->inverse_mass[own->first_place + v]);
    return bound + volume;
}

double pel_shell_stiffness_bound(const pel_shell_forces *forces)
{
    double bound = 0;
    for (int32_t b = 0; forces != NULL && b < forces->model->body_count; b++)
        if (forces->bodies[b].shell != NULL)
            bound = pel_max(bound, body_bound(forces->model, &forces->bodies[b], forces->sums));
    return bound;
}

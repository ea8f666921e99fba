#include "force/shell_body.h"
#include "math/vec3.h"
#include "measure/element.h"

double pel_shell_hinge_factor(const pel_shell *shell, const pel_shell_hinge *hinge)
{
    return shell->bending == PEL_BENDING_HINGE ? hinge->stiffness : hinge->stiffness / 3;
}

static double fibre_energy(const pel_shell_body *own, const pel_rest_triangle *rest, const pel_triangle_fibre *fibre,
                           double time, const double x[3][3], double gradient[3][3])
{
    const pel_shell_region *region = &own->shell->regions[fibre->region];
    if (region->def.mode == PEL_FIBRE_STRAIN)
        return pel_fibre_energy(rest, region->def.kind, fibre->stiffness, fibre->direction, x, gradient);
    double length =
        region->def.rest_length.value * pel_curve_value(region->rest_length.keys, region->rest_length.key_count, time);
    return pel_fibre_active_energy(rest, fibre->stiffness, length, fibre->direction, x, gradient);
}

static void subtract_rows(double rows[][3], double gradient[][3], int count)
{
    for (int i = 0; i < count; i++)
        pel_vec3_subtract(rows[i], gradient[i], rows[i]);
}

pel_membrane_law pel_shell_law(const pel_shell_body *own, int32_t t)
{
    pel_membrane_law law = own->law;
    law.modulus *= own->shell->triangles[t].young * own->shell->triangles[t].thickness;
    return law;
}

double pel_shell_membrane_energy(const pel_shell_body *own, int32_t t, const double x[3][3], double rows[3][3])
{
    const pel_shell *shell = own->shell;
    if (!shell->has_membrane)
        return 0;
    const pel_membrane_law law = pel_shell_law(own, t);
    double gradient[3][3];
    if (rows == NULL)
        return pel_membrane_law_energy(&shell->triangles[t].rest, &law, x, NULL);
    double energy = pel_membrane_law_energy(&shell->triangles[t].rest, &law, x, gradient);
    subtract_rows(rows, gradient, 3);
    return energy;
}

double pel_shell_fibre_energies(const pel_shell_body *own, int32_t t, double time, const double x[3][3],
                                double rows[3][3])
{
    double sum = 0, gradient[3][3];
    if (own->fibre_begin == NULL)
        return 0;
    for (int32_t i = own->fibre_begin[t]; i < own->fibre_begin[t + 1]; i++) {
        const pel_rest_triangle *rest = &own->shell->triangles[t].rest;
        sum += fibre_energy(own, rest, &own->fibres[i], time, x, rows != NULL ? gradient : NULL);
        if (rows != NULL)
            subtract_rows(rows, gradient, 3);
    }
    return sum;
}

double pel_shell_hinge_energy(const pel_shell *shell, const pel_shell_hinge *hinge, const double x[4][3],
                              double gradient[4][3])
{
    if (shell->bending == PEL_BENDING_HINGE)
        return pel_hinge_energy(&hinge->hinge, x, gradient);
    pel_bending_form form = shell->bending == PEL_BENDING_ISOMETRIC ? PEL_BENDING_LITERAL : PEL_BENDING_REST_SUBTRACTED;
    return pel_bending_isometric_energy(&hinge->isometric, form, x, gradient);
}

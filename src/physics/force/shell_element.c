#include "base/assert.h"
#include "force/shell_body.h"
#include "math/vec3.h"
#include "measure/element.h"

double pel_shell_hinge_factor(const pel_shell *shell, const pel_shell_hinge *hinge)
{
    return shell->bending->is_angle ? hinge->stiffness : hinge->stiffness / 3;
}

double pel_shell_fibre_amount(const pel_shell_region *region, double time)
{
    const pel_curve *curve = &region->course;
    if (region->def.mode != PEL_FIBRE_ACTIVE && region->def.mode != PEL_FIBRE_MUSCLE)
        return 1;
    return region->amount * pel_curve_value(curve->keys, curve->key_count, time);
}

double pel_shell_fibre_energy(const pel_shell *shell, const pel_shell_region *region, int32_t i, double time,
                              const double x[3][3], double gradient[3][3])
{
    PEL_ASSERT_INDEX(i, region->fibre_count);
    pel_shell_fibre fibre = pel_shell_fibre_of(shell, region, i);
    const pel_rest_triangle rest = pel_shell_rest(shell, fibre.triangle);
    double stiffness = region->def.stiffness * fibre.weight;
    if (region->def.direction == PEL_FIBRE_PRINCIPAL)
        pel_principal_direction(&rest, x, fibre.direction);
    if (region->def.mode == PEL_FIBRE_STRAIN)
        return pel_fibre_energy(&rest, region->def.kind, stiffness, fibre.direction, x, gradient);
    const double amount = pel_shell_fibre_amount(region, time);
    if (region->def.mode == PEL_FIBRE_MUSCLE)
        return pel_muscle_energy(&rest, amount * stiffness, region->def.optimum, region->def.width, fibre.direction, x,
                                 gradient);
    return pel_fibre_active_energy(&rest, stiffness, amount, fibre.direction, x, gradient);
}

int32_t pel_shell_find_fibre(const pel_shell_region *region, int32_t triangle)
{
    int32_t low = 0, count = pel_shell_fibre_count(region), high = count;
    while (low < high) {
        int32_t middle = low + (high - low) / 2;
        if (pel_shell_fibre_triangle(region, middle) < triangle)
            low = middle + 1;
        else
            high = middle;
    }
    return low < count && pel_shell_fibre_triangle(region, low) == triangle ? low : -1;
}

double pel_shell_membrane_energy(const pel_shell_forces *forces, const pel_shell_body *own, int32_t t,
                                 const double x[3][3], double gradient[3][3])
{
    const pel_membrane_law law = pel_shell_law_now(own->shell, t, forces->plastic.flows);
    const pel_rest_triangle rest = pel_shell_rest_now(own->shell, t, forces->plastic.flows);
    return pel_membrane_law_energy(&rest, &law, x, gradient);
}

double pel_shell_hinge_energy(const pel_shell *shell, const pel_record *rest, const pel_shell_hinge *hinge,
                              const double x[4][3], double gradient[4][3])
{
    if (shell->bending->is_angle) {
        const pel_hinge stencil = pel_shell_angle(shell, rest, hinge);
        return pel_hinge_energy(&stencil, x, gradient);
    }
    const pel_bending_isometric stencil = pel_shell_isometric(rest, hinge);
    return pel_bending_isometric_energy(&stencil, shell->bending->form, x, gradient);
}

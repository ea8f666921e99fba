#include "pellicle/material.h"

#include "math/vec3.h"

/* P = d psi / d F = scale (F a) a^T */
static void fibre_stress(double scale, const double image[3], const double direction[2], double first_piola[6])
{
    for (int i = 0; i < 3; i++) {
        first_piola[2 * i] = scale * image[i] * direction[0];
        first_piola[2 * i + 1] = scale * image[i] * direction[1];
    }
}

/* F a */
static void fibre_image(const double f[6], const double a[2], double image[3])
{
    for (int i = 0; i < 3; i++)
        image[i] = f[2 * i] * a[0] + f[2 * i + 1] * a[1];
}

double pel_fibre_active_density(double stiffness, double rest_length, const double direction[2],
                                const double deformation_gradient[6], double first_piola[6])
{
    double image[3];
    fibre_image(deformation_gradient, direction, image);
    double length = pel_vec3_length(image), stretch = length - rest_length;
    if (first_piola != NULL)
        fibre_stress(length > 0 ? stiffness * stretch / length : 0, image, direction, first_piola);
    return 0.5 * stiffness * stretch * stretch;
}

double pel_fibre_density(pel_fibre_kind kind, double stiffness, const double direction[2],
                         const double deformation_gradient[6], double first_piola[6])
{
    if (kind != PEL_FIBRE_STVK)
        return pel_fibre_active_density(stiffness, 1, direction, deformation_gradient, first_piola);
    double image[3];
    fibre_image(deformation_gradient, direction, image);
    double strain = pel_vec3_squared_length(image) - 1;
    if (first_piola != NULL)
        fibre_stress(2 * stiffness * strain, image, direction, first_piola);
    return 0.5 * stiffness * strain * strain;
}

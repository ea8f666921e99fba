#include "observe/field_mechanics.h"

#include "math/functions.h"
#include "math/vec3.h"
#include "observe/field.h"

#include <string.h>

void pel_field_mechanics_of(const pel_triangle_mechanics *numbers, const int32_t *triangles, int32_t triangle_count,
                            const double *rest, const double *positions, pel_field_mechanics *made)
{
    for (int32_t t = 0; t < triangle_count; t++) {
        const int32_t *v = triangles + 3 * (size_t)t;
        const size_t a = 3 * (size_t)v[0], b = 3 * (size_t)v[1], c = 3 * (size_t)v[2];
        made[t].numbers = numbers[t];
        pel_vec3_triangle_normal(rest + a, rest + b, rest + c, made[t].rest_normal);
        pel_vec3_triangle_normal(positions + a, positions + b, positions + c, made[t].normal);
        pel_vec3_normalize(made[t].rest_normal);
        pel_vec3_normalize(made[t].normal);
    }
}

static void add_scaled(const double *values, int count, double scale, double *sums)
{
    for (int k = 0; k < count; k++)
        sums[k] += scale * values[k];
}

static void add_triangle(const pel_field_mechanics *from, pel_field_mechanics *to)
{
    const pel_triangle_mechanics *n = &from->numbers;
    pel_triangle_mechanics *s = &to->numbers;
    const double now = n->area, rest = n->rest_area;
    s->area += now;
    s->rest_area += rest;
    s->thickness += now * n->thickness;
    s->membrane_energy += rest * n->membrane_energy;
    s->fibre_energy += rest * n->fibre_energy;
    s->bending_energy += rest * n->bending_energy;
    add_scaled(n->strain, 6, rest, s->strain);
    add_scaled(n->piola_stress, 6, rest, s->piola_stress);
    add_scaled(n->force, 6, now, s->force);
    add_scaled(n->moment, 6, now, s->moment);
    add_scaled(from->rest_normal, 3, rest, to->rest_normal);
    add_scaled(from->normal, 3, now, to->normal);
}

static void divide(double *values, int count, double by)
{
    for (int k = 0; by > 0 && k < count; k++)
        values[k] /= by;
}

void pel_field_mechanics_smooth(const pel_field_mechanics *made, const int32_t *triangles, int32_t triangle_count,
                                int32_t vertex_count, pel_field_mechanics *smooth)
{
    memset(smooth, 0, (size_t)vertex_count * sizeof *smooth);
    for (int32_t t = 0; t < triangle_count; t++)
        for (int k = 0; k < 3; k++)
            add_triangle(&made[t], &smooth[triangles[3 * (size_t)t + (size_t)k]]);
    for (int32_t v = 0; v < vertex_count; v++) {
        pel_triangle_mechanics *s = &smooth[v].numbers;
        divide(&s->thickness, 1, s->area);
        divide(&s->membrane_energy, 1, s->rest_area);
        divide(&s->fibre_energy, 1, s->rest_area);
        divide(&s->bending_energy, 1, s->rest_area);
        divide(s->strain, 6, s->rest_area);
        divide(s->piola_stress, 6, s->rest_area);
        divide(s->force, 6, s->area);
        divide(s->moment, 6, s->area);
        pel_vec3_normalize(smooth[v].rest_normal);
        pel_vec3_normalize(smooth[v].normal);
    }
}

/* ---- fields ---- */

/* principal values of a tensor (xx, yy, zz, xy, yz, xz) in the plane of a normal, larger first, and the unit direction
   of the first */
static void find_principal(const double tensor[6], const double normal[3], double values[2], double direction[3])
{
    const double rows[3][3] = {
        {tensor[0], tensor[3], tensor[5]}, {tensor[3], tensor[1], tensor[4]}, {tensor[5], tensor[4], tensor[2]}};
    /* axes in the plane, the first away from the axis of space that is nearest to the normal */
    int least = fabs(normal[0]) <= fabs(normal[1]) && fabs(normal[0]) <= fabs(normal[2]) ? 0
                : fabs(normal[1]) <= fabs(normal[2])                                     ? 1
                                                                                         : 2;
    double axis[2][3] = {{0}}, image[2][3];
    axis[0][least] = 1;
    pel_vec3_along(axis[0], -normal[least], normal, axis[0]);
    pel_vec3_normalize(axis[0]);
    pel_vec3_cross(normal, axis[0], axis[1]);
    for (int a = 0; a < 2; a++)
        for (int i = 0; i < 3; i++)
            image[a][i] = pel_vec3_dot(rows[i], axis[a]);
    double a = pel_vec3_dot(axis[0], image[0]), b = pel_vec3_dot(axis[1], image[1]);
    double c = pel_vec3_dot(axis[0], image[1]), mean = 0.5 * (a + b), size = pel_hypot(0.5 * (a - b), c);
    double angle = 0.5 * pel_atan2(2 * c, a - b);
    values[0] = mean + size;
    values[1] = mean - size;
    for (int i = 0; i < 3; i++)
        direction[i] = pel_cos(angle) * axis[0][i] + pel_sin(angle) * axis[1][i];
}

/* membrane stress, plus bending stress on one side */
static void find_stress(const pel_triangle_mechanics *numbers, double side, double stress[6])
{
    double h = numbers->thickness;
    for (int k = 0; k < 6; k++)
        stress[k] = h > 0 ? numbers->force[k] / h + side * 6 * numbers->moment[k] / (h * h) : 0;
}

static double von_mises(const pel_field_mechanics *at, double side)
{
    double stress[6], values[2], direction[3];
    find_stress(&at->numbers, side, stress);
    find_principal(stress, at->normal, values, direction);
    return sqrt(values[0] * values[0] - values[0] * values[1] + values[1] * values[1]);
}

static void put_principal(const pel_field_mechanics *at, int32_t field, double *values)
{
    double stress[6], principal[2], direction[3];
    if (field == PEL_FIELD_PRINCIPAL_STRAIN) {
        find_principal(at->numbers.strain, at->rest_normal, values, direction);
        return;
    }
    find_stress(&at->numbers, 0, stress);
    find_principal(stress, at->normal, principal, direction);
    if (field == PEL_FIELD_PRINCIPAL_STRESS)
        memcpy(values, principal, sizeof principal);
    else
        memcpy(values, direction, sizeof direction);
}

void pel_field_mechanics_put(const pel_field_mechanics *at, int32_t field, double *values)
{
    const pel_triangle_mechanics *numbers = &at->numbers;
    switch (field) {
    case PEL_FIELD_STRAIN:
        memcpy(values, numbers->strain, sizeof numbers->strain);
        break;
    case PEL_FIELD_PIOLA_STRESS:
        memcpy(values, numbers->piola_stress, sizeof numbers->piola_stress);
        break;
    case PEL_FIELD_CAUCHY_STRESS:
        find_stress(numbers, 0, values);
        break;
    case PEL_FIELD_MEMBRANE_FORCE:
        memcpy(values, numbers->force, sizeof numbers->force);
        break;
    case PEL_FIELD_BENDING_MOMENT:
        memcpy(values, numbers->moment, sizeof numbers->moment);
        break;
    case PEL_FIELD_PRINCIPAL_STRAIN:
    case PEL_FIELD_PRINCIPAL_STRESS:
    case PEL_FIELD_PRINCIPAL_DIRECTION:
        put_principal(at, field, values);
        break;
    case PEL_FIELD_VON_MISES_TOP:
        *values = von_mises(at, 1);
        break;
    case PEL_FIELD_VON_MISES_BOTTOM:
        *values = von_mises(at, -1);
        break;
    case PEL_FIELD_MEMBRANE_DENSITY:
        *values = numbers->membrane_energy;
        break;
    case PEL_FIELD_BENDING_DENSITY:
        *values = numbers->bending_energy;
        break;
    case PEL_FIELD_FIBRE_DENSITY:
        *values = numbers->fibre_energy;
        break;
    default:
        break;
    }
}

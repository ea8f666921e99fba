/* A frame: symplectic Euler under the pressure, then x -= step * gradient of E_S until the energy is as low as wanted.
   The step doubles in each iteration and halves until the energy falls enough (Armijo). Velocities are displacements
   over dt, as in step 6 of the paper. */
#include "papers/b/descend.h"

#include <pellicle/error.h>
#include <pellicle/material.h>
#include <pellicle/measure.h>
#include <pellicle/topology.h>

#include <stdlib.h>
#include <string.h>

#include <math.h>

/* F = Ds inverse(Dm), with inverse(Dm) = [[a, b], [0, c]] */
typedef struct flat {
    double a, b, c, area;
} flat;

typedef struct shell {
    const pel_mesh *rest;
    flat *flats; /* (triangle_count) */
    double mu, lambda;
    double (*x)[3], (*before)[3], (*velocity)[3], (*force)[3], (*gradient)[3], (*trial)[3], *mass; /* (vertex_count) */
    double step;
} shell;

static bool create_shell(const pel_mesh *rest, const b_descent *def, shell *made)
{
    size_t count = (size_t)rest->vertex_count;
    *made = (shell){.rest = rest, .step = 1e-4};
    pel_plane_stress_lame(def->young, def->poisson, def->thickness, &made->mu, &made->lambda);
    made->flats = calloc((size_t)rest->triangle_count, sizeof *made->flats);
    made->mass = calloc(19 * count, sizeof *made->mass);
    if (made->flats == NULL || made->mass == NULL)
        return false;
    double(*vectors)[3] = (double(*)[3])(made->mass + count);
    double(**const arrays[])[3] = {&made->x,     &made->before,   &made->velocity,
                                   &made->force, &made->gradient, &made->trial};
    for (int i = 0; i < 6; i++)
        *arrays[i] = vectors + (size_t)i * count;
    memcpy(made->x, rest->positions, count * sizeof *made->x);
    for (int32_t t = 0; t < rest->triangle_count; t++) {
        const int32_t *corners = rest->triangles[t];
        double first = 0, both = 0, second = 0;
        for (int i = 0; i < 3; i++) {
            double a = made->x[corners[1]][i] - made->x[corners[0]][i],
                   b = made->x[corners[2]][i] - made->x[corners[0]][i];
            first += a * a;
            both += a * b;
            second += b * b;
        }
        double length = sqrt(first), along = both / length, height = sqrt(second - along * along);
        made->flats[t] = (flat){1 / length, -along / (length * height), 1 / height, length * height / 2};
        for (int k = 0; k < 3; k++)
            made->mass[corners[k]] += def->density * def->thickness * length * height / 6;
    }
    return true;
}

static void destroy_shell(shell *made)
{
    free(made->flats);
    free(made->mass);
}

/* E_S at x, and its gradient, which may be null */
static double energy_of(const shell *made, const double (*x)[3], double (*gradient)[3])
{
    double sum = 0;
    if (gradient != NULL)
        memset(gradient, 0, (size_t)made->rest->vertex_count * sizeof *gradient);
    for (int32_t t = 0; t < made->rest->triangle_count; t++) {
        const int32_t *corners = made->rest->triangles[t];
        const flat *at = &made->flats[t];
        double f0[3], f1[3], e11 = -1, e22 = -1, e12 = 0;
        for (int i = 0; i < 3; i++) {
            double a = x[corners[1]][i] - x[corners[0]][i], b = x[corners[2]][i] - x[corners[0]][i];
            f0[i] = a * at->a;
            f1[i] = a * at->b + b * at->c;
            e11 += f0[i] * f0[i];
            e22 += f1[i] * f1[i];
            e12 += f0[i] * f1[i];
        }
        e11 /= 2, e22 /= 2, e12 /= 2;
        double trace = e11 + e22;
        sum += at->area * (made->mu * (e11 * e11 + e22 * e22 + 2 * e12 * e12) + made->lambda / 2 * trace * trace);
        for (int i = 0; gradient != NULL && i < 3; i++) {
            double s11 = 2 * made->mu * e11 + made->lambda * trace, s22 = 2 * made->mu * e22 + made->lambda * trace,
                   s12 = 2 * made->mu * e12;
            double p0 = f0[i] * s11 + f1[i] * s12, p1 = f1[i] * s22 + f0[i] * s12;
            double first = at->area * (p0 * at->a + p1 * at->b), second = at->area * p1 * at->c;
            gradient[corners[0]][i] -= first + second;
            gradient[corners[1]][i] += first;
            gradient[corners[2]][i] += second;
        }
    }
    return sum;
}

/* one iteration; returns the energy after it */
static double descend_once(shell *made)
{
    enum { HALVINGS = 60 };
    double energy = energy_of(made, (const double(*)[3])made->x, made->gradient), slope = 0, after = energy;
    size_t numbers = 3 * (size_t)made->rest->vertex_count;
    for (size_t i = 0; i < numbers; i++)
        slope += made->gradient[0][i] * made->gradient[0][i];
    made->step *= 2;
    for (int k = 0; k < HALVINGS; k++, made->step /= 2) {
        for (size_t i = 0; i < numbers; i++)
            made->trial[0][i] = made->x[0][i] - made->step * made->gradient[0][i];
        after = energy_of(made, (const double(*)[3])made->trial, NULL);
        if (after <= energy - 1e-4 * made->step * slope)
            break;
    }
    memcpy(made->x, made->trial, numbers * sizeof made->x[0][0]);
    return after;
}

pel_status b_descend(const pel_mesh *rest, const b_descent *def, double (*positions)[3], int *iterations,
                     pel_error *error)
{
    pel_topology *topology;
    shell made;
    *iterations = 0;
    pel_status status = pel_topology_create(rest, &topology, error);
    if (status != PEL_OK)
        return status;
    if (!create_shell(rest, def, &made))
        status = pel_fail_memory(error);
    size_t count = (size_t)rest->vertex_count;
    for (int frame = 1; status == PEL_OK && frame <= def->frames; frame++) {
        memcpy(made.before, made.x, count * sizeof *made.x);
        pel_surface_pressure(topology, made.x[0], def->pressure, PEL_PRESSURE_CONSISTENT, made.force[0], NULL, NULL);
        for (size_t i = 0; i < 3 * count; i++) {
            made.velocity[0][i] += def->dt * made.force[0][i] / made.mass[i / 3];
            made.x[0][i] += def->dt * made.velocity[0][i];
        }
        double energy = energy_of(&made, (const double(*)[3])made.x, NULL);
        for (int i = 0; energy > def->energies[frame] && i < def->most; i++, ++*iterations)
            energy = descend_once(&made);
        for (size_t i = 0; i < 3 * count; i++)
            made.velocity[0][i] = (made.x[0][i] - made.before[0][i]) / def->dt;
    }
    if (status == PEL_OK)
        memcpy(positions, made.x, count * sizeof *positions);
    destroy_shell(&made);
    pel_topology_destroy(topology);
    return status;
}

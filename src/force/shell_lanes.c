/* The loops of the forces of shells over blocks of elements, all lanes at once. A lane without an element has numbers
   of zero: its energy and forces are zero. */
#include "element/bending_lane.h"
#include "force/shell_body.h"
#include "material/membrane_lane.h"

static inline pel_lane number_of(const pel_real *numbers, int count, int32_t block, int j)
{
    return pel_lane_load(numbers + ((size_t)block * (size_t)count + (size_t)j) * PEL_BLOCK, 0);
}

static inline pel_particle load_corner(const int32_t *steps, int arity, int32_t block, int k,
                                       const pel_record *positions)
{
    return pel_particle_load(positions, steps + ((size_t)block * (size_t)arity + (size_t)k) * PEL_BLOCK, 0);
}

static inline double sum_of_lanes(pel_lane a)
{
    double sum = 0;
    for (int i = 0; i < PEL_BLOCK; i++)
        sum += (double)a[i];
    return sum;
}

/* ---- triangles ---- */

typedef struct triangle_forces {
    pel_lane3 row[3];
} triangle_forces;

/* a third of pressure times area along the normal on each corner (element/triangle.c) */
static inline void add_pressure(const pel_shell_body *own, int32_t block, pel_lane sixth, const pel_particle x[3],
                                triangle_forces *forces)
{
    pel_lane weight = number_of(own->triangle_numbers, PEL_TRIANGLE_NUMBERS, block, 5);
    pel_lane3 force = pel_lane3_cross(pel_lane3_subtract(x[1].at, x[0].at), pel_lane3_subtract(x[2].at, x[0].at));
    if (own->area_vectors != NULL) {
        pel_lane3_store(own->area_vectors + (size_t)block * PEL_BLOCK,
                        pel_lane3_scale(force, pel_lane_splat((pel_real)0.5) * weight));
        return;
    }
    force = pel_lane3_scale(force, sixth * weight);
    for (int k = 0; k < 3; k++)
        forces->row[k] = pel_lane3_add(forces->row[k], force);
}

PEL_INLINE double sweep_triangles(const pel_shell_body *own, const pel_shell_sweep *sweep, pel_membrane_kind kind,
                                  bool membrane)
{
    const pel_real *numbers = own->triangle_numbers;
    pel_lane energy = pel_lane_splat(0), sixth = pel_lane_splat((pel_real)(sweep->pressure / 6));
    const pel_lane3 none = {energy, energy, energy};
    for (int32_t block = sweep->begin; block < sweep->end; block++) {
        pel_particle x[3];
        triangle_forces forces = {{none, none, none}};
        for (int k = 0; k < 3; k++)
            x[k] = load_corner(own->triangle_steps, 3, block, k, sweep->position);
        if (membrane) {
            pel_lane i0 = number_of(numbers, PEL_TRIANGLE_NUMBERS, block, 0);
            pel_lane i1 = number_of(numbers, PEL_TRIANGLE_NUMBERS, block, 1);
            pel_lane i2 = number_of(numbers, PEL_TRIANGLE_NUMBERS, block, 2);
            pel_lane3 first = pel_lane3_subtract(x[0].at, x[2].at), second = pel_lane3_subtract(x[1].at, x[2].at);
            pel_strain_lanes s = pel_strain_of(pel_lane3_scale(first, i0), pel_lane3_combine(i1, first, i2, second));
            pel_lane3 stress[2];
            energy = energy + pel_membrane_stress(kind, number_of(numbers, PEL_TRIANGLE_NUMBERS, block, 3),
                                                  number_of(numbers, PEL_TRIANGLE_NUMBERS, block, 4), &s, stress);
            forces.row[0] = pel_lane3_combine(-i0, stress[0], -i1, stress[1]);
            forces.row[1] = pel_lane3_scale(stress[1], -i2);
            forces.row[2] = pel_lane3_subtract(pel_lane3_scale(forces.row[0], pel_lane_splat(-1)), forces.row[1]);
        }
        if (sweep->with_pressure)
            add_pressure(own, block, sixth, x, &forces);
        for (int k = 0; k < 3; k++)
            pel_lane3_store(own->rows + ((size_t)block * 3 + (size_t)k) * PEL_BLOCK, forces.row[k]);
    }
    return sum_of_lanes(energy);
}

double pel_shell_sweep_triangles(const pel_shell_body *own, const pel_shell_sweep *sweep, bool membrane)
{
    if (!membrane || !own->shell->has_membrane)
        return sweep_triangles(own, sweep, PEL_MEMBRANE_STVK, false);
    switch (own->kind) {
    case PEL_MEMBRANE_COROTATED:
        return sweep_triangles(own, sweep, PEL_MEMBRANE_COROTATED, true);
    case PEL_MEMBRANE_LINEAR:
        return sweep_triangles(own, sweep, PEL_MEMBRANE_LINEAR, true);
    case PEL_MEMBRANE_MOONEY_RIVLIN:
        return sweep_triangles(own, sweep, PEL_MEMBRANE_MOONEY_RIVLIN, true);
    case PEL_MEMBRANE_NEO_HOOKEAN:
        return sweep_triangles(own, sweep, PEL_MEMBRANE_NEO_HOOKEAN, true);
    case PEL_MEMBRANE_STVK:
    default:
        return sweep_triangles(own, sweep, PEL_MEMBRANE_STVK, true);
    }
}

double pel_shell_sweep_volumes(const pel_shell_body *own, const pel_shell_sweep *sweep)
{
    pel_lane volume = pel_lane_splat(0);
    const pel_record corner = pel_record_get(sweep->position, own->triangle_steps[0]);
    const pel_lane3 origin = {pel_lane_splat(corner[0]), pel_lane_splat(corner[1]), pel_lane_splat(corner[2])};
    for (int32_t block = sweep->begin; block < sweep->end; block++) {
        pel_lane3 x[3];
        for (int k = 0; k < 3; k++)
            x[k] = pel_lane3_subtract(load_corner(own->triangle_steps, 3, block, k, sweep->position).at, origin);
        pel_lane used = number_of(own->triangle_numbers, PEL_TRIANGLE_NUMBERS, block, 6);
        volume = volume + used * pel_lane3_dot(x[0], pel_lane3_cross(x[1], x[2]));
    }
    return sum_of_lanes(volume) / 6;
}

/* ---- hinges ---- */

static inline void store_hinge(const pel_shell_body *own, int32_t block, const pel_lane3 force[4])
{
    for (int k = 0; k < 4; k++)
        pel_lane3_store(own->rows + own->first_hinge_row + ((size_t)block * 4 + (size_t)k) * PEL_BLOCK, force[k]);
}

static double sweep_angles(const pel_shell_body *own, const pel_shell_sweep *sweep)
{
    const pel_lane one = pel_lane_splat(1);
    const pel_real *numbers = own->hinge_numbers;
    pel_lane energy = pel_lane_splat(0);
    for (int32_t block = sweep->begin; block < sweep->end; block++) {
        pel_particle x[4];
        for (int k = 0; k < 4; k++)
            x[k] = load_corner(own->hinge_steps, 4, block, k, sweep->position);
        pel_hinge_lanes h = pel_hinge_of(x, number_of(numbers, PEL_HINGE_NUMBERS, block, 0),
                                         number_of(numbers, PEL_HINGE_NUMBERS, block, 1));
        pel_lane moment = number_of(numbers, PEL_HINGE_NUMBERS, block, 2) * h.difference;
        energy = energy + moment * h.difference;
        pel_lane3 force[4];
        force[2] = pel_lane3_scale(h.n2, moment * h.length * h.r2);
        force[3] = pel_lane3_scale(h.n3, moment * h.length * h.r3);
        force[0] = pel_lane3_combine(h.t2 - one, force[2], h.t3 - one, force[3]);
        force[1] = pel_lane3_combine(-h.t2, force[2], -h.t3, force[3]);
        store_hinge(own, block, force);
    }
    return 0.5 * sum_of_lanes(energy);
}

/* K x from differences to x0 (element/bending.c) */
static double sweep_isometric(const pel_shell_body *own, const pel_shell_sweep *sweep)
{
    const pel_real *numbers = own->hinge_numbers;
    pel_lane energy = pel_lane_splat(0);
    for (int32_t block = sweep->begin; block < sweep->end; block++) {
        pel_particle x[4];
        pel_lane weight[4];
        for (int k = 0; k < 4; k++)
            x[k] = load_corner(own->hinge_steps, 4, block, k, sweep->position);
        for (int k = 1; k < 4; k++)
            weight[k] = number_of(numbers, PEL_HINGE_NUMBERS, block, k - 1);
        weight[0] = -(weight[1] + weight[2] + weight[3]);
        pel_lane3 sum = pel_lane3_combine(weight[1], pel_lane3_subtract(x[1].at, x[0].at), weight[2],
                                          pel_lane3_subtract(x[2].at, x[0].at));
        sum = pel_lane3_combine(pel_lane_splat(1), sum, weight[3], pel_lane3_subtract(x[3].at, x[0].at));
        pel_lane factor = number_of(numbers, PEL_HINGE_NUMBERS, block, 3);
        energy = energy + factor * pel_lane3_dot(sum, sum) - number_of(numbers, PEL_HINGE_NUMBERS, block, 4);
        pel_lane3 force[4];
        for (int k = 0; k < 4; k++)
            force[k] = pel_lane3_scale(sum, -(factor * weight[k]));
        store_hinge(own, block, force);
    }
    return 0.5 * sum_of_lanes(energy);
}

double pel_shell_sweep_hinges(const pel_shell_body *own, const pel_shell_sweep *sweep)
{
    return own->shell->bending == PEL_BENDING_HINGE ? sweep_angles(own, sweep) : sweep_isometric(own, sweep);
}

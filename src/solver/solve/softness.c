#include "solve/softness.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/status.h"
#include "force/pressure.h"
#include "math/extremes.h"
#include "math/functions.h"
#include "measure/element.h"
#include "model/shell.h"

#include <math.h>
#include <string.h>

enum { POWER_STEPS = 12, STRAIN_COUNT = 3, BINS_PER_OCTAVE = 8, BIN_COUNT = 128 };

/* share of the energy of a level that may lie above its rate */
#define LEFT_OUT 0.05

/* strain and relative volume of difference quotients */
#define STRAIN_STEP 1e-5
#define VOLUME_STEP 1e-4
/* a triangle squeezed below this area ratio has no frame to speak of */
#define LEAST_AREA_RATIO 1e-6

pel_status pel_softness_create(const pel_model *model, double *lent, pel_softness_scratch *scratch, pel_error *error)
{
    size_t count = (size_t)model->vertex_count;
    double *own = lent == NULL ? pel_allocate(4 * count, sizeof *own) : NULL, *room = lent != NULL ? lent : own;
    *scratch = (pel_softness_scratch){.own = own};
    if (room == NULL)
        return pel_fail_memory(error);
    scratch->energy = room;
    scratch->excess = room + count;
    scratch->mean = room + 2 * count;
    scratch->sum = room + 3 * count;
    return PEL_OK;
}

void pel_softness_destroy(pel_softness_scratch *scratch)
{
    pel_free(scratch->own);
}

/* ---- means over the elements at a vertex ---- */

/* the level of detail on which a vertex appears; -1 = not in use */
static int32_t level_of(const pel_model *model, int32_t body, int32_t v)
{
    PEL_ASSERT_INDEX(body, model->body_count);
    const pel_front *front = model->bodies[body].front;
    int32_t level = 0;
    if (front == NULL || model->mesh_vertex[v] < 0)
        return model->mesh_vertex[v] < 0 ? -1 : 0;
    while (model->mesh_vertex[v] >= front->forest->levels[level]->vertex_count)
        level++;
    return level;
}

static void clear(const pel_model *model, const pel_softness_scratch *scratch)
{
    memset(scratch->energy, 0, (size_t)model->vertex_count * sizeof *scratch->energy);
    memset(scratch->excess, 0, (size_t)model->vertex_count * sizeof *scratch->excess);
}

/* energy: of the element in a uniform strain; rate: mobility times stiffness */
static void add_element(const pel_softness_scratch *scratch, const int32_t *vertices, int count, double energy,
                        double rate)
{
    for (int k = 0; k < count && energy > 0 && rate > 0; k++) {
        scratch->energy[vertices[k]] += energy;
        scratch->excess[vertices[k]] += energy * rate;
    }
}

/* mean rate of the elements at each vertex and its neighbours by triangles, 0 where there are none */
static void find_means(const pel_model *model, int32_t body, const pel_softness_scratch *scratch)
{
    PEL_ASSERT_INDEX(body, model->body_count);
    const pel_shell *shell = model->bodies[body].shell;
    int32_t first = model->bodies[body].slice_begin * PEL_WIDTH, end = pel_body_place_end(model, body);
    for (int32_t v = first; v < end; v++) {
        scratch->sum[v] = scratch->energy[v];
        scratch->mean[v] = scratch->excess[v];
    }
    for (int32_t t = 0; shell != NULL && t < shell->triangle_count; t++) {
        const int32_t *v = shell->corners[t];
        for (int k = 0; k < 3; k++) {
            scratch->sum[v[k]] += scratch->energy[v[(k + 1) % 3]] + scratch->energy[v[(k + 2) % 3]];
            scratch->mean[v[k]] += scratch->excess[v[(k + 1) % 3]] + scratch->excess[v[(k + 2) % 3]];
        }
    }
    for (int32_t v = first; v < end; v++)
        scratch->mean[v] = scratch->energy[v] > 0 ? scratch->mean[v] / scratch->sum[v] : 0;
}

/* eighths of an octave below `largest`; the last bin takes all that is smaller */
static int bin_of(double rate, double largest)
{
    int exponent;
    double mantissa = frexp(largest / rate, &exponent); /* 0.5 <= mantissa < 1 */
    double bin = BINS_PER_OCTAVE * (exponent - 1) + (2 * mantissa - 1) * BINS_PER_OCTAVE;
    return (int)pel_min(bin, BIN_COUNT - 1);
}

/* the first rate, and the last, of a bin */
static double top_of(int bin, double largest)
{
    return largest / ldexp(1 + (double)(bin % BINS_PER_OCTAVE) / BINS_PER_OCTAVE, bin / BINS_PER_OCTAVE);
}

/* The rate that all but a small share of the vertices of a level stay below, by energy: the few smallest elements of a
   mesh do not decide, a region that is finer or stiffer does. */
static double level_rate(const pel_model *model, int32_t body, int32_t level, const pel_softness_scratch *scratch)
{
    PEL_ASSERT_INDEX(body, model->body_count);
    int32_t first = model->bodies[body].slice_begin * PEL_WIDTH, end = pel_body_place_end(model, body);
    double largest = 0, sum = 0, energies[BIN_COUNT] = {0};
    for (int32_t v = first; v < end; v++)
        if (level_of(model, body, v) == level)
            largest = pel_max(largest, scratch->mean[v]);
    for (int32_t v = first; v < end && largest > 0; v++) {
        double rate = scratch->mean[v];
        if (!(rate > 0) || level_of(model, body, v) != level)
            continue;
        energies[bin_of(rate, largest)] += scratch->energy[v];
        sum += scratch->energy[v];
    }
    double above = 0;
    int bin = 0;
    for (; bin < BIN_COUNT - 1 && above + energies[bin] <= LEFT_OUT * sum; bin++)
        above += energies[bin];
    return largest > 0 ? top_of(bin, largest) : 0;
}

/* of the worst level of detail */
static double worst_rate(const pel_model *model, int32_t body, const pel_softness_scratch *scratch)
{
    PEL_ASSERT_INDEX(body, model->body_count);
    const pel_front *front = model->bodies[body].front;
    double rate = 0;
    find_means(model, body, scratch);
    for (int32_t level = 0; level <= (front != NULL ? front->forest->depth : 0); level++)
        rate = pel_max(rate, level_rate(model, body, level, scratch));
    return rate;
}

/* ---- springs ---- */

static void add_springs(const pel_model *model, const pel_state *state, int32_t body,
                        const pel_softness_scratch *scratch)
{
    PEL_ASSERT_INDEX(body, model->body_count);
    const pel_body *b = &model->bodies[body];
    double factor = state->factors[body][PEL_SPRING_STIFFNESS];
    for (int32_t v = b->slice_begin * PEL_WIDTH; v < b->slice_end * PEL_WIDTH && b->uniform_spring != 0; v++) {
        int32_t slice = v / PEL_WIDTH, lane = v % PEL_WIDTH;
        for (int32_t slot = model->slot_begin[slice]; slot < model->slot_end[slice]; slot++) {
            int32_t ends[2] = {v, model->neighbours[slot][lane]};
            if (ends[1] == v)
                continue;
            double k = factor * (b->uniform_spring > 0 ? b->uniform_spring : (double)model->stiffnesses[slot][lane]);
            double length = (double)model->rest_lengths[slot][lane];
            double mobility = (double)model->inverse_mass[v] + (double)model->inverse_mass[ends[1]];
            add_element(scratch, ends, 1, k * length * length, k * mobility);
        }
    }
}

/* ---- membranes ---- */

/* the rotation R (3 x 2) of F = R U; false for a collapsed triangle */
static bool find_rotation(const double f[6], double r[6])
{
    double c11 = 0, c12 = 0, c22 = 0;
    for (int i = 0; i < 3; i++) {
        c11 += f[2 * i] * f[2 * i];
        c12 += f[2 * i] * f[2 * i + 1];
        c22 += f[2 * i + 1] * f[2 * i + 1];
    }
    double ratio = sqrt(pel_max(c11 * c22 - c12 * c12, 0)), trace = sqrt(c11 + c22 + 2 * ratio);
    if (!(ratio > LEAST_AREA_RATIO))
        return false;
    /* U = (C + J) / trace and its inverse */
    double u11 = (c11 + ratio) / trace, u12 = c12 / trace, u22 = (c22 + ratio) / trace;
    for (int i = 0; i < 3; i++) {
        r[2 * i] = (f[2 * i] * u22 - f[2 * i + 1] * u12) / ratio;
        r[2 * i + 1] = (f[2 * i + 1] * u11 - f[2 * i] * u12) / ratio;
    }
    return true;
}

/* strains of unit size in the frame R: along both axes, and shear */
static void find_modes(const double r[6], double modes[STRAIN_COUNT][6])
{
    const double half = sqrt(0.5);
    for (int i = 0; i < 3; i++) {
        const double a = r[2 * i], b = r[2 * i + 1];
        modes[0][2 * i] = a;
        modes[0][2 * i + 1] = 0;
        modes[1][2 * i] = 0;
        modes[1][2 * i + 1] = b;
        modes[2][2 * i] = half * b;
        modes[2][2 * i + 1] = half * a;
    }
}

/* h: tangent stiffness of the law at f for the modes [N/m] */
static void find_tangent(const pel_membrane_law *law, const double f[6], double modes[STRAIN_COUNT][6],
                         double h[STRAIN_COUNT][STRAIN_COUNT])
{
    double stress[6], moved[6], changed[6];
    pel_membrane_law_density(law, f, stress);
    for (int k = 0; k < STRAIN_COUNT; k++) {
        for (int i = 0; i < 6; i++)
            moved[i] = f[i] + STRAIN_STEP * modes[k][i];
        pel_membrane_law_density(law, moved, changed);
        for (int l = 0; l < STRAIN_COUNT; l++) {
            double sum = 0;
            for (int i = 0; i < 6; i++)
                sum += modes[l][i] * (changed[i] - stress[i]);
            h[l][k] = sum / STRAIN_STEP;
        }
    }
    for (int k = 0; k < STRAIN_COUNT; k++)
        for (int l = 0; l < k; l++)
            h[k][l] = h[l][k] = 0.5 * (h[k][l] + h[l][k]);
}

/* g: sum over the corners of 1 / m times the products of the gradients of the modes [1/(kg m2)] */
static void find_mobility(const pel_model *model, const int32_t corners[3], const pel_rest_triangle *rest,
                          double g[STRAIN_COUNT][STRAIN_COUNT])
{
    const double *inverse = rest->inverse;
    const double shapes[3][2] = {{inverse[0], inverse[1]}, {0, inverse[2]}, {-inverse[0], -inverse[1] - inverse[2]}};
    double xx = 0, xy = 0, yy = 0;
    for (int k = 0; k < 3; k++) {
        double w = (double)model->inverse_mass[corners[k]];
        xx += w * shapes[k][0] * shapes[k][0];
        xy += w * shapes[k][0] * shapes[k][1];
        yy += w * shapes[k][1] * shapes[k][1];
    }
    g[0][0] = xx;
    g[1][1] = yy;
    g[2][2] = 0.5 * (xx + yy);
    g[0][1] = g[1][0] = 0;
    g[0][2] = g[2][0] = g[1][2] = g[2][1] = sqrt(0.5) * xy;
}

static void multiply(double m[STRAIN_COUNT][STRAIN_COUNT], const double x[STRAIN_COUNT], double y[STRAIN_COUNT])
{
    for (int k = 0; k < STRAIN_COUNT; k++)
        y[k] = m[k][0] * x[0] + m[k][1] * x[1] + m[k][2] * x[2];
}

/* largest eigenvalue of H G by power iteration, as the quotient (H x . G H x) / (x . H x) */
static double largest_product(double h[STRAIN_COUNT][STRAIN_COUNT], double g[STRAIN_COUNT][STRAIN_COUNT])
{
    double x[STRAIN_COUNT] = {1, 0.9, 0.2}, y[STRAIN_COUNT], value = 0;
    for (int n = 0; n < POWER_STEPS; n++) {
        multiply(h, x, y);
        double energy = x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
        multiply(g, y, x);
        double work = x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
        double size = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
        if (!(energy > 0) || !(size > 0))
            return value;
        value = work / energy;
        for (int k = 0; k < STRAIN_COUNT; k++)
            x[k] /= size;
    }
    return value;
}

static void add_membrane(const pel_model *model, const pel_shell *shell, const pel_record *positions,
                         const pel_softness_scratch *scratch)
{
    for (int32_t t = 0; t < shell->triangle_count && shell->has_membrane; t++) {
        const int32_t *corners = shell->corners[t];
        const pel_rest_triangle rest = pel_shell_rest(shell, t);
        double x[3][3], f[6], r[6], modes[STRAIN_COUNT][6];
        double h[STRAIN_COUNT][STRAIN_COUNT], g[STRAIN_COUNT][STRAIN_COUNT];
        pel_load_points(positions, corners, 3, x);
        pel_deformation_gradient(&rest, (const double(*)[3])x, f);
        if (!(rest.area > 0) || !find_rotation(f, r))
            continue;
        const pel_membrane_law law = pel_shell_law(shell, t);
        find_modes(r, modes);
        find_tangent(&law, f, modes, h);
        find_mobility(model, corners, &rest, g);
        double energy = rest.area * (h[0][0] + h[1][1] + h[2][2]);
        add_element(scratch, corners, 3, energy, rest.area * largest_product(h, g));
    }
}

/* ---- bending and fibres ---- */

static double hinge_mobility(const pel_model *model, const pel_shell *shell, const pel_shell_hinge *hinge,
                             const pel_bending_isometric *isometric, const pel_record *positions)
{
    double x[4][3], gradient[4][3] = {{0}}, sum = 0;
    if (shell->bending->is_angle) {
        pel_load_points(positions, hinge->vertices, 4, x);
        pel_dihedral_angle((const double(*)[3])x, gradient);
    }
    for (int k = 0; k < 4; k++) {
        double weight = isometric->weight[k];
        double square = shell->bending->is_angle ? pel_vec3_squared_length(gradient[k]) : weight * weight;
        sum += (double)model->inverse_mass[hinge->vertices[k]] * square;
    }
    return sum;
}

/* weighted with the energy of a uniform curvature, which goes with D and area */
static void add_bending(const pel_model *model, const pel_shell *shell, const pel_record *positions,
                        const pel_softness_scratch *scratch)
{
    bool is_angle = shell->bending->is_angle;
    for (int32_t i = 0; i < shell->hinge_count; i++) {
        const pel_shell_hinge hinge = pel_shell_hinge_of(shell, i);
        const pel_bending_isometric isometric = pel_shell_isometric(model->rest, &hinge);
        double factor = is_angle ? pel_shell_angle(shell, model->rest, &hinge).factor : isometric.factor;
        /* the factor of the isometric stencil is 3 over the area */
        double stiffness = hinge.stiffness * (is_angle ? factor : factor / 3);
        double energy = factor > 0 ? hinge.stiffness / isometric.factor : 0;
        add_element(scratch, hinge.vertices, 4, energy,
                    stiffness * hinge_mobility(model, shell, &hinge, &isometric, positions));
    }
}

static void add_fibres(const pel_model *model, const pel_shell *shell, const pel_shell_region *region,
                       const pel_softness_scratch *scratch)
{
    for (int32_t i = 0; i < region->fibre_count && region->def.mode != PEL_FIBRE_CAVE; i++) {
        const pel_shell_fibre fibre = pel_shell_fibre_of(shell, region, i);
        const int32_t *corners = shell->corners[fibre.triangle];
        const pel_rest_triangle rest = pel_shell_rest(shell, fibre.triangle);
        const double *inverse = rest.inverse, *d = fibre.direction;
        double c[3] = {inverse[0] * d[0] + inverse[1] * d[1], inverse[2] * d[1], 0}, mobility = 0;
        c[2] = -c[0] - c[1];
        for (int k = 0; k < 3; k++)
            mobility += (double)model->inverse_mass[corners[k]] * c[k] * c[k];
        bool squared = region->def.kind == PEL_FIBRE_STVK && region->def.mode != PEL_FIBRE_ACTIVE;
        double stiffness = (squared ? 4 : 1) * rest.area * region->def.stiffness * fibre.weight;
        add_element(scratch, corners, 3, stiffness, stiffness * mobility);
    }
}

/* ---- pressure ---- */

/* a pressure p(V) has the stiffness -p' g g^T with the gradient g of the volume; its only eigenvalue over the mass */
static double pressure_rate(const pel_model *model, int32_t body, const pel_record *positions, double time,
                            const pel_softness_scratch *scratch)
{
    PEL_ASSERT_INDEX(body, model->body_count);
    const pel_body *b = &model->bodies[body];
    const pel_shell *shell = b->shell;
    if (!b->closed || (shell->pressure.kind != PEL_PRESSURE_GAS && shell->pressure.kind != PEL_PRESSURE_VOLUME))
        return 0;
    double volume = pel_body_volume(model, body, positions), step = VOLUME_STEP * b->rest_volume, sum = 0;
    double slope = (pel_pressure_difference(shell, time, 1, volume, b->rest_volume) -
                    pel_pressure_difference(shell, time, 1, volume + step, b->rest_volume)) /
                   step;
    memset(scratch->energy, 0, (size_t)model->vertex_count * sizeof *scratch->energy);
    for (int32_t t = 0; t < shell->triangle_count; t++) {
        double x[3][3], first[3], second[3], normal[3];
        pel_load_points(positions, shell->corners[t], 3, x);
        pel_vec3_subtract(x[1], x[0], first);
        pel_vec3_subtract(x[2], x[0], second);
        pel_vec3_cross(first, second, normal);
        for (int k = 0; k < 3; k++)
            scratch->energy[shell->corners[t][k]] += pel_vec3_length(normal) / 6;
    }
    for (int32_t v = b->slice_begin * PEL_WIDTH; v < pel_body_place_end(model, body); v++)
        sum += scratch->energy[v] * scratch->energy[v] * (double)model->inverse_mass[v];
    return slope > 0 ? slope * sum : 0;
}

/* ---- all bodies ---- */

static double body_rate(const pel_model *model, const pel_state *state, int32_t body, const pel_record *positions,
                        const pel_softness_scratch *scratch)
{
    PEL_ASSERT_INDEX(body, model->body_count);
    const pel_shell *shell = model->bodies[body].shell;
    clear(model, scratch);
    add_springs(model, state, body, scratch);
    double rate = worst_rate(model, body, scratch);
    if (shell == NULL)
        return rate;
    clear(model, scratch);
    add_membrane(model, shell, positions, scratch);
    rate = pel_max(rate, worst_rate(model, body, scratch));
    clear(model, scratch);
    add_bending(model, shell, positions, scratch);
    rate = pel_max(rate, worst_rate(model, body, scratch));
    for (int32_t r = 0; r < shell->region_count; r++) {
        clear(model, scratch);
        add_fibres(model, shell, &shell->regions[r], scratch);
        rate = pel_max(rate, worst_rate(model, body, scratch));
    }
    return rate;
}

pel_softness pel_softness_find(const pel_model *model, const pel_state *state, const pel_record *positions, double time,
                               const pel_softness_scratch *scratch)
{
    pel_softness found = {0};
    for (int32_t b = 0; b < model->body_count; b++) {
        found.rate = pel_max(found.rate, body_rate(model, state, b, positions, scratch));
        if (model->bodies[b].shell != NULL)
            found.pressure = pel_max(found.pressure, pressure_rate(model, b, positions, time, scratch));
    }
    return found;
}

double pel_softness_after(double share, int32_t iterations)
{
    double left = pel_pow(share / (1 + share), iterations);
    return left / (1 - left);
}

double pel_softness_share(double softness, int32_t iterations)
{
    double left = pel_pow(softness / (1 + softness), 1.0 / iterations);
    return left / (1 - left);
}

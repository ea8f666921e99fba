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

enum { POWER_STEPS = 12, STRAIN_COUNT = 3, BINS_PER_OCTAVE = 8, BIN_COUNT = 128, SAMPLE_CHUNK = 256 };

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
    double *own = pel_allocate((lent == NULL ? 4 : 2) * count, sizeof *own);
    *scratch = (pel_softness_scratch){.own = own};
    if (own == NULL)
        return pel_fail_memory(error);
    scratch->energy = own;
    scratch->excess = own + count;
    scratch->mean = lent != NULL ? lent : own + 2 * count;
    scratch->sum = scratch->mean + count;
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

/* What an element adds at each of its vertices. energy: of the element in a uniform strain; excess: the energy times
   the rate, which is mobility times stiffness. */
typedef struct sample {
    double energy, excess;
} sample;

static sample make_sample(double energy, double rate)
{
    return energy > 0 && rate > 0 ? (sample){energy, energy * rate} : (sample){0};
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

/* those at a vertex together */
static sample sample_springs(const pel_model *model, const pel_state *state, int32_t body, int32_t v)
{
    PEL_ASSERT_INDEX(body, model->body_count);
    const pel_body *b = &model->bodies[body];
    double factor = state->factors[body][PEL_SPRING_STIFFNESS];
    int32_t slice = v / PEL_WIDTH, lane = v % PEL_WIDTH;
    sample sum = {0};
    for (int32_t slot = model->slot_begin[slice]; slot < model->slot_end[slice]; slot++) {
        int32_t other = model->neighbours[slot][lane];
        if (other == v)
            continue;
        double k = factor * (b->uniform_spring > 0 ? b->uniform_spring : (double)model->stiffnesses[slot][lane]);
        double length = (double)model->rest_lengths[slot][lane];
        double mobility = (double)model->inverse_mass[v] + (double)model->inverse_mass[other];
        sample spring = make_sample(k * length * length, k * mobility);
        sum.energy += spring.energy;
        sum.excess += spring.excess;
    }
    return sum;
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

static sample sample_membrane(const pel_model *model, const pel_shell *shell, int32_t t, const pel_record *positions)
{
    const int32_t *corners = shell->corners[t];
    const pel_rest_triangle rest = pel_shell_rest(shell, t);
    double x[3][3], f[6], r[6], modes[STRAIN_COUNT][6];
    double h[STRAIN_COUNT][STRAIN_COUNT], g[STRAIN_COUNT][STRAIN_COUNT];
    pel_load_points(positions, corners, 3, x);
    pel_deformation_gradient(&rest, (const double(*)[3])x, f);
    if (!(rest.area > 0) || !find_rotation(f, r))
        return (sample){0};
    const pel_membrane_law law = pel_shell_law(shell, t);
    find_modes(r, modes);
    find_tangent(&law, f, modes, h);
    find_mobility(model, corners, &rest, g);
    return make_sample(rest.area * (h[0][0] + h[1][1] + h[2][2]), rest.area * largest_product(h, g));
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
static sample sample_hinge(const pel_model *model, const pel_shell *shell, int32_t i, const pel_record *positions)
{
    bool is_angle = shell->bending->is_angle;
    const pel_shell_hinge hinge = pel_shell_hinge_of(shell, i);
    const pel_bending_isometric isometric = pel_shell_isometric(model->rest, &hinge);
    double factor = is_angle ? pel_shell_angle(shell, model->rest, &hinge).factor : isometric.factor;
    /* the factor of the isometric stencil is 3 over the area */
    double stiffness = hinge.stiffness * (is_angle ? factor : factor / 3);
    return make_sample(factor > 0 ? hinge.stiffness / isometric.factor : 0,
                       stiffness * hinge_mobility(model, shell, &hinge, &isometric, positions));
}

static sample sample_fibre(const pel_model *model, const pel_shell *shell, const pel_shell_region *region, int32_t i)
{
    const pel_shell_fibre fibre = pel_shell_fibre_of(shell, region, i);
    const int32_t *corners = shell->corners[fibre.triangle];
    const pel_rest_triangle rest = pel_shell_rest(shell, fibre.triangle);
    const double *inverse = rest.inverse, *d = fibre.direction;
    double c[3] = {inverse[0] * d[0] + inverse[1] * d[1], inverse[2] * d[1], 0}, mobility = 0;
    c[2] = -c[0] - c[1];
    for (int k = 0; k < 3; k++)
        mobility += (double)model->inverse_mass[corners[k]] * c[k] * c[k];
    bool squared = region->def.kind == PEL_FIBRE_STVK && region->def.mode != PEL_FIBRE_ACTIVE;
    /* of a muscle the steepest part of its force, or force over length */
    const double times = squared ? 4 : region->def.mode == PEL_FIBRE_MUSCLE ? 2 / region->def.width : 1;
    double stiffness = times * rest.area * region->def.stiffness * fibre.weight;
    return make_sample(stiffness, stiffness * mobility);
}

/* ---- tetrahedra ---- */

/* H x = 2 mu x + lambda tr(x) 1 for a strain x, for a Young's modulus of 1: all laws have it at rest */
static void solid_stress(const pel_solid_law *law, const double x[9], double y[9])
{
    const double lambda = law->kind == PEL_VOLUME_STVK ? 4 * law->b2 : law->k - law->shape_k;
    const double shear = 2 * law->a2 + 12 * law->a4 - law->c, trace = lambda * (x[0] + x[4] + x[8]);
    for (int i = 0; i < 9; i++)
        y[i] = shear * x[i] + (i % 4 == 0 ? trace : 0);
}

/* Largest eigenvalue of H G by power iteration, with G x = (M x + x M) / 2 of the strains x, and M the sum over the
   corners of 1 / m times the gradient by the gradient. */
static double largest_solid_product(const pel_solid_law *law, const double m[9])
{
    double x[9] = {1, 0.1, 0.2, 0.1, 0.9, 0.3, 0.2, 0.3, 0.8}, y[9], value = 0;
    for (int n = 0; n < POWER_STEPS; n++) {
        double energy = 0, work = 0, size = 0;
        solid_stress(law, x, y);
        for (int i = 0; i < 9; i++) {
            energy += x[i] * y[i];
            size += x[i] * x[i];
        }
        for (int i = 0; i < 9; i++) {
            const int row = i / 3, column = i % 3;
            x[i] = 0;
            for (int k = 0; k < 3; k++)
                x[i] += 0.5 * (m[3 * row + k] * y[3 * k + column] + y[3 * row + k] * m[3 * k + column]);
            work += x[i] * y[i];
        }
        if (!(energy > 0))
            return value;
        value = work / energy;
        for (int i = 0; i < 9; i++)
            x[i] /= value * sqrt(size);
    }
    return value;
}

/* at rest */
static sample sample_tetra(const pel_model *model, const pel_shell *shell, int32_t t)
{
    pel_rest_tetra rest;
    const double scale = pel_filled_rest(shell, model->rest, t, &rest);
    double m[9] = {0};
    for (int k = 0; k < 4; k++)
        for (int i = 0; i < 9; i++)
            m[i] += (double)model->inverse_mass[shell->tetrahedra[t][k]] * rest.gradients[k][i / 3] *
                    rest.gradients[k][i % 3];
    return make_sample(scale, scale * largest_solid_product(&shell->solid, m));
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
    double slope = (pel_pressure_difference(shell, pel_instant(time), 1, volume, b->rest_volume) -
                    pel_pressure_difference(shell, pel_instant(time), 1, volume + step, b->rest_volume)) /
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

/* ---- looks ---- */

/* kinds of elements of a body, each with means of its own; from FIBRES on one for each region */
enum { SPRINGS, MEMBRANE, BENDING, TETRAHEDRA, FIBRES };

static int32_t kind_count(const pel_model *model, int32_t body)
{
    PEL_ASSERT_INDEX(body, model->body_count);
    const pel_shell *shell = model->bodies[body].shell;
    return shell != NULL ? FIBRES + shell->region_count : MEMBRANE;
}

static int32_t element_count(const pel_model *model, int32_t body, int32_t kind)
{
    PEL_ASSERT_INDEX(body, model->body_count);
    const pel_body *b = &model->bodies[body];
    if (kind == SPRINGS)
        return b->uniform_spring != 0 ? (b->slice_end - b->slice_begin) * PEL_WIDTH : 0;
    if (kind == MEMBRANE)
        return b->shell->has_membrane ? b->shell->triangle_count : 0;
    if (kind == BENDING)
        return b->shell->hinge_count;
    if (kind == TETRAHEDRA)
        return b->shell->tetrahedron_count;
    const pel_shell_region *region = &b->shell->regions[kind - FIBRES];
    return pel_shell_region_is_elastic(region) ? region->fibre_count : 0;
}

/* elements of one kind from `first` on */
typedef struct sample_job {
    const pel_model *model;
    const pel_state *state;
    const pel_record *positions;
    sample *samples; /* (count) */
    int32_t body, kind, first, count;
} sample_job;

static sample take_sample(const sample_job *job, int32_t i)
{
    const pel_body *b = &job->model->bodies[job->body];
    if (job->kind == SPRINGS)
        return sample_springs(job->model, job->state, job->body, b->slice_begin * PEL_WIDTH + i);
    if (job->kind == MEMBRANE)
        return sample_membrane(job->model, b->shell, i, job->positions);
    if (job->kind == BENDING)
        return sample_hinge(job->model, b->shell, i, job->positions);
    if (job->kind == TETRAHEDRA)
        return sample_tetra(job->model, b->shell, i);
    return sample_fibre(job->model, b->shell, &b->shell->regions[job->kind - FIBRES], i);
}

static void sample_chunk(void *context, int32_t chunk)
{
    const sample_job *job = context;
    int32_t begin = chunk * SAMPLE_CHUNK, end = job->count - begin < SAMPLE_CHUNK ? job->count : begin + SAMPLE_CHUNK;
    for (int32_t i = begin; i < end; i++)
        job->samples[i] = take_sample(job, job->first + i);
}

/* returns their number */
static int vertices_of(const sample_job *job, int32_t i, int32_t vertices[4])
{
    const pel_body *b = &job->model->bodies[job->body];
    const int32_t *corners;
    pel_shell_hinge hinge;
    int count = 3;
    if (job->kind == SPRINGS) {
        vertices[0] = b->slice_begin * PEL_WIDTH + i;
        return 1;
    }
    if (job->kind == BENDING) {
        hinge = pel_shell_hinge_of(b->shell, i);
        corners = hinge.vertices;
        count = 4;
    } else if (job->kind == TETRAHEDRA) {
        corners = b->shell->tetrahedra[i];
        count = 4;
    } else if (job->kind == MEMBRANE) {
        corners = b->shell->corners[i];
    } else {
        corners = b->shell->corners[pel_shell_fibre_of(b->shell, &b->shell->regions[job->kind - FIBRES], i).triangle];
    }
    memcpy(vertices, corners, (size_t)count * sizeof *corners);
    return count;
}

/* samples on all threads, sums in the order of the elements */
static void add_samples(sample_job *job, pel_pool *pool, const pel_softness_scratch *scratch)
{
    pel_pool_run(pool, (job->count + SAMPLE_CHUNK - 1) / SAMPLE_CHUNK, sample_chunk, job);
    for (int32_t i = 0; i < job->count; i++) {
        int32_t vertices[4], count = vertices_of(job, job->first + i, vertices);
        for (int k = 0; k < count; k++) {
            scratch->energy[vertices[k]] += job->samples[i].energy;
            scratch->excess[vertices[k]] += job->samples[i].excess;
        }
    }
}

/* the elements begin .. end - 1 of a kind; after the last one its rate counts */
static void look_at(sample_job job, int32_t begin, int32_t end, pel_pool *pool, const pel_softness_scratch *scratch,
                    pel_softness *found)
{
    job.samples = (sample *)scratch->mean;
    if (begin == 0)
        clear(job.model, scratch);
    for (job.first = begin; job.first < end; job.first += job.count) {
        job.count = end - job.first < job.model->vertex_count ? end - job.first : job.model->vertex_count;
        add_samples(&job, pool, scratch);
    }
    if (end == element_count(job.model, job.body, job.kind))
        found->rate = pel_max(found->rate, worst_rate(job.model, job.body, scratch));
}

int64_t pel_softness_size(const pel_model *model)
{
    int64_t size = 0;
    for (int32_t b = 0; b < model->body_count; b++)
        for (int32_t kind = 0; kind < kind_count(model, b); kind++)
            size += element_count(model, b, kind);
    return size;
}

void pel_softness_look(const pel_model *model, const pel_state *state, double time, pel_pool *pool, int64_t end,
                       const pel_softness_scratch *scratch, pel_softness_progress *progress)
{
    const pel_record *positions = state->position;
    int64_t first = 0;
    if (progress->done == 0)
        progress->found = (pel_softness){0};
    for (int32_t b = 0; b < model->body_count; b++)
        for (int32_t kind = 0; kind < kind_count(model, b); kind++) {
            int64_t count = element_count(model, b, kind), stop = end < first + count ? end : first + count;
            const sample_job job = {.model = model, .state = state, .positions = positions, .body = b, .kind = kind};
            if (progress->done < stop)
                look_at(job, (int32_t)(progress->done - first), (int32_t)(stop - first), pool, scratch,
                        &progress->found);
            progress->done = progress->done > stop ? progress->done : stop;
            first += count;
        }
    for (int32_t b = 0; b < model->body_count && end == first; b++)
        if (model->bodies[b].shell != NULL)
            progress->found.pressure =
                pel_max(progress->found.pressure, pressure_rate(model, b, positions, time, scratch));
}

double pel_softness_after(double share, int32_t iterations)
{
    if (iterations == 1)
        return share * (share / (share + PEL_MOST_CORRECTION));
    double left = pel_pow(share / (1 + share), iterations);
    return left / (1 - left);
}

double pel_softness_share(double softness, int32_t iterations)
{
    if (iterations == 1)
        return 0.5 * (softness + sqrt(softness * (softness + 4 * PEL_MOST_CORRECTION)));
    double left = pel_pow(softness / (1 + softness), 1.0 / iterations);
    return left / (1 - left);
}

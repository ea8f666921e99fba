/* A body that is filled has the mass m of its filling on its vertices, in proportion to their own masses, so that
   gravity g and inertia act on them. The filling itself has the potential -m g . c at the centre c of the enclosed
   volume V in place of -g . sum m_i x_i:

       U = -m g . c + g . sum m_i x_i,     c = 1/V int x dV

   The gradient of the first term is the pressure p = (m / V) g . (x - c): the weight of the filling, hydrostatic, with
   the mean 0 over the volume, since what presses alike in all directions belongs to the volume (force/pressure.h). The
   sum of all forces of U is zero.

   A liquid with a level has the pressure p = rho |g| depth below it, and no mass. With p linear over a triangle of the
   area vector a / 2, corner i has the force (p_i + p_0 + p_1 + p_2) a / 24; of a triangle that the level cuts the wet
   parts count alone. */
#include "boundary/fluid.h"

#include "base/assert.h"
#include "base/status.h"
#include "boundary/loads.h"
#include "math/extremes.h"
#include "stage/surface_view.h"

#include <string.h>

/* positions of the state, or unknowns */
typedef struct fluid_places {
    const pel_record *records;
    const double *unknowns;
} fluid_places;

/* p = slope . x + offset */
typedef struct fluid_pressure {
    double slope[3], offset;
    bool has_level;
    double potential; /* J, of the filling: first term of U */
} fluid_pressure;

static void load_triangle(const fluid_places *places, const int32_t v[3], double x[3][3])
{
    for (int k = 0; k < 3; k++)
        if (places->records != NULL)
            pel_vertex_position(places->records, v[k], x[k]);
        else
            memcpy(x[k], places->unknowns + 3 * (size_t)v[k], sizeof x[k]);
}

static bool is_filled(const pel_body *body)
{
    return body->fluid_density > 0 && !isfinite(body->fluid_level);
}

/* volume and its centre, about the first corner */
static double find_centre(const pel_sim *sim, int32_t b, const fluid_places *places, double centre[3])
{
    PEL_ASSERT_INDEX(b, sim->model->body_count);
    double volume = 0, sum[3] = {0, 0, 0}, origin[3] = {0, 0, 0}, x[3][3];
    for (int32_t i = 0; i < pel_surface_count(sim->model, b); i++) {
        load_triangle(places, pel_surface_corners(sim, b, i), x);
        if (i == 0)
            pel_vec3_copy(x[0], origin);
        double part = pel_vec3_cone_volume(origin, x[0], x[1], x[2]);
        volume += part;
        for (int k = 0; k < 3; k++)
            sum[k] += 0.25 * part * (x[0][k] + x[1][k] + x[2][k] - 3 * origin[k]);
    }
    for (int k = 0; k < 3; k++)
        centre[k] = origin[k] + sum[k] / volume;
    return volume;
}

static fluid_pressure pressure_of(const pel_sim *sim, int32_t b, const fluid_places *places)
{
    PEL_ASSERT_INDEX(b, sim->model->body_count);
    const pel_body *body = &sim->model->bodies[b];
    fluid_pressure p = {.has_level = !is_filled(body)};
    double gravity[3], centre[3];
    pel_vec3_scale(sim->model->gravity, sim->state->load_factor, gravity);
    if (p.has_level) {
        pel_vec3_scale(gravity, body->fluid_density, p.slope);
        p.offset = body->fluid_density * pel_vec3_length(gravity) * body->fluid_level;
        return p;
    }
    double mass = body->fluid_density * fabs(body->rest_volume);
    double density = mass / find_centre(sim, b, places, centre);
    pel_vec3_scale(gravity, density, p.slope);
    p.offset = -pel_vec3_dot(p.slope, centre);
    p.potential = -mass * pel_vec3_dot(gravity, centre);
    return p;
}

/* ---- a triangle ---- */

/* adds a third of the force on a part of a triangle, whose corners have these weights of the triangle's corners */
static void add_part(const double weights[3][3], const double pressure[3], const double area[3], double force[3][3])
{
    double sum = pressure[0] + pressure[1] + pressure[2];
    for (int m = 0; m < 3; m++)
        for (int i = 0; i < 3; i++)
            pel_vec3_along(force[i], weights[m][i] * (pressure[m] + sum) / 24, area, force[i]);
}

/* the wet part of a triangle with one or two dry corners: from corner `apart`, which is the one of its kind */
static void add_cut(const double p[3], int apart, const double area[3], double force[3][3])
{
    const int i = apart, j = (apart + 1) % 3, k = (apart + 2) % 3;
    const double to_j = p[i] / (p[i] - p[j]), to_k = p[i] / (p[i] - p[k]);
    double corner[3] = {0, 0, 0}, cut_j[3] = {0, 0, 0}, cut_k[3] = {0, 0, 0}, part[3];
    corner[i] = 1;
    cut_j[i] = 1 - to_j;
    cut_j[j] = to_j;
    cut_k[i] = 1 - to_k;
    cut_k[k] = to_k;
    double weights[3][3], whole[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, pressure[3] = {p[i], 0, 0};
    memcpy(weights[0], corner, sizeof corner);
    memcpy(weights[1], cut_j, sizeof cut_j);
    memcpy(weights[2], cut_k, sizeof cut_k);
    /* one wet corner: its part; one dry corner: the whole less its part, where the pressure is negative */
    pel_vec3_scale(area, (p[i] > 0 ? 1 : -1) * to_j * to_k, part);
    add_part((const double(*)[3])weights, pressure, part, force);
    if (p[i] <= 0)
        add_part((const double(*)[3])whole, p, area, force);
}

static void find_pressures(const fluid_pressure *at, const double x[3][3], double p[3])
{
    for (int k = 0; k < 3; k++)
        p[k] = pel_vec3_dot(at->slope, x[k]) + at->offset;
}

/* N, on the corners */
static void triangle_forces(const fluid_pressure *at, const double x[3][3], double force[3][3])
{
    static const double whole[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double p[3], area[3];
    int wet = 0, apart = 0;
    memset(force, 0, 9 * sizeof(double));
    find_pressures(at, x, p);
    pel_vec3_triangle_normal(x[0], x[1], x[2], area);
    for (int k = 0; k < 3; k++)
        wet += p[k] > 0;
    if (!at->has_level || wet == 3) {
        add_part(whole, p, area, force);
        return;
    }
    if (wet == 0)
        return;
    while ((p[apart] > 0) != (wet == 1))
        apart++;
    add_cut(p, apart, area, force);
}

/* N/m: derivative of the force on corner i by the position of corner k, of a triangle under water */
static void find_slope(const fluid_pressure *at, const double x[3][3], int i, int k, double slope[3][3])
{
    double p[3], area[3], edge[3], sum = 0;
    find_pressures(at, x, p);
    pel_vec3_triangle_normal(x[0], x[1], x[2], area);
    pel_vec3_subtract(x[(k + 1) % 3], x[(k + 2) % 3], edge);
    for (int c = 0; c < 3; c++) {
        p[c] = at->has_level ? pel_max(p[c], 0) : p[c];
        sum += p[c];
    }
    const double pressure = (p[i] + sum) / 24, share = at->has_level && !(p[k] > 0) ? 0 : i == k ? 2.0 / 24 : 1.0 / 24;
    const double across[3][3] = {{0, edge[2], -edge[1]}, {-edge[2], 0, edge[0]}, {edge[1], -edge[0], 0}};
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++)
            slope[row][column] = pressure * across[row][column] + share * area[row] * at->slope[column];
}

/* ---- bodies ---- */

pel_status pel_fluids_create(pel_sim *sim, pel_error *error)
{
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        if (!(sim->model->bodies[b].fluid_density > 0))
            continue;
        sim->loads->fluid_count++;
        if (sim->model->bodies[b].shell == NULL && sim->model->bodies[b].plain_spring == 0)
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", b,
                                      "give the body a membrane, bending or springs",
                                      "a liquid presses on a body without elements");
        if (sim->stepper->descends || sim->stepper->relaxes || sim->stepper->has_lengths)
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", b,
                                      "use the method implicit, static, xpbd, pbd or explicit",
                                      "this method does not support `fluid`");
    }
    return PEL_OK;
}

pel_status pel_fluids_refuse(const pel_sim *sim, const char *what, pel_error *error)
{
    if (sim->loads->fluid_count == 0)
        return PEL_OK;
    return pel_refuse(error, PEL_BAD_ARGUMENT, "leave `fluid` out, or give its pressure as `pressure`",
                      "%s does not support `fluid`", what);
}

void pel_fluids_add(const pel_sim *sim, const pel_record *positions, pel_record *force)
{
    const fluid_places places = {.records = positions};
    for (int32_t b = 0; sim->loads->fluid_count > 0 && b < sim->model->body_count; b++) {
        const pel_body *body = &sim->model->bodies[b];
        if (!(body->fluid_density > 0))
            continue;
        const fluid_pressure at = pressure_of(sim, b, &places);
        for (int32_t i = 0; i < pel_surface_count(sim->model, b); i++) {
            const int32_t *v = pel_surface_corners(sim, b, i);
            double x[3][3], part[3][3];
            load_triangle(&places, v, x);
            triangle_forces(&at, (const double(*)[3])x, part);
            for (int k = 0; k < 3; k++)
                force[v[k]] += (pel_record){(pel_real)part[k][0], (pel_real)part[k][1], (pel_real)part[k][2], 0};
        }
        const double *g = sim->model->gravity, factor = -body->fluid_share * sim->state->load_factor;
        const pel_record back = {(pel_real)(factor * g[0]), (pel_real)(factor * g[1]), (pel_real)(factor * g[2]), 0};
        for (int32_t v = body->slice_begin * PEL_WIDTH; v < pel_body_place_end(sim->model, b); v++)
            force[v] += sim->model->mass[v] * back;
    }
}

/* J: subtracts the forces of a filling that gravity on vertices already is */
static double take_back_weight(const pel_sim *sim, int32_t b, const double *unknowns, double *gradient)
{
    PEL_ASSERT_INDEX(b, sim->model->body_count);
    const pel_body *body = &sim->model->bodies[b];
    double gravity[3], energy = 0;
    pel_vec3_scale(sim->model->gravity, body->fluid_share * sim->state->load_factor, gravity);
    for (int32_t v = body->slice_begin * PEL_WIDTH; v < pel_body_place_end(sim->model, b); v++) {
        double *at = gradient + 3 * (size_t)v, mass = (double)sim->model->mass[v];
        energy += mass * pel_vec3_dot(gravity, unknowns + 3 * (size_t)v);
        pel_vec3_along(at, mass, gravity, at);
    }
    return energy;
}

double pel_fluids_evaluate(const pel_sim *sim, const double *unknowns, double *gradient)
{
    const fluid_places places = {.unknowns = unknowns};
    double energy = 0;
    for (int32_t b = 0; sim->loads->fluid_count > 0 && b < sim->model->body_count; b++) {
        if (!(sim->model->bodies[b].fluid_density > 0))
            continue;
        const fluid_pressure at = pressure_of(sim, b, &places);
        energy += at.potential + take_back_weight(sim, b, unknowns, gradient);
        for (int32_t i = 0; i < pel_surface_count(sim->model, b); i++) {
            const int32_t *v = pel_surface_corners(sim, b, i);
            double x[3][3], force[3][3];
            load_triangle(&places, v, x);
            triangle_forces(&at, (const double(*)[3])x, force);
            for (int k = 0; k < 3; k++)
                pel_vec3_subtract(gradient + 3 * (size_t)v[k], force[k], gradient + 3 * (size_t)v[k]);
        }
    }
    return energy;
}

static void add_slopes(const fluid_pressure *at, const double x[3][3], const int32_t v[3], pel_matrix *matrix)
{
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            double slope[3][3], other[3][3];
            find_slope(at, x, i, k, slope);
            find_slope(at, x, k, i, other);
            double *block = matrix->values + matrix->block_start[pel_matrix_block(matrix, v[i], v[k])];
            for (int row = 0; row < 3; row++)
                for (int column = 0; column < 3; column++)
                    block[row + 3 * column] -= 0.5 * (slope[row][column] + other[column][row]);
        }
}

void pel_fluids_add_matrix(const pel_sim *sim, const double *unknowns, pel_matrix *matrix)
{
    const fluid_places places = {.unknowns = unknowns};
    for (int32_t b = 0; sim->loads->fluid_count > 0 && b < sim->model->body_count; b++) {
        if (!(sim->model->bodies[b].fluid_density > 0))
            continue;
        const fluid_pressure at = pressure_of(sim, b, &places);
        for (int32_t i = 0; i < pel_surface_count(sim->model, b); i++) {
            const int32_t *v = pel_surface_corners(sim, b, i);
            double x[3][3];
            load_triangle(&places, v, x);
            add_slopes(&at, (const double(*)[3])x, v, matrix);
        }
    }
}

double pel_fluids_work(const pel_sim *sim)
{
    const pel_state *state = sim->state;
    double work = 0;
    if (sim->loads->fluid_count == 0)
        return 0;
    memset(sim->force, 0, (size_t)sim->model->vertex_count * sizeof *sim->force);
    pel_fluids_add(sim, state->position, sim->force);
    pel_fluids_add(sim, state->position_next, sim->force);
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        for (int k = 0; k < 3; k++)
            work +=
                0.5 * (double)sim->force[v][k] * ((double)state->position_next[v][k] - (double)state->position[v][k]);
    return work;
}

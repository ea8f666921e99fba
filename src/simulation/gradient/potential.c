#include "pellicle/potential.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "boundary/fluid.h"
#include "boundary/follower.h"
#include "boundary/loads.h"
#include "boundary/wind.h"
#include "force/tangent.h"
#include "force/tangent_body.h"
#include "linear/matrix.h"
#include "stage/surface_view.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct pel_potential {
    pel_sim *sim;
    pel_tangent *tangent;
    pel_matrix *matrix; /* null until the first Hessian */
    int32_t vertex_count;
    int32_t *places;       /* (vertex_count) in the model's order */
    int32_t *rows;         /* (vertices of the model) -1 = padding */
    double *unknowns;      /* (unknowns of the tangent) */
    double *gradient;      /* the same */
    pel_record *dead_load; /* (vertices of the model) N, gravity included */
};

static size_t unknown_count(const pel_potential *potential)
{
    return (size_t)pel_tangent_pattern_of(potential->tangent)->unknown_count;
}

static void list_rows(pel_potential *potential)
{
    const pel_sim *sim = potential->sim;
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        potential->rows[v] = -1;
    int32_t row = 0;
    for (int32_t b = 0; b < sim->model->body_count; b++)
        for (int32_t r = 0; r < pel_output_count(sim, b); r++, row++) {
            potential->places[row] = pel_output_model_index(sim, b, r);
            potential->rows[potential->places[row]] = row;
        }
}

static pel_status allocate(pel_potential *potential, pel_error *error)
{
    const pel_sim *sim = potential->sim;
    for (int32_t b = 0; b < sim->model->body_count; b++)
        potential->vertex_count += pel_output_count(sim, b);
    size_t vertices = (size_t)sim->model->vertex_count;
    bool room = PEL_ALLOCATE_ALL(
        PEL_ROOM(potential->places, potential->vertex_count), PEL_ROOM(potential->rows, vertices),
        PEL_ROOM(potential->unknowns, unknown_count(potential)),
        PEL_ROOM(potential->gradient, unknown_count(potential)), PEL_ROOM_ALIGNED(potential->dead_load, vertices));
    return room ? PEL_OK : pel_fail_memory(error);
}

pel_status pel_potential_create(pel_sim *sim, pel_potential **potential, pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    PEL_REFUSE_NULL(potential, error);
    *potential = NULL;
    if (sim->active != NULL)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "leave refine out",
                          "a body refines: its potential has other positions after each event");
    if (sim->loads->fluid_count > 0)
        return pel_fluids_refuse(sim, "a potential", error);
    if (sim->loads->wind != NULL)
        return pel_wind_refuse(sim, "a potential", error);
    if (sim->loads->follower_count > 0)
        return pel_followers_refuse(sim, "this needs", error);
    pel_potential *made = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    made->sim = sim;
    pel_status status = pel_tangent_create(sim->model, &made->tangent, error);
    if (status == PEL_OK)
        status = allocate(made, error);
    if (status != PEL_OK) {
        pel_potential_destroy(made);
        return status;
    }
    list_rows(made);
    *potential = made;
    return PEL_OK;
}

void pel_potential_destroy(pel_potential *potential)
{
    if (potential == NULL)
        return;
    pel_tangent_destroy(potential->tangent);
    pel_matrix_destroy(potential->matrix);
    PEL_FREE_ALL(potential->places, potential->rows, potential->unknowns, potential->gradient, potential->dead_load);
    pel_free(potential);
}

int32_t pel_potential_vertex_count(const pel_potential *potential)
{
    if (potential == NULL)
        return 0;
    return potential->vertex_count;
}

/* positions into the order of the model; padding and edges become 0 */
static pel_status take_positions(pel_potential *potential, const double *positions, pel_error *error)
{
    memset(potential->unknowns, 0, unknown_count(potential) * sizeof *potential->unknowns);
    for (int32_t r = 0; r < potential->vertex_count; r++)
        for (int32_t k = 0; k < 3; k++) {
            double x = positions[3 * (size_t)r + (size_t)k];
            if (!isfinite(x))
                return pel_refuse_element(error, PEL_BAD_ARGUMENT, "vertex", r, "give finite positions",
                                          "position of vertex %d is not finite", (int)r);
            potential->unknowns[3 * (size_t)potential->places[r] + (size_t)k] = x;
        }
    pel_tangent_follow(potential->tangent, potential->unknowns);
    if (pel_tangent_pattern_of(potential->tangent)->edge_count > 0)
        pel_tangent_settle_edges(potential->tangent, potential->unknowns, NULL);
    return PEL_OK;
}

static pel_tangent_input input_of(const pel_potential *potential)
{
    return (pel_tangent_input){.unknowns = potential->unknowns,
                               .span = pel_instant(pel_sim_time(potential->sim)),
                               .state = potential->sim->state};
}

/* subtracts loads and gravity from the gradient, and returns minus their work from the rest shape */
static double add_dead_loads(pel_potential *potential)
{
    const pel_sim *sim = potential->sim;
    double energy = 0;
    memset(potential->dead_load, 0, (size_t)sim->model->vertex_count * sizeof *potential->dead_load);
    pel_loads_add(sim, pel_instant(pel_sim_time(sim)), NULL, potential->dead_load);
    for (int32_t r = 0; r < potential->vertex_count; r++) {
        int32_t v = potential->places[r];
        for (int32_t k = 0; k < 3; k++) {
            size_t unknown = 3 * (size_t)v + (size_t)k;
            double force = (double)potential->dead_load[v][k];
            energy -= force * (potential->unknowns[unknown] - (double)sim->model->rest[v][k]);
            potential->gradient[unknown] -= force;
        }
    }
    return energy;
}

pel_status pel_potential_evaluate(pel_potential *potential, const double *positions, double *energy, double *gradient,
                                  pel_error *error)
{
    PEL_REFUSE_NULL(potential, error);
    PEL_REFUSE_NULL(positions, error);
    PEL_REFUSE_NULL(energy, error);
    pel_status status = take_positions(potential, positions, error);
    if (status != PEL_OK)
        return status;
    pel_tangent_input input = input_of(potential);
    pel_tangent_energy parts =
        pel_tangent_evaluate(potential->tangent, &input, potential->sim->pool, potential->gradient);
    *energy = pel_tangent_energy_sum(&parts) + add_dead_loads(potential);
    for (int32_t r = 0; gradient != NULL && r < potential->vertex_count; r++)
        memcpy(gradient + 3 * (size_t)r, potential->gradient + 3 * (size_t)potential->places[r], 3 * sizeof(double));
    return PEL_OK;
}

/* ---- the Hessian ---- */

static pel_status create_matrix(pel_potential *potential, pel_error *error)
{
    const pel_tangent_pattern *pattern = pel_tangent_pattern_of(potential->tangent);
    if (pattern->edge_count > 0)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "set bending: { model: hinge } (or none), or use the gradient alone",
                          "bending of the model midedge has unknowns on edges beside the positions");
    if (potential->matrix != NULL)
        return PEL_OK;
    const pel_matrix_def def = {.node_count = pattern->vertex_count,
                                .element_count = pattern->element_count,
                                .element_start = pattern->node_begin,
                                .element_node = pattern->nodes,
                                .element_kind = pattern->element_kind};
    return pel_matrix_create(&def, &potential->matrix, error);
}

static pel_hessian *allocate_hessian(const pel_potential *potential, int32_t entry_count, int32_t rank_one_count)
{
    pel_hessian *hessian = pel_allocate(1, sizeof *hessian);
    if (hessian == NULL)
        return NULL;
    hessian->row_count = 3 * potential->vertex_count;
    hessian->entry_count = entry_count;
    hessian->rank_one_count = rank_one_count;
    size_t rows = (size_t)hessian->row_count, products = (size_t)rank_one_count;
    hessian->row_start = pel_allocate(rows + 1, sizeof *hessian->row_start);
    hessian->columns = pel_allocate((size_t)entry_count, sizeof *hessian->columns);
    hessian->values = pel_allocate((size_t)entry_count, sizeof *hessian->values);
    hessian->coefficients = pel_allocate(products, sizeof *hessian->coefficients);
    hessian->volume_gradients = pel_allocate(products * rows, sizeof *hessian->volume_gradients);
    if (hessian->row_start != NULL && hessian->columns != NULL && hessian->values != NULL &&
        hessian->coefficients != NULL && hessian->volume_gradients != NULL)
        return hessian;
    pel_hessian_destroy(hessian);
    return NULL;
}

void pel_hessian_destroy(pel_hessian *hessian)
{
    if (hessian == NULL)
        return;
    PEL_FREE_ALL(hessian->row_start, hessian->columns, hessian->values, hessian->coefficients,
                 hessian->volume_gradients);
    pel_free(hessian);
}

/* a block of a row of blocks */
typedef struct block_place {
    int32_t row, block;
} block_place;

static int compare_places(const void *a, const void *b)
{
    const block_place *p = a, *q = b;
    return (p->row > q->row) - (p->row < q->row);
}

/* three rows of entries from the blocks of a vertex, by ascending column; blocks has room for the longest row */
static int32_t write_rows(const pel_potential *potential, int32_t r, int32_t entry, block_place *blocks,
                          pel_hessian *hessian)
{
    const pel_matrix *matrix = potential->matrix;
    int32_t begin = matrix->row_start[potential->places[r]], count = 0;
    for (int32_t block = begin; block < matrix->row_start[potential->places[r] + 1]; block++) {
        int32_t row = potential->rows[matrix->column[block]];
        if (row >= 0)
            blocks[count++] = (block_place){row, block};
    }
    qsort(blocks, (size_t)count, sizeof *blocks, compare_places);
    for (int32_t k = 0; k < 3; k++) {
        hessian->row_start[3 * r + k] = entry;
        for (int32_t i = 0; i < 3 * count; i++, entry++) {
            hessian->columns[entry] = 3 * blocks[i / 3].row + i % 3;
            hessian->values[entry] = matrix->values[matrix->block_start[blocks[i / 3].block] + k + 3 * (i % 3)];
        }
    }
    return entry;
}

static void write_rank_ones(const pel_potential *potential, pel_hessian *hessian)
{
    const pel_tangent_pattern *pattern = pel_tangent_pattern_of(potential->tangent);
    for (int32_t i = 0; i < hessian->rank_one_count; i++) {
        const pel_rank_one *one = &pattern->rank_ones[i];
        double *row = hessian->volume_gradients + (size_t)i * (size_t)hessian->row_count;
        hessian->coefficients[i] = one->coefficient;
        for (int32_t v = 0; v < one->vertex_count; v++)
            for (int32_t k = 0; k < 3 && potential->rows[one->first_vertex + v] >= 0; k++)
                row[3 * potential->rows[one->first_vertex + v] + k] = one->gradient[3 * v + k];
    }
}

static pel_status write_hessian(const pel_potential *potential, pel_hessian **result, pel_error *error)
{
    const pel_matrix *matrix = potential->matrix;
    int32_t longest = 0, blocks = 0;
    for (int32_t v = 0; v < matrix->node_count; v++) {
        int32_t count = matrix->row_start[v + 1] - matrix->row_start[v];
        longest = count > longest ? count : longest;
        blocks += potential->rows[v] >= 0 ? count : 0;
    }
    pel_hessian *hessian =
        allocate_hessian(potential, 9 * blocks, pel_tangent_pattern_of(potential->tangent)->rank_one_count);
    block_place *room = pel_allocate((size_t)longest, sizeof *room);
    if (hessian == NULL || room == NULL) {
        pel_hessian_destroy(hessian);
        pel_free(room);
        return pel_fail_memory(error);
    }
    int32_t entry = 0;
    for (int32_t r = 0; r < potential->vertex_count; r++)
        entry = write_rows(potential, r, entry, room, hessian);
    hessian->row_start[hessian->row_count] = hessian->entry_count = entry;
    write_rank_ones(potential, hessian);
    pel_free(room);
    *result = hessian;
    return PEL_OK;
}

pel_status pel_potential_hessian(pel_potential *potential, const double *positions, pel_hessian **hessian,
                                 pel_error *error)
{
    PEL_REFUSE_NULL(potential, error);
    PEL_REFUSE_NULL(positions, error);
    PEL_REFUSE_NULL(hessian, error);
    *hessian = NULL;
    pel_status status = create_matrix(potential, error);
    if (status == PEL_OK)
        status = take_positions(potential, positions, error);
    if (status != PEL_OK)
        return status;
    pel_tangent_input input = input_of(potential);
    pel_tangent_evaluate(potential->tangent, &input, potential->sim->pool, potential->gradient);
    pel_matrix_assemble(potential->matrix, potential->sim->pool, pel_tangent_matrices, potential->tangent);
    return write_hessian(potential, hessian, error);
}

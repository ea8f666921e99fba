/* The surface of a body for its users: rows of vertices, triangles, levels. After an event the rows are rebuilt on the
   next access. */
#include "stage/surface_view.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/sort.h"
#include "pellicle/error.h"
#include "pellicle/sim_surface.h"

#include <string.h>

pel_status pel_surface_rows_create(pel_sim *sim, pel_error *error)
{
    if (sim->active == NULL)
        return PEL_OK;
    sim->rows = pel_allocate((size_t)sim->model->body_count, sizeof *sim->rows);
    bool room = sim->rows != NULL;
    for (int32_t b = 0; room && b < sim->model->body_count; b++) {
        const pel_front *front = sim->model->bodies[b].front;
        if (front == NULL)
            continue;
        pel_surface_rows *rows = &sim->rows[b];
        const pel_topology *finest = front->forest->levels[front->forest->depth];
        rows->vertices = pel_allocate((size_t)finest->vertex_count, sizeof *rows->vertices);
        rows->row_of_vertex = pel_allocate((size_t)finest->vertex_count, sizeof *rows->row_of_vertex);
        rows->surface = pel_allocate((size_t)finest->triangle_count, sizeof *rows->surface);
        rows->made_revision = -1;
        room = rows->vertices != NULL && rows->row_of_vertex != NULL && rows->surface != NULL;
    }
    return room ? PEL_OK : pel_fail_memory(error);
}

void pel_surface_rows_destroy(pel_sim *sim)
{
    for (int32_t b = 0; sim->rows != NULL && b < sim->model->body_count; b++) {
        PEL_FREE_ALL(sim->rows[b].vertices, sim->rows[b].row_of_vertex, sim->rows[b].surface);
    }
    pel_free(sim->rows);
}

static const pel_surface_rows *rows_of(const pel_sim *sim, int32_t body)
{
    const pel_front *front = sim->model->bodies[body].front;
    if (front == NULL)
        return NULL;
    pel_surface_rows *rows = &sim->rows[body];
    if (rows->made_revision == rows->revision)
        return rows;
    int32_t mesh_count = front->forest->levels[0]->vertex_count, count = 0;
    for (int32_t i = 0; i < front->vertex_count; i++)
        if (front->vertices[i] >= mesh_count)
            rows->vertices[mesh_count + count++] = front->vertices[i];
    pel_sort_int32(rows->vertices + mesh_count, count);
    for (int32_t r = 0; r < mesh_count + count; r++) {
        if (r < mesh_count)
            rows->vertices[r] = r;
        rows->row_of_vertex[rows->vertices[r]] = r;
    }
    pel_front_surface(front, rows->surface);
    rows->made_revision = rows->revision;
    return rows;
}

int32_t pel_output_count(const pel_sim *sim, int32_t body)
{
    PEL_ASSERT_INDEX(body, sim->model->body_count);
    const pel_front *front = sim->model->bodies[body].front;
    return front != NULL ? front->vertex_count : sim->model->bodies[body].mesh->vertex_count;
}

/* number in the forest of a row's vertex */
static int32_t row_vertex(const pel_sim *sim, int32_t body, int32_t row)
{
    const pel_surface_rows *rows = rows_of(sim, body);
    return rows != NULL ? rows->vertices[row] : row;
}

int32_t pel_output_model_index(const pel_sim *sim, int32_t body, int32_t row)
{
    PEL_ASSERT_INDEX(body, sim->model->body_count);
    const pel_body *b = &sim->model->bodies[body];
    if (b->front == NULL || row < b->mesh->vertex_count)
        return b->model_index[row];
    return sim->active->bodies[body].model_index[row_vertex(sim, body, row)];
}

int32_t pel_output_vertex(const pel_sim *sim, int32_t body, int32_t v)
{
    PEL_ASSERT_INDEX(body, sim->model->body_count);
    PEL_ASSERT_INDEX(v, sim->model->vertex_count);
    return v < sim->model->bodies[body].mesh->vertex_count ? v : rows_of(sim, body)->row_of_vertex[v];
}

const int32_t *pel_output_numbers(const pel_sim *sim, int32_t body)
{
    PEL_ASSERT_INDEX(body, sim->model->body_count);
    const pel_surface_rows *rows = rows_of(sim, body);
    return rows != NULL ? rows->row_of_vertex : NULL;
}

const pel_front_triangle *pel_surface_in_order(const pel_sim *sim, int32_t body)
{
    PEL_ASSERT_INDEX(body, sim->model->body_count);
    const pel_surface_rows *rows = rows_of(sim, body);
    return rows != NULL ? rows->surface : NULL;
}

const int32_t *pel_surface_corners(const pel_sim *sim, int32_t body, int32_t i)
{
    PEL_ASSERT_INDEX(body, sim->model->body_count);
    const pel_shell *shell = sim->model->bodies[body].shell;
    if (shell != NULL)
        return shell->corners[i];
    const pel_surface_rows *rows = rows_of(sim, body);
    int32_t number = rows != NULL ? pel_surface_number(&rows->surface[i]) : i;
    return sim->model->triangles[sim->model->triangle_begin[body] + number];
}

int32_t pel_sim_vertex_count(const pel_sim *sim, int32_t body)
{
    if (!pel_sim_has_body(sim, body))
        return 0;
    return pel_output_count(sim, body);
}

int32_t pel_sim_triangle_count(const pel_sim *sim, int32_t body)
{
    if (!pel_sim_has_body(sim, body))
        return 0;
    return pel_surface_count(sim->model, body);
}

bool pel_sim_refines(const pel_sim *sim, int32_t body)
{
    if (!pel_sim_has_body(sim, body))
        return false;
    return sim->model->bodies[body].detail != NULL;
}

int64_t pel_sim_surface_revision(const pel_sim *sim, int32_t body)
{
    if (!pel_sim_has_body(sim, body))
        return 0;
    return sim->cut_revision + pel_surface_event_count(sim, body);
}

int64_t pel_surface_event_count(const pel_sim *sim, int32_t body)
{
    PEL_ASSERT_INDEX(body, sim->model->body_count);
    return sim->rows != NULL ? sim->rows[body].revision : 0;
}

void pel_sim_get_triangles(const pel_sim *sim, int32_t body, int32_t *triangles)
{
    if (!pel_sim_has_body(sim, body) || triangles == NULL)
        return;
    const pel_surface_rows *rows = rows_of(sim, body);
    const pel_mesh *mesh = sim->model->bodies[body].mesh;
    int32_t count = pel_sim_triangle_count(sim, body);
    for (int32_t t = 0; t < count; t++)
        for (int c = 0; c < 3; c++)
            triangles[3 * (size_t)t + (size_t)c] =
                rows != NULL ? rows->row_of_vertex[rows->surface[t].vertices[c]] : mesh->triangles[t][c];
}

void pel_sim_get_rest_positions(const pel_sim *sim, int32_t body, double *positions)
{
    if (!pel_sim_has_body(sim, body) || positions == NULL)
        return;
    const pel_body *b = &sim->model->bodies[body];
    const double(*rest)[3] =
        (const double(*)[3])(b->detail != NULL ? b->detail->forest->rest_positions : b->mesh->positions);
    int32_t count = pel_output_count(sim, body);
    for (int32_t r = 0; r < count; r++)
        memcpy(positions + 3 * (size_t)r, rest[row_vertex(sim, body, r)], sizeof rest[0]);
}

void pel_sim_get_levels(const pel_sim *sim, int32_t body, int32_t *levels)
{
    if (!pel_sim_has_body(sim, body) || levels == NULL)
        return;
    const pel_body_levels *detail = sim->model->bodies[body].detail;
    int32_t count = pel_output_count(sim, body);
    for (int32_t r = 0; r < count; r++)
        levels[r] = detail != NULL ? pel_lod_forest_vertex_level(detail->forest, row_vertex(sim, body, r)) : 0;
}

void pel_sim_get_masses(const pel_sim *sim, int32_t body, double *masses)
{
    if (!pel_sim_has_body(sim, body) || masses == NULL)
        return;
    int32_t count = pel_output_count(sim, body);
    for (int32_t r = 0; r < count; r++)
        masses[r] = (double)sim->model->mass[pel_output_model_index(sim, body, r)];
}

/* a point of a triangle given by the weights of its corners, as a point of the parent */
static void weights_in_parent(int32_t child, double w[3])
{
    const double a = w[0], b = w[1], c = w[2];
    if (child == 3) {
        w[0] = (a + c) / 2;
        w[1] = (a + b) / 2;
        w[2] = (b + c) / 2;
        return;
    }
    w[child] = a + (b + c) / 2;
    w[(child + 1) % 3] = b / 2;
    w[(child + 2) % 3] = c / 2;
}

static int32_t place_in_mesh(const pel_lod_forest *forest, int32_t v, double w[3])
{
    PEL_ASSERT_INDEX(v, forest->levels[forest->depth]->vertex_count);
    int32_t level = pel_lod_forest_vertex_level(forest, v);
    int32_t h = forest->levels[level]->corner_of_vertex[v], t = h / 3;
    w[0] = w[1] = w[2] = 0;
    w[h % 3] = 1;
    for (; level > 0; level--) {
        weights_in_parent(t % 4, w);
        t = pel_lod_parent(t);
    }
    return t;
}

void pel_sim_get_mesh_places(const pel_sim *sim, int32_t body, int32_t *triangles, double *weights)
{
    if (!pel_sim_has_body(sim, body) || triangles == NULL || weights == NULL)
        return;
    const pel_body *b = &sim->model->bodies[body];
    int32_t count = pel_output_count(sim, body);
    if (b->detail != NULL) {
        for (int32_t r = 0; r < count; r++)
            triangles[r] = place_in_mesh(b->detail->forest, row_vertex(sim, body, r), weights + 3 * (size_t)r);
        return;
    }
    for (int32_t t = b->mesh->triangle_count - 1; t >= 0; t--)
        for (int c = 0; c < 3; c++) {
            int32_t v = b->mesh->triangles[t][c];
            triangles[v] = t;
            for (int k = 0; k < 3; k++)
                weights[3 * (size_t)v + (size_t)k] = k == c;
        }
}

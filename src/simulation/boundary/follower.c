/* A follower load F = L R R0^T f on a boundary edge: f per length L at rest, R the frame (t, m, n) of the present edge,
   R0 the frame at rest. t points along the edge with the triangle to its left, n is the normal of the triangle, m = t x
   n points outward in its plane. Each end takes one half.

   A displacement turns the frame by w = t x (u_b - u_a) / l + t n . (u_c - (1 - s) u_a - s u_b) / h, with the length l
   of the edge a b, the height h of the tip c over it and the foot a + s (b - a) of that height. So dF = w x F. The
   slope is not symmetric: the matrix of Newton's method has its symmetric part, GMRES the rest (newton/skew.c).
 */
#include "boundary/follower.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/status.h"
#include "boundary/loads.h"
#include "math/extremes.h"
#include "math/vec3.h"
#include "pellicle/topology.h"

#include <string.h>

/* rows t, m, n; the height of the tip and its foot */
typedef struct edge_frame {
    double axes[3][3], length, height, foot;
} edge_frame;

static edge_frame find_frame(const double a[3], const double b[3], const double c[3])
{
    edge_frame f;
    double side[3];
    pel_vec3_subtract(b, a, f.axes[0]);
    pel_vec3_subtract(c, a, side);
    f.length = pel_vec3_normalize(f.axes[0]);
    pel_vec3_cross(f.axes[0], side, f.axes[2]);
    f.height = pel_vec3_normalize(f.axes[2]);
    pel_vec3_cross(f.axes[0], f.axes[2], f.axes[1]);
    f.foot = pel_vec3_dot(f.axes[0], side) / f.length;
    return f;
}

/* of the vertices of the mesh: -1 = not of the load */
static void find_weights(const pel_load_def *def, int32_t vertex_count, double *weights)
{
    for (int32_t v = 0; v < vertex_count; v++)
        weights[v] = def->vertices == NULL ? (def->weights != NULL ? def->weights[v] : 1) : -1;
    for (int32_t i = 0; def->vertices != NULL && i < def->vertex_count; i++)
        weights[def->vertices[i]] = def->weights != NULL ? pel_max(def->weights[i], 0) : 1;
}

static void add_edge(pel_sim *sim, const pel_load_def *def, int32_t l, const int32_t corners[3], double weight)
{
    PEL_ASSERT_INDEX(l, sim->loads->count);
    const pel_body *body = &sim->model->bodies[def->body];
    const double(*x)[3] = (const double(*)[3])body->mesh->positions;
    const edge_frame rest = find_frame(x[corners[0]], x[corners[1]], x[corners[2]]);
    pel_follower *made = &sim->loads->followers[sim->loads->follower_count++];
    *made = (pel_follower){.load = l, .length = weight * rest.length};
    memcpy(made->rest, rest.axes, sizeof made->rest);
    for (int k = 0; k < 3; k++)
        made->vertices[k] = body->model_index[corners[k]];
}

static pel_status list_edges(pel_sim *sim, const pel_load_def *def, int32_t l, pel_error *error)
{
    PEL_ASSERT_INDEX(l, sim->loads->count);
    const pel_mesh *mesh = sim->model->bodies[def->body].mesh;
    double *weights = pel_allocate((size_t)mesh->vertex_count, sizeof *weights);
    pel_topology *topology = NULL;
    pel_status status = weights != NULL ? pel_topology_create(mesh, &topology, error) : pel_fail_memory(error);
    if (status != PEL_OK) {
        pel_free(weights);
        return status;
    }
    find_weights(def, mesh->vertex_count, weights);
    for (int32_t h = 0; h < 3 * topology->triangle_count; h++) {
        int32_t a = pel_half_edge_origin(topology, h), b = pel_half_edge_target(topology, h);
        const int32_t *v = mesh->triangles[h / 3];
        if (topology->twin[h] >= 0 || weights[a] < 0 || weights[b] < 0 || pel_is_lip(&sim->model->bodies[def->body], h))
            continue;
        const int32_t corners[3] = {a, b, v[0] + v[1] + v[2] - a - b};
        add_edge(sim, def, l, corners, 0.5 * (weights[a] + weights[b]));
    }
    pel_topology_destroy(topology);
    pel_free(weights);
    /* the edges take the load over */
    for (int32_t i = 0; i < sim->loads->items[l].vertex_count; i++)
        sim->loads->items[l].weights[i] = 0;
    return PEL_OK;
}

pel_status pel_followers_create(pel_sim *sim, const pel_sim_def *def, pel_error *error)
{
    size_t most = 0;
    for (int32_t l = 0; l < def->load_count; l++) {
        const pel_load_def *load = &def->loads[l];
        if (!load->follower)
            continue;
        if (load->kind != PEL_LOAD_PER_LENGTH)
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "load", l,
                                      "give it per length of boundary edges (`per: length`), or leave out `follower`",
                                      "a follower load must be a force per length");
        const pel_body *body = &sim->model->bodies[load->body];
        if (body->shell == NULL && body->plain_spring == 0)
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "load", l,
                                      "give the body a membrane, bending or springs",
                                      "a follower load acts on a body without elements");
        most += 3 * (size_t)sim->model->bodies[load->body].mesh->triangle_count;
    }
    if (most == 0)
        return PEL_OK;
    sim->loads->followers = pel_allocate(most, sizeof *sim->loads->followers);
    pel_status status = sim->loads->followers != NULL ? PEL_OK : pel_fail_memory(error);
    for (int32_t l = 0; status == PEL_OK && l < def->load_count; l++)
        if (def->loads[l].follower)
            status = list_edges(sim, &def->loads[l], l, error);
    return status;
}

void pel_followers_destroy(pel_sim *sim)
{
    pel_free(sim->loads->followers);
}

/* ---- forces ---- */

static void turn_force(const pel_sim *sim, const pel_follower *at, pel_span span, const edge_frame *frame,
                       double force[3])
{
    const pel_load *load = &sim->loads->items[at->load];
    double factor = pel_load_factor(sim, load, span);
    pel_vec3_set(force, 0, 0, 0);
    for (int k = 0; k < 3; k++)
        pel_vec3_along(force, factor * at->length * pel_vec3_dot(at->rest[k], load->force), frame->axes[k], force);
}

void pel_follower_force(const pel_sim *sim, int32_t i, pel_span span, const pel_record *positions, double force[3])
{
    const pel_follower *at = &sim->loads->followers[i];
    double x[3][3];
    for (int k = 0; k < 3; k++)
        pel_vertex_position(positions, at->vertices[k], x[k]);
    const edge_frame frame = find_frame(x[0], x[1], x[2]);
    turn_force(sim, at, span, &frame, force);
}

/* turns[v] d = the turn of the frame by a displacement d of end, end or tip */
static void find_turns(const edge_frame *f, double turns[3][3][3])
{
    const double *t = f->axes[0], *n = f->axes[2];
    const double by_side[3] = {-1 / f->length, 1 / f->length, 0};
    const double by_height[3] = {-(1 - f->foot) / f->height, -f->foot / f->height, 1 / f->height};
    /* t x d */
    const double across[3][3] = {{0, -t[2], t[1]}, {t[2], 0, -t[0]}, {-t[1], t[0], 0}};
    for (int v = 0; v < 3; v++)
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                turns[v][i][j] = by_side[v] * across[i][j] + by_height[v] * t[i] * n[j];
}

void pel_followers_evaluate(const pel_sim *sim, pel_span span, const double *unknowns, double *gradient)
{
    for (int32_t i = 0; i < sim->loads->follower_count; i++) {
        pel_follower *at = &sim->loads->followers[i];
        const int32_t *v = at->vertices;
        const edge_frame frame =
            find_frame(unknowns + 3 * (size_t)v[0], unknowns + 3 * (size_t)v[1], unknowns + 3 * (size_t)v[2]);
        turn_force(sim, at, span, &frame, at->force);
        find_turns(&frame, at->turns);
        for (int k = 0; k < 2; k++)
            pel_vec3_along(gradient + 3 * (size_t)v[k], -0.5, at->force, gradient + 3 * (size_t)v[k]);
    }
}

void pel_follower_slopes(const pel_sim *sim, int32_t i, double slopes[3][3][3])
{
    const pel_follower *at = &sim->loads->followers[i];
    for (int v = 0; v < 3; v++)
        for (int column = 0; column < 3; column++) {
            double turn[3], change[3];
            for (int k = 0; k < 3; k++)
                turn[k] = at->turns[v][k][column];
            pel_vec3_cross(turn, at->force, change);
            for (int row = 0; row < 3; row++)
                slopes[v][row][column] = -0.5 * change[row];
        }
}

void pel_followers_add_matrix(const pel_sim *sim, pel_matrix *matrix)
{
    for (int32_t i = 0; i < sim->loads->follower_count; i++) {
        const int32_t *v = sim->loads->followers[i].vertices;
        double slopes[3][3][3];
        pel_follower_slopes(sim, i, slopes);
        for (int end = 0; end < 2; end++)
            for (int by = 0; by < 3; by++) {
                double *block = matrix->values + matrix->block_start[pel_matrix_block(matrix, v[end], v[by])];
                double *other = matrix->values + matrix->block_start[pel_matrix_block(matrix, v[by], v[end])];
                for (int row = 0; row < 3; row++)
                    for (int column = 0; column < 3; column++) {
                        block[row + 3 * column] += 0.5 * slopes[by][row][column];
                        other[column + 3 * row] += 0.5 * slopes[by][row][column];
                    }
            }
    }
}

void pel_followers_add_skew(const pel_sim *sim, const double *x, double *y)
{
    for (int32_t i = 0; i < sim->loads->follower_count; i++) {
        const int32_t *v = sim->loads->followers[i].vertices;
        double slopes[3][3][3];
        pel_follower_slopes(sim, i, slopes);
        for (int end = 0; end < 2; end++)
            for (int by = 0; by < 3; by++)
                for (int row = 0; row < 3; row++)
                    for (int column = 0; column < 3; column++) {
                        size_t a = 3 * (size_t)v[end] + (size_t)row, b = 3 * (size_t)v[by] + (size_t)column;
                        y[a] += 0.5 * slopes[by][row][column] * x[b];
                        y[b] -= 0.5 * slopes[by][row][column] * x[a];
                    }
    }
}

pel_status pel_followers_refuse(const pel_sim *sim, const char *what, pel_error *error)
{
    if (sim->loads->follower_count == 0)
        return PEL_OK;
    return pel_refuse_element(error, PEL_BAD_ARGUMENT, "load", sim->loads->followers[0].load,
                              "leave out `follower`: the load keeps its direction",
                              "follower loads have no potential, which %s", what);
}

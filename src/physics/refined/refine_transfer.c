/* Positions and velocities over an event.

   A new vertex is placed at the middle of its edge plus the mean over the edge's two triangles of (rotation of the
   triangle) x (offset of the vertex from the middle at rest). This leaves a rigidly moved shape free of force.

   Momentum is transferred triangle by triangle. A triangle gives the mass s r_i to its corner i, s being its area and r
   the density. When a triangle is refined, a new vertex between the corners i and j takes its mass from both in
   proportion to their densities, and its velocity is their mean with these weights; when it is coarsened, mass and
   momentum return in the same proportion, half each for equal densities. So mass, linear momentum and rigid
   translations are conserved, and the kinetic energy never grows, because velocities become means (Jensen). An event
   coarsens every changed triangle to the common ancestor and refines that to the new children, so that a bisected
   triangle that turns red is treated exactly too. With velocities u_i at the corners of a triangle,

       whole:      u_i is the vertex's velocity
       bisected:   u of both ends of the split edge is the mean of theirs and the middle's
       refined:    u_0 = 1/4 [u_0 of child 0 + 1/2 (those of the middles beside it in their three children each)]

   do not depend on densities. The quasi-static method stores x - x_before instead of velocities. */
#include "base/assert.h"
#include "math/matrix2.h"
#include "math/vec3.h"
#include "refined/refined_model.h"

#include <string.h>

/* ---- positions ---- */

/* axes of a triangle as rows: along its first edge, across, normal; and its second and third corner in them */
typedef struct frame {
    double axes[3][3];
    double corners[3]; /* (x1, 0), (x2, y2) */
} frame;

static void frame_of(const double x[3][3], frame *f)
{
    double across[3];
    pel_vec3_subtract(x[1], x[0], f->axes[0]);
    pel_vec3_triangle_normal(x[0], x[1], x[2], f->axes[2]);
    f->corners[0] = pel_vec3_normalize(f->axes[0]);
    pel_vec3_normalize(f->axes[2]);
    pel_vec3_cross(f->axes[2], f->axes[0], f->axes[1]);
    pel_vec3_subtract(x[2], x[0], across);
    f->corners[1] = pel_vec3_dot(across, f->axes[0]);
    f->corners[2] = pel_vec3_dot(across, f->axes[1]);
}

/* turns an offset as the triangle turned from its rest to its present shape, and adds it */
static void add_turned(const double rest[3][3], const double now[3][3], const double offset[3], double sum[3])
{
    frame from, to;
    frame_of(rest, &from);
    frame_of(now, &to);
    if (!(from.corners[0] > 0 && from.corners[2] > 0))
        return;
    double stretch = to.corners[0] / from.corners[0];
    const double gradient[4] = {stretch, (to.corners[1] - stretch * from.corners[1]) / from.corners[2], 0,
                                to.corners[2] / from.corners[2]};
    double rotation[4];
    pel_matrix2_rotation(gradient, rotation);
    double a = pel_vec3_dot(offset, from.axes[0]), b = pel_vec3_dot(offset, from.axes[1]);
    double turned[3] = {rotation[0] * a + rotation[1] * b, rotation[2] * a + rotation[3] * b,
                        pel_vec3_dot(offset, from.axes[2])};
    for (int i = 0; i < 3; i++)
        pel_vec3_along(sum, turned[i], to.axes[i], sum);
}

static void place_vertex(const pel_refined_body *body, const pel_state *state, int32_t v, double x[3])
{
    const pel_lod_forest *forest = body->front->forest;
    const double(*rest)[3] = (const double(*)[3])forest->rest_positions;
    const pel_topology *coarse = forest->levels[pel_lod_forest_vertex_level(forest, v) - 1];
    int32_t h = coarse->half_edge_of_edge[v - coarse->vertex_count], sides[2] = {h / 3, coarse->twin[h]};
    int32_t a = pel_half_edge_origin(coarse, h), b = pel_half_edge_target(coarse, h);
    double xa[3], xb[3], offset[3], sum[3] = {0, 0, 0};
    int side_count = sides[1] < 0 ? 1 : 2;
    sides[1] /= 3;
    for (int i = 0; i < 3; i++)
        offset[i] = rest[v][i] - (rest[a][i] + rest[b][i]) / 2;
    for (int s = 0; s < side_count; s++) {
        double from[3][3], to[3][3];
        for (int c = 0; c < 3; c++) {
            int32_t corner = coarse->triangles[sides[s]][c];
            pel_vec3_copy(rest[corner], from[c]);
            pel_vertex_position(state->position, body->model_index[corner], to[c]);
        }
        add_turned((const double(*)[3])from, (const double(*)[3])to, offset, sum);
    }
    pel_vertex_position(state->position, body->model_index[a], xa);
    pel_vertex_position(state->position, body->model_index[b], xb);
    for (int i = 0; i < 3; i++)
        x[i] = (xa[i] + xb[i]) / 2 + sum[i] / side_count;
}

void pel_refine_transfer_positions(const pel_refined_model *active, int32_t body, pel_state *state)
{
    PEL_ASSERT_INDEX(body, active->model.body_count);
    const pel_refined_body *b = &active->bodies[body];
    for (int32_t i = 0; i < b->front->added_count; i++) {
        int32_t v = b->front->added_vertices[i], place = b->model_index[v];
        double x[3];
        place_vertex(b, state, v, x);
        state->position[place] = (pel_record){(pel_real)x[0], (pel_real)x[1], (pel_real)x[2], 0};
        state->position_before[place] = state->position_next[place] = state->position[place];
        state->contact[place] = 0;
        if (state->velocity != NULL)
            state->velocity[place] = state->velocity_next[place] = (pel_record){0};
    }
}

/* ---- momentum ---- */

typedef struct transfer {
    pel_refined_model *active;
    const pel_refined_body *body;
    const pel_body_levels *detail;
    const pel_state *state;
} transfer;

static void velocity_of(const transfer *run, int32_t v, double velocity[3])
{
    int32_t place = run->body->model_index[v];
    const pel_state *state = run->state;
    for (int i = 0; i < 3; i++)
        velocity[i] = state->velocity != NULL
                          ? (double)state->velocity[place][i]
                          : (double)state->position[place][i] - (double)state->position_before[place][i];
}

static void mean(const double a[3], const double b[3], double middle[3])
{
    for (int i = 0; i < 3; i++)
        middle[i] = (a[i] + b[i]) / 2;
}

static const pel_topology *level_of(const transfer *run, int32_t level)
{
    return run->body->front->forest->levels[level];
}

/* velocities at the corners of a triangle as it was before the event */
static void gather(const transfer *run, int32_t level, int32_t t, double u[3][3])
{
    const pel_front *front = run->body->front;
    uint8_t shape = front->old_shapes[front->node_begin[level] + t];
    const pel_topology *topology = level_of(run, level);
    if (shape == PEL_FRONT_RED) {
        double child[4][3][3];
        for (int32_t i = 0; i < 4; i++)
            gather(run, level + 1, pel_lod_child(t, i), child[i]);
        for (int i = 0; i < 3; i++) {
            int before = (i + 2) % 3, after = (i + 1) % 3;
            for (int c = 0; c < 3; c++)
                u[i][c] = (child[i][0][c] + (child[i][1][c] + child[after][2][c] + child[3][i][c]) / 2 +
                           (child[i][2][c] + child[before][1][c] + child[3][before][c]) / 2) /
                          4;
        }
        return;
    }
    for (int i = 0; i < 3; i++)
        velocity_of(run, topology->triangles[t][i], u[i]);
    if (pel_front_is_green(shape)) {
        int k = shape - PEL_FRONT_BISECTED;
        double middle[3];
        velocity_of(run, pel_lod_midpoint(topology, 3 * t + k), middle);
        mean(u[k], middle, u[k]);
        mean(u[(k + 1) % 3], middle, u[(k + 1) % 3]);
    }
}

/* vertex v takes the velocity u for the part of its mass that belongs to this area */
static void give(const transfer *run, int32_t v, double area, const double u[3])
{
    double old[3], *change = run->active->change[run->body->model_index[v]];
    velocity_of(run, v, old);
    for (int i = 0; i < 3; i++)
        change[i] += area * run->detail->densities[v].mass * (u[i] - old[i]);
}

static void between(const transfer *run, int32_t a, int32_t b, const double ua[3], const double ub[3], double u[3])
{
    double p = run->detail->densities[a].mass, q = run->detail->densities[b].mass;
    for (int i = 0; i < 3; i++)
        u[i] = ua[i] == ub[i] ? ua[i] : (p * ua[i] + q * ub[i]) / (p + q);
}

/* hands the velocities at the corners of a triangle to the vertices that it has now */
static void scatter(const transfer *run, int32_t level, int32_t t, double area, double u[3][3])
{
    const pel_front *front = run->body->front;
    uint8_t shape = front->shapes[front->node_begin[level] + t];
    const pel_topology *topology = level_of(run, level);
    const int32_t *v = topology->triangles[t];
    double middle[3][3];
    if (shape == PEL_FRONT_RED) {
        for (int i = 0; i < 3; i++)
            between(run, v[i], v[(i + 1) % 3], u[i], u[(i + 1) % 3], middle[i]);
        for (int32_t i = 0; i < 3; i++) {
            double corner[3][3];
            pel_vec3_copy(u[i], corner[0]);
            pel_vec3_copy(middle[i], corner[1]);
            pel_vec3_copy(middle[(i + 2) % 3], corner[2]);
            scatter(run, level + 1, pel_lod_child(t, i), area / 4, corner);
        }
        scatter(run, level + 1, pel_lod_child(t, 3), area / 4, middle);
        return;
    }
    int k = pel_front_is_green(shape) ? shape - PEL_FRONT_BISECTED : -1;
    for (int i = 0; i < 3; i++)
        give(run, v[i], k >= 0 && i != (k + 2) % 3 ? area / 2 : area, u[i]);
    if (k < 0)
        return;
    between(run, v[k], v[(k + 1) % 3], u[k], u[(k + 1) % 3], middle[0]);
    give(run, pel_lod_midpoint(topology, 3 * t + k), area, middle[0]);
}

void pel_refine_transfer_gather(pel_refined_model *active, int32_t body, const pel_state *state)
{
    PEL_ASSERT_INDEX(body, active->model.body_count);
    const pel_front *front = active->bodies[body].front;
    transfer run = {active, &active->bodies[body], active->model.bodies[body].detail, state};
    for (int32_t c = 0; c < front->change_count; c++) {
        const pel_front_change *change = &front->changes[c];
        /* new and removed triangles lie within an ancestor in the list */
        if (change->before == PEL_FRONT_ABSENT || change->after == PEL_FRONT_ABSENT)
            continue;
        int32_t level = pel_front_level(front, change->node), t = change->node - front->node_begin[level];
        double u[3][3], area = run.detail->areas[t >> (2 * level)] / (double)(INT64_C(1) << (2 * level));
        gather(&run, level, t, u);
        scatter(&run, level, t, area, u);
    }
}

void pel_refine_transfer_apply(pel_refined_model *active, int32_t body, pel_state *state)
{
    PEL_ASSERT_INDEX(body, active->model.body_count);
    const pel_refined_body *b = &active->bodies[body];
    for (int32_t d = 0; d < active->dirty_count; d++) {
        int32_t place = b->model_index[active->dirty[d]];
        double *change = active->change[place], mass = (double)active->model.mass[place];
        bool moves = active->model.inverse_mass[place] > 0;
        for (int i = 0; i < 3; i++) {
            if (moves && change[i] != 0 && state->velocity != NULL)
                state->velocity[place][i] += (pel_real)(change[i] / mass);
            else if (moves && change[i] != 0)
                state->position_before[place][i] -= (pel_real)(change[i] / mass);
            change[i] = 0;
        }
    }
}

/* The edges of mid-edge bending: angles, finite steps, and the minimum of the bending energy over their rotations. */
#include "force/tangent_lanes.h"
#include "math/vec3.h"
#include "measure/face_turn.h"
#include "measure/hinge.h"

#include <math.h>
#include <string.h>

/* a loop over the edges */
typedef struct edge_loop {
    pel_tangent *tangent;
    const double *unknowns, *step;
    double scale;
    double *xi; /* null = angles */
} edge_loop;

/* Lanes have the edges from `first` on; unused ones repeat the last. An edge of the boundary takes its own tip for the
   second one. */
typedef struct edge_lanes {
    const pel_tangent_edge *edges[PEL_TANGENT_LANES];
    int32_t vertices[PEL_TANGENT_LANES][4];
    const int32_t *nodes[PEL_TANGENT_LANES];
} edge_lanes;

static void load_edges(const edge_loop *loop, int32_t first, int32_t end, edge_lanes *at)
{
    for (int l = 0; l < PEL_TANGENT_LANES; l++) {
        at->edges[l] = &loop->tangent->edges[first + l < end ? first + l : end - 1];
        memcpy(at->vertices[l], at->edges[l]->vertices, sizeof at->vertices[l]);
        if (at->edges[l]->triangles[1] < 0)
            at->vertices[l][3] = at->vertices[l][2];
        at->nodes[l] = at->vertices[l];
    }
}

/* An angle of positions has no turns. Before equilibrium a fold may close until its sides pass through each other: its
   angle continues there, as xi does. */
static void find_angles(const edge_loop *loop, int32_t first, int32_t end)
{
    const double half_turn = 3.141592653589793;
    edge_lanes at;
    pel_particle points[4];
    load_edges(loop, first, end, &at);
    for (int k = 0; k < 4; k++)
        points[k] = (pel_particle){pel_tangent_corner(loop->unknowns, at.nodes, k), pel_lane_splat(0)};
    const pel_lane angles = pel_hinge_angle_of(points, pel_lane_splat(1), pel_lane_splat(0)).difference;
    for (int l = 0; l < PEL_TANGENT_LANES && first + l < end; l++) {
        const double half = 0.5 * pel_angle_the_short_way(pel_tangent_lane(&angles, l), at.edges[l]->rest_angle);
        const double turns = rint((loop->tangent->first_half_angles[first + l] - half) / half_turn);
        loop->tangent->half_angles[first + l] = at.edges[l]->triangles[1] < 0 ? 0 : half + half_turn * turns;
    }
}

/* the finite turns of one triangle of each edge over the step */
static pel_lane find_turns(const edge_loop *loop, const edge_lanes *at, int tail, int head, int tip)
{
    const int corners[3] = {tail, head, tip};
    pel_lane3 before[3], after[3];
    for (int k = 0; k < 3; k++) {
        before[k] = pel_tangent_corner(loop->unknowns, at->nodes, corners[k]);
        const pel_lane3 step = pel_tangent_corner(loop->step, at->nodes, corners[k]);
        after[k] = pel_lane3_add(before[k], pel_lane3_scale(step, pel_lane_splat(loop->scale)));
    }
    const pel_face_turn first = pel_face_turn_of(before[0], before[1], before[2]);
    const pel_face_turn last = pel_face_turn_of(after[0], after[1], after[2]);
    return pel_face_turn_between(&first, &last);
}

static void advance_edges(const edge_loop *loop, int32_t first, int32_t end)
{
    const double *psi = loop->step + 3 * (size_t)loop->tangent->pattern.vertex_count;
    edge_lanes at;
    load_edges(loop, first, end, &at);
    const pel_lane one = find_turns(loop, &at, 0, 1, 2), other = find_turns(loop, &at, 1, 0, 3);
    for (int l = 0; l < PEL_TANGENT_LANES && first + l < end; l++) {
        const double turn = pel_tangent_lane(&one, l), second = pel_tangent_lane(&other, l);
        const double own = loop->scale * psi[first + l];
        loop->xi[first + l] += own + (at.edges[l]->triangles[1] < 0 ? turn : 0.5 * (turn - second));
    }
}

static void edge_chunk(void *context, int32_t chunk)
{
    const edge_loop *loop = context;
    int32_t first = chunk * PEL_TANGENT_CHUNK, count = loop->tangent->pattern.edge_count;
    int32_t end = first + PEL_TANGENT_CHUNK < count ? first + PEL_TANGENT_CHUNK : count;
    for (int32_t e = first; e < end; e += PEL_TANGENT_LANES)
        if (loop->xi != NULL)
            advance_edges(loop, e, end);
        else
            find_angles(loop, e, end);
}

void pel_tangent_find_angles(pel_tangent *tangent, const double *unknowns, pel_pool *pool)
{
    edge_loop loop = {.tangent = tangent, .unknowns = unknowns};
    pel_pool_run(pool, pel_tangent_chunk_count(tangent->pattern.edge_count), edge_chunk, &loop);
}

void pel_tangent_advance(pel_tangent *tangent, double *unknowns, const double *step, double scale, pel_pool *pool)
{
    size_t positions = 3 * (size_t)tangent->pattern.vertex_count;
    edge_loop loop = {tangent, unknowns, step, scale, unknowns + positions};
    pel_pool_run(pool, pel_tangent_chunk_count(tangent->pattern.edge_count), edge_chunk, &loop);
    for (size_t i = 0; i < positions; i++)
        unknowns[i] += scale * step[i];
}

/* angles of positions alone, from which the others continue */
static void find_first_angles(pel_tangent *tangent, const double *unknowns)
{
    size_t bytes = (size_t)tangent->pattern.edge_count * sizeof *tangent->half_angles;
    memset(tangent->first_half_angles, 0, bytes);
    pel_tangent_find_angles(tangent, unknowns, NULL);
    memcpy(tangent->first_half_angles, tangent->half_angles, bytes);
}

/* ---- minimum over rotations ---- */

/* result = derivative of the bending energy by xi where alpha = share half_angle + sign xi, 0 on fixed edges; diagonal
   (may be null) of that matrix */
static void edge_moments(const pel_tangent *tangent, const double *xi, double share, const uint8_t *is_fixed,
                         double *result, double *diagonal)
{
    size_t size = (size_t)tangent->pattern.edge_count * sizeof(double);
    memset(result, 0, size);
    if (diagonal != NULL)
        memset(diagonal, 0, size);
    for (int32_t b = 0; b < tangent->shell_count; b++) {
        const pel_tangent_shell *own = &tangent->shells[b];
        for (int32_t t = 0; own->midedges != NULL && t < own->shell->triangle_count; t++) {
            static const int at[3] = {0, 3, 5};
            double alpha[3], sign[3], moment[3];
            int32_t e[3];
            for (int k = 0; k < 3; k++) {
                e[k] = pel_tangent_edge_of(own->edges[t][k], &sign[k]);
                alpha[k] = share * tangent->half_angles[e[k]] + sign[k] * xi[e[k]];
            }
            pel_midedge_moments(&own->midedges[t], alpha, moment);
            for (int k = 0; k < 3; k++) {
                result[e[k]] += sign[k] * moment[k];
                if (diagonal != NULL)
                    diagonal[e[k]] += own->midedges[t].stiffness[at[k]];
            }
        }
    }
    for (int32_t e = 0; is_fixed != NULL && e < tangent->pattern.edge_count; e++)
        if (is_fixed[e])
            result[e] = 0;
}

static double dot(const double *a, const double *b, int32_t count)
{
    double sum = 0;
    for (int32_t i = 0; i < count; i++)
        sum += a[i] * b[i];
    return sum;
}

/* conjugate gradients with the diagonal as preconditioner */
int pel_tangent_settle_edges(pel_tangent *tangent, double *unknowns, const uint8_t *is_fixed)
{
    enum { MOST = 1000 };
    int32_t count = tangent->pattern.edge_count;
    double *xi = unknowns + 3 * (size_t)tangent->pattern.vertex_count;
    double *residual = tangent->settle[0], *direction = tangent->settle[1], *image = tangent->settle[2];
    double *diagonal = tangent->settle[3], product = 0, start = 0;
    find_first_angles(tangent, unknowns);
    edge_moments(tangent, xi, 1, is_fixed, residual, diagonal);
    for (int32_t e = 0; e < count; e++) {
        direction[e] = diagonal[e] > 0 ? -residual[e] / diagonal[e] : 0;
        product -= residual[e] * direction[e];
    }
    start = product;
    int iterations = 0;
    while (product > 1e-24 * start && iterations < MOST) {
        edge_moments(tangent, direction, 0, is_fixed, image, NULL);
        double step = product / dot(direction, image, count), next = 0;
        for (int32_t e = 0; e < count; e++) {
            xi[e] += step * direction[e];
            residual[e] += step * image[e];
            next += diagonal[e] > 0 ? residual[e] * residual[e] / diagonal[e] : 0;
        }
        for (int32_t e = 0; e < count; e++)
            direction[e] = next / product * direction[e] - (diagonal[e] > 0 ? residual[e] / diagonal[e] : 0);
        product = next;
        iterations++;
    }
    return iterations;
}

/* ---- clamped edges ---- */

/* the normal at rest of the first triangle, turned as the edge's direction is from that at rest */
static void carried_normal(const double rest[3][3], const double now[3][3], double normal[3])
{
    double from[3], to[3], both[3];
    pel_vec3_triangle_normal(rest[0], rest[1], rest[2], normal);
    pel_vec3_subtract(rest[1], rest[0], from);
    pel_vec3_subtract(now[1], now[0], to);
    pel_vec3_normalize(from);
    pel_vec3_normalize(to);
    pel_vec3_add(from, to, both);
    pel_vec3_along(normal, -pel_vec3_dot(normal, to) / (1 + pel_vec3_dot(from, to)), both, normal);
}

void pel_tangent_clamp_edges(pel_tangent *tangent, double *unknowns, const uint8_t *is_fixed)
{
    double *xi = unknowns + 3 * (size_t)tangent->pattern.vertex_count;
    find_first_angles(tangent, unknowns);
    for (int32_t e = 0; e < tangent->pattern.edge_count; e++) {
        double rest[3][3], now[3][3], normal[3];
        if (!is_fixed[e])
            continue;
        for (int k = 0; k < 3; k++)
            pel_vertex_position(tangent->model->rest, tangent->edges[e].vertices[k], rest[k]);
        pel_tangent_points(unknowns, tangent->edges[e].vertices, 3, now[0]);
        carried_normal((const double(*)[3])rest, (const double(*)[3])now, normal);
        xi[e] = pel_midedge_angle((const double(*)[3])now, normal) - tangent->half_angles[e];
    }
}

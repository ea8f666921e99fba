/* The configurational force on the tip of a cut: the energy that is released per length by which the tip moves on in
   the rest shape. With weights q that fall from 1 at the tip to 0 on the last of some rings, energy density psi and
   first Piola-Kirchhoff stress P,

       J = sum over triangles  A (F^T P - psi 1) grad q

   (the domain integral of Shih, Moran and Nakamura 1986, in the form of Maugin 1993). P grad q = sum_a q_a g_a / A with
   the gradients g_a of the energy of a triangle on its corners, so the law itself does not appear; a vector of the rest
   triangle with F^T w is the one whose products with its sides are those of w with the present sides. */
#include "pellicle/tear.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "force/mechanics.h"
#include "math/vec3.h"
#include "pellicle/topology.h"
#include "stage/stage.h"

#include <string.h>

/* q is 1 up to the first ring of vertices, where the field of elements is poor, and falls linearly to 0 at the last */
enum { RINGS = 4 };

typedef struct survey {
    pel_sim *sim;
    int32_t body;
    pel_topology *topology;
    double *weights; /* (mesh vertices) q of the tip at work */
    int32_t *queue, *rings;
} survey;

/* ---- rings ---- */

/* vertices around a vertex, first those that its half-edges lead to, then the tail at the border */
static int32_t visit(const survey *s, int32_t v, int32_t ring, int32_t count)
{
    int32_t first = s->topology->corner_of_vertex[v], h = first;
    do {
        const int32_t ends[2] = {pel_half_edge_target(s->topology, h),
                                 pel_half_edge_origin(s->topology, pel_half_edge_previous(h))};
        for (int i = 0; i < 2; i++)
            if (s->rings[ends[i]] < 0) {
                s->rings[ends[i]] = ring;
                s->queue[count++] = ends[i];
            }
        h = pel_half_edge_turn(s->topology, h);
    } while (h >= 0 && h != first);
    return count;
}

/* fills queue and rings; returns the number of vertices */
static int32_t find_rings(survey *s, int32_t tip)
{
    int32_t count = 0;
    s->queue[count++] = tip;
    s->rings[tip] = 0;
    for (int32_t i = 0; i < count && s->rings[s->queue[i]] < RINGS; i++)
        count = visit(s, s->queue[i], s->rings[s->queue[i]] + 1, count);
    for (int32_t i = 0; i < count; i++) {
        int32_t ring = s->rings[s->queue[i]];
        s->weights[s->queue[i]] = ring <= 1 ? 1 : (double)(RINGS - ring) / (RINGS - 1);
    }
    return count;
}

static void clear_rings(survey *s, int32_t count)
{
    for (int32_t i = 0; i < count; i++) {
        s->rings[s->queue[i]] = -1;
        s->weights[s->queue[i]] = 0;
    }
}

/* ---- the force ---- */

/* the vector in the plane of two sides that has these products with them */
static void from_products(const double sides[2][3], const double products[2], double vector[3])
{
    double a = pel_vec3_dot(sides[0], sides[0]), b = pel_vec3_dot(sides[0], sides[1]),
           c = pel_vec3_dot(sides[1], sides[1]), scale = 1 / (a * c - b * b);
    pel_vec3_scale(sides[0], scale * (c * products[0] - b * products[1]), vector);
    pel_vec3_along(vector, scale * (a * products[1] - b * products[0]), sides[1], vector);
}

/* adds the springs on the sides of a triangle, half of those that two triangles share; returns their energy */
static double add_springs(const survey *s, int32_t t, const double x[3][3], double gradient[3][3])
{
    const pel_model *model = s->sim->model;
    const pel_body *body = &model->bodies[s->body];
    double factor = s->sim->state->factors[s->body][PEL_SPRING_STIFFNESS], energy = 0;
    for (int k = 0; k < 3 && body->plain_spring != 0; k++) {
        int32_t h = 3 * t + k, next = (k + 1) % 3, place = body->model_index[body->mesh->triangles[t][k]],
                other = body->model_index[body->mesh->triangles[t][next]], slot = model->slot_begin[place / PEL_WIDTH];
        while (model->neighbours[slot][place % PEL_WIDTH] != other)
            slot++;
        double stiffness =
            body->uniform_spring >= 0 ? body->uniform_spring : (double)model->stiffnesses[slot][place % PEL_WIDTH];
        double along[3], rest = (double)pel_model_rest_length(model, slot, place);
        pel_vec3_subtract(x[next], x[k], along);
        stiffness *= factor * (s->topology->twin[h] >= 0 ? 0.5 : 1);
        double length = pel_vec3_normalize(along), stretch = length - rest;
        energy += 0.5 * stiffness * stretch * stretch;
        pel_vec3_along(gradient[next], stiffness * stretch, along, gradient[next]);
        pel_vec3_along(gradient[k], -stiffness * stretch, along, gradient[k]);
    }
    return energy;
}

static void add_triangle(const survey *s, int32_t t, double force[3])
{
    const pel_body *body = &s->sim->model->bodies[s->body];
    const int32_t *v = body->mesh->triangles[t];
    double x[3][3], gradient[3][3] = {{0}}, pull[3] = {0}, rest[2][3], side[3], products[2], part[3], q[3];
    for (int c = 0; c < 3; c++) {
        q[c] = s->weights[v[c]];
        pel_vertex_position(s->sim->state->position, body->model_index[v[c]], x[c]);
    }
    if (q[0] == q[1] && q[1] == q[2])
        return;
    double energy =
        pel_mechanics_gradient(s->sim->shells, s->body, t, s->sim->state->position, pel_sim_time(s->sim), gradient);
    energy += add_springs(s, t, (const double(*)[3])x, gradient);
    for (int c = 0; c < 3; c++)
        pel_vec3_along(pull, q[c], gradient[c], pull);
    for (int i = 0; i < 2; i++) {
        pel_vec3_subtract(body->mesh->positions[v[i]], body->mesh->positions[v[2]], rest[i]);
        pel_vec3_subtract(x[i], x[2], side);
        products[i] = pel_vec3_dot(side, pull) - energy * (q[i] - q[2]);
    }
    from_products((const double(*)[3])rest, products, part);
    pel_vec3_add(force, part, force);
}

static bool has_weight(const survey *s, const int32_t v[3])
{
    return s->weights[v[0]] > 0 || s->weights[v[1]] > 0 || s->weights[v[2]] > 0;
}

static void read_tip(survey *s, int32_t vertex, int32_t behind, pel_tip *tip)
{
    const pel_body *body = &s->sim->model->bodies[s->body];
    int32_t count = find_rings(s, vertex);
    *tip = (pel_tip){.body = s->body, .vertex = vertex};
    pel_vertex_position(s->sim->state->position, body->model_index[vertex], tip->position);
    pel_vec3_subtract(body->mesh->positions[vertex], body->mesh->positions[behind], tip->ahead);
    pel_vec3_normalize(tip->ahead);
    for (int32_t t = 0; t < body->mesh->triangle_count; t++)
        if (has_weight(s, body->mesh->triangles[t]))
            add_triangle(s, t, tip->force);
    tip->release = pel_vec3_length(tip->force);
    clear_rings(s, count);
}

/* ---- tips ---- */

/* where two lips meet in a vertex that was not divided; the vertex before it along one of them, -1 = no tip */
static int32_t find_behind(const survey *s, int32_t v)
{
    const pel_body *body = &s->sim->model->bodies[s->body];
    int32_t h = s->topology->corner_of_vertex[v], last = h;
    if (s->topology->twin[h] >= 0 || body->shares[v] < 1 || !pel_is_lip(body, h))
        return -1;
    while (pel_half_edge_turn(s->topology, last) >= 0)
        last = pel_half_edge_turn(s->topology, last);
    return pel_is_lip(body, pel_half_edge_previous(last)) ? pel_half_edge_target(s->topology, h) : -1;
}

static pel_status begin(survey *s, pel_error *error)
{
    const pel_mesh *mesh = s->sim->model->bodies[s->body].mesh;
    size_t count = (size_t)mesh->vertex_count;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(s->weights, count), PEL_ROOM(s->queue, count), PEL_ROOM(s->rings, count)))
        return pel_fail_memory(error);
    memset(s->rings, -1, count * sizeof *s->rings);
    return pel_topology_create(mesh, &s->topology, error);
}

pel_status pel_sim_tips(pel_sim *sim, int32_t body, pel_tip *tips, int32_t room, int32_t *count, pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    PEL_REFUSE_NULL(count, error);
    *count = 0;
    if (!pel_sim_has_body(sim, body) || (tips == NULL && room > 0))
        return pel_fail(error, PEL_BAD_ARGUMENT, "body %d does not exist, or tips is null", (int)body);
    if (sim->model->bodies[body].shares == NULL)
        return PEL_OK;
    survey s = {.sim = sim, .body = body};
    pel_status status = begin(&s, error);
    pel_shell_forces_follow(sim->shells, sim->state->position);
    for (int32_t v = 0; status == PEL_OK && v < s.topology->vertex_count; v++) {
        int32_t behind = find_behind(&s, v);
        if (behind < 0)
            continue;
        if (*count < room)
            read_tip(&s, v, behind, &tips[*count]);
        ++*count;
    }
    pel_topology_destroy(s.topology);
    PEL_FREE_ALL(s.weights, s.queue, s.rings);
    return status;
}

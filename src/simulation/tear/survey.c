/* The configurational force on the tip of a cut: the energy that is released per length by which the tip moves on in
   the rest shape. With weights q that fall from 1 at the tip to 0 on the last of some rings, energy density psi, first
   Piola-Kirchhoff stress P, and forces f on vertices from outside,

       J = sum over triangles  A (F^T P - psi 1) grad q  -  sum over vertices  q F^T f

   (the domain integral of Shih, Moran and Nakamura 1986, in the form of Maugin 1993). P grad q = sum_a q_a g_a / A with
   the gradients g_a of the energy of a triangle on its corners, so the law itself does not appear; a vector of the rest
   triangle with F^T w is the one whose products with its sides are those of w with the present sides. The sum of the
   gradients around a vertex is f: loads, grasps, contacts, fillings, bending and inertia alike. It is not taken at the
   tip, where F has no mean.

   q is 0 at the border but on the two sides of the cut: a border that moved on with the tip would release energy too.
   So would the sides of the cut where they moved sideways with the tip, if one is stretched more than the other: that
   is taken out (Eischen 1987). No force acts across a side, so its energy is that of a strip, E h e^2 / 2 by its strain
   e, and both sides differ by E h times their mean strain times the difference of their strains. The sum of the latter
   is how far the sides slid on each other, which elements resolve up to the tip; the mean leaves the two edges next to
   the tip out.
 */
#include "tear/survey.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "force/mechanics.h"
#include "math/extremes.h"
#include "math/functions.h"
#include "math/vec3.h"
#include "tear/material.h"

#include <math.h>
#include <string.h>

/* q is 1 up to the first ring of vertices, where the field of elements is poor, and falls linearly to 0 at the last */
enum { LEAST_RINGS = 4, MOST_RINGS = 12 };
/* over toughness / young, where strains of a tip that is about to grow are 0.35; of the root of the area of the body */
#define REACH 1.3
#define MOST_REACH 0.2
/* rad, within the surface: a corner of the border with more is a notch */
#define LEAST_NOTCH (1.5 * 3.141592653589793 + 0.02)
/* cosine: sides of a notch go on where the border bends less */
#define STRAIGHT 0.85

/* ---- rings ---- */

static int32_t add(pel_survey *s, int32_t v, int32_t ring, int32_t count)
{
    if (s->rings[v] >= 0)
        return count;
    s->rings[v] = ring;
    s->queue[count] = v;
    return count + 1;
}

/* the vertices that half-edges lead to, then the tail at the border */
static int32_t add_neighbours(pel_survey *s, int32_t v, int32_t count)
{
    int32_t ring = s->rings[v] + 1;
    for (int32_t h = s->topology->corner_of_vertex[v]; h >= 0; h = pel_survey_turn(s, v, h)) {
        count = add(s, pel_half_edge_target(s->topology, h), ring, count);
        count = add(s, pel_half_edge_origin(s->topology, pel_half_edge_previous(h)), ring, count);
    }
    return count;
}

int32_t pel_survey_walk(pel_survey *s, int32_t vertex, int32_t ring_count)
{
    int32_t count = add(s, vertex, 0, 0);
    for (int32_t i = 0; i < count && s->rings[s->queue[i]] < ring_count; i++)
        count = add_neighbours(s, s->queue[i], count);
    return count;
}

int32_t pel_survey_spread(pel_survey *s, int32_t vertex, double distance)
{
    const pel_mesh *mesh = s->sim->model->bodies[s->body].mesh;
    int32_t count = add(s, vertex, 0, 0);
    for (int32_t i = 0; i < count; i++)
        if (pel_vec3_distance(mesh->positions[s->queue[i]], mesh->positions[vertex]) <= distance)
            count = add_neighbours(s, s->queue[i], count);
    return count;
}

void pel_survey_leave(pel_survey *s, int32_t count)
{
    for (int32_t i = 0; i < count; i++) {
        int32_t v = s->queue[i];
        s->rings[v] = -1;
        s->weights[v] = s->areas[v] = 0;
        s->is_side[v] = 0;
        pel_vec3_set(s->sums[v], 0, 0, 0);
    }
}

/* ---- the border ---- */

static bool is_border(const pel_survey *s, int32_t v)
{
    return s->topology->twin[s->topology->corner_of_vertex[v]] < 0;
}

/* half-edges of the border that leave a vertex of it, and that come to it */
static int32_t border_from(const pel_survey *s, int32_t v)
{
    return s->topology->corner_of_vertex[v];
}

static int32_t border_to(const pel_survey *s, int32_t v)
{
    return pel_survey_last(s, v);
}

static void direction_of(const pel_survey *s, int32_t half_edge, double direction[3])
{
    const pel_mesh *mesh = s->sim->model->bodies[s->body].mesh;
    pel_vec3_subtract(mesh->positions[pel_half_edge_target(s->topology, half_edge)],
                      mesh->positions[pel_half_edge_origin(s->topology, half_edge)], direction);
    pel_vec3_normalize(direction);
}

/* m, mean distance at rest from a vertex to some of the queue; infinite to none */
static double mean_distance(const pel_survey *s, int32_t vertex, int32_t from, int32_t to)
{
    const pel_mesh *mesh = s->sim->model->bodies[s->body].mesh;
    double sum = 0;
    for (int32_t i = from; i < to; i++)
        sum += pel_vec3_distance(mesh->positions[vertex], mesh->positions[s->queue[i]]);
    return to > from ? sum / (to - from) : (double)HUGE_VAL;
}

/* whether another tip is among some of the queue; the sides between them are stretched too */
static bool has_other_tip(const pel_survey *s, int32_t vertex, int32_t from, int32_t to)
{
    double ahead[3];
    for (int32_t i = from; i < to; i++)
        if (s->queue[i] != vertex && pel_survey_is_tip(s, s->queue[i], ahead))
            return true;
    return false;
}

/* whether the border of the surface, and no lip, is among some of the queue */
static bool has_rim(const pel_survey *s, int32_t from, int32_t to)
{
    const pel_body *body = &s->sim->model->bodies[s->body];
    for (int32_t i = from; i < to; i++) {
        int32_t v = s->queue[i];
        if (is_border(s, v) && !pel_is_lip(body, border_from(s, v)))
            return true;
    }
    return false;
}

/* the vertices from which the force on a tip comes: as many rings as it asks for, and that meet no other tip and no rim
   beyond the first ones */
static int32_t walk_to_reach(pel_survey *s, int32_t tip, int32_t *rings)
{
    double stiffness = pel_tear_stiffness(s->sim, s->body, tip),
           reach = stiffness > 0 ? REACH * pel_tear_resistance(s->sim, s->body, tip) / stiffness : 0;
    reach = pel_min(reach, MOST_REACH * sqrt(s->sim->model->bodies[s->body].rest_area));
    int32_t count = add(s, tip, 0, 0), begin = 0, end = 0;
    for (*rings = 0; *rings < MOST_RINGS; ++*rings) {
        if (*rings >= LEAST_RINGS && mean_distance(s, tip, begin, count) >= reach)
            break;
        for (end = count; begin < end; begin++)
            count = add_neighbours(s, s->queue[begin], count);
        if (*rings >= LEAST_RINGS && (has_other_tip(s, tip, end, count) || has_rim(s, end, count))) {
            for (int32_t i = end; i < count; i++)
                s->rings[s->queue[i]] = -1;
            return end;
        }
    }
    return count;
}

int32_t pel_survey_rings(pel_survey *s, int32_t tip)
{
    int32_t rings, count = walk_to_reach(s, tip, &rings);
    pel_survey_leave(s, count);
    return rings;
}

/* whether the side of a cut or notch goes on beyond a vertex of the border */
static bool goes_on(const pel_survey *s, int32_t v)
{
    const pel_body *body = &s->sim->model->bodies[s->body];
    int32_t from = border_from(s, v), to = border_to(s, v);
    double ahead[3], a[3], b[3];
    if (pel_survey_is_tip(s, v, ahead))
        return false;
    if (pel_is_lip(body, from) && pel_is_lip(body, to))
        return true;
    direction_of(s, from, a);
    direction_of(s, to, b);
    return pel_is_lip(body, from) == pel_is_lip(body, to) && pel_vec3_dot(a, b) > STRAIGHT;
}

/* both sides behind a tip, as far as the rings go */
static void mark_sides(pel_survey *s, int32_t tip)
{
    s->is_side[tip] = 1;
    for (int side = 0; side < 2; side++) {
        int32_t v = tip;
        do {
            v = side == 0 ? pel_half_edge_target(s->topology, border_from(s, v))
                          : pel_half_edge_origin(s->topology, border_to(s, v));
            if (s->rings[v] < 0 || !goes_on(s, v))
                break;
            s->is_side[v] = 1;
        } while (v != tip);
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
static double add_springs(const pel_survey *s, int32_t t, const double x[3][3], double gradient[3][3])
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

static void load_corners(const pel_survey *s, int32_t t, double x[3][3])
{
    const pel_body *body = &s->sim->model->bodies[s->body];
    for (int c = 0; c < 3; c++)
        pel_vertex_position(s->sim->state->position, body->model_index[body->mesh->triangles[t][c]], x[c]);
}

double pel_survey_triangle(const pel_survey *s, int32_t t, double gradient[3][3])
{
    double x[3][3];
    load_corners(s, t, x);
    double energy =
        pel_mechanics_gradient(s->sim->shells, s->body, t, s->sim->state->position, pel_sim_time(s->sim), gradient);
    return energy + add_springs(s, t, (const double(*)[3])x, gradient);
}

/* lists the triangles around all vertices with a weight and sums their areas and gradients by vertex; returns their
 * number */
static int32_t list_triangles(pel_survey *s, int32_t vertex_count)
{
    const pel_mesh *mesh = s->sim->model->bodies[s->body].mesh;
    int32_t count = 0;
    for (int32_t i = 0; i < vertex_count; i++) {
        int32_t v = s->queue[i];
        for (int32_t h = s->topology->corner_of_vertex[v]; s->weights[v] > 0 && h >= 0; h = pel_survey_turn(s, v, h))
            if (!s->is_listed[h / 3]) {
                s->is_listed[h / 3] = 1;
                s->triangles[count++] = h / 3;
            }
    }
    for (int32_t i = 0; i < count; i++) {
        int32_t t = s->triangles[i];
        const int32_t *v = mesh->triangles[t];
        double area = pel_vec3_triangle_area(mesh->positions[v[0]], mesh->positions[v[1]], mesh->positions[v[2]]);
        s->is_listed[t] = 0;
        memset(s->gradients[i], 0, sizeof *s->gradients);
        s->energies[i] = pel_survey_triangle(s, t, s->gradients[i]);
        for (int c = 0; c < 3; c++) {
            s->areas[v[c]] += area;
            pel_vec3_add(s->sums[v[c]], s->gradients[i][c], s->sums[v[c]]);
        }
    }
    return count;
}

static void add_triangle(const pel_survey *s, int32_t i, int32_t tip, double force[3])
{
    const pel_body *body = &s->sim->model->bodies[s->body];
    const double(*rest)[3] = (const double(*)[3])body->mesh->positions;
    const int32_t *v = body->mesh->triangles[s->triangles[i]];
    double x[3][3], pull[3] = {0}, sides[2][3], side[3], products[2], part[3];
    double area = pel_vec3_triangle_area(rest[v[0]], rest[v[1]], rest[v[2]]);
    load_corners(s, s->triangles[i], x);
    for (int c = 0; c < 3; c++) {
        double q = s->weights[v[c]];
        pel_vec3_along(pull, q, s->gradients[i][c], pull);
        if (q > 0 && v[c] != tip)
            pel_vec3_along(pull, -q * area / s->areas[v[c]], s->sums[v[c]], pull);
    }
    for (int k = 0; k < 2; k++) {
        pel_vec3_subtract(rest[v[k]], rest[v[2]], sides[k]);
        pel_vec3_subtract(x[k], x[2], side);
        products[k] = pel_vec3_dot(side, pull) - s->energies[i] * (s->weights[v[k]] - s->weights[v[2]]);
    }
    from_products((const double(*)[3])sides, products, part);
    pel_vec3_add(force, part, force);
}

/* logarithmic strain of the side of a cut between two vertices; false where it is none, or not within the rings */
static bool side_strain(const pel_survey *s, int32_t half_edge, double *length, double *strain)
{
    const pel_body *body = &s->sim->model->bodies[s->body];
    int32_t a = pel_half_edge_origin(s->topology, half_edge), b = pel_half_edge_target(s->topology, half_edge);
    double x[3], y[3];
    if (s->topology->twin[half_edge] >= 0 || s->weights[a] + s->weights[b] == 0)
        return false;
    pel_vertex_position(s->sim->state->position, body->model_index[a], x);
    pel_vertex_position(s->sim->state->position, body->model_index[b], y);
    *length = pel_vec3_distance(body->mesh->positions[a], body->mesh->positions[b]);
    *strain = pel_ln(pel_vec3_distance(x, y) / *length);
    return isfinite(*strain);
}

/* mean strain of both sides, but for the two edges next to the tip, where elements do not resolve it */
static double mean_strain(const pel_survey *s, int32_t triangle_count)
{
    double sum = 0, way = 0, length, strain;
    for (int32_t i = 0; i < 3 * triangle_count; i++) {
        int32_t h = 3 * s->triangles[i / 3] + i % 3, a = pel_half_edge_origin(s->topology, h),
                b = pel_half_edge_target(s->topology, h);
        if (s->rings[a] + s->rings[b] < 5 || !side_strain(s, h, &length, &strain))
            continue;
        sum += length * strain;
        way += length;
    }
    return way > 0 ? sum / way : 0;
}

/* takes out what the sides release where they move sideways with the tip */
static void add_sides(const pel_survey *s, int32_t triangle_count, double stiffness, double force[3])
{
    const pel_mesh *mesh = s->sim->model->bodies[s->body].mesh;
    double mean = mean_strain(s, triangle_count), length, strain;
    for (int32_t i = 0; i < 3 * triangle_count; i++) {
        int32_t t = s->triangles[i / 3], h = 3 * t + i % 3, a = pel_half_edge_origin(s->topology, h),
                b = pel_half_edge_target(s->topology, h);
        const int32_t *v = mesh->triangles[t];
        double side[3], normal[3], out[3];
        if (!side_strain(s, h, &length, &strain))
            continue;
        pel_vec3_subtract(mesh->positions[b], mesh->positions[a], side);
        pel_vec3_triangle_normal(mesh->positions[v[0]], mesh->positions[v[1]], mesh->positions[v[2]], normal);
        pel_vec3_normalize(normal);
        pel_vec3_cross(side, normal, out);
        pel_vec3_along(force, 0.5 * (s->weights[a] + s->weights[b]) * stiffness * mean * strain, out, force);
    }
}

static void read_tip(pel_survey *s, int32_t vertex, const double ahead[3], pel_tip *tip)
{
    const pel_body *body = &s->sim->model->bodies[s->body];
    int32_t rings, count = walk_to_reach(s, vertex, &rings);
    mark_sides(s, vertex);
    for (int32_t i = 0; i < count; i++) {
        int32_t v = s->queue[i], ring = s->rings[v];
        if (!is_border(s, v) || s->is_side[v])
            s->weights[v] = ring <= 1 ? 1 : (double)(rings - ring) / (rings - 1);
    }
    *tip = (pel_tip){.body = s->body, .vertex = vertex};
    pel_vertex_position(s->sim->state->position, body->model_index[vertex], tip->position);
    pel_vec3_copy(ahead, tip->ahead);
    int32_t triangle_count = list_triangles(s, count);
    for (int32_t i = 0; i < triangle_count; i++)
        add_triangle(s, i, vertex, tip->force);
    double stiffness = pel_tear_stiffness(s->sim, s->body, vertex);
    if (stiffness > 0 && !has_other_tip(s, vertex, 0, count))
        add_sides(s, triangle_count, stiffness, tip->force);
    tip->release = pel_vec3_length(tip->force);
    pel_survey_leave(s, count);
}

void pel_survey_read(pel_survey *s, int32_t vertex, const double ahead[3], pel_tip *tip)
{
    pel_tip_reading *reading = &s->readings[vertex % PEL_TIP_READINGS];
    int64_t state = (int64_t)s->sim->state_number + 1;
    if (reading->state != state || reading->tip.vertex != vertex) {
        read_tip(s, vertex, ahead, &reading->tip);
        reading->state = state;
    }
    *tip = reading->tip;
}

double pel_survey_change(pel_survey *s, const pel_tip *tip)
{
    pel_state *state = s->sim->state;
    pel_record *present = state->position;
    pel_tip before;
    double change[3];
    if (!s->sim->stepper->relaxes)
        return 0;
    state->position = state->position_before;
    pel_shell_forces_follow(s->sim->shells, state->position);
    read_tip(s, tip->vertex, tip->ahead, &before);
    state->position = present;
    pel_shell_forces_follow(s->sim->shells, state->position);
    pel_vec3_subtract(tip->force, before.force, change);
    return pel_vec3_length(change) / tip->release;
}

/* ---- tips ---- */

bool pel_vertex_is_held(const pel_sim *sim, int32_t body, int32_t v)
{
    int32_t place = sim->model->bodies[body].model_index[v];
    return sim->model->inverse_mass[place] == 0 || (sim->held != NULL && sim->held[place]);
}

bool pel_survey_is_held(const pel_survey *s, int32_t v)
{
    return pel_vertex_is_held(s->sim, s->body, v);
}

/* rad, of the triangles around a vertex at rest */
static double angle_around(const pel_survey *s, int32_t v)
{
    double sum = 0, a[3], b[3], cross[3];
    for (int32_t h = s->topology->corner_of_vertex[v]; h >= 0; h = pel_survey_turn(s, v, h)) {
        direction_of(s, h, a);
        direction_of(s, pel_half_edge_previous(h), b);
        pel_vec3_cross(a, b, cross);
        sum += pel_atan2(pel_vec3_length(cross), -pel_vec3_dot(a, b));
    }
    return sum;
}

/* Two lips meet in a vertex that was not divided, or two borders in a sharp corner. The direction is against the mean
   of the two sides. */
bool pel_survey_is_tip(const pel_survey *s, int32_t v, double ahead[3])
{
    const pel_body *body = &s->sim->model->bodies[s->body];
    double a[3], b[3];
    if (s->topology->corner_of_vertex[v] < 0 || !is_border(s, v))
        return false;
    int32_t from = border_from(s, v), to = border_to(s, v);
    bool is_cut = pel_is_lip(body, from) && pel_is_lip(body, to) && pel_vertex_share(body, v) == 1;
    bool is_notch =
        s->has_notches && !pel_is_lip(body, from) && !pel_is_lip(body, to) && angle_around(s, v) > LEAST_NOTCH;
    if (!is_cut && !is_notch)
        return false;
    direction_of(s, from, a);
    direction_of(s, to, b);
    pel_vec3_subtract(b, a, ahead);
    return pel_vec3_normalize(ahead) > 0;
}

int32_t pel_survey_count_tips(pel_survey *s)
{
    double ahead[3];
    if (s->tip_count >= 0)
        return s->tip_count;
    s->tip_count = 0;
    for (int32_t v = 0; v < s->topology->vertex_count; v++)
        if (pel_survey_is_tip(s, v, ahead))
            s->tips[s->tip_count++] = v;
    return s->tip_count;
}

pel_status pel_survey_begin(pel_survey *s, pel_sim *sim, int32_t body, pel_error *error)
{
    const pel_mesh *mesh = sim->model->bodies[body].mesh;
    *s = (pel_survey){.sim = sim, .body = body};
    s->tip_count = -1;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(s->tips, mesh->vertex_count), PEL_ROOM(s->weights, mesh->vertex_count),
                          PEL_ROOM(s->queue, mesh->vertex_count), PEL_ROOM(s->rings, mesh->vertex_count),
                          PEL_ROOM(s->is_side, mesh->vertex_count), PEL_ROOM(s->sums, mesh->vertex_count),
                          PEL_ROOM(s->areas, mesh->vertex_count), PEL_ROOM(s->triangles, mesh->triangle_count),
                          PEL_ROOM(s->is_listed, mesh->triangle_count), PEL_ROOM(s->gradients, mesh->triangle_count),
                          PEL_ROOM(s->energies, mesh->triangle_count)))
        return pel_fail_memory(error);
    if (pel_body_has_strength(sim, body) && pel_tear_may_start(sim, body) &&
        !PEL_ALLOCATE_ALL(PEL_ROOM(s->stresses, mesh->triangle_count), PEL_ROOM(s->axes, mesh->triangle_count)))
        return pel_fail_memory(error);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        s->rings[v] = -1;
    return pel_topology_create(mesh, &s->topology, error);
}

void pel_survey_end(pel_survey *s)
{
    pel_topology_destroy(s->topology);
    PEL_FREE_ALL(s->tips, s->weights, s->queue, s->rings, s->is_side, s->sums, s->areas, s->triangles, s->is_listed,
                 s->gradients, s->energies, s->stresses, s->axes);
    *s = (pel_survey){0};
}

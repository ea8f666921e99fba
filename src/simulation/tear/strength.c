/* A tear starts at a vertex where the largest principal value of the true stress reaches the strength: in the mean over
   the triangles around the vertex, and in the mean over the disc of 1.32 L around it in the rest shape, with L = young
   x toughness / (pi strength^2). So neither the mesh nor a sharp corner decides (area method of the theory of critical
   distances: Taylor 2007). The tear opens at once by 2 L from the border, or to both sides of a vertex inside: a slit
   of this size releases as much energy as it takes (finite fracture mechanics: Leguillon 2002), so it goes on by
   itself. It opens across the mean of the largest stress. Where the mesh is coarser than L the mean is that around the
   vertex, and the slit one edge to each side. L counts as at most a share of the size of the body.

   At a tip the mean stress reaches the strength when the tip is about to grow: within the disc or four rings of a tip
   toughness decides, and nothing starts. */
#include "tear/strength.h"

#include "math/extremes.h"
#include "math/vec3.h"
#include "tear/material.h"

#include <math.h>

/* over L */
#define DISC 1.32
#define ARM 2.0
/* of the root of the area of the body */
#define MOST_DISC 0.05
/* rings around tips in which nothing starts */
enum { TIP_RINGS = 4 };
/* cosine between the way into the surface and a slit from the border */
#define LEAST_INWARD 0.3

/* ---- stress of triangles ---- */

/* the larger principal value of a symmetric tensor (11, 22, 12), and the axis of the smaller one */
static double split(const double stress[3], double minor[2])
{
    double mean = 0.5 * (stress[0] + stress[1]), d = 0.5 * (stress[0] - stress[1]),
           r = sqrt(d * d + stress[2] * stress[2]);
    /* the axis of the larger one is (d + r, s12) or (s12, r - d), whichever is longer */
    minor[0] = d >= 0 ? -stress[2] : d - r;
    minor[1] = d >= 0 ? d + r : stress[2];
    return mean + r;
}

/* Pa, the largest stress in a triangle; `axis` is the unit direction at rest across which it opens most */
static double find_stress(const pel_survey *s, int32_t t, double axis[3])
{
    const pel_body *body = &s->sim->model->bodies[s->body];
    const int32_t *v = body->mesh->triangles[t];
    double gradient[3][3] = {{0}}, x[3][3], sides[2][3], rest[2][3], frame[2][3], plane[2][2], normal[3], along[3],
           minor[2];
    double thickness = 0;
    pel_survey_triangle(s, t, gradient);
    for (int c = 0; c < 3; c++) {
        pel_vertex_position(s->sim->state->position, body->model_index[v[c]], x[c]);
        thickness += pel_tear_thickness(s->sim, s->body, v[c]) / 3;
    }
    for (int k = 0; k < 2; k++) {
        pel_vec3_subtract(x[k], x[2], sides[k]);
        pel_vec3_subtract(body->mesh->positions[v[k]], body->mesh->positions[v[2]], rest[k]);
    }
    /* sides in a frame of the present plane */
    pel_vec3_cross(sides[0], sides[1], normal);
    double area = 0.5 * pel_vec3_normalize(normal);
    pel_vec3_copy(sides[0], frame[0]);
    pel_vec3_normalize(frame[0]);
    pel_vec3_cross(normal, frame[0], frame[1]);
    double stress[3] = {0};
    for (int k = 0; k < 2; k++) {
        double g[2] = {pel_vec3_dot(gradient[k], frame[0]), pel_vec3_dot(gradient[k], frame[1])};
        for (int i = 0; i < 2; i++)
            plane[k][i] = pel_vec3_dot(sides[k], frame[i]);
        stress[0] += g[0] * plane[k][0];
        stress[1] += g[1] * plane[k][1];
        stress[2] += 0.5 * (g[0] * plane[k][1] + g[1] * plane[k][0]);
    }
    pel_vec3_cross(rest[0], rest[1], normal);
    double rest_area = 0.5 * pel_vec3_normalize(normal);
    pel_vec3_set(axis, 0, 0, 0);
    if (!(area > 0 && rest_area > 0))
        return 0;
    double largest = split(stress, minor), determinant = plane[0][0] * plane[1][1] - plane[0][1] * plane[1][0];
    pel_vec3_scale(rest[0], (minor[0] * plane[1][1] - minor[1] * plane[1][0]) / determinant, along);
    pel_vec3_along(along, (minor[1] * plane[0][0] - minor[0] * plane[0][1]) / determinant, rest[1], along);
    pel_vec3_cross(along, normal, axis);
    pel_vec3_normalize(axis);
    return largest / (area * thickness * pel_tear_thinning(s->sim, s->body, area / rest_area));
}

/* all of them; whether any reaches the strength at a corner */
static bool fill_stresses(pel_survey *s)
{
    const pel_mesh *mesh = s->sim->model->bodies[s->body].mesh;
    bool any = false;
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        s->stresses[t] = find_stress(s, t, s->axes[t]);
        for (int c = 0; c < 3; c++)
            any |= s->stresses[t] >= pel_tear_strength(s->sim, s->body, mesh->triangles[t][c]);
    }
    return any;
}

/* ---- means ---- */

typedef struct mean {
    double area, stress; /* m2; N, sum over areas */
    double tensor[3][3]; /* N, of the stress and its axes */
} mean;

static void add_part(const pel_survey *s, int32_t t, double area, mean *m)
{
    m->area += area;
    m->stress += area * s->stresses[t];
    for (int i = 0; i < 3; i++)
        pel_vec3_along(m->tensor[i], area * s->stresses[t] * s->axes[t][i], s->axes[t], m->tensor[i]);
}

static double area_of(const pel_survey *s, int32_t t)
{
    const pel_mesh *mesh = s->sim->model->bodies[s->body].mesh;
    const int32_t *v = mesh->triangles[t];
    return pel_vec3_triangle_area(mesh->positions[v[0]], mesh->positions[v[1]], mesh->positions[v[2]]);
}

static void add_fan(const pel_survey *s, int32_t v, mean *m)
{
    for (int32_t h = s->topology->corner_of_vertex[v]; h >= 0; h = pel_survey_turn(s, v, h))
        add_part(s, h / 3, area_of(s, h / 3), m);
}

/* the thirds of a triangle whose middles of sides are in the disc */
static void add_in_disc(const pel_survey *s, int32_t t, const double centre[3], double radius, mean *m)
{
    const pel_mesh *mesh = s->sim->model->bodies[s->body].mesh;
    double area = area_of(s, t), middle[3];
    for (int k = 0; k < 3; k++) {
        const double *a = mesh->positions[mesh->triangles[t][k]], *b = mesh->positions[mesh->triangles[t][(k + 1) % 3]];
        for (int c = 0; c < 3; c++)
            middle[c] = 0.5 * (a[c] + b[c]);
        if (pel_vec3_distance(middle, centre) <= radius)
            add_part(s, t, area / 3, m);
    }
}

/* over the disc, which the survey has walked over; false where it is smaller than the triangles */
static bool add_disc(pel_survey *s, int32_t v, int32_t count, double radius, mean *m)
{
    const double *centre = s->sim->model->bodies[s->body].mesh->positions[v];
    int32_t listed = 0;
    for (int32_t i = 0; i < count; i++)
        for (int32_t h = s->topology->corner_of_vertex[s->queue[i]]; h >= 0; h = pel_survey_turn(s, s->queue[i], h))
            if (!s->is_listed[h / 3]) {
                s->is_listed[h / 3] = 1;
                s->triangles[listed++] = h / 3;
            }
    for (int32_t i = 0; i < listed; i++) {
        s->is_listed[s->triangles[i]] = 0;
        add_in_disc(s, s->triangles[i], centre, radius, m);
    }
    return m->area > 0;
}

static bool has_tip(const pel_survey *s, int32_t count)
{
    double ahead[3];
    for (int32_t i = 0; i < count; i++)
        if (pel_survey_is_tip(s, s->queue[i], ahead))
            return true;
    return false;
}

static bool is_near_tip(pel_survey *s, int32_t v)
{
    int32_t count = pel_survey_walk(s, v, TIP_RINGS);
    bool found = has_tip(s, count);
    pel_survey_leave(s, count);
    return found;
}

/* m, at most a share of the size of the body */
static double length_at(const pel_survey *s, int32_t v, double size)
{
    return pel_min(pel_tear_length(s->sim, s->body, v), MOST_DISC * size);
}

/* stress over strength at a vertex, in the mean; 0 where nothing starts */
static double read_vertex(pel_survey *s, int32_t v, double size, mean *m)
{
    double strength = pel_tear_strength(s->sim, s->body, v), radius = DISC * length_at(s, v, size);
    mean fan = {0};
    add_fan(s, v, &fan);
    if (!(fan.stress >= strength * fan.area) || is_near_tip(s, v))
        return 0;
    int32_t count = pel_survey_spread(s, v, radius);
    *m = (mean){0};
    if (has_tip(s, count))
        m->area = m->stress = 0;
    else if (!add_disc(s, v, count, radius, m))
        *m = fan;
    pel_survey_leave(s, count);
    return m->area > 0 ? m->stress / (strength * m->area) : 0;
}

/* ---- the start ---- */

/* across the largest mean stress, in the surface at a vertex; false from a border along it */
static bool aim(const pel_survey *s, const mean *m, pel_start *start)
{
    const pel_mesh *mesh = s->sim->model->bodies[s->body].mesh;
    double normal[3] = {0}, inward[3] = {0}, frame[2][3], part[3], plane[3], minor[2];
    for (int32_t h = s->topology->corner_of_vertex[start->vertex]; h >= 0; h = pel_survey_turn(s, start->vertex, h)) {
        const int32_t *v = mesh->triangles[h / 3];
        pel_vec3_triangle_normal(mesh->positions[v[0]], mesh->positions[v[1]], mesh->positions[v[2]], part);
        pel_vec3_add(normal, part, normal);
        for (int c = 0; c < 3; c++) {
            pel_vec3_subtract(mesh->positions[v[c]], mesh->positions[start->vertex], part);
            pel_vec3_add(inward, part, inward);
        }
    }
    pel_vec3_normalize(normal);
    int32_t h = s->topology->corner_of_vertex[start->vertex];
    pel_vec3_subtract(mesh->positions[pel_half_edge_target(s->topology, h)], mesh->positions[start->vertex], frame[0]);
    pel_vec3_along(frame[0], -pel_vec3_dot(frame[0], normal), normal, frame[0]);
    pel_vec3_normalize(frame[0]);
    pel_vec3_cross(normal, frame[0], frame[1]);
    for (int i = 0; i < 3; i++) {
        const double *a = frame[i == 1], *b = frame[i != 0];
        plane[i] = 0;
        for (int k = 0; k < 3; k++)
            plane[i] += a[k] * pel_vec3_dot(m->tensor[k], b);
    }
    split(plane, minor);
    pel_vec3_scale(frame[0], minor[0], start->direction);
    pel_vec3_along(start->direction, minor[1], frame[1], start->direction);
    if (!(pel_vec3_normalize(start->direction) > 0))
        pel_vec3_copy(frame[0], start->direction);
    if (s->topology->twin[h] >= 0) {
        start->arm_count = 2;
        return true;
    }
    start->arm_count = 1;
    double cosine = pel_vec3_normalize(inward) > 0 ? pel_vec3_dot(inward, start->direction) : 0;
    if (cosine < 0)
        pel_vec3_scale(start->direction, -1, start->direction);
    return fabs(cosine) >= LEAST_INWARD;
}

/* m, the root of the area at rest */
static double size_of(const pel_survey *s)
{
    double sum = 0;
    for (int32_t t = 0; t < s->sim->model->bodies[s->body].mesh->triangle_count; t++)
        sum += area_of(s, t);
    return sqrt(sum);
}

bool pel_start_find(pel_survey *s, int32_t most_tips, pel_start *start)
{
    double best = 1;
    bool everywhere = s->sim->def.tear.start == PEL_TEAR_ANYWHERE;
    if (s->stresses == NULL || !fill_stresses(s))
        return false;
    int32_t tip_count = pel_survey_count_tips(s);
    start->vertex = -1;
    double size = size_of(s);
    for (int32_t v = 0; v < s->topology->vertex_count && tip_count < most_tips; v++) {
        mean m = {0};
        int32_t h = s->topology->corner_of_vertex[v];
        if (h < 0 || (!everywhere && s->topology->twin[h] >= 0) || pel_survey_is_held(s, v))
            continue;
        pel_start found = {.vertex = v, .length = ARM * length_at(s, v, size)};
        double ratio = read_vertex(s, v, size, &m);
        if (ratio < best || (ratio == best && start->vertex >= 0) || !aim(s, &m, &found))
            continue;
        best = ratio;
        *start = found;
    }
    return start->vertex >= 0;
}

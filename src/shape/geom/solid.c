#include "geom/solid.h"

#include <string.h>

#include "math/extremes.h"
#include "math/pose.h"
#include "math/vec3.h"
#include "pellicle/geometry.h"

/* unit vector along d, or the fallback when d has no length */
static void unit_or(const double d[3], const double fallback[3], double unit[3])
{
    double length = pel_vec3_length(d);
    if (length > 0)
        pel_vec3_scale(d, 1 / length, unit);
    else
        pel_vec3_copy(fallback, unit);
}

static double clamp(double value, double low, double high)
{
    return value < low ? low : value > high ? high : value;
}

/* ---- round solids ---- */

static double round_distance(const pel_solid *solid, const double p[3], double normal[3])
{
    const double sideways[3] = {1, 0, 0};
    double d[3] = {p[0], p[1], p[2] - clamp(p[2], -solid->half_length, solid->half_length)};
    unit_or(d, sideways, normal);
    return pel_vec3_length(d) - solid->radius;
}

/* direction to push a triangle that the axis itself pierces: sideways, as its own normal points */
static void way_past_axis(const double a[3], const double b[3], const double c[3], double direction[3])
{
    double u[3], v[3], n[3];
    const double sideways[3] = {1, 0, 0};
    pel_vec3_subtract(b, a, u);
    pel_vec3_subtract(c, a, v);
    pel_vec3_cross(u, v, n);
    n[2] = 0;
    pel_vec3_scale(n, -1, n);
    unit_or(n, sideways, direction);
}

/* How far a plane across the direction of the middle of a triangle keeps it out of the solid, surely; 0 or less = it
   does not. */
static double room_before_plane(const pel_solid *solid, const double a[3], const double b[3], const double c[3])
{
    const double half = solid->half_length;
    double way[3] = {a[0] + b[0] + c[0], a[1] + b[1] + c[1], a[2] + b[2] + c[2]};
    way[2] -= clamp(way[2], -3 * half, 3 * half);
    double along[3] = {pel_vec3_dot(way, a), pel_vec3_dot(way, b), pel_vec3_dot(way, c)};
    double least = along[0] < along[1] ? along[0] : along[1];
    least = along[2] < least ? along[2] : least;
    double clear = 0.999999 * (least - half * fabs(way[2])), square = pel_vec3_squared_length(way);
    if (!(clear > 0 && clear * clear > solid->radius * solid->radius * square))
        return 0;
    return clear / sqrt(square) - solid->radius;
}

static double round_depth(const pel_solid *solid, const double a[3], const double b[3], const double c[3],
                          double weights[3], double normal[3])
{
    const double half = solid->half_length;
    double room = room_before_plane(solid, a, b, c);
    if (room > 0)
        return -room;
    const double low[3] = {0, 0, -half}, high[3] = {0, 0, half};
    double both[5] = {1, 0, 0, 0, 0};
    double square = half > 0 ? pel_closest_segment_triangle(low, high, a, b, c, both)
                             : pel_closest_point_triangle(low, a, b, c, both + 2);
    double depth = solid->radius - sqrt(square);
    if (!(depth > 0))
        return depth;
    const double *w = both + 2;
    double point[3], axis[3] = {0, 0, half * (both[1] - both[0])};
    for (int i = 0; i < 3; i++)
        point[i] = w[0] * a[i] + w[1] * b[i] + w[2] * c[i] - axis[i];
    double fallback[3];
    way_past_axis(a, b, c, fallback);
    bool pierced = square < 1e-18 * solid->radius * solid->radius;
    unit_or(pierced ? fallback : point, fallback, normal);
    memcpy(weights, w, 3 * sizeof *weights);
    return depth;
}

static void round_half_box(const pel_solid *solid, double half[3])
{
    pel_vec3_set(half, solid->radius, solid->radius, solid->radius + solid->half_length);
}

/* ---- box ---- */

/* axis of the face of the box that p is nearest to from inside */
static int nearest_face(const double half[3], const double p[3])
{
    int axis = 0;
    for (int i = 1; i < 3; i++)
        if (fabs(p[i]) - half[i] > fabs(p[axis]) - half[axis])
            axis = i;
    return axis;
}

static double box_distance(const pel_solid *solid, const double p[3], double normal[3])
{
    const double *half = solid->half_extents;
    double out[3], outside = 0;
    for (int i = 0; i < 3; i++) {
        out[i] = p[i] - clamp(p[i], -half[i], half[i]);
        outside += out[i] * out[i];
    }
    int axis = nearest_face(half, p);
    const double face[3] = {axis == 0 ? copysign(1, p[0]) : 0, axis == 1 ? copysign(1, p[1]) : 0,
                            axis == 2 ? copysign(1, p[2]) : 0};
    unit_or(out, face, normal);
    return outside > 0 ? sqrt(outside) : fabs(p[axis]) - half[axis];
}

/* Depth at a point p of the triangle is min over the six faces of (half - side p), a concave function; its maximum over
   the triangle is the linear program
       max s  subject to  s <= half_i - side p_i(u, v)  (6 faces),  u >= 0, v >= 0, u + v <= 1
   in three unknowns. The optimum is a corner where three of the nine constraints hold with equality; all 84 triples are
   tried. */

typedef struct constraint {
    double u, v, s, limit; /* u U + v V + s S <= limit */
} constraint;

static void box_constraints(const double half[3], const double a[3], const double b[3], const double c[3],
                            constraint constraints[9])
{
    for (int face = 0; face < 6; face++) {
        int i = face / 2;
        double sign = face % 2 != 0 ? 1 : -1;
        constraints[face] = (constraint){sign * (b[i] - a[i]), sign * (c[i] - a[i]), 1, half[i] - sign * a[i]};
    }
    constraints[6] = (constraint){-1, 0, 0, 0};
    constraints[7] = (constraint){0, -1, 0, 0};
    constraints[8] = (constraint){1, 1, 0, 1};
}

/* the point where three constraints hold with equality; false if there is none */
static int solve_triple(const constraint *p, const constraint *q, const constraint *r, double solution[3])
{
    const double row[3][3] = {{p->u, p->v, p->s}, {q->u, q->v, q->s}, {r->u, r->v, r->s}};
    const double x[3] = {p->u, q->u, r->u}, y[3] = {p->v, q->v, r->v}, z[3] = {p->s, q->s, r->s};
    const double limit[3] = {p->limit, q->limit, r->limit};
    double yz[3], zx[3], xy[3];
    pel_vec3_cross(y, z, yz);
    pel_vec3_cross(z, x, zx);
    pel_vec3_cross(x, y, xy);
    double determinant = pel_vec3_dot(x, yz);
    double scale = pel_vec3_length(row[0]) * pel_vec3_length(row[1]) * pel_vec3_length(row[2]);
    if (fabs(determinant) <= 1e-12 * scale)
        return 0;
    pel_vec3_set(solution, pel_vec3_dot(limit, yz) / determinant, pel_vec3_dot(limit, zx) / determinant,
                 pel_vec3_dot(limit, xy) / determinant);
    return 1;
}

static int is_feasible(const constraint constraints[9], const double x[3], double tolerance)
{
    for (int k = 0; k < 9; k++) {
        const constraint *c = &constraints[k];
        if (c->u * x[0] + c->v * x[1] + c->s * x[2] > c->limit + (k < 6 ? tolerance : 1e-12))
            return 0;
    }
    return 1;
}

/* the best axis found: they are farthest apart along it */
typedef struct separation {
    const double *half; /* of the box */
    const double (*triangle)[3];
    double axis[3], gap, support;
} separation;

static void try_axis(separation *best, const double direction[3])
{
    double axis[3], low = HUGE_VAL, high = -HUGE_VAL, support = 0;
    pel_vec3_copy(direction, axis);
    if (!(pel_vec3_normalize(axis) > 0))
        return;
    for (int i = 0; i < 3; i++) {
        double along = pel_vec3_dot(axis, best->triangle[i]);
        low = pel_min(low, along);
        high = pel_max(high, along);
        support += best->half[i] * fabs(axis[i]);
    }
    double gap = pel_max(low, -high) - support;
    if (!(gap > best->gap + 1e-9 * support))
        return;
    best->gap = gap;
    best->support = support;
    pel_vec3_scale(axis, low > -high ? 1 : -1, best->axis);
}

static double box_separation(const pel_solid *solid, const double triangle[3][3], double result[3])
{
    static const double faces[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    separation best = {.half = solid->half_extents, .triangle = triangle, .gap = -HUGE_VAL};
    double side[3][3], axis[3];
    for (int i = 0; i < 3; i++) {
        pel_vec3_subtract(triangle[(i + 1) % 3], triangle[i], side[i]);
        try_axis(&best, faces[i]);
    }
    pel_vec3_cross(side[0], side[1], axis);
    try_axis(&best, axis);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            pel_vec3_cross(side[i], faces[k], axis);
            try_axis(&best, axis);
        }
    pel_vec3_copy(best.axis, result);
    return best.support;
}

static double box_depth(const pel_solid *solid, const double a[3], const double b[3], const double c[3],
                        double weights[3], double normal[3])
{
    const double *half = solid->half_extents;
    for (int i = 0; i < 3; i++) {
        double low = pel_min(a[i], pel_min(b[i], c[i])), high = pel_max(a[i], pel_max(b[i], c[i]));
        if (low >= half[i] || high <= -half[i])
            return 0;
    }
    constraint constraints[9];
    box_constraints(half, a, b, c, constraints);
    double best[3] = {0, 0, 0}, size = half[0] + half[1] + half[2];
    for (int p = 0; p < 6; p++)
        for (int q = p + 1; q < 8; q++)
            for (int r = q + 1; r < 9; r++) {
                double x[3];
                if (solve_triple(&constraints[p], &constraints[q], &constraints[r], x) && x[2] > best[2] &&
                    is_feasible(constraints, x, 1e-12 * size))
                    memcpy(best, x, sizeof best);
            }
    if (!(best[2] > 0))
        return 0;
    pel_vec3_set(weights, 1 - best[0] - best[1], best[0], best[1]);
    double point[3];
    for (int i = 0; i < 3; i++)
        point[i] = weights[0] * a[i] + weights[1] * b[i] + weights[2] * c[i];
    const double triangle[3][3] = {{a[0], a[1], a[2]}, {b[0], b[1], b[2]}, {c[0], c[1], c[2]}};
    double support = box_separation(solid, triangle, normal);
    return support - pel_vec3_dot(normal, point);
}

/* m, the least depth of a point below the faces of a box but one */
static double depth_below_others(const double half[3], const double p[3], int axis, int side)
{
    double least = half[axis] + side * p[axis];
    for (int k = 0; k < 3; k++)
        if (k != axis)
            least = pel_min(least, half[k] - fabs(p[k]));
    return least;
}

/* Depth below a face is linear: where the deepest corner is limited by that face alone, no other point of the triangle
   is deeper. Where all corners are deeper below the other faces, it is so for any of them. */
static double box_corner_room(const pel_solid *solid, const double corner[3][3])
{
    const double *half = solid->half_extents;
    double room = -1;
    for (int i = 0; i < 3; i++)
        for (int side = -1; side <= 1; side += 2) {
            int deepest = 0;
            double least = HUGE_VAL;
            for (int c = 0; c < 3; c++) {
                if (side * corner[c][i] < side * corner[deepest][i])
                    deepest = c;
                least = pel_min(least, depth_below_others(half, corner[c], i, side));
            }
            double depth = half[i] - side * corner[deepest][i];
            if (depth_below_others(half, corner[deepest], i, side) >= depth)
                room = pel_max(room, pel_max(0.5 * (least - depth), 0));
        }
    return room;
}

static void box_half_box(const pel_solid *solid, double half[3])
{
    pel_vec3_copy(solid->half_extents, half);
}

static const double box_corners[8][3] = {{-1, -1, -1}, {1, -1, -1}, {-1, 1, -1}, {1, 1, -1},
                                         {-1, -1, 1},  {1, -1, 1},  {-1, 1, 1},  {1, 1, 1}};
static const int32_t box_triangles[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                             {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};

/* ---- edge ---- */

/* of its length: half the width of the bar that pictures show */
#define BAR_SHARE 0.015

static double edge_distance(const pel_solid *solid, const double p[3], double normal[3])
{
    const double sideways[3] = {1, 0, 0};
    double weights[2], nearest[3], d[3];
    double distance = sqrt(pel_closest_point_segment(p, solid->edge[0], solid->edge[1], weights));
    pel_vec3_scale(solid->edge[0], weights[0], nearest);
    pel_vec3_along(nearest, weights[1], solid->edge[1], nearest);
    pel_vec3_subtract(p, nearest, d);
    unit_or(d, sideways, normal);
    return distance;
}

/* nothing is inside */
static double edge_depth(const pel_solid *solid, const double a[3], const double b[3], const double c[3],
                         double weights[3], double normal[3])
{
    (void)solid, (void)a, (void)b, (void)c, (void)weights, (void)normal;
    return 0;
}

static void edge_half_box(const pel_solid *solid, double half[3])
{
    for (int k = 0; k < 3; k++)
        half[k] = pel_max(fabs(solid->edge[0][k]), fabs(solid->edge[1][k]));
}

/* of a bar about the edge */
static void edge_corner(const pel_solid *solid, const double unit[3], double corner[3])
{
    double along[3], across[2][3];
    pel_vec3_subtract(solid->edge[1], solid->edge[0], along);
    double length = pel_vec3_normalize(along);
    int least = fabs(along[0]) < fabs(along[1]) ? 0 : 1;
    least = fabs(along[2]) < fabs(along[least]) ? 2 : least;
    const double axis[3] = {least == 0, least == 1, least == 2};
    pel_vec3_cross(axis, along, across[0]);
    pel_vec3_normalize(across[0]);
    pel_vec3_cross(along, across[0], across[1]);
    pel_vec3_copy(solid->edge[unit[2] > 0], corner);
    for (int k = 0; k < 2; k++)
        pel_vec3_along(corner, BAR_SHARE * length * unit[k], across[k], corner);
}

/* of two spikes from the pivot to the tips, which come together as the scissors close */
static void scissors_corner(const pel_solid *solid, const double unit[3], double corner[3])
{
    const double *own = solid->edge[unit[2] > 0];
    double middle[3], tip[3], normal[3];
    for (int k = 0; k < 3; k++)
        middle[k] = 0.5 * (solid->edge[0][k] + solid->edge[1][k]);
    pel_vec3_scale(own, 1 - solid->closed, tip);
    pel_vec3_along(tip, solid->closed, middle, tip);
    pel_vec3_cross(solid->edge[0], solid->edge[1], normal);
    pel_vec3_normalize(normal);
    double width = BAR_SHARE * pel_vec3_length(tip);
    if (unit[1] < 0)
        pel_vec3_scale(normal, unit[0] * width, corner);
    else if (unit[0] < 0)
        pel_vec3_copy(tip, corner);
    else
        pel_vec3_cross(normal, tip, corner);
    if (unit[0] > 0 && unit[1] > 0)
        pel_vec3_scale(corner, 2 * BAR_SHARE, corner);
}

static const int32_t spike_triangles[8][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3},
                                              {4, 6, 5}, {4, 5, 7}, {4, 7, 6}, {5, 6, 7}};

/* ---- the rows ---- */

#define EDGE                                                                                                           \
    .has_edge = true, .distance = edge_distance, .depth = edge_depth, .half_box = edge_half_box, .corner_count = 8,    \
    .corners = box_corners

#define ROUND                                                                                                          \
    .is_round = true, .has_radius = true, .distance = round_distance, .depth = round_depth, .half_box = round_half_box

const pel_solid_row pel_solid_rows[PEL_TOOL_SHAPE_COUNT] = {
    [PEL_TOOL_SPHERE] = {.word = "sphere", ROUND},
    [PEL_TOOL_CAPSULE] = {.word = "capsule", ROUND, .has_length = true},
    [PEL_TOOL_BOX] = {.word = "box",
                      .has_size = true,
                      .distance = box_distance,
                      .depth = box_depth,
                      .half_box = box_half_box,
                      .separation = box_separation,
                      .corner_room = box_corner_room,
                      .corner_count = 8,
                      .triangle_count = 12,
                      .corners = box_corners,
                      .triangles = box_triangles},
    [PEL_TOOL_MESH] = {.word = "mesh"},
    [PEL_TOOL_SUPPORT] = {.word = "support"},
    [PEL_TOOL_BLADE] = {.word = "blade", EDGE, .triangle_count = 12, .triangles = box_triangles},
    [PEL_TOOL_HOOK] = {.word = "hook", EDGE, .triangle_count = 12, .triangles = box_triangles},
    [PEL_TOOL_SCISSORS] = {.word = "scissors", EDGE, .triangle_count = 8, .triangles = spike_triangles},
};

bool pel_solid_find(const char *word, pel_tool_shape *shape)
{
    for (int i = 0; i < PEL_TOOL_SHAPE_COUNT; i++)
        if (pel_solid_rows[i].distance != NULL && strcmp(pel_solid_rows[i].word, word) == 0) {
            *shape = (pel_tool_shape)i;
            return true;
        }
    return false;
}

pel_solid pel_solid_of(const pel_tool_def *def)
{
    const pel_solid_row *row = &pel_solid_rows[def->shape];
    pel_solid solid = {.shape = row->distance != NULL ? def->shape : PEL_TOOL_SPHERE,
                       .radius = def->radius,
                       .half_length = row->has_length ? def->half_length : 0};
    pel_vec3_copy(def->half_extents, solid.half_extents);
    memcpy(solid.edge, def->edge, sizeof solid.edge);
    return solid;
}

double pel_solid_distance(const pel_solid *solid, const double p[3], double normal[3])
{
    return pel_solid_rows[solid->shape].distance(solid, p, normal);
}

double pel_solid_depth(const pel_solid *solid, const double a[3], const double b[3], const double c[3],
                       double weights[3], double normal[3])
{
    return pel_solid_rows[solid->shape].depth(solid, a, b, c, weights, normal);
}

double pel_solid_separation(const pel_solid *solid, const double triangle[3][3], double axis[3])
{
    return pel_solid_rows[solid->shape].separation(solid, triangle, axis);
}

double pel_solid_corner_room(const pel_solid *solid, const double triangle[3][3])
{
    const pel_solid_row *row = &pel_solid_rows[solid->shape];
    return row->corner_room != NULL ? row->corner_room(solid, triangle) : -1;
}

void pel_solid_half_box(const pel_solid *solid, double half[3])
{
    pel_solid_rows[solid->shape].half_box(solid, half);
}

double pel_tool_def_reach(const pel_tool_def *def, const double rotation[4], const double along[3])
{
    const pel_solid solid = pel_solid_of(def);
    double turned[3], half[3], reach = 0;
    pel_rotate_back(rotation, along, turned);
    for (int32_t v = 0; def->mesh != NULL && v < def->mesh->vertex_count; v++) {
        const double way = pel_vec3_dot(def->mesh->positions[v], turned);
        reach = v > 0 ? pel_max(reach, way) : way;
    }
    if (def->mesh != NULL)
        return reach;
    pel_solid_half_box(&solid, half);
    return fabs(half[0] * turned[0]) + fabs(half[1] * turned[1]) + fabs(half[2] * turned[2]);
}

double pel_solid_least_half_width(const pel_solid *solid)
{
    double half[3];
    pel_solid_half_box(solid, half);
    return pel_min(half[0], pel_min(half[1], half[2]));
}

double pel_solid_size(const pel_solid *solid)
{
    double half[3];
    pel_solid_half_box(solid, half);
    return half[0] + half[1] + half[2];
}

void pel_solid_corner(const pel_solid *solid, int32_t i, double corner[3])
{
    const double *unit = pel_solid_rows[solid->shape].corners[i];
    if (pel_solid_has_edge(solid)) {
        (solid->shape == PEL_TOOL_SCISSORS ? scissors_corner : edge_corner)(solid, unit, corner);
        return;
    }
    for (int k = 0; k < 3; k++)
        corner[k] = unit[k] * solid->half_extents[k];
}

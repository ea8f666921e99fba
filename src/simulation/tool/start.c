/* Tools that start inside a body are refused, with the displacement that frees them; the content of a bag is not. The
   displacement is the shortest one over the directions tried: the axes of the world and of the tool, the normal of the
   deepest triangle, and the direction to the point of the surface nearest to the tool's centre. Bisection finds the
   distance along a direction. */
#include "tool/start.h"

#include "base/assert.h"
#include "base/status.h"
#include "math/bounds.h"
#include "math/extremes.h"
#include "math/functions.h"
#include "pellicle/geometry.h"

/* of a tool's size: a tool that is less deep may start */
#define START_DEPTH 1e-3
/* relative to the distance that is certainly enough: precision of the distance */
enum { BISECTIONS = 20, DIRECTION_LIMIT = 16 };

/* a tool against one body */
typedef struct overlap {
    const pel_sim *sim;
    const pel_tool *tool;
    int32_t body;
} overlap;

/* solid angle of a triangle seen from the origin over 4 pi */
static double winding(const double a[3], const double b[3], const double c[3])
{
    double la = pel_vec3_length(a), lb = pel_vec3_length(b), lc = pel_vec3_length(c), n[3];
    pel_vec3_cross(b, c, n);
    double divisor = la * lb * lc + pel_vec3_dot(a, b) * lc + pel_vec3_dot(b, c) * la + pel_vec3_dot(c, a) * lb;
    return pel_atan2(pel_vec3_dot(a, n), divisor) / 6.283185307179586;
}

static void load_corners(const overlap *o, int32_t t, double corner[3][3])
{
    for (int c = 0; c < 3; c++)
        pel_vertex_position(o->sim->state->position, o->sim->model->triangles[t][c], corner[c]);
}

/* true when a point lies inside a closed body */
static bool is_enclosed(const pel_sim *sim, const double point[3], int32_t body)
{
    PEL_ASSERT_INDEX(body, sim->model->body_count);
    const overlap o = {sim, NULL, body};
    double sum = 0, corner[3][3];
    for (int32_t i = 0; i < pel_surface_count(sim->model, body); i++) {
        load_corners(&o, pel_surface_triangle(sim->model, body, i), corner);
        for (int c = 0; c < 3; c++)
            pel_vec3_subtract(corner[c], point, corner[c]);
        sum += winding(corner[0], corner[1], corner[2]);
    }
    return fabs(sum) > 0.5;
}

bool pel_tool_starts_within(const pel_sim *sim, const double point[3], int32_t body)
{
    PEL_ASSERT_INDEX(body, sim->model->body_count);
    const pel_body *own = &sim->model->bodies[body];
    bool is_bag = own->shell != NULL && own->shell->has_membrane && !own->has_volumetric;
    return own->closed && !is_bag && is_enclosed(sim, point, body);
}

/* ---- solids ---- */

/* depth of a triangle in the solid at a pose; out: the way out, in the world */
static double depth_at(const overlap *o, const pel_pose *pose, double corner[3][3], double out[3])
{
    double local[3][3], weights[3], normal[3], far = pel_tool_size(o->tool), nearest[3];
    /* most are out of the sphere about it */
    if (pel_closest_point_triangle(pose->position, corner[0], corner[1], corner[2], nearest) > far * far)
        return 0;
    for (int c = 0; c < 3; c++)
        pel_pose_to_local(pose, corner[c], local[c]);
    double depth = pel_solid_depth(&o->tool->solid, local[0], local[1], local[2], weights, normal);
    if (depth > 0)
        pel_rotate(pose->rotation, normal, out);
    return depth;
}

/* ---- meshes ---- */

static void low_and_high(double corner[3][3], double low[3], double high[3])
{
    pel_bounds_clear(low, high);
    for (int c = 0; c < 3; c++)
        pel_bounds_add(low, high, corner[c]);
}

/* whether a triangle of the tool's mesh at a pose cuts one of the body */
static bool is_cut(const overlap *o, const pel_pose *pose, double corner[3][3])
{
    const pel_mesh *mesh = o->tool->mesh;
    double low[3], high[3], own[3][3], own_low[3], own_high[3], far = o->tool->solid.radius, nearest[3];
    if (pel_closest_point_triangle(pose->position, corner[0], corner[1], corner[2], nearest) > far * far)
        return false;
    low_and_high(corner, low, high);
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        for (int c = 0; c < 3; c++)
            pel_pose_to_world(pose, mesh->positions[mesh->triangles[t][c]], own[c]);
        low_and_high(own, own_low, own_high);
        bool apart = false;
        for (int k = 0; k < 3; k++)
            apart |= own_low[k] > high[k] || low[k] > own_high[k];
        if (!apart && pel_triangles_intersect((const double(*)[3])own, (const double(*)[3])corner))
            return true;
    }
    return false;
}

/* ---- the way out ---- */

static bool overlaps(const overlap *o, const pel_pose *pose)
{
    const pel_model *model = o->sim->model;
    double corner[3][3], out[3], inner[3];
    for (int32_t i = 0; i < pel_surface_count(model, o->body); i++) {
        load_corners(o, pel_surface_triangle(model, o->body, i), corner);
        if (o->tool->mesh != NULL ? is_cut(o, pose, corner) : depth_at(o, pose, corner, out) > 0)
            return true;
    }
    pel_vec3_copy(pose->position, inner);
    if (o->tool->mesh != NULL)
        pel_pose_to_world(pose, o->tool->mesh->positions[0], inner);
    return model->bodies[o->body].closed && is_enclosed(o->sim, inner, o->body);
}

static void add_direction(double directions[DIRECTION_LIMIT][3], int *count, const double direction[3])
{
    double unit[3];
    pel_vec3_copy(direction, unit);
    if (!(pel_vec3_normalize(unit) > 0))
        return;
    for (int sign = -1; sign <= 1 && *count < DIRECTION_LIMIT; sign += 2)
        pel_vec3_scale(unit, sign, directions[(*count)++]);
}

/* also returns a way that is sure to be enough */
static double find_directions(const overlap *o, double directions[DIRECTION_LIMIT][3], int *count)
{
    const pel_model *model = o->sim->model;
    const double *center = o->tool->pose.position;
    double corner[3][3], weights[3], out[3], outmost[3] = {0, 0, 0}, nearest[3] = {0, 0, 0};
    double least = HUGE_VAL, deepest = 0, farthest = 0;
    for (int32_t i = 0; i < pel_surface_count(model, o->body); i++) {
        load_corners(o, pel_surface_triangle(model, o->body, i), corner);
        for (int c = 0; c < 3; c++)
            farthest = pel_max(farthest, pel_vec3_distance(center, corner[c]));
        double square = pel_closest_point_triangle(center, corner[0], corner[1], corner[2], weights);
        for (int k = 0; k < 3 && square < least; k++)
            nearest[k] = weights[0] * corner[0][k] + weights[1] * corner[1][k] + weights[2] * corner[2][k] - center[k];
        least = pel_min(least, square);
        double depth = o->tool->mesh == NULL ? depth_at(o, &o->tool->pose, corner, out) : 0;
        if (depth > deepest) {
            deepest = depth;
            pel_vec3_copy(out, outmost);
        }
    }
    add_direction(directions, count, nearest);
    add_direction(directions, count, outmost);
    for (int k = 0; k < 3; k++) {
        const double axis[3] = {k == 0, k == 1, k == 2};
        double turned[3];
        pel_rotate(o->tool->pose.rotation, axis, turned);
        add_direction(directions, count, axis);
        add_direction(directions, count, turned);
    }
    return farthest + 2 * pel_tool_size(o->tool);
}

/* m, the least way after which a tool is outside a body */
static double way_out(const pel_sim *sim, const pel_tool *tool, int32_t body)
{
    const overlap o = {sim, tool, body};
    double directions[DIRECTION_LIMIT][3];
    int count = 0;
    double least = find_directions(&o, directions, &count), tolerance = ldexp(least, -BISECTIONS);
    for (int i = 0; i < count; i++) {
        double low = 0, high = least;
        pel_pose pose = tool->pose;
        pel_vec3_along(tool->pose.position, high, directions[i], pose.position);
        /* no shorter way in this direction */
        if (i > 0 && overlaps(&o, &pose))
            continue;
        while (high - low > tolerance) {
            double middle = 0.5 * (low + high);
            pel_vec3_along(tool->pose.position, middle, directions[i], pose.position);
            if (overlaps(&o, &pose))
                low = middle;
            else
                high = middle;
        }
        least = high;
    }
    return least;
}

/* ---- the check ---- */

pel_status pel_tool_refuse_inside(const pel_sim *sim, int32_t index, int32_t body, pel_error *error)
{
    PEL_ASSERT_INDEX(body, sim->model->body_count);
    const pel_tool *tool = &sim->tools->items[index];
    return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", index,
                              tool->grasp ? "give `press: false` if it only grasps, or move its first key away"
                                          : "move its first key away from the body by at least that much",
                              "tool '%s' starts inside body '%s' (by %.3g m)", tool->name,
                              sim->model->bodies[body].name, way_out(sim, tool, body));
}

pel_status pel_tool_check_outside(const pel_sim *sim, int32_t index, pel_error *error)
{
    const pel_tool *tool = &sim->tools->items[index];
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const overlap o = {sim, tool, b};
        double deepest = 0, corner[3][3], out[3];
        for (int32_t i = 0; pel_tool_acts_on(tool, b) && i < pel_surface_count(sim->model, b); i++) {
            load_corners(&o, pel_surface_triangle(sim->model, b, i), corner);
            deepest = pel_max(deepest, depth_at(&o, &tool->pose, corner, out));
        }
        bool is_inside = pel_tool_acts_on(tool, b) && pel_tool_starts_within(sim, tool->pose.position, b);
        if (is_inside || deepest > START_DEPTH * pel_tool_size(tool))
            return pel_tool_refuse_inside(sim, index, b, error);
    }
    return PEL_OK;
}

pel_status pel_tool_check_start(pel_sim *sim, int32_t index, pel_error *error)
{
    const pel_tool *tool = &sim->tools->items[index];
    if (!tool->press || tool->mesh != NULL || tool->support != NULL)
        return PEL_OK;
    return pel_tool_check_outside(sim, index, error);
}

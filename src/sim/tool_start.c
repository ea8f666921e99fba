/* Where a tool starts: outside of the bodies that it presses. */
#include "base/status.h"
#include "sim/tool.h"

/* solid angle of a triangle seen from the origin over 4 pi */
static double winding(const double a[3], const double b[3], const double c[3])
{
    double la = pel_vec3_length(a), lb = pel_vec3_length(b), lc = pel_vec3_length(c), n[3];
    pel_vec3_cross(b, c, n);
    double divisor = la * lb * lc + pel_vec3_dot(a, b) * lc + pel_vec3_dot(b, c) * la + pel_vec3_dot(c, a) * lb;
    return atan2(pel_vec3_dot(a, n), divisor) / 6.283185307179586;
}

bool pel_tool_is_enclosed(const pel_sim *sim, const double point[3], int32_t body)
{
    double sum = 0;
    for (int32_t i = 0; i < pel_surface_count(sim->model, body); i++) {
        int32_t t = pel_surface_triangle(sim->model, body, i);
        double corner[3][3];
        for (int c = 0; c < 3; c++) {
            pel_vertex_position(sim->state->position, sim->model->triangles[t][c], corner[c]);
            pel_vec3_subtract(corner[c], point, corner[c]);
        }
        sum += winding(corner[0], corner[1], corner[2]);
    }
    return fabs(sum) > 0.5;
}

static pel_status refuse_inside(const pel_tool *tool, int32_t index, const char *body, double depth, pel_error *error)
{
    pel_fail(error, PEL_BAD_ARGUMENT, "tool '%s' starts inside body '%s' (by %.3g m)", tool->name, body, depth);
    pel_fail_element(error, "tool", index);
    pel_fail_remedy(error, "move its first key away from the body by at least that much");
    return PEL_BAD_ARGUMENT;
}

/* how far the solid extends from its centre along a unit vector of its frame */
static double extent_along(const pel_solid *solid, const double along[3])
{
    const double *half = solid->half_extents;
    if (solid->kind == PEL_SOLID_BOX)
        return half[0] * fabs(along[0]) + half[1] * fabs(along[1]) + half[2] * fabs(along[2]);
    return solid->radius + (solid->kind == PEL_SOLID_CAPSULE ? solid->half_length * fabs(along[2]) : 0);
}

/* the way out of a body for a tool whose centre is inside: through the nearest point of the surface, by all of the tool
 */
static double depth_inside(const pel_sim *sim, const pel_tool *tool, int32_t body)
{
    double least = HUGE_VAL, corner[3][3], nearest[3] = {0, 0, 0}, weights[3];
    for (int32_t i = 0; i < pel_surface_count(sim->model, body); i++) {
        const int32_t *v = sim->model->triangles[pel_surface_triangle(sim->model, body, i)];
        for (int c = 0; c < 3; c++)
            pel_vertex_position(sim->state->position, v[c], corner[c]);
        double square = pel_closest_point_triangle(tool->pose.position, corner[0], corner[1], corner[2], weights);
        if (!(square < least))
            continue;
        least = square;
        for (int c = 0; c < 3; c++)
            nearest[c] = weights[0] * corner[0][c] + weights[1] * corner[1][c] + weights[2] * corner[2][c];
    }
    double distance = sqrt(least), along[3] = {0, 0, 1};
    pel_pose_to_local(&tool->pose, nearest, nearest);
    if (distance > 0)
        pel_vec3_scale(nearest, 1 / distance, along);
    return distance + extent_along(&tool->solid, along);
}

pel_status pel_tool_check_outside(const pel_sim *sim, int32_t index, pel_error *error)
{
    const pel_tool *tool = &sim->tools[index];
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_body *body = &sim->model->bodies[b];
        if (tool->body >= 0 && tool->body != b)
            continue;
        double deepest = 0, weights[3], normal[3];
        for (int32_t i = 0; i < pel_surface_count(sim->model, b); i++) {
            int32_t t = pel_surface_triangle(sim->model, b, i);
            deepest = fmax(deepest,
                           pel_tool_triangle_depth(sim, tool, &tool->solid, sim->state->position, t, weights, normal));
        }
        if (body->closed && pel_tool_is_enclosed(sim, tool->pose.position, b))
            return refuse_inside(tool, index, body->name, depth_inside(sim, tool, b), error);
        if (deepest > 1e-3 * pel_tool_size(tool))
            return refuse_inside(tool, index, body->name, deepest, error);
    }
    return PEL_OK;
}

/* A local model has two kinds of planes. Touched planes carry the force of the last step: forces on the touched
   vertices are grouped by direction, and each group gives a plane along its sum N, whose offset normal . x + |N| / k
   makes it push with N at the tool's position x. Near triangles, which the tool has not touched yet, give planes
   through the tool's position minus the gap; they count where the surface is concave there, since the half spaces of a
   convex surface exclude more than the surface does. */

#include "haptic/local_model.h"

#include "math/extremes.h"
#include "math/vec3.h"
#include "tool/near.h"
#include "tool/pose.h"
#include "tool/sagitta.h"

/* directions within 60 degrees make one plane */
#define SAME_DIRECTION 0.5
/* within 45 degrees: of triangles whose direction is known about */
#define SURELY_SAME 0.7
/* share of the sum of the magnitudes of all forces: smaller groups get no plane */
#define LEAST_GROUP 0.02
/* of the reach: moves below this tell nothing about stiffness, and moves of this much tell half of it */
#define LEAST_MOVE 2e-3
#define TELLING_MOVE 0.1
/* of the sums of the estimate, that is kept when a step is added */
#define MEMORY 0.7

/* a plane before its stiffness is known */
typedef struct candidate {
    double normal[3];
    double point[3]; /* m, of the surface */
    double gap;      /* m; touched: 0 */
    double force;    /* N; near: 0 */
} candidate;

typedef struct candidates {
    candidate list[PEL_HAPTIC_PLANES];
    int32_t count;
} candidates;

static bool is_like(const double a[3], const double b[3])
{
    return pel_vec3_dot(a, b) > SAME_DIRECTION;
}

/* ---- touched ---- */

/* force of a touched vertex on the tool; returns its size and its direction */
static double touch_force(const pel_sim *sim, int32_t v, double direction[3])
{
    pel_contact_force_at(&sim->contact_forces.vertex, v, direction);
    pel_vec3_scale(direction, -1, direction);
    return pel_vec3_normalize(direction);
}

static bool has_seed_like(const double seeds[][3], int32_t count, const double direction[3])
{
    for (int32_t s = 0; s < count; s++)
        if (is_like(seeds[s], direction))
            return true;
    return false;
}

/* directions of the largest forces, each unlike those before it */
static int32_t find_seeds(const pel_sim *sim, const pel_tool *tool, double seeds[PEL_HAPTIC_PLANES][3])
{
    int32_t count = 0;
    for (; count < PEL_HAPTIC_PLANES; count++) {
        double largest = 0, direction[3];
        for (int32_t i = 0; i < tool->touch_count; i++) {
            double size = touch_force(sim, tool->touches[i].vertex, direction);
            if (size > largest && !has_seed_like((const double(*)[3])seeds, count, direction)) {
                largest = size;
                pel_vec3_copy(direction, seeds[count]);
            }
        }
        if (!(largest > 0))
            break;
    }
    return count;
}

/* Sums the forces of the touched vertices by seeds: normal is the sum [N], point the mean place by force, force the sum
   of the sizes. */
static void sum_groups(const pel_sim *sim, const pel_tool *tool, const double seeds[][3], int32_t seed_count,
                       candidate *groups)
{
    for (int32_t i = 0; i < tool->touch_count; i++) {
        double direction[3], x[3];
        double size = touch_force(sim, tool->touches[i].vertex, direction);
        for (int32_t s = 0; s < seed_count; s++) {
            if (!is_like(seeds[s], direction))
                continue;
            pel_vertex_position(sim->state->position, tool->touches[i].vertex, x);
            pel_vec3_along(groups[s].normal, size, direction, groups[s].normal);
            pel_vec3_along(groups[s].point, size, x, groups[s].point);
            groups[s].force += size;
            break;
        }
    }
}

/* planes whose forces add up to that on the tool, exactly */
static void add_touched(const pel_sim *sim, const pel_tool *tool, candidates *found)
{
    double seeds[PEL_HAPTIC_PLANES][3], left[3], total = 0;
    candidate groups[PEL_HAPTIC_PLANES] = {0};
    if (!(pel_vec3_length(tool->force) > 0))
        return;
    int32_t count = find_seeds(sim, tool, seeds);
    sum_groups(sim, tool, (const double(*)[3])seeds, count, groups);
    for (int32_t g = 0; g < count; g++)
        total += groups[g].force;
    pel_vec3_copy(tool->force, left);
    for (int32_t g = 0; g < count; g++)
        if (groups[g].force > LEAST_GROUP * total && pel_vec3_length(groups[g].normal) > 0) {
            pel_vec3_scale(groups[g].point, 1 / groups[g].force, groups[g].point);
            pel_vec3_subtract(left, groups[g].normal, left);
            found->list[found->count++] = groups[g];
        }
    /* forces of other contacts on these vertices, and small groups, go with the largest one */
    if (found->count == 0) {
        found->count = 1;
        pel_vec3_set(found->list[0].normal, 0, 0, 0);
        pel_vec3_copy(tool->pose.position, found->list[0].point);
    }
    pel_vec3_add(found->list[0].normal, left, found->list[0].normal);
    for (int32_t i = 0; i < found->count; i++)
        found->list[i].force = pel_vec3_normalize(found->list[i].normal);
}

/* ---- near ---- */

/* keeps the nearest triangles of unlike directions */
static void consider(const candidate *near, candidates *found)
{
    int32_t farthest = 0;
    for (int32_t i = 0; i < found->count; i++) {
        if (is_like(found->list[i].normal, near->normal)) {
            if (near->gap < found->list[i].gap)
                found->list[i] = *near;
            return;
        }
        if (found->list[i].gap > found->list[farthest].gap)
            farthest = i;
    }
    if (found->count < PEL_HAPTIC_PLANES)
        found->list[found->count++] = *near;
    else if (near->gap < found->list[farthest].gap)
        found->list[farthest] = *near;
}

/* Whether a triangle is farther from a ball than its reach, or than a plane of its direction that was found: by the
   distance of its middle, less that from there to its farthest corner. Other shapes: false. */
static bool is_behind(const pel_tool *tool, const pel_solid *press, double corners[3][3], double reach,
                      const candidates *found)
{
    double way[3], width = 0;
    if (!pel_solid_is_ball(press))
        return false;
    for (int k = 0; k < 3; k++)
        way[k] = (corners[0][k] + corners[1][k] + corners[2][k]) / 3 - tool->pose.position[k];
    for (int c = 0; c < 3; c++) {
        double arm[3];
        pel_vec3_subtract(corners[c], tool->pose.position, arm);
        pel_vec3_subtract(arm, way, arm);
        width = pel_max(width, pel_vec3_squared_length(arm));
    }
    double distance = pel_vec3_length(way), gap = distance - press->radius - sqrt(width);
    if (gap > reach)
        return true;
    for (int32_t i = 0; i < found->count; i++)
        if (found->list[i].gap < gap && -pel_vec3_dot(found->list[i].normal, way) > SURELY_SAME * distance)
            return true;
    return false;
}

/* where a triangle may cut into the tool: depth of its deepest corner in the grown tool, if that is touched first */
static double deepest_corner(const pel_solid *grown, double local[3][3], double depth, double weights[3],
                             double normal[3])
{
    for (int c = 0; c < 3; c++) {
        double out[3], own = -pel_solid_distance(grown, local[c], out);
        if (!(own > depth))
            continue;
        depth = own;
        pel_vec3_copy(out, normal);
        pel_vec3_set(weights, c == 0, c == 1, c == 2);
    }
    return depth;
}

/* the plane of a triangle within the reach of a tool; false if none is nearer than those found */
static bool near_plane(const pel_sim *sim, const pel_tool *tool, int32_t t, double reach, const candidates *found,
                       candidate *near)
{
    double corners[3][3], local[3][3], weights[3];
    const int32_t *v = sim->model->triangles[t];
    const pel_solid press = pel_tool_press_solid(sim, tool, v[0]), grown = pel_solid_grown(&press, reach);
    for (int c = 0; c < 3; c++)
        pel_vertex_position(sim->state->position, v[c], corners[c]);
    if (is_behind(tool, &press, corners, reach, found))
        return false;
    for (int c = 0; c < 3; c++)
        pel_pose_to_local(&tool->pose, corners[c], local[c]);
    const pel_solid own = pel_tool_triangle_solid(sim, tool, t), grown_own = pel_solid_grown(&own, reach);
    double depth = pel_solid_depth(&grown_own, local[0], local[1], local[2], weights, near->normal);
    if (pel_tool_cuts(sim, tool, v[0]))
        depth = deepest_corner(&grown, local, depth, weights, near->normal);
    if (!(depth > 0))
        return false;
    pel_rotate(tool->pose.rotation, near->normal, near->normal);
    pel_vec3_scale(near->normal, -1, near->normal);
    pel_vec3_set(near->point, 0, 0, 0);
    for (int c = 0; c < 3; c++)
        pel_vec3_along(near->point, weights[c], corners[c], near->point);
    near->gap = reach - depth;
    near->force = 0;
    return true;
}

/* whether the surface at `near` rises above the planes found, in another direction */
static bool is_concave(const candidates *found, const candidate *near)
{
    for (int32_t i = 0; i < found->count; i++) {
        double way[3];
        pel_vec3_subtract(near->point, found->list[i].point, way);
        if (is_like(found->list[i].normal, near->normal) || !(pel_vec3_dot(way, found->list[i].normal) > 0))
            return false;
    }
    return true;
}

static void add_near(pel_sim *sim, pel_tool *tool, double reach, candidates *found)
{
    candidates nearest = {.count = 0};
    int32_t count = pel_tool_near_triangles(sim, tool, &tool->in_reach, sim->state->position, reach);
    for (int32_t i = 0; i < count; i++) {
        candidate near;
        if (near_plane(sim, tool, sim->tools->near_triangles[i], reach, &nearest, &near))
            consider(&near, &nearest);
    }
    /* in the order of their gaps */
    while (nearest.count > 0 && found->count < PEL_HAPTIC_PLANES) {
        int32_t first = 0;
        for (int32_t i = 1; i < nearest.count; i++)
            if (nearest.list[i].gap < nearest.list[first].gap)
                first = i;
        if (is_concave(found, &nearest.list[first]))
            found->list[found->count++] = nearest.list[first];
        nearest.list[first] = nearest.list[--nearest.count];
    }
}

/* ---- stiffness ---- */

/* Adds the measurement of the step from the last model to this one. If both were touched, forces and positions change
   along the planes; at a first touch the force has grown from 0 over the depth behind the planes that were near. */
static void learn(const pel_local_model *last, const pel_local_model *now, pel_surface_estimate *estimate)
{
    double move[3], change[3], force_change = 0, depth_change = 0, least = LEAST_MOVE * now->reach;
    pel_vec3_subtract(now->tool_position, last->tool_position, move);
    pel_vec3_subtract(now->force, last->force, change);
    if (last->touched_count > 0)
        force_change = -pel_vec3_dot(change, move);
    for (int32_t i = 0; i < last->plane_count; i++) {
        const pel_haptic_plane *plane = &last->planes[i];
        double depth = plane->offset - pel_vec3_dot(plane->normal, now->tool_position);
        if (last->touched_count > 0 && i < last->touched_count) {
            double way = pel_vec3_dot(plane->normal, move);
            depth_change += way * way;
        } else if (last->touched_count == 0 && depth > 0) {
            force_change += depth * pel_vec3_dot(now->force, plane->normal);
            depth_change += depth * depth;
        }
    }
    if (!(depth_change > least * least))
        return;
    estimate->force_change = MEMORY * estimate->force_change + force_change;
    estimate->depth_change = MEMORY * estimate->depth_change + depth_change;
    /* a small move tells little: it changes the estimate little */
    double little = TELLING_MOVE * now->reach * TELLING_MOVE * now->reach;
    double stiffness = (estimate->force_change + little * estimate->stiffness) / (estimate->depth_change + little);
    estimate->stiffness = pel_min(pel_max(stiffness, estimate->least), estimate->most);
}

/* ---- the model ---- */

/* three two-sided planes along the axes: held vertices have the same stiffness in all directions */
static void hold(pel_local_model *model)
{
    model->plane_count = model->touched_count = 3;
    for (int i = 0; i < 3; i++) {
        pel_haptic_plane *plane = &model->planes[i];
        *plane = (pel_haptic_plane){.stiffness = model->stiffness, .is_two_sided = true};
        plane->normal[i] = 1;
        plane->offset = model->tool_position[i] + model->force[i] / model->stiffness;
    }
}

/* near planes lie where they are at the end of the step */
static void set_planes(const candidates *found, const double end[3], pel_local_model *model)
{
    model->plane_count = found->count;
    for (int32_t i = 0; i < found->count; i++) {
        const candidate *c = &found->list[i];
        pel_haptic_plane *plane = &model->planes[i];
        *plane = (pel_haptic_plane){.stiffness = model->stiffness};
        pel_vec3_copy(c->normal, plane->normal);
        plane->offset = c->force > 0 ? pel_vec3_dot(c->normal, model->tool_position) + c->force / model->stiffness
                                     : pel_vec3_dot(c->normal, end) - c->gap;
        model->touched_count += c->force > 0;
    }
}

/* the position at which the force of the last step acts: with velocities it is a mean over the step, in which the tool
   moved evenly, otherwise the force at its end */
static void tool_place(const pel_sim *sim, const pel_tool *tool, double place[3])
{
    pel_vec3_copy(tool->pose.position, place);
    if (sim->state->velocity_next == NULL)
        return;
    pel_vec3_add(place, tool->pose_start.position, place);
    pel_vec3_scale(place, 0.5, place);
}

void pel_local_model_take(pel_sim *sim, int32_t tool, double reach, const pel_local_model *last,
                          pel_surface_estimate *estimate, pel_local_model *model)
{
    pel_tool *t = &sim->tools->items[tool];
    candidates found = {.count = 0};
    *model = (pel_local_model){.reach = reach};
    tool_place(sim, t, model->tool_position);
    pel_vec3_copy(t->force, model->force);
    if (last != NULL && pel_vec3_length(model->force) > 0)
        learn(last, model, estimate);
    /* planes lie at most twice the reach above the tool: farther up the model does not hold */
    model->stiffness = pel_max(estimate->stiffness, 0.5 * pel_vec3_length(model->force) / reach);
    if (t->held_count > 0) {
        hold(model);
        return;
    }
    add_touched(sim, t, &found);
    if (t->press && t->mesh == NULL)
        add_near(sim, t, reach, &found);
    set_planes(&found, t->pose.position, model);
}

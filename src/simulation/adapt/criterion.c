/* Criteria of refinement: measures at a vertex relative to their thresholds.

   Force (paper A, section 3.2): the elastic force, springs, volumetric spring and shell, over the vertex's share of the
   area. At rest it balances the external forces on the vertex, tools and loads, per area; it is zero where none acts.

   Curvature: |H - H of the rest shape|, with H = (sum of |e| 2 tan(angle / 2) over the edges e at the vertex) / (4 A),
   with the angle between the triangles at e, and A a third of the area around. On a sphere H is 1 / radius. The angle
   alone would halve with each level and so end its own refinement; H stays, and grows where the surface folds, until
   the finest level is there. 2 tan(angle / 2) (Grinspun et al. 2003) takes no arc tangent and grows without bound
   towards a complete fold.

   Tools: the distance of the triangles around from the surface of a tool, at the present poses.

   A measure over area or length does not change with the level, the deformation being smooth. */
#include "adapt/criterion.h"

#include "adapt/refine.h"
#include "base/assert.h"
#include "math/extremes.h"
#include "tool/near.h"

/* a tool is left at this multiple of the distance at which it is met */
#define LEAVING_RATIO 1.25

static void note(pel_verdict *verdict, double measure, double above, double below)
{
    verdict->strength = pel_max(verdict->strength, measure / above);
    verdict->warm |= measure >= below;
}

/* ---- curvature ---- */

/* the corners of one triangle at a vertex, seen from it: vectors along its sides, twice the area, normal times that */
typedef struct sector {
    double next[3], previous[3], normal[3], area;
} sector;

static void record_difference(const pel_record *records, int32_t to, int32_t from, double difference[3])
{
    for (int i = 0; i < 3; i++)
        difference[i] = (double)records[to][i] - (double)records[from][i];
}

static sector sector_of(const pel_refined_body *own, const pel_record *records, int32_t place,
                        const pel_front_corner *corner)
{
    sector s;
    record_difference(records, own->model_index[corner->next], place, s.next);
    record_difference(records, own->model_index[corner->previous], place, s.previous);
    pel_vec3_cross(s.next, s.previous, s.normal);
    s.area = pel_vec3_length(s.normal);
    return s;
}

/* |e| 2 tan(angle / 2) of the edge between two sectors, positive where the surface is convex */
static double edge_curvature(const sector *before, const sector *after)
{
    double cross[3];
    pel_vec3_cross(before->normal, after->normal, cross);
    double flat = before->area * after->area + pel_vec3_dot(before->normal, after->normal);
    double sine = -2 * pel_vec3_dot(cross, after->next);
    /* a complete fold: as if it lacked a little */
    return sine / pel_max(flat, 1e-6 * before->area * after->area);
}

static double mean_curvature(const pel_refined_body *own, const pel_record *records, int32_t place,
                             const pel_front_corner *fan, int32_t count)
{
    bool open = fan[count - 1].previous_edge != fan[0].next_edge;
    sector first = sector_of(own, records, place, &fan[0]), before = first;
    double area = first.area, sum = 0;
    for (int32_t i = 1; i < count; i++) {
        sector s = sector_of(own, records, place, &fan[i]);
        sum += edge_curvature(&before, &s);
        area += s.area;
        before = s;
    }
    if (!open)
        sum += edge_curvature(&before, &first);
    /* the sum of twice the areas is 6 A */
    return area > 0 ? sum * 6 / (4 * area) : 0;
}

static double curvature_change(pel_sim *sim, int32_t body, int32_t place, const pel_front_corner *fan, int32_t count)
{
    const pel_refined_body *own = &sim->active->bodies[body];
    double *rest = &sim->refine[body].rest_curvatures[place - sim->model->bodies[body].slice_begin * PEL_WIDTH];
    if (isnan(*rest))
        *rest = mean_curvature(own, sim->model->rest, place, fan, count);
    return fabs(mean_curvature(own, sim->state->position, place, fan, count) - *rest);
}

/* ---- tools ---- */

/* the solid grown by a width on all sides */
static pel_solid grown(const pel_solid *solid, double width)
{
    pel_solid large = *solid;
    large.radius += width;
    for (int i = 0; i < 3; i++)
        large.half_extents[i] += width;
    return large;
}

/* depth of the triangles of a fan in the solid at the tool's pose */
static double fan_depth(const pel_sim *sim, const pel_refined_body *own, const pel_tool *tool, const pel_solid *solid,
                        int32_t place, const pel_front_corner *fan, int32_t count)
{
    double deepest = 0, corners[3][3], weights[3], normal[3], x[3];
    pel_vertex_position(sim->state->position, place, x);
    pel_pose_to_local(&tool->pose, x, corners[0]);
    for (int32_t i = 0; i < count; i++) {
        const int32_t others[2] = {fan[i].next, fan[i].previous};
        for (int c = 0; c < 2; c++) {
            pel_vertex_position(sim->state->position, own->model_index[others[c]], x);
            pel_pose_to_local(&tool->pose, x, corners[c + 1]);
        }
        deepest = pel_max(deepest, pel_solid_depth(solid, corners[0], corners[1], corners[2], weights, normal));
    }
    return deepest;
}

/* whether a point is farther than `reach` from a solid at the tool's place */
static bool is_far(const pel_tool *tool, const pel_solid *solid, const double x[3], double reach)
{
    double local[3], half[3], normal[3];
    pel_pose_to_local(&tool->pose, x, local);
    pel_solid_half_box(solid, half);
    for (int i = 0; i < 3; i++)
        if (fabs(local[i]) > half[i] + reach)
            return true;
    return pel_solid_distance(solid, local, normal) > reach;
}

/* ---- a vertex ---- */

/* shared by measures that need the triangles around a vertex; the fan is built on first use */
typedef struct look {
    pel_sim *sim;
    int32_t body, place, fan_count;
    double longest; /* edge at the vertex */
} look;

static const pel_front_corner *fan_of(look *at)
{
    pel_refined_model *active = at->sim->active;
    if (at->fan_count == 0)
        at->fan_count =
            pel_front_fan(active->bodies[at->body].front, at->sim->model->mesh_vertex[at->place], active->fan);
    return active->fan;
}

static void look_at_tools(look *at, double near, pel_verdict *verdict)
{
    const pel_sim *sim = at->sim;
    double x[3];
    pel_vertex_position(sim->state->position, at->place, x);
    for (int32_t i = 0; i < sim->tools->count; i++) {
        const pel_tool *tool = &sim->tools->items[i];
        if (!pel_tool_acts_on(tool, at->body))
            continue;
        pel_solid large = grown(&tool->solid, LEAVING_RATIO * near);
        if (is_far(tool, &large, x, at->longest))
            continue;
        const pel_front_corner *fan = fan_of(at);
        double depth = fan_depth(sim, &sim->active->bodies[at->body], tool, &large, at->place, fan, at->fan_count);
        if (depth > 0)
            /* 1 at the distance `near`, 2 where it touches */
            note(verdict, 2 - LEAVING_RATIO + depth / near, 1, 0);
    }
}

/* size of the elastic force on a vertex: springs, volumetric spring and shell */
static double elastic_force(const pel_sim *sim, int32_t body, int32_t place, const pel_wide3 *springs, int32_t lane)
{
    double force[3], shell[3];
    pel_vec3_set(force, (double)springs->x[lane], (double)springs->y[lane], (double)springs->z[lane]);
    if (sim->model->bodies[body].shell != NULL) {
        pel_shell_elastic_force_at(sim->shells, body, sim->state->position, pel_sim_time(sim), place, shell);
        pel_vec3_add(force, shell, force);
    }
    return pel_vec3_length(force);
}

/* whether a vertex of the slice may have triangles within the distance at which a tool is left; an axis-aligned box
   excludes most of them */
static bool is_near_tool(const pel_sim *sim, int32_t body, const pel_wide3 *x, pel_wide longest)
{
    const pel_wide reach = longest * pel_wide_splat((pel_real)1.001);
    for (int32_t i = 0; i < sim->tools->count; i++) {
        const pel_real(*box)[3] = (const pel_real(*)[3])sim->tools->items[i].look_box;
        if (!pel_tool_acts_on(&sim->tools->items[i], body))
            continue;
        pel_wide_mask apart = x->x + reach < pel_wide_splat(box[0][0]);
        apart |= x->x - reach > pel_wide_splat(box[1][0]);
        apart |= x->y + reach < pel_wide_splat(box[0][1]);
        apart |= x->y - reach > pel_wide_splat(box[1][1]);
        apart |= x->z + reach < pel_wide_splat(box[0][2]);
        apart |= x->z - reach > pel_wide_splat(box[1][2]);
        if (!pel_wide_all(apart))
            return true;
    }
    return false;
}

void pel_refine_criterion_begin(pel_sim *sim, int32_t body)
{
    PEL_ASSERT_INDEX(body, sim->model->body_count);
    double near = sim->model->bodies[body].detail->def.near_tools;
    for (int32_t i = 0; near > 0 && i < sim->tools->count; i++) {
        const pel_search_box box = pel_tool_box(&sim->tools->items[i], LEAVING_RATIO * near, 0);
        for (int k = 0; k < 3; k++) {
            sim->tools->items[i].look_box[0][k] = box.low[k];
            sim->tools->items[i].look_box[1][k] = box.high[k];
        }
    }
}

void pel_refine_criterion_slice(pel_sim *sim, int32_t body, int32_t slice, const pel_body_force *numbers,
                                pel_verdict verdicts[PEL_WIDTH])
{
    PEL_ASSERT_INDEX(body, sim->model->body_count);
    const pel_model *model = sim->model;
    const pel_refine_def *def = &model->bodies[body].detail->def;
    pel_slice own = pel_slice_load(sim->state->position, slice);
    pel_wide longest = pel_wide_splat(0);
    pel_wide3 force = {longest, longest, longest};
    if (def->above > 0)
        force = pel_elastic_force(model, sim->state->position, slice, &own.position, numbers, &longest);
    else if (def->near_tools > 0)
        longest = pel_slice_longest(model, sim->state->position, slice, &own.position);
    bool near_tool = def->near_tools > 0 && is_near_tool(sim, body, &own.position, longest);
    for (int32_t lane = 0; lane < PEL_WIDTH; lane++) {
        int32_t place = slice * PEL_WIDTH + lane;
        verdicts[lane] = (pel_verdict){0};
        if (model->mesh_vertex[place] < 0)
            continue;
        look at = {.sim = sim, .body = body, .place = place, .longest = (double)longest[lane]};
        if (def->above > 0 && model->inverse_mass[place] > 0)
            note(&verdicts[lane], 3 * elastic_force(sim, body, place, &force, lane) / sim->active->areas[place],
                 def->above, def->below);
        if (def->curvature_above > 0) {
            const pel_front_corner *fan = fan_of(&at);
            note(&verdicts[lane], curvature_change(sim, body, place, fan, at.fan_count), def->curvature_above,
                 def->curvature_below);
        }
        if (near_tool)
            look_at_tools(&at, def->near_tools, &verdicts[lane]);
    }
}

void pel_refine_criterion_forget(const pel_sim *sim, int32_t body)
{
    PEL_ASSERT_INDEX(body, sim->model->body_count);
    const pel_refine_body *refine = &sim->refine[body];
    for (int32_t i = 0; i < refine->curvature_count; i++)
        refine->rest_curvatures[i] = (double)NAN;
}

/* The contact thickness of bodies and tools.

   By default a surface that is open and deformable has the thickness of its sheet: thinner layers are left in one
   substep of a fall, and steps are divided. It has no more than what the mesh and the start leave room for, so that no
   layer acts before anything moves:

     a quarter of its shortest edge, and half of the least height of its triangles, so that neighbours in the sheet
     meet only where a triangle collapses;
     half of the mean edge of any deformable body, since a search looks around all of them as far as the thickest layer;
     the distance at which it starts from itself, from other bodies and from tools,

   but at least the thickness that bodies without a sheet have. These limits are found once, and are part of the state:
   cuts move rest positions, and parts that are near each other later are no start. */
#include "touch/thickness.h"

#include "base/assert.h"
#include "base/status.h"
#include "math/bounds.h"
#include "math/extremes.h"
#include "model/quantity.h"
#include "stage/layer.h"
#include "tool/tools.h"
#include "touch/contact.h"
#include "touch/tangle.h"

#include <stdio.h>

static double diagonal(const pel_model *model)
{
    double low[3], high[3], x[3];
    pel_bounds_clear(low, high);
    for (int32_t v = 0; v < model->vertex_count; v++)
        if (model->mesh_vertex[v] >= 0) {
            pel_vertex_position(model->rest, v, x);
            pel_bounds_add(low, high, x);
        }
    return pel_vec3_distance(low, high);
}

static int32_t levels_of(const pel_model *model, int32_t body)
{
    return model->bodies[body].detail != NULL ? model->bodies[body].detail->def.levels : 0;
}

double pel_contact_relative_thickness(const pel_contact_def *def)
{
    return def->relative_thickness > 0 ? def->relative_thickness : PEL_LAYER_RELATIVE;
}

typedef struct edge_place {
    double length; /* m */
    int32_t body, vertex;
} edge_place;

/* shortest edge of a body at rest, on the finest level where it refines, and where it begins */
static edge_place shortest_edge(const pel_model *model, int32_t body)
{
    PEL_ASSERT_INDEX(body, model->body_count);
    const pel_mesh *mesh = model->bodies[body].mesh;
    edge_place shortest = {HUGE_VAL, body, 0};
    for (int32_t h = 0; h < 3 * mesh->triangle_count; h++) {
        int32_t v = mesh->triangles[h / 3][h % 3];
        const double *next = mesh->positions[mesh->triangles[h / 3][(h + 1) % 3]];
        double length = ldexp(pel_vec3_distance(mesh->positions[v], next), -levels_of(model, body));
        if (length < shortest.length)
            shortest = (edge_place){length, body, v};
    }
    return shortest;
}

static pel_status refuse_thickness(const pel_sim *sim, double thickness, bool is_shell, const edge_place *edge,
                                   pel_error *error)
{
    pel_fail(error, PEL_BAD_ARGUMENT, "contact thickness %g%s is more than the shortest edge, %g, of body '%s'",
             thickness, is_shell ? " of the shell" : "", edge->length, sim->given->bodies[edge->body].name);
    pel_fail_element(error, "vertex", edge->vertex);
    pel_fail_remedy(error, "use %s %.3g, or a mesh without such short edges",
                    is_shell ? "a coarser mesh, a thickness in metres of at most" : "at most", 0.5 * edge->length);
    return PEL_BAD_ARGUMENT;
}

/* of the shortest edge, of the least height of a triangle, of the mean edge of any body */
#define EDGE_SHARE 0.25
#define HEIGHT_SHARE 0.5
#define MEAN_SHARE 0.5

/* m, twice the area over the longest edge */
static double height_of(const double x[3], const double y[3], const double z[3])
{
    double u[3], v[3], cross[3];
    pel_vec3_subtract(y, x, u);
    pel_vec3_subtract(z, x, v);
    pel_vec3_cross(u, v, cross);
    double longest = pel_max(pel_vec3_distance(y, z), pel_max(pel_vec3_length(u), pel_vec3_length(v)));
    return longest > 0 ? pel_vec3_length(cross) / longest : 0;
}

static void reduce(pel_thickness_limit *limit, double most, int32_t reason)
{
    if (most < limit->most)
        *limit = (pel_thickness_limit){.most = most, .reason = reason};
}

pel_thickness_limit pel_mesh_thickness_limit(const pel_mesh *mesh, int32_t levels)
{
    pel_thickness_limit limit = {.most = HUGE_VAL, .reason = PEL_LIMIT_EDGE};
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        const double *x[3];
        for (int i = 0; i < 3; i++)
            x[i] = mesh->positions[mesh->triangles[t][i]];
        for (int i = 0; i < 3; i++)
            reduce(&limit, ldexp(EDGE_SHARE * pel_vec3_distance(x[i], x[(i + 1) % 3]), -levels), PEL_LIMIT_EDGE);
        reduce(&limit, ldexp(HEIGHT_SHARE * height_of(x[0], x[1], x[2]), -levels), PEL_LIMIT_HEIGHT);
    }
    return limit;
}

/* m, on the finest level */
static double mean_edge(const pel_model *model, int32_t body)
{
    const pel_mesh *mesh = model->bodies[body].mesh;
    double sum = 0;
    for (int32_t c = 0; c < 3 * mesh->triangle_count; c++) {
        const int32_t *v = mesh->triangles[c / 3];
        sum += pel_vec3_distance(mesh->positions[v[c % 3]], mesh->positions[v[(c + 1) % 3]]);
    }
    return ldexp(sum / (3 * mesh->triangle_count), -levels_of(model, body));
}

/* of g dt^2: a thinner layer is lost in one substep of a fall, the guard stops what it cannot hold, and the step is
   divided; at most so much of the least side of the box around a rigid body, and of its shortest edge */
#define FALL_SHARE 0.0625
#define SIDE_SHARE 3e-3

/* m, of the layer of a rigid body that has none of its own; 0 = it is given, or not rigid */
static double rigid_thickness(const pel_sim *sim, int32_t body)
{
    const pel_mesh *mesh = sim->given->bodies[body].mesh;
    double low[3], high[3], least = HUGE_VAL;
    if (sim->model->bodies[body].rigid == NULL || sim->touch->def.thickness > 0)
        return 0;
    pel_bounds_clear(low, high);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        pel_bounds_add(low, high, mesh->positions[v]);
    for (int k = 0; k < 3; k++)
        least = pel_min(least, high[k] - low[k]);
    double fall = FALL_SHARE * pel_vec3_length(sim->model->gravity) * sim->solver.dt * sim->solver.dt;
    return pel_min(fall, pel_min(SIDE_SHARE * least, EDGE_SHARE * shortest_edge(sim->given, body).length));
}

/* m, the least one where all bodies are rigid, else 0 */
static double all_rigid_thickness(const pel_sim *sim)
{
    double least = HUGE_VAL;
    for (int32_t b = 0; b < sim->model->body_count; b++)
        least = pel_min(least, rigid_thickness(sim, b));
    return least;
}

/* the thickness of all groups without their own: a given one is accepted or refused, the relative one is reduced for
   short edges */
static pel_status choose_thickness(const pel_sim *sim, const edge_place *shortest, double *thickness, pel_error *error)
{
    const pel_contact_def *def = &sim->touch->def;
    double relative = pel_contact_relative_thickness(def);
    *thickness = def->thickness;
    if (!(*thickness > 0))
        *thickness =
            pel_max(pel_min(relative * diagonal(sim->given), 0.5 * shortest->length), all_rigid_thickness(sim));
    if (*thickness > 0)
        return PEL_OK;
    return pel_refuse_element(error, PEL_BAD_ARGUMENT, "vertex", shortest->vertex,
                              "repair the mesh, or give contact a thickness in metres",
                              "body '%s' has an edge without length", sim->given->bodies[shortest->body].name);
}

double pel_membrane_thickness(const pel_body_def *def)
{
    return def->shell.membrane.on ? pel_quantity_mean(&def->shell.membrane.thickness, def->mesh->vertex_count) : 0;
}

/* m, of the sheet that a body is, 0 for filled ones */
static double shell_of(const pel_sim *sim, int32_t body)
{
    PEL_ASSERT_INDEX(body, sim->given->body_count);
    const pel_body_def *def = &sim->given->def.bodies[body];
    double membrane = pel_membrane_thickness(def);
    bool has_mass = !sim->given->bodies[body].closed && def->mass_kind == PEL_MASS_DENSITY;
    return membrane > 0 || !has_mass ? membrane : pel_quantity_mean(&def->thickness, def->mesh->vertex_count);
}

/* m, of the membrane of an open surface that deforms; 0 for all others */
static double sheet_of(const pel_sim *sim, int32_t body)
{
    const pel_body *own = &sim->given->bodies[body];
    return !own->closed && own->rigid == NULL ? pel_membrane_thickness(&sim->given->def.bodies[body]) : 0;
}

/* whether a body has the thickness of its sheet, whatever that is */
static bool is_shell(const pel_sim *sim, int32_t body)
{
    const pel_contact_def *def = &sim->touch->def;
    return def->shell_thickness && !(def->thickness > 0) && !(sim->given->bodies[body].contact_thickness > 0);
}

/* whether it has that of its sheet by default, as far as its limit lets it */
static bool is_sheet(const pel_sim *sim, int32_t body)
{
    const pel_contact_def *def = &sim->touch->def;
    bool is_given = def->thickness > 0 || def->shell_thickness || def->relative_thickness > 0;
    return !is_given && !(sim->given->bodies[body].contact_thickness > 0) && sheet_of(sim, body) > 0;
}

static pel_contact_group group_of(const pel_sim *sim, int32_t number, double thickness)
{
    int32_t tool = number - sim->model->body_count;
    double own = tool < 0 ? sim->given->bodies[number].contact_thickness : sim->tools->items[tool].thickness;
    double friction = tool < 0 ? sim->model->bodies[number].friction : sim->tools->items[tool].friction;
    if (tool < 0 && is_shell(sim, number))
        own = shell_of(sim, number);
    if (tool < 0 && !(own > 0))
        own = pel_max(thickness, rigid_thickness(sim, number));
    if (tool < 0 && is_sheet(sim, number))
        own = pel_max(own, pel_min(sheet_of(sim, number), sim->touch->limits[number].most));
    return (pel_contact_group){.thickness = own > 0 ? own : thickness,
                               .friction = friction >= 0 ? friction : sim->touch->def.friction};
}

/* an animation moves all vertices of the body, for good: its layer is never the weaker one */
static bool is_obstacle(const pel_sim *sim, int32_t body)
{
    bool is = false;
    for (int32_t t = 0; t < sim->tools->count; t++) {
        const pel_tool *tool = &sim->tools->items[t];
        is |= tool->sequence != NULL && tool->body == body && !(tool->grasp_from > 0) && isinf(tool->strength) &&
              isinf(tool->grasp_until) && tool->support_count == sim->given->bodies[body].mesh->vertex_count;
    }
    return is;
}

/* its layer takes the thickness; returns the hardness */
static double take_thickness(pel_sim *sim, int32_t body, double thickness)
{
    pel_layer_set_thickness(sim, body, thickness);
    return is_obstacle(sim, body) ? (double)HUGE_VAL : sim->layers[body].hardness;
}

pel_status pel_contacts_set_groups(pel_sim *sim, pel_contact_set_def *def, pel_contact_group *groups, pel_error *error)
{
    edge_place shortest = {.length = HUGE_VAL};
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        edge_place edges = shortest_edge(sim->given, b);
        shortest = edges.length < shortest.length ? edges : shortest;
    }
    pel_status status = choose_thickness(sim, &shortest, &def->thickness, error);
    for (int32_t i = 0; status == PEL_OK && i < def->body_count + def->obstacle_count; i++) {
        groups[i] = group_of(sim, i, def->thickness);
        if (i < def->body_count)
            groups[i].hardness = take_thickness(sim, i, groups[i].thickness);
        edge_place edges = i < def->body_count ? shortest_edge(sim->given, i) : shortest;
        if (i < def->body_count && groups[i].thickness > edges.length)
            return refuse_thickness(sim, groups[i].thickness, is_shell(sim, i), &edges, error);
    }
    def->shortest_edge = shortest.length;
    return status;
}

/* ---- limits ---- */

void pel_contacts_limit_by_mesh(const pel_sim *sim)
{
    const pel_model *model = sim->given;
    double finest = HUGE_VAL;
    for (int32_t b = 0; b < model->body_count; b++)
        if (model->bodies[b].rigid == NULL)
            finest = pel_min(finest, mean_edge(model, b));
    for (int32_t b = 0; b < model->body_count; b++) {
        sim->touch->limits[b] = pel_mesh_thickness_limit(model->bodies[b].mesh, levels_of(model, b));
        reduce(&sim->touch->limits[b], MEAN_SHARE * finest, PEL_LIMIT_FINEST);
    }
}

/* the tool's distance from bodies is what its search looks for */
static void take_press_margins(const pel_sim *sim)
{
    for (int32_t i = 0; i < sim->tools->count; i++) {
        double *margin = &sim->tools->items[i].press_margin;
        *margin = 0;
        for (int32_t b = 0; b < sim->model->body_count; b++)
            *margin = pel_max(*margin, pel_contact_thickness(sim->contacts, b, sim->model->body_count + i));
    }
}

/* where they change nothing, what the set has learnt of the last steps stays */
static void take_limits(pel_sim *sim)
{
    pel_contact_set *set = sim->contacts;
    bool differs = false;
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        double thickness = group_of(sim, b, set->def.thickness).thickness;
        differs |= thickness != set->groups[b].thickness;
        set->groups[b].thickness = thickness;
        set->groups[b].hardness = take_thickness(sim, b, thickness);
    }
    if (differs)
        pel_contact_set_measure_groups(set);
    take_press_margins(sim);
}

/* A pair of elements at the start, `distance` [m] apart. */
typedef void visit_pair(pel_sim *sim, const pel_collision *pair, double distance, void *context);

/* Visits all pairs nearer than `reach` [m], with a search of its own: nothing of the simulation changes. */
static pel_status visit_near_pairs(pel_sim *sim, double reach, visit_pair *visit, void *context, pel_error *error)
{
    pel_contact_set *set = sim->contacts;
    pel_contacts_place_start(sim);
    const pel_mesh mesh = pel_contact_mesh(set);
    pel_collider_def def = pel_collider_def_default();
    def.mesh = &mesh;
    def.margin = 0;
    def.memory_limit = set->def.memory_limit;
    pel_collider *collider;
    pel_status status = pel_collider_create(&def, &collider, error);
    if (status != PEL_OK)
        return status;
    const pel_collision_groups groups = {set->group_of_point, set->may_meet,
                                         set->def.body_count + set->def.obstacle_count, (const double(*)[3])set->shape};
    status = pel_collider_use_groups(collider, &groups, (const double(*)[3])set->start, error);
    pel_collision_query query = pel_collision_query_default();
    query.start = query.end = set->start[0];
    query.min_separation = reach;
    pel_collision_result result;
    if (status == PEL_OK)
        status = pel_collider_detect(collider, &query, &result, error);
    for (int64_t i = 0; status == PEL_OK && i < result.collision_count; i++) {
        const pel_collision *pair = &result.collisions[i];
        double way[3] = {0, 0, 0};
        for (int k = 0; k < 4; k++)
            pel_vec3_along(way, pair->hit.weight[k], set->start[pair->vertices[k]], way);
        visit(sim, pair, pel_vec3_length(way), context);
    }
    pel_collider_destroy(collider);
    return status;
}

/* share of the thickness that a pair may lack unnoticed: bodies that a mesher put next to each other */
#define GAP_TOLERANCE 0.01

/* of a body that starts so near [m] to a group: two sheets have half of the distance each */
static void limit_body(pel_sim *sim, int32_t body, int32_t other, double distance)
{
    double free = (1 - GAP_TOLERANCE) * distance;
    bool shares = other < sim->model->body_count && is_sheet(sim, other);
    double most = shares ? free : pel_min(free, 2 * free - sim->contacts->groups[other].thickness);
    reduce(&sim->touch->limits[body], most, other);
}

/* lips of a cut may lie on each other */
static void limit_pair(pel_sim *sim, const pel_collision *pair, double distance, void *unused)
{
    (void)unused;
    const pel_contact_set *set = sim->contacts;
    int32_t a = set->group_of_point[pair->vertices[0]], b = set->group_of_point[pair->vertices[3]];
    if (pel_contact_pair_share(set, pair->vertices) < 1)
        return;
    if (a < sim->model->body_count)
        limit_body(sim, a, b, distance);
    if (b < sim->model->body_count)
        limit_body(sim, b, a, distance);
}

/* spheres and capsules are no part of the surface */
static void limit_before_round(pel_sim *sim, int32_t tool, double reach)
{
    const pel_contact_set *set = sim->contacts;
    const pel_obstacle *obstacle = &set->obstacles[tool];
    pel_solid grown = obstacle->solid;
    grown.radius += reach;
    for (int32_t t = set->obstacle_triangle_count; t < set->triangle_count; t++) {
        const int32_t *corners = set->triangles[t];
        int32_t body = set->group_of_point[corners[0]];
        double local[3][3], weights[3], normal[3];
        if (obstacle->body >= 0 && obstacle->body != body)
            continue;
        for (int i = 0; i < 3; i++)
            pel_pose_to_local(&obstacle->pose, set->start[corners[i]], local[i]);
        double depth = pel_solid_depth(&grown, local[0], local[1], local[2], weights, normal);
        if (depth > 0)
            limit_body(sim, body, sim->model->body_count + tool, reach - depth);
    }
}

pel_status pel_contacts_limit_by_start(pel_sim *sim, pel_error *error)
{
    const pel_contact_set *set = sim->contacts;
    double reach = 0;
    for (int32_t b = 0; b < sim->model->body_count; b++)
        if (sheet_of(sim, b) > 0)
            reach = pel_max(reach, pel_max(sim->touch->limits[b].most, set->largest));
    pel_status status = reach > 0 ? visit_near_pairs(sim, reach, limit_pair, NULL, error) : PEL_OK;
    for (int32_t i = 0; status == PEL_OK && reach > 0 && i < set->def.obstacle_count; i++)
        if (set->obstacles[i].presses && set->obstacles[i].mesh == NULL && pel_solid_is_round(&set->obstacles[i].solid))
            limit_before_round(sim, i, reach);
    take_limits(sim);
    return status;
}

void pel_contacts_transfer_limits(pel_cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    if (sim->contacts == NULL)
        return;
    pel_transfer(at, sim->touch->limits, (size_t)sim->model->body_count * sizeof *sim->touch->limits);
    if (at->load)
        take_limits((pel_sim *)(uintptr_t)sim);
}

static void note_gap(pel_sim *sim, const pel_collision *pair, double distance, void *context)
{
    const pel_contact_set *set = sim->contacts;
    pel_start_gap *gap = context;
    const int32_t first = set->group_of_point[pair->vertices[0]], second = set->group_of_point[pair->vertices[3]];
    double thickness = pel_contact_thickness(set, first, second);
    if (distance >= (1 - GAP_TOLERANCE) * thickness)
        return;
    if (gap->count == 0 || thickness - distance > gap->thickness - gap->gap)
        *gap = (pel_start_gap){gap->count, distance, thickness, {first, second}};
    gap->count++;
}

pel_status pel_contacts_find_start_gap(pel_sim *sim, pel_start_gap *gap, pel_error *error)
{
    *gap = (pel_start_gap){0};
    return sim->contacts != NULL ? visit_near_pairs(sim, sim->contacts->largest, note_gap, gap, error) : PEL_OK;
}

/* ---- questions ---- */

static void describe_limit(const pel_sim *sim, int32_t body, char *text, size_t size)
{
    int32_t reason = sim->touch->limits[body].reason;
    char other[PEL_NAME_SIZE + 16] = "its other parts";
    if (reason >= 0 && reason < sim->model->body_count + sim->tools->count && reason != body)
        pel_contacts_name_group(sim, reason, other, sizeof other);
    if (reason == PEL_LIMIT_EDGE || reason == PEL_LIMIT_HEIGHT)
        snprintf(text, size, "%s",
                 reason == PEL_LIMIT_EDGE ? "a quarter of its shortest edge"
                                          : "half of its least height of a triangle");
    else if (reason == PEL_LIMIT_FINEST)
        snprintf(text, size, "half of the mean edge of the finest body");
    else
        snprintf(text, size, "it starts so near to %s", other);
}

void pel_contacts_describe_thickness(const pel_sim *sim, int32_t body, char *text, size_t size)
{
    double thickness = pel_sim_body_contact_thickness(sim, body);
    int length = snprintf(text, size, "contact thickness %.3g m", thickness);
    double sheet = is_sheet(sim, body) ? sheet_of(sim, body) : 0;
    char limit[PEL_NAME_SIZE + 64];
    if (!(sheet > 0) || thickness > sheet || length < 0 || (size_t)length >= size)
        return;
    describe_limit(sim, body, limit, sizeof limit);
    if (thickness == sheet)
        snprintf(text + length, size - (size_t)length, " of its sheet");
    else
        snprintf(text + length, size - (size_t)length, " (%s; its sheet has %.3g m)", limit, sheet);
}

#include "tear/growth.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "math/extremes.h"
#include "math/vec3.h"
#include "mesh/figures.h"
#include "mesh/opening.h"
#include "mesh/path.h"
#include "tear/strength.h"

#include <math.h>
#include <string.h>

/* cosine and sine of the largest angle by which a tear turns at once: 70.5 degrees, that of the largest hoop stress
   ahead of a crack under shear (Erdogan and Sih 1963) */
#define MOST_TURN_COSINE (1.0 / 3)
#define MOST_TURN_SINE 0.9428090415820634
/* least ratio of the release of a tip after and before an advance */
#define LEAST_RATIO 0.5
/* sides that overlap by more than this share of their distance are closed */
#define LEAST_OPENING (-0.05)

static const pel_body_def *def_of(const pel_sim *sim, int32_t body)
{
    return &sim->given->def.bodies[body];
}

/* ---- tips ---- */

static void point_of(const pel_survey *s, int32_t v, double x[3])
{
    pel_vertex_position(s->sim->state->position, s->sim->model->bodies[s->body].model_index[v], x);
}

static void centre_of(const pel_survey *s, int32_t t, double centre[3])
{
    double x[3];
    pel_vec3_set(centre, 0, 0, 0);
    for (int c = 0; c < 3; c++) {
        point_of(s, s->topology->triangles[t][c], x);
        pel_vec3_along(centre, 1.0 / 3, x, centre);
    }
}

/* a cut that is pressed together releases energy too in theory, but does not grow */
static bool is_open(const pel_survey *s, int32_t tip)
{
    const pel_topology *topology = s->topology;
    int32_t from = topology->corner_of_vertex[tip], to = from;
    for (int32_t h = from; h >= 0; h = pel_survey_turn(s, tip, h))
        to = pel_half_edge_previous(h);
    double a[3], b[3], x[3], opening[3], across[3], along[3], centre[3];
    point_of(s, pel_half_edge_target(topology, from), a);
    point_of(s, pel_half_edge_origin(topology, to), b);
    point_of(s, tip, x);
    pel_vec3_subtract(a, b, opening);
    centre_of(s, from / 3, across);
    centre_of(s, to / 3, centre);
    pel_vec3_subtract(across, centre, across);
    for (int c = 0; c < 3; c++)
        along[c] = x[c] - 0.5 * (a[c] + b[c]);
    if (pel_vec3_normalize(along) > 0)
        pel_vec3_along(across, -pel_vec3_dot(across, along), along, across);
    return pel_vec3_dot(opening, across) >= LEAST_OPENING * pel_vec3_length(opening) * pel_vec3_length(across);
}

/* mean over the edge to come of what a tip releases, over what the material takes: in balance it falls along the edge
   as it did along the last one */
static double readiness(const pel_survey *s, const pel_tip *tip)
{
    double ratio = s->sim->tear_drop.ratio > 0 ? s->sim->tear_drop.ratio : 1;
    return 0.5 * (1 + ratio) * tip->release / pel_tear_resistance(s->sim, s->body, tip->vertex);
}

/* methods that do not solve for balance would see less, in the first step after the edge opened */
static void read_drop(const pel_survey *s, const pel_tip *tip)
{
    pel_tear_drop *drop = &s->sim->tear_drop;
    if (!s->sim->stepper->minimises || drop->body != s->body || drop->vertex != tip->vertex || !(drop->before > 0))
        return;
    drop->ratio = pel_max(LEAST_RATIO, pel_min(1, tip->release / drop->before));
    drop->vertex = -1;
}

/* methods that approach rest over many steps have no balance just after an edge opened or contact pushed: the force is
   then larger or smaller than it will be, and has another direction */
static bool is_relaxed(pel_survey *s, const pel_tip *tip)
{
    return pel_survey_change(s, tip) < PEL_TIP_RELAXED;
}

/* tips that grow, the readiest first; of too many the others wait */
static int32_t find_ready(pel_tear *tear, pel_survey *s)
{
    int32_t count = 0;
    for (int32_t i = 0; i < pel_survey_count_tips(s); i++) {
        pel_tip tip;
        double ahead[3];
        int32_t v = s->tips[i];
        if (!pel_survey_is_tip(s, v, ahead) || pel_survey_is_held(s, v))
            continue;
        pel_survey_read(s, v, ahead, &tip);
        read_drop(s, &tip);
        double own = readiness(s, &tip);
        if (!(own >= 1) || !is_open(s, v) || !is_relaxed(s, &tip))
            continue;
        int32_t place = count < tear->tip_room ? count++ : count;
        for (; place > 0 && readiness(s, &tear->tips[place - 1]) < own; place--)
            if (place < tear->tip_room)
                tear->tips[place] = tear->tips[place - 1];
        if (place < tear->tip_room)
            tear->tips[place] = tip;
    }
    return count;
}

/* unit normal of the surface at a vertex at rest, of a mesh with the triangles of the survey */
static void normal_at(const pel_survey *s, const pel_mesh *mesh, int32_t vertex, double normal[3])
{
    double part[3];
    pel_vec3_set(normal, 0, 0, 0);
    for (int32_t h = s->topology->corner_of_vertex[vertex]; h >= 0; h = pel_survey_turn(s, vertex, h)) {
        const int32_t *v = mesh->triangles[h / 3];
        pel_vec3_triangle_normal(mesh->positions[v[0]], mesh->positions[v[1]], mesh->positions[v[2]], part);
        pel_vec3_add(normal, part, normal);
    }
    pel_vec3_normalize(normal);
}

/* its part in the surface, of length 1 */
static void flatten(const double normal[3], const double x[3], double flat[3])
{
    pel_vec3_along(x, -pel_vec3_dot(x, normal), normal, flat);
    pel_vec3_normalize(flat);
}

/* the direction of the force in the surface, turned by no more than the limit from the one ahead */
static void find_direction(const pel_survey *s, const pel_tip *tip, double direction[3])
{
    double normal[3], along[3], aside[3];
    normal_at(s, s->sim->model->bodies[s->body].mesh, tip->vertex, normal);
    flatten(normal, tip->ahead, along);
    flatten(normal, tip->force, direction);
    double cosine = pel_vec3_dot(direction, along);
    pel_vec3_along(direction, -cosine, along, aside);
    if (cosine >= MOST_TURN_COSINE || !(pel_vec3_normalize(aside) > 0))
        return;
    pel_vec3_scale(along, MOST_TURN_COSINE, direction);
    pel_vec3_along(direction, MOST_TURN_SINE, aside, direction);
}

/* ---- the path ---- */

static void mark_list(uint8_t *marks, const int32_t *vertices, int32_t count)
{
    for (int32_t i = 0; vertices != NULL && i < count; i++)
        marks[vertices[i]] = 1;
}

/* a support across a flat body: its vertices may move within the plane that it keeps them in */
static bool holds_plane(const pel_support_def *support, const pel_mesh *mesh)
{
    const double slack = 1e-12 * pel_mesh_diagonal(mesh);
    for (int c = 0; c < 3; c++) {
        double first = pel_vec3_dot(support->axes[c], mesh->positions[0]);
        for (int32_t v = 1; support->fix[c] && v < mesh->vertex_count; v++)
            if (fabs(pel_vec3_dot(support->axes[c], mesh->positions[v]) - first) > slack)
                return false;
    }
    return !support->fix_rotation;
}

void pel_growth_mark_fixed(const pel_sim *sim, int32_t own, uint8_t *marks)
{
    const pel_sim_def *def = &sim->def;
    const pel_body_def *body = def_of(sim, own);
    int32_t count = body->mesh->vertex_count;
    for (int32_t v = 0; v < count; v++) {
        if (pel_vertex_is_held(sim, own, v))
            marks[v] = 1;
        if (body->origins != NULL && body->origins[v] != v)
            marks[v] = marks[body->origins[v]] = 1;
    }
    for (int32_t l = 0; l < def->load_count; l++)
        if (def->loads[l].body == own && def->loads[l].vertex_count < count)
            mark_list(marks, def->loads[l].vertices, def->loads[l].vertex_count);
    for (int32_t i = 0; i < def->support_count; i++)
        if (def->supports[i].body == own && def->supports[i].vertex_count < count &&
            !holds_plane(&def->supports[i], body->mesh))
            mark_list(marks, def->supports[i].vertices, def->supports[i].vertex_count);
    for (int32_t c = sim->cuts_done; c < def->cut_count; c++)
        if (def->cuts[c].body == own)
            mark_list(marks, def->cuts[c].vertices, def->cuts[c].vertex_count);
    for (int32_t i = 0; i < def->seam_count; i++)
        if (def->seams[i].body == own)
            mark_list(marks, def->seams[i].path, def->seams[i].path_count);
}

static pel_status begin_growth(const pel_survey *s, pel_growth *growth, uint8_t **fixed, pel_error *error)
{
    const pel_mesh *mesh = s->sim->model->bodies[s->body].mesh;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(growth->marks, s->topology->edge_count),
                          PEL_ROOM(growth->is_moved, mesh->vertex_count), PEL_ROOM(*fixed, mesh->vertex_count)))
        return pel_fail_memory(error);
    pel_growth_mark_fixed(s->sim, s->body, *fixed);
    return pel_mesh_create(mesh->positions[0], mesh->vertex_count, mesh->triangles[0], mesh->triangle_count,
                           &growth->mesh, error);
}

/* one edge further; none where no edge leads that way */
static pel_status advance(const pel_survey *s, const pel_tip *tip, uint8_t *fixed, pel_growth *growth, pel_error *error)
{
    double direction[3];
    int32_t next;
    find_direction(s, tip, direction);
    pel_status status = pel_path_step(growth->mesh, s->topology, tip->vertex, direction, fixed, &next, error);
    if (status != PEL_OK || next < 0)
        return status;
    int32_t e = pel_topology_edge_between(s->topology, tip->vertex, next);
    if (growth->marks[e])
        return PEL_OK;
    if (growth->edge_count == 0)
        s->sim->tear_drop = (pel_tear_drop){s->body, next, tip->release, s->sim->tear_drop.ratio};
    growth->marks[e] = 1;
    growth->edge_count++;
    return PEL_OK;
}

/* one arm of a slit, straight over the surface, to its length, a border or a vertex that is held */
static pel_status open_arm(const pel_survey *s, const pel_start *start, double sign, uint8_t *fixed, pel_growth *growth,
                           pel_error *error)
{
    pel_status status = PEL_OK;
    double direction[3], normal[3], gone = 0, edge = 0;
    pel_vec3_scale(start->direction, sign, direction);
    for (int32_t v = start->vertex, next; gone == 0 || gone + 0.5 * edge < start->length; v = next) {
        normal_at(s, growth->mesh, v, normal);
        flatten(normal, direction, direction);
        status = pel_path_step(growth->mesh, s->topology, v, direction, fixed, &next, error);
        int32_t e = status == PEL_OK && next >= 0 ? pel_topology_edge_between(s->topology, v, next) : -1;
        if (e < 0 || growth->marks[e])
            break;
        growth->marks[e] = 1;
        growth->edge_count++;
        edge = pel_vec3_distance(growth->mesh->positions[v], growth->mesh->positions[next]);
        gone += edge;
        if (s->topology->twin[s->topology->corner_of_vertex[next]] < 0 || pel_survey_is_held(s, next))
            break;
    }
    return status;
}

static pel_status open_slit(const pel_survey *s, const pel_start *start, uint8_t *fixed, pel_growth *growth,
                            pel_error *error)
{
    fixed[start->vertex] = 1;
    pel_status status = open_arm(s, start, 1, fixed, growth, error);
    return status == PEL_OK && start->arm_count > 1 ? open_arm(s, start, -1, fixed, growth, error) : status;
}

static void sum_energy(const pel_survey *s, pel_growth *growth)
{
    growth->energy = 0;
    for (int32_t e = 0; e < s->topology->edge_count; e++) {
        int32_t h = s->topology->half_edge_of_edge[e], a = pel_half_edge_origin(s->topology, h),
                b = pel_half_edge_target(s->topology, h);
        if (growth->marks[e])
            growth->energy += 0.5 *
                              (pel_tear_resistance(s->sim, s->body, a) + pel_tear_resistance(s->sim, s->body, b)) *
                              pel_vec3_distance(growth->mesh->positions[a], growth->mesh->positions[b]);
    }
}

pel_status pel_growth_find(pel_tear *tear, int32_t survey, pel_growth *growth, pel_error *error)
{
    pel_survey *s = &tear->surveys[survey];
    const pel_mesh *mesh = s->sim->model->bodies[s->body].mesh;
    uint8_t *fixed = NULL;
    *growth = (pel_growth){0};
    pel_shell_forces_follow(s->sim->shells, s->sim->state->position);
    pel_start start;
    int32_t count = find_ready(tear, s);
    /* a tear that grows relieves the rest */
    bool starts = count == 0 && pel_start_find(s, tear->tip_room, &start);
    if (count == 0 && !starts)
        return PEL_OK;
    pel_status status = begin_growth(s, growth, &fixed, error);
    for (int32_t i = 0; status == PEL_OK && i < count; i++)
        status = advance(s, &tear->tips[i], fixed, growth, error);
    if (status == PEL_OK && starts)
        status = open_slit(s, &start, fixed, growth, error);
    for (int32_t v = 0; status == PEL_OK && v < mesh->vertex_count; v++)
        growth->is_moved[v] = memcmp(mesh->positions[v], growth->mesh->positions[v], sizeof *mesh->positions) != 0;
    if (status == PEL_OK)
        sum_energy(s, growth);
    pel_free(fixed);
    return status;
}

void pel_growth_shorten(const pel_tear *tear, int32_t survey, pel_growth *growth, double share)
{
    const pel_survey *s = &tear->surveys[survey];
    const pel_mesh *mesh = s->sim->model->bodies[s->body].mesh;
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        double *x = growth->mesh->positions[v];
        for (int c = 0; c < 3; c++)
            x[c] = mesh->positions[v][c] + share * (x[c] - mesh->positions[v][c]);
    }
    sum_energy(s, growth);
}

void pel_growth_clear(pel_growth *growth)
{
    pel_mesh_destroy(growth->mesh);
    PEL_FREE_ALL(growth->marks, growth->is_moved);
    *growth = (pel_growth){0};
}

/* ---- creation ---- */

/* whether tools that lead a tear have a body that tears */
static pel_status check_leads(const pel_sim *sim, pel_error *error)
{
    for (int32_t t = 0; t < sim->def.tool_count; t++) {
        const pel_tool_def *def = &sim->def.tools[t];
        bool can_tear = !def->leads;
        for (int32_t b = 0; b < sim->given->body_count; b++)
            can_tear |= pel_body_can_tear(sim, b) && (def->body < 0 || def->body == b);
        if (!can_tear)
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", t, "give the body a toughness",
                                      "tool '%s' leads a tear, but no body that it acts on can tear", def->name);
    }
    return PEL_OK;
}

static pel_status begin_body(pel_sim *sim, int32_t body, pel_error *error)
{
    pel_tear *tear = sim->tear;
    pel_status status = PEL_OK;
    if (pel_body_can_tear(sim, body)) {
        pel_survey *survey = &tear->surveys[tear->survey_count++];
        status = pel_survey_begin(survey, sim, body, error);
        survey->has_notches = pel_tear_may_start(sim, body);
    }
    if (status == PEL_OK && pel_body_adheres(sim, body))
        status = pel_adhesion_begin(&tear->adhesions[tear->adhesion_count++], sim, body, error);
    if (status == PEL_OK && pel_body_has_seam(sim, body))
        status = pel_seams_begin(&tear->seams[tear->seam_count++], sim, body, error);
    return status;
}

/* whether a body has a strength, if tears shall start anywhere */
static pel_status check_start(const pel_sim *sim, pel_error *error)
{
    bool has_strength = sim->def.tear.start != PEL_TEAR_ANYWHERE;
    for (int32_t b = 0; b < sim->given->body_count; b++)
        has_strength |= pel_body_has_strength(sim, b);
    return has_strength ? PEL_OK
                        : pel_refuse(error, PEL_BAD_ARGUMENT, "give a body `strength` beside its toughness",
                                     "tears start anywhere, but no body has a strength");
}

pel_status pel_tear_create(pel_sim *sim, pel_error *error)
{
    int32_t body_count = sim->given->body_count, most = sim->def.tear.max_tips;
    bool any = false;
    pel_status status = check_leads(sim, error);
    if (status == PEL_OK)
        status = check_start(sim, error);
    for (int32_t b = 0; b < body_count; b++)
        any |= pel_body_can_tear(sim, b) || pel_body_adheres(sim, b) || pel_body_has_seam(sim, b);
    if (status != PEL_OK || !any)
        return status;
    if (sim->def.tie_count > 0)
        return pel_refuse(error, PEL_BAD_ARGUMENT,
                          "give stitches a strength, which opens them, or leave toughness, seams and adhesion out",
                          "attachments and stitches beside tears");
    sim->tear = pel_allocate(1, sizeof *sim->tear);
    if (sim->tear == NULL)
        return pel_fail_memory(error);
    sim->tear->tip_room = most;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(sim->tear->surveys, body_count), PEL_ROOM(sim->tear->adhesions, body_count),
                          PEL_ROOM(sim->tear->seams, body_count), PEL_ROOM(sim->tear->tips, most)))
        return pel_fail_memory(error);
    for (int32_t b = 0; status == PEL_OK && b < body_count; b++)
        status = begin_body(sim, b, error);
    return status;
}

void pel_tear_destroy(pel_sim *sim)
{
    if (sim->tear == NULL)
        return;
    for (int32_t i = 0; i < sim->tear->survey_count; i++)
        pel_survey_end(&sim->tear->surveys[i]);
    for (int32_t i = 0; i < sim->tear->adhesion_count; i++)
        pel_adhesion_end(&sim->tear->adhesions[i]);
    for (int32_t i = 0; i < sim->tear->seam_count; i++)
        pel_seams_end(&sim->tear->seams[i]);
    PEL_FREE_ALL(sim->tear->surveys, sim->tear->adhesions, sim->tear->seams, sim->tear->tips);
    pel_free(sim->tear);
}

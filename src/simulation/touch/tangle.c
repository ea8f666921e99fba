/* Starts that contact refuses: pairs of triangles that intersect, tools in bodies. */
#include "touch/tangle.h"

#include "base/memory.h"
#include "base/status.h"
#include "bvh/intersect.h"
#include "tool/start.h"
#include "touch/contact.h"

#include <stdio.h>
#include <string.h>

enum { NAMED_PAIRS = 3, NAME_ROOM = PEL_NAME_SIZE + 32 };

void pel_contacts_name_group(const pel_sim *sim, int32_t group, char *text, size_t size)
{
    bool is_body = group < sim->model->body_count;
    snprintf(text, size, "%s '%s'", is_body ? "body" : "tool",
             is_body ? sim->model->bodies[group].name : sim->tools->items[group - sim->model->body_count].name);
}

static void describe(const pel_sim *sim, int32_t triangle, char *text, size_t size)
{
    const pel_contact_set *set = sim->contacts;
    int32_t group = set->group_of_point[set->triangles[triangle][0]], first = triangle;
    while (first > 0 && set->group_of_point[set->triangles[first - 1][0]] == group)
        first--;
    pel_contacts_name_group(sim, group, text, size);
    size_t length = strlen(text);
    snprintf(text + length, size - length, " %d", (int)(triangle - first));
}

/* the first pairs of those that intersect */
static void list_pairs(const pel_sim *sim, char *list, size_t size)
{
    const pel_tangles *tangles = &sim->contacts->tangles;
    char first[NAME_ROOM], second[NAME_ROOM];
    for (int64_t i = 0; i < tangles->count && i < NAMED_PAIRS; i++) {
        size_t length = strlen(list);
        describe(sim, tangles->pairs[i].first, first, sizeof first);
        describe(sim, tangles->pairs[i].second, second, sizeof second);
        snprintf(list + length, size - length, "%s%s and %s", i > 0 ? "; " : "", first, second);
    }
    size_t length = strlen(list);
    snprintf(list + length, size - length, "%s", tangles->count > NAMED_PAIRS ? "; ..." : "");
}

static pel_status refuse_pairs(const pel_sim *sim, pel_error *error)
{
    char list[400] = "";
    list_pairs(sim, list, sizeof list);
    return pel_refuse(error, PEL_BAD_ARGUMENT, "pull them apart, or accept them with contact: { start: tangled }",
                      "%lld pairs of triangles intersect at the start: %s", (long long)sim->contacts->tangles.count,
                      list);
}

/* a tool that is a surface must not cut a body, nor be inside a closed one */
static pel_status refuse_tools(const pel_sim *sim, pel_error *error)
{
    const pel_contact_set *set = sim->contacts;
    int32_t body_count = sim->model->body_count;
    for (int64_t i = 0; i < set->tangles.count; i++) {
        const pel_pair *pair = &set->tangles.pairs[i];
        int32_t first = set->group_of_point[set->triangles[pair->first][0]];
        int32_t second = set->group_of_point[set->triangles[pair->second][0]];
        int32_t tool = (first > second ? first : second) - body_count;
        if (tool >= 0)
            return pel_tool_refuse_inside(sim, tool, first < second ? first : second, error);
    }
    for (int32_t i = 0; i < sim->tools->count; i++)
        for (int32_t b = 0; b < body_count; b++)
            if (sim->tools->items[i].mesh != NULL && sim->tools->items[i].press &&
                pel_tool_acts_on(&sim->tools->items[i], b) &&
                pel_tool_starts_within(sim, set->start[set->obstacles[i].point_begin], b))
                return pel_tool_refuse_inside(sim, i, b, error);
    return PEL_OK;
}

/* Balls whose spheres overlap other surfaces; meshes that touch may lie this share of a radius deeper. */
#define BALL_SHARE 0.02

static pel_status refuse_balls(const pel_sim *sim, pel_error *error)
{
    pel_collision pair = {.first = 0};
    double depth;
    pel_status status = pel_contact_balls_find_deepest(sim->contacts, &pair, &depth, error);
    if (status != PEL_OK || !(depth > BALL_SHARE * pel_rigid_radius(sim->rigids, pair.vertices[0])))
        return status;
    char first[NAME_ROOM], second[NAME_ROOM];
    pel_contacts_name_group(sim, sim->contacts->group_of_point[pair.vertices[0]], first, sizeof first);
    pel_contacts_name_group(sim, sim->contacts->group_of_point[pair.vertices[3]], second, sizeof second);
    return pel_refuse(error, PEL_BAD_ARGUMENT, "pull them apart, or accept it with contact: { start: tangled }",
                      "the sphere of %s overlaps %s by %.2g m at the start", first, second, depth);
}

pel_status pel_contacts_refuse_tangles(const pel_sim *sim, pel_error *error)
{
    pel_status status = refuse_tools(sim, error);
    if (status == PEL_OK && sim->contacts->tangles.count > 0 && !sim->touch->def.allow_tangled)
        status = refuse_pairs(sim, error);
    if (status == PEL_OK && !sim->touch->def.allow_tangled)
        status = refuse_balls(sim, error);
    return status;
}

static bool are_tied(const pel_sim_def *def, int32_t a, int32_t b)
{
    for (int32_t i = 0; i < def->tie_count; i++) {
        const pel_tie_def *tie = &def->ties[i];
        bool is_pair = tie->target == PEL_TIE_BODY || tie->target == PEL_TIE_VERTICES;
        if (is_pair && ((tie->body == a && tie->to_body == b) || (tie->body == b && tie->to_body == a)))
            return true;
    }
    return false;
}

pel_status pel_contacts_refuse_buried(const pel_sim *sim, const pel_sim_def *def, pel_error *error)
{
    const pel_model *model = sim->model;
    const pel_contact_set *set = sim->contacts;
    for (int32_t b = 0; set != NULL && !sim->touch->def.allow_tangled && b < model->body_count; b++)
        for (int32_t solid = 0; solid < model->body_count; solid++) {
            double point[3];
            bool may_meet = set->may_meet[b * (set->def.body_count + set->def.obstacle_count) + solid];
            if (solid == b || model->bodies[solid].shell == NULL || !may_meet || pel_surface_count(model, b) == 0 ||
                model->bodies[solid].shell->tetrahedron_count == 0 || are_tied(def, b, solid))
                continue;
            pel_vertex_position(sim->state->position, model->triangles[pel_surface_triangle(model, b, 0)][0], point);
            if (pel_tool_starts_within(sim, point, solid))
                return pel_refuse(error, PEL_BAD_ARGUMENT,
                                  "tie vertices inside of the latter to the former with `attachments`, give the latter "
                                  "a stiffer region instead (volume: { young: { base, regions } }), or a mesh with a "
                                  "cavity",
                                  "body '%s' starts inside body '%s', whose tetrahedra do not feel it: it would move "
                                  "through them",
                                  model->bodies[b].name, model->bodies[solid].name);
        }
    return PEL_OK;
}

/* those of the surface before the cut need no search where they are known */
static pel_status count_before(pel_sim *sim, int64_t *count, pel_error *error)
{
    *count = sim->contacts != NULL ? sim->contacts->tangles.count : 0;
    if (sim->contacts == NULL || sim->contacts->tangles.is_known)
        return PEL_OK;
    return pel_sim_intersections(sim, count, error);
}

/* whether nothing intersected before a cut, so that only what it changed can intersect */
static bool was_clear(const pel_sim *before, const pel_sim *sim)
{
    const pel_contact_set *set = before->contacts;
    if (set == NULL || !set->tangles.is_known || set->tangles.count > 0 ||
        set->triangle_count != sim->contacts->triangle_count || !pel_contacts_are_of_present(before))
        return false;
    for (int32_t t = 0; t < sim->tools->count; t++)
        if (memcmp(&before->tools->items[t].pose, &sim->tools->items[t].pose, sizeof before->tools->items[t].pose) != 0)
            return false;
    return true;
}

/* triangles of bodies with a corner that is another vertex than before, or elsewhere */
static void mark_changed(const pel_sim *before, const pel_sim *sim, uint8_t *changed)
{
    const pel_contact_set *old = before->contacts, *set = sim->contacts;
    for (int32_t i = 3 * set->obstacle_triangle_count; i < 3 * set->triangle_count; i++) {
        int32_t was = old->triangles[i / 3][i % 3], is = set->triangles[i / 3][i % 3];
        double x[3];
        pel_vertex_position(before->state->position, was, x);
        changed[i / 3] |=
            before->model->mesh_vertex[was] != sim->model->mesh_vertex[is] || memcmp(x, set->start[is], sizeof x) != 0;
    }
}

/* a cut changes few triangles: they are looked at alone, and the whole surface only if they may be in the way */
static pel_status find_tangles(const pel_sim *before, pel_sim *sim, pel_error *error)
{
    pel_contact_set *set = sim->contacts;
    if (!was_clear(before, sim))
        return pel_tangles_find(set, error);
    uint8_t *changed = pel_allocate((size_t)set->triangle_count, 1);
    if (changed == NULL)
        return pel_fail_memory(error);
    bool found;
    const pel_mesh mesh = pel_contact_mesh(set);
    mark_changed(before, sim, changed);
    pel_status status = pel_mesh_changed_intersect(&mesh, changed, &found);
    pel_free(changed);
    if (status != PEL_OK)
        return pel_fail_memory(error);
    if (found)
        return pel_tangles_find(set, error);
    set->statistics.tangled = set->tangles.count = 0;
    set->tangles.is_known = true;
    return PEL_OK;
}

pel_status pel_contacts_check_lips(pel_sim *before, pel_sim *sim, pel_error *error)
{
    int64_t count;
    char list[400] = "";
    sim->touch->revisions[0] = -1;
    pel_contacts_place_start(sim);
    pel_status status = pel_contacts_update_surface(sim, error);
    if (status == PEL_OK)
        status = find_tangles(before, sim, error);
    if (status != PEL_OK || sim->contacts->tangles.count == 0)
        return status;
    status = count_before(before, &count, error);
    if (status != PEL_OK || sim->contacts->tangles.count <= count)
        return status;
    before->cut_is_held = true;
    list_pairs(sim, list, sizeof list);
    return pel_refuse(error, PEL_BAD_ARGUMENT, "unfold the surface there first, or cut elsewhere",
                      "the cut is held back, because its lips would intersect: %s", list);
}

pel_status pel_sim_intersections(pel_sim *sim, int64_t *count, pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    PEL_REFUSE_NULL(count, error);
    *count = 0;
    if (sim->contacts == NULL)
        return pel_fail(error, PEL_BAD_ARGUMENT, "contact is not enabled");
    pel_tangles tangles = {0};
    pel_contacts_place_start(sim);
    pel_status status = pel_contacts_update_surface(sim, error);
    if (status == PEL_OK)
        status = pel_tangles_list(sim->contacts, &tangles, error);
    *count = tangles.count;
    pel_free(tangles.pairs);
    return status;
}

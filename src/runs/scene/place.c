#include "scene/place.h"

#include "base/number.h"
#include "bvh/ray.h"
#include "geom/solid.h"
#include "keys/validate.h"
#include "math/extremes.h"
#include "math/pose.h"
#include "math/vec3.h"
#include "mesh/figures.h"
#include "pellicle/topology.h"
#include "touch/thickness.h"

#include <math.h>
#include <string.h>

enum { MOST_NAMES = 64 };

/* vertices within this share of the diagonal below the highest one are the top */
static const double TOP_SHARE = 1e-3;

/* times the contact thickness, with rounding: nearer surfaces are pushed apart at the start */
static const double CLEARANCE = 1.001;

/* the bodies that a place is about */
typedef struct choice {
    const pel_mesh *meshes[MOST_NAMES];
    int32_t count;
} choice;

static pel_status choose_bodies(pel_scene_reader *reader, const pel_scene_value *name, const pel_model_def *model,
                                choice *chosen)
{
    const char *names[MOST_NAMES];
    const int32_t count = model->body_count < MOST_NAMES ? model->body_count : MOST_NAMES;
    chosen->count = 0;
    for (int32_t b = 0; b < count; b++) {
        names[b] = model->bodies[b].name;
        if (name == NULL || strcmp(name->text, names[b]) == 0)
            chosen->meshes[chosen->count++] = model->bodies[b].mesh;
    }
    if (chosen->count > 0)
        return PEL_OK;
    return pel_scene_fail_name(reader, &name->place, "body", name->text, names, (size_t)count);
}

static void find_box(const choice *bodies, double low[3], double high[3])
{
    for (int i = 0; i < 3; i++) {
        low[i] = (double)HUGE_VAL;
        high[i] = -(double)HUGE_VAL;
    }
    for (int32_t b = 0; b < bodies->count; b++)
        pel_mesh_add_box(bodies->meshes[b], low, high);
}

static double diagonal_of(const pel_model_def *model)
{
    choice all = {.count = 0};
    double low[3], high[3];
    for (int32_t b = 0; b < model->body_count && b < MOST_NAMES; b++)
        all.meshes[all.count++] = model->bodies[b].mesh;
    find_box(&all, low, high);
    return pel_vec3_distance(low, high);
}

pel_status pel_scene_vertex(pel_scene_reader *reader, const pel_scene_value *value, const pel_mesh *mesh,
                            int32_t *vertex)
{
    if (mesh->tetrahedron_count > 0) {
        pel_scene_fail(reader, &value->place, "vertex %.0f of a body with `volume`, whose surface has other vertices",
                       value->number);
        pel_fail_remedy(reader->error, "select by place: nearest, a sphere, a box or a ray");
        return PEL_BAD_SCENE;
    }
    const pel_scene_welding *welding = reader->weldings;
    while (welding != NULL && welding->mesh != mesh)
        welding = welding->next;
    const int32_t count = welding != NULL ? welding->file_count : mesh->vertex_count;
    if (value->number >= count) {
        pel_scene_fail(reader, &value->place, "the mesh has no vertex %.0f", value->number);
        pel_fail_remedy(reader->error, "give numbers from 0 to %d", (int)count - 1);
        return PEL_BAD_SCENE;
    }
    const int32_t number = (int32_t)value->number;
    *vertex = welding != NULL ? welding->index_of[number] : number;
    return PEL_OK;
}

/* ---- points of bodies ---- */

pel_status pel_scene_cast(pel_scene_reader *reader, const pel_scene_value *value, const pel_mesh *const *meshes,
                          int32_t mesh_count, double point[3], double normal[3])
{
    pel_ray ray;
    double nearest = (double)HUGE_VAL, across[3] = {0};
    pel_scene_value_numbers(pel_scene_value_entry(value, "origin"), ray.origin);
    pel_scene_value_numbers(pel_scene_value_entry(value, "direction"), ray.direction);
    if (!(pel_vec3_normalize(ray.direction) > 0)) {
        pel_scene_fail(reader, &pel_scene_value_entry(value, "direction")->place, "the direction has no length");
        pel_fail_remedy(reader->error, "give a vector that is not 0");
        return PEL_BAD_SCENE;
    }
    for (int32_t b = 0; b < mesh_count; b++)
        for (int32_t t = 0; t < meshes[b]->triangle_count; t++) {
            const int32_t *v = meshes[b]->triangles[t];
            const double *p = meshes[b]->positions[v[0]], *q = meshes[b]->positions[v[1]],
                         *r = meshes[b]->positions[v[2]];
            pel_ray_hit hit;
            if (!pel_ray_triangle(&ray, p, q, r, &hit) || hit.distance >= nearest)
                continue;
            nearest = hit.distance;
            pel_vec3_triangle_normal(p, q, r, across);
        }
    if (!isfinite(nearest)) {
        double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
        for (int32_t b = 0; b < mesh_count; b++)
            pel_mesh_add_box(meshes[b], low, high);
        pel_scene_fail(reader, &value->place, "the ray meets no body");
        pel_fail_remedy(reader->error, "aim it at the bodies, which lie between (%g, %g, %g) and (%g, %g, %g)", low[0],
                        low[1], low[2], high[0], high[1], high[2]);
        return PEL_BAD_SCENE;
    }
    pel_vec3_along(ray.origin, nearest, ray.direction, point);
    if (normal != NULL) {
        pel_vec3_scale(across, pel_vec3_dot(across, ray.direction) > 0 ? -1 : 1, normal);
        pel_vec3_normalize(normal);
    }
    return PEL_OK;
}

/* the middle of a level top, at the height of its highest vertex; with the sign -1 of the bottom, at its lowest */
static void find_end(const choice *bodies, int32_t up, int sign, double point[3])
{
    double low[3], high[3], middle[3] = {0}, best = (double)HUGE_VAL;
    int32_t count = 0;
    find_box(bodies, low, high);
    const double top = sign > 0 ? high[up] : low[up], depth = TOP_SHARE * pel_vec3_distance(low, high);
    for (int pass = 0; pass < 2; pass++) {
        if (pass == 1)
            pel_vec3_scale(middle, 1.0 / count, middle);
        for (int32_t b = 0; b < bodies->count; b++)
            for (int32_t v = 0; v < bodies->meshes[b]->vertex_count; v++) {
                const double *p = bodies->meshes[b]->positions[v];
                if (fabs(p[up] - top) > depth)
                    continue;
                if (pass == 0) {
                    pel_vec3_add(middle, p, middle);
                    count++;
                } else if (pel_vec3_distance(p, middle) < best) {
                    best = pel_vec3_distance(p, middle);
                    pel_vec3_copy(p, point);
                }
            }
    }
    point[up] = top;
}

/* a vertex of the only body, and the direction out of the surface there */
static pel_status find_vertex(pel_scene_reader *reader, const pel_scene_value *value, const pel_model_def *model,
                              const choice *bodies, double point[3], double normal[3])
{
    int32_t vertex;
    if (bodies->count > 1) {
        pel_scene_fail(reader, &value->place, "the place does not say of which body the vertex is");
        pel_fail_remedy(reader->error, "add `body: %s` or another name", model->bodies[0].name);
        return PEL_BAD_SCENE;
    }
    const pel_mesh *mesh = bodies->meshes[0];
    const pel_status status = pel_scene_vertex(reader, value, mesh, &vertex);
    if (status != PEL_OK)
        return status;
    pel_vec3_copy(mesh->positions[vertex], point);
    pel_vec3_set(normal, 0, 0, 0);
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        const int32_t *v = mesh->triangles[t];
        double across[3];
        if (v[0] != vertex && v[1] != vertex && v[2] != vertex)
            continue;
        pel_vec3_triangle_normal(mesh->positions[v[0]], mesh->positions[v[1]], mesh->positions[v[2]], across);
        pel_vec3_add(normal, across, normal);
    }
    if (pel_vec3_normalize(normal) > 0)
        return PEL_OK;
    pel_scene_fail(reader, &value->place, "the surface has no direction at this vertex");
    pel_fail_remedy(reader->error, "name a vertex of a triangle, or use `above: highest` or a ray");
    return PEL_BAD_SCENE;
}

/* ---- tools ---- */

/* distance from the center of a tool to its farthest point along a direction of its own frame */
static double reach_of(const pel_tool_def *tool, const double direction[3])
{
    double farthest = -(double)HUGE_VAL;
    if (tool->mesh != NULL) {
        for (int32_t v = 0; v < tool->mesh->vertex_count; v++)
            farthest = pel_max(farthest, pel_vec3_dot(direction, tool->mesh->positions[v]));
        return farthest;
    }
    const pel_solid solid = pel_solid_of(tool);
    if (pel_solid_is_round(&solid))
        return solid.radius + solid.half_length * fabs(direction[2]);
    for (int32_t i = 0; i < pel_solid_rows[solid.shape].corner_count; i++) {
        double corner[3];
        pel_solid_corner(&solid, i, corner);
        farthest = pel_max(farthest, pel_vec3_dot(direction, corner));
    }
    return farthest;
}

/* `by`: metres, or relative to the bodies */
static pel_status read_gap(pel_scene_reader *reader, const pel_scene_value *value, const pel_model_def *model,
                           double *gap)
{
    static const char word[] = "relative ";
    *gap = value->number;
    if (value->form != PEL_FORM_TEXT)
        return PEL_OK;
    const char *number = value->text + strlen(word), *end = value->text + strlen(value->text);
    double share;
    if (strncmp(value->text, word, strlen(word)) == 0 && pel_number_parse(number, end, &share) == end &&
        isfinite(share)) {
        *gap = share * diagonal_of(model);
        return PEL_OK;
    }
    pel_scene_fail(reader, &value->place, "`by` '%.80s' is not a distance", value->text);
    pel_fail_remedy(reader->error, "give a number of metres, or `relative` and a number, such as relative 0.05");
    return PEL_BAD_SCENE;
}

pel_status pel_scene_size_tool(pel_scene_reader *reader, pel_scene_value *tool, const pel_model_def *model)
{
    pel_scene_value *radius = pel_scene_value_entry(tool, "radius"), *length = pel_scene_value_entry(tool, "length"),
                    *size = pel_scene_value_entry(tool, "size");
    const double diagonal = diagonal_of(model);
    const double side[3] = {0.12 * diagonal, 0.12 * diagonal, 0.12 * diagonal};
    pel_status status = PEL_OK;
    if (radius != NULL && radius->form == PEL_FORM_WORD)
        status = pel_scene_value_set_number(reader, radius, (length != NULL ? 0.03 : 0.06) * diagonal);
    if (status == PEL_OK && length != NULL && length->form == PEL_FORM_WORD)
        status = pel_scene_value_set_number(reader, length, 0.2 * diagonal);
    if (status == PEL_OK && size != NULL && size->form == PEL_FORM_WORD)
        status = pel_scene_value_set_vector(reader, size, side);
    return status;
}

static bool is_closed(const pel_mesh *mesh)
{
    pel_topology *topology;
    if (pel_topology_create(mesh, &topology, NULL) != PEL_OK)
        return true;
    const bool closed = topology->boundary_edge_count == 0;
    pel_topology_destroy(topology);
    return closed;
}

/* m, of its own or of its sheet; 0 = that of all */
static double thickness_of(const pel_contact_def *contact, const pel_body_def *body)
{
    if (body->contact_thickness > 0 || contact->thickness > 0)
        return body->contact_thickness;
    if (contact->shell_thickness)
        return body->shell.membrane.thickness.value;
    const bool is_sheet = contact->enabled && !(contact->relative_thickness > 0) && !is_closed(body->mesh);
    const double most = pel_mesh_thickness_limit(body->mesh, body->refine.levels).most;
    return is_sheet ? pel_min(pel_membrane_thickness(body), most) : 0;
}

/* m, at which contact leaves a tool and the bodies alone */
static double clearance_of(const pel_scene *scene, const pel_tool_def *tool)
{
    const pel_contact_def *contact = &scene->sim.contact;
    const double relative = pel_contact_relative_thickness(contact) * diagonal_of(&scene->model);
    const double common = contact->thickness > 0 ? contact->thickness : relative;
    double thickest = common;
    for (int32_t b = 0; b < scene->model.body_count; b++)
        thickest = pel_max(thickest, thickness_of(contact, &scene->model.bodies[b]));
    return CLEARANCE * 0.5 * (thickest + (tool->thickness > 0 ? tool->thickness : common));
}

pel_status pel_scene_place_tool(pel_scene_reader *reader, pel_scene_value *position, const pel_scene *scene,
                                const pel_tool_def *tool, const double rotation[3])
{
    const pel_model_def *model = &scene->model;
    const int32_t up = scene->up;
    const pel_scene_value *above = pel_scene_value_entry(position, "above");
    const pel_scene_value *vertex = above != NULL ? pel_scene_value_entry(above, "vertex") : NULL,
                          *ray = above != NULL ? pel_scene_value_entry(above, "ray") : NULL;
    const int sign = above != NULL ? 1 : -1;
    double point[3], out[3] = {sign * (up == 0), sign * (up == 1), sign * (up == 2)}, inward[3], gap;
    choice bodies;
    pel_status status = choose_bodies(reader, pel_scene_value_entry(position, "body"), model, &bodies);
    if (status == PEL_OK)
        status = read_gap(reader, pel_scene_value_entry(position, "by"), model, &gap);
    if (status == PEL_OK && vertex != NULL)
        status = find_vertex(reader, vertex, model, &bodies, point, out);
    else if (status == PEL_OK && ray != NULL)
        status = pel_scene_cast(reader, ray, bodies.meshes, bodies.count, point, out);
    else if (status == PEL_OK)
        find_end(&bodies, up, sign, point);
    if (status != PEL_OK)
        return status;
    if (scene->sim.contact.enabled && gap >= 0)
        gap = pel_max(gap, clearance_of(scene, tool));
    /* the tool's side that faces the body, in its own frame */
    static const double upright[4] = {0, 0, 0, 1};
    double turn[4];
    pel_rotation_turn(upright, rotation, 1, turn);
    pel_vec3_scale(out, -1, inward);
    pel_rotate_back(turn, inward, inward);
    pel_vec3_along(point, gap + reach_of(tool, inward), out, point);
    return pel_scene_value_set_vector(reader, position, point);
}

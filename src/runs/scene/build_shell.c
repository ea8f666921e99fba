/* Fibres and pressure of a body, with their regions. */
#include "scene/build.h"

#include "base/status.h"
#include "keys/table.h"
#include "math/vec3.h"
#include "scene/mesh.h"
#include "scene/region.h"

#include <math.h>
#include <string.h>

/* ---- regions ---- */

/* weights on all vertices; null for the whole body */
static pel_status read_weights(const pel_scene_part *source, const pel_scene_value *value, const double **weights)
{
    pel_scene_region region;
    pel_status status = pel_scene_region_find(source->reader, value, source->mesh, &region);
    if (status != PEL_OK || region.vertices == NULL)
        return status;
    double *all = pel_arena_take(source->reader->arena, (size_t)source->mesh->vertex_count, sizeof *all);
    if (all == NULL)
        return pel_fail_memory(source->reader->error);
    for (int32_t i = 0; i < region.count; i++)
        all[region.vertices[i]] = region.weights != NULL ? region.weights[i] : 1;
    *weights = all;
    return PEL_OK;
}

/* the centre of a sphere, the middle of a box, otherwise the mean of the vertices */
static void find_center(const pel_scene_value *region, const pel_mesh *mesh, const double *weights, double center[3])
{
    const pel_scene_value *sphere = pel_scene_value_entry(region, "sphere");
    double sum = 0;
    memset(center, 0, 3 * sizeof *center);
    if (sphere != NULL) {
        pel_scene_value_numbers(pel_scene_value_entry(sphere, "center"), center);
        return;
    }
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        double weight = weights != NULL ? weights[v] : 1;
        sum += weight;
        for (int c = 0; c < 3; c++)
            center[c] += weight * mesh->positions[v][c];
    }
    for (int c = 0; c < 3; c++)
        center[c] /= sum;
}

static void read_direction(const pel_scene_value *value, pel_anisotropy_def *fibres)
{
    if (value->form == PEL_FORM_VECTOR) {
        fibres->direction = PEL_FIBRE_ALONG;
        pel_scene_value_numbers(value, fibres->axis);
        return;
    }
    fibres->direction = value->number > 0 ? PEL_FIBRE_PRINCIPAL : PEL_FIBRE_TO_CENTER;
}

/* mean of young times thickness over the vertices */
static double sheet_stiffness(const pel_membrane_def *membrane, const pel_mesh *mesh)
{
    double sum = 0;
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        sum += (membrane->young.field != NULL ? membrane->young.field[v] : membrane->young.value) *
               (membrane->thickness.field != NULL ? membrane->thickness.field[v] : membrane->thickness.value);
    return sum / mesh->vertex_count;
}

/* the stiffness of fibres without a number of their own */
static pel_status find_stiffness(const pel_scene_part *source, const pel_scene_value *value, const pel_shell_def *shell,
                                 pel_anisotropy_def *fibres)
{
    const bool is_given = pel_scene_value_entry(value, "stiffness")->form == PEL_FORM_NUMBER;
    if (is_given && fibres->mode == PEL_FIBRE_MUSCLE) {
        pel_scene_fail(source->reader, &pel_scene_value_entry(value, "stiffness")->place,
                       "a muscle has a tension, and no stiffness");
        pel_fail_remedy(source->reader->error, "use a second region of mode strain for what resists stretch beside it");
        return PEL_BAD_SCENE;
    }
    if (is_given || fibres->mode == PEL_FIBRE_MUSCLE)
        return PEL_OK;
    if (shell->membrane.on) {
        fibres->stiffness = sheet_stiffness(&shell->membrane, source->mesh);
        return PEL_OK;
    }
    if (fibres->mode == PEL_FIBRE_CURL)
        return PEL_OK;
    pel_scene_fail(source->reader, &value->place, "the stiffness of the fibres is not known");
    pel_fail_remedy(source->reader->error, "set `stiffness` [N/m], or give the body a membrane");
    return PEL_BAD_SCENE;
}

static pel_status read_fibres(const pel_scene_part *source, const pel_scene_value *value, const pel_shell_def *shell,
                              pel_anisotropy_def *fibres)
{
    const pel_scene_value *region = pel_scene_value_entry(value, "region");
    *fibres = pel_anisotropy_def_default();
    read_direction(pel_scene_value_entry(value, "direction"), fibres);
    const pel_scene_part part = {source->reader, value, source->mesh};
    pel_status status = pel_scene_read_members(&part, PEL_DEF_FIBRES, fibres);
    if (status == PEL_OK)
        status = find_stiffness(source, value, shell, fibres);
    if (status == PEL_OK && fibres->rest_length.field != NULL) {
        pel_scene_fail(source->reader, &value->place, "rest_length cannot vary over the body");
        pel_fail_remedy(source->reader->error,
                        "use a number or keys; to vary the effect over the body use a region with falloff");
        return PEL_BAD_SCENE;
    }
    if (status == PEL_OK)
        status = read_weights(source, region, &fibres->weights);
    if (status == PEL_OK)
        find_center(region, source->mesh, fibres->weights, fibres->center);
    return status;
}

static pel_status read_anisotropies(const pel_scene_part *source, pel_shell_def *shell)
{
    const pel_scene_value *value = pel_scene_value_entry(source->value, "anisotropy");
    if (value == NULL)
        return PEL_OK;
    bool is_list = value->kind == PEL_SCENE_LIST;
    size_t count = is_list ? (size_t)pel_scene_value_count(value) : 1;
    pel_anisotropy_def *fibres = pel_arena_take(source->reader->arena, count, sizeof *fibres);
    if (fibres == NULL)
        return pel_fail_memory(source->reader->error);
    shell->anisotropies = fibres;
    pel_status status = PEL_OK;
    for (const pel_scene_value *at = is_list ? value->first : value; status == PEL_OK && at != NULL;
         at = is_list ? at->next : NULL)
        status = read_fibres(source, at, shell, &fibres[shell->anisotropy_count++]);
    return status;
}

/* ---- pressure ---- */

/* with a gas or a target volume pressures and volumes are numbers of the whole body */
static pel_status check_pressure(const pel_scene_part *source, const pel_scene_value *value,
                                 const pel_pressure_def *pressure)
{
    bool is_outside = pressure->target.field == NULL;
    if (pressure->kind == PEL_PRESSURE_GIVEN || (is_outside && pressure->outside.field == NULL))
        return PEL_OK;
    if (is_outside)
        pel_scene_fail(source->reader, &pel_scene_value_entry(value, "outside")->place,
                       "with a gas or a target volume the outside pressure cannot vary over the body");
    else
        pel_scene_fail(source->reader, &value->place, "the target volume is one number; it cannot vary over the body");
    pel_fail_remedy(source->reader->error, "give a number or keys");
    return PEL_BAD_SCENE;
}

static pel_status finish_pressure(const pel_scene_part *source, pel_pressure_def *pressure)
{
    const pel_scene_value *value = pel_scene_value_entry(source->value, "pressure");
    if (value == NULL)
        return PEL_OK;
    const pel_scene_value *gas = pel_scene_value_entry(value, "gas"), *volume = pel_scene_value_entry(value, "volume");
    pressure->kind = gas != NULL ? PEL_PRESSURE_GAS : volume != NULL ? PEL_PRESSURE_VOLUME : PEL_PRESSURE_GIVEN;
    pel_status status = check_pressure(source, gas != NULL ? gas : volume, pressure);
    return status == PEL_OK ? read_weights(source, pel_scene_value_entry(value, "region"), &pressure->weights) : status;
}

/* ---- the warp ---- */

/* the distance of each vertex from a point */
static pel_status read_distances(const pel_scene_part *source, const pel_scene_value *center, const double **coordinate)
{
    const pel_mesh *mesh = source->mesh;
    double point[3], *distances = pel_arena_take(source->reader->arena, (size_t)mesh->vertex_count, sizeof *distances);
    if (distances == NULL)
        return pel_fail_memory(source->reader->error);
    pel_scene_value_numbers(center, point);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        distances[v] = pel_vec3_distance(mesh->positions[v], point);
    *coordinate = distances;
    return PEL_OK;
}

/* a direction that is no vector: the number whose gradient it is */
static pel_status read_warp(const pel_scene_part *source, pel_membrane_def *membrane)
{
    const pel_scene_value *value = pel_scene_value_at(source->value, "membrane.direction");
    if (value == NULL || value->form == PEL_FORM_VECTOR)
        return PEL_OK;
    const pel_scene_value *field = pel_scene_value_entry(value, "field"),
                          *center = pel_scene_value_entry(value, "center");
    if (field != NULL)
        return pel_scene_field(source->reader, field, source->mesh, &membrane->coordinate);
    if (center != NULL)
        return read_distances(source, center, &membrane->coordinate);
    /* as PLY files of several programs name them */
    static const char *const names[] = {"u", "s", "texture_u"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const pel_field *u = pel_mesh_field(source->mesh, names[i]);
        if (u == NULL || u->component_count != 1)
            continue;
        membrane->coordinate = u->values;
        return PEL_OK;
    }
    pel_scene_fail(source->reader, &value->place, "the mesh has no texture coordinates: no field u, s or texture_u");
    pel_fail_remedy(source->reader->error,
                    "save it as OBJ or PLY with one texture coordinate for each vertex, or give the warp as a "
                    "vector [x, y, z] or { field: NAME }");
    return PEL_BAD_SCENE;
}

/* points of the curve of a thread */
static void read_curve(const pel_scene_part *source, const char *path, double points[PEL_WEAVE_POINTS][2])
{
    const pel_scene_value *list = pel_scene_value_at(source->value, path);
    int i = 0;
    for (const pel_scene_value *point = list != NULL ? list->first : NULL; point != NULL && i < PEL_WEAVE_POINTS;
         point = point->next)
        pel_scene_value_numbers(point, points[i++]);
}

pel_status pel_scene_build_shell(const pel_scene_part *source, pel_shell_def *shell)
{
    read_curve(source, "membrane.warp_curve", shell->membrane.warp_curve);
    read_curve(source, "membrane.weft_curve", shell->membrane.weft_curve);
    pel_status status = read_warp(source, &shell->membrane);
    if (status == PEL_OK)
        status = read_anisotropies(source, shell);
    return status == PEL_OK ? finish_pressure(source, &shell->pressure) : status;
}

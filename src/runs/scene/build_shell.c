/* Membrane, bending, fibres and pressure of a body. */
#include "scene/build.h"

#include "scene/region.h"
#include "scene/table.h"

#include <math.h>
#include <string.h>

static pel_status read_membrane(const pel_scene_body_source *source, pel_membrane_def *membrane)
{
    const pel_scene_value *value = pel_scene_value_entry(source->value, "membrane");
    if (value == NULL)
        return PEL_OK;
    membrane->on = true;
    membrane->kind = (pel_membrane_kind)pel_scene_value_integer(value, "material");
    membrane->poisson = pel_scene_value_number(value, "poisson");
    membrane->mooney_ratio = pel_scene_value_number(value, "mooney_ratio");
    membrane->extension_limit = pel_scene_value_number(value, "extension_limit");
    membrane->stiffening = pel_scene_value_number(value, "stiffening");
    const pel_scene_value *limit = pel_scene_value_entry(value, "strain_limit");
    membrane->strain_limit = limit != NULL ? limit->number : 0;
    pel_status status = pel_scene_build_quantity(source, value, "young", "bodies[].membrane", &membrane->young);
    if (status == PEL_OK)
        status = pel_scene_build_quantity(source, value, "thickness", "bodies[].membrane", &membrane->thickness);
    return status;
}

static pel_status read_bending(const pel_scene_body_source *source, pel_bending_def *bending)
{
    const pel_scene_value *value = pel_scene_value_entry(source->value, "bending");
    if (value == NULL)
        return PEL_OK;
    const pel_scene_value *weight = pel_scene_value_entry(value, "weight");
    bending->model = (pel_bending_model)pel_scene_value_integer(value, "model");
    bending->weight = weight->form == PEL_FORM_NUMBER ? weight->number : -1;
    if (pel_scene_value_entry(value, "stiffness")->form == PEL_FORM_WORD) {
        bending->stiffness = (pel_quantity){.value = -1};
        return PEL_OK;
    }
    return pel_scene_build_quantity(source, value, "stiffness", "bodies[].bending", &bending->stiffness);
}

/* ---- regions ---- */

/* weights on all vertices; null for the whole body */
static pel_status read_weights(const pel_scene_body_source *source, const pel_scene_value *value,
                               const double **weights)
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

static pel_status read_stiffness(const pel_scene_body_source *source, const pel_scene_value *value,
                                 const pel_shell_def *shell, pel_anisotropy_def *fibres)
{
    const pel_scene_value *stiffness = pel_scene_value_entry(value, "stiffness");
    if (stiffness->form == PEL_FORM_NUMBER) {
        fibres->stiffness = stiffness->number;
        return PEL_OK;
    }
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

static pel_status read_fibres(const pel_scene_body_source *source, const pel_scene_value *value,
                              const pel_shell_def *shell, pel_anisotropy_def *fibres)
{
    const pel_scene_value *region = pel_scene_value_entry(value, "region"),
                          *curvature = pel_scene_value_entry(value, "curvature");
    *fibres = pel_anisotropy_def_default();
    fibres->mode = (pel_fibre_mode)pel_scene_value_integer(value, "mode");
    fibres->kind = (pel_fibre_kind)pel_scene_value_integer(value, "energy");
    if (fibres->mode == PEL_FIBRE_CAVE) {
        fibres->strength = pel_scene_value_number(value, "strength");
        fibres->max_step = pel_scene_value_number(value, "max_step");
    }
    if (curvature != NULL)
        fibres->curvature = curvature->number;
    read_direction(pel_scene_value_entry(value, "direction"), fibres);
    pel_status status = read_stiffness(source, value, shell, fibres);
    if (status == PEL_OK && fibres->mode == PEL_FIBRE_ACTIVE)
        status = pel_scene_build_quantity(source, value, "rest_length", "<anisotropy>", &fibres->rest_length);
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

static pel_status read_anisotropies(const pel_scene_body_source *source, pel_shell_def *shell)
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

/* an inside pressure is a negative outside one; the arrays belong to the arena */
static pel_status negate(const pel_scene_body_source *source, pel_quantity *quantity)
{
    size_t vertex_count = quantity->field != NULL ? (size_t)source->mesh->vertex_count : 0;
    size_t key_count = (size_t)quantity->key_count;
    double *field = pel_arena_take(source->reader->arena, vertex_count, sizeof *field);
    pel_key *keys = pel_arena_take(source->reader->arena, key_count, sizeof *keys);
    if (field == NULL || keys == NULL)
        return pel_fail_memory(source->reader->error);
    for (size_t v = 0; v < vertex_count; v++)
        field[v] = -quantity->field[v];
    for (size_t k = 0; k < key_count; k++)
        keys[k] = (pel_key){quantity->keys[k].time, -quantity->keys[k].value};
    quantity->value = -quantity->value;
    if (vertex_count > 0)
        quantity->field = field;
    if (key_count > 0)
        quantity->keys = keys;
    return PEL_OK;
}

/* in addition to a gas or a target volume */
static pel_status read_outside(const pel_scene_body_source *source, const pel_scene_value *value, const char *prefix,
                               pel_pressure_def *pressure)
{
    pel_status status = pel_scene_build_quantity(source, value, "outside", prefix, &pressure->outside);
    if (status != PEL_OK || pressure->outside.field == NULL)
        return status;
    pel_scene_fail(source->reader, &pel_scene_value_entry(value, "outside")->place,
                   "with a gas or a target volume the outside pressure cannot vary over the body");
    pel_fail_remedy(source->reader->error, "give a number or keys");
    return PEL_BAD_SCENE;
}

static pel_status read_target(const pel_scene_body_source *source, const pel_scene_value *value,
                              pel_pressure_def *pressure)
{
    pressure->kind = PEL_PRESSURE_VOLUME;
    pressure->bulk = pel_scene_value_number(value, "bulk");
    pel_status status =
        pel_scene_build_quantity(source, value, "target", "bodies[].pressure.volume", &pressure->target);
    if (status != PEL_OK)
        return status;
    if (pressure->target.field == NULL)
        return read_outside(source, value, "bodies[].pressure.volume", pressure);
    pel_scene_fail(source->reader, &value->place, "the target volume is one number; it cannot vary over the body");
    pel_fail_remedy(source->reader->error, "give a number or keys");
    return PEL_BAD_SCENE;
}

static pel_status read_pressure(const pel_scene_body_source *source, pel_pressure_def *pressure)
{
    const pel_scene_value *value = pel_scene_value_entry(source->value, "pressure");
    if (value == NULL)
        return PEL_OK;
    const pel_scene_value *gas = pel_scene_value_entry(value, "gas"), *volume = pel_scene_value_entry(value, "volume"),
                          *inside = pel_scene_value_entry(value, "inside");
    pressure->form = (pel_pressure_form)pel_scene_value_integer(value, "form");
    pel_status status = PEL_OK;
    if (gas != NULL) {
        pressure->kind = PEL_PRESSURE_GAS;
        pressure->value = pel_scene_value_number(gas, "pressure");
        pressure->gamma = pel_scene_value_number(gas, "gamma");
        status = read_outside(source, gas, "bodies[].pressure.gas", pressure);
    } else if (volume != NULL) {
        status = read_target(source, volume, pressure);
    } else {
        pressure->kind = PEL_PRESSURE_GIVEN;
        status = pel_scene_build_quantity(source, value, inside != NULL ? "inside" : "outside", "bodies[].pressure",
                                          &pressure->outside);
        if (status == PEL_OK && inside != NULL)
            status = negate(source, &pressure->outside);
    }
    if (status == PEL_OK)
        status = read_weights(source, pel_scene_value_entry(value, "region"), &pressure->weights);
    return status;
}

pel_status pel_scene_build_shell(const pel_scene_body_source *source, pel_shell_def *shell)
{
    pel_status status = read_membrane(source, &shell->membrane);
    if (status == PEL_OK)
        status = read_bending(source, &shell->bending);
    if (status == PEL_OK)
        status = read_anisotropies(source, shell);
    return status == PEL_OK ? read_pressure(source, &shell->pressure) : status;
}

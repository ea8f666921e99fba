#include "model/shell.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "law/membrane.h"
#include "math/vec3.h"
#include "measure/element.h"
#include "model/quantity.h"

#include "pellicle/mesh.h"

#include <math.h>
#include <string.h>

/* rest angles beyond this have no side to bend to [rad] */
#define FOLDED_ANGLE 3.14

pel_shell_def pel_shell_def_default(void)
{
    return pel_body_def_default().shell;
}

pel_anisotropy_def pel_anisotropy_def_default(void)
{
    pel_anisotropy_def def = {.axis = {0, 0, 1}};
    pel_def_reset(PEL_DEF_FIBRES, &def);
    return def;
}

/* whether a def switches anything on */
static bool is_on(const pel_shell_def *def)
{
    return def->membrane.on || def->bending.model != PEL_BENDING_NONE || def->anisotropy_count > 0 ||
           def->pressure.kind != PEL_PRESSURE_NONE;
}

/* ---- checks ---- */

static pel_status check_number(double value, double least, double most, int32_t body, const char *name,
                               pel_error *error)
{
    if (value >= least && value <= most && isfinite(value))
        return PEL_OK;
    pel_fail(error, PEL_BAD_ARGUMENT, "%s is %g", name, value);
    pel_fail_element(error, "body", body);
    if (isfinite(most))
        pel_fail_remedy(error, "give a number from %g to %g", least, most);
    else
        pel_fail_remedy(error, "give a finite number of at least %g", least);
    return PEL_BAD_ARGUMENT;
}

static pel_status check_weights(const double *weights, int32_t count, int32_t body, const char *name, pel_error *error)
{
    pel_status status = PEL_OK;
    bool any = weights == NULL;
    for (int32_t v = 0; weights != NULL && status == PEL_OK && v < count; v++) {
        status = check_number(weights[v], 0, 1, body, name, error);
        any |= weights[v] > 0;
    }
    if (status == PEL_OK && !any)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", body,
                                  "choose a region that holds at least one vertex", "%s are 0 on every vertex", name);
    return status;
}

/* the material with the numbers of vertex v */
static pel_membrane_material material_at(const pel_membrane_def *def, int32_t v)
{
    pel_membrane_material material = {.kind = def->kind,
                                      .young = pel_quantity_at(&def->young, v),
                                      .poisson = def->poisson,
                                      .thickness = pel_quantity_at(&def->thickness, v),
                                      .mooney_ratio = def->mooney_ratio,
                                      .extension_limit = def->extension_limit,
                                      .stiffening = def->stiffening,
                                      .weft = def->weft,
                                      .shear = def->shear,
                                      .yield = def->yield,
                                      .hardening = def->hardening};
    memcpy(material.warp_curve, def->warp_curve, sizeof material.warp_curve);
    memcpy(material.weft_curve, def->weft_curve, sizeof material.weft_curve);
    return material;
}

/* refuses the value of an enum outside the first `count` */
static pel_status check_choice(int value, int count, int32_t body, const char *name, pel_error *error)
{
    if (!PEL_IS_NO_CHOICE(value, count))
        return PEL_OK;
    return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", body, "give one of the choices of the header",
                              "%s is %d, which is no valid choice", name, value);
}

/* whether anything of a body has a warp */
static bool has_warp(const pel_shell_def *def)
{
    return (def->membrane.on && pel_law_is_oriented(pel_membrane_law_traits(def->membrane.kind))) ||
           (def->bending.model != PEL_BENDING_NONE && !(def->bending.weft < 0));
}

static pel_status check_warp(const pel_body_def *def, int32_t body, pel_error *error)
{
    const pel_membrane_def *membrane = &def->shell.membrane;
    if (!has_warp(&def->shell))
        return PEL_OK;
    if (membrane->young.field != NULL && pel_law_is_oriented(pel_membrane_law_traits(membrane->kind)))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", body,
                                  "give young one number; the thickness may vary over the body",
                                  "young of an orthotropic membrane varies over the body, where weft and shear do not");
    for (int32_t v = 0; membrane->coordinate != NULL && v < def->mesh->vertex_count; v++)
        if (!isfinite(membrane->coordinate[v]))
            return pel_body_refuse(error, body, "coordinate of the warp", membrane->coordinate[v],
                                   "give finite numbers");
    double length = pel_vec3_length(membrane->direction);
    if (membrane->coordinate == NULL && !(length > 0 && isfinite(length)))
        return pel_body_refuse(error, body, "length of the direction of the warp", length,
                               "give a direction whose length is above 0");
    return PEL_OK;
}

/* numbers that are the same all over a body, and what a body that keeps its triangles lacks */
static pel_status check_flow(const pel_body_def *def, int32_t body, pel_error *error)
{
    const pel_membrane_def *membrane = &def->shell.membrane;
    if (!pel_law_yields(pel_membrane_law_traits(membrane->kind)))
        return PEL_OK;
    if (membrane->young.field != NULL)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", body,
                                  "give young one number; the thickness may vary over the body",
                                  "young of an elastoplastic membrane varies over the body, where yield does not");
    if (def->refine.levels > 0 || def->origins != NULL || membrane->toughness.value > 0)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", body,
                                  "take another material, or leave out `refine`, cuts and `toughness`",
                                  "a body that stretches for good keeps its triangles: it neither refines nor is cut");
    return PEL_OK;
}

/* whether its shape without stress is not that of the mesh */
static bool grows(const pel_membrane_def *membrane)
{
    const pel_quantity *scale = &membrane->rest_scale;
    return membrane->on && (scale->field != NULL || (scale->value > 0 && scale->value != 1));
}

static pel_status check_growth(const pel_body_def *def, int32_t body, pel_error *error)
{
    const pel_membrane_def *membrane = &def->shell.membrane;
    const pel_quantity course = {.keys = membrane->rest_keys, .key_count = membrane->rest_key_count};
    pel_status status =
        pel_quantity_check(&membrane->rest_scale, def->mesh->vertex_count, body, "rest_scale", false, error);
    if (status == PEL_OK)
        status = pel_quantity_check(&course, def->mesh->vertex_count, body, "rest_keys", true, error);
    for (int32_t v = 0; status == PEL_OK && membrane->rest_scale.field != NULL && v < def->mesh->vertex_count; v++)
        if (!(membrane->rest_scale.field[v] > 0))
            status = pel_body_refuse(error, body, "rest_scale", membrane->rest_scale.field[v], "give numbers above 0");
    for (int32_t k = 0; status == PEL_OK && k < course.key_count; k++)
        if (course.keys[k].value > 1)
            status = pel_body_refuse(error, body, "rest_keys", course.keys[k].value, "give shares from 0 to 1");
    if (status != PEL_OK || !grows(membrane))
        return status;
    if (def->refine.levels > 0 || def->origins != NULL || membrane->toughness.value > 0 ||
        membrane->toughness.field != NULL)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", body,
                                  "leave out `rest_scale`, or `refine`, cuts and `toughness`",
                                  "a body that grows keeps its triangles: it neither refines nor is cut");
    if (pel_law_yields(pel_membrane_law_traits(membrane->kind)) || def->shell.anisotropy_count > 0)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", body,
                                  "leave out `rest_scale`, or take another material and no `anisotropy`",
                                  "fibres and elastoplastic membranes have a shape without stress of their own");
    return PEL_OK;
}

static pel_status check_membrane(const pel_body_def *def, int32_t body, pel_error *error)
{
    const pel_membrane_def *membrane = &def->shell.membrane;
    if (!membrane->on)
        return PEL_OK;
    if (!(membrane->strain_limit >= 0 && membrane->strain_limit < 1))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", body, "give 0 < strain_limit < 1, or 0 for no limit",
                                  "strain limit of the membrane is %g", membrane->strain_limit);
    pel_status status = check_number(membrane->retardation, 0, HUGE_VAL, body, "retardation of the membrane", error);
    if (status == PEL_OK)
        status = pel_quantity_check(&membrane->young, def->mesh->vertex_count, body, "young", false, error);
    if (status == PEL_OK)
        status = pel_quantity_check(&membrane->thickness, def->mesh->vertex_count, body, "thickness", false, error);
    if (status == PEL_OK)
        status = check_flow(def, body, error);
    if (status == PEL_OK)
        status = check_growth(def, body, error);
    if (status == PEL_OK)
        status = pel_toughness_check(&membrane->toughness, def, body, error);
    if (status == PEL_OK)
        status = pel_strength_check(&membrane->strength, &membrane->toughness, def, body, error);
    bool varies = membrane->young.field != NULL || membrane->thickness.field != NULL;
    for (int32_t v = 0; status == PEL_OK && v < (varies ? def->mesh->vertex_count : 1); v++) {
        pel_membrane_material material = material_at(membrane, v);
        status = pel_membrane_material_check(&material, error);
        if (status != PEL_OK)
            pel_fail_element(error, "body", body);
    }
    return status == PEL_OK ? check_warp(def, body, error) : status;
}

static pel_status check_yield(const pel_body_def *def, int32_t body, pel_error *error)
{
    const pel_bending_def *bending = &def->shell.bending;
    pel_status status = check_number(bending->yield, 0, HUGE_VAL, body, "yield of the bending", error);
    if (status == PEL_OK && bending->yield > 0)
        status = check_number(bending->hardening, 0, HUGE_VAL, body, "hardening of the bending", error);
    if (status != PEL_OK || !(bending->yield > 0))
        return status;
    if (!pel_bending_traits_of(bending->model)->is_angle)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", body, "give the bending the model hinge",
                                  "plastic folds change rest angles of hinges, but the body has none");
    if (def->refine.levels > 0 || def->origins != NULL || def->shell.membrane.toughness.value > 0)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", body,
                                  "leave out `yield`, or `refine`, cuts and `toughness`",
                                  "a body with plastic folds keeps its triangles: it neither refines nor is cut");
    return PEL_OK;
}

static pel_status check_bending(const pel_body_def *def, int32_t body, pel_error *error)
{
    const pel_bending_def *bending = &def->shell.bending;
    pel_status status = check_choice((int)bending->model, PEL_BENDING_COUNT, body, "bending model", error);
    if (status != PEL_OK || bending->model == PEL_BENDING_NONE)
        return status;
    status = check_number(bending->retardation, 0, HUGE_VAL, body, "retardation of the bending", error);
    if (status == PEL_OK && bending->retardation > 0 && !pel_bending_traits_of(bending->model)->has_rest_angles)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", body,
                                  "damp the bending with the model hinge or midedge",
                                  "isometric bending has no angle whose rate could be damped");
    if (status == PEL_OK)
        status = check_yield(def, body, error);
    if (status != PEL_OK)
        return status;
    if (!(bending->weight < 0)) {
        status = check_number(bending->weight, 0, 1, body, "bending weight", error);
        if (status != PEL_OK)
            return status;
    }
    if (!(bending->weft < 0)) {
        status = check_number(bending->weft, 0, HUGE_VAL, body, "bending weft", error);
        if (status == PEL_OK && bending->stiffness.field != NULL)
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", body, "give the bending stiffness one number",
                                      "bending stiffness of the warp varies over the body, that of the weft does not");
        if (status == PEL_OK)
            status = check_warp(def, body, error);
        if (status != PEL_OK)
            return status;
    }
    if (bending->stiffness.field == NULL && bending->stiffness.key_count == 0 && bending->stiffness.value < 0)
        return PEL_OK;
    return pel_quantity_check(&bending->stiffness, def->mesh->vertex_count, body, "bending stiffness", false, error);
}

static pel_status check_muscle(const pel_body_def *body_def, const pel_anisotropy_def *def, int32_t body,
                               pel_error *error)
{
    const double numbers[] = {def->tension, def->optimum, def->width};
    static const char *const names[] = {"muscle tension", "muscle optimum", "muscle width"};
    pel_status status =
        pel_quantity_check(&def->activation, body_def->mesh->vertex_count, body, "activation", true, error);
    for (int i = 0; status == PEL_OK && i < 3; i++)
        if (!(numbers[i] > 0 && isfinite(numbers[i])))
            status = check_number(numbers[i], 1e-300, HUGE_VAL, body, names[i], error);
    return status;
}

static pel_status check_anisotropy(const pel_body_def *body_def, const pel_anisotropy_def *def, int32_t body,
                                   pel_error *error)
{
    bool fibres = def->mode != PEL_FIBRE_CURL, is_muscle = def->mode == PEL_FIBRE_MUSCLE;
    pel_status status = check_choice((int)def->mode, PEL_FIBRE_MUSCLE + 1, body, "anisotropy mode", error);
    if (status == PEL_OK)
        status = check_choice((int)def->kind, PEL_FIBRE_SQRT + 1, body, "fibre kind", error);
    if (status == PEL_OK)
        status = check_choice((int)def->direction, PEL_FIBRE_PRINCIPAL + 1, body, "fibre direction", error);
    if (status == PEL_OK && fibres && !is_muscle && !(def->stiffness > 0))
        status = check_number(def->stiffness, 1e-300, HUGE_VAL, body, "fibre stiffness", error);
    if (status == PEL_OK && def->mode == PEL_FIBRE_CAVE && !(def->strength > 0 && isfinite(def->strength)))
        status = check_number(def->strength, 1e-300, HUGE_VAL, body, "anisotropy strength", error);
    if (status == PEL_OK && def->mode == PEL_FIBRE_NORMAL && !(def->gradient > 0 && isfinite(def->gradient)))
        status = check_number(def->gradient, 1e-300, HUGE_VAL, body, "anisotropy gradient", error);
    if (status == PEL_OK && (def->mode == PEL_FIBRE_CAVE || def->mode == PEL_FIBRE_NORMAL))
        status = check_number(def->max_step, 0, 1, body, "anisotropy max_step", error);
    if (status == PEL_OK && def->mode == PEL_FIBRE_ACTIVE)
        status =
            pel_quantity_check(&def->rest_length, body_def->mesh->vertex_count, body, "fibre rest_length", true, error);
    if (status == PEL_OK && is_muscle)
        status = check_muscle(body_def, def, body, error);
    if (status == PEL_OK && !fibres && !pel_bending_traits_of(body_def->shell.bending.model)->has_rest_angles)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", body, "give the bending the model hinge",
                                  "anisotropy that curls changes rest angles, but the body has no hinges");
    if (status == PEL_OK && !isfinite(def->curvature))
        status = check_number(def->curvature, -1e6, 1e6, body, "curvature", error);
    if (status == PEL_OK && fibres && def->direction == PEL_FIBRE_ALONG &&
        !(pel_vec3_length(def->axis) > 0 && isfinite(pel_vec3_length(def->axis))))
        status = check_number(pel_vec3_length(def->axis), 1e-300, HUGE_VAL, body, "length of the fibre axis", error);
    return status == PEL_OK
               ? check_weights(def->weights, body_def->mesh->vertex_count, body, "anisotropy weights", error)
               : status;
}

/* the pressure depends on the enclosed volume */
static bool has_volume(pel_pressure_kind kind)
{
    return kind == PEL_PRESSURE_GAS || kind == PEL_PRESSURE_VOLUME;
}

static pel_status check_pressure(const pel_body_def *body_def, int32_t body, pel_error *error)
{
    const pel_pressure_def *def = &body_def->shell.pressure;
    int32_t vertex_count = body_def->mesh->vertex_count;
    pel_status status = check_choice((int)def->kind, PEL_PRESSURE_VOLUME + 1, body, "pressure kind", error);
    if (status == PEL_OK)
        status = check_choice((int)def->form, PEL_PRESSURE_VERTEX_NORMAL + 1, body, "pressure form", error);
    if (status != PEL_OK)
        return status;
    if (def->kind != PEL_PRESSURE_NONE)
        status = pel_quantity_check_signed(&def->outside, vertex_count, body, "outside pressure", true, error);
    if (status == PEL_OK && def->outside.field != NULL && has_volume(def->kind))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", body, "give it as a number or keys",
                                  "the outside pressure beside a gas or a target volume varies over the body");
    if (status == PEL_OK && def->kind == PEL_PRESSURE_GAS)
        status = check_number(def->value, 0, HUGE_VAL, body, "gas pressure", error);
    if (status == PEL_OK && def->kind == PEL_PRESSURE_GAS)
        status = check_number(def->gamma, 1, 10, body, "gas gamma", error);
    if (status == PEL_OK && def->kind == PEL_PRESSURE_VOLUME)
        status = check_number(def->bulk, 0, HUGE_VAL, body, "bulk", error);
    if (status == PEL_OK && def->kind == PEL_PRESSURE_VOLUME)
        status = pel_quantity_check(&def->target, vertex_count, body, "target volume", true, error);
    if (status == PEL_OK && def->kind != PEL_PRESSURE_NONE)
        status = check_weights(def->weights, vertex_count, body, "pressure weights", error);
    return status;
}

pel_status pel_shell_check(const pel_body_def *def, int32_t body, pel_error *error)
{
    pel_status status = check_membrane(def, body, error);
    if (status == PEL_OK)
        status = check_bending(def, body, error);
    if (status == PEL_OK)
        status = check_pressure(def, body, error);
    int32_t count = def->shell.anisotropy_count;
    if (status == PEL_OK && (count < 0 || (count > 0 && def->shell.anisotropies == NULL))) {
        pel_fail(error, PEL_BAD_ARGUMENT, "anisotropies is null or anisotropy_count below 0: %d", (int)count);
        pel_fail_element(error, "body", body);
        return PEL_BAD_ARGUMENT;
    }
    for (int32_t i = 0; status == PEL_OK && i < def->shell.anisotropy_count; i++)
        status = check_anisotropy(def, &def->shell.anisotropies[i], body, error);
    return status;
}

/* ---- creation ---- */

static double corner_mean(const pel_quantity *quantity, const int32_t vertices[3])
{
    if (quantity->field == NULL)
        return quantity->value;
    return (quantity->field[vertices[0]] + quantity->field[vertices[1]] + quantity->field[vertices[2]]) / 3;
}

static double mean_weight(const double *weights, const int32_t vertices[3])
{
    return weights == NULL ? 1 : (weights[vertices[0]] + weights[vertices[1]] + weights[vertices[2]]) / 3;
}

static void load_corners(const pel_mesh *mesh, int32_t t, double x[3][3])
{
    for (int i = 0; i < 3; i++)
        memcpy(x[i], mesh->positions[mesh->triangles[t][i]], sizeof x[i]);
}

/* m, size of a mesh whose areas, and their squares, are numbers; its reciprocal likewise */
#define LEAST_SIZE 1e-50

pel_status pel_refuse_area(const pel_mesh *mesh, int32_t triangle, pel_error *error)
{
    double low[3], high[3], size = 0;
    pel_mesh_box(mesh, low, high);
    for (int k = 0; k < 3; k++)
        size = high[k] - low[k] > size ? high[k] - low[k] : size;
    bool has_areas = size > LEAST_SIZE && size < 1 / LEAST_SIZE;
    return pel_refuse_element(error, PEL_BAD_MESH, "triangle", triangle,
                              has_areas ? "repair the mesh with `pellicle check --fix`"
                                        : "scale the mesh to metres: mesh: { ..., scale: ... }",
                              has_areas ? "triangle has no area" : "triangle has no area: its mesh is %.3g m across",
                              size);
}

static pel_status check_areas(const pel_body *body, pel_shell *shell, pel_error *error)
{
    const pel_mesh *mesh = body->mesh;
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        double x[3][3];
        pel_rest_triangle rest;
        load_corners(mesh, t, x);
        if (!pel_rest_triangle_setup((const double(*)[3])x, &rest))
            return pel_refuse_area(mesh, t, error);
        for (int i = 0; i < 3; i++)
            shell->mean_edge += pel_vec3_distance(x[i], x[(i + 1) % 3]) / (3.0 * mesh->triangle_count);
    }
    return PEL_OK;
}

/* whether a vector is normal to a triangle, as far as corners in single precision tell */
static bool is_normal(const double x[3][3], const double vector[3])
{
    double first[3], second[3], normal[3], across[3];
    pel_vec3_subtract(x[1], x[0], first);
    pel_vec3_subtract(x[2], x[0], second);
    pel_vec3_cross(first, second, normal);
    pel_vec3_cross(normal, vector, across);
    return pel_vec3_length(across) <= 1e-6 * pel_vec3_length(normal) * pel_vec3_length(vector);
}

void pel_shell_warp(const pel_shell *shell, int32_t t, const double x[3][3], double along[3])
{
    if (shell->coordinate == NULL) {
        const double *vector = shell->direction;
        if (is_normal(x, vector))
            pel_vec3_set(along, vector[2], vector[0], vector[1]);
        else
            pel_vec3_copy(vector, along);
        return;
    }
    double values[3];
    for (int k = 0; k < 3; k++)
        values[k] = shell->coordinate[shell->mesh->triangles[t][k]];
    pel_triangle_gradient(x, values, along);
}

static pel_status create_axes(const pel_membrane_def *membrane, pel_shell *shell, pel_error *error)
{
    const pel_mesh *mesh = shell->mesh;
    const size_t vertices = (size_t)mesh->vertex_count;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(shell->axes, (size_t)mesh->triangle_count),
                          PEL_ROOM_IF(membrane->coordinate != NULL, shell->coordinate, vertices)))
        return pel_fail_memory(error);
    pel_vec3_copy(membrane->direction, shell->direction);
    if (membrane->coordinate != NULL)
        memcpy(shell->coordinate, membrane->coordinate, vertices * sizeof *shell->coordinate);
    bool is_along_some = false;
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        double x[3][3], along[3];
        load_corners(mesh, t, x);
        is_along_some |= membrane->coordinate != NULL || !is_normal((const double(*)[3])x, shell->direction);
        pel_shell_warp(shell, t, (const double(*)[3])x, along);
        if (!pel_rest_triangle_direction((const double(*)[3])x, along, shell->axes[t]) ||
            (t == mesh->triangle_count - 1 && !is_along_some))
            return pel_refuse_element(
                error, PEL_BAD_ARGUMENT, "triangle", t,
                "choose a direction within the surface, or a coordinate that rises along the warp",
                "warp is normal to a triangle, or has no direction there");
    }
    return PEL_OK;
}

/* the material over its Young's modulus */
static pel_membrane_material unit_material(const pel_membrane_material *material)
{
    pel_membrane_material unit = *material;
    unit.weft /= unit.young;
    unit.shear /= unit.young;
    unit.yield /= unit.young;
    unit.hardening /= unit.young;
    for (int i = 0; i < PEL_WEAVE_POINTS; i++) {
        unit.warp_curve[i][1] /= unit.young;
        unit.weft_curve[i][1] /= unit.young;
    }
    unit.young = unit.thickness = 1;
    return unit;
}

static pel_status create_growth(const pel_membrane_def *membrane, pel_shell *shell, pel_error *error)
{
    const pel_quantity course = {.keys = membrane->rest_keys, .key_count = membrane->rest_key_count};
    if (!grows(membrane))
        return PEL_OK;
    shell->growths = pel_allocate((size_t)shell->triangle_count, sizeof *shell->growths);
    if (shell->growths == NULL)
        return pel_fail_memory(error);
    for (int32_t t = 0; t < shell->triangle_count; t++)
        shell->growths[t] = corner_mean(&membrane->rest_scale, shell->mesh->triangles[t]) - 1;
    return pel_curve_copy(&course, &shell->growth_course, error);
}

static pel_status create_triangles(const pel_body_def *def, const pel_model *model, const pel_body *body,
                                   pel_shell *shell, pel_error *error)
{
    const pel_membrane_def *membrane = &def->shell.membrane;
    const pel_mesh *mesh = shell->mesh = body->mesh;
    shell->triangle_count = shell->triangle_limit = mesh->triangle_count;
    shell->corners = (const int32_t(*)[3])model->triangles + model->triangle_begin[body - model->bodies];
    if (membrane->young.field != NULL || membrane->thickness.field != NULL) {
        shell->sheets = pel_allocate((size_t)mesh->triangle_count, sizeof *shell->sheets);
        if (shell->sheets == NULL)
            return pel_fail_memory(error);
    }
    for (int32_t t = 0; shell->sheets != NULL && t < mesh->triangle_count; t++)
        shell->sheets[t] = (pel_shell_sheet){corner_mean(&membrane->young, mesh->triangles[t]),
                                             corner_mean(&membrane->thickness, mesh->triangles[t])};
    shell->has_membrane = membrane->on;
    shell->strain_limit = shell->has_membrane ? membrane->strain_limit : 0;
    shell->membrane_retardation = shell->has_membrane ? membrane->retardation : 0;
    shell->bending_retardation = def->shell.bending.model != PEL_BENDING_NONE ? def->shell.bending.retardation : 0;
    shell->material = material_at(membrane, mesh->triangles[0][0]);
    shell->material.young = corner_mean(&membrane->young, mesh->triangles[0]);
    shell->material.thickness = corner_mean(&membrane->thickness, mesh->triangles[0]);
    const pel_membrane_material unit = unit_material(&shell->material);
    shell->law = pel_membrane_law_of(&unit);
    shell->yields = shell->has_membrane && pel_law_yields(pel_membrane_law_traits(shell->law.kind));
    if (!shell->has_membrane)
        shell->law.poisson = membrane->poisson;
    pel_status status = check_areas(body, shell, error);
    if (status == PEL_OK && has_warp(&def->shell))
        status = create_axes(membrane, shell, error);
    return status == PEL_OK ? create_growth(membrane, shell, error) : status;
}

/* D of a triangle by its material; 0 without a membrane */
static double triangle_bending(const pel_shell *shell, int32_t t)
{
    PEL_ASSERT_INDEX(t, shell->triangle_count);
    if (!shell->has_membrane)
        return 0;
    pel_shell_sheet sheet = pel_shell_sheet_of(shell, t);
    if (!pel_law_is_oriented(pel_membrane_law_traits(shell->law.kind)))
        return pel_bending_stiffness(sheet.young, shell->law.poisson, sheet.thickness);
    const double cube = sheet.thickness * sheet.thickness * sheet.thickness;
    return sheet.young * cube / 12 * pel_membrane_law_along(&shell->law);
}

pel_plate pel_shell_plate_of(const pel_membrane_law *law)
{
    double d[6];
    const double rest[3] = {0, 0, 0};
    if (!pel_law_is_oriented(pel_membrane_law_traits(law->kind)))
        return pel_plate_isotropic(law->poisson);
    pel_membrane_law_response(law, rest, NULL, d, NULL);
    return (pel_plate){d[3] / d[0], d[1] / d[0], d[5] / d[0], {1, 0}};
}

/* Bending across the warp: as the membrane where nothing is given, else by Huber's estimate of an orthotropic plate
   (1923), coupling + 2 twist = sqrt(along across). */
static void create_plate(const pel_bending_def *bending, pel_shell *shell)
{
    const bool is_own = bending->stiffness.field == NULL && bending->stiffness.value < 0 && shell->has_membrane;
    shell->bends_as_membrane = is_own && bending->weft < 0;
    shell->plate = shell->bends_as_membrane ? pel_shell_plate_of(&shell->law) : pel_plate_isotropic(shell->law.poisson);
    if (bending->weft < 0)
        return;
    const double along = is_own ? triangle_bending(shell, 0) : bending->stiffness.value;
    const double ratio = bending->weft / along, root = sqrt(ratio);
    shell->plate = (pel_plate){ratio, shell->plate.coupling * root, shell->plate.twist * root, {1, 0}};
}

double pel_shell_hinge_share(const pel_shell *shell, const int32_t sides[2])
{
    double sum = 0;
    for (int i = 0; i < 2; i++) {
        const pel_rest_triangle rest = pel_shell_rest(shell, sides[i] / 3);
        const pel_plate plate = pel_shell_plate(shell, sides[i] / 3);
        sum += 0.5 * pel_plate_about_edge(&rest, sides[i] % 3, &plate);
    }
    return sum;
}

/* bending of triangles: of hinges between their parts, or of mid-edge elements */
static pel_status create_parts(const pel_body_def *def, const pel_body *body, pel_shell *shell, pel_error *error)
{
    if (body->detail == NULL && !shell->bending->turns_edges)
        return PEL_OK;
    shell->parts = pel_allocate((size_t)shell->triangle_count, sizeof *shell->parts);
    if (shell->parts == NULL)
        return pel_fail_memory(error);
    const pel_quantity *given = &def->shell.bending.stiffness;
    for (int32_t t = 0; t < shell->triangle_count; t++) {
        pel_shell_part_bending *part = &shell->parts[t];
        const int32_t *v = body->mesh->triangles[t];
        bool own = given->field == NULL && given->value < 0;
        part->stiffness = own ? triangle_bending(shell, t) : corner_mean(given, v);
        part->curl = 1;
        for (int32_t i = 0; i < def->shell.anisotropy_count; i++) {
            const pel_anisotropy_def *curl = &def->shell.anisotropies[i];
            if (curl->mode == PEL_FIBRE_CURL)
                part->curl *= 1 + mean_weight(curl->weights, v) * (curl->curvature - 1);
        }
    }
    return PEL_OK;
}

/* D of a hinge: given, or from its two triangles */
static double hinge_stiffness(const pel_body_def *def, const pel_shell *shell, const int32_t sides[2],
                              const int32_t ends[2])
{
    const pel_quantity *given = &def->shell.bending.stiffness;
    if (given->field != NULL)
        return 0.5 * (given->field[ends[0]] + given->field[ends[1]]);
    if (!(given->value < 0))
        return given->value;
    return 0.5 * triangle_bending(shell, sides[0] / 3) + 0.5 * triangle_bending(shell, sides[1] / 3);
}

/* false when there is no hinge */
static bool find_hinge(const pel_mesh *mesh, const int32_t sides[2], pel_hinge *hinge, double *length)
{
    const int32_t corners[4] = {sides[0], pel_half_edge_next(sides[0]), pel_half_edge_previous(sides[0]),
                                pel_half_edge_previous(sides[1])};
    double x[4][3];
    for (int i = 0; i < 4; i++)
        memcpy(x[i], mesh->positions[mesh->triangles[corners[i] / 3][corners[i] % 3]], sizeof x[i]);
    *length = pel_vec3_distance(x[0], x[1]);
    return pel_hinge_setup((const double(*)[3])x, hinge);
}

static pel_status fail_folded(const int32_t sides[2], pel_error *error)
{
    return pel_refuse_element(error, PEL_BAD_MESH, "triangle", sides[0] / 3,
                              "unfold or remove one of them, or leave out the bending",
                              "triangle is folded onto its neighbour %d at rest", (int)(sides[1] / 3));
}

/* a rest angle with all curls applied */
static double curl(const pel_body_def *def, const int32_t ends[2], double angle)
{
    for (int32_t i = 0; i < def->shell.anisotropy_count; i++) {
        const pel_anisotropy_def *region = &def->shell.anisotropies[i];
        if (region->mode != PEL_FIBRE_CURL)
            continue;
        double w = region->weights == NULL ? 1 : 0.5 * (region->weights[ends[0]] + region->weights[ends[1]]);
        angle *= 1 + w * (region->curvature - 1);
    }
    return angle;
}

static bool has_curls(const pel_body_def *def)
{
    for (int32_t i = 0; i < def->shell.anisotropy_count; i++)
        if (def->shell.anisotropies[i].mode == PEL_FIBRE_CURL)
            return true;
    return false;
}

/* A body that refines keeps its rest angles: events take them over. */
static pel_status allocate_hinges(const pel_body_def *def, const pel_topology *topology, bool refines, pel_shell *shell,
                                  pel_error *error)
{
    size_t limit = (size_t)topology->edge_count;
    bool keeps = refines || has_curls(def),
         varies = shell->sheets != NULL || shell->axes != NULL || def->shell.bending.stiffness.field != NULL;
    return PEL_ALLOCATE_ALL(PEL_ROOM(shell->hinge_sides, limit), PEL_ROOM_IF(keeps, shell->rest_angles, limit),
                            PEL_ROOM_IF(varies, shell->hinge_stiffnesses, limit),
                            PEL_ROOM_IF(def->shell.bending.yield > 0, shell->yield_angles, limit))
               ? PEL_OK
               : pel_fail_memory(error);
}

static pel_status create_hinges(const pel_body_def *def, const pel_body *body, const pel_topology *topology,
                                pel_shell *shell, pel_error *error)
{
    shell->bending = pel_bending_traits_of(def->shell.bending.model);
    shell->bending_weight = def->shell.bending.weight;
    shell->hardening = def->shell.bending.hardening;
    create_plate(&def->shell.bending, shell);
    if (!pel_bending_is_on(shell->bending))
        return PEL_OK;
    pel_status status = allocate_hinges(def, topology, body->detail != NULL, shell, error);
    /* of a mesh without an inner edge, whose refined surface has some */
    const pel_quantity *given = &def->shell.bending.stiffness;
    shell->hinge_stiffness = given->field == NULL && !(given->value < 0) ? given->value : triangle_bending(shell, 0);
    for (int32_t e = 0; status == PEL_OK && e < topology->edge_count; e++) {
        int32_t h = topology->half_edge_of_edge[e], i = shell->hinge_count;
        const int32_t sides[2] = {h, topology->twin[h]};
        const int32_t ends[2] = {pel_half_edge_origin(topology, h), pel_half_edge_target(topology, h)};
        pel_hinge hinge;
        double length;
        if (sides[1] < 0 || !find_hinge(shell->mesh, sides, &hinge, &length))
            continue;
        if (fabs(hinge.rest_angle) > FOLDED_ANGLE)
            return fail_folded(sides, error);
        shell->hinge_stiffness = hinge_stiffness(def, shell, sides, ends);
        if (shell->axes != NULL)
            shell->hinge_stiffness *= pel_shell_hinge_share(shell, sides);
        memcpy(shell->hinge_sides[i], sides, sizeof sides);
        if (shell->rest_angles != NULL)
            shell->rest_angles[i] = curl(def, ends, hinge.rest_angle);
        /* a hinge of the length L stands for a strip of the width (A0 + A1) / L */
        if (shell->yield_angles != NULL)
            shell->yield_angles[i] = def->shell.bending.yield * length / hinge.factor;
        if (shell->hinge_stiffnesses != NULL)
            shell->hinge_stiffnesses[i] = shell->hinge_stiffness;
        shell->hinge_count++;
    }
    return status;
}

void pel_shell_fibre_direction(const pel_anisotropy_def *def, const double x[3][3], double direction[2])
{
    double along[3];
    for (int i = 0; i < 3; i++)
        along[i] =
            def->direction == PEL_FIBRE_ALONG ? def->axis[i] : def->center[i] - (x[0][i] + x[1][i] + x[2][i]) / 3;
    pel_rest_triangle_direction(x, along, direction);
}

/* of a region, of an activation over the body, or of both */
static double fibre_weight(const double *weights, const double *spread, const int32_t corners[3])
{
    return (weights != NULL ? mean_weight(weights, corners) : 1) * (spread != NULL ? mean_weight(spread, corners) : 1);
}

static pel_status create_region(const pel_anisotropy_def *def, const pel_body *body, pel_shell_region *region,
                                pel_error *error)
{
    const pel_mesh *mesh = body->mesh;
    const bool is_muscle = def->mode == PEL_FIBRE_MUSCLE;
    const pel_quantity *course = is_muscle ? &def->activation : &def->rest_length;
    const double *spread = is_muscle ? def->activation.field : NULL;
    region->def = *def;
    region->def.weights = NULL;
    region->def.rest_length.field = region->def.activation.field = NULL;
    region->def.rest_length.keys = region->def.activation.keys = NULL;
    region->amount = spread != NULL ? 1 : pel_quantity_at(course, 0);
    /* the tension is the stiffness of the numbers of its elements */
    if (is_muscle)
        region->def.stiffness = def->tension;
    pel_status status = pel_curve_copy(course, &region->course, error);
    if (status != PEL_OK || def->mode == PEL_FIBRE_CURL)
        return status;
    if (def->weights == NULL && spread == NULL) {
        region->fibre_count = mesh->triangle_count;
        return PEL_OK;
    }
    size_t count = 0;
    for (int32_t t = 0; t < mesh->triangle_count; t++)
        count += fibre_weight(def->weights, spread, mesh->triangles[t]) > 0;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(region->triangles, count), PEL_ROOM(region->weights, count)))
        return pel_fail_memory(error);
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        double weight = fibre_weight(def->weights, spread, mesh->triangles[t]);
        if (!(weight > 0))
            continue;
        region->triangles[region->fibre_count] = t;
        region->weights[region->fibre_count++] = weight;
    }
    return PEL_OK;
}

static pel_status create_regions(const pel_body_def *def, const pel_body *body, pel_shell *shell, pel_error *error)
{
    int32_t count = def->shell.anisotropy_count;
    if (count == 0)
        return PEL_OK;
    shell->regions = pel_allocate((size_t)count, sizeof *shell->regions);
    if (shell->regions == NULL)
        return pel_fail_memory(error);
    shell->region_count = count;
    pel_status status = PEL_OK;
    for (int32_t i = 0; status == PEL_OK && i < count; i++)
        status = create_region(&def->shell.anisotropies[i], body, &shell->regions[i], error);
    return status;
}

static pel_status create_pressure(const pel_body_def *def, const pel_body *body, pel_shell *shell, pel_error *error)
{
    const pel_pressure_def *pressure = &def->shell.pressure;
    const pel_mesh *mesh = body->mesh;
    shell->pressure = *pressure;
    shell->pressure.weights = NULL;
    shell->pressure.outside.field = shell->pressure.target.field = NULL;
    shell->pressure.outside.keys = shell->pressure.target.keys = NULL;
    shell->pressure.outside.value = pressure->outside.field != NULL ? 1 : pel_quantity_at(&pressure->outside, 0);
    shell->pressure.target.value = pel_quantity_at(&pressure->target, 0);
    pel_status status = pel_curve_copy(&pressure->outside, &shell->outside, error);
    if (status == PEL_OK)
        status = pel_curve_copy(&pressure->target, &shell->target, error);
    bool field = pressure->kind == PEL_PRESSURE_GIVEN && pressure->outside.field != NULL;
    if (status != PEL_OK || (!field && pressure->weights == NULL))
        return status;
    shell->pressure_weights = pel_allocate((size_t)mesh->triangle_count, sizeof *shell->pressure_weights);
    if (shell->pressure_weights == NULL)
        return pel_fail_memory(error);
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        double value = field ? corner_mean(&pressure->outside, mesh->triangles[t]) : 1;
        shell->pressure_weights[t] = value * mean_weight(pressure->weights, mesh->triangles[t]);
    }
    return PEL_OK;
}

/* a gas and a target volume need a volume */
static pel_status check_closed(const pel_body_def *def, const pel_body *body, int32_t index,
                               const pel_topology *topology, pel_error *error)
{
    if (body->closed || !has_volume(def->shell.pressure.kind))
        return PEL_OK;
    pel_fail(error, PEL_BAD_ARGUMENT, "its mesh has a boundary and encloses no volume");
    pel_fail_element(error, "body", index);
    pel_fail_remedy(
        error, "close its holes with `pellicle check MESH --fix OUT --fill-holes %d`, or give the pressure as a number",
        (int)topology->boundary_edge_count);
    return PEL_BAD_ARGUMENT;
}

pel_status pel_body_shell_create(const pel_body_def *def, pel_model *model, int32_t body, const pel_topology *topology,
                                 pel_error *error)
{
    PEL_ASSERT_INDEX(body, model->body_count);
    if (!is_on(&def->shell) && !def->volume.on)
        return PEL_OK;
    pel_body *b = &model->bodies[body];
    const int32_t first_fold = pel_model_fold_count(model), first_flow = pel_model_flow_count(model);
    pel_shell *shell = b->shell = pel_allocate(1, sizeof *shell);
    if (shell == NULL)
        return pel_fail_memory(error);
    shell->first_fold = first_fold;
    shell->first_flow = first_flow;
    pel_status status = check_closed(def, b, body, topology, error);
    if (status == PEL_OK)
        status = create_triangles(def, model, b, shell, error);
    if (status == PEL_OK)
        status = create_hinges(def, b, topology, shell, error);
    if (status == PEL_OK)
        status = create_regions(def, b, shell, error);
    if (status == PEL_OK)
        status = create_parts(def, b, shell, error);
    if (status == PEL_OK)
        status = pel_filled_create(def, b, shell, error);
    shell->hinge_limit = shell->hinge_count;
    for (int32_t i = 0; i < shell->region_count; i++)
        shell->regions[i].fibre_limit = shell->regions[i].fibre_count;
    return status == PEL_OK ? create_pressure(def, b, shell, error) : status;
}

bool pel_shell_needs_projection(const pel_shell *shell)
{
    return shell != NULL && (shell->strain_limit > 0 || pel_shell_has_mode(shell, PEL_FIBRE_CAVE));
}

bool pel_shell_has_mode(const pel_shell *shell, pel_fibre_mode mode)
{
    for (int32_t r = 0; r < shell->region_count; r++)
        if (shell->regions[r].def.mode == mode)
            return true;
    return false;
}

pel_status pel_shell_check_bending(const pel_shell *shell, int32_t body, pel_error *error)
{
    for (int32_t i = 0; i < shell->hinge_count; i++) {
        if (shell->has_membrane || pel_shell_hinge_stiffness(shell, i) > 0)
            continue;
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", body,
                                  "give the bending a stiffness above 0 [N m], or the body a membrane",
                                  "bending has no stiffness");
    }
    return PEL_OK;
}

void pel_shell_destroy(pel_shell *shell)
{
    if (shell == NULL)
        return;
    for (int32_t i = 0; i < shell->region_count; i++) {
        PEL_FREE_ALL(shell->regions[i].triangles, shell->regions[i].weights, shell->regions[i].course.keys);
    }
    PEL_FREE_ALL(shell->sheets, shell->axes, shell->growths, shell->growth_course.keys, shell->coordinate,
                 shell->hinge_sides, shell->hinge_stiffnesses, shell->rest_angles, shell->yield_angles, shell->regions,
                 shell->parts, shell->outside.keys, shell->target.keys, shell->pressure_weights);
    pel_filled_destroy(shell);
    pel_free(shell);
}

/* ---- elements ---- */

pel_rest_triangle pel_shell_rest(const pel_shell *shell, int32_t t)
{
    PEL_ASSERT_INDEX(t, shell->triangle_count);
    if (shell->rests != NULL)
        return shell->rests[t];
    double x[3][3];
    pel_rest_triangle rest;
    load_corners(shell->mesh, t, x);
    pel_rest_triangle_setup((const double(*)[3])x, &rest);
    return rest;
}

pel_shell_hinge pel_shell_hinge_of(const pel_shell *shell, int32_t i)
{
    PEL_ASSERT_INDEX(i, shell->hinge_count);
    const int32_t *sides = shell->hinge_sides[i], h = sides[0];
    const int32_t corners[4] = {h, pel_half_edge_next(h), pel_half_edge_previous(h), pel_half_edge_previous(sides[1])};
    pel_shell_hinge hinge = {.number = i, .triangles = {h / 3, sides[1] / 3}};
    for (int k = 0; k < 4; k++)
        hinge.vertices[k] = shell->corners[corners[k] / 3][corners[k] % 3];
    hinge.stiffness = pel_shell_hinge_stiffness(shell, i);
    return hinge;
}

double pel_shell_rest_angle(const pel_shell *shell, int32_t i)
{
    PEL_ASSERT_INDEX(i, shell->hinge_count);
    pel_hinge hinge;
    double length;
    if (shell->rest_angles != NULL)
        return shell->rest_angles[i];
    find_hinge(shell->mesh, shell->hinge_sides[i], &hinge, &length);
    return hinge.rest_angle;
}

int32_t pel_model_fold_count(const pel_model *model)
{
    int32_t count = 0;
    for (int32_t b = 0; b < model->body_count; b++)
        if (model->bodies[b].shell != NULL && model->bodies[b].shell->yield_angles != NULL)
            count += model->bodies[b].shell->hinge_count;
    return count;
}

int32_t pel_model_flow_count(const pel_model *model)
{
    int32_t count = 0;
    for (int32_t b = 0; b < model->body_count; b++)
        if (model->bodies[b].shell != NULL && pel_shell_flows(model->bodies[b].shell))
            count += model->bodies[b].shell->triangle_count;
    return count;
}

pel_rest_triangle pel_shell_rest_now(const pel_shell *shell, int32_t t, const pel_flow *flows)
{
    pel_rest_triangle rest = pel_shell_rest(shell, t);
    if (!pel_shell_flows(shell) || flows == NULL)
        return rest;
    const pel_flow *flow = &flows[shell->first_flow + t];
    memcpy(rest.inverse, flow->inverse, sizeof rest.inverse);
    rest.area *= flow->growth;
    return rest;
}

double pel_shell_growth(const pel_shell *shell, double time)
{
    return pel_curve_value(shell->growth_course.keys, shell->growth_course.key_count, time);
}

void pel_shell_grow(const pel_shell *shell, double share, pel_flow *flows)
{
    for (int32_t t = 0; shell->growths != NULL && t < shell->triangle_count; t++) {
        const double scale = 1 + share * shell->growths[t];
        const pel_rest_triangle rest = pel_shell_rest(shell, t);
        pel_flow *flow = &flows[shell->first_flow + t];
        for (int i = 0; i < 3; i++)
            flow->inverse[i] = rest.inverse[i] / scale;
        flow->growth = scale * scale;
    }
}

pel_shell_fibre pel_shell_fibre_of(const pel_shell *shell, const pel_shell_region *region, int32_t i)
{
    PEL_ASSERT_INDEX(i, region->fibre_count);
    pel_shell_fibre fibre = {.triangle = pel_shell_fibre_triangle(region, i),
                             .weight = pel_shell_fibre_weight(region, i)};
    double x[3][3];
    if (region->directions != NULL) {
        memcpy(fibre.direction, region->directions[i], sizeof fibre.direction);
        return fibre;
    }
    load_corners(shell->mesh, fibre.triangle, x);
    pel_shell_fibre_direction(&region->def, (const double(*)[3])x, fibre.direction);
    return fibre;
}

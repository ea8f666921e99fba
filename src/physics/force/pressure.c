#include "force/pressure.h"

#include "base/assert.h"
#include "math/extremes.h"
#include "math/functions.h"
#include "model/state.h"
#include "pellicle/material.h"

/* a gas squeezed to less than this share of its volume at rest presses as it does there */
#define LEAST_GAS_VOLUME 1e-3

/* stretches at which a membrane is looked at, and their ratio; beyond the last one its pressure rises without end */
#define MOST_STRETCH 8.0
#define STRETCH_RATIO 1.02
enum { PEAK_ROUNDS = 40 };

/* Pa, of the given pressure */
static double outside_pressure(const pel_shell *shell, pel_span span, double load_factor)
{
    return load_factor * shell->pressure.outside.value *
           pel_curve_mean(shell->outside.keys, shell->outside.key_count, span, -HUGE_VAL, HUGE_VAL);
}

/* the volume that a target asks for, over the volume at rest */
static double target_ratio(const pel_shell *shell, pel_span span)
{
    return shell->pressure.target.value * pel_curve_value(shell->target.keys, shell->target.key_count, span.time);
}

double pel_pressure_difference(const pel_shell *shell, pel_span span, double load_factor, double volume,
                               double rest_volume)
{
    const pel_pressure_def *def = &shell->pressure;
    double ratio = volume / rest_volume, outside = outside_pressure(shell, span, load_factor);
    switch (def->kind) {
    case PEL_PRESSURE_GIVEN:
        return -outside;
    case PEL_PRESSURE_GAS:
        return def->value * (pel_pow(pel_max(ratio, LEAST_GAS_VOLUME), -def->gamma) - 1) - outside;
    case PEL_PRESSURE_VOLUME:
        return def->bulk * (target_ratio(shell, span) - ratio) - outside;
    default:
        return 0;
    }
}

double pel_pressure_slope(const pel_shell *shell, double volume, double rest_volume)
{
    const pel_pressure_def *def = &shell->pressure;
    double ratio = volume / rest_volume;
    if (def->kind == PEL_PRESSURE_GAS && ratio > LEAST_GAS_VOLUME)
        return -def->gamma * def->value * pel_pow(ratio, -def->gamma - 1) / rest_volume;
    return def->kind == PEL_PRESSURE_VOLUME ? -def->bulk / rest_volume : 0;
}

bool pel_pressure_is_conservative(const pel_body *body)
{
    const pel_shell *shell = body->shell;
    return shell->pressure.kind == PEL_PRESSURE_NONE ||
           (body->closed && shell->pressure.form == PEL_PRESSURE_CONSISTENT && shell->pressure_weights == NULL);
}

bool pel_shell_has_potential(const pel_body *body)
{
    const pel_shell *shell = body->shell;
    if (body->fluid_density > 0 && isfinite(body->fluid_level))
        return false;
    return shell == NULL || (pel_pressure_is_conservative(body) && !pel_shell_has_mode(shell, PEL_FIBRE_NORMAL));
}

/* the work of a gas from ratio 1 to this one, over pressure times volume at rest */
static double gas_work(double ratio, double gamma)
{
    if (ratio < LEAST_GAS_VOLUME)
        return gas_work(LEAST_GAS_VOLUME, gamma) - pel_pow(LEAST_GAS_VOLUME, -gamma) * (LEAST_GAS_VOLUME - ratio);
    return gamma > 1 ? (1 - pel_pow(ratio, 1 - gamma)) / (gamma - 1) : pel_ln(ratio);
}

double pel_pressure_potential(const pel_shell *shell, pel_span span, double load_factor, double volume,
                              double rest_volume)
{
    const pel_pressure_def *def = &shell->pressure;
    double ratio = volume / rest_volume;
    if (def->kind == PEL_PRESSURE_NONE)
        return 0;
    double given = outside_pressure(shell, span, load_factor) * (volume - rest_volume);
    if (def->kind == PEL_PRESSURE_GIVEN)
        return given;
    if (def->kind == PEL_PRESSURE_GAS)
        return given + def->value * rest_volume * (ratio - 1 - gas_work(ratio, def->gamma));
    double target = target_ratio(shell, span);
    return given + 0.5 * def->bulk * rest_volume * ((ratio - target) * (ratio - target) - (1 - target) * (1 - target));
}

/* The corners of a triangle of a body. The order of a shell's triangles does not depend on the history of a refined
   surface. */
static void load_triangle(const pel_model *model, int32_t body, int32_t triangle, const pel_record *position,
                          double x[3][3])
{
    const pel_shell *shell = model->bodies[body].shell;
    const int32_t *v =
        shell != NULL ? shell->corners[triangle] : model->triangles[pel_surface_triangle(model, body, triangle)];
    for (int k = 0; k < 3; k++)
        pel_vertex_position(position, v[k], x[k]);
}

double pel_body_volume(const pel_model *model, int32_t body, const pel_record *position)
{
    PEL_ASSERT_INDEX(body, model->body_count);
    double volume = 0, at[3], x[3][3];
    pel_vertex_position(position, model->bodies[body].model_index[0], at);
    const int32_t count = pel_surface_count(model, body);
    for (int32_t i = 0; i < count; i++) {
        load_triangle(model, body, i, position, x);
        volume += pel_vec3_cone_volume(at, x[0], x[1], x[2]);
    }
    return volume;
}

double pel_body_area(const pel_model *model, int32_t body, const pel_record *position)
{
    PEL_ASSERT_INDEX(body, model->body_count);
    double area = 0, x[3][3], along[3], across[3], normal[3];
    const int32_t count = pel_surface_count(model, body);
    for (int32_t i = 0; i < count; i++) {
        load_triangle(model, body, i, position, x);
        pel_vec3_subtract(x[1], x[0], along);
        pel_vec3_subtract(x[2], x[0], across);
        pel_vec3_cross(along, across, normal);
        area += 0.5 * pel_vec3_length(normal);
    }
    return area;
}

/* ---- the largest pressure ---- */

/* N/m over young times thickness of the material: derivative of the energy per area by an equal stretch in all
 * directions */
static double tension_at(const pel_membrane_material *material, double stretch)
{
    const double gradient[6] = {stretch, 0, 0, stretch, 0, 0};
    double stress[6];
    pel_membrane_density(material, gradient, stress);
    return (stress[0] + stress[3]) / (material->young * material->thickness);
}

/* N, of all triangles per tension */
static double weight_of(const pel_shell *shell)
{
    double sum = 0;
    for (int32_t t = 0; t < shell->triangle_count; t++) {
        pel_shell_sheet sheet = pel_shell_sheet_of(shell, t);
        sum += pel_shell_rest(shell, t).area * sheet.young * sheet.thickness;
    }
    return sum;
}

/* the largest, or the first maximum */
static double find_largest(const pel_model *model, int32_t body, bool is_first, double *ratio)
{
    PEL_ASSERT_INDEX(body, model->body_count);
    const pel_body *own = &model->bodies[body];
    const pel_shell *shell = own->shell;
    double best = 0, at = 1;
    *ratio = 1;
    if (shell == NULL || !shell->has_membrane || !own->closed || !(own->rest_volume > 0) || shell->region_count > 0 ||
        own->has_volumetric || own->uniform_spring != 0)
        return HUGE_VAL;
    for (double stretch = 1; stretch < MOST_STRETCH; stretch *= STRETCH_RATIO) {
        double pressure = tension_at(&shell->material, stretch) / (stretch * stretch);
        if (is_first && pressure < best)
            break;
        at = pressure > best ? stretch : at;
        best = pel_max(best, pressure);
    }
    if (at * STRETCH_RATIO * STRETCH_RATIO > MOST_STRETCH)
        return HUGE_VAL;
    double low = at / STRETCH_RATIO, high = at * STRETCH_RATIO;
    for (int i = 0; i < PEAK_ROUNDS; i++) {
        double a = low + (high - low) / 3, b = high - (high - low) / 3;
        bool is_left = tension_at(&shell->material, a) / (a * a) > tension_at(&shell->material, b) / (b * b);
        *(is_left ? &high : &low) = is_left ? b : a;
    }
    at = 0.5 * (low + high);
    *ratio = at * at * at;
    return weight_of(shell) * tension_at(&shell->material, at) / (3 * at * at * own->rest_volume);
}

double pel_pressure_largest(const pel_model *model, int32_t body, double *ratio)
{
    return find_largest(model, body, false, ratio);
}

double pel_pressure_peak(const pel_model *model, int32_t body, double *ratio)
{
    return find_largest(model, body, true, ratio);
}

double pel_pressure_given(const pel_shell *shell)
{
    double most = shell->outside.key_count > 0 ? -HUGE_VAL : -shell->pressure.outside.value;
    for (int32_t k = 0; k < shell->outside.key_count; k++)
        most = pel_max(most, -shell->pressure.outside.value * shell->outside.keys[k].value);
    return shell->pressure.kind == PEL_PRESSURE_GIVEN && shell->pressure_weights == NULL ? pel_max(most, 0) : 0;
}

#include "view/field.h"

#include "pellicle/observe.h"
#include "view/support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- values ---- */

enum { MOST_NAMES = 256 };

pel_status view_field_find(const pel_mesh *mesh, const char *name, const char *place, const pel_field **field,
                           pel_error *error)
{
    *field = pel_mesh_field(mesh, name);
    if (*field != NULL)
        return PEL_OK;
    const char *names[MOST_NAMES];
    char list[240] = "";
    size_t count = 0, length = 0;
    for (; count < MOST_NAMES && count < (size_t)mesh->field_count; ++count) {
        names[count] = mesh->fields[count].name;
        if (length < sizeof list)
            length +=
                (size_t)snprintf(list + length, sizeof list - length, "%s%s", count > 0 ? ", " : "", names[count]);
    }
    const char *nearest = pel_nearest_name(name, names, count);
    pel_fail(error, PEL_BAD_ARGUMENT, "there is no field '%s'", name);
    pel_fail_place(error, place, 0, 0);
    if (nearest != NULL)
        pel_fail_remedy(error, "did you mean '%s'?", nearest);
    else if (count > 0)
        pel_fail_remedy(error, "choose one of %s", list);
    else
        pel_fail_remedy(error, "there are no fields here; name them under output: fields: in the scene");
    return PEL_BAD_ARGUMENT;
}

static pel_status check_component(const pel_field *field, int32_t component, const char *place, pel_error *error)
{
    if (component < field->component_count)
        return PEL_OK;
    pel_fail(error, PEL_BAD_ARGUMENT, "field '%s' has no component %d", field->name, (int)component);
    pel_fail_place(error, place, 0, 0);
    if (field->component_count == 1)
        pel_fail_remedy(error, "it is a single number; leave the component out");
    else
        pel_fail_remedy(error, "its components are 0 (x) to %d", (int)field->component_count - 1);
    return PEL_BAD_ARGUMENT;
}

pel_status view_field_take(const pel_mesh *mesh, const char *name, int32_t component, const char *place, double *values,
                           double range[2], pel_error *error)
{
    const pel_field *field;
    pel_status status = view_field_find(mesh, name, place, &field, error);
    if (status == PEL_OK)
        status = check_component(field, component, place, error);
    if (status != PEL_OK)
        return status;
    int32_t count = field->component_count;
    for (int32_t v = 0; v < mesh->vertex_count; ++v) {
        const double *numbers = field->values + (size_t)v * (size_t)count;
        double value = count == 1 ? numbers[0] : component >= 0 ? numbers[component] : 0;
        for (int32_t i = 0; count > 1 && component < 0 && i < count; ++i)
            value = hypot(value, numbers[i]);
        if (!isfinite(value)) {
            pel_fail(error, PEL_BAD_FORMAT, "field '%s' is %s", name, isnan(value) ? "not a number (NaN)" : "infinite");
            pel_fail_place(error, place, 0, 0);
            pel_fail_remedy(error, "find the cause in the scene, or draw another field");
            if (error != NULL) {
                error->element = v;
                snprintf(error->element_kind, sizeof error->element_kind, "vertex");
            }
            return PEL_BAD_FORMAT;
        }
        values[v] = value;
        range[0] = fmin(range[0], value);
        range[1] = fmax(range[1], value);
    }
    return PEL_OK;
}

/* ---- scales ---- */

/* fields of meshes and of measures; fields of a simulation are in the library's table */
static const struct {
    const char *ending, *unit;
} units[] = {
    {"displacement", "m"}, {"position", "m"},    {"thickness", "m"}, {"distance", "m"}, {"velocity", "m/s"},
    {"force", "N"},        {"energy", "J"},      {"pressure", "Pa"}, {"moment", "N"},   {"energy_density", "J/m2"},
    {"stress", "N/m"},     {"stiffness", "N/m"}, {"mass", "kg"},     {"area", "m2"},    {"gaussian_curvature", "1/m2"},
    {"curvature", "1/m"},  {"volume", "m3"},
};

static const char *plain_unit(const char *name)
{
    int32_t field = pel_field_find(name);
    if (field >= 0)
        return pel_field_at(field)->unit;
    for (size_t i = 0; i < sizeof units / sizeof units[0]; ++i) {
        if (strcmp(name, units[i].ending) == 0 || view_ends_with(name, units[i].ending))
            return units[i].unit;
    }
    /* energy_spring, energy_bending, ... */
    return strncmp(name, "energy_", 7) == 0 ? "J" : "";
}

const char *view_field_unit(const char *name)
{
    static const char *const raised[][2] = {{"J/m2", "J/m²"}, {"1/m2", "1/m²"}, {"m2", "m²"}, {"m3", "m³"}};
    const char *unit = plain_unit(name);
    for (size_t i = 0; i < sizeof raised / sizeof raised[0]; ++i) {
        if (strcmp(unit, raised[i][0]) == 0)
            return raised[i][1];
    }
    return unit;
}

/* whether a prefix such as milli may stand before the unit */
static bool takes_prefix(const char *unit)
{
    static const char *const with[] = {"m", "m/s", "N", "J", "Pa", "N/m"};
    for (size_t i = 0; i < sizeof with / sizeof with[0]; ++i) {
        if (strcmp(unit, with[i]) == 0)
            return true;
    }
    return false;
}

/* the power of a thousand by which large and small numbers are written, and the unit with it */
static int choose_power(view_scale *scale, const char *unit, double largest)
{
    static const char *const prefixes[] = {"n", "µ", "m", "", "k", "M", "G"};
    static const char *const digits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    int power = largest > 0 ? (int)floor(log10(largest) / 3 + 1e-9) : 0;
    if (largest >= 0.0999 && power < 0)
        power = 0;
    if (takes_prefix(unit) && power >= -3 && power <= 3) {
        snprintf(scale->unit, sizeof scale->unit, "%s%s", prefixes[power + 3], unit);
        return power;
    }
    if (power == 0) {
        snprintf(scale->unit, sizeof scale->unit, "%s", unit);
        return power;
    }
    char number[8] = "", text[32] = "";
    snprintf(number, sizeof number, "%d", abs(3 * power) % 1000);
    for (const char *c = number; *c != '\0'; ++c)
        strncat(text, digits[*c - '0'], sizeof text - strlen(text) - 1);
    snprintf(scale->unit, sizeof scale->unit, "×10%s%s%s%s", power < 0 ? "⁻" : "", text, unit[0] != '\0' ? " " : "",
             unit);
    return power;
}

static void name_scale(view_scale *scale, const char *name, int32_t component, int32_t component_count)
{
    snprintf(scale->title, sizeof scale->title - 8, "%s", name);
    for (char *c = scale->title; *c != '\0'; ++c)
        *c = *c == '_' ? ' ' : *c;
    size_t length = strlen(scale->title);
    if (component >= 0 && component_count == 3)
        snprintf(scale->title + length, sizeof scale->title - length, " %c", "xyz"[component]);
    else if (component >= 0 && component_count > 1)
        snprintf(scale->title + length, sizeof scale->title - length, " %d", (int)component);
}

void view_scale_make(view_scale *scale, const char *name, int32_t component, int32_t component_count, const char *unit,
                     const double range[2])
{
    *scale = (view_scale){.count = 0};
    name_scale(scale, name, component, component_count);
    int power = choose_power(scale, unit != NULL ? unit : view_field_unit(name), fmax(fabs(range[0]), fabs(range[1])));
    double factor = pow(1000, -power), low = range[0] * factor, high = range[1] * factor;
    /* steps of 1, 2 or 5 times a power of ten */
    double rough = (high - low) / 5, ten = pow(10, floor(log10(rough))), part = rough / ten;
    double step = ten * (part < 1.5 ? 1 : part < 3.5 ? 2 : part < 7.5 ? 5 : 10);
    int decimals = (int)fmax(0, fmin(9, -floor(log10(step) + 1e-9)));
    for (double k = ceil(low / step - 1e-6); scale->count < VIEW_TICKS && k * step <= high + 1e-6 * step; ++k) {
        scale->at[scale->count] = fmin(fmax((k * step - low) / (high - low), 0), 1);
        /* a true minus sign; no minus before a zero */
        double value = fabs(k) < 0.5 ? 0 : k * step;
        snprintf(scale->text[scale->count++], sizeof scale->text[0], "%s%.*f", value < 0 ? "−" : "", decimals,
                 fabs(value));
    }
}

#include "stage/layer.h"

#include "base/memory.h"
#include "base/status.h"
#include "math/extremes.h"
#include "model/shell.h"

#include <math.h>

/* Without contact a tool sinks into a layer of this share of the sheet, which begins softly (tool/solid.c): a tenth
   makes the force of a gliding tool jump where a vertex comes to it. */
#define SHEET_SHARE 0.25

static bool has_membrane(const pel_body *body)
{
    return body->shell != NULL && body->shell->has_membrane && body->shell->triangle_count > 0;
}

/* N/m, E A / thickness of the whole body */
static double membrane_stiffness(const pel_body *body, double thickness)
{
    double sum = 0;
    for (int32_t t = 0; has_membrane(body) && t < body->shell->triangle_count; t++)
        sum += pel_shell_sheet_of(body->shell, t).young / body->shell->triangle_count;
    return sum * body->rest_area / thickness;
}

/* N/m, mean of Young's modulus times thickness */
static double membrane_tension(const pel_body *body)
{
    double sum = 0;
    for (int32_t t = 0; has_membrane(body) && t < body->shell->triangle_count; t++) {
        const pel_shell_sheet sheet = pel_shell_sheet_of(body->shell, t);
        sum += sheet.young * sheet.thickness / body->shell->triangle_count;
    }
    return sum;
}

/* N/m, the same of springs */
static double spring_tension(const pel_body_def *def)
{
    double given = def->spring_stiffness.value;
    return def->spring_thickness > 0 ? given * def->spring_thickness : given;
}

/* of springs that are given by their stiffness [N/m] only the product of modulus and thickness is known */
static double spring_stiffness(const pel_body_def *def, const pel_body *body, double thickness)
{
    double given = def->spring_stiffness.value;
    return (def->spring_thickness > 0 ? given : given / thickness) * body->rest_area / thickness;
}

static double mass_of(const pel_model *model, int32_t body)
{
    double mass = 0;
    for (int32_t v = model->bodies[body].slice_begin * PEL_WIDTH; v < pel_body_place_end(model, body); v++)
        mass += (double)model->mass[v];
    return mass;
}

/* m, of the sheet of a body; 0 = unknown */
static double sheet_thickness(const pel_body_def *def, const pel_body *body)
{
    double membrane = 0;
    if (has_membrane(body))
        membrane = pel_shell_sheet_of(body->shell, 0).thickness;
    return pel_max(membrane, def->spring_thickness);
}

void pel_layer_set_thickness(pel_sim *sim, int32_t body, double thickness)
{
    const pel_model *model = sim->given;
    const pel_body *own = &model->bodies[body];
    double mass = mass_of(model, body);
    double stiffness =
        pel_max(membrane_stiffness(own, thickness), spring_stiffness(&model->def.bodies[body], own, thickness));
    sim->layers[body] = (pel_contact_layer){thickness, mass > 0 ? stiffness / mass : 0};
}

double pel_body_strength(const pel_sim *sim, int32_t body)
{
    const pel_body *own = &sim->given->bodies[body];
    const pel_body_def *def = &sim->given->def.bodies[body];
    double area = own->rest_area / own->mesh->vertex_count, filling = def->volumetric_stiffness.value;
    double share = def->volumetric_by_area ? (double)def->reference_count / own->mesh->vertex_count : 1;
    double depth = def->volumetric_depth > 0 ? area : share * own->diameter;
    return pel_max(membrane_tension(own), spring_tension(def)) * sqrt(area) + filling * depth;
}

pel_status pel_layers_create(pel_sim *sim, pel_error *error)
{
    const pel_model *model = sim->given;
    sim->layers = pel_allocate((size_t)model->body_count, sizeof *sim->layers);
    if (sim->layers == NULL)
        return pel_fail_memory(error);
    for (int32_t b = 0; b < model->body_count; b++) {
        double sheet = sheet_thickness(&model->def.bodies[b], &model->bodies[b]);
        pel_layer_set_thickness(sim, b,
                                sheet > 0 ? SHEET_SHARE * sheet : PEL_LAYER_RELATIVE * model->bodies[b].diameter);
    }
    return PEL_OK;
}

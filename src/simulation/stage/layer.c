#include "stage/layer.h"

#include "base/memory.h"
#include "base/status.h"
#include "model/shell.h"

/* What gives way is the sheet, or the layer if that is thicker: E A / l [N/m] for the area of the body. Of a sheet whose
   springs are given by their stiffness [N/m] only the product of modulus and thickness is known. */
static double membrane_stiffness(const pel_body *body, double thickness)
{
    double sum = 0;
    if (body->shell == NULL || !body->shell->has_membrane)
        return 0;
    for (int32_t t = 0; t < body->shell->triangle_count; t++) {
        pel_shell_sheet sheet = pel_shell_sheet_of(body->shell, t);
        sum += sheet.young / fmax(sheet.thickness, thickness) / body->shell->triangle_count;
    }
    return sum * body->rest_area;
}

static double spring_stiffness(const pel_body_def *def, const pel_body *body, double thickness)
{
    double given = def->spring_stiffness.value;
    if (def->spring_thickness > 0)
        return given / fmax(def->spring_thickness, thickness) * body->rest_area;
    return given / (thickness * thickness) * body->rest_area;
}

static double mass_of(const pel_model *model, int32_t body)
{
    double mass = 0;
    for (int32_t v = model->bodies[body].slice_begin * PEL_WIDTH; v < pel_body_place_end(model, body); v++)
        mass += (double)model->mass[v];
    return mass;
}

pel_status pel_layers_create(pel_sim *sim, double relative_thickness, pel_error *error)
{
    const pel_model *model = sim->given;
    sim->layers = pel_allocate((size_t)model->body_count, sizeof *sim->layers);
    if (sim->layers == NULL)
        return pel_fail_memory(error);
    for (int32_t b = 0; b < model->body_count; b++) {
        const pel_body *body = &model->bodies[b];
        double thickness = relative_thickness * body->diameter, mass = mass_of(model, b);
        double stiffness = fmax(membrane_stiffness(body, thickness),
                                spring_stiffness(&model->def.bodies[b], body, thickness));
        sim->layers[b] = (pel_contact_layer){thickness, mass > 0 ? stiffness / mass : 0};
    }
    return PEL_OK;
}

#include "choice/fluid.h"

#include "math/vec3.h"
#include "mesh/figures.h"

#include <math.h>
#include <stdint.h>

/* pressures at the depth of the body, or of its size without gravity, that change its volume as a whole */
#define HEADS 1000
#define EARTH 9.81

/* closed, and not flat: a ball has 0.094 */
static pel_status check_volume(pel_scene_reader *reader, const pel_mesh *mesh, bool *has_volume)
{
    pel_mesh_report *report;
    pel_status status = pel_mesh_check(mesh, &report, reader->error);
    if (status == PEL_OK)
        *has_volume = report->closed && fabs(report->volume) > 1e-3 * report->area * sqrt(report->area);
    pel_mesh_report_destroy(report);
    return status;
}

/* a body without a material: open and flat surfaces have no volume to keep */
static pel_status keep_bare(pel_scene_reader *reader, pel_scene_value *pressure, pel_body_def *body)
{
    bool has_volume = false;
    if (pressure == NULL || !pressure->is_implied)
        return PEL_OK;
    pel_status status = check_volume(reader, body->mesh, &has_volume);
    if (status != PEL_OK)
        return status;
    if (has_volume) {
        pel_log_line(reader->log,
                     "body '%s': no material is given; it is soft tissue (5 kPa) that keeps its volume. `springs`, "
                     "`membrane` or `volume` choose another",
                     body->name);
        return PEL_OK;
    }
    body->shell.pressure = (pel_pressure_def){0};
    pel_scene_value_remove(pressure);
    return PEL_OK;
}

pel_status pel_scene_keep_fillings(pel_scene_reader *reader, pel_scene_value *root, const pel_scene *scene)
{
    pel_scene_value *value = pel_scene_value_entry(root, "bodies")->first;
    double gravity = pel_vec3_length(scene->model.gravity);
    for (int32_t b = 0; b < scene->model.body_count; b++, value = value->next) {
        /* the scene's own array, which it was built into */
        pel_body_def *body = (pel_body_def *)(uintptr_t)&scene->model.bodies[b];
        pel_status status = keep_bare(reader, pel_scene_value_entry(value, "pressure"), body);
        if (status != PEL_OK)
            return status;
        if (body->fluid_density > 0 && isfinite(body->fluid_level) && !(gravity > 0))
            pel_log_line(reader->log,
                         "fluid of '%s' presses by its weight below its level, and there is no gravity: it has no "
                         "effect. add gravity: [0, 0, -9.81]",
                         body->name);
        if (!(body->fluid_density > 0) || isfinite(body->fluid_level) || body->shell.pressure.kind != PEL_PRESSURE_NONE)
            continue;
        body->shell.pressure.kind = PEL_PRESSURE_VOLUME;
        body->shell.pressure.bulk =
            HEADS * body->fluid_density * (gravity > 0 ? gravity : EARTH) * pel_mesh_diagonal(body->mesh);
        pel_log_line(reader->log,
                     "fluid of '%s': its volume is kept with a bulk modulus of %.3g Pa, %d times the "
                     "pressure of its own depth; `pressure: { volume: ... }` chooses another",
                     body->name, body->shell.pressure.bulk, HEADS);
    }
    return PEL_OK;
}

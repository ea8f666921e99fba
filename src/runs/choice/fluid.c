#include "choice/fluid.h"

#include "math/vec3.h"
#include "mesh/figures.h"

#include <math.h>
#include <stdint.h>

/* pressures at the depth of the body, or of its size without gravity, that change its volume as a whole */
#define HEADS 1000
#define EARTH 9.81

void pel_scene_keep_fillings(pel_scene_reader *reader, const pel_scene *scene)
{
    double gravity = pel_vec3_length(scene->model.gravity);
    for (int32_t b = 0; b < scene->model.body_count; b++) {
        /* the scene's own array, which it was built into */
        pel_body_def *body = (pel_body_def *)(uintptr_t)&scene->model.bodies[b];
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
}

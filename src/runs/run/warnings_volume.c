#include "run/warnings_volume.h"

#include "choice/element.h"
#include "math/extremes.h"
#include "run/state.h"

#include <stdio.h>

/* share of the stiffness that is told */
#define MOST_ERROR 0.1
/* edges in a thickness at which the error is 7 % */
#define GOOD_COUNT 4

void pel_warnings_check_volume(pel_run_state *run, int32_t b)
{
    const pel_body_def *body = &run->scene->model.bodies[b];
    if (!body->volume.on || body->volume.element == PEL_VOLUME_SMOOTH)
        return;
    const pel_solid_shape shape = pel_solid_shape_of(body->mesh);
    double error = pel_max(pel_solid_bending_error(&shape), pel_solid_shear_error(&shape));
    if (error > MOST_ERROR || body->volume.poisson > PEL_LOCKING_POISSON)
        pel_warn_body(run, PEL_WARN_COARSE_VOLUME, b, error, 0);
}

void pel_tell_coarse_volume(const pel_warning_text *at)
{
    const pel_body_def *body = &at->run->scene->model.bodies[at->run->flagged[PEL_WARN_COARSE_VOLUME].body];
    const pel_solid_shape shape = pel_solid_shape_of(body->mesh);
    double error = pel_solid_bending_error(&shape), shear = pel_solid_shear_error(&shape);
    if (error > MOST_ERROR)
        snprintf(
            at->text, at->size,
            "body '%s' is about %.2g m thick, and the edges of its tetrahedra are %.2g m long: it bends about %.2g "
            "times too stiffly. use volume: { element: smooth } or { edge: %.2g }, or for a thin sheet a surface with "
            "a membrane of that thickness",
            body->name, shape.thickness, shape.edge, 1 + error, shape.thickness / GOOD_COUNT);
    else if (body->volume.poisson > PEL_LOCKING_POISSON)
        snprintf(
            at->text, at->size,
            "Poisson's ratio of body '%s' is %.4g: linear tetrahedra lock above %g, and bend and shear too stiffly. "
            "use volume: { element: smooth }, or a smaller ratio",
            body->name, body->volume.poisson, PEL_LOCKING_POISSON);
    else
        snprintf(
            at->text, at->size,
            "body '%s' is about %.2g m thick, and the edges of its tetrahedra are %.2g m long: where it is sheared "
            "or bent it is up to %.2g %% too stiff. use volume: { element: smooth } or { edge: %.2g }",
            body->name, shape.thickness, shape.edge, 100 * shear, shape.thickness / GOOD_COUNT);
}

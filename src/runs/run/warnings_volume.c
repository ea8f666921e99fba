#include "run/warnings_volume.h"

#include "choice/element.h"
#include "math/extremes.h"
#include "math/vec3.h"
#include "model/model.h"
#include "model/quantity.h"
#include "run/state.h"

#include <math.h>
#include <stdio.h>

/* share of the stiffness that is told */
#define MOST_ERROR 0.1
/* edges in a thickness at which the error is 7 % */
#define GOOD_COUNT 4
/* thicknesses that a slender body extends from its pins, and motion over that length that its weight would cause */
#define SLENDER 1.5
#define MOST_SAG 0.1
/* pairs of vertices and pins that are looked at */
#define MOST_PAIRS 10000000

void pel_warnings_check_volume(pel_run_state *run, int32_t b)
{
    const pel_body_def *body = &run->scene->model.bodies[b];
    if (!body->volume.on || body->volume.element == PEL_VOLUME_SMOOTH)
        return;
    const pel_solid_shape shape = pel_solid_shape_of(body->mesh);
    double error = pel_solid_bending_error(&shape);
    if (error > MOST_ERROR || body->volume.poisson > PEL_LOCKING_POISSON)
        pel_warn_body(run, PEL_WARN_COARSE_VOLUME, b, error, 0);
}

/* m: how far vertices are from the nearest pin, at most: across gravity, whose unit vector is down, and along it */
static void measure_reach(const pel_body_def *body, const double down[3], double *across, double *along)
{
    const int64_t pairs = (int64_t)body->mesh->vertex_count * body->pinned_count;
    const int32_t stride = (int32_t)(1 + pairs / MOST_PAIRS);
    *across = *along = 0;
    for (int32_t v = 0; v < body->mesh->vertex_count; v += stride) {
        double least[2] = {HUGE_VAL, HUGE_VAL};
        for (int32_t i = 0; i < body->pinned_count; i++) {
            double way[3];
            pel_vec3_subtract(body->mesh->positions[v], body->mesh->positions[body->pinned[i]], way);
            double fall = pel_vec3_dot(way, down), square = pel_vec3_squared_length(way);
            least[0] = pel_min(least[0], square - fall * fall);
            least[1] = pel_min(least[1], fabs(fall));
        }
        *across = pel_max(*across, sqrt(pel_max(least[0], 0)));
        *along = pel_max(*along, least[1]);
    }
}

/* As a round rod of the filling's modulus, held at both ends: its middle sags by w a^4 / (24 E I) at a distance a from
   them, and one that hangs stretches by half of its weight. A cantilever sags three times as far. */
bool pel_warnings_is_carried(const pel_run_state *run, int32_t b)
{
    const pel_body_def *def = &run->scene->model.bodies[b];
    const pel_body *body = &run->model->bodies[b];
    const double g = pel_vec3_length(run->scene->model.gravity);
    const double young = pel_quantity_mean(&def->volumetric_stiffness, def->mesh->vertex_count);
    if (!(def->volumetric_depth > 0 && young > 0 && g > 0) || def->pinned_count == 0 || !body->has_volume)
        return false;
    double mass = 0, across, along, down[3];
    for (int32_t i = body->slice_begin * PEL_WIDTH; i < body->slice_end * PEL_WIDTH; i++)
        mass += (double)run->model->mass[i];
    pel_vec3_scale(run->scene->model.gravity, 1 / g, down);
    measure_reach(def, down, &across, &along);
    const double thickness = 4 * fabs(body->rest_volume) / body->rest_area, weight = g * mass / fabs(body->rest_volume);
    const double slenderness = across / thickness;
    const double sag = 2.0 / 3 * weight * across * slenderness * slenderness / young;
    return (slenderness > SLENDER && sag > MOST_SAG) ||
           (along > SLENDER * thickness && 0.5 * weight * along / young > MOST_SAG);
}

void pel_tell_coarse_volume(const pel_warning_text *at)
{
    const pel_body_def *body = &at->run->scene->model.bodies[at->run->flagged[PEL_WARN_COARSE_VOLUME].body];
    const pel_solid_shape shape = pel_solid_shape_of(body->mesh);
    double error = pel_solid_bending_error(&shape);
    if (error > MOST_ERROR)
        snprintf(
            at->text, at->size,
            "body '%s' is about %.2g m thick, and the edges of its tetrahedra are %.2g m long: it bends about %.2g "
            "times too stiffly. use volume: { element: smooth } or { edge: %.2g }, or for a thin sheet a surface with "
            "a membrane of that thickness",
            body->name, shape.thickness, shape.edge, 1 + error, shape.thickness / GOOD_COUNT);
    else
        snprintf(
            at->text, at->size,
            "Poisson's ratio of body '%s' is %.4g: linear tetrahedra lock above %g, and bend and shear too stiffly. "
            "use volume: { element: smooth }, or a smaller ratio",
            body->name, body->volume.poisson, PEL_LOCKING_POISSON);
}

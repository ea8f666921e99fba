/* The score of a tear: the forces of the tools, and whether they came to the far side. */
#include "tear/score.h"

#include "base/memory.h"
#include "base/status.h"
#include "math/extremes.h"
#include "math/vec3.h"
#include "pellicle/sim_reading.h"
#include "pellicle/sim_surface.h"
#include "pellicle/tear.h"
#include "tear/forceps.h"

#include <math.h>

/* m, from the centre of the circle along its axis, and the place across it */
static double split(const double x[3], const pel_tool_def *lead, double across[3])
{
    double axis[3], way[3];
    pel_vec3_copy(lead->lead_axis, axis);
    pel_vec3_normalize(axis);
    pel_vec3_subtract(x, lead->lead_center, way);
    double along = pel_vec3_dot(way, axis);
    pel_vec3_along(way, -along, axis, across);
    return along;
}

/* whether a point beyond the centre is at the surface there, or behind it: the vertex of the far half that is nearest
   across the axis decides */
static bool is_beyond(const double *positions, int32_t count, const double point[3], const pel_tool_def *lead)
{
    double here[3], there[3], depth = split(point, lead, here), least = HUGE_VAL, bottom = -HUGE_VAL;
    for (int32_t v = 0; v < count; v++) {
        double along = split(positions + 3 * (size_t)v, lead, there), distance = pel_vec3_distance(here, there);
        if (along < 0 && distance < least) {
            least = distance;
            bottom = along;
        }
    }
    return depth <= bottom;
}

static pel_status look_beyond(const pel_sim *sim, const double point[3], const pel_tool_def *lead, bool *touches,
                              pel_error *error)
{
    double across[3];
    for (int32_t b = 0; b < pel_model_body_count(pel_sim_model(sim)) && !*touches; b++) {
        int32_t count = pel_sim_vertex_count(sim, b);
        if ((lead->body >= 0 && lead->body != b) || split(point, lead, across) >= 0)
            continue;
        double *positions = pel_allocate(3 * (size_t)count, sizeof *positions);
        if (positions == NULL)
            return pel_fail_memory(error);
        pel_sim_get_positions(sim, b, positions);
        *touches = is_beyond(positions, count, point, lead);
        pel_free(positions);
    }
    return PEL_OK;
}

pel_status pel_score_add(pel_sim *sim, pel_error *error)
{
    const pel_tool_def *lead = pel_forceps_first(&sim->def);
    pel_score_sums *sums = &sim->score;
    double force = 0, time = pel_sim_time(sim);
    bool touches = false;
    pel_status status = PEL_OK;
    if (lead == NULL)
        return PEL_OK;
    for (int32_t t = 0; status == PEL_OK && t < pel_sim_tool_count(sim); t++) {
        pel_tool_reading tool;
        pel_sim_get_tool(sim, t, &tool);
        force = pel_max(force, pel_vec3_length(tool.force));
        status = look_beyond(sim, tool.position, lead, &touches, error);
    }
    sums->touches += touches;
    if (!(force > 0))
        return status;
    sums->begin = sums->pulls > 0 ? sums->begin : time;
    sums->end = time;
    sums->pulls++;
    sums->peak = pel_max(sums->peak, force);
    sums->squares += force * force;
    return status;
}

bool pel_sim_get_score(const pel_sim *sim, pel_score *score)
{
    if (score == NULL)
        return false;
    *score = (pel_score){0};
    if (sim == NULL || !pel_sim_get_hole(sim, &score->hole))
        return false;
    const pel_score_sums *sums = &sim->score;
    score->force_peak = sums->peak;
    score->force_rms = sums->pulls > 0 ? sqrt(sums->squares / (double)sums->pulls) : 0;
    score->time = sums->end - sums->begin;
    score->touch_count = sums->touches;
    return true;
}

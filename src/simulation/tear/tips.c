#include "base/status.h"
#include "math/vec3.h"
#include "tear/growth.h"
#include "tear/survey.h"

pel_status pel_sim_tips(pel_sim *sim, int32_t body, pel_tip *tips, int32_t room, int32_t *count, pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    PEL_REFUSE_NULL(count, error);
    *count = 0;
    if (!pel_sim_has_body(sim, body) || (tips == NULL && room > 0))
        return pel_fail(error, PEL_BAD_ARGUMENT, "body %d does not exist, or tips is null", (int)body);
    bool has_notches = pel_tear_may_start(sim, body);
    if (sim->model->bodies[body].shares == NULL && !has_notches)
        return PEL_OK;
    pel_survey s;
    pel_status status = pel_survey_begin(&s, sim, body, error);
    s.has_notches = has_notches;
    pel_shell_forces_follow(sim->shells, sim->state->position);
    for (int32_t v = 0; status == PEL_OK && v < s.topology->vertex_count; v++) {
        double ahead[3];
        if (!pel_survey_is_tip(&s, v, ahead))
            continue;
        if (*count < room) {
            pel_tip *tip = &tips[*count];
            pel_survey_read(&s, v, ahead, tip);
            tip->rate = tip->release / pel_tear_thickness(sim, body, v);
        }
        ++*count;
    }
    pel_survey_end(&s);
    return status;
}

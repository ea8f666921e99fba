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
    *count = status == PEL_OK ? pel_survey_count_tips(&s) : 0;
    for (int32_t i = 0; i < *count && i < room; i++) {
        double ahead[3];
        if (pel_survey_is_tip(&s, s.tips[i], ahead))
            pel_survey_read(&s, s.tips[i], ahead, &tips[i]);
        tips[i].rate = tips[i].release / pel_tear_thickness(sim, body, s.tips[i]);
    }
    pel_survey_end(&s);
    return status;
}

#include "choice/plan.h"

#include "math/extremes.h"

#include <math.h>

/* more steps than anyone can wait for, and still exact in a double */
#define STEP_LIMIT 1e15

/* 1 .. STEP_LIMIT */
static int64_t whole_steps(double steps)
{
    return (int64_t)llround(pel_min(pel_max(steps, 1), STEP_LIMIT));
}

static double later_finite(double time, double candidate)
{
    return isfinite(candidate) && candidate > time ? candidate : time;
}

static double quantity_end(const pel_quantity *quantity)
{
    return quantity->keys != NULL && quantity->key_count > 0 ? quantity->keys[quantity->key_count - 1].time : 0;
}

static double shell_end(const pel_shell_def *shell)
{
    const pel_quantity growth = {.keys = shell->membrane.rest_keys, .key_count = shell->membrane.rest_key_count};
    double time = pel_max(quantity_end(&shell->pressure.outside), quantity_end(&shell->pressure.target));
    time = pel_max(time, quantity_end(&growth));
    for (int32_t i = 0; i < shell->anisotropy_count; i++)
        time = pel_max(time, pel_max(quantity_end(&shell->anisotropies[i].rest_length),
                                     quantity_end(&shell->anisotropies[i].activation)));
    return time;
}

static double settled_time(const pel_scene *scene)
{
    double time = 0;
    for (int32_t i = 0; i < scene->sim.load_count; i++) {
        const pel_load_def *load = &scene->sim.loads[i];
        time = later_finite(later_finite(time, load->from), load->until);
        if (load->key_count > 0)
            time = later_finite(time, load->keys[load->key_count - 1].time);
    }
    for (int32_t i = 0; i < scene->sim.tool_count; i++) {
        const pel_tool_def *tool = &scene->sim.tools[i];
        time = later_finite(time, tool->keys[tool->key_count - 1].time);
        if (tool->grasp)
            time = later_finite(later_finite(time, tool->grasp_from), tool->grasp_until);
    }
    for (int32_t i = 0; i < scene->model.body_count; i++) {
        const pel_body_def *body = &scene->model.bodies[i];
        const pel_quantity *quantities[4] = {&body->spring_stiffness, &body->spring_damping,
                                             &body->volumetric_stiffness, &body->volumetric_damping};
        for (int q = 0; q < 4; q++)
            time = later_finite(time, quantity_end(quantities[q]));
        time = later_finite(time, shell_end(&body->shell));
    }
    return time;
}

int64_t pel_run_plan_step(const pel_run_plan *plan, int64_t frame)
{
    double step = round((double)frame * plan->steps_per_frame);
    return step < (double)plan->step_total ? (int64_t)step : plan->step_total;
}

double pel_run_plan_time(const pel_run_plan *plan, int64_t frame)
{
    return (double)pel_run_plan_step(plan, frame) * plan->dt;
}

/* steps to the earliest of the ends that the scene names */
static double step_limit(const pel_scene *scene)
{
    double dt = scene->sim.solver.dt, steps = scene->duration / dt;
    if (scene->frame_limit > 0)
        steps = pel_min(steps, (double)scene->frame_limit);
    return scene->time_limit > 0 ? pel_min(steps, scene->time_limit / dt) : steps;
}

pel_run_plan pel_run_plan_make(const pel_scene *scene, int64_t max_frames)
{
    const pel_output_def *output = &scene->output;
    double dt = scene->sim.solver.dt;
    double spacing = output->every > 0 ? output->every / dt : (double)output->every_frame;
    pel_run_plan plan = {
        .dt = dt,
        .steps_per_frame = pel_min(pel_max(spacing, 1), STEP_LIMIT),
        .step_total = whole_steps(step_limit(scene)),
        .checkpoint_steps = output->checkpoint > 0 ? whole_steps(output->checkpoint / dt) : 0,
        .settled_time = settled_time(scene),
    };
    /* the division is rounded: walk to the first frame at the last step */
    plan.frame_total = (int64_t)pel_max((double)plan.step_total / plan.steps_per_frame - 2, 1);
    while (pel_run_plan_step(&plan, plan.frame_total) < plan.step_total)
        plan.frame_total++;
    plan.frame_end = max_frames > 0 && max_frames < plan.frame_total ? max_frames : plan.frame_total;
    return plan;
}

pel_disk_need pel_run_plan_need(const pel_run_plan *plan, const pel_scene *scene, int64_t frame, int64_t step)
{
    const int64_t steps = pel_run_plan_step(plan, plan->frame_end) - step;
    return (pel_disk_need){
        .frame_count = (double)(plan->frame_end + 1 - frame),
        .checkpoint_count = plan->checkpoint_steps > 0 ? (double)(steps / plan->checkpoint_steps) : 0,
        .frame_seconds = plan->steps_per_frame * plan->dt,
        .checkpoint_seconds = (double)plan->checkpoint_steps * plan->dt,
        .may_take_less = scene->rest_speed > 0 || scene->least_volume_ratio > 0 || scene->stop_at_contact ||
                         scene->sim.solver.path == PEL_PATH_ARC_LENGTH,
    };
}

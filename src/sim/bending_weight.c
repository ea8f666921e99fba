/* `weight: auto`: the paper's k_B chosen while the body shrinks or grows (pbd).

   Too large a k_B holds the surface and lets it jitter (paper B, figures 17 and 18): the volume turns round from step
   to step. Too small a one lets the surface crumple. The best is the largest for which the volume goes one way. So the
   weight falls by a factor each time the volume turns round, and rises slowly, step by step, while it does not; like
   the rate of a sender on a network it stays just below where the trouble begins, wherever that is for the mesh, the
   load and the time step. */
#include "force/pressure.h"
#include "sim/sim.h"

/* the paper's choice for all of its models */
#define FIRST_WEIGHT 0.01
#define LEAST_WEIGHT 1e-4
#define FALL 0.5
#define RISE 1.02
/* steps without a turn before the weight rises, and changes of the volume ratio that do not count */
#define CALM_STEPS 10
#define STILL 1e-7

static bool is_automatic(const pel_body *body)
{
    return body->shell != NULL && body->shell->bending != PEL_BENDING_OFF && body->shell->bending_weight < 0;
}

void pel_bending_weights_start(pel_sim *sim)
{
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_body *body = &sim->model->bodies[b];
        double given = body->shell != NULL ? body->shell->bending_weight : 0;
        sim->state->bending[b] = (pel_bending_control){is_automatic(body) ? FIRST_WEIGHT : given, 1, 0, 0};
    }
}

static void follow(pel_bending_control *control, double ratio)
{
    double change = ratio - control->volume_ratio;
    control->volume_ratio = ratio;
    if (!(fabs(change) > STILL))
        return;
    bool turned = change * control->change < 0;
    control->change = change;
    control->calm_count = turned ? 0 : control->calm_count + 1;
    if (turned)
        control->weight = fmax(control->weight * FALL, LEAST_WEIGHT);
    else if (control->calm_count >= CALM_STEPS)
        control->weight = fmin(control->weight * RISE, 1);
}

void pel_bending_weights_follow(pel_sim *sim)
{
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_body *body = &sim->model->bodies[b];
        if (sim->stepper->weighs && is_automatic(body) && body->closed)
            follow(&sim->state->bending[b], pel_body_volume(sim->model, b, sim->state->position) / body->rest_volume);
    }
}

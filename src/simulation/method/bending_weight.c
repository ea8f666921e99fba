/* `weight: auto`: the paper's k_B chosen while the body shrinks or grows (pbd).

   Too large a k_B holds the surface and lets it jitter (paper B, figures 17 and 18): the volume turns round from step
   to step. Too small a one from the start lets the surface crumple before it has a shape to fall into. So the weight
   starts at the paper's choice and only falls: slowly while the volume goes one way, by half each time it turns round,
   down to where the paper sees no effect of bending. The body shrinks further than with the first weight, along the
   folds that this one made. */
#include "method/bending_weight.h"

#include "force/pressure.h"
#include "math/extremes.h"

/* the paper's choice for all of its models */
#define FIRST_WEIGHT 0.01
#define LEAST_WEIGHT 1e-3
/* factors of a step in which the volume turns round, and of any other */
#define FALL 0.5
#define DRIFT 0.99
/* changes of the volume ratio that do not count */
#define STILL 1e-7

static bool is_automatic(const pel_body *body)
{
    return body->shell != NULL && pel_bending_is_on(body->shell->bending) && body->shell->bending_weight < 0;
}

void pel_bending_weights_start(pel_sim *sim)
{
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_body *body = &sim->model->bodies[b];
        double given = body->shell != NULL ? body->shell->bending_weight : 0;
        sim->state->bending[b] = (pel_bending_control){is_automatic(body) ? FIRST_WEIGHT : given, 1, 0};
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
    control->weight = pel_max(control->weight * (turned ? FALL : DRIFT), LEAST_WEIGHT);
}

void pel_bending_weights_follow(pel_sim *sim)
{
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_body *body = &sim->model->bodies[b];
        if (sim->stepper->weighs && is_automatic(body) && body->has_volume)
            follow(&sim->state->bending[b], pel_body_volume(sim->model, b, sim->state->position) / body->rest_volume);
    }
}

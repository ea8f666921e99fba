/* of the cube of the trace of the inertia: below it the body is a line */
#include "stage/rigid_motion.h"

#include "base/assert.h"
#include "math/pose.h"
#include "math/vec3.h"
#include "rigid/inertia.h"

#define LEAST_INERTIA 1e-12

void pel_rigid_apply(const double m[3][3], const double x[3], double y[3])
{
    pel_vec3_set(y, pel_vec3_dot(m[0], x), pel_vec3_dot(m[1], x), pel_vec3_dot(m[2], x));
}

static bool is_free(const pel_sim *sim, int32_t body)
{
    const pel_model *model = sim->model;
    for (int32_t v = model->bodies[body].slice_begin * PEL_WIDTH; v < pel_body_place_end(model, body); v++)
        if (model->mesh_vertex[v] >= 0 && (!(model->inverse_mass[v] > 0) || (sim->held != NULL && sim->held[v])))
            return false;
    return true;
}

/* center, velocity and mass */
static double sum_momentum(const pel_sim *sim, int32_t body, const pel_record *position, const pel_record *velocity,
                           pel_rigid_motion *motion)
{
    const pel_model *model = sim->model;
    double sum = 0, x[3], v[3];
    for (int32_t i = model->bodies[body].slice_begin * PEL_WIDTH; i < pel_body_place_end(model, body); i++) {
        double mass = model->mesh_vertex[i] >= 0 ? (double)model->mass[i] : 0;
        if (!(mass > 0))
            continue;
        pel_vertex_position(position, i, x);
        pel_vertex_position(velocity, i, v);
        pel_vec3_along(motion->center, mass, x, motion->center);
        pel_vec3_along(motion->velocity, mass, v, motion->velocity);
        sum += mass;
    }
    pel_vec3_scale(motion->center, 1 / sum, motion->center);
    pel_vec3_scale(motion->velocity, 1 / sum, motion->velocity);
    return sum;
}

/* of a rigid body: its state has all of it */
static pel_rigid_motion motion_of_rigid(const pel_sim *sim, int32_t body, const pel_rigid_state *states)
{
    static const double axes[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const pel_rigid_shape *shape = sim->model->bodies[body].rigid;
    const pel_rigid_state *state = &states[body];
    pel_rigid_motion motion = {.is_free = is_free(sim, body)};
    pel_rigid_center(shape, state, motion.center, motion.velocity, motion.spin, motion.momentum);
    if (!motion.is_free) {
        pel_vec3_set(motion.velocity, 0, 0, 0);
        pel_vec3_set(motion.spin, 0, 0, 0);
        pel_vec3_set(motion.momentum, 0, 0, 0);
        return motion;
    }
    motion.inverse_mass = shape->inverse_mass;
    for (int k = 0; k < 3; k++) {
        double own[3], turned[3];
        pel_rotate_back(state->rotation, axes[k], own);
        pel_rigid_apply(shape->inverse_inertia, own, turned);
        pel_rotate(state->rotation, turned, motion.inverse_inertia[k]);
    }
    return motion;
}

pel_rigid_motion pel_rigid_motion_of(const pel_sim *sim, int32_t body, const pel_record *position,
                                     const pel_record *velocity)
{
    PEL_ASSERT_INDEX(body, sim->model->body_count);
    const pel_model *model = sim->model;
    if (model->bodies[body].rigid != NULL)
        return motion_of_rigid(sim, body,
                               position == sim->state->position ? sim->state->rigids : sim->state->rigids_before);
    pel_rigid_motion motion = {.is_free = is_free(sim, body)};
    double inertia[3][3] = {{0}}, x[3], v[3], turn[3];
    double sum = sum_momentum(sim, body, position, velocity, &motion);
    if (!motion.is_free) {
        pel_vec3_set(motion.velocity, 0, 0, 0);
        return motion;
    }
    motion.inverse_mass = 1 / sum;
    for (int32_t i = model->bodies[body].slice_begin * PEL_WIDTH; i < pel_body_place_end(model, body); i++) {
        double mass = model->mesh_vertex[i] >= 0 ? (double)model->mass[i] : 0;
        if (!(mass > 0))
            continue;
        pel_vertex_position(position, i, x);
        pel_vertex_position(velocity, i, v);
        pel_vec3_subtract(x, motion.center, x);
        pel_vec3_cross(x, v, turn);
        pel_vec3_along(motion.momentum, mass, turn, motion.momentum);
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++)
                inertia[a][b] += mass * ((a == b ? pel_vec3_squared_length(x) : 0) - x[a] * x[b]);
    }
    pel_inertia_invert_above((const double(*)[3])inertia, LEAST_INERTIA, motion.inverse_inertia);
    pel_rigid_apply((const double(*)[3])motion.inverse_inertia, motion.momentum, motion.spin);
    return motion;
}

#include "run/swing.h"

#include "math/functions.h"
#include "math/record.h"
#include "math/vec3.h"
#include "model/model.h"
#include "run/state.h"
#include "stage/stepper.h"

#include <math.h>

/* rad in a step: 11 steps in a vibration, which the midpoint rule makes 3 % too slow */
#define MOST_ANGLE 0.586
/* Steps from which a body that falls, too, has a smaller ratio than a vibration of this angle. Before that a run shows
   no vibration, but what a sudden load does in it. */
enum { LEAST_STEPS = 7, FIRST_STEPS = 2 };
/* of the supplied energy: a start with more of it is no state of rest */
#define REST_SHARE 0.1
/* first steps of implicit Euler store this many times the energy of those of the midpoint rule */
#define EULER_TIMES 4

/* surfaces, or a tool that is no pin */
static bool is_touched(const pel_run_state *run)
{
    pel_contact_statistics contact;
    pel_sim_get_contact_statistics(run->sim, &contact);
    bool any = contact.contacts > 0;
    for (int32_t t = 0; t < pel_sim_tool_count(run->sim); t++) {
        pel_tool_reading reading;
        bool is_pin = t < run->scene->sim.tool_count && run->scene->sim.tools[t].shape == PEL_TOOL_SUPPORT;
        pel_sim_get_tool(run->sim, t, &reading);
        any |= !is_pin && pel_vec3_length(reading.force) > 0;
    }
    return any;
}

/* Rad in a step, after one of the first: of a body at rest on which a load acts from the start,
   U/K = tan(w t / 2)^2. */
static double sudden_angle(const pel_run_state *run, int32_t substeps)
{
    const pel_sim_def *def = &run->scene->sim;
    pel_sim_ledger ledger;
    bool is_sudden = def->tool_count == 0;
    for (int32_t l = 0; l < def->load_count; l++)
        is_sudden &= def->loads[l].key_count == 0;
    for (int32_t b = 0; b < run->scene->model.body_count; b++)
        is_sudden &= run->scene->model.bodies[b].shell.pressure.outside.key_count == 0;
    if (!is_sudden)
        return 0;
    pel_sim_get_ledger(run->sim, &ledger);
    const double stored = ledger.elastic - ledger.elastic_start;
    if (!(stored > 0) || !(ledger.kinetic > 0) || ledger.elastic_start > REST_SHARE * ledger.supplied)
        return 0;
    const double angle = 2 * pel_atan2(sqrt(stored / EULER_TIMES), sqrt(ledger.kinetic));
    return angle / ((double)run->totals.swing.step_count * substeps);
}

static int32_t substeps_of(const pel_run_state *run)
{
    pel_solver_reading solver;
    pel_sim_get_solver(run->sim, &solver);
    return solver.most_substeps > 1 ? solver.most_substeps : 1;
}

void pel_swing_add(pel_run_state *run)
{
    pel_swing *swing = &run->totals.swing;
    const pel_sim *sim = run->sim;
    const int32_t place_count = sim->model->vertex_count;
    swing->vertex_count = swing->step_count == 0 ? place_count : swing->vertex_count;
    swing->is_over |= swing->vertex_count != place_count || sim->state->velocity == NULL || is_touched(run);
    if (swing->is_over)
        return;
    swing->step_count++;
    if (swing->step_count <= FIRST_STEPS)
        swing->sudden = pel_max(swing->sudden, sudden_angle(run, substeps_of(run)));
    for (int32_t i = 0; i < PEL_SWING_VERTICES; i++) {
        const int32_t v = (int32_t)((int64_t)i * place_count / PEL_SWING_VERTICES);
        double x[3], rest[3], way[3];
        pel_vertex_position(sim->state->position, v, x);
        pel_vertex_position(sim->model->rest, v, rest);
        pel_vertex_position(sim->state->velocity, v, way);
        pel_vec3_subtract(x, rest, x);
        pel_vec3_add(swing->sums[i], x, swing->sums[i]);
        swing->squares += pel_vec3_dot(x, x);
        swing->ways += pel_vec3_dot(way, way) * run->plan.dt * run->plan.dt;
    }
}

/* rad in a step or substep, by the sums */
static double angle_of(const pel_swing *swing, int32_t substeps)
{
    double variance = swing->squares;
    for (int32_t i = 0; i < PEL_SWING_VERTICES; i++)
        variance -= pel_vec3_dot(swing->sums[i], swing->sums[i]) / (double)swing->step_count;
    return variance > 0 ? sqrt(swing->ways / variance) / substeps : 0;
}

/* the methods follow a body that turns */
static bool turns(const pel_run_state *run)
{
    bool any = false;
    for (int32_t b = 0; b < run->scene->model.body_count; b++)
        any |= pel_vec3_length(run->scene->model.bodies[b].angular_velocity) > 0;
    return any;
}

double pel_swing_angle(const pel_run_state *run)
{
    const pel_swing *swing = &run->totals.swing;
    if (swing->is_over || swing->step_count == 0 || turns(run))
        return 0;
    double angle = swing->step_count < LEAST_STEPS ? swing->sudden : angle_of(swing, substeps_of(run));
    return angle > MOST_ANGLE ? angle : 0;
}

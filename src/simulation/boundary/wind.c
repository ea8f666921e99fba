/* Each triangle is a flat plate (include/pellicle/wind.h). Its force on the air's relative velocity w has a slope of at
   most density A max(drag, lift) (c + |w|) / 2, exact where the wind is across it. Half of that slope is taken as a
   drag d of the change of the velocity in the step, as in the trapezoidal rule: of second order for a plate across the
   wind, stable for any step, and the balance of a steady motion is that of F alone. */
#include "boundary/wind.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "boundary/gusts.h"
#include "boundary/loads.h"
#include "math/extremes.h"
#include "model/quantity.h"
#include "stage/surface_view.h"

#include <math.h>
#include <string.h>

struct pel_wind {
    pel_wind_def def; /* keys are copied */
    pel_key *keys;
    pel_gusts gusts;
    double factor;    /* of the step */
    pel_record *air;  /* (vertex_count) see pel_wind_forces */
    pel_record *flow; /* (vertex_count) m/s, velocity of the air at the vertices */
    double work;      /* J, in the substeps of the step */
};

static void flow_at(const pel_wind *wind, const double x[3], double time, double flow[3])
{
    pel_vec3_scale(wind->def.velocity, wind->factor, flow);
    pel_gusts_add(&wind->gusts, wind->def.velocity, x, time, wind->factor, flow);
}

/* ---- forces ---- */

/* N on a plate of an area vector in a relative wind, and its slope, see above */
static double plate_force(const pel_wind_def *def, const double area[3], const double w[3], bool closed,
                          double force[3])
{
    double size = pel_vec3_length(area), speed = pel_vec3_length(w);
    pel_vec3_set(force, 0, 0, 0);
    if (!(size > 0) || !(speed > 0))
        return 0;
    double along = pel_vec3_dot(area, w) / size, across = fabs(along);
    /* the outside of a closed body that faces away from the wind */
    if (closed && along > 0)
        return 0;
    double half = 0.5 * def->density * size * across;
    pel_vec3_scale(area, half * def->lift * speed * (along < 0 ? -1 : 1) / size, force);
    pel_vec3_along(force, half * (def->drag - def->lift) * across / speed, w, force);
    return 0.5 * def->density * size * pel_max(def->drag, def->lift) * (across + speed);
}

/* the mean over the corners of the velocity of the air less that of the triangle, and its area vector */
static void find_plate(const pel_sim *sim, const int32_t v[3], double w[3], double area[3])
{
    const pel_state *state = sim->state;
    const pel_wind *wind = sim->loads->wind;
    double x[3][3], a[3], b[3], c[3];
    pel_vec3_set(w, 0, 0, 0);
    for (int k = 0; k < 3; k++) {
        pel_vertex_position(state->position, v[k], x[k]);
        for (int i = 0; i < 3; i++)
            w[i] += ((double)wind->flow[v[k]][i] - (double)state->velocity[v[k]][i]) / 3;
    }
    pel_vec3_subtract(x[1], x[0], a);
    pel_vec3_subtract(x[2], x[0], b);
    pel_vec3_cross(a, b, c);
    pel_vec3_scale(c, 0.5, area);
}

/* adds forces to the vertices of a body, and half of the slopes as a fourth number */
static void add_body(const pel_sim *sim, int32_t b, pel_record *air)
{
    PEL_ASSERT_INDEX(b, sim->model->body_count);
    for (int32_t i = 0; i < pel_surface_count(sim->model, b); i++) {
        const int32_t *v = pel_surface_corners(sim, b, i);
        double w[3], area[3], force[3];
        find_plate(sim, v, w, area);
        double slope = plate_force(&sim->loads->wind->def, area, w, sim->model->bodies[b].closed, force);
        const pel_record third = {(pel_real)(force[0] / 3), (pel_real)(force[1] / 3), (pel_real)(force[2] / 3),
                                  (pel_real)(slope / 6)};
        for (int k = 0; k < 3; k++)
            air[v[k]] += third;
    }
}

static void find_flow(const pel_sim *sim, pel_span span)
{
    pel_wind *wind = sim->loads->wind;
    wind->factor =
        wind->def.key_count > 0 ? pel_curve_mean(wind->keys, wind->def.key_count, span, -HUGE_VAL, HUGE_VAL) : 1;
    double time = span.time + 0.5 * (span.ahead - span.back);
    for (int32_t v = 0; v < sim->model->vertex_count; v++) {
        double x[3], flow[3];
        pel_vertex_position(sim->state->position, v, x);
        flow_at(wind, x, time, flow);
        wind->flow[v] = (pel_record){(pel_real)flow[0], (pel_real)flow[1], (pel_real)flow[2], 0};
    }
}

void pel_wind_begin(pel_sim *sim)
{
    pel_wind *wind = sim->loads->wind;
    if (wind == NULL)
        return;
    wind->work = 0;
    find_flow(sim, (pel_span){.time = pel_sim_time(sim), .ahead = sim->step.dt});
    memset(wind->air, 0, (size_t)sim->model->vertex_count * sizeof *wind->air);
    for (int32_t b = 0; b < sim->model->body_count; b++)
        add_body(sim, b, wind->air);
    for (int32_t v = 0; v < sim->model->vertex_count; v++) {
        pel_real drag = wind->air[v][3];
        wind->air[v] += drag * pel_record_with(sim->state->velocity[v], 0);
        wind->air[v][3] = drag;
    }
}

const pel_record *pel_wind_forces(const pel_sim *sim)
{
    return sim->loads->wind != NULL ? sim->loads->wind->air : NULL;
}

void pel_wind_add(const pel_sim *sim, pel_record *force)
{
    const pel_record *air = pel_wind_forces(sim);
    for (int32_t v = 0; air != NULL && v < sim->model->vertex_count; v++)
        force[v] += pel_record_with(air[v], 0);
}

void pel_wind_add_present(const pel_sim *sim, pel_record *force)
{
    if (sim->loads->wind == NULL)
        return;
    find_flow(sim, pel_instant(pel_sim_time(sim)));
    for (int32_t b = 0; b < sim->model->body_count; b++)
        add_body(sim, b, force);
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        force[v][3] = 0;
}

void pel_wind_apply(pel_sim *sim, double ratio)
{
    const pel_record *air = pel_wind_forces(sim);
    pel_state *state = sim->state;
    const pel_real dt = (pel_real)sim->step.dt, way = (pel_real)ratio;
    for (int32_t v = 0; air != NULL && v < sim->model->vertex_count; v++) {
        pel_real w = sim->model->inverse_mass[v], drag = air[v][3];
        if (!(w > 0))
            continue;
        pel_record before = pel_record_with(state->velocity[v], 0);
        pel_record change = pel_record_with(state->velocity_next[v], 0) - before;
        pel_record force = pel_record_with(air[v], 0) - drag * before;
        pel_record after = (change + dt * w * force) * (1 / (1 + dt * w * drag));
        state->velocity_next[v] += after - change;
        state->position_next[v] += way * (after - change);
    }
}

/* J, from some positions to the new ones in a time h */
static double work_between(const pel_sim *sim, const pel_record *start, double h)
{
    const pel_record *air = pel_wind_forces(sim);
    double work = 0;
    for (int32_t v = 0; air != NULL && v < sim->model->vertex_count; v++)
        for (int i = 0; i < 3; i++) {
            double way = (double)sim->state->position_next[v][i] - (double)start[v][i];
            work += ((double)air[v][i] - (double)air[v][3] * way / h) * way;
        }
    return work;
}

void pel_wind_tally(pel_sim *sim, const pel_record *start, double h)
{
    if (sim->loads->wind != NULL)
        sim->loads->wind->work += work_between(sim, start, h);
}

/* J, that a substep of length h overstates by its velocity v at the end in place of the mean with that at its start:
   the sum over the substeps of (F - d v) (v - v') h / 2 */
static double work_beyond(const pel_sim *sim, double h)
{
    const pel_record *air = pel_wind_forces(sim);
    const pel_state *state = sim->state;
    double work = 0;
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        for (int i = 0; i < 3; i++) {
            double before = (double)state->velocity[v][i], after = (double)state->velocity_next[v][i];
            work += 0.5 * h * (double)air[v][i] * (after - before);
            work -= 0.25 * h * (double)air[v][3] * (after * after - before * before);
        }
    return work;
}

/* J: velocities of the leapfrog belong to the middles of steps, forces to the time between two of them */
static double work_of_kick(const pel_sim *sim)
{
    const pel_record *air = pel_wind_forces(sim);
    double work = 0;
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        for (int i = 0; i < 3; i++) {
            double before = (double)sim->state->velocity[v][i], after = (double)sim->state->velocity_next[v][i];
            work += ((double)air[v][i] - (double)air[v][3] * after) * 0.5 * (before + after);
        }
    return sim->step.dt * work;
}

double pel_wind_work(const pel_sim *sim, double h)
{
    if (sim->loads->wind == NULL)
        return 0;
    if (pel_sim_is_explicit(sim) && sim->solver.symplectic)
        return work_of_kick(sim);
    if (!pel_sim_projects_elements(sim))
        return work_between(sim, sim->state->position, sim->step.dt);
    return sim->loads->wind->work - (h > 0 ? work_beyond(sim, h) : 0);
}

/* ---- creation ---- */

static pel_status check_keys(const pel_wind_def *def, pel_error *error)
{
    if (def->key_count < 0 || (def->key_count > 0 && def->keys == NULL))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give keys, or a count of 0", "keys of the wind are null");
    if (!pel_keys_are_ordered(def->keys, def->key_count))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give keys with increasing times",
                          "keys of the wind are not finite or not in order");
    return PEL_OK;
}

static bool is_number(double number)
{
    return number >= 0 && isfinite(number);
}

static pel_status check(const pel_sim *sim, const pel_wind_def *def, pel_error *error)
{
    const pel_gust_def *gusts = &def->gusts;
    if (!is_number(def->density))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give a density above 0, or 0 for no air",
                          "density of the wind is %g", def->density);
    if (!(def->density > 0))
        return PEL_OK;
    for (int i = 0; i < 3; i++)
        if (!isfinite(def->velocity[i]))
            return pel_refuse(error, PEL_BAD_ARGUMENT, "give three finite numbers", "velocity of the wind is %g",
                              def->velocity[i]);
    if (!is_number(def->drag) || !is_number(def->lift))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give finite coefficients of at least 0",
                          "drag and lift of the wind are %g and %g", def->drag, def->lift);
    if (!is_number(gusts->speed) || (gusts->speed > 0 && !(gusts->length > 0 && isfinite(gusts->length))))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "give a speed and a length above 0, or the speed 0 for no gusts",
                          "gusts have the speed %g and the length %g", gusts->speed, gusts->length);
    if (!pel_sim_has_velocity(sim))
        return pel_refuse(error, PEL_BAD_ARGUMENT,
                          "use method implicit or xpbd, or loads and pressure for a steady force",
                          "wind acts by velocities, which this method does not have");
    return check_keys(def, error);
}

pel_status pel_wind_create(pel_sim *sim, const pel_wind_def *def, pel_error *error)
{
    size_t count = (size_t)sim->model->vertex_count;
    pel_status status = check(sim, def, error);
    if (status != PEL_OK || !(def->density > 0))
        return status;
    pel_wind *wind = sim->loads->wind = pel_allocate(1, sizeof *wind);
    if (wind == NULL || !PEL_ALLOCATE_ALL(PEL_ROOM_ALIGNED(wind->air, count), PEL_ROOM_ALIGNED(wind->flow, count),
                                          PEL_ROOM_IF(def->key_count > 0, wind->keys, def->key_count)))
        return pel_fail_memory(error);
    wind->def = *def;
    if (def->key_count > 0)
        memcpy(wind->keys, def->keys, (size_t)def->key_count * sizeof *wind->keys);
    wind->def.keys = wind->keys;
    pel_gusts_make(&def->gusts, &wind->gusts);
    return PEL_OK;
}

void pel_wind_destroy(pel_sim *sim)
{
    pel_wind *wind = sim->loads->wind;
    if (wind == NULL)
        return;
    PEL_FREE_ALL(wind->air, wind->flow, wind->keys);
    pel_free(wind);
}

pel_status pel_wind_refuse(const pel_sim *sim, const char *what, pel_error *error)
{
    if (sim->loads->wind == NULL)
        return PEL_OK;
    return pel_refuse(error, PEL_BAD_ARGUMENT, "leave the wind out", "%s does not support wind", what);
}

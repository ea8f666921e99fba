

#include "pellicle/haptic.h"
#include "base/memory.h"
#include "base/status.h"
#include "haptic/exchange.h"
#include "haptic/local_model.h"
#include "haptic/loop.h"
#include "haptic/proxy.h"
#include "math/extremes.h"
#include "tool/tool.h"

#include <string.h>

enum { HAPTIC_COOKIE = 0x68617074 };
/* Hz */
#define LEAST_RATE 100.0
#define MOST_RATE 10000.0
/* of the stiffest passive coupling: the rest of the device's damping is a reserve for changes of the local model */
#define AUTOMATIC_SHARE 0.5
/* relative to the stiffness of the coupling: initial stiffness of a surface, and bounds of the estimate */
#define ASSUMED_STIFFNESS 0.01
#define LEAST_STIFFNESS 1e-4
#define MOST_STIFFNESS 1e3

/* message of the loop to the simulation */
typedef struct loop_record {
    pel_haptic_reading reading;
    double rotation[4]; /* of the device */
    bool has_pose;      /* there was an update with a position */
} loop_record;

struct pel_haptic {
    /* fixed */
    pel_sim *sim;
    int32_t tool;
    char tool_name[PEL_NAME_SIZE];
    double rate, reach;

    /* the simulation's side */
    int64_t model_step; /* steps when the last model was taken; -1 = none yet */
    pel_local_model last;
    pel_surface_estimate estimate;
    pel_loop *loop; /* null = none runs */
    pel_haptic_device device;

    /* the loop's side */
    pel_proxy proxy;
    double rotation[4];
    bool has_pose;

    /* between them: `models` goes to the loop, `records` comes from it */
    pel_exchange model_exchange, record_exchange;
    pel_local_model models[PEL_EXCHANGE_SLOTS];
    loop_record records[PEL_EXCHANGE_SLOTS];
};

pel_haptic_def pel_haptic_def_default(void)
{
    return (pel_haptic_def){.rate = 1000,
                            .device_damping = 0.5,
                            .energy_budget = 2e-5,
                            .passivity_control = true,
                            .max_force = 4,
                            .max_force_rate = 4000,
                            .cookie = HAPTIC_COOKIE};
}

double pel_haptic_passive_stiffness(double device_damping, double coupling_damping, double rate)
{
    return pel_max(2 * (device_damping - coupling_damping) * rate, 0);
}

/* ---- creation ---- */

static pel_status fail_number(pel_error *error, const char *name, double value, const char *remedy)
{
    return pel_refuse(error, PEL_BAD_ARGUMENT, remedy, "%s is %g", name, value);
}

static pel_status check_numbers(const pel_haptic_def *def, pel_error *error)
{
    if (!(def->rate >= LEAST_RATE && def->rate <= MOST_RATE))
        return fail_number(error, "rate", def->rate, "use 100 to 10000 Hz");
    const struct {
        const char *name;
        double value;
        bool may_be_zero;
    } numbers[] = {{"reach", def->reach, true},
                   {"device_damping", def->device_damping, false},
                   {"coupling_stiffness", def->coupling_stiffness, true},
                   {"coupling_damping", def->coupling_damping, true},
                   {"surface_stiffness", def->surface_stiffness, true},
                   {"energy_budget", def->energy_budget, true},
                   {"max_force", def->max_force, false},
                   {"max_force_rate", def->max_force_rate, false}};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        if (!isfinite(numbers[i].value) || numbers[i].value < 0 || (numbers[i].value <= 0 && !numbers[i].may_be_zero))
            return fail_number(error, numbers[i].name, numbers[i].value,
                               numbers[i].may_be_zero ? "use a finite number, at least 0"
                                                      : "use a finite number above 0");
    return PEL_OK;
}

static pel_status check_tool(const pel_haptic_def *def, pel_error *error)
{
    if (def->tool < 0 || def->tool >= def->sim->tools->count) {
        pel_fail(error, PEL_BAD_ARGUMENT, "tool %d does not exist", (int)def->tool);
        pel_fail_remedy(error, "add a tool that presses to the scene; it has %d tools", (int)def->sim->tools->count);
        return PEL_BAD_ARGUMENT;
    }
    const pel_tool *tool = &def->sim->tools->items[def->tool];
    if (tool->support == NULL)
        return PEL_OK;
    return pel_refuse(error, PEL_BAD_ARGUMENT, "use a sphere, capsule, box or mesh",
                      "tool '%s' is a support and has no surface", tool->name);
}

/* fills in the numbers that are automatic */
static pel_status resolve_coupling(pel_haptic_def *def, pel_error *error)
{
    double most = pel_haptic_passive_stiffness(def->device_damping, def->coupling_damping, def->rate);
    if (!(most > 0))
        return fail_number(error, "coupling_damping", def->coupling_damping, "use less than device_damping");
    if (def->coupling_stiffness > most) {
        pel_fail(error, PEL_UNSTABLE, "coupling_stiffness %g N/m can give energy to a device of damping %g N s/m",
                 def->coupling_stiffness, def->device_damping);
        pel_fail_remedy(error, "use at most %g N/m, or a higher rate", most);
        return PEL_UNSTABLE;
    }
    if (!(def->coupling_stiffness > 0))
        def->coupling_stiffness = AUTOMATIC_SHARE * most;
    if (!(def->surface_stiffness > 0))
        def->surface_stiffness = ASSUMED_STIFFNESS * def->coupling_stiffness;
    if (!(def->reach > 0))
        def->reach = 0.5 * pel_tool_size(&def->sim->tools->items[def->tool]) / 3;
    return PEL_OK;
}

static void fill(pel_haptic *haptic, const pel_haptic_def *def)
{
    haptic->sim = def->sim;
    haptic->tool = def->tool;
    memcpy(haptic->tool_name, def->sim->tools->items[def->tool].name, sizeof haptic->tool_name);
    haptic->rate = def->rate;
    haptic->reach = def->reach;
    haptic->model_step = -1;
    haptic->estimate = (pel_surface_estimate){.stiffness = def->surface_stiffness,
                                              .least = LEAST_STIFFNESS * def->coupling_stiffness,
                                              .most = MOST_STIFFNESS * def->coupling_stiffness};
    pel_proxy_create(&haptic->proxy, def);
    haptic->rotation[3] = 1;
    pel_exchange_create(&haptic->model_exchange);
    pel_exchange_create(&haptic->record_exchange);
}

pel_status pel_haptic_create(const pel_haptic_def *def, pel_haptic **haptic, pel_error *error)
{
    PEL_REFUSE_NULL(haptic, error);
    *haptic = NULL;
    PEL_REFUSE_NULL(def, error);
    if (def->cookie != HAPTIC_COOKIE)
        return pel_fail(error, PEL_BAD_ARGUMENT, "the haptic def was not made by pel_haptic_def_default");
    PEL_REFUSE_NULL(def->sim, error);
    pel_haptic_def resolved = *def;
    pel_status status = check_numbers(def, error);
    if (status == PEL_OK)
        status = check_tool(def, error);
    if (status == PEL_OK)
        status = resolve_coupling(&resolved, error);
    if (status != PEL_OK)
        return status;
    pel_haptic *made = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    fill(made, &resolved);
    *haptic = made;
    return PEL_OK;
}

void pel_haptic_destroy(pel_haptic *haptic)
{
    if (haptic == NULL)
        return;
    pel_haptic_stop(haptic);
    pel_free(haptic);
}

/* ---- the simulation's side ---- */

/* the newest record of the loop */
static const loop_record *newest_record(pel_haptic *haptic)
{
    pel_exchange_take(&haptic->record_exchange);
    return &haptic->records[haptic->record_exchange.reader];
}

static void send_model(pel_haptic *haptic)
{
    pel_local_model *model = &haptic->models[haptic->model_exchange.writer];
    pel_local_model_take(haptic->sim, haptic->tool, haptic->reach, haptic->model_step < 0 ? NULL : &haptic->last,
                         &haptic->estimate, model);
    haptic->last = *model;
    haptic->model_step = pel_sim_step_count(haptic->sim);
    pel_exchange_give(&haptic->model_exchange);
}

/* the proxy's place, at most the reach from where the tool is */
static void tool_target(const pel_haptic *haptic, const double proxy[3], double target[3])
{
    const double *at = haptic->sim->tools->items[haptic->tool].pose.position;
    double way[3];
    pel_vec3_subtract(proxy, at, way);
    double length = pel_vec3_length(way);
    pel_vec3_along(at, length > haptic->reach ? haptic->reach / length : 1, way, target);
}

pel_status pel_haptic_sync(pel_haptic *haptic, pel_error *error)
{
    PEL_REFUSE_NULL(haptic, error);
    pel_sim *sim = haptic->sim;
    if (haptic->tool >= sim->tools->count || strcmp(sim->tools->items[haptic->tool].name, haptic->tool_name) != 0)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "create a new haptic loop when tools change",
                          "tool '%s' was removed", haptic->tool_name);
    if (haptic->model_step != pel_sim_step_count(sim))
        send_model(haptic);
    const loop_record *record = newest_record(haptic);
    if (!record->has_pose)
        return PEL_OK;
    double target[3];
    tool_target(haptic, record->reading.proxy, target);
    return pel_sim_set_tool_pose(sim, haptic->tool, target, record->rotation, error);
}

void pel_haptic_get(pel_haptic *haptic, pel_haptic_reading *reading)
{
    if (reading == NULL)
        return;
    memset(reading, 0, sizeof *reading);
    if (haptic != NULL)
        *reading = newest_record(haptic)->reading;
}

/* ---- the loop's side ---- */

static void send_record(pel_haptic *haptic, const pel_haptic_latency *latency)
{
    const pel_proxy *proxy = &haptic->proxy;
    loop_record *record = &haptic->records[haptic->record_exchange.writer];
    pel_haptic_reading *reading = &record->reading;
    *reading = (pel_haptic_reading){.update_count = proxy->update_count,
                                    .stiffness = proxy->model.stiffness,
                                    .coupling_stiffness = proxy->coupling_stiffness,
                                    .touches = proxy->touches,
                                    .energy = proxy->energy,
                                    .most_energy = proxy->most_energy,
                                    .withdrawn_count = proxy->withdrawn_count,
                                    .limited_count = proxy->limited_count,
                                    .lost_count = proxy->lost_count,
                                    .plane_count = proxy->model.plane_count};
    pel_vec3_copy(proxy->device, reading->device);
    pel_vec3_copy(proxy->proxy, reading->proxy);
    pel_vec3_copy(proxy->force, reading->force);
    memcpy(reading->planes, proxy->model.planes, sizeof reading->planes);
    if (latency != NULL)
        reading->latency = *latency;
    memcpy(record->rotation, haptic->rotation, sizeof record->rotation);
    record->has_pose = haptic->has_pose;
    pel_exchange_give(&haptic->record_exchange);
}

static bool is_pose(const double position[3], const double rotation[4])
{
    double square = pel_vec3_dot(rotation, rotation) + rotation[3] * rotation[3];
    return isfinite(position[0]) && isfinite(position[1]) && isfinite(position[2]) && fabs(square - 1) < 1e-6;
}

/* one update; position is null, or no pose, where the device is lost */
static bool update(pel_haptic *haptic, const double *position, const double *rotation,
                   const pel_haptic_latency *latency)
{
    bool is_there = position != NULL && is_pose(position, rotation);
    if (pel_exchange_take(&haptic->model_exchange))
        pel_proxy_set_model(&haptic->proxy, &haptic->models[haptic->model_exchange.reader]);
    if (is_there) {
        pel_proxy_update(&haptic->proxy, position);
        memcpy(haptic->rotation, rotation, sizeof haptic->rotation);
        haptic->has_pose = true;
    } else {
        pel_proxy_lose(&haptic->proxy);
    }
    send_record(haptic, latency);
    return is_there;
}

pel_status pel_haptic_update(pel_haptic *haptic, const double position[3], const double rotation[4], double force[3],
                             pel_error *error)
{
    PEL_REFUSE_NULL(force, error);
    pel_vec3_set(force, 0, 0, 0);
    PEL_REFUSE_NULL(haptic, error);
    PEL_REFUSE_NULL(position, error);
    if (haptic->loop != NULL)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "stop it with pel_haptic_stop before pel_haptic_update",
                          "the haptic loop runs in its own thread");
    double turned[4];
    memcpy(turned, rotation != NULL ? rotation : haptic->rotation, sizeof turned);
    if (!update(haptic, position, turned, NULL))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "set the force to 0 until the pose of the device is valid",
                          "the position of the device is not finite or its rotation is not a unit "
                          "quaternion");
    pel_vec3_copy(haptic->proxy.force, force);
    return PEL_OK;
}

static void update_device(void *context, const pel_haptic_latency *latency)
{
    pel_haptic *haptic = context;
    const pel_haptic_device *device = &haptic->device;
    double position[3], rotation[4];
    pel_vec3_copy(haptic->proxy.device, position);
    memcpy(rotation, haptic->rotation, sizeof rotation);
    bool is_there = device->read(device->user, position, rotation);
    update(haptic, is_there ? position : NULL, rotation, latency);
    device->write(device->user, haptic->proxy.force);
}

pel_status pel_haptic_start(pel_haptic *haptic, const pel_haptic_device *device, pel_error *error)
{
    PEL_REFUSE_NULL(haptic, error);
    PEL_REFUSE_NULL(device, error);
    if (device->read == NULL || device->write == NULL)
        return pel_fail(error, PEL_BAD_ARGUMENT, "the device lacks a function to read or to write");
    if (haptic->loop != NULL)
        return pel_fail(error, PEL_BAD_ARGUMENT, "the haptic loop runs already");
    haptic->device = *device;
    return pel_loop_create(haptic->rate, update_device, haptic, &haptic->loop, error);
}

void pel_haptic_stop(pel_haptic *haptic)
{
    if (haptic == NULL || haptic->loop == NULL)
        return;
    static const double none[3] = {0};
    pel_loop_destroy(haptic->loop);
    haptic->loop = NULL;
    haptic->device.write(haptic->device.user, none);
}

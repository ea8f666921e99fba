/* A force that acts at once sets a body into the modes that its linear displacement under it consists of, mainly the
   lowest of them: a band that is pulled along its axis swings along it, and hardly knows of the slow waves across it.
   The frequency is Rayleigh's quotient of that displacement. Pins that move, and a velocity at the start, act like a
   weight along them. Over a time of n periods a force starts at most 1 / (pi n) of its displacement. */
#include "choice/excited.h"

#include "base/memory.h"
#include "math/extremes.h"
#include "math/vec3.h"
#include "minimise/step_modes.h"
#include "minimise/step_newton.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* periods, over which what changes starts nothing to speak of: 3 % */
#define SLOW_PERIODS 10
/* of the largest energy */
#define LEAST_SHARE 0.01
/* of the energy of a velocity, in one mode */
#define LEAST_PART 0.1
/* of the size of the body, by which its weight moves it */
#define LEAST_SAG 1e-3
#define PI 3.14159265358979323846

typedef struct cause {
    pel_modes_response response;
    double energy;
    char name[PEL_NAME_SIZE + 16];
} cause;

typedef struct causes {
    const pel_scene *scene;
    const pel_body_def *body;
    pel_sim *sim;
    double *force; /* (unknown_count) */
    cause *found;  /* room for all */
    int32_t count;
} causes;

void pel_excited_lay_out(const pel_scene *scene, int32_t body, double dt, pel_load_def *loads, int32_t *count)
{
    *count = 0;
    for (int32_t l = 0; l < scene->sim.load_count; l++) {
        pel_load_def load = scene->sim.loads[l];
        if (load.body != body)
            continue;
        load.body = 0;
        load.follower = false;
        load.keys = NULL;
        load.key_count = 0;
        load.from = (2 + *count) * dt;
        load.until = (3 + *count) * dt;
        loads[(*count)++] = load;
    }
}

/* a value over time changes within few periods of a frequency; at its begin it does so at once */
static bool is_quick(const pel_key *keys, int32_t count, double frequency)
{
    bool any = count == 0 || keys[0].value != 0;
    for (int32_t k = 1; k < count; k++)
        any |= keys[k].value != keys[k - 1].value && (keys[k].time - keys[k - 1].time) * frequency < SLOW_PERIODS;
    return any;
}

/* the response to the force, with its energy times a power of the angular frequency */
static cause *take(causes *all, int power, const char *format, const char *name)
{
    cause *made = &all->found[all->count];
    made->response = pel_modes_respond(all->sim->modes->modes, &all->sim->minimise->newton->frames, all->force);
    made->energy = made->response.energy;
    for (int i = 0; i < power; i++)
        made->energy *= 2 * PI * made->response.frequency;
    snprintf(made->name, sizeof made->name, format, name);
    all->count += made->response.frequency > 0;
    return made;
}

static void take_back(causes *all, const cause *made)
{
    all->count = (int32_t)(made - all->found);
}

static void clear(const causes *all)
{
    memset(all->force, 0, (size_t)pel_newton_pattern(all->sim->newton)->unknown_count * sizeof *all->force);
}

static void weigh(const causes *all, const double acceleration[3])
{
    clear(all);
    for (int32_t v = 0; v < all->sim->model->vertex_count; v++)
        for (int k = 0; k < 3; k++)
            all->force[3 * v + k] = (double)all->sim->model->mass[v] * acceleration[k];
}

static void take_loads(causes *all, int32_t body)
{
    const pel_scene *scene = all->scene;
    pel_sim_newton *newton = all->sim->minimise->newton;
    const size_t bytes = (size_t)pel_newton_pattern(all->sim->newton)->unknown_count * sizeof *all->force;
    int32_t number = 0;
    for (int32_t l = 0; l < scene->sim.load_count; l++) {
        const pel_load_def *load = &scene->sim.loads[l];
        if (load->body != body)
            continue;
        pel_sim_newton_gather(all->sim, pel_instant((2.5 + number++) * all->sim->step.dt), false);
        memcpy(all->force, newton->loads, bytes);
        const cause *made = take(all, 0, "load '%s'", load->name != NULL ? load->name : "");
        bool ends = isfinite(load->until) && load->until < scene->duration;
        if (load->from >= scene->duration ||
            (!ends && !is_quick(load->keys, load->key_count, made->response.frequency)))
            take_back(all, made);
    }
}

static void take_weight(causes *all)
{
    weigh(all, all->scene->model.gravity);
    const cause *made = take(all, 0, "%s", "gravity");
    if (made->response.reach < LEAST_SAG * all->sim->minimise->size)
        take_back(all, made);
}

/* the highest mode that has enough of the energy of a velocity at the start, which is that of its share of the mass */
static void take_motion(causes *all)
{
    const pel_model *model = all->sim->model;
    weigh(all, all->body->velocity);
    cause *made = take(all, 2, "%s", "the motion at the start");
    double energy = 0;
    for (int32_t v = 0; v < model->vertex_count; v++)
        energy += model->inverse_mass[v] > 0
                      ? (double)model->mass[v] * pel_vec3_dot(all->body->velocity, all->body->velocity)
                      : 0;
    weigh(all, all->body->velocity);
    for (int32_t m = 0; m < all->sim->modes->count; m++) {
        const double *mode = pel_modes_vector(all->sim->modes->modes, m);
        double along = 0, mass = 0;
        for (int32_t u = 0; u < 3 * model->vertex_count; u++) {
            along += mode[u] * all->force[u];
            mass += (double)model->mass[u / 3] * mode[u] * mode[u];
        }
        if (along * along >= LEAST_PART * mass * energy)
            made->response.frequency = pel_max(made->response.frequency, all->sim->modes->values[m]);
    }
}

/* Along the normals, as if on all of the surface. A pressure without keys, of no gas, is there to inflate, and may be
   damped. */
static void take_pressure(causes *all)
{
    const pel_model *model = all->sim->model;
    const pel_quantity *pressure = &all->body->shell.pressure.outside;
    double x[3][3], across[3];
    const bool is_gas = all->body->shell.pressure.kind == PEL_PRESSURE_GAS;
    if (pressure->key_count == 0 && !(is_gas && pressure->value != 0))
        return;
    clear(all);
    for (int32_t t = 0; t < model->triangle_count; t++) {
        for (int i = 0; i < 3; i++)
            pel_vertex_position(model->rest, model->triangles[t][i], x[i]);
        pel_vec3_triangle_normal(x[0], x[1], x[2], across);
        for (int i = 0; i < 3; i++)
            pel_vec3_add(all->force + 3 * (size_t)model->triangles[t][i], across,
                         all->force + 3 * (size_t)model->triangles[t][i]);
    }
    const cause *made = take(all, 0, "%s", "the pressure");
    if (!is_quick(pressure->keys, pressure->key_count, made->response.frequency))
        take_back(all, made);
}

static void take_pins(causes *all, int32_t body)
{
    const pel_sim_def *def = &all->scene->sim;
    for (int32_t t = 0; t < def->tool_count; t++) {
        const pel_tool_def *tool = &def->tools[t];
        bool moves = false;
        for (int32_t k = 1; tool->shape == PEL_TOOL_SUPPORT && tool->body == body && k < tool->key_count; k++) {
            double way[3];
            pel_vec3_subtract(tool->keys[k].position, tool->keys[k - 1].position, way);
            if (moves || !(pel_vec3_length(way) > 0))
                continue;
            weigh(all, way);
            const cause *made = take(all, 4, "the way of %s", tool->name);
            moves = (tool->keys[k].time - tool->keys[k - 1].time) * made->response.frequency < SLOW_PERIODS;
            if (!moves)
                take_back(all, made);
        }
    }
}

static void take_supports(causes *all, int32_t body)
{
    const pel_sim_def *def = &all->scene->sim;
    for (int32_t s = 0; s < def->support_count; s++) {
        const pel_support_def *support = &def->supports[s];
        double way[3] = {0};
        for (int i = 0; i < 3; i++)
            if (support->fix[i])
                pel_vec3_along(way, support->displacement[i], support->axes[i], way);
        if (support->body != body || !(pel_vec3_length(way) > 0) || support->key_count == 0)
            continue;
        weigh(all, way);
        const cause *made = take(all, 4, "support '%s'", support->name != NULL ? support->name : "");
        if (!is_quick(support->keys, support->key_count, made->response.frequency))
            take_back(all, made);
    }
}

pel_status pel_excited_find(const pel_scene *scene, int32_t body, pel_sim *sim, pel_excited *excited)
{
    const pel_sim_def *def = &scene->sim;
    size_t room = (size_t)def->load_count + (size_t)def->tool_count + (size_t)def->support_count + 4;
    causes all = {.scene = scene, .body = &scene->model.bodies[body], .sim = sim};
    *excited = (pel_excited){0};
    all.force = pel_allocate((size_t)pel_newton_pattern(sim->newton)->unknown_count + 1, sizeof *all.force);
    all.found = pel_allocate(room, sizeof *all.found);
    if (all.force != NULL && all.found != NULL) {
        take_loads(&all, body);
        take_weight(&all);
        take_motion(&all);
        take_pressure(&all);
        take_pins(&all, body);
        take_supports(&all, body);
    }
    double most = 0;
    for (int32_t i = 0; i < all.count; i++)
        most = pel_max(most, all.found[i].energy);
    for (int32_t i = 0; i < all.count; i++) {
        const cause *at = &all.found[i];
        if (at->energy < LEAST_SHARE * most || at->response.frequency <= excited->frequency)
            continue;
        excited->frequency = at->response.frequency;
        memcpy(excited->by, at->name, sizeof excited->by);
    }
    const bool done = all.force != NULL && all.found != NULL;
    pel_free(all.force);
    pel_free(all.found);
    return done ? PEL_OK : PEL_OUT_OF_MEMORY;
}

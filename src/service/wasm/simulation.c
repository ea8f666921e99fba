#include "base/memory.h"
#include "base/room.h"
#include "io/json.h"
#include "live/message.h"
#include "pellicle/observe.h"
#include "pellicle/sim_reading.h"
#include "pellicle/sim_rigid.h"
#include "pellicle/sim_surface.h"
#include "pellicle/tear.h"
#include "wasm/calls.h"
#include "wasm/error.h"

#include <string.h>

enum { RIGID_NUMBERS = 21, PICK_NUMBERS = 17, TIP_NUMBERS = 12 };

/* arrays of a body, as JavaScript reads them */
typedef struct body_arrays {
    float *positions;
    int32_t *triangles;
    int32_t position_count, triangle_count; /* rows that there is room for */
} body_arrays;

struct pel_wasm_sim {
    pel_scene *scene;
    pel_model *model;
    pel_sim *sim;
    pel_session *session;
    pel_error error;
    pel_status status;
    pel_json notes;    /* elements of an array */
    char *kept;        /* the last text */
    pel_wasm_text out; /* it, or one that lives elsewhere */
    int32_t body_count;
    body_arrays *bodies; /* (body_count) */
    double *numbers;     /* (number_room) */
    size_t number_room;
    float *values; /* (value_room) of a field */
    size_t value_room;
    double picked[PICK_NUMBERS];
    double *tips; /* of the last call */
    double rigid[RIGID_NUMBERS];
    pel_joint_reading joint;
};

/* ---- creation ---- */

static void note(void *user, const char *text)
{
    pel_json_text(user, NULL, text);
}

static pel_status start(pel_wasm_sim *sim)
{
    pel_error *error = &sim->error;
    sim->body_count = sim->scene->model.body_count;
    sim->bodies = pel_allocate((size_t)sim->body_count, sizeof *sim->bodies);
    if (sim->bodies == NULL)
        return pel_fail_memory(error);
    pel_status status = pel_model_create(&sim->scene->model, &sim->model, error);
    pel_sim_def def = sim->scene->sim;
    def.model = sim->model;
    def.thread_count = 1;
    if (status == PEL_OK)
        status = pel_sim_create(&def, &sim->sim, error);
    if (status == PEL_OK)
        status = pel_session_create(sim->scene, sim->sim, &sim->session, error);
    if (status != PEL_OK)
        pel_scene_locate(sim->scene, error);
    return status;
}

pel_wasm_sim *pel_wasm_sim_create(const char *path, const char *text, int32_t size, const char *const *overrides,
                                  int32_t override_count)
{
    pel_wasm_sim *sim = pel_allocate(1, sizeof *sim);
    if (sim == NULL)
        return NULL;
    const pel_log log = {note, &sim->notes};
    sim->status = pel_scene_parse(path, text, (size_t)size, overrides, override_count, &log, &sim->scene, &sim->error);
    if (sim->status == PEL_OK)
        sim->status = start(sim);
    return sim;
}

void pel_wasm_sim_destroy(pel_wasm_sim *sim)
{
    if (sim == NULL)
        return;
    pel_session_destroy(sim->session);
    pel_sim_destroy(sim->sim);
    pel_model_destroy(sim->model);
    pel_scene_destroy(sim->scene);
    for (int32_t b = 0; sim->bodies != NULL && b < sim->body_count; b++) {
        pel_free(sim->bodies[b].positions);
        pel_free(sim->bodies[b].triangles);
    }
    pel_free(sim->bodies);
    pel_json_free(&sim->notes);
    PEL_FREE_ALL(sim->kept, sim->numbers, sim->values, sim->tips, sim);
}

int32_t pel_wasm_sim_status(const pel_wasm_sim *sim)
{
    return (int32_t)sim->status;
}

/* ---- texts ---- */

/* keeps a text (pel_allocate, nullable) until the next one */
static const pel_wasm_text *keep(pel_wasm_sim *sim, void *text, size_t size)
{
    pel_free(sim->kept);
    sim->kept = text;
    sim->out = (pel_wasm_text){sim->kept, text != NULL ? (int32_t)size : 0};
    return &sim->out;
}

static const pel_wasm_text *keep_json(pel_wasm_sim *sim, pel_json *json)
{
    if (json->failed)
        pel_json_free(json);
    return keep(sim, json->text, json->length);
}

const pel_wasm_text *pel_wasm_sim_error(pel_wasm_sim *sim)
{
    pel_json json = {0};
    pel_wasm_put_error(&json, &sim->error);
    return keep_json(sim, &json);
}

const pel_wasm_text *pel_wasm_sim_notes(pel_wasm_sim *sim)
{
    pel_json json = {0};
    pel_json_print(&json, "[%s]", sim->notes.length > 0 && !sim->notes.failed ? sim->notes.text : "");
    return keep_json(sim, &json);
}

const pel_wasm_text *pel_wasm_sim_hello(pel_wasm_sim *sim)
{
    size_t size = 0;
    void *text = pel_message_hello(sim->scene, sim->scene->path, sim->sim, &size);
    return keep(sim, text, size);
}

const pel_wasm_text *pel_wasm_sim_parameters(pel_wasm_sim *sim)
{
    size_t size = 0;
    void *text = pel_message_parameters(sim->sim, sim->session, sim->scene, &size);
    return keep(sim, text, size);
}

const pel_wasm_text *pel_wasm_sim_summary(pel_wasm_sim *sim)
{
    size_t size = 0;
    void *text = pel_message_summary(sim->sim, sim->session, &size);
    return keep(sim, text, size);
}

const pel_wasm_text *pel_wasm_sim_scene(pel_wasm_sim *sim)
{
    char *text = NULL;
    sim->status = pel_session_scene(sim->session, &text, &sim->error);
    return keep(sim, text, text != NULL ? strlen(text) : 0);
}

/* ---- steps and commands ---- */

int32_t pel_wasm_sim_step(pel_wasm_sim *sim, int32_t count)
{
    sim->status = PEL_OK;
    for (int32_t i = 0; sim->status == PEL_OK && i < count; i++) {
        sim->status = pel_session_repeat(sim->session, &sim->error);
        if (sim->status == PEL_OK)
            sim->status = pel_session_step(sim->session, &sim->error);
    }
    return (int32_t)sim->status;
}

int32_t pel_wasm_sim_apply(pel_wasm_sim *sim, const char *line)
{
    sim->status = pel_session_apply(sim->session, line, &sim->error);
    return (int32_t)sim->status;
}

int32_t pel_wasm_sim_undo(pel_wasm_sim *sim)
{
    bool done = false;
    sim->status = pel_session_undo(sim->session, &done, &sim->error);
    return sim->status == PEL_OK ? done : -1;
}

int32_t pel_wasm_sim_reset(pel_wasm_sim *sim)
{
    sim->status = pel_session_reset(sim->session, &sim->error);
    return (int32_t)sim->status;
}

double pel_wasm_sim_time(const pel_wasm_sim *sim)
{
    return pel_sim_time(sim->sim);
}

double pel_wasm_sim_step_count(const pel_wasm_sim *sim)
{
    return (double)pel_sim_step_count(sim->sim);
}

/* ---- arrays ---- */

int32_t pel_wasm_sim_vertex_count(const pel_wasm_sim *sim, int32_t body)
{
    return body >= 0 && body < sim->body_count ? pel_sim_vertex_count(sim->sim, body) : 0;
}

int32_t pel_wasm_sim_triangle_count(const pel_wasm_sim *sim, int32_t body)
{
    return body >= 0 && body < sim->body_count ? pel_sim_triangle_count(sim->sim, body) : 0;
}

double pel_wasm_sim_revision(const pel_wasm_sim *sim, int32_t body)
{
    return body >= 0 && body < sim->body_count ? (double)pel_sim_surface_revision(sim->sim, body) : 0;
}

static bool reserve_numbers(pel_wasm_sim *sim, size_t count)
{
    void *numbers = sim->numbers;
    if (!pel_reserve(&numbers, &sim->number_room, count, sizeof *sim->numbers))
        return false;
    sim->numbers = numbers;
    return true;
}

/* an array with exactly `count` rows of three, > 0 */
static bool fit(void **array, int32_t *rows, int32_t count, size_t size)
{
    if (*rows == count)
        return true;
    void *room = pel_reallocate(*array, 3 * (size_t)count, size);
    if (room == NULL)
        return false;
    *array = room;
    *rows = count;
    return true;
}

const float *pel_wasm_sim_positions(pel_wasm_sim *sim, int32_t body)
{
    int32_t count = pel_wasm_sim_vertex_count(sim, body);
    if (count == 0 || !reserve_numbers(sim, 3 * (size_t)count))
        return NULL;
    body_arrays *arrays = &sim->bodies[body];
    void *positions = arrays->positions;
    if (!fit(&positions, &arrays->position_count, count, sizeof *arrays->positions))
        return NULL;
    arrays->positions = positions;
    pel_sim_get_positions(sim->sim, body, sim->numbers);
    for (size_t i = 0; i < 3 * (size_t)count; i++)
        arrays->positions[i] = (float)sim->numbers[i];
    return arrays->positions;
}

const int32_t *pel_wasm_sim_triangles(pel_wasm_sim *sim, int32_t body)
{
    int32_t count = pel_wasm_sim_triangle_count(sim, body);
    if (count == 0)
        return NULL;
    body_arrays *arrays = &sim->bodies[body];
    void *triangles = arrays->triangles;
    if (!fit(&triangles, &arrays->triangle_count, count, sizeof *arrays->triangles))
        return NULL;
    arrays->triangles = triangles;
    pel_sim_get_triangles(sim->sim, body, arrays->triangles);
    return arrays->triangles;
}

const float *pel_wasm_sim_field(pel_wasm_sim *sim, int32_t field, int32_t body)
{
    sim->status = PEL_BAD_ARGUMENT;
    if (field < 0 || field >= pel_field_count()) {
        pel_fail(&sim->error, PEL_BAD_ARGUMENT, "there is no field %d", (int)field);
        return NULL;
    }
    size_t components = (size_t)pel_field_at(field)->component_count;
    size_t count = (size_t)pel_wasm_sim_vertex_count(sim, body) * components;
    void *values = sim->values;
    if (!reserve_numbers(sim, count) || !pel_reserve(&values, &sim->value_room, count, sizeof *sim->values)) {
        sim->status = pel_fail_memory(&sim->error);
        return NULL;
    }
    sim->values = values;
    sim->status = pel_observe(sim->sim, field, body, sim->numbers, &sim->error);
    if (sim->status != PEL_OK)
        return NULL;
    for (size_t i = 0; i < count; i++)
        sim->values[i] = (float)sim->numbers[i];
    return sim->values;
}

const double *pel_wasm_sim_pick(pel_wasm_sim *sim, double ox, double oy, double oz, double dx, double dy, double dz)
{
    const double origin[3] = {ox, oy, oz}, direction[3] = {dx, dy, dz};
    pel_pick_hit hit;
    sim->status = pel_pick(sim->sim, origin, direction, &hit, &sim->error);
    if (sim->status != PEL_OK)
        return NULL;
    double *out = sim->picked;
    out[0] = hit.is_hit;
    out[1] = hit.body;
    out[2] = hit.triangle;
    out[3] = hit.mesh_vertex;
    out[4] = hit.distance;
    for (int i = 0; i < 3; i++) {
        out[5 + i] = hit.point[i];
        out[8 + i] = hit.normal[i];
        out[11 + i] = hit.vertices[i];
        out[14 + i] = hit.weights[i];
    }
    return out;
}

const double *pel_wasm_sim_rigid(pel_wasm_sim *sim, int32_t body)
{
    pel_rigid_reading reading;
    _Static_assert(sizeof reading == sizeof sim->rigid, "its members are all doubles");
    if (!pel_sim_get_rigid(sim->sim, body, &reading))
        return NULL;
    memcpy(sim->rigid, &reading, sizeof reading);
    return sim->rigid;
}

const double *pel_wasm_sim_joint(pel_wasm_sim *sim, const char *name)
{
    _Static_assert(sizeof sim->joint == 10 * sizeof(double), "its members are all doubles");
    int32_t joint = 0;
    while (joint < pel_sim_joint_count(sim->sim) && strcmp(pel_sim_joint_name(sim->sim, joint), name) != 0)
        joint++;
    return pel_sim_get_joint(sim->sim, joint, &sim->joint) ? &sim->joint.position : NULL;
}

const double *pel_wasm_sim_tips(pel_wasm_sim *sim, int32_t body)
{
    int32_t count = 0;
    pel_free(sim->tips);
    sim->tips = NULL;
    sim->status = pel_sim_tips(sim->sim, body, NULL, 0, &count, &sim->error);
    if (sim->status != PEL_OK)
        return NULL;
    pel_tip *tips = pel_allocate((size_t)count, sizeof *tips);
    sim->tips = pel_allocate(1 + TIP_NUMBERS * (size_t)count, sizeof *sim->tips);
    sim->status = tips != NULL && sim->tips != NULL ? pel_sim_tips(sim->sim, body, tips, count, &count, &sim->error)
                                                    : pel_fail_memory(&sim->error);
    for (int32_t t = 0; sim->status == PEL_OK && t < count; t++) {
        double *out = sim->tips + 1 + TIP_NUMBERS * (size_t)t;
        out[0] = tips[t].vertex;
        memcpy(out + 1, tips[t].position, sizeof tips[t].position);
        memcpy(out + 4, tips[t].ahead, sizeof tips[t].ahead);
        memcpy(out + 7, tips[t].force, sizeof tips[t].force);
        out[10] = tips[t].release;
        out[11] = tips[t].rate;
    }
    pel_free(tips);
    if (sim->status != PEL_OK)
        return NULL;
    sim->tips[0] = count;
    return sim->tips;
}

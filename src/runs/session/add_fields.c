/* Fields that are computed after a run, from the positions of its frames. */
#include "pellicle/run.h"

#include "base/memory.h"
#include "base/status.h"
#include "def/row.h"
#include "observe/field.h"
#include "pellicle/frames.h"
#include "results/surface.h"

#include <stdio.h>
#include <string.h>

/* the simulation that a frame's positions are put into */
typedef struct replay {
    pel_frames *frames;
    pel_scene *scene;
    pel_model *model;
    pel_sim *sim;
    const char **names; /* of the run's fields and the new ones */
    pel_output_def output;
    pel_run_surface surface;
} replay;

/* whether a field depends on positions alone, not on velocities, contacts, loads or the past */
static bool depends_on_positions(int32_t field)
{
    return field == PEL_FIELD_DISPLACEMENT || (field >= PEL_FIELD_ENERGY && field <= PEL_FIELD_BENDING_ENERGY) ||
           pel_field_is_measure(field) || field == PEL_FIELD_STRESS || pel_field_is_mechanics(field);
}

static pel_status check_name(const char *name, pel_error *error)
{
    const int32_t field = pel_field_find(name);
    if (field >= 0 && depends_on_positions(field))
        return PEL_OK;
    pel_fail(error, PEL_BAD_ARGUMENT,
             field < 0 ? "there is no field '%s'" : "field '%s' depends on more than the positions of a frame", name);
    pel_fail_remedy(error, field < 0 ? "see the list of fields: pellicle reference"
                                     : "name it in output.fields and run the scene again");
    return PEL_BAD_ARGUMENT;
}

/* whether a number of the material has keys over time */
static bool is_keyed(const pel_body_def *body)
{
    const pel_def_row *members[PEL_MOST_MEMBERS];
    const int32_t count = pel_def_members(PEL_DEF_BODY, members);
    for (int32_t i = 0; i < count; i++) {
        int32_t keys = 0;
        if (pel_def_row_may_be_keyed(members[i]) && strstr(members[i]->path, "pressure") == NULL &&
            pel_member_keys(members[i], body, &keys) != NULL && keys > 0)
            return true;
    }
    return false;
}

/* what changes the material or the mesh during a run is unknown afterwards */
static pel_status check_scene(const pel_scene *scene, const char *folder, pel_error *error)
{
    const char *why = scene->session_count > 0 ? "it has a session, which may change parameters"
                      : scene->sim.cut_count + scene->sim.seam_count > 0 ? "its bodies are cut"
                      : scene->imperfection_amplitude > 0                ? "its rest shapes come from a buckling mode"
                                                                         : NULL;
    for (int32_t b = 0; b < scene->model.body_count; b++) {
        const pel_body_def *body = &scene->model.bodies[b];
        why = body->refine.levels > 0            ? "it has bodies that refine"
              : body->shell.anisotropy_count > 0 ? "its fibres change over time"
              : is_keyed(body)                   ? "its material changes over time"
                                                 : why;
    }
    if (why == NULL)
        return PEL_OK;
    pel_fail(error, PEL_BAD_ARGUMENT, "fields cannot be added to this run: %s", why);
    pel_fail_place(error, folder, 0, 0);
    pel_fail_remedy(error, "name the fields in output.fields and run the scene again");
    return PEL_BAD_ARGUMENT;
}

/* joins the names of the run's fields and the new ones, each once */
static pel_status join_names(replay *r, const char *const *names, int32_t count, pel_error *error)
{
    const pel_output_def *old = &r->scene->output;
    r->output = *old;
    r->names = pel_allocate((size_t)(old->field_count + count), sizeof *r->names);
    if (r->names == NULL)
        return pel_fail_memory(error);
    r->output.fields = r->names;
    r->output.field_count = 0;
    for (int32_t i = 0; i < old->field_count + count; i++) {
        const char *name = i < old->field_count ? old->fields[i] : names[i - old->field_count];
        int32_t k = 0;
        while (k < r->output.field_count && strcmp(r->names[k], name) != 0)
            k++;
        r->names[k] = name;
        r->output.field_count += k == r->output.field_count;
    }
    return PEL_OK;
}

static pel_status open_replay(replay *r, const char *folder, const char *const *names, int32_t count, pel_error *error)
{
    char path[PEL_RUN_PATH_SIZE + 64];
    snprintf(path, sizeof path, "%s/%s", folder, pel_run_file_name(PEL_RUN_SCENE));
    pel_status status = pel_frames_open(folder, &r->frames, error);
    if (status == PEL_OK)
        status = pel_scene_load(path, NULL, 0, NULL, &r->scene, error);
    if (status == PEL_OK)
        status = check_scene(r->scene, folder, error);
    if (status == PEL_OK)
        status = join_names(r, names, count, error);
    if (status == PEL_OK)
        status = pel_model_create(&r->scene->model, &r->model, error);
    if (status != PEL_OK)
        return status;
    pel_sim_def def = r->scene->sim;
    def.model = r->model;
    status = pel_sim_create(&def, &r->sim, error);
    return status == PEL_OK ? pel_run_surface_create(r->sim, &r->output, &r->surface, error) : status;
}

static void close_replay(replay *r)
{
    pel_run_surface_destroy(&r->surface);
    pel_sim_destroy(r->sim);
    pel_model_destroy(r->model);
    pel_scene_destroy(r->scene);
    pel_frames_close(r->frames);
    pel_free(r->names);
}

/* fields that the frame has already keep the values of the run */
static void keep_values(const replay *r, const pel_mesh *frame)
{
    for (int32_t f = 0; f < r->surface.field_count; f++) {
        pel_vtp_field *field = &r->surface.fields[f];
        const pel_field *old = pel_mesh_field(frame, field->name);
        if (old == NULL || old->component_count != field->component_count)
            continue;
        /* the surface owns these values */
        memcpy((double *)(uintptr_t)field->values, old->values,
               (size_t)frame->vertex_count * (size_t)old->component_count * sizeof *old->values);
    }
}

static pel_status replace_frame(replay *r, int32_t number, pel_error *error)
{
    pel_mesh *frame;
    pel_status status = pel_frames_read(r->frames, number, &frame, error);
    if (status != PEL_OK)
        return status;
    if (frame->vertex_count != r->surface.vertex_count) {
        pel_fail(error, PEL_BAD_FORMAT, "the frame has %d vertices, the bodies of the scene have %d",
                 (int)frame->vertex_count, (int)r->surface.vertex_count);
        pel_fail_place(error, r->frames->paths[number], 0, 0);
        pel_fail_remedy(error, "run the scene again, with the fields in output.fields");
        status = PEL_BAD_FORMAT;
    }
    for (int32_t b = 0; status == PEL_OK && b < r->surface.body_count; b++)
        status = pel_sim_set_positions(r->sim, b, frame->positions[r->surface.begin[b]], error);
    if (status == PEL_OK)
        status = pel_run_surface_read(&r->surface, r->sim, error);
    if (status == PEL_OK) {
        keep_values(r, frame);
        r->surface.time = r->frames->times[number];
        status = pel_run_surface_write(&r->surface, &r->output, r->frames->paths[number], error);
    }
    pel_mesh_destroy(frame);
    return status;
}

pel_status pel_run_add_fields(const char *folder, const char *const *names, int32_t name_count, pel_error *error)
{
    PEL_REFUSE_NULL(folder, error);
    PEL_REFUSE_NULL(names, error);
    if (name_count < 1)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "name at least one field", "there are %d names", (int)name_count);
    for (int32_t i = 0; i < name_count; i++) {
        const pel_status status = check_name(names[i], error);
        if (status != PEL_OK)
            return status;
    }
    replay r = {0};
    pel_status status = open_replay(&r, folder, names, name_count, error);
    for (int32_t f = 0; status == PEL_OK && f < r.frames->frame_count; f++)
        status = replace_frame(&r, f, error);
    close_replay(&r);
    return status;
}

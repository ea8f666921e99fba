/* The first pass over a run for a report: its fields and their ranges. */
#include "report/read.h"

#include "base/hash.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "math/extremes.h"
#include "mesh/figures.h"
#include "results/common_mesh.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- topologies ---- */

static uint64_t hash_triangles(const pel_mesh *mesh)
{
    uint64_t hash = PEL_HASH_START;
    const int32_t *corners = mesh->triangles[0];
    for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count; i++)
        hash = pel_hash_word(hash, (uint64_t)corners[i]);
    return hash;
}

static pel_status note_topology(pel_report_run *run, const pel_mesh *mesh, int32_t frame, pel_error *error)
{
    uint64_t hash = hash_triangles(mesh);
    for (int32_t i = run->topology_count - 1; i >= 0; i--) {
        const pel_report_topology *known = &run->topologies[i];
        if (known->hash == hash && known->vertex_count == mesh->vertex_count &&
            known->triangle_count == mesh->triangle_count) {
            run->frame_topology[frame] = i;
            return PEL_OK;
        }
    }
    void *grown = pel_reallocate(run->topologies, (size_t)run->topology_count + 1, sizeof *run->topologies);
    if (grown == NULL)
        return pel_fail_memory(error);
    run->topologies = grown;
    run->topologies[run->topology_count] =
        (pel_report_topology){.hash = hash, .vertex_count = mesh->vertex_count, .triangle_count = mesh->triangle_count};
    run->frame_topology[frame] = run->topology_count++;
    run->vertex_limit = run->vertex_limit > mesh->vertex_count ? run->vertex_limit : mesh->vertex_count;
    run->triangle_limit = run->triangle_limit > mesh->triangle_count ? run->triangle_limit : mesh->triangle_count;
    return PEL_OK;
}

/* ---- ranges ---- */

static void grow_range(pel_report_field *known, const pel_field *field, int32_t vertex_count)
{
    const double *value = field->values;
    for (int32_t v = 0; v < vertex_count; v++) {
        double squares = 0;
        for (int32_t i = 0; i < field->component_count; i++, value++) {
            known->low = *value < known->low ? *value : known->low;
            known->high = *value > known->high ? *value : known->high;
            squares += *value * *value;
        }
        double magnitude = field->component_count > 1 ? sqrt(squares) : value[-1];
        known->magnitude_low = pel_min(known->magnitude_low, magnitude);
        known->magnitude_high = pel_max(known->magnitude_high, magnitude);
    }
    known->frame_count++;
}

/* ---- fields ---- */

/* where the user put the field, -1 when it is not wanted; places in the mesh are nothing to look at */
static int32_t find_place(const pel_report_def *def, const char *name, int32_t otherwise)
{
    for (int32_t i = 0; i < def->field_count; i++)
        if (strcmp(def->fields[i], name) == 0)
            return i;
    return def->field_count == 0 && !pel_common_mesh_is_place(name) ? otherwise : -1;
}

static pel_status add_field(pel_report_run *run, const pel_field *field, int32_t place, pel_error *error)
{
    void *grown = pel_reallocate(run->fields, (size_t)run->field_count + 1, sizeof *run->fields);
    if (grown == NULL)
        return pel_fail_memory(error);
    run->fields = grown;
    pel_report_field *made = &run->fields[run->field_count++];
    *made = (pel_report_field){.component_count = field->component_count,
                               .place = place,
                               .low = HUGE_VAL,
                               .high = -HUGE_VAL,
                               .magnitude_low = HUGE_VAL,
                               .magnitude_high = -HUGE_VAL};
    snprintf(made->name, sizeof made->name, "%s", field->name);
    return PEL_OK;
}

static pel_status note_fields(pel_report_run *run, const pel_report_def *def, const pel_mesh *mesh, pel_error *error)
{
    for (int32_t f = 0; f < mesh->field_count; f++) {
        const pel_field *field = &mesh->fields[f];
        int32_t place = find_place(def, field->name, f), at = 0;
        if (place < 0)
            continue;
        while (at < run->field_count && strcmp(run->fields[at].name, field->name) != 0)
            at++;
        if (at == run->field_count) {
            pel_status status = add_field(run, field, place, error);
            if (status != PEL_OK)
                return status;
        }
        if (run->fields[at].component_count == field->component_count)
            grow_range(&run->fields[at], field, mesh->vertex_count);
    }
    return PEL_OK;
}

/* tells which field may be meant, or which there are */
static void suggest_field(const pel_mesh *mesh, const char *name, pel_error *error)
{
    char list[200] = "";
    const char **names = pel_allocate((size_t)mesh->field_count, sizeof *names);
    for (int32_t f = 0; names != NULL && f < mesh->field_count; f++) {
        size_t length = strlen(list);
        names[f] = mesh->fields[f].name;
        snprintf(list + length, sizeof list - length, "%s%s", f > 0 ? ", " : "", names[f]);
    }
    const char *nearest = names != NULL ? pel_nearest_name(name, names, (size_t)mesh->field_count) : NULL;
    if (nearest != NULL)
        pel_fail_remedy(error, "did you mean '%s'?", nearest);
    else if (list[0] != '\0')
        pel_fail_remedy(error, "choose one of %s", list);
    else
        pel_fail_remedy(error, "it has no fields; list fields in output.fields of the scene");
    pel_free(names);
}

/* refuses a field that the user asked for and the frame does not have */
static pel_status check_wanted(const pel_report_run *run, const pel_report_def *def, const pel_mesh *mesh,
                               pel_error *error)
{
    for (int32_t i = 0; i < def->field_count; i++) {
        if (pel_mesh_field(mesh, def->fields[i]) != NULL)
            continue;
        pel_fail(error, PEL_BAD_ARGUMENT, "the run has no field '%s'", def->fields[i]);
        suggest_field(mesh, def->fields[i], error);
        pel_fail_place(error, run->folder, 0, 0);
        return PEL_BAD_ARGUMENT;
    }
    return PEL_OK;
}

/* in the user's order, without those that some frames do not have */
static void settle_fields(pel_report_run *run, const pel_log *log)
{
    int32_t kept = 0;
    for (int32_t f = 0; f < run->field_count; f++) {
        if (run->fields[f].frame_count == run->frames->frame_count)
            run->fields[kept++] = run->fields[f];
        else
            pel_log_line(log, "%s: field '%s' left out, some frames do not have it", run->folder, run->fields[f].name);
    }
    run->field_count = kept;
    for (int32_t f = 1; f < kept; f++)
        for (int32_t k = f; k > 0 && run->fields[k].place < run->fields[k - 1].place; k--) {
            pel_report_field swapped = run->fields[k];
            run->fields[k] = run->fields[k - 1];
            run->fields[k - 1] = swapped;
        }
}

/* ---- all ---- */

static pel_status survey_frame(pel_report_run *run, const pel_report_def *def, int32_t frame, pel_error *error)
{
    pel_mesh *mesh;
    pel_status status = pel_frames_read(run->frames, frame, &mesh, error);
    if (status != PEL_OK)
        return status;
    pel_mesh_add_box(mesh, run->low, run->high);
    if (frame == 0)
        status = check_wanted(run, def, mesh, error);
    if (status == PEL_OK)
        status = note_topology(run, mesh, frame, error);
    if (status == PEL_OK)
        status = note_fields(run, def, mesh, error);
    pel_mesh_destroy(mesh);
    return status;
}

pel_status pel_report_run_survey(pel_report_run *run, const pel_report_def *def, pel_error *error)
{
    for (int i = 0; i < 3; i++) {
        run->low[i] = HUGE_VAL;
        run->high[i] = -HUGE_VAL;
    }
    pel_status status = pel_frames_open(run->folder, &run->frames, error);
    if (status != PEL_OK)
        return status;
    run->frame_topology = pel_allocate((size_t)run->frames->frame_count, sizeof *run->frame_topology);
    if (run->frame_topology == NULL)
        return pel_fail_memory(error);
    for (int32_t f = 0; status == PEL_OK && f < run->frames->frame_count; f++)
        status = survey_frame(run, def, f, error);
    if (status == PEL_OK)
        settle_fields(run, def->log);
    return status;
}

void pel_report_run_free(pel_report_run *run)
{
    pel_json_free(&run->json);
    pel_report_pack_free(&run->pack);
    PEL_FREE_ALL(run->frame_topology, run->topologies, run->fields);
    pel_frames_close(run->frames);
    *run = (pel_report_run){0};
}

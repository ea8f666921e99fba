#include "study/kept.h"

#include "base/memory.h"
#include "base/room.h"
#include "stage/stepper.h"

#include <string.h>

void pel_study_kept_drop(pel_study_kept *kept)
{
    pel_run_kept_drop(&kept->parts, true);
    pel_scene_destroy(kept->scene);
    pel_free(kept->places);
    pel_free(kept->numbers);
    *kept = (pel_study_kept){0};
}

static bool varies(const pel_study_axis *axis)
{
    return axis->count > 1;
}

/* leaves places null where a value of an axis needs a scene of its own */
static pel_status find_places(const pel_study *study, pel_study_kept *kept, pel_error *error)
{
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(kept->places, study->axis_count), PEL_ROOM(kept->numbers, study->axis_count)))
        return pel_fail_memory(error);
    bool all = kept->scene->session_count == 0;
    for (int32_t a = 0; all && a < study->axis_count; a++)
        all = !varies(&study->axes[a]) || pel_scene_patch_find(kept->scene, study->axes[a].path, &kept->places[a]);
    if (!all) {
        pel_free(kept->places);
        kept->places = NULL;
    }
    return PEL_OK;
}

static const char *value_of(const pel_study *study, const pel_study_axis *axis, int64_t run)
{
    return axis->values[pel_study_index(study, run, axis->group)];
}

static bool is_of_model(pel_def_kind kind)
{
    return kind == PEL_DEF_BODY || kind == PEL_DEF_FIBRES || kind == PEL_DEF_MODEL;
}

/* the simulation has to be made anew; methods that seek rest refuse loads without a state of rest when they are made */
static bool needs_sim(const pel_study_kept *kept, const pel_def_row *row)
{
    bool seeks_rest = pel_stepper_of(kept->scene->sim.solver.method)->seeks_rest;
    return !row->is_direct || (seeks_rest && row->def == PEL_DEF_LOAD);
}

/* Writes the values of a run over those that are there. */
static bool patch(const pel_study *study, pel_study_kept *kept, int64_t run)
{
    bool changes_model = false, changes_sim = false;
    int32_t count = 0;
    for (int32_t a = 0; a < study->axis_count; a++) {
        const pel_study_axis *axis = &study->axes[a];
        const char *value = value_of(study, axis, run);
        const pel_def_row *row = pel_def_row_at(kept->places[a].row);
        if (strcmp(value, value_of(study, axis, kept->run)) == 0)
            continue;
        if (!pel_scene_patch(kept->scene, kept->places[a], value))
            return false;
        changes_model |= is_of_model(row->def);
        changes_sim |= needs_sim(kept, row);
        kept->numbers[count++] = (pel_run_number){kept->places[a], value};
    }
    if ((changes_model || changes_sim) && !pel_run_kept_refill(&kept->parts, kept->numbers, count, changes_model))
        pel_run_kept_drop(&kept->parts, changes_model);
    return true;
}

/* Writes the values that a simulation reads in each step. */
static bool copy_direct(const pel_study *study, pel_study_kept *kept)
{
    if (kept->parts.sim == NULL)
        return true;
    bool done = pel_run_kept_rewind(&kept->parts, NULL) == PEL_OK;
    for (int32_t a = 0; done && a < study->axis_count; a++)
        if (varies(&study->axes[a]) && pel_def_row_at(kept->places[a].row)->is_direct)
            done = pel_parameter_copy(kept->parts.sim, &kept->scene->sim, kept->places[a], NULL) == PEL_OK;
    return done;
}

pel_status pel_study_kept_take(const pel_study *study, pel_study_kept *kept, int64_t run, bool *patched,
                               pel_error *error)
{
    *patched = kept->places != NULL && patch(study, kept, run) && copy_direct(study, kept);
    if (*patched) {
        kept->run = run;
        return PEL_OK;
    }
    pel_study_kept_drop(kept);
    pel_status status = pel_study_scene(study, run, &kept->scene, error);
    if (status == PEL_OK)
        status = find_places(study, kept, error);
    kept->run = run;
    return status;
}

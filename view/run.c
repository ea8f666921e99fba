#include "view/run.h"

#include "view/support.h"

#include "pellicle/import.h"
#include "pellicle/results.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { PATH_SIZE = 4096 };

static bool is_folder(const char *path)
{
    struct stat found;
    return stat(path, &found) == 0 && S_ISDIR(found.st_mode);
}

static bool is_file(const char *path)
{
    struct stat found;
    return stat(path, &found) == 0 && !S_ISDIR(found.st_mode);
}

/* ---- tools ---- */

/* positions out of series.csv; without that file the keys of the scene have to do */
static pel_status read_positions(view_run *run, const char *path, pel_error *error)
{
    int32_t name_count = 3 * run->scene->sim.tool_count;
    char(*names)[PEL_NAME_SIZE + 4] = view_allocate((size_t)name_count, sizeof *names);
    const char **pointers = view_allocate((size_t)name_count, sizeof *pointers);
    pel_status status = PEL_OUT_OF_MEMORY;
    if (names != NULL && pointers != NULL) {
        for (int32_t i = 0; i < name_count; ++i) {
            snprintf(names[i], sizeof names[i], "%s_%c", run->scene->sim.tools[i / 3].name, "xyz"[i % 3]);
            pointers[i] = names[i];
        }
        status = pel_series_read(path, pointers, name_count, &run->tool_positions, error);
        if (status == PEL_BAD_FILE)
            pel_fail_remedy(error, "leave the tools out, or run the scene again");
    } else {
        pel_fail_memory(error);
    }
    free(names);
    free(pointers);
    return status;
}

/* the scene, and with `tools` the positions of its tools */
static pel_status open_scene(view_run *run, bool tools, const pel_log *log, pel_error *error)
{
    char path[PATH_SIZE];
    pel_error problem;
    snprintf(path, sizeof path, "%s/%s", run->frames->folder, pel_run_file_name(PEL_RUN_SCENE));
    if (!is_file(path))
        return PEL_OK;
    pel_status status = pel_scene_load(path, NULL, 0, NULL, &run->scene, &problem);
    if (status == PEL_OUT_OF_MEMORY) {
        if (error != NULL)
            *error = problem;
        return status;
    }
    if (status != PEL_OK) {
        char text[800];
        if (tools)
            pel_log_line(log, "tools are not drawn: %s", pel_error_text(&problem, text, sizeof text));
        return PEL_OK;
    }
    run->tool_count = tools ? run->scene->sim.tool_count : 0;
    if (run->tool_count == 0)
        return PEL_OK;
    snprintf(path, sizeof path, "%s/%s", run->frames->folder, pel_run_file_name(PEL_RUN_SERIES));
    if (!is_file(path))
        return PEL_OK;
    return read_positions(run, path, error);
}

bool view_run_has_modes(const view_run *run)
{
    return run->scene != NULL && run->scene->sim.solver.analysis != PEL_ANALYSIS_NONE;
}

int32_t view_run_up(const view_run *run)
{
    return run->scene != NULL ? run->scene->up : 2;
}

int32_t view_run_tool_count(const view_run *run)
{
    return run->tool_count;
}

const pel_tool_def *view_run_tool(const view_run *run, int32_t tool, int32_t frame, double position[3],
                                  double rotation[4])
{
    const pel_tool_def *def = &run->scene->sim.tools[tool];
    pel_tool_def_pose(def, view_run_time(run, frame), position, rotation);
    if (run->tool_positions == NULL)
        return def;
    double read[3];
    for (int32_t i = 0; i < 3; ++i)
        read[i] = pel_series_value(run->tool_positions, 3 * tool + i, frame);
    if (isfinite(read[0]) && isfinite(read[1]) && isfinite(read[2]))
        memcpy(position, read, sizeof read);
    return def;
}

/* ---- frames ---- */

static pel_status find_peak(view_run *run, pel_error *error)
{
    static const char *const name = "max_displacement";
    char path[PATH_SIZE];
    pel_series *series;
    double largest = 0;
    run->peak = run->frames->frame_count - 1;
    snprintf(path, sizeof path, "%s/%s", run->frames->folder, pel_run_file_name(PEL_RUN_SERIES));
    if (!is_file(path))
        return PEL_OK;
    pel_status status = pel_series_read(path, &name, 1, &series, error);
    if (status != PEL_OK)
        return status == PEL_OUT_OF_MEMORY ? status : PEL_OK;
    for (int32_t frame = 0; frame < run->frames->frame_count; ++frame) {
        if (pel_series_value(series, 0, frame) > largest) {
            largest = pel_series_value(series, 0, frame);
            run->peak = frame;
        }
    }
    pel_series_destroy(series);
    return PEL_OK;
}

/* the folder of a run, which may be named by its frames.pvd; false for anything else */
static bool find_folder(const char *path, char folder[PATH_SIZE])
{
    const char *list = pel_run_file_name(PEL_RUN_FRAMES);
    size_t length = strlen(path), size = strlen(list);
    snprintf(folder, PATH_SIZE, "%s", path);
    if (is_folder(path))
        return true;
    if (length < size || strcmp(path + length - size, list) != 0 || (length > size && path[length - size - 1] != '/'))
        return false;
    snprintf(folder, PATH_SIZE, "%.*s", length > size ? (int)(length - size) : 1, length > size ? path : ".");
    return true;
}

pel_status view_run_open(view_run *run, const char *path, bool tools, const pel_log *log, pel_error *error)
{
    char folder[PATH_SIZE];
    *run = (view_run){.path = path};
    if (strlen(path) + 32 > PATH_SIZE) {
        pel_fail(error, PEL_BAD_FILE, "the name is too long");
        pel_fail_place(error, path, 0, 0);
        pel_fail_remedy(error, "name the run from a nearer folder");
        return PEL_BAD_FILE;
    }
    if (!find_folder(path, folder))
        return PEL_OK;
    pel_status status = pel_frames_open(folder, &run->frames, error);
    if (status == PEL_OK)
        status = find_peak(run, error);
    if (status == PEL_OK)
        status = open_scene(run, tools, log, error);
    if (status != PEL_OK)
        view_run_close(run);
    run->has_times = run->frames != NULL;
    return status;
}

void view_run_close(view_run *run)
{
    pel_frames_close(run->frames);
    pel_scene_destroy(run->scene);
    pel_series_destroy(run->tool_positions);
    *run = (view_run){0};
}

int32_t view_run_frame_count(const view_run *run)
{
    return run->frames != NULL ? run->frames->frame_count : 1;
}

double view_run_time(const view_run *run, int32_t frame)
{
    return run->frames != NULL ? run->frames->times[frame] : 0;
}

pel_status view_run_read(const view_run *run, int32_t frame, pel_mesh **mesh, pel_error *error)
{
    const char *path = run->frames != NULL ? run->frames->paths[frame] : run->path;
    if (run->frames == NULL && !view_ends_with(path, ".vtp"))
        return pel_mesh_import(path, NULL, mesh, error);
    pel_status status = pel_vtp_read(path, mesh, NULL, error);
    if (status == PEL_BAD_FILE && run->frames != NULL)
        pel_fail_remedy(error, "frames.pvd names this frame; run the scene again");
    return status;
}

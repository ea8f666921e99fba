#include "results/files.h"

#include "base/memory.h"
#include "base/status.h"
#include "io/file.h"
#include "io/pvd.h"
#include "pellicle/results.h"
#include "pellicle/sim_contact.h"
#include "results/folder.h"

#include <inttypes.h>
#include <string.h>
#include <unistd.h>

const char *pel_run_file_name(pel_run_file file)
{
    static const char *const names[PEL_RUN_FILE_COUNT] = {
        [PEL_RUN_SCENE] = "scene.yaml",  [PEL_RUN_SERIES] = "series.csv", [PEL_RUN_SUMMARY] = "summary.json",
        [PEL_RUN_FRAMES] = "frames.pvd", [PEL_RUN_FINAL] = "final.ply",   [PEL_RUN_CHECKPOINT] = "checkpoint",
    };
    return (unsigned)file < PEL_RUN_FILE_COUNT ? names[file] : NULL;
}

pel_status pel_results_write_scene(const char *folder, const char *text, const pel_sim *sim, bool finished,
                                   pel_error *error)
{
    pel_file_writer writer;
    char path[PEL_RUN_FILE_SIZE];
    pel_status status = pel_file_writer_open(&writer, pel_run_path(path, folder, PEL_RUN_SCENE), error);
    if (status != PEL_OK)
        return status;
    const pel_model *model = pel_sim_model(sim);
    pel_file_writer_write(&writer, text, strlen(text));
    pel_file_writer_printf(&writer, "# program: pellicle %s\n", PEL_VERSION);
    for (int32_t b = 0; pel_sim_contact_thickness(sim) > 0 && b < pel_model_body_count(model); b++)
        pel_file_writer_printf(&writer, "# contact thickness of '%s': %.6g m\n", pel_model_body_name(model, b),
                               pel_sim_body_contact_thickness(sim, b));
    if (finished)
        pel_file_writer_printf(&writer, "# state_hash: %016" PRIx64 " (step %" PRId64 ")\n", pel_sim_hash(sim),
                               pel_sim_step_count(sim));
    return pel_file_writer_commit(&writer, error);
}

/* room for the name of a file relative to the folder */
enum { NAME_ROOM = 48 };

static void list_file(const char *path, char *name, const char *title, double time, int32_t part, pel_pvd_entry *entry)
{
    memcpy(name, path, strlen(path) + 1);
    *entry = (pel_pvd_entry){.file = name, .name = title, .time = time, .part = part};
}

/* entries of all frames, each followed by its tools; names (NAME_ROOM each) take the paths; returns their number */
static size_t list_files(const char *folder, const double *times, size_t count, const pel_tool_surfaces *tools,
                         char *names, pel_pvd_entry *entries)
{
    char path[PEL_RUN_FILE_SIZE];
    size_t made = 0;
    for (size_t i = 0; i < count; i++) {
        pel_run_frame_path(path, NULL, (int64_t)i);
        list_file(path, names + made * NAME_ROOM, NULL, times[i], 0, &entries[made]);
        made++;
        for (int32_t tool = 0; tool < tools->count; tool++) {
            if (access(pel_run_tool_path(path, folder, (int64_t)i, tool), F_OK) != 0)
                continue;
            pel_run_tool_path(path, NULL, (int64_t)i, tool);
            list_file(path, names + made * NAME_ROOM, pel_tool_surface_name(tools, tool), times[i], tool + 1,
                      &entries[made]);
            made++;
        }
    }
    return made;
}

pel_status pel_results_write_list(const char *folder, const double *times, size_t count, const pel_tool_surfaces *tools,
                                  pel_error *error)
{
    char path[PEL_RUN_FILE_SIZE];
    size_t most = count * (1 + (size_t)tools->count);
    char *names = pel_allocate(most, NAME_ROOM);
    pel_pvd_entry *entries = pel_allocate(most, sizeof *entries);
    pel_status status = names != NULL && entries != NULL ? PEL_OK : pel_fail_memory(error);
    if (status == PEL_OK) {
        size_t made = list_files(folder, times, count, tools, names, entries);
        status = pel_pvd_write_entries(pel_run_path(path, folder, PEL_RUN_FRAMES), entries, made, error);
    }
    pel_free(entries);
    pel_free(names);
    return status;
}

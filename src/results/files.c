#include "results/files.h"

#include "base/memory.h"
#include "base/status.h"
#include "io/file.h"
#include "pellicle/results.h"
#include "results/folder.h"

#include <inttypes.h>
#include <string.h>

const char *pel_run_file_name(pel_run_file file)
{
    static const char *const names[PEL_RUN_FILE_COUNT] = {
        [PEL_RUN_SCENE] = "scene.yaml",  [PEL_RUN_SERIES] = "series.csv", [PEL_RUN_SUMMARY] = "summary.json",
        [PEL_RUN_FRAMES] = "frames.pvd", [PEL_RUN_FINAL] = "final.ply",   [PEL_RUN_CHECKPOINT] = "checkpoint",
    };
    return (unsigned)file < PEL_RUN_FILE_COUNT ? names[file] : NULL;
}

pel_status pel_results_write_scene(const char *folder, const char *text, const pel_sim *finished, pel_error *error)
{
    pel_file_writer writer;
    char path[PEL_RUN_FILE_SIZE];
    pel_status status = pel_file_writer_open(&writer, pel_run_path(path, folder, PEL_RUN_SCENE), error);
    if (status != PEL_OK)
        return status;
    pel_file_writer_write(&writer, text, strlen(text));
    pel_file_writer_printf(&writer, "# program: pellicle %s\n", PEL_VERSION);
    if (finished != NULL)
        pel_file_writer_printf(&writer, "# state_hash: %016" PRIx64 " (step %" PRId64 ")\n", pel_sim_hash(finished),
                               pel_sim_step_count(finished));
    return pel_file_writer_commit(&writer, error);
}

pel_status pel_results_write_list(const char *folder, const double *times, size_t count, pel_error *error)
{
    enum { NAME_ROOM = 40 };
    char *text = pel_allocate(count, NAME_ROOM), path[PEL_RUN_FILE_SIZE];
    const char **names = pel_allocate(count, sizeof *names);
    pel_status status = PEL_OUT_OF_MEMORY;
    if (text != NULL && names != NULL) {
        for (size_t i = 0; i < count; i++) {
            char *name = text + i * NAME_ROOM;
            pel_run_frame_path(path, NULL, (int64_t)i);
            memcpy(name, path, strlen(path) + 1);
            names[i] = name;
        }
        status = pel_pvd_write(pel_run_path(path, folder, PEL_RUN_FRAMES), names, times, (int32_t)count, error);
    } else {
        pel_fail_memory(error);
    }
    pel_free(names);
    pel_free(text);
    return status;
}

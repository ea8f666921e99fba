#include "pellicle/frames.h"

const char *pel_run_file_name(pel_run_file file)
{
    static const char *const names[PEL_RUN_FILE_COUNT] = {
        [PEL_RUN_SCENE] = "scene.yaml",  [PEL_RUN_SERIES] = "series.csv", [PEL_RUN_SUMMARY] = "summary.json",
        [PEL_RUN_FRAMES] = "frames.pvd", [PEL_RUN_FINAL] = "final.ply",   [PEL_RUN_CHECKPOINT] = "checkpoint",
    };
    return (unsigned)file < PEL_RUN_FILE_COUNT ? names[file] : NULL;
}

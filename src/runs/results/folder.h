/* The output folder of a run: names, creation, and removal of an older run. */
#ifndef PEL_RESULTS_FOLDER_H
#define PEL_RESULTS_FOLDER_H

#include "pellicle/frames.h"
#include "pellicle/run.h"

/* room for the path of any file of a run */
enum { PEL_RUN_FILE_SIZE = PEL_RUN_PATH_SIZE + 64 };

/* folder/series.csv and the like */
const char *pel_run_path(char path[PEL_RUN_FILE_SIZE], const char *folder, pel_run_file file);
/* folder/frames/f00012.vtp; without a folder relative to it */
const char *pel_run_frame_path(char path[PEL_RUN_FILE_SIZE], const char *folder, int64_t frame);
/* folder/frames/t00012-0.vtp, of the tool with that number; without a folder relative to it */
const char *pel_run_tool_path(char path[PEL_RUN_FILE_SIZE], const char *folder, int64_t frame, int32_t tool);
/* folder/checkpoint-120.pel */
const char *pel_run_checkpoint_path(char path[PEL_RUN_FILE_SIZE], const char *folder, int64_t step);

/* Decides what becomes of what is in the folder before a run. One that has the mark of a run (.pellicle-run) moves
   aside to the first free of NAME.1, NAME.2, ..., with a note in log, or stays to be cleared with `overwrite`. One
   without the mark must be missing or empty. resume: the checkpoint to go on from, null = none; it makes its own folder
   that of a run. PEL_BAD_FILE: a folder with other files, one that cannot be moved (a mount, a folder above the current
   one), another run is in it. */
pel_status pel_run_folder_claim(const char *folder, const char *resume, bool overwrite, const pel_log *log,
                                pel_error *error);

/* Makes the folder with its parents, its mark and `frames` in it. PEL_BAD_FILE if that fails or the folder is not
   writable. */
pel_status pel_run_folder_open(const char *folder, pel_error *error);

/* From claiming a folder to locking it one run comes after the other: another one would move the new folder aside
   before it is locked. A lock on the folder around it, for which it waits at most 5 s; -1 if that has none yet. */
int pel_run_folder_queue(const char *folder);
void pel_run_folder_leave_queue(int queue);

/* Keeps other runs out of the folder until it is unlocked or the program ends in any way. *lock receives the argument
   of unlocking, -1 if the file system has no locks. PEL_BAD_FILE, with the owner, if another run holds it. */
pel_status pel_run_folder_lock(const char *folder, int *lock, pel_error *error);
/* Waits until frames and rows are on the disk, which a checkpoint or a summary counts on. PEL_BAD_FILE. */
pel_status pel_run_folder_sync(const char *folder, pel_error *error);
void pel_run_folder_unlock(const char *folder, int lock);

/* Removes the files of an older run: frames from first_frame on, partial files, and the other files of a run; of these
   only summary.json and final.ply with `resume`. *removed tells whether there were any. */
pel_status pel_run_folder_clear(const char *folder, int64_t first_frame, bool resume, bool *removed, pel_error *error);

/* Whether such a run writes over a file that is there, removes it or moves it aside. */
bool pel_run_folder_takes(const char *folder, const char *path, bool resume, bool overwrite);

/* Sets space on the disk aside (false when there is not enough), and gives it back, so that the last files of a run can
   be written after frames have filled the disk. */
bool pel_run_folder_reserve(const char *folder, size_t size);
void pel_run_folder_release(const char *folder);

#endif

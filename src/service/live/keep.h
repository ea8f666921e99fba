/* The state of a live simulation on the disk: a scene that repeats its session, written while it goes on and read at
   the next start. */
#ifndef PEL_LIVE_KEEP_H
#define PEL_LIVE_KEEP_H

#include "pellicle/session.h"

/* s between two writes: a crash loses no more */
#define PEL_KEEP_SECONDS 0.5

/* Replaces the file; removes it if nothing is recorded. Does not wait for the disk: the file survives a crash of the
   program, not of the machine. PEL_BAD_FILE, PEL_OUT_OF_MEMORY. */
pel_status pel_keep_write(const char *path, const pel_session *session, int64_t steps, pel_error *error);

/* What a session did up to a step. */
typedef struct pel_kept {
    pel_scene *scene;
    const pel_scene_command *commands; /* (command_count), of the scene, which itself has no session then */
    int32_t command_count;
    int64_t steps;
} pel_kept;

/* Reads the file; paths of meshes are relative to the folder of scene_path. No file: PEL_OK and a null scene. Errors:
   those of pel_scene_parse, and PEL_BAD_FORMAT if it is another file. */
pel_status pel_keep_read(const char *path, const char *scene_path, pel_kept *kept, pel_error *error);

#endif

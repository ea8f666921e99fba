/* The state of a live simulation on the disk: a scene that repeats its session, written while it goes on and read at
   the next start. */
#ifndef PEL_LIVE_KEEP_H
#define PEL_LIVE_KEEP_H

#include "pellicle/session.h"

#include <stdio.h>

/* s between two writes: a crash loses no more */
#define PEL_KEEP_SECONDS 0.5

/* The file of a session. Zeros but for the path at the start. */
typedef struct pel_keep {
    const char *path;
    FILE *stream;  /* null: the file is not of the session, or not whole */
    size_t head;   /* bytes before the commands */
    size_t length; /* bytes of commands in the file */
} pel_keep;

/* Writes what the file lacks: the whole text at first, then the commands that are new, behind those that did not
   change, so that hours of use take no longer than the first minute. Removes the file if nothing is recorded. Does not
   wait for the disk: the file survives a crash of the program, not of the machine. After PEL_BAD_FILE,
   PEL_OUT_OF_MEMORY the next call writes all. */
pel_status pel_keep_write(pel_keep *keep, pel_session *session, int64_t steps, pel_error *error);
void pel_keep_close(pel_keep *keep);

/* What a session did up to a step. */
typedef struct pel_kept {
    pel_scene *scene;
    const pel_scene_command *commands; /* (command_count), of the scene, which itself has no session then */
    int32_t command_count;
    int64_t steps;
} pel_kept;

/* Reads the file, without the line that a crash cut off; paths of meshes are relative to the folder of scene_path. No
   file: PEL_OK and a null scene. Errors: those of pel_scene_parse, and PEL_BAD_FORMAT if it is another file. */
pel_status pel_keep_read(const char *path, const char *scene_path, pel_kept *kept, pel_error *error);

#endif

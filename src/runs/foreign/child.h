/* Formats that assimp reads are read by the program `pellicle` in a process of its own, so that a damaged file ends
   that process and not this one.

   The child writes to its standard output: the head, what_length bytes of notes (each ends with a zero) or, after a
   failure, what and remedy (each ends with a zero), then positions (vertex_count x 3 doubles) and triangles
   (triangle_count x 3 int32_t). */
#ifndef PEL_FOREIGN_CHILD_H
#define PEL_FOREIGN_CHILD_H

#include "pellicle/mesh.h"

#define PEL_CHILD_MAGIC "pelmesh1"
/* the hidden command of the program: pellicle --import-child FILE */
#define PEL_CHILD_COMMAND "--import-child"

typedef struct pel_child_head {
    char magic[8];
    int32_t status, vertex_count, triangle_count, text_length;
} pel_child_head;

/* limits of the child: seconds of processor and of waiting, bytes for a file of that size */
enum { PEL_CHILD_CPU_SECONDS = 60, PEL_CHILD_WAIT_SECONDS = 90 };
#define PEL_CHILD_MEMORY(file_size) (((uint64_t)1 << 30) + 100 * (uint64_t)(file_size))

/* Whether a path has one of the extensions of the list. */
bool pel_foreign_is(const char *path);
/* Finds the program that reads foreign formats, as pel_mesh_import says. false = none. */
bool pel_foreign_program(char *path, size_t size);
/* Reads the file in a child, and waits for it no longer than that. */
pel_status pel_foreign_read(const char *path, double wait_seconds, const pel_log *log, pel_mesh **mesh,
                            pel_error *error);

#endif

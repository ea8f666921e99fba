/* Whole files: reading one into memory, and writing one so that its name always refers to a complete file. */
#ifndef PEL_IO_FILE_H
#define PEL_IO_FILE_H

#include "base/status.h"

#include <stdbool.h>
#include <stdio.h>

/* Reads a whole regular file into a new block of *size bytes, to be freed with pel_free. One zero byte follows the
   last byte. Errors: PEL_BAD_FILE with the path (missing, a folder, a pipe or a device, unreadable), PEL_OUT_OF_MEMORY;
   *bytes is null then. An empty file is no error. */
pel_status pel_file_read(const char *path, char **bytes, size_t *size, pel_error *error);

/* Whether a regular file is there and can be opened for reading; PEL_BAD_FILE otherwise. */
pel_status pel_file_check(const char *path, pel_error *error);

/* Refuses (PEL_BAD_FORMAT) a file that is not below the folder once links are resolved. One that is not there passes.
 */
pel_status pel_file_check_inside(const char *folder, const char *path, pel_error *error);

/* Writes to a temporary file in the folder of the path, without a name until it is whole where the file system has such
   files; commit renames it over the path, abandon removes it. A path
   that is a device or a pipe is written directly, a symbolic link is followed, and the mode of a replaced file is kept.
       pel_file_writer writer;
       pel_status status = pel_file_writer_open(&writer, path, error);
       if (status != PEL_OK)
           return status;
       pel_file_writer_printf(&writer, ...);
       return pel_file_writer_commit(&writer, error);
   A failed write is remembered and reported by commit, so the calls between need no checks. */
typedef struct pel_file_writer {
    FILE *stream;
    char *path;      /* path given by the user, for messages */
    char *target;    /* the same with links resolved */
    char *temporary; /* null when written directly */
    bool nameless;   /* the temporary file has no name yet */
    bool is_kept;    /* waits for the disk */
    int failure;     /* errno of the first failure, 0 = none */
} pel_file_writer;

/* On failure (PEL_BAD_FILE, PEL_OUT_OF_MEMORY) there is nothing to close. */
pel_status pel_file_writer_open(pel_file_writer *writer, const char *path, pel_error *error);
void pel_file_writer_write(pel_file_writer *writer, const void *bytes, size_t size);
/* for text and integers; floating-point numbers follow the locale here: see pel_number_print for those */
void pel_file_writer_printf(pel_file_writer *writer, const char *format, ...) PEL_PRINTF(2, 3);
/* Before commit: the file is to survive a power failure. Its bytes are on the disk before its name is, and its name is
   before commit returns. Takes some milliseconds. */
void pel_file_writer_keep(pel_file_writer *writer);
/* Flushes, closes and renames. On failure (disk full, ...) the temporary file is removed and an older file under the
   path stays as it was. Closes the writer either way. */
pel_status pel_file_writer_commit(pel_file_writer *writer, pel_error *error);
/* Waits until the bytes of a file, or the names of the folder that a path is in, are on the disk. False with errno;
   file systems that cannot wait are no failure. */
bool pel_file_sync(int descriptor);
bool pel_file_sync_folder(const char *path);
/* The same for all that was written to the file system of a folder: for many files faster than one by one. */
bool pel_file_sync_system(const char *folder);
/* Remedy for a write that failed with this errno. Lives forever. */
const char *pel_file_write_remedy(int number);
/* Closes and removes the file; allowed on a closed writer. */
void pel_file_writer_abandon(pel_file_writer *writer);

#endif

/* Shared by several commands: errors and notes on standard error, meshes in and out. */
#ifndef PELLICLE_CLI_DIAGNOSTICS_H
#define PELLICLE_CLI_DIAGNOSTICS_H

#include "options.h"

#include <pellicle/error.h>
#include <pellicle/json.h>
#include <pellicle/mesh_check.h>
#include <pellicle/mesh_io.h>

/* Prints the error as "file:line:column: error: what. remedy" on stderr. Returns its exit status. */
int cli_report(const pel_error *error);
/* writes the error as the member "error" of the open JSON object */
void cli_write_error(pel_json *json, const pel_error *error);
/* cli_report, and as members "ok": false and "error" of the open JSON object; json is nullable */
int cli_report_to(const pel_error *error, pel_json *json);
/* names the file of an error that names none */
void cli_name_file(pel_error *error, const char *path);

const char *cli_severity_name(pel_severity severity);
/* Opens an object of the list of issues of `pellicle check` and writes what all of them have. */
void cli_open_issue(pel_json *json, const pel_issue_info *info, int64_t count);

/* Finds a file that is installed in share/pellicle next to the program or, before installation, is in the build folder
   or the source tree. Returns path (size bytes), or null if it is in none of these places. */
const char *cli_share_path(char *path, size_t size, const char *name);
/* The scene's file: a name without slash and dot, where no such file is, means an installed scene. Returns path (size
   bytes) or name. */
const char *cli_scene_path(char *path, size_t size, const char *name);
/* makes the nearest installed scene the remedy of an error about a missing file, if the name can mean one */
void cli_suggest_scene(pel_error *error, const char *name);

/* whether the path ends like a scene file (.yaml, .yml, .json) */
bool cli_is_scene(const char *path);
bool cli_is_folder(const char *path);

/* a log that prints "note: ..." on stderr */
extern const pel_log cli_notes;

/* any mesh file; reports the error (json is nullable) and returns null on failure */
pel_mesh *cli_read_mesh(const char *path, const pel_log *log, pel_json *json, int *status);

/* The format of --format, otherwise of the path's extension; prints an error and returns false if there is none. */
bool cli_output_format(const cli_call *call, const char *path, pel_mesh_format *format);

/* Writes the mesh; prints a summary on stdout unless quiet, or the error. Returns the exit status. */
int cli_write_mesh(const char *path, pel_mesh_format format, const pel_mesh *mesh, const pel_log *log, bool quiet);

#endif

/* The finding of `pellicle check` that needs a trial repair: triangles whose common corners lie slightly apart. */
#ifndef PELLICLE_CLI_CRACKS_H
#define PELLICLE_CLI_CRACKS_H

#include <pellicle/json.h>
#include <pellicle/mesh_check.h>

typedef struct cli_cracks {
    int32_t count;    /* boundary edges that close if vertices up to `tolerance` apart are one; 0 = none */
    double tolerance; /* lengths of the file: a thousandth of the median edge, two digits */
    char remedy[120]; /* an imperative, "" without cracks */
} cli_cracks;

/* Looks for them in a mesh without exact duplicates of vertices, which are another finding. */
pel_status cli_find_cracks(const pel_mesh *mesh, const pel_mesh_report *report, cli_cracks *found, pel_error *error);

/* One warning, if there are any. */
void cli_print_cracks(const char *path, const cli_cracks *found);

/* An entry of the list of issues. */
void cli_write_cracks(pel_json *json, const cli_cracks *found);

#endif

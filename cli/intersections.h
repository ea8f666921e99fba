/* The finding of `pellicle check` that needs a search: triangles that cut each other. */
#ifndef PELLICLE_CLI_INTERSECTIONS_H
#define PELLICLE_CLI_INTERSECTIONS_H

#include <pellicle/intersect.h>
#include <pellicle/json.h>
#include <pellicle/mesh_check.h>

typedef struct cli_intersections {
    bool looked;   /* false: not requested, or the mesh has other errors to fix first */
    int64_t count; /* pairs of triangles */
    int32_t listed_count;
    pel_pair pairs[PEL_ISSUE_LIST_LIMIT];
    pel_error failure; /* too much work: why they are not counted; status PEL_OK otherwise */
} cli_intersections;

/* Looks for them in a mesh whose report has no errors; vertices at one place count as one, as after `--fix`. Too much
   work is not an error: `failure` describes it and nothing is counted. */
pel_status cli_find_intersections(const pel_mesh *mesh, const pel_mesh_report *report, cli_intersections *found,
                                  pel_error *error);

/* The first of them as warnings, with their places. */
void cli_print_intersections(const char *path, const pel_mesh *mesh, const cli_intersections *found, int shown_max);

/* An entry of the list of issues. */
void cli_write_intersections(pel_json *json, const cli_intersections *found);

#endif

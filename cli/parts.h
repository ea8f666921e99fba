/* The finding of `pellicle check` about a mesh in several parts, such as a scan with a stray piece. */
#ifndef PELLICLE_CLI_PARTS_H
#define PELLICLE_CLI_PARTS_H

#include <pellicle/json.h>
#include <pellicle/mesh_check.h>

typedef struct cli_parts {
    int32_t count;       /* parts that no edge connects with the largest one; 0 = none */
    int32_t first;       /* first triangle of the first of them */
    int32_t least, most; /* triangles of the smallest and of the largest of them */
    double area_share;   /* their area over that of the mesh */
    char remedy[120];    /* an imperative, "" without parts */
} cli_parts;

/* Counts the parts of a mesh whose vertices are not still to be welded. */
void cli_find_parts(const pel_mesh_report *report, cli_parts *found);

/* One note, if there are any. */
void cli_print_parts(const char *path, const pel_mesh *mesh, const cli_parts *found);

/* An entry of the list of issues. */
void cli_write_parts(pel_json *json, const cli_parts *found);

#endif

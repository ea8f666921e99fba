#include "cracks.h"

#include "diagnostics.h"

#include <stdio.h>
#include <stdlib.h>

/* vertices this near to each other are meant to be one; of the median edge */
#define CRACK_WIDTH 1e-3

static const char doc[] = "edge on a boundary only because corners of neighbouring triangles lie slightly apart";

static pel_status count_welded(const pel_mesh *mesh, double tolerance, int32_t *count, pel_error *error)
{
    pel_repair_options options = pel_repair_options_default();
    options.weld_tolerance = tolerance;
    pel_mesh *welded = NULL;
    pel_mesh_report *report = NULL;
    pel_status status = pel_mesh_repair(mesh, &options, &welded, NULL, error);
    if (status == PEL_OK)
        status = pel_mesh_check(welded, &report, error);
    if (status == PEL_OK)
        *count = report->issues[PEL_ISSUE_BOUNDARY_EDGE].count;
    pel_mesh_report_destroy(report);
    pel_mesh_destroy(welded);
    return status;
}

pel_status cli_find_cracks(const pel_mesh *mesh, const pel_mesh_report *report, cli_cracks *found, pel_error *error)
{
    *found = (cli_cracks){0};
    int32_t before = report->issues[PEL_ISSUE_BOUNDARY_EDGE].count, loose, after;
    char text[32];
    snprintf(text, sizeof text, "%.1e", CRACK_WIDTH * report->edge_length_median);
    double tolerance = strtod(text, NULL);
    if (before == 0 || !(tolerance > 0) || report->issues[PEL_ISSUE_DUPLICATE_VERTEX].count > 0)
        return PEL_OK;
    /* other repairs change boundaries too: compare with those alone */
    pel_status status = count_welded(mesh, 0, &loose, error);
    if (status == PEL_OK)
        status = count_welded(mesh, tolerance, &after, error);
    /* nothing is left: other findings say why */
    if (status == PEL_BAD_MESH)
        return PEL_OK;
    if (status == PEL_OK && after < loose) {
        found->count = loose - after;
        found->tolerance = tolerance;
        snprintf(found->remedy, sizeof found->remedy, "run `pellicle check FILE --fix OUT --tolerance %g` to weld them",
                 tolerance);
    }
    return status;
}

void cli_print_cracks(const char *path, const cli_cracks *found)
{
    if (found->count > 0)
        fprintf(stderr, "%s: warning: %s: %d of them. %s\n", path, doc, (int)found->count, found->remedy);
}

void cli_write_cracks(pel_json *json, const cli_cracks *found)
{
    if (found->count == 0)
        return;
    const pel_issue_info info = {
        .name = "crack", .severity = PEL_SEVERITY_WARNING, .doc = doc, .remedy = found->remedy, .repairable = true};
    cli_open_issue(json, &info, found->count);
    pel_json_number(json, "tolerance", found->tolerance);
    pel_json_close(json, '}');
}

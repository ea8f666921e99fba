#include "intersections.h"

#include "diagnostics.h"

static const char *const doc = "triangles that cut or touch each other away from their common corners";
static const char *const remedy = "move them apart in a mesh editor; this cannot be repaired here";

/* a copy in which vertices at one place are one; its triangles have the same numbers */
static pel_status weld(const pel_mesh *mesh, pel_mesh **welded, pel_error *error)
{
    pel_repair_options options = pel_repair_options_default();
    options.drop_degenerate = options.drop_duplicates = options.drop_isolated = false;
    options.close_slits = options.cut = false;
    options.orient = options.outward = false;
    return pel_mesh_repair(mesh, &options, welded, NULL, error);
}

pel_status cli_find_intersections(const pel_mesh *mesh, const pel_mesh_report *report, cli_intersections *found,
                                  pel_error *error)
{
    pel_mesh *welded = NULL;
    pel_status status = PEL_OK;
    found->looked = false;
    found->count = found->listed_count = 0;
    found->failure = (pel_error){.status = PEL_OK};
    if (report->error_count > 0)
        return PEL_OK;
    if (report->issues[PEL_ISSUE_DUPLICATE_VERTEX].count > 0)
        status = weld(mesh, &welded, error);
    if (status == PEL_OK)
        status = pel_mesh_self_intersections(welded != NULL ? welded : mesh, found->pairs, PEL_ISSUE_LIST_LIMIT,
                                             &found->count, &found->failure);
    pel_mesh_destroy(welded);
    found->looked = status == PEL_OK;
    if (status != PEL_OK && status != PEL_BAD_MESH && found->failure.status == status)
        *error = found->failure;
    status = status == PEL_BAD_MESH ? PEL_OK : status;
    found->listed_count = (int32_t)(found->count < PEL_ISSUE_LIST_LIMIT ? found->count : PEL_ISSUE_LIST_LIMIT);
    return status;
}

void cli_print_intersections(const char *path, const pel_mesh *mesh, const cli_intersections *found, int shown_max)
{
    if (found->failure.status == PEL_BAD_MESH)
        fprintf(stderr, "%s: note: self-intersections are not counted: %s. %s\n", path, found->failure.what,
                found->failure.remedy);
    int32_t shown = found->listed_count < shown_max ? found->listed_count : shown_max;
    for (int32_t i = 0; i < shown; ++i) {
        const double *x = mesh->positions[mesh->triangles[found->pairs[i].first][0]];
        fprintf(stderr, "%s: warning: triangles %d and %d at (%.6g, %.6g, %.6g): %s. %s\n", path,
                (int)found->pairs[i].first, (int)found->pairs[i].second, x[0], x[1], x[2], doc, remedy);
    }
    if (found->count > shown)
        fprintf(stderr, "%s: warning: and %lld more pairs: %s\n", path, (long long)(found->count - shown), doc);
}

void cli_write_intersections(pel_json *json, const cli_intersections *found)
{
    if (found->count == 0)
        return;
    const pel_issue_info info = {.name = "self-intersection",
                                 .severity = PEL_SEVERITY_WARNING,
                                 .doc = doc,
                                 .remedy = remedy,
                                 .repairable = false};
    cli_open_issue(json, &info, found->count);
    pel_json_text(json, "element_kind", "triangle");
    pel_json_open(json, "elements", '[');
    for (int32_t i = 0; i < found->listed_count; ++i)
        pel_json_integer(json, NULL, found->pairs[i].first);
    pel_json_close(json, ']');
    pel_json_open(json, "pairs", '[');
    for (int32_t i = 0; i < found->listed_count; ++i)
        pel_json_numbers(json, NULL, (double[]){found->pairs[i].first, found->pairs[i].second}, 2);
    pel_json_close(json, ']');
    pel_json_close(json, '}');
}

#include "parts.h"

#include "diagnostics.h"

#include <stdio.h>

static const char doc[] = "part that no edge connects with the largest one";

void cli_find_parts(const pel_mesh_report *report, cli_parts *found)
{
    *found = (cli_parts){0};
    if (report->component_count < 2 || report->issues[PEL_ISSUE_DUPLICATE_VERTEX].count > 0)
        return;
    int32_t largest = 0;
    double area = 0;
    for (int32_t c = 0; c < report->component_count; c++)
        if (report->components[c].triangle_count > report->components[largest].triangle_count)
            largest = c;
    found->first = report->components[largest == 0].first_triangle;
    found->least = found->most = report->components[largest == 0].triangle_count;
    for (int32_t c = 0; c < report->component_count; c++) {
        int32_t size = report->components[c].triangle_count;
        if (c == largest)
            continue;
        found->count++;
        found->least = size < found->least ? size : found->least;
        found->most = size > found->most ? size : found->most;
        area += report->components[c].area;
    }
    found->area_share = report->area > 0 ? area / report->area : 0;
    snprintf(found->remedy, sizeof found->remedy,
             "if it is stray, run `pellicle check FILE --fix OUT --drop-parts %d` to drop it", (int)found->most);
}

void cli_print_parts(const char *path, const pel_mesh *mesh, const cli_parts *found)
{
    char size[48];
    if (found->count == 0)
        return;
    if (found->least < found->most)
        snprintf(size, sizeof size, "%d to %d triangles", (int)found->least, (int)found->most);
    else
        snprintf(size, sizeof size, "%d %s", (int)found->most, found->most == 1 ? "triangle" : "triangles");
    const double *x = mesh->positions[mesh->triangles[found->first][0]];
    fprintf(stderr,
            "%s: note: %s: %d of them, %s, %.2g %% of the area, from triangle %d at (%.6g, %.6g, %.6g) on. %s\n", path,
            doc, (int)found->count, size, 100 * found->area_share, (int)found->first, x[0], x[1], x[2], found->remedy);
}

void cli_write_parts(pel_json *json, const cli_parts *found)
{
    if (found->count == 0)
        return;
    const pel_issue_info info = {
        .name = "part", .severity = PEL_SEVERITY_NOTE, .doc = doc, .remedy = found->remedy, .repairable = true};
    cli_open_issue(json, &info, found->count);
    pel_json_integer(json, "triangles_least", found->least);
    pel_json_integer(json, "triangles_most", found->most);
    pel_json_number(json, "area_share", found->area_share);
    pel_json_close(json, '}');
}

#include "commands.h"
#include "diagnostics.h"

#include <pellicle/mesh_check.h>

static const char *yes_or_no(bool value)
{
    return value ? "yes" : "no";
}

static bool is_outward(const pel_mesh_report *report)
{
    return report->issues[PEL_ISSUE_INSIDE_OUT].count == 0;
}

static void print_fields(const pel_mesh *mesh)
{
    printf("  fields            ");
    for (int32_t i = 0; i < mesh->field_count; ++i) {
        printf("%s%s", i > 0 ? ", " : "", mesh->fields[i].name);
        if (mesh->fields[i].component_count > 1)
            printf(" (%d numbers)", (int)mesh->fields[i].component_count);
    }
    puts(mesh->field_count == 0 ? "none" : "");
}

static void print_info(const char *path, const pel_mesh *mesh, const pel_mesh_report *r)
{
    const double *low = r->bounds_low, *high = r->bounds_high;
    printf("%s\n", path);
    printf("  vertices          %d\n", (int)r->vertex_count);
    printf("  triangles         %d\n", (int)r->triangle_count);
    printf("  edges             %d\n", (int)r->edge_count);
    printf("  components        %d\n", (int)r->component_count);
    printf("  closed            %s", yes_or_no(r->closed));
    if (!r->closed)
        printf(", %d boundary edges in %d %s", (int)r->issues[PEL_ISSUE_BOUNDARY_EDGE].count,
               (int)r->boundary_loop_count, r->boundary_loop_count == 1 ? "loop" : "loops");
    printf("\n  manifold          %s\n", yes_or_no(r->manifold));
    printf("  oriented          %s%s\n", yes_or_no(r->oriented),
           !r->oriented || !r->closed ? ""
           : is_outward(r)            ? ", outward"
                                      : ", inside out");
    if (r->genus >= 0)
        printf("  genus             %d\n", (int)r->genus);
    else
        printf("  genus             none\n");
    printf("  Euler number      %d\n", (int)r->euler_characteristic);
    if (r->closed && r->oriented)
        printf("  volume            %.9g\n", r->volume);
    printf("  area              %.9g\n", r->area);
    printf("  edge length       %.6g to %.6g, median %.6g\n", r->edge_length_min, r->edge_length_max,
           r->edge_length_median);
    printf("  quality           %.4g at worst (triangle %d), mean %.4g; 1 = equilateral, 0 = flat\n", r->quality_min,
           (int)r->worst_triangle, r->quality_mean);
    printf("  edges per vertex  %d to %d, mean %.4g\n", (int)r->valence_min, (int)r->valence_max, r->valence_mean);
    printf("  size              %.6g x %.6g x %.6g\n", high[0] - low[0], high[1] - low[1], high[2] - low[2]);
    printf("  bounding box      (%.6g, %.6g, %.6g) to (%.6g, %.6g, %.6g)\n", low[0], low[1], low[2], high[0], high[1],
           high[2]);
    print_fields(mesh);
    if (r->error_count + r->warning_count > 0)
        printf("  problems          %lld; 'pellicle check %s' names them\n",
               (long long)(r->error_count + r->warning_count), path);
}

static void write_fields(pel_json *json, const pel_mesh *mesh)
{
    pel_json_open(json, "fields", '[');
    for (int32_t i = 0; i < mesh->field_count; ++i) {
        pel_json_open(json, NULL, '{');
        pel_json_text(json, "name", mesh->fields[i].name);
        pel_json_integer(json, "component_count", mesh->fields[i].component_count);
        pel_json_close(json, '}');
    }
    pel_json_close(json, ']');
}

static void write_topology(pel_json *json, const pel_mesh_report *r)
{
    pel_json_integer(json, "vertices", r->vertex_count);
    pel_json_integer(json, "triangles", r->triangle_count);
    pel_json_integer(json, "edges", r->edge_count);
    pel_json_integer(json, "components", r->component_count);
    pel_json_bool(json, "closed", r->closed);
    pel_json_bool(json, "manifold", r->manifold);
    pel_json_bool(json, "oriented", r->oriented);
    if (r->closed && r->oriented)
        pel_json_bool(json, "outward", is_outward(r));
    else
        pel_json_null(json, "outward");
    if (r->genus >= 0)
        pel_json_integer(json, "genus", r->genus);
    else
        pel_json_null(json, "genus");
    pel_json_integer(json, "euler_characteristic", r->euler_characteristic);
    pel_json_integer(json, "boundary_edges", r->issues[PEL_ISSUE_BOUNDARY_EDGE].count);
    pel_json_integer(json, "boundary_loops", r->boundary_loop_count);
}

static void write_info(const char *path, const pel_mesh *mesh, const pel_mesh_report *r)
{
    pel_json json = {.file = stdout, .style = PEL_JSON_INDENTED};
    pel_json_open(&json, NULL, '{');
    pel_json_text(&json, "file", path);
    write_topology(&json, r);
    if (r->closed && r->oriented)
        pel_json_number(&json, "volume", r->volume);
    else
        pel_json_null(&json, "volume");
    pel_json_number(&json, "area", r->area);
    pel_json_number(&json, "edge_length_min", r->edge_length_min);
    pel_json_number(&json, "edge_length_median", r->edge_length_median);
    pel_json_number(&json, "edge_length_mean", r->edge_length_mean);
    pel_json_number(&json, "edge_length_max", r->edge_length_max);
    pel_json_number(&json, "quality_min", r->quality_min);
    pel_json_number(&json, "quality_mean", r->quality_mean);
    pel_json_integer(&json, "worst_triangle", r->worst_triangle);
    pel_json_integer(&json, "valence_min", r->valence_min);
    pel_json_integer(&json, "valence_max", r->valence_max);
    pel_json_number(&json, "valence_mean", r->valence_mean);
    pel_json_numbers(&json, "bounds_low", r->bounds_low, 3);
    pel_json_numbers(&json, "bounds_high", r->bounds_high, 3);
    write_fields(&json, mesh);
    pel_json_integer(&json, "errors", r->error_count);
    pel_json_integer(&json, "warnings", r->warning_count);
    pel_json_close(&json, '}');
}

int cli_info(const cli_call *call)
{
    const char *path = call->arguments[0];
    int status;
    pel_mesh *mesh = cli_read_mesh(path, &cli_notes, NULL, &status);
    if (mesh == NULL)
        return status;
    pel_mesh_report *report = NULL;
    pel_error error;
    if (pel_mesh_check(mesh, &report, &error) != PEL_OK)
        status = cli_report(&error);
    else if (cli_has(call, "json"))
        write_info(path, mesh, report);
    else
        print_info(path, mesh, report);
    pel_mesh_report_destroy(report);
    pel_mesh_destroy(mesh);
    return status;
}
